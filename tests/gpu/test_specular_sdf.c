/* test_specular_sdf.c: reflection rays and the SDF: each ray's hit against the scene's field in
 * double precision, from surfaces that the reference has found too; rays that begin in a solid or
 * hold any bits, and slots of any bits; moving parts; and images: SDF and polygons in each other's
 * reflections. */
#include "support/floats.h"
#include "support/files.h"
#include "support/random.h"
#include "support/reflect.h"
#include "support/stiff.h"

#include "measure/truth.h"
#include "scene/scene.h"
#include "reference/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 88, H = 72, TEXELS = W * H, SLOTS = 1 << 17 };

static struct {
    uint32_t guide[2 * TEXELS], ray[2 * TEXELS], before[4 * TEXELS], hit[4 * TEXELS];
    float slots[SLOTS];
    double off[TEXELS], angle[TEXELS];
} own;

static uint64_t state;

/* ---- Packing as in the shaders --------------------------------------------------------------- */

static void oct_encode(const double n[3], double p[2]) {
    double sum = fabs(n[0]) + fabs(n[1]) + fabs(n[2]), x = n[0] / sum, y = n[1] / sum;
    p[0] = n[2] < 0 ? (1 - fabs(y)) * (x < 0 ? -1 : 1) : x;
    p[1] = n[2] < 0 ? (1 - fabs(x)) * (y < 0 ? -1 : 1) : y;
}

static uint32_t pack_normal(const double n[3]) {
    double p[2];
    oct_encode(n, p);
    return (uint32_t)(round(p[0] * 4095) + 4095) | (uint32_t)(round(p[1] * 4095) + 4095) << 13;
}

static uint32_t pack_direction(const double d[3]) {
    double p[2];
    oct_encode(d, p);
    return ((uint32_t)(int32_t)round(p[0] * 32767) & 0xFFFF) |
           (uint32_t)(int32_t)round(p[1] * 32767) << 16;
}

static void unpack_direction(uint32_t word, double d[3]) {
    double p[2] = {(int16_t)(word & 0xFFFF) / 32767.0, (int16_t)(word >> 16) / 32767.0};
    d[0] = p[0], d[1] = p[1], d[2] = 1 - fabs(p[0]) - fabs(p[1]);
    if (d[2] < 0) {
        d[0] = (1 - fabs(p[1])) * (p[0] < 0 ? -1 : 1);
        d[1] = (1 - fabs(p[0])) * (p[1] < 0 ? -1 : 1);
    }
    unit3(d);
}

/* ---- A scene and rays in it ------------------------------------------------------------------ */

typedef struct stage {
    masu_session session;
    masu_view view; /* for 2W x 2H pixels */
    masu_truth truth;
    masu_scene_view blob;
    reflect_job job;
} stage;

static stage open_stage(const char *name, const masu_camera *camera) {
    stage s;
    char file[128], error[ERROR_SIZE];
    memset(&s, 0, sizeof s);
    snprintf(file, sizeof file, "%s.masu", name);
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = stiff_path(file);
    d.no_renderer = true;
    open_session(&s.session, &d);
    snprintf(file, sizeof file, "%s.truth.so", name);
    assert_ok(masu_truth_open(stiff_path(file), &s.truth, error, sizeof error));
    assert_ok(
        masu_view_of(&s.session.scene, camera, 0.0, 2 * W, 2 * H, &s.view, error, sizeof error));
    s.blob = masu_scene_view_of(&s.session.scene);
    assert_non_null(s.blob.reflections);
    assert_true(2 * s.blob.slot_count <= SLOTS);
    struct masu_frame_uniforms *f = &s.job.frame;
    for (int i = 0; i < 3; i++) {
        f->right[i] = (float)s.view.right[i];
        f->up[i] = (float)s.view.up[i];
        f->forward[i] = (float)s.view.forward[i];
        f->sdf_eye_hi[i] = f->trace_eye[i] = (float)s.view.eye[i];
        f->sdf_eye_lo[i] = (float)(s.view.eye[i] - (double)f->sdf_eye_hi[i]);
        f->sdf_min[i] = (float)s.view.sdf_min[i];
        f->sdf_max[i] = (float)s.view.sdf_max[i];
    }
    f->up[3] = (float)s.view.tan_y;
    f->forward[3] = (float)s.view.near_distance;
    f->sdf_min[3] = 1 / s.blob.sdf->lipschitz;
    f->sdf_max[3] = (float)s.view.max_distance;
    f->trace_anchor[3] = s.blob.reflections->distance;
    memcpy(own.slots, s.blob.slots, s.blob.slot_count * sizeof(float));
    memcpy(own.slots + s.blob.slot_count, s.blob.slots, s.blob.slot_count * sizeof(float));
    s.job.spirv = s.blob.code[MASU_BLOB_TRACE_SDF_SPIRV].words;
    s.job.words = (size_t)s.blob.code[MASU_BLOB_TRACE_SDF_SPIRV].count;
    assert_non_null(s.job.spirv);
    s.job.slots = own.slots;
    s.job.slot_count = 2 * (size_t)s.blob.slot_count;
    s.job.width = W, s.job.height = H;
    s.job.guide = own.guide, s.job.ray = own.ray, s.job.hit = own.hit;
    s.job.steps = MASU_MARCH_STEPS_MAX;
    return s;
}

