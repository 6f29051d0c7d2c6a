#version 330 core
#include "skinning.glsl"

uniform mat4 world_to_shadow_clip;

void main() {
    vec4 x_row, y_row, z_row;
    blend_matrix(x_row, y_row, z_row);
    vec4 bound = bind_vertex();
    vec3 world = vec3(dot(x_row, bound), dot(y_row, bound), dot(z_row, bound)) + walker_place();
    gl_Position = world_to_shadow_clip * vec4(world, 1.0);
}
