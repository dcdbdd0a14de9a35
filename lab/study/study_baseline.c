/* study_baseline.c: `masu-lab study baseline`: settings compared with a baseline renderer, at their
 * own errors and at equal error: the command line of lab/study/baseline.h, and its tables. */
#include "lab/study/study.h"

#include "settings/ladder_file.h"
#include "measure/motion.h"
#include "measure/picture.h"
#include "lab/study/baseline.h"
#include "image.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct options {
    masu_study_options study;
    masu_rung rungs[MASU_BASELINE_SETTINGS];
    uint32_t rung_count, most;
    double step;
    bool curve, own_march;
    const char *ladder;
} options;

static options given = {.study = {.size = {640, 360},
                                  .time = 1.0,
                                  .frames = 32,
                                  .runs = 9,
                                  .truth = {NULL, MASU_PICTURE_POSITIONS, MASU_PICTURE_RAYS}},
                        .step = MASU_MOTION_STEP,
                        .most = 64};
static const masu_study_options *const o = &given.study;

/* ---- Tables ---------------------------------------------------------------------------------- */

/* Shown: the number of samples with which the baseline has the same error (k), and its time then
 * divided by the setting's (b). */
static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"setting", "\"", "setting", NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {"render_width", "%.0f", NULL, NULL},
    {"render_height", "%.0f", NULL, NULL},
    {NULL, NULL, "render", NULL},
    {"time", "%g", NULL, NULL},
    {"positions", "%.0f", NULL, NULL},
    {"rays", "%.0f", NULL, NULL},
    {"frames", "%.0f", NULL, NULL},
    {"step", "%.6g", NULL, NULL},
    {"runs", "%.0f", NULL, NULL},
    {"most", "%.0f", NULL, NULL},
    {"plain_march", NULL, NULL, NULL},
#define PHASE(name, ms, a)                                                                         \
    {name "_wall_ms", "%.4f", NULL, NULL}, {name "_gpu_ms", "%.4f", NULL, NULL},                   \
        {name "_ratio", "%.4f", NULL, NULL}, {name "_gpu_ratio", "%.4f", NULL, NULL},              \
        {name "_least_ratio", "%.4f", NULL, NULL}, {name "_plausible", "%.3f", NULL, NULL},        \
        {NULL, NULL, ms, "%.2f"}, {NULL, NULL, a, "%.2f"}
    PHASE("motion", "ms", "a"),
    PHASE("rest", "rest ms", "a rest"),
    {"flip", "%.6f", NULL, NULL},
    {"rmse", "%.6f", NULL, NULL},
    {"ssim", "%.6f", NULL, NULL},
    {NULL, NULL, "flip", "%.4f"},
    {NULL, NULL, "rmse", "%.2f"},
    {NULL, NULL, "ssim", "%.4f"},