static void close_stage(stage *s) {
    masu_truth_close(&s->truth);
    close_session(&s->session);
}

static void pixel_of(uint32_t i, uint32_t *x, uint32_t *y) {
    uint32_t k = own.guide[2 * i + 1] & 3;
    *x = 2 * (i % W) + (k & 1);
    *y = 2 * (i / W) + (k >> 1);
}

/* The guide's texel, decoded as the shader does. */
typedef struct beginning {
    double point[3], normal[3], direction[3]; /* point: world */
    double z, pixel, lift;
} beginning;

static beginning beginning_of(const stage *s, uint32_t i) {
    beginning b;
    uint32_t x, y;
    float n[3];
    pixel_of(i, &x, &y);
    masu_view_ray ray = masu_view_ray_at(&s->view, x, y);
    b.z = s->view.near_distance / (double)float_of_bits(own.guide[2 * i + 1] & ~7u);
    b.pixel = 2 * s->view.tan_y / s->view.height;
    double most = b.z * ray.z_scale;
    masu_unpack_normal(own.guide[2 * i] & 0x3FFFFFF, n);
    for (int k = 0; k < 3; k++) {
        b.point[k] = s->view.eye[k] + ray.direction[k] * b.z * ray.z_scale;
        b.normal[k] = (double)n[k];
        most = fmax(most, fabs(b.point[k]));
    }
    b.lift = 0.125 * b.z * b.pixel + 9.6e-7 * most;
    unpack_direction(own.ray[2 * i], b.direction);
    return b;
}

/* A ray for each texel whose pixel shows a surface: reflected, and scattered by up to `rough`. One
 * of four has hit a polygon. inside: depth of the origin behind the surface, metres; every: one of
 * this number of texels has a ray. */
static void make_rays(const stage *s, double rough, double inside, uint32_t every) {
    state = 1;
    for (uint32_t i = 0; i < TEXELS; i++) {
        uint32_t x, y;
        uint32_t k = random_word(&state) & 3;
        own.guide[2 * i] = 0;
        own.guide[2 * i + 1] = k;
        own.ray[2 * i] = own.ray[2 * i + 1] = 0;
        bool met = random_word(&state) % 4 == 0;
        float at = (float)(6 * (double)random_float(&state));
        const uint32_t polygon[4] = {bits_of_float(met ? at : -1.0f), 7, 9, 11};
        memcpy(own.before + 4 * i, polygon, sizeof polygon);
        if (i % every) continue;
        pixel_of(i, &x, &y);
        masu_view_ray ray = masu_view_ray_at(&s->view, x, y);
        masu_truth_sample seen;
        masu_truth_march(&s->truth, &s->view, &ray, &seen);
        if (seen.kind != MASU_TRUTH_HIT) continue;
        float depth = (float)(s->view.near_distance * ray.z_scale / (seen.t + inside));
        own.guide[2 * i] = pack_normal(seen.normal) | (uint32_t)(63 * rough) << 26;
        own.guide[2 * i + 1] = (bits_of_float(depth) & ~7u) | k;
        double d[3], along = dot3(ray.direction, seen.normal), up = 0;
        for (int c = 0; c < 3; c++) {
            d[c] = ray.direction[c] - 2 * along * seen.normal[c] +
                   rough * (2 * (double)random_float(&state) - 1);
            up += d[c] * seen.normal[c];
        }
        for (int c = 0; c < 3 && up < 0; c++) d[c] -= 2 * up * seen.normal[c];
        unit3(d);
        own.ray[2 * i] = pack_direction(d);
    }
}

