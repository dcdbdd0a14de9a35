/* trace.h: reads the recorded frame times of a scene: CSV from `masu-lab simulate --record`, with a
 * line "frame,1,0.88,..." of scales, then one line per frame. */
#ifndef LAB_TRACE_H
#define LAB_TRACE_H

#include "support/simulated_gpu.h"

#include <stdio.h>

/* On false, `error` holds the reason. `path` is for messages and for the name of a parsed file. */
bool sim_trace_parse(FILE *file, const char *path, sim_trace *out, char *error, size_t error_size);
bool sim_trace_read(const char *path, sim_trace *out, char *error, size_t error_size);
sim_model sim_of_trace(const sim_trace *trace);

#endif
