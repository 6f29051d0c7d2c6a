#version 330 core
uniform mat4 world_to_clip;
uniform vec3 machine_place;
in vec3 position;
in vec3 normal;
in vec4 paint;       // linear rgb, roughness
in vec2 belt;        // belt coordinate along its loop (m), 1 on the belt
out vec3 world_position;
out vec3 world_normal;
out vec4 surface;
out vec2 loop;

void main() {
    world_position = position + machine_place;
    world_normal = normal;
    surface = paint;
    loop = belt;
    gl_Position = world_to_clip * vec4(world_position, 1.0);
}
