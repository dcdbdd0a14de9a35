/*
 * place.glsl: where a pixel of the output lies in the input, the same on every driver.
 *
 * The scale is in * (1 / out), rounded twice, as AMD's host code has it: with odd:odd ratios (3:5)
 * some pixels lie exactly on a texel centre, where its last bit decides which four texels are the
 * nearest. So the host computes it (src/device/record.c): a division of a shader may be 2.5 units off,
 * differently on each device, and to make it exact takes a pixel more than its four texels do.
 */
#ifndef MASU_PLACE_GLSL
#define MASU_PLACE_GLSL

struct masu_place {
    ivec2 texel; /* the upper left one of the four around it */
    vec2 p;      /* from its centre, 0 to 1 */
};

/* Pixel centre to texel centre, rounded in AMD's order. */
masu_place masu_place_of(uvec2 at, vec2 scale)
{
    precise vec2 offset = 0.5 * scale - 0.5;
    precise vec2 moved = vec2(at) * scale;
    precise vec2 p = moved + offset;
    precise vec2 whole = floor(p);
    p = p - whole;
    return masu_place(ivec2(whole), p);
}

#endif
