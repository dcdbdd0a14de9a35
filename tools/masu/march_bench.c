/* march_bench.c: `masu march-bench`: the ways of marching a scene's SDF side by side: work,
 * time, and error against the truth. */
#include "masu/cmd.h"

#include "bench/measure/run.h"
#include "image.h"
#include "metric/image.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_SIZE = 1,
    OPTION_CSV,
    OPTION_RUNS,
    OPTION_TRUTH,
    OPTION_STRIDE,
    OPTION_TIME,
    OPTION_ONLY,
    OPTION_IMAGES
};

enum { SCENES_MAX = 64 };

typedef struct bench_options {
    masu_bench_desc bench;
    const char *csv;
    const char *scenes[SCENES_MAX];
    uint32_t scene_count;
} bench_options;

/* What the last lines sum up, over the scenes that have both. */
typedef struct summary {
    double log_evals, log_plain, log_seed; /* sums of logarithms: masu against plain, seed */
    uint32_t evals_count, plain_count, seed_count;
    double worst_hitmiss, worst_depth, worst_flip, least_plain, least_seed;
    uint32_t compared;
} summary;

/* ---- Numbers --------------------------------------------------------------------------------- */

/* Of the better plain march; 0 or NAN: not known. */
static double plain_ms(const masu_bench *b) {
    const masu_bench_row *f = &b->rows[MASU_BENCH_FRAGMENT], *c = &b->rows[MASU_BENCH_COMPUTE];
    if (!f->there || !c->there) return f->there ? f->ms : c->there ? c->ms : 0.0;
    return fmin(f->ms, c->ms);
}

static double seed_ms(const masu_bench *b) {
    return b->rows[MASU_BENCH_SEED].there ? b->rows[MASU_BENCH_SEED].ms : 0.0;
}

static double pixels(const bench_options *o) {
    return (double)o->bench.width * (double)o->bench.height;
}

