/* probes.c: see probes.h. A probe is one item of work: the number, values and order of its rays
 * depend only on its position in the grid. */
#define _POSIX_C_SOURCE 200809L
#include "bake/light/probes.h"
#include "bake/base/process.h"
#include "bake/light/path.h"
#include "bake/light/probe_light.h"
#include "cli/cli.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PROBES_WISHED 2048.0
#define COEFFICIENTS 27u
#define DISTANCE_MOST 1.5f /* in units of a cell's diagonal: farther surfaces occlude nothing within
                            * a cell */
/* A probe is inside an object if more than this share of its rays hits back faces. A probe this
 * close to a surface, in metres, is invalid too: its map could not separate the two sides. */
#define BACKS_MOST 0.25f
#define FACE_NEAREST 1e-3f
/* Rays of a live probe: the lobes of its map are narrow. */
#define LIVE_RAYS 2048u

masu_bake_probe_settings masu_bake_probe_defaults(void) {
    return (masu_bake_probe_settings){
        .rays = 1024, .bounces = 8, .sky_bands = 3, .visibility = 8, .bias = 0.25};
}

/* ---- the grid ---- */

/* Whether light is baked, not only distance maps. */
static bool is_lit(const masu_bake_probe_settings *s) { return s->wanted || !s->live; }

/* Device memory per probe. */
static uint64_t device_bytes(const masu_bake_probe_settings *s, const masu_blob_probes *p) {
    uint64_t side = s->visibility + 2, map = s->visibility ? side * side : 0;
    uint64_t words = masu_probe_sets(p) * MASU_PROBE_WORDS + map + MASU_PROBE_LIT_WORDS;
    return sizeof(uint32_t) * (words + (s->live ? MASU_PROBE_LIVE_WORDS : 0));
}

/* As near as MASU_BAKE_LIVE_SPACING, or as the bytes allow. */
static double live_spacing(const double size[3], uint64_t each) {
    double spacing = MASU_BAKE_LIVE_SPACING, most = (double)(MASU_BAKE_LIVE_BYTES / each);
    for (;; spacing *= 1.02) {
        double total = 1;
        for (int k = 0; k < 3; k++) total *= fmax(ceil(size[k] / spacing - 1e-6), 1);
        if (!(total > most)) break;
    }
    if (spacing > MASU_BAKE_LIVE_SPACING && !masu_cli_quiet())
        printf("bounce: probes %.3g m apart instead of %.3g, to take at most %llu MiB; \"spacing\" "
               "or a smaller "
               "\"box\" sets it\n",
               spacing, MASU_BAKE_LIVE_SPACING, (unsigned long long)(MASU_BAKE_LIVE_BYTES >> 20));
    return spacing;
}

/* Probes stand in the middles of their cells: none on the surfaces that bound the scene. */
static bool place(const masu_bake_content *content, const masu_bake_probe_settings *s,
                  masu_blob_probes *p) {
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box box = s->has_bounds ? s->bounds : masu_bake_bounds(content, &identity);
    if (!s->has_bounds && s->live && masu_bake_count(content, MASU_BLOB_SDF)) {
        const masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, const masu_blob_sdf);
        masu_bake_box_grow(&box, masu_bake_v3f(sdf->bounds_min));
        masu_bake_box_grow(&box, masu_bake_v3f(sdf->bounds_max));
    }
    if (masu_bake_box_is_empty(&box)) {
        masu_cli_error("probes: the scene has neither polygons nor bounds for them");
        return false;
    }
    const double low[3] = {box.low.x, box.low.y, box.low.z};
    double size[3] = {box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z};
    const double wish[3] = {s->spacing.x, s->spacing.y, s->spacing.z};
    double most = fmax(fmax(size[0], size[1]), fmax(size[2], 1e-3)), total = 1;
    for (int k = 0; k < 3; k++) size[k] = fmax(size[k], most * 1e-3);
    double even = cbrt(size[0] * size[1] * size[2] / PROBES_WISHED), count[3];
    if (s->live && !s->has_spacing && !s->has_counts) even = live_spacing(size, device_bytes(s, p));
    for (int k = 0; k < 3; k++) {
        count[k] = s->has_counts    ? s->counts[k]
                   : s->has_spacing ? ceil(size[k] / wish[k] - 1e-6)
                                    : ceil(size[k] / even - 1e-6);
        total *= fmax(count[k], 1);
    }
    if (total > MASU_PROBE_COUNT_MAX) {
        masu_cli_error("probes: %.0f x %.0f x %.0f are %.0f probes, at most %u", count[0], count[1],
                       count[2], total, MASU_PROBE_COUNT_MAX);
        return false;
    }
    double shortest = DBL_MAX;
    for (int k = 0; k < 3; k++) {
        p->counts[k] = (uint32_t)fmax(count[k], 1);
        double spacing = size[k] / p->counts[k];
        p->spacing[k] = (float)spacing;
        p->origin[k] = (float)(low[k] + 0.5 * spacing);
        shortest = fmin(shortest, spacing);
    }
    p->bias = (float)(shortest * s->bias);
    return true;
}

