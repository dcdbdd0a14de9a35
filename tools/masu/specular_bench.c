/* specular_bench.c: `masu specular-bench`: what each filter of reflections buys: the error of frames at
 * rest, with the camera in motion, with an object in motion, and after it has jumped, each beside the mean of
 * very many rays per pixel; flicker; and time of the passes.
 *
 * One renderer with a rung for each set of filters, and one that traces every pixel and adds up. Its first
 * frames are what unfiltered rays would bring, later ones after a cut are the truth: no ray is in both. Times
 * are the least of nine frames at rest. Nothing is judged. */
#include "masu/cmd.h"

#include "bench/study/specular.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_SIZE = 1,
    OPTION_CSV,
    OPTION_FRAMES,
    OPTION_RAYS,
    OPTION_TRUTH_RAYS,
    OPTION_TRUTH,
    OPTION_TIME,
    OPTION_OBJECT,
    OPTION_IMAGES,
    OPTION_ONLY
};

#define NONE MASU_OFF
#define YES MASU_ON
enum { WAYS = 8, MOTIONS = 4, FLICKER_FRAMES = 64, GHOST_FRAMES = 8, TIMED = 9 };

static const struct {
    const char *name;
    masu_switch reuse, temporal, fine, filter, taa;
} ways[WAYS] = {{"none", NONE, NONE, NONE, NONE, NONE},
                {"reuse", YES, NONE, NONE, NONE, NONE},
                {"temporal", NONE, YES, NONE, NONE, NONE},
                {"reuse+temporal", YES, YES, NONE, NONE, NONE},
                {"reuse+temporal+fine", YES, YES, YES, NONE, NONE},
                {"reuse+temporal+fine+filter", YES, YES, YES, YES, NONE},
                {"temporal+fine+filter+taa", NONE, YES, YES, YES, YES},
                {"all", YES, YES, YES, YES, YES}};
static const char *const motions[MOTIONS] = {"rest", "camera", "object", "jump"};

typedef struct options {
    const char *path, *csv, *truth, *images, *object;
    VkExtent2D size;
    uint32_t frames, rays, truth_rays, only;
    double time;
} options;

typedef struct bench {
    const options *o;
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
    snprintf(b->error, sizeof b->error, "%s: %s", b->o->path, text);
    return false;
}

static masu_session_desc session_of(const bench *b, const masu_headless_desc *host) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = b->o->path;
    d.host = *host;
    d.desc.output = b->o->size;
    d.desc.targets.storage = 1;
    d.desc.readback =
        MASU_READBACK_HDR | MASU_READBACK_DEPTH | MASU_READBACK_NORMAL | MASU_READBACK_ALBEDO;
    return d;
}

static bool open_all(bench *b, const masu_headless_desc *host) {
    masu_session_desc d = session_of(b, host);
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
    d = session_of(b, host);
    d.desc.debug.reference = 1;
    d.desc.rung_count = 1;
    if (!masu_session_open(&d, &b->full, b->error, sizeof b->error)) return false;
    b->opened = 2;
    if (!b->s.scene.reflections) return failed(b, "the scene asks for no reflections");
    b->pixels = b->o->size.width * b->o->size.height;
    b->classes = calloc(b->pixels, 1);
    b->truth = calloc(b->pixels, 3 * sizeof *b->truth);
    b->unfiltered = calloc(b->pixels, 3 * sizeof *b->unfiltered);
    b->rgb = calloc(b->pixels, 3 * sizeof *b->rgb);
    return (b->classes && b->truth && b->unfiltered && b->rgb) || failed(b, "out of memory");
}

/* The object that moves, if the scene has it. */
static bool find_object(bench *b) {
    size_t bytes = 0;
    masu_scene scene;
    masu_detail detail;
    b->run.object = masu_instance_find(b->s.m, b->o->object);
    if (!b->run.object.id) return true;
    if (!masu_file_read(b->o->path, (size_t)2 << 30, &b->blob, &bytes, b->error, sizeof b->error))
        return false;
    if (masu_scene_bind(b->blob, bytes, &scene, &detail)) return failed(b, detail.text);
    return masu_specular_place(&scene, b->o->object, b->run.rows) || failed(b, "no such instance");
}

