/* temporal.h: what a rung with `temporal`, or with temporal accumulation of reflections, knows of
 * the frames before: where in its pixels each looks, what the previous one has left, whether
 * anything but the camera has changed since. Host state of a few words; nothing here fails. */
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
    uint32_t changed; /* frames for which what has changed may still be found */
    uint32_t rung;    /* and this rung */
    uint32_t lights, instances, materials, post; /* changes of them that it knew of */
    uint64_t sprites; /* hash of its particles, trails and decals */
} masu_temporal;

/* By how much beside the middle of its pixels a frame looks, in pixels of the render size, -0.5 to 0.5: Halton's sequence of
 * bases 2 and 3, of as many places as put 16 samples into each pixel of the output. */
void masu_temporal_place(VkExtent2D render, VkExtent2D shown, uint64_t frame, float place[2]);

/* The same of this frame. Returns the most that it is in any; of a rung without, all is 0. */
float masu_temporal_jitter(const masu_frame_data *f, float jitter[2]);

/* The history of a frame into its uniforms, which are whole but for that. */
void masu_temporal_read(masu_temporal *t, const masu_history *history, const masu_instances *in,
                        const masu_lights *lights, const masu_materials *materials,
                        const masu_textures *textures, const masu_post_state *post,
                        masu_frame_data *f);

#endif
