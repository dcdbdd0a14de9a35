/* ao_bench.c: `masu ao-bench`: ambient occlusion in screen space beside rays (bench/study/ao.h), for
 * several numbers of samples, at half and at full size, with and without the mean over 4x4 texels:
 * errors, times, and how much of it moves when the camera moves by an eighth of a pixel.
 *
 * Four renderers, one for each size and filter, a rung for each number of samples. The points that are
 * compared are those of the picture: every stride-th pixel, placed by its depth, with its normal. Times
 * are the least of the runs, all ways in turn. Nothing is judged. */
#include "masu/cmd.h"

#include "bench/study/ao.h"
#include "image.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_SIZE = 1,
    OPTION_CSV,
    OPTION_RUNS,
    OPTION_RAYS,
    OPTION_STRIDE,
    OPTION_TIME,
    OPTION_RADIUS,
    OPTION_TRUTH,
    OPTION_IMAGES
};

enum { OFF, RUNGS = 7, MOVES = 8, WAYS = 4 };
static const uint32_t samples[RUNGS][2] = {{0, 0}, {1, 4}, {2, 4}, {1, 8}, {2, 8}, {4, 8}, {4, 16}};
static const struct {
    const char *size, *filter;
    uint32_t full, nearest;
} ways[WAYS] = {{"half", "4x4", 0, 0},
                {"half", "nearest", 0, 1},
                {"full", "4x4", 1, 0},
                {"full", "nearest", 1, 1}};

typedef struct options {
    const char *path, *csv, *truth, *images;
    VkExtent2D size;
    uint32_t runs, rays, stride;
    double time, radius;
} options;

typedef struct point {
    uint32_t x, y;
    double truth;
} point;

typedef struct row {
    double rmse, mean, correlation, p99, worst, moving;
    double ao_ms, upsample_ms;
} row;

typedef struct bench {
    const options *o;
    masu_session s[WAYS];
    masu_camera camera;
    masu_truth field;
    masu_view view;
    masu_ao_world world;
    uint8_t *blob;
    masu_scene scene;
    point *points;
    uint32_t count;
    double *differences;
    float *before; /* seen part of the picture before the camera moved */
    row rows[WAYS][RUNGS];
    double truth_mean;
    char error[1024];
} bench;

static bool failed(bench *b, const char *text) {
    if (text != b->error) snprintf(b->error, sizeof b->error, "%s: %s", b->o->path, text);
    return false;
}

static bool draw(bench *b, uint32_t way, uint32_t rung, const masu_camera *camera,
                 masu_commands *commands) {
    masu_frame_desc f = {.camera = camera, .rung = rung, .time = b->o->time};
    return masu_session_frame(&b->s[way], &f, true, commands, b->error, sizeof b->error);
}

static const uint8_t *texel_at(const masu_readback_image *image, uint32_t x, uint32_t y) {
    return (const uint8_t *)image->pixels + y * image->row_bytes + 4 * (size_t)x;
}

static double seen_at(const masu_readback_image *image, uint32_t x, uint32_t y) {
    uint32_t word;
    if (!image->pixels) return 1.0; /* nothing of the rung writes it */
    memcpy(&word, texel_at(image, x, y), sizeof word);
    return (word >> 16) / 65535.0;
}

static masu_readback_image occlusion(bench *b, uint32_t way, uint32_t rung, uint32_t slot) {
    masu_readback_image image = {0};
    if (rung == OFF && !b->scene.sdf_occlusion && !b->scene.shadow_cascades) return image;
    if (masu_readback(b->s[way].m, slot, MASU_READBACK_OCCLUSION, &image)) image.pixels = NULL;
    return image;
}

/* ---- Truth ----------------------------------------------------------------------------------- */

typedef struct eye {
    double forward[3], right[3], up[3], tan_x, tan_y, near;
} eye;

static eye eye_of(const bench *b) {
    eye e;
    double length = 0, flat;
    for (int k = 0; k < 3; k++) length += (double)b->camera.forward[k] * (double)b->camera.forward[k];
    for (int k = 0; k < 3; k++) e.forward[k] = (double)b->camera.forward[k] / sqrt(length);
    flat = hypot(e.forward[0], e.forward[2]);
    e.right[0] = flat > 0 ? -e.forward[2] / flat : 1;
    e.right[1] = 0;
    e.right[2] = flat > 0 ? e.forward[0] / flat : 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        e.up[k] = e.right[i] * e.forward[j] - e.right[j] * e.forward[i];
    }
    e.tan_y = tan((double)b->camera.fov_y / 2);
    e.tan_x = e.tan_y * b->o->size.width / b->o->size.height;
    float near = b->camera.near_distance;
    e.near = (double)(near != 0.0f ? near : masu_scene_look(&b->scene).environment->near_distance);
    return e;
}

