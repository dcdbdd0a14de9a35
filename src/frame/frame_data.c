/* frame_data.c: see frame_data.h. */
#include "frame/frame_data.h"

#include "base/error.h"
#include "device/bind.h"

#include <math.h>
#include <string.h>

void masu_history_alloc(masu_history *history, masu_arena *arena, const masu_frame_plan *plan) {
    history->previous = masu_arena_alloc(arena, "previous frame", plan->needs.velocity ? 1 : 0,
                                         sizeof *history->previous, 16);
}

masu_frame_data masu_frame_begin(const masu_frame_plan *plan, const masu_device *device,
                                 const masu_draws *draws, const masu_timeline *timeline,
                                 const masu_frame_desc *desc) {
    masu_frame_data f;
    memset(&f, 0, sizeof f);
    f.plan = plan;
    f.device = device;
    f.draws = draws;
    f.desc = *desc;
    f.number = timeline->frame;
    f.slot = (uint32_t)(timeline->frame % plan->desc.frames_in_flight);
    f.cut =
        desc->cut || timeline->frame == 0 || timeline->cut || desc->viewport != timeline->viewport;
    return f;
}

const masu_rung *masu_frame_rung(const masu_frame_data *f) {
    return &f->plan->desc.rungs[f->desc.rung];
}

const masu_rung_plan *masu_frame_rung_plan(const masu_frame_data *f) {
    return &f->plan->rungs[f->desc.rung];
}

unsigned char *masu_frame_slot(const masu_frame_data *f, masu_buffer_id buffer) {
    return masu_buffer_pointer(f->device, buffer, f->slot);
}

masu_result masu_frame_read_time(masu_frame_data *f, masu_detail *detail) {
    /* Beyond this a float has no seconds left; far beyond, it is infinite. */
    if (!(fabs(f->desc.time) <= 1e15))
        return masu_fail_number(detail, "time", f->desc.time, "-1e15 to 1e15 s");
    if (!(fabsf(f->desc.time_step) <= 1e15f))
        return masu_fail_number(detail, "time_step", (double)f->desc.time_step, "-1e15 to 1e15 s");
    f->u.eye_hi[3] = (float)f->desc.time;
    f->u.eye_lo[3] = f->desc.time_step;
    f->u.history[0] = (uint32_t)f->number;
    if (f->cut) f->u.history[3] |= MASU_HISTORY_CUT;
    return MASU_OK;
}

void masu_far_origin(const double eye[3], double origin[3]) {
    int far = 0;
    for (uint32_t k = 0; k < 3; k++) far |= fabs(eye[k]) >= MASU_ANCHOR_FROM;
    for (uint32_t k = 0; k < 3; k++)
        origin[k] = far ? floor(eye[k] / MASU_ANCHOR_GRID + 0.5) * MASU_ANCHOR_GRID : 0.0;
}

void masu_history_rebase(masu_history *history, const masu_frame_data *f) {
    double moved[3];
    for (uint32_t k = 0; k < 3; k++) {
        moved[k] = history->origin[k] - f->origin[k];
        history->origin[k] = f->origin[k];
        if (moved[k] == 0.0 || f->cut || !f->plan->needs.velocity) continue;
        struct masu_frame_uniforms *u = history->previous;
        double eye = (moved[k] + (double)u->eye_hi[k]) + (double)u->eye_lo[k];
        masu_split_double(eye, &u->eye_hi[k], &u->eye_lo[k]);
    }
}

void masu_frame_write_uniforms(masu_history *history, const masu_frame_data *f) {
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_FRAME);
    memcpy(to, &f->u, sizeof f->u);
    if (!f->plan->needs.velocity) return;
    uint64_t half = f->plan->buffers[MASU_BUFFER_FRAME].stride / 2;
    memcpy(to + half, f->cut ? &f->u : history->previous, sizeof f->u);
    *history->previous = f->u;
}
