/* bench.c: `masu bench`: every quality level of a scene, a measured error beside a measured
 * time: the command line of bench/sweep/sweep.h, which measures, and bench/sweep/report.h, which makes rungs,
 * plots and a page of it. */
#include "masu/cmd.h"

#include "bench/sweep/against.h"
#include "bench/measure/picture.h"
#include "bench/sweep/report.h"
#include "bench/sweep/sweep.h"
#include "model/write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_OUT = 1,
    OPTION_FRAMES,
    OPTION_RUNS,
    OPTION_SHARD,
    OPTION_MERGE,
    OPTION_QUICK,
    OPTION_STEADY,
    OPTION_RUNGS_OF,
    OPTION_AGAINST,
    OPTION_CSV
};

enum { PARTS_MOST = 64 };

typedef struct options {
    masu_sweep_desc sweep;
    masu_setting_list only;
    const char *arguments[PARTS_MOST], *against, *rungs_of, *csv;
    uint32_t count;
    bool merge, steady; /* --steady is given */
} options;

/* The model sheet of the ladder, which the report has made: the page is then written once more. */
static void model(const options *o) {
    char error[4096];
    masu_model_desc d = {.scene_path = o->arguments[0],
                         .size = {1920, 1080},
                         .drawn = masu_count_size(o->sweep.size),
                         .time = o->sweep.time,
                         .host = {.device = o->sweep.host.device},
                         .progress = masu_cli_progress_text};
    if (masu_model_write(&d, o->sweep.folder, error, sizeof error)) return;
    masu_cli_warn("there is no model sheet: %s", error);
}

static int report(const options *o) {
    /* A sheet of another ladder does not stay. */
    static const char *const sheets[] = {"model.csv", MASU_MODEL_FRAGMENT};
    char path[4096];
    for (size_t i = 0; i < 2; i++) {
        if (masu_sweep_path(o->sweep.folder, sheets[i], path)) (void)remove(path);
    }
    masu_report_result result;
    char error[4096];
    masu_cli_progress("writing the report");
    if (!masu_report_write(o->sweep.folder, &result, error, sizeof error))
        return masu_cli_error("%s", error);
    if (!o->merge) {
        model(o);
        masu_cli_progress("writing the report");
        if (!masu_report_write(o->sweep.folder, &result, error, sizeof error))
            return masu_cli_error("%s", error);
    }
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
    if (!masu_sweep_merge(o->sweep.folder, o->arguments, o->count, error, sizeof error))
        return masu_cli_error("%s", error);
    return report(o);
}

