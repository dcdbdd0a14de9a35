/* bench/study/image.c: `masu bench-image`: what a frame does to the finished picture, timed:
 * upscaling and sharpening, by the library's rungs, and beside them shaders of the bench's own.
 *
 * A case is a row of the table below: a rung, which the library runs on the picture as it does in a
 * frame, or a chain of shaders. All cases take turns; the first run of each is dropped; the least
 * and the median of the rest count, on the wall from submit to fence. Beside it the time between
 * the device's timestamps, which Mesa 22.3's lavapipe is known to get wrong: a case where the two
 * differ by more than a tenth and 0.2 ms is marked. Then each picture is compared with that of the
 * case it is like. Nothing is judged. */
#include "masu/cmd.h"

#include "bench/study/image.h"
#include "clock.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "easu_fast_bytes_counted_comp.spv.h"
#include "easu_fast_bytes_half_comp.spv.h"
#include "easu_gather_comp.spv.h"
#include "rcas_bytes_comp.spv.h"

enum { OPTION_SIZE = 1, OPTION_FROM, OPTION_RUNS, OPTION_CSV, OPTION_ONLY, OPTION_OUTPUT };

#define SPIRV(name) masu_spv_##name, sizeof masu_spv_##name
#define RCAS_02 0.870550563f /* exp2(-0.2) */

/* fetches: of texels by one output pixel, gathers counted as one; middle: images of the output's
 * size between passes; like: the case whose picture this one's is compared with. */
typedef struct bench_case {
    const char *name;
    double fetches;
    uint32_t middle;
    const char *like;
    masu_rung rung;                            /* where there is no chain */
    masu_bench_stage chain[MASU_BENCH_STAGES]; /* words NULL: there is none */
    bool half;                                 /* takes shaderFloat16 */
    masu_bench_stage counted; /* a build of its upscaling that counts tiles left early */
} bench_case;

