/*
 * bilinear.comp: bilinear upscale, the baseline for comparisons: the mean of the four texels around
 * a pixel, in display encoding. One invocation per output pixel.
 *
 * Push constants: render_*: valid corner of the input, output_*: size to write, push.scale_*: input
 * size * (1 / output size).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/bilinear.h"
#include "shared/types.h"
#include "shared/output.glsl"
#include "upscale/place.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

vec3 fetch(ivec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    return masu_sane_unit(texelFetch(source, clamp(at, ivec2(0), last), 0).rgb);
}

void main()
{
    uvec2 to = uvec2(pc.output_width, pc.output_height);
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, to))) {
        return;
    }
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    ivec2 f = place.texel;
    vec3 here = fetch(f), under = fetch(f + ivec2(0, 1));
    /* As differences: four equal texels give exactly that texel. */
    vec3 above = here + place.p.x * (fetch(f + ivec2(1, 0)) - here);
    vec3 below = under + place.p.x * (fetch(f + ivec2(1, 1)) - under);
    vec3 result = above + place.p.y * (below - above);
    MASU_STORE_COLOR(target, at, result);
}
