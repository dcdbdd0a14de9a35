/* test_air.c: fog in the image. Each pixel with fog is compared with the same pixel without fog,
 * times the transmittance plus the in-scattered light, from numeric integration in double precision
 * along its ray. */
#include "support/support.h"
#include "support/floats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { SIDE = 96, PIXELS = SIDE * SIDE };

static masu_session s;
static float clear[4 * PIXELS], foggy[4 * PIXELS], depths[PIXELS];

static void render(const masu_camera *camera, const masu_light *light, float *hdr) {
    masu_frame_desc frame = {MASU_FRAME_DESC, .camera = camera, .light = light};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    memcpy(depths, read_image(&s, commands.slot, MASU_READBACK_DEPTH), sizeof depths);
    floats_of_halves(read_image(&s, commands.slot, MASU_READBACK_HDR), hdr, 4 * PIXELS);
}

static double integral(const masu_light *l, double height, double climb, double end) {
    double start = (double)l->fog_start, falloff = (double)l->fog_falloff;
    if (!(end > start)) return 0;
    int n = 2 * (int)fmin(fmax(50 * falloff * fabs(climb) * (end - start), 8), 200000);
    double step = (end - start) / n, sum = 0;
    for (int i = 0; i <= n; i++) {
        double w = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
        sum += w * exp(-falloff * (height + climb * (start + i * step)));
    }
    return (double)l->fog_density * sum * step / 3;
}

/* The largest difference from the expected value, relative to the pixel. */
static double compare(const masu_camera *camera, masu_light light) {
    double tan_y = tan((double)camera->fov_y / 2), worst = 0;
    float density = light.fog_density;
    light.fog_density = 0;
    render(camera, &light, clear);
    light.fog_density = density;
    render(camera, &light, foggy);
    for (uint32_t i = 0; i < PIXELS; i++) {
        /* The camera looks along -z. */
        double ray[3] = {((i % SIDE + 0.5) / SIDE * 2 - 1) * tan_y,
                         (1 - (i / SIDE + 0.5) / SIDE * 2) * tan_y, -1};
        double length = sqrt(ray[0] * ray[0] + ray[1] * ray[1] + 1);
        double climb = ray[1] / length;
        double height = camera->position[1] - (double)light.fog_height, depth;
        if (depths[i] > 0) {
            depth = integral(&light, height, climb,
                             (double)camera->near_distance / (double)depths[i] * length);
        } else if (light.fog_falloff > 0 && climb > 0) { /* the rest of an infinite ray: nothing */
            double end = (double)light.fog_start + 40 / ((double)light.fog_falloff * climb);
            depth = integral(&light, height, climb, end);
        } else {
            depth = 1e3;
        }
        for (uint32_t k = 0; k < 3; k++) {
            double left = exp(-depth);
            double want = (double)clear[4 * i + k] * left + (double)light.fog_color[k] * (1 - left);
            double off = fabs((double)foggy[4 * i + k] - want) / (0.01 + want);
            assert_true(isfinite(off));
            worst = worst_of(worst, off);
        }
    }
    return worst;
}

static void open_scene(const char *name) {
    masu_session_desc d = test_desc(name, SIDE, SIDE);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    open_session(&s, &d);
}

static masu_light fog_of(float density, float height, float falloff, float start) {
    return (masu_light){.sun_direction = {0.3f, 0.5f, 0.4f},
                        .sun_color = {2, 2, 2},
                        .ambient = {0.2f, 0.2f, 0.3f},
                        .sky_zenith = {0.2f, 0.4f, 0.8f},
                        .sky_horizon = {0.8f, 0.9f, 1},
                        .fog_color = {0.7f, 0.6f, 0.4f},
                        .fog_density = density,
                        .fog_height = height,
                        .fog_falloff = falloff,
                        .fog_start = start};
}

