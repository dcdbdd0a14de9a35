/* input.h: reads patches from files: a height image (height.c) or a model (import.c). Files are
 * untrusted, and both readers validate them. Functions return false after one error line. */
#ifndef MASU_MESO_INPUT_H
#define MASU_MESO_INPUT_H

#include "meso/patch.h"

#define MASU_MESO_HEIGHT_SIDE_MAX 2048u

typedef struct masu_meso_input {
    double height;    /* of white above black, in periods */
    double albedo[3]; /* of parts without a colour */
    double roughness; /* of the facets */
    double tile;      /* of a model: side of its period in the model's unit; 0: its extent in x */
} masu_meso_input;

/* A square PNG of 8 or 16 bits; uses the first channel. It repeats in both directions. */
bool masu_meso_read_heights(const char *path, const masu_meso_input *input, masu_meso_patch *patch);
/* A model in any format of masu-bake, y up; it repeats in x and z. */
bool masu_meso_read_model(const char *path, const masu_meso_input *input, masu_meso_patch *patch);

#endif
