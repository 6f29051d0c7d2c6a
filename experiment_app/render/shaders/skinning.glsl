// Linear skinning. One row of `poses` per walker: 21 joints x 3 texels (rows of a 3x4 matrix), then
// one texel with the walker's place. The same arithmetic as skin_matrices applied with NumPy.
// INFLUENCES: joints that a vertex has at most, the first ones; all are read, for a loop that may end early costs more.

#ifndef INFLUENCES
#define INFLUENCES 4
#endif

uniform sampler2D poses;
#ifdef CROWD
in vec4 instance;  // row of `poses`, lowest and highest of the screen's noise that it is drawn in, look
#else
uniform int first_walker;
#endif

// By fours, as software drivers read attributes fastest.
in vec4 position_material;  // m in the bind pose; the material's number plus what blood takes, less than 0.5
in vec4 weights;
in uvec4 joints;

const int PLACE_TEXEL = 63;

// The row of `poses` of the walker being drawn.
int walker_row() {
#ifdef CROWD
    return int(instance.x + 0.5);
#else
    return first_walker + gl_InstanceID;
#endif
}

// The vertex in the bind pose, as a column to multiply.
vec4 bind_vertex() {
    return vec4(position_material.xyz, 1.0);
}

// The material's number.
int material_number() {
    return int(position_material.w + 0.5);
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
