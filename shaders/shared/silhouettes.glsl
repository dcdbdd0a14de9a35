/*
 * silhouettes.glsl: the colour of a pixel with an SDF edge (silhouettes.comp), as a 32-bit value.
 *
 *   bits 0-9    red, 10-20 green, 21-30 blue: square roots of display-linear colour relative to the
 *               highest output; 1023, 2047 and 1023 steps
 *   bit 31      the pixel has an edge
 *   0           no edge
 */
#ifndef MASU_SILHOUETTES_GLSL
#define MASU_SILHOUETTES_GLSL

#include "shared/guard.glsl"

const vec3 masu_edge_steps = vec3(1023.0, 2047.0, 1023.0);

/* Light is 0 to 1. Whether two lights differ by more than 1.5 steps of 10 bits: else every bit of
 * the pixel is kept. */
bool masu_edge_differs(vec3 a, vec3 b)
{
    vec3 apart = abs(sqrt(masu_sane_unit(a)) - sqrt(masu_sane_unit(b)));
    return any(greaterThan(apart, vec3(1.5 / 1023.0)));
}

uint masu_pack_edge(vec3 light)
{
    uvec3 steps = uvec3(sqrt(masu_sane_unit(light)) * masu_edge_steps + 0.5);
    return 0x80000000u | steps.b << 21 | steps.g << 10 | steps.r;
}

vec3 masu_unpack_edge(uint word)
{
    vec3 roots = vec3(word & 1023u, word >> 10 & 2047u, word >> 21 & 1023u) / masu_edge_steps;
    return roots * roots;
}

#endif
