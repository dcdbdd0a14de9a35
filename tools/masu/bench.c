/* bench.c: `masu bench`: measures every quality level of a scene, error against run time: the
 * command line of bench/sweep.h, which measures, and of bench/report.h, which writes rungs, plots
 * and a page. */
#include "masu/bench.h"

#include "bench/against.h"
#include "bench/golden.h"
#include "bench/index.h"
#include "measure/picture.h"
#include "bench/report.h"
#include "bench/sweep.h"
#include "bench/sweep_files.h"
#include "clock.h"
#include "file_kind.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    masu_sweep_desc sweep;
    masu_truth_options truth;
    masu_setting_list only;
    masu_given given;
    const char *against, *rungs_of, *csv, *golden, *index;
    bool merge, ladder, steady; /* --steady is given */
} options;

static int report(const options *o) {
    masu_report_result result;
    char error[4096];
    masu_cli_progress("writing the report");
    if (!masu_report_write(o->sweep.folder, &result, error, sizeof error))
        return masu_cli_error("%s", error);
    masu_cli_progress_clear();
    if (result.unsteady > result.rows / 10) {
        masu_cli_warn(
            "%s: noisy times: %u of %u settings vary by more than 10 %%; rerun on an idle machine",
            o->sweep.folder, result.unsteady, result.rows);
    }
    if (!result.plots) masu_cli_warn("gnuplot not found: no plots written");
    if (masu_cli_quiet()) return MASU_CLI_OK;
    printf("%s: %u of %u settings, %u rungs chosen by %s; report: %s/index.html\n", o->sweep.folder,
           result.rows, result.settings, result.rungs,
           result.by_costs        ? "computed costs"
           : result.by_timestamps ? "timestamps"
                                  : "the wall clock",
           o->sweep.folder);
    return MASU_CLI_OK;
}

static int write_index(const char *folder) {
    char error[4096];
    uint32_t count;
    if (!masu_bench_index(folder, &count, error, sizeof error)) return masu_cli_error("%s", error);
    if (!masu_cli_quiet()) printf("%s/index.html: %u scenes\n", folder, count);
    return MASU_CLI_OK;
}

static int merge(const options *o) {
    char error[4096];
    int lock = masu_sweep_lock(o->sweep.folder, error, sizeof error); /* until the process ends */
    if (lock < 0 ||
        !masu_sweep_merge(o->sweep.folder, o->given.arguments, o->given.count, error, sizeof error))
        return masu_cli_error("%s", error);
    return report(o);
}

static int against(const options *o) {
    masu_against result;
    char error[8192];
    if (o->given.count != 1)
        return masu_cli_usage_error("--against: expected one folder to compare with it");
    if (!masu_against_compare(o->given.arguments[0], o->against, &result, error, sizeof error))
        return masu_cli_error("%s", error);
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    bool good = f && masu_against_print(f, &result, o->csv != NULL) >= 0;
    good = f && !fclose(f) && good;
    int code = good ? masu_text_write(o->csv ? o->csv : "-", text, bytes)
                    : masu_cli_error("out of memory");
    free(text);
    return code;
}

/* Times the rungs again, and the settings that replace those that were slower than measured. */
static bool steady(options *o, uint32_t *timed, uint32_t *messages, char *error,
                   size_t error_size) {
    for (;;) {
        static masu_setting_list list;
        masu_sweep_result result;
        list = o->only;
        if (!list.count && !masu_report_unsteady(o->sweep.folder, &list, error, error_size))
            return false;
        if (!list.count) return true;
        if (!masu_sweep_steady(&o->sweep, &list, &result, error, error_size)) return false;
        *messages += result.messages;
        *timed += result.measured;
        if (!result.measured) return true; /* the list is the complete --rungs-of */
    }
}

