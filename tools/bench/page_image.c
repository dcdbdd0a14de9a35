/* page_image.c: an image of a page (page.h), encoded as JPEG. */
#include "bench/page.h"

#include "cli/markup.h"
#include "image.h"

#include <stdlib.h>
#include <string.h>

/* Means of 2x2 pixels, in place; an odd last row or column is dropped. */
static void halve(uint8_t *rgba, uint32_t *width, uint32_t *height) {
    const uint32_t w = *width / 2, h = *height / 2;
    const size_t row = 4 * (size_t)*width;
    for (uint32_t y = 0; y < h; y++) {
        for (uint32_t i = 0; i < 4 * w; i++) {
            const uint8_t *from = rgba + 2 * y * row + 8 * (size_t)(i / 4) + i % 4;
            const uint32_t sum = 2u + from[0] + from[4] + from[row] + from[row + 4];
            rgba[4 * (size_t)w * y + i] = (uint8_t)(sum / 4);
        }
    }
    *width = w;
    *height = h;
}

bool masu_page_image(FILE *f, const uint8_t *rgba, uint32_t width, uint32_t height, size_t bytes,
                     const char *kind, const char *text) {
    const size_t all = 4 * (size_t)width * height;
    const uint32_t shown_width = width, shown_height = height;
    size_t count = bytes + 1;
    uint8_t *jpeg = malloc(bytes), *copy = malloc(all);
    bool good = jpeg && copy;
    if (good) memcpy(copy, rgba, all);
    while (good) {
        for (int quality = 97; quality >= 37 && count > bytes; quality -= 15)
            count = masu_image_encode_jpeg(copy, width, height, quality, jpeg, bytes);
        if (count <= bytes || width < 32 || height < 32) break;
        halve(copy, &width, &height);
    }
    good = good && count && count <= bytes;
    if (good) {
        masu_markup(
            f,
            "<img class=\"%s\" width=\"%u\" height=\"%u\" alt=\"%s\" src=\"data:image/jpeg;base64,",
            kind, shown_width, shown_height, text);
        masu_page_base64(f, jpeg, count);
        fputs("\"/>", f);
    }
    free(jpeg);
    free(copy);
    return good;
}
