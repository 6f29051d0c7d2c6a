#version 330 core
// People small on the screen: lit at their vertices, of which there are fewer than pixels, as walker.frag lights pixels.
#include "common.glsl"
#ifdef HAZE
#include "surroundings.glsl"
#endif
#include "skinning.glsl"

const int MOST_MATERIALS = 24;
uniform mat4 world_to_clip;
uniform sampler2D palette;              // column: material, row: look; linear rgb, roughness
uniform vec4 finishes[MOST_MATERIALS];  // skin, sheen, specular strength, unused

in vec4 normal_sky;                     // of the bind pose; how much of the sky it sees

centroid out vec3 colour;             // inside the triangle also at its edges, or it may leave 0 .. 1
#ifdef FADED
flat out vec2 drawn_in;                 // of the screen's noise
#endif

void main() {
    vec4 x_row, y_row, z_row;
    blend_matrix(x_row, y_row, z_row);
    vec4 bound = bind_vertex();
    vec3 skinned = vec3(dot(x_row, bound), dot(y_row, bound), dot(z_row, bound));
    vec3 normal = normal_sky.xyz;
    vec3 turned = normalize(vec3(dot(x_row.xyz, normal), dot(y_row.xyz, normal), dot(z_row.xyz, normal)));
    vec3 world = skinned + walker_place();
    gl_Position = world_to_clip * vec4(world, 1.0);

#ifdef FADED
    drawn_in = instance.yz;
#endif
    vec3 albedo = texelFetch(palette, ivec2(material_number(), int(instance.w + 0.5)), 0).rgb;
    vec4 finish = finishes[material_number()];
    vec3 to_eye = normalize(eye - world);
    float above_ground = mix(0.62, 1.0, smoothstep(0.0, 0.35, max(skinned.y, 0.0) + 0.3 * max(turned.y, 0.0)));
    float occlusion = normal_sky.w;
    float open = occlusion * above_ground;
    float facing = max((dot(turned, to_sun) + 0.2 * finish.x) / (1.0 + 0.2 * finish.x), 0.0);
    vec3 light = sky_light(turned) * open;
    light += sun_colour * facing * sunlight(world, turned, facing > 0.0) * mix(1.0, occlusion, 0.35);
    float grazing = 1.0 - max(dot(turned, to_eye), 0.0);
    grazing *= grazing;
    colour = albedo * light + finish.y * grazing * grazing * open * sky_colour * mix(vec3(0.5), albedo, 0.7);
#ifdef HAZE
    colour = haze(colour, world - eye);
#endif
    colour = fit_to_display(colour);
}
