/*
 * surface.glsl: the surface of a pixel, for the reflection passes that read the whole G-buffer:
 * images at bindings 0 to 2 of their set, with MASU_SURFACE the surface image at 3.
 */
#ifndef MASU_SPECULAR_SURFACE_GLSL
#define MASU_SPECULAR_SURFACE_GLSL

#include "shared/materials.h"
#include "shared/pack.glsl"

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D albedo_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D depth_image;
#ifdef MASU_SURFACE
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D surface_image;
#define MASU_AFTER_SURFACE 4
#else
#define MASU_AFTER_SURFACE 3
#endif

/* The sky and unlit emitters have no reflection: depth 0. */
struct masu_pixel {
    masu_surface surface;
    uint normal; /* packed */
    float depth;
};

masu_pixel masu_pixel_at(uvec2 at)
{
    masu_pixel p;
    vec4 albedo = texelFetch(albedo_image, ivec2(at), 0);
    p.normal = texelFetch(normal_image, ivec2(at), 0).r;
    p.depth = texelFetch(depth_image, ivec2(at), 0).r;
    p.surface = masu_unpack_look(albedo, p.normal);
#ifdef MASU_SURFACE
    if ((masu_unpack_flags(p.normal) & MASU_SURFACE_MORE) != 0u) {
        masu_unpack_surface(texelFetch(surface_image, ivec2(at), 0), p.surface);
    }
#endif
    if (masu_is_unlit_texel(p.normal) || !(p.depth > 0.0)) {
        p.depth = 0.0;
    }
    return p;
}

#endif
