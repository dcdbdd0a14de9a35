/*
 * specular_filter.comp: spatial filter of reflections, as wide as the remaining noise needs. A
 * neighbour is weighted by its distance from the surface's plane, by the angle between the normals,
 * and by the difference of luma in standard deviations of the temporal mean: its variance divided
 * by the number of accumulated frames (Schied et al., "Spatiotemporal Variance-Guided Filtering",
 * HPG 2017). The filter therefore disappears as the mean converges.
 *
 * Fireflies: fewer than five frames do not average out a ray that has hit a lamp. Its luma is
 * limited to the mean of the eight neighbours plus some of their standard deviations, more with
 * each frame. In the first frame it is also weighted as without rung.temporal, since there is no
 * mean yet.
 *
 * The radius is the size of the lobe's footprint on the surface (filter.glsl). The sample pattern
 * is rotated by position and not by frame, so that the remaining noise does not flicker.
 *
 * push.taps: number of neighbours; push.luma_width: difference of luma, in standard deviations,
 * that halves a neighbour's weight (smaller with rung.temporal, which averages too); push.temporal:
 * not 0 with temporal accumulation; push.frames: length of the accumulation, 1/60 s.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/specular_filter.h"
#include "shared/reflections.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "noise/sequence.glsl"
#include "specular/filter.glsl"
#include "specular/tiles.glsl"
#include "trace/scene.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D light_image;
layout(set = MASU_SET_PASS, binding = 2) uniform usampler2D age_image;
layout(set = MASU_SET_PASS, binding = 3, rgba16f) uniform writeonly image2D smooth_image;

const float widest = 12.0; /* texels */

/* Mean and standard deviation of the luma of the eight neighbours, for pixels without temporal
 * accumulation or with few frames. The texel itself is excluded: a firefly would raise its own
 * limit. */
vec2 spread_around(ivec2 texel, masu_guide g, vec3 point, float width)
{
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    float sum = 0.0;
    float squares = 0.0;
    float count = 0.0;
    masu_flat flat_here = masu_flat_through(point, g.normal);
    [[dont_unroll]] for (int k = 0; k < 9; k++) {
        ivec2 at = texel + ivec2(k % 3 - 1, k / 3 - 1);
        if (k == 4 || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
            continue;
        }
        masu_guide o = masu_unpack_guide(texelFetch(guide_image, at, 0).rg);
        if (!o.there || !(abs(masu_specular_off(flat_here, uvec2(at), o)) < width)) {
            continue;
        }
        float y = masu_luma(masu_tamed(texelFetch(light_image, at, 0).rgb));
        sum += y;
        squares += y * y;
        count += 1.0;
    }
    /* One or two neighbours are too few for a limit. */
    float mean = sum / max(count, 1.0);
    return vec2(count > 2.0 ? mean : 65504.0, masu_sqrt(squares / max(count, 1.0) - mean * mean));
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        vec4 result = vec4(0.0);
        if (g.there) {
            vec4 own = texelFetch(light_image, ivec2(texel), 0);
            vec3 color = masu_tamed(own.rgb);
            result = vec4(color, 1.0);
            if (g.roughness > masu_mirror_roughness) {
                vec3 point = masu_specular_point(texel, g);
                float width = masu_texel_width(g);
                float y = masu_luma(color);
                float far = masu_sane(own.a, 0.0, 65504.0);
                float frames = 1.0;
                if (push.temporal != 0u) {
                    uint age = texelFetch(age_image, ivec2(texel), 0).r;
                    far = masu_age_far(age);
                    frames = max(masu_age_frames(age), 1.0);
                }
                float luma_width = max(push.luma_width, 2.0 / (frames * frames)), sigma;
                if (push.temporal != 0u && frames > 4.0) {
                    sigma = masu_sqrt(masu_sane(own.a, 0.0, 65504.0) - y * y) *
                            masu_rsqrt(min(frames, 2.0 / masu_time_share(float(push.frames))));
                } else {
                    vec2 spread = spread_around(ivec2(texel), g, point, width);
                    sigma = spread.y;
                    float most = spread.x + frames * (frames + 1.0) * sigma;
                    color *= y > most ? most / y : 1.0;
                    y = min(y, most);
                }
                float curvature = masu_guide_curvature(guide_image, ivec2(texel), g, point);
                float radius = masu_specular_reach(g, point, far, curvature);
                radius = clamp(radius * (1.0 + 2.0 / frames), 1.0, widest);
                float turn = float(masu_trace_noise(masu_noise_index(texel.x, texel.y, 3u)) &
                                   0xFFFFu) /
                             65536.0;
                ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
                masu_flat flat_here = masu_flat_through(point, g.normal);
                float narrow = 1.0 / max(width, 1e-9);
                vec4 sum = vec4(color, 1.0);
                for (uint k = 0u; k < uint(MASU_FILTER_TAPS_MAX); k++) {
                    if (k >= push.taps) {
                        break;
                    }
                    float share = (float(k) + 0.5) / float(push.taps);
                    float r = max(radius * sqrt(share), 1.0);
                    /* Vulkan specifies the precision of sin and cos only within -pi..pi. */
                    float angle = 6.2831853 * fract(0.38196601 * float(k) + turn) - 3.1415927;
                    ivec2 at = ivec2(texel) + ivec2(round(r * vec2(cos(angle), sin(angle))));
                    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
                        continue;
                    }
                    masu_guide o = masu_unpack_guide(texelFetch(guide_image, at, 0).rg);
                    if (!o.there || abs(o.roughness - g.roughness) > 0.1) {
                        continue;
                    }
                    float off = masu_specular_off(flat_here, uvec2(at), o) * narrow;
                    vec3 other = masu_tamed(texelFetch(light_image, at, 0).rgb);
                    float luma = abs(masu_luma(other) - y) / (luma_width * sigma + 1e-4);
                    float alike = masu_pow(max(dot(o.normal, g.normal), 0.0), 64.0);
                    float weight = alike * masu_exp2(-2.0 * off * off - luma - 2.0 * share);
                    sum += weight * vec4(other, 1.0);
                }
                result.rgb = sum.rgb / sum.a;
            }
        }
        MASU_STORE_HALF(smooth_image, texel, result);
    }
    masu_count_end();
}
