/* test_environment.c: environment maps from images: formats that masu-bake accepts and rejects,
 * texel encoding, and the blurred mips and the irradiance against integrals over the image in
 * double precision. The bounds are the measured errors, rounded up. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "bake/light/environment.h"
#include "bake/light/picture_light.h"
#include "bake/light/picture_sun.h"
#include "cli/cli.h"
#include "image.h"
#include "support/files.h"
#include "support/random.h"

#define PI 3.14159265358979323846
#define WIDE 256u
#define HIGH 128u

/* ---- Images ---------------------------------------------------------------------------------- */

static float pixels[WIDE * HIGH * 3];

/* A sky brighter at the horizon, a darker patterned ground, a window of 8 degrees 30 times as bright. */
static void paint(double window) {
    for (uint32_t i = 0; i < WIDE * HIGH; i++) {
        double polar = (i / WIDE + 0.5) / HIGH * PI, turn = (i % WIDE + 0.5) / WIDE * 2 * PI;
        double up = cos(polar);
        const double d[3] = {sin(polar) * cos(turn), up, sin(polar) * sin(turn)};
        int inside = d[0] * 0.8 + d[1] * 0.6 > cos(8 * PI / 180);
        for (uint32_t c = 0; c < 3; c++) {
            double sky = 0.3 + 0.2 * c + 0.5 * exp(-6 * up);
            double soil = 0.15 + (2.0 - c) * 0.05 * (1 + sin(8 * turn) * sin(polar));
            pixels[3 * i + c] = (float)((up > 0 ? sky : soil) + (inside ? window : 0));
        }
    }
}

static masu_bake_panorama picture(double turn) {
    return (masu_bake_panorama){
        .width = WIDE, .height = HIGH, .rgb = pixels, .turn = turn, .factor = 1};
}

static const masu_blob_environment_map *bake(const masu_bake_panorama *p, uint32_t size,
                                             masu_bake_content *content) {
    memset(content, 0, sizeof *content);
    masu_bake_add_environment(p, size, content);
    return (const masu_blob_environment_map *)(const void *)
        content->section[MASU_BLOB_ENVIRONMENT_MAP].data;
}

static const uint32_t *texels_of(const masu_bake_content *content) {
    return (const uint32_t *)(const void *)content->section[MASU_BLOB_ENVIRONMENT_TEXELS].data;
}

static void forget(masu_bake_content *content) {
    free(content->section[MASU_BLOB_ENVIRONMENT_MAP].data);
    free(content->section[MASU_BLOB_ENVIRONMENT_TEXELS].data);
    memset(content, 0, sizeof *content);
}

enum { LOOKS = 30 };

static void some_normal(int i, int count, double out[3]) {
    double y = 1 - (2 * i + 1.0) / count, a = 2.399963 * i, flat = sqrt(1 - y * y);
    out[0] = flat * cos(a);
    out[1] = y;
    out[2] = flat * sin(a);
}

/* Averages over GGX lobes around up to LOOKS normals, viewed along each, weighted by the cosine. */
static void integrate(const masu_bake_panorama *p, int count, double n[][3], double roughness,
                      double out[][3]) {
    double a2 = pow(roughness, 4), weight[LOOKS] = {0};
    const uint32_t rows = roughness < 0.35 ? 512 : 192, columns = 2 * rows;
    memset(out, 0, (size_t)count * sizeof *out);
    for (uint32_t y = 0; y < rows; y++) {
        double up = cos(PI * (y + 0.5) / rows), flat = sqrt(1 - up * up);
        for (uint32_t x = 0; x < columns; x++) {
            double turn = 2 * PI * (x + 0.5) / columns, light[3];
            const double d[3] = {flat * sin(turn), up, flat * cos(turn)};
            masu_bake_panorama_at(p, d, light);
            for (int i = 0; i < count; i++) {
                double cosine = d[0] * n[i][0] + d[1] * n[i][1] + d[2] * n[i][2];
                if (cosine <= 0) continue;
                double k = (1 + cosine) / 2 * (a2 - 1) + 1, w = flat * cosine / (k * k);
                weight[i] += w;
                for (int c = 0; c < 3; c++) out[i][c] += w * light[c];
            }
        }
    }
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) out[i][c] /= weight[i];
}

