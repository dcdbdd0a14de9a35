/* gnuplot.h: how every program draws its plots: commands in, gnuplot's verdict out.
 *
 * A text of ours, a file's or a user's (a title, a name, a folder) comes into commands through masu_gnuplot_quote and
 * into data through masu_gnuplot_label, and nowhere else: within double quotes and outside of quotes gnuplot runs
 * what stands between backticks. */
#ifndef MASU_GNUPLOT_H
#define MASU_GNUPLOT_H

#include <stddef.h>
#include <stdio.h>

/* 'text': a string of which gnuplot reads nothing but its end. Control characters, which would end the command,
 * become spaces: a name of a file that has some is to be refused before. */
void masu_gnuplot_quote(FILE *f, const char *text);

/* "text": a string of one column of inline data. */
void masu_gnuplot_label(FILE *f, const char *text);

/* Whether a name of a file can be given to gnuplot: no control characters. */
int masu_gnuplot_can_name(const char *path);

typedef enum masu_gnuplot_end {
    MASU_GNUPLOT_DRAWN,
    MASU_GNUPLOT_MISSING, /* there is no gnuplot, which is no error */
    MASU_GNUPLOT_FAILED
} masu_gnuplot_end;

/* Runs gnuplot in that folder (NULL: where we are), without a shell; it reads the commands from a pipe. What it
 * says goes nowhere. */
masu_gnuplot_end masu_gnuplot_run(const char *folder, const char *commands, size_t bytes);

#endif
