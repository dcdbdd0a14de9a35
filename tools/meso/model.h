/* model.h: what the relief of a material does to its texels, as the renderer computes it. The
 * twin in GLSL is shaders/brdf/meso.glsl; tests/gpu/test_meso.c holds them against each other.
 *
 * With x = dot(V, N of the polygon), y = 1 - x, and poly(c) = y (c0 + y (c1 + y c2)), which is 0 seen
 * from straight above, where the texels are right as they are:
 *
 *   normal     N' = normalise(N + poly(tilt) (V - N dot(N, V)))    what is seen leans to the viewer
 *   roughness  r' = clamp(r (1 + poly(rough)), facet, 1)           and varies less
 *   AO         A' = clamp01(A + (1 - A) poly(ao))                  and lies more open
 *   colour     c' = c (1 + y^2 tint)                               and is of another colour
 *   specular   s' = clamp01(specular0 + y (specular1 + y specular2)), of both specular terms
 *   sun        D  = max(1 + poly(gain), 0.05) / clamp(1 + S s(y), 1/4, 4)   of diffuse light from
 *                                                                  lights; s = spread + y (spread1 +
 *                                                                  y spread2)
 *   lights     f  = clamp01(offset - alpha (1 - A'))               what shadows leave of them
 *              f' = clamp01(f (1 + 0.3 (V.L)^3))                   more towards the light: no shadow is
 *                                                                  seen along it, most against it
 *
 * f' scales what a light adds, A' what comes from everywhere. Since the renderer keeps one albedo for
 * both, D goes into it and out of the occlusion again: albedo c' D, occlusion min(A' / D, 1). S is the
 * variance that the roughness of a texel holds beyond the facets' own, S = (r^4 - facet^4) / 2: of
 * normals that a mip has averaged less than the full length counts: with s a mip keeps the light of its
 * texels at every angle, which one number for all angles did not (off by up to 10 %). f is linear in A between its
 * clamps, so it may be filtered.
 *
 * The forms of tilt, roughness and AO are those presented for Gran Turismo 7 (Polyphony Digital,
 * CEDEC+KYUSHU / CEDEC 2022), as is f but for one term: there it is clamp01(N.L - alpha (1 - AO) + 1/2).
 * With a free factor of N.L the fits to radiance came out at 0 for asphalt, gravel and grass, so it is
 * left out; offset, (V.L)^3, D, specular and S are measured additions. docs/design/04-surfaces.md
 * has the table. */
#ifndef MASU_MESO_MODEL_H
#define MASU_MESO_MODEL_H

#include "meso/patch.h"

/* Order and number of the floats are those of the blob's record: six vec4. */
typedef struct masu_meso_curves {
    double tilt[3], facet;
    double rough[3], spread;
    double ao[3], alpha;
    double gain[3], offset;
    double tint[3], spread1;
    double specular[3], spread2;
} masu_meso_curves;

#define MASU_MESO_NUMBERS 24u

typedef struct masu_meso_surface {
    masu_meso_vec3 normal; /* unit */
    double color[3];
    double roughness, ao;
    double specular; /* factor of the specular terms */
    double shadow;   /* f */
} masu_meso_surface;

/* Bounds of what the lost normals' spread divides diffuse light by: this and its inverse. */
#define MASU_MESO_FADE_MIN 0.25

/* Curves that change nothing, for a facet roughness. */
masu_meso_curves masu_meso_identity(double facet);
/* Its numbers are finite and the facets' roughness is one. */
#define MASU_MESO_NUMBER_MAX 1000.0

/* v, unit, to the viewer; n the polygon's normal. */
void masu_meso_bend(const masu_meso_curves *curves, masu_meso_vec3 v, masu_meso_vec3 n,
                    masu_meso_surface *surface);
/* The share of a light that arrives, on a bent surface: f'. */
double masu_meso_shadow(const masu_meso_surface *surface, masu_meso_vec3 v, masu_meso_vec3 l);

#endif