static void fog_is_what_an_integral_says(void **state) {
    (void)state;
    static const float rows[][5] = {/* density, height, falloff, start, eye */
                                    {0.02f, 0, 0, 0, 3},      {0.02f, 0, 0.1f, 0, 3},
                                    {0.02f, 0, 0.1f, 15, 3},  {0.5f, 0, 0.5f, 0, 12},
                                    {0.01f, 5, 0.02f, 1, 40}, {1e-4f, 0, 1e-3f, 0, 3},
                                    {0.3f, -2, 2, 0, 3},      {1e-8f, 200, 0.1f, 0, 3}};
    open_scene("test_fog");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const float *r = rows[i];
        masu_camera camera = {.position = {0, (double)r[4], 4},
                              .forward = {0, 0, -1},
                              .fov_y = 1.2f,
                              .near_distance = 0.1f};
        double off = compare(&camera, fog_of(r[0], r[1], r[2], r[3]));
        print_message("density %g, falloff %g, start %g, eye at %g: relative error %.5f\n",
                      (double)r[0], (double)r[2], (double)r[3], (double)r[4], off);
        assert_true(off < 0.003); /* half floats have an error of 2^-11, twice */
    }
    close_session(&s);
}

/* A million metres up, compared with the origin. */
static void fog_has_its_height_anywhere(void **state) {
    (void)state;
    static float here[4 * PIXELS];
    open_scene("test_fog");
    masu_camera camera = {.position = {1000, 20, 4}, .forward = {0, 0, -1}, .fov_y = 1.2f};
    masu_light light = fog_of(0.02f, 16, 0.1f, 0);
    render(&camera, &light, here);
    camera.position[1] = 1000020;
    light.fog_height = 1000016;
    render(&camera, &light, foggy);
    for (uint32_t i = 0; i < 4 * PIXELS / 3; i++) { /* above the horizon */
        assert_true(fabsf(here[i] - foggy[i]) <= 0.001f * here[i]);
    }
    close_session(&s);
}

/* Fog over the sky has no edge at the horizon, and thick fog has the horizon's colour. */
static void fog_of_the_sky_meets_the_horizon(void **state) {
    (void)state;
    open_scene("test_fog");
    masu_camera camera = {.position = {1000, 3, 4}, .forward = {0, 0, -1}, .fov_y = 1.2f};
    masu_light light = fog_of(0.02f, 0, 0.1f, 0);
    memset(light.fog_color, 0, sizeof light.fog_color);
    light.sun_direction[2] = -1;
    render(&camera, &light, foggy);
    for (uint32_t y = 1; y < SIDE; y++) {
        for (uint32_t x = 0; x < SIDE; x++) {
            const float *p = foggy + 4 * (y * SIDE + x), *above = p - 4 * SIDE;
            for (uint32_t k = 0; k < 3; k++) assert_true(fabsf(p[k] - above[k]) < 0.06f * p[k]);
        }
    }
    close_session(&s);
}

static void a_scene_without_fog_refuses_it(void **state) {
    (void)state;
    open_scene("test_texture_quad");
    masu_camera camera = {.position = {0, 0, 3}, .forward = {0, 0, -1}, .fov_y = 1.2f};
    masu_light light = fog_of(0.5f, 0, 0, 0);
    masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .light = &light};
    masu_commands commands;
    assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "light.fog_density");
    light.fog_density = 0;
    render(&camera, &light, foggy);
    float *values[] = {&light.fog_density, &light.fog_falloff, &light.fog_start, &light.fog_height,
                       &light.fog_color[1]};
    for (size_t i = 0; i < 5; i++) {
        float kept = *values[i];
        *values[i] = NAN;
        assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
        assert_non_null(strstr(failure.text, "fog"));
        *values[i] = i == 3 ? 2e9f : -1;
        assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
        *values[i] = kept;
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fog_is_what_an_integral_says),
        cmocka_unit_test(fog_has_its_height_anywhere),
        cmocka_unit_test(fog_of_the_sky_meets_the_horizon),
        cmocka_unit_test(a_scene_without_fog_refuses_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
