/* frame_data.h: the frame at hand. It lies on the stack of masu_frame, whose steps read and fill it: what
 * they are about, and the uniforms as they come to be. Besides, the uniforms of the previous frame. */
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
    masu_frame_desc desc; /* what the host wants, of the rung that the governor has picked */
    uint64_t number;
    uint32_t slot;
    int cut; /* nothing of the previous frame counts: it is taken to be as this one */

    /* What its steps have found. */
    double eye[3];
    /* World position that eye, instances and their boxes, cascades and shadow faces are relative to
     * on the device: 0, or with desc.double_positions a point near an eye that is far out. */
    double origin[3];
    /* Tangents of the angles between `forward` and the picture's farthest sides, in any frame with this lens: as if
     * jitter moved them as far out as it does in any, so that what is made wide enough for it stays as it is. */
    double widest[2];
    masu_light light; /* with defaults */
    struct masu_frame_uniforms u;
    uint32_t cascades; /* bit per cascade of the shadow map that it draws */
    uint32_t faces;    /* 1: it renders shadow faces of punctual lights */
} masu_frame_data;

/* The previous frame, of no length where nothing reads velocities. It is kept here and not on the device,
 * so that no state crosses frames there and frames in flight need not know of each other. */
typedef struct masu_history {
    struct masu_frame_uniforms *previous;
    double origin[3]; /* of its eye */
} masu_history;

void masu_history_alloc(masu_history *history, masu_arena *arena, const masu_frame_plan *plan);

/* The next frame of a timeline, of which nothing has been found yet. */
masu_frame_data masu_frame_begin(const masu_frame_plan *plan, const masu_device *device,
                                 const masu_draws *draws, const masu_timeline *timeline,
                                 const masu_frame_desc *desc);
const masu_rung *masu_frame_rung(const masu_frame_data *f);
const masu_rung_plan *masu_frame_rung_plan(const masu_frame_data *f);

/* A double as a float and what that leaves. Volatile: GCC 12 vectorises a loop of these and then takes
 * the conversion to float and back for the identity, which makes `low` 0. */
static inline void masu_split_double(double value, float *high, float *low) {
    volatile float rounded = (float)value;
    *high = rounded;
    *low = (float)(value - (double)*high);
}

/* 0, or where the eye is far out a point near it that rarely moves. */
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