static int sweep(options *o) {
    masu_sweep_result result;
    uint32_t timed = 0;
    char error[4096];
    if (o->rungs_of) {
        if (!masu_report_rungs(o->rungs_of, &o->only, error, sizeof error))
            return masu_cli_error("%s", error);
        if (!o->only.count) return masu_cli_error("%s: the ladder has no rungs", o->rungs_of);
        o->sweep.only = &o->only;
        o->sweep.like = o->rungs_of;
    }
    o->sweep.scene_path = o->given.arguments[0];
    o->sweep.progress = masu_cli_progress_text;
    masu_sweep_desc *d = &o->sweep; /* members that were not given are 0 */
    if (!d->size.width) d->size = d->quick ? (VkExtent2D){128, 72} : (VkExtent2D){640, 360};
    if (!d->positions) d->positions = d->quick ? 4 : MASU_PICTURE_POSITIONS;
    if (!d->runs) d->runs = d->quick ? 2 : 9;
    if (!d->frames) d->frames = d->quick ? 8 : 32;
    if (!o->steady) d->steady = d->quick ? 0.0 : 60.0;
    if (!masu_clock_advances()) return masu_cli_error("%s", MASU_CLOCK_STOPPED);
    bool good = masu_sweep_run(&o->sweep, &result, error, sizeof error);
    if (good && d->shards == 1 && d->steady > 0.0)
        good = steady(o, &timed, &result.messages, error, sizeof error);
    if (good && o->golden)
        good = masu_golden_rungs(d, o->golden, &result.messages, error, sizeof error);
    masu_cli_progress_clear();
    if (!good) return masu_cli_error("%s", error);
    if (!masu_cli_quiet()) {
        printf("%s: %u settings measured, %u already there, of %u; %u skipped as useless for the "
               "scene; %u timed again\n",
               o->sweep.folder, result.measured, result.there, result.settings, result.dropped,
               timed);
    }
    int code = MASU_CLI_OK;
    if (o->sweep.shards == 1) code = report(o);
    if (result.messages)
        code = masu_cli_error("the validation layer reported %u messages", result.messages);
    return code;
}

/* "0/4" */
static bool read_shard(masu_cli *cli, void *to) {
    masu_sweep_desc *d = &((options *)to)->sweep;
    char *end;
    const char *text = cli->value;
    unsigned long shard = strtoul(text, &end, 10);
    if (end == text || *end != '/' || *text == '-') goto bad;
    const char *of = end + 1;
    unsigned long shards = strtoul(of, &end, 10);
    if (end == of || *end || *of == '-' || shards < 1 || shards > 1000 || shard >= shards) goto bad;
    d->shard = (uint32_t)shard;
    d->shards = (uint32_t)shards;
    return true;
bad:
    masu_cli_usage_error("%s: expected I/N with I from 0 to N - 1 and N up to 1000, found '%s'",
                         cli->option, text);
    return false;
}

static const masu_option rows[] = {
    MASU_HEADING("Output"),
    {MASU_ROW(options, sweep.folder, MASU_TAKE_TEXT, "out", "DIR",
              "folder of the results; an interrupted sweep in it continues"),
     .letter = 'o'},
    MASU_HEADING("Measurement"),
    MASU_SIZE(options, sweep.size, "size", "output size (default 640x360)"),
    MASU_MOMENT_ROW(options, sweep.time),
    MASU_TRUTH_ROWS(options, truth),
    MASU_TEXT(options, golden, "golden", "FILE",
              "linear reference of the scene (.ref, .pfm, .exr): judge 128x72 stills of the\n"
              "rungs at rest by it, into DIR/reference.csv"),
    MASU_UINT(options, sweep.frames, "frames", 1, 10000,
              "frames in motion before the measured image, for settings with history\n"
              "(default 32)"),
    MASU_UINT(options, sweep.runs, "runs", 1, MASU_SWEEP_RUNS_MAX,
              "timed frames per setting (default 9)"),
    MASU_REAL(options, sweep.steady, "steady", "SECONDS", 0.0, 3600.0,
              "after the sweep, time the rungs again: at least so long per group of eleven\n"
              "rungs; 0 disables it (default 60)"),
    MASU_TEXT(options, rungs_of, "rungs-of", "DIR2",
              "measure only the base setting and the rungs of that folder's ladder, to\n"
              "reproduce them with --against"),
    MASU_FLAG(options, sweep.quick, "quick",
              "smoke test: few settings, 128x72, 4 samples, 8 frames, 2 runs, no --steady"),
    MASU_HEADING("Shards"),
    MASU_OWN("shard", "I/N", read_shard,
             "measure every N-th setting from the I-th (0 to N - 1); writes no report"),
    MASU_FLAG(options, merge, "merge",
              "join the shard folders DIR... into --out and write the report; then run\n"
              "SCENE.masu with the same --out to time the rungs again"),
    MASU_HEADING("Comparison of results"),
    MASU_TEXT(options, against, "against", "DIR2",
              "compare every rung of DIR with the same setting in DIR2: difference of\n"
              "error and of time ratio, and the largest differences"),
    MASU_OUTPUT(options, csv, "csv", "FILE", "with --against: write CSV there; '-' is stdout"),
    MASU_TEXT(options, index, "index", "DIR",
              "write DIR/index.html: verdict and link of every result folder in DIR"),
    MASU_FLAG(options, ladder, "ladder", "print the measured ladders LADDER.json..."),
    MASU_HEADING("Device"),
    MASU_DEVICE_ROWS(options, sweep.host),
    {.name = NULL}};

