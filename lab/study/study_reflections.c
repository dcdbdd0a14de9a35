/* study_reflections.c: `masu-lab study reflections`: the gain from each filter of reflections: the
 * error of still frames, with the camera in motion, with an object in motion, and after it has
 * jumped, each against the mean of very many rays per pixel; also flicker and pass times.
 *
 * One renderer has a rung for each set of filters; another traces every pixel and sums the rays.
 * The latter's first frames are the unfiltered rays, and its frames after a cut are the ground
 * truth: no ray is in both. Times are the least of nine still frames. The study only reports. */
#include "lab/study/study.h"

#include "measure/specular.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NONE MASU_OFF
#define YES MASU_ON
enum { WAYS = 8, MOTIONS = 4, FLICKER_FRAMES = 64, GHOST_FRAMES = 8, TIMED = 9 };

static const char *const names[WAYS] = {"none",
                                        "reuse",
                                        "temporal",
                                        "reuse+temporal",
                                        "reuse+temporal+fine",
                                        "reuse+temporal+fine+filter",
                                        "temporal+fine+filter+taa",
                                        "all"};
static const struct {
    masu_switch reuse, temporal, fine, filter, taa;
} ways[WAYS] = {{NONE, NONE, NONE, NONE, NONE}, {YES, NONE, NONE, NONE, NONE},
                {NONE, YES, NONE, NONE, NONE},  {YES, YES, NONE, NONE, NONE},
                {YES, YES, YES, NONE, NONE},    {YES, YES, YES, YES, NONE},
                {NONE, YES, YES, YES, YES},     {YES, YES, YES, YES, YES}};
static const char *const motions[MOTIONS] = {"rest", "camera", "object", "jump"};

typedef struct options {
    masu_study_options study;
    const char *object;
    uint32_t rays;
} options;

static options given = {
    .study = {.size = {320, 180}, .frames = 32, .time = 0.8, .truth.rays = 1024},
    .object = "moving",
    .rays = 64};
static const masu_study_options *const o = &given.study;

typedef struct bench {
    uint32_t only; /* bit: way */
    masu_session s, full;
    uint8_t *blob, *classes;
    float *truth, *unfiltered, *rgb;
    masu_specular_run run;
    masu_specular_error rays, errors[WAYS][MOTIONS];
    double flicker[WAYS], times[WAYS];
    uint32_t pixels, opened;
    char error[1024];
} bench;

static bool failed(bench *b, const char *text) {
    snprintf(b->error, sizeof b->error, "%s: %s", o->scene, text);
    return false;
}

static masu_session_desc session_of(void) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = o->scene;
    d.host = o->host;
    d.desc.output = o->size;
    d.desc.targets.storage = 1;
    d.desc.readback =
        MASU_READBACK_HDR | MASU_READBACK_DEPTH | MASU_READBACK_NORMAL | MASU_READBACK_ALBEDO;
    return d;
}

static bool open_all(bench *b) {
    masu_session_desc d = session_of();
    d.desc.debug.timestamps = 1;
    d.desc.rung_count = WAYS;
    for (uint32_t w = 0; w < WAYS; w++) {
        d.desc.rungs[w].specular_reuse = ways[w].reuse;
        d.desc.rungs[w].specular_temporal = ways[w].temporal;
        d.desc.rungs[w].specular_fine = ways[w].fine;
        d.desc.rungs[w].specular_filter = ways[w].filter;
        d.desc.rungs[w].specular_taa = ways[w].taa;
    }
    if (!masu_session_open(&d, &b->s, b->error, sizeof b->error)) return false;
    b->opened = 1;
    d = session_of();
    d.desc.debug.reference = 1;
    d.desc.rung_count = 1;
    if (!masu_session_open(&d, &b->full, b->error, sizeof b->error)) return false;
    b->opened = 2;
    if (!(masu_scene_features(&b->s.scene) & MASU_SCENE_HAS_REFLECTIONS))
        return failed(b, "the scene has no reflections");
    b->pixels = o->size.width * o->size.height;
    b->classes = calloc(b->pixels, 1);
    b->truth = calloc(b->pixels, 3 * sizeof *b->truth);
    b->unfiltered = calloc(b->pixels, 3 * sizeof *b->unfiltered);
    b->rgb = calloc(b->pixels, 3 * sizeof *b->rgb);
    return (b->classes && b->truth && b->unfiltered && b->rgb) || failed(b, "out of memory");
}

/* Finds the moving object, if the scene has it. */
static bool find_object(bench *b) {
    size_t bytes = 0;
    masu_scene scene;
    masu_detail detail;
    b->run.object = masu_instance_find(b->s.m, given.object);
    if (!b->run.object.id) return true;
    if (!masu_file_read(o->scene, (size_t)2 << 30, &b->blob, &bytes, b->error, sizeof b->error))
        return false;
    if (masu_scene_bind(b->blob, bytes, &scene, &detail)) return failed(b, detail.text);
    return masu_specular_place(&scene, given.object, b->run.rows) || failed(b, "no such instance");
}

