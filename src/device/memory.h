/* memory.h: the device block.
 *
 *   role device                                                     role upload           role
 *   readback | vertices | indices | ... | transient images, sharing bytes |  | frame | instances |
 *   | slot 0 | slot 1 |
 *
 * On unified memory the three follow one another in ONE block. Sizes and alignments come from the
 * driver (vkGetImageMemoryRequirements on the real images), never from width * height * bytes:
 * drivers pad and tile.
 *
 * Transient images share bytes when their lifetimes (rows of the frame table) do not meet. Placing
 * them is dynamic storage allocation, which is NP-hard; a few tens of images and first fit over
 * several orders come close, and the lower bound (largest set alive at once) is printed beside the
 * result.
 *
 * An image whose content outlives the frame (histories; the shadow map, where not every cascade is drawn in
 * every frame) stands in front of them and shares nothing.
 *
 * Memory types are a preference list, never an exclusion: an integrated GPU has one type that is
 * everything at once. */
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
