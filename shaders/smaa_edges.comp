/*
 * smaa_edges.comp: SMAA 1x, first pass: finds the edges of the image, and lists the tiles of 16x16
 * pixels for the second pass. One workgroup for each tile. It also copies the image, so that the
 * second pass writes only changed pixels.
 *
 * Jimenez et al., "SMAA" (Eurographics 2012), section 4.1: a pixel has an edge to the left or above
 * if luma differs by a threshold, unless an adjacent edge is more than twice as strong and
 * therefore dominates. All 32-bit values of every tile are written, so no edge of an earlier frame
 * remains.
 *
 * Push constants: render_* = valid corner of the image, output_* = tiles, push.threshold =
 * threshold in the steps of masu_smaa_luma.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/smaa_edges.h"
#include "shared/counters.h"
#include "shared/smaa.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/output.glsl"
#include "smaa/color.glsl"
#define MASU_SMAA_TILES_ACCESS
#include "smaa/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D picture; /* display-encoded */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE smooth_image;

/* Luma of the tile, of two pixels to the left and above, of one to the right and below. */
const int side = MASU_TILE + 3;
const int threads = MASU_GROUP * MASU_GROUP;
/* Larger than needed: the compiler would unroll a loop of six rounds, which takes lavapipe a third
 * longer. */
const int rounds = 64;
shared float lumas[side * side];
shared uint words[MASU_SMAA_WORDS];
shared uint any_edge;

float luma_at(ivec2 p)
{
    return lumas[(p.y + 2) * side + p.x + 2];
}

void main()
{
    masu_count_begin();
    uint t = gl_LocalInvocationIndex;
    ivec2 first = ivec2(gl_WorkGroupID.xy) * MASU_TILE;
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    if (t < uint(MASU_SMAA_WORDS)) {
        words[t] = 0u;
    }
    if (t == 0u) {
        any_edge = 0u;
    }
    for (int n = 0, k = int(t); k < side * side && n < rounds; n++, k += threads) {
        ivec2 p = ivec2(k % side, k / side) - 2;
        ivec2 at = first + p;
        vec3 color = texelFetch(picture, clamp(at, ivec2(0), last), 0).rgb;
        lumas[k] = masu_smaa_luma(color);
        if (all(equal(p, clamp(p, ivec2(0), ivec2(MASU_TILE - 1)))) &&
            all(lessThanEqual(at, last))) {
            MASU_STORE_COLOR(smooth_image, at, color);
        }
    }
    barrier();

    float threshold = push.threshold;
    for (int k = 0; k < 4; k++) {
        ivec2 pixel = ivec2(gl_LocalInvocationID.xy) + MASU_GROUP * ivec2(k & 1, k >> 1);
        /* Beyond the image its outermost pixels are repeated. */
        ivec2 p = min(pixel, last - first);
        float luma = luma_at(p);
        vec2 beside = vec2(luma_at(p - ivec2(1, 0)), luma_at(p - ivec2(0, 1)));
        vec2 delta = abs(vec2(luma) - beside);
        vec2 ahead = abs(vec2(luma) - vec2(luma_at(p + ivec2(1, 0)), luma_at(p + ivec2(0, 1))));
        bvec2 edge = greaterThanEqual(delta, vec2(threshold));
        /* An edge that the adjacent tile may find also changes pixels of this tile. */
        bool border = (pixel.x == MASU_TILE - 1 && ahead.x >= threshold) ||
                      (pixel.y == MASU_TILE - 1 && ahead.y >= threshold);
        if (!any(edge)) {
            if (border) {
                any_edge = 1u;
            }
            continue;
        }
        vec2 behind = abs(beside - vec2(luma_at(p - ivec2(2, 0)), luma_at(p - ivec2(0, 2))));
        vec2 most = max(max(delta, ahead), behind);
        edge = bvec2(uvec2(edge) & uvec2(greaterThanEqual(2.0 * delta, vec2(max(most.x, most.y)))));
        if (any(edge)) {
            uint left = edge.x ? 1u : 0u;
            uint top = edge.y ? 1u : 0u;
            atomicOr(words[pixel.y], top << pixel.x | left << (16 + pixel.x));
            atomicOr(words[16 + pixel.x], left << pixel.y | top << (16 + pixel.y));
        }
        if (border || any(edge)) {
            any_edge = 1u;
        }
    }
    barrier();

    uvec2 grid = uvec2(pc.output_width, pc.output_height);
    if (t < uint(MASU_SMAA_WORDS)) {
        smaa_tiles[masu_smaa_words(gl_WorkGroupID.xy, grid) + t] = words[t];
    }
    if (t == 0u && any_edge != 0u) {
        uint slot = atomicAdd(smaa_tiles[0], 1u);
        smaa_tiles[uint(MASU_TILES_HEADER) + slot] = gl_WorkGroupID.y * grid.x + gl_WorkGroupID.x;
        masu_count(MASU_COUNTER_SMAA_TILES, 1u);
    }
    masu_count_end();
}
