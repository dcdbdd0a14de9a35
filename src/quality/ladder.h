/* ladder.h: quality ladders that were measured in advance, one per class of scenes. Constant tables
 * (ladder_tables.h, written by `make ladders`) and pure functions; cannot fail. */
#ifndef MASU_LADDER_H
#define MASU_LADDER_H

#include "masu.h"
#include "quality/device_class.h"

/* A class without a measurement has a count of 0. */
typedef struct masu_ladder {
    const char *from; /* scene, size, driver and date of the measurement */
    uint32_t count;
    masu_rung rungs[MASU_MAX_RUNGS];
    /* cost / cost of the base setting, mean over GPU classes; descending */
    float ratios[MASU_MAX_RUNGS];
    float flips[MASU_MAX_RUNGS]; /* mean FLIP against the ground truth; ascending */
} masu_ladder;

/* The ladder of a class; never NULL. */
const masu_ladder *masu_ladder_of_class(masu_scene_class scene_class);

/* The ladder of the scene's class, or of the most similar class that has one; NULL if no class
 * has. */
const masu_ladder *masu_ladder_for(const masu_scene *scene);

/* Index, in the ladder, of its nth rung that has all features of `keep`, MASU_KEEP_*; count if
 * there is none. */
uint32_t masu_ladder_kept(const masu_ladder *l, uint32_t keep, uint32_t nth);

/* The features of `keep` that a rung disables. */
uint32_t masu_rung_drops(const masu_rung *rung, uint32_t keep);

/* Relative costs of the rungs on GPUs of a class, in the unit of `ratios`: computed from the
 * instructions that the compiler of that class emits. `ratios` are their geometric mean, relative
 * to the base setting. NULL if there are none. */
const float *masu_ladder_costs_on(const masu_scene *scene, masu_device_class device_class);

/* Resolves desc->ladder. If the ladder is used, fills rungs, flips, and the costs that are 0. */
void masu_ladder_defaults(masu_desc *desc);

#endif
