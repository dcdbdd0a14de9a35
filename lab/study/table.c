/* table.c: see table.h. */
#define _POSIX_C_SOURCE 200809L
#include "lab/study/table.h"

#include "cli/cli.h"
#include "image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Names come from files and drivers: quotes are doubled. */
static void quoted(FILE *f, const char *text) {
    fputc('"', f);
    for (; *text; text++) {
        if (*text == '"') fputc('"', f);
        fputc(*text, f);
    }
    fputc('"', f);
}

void masu_table_open(masu_table *t, const masu_column *columns, const char *absent) {
    memset(t, 0, sizeof *t);
    t->columns = columns;
    t->absent = absent;
    t->csv = open_memstream(&t->text, &t->bytes);
    t->failed = !t->csv;
    const char *between = "";
    for (; columns[t->count].csv || columns[t->count].heading; t->count++) {
        const char *name = columns[t->count].csv;
        if (!name || t->failed) continue;
        fprintf(t->csv, "%s%s", between, name);
        between = ",";
    }
    if (!t->failed) fputc('\n', t->csv);
}

/* Returns the next shown cell; grows the table if needed. */
static char *next_cell(masu_table *t) {
    if (t->at == 0 && t->rows == t->rows_max) {
        uint32_t more = 2 * t->rows_max + 16;
        void *cells = realloc(t->cells, (size_t)more * t->count * sizeof *t->cells);
        t->failed = t->failed || !cells;
        if (!cells) return NULL;
        t->cells = cells;
        t->rows_max = more;
    }
    return t->cells[(size_t)t->rows * t->count + t->at];
}

static void end_cell(masu_table *t) {
    bool more = false; /* the CSV has more columns after this one */
    for (uint32_t i = t->at + 1; i < t->count; i++) more = more || t->columns[i].csv;
    if (t->columns[t->at].csv) fputc(more ? ',' : '\n', t->csv);
    if (++t->at < t->count) return;
    t->at = 0;
    t->rows++;
}

void masu_table_text(masu_table *t, const char *text) {
    const masu_column *c = &t->columns[t->at];
    char *cell = t->failed ? NULL : next_cell(t);
    if (!cell) return;
    snprintf(cell, MASU_TABLE_CELL, "%s", text);
    if (c->csv && (c->form || strpbrk(text, ",\"\n\r")))
        quoted(t->csv, text);
    else if (c->csv)
        fputs(text, t->csv);
    end_cell(t);
}

void masu_table_number(masu_table *t, double value) {
    const masu_column *c = &t->columns[t->at];
    char *cell = t->failed ? NULL : next_cell(t);
    if (!cell) return;
    if (isnan(value) || !c->shown)
        snprintf(cell, MASU_TABLE_CELL, "-");
    else
        snprintf(cell, MASU_TABLE_CELL, c->shown, value);
    if (c->csv && isnan(value))
        fputs(t->absent, t->csv);
    else if (c->csv)
        fprintf(t->csv, c->form, value);
    end_cell(t);
}

void masu_table_numbers(masu_table *t, const double *values, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) masu_table_number(t, values[i]);
}

/* The width of the widest cell or heading. */
static int width_of(const masu_table *t, uint32_t column) {
    size_t width = strlen(t->columns[column].heading);
    for (uint32_t i = 0; i < t->rows; i++) {
        size_t length = strlen(t->cells[(size_t)i * t->count + column]);
        if (length > width) width = length;
    }
    return (int)width;
}

void masu_table_print(masu_table *t, FILE *f) {
    uint32_t last = t->count;
    if (t->failed) return;
    for (uint32_t c = 0; c < t->count; c++) last = t->columns[c].heading ? c : last;
    for (uint32_t r = 0; r <= t->rows; r++) { /* row 0: the headings */
        for (uint32_t c = 0; c <= last && last < t->count; c++) {
            const char *heading = t->columns[c].heading;
            if (!heading) continue;
            const char *text = r ? t->cells[(size_t)(r - 1) * t->count + c] : heading;
            bool left = !t->columns[c].shown;
            fprintf(f, left ? "  %-*s" : "  %*s", left && c == last ? 0 : width_of(t, c), text);
        }
        fputc('\n', f);
    }
    t->rows = 0;
}

int masu_table_close(masu_table *t, const char *csv) {
    char error[4096];
    int code = MASU_CLI_OK;
    if (t->csv && fclose(t->csv)) t->failed = true;
    if (t->failed)
        code = masu_cli_error("out of memory for the table");
    else if (csv && !strcmp(csv, "-"))
        fwrite(t->text, 1, t->bytes, stdout);
    else if (csv && !masu_file_write(csv, t->text, t->bytes, error, sizeof error))
        code = masu_cli_error("%s", error);
    free(t->text);
    free(t->cells);
    memset(t, 0, sizeof *t);
    return code;
}
