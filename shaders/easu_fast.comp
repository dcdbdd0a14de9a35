/*
 * easu_fast.comp: the cheap form of easu.comp (upscale/easu_fast.glsl), one invocation for each
 * output pixel. With MASU_BYTES the input is known to have 8 bits; with MASU_COUNTED tiles that
 * leave early are counted.
 *
 * Push constants: render_* = valid corner of the input, output_* = size to write, push.scale_* = input
 * size * (1 / output size).
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef MASU_HALF
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#endif
#define MASU_PUSH masu_push_easu_fast
#include "shared/masu_shared.h"
#ifdef MASU_COUNTED
#include "shared/counters.glsl"
#endif
#include "shared/output.glsl"
#include "upscale/easu_fast.glsl"
#include "upscale/place.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT) uniform writeonly image2D target;

#ifdef MASU_COUNTED
shared uint filtered; /* not 0: some pixel of the tile */
#endif

vec3 fetch(ivec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    vec3 texel = texelFetch(source, clamp(at, ivec2(0), last), 0).rgb;
#ifdef MASU_BYTES
    return texel;
#else
    return masu_sane_unit(texel);
#endif
}

vec3 upscaled(uvec2 at)
{
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    ivec2 f = place.texel;
    masu_taps t;
    t.f = fetch(f);
    t.g = fetch(f + ivec2(1, 0));
    t.j = fetch(f + ivec2(0, 1));
    t.k = fetch(f + ivec2(1, 1));
    vec3 least = min(min(t.f, t.g), min(t.j, t.k));
    vec3 most = max(max(t.f, t.g), max(t.j, t.k));
    if (masu_flat(least, most)) {
        return masu_bilinear(t, place.p);
    }
#ifdef MASU_COUNTED
    atomicOr(filtered, 1u);
#endif
    t.b = fetch(f + ivec2(0, -1));
    t.c = fetch(f + ivec2(1, -1));
    t.e = fetch(f + ivec2(-1, 0));
    t.h = fetch(f + ivec2(2, 0));
    t.i = fetch(f + ivec2(-1, 1));
    t.l = fetch(f + ivec2(2, 1));
    t.n = fetch(f + ivec2(0, 2));
    t.o = fetch(f + ivec2(1, 2));
    return masu_easu_fast(t, place.p, least, most);
}

void main()
{
#ifdef MASU_COUNTED
    masu_count_begin();
    if (gl_LocalInvocationIndex == 0u) {
        filtered = 0u;
    }
    barrier();
#endif
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        MASU_STORE_COLOR(target, at, upscaled(at));
    }
#ifdef MASU_COUNTED
    barrier();
    if (gl_LocalInvocationIndex == 0u) {
        masu_count(MASU_COUNTER_EASU_TILES_EARLY, filtered == 0u ? 1u : 0u);
    }
    masu_count_end();
#endif
}
