/*
 * tonemap.comp: exposure, tone curve and output encoding. The result is display-encoded, 0..1, as
 * FSR1 requires.
 *
 * shaders/shared/tone.glsl has the curves and encodings; output.glsl describes the encoding of
 * targets beyond white. Push constants: push.white = white in nits; push.peak = the largest output
 * value, relative to white; push.silhouettes not 0: silhouettes.comp provides the colour of some
 * pixels; push.roots not 0: rung.temporal follows, whose samples are square-root-encoded
 * display-linear colour (upscale/roots.glsl).
 *
 * MASU_LENS: bloom and grading of desc.post. Bloom mixes the scattered light into the radiance;
 * without bloom, a dummy image is bound and not read. Pixels of silhouettes.comp are already
 * tone-mapped: the effect of the lens on the pixel's own colour is added to them.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#include "push/tonemap.h"
#include "shared/target.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/output.glsl"
#include "shared/encode.glsl"
#include "upscale/roots.glsl"
#ifdef MASU_SILHOUETTES
#include "shared/silhouettes.glsl"
#endif
#ifdef MASU_LENS
#include "post/bloom.glsl"
#include "post/grade.glsl"
#endif

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D hdr_image;
#ifdef MASU_SILHOUETTES
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D silhouettes_image;
#define MASU_AT_BLOOM 2
#else
#define MASU_AT_BLOOM 1
#endif
#ifdef MASU_LENS
layout(set = MASU_SET_PASS, binding = MASU_AT_BLOOM) uniform sampler2D bloom_image;
#define MASU_FIRST_WRITE (MASU_AT_BLOOM + 1)
#else
#define MASU_FIRST_WRITE MASU_AT_BLOOM
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE ldr_image;

#ifdef MASU_METERED
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_EXPOSURE, std430) readonly buffer Exposure
{
    float metered_exposure;
};
#endif

float exposure_of_frame()
{
#ifdef MASU_METERED
    return metered_exposure;
#else
    return frame.sun_direction.w;
#endif
}

vec3 shown(vec3 radiance)
{
    return masu_shown(radiance, exposure_of_frame(), max(push.peak, 1.0));
}

#ifdef MASU_LENS
/* Radiance behind the lens. */
vec3 through_lens(vec3 radiance, ivec2 at)
{
    if (post.lens.x > 0.0) {
        vec2 place = (vec2(at) + 0.5) * 0.25, size = vec2(masu_bloom_size(4u));
        radiance = mix(radiance, masu_post_spline(bloom_image, place, size, 0.0), post.lens.x);
    }
    if (post.lens.w != 0.0) {
        radiance *= masu_vignette(vec2(at), vec2(pc.render_width, pc.render_height));
    }
    return radiance;
}
#endif

vec3 display_light(ivec2 at)
{
#ifdef MASU_SILHOUETTES
    uint seen = push.silhouettes != 0u ? texelFetch(silhouettes_image, at, 0).r : 0u;
    if (seen != 0u) {
        vec3 edge = masu_unpack_edge(seen) * max(push.peak, 1.0);
#ifdef MASU_LENS
        if (post.lens.x > 0.0 || post.lens.w != 0.0) {
            vec3 radiance = texelFetch(hdr_image, at, 0).rgb;
            edge = max(edge + shown(through_lens(radiance, at)) - shown(radiance), 0.0);
        }
#endif
        return edge;
    }
#endif
    vec3 radiance = texelFetch(hdr_image, at, 0).rgb;
#ifdef MASU_LENS
    radiance = through_lens(radiance, at);
#endif
    return shown(radiance);
}

/* Encodes display-linear colour: by square roots, or for the display. */
vec3 stored(vec3 y)
{
    return push.roots != 0u ? sqrt(clamp(y * masu_rcp(push.peak), 0.0, 1.0))
                            : masu_encoded(y, push.white);
}

#ifdef MASU_TEN
uint stored_bits(vec3 v, uvec2 at)
{
    return push.roots != 0u ? masu_root_bits(v, masu_dither(at)) : masu_ten_bits(v);
}
#endif

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        vec3 y = display_light(ivec2(at));
#ifdef MASU_LENS
        if (post.lens.w != 0.0) {
            y = masu_graded(y, push.peak);
        }
#endif
#if defined(MASU_TEN)
        MASU_STORE_CHECKED(ldr_image, at, vec3, stored(y),
                           uvec4(stored_bits(masu_sane_unit(masu_store_value), at)));
#elif defined(MASU_DEEP)
        if (push.roots != 0u) {
            MASU_STORE_HALF(ldr_image, at, vec4(masu_nearest_half(stored(y)), 0.0));
        } else if (masu_encoding == MASU_OUTPUT_LINEAR && masu_is_last()) { /* without PQ */
            vec3 white = min(y * push.white, 1e4) * (1.0 / 80.0);
            MASU_STORE_HALF(ldr_image, at, vec4(masu_nearest_half(white), 1.0));
        } else {
            MASU_STORE_COLOR(ldr_image, at, stored(y));
        }
#else
        MASU_STORE_COLOR(ldr_image, at, masu_encoded(y, push.white));
#endif
    }
    masu_count_end();
}
