/* temporal.h: history of a rung with `temporal`, or with temporal accumulation of reflections:
 * the jitter offset of each frame, whether the previous frame's history is valid, and whether
 * anything except the camera has changed since. A few integers of host state; nothing here
 * fails. */
#ifndef MASU_TEMPORAL_H
#define MASU_TEMPORAL_H

#include "frame/frame_data.h"
#include "frame/instances.h"
#include "frame/materials.h"
#include "frame/post.h"
#include "frame/punctual_lights.h"
#include "frame/textures.h"

typedef struct masu_temporal {
    int kept;         /* the previous frame has left a history, */
    uint32_t size[2]; /* of this render size */
    uint32_t changed; /* frames for which the history may still differ because of a change */
    uint32_t rung;    /* and this rung */
    uint32_t lights, instances, materials, post; /* change counters at the previous frame */
    uint64_t sprites; /* hash of its particles, trails and decals */
} masu_temporal;

/* Jitter offset of a frame from the pixel centres, in pixels of the render size, -0.5 to 0.5:
 * Halton's sequence of bases 2 and 3, with a period that puts 16 samples into each pixel of the
 * output. */
void masu_temporal_place(VkExtent2D render, VkExtent2D shown, uint64_t frame, float place[2]);

/* The same of this frame. Returns the most that it is in any; of a rung without, all is 0. */
float masu_temporal_jitter(const masu_frame_data *f, float jitter[2]);

/* Writes the frame's history into its uniforms, which are otherwise complete. */
void masu_temporal_read(masu_temporal *t, const masu_history *history, const masu_instances *in,
                        const masu_lights *lights, const masu_materials *materials,
                        const masu_textures *textures, const masu_post_state *post,
                        masu_frame_data *f);

#endif
