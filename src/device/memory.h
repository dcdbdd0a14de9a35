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
 * Transient images share memory if their lifetimes (rows of the pass table) do not overlap. Optimal
 * placement is the dynamic storage allocation problem, which is NP-hard. With a few tens of images,
 * first fit in several orders is close to optimal; the plan prints the lower bound (the largest
 * live set) next to the result. Persistent images, whose content outlives the frame, share no
 * memory: histories, and the shadow map if some cascades are not rendered in every frame.
 *
 * Memory types are a preference list and never exclude a device: an integrated GPU has one type
 * with all properties. */
#ifndef MASU_DEVICE_MEMORY_H
#define MASU_DEVICE_MEMORY_H

#include "plan/plan.h"
#include "device/vk.h"

/* Role of the mapped block in which shaders are unpacked while nothing else uses the block. Without
 * unified memory this is the readback block, because the host reads it as fast as it writes. The
 * block has at least masu_code_room bytes, if necessary more than its resources need. */
static inline uint32_t masu_code_role(const masu_frame_plan *plan) {
    return plan->unified ? MASU_ROLE_DEVICE : MASU_ROLE_READBACK;
}

/* An item to place: `bytes` bytes, live from row `first` to row `last` inclusive. */
typedef struct masu_placement {
    uint64_t bytes, alignment;
    uint32_t first, last;
    uint64_t offset; /* result */
} masu_placement;

/* Places n (at most MASU_MAX_RESOURCES) items so that items with overlapping lifetimes do not
 * overlap in memory. Returns the size of the region; offsets are relative to its start.
 * Deterministic. */
uint64_t masu_place(masu_placement *items, uint32_t n);

/* Largest sum of live bytes in one row. No placement can be smaller. */
uint64_t masu_place_lower_bound(const masu_placement *items, uint32_t n);

/* The objects whose requirements determine the layout, created by the caller in plan order. Unused
 * handles may be null. */
typedef struct masu_objects {
    VkImage images[MASU_IMAGE_COUNT];
    VkBuffer buffers[MASU_BUFFER_COUNT];
} masu_objects;

/* Creates the images and buffers of the plan, without binding memory. On failure, the objects
 * created so far remain in `objects` for masu_objects_destroy. Also sets plan->unified, decides
 * whether a staging buffer is needed, and fills the memory part of the plan. */
masu_result masu_objects_create(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects,
                                masu_detail *detail);
void masu_objects_destroy(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects);

#endif