/* The first is what ratios are to. */
static const bench_case cases[] = {
    {"easu+rcas", 17, 1, NULL, .rung = {.upscale = MASU_ON, .sharpen = MASU_ON, .sharpness = 0.2f}},
    {"fsr1", 12 * 34.0 * 34 / 1024, 0, "easu+rcas",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_ON, .sharpness = 0.2f, .fuse = MASU_ON}},
    {"easu", 12, 0, NULL, .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF}},
    {"easu-fast+rcas", 17, 1, "easu+rcas",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_ON, .sharpness = 0.2f, .easu = MASU_EASU_FAST}},
    {"easu-fast", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .easu = MASU_EASU_FAST},
     .counted = {SPIRV(easu_fast_bytes_counted_comp), 0, 0}},
    {"easu-fast-half", 12, 0, "easu", .half = true,
     .chain = {{SPIRV(easu_fast_bytes_half_comp), 0, 0}}},
    {"bilinear", 4, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .easu = MASU_EASU_BILINEAR}},
    /* Anti-aliasing of the small picture before: beside easu, what it costs and what it changes. */
    {"fxaa+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_FXAA}},
    {"smaa-low+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_SMAA_LOW}},
    {"smaa-high+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_SMAA_HIGH}},
    {"smaa-ultra+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_SMAA_ULTRA}},
    {"gather", 12, 0, "easu", .chain = {{SPIRV(easu_gather_comp), 0, 0}}},
    {"gather+rcas", 17, 1, "easu+rcas",
     .chain = {{SPIRV(easu_gather_comp), 0, 0}, {SPIRV(rcas_bytes_comp), 0, RCAS_02}}},
};

enum { CASES = sizeof cases / sizeof *cases, RUNS_MOST = 99 };

typedef struct options {
    const char *path, *csv, *only, *output;
    VkExtent2D from, to;
    uint32_t runs;
} options;

typedef struct subject {
    masu_renderer *m; /* of a rung */
    void *block;
    masu_bench_chain chain;
    uint32_t runs;
    uint8_t *pixels;
    double rms, flip; /* against the case that this one is like, of 255 and of 1; below 0: none */
    uint32_t most;    /* of 255 */
    double early;     /* tiles that leave early, of all; below 0: nothing counts them */
    double wall[RUNS_MOST], gpu[RUNS_MOST];
} subject;

typedef struct bench {
    const options *o;
    masu_session s; /* the device and a target */
    masu_headless_source source;
    subject subjects[CASES];
    bool on[CASES];
    char error[1024];
} bench;

/* ---- The picture ----------------------------------------------------------------------------- */

/* A third sky (a ramp of few steps), a third of flat and striped discs, a third of noise:
 * something for every branch of an upscaler. */
static void make_picture(uint8_t *rgba, uint32_t width, uint32_t height) {
    uint32_t hash = 1;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++, rgba += 4) {
            double u = (double)x / width, v = (double)y / height, c[3];
            hash = hash * 1664525u + 1013904223u;
            double noise = (double)(hash >> 8) / (1 << 24);
            double cx = fmod(u * 8, 1) - 0.5, cy = fmod(v * 4.5, 1) - 0.5;
            bool disc = cx * cx + cy * cy < 0.12;
            for (int k = 0; k < 3; k++) c[k] = 0.35 + 0.1 * k + 0.25 * v;
            if (v > 0.33 && disc) {
                double stripe = fmod(u * 40 + v * 13, 1) < 0.5 ? 0.2 : 0.8;
                for (int k = 0; k < 3; k++) c[k] = k == (int)(u * 8) % 3 ? stripe : 0.4;
            } else if (v > 0.66) {
                for (int k = 0; k < 3; k++) c[k] = 0.3 + 0.2 * noise + 0.1 * sin(u * 300 + v * 90);
            }
            for (int k = 0; k < 3; k++) rgba[k] = (uint8_t)(255 * fmin(fmax(c[k], 0), 1) + 0.5);
            rgba[3] = 255;
        }
    }
}

static bool make_source(bench *b) {
    uint32_t width = b->o->from.width, height = b->o->from.height;
    struct masu_image image = {0};
    uint8_t *made = NULL;
    bool good;
    if (b->o->path) {
        if (!masu_image_load_png(b->o->path, &image, b->error, sizeof b->error)) return false;
        if (image.width != width || image.height != height) {
            snprintf(b->error, sizeof b->error, "%s is %ux%u, --from says %ux%u", b->o->path,
                     image.width, image.height, width, height);
            masu_image_free(&image);
            return false;
        }
    } else {
        made = malloc((size_t)width * height * 4);
        if (!made) {
            snprintf(b->error, sizeof b->error, "no memory for %ux%u pixels", width, height);
            return false;
        }
        make_picture(made, width, height);
    }
    good = masu_headless_source_create(&b->s.host, made ? made : image.rgba, width, height, width,
                                       height, 0, &b->source, b->error, sizeof b->error);
    free(made);
    masu_image_free(&image);
    return good;
}

/* ---- Cases ----------------------------------------------------------------------------------- */

static bool open_rung(bench *b, const bench_case *c, subject *u) {
    masu_desc d = b->s.desc;
    masu_detail detail;
    masu_memory need;
    masu_commands commands;
    d.source = (masu_source){b->source.view, b->o->from.width, b->o->from.height,
                             VK_FORMAT_R8G8B8A8_UNORM};
    d.rung_count = 1;
    d.rungs[0] = c->rung;
    d.frames_in_flight = 1;
    d.debug.timestamps = 1;
    bool good = !masu_memory_query(&d, &need, &detail);
    u->block = good ? aligned_alloc(64, (size_t)(need.host_bytes + 63) / 64 * 64) : NULL;
    good = good && u->block && !masu_init(&d, u->block, need.host_bytes, &u->m, &detail);
    masu_result result = MASU_INCOMPLETE;
    while (good && result == MASU_INCOMPLETE) {
        result = masu_load(u->m, &commands);
        if (result == MASU_INCOMPLETE &&
            !masu_headless_run(&b->s.host, commands.buffer, b->error, sizeof b->error))
            return false;
    }
    good = good && !result;
    if (!good) snprintf(b->error, sizeof b->error, "%s: %s", c->name, detail.text);
    return good;
}

static bool open_case(bench *b, uint32_t i) {
    const bench_case *c = &cases[i];
    if (!c->chain[0].words) return open_rung(b, c, &b->subjects[i]);
    return masu_bench_chain_open(&b->s.host, c->chain, &b->source, b->o->from, &b->s.targets[0],
                                 false, &b->subjects[i].chain, b->error, sizeof b->error);
}

static bool count_early(bench *b, uint32_t i) {
    masu_bench_stage stages[MASU_BENCH_STAGES] = {cases[i].counted};
    masu_bench_chain chain;
    double wall, gpu;
    b->subjects[i].early = -1;
    if (!stages[0].words) return true;
    bool good = masu_bench_chain_open(&b->s.host, stages, &b->source, b->o->from, &b->s.targets[0],
                                      true, &chain, b->error, sizeof b->error) &&
                masu_bench_chain_run(&chain, &wall, &gpu, b->error, sizeof b->error);
    uint32_t across = (b->o->to.width + MASU_GROUP - 1) / MASU_GROUP;
    uint32_t down = (b->o->to.height + MASU_GROUP - 1) / MASU_GROUP;
    if (good) {
        uint64_t count = masu_bench_chain_count(&chain, MASU_COUNTER_EASU_TILES_EARLY);
        b->subjects[i].early = (double)count / ((double)across * down);
        masu_bench_chain_close(&chain);
    }
    return good;
}

static bool run_rung(bench *b, subject *u, double *wall, double *gpu) {
    masu_commands commands;
    masu_frame_desc frame = {0};
    masu_stats_info stats;
    uint64_t from = masu_clock_ns(NULL);
    if (masu_frame(u->m, &frame, &commands)) {
        snprintf(b->error, sizeof b->error, "%s", masu_last_error(u->m)->text);
        return false;
    }
    if (!masu_headless_run(&b->s.host, commands.buffer, b->error, sizeof b->error)) return false;
    *wall = (double)(masu_clock_ns(NULL) - from) * 1e-9;
    *gpu =
        masu_stats(u->m, commands.slot, &stats) || !stats.timed ? 0 : (double)stats.gpu_ns * 1e-9;
    return true;
}

static bool run_case(bench *b, uint32_t i, bool kept) {
    subject *u = &b->subjects[i];
    double wall, gpu;
    bool good = u->m ? run_rung(b, u, &wall, &gpu)
                     : masu_bench_chain_run(&u->chain, &wall, &gpu, b->error, sizeof b->error);
    if (!good || !kept) return good;
    u->wall[u->runs] = wall;
    u->gpu[u->runs++] = gpu;
    return true;
}

static bool keep_picture(bench *b, uint32_t i) {
    size_t bytes = (size_t)b->o->to.width * b->o->to.height * 4;
    subject *u = &b->subjects[i];
    char path[512];
    if (!run_case(b, i, false) ||
        !masu_headless_target_read(&b->s.host, &b->s.targets[0], b->error, sizeof b->error))
        return false;
    u->pixels = malloc(bytes);
    if (!u->pixels) {
        snprintf(b->error, sizeof b->error, "no memory for %zu bytes of pixels", bytes);
        return false;
    }
    memcpy(u->pixels, b->s.targets[0].mapped, bytes);
    if (!b->o->output) return true;
    snprintf(path, sizeof path, "%s-%s.png", b->o->output, cases[i].name);
    return masu_image_save_png(path, u->pixels, b->o->to.width, b->o->to.height, 0, b->error,
                               sizeof b->error);
}

static bool compare(bench *b, uint32_t i) {
    subject *u = &b->subjects[i], *like = NULL;
    uint32_t width = b->o->to.width, height = b->o->to.height;
    masu_flip flip;
    u->rms = -1;
    for (uint32_t k = 0; k < CASES && cases[i].like; k++) {
        if (b->on[k] && !strcmp(cases[k].name, cases[i].like)) like = &b->subjects[k];
    }
    if (!like) return true;
    u->rms = 255 * masu_metric_rmse(like->pixels, u->pixels, width, height);
    for (size_t k = 0; k < (size_t)width * height * 4; k++) {
        uint32_t d = (uint32_t)abs(like->pixels[k] - u->pixels[k]);
        if (d > u->most) u->most = d;
    }
    if (!masu_metric_flip(like->pixels, u->pixels, width, height, 0, NULL, &flip)) {
        snprintf(b->error, sizeof b->error, "no memory for FLIP of %ux%u pixels", width, height);
        return false;
    }
    u->flip = flip.mean;
    return true;
}

/* ---- Results --------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double least_of(double *v, uint32_t n) {
    qsort(v, n, sizeof *v, by_value);
    return v[0];
}

/* Of compulsory traffic: each image once, read or written. */
static double bytes_per_pixel(const options *o, const bench_case *c) {
    double in = (double)o->from.width * o->from.height, out = (double)o->to.width * o->to.height;
    return 4 * in / out + 4 + 8.0 * c->middle;
}

static void print_rows(bench *b, FILE *f, bool csv) {
    double base = 0;
    if (csv) {
        fprintf(f, "case,driver,ms_min,ms_median,ratio,gpu_ms_min,plausible,fetches,bytes,tiles_"
                   "early,rms,max,flip\n");
    } else {
        fprintf(f, "%s\n%ux%u to %ux%u, %u runs in turns\n\n", b->s.host.driver, b->o->from.width,
                b->o->from.height, b->o->to.width, b->o->to.height, b->o->runs);
        fprintf(
            f,
            "| case | ms | median | ratio | by timestamps | fetches/px | bytes/px | tiles early | "
            "rms/255 | most/255 | FLIP |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    }
    for (uint32_t i = 0; i < CASES; i++) {
        if (!b->on[i]) continue;
        subject *u = &b->subjects[i];
        double wall = 1e3 * least_of(u->wall, u->runs), gpu = 1e3 * least_of(u->gpu, u->runs);
        double median = 1e3 * u->wall[u->runs / 2];
        bool plausible = fabs(wall - gpu) <= 0.1 * wall + 0.2;
        char early[16] = "";
        if (u->early >= 0) snprintf(early, sizeof early, csv ? "%.4f" : "%.3f", u->early);
        char errors[64];
        snprintf(errors, sizeof errors, csv ? ",," : " | | |");
        if (u->rms >= 0)
            snprintf(errors, sizeof errors, csv ? "%.4f,%u,%.5f" : " %.2f | %u | %.4f |", u->rms,
                     u->most, u->flip);
        if (base == 0) base = wall;
        if (csv) {
            fprintf(f, "%s,\"%s\",%.3f,%.3f,%.3f,%.3f,%d,%.3g,%.3g,%s,%s\n", cases[i].name,
                    b->s.host.driver, wall, median, wall / base, gpu, plausible, cases[i].fetches,
                    bytes_per_pixel(b->o, &cases[i]), early, errors);
        } else {
            fprintf(f, "| %s | %.2f | %.2f | %.2f | %.2f%s | %.3g | %.3g | %s |%s\n", cases[i].name,
                    wall, median, wall / base, gpu, plausible ? "" : " (?)", cases[i].fetches,
                    bytes_per_pixel(b->o, &cases[i]), early, errors);
        }
    }
}

static bool write_csv(bench *b) {
    if (!b->o->csv) return true;
    FILE *f = strcmp(b->o->csv, "-") ? fopen(b->o->csv, "w") : stdout;
    bool good = f != NULL;
    if (f) print_rows(b, f, true);
    if (f && f != stdout) good = !fclose(f);
    if (!good) snprintf(b->error, sizeof b->error, "cannot write %s", b->o->csv);
    return good;
}

/* Whether the list of names, with commas between, has that one. */
static bool listed(const char *list, const char *name, size_t n) {
    for (const char *at = list; *at; at += strcspn(at, ","), at += *at == ',') {
        if (strcspn(at, ",") == n && !strncmp(at, name, n)) return true;
    }
    return false;
}

static bool wanted(const options *o, const char *name) {
    return !o->only || listed(o->only, name, strlen(name));
}

/* The first of the list that is no case, as which an empty list counts; NULL: all are. */
static const char *unknown(const char *list) {
    if (!*list) return list;
    for (const char *at = list; *at; at += strcspn(at, ","), at += *at == ',') {
        bool known = false;
        for (uint32_t i = 0; i < CASES && !known; i++)
            known = listed(cases[i].name, at, strcspn(at, ","));
        if (!known) return at;
    }
    return NULL;
}

static bool measure(bench *b, const masu_headless_desc *host) {
    masu_session_desc d = {.desc = {.output = b->o->to, .targets = {.storage = 1}},
                           .host = *host,
                           .no_renderer = true};
    bool good = masu_session_open(&d, &b->s, b->error, sizeof b->error) && make_source(b);
    for (uint32_t i = 0; i < CASES && good; i++) {
        b->on[i] = wanted(b->o, cases[i].name) && (!cases[i].half || b->s.host.float16);
        good = !b->on[i] || (open_case(b, i) && count_early(b, i));
    }
    for (uint32_t run = 0; run <= b->o->runs && good; run++) {
        for (uint32_t i = 0; i < CASES && good; i++) good = !b->on[i] || run_case(b, i, run > 0);
    }
    for (uint32_t i = 0; i < CASES && good; i++) good = !b->on[i] || keep_picture(b, i);
    for (uint32_t i = 0; i < CASES && good; i++) good = !b->on[i] || compare(b, i);
    return good;
}

static int bench_image(const options *o, const masu_headless_desc *host) {
    static bench b;
    memset(&b, 0, sizeof b);
    b.o = o;
    bool good = measure(&b, host);
    if (good && (!o->csv || strcmp(o->csv, "-"))) print_rows(&b, stdout, false);
    good = good && write_csv(&b);
    int code = good ? MASU_CLI_OK : masu_cli_error("%s", b.error);
    masu_headless_settle(&b.s.host);
    for (uint32_t i = 0; i < CASES; i++) {
        masu_destroy(b.subjects[i].m);
        free(b.subjects[i].block);
        free(b.subjects[i].pixels);
        masu_bench_chain_close(&b.subjects[i].chain);
    }
    if (b.source.image) masu_headless_source_destroy(&b.s.host, &b.source);
    code = masu_finish_validation(&b.s.host, code);
    masu_session_close(&b.s);
    return code;
}

static int run(masu_cli *cli) {
    options o = {.from = {960, 540}, .to = {1920, 1080}, .runs = 9};
    masu_headless_desc host = {.message = masu_print_message};
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &host)) continue;
        switch (id) {
        case OPTION_SIZE:
            if (!masu_output_size(cli, &o.to)) return MASU_CLI_USAGE;
            continue;
        case OPTION_FROM:
            if (!masu_output_size(cli, &o.from)) return MASU_CLI_USAGE;
            continue;
        case OPTION_RUNS:
            if (!masu_cli_uint(cli, 1, RUNS_MOST, &o.runs)) return MASU_CLI_USAGE;
            continue;
        case OPTION_CSV:
            if (!masu_output_file_or_stdout(cli, &o.csv)) return cli->exit_code;
            continue;
        case OPTION_ONLY: o.only = cli->value; continue;
        case OPTION_OUTPUT:
            if (!masu_output_file(cli, &o.output)) return cli->exit_code;
            continue;
        case MASU_CLI_ARGUMENT:
            if (o.path) return masu_cli_usage_error("one picture at a time: '%s'", cli->value);
            o.path = cli->value;
            continue;
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    const char *bad = o.only ? unknown(o.only) : NULL;
    if (bad)
        return masu_cli_usage_error("--only: there is no case '%.*s'", (int)strcspn(bad, ","), bad);
    return bench_image(&o, &host);
}

static const masu_cli_option list[] = {
    {"from", "WxH", "size of the picture (default 960x540)", OPTION_FROM, 0},
    {"size", "WxH", "output size (default 1920x1080)", OPTION_SIZE, 0},
    {"runs", "N", "of each case after the first, at most 99 (default 9)", OPTION_RUNS, 0},
    {"only", "CASE,...", "these cases alone", OPTION_ONLY, 0},
    {"output", "NAME", "write what each case makes to NAME-CASE.png", OPTION_OUTPUT, 'o'},
    {"csv", "FILE", "write the rows as CSV; -: to stdout", OPTION_CSV, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_bench_image = {
    .name = "bench-image",
    .arguments = "[IN.png] [options]",
    .summary = "time what is done to the finished picture: upscaling, sharpening",
    .options = list,
    .details = "Without a picture one is made: a third ramp, a third discs, a third noise.\n",
    .run = run};
