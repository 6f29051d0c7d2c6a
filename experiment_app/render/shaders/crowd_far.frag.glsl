#version 330 core
#ifdef FADED
#include "dither.glsl"
flat in vec2 drawn_in;
#endif
centroid in vec3 colour;
layout(location = 0) out vec4 pixel;

void main() {
#ifdef FADED
    if (outside(drawn_in)) discard;
#endif
    pixel = vec4(colour, 1.0);
}
