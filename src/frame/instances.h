/* instances.h: transforms of instances. The host's copy is authoritative; changes are copied to
 * each slot. */
#ifndef MASU_INSTANCES_H
#define MASU_INSTANCES_H

#include "frame/frame_data.h"
#include "frame/handles.h"
#include "frame/looks.h"
#include "scene/blob_section.h"

enum {
    MASU_INSTANCE_HIDDEN = 0x80,
    MASU_INSTANCE_COMES = 0x40, /* it has been shown since the last frame: it was nowhere before */
    MASU_INSTANCE_DIRTY = 0x3F
};

/* All by instance. */
typedef struct masu_instances {
    struct masu_instance_data *now;
    struct masu_instance_data *previous; /* of no length where nothing reads velocities */
    uint64_t *names;                     /* FNV-1a 64 of the name, 0: none */
    uint8_t *flags;                      /* MASU_INSTANCE_*, and how many frames still write it */
    uint32_t dirty_count;                /* instances that some do */
    uint32_t hidden_count;
    uint32_t changes; /* how often one was moved, shown or hidden */
    uint32_t *meshes;
    /* Instances of the reserve, which are not in the blob, as one list per mesh. Empty without a
     * reserve. */
    uint32_t *of_mesh; /* [mesh]: the first, or MASU_BLOB_NONE */
    uint32_t *next;    /* [instance of the reserve]: the next of the same mesh */
    uint32_t *lives;
    uint32_t own; /* instances of the blob; the reserve's come behind */
    masu_handles handles;
    /* With desc.double_positions: what rounding to float leaves of translations; else NULL. */
    float (*low)[3], (*previous_low)[3];
    masu_looks looks;
    double slot_origin[MASU_MAX_FLIGHT][3]; /* that translations in the slot are relative to */
} masu_instances;

void masu_instances_alloc(masu_instances *in, masu_arena *arena, const masu_frame_plan *plan);
void masu_instances_copy_scene(masu_instances *in, const masu_frame_plan *plan,
                               const masu_scene_view *v);

static inline int masu_instance_dirty(const masu_instances *in, uint32_t instance) {
    return in->flags[instance] & MASU_INSTANCE_DIRTY;
}
static inline int masu_instance_hidden(const masu_instances *in, uint32_t instance) {
    return in->flags[instance] & MASU_INSTANCE_HIDDEN;
}

/* Whether the instance was moved, deformed, shown or hidden since the last frame; call before
 * masu_instances_write. */
int masu_instance_moved(const masu_instances *in, const masu_frame_plan *plan, uint32_t instance);

/* masu_instance_set_look of the public header, of a look that masu_looks_check has accepted. */
void masu_instances_set_look(masu_instances *in, const masu_frame_plan *plan, uint32_t instance,
                             const masu_look *look);

/* The rows are finite. */
void masu_instances_place(masu_instances *in, const masu_frame_plan *plan, uint32_t instance,
                          const float rows[12]);
/* With desc.double_positions: the translation of the rows plus `offset`. */
void masu_instances_place_at(masu_instances *in, const masu_frame_plan *plan, uint32_t instance,
                             const float rows[12], const double offset[3]);
/* The transform is unchanged, but a skin has deformed the mesh. */
void masu_instances_touch(masu_instances *in, const masu_frame_plan *plan, uint32_t instance);
/* Hidden instances are in no view and no reflection, and their lights are off. */
void masu_instances_show(masu_instances *in, const masu_frame_plan *plan, uint32_t instance,
                         int shown);

/* masu_instance_find and masu_instance_set_transform of the public header. */
/* UINT32_MAX: there is none. */
uint32_t masu_instances_find(const masu_instances *in, const masu_frame_plan *plan,
                             const char *name);
masu_result masu_instances_set(masu_instances *in, const masu_frame_plan *plan, uint32_t instance,
                               const float rows[12], masu_detail *detail);

/* MASU_ERROR_STATE without desc.double_positions, MASU_ERROR_ARGUMENT if out of range. */
masu_result masu_position_check(const masu_frame_plan *plan, const double position[3],
                                masu_detail *detail);

/* One of the reserve becomes one of a mesh, hidden as yet, or is none any more. */
void masu_instances_add(masu_instances *in, uint32_t instance, uint32_t mesh);
void masu_instances_remove(masu_instances *in, const masu_frame_plan *plan, uint32_t instance);
/* Those of a mesh, one after the other, until MASU_BLOB_NONE. */
static inline uint32_t masu_instances_added(const masu_instances *in, uint32_t mesh) {
    return in->of_mesh ? in->of_mesh[mesh] : MASU_BLOB_NONE;
}
static inline uint32_t masu_instances_next(const masu_instances *in, uint32_t instance) {
    return in->next[instance - in->own];
}

void masu_instance_rows(const struct masu_instance_data *at, float rows[12]);
/* Its translation in world space. */
void masu_instance_position(const masu_instances *in, uint32_t instance, double position[3]);
/* Rows relative to an origin; low: what rounding has left of their translation, or NULL. */
void masu_instance_rows_from(const struct masu_instance_data *at, const float *low,
                             const double origin[3], float rows[12]);
/* Whether the slot's origin differs from the frame's, so that all instances must be written. */
int masu_instances_rebased(const masu_instances *in, const masu_frame_data *f);

/* Writes the dirty instances to the slot and decrements their dirty counts. Call after all
 * readers of the dirty state. */
void masu_instances_write(masu_instances *in, const masu_frame_data *f);

#endif
