/* image_write.c: encodes PNG and JPEG by stb (image.h). Apart from image.c, because stb's JPEG
 * writer shifts bits out of signed integers, which the sanitizer allows in this file alone
 * (platform.mk). */
#include "image.h"
#include "image_parts.h"

#include <stdlib.h>
#include <string.h>

/* Hidden, for the reason in image.c. */
#if defined(__GNUC__)
#define STBIWDEF extern __attribute__((visibility("hidden")))
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

bool masu_image_save_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                         size_t row_bytes, char *error, size_t error_size) {
    if (!masu_image_size_allowed(path, width, height, error, error_size)) {
        return false;
    }
    size_t row = row_bytes ? row_bytes : (size_t)width * 4;
    if (row < (size_t)width * 4 || row > 0x7FFFFFFFu) {
        return masu_image_fail(error, error_size, "%s: rows of %zu bytes do not hold %u pixels",
                               path, row, width);
    }
    int count = 0;
    unsigned char *bytes =
        stbi_write_png_to_mem(rgba, (int)row, (int)width, (int)height, 4, &count);
    if (!bytes) {
        return masu_image_fail(error, error_size, "%s: out of memory for the PNG file", path);
    }
    bool good = masu_file_write(path, bytes, (size_t)count, error, error_size);
    free(bytes);
    return good;
}

struct encoded {
    uint8_t *bytes;
    size_t count, most; /* count above most: the rest is dropped */
};

static void append(void *context, void *bytes, int count) {
    struct encoded *e = context;
    size_t left = e->count < e->most ? e->most - e->count : 0;
    size_t kept = left < (size_t)count ? left : (size_t)count;
    if (kept) {
        memcpy(e->bytes + e->count, bytes, kept);
    }
    e->count += (size_t)count;
}

size_t masu_image_encode_jpeg(const uint8_t *rgba, uint32_t width, uint32_t height, int quality,
                              uint8_t *bytes, size_t most) {
    struct encoded e = {bytes, 0, most};
    if (quality < 1 || quality > 100 || !masu_image_size_allowed("", width, height, NULL, 0)) {
        return 0;
    }
    (void)stbi_write_jpg_to_func(append, &e, (int)width, (int)height, 4, rgba, quality);
    return e.count;
}
