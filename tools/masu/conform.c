/* conform.c: `masu conform`: runs a suite of cases and checks whether this device and this build
 * stay within its budgets and error limits. */
#include "masu/cmd.h"
#include "masu/data.h"
#include "command/options.h"

#include "conform/report.h"
#include "file_kind.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SUITE_BYTES_MAX ((size_t)4 << 20)

typedef struct options {
    const char *suite, *scenes; /* as given */
    const char *glob, *replay, *junit, *csv, *table, *images;
    uint32_t first, of, runs, rays;
    bool rays_given, list;
    char suite_file[MASU_DATA_PATH], scene_folder[MASU_DATA_PATH]; /* as found */
    char suite_name[256]; /* in results: independent of where it was found */
    masu_headless_desc host;
} options;

typedef void (*writer)(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                       uint32_t n, const char *driver);

/* Writes one report completely; "-" is stdout. */
static int write_file(const char *path, writer write, const masu_suite *suite,
                      const masu_conform_result *results, uint32_t n, const char *driver) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    if (!f) return masu_cli_error("%s: out of memory", path);
    write(f, suite, results, n, driver);
    int code =
        fclose(f) ? masu_cli_error("%s: out of memory", path) : masu_text_write(path, text, bytes);
    free(text);
    return code;
}

/* Writes all reports, before each case and at the end: if the run is aborted, the files are
 * complete and name the current case. Standard output, devices and pipes get only the last
 * version. */
static int write_reports(const options *o, const masu_suite *suite,
                         const masu_conform_result *results, uint32_t n, const char *driver,
                         bool last) {
    const struct {
        const char *path;
        writer write;
    } reports[] = {
        {o->junit, masu_conform_junit}, {o->csv, masu_conform_csv}, {o->table, masu_conform_table}};
    int code = MASU_CLI_OK;
    for (size_t i = 0; i < sizeof reports / sizeof *reports; i++) {
        const char *path = reports[i].path;
        bool file = path && strcmp(path, "-") != 0 &&
                    (!masu_file_exists(path) || masu_file_is_regular(path));
        if (path && (last || file))
            code |= write_file(path, reports[i].write, suite, results, n, driver);
    }
    return code;
}

/* The same settings as shell text. */
static char *command_of(const options *o) {
    const char *const given[][2] = {{" --suite ", o->suite},
                                    {" --scenes ", o->scenes},
                                    {" --rays ", o->rays_given ? masu_ray_ways[o->rays] : NULL},
                                    {" --device ", o->host.device}};
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    if (!f) return NULL;
    fputs("masu conform", f);
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        if (!given[i][1]) continue;
        fputs(given[i][0], f);
        masu_shell_quote(f, given[i][1]);
    }
    if (o->host.validate) fputs(" --validate", f);
    if (o->host.gpu_av) fputs(" --gpu-av", f);
    if (!fclose(f)) return text;
    free(text);
    return NULL;
}

/* Warns about missing scenes of these cases. Returns false, with `error` set, if all are
 * missing. */
static bool has_scenes(const options *o, const masu_conform_result *results, uint32_t n,
                       char *error, size_t size) {
    char names[200] = "";
    uint32_t missing = 0, most = 0;
    for (uint32_t i = 0; i < n; i++) {
        char path[MASU_DATA_PATH];
        bool seen = false;
        for (uint32_t k = 0; k < i && !seen; k++)
            seen = !strcmp(results[k].of->scene, results[i].of->scene);
        if (seen) continue;
        most++;
        snprintf(path, sizeof path, "%.3000s/%.1000s.masu", o->scene_folder, results[i].of->scene);
        if (masu_file_exists(path)) continue;
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", missing ? ", " : "",
                 results[i].of->scene);
        missing++;
    }
    if (missing)
        snprintf(error, size,
                 "%u of %u scenes are not baked in %.2000s (%s): `make scenes` in Masu's source "
                 "tree bakes them",
                 missing, most, o->scene_folder, names);
    if (missing && missing < most) masu_cli_warn("%s", error);
    return !missing || missing < most;
}

/* Reports that no case was run, with the reason. */
static int none_run(const options *o, const masu_suite *suite, masu_conform_result *results,
                    uint32_t n, const char *why) {
    for (uint32_t i = 0; i < n; i++) masu_conform_not_run(results[i].of, why, &results[i]);
    (void)write_reports(o, suite, results, n, "", true);
    return masu_cli_error("%s", why);
}

