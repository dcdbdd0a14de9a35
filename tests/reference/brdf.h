/* brdf.h: the surface model in double precision, from the formulas of shaders/brdf/bsdf.glsl but not from
 * their code: Smith's Lambda instead of a visibility term, the cosine form of D, integrals over half
 * vectors instead of visible normals. */
#ifndef MASU_REFERENCE_BRDF_H
#define MASU_REFERENCE_BRDF_H

#include <stdint.h>

typedef struct brdf_surface {
    double albedo[3], roughness, metallic, specular, coat, coat_roughness;
} brdf_surface;

enum { BRDF_WHITE, BRDF_WEIGHT, BRDF_COVERED, BRDF_COVERED_WEIGHT, BRDF_INTEGRALS };

/* Of a lobe of this roughness and a direction with cosine mu > 0: what a white one returns, its weight of
 * (1 - h.v)^5, and both times max((1 - N.v)^5, (1 - N.l)^5). steps: in each of the two angles. */
void brdf_integrals(double roughness, double mu, int steps, double out[BRDF_INTEGRALS]);

/* The same from the table, `words` of which are masu_split_sum of gen/split_sum.h. */
void brdf_looked_up(const uint32_t *words, double roughness, double mu, double out[BRDF_INTEGRALS]);

/* f * N.L * pi, the normal being +z. 0 where l is below; v counts as at least 1e-4 above. */
void brdf_eval(const uint32_t *words, const brdf_surface *s, const double v[3], const double l[3],
               double out[3]);

/* The same of a coat with a unit normal of its own: +z is that of what lies below. */
void brdf_over(const uint32_t *words, const brdf_surface *s, const double coat_normal[3], const double v[3],
               const double l[3], double out[3]);

/* What the surface returns of light from everywhere: of irradiance / pi, of what lies in the mirror of the base, and
 * in that of the coat. v is unit, the normal of what lies below +z. */
void brdf_ambient(const uint32_t *words, const brdf_surface *s, const double coat_normal[3], const double v[3],
                  double diffuse[3], double specular[3], double *coat);

/* All that the surface returns of light of radiance 1 from everywhere, by quadrature of each lobe. */
void brdf_furnace(const uint32_t *words, const brdf_surface *s, double mu, int steps,
                  double out[3]);

#endif
