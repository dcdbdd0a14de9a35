/* sdf.c: see sdf.h. */
#include "frame/sdf.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

void masu_sdf_alloc(masu_sdf *sdf, masu_arena *arena, const masu_frame_plan *plan) {
    sdf->params =
        masu_arena_alloc(arena, "SDF parameters", plan->scene.sdf_params, sizeof *sdf->params, 4);
}

void masu_sdf_copy_scene(masu_sdf *sdf, const masu_frame_plan *plan, const masu_scene_view *v) {
    if (plan->scene.sdf_params)
        memcpy(sdf->params, v->sdf_params, plan->scene.sdf_params * sizeof *v->sdf_params);
    if (!v->sdf) return;
    for (uint32_t k = 0; k < 3; k++) {
        sdf->bounds[0][k] = v->sdf->bounds_min[k];
        sdf->bounds[1][k] = v->sdf->bounds_max[k];
    }
    sdf->bounds[0][3] = 1.0f / v->sdf->lipschitz;
    sdf->bounds[1][3] = v->sdf->max_distance;
}

/* The SDF's space. If fp32 resolves world coordinates too coarsely at the camera, and the
 * scene's code supports floating origins, the origin moves to a point near the camera. It is on
 * a grid, so that it rarely changes: rounding of the field would otherwise differ between
 * frames. */
static void set_origin(const masu_sdf *sdf, masu_frame_data *f) {
    struct masu_frame_uniforms *u = &f->u;
    int far = 0;
    for (uint32_t i = 0; i < 3; i++) {
        far |= f->plan->scene.sdf_anchored && fabs(f->eye[i]) >= MASU_ANCHOR_FROM;
    }
    for (uint32_t i = 0; i < 3; i++) {
        double steps = floor(f->eye[i] / MASU_ANCHOR_GRID + 0.5);
        u->anchor[i] = far ? (float)(steps * MASU_ANCHOR_GRID) : 0.0f;
        double anchor = (double)u->anchor[i], eye = f->eye[i] - anchor;
        u->sdf_eye_hi[i] = (float)eye;
        u->sdf_eye_lo[i] = (float)(eye - (double)u->sdf_eye_hi[i]);
        u->sdf_min[i] = (float)((double)sdf->bounds[0][i] - anchor);
        u->sdf_max[i] = (float)((double)sdf->bounds[1][i] - anchor);
        u->sdf_low[i] = (float)((double)sdf->bounds[0][i] - f->eye[i]);
        u->sdf_high[i] = (float)((double)sdf->bounds[1][i] - f->eye[i]);
    }
    float largest = 0.0f;
    for (uint32_t i = 0; i < 3; i++) largest = fmaxf(largest, fabsf(u->sdf_eye_hi[i]));
    u->sdf_eye_hi[3] = largest * 0x1p-20f;
    u->sdf_min[3] = sdf->bounds[0][3];
    u->sdf_max[3] = sdf->bounds[1][3];
}

masu_result masu_sdf_read(const masu_sdf *sdf, masu_frame_data *f, masu_detail *detail) {
    uint32_t params = f->plan->scene.sdf_params;
    uint32_t given = f->desc.sdf_param_count;
    if (given > params) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "sdf_param_count", params, given,
                         "sdf_param_count is %u, the scene has %u", given, params);
    }
    if (given && !f->desc.sdf_params) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "sdf_params", given, 0,
                         "sdf_params is NULL, needed is an array: sdf_param_count is %u", given);
    }
    for (uint32_t i = 0; i < params; i++) {
        const masu_blob_sdf_param *p = &sdf->params[i];
        float v = i < given ? f->desc.sdf_params[i] : p->value;
        if (!isfinite(v)) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "sdf_params", 0, i,
                             "sdf_params[%u] is %g, allowed are finite numbers", i, (double)v);
        }
        f->u.sdf_params[i / 4][i % 4] = v < p->minimum   ? p->minimum
                                        : v > p->maximum ? p->maximum
                                                         : v;
    }
    set_origin(sdf, f);
    return MASU_OK;
}
