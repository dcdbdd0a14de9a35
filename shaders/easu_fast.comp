/*
 * easu_fast.comp: the fast variant of easu.comp (upscale/easu_fast.glsl), one invocation per output
 * pixel. With MASU_BYTES the input format contains only 0..1; with MASU_COUNTED, tiles that exit
 * early are counted.
 *
 * Push constants: render_*: valid corner of the input, output_*: size to write, push.scale_*: input
 * size * (1 / output size).
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef MASU_HALF
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#endif
#include "push/easu_fast.h"
#include "shared/counters.h"
#include "shared/types.h"
#ifdef MASU_COUNTED
#include "shared/counters.glsl"
#endif
#include "shared/output.glsl"
#include "shared/unorm.glsl"
#include "upscale/easu_fast.glsl"
#include "upscale/place.glsl"
#include "upscale/taps.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

#ifdef MASU_COUNTED
shared uint filtered; /* not 0: a pixel of the tile needs filtering */
#endif

vec3 upscaled(uvec2 at)
{
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    masu_cross c = masu_cross_of(place.texel);
    masu_taps t;
    masu_fetch_middle(source, c, t);
    vec3 least = min(min(t.f, t.g), min(t.j, t.k));
    vec3 most = max(max(t.f, t.g), max(t.j, t.k));
    if (masu_flat(least, most)) {
        return masu_bilinear(t, place.p);
    }
#ifdef MASU_COUNTED
    atomicOr(filtered, 1u);
#endif
    masu_fetch_around(source, c, t);
    return masu_easu_fast(t, place.p, least, most);
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
#ifdef MASU_COUNTED
    masu_count_begin();
    if (gl_LocalInvocationIndex == 0u) {
        filtered = 0u;
    }
    barrier();
    if (!masu_is_outside(at)) {
        MASU_STORE_FILTERED(target, at, upscaled(at));
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u) {
        masu_count(MASU_COUNTER_EASU_TILES_EARLY, filtered == 0u ? 1u : 0u);
    }
    masu_count_end();
#else
    if (masu_is_outside(at)) {
        return;
    }
    MASU_STORE_FILTERED(target, at, upscaled(at));
#endif
}
