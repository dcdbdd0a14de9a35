/*
 * shelf.glsl: packs the colours of a bsdf as half floats, to free registers while shadows and
 * lights are looked up.
 */
#ifndef MASU_SHELF_GLSL
#define MASU_SHELF_GLSL

#include "brdf/bsdf.glsl"

uvec2 masu_pack_halves(vec4 v)
{
    return uvec2(packHalf2x16(v.xy), packHalf2x16(v.zw));
}

vec4 masu_unpack_halves(uvec2 v)
{
    return vec4(unpackHalf2x16(v.x), unpackHalf2x16(v.y));
}

/* The colours and related values of a bsdf that only the end of a light's evaluation needs. */
struct masu_shelved_bsdf {
    uvec2 f0, rest, diffuse, matte;
#ifdef MASU_SURFACE
    uint coat_line;
#endif
};

masu_shelved_bsdf masu_shelve(masu_bsdf b)
{
    masu_shelved_bsdf p;
    p.f0 = masu_pack_halves(vec4(b.f0, b.f90));
    p.rest = masu_pack_halves(vec4(b.rest, b.seen.white));
    p.diffuse = masu_pack_halves(vec4(b.diffuse, b.seen.weight));
    /* f90, which is usually exactly 1, instead of f90 - f0: at grazing angles 1 - Fresnel is near
     * 0, and the rounding of f90 - f0 would change diffuse light by 3.6 %. */
    p.matte = masu_pack_halves(vec4(b.matte_f0, b.matte_f0 + b.matte_slope, b.matte_rest, 0.0));
#ifdef MASU_SURFACE
    p.matte.y = packHalf2x16(vec2(b.matte_rest, b.coat));
    p.coat_line = packHalf2x16(b.coat_line);
#endif
    return p;
}

void masu_unshelve(masu_shelved_bsdf p, inout masu_bsdf b)
{
    vec4 v = masu_unpack_halves(p.f0);
    b.f0 = v.xyz;
    b.f90 = v.w;
    v = masu_unpack_halves(p.rest);
    b.rest = v.xyz;
    b.seen.white = v.w;
    v = masu_unpack_halves(p.diffuse);
    b.diffuse = v.xyz;
    b.seen.weight = v.w;
    v = masu_unpack_halves(p.matte);
    b.matte_f0 = v.x;
    b.matte_slope = v.y - v.x;
    b.matte_rest = v.z;
#ifdef MASU_SURFACE
    b.coat = v.w;
    b.coat_line = unpackHalf2x16(p.coat_line);
#endif
}

#endif
