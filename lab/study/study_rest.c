/* study_rest.c: `masu-lab study rest`: how much of the light of lamps in a reference the
 * reflections have, and how much the image changes with a still camera. */
#include "lab/study/study.h"

#include "image.h"
#include "measure/linear.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    masu_study_options study;
    const char *reference;
    uint32_t last;
    double floor;
} options;

static options given = {
    .study = {.size = {320, 240}, .time = 0.0, .frames = 140}, .last = 32, .floor = 0.03};
static const masu_study_options *const o = &given.study;

static const masu_column columns[] = {{"scene", NULL, NULL, NULL},
                                      {"way", NULL, "way", NULL},
                                      {"glow", "%.5f", "glow", "%.3f"},
                                      {"pixels", "%.0f", "of pixels", "%.0f"},
                                      {"deviation_mean", "%.5f", "deviation, mean", "%.3f"},
                                      {"deviation_99", "%.5f", "99 %", "%.3f"},
                                      {"deviation_most", "%.5f", "most", "%.3f"},
                                      {"driver", "\"", NULL, NULL},
                                      {NULL, NULL, NULL, NULL}};

typedef struct found {
    double glow, pixels, mean, most, high;
    char driver[1024];
    uint32_t messages;
} found;

static int by_value(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

typedef struct sums {
    float *linear, *mean, *sum, *square; /* 3, 3, 3, 3 a pixel */
} sums;

static bool add_frame(masu_session *s, uint32_t slot, size_t values, sums *t, char *error,
                      size_t size) {
    if (!masu_headless_target_read(&s->host, &s->targets[0], error, size)) return false;
    if (!masu_linear_read(s->m, slot, o->size, t->linear)) {
        snprintf(error, size, "no image of linear light");
        return false;
    }
    const uint8_t *shown = s->targets[0].mapped;
    for (size_t i = 0; i < values; i++) {
        float x = (float)shown[4 * (i / 3) + i % 3];
        t->mean[i] += t->linear[i] / (float)given.last;
        t->sum[i] += x;
        t->square[i] += x * x;
    }
    return true;
}

enum { AROUND = 3 };

/* Whether a pixel is in the glow: the mean of the reference around it is at least the floor, and no
 * lamp is near. The mean is used because pixels of the reference are noisy: chosen by themselves,
 * they would be biased to too bright ones. */
static bool is_glow(const float *reference, int32_t x, int32_t y) {
    const int32_t width = (int32_t)o->size.width, height = (int32_t)o->size.height;
    double sum = 0, count = 0;
    for (int32_t j = y - AROUND; j <= y + AROUND; j++) {
        for (int32_t i = x - AROUND; i <= x + AROUND; i++) {
            if (i < 0 || j < 0 || i >= width || j >= height) continue;
            const float *r = reference + 3 * ((size_t)j * (size_t)width + (size_t)i);
            double most = fmax((double)r[0], fmax((double)r[1], (double)r[2]));
            if (!(most < 1)) return false;
            sum += most;
            count++;
        }
    }
    return sum > given.floor * count;
}

static void evaluate(const sums *t, const float *reference, size_t pixels, found *out) {
    double light[2] = {0, 0};
    float *deviations = t->linear;
    for (size_t p = 0; p < pixels; p++) {
        const float *r = reference + 3 * p;
        float deviation = 0;
        for (size_t k = 0; k < 3; k++) {
            float n = (float)given.last, mean = t->sum[3 * p + k] / n;
            deviation = fmaxf(deviation, sqrtf(fmaxf(t->square[3 * p + k] / n - mean * mean, 0)));
        }
        deviations[p] = deviation;
        out->mean += (double)deviation / (double)pixels;
        if (!is_glow(reference, (int32_t)(p % o->size.width), (int32_t)(p / o->size.width)))
            continue;
        out->pixels++;
        for (size_t k = 0; k < 3; k++) {
            light[0] += (double)t->mean[3 * p + k];
            light[1] += (double)r[k];
        }
    }
    qsort(deviations, pixels, sizeof *deviations, by_value);
    out->most = (double)deviations[pixels - 1];
    out->high = (double)deviations[pixels * 99 / 100];
    out->glow = light[1] > 0 ? light[0] / light[1] : (double)NAN;
}

static bool measure(masu_switch temporal, const float *reference, found *out, char *error,
                    size_t size) {
    static masu_session s; /* must not move, and is large */
    const size_t pixels = (size_t)o->size.width * o->size.height;
    masu_session_desc d = {.scene_path = o->scene, .host = o->host};
    float *memory = calloc(12 * pixels, sizeof *memory);
    sums t = {memory, memory + 3 * pixels, memory + 6 * pixels, memory + 9 * pixels};
    if (!memory) {
        snprintf(error, size, "out of memory");
        return false;
    }
    d.desc.output = o->size;
    d.desc.targets.storage = 1;
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.tone = MASU_TONE_NONE;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1, .temporal = temporal};
    bool good = masu_session_open(&d, &s, error, size);
    if (good) {
        snprintf(out->driver, sizeof out->driver, "%s", s.host.driver);
        for (uint32_t i = 0; good && i < o->frames; i++) {
            masu_commands commands;
            masu_frame_desc frame = {.time = o->time, .time_step = i ? 1.0f / 60.0f : 0, .cut = !i};
            bool counts = i + given.last >= o->frames;
            good = masu_session_frame(&s, &frame, counts, &commands, error, size) &&
                   (!counts || add_frame(&s, commands.slot, 3 * pixels, &t, error, size));
        }
        masu_session_close(&s);
        out->messages = s.host.messages;
    }
    if (good) evaluate(&t, reference, pixels, out);
    free(memory);
    return good;
}

