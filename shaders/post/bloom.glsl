/*
 * bloom.glsl: the sizes of the lit image for bloom. 1/4 has its own image; 1/8 and 1/16, and 1/32,
 * 1/64 and 1/128, are one below the other. A texel of 1/n covers n x n render pixels exactly; those
 * of the last row and column may extend beyond the image.
 */
#ifndef MASU_BLOOM_GLSL
#define MASU_BLOOM_GLSL

#include "shared/push.glsl"

uvec2 masu_bloom_size(uint divisor)
{
    return (uvec2(pc.render_width, pc.render_height) + divisor - 1u) / divisor;
}

/* First row of a size in its image. */
uint masu_bloom_row(uint divisor)
{
    uint row = divisor == 16u ? masu_bloom_size(8u).y : 0u;
    row += divisor > 32u ? masu_bloom_size(32u).y : 0u;
    return row + (divisor > 64u ? masu_bloom_size(64u).y : 0u);
}

#endif
