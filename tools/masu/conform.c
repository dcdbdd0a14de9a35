/* conform.c: `masu conform`: a suite of cases with fixed budgets and error limits, and whether
 * this device and this build keep them. */
#include "masu/cmd.h"

#include "conform/report.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_SUITE = 1,
    OPTION_SCENES,
    OPTION_LIST,
    OPTION_CASE,
    OPTION_FRACTION,
    OPTION_REPLAY,
    OPTION_JUNIT,
    OPTION_CSV,
    OPTION_IMAGES,
    OPTION_RUNS,
    OPTION_RAYS
};

#define SUITE_BYTES_MAX ((size_t)4 << 20)

typedef struct conform_options {
    const char *suite, *scenes, *glob, *replay, *junit, *csv, *images;
    const char *rays; /* as given, for the replay line */
    uint32_t first, of, runs;
    bool list;
    masu_session_desc rays_desc;
    masu_headless_desc host;
} conform_options;

typedef void (*writer)(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                       uint32_t n, const char *driver);

/* A whole file at once; "-" is stdout. */
static int write_file(const char *path, writer write, const masu_suite *suite,
                      const masu_conform_result *results, uint32_t n, const char *driver) {
    char *text = NULL, error[512];
    size_t bytes = 0;
    if (!strcmp(path, "-")) {
        write(stdout, suite, results, n, driver);
        return MASU_CLI_OK;
    }
    FILE *f = open_memstream(&text, &bytes);
    if (!f) return masu_cli_error("%s: no memory for it", path);
    write(f, suite, results, n, driver);
    int code = fclose(f) ? masu_cli_error("%s: no memory for it", path) : MASU_CLI_OK;
    if (!code && !masu_file_write(path, text, bytes, error, sizeof error))
        code = masu_cli_error("%s", error);
    free(text);
    return code;
}

