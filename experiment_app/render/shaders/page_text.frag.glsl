#version 330 core
// Text in one colour through the sheet that says how much of every pixel is ink.
uniform sampler2D sheet;

in vec2 position;
flat in vec4 box;
flat in vec4 inside;

out vec4 colour;

void main() {
    if (any(lessThan(position, box.xy)) || any(greaterThanEqual(position, box.xy + box.zw))) discard;
    float ink = texelFetch(sheet, ivec2(gl_FragCoord.xy), 0).r;
    colour = vec4(inside.rgb, 1.0) * (inside.a * ink);
}
