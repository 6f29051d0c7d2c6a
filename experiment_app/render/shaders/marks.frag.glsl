#version 330 core
// Round to a pixel: how much of the pixel the line covers is its alpha.
uniform float brightness;

in vec2 position;
flat in vec2 start;
flat in vec2 end;
flat in float radius;

layout(location = 0) out vec4 pixel;

void main() {
    vec2 along = end - start;
    float share = clamp(dot(position - start, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
    float outside = distance(position, start + share * along) - radius;
    pixel = vec4(vec3(brightness), clamp(0.5 - outside, 0.0, 1.0));
}
