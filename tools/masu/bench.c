/* bench.c: `masu bench`: measures every quality level of a scene, error against run time: the command line of
 * bench/sweep.h, which measures, and of bench/report.h, which writes rungs, plots and a page. */
#include "masu/bench.h"

#include "bench/against.h"
#include "measure/picture.h"
#include "bench/report.h"
#include "bench/sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    masu_sweep_desc sweep;
    masu_truth_options truth;
    masu_setting_list only;
    masu_given given;
    const char *against, *rungs_of, *csv;
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
        masu_cli_warn("the machine was busy: times of %u of %u settings contradict themselves",
                      result.unsteady, result.rows);
    }
    if (!result.plots) masu_cli_warn("no gnuplot: there are no plots");
    if (masu_cli_quiet()) return MASU_CLI_OK;
    printf("%s: %u of %u settings, %u rungs by %s; see %s/index.html\n", o->sweep.folder,
           result.rows, result.settings, result.rungs,
           result.by_timestamps ? "timestamps" : "the wall clock", o->sweep.folder);
    return MASU_CLI_OK;
}

static int merge(const options *o) {
    char error[4096];
    if (!masu_sweep_merge(o->sweep.folder, o->given.arguments, o->given.count, error, sizeof error))
        return masu_cli_error("%s", error);
    return report(o);
}

static int against(const options *o) {
    masu_against result;
    char error[8192];
    if (o->given.count != 1) return masu_cli_usage_error("--against needs one folder besides its own");
    if (!masu_against_compare(o->given.arguments[0], o->against, &result, error, sizeof error))
        return masu_cli_error("%s", error);
    bool to_file = o->csv && strcmp(o->csv, "-") != 0;
    FILE *f = to_file ? fopen(o->csv, "w") : stdout;
    if (!f) return masu_cli_error("%s: cannot be written", o->csv);
    bool good = masu_against_print(f, &result, o->csv != NULL) >= 0;
    if (to_file) good = !fclose(f) && good;
    return good ? MASU_CLI_OK
                : masu_cli_error("%s: cannot be written", to_file ? o->csv : "output");
}

/* The rungs again, and those that have come up in place of what was not as quick as it looked. */
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
        if (!result.measured) return true; /* the list is the whole of --rungs-of */
    }
}

static int sweep(options *o) {
    masu_sweep_result result;
    uint32_t timed = 0;
    char error[4096];
    if (o->rungs_of) {
        if (!masu_report_rungs(o->rungs_of, &o->only, error, sizeof error))
            return masu_cli_error("%s", error);
        if (!o->only.count) return masu_cli_error("%s: has no rungs", o->rungs_of);
        o->sweep.only = &o->only;
        o->sweep.like = o->rungs_of;
    }
    o->sweep.scene_path = o->given.arguments[0];
    o->sweep.progress = masu_cli_progress_text;
    masu_sweep_desc *d = &o->sweep; /* what has not been given is 0 */
    if (!d->size.width) d->size = d->quick ? (VkExtent2D){128, 72} : (VkExtent2D){640, 360};
    if (!d->positions) d->positions = d->quick ? 4 : MASU_PICTURE_POSITIONS;
    if (!d->runs) d->runs = d->quick ? 2 : 9;
    if (!d->frames) d->frames = d->quick ? 8 : 32;
    if (!o->steady) d->steady = d->quick ? 0.0 : 60.0;
    bool good = masu_sweep_run(&o->sweep, &result, error, sizeof error);
    if (good && d->shards == 1 && d->steady > 0.0)
        good = steady(o, &timed, &result.messages, error, sizeof error);
    masu_cli_progress_clear();
    if (!good) return masu_cli_error("%s", error);
    if (!masu_cli_quiet()) {
        printf("%s: %u settings measured, %u were there; of %u, and %u that the scene has no use "
               "for; %u timed again\n",
               o->sweep.folder, result.measured, result.there, result.settings, result.dropped,
               timed);
    }
    int code = MASU_CLI_OK;
    if (o->sweep.shards == 1) code = report(o);
    if (result.messages)
        code = masu_cli_error("the validation layer has reported %u messages", result.messages);
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
    masu_cli_usage_error("%s '%s': I/N, with I from 0 to N - 1 and N up to 1000", cli->option,
                         text);
    return false;
}

