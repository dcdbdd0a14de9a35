/* probe_report.c: compares the light of a grid with ground truth. Ground truth is path traced, at
 * surface points visible from random positions within the grid, with more rays and bounces than the
 * probes use. It uses the scene's sky itself, not its spherical harmonics. Two renderers without
 * probes are listed for comparison: the sky's harmonics without occlusion, and one constant colour.
 *
 * All numbers are irradiance / pi. RMSE: the root of the mean squared error over points and
 * channels, relative to the mean of the ground truth; bias: the mean error, also relative; worst:
 * the error that 1 in 20 points exceeds. */
#define _POSIX_C_SOURCE 200809L
#include "bake/light/path.h"
#include "bake/light/probe_light.h"
#include "bake/light/probes.h"
#include "cli/cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRUTH_BOUNCES 16u
#define SKY_SAMPLES 16384u

typedef struct point {
    float position[3], normal[3];
    float truth[2][4][3]; /* of two halves of the rays: sky, emission, sun 0, sun between */
} point;

typedef struct judge {
    const masu_bake_trace *trace;
    const masu_blob_environment *environment;
    masu_path_lights lights;
    point *points;
    uint32_t rays;
} judge;

/* The sky of light.comp: by the sine of elevation, the horizon's colour below it. */
static void scene_sky(const void *context, const float d[3], float *rgb) {
    const masu_blob_environment *e = context;
    float k = sqrtf(fminf(fmaxf(d[1], 0.0f), 1.0f));
    for (int c = 0; c < 3; c++) {
        rgb[c] = e->sky_horizon[c] + (e->sky_zenith[c] - e->sky_horizon[c]) * k;
    }
}

static void project_sky(const masu_blob_environment *e, float sky[9][3]) {
    double sum[9][3] = {{0}};
    for (uint32_t i = 0; i < SKY_SAMPLES; i++) {
        float u[2], d[3], y[9], rgb[3];
        masu_path_sample(7, i, 0, u);
        masu_path_sphere(u, d);
        scene_sky(e, d, rgb);
        masu_probe_basis(d, y);
        for (int k = 0; k < 9; k++) {
            for (int c = 0; c < 3; c++) sum[k][c] += (double)(y[k] * rgb[c]);
        }
    }
    for (int k = 0; k < 9; k++) {
        for (int c = 0; c < 3; c++) {
            sky[k][c] = (float)(sum[k][c] * 4 * MASU_BAKE_PI / SKY_SAMPLES);
        }
    }
}

static void find_points(const masu_bake_trace *trace, const masu_blob_probes *p, point *points,
                        uint32_t *count) {
    uint32_t found = 0, wanted = *count;
    for (uint32_t i = 0; i < wanted * 64 && found < wanted; i++) {
        float u[2], v[2], w[2], origin[3], d[3];
        masu_bake_hit hit;
        masu_path_sample(11, i, 0, u);
        masu_path_sample(11, i, 1, v);
        masu_path_sample(11, i, 2, w);
        const float at[3] = {u[0], u[1], v[0]};
        for (int k = 0; k < 3; k++) {
            origin[k] = p->origin[k] + p->spacing[k] * (at[k] * (float)p->counts[k] - 0.5f);
        }
        masu_path_sphere(w, d);
        if (!masu_bake_trace_ray(trace, origin, d, FLT_MAX, &hit) || hit.back) continue;
        bool within = true;
        for (int k = 0; k < 3; k++) {
            float g = (hit.position[k] - p->origin[k]) / p->spacing[k];
            within = within && g >= -0.5f && g <= (float)p->counts[k] - 0.5f;
        }
        if (!within) continue;
        memcpy(points[found].position, hit.position, sizeof hit.position);
        memcpy(points[found++].normal, hit.normal, sizeof hit.normal);
    }
    *count = found;
}

static void find_truth(void *context, uint32_t item) {
    judge *j = context;
    point *p = &j->points[item];
    uint64_t seed = (uint64_t)item * 0xD1B54A32D192ED03u + 99;
    memset(p->truth, 0, sizeof p->truth);
    for (uint32_t r = 0; r < j->rays; r++) {
        float u[2], d[3], light[4][3] = {{0}};
        masu_bake_hit first;
        masu_path_sample(seed, r, 0, u);
        masu_path_cosine(p->normal, u, d);
        (void)masu_path_radiance(j->trace, &j->lights, p->position, d, seed, r,
                                 2.0f / (float)j->rays, light, &first);
        for (int s = 0; s < 4; s++) {
            for (int c = 0; c < 3; c++) p->truth[r & 1][s][c] += light[s][c];
        }
    }
}

