/* ladder.c: `masu-lab ladder`: writes the ladders that the library is built with:
 * src/quality/ladder_tables.h from ladders that `masu bench` has measured, and
 * src/quality/ladder_devices.h from the cost model (lab/model). With --costs it computes the costs
 * by which `masu bench` then chooses rungs. */
#include "lab/command/commands.h"
#include "lab/model/ask.h"
#include "lab/model/write.h"

#include "bench/costs.h"
#include "bench/sweep.h"
#include "image.h"
#include "settings/knobs.h"
#include "settings/ladder.h"
#include "settings/ladder_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

typedef struct options {
    bool devices, costs;
} options;

static const char *const constants[MASU_SCENE_CLASSES] = {
    "POLYGONS",        "WORLD",        "SDF",        "BOTH",
    "POLYGONS_TRACED", "WORLD_TRACED", "SDF_TRACED", "BOTH_TRACED"};

/* The class of CLASS=...; *rest is the text after it. MASU_SCENE_CLASSES: an invalid argument,
 * already reported. */
static uint32_t class_of(const char *argument, const char **rest) {
    const char *equals = strchr(argument, '=');
    uint32_t c = 0;
    for (; equals && c < MASU_SCENE_CLASSES; c++) {
        const char *name = masu_scene_class_name((masu_scene_class)c);
        if (strlen(name) == (size_t)(equals - argument) && !strncmp(name, argument, strlen(name)))
            break;
    }
    if (equals && c < MASU_SCENE_CLASSES) {
        *rest = equals + 1;
        return c;
    }
    masu_cli_usage_error(
        "expected CLASS=FILE, with a class of polygons, world, sdf, both, or one with -traced: "
        "found '%s'",
        argument);
    return MASU_SCENE_CLASSES;
}

/* ---- ladder_tables.h ------------------------------------------------------------------------- */

/* A built-in ladder must work on every scene of its class and on every device. */
static const char *not_built_in(const masu_rung *rung) {
    return rung->march != MASU_MARCH_AUTO ? "march needs a blob baked with --variants"
           : rung->specular == MASU_ON    ? "specular on fails on devices with few storage buffers"
           : rung->occlusion == MASU_ON   ? "occlusion on fails on devices with few storage buffers"
           : rung->upscale == MASU_OFF    ? "upscale off fails at scales below 1"
           : rung->shadow_distance > 0.0f ? "shadow_distance depends on the scene"
           : rung->specular_cutoff > 0.0f ? "specular_cutoff depends on the scene"
                                          : NULL;
}

