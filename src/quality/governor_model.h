/* governor_model.h: the state of a governor, and its model of frame times. governor.h has the rules
 * that use it. */
#ifndef MASU_GOVERNOR_MODEL_H
#define MASU_GOVERNOR_MODEL_H

#include "quality/pacing.h"
#include "quality/spikes.h"
#include "quality/survey.h"
#include "quality/trust.h"

#define MASU_GOVERNOR_RUNGS 16u
/* Deviations of one sample that a rung is chosen with. */
#define MASU_GOVERNOR_MARGIN 2.5
#define MASU_GOVERNOR_TRIAL 12u /* frames for which a better rung is tried */

typedef struct masu_governor_rung {
    double scale; /* render size / output size */
    double cost;  /* of the part that depends on the rung, beside the others; 0: scale^2 */
} masu_governor_rung;

typedef struct masu_governor {
    /* The description, every default filled in. */
    masu_governor_mode mode;
    double asked; /* target, as described; */
    double target, headroom; /* and as whole refreshes allow it */
    uint32_t best, worst, fixed_rung, dwell, count;
    double scale[MASU_GOVERNOR_RUNGS], prior[MASU_GOVERNOR_RUNGS];

    /* What is known of each rung: its cost as measured, and the variance of its relative error. */
    double cost[MASU_GOVERNOR_RUNGS], cost_variance[MASU_GOVERNOR_RUNGS];

    /* The filter: fixed part, load at cost 1, its change per frame; covariances of the three. */
    double fixed, load, slope, p[3][3];
    double noise; /* of one sample, relative standard deviation */
    double trend; /* mean of the last innovations in deviations: far from 0 when the load moves */
    uint32_t noise_samples;
    double grain, repeats,
        raw;          /* step of a coarse timer, ms; how often a time comes again; the last */
    double before[2]; /* the last samples of a run at one rung, for the noise */
    uint32_t before_rung, before_count;
    int known;       /* the filter has a state */
    uint32_t fitted; /* rung of the last sample that was not odd */
    uint64_t newest; /* frame of the last sample that was used */
    uint64_t last; /* frame of the last sample that was given; one is rejected if it is not newer */
    uint64_t since; /* samples of frames before it are of another output size */
    int any, warm; /* a sample has been given, has been dropped as the first */
    uint64_t cut;  /* the first sample from this frame on is taken as it is; UINT64_MAX: none */

    /* Samples far from what was expected, waiting for others that say the same. */
    uint32_t odd_count;
    int odd_sign;
    double odd_load;

    masu_trust trust;
    masu_pacing pacing;
    masu_survey survey;
    masu_spikes spikes;

    /* The decision. */
    uint32_t rung;
    uint64_t frame, changed; /* last frame asked for; first frame of this rung */
    uint64_t held_before; /* frames that the rung was held for in another renderer */
    int urged; /* what was asked has changed: the next rise need not wait for the dwell; 2: for nothing */
    int started;
    int jumped;      /* the load has just been found elsewhere */
    uint32_t misses; /* samples in a row of this rung that were over the target */
    uint32_t
        patience; /* rising takes this many times the dwell: doubles when a rise was a mistake */
    uint64_t restless;                       /* frame in which the load moved last */
    double raised_load, load_low, load_high; /* at the last rise; least and most since */
    double raised_ms, failed_ms; /* of its rung: as expected, as found when it was taken back */
    double mistake_load;
    double penalty[MASU_GOVERNOR_RUNGS];
    uint32_t raised_rung;
    int failed;          /* the last rise was taken back */
    int rising;          /* the last change was a rise */
    double settled_load; /* < 0: not settled */
    /* Whether the clock follows the load: tried by drawing at a better rung that does not fit yet. */
    int steady_clock; /* the host says that it does not */
    int follows;      /* it did when it was tried */
    int trial;        /* the rung is one, and this was drawn before: */
    uint32_t trial_from, trials; /* failures since one that did not */
    uint64_t trial_ended;
    double trial_load, trial_ms; /* load when the last ended; what it was expected to take */
    double seen_ms; /* of the first frame after a rise, if it was over the target; its frame and rung */
    uint64_t seen_frame;
    uint32_t seen_rung;
    masu_governor_reason reason;
    masu_governor_lock lock;
    uint64_t samples, rejected, missed, changes;
} masu_governor;

void masu_governor_sample_in(masu_governor *g, const masu_governor_sample *sample);
/* What a frame now would take at a rung, ms; 0: nothing is known yet. */
double masu_governor_predict(const masu_governor *g, uint32_t rung);
/* What a frame `lead` frames past the newest sample takes at a rung, and `margin` deviations more.
 * falls: a load that falls is followed too; else it is taken as it is. */
double masu_governor_upper(const masu_governor *g, uint32_t rung, double lead, int falls,
                           double margin);
/* Frames from the newest sample to this one, as far as a slope is followed. */
double masu_governor_lead(const masu_governor *g, uint64_t frame);
/* 0: the load is at rest; 1: it moves for certain. */
double masu_governor_moves(const masu_governor *g);
/* The model before the first sample. */
void masu_governor_model_init(masu_governor *g);

#endif
