/* occlusion.h: how much of the sun and of the ambient light a field leaves to a surface point, the
 * slow way: many rays in double precision, each marched until it hits or leaves.
 *
 * The sun is a disc; its visible part is the fraction of rays, spread evenly over it, that get away.
 * Ambient visibility is the cosine-weighted part of the hemisphere that is free, where something at
 * distance t < radius counts as 1 - t / radius of an obstacle. Written from these two sentences and
 * docs/scene.md, not from the shader. */
#ifndef MASU_REFERENCE_OCCLUSION_H
#define MASU_REFERENCE_OCCLUSION_H

typedef struct masu_ref_field {
    double (*step)(const double *params, double time, const double p[3]); /* never too far */
    const double *params;
    double time;
    double low[3], high[3]; /* nothing outside casts a shadow */
} masu_ref_field;

/* point: on the surface; normal, sun: unit. tangent: of the sun's radius. */
double masu_ref_sun_seen(const masu_ref_field *field, const double point[3], const double normal[3],
                         const double sun[3], double tangent, double distance, int rays);
double masu_ref_ambient_seen(const masu_ref_field *field, const double point[3],
                             const double normal[3], double radius, int rays);

#endif
