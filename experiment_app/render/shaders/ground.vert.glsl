#version 330 core
// A square of ground centred under the eye.
uniform mat4 world_to_clip;
uniform vec3 eye_position;
uniform float ground_height;
const float HALF_SIZE = 3000.0;
out vec3 world_position;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    world_position = vec3(eye_position.x + corner.x * HALF_SIZE, ground_height, eye_position.z + corner.y * HALF_SIZE);
    gl_Position = world_to_clip * vec4(world_position, 1.0);
}
