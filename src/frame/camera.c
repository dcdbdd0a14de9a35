/* camera.c: see camera.h. */
#include "frame/camera.h"

#include "base/error.h"
#include "base/vec.h"
#include "frame/temporal.h"

#include <math.h>
#include <string.h>

/* ---- The path -------------------------------------------------------------------------------- */

void masu_camera_path_alloc(masu_camera_path *path, masu_arena *arena,
                            const masu_frame_plan *plan) {
    path->keys =
        masu_arena_alloc(arena, "camera keys", plan->scene.camera_keys, sizeof *path->keys, 4);
}

void masu_camera_path_copy_scene(masu_camera_path *path, const masu_frame_plan *plan,
                                 const masu_scene_view *v) {
    path->near_distance = v->environment->near_distance;
    if (plan->scene.camera_keys)
        memcpy(path->keys, v->camera_keys, plan->scene.camera_keys * sizeof *v->camera_keys);
}

masu_result masu_camera_path_at(const masu_camera_path *path, const masu_frame_plan *plan,
                                double time, masu_camera *out) {
    uint32_t n = plan->scene.camera_keys;
    if (!out || !isfinite(time)) return MASU_ERROR_ARGUMENT;
    if (!n) return MASU_ERROR_STATE;
    uint32_t k = 0;
    while (k + 2 < n && time >= (double)path->keys[k + 1].time) k++;
    const masu_blob_camera_key *a = &path->keys[k], *b = &path->keys[n > 1 ? k + 1 : k];
    double span = (double)b->time - (double)a->time;
    double u = span > 0.0 ? (time - (double)a->time) / span : 0.0;
    u = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < 3; i++) {
        out->position[i] =
            (double)a->position[i] + ((double)b->position[i] - (double)a->position[i]) * u;
        double target = (double)a->target[i] + ((double)b->target[i] - (double)a->target[i]) * u;
        out->forward[i] = (float)(target - out->position[i]);
    }
    out->fov_y = (float)((double)a->fov_y + ((double)b->fov_y - (double)a->fov_y) * u);
    /* Two keys whose positions and targets cross over coincide half-way: use the first key's
     * direction. */
    float ignored[3];
    if (!masu_unit(out->forward, ignored)) {
        for (uint32_t i = 0; i < 3; i++) out->forward[i] = a->target[i] - a->position[i];
    }
    return MASU_OK;
}

/* ---- A frame's ------------------------------------------------------------------------------- */

static masu_result bad_direction(masu_detail *detail, const char *what, const float v[3],
                                 const char *needed) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s is (%g, %g, %g), needed is %s",
                     what, (double)v[0], (double)v[1], (double)v[2], needed);
}

/* Orthonormal: right, up, forward. */
static masu_result find_axes(const masu_camera *c, float right[3], float up[3], float forward[3],
                             masu_detail *detail) {
    float wish[3] = {0.0f, 1.0f, 0.0f};
    for (uint32_t i = 0; i < 3; i++) {
        if (!(fabs(c->position[i]) <= 1e15)) {
            return masu_fail_element(detail, "camera.position", i, c->position[i],
                                     "-1e15 to 1e15 m");
        }
    }
    if (!masu_unit(c->forward, forward))
        return bad_direction(detail, "camera.forward", c->forward, "a direction: finite, not zero");
    int own_up = c->up[0] != 0.0f || c->up[1] != 0.0f || c->up[2] != 0.0f;
    if (own_up && !masu_unit(c->up, wish))
        return bad_direction(detail, "camera.up", c->up, "a finite direction, or (0, 0, 0)");
    masu_cross(forward, wish, right);
    if (!masu_unit(right, right)) {
        if (own_up) {
            return bad_direction(detail, "camera.up", c->up,
                                 "a direction that is not parallel to camera.forward");
        }
        /* Straight up or down without an up vector: any right vector is valid. */
        right[0] = 1.0f, right[1] = right[2] = 0.0f;
    }
    masu_cross(right, forward, up);
    return MASU_OK;
}

static int has_window(const masu_camera *c) {
    return c->left != 0.0f || c->right != 0.0f || c->bottom != 0.0f || c->top != 0.0f;
}

/* Two sides of a window. The minimum distance keeps the centre in pixels exact. */
static masu_result check_sides(const char *low_name, double low, const char *high_name, double high,
                               masu_detail *detail) {
    const char *name[2] = {low_name, high_name};
    double side[2] = {low, high};
    for (uint32_t i = 0; i < 2; i++) {
        if (!(fabs(side[i]) <= 100.0))
            return masu_fail_number(detail, name[i], side[i], "-100 to 100");
    }
    double apart = fmax(1e-4, fmax(fabs(low), fabs(high)) / 1024.0);
    if (high - low >= apart) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_ARGUMENT, high_name, 0, 0,
                     "%s is %g, needed is %s (%g) + %g or more", high_name, high, low_name, low,
                     apart);
}

