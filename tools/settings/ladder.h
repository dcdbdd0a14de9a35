/* ladder.h: which of many measured settings are worth having: the Pareto front of time and
 * error, and a ladder of rungs out of it.
 *
 * Pure functions of their arguments; nothing allocates, nothing fails. A point whose time is not
 * finite and above 0, or whose error is not finite or is below 0, is no measurement: it is never
 * chosen and beats nothing. */
#ifndef MASU_SETTINGS_LADDER_H
#define MASU_SETTINGS_LADDER_H

#include <stdbool.h>
#include <stdint.h>

/* Nearer in time than that two rungs are one: dynamic resolution of known engines ignores changes
 * of 2 to 5 %, and a measured minimum is hardly steadier. */
#define MASU_LADDER_APART 1.04

/* Less than that much better in error than what is quicker is no reason to take longer: noise of
 * reflections alone makes more. */
#define MASU_LADDER_BETTER 1.01

/* Mean difference of successive frames at rest, of 255, by which a rung may be worse than the base. */
#define MASU_LADDER_FLICKER 0.5

/* Mean change at rest from one rung to the next, of 255: a larger one is seen as a jump. */
#define MASU_LADDER_STEP 3.0

typedef struct masu_ladder_point {
    double time, error; /* in any units; less is better */
} masu_ladder_point;

/* a is at least as good in both and better in one. */
bool masu_ladder_dominates(masu_ladder_point a, masu_ladder_point b);

/* Points that also have `columns` costs each, costs[point * columns + column]: those that another
 * one dominates by one of the columns, and those with a cost that is not above 0, lose their time,
 * and are no measurement. In every column the cost of those that are left then falls as the error
 * rises. */
void masu_ladder_exclude(masu_ladder_point *points, uint32_t n, const double *costs,
                         uint32_t columns);

/* Indices of the points that no other dominates, by rising time and falling error; of equal points
 * the first. `out` has room for n. Returns how many there are. */
uint32_t masu_ladder_front(const masu_ladder_point *points, uint32_t n, uint32_t *out);

/* Of the front, without the points of which a quicker one that stays has less than `better` times the
 * error, in falling quality (falling time, rising error): at most `most` points, each at least
 * `apart` times as long as the next. Of what that leaves the best is always one; the quickest is, if it
 * is that far from the best. Between them those go first that leave the least gap. `out` has room
 * for n. */
uint32_t masu_ladder_rungs(const masu_ladder_point *points, uint32_t n, double apart, double better,
                           uint32_t most, uint32_t *out);

#endif
