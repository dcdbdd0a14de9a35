/*
 * meso.glsl: view-dependent changes to material texels by a relief too small for polygons.
 * tools/meso/model.h explains the equations and is the C copy; masu-meso fits the coefficients. The
 * results pass through pack.glsl, which makes any value finite.
 */
#ifndef MASU_MESO_GLSL
#define MASU_MESO_GLSL

#include "shared/guard.glsl"

struct masu_meso_curves {
    vec4 tilt;      /* w: roughness of the facets */
    vec4 rough;     /* w: loss of diffuse light by the spread of lost normals, from above */
    vec4 open;      /* ambient occlusion; w: alpha of the shadow */
    vec4 gain;      /* diffuse light; w: offset of the shadow */
    vec4 tint;      /* colour at grazing angles; w: additional loss, by y */
    vec4 specular;  /* w: and by y^2 */
};

/* The surface parameters that the curves change. */
struct masu_meso_surface {
    vec3 normal;
    vec3 color;      /* linear; pack.glsl clamps it */
    float roughness; /* perceptual, 0..1 */
    float occlusion; /* 0..1 */
    float specular;  /* factor of the specular terms, 0..1 */
    float shadow;    /* 0..1 */
};

float masu_meso_poly(vec3 c, float y)
{
    return y * (c.x + y * (c.y + y * c.z));
}

/* view: unit, towards the viewer; x: its cosine with the polygon's normal, on the viewer's side.
 * Reads normal, color, roughness (0..1) and occlusion (0..1) of `s`; the caller normalises its
 * normal. The coefficients in the blob are finite and within +-1000, so no intermediate overflows
 * and none needs a guard. */
void masu_meso_bend(masu_meso_curves m, vec3 view, float x, inout masu_meso_surface s)
{
    float y = 1.0 - clamp(x, 0.0, 1.0);
    float r2 = s.roughness * s.roughness;
    float f2 = m.tilt.w * m.tilt.w;
    float lost = 0.5 * max(r2 * r2 - f2 * f2, 0.0);
    float spread = m.rough.w + y * (m.tint.w + y * m.specular.w);
    float k = masu_meso_poly(m.tilt.xyz, y);
    s.normal += k * (view - s.normal * dot(s.normal, view));
    s.roughness = clamp(s.roughness * (1.0 + masu_meso_poly(m.rough.xyz, y)), m.tilt.w, 1.0);
    float closed = 1.0 - s.occlusion;
    closed = clamp(closed - closed * masu_meso_poly(m.open.xyz, y), 0.0, 1.0);
    float sun = max(1.0 + masu_meso_poly(m.gain.xyz, y), 0.05) /
                clamp(1.0 + spread * lost, 0.25, 4.0);
    s.color *= sun + (sun * y * y) * m.tint.rgb;
    s.occlusion = min((1.0 - closed) / sun, 1.0);
    s.specular = clamp(m.specular.x + y * (m.specular.y + y * m.specular.z), 0.0, 1.0);
    s.shadow = clamp(m.gain.w - m.open.w * closed, 0.0, 1.0);
}

/* The share of a light that arrives: more along the view, from which no shadow is visible. */
float masu_meso_shadow(float shadow, vec3 view, vec3 light)
{
    float along = dot(view, light);
    return clamp(shadow + 0.3 * shadow * along * along * along, 0.0, 1.0);
}

#endif