static bool sum_up(bench *b, uint32_t frames, float *rgb, const char *what) {
    masu_cli_progress("%s: %u rays a pixel", what, frames);
    masu_specular_run run = {.frames = frames, .time = o->time};
    return masu_specular_draw(&b->full, &run, rgb, NULL, NULL, b->error, sizeof b->error);
}

/* Reads the file if it exists; otherwise computes the ground truth and writes it there. A file of
 * another size is not used and not overwritten: it is another image, or none. */
static bool find_truth(bench *b) {
    size_t floats = 3 * (size_t)b->pixels;
    FILE *f =
        o->truth.path && masu_file_is_regular(o->truth.path) ? fopen(o->truth.path, "rb") : NULL;
    bool found = f && fread(b->truth, sizeof *b->truth, floats, f) == floats && fgetc(f) == EOF;
    if (f) fclose(f);
    if (f && !found) return failed(b, "the ground truth's file has another size");
    if (!sum_up(b, given.rays, b->unfiltered, "unfiltered")) return false;
    if (!masu_specular_classes(&b->full, masu_scene_specular_cutoff(&b->s.scene), b->classes))
        return failed(b, "no readback");
    if (!found && !sum_up(b, o->truth.rays, b->truth, "truth")) return false;
    if (!found && o->truth.path) {
        f = fopen(o->truth.path, "wb");
        bool good = f && fwrite(b->truth, sizeof *b->truth, floats, f) == floats;
        good = f && !fclose(f) && good;
        if (!good) return failed(b, "the ground truth cannot be written");
    }
    b->rays = masu_specular_compare(b->unfiltered, b->truth, b->classes, b->pixels);
    return true;
}

/* Saves the shown image, and one of the errors, in which a relMSE of 0.25 is white. */
static bool save(bench *b, uint32_t way, uint32_t motion) {
    char path[4096], scene[256];
    masu_study_scene_name(o->scene, scene, sizeof scene);
    if (!masu_headless_target_read(&b->s.host, &b->s.targets[0], b->error, sizeof b->error))
        return false;
    snprintf(path, sizeof path, "%s/%s.%s.%s.png", o->images, scene, motions[motion], names[way]);
    if (!masu_image_save_png(path, b->s.targets[0].mapped, o->size.width, o->size.height, 0,
                             b->error, sizeof b->error)) {
        return false;
    }
    float *errors = calloc(b->pixels, sizeof *errors);
    if (!errors) return failed(b, "out of memory");
    for (uint32_t i = 0; i < b->pixels; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < 3 && b->classes[i] != 0xFF; k++) {
            double x = (double)b->rgb[3 * i + k], t = (double)b->truth[3 * i + k];
            sum += (x - t) * (x - t) / (t * t + 0.01) / 3;
        }
        errors[i] = (float)(4 * sum);
    }
    snprintf(path, sizeof path, "%s/%s.%s.%s.error.png", o->images, scene, motions[motion],
             names[way]);
    bool good = masu_study_save_grey(path, errors, o->size, b->error, sizeof b->error);
    free(errors);
    return good;
}

static double filters_ms(bench *b, uint32_t slot) {
    static const char *const passes[] = {"specular_reuse", "specular_temporal", "specular_fine",
                                        "specular_filter", "specular_taa", "specular_keep",
                                        "specular_keep_fine"};
    masu_stats_info stats;
    double ms = 0;
    (void)masu_stats(b->s.m, slot, &stats, NULL);
    for (uint32_t p = 0; p < stats.pass_count; p++) {
        for (size_t i = 0; i < sizeof passes / sizeof *passes; i++) {
            if (!strcmp(stats.pass_names[p], passes[i])) ms += (double)stats.pass_ns[p] / 1e6;
        }
    }
    return ms;
}

static bool time_filters(bench *b, uint32_t way) {
    masu_camera camera;
    masu_commands commands;
    if (masu_camera_at(b->s.m, o->time, &camera, NULL)) return failed(b, "the scene has no camera");
    for (uint32_t i = 0; i < TIMED; i++) {
        masu_frame_desc frame = {.camera = &camera,
                                 .time = o->time,
                                 .time_step = b->run.step,
                                 .rung = way};
        if (!masu_session_frame(&b->s, &frame, true, &commands, b->error, sizeof b->error))
            return false;
        double ms = filters_ms(b, commands.slot);
        if (!i || ms < b->times[way]) b->times[way] = ms;
    }
    return true;
}

static bool measure(bench *b, uint32_t way) {
    for (uint32_t motion = 0; motion < MOTIONS; motion++) {
        if (motion >= MASU_SPECULAR_OBJECT && !b->run.object.id) continue;
        masu_cli_progress("%s, %s", names[way], motions[motion]);
        masu_specular_run run = b->run;
        run.rung = way;
        run.motion = (masu_specular_motion)motion;
        if (!masu_specular_draw(&b->s, &run, b->rgb, NULL, NULL, b->error, sizeof b->error))
            return false;
        b->errors[way][motion] = masu_specular_compare(b->rgb, b->truth, b->classes, b->pixels);
        if (o->images && !save(b, way, motion)) return false;
    }
    masu_specular_run run = b->run;
    run.rung = way;
    run.frames = FLICKER_FRAMES;
    masu_cli_progress("%s, flicker", names[way]);
    return masu_specular_draw(&b->s, &run, NULL, b->classes, &b->flicker[way], b->error,
                              sizeof b->error) &&
           time_filters(b, way);
}

