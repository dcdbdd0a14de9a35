/*
 * silhouettes.glsl: a line between two pixels, where something in front ends, and what it covers of them.
 *
 *   bits 0-7    how far the line is from the pixel's centre, pixels * 180
 *   bits 8-15   which way, as right and down divided by the sum of their absolute values: right * 63.5 + 63.5; bit 15: down
 *               is below 0. Wrong turn: the vector to the line itself has no direction left where the line is near.
 *   bits 16-19  which neighbours show what is beyond the line: right, left, below, above
 *   0           no line
 */
#ifndef MASU_SILHOUETTES_GLSL
#define MASU_SILHOUETTES_GLSL

#include "shared/guard.glsl"

/* Right, left, below, above. */
ivec2 masu_beside(int k)
{
    int way = 1 - 2 * (k & 1);
    return k < 2 ? ivec2(way, 0) : ivec2(0, way);
}

/* How far a direction goes along each of these. */
vec4 masu_ways(vec2 n)
{
    return vec4(n.x, -n.x, n.y, -n.y);
}

/* `line`: from the pixel's centre to the nearest point of it. `beyond`: a bit for each neighbour that shows what
 * may be beyond; those count towards which the line lies. */
uint masu_pack_silhouette(vec2 line, uint beyond)
{
    float far = length(line);
    vec2 n = line * masu_rcp(far);
    vec4 ways = masu_ways(n);
    uint towards = (ways.x > 0.25 ? 1u : 0u) | (ways.y > 0.25 ? 2u : 0u) | (ways.z > 0.25 ? 4u : 0u) |
                   (ways.w > 0.25 ? 8u : 0u);
    uint mask = beyond & towards;
    float right = n.x * masu_rcp(abs(n.x) + abs(n.y));
    uint way = uint(clamp(right * 63.5 + 63.5, 0.0, 127.0) + 0.5) | (n.y < 0.0 ? 0x80u : 0u);
    uint off = uint(clamp(far, 0.0, 1.41) * 180.0 + 0.5);
    return far < 1.41 && mask != 0u ? off | way << 8 | mask << 16 : 0u;
}

vec2 masu_silhouette_normal(uint word)
{
    float right = float(word >> 8 & 0x7Fu) / 63.5 - 1.0;
    float down = (word & 0x8000u) != 0u ? abs(right) - 1.0 : 1.0 - abs(right);
    vec2 v = vec2(right, down);
    return v * masu_rsqrt(dot(v, v));
}

/* What lies beyond a line of a pixel's square, whose centre is `off` from it; n: its unit normal. */
float masu_beyond(float off, vec2 n)
{
    vec2 a = abs(n);
    float more = max(a.x, a.y);
    float less = min(a.x, a.y);
    float corner = max(0.5 * (more + less) - off, 0.0);
    return off < 0.5 * (more - less) ? 0.5 - off / max(more, 0.5) : 0.5 * corner * corner / max(more * less, 1e-6);
}

/* How much of a pixel belongs to each neighbour, by its own word and theirs. */
vec4 masu_silhouette_weights(uint own, uvec4 others)
{
    vec4 weights = vec4(0.0);
    for (int k = 0; k < 5; k++) {
        uint word = k == 4 ? own : others[k];
        if (word == 0u) {
            continue;
        }
        vec2 n = masu_silhouette_normal(word);
        vec4 ways = masu_ways(n);
        uvec4 seen = (uvec4(word) >> uvec4(16u, 17u, 18u, 19u)) & 1u;
        float far = float(word & 0xFFu) / 180.0;
        if (k == 4) {
            /* Of the neighbours in front the one that is most so. */
            vec4 to = vec4(seen) * ways;
            float most = max(max(to.x, to.y), max(to.z, to.w));
            float beyond = masu_beyond(far, n);
            vec4 one = to.x == most ? vec4(1, 0, 0, 0) : to.y == most ? vec4(0, 1, 0, 0)
                     : to.z == most ? vec4(0, 0, 1, 0) : vec4(0, 0, 0, 1);
            weights = max(weights, beyond * one);
        } else if (seen[k ^ 1] != 0u) {
            /* It is in front of this one. */
            weights[k] = max(weights[k], masu_beyond(max(ways[k ^ 1] - far, 0.0), n));
        }
    }
    /* A slanted line lies beside two neighbours: only one of them is blended with. What is thin has lines on both sides. */
    vec2 along = vec2(weights.x + weights.y, weights.z + weights.w);
    weights *= along.x >= along.y ? vec4(1, 1, 0, 0) : vec4(0, 0, 1, 1);
    float sum = max(along.x, along.y);
    return sum > 1.0 ? weights / sum : weights;
}

#endif
