/* recorder.h: what one recording is made of. record.c makes one, and everything that writes to its
 * command buffer takes it. */
#ifndef MASU_RECORDER_H
#define MASU_RECORDER_H

#include "device/device.h"

/* How an image or a buffer was used last in the frame. */
typedef struct masu_use {
    int used; /* in this frame */
    VkPipelineStageFlags stages;
    VkAccessFlags access; /* what the last use did; writes are what must be made available */
    VkImageLayout layout;
    int writes;
} masu_use;

typedef struct masu_recorder {
    masu_device *m;
    const masu_draws *draws;
    VkCommandBuffer *parts; /* of this recording; plan->parts of them */
    VkCommandBuffer cmd;    /* the part at hand */
    uint32_t flight, viewport, rung, target, variant;
    masu_rung_plan *rp;
    masu_use states[MASU_RESOURCE_END]; /* images, then the buffers that rows name */
    uint8_t written[MASU_RESOURCE_END]; /* by a pass of this frame; of buffers */
    uint32_t barriers;
} masu_recorder;

#endif
