#version 330 core
// One triangle over the whole picture, at the far plane; no buffer needed.
out vec2 screen;  // 0..1 from bottom left

void main() {
    screen = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(screen * 2.0 - 1.0, 1.0, 1.0);
}
