/* study_ao.c: `masu study ao`: ambient occlusion in screen space beside rays (bench/study/ao.h), for
 * several numbers of samples, at half and at full size, with and without the mean over 4x4 texels:
 * errors, times, and how much of it moves when the camera moves by an eighth of a pixel.
 *
 * Four renderers, one for each size and filter, a rung for each number of samples. The points that are
 * compared are those of the picture: every stride-th pixel, placed by its depth, with its normal. Times
 * are the least of the runs, all ways in turn. Nothing is judged. */
#include "masu/study.h"

#include "bench/study/ao.h"
#include "bench/study/texel.h"
#include "image.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    masu_study_options study;
    uint32_t rays;
    double radius;
} options;

static options given = {.study = {.size = {640, 360}, .runs = 5, .stride = 3}, .rays = 256};
static const masu_study_options *const o = &given.study;

typedef struct point {
    uint32_t x, y;
    double truth;
} point;

typedef struct row {
    double rmse, mean, correlation, p99, worst, moving;
    double ao_ms, upsample_ms;
} row;

typedef struct bench {
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
    if (text != b->error) snprintf(b->error, sizeof b->error, "%s: %s", o->scene, text);
    return false;
}

static bool draw(bench *b, uint32_t way, uint32_t rung, const masu_camera *camera,
                 masu_commands *commands) {
    masu_frame_desc f = {.camera = camera, .rung = rung, .time = o->time};
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
    if (rung == OFF && !masu_scene_data_of(&b->scene)->sdf_occlusion &&
        !masu_scene_shadow_cascades(&b->scene, NULL))
        return image;
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
    e.tan_x = e.tan_y * o->size.width / o->size.height;
    float near = b->camera.near_distance;
    e.near = (double)(near != 0.0f ? near : masu_scene_look(&b->scene).environment->near_distance);
    return e;
}

static bool open_truth(bench *b) {
    size_t bytes = 0;
    masu_detail detail;
    char path[4096];
    if (!masu_file_read(o->scene, (size_t)2 << 30, &b->blob, &bytes, b->error, sizeof b->error))
        return false;
    if (masu_scene_bind(b->blob, bytes, &b->scene, &detail)) return failed(b, detail.text);
    if ((masu_scene_features(&b->scene) & MASU_SCENE_HAS_SDF)) {
        const char *truth = o->field;
        if (!truth && masu_truth_path(o->scene, path, sizeof path)) truth = path;
        if (!masu_view_of(&b->scene, &b->camera, o->time, o->size.width, o->size.height,
                          &b->view, b->error, sizeof b->error) ||
            !masu_truth_open(truth, &b->field, b->error, sizeof b->error)) {
            return false;
        }
    }
    if (!masu_ao_open(&b->scene, &b->world, b->error, sizeof b->error)) return false;
    if ((masu_scene_features(&b->scene) & MASU_SCENE_HAS_SDF))
        b->world.field = &b->field, b->world.view = &b->view;
    return true;
}