static const masu_option rows[] = {
    {MASU_ROW(options, sweep.folder, MASU_TAKE_TEXT, "out", "DIR",
              "folder of the results; one with a part of the same sweep is gone on with"),
     .letter = 'o'},
    MASU_SIZE(options, sweep.size, "size", "output size (default 640x360)"),
    MASU_MOMENT_ROW(options, sweep.time),
    MASU_TRUTH_ROWS(options, truth),
    MASU_UINT(options, sweep.frames, "frames", 1, 10000,
              "in motion before a picture is taken, where one depends on those before\n"
              "(default 32)"),
    MASU_UINT(options, sweep.runs, "runs", 1, MASU_SWEEP_RUNS_MAX,
              "timed frames of each setting (default 9)"),
    MASU_REAL(options, sweep.steady, "steady", "SECONDS", 0.0, 3600.0,
              "that each seven rungs of the ladder are timed again when all is\n"
              "measured; 0: not at all (default 60)"),
    MASU_TEXT(options, rungs_of, "rungs-of", "DIR2",
              "measure the base and the rungs of that folder's ladder alone: to see\n"
              "on another day whether they hold (--against)"),
    MASU_OWN("shard", "I/N", read_shard,
             "measure each N-th setting alone, from the I-th on, 0 to N - 1; no report"),
    MASU_FLAG(options, merge, "merge",
              "join DIR... of shards in --out, and write the report; a run with SCENE.masu and\n"
              "that --out then times the rungs again"),
    MASU_TEXT(options, against, "against", "DIR2",
              "compare each rung of the folder DIR with the same setting there: error and\n"
              "time ratio of the two, and the worst"),
    MASU_TEXT(options, csv, "csv", "FILE", "of --against: write it as CSV, - is standard output"),
    MASU_FLAG(options, ladder, "ladder", "print the ladders LADDER.json... that have been measured"),
    MASU_FLAG(options, sweep.quick, "quick",
              "few settings, 128x72, 4 positions, 8 frames, 2 runs, no rungs again: a test"),
    MASU_DEVICE_ROWS(options, sweep.host),
    {.name = NULL}};

/* What does not go together; an exit code. */
static int check(const options *o) {
    const bool apart = o->against || o->merge;
    if (o->rungs_of && apart)
        return masu_cli_usage_error("--rungs-of is of measuring: not with --against or --merge");
    if (o->steady && (apart || o->sweep.shards > 1))
        return masu_cli_usage_error("--steady needs all settings and their scene: not with --shard, "
                                    "--merge or --against");
    if (o->rungs_of && o->sweep.folder && !strcmp(o->rungs_of, o->sweep.folder))
        return masu_cli_usage_error("--rungs-of and --out are one folder");
    if (o->ladder && (apart || o->rungs_of || o->sweep.folder))
        return masu_cli_usage_error("--ladder prints what is measured: not with %s",
                                    o->against        ? "--against"
                                    : o->merge        ? "--merge"
                                    : o->rungs_of     ? "--rungs-of"
                                                      : "--out");
    if (o->csv && !o->against) return masu_cli_usage_error("--csv is of --against");
    return MASU_CLI_OK;
}

static int run(masu_cli *cli) {
    static options o = {
        .sweep = {.time = 1.0, .shards = 1, .host = {.message = masu_print_message}},
        .truth = {.rays = MASU_PICTURE_RAYS},
        .given = {.most = MASU_ARGUMENTS_MAX, .excess = "more than 64 folders"}};
    int code;
    if (!masu_options_read(cli, rows, &o, &o.given, &code)) return code;
    o.steady = masu_is_given(&o.given, rows, "steady");
    o.sweep.truth_path = o.truth.path;
    o.sweep.positions = o.truth.positions;
    o.sweep.rays = o.truth.rays;
    code = check(&o);
    if (code) return code;
    if (o.ladder) return masu_bench_ladder(&o.given);
    if (o.against) return against(&o);
    if (!o.given.count)
        return masu_cli_usage_error(o.merge ? "no folder to merge is given" : "no scene is given");
    if (!o.sweep.folder) return masu_cli_usage_error("--out is missing");
    if (o.merge) return merge(&o);
    if (o.given.count > 1)
        return masu_cli_usage_error("one scene at a time: '%s'", o.given.arguments[1]);
    return sweep(&o);
}

const masu_cli_command masu_cmd_bench = {
    .name = "bench",
    .arguments = "SCENE.masu --out DIR [options], or --merge DIR... --out DIR, or DIR --against DIR2,\n"
                 "       or --ladder LADDER.json...",
    .summary = "measure each quality level: error against run time, and the rungs worth having",
    .details =
        "--truth is DIR/truth.png unless it is given; --positions are 64.\n"
        "Into DIR: results.csv, a row per setting; steady.csv, the rungs timed again; ladder.json,\n"
        "the rungs of the Pareto front; index.html, one page with tables, plots and pictures;\n"
        "plots/ if there is gnuplot.\n"
        "Where NAME.truth.so lies beside NAME.masu (code, as trusted as this program), surfaces are\n"
        "compared with it. A setting's time is that of frames at rest, in turns with the base\n"
        "setting (all defaults, no upscaling); its picture is the last of some frames in motion.\n",
    .run = run};
