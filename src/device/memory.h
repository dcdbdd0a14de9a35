/* memory.h: the layout of device memory.
 *
 *   device     | vertices | indices | ... | persistent images | transient images, aliased |
 *   upload     | frame slot 0 | frame slot 1 | ... |
 *   readback   | frame slot 0 | frame slot 1 | ... |
 *
 * On unified memory the three roles follow one another in ONE block. Sizes and alignments are those
 * that the driver reports for the real images (vkGetImageMemoryRequirements), never width * height
 * * bytes: drivers pad and tile.
 *
 * Transient images share memory if their lifetimes (rows of the pass table) do not overlap. Placing
 * them optimally is dynamic storage allocation, which is NP-hard. With a few tens of images, first
 * fit in several orders comes close; the plan prints the lower bound (the largest set alive at
 * once) next to the result. Persistent images, whose content outlives the frame, share nothing:
 * histories, and the shadow map if some cascades are not rendered in every frame.
 *
 * Memory types are a preference list, never an exclusion: an integrated GPU has one type with all
 * properties. */
#ifndef MASU_DEVICE_MEMORY_H
#define MASU_DEVICE_MEMORY_H

#include "plan/plan.h"
#include "device/vk.h"

/* The block in which shaders are unpacked, before anything else is in it: mapped, and best one that the host
 * reads as fast as it writes. It has masu_code_room bytes, if need be more than the rest asks for. */
static inline uint32_t masu_code_role(const masu_frame_plan *plan) {
    return plan->unified ? MASU_ROLE_DEVICE : MASU_ROLE_READBACK;
}

/* One thing to place: `bytes` alive from row `first` to row `last`, both included. */
typedef struct masu_placement {
    uint64_t bytes, alignment;
    uint32_t first, last;
    uint64_t offset; /* out */
} masu_placement;

/* Places n (at most MASU_MAX_RESOURCES) items so that no two that are alive together overlap.
 * Returns the end of the region, offsets are relative to its start. Deterministic. */
uint64_t masu_place(masu_placement *items, uint32_t n);

/* Largest sum of bytes alive in one row: no placement can be smaller. */
uint64_t masu_place_lower_bound(const masu_placement *items, uint32_t n);

/* Objects whose requirements decide the layout; created by the caller, in plan order; handles may
 * be null where unused. */
typedef struct masu_objects {
    VkImage images[MASU_IMAGE_COUNT];
    VkBuffer buffers[MASU_BUFFER_COUNT];
} masu_objects;

/* Creates the images and buffers that the plan uses (not yet bound). On failure what was created
 * stays in `objects` for masu_objects_destroy. Also decides plan->unified and whether a staging
 * buffer is needed, and fills the memory part of the plan. */
masu_result masu_objects_create(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects,
                                masu_detail *detail);
void masu_objects_destroy(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects);

#endif
