#version 330 core
uniform mat4 world_to_clip;
uniform float first_z;   // m, where the first stretch begins
uniform float stretch;   // m, of one stretch
uniform float side;      // 1 at +X, -1 mirrored
in vec3 position;
in vec3 normal;
in vec4 paint;           // linear rgb, kind
in vec4 wall;            // m along and up, width of a bay, height of a floor
out vec3 world_position;
out vec3 world_normal;
flat out vec4 surface;
out vec2 at_wall;
flat out vec2 cells;

void main() {
    world_position = vec3(position.x * side, position.y, position.z + first_z + float(gl_InstanceID) * stretch);
    world_normal = vec3(normal.x * side, normal.yz);
    surface = paint;
    at_wall = wall.xy;
    cells = wall.zw;
    gl_Position = world_to_clip * vec4(world_position, 1.0);
}
