/*
 * expose.comp: automatic exposure from the histogram of meter.comp, with adaptation over time. One
 * workgroup, in which one invocation adds up the bins: a fixed order, so that equal images give
 * bit-identical results.
 *
 * The metered value is the mean of log2 luminance without the darkest and the brightest shares of
 * the pixels; a bin across the end of a share is weighted by its part inside. The target exposure
 * maps the mean to the luminance of a grey card. In log2, exposure moves by 1 - exp(-speed dt) of
 * the remaining distance, so that two frames of dt equal one frame of 2 dt. A frame without any
 * metered pixel leaves it unchanged.
 *
 * Push constants: push: speed to brighten, to darken, min, max; low and high: shares ignored at the
 * dark and at the bright end, in units of 2^-16.
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
    float adapted; /* log2 of the metered part */
    uint unused[MASU_EXPOSURE_HEADER - 2];
    uint bins[MASU_EXPOSURE_BINS];
};

shared uint counts[MASU_EXPOSURE_BINS];

/* log2 luminance at the centre of a bin. */
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
    /* At most 2^28 pixels: a float's rounding error is below 16 of them. */
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
    /* Clamped to the reachable range: a value beyond it would take time to return. */
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
