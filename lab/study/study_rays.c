/* study_rays.c: `masu-lab study rays`: rays per second through a scene's trees in a compute shader,
 * compared with Embree with the same triangles, transforms and rays. Their runs alternate; the
 * shortest run counts, as wall time from submit to fence. Also printed is the CPU time of all
 * threads of this process: on a software driver that is the work itself, independent of other load
 * on the machine. Rays: from the camera, and rough reflections from their hits. */
#include "lab/study/study.h"

#include "lab/study/rays.h"
#include "image.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PRIMARY, SPECULAR, KINDS };
static const char *const kind_names[KINDS] = {"primary", "specular"};

/* Ways to trace on the device; each is a row, compared with Embree. */
enum { COMPUTE, BACKENDS };
static const char *const backend_names[BACKENDS] = {"compute"};

typedef struct options {
    masu_study_options study;
    uint32_t threads;
    double roughness;
    bool flat;
} options;

static options given = {.study = {.size = {960, 540}, .runs = 9}, .threads = 2, .roughness = 0.3};
static const masu_study_options *const o = &given.study;

typedef struct row {
    uint32_t rays, hits, mismatches, given_up;
    double seconds, embree_seconds, nodes, triangles; /* the last two per ray */
    double cpu, embree_cpu;                           /* seconds of all threads */
} row;

typedef struct bench {
    masu_scene scene;
    uint8_t *bytes;
    masu_headless host;
    masu_bench_rays rays;
    masu_bench_gpu gpu;
    masu_bench_ray *in[KINDS];
    masu_bench_hit *truth;
    row rows[KINDS][BACKENDS];
    char error[1024];
} bench;

/* Whether one hits and the other misses, or t differs by more than 1e-4 t plus the rounding of
 * coordinates as large as the ray's. */
static bool differs(const masu_bench_ray *ray, const masu_bench_hit *a, const masu_bench_hit *b) {
    float most = fmaxf(fabsf(ray->origin[0]), fmaxf(fabsf(ray->origin[1]), fabsf(ray->origin[2])));
    if ((a->t >= 0) != (b->t >= 0)) return true;
    return a->t >= 0 && !(fabsf(a->t - b->t) <= 1e-4f * fmaxf(a->t, b->t) + 4e-6f * most + 1e-6f);
}

static void compare(bench *b, const masu_bench_ray *in, row *r) {
    const masu_bench_hit *hits = masu_bench_gpu_hits(&b->gpu);
    for (uint32_t i = 0; i < r->rays; i++) {
        r->hits += hits[i].t >= 0;
        r->given_up += hits[i].nodes == UINT32_MAX;
        r->mismatches += differs(&in[i], &hits[i], &b->truth[i]);
        r->nodes += hits[i].nodes == UINT32_MAX ? 0 : hits[i].nodes;
        r->triangles += hits[i].triangles;
    }
    r->nodes /= r->rays;
    r->triangles /= r->rays;
}

