/* study_upscale.c: `masu-lab study upscale`: times the last passes of a frame, which process the
 * finished image: upscaling and sharpening, by the library's rungs and by shaders of this study.
 *
 * A case is a row of the table below: a rung, which the library runs on the image as in a frame, or
 * a chain of shaders. The runs of all cases alternate; the first run of each is dropped; the least
 * and the median of the rest count, as wall time from submit to fence. Also printed is the time
 * between the device's timestamps, which Mesa 22.3's lavapipe gets wrong: a case where the two
 * differ by more than a tenth and 0.2 ms is marked. Then each image is compared with that of the
 * case in `like`. The study only reports. */
#include "lab/study/study.h"

#include "lab/study/upscale.h"
#include "clock.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "easu_bytes_comp.spv.h"
#include "easu_fast_bytes_counted_comp.spv.h"
#include "easu_fast_bytes_half_comp.spv.h"
#include "easu_gather_comp.spv.h"
#include "rcas_bytes_comp.spv.h"

#define SPIRV(name) masu_spv_##name, sizeof masu_spv_##name
#define RCAS_02 0.870550563f /* exp2(-0.2) */

/* fetches: texels per output pixel, a gather counted as one; middle: images of the output's size
 * between passes; like: the case with which the image is compared. */
typedef struct bench_case {
    const char *name;
    double fetches;
    uint32_t middle;
    const char *like;
    masu_rung rung;                            /* without a chain */
    masu_bench_stage chain[MASU_BENCH_STAGES]; /* words NULL: none */
    bool half;                                 /* needs shaderFloat16 */
    masu_bench_stage counted; /* a variant of its upscaling that counts tiles left early */
} bench_case;

