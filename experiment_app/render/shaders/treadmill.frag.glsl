#version 330 core
#include "common.glsl"
#include "filtered.glsl"
uniform float belt_travel;        // m the belt has run, kept small by the caller in whole pattern lengths
uniform vec3 machine_place;
in vec3 world_position;
in vec3 world_normal;
in vec4 surface;
in vec2 loop;
layout(location = 0) out vec4 pixel;

// Dark rubber with a fine weave, faint scuffs and pale marks at unequal places, all running with the belt.
vec3 belt_colour(vec2 at, vec2 footprint) {
    float reach = max(footprint.x, footprint.y);
    float weave = filtered_noise(at * vec2(120.0, 120.0), reach * 120.0);
    float scuffs = filtered_noise(at * vec2(22.0, 7.0), reach * 22.0);
    vec3 rubber = vec3(0.060, 0.061, 0.064) * (1.0 + 0.16 * weave + 0.16 * scuffs);

    float cell = at.y / 0.4;
    int index = int(floor(cell));
    float middle = (float(index) + 0.3 + 0.4 * cell_number(ivec2(((index % 6) + 6) % 6, 5))) * 0.4;
    float soft = max(footprint.y, 0.0015);
    float mark = clamp(0.5 + (0.011 - abs(at.y - middle)) / soft, 0.0, 1.0) * min(1.0, 0.022 / soft);
    mark *= clamp(0.5 + (0.245 - abs(at.x)) / max(footprint.x, 0.0015), 0.0, 1.0);
    return mix(rubber, vec3(0.265, 0.265, 0.255), mark * 0.75);
}

void main() {
    vec3 normal = normalize(world_normal);
    vec3 to_eye = normalize(eye - world_position);
    vec2 at = vec2(world_position.x - machine_place.x, loop.x + belt_travel);
    vec2 footprint = max(abs(dFdx(at)), abs(dFdy(at)));
    vec3 albedo = loop.y > 0.5 ? belt_colour(at, footprint) : surface.rgb;

    float facing = max(dot(normal, to_sun), 0.0);
    float lit = sunlight(world_position, normal, facing > 0.0);
    float below = world_position.y - machine_place.y;
    float open = mix(0.55, 1.0, smoothstep(-0.16, -0.02, below));
    vec3 colour = albedo * (sky_light(normal) * open + sun_colour * facing * lit);

    float roughness = surface.a;
    vec3 halfway = normalize(to_eye + to_sun);
    float sharp = 2.0 / (roughness * roughness * roughness * roughness) - 2.0;
    float shine = pow(max(dot(normal, halfway), 0.0), sharp) * (sharp + 2.0) / 8.0 * 0.04;
    float grazing = 0.04 + 0.96 * pow(apart(normal, to_eye), 5.0);
    colour += sun_colour * shine * facing * lit + sky_colour * grazing * (1.0 - roughness) * 0.8 * open;
    pixel = vec4(fit_to_display(colour), 1.0);
}
