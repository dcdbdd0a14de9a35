/* tracer.h: the radiance along one path.
 *
 *   full     all light paths: the physical appearance of the scene
 *   direct   the light paths that Masu specifies (docs/scene.md): sun with shadows, punctual lights
 *            without, sky and ambient light, occluded only within the radius of ambient occlusion,
 *            and one mirror reflection if the scene traces reflections; no light between diffuse
 *            surfaces */
#ifndef LAB_REFERENCE_TRACER_H
#define LAB_REFERENCE_TRACER_H

#include "lab/reference/geometry.h"
#include "lab/reference/sky.h"

typedef struct ref_tracer {
    const ref_world *world;
    const ref_sky *sky;
    bool physics; /* random walks, shadows of punctual lights, the visible sky also for diffuse
                   * light */
    bool full;
    bool polygons_shadow, field_shadows;
    bool sky_samples, light_samples; /* strategies in addition to sampling the BSDF; false only in
                                      * tests */
    bool bsdf_samples;
    uint32_t bounces;                 /* maximum number of surfaces of a path after the first */
    double sun_radius;                /* half angle, radians; 0: a delta light */
    ref_vec sun_direction, sun_color; /* irradiance / pi */
    ref_vec eye;
    double occlusion_radius; /* of ambient occlusion, direct only; 0: none */
    double field_occlusion_radius, field_occlusion_strength; /* of the field's occlusion; 0: none */
    ref_light_box window; /* samples the sky through this box; cumulative 0: none */
    double cutoff;        /* roughness from which no reflection is traced; 0: none */
    const masu_blob_environment *environment;
    /* ref_irradiance excludes the direct light of the sun, of local lights and of emissive
     * materials with `true` here; NULL: includes all light. */
    const bool *direct;
    bool diffuse_hits; /* ref_irradiance: surfaces reflect diffusely by their base colour, as in
                        * probe rays */
} ref_tracer;

/* From the camera along d, unit. */
ref_vec ref_radiance(const ref_tracer *t, ref_vec d, ref_random *r);

/* Irradiance / pi by a point or spot light at p, as if it had no size, on a surface that faces it.
 * *l: towards the light, unit. */
ref_vec ref_light_at(const ref_light *light, ref_vec p, ref_vec *l);

/* Parts of shade.c, lights.c. */
void ref_sun_light(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                   ref_lobes *out);
/* share: fractions of base and coat whose mirrored light surface is traced instead; NULL: none. */
void ref_local_lights(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                      const double share[2], ref_lobes *out);
/* Adds `from`, with each lobe times color. */
void ref_add_lobes(ref_lobes *to, const ref_lobes *from, ref_vec color);
/* Light that reaches a surface from a light source at the distance `far` along l. */
ref_vec ref_light_visible(const ref_tracer *t, const ref_hit *hit, ref_vec l, double far,
                          bool shadows);
bool ref_is_unlit(const ref_surface *s);
/* Transmittance of fog along a segment that starts at `from` in direction d. far: HUGE_VAL for the
 * sky. */
double ref_air_left(const ref_tracer *t, ref_vec from, ref_vec d, double far);
ref_vec ref_air_color(const ref_tracer *t, ref_vec d);
/* The sky visible to the camera, with the glow around the sun. */
ref_vec ref_sky_seen(const ref_tracer *t, ref_vec d);
/* color behind air of transmittance `left`, for a layer with coverage `alpha`. */
static inline ref_vec ref_through_air(const ref_tracer *t, ref_vec color, ref_vec d, double left,
                                      double alpha) {
    if (left >= 1) return color;
    return ref_along(ref_scale(color, left), (1 - left) * alpha, ref_air_color(t, d));
}
/* Transparent surfaces: transmission of the light behind, factor of the soft part, coverage. */
typedef struct ref_pane {
    ref_vec behind;
    double soft, mirror, taken;
} ref_pane;
ref_pane ref_pane_of(const ref_look *look, const ref_bsdf *b);
/* Direction of a ray behind rough glass: reflected by a facet (GGX), mirrored to the other side. */
ref_vec ref_pane_scatter(const ref_look *look, ref_vec d, ref_random *r);
/* Fraction of the light from the distance `far` along l that arrives: transparent surfaces only
 * attenuate it in physics mode. */
ref_vec ref_unoccluded(const ref_tracer *t, ref_vec from, ref_vec l, double far, unsigned flags);

ref_vec ref_direct(const ref_tracer *t, ref_vec from, ref_vec d, ref_random *r, int depth);
ref_vec ref_full(const ref_tracer *t, ref_vec from, ref_vec d, ref_random *r);
/* Light that arrives at a surface on the side of its normal by all paths, over all directions. */
ref_vec ref_irradiance(const ref_tracer *t, const ref_hit *at, ref_random *r);

#endif
