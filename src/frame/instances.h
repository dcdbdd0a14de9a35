/* instances.h: where instances are: the host's truth, copied to a slot when it has changed. */
#ifndef MASU_INSTANCES_H
#define MASU_INSTANCES_H

#include "frame/frame_data.h"
#include "scene/view.h"

/* All by instance. */
typedef struct masu_instances {
    struct masu_instance_data *now;
    struct masu_instance_data *previous; /* of no length where nothing reads velocities */
    uint64_t *names;                     /* FNV-1a 64 of the name, 0: none */
    uint8_t *dirty;                      /* frames that still have to write the transform */
    uint32_t dirty_count;                /* instances of which that is not 0 */
    uint32_t changes;                    /* how often one was moved */
    uint32_t *meshes;
} masu_instances;

void masu_instances_lay(masu_instances *in, masu_arena *arena, const masu_frame_plan *plan);
void masu_instances_keep(masu_instances *in, const masu_frame_plan *plan, const masu_scene_view *v);

/* masu_instance_find and masu_instance_set_transform of the public header. */
masu_instance masu_instances_find(const masu_instances *in, const masu_frame_plan *plan,
                                  const char *name);
masu_result masu_instances_set(masu_instances *in, const masu_frame_plan *plan,
                               masu_instance instance, const float rows[12], masu_detail *detail);

void masu_instance_rows(const struct masu_instance_data *at, float rows[12]);

/* Those that are dirty to the slot, and one frame less dirty: what else depends on that comes before. */
void masu_instances_write(masu_instances *in, const masu_frame_data *f);

#endif
