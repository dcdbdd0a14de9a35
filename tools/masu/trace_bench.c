/* trace_bench.c: `masu trace-bench`: rays per second through a scene's own trees in a compute
 * shader, beside Embree with the same triangles, transforms and rays. Both take turns, and of the
 * repetitions the least time counts, on the wall from submit to fence; beside it the time of all
 * threads of this process, which on a software driver is the work itself, whatever else the machine
 * does. Rays: those of the camera, and those of rough reflections from what these have hit. */
#include "masu/cmd.h"

#include "bench/study/rays.h"
#include "image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { OPTION_SIZE = 1, OPTION_REPEAT, OPTION_ROUGHNESS, OPTION_THREADS, OPTION_FLAT, OPTION_CSV };

enum { PRIMARY, SPECULAR, KINDS };
static const char *const kind_names[KINDS] = {"primary", "specular"};

/* Ways to trace on the device; each is a row beside Embree's. */
enum { COMPUTE, BACKENDS };
static const char *const backend_names[BACKENDS] = {"compute"};

typedef struct options {
    const char *path, *csv;
    VkExtent2D size;
    uint32_t repeat, threads;
    double roughness;
    bool flat;
} options;

typedef struct row {
    uint32_t rays, hits, mismatches, given_up;
    double seconds, embree_seconds, nodes, triangles; /* the last two of a ray */
    double cpu, embree_cpu;                           /* seconds of all threads */
} row;

