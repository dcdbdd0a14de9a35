/* test_truth.c: a shifted projection moves polygons, SDF and velocities by the same fraction of a
 * pixel; the ground truth of an image with an edge is the area of each pixel on one side of it; and
 * the table of errors is printed. The scene's polygon box and SDF share an edge at x = -0.013 on
 * the plane z = -5, emissive in front of black: polygons above y = 0, the SDF below. */
#include "support/support.h"
#include "support/files.h"

#include "measure/linear.h"
#include "measure/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 96, PIXELS = SIZE * SIZE, PLACES = 64 };

#define EDGE -0.013 /* the camera is on the emissive side, and no other face is visible */
#define AWAY 5.0
#define FOV 0.7

static uint8_t picture[4 * PIXELS];
static float radiance[3 * PIXELS];

/* The camera, and with it the edge, rolled by an angle. */
static masu_camera rolled(double angle) {
    return (masu_camera){.forward = {0, 0, -1},
                         .up = {(float)sin(angle), (float)cos(angle), 0},
                         .fov_y = (float)FOV,
                         .near_distance = 0.1f};
}

/* x and y on the plane of the edge, affine in pixels: a[0] px + a[1] py + a[2]. */
static void plane_of(double angle, double x[3], double y[3]) {
    double step = 2 * AWAY * tan(FOV / 2) / SIZE;
    x[0] = step * cos(angle), x[1] = -step * sin(angle);
    y[0] = -step * sin(angle), y[1] = -step * cos(angle);
    x[2] = -SIZE / 2 * (x[0] + x[1]) - EDGE; /* from the edge */
    y[2] = -SIZE / 2 * (y[0] + y[1]);
}

static double at(const double a[3], double px, double py) { return a[0] * px + a[1] * py + a[2]; }

static double positive_square(double v) { return v > 0 ? v * v : 0; }

/* Fraction of the pixel with corner (px, py) in which a is above 0. */
static double share(const double a[3], double px, double py) {
    double n[2] = {fabs(a[0]), fabs(a[1])};
    /* the smallest of its four corners */
    double least = at(a, px, py) + fmin(a[0], 0) + fmin(a[1], 0);
    double most = least + n[0] + n[1];
    if (!(fmin(n[0], n[1]) > 1e-6 * fmax(n[0], n[1])))
        return fmin(fmax(most / fmax(n[0], n[1]), 0), 1);
    double sum = positive_square(most) - positive_square(most - n[0]) -
                 positive_square(most - n[1]) + positive_square(least);
    return sum / (2 * n[0] * n[1]);
}

