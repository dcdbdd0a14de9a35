/* costs.h: costs.csv of a folder of `masu bench`: what its settings cost on classes of GPUs, as a
 * cost model computes it (masu-lab ladder --costs). A header, then a row per setting: its name and
 * a number per class, in any unit that the rows share, the base's among them. Where the file
 * exists, rungs are chosen by it instead of by times, and a setting that another one dominates on
 * one of the classes is no rung. */
#ifndef MASU_BENCH_COSTS_H
#define MASU_BENCH_COSTS_H

#include "bench/table.h"

#define MASU_COSTS "costs.csv"
#define MASU_COSTS_HEADER "setting,xe80,uhd620,vega8,deck,mobile"
#define MASU_COSTS_CLASSES 5u

/* out: MASU_COSTS_CLASSES per row, 0 for rows without costs. *there: whether the folder has the
 * file; without it `out` is not written. False: `error` holds one line. */
bool masu_costs_read(const char *folder, const masu_row *rows, uint32_t count, double *out,
                     bool *there, char *error, size_t error_size);

#endif