static double unconverged_pct(const bench_options *o, const masu_bench_row *r) {
    return 100.0 * (double)r->unconverged / pixels(o);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static const char *const columns =
    "scene,variant,evals_per_px,ms,ratio_vs_best_plain,hitmiss_pct,depth_off_pct,flip,"
    "ratio_vs_seed,hits,unconverged_pct,frame_wall_ms,sdf_gpu_ms,timing,median_to_least,depth_mean_"
    "px,depth_max_px,"
    "normal_mean_deg,normal_p99_deg,normal_max_deg,rmse,psnr_db,ssim,flip_p99,flip_max,flip_shown,"
    "checker_even_pct,checker_odd_pct,checker_z,checker_p,checker_depth_z,border_pct,interior_pct,"
    "border_z,border_p,border_depth_z,truth_pixels,truth_unsure,width,height,runs,time,driver\n";

/* One field and its comma; n/a where there is nothing to say. */
static void field(FILE *f, bool known, double value) {
    if (!known || isnan(value)) {
        fputs("n/a,", f);
    } else {
        fprintf(f, "%.7g,", value);
    }
}

static void class_fields(FILE *f, bool known, const masu_class_test *t) {
    field(f, known, 100 * t->rate[0]);
    field(f, known, 100 * t->rate[1]);
    field(f, known, t->z);
    field(f, known, t->p);
    field(f, known, t->error_z);
}

/* Names come from files and drivers: quoted, quotes doubled. */
static void quoted(FILE *f, const char *text) {
    fputc('"', f);
    for (; *text; text++) {
        if (*text == '"') fputc('"', f);
        fputc(*text, f);
    }
    fputc('"', f);
}

static void csv_row(FILE *f, const bench_options *o, const masu_bench *b, int v) {
    const masu_bench_row *r = &b->rows[v];
    const masu_march_errors *e = &r->errors;
    bool there = r->there, compared = there && b->compared;
    double plain = plain_ms(b), seed = seed_ms(b);
    bool plain_name = !strpbrk(b->scene, ",\"\n\r");
    if (plain_name) {
        fputs(b->scene, f);
    } else {
        quoted(f, b->scene);
    }
    fprintf(f, ",%s,", masu_bench_names[v]);
    field(f, there, (double)r->evals / pixels(o));
    field(f, there && o->bench.runs, r->ms);
    field(f, there && plain > 0, plain / r->ms);
    field(f, compared, e->hitmiss_pct);
    field(f, compared, e->depth_off_pct);
    field(f, compared, r->flip.mean);
    field(f, there && seed > 0, seed / r->ms);
    field(f, there, (double)r->hits);
    field(f, there, unconverged_pct(o, r));
    field(f, there && o->bench.runs, r->wall_ms);
    field(f, there && r->gpu_ms > 0, r->gpu_ms);
    fprintf(f, "%s,", !there || !o->bench.runs ? "n/a" : b->by_timestamps ? "timestamps" : "wall");
    field(f, there && o->bench.runs, r->spread);
    field(f, compared, e->depth_mean_px);
    field(f, compared, e->depth_max_px);
    field(f, compared, e->normal_mean);
    field(f, compared, e->normal_p99);
    field(f, compared, e->normal_max);
    field(f, compared, r->rmse);
    field(f, compared, masu_metric_psnr(r->rmse));
    field(f, compared, r->ssim);
    field(f, compared, r->flip.p99);
    field(f, compared, r->flip.max);
    field(f, compared, r->shown.mean);
    class_fields(f, compared, &e->checker);
    class_fields(f, compared, &e->border);
    field(f, compared, (double)b->truth_samples);
    field(f, compared, (double)b->truth_unsure);
    fprintf(f, "%" PRIu32 ",%" PRIu32 ",%" PRIu32 ",%.7g,", o->bench.width, o->bench.height,
            o->bench.runs, o->bench.time);
    quoted(f, b->driver);
    fputc('\n', f);
}

/* ---- Table ----------------------------------------------------------------------------------- */

static void cell(int width, const char *format, bool known, double value) {
    char text[64];
    snprintf(text, sizeof text, known && !isnan(value) ? format : "n/a", value);
    printf(" %*s", width, text);
}

static void print_row(const bench_options *o, const masu_bench *b, int v) {
    const masu_bench_row *r = &b->rows[v];
    const masu_march_errors *e = &r->errors;
    double plain = plain_ms(b), seed = seed_ms(b);
    printf("  %-14s", masu_bench_names[v]);
    if (!r->there) {
        printf(" %8s\n", "n/a");
        return;
    }
    bool c = b->compared;
    cell(8, "%.2f", true, (double)r->evals / pixels(o));
    cell(9, "%.0f", true, (double)r->hits);
    cell(8, "%.4f", true, unconverged_pct(o, r));
    cell(8, "%.2f", o->bench.runs > 0, r->ms);
    cell(8, "%.2f", o->bench.runs > 0, r->wall_ms);
    cell(6, "%.2f", plain > 0, plain / r->ms);
    cell(6, "%.2f", seed > 0, seed / r->ms);
    cell(9, "%.4f", c, e->hitmiss_pct);
    cell(9, "%.4f", c, e->depth_off_pct);
    cell(8, "%.4f", c, e->depth_mean_px);
    cell(9, "%.3g", c, e->depth_max_px);
    cell(7, "%.3f", c, e->normal_mean);
    cell(8, "%.5f", c, r->flip.mean);
    cell(8, "%.4f", c, r->flip.p99);
    cell(8, "%.5f", c, r->shown.mean);
    cell(7, "%.1f", c, e->checker.z);
    cell(7, "%.1f", c, e->border.z);
    printf("\n");
}

static void print_scene(const bench_options *o, const masu_bench *b) {
    printf("%s, %" PRIu32 "x%" PRIu32 ", %s\n", b->scene, o->bench.width, o->bench.height,
           b->driver);
    if (b->compared) {
        printf("  truth: %" PRIu64 " rays, %" PRIu64 " undecided and left out, %.1f evaluations a "
               "ray, %.1f s\n",
               b->truth_samples, b->truth_unsure, b->truth_evals, b->truth_seconds);
    } else {
        printf("  truth: none beside the scene; errors are not measured\n");
    }
    if (!o->bench.runs) {
        printf("  ms: not measured\n");
    } else if (b->by_timestamps) {
        printf("  ms: the SDF passes by timestamps, least of %" PRIu32 " runs\n", o->bench.runs);
    } else {
        printf("  ms: the frame's wall time less %.2f, that of a frame with one march step; least "
               "of %" PRIu32 " runs\n      (timestamps do not fit the wall clock)\n",
               b->rest_wall_ms, o->bench.runs);
    }
    printf("  %-14s %8s %9s %8s %8s %8s %6s %6s %9s %9s %8s %9s %7s %8s %8s %8s %7s %7s\n", "",
           "evals/px", "hits", "unconv.%", "ms", "frame", "/plain", "/seed", "hitmiss%", "depth>1%",
           "mean px", "max px", "normal", "FLIP", "p99", "shown", "check z", "tile z");
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++) print_row(o, b, v);
    if (b->compared) {
        const masu_march_errors *e = &b->rows[MASU_BENCH_MASU].errors;
        printf("  masu, wrong pixels: even %.4f %%, odd %.4f %% (chance of such a split %.3g); "
               "tile rim %.4f %%, inside %.4f %% (%.3g)\n",
               100 * e->checker.rate[0], 100 * e->checker.rate[1], e->checker.p,
               100 * e->border.rate[0], 100 * e->border.rate[1], e->border.p);
    }
    double spread = 1.0;
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++) spread = fmax(spread, b->rows[v].spread);
    if (spread > 1.25) {
        printf("  the machine was busy: half of the frames of a variant took %.2f times its least; "
               "more --runs would tell better\n",
               spread);
    }
    printf("\n");
    fflush(stdout);
}