/* RMS over directions and colours relative to the image's mean. */
static double error_at(const masu_bake_panorama *p, const masu_blob_environment_map *map,
                       const uint32_t *texels, double roughness) {
    double square = 0, mean = 0, n[LOOKS][3], truth[LOOKS][3], got[3];
    for (int i = 0; i < LOOKS; i++) some_normal(i, LOOKS, n[i]);
    integrate(p, LOOKS, n, roughness, truth);
    for (int i = 0; i < LOOKS; i++) {
        masu_bake_environment_at(map, texels, n[i], roughness, got);
        for (int c = 0; c < 3; c++) {
            square += pow(got[c] - truth[i][c], 2) / (3 * LOOKS);
            mean += truth[i][c] / (3 * LOOKS);
        }
    }
    return sqrt(square) / mean;
}

static void mips_are_the_picture_averaged_by_the_lobe(void **state) {
    (void)state;
    static const struct {
        double window, between, at[2], rest;
    } cases[] = {{0, 0, {0.006, 0.026}, 0.055}, {30, 0, {0.02, 0.06}, 0.22}};
    /* the harder case */
    for (size_t i = whole_run() ? 0 : 1; i < sizeof cases / sizeof *cases; i++) {
        masu_bake_content content;
        paint(cases[i].window);
        masu_bake_panorama p = picture(0.4);
        const masu_blob_environment_map *map = bake(&p, 256, &content);
        assert_int_equal(map->mips, 6);
        for (uint32_t mip = 1; mip < map->mips; mip++) {
            double r = (double)mip / (map->mips - 1);
            double at = error_at(&p, map, texels_of(&content), r);
            double between = error_at(&p, map, texels_of(&content), r - 0.1);
            print_message("window %g: roughness %.1f error %.4f of the mean, %.1f error %.4f\n",
                          cases[i].window, r, at, r - 0.1, between);
            assert_true(at <= cases[i].at[mip > 1]);
            assert_true(between <= cases[i].rest);
        }
        forget(&content);
    }
}

/* Irradiance / pi at normals, from the pixels. */
enum { COUNT = 40 };

static void light_on(const masu_bake_panorama *p, double normals[COUNT][3], double out[COUNT][3]) {
    memset(out, 0, COUNT * sizeof *out);
    for (int k = 0; k < COUNT; k++) some_normal(k, COUNT, normals[k]);
    for (uint32_t i = 0; i < p->width * p->height; i++) {
        double d[3], solid_angle;
        masu_bake_panorama_pixel(p, i % p->width, i / p->width, d, &solid_angle);
        for (int k = 0; k < COUNT; k++) {
            const double *n = normals[k];
            double cosine = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
            if (!(cosine > 0)) continue;
            for (int c = 0; c < 3; c++)
                out[k][c] += cosine * solid_angle / PI * (double)p->rgb[3 * i + (uint32_t)c];
        }
    }
}

/* Relative RMS over normals of the irradiance from sun and coefficients, against the image with its
 * sun. */
static double irradiance_error(const masu_bake_panorama *whole, const masu_bake_picture_sun *sun,
                               const masu_blob_environment_map *map) {
    double normals[COUNT][3], truth[COUNT][3], square = 0;
    light_on(whole, normals, truth);
    for (int i = 0; i < COUNT; i++) {
        double got[3], facing = 0;
        const double *n = normals[i];
        masu_bake_irradiance_at(map, n, got);
        for (int k = 0; k < 3; k++) facing += n[k] * sun->direction[k];
        for (int c = 0; c < 3; c++) {
            got[c] += fmax(facing, 0) * sun->color[c];
            assert_true(isfinite(got[c]));
            if (truth[i][c] > 0) square += pow(got[c] / truth[i][c] - 1, 2) / (3 * COUNT);
        }
    }
    return sqrt(square);
}