static void open_truth(masu_session *s) {
    char error[ERROR_SIZE];
    masu_session_desc d = test_desc("test_truth", SIZE, SIZE);
    assert_ok(masu_picture_open(&d, PLACES, s, error, sizeof error));
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void places_are_even(void **state) {
    (void)state;
    for (uint32_t n = 1; n <= 256; n *= 4) {
        uint8_t across[256] = {0}, down[256] = {0};
        for (uint32_t i = 0; i < n; i++) {
            float place[2];
            masu_picture_place(i, n, place);
            assert_true(fabsf(place[0]) < 0.5f && fabsf(place[1]) < 0.5f);
            across[(uint32_t)((place[0] + 0.5f) * (float)n)]++;
            down[(uint32_t)((place[1] + 0.5f) * (float)n)]++;
        }
        for (uint32_t i = 0; i < n; i++) assert_true(across[i] == 1 && down[i] == 1);
    }
    float far[2]; /* also for numbers that are no power of two */
    for (uint32_t i = 0; i < 4095; i++) {
        masu_picture_place(i, 4095, far);
        assert_true(fabsf(far[0]) <= 0.5f && fabsf(far[1]) <= 0.5f);
    }
}

static void eight_bits_come_back(void **state) {
    (void)state;
    for (uint32_t v = 0; v < 256; v++)
        assert_int_equal(masu_srgb_encoded(masu_srgb_decoded((uint8_t)v)), v);
    assert_int_equal(masu_srgb_encoded(2.0f), 255);
    assert_int_equal(masu_srgb_encoded(nanf("")), 0);
}

/* Numbers of lit pixels in the polygon half and in the SDF half, and of all pixels in each. */
static void count_lit(const double y[3], double lit[2], double all[2]) {
    lit[0] = lit[1] = all[0] = all[1] = 0;
    double pixel = hypot(y[0], y[1]);
    for (uint32_t p = 0; p < PIXELS; p++) {
        double v = at(y, p % SIZE + 0.5, p / SIZE + 0.5);
        if (fabs(v) < 3 * pixel) continue;
        all[v < 0]++;
        lit[v < 0] += picture[4 * p + 1] > 64;
    }
}

/* An edge tilted by one pixel in 8 crosses the pixels' centres at as many positions as there are
 * rows: the number of lit pixels gives its position to some hundredths of a pixel. */
static void a_jitter_moves_all_alike(void **state) {
    (void)state;
    static const float jitters[][2] = {{0.6f, 0}, {-0.35f, 0}, {0, 0.6f}, {0, -1.0f}, {1.0f, 0.3f}};
    masu_session s;
    masu_session_desc d = test_desc("test_truth", SIZE, SIZE);
    d.desc.rung_count = 1;
    open_session(&s, &d);
    for (size_t i = 0; i < sizeof jitters / sizeof *jitters; i++) {
        double angle = 0.1235 + (jitters[i][0] != 0.0f ? 0.0 : acos(0.0)), x[3], y[3];
        plane_of(angle, x, y);
        masu_camera camera = rolled(angle);
        masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .cut = 1};
        masu_commands commands;
        double still[2], moved[2], all[2];
        draw(&s, &f, &commands, picture);
        count_lit(y, still, all);
        memcpy(camera.jitter, jitters[i], sizeof camera.jitter);
        draw(&s, &f, &commands, picture);
        count_lit(y, moved, all);
        /* Distance in pixels by which the edge has moved to the dark side, and the expected
         * distance. */
        double want =
            ((double)jitters[i][0] * x[0] + (double)jitters[i][1] * x[1]) / hypot(x[0], x[1]);
        for (int half = 0; half < 2; half++) {
            /* approximate length of the edge: one side of the swept area */
            double length = all[half] / SIZE;
            double got = (moved[half] - still[half]) / (length / fabs(cos(0.1235)));
            if (fabs(got - want) > 0.1)
                fail_msg("jitter %g,%g, %s: edge moved by %g pixels, expected %g",
                         (double)jitters[i][0], (double)jitters[i][1], half ? "SDF" : "box", got,
                         want);
        }
    }
    close_session(&s);
}

static float half_float(uint16_t bits) {
    float value = bits & 0x7C00u
                      ? ldexpf((float)((bits & 0x3FFu) | 0x400u), (int)(bits >> 10 & 31u) - 25)
                      : ldexpf((float)(bits & 0x3FFu), -24);
    return bits & 0x8000u ? -value : value;
}

static void velocities_hold_the_jitter(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("test_truth", SIZE, SIZE);
    d.desc.rung_count = 1;
    d.desc.readback = MASU_READBACK_VELOCITY;
    open_session(&s, &d);
    masu_camera camera = rolled(0.3);
    masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera};
    masu_commands commands;
    masu_readback_image image;
    draw(&s, &f, &commands, NULL);
    camera.jitter[0] = 0.5f, camera.jitter[1] = -0.25f;
    draw(&s, &f, &commands, NULL);
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_VELOCITY, &image, NULL),
                     MASU_OK);
    for (uint32_t p = 0; p < PIXELS; p++) {
        uint16_t v[4];
        memcpy(v, (const uint8_t *)image.pixels + image.row_bytes * (p / SIZE) + 8 * (p % SIZE),
               sizeof v);
        assert_true(half_float(v[3]) == 1.0f);
        assert_true(fabsf(half_float(v[0]) - 0.5f) < 2e-3f);
        assert_true(fabsf(half_float(v[1]) + 0.25f) < 2e-3f);
    }
    camera.jitter[0] = 1.01f;
    assert_int_equal(masu_frame(s.m, &f, &commands, NULL), MASU_ERROR_ARGUMENT);
    camera.jitter[0] = nanf("");
    assert_int_equal(masu_frame(s.m, &f, &commands, NULL), MASU_ERROR_ARGUMENT);
    close_session(&s);
}

