/* ladder.c: see ladder.h. */
#include "settings/ladder.h"

#include <math.h>

static bool measured(masu_ladder_point p) {
    return isfinite(p.time) && p.time > 0.0 && isfinite(p.error) && p.error >= 0.0;
}

bool masu_ladder_dominates(masu_ladder_point a, masu_ladder_point b) {
    return measured(a) && measured(b) && a.time <= b.time && a.error <= b.error &&
           (a.time < b.time || a.error < b.error);
}

/* b is measured. NaN compares as not less and not greater. */
static bool same(masu_ladder_point a, masu_ladder_point b) {
    return measured(a) && !(a.time < b.time) && !(a.time > b.time) && !(a.error < b.error) &&
           !(a.error > b.error);
}

static bool on_front(const masu_ladder_point *points, uint32_t n, uint32_t i) {
    if (!measured(points[i])) return false;
    for (uint32_t k = 0; k < n; k++) {
        if (masu_ladder_dominates(points[k], points[i])) return false;
        if (k < i && same(points[k], points[i])) return false;
    }
    return true;
}

static bool beaten(const masu_ladder_point *points, uint32_t n, const double *costs,
                   uint32_t columns, uint32_t i) {
    for (uint32_t k = 0; k < n; k++) {
        for (uint32_t c = 0; c < columns && fabs(points[k].time) > 0.0; c++) {
            const masu_ladder_point own = {costs[i * columns + c], points[i].error};
            const masu_ladder_point other = {costs[k * columns + c], points[k].error};
            if (masu_ladder_dominates(other, own)) return true;
        }
    }
    return false;
}

void masu_ladder_exclude(masu_ladder_point *points, uint32_t n, const double *costs,
                         uint32_t columns) {
    for (uint32_t i = 0; i < n; i++) {
        bool whole = measured(points[i]);
        for (uint32_t c = 0; c < columns; c++) whole = whole && costs[i * columns + c] > 0.0;
        if (!whole) points[i].time = 0.0;
    }
    for (uint32_t i = 0; i < n; i++) { /* a time below 0: dominated, but still dominates others */
        if (measured(points[i]) && beaten(points, n, costs, columns, i))
            points[i].time = -points[i].time;
    }
    for (uint32_t i = 0; i < n; i++) points[i].time = fmax(points[i].time, 0.0);
}

/* There are a few hundred points at most: all pairs are compared, and sorting is by insertion. */
uint32_t masu_ladder_front(const masu_ladder_point *points, uint32_t n, uint32_t *out) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!on_front(points, n, i)) continue;
        uint32_t at = count++;
        for (; at && points[out[at - 1]].time > points[i].time; at--) out[at] = out[at - 1];
        out[at] = i;
    }
    return count;
}

static uint32_t remove_at(uint32_t *list, uint32_t count, uint32_t at) {
    for (uint32_t i = at + 1; i < count; i++) list[i - 1] = list[i];
    return count - 1;
}

/* The list is in falling quality; the quickest is always kept. */
static uint32_t keep_better(const masu_ladder_point *points, double better, uint32_t *list,
                            uint32_t count) {
    uint32_t first = count - 1;
    for (uint32_t i = count - 1; i-- > 0;) {
        if (better * points[list[i]].error <= points[list[first]].error) list[--first] = list[i];
    }
    for (uint32_t i = first; i < count; i++) list[i - first] = list[i];
    return count - first;
}

uint32_t masu_ladder_rungs(const masu_ladder_point *points, uint32_t n, double apart, double better,
                           uint32_t most, uint32_t *out) {
    uint32_t count = masu_ladder_front(points, n, out);
    if (!count || !most) return 0;
    for (uint32_t i = 0; i < count / 2; i++) { /* falling quality */
        uint32_t first = out[i];
        out[i] = out[count - 1 - i];
        out[count - 1 - i] = first;
    }
    count = keep_better(points, better, out, count);
    uint32_t quickest = out[count - 1], kept = 1;
    for (uint32_t i = 1; i < count; i++) {
        if (points[out[kept - 1]].time >= apart * points[out[i]].time) out[kept++] = out[i];
    }
    if (out[kept - 1] != quickest) { /* it replaces the last ones, except the best */
        while (kept > 1 && points[out[kept - 1]].time < apart * points[quickest].time) kept--;
        if (points[out[kept - 1]].time >= apart * points[quickest].time) out[kept++] = quickest;
    }
    while (kept > most) {
        uint32_t least = kept - 1; /* if most is 2, the best is kept */
        double gap = HUGE_VAL;
        for (uint32_t i = 1; i + 1 < kept; i++) {
            double g = points[out[i - 1]].time / points[out[i + 1]].time;
            if (g < gap) {
                gap = g;
                least = i;
            }
        }
        kept = remove_at(out, kept, least);
    }
    return kept;
}
