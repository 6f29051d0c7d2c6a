#version 330 core
#include "common.glsl"
#include "surroundings.glsl"
uniform mat4 clip_to_world;
in vec2 screen;
layout(location = 0) out vec4 pixel;

void main() {
    vec4 far = clip_to_world * vec4(screen * 2.0 - 1.0, 1.0, 1.0);
    vec3 direction = normalize(far.xyz / far.w - eye);
    pixel = vec4(fit_to_display(background(direction)), 1.0);
}
