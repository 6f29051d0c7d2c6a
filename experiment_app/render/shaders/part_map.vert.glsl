#version 330 core
#include "skinning.glsl"

uniform mat4 world_to_clip;
flat out uvec4 part;        // joint + 1, walker + 1 as two bytes, 255

void main() {
    vec4 x_row, y_row, z_row;
    blend_matrix(x_row, y_row, z_row);
    vec4 bound = vec4(position, 1.0);
    vec3 world = vec3(dot(x_row, bound), dot(y_row, bound), dot(z_row, bound)) + walker_place();
    int heaviest = 0;
    for (int i = 1; i < 4; i++) heaviest = weights[i] > weights[heaviest] ? i : heaviest;
    int number = walker_number() + 1;
    part = uvec4(joints[heaviest] + 1u, number & 255, (number >> 8) & 255, 255);
    gl_Position = world_to_clip * vec4(world, 1.0);
}
