/* governor.h: frame times in, a rung of the ladder out. A pure function of its own state: no clock,
 * no Vulkan, no allocation; sqrt and arithmetic of doubles alone, so that every machine decides
 * alike.
 *
 *   masu_governor_init(&g, &desc, rungs, count);
 *   for each frame:
 *       masu_governor_sample_in(&g, &sample);   what is known by then, of frames long submitted
 *       rung = masu_governor_pick(&g, frame);
 *
 * The model is   ms = fixed + cost[rung] * load   with the load moving by `slope` each frame. Fixed
 * part, load and slope are the state of a Kalman filter; costs begin at the prior (scale^2) and are
 * corrected by what each rung has measured. docs/design/35-governor.md has laws and measurements.
 *
 * Any sample may be given: what cannot be a frame's time is left out, and the rung handed out is
 * one of best .. worst whatever comes in. */
#ifndef MASU_GOVERNOR_H
#define MASU_GOVERNOR_H

#include "masu.h"

#define MASU_GOVERNOR_RUNGS 16u

typedef struct masu_governor_rung {
    double scale; /* render size / output size */
    double cost;  /* of the part that depends on the rung, beside the others; 0: scale^2 */
} masu_governor_rung;

/* One finished frame. What is not known is 0, negative or NaN. */
typedef struct masu_governor_sample {
    uint64_t frame;  /* samples come in rising order; others are left out */
    uint32_t rung;   /* that it was drawn at */
    double gpu_ms;   /* by timestamps */
    double wall_ms;  /* by the host's clock: from its submit, or the end of the previous frame if that
                       was later, to its end */
    double fixed_ms; /* of gpu_ms: passes whose cost does not follow the rung */
} masu_governor_sample;

typedef struct masu_governor {
    /* The description, every default filled in. */
    masu_governor_mode mode;
    double target, headroom;
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
    int any, warm; /* a sample has been given, has been dropped as the first */
    uint64_t cut;  /* the first sample from this frame on is taken as it is; UINT64_MAX: none */

    /* Samples far from what was expected, waiting for others that say the same. */
    uint32_t odd_count;
    int odd_sign;
    double odd_load;

    /* Trust. */
    masu_governor_source source;
    double overhead; /* wall - gpu, ms, where both are believed */
    int overhead_known;
    double distrust; /* rises with each GPU time that the wall contradicts */
    int wall_only;
    double unit, unit_try; /* what GPU times are multiplied by */
    uint32_t unit_count, unit_bad;
    double frozen_gpu, frozen_wall;
    uint32_t frozen, frozen_rung;

    /* The decision. */
    uint32_t rung;
    uint64_t frame, changed; /* last frame asked for; first frame of this rung */
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
    masu_governor_reason reason;
    masu_governor_lock lock;
    uint64_t samples, rejected, missed, changes;
} masu_governor;

/* Fills what is 0 with defaults; without a governor nothing. */
void masu_governor_defaults(masu_governor_desc *desc, uint32_t rungs);
/* Out-of-range fields of `desc` count as 0; a count of 0 or above MASU_GOVERNOR_RUNGS is
 * clamped. */
void masu_governor_init(masu_governor *g, const masu_governor_desc *desc,
                        const masu_governor_rung *rungs, uint32_t count);
void masu_governor_sample_in(masu_governor *g, const masu_governor_sample *sample);
/* The rung for a frame; asked for again, the same one. */
uint32_t masu_governor_pick(masu_governor *g, uint64_t frame);
/* The host draws this frame at a rung of its own choice. */
void masu_governor_override(masu_governor *g, uint64_t frame, uint32_t rung);
/* From this frame on the picture has nothing to do with the one before: so may its cost. */
void masu_governor_cut(masu_governor *g, uint64_t frame);
/* What a frame now would take at a rung, ms; 0: nothing is known yet. */
double masu_governor_predict(const masu_governor *g, uint32_t rung);
void masu_governor_report(const masu_governor *g, masu_governor_info *out);

#endif
