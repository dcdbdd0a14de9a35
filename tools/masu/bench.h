/* bench.h: the parts of `masu bench` besides measuring. */
#ifndef MASU_CMD_BENCH_H
#define MASU_CMD_BENCH_H

#include "masu/cmd.h"
#include "masu/options.h"

/* --ladder FILE...: prints ladders; with `c`, each file being CLASS=FILE, as the table that the library
 * is built with. An exit code. */
int masu_bench_ladder(const masu_given *given, bool c);

#endif
