/* table.h: rows of numbers, as a table that is shown and as CSV: both are the same cells, of which a
 * column says in which of the two it is, under which name and in which form. Cells come one by one, in
 * the order of the columns; the last one of a row ends it.
 *
 * CSV is kept in memory until masu_table_close writes it whole: a study that fails leaves no half of a
 * file. Running out of memory is reported there. */
#ifndef MASU_TABLE_H
#define MASU_TABLE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct masu_column {
    const char *csv;     /* name in the CSV; NULL: it is not there */
    const char *form;    /* there: "%.4f" of a number; of text NULL, or "\"": always in quotes */
    const char *heading; /* of the table; NULL: it is not shown */
    const char *shown;   /* there: "%.2f" of a number; of text NULL */
} masu_column;

enum { MASU_TABLE_CELL = 96 };

typedef struct masu_table {
    const masu_column *columns; /* ends where neither csv nor heading is */
    const char *absent;         /* for NAN in the CSV; in the table "-" */
    uint32_t count, at;         /* columns; the next cell's */
    FILE *csv;
    char *text;
    size_t bytes;
    char (*cells)[MASU_TABLE_CELL]; /* shown, of the rows since the last masu_table_print */
    uint32_t rows, rows_max;
    bool failed;
} masu_table;

void masu_table_open(masu_table *t, const masu_column *columns, const char *absent);
void masu_table_text(masu_table *t, const char *text);
void masu_table_number(masu_table *t, double value); /* NAN: it is absent */
void masu_table_numbers(masu_table *t, const double *values, uint32_t count);

/* The rows since the last call: text to the left, numbers to the right. */
void masu_table_print(masu_table *t, FILE *f);

/* Writes the CSV, "-" to stdout, NULL nowhere; frees. Returns an exit code, having reported a
 * failure. */
int masu_table_close(masu_table *t, const char *csv);

#endif
