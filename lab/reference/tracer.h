/* tracer.h: the radiance along one path.
 *
 *   full     all light paths: what the scene looks like
 *   direct   the light paths that Masu promises (docs/scene.md): sun with shadows, punctual lights
 *            without, sky and ambient light, occluded within the radius of ambient occlusion only,
 *            and one mirror reflection where the scene traces reflections; no light between
 *            diffuse surfaces */
#ifndef LAB_REFERENCE_TRACER_H
#define LAB_REFERENCE_TRACER_H

#include "lab/reference/geometry.h"
#include "lab/reference/sky.h"

typedef struct ref_tracer {
    const ref_world *world;
    const ref_sky *sky;
    bool physics; /* random walks, shadows of punctual lights, sky as seen for diffuse light too */
    bool full;
    bool polygons_shadow, field_shadows;
    bool sky_samples, light_samples; /* strategies beside sampling the BSDF; for tests. Both true */
    bool bsdf_samples;
    uint32_t bounces;                 /* most surfaces of a path after the first */
    double sun_radius;                /* half angle, radians; 0: a delta light */
    ref_vec sun_direction, sun_color; /* irradiance / pi */
    ref_vec eye;
    double occlusion_radius; /* of ambient occlusion, direct only; 0: none */
    double field_occlusion_radius, field_occlusion_strength; /* of the field's own; 0: none */
    ref_light_box window; /* through which the sky is looked for; cumulative 0: none */
    double cutoff;        /* roughness from which no reflection is traced; 0: none is */
    const masu_blob_environment *environment;
    /* ref_irradiance without the direct light of sun, local lights and emissive materials with `true` here; NULL: all
     * light. */
    const bool *direct;
    bool diffuse_hits; /* ref_irradiance: surfaces reflect by their base colour, diffusely, as probe rays shade them */
} ref_tracer;

/* From the camera along d, unit. */
ref_vec ref_radiance(const ref_tracer *t, ref_vec d, ref_random *r);

/* Irradiance / pi by a point or spot at p, as if it had no size, on a surface that faces it. *l: towards it, unit. */
ref_vec ref_light_at(const ref_light *light, ref_vec p, ref_vec *l);

/* Parts of shade.c, lights.c. */
void ref_sun_light(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                   ref_lobes *out);
/* share: of base and coat, what is traced of a mirrored light's surface instead; NULL: nothing. */
void ref_local_lights(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                      const double share[2], ref_lobes *out);
/* Adds `from`, each lobe times color. */
void ref_add_lobes(ref_lobes *to, const ref_lobes *from, ref_vec color);
/* Light that reaches a surface from a light source at the distance `far` along l. */
ref_vec ref_light_visible(const ref_tracer *t, const ref_hit *hit, ref_vec l, double far, bool shadows);
bool ref_is_unlit(const ref_surface *s);
/* Fog along a segment that begins at `from` in direction d: the part of the light that is left.
 * far: HUGE_VAL for the sky. */
double ref_air_left(const ref_tracer *t, ref_vec from, ref_vec d, double far);
ref_vec ref_air_color(const ref_tracer *t, ref_vec d);
/* The sky as the camera sees it, with the glow around the sun. */
ref_vec ref_sky_seen(const ref_tracer *t, ref_vec d);
/* color behind `left` of air, of a layer that covers `alpha`. */
static inline ref_vec ref_through_air(const ref_tracer *t, ref_vec color, ref_vec d, double left,
                                      double alpha) {
    if (left >= 1) return color;
    return ref_along(ref_scale(color, left), (1 - left) * alpha, ref_air_color(t, d));
}
/* Transparent surfaces: what of the light behind is left, how the soft part is dimmed, what of
 * all is covered. */
typedef struct ref_pane {
    ref_vec behind;
    double soft, mirror, taken;
} ref_pane;
ref_pane ref_pane_of(const ref_look *look, const ref_bsdf *b);
/* Which way a ray goes on behind rough glass: as a reflection by a facet (GGX), mirrored to the other side. */
ref_vec ref_pane_scatter(const ref_look *look, ref_vec d, ref_random *r);
/* Part of the light from the distance `far` along l that arrives: transparent surfaces dim it in
 * physics mode only. */
ref_vec ref_unoccluded(const ref_tracer *t, ref_vec from, ref_vec l, double far, unsigned flags);

ref_vec ref_direct(const ref_tracer *t, ref_vec from, ref_vec d, ref_random *r, int depth);
ref_vec ref_full(const ref_tracer *t, ref_vec from, ref_vec d, ref_random *r);
/* Light that arrives at a surface from the side of its normal by all paths, over all directions. */
ref_vec ref_irradiance(const ref_tracer *t, const ref_hit *at, ref_random *r);

#endif
