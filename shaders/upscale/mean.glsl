/*
 * mean.glsl: the format of `history`, a mean over frames with 16 bits per channel: display-linear
 * colour and the number of samples in the mean: at most 28 earlier ones and one of this frame.
 * After globals.glsl.
 *
 * It is rounded with dither: rounding to nearest would freeze a history that is slightly wrong.
 * Steps are 1/65535, a hundredth of an 8-bit sRGB step (in the dark a twentieth); steps of half
 * floats are a tenth at bright values, which every second pixel of a sky shows. Half floats are
 * used if the device does not filter unorm, and for values beyond white.
 */
#ifndef MASU_MEAN_GLSL
#define MASU_MEAN_GLSL

layout(constant_id = 14) const bool masu_half_means = false;

const float masu_mean_counts = 64.0; /* the channel holds the count divided by this */
const float masu_mean_most = 29.5;   /* samples, with room for rounding */

/* Layers of `history`: written by this frame, and by the previous one. A frame that was not
 * submitted is followed by a cut. */
int masu_layer()
{
    return int(frame.history.x & 1u);
}

float masu_layer_before()
{
    return float(1u - (frame.history.x & 1u));
}

/* Dither for rounding a mean: R2 over the pixels as in dither.glsl, in 24 bits, which multiply
 * faster. */
const uvec2 masu_chance_step = uvec2(0xC13FAAu, 0x91E10Eu);

uint masu_chance(uvec2 at)
{
    return at.x * masu_chance_step.x + at.y * masu_chance_step.y + frame.history.x * 0x9E3779u;
}

/* light: 0 to 1; as half floats NaN, infinities and values above 1 become 1. chance: of its pixel;
 * only its last 24 bits are used. */
uvec4 masu_mean_rounded(vec3 light, float count, uint chance)
{
    if (masu_half_means) {
        uvec3 bits = min(floatBitsToUint(light), uvec3(0x3F800000u));
        vec3 rounded = uintBitsToFloat((bits + (chance >> 11 & 0x1FFFu)) & 0xFFFFE000u);
        return uvec4(packHalf2x16(rounded.rg), packHalf2x16(vec2(rounded.b, count)), 0u, 0u);
    }
    /* Added to 3 * 2^22, a number has its rounded integer in its last 16 bits: half the
     * instructions of packUnorm2x16. */
    float off = float(chance >> 16 & 0xFFu) * (1.0 / 256.0) - 0.5; /* below 1/2: 65535 must not
                                                                    * become 65536 */
    precise vec4 steps = vec4(light * 65535.0 + off, count * (65535.0 / masu_mean_counts));
    precise vec4 whole = steps + 12582912.0; /* not merged with the constant of `off` */
    uvec4 bits = floatBitsToUint(whole);
    return uvec4(bits.xz & 0xFFFFu | bits.yw << 16, 0u, 0u);
}

/* Number of samples in a sampled mean. */
float masu_mean_count(vec4 mean)
{
    return masu_half_means ? mean.a : mean.a * masu_mean_counts;
}

#endif
