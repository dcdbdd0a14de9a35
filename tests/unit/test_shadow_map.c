/* test_shadow_map.c: the sun's shadow map without a GPU: the cascades contain their part of the
 * view, keep their size and move by whole texels; when they are rendered again; their images and
 * passes in the plan. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/bind.h"
#include "plan/compile.h"
#include "support/desc.h"
#include "support/random.h"
#include "support/dry_renderer.h"
#include "reference/vec.h"

static void random_direction(uint64_t *r, double out[3]) {
    double length = 0;
    while (!(length > 0.01 && length < 1)) {
        for (int i = 0; i < 3; i++) out[i] = random_between(r, -1, 1);
        length = dot3(out, out);
    }
    for (int i = 0; i < 3; i++) out[i] /= sqrt(length);
}

static masu_shadow_view random_view(uint64_t *r, double far) {
    masu_shadow_view v;
    memset(&v, 0, sizeof v);
    random_direction(r, v.forward);
    random_direction(r, v.sun);
    v.tan2 = pow(random_between(r, 0.05, 3), 2);
    v.near_distance = random_between(r, 0.01, 1);
    for (int i = 0; i < 3; i++) {
        v.eye[i] = random_between(r, -far, far);
        v.casters[0][i] = v.eye[i] - random_between(r, 0, 500);
        v.casters[1][i] = v.eye[i] + random_between(r, 0, 500);
    }
    return v;
}

/* ---- Cascades -------------------------------------------------------------------------------- */

static void axes_are_orthonormal_for_any_sun(void **state) {
    (void)state;
    static const double suns[][3] = {{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, -1}, {1e-9, -1, 0}};
    uint64_t r = 1;
    for (int i = 0; i < 1000; i++) {
        double sun[3], axis[3][3];
        random_direction(&r, sun);
        if (i < 5) memcpy(sun, suns[i], sizeof sun);
        masu_shadow_axes(sun, axis);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) assert_true(fabs(dot3(axis[a], axis[b]) - (a == b)) < 1e-8);
        assert_memory_equal(axis[2], sun, sizeof sun);
    }
}

static void splits_rise_and_end_at_the_distance(void **state) {
    (void)state;
    uint64_t r = 2;
    for (int i = 0; i < 1000; i++) {
        double near_distance = random_between(&r, 1e-6, 10),
               distance = random_between(&r, 1e-3, 1000);
        double lambda = random_between(&r, 0, 1), last = 0;
        uint32_t n = (uint32_t)support_random_in(&r, 1, 4);
        for (uint32_t k = 0; k < n; k++) {
            double split = masu_shadow_split(near_distance, distance, lambda, k, n);
            assert_true(split > last || (split >= last && near_distance >= distance));
            last = split;
        }
        assert_true(last == distance);
    }
    for (uint32_t k = 0; k < 4; k++) { /* lambda 0: even; 1: by a factor of 4 from 1/256 on */
        assert_true(fabs(masu_shadow_split(0.1, 80, 0, k, 4) - 20 * (k + 1)) < 1e-9);
        assert_true(fabs(masu_shadow_split(0.1, 256, 1, k, 4) - pow(4, k + 1)) < 1e-9);
    }
}

/* Of orthographic cameras: a narrow lens whose near plane is far away. */
static void far_near_planes_waste_no_texels(void **state) {
    (void)state;
    assert_true(masu_shadow_begin(1, 2) == 0);
    assert_true(masu_shadow_begin(1.001, 2) == 1.001);
    assert_true(masu_shadow_begin(3, 2) == 2);
    masu_shadow_view v = {
        .forward = {0, 0, -1}, .sun = {0, 1, 0}, .casters = {{-1, -1, -1}, {1, 1, 1}}};
    for (int tip = 0; tip < 2; tip++) { /* an image 4 m high, 10 m of it */
        v.tan2 = 2 * 0.0005 * 0.0005;
        v.begin = tip ? 0 : 3995;
        masu_cascade c = masu_cascade_fit(&v, 4005, 0, 1024);
        double radius = tip ? 2002.5 : hypot(5, sqrt(v.tan2) * 4000);
        assert_true(fabs(c.radius - radius) < 0.001 * radius);
    }
}

