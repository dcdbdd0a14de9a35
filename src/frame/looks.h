/* looks.h: per-instance appearance that the host sets (masu_look): tint, emission, fade and
 * texture coordinates for the GPU; visible views for the CPU. Empty without desc.instance_looks.
 * Part of masu_instances (instances.h). */
#ifndef MASU_LOOKS_H
#define MASU_LOOKS_H

#include "frame/frame_data.h"

typedef struct masu_looks {
    masu_look *now;       /* [instance]; NULL without desc.instance_looks */
    uint8_t *writes;      /* [instance]: number of frames that still write it */
    uint32_t dirty_count; /* instances with a write left */
    uint32_t given;       /* instances whose look is not all zero */
    uint32_t changes;     /* since the start */
} masu_looks;

void masu_looks_alloc(masu_looks *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_looks_init(masu_looks *s, const masu_frame_plan *plan);

/* MASU_ERROR_STATE without desc.instance_looks, MASU_ERROR_ARGUMENT if a value is out of range. */
masu_result masu_looks_check(const masu_frame_plan *plan, const masu_look *look,
                             masu_detail *detail);

/* Returns whether the instance leaves or enters shadows or reflections, which must then treat it as
 * moved. */
int masu_looks_set(masu_looks *s, const masu_frame_plan *plan, uint32_t instance,
                   const masu_look *look);

/* Writes the looks that have changed to the slot. */
void masu_looks_write(masu_looks *s, const masu_frame_data *f);

/* The same values in the layout of the shaders: tint and emission, then texture coordinates. */
void masu_look_rows(const masu_look *look, float rows[8]);

static inline int masu_look_fades(const masu_looks *s, uint32_t instance) {
    return s->now && s->now[instance].fade > 0.0f;
}

/* Whether the look removes an instance: from the camera's image in a viewport, from shadows, from
 * reflections, from the picking of a frame. */
static inline int masu_look_unseen(const masu_looks *s, uint32_t instance, uint32_t viewport) {
    if (!s->now) return 0;
    return s->now[instance].fade >= 1.0f || (s->now[instance].hidden_views >> viewport & 1u);
}
static inline int masu_look_shadowless(const masu_looks *s, uint32_t instance) {
    if (!s->now) return 0;
    return s->now[instance].fade >= 1.0f || (s->now[instance].flags & MASU_LOOK_NO_SHADOW);
}
static inline int masu_look_untraced(const masu_looks *s, uint32_t instance) {
    if (!s->now) return 0;
    return s->now[instance].fade >= 1.0f || (s->now[instance].flags & MASU_LOOK_NOT_TRACED);
}
static inline int masu_look_unpicked(const masu_looks *s, uint32_t instance, uint32_t mask) {
    if (!s->now) return 0;
    uint32_t own = s->now[instance].pick_mask ? s->now[instance].pick_mask : UINT32_MAX;
    return (s->now[instance].flags & MASU_LOOK_NOT_PICKED) || !(own & (mask ? mask : UINT32_MAX));
}

#endif
