/* test_extremes.c: extreme fields and views give a defined, finite image. */
#include "support/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { W = 96, H = 66 };

static void open_for_depth(masu_session *s, const char *scene, uint32_t steps) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.march_steps = steps};
    open_session(s, &d);
}

/* Renders, checks that everything is finite, returns the depth image. */
static const float *draw_finite(masu_session *s, const masu_frame_desc *frame,
                                masu_stats_info *stats) {
    masu_commands commands;
    masu_readback_image depth, hdr;
    draw(s, frame, &commands, NULL);
    assert_int_equal(masu_stats(s->m, commands.slot, stats, NULL), MASU_OK);
    assert_int_equal(stats->replaced, 0);
    assert_int_equal(masu_readback(s->m, commands.slot, MASU_READBACK_DEPTH, &depth, NULL),
                     MASU_OK);
    assert_int_equal(masu_readback(s->m, commands.slot, MASU_READBACK_HDR, &hdr, NULL), MASU_OK);
    for (uint32_t i = 0; i < W * H; i++) {
        float d = ((const float *)depth.pixels)[i];
        assert_true(d >= 0.0f && d <= 1.0f);
        for (uint32_t ch = 0; ch < 4; ch++) {
            assert_true((((const uint16_t *)hdr.pixels)[4 * i + ch] & 0x7C00) != 0x7C00);
        }
    }
    return depth.pixels;
}

static void a_field_of_nan_and_infinity_is_a_miss_and_breaks_nothing_beside_it(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    masu_frame_desc frame = {0};
    open_for_depth(&s, "test_broken_field", 0);
    const float *depth = draw_finite(&s, &frame, &stats);
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        if (depth[i] > 0) *(i % W < W / 2 ? &left : &right) += 1;
    }
    assert_int_equal(left, 0);
    assert_true(right > 100); /* the sphere of the valid quarter */
    close_session(&s);
}

static void a_camera_inside_a_solid_sees_it_at_the_near_plane(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    const masu_camera c = {.position = {0.1, 0.2, 0.1},
                           .forward = {0.3f, 0.1f, -1},
                           .fov_y = 1,
                           .near_distance = 0.1f};
    masu_frame_desc frame = {.camera = &c};
    open_for_depth(&s, "test_sphere_sdf", 0);
    const float *depth = draw_finite(&s, &frame, &stats);
    for (uint32_t i = 0; i < W * H; i++) assert_float_equal(depth[i], 1.0f, 1e-5f);
    assert_int_equal(stats.sdf_hits, W * H);
    close_session(&s);
}

static void a_camera_on_the_surface_looking_out_sees_the_sky(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    const masu_camera c = {
        .position = {0, 0, 1.0001}, .forward = {0, 0, 1}, .fov_y = 1, .near_distance = 0.01f};
    masu_frame_desc frame = {.camera = &c};
    open_for_depth(&s, "test_sphere_sdf", 0);
    draw_finite(&s, &frame, &stats);
    assert_int_equal(stats.sdf_hits, 0);
    close_session(&s);
}

static void rays_that_run_out_of_steps_are_counted_and_never_drawn_by_default(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats, full;
    masu_frame_desc frame = {0};
    open_for_depth(&s, "test_sphere_sdf", 0);
    draw_finite(&s, &frame, &full);
    close_session(&s);
    assert_int_equal(full.sdf_unconverged, 0);
    open_for_depth(&s, "test_sphere_sdf", 2);
    draw_finite(&s, &frame, &stats);
    close_session(&s);
    assert_true(stats.sdf_unconverged > 0);
    /* At most the pixels whose best sample came within 2 pixels: a rim of that width around the
     * disc. */
    double rim = 2.0 * 2.0 * sqrt(3.14159265 * (double)full.sdf_hits);
    assert_true((double)stats.sdf_hits <= (double)full.sdf_hits + 1.1 * rim);
    assert_true(stats.sdf_evals < full.sdf_evals);
}

