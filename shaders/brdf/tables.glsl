/*
 * tables.glsl: lookups of directional albedos of the specular lobe. tools/generate/make_split_sum.c
 * generates the table; shared/lookup_tables.h has the layout of its buffer, which is resident and
 * the same for all lit scenes. Interpolated in the shader: a buffer needs no sampler, and all
 * drivers round alike.
 */
#ifndef MASU_TABLES_GLSL
#define MASU_TABLES_GLSL

#include "shared/guard.glsl"
#include "shared/lookup_tables.h"
#include "shared/types.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TABLES, std430) readonly buffer Tables
{
    uint masu_tables[];
};

/* The row of a roughness of 0..1; from 0 to TABLE_SMOOTHEST all share one. */
uint masu_row_of(float roughness)
{
    const float scale = float(MASU_TABLE_ROWS - 1) / (1.0 - MASU_TABLE_SMOOTHEST);
    float at = max((roughness - MASU_TABLE_SMOOTHEST) * scale, 0.0) + 0.5;
    return min(uint(at), uint(MASU_TABLE_ROWS - 1));
}

/* The two numbers of `table` at N.v = cosine, which is within 0..1. */
vec2 masu_table(uint table, uint row, float cosine)
{
    float at = sqrt(cosine) * float(MASU_TABLE_SIZE - 1);
    uint left = min(uint(at), uint(MASU_TABLE_SIZE - 2));
    uint node = table + row * uint(MASU_TABLE_SIZE) + left;
    return mix(unpackUnorm2x16(masu_tables[node]), unpackUnorm2x16(masu_tables[node + 1u]),
               at - float(left));
}

/* Of `count` floats for each row from `table` on, those number k and k + 1. */
vec2 masu_table_averages(uint table, uint count, uint row, uint k)
{
    uint at = table + row * count + k;
    return uintBitsToFloat(uvec2(masu_tables[at], masu_tables[at + 1u]));
}

#endif
