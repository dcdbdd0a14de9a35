/* trust.h: what is believed of a frame's times. Two clocks may tell of it, that of the GPU by timestamps
 * and the host's ("the wall"), and either may lie, stand still, have a wrong unit or be missing. A pure
 * function of its own state; any values may be given. docs/design/19-governor.md, "Clock
 * selection". */
#ifndef MASU_TRUST_H
#define MASU_TRUST_H

#include "masu.h"

/* One finished frame. What is not known is 0, negative or NaN. */
typedef struct masu_governor_sample {
    uint64_t frame;  /* samples come in rising order; others are left out */
    uint32_t rung;   /* that it was drawn at */
    double gpu_ms;   /* by timestamps */
    double wall_ms;  /* by the host's clock: from its submit, or the end of the previous frame if that
                       was later, to its end */
    double fixed_ms; /* of gpu_ms: passes whose cost does not follow the rung */
    double cpu_ms;   /* what the host was busy with for it, without waiting */
    int exclude_from_timing; /* its times say nothing of other frames' */
} masu_governor_sample;

typedef struct masu_trust {
    masu_governor_source source;
    double overhead; /* wall - gpu, ms, where both are believed */
    int overhead_known;
    double distrust; /* rises with each GPU time that the wall contradicts */
    int wall_only;
    double unit, unit_try; /* what GPU times are multiplied by */
    uint32_t unit_count;
    double frozen_gpu, frozen_wall;
    uint32_t frozen, frozen_rung;
    /* Wall times in whole refreshes: the host waits for the display before it measures. */
    double vsync;         /* refresh interval, ms; 0: not found */
    double step;          /* candidate for it */
    uint32_t steps;       /* times that are multiples of it */
    uint32_t turns;       /* changes of the multiple */
    uint32_t odd;         /* times in a row that are none */
    uint32_t multiple;    /* of the last time */
    double cpu; /* the host's own work for a frame, ms, without single long ones; 0: not known */
} masu_trust;

static inline double masu_within(double x, double low, double high) {
    return x >= low ? x <= high ? x : high : low; /* NaN: low */
}
static inline double masu_largest(double a, double b) { return a > b ? a : b; }
/* Whether it can be a frame's time, ms. NaN cannot. */
static inline int masu_is_time(double ms) { return ms > 0.0 && ms <= 1e4; }

void masu_trust_start(masu_trust *t);
/* The time of a sample on the GPU, ms; 0: it has none. *sure: two clocks say so. `target`: of a frame. */
double masu_trust_time(masu_trust *t, double target, const masu_governor_sample *s, int *sure);

#endif
