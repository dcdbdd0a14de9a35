/* patches.h: compares a linear image with a stored reference, a noisy image with known errors. It
 * compares the means of patches: their noise is small, so they reveal wrong lighting that the error
 * of a single pixel hides.
 *
 * A stored reference (.ref) is a text header, one "name value" per line, up to the line "end"; then
 * 3 half floats per pixel, top row first; then 3 means and 3 standard errors as floats for each of
 * the 144 patches. All values are little-endian. */
#ifndef MASU_MEASURE_PATCHES_H
#define MASU_MEASURE_PATCHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    MASU_PATCH_COLUMNS = 16,
    MASU_PATCH_ROWS = 9,
    MASU_PATCHES = MASU_PATCH_COLUMNS * MASU_PATCH_ROWS
};

typedef struct masu_patch {
    float mean[3], error[3];
} masu_patch;

typedef struct masu_reference {
    uint32_t width, height;
    char command[1024]; /* command that rendered it */
    float *pixels;      /* 3 per pixel; freed by masu_reference_free */
    masu_patch patches[MASU_PATCHES];
} masu_reference;

/* Computes the means of an image's patches. errors: standard error of each value of `pixels`,
 * independent of the other values; NULL: 0. */
void masu_patches_of(const float *pixels, const float *errors, uint32_t width, uint32_t height,
                     masu_patch out[MASU_PATCHES]);

bool masu_reference_save(const char *path, const masu_reference *r, char *error, size_t error_size);
bool masu_reference_load(const char *path, masu_reference *out, char *error, size_t error_size);
void masu_reference_free(masu_reference *r);
bool masu_reference_is_named(const char *path); /* ends in .ref, in any case */

typedef struct masu_patch_judgement {
    double ratio; /* of the means of both images: 1 if they agree */
    double p95;   /* 95th percentile over patches of |ratio - 1| beyond three standard errors */
    double trimmed; /* mean of the lowest nine tenths of z^2; 1: only noise and tolerance */
    uint32_t worst; /* patch with the largest |ratio - 1|, and that value: */
    double worst_by;
} masu_patch_judgement;

/* A relative error of 0.01 of a patch has the same weight as one standard error. Errors of patches
 * darker than a hundredth of the image's mean are relative to that hundredth. */
masu_patch_judgement masu_patches_judge(const masu_patch reference[MASU_PATCHES],
                                        const masu_patch image[MASU_PATCHES]);

#endif
