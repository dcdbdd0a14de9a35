/*
 * sequence.glsl: two quasi-random values in 0..1 per pixel and frame. Start with masu_noise2.
 *
 * Over frames they are a low-discrepancy sequence: R2, the fractional parts of n/g and n/g^2 with
 * g^3 = g + 1 (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018). A
 * history may begin at any frame, so every run of consecutive frames must fill the unit square
 * evenly. R2 does that; Sobol points do so only from multiples of powers of two.
 *
 * Over pixels they are blue noise: the point is shifted by the pixel's two values of a blue-noise
 * tile, modulo 1 (Cranley and Patterson 1976). tests/unit/test_sequence.c measures the error of
 * this sequence and of four others.
 *
 * The products are 32-bit integers that wrap around, so frame 4e9 is as precise as frame 1. A float
 * would have no fractional bits left after about 1e6 frames.
 *
 * There is no vector arithmetic here, because tests compile this file as C.
 */
#ifndef MASU_SEQUENCE_GLSL
#define MASU_SEQUENCE_GLSL

#include "shared/lookup_tables.h"

/* Integer hash: each bit of x flips half of the bits of the result on average (lowbias32 of
 * C. Wellons, "Prospecting for Hash Functions", 2018). A bijection; 0 is mapped to 0. */
uint masu_hash(uint x)
{
    x = (x ^ (x >> 16)) * 0x7FEB352Du;
    x = (x ^ (x >> 15)) * 0x846CA68Bu;
    return x ^ (x >> 16);
}

/* Index of a pixel's value in the tile of tools/generate/make_blue_noise.c. key: shifts the tile,
 * so that two uses with different keys, such as two bounces, are uncorrelated. */
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

/* noise_word: the value at masu_noise_index; frame: 0, 1, 2, ..., wraps after 2^32. Results are
 * below 1. */
vec2 masu_noise2(uint noise_word, uint frame)
{
    uint x = (noise_word << 16) + frame * 0xC13FA9A9u; /* 2^32 / g */
    uint y = (noise_word & 0xFFFF0000u) + frame * 0x91E10DA5u; /* 2^32 / g^2 */
    return masu_unit2(x, y);
}

/* Order in which the four pixels of a 2x2 block are traced: bits 0 and 1 of the result select the
 * pixel, the other bits count groups of four frames. The last two bits of the frame number are
 * decremented by one more in each group of 4 and of 16 frames. Without that, the order would have
 * the same period as the jitter of rung.temporal: a pixel would always be sampled in the same
 * quarter, and edges in mirrors would be dotted. With it a pixel gets all four quarters in 4 of its
 * samples and all 16 jitter positions in 16. A pixel waits for at most five frames (seven if the
 * bits were incremented). */
uint masu_turn(uint frame)
{
    return (frame & 0xFFFFFFFCu) | ((frame - (frame >> 2) - (frame >> 4)) & 3u);
}

/* masu_noise2 for pixels that are traced every fourth frame. frame: the result of masu_turn. Every
 * fourth point of R2 is in a narrow strip, because 4/g is 3.02. These are multiples of (1 + 1/g) /
 * 4 and (1 + 1/g^2) / 4: every fourth point is one of R2, and all together are as even as R2. */
vec2 masu_turn_noise2(uint noise_word, uint frame)
{
    uint x = (noise_word << 16) + frame * 0x704FEA6Au;
    uint y = (noise_word & 0xFFFF0000u) + frame * 0x64784369u;
    return masu_unit2(x, y);
}

#endif
