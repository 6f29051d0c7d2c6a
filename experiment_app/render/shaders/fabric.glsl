// What a body's surface looks like from near by: cloth is a little rumpled and woven, skin is not of one colour, hair is
// of strands.
// Everything is a function of the place on the body in its bind pose (metres), so that it moves with the walker.

uniform float close_up;  // 1 for walkers near enough that it can be seen, else 0

float hashed(vec3 cell) {
    cell = fract(cell * vec3(0.1031, 0.1030, 0.0973));
    cell += dot(cell, cell.yxz + 33.33);
    return fract((cell.x + cell.y) * cell.z);
}

// Value noise in [0, 1] and its gradient: xyz the gradient, w the value.
vec4 noise(vec3 place) {
    vec3 cell = floor(place), t = place - cell;
    vec3 s = t * t * t * (t * (6.0 * t - 15.0) + 10.0), ds = 30.0 * t * t * (t * (t - 2.0) + 1.0);
    float a = hashed(cell), b = hashed(cell + vec3(1, 0, 0)), c = hashed(cell + vec3(0, 1, 0));
    float d = hashed(cell + vec3(1, 1, 0)), e = hashed(cell + vec3(0, 0, 1)), f = hashed(cell + vec3(1, 0, 1));
    float g = hashed(cell + vec3(0, 1, 1)), h = hashed(cell + vec3(1, 1, 1));
    float k1 = b - a, k2 = c - a, k3 = e - a, k4 = a - b - c + d, k5 = a - c - e + g, k6 = a - b - e + f;
    float k7 = -a + b + c - d + e - f - g + h;
    vec3 gradient = ds * vec3(k1 + k4 * s.y + k6 * s.z + k7 * s.y * s.z,
                              k2 + k4 * s.x + k5 * s.z + k7 * s.x * s.z,
                              k3 + k5 * s.y + k6 * s.x + k7 * s.x * s.y);
    float value = a + k1 * s.x + k2 * s.y + k3 * s.z + k4 * s.x * s.y + k5 * s.y * s.z + k6 * s.z * s.x
        + k7 * s.x * s.y * s.z;
    return vec4(gradient, value);
}

// The normal of a surface raised by a height whose gradient (per m, bind pose) is given (Mikkelsen 2010).
vec3 raised(vec3 normal, vec3 gradient, vec3 place, vec3 world) {
    vec3 across = dFdx(world), along = dFdy(world);
    vec3 first = cross(along, normal), second = cross(normal, across);
    float area = dot(across, first);
    vec3 slope = sign(area) * (dot(gradient, dFdx(place)) * first + dot(gradient, dFdy(place)) * second);
    return normalize(abs(area) * normal - slope);
}

const float BEHIND = 0.0713;  // of the knot's height: how far behind the ear canals it lies
const float HEAD = 0.09;      // m, roughly a head's radius

// Coordinates in which a strand of hair runs along y: from the crown, or to the knot at this height (m) and down the tail.
vec3 along_strands(vec3 place, float knot) {
    vec3 from = knot > 0.0 ? (place - vec3(0.0, knot, -BEHIND * knot)).xzy : place - vec3(0.0, 0.0, -0.01);
    if (knot > 0.0 && from.y < 0.0) return place;
    float radius = max(length(from.xz), 0.004);
    vec2 round_it = from.xz * (HEAD / radius);
    return vec3(round_it.x, from.y - radius, round_it.y);
}

// kind: 1 knitted, 2 woven twill, 3 skin, 4 hair, 5 and more hair that is tied at kind - 5 m above the ground, 0 anything
// else. Changes the albedo and returns the normal.
vec3 fabric(float kind, vec3 place, vec3 world, vec3 normal, inout vec3 albedo) {
    if (close_up == 0.0 || kind == 0.0) return normal;
    float pixel = max(length(dFdx(place)), length(dFdy(place)));  // m
    if (kind > 3.5) {
        vec3 lie = along_strands(place, kind - 5.0);
        float seen = clamp(1.5 - 450.0 * pixel, 0.0, 1.0);
        float strand = noise(lie * vec3(620.0, 9.0, 620.0)).w - 0.5;
        vec3 wide = vec3(150.0, 7.0, 150.0);
        vec4 tress = noise(lie * wide);
        float wide_seen = clamp(1.5 - 150.0 * pixel, 0.0, 1.0);
        albedo *= 1.0 + 0.5 * seen * strand + 0.45 * wide_seen * (tress.w - 0.5);
        return raised(normal, 0.0012 * wide_seen * wide * tress.xyz, lie, world);
    }
    if (kind > 2.5) {
        float seen = clamp(1.5 - 120.0 * pixel, 0.0, 1.0);
        albedo *= 1.0 + seen * (noise(place * 55.0).w - 0.5) * vec3(0.05, 0.11, 0.12);
        return normal;
    }
    float grain = noise(place * vec3(260.0, 190.0, 260.0)).w - 0.5;
    albedo *= 1.0 + 0.08 * grain * clamp(1.6 - 350.0 * pixel, 0.0, 1.0);
    if (kind > 1.5) {
        float thread = sin(1300.0 * (place.y + 0.8 * (place.x + place.z)));
        albedo *= 1.0 + 0.10 * thread * clamp(1.4 - 700.0 * pixel, 0.0, 1.0);
    }
    vec3 wide = vec3(17.0, 26.0, 17.0);
    vec3 gradient = wide * noise(place * wide + 7.0).xyz;
    return raised(normal, 0.0016 * gradient * clamp(1.5 - 100.0 * pixel, 0.0, 1.0), place, world);
}
