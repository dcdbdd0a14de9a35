/*
 * rcas.comp: FSR1 contrast-adaptive sharpening, fp32, one invocation for each pixel.
 *
 * Five taps in a cross; the lobe is the strongest that drives no channel out of 0..1. AMD's version
 * (ffx_fsr1 v1.0.2) ends with an approximate reciprocal; the exact division here differs from it by
 * at most 0.8/255 and, unlike it, returns a constant picture unchanged. The scalar judge is
 * tests/reference/fsr1.c. No noise guard: the input is rendered, not filmed.
 *
 * Push constants: render_* = valid corner of the input = output_*, push.lobe = exp2(-stops), in 0..1,
 * 1 the sharpest, 0 a copy.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_PUSH masu_push_rcas
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "shared/unorm8.glsl"
#include "upscale/rcas.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT) uniform writeonly image2D target;

vec3 fetch(ivec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    return masu_fetched_unorm8(texelFetch(source, clamp(at, ivec2(0), last), 0).rgb);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(pc.output_width, pc.output_height)))) {
        return;
    }
    vec3 sharpened = masu_rcas(fetch(at + ivec2(0, -1)), fetch(at + ivec2(-1, 0)), fetch(at),
                               fetch(at + ivec2(1, 0)), fetch(at + ivec2(0, 1)),
                               masu_sane(push.lobe, 0.0, 1.0));
    MASU_STORE_COLOR(target, at, sharpened);
}
