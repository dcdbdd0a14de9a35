/*
 * easu.comp: FSR1 edge-adaptive upscale, fp32, one invocation per output pixel. With MASU_HALF,
 * taps are weighted in 16 bits.
 *
 * Follows AMD's published fp32 shader (ffx_fsr1 v1.0.2), including its approximate reciprocals.
 * With MASU_EXACT it is bit-identical to that shader as rounded by tests/reference/fsr1.c. It
 * differs from the original in its reads: 12 clamped texelFetch instead of 12 gathers, because the
 * input is the corner of a larger image, and a gather at its border would return texels of an
 * earlier frame. A clamp is per column or row: eight in all.
 *
 * Push constants: render_*: valid corner of the input, output_*: size to write, push.scale_*: input
 * size * (1 / output size).
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef MASU_HALF
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#endif
#include "push/easu.h"
#include "shared/types.h"
#include "shared/output.glsl"
#include "shared/unorm.glsl"
#include "upscale/easu.glsl"
#include "upscale/place.glsl"
#include "upscale/taps.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (masu_is_outside(at)) {
        return;
    }
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    masu_taps t = masu_fetch_taps(source, place.texel);
    vec3 result = masu_easu(t, masu_edge_of(t, place.p), place.p);
    MASU_STORE_FILTERED(target, at, result);
}
