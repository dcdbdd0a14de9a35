/* plot.h: the plots of `masu bench`: error against time, drawn by gnuplot as SVG.
 *
 * Points and commands are written to plots/ in the folder, so that plots can be changed and drawn
 * again. gnuplot runs as a child process without a shell. Without gnuplot there are no plots, which
 * is not an error. */
#ifndef MASU_BENCH_PLOT_H
#define MASU_BENCH_PLOT_H

#include "bench/table.h"

/* The input: rows, their times as used by the ladder, and the ladder. */
typedef struct masu_plot {
    const char *folder, *title, *clock; /* clock: "wall clock" or "timestamps" */
    const masu_row *rows;
    const double *ratios; /* one per row */
    uint32_t row_count;
    const uint32_t *rungs, *front; /* row indices; rungs in descending quality */
    uint32_t rung_count, front_count;
} masu_plot;

/* Draws plots/front.svg and plots/techniques.svg. *drawn: they exist. On false `error` holds one
 * line. */
bool masu_plot_draw(const masu_plot *plot, bool *drawn, char *error, size_t error_size);

#endif
