/*
 * history.glsl: of a pixel of the output what frames before have left, found again by what temporal_find.comp says of the texel
 * that it lies in; and what becomes of it. After output.glsl and found.glsl; for temporal.comp and temporal_twice.comp, whose
 * images 1 to 5 these are.
 *
 * Push constants: push.moved_*, push.old_*: 1 / size of the images of velocity and history; push.last_*: how far a place may
 * lie, texels of the render size whose middles are whole numbers; push.calm, push.moving: of masu_show; push.white, push.peak:
 * encode.glsl's.
 */
#ifndef MASU_HISTORY_GLSL
#define MASU_HISTORY_GLSL

#include "shared/frame.h"
#include "shared/encode.glsl"
#include "upscale/mean.glsl"

layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D found_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image; /* linear */
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2DArray history_image; /* linear */
layout(set = MASU_SET_PASS, binding = 4, rg32ui) uniform writeonly uimage2DArray kept_image; /* the other layer of it */
layout(set = MASU_SET_PASS, binding = 5, MASU_COLOR_FORMAT) uniform writeonly MASU_COLOR_IMAGE target;

const float masu_sharpen = 0.05; /* while the view rests, of what moves before it */

/* What a pixel was. */
struct masu_past {
    vec4 mean;  /* display light; samples */
    vec3 curve; /* of that light the second difference, a pixel apart */
};

/* The cubic of Catmull and Rom less its mixed term: the linear mean, less so much of the second difference of
 * linear means a texel apart. */
masu_past masu_history_at(vec2 place)
{
    vec2 inside = place, end = vec2(pc.output_width, pc.output_height) - 0.5;
    if (!masu_fixed_output) { /* the image may be larger than the picture: masu_resize; else samplers care */
        inside = clamp(place, vec2(0.5), end);
    }
    vec2 t = fract(inside - 0.5);
    vec2 bent = t * (0.5 - 0.5 * t);
    vec3 uv = vec3(inside * vec2(push.old_x, push.old_y), masu_layer_before());
    vec4 here = textureLod(history_image, uv, 0.0);
    vec3 beside = textureLodOffset(history_image, uv, 0.0, ivec2(-1, 0)).rgb +
                  textureLodOffset(history_image, uv, 0.0, ivec2(1, 0)).rgb;
    vec3 above = textureLodOffset(history_image, uv, 0.0, ivec2(0, -1)).rgb +
                 textureLodOffset(history_image, uv, 0.0, ivec2(0, 1)).rgb;
    if (!masu_fixed_output) { /* what lies beyond is of another picture */
        beside = inside.x > end.x - 1.0 ? 2.0 * here.rgb : beside;
        above = inside.y > end.y - 1.0 ? 2.0 * here.rgb : above;
    }
    vec3 curve = 4.0 * here.rgb - beside - above;
    here.rgb += 2.0 * (bent.x + bent.y) * here.rgb - bent.x * beside - bent.y * above;
    return masu_past(here, curve);
}

/* The mean as it may be, and how many samples of it count; 0 where it begins anew.
 *
 * middle: of the pixel; texel: of the render size, the one that the pixel lies in; inside: where it lies, within the picture, in
 * texels of the render size, whose middles are whole numbers; steps: pixels a texel. */
masu_past masu_history(uvec2 found, vec2 middle, ivec2 texel, vec2 inside, vec2 steps)
{
    if (!masu_is_found(found)) {
        return masu_past(vec4(0.0), vec3(0.0));
    }
    /* Of what has stayed the middle of its texel, which is that texel: samplers round to 1/256, as Direct3D has them. Not a
     * fetch instead, which takes a seventh more of this pass by the estimate of Intel's compiler. */
    vec2 before = middle;
    if (!masu_has_stayed(found)) {
        /* One fetch serves both cases: a texel is read at its middle. Two fetches cost one more wait by Intel's estimate, a
         * sixth of this pass. What lies beyond the picture is not touched, even with a weight of 0, since it may be NaN. */
        vec2 beside = min(vec2(texel + masu_found_beside(found)), vec2(push.last_x, push.last_y));
        vec2 uv = ((masu_found_is_beside(found) ? beside : inside) + 0.5) * vec2(push.moved_x, push.moved_y);
        vec2 moved = textureLod(velocity_image, uv, 0.0).xy;
        before += (masu_is_missed(found) ? masu_thin_motion(masu_thin_of(found))
                                         : moved + frame.shifts.zw) * steps;
    }
    masu_past old = masu_history_at(before);
    old.mean.a = masu_mean_count(old.mean);
    /* More samples than a frame stores, NaN or more light than the cubic makes of what is 0 to 1, is what none has stored, and
     * would be seen as long as all: begin anew. Unorm has neither of the last. */
    bool stored = old.mean.a <= masu_mean_most &&
                  (!masu_half_means || abs(old.mean.r) + abs(old.mean.g) + abs(old.mean.b) <= 6.0);
    old.mean = stored ? masu_found_held(found, old.mean) : vec4(0.0);
    old.curve = stored || !masu_half_means ? old.curve : vec3(0.0);
    return old;
}

/* Leaves a pixel's mean for the next frame, and shows it, encoded and a little sharper. chance: masu_mean_rounded's.
 *
 * Of what moves a sample counts for the pixels around it by a tent, twice as wide as the pixel (below full size a little
 * wider): steadier than what falls into the pixel alone, but blurred. Of what that and the history's resampling take,
 * masu_sharpen gives some back; push.moving does while the view moves, for all of the history is resampled then; of what rests
 * in a world that does, which is no tent's, push.calm, less than half of it. What is added is that factor times the second
 * difference of the history, times the history's share of the mean. The mean's own is not known yet: its neighbours are
 * written by other invocations. What is kept is not sharpened: it would be again in every frame. */
void masu_show(ivec2 at, vec3 light, float count, masu_past old, bool stays, uint chance)
{
    float moving = (frame.temporal.z & MASU_TEMPORAL_MOVES) != 0u ? push.moving : masu_sharpen;
    vec3 sharp = light + (stays ? push.calm : moving) * old.mean.a * (1.0 / max(count, 1.0)) * old.curve;
#if defined(MASU_TEN) || defined(MASU_DEEP) /* no store clamps it */
    sharp = clamp(sharp, 0.0, 1.0);
#endif
    MASU_STORE_LAYER(kept_image, at, masu_layer(), masu_mean_rounded(light, count, chance));
    MASU_STORE_FILTERED(target, at, masu_encoded_open(sharp, push.peak, push.white));
}

#endif
