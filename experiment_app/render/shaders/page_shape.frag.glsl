#version 330 core
// A rounded rectangle with a border, smooth to a pixel. Colours are sRGB as they are shown; the result is
// premultiplied by its alpha.
in vec2 position;
flat in vec4 box;
flat in vec4 inside;
flat in vec4 outline;
flat in vec3 shape;

out vec4 colour;

void main() {
    vec2 half_size = 0.5 * box.zw;
    float radius = min(shape.x, min(half_size.x, half_size.y));
    vec2 corner = abs(position - box.xy - half_size) - half_size + radius;
    float outside = length(max(corner, 0.0)) + min(max(corner.x, corner.y), 0.0) - radius;

    float within = shape.z > 0.0 ? 1.0 - smoothstep(-shape.z, shape.z, outside) : clamp(0.5 - outside, 0.0, 1.0);
    float core = shape.y > 0.0 ? clamp(0.5 - outside - shape.y, 0.0, 1.0) : 1.0;
    vec4 body = vec4(inside.rgb, 1.0) * inside.a;
    vec4 border = vec4(outline.rgb, 1.0) * outline.a;
    colour = mix(border, body, core) * within;
}