/* Checks lens values; near_distance: the default. */
static masu_result check_lens(const masu_camera *c, float near_distance, masu_detail *detail) {
    if (!(near_distance >= 1e-9f && near_distance <= 1e9f)) {
        return masu_fail_number(detail, "camera.near_distance", (double)near_distance,
                                "0 and 1e-9 to 1e9 m");
    }
    if (has_window(c)) {
        masu_result result = check_sides("camera.left", (double)c->left, "camera.right",
                                         (double)c->right, detail);
        if (!result)
            result = check_sides("camera.bottom", (double)c->bottom, "camera.top", (double)c->top,
                                 detail);
        if (result) return result;
    }
    if (has_window(c) ? !isfinite(c->fov_y) : !(c->fov_y >= 0.0005f && c->fov_y <= 3.1f))
        return masu_fail_number(detail, "camera.fov_y", (double)c->fov_y, "0.0005 to 3.1 radians");
    for (uint32_t k = 0; k < 2; k++) {
        if (!(fabsf(c->jitter[k]) <= 1.0f))
            return masu_fail_element(detail, "camera.jitter", k, (double)c->jitter[k],
                                     "-1 to 1 pixels");
    }
    return MASU_OK;
}

/* Half of the window's width and height, and the centre in units of those: right and down. */
typedef struct lens {
    double half[2];
    double middle[2];
} lens;

static lens lens_of(const masu_camera *c, const masu_frame_data *f) {
    const VkExtent2D shown = f->plan->desc.output;
    lens l = {{0, 0}, {0, 0}};
    l.half[1] = tan((double)c->fov_y * 0.5);
    l.half[0] = l.half[1] * (double)shown.width / (double)shown.height;
    if (!has_window(c)) return l;
    double left = (double)c->left, right = (double)c->right, bottom = (double)c->bottom,
           top = (double)c->top;
    l.half[0] = 0.5 * (right - left);
    l.half[1] = 0.5 * (top - bottom);
    l.middle[0] = (right + left) / (right - left);
    l.middle[1] = -(top + bottom) / (top - bottom);
    return l;
}

static void project(const masu_camera *c, const float right[3], const float up[3],
                    const float forward[3], float near_distance, masu_frame_data *f) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    struct masu_frame_uniforms *u = &f->u;
    const float pixel[2] = {2.0f / (float)rp->render_width, 2.0f / (float)rp->render_height};
    float own[2], most = masu_temporal_jitter(f, own);
    lens l = lens_of(c, f);
    for (uint32_t k = 0; k < 2; k++) {
        u->jitter[2 + k] = (c->jitter[k] + own[k]) * pixel[k];
        u->jitter[k] = (float)((double)u->jitter[2 + k] + l.middle[k]);
        float moves = (fabsf(c->jitter[k]) + most) * pixel[k];
        f->widest[k] = (double)(float)l.half[k] * (1.0 + fabs(l.middle[k]) + (double)moves);
    }
    double tan_x = l.half[0], tan_y = l.half[1];
    for (uint32_t i = 0; i < 3; i++) {
        masu_split_double(c->position[i] - f->origin[i], &u->eye_hi[i], &u->eye_lo[i]);
        u->right[i] = (float)((double)right[i] * tan_x);
        u->up[i] = (float)((double)up[i] * tan_y);
        u->forward[i] = forward[i];
        /* Reverse-Z with an infinite far plane: depth = near / view z, so that fp32 resolution
         * is relative at any distance (near / depth gives view z again). Vulkan's clip y points
         * down. */
        u->clip_from_rel[i * 4 + 0] =
            (float)((double)right[i] / tan_x - (double)u->jitter[0] * (double)forward[i]);
        u->clip_from_rel[i * 4 + 1] =
            (float)(-(double)up[i] / tan_y - (double)u->jitter[1] * (double)forward[i]);
        u->clip_from_rel[i * 4 + 3] = forward[i];
    }
    u->clip_from_rel[14] = near_distance;
    u->right[3] = (float)tan_x;
    u->up[3] = (float)tan_y;
    u->forward[3] = near_distance;
}

/* Shaders compare the camera with probes in world space, and shadow faces with the SDF's space. */
static int has_origin(const masu_frame_plan *plan) {
    return plan->desc.double_positions && !plan->scene.probes && !plan->needs.bounce &&
           !(plan->needs.local_shadows && plan->needs.sdf);
}

masu_result masu_camera_read(const masu_camera_path *path, masu_frame_data *f,
                             masu_detail *detail) {
    masu_camera c;
    if (f->desc.camera) {
        c = *f->desc.camera;
    } else if (masu_camera_path_at(path, f->plan, f->desc.time, &c) != MASU_OK) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "camera", 1, 0,
                         "camera is NULL and the scene has no camera path");
    }
    float right[3], up[3], forward[3];
    float near_distance = c.near_distance != 0.0f ? c.near_distance : path->near_distance;
    masu_result result = find_axes(&c, right, up, forward, detail);
    if (!result) result = check_lens(&c, near_distance, detail);
    if (result) return result;
    memcpy(f->eye, c.position, sizeof f->eye);
    if (has_origin(f->plan)) masu_far_origin(f->eye, f->origin);
    project(&c, right, up, forward, near_distance, f);
    return MASU_OK;
}
