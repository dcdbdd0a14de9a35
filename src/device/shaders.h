/* shaders.h: returns the SPIR-V of a pass: the library's, in the permutation that a plan needs, or
 * the scene's.
 *
 * The list of shaders, their axes and their code follow from src/plan/passes.inc and axes.inc
 * (shaders/tables.sh writes permutations.h). Only masu_code_check can fail. The library's code is
 * packed (unpack.h); masu_code_read unpacks it. */
#ifndef MASU_SHADERS_H
#define MASU_SHADERS_H

#include "bindings.h"
#include "device/unpack.h"
#include "plan/plan.h"

typedef struct masu_code {
    const uint32_t *words; /* code of the scene, else NULL */
    masu_packed packed;    /* if words is NULL */
    uint64_t bytes;        /* of the SPIR-V; 0: no code */
    int left_out;          /* the library was built without this shader */
} masu_code;

/* The two stages of a draw. Depth-only draws have no fragment shader. */
typedef struct masu_draw_code {
    masu_code vertex, fragment;
} masu_draw_code;

/* Code of a compute pass. last: for rungs in which the pass writes the final image. */
masu_code masu_compute_code(const masu_frame_plan *plan, uint32_t pass, int last);

/* Code of a graphics pass. textured: for materials with textures. */
masu_draw_code masu_draw_code_of(const masu_frame_plan *plan, uint32_t pass, int textured);

/* The interface that the code declares; empty without code. */
masu_interface masu_code_interface(const masu_code *code);

/* Layout bindings of set 0 of a pass: those that its shaders declare and whose buffers the plan
 * has; the counters only with desc.debug.counters, if the pass has another storage buffer. Returns
 * their number. */
uint32_t masu_global_bindings(const masu_frame_plan *plan, uint32_t pass,
                              VkDescriptorSetLayoutBinding out[MASU_BIND_COUNT]);

#define MASU_MAP_COUNT (MASU_SLOT_COUNT + 1u) /* bindings of set 2 */

/* Whether the pass draws polygons, with their textures in set 2. */
int masu_draws_polygons(uint32_t pass);

/* The descriptors in a pass's layouts: for each kind, the largest number in one stage. Every
 * sampled image has a sampler. */
typedef struct masu_stage_needs {
    uint32_t uniform_buffers, storage_buffers; /* in set 0 */
    uint32_t sampled_images;                   /* in sets 1 and 2 */
    uint32_t storage_images;
    uint32_t attachments; /* for colour */
    uint32_t groups;      /* bit n: the pass binds a buffer of masu_binding_group n */
} masu_stage_needs;

masu_stage_needs masu_stage_needs_of(const masu_frame_plan *plan, uint32_t pass);

/* The SPIR-V of a code for the layout of a pass. Code that is packed or adapted to the layout is
 * written to `room`, which has masu_code_room(plan) bytes. NULL if it cannot be unpacked. */
const uint32_t *masu_code_read(const masu_frame_plan *plan, uint32_t pass, const masu_code *code,
                               uint32_t *room);

/* MASU_ERROR_LIMIT: the plan needs a shader that the library was built without (make
 * CLASSES=...). */
masu_result masu_code_check(const masu_frame_plan *plan, masu_detail *detail);

/* Size, in bytes, of the largest shader of the plan's pipelines. */
uint64_t masu_code_room(const masu_frame_plan *plan);

#endif
