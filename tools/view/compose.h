/* compose.h: copies the images of one or two stages to the swapchain image: a small compute pass,
 * the user interface on top, and a blit, in the viewer's own command buffers.
 *
 *   A.target, B.target, map --compose.comp--> shown --ui.h--> shown --blit--> swapchain image
 *
 * The commands run after the library's commands on the same queue. Between frames the targets and
 * `shown` are in TRANSFER_SRC_OPTIMAL, as masu_headless_target_read requires for screenshots and
 * for the difference. */
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

/* The contents of the window. */
typedef struct masu_composition {
    const masu_headless_target *a, *b; /* a NULL: no image yet; b NULL: only A */
    uint32_t split;                    /* first column of B, pixels from the left */
    bool map;                          /* show the difference instead of both */
} masu_composition;

/* open creates the objects of a device, resize those that depend on the output size. The device
 * must be idle for resize. */
bool masu_compose_open(masu_compose *c, masu_headless *host, VkPipelineCache cache, char *error,
                       size_t size);
bool masu_compose_resize(masu_compose *c, VkExtent2D output, char *error, size_t size);
void masu_compose_close(masu_compose *c);

/* Records the slot's commands, including the user interface of this frame. Submit them after the
 * commands that draw A and B. */
bool masu_compose_record(masu_compose *c, uint32_t slot, const masu_composition *what,
                         VkImage image, VkExtent2D extent, char *error, size_t size);

#endif