static double cpu_seconds(void) {
    struct timespec t;
    return clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t)
               ? 0
               : (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* One run that counts and compares, then the timed ones. */
static bool measure(bench *b, uint32_t kind, row *r) {
    double seconds;
    masu_bench_gpu_rays(&b->gpu, b->in[kind], r->rays);
    if (!r->rays) return true;
    if (!masu_bench_gpu_trace(&b->gpu, r->rays, true, &seconds, b->error, sizeof b->error))
        return false;
    (void)masu_bench_rays_embree(&b->rays, b->in[kind], r->rays, given.threads, b->truth);
    compare(b, b->in[kind], r);
    r->seconds = r->embree_seconds = r->cpu = r->embree_cpu = (double)INFINITY;
    for (uint32_t i = 0; i < o->runs; i++) {
        masu_cli_progress("%s: %u of %u", kind_names[kind], i + 1, o->runs);
        double from = cpu_seconds();
        if (!masu_bench_gpu_trace(&b->gpu, r->rays, false, &seconds, b->error, sizeof b->error))
            return false;
        r->seconds = fmin(r->seconds, seconds);
        double middle = cpu_seconds();
        r->embree_seconds =
            fmin(r->embree_seconds,
                 masu_bench_rays_embree(&b->rays, b->in[kind], r->rays, given.threads, b->truth));
        r->cpu = fmin(r->cpu, middle - from);
        r->embree_cpu = fmin(r->embree_cpu, cpu_seconds() - middle);
    }
    masu_cli_progress_clear();
    return true;
}

static bool make_rays(bench *b) {
    uint32_t pixels = o->size.width * o->size.height;
    masu_scene_view view = masu_scene_view_of(&b->scene);
    for (uint32_t k = 0; k < KINDS; k++) {
        b->in[k] = calloc(pixels, sizeof *b->in[k]);
        if (!b->in[k]) return false;
    }
    b->truth = calloc(pixels, sizeof *b->truth);
    if (!b->truth) return false;
    masu_bench_rays_primary(&b->rays, view.camera_keys, o->size.width, o->size.height,
                            b->in[PRIMARY]);
    (void)masu_bench_rays_embree(&b->rays, b->in[PRIMARY], pixels, given.threads, b->truth);
    uint32_t specular = masu_bench_rays_specular(&b->rays, b->in[PRIMARY], b->truth, pixels,
                                                 given.roughness, b->in[SPECULAR]);
    for (uint32_t i = 0; i < BACKENDS; i++) {
        b->rows[PRIMARY][i].rays = pixels;
        b->rows[SPECULAR][i].rays = specular;
    }
    return true;
}

static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"kind", NULL, "kind", NULL},
    {"backend", NULL, "backend", NULL},
    {"rays", "%.0f", "rays", "%.0f"},
    {"mrays_s", "%.4f", "Mrays/s", "%.3f"},
    {"embree_mrays_s", "%.4f", "Embree", "%.3f"},
    {"ratio", "%.4f", "ratio", "%.3f"},
    {"mismatches", "%.0f", "mismatches", "%.0f"},
    {"hits", "%.0f", NULL, NULL},
    {"given_up", "%.0f", NULL, NULL},
    {"nodes_per_ray", "%.3f", "nodes/ray", "%.2f"},
    {"triangles_per_ray", "%.3f", "triangles", "%.2f"},
    {"cpu_ns", "%.1f", NULL, NULL},
    {"embree_cpu_ns", "%.1f", NULL, NULL},
    {"cpu_ratio", "%.4f", "cpu ratio", "%.3f"},
    {"nodes", "%.0f", NULL, NULL},
    {"triangles", "%.0f", NULL, NULL},
    {"instances", "%.0f", NULL, NULL},
    {"static_bytes", "%.0f", NULL, NULL},
    {"frame_bytes", "%.0f", NULL, NULL},
    {"embree", NULL, NULL, NULL},
    {"threads", "%.0f", NULL, NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {"roughness", "%.3f", NULL, NULL},
    {"runs", "%.0f", NULL, NULL},
    {"driver", "\"", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, const bench *b, uint32_t kind, uint32_t backend) {
    const row *r = &b->rows[kind][backend];
    const masu_scene_data *s = masu_scene_data_of(&b->scene);
    double own = r->rays ? r->rays / r->seconds * 1e-6 : 0;
    double embree = r->rays ? r->rays / r->embree_seconds * 1e-6 : 0;
    masu_trace_static layout = masu_trace_static_layout(s->trace_nodes, s->trace_triangles);
    const double first[] = {r->rays,
                            own,
                            embree,
                            embree > 0 ? own / embree : 0,
                            r->mismatches,
                            r->hits,
                            r->given_up,
                            r->nodes,
                            r->triangles,
                            r->cpu / r->rays * 1e9,
                            r->embree_cpu / r->rays * 1e9,
                            r->embree_cpu / r->cpu,
                            s->trace_nodes,
                            s->trace_triangles,
                            s->trace_instances,
                            (double)layout.bytes,
                            (double)masu_trace_frame_bytes(s->trace_instances)};
    const double last[] = {given.threads, o->size.width, o->size.height, given.roughness, o->runs};
    masu_table_text(t, o->scene);
    masu_table_text(t, kind_names[kind]);
    masu_table_text(t, backend_names[backend]);
    masu_table_numbers(t, first, sizeof first / sizeof *first);
    masu_table_text(t, given.flat ? "flat" : "instances");
    masu_table_numbers(t, last, sizeof last / sizeof *last);
    masu_table_text(t, b->host.driver);
}

static int print(const bench *b) {
    masu_table t;
    masu_table_open(&t, columns, "n/a");
    for (uint32_t i = 0; i < KINDS * BACKENDS; i++) add_row(&t, b, i / BACKENDS, i % BACKENDS);
    fprintf(o->text, "%s: %u nodes, %u triangles, %u instances; %s\n", o->scene,
            masu_scene_data_of(&b->scene)->trace_nodes,
            masu_scene_data_of(&b->scene)->trace_triangles,
            masu_scene_data_of(&b->scene)->trace_instances, b->host.driver);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, o->csv);
}