#define METRIC(name)                                                                               \
    {name "_samples", "%.0f", NULL, NULL}, {name "_equal_ratio", "%.4f", NULL, NULL},              \
        {NULL, NULL, "k", NULL}, {NULL, NULL, "b " name, NULL}
    METRIC("flip"),
    METRIC("rmse"),
    METRIC("ssim"),
    {"march_evals", "%.0f", NULL, NULL},
    {"occlusion_evals", "%.0f", NULL, NULL},
    {"specular_rays", "%.0f", NULL, NULL},
    {"specular_nodes", "%.0f", NULL, NULL},
    {"specular_evals", "%.0f", NULL, NULL},
    {"light_tests", "%.0f", NULL, NULL},
    {"draws", "%.0f", NULL, NULL},
    {"triangles", "%.0f", NULL, NULL},
    {"spare", "%.4f", NULL, NULL},
    {"driver", "\"", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

static void add_equal(masu_table *t, const masu_baseline *w, const masu_baseline_entry *e,
                      int metric) {
    uint32_t k = e->samples[metric];
    char samples[16] = "", ratio[24] = "";
    masu_table_number(t, k);
    masu_table_number(t, k ? masu_baseline_equal(w, e, k) : 0.0);
    if (!e->plain) {
        snprintf(samples, sizeof samples, "%s%u", k ? "" : ">", k ? k : given.most);
        snprintf(ratio, sizeof ratio, "%s%.2f", k ? "" : ">",
                 masu_baseline_equal(w, e, k ? k : given.most));
    }
    masu_table_text(t, samples);
    masu_table_text(t, o->runs || e->plain ? ratio : "-");
}

static void add_row(masu_table *t, const masu_baseline *w, uint32_t entry) {
    const masu_baseline_entry *e = &w->entries[entry];
    const double *errors = e->errors.of;
    const bool shown = entry == 0 || !e->plain;
    char size[32];
    snprintf(size, sizeof size, "%ux%u", e->render.width, e->render.height);
    const double sizes[] = {o->size.width, o->size.height, e->render.width, e->render.height};
    const double asked[] = {o->time,   o->truth.positions, o->truth.rays,
                            o->frames, given.step,         o->runs,
                            given.most};
    masu_table_text(t, w->scene);
    masu_table_text(t, e->name);
    masu_table_numbers(t, sizes, sizeof sizes / sizeof *sizes);
    masu_table_text(t, size);
    masu_table_numbers(t, asked, sizeof asked / sizeof *asked);
    masu_table_text(t, w->march);
    for (int p = 0; p < MASU_BASELINE_PHASES; p++) {
        const masu_baseline_time *time = &e->times[p];
        const double times[] = {time->wall_ms,
                                time->gpu_ms,
                                time->ratio,
                                time->gpu_ratio,
                                time->least_ratio,
                                time->plausible,
                                o->runs ? time->wall_ms : (double)NAN,
                                o->runs ? time->ratio : (double)NAN};
        masu_table_numbers(t, times, sizeof times / sizeof *times);
    }
    masu_table_number(t, errors[MASU_BASELINE_FLIP]);
    masu_table_number(t, errors[MASU_BASELINE_RMSE]);
    masu_table_number(t, 1.0 - errors[MASU_BASELINE_SSIM]);
    masu_table_number(t, shown ? errors[MASU_BASELINE_FLIP] : (double)NAN);
    masu_table_number(t, shown ? 255.0 * errors[MASU_BASELINE_RMSE] : (double)NAN);
    masu_table_number(t, shown ? 1.0 - errors[MASU_BASELINE_SSIM] : (double)NAN);
    for (int m = 0; m < MASU_BASELINE_METRICS; m++) add_equal(t, w, e, m);
    const double counts[] = {(double)e->evals,          (double)e->occlusion_evals,
                             (double)e->specular_rays,  (double)e->specular_nodes,
                             (double)e->specular_evals, (double)e->light_tests,
                             (double)e->draws,          (double)e->triangles,
                             e->plain ? masu_baseline_spare(e) : 0.0};
    masu_table_numbers(t, counts, sizeof counts / sizeof *counts);
    masu_table_text(t, w->driver);
}

static void print_head(const masu_baseline *w) {
    fprintf(o->text, "%s at %ux%u, %.4g s, ground truth of %u positions and %u rays; %s\n",
            w->scene, o->size.width, o->size.height, o->time, o->truth.positions, o->truth.rays,
            w->driver);
    fprintf(o->text,
            "plain: march %s; %.1f %% of its time in passes that no baseline renderer needs, %.1f "
            "%% in "
            "work that k samples need once\n",
            w->march, 100.0 * masu_baseline_spare(&w->entries[0]),
            100.0 * masu_baseline_once(&w->entries[0]));
    fprintf(o->text,
            "a: plain time / own; b: the same with the samples needed for equal error; both in "
            "motion\n");
}

static void print_points(const masu_baseline *w) {
    fprintf(o->text, "plain by samples%s: flip rmse ssim:",
            given.own_march || !strcmp(w->march, "none") ? "" : ", with Masu's march");
    for (uint32_t p = 0; p < w->point_count; p++) {
        const masu_baseline_point *at = &w->points[p];
        fprintf(o->text, "%s %u: %.4f %.2f %.4f", p ? ";" : "", at->samples,
                at->errors.of[MASU_BASELINE_FLIP], 255.0 * at->errors.of[MASU_BASELINE_RMSE],
                1.0 - at->errors.of[MASU_BASELINE_SSIM]);
    }
    fprintf(o->text, "\n");
}

/* A row for the baseline and the first setting. 0: not present, or not counted. */
static void add_pair(masu_table *t, const char *name, double a, double b) {
    if (!(a > 0.0) && !(b > 0.0)) return;
    masu_table_text(t, name);
    masu_table_number(t, a > 0.0 ? a : (double)NAN);
    masu_table_number(t, b > 0.0 ? b : (double)NAN);
}

/* Times by pass. The passes are the same rows in both plans. */
static int print_passes(const masu_baseline *w) {
    const masu_baseline_entry *a = &w->entries[0], *b = &w->entries[w->plain_count];
    const masu_column pair[] = {{NULL, NULL, "pass, ms", NULL},
                                {NULL, NULL, "plain", "%.3f"},
                                {NULL, NULL, b->name, "%.3f"},
                                {NULL, NULL, NULL, NULL}};
    masu_table t;
    masu_table_open(&t, pair, "");
    for (uint32_t p = 0; p < a->pass_count && p < b->pass_count; p++)
        add_pair(&t, a->pass_names[p], a->pass_ms[p], b->pass_ms[p]);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, NULL);
}

