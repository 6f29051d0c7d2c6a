// Light, colour and shadow shared by everything in the scene. All colours are linear light.

const float PI = 3.14159265359;

uniform vec3 sun_colour;          // linear light on a surface that faces the sun
uniform vec3 sky_colour;          // on a surface that faces up, from the sky alone
uniform vec3 bounce_colour;       // on a surface that faces down, from the ground alone
uniform vec3 eye;
uniform vec3 to_sun;
uniform mat4 world_to_light;      // to the shadow map: xy in [0, 1], z in [0, 1]
uniform vec3 light_extent;        // m covered by the shadow map: width, height, depth
uniform sampler2DShadow shadow_map;
uniform sampler2D shadow_depth;

// How far two unit vectors are from being one: 1 less their cosine, 1 beyond 90 degrees. The cosine of the same two
// may come out a little above 1, and a power of a negative number is no number at all.
float apart(vec3 one, vec3 other) {
    return 1.0 - clamp(dot(one, other), 0.0, 1.0);
}

// Sky light on a surface: bright from above, warm and dim from the ground below.
vec3 sky_light(vec3 normal) {
    return mix(bounce_colour, sky_colour, 0.5 + 0.5 * normal.y);
}

// The next direction of a sunflower's spiral: turned on by the golden angle.
vec2 turned_on(vec2 direction) {
    return vec2(direction.x * -0.737368878 - direction.y * 0.675490294,
                direction.x * 0.675490294 + direction.y * -0.737368878);
}

// How much of the sun reaches a point, 0..1; 1 and no work where it is not wanted. The penumbra widens with the distance to what casts the shadow
// (percentage-closer soft shadows, Fernando 2005), with fixed taps so that equal scenes give equal pixels.
// The loops' lengths depend on the point because software drivers run both sides of every `if`.
#if SHADOW_TAPS == 0
float sunlight(vec3 world, vec3 normal, bool wanted) {
    return 1.0;
}
#elif SHADOW_TAPS == 1
// One comparison, for points near to one another that what they find is spread between: the vertices of far people.
float sunlight(vec3 world, vec3 normal, bool wanted) {
    vec3 at = (world_to_light * vec4(world + normal * SHADOW_OFFSET, 1.0)).xyz;
    bool within = wanted && all(equal(at.xy, clamp(at.xy, 0.0, 1.0)));
    float lit = textureLod(shadow_map, vec3(at.xy, at.z - SHARPEST / light_extent.z), 0.0);
    return within ? lit : 1.0;
}
#elif BLOCKER_TAPS == 0
// The same with a soft edge of one width everywhere, for crowds, whose shadow map is coarser than any penumbra.
float sunlight(vec3 world, vec3 normal, bool wanted) {
    vec3 at = (world_to_light * vec4(world + normal * SHADOW_OFFSET, 1.0)).xyz;
    bool within = wanted && all(greaterThan(at.xy, vec2(0.0))) && all(lessThan(at.xy, vec2(1.0)));
    vec2 reach = SHARPEST / light_extent.xy;
    float depth = min(at.z, 1.0) - SHARPEST / light_extent.z;
    float lit = 0.0;
    int taps = within ? SHADOW_TAPS : 0;
    for (int i = 0; i < taps; i++) {
        vec2 corner = vec2(float(i & 1), float(i >> 1)) * 2.0 - 1.0;
        lit += textureLod(shadow_map, vec3(at.xy + corner * reach, depth), 0.0);
    }
    return within ? lit / float(SHADOW_TAPS) : 1.0;
}
#else
float sunlight(vec3 world, vec3 normal, bool wanted) {
    vec3 at = (world_to_light * vec4(world + normal * SHADOW_OFFSET, 1.0)).xyz;
    bool within = wanted && all(greaterThan(at.xy, vec2(0.0))) && all(lessThan(at.xy, vec2(1.0)));
    at.z = min(at.z, 1.0);
    vec2 per_metre = 1.0 / light_extent.xy;

    float blocker = 0.0;
    float blockers = 0.0;
    vec2 direction = vec2(1.0, 0.0);
    int taps = within ? BLOCKER_TAPS : 0;
    for (int i = 0; i < taps; i++) {
        vec2 offset = direction * sqrt((float(i) + 0.5) / float(BLOCKER_TAPS)) * SEARCH_RADIUS;
        float depth = textureLod(shadow_depth, at.xy + offset * per_metre, 0.0).r;
        float nearer = depth < at.z - 0.001 ? 1.0 : 0.0;
        blocker += nearer * depth;
        blockers += nearer;
        direction = turned_on(direction);
    }

    float gap = (at.z - blocker / max(blockers, 1.0)) * light_extent.z;
    float radius = clamp(gap * SUN_WIDTH, SHARPEST, SEARCH_RADIUS);
    float depth = at.z - radius * 0.25 / light_extent.z;
    float lit = 0.0;
    direction = vec2(0.0, 1.0);
    taps = blockers > 0.0 ? SHADOW_TAPS : 0;
    for (int i = 0; i < taps; i++) {
        vec2 offset = direction * sqrt((float(i) + 0.5) / float(SHADOW_TAPS)) * radius;
        lit += textureLod(shadow_map, vec3(at.xy + offset * per_metre, depth), 0.0);
        direction = turned_on(direction);
    }
    return blockers > 0.0 ? lit / float(SHADOW_TAPS) : 1.0;
}
#endif

// Fits light beyond white into [0, 1] without shifting hue: straight below 0.8, then a soft shoulder.
vec3 fit_to_display(vec3 colour) {
    const float start = 0.8;
    float peak = max(colour.r, max(colour.g, colour.b));
    if (peak <= start) return colour;
    float room = 1.0 - start;
    float fitted = 1.0 - room * room / (peak + room - start);
    float grey = 1.0 - 1.0 / (0.15 * (peak - fitted) + 1.0);
    return mix(colour * (fitted / peak), vec3(fitted), grey);
}
