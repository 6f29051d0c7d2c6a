#version 330 core
// A finished picture where it belongs in the window.
uniform vec4 place;   // x, y, width, height on the page; pixels from the top left
uniform vec2 window;  // pixels

void main() {
    vec2 unit = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 at = (place.xy + unit * place.zw) / window * 2.0 - 1.0;
    gl_Position = vec4(at.x, -at.y, 0.0, 1.0);
}
