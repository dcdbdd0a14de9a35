/*
 * static_velocity.comp: the velocity of a static SDF and of the sky. Their points have not moved in
 * world space, so the depth and the two cameras give it; the field is not evaluated. Polygons have
 * written theirs (gbuffer.frag). An SDF that may change has sdf_velocity.comp.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#ifdef MASU_POLYGONS
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_IMAGE 1
#else
#define MASU_FIRST_IMAGE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 1, rgba16f)
    uniform writeonly image2D velocity_image;

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        bool polygon = false;
#ifdef MASU_POLYGONS
        polygon = depth > 0.0 && depth == texelFetch(raster_depth, ivec2(at), 0).r;
#endif
        if (!polygon) {
            vec4 velocity = masu_sky_velocity(at, size);
            if (depth > 0.0) {
                float z = frame.forward.w / depth;
                velocity = masu_point_velocity(masu_pixel_ray(at, size), z, vec3(0.0), vec2(size));
            }
            MASU_STORE_HALF(velocity_image, at, velocity);
        }
    }
    masu_count_end();
}
