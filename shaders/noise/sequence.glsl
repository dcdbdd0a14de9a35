/*
 * sequence.glsl: two numbers of 0..1 for each pixel and frame: over frames a sequence that fills
 * the unit square evenly, over pixels blue noise.
 *
 * Over frames: R2, multiples of 1/g and 1/g^2, g^3 = g + 1, without their integer parts (M.
 * Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018). Each run of
 * consecutive frames is as even as any other, whichever it begins with, which a history that begins
 * anywhere needs; Sobol's points are even from multiples of powers of two on only. Over pixels:
 * shifted, round the square, by the tile's two numbers (Cranley and Patterson 1976), which differ
 * the most between neighbours; a common step leaves them as they are. tests/unit/test_sequence.c
 * measures it against others.
 *
 * The products are integers, which wrap as the square does: frame 4e9 is as precise as frame 1. In
 * floats nothing would be left of the 24 bits after some 1e6 frames.
 *
 * Written without vector arithmetic: tests compile it as C.
 */
#ifndef MASU_SEQUENCE_GLSL
#define MASU_SEQUENCE_GLSL

#include "shared/lookup_tables.h"

/* Every bit of x changes half of the result's (C. Wellons, "Prospecting for Hash Functions", 2018:
 * lowbias32). A bijection; 0 is 0. */
uint masu_hash(uint x)
{
    x = (x ^ (x >> 16)) * 0x7FEB352Du;
    x = (x ^ (x >> 15)) * 0x846CA68Bu;
    return x ^ (x >> 16);
}

/* Where in the tile of tools/generate/make_blue_noise.c a pixel's word stands. Uses that must not know of
 * each other, as two bounces, have different keys: the tile lies elsewhere for each. */
uint masu_noise_index(uint x, uint y, uint key)
{
    uint shift = masu_hash(key), mask = uint(MASU_BLUE_NOISE_SIZE - 1);
    return ((y + (shift >> 16)) & mask) * uint(MASU_BLUE_NOISE_SIZE) + ((x + shift) & mask);
}

vec2 masu_unit2(uint x, uint y)
{
    float u = x >> 8, v = y >> 8;
    return vec2(u * (1.0 / 16777216.0), v * (1.0 / 16777216.0));
}

/* noise_word: the tile's; frame: 0, 1, 2 ... and round again after 2^32. Below 1. */
vec2 masu_noise2(uint noise_word, uint frame)
{
    uint x = (noise_word << 16) + frame * 0xC13FA9A9u; /* 2^32 / g */
    uint y = (noise_word & 0xFFFF0000u) + frame * 0x91E10DA5u; /* 2^32 / g^2 */
    return masu_unit2(x, y);
}

/* Which turn of four frames a frame is, and in which four: its number with the last two bits turned back by one more in each four
 * and in each sixteen. The last two bits of a frame's own number say in which quarter of a pixel rung.temporal looks in it, across:
 * what had its turn by these would see one quarter alone, and edges in mirrors were dotted. So it sees all in four turns, and all
 * of 16 places in 16. Turned back, it waits for five frames at most, within sixteen; forward for seven. */
uint masu_turn(uint frame)
{
    return (frame & 0xFFFFFFFCu) | ((frame - (frame >> 2) - (frame >> 4)) & 3u);
}

/* frame: masu_turn's. Where pixels take turns, and each has every fourth frame. Every fourth of R2's points lies within a
 * strip: 4/g is 3.02. These are multiples of (1 + 1/g) / 4 and (1 + 1/g^2) / 4, of which every fourth is R2, and all of them
 * are as even as R2. */
vec2 masu_turn_noise2(uint noise_word, uint frame)
{
    uint x = (noise_word << 16) + frame * 0x704FEA6Au;
    uint y = (noise_word & 0xFFFF0000u) + frame * 0x64784369u;
    return masu_unit2(x, y);
}

#endif