/* Ratios are to the first. */
static const bench_case cases[] = {
    {"easu+rcas", 17, 1, NULL, .rung = {.upscale = MASU_ON, .sharpen = MASU_ON, .sharpness = 0.2f}},
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
    /* Anti-aliasing before upscaling: its cost and effect, compared with easu. */
    {"fxaa+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_FXAA}},
    {"smaa-low+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_SMAA_LOW}},
    {"smaa-high+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_SMAA_HIGH}},
    {"smaa-ultra+easu", 12, 0, "easu",
     .rung = {.upscale = MASU_ON, .sharpen = MASU_OFF, .aa = MASU_AA_SMAA_ULTRA}},
    {"gather", 12, 0, "easu", .chain = {{SPIRV(easu_gather_comp), 0, 0}}},
    /* The image between the two passes has 8 bits instead of 10. */
    {"easu+rcas-8", 17, 1, "easu+rcas",
     .chain = {{SPIRV(easu_bytes_comp), 0, 0}, {SPIRV(rcas_bytes_comp), 0, RCAS_02}}},
};

enum { CASES = sizeof cases / sizeof *cases, RUNS_MOST = 99 };

typedef struct options {
    masu_study_options study;
    VkExtent2D from;
} options;

static options given = {.study = {.size = {1920, 1080}, .runs = 9}, .from = {960, 540}};
static const masu_study_options *const o = &given.study;

typedef struct subject {
    masu_renderer *m; /* of a rung */
    void *block;
    masu_bench_chain chain;
    uint32_t runs;
    uint8_t *pixels;
    double rms, flip; /* against the case in `like`, of 255 and of 1; below 0: none */
    uint32_t most;    /* of 255 */
    double early;     /* share of tiles left early; below 0: not counted */
    double wall[RUNS_MOST], gpu[RUNS_MOST];
} subject;

typedef struct bench {
    masu_session s; /* the device and a target */
    masu_headless_source source;
    subject subjects[CASES];
    uint32_t only; /* bit: case */
    char error[1024];
} bench;

static bool on(const bench *b, uint32_t i) { return b->only >> i & 1u; }

/* ---- The image ------------------------------------------------------------------------------- */

/* A third sky (a ramp of few steps), a third flat and striped discs, a third noise, to reach every
 * branch of an upscaler. */
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
    uint32_t width = given.from.width, height = given.from.height;
    struct masu_image image = {0};
    uint8_t *made = NULL;
    bool good;
    if (o->scene) {
        if (!masu_image_load_png(o->scene, &image, b->error, sizeof b->error)) return false;
        if (image.width != width || image.height != height) {
            snprintf(b->error, sizeof b->error, "%s is %ux%u, --from is %ux%u", o->scene,
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
    d.source = (masu_source){b->source.view, given.from.width, given.from.height,
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
        result = masu_load(u->m, &commands, NULL);
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
    return masu_bench_chain_open(&b->s.host, c->chain, &b->source, given.from, &b->s.targets[0],
                                 false, &b->subjects[i].chain, b->error, sizeof b->error);
}

static bool count_early(bench *b, uint32_t i) {
    masu_bench_stage stages[MASU_BENCH_STAGES] = {cases[i].counted};
    masu_bench_chain chain;
    double wall, gpu;
    b->subjects[i].early = -1;
    if (!stages[0].words) return true;
    bool good = masu_bench_chain_open(&b->s.host, stages, &b->source, given.from, &b->s.targets[0],
                                      true, &chain, b->error, sizeof b->error) &&
                masu_bench_chain_run(&chain, &wall, &gpu, b->error, sizeof b->error);
    uint32_t across = (o->size.width + MASU_GROUP - 1) / MASU_GROUP;
    uint32_t down = (o->size.height + MASU_GROUP - 1) / MASU_GROUP;
    if (good) {
        uint64_t count = masu_bench_chain_count(&chain, MASU_COUNTER_EASU_TILES_EARLY);
        b->subjects[i].early = (double)count / ((double)across * down);
        masu_bench_chain_close(&chain);
    }
    return good;
}

static bool run_rung(bench *b, subject *u, double *wall, double *gpu) {
    masu_commands commands;
    masu_frame_desc frame = {MASU_FRAME_DESC};
    masu_stats_info stats;
    uint64_t from = masu_clock_ns(NULL);
    if (masu_frame(u->m, &frame, &commands, &b->s.detail)) {
        snprintf(b->error, sizeof b->error, "%s", b->s.detail.text);
        return false;
    }
    if (!masu_headless_run(&b->s.host, commands.buffer, b->error, sizeof b->error)) return false;
    *wall = (double)(masu_clock_ns(NULL) - from) * 1e-9;
    *gpu = masu_stats(u->m, commands.slot, &stats, NULL) || !stats.timed
               ? 0
               : (double)stats.gpu_ns * 1e-9;
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
    size_t bytes = (size_t)o->size.width * o->size.height * 4;
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
    if (!o->images) return true;
    snprintf(path, sizeof path, "%s/%s.png", o->images, cases[i].name);
    return masu_image_save_png(path, u->pixels, o->size.width, o->size.height, 0, b->error,
                               sizeof b->error);
}

static bool compare(bench *b, uint32_t i) {
    subject *u = &b->subjects[i], *like = NULL;
    uint32_t width = o->size.width, height = o->size.height;
    masu_flip flip;
    u->rms = -1;
    for (uint32_t k = 0; k < CASES && cases[i].like; k++) {
        if (on(b, k) && !strcmp(cases[k].name, cases[i].like)) like = &b->subjects[k];
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

/* The minimum traffic: each image read or written once. */
static double bytes_per_pixel(const bench_case *c) {
    double in = (double)given.from.width * given.from.height;
    double out = (double)o->size.width * o->size.height;
    return 4 * in / out + 4 + 8.0 * c->middle;
}

static const masu_column columns[] = {
    {"case", NULL, "case", NULL},
    {"driver", "\"", NULL, NULL},
    {"ms_min", "%.3f", "ms", "%.2f"},
    {"ms_median", "%.3f", "median", "%.2f"},
    {"ratio", "%.3f", "ratio", "%.2f"},
    {"gpu_ms_min", "%.3f", "by timestamps", "%.2f"},
    {NULL, NULL, "", NULL},
    {"plausible", "%.0f", NULL, NULL},
    {"fetches", "%.3g", "fetches/px", "%.3g"},
    {"bytes", "%.3g", "bytes/px", "%.3g"},
    {"tiles_early", "%.4f", "tiles early", "%.3f"},
    {"rms", "%.4f", "rms/255", "%.2f"},
    {"max", "%.0f", "most/255", "%.0f"},
    {"flip", "%.5f", "FLIP", "%.4f"},
    {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, bench *b, uint32_t i, double *base) {
    subject *u = &b->subjects[i];
    bool alike = u->rms >= 0;
    double wall = 1e3 * least_of(u->wall, u->runs), gpu = 1e3 * least_of(u->gpu, u->runs);
    bool plausible = fabs(wall - gpu) <= 0.1 * wall + 0.2;
    if (*base == 0) *base = wall;
    masu_table_text(t, cases[i].name);
    masu_table_text(t, b->s.host.driver);
    masu_table_number(t, wall);
    masu_table_number(t, 1e3 * u->wall[u->runs / 2]);
    masu_table_number(t, wall / *base);
    masu_table_number(t, gpu);
    masu_table_text(t, plausible ? "" : "(?)");
    masu_table_number(t, plausible);
    masu_table_number(t, cases[i].fetches);
    masu_table_number(t, bytes_per_pixel(&cases[i]));
    masu_table_number(t, u->early >= 0 ? u->early : (double)NAN);
    masu_table_number(t, alike ? u->rms : (double)NAN);
    masu_table_number(t, alike ? u->most : (double)NAN);
    masu_table_number(t, alike ? u->flip : (double)NAN);
}

static int print(bench *b) {
    masu_table t;
    double base = 0;
    masu_table_open(&t, columns, "");
    for (uint32_t i = 0; i < CASES; i++) {
        if (on(b, i)) add_row(&t, b, i, &base);
    }
    fprintf(o->text, "%s\n%ux%u to %ux%u, %u alternating runs\n", b->s.host.driver,
            given.from.width, given.from.height, o->size.width, o->size.height, o->runs);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, o->csv);
}

static bool measure(bench *b) {
    masu_session_desc d = {.desc = {.output = o->size, .targets = {.storage = 1}},
                           .host = o->host,
                           .no_renderer = true};
    bool good = masu_session_open(&d, &b->s, b->error, sizeof b->error) && make_source(b);
    for (uint32_t i = 0; i < CASES && good; i++) {
        if (cases[i].half && !b->s.host.float16) b->only &= ~(1u << i);
        good = !on(b, i) || (open_case(b, i) && count_early(b, i));
    }
    for (uint32_t run = 0; run <= o->runs && good; run++) {
        for (uint32_t i = 0; i < CASES && good; i++) good = !on(b, i) || run_case(b, i, run > 0);
    }
    for (uint32_t i = 0; i < CASES && good; i++) good = !on(b, i) || keep_picture(b, i);
    for (uint32_t i = 0; i < CASES && good; i++) good = !on(b, i) || compare(b, i);
    return good;
}

static int run(void) {
    static bench b;
    const char *names[CASES];
    for (uint32_t i = 0; i < CASES; i++) names[i] = cases[i].name;
    b.only = (1u << CASES) - 1;
    if (o->only && !masu_read_names("--only", o->only, names, CASES, &b.only))
        return MASU_CLI_USAGE;
    int code = measure(&b) ? print(&b) : masu_cli_error("%s", b.error);
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

static const masu_option rows[] = {
    MASU_SIZE(options, from, "from", "size of the image"),
    MASU_STUDY_SIZE,
    MASU_STUDY_RUNS(1, RUNS_MOST),
    MASU_STUDY_ONLY,
    MASU_STUDY_IMAGES("write each case's image there, CASE.png"),
    MASU_STUDY_CSV,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_upscale = {
    .name = "upscale",
    .purpose = "upscaling and sharpening of a finished image: times, errors",
    .arguments = "[IN.png] [options]",
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details = "The default image is generated: a third ramp, a third discs, a third noise.\n"};