/* The image as painted, before its sun is removed. */
static float whole_pixels[WIDE * HIGH * 3];

/* Removes the sun of the painted image, if there is one, and fits the rest. */
static int cut_and_fit(double turn, masu_bake_picture_sun *sun, double *error) {
    masu_blob_environment_map map;
    masu_bake_panorama p = picture(turn), whole = p;
    memcpy(whole_pixels, pixels, sizeof pixels);
    memset(sun, 0, sizeof *sun);
    whole.rgb = whole_pixels;
    int found = masu_bake_cut_sun(&p, sun);
    masu_bake_fit_irradiance(&p, &map);
    *error = irradiance_error(&whole, sun, &map);
    return found;
}

/* Adds a disc of constant radiance; angles in degrees, azimuths of an unrotated image. */
static void add_disc(double azimuth, double elevation, double radius, double light) {
    double e = elevation * PI / 180, a = azimuth * PI / 180;
    const double to[3] = {cos(e) * sin(a), sin(e), cos(e) * cos(a)};
    masu_bake_panorama p = picture(0);
    for (uint32_t i = 0; i < WIDE * HIGH; i++) {
        double d[3], solid_angle;
        masu_bake_panorama_pixel(&p, i % WIDE, i / WIDE, d, &solid_angle);
        if (d[0] * to[0] + d[1] * to[1] + d[2] * to[2] < cos(radius * PI / 180)) continue;
        for (int c = 0; c < 3; c++) pixels[3 * i + (uint32_t)c] += (float)(light * (1 - 0.2 * c));
    }
}

/* Order 2 by itself has errors of 0.4 and 5.3 %, and of 47 % with two lamps over little light. */
static void irradiance_is_that_of_the_picture(void **state) {
    (void)state;
    static const struct {
        double window, bound;
    } cases[] = {{0, 0.003}, {30, 0.025}};
    masu_bake_picture_sun sun;
    double error;
    for (int i = 0; i < 2; i++) {
        paint(cases[i].window);
        assert_false(cut_and_fit(-1, &sun, &error));
        print_message("window %g: relative irradiance error %.4f\n", cases[i].window, error);
        assert_true(error <= cases[i].bound);
    }
    for (uint32_t i = 0; i < WIDE * HIGH * 3; i++) pixels[i] = 0.02f;
    add_disc(90, 20, 8, 30);
    add_disc(-140, 35, 5, 70);
    assert_false(cut_and_fit(0, &sun, &error));
    print_message("two lamps: relative irradiance error %.4f\n", error);
    assert_true(error <= 0.35);
}

/* At any position: the zenith and the nadir, across the image's edge, below the horizon, and with a
 * second sun next to it, which is kept in the image. */