static bool open_truth(bench *b) {
    size_t bytes = 0;
    masu_detail detail;
    char path[4096];
    if (!masu_file_read(b->o->path, (size_t)2 << 30, &b->blob, &bytes, b->error, sizeof b->error))
        return false;
    if (masu_scene_bind(b->blob, bytes, &b->scene, &detail)) return failed(b, detail.text);
    if (b->scene.sdf) {
        const char *truth = b->o->truth;
        if (!truth && masu_truth_path(b->o->path, path, sizeof path)) truth = path;
        if (!masu_view_of(&b->scene, &b->camera, b->o->time, b->o->size.width, b->o->size.height,
                          &b->view, b->error, sizeof b->error) ||
            !masu_truth_open(truth, &b->field, b->error, sizeof b->error)) {
            return false;
        }
    }
    if (!masu_ao_open(&b->scene, &b->world, b->error, sizeof b->error)) return false;
    if (b->scene.sdf) b->world.field = &b->field, b->world.view = &b->view;
    return true;
}

static bool trace(bench *b, uint32_t slot) {
    masu_readback_image depths, normals;
    eye e = eye_of(b);
    const VkExtent2D size = b->o->size;
    double sum = 0;
    if (masu_readback(b->s[0].m, slot, MASU_READBACK_DEPTH, &depths) ||
        masu_readback(b->s[0].m, slot, MASU_READBACK_NORMAL, &normals)) {
        return failed(b, "no readback");
    }
    b->points = calloc((size_t)size.width * size.height, sizeof *b->points);
    b->differences = calloc((size_t)size.width * size.height, sizeof *b->differences);
    b->before = calloc((size_t)size.width * size.height, sizeof *b->before);
    if (!b->points || !b->differences || !b->before) return failed(b, "out of memory");
    for (uint32_t y = b->o->stride / 2; y < size.height; y += b->o->stride) {
        masu_cli_progress("rays, row %u of %u", y, size.height);
        for (uint32_t x = b->o->stride / 2; x < size.width; x += b->o->stride) {
            float depth, n[3];
            uint32_t texel;
            double at[3], normal[3], u, v, z;
            memcpy(&depth, texel_at(&depths, x, y), sizeof depth);
            memcpy(&texel, texel_at(&normals, x, y), sizeof texel);
            if (!(depth > 0.0f) || (texel >> 30 & MASU_SURFACE_EMISSIVE)) continue;
            masu_unpack_normal(texel, n);
            u = ((x + 0.5) / size.width * 2 - 1) * e.tan_x;
            v = ((y + 0.5) / size.height * 2 - 1) * e.tan_y;
            z = e.near / (double)depth;
            for (int k = 0; k < 3; k++) {
                at[k] = b->camera.position[k] + (e.forward[k] + e.right[k] * u - e.up[k] * v) * z;
                normal[k] = (double)n[k];
            }
            point *p = &b->points[b->count];
            *p = (point){x, y, masu_ao_seen(&b->world, at, normal, 1e-4 * z + 1e-3 * b->o->radius,
                                            b->o->radius, b->o->rays, b->count)};
            sum += p->truth;
            b->count++;
        }
    }
    b->truth_mean = b->count ? sum / b->count : 1;
    return b->count > 0 || failed(b, "the picture shows no surface");
}

