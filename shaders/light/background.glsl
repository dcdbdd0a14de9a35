/*
 * background.glsl: the lit image at 1/2 to 1/64 of its size, side by side in one texture: the
 * background behind rough glass; with refracting glass in the scene also at full size.
 * background.comp writes it, transparents.frag reads it.
 *
 * A tile of 64x64 pixels has 32x32, 16x16 ... 1x1 texels at the levels 1 to 6. The largest level
 * takes two thirds of the height, the others are below it from left to right.
 */
#ifndef MASU_BACKGROUND_GLSL
#define MASU_BACKGROUND_GLSL

layout(constant_id = 22) const bool masu_flat_lens = false;

/* Converts a depth to the value in alpha, and back: depths of an orthographic camera are near 1. */
float masu_background_depth(float depth)
{
    return masu_flat_lens ? 1.0 - depth : depth;
}

#define MASU_BACKGROUND_LEVELS 6u
#define MASU_BACKGROUND_TILE 64u

uvec2 masu_background_tiles(uvec2 size)
{
    return (size + MASU_BACKGROUND_TILE - 1u) / MASU_BACKGROUND_TILE;
}

/* First texel of a level; largest: 0 or 1, the first level that the image has. */
uvec2 masu_background_at(uint level, uint largest, uvec2 tiles)
{
    uint side = MASU_BACKGROUND_TILE >> largest;
    return level <= largest ? uvec2(0u) : uvec2(side - (128u >> level), side) * tiles;
}

#endif
