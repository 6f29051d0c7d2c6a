#version 330 core
// Linear light to sRGB codes (IEC 61966-2-1), with 0.4 codes of ordered noise either way: the sky does not band,
// and light that is exactly a code stays that code.
// The formula stands here because drivers' own encoding may be off by one code. Its power is fitted by square and fourth
// roots (least greatest error: 0.01 codes, exact at 1), which cost a software driver half as much.
uniform sampler2D linear_picture;
uniform ivec2 corner;  // of the target's pixels, where the picture begins
layout(location = 0) out vec4 pixel;

float noise(vec2 at) {
    return fract(52.9829189 * fract(dot(at, vec2(0.06711056, 0.00583715))));
}

void main() {
    vec2 at = gl_FragCoord.xy - vec2(corner);
    vec3 light = clamp(texelFetch(linear_picture, ivec2(at), 0).rgb, 0.0, 1.0);
    vec3 low = light * 12.92;
    vec3 root = sqrt(light);
    vec3 fourth = sqrt(root);
    vec3 high = -0.0648014 + 0.0784711 * light + (1.1175402 - 0.3290264 * fourth) * root + 0.1978165 * fourth;
    vec3 encoded = mix(high, low, vec3(lessThanEqual(light, vec3(0.0031308))));
    pixel = vec4(encoded + (noise(at) - 0.5) * 0.8 / 255.0, 1.0);
}
