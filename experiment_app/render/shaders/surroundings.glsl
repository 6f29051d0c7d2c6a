// What lies behind everything, by direction; and the haze that lets the ground melt into it.

#ifndef HAZE_REACH
#define HAZE_REACH 62.0  // m
#endif

#ifdef OPEN_GROUND
const vec3 HORIZON = vec3(0.735, 0.765, 0.785);
const vec3 ZENITH = vec3(0.330, 0.455, 0.640);

vec3 background(vec3 direction) {
    float height = max(direction.y, 0.0);
    vec3 sky = mix(HORIZON, ZENITH, 1.0 - exp(-height * 2.6));
    float towards_sun = max(dot(normalize(direction.xz + 1e-6), normalize(to_sun.xz)), 0.0);
    return sky + vec3(0.05, 0.035, 0.01) * towards_sun * exp(-height * 5.0);
}

vec3 haze(vec3 colour, vec3 offset) {
    float distance = length(offset);
    float clear = exp(-pow(distance / HAZE_REACH, 1.35));
    return mix(background(vec3(offset.x, 0.0, offset.z) / distance), colour, clear);
}
#else
const vec3 WALL = vec3(0.640, 0.645, 0.640);
const vec3 WALL_ABOVE = vec3(0.430, 0.440, 0.450);

vec3 background(vec3 direction) {
    return mix(WALL, WALL_ABOVE, smoothstep(-0.1, 0.75, direction.y));
}

// A studio's cove: the floor turns into the wall without an edge.
vec3 haze(vec3 colour, vec3 offset) {
    float away = smoothstep(5.0, 22.0, length(offset));
    return mix(colour, background(normalize(offset)), away);
}
#endif
