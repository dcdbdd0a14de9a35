/* golden.h: stills of the rungs at rest, 128x72 in linear light, judged by a reference:
 * reference.csv in the folder. */
#ifndef MASU_BENCH_GOLDEN_H
#define MASU_BENCH_GOLDEN_H

#include "bench/sweep.h"

/* After a sweep. path: a stored reference (.ref) of the scene at desc->time, or PFM or OpenEXR.
 * messages: adds those of the validation layer. False: one line in `error`. */
bool masu_golden_rungs(const masu_sweep_desc *desc, const char *path, uint32_t *messages,
                       char *error, size_t error_size);

#endif