static bool sum_up(bench *b, uint32_t frames, float *rgb, const char *what) {
    masu_cli_progress("%s: %u rays a pixel", what, frames);
    masu_specular_run run = {.frames = frames, .time = b->o->time};
    return masu_specular_draw(&b->full, &run, rgb, NULL, NULL, b->error, sizeof b->error);
}

/* From the file, if there is one, else by rays, and into the file. One of another size is of another picture,
 * or none at all, and is not written over. */
static bool find_truth(bench *b) {
    size_t floats = 3 * (size_t)b->pixels;
    FILE *f = b->o->truth ? fopen(b->o->truth, "rb") : NULL;
    bool found = f && fread(b->truth, sizeof *b->truth, floats, f) == floats && fgetc(f) == EOF;
    if (f) fclose(f);
    if (f && !found) return failed(b, "the file of the truth is not one of this size");
    if (!sum_up(b, b->o->rays, b->unfiltered, "unfiltered")) return false;
    if (!masu_specular_classes(&b->full, b->s.scene.specular_cutoff, b->classes))
        return failed(b, "no readback");
    if (!found && !sum_up(b, b->o->truth_rays, b->truth, "truth")) return false;
    if (!found && b->o->truth) {
        f = fopen(b->o->truth, "wb");
        bool good = f && fwrite(b->truth, sizeof *b->truth, floats, f) == floats;
        good = f && !fclose(f) && good;
        if (!good) return failed(b, "the truth cannot be written");
    }
    b->rays = masu_specular_compare(b->unfiltered, b->truth, b->classes, b->pixels);
    return true;
}

/* The shown picture, and one of the errors: 0.25 of relMSE and more is white. */
static bool save(bench *b, uint32_t way, uint32_t motion) {
    char path[4096];
    const char *last = strrchr(b->o->path, '/');
    const char *scene = last ? last + 1 : b->o->path;
    int length = (int)strcspn(scene, ".");
    if (!masu_headless_target_read(&b->s.host, &b->s.targets[0], b->error, sizeof b->error)) return false;
    snprintf(path, sizeof path, "%s/%.*s.%s.%s.png", b->o->images, length, scene, motions[motion],
             ways[way].name);
    if (!masu_image_save_png(path, b->s.targets[0].mapped, b->o->size.width, b->o->size.height, 0,
                             b->error, sizeof b->error)) {
        return false;
    }
    uint8_t *grey = calloc(b->pixels, 4);
    if (!grey) return failed(b, "out of memory");
    for (uint32_t i = 0; i < b->pixels; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < 3 && b->classes[i] != 0xFF; k++) {
            double x = (double)b->rgb[3 * i + k], t = (double)b->truth[3 * i + k];
            sum += (x - t) * (x - t) / (t * t + 0.01) / 3;
        }
        memset(grey + 4 * i, sum < 0.25 ? (int)(sum * 4 * 255) : 255, 3);
        grey[4 * i + 3] = 255;
    }
    snprintf(path, sizeof path, "%s/%.*s.%s.%s.error.png", b->o->images, length, scene, motions[motion],
             ways[way].name);
    bool good = masu_image_save_png(path, grey, b->o->size.width, b->o->size.height, 0, b->error,
                                    sizeof b->error);
    free(grey);
    return good;
}

static double filters_ms(bench *b, uint32_t slot) {
    static const char *const names[] = {"specular_reuse", "specular_temporal", "specular_fine",
                                        "specular_filter", "specular_taa", "specular_keep",
                                        "specular_keep_fine"};
    masu_stats_info stats;
    double ms = 0;
    (void)masu_stats(b->s.m, slot, &stats);
    for (uint32_t p = 0; p < stats.pass_count; p++) {
        for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
            if (!strcmp(stats.pass_names[p], names[i])) ms += (double)stats.pass_ns[p] / 1e6;
        }
    }
    return ms;
}

