/* smaa.h: slow scalar SMAA 1x in its three passes, the reference for shaders/smaa_edges.comp and
 * shaders/smaa_blend.comp; and for shaders/fxaa.comp.
 *
 * SMAA is written as its authors describe it: searches step by two pixels through bilinear fetches
 * of an edge image, the end of a line is read from the search table, the area from the area table.
 * The shaders count bits instead, and both have to agree.
 *
 * Images as in fsr1.h: values outside of 0..1 are clamped on read, non-finite ones read as 0. The
 * caller owns all memory; nothing here allocates or fails. */
#ifndef MASU_TESTS_REFERENCE_SMAA_H
#define MASU_TESTS_REFERENCE_SMAA_H

#include "reference/fsr1.h"

struct masu_ref_smaa {
    float threshold;
    int steps, diagonal_steps, corners; /* diagonal_steps 0: no diagonals */
};

/* 0 low, 1 medium, 2 high, 3 ultra. */
struct masu_ref_smaa masu_ref_smaa_preset(int preset);

/* Two bytes per pixel, 255 or 0: an edge to the left, an edge above. Luma is computed from values
 * rounded to 8 bits. */
void masu_ref_smaa_edges(const struct masu_ref_image *in, const struct masu_ref_smaa *with,
                         uint8_t *edges);
/* Four bytes per pixel: for the edge above, then for the edge to the left. */
void masu_ref_smaa_weights(const uint8_t *edges, uint32_t width, uint32_t height,
                           const struct masu_ref_smaa *with, uint8_t *weights);
/* Three floats per pixel. */
void masu_ref_smaa_blend(const struct masu_ref_image *in, const uint8_t *weights, float *out);

void masu_ref_fxaa(const struct masu_ref_image *in, float *out);

#endif
