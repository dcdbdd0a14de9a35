/*
 * focus_gather.comp: depth of field: gathers the discs that cover a pixel, at half resolution, in
 * two layers. After J. Jimenez, "Next Generation Post Processing in Call of Duty: Advanced
 * Warfare", SIGGRAPH 2014.
 *
 * Far layer, behind the focal plane: a sample contributes if both its disc and the pixel's disc
 * reach across the distance between them. So sharp samples reach no other pixel, and no distant
 * light spreads over a closer surface. For pixels that are not behind the focal plane, this layer
 * contains the farther surroundings, which are visible through the edges of closer discs.
 *
 * Near layer, in front of the focal plane: a sample contributes if its disc reaches the pixel,
 * which may be sharp itself. The sum of the contributions, each divided by the disc's area, is the
 * coverage of the pixel.
 *
 * push.vary: not 0: rotates the samples differently in each frame, for rung.temporal.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/focus_gather.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "post/focus.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D tiles_image;
layout(set = MASU_SET_PASS, binding = 2, rgba16f) uniform writeonly image2D far_image;
layout(set = MASU_SET_PASS, binding = 3, rgba16f) uniform writeonly image2D near_image;

#define SAMPLES 48

shared uint nearest; /* bits of the largest near radius whose disc may reach this tile */

void main()
{
    if (!(post.lens.y > 0.0)) {
        return;
    }
    if (gl_LocalInvocationIndex == 0u) {
        nearest = 0u;
    }
    barrier();
    ivec2 tiles = ivec2(pc.render_width + uint(MASU_TILE) - 1u,
                        pc.render_height + uint(MASU_TILE) - 1u) /
                  MASU_TILE;
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    float most = min(float(MASU_FOCUS_MOST) * float(pc.render_height), masu_focus_reach);
    int around = int(most / float(MASU_TILE)) + 1; /* 9 at most */
    int side = 2 * around + 1; /* 6 iterations suffice for 19 x 19 tiles */
    for (int n = 0; n < 6; n++) {
        int k = n * MASU_GROUP * MASU_GROUP + int(gl_LocalInvocationIndex);
        ivec2 offset = ivec2(k % side, min(k / side, side)) - around;
        ivec2 tile = ivec2(gl_WorkGroupID.xy) + offset;
        if (k < side * side && all(greaterThanEqual(tile, ivec2(0))) &&
            all(lessThan(tile, tiles))) {
            float radius = masu_sane(texelFetch(tiles_image, tile, 0).r, 0.0, most);
            int between = max(max(abs(offset.x), abs(offset.y)) - 1, 0) * MASU_TILE;
            if (radius > float(between)) {
                atomicMax(nearest, floatBitsToUint(radius));
            }
        }
    }
    barrier();
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    vec4 own = masu_sane(texelFetch(source_image, min(at, last), 0), -65504.0, 65504.0);
    float widest = max(own.a, uintBitsToFloat(nearest));
    float radius = max(0.5 * masu_focus_disc(widest), 0.5); /* here and below: half-size texels */
    float own_disc = max(0.5 * masu_focus_disc(max(own.a, 0.0)), 0.5);
    vec4 behind = vec4(0.0), front = vec4(0.0);
    if (widest > 0.5) {
        uint noise = uint(at.x) * 0xC13FA9A9u + uint(at.y) * 0x91E10DA5u +
                     (push.vary != 0u ? frame.history.x * 0x9E3779B9u : 0u);
        float turn = float(noise >> 8) * (6.2831853 / 16777216.0);
        float area = radius * radius / float(SAMPLES);
        for (int k = 0; k < SAMPLES; k++) {
            /* Evenly distributed from the disc's centre, by the golden angle; H. Vogel, 1979. */
            float away = radius * masu_sqrt(float(k) / float(SAMPLES)),
                  angle = turn + 2.3999632 * float(k);
            ivec2 from = ivec2(floor(vec2(at) + 0.5 + away * vec2(cos(angle), sin(angle))));
            vec4 there = masu_sane(texelFetch(source_image, clamp(from, ivec2(0), last), 0),
                                   -65504.0, 65504.0);
            float disc = max(0.5 * masu_focus_disc(there.a), 0.5);
            /* Far layer. */
            float least = min(disc, own_disc);
            float weight = own.a > 0.0 ? clamp(least - away + 0.5, 0.0, 1.0) *
                                             clamp(there.a, 0.0, 1.0) / (least * least)
                                       : clamp(there.a - own.a - 1.0, 0.0, 1.0);
            behind += weight * vec4(there.rgb, 1.0);
            /* Near layer. */
            float covers = there.a < 0.0
                               ? clamp(disc - away + 0.5, 0.0, 1.0) * masu_focus_share(there.a)
                               : 0.0;
            front += covers * area / (disc * disc) * vec4(there.rgb, 1.0);
        }
        behind = behind.a > 1e-4 ? vec4(behind.rgb / behind.a, 1.0) : vec4(0.0);
        front *= front.a > 1.0 ? 1.0 / front.a : 1.0;
    }
    MASU_STORE_HALF(far_image, at, behind);
    MASU_STORE_HALF(near_image, at, front);
}
