/* punctual_lights.h: local lights (point, spot and area lights) between the scene and the shaders.
 *
 * The host keeps each light as the scene or masu_punctual_light_set has it. Every frame it
 * transforms the lights, culls those that light nothing in the image, and writes the others, in
 * the scene's order, to the frame's slot of MASU_BUFFER_LIGHTS: a masu_light_header and the
 * array of masu_punctual_light_data, relative to the camera. light_tiles.comp sorts them into
 * tiles from there. */
#ifndef MASU_PUNCTUAL_LIGHTS_H
#define MASU_PUNCTUAL_LIGHTS_H

#include "frame/instances.h"
#include "frame/local_shadows.h"

typedef struct masu_lights {
    /* [plan->scene.lights]. The carrying instance is stored as 1 + its index, not as its handle;
     * 0: none. */
    masu_punctual_light_state *states;
    uint64_t *names;                      /* FNV-1a 64 of the name, 0: none */
    uint32_t slot_count[MASU_MAX_FLIGHT]; /* in view */
    uint32_t changes;                     /* how often one was set, or its shadow has changed */
    int any_areas, any_surfaces;          /* needs.area_lights, needs.shared_lights */
    uint32_t *lives;                      /* of the reserve */
    masu_handles handles;
} masu_lights;

void masu_lights_alloc(masu_lights *l, masu_arena *arena, const masu_frame_plan *plan);
void masu_lights_copy_scene(masu_lights *l, const masu_frame_plan *plan, const masu_scene_view *v);

/* masu_punctual_light_find, _get and _set of the public header. */
/* UINT32_MAX: there is none. */
uint32_t masu_lights_find(const masu_lights *l, const masu_frame_plan *plan, const char *name);
masu_punctual_light_state masu_lights_get(const masu_lights *l, const masu_instances *in,
                                          uint32_t light);
masu_result masu_lights_set(masu_lights *l, const masu_instances *in, uint32_t light,
                            const masu_punctual_light_state *state, masu_detail *detail);

/* One of the reserve is taken, or given back. MASU_ERROR_LIMIT: all are taken. */
masu_result masu_lights_add(masu_lights *l, const masu_instances *in,
                            const masu_punctual_light_state *state, uint32_t *light,
                            masu_detail *detail);
void masu_lights_remove(masu_lights *l, uint32_t light);

/* Writes the lights that may light something visible to the slot; after the camera. */
void masu_lights_write(masu_lights *l, const masu_instances *in, const masu_local_shadows *shadows,
                       const masu_frame_data *f);

/* Finds the lights that may cast shadows in this frame, and lets masu_local_shadows_write do the
 * rest. After the camera, before masu_temporal_read. */
void masu_lights_cast(masu_lights *l, masu_local_shadows *shadows, const masu_instances *in,
                      const masu_bounds *bounds, masu_frame_data *f);

#endif
