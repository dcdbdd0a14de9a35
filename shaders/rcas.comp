/*
 * rcas.comp: FSR1 contrast-adaptive sharpening, fp32, one invocation for each pixel.
 *
 * Five taps in a cross; the lobe is the strongest that drives no channel out of 0..1. AMD's version
 * (ffx_fsr1 v1.0.2) ends with an approximate reciprocal; the true one here differs from it by at most
 * 0.8/255 and, unlike it, returns a constant picture unchanged. The scalar judge is
 * tests/reference/fsr1.c. No noise guard: the input is rendered, not filmed.
 *
 * Push constants: output_* = size of input and output, push.last_* = its last pixel, push.lobe =
 * exp2(-stops), in 0..1, 1 the sharpest, 0 a copy, push.stops = exp2(stops).
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_PUSH masu_push_rcas
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "shared/unorm.glsl"
#include "upscale/rcas.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT) uniform writeonly MASU_COLOR_IMAGE target;

vec3 fetch(int x, int y)
{
    return masu_fetched_unorm(texelFetch(source, ivec2(x, y), 0).rgb);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (masu_is_outside(gl_GlobalInvocationID.xy)) {
        return;
    }
    /* `at` is inside: each clamp has one side. */
    ivec2 before = max(at - 1, 0), after = min(at + 1, ivec2(push.last_x, push.last_y));
    vec3 sharpened = masu_rcas(fetch(at.x, before.y), fetch(before.x, at.y), fetch(at.x, at.y),
                               fetch(after.x, at.y), fetch(at.x, after.y), push.lobe,
                               push.stops);
    MASU_STORE_FILTERED(target, at, sharpened);
}
