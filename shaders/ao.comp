/*
 * ao.comp: screen-space ambient occlusion of polygons and SDF from depth and normals, at every
 * second pixel of every second row. ao_upsample.comp upsamples the result to full resolution.
 *
 * After Jimenez, Wu, Pesce and Jarabo, "Practical Realtime Strategies for Accurate Indirect
 * Occlusion", 2016: the hemisphere is divided into slices that contain the view direction. On each
 * side of a slice, the sample with the largest elevation is the horizon. The cosine-weighted
 * visibility between the two horizons has a closed form. This shader evaluates the same integral
 * over the occluded part. With alpha the elevation above the surface, and gamma the angle in the
 * slice from the view direction to the normal n,
 *
 *   occluded(a0..a1) = |n_slice| (F(a0) - F(a1)),  4 F(a) = cos(2a - gamma) - 2a sin(gamma),
 *
 * which is their equation 7 with h = gamma + pi / 2 - alpha. Two changes lower the error, both
 * measured against ray tracing (docs/design/06-ambient-occlusion.md):
 *  - A sample occludes the arc that it adds to the horizon, weighted by its distance (1 - t /
 *    radius, as in the ray-traced reference). The paper instead pulls the sample's direction
 *    towards the lowest horizon, by the distance.
 *  - Elevation is measured from the plane of the pixel: the height above the plane over the
 *    distance along the slice. Samples are texel centres, up to half a texel away from the slice.
 *    On a floor viewed at a grazing angle such a sample appeared "above" the floor: the error of
 *    the mean was -0.025 instead of 0.004.
 *
 * A sample's surface is assumed endless along the view ray, even if there is air behind it; only
 * its distance limits the occlusion. An assumed thickness (bounded arcs in a mask of 32 bits)
 * gained nothing.
 *
 * Slice directions and sample phases repeat every 4x4 texels, as the 16 points of a rank-1 lattice,
 * so that a mean over 4x4 texels has 16 times as many slices and samples. Nothing depends on time:
 * a stationary camera gets the same image each frame.
 *
 * push.radius: radius, metres. push.reach: largest radius on the screen, as a share of the image
 * height. push.slices: slices. push.steps: samples per side of a slice. push.size: pixels per
 * texel, 2, or 1 for comparison.
 *
 * Out: bits 0-9 visibility, bits 10-31 depth of the pixel (ao_texel.glsl).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/ao.h"
#include "shared/ao.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/ao_texel.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 2, r32ui) uniform writeonly uimage2D ao_image;

/* Abramowitz and Stegun 4.4.45, within 7e-5 of acos for x in -1..1. */
float fast_acos(float x)
{
    float a = abs(x);
    float r = ((-0.0187293 * a + 0.0742610) * a - 0.2121144) * a + 1.5707288;
    r *= sqrt(max(1.0 - a, 0.0));
    return x < 0.0 ? 3.14159265 - r : r;
}

/* 4 F from the cosine c and sine s of the elevation a; slice: cosine and sine of gamma. */
float free_above(float c, float s, float a, vec2 slice)
{
    return (2.0 * c * c - 1.0) * slice.x + (2.0 * s * c - 2.0 * a) * slice.y;
}

struct surface_point {
    vec3 place;  /* view space: right, down, away */
    vec2 slope;  /* x / z and y / z */
    vec3 normal;
    vec3 eye;    /* unit, from the point to the camera */
    vec2 pixel;  /* pixel centre */
};

/* Occlusion on one side of a slice. way: unit direction along the slice to this side. screen: the
 * same direction in pixels, unit. slice: cosine and sine of gamma on this side. */
