/* test_sky.c: the analytic sky on the GPU: the shader's table look-ups against src/frame/sky.c, the
 * sky's light on a matt sphere, and a renderer with an optional analytic sky renders a gradient
 * like one without. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image.h"
#include "support/support.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/sky_mirror.h"

#include "frame/sky.h"
#include "frame/sky_table.h"

static masu_detail failure; /* of the last call that failed */

#define W 128u
#define H 96u
#define PI 3.14159265358979323846

static masu_session s;
static masu_sky sky;

static masu_light light_at(double elevation, double azimuth, float turbidity) {
    double e = elevation * PI / 180, a = azimuth * PI / 180;
    return (masu_light){
        .sun_direction = {(float)(cos(e) * sin(a)), (float)sin(e), (float)(cos(e) * cos(a))},
        .turbidity = turbidity,
        .ground = {0.3f, 0.25f, 0.2f}};
}

static void open_sky(const char *scene, uint32_t analytic) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    d.desc.analytic_sky = analytic;
    open_session(&s, &d);
}

static void images(const masu_frame_desc *frame, const uint16_t **hdr, const float **depth) {
    masu_commands commands;
    draw(&s, frame, &commands, NULL);
    *hdr = read_image(&s, commands.slot, MASU_READBACK_HDR);
    *depth = read_image(&s, commands.slot, MASU_READBACK_DEPTH);
}

/* Unit vector through the centre of a pixel of a camera at z = 4 that looks along -z, up by
 * `tilt`. */
static void pixel_ray(uint32_t i, double tilt, float out[3]) {
    double t = tan(PI / 6), x = ((i % W + 0.5) / W * 2 - 1) * t * W / H;
    double y = -((i / W + 0.5) / H * 2 - 1) * t;
    double v[3] = {x, y * cos(tilt) + sin(tilt), y * sin(tilt) - cos(tilt)};
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) out[k] = (float)(v[k] / length);
}

static masu_camera camera_of(double tilt) {
    return (masu_camera){.position = {0, 0, 4},
                         .forward = {0, (float)sin(tilt), (float)-cos(tilt)},
                         .fov_y = (float)(PI / 3)};
}

/* Halves have 11 bits; the sun's disc and a pixel around it are skipped. */
static void pixels_of_the_sky_are_what_the_tables_say(void **state) {
    (void)state;
    static const double suns[][2] = {{60, 160}, {15, 200}, {1, 180}, {-3, 170}, {-20, 10}, {90, 0}};
    double worst = 0;
    open_sky("test_sky", 0);
    for (size_t n = 0; n < sizeof suns / sizeof *suns; n++) {
        for (int view = -1; view <= 1; view++) {
            double tilt = 0.9 * view;
            masu_light light = light_at(suns[n][0], suns[n][1], 2 + (float)n);
            masu_camera camera = camera_of(tilt);
            masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light, .camera = &camera};
            const uint16_t *hdr;
            const float *depth;
            uint32_t seen = 0;
            images(&frame, &hdr, &depth);
            masu_sky_update(&sky, light.sun_direction, light.turbidity, light.ground);
            for (uint32_t i = 0; i < W * H; i++) {
                float d[3], want[3];
                pixel_ray(i, tilt, d);
                float towards = d[0] * sky.sun[0] + d[1] * sky.sun[1] + d[2] * sky.sun[2];
                if (depth[i] > 0 || towards > 0.9995f) continue;
                masu_sky_radiance(&sky.uniforms, d, want);
                seen++;
                for (int c = 0; c < 3; c++) {
                    double got = half_float(hdr[4 * i + (uint32_t)c]), w = (double)want[c];
                    worst = worst_of(worst, fabs(got - w) / (w + 1e-4));
                }
            }
            assert_true(seen > W * H / 2);
        }
    }
    print_message("pixels have an error of %.5f at most\n", worst);
    assert_true(worst < 0.002);
    close_session(&s);
}