static int print_counts(const masu_baseline *w) {
    const masu_baseline_entry *a = &w->entries[0], *b = &w->entries[w->plain_count];
    const masu_column pair[] = {{NULL, NULL, "of one frame", NULL},
                                {NULL, NULL, "plain", "%.7g"},
                                {NULL, NULL, b->name, "%.7g"},
                                {NULL, NULL, NULL, NULL}};
    double n = (double)o->size.width * o->size.height;
    masu_table t;
    masu_table_open(&t, pair, "");
#define EACH(name, what) add_pair(&t, name, (double)a->what / n, (double)b->what / n)
    EACH("march evals / pixel", evals);
    EACH("shadow, ao evals / px", occlusion_evals);
    EACH("specular rays / pixel", specular_rays);
    EACH("their nodes / pixel", specular_nodes);
    EACH("their evals / pixel", specular_evals);
    EACH("light tests / pixel", light_tests);
#undef EACH
    add_pair(&t, "draws", (double)a->draws, (double)b->draws);
    add_pair(&t, "triangles", (double)a->triangles, (double)b->triangles);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, NULL);
}

/* ---- Command line ---------------------------------------------------------------------------- */

static bool add_rung(options *to, const char *name) {
    char error[512];
    if (to->rung_count == MASU_BASELINE_SETTINGS) {
        masu_cli_usage_error("more than %u settings", MASU_BASELINE_SETTINGS);
        return false;
    }
    if (!masu_setting_parse(name, &to->rungs[to->rung_count], error, sizeof error)) {
        masu_cli_usage_error("%s", error);
        return false;
    }
    to->rung_count++;
    return true;
}

static bool read_rung(masu_cli *cli, void *to) { return add_rung(to, cli->value); }

static int add_ladder(void) {
    static masu_ladder_file ladder;
    char error[1024];
    if (!masu_ladder_read(given.ladder, &ladder, error, sizeof error))
        return masu_cli_error("%s", error);
    if (given.rung_count + ladder.count > MASU_BASELINE_SETTINGS)
        return masu_cli_usage_error("more than %u settings", MASU_BASELINE_SETTINGS);
    for (uint32_t i = 0; i < ladder.count; i++) given.rungs[given.rung_count++] = ladder.rungs[i];
    return MASU_CLI_OK;
}

/* The given settings, or the default ones. */
static int choose_rungs(void) {
    static const char *const usual[] = {"base",
                                        "aa=smaa-high",
                                        "scale=0.75+sharpen=off",
                                        "scale=0.75+sharpen=off+aa=smaa-high",
                                        "scale=0.5",
                                        "scale=0.5+sharpen=off",
                                        "scale=0.5+sharpen=off+aa=smaa-high"};
    int code = given.ladder ? add_ladder() : MASU_CLI_OK;
    bool chosen = code || given.rung_count > 0;
    for (size_t i = 0; i < sizeof usual / sizeof *usual && !chosen; i++) {
        if (!add_rung(&given, usual[i])) return MASU_CLI_USAGE;
    }
    return code;
}

