/* image.h: decodes image files. ImageMagick decodes them in a child process with a time limit and
 * half of the machine's memory, because image files are as untrusted as models.
 *
 * This file chooses the decoder by the first bytes of the file (by the name for TGA, which has no
 * signature). It allows only decoders of plain images: ImageMagick's own choice would also run
 * scripts and open addresses. */
#ifndef MASU_BAKE_IMAGE_H
#define MASU_BAKE_IMAGE_H

#include "bake/scene/content.h"

#define MASU_BAKE_IMAGE_SECONDS 30
#define MASU_BAKE_IMAGE_BYTES ((uint64_t)256 << 20) /* of the file */
#define MASU_BAKE_IMAGE_SIDE 16384u

/* How images are resized to get fewer different sizes: unchanged, to powers of two, or to squares
 * whose sides are powers of two. A side over MASU_TEXTURE_SIZE_MAX is always reduced to it. */
enum { MASU_BAKE_SIZE_KEPT, MASU_BAKE_SIZE_POWER, MASU_BAKE_SIZE_SQUARE, MASU_BAKE_SIZES };

typedef struct masu_bake_picture {
    uint32_t width, height;
    masu_bake_buffer rgba; /* 4 bytes per texel, as the file encodes them */
    /* The file's size if it exceeds MASU_TEXTURE_SIZE_MAX; else 0. */
    uint32_t whole_width, whole_height;
    uint32_t bits; /* bits per channel if the values need more than 8; else 0 */
} masu_bake_picture;

/* The name of the decoder for these bytes ("PNG"), or NULL. */
const char *masu_bake_image_format(const unsigned char *data, size_t bytes, const char *name);

/* Returns false after one warning that names the image. `directories`: the folders to search for
 * files that do not exist under their own path, separated by ':'; may be NULL. */
bool masu_bake_read_image(const masu_bake_content *content, uint32_t image, const char *directories,
                          int sizes, masu_bake_picture *picture);

#endif
