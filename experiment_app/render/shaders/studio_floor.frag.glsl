#version 330 core
#include "common.glsl"
#include "surroundings.glsl"
#include "filtered.glsl"
in vec3 world_position;
uniform vec4 machine;             // m: centre x, centre z, half width, half length of the treadmill
layout(location = 0) out vec4 pixel;

void main() {
    vec2 at = world_position.xz;
    vec2 footprint = max(abs(dFdx(at)), abs(dFdy(at)));
    float reach = max(footprint.x, footprint.y);
    float grain = filtered_noise(at * 55.0, reach * 55.0);
    vec3 floor_colour = vec3(0.400, 0.400, 0.395) * (1.0 + 0.015 * grain);

    // Sky light that the machine takes from the floor beside it.
    vec2 outside = max(abs(at - machine.xy) - machine.zw, 0.0);
    float distance = length(outside);
    float open = 1.0 - 0.62 * exp(-distance * 9.0) - 0.18 * exp(-distance * 2.2);

    vec3 up = vec3(0.0, 1.0, 0.0);
    vec3 light = sky_colour * open + sun_colour * to_sun.y * sunlight(world_position, up, true);
    pixel = vec4(fit_to_display(haze(floor_colour * light, world_position - eye)), 1.0);
}
