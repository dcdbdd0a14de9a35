/*
 * velocity.comp: velocity of sky pixels in scenes without an SDF, from the rotation of the camera.
 * Polygons have written their own velocity (gbuffer.frag).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1, rgba16f) uniform writeonly image2D velocity_image;

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size)) && !(texelFetch(depth_image, ivec2(at), 0).r > 0.0)) {
        MASU_STORE_HALF(velocity_image, at, masu_sky_velocity(at, size));
    }
    masu_count_end();
}