static int run_cases(const options *o, const masu_suite *suite, masu_conform_result *results,
                     uint32_t n) {
    static masu_conform c;
    char error[4096];
    if (o->images && (!masu_folder_make(o->images, error, sizeof error)))
        return none_run(o, suite, results, n, error);
    c = (masu_conform){.suite = suite,
                       .scenes = o->scene_folder,
                       .images = o->images,
                       .host = o->host,
                       .runs = o->runs};
    masu_headless_desc asked = o->host; /* each case requests ray queries itself */
    masu_use_rays(o->rays, &c.ray_query, &asked);
    if (!has_scenes(o, results, n, error, sizeof error))
        return none_run(o, suite, results, n, error);
    /* A driver may crash when it is opened. */
    int written = write_reports(o, suite, results, n, "", false);
    if (written) return written;
    if (!masu_conform_open(&c, error, sizeof error)) return none_run(o, suite, results, n, error);
    char *command = command_of(o);
    bool failed = false;
    bool quiet = masu_cli_quiet();
    if (!quiet) printf("%s, %08x\n%s\n", suite->file, suite->hash, c.driver);
    for (uint32_t i = 0; i < n && command; i++) {
        const masu_case *of = results[i].of;
        masu_cli_progress("case %u of %u: %s", i + 1, n, of->name);
        masu_conform_not_run(of, "the program ended during this case", &results[i]);
        fflush(stdout);
        /* The disk may be full: the cases still run and are printed. */
        if (!written) written = write_reports(o, suite, results, n, c.driver, false);
        masu_conform_run(&c, of, &results[i]);
        masu_cli_progress_clear();
        if (!quiet || results[i].verdict) masu_conform_print(stdout, suite, &results[i], command);
        failed = failed || masu_verdict_failed(results[i].verdict);
    }
    masu_conform_close(&c);
    if (!command) return masu_cli_error("out of memory");
    free(command);
    if (!quiet) masu_conform_sum(stdout, results, n);
    if (!written) written = write_reports(o, suite, results, n, c.driver, true);
    return written || failed ? MASU_CLI_FAILURE : MASU_CLI_OK;
}

static int mark(const options *o, const masu_suite *suite, bool *marks, uint32_t *count) {
    char error[512];
    if (o->replay) {
        int32_t at = masu_replay_find(suite, o->replay, error, sizeof error);
        if (at < 0) return masu_cli_usage_error("--replay: %s", error);
        memset(marks, 0, suite->count * sizeof *marks);
        marks[at] = true;
        *count = 1;
        return MASU_CLI_OK;
    }
    if (!masu_suite_select(suite, o->glob, 0, 1, marks))
        return masu_cli_usage_error("--case: no case of %s matches '%s'", suite->file, o->glob);
    *count = masu_suite_select(suite, o->glob, o->first, o->of, marks);
    return MASU_CLI_OK;
}

static int conform(const options *o) {
    masu_suite suite;
    uint8_t *text = NULL;
    size_t bytes = 0;
    char error[1024];
    if (!masu_file_read(o->suite_file, SUITE_BYTES_MAX, &text, &bytes, error, sizeof error))
        return masu_cli_error("%s", error);
    bool good =
        masu_suite_parse(o->suite_name, (const char *)text, bytes, &suite, error, sizeof error);
    const char *hint = good ? "" : masu_file_hint(o->suite_file, text, bytes, MASU_FILE_SUITE);
    free(text);
    if (!good) return masu_cli_error("%s%s", error, hint);
    uint32_t count = 0;
    bool *marks = calloc(suite.count, sizeof *marks);
    masu_conform_result *results = calloc(suite.count, sizeof *results);
    int code = marks && results ? mark(o, &suite, marks, &count)
                                : masu_cli_error("out of memory for %u cases", suite.count);
    if (!code && o->list) {
        for (uint32_t i = 0; i < suite.count; i++) {
            const masu_case *c = &suite.cases[i];
            if (marks[i]) printf("%-36s %ux%u %s\n", c->name, c->width, c->height, c->scene);
        }
    } else if (!code) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < suite.count; i++)
            if (marks[i])
                masu_conform_not_run(&suite.cases[i], "the run ended before this case",
                                     &results[n++]);
        code = run_cases(o, &suite, results, n);
    }
    free(results);
    free(marks);
    masu_suite_free(&suite);
    return code;
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* A plain name such as `smoke` is a suite of the program; anything else is a file. Returns an exit
 * code. */
