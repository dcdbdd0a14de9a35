/* test_meaning.c: inputs have their documented effect: constants of the field, time, camera path,
 * materials, light, exposure, and log messages. */
#include "support/support.h"
#include "support/floats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 96, H = 66, CENTRE = H / 2 * W + W / 2 };

static masu_session s;

static void open_scene(const char *scene, uint32_t steps) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_ALL;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.march_steps = steps};
    open_session(&s, &d);
}

/* View depth at the centre of the image. */
static float depth_at_centre(const masu_frame_desc *frame) {
    return 0.1f / ((const float *)draw_image(&s, frame, MASU_READBACK_DEPTH, NULL))[CENTRE];
}

static void a_field_of_lipschitz_constant_3_is_stepped_by_a_third(void **state) {
    (void)state;
    masu_stats_info stats;
    masu_frame_desc frame = {MASU_FRAME_DESC};
    open_scene("test_scaled_field", 0);
    assert_float_equal(depth_at_centre(&frame), 3.0f, 1e-3f);
    assert_int_equal(masu_stats(s.m, 0, &stats, &failure), MASU_OK);
    /* Steps three times too long would pass through the rim, or go far into the sphere. */
    const float *depth = draw_image(&s, &frame, MASU_READBACK_DEPTH, NULL);
    uint32_t hits = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        if (depth[i] <= 0) continue;
        hits++;
        assert_true(0.1f / depth[i] >= 2.999f && 0.1f / depth[i] <= 4.0f);
    }
    assert_int_equal(stats.sdf_hits, hits);
    /* A disc of radius tan(asin(1/4)) in an image 2 tan(20 degrees) high. */
    double radius = tan(asin(0.25)) / tan(20 / 57.29578) * H / 2;
    assert_true(fabs(hits - 3.14159265 * radius * radius) < 0.02 * hits);
    close_session(&s);
}

static void time_moves_the_field_and_the_camera_along_its_path(void **state) {
    (void)state;
    masu_camera c;
    masu_frame_desc frame = {MASU_FRAME_DESC, .time = 1};
    open_scene("test_scaled_field", 0);
    /* Both are 0.5 apart at time 1: the camera at x = 1, the sphere at x = 0.5. */
    assert_float_equal(depth_at_centre(&frame), 4.0f - sqrtf(0.75f), 0.02f);
    assert_int_equal(masu_camera_at(s.m, 0.5, &c, &failure), MASU_OK);
    assert_float_equal(c.position[0], 0.5, 1e-6);
    assert_int_equal(masu_camera_at(s.m, -5, &c, &failure), MASU_OK); /* held at both ends */
    assert_float_equal(c.position[0], 0, 1e-6);
    assert_int_equal(masu_camera_at(s.m, 99, &c, &failure), MASU_OK);
    assert_float_equal(c.position[0], 2, 1e-6);
    close_session(&s);
}

static void steps_that_run_out_near_the_surface_still_show_it(void **state) {
    (void)state;
    masu_stats_info stats;
    masu_frame_desc frame = {MASU_FRAME_DESC};
    /* From distance 4 with f / 3: after 24 steps the centre is within 2 pixels, not within 0.1. */
    for (uint32_t steps = 1; steps < 64; steps++) {
        open_scene("test_sphere_sdf", steps);
        depth_at_centre(&frame);
        assert_int_equal(masu_stats(s.m, 0, &stats, &failure), MASU_OK);
        close_session(&s);
        if (stats.sdf_unconverged && stats.sdf_hits)
            return; /* some of the unconverged rays give the surface */
    }
    fail_msg("no number of steps leaves rays unconverged and drawn");
}

static void materials_arrive_in_the_g_buffer(void **state) {
    (void)state;
    static const float box[3] = {0.2f, 0.4f, 0.7f}, sphere[3] = {0.7f, 0.6f, 0.2f};
    masu_frame_desc frame = {MASU_FRAME_DESC};
    uint32_t seen[2] = {0};
    open_scene("test_both", 0);
    const uint8_t *albedo = draw_image(&s, &frame, MASU_READBACK_ALBEDO, NULL);
    for (uint32_t i = 0; i < W * H; i++, albedo += 4) {
        for (int which = 0; which < 2; which++) {
            const float *color = which ? sphere : box;
            int same = abs((int)albedo[3] - (which ? 102 : 153)) <= 1; /* roughness 0.4, 0.6 */
            for (int k = 0; k < 3; k++) {
                same &= fabsf((float)albedo[k] - 255.0f * sqrtf(color[k])) < 1.01f;
            }
            seen[which] += (uint32_t)same;
        }
    }
    assert_true(seen[0] > 300 && seen[1] > 300);
    close_session(&s);
}