/* Gauss and Jordan, with the largest pivot. The kernel is positive definite for directions that
 * differ, of which no two are opposite; for those a little is added to the diagonal. */
static void invert(uint32_t n, double m[MASU_PROBE_SUNS_MAX][2 * MASU_PROBE_SUNS_MAX]) {
    for (uint32_t i = 0; i < n; i++) {
        uint32_t best = i;
        for (uint32_t k = i + 1; k < n; k++) {
            if (fabs(m[k][i]) > fabs(m[best][i])) best = k;
        }
        for (uint32_t j = 0; j < 2 * n; j++) {
            double swap = m[i][j];
            m[i][j] = m[best][j];
            m[best][j] = swap;
        }
        double pivot = m[i][i];
        for (uint32_t j = 0; j < 2 * n; j++) m[i][j] /= pivot;
        for (uint32_t k = 0; k < n; k++) {
            double factor = m[k][i];
            for (uint32_t j = 0; j < 2 * n && k != i; j++) m[k][j] -= factor * m[i][j];
        }
    }
}

static void set_suns(const masu_bake_content *content, const masu_bake_probe_settings *s,
                     masu_blob_probes *p) {
    const masu_blob_environment *e =
        MASU_BAKE_ARRAY(content, MASU_BLOB_ENVIRONMENT, const masu_blob_environment);
    p->suns = s->has_suns ? s->suns : 1;
    memcpy(p->sun_direction, s->sun, sizeof p->sun_direction);
    if (!s->has_suns) memcpy(p->sun_direction[0], e->sun_direction, 3 * sizeof(float));
    double m[MASU_PROBE_SUNS_MAX][2 * MASU_PROBE_SUNS_MAX] = {{0}};
    for (uint32_t i = 0; i < p->suns; i++) {
        for (uint32_t k = 0; k < p->suns; k++) {
            double c = masu_bake_dot(masu_bake_v3f(p->sun_direction[i]),
                                     masu_bake_v3f(p->sun_direction[k]));
            m[i][k] = i == k ? 1 + 1e-6 : 1 - acos(fmin(fmax(c, -1), 1)) / MASU_BAKE_PI;
            m[i][p->suns + k] = i == k;
        }
    }
    invert(p->suns, m);
    for (uint32_t i = 0; i < p->suns; i++) {
        for (uint32_t k = 0; k < p->suns; k++) p->sun_inverse[i][k] = (float)m[i][p->suns + k];
    }
}

/* ---- one probe ---- */

typedef struct work {
    const masu_bake_trace *trace;
    const masu_bake_probe_settings *settings;
    const masu_blob_probes *grid;
    masu_path_lights lights;
    uint32_t sets;  /* of paths: with that of emissive surfaces */
    float *sums;    /* of each probe: sets x COEFFICIENTS */
    uint8_t *valid; /* of each probe */
    uint32_t *maps; /* of each probe */
    atomic_ullong rays;
} work;

static void basis_sky(const void *context, const float d[3], float *rgb) {
    const uint32_t *count = context;
    float y[9];
    masu_probe_basis(d, y);
    for (uint32_t s = 0; s < *count; s++) rgb[s * 3] = rgb[s * 3 + 1] = rgb[s * 3 + 2] = y[s];
}

/* The direction of a texel of an octahedral map. */
static void texel_direction(uint32_t side, uint32_t i, uint32_t j, float d[3]) {
    float x = ((float)i + 0.5f) / (float)side * 2 - 1, y = ((float)j + 0.5f) / (float)side * 2 - 1;
    float z = 1 - fabsf(x) - fabsf(y), length;
    if (z < 0) {
        float fx = (1 - fabsf(y)) * (x >= 0 ? 1.0f : -1.0f);
        y = (1 - fabsf(x)) * (y >= 0 ? 1.0f : -1.0f);
        x = fx;
    }
    length = sqrtf(x * x + y * y + z * z);
    d[0] = x / length;
    d[1] = y / length;
    d[2] = z / length;
}