/* The sphere is matt, its sun below the horizon: it shows the sky's irradiance by its normal. */
static void a_matt_surface_shows_the_irradiance(void **state) {
    (void)state;
    masu_light light = light_at(-1, 120, 3);
    masu_camera camera = camera_of(0);
    masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light, .camera = &camera};
    const uint16_t *hdr;
    const float *depth;
    double worst = 0;
    uint32_t seen = 0;
    open_sky("test_sky", 0);
    images(&frame, &hdr, &depth);
    masu_sky_update(&sky, light.sun_direction, light.turbidity, light.ground);
    for (uint32_t i = 0; i < W * H; i++) {
        float d[3], n[3], want[3];
        pixel_ray(i, 0, d);
        double b = 4 * (double)d[2], root = b * b - 15, t = -b - sqrt(fmax(root, 0));
        if (!(depth[i] > 0) || root < 0.1) continue; /* except the rim */
        for (int k = 0; k < 3; k++) n[k] = (float)(t * (double)d[k] + (k == 2 ? 4 : 0));
        masu_sky_irradiance_at(&sky.irradiance, n, want);
        seen++;
        for (int c = 0; c < 3; c++) {
            double got = half_float(hdr[4 * i + (uint32_t)c]), w = 0.64 * (double)want[c];
            worst = worst_of(worst, fabs(got - w) / w);
        }
    }
    print_message("%u pixels, irradiance error %.4f at most\n", seen, worst);
    assert_true(seen > 1000 && worst < 0.02);
    close_session(&s);
}

/* Four spheres of grey metal use the sky by three look-ups, by look-ups and the table, by the
 * table, and by order 2; the sun is below the horizon. Viewed from above, such a metal reflects the
 * same fraction everywhere, in all colours. A white one would reflect more than a hundredth of its
 * light after a second interaction with the surface, from other directions. */
static void metals_mirror_the_sky_by_their_roughness(void **state) {
    (void)state;
    static const double roughness[] = {0.2, 0.35, 0.45, 0.7};
    static const double azimuths[] = {120, 10, 250};
    open_sky("test_sky_mirror", 0);
    for (int a = 0; a < 3; a++) {
        masu_light light = light_at(-1, azimuths[a], 3);
        masu_camera camera = camera_of(0);
        masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light, .camera = &camera};
        const uint16_t *hdr;
        const float *depth;
        images(&frame, &hdr, &depth);
        masu_sky_update(&sky, light.sun_direction, light.turbidity, light.ground);
        for (int b = 0; b < 4; b++) {
            double apart = 0, least = 1e9, most = 0;
            uint32_t seen = 0;
            for (uint32_t i = 0; i < W * H; i++) {
                float d[3];
                double n[3], v[3], want[3], ratio[3];
                pixel_ray(i, 0, d);
                const double eye[3] = {1.5 - b, 0, 4};
                double half = 0, square = -0.45 * 0.45;
                for (int k = 0; k < 3; k++) {
                    half += eye[k] * (double)d[k];
                    square += eye[k] * eye[k];
                }
                double root = half * half - square;
                if (!(depth[i] > 0) || root < 0.13) continue; /* except the rim */
                double t = -half - sqrt(root), facing = 0;
                for (int k = 0; k < 3; k++) {
                    n[k] = (eye[k] + t * (double)d[k]) / 0.45;
                    facing += n[k] * (double)d[k];
                }
                for (int k = 0; k < 3; k++) v[k] = (double)d[k] - 2 * facing * n[k];
                sky_mirror(&sky, v, roughness[b], want);
                seen++;
                for (int c = 0; c < 3; c++) {
                    ratio[c] = half_float(hdr[4 * i + (uint32_t)c]) / want[c];
                    least = fmin(least, ratio[c]);
                    most = fmax(most, ratio[c]);
                }
                apart = worst_of(
                    apart, fmax(fabs(ratio[0] / ratio[1] - 1), fabs(ratio[2] / ratio[1] - 1)));
            }
            print_message("roughness %.2f, sun at %g: %u pixels, %.4f to %.4f of the twin, colours "
                          "apart by %.4f\n",
                          roughness[b], azimuths[a], seen, least, most, apart);
            assert_true(seen > 60 && apart < 0.02 && most < 1.15 * least);
        }
    }
    close_session(&s);
}

/* Also in the frame after one with an analytic sky, in the same slot. */
static void a_gradient_is_the_same_where_an_analytic_sky_is_possible(void **state) {
    (void)state;
    static uint16_t without[W * H * 4];
    const uint16_t *hdr;
    const float *depth;
    masu_light light = light_at(30, 120, 0), analytic = light_at(30, 120, 4);
    light.sun_color[0] = 1, light.ambient[1] = 0.2f, light.sky_zenith[2] = 0.7f;
    light.sky_horizon[0] = 0.6f;
    masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light}, other = {.light = &analytic};
    open_sky("test_sphere_mesh", 0);
    images(&frame, &hdr, &depth);
    memcpy(without, hdr, sizeof without);
    close_session(&s);
    open_sky("test_sphere_mesh", 1);
    for (int i = 0; i < 3; i++) {
        images(&other, &hdr, &depth);
        assert_true(memcmp(without, hdr, sizeof without) != 0);
    }
    for (int i = 0; i < 3; i++) {
        images(&frame, &hdr, &depth);
        assert_memory_equal(without, hdr, sizeof without);
    }
    close_session(&s);
}

