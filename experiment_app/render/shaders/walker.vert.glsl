#version 330 core
#include "skinning.glsl"

uniform mat4 world_to_clip;

in vec4 normal_sky;         // of the bind pose; how much of the sky it sees

out vec3 world_position;
out vec3 world_normal;
centroid out float sky_seen;
out vec2 sole;              // metres above the walked surface, kept for contact darkening
flat out int surface;
#ifdef CROWD
flat out int look;
flat out vec2 drawn_in;     // of the screen's noise
#else
out vec3 bind_place;         // m, where on the body in its bind pose
out float blush;             // share of green and blue light that blood under the skin takes
#endif
#ifdef TEXTURED
in vec2 picture_at;
out vec2 picture_place;
#endif

void main() {
    vec4 x_row, y_row, z_row;
    blend_matrix(x_row, y_row, z_row);
    vec4 bound = bind_vertex();
    vec3 skinned = vec3(dot(x_row, bound), dot(y_row, bound), dot(z_row, bound));
    vec3 normal = normal_sky.xyz;
    world_normal = vec3(dot(x_row.xyz, normal), dot(y_row.xyz, normal), dot(z_row.xyz, normal));
    world_position = skinned + walker_place();
    sole = vec2(skinned.y, 0.0);
    sky_seen = normal_sky.w;
    surface = material_number();
#ifdef CROWD
    look = int(instance.w + 0.5);
    drawn_in = instance.yz;
#else
    bind_place = bound.xyz;
    blush = position_material.w - float(surface);
#endif
#ifdef TEXTURED
    picture_place = picture_at;
#endif
    gl_Position = world_to_clip * vec4(world_position, 1.0);
}