static void trace(stage *s) {
    memcpy(own.hit, own.before, sizeof own.hit);
    reflect_run(&s->job);
}

static bool sdf_wins(uint32_t i) { return own.hit[4 * i + 1] >> 31; }

/* ---- Comparison with the reference ----------------------------------------------------------- */

typedef struct figures {
    uint32_t rays, wrong, unsure, true_hits;
    double off_p50, off_p99, angle_p99; /* pixels wide; degrees */
    uint32_t other_parts;
} figures;

static void to_box(const masu_view *v, const double from[3], const double d[3], double *limit) {
    for (int i = 0; i < 3; i++) {
        double a = (v->sdf_min[i] - from[i]) / d[i], b = (v->sdf_max[i] - from[i]) / d[i];
        double out = fmax(a, b);
        if (out < *limit) *limit = out;
    }
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static figures compare(const stage *s) {
    figures f = {0};
    uint32_t both = 0;
    for (uint32_t i = 0; i < TEXELS; i++) {
        if (own.guide[2 * i + 1] <= 7) {
            assert_memory_equal(own.hit + 4 * i, own.before + 4 * i, 16);
            continue;
        }
        beginning b = beginning_of(s, i);
        float polygon = float_of_bits(own.before[4 * i]), t = float_of_bits(own.hit[4 * i]);
        masu_view from = s->view;
        masu_view_ray ray = {.z_scale = 1, .pixel = b.pixel, .limit = s->view.max_distance};
        for (int k = 0; k < 3; k++) {
            from.eye[k] = b.point[k] + b.normal[k] * b.lift;
            ray.direction[k] = b.direction[k];
        }
        if (polygon >= 0) ray.limit = fmin(ray.limit, (double)polygon);
        to_box(&s->view, from.eye, ray.direction, &ray.limit);
        masu_truth_sample truth;
        masu_truth_march(&s->truth, &from, &ray, &truth);
        f.rays++;
        if (truth.kind == MASU_TRUTH_UNSURE) {
            f.unsure++;
            continue;
        }
        bool hit = sdf_wins(i), truly = truth.kind == MASU_TRUTH_HIT;
        if (!hit) assert_memory_equal(own.hit + 4 * i, own.before + 4 * i, 16);
        if (hit && polygon >= 0) assert_true(t <= polygon);
        f.true_hits += truly;
        f.wrong += hit != truly;
        if (!hit || !truly) continue;
        float n[3];
        double m[8], sine = 0, cosine = 0;
        masu_unpack_normal(own.hit[4 * i + 2], n);
        double u[3] = {(double)n[0], (double)n[1], (double)n[2]};
        cosine = dot3(u, truth.normal);
        sine = sqrt(fmax(0, 1 - cosine * cosine));
        own.off[both] = fabs((double)t - truth.t) / (b.pixel * (b.z + truth.t));
        own.angle[both++] = atan2(sine, cosine) * 57.29577951308232;
        s->truth.material(truth.part, m);
        bool shines = m[4] + m[5] + m[6] > 0;
        for (int k = 0; k < 3; k++) {
            double color = sqrt(shines ? m[4 + k] / 16 : m[k]) * 255;
            if (fabs(color - (double)(own.hit[4 * i + 3] >> 8 * k & 255)) > 1.01) {
                f.other_parts++;
                break;
            }
        }
    }
    assert_true(both > 0);
    qsort(own.off, both, sizeof *own.off, by_size);
    qsort(own.angle, both, sizeof *own.angle, by_size);
    f.off_p50 = own.off[both / 2];
    f.off_p99 = own.off[(size_t)(0.99 * (both - 1))];
    f.angle_p99 = own.angle[(size_t)(0.99 * (both - 1))];
    return f;
}

/* Compares with the reference and prints a row; asserts the limits for every scene. */
static figures judge(stage *s, const char *name, double rough, uint32_t every) {
    make_rays(s, rough, 0, every);
    trace(s);
    figures f = compare(s);
    double rays = f.rays;
    printf("| %s | %.2f | %u | %.1f | %.3f | %.4f | %.3f | %.2f | %u | %.1f | %.3f | %.2f |\n",
           name, rough, f.rays, 100 * f.true_hits / rays, 100 * f.wrong / rays, f.off_p50,
           f.off_p99, f.angle_p99, f.other_parts, (double)s->job.evals / rays,
           100 * (double)s->job.unconverged / rays, 100 * f.unsure / rays);
    fflush(stdout);
    assert_true(f.rays > TEXELS / every / 3);
    assert_true(f.true_hits > f.rays / 10);
    assert_true(f.unsure * 100 <= f.rays);
    if (!(f.wrong * 200 <= f.rays)) fail_msg("%s: %u of %u rays are wrong", name, f.wrong, f.rays);
    return f;
}

static const masu_camera around = {.position = {0.4, 2.6, 4.6},
                                   .forward = {-0.1f, -0.5f, -1},
                                   .fov_y = 0.8f,
                                   .near_distance = 0.05f};

static void hits_are_those_of_the_truth(void **unused) {
    (void)unused;
    static const char *const scenes[] = {"mirrors", "pebbles"};
    static const double rough[] = {0, 0.3};
    printf("| scene | scatter | rays | true hits %% | hit/miss %% | distance p50, pixels | p99 | "
           "normal p99 | other "
           "parts | evaluations | unconverged %% | undecided %% "
           "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < 2; i++) {
        stage s = open_stage(scenes[i], &around);
        for (int k = 0; k < 2; k++) {
            figures f = judge(&s, scenes[i], rough[k], trials(1, 2, 2));
            assert_true(f.off_p50 <= 0.01);
            assert_true(f.off_p99 <= 0.5);
            assert_true(f.angle_p99 <= 5);
            assert_true(f.other_parts * 200 <= f.rays);
        }
        close_stage(&s);
    }
}

/* Rays along the rows of 4096 balls, and back from a wall past 90 rods whose bounding spheres each
 * ray hits: more than a list holds. */
static void rays_past_many_parts_meet_the_first(void **unused) {
    (void)unused;
    const masu_camera low = {.position = {0, 3, 38}, .forward = {0, -0.1f, -1}, .fov_y = 0.3f,
                             .near_distance = 0.05f};
    stage s = open_stage("many", &low);
    figures f = judge(&s, "many", 0, 5);
    assert_true(f.off_p99 <= 0.5);
    close_stage(&s);
    const masu_camera at_wall = {.position = {0, 1, 8}, .forward = {0, 0, 1}, .fov_y = 0.5f,
                                 .near_distance = 0.05f};
    s = open_stage("row", &at_wall);
    f = judge(&s, "row", 0, 1);
    assert_true(f.off_p99 <= 0.5);
    close_stage(&s);
}

static void who_begins_in_a_solid_has_met_it(void **unused) {
    (void)unused;
    stage s = open_stage("mirrors", &around);
    make_rays(&s, 0, 0.05, 1); /* at least two widths of a pixel, and less than the thickness of any
                                  part except the rod */
    trace(&s);
    uint32_t inside = 0, met = 0, at_once = 0;
    for (uint32_t i = 0; i < TEXELS; i++) {
        if (own.guide[2 * i + 1] <= 7 || float_of_bits(own.before[4 * i]) >= 0) continue;
        beginning b = beginning_of(&s, i);
        for (int k = 0; k < 3; k++) b.point[k] += b.normal[k] * b.lift;
        if (!(s.truth.step(s.view.params, 0, b.point) < -b.z * b.pixel)) continue;
        inside++;
        met += sdf_wins(i);
        at_once += sdf_wins(i) && (double)float_of_bits(own.hit[4 * i]) < 0.7 * b.z * b.pixel;
    }
    printf("  %u rays begin inside, %u hit, %u there\n", inside, met, at_once);
    assert_true(inside > TEXELS / 20);
    assert_int_equal(met, inside);
    assert_int_equal(at_once, inside);
    close_stage(&s);
}

/* Running out of steps without coming near a surface is a miss, and never a hit of the ray's own
 * surface. */
static void rays_without_steps_miss(void **unused) {
    (void)unused;
    stage s = open_stage("mirrors", &around);
    make_rays(&s, 0, 0, 1);
    s.job.steps = 3;
    trace(&s);
    figures f = compare(&s);
    uint32_t at_once = 0, hits = 0;
    for (uint32_t i = 0; i < TEXELS; i++) {
        if (!sdf_wins(i)) continue;
        beginning b = beginning_of(&s, i);
        hits++;
        at_once += (double)float_of_bits(own.hit[4 * i]) < 4 * b.z * b.pixel;
    }
    printf("  3 steps: %.1f %% wrong, %.1f %% unconverged, %u of %u hits near the start\n",
           100.0 * f.wrong / f.rays, 100.0 * (double)s.job.unconverged / f.rays, at_once, hits);
    assert_true(s.job.unconverged * 10 > f.rays);
    assert_true(f.wrong * 20 > f.rays);
    assert_true(at_once * 50 <= f.rays);
    close_stage(&s);
}

/* ---- Motion ---------------------------------------------------------------------------------- */

static void unpack_motion(uint32_t word, double v[3]) {
    for (int k = 0; k < 3; k++)
        v[k] = (int8_t)(word >> 8 * k & 255) * ldexp(1, (int)(word >> 24 & 127) - 63 - 7);
}

static void a_part_that_moves_says_by_how_much(void **unused) {
    (void)unused;
    stage s = open_stage("mirrors", &around);
    make_rays(&s, 0, 0, 1);
    /* The ball that `shift` moves is the only one whose arguments have its default. */
    uint32_t found = 0, n = (uint32_t)s.blob.slot_count;
    for (uint32_t i = 8 * s.blob.sdf->part_count; i < n; i++) {
        if (fabsf(fabsf(own.slots[i]) - 0.7129f) > 1e-6f) continue;
        own.slots[n + i] += own.slots[i] > 0 ? -0.25f : 0.25f;
        found++;
    }
    assert_int_equal(found, 1);
    trace(&s);
    uint32_t still = 0, moving = 0;
    for (uint32_t i = 0; i < TEXELS; i++) {
        double v[3];
        if (!sdf_wins(i)) continue;
        unpack_motion(own.hit[4 * i + 1], v);
        bool shines = own.hit[4 * i + 2] >> 30 & MASU_SURFACE_EMISSIVE;
        moving += shines;
        still += !shines;
        if (fabs(v[0] - (shines ? -0.25 : 0)) > 0.003 || fabs(v[1]) > 0.002 || fabs(v[2]) > 0.002)
            fail_msg("texel %u: %g %g %g", i, v[0], v[1], v[2]);
    }
    printf("  %u hits move, %u do not\n", moving, still);
    assert_true(moving > 20 && still > 200);
    close_stage(&s);
}

/* ---- Arbitrary bits -------------------------------------------------------------------------- */

static void check_sane(const stage *s, const char *what) {
    for (uint32_t i = 0; i < TEXELS; i++) {
        if (!memcmp(own.hit + 4 * i, own.before + 4 * i, 16)) continue;
        float t = float_of_bits(own.hit[4 * i]), n[3], before = float_of_bits(own.before[4 * i]);
        if (!isfinite(t) || !(t >= 0) || !sdf_wins(i))
            fail_msg("%s: texel %u: %g", what, i, (double)t);
        if (before >= 0 && !(t <= before)) fail_msg("%s: texel %u: behind the polygon", what, i);
        masu_unpack_normal(own.hit[4 * i + 2], n);
        assert_true(isfinite(n[0]) && isfinite(n[1]) && isfinite(n[2]));
        assert_true(t <= s->job.frame.trace_anchor[3]);
    }
}

static void any_bits_give_finite_hits(void **unused) {
    (void)unused;
    static const char *const scenes[] = {"mirrors", "pebbles"};
    static const float senseless[] = {NAN,      INFINITY, -INFINITY, 3.4e38f,
                                      -3.4e38f, 1e-42f,   0,         1e10f};
    for (uint32_t i = 0; i < trials(2, 2, 1); i++) {
        stage s = open_stage(scenes[i], &around);
        state = 5;
        for (uint32_t k = 0; k < 2 * TEXELS; k++)
            own.guide[k] = random_word(&state), own.ray[k] = random_word(&state);
        for (uint32_t k = 0; k < 4 * TEXELS; k++) own.before[k] = random_word(&state);
        trace(&s);
        check_sane(&s, "bits");
        make_rays(&s, 0.3, 0, 1);
        /* masu-bake makes the numbers of parts and shapes */
        uint32_t from = 8 * s.blob.sdf->part_count;
        for (uint32_t k = from; k < s.job.slot_count; k++)
            if (random_word(&state) % 3 == 0) own.slots[k] = senseless[random_word(&state) % 8];
        trace(&s);
        check_sane(&s, "slots");
        /* Unbounded parts fill the list of every piece of a ray: of many parts, a sixth of the
         * workgroups. */
        for (uint32_t k = 0; k < TEXELS && s.blob.sdf->part_count > 100 && !long_run(); k++)
            if ((k / W / 8 + k % W / 8) % 6) own.guide[2 * k + 1] &= 3;
        for (uint32_t k = 0; k < from; k++)
            if (k % 8 < 5) own.slots[k] = senseless[random_word(&state) % 8];
        trace(&s);
        uint32_t rays = 0;
        for (uint32_t k = 0; k < TEXELS; k++) rays += own.guide[2 * k + 1] > 7;
        printf("  %s: %u rays past senseless bounds\n", scenes[i], rays);
        check_sane(&s, "bounds");
        close_stage(&s);
    }
}

/* ---- Images ---------------------------------------------------------------------------------- */

enum { WIDE = 2 * W, HIGH = 2 * H, PIXELS = WIDE * HIGH };

static uint8_t shown[2][4 * PIXELS];

static void picture_of(const char *path, const masu_camera *camera, uint8_t *to, uint16_t *hdr,
                       masu_stats_info *stats) {
    masu_session s;
    masu_session_desc d = test_desc(NULL, WIDE, HIGH);
    masu_frame_desc frame = {.camera = camera};
    masu_commands commands;
    d.scene_path = path;
    d.desc.readback = hdr ? MASU_READBACK_HDR : 0;
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = 1;
    open_session(&s, &d);
    draw(&s, &frame, &commands, to);
    assert_int_equal(masu_stats(s.m, commands.slot, stats, NULL), MASU_OK);
    if (hdr) {
        masu_readback_image image;
        assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_HDR, &image, NULL),
                         MASU_OK);
        for (uint32_t y = 0; y < HIGH; y++)
            memcpy(hdr + 4 * WIDE * y, (const uint8_t *)image.pixels + y * image.row_bytes,
                   8 * WIDE);
    }
    close_session(&s);
    assert_int_equal(stats->replaced, 0);
}

