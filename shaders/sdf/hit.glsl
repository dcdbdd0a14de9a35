/*
 * hit.glsl: writes an SDF hit to the G-buffer. The including shader has declared albedo_image,
 * normal_image and hdr_image.
 */
#ifndef MASU_HIT_GLSL
#define MASU_HIT_GLSL

#include "shared/counters.h"
#include "sdf/trace.glsl"

/* Writes the G-buffer texels of a hit and returns its depth; parameters as of surface_met(). */
float write_hit(uvec2 at, ray r, float t, bool known, uint part, float z_scale)
{
    vec4 albedo;
    uint normal;
    vec3 n;
    masu_surface s = surface_met(r, t, known, part, n);
    masu_pack_texels(n, s, albedo, normal);
    masu_count(MASU_COUNTER_SDF_HITS, 1u);
    /* The caller guarantees that the pixel is inside the image. */
    MASU_STORE_SAFE(albedo_image, at, albedo);
    MASU_STORE_SAFE(normal_image, at, uvec4(normal));
    if (!masu_emission_packed && masu_has_emission(normal)) {
        MASU_STORE_SAFE(hdr_image, at, vec4(masu_emitted(s), 1.0));
    }
    return depth_of(t, z_scale);
}

#endif
