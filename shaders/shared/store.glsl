/*
 * store.glsl: the only way in which a shader writes an image.
 *
 * Each macro drops a store outside the image (also for negative coordinates), replaces NaN and Inf
 * by 0, and clamps to the range of the format, because drivers differ for other values:
 * one packs 1e6 into a half as NaN. A bad value therefore lives in one pixel of one pass
 * and is never kept by a history image.
 *
 *   MASU_STORE_UNORM(img, p, v)   vec4 v to 0..1              rgba8 and its like
 *   MASU_STORE_HALF(img, p, v)    vec4 v to -65504..65504     rgba16f, rg16f, r11f_g11f_b10f
 *   MASU_STORE_R32F(img, p, x)    float x, finite             r32f
 *   MASU_STORE_UINT(img, p, u)    uint or uvec4 u, unchanged  r32ui and its like
 *   MASU_STORE_TEN(img, p, v)     vec3 v to 0..1              r32ui view of 10 bits a channel
 *   MASU_STORE_SAFE(img, p, v)    vec4 v, unchanged           v must be finite, p inside the image.
 *                                                             The format clamps v; masu_ten_bits
 *                                                             requires 0..1
 *   MASU_STORE_LAYER(img, p, layer, v)                        the same to a layer of an array
 *
 * p is an ivec2 or a uvec2. Each argument is evaluated once. Write a semicolon after the macro and
 * braces around it under if/else: it expands to a block.
 *
 * A shader that counts replaced pixels defines MASU_COUNT_REPLACED(n) before it includes this file;
 * n is 1u, and the macro runs once for each stored pixel with a NaN or Inf in any component.
 * Clamping a finite value is not counted.
 */
#ifndef MASU_STORE_GLSL
#define MASU_STORE_GLSL

#include "shared/guard.glsl"

#ifndef MASU_COUNT_REPLACED
#define MASU_COUNT_REPLACED(n)
#endif

/* value: expression that converts v, available as masu_store_value of type `type`, to the stored
 * value. */
#define MASU_STORE_CHECKED(img, p, type, v, value)                                                 \
    {                                                                                              \
        ivec2 masu_store_at = ivec2(p);                                                            \
        type masu_store_value = (v);                                                               \
        if (all(lessThan(uvec2(masu_store_at), uvec2(imageSize(img))))) {                          \
            if (!masu_finite(masu_store_value)) {                                                  \
                MASU_COUNT_REPLACED(1u);                                                           \
            }                                                                                      \
            imageStore(img, masu_store_at, value);                                                 \
        }                                                                                          \
    }

#define MASU_STORE_FLOATS(img, p, v, lo, hi)                                                       \
    MASU_STORE_CHECKED(img, p, vec4, v, masu_sane(masu_store_value, lo, hi))
#define MASU_STORE_UNORM(img, p, v) MASU_STORE_FLOATS(img, p, v, 0.0, 1.0)
#define MASU_STORE_HALF(img, p, v) MASU_STORE_FLOATS(img, p, v, -65504.0, 65504.0)
#define MASU_STORE_R32F(img, p, x)                                                                 \
    MASU_STORE_FLOATS(img, p, vec4((x), 0.0, 0.0, 0.0), -3.4e38, 3.4e38)

#define MASU_STORE_SAFE(img, p, v) imageStore(img, ivec2(p), (v))
#define MASU_STORE_LAYER(img, p, layer, v) imageStore(img, ivec3(ivec2(p), (layer)), (v))

/* v of 0..1 in the bits of A2B10G10R10_UNORM, to the nearest step, alpha 1. Added to 2^23, a number
 * has its rounded integer in its last bits; the bits above, 0x4B000000, are shifted out of two of
 * three. */
uint masu_ten_bits(vec3 v)
{
#ifdef MASU_EXACT
    precise vec3 scaled = v * 1023.0;
#else
    vec3 scaled = v * 1023.0;
#endif
    uvec3 steps = floatBitsToUint(scaled + 8388608.0);
    return (steps.b << 20) + ((steps.g << 10) + (steps.r + (0xC0000000u - 0x4B000000u)));
}

#define MASU_STORE_TEN(img, p, v)                                                                  \
    MASU_STORE_CHECKED(img, p, vec3, v, uvec4(masu_ten_bits(masu_sane_unit(masu_store_value))))

#define MASU_STORE_UINT(img, p, u)                                                                 \
    {                                                                                              \
        ivec2 masu_store_at = ivec2(p);                                                            \
        uvec4 masu_store_value = uvec4(u);                                                         \
        if (all(lessThan(uvec2(masu_store_at), uvec2(imageSize(img))))) {                          \
            imageStore(img, masu_store_at, masu_store_value);                                      \
        }                                                                                          \
    }

#endif