/* Along an axis 64 samples are exact to half of a 64th, along other directions to four 64ths at
 * worst, plus the snapping of the raster. */
static void an_edge_is_as_wide_as_it_covers(void **state) {
    (void)state;
    static const double angles[] = {0, 0.12, 0.5, 0.785398, 1.570796};
    masu_session s;
    open_truth(&s);
    /* Steps of the raster in 64ths of a pixel: a vertex moves by up to one. */
    double grid = ldexp(64.0, -(int)s.host.properties.limits.subPixelPrecisionBits);
    for (size_t i = 0; i < sizeof angles / sizeof *angles;
         i += long_run() ? 1 : 2) { /* at least both axes */
        char error[ERROR_SIZE];
        double x[3], y[3], worst[2] = {0, 0}, sum[2] = {0, 0}, count[2] = {0, 0}, white = 0;
        plane_of(angles[i], x, y);
        masu_camera camera = rolled(angles[i]);
        masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera};
        assert_ok(masu_picture_truth(&s, &f, PLACES, 1, &(masu_picture_means){.linear = radiance},
                                     NULL, error, sizeof error));
        for (uint32_t p = 0; p < PIXELS; p++)
            white = fmax(white, (double)radiance[3 * p + 1]);
        assert_true(white > 0.01);
        for (uint32_t p = 0; p < PIXELS; p++) {
            double v = at(y, p % SIZE + 0.5, p / SIZE + 0.5);
            double covered = share(x, p % SIZE, p / SIZE);
            if (fabs(v) < 3 * hypot(y[0], y[1])) continue;
            double off = (double)radiance[3 * p + 1] / white - covered;
            worst[v < 0] = fmax(worst[v < 0], fabs(off));
            if (covered > 1e-6 && covered < 1 - 1e-6) sum[v < 0] += off * off, count[v < 0]++;
        }
        int axis = i == 0 || i == 4;
        for (int half = 0; half < 2; half++) {
            double rms = sqrt(sum[half] / fmax(count[half], 1));
            print_message("  angle %.2f, %s: worst %.2f/64, rms %.2f/64 of %g pixels\n", angles[i],
                          half ? "SDF" : "box", 64 * worst[half], 64 * rms, count[half]);
            assert_true(count[half] > SIZE / 4);
            double snapped = half ? 0.0 : grid;
            assert_true(64 * worst[half] < (axis ? 1.5 : 5.0) + snapped);
            assert_true(64 * rms < (axis ? 1.5 : 2.5) + snapped);
        }
    }
    close_session(&s);
}

/* A surface four times as bright as white: the mean of linear light keeps what a mean of display
 * light would have clipped. */
static void light_beyond_white_is_averaged_before_clipping(void **state) {
    (void)state;
    enum { BRIGHT = 4 };
    masu_session s;
    masu_light light;
    char error[ERROR_SIZE];
    masu_session_desc d = test_desc("test_truth", SIZE, SIZE);
    d.desc.tone = MASU_TONE_NONE;
    assert_ok(masu_picture_open(&d, PLACES, &s, error, sizeof error));
    double grid = ldexp(64.0, -(int)s.host.properties.limits.subPixelPrecisionBits), x[3], y[3],
           white = 0;
    plane_of(0.12, x, y);
    masu_camera camera = rolled(0.12);
    assert_int_equal(masu_light_of(s.m, &light, NULL), MASU_OK);
    masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .light = &light};
    const masu_picture_means means = {.linear = radiance, .display = picture};
    for (int pass = 0; pass < 2; pass++) { /* the first pass finds the surface's radiance */
        assert_ok(
            masu_picture_truth(&s, &f, pass ? PLACES : 1, 1, &means, NULL, error, sizeof error));
        if (pass) break;
        for (uint32_t p = 0; p < PIXELS; p++) white = fmax(white, (double)radiance[3 * p + 1]);
        assert_true(white > 0.01);
        light.exposure = (float)(BRIGHT / white);
    }
    uint32_t counted = 0;
    for (uint32_t p = 0; p < PIXELS; p++) {
        double v = at(y, p % SIZE + 0.5, p / SIZE + 0.5), covered = share(x, p % SIZE, p / SIZE);
        if (fabs(v) < 3 * hypot(y[0], y[1])) continue;
        double slack = (5.0 + (v > 0 ? grid : 0.0)) / 64;
        double shown = (double)masu_srgb_decoded(picture[4 * p + 1]);
        assert_true(fabs((double)radiance[3 * p + 1] / white - covered) < slack);
        assert_true(fabs(shown - covered) < slack + 0.01);
        counted += covered > 0.05 && covered < 0.95;
    }
    close_session(&s);
    print_message("  %u pixels partly covered\n", counted);
    assert_true(counted > SIZE / 4);
}

