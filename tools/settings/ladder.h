/* ladder.h: selects rungs from measured settings: the Pareto front of time and error, thinned to a
 * quality ladder.
 *
 * Pure functions that do not allocate and cannot fail. A point is not a measurement if its time is
 * not finite and above 0, or its error is not finite or is below 0. Such a point is never selected
 * and dominates nothing. */
#ifndef MASU_SETTINGS_LADDER_H
#define MASU_SETTINGS_LADDER_H

#include <stdbool.h>
#include <stdint.h>

/* Smallest ratio of the times of two rungs: dynamic resolution of known engines ignores changes of
 * 2 to 5 %, and measured times are hardly more precise. */
#define MASU_LADDER_APART 1.04

/* Smallest ratio by which a slower rung must have a lower error: noise of reflections causes larger
 * differences. */
#define MASU_LADDER_BETTER 1.01

/* Flicker (mean difference of successive static frames, of 255) by which a rung may exceed the
 * base. */
#define MASU_LADDER_FLICKER 0.5

/* Mean change of a static image from one rung to the next, of 255: a larger one is a visible
 * jump. */
#define MASU_LADDER_STEP 3.0

typedef struct masu_ladder_point {
    double time, error; /* in any units; less is better */
} masu_ladder_point;

/* a is at least as good as b in both, and better in one. */
bool masu_ladder_dominates(masu_ladder_point a, masu_ladder_point b);

/* Each point also has `columns` costs, costs[point * columns + column]. Sets the time of a point to
 * 0, so that it is no measurement, if another point dominates it in one of the columns, or if one
 * of its costs is not above 0. For the remaining points the cost falls in every column as the error
 * rises. */
void masu_ladder_exclude(masu_ladder_point *points, uint32_t n, const double *costs,
                         uint32_t columns);

/* Writes the indices of the points that no other point dominates, by rising time and falling error;
 * of equal points, the first. `out` has room for n. Returns their number. */
uint32_t masu_ladder_front(const masu_ladder_point *points, uint32_t n, uint32_t *out);

/* Writes at most `most` points of the front in falling quality (falling time, rising error), and
 * returns their number. Skips a point if a quicker one has less than `better` times its error. Each
 * point takes at least `apart` times as long as the next. The best point is always selected, and so
 * is the quickest if it is far enough from the best. If there are too many, the points between them
 * with the smallest gap are removed first. `out` has room for n. */
uint32_t masu_ladder_rungs(const masu_ladder_point *points, uint32_t n, double apart, double better,
                           uint32_t most, uint32_t *out);

#endif
