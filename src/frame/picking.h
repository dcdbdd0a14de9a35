/* picking.h: finds the instance at a pixel that the host queries: chooses the instances that are
 * drawn again for it, and keeps the frame's data for the result.
 *
 * The recordings draw every primitive of every LOD of a mesh a second time, indirectly, for 2x2
 * pixels (shaders/pick.vert). Separate draw commands and lists select the instances: those of
 * the camera's view, in the same LODs, whose box is near the pixel. A frame without a query
 * executes empty commands only. Rejected alternative: an image of instance ids next to the
 * G-buffer: 4 bytes a pixel written in every frame, for one that is read. */
#ifndef MASU_PICKING_H
#define MASU_PICKING_H

#include "frame/visible.h"

typedef struct masu_picking_slot {
    int asked;
    uint32_t x, y; /* the queried pixel */
    double eye[3];
} masu_picking_slot;

typedef struct masu_picking {
    uint64_t *added; /* [model of the reserve]: the first frame of the one in the slot */
    uint8_t *group_states; /* [group], of masu_cull */
    masu_picking_slot slots[MASU_MAX_FLIGHT];
} masu_picking;

void masu_picking_alloc(masu_picking *p, masu_arena *arena, const masu_frame_plan *plan);
/* Writes the constant part of the draw commands to all slots. */
void masu_picking_write_scene(const masu_device *device, const masu_draws *draws,
                              const masu_scene_view *v);

/* Checks a frame's query and writes the pixel at its render size into the uniforms. */
masu_result masu_picking_read(masu_frame_data *f, masu_detail *detail);
/* After masu_visible_write. */
void masu_picking_write(masu_picking *p, masu_visible *visible, const masu_bounds *bounds,
                        const masu_instances *in, const masu_frame_data *f);

#endif
