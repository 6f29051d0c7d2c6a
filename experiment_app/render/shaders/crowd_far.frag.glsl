#version 330 core
#include "dither.glsl"
centroid in vec3 colour;
flat in vec2 drawn_in;
layout(location = 0) out vec4 pixel;

void main() {
#ifdef FADED
    if (outside(drawn_in)) discard;
#endif
    pixel = vec4(colour, 1.0);
}
