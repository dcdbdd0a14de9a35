/*
 * smaa_blend.comp: SMAA 1x, second and third step: computes the blend weights of the listed tiles
 * and blends pixels with their neighbours. One workgroup for each tile of 16x16.
 *
 * The weights of a pixel's edges are used by the pixel, by its left neighbour and by the one above:
 * a group computes the weights of 17x17 pixels in shared memory. Only pixels with edges, a third of
 * a busy tile, are distributed over the invocations, so that none waits for pixels without edges.
 *
 * Push constants: render_* = size of the image, push.steps = steps of a search, two pixels each,
 * push.diagonal_steps = steps of a diagonal search, 0: no diagonals, push.corners not 0: keeps
 * corners.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/smaa_blend.h"
#include "shared/types.h"
#include "shared/globals.glsl"
#include "shared/output.glsl"
#include "smaa/color.glsl"
#include "smaa/weights.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D picture;
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE smooth_image;

const int side = MASU_TILE + 1;
const int threads = MASU_GROUP * MASU_GROUP;
/* Larger than needed, as in smaa_edges.comp. */
const int rounds = 64;
shared uint weights[side * side]; /* 4 x 8 bit unorm */
shared uint tops[side], lefts[side]; /* per row, a bit for each of 17 pixels */
shared uint items[side * side];
shared uint item_count;

vec3 light_at(ivec2 p)
{
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    return masu_decode(texelFetch(picture, clamp(p, ivec2(0), last), 0).rgb);
}

void main()
{
    uint t = gl_LocalInvocationIndex;
    uvec2 grid = masu_smaa_grid();
    uint number = smaa_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x];
    uvec2 tile = uvec2(number % grid.x, number / grid.x);
    ivec2 first = ivec2(tile) * MASU_TILE;
    ivec2 size = ivec2(pc.render_width, pc.render_height);
    ivec2 inside = size - first; /* pixels of the image from the tile's first pixel on */

    for (int n = 0, k = int(t); k < side * side && n < rounds; n++, k += threads) {
        weights[k] = 0u;
    }
    if (t < uint(side)) {
        int y = first.y + int(t);
        uint word = masu_line_word(0u, int(tile.x), y);
        uint beside = masu_line_word(0u, int(tile.x) + 1, y);
        tops[t] = word & 0xFFFFu;
        lefts[t] = word >> 16 | (beside & 0x10000u);
        /* The 16x16 pixels need the next column's edges to the left, and the next row's edges to
         * the top. The other edge of these pixels is used only together with the needed one,
         * because both may belong to a diagonal. */
        if (t == 16u) {
            lefts[t] &= tops[t];
        } else {
            tops[t] |= (beside & lefts[t] >> 16 & 1u) << 16;
        }
        if (int(t) >= inside.y) {
            tops[t] = lefts[t] = 0u;
        }
    }
    if (t == 0u) {
        item_count = 0u;
    }
    barrier();
    for (int n = 0, k = int(t); k < side * side && n < rounds; n++, k += threads) {
        int x = k % side, y = k / side;
        uint edges = (tops[y] >> x & 1u) | (lefts[y] >> x & 1u) << 1;
        if (edges != 0u && x < inside.x) {
            items[atomicAdd(item_count, 1u)] = uint(k) | edges << 16;
        }
    }
    barrier();
    int count = int(item_count);
    for (int n = 0, k = int(t); k < count && n < rounds; n++, k += threads) {
        int at = int(items[k] & 0xFFFFu);
        vec4 w = masu_smaa_weights(first + ivec2(at % side, at / side), (items[k] & 0x20000u) != 0u,
                                   (items[k] & 0x10000u) != 0u);
        weights[at] = packUnorm4x8(w);
    }
    barrier();
    for (int k = 0; k < 4; k++) {
        ivec2 p = ivec2(gl_LocalInvocationID.xy) + MASU_GROUP * ivec2(k & 1, k >> 1);
        if (any(greaterThanEqual(p, inside))) {
            continue;
        }
        ivec2 next = min(p + 1, inside - 1);
        uint own = weights[p.y * side + p.x];
        uint right = weights[p.y * side + next.x] & 0xFF000000u;
        uint below = weights[next.y * side + p.x] & 0x0000FF00u;
        if (((own & 0x00FF00FFu) | right | below) == 0u) {
            continue; /* smaa_edges.comp has copied the pixel */
        }
        /* x from the right, y from below, z from the left, w from above */
        vec4 a = unpackUnorm4x8(right >> 24 | below | (own & 0x00FF0000u) | (own & 0xFFu) << 24);
        bool sideways = max(a.x, a.z) > max(a.y, a.w);
        vec2 share = sideways ? a.xz : a.yw;
        ivec2 way = sideways ? ivec2(1, 0) : ivec2(0, 1);
        ivec2 at = first + p;
        vec3 here = light_at(at);
        vec3 ahead = mix(here, light_at(at + way), share.x);
        vec3 behind = mix(here, light_at(at - way), share.y);
        float sum = share.x + share.y;
        vec3 light = (share.x * ahead + share.y * behind) / (sum > 1e-5 ? sum : 1.0);
        MASU_STORE_COLOR(smooth_image, at, masu_encode(light));
    }
}