/* The corners of the view up to the depth, and the eye, or the corners where it begins. */
static void each_cascade_holds_the_view_up_to_its_depth(void **state) {
    (void)state;
    uint64_t r = 3;
    for (int i = 0; i < 2000; i++) {
        masu_shadow_view v = random_view(&r, i % 2 ? 10 : 1e7);
        double depth = random_between(&r, 0.5, 500), tangent = sqrt(v.tan2), right[3], up[3];
        uint32_t size = (uint32_t)support_random_in(&r, 16, 4096);
        if (i % 4 == 1) v.begin = depth * random_between(&r, 0.5, 1);
        masu_cascade c = masu_cascade_fit(&v, depth, i % 3 ? 0 : 0.1, size);
        double axis[3][3];
        masu_shadow_axes(v.forward, axis);
        memcpy(right, axis[0], sizeof right);
        memcpy(up, axis[1], sizeof up);
        for (int k = 0; k < 32; k++) {
            double a = k * 0.3927, p[3], at = k < 16 ? depth : v.begin;
            for (int j = 0; j < 3; j++) {
                p[j] = v.eye[j] - c.center[j];
                p[j] += at * (v.forward[j] + tangent * (right[j] * cos(a) + up[j] * sin(a)));
            }
            double most = 1 - 3.0 / size + 1e-7;
            assert_true(fabs(dot3(c.axis[0], p)) <= c.half * most);
            assert_true(fabs(dot3(c.axis[1], p)) <= c.half * most);
            assert_true(dot3(c.axis[2], p) >= -c.behind && dot3(c.axis[2], p) <= c.ahead);
        }
        /* Towards the sun it extends to the last caster. */
        for (int k = 0; k < 8; k++) {
            double p[3];
            for (int j = 0; j < 3; j++) p[j] = v.casters[k >> j & 1][j] - c.center[j];
            assert_true(dot3(c.axis[2], p) <= c.ahead * (1 + 1e-9));
        }
    }
}

static void size_depends_on_neither_place_nor_direction(void **state) {
    (void)state;
    uint64_t r = 4;
    masu_shadow_view first = random_view(&r, 100);
    masu_cascade one = masu_cascade_fit(&first, 50, 0, 1024);
    for (int i = 0; i < 1000; i++) {
        masu_shadow_view v = random_view(&r, 1e6);
        v.tan2 = first.tan2;
        masu_cascade c = masu_cascade_fit(&v, 50, 0, 1024);
        assert_true(c.half == one.half && c.behind == one.behind && c.radius == one.radius);
        double steps = log2(c.ahead / c.behind); /* the depth's scale: only by doubling */
        assert_true(steps == floor(steps) && steps >= 0);
    }
}

static void centres_lie_on_a_grid_of_texels(void **state) {
    (void)state;
    uint64_t r = 5;
    for (int i = 0; i < 200; i++) {
        masu_shadow_view v = random_view(&r, i % 2 ? 100 : 1e6);
        masu_cascade before = masu_cascade_fit(&v, 40, 0, 512);
        double texel = 2 * before.half / 512;
        uint32_t same = 0;
        for (int k = 0; k < 50; k++) {
            masu_shadow_view next = v;
            for (int j = 0; j < 3; j++) next.eye[j] += random_between(&r, -0.02, 0.02) * texel;
            masu_cascade c = masu_cascade_fit(&next, 40, 0, 512);
            double d[3];
            for (int j = 0; j < 3; j++) d[j] = c.center[j] - before.center[j];
            for (int a = 0; a < 2; a++) {
                double step = dot3(c.axis[a], d) / texel;
                assert_true(fabs(step - floor(step + 0.5)) < 1e-4 && fabs(step) < 1.5);
            }
            same += !memcmp(c.center, before.center, sizeof c.center);
        }
        assert_true(same >= 25); /* bit-identical, unless a step is in between */
    }
}