/* ---- Comparing ------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void compare(bench *b, const masu_readback_image *image, row *r) {
    double n = b->count, e1 = 0, e2 = 0, t1 = 0, t2 = 0, s1 = 0, s2 = 0, ts = 0;
    for (uint32_t i = 0; i < b->count; i++) {
        double t = b->points[i].truth, s = seen_at(image, b->points[i].x, b->points[i].y);
        e1 += s - t;
        e2 += (s - t) * (s - t);
        t1 += t, s1 += s, t2 += t * t, s2 += s * s, ts += t * s;
        b->differences[i] = fabs(s - t);
    }
    double spread = (t2 / n - t1 / n * t1 / n) * (s2 / n - s1 / n * s1 / n);
    qsort(b->differences, b->count, sizeof *b->differences, by_size);
    r->rmse = sqrt(e2 / n);
    r->mean = e1 / n;
    r->correlation = spread > 1e-12 ? (ts / n - t1 / n * s1 / n) / sqrt(spread) : 0;
    r->p99 = b->differences[(uint32_t)(0.99 * (n - 1))];
    r->worst = b->differences[b->count - 1];
}

static bool save(bench *b, const char *name, const uint8_t *rgba) {
    char path[4096];
    const char *last = strrchr(b->o->path, '/');
    const char *scene = last ? last + 1 : b->o->path;
    snprintf(path, sizeof path, "%s/%.*s.%s.png", b->o->images, (int)strcspn(scene, "."), scene, name);
    return masu_image_save_png(path, rgba, b->o->size.width, b->o->size.height, 0, b->error,
                               sizeof b->error);
}

/* The seen part as grey, and the lit picture. */
static bool save_all(bench *b, uint32_t way, uint32_t rung, const masu_readback_image *image) {
    char name[64];
    masu_headless_target *t = &b->s[way].targets[0];
    size_t pixels = (size_t)b->o->size.width * b->o->size.height;
    uint8_t *grey = malloc(4 * pixels);
    if (!grey) return failed(b, "out of memory");
    for (size_t i = 0; i < pixels; i++) {
        uint32_t x = (uint32_t)(i % b->o->size.width), y = (uint32_t)(i / b->o->size.width);
        memset(grey + 4 * i, (int)(seen_at(image, x, y) * 255 + 0.5), 3);
        grey[4 * i + 3] = 255;
    }
    snprintf(name, sizeof name, "ao_%s_%s_%ux%u", ways[way].size, ways[way].filter, samples[rung][0],
             samples[rung][1]);
    bool good = save(b, name, grey);
    free(grey);
    snprintf(name, sizeof name, "lit_%s_%s_%ux%u", ways[way].size, ways[way].filter, samples[rung][0],
             samples[rung][1]);
    return good && masu_headless_target_read(&b->s[way].host, t, b->error, sizeof b->error) &&
           save(b, name, t->mapped);
}

/* A grey picture of the rays, a square of stride x stride pixels for each. */
static bool save_truth(bench *b) {
    size_t pixels = (size_t)b->o->size.width * b->o->size.height;
    uint8_t *grey = malloc(4 * pixels);
    if (!grey) return failed(b, "out of memory");
    memset(grey, 255, 4 * pixels);
    for (uint32_t i = 0; i < b->count; i++) {
        uint32_t half = b->o->stride / 2;
        for (uint32_t y = b->points[i].y - half; y <= b->points[i].y + half; y++) {
            for (uint32_t x = b->points[i].x - half; x <= b->points[i].x + half; x++) {
                if (x >= b->o->size.width || y >= b->o->size.height) continue;
                memset(grey + 4 * ((size_t)y * b->o->size.width + x),
                       (int)(b->points[i].truth * 255 + 0.5), 3);
            }
        }
    }
    bool good = save(b, "truth", grey);
    free(grey);
    return good;
}

/* The camera goes to the right by an eighth of a pixel at the picture's middle depth, eight times:
 * root mean square of what changes from frame to frame, at the points. */
static bool move(bench *b, uint32_t way, uint32_t rung) {
    eye e = eye_of(b);
    double squares = 0, middle = 0;
    masu_commands commands;
    masu_readback_image depths;
    uint64_t count = 0;
    for (uint32_t m = 0; m <= MOVES; m++) {
        masu_camera c = b->camera;
        double step = middle * m / MOVES * 2 * e.tan_y / b->o->size.height;
        for (int k = 0; k < 3; k++) c.position[k] += e.right[k] * step;
        if (!draw(b, way, rung, &c, &commands)) return false;
        if (m == 0) {
            float depth = 0;
            point *p = &b->points[b->count / 2];
            if (masu_readback(b->s[way].m, commands.slot, MASU_READBACK_DEPTH, &depths))
                return failed(b, "no readback");
            memcpy(&depth, texel_at(&depths, p->x, p->y), sizeof depth);
            middle = depth > 0.0f ? e.near / (double)depth : 1;
        }
        masu_readback_image image = occlusion(b, way, rung, commands.slot);
        for (uint32_t i = 0; i < b->count; i++) {
            double s = seen_at(&image, b->points[i].x, b->points[i].y);
            double d = s - (double)b->before[i];
            if (m) squares += d * d, count++;
            b->before[i] = (float)s;
        }
    }
    b->rows[way][rung].moving = sqrt(squares / (double)count);
    return true;
}

