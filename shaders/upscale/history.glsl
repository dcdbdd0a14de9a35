/*
 * history.glsl: reads the history of an output pixel (masu_history), at the position that
 * temporal_find.comp found for its render texel, and writes history and target (masu_show). For
 * temporal.comp and temporal_twice.comp, which bind images 1 to 5. Include output.glsl and
 * found.glsl first.
 *
 * Push constants: push.moved_*, push.old_*: 1 / size of the velocity and history images;
 * push.last_*: the last position, in render texels with integer centres; push.calm, push.moving:
 * see masu_show; push.white, push.peak: see encode.glsl.
 */
#ifndef MASU_HISTORY_GLSL
#define MASU_HISTORY_GLSL

#include "shared/frame.h"
#include "shared/encode.glsl"
#include "upscale/mean.glsl"

layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D found_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image; /* linear */
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2DArray history_image; /* linear */
/* history, other layer */
layout(set = MASU_SET_PASS, binding = 4, rg32ui) uniform writeonly uimage2DArray kept_image;
layout(set = MASU_SET_PASS, binding = 5, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

const float masu_sharpen = 0.05; /* of moving pixels while the camera is stationary */

/* History of a pixel. */
struct masu_past {
    vec4 mean;  /* display-linear colour; number of samples */
    vec3 curve; /* second difference of the colour, one pixel apart */
};

/* The history at a position of the output. moves: between pixels, else at the centre of one.
 *
 * Catmull-Rom interpolation without its mixed term: the bilinear value minus a multiple of the
 * second difference of bilinear values one texel apart. At a centre the multiple is 0. */
masu_past masu_history_at(vec2 place, bool moves)
{
    vec2 inside = place, end = vec2(pc.output_width, pc.output_height) - 0.5;
    if (!masu_fixed_output) { /* masu_resize: the image may be larger than the output */
        inside = clamp(place, vec2(0.5), end);
    }
    vec3 uv = vec3(inside * vec2(push.old_x, push.old_y), masu_layer_before());
    vec4 here = textureLod(history_image, uv, 0.0);
    vec3 beside = textureLodOffset(history_image, uv, 0.0, ivec2(-1, 0)).rgb +
                  textureLodOffset(history_image, uv, 0.0, ivec2(1, 0)).rgb;
    vec3 above = textureLodOffset(history_image, uv, 0.0, ivec2(0, -1)).rgb +
                 textureLodOffset(history_image, uv, 0.0, ivec2(0, 1)).rgb;
    if (!masu_fixed_output) { /* texels beyond are stale */
        beside = inside.x > end.x - 1.0 ? 2.0 * here.rgb : beside;
        above = inside.y > end.y - 1.0 ? 2.0 * here.rgb : above;
    }
    vec3 curve = 4.0 * here.rgb - beside - above;
    if (moves) {
        vec2 t = fract(inside - 0.5);
        vec2 bent = t * (0.5 - 0.5 * t);
        here.rgb += 2.0 * (bent.x + bent.y) * here.rgb - bent.x * beside - bent.y * above;
    }
    return masu_past(here, curve);
}

/* The history, clamped, and its weight in samples; 0 if the pixel starts over.
 *
 * middle: centre of the output pixel; texel: the render texel that contains it; inside: its
 * position in render texels with integer centres, clamped to the image; steps: output pixels per
 * texel. */
masu_past masu_history(uvec2 found, vec2 middle, ivec2 texel, vec2 inside, vec2 steps)
{
    if (!masu_is_found(found)) {
        return masu_past(vec4(0.0), vec3(0.0));
    }
    /* A static pixel reads its texel's centre, which returns that texel: samplers round to 1/256,
     * as Direct3D requires. A texelFetch would cost a seventh more of this pass by the estimate of
     * Intel's compiler. */
    vec2 before = middle;
    bool stays = masu_has_stayed(found);
    if (!stays) {
        /* One fetch serves both cases: another texel is read at its centre. Two fetches cost a
         * sixth more of this pass by Intel's estimate. Texels outside of the image must not be
         * read, even with a weight of 0, since they may be NaN. */
        vec2 beside = min(vec2(texel + masu_found_beside(found)), vec2(push.last_x, push.last_y));
        vec2 uv = ((masu_found_is_beside(found) ? beside : inside) + 0.5) *
                  vec2(push.moved_x, push.moved_y);
        vec2 moved = textureLod(velocity_image, uv, 0.0).xy + frame.shifts.zw;
        if (masu_is_missed(found)) {
            moved = masu_thin_motion(masu_thin_of(found));
        }
        before += moved * steps;
    }
    masu_past old = masu_history_at(before, !stays);
    float count = masu_mean_count(old.mean);
    /* Undefined content would remain visible for many frames. It shows as more samples than a frame
     * stores, as NaN, or as more light than the cubic filter makes of 0..1 (the last two cannot
     * occur in unorm images): the pixel starts over. Undefined neighbours of a static pixel only
     * affect the sharpened image, for one frame. */
    bool stored = count <= masu_mean_most;
    if (masu_half_means && !(stored && dot(abs(old.mean.rgb), vec3(1.0)) <= 6.0)) {
        stored = false;
        old.mean.rgb = old.curve = vec3(0.0);
    }
    if (!stays) {
        old.mean.rgb = masu_found_held(found, old.mean.rgb);
    }
    old.mean.a = stored ? min(abs(count), masu_found_count(found)) : 0.0;
    return old;
}

/* Writes a pixel's mean to the history, and a slightly sharpened, encoded copy to the target.
 * chance: see masu_mean_rounded.
 *
 * Samples of moving pixels are weighted by a tent filter two output pixels wide (wider below full
 * size). It is more stable than a box filter, but it blurs, and so does resampling of the history.
 * Sharpening restores some of that: by masu_sharpen for moving pixels, by push.moving while the
 * camera moves, because the whole history is resampled then, and by push.calm, less than half, for
 * static pixels of an unchanged scene, which use a box filter. The factor is multiplied by the
 * second difference of the history and by the history's share of the mean. (The second difference
 * of the mean is not available: other invocations compute its neighbours.) The history itself is
 * not sharpened, because that would accumulate over frames. */
void masu_show(ivec2 at, vec3 light, float count, masu_past old, bool stays, uint chance)
{
    light = clamp(light, 0.0, 1.0);
    float moving = (frame.temporal.z & MASU_TEMPORAL_MOVES) != 0u ? push.moving : masu_sharpen;
    vec3 sharp = light +
                 (stays ? push.calm : moving) * old.mean.a * (1.0 / max(count, 1.0)) * old.curve;
#if defined(MASU_TEN) || defined(MASU_DEEP) /* the store does not clamp */
    sharp = clamp(sharp, 0.0, 1.0);
#endif
    MASU_STORE_LAYER(kept_image, at, masu_layer(), masu_mean_rounded(light, count, chance));
    MASU_STORE_FILTERED(target, at, masu_encoded_open(sharp, push.peak, push.white));
}

#endif
