/* trust.h: selects the clock for a frame's time. There may be GPU timestamps and the host's clock
 * ("wall"). Either may be implausible, stand still, have a wrong unit or be missing. A pure
 * function of its state; accepts any values. docs/design/19-governor.md, "Clock selection". */
#ifndef MASU_TRUST_H
#define MASU_TRUST_H

#include "masu.h"

/* One finished frame. Unknown values are 0, negative or NaN. */
typedef struct masu_governor_sample {
    uint64_t frame; /* ascending; other samples are ignored */
    uint32_t rung;  /* rung of the frame */
    double gpu_ms;  /* from timestamps */
    /* host clock: from the submit, or the end of the previous frame if later, to the end of the
     * frame */
    double wall_ms;
    double fixed_ms;         /* part of gpu_ms: passes whose cost does not depend on the rung */
    double cpu_ms;           /* the host's work for the frame, without waiting */
    int exclude_from_timing; /* not representative for other frames */
} masu_governor_sample;

typedef struct masu_trust {
    masu_governor_source source;
    double overhead; /* wall - gpu, ms, while both are accepted */
    int overhead_known;
    double distrust; /* increases with each GPU time that the wall clock contradicts */
    int wall_only;
    double unit, unit_try; /* factor on GPU times */
    uint32_t unit_count;
    double frozen_gpu, frozen_wall;
    uint32_t frozen, frozen_rung;
    /* Wall times in whole refreshes: the host waits for the display before it measures. */
    double vsync;         /* refresh interval, ms; 0: not found */
    double step;          /* candidate for it */
    uint32_t steps;       /* times that are multiples of the step */
    uint32_t turns;       /* changes of the multiple */
    uint32_t odd;         /* consecutive times that are no multiples */
    uint32_t multiple;    /* of the last time */
    double cpu;           /* the host's own work per frame, ms, without outliers; 0: unknown */
} masu_trust;

static inline double masu_within(double x, double low, double high) {
    return x >= low ? x <= high ? x : high : low; /* NaN gives low */
}
static inline double masu_largest(double a, double b) { return a > b ? a : b; }
/* Whether a time in ms is plausible for a frame. False for NaN. */
static inline int masu_is_time(double ms) { return ms > 0.0 && ms <= 1e4; }

/* Factor: times this far from the target, either way, are pauses or clock errors, not load. About
 * 1 s at 60 Hz. */
#define MASU_TRUST_RANGE 64.0

void masu_trust_start(masu_trust *t);
/* GPU time of a sample, ms; 0: none. *sure: two clocks agree. `target`: target time of a frame. */
double masu_trust_time(masu_trust *t, double target, const masu_governor_sample *s, int *sure);

#endif