static uint32_t unorm16(float v) { return (uint32_t)(fminf(v, 1.0f) * 65535.0f + 0.5f); }

/* So many texels at a time, which the compiler puts into one register. */
#define TOGETHER 4u

/* Means over a lobe as wide as a texel or two: powers 32 and 64, narrow 200. d: of the texels. */
static void add_lobes(bool wide, bool narrow, uint32_t rays, const float (*hits)[4],
                      const float d[3][TOGETHER], float sums[3][TOGETHER]) {
    const float least = narrow ? 0.93f : 0.5f;
    for (uint32_t r = 0; r < rays; r++) {
        float cosine[TOGETHER], w[TOGETHER], w8[TOGETHER];
        for (uint32_t k = 0; k < TOGETHER; k++) {
            float c = d[0][k] * hits[r][0] + d[1][k] * hits[r][1] + d[2][k] * hits[r][2];
            cosine[k] = c > least ? c : 0;
        }
        for (uint32_t k = 0; k < TOGETHER; k++) {
            float c = cosine[k], c2 = c * c, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8;
            w8[k] = c8;
            w[k] = c16 * c16;
        }
        if (!wide)
            for (uint32_t k = 0; k < TOGETHER; k++) w[k] *= w[k];
        if (narrow)
            for (uint32_t k = 0; k < TOGETHER; k++) w[k] *= w[k] * w[k] * w8[k];
        for (uint32_t k = 0; k < TOGETHER; k++) {
            sums[0][k] += w[k];
            sums[1][k] += w[k] * hits[r][3];
            sums[2][k] += w[k] * hits[r][3] * hits[r][3];
        }
    }
}

static void make_map(uint32_t side, bool narrow, uint32_t rays, const float (*hits)[4],
                     uint32_t *map) {
    uint32_t outer = side + 2;
    for (uint32_t t = 0; t < side * side; t += TOGETHER) {
        float d[3][TOGETHER], sums[3][TOGETHER] = {{0}};
        for (uint32_t k = 0; k < TOGETHER; k++) {
            float own[3];
            texel_direction(side, (t + k) % side, (t + k) / side, own);
            for (uint32_t c = 0; c < 3; c++) d[c][k] = own[c];
        }
        add_lobes(side <= 6, narrow, rays, hits, (const float(*)[TOGETHER])d, sums);
        for (uint32_t k = 0; k < TOGETHER && t + k < side * side; k++) {
            float total = fmaxf(sums[0][k], 1e-20f);
            map[((t + k) / side + 1) * outer + (t + k) % side + 1] =
                unorm16(sums[1][k] / total / DISTANCE_MOST) |
                unorm16(sums[2][k] / total / (DISTANCE_MOST * DISTANCE_MOST)) << 16;
        }
    }
    /* The texels across an edge of the square are on the same edge, in reverse order. */
    for (uint32_t k = 0; k < side; k++) {
        uint32_t back = side - k;
        map[k + 1] = map[outer + back];
        map[(side + 1) * outer + k + 1] = map[side * outer + back];
        map[(k + 1) * outer] = map[back * outer + 1];
        map[(k + 1) * outer + side + 1] = map[back * outer + side];
    }
    map[0] = map[side * outer + side];
    map[side + 1] = map[side * outer + 1];
    map[(side + 1) * outer] = map[outer + side];
    map[(side + 1) * outer + side + 1] = map[outer + 1];
}

