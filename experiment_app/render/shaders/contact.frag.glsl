#version 330 core
// Sky light taken from the ground by the body above it: cos(angle) r^2 / d^2 for each sphere of the legs and trunk.
uniform sampler2D occluders;
uniform vec4 area;                // centre x, z and half sizes x, z m within which the ground lies
in vec3 world_position;
flat in int walker;
layout(location = 0) out vec4 pixel;

void main() {
    if (any(greaterThan(abs(world_position.xz - area.xy), area.zw))) discard;
    vec4 place = texelFetch(occluders, ivec2(0, walker), 0);
    float edge = length(world_position.xz - place.xz) / place.w;
    float open = 1.0;
    int count = edge < 1.0 ? OCCLUDERS : 0;
    for (int i = 1; i < count; i++) {
        vec4 sphere = texelFetch(occluders, ivec2(i, walker), 0);
        vec3 towards = sphere.xyz - world_position;
        float square = max(dot(towards, towards), sphere.w * sphere.w);
        float facing = max(towards.y, 0.0) * inversesqrt(square);
        open *= 1.0 - 0.85 * facing * sphere.w * sphere.w / square;
    }
    pixel = vec4(vec3(mix(open, 1.0, smoothstep(0.55, 1.0, edge))), 1.0);
}
