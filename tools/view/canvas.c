/* canvas.c: see canvas.h. */
#include "view/canvas.h"

#include <stdlib.h>
#include <string.h>

#include "view_font.h"

enum { FONTS = sizeof masu_fonts / sizeof *masu_fonts, FIRST = ' ', LAST = '~', LINES = 40 };

static const masu_font *font_for(uint32_t width, uint32_t height) {
    const masu_font *font = &masu_fonts[0];
    for (int i = 1; i < FONTS; i++) {
        bool fits = masu_fonts[i].height * LINES <= (int)height &&
                    masu_fonts[i].width * 2 * LINES <= (int)width;
        if (fits) font = &masu_fonts[i];
    }
    return font;
}

bool masu_canvas_resize(masu_canvas *c, uint32_t width, uint32_t height) {
    uint32_t *pixels = calloc((size_t)width * height, sizeof *pixels);
    if (!pixels) return false;
    free(c->pixels);
    *c = (masu_canvas){.pixels = pixels,
                       .width = (int)width,
                       .height = (int)height,
                       .font = font_for(width, height)};
    return true;
}

void masu_canvas_free(masu_canvas *c) {
    free(c->pixels);
    memset(c, 0, sizeof *c);
}

void masu_canvas_clear(masu_canvas *c) {
    if (c->bottom > c->top) {
        memset(c->pixels + (size_t)c->top * (size_t)c->width, 0,
               sizeof *c->pixels * (size_t)(c->bottom - c->top) * (size_t)c->width);
    }
    c->top = c->bottom = 0;
}

static void touch(masu_canvas *c, int top, int bottom) {
    bool empty = c->bottom <= c->top;
    if (empty || top < c->top) c->top = top;
    if (empty || bottom > c->bottom) c->bottom = bottom;
}

/* Premultiplied "over"; alpha 0..255. */
static uint32_t over(uint32_t below, uint32_t color, uint32_t alpha) {
    uint32_t parts[4] = {color >> 16 & 255u, color >> 8 & 255u, color & 255u, 255u};
    uint32_t out = 0;
    for (int i = 0; i < 4; i++) {
        uint32_t was = below >> 8 * i & 255u;
        out |= (parts[i] * alpha + was * (255u - alpha) + 127u) / 255u << 8 * i;
    }
    return out;
}

void masu_canvas_fill(masu_canvas *c, int x, int y, int width, int height, uint32_t color,
                      int opacity) {
    int x1 = x + width < c->width ? x + width : c->width;
    int y1 = y + height < c->height ? y + height : c->height;
    x = x < 0 ? 0 : x;
    y = y < 0 ? 0 : y;
    if (x >= x1 || y >= y1) return;
    touch(c, y, y1);
    for (int j = y; j < y1; j++) {
        uint32_t *row = c->pixels + (size_t)j * (size_t)c->width;
        for (int i = x; i < x1; i++) row[i] = over(row[i], color, (uint32_t)opacity);
    }
}

static void glyph(masu_canvas *c, int x, int y, uint32_t color, int character) {
    const masu_font *f = c->font;
    const unsigned char *cell = f->coverage + (size_t)(character - FIRST) * (size_t)(f->width * f->height);
    for (int j = 0; j < f->height; j++) {
        int at = y + j;
        if (at < 0 || at >= c->height) continue;
        uint32_t *row = c->pixels + (size_t)at * (size_t)c->width;
        for (int i = 0; i < f->width; i++) {
            unsigned char coverage = cell[j * f->width + i];
            if (coverage && x + i >= 0 && x + i < c->width)
                row[x + i] = over(row[x + i], color, coverage);
        }
    }
}

int masu_canvas_text(masu_canvas *c, int x, int y, uint32_t color, const char *text) {
    int top = y < 0 ? 0 : y, bottom = y + c->font->height;
    if (bottom > c->height) bottom = c->height;
    if (top < bottom && *text) touch(c, top, bottom);
    for (; *text; text++, x += c->font->width) {
        unsigned char character = (unsigned char)*text;
        if (character != ' ')
            glyph(c, x, y, color, character < FIRST || character > LAST ? '?' : character);
    }
    return x;
}
