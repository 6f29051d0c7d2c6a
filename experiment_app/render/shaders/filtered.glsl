// Patterns averaged over the footprint of a pixel, so that they neither crawl nor make moire.

// A repeatable number in [0, 1) for a whole-numbered cell (PCG, Jarzynski and Olano 2020); equal on every driver.
float cell_number(ivec2 cell) {
    uint state = uint(cell.x) * 747796405u + uint(cell.y) * 2891336453u + 12345u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return float(((word >> 22u) ^ word) >> 8u) * (1.0 / 16777216.0);
}

// Share of [at - width/2, at + width/2] covered by a line of the given thickness round every whole number.
float filtered_lines(float at, float thickness, float width) {
    float footprint = max(width, 1e-4);
    float left = at - 0.5 * footprint + 0.5 * thickness;
    float right = left + footprint;
    float covered = floor(right) * thickness + min(fract(right), thickness)
                  - floor(left) * thickness - min(fract(left), thickness);
    return clamp(covered / footprint, 0.0, 1.0);
}

// The one or two cells that a footprint narrower than a cell touches: first cell, and the second one's share.
void touched_cells(float at, float width, out int first, out float share_of_second) {
    float footprint = clamp(width, 1e-4, 1.0);
    float left = at - 0.5 * footprint;
    first = int(floor(left));
    share_of_second = clamp((left + footprint - float(first) - 1.0) / footprint, 0.0, 1.0);
}

// Smooth noise of unit cell size in [-1, 1], fading to its mean 0 before it would alias.
float filtered_noise(vec2 at, float width) {
    float strength = 1.0 - smoothstep(0.35, 0.9, width);
    if (strength <= 0.0) return 0.0;
    ivec2 cell = ivec2(floor(at));
    vec2 part = at - vec2(cell);
    part = part * part * (3.0 - 2.0 * part);
    float near = mix(cell_number(cell), cell_number(cell + ivec2(1, 0)), part.x);
    float far = mix(cell_number(cell + ivec2(0, 1)), cell_number(cell + ivec2(1, 1)), part.x);
    return strength * (mix(near, far, part.y) * 2.0 - 1.0);
}