static int print(const masu_baseline *w) {
    masu_table t;
    masu_table_open(&t, columns, "0");
    for (uint32_t i = 0; i < w->entry_count; i++) add_row(&t, w, i);
    print_head(w);
    masu_table_print(&t, o->text);
    print_points(w);
    int code = o->runs ? print_passes(w) : MASU_CLI_OK;
    code |= print_counts(w);
    return code | masu_table_close(&t, o->csv);
}

static int run(void) {
    static masu_baseline w;
    char error[4096];
    int code = choose_rungs();
    if (code) return code;
    const masu_baseline_desc d = {.scene_path = o->scene,
                               .truth_path = o->truth.path,
                               .image_dir = o->images,
                               .size = o->size,
                               .time = o->time,
                               .positions = o->truth.positions,
                               .rays = o->truth.rays,
                               .frames = o->frames,
                               .step = given.step,
                               .runs = o->runs,
                               .most = given.most,
                               .own_march = given.own_march,
                               .curve = given.curve,
                               .rungs = given.rungs,
                               .rung_count = given.rung_count,
                               .host = o->host,
                               .progress = masu_cli_progress_text};
    bool good = masu_baseline_run(&d, &w, error, sizeof error);
    masu_cli_progress_clear();
    if (!good) return masu_cli_error("%s", error);
    if (w.entries[0].times[MASU_BASELINE_MOTION].plausible < 0.9 && o->runs)
        masu_cli_warn("timestamps do not fit the wall clock: times of passes are unreliable");
    code = print(&w);
    return w.messages ? masu_cli_error("the validation layer has reported %u messages", w.messages)
                      : code;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_TIME,
    MASU_STUDY_TRUTH,
    MASU_STUDY_FRAMES(10000, "in motion before an image is measured"),
    MASU_REAL(options, step, "step", "SECONDS", 0, 10, "between these frames; 0: camera still"),
    MASU_STUDY_RUNS(0, MASU_SAMPLES_MAX),
    MASU_UINT(options, most, "most", 1, MASU_BASELINE_SAMPLES,
              "maximum samples per pixel of the baseline"),
    MASU_FLAG(options, curve, "curve", "its error with 1, 2, 4, ... samples, even if not needed"),
    MASU_FLAG(options, own_march, "own-march",
              "equal error with the baseline's own march, which stops at 0.1 of a pixel,\n"
              "instead of Masu's march at the plain march's time"),
    MASU_OWN("rung", "SETTING", read_rung,
             "in the notation of masu bench: scale=0.5+aa=fxaa; up to 8 times (default:\n"
             "seven at full, 0.75 and half the size)"),
    MASU_TEXT(options, ladder, "ladder", "FILE", "the rungs of a ladder.json of masu bench"),
    MASU_STUDY_CSV,
    MASU_STUDY_IMAGES("the ground truth and the images as PNG"),
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_baseline = {
    .name = "baseline",
    .purpose = "whole frames against a baseline renderer, also at equal error",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details =
        "Plain: the output's size, a separate march per pixel, nothing culled, no LODs, ambient\n"
        "occlusion and one unfiltered specular ray at each pixel, no anti-aliasing, no history. "
        "The\n"
        "camera is in motion, or still (--step 0); the ground truth is drawn as by masu render\n"
        "--truth. a is the median over rounds of plain time / own time. b is the same with k "
        "plain\n"
        "frames, where k is the least count whose mean has at most the setting's error; computing\n"
        "the mean is not timed, and shadow maps are drawn once.\n"
        "k is 1 if a single plain frame is at least as good: then b is a.\n"
        "ms is the least wall time from masu_frame to the fence, with a full barrier around each\n"
        "pass. Scenes with an SDF must be baked with --variants: otherwise the baseline\n"
        "has Masu's own march.\n"};
