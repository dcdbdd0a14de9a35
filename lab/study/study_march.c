/* study_march.c: `masu-lab study march`: compares the marches of a scene's SDF: evaluations, time,
 * and error against the double-precision ground truth. */
#include "lab/study/study.h"

#include "lab/study/marches.h"
#include "image.h"
#include "metric/image.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_study_options given = {.size = {960, 540}, .runs = 9, .stride = 1};
static const masu_study_options *const o = &given;

/* Totals for the last lines, over the scenes that have both values. */
typedef struct summary {
    double log_evals, log_plain, log_seed; /* sums of logarithms: masu against plain, seed */
    uint32_t evals_count, plain_count, seed_count;
    double worst_hitmiss, worst_depth, worst_flip, least_plain, least_seed;
    uint32_t compared;
} summary;

/* ---- Numbers --------------------------------------------------------------------------------- */

/* 0 or NAN: unknown. */
static double plain_ms(const masu_bench *b) {
    return b->rows[MASU_BENCH_PLAIN].there ? b->rows[MASU_BENCH_PLAIN].ms : 0.0;
}

static double seed_ms(const masu_bench *b) {
    return b->rows[MASU_BENCH_SEED].there ? b->rows[MASU_BENCH_SEED].ms : 0.0;
}

static double pixels(void) { return (double)o->size.width * (double)o->size.height; }

