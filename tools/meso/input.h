/* input.h: patches from files: a picture of heights (height.c) or a model (import.c).
 * Files are hostile; both readers check before they trust. False after one error line. */
#ifndef MASU_MESO_INPUT_H
#define MASU_MESO_INPUT_H

#include "meso/patch.h"

#define MASU_MESO_HEIGHT_SIDE_MAX 2048u

typedef struct masu_meso_input {
    double height;    /* of white over black, in periods */
    double albedo[3]; /* of what has no colour of its own */
    double roughness; /* of the facets */
    double tile;      /* of a model: edge of its period in the model's unit; 0: its extent in x */
} masu_meso_input;

/* A square PNG of 8 or 16 bits, the first channel; it repeats in both directions. */
bool masu_meso_read_heights(const char *path, const masu_meso_input *input, masu_meso_patch *patch);
/* A model as masu-bake reads it, y up, which repeats in x and z. */
bool masu_meso_read_model(const char *path, const masu_meso_input *input, masu_meso_patch *patch);

#endif
