/*
 * specular_taa.comp: a second, short temporal accumulation of the filtered reflections. Each frame
 * traces another one of a texel's four pixels and rotates the pattern of specular_reuse; this pass
 * averages the differences that the longer mean has not removed. The history is clamped to the
 * colours of the current 3x3 texels (Karis, "High Quality Temporal Supersampling", SIGGRAPH 2014;
 * by their deviation instead of their bounds: Salvi, "An Excursion in Temporal Supersampling", GDC
 * 2016), which have little noise here.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_taa.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "specular/filter.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D light_image;
layout(set = MASU_SET_PASS, binding = 2) uniform usampler2D age_image;
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D old_image;
layout(set = MASU_SET_PASS, binding = 4, rgba16f) uniform writeonly image2D steady_image;

const float reach = 8.0; /* 1/60 s */
const float clamp_width = 1.5; /* deviations */

/* a: 0: no history. */
vec4 look(ivec2 texel, vec2 moved)
{
    vec2 scale = vec2(frame.history.yz) / vec2(pc.render_width, pc.render_height);
    vec2 place = (2.0 * vec2(texel) + 1.0 + moved) * scale * 0.5 - 0.5;
    place = masu_sane(vec4(place, 0.0, 0.0), -2.0, 32768.0).xy;
    vec2 whole = round(place);
    if (all(lessThan(abs(place - whole), vec2(2e-3)))) {
        place = whole;
    }
    vec2 corner = floor(place);
    vec2 part = place - corner;
    ivec2 last = (ivec2(frame.history.yz) + 1) / 2 - 1;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 off = ivec2(k & 1, k >> 1);
        ivec2 at = ivec2(corner) + off;
        float bilinear = mix(1.0 - part.x, part.x, float(off.x)) *
                         mix(1.0 - part.y, part.y, float(off.y));
        if (!(bilinear > 0.0) || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
            continue;
        }
        vec4 old = texelFetch(old_image, at, 0);
        if (old.a > 0.0 && masu_finite(old)) {
            sum += bilinear * vec4(masu_tamed(old.rgb), 1.0);
        }
    }
    return sum.a > 0.05 ? vec4(sum.rgb / sum.a, sum.a) : vec4(0.0);
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        vec4 result = vec4(0.0);
        if (g.there) {
            result = vec4(masu_tamed(texelFetch(light_image, ivec2(texel), 0).rgb), 1.0);
            uint moved = texelFetch(age_image, ivec2(texel), 0).g;
            if (frame.history.y != 0u && moved != masu_unmoved) {
                vec4 old = look(ivec2(texel), unpackHalf2x16(moved));
                ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
                vec3 sum = vec3(0.0);
                vec3 squares = vec3(0.0);
                float count = 0.0;
                for (int k = 0; k < 9; k++) {
                    ivec2 at = ivec2(texel) + ivec2(k % 3 - 1, k / 3 - 1);
                    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last)) ||
                        !masu_unpack_guide(texelFetch(guide_image, at, 0).rg).there) {
                        continue;
                    }
                    vec3 c = masu_ycocg(masu_tamed(texelFetch(light_image, at, 0).rgb));
                    sum += c;
                    squares += c * c;
                    count += 1.0;
                }
                vec3 mean = sum / max(count, 1.0);
                vec3 wide = clamp_width * sqrt(max(squares / max(count, 1.0) - mean * mean, 0.0)) +
                            1e-3 + 0.02 * mean.x;
                vec3 from = masu_ycocg(old.rgb) - mean;
                vec3 times = abs(from) / wide;
                float most = max(max(times.x, times.y), max(times.z, 1.0));
                vec3 history = max(masu_from_ycocg(mean + from / most), vec3(0.0));
                if (old.a > 0.0) {
                    result.rgb = mix(history, result.rgb, masu_time_share(reach));
                }
            }
        }
        MASU_STORE_HALF(steady_image, texel, result);
    }
    masu_count_end();
}