static void a_million_units_away_it_is_the_same(void **unused) {
    (void)unused;
    masu_stats_info stats[2];
    masu_camera far = around;
    far.position[0] += 1e6, far.position[2] -= 1e6;
    picture_of(stiff_path("mirrors.masu"), &around, shown[0], NULL, &stats[0]);
    picture_of(stiff_path("mirrors_far.masu"), &far, shown[1], NULL, &stats[1]);
    assert_true(stats[0].specular_rays > PIXELS / 8);
    assert_true(stats[0].specular_sdf_hits > stats[0].specular_rays / 10);
    assert_int_equal(stats[0].specular_hits, 0);
    uint32_t other = 0;
    for (uint32_t i = 0; i < PIXELS; i++)
        other += max_difference(&shown[0][4 * i], &shown[1][4 * i], 3) > 8;
    printf("  %u of %d pixels differ by more than 8; %llu and %llu hits of %llu rays\n", other,
           PIXELS, (unsigned long long)stats[0].specular_sdf_hits,
           (unsigned long long)stats[1].specular_sdf_hits,
           (unsigned long long)stats[0].specular_rays);
    assert_true(other * 100 <= PIXELS);
}

/* tests/scenes/test_reflections.json: a mirror floor, left of x = 0 a polygon, otherwise the SDF;
 * above it emissive balls, red ones of the SDF, green ones of polygons. In front of the camera
 * there is only the floor. */