static void what_a_cascade_still_holds_is_told(void **state) {
    (void)state;
    uint64_t r = 6;
    masu_shadow_view v = random_view(&r, 10);
    masu_cascade drawn = masu_cascade_fit(&v, 30, 0.1, 256);
    for (int i = 0; i < 500; i++) {
        masu_shadow_view next = v;
        double by[3], far = random_between(&r, 0, 0.4) * drawn.radius;
        random_direction(&r, by);
        for (int j = 0; j < 3; j++) next.eye[j] += by[j] * far;
        masu_cascade wanted = masu_cascade_fit(&next, 30, 0.1, 256);
        int holds = masu_cascade_holds(&drawn, &wanted);
        if (far < 0.08 * drawn.radius) assert_true(holds);
        double across = hypot(dot3(drawn.axis[0], by), dot3(drawn.axis[1], by)) * far;
        if (across > 0.17 * drawn.radius) assert_false(holds);
    }
    /* Along the sun's direction: away from it up to the map's depth, and towards it. */
    const double away[] = {-0.4 * drawn.radius, -0.05 * drawn.radius, 0.05 * drawn.radius,
                           drawn.ahead};
    for (int i = 0; i < 4; i++) {
        masu_shadow_view next = v;
        for (int j = 0; j < 3; j++) next.eye[j] += drawn.axis[2][j] * away[i];
        masu_cascade wanted = masu_cascade_fit(&next, 30, 0.1, 256);
        assert_int_equal(masu_cascade_holds(&drawn, &wanted), i == 1 || i == 2);
    }
    masu_cascade other = masu_cascade_fit(&v, 30, 0.1, 128);
    assert_false(masu_cascade_holds(&drawn, &other));
    other = masu_cascade_fit(&v, 31, 0.1, 256);
    assert_false(masu_cascade_holds(&drawn, &other));
    other = masu_cascade_fit(&v, 30, 0.1, 256);
    assert_true(masu_cascade_holds(&drawn, &other));
    other.lod_error = 2; /* other LODs */
    assert_false(masu_cascade_holds(&drawn, &other));
    other.lod_error = 0;
    drawn.trimmed = 1; /* without the casters that shadowed nothing in its own frame */
    assert_false(masu_cascade_holds(&drawn, &other));
}

/* A point relative to the cascade's origin, as in rendering, and relative to the camera, as in the
 * look-up. */
