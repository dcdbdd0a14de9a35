/* whole_bench.c: `masu whole-bench`: settings beside a plain renderer, at their own errors and
 * at equal error: the command line of bench/study/whole.h, and its tables. Nothing is judged. */
#include "masu/cmd.h"

#include "bench/sweep/ladder_file.h"
#include "bench/measure/picture.h"
#include "bench/study/whole.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_FRAMES = 1,
    OPTION_RUNS,
    OPTION_MOST,
    OPTION_CURVE,
    OPTION_OWN_MARCH,
    OPTION_RUNG,
    OPTION_LADDER,
    OPTION_CSV,
    OPTION_IMAGES
};

static const char *const metrics[MASU_WHOLE_METRICS] = {"flip", "rmse", "ssim"};
static const char *const phases[MASU_WHOLE_PHASES] = {"motion", "rest"};

typedef struct options {
    masu_whole_desc whole;
    masu_rung rungs[MASU_WHOLE_SETTINGS];
    const char *csv, *ladder;
} options;

/* ---- Tables ---------------------------------------------------------------------------------- */

static void print_errors(const masu_whole_entry *e) {
    printf(" %7.4f %6.2f %7.4f", e->errors.of[MASU_WHOLE_FLIP],
           255.0 * e->errors.of[MASU_WHOLE_RMSE], 1.0 - e->errors.of[MASU_WHOLE_SSIM]);
}

/* Samples, and how many times as long as the setting the plain renderer then takes. */
static void print_equal(const masu_whole *w, const masu_whole_entry *e, int metric, uint32_t most,
                        bool timed) {
    uint32_t k = e->samples[metric];
    char samples[16], ratio[24];
    snprintf(samples, sizeof samples, "%s%u", k ? "" : ">", k ? k : most);
    snprintf(ratio, sizeof ratio, "%s%.2f", k ? "" : ">", masu_whole_equal(w, e, k ? k : most));
    printf(" %5s %8s", samples, timed ? ratio : "-");
}

static void print_table(const options *o, const masu_whole *w) {
    const masu_whole_desc *d = &o->whole;
    printf("%s at %ux%u, %.4g s, truth of %u places and %u rays; %s\n", w->scene, d->size.width,
           d->size.height, d->time, d->positions, d->rays, w->driver);
    printf(
        "plain: march %s; of its time %.1f %% in passes that no plain renderer needs, %.1f %% in "
        "what k samples need once\n",
        w->march, 100.0 * masu_whole_spare(&w->entries[0]),
        100.0 * masu_whole_once(&w->entries[0]));
    printf("a: plain time / own; b: the same with the samples that equal error takes; both in "
           "motion\n");
    printf("%-40s %9s %8s %6s %8s %6s %7s %6s %7s", "setting", "render", "ms", "a", "rest ms",
           "a rest", "flip", "rmse", "ssim");
    for (int m = 0; m < MASU_WHOLE_METRICS; m++) printf(" %5s   b %s", "k", metrics[m]);
    printf("\n");
    for (uint32_t i = 0; i < w->entry_count; i++) {
        const masu_whole_entry *e = &w->entries[i];
        const masu_whole_time *t = e->times;
        char size[32];
        snprintf(size, sizeof size, "%ux%u", e->render.width, e->render.height);
        printf("%-40s %9s", e->name, size);
        for (int phase = 0; phase < MASU_WHOLE_PHASES; phase++) {
            if (d->runs)
                printf(" %8.2f %6.2f", t[phase].wall_ms, t[phase].ratio);
            else
                printf(" %8s %6s", "-", "-");
        }
        if (i == 0 || !e->plain) print_errors(e);
        for (int m = 0; m < MASU_WHOLE_METRICS && !e->plain; m++)
            print_equal(w, e, m, d->most, d->runs > 0);
        printf("\n");
    }
    printf("plain by samples%s: flip rmse ssim:",
           d->own_march || !strcmp(w->march, "none") ? "" : ", marched as Masu does");
    for (uint32_t p = 0; p < w->point_count; p++) {
        const masu_whole_point *at = &w->points[p];
        printf("%s %u: %.4f %.2f %.4f", p ? ";" : "", at->samples, at->errors.of[MASU_WHOLE_FLIP],
               255.0 * at->errors.of[MASU_WHOLE_RMSE], 1.0 - at->errors.of[MASU_WHOLE_SSIM]);
    }
    printf("\n");
}