static void views_beside_behind_and_far_from_the_bounds_draw_only_sky(void **state) {
    (void)state;
    static const masu_camera cameras[] = {
        {.position = {0, 0, 5}, .forward = {0, 0, 1}, .fov_y = 1, .near_distance = 0.1f},
        {.position = {0, 50, 5}, .forward = {0, 0, -1}, .fov_y = 0.5f, .near_distance = 0.1f},
        {.position = {1e7, 0, 0}, .forward = {-1, 0, 0}, .fov_y = 0.01f, .near_distance = 0.1f},
        {.position = {1e14, -1e14, 1e14},
         .forward = {-1, 1, -1},
         .fov_y = 3.1f,
         .near_distance = 1e9f},
    };
    masu_session s;
    masu_stats_info stats;
    open_for_depth(&s, "test_sphere_sdf", 0);
    for (size_t i = 0; i < sizeof cameras / sizeof *cameras; i++) {
        masu_frame_desc frame = {.camera = &cameras[i], .time = i ? 1e9 : -1e9};
        draw_finite(&s, &frame, &stats);
        assert_int_equal(stats.sdf_hits, 0);
        /* The bounds prevent evaluations of the field, except for single cones whose rounding slack
         * is as large as the bounds. */
        assert_true(stats.sdf_evals < W * H / 64);
    }
    close_session(&s);
}

/* Rays along the axes have zero components, by which the slab test divides. */
static void axis_parallel_views_are_not_special(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    uint64_t hits[6];
    open_for_depth(&s, "test_sphere_sdf", 0);
    for (uint32_t i = 0; i < 6; i++) {
        masu_camera c = {.fov_y = 0.8f, .near_distance = 0.1f};
        float sign = i % 2 ? -1.0f : 1.0f;
        c.position[i / 2] = (double)(-4 * sign);
        c.forward[i / 2] = sign;
        masu_frame_desc frame = {.camera = &c};
        draw_finite(&s, &frame, &stats);
        hits[i] = stats.sdf_hits;
    }
    for (uint32_t i = 1; i < 6; i++) assert_int_equal(hits[i], hits[0]);
    assert_true(hits[0] > 500);
    close_session(&s);
}

static void light_beyond_what_halves_hold_is_clamped_and_not_infinite(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    const masu_light light = {.sun_direction = {0.5f, 1, 0.3f},
                              .sun_color = {1e9f, 1e9f, 1e9f},
                              .ambient = {1e9f, 0, 1e9f},
                              .sky_zenith = {1e9f, 1e9f, 1e9f},
                              .exposure = 1e9f};
    masu_frame_desc frame = {.light = &light};
    open_for_depth(&s, "test_sphere_sdf", 0);
    draw_finite(&s, &frame, &stats);
    close_session(&s);
}

/* Each evaluation of the field adds 2^17 to one counter, and 1 to another. */
static void a_counter_carries_into_its_high_word(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    masu_commands commands;
    masu_frame_desc frame = {0};
    masu_session_desc d = test_desc("test_counter_carry", 256, 192);
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = 1.0f;
    open_session(&s, &d);
    for (int i = 0; i < 2; i++) { /* and the next frame begins at 0 again */
        draw(&s, &frame, &commands, NULL);
        assert_int_equal(masu_stats(s.m, commands.slot, &stats, NULL), MASU_OK);
        assert_true(stats.sdf_evals > 1u << 15);
        assert_int_equal(stats.replaced, stats.sdf_evals << 17);
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_field_of_nan_and_infinity_is_a_miss_and_breaks_nothing_beside_it),
        cmocka_unit_test(a_camera_inside_a_solid_sees_it_at_the_near_plane),
        cmocka_unit_test(a_camera_on_the_surface_looking_out_sees_the_sky),
        cmocka_unit_test(rays_that_run_out_of_steps_are_counted_and_never_drawn_by_default),
        cmocka_unit_test(views_beside_behind_and_far_from_the_bounds_draw_only_sky),
        cmocka_unit_test(axis_parallel_views_are_not_special),
        cmocka_unit_test(a_counter_carries_into_its_high_word),
        cmocka_unit_test(light_beyond_what_halves_hold_is_clamped_and_not_infinite),
    };
    return cmocka_run_group_tests_name("extremes", tests, NULL, NULL);
}
