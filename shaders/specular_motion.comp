/*
 * specular_motion.comp: motion of reflections since the previous frame, for specular_temporal. A
 * mirror shows a virtual point as far behind its surface as the reflected point is in front. The
 * virtual point moves like the mirror image of the object, and with the mirror.
 *
 * A separate pass: in specular_shade it would need 40 additional registers.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/specular_motion.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"
#ifndef MASU_NO_POLYGONS /* rays can hit only the SDF */
#define MASU_TRACE_POLYGONS
#include "trace/scene.glsl"
#endif
#include "specular/filter.glsl"
#include "specular/origin.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D hit_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image;
layout(set = MASU_SET_PASS, binding = 3, r32ui) uniform writeonly uimage2D motion_image;

/* Position of the hit point in the previous frame, minus its current position. */
vec3 met_before(uvec4 hit)
{
#ifdef MASU_TRACE_POLYGONS
    if ((hit.y & MASU_HIT_SDF) == 0u) {
        vec2 b = unpackUnorm2x16(hit.w);
        uvec3 triangle = masu_trace_triangle(hit.z).xyz;
        uint traced = masu_trace_instance(hit.y);
        vec3 object = uintBitsToFloat(masu_trace_vertices[triangle.x].xyz) * (1.0 - b.x - b.y) +
                      uintBitsToFloat(masu_trace_vertices[triangle.y].xyz) * b.x +
                      uintBitsToFloat(masu_trace_vertices[triangle.z].xyz) * b.y;
        return masu_trace_before(traced, vec4(object, 1.0)) -
               masu_trace_now(traced, vec4(object, 1.0));
    }
#endif
    return masu_unpack_sdf_motion(hit.y);
}

/* Motion in pixels of a point behind the mirror: `off` further along the line of sight; `thing`:
 * its previous position minus its current one. */
vec4 image_moved(vec3 point, vec3 along, float off, vec3 thing, vec3 eyes, vec2 size)
{
    vec3 behind = point + along * off;
    return masu_velocity(vec4(behind, 1.0), vec4(behind + thing - eyes, 1.0), size);
}

/* Motion of the reflection in pixels; masu_unmoved: undefined.
 *
 * A convex mirror shows it closer to its surface and smaller: 1/image = 1/far + 2/r for the plane
 * that contains view and normal with r cos instead of r, for the perpendicular plane r / cos
 * (Coddington's equations). The image's own motion is reduced by the same factor; the remainder
 * follows the surface. */
uint motion(uvec2 texel, masu_guide g, vec3 point, float far, vec3 before)
{
    uvec2 at = masu_guide_place(texel, g.pixel, push.traced_size);
    vec2 size = vec2(pc.render_width, pc.render_height);
    vec4 moved = texelFetch(velocity_image, ivec2(at), 0);
    if (!(moved.w > 0.0)) {
        return masu_unmoved;
    }
    /* Previous position of the surface, relative to the previous and to the current camera. */
    vec3 eyes = (previous.eye_hi.xyz - frame.eye_hi.xyz) + (previous.eye_lo.xyz - frame.eye_lo.xyz);
    float z = frame.forward.w * masu_rcp(g.depth) * (1.0 + moved.z);
    vec2 ndc = (vec2(at) + 0.5 + moved.xy) / size * 2.0 - 1.0 + previous.jitter.xy;
    vec3 was = (previous.forward.xyz + previous.right.xyz * ndc.x - previous.up.xyz * ndc.y) * z;
    vec3 shift = was + eyes - point;
    vec3 along = masu_normalize(point, frame.forward.xyz);
    vec3 thing = before - 2.0 * g.normal * dot(before - shift, g.normal);
    float curvature = masu_guide_curvature(guide_image, ivec2(texel), g, point);
    float cosine = clamp(-dot(along, g.normal), 0.1, 1.0);
    vec2 velocity = vec2(0.0), lean = vec2(0.0);
    float steep = 0.0;
    /* In a loop, so that the matrices are loaded where they are used, not kept in registers. */
    [[dont_unroll]] for (int i = 0; i < 2; i++) {
        float image = masu_image_far(far, i == 0 ? curvature / cosine : curvature * cosine);
        vec4 shown = image_moved(point, along, image, mix(shift, thing, image / max(far, 1e-9)),
                                 eyes, size);
        if (!(shown.w > 0.0)) {
            return masu_unmoved;
        }
        if (i > 0) {
            velocity = shown.xy + lean * (dot(lean, velocity - shown.xy) / steep);
            break;
        }
        velocity = shown.xy;
        vec3 aside = g.normal + along * cosine;
        lean = vec2(dot(aside, frame.right.xyz) / frame.right.w,
                    -dot(aside, frame.up.xyz) / frame.up.w);
        steep = dot(lean, lean);
        if (!(curvature > 0.0 && steep > 1e-6)) {
            break;
        }
    }
    return packHalf2x16(clamp(velocity, vec2(-60000.0), vec2(60000.0)));
}

uint motion_of(uvec2 texel, masu_guide g)
{
    uvec4 hit = texelFetch(hit_image, ivec2(texel), 0);
    float t = masu_met_at(hit);
    bool there = t >= 0.0;
    return motion(texel, g, masu_specular_point(texel, g), there ? t : frame.trace_anchor.w,
                  there ? met_before(hit) : vec3(0.0));
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        uint moved = g.there ? motion_of(texel, g) : masu_unmoved;
        MASU_STORE_UINT(motion_image, texel, uvec4(moved));
    }
    masu_count_end();
}