/* 0 is what is not there, or not counted: the fragment march counts nothing. */
static void number(double value, int digits) {
    if (value > 0.0)
        printf(" %10.*f", digits, value);
    else
        printf(" %10s", "-");
}

/* Where the time went: the plain renderer and the first setting. The passes are the same rows in
 * both plans. */
static void print_passes(const masu_whole *w) {
    const masu_whole_entry *a = &w->entries[0], *b = &w->entries[w->plain_count];
    printf("%-22s %10s %10s\n", "pass, ms", "plain", b->name);
    for (uint32_t p = 0; p < a->pass_count && p < b->pass_count; p++) {
        if (!(a->pass_ms[p] > 0.0) && !(b->pass_ms[p] > 0.0)) continue;
        printf("%-22s", a->pass_names[p]);
        number(a->pass_ms[p], 3);
        number(b->pass_ms[p], 3);
        printf("\n");
    }
}

static void print_count(const char *name, const options *o, uint64_t a, uint64_t b, bool each) {
    double pixels = each ? (double)o->whole.size.width * o->whole.size.height : 1.0;
    if (!a && !b) return;
    printf("%-22s", name);
    number((double)a / pixels, each ? 3 : 0);
    number((double)b / pixels, each ? 3 : 0);
    printf("\n");
}

