/*
 * specular_keep.comp: copies the reflection history for the next frame. Command buffers are
 * recorded once, so images cannot alternate and a copy is needed. It copies all
 * texels, not only the listed tiles: a tile without reflections must not leave values of an older
 * frame to the next one.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_keep.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "specular/filter.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D mean_image;
layout(set = MASU_SET_PASS, binding = 2) uniform usampler2D age_image;
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D shown_image;
layout(set = MASU_SET_PASS, binding = 4, rg32ui) uniform writeonly uimage2D old_guide_image;
layout(set = MASU_SET_PASS, binding = 5, rgba16f) uniform writeonly image2D old_mean_image;
layout(set = MASU_SET_PASS, binding = 6, r32ui) uniform writeonly uimage2D old_age_image;
#ifdef MASU_TAA
layout(set = MASU_SET_PASS, binding = 7, rgba16f) uniform writeonly image2D old_steady_image;
#endif

void main()
{
    masu_count_begin();
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (masu_specular_inside(uvec2(texel))) {
        uvec2 guide = texelFetch(guide_image, texel, 0).rg;
        vec4 mean = vec4(0.0, 0.0, 0.0, -1.0);
        vec4 shown = vec4(0.0);
        uint age = 0u;
        if (masu_unpack_guide(guide).there) {
            mean = texelFetch(mean_image, texel, 0);
            mean = vec4(masu_tamed(mean.rgb), masu_sane(mean.a, 0.0, 65504.0));
            shown = vec4(masu_tamed(texelFetch(shown_image, texel, 0).rgb), 1.0);
            age = texelFetch(age_image, texel, 0).r;
        }
        MASU_STORE_UINT(old_guide_image, texel, uvec4(guide, 0u, 0u));
        MASU_STORE_HALF(old_mean_image, texel, mean);
        MASU_STORE_UINT(old_age_image, texel, uvec4(age));
#ifdef MASU_TAA
        MASU_STORE_HALF(old_steady_image, texel, shown);
#endif
    }
    masu_count_end();
}