/* ---- the table ---- */

typedef struct row {
    double square, sum, truth;
    double *errors;
    uint32_t count;
} row;

static void add(row *r, const float got[3], const float truth[3]) {
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double e = (double)got[c] - (double)truth[c];
        square += e * e / 3;
        r->sum += e / 3;
        r->truth += (double)truth[c] / 3;
    }
    r->square += square;
    r->errors[r->count++] = sqrt(square);
}

static int rising(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static masu_bake_probe_error sum_up(const char *light, const char *method, row *r) {
    double n = r->count ? r->count : 1, mean = fmax(r->truth / n, 1e-12);
    qsort(r->errors, r->count, sizeof *r->errors, rising);
    double worst = r->count ? r->errors[(size_t)((double)(r->count - 1) * 0.95)] : 0;
    return (masu_bake_probe_error){light, method, sqrt(r->square / n) / mean, r->sum / n / mean,
                                   worst / mean};
}

typedef struct method {
    const char *name;
    int kind; /* 0 probes, 1 the sky's harmonics, 2 one colour, 3 the other half of the rays */
    uint32_t bands, visibility;
} method;

/* A light, as weights of the four parts of the ground truth. */
typedef struct light {
    const char *name;
    float weights[4];
} light;

static void plain_sky(float sky[9][3], const float n[3], bool constant, float out[3]) {
    float y[9];
    masu_probe_basis(n, y);
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
        for (int k = 0; k < (constant ? 1 : 9); k++) {
            out[c] += sky[k][c] * y[k] * (k < 1 ? 1 : k < 4 ? 2.0f / 3 : 0.25f);
        }
        out[c] = fmaxf(out[c], 0.0f);
    }
}

static uint32_t judge_light(const judge *j, const masu_blob_probes *p, const uint32_t *data,
                            uint32_t points, const light *l, const float sun[3],
                            const masu_blob_environment *e, masu_bake_probe_error *errors) {
    static const method methods[] = {{"probes, as baked", 0, 3, 1},
                                     {"probes, no maps of distances", 0, 3, 0},
                                     {"probes, sky of 2 bands", 0, 2, 1},
                                     {"probes, sky of 1 band", 0, 1, 1},
                                     {"sky's harmonics, nothing between", 1, 3, 0},
                                     {"one colour", 2, 1, 0},
                                     {"the truth's own noise", 3, 0, 0}};
    uint32_t count = p->counts[0] * p->counts[1] * p->counts[2], rows = 0;
    uint32_t *lit = masu_bake_allocate((size_t)count * MASU_PROBE_LIT_WORDS * sizeof *lit);
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        const method *way = &methods[m];
        if (way->kind == 0 && way->bands < 3 &&
            (l->weights[0] == 0 || way->bands * way->bands >= p->sky_sets)) {
            continue;
        }
        if (way->kind == 0 && !way->visibility && !p->visibility) continue;
        masu_probe_sky now = {.sky = {{0}}};
        project_sky(e, now.sky);
        for (int c = 0; c < 3; c++) {
            now.sun_direction[c] = sun[c];
            now.sun[c] = e->sun_color[c] * (l->weights[2] + l->weights[3]);
            for (uint32_t k = 0; k < 9; k++) {
                if (k >= way->bands * way->bands) now.sky[k][c] = 0;
                now.sky[k][c] *= l->weights[0];
            }
        }
        masu_blob_probes used = *p;
        if (!way->visibility) used.visibility = 0;
        masu_probe_light(p, data, &now, lit);
        row r = {.errors = masu_bake_allocate(points * sizeof(double))};
        for (uint32_t i = 0; i < points; i++) {
            const point *at = &j->points[i];
            float truth[3], got[3], half[2][3] = {{0}};
            for (int c = 0; c < 3; c++) {
                for (int s = 0; s < 4; s++) {
                    float k = l->weights[s] * (s >= 2 ? e->sun_color[c] : 1);
                    half[0][c] += k * at->truth[0][s][c];
                    half[1][c] += k * at->truth[1][s][c];
                }
                truth[c] = (half[0][c] + half[1][c]) / 2;
                got[c] = half[0][c];
            }
            if (way->kind == 0) {
                masu_probe_lookup(&used, data, lit, at->position, at->normal, got);
            } else if (way->kind < 3) {
                plain_sky(now.sky, at->normal, way->kind == 2, got);
            }
            add(&r, got, truth);
        }
        errors[rows++] = sum_up(l->name, way->name, &r);
        free(r.errors);
    }
    free(lit);
    return rows;
}

