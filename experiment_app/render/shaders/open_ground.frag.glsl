#version 330 core
#include "common.glsl"
#include "surroundings.glsl"
#include "filtered.glsl"
in vec3 world_position;
layout(location = 0) out vec4 pixel;

const float ROWS_PER_METRE = 1.9;
const float SLABS_PER_METRE = 1.25;
const float JOINT = 0.006;        // m

// Rows of slabs across the way, of unequal depth (0.40 to 0.75 m) so that no steady beat competes with the steps.
float row_of(float z) {
    return z * ROWS_PER_METRE + 0.16 * sin(z * 1.31) + 0.14 * sin(z * 2.17 + 1.0);
}

float rows_per_metre(float z) {
    return ROWS_PER_METRE + 0.2096 * cos(z * 1.31) + 0.3038 * cos(z * 2.17 + 1.0);
}

float slab_tone(int row, float x, float width) {
    float shift = cell_number(ivec2(row, 77));
    int first;
    float second_share;
    touched_cells(x + shift, width, first, second_share);
    return mix(cell_number(ivec2(row, first)), cell_number(ivec2(row, first + 1)), second_share);
}

void main() {
    vec2 at = world_position.xz;
    vec2 footprint = max(abs(dFdx(at)), abs(dFdy(at)));
    float reach = max(footprint.x, footprint.y);

    float density = rows_per_metre(at.y);
    float row = row_of(at.y);
    float row_width = footprint.y * density;
    float slab = at.x * SLABS_PER_METRE;
    float slab_width = footprint.x * SLABS_PER_METRE;

    int first_row;
    float second_share;
    touched_cells(row, row_width, first_row, second_share);
    float here = slab_tone(first_row, slab, slab_width);
    float there = slab_tone(first_row + 1, slab, slab_width);
    float tone = mix(mix(here, there, second_share) * 2.0 - 1.0, 0.0, smoothstep(0.6, 2.2, max(row_width, slab_width)));

    float across = filtered_lines(row, JOINT * density, row_width);
    int own_row = int(floor(row));
    float along = filtered_lines(slab + cell_number(ivec2(own_row, 77)), JOINT * SLABS_PER_METRE, slab_width);
    float joint = 1.0 - (1.0 - across) * (1.0 - along);

    float grain = 0.5 * filtered_noise(at * 9.0, reach * 9.0) + 0.5 * filtered_noise(at * 41.0, reach * 41.0);
    float speckle = filtered_noise(at * 160.0 + 7.0, reach * 160.0);
    vec3 stone = vec3(0.352, 0.340, 0.318) * (1.0 + 0.085 * tone + 0.045 * grain + 0.05 * speckle);
    stone = mix(stone, vec3(0.185, 0.175, 0.160), joint * 0.85);
#ifdef HALF_STREET
    // Gutters along the kerbs: a strip of darker stone, dirtier towards the edge.
    stone *= vec3(0.80, 0.81, 0.83);
    float inside = HALF_STREET - abs(at.x);
    float gutter = 1.0 - clamp((inside - 0.35) / max(footprint.x, 0.01) + 0.5, 0.0, 1.0);
    float setts = filtered_lines(at.y * 2.5, 0.03, footprint.y * 2.5);
    vec3 strip = mix(vec3(0.205, 0.200, 0.192) * (1.0 + 0.04 * grain), vec3(0.16), 0.6 * setts);
    stone = mix(stone, strip * (0.82 + 0.18 * smoothstep(0.0, 0.2, inside)), gutter);
#endif

    vec3 up = vec3(0.0, 1.0, 0.0);
    vec3 light = sky_colour + sun_colour * to_sun.y * sunlight(world_position, up, true);
    pixel = vec4(fit_to_display(haze(stone * light, world_position - eye)), 1.0);
}
