/* host_matrices.c: see host_matrices.h. The matrices come from the uniforms that shaders read, so
 * that the host and the shaders use the same camera. */
#include "frame/host_matrices.h"

#include "base/vec.h"
#include "frame/temporal.h"

#include <math.h>
#include <string.h>

/* Entry of a matrix that is given row by row. */
#define AT(m, row, column) (m)[4 * (row) + (column)]

/* The world's axes in view space: right, up, backward. */
static void read_axes(const struct masu_frame_uniforms *u, double axes[3][3]) {
    const float *from[3] = {u->right, u->up, u->forward};
    for (uint32_t k = 0; k < 3; k++) {
        double length = 0.0;
        for (uint32_t i = 0; i < 3; i++) length += (double)from[k][i] * (double)from[k][i];
        for (uint32_t i = 0; i < 3; i++)
            axes[k][i] = (k == 2 ? -1.0 : 1.0) * (double)from[k][i] / sqrt(length);
    }
}

/* The component of a row of clip_from_rel along a view-space axis. */
static float along(const struct masu_frame_uniforms *u, uint32_t row, const double axis[3]) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 3; i++) sum += (double)u->clip_from_rel[i * 4 + row] * axis[i];
    return (float)sum;
}

void masu_frame_view_write(masu_frame_view *view, const masu_frame_data *f) {
    const struct masu_frame_uniforms *u = &f->u;
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    const float render[2] = {(float)rp->render_width, (float)rp->render_height};
    double axes[3][3];
    read_axes(u, axes);
    memset(view, 0, sizeof *view);
    view->frame = f->number;
    view->near_distance = u->forward[3];
    view->exposure = f->light.exposure;
    view->render_width = rp->render_width;
    view->render_height = rp->render_height;
    view->output_width = f->plan->desc.output.width;
    view->output_height = f->plan->desc.output.height;
    for (uint32_t k = 0; k < 3; k++) {
        double back = 0.0;
        view->position[k] = f->eye[k];
        for (uint32_t i = 0; i < 3; i++) {
            AT(view->view, k, i) = (float)axes[k][i];
            back -= axes[k][i] * f->eye[i];
        }
        AT(view->view, k, 3) = (float)back;
    }
    AT(view->view, 3, 3) = 1.0f;
    /* Elements that are 0 in every projection are set to 0 exactly, without rounding errors. */
    float *p = view->projection;
    for (uint32_t k = 0; k < 2; k++) {
        AT(p, k, k) = along(u, k, axes[k]);
        AT(p, k, 2) = along(u, k, axes[2]);
    }
    AT(p, 2, 3) = view->near_distance;
    AT(p, 3, 2) = -1.0f;
    /* temporal.comp removes the jitter, so the camera's own jitter is removed here too. */
    float own[2];
    int resolves = masu_temporal_jitter(f, own) > 0.0f;
    memcpy(view->output_projection, p, sizeof view->projection);
    for (uint32_t k = 0; k < 2; k++) {
        view->jitter[k] = (f->desc.camera ? f->desc.camera->jitter[k] : 0.0f) + own[k];
        if (resolves) AT(view->output_projection, k, 2) -= 2.0f * view->jitter[k] / render[k];
    }
}
