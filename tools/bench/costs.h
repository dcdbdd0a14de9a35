/* costs.h: reads costs.csv of a folder of `masu bench`: the costs of its settings on classes of
 * GPUs, computed by a cost model (masu-lab ladder --costs). A header, then a row per setting,
 * including the base: its name and a number per class, all in the same unit. If the file exists,
 * rungs are chosen by costs instead of times, and a setting that is dominated on one of the classes
 * cannot be a rung. */
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