static void drawn_and_looked_up_is_the_same_place(void **state) {
    (void)state;
    uint64_t r = 7;
    struct masu_shadow_uniforms u;
    for (int i = 0; i < 1000; i++) {
        masu_shadow_view v = random_view(&r, i % 2 ? 100 : 1e7);
        masu_cascade c = masu_cascade_fit(&v, 50, 0, 1024);
        int32_t place[2] = {1024, 0};
        memset(&u, 0, sizeof u);
        masu_cascade_write(&c, v.eye, (double[3]){0, 0, 0}, place, 2, &u);
        assert_true(u.rect[2][0] == 1024 && u.rect[2][1] == 0 && u.rect[2][2] == 1024);
        const float *rows[] = {u.row0[2], u.row1[2], u.row2[2]};
        for (int a = 0; a < 3; a++) {
            double drawn = a == 2 ? (double)u.rect[2][3] : 0, seen = (double)rows[a][3];
            for (int j = 0; j < 3; j++) {
                double p = v.eye[j] + random_between(&r, -20, 20);
                drawn += (double)rows[a][j] *
                         (p - (double)u.origin_hi[2][j] - (double)u.origin_lo[2][j]);
                seen += (double)rows[a][j] * (p - v.eye[j]);
            }
            assert_true(fabs(drawn - seen) < 2e-6);
        }
        assert_true(fabs((double)u.origin_hi[2][3] * 512 / c.half - 1) < 1e-6);
        assert_true(fabs((double)u.origin_lo[2][3] * (c.behind + c.ahead) - 1) < 1e-6);
    }
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static uint32_t draw_frame(const masu_camera *camera, uint32_t rung, uint32_t cut) {
    masu_frame_desc f = {.camera = camera, .rung = rung, .cut = cut};
    return write_good(&f, (uint32_t)(m.timeline.frame++ % 2));
}

static const masu_camera still = {.position = {0, 2, 5}, .forward = {0, 0, -1}, .fov_y = 1};

static void without_a_pace_every_cascade_is_drawn_in_every_frame(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    for (int i = 0; i < 10; i++) assert_int_equal(draw_frame(&still, (uint32_t)(i % 3), 0), 3);
}

static void each_cascade_keeps_its_pace(void **state) {
    (void)state;
    static const masu_rung rungs[] = {{.shadow_refresh = {1, 4}}, {.shadow_refresh = {2, 3}}};
    make_renderer_with(SUPPORT_ALL, 0, rungs, 2);
    assert_int_equal(draw_frame(&still, 0, 0), 3); /* the first frame renders all */
    uint32_t drawn[2] = {0, 0};
    for (int i = 0; i < 80; i++) {
        uint32_t now = draw_frame(&still, 0, 0);
        for (int k = 0; k < 2; k++) drawn[k] += now >> k & 1;
    }
    assert_int_equal(drawn[0], 80);
    assert_int_equal(drawn[1], 20);
    drawn[0] = drawn[1] = 0;
    for (int i = 0; i < 60; i++) {
        uint32_t now = draw_frame(&still, 1, 0);
        for (int k = 0; k < 2; k++) drawn[k] += now >> k & 1;
    }
    assert_in_range(drawn[0], 30, 31);
    assert_in_range(drawn[1], 20, 21);
}

static void a_cut_or_a_jump_draws_what_would_not_be_due(void **state) {
    (void)state;
    static const masu_rung rung = {.shadow_refresh = {64, 64}};
    make_renderer_with(SUPPORT_ALL, 0, &rung, 1);
    assert_int_equal(draw_frame(&still, 0, 0), 3);
    assert_int_equal(draw_frame(&still, 0, 0), 0);
    assert_int_equal(draw_frame(&still, 0, 1), 3); /* a cut */
    assert_int_equal(draw_frame(&still, 0, 0), 0);
    masu_camera moved = still;
    moved.position[0] = 0.3; /* small compared with 50 m */
    assert_int_equal(draw_frame(&moved, 0, 0), 0);
    moved.position[0] = 1000;
    assert_int_equal(draw_frame(&moved, 0, 0), 3);
    moved.fov_y = 0.5f; /* another size of the bounding sphere */
    assert_int_equal(draw_frame(&moved, 0, 0), 3);
    moved.forward[2] = 1; /* in the opposite direction */
    assert_int_equal(draw_frame(&moved, 0, 0), 3);
    assert_int_equal(draw_frame(&moved, 0, 0), 0);
}

/* A recording that renders all cascades of its rung discards the rest of the map. */
static void what_a_smaller_rung_discards_is_drawn_again(void **state) {
    (void)state;
    static const masu_rung rungs[] = {{.shadow_refresh = {64, 64}},
                                      {.shadow_cascades = 1, .shadow_refresh = {64}}};
    make_renderer_with(SUPPORT_ALL, 0, rungs, 2);
    assert_int_equal(draw_frame(&still, 0, 0), 3);
    assert_int_equal(draw_frame(&still, 0, 0), 0);
    assert_int_equal(draw_frame(&still, 1, 1), 1); /* its only one: all */
    assert_int_equal(draw_frame(&still, 0, 0), 3); /* the first has a different depth there */
}

/* A cascade that is not rendered keeps its position; data relative to the camera is updated. */
static void a_stale_cascade_stays_where_it_was_drawn(void **state) {
    (void)state;
    static const masu_rung rung = {.shadow_refresh = {1, 64}};
    struct masu_shadow_uniforms a, b;
    make_renderer_with(SUPPORT_ALL, 0, &rung, 1);
    draw_frame(&still, 0, 0);
    memcpy(&a, slot_bytes(MASU_BUFFER_SHADOW, 0), sizeof a);
    masu_camera moved = still;
    moved.position[0] = 1.5;
    assert_int_equal(draw_frame(&moved, 0, 0), 1);
    memcpy(&b, slot_bytes(MASU_BUFFER_SHADOW, 1), sizeof b);
    assert_memory_equal(a.origin_hi[1], b.origin_hi[1], sizeof a.origin_hi[1]);
    assert_memory_equal(a.origin_lo[1], b.origin_lo[1], sizeof a.origin_lo[1]);
    assert_memory_not_equal(a.origin_hi[0], b.origin_hi[0], sizeof a.origin_hi[0]);
    double off = (double)b.row0[1][0] * 1.5; /* the camera has moved within it */
    assert_true(fabs((double)b.row0[1][3] - (double)a.row0[1][3] - off) < 1e-6);
}

static void casters_that_move_away_stay_in_reach(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    double before[2][3];
    memcpy(before, m.bounds.swept, sizeof before);
    assert_true(before[0][0] <= -1 && before[1][0] >= 4); /* "plate" at 0 and at 3 */
    float rows[12] = {1, 0, 0, 1e6f, 0, 1, 0, 500, 0, 0, 1, 0};
    masu_instance i = masu_instance_find(&m, "plate");
    assert_int_equal(masu_instance_set_transform(&m, i, rows, NULL), MASU_OK);
    assert_true(m.bounds.swept[1][0] >= 1e6 && m.bounds.swept[1][1] >= 502);
    assert_true(m.bounds.swept[0][0] == before[0][0]);
    draw_frame(&still, 0, 0);
    for (uint32_t k = 0; k < 2; k++) {
        double p[3] = {1e6, 502, 0};
        for (int j = 0; j < 3; j++) p[j] -= m.shadow.cascades[k].center[j];
        assert_true(dot3(m.shadow.cascades[k].axis[2], p) <= m.shadow.cascades[k].ahead);
    }
    rows[3] = 3e38f; /* finite, as required */
    assert_int_equal(masu_instance_set_transform(&m, i, rows, NULL), MASU_OK);
    draw_frame(&still, 0, 0);
    assert_true(isfinite(m.shadow.cascades[0].ahead));
}

/* ---- Plan ------------------------------------------------------------------------------------ */

static masu_frame_plan plan;

static void compile_shadow(masu_desc *d, uint32_t cascades, uint32_t size) {
    masu_detail detail;
    support_scene.shadow_cascades = cascades;
    support_scene.shadow_resolution = size;
    support_scene.shadow_distance = 100;
    support_scene.shadow_lambda = 0.5f;
    if (masu_compile(d, 256, 64, &plan, &detail)) fail_msg("%s", detail.text);
}

static void a_scene_without_shadows_has_none_of_it(void **state) {
    (void)state;
    static const char *const why[] = {"the scene has no shadow map",
                                      "the scene has no instances"};
    for (int i = 0; i < 2; i++) {
        masu_desc d = scene_desc(i ? SDF : RASTER | SDF, 640, 480);
        d.readback = MASU_READBACK_ALL;
        compile_shadow(&d, 0, 0);
        for (uint32_t p = MASU_PASS_CASCADE_0; p <= MASU_PASS_CASCADE_3; p++) {
            assert_false(masu_has_pass(&plan.rungs[0].active, p));
            assert_string_equal(plan.why[p], why[i]);
        }
        assert_false(masu_has_pass(&plan.rungs[0].active, MASU_PASS_SHADOW));
        assert_string_equal(plan.why[MASU_PASS_SHADOW], why[i]);
        assert_true(masu_has_pass(&plan.rungs[0].active, MASU_PASS_LIGHT));
        assert_false(plan.images[MASU_IMAGE_SHADOW_MAP].used);
        assert_false(plan.images[MASU_IMAGE_OCCLUSION].used);
        assert_int_equal(plan.buffers[MASU_BUFFER_SHADOW].bytes, 0);
        assert_int_equal(plan.desc.readback & MASU_READBACK_SHADOW_MAP, 0);
        assert_int_equal(plan.recordings, 3 * 2);
    }
}

static void cascades_lie_side_by_side_in_one_image(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{100, 100}, {100, 200}, {100, 300}, {200, 200}};
    for (uint32_t n = 1; n <= 4; n++) {
        masu_desc d = scene_desc(RASTER, 640, 480);
        compile_shadow(&d, n, 100);
        const masu_image_plan *map = &plan.images[MASU_IMAGE_SHADOW_MAP];
        assert_int_equal(map->width, sizes[n - 1][0]);
        assert_int_equal(map->height, sizes[n - 1][1]);
        assert_int_equal(map->first, MASU_PASS_CASCADE_0);
        assert_int_equal(map->last, MASU_PASS_SHADOW);
        assert_false(map->persistent);
        for (uint32_t k = 0; k < n; k++) {
            VkOffset2D at = masu_cascade_place(&plan, k);
            assert_in_range(at.x, 0, map->width - 100);
            assert_in_range(at.y, 0, map->height - 100);
            for (uint32_t j = 0; j < k; j++) {
                VkOffset2D other = masu_cascade_place(&plan, j);
                assert_true(at.x != other.x || at.y != other.y);
            }
        }
        for (uint32_t k = 0; k < 4; k++)
            assert_int_equal(masu_has_pass(&plan.rungs[0].active, MASU_PASS_CASCADE_0 + k), k < n);
        assert_true(masu_has_pass(&plan.rungs[0].active, MASU_PASS_LIGHT_OCCLUDED));
        assert_string_equal(plan.why[MASU_PASS_LIGHT_OCCLUDED],
                            "a scene is lit, with the visibility from shadow");
        assert_true(plan.buffers[MASU_BUFFER_SHADOW].bytes >=
                    2 * sizeof(struct masu_shadow_uniforms));
    }
}