float hidden_by(surface_point p, ao_lens lens, vec3 way, vec2 screen, vec2 slice, float length_n,
                float reach, float phase)
{
    vec3 along = way * slice.x - p.eye * slice.y; /* in the slice and in the surface's plane */
    float highest_c = 1.0;
    float highest_f = slice.x;
    float hidden = 0.0;
    for (int i = 0; i < MASU_AO_STEPS_MAX; i++) {
        if (uint(i) >= push.steps) {
            break;
        }
        float share = (float(i) + phase) / float(push.steps);
        vec2 at = floor(p.pixel + screen * max(share * share * reach, 1.0));
        if (!(all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, lens.size)))) {
            break; /* all farther samples are outside too */
        }
        float z = ao_view_z(texelFetch(depth_image, ivec2(at), 0).r);
        vec3 to = ao_place(lens, at + 0.5, z) - p.place;
        float high = dot(to, p.normal) / length_n;
        float far = dot(to, along);
        float distance = length(to);
        float weight = 1.0 - distance / push.radius;
        /* Clamped to the view direction: no visible point is in front of the surface. */
        float c = max(far / max(length(vec2(far, high)), masu_tiny), -slice.y);
        if (z < ao_farthest && high > 0.0 && weight > 0.0 && c < highest_c) {
            float f = free_above(c, sqrt(max(1.0 - c * c, 0.0)), fast_acos(c), slice);
            hidden += weight * (highest_f - f);
            highest_c = c;
            highest_f = f;
        }
    }
    return 0.25 * hidden * length_n;
}

float seen_from(surface_point p, ao_lens lens, uvec2 texel)
{
    /* Point k of the lattice; 5x + 4y takes all 16 values in any 4x4 texels. */
    uint k = (5u * texel.x + 4u * texel.y) & 15u;
    float turn = (float(k) + 0.5) / 16.0;
    float phase = (float((7u * k) & 15u) + 0.5) / 16.0;
    float reach = push.radius * lens.pixels.y / p.place.z;
    if (!(reach > 1.0)) {
        return 1.0; /* all possible occluders are in this pixel */
    }
    reach = min(reach, push.reach * lens.size.y);
    /* Duff's frame (JCGT 6-1, 2017) around the view direction, whose z is below 0. */
    vec3 e = p.eye;
    float a = 1.0 / (1.0 - e.z);
    vec3 u = vec3(1.0 - e.x * e.x * a, -e.x * e.y * a, e.x);
    vec3 v = vec3(e.x * e.y * a, e.y * e.y * a - 1.0, -e.y);
    float hidden = 0.0;
    for (int i = 0; i < MASU_AO_SLICES_MAX; i++) {
        if (uint(i) >= push.slices) {
            break;
        }
        float phi = 3.14159265 * (float(i) + turn) / float(push.slices);
        vec3 way = u * cos(phi) + v * sin(phi);
        vec2 screen = (way.xy - p.slope * way.z) * lens.pixels;
        screen *= masu_rsqrt(dot(screen, screen));
        vec2 in_slice = vec2(dot(p.normal, e), dot(p.normal, way));
        float length_n = length(in_slice);
        /* else the slice is parallel to the surface: its cosine weight is 0 */
        if (length_n > 1e-4) {
            in_slice /= length_n;
            [[dont_unroll]] for (int side = 0; side < 2; side++) {
                hidden += hidden_by(p, lens, way, screen, in_slice, length_n, reach, phase);
                way = -way;
                screen = -screen;
                in_slice.y = -in_slice.y;
            }
        }
    }
    return 1.0 - hidden / float(push.slices);
}

void main()
{
    masu_count_begin();
    uvec2 texel = gl_GlobalInvocationID.xy;
    if (all(lessThan(texel, uvec2(pc.output_width, pc.output_height)))) {
        uvec2 size = uvec2(pc.render_width, pc.render_height);
        uvec2 at = min(texel * push.size, size - 1u);
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        uint packed = texelFetch(normal_image, ivec2(at), 0).r;
        ao_lens lens = ao_lens_of(size);
        surface_point p;
        p.pixel = vec2(at) + 0.5;
        float z = ao_view_z(depth);
        bool there = z < ao_farthest && !masu_is_unlit_texel(packed);
        p.place = ao_place(lens, p.pixel, there ? z : 1.0);
        p.slope = ao_place(lens, p.pixel, 1.0).xy;
        p.eye = -p.place * masu_rsqrt(dot(p.place, p.place));
        p.normal = ao_view_normal(packed);
        float seen = there ? seen_from(p, lens, texel) : 1.0;
        MASU_STORE_UINT(ao_image, texel,
                        uvec4(ao_pack(masu_sane(seen, 0.0, 1.0), there ? depth : 0.0)));
    }
    masu_count_end();
}
