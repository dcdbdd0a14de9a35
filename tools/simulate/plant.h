/* plant.h: simulated GPUs and scenes for controllers of resolution, and the controllers that are
 * compared on them. Deterministic: a plant, a controller and a seed give the same frames with every
 * compiler. Linked by tests/unit/test_governor.c and by `masu plant`.
 *
 *   true ms = clock(f) * (fixed + load(f) * s^exponent) * (1 + noise * (u - 0.5))
 *
 * u is uniform in 0..1. A sample of frame f is known when frame f + latency is decided. */
#ifndef PLANT_H
#define PLANT_H

#include "quality/governor.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PLANT_FRAMES_MOST 4096u
#define PLANT_RUNGS 16u
#define PLANT_TRACE_RUNGS 8u

/* How timestamps lie, from plant.lie_from to lie_until. */
typedef enum plant_lie {
    PLANT_HONEST,
    PLANT_TENTH,    /* 0.1 ms, whatever it was */
    PLANT_LAVAPIPE, /* 0.06 to 0.17 ms, at random: Mesa 22.3 */
    PLANT_LOW,      /* 60 % of the truth */
    PLANT_FROZEN,   /* the last honest one, for ever */
    PLANT_ZERO,
    PLANT_NEGATIVE,
    PLANT_HUGE, /* 2^64 - 1 */
    PLANT_NAN,
    PLANT_MICRO, /* microseconds in a field of milliseconds */
    PLANT_NANO,
    PLANT_SECONDS,
    PLANT_GARBAGE /* any of these, and any bits */
} plant_lie;

/* Times of a recorded scene: a row per frame, a column per scale. */
typedef struct plant_trace {
    char name[64];
    uint32_t frames, columns;
    double scale[PLANT_TRACE_RUNGS]; /* falling */
    double ms[PLANT_FRAMES_MOST][PLANT_TRACE_RUNGS];
    double budget_ms; /* halfway between its dearest and cheapest mean */
} plant_trace;

typedef struct plant {
    const char *name;
    const char *what; /* one line */
    uint32_t frames;
    uint32_t event; /* the frame from which settling is counted */
    double (*load)(const struct plant *plant, uint32_t frame); /* NULL: a */
    double (*clock)(uint32_t frame);                           /* factor on times; NULL: 1 */
    double a, b, period;                                       /* of the load */
    double fixed;                                              /* ms; 0: 2 */
    double exponent;                                           /* 0: 2 */
    double noise;                                              /* full width, relative; 0: 0.04 */
    double spikes;    /* part of frames that take three times as long */
    double missing;   /* part of samples that never arrive */
    double quantum;   /* ms: timestamps are multiples of it */
    uint32_t latency; /* 0: 3 */
    uint32_t rungs;   /* of the ladder: 0: 16, geometric from 1 to 0.4 */
    plant_lie lie;
    uint32_t lie_from, lie_until;
    uint32_t wall;  /* the host's clock is known too: truth + 0.3 ms, 2 % of noise */
    uint32_t pause; /* at this frame: a time of 10 s, then 200 frames without samples; 0: none */
    const plant_trace *trace; /* instead of fixed and load */
} plant;

#define PLANT_BUDGET 16.67
#define PLANT_SETTLED                                                                              \
    180u /* frames after the event: from then on a constant load is no reason to change */

extern const plant plant_list[];
extern const uint32_t plant_count;
const plant *plant_find(const char *name); /* NULL: there is none */

/* A controller of resolution: times in, a scale out. `state` has room for any of them. */
typedef union plant_state {
    masu_governor governor;
    struct {
        double scale, budget;
        double history[16], integral, error;
        uint32_t count, held, over, frame, settings;
        double level;
    } rival;
} plant_state;

typedef struct plant_controller {
    const char *name;
    void (*init)(plant_state *state, const masu_governor_rung *ladder, uint32_t rungs,
                 double budget);
    void (*sample)(plant_state *state, const masu_governor_sample *sample);
    /* The rung to draw at, or, of a controller with scales of its own, rungs + any: then *scale. */
    uint32_t (*pick)(plant_state *state, uint64_t frame, double *scale);
} plant_controller;

/* masu, three_state, filament, filament_headroom, unreal */
extern const plant_controller plant_controllers[];
extern const uint32_t plant_controller_count;

/* One frame of a run. */
typedef struct plant_frame {
    double ms, scale;
    uint32_t rung;
} plant_frame;

typedef struct plant_result {
    uint32_t frames, over, changes;
    uint32_t late_changes; /* from frame event + PLANT_SETTLED on */
    double mean_scale;
    int32_t
        settle; /* frames from the event until 30 in a row keep the budget and the scale does not
                       fall; -1: never */
    uint32_t invalid;          /* rungs that do not exist */
    uint32_t most_changes_150; /* in any 150 frames */
} plant_result;

/* `frames` takes plant->frames of them, or NULL; `state` is left as it is after the last one, or
 * NULL. */
plant_result plant_run(const plant *p, const plant_controller *controller, uint64_t seed,
                       plant_frame *frames, plant_state *state);
double plant_budget(const plant *p);
/* The ladder of a plant; returns how many rungs. */
uint32_t plant_ladder(const plant *p, masu_governor_rung out[PLANT_RUNGS]);
/* The largest rung's scale that keeps the budget with all the noise there may be, and knows the
 * load: what nobody can beat. */
double plant_oracle(const plant *p);

/* "frame,1,0.88,...": a line of scales, then a line per frame. False: `error` says why. */
bool plant_trace_read(const char *path, plant_trace *out, char *error, size_t error_size);
plant plant_of_trace(const plant_trace *trace);

#endif
