/*
 * easu.comp: FSR1 edge-adaptive upscale, fp32, one invocation for each output pixel.
 *
 * Equal to AMD's published fp32 shader (ffx_fsr1 v1.0.2), approximate reciprocals included; the
 * scalar judge is tests/reference/fsr1.c. It differs from the original in how it reads: 12 clamped
 * texelFetch instead of 12 gathers, because the input is the corner of a larger image and a gather
 * at its border would return what an earlier frame left outside.
 *
 * Why everything is `precise`: the result jumps, by up to tens of 255ths, where floor(p) changes,
 * where the gradient counts as none, and where three neighbours of different colour have the same
 * luma (one unit in the last place then decides between a straight edge and none). With operations
 * that are correctly rounded by the standard and never fused or reordered, and with inputs and
 * scale made independent of the driver below, all drivers take the same side.
 *
 * Push constants: render_* = valid corner of the input, output_* = size to write, push.scale_* = input
 * size * (1 / output size).
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_PUSH masu_push_easu
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "shared/unorm8.glsl"
#include "upscale/easu.glsl"
#include "upscale/place.glsl"

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
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, uvec2(pc.output_width, pc.output_height)))) {
        return;
    }
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    ivec2 f = place.texel;
    masu_taps t;
    t.b = fetch(f + ivec2(0, -1));
    t.c = fetch(f + ivec2(1, -1));
    t.e = fetch(f + ivec2(-1, 0));
    t.f = fetch(f);
    t.g = fetch(f + ivec2(1, 0));
    t.h = fetch(f + ivec2(2, 0));
    t.i = fetch(f + ivec2(-1, 1));
    t.j = fetch(f + ivec2(0, 1));
    t.k = fetch(f + ivec2(1, 1));
    t.l = fetch(f + ivec2(2, 1));
    t.n = fetch(f + ivec2(0, 2));
    t.o = fetch(f + ivec2(1, 2));
    vec3 result = masu_easu(t, masu_edge_of(t, place.p), place.p);
    MASU_STORE_COLOR(target, at, result);
}