static bool open_scene(bench *b) {
    size_t size;
    masu_detail detail;
    if (!masu_file_read(o->scene, (size_t)1 << 30, &b->bytes, &size, b->error, sizeof b->error))
        return false;
    if (masu_scene_bind(b->bytes, size, &b->scene, &detail) != MASU_OK) {
        snprintf(b->error, sizeof b->error, "%s: %s", o->scene, detail.text);
        return false;
    }
    if (!masu_scene_count(&b->scene, MASU_SCENE_CAMERA_KEY)) {
        snprintf(b->error, sizeof b->error, "%s: has no camera path", o->scene);
        return false;
    }
    /* As far away as a frame's anchor would be. */
    double anchor[3];
    for (uint32_t k = 0; k < 3; k++) {
        double at = (double)masu_scene_view_of(&b->scene).camera_keys->position[k];
        anchor[k] = 64.0 * round(at / 64.0);
    }
    char error[512];
    if (masu_bench_rays_open(&b->scene, anchor, given.flat, &b->rays, error, sizeof error))
        return true;
    snprintf(b->error, sizeof b->error, "%s: %s", o->scene, error);
    return false;
}

static bool measure_all(bench *b) {
    if (!open_scene(b)) return false;
    if (!make_rays(b)) {
        snprintf(b->error, sizeof b->error, "out of memory");
        return false;
    }
    if (!masu_headless_open(&o->host, &b->host, b->error, sizeof b->error) ||
        !masu_bench_gpu_open(&b->host, &b->rays, o->size.width * o->size.height, &b->gpu, b->error,
                             sizeof b->error)) {
        return false;
    }
    for (uint32_t k = 0; k < KINDS; k++) {
        if (!measure(b, k, &b->rows[k][COMPUTE])) return false;
    }
    return true;
}

static int run(void) {
    static bench b;
    int code = measure_all(&b) ? print(&b) : masu_cli_error("%s", b.error);
    masu_bench_gpu_close(&b.gpu);
    masu_headless_close(&b.host);
    code = masu_finish_validation(&b.host, code);
    masu_bench_rays_close(&b.rays);
    for (uint32_t k = 0; k < KINDS; k++) free(b.in[k]);
    free(b.truth);
    free(b.bytes);
    return code;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_RUNS(1, 1000),
    MASU_REAL(options, roughness, "roughness", "R", 0, 1,
              "of the surfaces that reflect specular rays"),
    MASU_UINT(options, threads, "threads", 1, 16, "threads of Embree"),
    MASU_FLAG(options, flat, "flat",
              "give Embree all triangles in world space instead of instances"),
    MASU_STUDY_CSV,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_rays = {
    .name = "rays",
    .purpose = "rays through a scene's trees, compared with Embree: rays per second, differences",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run};
