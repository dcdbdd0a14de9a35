/*
 * weights.glsl: SMAA 1x, second step: blending weights: for each edge of a pixel, the share of the
 * pixel beyond the line (Jimenez et al., "SMAA", Eurographics 2012, sections 4.2 to 4.4). Straight
 * lines along an axis, diagonal ones, corners. Start at masu_smaa_weights().
 *
 * Outside the image the edges of its outermost pixels are repeated.
 */
#ifndef MASU_SMAA_WEIGHTS_GLSL
#define MASU_SMAA_WEIGHTS_GLSL

#include "shared/smaa.h"
#include "shared/types.h"
#include "smaa/tiles.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SMAA_AREA, std430) readonly buffer SmaaArea
{
    uint smaa_area[MASU_SMAA_AREA_WORDS];
};

/* The highest of up to 16 bits, not all 0. */
int masu_high_bit(uint bits)
{
    return int(floatBitsToUint(float(bits)) >> 23) - 127;
}

/* Edges of line `q` in tile `k` along it: bits 0..15 along the line, 16..31 across. axis 0: rows,
 * 1: columns. */
uint masu_line_word(uint axis, int k, int q)
{
    uvec2 grid = masu_smaa_grid();
    ivec2 size = ivec2(pc.render_width, pc.render_height);
    int lines = axis == 0u ? size.y : size.x;
    int count = int(axis == 0u ? grid.x : grid.y);
    q = clamp(q, 0, lines - 1);
    uint along = uint(clamp(k, 0, count - 1));
    uint across = uint(q) / uint(MASU_TILE);
    uvec2 tile = axis == 0u ? uvec2(along, across) : uvec2(across, along);
    uint word = smaa_tiles[masu_smaa_words(tile, grid) + 16u * axis + (uint(q) & 15u)];
    if (k != int(along)) {
        uint bit = k < 0 ? 0u : 15u;
        word = (word >> bit & 0x10001u) * 0xFFFFu;
    }
    return word;
}

/* Whether line q has an edge across it at p. */
uint masu_cross_at(uint axis, int p, int q)
{
    return masu_line_word(axis, p >> 4, q) >> (16 + (p & 15)) & 1u;
}

/* Bit x: the line continues from pixel x - 1 to x: both have its edge, and none crosses between
 * them on either side. */
uint masu_passable(uint word, uint above, uint before)
{
    uint line = word & 0xFFFFu;
    return line & (line << 1 | (before >> 15 & 1u)) & ~((word | above) >> 16);
}

/* Number of pixels by which the line continues from p, back and ahead; `most` back, one more ahead:
 * the original steps by two pixels, and begins between this one and the one before. */
ivec2 masu_line_ends(uint axis, int p, int q, int most)
{
    int k = p >> 4, i = p & 15;
    uint here = masu_line_word(axis, k, q);
    uint above = masu_line_word(axis, k, q - 1);
    uint before = masu_line_word(axis, k - 1, q);
    uint passable = masu_passable(here, above, before);

    int back = 0;
    uint stop = ~passable & ((2u << i) - 1u);
    uint word = before;
    int at = i;
    for (int n = 1; n <= 2 * MASU_SMAA_STEPS_MAX / MASU_TILE; n++) {
        if (stop != 0u || back + at + 1 >= most) {
            break;
        }
        back += at + 1;
        uint next = masu_line_word(axis, k - n - 1, q);
        stop = ~masu_passable(word, masu_line_word(axis, k - n, q - 1), next) & 0xFFFFu;
        word = next;
        at = 15;
    }
    back += stop != 0u ? at - masu_high_bit(stop) : at + 1;

    int ahead = 0;
    stop = ~passable & 0xFFFFu & ~((2u << i) - 1u);
    word = here;
    at = 15 - i;
    int low = i + 1;
    for (int n = 1; n <= 2 * MASU_SMAA_STEPS_MAX / MASU_TILE; n++) {
        if (stop != 0u || ahead + at >= most + 1) {
            break;
        }
        ahead += at;
        uint next = masu_line_word(axis, k + n, q);
        stop = ~masu_passable(next, masu_line_word(axis, k + n, q - 1), word) & 0xFFFFu;
        word = next;
        at = 16;
        low = 0;
    }
    ahead += stop != 0u ? int(masu_low_bit(stop)) - low : at;
    return min(ivec2(back, ahead), ivec2(most, most + 1));
}

/* Interpolates the table at square roots of distances; pattern: code of the left end + 4 * code of
 * the right end, each 1: an edge above the line, 2: below. */
vec2 masu_straight_area(uint pattern, ivec2 ends)
{
    vec2 root = vec2(masu_sqrt(float(ends.x)), masu_sqrt(float(ends.y)));
    vec2 whole = min(floor(root), vec2(MASU_SMAA_STRAIGHT - 2));
    vec2 part = root - whole;
    uint at = (pattern * uint(MASU_SMAA_STRAIGHT) + uint(whole.y)) * uint(MASU_SMAA_STRAIGHT) +
              uint(whole.x);
    vec4 a = unpackUnorm4x8(smaa_area[at]);
    vec4 b = unpackUnorm4x8(smaa_area[at + uint(MASU_SMAA_STRAIGHT)]);
    vec4 row = mix(a, b, part.y);
    return mix(row.xy, row.zw, part.x);
}

/* Keeps a quarter of a corner sharp: if the line ends in an edge that continues beyond it, less is
 * blended on that side. */
