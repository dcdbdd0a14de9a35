/* run.h: runs one case of a suite on a device and determines its verdict.
 *
 * Each case has its own renderer and device, closed before the next case, so that no verdict
 * depends on the order. Shared are: an idle device that stays open, the calibration's renderer, and
 * ground-truth images that several cases use. A masu_conform owns them all; it is large and must
 * not be moved. */
#ifndef MASU_CONFORM_RUN_H
#define MASU_CONFORM_RUN_H

#include "conform/suite.h"
#include "session.h"

typedef struct masu_conform_result {
    const masu_case *of;
    masu_verdict verdict;
    double values[MASU_MEASURE_COUNT]; /* NAN: not measured */
    char why[600];  /* reason of the verdict, one line; "" for a pass */
    char note[200]; /* what could not be measured on this machine; or "" */
    double seconds;
} masu_conform_result;

typedef struct masu_truth_picture {
    const masu_case *of; /* the first case that used it */
    uint8_t *rgba;
} masu_truth_picture;

typedef struct masu_conform {
    const masu_suite *suite;
    const char *scenes; /* folder */
    const char *images; /* folder for the images; NULL: none */
    masu_headless_desc host;
    masu_switch ray_query;
    uint32_t runs; /* per round of times */
    char driver[1024];
    uint32_t most_pixels; /* largest width or height of an image */
    masu_headless kept;   /* always open: otherwise the loader reloads the driver for each case, and
                           * NVIDIA's 580.159 fails to load after about 30 times in one process */
    uint32_t offers;      /* same bits as masu_case.needs */
    bool clock_stopped; /* time measurements are impossible */
    bool calibrated;
    masu_session calibration;
    masu_headless_source source;
    masu_session session;
    masu_view view; /* of a case with field measures */
    masu_truth_picture *truths;
    uint32_t truth_count;
} masu_conform;

/* Set suite, scenes, images, host, ray_query and runs first. Opens a device and queries its
 * features; it remains open until masu_conform_close. */
bool masu_conform_open(masu_conform *c, char *error, size_t error_size);
void masu_conform_close(masu_conform *c);

/* Fills the result of a case that was not run, with the reason. */
void masu_conform_not_run(const masu_case *of, const char *why, masu_conform_result *out);
/* Compares the values of a case with its limits. `validated`: the validation layer ran, which hides
 * allocations. */
void masu_conform_judge(masu_conform_result *r, bool validated);
/* Never fails: every error becomes the verdict. */
void masu_conform_run(masu_conform *c, const masu_case *of, masu_conform_result *out);

#endif
