// Shares of the pixels: every pixel has a number in [0, 1), evenly spread among neighbours (interleaved gradient
// noise, Jimenez 2014), and what is drawn in a share takes the pixels whose number lies within it.
bool outside(vec2 share) {
    float number = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    return number < share.x || number >= share.y;
}
