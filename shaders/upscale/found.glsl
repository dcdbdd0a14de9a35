/*
 * found.glsl: the result of temporal_find.comp for a pixel, which temporal.comp and
 * temporal_twice.comp read: two 32-bit values.
 *
 *   x   bits 0 to 26   lower limit of the history's red, green and blue, 9 bits each,
 *                      display-linear: bits 18 to 26 of the float, which is 2^-15 to 1, rounded
 *                      down. Black is 2^-15, a tenth of a step of 8 bits
 *       bits 27 to 31  limit of the history weight, in samples: bits 21 to 25 of the float, which
 *                      is 5/32 to 28; 0: no history
 *   y   bits 0 to 26   upper limit, in the same form, rounded up
 *       bits 27 to 31  velocity that leads to the history. 0: of this texel; 31: none (same
 *                      position); 30: stored in this value (thin surface, below); else of another
 *                      texel: bits 27 and 28 hold its offset to the right (-1 to 1) plus 2, bits 29
 *                      and 30 its offset downwards plus 1
 *
 * 30 marks a thin surface that this frame's samples have missed (temporal_find.comp, rule 5). It
 * has no upper limit, so the lowest 5 bits of the three colours of y hold the 15 bits of masu_thin.
 */
#ifndef MASU_FOUND_GLSL
#define MASU_FOUND_GLSL

const float masu_found_most = 28.0;
const uint masu_found_linear = 0u, masu_found_missed = 30u, masu_found_stays = 31u;

/* Offset of the texel whose velocity the pixel uses: -1, 0 or 1 to the right and downwards. */
uint masu_found_way(int right, int below)
{
    return uint(right + 2) | uint(below + 1) << 2;
}

ivec2 masu_found_beside(uint way)
{
    return ivec2(way & 3u, way >> 2) - ivec2(2, 1);
}

/* Bits 18 to 26 of floats in 0 to 1; smaller exponents than 112 become 112. up: 2^18 - 1 rounds up,
 * 0 down. */
uint masu_found_color(vec3 light, uint up)
{
    uvec3 bits = (floatBitsToUint(max(light, vec3(1.0 / 32768.0))) + up - 0x38000000u) >> 18;
    return bits.r | bits.g << 9 | bits.b << 18;
}

/* count: rounded to a value that can be stored, 5/32 to masu_found_most. least, most:
 * display-linear, 0 to 1. */
uvec2 masu_found(uint way, float count, vec3 least, vec3 most)
{
    uint level =
        (floatBitsToUint(clamp(count, 0.15625, masu_found_most)) - 0x3E000000u + 0x100000u) >> 21;
    return uvec2(masu_found_color(least, 0u) | level << 27,
                 masu_found_color(most, 0x3FFFFu) | way << 27);
}

/* A thin surface, as the lowest 15 bits of its depth in `history_depth` and as the lowest of
 * `found` hold it: bits 0 to 2 how many frames may miss it, 0: it is not thin; bits 3 to 8 and 9 to
 * 14 its velocity, quarters of a pixel of the render size. */
const uint masu_thin_lives = 7u, masu_thin_bits = 0x7FFFu;
const float masu_thin_fastest = 7.75; /* pixels of the render size */

uint masu_thin(vec2 moved, uint lives)
{
    uvec2 quarters = uvec2(moved * 4.0 + 32.5);
    return lives | quarters.x << 3 | quarters.y << 9;
}

vec2 masu_thin_motion(uint thin)
{
    return vec2(uvec2(thin >> 3, thin >> 9) & 63u) * 0.25 - 8.0;
}

/* Stores a missed thin surface in `found`; masu_thin_of reads it. */
uvec2 masu_found_thin(uint thin, float count, vec3 least)
{
    uvec2 found = masu_found(masu_found_missed, count, least, vec3(1.0));
    return uvec2(found.x, found.y | (thin & 31u) | (thin >> 5 & 31u) << 9 | thin >> 10 << 18);
}

uint masu_thin_of(uvec2 found)
{
    return (found.y & 31u) | (found.y >> 9 & 31u) << 5 | (found.y >> 18 & 31u) << 10;
}

bool masu_is_missed(uvec2 found)
{
    return found.y >> 27 == masu_found_missed;
}

bool masu_is_found(uvec2 found)
{
    return found.x >= 1u << 27;
}

bool masu_has_stayed(uvec2 found)
{
    return found.y >= masu_found_stays << 27;
}

/* For pixels that have moved: whether they use the velocity of another texel, and its offset. */
bool masu_found_is_beside(uvec2 found)
{
    return found.y >= 1u << 27;
}

ivec2 masu_found_beside(uvec2 found)
{
    return masu_found_beside(found.y >> 27);
}

vec3 masu_found_light(uint word)
{
    return uintBitsToFloat((uvec3(word << 18, word << 9, word) & 0x7FC0000u) | 0x38000000u);
}

/* Clamps light to the limits of `found`. */
vec3 masu_found_held(uvec2 found, vec3 light)
{
    return clamp(light, masu_found_light(found.x), masu_found_light(found.y));
}

/* Limit of the weight of a history that was found, in samples. */
float masu_found_count(uvec2 found)
{
    return uintBitsToFloat((found.x >> 27 << 21) + 0x3E000000u);
}

#endif