typedef struct bench {
    const options *o;
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

/* Hit or miss, or t by over 1e-4 of it and what rounding makes of coordinates as large as the
 * ray's. */
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

/* A round that counts and compares, then those that are timed. */
static bool measure(bench *b, uint32_t kind, row *r) {
    double seconds;
    masu_bench_gpu_rays(&b->gpu, b->in[kind], r->rays);
    if (!r->rays) return true;
    if (!masu_bench_gpu_trace(&b->gpu, r->rays, true, &seconds, b->error, sizeof b->error))
        return false;
    (void)masu_bench_rays_embree(&b->rays, b->in[kind], r->rays, b->o->threads, b->truth);
    compare(b, b->in[kind], r);
    r->seconds = r->embree_seconds = r->cpu = r->embree_cpu = (double)INFINITY;
    for (uint32_t i = 0; i < b->o->repeat; i++) {
        masu_cli_progress("%s: %u of %u", kind_names[kind], i + 1, b->o->repeat);
        double from = cpu_seconds();
        if (!masu_bench_gpu_trace(&b->gpu, r->rays, false, &seconds, b->error, sizeof b->error))
            return false;
        r->seconds = fmin(r->seconds, seconds);
        double middle = cpu_seconds();
        r->embree_seconds =
            fmin(r->embree_seconds,
                 masu_bench_rays_embree(&b->rays, b->in[kind], r->rays, b->o->threads, b->truth));
        r->cpu = fmin(r->cpu, middle - from);
        r->embree_cpu = fmin(r->embree_cpu, cpu_seconds() - middle);
    }
    masu_cli_progress_clear();
    return true;
}

static bool make_rays(bench *b) {
    uint32_t pixels = b->o->size.width * b->o->size.height;
    masu_scene_view view = masu_scene_look(&b->scene);
    for (uint32_t k = 0; k < KINDS; k++) {
        b->in[k] = calloc(pixels, sizeof *b->in[k]);
        if (!b->in[k]) return false;
    }
    b->truth = calloc(pixels, sizeof *b->truth);
    if (!b->truth) return false;
    masu_bench_rays_primary(&b->rays, view.camera_keys, b->o->size.width, b->o->size.height,
                            b->in[PRIMARY]);
    (void)masu_bench_rays_embree(&b->rays, b->in[PRIMARY], pixels, b->o->threads, b->truth);
    uint32_t specular = masu_bench_rays_specular(&b->rays, b->in[PRIMARY], b->truth, pixels,
                                                 b->o->roughness, b->in[SPECULAR]);
    for (uint32_t i = 0; i < BACKENDS; i++) {
        b->rows[PRIMARY][i].rays = pixels;
        b->rows[SPECULAR][i].rays = specular;
    }
    return true;
}

static void print_rows(const bench *b, FILE *f, bool csv) {
    if (csv) {
        fputs("scene,kind,backend,rays,mrays_s,embree_mrays_s,ratio,mismatches,hits,given_up,"
              "nodes_per_ray,triangles_per_ray,cpu_ns,embree_cpu_ns,cpu_ratio,nodes,triangles,"
              "instances,static_bytes,frame_bytes,"
              "embree,threads,width,height,roughness,runs,driver\n",
              f);
    } else {
        fprintf(f, "%s: %u nodes, %u triangles, %u instances; %s\n", b->o->path,
                b->scene.trace_nodes, b->scene.trace_triangles, b->scene.trace_instances,
                b->host.driver);
        fprintf(f, "  %-9s %-8s %9s %9s %9s %7s %9s %10s %9s %11s\n", "rays", "backend", "number",
                "Mrays/s", "Embree", "ratio", "cpu ratio", "mismatches", "nodes/ray", "triangles");
    }
    for (uint32_t i = 0; i < KINDS * BACKENDS; i++) {
        const row *r = &b->rows[i / BACKENDS][i % BACKENDS];
        const char *kind = kind_names[i / BACKENDS], *backend = backend_names[i % BACKENDS];
        double own = r->rays ? r->rays / r->seconds * 1e-6 : 0;
        double embree = r->rays ? r->rays / r->embree_seconds * 1e-6 : 0;
        double ratio = embree > 0 ? own / embree : 0;
        if (csv) {
            masu_trace_static s =
                masu_trace_static_layout(b->scene.trace_nodes, b->scene.trace_triangles);
            fprintf(f,
                    "%s,%s,%s,%u,%.4f,%.4f,%.4f,%u,%u,%u,%.3f,%.3f,%.1f,%.1f,%.4f,%u,%u,%u,%llu,%"
                    "llu,%s,%u,%u,%u,"
                    "%.3f,%u,\"%s\"\n",
                    b->o->path, kind, backend, r->rays, own, embree, ratio, r->mismatches, r->hits,
                    r->given_up, r->nodes, r->triangles, r->cpu / r->rays * 1e9,
                    r->embree_cpu / r->rays * 1e9, r->embree_cpu / r->cpu, b->scene.trace_nodes,
                    b->scene.trace_triangles, b->scene.trace_instances, (unsigned long long)s.bytes,
                    (unsigned long long)masu_trace_frame_bytes(b->scene.trace_instances),
                    b->o->flat ? "flat" : "instances", b->o->threads, b->o->size.width,
                    b->o->size.height, b->o->roughness, b->o->repeat, b->host.driver);
        } else {
            fprintf(f, "  %-9s %-8s %9u %9.3f %9.3f %7.3f %9.3f %10u %9.2f %11.2f\n", kind, backend,
                    r->rays, own, embree, ratio, r->rays ? r->embree_cpu / r->cpu : 0,
                    r->mismatches, r->nodes, r->triangles);
        }
    }
}

static bool write_csv(bench *b) {
    if (!b->o->csv) return true;
    FILE *f = strcmp(b->o->csv, "-") ? fopen(b->o->csv, "w") : stdout;
    if (f) print_rows(b, f, true);
    bool good = f && !ferror(f);
    if (f && f != stdout && fclose(f)) good = false;
    if (!good) snprintf(b->error, sizeof b->error, "cannot write %s", b->o->csv);
    return good;
}

static bool open_scene(bench *b) {
    size_t size;
    masu_detail detail;
    if (!masu_file_read(b->o->path, (size_t)1 << 30, &b->bytes, &size, b->error, sizeof b->error))
        return false;
    if (masu_scene_bind(b->bytes, size, &b->scene, &detail) != MASU_OK) {
        snprintf(b->error, sizeof b->error, "%s: %s", b->o->path, detail.text);
        return false;
    }
    if (!b->scene.camera_keys) {
        snprintf(b->error, sizeof b->error, "%s: has no camera path", b->o->path);
        return false;
    }
    /* As far as a frame's anchor would be. */
    double anchor[3];
    for (uint32_t k = 0; k < 3; k++) {
        double at = (double)masu_scene_look(&b->scene).camera_keys->position[k];
        anchor[k] = 64.0 * round(at / 64.0);
    }
    char error[512];
    if (masu_bench_rays_open(&b->scene, anchor, b->o->flat, &b->rays, error, sizeof error))
        return true;
    snprintf(b->error, sizeof b->error, "%s: %s", b->o->path, error);
    return false;
}

static bool measure_all(bench *b, const masu_headless_desc *host) {
    if (!open_scene(b)) return false;
    if (!make_rays(b)) {
        snprintf(b->error, sizeof b->error, "out of memory");
        return false;
    }
    if (!masu_headless_open(host, &b->host, b->error, sizeof b->error) ||
        !masu_bench_gpu_open(&b->host, &b->rays, b->o->size.width * b->o->size.height, &b->gpu,
                             b->error, sizeof b->error)) {
        return false;
    }
    for (uint32_t k = 0; k < KINDS; k++) {
        if (!measure(b, k, &b->rows[k][COMPUTE])) return false;
    }
    if (!b->o->csv || strcmp(b->o->csv, "-")) print_rows(b, stdout, false);
    return write_csv(b);
}

static int bench_scene(const options *o, const masu_headless_desc *host) {
    static bench b;
    memset(&b, 0, sizeof b);
    b.o = o;
    int code = measure_all(&b, host) ? MASU_CLI_OK : masu_cli_error("%s", b.error);
    masu_bench_gpu_close(&b.gpu);
    masu_headless_close(&b.host);
    code = masu_finish_validation(&b.host, code);
    masu_bench_rays_close(&b.rays);
    for (uint32_t k = 0; k < KINDS; k++) free(b.in[k]);
    free(b.truth);
    free(b.bytes);
    return code;
}

static int run(masu_cli *cli) {
    options o = {.size = {960, 540}, .repeat = 9, .threads = 2, .roughness = 0.3};
    masu_headless_desc host = {.message = masu_print_message};
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &host)) continue;
        switch (id) {
        case OPTION_SIZE:
            if (!masu_output_size(cli, &o.size)) return MASU_CLI_USAGE;
            continue;
        case OPTION_REPEAT:
            if (!masu_cli_uint(cli, 1, 1000, &o.repeat)) return MASU_CLI_USAGE;
            continue;
        case OPTION_THREADS:
            if (!masu_cli_uint(cli, 1, 16, &o.threads)) return MASU_CLI_USAGE;
            continue;
        case OPTION_ROUGHNESS:
            if (!masu_cli_double(cli, 0, 1, &o.roughness)) return MASU_CLI_USAGE;
            continue;
        case OPTION_FLAT: o.flat = true; continue;
        case OPTION_CSV:
            if (!masu_output_file_or_stdout(cli, &o.csv)) return cli->exit_code;
            continue;
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
    {"size", "WxH", "size in pixels (default 960x540)", OPTION_SIZE, 0},
    {"repeat", "N", "times that each is traced; the least time counts (default 9)", OPTION_REPEAT,
     0},
    {"roughness", "R", "of the surfaces that specular rays leave (default 0.3)", OPTION_ROUGHNESS,
     0},
    {"threads", "N", "that Embree may use (default 2)", OPTION_THREADS, 0},
    {"flat", NULL, "give Embree all triangles in world space instead of instances", OPTION_FLAT, 0},
    {"csv", "FILE", "write the rows as CSV; -: to stdout", OPTION_CSV, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_trace_bench = {
    .name = "trace-bench",
    .arguments = "SCENE.masu [options]",
    .summary = "rays through a scene's trees, beside Embree: rays a second, differences",
    .options = list,
    .run = run};