static bool time_filters(bench *b, uint32_t way) {
    masu_camera camera;
    masu_commands commands;
    if (masu_camera_at(b->s.m, b->o->time, &camera)) return failed(b, "the scene has no camera");
    for (uint32_t i = 0; i < TIMED; i++) {
        masu_frame_desc frame = {.camera = &camera,
                                 .time = b->o->time,
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
        masu_cli_progress("%s, %s", ways[way].name, motions[motion]);
        masu_specular_run run = b->run;
        run.rung = way;
        run.motion = (masu_specular_motion)motion;
        if (!masu_specular_draw(&b->s, &run, b->rgb, NULL, NULL, b->error, sizeof b->error))
            return false;
        b->errors[way][motion] = masu_specular_compare(b->rgb, b->truth, b->classes, b->pixels);
        if (b->o->images && !save(b, way, motion)) return false;
    }
    masu_specular_run run = b->run;
    run.rung = way;
    run.frames = FLICKER_FRAMES;
    masu_cli_progress("%s, flicker", ways[way].name);
    return masu_specular_draw(&b->s, &run, NULL, b->classes, &b->flicker[way], b->error,
                              sizeof b->error) &&
           time_filters(b, way);
}

static void print_row(FILE *f, const bench *b, const char *name, const char *motion, uint32_t frames,
                      const masu_specular_error *e, double flicker, double ms) {
    fprintf(f, "%s,%s,%s,%u,%.6f,%.6f,%.6f,%.6f,%.6f,%.3f,%.3f,%u,%u,%u\n", b->o->path, name, motion,
            frames, e->value[MASU_SPECULAR_ALL], e->value[MASU_SPECULAR_MIRROR],
            e->value[MASU_SPECULAR_SMOOTH], e->value[MASU_SPECULAR_SATIN],
            e->value[MASU_SPECULAR_ROUGH], flicker, ms, e->pixels[MASU_SPECULAR_ALL],
            b->o->size.width, b->o->size.height);
}

static bool print(bench *b) {
    FILE *f = b->o->csv && strcmp(b->o->csv, "-") != 0 ? fopen(b->o->csv, "w") : stdout;
    if (!f) return failed(b, "the CSV file cannot be written");
    fprintf(f, "scene,filters,motion,frames,relmse,mirror,smooth,satin,rough,flicker,filters_ms,pixels,"
               "width,height\n");
    print_row(f, b, "rays", "rest", b->o->rays, &b->rays, 0, 0);
    for (uint32_t w = 0; w < WAYS; w++) {
        if (!(b->o->only >> w & 1u)) continue;
        for (uint32_t motion = 0; motion < MOTIONS; motion++) {
            if (motion >= MASU_SPECULAR_OBJECT && !b->run.object.id) continue;
            print_row(f, b, ways[w].name, motions[motion], b->o->frames, &b->errors[w][motion],
                      b->flicker[w], b->times[w]);
        }
    }
    return f == stdout || !fclose(f) || failed(b, "the CSV file cannot be written");
}

static int bench_scene(const options *o, const masu_headless_desc *host) {
    static bench b;
    memset(&b, 0, sizeof b);
    b.o = o;
    b.run = (masu_specular_run){.frames = o->frames,
                                .after = GHOST_FRAMES,
                                .time = o->time,
                                .step = 1.0f / 60.0f,
                                .distance = 1.0};
    bool good = open_all(&b, host) && find_object(&b) && find_truth(&b);
    for (uint32_t w = 0; w < WAYS && good; w++) good = !(o->only >> w & 1u) || measure(&b, w);
    masu_cli_progress_clear();
    good = good && print(&b);
    if (!good) masu_cli_error("%s", b.error);
    free(b.blob);
    free(b.classes);
    free(b.truth);
    free(b.unfiltered);
    free(b.rgb);
    int code = good ? MASU_CLI_OK : MASU_CLI_FAILURE;
    masu_session *const sessions[] = {&b.s, &b.full};
    for (uint32_t i = 0; i < b.opened; i++) {
        masu_session_close(sessions[i]);
        code = masu_finish_validation(&sessions[i]->host, code);
    }
    return code;
}

static int run(masu_cli *cli) {
    options o = {.size = {320, 180},
                 .frames = 32,
                 .rays = 64,
                 .truth_rays = 1024,
                 .time = 0.8,
                 .object = "moving",
                 .only = (1u << WAYS) - 1};
    masu_headless_desc host = {.message = masu_print_message};
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &host)) continue;
        switch (id) {
        case OPTION_SIZE:
            if (!masu_output_size(cli, &o.size)) return MASU_CLI_USAGE;
            continue;
        case OPTION_CSV:
            if (!masu_output_file_or_stdout(cli, &o.csv)) return cli->exit_code;
            continue;
        case OPTION_FRAMES:
            if (!masu_cli_uint(cli, 1, 10000, &o.frames)) return MASU_CLI_USAGE;
            continue;
        case OPTION_RAYS:
            if (!masu_cli_uint(cli, 1, 1000000, &o.rays)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TRUTH_RAYS:
            if (!masu_cli_uint(cli, 1, 1000000, &o.truth_rays)) return MASU_CLI_USAGE;
            continue;
        case OPTION_ONLY:
            if (!masu_cli_uint(cli, 1, (1u << WAYS) - 1, &o.only)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TIME:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.time)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TRUTH: o.truth = cli->value; continue;
        case OPTION_OBJECT: o.object = cli->value; continue;
        case OPTION_IMAGES: o.images = cli->value; continue;
        case MASU_CLI_ARGUMENT:
            if (o.path) return masu_cli_usage_error("one scene at a time: '%s'", cli->value);
            o.path = cli->value;
            continue;
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (!o.path) return masu_cli_usage_error("no scene is given");
    return bench_scene(&o, &host);
}

static const masu_cli_option list[] = {
    {"size", "WxH", "size in pixels (default 320x180)", OPTION_SIZE, 0},
    {"csv", "FILE", "where to write (default: standard output)", OPTION_CSV, 0},
    {"frames", "N", "frames at rest or in motion (default 32)", OPTION_FRAMES, 0},
    {"rays", "N", "unfiltered rays per pixel to compare with (default 64)", OPTION_RAYS, 0},
    {"truth-rays", "N", "rays per pixel of the truth (default 1024)", OPTION_TRUTH_RAYS, 0},
    {"truth", "FILE", "read the truth from there, or write it there: floats of width x height x 3",
     OPTION_TRUTH, 0},
    {"time", "SECONDS", "where on its path the camera ends (default 0.8)", OPTION_TIME, 0},
    {"object", "NAME", "instance that moves and jumps (default moving)", OPTION_OBJECT, 0},
    {"only", "BITS", "of the sets of filters those with a bit set (default all, 255)", OPTION_ONLY, 0},
    {"images", "DIR", "the shown pictures, and their errors, as PNG", OPTION_IMAGES, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_specular_bench = {
    .name = "specular-bench",
    .arguments = "SCENE.masu [options]",
    .summary = "measure the filters of reflections against many rays per pixel",
    .options = list,
    .details =
        "One line of CSV for each set of filters and motion, after one for unfiltered rays. relmse: mean of\n"
        "(x - t)^2 / (t^2 + 0.01) over pixels that trace; then the same of those whose roughness is below\n"
        "0.05, 0.15, 0.25, and above. camera: its path up to --time; object: 1 m/s; jump: 8 frames after the\n"
        "object was moved by 1 m. flicker: of 64 frames at rest, from the 16th on, in 1/255. Scenes without\n"
        "such an instance have no lines for object and jump.\n",
    .run = run};
