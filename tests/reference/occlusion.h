/* occlusion.h: visibility of the sun and of ambient light at a surface point of a field, the slow
 * way: many rays in double precision, each traced until it hits or leaves.
 *
 * The sun is a disc; its visible part is the fraction of rays, spread evenly over it, that miss.
 * Ambient visibility is the cosine-weighted part of the hemisphere that is free; an obstacle at
 * distance t < radius occludes by 1 - t / radius. Written from these two sentences and
 * docs/scene.md, not from the shader. */
#ifndef MASU_REFERENCE_OCCLUSION_H
#define MASU_REFERENCE_OCCLUSION_H

typedef struct masu_ref_field {
    /* never more than the distance to the surface */
    double (*step)(const double *params, double time, const double p[3]);
    const double *params;
    double time;
    double low[3], high[3]; /* nothing outside casts a shadow */
} masu_ref_field;

/* point: on the surface; normal, sun: unit. tangent: of the sun's angular radius. */
double masu_ref_sun_seen(const masu_ref_field *field, const double point[3], const double normal[3],
                         const double sun[3], double tangent, double distance, int rays);
double masu_ref_ambient_seen(const masu_ref_field *field, const double point[3],
                             const double normal[3], double radius, int rays);

#endif