/* measure/linear.c equals the pass of the tone curve, to one step of rounding. */
static void tone_curves_are_those_of_the_pass(void **state) {
    (void)state;
    static const masu_tone tones[] = {MASU_TONE_ACES, MASU_TONE_NEUTRAL};
    static uint8_t shown[4 * PIXELS];
    static float linear[3 * PIXELS];
    for (size_t t = 0; t < sizeof tones / sizeof *tones; t++) {
        masu_session s;
        masu_session_desc d = test_desc("test_truth", SIZE, SIZE);
        d.desc.tone = tones[t];
        d.desc.readback = MASU_READBACK_HDR;
        d.desc.rung_count = 1;
        open_session(&s, &d);
        masu_light light = {.sun_direction = {0, 1, 0},
                            .sky_zenith = {0.1f, 0.6f, 8},
                            .sky_horizon = {3, 0.6f, 0.02f}};
        masu_camera camera = {.forward = {0, 0.6f, 1}, .fov_y = 1.2f, .near_distance = 0.1f};
        int steps = 0;
        for (light.exposure = 0.25f; light.exposure < 5.0f; light.exposure *= 4.0f) {
            masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .light = &light, .cut = 1};
            masu_commands commands;
            draw(&s, &f, &commands, picture);
            assert_true(masu_linear_read(s.m, commands.slot, s.desc.output, linear));
            masu_linear_show(&s, linear, PIXELS, masu_linear_exposure(&s, commands.slot, &light),
                             linear);
            masu_srgb_encode(linear, PIXELS, shown);
            for (uint32_t p = 0; p < 4 * PIXELS; p++) {
                int off = abs((int)shown[p] - (int)picture[p]);
                steps = off > steps ? off : steps;
            }
        }
        close_session(&s);
        assert_true(steps <= 1);
    }
}

/* Whether a neighbour across an edge with that normal is outside the image. */
static int on_rim(uint32_t p, const double normal[2]) {
    uint32_t x = p % SIZE, y = p / SIZE;
    int steep = fabs(normal[0]) > fabs(normal[1]);
    return steep ? x == 0 || x == SIZE - 1 : y == 0 || y == SIZE - 1;
}

/* rung.silhouettes: the SDF's edge is as good as with four samples per pixel: an error of 0.1 of a
 * pixel instead of 0.25, and no worse at the one angle and position at which a single sample is
 * exact for all pixels of an edge. Polygon edges are unchanged. */
