#version 330 core
// Copies a finished picture pixel by pixel.
uniform sampler2D picture;
uniform vec4 place;   // x, y, width, height on the page; pixels from the top left
uniform vec2 window;  // pixels

out vec4 colour;

void main() {
    vec2 corner = vec2(place.x, window.y - place.y - place.w);
    colour = texelFetch(picture, ivec2(gl_FragCoord.xy - corner), 0);
}
