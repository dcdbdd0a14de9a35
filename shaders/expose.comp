/*
 * expose.comp: the exposure that the bins of meter.comp ask for, as far as time lets it adapt. One
 * workgroup, of which one invocation sums up: in one order, so that the same picture gives the same
 * bits.
 *
 * The mean is that of log2 of luminance without the darkest and the brightest shares; a bin that
 * straddles a share's end counts in part. The exposure makes it a grey card's. In log2 it goes a share
 * 1 - exp(-speed dt) of the way: two frames of dt do what one of 2 dt does. A frame without a pixel that
 * counts leaves it where it is.
 *
 * Push constants: push: speed to brighten, to darken, min, max; low and high = shares left out, of
 * 2^16, below and above.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/expose.h"
#include "shared/counters.h"
#include "shared/exposure.h"
#include "shared/frame.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/guard.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_EXPOSURE, std430) buffer Exposure
{
    float exposure;
    float adapted; /* log2 of what is metered of it */
    uint unused[MASU_EXPOSURE_HEADER - 2];
    uint bins[MASU_EXPOSURE_BINS];
};

shared uint counts[MASU_EXPOSURE_BINS];

/* log2 of the middle of a bin. */
float middle(uint bin)
{
    return float(MASU_EXPOSURE_LOG2) + float(bin >> 3) + masu_log2((float(bin & 7u) + 8.5) / 8.0);
}

void main()
{
    for (uint k = 0u; k < uint(MASU_EXPOSURE_BINS); k += 64u) {
        counts[k + gl_LocalInvocationIndex] = bins[k + gl_LocalInvocationIndex];
    }
    barrier();
    if (gl_LocalInvocationIndex > 0u) {
        return;
    }
    uint all_pixels = 0u;
    for (uint k = 0u; k < uint(MASU_EXPOSURE_BINS); k++) {
        all_pixels += counts[k];
    }
    /* At most 2^28 pixels: floats lose what is below 16 of them. */
    float pixels = float(all_pixels);
    float low = pixels * (float(push.low) / 65536.0);
    float high = pixels * (1.0 - float(push.high) / 65536.0);
    float below = 0.0, weight = 0.0, sum = 0.0;
    for (uint k = 0u; k < uint(MASU_EXPOSURE_BINS); k++) {
        float n = float(counts[k]);
        float inside = max(min(below + n, high) - max(below, low), 0.0);
        below += n;
        weight += inside;
        sum += inside * middle(k);
    }
    bool cut = (frame.history.w & uint(MASU_HISTORY_CUT)) != 0u;
    /* What no frame leaves is not kept: it would take as long to go as it is far away. */
    float least = min(masu_log2(push.min), 0.0), most = max(masu_log2(push.max), 0.0);
    float before = masu_sane(adapted, least, most);
    float wanted = cut ? 0.0 : before;
    if (weight > 0.0) {
        wanted = masu_log2(MASU_EXPOSURE_KEY) - sum / weight;
        wanted = clamp(wanted, masu_log2(push.min), masu_log2(push.max)); /* within least .. most */
    }
    float speed = wanted > before ? push.brighten : push.darken;
    float share = 1.0 - masu_exp2(-1.44269504 * speed * max(frame.eye_lo.w, 0.0));
    float next = cut ? wanted : mix(before, wanted, share);
    adapted = next;
    exposure = frame.sun_direction.w * masu_exp2(next);
    if (masu_counting) {
        masu_counters[2 * MASU_COUNTER_EXPOSURE] = floatBitsToUint(exposure);
    }
}