typedef struct ball {
    double center[3], radius;
    int color; /* 0 red: SDF; 1 green: polygons */
} ball;

static const ball balls[] = {{{-3, 1, -1}, 0.5, 0},    {{-1.5, 1, -1}, 0.5, 1},
                             {{1.5, 1, -1}, 0.5, 0},   {{3, 1, -1}, 0.5, 1},
                             {{0.4, 1, -1}, 0.4, 0},   {{0.4, 1.6, -2.2}, 1.2, 1},
                             {{-0.4, 1, -1}, 0.35, 1}, {{-0.4, 1.6, -2.2}, 1.1, 0}};

/* 0, 1: the colour of the nearest ball on a ray; 2: none; -1: near an edge. */
static int ball_on(const double from[3], const double d[3]) {
    double nearest = 1e9;
    int color = 2;
    for (size_t i = 0; i < sizeof balls / sizeof *balls; i++) {
        double to[3] = {balls[i].center[0] - from[0], balls[i].center[1] - from[1],
                        balls[i].center[2] - from[2]};
        double along = dot3(to, d), off = sqrt(fmax(0, dot3(to, to) - along * along));
        if (fabs(off - balls[i].radius) < 0.17) return -1;
        if (off < balls[i].radius) {
            double at = along - sqrt(balls[i].radius * balls[i].radius - off * off);
            if (at < nearest) nearest = at, color = balls[i].color;
        }
    }
    return color;
}