/* The map has the size of the largest rung's; a rung that requests more gets the scene's size. */
static void rungs_have_cascades_of_their_own(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 640, 480);
    d.rung_count = 3;
    d.rungs[0] = (masu_rung){.shadow_cascades = 2, .shadow_resolution = 64};
    d.rungs[1] = (masu_rung){.shadow_cascades = 4, .shadow_resolution = 8192};
    d.rungs[2] = (masu_rung){.shadow_cascades = 1};
    compile_shadow(&d, 3, 128);
    static const uint32_t expected[][2] = {{2, 64}, {3, 128}, {1, 128}};
    for (uint32_t r = 0; r < 3; r++) {
        assert_int_equal(plan.rungs[r].cascades, expected[r][0]);
        assert_int_equal(plan.rungs[r].cascade_size, expected[r][1]);
        for (uint32_t k = 0; k < 4; k++)
            assert_int_equal(masu_has_pass(&plan.rungs[r].active, MASU_PASS_CASCADE_0 + k),
                             k < expected[r][0]);
    }
    assert_int_equal(plan.images[MASU_IMAGE_SHADOW_MAP].width, 128);
    assert_int_equal(plan.images[MASU_IMAGE_SHADOW_MAP].height, 3 * 128);
    d.rung_count = 1; /* nothing is kept for cascades that no rung renders */
    compile_shadow(&d, 3, 128);
    assert_int_equal(plan.images[MASU_IMAGE_SHADOW_MAP].width, 64);
    assert_int_equal(plan.images[MASU_IMAGE_SHADOW_MAP].height, 2 * 64);
}