static int against(const options *o) {
    masu_against result;
    char error[8192];
    if (o->count != 1) return masu_cli_usage_error("--against needs one folder besides its own");
    if (!masu_against_compare(o->arguments[0], o->against, &result, error, sizeof error))
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
    o->sweep.scene_path = o->arguments[0];
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
static bool read_shard(const masu_cli *cli, masu_sweep_desc *d) {
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

static bool read_option(const masu_cli *cli, int id, options *o) {
    masu_sweep_desc *d = &o->sweep;
    switch (id) {
    case OPTION_OUT: d->folder = cli->value; return true;
    case OPTION_FRAMES: return masu_cli_uint(cli, 1, 10000, &d->frames);
    case OPTION_RUNS: return masu_cli_uint(cli, 1, MASU_SWEEP_RUNS_MAX, &d->runs);
    case OPTION_SHARD: return read_shard(cli, d);
    case OPTION_MERGE: o->merge = true; return true;
    case OPTION_STEADY: o->steady = true; return masu_cli_double(cli, 0.0, 3600.0, &d->steady);
    case OPTION_RUNGS_OF: o->rungs_of = cli->value; return true;
    case OPTION_QUICK: d->quick = true; return true;
    case OPTION_AGAINST: o->against = cli->value; return true;
    case OPTION_CSV: o->csv = cli->value; return true;
    case MASU_CLI_ARGUMENT:
        if (o->count == PARTS_MOST) {
            masu_cli_usage_error("more than %d folders", PARTS_MOST);
            return false;
        }
        o->arguments[o->count++] = cli->value;
        return true;
    default: return false;
    }
}

static int run(masu_cli *cli) {
    static options o;
    masu_sweep_desc *d = &o.sweep;
    const masu_truth_places truth = {&d->size, &d->time, &d->truth_path, &d->positions, &d->rays};
    o = (options){.sweep = {.time = 1.0,
                            .rays = MASU_PICTURE_RAYS,
                            .shards = 1,
                            .host = {.message = masu_print_message}}};
    for (;;) {
        int id = masu_cli_next(cli);
        if (id == MASU_CLI_EXIT) return cli->exit_code;
        if (id == MASU_CLI_END) break;
        if (masu_device_option(cli, id, &o.sweep.host)) continue;
        int read = masu_truth_option(cli, id, &truth);
        if (read < 0) return MASU_CLI_USAGE;
        if (read) continue;
        if (!read_option(cli, id, &o)) return MASU_CLI_USAGE;
    }
    if (o.rungs_of && (o.against || o.merge))
        return masu_cli_usage_error("--rungs-of is of measuring: not with --against or --merge");
    if (o.steady && (o.against || o.merge || o.sweep.shards > 1))
        return masu_cli_usage_error("--steady needs all settings and their scene: not with --shard, "
                                    "--merge or --against");
    if (o.rungs_of && o.sweep.folder && !strcmp(o.rungs_of, o.sweep.folder))
        return masu_cli_usage_error("--rungs-of and --out are one folder");
    if (o.against) return against(&o);
    if (o.csv) return masu_cli_usage_error("--csv is of --against");
    if (!o.count)
        return masu_cli_usage_error(o.merge ? "no folder to merge is given" : "no scene is given");
    if (!o.sweep.folder) return masu_cli_usage_error("--out is missing");
    if (o.merge) return merge(&o);
    if (o.count > 1) return masu_cli_usage_error("one scene at a time: '%s'", o.arguments[1]);
    return sweep(&o);
}

static const masu_cli_option list[] = {
    {"out", "DIR", "folder of the results; one with a part of the same sweep is gone on with",
     OPTION_OUT, 'o'},
    MASU_TRUTH_OPTIONS("1"),
    {"frames", "N",
     "in motion before a picture is taken, where one depends on those before\n"
     "(default 32)",
     OPTION_FRAMES, 0},
    {"runs", "N", "timed frames of each setting (default 9)", OPTION_RUNS, 0},
    {"steady", "SECONDS",
     "that each seven rungs of the ladder are timed again when all is\n"
     "measured; 0: not at all (default 60)",
     OPTION_STEADY, 0},
    {"rungs-of", "DIR2",
     "measure the base and the rungs of that folder's ladder alone: to see\n"
     "on another day whether they hold (--against)",
     OPTION_RUNGS_OF, 0},
    {"shard", "I/N", "measure each N-th setting alone, from the I-th on, 0 to N - 1; no report",
     OPTION_SHARD, 0},
    {"merge", NULL,
     "join DIR... of shards in --out, and write the report; a run with SCENE.masu and\n"
     "that --out then times the rungs again",
     OPTION_MERGE, 0},
    {"against", "DIR2",
     "compare each rung of the folder DIR with the same setting there: error and\n"
     "time ratio of the two, and the worst",
     OPTION_AGAINST, 0},
    {"csv", "FILE", "of --against: write it as CSV, - is standard output", OPTION_CSV, 0},
    {"quick", NULL,
     "few settings, 128x72, 4 positions, 8 frames, 2 runs, no rungs again: a test",
     OPTION_QUICK, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_bench = {
    .name = "bench",
    .arguments =
        "SCENE.masu --out DIR [options], or --merge DIR... --out DIR, or DIR --against DIR2",
    .summary = "measure each quality level: error against run time, and the rungs worth having",
    .options = list,
    .details =
        "--truth is DIR/truth.png unless it is given.\n"
        "Into DIR: results.csv, a row per setting; steady.csv, the rungs timed again; ladder.json,\n"
        "the rungs of the Pareto front; index.html, one page with tables, plots and pictures;\n"
        "plots/ if there is gnuplot;\n"
        "model.csv, model.xhtml: the model sheet of these rungs at 1080p (masu model), computed.\n"
        "Where NAME.truth.so lies beside NAME.masu (code, as trusted as this program), surfaces are\n"
        "compared with it. A setting's time is that of frames at rest, in turns with the base\n"
        "setting (all defaults, no upscaling); its picture is the last of some frames in motion.\n",
    .run = run};