static void trace_probe(void *context, uint32_t item) {
    work *w = context;
    const masu_blob_probes *g = w->grid;
    const uint32_t paths = is_lit(w->settings) ? w->settings->rays : 0;
    uint32_t rays = paths, backs = 0;
    if (w->settings->live && rays < LIVE_RAYS) rays = LIVE_RAYS;
    bool touches = false;
    const uint32_t at[3] = {item % g->counts[0], item / g->counts[0] % g->counts[1],
                            item / g->counts[0] / g->counts[1]};
    float origin[3], diagonal = 0;
    for (int k = 0; k < 3; k++) {
        origin[k] = g->origin[k] + (float)at[k] * g->spacing[k];
        diagonal += g->spacing[k] * g->spacing[k];
    }
    diagonal = sqrtf(diagonal);
    float *sums = w->sums + (size_t)item * w->sets * COEFFICIENTS;
    double(*total)[COEFFICIENTS] = masu_bake_allocate(w->sets * sizeof *total);
    float(*hits)[4] = masu_bake_allocate(rays * sizeof *hits);
    memset(total, 0, w->sets * sizeof *total);
    uint64_t count = 0, seed = (uint64_t)item * 0x9E3779B97F4A7C15u + 1;
    for (uint32_t r = 0; r < rays; r++) {
        float u[2], d[3], y[9], light[MASU_PATH_SETS_MAX][3];
        masu_bake_hit first;
        memset(light, 0, w->sets * sizeof *light);
        masu_path_sample(seed, r, 0, u);
        masu_path_sphere(u, d);
        if (r < paths) {
            count += masu_path_radiance(w->trace, &w->lights, origin, d, seed, r, 1, light, &first);
        } else {
            count++;
            if (!masu_bake_trace_ray(w->trace, origin, d, FLT_MAX, &first)) first.t = -1;
        }
        float far = DISTANCE_MOST;
        if (first.t >= 0) far = fminf(first.t / diagonal * (first.back ? 0.2f : 1.0f), far);
        backs += first.t >= 0 && first.back;
        touches |= first.t >= 0 && first.t < FACE_NEAREST;
        memcpy(hits[r], d, sizeof d);
        hits[r][3] = far;
        masu_probe_basis(d, y);
        for (uint32_t s = 0; s < w->sets && r < paths; s++) {
            if (light[s][0] == 0 && light[s][1] == 0 && light[s][2] == 0) continue;
            for (uint32_t k = 0; k < COEFFICIENTS; k++) {
                total[s][k] += (double)(light[s][k % 3] * y[k / 3]);
            }
        }
    }
    /* To irradiance / pi: bands times 1, 2/3, 1/4 (Ramamoorthi and Hanrahan 2001). */
    for (uint32_t s = 0; s < w->sets; s++) {
        for (uint32_t k = 0; k < COEFFICIENTS; k++) {
            double band = k < 3 ? 1 : k < 12 ? 2.0 / 3 : 0.25;
            sums[s * COEFFICIENTS + k] =
                (float)(total[s][k] * band * 4 * MASU_BAKE_PI / fmax(paths, 1));
        }
    }
    w->valid[item] = !touches && (float)backs <= BACKS_MOST * (float)rays;
    uint32_t side = w->settings->visibility;
    if (side)
        make_map(side, w->settings->live && side > 8, rays, (const float(*)[4])hits,
                 w->maps + (size_t)item * (side + 2) * (side + 2));
    free(hits);
    free(total);
    atomic_fetch_add(&w->rays, count);
}

/* Invalid probes (inside objects) get the mean of their valid neighbours, in repeated passes.
 * Returns their number. */
static uint64_t fill_invalid(work *w) {
    const masu_blob_probes *g = w->grid;
    uint32_t count = g->counts[0] * g->counts[1] * g->counts[2];
    size_t words = (size_t)w->sets * COEFFICIENTS;
    uint8_t *round = masu_bake_allocate(count);
    uint64_t invalid = 0;
    for (uint32_t i = 0; i < count; i++) {
        round[i] = w->valid[i];
        invalid += !w->valid[i];
        if (!w->valid[i]) memset(w->sums + i * words, 0, words * sizeof(float));
    }
    for (uint64_t filled = 0, last = 1; filled < invalid && last; filled += last) {
        last = 0;
        for (uint32_t i = 0; i < count; i++) {
            if (round[i]) continue;
            const int64_t at[3] = {i % g->counts[0], i / g->counts[0] % g->counts[1],
                                   i / g->counts[0] / g->counts[1]};
            uint32_t sources = 0;
            for (int k = 0; k < 6; k++) {
                int64_t n[3] = {at[0], at[1], at[2]};
                n[k / 2] += k % 2 ? 1 : -1;
                if (n[k / 2] < 0 || n[k / 2] >= g->counts[k / 2]) continue;
                size_t from = (size_t)((n[2] * g->counts[1] + n[1]) * g->counts[0] + n[0]);
                if (round[from] != 1) continue;
                sources++;
                for (size_t j = 0; j < words; j++) {
                    w->sums[i * words + j] += w->sums[from * words + j];
                }
            }
            if (!sources) continue;
            for (size_t j = 0; j < words; j++) w->sums[i * words + j] /= (float)sources;
            round[i] = 2;
            last++;
        }
        for (uint32_t i = 0; i < count; i++) round[i] = round[i] ? 1 : 0;
    }
    free(round);
    return invalid;
}

