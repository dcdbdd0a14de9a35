/* stiff.c: see stiff.h. One case at a time, in static buffers for the largest image of a case. */
#include "support/files.h"
#include "support/stiff.h"

#include "measure/truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS = 192 * 192 };

static struct {
    stiff_picture picture;
    float depth[PIXELS];
    uint32_t normal[PIXELS], hdr[2 * PIXELS];
    uint8_t albedo[4 * PIXELS], shown[2][4 * PIXELS];
    masu_truth_sample truth[PIXELS];
    double depths[PIXELS], angles[PIXELS];
} own;

const char *stiff_path(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/stiff/%s", made_dir(), name);
    return path;
}

void stiff_head(void) {
    printf("| case | true hits %% | hit/miss %% | lost %% | depth p50 | depth p99 | depth max "
           "| normal p50 | normal p99 | "
           "evaluations/px | unconverged %% | undecided %% |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

/* ---- Drawing --------------------------------------------------------------------------------- */

static void copy_image(masu_session *s, uint32_t slot, masu_readback_bits which, size_t texel,
                       const stiff_case *c, void *out) {
    masu_readback_image image;
    assert_int_equal(masu_readback(s->m, slot, which, &image, NULL), MASU_OK);
    assert_int_equal(image.width, c->width);
    assert_int_equal(image.height, c->height);
    for (uint32_t y = 0; y < c->height; y++)
        memcpy((uint8_t *)out + y * c->width * texel,
               (const uint8_t *)image.pixels + y * image.row_bytes, c->width * texel);
}

static void assert_finite(const stiff_case *c) {
    const uint16_t *halves = (const uint16_t *)(const void *)own.hdr;
    for (uint32_t i = 0; i < c->width * c->height; i++) {
        if (!(own.depth[i] >= 0.0f && own.depth[i] <= 1.0f))
            fail_msg("%s: depth of pixel %u is %g", c->name, i, (double)own.depth[i]);
        for (uint32_t k = 0; k < 4; k++)
            if ((halves[4 * i + k] & 0x7C00) == 0x7C00)
                fail_msg("%s: radiance of pixel %u is not finite", c->name, i);
    }
}

static void draw_once(masu_session *s, const stiff_case *c, uint8_t *shown) {
    masu_frame_desc frame = {.camera = &c->camera,
                             .sdf_params = c->param_count ? c->params : NULL,
                             .sdf_param_count = c->param_count};
    masu_commands commands;
    draw(s, &frame, &commands, shown);
    assert_int_equal(masu_stats(s->m, commands.slot, &own.picture.stats, NULL), MASU_OK);
    copy_image(s, commands.slot, MASU_READBACK_DEPTH, 4, c, own.depth);
    copy_image(s, commands.slot, MASU_READBACK_NORMAL, 4, c, own.normal);
    copy_image(s, commands.slot, MASU_READBACK_ALBEDO, 4, c, own.albedo);
    copy_image(s, commands.slot, MASU_READBACK_HDR, 8, c, own.hdr);
    assert_finite(c);
    if (own.picture.stats.replaced)
        fail_msg("%s: %llu values were not finite", c->name,
                 (unsigned long long)own.picture.stats.replaced);
}

/* ---- Comparing ------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double part_of(double *sorted, uint32_t count, double part) {
    return count ? sorted[(size_t)(part * (count - 1) + 0.5)] : 0.0;
}

static double angle_between(const float a[3], const double b[3]) {
    double u[3] = {(double)a[0], (double)a[1], (double)a[2]}, sine[3];
    for (int i = 0; i < 3; i++)
        sine[i] = u[(i + 1) % 3] * b[(i + 2) % 3] - u[(i + 2) % 3] * b[(i + 1) % 3];
    double cosine = u[0] * b[0] + u[1] * b[1] + u[2] * b[2];
    return atan2(hypot(hypot(sine[0], sine[1]), sine[2]), cosine) * (180 / 3.14159265358979324);
}

static void compare(const stiff_case *c, const masu_view *view) {
    uint32_t stride = c->stride ? c->stride : 1, columns = masu_truth_columns(c->width, stride);
    uint32_t count = columns * masu_truth_columns(c->height, stride), wrong = 0, both = 0;
    uint32_t true_hits = 0, unsure = 0, lost = 0;
    for (uint32_t i = 0; i < count; i++) {
        const masu_truth_sample *truth = &own.truth[i];
        uint32_t x = i % columns * stride, y = i / columns * stride, at = y * c->width + x;
        if (truth->kind == MASU_TRUTH_UNSURE) {
            unsure++;
            continue;
        }
        bool hit = own.depth[at] > 0.0f, truly = truth->kind == MASU_TRUTH_HIT;
        true_hits += truly;
        wrong += hit != truly;
        lost += !hit && truly;
        if (!hit || !truly) continue;
        masu_view_ray ray = masu_view_ray_at(view, x, y);
        double t = view->near_distance * ray.z_scale / (double)own.depth[at];
        float n[3];
        masu_unpack_normal(own.normal[at], n);
        own.depths[both] = fabs(t - truth->t) / truth->t;
        own.angles[both++] = angle_between(n, truth->normal);
    }
    qsort(own.depths, both, sizeof *own.depths, by_size);
    qsort(own.angles, both, sizeof *own.angles, by_size);
    double decided = count > unsure ? count - unsure : 1;
    double pixels = (double)c->width * c->height;
    own.picture.true_hits = 100.0 * true_hits / decided;
    own.picture.unsure = 100.0 * unsure / count;
    own.picture.figures =
        (stiff_figures){.hitmiss = 100.0 * wrong / decided,
                        .lost = 100.0 * lost / decided,
                        .depth_p50 = part_of(own.depths, both, 0.5),
                        .depth_p99 = part_of(own.depths, both, 0.99),
                        .depth_max = part_of(own.depths, both, 1),
                        .normal_p50 = part_of(own.angles, both, 0.5),
                        .normal_p99 = part_of(own.angles, both, 0.99),
                        .evals = (double)own.picture.stats.sdf_evals / pixels,
                        .unconverged = 100.0 * (double)own.picture.stats.sdf_unconverged / pixels};
}

static void find_truth(const stiff_case *c, const masu_scene *scene, masu_view *view) {
    masu_truth truth;
    char name[128], error[ERROR_SIZE];
    snprintf(name, sizeof name, "%s.truth.so", c->scene);
    assert_ok(masu_truth_open(stiff_path(name), &truth, error, sizeof error));
    assert_ok(masu_view_of(scene, &c->camera, 0.0, c->width, c->height, view, error, sizeof error));
    for (uint32_t i = 0; i < c->param_count; i++) view->params[i] = (double)c->params[i];
    masu_truth_image(&truth, view, c->stride ? c->stride : 1, own.truth);
    masu_truth_close(&truth);
}

/* ---- A case ---------------------------------------------------------------------------------- */

static void open_scene(masu_session *s, const stiff_case *c) {
    char name[128];
    assert_true((size_t)c->width * c->height <= PIXELS);
    snprintf(name, sizeof name, "%s.masu", c->scene);
    masu_session_desc d = test_desc(NULL, c->width, c->height);
    d.scene_path = stiff_path(name);
    d.desc.readback = MASU_READBACK_ALL;
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = 1.0f;
    d.desc.rungs[0].march_steps = c->steps;
    d.no_renderer = true; /* the reference reads the blob too: it is freed with the renderer */
    open_session(s, &d);
}

static void start(masu_session *s) {
    char error[ERROR_SIZE];
    assert_ok(masu_session_start(s, error, sizeof error));
}

void stiff_open(masu_session *s, const stiff_case *c) {
    open_scene(s, c);
    start(s);
}

const uint8_t *stiff_frame(masu_session *s, const stiff_case *c) {
    draw_once(s, c, own.shown[0]);
    return own.shown[0];
}

const stiff_picture *stiff_draw(const stiff_case *c) {
    masu_session s;
    masu_view view;
    size_t pixels = (size_t)c->width * c->height;
    open_scene(&s, c);
    find_truth(c, &s.scene, &view);
    start(&s);
    own.picture.gpu = on_gpu(&s);
    for (int i = 0; i < 2; i++) draw_once(&s, c, own.shown[i]);
    if (memcmp(own.shown[0], own.shown[1], 4 * pixels))
        fail_msg("%s: the same frame twice gives different images", c->name);
    close_session(&s);
    compare(c, &view);
    const stiff_figures *f = &own.picture.figures;
    printf("| %s | %.1f | %.3f | %.3f | %.1e | %.1e | %.1e | %.3f | %.2f | %.1f | %.3f | %.2f |\n",
           c->name, own.picture.true_hits, f->hitmiss, f->lost, f->depth_p50, f->depth_p99,
           f->depth_max, f->normal_p50, f->normal_p99, f->evals, f->unconverged,
           own.picture.unsure);
    fflush(stdout);
    own.picture.depth = own.depth;
    own.picture.albedo = own.albedo;
    return &own.picture;
}

static void claim(const stiff_case *c, const char *what, double is, double most) {
    if (most < 0) return; /* no limit */
    if (!(is <= most)) fail_msg("%s: %s is %g, at most %g: %s", c->name, what, is, most, c->why);
}

const stiff_picture *stiff_run(const stiff_case *c) {
    const stiff_picture *p = stiff_draw(c);
    const stiff_figures *f = &p->figures, *most = &c->most;
    if (!(p->true_hits >= c->least_hits))
        fail_msg("%s: the reference hits in %.2f %% of the pixels only", c->name, p->true_hits);
    claim(c, "hit/miss %", f->hitmiss, most->hitmiss);
    claim(c, "lost %", f->lost, most->lost);
    double slack = p->gpu ? 1e-5 : 0; /* GPU quotients and roots have errors of 2 to 3 ulp, which
                                         the horizon of a plain amplifies */
    claim(c, "depth p50", f->depth_p50, most->depth_p50 + slack);
    claim(c, "depth p99", f->depth_p99, most->depth_p99 + slack);
    claim(c, "depth max", f->depth_max, most->depth_max + slack);
    claim(c, "normal p50", f->normal_p50, most->normal_p50);
    claim(c, "normal p99", f->normal_p99, most->normal_p99);
    claim(c, "evaluations/px", f->evals, most->evals);
    claim(c, "unconverged %", f->unconverged, most->unconverged);
    claim(c, "undecided %", p->unsure, 1.0);
    return p;
}