uint32_t masu_bake_judge_probes(const masu_bake_content *content,
                                const masu_bake_probe_settings *settings,
                                const masu_bake_trace *trace, uint32_t points, uint32_t rays,
                                masu_bake_probe_error errors[MASU_BAKE_PROBE_ERRORS]) {
    const masu_blob_probes *p = MASU_BAKE_ARRAY(content, MASU_BLOB_PROBES, const masu_blob_probes);
    const uint32_t *data = MASU_BAKE_ARRAY(content, MASU_BLOB_PROBE_DATA, const uint32_t);
    const masu_blob_environment *e =
        MASU_BAKE_ARRAY(content, MASU_BLOB_ENVIRONMENT, const masu_blob_environment);
    /* The first sun, and the direction half way between the first and the second; for a single sun,
     * 20 degrees further. */
    float suns[2][4] = {{0}};
    masu_bake_vec3 a = masu_bake_v3f(e->sun_direction), b;
    if (p->suns) a = masu_bake_v3f(p->sun_direction[0]);
    if (p->suns > 1) {
        b = masu_bake_mad(a, masu_bake_v3f(p->sun_direction[1]), 1);
    } else {
        masu_bake_affine turn = masu_bake_rotation(1, 20);
        b = masu_bake_apply(&turn, a);
    }
    if (!masu_bake_normalize(&b)) b = a;
    const masu_bake_vec3 both[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        suns[i][0] = (float)both[i].x;
        suns[i][1] = (float)both[i].y;
        suns[i][2] = (float)both[i].z;
    }
    judge j = {.trace = trace, .environment = e, .rays = rays & ~1u};
    j.points = masu_bake_allocate(points * sizeof *j.points);
    j.lights = (masu_path_lights){.sky = scene_sky,
                                  .context = e,
                                  .sky_sets = 1,
                                  .suns = 2,
                                  .sun = (const float(*)[4])suns,
                                  .bounces = TRUTH_BOUNCES};
    find_points(trace, p, j.points, &points);
    masu_cli_progress("tracing the truth at %u points", points);
    masu_path_share(points, settings->threads, find_truth, &j);
    masu_cli_progress_clear();
    static const light lights[] = {{"sky", {1, 0, 0, 0}},
                                   {"sun, first baked", {0, 0, 1, 0}},
                                   {"sun, in between", {0, 0, 0, 1}},
                                   {"all, first sun", {1, 1, 1, 0}},
                                   {"all, sun in between", {1, 1, 0, 1}}};
    uint32_t rows = 0;
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        if (p->emissive && lights[i].weights[1] == 0) continue; /* it cannot be put out */
        rows += judge_light(&j, p, data, points, &lights[i], suns[lights[i].weights[3] > 0], e,
                            errors + rows);
    }
    free(j.points);
    return rows;
}

void masu_bake_report_probes(const masu_bake_content *content,
                             const masu_bake_probe_settings *settings, const masu_bake_trace *trace,
                             uint32_t points, uint32_t rays) {
    masu_bake_probe_error errors[MASU_BAKE_PROBE_ERRORS];
    uint32_t rows = masu_bake_judge_probes(content, settings, trace, points, rays, errors);
    printf("  %-22s %-34s %9s  %9s  %9s\n", "light", "method", "RMSE", "bias", "worst 5 %");
    for (uint32_t i = 0; i < rows; i++) {
        const masu_bake_probe_error *e = &errors[i];
        printf("  %-22s %-34s %7.1f %%  %+7.1f %%  %7.1f %%\n", e->light, e->method, e->rmse * 100,
               e->bias * 100, e->worst * 100);
    }
}
