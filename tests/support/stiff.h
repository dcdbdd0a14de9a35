/* stiff.h: one stress test of the sphere tracer: renders a scene of tests/stiff and compares it,
 * pixel by pixel, with its field traced in double precision.
 *
 * Each row states the claims of its case: the upper limit of each figure (below 0: no limit)
 * and the reason. A figure that depends on a limitation of the tracer says so; when the tracer
 * improves, only a number changes. Each case prints one row of a table (`make stiff`,
 * docs/design/05-sphere-tracing.md). */
#ifndef MASU_TEST_SUPPORT_STIFF_H
#define MASU_TEST_SUPPORT_STIFF_H

#include "support/support.h"

/* Over the pixels whose reference is decided. Distances and angles: if both hit. */
typedef struct stiff_figures {
    double hitmiss;   /* %: one hits, the other does not */
    double lost;      /* %, part of hitmiss: no hit although a surface is there */
    double depth_p50; /* t - reference| / reference */
    double depth_p99;
    double depth_max;
    double normal_p50; /* degrees */
    double normal_p99;
    double evals;       /* of the field, per pixel of the image */
    double unconverged; /* % of the rays: out of steps */
} stiff_figures;

enum { STIFF_PARAMS = 8 };

typedef struct stiff_case {
    const char *name, *scene;
    masu_camera camera;
    uint32_t width, height, stride; /* stride: every stride-th pixel is compared; 0: 1 */
    float params[STIFF_PARAMS];
    uint32_t param_count, steps; /* steps: limit per ray; 0: 2048 */
    double least_hits; /* %: lower bound for hits of the reference, so that the case shows
                          something */
    stiff_figures most;
    const char *why;
} stiff_case;

/* The rendering of a case, for tests that check more than the figures. Valid until the next one. */
typedef struct stiff_picture {
    const float *depth; /* width * height */
    const uint8_t *albedo;
    stiff_figures figures;
    masu_stats_info stats;
    double true_hits, unsure; /* % */
    bool gpu; /* rendered by a GPU, not by a processor */
} stiff_picture;

/* Renders twice under the validation layer. Fails the test if the two images differ, if a value is
 * not finite, or if the layer reports anything. Compares with the reference and prints the row. */
const stiff_picture *stiff_draw(const stiff_case *c);

/* stiff_draw, and asserts the limits of the case. */
const stiff_picture *stiff_run(const stiff_case *c);

/* The session of a case, and one frame, checked as above but not compared: width * height * 4
 * bytes, valid until the next one. */
void stiff_open(masu_session *s, const stiff_case *c);
const uint8_t *stiff_frame(masu_session *s, const stiff_case *c);

/* Prints the head of the table. */
void stiff_head(void);

/* $MADE/stiff/NAME, for files next to the scenes; static storage. */
const char *stiff_path(const char *name);

#endif
