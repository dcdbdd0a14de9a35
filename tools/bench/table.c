/* table.c: see table.h. */
#include "bench/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The position of a column in a row. */
typedef struct column {
    const char *name;
    size_t offset;
    size_t text; /* its size in bytes; 0: a number */
} column;

static const column columns[] = {
#define TEXT(name) {#name, offsetof(masu_row, name), sizeof((masu_row *)0)->name},
#define NUMBER(name) {#name, offsetof(masu_row, name), 0},
    MASU_ROW_TEXTS(TEXT) MASU_ROW_NUMBERS(NUMBER) TEXT(build)
#undef TEXT
#undef NUMBER
};

/* The last column was added last; the two before it were added earlier. */
enum {
    COLUMNS = sizeof columns / sizeof *columns,
    COLUMNS_BEFORE = COLUMNS - 1,
    COLUMNS_FIRST = COLUMNS - 3
};

int masu_rows_header(FILE *f) {
    for (uint32_t c = 0; c < COLUMNS; c++) {
        if (fprintf(f, "%s%s", c ? "," : "", columns[c].name) < 0) return -1;
    }
    return fprintf(f, "\n");
}

int masu_rows_write(FILE *f, const masu_row *row) {
    for (uint32_t c = 0; c < COLUMNS; c++) {
        const char *at = (const char *)row + columns[c].offset, *comma = c ? "," : "";
        double number = 0.0;
        if (!columns[c].text) memcpy(&number, at, sizeof number);
        int n = columns[c].text ? fprintf(f, "%s%s", comma, *at ? at : "unknown")
                                : fprintf(f, "%s%.9g", comma, number);
        if (n < 0) return -1;
    }
    return fprintf(f, "\n");
}

/* A setting's name is also used for files, plots and pages. It has only characters of knobs and
 * their values, and does not start with a dot. */
static bool is_name(const char *text, size_t n) {
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_=+.- ";
    return n < MASU_SETTING_ID && *text != '.' && strspn(text, allowed) >= n;
}

bool masu_setting_is_name(const char *text) { return *text && is_name(text, strlen(text)); }

/* Parses one line, without its line end, of the first `count` columns. Returns false if the number
 * of fields, a name or a number is wrong. */
static bool parse(const char *line, uint32_t count, masu_row *out) {
    memset(out, 0, sizeof *out);
    out->rest_flip = out->fast_flip = (double)NAN;
    for (uint32_t c = 0; c < count; c++) {
        size_t n = strcspn(line, ",");
        char *to = (char *)out + columns[c].offset, *end;
        if (!n || (line[n] == ',') != (c + 1 < count)) return false;
        if (columns[c].text) {
            if (!is_name(line, n) || n >= columns[c].text) return false;
            memcpy(to, line, n);
        } else {
            double number = strtod(line, &end);
            if (end != line + n) return false;
            memcpy(to, &number, sizeof number);
        }
        line += n + (line[n] == ',');
    }
    if (!strcmp(out->build, "unknown")) out->build[0] = '\0';
    return true;
}

double masu_row_error(const masu_row *row) {
    return isfinite(row->rest_flip) ? 0.5 * (row->flip + row->rest_flip) : row->flip;
}

/* Number of columns in the header: all columns, or those of an earlier version. 0: neither. */
static uint32_t columns_of(const char *text, size_t n) {
    uint32_t c = 0;
    for (; c < COLUMNS && (n || (c != COLUMNS_BEFORE && c != COLUMNS_FIRST)); c++) {
        size_t length = strlen(columns[c].name) + (c != 0);
        if (n < length || (c && *text != ',') ||
            strncmp(text + (c != 0), columns[c].name, length - (c != 0)) != 0) {
            return 0;
        }
        text += length;
        n -= length;
    }
    return n ? 0 : c;
}

masu_row *masu_rows_read(const char *text, uint32_t *count, char *error, size_t error_size) {
    uint32_t lines = 0, number = 1, names = 0;
    const char *end = strchr(text, '\n');
    *count = 0;
    for (const char *c = text; *c; c++) lines += *c == '\n';
    if (end) names = columns_of(text, (size_t)(end - text));
    if (!names) {
        snprintf(error, error_size, "line 1: expected the columns of this version");
        return NULL;
    }
    masu_row *rows = malloc((lines + 1) * sizeof *rows);
    if (!rows) {
        snprintf(error, error_size, "out of memory for %u rows", lines);
        return NULL;
    }
    while (text = end + 1, end = strchr(text, '\n'), end) {
        char line[4096];
        size_t n = (size_t)(end - text);
        number++;
        if (n < sizeof line) memcpy(line, text, n);
        line[n < sizeof line ? n : 0] = 0;
        if (!parse(line, names, &rows[*count])) {
            snprintf(error, error_size, "line %u: expected a row", number);
            free(rows);
            return NULL;
        }
        ++*count;
    }
    return rows;
}

const masu_row *masu_rows_find(const masu_row *rows, uint32_t count, const char *setting) {
    for (uint32_t i = 0; i < count; i++) {
        if (!strcmp(rows[i].setting, setting)) return &rows[i];
    }
    return NULL;
}
