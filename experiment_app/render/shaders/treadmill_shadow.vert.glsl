#version 330 core
uniform mat4 world_to_shadow_clip;
uniform vec3 machine_place;
in vec3 position;

void main() {
    gl_Position = world_to_shadow_clip * vec4(position + machine_place, 1.0);
}
