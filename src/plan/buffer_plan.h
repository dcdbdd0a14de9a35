/* buffer_plan.h: sizes of the buffers of buffers.inc for a plan, and the bindings of descriptor set
 * 0. Pure functions. */
#ifndef MASU_BUFFER_PLAN_H
#define MASU_BUFFER_PLAN_H

#include "plan/plan.h"

/* Fills plan->buffers and all offsets in buffers. The rest of the plan must be complete. */
void masu_size_buffers(masu_frame_plan *plan, uint64_t uniform_alignment,
                       uint64_t storage_alignment);

/* Feature that a rung drops if a shader stage has too few storage buffers. */
typedef enum masu_binding_group {
    MASU_BINDING_PLAIN,
    MASU_BINDING_CULLING,
    MASU_BINDING_TRACING,
    MASU_BINDING_BOUNCING
} masu_binding_group;

/* A binding of descriptor set 0. */
typedef struct masu_binding {
    uint32_t binding; /* MASU_BIND_* */
    masu_buffer_id buffer;
    VkDescriptorType type;
    VkShaderStageFlags stages;
    uint64_t range; /* size in bytes: of a slot, or of half a slot */
    masu_binding_group group;
    int bound;    /* whether the plan's layout has it */
    int previous; /* whether it is the previous frame's half of a slot */
} masu_binding;

/* Writes all bindings, in the order of the rows; `out` has room for MASU_BIND_COUNT. */
void masu_bindings(const masu_frame_plan *plan, masu_binding out[]);

/* Maximum length, over all rungs, of the tile lists of indirect dispatches: SDF, reflections,
 * SMAA. */
uint64_t masu_most_tiles(const masu_frame_plan *plan);

/* Maximum number of live probes that trace rays in a frame of a rung. */
uint32_t masu_bounce_most(const masu_frame_plan *plan, uint32_t rung);

typedef struct masu_buffer_row {
    const char *name;
    masu_role role;
    int loaded;     /* masu_load writes it */
    int of_loading; /* only masu_load uses it */
    int halved;     /* with velocities, a slot has a half for the previous frame */
} masu_buffer_row;

extern const masu_buffer_row masu_buffers[MASU_BUFFER_COUNT];

#endif