/* The same settings, as a shell takes them. */
static char *command_of(const conform_options *o) {
    const char *const given[][2] = {{" --suite ", o->suite},
                                    {" --scenes ", o->scenes},
                                    {" --rays ", o->rays},
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

static int run_cases(const conform_options *o, const masu_suite *suite, const bool *marks,
                     masu_conform_result *results, uint32_t count) {
    static masu_conform c;
    char error[1024];
    c = (masu_conform){.suite = suite,
                       .scenes = o->scenes,
                       .images = o->images,
                       .host = o->host,
                       .ray_query = o->rays_desc.desc.ray_query,
                       .runs = o->runs};
    if (!masu_conform_open(&c, error, sizeof error)) return masu_cli_error("%s", error);
    char *command = command_of(o);
    uint32_t n = 0;
    bool failed = false;
    bool quiet = masu_cli_quiet();
    if (!quiet) printf("%s, %08x\n%s\n", suite->file, suite->hash, c.driver);
    for (uint32_t i = 0; i < suite->count && command; i++) {
        if (!marks[i]) continue;
        masu_cli_progress("case %u of %u: %s", n + 1, count, suite->cases[i].name);
        masu_conform_run(&c, &suite->cases[i], &results[n]);
        masu_cli_progress_clear();
        if (!quiet || results[n].verdict) masu_conform_print(stdout, suite, &results[n], command);
        fflush(stdout);
        failed = failed || masu_verdict_failed(results[n].verdict);
        n++;
    }
    masu_conform_close(&c);
    int code = command ? MASU_CLI_OK : masu_cli_error("no memory for a line");
    free(command);
    if (code) return code;
    if (!quiet) masu_conform_sum(stdout, results, n);
    if (o->junit) code = write_file(o->junit, masu_conform_junit, suite, results, n, c.driver);
    if (o->csv) code |= write_file(o->csv, masu_conform_csv, suite, results, n, c.driver);
    return code || failed ? MASU_CLI_FAILURE : MASU_CLI_OK;
}

static int mark(const conform_options *o, const masu_suite *suite, bool *marks, uint32_t *count) {
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
        return masu_cli_usage_error("no case of %s is named '%s'", suite->file, o->glob);
    *count = masu_suite_select(suite, o->glob, o->first, o->of, marks);
    return MASU_CLI_OK;
}

static int conform(const conform_options *o) {
    masu_suite suite;
    uint8_t *text = NULL;
    size_t bytes = 0;
    char error[1024];
    if (!masu_file_read(o->suite, SUITE_BYTES_MAX, &text, &bytes, error, sizeof error))
        return masu_cli_error("%s", error);
    bool good = masu_suite_parse(o->suite, (const char *)text, bytes, &suite, error, sizeof error);
    free(text);
    if (!good) return masu_cli_error("%s", error);
    uint32_t count = 0;
    bool *marks = calloc(suite.count, sizeof *marks);
    masu_conform_result *results = calloc(suite.count, sizeof *results);
    int code = marks && results ? mark(o, &suite, marks, &count)
                                : masu_cli_error("no memory for %u cases", suite.count);
    if (!code && o->list) {
        for (uint32_t i = 0; i < suite.count; i++) {
            const masu_case *c = &suite.cases[i];
            if (marks[i]) printf("%-36s %ux%u %s\n", c->name, c->width, c->height, c->scene);
        }
    } else if (!code) {
        code = run_cases(o, &suite, marks, results, count);
    }
    free(results);
    free(marks);
    masu_suite_free(&suite);
    return code;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static bool read_fraction(const masu_cli *cli, conform_options *o) {
    int read = 0;
    if (sscanf(cli->value, "%9u,%9u%n", &o->first, &o->of, &read) == 2 && !cli->value[read] &&
        cli->value[0] != '-' && o->first < o->of) {
        return true;
    }
    masu_cli_usage_error("%s %s: needed is I,N with I below N, as in 0,4 to 3,4", cli->option,
                         cli->value);
    return false;
}

static int run(masu_cli *cli) {
    conform_options o = {
        .suite = "suites/smoke.json", .scenes = "build/scenes", .of = 1, .runs = 9};
    const char *parts = NULL;
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &o.host)) continue;
        switch (id) {
        case OPTION_SUITE: o.suite = cli->value; continue;
        case OPTION_SCENES: o.scenes = cli->value; continue;
        case OPTION_LIST: o.list = true; continue;
        case OPTION_CASE:
            o.glob = cli->value;
            parts = "--case";
            continue;
        case OPTION_FRACTION:
            if (!read_fraction(cli, &o)) return MASU_CLI_USAGE;
            parts = "--fraction";
            continue;
        case OPTION_REPLAY: o.replay = cli->value; continue;
        case OPTION_JUNIT:
            if (!masu_output_file_or_stdout(cli, &o.junit)) return cli->exit_code;
            continue;
        case OPTION_CSV:
            if (!masu_output_file_or_stdout(cli, &o.csv)) return cli->exit_code;
            continue;
        case OPTION_IMAGES: o.images = cli->value; continue;
        case OPTION_RUNS:
            if (!masu_cli_uint(cli, 1, 999, &o.runs)) return MASU_CLI_USAGE;
            continue;
        case OPTION_RAYS:
            if (!masu_rays_option(cli, &o.rays_desc)) return MASU_CLI_USAGE;
            o.rays = cli->value;
            continue;
        case MASU_CLI_ARGUMENT:
            return masu_cli_usage_error("'%s': a suite is given by --suite", cli->value);
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (o.replay && parts) return masu_cli_usage_error("--replay names one case: no %s", parts);
    return conform(&o);
}

static const masu_cli_option list[] = {
    {"suite", "FILE.json", "the cases (default suites/smoke.json)", OPTION_SUITE, 0},
    {"scenes", "DIR", "where baked scenes are (default build/scenes)", OPTION_SCENES, 0},
    {"list", NULL, "print the cases instead of running them", OPTION_LIST, 0},
    {"case", "GLOB", "only cases of such names, as in 'memory.*'", OPTION_CASE, 0},
    {"fraction", "I,N", "of these each N-th from the I-th on, from 0", OPTION_FRACTION, 0},
    {"replay", "TOKEN", "the one case that a failure has named so", OPTION_REPLAY, 0},
    {"junit", "FILE.xml", "the results as JUnit XML", OPTION_JUNIT, 0},
    {"csv", "FILE.csv", "the results with all that was measured; - for stdout", OPTION_CSV, 0},
    {"images", "DIR", "the picture of each case, as PNG", OPTION_IMAGES, 0},
    {"runs", "N", "timed frames in each of up to four rounds, where a case has a limit (default 9)",
     OPTION_RUNS, 0},
    MASU_RAYS_OPTION(OPTION_RAYS),
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_conform = {
    .name = "conform",
    .arguments = "[--suite FILE.json] [options]",
    .summary = "pass or fail against fixed budgets: memory, counts, errors, allocations",
    .options = list,
    .details =
        "Verdicts: pass, quality warning, not supported, resource error, fail. Exit code 0: none\n"
        "of the last two. docs/conform.md describes suites. Times are ratios to a fixed piece of\n"
        "work that takes turns with the case.\n",
    .run = run};
