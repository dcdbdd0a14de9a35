/* bench_ladder.c: `masu bench --ladder`: what `masu bench` has measured, as a table to read or as the
 * table that the library is built with. */
#include "masu/bench.h"

#include "bench/sweep/knobs.h"
#include "bench/sweep/ladder.h"
#include "bench/sweep/ladder_file.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

static void print_table(const char *path, const masu_ladder_file *l) {
    printf("%s: %s at %ux%u, by %s%s%s\n  %s\n", path, l->scene, l->width, l->height, l->clock,
           l->date[0] ? ", " : "", l->date, l->driver);
    printf("  rung   time    FLIP    RMSE  setting\n");
    for (uint32_t r = 0; r < l->count; r++) {
        char rmse[24] = "-";
        if (l->rmses[r] >= 0.0) snprintf(rmse, sizeof rmse, "%.2f", l->rmses[r]);
        printf("  %4u  %.3f  %.4f  %6s  %s\n", r, l->ratios[r], l->flips[r], rmse, l->settings[r]);
    }
}

/* ---- The library's tables -------------------------------------------------------------------- */

/* What is built in has to be what any scene on any device can do. */
static int check_baked(const char *path, const masu_ladder_file *l) {
    for (uint32_t r = 0; r < l->count; r++) {
        const masu_rung *rung = &l->rungs[r];
        const char *why =
            rung->march != MASU_MARCH_AUTO ? "march needs a blob baked with --variants"
            : rung->specular == MASU_ON    ? "specular on fails on devices with few storage buffers"
            : rung->occlusion == MASU_ON   ? "occlusion on fails on devices with few storage buffers"
            : rung->upscale == MASU_OFF    ? "upscale off fails at scales below 1"
            : rung->shadow_distance > 0.0f ? "shadow_distance depends on the scene"
            : rung->specular_cutoff > 0.0f ? "specular_cutoff depends on the scene"
                                           : NULL;
        if (why) return masu_cli_error("%s: rungs[%u]: not allowed in built-in ladders: %s", path, r, why);
        if (r && l->ratios[r - 1] < MASU_LADDER_APART * l->ratios[r] * (1.0 - 1e-6)) {
            return masu_cli_error("%s: rungs[%u]: ratio: expected at least %.2f times less than the "
                                  "previous rung, %.6g, found %.6g",
                                  path, r, MASU_LADDER_APART, l->ratios[r - 1], l->ratios[r]);
        }
        if (r && !((float)l->flips[r] > (float)l->flips[r - 1])) {
            return masu_cli_error(
                "%s: rungs[%u]: flip: expected more than the previous rung, %.6g, "
                "found %.6g",
                path, r, l->flips[r - 1], l->flips[r]);
        }
    }
    return MASU_CLI_OK;
}

/* Files that do not say when they were measured were written then. */
static void date_of(const char *path, const masu_ladder_file *l, char *out, size_t size) {
    struct stat s;
    struct tm utc;
    snprintf(out, size, "%s", l->date);
    if (!l->date[0] && !stat(path, &s) && gmtime_r(&s.st_mtime, &utc))
        strftime(out, size, "%Y-%m-%d", &utc);
}

static void print_rung(const masu_rung *rung) {
    static const masu_rung zero;
    size_t column = (size_t)printf("              {");
    const char *between = "";
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        char value[64], text[120];
        if (!masu_knob_differs(k, rung, &zero)) continue;
        masu_knob_c(k, rung, value, sizeof value);
        int n = snprintf(text, sizeof text, ".%s = %s", k->name, value);
        if (*between && column + (size_t)n > 94) {
            column = (size_t)printf(",\n               ") - 2;
            between = "";
        }
        column += (size_t)printf("%s%s", between, text);
        between = ", ";
    }
    printf("},\n");
}

static void print_floats(const char *name, const double *values, uint32_t count) {
    printf("         .%s = {", name);
    for (uint32_t i = 0; i < count; i++) {
        char text[32];
        snprintf(text, sizeof text, "%.6g", values[i]);
        printf("%s%s%sf", i ? i % 4 ? ", " : ",\n              " : "", text,
               strpbrk(text, ".e") ? "" : ".0");
    }
    printf("},\n");
}

static void print_class(const char *path, uint32_t scene_class, const masu_ladder_file *l) {
    static const char *const constants[MASU_SCENE_CLASSES] = {
        "POLYGONS",        "WORLD",        "SDF",        "BOTH",
        "POLYGONS_TRACED", "WORLD_TRACED", "SDF_TRACED", "BOTH_TRACED"};
    char date[32];
    date_of(path, l, date, sizeof date);
    printf("    [MASU_SCENE_%s] =\n        {.from = \"%s, %ux%u, \"\n         \"%s, \"\n"
           "         \"by %s, %s\",\n         .count = %u,\n         .rungs = {\n",
           constants[scene_class], l->scene, l->width, l->height, l->driver, l->clock, date,
           l->count);
    for (uint32_t r = 0; r < l->count; r++) print_rung(&l->rungs[r]);
    printf("         },\n");
    print_floats("ratios", l->ratios, l->count);
    print_floats("flips", l->flips, l->count);
    printf("        },\n");
}

static int print_c(const char *const *arguments, uint32_t count) {
    static masu_ladder_file ladders[MASU_SCENE_CLASSES];
    const char *paths[MASU_SCENE_CLASSES] = {NULL};
    char error[1024];
    for (uint32_t i = 0; i < count; i++) {
        const char *equals = strchr(arguments[i], '=');
        uint32_t c = 0;
        for (; equals && c < MASU_SCENE_CLASSES; c++) {
            const char *name = masu_scene_class_name((masu_scene_class)c);
            if (strlen(name) == (size_t)(equals - arguments[i]) &&
                !strncmp(name, arguments[i], strlen(name)))
                break;
        }
        if (!equals || c == MASU_SCENE_CLASSES) {
            return masu_cli_usage_error("--c: expected CLASS=FILE with a CLASS of polygons, world, sdf, "
                                        "both, each with or without -traced; found '%s'",
                                        arguments[i]);
        }
        if (paths[c])
            return masu_cli_usage_error("--c: two ladders of one class: '%s' and '%s'", paths[c],
                                        equals + 1);
        paths[c] = equals + 1;
        if (!masu_ladder_read(paths[c], &ladders[c], error, sizeof error))
            return masu_cli_error("%s", error);
        int code = check_baked(paths[c], &ladders[c]);
        if (code) return code;
    }
    printf("/* ladder_tables.h: measured ladders, one per class of scenes; part of ladder.c. "
           "Written by\n"
           " * `make ladders` out of what `masu bench` has measured: not to be edited. */\n"
           "/* clang-format off */\n"
           "#ifndef MASU_LADDER_TABLES_H\n#define MASU_LADDER_TABLES_H\n\n"
           "static const masu_ladder measured[MASU_SCENE_CLASSES] = {\n");
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        if (paths[c]) print_class(paths[c], c, &ladders[c]);
    }
    printf("};\n\n#endif\n");
    return MASU_CLI_OK;
}

int masu_bench_ladder(const masu_given *given, bool c) {
    if (!given->count) return masu_cli_usage_error("no ladder given: expected LADDER.json");
    if (c) return print_c(given->arguments, given->count);
    for (uint32_t i = 0; i < given->count; i++) {
        static masu_ladder_file ladder;
        char error[1024];
        if (!masu_ladder_read(given->arguments[i], &ladder, error, sizeof error))
            return masu_cli_error("%s", error);
        print_table(given->arguments[i], &ladder);
    }
    return MASU_CLI_OK;
}
