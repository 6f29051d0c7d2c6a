#version 330 core
// One rectangle of a page as two triangles, with room around it for the soft edge. Pixels from the top left.
uniform vec2 size;    // of the picture, pixels
uniform vec2 corner;  // of the picture on the page, pixels

in vec4 rectangle;    // x, y, width, height
in vec4 fill;
in vec4 edge;
in vec3 form;         // radius, border, softness; pixels

out vec2 position;
flat out vec4 box;
flat out vec4 inside;
flat out vec4 outline;
flat out vec3 shape;

void main() {
    vec2 unit = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    float room = form.z + 1.0;
    position = rectangle.xy - room + unit * (rectangle.zw + 2.0 * room);
    box = rectangle;
    inside = fill;
    outline = edge;
    shape = form;
    vec2 at = (position - corner) / size * 2.0 - 1.0;
    gl_Position = vec4(at.x, -at.y, 0.0, 1.0);
}
