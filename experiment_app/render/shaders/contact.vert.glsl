#version 330 core
// A square on the ground under each walker.
uniform mat4 world_to_clip;
uniform sampler2D occluders;
uniform float lift;
out vec3 world_position;
flat out int walker;

void main() {
    walker = gl_InstanceID;
    vec4 place = texelFetch(occluders, ivec2(0, walker), 0);  // xyz m, half size of the square m
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    world_position = place.xyz + vec3(corner.x * place.w, 0.0, corner.y * place.w);
    gl_Position = world_to_clip * vec4(world_position + vec3(0.0, lift, 0.0), 1.0);
}