static void slow_cascades_make_the_map_outlive_the_frame(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 640, 480);
    d.rung_count = 2;
    d.rungs[1] = (masu_rung){.shadow_refresh = {1, 2, 1, 4}};
    compile_shadow(&d, 4, 128);
    assert_true(plan.images[MASU_IMAGE_SHADOW_MAP].persistent);
    for (uint32_t i = 1; i < MASU_IMAGE_COUNT; i++)
        assert_int_equal(plan.images[i].persistent, i == MASU_IMAGE_SHADOW_MAP);
    assert_int_equal(plan.rungs[0].variants, 1);
    assert_int_equal(plan.rungs[1].variants, 4);
    assert_int_equal(plan.rungs[0].first_recording, 0);
    assert_int_equal(plan.rungs[1].first_recording, 2); /* two targets */
    assert_int_equal(plan.recordings, 2 + 2 * 4);
    const masu_rung_plan *rp = &plan.rungs[1];
    for (uint32_t drawn = 0; drawn < 16; drawn++) {
        uint32_t variant = masu_recording_variant(rp, drawn);
        assert_in_range(variant, 0, 3);
        for (uint32_t k = 0; k < 4; k++) {
            int slow = k == 1 || k == 3;
            assert_int_equal(masu_variant_draws(rp, variant, k), !slow || (drawn >> k & 1));
        }
    }
    assert_int_equal(masu_recording_variant(rp, 15), 3); /* the last variant renders all */
    for (uint32_t k = 0; k < 4; k++) assert_true(masu_variant_draws(&plan.rungs[0], 0, k));
    d.rungs[1].shadow_cascades = 1; /* the slow cascades are not among them */
    compile_shadow(&d, 4, 128);
    assert_int_equal(plan.rungs[1].variants, 1);
    assert_false(masu_variant_draws(&plan.rungs[1], 0, 1));
    assert_false(plan.images[MASU_IMAGE_SHADOW_MAP].persistent);
}

