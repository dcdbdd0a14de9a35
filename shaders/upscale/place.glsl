/*
 * place.glsl: the input position of an output pixel, identical on every driver.
 *
 * The scale is in * (1 / out), rounded twice, as in AMD's host code: with odd:odd ratios (3:5) some
 * pixels are exactly on a texel centre, where the last bit decides which four texels are the
 * closest. So the host computes it (src/device/record.c): a shader division may have an error of
 * 2.5 units, different on each device, and making it exact costs a pixel more than filtering its
 * four texels.
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
