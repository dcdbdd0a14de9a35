/* governor_model.h: the state of a governor, and its model of frame times. governor.h has the rules
 * that use it. */
#ifndef MASU_GOVERNOR_MODEL_H
#define MASU_GOVERNOR_MODEL_H

#include "quality/pacing.h"
#include "quality/spikes.h"
#include "quality/survey.h"
#include "quality/trust.h"

#define MASU_GOVERNOR_RUNGS MASU_SURVEY_RUNGS
/* Deviations of one sample: margin for selecting a rung. White noise exceeds it in less than one of
 * 100 frames. */
#define MASU_GOVERNOR_MARGIN 2.5
/* Frames after a rise in which the new rung is judged: a few slow clocks' measurement periods. */
#define MASU_GOVERNOR_TRIAL 12u
/* Frames: shortest stay on a rung, longest extrapolation, unconfirmed outliers that must agree.
 * More than the delay of samples, and too short to be noticed. */
#define MASU_GOVERNOR_HOLD 8u
/* Largest exponent of back-off: waits grow up to 64 times, half a minute for 24 frames. */
#define MASU_GOVERNOR_DOUBLINGS 6u
/* Relative deviation of a sample: the best that timers achieve, and more than any usable clock. */
#define MASU_GOVERNOR_NOISE_LEAST 0.003
#define MASU_GOVERNOR_NOISE_MOST 0.5

typedef struct masu_governor_rung {
    double scale; /* render size / output size */
    double cost;  /* relative cost of the part that depends on the rung; 0: scale^2 */
} masu_governor_rung;

typedef struct masu_governor {
    /* The description with all defaults. */
    masu_governor_mode mode;
    double asked;            /* the target in the description; */
    double target, headroom; /* rounded to whole refreshes */
    uint32_t best, worst, fixed_rung, dwell, count;
    double scale[MASU_GOVERNOR_RUNGS], prior[MASU_GOVERNOR_RUNGS];

    /* Per rung: measured cost, and the variance of its relative error. */
    double cost[MASU_GOVERNOR_RUNGS], cost_variance[MASU_GOVERNOR_RUNGS];

    /* The filter: fixed cost, load at cost 1, its change per frame; their covariances. */
    double fixed, load, slope, p[3][3];
    double noise; /* relative standard deviation of a sample */
    double trend; /* mean of the last innovations, in deviations: far from 0 if the load changes */
    uint32_t noise_samples;
    double grain, repeats,
        raw;          /* step of a coarse timer, ms; repetitions of a time; the last time */
    double before[2]; /* last consecutive samples at one rung, for the noise */
    uint32_t before_rung, before_count;
    int known;       /* the filter is initialised */
    uint32_t fitted; /* rung of the last sample that was no outlier */
    uint64_t newest; /* frame of the last sample used */
    uint64_t last;   /* frame of the last sample given; older samples are ignored */
    uint64_t since;  /* samples of earlier frames have another output size */
    int any, warm;   /* a sample was given; the first one was dropped */
    uint64_t cut;    /* the first sample from this frame on restarts the filter; UINT64_MAX: none */

    /* Outliers, until enough agree. */
    uint32_t odd_count;
    int odd_sign;
    double odd_load;

    masu_trust trust;
    masu_pacing pacing;
    masu_survey survey;
    masu_spikes spikes;

    /* The decision. */
    uint32_t rung;
    uint64_t frame, changed; /* last frame requested; first frame of this rung */
    uint64_t held_before;    /* frames at this rung in an earlier renderer */
    /* settings have changed: the next rise need not wait for the dwell; 2: need not wait at all */
    int urged;
    int started;
    int jumped;      /* the load has just jumped */
    uint32_t misses; /* consecutive samples of this rung over the target */
    uint32_t
        patience; /* back-off: factor on the dwell before a rise; doubles with each failed rise */
    uint64_t restless;                       /* frame of the last change of the load */
    double raised_load, load_low, load_high; /* at the last rise; minimum and maximum since */
    double raised_ms, failed_ms; /* of its rung: predicted, and measured when it was undone */
    double mistake_load;
    double penalty[MASU_GOVERNOR_RUNGS];
    uint32_t raised_rung;
    int failed;          /* the last rise was undone */
    int rising;          /* the last change was a rise */
    double settled_load; /* < 0: not settled */
    /* Whether the clock follows the load, found by trials of a better rung that does not fit
     * yet. */
    int steady_clock;            /* the host guarantees that it does not */
    int follows;                 /* a trial has shown that it does */
    int trial;                   /* the rung is on trial; the one before it: */
    uint32_t trial_from, trials; /* failures since the last success */
    uint64_t trial_ended;
    double trial_load, trial_ms; /* load at the end of the last trial; its predicted time */
    /* time of the first frame after a rise, if over the target; its frame and rung */
    double seen_ms;
    uint64_t seen_frame;
    uint32_t seen_rung;
    masu_governor_reason reason;
    masu_governor_lock lock;
    uint64_t samples, rejected, missed, changes;
} masu_governor;

void masu_governor_sample_in(masu_governor *g, const masu_governor_sample *sample);
/* Predicted time of a frame at present at a rung, ms; 0: no samples yet. */
double masu_governor_predict(const masu_governor *g, uint32_t rung);
/* Predicted time of a frame `lead` frames after the newest sample at a rung, plus `margin`
 * deviations. falls: extrapolate a falling load too; otherwise only a rising one. */
double masu_governor_upper(const masu_governor *g, uint32_t rung, double lead, int falls,
                           double margin);
/* Frames from the newest sample to this frame, at most MASU_GOVERNOR_HOLD. */
double masu_governor_lead(const masu_governor *g, uint64_t frame);
/* 0: steady load; 1: certainly changing load. */
double masu_governor_moves(const masu_governor *g);
/* Initialises the model. */
void masu_governor_model_init(masu_governor *g);

#endif
