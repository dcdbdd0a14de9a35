/* table.h: rows of numbers, written as a table and as CSV. Both have the same cells; a column
 * selects where it appears, with which name and format. Cells are added one by one, in the order of
 * the columns; the last one of a row ends it.
 *
 * The CSV is kept in memory until masu_table_close writes it, so that a failed study leaves no
 * partial file. Running out of memory is reported there. */
#ifndef MASU_TABLE_H
#define MASU_TABLE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct masu_column {
    const char *csv;     /* name in the CSV; NULL: not in it */
    const char *form;    /* in the CSV: "%.4f" for numbers; for text NULL, or "\"": always quoted */
    const char *heading; /* in the table; NULL: not in it */
    const char *shown;   /* in the table: "%.2f" for numbers; for text NULL */
} masu_column;

enum { MASU_TABLE_CELL = 96 };

typedef struct masu_table {
    const masu_column *columns; /* ends with a column that has neither csv nor heading */
    const char *absent;         /* for NAN in the CSV; in the table "-" */
    uint32_t count, at;         /* columns; the next cell's index */
    FILE *csv;
    char *text;
    size_t bytes;
    char (*cells)[MASU_TABLE_CELL]; /* of the table's rows since the last masu_table_print */
    uint32_t rows, rows_max;
    bool failed;
} masu_table;

void masu_table_open(masu_table *t, const masu_column *columns, const char *absent);
void masu_table_text(masu_table *t, const char *text);
void masu_table_number(masu_table *t, double value); /* NAN: absent */
void masu_table_numbers(masu_table *t, const double *values, uint32_t count);

/* Prints the rows since the last call: text left-aligned, numbers right-aligned. */
void masu_table_print(masu_table *t, FILE *f);

/* Writes the CSV ("-": to stdout; NULL: nowhere) and frees the table. Returns an exit code; a
 * failure has been reported. */
int masu_table_close(masu_table *t, const char *csv);

#endif