static void a_silhouette_is_as_wide_as_it_covers(int bright) {
    static const double angles[] = {0, 0.02, 0.12, 0.5, 0.785398, 1.2, 1.570796, 2.5};
    static const float jitters[][2] = {{0, 0}, {0.4f, -0.3f}};
    static uint8_t plain[4 * PIXELS];
    masu_session s;
    masu_session_desc d = test_desc("test_truth", SIZE, SIZE);
    d.desc.rung_count = 2;
    d.desc.rungs[0] = (masu_rung){.silhouettes = MASU_ON};
    d.desc.rungs[1] = (masu_rung){.silhouettes = MASU_OFF};
    if (bright) d.desc.tone = MASU_TONE_NONE;
    masu_light light = {
        .sun_direction = {0, 1, 0}, .sky_zenith = {30, 30, 30}, .sky_horizon = {30, 30, 30}};
    open_session(&s, &d);
    for (size_t i = 0; i < sizeof angles / sizeof *angles; i += long_run() ? 1 : 2) {
        for (size_t j = 0; j < sizeof jitters / sizeof *jitters; j++) {
            double x[3], y[3], worst = 0, sum = 0, before = 0, count = 0, white = 0;
            plane_of(angles[i], x, y);
            masu_camera camera = rolled(angles[i]);
            memcpy(camera.jitter, jitters[j], sizeof camera.jitter);
            x[2] += (double)jitters[j][0] * x[0] + (double)jitters[j][1] * x[1];
            y[2] += (double)jitters[j][0] * y[0] + (double)jitters[j][1] * y[1];
            masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera,
                                 .light = bright ? &light : NULL, .cut = 1};
            masu_commands commands;
            draw(&s, &f, &commands, picture);
            f.rung = 1;
            draw(&s, &f, &commands, plain);
            double dark = 1;
            for (uint32_t p = 0; p < PIXELS; p++) {
                white = fmax(white, (double)masu_srgb_decoded(plain[4 * p + 1]));
                dark = fmin(dark, (double)masu_srgb_decoded(plain[4 * p + 1]));
            }
            assert_true(white - dark > 0.2);
            for (uint32_t p = 0; p < PIXELS; p++) {
                double v = at(y, p % SIZE + 0.5, p / SIZE + 0.5);
                double covered = share(x, p % SIZE, p / SIZE);
                if (fabs(v) < 3 * hypot(y[0], y[1])) continue;
                int edge = covered > 1e-6 && covered < 1 - 1e-6;
                if (v > 0 || !edge) { /* a box, or inside a surface */
                    assert_int_equal(picture[4 * p + 1], plain[4 * p + 1]);
                    continue;
                }
                double shown =
                    ((double)masu_srgb_decoded(picture[4 * p + 1]) - dark) / (white - dark);
                double alone =
                    ((double)masu_srgb_decoded(plain[4 * p + 1]) - dark) / (white - dark);
                double off = (bright ? 1 - shown : shown) - covered;
                double was = (bright ? 1 - alone : alone) - covered;
                if (on_rim(p, x)) { /* the determining side of the edge may be outside the image */
                    assert_true(fabs(off) < fabs(was) + 0.04);
                    continue;
                }
                worst = fmax(worst, fabs(off));
                sum += off * off, before += was * was, count++;
            }
            print_message("  angle %.2f, jitter %g: worst %.3f, rms %.3f of a pixel, without %.3f, "
                          "%g pixels\n",
                          angles[i], (double)jitters[j][0], worst, sqrt(sum / fmax(count, 1)),
                          sqrt(before / fmax(count, 1)), count);
            assert_true(count > SIZE / 4);
            assert_true(worst < 0.4 && sqrt(sum / count) < 0.16 && sum < before * 1.01);
        }
    }
    close_session(&s);
}

static uint64_t sum_of(const uint8_t *pixels) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < 4 * PIXELS; i++) sum += pixels[i];
    return sum;
}

static void silhouettes_before_the_dark(void **state) {
    (void)state;
    a_silhouette_is_as_wide_as_it_covers(0);
}

/* A surface thirty times as bright as white is shown as white, and its coverage is not larger. */
static void silhouettes_before_what_is_too_bright(void **state) {
    (void)state;
    a_silhouette_is_as_wide_as_it_covers(1);
}

/* Auto-exposure applies to the samples of the field as well; with and without a tone curve; memory
 * that is not yet written must not be read. */
static void silhouettes_stand_beside_everything_else(void **state) {
    (void)state;
    static const masu_tone tones[] = {MASU_TONE_NONE, MASU_TONE_ACES};
    static uint8_t plain[4 * PIXELS];
    for (uint32_t i = 0; i < 8; i++) {
        /* every two settings together are still covered */
        if (!long_run() && (i ^ i >> 1 ^ i >> 2) & 1) continue;
        masu_session s;
        masu_session_desc d = test_desc(i & 1 ? "spheres" : "test_both", SIZE, SIZE);
        d.desc.rung_count = 2;
        d.desc.rungs[0] = (masu_rung){.silhouettes = MASU_ON, .scale = i & 4 ? 0.7f : 1.0f};
        d.desc.rungs[1] = (masu_rung){.silhouettes = MASU_OFF, .scale = i & 4 ? 0.7f : 1.0f};
        d.desc.tone = tones[i >> 1 & 1];
        d.desc.exposure.metered = MASU_ON;
        d.desc.debug.counters = 1;
        d.desc.debug.poison = 1;
        open_session(&s, &d);
        masu_frame_desc f = {MASU_FRAME_DESC, .cut = 1};
        masu_commands commands;
        draw(&s, &f, &commands, picture);
        uint64_t with = stats_of(&s, commands.slot).sdf_evals;
        f.rung = 1;
        draw(&s, &f, &commands, plain);
        uint64_t without = stats_of(&s, commands.slot).sdf_evals;
        assert_true(with > without && with < without + 16 * PIXELS);
        assert_memory_not_equal(picture, plain, sizeof plain);
        double ratio = (double)sum_of(picture) / (double)sum_of(plain);
        assert_true(ratio > 0.99 && ratio < 1.01);
        close_session(&s);
    }
}

