/* simulated_gpu.h: simulated GPUs and scenes, for running controllers of dynamic resolution.
 * Deterministic: a model, a controller and a seed give the same frames with every compiler. Used by
 * the governor's tests and by `masu-lab simulate`, which adds controllers of other engines and
 * recorded traces (lab/simulate).
 *
 *   true ms = clock(f) * (fixed + load(f) * s^exponent) * (1 + noise * (u - 0.5))
 *
 * u is uniform in 0..1. A sample of frame f is available when frame f + latency is decided. */
#ifndef SUPPORT_SIMULATED_GPU_H
#define SUPPORT_SIMULATED_GPU_H

#include "quality/governor.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define SIM_FRAMES_MOST 4096u
#define SIM_RUNGS 16u
#define SIM_TRACE_RUNGS 8u

/* How timestamps are wrong, from model.lie_from to lie_until. */
typedef enum sim_lie {
    SIM_HONEST,
    SIM_TENTH,    /* 0.1 ms, always */
    SIM_LAVAPIPE, /* 0.06 to 0.17 ms, at random: Mesa 22.3 */
    SIM_LOW,      /* 60 % of the true time */
    SIM_FROZEN,   /* the last correct one, repeated */
    SIM_ZERO,
    SIM_NEGATIVE,
    SIM_HUGE, /* 2^64 - 1 */
    SIM_NAN,
    SIM_MICRO, /* microseconds in a field of milliseconds */
    SIM_NANO,
    SIM_SECONDS,
    SIM_GARBAGE /* any of the above, and any bits */
} sim_lie;

/* Times of a recorded scene: one row per frame, one column per scale (lab/simulate/trace.h reads
 * such files). */
typedef struct sim_trace {
    char name[64];
    uint32_t frames, columns;
    double scale[SIM_TRACE_RUNGS]; /* falling */
    double ms[SIM_FRAMES_MOST][SIM_TRACE_RUNGS];
    double budget_ms; /* halfway between the most and the least expensive mean */
} sim_trace;

/* A clock that follows its load: the driver measures the fraction of time in which the GPU is busy,
 * with frames shown at the budget or later. Times of the model are for the highest clock. */
typedef struct sim_dvfs {
    double low, high; /* MHz */
    double up, down;  /* busy fraction: above up the clock rises, below down it falls */
    double step;      /* factor; 0: directly to the highest clock, and down to the clock with a busy
                         fraction halfway between up and down (simple_ondemand of Linux) */
    uint32_t period;  /* frames between two measurements */
} sim_dvfs;

typedef struct sim_model {
    const char *name;
    const char *what; /* one line */
    uint32_t frames;
    uint32_t event; /* the frame from which the settling time is counted */
    double (*load)(const struct sim_model *model, uint32_t frame); /* NULL: a */
    double (*clock)(uint32_t frame);                           /* factor on times; NULL: 1 */
    /* or a clock that depends on the load */
    const sim_dvfs *dvfs;
    double a, b, period;                                       /* parameters of the load */
    double fixed;                                              /* ms; 0: 2 */
    double exponent;                                           /* 0: 2 */
    double noise;                                              /* full width, relative; 0: 0.04 */
    double spikes;    /* fraction of frames that take three times as long */
    double missing;   /* fraction of samples that never arrive */
    double quantum;   /* ms: timestamps are multiples of this */
    uint32_t latency; /* 0: 3 */
    uint32_t rungs;   /* number of rungs; 0: 16, geometric from 1 to 0.4 */
    sim_lie lie;
    uint32_t lie_from, lie_until;
    uint32_t wall;  /* the wall-clock time is available too: true time + 0.3 ms, 2 % noise */
    uint32_t pause; /* from this frame: a time of 10 s, then 200 frames without samples; 0: none */
    const sim_trace *trace; /* instead of fixed and load */
} sim_model;

#define SIM_BUDGET 16.67
#define SIM_SETTLED                                                                              \
    180u /* frames after the event, from which on a constant load should cause no changes */

extern const sim_model sim_models[];
extern const uint32_t sim_model_count;
const sim_model *sim_find(const char *name); /* NULL: no such model */

/* A controller of resolution: times in, a scale out. `state` is large enough for all
 * controllers. */
typedef union sim_state {
    masu_governor governor;
    struct {
        double scale, budget;
        double history[16], integral, error;
        uint32_t count, held, over, frame, settings;
        double level;
    } rival;
} sim_state;

typedef struct sim_controller {
    const char *name;
    void (*init)(sim_state *state, const masu_governor_rung *ladder, uint32_t rungs,
                 double budget);
    void (*sample)(sim_state *state, const masu_governor_sample *sample);
    /* The rung to render at. Controllers with free scales return a value >= rungs, and set
     * *scale. */
    uint32_t (*pick)(sim_state *state, uint64_t frame, double *scale);
} sim_controller;

extern const sim_controller sim_masu; /* the library's governor */

/* One frame of a run. */
typedef struct sim_frame {
    double ms, scale;
    double mhz; /* of a model with dvfs */
    uint32_t rung;
} sim_frame;

typedef struct sim_result {
    uint32_t frames, over, changes;
    uint32_t late_changes; /* from frame event + SIM_SETTLED on */
    double mean_scale;
    int32_t
        settle; /* frames from the event until 30 in a row keep the budget and the scale does not
                       fall; -1: never */
    uint32_t invalid;          /* rungs that do not exist */
    uint32_t most_changes_150; /* in any 150 frames */
} sim_result;

/* `frames` receives model->frames entries, or is NULL; `state` receives the state after the last
 * frame, or is NULL. */
sim_result sim_run(const sim_model *p, const sim_controller *controller, uint64_t seed,
                       sim_frame *frames, sim_state *state);
/* Means over the seeds 1 to `seeds`: frames over the budget and changes of rung. Of the result,
 * only mean_scale is a mean, and `invalid` is the sum. */
sim_result sim_mean(const sim_model *p, const sim_controller *controller, uint32_t seeds,
                    double *over, double *changes);
double sim_budget(const sim_model *p);
/* The rungs of a model; returns their number. */
uint32_t sim_ladder(const sim_model *p, masu_governor_rung out[SIM_RUNGS]);
/* The scale of the largest rung that keeps the budget at maximum noise, given the exact load: the
 * upper bound for any controller. */
double sim_oracle(const sim_model *p);

#endif
