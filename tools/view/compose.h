/* compose.h: from the pictures of one or two stages to the swapchain's image: one small compute pass of the host's own,
 * the user interface over it, and a blit, in command buffers of the host's own.
 *
 *   A.target, B.target, map --compose.comp--> shown --ui.h--> shown --blit--> swapchain image
 *
 * It runs behind the library's commands on the same queue. Between frames the targets and `shown` are in
 * TRANSFER_SRC_OPTIMAL, as masu_headless_target_read wants them: that is how screenshots and the
 * difference come to the host. */
#ifndef MASU_VIEW_COMPOSE_H
#define MASU_VIEW_COMPOSE_H

#include "view/window.h"

typedef struct masu_compose {
    masu_headless *host; /* NULL: closed */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkDescriptorSet sets[MASU_WINDOW_FLIGHT];
    VkCommandBuffer commands[MASU_WINDOW_FLIGHT];
    masu_headless_buffer map;
    masu_headless_target shown;
} masu_compose;

/* What there is to show. */
typedef struct masu_composition {
    const masu_headless_target *a, *b; /* a NULL: no picture yet; b NULL: all is A */
    uint32_t split;                    /* where B begins, pixels from the left */
    bool map;                          /* the difference instead of both */
} masu_composition;

/* What a device needs once; then what a size needs, whenever it changes (the device is idle). */
bool masu_compose_open(masu_compose *c, masu_headless *host, VkPipelineCache cache, char *error,
                       size_t size);
bool masu_compose_resize(masu_compose *c, VkExtent2D output, char *error, size_t size);
void masu_compose_close(masu_compose *c);

/* Records the slot's commands, with the user interface of this frame; to be submitted behind those that
 * draw A and B. */
bool masu_compose_record(masu_compose *c, uint32_t slot, const masu_composition *what, VkImage image,
                         VkExtent2D extent, char *error, size_t size);

#endif
