/*
 * rcas.comp: FSR1 contrast-adaptive sharpening, fp32, one invocation for each pixel.
 *
 * Five taps in a cross; the lobe is the strongest that drives no channel out of 0..1. AMD's version
 * (ffx_fsr1 v1.0.2) ends with an approximate reciprocal; the exact division here differs from it by
 * at most 0.8/255 and, unlike it, returns a constant picture unchanged. The scalar judge is
 * tests/reference/fsr1.c. No noise guard: the input is rendered, not filmed.
 *
 * Push constants: render_* = valid corner of the input = output_*, param.x = exp2(-stops), in 0..1,
 * 1 the sharpest, 0 a copy.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/store.glsl"
#include "shared/unorm8.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(push_constant) uniform Push
{
    masu_push pc;
};

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D target;

/* Rings darker than the first, or closer to white than the second, have no room on that side: the
 * quotient there would be 0/0. Far below one step of 8 bits, far above a denormal. */
const float dark = 1e-6;
const float bright = 1.0 - 1e-6;

vec3 fetch(ivec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    return masu_fetched_unorm8(texelFetch(source, clamp(at, ivec2(0), last), 0).rgb);
}

/* Most negative lobe for one channel, given the least and most of its ring; at least -1. */
float limit_of(float least, float most, float centre)
{
    float limit = -1.0;
    if (most > dark) {
        limit = max(limit, -(min(least, centre) / (4.0 * most)));
    }
    if (least < bright) {
        limit = max(limit, (1.0 - max(most, centre)) / (4.0 * least - 4.0));
    }
    return limit;
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(pc.output_width, pc.output_height)))) {
        return;
    }
    vec3 up = fetch(at + ivec2(0, -1));
    vec3 left = fetch(at + ivec2(-1, 0));
    vec3 centre = fetch(at);
    vec3 right = fetch(at + ivec2(1, 0));
    vec3 down = fetch(at + ivec2(0, 1));

    vec3 least = min(min(up, left), min(right, down));
    vec3 most = max(max(up, left), max(right, down));
    float lobe = max(max(limit_of(least.r, most.r, centre.r), limit_of(least.g, most.g, centre.g)),
                     limit_of(least.b, most.b, centre.b));
    precise float strength = clamp(lobe, -0.1875, 0.0) * masu_sane(pc.param.x, 0.0, 1.0);

    /* 4 * -0.1875 + 1 = 0.25: never near 0. */
    precise float denominator = 4.0 * strength + 1.0;
    precise vec3 ring = (up + left) + (right + down);
    precise vec3 sharpened = (strength * ring + centre) / denominator;
    MASU_STORE_UNORM(target, at, vec4(sharpened, 1.0));
}