static double unconverged_pct(const masu_bench_row *r) {
    return 100.0 * (double)r->unconverged / pixels();
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"variant", NULL, "variant", NULL},
    {"evals_per_px", "%.7g", "evals/px", "%.2f"},
    {"ms", "%.7g", "ms", "%.2f"},
    {"ratio_vs_plain", "%.7g", "/plain", "%.2f"},
    {"hitmiss_pct", "%.7g", "hitmiss%", "%.4f"},
    {"depth_off_pct", "%.7g", "depth>1%", "%.4f"},
    {"flip", "%.7g", "FLIP", "%.5f"},
    {"ratio_vs_seed", "%.7g", "/seed", "%.2f"},
    {"hits", "%.7g", "hits", "%.0f"},
    {"unconverged_pct", "%.7g", "unconv.%", "%.4f"},
    {"frame_wall_ms", "%.7g", "frame", "%.2f"},
    {"sdf_gpu_ms", "%.7g", NULL, NULL},
    {"timing", NULL, NULL, NULL},
    {"median_to_least", "%.7g", NULL, NULL},
    {"depth_mean_px", "%.7g", "mean px", "%.4f"},
    {"depth_max_px", "%.7g", "max px", "%.3g"},
    {"normal_mean_deg", "%.7g", "normal", "%.3f"},
    {"normal_p99_deg", "%.7g", NULL, NULL},
    {"normal_max_deg", "%.7g", NULL, NULL},
    {"rmse", "%.7g", NULL, NULL},
    {"psnr_db", "%.7g", NULL, NULL},
    {"ssim", "%.7g", NULL, NULL},
    {"flip_p99", "%.7g", "p99", "%.4f"},
    {"flip_max", "%.7g", NULL, NULL},
    {"flip_shown", "%.7g", "shown", "%.5f"},
    {"checker_even_pct", "%.7g", NULL, NULL},
    {"checker_odd_pct", "%.7g", NULL, NULL},
    {"checker_z", "%.7g", "check z", "%.1f"},
    {"checker_p", "%.7g", NULL, NULL},
    {"checker_depth_z", "%.7g", NULL, NULL},
    {"border_pct", "%.7g", NULL, NULL},
    {"interior_pct", "%.7g", NULL, NULL},
    {"border_z", "%.7g", "tile z", "%.1f"},
    {"border_p", "%.7g", NULL, NULL},
    {"border_depth_z", "%.7g", NULL, NULL},
    {"truth_pixels", "%.7g", NULL, NULL},
    {"truth_unsure", "%.7g", NULL, NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {"runs", "%.0f", NULL, NULL},
    {"time", "%.7g", NULL, NULL},
    {"driver", "\"", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

/* An unknown value is printed as absent. */
static void cell(masu_table *t, bool known, double value) {
    masu_table_number(t, known ? value : (double)NAN);
}

static void class_cells(masu_table *t, bool known, const masu_class_test *c) {
    cell(t, known, 100 * c->rate[0]);
    cell(t, known, 100 * c->rate[1]);
    cell(t, known, c->z);
    cell(t, known, c->p);
    cell(t, known, c->error_z);
}

static void add_row(masu_table *t, const masu_bench *b, int v) {
    const masu_bench_row *r = &b->rows[v];
    const masu_march_errors *e = &r->errors;
    bool there = r->there, timed = there && o->runs, compared = there && b->compared;
    double plain = plain_ms(b), seed = seed_ms(b);
    masu_table_text(t, b->scene);
    masu_table_text(t, masu_bench_names[v]);
    cell(t, there, (double)r->evals / pixels());
    cell(t, timed, r->ms);
    cell(t, there && plain > 0, plain / r->ms);
    cell(t, compared, e->hitmiss_pct);
    cell(t, compared, e->depth_off_pct);
    cell(t, compared, r->flip.mean);
    cell(t, there && seed > 0, seed / r->ms);
    cell(t, there, (double)r->hits);
    cell(t, there, unconverged_pct(r));
    cell(t, timed, r->wall_ms);
    cell(t, there && r->gpu_ms > 0, r->gpu_ms);
    masu_table_text(t, !timed ? "n/a" : b->by_timestamps ? "timestamps" : "wall");
    cell(t, timed, r->spread);
    const double errors[] = {e->depth_mean_px, e->depth_max_px, e->normal_mean,
                             e->normal_p99,    e->normal_max,   r->rmse,
                             masu_metric_psnr(r->rmse), r->ssim, r->flip.p99,
                             r->flip.max,      r->shown.mean};
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) cell(t, compared, errors[i]);
    class_cells(t, compared, &e->checker);
    class_cells(t, compared, &e->border);
    cell(t, compared, (double)b->truth_samples);
    cell(t, compared, (double)b->truth_unsure);
    const double size[] = {o->size.width, o->size.height, o->runs, o->time};
    masu_table_numbers(t, size, sizeof size / sizeof *size);
    masu_table_text(t, b->driver);
}

/* ---- Output ---------------------------------------------------------------------------------- */

static void print_scene(masu_table *t, const masu_bench *b) {
    fprintf(o->text, "%s, %" PRIu32 "x%" PRIu32 ", %s\n", b->scene, o->size.width, o->size.height,
           b->driver);
    if (b->compared) {
        fprintf(o->text,
                "  truth: %" PRIu64 " rays, %" PRIu64 " undecided and skipped, %.1f evaluations a "
                "ray, %.1f s\n",
                b->truth_samples, b->truth_unsure, b->truth_evals, b->truth_seconds);
    } else {
        fprintf(o->text, "  truth: none next to the scene; errors are not measured\n");
    }
    if (!o->runs) {
        fprintf(o->text, "  ms: not measured\n");
    } else if (b->by_timestamps) {
        fprintf(o->text, "  ms: the SDF passes by timestamps, least of %" PRIu32 " runs\n",
                o->runs);
    } else {
        fprintf(o->text,
                "  ms: the frame's wall time less %.2f, that of a frame with one march step; least "
                "of %" PRIu32 " runs\n      (timestamps do not fit the wall clock)\n",
                b->rest_wall_ms, o->runs);
    }
    masu_table_print(t, o->text);
    if (b->compared) {
        const masu_march_errors *e = &b->rows[MASU_BENCH_MASU].errors;
        fprintf(o->text,
                "  masu, wrong pixels: even %.4f %%, odd %.4f %% (chance of such a split %.3g); "
                "tile rim %.4f %%, inside %.4f %% (%.3g)\n",
                100 * e->checker.rate[0], 100 * e->checker.rate[1], e->checker.p,
                100 * e->border.rate[0], 100 * e->border.rate[1], e->border.p);
    }
    double spread = 1.0;
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++) spread = fmax(spread, b->rows[v].spread);
    if (spread > 1.25) {
        fprintf(
            o->text,
            "  the machine was busy: half of the frames of a variant took %.2f times its least; "
            "use more --runs\n",
            spread);
    }
    fprintf(o->text, "\n");
    fflush(o->text);
}