static int check_baked(const char *path, const masu_ladder_file *l) {
    for (uint32_t r = 0; r < l->count; r++) {
        const char *why = not_built_in(&l->rungs[r]);
        if (why)
            return masu_cli_error("%s: rungs[%u]: not allowed in built-in ladders: %s", path, r,
                                  why);
        if (r && l->ratios[r - 1] < MASU_LADDER_APART * l->ratios[r] * (1.0 - 1e-6)) {
            return masu_cli_error(
                "%s: rungs[%u]: ratio: expected at least %.2f times less than the "
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

/* A file without a date was measured when it was written. */
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

static int print_tables(const masu_given *given) {
    static masu_ladder_file ladders[MASU_SCENE_CLASSES];
    const char *paths[MASU_SCENE_CLASSES] = {NULL}, *path = NULL;
    char error[1024];
    for (uint32_t i = 0; i < given->count; i++) {
        uint32_t c = class_of(given->arguments[i], &path);
        if (c == MASU_SCENE_CLASSES) return MASU_CLI_USAGE;
        if (paths[c])
            return masu_cli_usage_error("two ladders of one class: '%s' and '%s'", paths[c], path);
        paths[c] = path;
        if (!masu_ladder_read(path, &ladders[c], error, sizeof error))
            return masu_cli_error("%s", error);
        int code = check_baked(path, &ladders[c]);
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

/* ---- ladder_devices.h ------------------------------------------------------------------------ */

/* The checksum of the program cksum (POSIX). */
static uint32_t cksum(const uint8_t *bytes, size_t count) {
    uint32_t crc = 0;
    size_t length = count;
    for (size_t i = 0; i < count || length; i++) {
        uint32_t byte = i < count ? bytes[i] : length & 0xFF;
        if (i >= count) length >>= 8;
        crc ^= byte << 24;
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 0x80000000u ? crc << 1 ^ 0x04C11DB7u : crc << 1;
    }
    return ~crc;
}

/* Splits SCENE.masu=LADDER.json[=SECONDS]; SECONDS is the time of the scene. */
static bool split(const char *argument, char scene[1024], char ladder[1024], double *time) {
    char text[2200], *end;
    if (snprintf(text, sizeof text, "%s", argument) >= (int)sizeof text) return false;
    char *second = strchr(text, '='), *third = second ? strchr(second + 1, '=') : NULL;
    if (!second) return false;
    *second = 0;
    if (third) *third = 0;
    *time = 1.0;
    if (third) {
        *time = strtod(third + 1, &end);
        if (end == third + 1 || *end) return false;
    }
    return snprintf(scene, 1024, "%s", text) < 1024 &&
           snprintf(ladder, 1024, "%s", second + 1) < 1024;
}

/* Rounds like the CSV of the model sheet. */
static double shown(double ms) {
    char text[32];
    snprintf(text, sizeof text, "%.6g", ms);
    return strtod(text, NULL);
}

/* Computes the cost of each rung of the ladder on each class; the caller frees *out. */
static int model(const char *scene, const char *ladder, double time, masu_model_sheet **out) {
    static masu_issued issued[MASU_MODEL_CLASSES];
    const VkExtent2D size = {1920, 1080};
    char error[4096];
    memset(issued, 0, sizeof issued);
    int code = masu_model_ask("tgl,kbl,raven,vangogh,a630", scene, ladder, size, issued);
    if (code) return code;
    masu_model_sheet *m = malloc(sizeof *m);
    if (!m) return masu_cli_error("out of memory");
    const masu_model_desc d = {.scene_path = scene,
                               .ladder_path = ladder,
                               .size = size,
                               .drawn = masu_model_drawn(size),
                               .time = time,
                               .issued = issued,
                               .progress = masu_cli_progress_text};
    bool good = masu_model_run(&d, m, NULL, error, sizeof error);
    masu_cli_progress_clear();
    *out = m;
    if (good) return MASU_CLI_OK;
    free(m);
    return masu_cli_error("%s", error);
}

static int print_device_class(uint32_t scene_class, const char *scene, const char *ladder,
                              double time) {
    static const char *const devices[MASU_MODEL_CLASSES] = {"XE80", "UHD620", "VEGA8", "DECK",
                                                            "MOBILE"};
    char error[4096];
    uint8_t *bytes = NULL;
    size_t count = 0;
    if (!masu_file_read(ladder, 1u << 20, &bytes, &count, error, sizeof error))
        return masu_cli_error("%s", error);
    uint32_t sum = cksum(bytes, count);
    free(bytes);
    masu_model_sheet *m = NULL;
    int code = model(scene, ladder, time, &m);
    if (code) return code;
    const char *last = strrchr(scene, '/');
    printf("    [MASU_SCENE_%s] = { /* %s, ladder.json %u */\n", constants[scene_class],
           last ? last + 1 : scene, sum);
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
        printf("        [MASU_DEVICE_%s] = {", devices[k]);
        for (uint32_t r = 0; r < m->rung_count; r++)
            printf("%s%.4ff", r ? ", " : "",
                   shown(m->rungs[r].realistic[k]) / shown(m->rungs[0].realistic[k]));
        printf("},\n");
    }
    printf("    },\n");
    free(m);
    return MASU_CLI_OK;
}

static int print_devices(const masu_given *given) {
    char scene[1024], ladder[1024];
    double time;
    const char *rest = NULL;
    for (uint32_t i = 0; i < given->count; i++) {
        if (class_of(given->arguments[i], &rest) == MASU_SCENE_CLASSES) return MASU_CLI_USAGE;
        if (!split(rest, scene, ladder, &time)) {
            return masu_cli_usage_error(
                "--devices: expected CLASS=SCENE.masu=LADDER.json[=SECONDS], found '%s'",
                given->arguments[i]);
        }
    }
    printf("/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, "
           "relative to the first rung; part of\n"
           " * ladder.c. COMPUTED by the cost model from the instructions that the GPUs' own "
           "compilers emit (masu-lab model\n"
           " * --isa), not measured on any of them. Written by `make ladder-devices`: not to be "
           "edited. */\n"
           "/* clang-format off */\n"
           "#ifndef MASU_LADDER_DEVICES_H\n#define MASU_LADDER_DEVICES_H\n\n"
           "static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = "
           "{\n");
    for (uint32_t i = 0; i < given->count; i++) {
        uint32_t c = class_of(given->arguments[i], &rest);
        int code = split(rest, scene, ladder, &time) ? print_device_class(c, scene, ladder, time)
                                                     : MASU_CLI_USAGE;
        if (code) return code;
    }
    printf("};\n\n#endif\n");
    return MASU_CLI_OK;
}

/* ---- costs.csv ------------------------------------------------------------------------------- */

_Static_assert(MASU_COSTS_CLASSES == MASU_MODEL_CLASSES, "a column for each class of the model");

/* Settings that change only time are for comparison. */
static bool may_be_rung(const masu_rung *rung) {
    return !not_built_in(rung) && rung->frustum != MASU_OFF && rung->occlusion != MASU_OFF &&
           rung->light_tiles != MASU_OFF;
}

/* Writes a ladder.json for some of the rows, as input of the model; its times and errors are
 * placeholders. */
static bool write_part(const char *path, const masu_row *rows, const uint32_t *part, uint32_t count,
                       char *error, size_t error_size) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    if (!f) return snprintf(error, error_size, "out of memory"), false;
    fprintf(f, "{\"scene\": \"costs\", \"driver\": \"none\", \"clock\": \"none\", \"width\": 1, "
               "\"height\": 1, "
               "\"error\": \"flip\", \"rungs\": [");
    bool good = true;
    for (uint32_t i = 0; i < count && good; i++) {
        masu_rung rung;
        good = masu_setting_parse(rows[part[i]].setting, &rung, error, error_size);
        fprintf(f, "%s{\"setting\": \"%s\", \"ratio\": %u, \"flip\": 0, \"knobs\": {",
                i ? ", " : "", rows[part[i]].setting, count - i);
        for (const masu_knob *k = masu_knob_table(); k->name && good; k++) {
            char value[64];
            masu_knob_json(k, &rung, value, sizeof value);
            fprintf(f, "%s\"%s\": %s", k == masu_knob_table() ? "" : ", ", k->name, value);
        }
        fprintf(f, "}}");
    }
    fprintf(f, "]}\n");
    good = !fclose(f) && good && masu_file_write(path, text, bytes, error, error_size);
    free(text);
    return good;
}

/* Processes twelve settings at a time, the maximum of a ladder. */
static int write_costs(const char *scene, const char *folder, double time) {
    char path[4096], part_path[4096], error[4096], *text = NULL;
    uint32_t count = 0, part[MASU_MAX_RUNGS];
    size_t bytes = 0;
    masu_row *rows = masu_sweep_rows(folder, &count, error, sizeof error);
    if (rows && !count) snprintf(error, sizeof error, "%.2000s: no setting is measured", folder);
    if (!rows || !count) {
        free(rows);
        return masu_cli_error("%s", error);
    }
    FILE *f = open_memstream(&text, &bytes);
    int code = f && masu_sweep_path(folder, MASU_COSTS, path) &&
                       masu_sweep_path(folder, "costs.json", part_path)
                   ? MASU_CLI_OK
                   : masu_cli_error("%s: out of memory, or the path is too long", folder);
    if (!code) fprintf(f, MASU_COSTS_HEADER "\n");
    for (uint32_t i = 0; i < count && !code;) {
        uint32_t n = 0;
        masu_rung rung;
        masu_model_sheet *m = NULL;
        for (; i < count && n < MASU_MAX_RUNGS; i++) {
            if (masu_setting_parse(rows[i].setting, &rung, error, sizeof error) &&
                may_be_rung(&rung))
                part[n++] = i;
        }
        if (!n) break;
        if (!write_part(part_path, rows, part, n, error, sizeof error))
            code = masu_cli_error("%s", error);
        if (!code) code = model(scene, part_path, time, &m);
        for (uint32_t k = 0; k < n && !code; k++) {
            fprintf(f, "%s", rows[part[k]].setting);
            for (uint32_t c = 0; c < MASU_MODEL_CLASSES; c++)
                fprintf(f, ",%.6g", m->rungs[k].realistic[c]);
            fprintf(f, "\n");
        }
        free(m);
    }
    (void)remove(part_path);
    if (f && fclose(f) && !code) code = masu_cli_error("out of memory");
    if (!code && !masu_file_write(path, text, bytes, error, sizeof error))
        code = masu_cli_error("%s", error);
    free(text);
    free(rows);
    return code;
}

static int write_all_costs(const masu_given *given) {
    char scene[1024], folder[1024];
    double time;
    for (uint32_t i = 0; i < given->count; i++) {
        if (!split(given->arguments[i], scene, folder, &time)) {
            return masu_cli_usage_error("--costs: expected SCENE.masu=DIR[=SECONDS], found '%s'",
                                        given->arguments[i]);
        }
        int code = write_costs(scene, folder, time);
        if (code) return code;
    }
    return MASU_CLI_OK;
}

static const masu_option rows[] = {
    MASU_FLAG(options, devices, "devices",
              "print ladder_devices.h instead: the cost of each rung on the model's five classes "
              "of GPU,\n"
              "relative to the first rung"),
    MASU_FLAG(options, costs, "costs",
              "write costs.csv into each DIR of masu bench: the cost of each setting on these "
              "classes, in ms;\n"
              "masu bench then chooses no rung that another setting dominates on any class"),
    {.name = NULL}};

static int run(masu_cli *cli) {
    options o = {false, false};
    masu_given given = {.most = MASU_SCENE_CLASSES, .excess = "a ladder for each class of scenes"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (!given.count) return masu_cli_usage_error("no ladder is given");
    if (o.devices && o.costs)
        return masu_cli_usage_error("--devices cannot be combined with --costs");
    return o.costs     ? write_all_costs(&given)
           : o.devices ? print_devices(&given)
                       : print_tables(&given);
}

const masu_cli_command lab_ladder = {
    .name = "ladder",
    .arguments = "CLASS=LADDER.json...\n"
                 "       masu-lab ladder --devices CLASS=SCENE.masu=LADDER.json[=SECONDS]...\n"
                 "       masu-lab ladder --costs SCENE.masu=DIR[=SECONDS]...",
    .summary = "print the ladders that the library is built with, src/quality/ladder_tables.h",
    .details = "LADDER.json is one that masu bench has measured. A class is polygons, world, sdf, "
               "both, or one of\n"
               "them with -traced; each class takes one ladder. --devices and --costs need "
               "MASU_ISA_DRIVERS, as masu-lab\n"
               "isa.\n",
    .run = run};