static void a_sun_is_cut_out_of_the_picture(void **state) {
    (void)state;
    static const struct {
        double azimuth, elevation, turn, second, bound;
    } cases[] = {{40, 35, 0, 0, 0.01},  {0, 90, 0, 0, 0.01},     {10, -89.6, 0, 0, 0.01},
                 {180, 10, 0, 0, 0.01}, {179.5, 60, 2, 0, 0.01}, {-70, -20, -3, 0, 0.01},
                 {90, 0.2, 1, 0, 0.01}, {40, 50, 0, 6000, 0.08}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i += whole_run() ? 1 : 3) {
        masu_bake_picture_sun sun;
        double error, off = 0, most = 0;
        double e = cases[i].elevation * PI / 180, a = cases[i].azimuth * PI / 180 + cases[i].turn;
        const double to[3] = {cos(e) * sin(a), sin(e), cos(e) * cos(a)};
        paint(0);
        add_disc(cases[i].azimuth, cases[i].elevation, 1.1, 9000);
        if (cases[i].second > 0) add_disc(-100, 25, 1.1, cases[i].second);
        assert_true(cut_and_fit(cases[i].turn, &sun, &error));
        for (int k = 0; k < 3; k++) off += pow(sun.direction[k] - to[k], 2);
        for (uint32_t k = 0; k < WIDE * HIGH * 3; k++) most = fmax(most, (double)pixels[k]);
        print_message("sun %zu: %.2f degrees off, irradiance %.4f, brightest left %.2f\n", i,
                      sqrt(off) * 180 / PI, error, most);
        assert_true(sqrt(off) < 1 * PI / 180); /* a pixel is 1.4 degrees */
        assert_true(error <= cases[i].bound);
        assert_true(cases[i].second > 0 ? most > 5000 : most < 3);
    }
}

/* Images without a sun: black, uniform, a source that is too large or too weak, too few pixels.
 * They are unchanged. */
static void what_is_no_sun_stays_in_the_picture(void **state) {
    (void)state;
    static const struct {
        double sky, radius, light;
    } cases[] = {{0, 0, 0}, {1, 0, 0}, {0.2, 4, 500}, {0.5, 1.1, 100}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_bake_picture_sun sun;
        double error;
        for (uint32_t k = 0; k < WIDE * HIGH * 3; k++) pixels[k] = (float)cases[i].sky;
        if (cases[i].radius > 0) add_disc(20, 30, cases[i].radius, cases[i].light);
        if (cut_and_fit(0, &sun, &error)) fail_msg("case %zu has a sun", i);
        assert_memory_equal(pixels, whole_pixels, sizeof pixels);
    }
    for (uint32_t width = 1; width <= 64; width *= 4) {
        static float few[64 * 64 * 3], before[64 * 64 * 3];
        masu_blob_environment_map map;
        for (size_t k = 0; k < 64 * 64 * 3; k++) few[k] = before[k] = k < 3 ? 7 : 0.1f;
        masu_bake_panorama p = {.width = width, .height = width, .rgb = few, .factor = 1};
        masu_bake_picture_sun sun;
        assert_false(masu_bake_cut_sun(&p, &sun));
        assert_memory_equal(few, before, sizeof few);
        masu_bake_fit_irradiance(&p, &map);
        double n[12][3], got[3], truth[12][3];
        for (int i = 0; i < 12; i++) some_normal(i, 12, n[i]);
        integrate(&p, 12, n, 1, truth);
        for (int i = 0; i < 12; i++) {
            masu_bake_irradiance_at(&map, n[i], got);
            if (!(fabs(got[0] / truth[i][0] - 1) < 0.15))
                fail_msg("%ux%u: %g instead of %g", width, width, got[0], truth[i][0]);
        }
    }
}

/* A black image has coefficients of 0; radiances near the limit of floats give finite
 * coefficients. */
static void no_picture_gives_coefficients_that_are_not_finite(void **state) {
    (void)state;
    for (int bright = 0; bright < 2; bright++) {
        masu_blob_environment_map map;
        float rgb[3 * 8];
        for (int i = 0; i < 3 * 8; i++) rgb[i] = bright ? 3e38f : 0;
        masu_bake_panorama p = {.width = 4, .height = 2, .rgb = rgb, .factor = bright ? 1e6 : 1};
        masu_bake_fit_irradiance(&p, &map);
        for (int k = 0; k < 36; k++) {
            assert_true(isfinite(map.sh[k / 4][k % 4]));
            if (!bright) assert_true(map.sh[k / 4][k % 4] == 0);
        }
    }
    for (uint32_t k = 0; k < WIDE * HIGH * 3; k++) pixels[k] = 1e-30f;
    add_disc(20, 30, 1.1, 1e38);
    masu_bake_panorama p = picture(0);
    masu_bake_picture_sun sun;
    p.factor = 1e6;
    assert_true(masu_bake_cut_sun(&p, &sun));
    for (int c = 0; c < 3; c++) assert_true(isfinite(sun.color[c]) && sun.color[c] <= 1e6);
}

