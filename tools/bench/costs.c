/* costs.c: see costs.h. */
#include "bench/costs.h"

#include "bench/sweep.h"
#include "file_kind.h"
#include "image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parses "NAME,1,2,3,4,5" without a line end. */
static bool read_row(const char *line, char setting[MASU_SETTING_ID],
                     double costs[MASU_COSTS_CLASSES]) {
    size_t n = strcspn(line, ",");
    if (!n || n >= MASU_SETTING_ID) return false;
    memcpy(setting, line, n);
    setting[n] = '\0';
    line += n;
    for (uint32_t c = 0; c < MASU_COSTS_CLASSES; c++) {
        char *end;
        if (*line != ',') return false;
        costs[c] = strtod(line + 1, &end);
        if (end == line + 1 || !isfinite(costs[c]) || !(costs[c] > 0.0)) return false;
        line = end;
    }
    return !*line;
}

static bool read_rows(char *text, const masu_row *rows, uint32_t count, double *out,
                      uint32_t *line) {
    char setting[MASU_SETTING_ID], *rest = text;
    double costs[MASU_COSTS_CLASSES];
    for (*line = 1;; ++*line) {
        char *at = rest, *end = strchr(at, '\n');
        if (!*at) return *line > 1;
        if (!end) return false;
        *end = '\0';
        rest = end + 1;
        if (*line == 1 ? strcmp(at, MASU_COSTS_HEADER) != 0 : !read_row(at, setting, costs))
            return false;
        const masu_row *row = *line == 1 ? NULL : masu_rows_find(rows, count, setting);
        if (row) memcpy(&out[MASU_COSTS_CLASSES * (size_t)(row - rows)], costs, sizeof costs);
    }
}

bool masu_costs_read(const char *folder, const masu_row *rows, uint32_t count, double *out,
                     bool *there, char *error, size_t error_size) {
    char path[4096];
    uint8_t *bytes = NULL;
    size_t size = 0;
    uint32_t line = 0;
    *there = masu_sweep_path(folder, MASU_COSTS, path) && masu_file_exists(path);
    if (!*there) return true;
    if (!masu_file_read(path, 1u << 20, &bytes, &size, error, error_size)) return false;
    char *text = calloc(size + 1, 1);
    if (text && size) memcpy(text, bytes, size);
    free(bytes);
    memset(out, 0, sizeof *out * MASU_COSTS_CLASSES * count);
    bool good = text && read_rows(text, rows, count, out, &line);
    if (!text)
        snprintf(error, error_size, "%.2000s: out of memory", path);
    else if (!good)
        snprintf(error, error_size,
                 "%.2000s: line %u: expected a name and %u numbers above 0 after the line '%s'",
                 path, line, MASU_COSTS_CLASSES, MASU_COSTS_HEADER);
    free(text);
    return good;
}