static void a_sky_that_was_not_planned_is_refused(void **state) {
    (void)state;
    masu_commands commands;
    masu_light light = light_at(30, 120, 3);
    masu_frame_desc frame = {MASU_FRAME_DESC, .light = &light};
    open_sky("test_sphere_mesh", 0);
    assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "light.turbidity");
    close_session(&s);
    open_sky("test_sphere_mesh", 1);
    static const float bad[] = {1.4f, 10.1f, -3, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        light.turbidity = bad[i];
        assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
        assert_string_equal(failure.what, "light.turbidity");
    }
    light.turbidity = 3, light.ground[1] = 1.1f;
    assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "light.ground");
    close_session(&s);
}

/* ---- Environment map ------------------------------------------------------------------------- */

/* A radiance linear in the direction: its irradiance / pi has two thirds of the slope. */
static double linear_sky(const float d[3], int c, double share) {
    static const double slope[3][3] = {{0.3, 0.1, 0.05}, {-0.1, 0.25, 0.1}, {0.05, 0.1, -0.3}};
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += slope[c][k] * (double)d[k];
    return 0.5 + share * sum;
}

static void write_picture(const char *path) {
    enum { WIDE = 128, HIGH = 64 };
    static float rgb[WIDE * HIGH * 3];
    char error[256];
    for (int i = 0; i < WIDE * HIGH; i++) {
        double polar = (i / WIDE + 0.5) / HIGH * PI,
               azimuth = (0.5 - (i % WIDE + 0.5) / WIDE) * 2 * PI;
        const float d[3] = {(float)(sin(polar) * sin(azimuth)), (float)cos(polar),
                            (float)(sin(polar) * cos(azimuth))};
        for (int c = 0; c < 3; c++) rgb[3 * i + c] = (float)(0.5 * linear_sky(d, c, 1));
    }
    assert_ok(masu_image_save_pfm(path, rgb, WIDE, HIGH, 3, error, sizeof error));
}

static void bake_picture(void) {
    static const char json[] =
        "{\"models\": [{\"mesh\": {\"sphere\": {\"radius\": 1, \"subdivisions\": 6}}, "
        "\"material\": "
        "{\"base_color\": [0.64, 0.64, 0.64], \"roughness\": 1, \"specular\": 0}}], \"sun\": "
        "{\"intensity\": 0}, \"environment\": {\"file\": \"sky.pfm\", \"scale\": 2, \"size\": 64}}";
    write_picture(in_scratch("sky.pfm"));
    bake_scene("sky", json);
}

static void a_picture_is_seen_and_lights(void **state) {
    (void)state;
    bake_picture();
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = in_scratch("sky.masu");
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    double sky_error = 0, light_error = 0;
    uint32_t lit = 0;
    open_session(&s, &d);
    for (int view = -1; view <= 1; view++) {
        masu_camera camera = camera_of(0.9 * view);
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera};
        const uint16_t *hdr;
        const float *depth;
        images(&frame, &hdr, &depth);
        for (uint32_t i = 0; i < W * H; i++) {
            float ray[3], n[3];
            pixel_ray(i, 0.9 * view, ray);
            double b = 4 * (double)ray[2], root = b * b - 15, t = -b - sqrt(fmax(root, 0));
            if (depth[i] > 0 && root < 0.1) continue;
            for (int k = 0; k < 3; k++) n[k] = (float)(t * (double)ray[k] + (k == 2 ? 4 : 0));
            for (int c = 0; c < 3; c++) {
                double got = half_float(hdr[4 * i + (uint32_t)c]);
                if (depth[i] > 0) {
                    light_error =
                        worst_of(light_error, fabs(got - 0.64 * linear_sky(n, c, 2.0 / 3)));
                    lit++;
                } else {
                    sky_error = worst_of(sky_error, fabs(got - linear_sky(ray, c, 1)));
                }
            }
        }
    }
    close_session(&s);
    print_message("an environment map's sky has an error of %.4f, its light %.4f\n",
                  sky_error, light_error);
    assert_true(sky_error < 0.01 && light_error < 0.005 && lit > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_of_the_sky_are_what_the_tables_say),
        cmocka_unit_test(a_matt_surface_shows_the_irradiance),
        cmocka_unit_test(metals_mirror_the_sky_by_their_roughness),
        cmocka_unit_test(a_gradient_is_the_same_where_an_analytic_sky_is_possible),
        cmocka_unit_test(a_picture_is_seen_and_lights),
        cmocka_unit_test(a_sky_that_was_not_planned_is_refused),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
