#version 330 core
#include "common.glsl"
#ifdef HAZE
#include "surroundings.glsl"
#endif
#ifdef FADED
#include "dither.glsl"
#endif
#ifndef CROWD
#include "fabric.glsl"
in vec3 bind_place;  // m, where on the body
in float blush;      // share of green and blue light that blood under the skin takes
#endif

const int MOST_MATERIALS = 24;
#ifdef CROWD
uniform sampler2D palette;              // column: material, row: look; linear rgb, roughness
flat in int look;
flat in vec2 drawn_in;
#else
uniform vec4 colours[MOST_MATERIALS];   // linear rgb, roughness
#endif
uniform vec4 finishes[MOST_MATERIALS];  // skin, sheen, specular strength, fabric

in vec3 world_position;
in vec3 world_normal;
centroid in float sky_seen;
in vec2 sole;
flat in int surface;
#ifdef TEXTURED
uniform sampler2DArray pictures;  // linear light
uniform vec4 covers[MOST_MATERIALS];  // layer of its picture or -1, 0 opaque 1 mask 2 blend, least alpha, alpha factor
in vec2 picture_place;
#endif

layout(location = 0) out vec4 pixel;

// Light that enters skin comes out past the terminator, red farthest (after Jimenez et al. 2015, simplified).
vec3 diffuse_sun(float facing, float lit, float skin) {
    vec3 wrap = skin * vec3(0.34, 0.16, 0.10);
    vec3 bled = clamp((vec3(facing) + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0, 1.0);
    vec3 softened = mix(vec3(lit), pow(vec3(lit), vec3(0.75, 1.0, 1.05)), skin);
    return bled * softened;
}

// Microfacet highlight: GGX with the visibility fit of Lazarov 2011, dielectric reflectance 0.04.
float highlight(vec3 normal, vec3 to_eye, vec3 to_light, float roughness) {
    vec3 halfway = normalize(to_eye + to_light);
    float alpha = roughness * roughness;
    float n_h = max(dot(normal, halfway), 0.0);
    float v_h = clamp(dot(to_eye, halfway), 0.0, 1.0);
    float spread = n_h * n_h * (alpha * alpha - 1.0) + 1.0;
    float distribution = alpha * alpha / (PI * spread * spread);
    float fresnel = 0.04 + 0.96 * pow(1.0 - v_h, 5.0);
    return distribution * fresnel / (4.0 * mix(v_h * v_h, 1.0, alpha) + 0.0001);
}

void main() {
#ifdef FADED
    if (outside(drawn_in)) discard;
#endif
#ifdef CROWD
    vec4 paint = texelFetch(palette, ivec2(surface, look), 0);
#else
    vec4 paint = colours[surface];
#endif
    vec3 albedo = paint.rgb;
    float alpha = 1.0;
#ifdef TEXTURED
    vec4 cover = covers[surface];
    vec4 picture = cover.x >= 0.0 ? texture(pictures, vec3(picture_place, cover.x)) : vec4(1.0);
    albedo *= picture.rgb;
    alpha = cover.y > 0.0 ? picture.a * cover.w : 1.0;
    if (alpha < cover.z) discard;
    if (cover.y < 1.5) alpha = 1.0;
#endif
    float roughness = clamp(paint.a, 0.2, 1.0);
    vec4 finish = finishes[surface];

    vec3 to_eye = normalize(eye - world_position);
    vec3 normal = normalize(world_normal);
#ifndef CROWD
    albedo.gb *= 1.0 - blush;
    normal = fabric(finish.w, bind_place, world_position, normal, albedo);
#endif
#ifdef TEXTURED
    if (!gl_FrontFacing) normal = -normal;
#endif
    float facing = dot(normal, to_sun);
    float lit = sunlight(world_position, normal, facing > -0.34 * finish.x);

    // The ground hides the lower half of the sky from what is close to it.
    float height = max(sole.x, 0.0);
    float above_ground = mix(0.62, 1.0, smoothstep(0.0, 0.35, height + 0.3 * max(normal.y, 0.0)));
    float open = clamp(sky_seen, 0.0, 1.0) * above_ground;

    vec3 light = sky_light(normal) * mix(vec3(open), pow(vec3(open), vec3(0.8, 1.0, 1.0)), finish.x);
    light += sun_colour * diffuse_sun(facing, lit, finish.x) * mix(1.0, clamp(sky_seen, 0.0, 1.0), 0.35);
    vec3 colour = albedo * light;

    float grazing = pow(apart(normal, to_eye), 4.0);
    colour += finish.y * grazing * open * sky_light(reflect(-to_eye, normal)) * mix(vec3(0.5), albedo, 0.7);
    vec3 shine = sun_colour * PI * highlight(normal, to_eye, to_sun, roughness) * max(facing, 0.0) * lit;
    float smoothness = (1.0 - roughness) * (1.0 - roughness);
    shine += sky_light(reflect(-to_eye, normal)) * open * smoothness * (0.04 + 0.4 * grazing * smoothness);
    colour += finish.z * shine;

#ifdef HAZE
    colour = haze(colour, world_position - eye);
#endif
    pixel = vec4(fit_to_display(colour), alpha);
}
