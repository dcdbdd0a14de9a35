/* compose.h: from the pictures of one or two stages and the overlay to the swapchain's image: one small
 * compute pass of the host's own, and a blit, in command buffers of the host's own.
 *
 *   A.target, B.target, overlay, map --compose.comp--> shown --blit--> swapchain image
 *
 * It runs behind the library's commands on the same queue. Between frames the targets and `shown` are in
 * TRANSFER_SRC_OPTIMAL, as masu_headless_target_read wants them: that is how screenshots and the
 * difference come to the host. The overlay has a buffer for each frame in flight, written while the
 * other is read. */
#ifndef MASU_VIEW_COMPOSE_H
#define MASU_VIEW_COMPOSE_H

#include "view/canvas.h"
#include "view/window.h"

typedef struct masu_compose {
    masu_headless *host; /* NULL: closed */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkDescriptorSet sets[MASU_WINDOW_FLIGHT];
    VkCommandBuffer commands[MASU_WINDOW_FLIGHT];
    masu_headless_buffer overlay[MASU_WINDOW_FLIGHT], map;
    masu_headless_target shown;
    int top[MASU_WINDOW_FLIGHT], bottom[MASU_WINDOW_FLIGHT]; /* rows of each overlay in use */
} masu_compose;

/* What there is to show. */
typedef struct masu_composition {
    const masu_headless_target *a, *b; /* b NULL: all is A */
    uint32_t split;                    /* where B begins, pixels from the left */
    bool map;                          /* the difference instead of both */
} masu_composition;

/* What a device needs once; then what a size needs, whenever it changes (the device is idle). */
bool masu_compose_open(masu_compose *c, masu_headless *host, VkPipelineCache cache, char *error,
                       size_t size);
bool masu_compose_resize(masu_compose *c, VkExtent2D output, char *error, size_t size);
void masu_compose_close(masu_compose *c);

/* Hands the canvas to the slot, whose last frame is finished. */
void masu_compose_overlay(masu_compose *c, uint32_t slot, const masu_canvas *canvas);
/* Records the slot's commands; to be submitted behind those that draw A and B. */
bool masu_compose_record(masu_compose *c, uint32_t slot, const masu_composition *what, VkImage image,
                         VkExtent2D extent, char *error, size_t size);

#endif
