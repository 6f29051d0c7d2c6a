#version 330 core
flat in uvec4 part;
layout(location = 0) out vec4 pixel;

void main() {
    pixel = vec4(part) / 255.0;
}
