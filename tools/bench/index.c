/* index.c: see index.h. */
#include "bench/index.h"

#include "bench/page.h"
#include "bench/sweep.h"
#include "cli/markup.h"
#include "file_kind.h"
#include "image.h"
#include "settings/ladder_file.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

static bool has(const char *folder, const char *file) {
    char path[4096];
    return masu_sweep_path(folder, file, path) && masu_file_exists(path);
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Percent-encodes all but unreserved characters (RFC 3986), so that a folder's name is one path
 * segment. */
static void put_link(FILE *f, const char *name, const char *file) {
    fputs("<a href=\"./", f);
    for (const unsigned char *c = (const unsigned char *)name; *c; c++) {
        const bool plain =
            strchr("-._~0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz", *c);
        fprintf(f, plain ? "%c" : "%%%02X", *c);
    }
    masu_markup(f, "/%s\">%s</a>", file, name);
}

static bool put_scene(FILE *f, const char *folder, const char *name, char *error,
                      size_t error_size) {
    char path[4096];
    masu_ladder_file *l = malloc(sizeof *l);
    const masu_row *rungs[MASU_MAX_RUNGS];
    uint32_t count, found = 0;
    masu_row *rows = masu_sweep_rows(folder, &count, error, error_size);
    bool good = rows && l && masu_sweep_path(folder, "ladder.json", path) &&
                masu_ladder_read(path, l, error, error_size);
    if (!l) snprintf(error, error_size, "out of memory");
    for (uint32_t i = 0; good && i < l->count; i++) {
        rungs[i] = masu_rows_find(rows, count, l->settings[i]);
        good = rungs[i] != NULL;
        found += good;
        if (!good)
            snprintf(error, error_size, "%.2000s: results.csv lacks rung %u of ladder.json: %s",
                     folder, i, l->settings[i]);
    }
    masu_verdict v;
    if (good) {
        fputs("<tr><td>", f);
        put_link(f, name, has(folder, "index.html") ? "index.html" : "ladder.json");
    }
    if (good && masu_verdict_find(rungs, found, &v)) {
        masu_markup(f,
                    "</td><td class=\"%s\">%s</td><td>%.2f</td><td>%.4f</td>",
                    v.holds ? "holds" : "bad", v.holds ? "holds" : "no rung holds", v.ms, v.error);
        masu_markup(f, "<td class=\"text\">%u of %u: %s</td><td>%ux%u</td><td>%s</td>", v.rung,
                    found, rungs[v.rung]->setting, l->width, l->height, l->date);
        masu_markup(f, "<td class=\"text\">%s</td></tr>\n", l->driver);
    } else if (good) {
        fputs("</td><td>no times</td>", f);
        for (int column = 2; column < 8; column++) fputs("<td>-</td>", f);
        fputs("</tr>\n", f);
    }
    free(rows);
    free(l);
    return good;
}

/* Adds a copy of `name` to the array; false: out of memory. */
static bool add_name(char ***names, uint32_t *count, const char *name) {
    if (!(*count & (*count - 1))) { /* a power of two: full */
        char **more = realloc(*names, (*count ? 2 * (size_t)*count : 1) * sizeof *more);
        if (!more) return false;
        *names = more;
    }
    (*names)[*count] = strdup(name);
    if (!(*names)[*count]) return false;
    ++*count;
    return true;
}

bool masu_bench_index(const char *folder, uint32_t *count, char *error, size_t error_size) {
    char **names = NULL, path[4096], *text = NULL;
    size_t bytes = 0;
    DIR *d = opendir(folder);
    const struct dirent *e;
    bool good = true;
    *count = 0;
    while (good && d && (e = readdir(d))) {
        if (*e->d_name != '.' && masu_sweep_path(folder, e->d_name, path) &&
            has(path, "ladder.json") && has(path, "results.csv"))
            good = add_name(&names, count, e->d_name);
    }
    if (d) closedir(d);
    if (good && !*count) {
        snprintf(error, error_size, "%.2000s: found no folder with ladder.json and results.csv",
                 folder);
        return false;
    }
    if (good) qsort(names, *count, sizeof *names, by_name);
    FILE *f = good ? open_memstream(&text, &bytes) : NULL;
    if (f) {
        masu_page_begin(f, "Error against run time: ", "all scenes");
        masu_markup(
            f,
            "<p>Verdict: the first rung, in falling quality, whose median frame takes at most "
            "%.2f ms (60 Hz), or else the fastest rung.</p>\n"
            "<div class=\"wide\"><table class=\"sort\">\n"
            "<tr><th>scene</th><th>verdict</th><th>ms</th><th>error</th><th class=\"text\">rung</th>"
            "<th>size</th><th>date</th><th class=\"text\">driver</th></tr>\n",
            MASU_PAGE_BUDGET_MS);
    }
    for (uint32_t i = 0; f && i < *count && good; i++)
        good = masu_sweep_path(folder, names[i], path) &&
               put_scene(f, path, names[i], error, error_size);
    if (f) {
        fputs("</table></div>\n", f);
        masu_page_end(f);
    }
    if (!f || fclose(f)) {
        snprintf(error, error_size, "out of memory");
        good = false;
    }
    good = good && masu_sweep_path(folder, "index.html", path) &&
           masu_file_write(path, text, bytes, error, error_size);
    free(text);
    for (uint32_t i = 0; i < *count; i++) free(names[i]);
    free(names);
    return good;
}
