/* overlay.h: draws over the library's image, in its own command buffer after the
 * library's: text, as on a HUD, and a copy of the image for a file. */
#ifndef EXAMPLES_OVERLAY_H
#define EXAMPLES_OVERLAY_H

#include "window.h"

typedef struct overlay_line {
    int x, y, dot; /* pixels: upper left corner, size of a dot */
    char text[64]; /* '-' to 'Z' and spaces */
} overlay_line;

typedef struct overlay_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} overlay_buffer;

typedef struct overlay {
    window *window;
    overlay_buffer words[WINDOW_SLOTS], copy;
    bool blank;
} overlay;

/* Allocates all memory; nothing is allocated later. Safe to close after a failure. */
bool overlay_open(overlay *o, window *w);
void overlay_close(overlay *o);
/* Records w->commands[slot]: the lines that fit into the image, then the copy. The library leaves
 * the image in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL; afterwards it is ready to be presented. With
 * `blank` set the image has no contents yet, and is filled with dark gray first. */
bool overlay_record(overlay *o, uint32_t slot, uint32_t image, const overlay_line *lines, int count,
                    bool copy);
/* Waits, and writes the copy as a BMP of at most 2560x1440 pixels. */
bool overlay_save(overlay *o, const char *file);

#endif
