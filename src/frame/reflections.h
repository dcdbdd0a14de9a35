/* reflections.h: what a frame says of traced reflections: where traced instances are, as
 * src/scene/trace_scene.h lays it, and which history the filters find. */
#ifndef MASU_REFLECTIONS_H
#define MASU_REFLECTIONS_H

#include "frame/bounds.h"
#include "frame/instances.h"
#include "scene/trace.h"

typedef struct masu_reflections {
    masu_trace_top tree; /* over instances, in tree_memory; with ray queries the device has one */
    void *tree_memory;
    uint32_t *traced; /* [traced instance]: instance; MASU_BLOB_NONE: none, in a place of the reserve */
    uint8_t *bends;   /* [traced instance]: its box changes: a skin, a mesh of the host; NULL without both */
    uint8_t *live;    /* of ray queries, [traced instance]: it is not left out */
    double origin[3]; /* that the frame measures traced things from */
    double previous_origin[3];
    uint64_t versions;                      /* so many times something has changed */
    uint64_t slot_version[MASU_MAX_FLIGHT]; /* as of which the slot is */
    uint32_t looks;                         /* changes of looks, as of the last frame */
    int history;                            /* the previous frame has kept what it traced, */
    uint32_t history_size[2];               /* at this render size; */
    int full_history;                       /* and a history of full resolution */
} masu_reflections;

void masu_reflections_alloc(masu_reflections *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_reflections_copy_scene(masu_reflections *s, const masu_frame_plan *plan,
                                 const masu_scene_view *v);

/* Into a place of the reserve: a traced instance as another is traced, and away again. */
void masu_reflections_copy(masu_reflections *s, const masu_frame_plan *plan, uint32_t place,
                           uint32_t from, uint32_t to);
void masu_reflections_clear(masu_reflections *s, const masu_frame_plan *plan, uint32_t place);

/* A slot of desc.reserve.meshes gets a mesh, whose BVH has its root at `node`; or is free again. */
void masu_reflections_set_mesh(masu_reflections *s, const masu_frame_plan *plan, uint32_t slot,
                               uint32_t instance, uint32_t node);
void masu_reflections_clear_mesh(masu_reflections *s, const masu_frame_plan *plan, uint32_t slot);

/* Origin and history of a frame into the uniforms; after its camera. */
void masu_reflections_read(masu_reflections *s, masu_frame_data *f);
/* Traced instances to the slot; after the origin, and before masu_instances_write, which forgets what has
 * moved and where it was. */
void masu_reflections_write_instances(masu_reflections *s, const masu_instances *in,
                                      const masu_bounds *b, const masu_frame_data *f);

#endif
