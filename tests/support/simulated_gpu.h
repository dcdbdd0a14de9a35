/* simulated_gpu.h: simulated GPUs and scenes, on which a controller of resolution is run.
 * Deterministic: a model, a controller and a seed give the same frames with every compiler. The
 * governor's tests use them, and so does `masu-lab simulate`, which has other engines' controllers
 * and recorded traces (lab/simulate).
 *
 *   true ms = clock(f) * (fixed + load(f) * s^exponent) * (1 + noise * (u - 0.5))
 *
 * u is uniform in 0..1. A sample of frame f is known when frame f + latency is decided. */
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

/* How timestamps lie, from model.lie_from to lie_until. */
typedef enum sim_lie {
    SIM_HONEST,
    SIM_TENTH,    /* 0.1 ms, whatever it was */
    SIM_LAVAPIPE, /* 0.06 to 0.17 ms, at random: Mesa 22.3 */
    SIM_LOW,      /* 60 % of the truth */
    SIM_FROZEN,   /* the last honest one, for ever */
    SIM_ZERO,
    SIM_NEGATIVE,
    SIM_HUGE, /* 2^64 - 1 */
    SIM_NAN,
    SIM_MICRO, /* microseconds in a field of milliseconds */
    SIM_NANO,
    SIM_SECONDS,
    SIM_GARBAGE /* any of these, and any bits */
} sim_lie;

/* Times of a recorded scene: a row per frame, a column per scale (lab/simulate/trace.h reads
 * one). */
typedef struct sim_trace {
    char name[64];
    uint32_t frames, columns;
    double scale[SIM_TRACE_RUNGS]; /* falling */
    double ms[SIM_FRAMES_MOST][SIM_TRACE_RUNGS];
    double budget_ms; /* halfway between its dearest and cheapest mean */
} sim_trace;

/* A clock that follows its own load: the driver looks at the part of the time that the GPU was busy for,
 * frames being shown at the budget or later. Times of the model are those at the highest clock. */
typedef struct sim_dvfs {
    double low, high; /* MHz */
    double up, down;  /* busy: above up the clock rises, below down it falls */
    double step;      /* factor; 0: to the highest at once, and down to where it would be busy in the
                         middle of the two (simple_ondemand of Linux) */
    uint32_t period;  /* frames from one look to the next */
} sim_dvfs;

typedef struct sim_model {
    const char *name;
    const char *what; /* one line */
    uint32_t frames;
    uint32_t event; /* the frame from which settling is counted */
    double (*load)(const struct sim_model *model, uint32_t frame); /* NULL: a */
    double (*clock)(uint32_t frame);                           /* factor on times; NULL: 1 */
    const sim_dvfs *dvfs;                                      /* or a clock of its own */
    double a, b, period;                                       /* of the load */
    double fixed;                                              /* ms; 0: 2 */
    double exponent;                                           /* 0: 2 */
    double noise;                                              /* full width, relative; 0: 0.04 */
    double spikes;    /* part of frames that take three times as long */
    double missing;   /* part of samples that never arrive */
    double quantum;   /* ms: timestamps are multiples of it */
    uint32_t latency; /* 0: 3 */
    uint32_t rungs;   /* of the ladder: 0: 16, geometric from 1 to 0.4 */
    sim_lie lie;
    uint32_t lie_from, lie_until;
    uint32_t wall;  /* the host's clock is known too: truth + 0.3 ms, 2 % of noise */
    uint32_t pause; /* at this frame: a time of 10 s, then 200 frames without samples; 0: none */
    const sim_trace *trace; /* instead of fixed and load */
} sim_model;

#define SIM_BUDGET 16.67
#define SIM_SETTLED                                                                              \
    180u /* frames after the event: from then on a constant load is no reason to change */

extern const sim_model sim_models[];
extern const uint32_t sim_model_count;
const sim_model *sim_find(const char *name); /* NULL: there is none */

/* A controller of resolution: times in, a scale out. `state` has room for any of them. */
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
    /* The rung to draw at, or, of a controller with scales of its own, rungs + any: then *scale. */
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

/* `frames` takes model->frames of them, or NULL; `state` is left as it is after the last one, or
 * NULL. */
sim_result sim_run(const sim_model *p, const sim_controller *controller, uint64_t seed,
                       sim_frame *frames, sim_state *state);
/* The mean of runs with the seeds 1 to `seeds`: frames over the budget, changes of rung, and of the
 * result only mean_scale; `invalid` is the sum. */
sim_result sim_mean(const sim_model *p, const sim_controller *controller, uint32_t seeds,
                    double *over, double *changes);
double sim_budget(const sim_model *p);
/* The ladder of a model; returns how many rungs. */
uint32_t sim_ladder(const sim_model *p, masu_governor_rung out[SIM_RUNGS]);
/* The largest rung's scale that keeps the budget with all the noise there may be, and knows the
 * load: what nobody can beat. */
double sim_oracle(const sim_model *p);

#endif
