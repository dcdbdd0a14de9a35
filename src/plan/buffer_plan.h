/* buffer_plan.h: what follows from the rows of buffers.inc for one plan: sizes, and the bindings of descriptor
 * set 0. Pure functions; nothing is kept. */
#ifndef MASU_BUFFER_PLAN_H
#define MASU_BUFFER_PLAN_H

#include "plan/plan.h"

/* Fills plan->buffers and all that says where things lie in them. Needs everything else of the plan. */
void masu_size_buffers(masu_frame_plan *plan, uint64_t uniform_alignment,
                       uint64_t storage_alignment);

/* What a rung goes without where a stage has too few storage buffers. */
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
    uint64_t range; /* bytes that it shows: of a slot, or of one of its halves */
    masu_binding_group group;
    int bound;    /* the plan's layout has it */
    int previous; /* it is of the half of a slot that is of the previous frame */
} masu_binding;

/* All of them, in the order of the rows; out has room for MASU_BIND_COUNT. */
void masu_bindings(const masu_frame_plan *plan, masu_binding out[]);

/* Over all rungs, the most tiles that a list may have of what is dispatched by lists: SDF, reflections, SMAA. */
uint64_t masu_most_tiles(const masu_frame_plan *plan);

/* The most probes of a live bounce that trace rays in a frame of a rung. */
uint32_t masu_bounce_most(const masu_frame_plan *plan, uint32_t rung);

typedef struct masu_buffer_row {
    const char *name;
    masu_role role;
    int loaded;     /* masu_load writes it */
    int of_loading; /* masu_load alone needs it */
    int halved;     /* where velocities are read, a slot has a half of the previous frame */
} masu_buffer_row;

extern const masu_buffer_row masu_buffers[MASU_BUFFER_COUNT];

#endif
