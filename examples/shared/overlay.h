/* overlay.h: what a host adds to a picture of the library's, in its own command buffer behind the library's:
 * words over it, as on a HUD, and a copy of it for a file. */
#ifndef EXAMPLES_OVERLAY_H
#define EXAMPLES_OVERLAY_H

#include "window.h"

typedef struct overlay_line {
    int x, y, dot; /* pixels: its upper left corner, the edge of a dot */
    char text[64]; /* '-' to 'Z' and blanks */
} overlay_line;

typedef struct overlay_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} overlay_buffer;

typedef struct overlay {
    window *window;
    overlay_buffer words[WINDOW_SLOTS], copy;
} overlay;

/* Takes all of its memory: nothing is asked for later. Harmless to close when that failed. */
bool overlay_open(overlay *o, window *w);
void overlay_close(overlay *o);
/* Records w->commands[slot]: the lines, as far as they fit into the picture, then the copy. The library has left the
 * image in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL; afterwards it can be shown. */
bool overlay_record(overlay *o, uint32_t slot, uint32_t image, const overlay_line *lines, int count, bool copy);
/* Waits, and writes the copy as a BMP; at most 2560x1440 pixels are there. */
bool overlay_save(overlay *o, const char *file);

#endif
