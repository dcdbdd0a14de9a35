/*
 * receiver_mask.comp: shadow receivers in light space: for each texel of the sun's part of the
 * occluder atlas, and for each cascade, the farthest visible surface that the sun may light, for
 * cull.comp. A surface contributes if shadow.comp samples its shadow, or might sample it after
 * rounding.
 *
 * push.header: the header of src/frame/occlusion.c.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/receiver_mask.h"
#include "shared/culling.h"
#include "shared/shadow.h"
#include "shared/globals.glsl"
#include "shared/culling.glsl"
#include "shared/pack.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SEEN, std430) buffer Seen
{
    uint seen[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SHADOW, std140) uniform Shadow
{
    masu_shadow_uniforms shadow;
};

/* Adds a point relative to the camera to each cascade that shadow.comp samples for it. */
void note(vec3 rel)
{
    mat4 clip = masu_cull_matrix(masu_cull_view(1u) + MASU_CULL_VIEW_CLIP);
    vec4 p = clip * vec4(rel, 1.0);
    vec2 texel = floor((p.xy * 0.5 + 0.5) * float(MASU_ATLAS_SUN));
    if (!all(greaterThanEqual(texel, vec2(0.0))) || !all(lessThan(texel, vec2(MASU_ATLAS_SUN)))) {
        return; /* this frame draws no cascade there */
    }
    uint depth = floatBitsToUint(clamp(p.z, 0.0, 1.0));
    uint word = masu_cull_word(MASU_CULL_RECEIVERS) + uint(texel.y) * uint(MASU_ATLAS_SUN) +
                uint(texel.x);
    uint count = min(uint(shadow.reach.x), uint(MASU_CASCADES_MAX));
    for (uint k = 0u; k < uint(MASU_CASCADES_MAX); k++) {
        if (k >= count) {
            break;
        }
        vec3 at = vec3(dot(shadow.row0[k].xyz, rel) + shadow.row0[k].w,
                       dot(shadow.row1[k].xyz, rel) + shadow.row1[k].w,
                       dot(shadow.row2[k].xyz, rel) + shadow.row2[k].w);
        float inside = (1.0 - 3.0 / shadow.rect[k].z) - max(abs(at.x), abs(at.y));
        uint here = word + k * MASU_RECEIVER_WORDS;
        /* For most pixels a neighbour has already written the texel. */
        if (inside >= -1e-4 && at.z >= -1e-4 && seen[here] > depth) {
            atomicMin(seen[here], depth);
        }
        if (inside > MASU_CASCADE_BLEND + 1e-4 && at.z > 1e-4) {
            break; /* it has the full weight */
        }
    }
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        uint texel = texelFetch(normal_image, ivec2(at), 0).r;
        float z = frame.forward.w * masu_rcp(depth);
        vec3 rel = masu_pixel_ray(at, size) * z;
        bool there = depth > 0.0 && !masu_is_unlit_texel(texel);
        bool faces = dot(masu_unpack_normal(texel), frame.sun_direction.xyz) > -1e-3;
        bool fades = (z - shadow.reach.y) * shadow.reach.z > 1.001;
        if (there && faces && !fades && masu_finite(rel)) {
            note(rel);
        }
    }
}