static void print_counts(const options *o, const masu_whole *w) {
    const masu_whole_entry *a = &w->entries[0], *b = &w->entries[w->plain_count];
    printf("%-22s %10s %10s\n", "of one frame", "plain", b->name);
    print_count("march evals / pixel", o, a->evals, b->evals, true);
    print_count("shadow, ao evals / px", o, a->occlusion_evals, b->occlusion_evals, true);
    print_count("specular rays / pixel", o, a->specular_rays, b->specular_rays, true);
    print_count("their nodes / pixel", o, a->specular_nodes, b->specular_nodes, true);
    print_count("their evals / pixel", o, a->specular_evals, b->specular_evals, true);
    print_count("light tests / pixel", o, a->light_tests, b->light_tests, true);
    print_count("draws", o, a->draws, b->draws, false);
    print_count("triangles", o, a->triangles, b->triangles, false);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static void csv_row(FILE *f, const options *o, const masu_whole *w, const masu_whole_entry *e) {
    const masu_whole_desc *d = &o->whole;
    fprintf(f, "%s,\"%s\",%u,%u,%u,%u,%g,%u,%u,%u,%u,%u,%s", w->scene, e->name, d->size.width,
            d->size.height, e->render.width, e->render.height, d->time, d->positions, d->rays,
            d->frames, d->runs, d->most, w->march);
    for (int p = 0; p < MASU_WHOLE_PHASES; p++) {
        const masu_whole_time *t = &e->times[p];
        fprintf(f, ",%.4f,%.4f,%.4f,%.4f,%.4f,%.3f", t->wall_ms, t->gpu_ms, t->ratio, t->gpu_ratio,
                t->least_ratio, t->plausible);
    }
    fprintf(f, ",%.6f,%.6f,%.6f", e->errors.of[MASU_WHOLE_FLIP], e->errors.of[MASU_WHOLE_RMSE],
            1.0 - e->errors.of[MASU_WHOLE_SSIM]);
    for (int m = 0; m < MASU_WHOLE_METRICS; m++) {
        uint32_t k = e->samples[m];
        fprintf(f, ",%u,%.4f", k, k ? masu_whole_equal(w, e, k) : 0.0);
    }
    fprintf(f, ",%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%.4f,\"%s\"\n",
            (unsigned long long)e->evals, (unsigned long long)e->occlusion_evals,
            (unsigned long long)e->specular_rays, (unsigned long long)e->specular_nodes,
            (unsigned long long)e->specular_evals, (unsigned long long)e->light_tests,
            (unsigned long long)e->draws, (unsigned long long)e->triangles,
            e->plain ? masu_whole_spare(e) : 0.0, w->driver);
}

static bool write_csv(const options *o, const masu_whole *w) {
    FILE *f = strcmp(o->csv, "-") ? fopen(o->csv, "w") : stdout;
    if (!f) return false;
    fprintf(f, "scene,setting,width,height,render_width,render_height,time,positions,rays,frames,"
               "runs,most,plain_march");
    for (int p = 0; p < MASU_WHOLE_PHASES; p++) {
        fprintf(f, ",%s_wall_ms,%s_gpu_ms,%s_ratio,%s_gpu_ratio,%s_least_ratio,%s_plausible",
                phases[p], phases[p], phases[p], phases[p], phases[p], phases[p]);
    }
    fprintf(f, ",flip,rmse,ssim");
    for (int m = 0; m < MASU_WHOLE_METRICS; m++)
        fprintf(f, ",%s_samples,%s_equal_ratio", metrics[m], metrics[m]);
    fprintf(f, ",march_evals,occlusion_evals,specular_rays,specular_nodes,specular_evals,"
               "light_tests,draws,triangles,spare,driver\n");
    for (uint32_t i = 0; i < w->entry_count; i++) csv_row(f, o, w, &w->entries[i]);
    bool good = !ferror(f);
    return (f == stdout || !fclose(f)) && good;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static int whole_bench(const options *o) {
    static masu_whole w;
    char error[4096];
    bool good = masu_whole_run(&o->whole, &w, error, sizeof error);
    masu_cli_progress_clear();
    if (!good) return masu_cli_error("%s", error);
    if (w.entries[0].times[MASU_WHOLE_MOTION].plausible < 0.9 && o->whole.runs)
        masu_cli_warn("timestamps do not fit the wall clock: passes mean little");
    print_table(o, &w);
    if (o->whole.runs) print_passes(&w);
    print_counts(o, &w);
    if (o->csv && !write_csv(o, &w)) return masu_cli_error("%s cannot be written", o->csv);
    return w.messages ? masu_cli_error("the validation layer has reported %u messages", w.messages)
                      : MASU_CLI_OK;
}

static bool add_rung(options *o, const char *name) {
    char error[512];
    if (o->whole.rung_count == MASU_WHOLE_SETTINGS) {
        masu_cli_usage_error("more than %u settings", MASU_WHOLE_SETTINGS);
        return false;
    }
    if (!masu_setting_parse(name, &o->rungs[o->whole.rung_count], error, sizeof error)) {
        masu_cli_usage_error("%s", error);
        return false;
    }
    o->whole.rung_count++;
    return true;
}

static int add_ladder(options *o) {
    static masu_ladder_file ladder;
    char error[1024];
    if (!masu_ladder_read(o->ladder, &ladder, error, sizeof error))
        return masu_cli_error("%s", error);
    if (o->whole.rung_count + ladder.count > MASU_WHOLE_SETTINGS)
        return masu_cli_usage_error("more than %u settings", MASU_WHOLE_SETTINGS);
    for (uint32_t i = 0; i < ladder.count; i++) o->rungs[o->whole.rung_count++] = ladder.rungs[i];
    return MASU_CLI_OK;
}

static bool read_option(const masu_cli *cli, int id, options *o) {
    masu_whole_desc *d = &o->whole;
    switch (id) {
    case OPTION_FRAMES: return masu_cli_uint(cli, 1, 10000, &d->frames);
    case OPTION_RUNS: return masu_cli_uint(cli, 0, MASU_SAMPLES_MAX, &d->runs);
    case OPTION_MOST: return masu_cli_uint(cli, 1, MASU_WHOLE_SAMPLES, &d->most);
    case OPTION_CURVE: d->curve = true; return true;
    case OPTION_OWN_MARCH: d->own_march = true; return true;
    case OPTION_RUNG: return add_rung(o, cli->value);
    case OPTION_LADDER: o->ladder = cli->value; return true;
    case OPTION_IMAGES: d->image_dir = cli->value; return true;
    case MASU_CLI_ARGUMENT:
        if (d->scene_path) {
            masu_cli_usage_error("one scene at a time: '%s'", cli->value);
            return false;
        }
        d->scene_path = cli->value;
        return true;
    default: return false;
    }
}

static int run(masu_cli *cli) {
    static const char *const usual[] = {"base",
                                        "aa=smaa-high",
                                        "scale=0.75+sharpen=off",
                                        "scale=0.75+sharpen=off+aa=smaa-high",
                                        "scale=0.5",
                                        "scale=0.5+sharpen=off",
                                        "scale=0.5+sharpen=off+aa=smaa-high"};
    static options o;
    masu_whole_desc *d = &o.whole;
    const masu_truth_places truth = {&d->size, &d->time, &d->truth_path, &d->positions, &d->rays};
    o = (options){.whole = {.size = {640, 360},
                            .time = 1.0,
                            .positions = MASU_PICTURE_POSITIONS,
                            .rays = MASU_PICTURE_RAYS,
                            .frames = 32,
                            .runs = 9,
                            .most = 64,
                            .rungs = o.rungs,
                            .host = {.message = masu_print_message},
                            .progress = masu_cli_progress_text}};
    for (;;) {
        int id = masu_cli_next(cli);
        if (id == MASU_CLI_EXIT) return cli->exit_code;
        if (id == MASU_CLI_END) break;
        if (masu_device_option(cli, id, &o.whole.host)) continue;
        int read = masu_truth_option(cli, id, &truth);
        if (read < 0) return MASU_CLI_USAGE;
        if (read) continue;
        if (id == OPTION_CSV) {
            if (!masu_output_file_or_stdout(cli, &o.csv)) return cli->exit_code;
            continue;
        }
        if (!read_option(cli, id, &o)) return MASU_CLI_USAGE;
    }
    if (!o.whole.scene_path) return masu_cli_usage_error("no scene is given");
    if (o.ladder) {
        int code = add_ladder(&o);
        if (code) return code;
    }
    bool chosen = o.whole.rung_count > 0;
    for (size_t i = 0; i < sizeof usual / sizeof *usual && !chosen; i++) {
        if (!add_rung(&o, usual[i])) return MASU_CLI_USAGE;
    }
    return whole_bench(&o);
}

static const masu_cli_option list[] = {
    MASU_TRUTH_OPTIONS("1"),
    {"frames", "N", "in motion before a picture is taken (default 32)", OPTION_FRAMES, 0},
    {"runs", "N", "timed frames of each, in motion and at rest; 0: none (default 9)", OPTION_RUNS,
     0},
    {"most", "K", "samples a pixel that the plain renderer may have (default 64)", OPTION_MOST, 0},
    {"curve", NULL, "its error with 1, 2, 4, ... of them, needed or not", OPTION_CURVE, 0},
    {"own-march", NULL,
     "equal error with the plain renderer's own march, which stops at 0.1 of a pixel, and\n"
     "not with Masu's at the plain one's time",
     OPTION_OWN_MARCH, 0},
    {"rung", "SETTING",
     "as masu bench names it: scale=0.5+aa=fxaa; up to 8 times (default: seven of\n"
     "full, 0.75 and half the size)",
     OPTION_RUNG, 0},
    {"ladder", "FILE", "the rungs of a ladder.json of masu bench", OPTION_LADDER, 0},
    {"csv", "FILE", "all numbers as CSV", OPTION_CSV, 0},
    {"images", "DIR", "the truth and the pictures as PNG", OPTION_IMAGES, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_whole_bench = {
    .name = "whole-bench",
    .arguments = "SCENE.masu [options]",
    .summary = "measure whole frames against a plain renderer, at equal error too",
    .options = list,
    .details =
        "Plain: the output's size, each pixel marched by itself, nothing culled, no LODs, ambient\n"
        "occlusion and one unfiltered specular ray at each pixel, no anti-aliasing, no past. The\n"
        "pictures are of a camera in motion; the truth is that of masu render --truth. a is the\n"
        "median over rounds of plain time / own. b is the same with k plain frames, k the least\n"
        "count found whose mean is as near to the truth; the work of taking the mean is left out,\n"
        "shadow maps are drawn once.\n"
        "k is 1 where a single plain frame is at least as near: b is then a.\n"
        "ms is the least wall time from masu_frame to the fence, with a full barrier around each\n"
        "pass. Scenes with an SDF are to be baked with --variants: else the plain renderer\n"
        "has Masu's own march.\n",
    .run = run};