static int run(void) {
    char error[4096], scene[128];
    uint32_t messages = 0;
    struct masu_image image;
    if (!given.reference) return masu_cli_usage_error("expected --reference FILE.pfm");
    if (given.last > o->frames) return masu_cli_usage_error("--last: more than --frames");
    if (!masu_image_load_pfm(given.reference, &image, error, sizeof error))
        return masu_cli_error("%s", error);
    if (image.width != o->size.width || image.height != o->size.height) {
        masu_image_free(&image);
        return masu_cli_error("%s: expected %ux%u, found %ux%u", given.reference, o->size.width,
                              o->size.height, image.width, image.height);
    }
    const float *reference = image.values;
    masu_table t;
    masu_study_scene_name(o->scene, scene, sizeof scene);
    masu_table_open(&t, columns, "");
    for (int way = 0; way < 2; way++) {
        found f = {0};
        if (!measure(way ? MASU_ON : MASU_OFF, reference, &f, error, sizeof error)) {
            masu_image_free(&image);
            return masu_cli_error("%s", error);
        }
        const double values[] = {f.glow, f.pixels, f.mean, f.high, f.most};
        masu_table_text(&t, scene);
        masu_table_text(&t, way ? "temporal" : "without");
        masu_table_numbers(&t, values, 5);
        masu_table_text(&t, f.driver);
        messages += f.messages;
    }
    masu_image_free(&image);
    masu_table_print(&t, o->text);
    int code = masu_table_close(&t, o->csv);
    return messages ? masu_cli_error("the validation layer has reported %u messages", messages)
                    : code;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_TIME,
    MASU_TEXT(options, reference, "reference", "FILE.pfm",
              "image of masu-lab reference, of the same size"),
    MASU_STUDY_FRAMES(10000, "frames of one moment"),
    MASU_UINT(options, last, "last", 2, 10000, "measured frames, at the end of --frames"),
    MASU_REAL(options, floor, "above", "RADIANCE", 0, 1e6,
              "minimum radiance of the reference in the glow"),
    MASU_STUDY_CSV,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_rest = {
    .name = "rest",
    .purpose = "glow of small lamps in glossy surfaces, and its noise with a still camera",
    .arguments = "SCENE.masu --reference FILE.pfm [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details =
        "Glow: the light of pixels around which the reference has a mean radiance of --above "
        "or more, and none of 1,\n"
        "divided by the reference's light.\n"
        "Deviation: standard deviation over the last frames of each pixel of the shown "
        "image, of 255, without tone\n"
        "curve: its mean, 99th percentile and maximum.\n"};