/* ---- Texels ---------------------------------------------------------------------------------- */

static void texels_hold_nine_bits(void **state) {
    (void)state;
    uint64_t random = 3;
    for (uint32_t i = 0; i < trials(100000, 100000, 10000); i++) {
        double v[3], got[3], most = 0;
        for (int c = 0; c < 3; c++) {
            v[c] = ldexp((double)support_random_in(&random, 0, 1 << 20), (int)(random % 30) - 34);
            most = fmax(most, v[c]);
        }
        masu_bake_unpack_9995(masu_bake_pack_9995(v), got);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(got[c] - v[c]) <= most / 510 + ldexp(1, -25));
        uint32_t word = (uint32_t)support_random(&random);
        masu_bake_unpack_9995(word, got);
        for (int c = 0; c < 3; c++) assert_true(got[c] >= 0 && got[c] <= 65408);
        double again[3];
        masu_bake_unpack_9995(masu_bake_pack_9995(got), again);
        assert_memory_equal(got, again, sizeof got);
    }
}

static char heard[256];

static void hear(void *user, const char *text) {
    (void)user;
    snprintf(heard, sizeof heard, "%s", text);
}

/* A texel holds radiances up to 65408; larger ones are clamped and reported. */
static void what_no_texel_holds_is_told(void **state) {
    (void)state;
    float rgb[3 * 8];
    for (int i = 0; i < 3 * 8; i++) rgb[i] = 1;
    rgb[4] = 70000;
    masu_bake_panorama p = {.width = 4, .height = 2, .rgb = rgb, .factor = 1, .name = "sun.hdr"};
    masu_bake_content content = {0};
    masu_cli_hear_warnings(hear, NULL);
    masu_bake_add_environment(&p, 8, &content);
    if (!strstr(heard, "sun.hdr: 1 of 8 pixels are above 65408: clamped (the largest is 70000)"))
        fail_msg("heard: %s", heard);
    heard[0] = '\0';
    p.factor = 0.5;
    forget(&content);
    masu_bake_add_environment(&p, 8, &content);
    masu_cli_hear_warnings(NULL, NULL);
    assert_string_equal(heard, "");
    forget(&content);
}

static void a_square_covers_all_directions(void **state) {
    (void)state;
    for (int i = 0; i < 1000; i++) {
        double d[3];
        masu_bake_octahedral((i % 33 + 0.5) / 33, (i / 33 + 0.5) / 33, d);
        assert_true(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-12);
    }
    double up[3], down[3];
    masu_bake_octahedral(0.5, 0.5, up);
    masu_bake_octahedral(0, 0, down);
    assert_true(fabs(up[1] - 1) < 1e-12);
    assert_true(fabs(down[1] + 1) < 1e-12);
}

