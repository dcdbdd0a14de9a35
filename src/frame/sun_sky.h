/* sun_sky.h: sun, sky and fog of a frame: checks the host's or the scene's values, and derives
 * light from an analytic sky. */
#ifndef MASU_SUN_SKY_H
#define MASU_SUN_SKY_H

#include "frame/frame_data.h"
#include "frame/sky.h"
#include "scene/blob_section.h"

typedef struct masu_sun_sky {
    masu_blob_environment environment;
    float environment_sh[9][4]; /* of an environment map: masu_blob_environment_map.sh */
    masu_sky *sky;                          /* of no length where the plan has no analytic sky */
    uint64_t slot_updates[MASU_MAX_FLIGHT]; /* sky->sun_updates that the slot has; 0: a gradient */
} masu_sun_sky;

void masu_sun_sky_alloc(masu_sun_sky *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_sun_sky_copy_scene(masu_sun_sky *s, const masu_scene_view *v);
/* The scene's. */
masu_light masu_sun_sky_light(const masu_sun_sky *s);

/* Checks the light of a frame, after its camera, and writes the uniforms that do not depend on
 * an analytic sky. */
masu_result masu_sun_sky_read(const masu_sun_sky *s, masu_frame_data *f, masu_detail *detail);
/* The frame's analytic sky, or that it has none, to the slot; its light into the uniforms. */
void masu_sun_sky_write(masu_sun_sky *s, masu_frame_data *f);

#endif
