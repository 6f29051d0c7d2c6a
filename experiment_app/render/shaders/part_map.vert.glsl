#version 330 core
#include "skinning.glsl"

uniform mat4 world_to_clip;
const int REGION_OF[JOINT_COUNT] = REGIONS;  // 0 legs, 1 arms, 2 torso, 3 head
const int SIDE_OF[JOINT_COUNT] = SIDES;      // 1 left, -1 right, 0 neither

flat out uvec4 part;        // heaviest joint + 1, walker + 1 as two bytes, 255
flat out uvec4 heaviest;    // of every region, joint + 1; 0 where this vertex has none
out vec4 share;             // of every region in the weights, so that borders lie between vertices, not along edges
out float side;

void main() {
    vec4 x_row, y_row, z_row;
    blend_matrix(x_row, y_row, z_row);
    vec4 bound = bind_vertex();
    vec3 world = vec3(dot(x_row, bound), dot(y_row, bound), dot(z_row, bound)) + walker_place();
    share = vec4(0.0);
    side = 0.0;
    heaviest = uvec4(0u);
    vec4 most = vec4(0.0);
    int first = 0;
    for (int i = 0; i < 4; i++) {
        int joint = int(joints[i]);
        int region = REGION_OF[joint];
        share[region] += weights[i];
        side += weights[i] * float(SIDE_OF[joint]);
        if (weights[i] > most[region]) {
            most[region] = weights[i];
            heaviest[region] = joints[i] + 1u;
        }
        first = weights[i] > weights[first] ? i : first;
    }
    int number = walker_number() + 1;
    part = uvec4(joints[first] + 1u, number & 255, (number >> 8) & 255, 255);
    gl_Position = world_to_clip * vec4(world, 1.0);
}
