/*
 * tonemap.comp: exposure, a tone curve, encoding. FSR1 wants what comes out here: display-encoded,
 * 0..1.
 *
 * shaders/shared/tone.glsl has the curves and encodings; output.glsl says why targets beyond white have
 * another one. Push constants: push.white = white, nits; push.peak = the most that is shown, in whites;
 * push.roots not 0: what follows is rung.temporal, whose samples are roots of display light (upscale/roots.glsl).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define MASU_OUTPUT
#define MASU_PUSH masu_push_tonemap
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/output.glsl"
#include "shared/encode.glsl"
#include "upscale/roots.glsl"
#ifdef MASU_SILHOUETTES
#include "shared/silhouettes.glsl"
#endif

layout(constant_id = 5) const uint tone = 2;

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D hdr_image;
#ifdef MASU_SILHOUETTES
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D silhouettes_image;
#define MASU_FIRST_WRITE 2
#else
#define MASU_FIRST_WRITE 1
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE ldr_image;

#ifdef MASU_METERED
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_EXPOSURE, std430) readonly buffer Exposure
{
    float metered_exposure;
};
#endif

float exposure()
{
#ifdef MASU_METERED
    return metered_exposure;
#else
    return frame.sun_direction.w;
#endif
}

vec3 curve(vec3 x, float most)
{
    return tone == 1u ? x : tone == 2u ? masu_tone_filmic(x) : masu_tone_neutral(x, most);
}

/* What is shown of a pixel alone. */
vec3 shown(ivec2 at)
{
    vec3 hdr = texelFetch(hdr_image, at, 0).rgb;
    return curve(masu_exposed(hdr, exposure()), max(push.peak, 1.0));
}

#ifdef MASU_SILHOUETTES
/* Display light, as an eye takes the mean of it: of radiance a lamp that covers a tenth of the pixel would turn it
 * white (docs/design/31-truth.md). What is covered shows the neighbour's colour, carried on to the rim by what it differs from
 * the next one: surfaces darken or brighten most where they turn away. One loop, so that the curve is compiled once. */
vec3 blended(ivec2 at, ivec2 size)
{
    ivec2 low = max(at - 1, ivec2(0));
    ivec2 high = min(at + 1, size - 1);
    uint own = texelFetch(silhouettes_image, at, 0).r;
    uvec4 others = uvec4(texelFetch(silhouettes_image, ivec2(high.x, at.y), 0).r,
                         texelFetch(silhouettes_image, ivec2(low.x, at.y), 0).r,
                         texelFetch(silhouettes_image, ivec2(at.x, high.y), 0).r,
                         texelFetch(silhouettes_image, ivec2(at.x, low.y), 0).r);
    /* None outside of the picture. */
    others *= uvec4(high.x > at.x, low.x < at.x, high.y > at.y, low.y < at.y);
    if ((own | others.x | others.y | others.z | others.w) == 0u) {
        return shown(at);
    }
    vec4 weights = masu_silhouette_weights(own, others);
    float most = max(push.peak, 1.0); /* what is brighter, as without a curve, is no brighter there */
    vec3 near = vec3(0.0);
    vec3 sum = vec3(0.0);
    [[dont_unroll]] for (int i = 0; i < 9; i++) {
        int k = i >> 1; /* 4: the pixel itself */
        bool next = (i & 1) != 0;
        float weight = k == 4 ? 1.0 - weights.x - weights.y - weights.z - weights.w : weights[k];
        if (!(weight > 0.0) || (next && (own >> (16 + k) & 1u) == 0u)) {
            continue;
        }
        ivec2 way = k == 4 ? ivec2(0) : masu_beside(k) * (next ? 2 : 1);
        vec3 y = min(shown(clamp(at + way, ivec2(0), size - 1)), most);
        vec3 on = near - y;
        bool same = all(lessThan(abs(on), 0.3 * near)); /* else it is another thing */
        sum += weight * (!next ? y : same ? 0.75 * on : vec3(0.0));
        near = y;
    }
    return clamp(sum, 0.0, most);
}
#endif

/* Roots, or what a display takes: of display light. */
vec3 stored(vec3 y)
{
    return push.roots != 0u ? sqrt(clamp(y * masu_rcp(push.peak), 0.0, 1.0)) : masu_encoded(y, push.white);
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
#ifdef MASU_SILHOUETTES
        vec3 y = push.silhouettes != 0u ? blended(ivec2(at), ivec2(pc.output_width, pc.output_height)) : shown(ivec2(at));
#else
        vec3 y = shown(ivec2(at));
#endif
#if defined(MASU_TEN)
        MASU_STORE_CHECKED(ldr_image, at, vec3, stored(y), uvec4(stored_bits(masu_sane_unit(masu_store_value), at)));
#elif defined(MASU_DEEP)
        if (push.roots != 0u) {
            MASU_STORE_HALF(ldr_image, at, vec4(masu_nearest_half(stored(y)), 0.0));
        } else if (masu_encoding == MASU_OUTPUT_LINEAR && masu_is_last()) { /* not through PQ and back */
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