static void write_sets(work *w, masu_blob_probes *p, masu_bake_buffer *out) {
    uint32_t count = p->counts[0] * p->counts[1] * p->counts[2], glow = p->sky_sets;
    for (size_t i = 0; i < (size_t)count * w->sets * COEFFICIENTS; i++) {
        /* For live probes, the rays of each frame hit the emissive surfaces. */
        if (i / COEFFICIENTS % w->sets == glow && w->sums[i] != 0 && !p->live) p->emissive = 1;
    }
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t s = 0; s < w->sets; s++) {
            if (s == glow && !p->emissive) continue;
            const float *from = w->sums + ((size_t)i * w->sets + s) * COEFFICIENTS;
            uint32_t words[MASU_PROBE_WORDS];
            for (uint32_t k = 0; k < MASU_PROBE_WORDS; k++) {
                float last = w->valid[i] ? 1.0f : 0.0f;
                words[k] =
                    masu_probe_pack(from[2 * k], 2 * k + 1 < COEFFICIENTS ? from[2 * k + 1] : last);
            }
            masu_bake_append(out, words, sizeof words);
        }
    }
}

bool masu_bake_make_probes(masu_bake_content *content, const masu_bake_probe_settings *s,
                           const masu_bake_trace *trace, masu_bake_probe_report *report) {
    masu_blob_probes p = {.sky_sets = is_lit(s) ? s->sky_bands * s->sky_bands : 0,
                          .emissive = !is_lit(s),
                          .visibility = s->visibility,
                          .live = s->live};
    double started = masu_bake_seconds();
    if (is_lit(s)) set_suns(content, s, &p);
    if (!place(content, s, &p)) return false;
    uint32_t count = p.counts[0] * p.counts[1] * p.counts[2];
    size_t map = s->visibility ? (size_t)(s->visibility + 2) * (s->visibility + 2) : 0;
    uint64_t bytes =
        (uint64_t)count * ((p.sky_sets + 1 + p.suns) * MASU_PROBE_WORDS + map) * sizeof(uint32_t);
    if (bytes > MASU_PROBE_BYTES_MAX) {
        masu_cli_error("probes: %u of %u sets take %llu bytes, at most %llu", count,
                       p.sky_sets + 1 + p.suns, (unsigned long long)bytes,
                       (unsigned long long)MASU_PROBE_BYTES_MAX);
        return false;
    }
    work w = {.trace = trace, .settings = s, .grid = &p, .sets = p.sky_sets + 1 + p.suns};
    w.lights = (masu_path_lights){.sky = basis_sky,
                                  .context = &p.sky_sets,
                                  .sky_sets = p.sky_sets,
                                  .suns = p.suns,
                                  .sun = (const float(*)[4])p.sun_direction,
                                  .bounces = s->bounces};
    w.sums = masu_bake_allocate((size_t)count * w.sets * COEFFICIENTS * sizeof(float));
    w.valid = masu_bake_allocate(count);
    w.maps = masu_bake_allocate((size_t)count * map * sizeof(uint32_t));
    masu_cli_progress("tracing %u light probes", count);
    masu_path_share(count, s->threads, trace_probe, &w);
    report->invalid = fill_invalid(&w);
    if (report->invalid == count) masu_cli_warn("probes: all %u are inside surfaces", count);
    masu_bake_buffer *out = &content->section[MASU_BLOB_PROBE_DATA];
    write_sets(&w, &p, out);
    masu_bake_append(out, w.maps, (size_t)count * map * sizeof(uint32_t));
    masu_bake_append(&content->section[MASU_BLOB_PROBES], &p, sizeof p);
    free(w.sums);
    free(w.valid);
    free(w.maps);
    report->probes = count;
    report->rays = atomic_load(&w.rays);
    report->bytes = out->bytes;
    report->triangles = masu_bake_trace_triangles(trace);
    report->seconds = masu_bake_seconds() - started;
    return true;
}
