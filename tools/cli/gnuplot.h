/* gnuplot.h: runs gnuplot for the plots of all programs.
 *
 * Our own texts and texts from files or users (a title, a name, a folder) must be inserted into
 * commands by masu_gnuplot_quote and into data by masu_gnuplot_label: within double quotes and
 * outside quotes gnuplot executes text in backticks. */
#ifndef MASU_GNUPLOT_H
#define MASU_GNUPLOT_H

#include <stddef.h>
#include <stdio.h>

/* 'text': a string that gnuplot does not interpret. Control characters, which would end the
 * command, become spaces; reject file names that contain them first. */
void masu_gnuplot_quote(FILE *f, const char *text);

/* "text": a string of one column of inline data. */
void masu_gnuplot_label(FILE *f, const char *text);

/* Whether a file name can be passed to gnuplot: no control characters. */
int masu_gnuplot_can_name(const char *path);

typedef enum masu_gnuplot_end {
    MASU_GNUPLOT_DRAWN,
    MASU_GNUPLOT_MISSING, /* gnuplot is not installed, which is not an error */
    MASU_GNUPLOT_FAILED
} masu_gnuplot_end;

/* Runs gnuplot in that folder (NULL: the current one), without a shell, with the commands on a
 * pipe. Its output is discarded. */
masu_gnuplot_end masu_gnuplot_run(const char *folder, const char *commands, size_t bytes);

#endif
