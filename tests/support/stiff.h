/* stiff.h: one case of the stiff and extreme ones: a scene of tests/stiff seen by a camera,
 * drawn and compared, pixel by pixel, with its field marched in double precision.
 *
 * What a case claims stands in its row: the most that each figure may be (below 0: nothing), and why. A figure that
 * depends on what the march can do today says so, so that only a number changes when it can do
 * more. Each case prints one row of a table (`make stiff`, docs/design/05-sphere-tracing.md). */
#ifndef MASU_TEST_SUPPORT_STIFF_H
#define MASU_TEST_SUPPORT_STIFF_H

#include "support/support.h"

/* Over the pixels whose truth is decided. Distances and angles where both hit. */
typedef struct stiff_figures {
    double hitmiss;   /* %: one hits, the other does not */
    double lost;      /* %, of which: no hit where something is */
    double depth_p50; /* |t - truth| / truth */
    double depth_p99;
    double depth_max;
    double normal_p50; /* degrees */
    double normal_p99;
    double evals;       /* of the field, per pixel of the picture */
    double unconverged; /* % of the rays: steps used up */
} stiff_figures;

enum { STIFF_PARAMS = 8 };

typedef struct stiff_case {
    const char *name, *scene;
    masu_camera camera;
    uint32_t width, height, stride; /* stride: of the pixels compared; 0: 1 */
    float params[STIFF_PARAMS];
    uint32_t param_count, steps; /* steps: most of a ray; 0: 2048 */
    double least_hits; /* %: the truth shows at least as much, or the case would show nothing */
    stiff_figures most;
    const char *why;
} stiff_case;

/* What a case has drawn, for those that ask more than the figures. Valid until the next. */
typedef struct stiff_picture {
    const float *depth; /* width * height */
    const uint8_t *albedo;
    stiff_figures figures;
    masu_stats_info stats;
    double true_hits, unsure; /* % */
    bool gpu; /* that has drawn it, not a processor */
} stiff_picture;

/* Draws twice under the validation layer; fails the test if the two differ in a byte, if anything is
 * not finite, or if the layer says anything. Compares with the truth and prints the row. */
const stiff_picture *stiff_draw(const stiff_case *c);

/* stiff_draw, and asserts what the case claims. */
const stiff_picture *stiff_run(const stiff_case *c);

/* The session of a case by itself, and one frame of it, checked as above but compared with nothing:
 * width * height * 4 bytes, valid until the next. */
void stiff_open(masu_session *s, const stiff_case *c);
const uint8_t *stiff_frame(masu_session *s, const stiff_case *c);

/* The table's head. */
void stiff_head(void);

/* $MADE/stiff/NAME, for files beside the scenes; static storage. */
const char *stiff_path(const char *name);

#endif
