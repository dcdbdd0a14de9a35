/* run.h: runs one case of a suite on a device and judges it.
 *
 * Each case has a renderer and a device of its own, closed again before the next, so that no
 * verdict depends on the order. What is shared: a device that stays open and does nothing, the calibration,
 * which is a renderer that stays open, and truths, which several cases are compared with. A masu_conform owns all; it is
 * large and must not be moved. */
#ifndef MASU_CONFORM_RUN_H
#define MASU_CONFORM_RUN_H

#include "conform/suite.h"
#include "session.h"

typedef struct masu_conform_result {
    const masu_case *of;
    masu_verdict verdict;
    double values[MASU_MEASURE_COUNT]; /* NAN: not measured */
    char why[600];  /* what made the verdict, on one line; "" where it is a pass */
    char note[200]; /* what could not be measured here; or "" */
    double seconds;
} masu_conform_result;

typedef struct masu_truth_picture {
    const masu_case *of; /* the first case that has asked for it */
    uint8_t *rgba;
} masu_truth_picture;

typedef struct masu_conform {
    const masu_suite *suite;
    const char *scenes; /* folder */
    const char *images; /* folder for the pictures; NULL: none */
    masu_headless_desc host;
    masu_switch ray_query;
    uint32_t runs; /* of each round of times */
    char driver[1024];
    uint32_t most_pixels; /* along an edge of an image */
    masu_headless kept;   /* open all the time, or the loader would load the driver anew for each case: NVIDIA's 580.159 can be
                             loaded some 30 times by one process, and is not found after that */
    uint32_t offers;      /* as masu_case.needs */
    bool clock_stopped; /* nothing can be timed */
    bool calibrated;
    masu_session calibration;
    masu_headless_source source;
    masu_session session;
    masu_view view; /* of a case that is compared with its field */
    masu_truth_picture *truths;
    uint32_t truth_count;
} masu_conform;

/* suite, scenes, images, host, ray_query and runs are given; asks the device what it is, and keeps it open until masu_conform_close. */
bool masu_conform_open(masu_conform *c, char *error, size_t error_size);
void masu_conform_close(masu_conform *c);

/* A result without a run: all that is known of the case, and why it was not run. */
void masu_conform_not_run(const masu_case *of, const char *why, masu_conform_result *out);
/* Never fails itself: whatever goes wrong is the verdict. */
void masu_conform_run(masu_conform *c, const masu_case *of, masu_conform_result *out);

#endif
