// Linear skinning. One row of `poses` per walker: 21 joints x 3 texels (rows of a 3x4 matrix), then
// one texel with the walker's place. The same arithmetic as skin_matrices applied with NumPy.
// INFLUENCES: joints that a vertex has at most, the first ones; all are read, for a loop that may end early costs more.

#ifndef INFLUENCES
#define INFLUENCES 4
#endif

uniform sampler2D poses;
uniform int first_walker;
#ifdef CROWD
uniform sampler2D instances;  // per instance: row of `poses`, then the shares of the screen's noise it is drawn in
#endif

in vec3 position;
in uvec4 joints;
in vec4 weights;

const int PLACE_TEXEL = 63;

// The row of `poses` of the walker being drawn.
int walker_row() {
#ifdef CROWD
    return int(texelFetch(instances, ivec2(first_walker + gl_InstanceID, 0), 0).x + 0.5);
#else
    return first_walker + gl_InstanceID;
#endif
}

void blend_matrix(out vec4 x_row, out vec4 y_row, out vec4 z_row) {
    int walker = walker_row();
    x_row = vec4(0.0);
    y_row = vec4(0.0);
    z_row = vec4(0.0);
    for (int i = 0; i < INFLUENCES; i++) {
        int texel = int(joints[i]) * 3;
        float weight = weights[i];
        x_row += weight * texelFetch(poses, ivec2(texel, walker), 0);
        y_row += weight * texelFetch(poses, ivec2(texel + 1, walker), 0);
        z_row += weight * texelFetch(poses, ivec2(texel + 2, walker), 0);
    }
}

// Where the walker's matrices lead from; those of crowds lead into the world.
vec3 walker_place() {
#ifdef CROWD
    return vec3(0.0);
#endif
    return texelFetch(poses, ivec2(PLACE_TEXEL, walker_row()), 0).xyz;
}

// The walker's number in the scene, kept beside its place.
int walker_number() {
    return int(texelFetch(poses, ivec2(PLACE_TEXEL, walker_row()), 0).w + 0.5);
}