/* Radiance at the sphere's centre against the formulas of light.comp in plain C. */
static void the_sun_lights_as_the_formulas_say(void **state) {
    (void)state;
    const masu_light light = {.sun_direction = {0, 0.6f, 0.8f},
                              .sun_color = {2, 1, 0.5f},
                              .ambient = {0.1f, 0.2f, 0.3f},
                              .sky_zenith = {0, 0, 0},
                              .sky_horizon = {0, 0, 0}};
    masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light};
    open_scene("test_scaled_field", 0);
    const uint16_t *hdr =
        (const uint16_t *)draw_image(&s, &frame, MASU_READBACK_HDR, NULL) + 4 * CENTRE;
    static const double albedo[3] = {0.25, 0.5, 1.0};
    double n_l = 0.8, alpha = 0.25, n_h = 0.8 + 1;
    double length = sqrt(0.6 * 0.6 + 1.8 * 1.8);
    n_h /= length;
    double v_h = n_h, sine2 = 1 - n_h * n_h, k = alpha / (sine2 + n_h * n_h * alpha * alpha);
    double a2 = alpha * alpha, g = n_l * sqrt(a2 + (1 - a2)) + sqrt(a2 + (1 - a2) * n_l * n_l);
    double lobe = k * k * 0.5 / g, fresnel = 0.04 + 0.96 * pow(1 - v_h, 5);
    for (int c = 0; c < 3; c++) {
        double sun =
            (double)light.sun_color[c] * n_l * (albedo[c] * (1 - fresnel) + fresnel * lobe);
        double ambient = (double)light.ambient[c] * (albedo[c] + 0.04 * 0.5);
        assert_float_equal((float)half_float(hdr[c]), (float)(sun + ambient),
                           (float)(0.05 * (sun + ambient)));
    }
    /* The same light from behind leaves only the ambient light. */
    masu_light behind = light;
    behind.sun_direction[2] = -0.8f, behind.sun_direction[1] = 0, behind.sun_direction[0] = 0;
    frame.light = &behind;
    hdr = (const uint16_t *)draw_image(&s, &frame, MASU_READBACK_HDR, NULL) + 4 * CENTRE;
    assert_float_equal((float)half_float(hdr[0]), 0.1f * (0.25f + 0.02f), 0.003f);
    /* Emission has its given radiance, under any light. */
    uint32_t glowing = 0;
    hdr = draw_image(&s, &frame, MASU_READBACK_HDR, NULL);
    for (uint32_t i = 0; i < W * H; i++) glowing += fabs(half_float(hdr[4 * i]) - 4) < 0.1;
    assert_true(glowing > 50);
    close_session(&s);
}

static void exposure_is_a_factor_and_the_curve_rises_to_white(void **state) {
    (void)state;
    static uint8_t a[W * H * 4], b[W * H * 4];
    masu_light light = {
        .sun_direction = {0, 0, 1}, .sun_color = {0.5f, 0.25f, 0.125f}, .exposure = 2};
    masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light};
    open_scene("test_sphere_sdf", 0);
    draw_image(&s, &frame, MASU_READBACK_HDR, a);
    for (int k = 0; k < 3; k++) light.sun_color[k] *= 2;
    light.exposure = 0; /* 1 */
    const uint16_t *hdr = draw_image(&s, &frame, MASU_READBACK_HDR, b);
    assert_true(max_difference(a, b, sizeof a) <= 1);
    /* The tone curve, in double precision, at every pixel. */
    for (uint32_t i = 0; i < W * H; i++) {
        for (int k = 0; k < 3; k++) {
            double x = half_float(hdr[4 * i + k]);
            double y = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
            y = fmin(1, fmax(0, y));
            double code = y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1 / 2.4) - 0.055;
            assert_true(fabs(code * 255 - b[4 * i + k]) <= 1.01);
        }
    }
    close_session(&s);
}

static char logged[4][256];
static uint32_t log_count;

static void keep_log(void *user, masu_log_level level, const char *text) {
    assert_ptr_equal(user, &log_count);
    if (log_count < 4) snprintf(logged[log_count], sizeof logged[0], "%d %s", (int)level, text);
    log_count++;
}

static void the_log_hears_what_the_detail_says(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_sphere_sdf", W, H);
    masu_commands commands;
    masu_frame_desc bad = {MASU_FRAME_DESC, .rung = 77};
    d.desc.log = keep_log;
    d.desc.log_user = &log_count;
    log_count = 0;
    open_session(&s, &d);
    assert_int_equal(log_count, 1);
    assert_int_equal(logged[0][0], '2'); /* information: the memory block */
    assert_int_equal(masu_frame(s.m, &bad, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(log_count, 2);
    assert_int_equal(logged[1][0], '0');
    assert_string_equal(logged[1] + 2, failure.text);
    masu_detail detail;
    masu_renderer *none;
    assert_int_equal(masu_init(&s.desc, NULL, 0, &none, &detail), MASU_ERROR_MEMORY);
    assert_int_equal(log_count, 3);
    assert_string_equal(logged[2] + 2, detail.text);
    close_session(&s);
}

static void targets_that_hold_no_picture_are_refused(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_detail detail;
    masu_memory need;
    d.no_renderer = true;
    open_session(&s, &d);
    static const VkFormat formats[] = {VK_FORMAT_R8G8B8_UNORM, VK_FORMAT_R32G32B32A32_SFLOAT,
                                       VK_FORMAT_R8G8B8A8_UINT, VK_FORMAT_D32_SFLOAT};
    s.desc.targets.storage = 0;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        s.desc.targets.format = formats[i];
        assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_ARGUMENT);
        assert_string_equal(detail.what, "targets.format");
    }
    s.desc.targets.format = VK_FORMAT_UNDEFINED;
    s.desc.targets.final_layout = (VkImageLayout)12345;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "targets.final_layout");
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_field_of_lipschitz_constant_3_is_stepped_by_a_third),
        cmocka_unit_test(time_moves_the_field_and_the_camera_along_its_path),
        cmocka_unit_test(steps_that_run_out_near_the_surface_still_show_it),
        cmocka_unit_test(materials_arrive_in_the_g_buffer),
        cmocka_unit_test(the_sun_lights_as_the_formulas_say),
        cmocka_unit_test(exposure_is_a_factor_and_the_curve_rises_to_white),
        cmocka_unit_test(the_log_hears_what_the_detail_says),
        cmocka_unit_test(targets_that_hold_no_picture_are_refused),
    };
    return cmocka_run_group_tests_name("meaning", tests, NULL, NULL);
}