/* Options that cannot be combined; an exit code. */
static int check(const options *o) {
    const bool apart = o->against || o->merge;
    if (o->rungs_of && apart)
        return masu_cli_usage_error("--rungs-of cannot be combined with --against or --merge");
    if (o->steady && (apart || o->sweep.shards > 1))
        return masu_cli_usage_error(
            "--steady cannot be combined with --shard, --merge or --against");
    if (o->rungs_of && o->sweep.folder && !strcmp(o->rungs_of, o->sweep.folder))
        return masu_cli_usage_error("--rungs-of and --out: expected two folders, found one folder");
    if (o->ladder && (apart || o->rungs_of || o->sweep.folder))
        return masu_cli_usage_error("--ladder cannot be combined with %s",
                                    o->against        ? "--against"
                                    : o->merge        ? "--merge"
                                    : o->rungs_of     ? "--rungs-of"
                                                      : "--out");
    if (o->golden && (apart || o->ladder || o->sweep.shards > 1))
        return masu_cli_usage_error(
            "--golden cannot be combined with --shard, --merge, --against or --ladder");
    if (o->index &&
        (apart || o->ladder || o->rungs_of || o->golden || o->sweep.folder || o->given.count))
        return masu_cli_usage_error(
            "--index cannot be combined with scenes, folders or other modes");
    if (o->csv && !o->against) return masu_cli_usage_error("--csv needs --against");
    return MASU_CLI_OK;
}

static int run(masu_cli *cli) {
    static options o = {
        .sweep = {.time = 1.0, .shards = 1, .host = {.message = masu_print_message}},
        .truth = {.rays = MASU_PICTURE_RAYS},
        .given = {.most = MASU_ARGUMENTS_MAX, .excess = "expected at most 64 folders"}};
    int code;
    if (!masu_options_read(cli, rows, &o, &o.given, &code)) return code;
    o.steady = masu_is_given(&o.given, rows, "steady");
    o.sweep.truth_path = o.truth.path;
    o.sweep.positions = o.truth.positions;
    o.sweep.rays = o.truth.rays;
    code = check(&o);
    if (code) return code;
    if (o.index) return write_index(o.index);
    if (o.ladder) return masu_bench_ladder(&o.given);
    if (o.against) return against(&o);
    if (!o.given.count)
        return masu_cli_usage_error(o.merge ? "no folder given: expected the DIR... to merge"
                                            : "no scene given: expected SCENE.masu");
    if (!o.sweep.folder) return masu_cli_usage_error("--out DIR is missing");
    if (o.merge) return merge(&o);
    if (o.given.count > 1)
        return masu_cli_usage_error("unexpected argument '%s': expected one scene",
                                    o.given.arguments[1]);
    char error[4096];
    if (o.truth.path && !masu_file_named(o.truth.path, ".png", error, sizeof error))
        return masu_cli_usage_error("--truth: %s", error);
    if (o.truth.path && !masu_file_exists(o.truth.path) &&
        !masu_file_writable(o.truth.path, error, sizeof error))
        return masu_cli_error("%s", error);
    return sweep(&o);
}

const masu_cli_command masu_cmd_bench = {
    .name = "bench",
    .arguments = "SCENE.masu --out DIR [options]\n"
                 "       masu bench --merge DIR... --out DIR\n"
                 "       masu bench DIR --against DIR2\n"
                 "       masu bench --index DIR\n"
                 "       masu bench --ladder LADDER.json...",
    .summary = "measure error and time of every quality setting, and build a quality ladder",
    .details =
        "Files in DIR:\n"
        "  results.csv        one row per setting\n"
        "  steady.csv         the rungs timed again\n"
        "  ladder.json        the rungs, from the Pareto front\n"
        "  index.html         report with tables, plots and images\n"
        "  reference.csv      with --golden: ratios of patches of each rung at rest\n"
        "  costs.csv          if it is there, costs of settings on GPUs (masu-lab ladder --costs): "
        "the\n"
        "                     rungs are chosen by these instead of times\n"
        "  truth.png          ground truth, unless --truth names a file (64 samples per pixel)\n"
        "  plots/             plots, if gnuplot is installed\n"
        "\n"
        "Method: frames of each setting alternate with frames of the base setting (all defaults, "
        "no\n"
        "upscaling). Times are measured with a stationary camera. The image of a setting is its "
        "last frame\n"
        "in motion. If NAME.truth.so is next to NAME.masu, SDF surfaces are compared with its\n"
        "double-precision field; the file is loaded as code, so it must be trusted.\n\n"
        "Exit codes:\n"
        "  0  success\n"
        "  1  a measurement failed, a file could not be read or written, or --validate reported a\n"
        "     message\n"
        "  2  the command line is wrong\n\n"
        "Examples:\n"
        "  masu bench engine.masu --out results\n"
        "  masu bench engine.masu --out today --rungs-of results\n"
        "  masu bench today --against results\n",
    .run = run};
