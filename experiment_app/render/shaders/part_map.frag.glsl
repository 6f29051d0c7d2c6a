#version 330 core
// The region with the largest share here, and in it the joint that the triangle's own vertex carries most. Where that
// vertex has none of the region, the joint next to the region's border stands in: hip, shoulder, chest or neck.
flat in uvec4 part;
flat in uvec4 heaviest;
in vec4 share;
in float side;
layout(location = 0) out vec4 pixel;

const uvec4 AT_BORDER_LEFT = LEFT_BORDER;    // joint + 1 of every region
const uvec4 AT_BORDER_RIGHT = RIGHT_BORDER;

void main() {
    int region = 0;
    for (int i = 1; i < 4; i++) region = share[i] > share[region] ? i : region;
    uint joint = heaviest[region];
    if (joint == 0u) joint = side >= 0.0 ? AT_BORDER_LEFT[region] : AT_BORDER_RIGHT[region];
    pixel = vec4(uvec4(joint, part.yzw)) / 255.0;
}
