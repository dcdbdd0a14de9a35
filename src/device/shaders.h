/* shaders.h: the SPIR-V of a pass: the library's own, in the permutation that a plan asks for, or the scene's.
 *
 * Which shaders there are, over which axes they are compiled, and their code follow from the rows of
 * src/plan/passes.inc and axes.inc (shaders/tables.sh writes permutations.h). Nothing here fails. The library's are packed
 * (unpack.h): masu_code_read unpacks them. */
#ifndef MASU_SHADERS_H
#define MASU_SHADERS_H

#include "bindings.h"
#include "device/unpack.h"
#include "plan/plan.h"

typedef struct masu_code {
    const uint32_t *words; /* of the scene */
    masu_packed packed;    /* where words is NULL */
    uint64_t bytes;        /* 0: none */
    int left_out;          /* one is needed that the library does not have */
} masu_code;

/* The two stages of a draw; of depth alone the second is none. */
typedef struct masu_draw_code {
    masu_code vertex, fragment;
} masu_draw_code;

/* Of a compute pass; last: for rungs in which it writes what is shown. */
masu_code masu_compute_code(const masu_frame_plan *plan, uint32_t pass, int last);

/* Of a graphics pass; textured: for what has textures. */
masu_draw_code masu_draw_code_of(const masu_frame_plan *plan, uint32_t pass, int textured);

/* What it declares; of no code nothing. */
masu_interface masu_code_interface(const masu_code *code);

/* The bindings of set 0 that a pass has: those that its shaders declare, of buffers that the plan
 * has. */
uint32_t masu_global_bindings(const masu_frame_plan *plan, uint32_t pass,
                              VkDescriptorSetLayoutBinding out[MASU_BIND_COUNT]);

/* Most storage buffers that a stage of a pass binds (all are in set 0), and bit n of *groups for
 * each masu_binding_group n that it binds one of. */
uint32_t masu_storage_buffers(const masu_frame_plan *plan, uint32_t pass, uint32_t *groups);

/* The words of a code that there is; room: for one that is packed, masu_code_room(plan) bytes. */
const uint32_t *masu_code_read(const masu_code *code, uint32_t *room);

/* MASU_ERROR_LIMIT: the plan needs a shader that was left out of the library (make CLASSES=...). */
masu_result masu_code_check(const masu_frame_plan *plan, masu_detail *detail);

/* Bytes of the largest packed code that the plan's pipelines are made of. */
uint64_t masu_code_room(const masu_frame_plan *plan);

#endif
