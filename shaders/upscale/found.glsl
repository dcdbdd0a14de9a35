/*
 * found.glsl: what temporal_find.comp tells temporal.comp of a pixel's history, in four words:
 *
 *   x       bits 0 to 5: how many samples it counts at most, 0: there is none; else three bits of an exponent from
 *           2^-3 on, three of a mantissa; 6 to 18, 19 to 31: where it was, 64ths of a pixel of the render size
 *           (bit 15 of y: that and not what `velocity` has at the place itself, linearly)
 *   y z w   of red, green and blue: two halves, the least and the most that it may be; display light
 *
 * What has moved farther than 63 pixels has none.
 */
#ifndef MASU_FOUND_GLSL
#define MASU_FOUND_GLSL

const float masu_found_most = 30.0;

/* count: to the nearest that there is, from 9/64 to the most. */
uvec4 masu_found(vec2 moved, bool of_front, float count, vec3 least, vec3 most)
{
    uint level = (floatBitsToUint(clamp(count, 0.140625, masu_found_most)) - 0x3E000000u + 0x80000u) >> 20;
    ivec2 steps = ivec2(round(clamp(moved, -64.0, 64.0) * 64.0));
    bool far = any(greaterThanEqual(abs(moved), vec2(63.0)));
    uint word = level | uint(steps.x & 8191) << 6 | uint(steps.y) << 19;
    return uvec4(far ? 0u : word, packHalf2x16(vec2(least.r, most.r)) | uint(of_front) << 15, packHalf2x16(vec2(least.g, most.g)),
                 packHalf2x16(vec2(least.b, most.b)));
}

/* Pixels of the render size. */
vec2 masu_found_motion(uvec4 found)
{
    ivec2 steps = ivec2(bitfieldExtract(int(found.x), 6, 13), int(found.x) >> 19);
    return vec2(steps) * (1.0 / 64.0);
}

bool masu_found_front(uvec4 found)
{
    return (found.y & 0x8000u) != 0u;
}

bool masu_is_found(uvec4 found)
{
    return (found.x & 63u) != 0u;
}

float masu_found_count(uvec4 found)
{
    return uintBitsToFloat((found.x & 63u) * 0x100000u + 0x3E000000u);
}

/* As light that is found may be. */
vec3 masu_found_held(uvec4 found, vec3 light)
{
    vec2 red = unpackHalf2x16(found.y), green = unpackHalf2x16(found.z), blue = unpackHalf2x16(found.w);
    return clamp(light, vec3(abs(red.x), green.x, blue.x), vec3(red.y, green.y, blue.y));
}

#endif
