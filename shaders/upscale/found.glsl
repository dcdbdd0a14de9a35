/*
 * found.glsl: what temporal_find.comp tells temporal.comp of a pixel's history, in two words:
 *
 *   x   bits 0 to 26   of red, green and blue, 9 bits each, the least that it may be: display light, bits 18 to 26 of the
 *                      float, of 2^-15 to 1; the rest of it cut off
 *       bits 27 to 31  how many samples it counts at most: bits 21 to 25 of that float, of 1/8 to 28; 0: there is none
 *   y   bits 0 to 26   the same of the most; the rest of it rounded up
 *       bits 27 to 31  where it was. 0: by the velocity at the place; 1: in the same place; else by that of a texel beside,
 *                      1 + bits 27 and 28 of which are 0 to 2 to the right, bits 29 and 30 below, all less 1
 */
#ifndef MASU_FOUND_GLSL
#define MASU_FOUND_GLSL

const float masu_found_most = 28.0;
const uint masu_found_linear = 0u, masu_found_stays = 31u;

/* The texel whose velocity is that of the pixel: -1, 0 or 1 to the right and below. */
uint masu_found_way(int right, int below)
{
    return uint(right + 2) | uint(below + 1) << 2;
}

ivec2 masu_found_beside(uint way)
{
    return ivec2(way & 3u, way >> 2) - ivec2(2, 1);
}

/* Bits 18 to 26 of floats of 0 to 1: exponents of less than 112 are that; rounded up by `up` of 2^18 - 1. */
uint masu_found_color(vec3 light, uint up)
{
    uvec3 bits = (floatBitsToUint(max(light, vec3(1.0 / 32768.0))) + up - 0x38000000u) >> 18;
    return bits.r | bits.g << 9 | bits.b << 18;
}

/* count: to the nearest that there is, 1/8 to the most. least, most: display light, 0 to 1. */
uvec2 masu_found(uint way, float count, vec3 least, vec3 most)
{
    uint level = (floatBitsToUint(clamp(count, 0.15625, masu_found_most)) - 0x3E000000u + 0x100000u) >> 21;
    return uvec2(masu_found_color(least, 0u) | level << 27, masu_found_color(most, 0x3FFFFu) | way << 27);
}

bool masu_is_found(uvec2 found)
{
    return found.x >= 1u << 27;
}

bool masu_has_stayed(uvec2 found)
{
    return found.y >= masu_found_stays << 27;
}

/* texel: that of `found`; place: of the picture, at most last, a little less than the middle of the last texel, for what lies
 * beyond is read even for a weight of 0. All in texels of the render size, whose middles are whole numbers. The place at
 * which its velocity is. */
vec2 masu_found_place(uvec2 found, vec2 texel, vec2 place, vec2 last)
{
    uint way = found.y >> 27;
    return way != masu_found_linear ? min(texel + vec2(masu_found_beside(way)), last) : place;
}

vec3 masu_found_light(uint word)
{
    return uintBitsToFloat((uvec3(word << 18, word << 9, word) & 0x7FC0000u) | 0x38000000u);
}

/* light: as it may be; a: samples, as many as count. */
vec4 masu_found_held(uvec2 found, vec4 light)
{
    float count = uintBitsToFloat((found.x >> 27 << 21) + 0x3E000000u);
    return vec4(clamp(light.rgb, masu_found_light(found.x), masu_found_light(found.y)), min(abs(light.a), count));
}

#endif
