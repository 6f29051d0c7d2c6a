#version 330 core
// A line between two places with round ends, as wide on the screen as asked wherever it is; a dot is a line of no
// length.
uniform mat4 world_to_clip;
uniform vec2 size;       // of the picture, pixels

in vec3 from;
in vec3 to;
in float width;          // pixels

out vec2 position;       // pixels
flat out vec2 start;
flat out vec2 end;
flat out float radius;

vec2 pixels(vec4 clip) {
    return (clip.xy / clip.w * 0.5 + 0.5) * size;
}

void main() {
    vec4 clip_from = world_to_clip * vec4(from, 1.0);
    vec4 clip_to = world_to_clip * vec4(to, 1.0);
    start = pixels(clip_from);
    end = pixels(clip_to);
    radius = 0.5 * width;
    vec2 along = end - start;
    along = dot(along, along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    bool first = (gl_VertexID & 1) == 0;
    float side = gl_VertexID < 2 ? -1.0 : 1.0;
    float room = radius + 1.0;
    position = (first ? start - along * room : end + along * room) + across * side * room;
    vec4 own = first ? clip_from : clip_to;
    bool behind = clip_from.w <= 0.0 || clip_to.w <= 0.0;
    gl_Position = behind ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(position / size * 2.0 - 1.0, own.z / own.w, 1.0);
}
