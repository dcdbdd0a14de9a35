/* truth.h: the exact surface at a pixel: evaluates the scene's SDF in double precision from a
 * shared library and marches it to convergence.
 *
 * The library is compiled from the C code that the SDF compiler generates for a scene. It is at
 * NAME.truth.so next to NAME.masu. It is executable code: trust it like the program itself.
 *
 * THE MARCH. Steps of field / Lipschitz constant until the field is below 1e-9 of the distance (or
 * below the resolution of double at these coordinates), then secant and bisection between that
 * point and one behind the surface. A ray that approaches a surface at a grazing angle needs more
 * than its 4096 steps. If the field is below 1e-6 of the distance, or if the steps are used up, the
 * march tests a point behind the predicted crossing. It accepts the crossing if the field falls
 * steadily up to there and changes its sign. There are up to 16 such rounds of 4096 steps. A ray
 * without a result is UNSURE and excluded from every comparison; the number of such rays is
 * reported.
 *
 * Rules shared with the renderer: a field at or below the tolerance at the ray's start is a hit at
 * the start (a camera inside a solid sees the solid at the near plane). There are no hits at or
 * beyond the limit or outside the bounds. A non-finite field is a miss. */
#ifndef MASU_MEASURE_TRUTH_H
#define MASU_MEASURE_TRUTH_H

#include "measure/view_uniforms.h"

#include <stddef.h>

typedef struct masu_truth {
    void *library; /* NULL: the functions are linked in */
    double (*distance)(const double *params, double time, const double p[3]);
    double (*step)(const double *params, double time, const double p[3]); /* a safe step */
    int (*part)(const double *params, double time, const double p[3]);
    /* Albedo, roughness, emissive, metallic; animated materials use the time of this thread's last
     * call of the functions above. */
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
    double t; /* along the ray; UNSURE: closest approach */
    double normal[3];
    uint32_t evals;
} masu_truth_sample;

/* "dir/NAME.masu" -> "dir/NAME.truth.so". Returns false if the result is too long. */
bool masu_truth_path(const char *scene_path, char *out, size_t size);

/* On false `error` holds one line. */
bool masu_truth_open(const char *path, masu_truth *truth, char *error, size_t error_size);
void masu_truth_close(masu_truth *truth);

/* Marches one ray of the view, with the view's params and time. */
void masu_truth_march(const masu_truth *truth, const masu_view *view, const masu_view_ray *ray,
                      masu_truth_sample *out);

/* Marches every stride-th pixel of every stride-th row, from pixel (0,0), row by row, on all
 * processors. out: masu_truth_columns(width, stride) * masu_truth_columns(height, stride)
 * samples. */
uint32_t masu_truth_columns(uint32_t size, uint32_t stride);
void masu_truth_image(const masu_truth *truth, const masu_view *view, uint32_t stride,
                      masu_truth_sample *out);

#endif
