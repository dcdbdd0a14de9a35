/*
 * easu_twice.comp: EASU (upscale/easu.glsl) at exactly twice the width and height: easu.comp's
 * result at a lower cost.
 *
 * The centres of any 2x2 texels enclose 2x2 output pixels, the first at odd coordinates, each a
 * quarter of a texel from the closest centre on both axes. All four pixels read the same twelve
 * texels, with the same gradients and straightness at the four central ones; only their weights
 * differ. So an invocation writes all four and reads and analyses the texels once.
 *
 * If the four central texels differ by at most half a step of 8 bits, both EASU's result and the
 * bilinear mean are between them. The bilinear mean is then written, and the other eight texels are
 * not read.
 *
 * One invocation per 2x2 texels, including those across the image edge: one more per axis than
 * there are texels. An output of odd size is less than twice the input. Its last pixel may then
 * differ in position from easu.comp's by up to a pixel.
 *
 * Push constants: render_*: valid corner of the input, output_*: size to write.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/types.h"
#include "shared/output.glsl"
#include "shared/unorm.glsl"
#include "upscale/easu.glsl"
#include "upscale/taps.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) - 1;
    if (any(greaterThanEqual(texel, ivec2(pc.render_width, pc.render_height)))) {
        return;
    }
    masu_cross c = masu_cross_of(texel);
    masu_taps t;
    masu_fetch_middle(source, c, t);
    vec3 least = min(min(t.f, t.g), min(t.j, t.k));
    vec3 most = max(max(t.f, t.g), max(t.j, t.k));
    bool same = all(lessThan(most - least, vec3(0.51 / 255.0)));
    masu_centres e;
    if (!same) {
        masu_fetch_around(source, c, t);
        e = masu_centres_of(t);
    }
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    [[dont_unroll]] for (uint i = 0u; i < 4u; i++) {
        uvec2 at = uvec2(texel * 2 + 1) + uvec2(i & 1u, i >> 1);
        vec2 p = 0.25 + 0.5 * vec2(i & 1u, i >> 1);
        vec3 result;
        if (same) {
            vec3 above = t.f + p.x * (t.g - t.f);
            vec3 below = t.j + p.x * (t.k - t.j);
            result = above + p.y * (below - above);
        } else {
            vec4 w = masu_bilinear_weights(p);
            vec3 mean = masu_weighted_mean(
                t, masu_kernel_of(vec3(dot(w, e.x), dot(w, e.y), dot(w, e.z))), p);
            result = min(most, max(least, mean));
        }
        if (all(lessThan(at, size))) { /* false for -1, which wraps around */
            MASU_STORE_FILTERED(target, at, result);
        }
    }
}
