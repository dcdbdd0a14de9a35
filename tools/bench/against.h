/* against.h: two folders of `masu bench`, of the same scene and settings but of other runs,
 * days or drivers: whether the rungs of the one have the same error and time ratio in the other.
 *
 * Which rungs is the first folder's ladder.json. Ratios are of one clock for both: timestamps, if
 * both ladders go by them, else the wall's. Pure but for reading the folders; what fails writes one
 * line to `error`. */
#ifndef MASU_BENCH_AGAINST_H
#define MASU_BENCH_AGAINST_H

#include "bench/table.h"

#include "masu.h"

typedef struct masu_against_rung {
    char setting[MASU_SETTING_ID];
    bool here, there;          /* it has a row; numbers below are of those that have both */
    double flip[2], ratio[2];  /* here, there */
    double flip_off, time_off; /* here / there - 1; 0 of two zeros */
} masu_against_rung;

typedef struct masu_against {
    masu_against_rung rungs[MASU_MAX_RUNGS];
    uint32_t count, missing;
    uint32_t worst_flip, worst_time; /* of rungs; count: there is none */
    bool by_timestamps;
} masu_against;

/* Both are of one scene, size, time and truth. False: `error` says what is not. */
bool masu_against_same(const char *here, const char *there, char *error, size_t error_size);

/* False: a file is not there or bad, or the folders are of another scene, size, time or truth. */
bool masu_against_compare(const char *here, const char *there, masu_against *out, char *error,
                          size_t error_size);

/* here / there - 1; 0 of two zeros. */
double masu_against_off(double here, double there);

/* The table as text, or as CSV. Below 0: it could not be written. */
int masu_against_print(FILE *f, const masu_against *a, bool csv);

#endif
