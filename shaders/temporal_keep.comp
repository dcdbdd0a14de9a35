/*
 * temporal_keep.comp: of each pixel the nearest depth of 3x3, for the next frame's temporal_find.comp: a pixel that a
 * silhouette is near belongs to what is in front.
 *
 * Push constants: output_* = the render size; push.depth_*: 1 / size of the image of depths.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/temporal_keep.h"
#include "shared/types.h"
#include "shared/push.glsl"
#include "shared/store.glsl"
#include "upscale/corners.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1, r32f) uniform writeonly image2D kept_image;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        vec2 texel = vec2(push.depth_x, push.depth_y);
        float nearest = masu_most_of(masu_corners_of(depth_image, vec2(at), vec2(size), texel));
        MASU_STORE_SAFE(kept_image, at, vec4(nearest));
    }
}
