/* bench.h: parts of `masu bench` other than measuring. */
#ifndef MASU_CMD_BENCH_H
#define MASU_CMD_BENCH_H

#include "masu/cmd.h"
#include "command/options.h"

/* --ladder FILE...: prints ladders. Returns an exit code. */
int masu_bench_ladder(const masu_given *given);

#endif
