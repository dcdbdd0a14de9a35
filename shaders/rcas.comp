/*
 * rcas.comp: FSR1 contrast-adaptive sharpening, fp32. An invocation writes two horizontally
 * adjacent pixels, which share two of their ten texels.
 *
 * Five taps in a cross; the lobe is the strongest that keeps all channels in 0..1. AMD's version
 * (ffx_fsr1 v1.0.2) ends with an approximate reciprocal. The exact reciprocal here differs from it
 * by at most 0.8/255 and, unlike it, leaves a constant image unchanged. tests/reference/fsr1.c is
 * the scalar reference. There is no noise guard: the input is rendered, not filmed.
 *
 * Push constants: output_*: size of input and output, push.last_*: its last pixel, push.lobe:
 * exp2(-stops), in 0..1, 1 the sharpest, 0 a copy, push.stops: exp2(stops).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/rcas.h"
#include "shared/types.h"
#include "shared/output.glsl"
#include "shared/unorm.glsl"
#include "upscale/rcas.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

vec3 fetch(int x, int y)
{
    return masu_fetched_unorm(texelFetch(source, ivec2(x, y), 0).rgb);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) * ivec2(2, 1);
    ivec2 last = ivec2(push.last_x, push.last_y);
    if (at.x > last.x || masu_is_outside(uvec2(at))) {
        return;
    }
    /* `at` is inside, so one clamp per direction suffices. */
    ivec2 before = max(at - 1, 0), after = min(at + 1, last);
    vec3 up = fetch(at.x, before.y), up2 = fetch(after.x, before.y);
    vec3 down = fetch(at.x, after.y), down2 = fetch(after.x, after.y);
    vec3 left = fetch(before.x, at.y), right2 = fetch(min(at.x + 2, last.x), at.y);
    vec3 centre = fetch(at.x, at.y), centre2 = fetch(after.x, at.y);
#ifdef MASU_EXACT
    vec3 first = masu_rcas(up, left, centre, centre2, down, push.lobe, push.stops);
    vec3 second = masu_rcas(up2, centre, centre2, right2, down2, push.lobe, push.stops);
#else
    vec3 off = masu_rcas_off(up, left, centre, centre2, down);
    vec3 off2 = masu_rcas_off(up2, centre, centre2, right2, down2);
    vec2 share = vec2(0.0);
    if (masu_rcas_asked(off, off2)) {
        share.x = masu_rcas_share(up, left, centre, centre2, down, push.stops);
        share.y = masu_rcas_share(up2, centre, centre2, right2, down2, push.stops);
    }
    vec3 first = centre + share.x * off;
    vec3 second = centre2 + share.y * off2;
#endif
    MASU_STORE_FILTERED(target, at, first);
    if (masu_whole_groups || at.x < last.x) { /* eight columns make pairs */
        ivec2 next = at + ivec2(1, 0);
        MASU_STORE_FILTERED(target, next, second);
    }
}