static void the_map_is_read_back_as_large_as_it_is(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 8, 8);
    d.readback = MASU_READBACK_SHADOW_MAP | MASU_READBACK_OCCLUSION;
    compile_shadow(&d, 2, 32);
    assert_int_equal(plan.buffers[MASU_BUFFER_READBACK].stride, 8 * 8 * 4 + 32 * 64 * 4);
    assert_int_equal(plan.images[MASU_IMAGE_SHADOW_MAP].last, MASU_PASS_READBACK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axes_are_orthonormal_for_any_sun),
        cmocka_unit_test(splits_rise_and_end_at_the_distance),
        cmocka_unit_test(far_near_planes_waste_no_texels),
        cmocka_unit_test(each_cascade_holds_the_view_up_to_its_depth),
        cmocka_unit_test(size_depends_on_neither_place_nor_direction),
        cmocka_unit_test(centres_lie_on_a_grid_of_texels),
        cmocka_unit_test(what_a_cascade_still_holds_is_told),
        cmocka_unit_test(drawn_and_looked_up_is_the_same_place),
        cmocka_unit_test(without_a_pace_every_cascade_is_drawn_in_every_frame),
        cmocka_unit_test(each_cascade_keeps_its_pace),
        cmocka_unit_test(a_cut_or_a_jump_draws_what_would_not_be_due),
        cmocka_unit_test(what_a_smaller_rung_discards_is_drawn_again),
        cmocka_unit_test(a_stale_cascade_stays_where_it_was_drawn),
        cmocka_unit_test(casters_that_move_away_stay_in_reach),
        cmocka_unit_test(a_scene_without_shadows_has_none_of_it),
        cmocka_unit_test(cascades_lie_side_by_side_in_one_image),
        cmocka_unit_test(rungs_have_cascades_of_their_own),
        cmocka_unit_test(slow_cascades_make_the_map_outlive_the_frame),
        cmocka_unit_test(the_map_is_read_back_as_large_as_it_is),
    };
    return cmocka_run_group_tests_name("shadow_map", tests, support_make_edge, NULL);
}
