/* recorder.h: the state of one recording, shared by record.c and the other files that write to its
 * command buffer. */
#ifndef MASU_RECORDER_H
#define MASU_RECORDER_H

#include "device/device.h"

/* The last use of an image or buffer in the frame. */
typedef struct masu_use {
    int used; /* whether used in this frame yet */
    VkPipelineStageFlags stages;
    VkAccessFlags access; /* accesses of the last use; its writes must be made available */
    VkImageLayout layout;
    int writes;
} masu_use;

typedef struct masu_recorder {
    masu_device *m;
    const masu_draws *draws;
    VkCommandBuffer *parts; /* plan->parts command buffers */
    VkCommandBuffer cmd;    /* the current part */
    uint32_t flight, viewport, rung, target, variant;
    masu_rung_plan *rp;
    masu_use states[MASU_RESOURCE_END]; /* images, then the buffers of the pass table */
    uint8_t written[MASU_RESOURCE_END]; /* buffers: written by a pass of this frame */
    uint32_t barriers;
} masu_recorder;

#endif