static void polygons_and_sdf_mirror_each_other_and_the_nearest_wins(void **unused) {
    (void)unused;
    static uint16_t hdr[4 * PIXELS];
    static const double eye[3] = {0, 3, 5};
    const masu_camera camera = {.position = {0, 3, 5},
                                .forward = {0, -0.75f, -0.75f},
                                .fov_y = 0.9f,
                                .near_distance = 0.05f};
    masu_stats_info stats;
    picture_of(scene_path("test_reflections"), &camera, shown[0], hdr, &stats);
    uint32_t count[2][3] = {{0}}, wrong[2][3] = {{0}};
    double tan_y = tan(0.45);
    for (uint32_t i = 0; i < PIXELS; i++) {
        double x = ((i % WIDE + 0.5) / WIDE * 2 - 1) * tan_y * WIDE / HIGH;
        double y = 1 - (i / WIDE + 0.5) / HIGH * 2;
        double c = sqrt(0.5), d[3] = {x, -c + y * tan_y * c, -c - y * tan_y * c};
        unit3(d);
        if (d[1] > -0.05 || ball_on(eye, d) != 2) continue;
        double t = -eye[1] / d[1], at[3] = {eye[0] + d[0] * t, 0, eye[2] + d[2] * t};
        double up[3] = {d[0], -d[1], d[2]};
        int color = ball_on(at, up);
        if (color < 0 || fabs(at[0]) < 0.25) continue;
        double r = half_float(hdr[4 * i]), g = half_float(hdr[4 * i + 1]);
        int is = fmax(r, g) < 0.05 ? 2 : g > r;
        count[at[0] > 0][color]++;
        wrong[at[0] > 0][color] += is != color;
    }
    for (int side = 0; side < 2; side++)
        for (int color = 0; color < 3; color++) {
            printf("  %s, %s: %u of %u pixels are not\n", side ? "SDF" : "polygon",
                   color == 2 ? "nothing" : color ? "polygons" : "SDF", wrong[side][color],
                   count[side][color]);
            assert_true(count[side][color] > 50);
            assert_true(wrong[side][color] * 50 <= count[side][color]);
        }
    assert_true(stats.specular_hits > 100 && stats.specular_sdf_hits > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_are_those_of_the_truth),
        cmocka_unit_test(rays_past_many_parts_meet_the_first),
        cmocka_unit_test(who_begins_in_a_solid_has_met_it),
        cmocka_unit_test(rays_without_steps_miss),
        cmocka_unit_test(a_part_that_moves_says_by_how_much),
        cmocka_unit_test(any_bits_give_finite_hits),
        cmocka_unit_test(a_million_units_away_it_is_the_same),
        cmocka_unit_test(polygons_and_sdf_mirror_each_other_and_the_nearest_wins),
    };
    return cmocka_run_group_tests_name("specular_sdf", tests, NULL, NULL);
}
