/* brdf.h: the surface model in double precision, from the formulas of shaders/brdf/bsdf.glsl but
 * not from its code: Smith's Lambda instead of a visibility term, the cosine form of D, and
 * integrals over half vectors instead of visible normals. */
#ifndef MASU_REFERENCE_BRDF_H
#define MASU_REFERENCE_BRDF_H

#include <stdint.h>

typedef struct brdf_surface {
    double albedo[3], roughness, metallic, specular, coat, coat_roughness;
} brdf_surface;

enum { BRDF_WHITE, BRDF_WEIGHT, BRDF_COVERED, BRDF_COVERED_WEIGHT, BRDF_INTEGRALS };

/* For a lobe of this roughness and a direction with cosine mu > 0: the reflectance of a white lobe,
 * its weight of (1 - h.v)^5, and both times max((1 - N.v)^5, (1 - N.l)^5). steps: per angle. */
void brdf_integrals(double roughness, double mu, int steps, double out[BRDF_INTEGRALS]);

/* The same from the table; `words` are masu_split_sum of gen/split_sum.h. */
void brdf_looked_up(const uint32_t *words, double roughness, double mu, double out[BRDF_INTEGRALS]);

/* f * N.L * pi, with normal +z. 0 if l is below the horizon; v is raised to at least 1e-4 above
 * it. */
void brdf_eval(const uint32_t *words, const brdf_surface *s, const double v[3], const double l[3],
               double out[3]);

/* The same with a coat that has a separate unit normal; +z is the normal of the base. */
void brdf_over(const uint32_t *words, const brdf_surface *s, const double coat_normal[3],
               const double v[3], const double l[3], double out[3]);

/* Reflected light under uniform illumination: factors of irradiance / pi, of the radiance in the
 * base's mirror direction, and of the radiance in the coat's. v is unit, the normal of the base
 * +z. */
void brdf_ambient(const uint32_t *words, const brdf_surface *s, const double coat_normal[3],
                  const double v[3], double diffuse[3], double specular[3], double *coat);

/* The total reflected light of uniform radiance 1, by quadrature of each lobe. */
void brdf_furnace(const uint32_t *words, const brdf_surface *s, double mu, int steps,
                  double out[3]);

#endif
