/* test_live_environment.c: light.environment against scenes whose environment map was baked so: a
 * rotated, brighter or tinted picture; in the sky, matt and glossy surfaces, traced mirrors and light
 * probes. The background changes what the camera sees of the sky and nothing else. */
#include "image.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 130, H = 72, WIDE = 256, HIGH = 128 };
#define PI 3.14159265358979323846

static masu_detail failure; /* of the last call that failed */
static masu_session s;
static uint16_t images[3][W * H * 4];
static float pixels[WIDE * HIGH * 3];
static int frames = 4; /* that an image takes: reflections and bounces gather */

/* ---- Pictures -------------------------------------------------------------------------------- */

typedef struct quaternion {
    double x, y, z, w;
} quaternion;

static quaternion about(double x, double y, double z, double degrees) {
    double half = degrees * PI / 360;
    return (quaternion){x * sin(half), y * sin(half), z * sin(half), cos(half)};
}

/* v rotated by the conjugate: from the world to the axes of the map. */
static void rotate_back(quaternion q, const double v[3], double out[3]) {
    const double u[3] = {-q.x, -q.y, -q.z};
    double t[3];
    for (int k = 0; k < 3; k++)
        t[k] = 2 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    for (int k = 0; k < 3; k++)
        out[k] =
            v[k] + q.w * t[k] + u[(k + 1) % 3] * t[(k + 2) % 3] - u[(k + 2) % 3] * t[(k + 1) % 3];
}

/* kind 0: a sky with a broad bright side over a ground; 1: a bright horizon; 2: a bright window. */
static double radiance(int kind, const double d[3], int c) {
    double side = exp(-4 * (1 - (0.6 * d[0] + 0.48 * d[1] + 0.64 * d[2])));
    double sky = 0.2 + 0.1 * c + 0.6 * side + 0.15 * d[1] + 0.1 * d[0] * d[2];
    if (kind == 1) return 0.2 + 0.05 * c + exp(-8 * d[1] * d[1]);
    if (kind == 2) return sky + (d[0] * 0.8 + d[1] * 0.6 > 0.97 ? 12 : 0);
    return sky * (d[1] > 0 ? 1 : 0.6);
}

static void bake(const char *name, int kind, quaternion q, const double factor[3],
                 const char *more) {
    char json[4096], file[64], error[256];
    for (int i = 0; i < WIDE * HIGH; i++) {
        double polar = (i / WIDE + 0.5) / HIGH * PI,
               azimuth = (0.5 - (i % WIDE + 0.5) / WIDE) * 2 * PI, d[3];
        const double world[3] = {sin(polar) * sin(azimuth), cos(polar), sin(polar) * cos(azimuth)};
        rotate_back(q, world, d);
        for (int c = 0; c < 3; c++) pixels[3 * i + c] = (float)(factor[c] * radiance(kind, d, c));
    }
    snprintf(file, sizeof file, "%s.pfm", name);
    assert_ok(masu_image_save_pfm(in_scratch(file), pixels, WIDE, HIGH, 3, error, sizeof error));
    snprintf(json, sizeof json,
             "{\"environment\": {\"file\": \"%s\", \"size\": 128}, \"sun\": {\"intensity\": 0}, "
             "\"ambient_occlusion\": false, %s \"models\": ["
             "{\"mesh\": {\"sphere\": {\"radius\": 0.9, \"subdivisions\": 4}}, \"translate\": [-2, "
             "0.2, 0], "
             "\"material\": {\"base_color\": [1, 1, 1], \"roughness\": 1, \"specular\": 0}},"
             "{\"mesh\": {\"sphere\": {\"radius\": 0.9, \"subdivisions\": 4}}, \"translate\": [0, "
             "0.2, 0], "
             "\"material\": {\"base_color\": [1, 1, 1], \"roughness\": 0.6, \"metallic\": 1}},"
             "{\"mesh\": {\"sphere\": {\"radius\": 0.9, \"subdivisions\": 5}}, \"translate\": [2, "
             "0.2, 0], "
             "\"material\": {\"base_color\": [1, 1, 1], \"roughness\": 0, \"metallic\": 1}}],"
             "\"camera\": {\"fov_y\": 45, \"near\": 0.05, \"keys\": [{\"position\": [0, 1, 6], "
             "\"target\": "
             "[0, 0.2, 0]}]}}",
             file, more);
    bake_scene(name, json);
}

/* ---- Images ---------------------------------------------------------------------------------- */

static void open_scene(const char *name, int live) {
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene(name);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.live_environment = (uint32_t)live;
    open_session(&s, &d);
}

