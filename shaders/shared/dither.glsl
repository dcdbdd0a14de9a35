/*
 * dither.glsl: 32 bits for each pixel and frame, evenly spread, to round by: R2 over the pixels (M.
 * Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), plus the golden ratio
 * for each frame; of integers, so that all drivers have one pattern. After globals.glsl.
 */
#ifndef MASU_DITHER_GLSL
#define MASU_DITHER_GLSL

/* For red, green and blue, a third apart: a positive error of one channel is offset by the
 * others. */
uvec3 masu_dither(uvec2 at)
{
    uint noise = at.x * 0xC13FA9A9u + at.y * 0x91E10DA5u + frame.history.x * 0x9E3779B9u;
    return noise + uvec3(0u, 0x55555555u, 0xAAAAAAAAu);
}

#endif
