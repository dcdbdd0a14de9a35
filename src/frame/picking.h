/* picking.h: the pixel of which the host asks what it shows: which instances are drawn once more for it, and what of
 * the frame has to be known when the answer is read.
 *
 * The recordings draw every primitive of every form of a mesh a second time, indirectly, for 2x2 pixels
 * (shaders/pick.vert). Draw commands and lists of their own say which instances: of those that the camera's view has kept,
 * in the same forms, the ones whose box is near the pixel. In a frame in which nothing is asked that is none, and such
 * a frame draws nothing more than empty commands. Wrong turn: an image of numbers beside the G-buffer: 4 bytes a pixel
 * written in every frame, for one that is read. */
#ifndef MASU_PICKING_H
#define MASU_PICKING_H

#include "frame/visible.h"

typedef struct masu_picking_slot {
    int asked;
    uint32_t x, y; /* as the host has asked */
    double eye[3];
} masu_picking_slot;

typedef struct masu_picking {
    uint64_t *added; /* [model of the reserve]: the first frame of the one in the slot */
    uint8_t *group_states; /* [group], of masu_cull */
    masu_picking_slot slots[MASU_MAX_FLIGHT];
} masu_picking;

void masu_picking_alloc(masu_picking *p, masu_arena *arena, const masu_frame_plan *plan);
/* What does not change of the draw commands, to all slots. */
void masu_picking_write_scene(const masu_device *device, const masu_draws *draws,
                              const masu_scene_view *v);

/* Checks what a frame asks for; the pixel of its render size into the uniforms. */
masu_result masu_picking_read(masu_frame_data *f, masu_detail *detail);
/* After masu_visible_write. */
void masu_picking_write(masu_picking *p, masu_visible *visible, const masu_bounds *bounds,
                        const masu_instances *in, const masu_frame_data *f);

#endif
