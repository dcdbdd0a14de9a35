/* truth.h: the true surface behind a pixel: the scene's field in double precision, out of a
 * shared object, marched until nothing is left to gain.
 *
 * The object is compiled from the C text that the SDF compiler writes for a scene; it lies beside
 * the scene, NAME.truth.so beside NAME.masu, and is code: as trusted as the program itself.
 *
 * THE MARCH. Steps of field / Lipschitz constant to a field of 1e-9 of the distance (or of what
 * double resolves at the coordinates involved), then secant and bisection between that point and
 * one behind the surface. A ray that creeps towards a surface under a small angle needs more steps
 * than the 4096 it has: once the field is below 1e-6 of the distance, or when the steps are used
 * up, a point behind the predicted crossing is tried, and taken if the field has fallen steadily up
 * to there and changed its sign. Up to 16 rounds of 4096 steps go by like that. A ray that is still
 * open is UNSURE and is left out of every comparison; how many there are is reported.
 *
 * The rules that the picture shares: a field at or below the tolerance where the ray starts is a
 * hit at the start (a camera inside a solid sees it at the near plane); nothing is hit at or beyond
 * the limit, nor outside the bounds. A field that is not finite is a miss. */
#ifndef MASU_MEASURE_TRUTH_H
#define MASU_MEASURE_TRUTH_H

#include "measure/view_uniforms.h"

#include <stddef.h>

typedef struct masu_truth {
    void *library; /* NULL: the functions are the program's own */
    double (*distance)(const double *params, double time, const double p[3]);
    double (*step)(const double *params, double time, const double p[3]); /* never too far */
    int (*part)(const double *params, double time, const double p[3]);
    /* Albedo, roughness, emissive, metallic; animated ones as of this thread's last call above. */
    void (*material)(int part, double out[8]);
} masu_truth;

typedef enum masu_truth_kind {
    MASU_TRUTH_MISS = 0,
    MASU_TRUTH_HIT = 1,
    MASU_TRUTH_UNSURE = 2
} masu_truth_kind;

typedef struct masu_truth_sample {
    masu_truth_kind kind;
    int part;
    double t; /* along the ray; UNSURE: where it came closest */
    double normal[3];
    uint32_t evals;
} masu_truth_sample;

/* "dir/NAME.masu" -> "dir/NAME.truth.so". False: it does not fit. */
bool masu_truth_path(const char *scene_path, char *out, size_t size);

/* On false `error` says why in one line. */
bool masu_truth_open(const char *path, masu_truth *truth, char *error, size_t error_size);
void masu_truth_close(masu_truth *truth);

/* The view's params and time, its eye and one of its rays. */
void masu_truth_march(const masu_truth *truth, const masu_view *view, const masu_view_ray *ray,
                      masu_truth_sample *out);

/* Every stride-th pixel of every stride-th row, from pixel (0,0), row by row, on all processors.
 * out: masu_truth_columns(width, stride) * masu_truth_columns(height, stride) samples. */
uint32_t masu_truth_columns(uint32_t size, uint32_t stride);
void masu_truth_image(const masu_truth *truth, const masu_view *view, uint32_t stride,
                      masu_truth_sample *out);

#endif