vec2 masu_keep_corner(uint axis, ivec2 from, ivec2 to, int q, ivec2 ends)
{
    vec2 nearer = vec2(ends.x <= ends.y ? 0.75 : 0.0, ends.y <= ends.x ? 0.75 : 0.0);
    if (ends.x == ends.y) {
        nearer *= 0.5;
    }
    vec2 below = vec2(masu_cross_at(axis, from.x, q + 1), masu_cross_at(axis, to.x, q + 1));
    vec2 above = vec2(masu_cross_at(axis, from.x, q - 2), masu_cross_at(axis, to.x, q - 2));
    return clamp(1.0 - vec2(dot(nearer, below), dot(nearer, above)), 0.0, 1.0);
}

/* Weights of the edge of pixel p along line q: the share of the pixel beyond it, and of the other
 * pixel on this side. */
vec2 masu_straight_weights(uint axis, int p, int q)
{
    ivec2 ends = masu_line_ends(axis, p, q, 2 * int(push.steps) - 1);
    int from = p - ends.x, to = p + ends.y + 1;
    uint left = masu_cross_at(axis, from, q - 1) + 2u * masu_cross_at(axis, from, q);
    uint right = masu_cross_at(axis, to, q - 1) + 2u * masu_cross_at(axis, to, q);
    vec2 weights = masu_straight_area(left + 4u * right, ends);
    if (push.corners != 0u) {
        weights *= masu_keep_corner(axis, ivec2(from), ivec2(to), q, ends);
    }
    return weights;
}

/* ---- Diagonals ------------------------------------------------------------------------------- */

/* x: an edge to the left, y: above. */
uvec2 masu_edges_at(ivec2 p)
{
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    uvec2 at = uvec2(clamp(p, ivec2(0), last));
    uvec2 grid = masu_smaa_grid();
    uint row = smaa_tiles[masu_smaa_words(at / uint(MASU_TILE), grid) + (at.y & 15u)];
    uint word = row >> (at.x & 15u);
    return uvec2(word >> 16 & 1u, word & 1u);
}

/* Steps along a stair of edges until one is missing. The two edges of a step belong to one pixel if
 * the stair rises (`apart` 0), else to two neighbours. x: whole steps, y: 1 if the end was not
 * found, z: the last step had an edge above. */
ivec3 masu_search_diagonal(ivec2 p, ivec2 way, int apart)
{
    int most = int(push.diagonal_steps);
    ivec3 found = ivec3(-1, 1, 0);
    for (int n = 0; n < MASU_SMAA_DIAGONAL_STEPS_MAX; n++) {
        if (found.y == 0 || found.x >= most - 1) {
            break;
        }
        p += way;
        uint top = masu_edges_at(p).y;
        uint left = masu_edges_at(p + ivec2(apart, 0)).x;
        found = ivec3(found.x + 1, int(top & left), int(top));
    }
    return found;
}

vec2 masu_diagonal_area(uvec2 pattern, ivec2 ends)
{
    uint cell = pattern.x + 4u * pattern.y;
    uint side = uint(MASU_SMAA_DIAGONAL);
    uint i = (cell * side + uint(ends.y)) * side + uint(ends.x);
    uint word = smaa_area[uint(MASU_SMAA_STRAIGHT_WORDS) + i / 2u] >> 16u * (i & 1u);
    return unpackUnorm4x8(word).xy;
}

/* Weights of the edge above pixel p if it is part of a stair of more than three steps; else 0. */
vec2 masu_diagonal_weights(ivec2 p, bool left_edge)
{
    vec2 weights = vec2(0.0);
    ivec3 a = ivec3(0);
    if (left_edge) {
        a = masu_search_diagonal(p, ivec2(-1, 1), 0);
        a.x += a.z;
    }
    ivec3 b = masu_search_diagonal(p, ivec2(1, -1), 0);
    if (a.x + b.x > 2) {
        ivec2 u = p + ivec2(-a.x - 1, a.x), v = p + ivec2(b.x + 1, -b.x);
        uvec2 ends = uvec2(2u * masu_edges_at(u).y + masu_edges_at(u + ivec2(1, 0)).x,
                           2u * masu_edges_at(v).y + masu_edges_at(v - ivec2(0, 1)).x);
        ends *= uvec2(1 - a.y, 1 - b.y);
        weights += masu_diagonal_area(ends, ivec2(a.x, b.x));
    }
    a = masu_search_diagonal(p, ivec2(-1, -1), 1);
    b = ivec3(0);
    if (masu_edges_at(p + ivec2(1, 0)).x != 0u) {
        b = masu_search_diagonal(p, ivec2(1, 1), 1);
        b.x += b.z;
    }
    if (a.x + b.x > 2) {
        ivec2 u = p - ivec2(a.x), v = p + ivec2(b.x + 1, b.x);
        uvec2 e = masu_edges_at(v);
        uvec2 ends = uvec2(2u * masu_edges_at(u - ivec2(1, 0)).y + masu_edges_at(u - ivec2(0, 1)).x,
                           2u * e.y + e.x);
        ends *= uvec2(1 - a.y, 1 - b.y);
        weights += masu_diagonal_area(ends, ivec2(a.x, b.x)).yx;
    }
    return weights;
}

/* Weights of both edges: x and y for the one above, z and w for the one to the left. A diagonal
 * replaces both. */
vec4 masu_smaa_weights(ivec2 p, bool left_edge, bool top_edge)
{
    vec4 weights = vec4(0.0);
    if (top_edge && push.diagonal_steps != 0u) {
        weights.xy = masu_diagonal_weights(p, left_edge);
        if (weights.x + weights.y > 0.0) {
            return weights;
        }
    }
    if (top_edge) {
        weights.xy = masu_straight_weights(0u, p.x, p.y);
    }
    if (left_edge) {
        weights.zw = masu_straight_weights(1u, p.y, p.x);
    }
    return weights;
}

#endif