static void draw_with(const masu_environment *environment, uint16_t *out) {
    masu_light light;
    static uint8_t shown[W * H * 4];
    assert_int_equal(masu_light_of(s.m, &light, &failure), MASU_OK);
    if (environment) light.environment = *environment;
    for (int i = 0; i < frames; i++) {
        masu_frame_desc frame = {.light = &light, .cut = i == 0};
        masu_commands commands;
        draw(&s, &frame, &commands, shown);
        memcpy(out, read_image(&s, commands.slot, MASU_READBACK_HDR), sizeof images[0]);
    }
    const char *folder = getenv("MASU_LOOKS_OUT");
    static int number;
    char path[512], error[256];
    if (!folder) return;
    snprintf(path, sizeof path, "%s/env%02d.png", folder, number++);
    assert_ok(masu_image_save_png(path, shown, W, H, 0, error, sizeof error));
}

static masu_environment rotated(quaternion q) {
    return (masu_environment){.rotation = {(float)q.x, (float)q.y, (float)q.z, (float)q.w}};
}

/* RMS of the difference over that of b, in columns of the image. */
static double error_of(const uint16_t *a, const uint16_t *b, uint32_t from, uint32_t to) {
    double square = 0, all = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        if (i % W < from || i % W >= to) continue;
        for (uint32_t c = 0; c < 3; c++) {
            double want = half_float(b[4 * i + c]);
            square += pow(half_float(a[4 * i + c]) - want, 2);
            all += want * want;
        }
    }
    return sqrt(square / all);
}

static const double white[3] = {1, 1, 1};
static const quaternion none = {0, 0, 0, 1};

/* ---- Tests ----------------------------------------------------------------------------------- */

static void compare(int kind, quaternion q, const char *more, double most, const char *what) {
    bake("straight", kind, none, white, more);
    bake("turned", kind, q, white, more);
    masu_environment e = rotated(q);
    open_scene("turned", 0);
    draw_with(NULL, images[0]);
    close_session(&s);
    open_scene("straight", 1);
    draw_with(&e, images[1]);
    draw_with(NULL, images[2]);
    close_session(&s);
    double off = error_of(images[1], images[0], 0, W),
           before = error_of(images[2], images[0], 0, W);
    print_message("%s: off by %.4f, the matt ball by %.4f, the mirror by %.4f; unturned %.4f\n",
                  what, off, error_of(images[1], images[0], 26, 40),
                  error_of(images[1], images[0], 86, 104), before);
    assert_true(off <= most);
    assert_true(before > 4 * most);
}

static void a_rotation_is_that_of_the_picture(void **state) {
    (void)state;
    compare(0, about(0, 1, 0, 90),
            "\"reflections\": {}, \"probes\": {\"spacing\": [0.6, 0.6, 0.6]},", 0.003,
            "90 degrees about +Y, with probes");
    compare(0, about(0, 1, 0, -37), "", 0.01, "-37 degrees about +Y");
    if (!whole_run()) return;
    compare(0, about(0.6, 0, 0.8, 90), "", 0.02, "tilted by 90 degrees");
    frames = 24;
    compare(0, about(0, 1, 0, 90), "\"reflections\": {}, \"bounce\": {\"spacing\": 0.7},", 0.01,
            "with a bounce");
    frames = 4;
}

/* What P4 of y cannot have of a tilted sky (masu_environment in masu.h). */
static void tilted_irradiance_is_off_by_little(void **state) {
    (void)state;
    double worst = 0;
    for (int kind = 0; kind < 3; kind++) {
        if (kind != 1 && !whole_run()) continue; /* the worst */
        bake("straight", kind, none, white, "");
        bake("turned", kind, about(1, 0, 0, 90), white, "");
        masu_environment e = rotated(about(1, 0, 0, 90));
        open_scene("turned", 0);
        draw_with(NULL, images[0]);
        close_session(&s);
        open_scene("straight", 1);
        draw_with(&e, images[1]);
        close_session(&s);
        double most = 0, brightest = 0;
        for (uint32_t y = 22; y < 50; y++) {
            for (uint32_t x = 24; x < 42; x++) { /* of the matt ball */
                for (uint32_t c = 0; c < 3; c++) {
                    double want = half_float(images[0][4 * (y * W + x) + c]);
                    most = fmax(most, fabs(half_float(images[1][4 * (y * W + x) + c]) - want));
                    brightest = fmax(brightest, want);
                }
            }
        }
        print_message(
            "sky %d, tilted by 90 degrees: irradiance off by at most %.4f of the brightest\n", kind,
            most / brightest);
        worst = fmax(worst, most / brightest);
    }
    assert_true(worst <= 0.021);
}

