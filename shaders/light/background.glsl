/*
 * background.glsl: the lit picture at 1/2 to 1/64 of its size, side by side in one image: what is seen through rough
 * glass. background.comp writes it, transparents.frag reads it.
 *
 * A tile of 64x64 pixels has 32x32, 16x16 ... 1x1 texels at the levels 1 to 6. The first level takes two thirds of the
 * height, the others stand below it from left to right.
 */
#ifndef MASU_BACKGROUND_GLSL
#define MASU_BACKGROUND_GLSL

#define MASU_BACKGROUND_LEVELS 6u
#define MASU_BACKGROUND_TILE 64u

uvec2 masu_background_tiles(uvec2 size)
{
    return (size + MASU_BACKGROUND_TILE - 1u) / MASU_BACKGROUND_TILE;
}

/* First texel of a level, 1 to 6. */
uvec2 masu_background_at(uint level, uvec2 tiles)
{
    return level < 2u ? uvec2(0u) : uvec2(32u - (64u >> (level - 1u)), 32u) * tiles;
}

#endif
