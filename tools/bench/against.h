/* against.h: compares two folders of `masu bench` for the same scene and settings, measured in
 * different runs or on different drivers: whether the rungs of one have the same error and time
 * ratio in the other.
 *
 * The rungs are those in the first folder's ladder.json. Both sides use the same clock: timestamps
 * if both ladders use them, otherwise the wall clock. Functions only read the folders; on failure
 * they write one line to `error`. */
#ifndef MASU_BENCH_AGAINST_H
#define MASU_BENCH_AGAINST_H

#include "bench/table.h"

#include "masu.h"

typedef struct masu_against_rung {
    char setting[MASU_SETTING_ID];
    bool here, there;          /* it has a row; the numbers below need both */
    double flip[2], ratio[2];  /* here, there */
    double flip_off, time_off; /* here / there - 1; 0 if both are zero */
} masu_against_rung;

typedef struct masu_against {
    masu_against_rung rungs[MASU_MAX_RUNGS];
    uint32_t count, missing;
    uint32_t worst_flip, worst_time; /* rungs with the largest change; count: none */
    bool by_timestamps;
} masu_against;

/* Whether both folders have the same scene, size, time and ground truth. On false `error` names the
 * difference. */
bool masu_against_same(const char *here, const char *there, char *error, size_t error_size);

/* Returns false if a file is missing or invalid, or if scene, size, time or ground truth differ. */
bool masu_against_compare(const char *here, const char *there, masu_against *out, char *error,
                          size_t error_size);

/* here / there - 1; 0 if both are zero. */
double masu_against_off(double here, double there);

/* Prints the table as text or CSV. Returns a negative value if writing failed. */
int masu_against_print(FILE *f, const masu_against *a, bool csv);

#endif