static bool trace(bench *b, uint32_t slot) {
    masu_readback_image depths, normals;
    eye e = eye_of(b);
    const VkExtent2D size = o->size;
    double sum = 0;
    if (masu_readback(b->s[0].m, slot, MASU_READBACK_DEPTH, &depths) ||
        masu_readback(b->s[0].m, slot, MASU_READBACK_NORMAL, &normals)) {
        return failed(b, "no readback");
    }
    b->points = calloc((size_t)size.width * size.height, sizeof *b->points);
    b->differences = calloc((size_t)size.width * size.height, sizeof *b->differences);
    b->before = calloc((size_t)size.width * size.height, sizeof *b->before);
    if (!b->points || !b->differences || !b->before) return failed(b, "out of memory");
    for (uint32_t y = o->stride / 2; y < size.height; y += o->stride) {
        masu_cli_progress("rays, row %u of %u", y, size.height);
        for (uint32_t x = o->stride / 2; x < size.width; x += o->stride) {
            float depth, n[3];
            uint32_t texel;
            double at[3], normal[3], u, v, z;
            memcpy(&depth, texel_at(&depths, x, y), sizeof depth);
            memcpy(&texel, texel_at(&normals, x, y), sizeof texel);
            if (!(depth > 0.0f) || masu_texel_is_unlit(texel)) continue;
            masu_unpack_normal(texel, n);
            u = ((x + 0.5) / size.width * 2 - 1) * e.tan_x;
            v = ((y + 0.5) / size.height * 2 - 1) * e.tan_y;
            z = e.near / (double)depth;
            for (int k = 0; k < 3; k++) {
                at[k] = b->camera.position[k] + (e.forward[k] + e.right[k] * u - e.up[k] * v) * z;
                normal[k] = (double)n[k];
            }
            point *p = &b->points[b->count];
            *p = (point){x, y, masu_ao_seen(&b->world, at, normal, 1e-4 * z + 1e-3 * given.radius,
                                            given.radius, given.rays, b->count)};
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

/* DIR/SCENE.NAME.png */
static void image_path(const char *name, char *path, size_t size) {
    char scene[256];
    masu_study_scene_name(o->scene, scene, sizeof scene);
    snprintf(path, size, "%s/%s.%s.png", o->images, scene, name);
}

/* The seen part as grey, and the lit picture. */
static bool save_all(bench *b, uint32_t way, uint32_t rung, const masu_readback_image *image) {
    char name[64], path[4096];
    masu_headless_target *t = &b->s[way].targets[0];
    VkExtent2D size = o->size;
    float *seen = malloc((size_t)size.width * size.height * sizeof *seen);
    if (!seen) return failed(b, "out of memory");
    for (uint32_t y = 0, i = 0; y < size.height; y++) {
        for (uint32_t x = 0; x < size.width; x++, i++) seen[i] = (float)seen_at(image, x, y);
    }
    snprintf(name, sizeof name, "ao_%s_%s_%ux%u", ways[way].size, ways[way].filter, samples[rung][0],
             samples[rung][1]);
    image_path(name, path, sizeof path);
    bool good = masu_study_save_grey(path, seen, size, b->error, sizeof b->error);
    free(seen);
    snprintf(name, sizeof name, "lit_%s_%s_%ux%u", ways[way].size, ways[way].filter, samples[rung][0],
             samples[rung][1]);
    image_path(name, path, sizeof path);
    return good && masu_headless_target_read(&b->s[way].host, t, b->error, sizeof b->error) &&
           masu_image_save_png(path, t->mapped, size.width, size.height, 0, b->error,
                               sizeof b->error);
}

/* A grey picture of the rays, a square of stride x stride pixels for each. */
static bool save_truth(bench *b) {
    char path[4096];
    VkExtent2D size = o->size;
    size_t pixels = (size_t)size.width * size.height;
    float *seen = malloc(pixels * sizeof *seen);
    if (!seen) return failed(b, "out of memory");
    for (size_t i = 0; i < pixels; i++) seen[i] = 1.0f;
    for (uint32_t i = 0; i < b->count; i++) {
        const point *p = &b->points[i];
        uint32_t half = o->stride / 2;
        for (uint32_t y = p->y - half; y <= p->y + half && y < size.height; y++) {
            for (uint32_t x = p->x - half; x <= p->x + half && x < size.width; x++)
                seen[(size_t)y * size.width + x] = (float)p->truth;
        }
    }
    image_path("truth", path, sizeof path);
    bool good = masu_study_save_grey(path, seen, size, b->error, sizeof b->error);
    free(seen);
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
        double step = middle * m / MOVES * 2 * e.tan_y / o->size.height;
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
            if (!way && !r && (!trace(b, commands.slot) || (o->images && !save_truth(b))))
                return false;
            masu_cli_progress("%s, %s, %ux%u", ways[way].size, ways[way].filter, samples[r][0],
                              samples[r][1]);
            masu_readback_image image = occlusion(b, way, r, commands.slot);
            compare(b, &image, &b->rows[way][r]);
            if (o->images && !save_all(b, way, r, &image)) return false;
            if (!move(b, way, r)) return false;
        }
    }
    return true;
}

static bool time_all(bench *b) {
    for (uint32_t run = 0; run <= o->runs; run++) {
        masu_cli_progress("timing, round %u of %u", run, o->runs);
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

static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"radius", "%g", NULL, NULL},
    {"size", NULL, "size", NULL},
    {"filter", NULL, "filter", NULL},
    {"slices", "%.0f", "slices", "%.0f"},
    {"steps", "%.0f", "steps", "%.0f"},
    {"taps_per_pixel", "%g", "taps/pixel", "%g"},
    {"rmse", "%.4f", "rmse", "%.4f"},
    {"mean", "%+.4f", "mean", "%+.4f"},
    {"correlation", "%.4f", "correlation", "%.4f"},
    {"p99", "%.3f", "p99", "%.3f"},
    {"worst", "%.3f", "worst", "%.3f"},
    {"moving", "%.5f", "moving", "%.5f"},
    {"ao_ms", "%.2f", "ao ms", "%.2f"},
    {"upsample_ms", "%.2f", "upsample", "%.2f"},
    {"truth_mean", "%.4f", NULL, NULL},
    {"points", "%.0f", NULL, NULL},
    {"rays", "%.0f", NULL, NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {"driver", "\"", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, const bench *b, uint32_t way, uint32_t rung) {
    const row *w = &b->rows[way][rung];
    double taps = 2.0 * samples[rung][0] * samples[rung][1] / (ways[way].full ? 1 : 4);
    const double numbers[] = {samples[rung][0], samples[rung][1], taps,       w->rmse,
                              w->mean,          w->correlation,   w->p99,     w->worst,
                              w->moving,        w->ao_ms,         w->upsample_ms,
                              b->truth_mean,    b->count,         given.rays, o->size.width,
                              o->size.height};
    masu_table_text(t, o->scene);
    masu_table_number(t, given.radius);
    masu_table_text(t, rung == OFF ? "off" : ways[way].size);
    masu_table_text(t, ways[way].filter);
    masu_table_numbers(t, numbers, sizeof numbers / sizeof *numbers);
    masu_table_text(t, b->s[0].host.properties.deviceName);
}

static int print(const bench *b) {
    masu_table t;
    masu_table_open(&t, columns, "n/a");
    for (uint32_t r = 0; r < RUNGS; r++) {
        for (uint32_t way = 0; way < (r == OFF ? 1 : WAYS); way++) add_row(&t, b, way, r);
    }
    fprintf(o->text, "%s, %ux%u, radius %g m, %u points of %u rays, mean %.4f; %s\n", o->scene,
            o->size.width, o->size.height, given.radius, b->count, given.rays, b->truth_mean,
            b->s[0].host.driver);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, o->csv);
}

static bool open_sessions(bench *b, uint32_t *opened) {
    for (uint32_t way = 0; way < WAYS; way++) {
        masu_session_desc d;
        memset(&d, 0, sizeof d);
        d.scene_path = o->scene;
        d.host = o->host;
        d.desc.output = o->size;
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

/* Of the rays: the scene's, or the one that is given where it has none. */
static bool choose_radius(bench *b) {
    double own = (double)masu_scene_data_of(&b->scene)->occlusion_radius;
    if (!(given.radius > 0)) given.radius = own;
    if (!(given.radius > 0))
        return failed(b, "asks for no ambient occlusion, and --radius is not given");
    if (own > 0 && own != given.radius)
        return failed(b, "has a radius of its own, --radius is for scenes that have none");
    return true;
}

static int run(void) {
    static bench b;
    uint32_t opened = 0;
    bool good = open_sessions(&b, &opened);
    if (good && masu_camera_at(b.s[0].m, o->time, &b.camera))
        good = failed(&b, "the scene has no camera");
    good = good && open_truth(&b) && choose_radius(&b) && look(&b) && time_all(&b);
    masu_cli_progress_clear();
    int code = good ? print(&b) : masu_cli_error("%s", b.error);
    masu_ao_close(&b.world);
    masu_truth_close(&b.field);
    free(b.blob);
    free(b.points);
    free(b.differences);
    free(b.before);
    for (uint32_t way = 0; way < opened; way++) {
        masu_session_close(&b.s[way]);
        code = masu_finish_validation(&b.s[way].host, code);
    }
    return code;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_CSV,
    MASU_STUDY_RUNS(1, 10000),
    MASU_UINT(options, rays, "rays", 1, 1000000, "rays of each point"),
    MASU_STUDY_STRIDE,
    MASU_STUDY_TIME,
    MASU_REAL(options, radius, "radius", "METRES", 1e-3, 1e6,
              "of the rays, for scenes whose SDF alone occludes"),
    MASU_STUDY_FIELD,
    MASU_STUDY_IMAGES("write the seen part and the lit picture of every way there, as PNG"),
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_ao = {
    .name = "ao",
    .purpose = "ambient occlusion in screen space against rays",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details =
        "One row for each number of slices and steps, size and filter; the row \"off\" is the picture\n"
        "without. rmse, mean: of the seen part less that of the rays; p99, worst: of its size; moving:\n"
        "root mean square of the change when the camera moves by an eighth of a pixel. Scenes with\n"
        "polygons and an SDF have no truth.\n"};
