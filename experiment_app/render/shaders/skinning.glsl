// Linear skinning, the same arithmetic as skin_matrices applied with NumPy. One row of `poses` per walker: of each of 21
// joints three texels (rows of a 3x4 matrix), of a walker in a crowd two (a quaternion as long as the square root of
// the walker's size, and a translation); then one texel with the walker's place.
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

#ifdef CROWD
const int PLACE_TEXEL = 42;
#else
const int PLACE_TEXEL = 63;
#endif

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

#ifdef CROWD
// Every element of a quaternion's matrix is a sum of products of two of its numbers, so the weighted mean of matrices is
// made of the weighted means of products.
void blend_matrix(out vec4 x_row, out vec4 y_row, out vec4 z_row) {
    int walker = walker_row();
    vec3 moved = vec3(0.0);
    vec4 squares = vec4(0.0);  // xx, yy, zz, ww
    vec3 mixed = vec3(0.0);    // xy, yz, zx
    vec3 with_w = vec3(0.0);   // xw, yw, zw
    for (int i = 0; i < INFLUENCES; i++) {
        int texel = int(joints[i]) * 2;
        float weight = weights[i];
        vec4 turn = texelFetch(poses, ivec2(texel, walker), 0);
        vec4 weighted = weight * turn;
        squares += weighted * turn;
        mixed += weighted.xyz * turn.yzx;
        with_w += weighted.w * turn.xyz;
        moved += weight * texelFetch(poses, ivec2(texel + 1, walker), 0).xyz;
    }
    vec3 sum = 2.0 * (mixed + with_w.zxy);
    vec3 difference = 2.0 * (mixed - with_w.zxy);
    vec3 along = squares.xyz - squares.yzx - squares.zxy + squares.w;
    x_row = vec4(along.x, difference.x, sum.z, moved.x);
    y_row = vec4(sum.x, along.y, difference.y, moved.y);
    z_row = vec4(difference.z, sum.y, along.z, moved.z);
}
#else
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
#endif

// Where the walker's matrices lead from; transforms of crowds lead into the world.
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
