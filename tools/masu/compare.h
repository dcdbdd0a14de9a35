/* compare.h: the two kinds of images that `masu compare` reads: 8 bits of sRGB, and linear
 * light. */
#ifndef MASU_CMD_COMPARE_H
#define MASU_CMD_COMPARE_H

#include <stdbool.h>

typedef struct masu_compare_options {
    const char *map, *json, *errors;
    double ppd;
} masu_compare_options;

/* Whether the file has linear light: PFM, OpenEXR or a stored reference (.ref). */
bool masu_compare_is_linear(const char *path);

/* files: reference, image. An exit code. */
int masu_compare_linear(const char *const files[2], const masu_compare_options *o);

#endif