static int find_suite(options *o) {
    const char *name = o->suite;
    bool file = strchr(name, '/') || strchr(name, '.');
    snprintf(o->suite_name, sizeof o->suite_name, file ? "%s" : "suites/%s.json", name);
    if (file) {
        snprintf(o->suite_file, sizeof o->suite_file, "%s", name);
        return MASU_CLI_OK;
    }
    char folder[MASU_DATA_PATH];
    if (!masu_data_folder("suites", folder)) {
        return masu_cli_error("no suites found in %s: use --suite FILE.json",
                              folder);
    }
    snprintf(o->suite_file, sizeof o->suite_file, "%.3500s/%.500s.json", folder, name);
    return MASU_CLI_OK;
}

/* Returns an exit code. */
static int find_scenes(options *o) {
    if (o->scenes) {
        snprintf(o->scene_folder, sizeof o->scene_folder, "%s", o->scenes);
        return MASU_CLI_OK;
    }
    if (masu_data_folder("scenes", o->scene_folder)) return MASU_CLI_OK;
    return masu_cli_error(
        "no baked scenes found in %s: run `make scenes install` in Masu's source tree, "
        "or use --scenes DIR",
        o->scene_folder);
}

/* ---- Command line ---------------------------------------------------------------------------- */

static bool read_fraction(masu_cli *cli, void *to) {
    options *o = to;
    int read = 0;
    if (sscanf(cli->value, "%9u,%9u%n", &o->first, &o->of, &read) == 2 && !cli->value[read] &&
        cli->value[0] != '-' && o->first < o->of) {
        return true;
    }
    masu_cli_usage_error("%s: expected I,N with I below N, for example 0,4 to 3,4; found '%s'",
                         cli->option, cli->value);
    return false;
}

static const masu_option rows[] = {
    MASU_HEADING("Cases"),
    MASU_TEXT(options, suite, "suite", "NAME|FILE.json",
              "smoke, full or extreme, which are installed with the program, or a file\n"),
    MASU_TEXT(options, scenes, "scenes", "DIR",
              "folder of the baked scenes (default: the installed scenes)"),
    MASU_TEXT(options, glob, "case", "GLOB", "run only cases whose name matches, e.g. 'memory.*'"),
    MASU_OWN("fraction", "I,N", read_fraction,
             "run only every N-th of these cases, from the I-th (0 to N - 1)"),
    MASU_TEXT(options, replay, "replay", "TOKEN",
              "run only the case of this token, as a failure prints it"),
    MASU_FLAG(options, list, "list", "print the names of the cases and run none"),
    MASU_UINT(options, runs, "runs", 1, 999,
              "timed frames per round, in up to four rounds, of cases with a time limit\n"),
    MASU_HEADING("Output"),
    MASU_OUTPUT(options, junit, "junit", "FILE.xml",
                "write the results as JUnit XML; '-' is stdout"),
    MASU_OUTPUT(options, csv, "csv", "FILE.csv",
                "write the results with all measurements; '-' is stdout"),
    MASU_OUTPUT(options, table, "table", "FILE.md",
                "write rows of a Markdown table: input, limits, measurements; '-' is stdout"),
    MASU_TEXT(options, images, "images", "DIR",
              "write the image of every case as PNG; the folder is created"),
    MASU_HEADING("Device"),
    MASU_RAYS_ROW(options, rays),
    MASU_DEVICE_ROWS(options, host),
    {.name = NULL}};

static int run(masu_cli *cli) {
    static const char *const parts[] = {"case", "fraction", NULL};
    static options o = {.suite = "smoke", .of = 1, .runs = 9};
    masu_given given = {.most = 0, .excess = "the suite is an option, --suite"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    const char *part = masu_first_given(&given, rows, parts);
    if (o.replay && part)
        return masu_cli_usage_error("--replay names one case: it cannot be combined with --%s",
                                    part);
    o.rays_given = masu_is_given(&given, rows, "rays");
    code = find_suite(&o);
    if (!code && !o.list) code = find_scenes(&o);
    return code ? code : conform(&o);
}

const masu_cli_command masu_cmd_conform = {
    .name = "conform",
    .arguments = "[--suite NAME|FILE.json] [options]",
    .summary = "run a conformance suite: limits of memory, counts, errors, times and allocations",
    .details = "Verdicts: pass, quality warning, not supported, resource error, fail. Times are "
               "ratios to a fixed\n"
               "workload whose frames alternate with those of the case. docs/conform.md describes "
               "the suites.\n\n"
               "Exit codes:\n"
               "  0  no case failed or had a resource error\n"
               "  1  a case failed or had a resource error, or the suite could not be run\n"
               "  2  the command line is wrong\n\n"
               "Examples:\n"
               "  masu conform\n"
               "  masu conform --suite full --case 'memory.*' --junit results.xml\n",
    .run = run};
