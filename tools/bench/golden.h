/* golden.h: compares static images of the rungs, 128x72 in linear light, with a reference; writes
 * reference.csv to the folder. */
#ifndef MASU_BENCH_GOLDEN_H
#define MASU_BENCH_GOLDEN_H

#include "bench/sweep.h"

/* Call it after a sweep. path: a stored reference (.ref) of the scene at desc->time, or PFM or
 * OpenEXR. Adds the messages of the validation layer to *messages. On false `error` holds one
 * line. */
bool masu_golden_rungs(const masu_sweep_desc *desc, const char *path, uint32_t *messages,
                       char *error, size_t error_size);

#endif
