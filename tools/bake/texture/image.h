/* image.h: a picture file becomes bytes. ImageMagick reads it, in a child process with a clock and
 * half of the machine's memory: picture files are as hostile as models.
 *
 * Which reader runs is decided here, by the file's first bytes (TGA has none: by its name), and
 * only readers of plain pictures: ImageMagick by itself would also follow scripts and addresses. */
#ifndef MASU_BAKE_IMAGE_H
#define MASU_BAKE_IMAGE_H

#include "bake/scene/content.h"

#define MASU_BAKE_IMAGE_SECONDS 30
#define MASU_BAKE_IMAGE_BYTES ((uint64_t)256 << 20) /* of the file */
#define MASU_BAKE_IMAGE_SIDE 16384u

/* How pictures are resized so that fewer sizes are left: not at all, to powers of two, to squares
 * of powers of two. Sides over MASU_TEXTURE_SIZE_MAX always become that long. */
enum { MASU_BAKE_SIZE_KEPT, MASU_BAKE_SIZE_POWER, MASU_BAKE_SIZE_SQUARE, MASU_BAKE_SIZES };

typedef struct masu_bake_picture {
    uint32_t width, height;
    masu_bake_buffer rgba; /* 4 bytes per texel, as the file encodes them */
    /* Of the file, if it is larger than MASU_TEXTURE_SIZE_MAX; else 0. */
    uint32_t whole_width, whole_height;
    uint32_t bits; /* of a channel, if its values need more than 8; else 0 */
} masu_bake_picture;

/* The name of the reader for these bytes ("PNG"), or NULL. */
const char *masu_bake_image_format(const unsigned char *data, size_t bytes, const char *name);

/* False after one warning that names the picture. `directories`: where to look for files that are
 * not where their name says, ':' between; may be NULL. */
bool masu_bake_read_image(const masu_bake_content *content, uint32_t image, const char *directories,
                          int sizes, masu_bake_picture *picture);

#endif
