/*
 * mean.glsl: a mean over frames as `history` holds it, 16 bits a channel: display light, and how many samples
 * stand in it, of which there are 28 of before and this frame's one at most. After globals.glsl.
 *
 * It is rounded up or down by chance: the nearest step would hold a history still that is a little wrong. In steps of 1/65535,
 * a hundredth of one of 8 bits of sRGB (in the dark a twentieth); of halves, a tenth where it is bright, which every second
 * pixel of a sky shows. Halves it is where the device does not filter unorm, and beyond white.
 */
#ifndef MASU_MEAN_GLSL
#define MASU_MEAN_GLSL

layout(constant_id = 14) const bool masu_half_means = false;

const float masu_mean_counts = 64.0; /* of which a channel holds the share */
const float masu_mean_most = 29.5;   /* samples, with room for rounding */

/* Of `history`: the layer that this frame writes, and that of the frame before. What was not submitted is followed by a cut. */
int masu_layer()
{
    return int(frame.history.x & 1u);
}

float masu_layer_before()
{
    return float(1u - (frame.history.x & 1u));
}

/* What a mean is rounded by: R2 over the pixels as in dither.glsl, in 24 bits, which multiply faster. */
const uvec2 masu_chance_step = uvec2(0xC13FAAu, 0x91E10Eu);

uint masu_chance(uvec2 at)
{
    return at.x * masu_chance_step.x + at.y * masu_chance_step.y + frame.history.x * 0x9E3779u;
}

/* light: 0 to 1; NaN, infinities and more than 1 become 1 in halves, whatever they are in unorm. chance: of its pixel; its last 24
 * bits count. */
uvec4 masu_mean_rounded(vec3 light, float count, uint chance)
{
    if (masu_half_means) {
        uvec3 bits = min(floatBitsToUint(light), uvec3(0x3F800000u));
        vec3 rounded = uintBitsToFloat((bits + (chance >> 11 & 0x1FFFu)) & 0xFFFFE000u);
        return uvec4(packHalf2x16(rounded.rg), packHalf2x16(vec2(rounded.b, count)), 0u, 0u);
    }
    float off = float(chance >> 16 & 0xFFu) * (1.0 / (256.0 * 65535.0)) - 127.5 / (256.0 * 65535.0);
    vec3 rounded = light + off;
    return uvec4(packUnorm2x16(rounded.rg), packUnorm2x16(vec2(rounded.b, count * (1.0 / masu_mean_counts))), 0u, 0u);
}

/* How many samples stand in what was sampled. */
float masu_mean_count(vec4 mean)
{
    return masu_half_means ? mean.a : mean.a * masu_mean_counts;
}

#endif
