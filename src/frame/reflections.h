/* reflections.h: a frame's data of traced reflections: transforms of traced instances, in the
 * layout of src/scene/trace_scene.h, and the history that the filters use. */
#ifndef MASU_REFLECTIONS_H
#define MASU_REFLECTIONS_H

#include "frame/bounds.h"
#include "frame/instances.h"
#include "scene/trace.h"

typedef struct masu_reflections {
    masu_trace_top tree; /* over instances, in tree_memory; with ray queries the device has one */
    void *tree_memory;
    uint32_t *traced; /* [traced instance]: instance; MASU_BLOB_NONE: a free slot of the reserve */
    /* [traced instance]: its box changes: a skin, a mesh of the host; NULL without both */
    uint8_t *bends;
    uint8_t *live;    /* for ray queries, [traced instance]: it is traced */
    double origin[3]; /* that the frame measures traced things from */
    double previous_origin[3];
    uint64_t versions;                      /* number of changes */
    uint64_t slot_version[MASU_MAX_FLIGHT]; /* as of which the slot is */
    uint32_t looks;                         /* changes of looks, as of the last frame */
    int history;                            /* the previous frame has stored its traced samples, */
    uint32_t history_size[2];               /* at this render size; */
    int full_history;                       /* and a history of full resolution */
} masu_reflections;

void masu_reflections_alloc(masu_reflections *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_reflections_copy_scene(masu_reflections *s, const masu_frame_plan *plan,
                                 const masu_scene_view *v);

/* Copies a traced instance into a slot of the reserve, or removes it. */
void masu_reflections_copy(masu_reflections *s, const masu_frame_plan *plan, uint32_t place,
                           uint32_t from, uint32_t to);
void masu_reflections_clear(masu_reflections *s, const masu_frame_plan *plan, uint32_t place);

/* A slot of desc.reserve.meshes gets a mesh, whose BVH has its root at `node`; or is free again. */
void masu_reflections_set_mesh(masu_reflections *s, const masu_frame_plan *plan, uint32_t slot,
                               uint32_t instance, uint32_t node);
void masu_reflections_clear_mesh(masu_reflections *s, const masu_frame_plan *plan, uint32_t slot);

/* Origin and history of a frame into the uniforms; after its camera. */
void masu_reflections_read(masu_reflections *s, masu_frame_data *f);
/* Writes traced instances to the slot; after the origin, and before masu_instances_write, which
 * clears the dirty state and the previous transforms. */
void masu_reflections_write_instances(masu_reflections *s, const masu_instances *in,
                                      const masu_bounds *b, const masu_frame_data *f);

#endif
