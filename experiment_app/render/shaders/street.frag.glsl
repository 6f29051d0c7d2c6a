#version 330 core
#include "common.glsl"
#include "surroundings.glsl"
#include "filtered.glsl"
in vec3 world_position;
in vec3 world_normal;
flat in vec4 surface;    // linear rgb, kind: 0 pavement, 1 kerb, 2 a house's front, 3 plain wall or roof
in vec2 at_wall;         // m along and up
flat in vec2 cells;      // m, width of a bay, height of a floor
layout(location = 0) out vec4 pixel;

// Share of a pixel's footprint within a span of every whole-numbered cell; middle, size: parts of a cell.
float span(float at, float middle, float size, float width) {
    return filtered_lines(at + 0.5 - middle + 0.5, size, width);
}

// Rows of windows in plaster: pale frames, panes that mirror the sky, a plinth, a line above each floor, a cornice.
vec3 front(vec3 plaster, vec2 footprint, vec3 to_eye, vec3 normal) {
    float bay = at_wall.x / cells.x;
    float floor_up = at_wall.y / cells.y;
    vec2 width = footprint / cells;
    float lowest = 1.0 - clamp((floor_up - 1.0) / max(width.y, 1e-3) + 0.5, 0.0, 1.0);
    float pane_width = mix(0.40, 0.56, lowest);
    float pane = span(bay, 0.5, pane_width, width.x) * span(floor_up, 0.53, 0.52, width.y);
    float framed = span(bay, 0.5, pane_width + 0.09, width.x) * span(floor_up, 0.53, 0.60, width.y);
    float bars = span(bay, 0.5, 0.025, width.x) + span(floor_up, 0.63, 0.018, width.y);

    float grain = filtered_noise(at_wall * 7.0, max(footprint.x, footprint.y) * 7.0);
    vec3 colour = plaster * (1.0 + 0.02 * grain);
    float line = filtered_lines(floor_up, 0.05, width.y) * step(0.5, floor_up);
    colour *= 1.0 - 0.10 * line;
    colour = mix(colour, vec3(0.36, 0.35, 0.335), 1.0 - clamp((at_wall.y - 0.6) / max(footprint.y, 0.02) + 0.5, 0.0, 1.0));
    colour = mix(colour, min(plaster * 1.18, vec3(0.66)), framed);
    vec3 mirrored = background(normalize(reflect(-to_eye, normal) + vec3(0.0, 0.12, 0.0)));
    vec3 glass = mix(vec3(0.075, 0.085, 0.095), mirrored, 0.22 + 0.30 * pow(1.0 - min(abs(dot(normal, to_eye)), 1.0), 3.0));
    colour = mix(colour, mix(glass, plaster * 1.05, clamp(bars, 0.0, 1.0) * 0.7), pane);

    // A door in every house's second bay, where its lowest window would be.
    vec2 in_door = vec2(abs(bay - 1.5) * cells.x - 0.55, at_wall.y - 2.35);
    vec2 covered = clamp(0.5 - in_door / max(footprint, vec2(0.01)), 0.0, 1.0);
    vec2 cased = clamp(0.5 - (in_door - 0.16) / max(footprint, vec2(0.01)), 0.0, 1.0);
    float lowest_pane = lowest * clamp(0.5 - (abs(bay - 1.5) - 0.5) / max(width.x, 1e-3), 0.0, 1.0);
    colour = mix(colour, plaster, lowest_pane * step(0.6, at_wall.y));
    colour = mix(colour, min(plaster * 1.18, vec3(0.66)), cased.x * cased.y);
    float panels = filtered_lines(at_wall.y / 0.78, 0.06, footprint.y / 0.78);
    return mix(colour, vec3(0.155, 0.125, 0.100) * (1.0 - 0.3 * panels), covered.x * covered.y);
}

vec3 paved(vec3 stone, vec2 footprint) {
    vec2 slab = world_position.zx * vec2(1.0 / 0.6, 1.0 / 0.6);
    vec2 width = footprint.yx / 0.6;
    float joint = 1.0 - (1.0 - filtered_lines(slab.x, 0.012, width.x)) * (1.0 - filtered_lines(slab.y, 0.012, width.y));
    float reach = max(footprint.x, footprint.y);
    float grain = filtered_noise(world_position.xz * 9.0, reach * 9.0);
    return mix(stone * (1.0 + 0.05 * grain), vec3(0.185, 0.175, 0.160), joint * 0.7);
}

void main() {
    vec3 normal = normalize(world_normal);
    vec3 to_eye = normalize(eye - world_position);
    vec2 ground = max(abs(dFdx(world_position.xz)), abs(dFdy(world_position.xz)));
    vec2 wall = max(abs(dFdx(at_wall)), abs(dFdy(at_wall)));
    float kind = surface.a;
    vec3 albedo = surface.rgb;
    float open = 1.0;
    if (kind < 0.5) {
        albedo = paved(albedo, ground);
    } else if (kind < 1.5) {
        albedo = mix(albedo, vec3(0.20), 0.6 * filtered_lines(world_position.z, 0.008, ground.y));
        open = normal.y > 0.5 ? 1.0 : 0.85;
    } else if (kind < 2.5) {
        albedo = front(albedo, wall, to_eye, normal);
        open = mix(0.72, 1.0, smoothstep(0.0, 5.0, at_wall.y));
    }
    float facing = max(dot(normal, to_sun), 0.0);
    float lit = sunlight(world_position, normal, facing > 0.0);
    vec3 light = sky_light(normal) * open + sun_colour * facing * lit;
    pixel = vec4(fit_to_display(haze(albedo * light, world_position - eye)), 1.0);
}
