/* view_uniforms.c: see view_uniforms.h. */
#include "measure/view_uniforms.h"

#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void widen(const float *from, double to[3]) {
    for (int i = 0; i < 3; i++) to[i] = (double)from[i];
}

static bool unit(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0.0 && isfinite(length))) return false;
    for (int i = 0; i < 3; i++) v[i] /= length;
    return true;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static bool look(const masu_camera *c, masu_view *v) {
    double wish[3] = {0, 1, 0};
    for (int i = 0; i < 3; i++) v->eye[i] = c->position[i];
    widen(c->forward, v->forward);
    if (c->up[0] != 0.0f || c->up[1] != 0.0f || c->up[2] != 0.0f) widen(c->up, wish);
    if (!unit(v->forward) || !unit(wish)) return false;
    cross(v->forward, wish, v->right);
    /* Straight up or down: the same right axis as the runtime. */
    if (!unit(v->right)) memcpy(v->right, (double[3]){1, 0, 0}, sizeof v->right);
    cross(v->right, v->forward, v->up);
    v->tan_y = tan((double)c->fov_y * 0.5);
    double tan_x = v->tan_y * v->width / v->height;
    for (int i = 0; i < 3; i++) {
        v->right[i] *= tan_x;
        v->up[i] *= v->tan_y;
    }
    return true;
}

bool masu_view_seen(const masu_scene *scene, const masu_camera *camera, uint32_t width,
                    uint32_t height, masu_view *out, char *error, size_t error_size) {
    memset(out, 0, sizeof *out);
    masu_scene_view blob = masu_scene_view_of(scene);
    out->width = width;
    out->height = height;
    if (!look(camera, out)) {
        snprintf(error, error_size, "the camera has no direction");
        return false;
    }
    const masu_blob_environment *e = blob.environment;
    float near_distance = camera->near_distance != 0.0f ? camera->near_distance : e->near_distance;
    out->near_distance = (double)near_distance;
    widen(e->sun_direction, out->sun_direction);
    (void)unit(out->sun_direction);
    widen(e->sun_color, out->sun_color);
    widen(e->ambient, out->ambient);
    widen(e->sky_zenith, out->sky_zenith);
    widen(e->sky_horizon, out->sky_horizon);
    out->exposure = (double)e->exposure;
    return true;
}

bool masu_view_of(const masu_scene *scene, const masu_camera *camera, double time, uint32_t width,
                  uint32_t height, masu_view *out, char *error, size_t error_size) {
    masu_scene_view blob = masu_scene_view_of(scene);
    if (!blob.sdf || blob.sdf->has_raster) {
        snprintf(error, error_size, "%s",
                 blob.sdf ? "the scene has polygons, which the truth does not know"
                          : "the scene has no SDF");
        return false;
    }
    if (!masu_view_seen(scene, camera, width, height, out, error, error_size)) return false;
    out->time = (double)(float)time; /* as in the shaders */
    widen(blob.sdf->bounds_min, out->sdf_min);
    widen(blob.sdf->bounds_max, out->sdf_max);
    out->max_distance = (double)blob.sdf->max_distance;
    for (uint32_t i = 0;
         i < masu_scene_count(scene, MASU_SCENE_SDF_PARAM) && i < MASU_MAX_SDF_PARAMS; i++)
        out->params[i] = (double)blob.sdf_params[i].value;
    return true;
}

masu_view_ray masu_view_ray_at(const masu_view *v, uint32_t x, uint32_t y) {
    masu_view_ray r;
    double u = (x + 0.5) / v->width * 2 - 1, w = (y + 0.5) / v->height * 2 - 1, through[3];
    for (int i = 0; i < 3; i++) through[i] = v->forward[i] + v->right[i] * u - v->up[i] * w;
    r.z_scale = sqrt(through[0] * through[0] + through[1] * through[1] + through[2] * through[2]);
    r.pixel = 2 * v->tan_y / v->height / r.z_scale;
    r.start = v->near_distance * r.z_scale;
    r.limit = v->max_distance;
    for (int i = 0; i < 3; i++) {
        double d = through[i] / r.z_scale;
        r.direction[i] = d;
        if (fabs(d) < 1e-12) d = 1e-12; /* as in the shader: avoids 0 * Inf */
        double a = (v->sdf_min[i] - v->eye[i]) / d, b = (v->sdf_max[i] - v->eye[i]) / d;
        r.start = fmax(r.start, fmin(a, b));
        r.limit = fmin(r.limit, fmax(a, b));
    }
    return r;
}