static void add_to_summary(summary *s, const masu_bench *b) {
    const masu_bench_row *own = &b->rows[MASU_BENCH_MASU], *plain = &b->rows[MASU_BENCH_PLAIN];
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
        fprintf(o->text,
                "masu: %.1f %% of the plain march's evaluations (geometric mean of %" PRIu32
                " scenes)\n",
                100 * exp(s->log_evals / s->evals_count), s->evals_count);
    }
    if (s->plain_count) {
        fprintf(o->text, "masu: %.2fx faster than the plain march (geometric mean; least %.2fx)\n",
               exp(s->log_plain / s->plain_count), s->least_plain);
    }
    if (s->seed_count) {
        fprintf(o->text, "masu: %.2fx faster than the seed's rule (geometric mean; least %.2fx)\n",
               exp(s->log_seed / s->seed_count), s->least_seed);
    }
    if (s->compared) {
        fprintf(o->text,
                "masu: worst of %" PRIu32 " scenes: hit/miss %.4f %%, depth off %.4f %%, FLIP "
                "%.5f\n",
                s->compared, s->worst_hitmiss, s->worst_depth, s->worst_flip);
    }
}

/* ---- The study ------------------------------------------------------------------------------- */

static bool run_scenes(uint32_t only, masu_table *t) {
    static masu_bench b;
    summary s;
    char error[1024];
    memset(&s, 0, sizeof s);
    for (uint32_t i = 0; i < o->given.count; i++) {
        const masu_bench_desc d = {.scene_path = o->given.arguments[i],
                                   .truth_path = o->field,
                                   .image_dir = o->images,
                                   .width = o->size.width,
                                   .height = o->size.height,
                                   .stride = o->stride,
                                   .runs = o->runs,
                                   .only = only,
                                   .time = o->time,
                                   .host = o->host};
        if (!masu_bench_run(&d, &b, masu_cli_progress_text, error, sizeof error)) {
            masu_cli_error("%s", error);
            return false;
        }
        masu_cli_progress_clear();
        for (int v = 0; v < MASU_BENCH_VARIANTS; v++) add_row(t, &b, v);
        print_scene(t, &b);
        add_to_summary(&s, &b);
    }
    print_summary(&s);
    return true;
}

static int run(void) {
    uint32_t only = 0;
    if (o->only &&
        !masu_read_names("--only", o->only, masu_bench_names, MASU_BENCH_VARIANTS, &only))
        return MASU_CLI_USAGE;
    if (o->runs && o->runs < 9)
        return masu_cli_usage_error("--runs %u: at least 9, or 0 for no times", o->runs);
    if (o->field && o->given.count > 1)
        return masu_cli_usage_error("--truth is for one scene, not %u", o->given.count);
    masu_table t;
    masu_table_open(&t, columns, "n/a");
    bool good = run_scenes(only, &t);
    int code = masu_table_close(&t, good ? o->csv : NULL);
    return good ? code : MASU_CLI_FAILURE;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_CSV,
    MASU_STUDY_RUNS(0, 10000),
    MASU_STUDY_ONLY,
    MASU_STUDY_FIELD,
    MASU_STUDY_STRIDE,
    MASU_STUDY_TIME,
    MASU_STUDY_IMAGES("write the ground truth and every variant there, SCENE.VARIANT.png"),
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_march = {
    .name = "march",
    .purpose = "the ways of marching an SDF: evaluations, time, and error against the ground truth",
    .arguments = "SCENE.masu... [options]",
    .scenes_min = 1,
    .scenes_max = MASU_ARGUMENTS_MAX,
    .options = rows,
    .given = &given,
    .run = run,
    .details = "Bake the scenes with the lab's masu-bake --variants (make study does): a march "
               "that a scene lacks has\n"
               "no numbers. The variants alternate, and each round starts with another variant; "
               "times are\n"
               "the least of at least 9 runs. \"/plain\" and \"/seed\" are the speed-up over the "
               "marches plain\n"
               "and seed. Errors are against rays marched in double precision: hit instead of miss "
               "or the\n"
               "reverse, in % of pixels; distance error above 1 %, in % of hits; distance error in "
               "widths of the\n"
               "pixel at that distance; degrees between normals; LDR-FLIP of the shaded surfaces, "
               "mean and 99th\n"
               "percentile, and of the GPU's own image. \"check z\" compares the error rates of "
               "even and odd pixels of\n"
               "a checkerboard, and \"tile z\" the rim of 16x16 tiles with their inside, in "
               "standard deviations: above 3\n"
               "the difference is significant.\n"};