static bool look(bench *b) {
    masu_commands commands;
    for (uint32_t way = 0; way < WAYS; way++) {
        for (uint32_t r = 0; r < RUNGS; r++) {
            if (!draw(b, way, r, &b->camera, &commands)) return false;
            if (!way && !r && (!trace(b, commands.slot) || (b->o->images && !save_truth(b))))
                return false;
            masu_cli_progress("%s, %s, %ux%u", ways[way].size, ways[way].filter, samples[r][0],
                              samples[r][1]);
            masu_readback_image image = occlusion(b, way, r, commands.slot);
            compare(b, &image, &b->rows[way][r]);
            if (b->o->images && !save_all(b, way, r, &image)) return false;
            if (!move(b, way, r)) return false;
        }
    }
    return true;
}

static bool time_all(bench *b) {
    for (uint32_t run = 0; run <= b->o->runs; run++) {
        masu_cli_progress("timing, round %u of %u", run, b->o->runs);
        for (uint32_t i = 0; i < WAYS * RUNGS; i++) {
            uint32_t k = (i + run * 5) % (WAYS * RUNGS), way = k % WAYS, rung = k / WAYS;
            masu_commands commands;
            masu_stats_info stats;
            double ao = 0, upsample = 0;
            if (!draw(b, way, rung, &b->camera, &commands)) return false;
            (void)masu_stats(b->s[way].m, commands.slot, &stats);
            for (uint32_t p = 0; p < stats.pass_count; p++) {
                double ms = (double)stats.pass_ns[p] / 1e6;
                if (!strcmp(stats.pass_names[p], "ao")) ao = ms;
                if (!strcmp(stats.pass_names[p], "ao_upsample")) upsample = ms;
            }
            row *r = &b->rows[way][rung];
            if (!run) continue; /* drivers compile at first use */
            if (run == 1 || ao < r->ao_ms) r->ao_ms = ao;
            if (run == 1 || upsample < r->upsample_ms) r->upsample_ms = upsample;
        }
    }
    return true;
}

static bool print(bench *b) {
    const masu_headless *host = &b->s[0].host;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(host->physical, &properties);
    FILE *f = b->o->csv && strcmp(b->o->csv, "-") != 0 ? fopen(b->o->csv, "w") : stdout;
    if (!f) return failed(b, "the CSV file cannot be written");
    fprintf(f, "scene,radius,size,filter,slices,steps,taps_per_pixel,rmse,mean,correlation,p99,worst,"
               "moving,ao_ms,upsample_ms,truth_mean,points,rays,width,height,driver\n");
    for (uint32_t r = 0; r < RUNGS; r++) {
        for (uint32_t way = 0; way < (r == OFF ? 1 : WAYS); way++) {
            const row *w = &b->rows[way][r];
            double taps = 2.0 * samples[r][0] * samples[r][1] / (ways[way].full ? 1 : 4);
            fprintf(f, "%s,%g,%s,%s,%u,%u,%g,%.4f,%+.4f,%.4f,%.3f,%.3f,%.5f,%.2f,%.2f,%.4f,%u,%u,%u,%u,"
                       "\"%s\"\n",
                    b->o->path, b->o->radius, r == OFF ? "off" : ways[way].size, ways[way].filter,
                    samples[r][0], samples[r][1], taps, w->rmse, w->mean, w->correlation, w->p99,
                    w->worst, w->moving, w->ao_ms, w->upsample_ms, b->truth_mean, b->count, b->o->rays,
                    b->o->size.width, b->o->size.height, properties.deviceName);
        }
    }
    return f == stdout || !fclose(f) || failed(b, "the CSV file cannot be written");
}

static bool open_sessions(bench *b, const masu_headless_desc *host, uint32_t *opened) {
    for (uint32_t way = 0; way < WAYS; way++) {
        masu_session_desc d;
        memset(&d, 0, sizeof d);
        d.scene_path = b->o->path;
        d.host = *host;
        d.desc.output = b->o->size;
        d.desc.targets.storage = 1;
        d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_NORMAL | MASU_READBACK_OCCLUSION;
        d.desc.debug = (masu_debug){.timestamps = 1,
                                    .ao_full = ways[way].full,
                                    .ao_nearest = ways[way].nearest};
        d.desc.rung_count = RUNGS;
        for (uint32_t r = 0; r < RUNGS; r++) {
            d.desc.rungs[r].lod_error = -1.0f; /* the rays see the finest forms */
            d.desc.rungs[r].ao = r == OFF ? MASU_OFF : MASU_ON;
            d.desc.rungs[r].ao_slices = samples[r][0];
            d.desc.rungs[r].ao_steps = samples[r][1];
        }
        if (!masu_session_open(&d, &b->s[way], b->error, sizeof b->error)) return false;
        ++*opened;
    }
    return true;
}