static void brightness_and_tint_are_those_of_the_picture(void **state) {
    (void)state;
    static const double twice[3] = {2, 2, 2}, hue[3] = {1, 0.5, 0.25};
    const masu_environment bright = {.intensity = 2}, tint = {.tint = {1, 0.5f, 0.25f}},
                           dark = {.intensity = -1};
    bake("straight", 0, none, white, "\"reflections\": {},");
    bake("bright", 0, none, twice, "\"reflections\": {},");
    bake("hued", 0, none, hue, "\"reflections\": {},");
    open_scene("bright", 0);
    draw_with(NULL, images[0]);
    close_session(&s);
    open_scene("straight", 1);
    draw_with(&bright, images[1]);
    close_session(&s);
    double off = error_of(images[1], images[0], 0, W);
    print_message("intensity 2: off by %.5f from a picture twice as bright\n", off);
    assert_true(off <= 0.0005);
    open_scene("hued", 0);
    draw_with(NULL, images[0]);
    close_session(&s);
    open_scene("straight", 1);
    draw_with(&tint, images[1]);
    off = error_of(images[1], images[0], 0, W);
    print_message("tint: off by %.5f from a picture of that tint\n", off);
    assert_true(off <= 0.004);
    draw_with(&dark, images[1]);
    for (uint32_t i = 0; i < W * H; i++)
        for (uint32_t c = 0; c < 3; c++) assert_int_equal(images[1][4 * i + c] & 0x7FFF, 0);
    close_session(&s);
}

/* Values are exact in half floats. */
static void a_background_changes_the_sky_only(void **state) {
    (void)state;
    const masu_environment flat = {.background_intensity = -1,
                                   .background_color = {0.125f, 0.25f, 0.5f}},
                           both = {.background_intensity = 0.5f,
                                   .background_color = {0.125f, 0, 0}};
    bake("straight", 0, none, white, "\"reflections\": {},");
    open_scene("straight", 0);
    draw_with(NULL, images[0]);
    close_session(&s);
    open_scene("straight", 1);
    draw_with(&flat, images[1]);
    close_session(&s);
    open_scene("straight", 1);
    draw_with(&both, images[2]);
    close_session(&s);
    uint32_t sky = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        const uint16_t *plain = images[0] + 4 * i, *is = images[1] + 4 * i,
                       *half = images[2] + 4 * i;
        int open =
            half_float(is[0]) == 0.125 && half_float(is[1]) == 0.25 && half_float(is[2]) == 0.5;
        sky += open;
        if (!open) {
            assert_memory_equal(is, plain, 6);
            assert_memory_equal(half, plain, 6);
        } else {
            for (uint32_t c = 0; c < 3; c++)
                assert_true(fabs(half_float(half[c]) - 0.5 * half_float(plain[c]) -
                                 (c ? 0 : 0.125)) < 0.001);
        }
    }
    print_message("%u of %u pixels are sky\n", sky, W * H);
    assert_in_range(sky, W * H / 2, W * H * 9 / 10);
}

static masu_result frame_with(const masu_environment *e) {
    masu_light light;
    masu_commands commands;
    assert_int_equal(masu_light_of(s.m, &light, &failure), MASU_OK);
    light.environment = *e;
    masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light};
    return masu_frame(s.m, &frame, &commands, &failure);
}

static void what_does_not_apply_is_rejected(void **state) {
    (void)state;
    static const masu_environment bad[] = {{.intensity = 1.1e6f},
                                           {.tint = {0, 0, 1.001f}},
                                           {.background_intensity = -1.1e6f},
                                           {.background_color = {-1, 0, 0}},
                                           {.rotation = {1e-11f, 0, 0, 0}},
                                           {.rotation = {NAN, 0, 0, 0}}};
    const masu_environment sky = {.intensity = 2}, background = {.background_color = {1, 1, 1}};
    bake("straight", 0, none, white, "");
    open_scene("straight", 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(frame_with(&bad[i]), MASU_ERROR_ARGUMENT);
    close_session(&s);
    open_scene("straight", 0);
    assert_int_equal(frame_with(&sky), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.text, "desc.live_environment"));
    assert_int_equal(frame_with(&background), MASU_ERROR_ARGUMENT);
    close_session(&s);
    bake_scene("bare", "{\"models\": [{\"mesh\": {\"sphere\": {}}}]}");
    open_scene("bare", 1);
    assert_int_equal(frame_with(&sky), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.text, "environment map"));
    draw_with(&background, images[0]); /* of any sky */
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rotation_is_that_of_the_picture),
        cmocka_unit_test(tilted_irradiance_is_off_by_little),
        cmocka_unit_test(brightness_and_tint_are_those_of_the_picture),
        cmocka_unit_test(a_background_changes_the_sky_only),
        cmocka_unit_test(what_does_not_apply_is_rejected),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
