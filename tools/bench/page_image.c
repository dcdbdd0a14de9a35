/* page_image.c: an image of a page (page.h), encoded as JPEG by stb. */
#include "bench/page.h"

#include "cli/markup.h"

#include <stdlib.h>
#include <string.h>

/* platform/image.c has the other copy. */
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

typedef struct encoded {
    uint8_t *bytes;
    size_t count, most; /* count above most: the image does not fit */
} encoded;

static void append(void *context, void *bytes, int count) {
    encoded *e = context;
    if (e->count + (size_t)count <= e->most) memcpy(e->bytes + e->count, bytes, (size_t)count);
    e->count += (size_t)count;
}

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
    encoded e = {malloc(bytes), bytes + 1, bytes};
    uint8_t *copy = malloc(all);
    bool good = e.bytes && copy;
    if (good) memcpy(copy, rgba, all);
    while (good) {
        for (int quality = 97; quality >= 37 && e.count > e.most; quality -= 15) {
            e.count = 0;
            if (!stbi_write_jpg_to_func(append, &e, (int)width, (int)height, 4, copy, quality))
                good = false;
        }
        if (!good || e.count <= e.most || width < 32 || height < 32) break;
        halve(copy, &width, &height);
    }
    good = good && e.count <= e.most;
    if (good) {
        masu_markup(
            f,
            "<img class=\"%s\" width=\"%u\" height=\"%u\" alt=\"%s\" src=\"data:image/jpeg;base64,",
            kind, shown_width, shown_height, text);
        masu_page_base64(f, e.bytes, e.count);
        fputs("\"/>", f);
    }
    free(e.bytes);
    free(copy);
    return good;
}