static int bench_scene(options *o, const masu_headless_desc *host) {
    static bench b;
    uint32_t opened = 0;
    memset(&b, 0, sizeof b);
    b.o = o;
    bool good = open_sessions(&b, host, &opened);
    if (good && masu_camera_at(b.s[0].m, o->time, &b.camera))
        good = failed(&b, "the scene has no camera");
    good = good && open_truth(&b);
    if (good && !(o->radius > 0)) o->radius = (double)b.scene.occlusion_radius;
    if (good && !(o->radius > 0))
        good = failed(&b, "asks for no ambient occlusion, and --radius is not given");
    if (good && b.scene.occlusion_radius > 0.0f && (double)b.scene.occlusion_radius != o->radius)
        good = failed(&b, "has a radius of its own, --radius is for scenes that have none");
    good = good && look(&b) && time_all(&b);
    masu_cli_progress_clear();
    good = good && print(&b);
    if (!good) masu_cli_error("%s", b.error);
    masu_ao_close(&b.world);
    masu_truth_close(&b.field);
    free(b.blob);
    free(b.points);
    free(b.differences);
    free(b.before);
    int code = good ? MASU_CLI_OK : MASU_CLI_FAILURE;
    for (uint32_t way = 0; way < opened; way++) {
        masu_session_close(&b.s[way]);
        code = masu_finish_validation(&b.s[way].host, code);
    }
    return code;
}

static int run(masu_cli *cli) {
    options o = {.size = {640, 360}, .runs = 5, .rays = 256, .stride = 3};
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
        case OPTION_RUNS:
            if (!masu_cli_uint(cli, 1, 10000, &o.runs)) return MASU_CLI_USAGE;
            continue;
        case OPTION_RAYS:
            if (!masu_cli_uint(cli, 1, 1000000, &o.rays)) return MASU_CLI_USAGE;
            continue;
        case OPTION_STRIDE:
            if (!masu_cli_uint(cli, 1, 1023, &o.stride)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TIME:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.time)) return MASU_CLI_USAGE;
            continue;
        case OPTION_RADIUS:
            if (!masu_cli_double(cli, 1e-3, 1e6, &o.radius)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TRUTH: o.truth = cli->value; continue;
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
    o.stride |= 1; /* an even one would see one pixel of each texel of half size alone */
    return bench_scene(&o, &host);
}

static const masu_cli_option list[] = {
    {"size", "WxH", "size in pixels (default 640x360)", OPTION_SIZE, 0},
    {"csv", "FILE", "where to write (default: standard output)", OPTION_CSV, 0},
    {"runs", "N", "timed frames of each way (default 5)", OPTION_RUNS, 0},
    {"rays", "N", "rays of each point (default 256)", OPTION_RAYS, 0},
    {"stride", "S", "compare every S-th pixel of every S-th row, odd (default 3)", OPTION_STRIDE, 0},
    {"time", "SECONDS", "moment of the scene (default 0)", OPTION_TIME, 0},
    {"radius", "METRES", "of the rays, for scenes whose SDF alone occludes", OPTION_RADIUS, 0},
    {"truth", "FILE.so", "the SDF in double precision (default: SCENE.truth.so)", OPTION_TRUTH, 0},
    {"images", "FOLDER", "write the seen part and the lit picture of every way there", OPTION_IMAGES,
     0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_ao_bench = {
    .name = "ao-bench",
    .arguments = "SCENE.masu [options]",
    .summary = "measure ambient occlusion in screen space against rays",
    .options = list,
    .details =
        "One line of CSV for each number of slices and steps, size and filter; the line \"off\" is "
        "the picture without.\nrmse, mean: of the seen part less that of the rays; p99, worst: of its "
        "size; moving: root mean square of the\nchange when the camera moves by an eighth of a "
        "pixel. Scenes with polygons and an SDF have no truth.\n",
    .run = run};