/* The centre of the image is at the azimuth of its rotation; the azimuth falls to the right. */
static void a_picture_is_turned_and_scaled(void **state) {
    (void)state;
    memset(pixels, 0, sizeof pixels);
    for (uint32_t x = WIDE / 2; x < WIDE / 2 + 8; x++) pixels[3 * (HIGH / 2 * WIDE + x)] = 1;
    masu_bake_panorama p = picture(PI / 2);
    double light[3];
    p.factor = 3;
    masu_bake_panorama_at(&p, (const double[3]){1, -0.0123, 0.05}, light);
    assert_true(light[0] > 2.5 && light[1] == 0);
    masu_bake_panorama_at(&p, (const double[3]){1, -0.0123, -0.05}, light);
    assert_true(light[0] == 0);
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* RGBE: 10x2 pixels of (0.5, 0.25, 2^-8), in runs or not. */
static size_t write_rgbe(uint8_t *out, int runs) {
    static const uint8_t pixel[4] = {128, 64, 1, 128};
    const char *head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 10\n";
    size_t n = strlen(head);
    memcpy(out, head, n);
    for (int row = 0; row < 2; row++) {
        if (!runs) {
            for (int i = 0; i < 40; i++) out[n++] = pixel[i % 4];
            continue;
        }
        out[n++] = 2, out[n++] = 2, out[n++] = 0, out[n++] = 10;
        for (int c = 0; c < 4; c++) {
            out[n++] = 128 + 7, out[n++] = pixel[c];
            out[n++] = 3;
            for (int i = 0; i < 3; i++) out[n++] = pixel[c];
        }
    }
    return n;
}

static int loads(const uint8_t *bytes, size_t n, masu_bake_panorama *p) {
    const char *path = write_bytes("a.hdr", bytes, n);
    int good = masu_bake_load_panorama(path, p);
    unlink(path);
    return good;
}

static void radiance_files_are_read_and_damaged_ones_refused(void **state) {
    (void)state;
    for (int runs = 0; runs < 2; runs++) {
        uint8_t bytes[512], cut[512];
        masu_bake_panorama p;
        size_t n = write_rgbe(bytes, runs);
        assert_true(loads(bytes, n, &p));
        assert_int_equal(p.width, 10);
        assert_int_equal(p.height, 2);
        for (int i = 0; i < 20; i++) {
            assert_true(p.rgb[3 * i] == 0.5f && p.rgb[3 * i + 1] == 0.25f);
            assert_true(p.rgb[3 * i + 2] == 0.00390625f);
        }
        free(p.rgb);
        for (size_t k = 0; k < n; k++) assert_false(loads(bytes, k, &p));
        uint64_t random = 11;
        for (int i = 0; i < 500; i++) { /* any byte changed: read or rejected */
            memcpy(cut, bytes, n);
            cut[support_random(&random) % n] = (uint8_t)support_random(&random);
            if (loads(cut, n, &p)) free(p.rgb);
        }
    }
}

static void pfm_files_are_read_and_what_is_no_light_refused(void **state) {
    (void)state;
    char error[256];
    masu_bake_panorama p;
    float rgb[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    const char *path = in_scratch("a.pfm");
    assert_true(masu_image_save_pfm(path, rgb, 2, 2, 3, error, sizeof error));
    assert_true(masu_bake_load_panorama(path, &p));
    assert_memory_equal(p.rgb, rgb, sizeof rgb);
    free(p.rgb);
    static const float bad[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        rgb[7] = bad[i];
        assert_true(masu_image_save_pfm(path, rgb, 2, 2, 3, error, sizeof error));
        assert_false(masu_bake_load_panorama(path, &p));
    }
    unlink(path);
    assert_false(masu_bake_load_panorama(in_scratch("a.exr"), &p));
    assert_false(masu_bake_load_panorama(in_scratch("none.hdr"), &p));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mips_are_the_picture_averaged_by_the_lobe),
        cmocka_unit_test(irradiance_is_that_of_the_picture),
        cmocka_unit_test(a_sun_is_cut_out_of_the_picture),
        cmocka_unit_test(what_is_no_sun_stays_in_the_picture),
        cmocka_unit_test(no_picture_gives_coefficients_that_are_not_finite),
        cmocka_unit_test(texels_hold_nine_bits),
        cmocka_unit_test(what_no_texel_holds_is_told),
        cmocka_unit_test(a_square_covers_all_directions),
        cmocka_unit_test(a_picture_is_turned_and_scaled),
        cmocka_unit_test(radiance_files_are_read_and_damaged_ones_refused),
        cmocka_unit_test(pfm_files_are_read_and_what_is_no_light_refused),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_empty_scratch);
}
