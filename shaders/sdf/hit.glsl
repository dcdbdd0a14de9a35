/*
 * hit.glsl: what a hit writes. The including shader has declared albedo_image and normal_image.
 */
#ifndef MASU_HIT_GLSL
#define MASU_HIT_GLSL

#include "sdf/trace.glsl"

/* A hit becomes texels of the G-buffer; `known`: of half-space `part`. Returns its depth. */
float write_hit(uvec2 at, ray r, float t, bool known, uint part, float z_scale)
{
    vec3 p = world_at(r.direction, t);
    masu_surface s = masu_plain_surface(vec3(0.5), 0.5);
    vec3 n;
    if (known) {
        n = unit_or(masu_sdf_flat_normal(part), -r.direction);
    } else {
        n = normal_at(r, t, part);
        masu_count(MASU_COUNTER_SDF_EVALS, 4u);
    }
    masu_normal = n;
    masu_sdf_part_surface(part, p, s);
    masu_count(MASU_COUNTER_SDF_HITS, 1u);
    /* Both are made finite by packing, and the pixel is one of the picture. */
    vec4 albedo;
    uint normal;
    masu_pack_texels(n, s, albedo, normal);
    MASU_STORE_SAFE(albedo_image, at, albedo);
    MASU_STORE_SAFE(normal_image, at, uvec4(normal));
    return depth_of(t, z_scale);
}

#endif
