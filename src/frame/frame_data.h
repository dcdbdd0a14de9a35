/* frame_data.h: data of the current frame, on the stack of masu_frame. Its steps read the
 * description and fill the uniforms. Also keeps the uniforms of the previous frame. */
#ifndef MASU_FRAME_DATA_H
#define MASU_FRAME_DATA_H

#include "base/arena.h"
#include "device/device.h"
#include "frame/timeline.h"
#include "plan/draws.h"
#include "plan/plan.h"
#include "shared/masu_shared.h"

typedef struct masu_frame_data {
    const masu_frame_plan *plan;
    const masu_device *device; /* for its mapped memory */
    const masu_draws *draws;
    masu_frame_desc desc; /* the host's description, with the rung that the governor has picked */
    uint64_t number;
    uint32_t slot;
    int cut; /* nothing of the previous frame counts: it is taken to be as this one */

    /* Results of the steps of masu_frame. */
    double eye[3];
    /* World position that camera, instances and their boxes, cascades and shadow faces are
     * relative to on the device: 0, or with desc.double_positions a point near a camera that is
     * far from 0. */
    double origin[3];
    /* Tangents of the angles between `forward` and the farthest image edges, including the
     * largest jitter of any frame with this lens, so that bounds made from it do not change with
     * jitter. */
    double widest[2];
    masu_light light; /* with defaults */
    struct masu_frame_uniforms u;
    uint32_t cascades; /* bit per cascade of the shadow map that it draws */
    uint32_t faces;    /* 1: it renders shadow faces of punctual lights */
} masu_frame_data;

/* The previous frame, of no length where nothing reads velocities. It is kept here and not on
 * the device, so that no state crosses frames there and frames in flight need not know of each
 * other. */
typedef struct masu_history {
    struct masu_frame_uniforms *previous;
    double origin[3]; /* the previous frame's origin */
} masu_history;

void masu_history_alloc(masu_history *history, masu_arena *arena, const masu_frame_plan *plan);

/* The next frame of a timeline, of which nothing has been found yet. */
masu_frame_data masu_frame_begin(const masu_frame_plan *plan, const masu_device *device,
                                 const masu_draws *draws, const masu_timeline *timeline,
                                 const masu_frame_desc *desc);
const masu_rung *masu_frame_rung(const masu_frame_data *f);
const masu_rung_plan *masu_frame_rung_plan(const masu_frame_data *f);

/* Splits a double into a float and the remainder. Volatile: GCC 12 vectorises loops over this
 * function and then treats the conversion to float and back as the identity, which makes `low`
 * 0. */
static inline void masu_split_double(double value, float *high, float *low) {
    volatile float rounded = (float)value;
    *high = rounded;
    *low = (float)(value - (double)*high);
}

/* 0, or a point near a camera that is far from 0; it rarely changes. */
void masu_far_origin(const double eye[3], double origin[3]);
/* The previous frame's eye becomes relative to this frame's origin. */
void masu_history_rebase(masu_history *history, const masu_frame_data *f);

/* The frame's part of a buffer. */
unsigned char *masu_frame_slot(const masu_frame_data *f, masu_buffer_id buffer);

/* Checks the time; number, time and cut into the uniforms. */
masu_result masu_frame_read_time(masu_frame_data *f, masu_detail *detail);
/* The uniforms, which are whole, and the previous frame's to the slot. */
void masu_frame_write_uniforms(masu_history *history, const masu_frame_data *f);

#endif
