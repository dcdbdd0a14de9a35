/* canvas.h: the overlay as the processor draws it: panels and text, over which compose.comp lays the
 * picture. RGBA8 with premultiplied alpha, the size of the output; alpha 0 lets the picture through.
 *
 * The pixels belong to the canvas and come from malloc; the font (gen/view_font.h, DejaVu Sans Mono) is
 * part of the program. Drawing beyond the edges is cut off and never an error; only a size can fail. */
#ifndef MASU_VIEW_CANVAS_H
#define MASU_VIEW_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct masu_font {
    int width, height;             /* of every cell, pixels */
    const unsigned char *coverage; /* cells of ' ' to '~', row after row */
} masu_font;

typedef struct masu_canvas {
    uint32_t *pixels;
    int width, height;
    int top, bottom; /* rows [top, bottom) hold something; the others are clear */
    const masu_font *font;
} masu_canvas;

/* Colours of text, 0xRRGGBB. */
enum {
    MASU_INK = 0xE8ECF0,
    MASU_INK_DIM = 0x9AA6B2,
    MASU_INK_TITLE = 0x7FD4FF,
    MASU_INK_GOOD = 0x8CE99A,
    MASU_INK_WARN = 0xFFC94D,
    MASU_INK_BAD = 0xFF7B6B
};

/* Another size, clear, with a font that fits it: about 40 lines. False: no memory, nothing has
 * changed. */
bool masu_canvas_resize(masu_canvas *canvas, uint32_t width, uint32_t height);
void masu_canvas_free(masu_canvas *canvas);
void masu_canvas_clear(masu_canvas *canvas);

/* Blends a colour 0xRRGGBB of that opacity (0..255) over a rectangle. */
void masu_canvas_fill(masu_canvas *canvas, int x, int y, int width, int height, uint32_t color,
                      int opacity);
/* One line; bytes that are not printable ASCII become '?'. Returns the x behind it. */
int masu_canvas_text(masu_canvas *canvas, int x, int y, uint32_t color, const char *text);

#endif
