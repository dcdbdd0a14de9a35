/*
 * pick_tell.comp: resolves picking: the visible object at the pixel that the host requests
 * (frame.temporal.w), and its position. The result is the closest polygon that the pick pass found
 * there, the SDF, or the sky. Depth is the image's own, except for transparent surfaces, which
 * write no depth.
 *
 * With polygons and an SDF, a pixel shows the SDF if image and raster depth differ in any bit:
 * classify.comp copies raster depth unchanged. (Depth drawn by the pick pass differs from raster
 * depth by rounding of the interpolation. Compared with the image's depth, it could report polygon
 * or SDF on ground that the SDF touches.)
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/picking.h"
#include "shared/types.h"
#include "shared/guard.glsl"
#include "shared/globals.glsl"

layout(local_size_x = 1) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
#ifdef MASU_POLYGONS
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D id_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D pick_depth_image;
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D raster_depth_image;
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PICKED, std430) buffer Picked
{
    uint picked[];
};

void main()
{
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    uvec2 pixel = min(uvec2(frame.temporal.w & 0xFFFFu, frame.temporal.w >> 16), size - 1u);
    float depth = texelFetch(depth_image, ivec2(pixel), 0).r;
    uint what = depth > 0.0 ? MASU_PICKED_SDF : MASU_PICKED_SKY;
    uint id = 0xFFFFFFFFu;
#ifdef MASU_POLYGONS
    ivec2 at = ivec2(pixel & 1u);
    uint found = texelFetch(id_image, at, 0).r;
    float nearest = texelFetch(pick_depth_image, at, 0).r;
    bool sdf = depth != texelFetch(raster_depth_image, ivec2(pixel), 0).r;
    bool blended = (found & MASU_PICK_BLENDED) != 0u;
    if (depth > 0.0 && !sdf) {
        what = MASU_PICKED_INSTANCE; /* of unknown id */
    }
    if (found != 0u && (sdf || blended ? nearest > depth : depth > 0.0)) {
        what = MASU_PICKED_INSTANCE;
        id = (found & ~MASU_PICK_BLENDED) - 1u;
        depth = sdf || blended ? nearest : depth;
    }
#endif
    vec3 rel = what == MASU_PICKED_SKY
                   ? vec3(0.0)
                   : masu_pixel_ray(pixel, size) * (frame.forward.w * masu_rcp(depth));
    picked[0] = what;
    picked[1] = id;
    picked[2] = floatBitsToUint(depth);
    picked[3] = floatBitsToUint(rel.x);
    picked[4] = floatBitsToUint(rel.y);
    picked[5] = floatBitsToUint(rel.z);
}
