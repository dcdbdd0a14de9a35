/* plot.h: the plots of `masu bench`: error against time, drawn by gnuplot as SVG.
 *
 * Points and commands go to plots/ in the folder, so that they can be drawn again otherwise.
 * gnuplot is run as a child process without a shell; where there is none, there are no plots, and
 * that is no failure. */
#ifndef MASU_BENCH_PLOT_H
#define MASU_BENCH_PLOT_H

#include "bench/table.h"

/* What is drawn: the rows, their place in time (as the ladder has it), and the ladder. */
typedef struct masu_plot {
    const char *folder, *title, *clock; /* clock: "wall clock" or "timestamps" */
    const masu_row *rows;
    const double *ratios; /* of each row */
    uint32_t row_count;
    const uint32_t *rungs, *front; /* rows; rungs in falling quality */
    uint32_t rung_count, front_count;
} masu_plot;

/* plots/front.svg and plots/techniques.svg. drawn: they are there. False: `error` has a line. */
bool masu_plot_draw(const masu_plot *plot, bool *drawn, char *error, size_t error_size);

#endif
