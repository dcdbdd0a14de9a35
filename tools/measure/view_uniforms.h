/* view_uniforms.h: the uniforms of one moment of a scene in double precision, from the baked blob
 * and a camera, for the ground truth's march and shading. A plain struct; owns nothing. */
#ifndef MASU_VIEW_UNIFORMS_H
#define MASU_VIEW_UNIFORMS_H

#include "masu.h"

#include <stdbool.h>

typedef struct masu_view {
    uint32_t width, height; /* pixels */
    double eye[3], forward[3];
    double right[3], up[3]; /* scaled by tan(fov_x / 2), tan(fov_y / 2) */
    double tan_y, near_distance;
    double sun_direction[3], sun_color[3], ambient[3], sky_zenith[3], sky_horizon[3], exposure;
    double sdf_min[3], sdf_max[3], max_distance;
    double time;
    double params[MASU_MAX_SDF_PARAMS];
} masu_view;

/* Fills the view; the blob of the scene must still be readable. On false `error` has one line: the
 * scene has no SDF, the scene also has polygons, which the ground truth does not support, or the
 * camera is invalid. */
bool masu_view_of(const masu_scene *scene, const masu_camera *camera, double time, uint32_t width,
                  uint32_t height, masu_view *out, char *error, size_t error_size);

/* The same for any scene, without its SDF: time, parameters, bounds and max_distance are 0. */
bool masu_view_seen(const masu_scene *scene, const masu_camera *camera, uint32_t width,
                    uint32_t height, masu_view *out, char *error, size_t error_size);

/* The ray through the centre of pixel (x, y). */
typedef struct masu_view_ray {
    double direction[3]; /* unit */
    double z_scale;      /* distance along the ray per unit of view z */
    double pixel;        /* width of the pixel's cone at distance 1 */
    double start, limit; /* interval that may contain the SDF: from the near plane, within the SDF's
                          * bounds */
} masu_view_ray;

masu_view_ray masu_view_ray_at(const masu_view *view, uint32_t x, uint32_t y);

#endif
