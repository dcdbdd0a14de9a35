/* model.h: the effect of a material's relief on its texels, as the renderer computes it. The GLSL
 * version is shaders/brdf/meso.glsl; tests/gpu/test_meso.c compares both.
 *
 * With x = dot(V, N of the polygon), y = 1 - x, and poly(c) = y (c0 + y (c1 + y c2)), which is 0
 * from straight above, where the texels need no change:
 *
 *   normal     N' = normalise(N + poly(tilt) (V - N dot(N, V)))    visible facets lean to the
 *   viewer
 *   roughness  r' = clamp(r (1 + poly(rough)), facet, 1)           and vary less
 *   AO         A' = clamp01(A + (1 - A) poly(ao))                  and are less occluded
 *   colour     c' = c (1 + y^2 tint)                               and have another colour
 *   specular   s' = clamp01(specular0 + y (specular1 + y specular2)), of both specular terms
 *   sun        D  = max(1 + poly(gain), 0.05) / clamp(1 + S s(y), 1/4, 4)   of diffuse light from
 *                                                                  lights; s = spread + y (spread1
 *                                                                  +
 *                                                                  y spread2)
 *   lights     f  = clamp01(offset - alpha (1 - A'))               fraction that is not shadowed
 *              f' = clamp01(f (1 + 0.3 (V.L)^3))                   more towards the light: shadows
 *              are
 *                                                                  hidden along it, and largest
 *                                                                  against it
 *
 * f' scales the light of lights, A' the ambient light. The renderer has one albedo for both, so D
 * is multiplied into the albedo and divided out of the occlusion: albedo c' D, occlusion min(A' /
 * D, 1). S is the variance of a texel's roughness beyond that of the facets, S = (r^4 - facet^4) /
 * 2: normals averaged by a mip are shorter, which has a larger weight at some angles. With s a mip
 * preserves the light of its texels at every angle; a single number for all angles has an error of
 * up to 10 %. f is linear in A between its clamps, so it may be filtered.
 *
 * The forms of tilt, roughness and AO were presented for Gran Turismo 7 (Polyphony Digital,
 * CEDEC+KYUSHU / CEDEC 2022). So was f, except for one term: there it is clamp01(N.L - alpha (1 -
 * AO) + 1/2). With a free factor of N.L, fits to the radiance of asphalt, gravel and grass gave 0
 * for it, so it is omitted; offset, (V.L)^3, D, specular and S are measured additions.
 * docs/design/04-surfaces.md has the table. */
#ifndef MASU_MESO_MODEL_H
#define MASU_MESO_MODEL_H

#include "meso/patch.h"

/* Order and number of the floats match the blob's record: six vec4. */
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

/* Lower bound of the divisor of diffuse light for the lost normals' spread; the upper bound is its
 * inverse. */
#define MASU_MESO_FADE_MIN 0.25

/* Curves without effect, for a facet roughness. */
masu_meso_curves masu_meso_identity(double facet);
/* Largest absolute value of a number. */
#define MASU_MESO_NUMBER_MAX 1000.0

/* Applies the curves. v: unit, to the viewer; n: the polygon's normal. */
void masu_meso_bend(const masu_meso_curves *curves, masu_meso_vec3 v, masu_meso_vec3 n,
                    masu_meso_surface *surface);
/* Fraction of a light that arrives at a modified surface: f'. */
double masu_meso_shadow(const masu_meso_surface *surface, masu_meso_vec3 v, masu_meso_vec3 l);

#endif
