/* ladder.h: quality ladders that were measured beforehand, one per class of scenes. Constant tables
 * (ladder_tables.h, which `make ladders` writes) and pure functions of their arguments: nothing is
 * owned, nothing fails. */
#ifndef MASU_LADDER_H
#define MASU_LADDER_H

#include "masu.h"
#include "quality/device_class.h"

/* A class without a measurement has a count of 0. */
typedef struct masu_ladder {
    const char *from; /* scene, size, driver and date of the measurement */
    uint32_t count;
    masu_rung rungs[MASU_MAX_RUNGS];
    /* cost / the base setting's, a mean over classes of GPUs; falling */
    float ratios[MASU_MAX_RUNGS];
    float flips[MASU_MAX_RUNGS];  /* mean FLIP against the truth; rising */
} masu_ladder;

/* The class's own; never NULL. */
const masu_ladder *masu_ladder_of_class(masu_scene_class scene_class);

/* That of the scene's class, or of the nearest class that has one; NULL: no class has. */
const masu_ladder *masu_ladder_for(const masu_scene *scene);

/* The number in the ladder of its nth rung that has all features of `keep`, MASU_KEEP_*; count:
 * there is none. */
uint32_t masu_ladder_kept(const masu_ladder *l, uint32_t keep, uint32_t nth);

/* The features of `keep` that a rung disables. */
uint32_t masu_rung_drops(const masu_rung *rung, uint32_t keep);

/* The costs of its rungs on GPUs of a class, beside each other, as ratios are: computed of the instructions
 * that the class's own compiler makes; ratios are their geometric mean, relative to the base
 * setting. NULL: nobody has computed them. */
const float *masu_ladder_costs_on(const masu_scene *scene, masu_device_class device_class);

/* Decides desc->ladder, and fills rungs, flips and those costs that are 0 where the ladder is
 * taken. */
void masu_ladder_defaults(masu_desc *desc);

#endif