/* A ray can hit a surface that no adjacent pixel shows: it must not be lit by texels that were not
 * written. */
static void silhouettes_read_what_was_written(void **state) {
    (void)state;
    static uint8_t poisoned[4 * PIXELS];
    for (uint32_t poison = 0; poison < 2; poison++) {
        masu_session s;
        masu_session_desc d = test_desc("rods", SIZE, SIZE);
        d.desc.rung_count = 1;
        d.desc.rungs[0] = (masu_rung){.silhouettes = MASU_ON};
        d.desc.debug.poison = poison;
        open_session(&s, &d);
        masu_frame_desc f = {MASU_FRAME_DESC, .time = 0.8, .cut = 1};
        masu_commands commands;
        draw(&s, &f, &commands, poison ? poisoned : picture);
        close_session(&s);
    }
    assert_memory_equal(picture, poisoned, sizeof poisoned);
}

/* Most of an image has a lower error with silhouettes: for each pixel whose error grows by 16 of
 * 255 there are fifty whose error falls by as much. Rods are metal, and reflect by their own
 * normal. */
static void silhouettes_go_towards_the_truth(void **state) {
    (void)state;
    static const char *const scenes[] = {"city", "tunnel", "rods"};
    static uint8_t truth[4 * PIXELS], plain[4 * PIXELS];
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        masu_session s;
        char error[ERROR_SIZE];
        masu_frame_desc f = {MASU_FRAME_DESC, .time = 0.8, .cut = 1};
        masu_session_desc d = test_desc(scenes[i], SIZE, SIZE);
        assert_ok(masu_picture_open(&d, 16, &s, error, sizeof error));
        assert_true(masu_picture_truth(&s, &f, 16, 16, &(masu_picture_means){.display = truth},
                                       NULL, error, sizeof error));
        close_session(&s);
        d.desc.rung_count = 2;
        d.desc.rungs[0] = (masu_rung){.silhouettes = MASU_ON};
        d.desc.rungs[1] = (masu_rung){.silhouettes = MASU_OFF};
        open_session(&s, &d);
        masu_commands commands;
        draw(&s, &f, &commands, picture);
        f.rung = 1;
        draw(&s, &f, &commands, plain);
        close_session(&s);
        uint32_t nearer = 0, farther = 0;
        for (uint32_t p = 0; p < 4 * PIXELS; p += 4) {
            uint32_t with = max_difference(picture + p, truth + p, 3),
                     without = max_difference(plain + p, truth + p, 3);
            nearer += with + 16 < without, farther += with > without + 16;
        }
        print_message("  %s: %u pixels with a lower error, %u with a higher one\n",
                      scenes[i], nearer, farther);
        assert_true(nearer > 100 && 50 * farther < nearer);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_even),
        cmocka_unit_test(eight_bits_come_back),
        cmocka_unit_test(a_jitter_moves_all_alike),
        cmocka_unit_test(velocities_hold_the_jitter),
        cmocka_unit_test(an_edge_is_as_wide_as_it_covers),
        cmocka_unit_test(light_beyond_white_is_averaged_before_clipping),
        cmocka_unit_test(tone_curves_are_those_of_the_pass),
        cmocka_unit_test(silhouettes_before_the_dark),
        cmocka_unit_test(silhouettes_before_what_is_too_bright),
        cmocka_unit_test(silhouettes_stand_beside_everything_else),
        cmocka_unit_test(silhouettes_read_what_was_written),
        cmocka_unit_test(silhouettes_go_towards_the_truth),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