static void add_to_summary(summary *s, const masu_bench *b) {
    const masu_bench_row *own = &b->rows[MASU_BENCH_MASU], *plain = &b->rows[MASU_BENCH_COMPUTE];
    double best = plain_ms(b), seed = seed_ms(b);
    if (!own->there) return;
    if (plain->there && plain->evals && own->evals) {
        s->log_evals += log((double)own->evals / (double)plain->evals);
        s->evals_count++;
    }
    if (best > 0 && own->ms > 0) {
        double ratio = best / own->ms;
        s->least_plain = s->plain_count++ ? fmin(s->least_plain, ratio) : ratio;
        s->log_plain += log(ratio);
    }
    if (seed > 0 && own->ms > 0) {
        double ratio = seed / own->ms;
        s->least_seed = s->seed_count++ ? fmin(s->least_seed, ratio) : ratio;
        s->log_seed += log(ratio);
    }
    if (b->compared) {
        s->compared++;
        s->worst_hitmiss = fmax(s->worst_hitmiss, own->errors.hitmiss_pct);
        s->worst_depth = fmax(s->worst_depth, own->errors.depth_off_pct);
        s->worst_flip = fmax(s->worst_flip, own->flip.mean);
    }
}

static void print_summary(const summary *s) {
    if (s->evals_count) {
        printf("masu: %.1f %% of the plain march's evaluations (geometric mean of %" PRIu32
               " scenes)\n",
               100 * exp(s->log_evals / s->evals_count), s->evals_count);
    }
    if (s->plain_count) {
        printf("masu: %.2fx faster than the better plain march (geometric mean; least %.2fx)\n",
               exp(s->log_plain / s->plain_count), s->least_plain);
    }
    if (s->seed_count) {
        printf("masu: %.2fx faster than the seed's rule (geometric mean; least %.2fx)\n",
               exp(s->log_seed / s->seed_count), s->least_seed);
    }
    if (s->compared) {
        printf("masu: worst of %" PRIu32 " scenes: hit/miss %.4f %%, depth off %.4f %%, FLIP "
               "%.5f\n",
               s->compared, s->worst_hitmiss, s->worst_depth, s->worst_flip);
    }
}

/* ---- The command ----------------------------------------------------------------------------- */

static int run_scenes(bench_options *o, FILE *csv) {
    static masu_bench b;
    summary s;
    char error[1024];
    memset(&s, 0, sizeof s);
    fputs(columns, csv);
    for (uint32_t i = 0; i < o->scene_count; i++) {
        o->bench.scene_path = o->scenes[i];
        if (!masu_bench_run(&o->bench, &b, masu_cli_progress_text, error, sizeof error))
            return masu_cli_error("%s", error);
        masu_cli_progress_clear();
        print_scene(o, &b);
        for (int v = 0; v < MASU_BENCH_VARIANTS; v++) csv_row(csv, o, &b, v);
        add_to_summary(&s, &b);
    }
    print_summary(&s);
    return MASU_CLI_OK;
}

static int run_all(bench_options *o) {
    char *text = NULL, error[512];
    size_t bytes = 0;
    FILE *csv = open_memstream(&text, &bytes);
    if (!csv) return masu_cli_error("no memory for the CSV text");
    int code = run_scenes(o, csv);
    if (fclose(csv) && !code) code = masu_cli_error("no memory for the CSV text");
    if (!code && o->csv && !masu_file_write(o->csv, text, bytes, error, sizeof error))
        code = masu_cli_error("%s", error);
    free(text);
    return code;
}

