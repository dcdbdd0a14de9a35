/*
 * silhouettes.glsl: a line between two pixels, where something in front ends, and what it covers of them.
 *
 *   bits 0-7, 8-15  from the centre of the pixel behind to the nearest point of the line: right, down; pixels * 63, + 128
 *   bits 16-19      which neighbours are in front: right, left, below, above
 *   0               no line
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

/* How far the line's normal goes along each of these. */
vec4 masu_silhouette_ways(vec2 line)
{
    vec2 n = line * masu_rsqrt(dot(line, line));
    return vec4(n.x, -n.x, n.y, -n.y);
}

/* `front`: 1 for each neighbour that is in front. Of them those count towards which the line lies. */
uint masu_pack_silhouette(vec2 line, vec4 front)
{
    vec4 ways = masu_silhouette_ways(line);
    uvec4 seen = uvec4(greaterThan(front * ways, vec4(0.25)));
    float far = dot(line, line);
    if (!(far > 1e-6 && far < 2.0)) {
        return 0u;
    }
    uint mask = seen.x | seen.y << 1 | seen.z << 2 | seen.w << 3;
    uvec2 q = uvec2(round(clamp(line, -2.0, 2.0) * 63.0) + 128.0);
    return mask != 0u ? q.x | q.y << 8 | mask << 16 : 0u;
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
        vec2 line = (vec2(word & 0xFFu, word >> 8 & 0xFFu) - 128.0) / 63.0;
        vec4 ways = masu_silhouette_ways(line);
        uvec4 seen = (uvec4(word) >> uvec4(16u, 17u, 18u, 19u)) & 1u;
        float far = length(line);
        vec2 n = line / max(far, 1e-6);
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