static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"filters", NULL, "filters", NULL},
    {"motion", NULL, "motion", NULL},
    {"frames", "%.0f", "frames", "%.0f"},
    {"relmse", "%.6f", "relmse", "%.6f"},
    {"mirror", "%.6f", "mirror", "%.6f"},
    {"smooth", "%.6f", "smooth", "%.6f"},
    {"satin", "%.6f", "satin", "%.6f"},
    {"rough", "%.6f", "rough", "%.6f"},
    {"flicker", "%.3f", "flicker", "%.3f"},
    {"filters_ms", "%.3f", "filters ms", "%.3f"},
    {"pixels", "%.0f", NULL, NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, const char *name, const char *motion, uint32_t frames,
                    const masu_specular_error *e, double flicker, double ms) {
    const double numbers[] = {frames,
                              e->value[MASU_SPECULAR_ALL],
                              e->value[MASU_SPECULAR_MIRROR],
                              e->value[MASU_SPECULAR_FILTERED],
                              e->value[MASU_SPECULAR_SATIN],
                              e->value[MASU_SPECULAR_ROUGH],
                              flicker,
                              ms,
                              e->pixels[MASU_SPECULAR_ALL],
                              o->size.width,
                              o->size.height};
    masu_table_text(t, o->scene);
    masu_table_text(t, name);
    masu_table_text(t, motion);
    masu_table_numbers(t, numbers, sizeof numbers / sizeof *numbers);
}

static int print(const bench *b) {
    masu_table t;
    masu_table_open(&t, columns, "n/a");
    add_row(&t, "rays", "rest", given.rays, &b->rays, 0, 0);
    for (uint32_t w = 0; w < WAYS; w++) {
        if (!(b->only >> w & 1u)) continue;
        for (uint32_t motion = 0; motion < MOTIONS; motion++) {
            if (motion >= MASU_SPECULAR_OBJECT && !b->run.object.id) continue;
            add_row(&t, names[w], motions[motion], o->frames, &b->errors[w][motion], b->flicker[w],
                    b->times[w]);
        }
    }
    fprintf(o->text, "%s, %ux%u, %u pixels that trace; %s\n", o->scene, o->size.width,
            o->size.height, b->rays.pixels[MASU_SPECULAR_ALL], b->s.host.driver);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, o->csv);
}

static int run(void) {
    static bench b;
    b.only = (1u << WAYS) - 1;
    if (o->only && !masu_read_names("--only", o->only, names, WAYS, &b.only)) return MASU_CLI_USAGE;
    b.run = (masu_specular_run){.frames = o->frames,
                                .after = GHOST_FRAMES,
                                .time = o->time,
                                .step = 1.0f / 60.0f,
                                .distance = 1.0};
    bool good = open_all(&b) && find_object(&b) && find_truth(&b);
    for (uint32_t w = 0; w < WAYS && good; w++) good = !(b.only >> w & 1u) || measure(&b, w);
    masu_cli_progress_clear();
    int code = good ? print(&b) : masu_cli_error("%s", b.error);
    free(b.blob);
    free(b.classes);
    free(b.truth);
    free(b.unfiltered);
    free(b.rgb);
    masu_session *const sessions[] = {&b.s, &b.full};
    for (uint32_t i = 0; i < b.opened; i++) {
        masu_session_close(sessions[i]);
        code = masu_finish_validation(&sessions[i]->host, code);
    }
    return code;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_CSV,
    MASU_STUDY_FRAMES(10000, "frames with still or moving camera"),
    MASU_UINT(options, rays, "rays", 1, 1000000, "unfiltered rays per pixel to compare with"),
    MASU_UINT(options, study.truth.rays, "reference", 1, 1000000,
              "rays per pixel of the ground truth"),
    MASU_TEXT(options, study.truth.path, "truth", "FILE",
              "ground truth, read if it exists, otherwise written: floats of width x height x 3"),
    MASU_REAL(options, study.time, "time", "SECONDS", -1e9, 1e9,
              "time of the camera's path at the last frame"),
    MASU_TEXT(options, object, "object", "NAME", "instance to move"),
    MASU_STUDY_ONLY,
    MASU_STUDY_IMAGES("the shown images, and their errors, as PNG"),
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_reflections = {
    .name = "reflections",
    .purpose = "the filters of reflections, compared with many rays per pixel",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details = "One row for each set of filters and motion, after one for unfiltered rays. relmse: "
               "mean of\n"
               "(x - t)^2 / (t^2 + 0.01) over pixels that trace; then over their pixels of "
               "roughness below 0.05,\n"
               "0.15, 0.25, and above. camera: its path up to --time; object: 1 m/s; jump: 8 "
               "frames after the\n"
               "object was moved by 1 m. flicker: of 64 still frames, from the 16th on, in 1/255. "
               "Scenes without\n"
               "such an instance have no rows for object and jump.\n"};