/* "plain_compute,masu" -> bits. */
static bool only_variants(const char *names, uint32_t *bits) {
    for (const char *at = names; *at;) {
        size_t n = strcspn(at, ",");
        int v = 0;
        while (v < MASU_BENCH_VARIANTS &&
               (strlen(masu_bench_names[v]) != n || strncmp(masu_bench_names[v], at, n) != 0)) {
            v++;
        }
        if (v == MASU_BENCH_VARIANTS) {
            masu_cli_usage_error("--only: there is no way of marching called \"%.*s\"", (int)n, at);
            return false;
        }
        *bits |= 1u << v;
        at += n + (at[n] == ',');
    }
    return true;
}

static int run(masu_cli *cli) {
    bench_options o = {.bench = {.width = 960, .height = 540, .runs = 9, .stride = 1}};
    o.bench.host.message = masu_print_message;
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &o.bench.host)) continue;
        switch (id) {
        case OPTION_SIZE:
            if (!masu_cli_extent(cli, 16384, &o.bench.width, &o.bench.height))
                return MASU_CLI_USAGE;
            continue;
        case OPTION_CSV:
            if (!masu_output_file(cli, &o.csv)) return cli->exit_code;
            continue;
        case OPTION_RUNS:
            if (!masu_cli_uint(cli, 0, 10000, &o.bench.runs)) return MASU_CLI_USAGE;
            if (o.bench.runs && o.bench.runs < 9)
                return masu_cli_usage_error("--runs %u: at least 9, or 0 for no times",
                                            o.bench.runs);
            continue;
        case OPTION_ONLY:
            if (!only_variants(cli->value, &o.bench.only)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TRUTH: o.bench.truth_path = cli->value; continue;
        case OPTION_STRIDE:
            if (!masu_cli_uint(cli, 1, 1024, &o.bench.stride)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TIME:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.bench.time)) return MASU_CLI_USAGE;
            continue;
        case OPTION_IMAGES: o.bench.image_dir = cli->value; continue;
        case MASU_CLI_ARGUMENT:
            if (o.scene_count == SCENES_MAX)
                return masu_cli_usage_error("more than %d scenes", SCENES_MAX);
            o.scenes[o.scene_count++] = cli->value;
            continue;
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (!o.scene_count) return masu_cli_usage_error("no scene is given");
    if (o.bench.truth_path && o.scene_count > 1)
        return masu_cli_usage_error("--truth is for one scene, %u are given", o.scene_count);
    o.bench.stride |= 1; /* an even one would only see pixels of one parity */
    return run_all(&o);
}

static const masu_cli_option options[] = {
    {"size", "WxH", "size in pixels (default 960x540)", OPTION_SIZE, 0},
    {"csv", "FILE", "the same numbers and more, one line for each scene and variant", OPTION_CSV,
     0},
    {"runs", "N", "timed frames of each variant, at least 9 (default 9); 0: counts and errors only",
     OPTION_RUNS, 0},
    {"only", "A,B,...", "draw these ways alone, by the names of the table", OPTION_ONLY, 0},
    {"truth", "FILE.so", "the field in double precision (default: SCENE.truth.so, if it is there)",
     OPTION_TRUTH, 0},
    {"truth-stride", "S",
     "compare every S-th pixel of every S-th row (default 1; an even S is raised by\n"
     "one, so that both colours of the checkerboard are seen)",
     OPTION_STRIDE, 0},
    {"time", "SECONDS", "moment of the scene (default 0)", OPTION_TIME, 0},
    {"images", "FOLDER", "write the truth and every variant there, SCENE.VARIANT.png",
     OPTION_IMAGES, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_march_bench = {
    .name = "march-bench",
    .arguments = "SCENE.masu... [options]",
    .summary = "measure the ways of marching an SDF against each other and the truth",
    .options = options,
    .details =
        "Scenes baked with --variants hold all ways; what a scene lacks is n/a. Frames of all "
        "variants are drawn in\n"
        "turn, the first one changing from round to round; times are the least of the runs. "
        "\"/plain\" and \"/seed\"\n"
        "say how many times faster than the better plain march, and than the seed's rule. Errors "
        "are against rays\n"
        "marched in double precision: hit instead of miss or the reverse, in % of pixels; distance "
        "off by more than\n"
        "1 %, in % of hits; distance error in widths of the pixel there; degrees between normals; "
        "LDR-FLIP of the\n"
        "shaded surfaces, mean and 99th percentile, and of the picture the GPU has made of them. "
        "\"check z\" compares the error rates of even "
        "and odd pixels of the\n"
        "checkerboard, \"tile z\" the rim of 16x16 tiles with their inside, in standard "
        "deviations: beyond 3 is not\n"
        "chance.\n",
    .run = run};
