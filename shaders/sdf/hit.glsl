/*
 * hit.glsl: what a hit writes. The including shader has declared albedo_image and normal_image.
 */
#ifndef MASU_HIT_GLSL
#define MASU_HIT_GLSL

#include "shared/counters.h"
#include "sdf/trace.glsl"

/* A hit becomes texels of the G-buffer; `known`: of half-space `part`. Returns its depth. */
float write_hit(uvec2 at, ray r, float t, bool known, uint part, float z_scale)
{
    vec4 albedo;
    uint normal;
    texels_at(r, t, known, part, albedo, normal);
    masu_count(MASU_COUNTER_SDF_HITS, 1u);
    /* The pixel is one of the picture. */
    MASU_STORE_SAFE(albedo_image, at, albedo);
    MASU_STORE_SAFE(normal_image, at, uvec4(normal));
    return depth_of(t, z_scale);
}

#endif
