/* test_output.c: values written to targets of every format and encoding; dither; constant images;
 * the error of 8 bits between tone curve and target; invalid input of the colour passes. */
#include "reference/tone.h"
#include "support/support.h"
#include "support/floats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { W = 32, H = 24 };
static masu_session s;

/* A scene with an image of only sky of one colour: viewed from outside, facing away. */
static masu_session_desc sky_desc(uint32_t width, uint32_t height) {
    masu_session_desc d = test_desc("test_sphere_mesh", width, height);
    d.desc.tone = MASU_TONE_NONE;
    d.desc.dither = MASU_OFF;
    d.desc.rung_count = 1;
    return d;
}

static void draw_sky(const float zenith[3], const float horizon[3], uint32_t rung, uint8_t *rgba) {
    static const masu_camera up = {
        .position = {0, 1000, 0}, .forward = {0, 0.5f, 1}, .fov_y = 0.7f};
    masu_light light = {.sun_direction = {0, -1, 0}, .exposure = 1};
    masu_frame_desc frame = {.camera = &up, .light = &light, .rung = rung};
    masu_commands commands;
    char error[ERROR_SIZE];
    memcpy(light.sky_zenith, zenith, sizeof light.sky_zenith);
    memcpy(light.sky_horizon, horizon, sizeof light.sky_horizon);
    draw(&s, &frame, &commands, rgba);
    if (!rgba) assert_ok(masu_headless_target_read(&s.host, &s.targets[0], error, sizeof error));
}

/* ---- Formats --------------------------------------------------------------------------------- */

/* The content of a pixel, each channel as its format reads: 0..1, floats unchanged. sRGB formats as
 * their bytes. */
static void pixel(VkFormat format, const uint8_t *at, double out[3], double step[3]) {
    uint32_t word;
    uint16_t h[4];
    for (int c = 0; c < 3; c++) step[c] = 1.0 / 255;
    switch (format) {
    case VK_FORMAT_R5G6B5_UNORM_PACK16:
    case VK_FORMAT_B5G6R5_UNORM_PACK16: {
        memcpy(h, at, 2);
        int swap = format == VK_FORMAT_B5G6R5_UNORM_PACK16;
        out[swap ? 2 : 0] = (h[0] >> 11) / 31.0, out[1] = (h[0] >> 5 & 63) / 63.0;
        out[swap ? 0 : 2] = (h[0] & 31) / 31.0;
        step[0] = step[2] = 1 / 31.0, step[1] = 1 / 63.0;
        return;
    }
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_A2R10G10B10_UNORM_PACK32: {
        memcpy(&word, at, 4);
        int swap = format == VK_FORMAT_A2R10G10B10_UNORM_PACK32;
        assert_int_equal(word >> 30, 3); /* opaque */
        for (int c = 0; c < 3; c++) {
            out[swap ? 2 - c : c] = (word >> 10 * c & 1023) / 1023.0;
            step[c] = 1 / 1023.0;
        }
        return;
    }
    case VK_FORMAT_R16G16B16A16_UNORM:
        memcpy(h, at, 8);
        for (int c = 0; c < 3; c++) out[c] = h[c] / 65535.0, step[c] = 1 / 2048.0; /* of the half */
        return;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
        memcpy(h, at, 8);
        assert_int_equal(h[3], 0x3C00);
        for (int c = 0; c < 3; c++) {
            out[c] = half_float(h[c]);
            step[c] = fmax(out[c], 1e-4) / 1024; /* for a half; the lit image is one, too */
        }
        return;
    default: {
        int swap = format == VK_FORMAT_B8G8R8A8_UNORM || format == VK_FORMAT_B8G8R8A8_SRGB;
        assert_int_equal(at[3], 255);
        for (int c = 0; c < 3; c++) out[c] = at[swap ? 2 - c : c] / 255.0;
    }
    }
}

static size_t bytes_of(VkFormat format) {
    return format == VK_FORMAT_R5G6B5_UNORM_PACK16 || format == VK_FORMAT_B5G6R5_UNORM_PACK16 ? 2
           : format == VK_FORMAT_R16G16B16A16_UNORM || format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8
                                                                                               : 4;
}

static const float colors[][3] = {{0, 0, 0},          {1, 1, 1},          {0.5f, 0.25f, 0.125f},
                                  {0.002f, 0.01f, 0.9f}, {0.73f, 0.046875f, 0.3f}, {0.21404f, 1, 0},
                                  {6, 2, 0.5f},       {40, 3, 1}};
enum { COLORS = sizeof colors / sizeof *colors };

typedef struct target_case {
    const char *name;
    VkFormat format;
    uint32_t storage;
    masu_encoding encoding;
} target_case;

static const target_case targets[] = {
    {"R8G8B8A8 storage", VK_FORMAT_R8G8B8A8_UNORM, 1, MASU_ENCODING_AUTO},
    {"R8G8B8A8", VK_FORMAT_R8G8B8A8_UNORM, 0, MASU_ENCODING_SRGB},
    {"B8G8R8A8", VK_FORMAT_B8G8R8A8_UNORM, 0, MASU_ENCODING_AUTO},
    {"A8B8G8R8", VK_FORMAT_A8B8G8R8_UNORM_PACK32, 0, MASU_ENCODING_AUTO},
    {"R8G8B8A8 SRGB", VK_FORMAT_R8G8B8A8_SRGB, 0, MASU_ENCODING_AUTO},
    {"B8G8R8A8 SRGB", VK_FORMAT_B8G8R8A8_SRGB, 0, MASU_ENCODING_AUTO},
    {"A8B8G8R8 SRGB", VK_FORMAT_A8B8G8R8_SRGB_PACK32, 0, MASU_ENCODING_AUTO},
    {"R5G6B5", VK_FORMAT_R5G6B5_UNORM_PACK16, 0, MASU_ENCODING_AUTO},
    {"A2B10G10R10", VK_FORMAT_A2B10G10R10_UNORM_PACK32, 0, MASU_ENCODING_AUTO},
    {"A2R10G10B10", VK_FORMAT_A2R10G10B10_UNORM_PACK32, 0, MASU_ENCODING_AUTO},
    {"R16G16B16A16", VK_FORMAT_R16G16B16A16_UNORM, 0, MASU_ENCODING_AUTO},
    {"scRGB storage", VK_FORMAT_R16G16B16A16_SFLOAT, 1, MASU_ENCODING_AUTO},
    {"scRGB", VK_FORMAT_R16G16B16A16_SFLOAT, 0, MASU_ENCODING_LINEAR},
    {"floats, sRGB", VK_FORMAT_R16G16B16A16_SFLOAT, 1, MASU_ENCODING_SRGB},
    {"HDR10", VK_FORMAT_A2B10G10R10_UNORM_PACK32, 0, MASU_ENCODING_PQ},
};

static double expected(const target_case *t, const float color[3], int c) {
    double linear[3] = {(double)color[0], (double)color[1], (double)color[2]}, wide[3];
    if (t->encoding == MASU_ENCODING_PQ) {
        masu_ref_bt2020(linear, wide);
        return masu_ref_pq_encode(203 * wide[c]);
    }
    int floats = t->format == VK_FORMAT_R16G16B16A16_SFLOAT && t->encoding != MASU_ENCODING_SRGB;
    return floats ? linear[c] : masu_ref_srgb_encode(linear[c]);
}

/* The device's format, or 0: it has no such target. */
static int has_format(const target_case *t) {
    VkFormatProperties p;
    vkGetPhysicalDeviceFormatProperties(s.host.physical, t->format, &p);
    VkFormatFeatureFlags needed = t->storage ? VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT
                                             : VK_FORMAT_FEATURE_BLIT_DST_BIT;
    return (p.optimalTilingFeatures & needed) != 0;
}

/* scale 1: tonemap writes the output; below: RCAS does. */
static void assert_target(const target_case *t, float scale) {
    masu_session_desc d = sky_desc(W, H);
    d.desc.targets.format = t->format;
    d.desc.targets.storage = t->storage;
    d.desc.targets.encoding = t->encoding;
    d.desc.rungs[0].scale = scale;
    double worst = 0;
    open_session(&s, &d);
    for (int i = 0; i < COLORS; i++) {
        draw_sky(colors[i], colors[i], 0, NULL);
        const uint8_t *mapped = s.targets[0].mapped;
        for (uint32_t k = 0; k < W * H; k++) { /* all pixels are the same */
            assert_memory_equal(mapped, mapped + bytes_of(t->format) * k, bytes_of(t->format));
        }
        double got[3], step[3];
        pixel(t->format, mapped, got, step);
        for (int c = 0; c < 3; c++) {
            double off = fabs(got[c] - expected(t, colors[i], c)) / step[c];
            /* 10 bits before EASU, 8 bits or less after it: another half of a step of 10 bits. */
            int twice = scale < 1 && bytes_of(t->format) <= 4 && step[c] > 1 / 300.0;
            /* The lit image is half float, which some drivers truncate: 2^-11. */
            /* PQ encoding and decoding in half floats: 2^-12 of its range. */
            int linear = scale < 1 && t->format == VK_FORMAT_R16G16B16A16_SFLOAT &&
                         t->encoding != MASU_ENCODING_SRGB;
            /* Half floats before EASU, 10 bits after it: a quarter of a step more. */
            int ten = scale < 1 && bytes_of(t->format) == 4 && step[c] < 1 / 1000.0;
            double allowed = twice                      ? 0.505 + 0.5 / 1023 / step[c]
                             : linear                   ? 4
                             : ten                      ? 0.77
                             : bytes_of(t->format) == 8 ? 1.01
                                                        : 0.505;
            if (!(off <= allowed)) {
                fail_msg("%s, scale %g, color %d, channel %d: %g, should be %g: %g steps off",
                         t->name, (double)scale, i, c, got[c], expected(t, colors[i], c), off);
            }
            worst = worst_of(worst, off);
        }
    }
    print_message("%-18s scale %.1f: error of %.3f steps at most\n", t->name, (double)scale, worst);
    close_session(&s);
}

static void every_target_gets_its_encoding(void **state) {
    (void)state;
    uint32_t tested = 0;
    masu_session_desc probe = sky_desc(W, H);
    uint8_t has[sizeof targets / sizeof *targets];
    probe.no_renderer = true;
    open_session(&s, &probe);
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        has[i] = (uint8_t)has_format(&targets[i]);
    close_session(&s);
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
        if (!has[i]) {
            print_message("%s: not on this device\n", targets[i].name);
            continue;
        }
        assert_target(&targets[i], 1.0f);
        if (i == 0 || i == 5 || i == 7 || i == 8 || i == 11 || i == 14)
            assert_target(&targets[i], 0.5f);
        tested++;
    }
    assert_true(tested >= 10);
}

static void what_no_target_can_be_is_refused(void **state) {
    (void)state;
    masu_session_desc d = sky_desc(W, H);
    masu_detail detail;
    masu_memory need;
    d.no_renderer = true;
    open_session(&s, &d);
    const masu_desc good = s.desc;
#define REFUSED(name, ...)                                                                         \
    do {                                                                                           \
        s.desc = good;                                                                             \
        masu_targets *t = &s.desc.targets;                                                         \
        (void)t;                                                                                   \
        __VA_ARGS__;                                                                               \
        assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_ARGUMENT);         \
        assert_string_equal(detail.what, name);                                                    \
        assert_non_null(strstr(detail.text, name));                                                \
    } while (0)
    REFUSED("targets.format", t->storage = 0, t->format = VK_FORMAT_R8G8B8A8_UINT);
    REFUSED("targets.format", t->storage = 0, t->format = VK_FORMAT_E5B9G9R9_UFLOAT_PACK32);
    REFUSED("targets.format", t->format = VK_FORMAT_B8G8R8A8_UNORM);
    REFUSED("targets.format", t->format = VK_FORMAT_R8G8B8A8_SRGB);
    REFUSED("targets.encoding", t->encoding = MASU_ENCODING_LINEAR);
    REFUSED("targets.encoding", t->encoding = MASU_ENCODING_PQ);
    REFUSED("targets.encoding", t->encoding = (masu_encoding)4);
    REFUSED("targets.white", t->white = 0.5f);
    REFUSED("targets.white", t->white = NAN);
    REFUSED("targets.peak", t->white = 500, t->peak = 400);
    REFUSED("targets.peak", t->peak = 1e5f);
    REFUSED("deep_color", s.desc.deep_color = MASU_ON);
    REFUSED("deep_color", s.desc.deep_color = MASU_ON, t->storage = 0,
            t->format = VK_FORMAT_B8G8R8A8_SRGB);
    REFUSED("deep_color", s.desc.deep_color = MASU_OFF, t->format = VK_FORMAT_R16G16B16A16_SFLOAT);
    REFUSED("deep_color", s.desc.deep_color = (masu_switch)3);
    REFUSED("dither", s.desc.dither = (masu_switch)3);
    REFUSED("tone", s.desc.tone = (masu_tone)4);
    REFUSED("exposure.metered", s.desc.exposure.metered = (masu_switch)3);
    REFUSED("exposure.brighten", s.desc.exposure.brighten = -1);
    REFUSED("exposure.darken", s.desc.exposure.darken = INFINITY);
    REFUSED("exposure.low", s.desc.exposure.low = 0.5f, s.desc.exposure.high = 0.5f);
    REFUSED("exposure.high", s.desc.exposure.high = (float)NAN);
    REFUSED("exposure.high", s.desc.exposure.high = 1.0f);
    REFUSED("exposure.min", s.desc.exposure.min = -1);
    REFUSED("exposure.max", s.desc.exposure.max = 1e-9f);
#undef REFUSED
    s.desc = good;
    close_session(&s);
}

static void what_is_brighter_than_white_stays_so(void **state) {
    (void)state;
    static const masu_tone tones[] = {MASU_TONE_NONE, MASU_TONE_ACES, MASU_TONE_NEUTRAL};
    for (int i = 0; i < 3; i++) {
        masu_session_desc d = sky_desc(W, H);
        d.desc.targets.format = VK_FORMAT_R16G16B16A16_SFLOAT;
        d.desc.tone = tones[i];
        d.desc.targets.white = 160; /* a radiance of 1 is 2 */
        d.desc.targets.peak = 800;
        open_session(&s, &d);
        for (int k = 0; k < 3; k++) {
            const float v = k == 0 ? 0.5f : k == 1 ? 3.0f : 1000.0f, color[3] = {v, v, v};
            double x[3] = {(double)v, (double)v, (double)v}, y[3], got[3], step[3];
            draw_sky(color, color, 0, NULL);
            pixel(VK_FORMAT_R16G16B16A16_SFLOAT, s.targets[0].mapped, got, step);
            masu_ref_tone((int)tones[i], 5, x, y);
            double wanted = fmin(2 * y[0], 125);
            assert_float_equal((float)got[0], (float)wanted, (float)(0.002 * wanted));
            if (k == 2) assert_true(i == 1 ? got[0] <= 2.001 : got[0] > 9.9);
        }
        close_session(&s);
    }
}

/* ---- Constant images and dither -------------------------------------------------------------- */

static double mean_of(const uint8_t *rgba, uint32_t pixels) {
    double sum = 0;
    for (uint32_t i = 0; i < pixels; i++) sum += rgba[4 * i] + rgba[4 * i + 1] + rgba[4 * i + 2];
    return sum / (3.0 * pixels);
}

static void constant_pictures_stay_what_they_are(void **state) {
    (void)state;
    enum { SIDE = 96 };
    static uint8_t rgba[4 * SIDE * SIDE];
    static const double codes[] = {0, 1 / 255.0, 0.5, 0.7137, 1};
    for (int dither = 0; dither < 2; dither++) {
        masu_session_desc d = sky_desc(SIDE, SIDE);
        d.desc.dither = dither ? MASU_ON : MASU_OFF;
        d.desc.rung_count = 3;
        d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
        d.desc.rungs[1] = (masu_rung){.scale = 0.5f};
        d.desc.rungs[2] = (masu_rung){.scale = 0.8f, .sharpen = MASU_OFF};
        open_session(&s, &d);
        for (uint32_t r = 0; r < 3; r++) {
            for (int i = 0; i < 5; i++) {
                float v = (float)masu_ref_srgb_decode(codes[i]), color[3] = {v, v, v};
                draw_sky(color, color, r, rgba);
                double mean = mean_of(rgba, SIDE * SIDE), wanted = 255 * codes[i];
                uint32_t low = 255, high = 0;
                for (uint32_t k = 0; k < SIDE * SIDE; k++) {
                    for (int c = 0; c < 3; c++) {
                        if (rgba[4 * k + (uint32_t)c] < low) low = rgba[4 * k + (uint32_t)c];
                        if (rgba[4 * k + (uint32_t)c] > high) high = rgba[4 * k + (uint32_t)c];
                    }
                }
                if (dither)
                    print_message("rung %u, %7.3f: %7.3f, %u to %u\n", r, wanted, mean, low, high);
                assert_true(fabs(mean - wanted) <= 0.505);
                assert_true(high - low <= 1);
                /* A step remains one step, at any noise; without dither everything is rounded.
                 * Upscaled, a step of 8 bits is one of 10 bits only at the ends. */
                int ends = i == 0 || i == 4;
                if (!dither || ends || (r == 0 && i != 2)) assert_true(i == 3 || low == high);
                if (dither) assert_true(fabs(mean - wanted) <= 0.13);
                if (i == 0) assert_int_equal(high, 0);
                if (i == 4) assert_int_equal(low, 255);
                /* At full size the mean is that of the radiance, which is a half: a relative
                 * 2^-12. */
                if (dither && r == 0) assert_true(fabs(mean - wanted) < 0.05);
                if (!dither && r == 0 && i != 2) assert_int_equal(low, (int)floor(wanted + 0.5));
            }
        }
        close_session(&s);
    }
}

/* A slow ramp: error of the mean over 8x8 pixels against the exact value, RMS in steps; the longest
 * run of one value along a column. */
static void ramp(int dither, uint8_t *rgba, uint32_t side, double *rms, uint32_t *run) {
    static const float low[3] = {0.2f, 0.2f, 0.2f}, high[3] = {0.235f, 0.235f, 0.235f};
    masu_session_desc d = sky_desc(side, side);
    d.desc.dither = dither ? MASU_ON : MASU_OFF;
    d.desc.readback = MASU_READBACK_HDR;
    open_session(&s, &d);
    draw_sky(high, low, 0, rgba);
    const uint16_t *hdr = read_image(&s, 0, MASU_READBACK_HDR);
    double sum = 0;
    for (uint32_t y = 0; y < side; y += 8) {
        for (uint32_t x = 0; x < side; x += 8) {
            double error = 0;
            for (uint32_t k = 0; k < 64; k++) {
                uint32_t at = 4 * ((y + k / 8) * side + x + k % 8);
                error += rgba[at] - 255 * masu_ref_srgb_encode(half_float(hdr[at]));
            }
            sum += error / 64 * (error / 64);
        }
    }
    *rms = sqrt(sum / (side / 8 * (side / 8)));
    *run = 0;
    for (uint32_t x = 0; x < side; x++) {
        for (uint32_t y = 1, n = 1; y < side; y++) {
            n = rgba[4 * (y * side + x)] == rgba[4 * ((y - 1) * side + x)] ? n + 1 : 1;
            if (n > *run) *run = n;
        }
    }
    close_session(&s);
}

static void dither_takes_the_bands_from_a_ramp(void **state) {
    (void)state;
    enum { SIDE = 128 };
    static uint8_t plain[4 * SIDE * SIDE], dithered[4 * SIDE * SIDE];
    double rms[2];
    uint32_t run[2];
    ramp(0, plain, SIDE, &rms[0], &run[0]);
    ramp(1, dithered, SIDE, &rms[1], &run[1]);
    print_message("mean of 8x8: error %.4f steps RMS, with dither %.4f; longest band %u pixels, "
                  "%u\n",
                  rms[0], rms[1], run[0], run[1]);
    assert_true(rms[1] < 0.25 * rms[0]);
    assert_true(2 * run[1] < run[0]);
    assert_true(max_difference(plain, dithered, sizeof plain) <= 1);
}

/* With upscaling, 8 bits before EASU would leave little to dither: RMS deviation of means over 8x8
 * pixels from a straight line, column by column. */
static double unevenness(int dither, masu_switch deep) {
    enum { SIDE = 128, MEANS = SIDE / 8 };
    static const float low[3] = {0.2f, 0.2f, 0.2f}, high[3] = {0.235f, 0.235f, 0.235f};
    static uint8_t rgba[4 * SIDE * SIDE];
    masu_session_desc d = sky_desc(SIDE, SIDE);
    d.desc.targets.storage = 0;
    d.desc.dither = dither ? MASU_ON : MASU_OFF;
    d.desc.deep_color = deep;
    d.desc.rungs[0].scale = 0.5f;
    open_session(&s, &d);
    draw_sky(high, low, 0, rgba);
    close_session(&s);
    double sum = 0;
    for (uint32_t x = 0; x < SIDE; x += 8) {
        double means[MEANS] = {0};
        for (uint32_t k = 0; k < 8 * SIDE; k++)
            means[k / 64] += rgba[4 * (k / 8 * SIDE + x + k % 8)] / 64.0;
        for (uint32_t i = 1; i + 1 < MEANS; i++) {
            double bend = means[i - 1] - 2 * means[i] + means[i + 1];
            sum += bend * bend / (MEANS - 2);
        }
    }
    return sqrt(sum / (SIDE / 8));
}

static void upscaled_pictures_are_dithered_too(void **state) {
    (void)state;
    double plain = unevenness(0, MASU_OFF), dithered = unevenness(1, MASU_OFF);
    double deep = unevenness(0, MASU_ON), both = unevenness(1, MASU_ON);
    print_message("upscaled ramp, deviation of means of 8x8: %.4f steps, dithered %.4f; deep "
                  "colour %.4f, dithered %.4f\n",
                  plain, dithered, deep, both);
    assert_true(dithered < 0.4 * plain);
    assert_true(both < 0.4 * plain);
}

static void dither_is_the_reference_and_depends_on_the_frame_alone(void **state) {
    (void)state;
    static uint8_t runs[2][3][4 * W * H];
    static const float low[3] = {0.1f, 0.2f, 0.02f}, high[3] = {0.12f, 0.25f, 0.03f};
    for (int i = 0; i < 2; i++) {
        masu_session_desc d = sky_desc(W, H);
        d.desc.dither = MASU_ON;
        d.desc.readback = MASU_READBACK_HDR;
        open_session(&s, &d);
        for (uint32_t f = 0; f < 3; f++) draw_sky(high, low, 0, runs[i][f]);
        const uint16_t *hdr = read_image(&s, 0, MASU_READBACK_HDR); /* of frame 2 */
        uint32_t other = 0;
        for (uint32_t k = 0; k < W * H; k++) {
            for (uint32_t c = 0; c < 3; c++) {
                double v = masu_ref_srgb_encode(half_float(hdr[4 * k + c]));
                other += masu_ref_dither(v, 255, k % W, k / W, 2, c) != runs[i][2][4 * k + c];
            }
        }
        assert_true(other <= 3 * W * H / 200); /* where pow() decides */
        close_session(&s);
    }
    assert_memory_equal(runs[0], runs[1], sizeof runs[0]);
    assert_true(max_difference(runs[0][0], runs[0][1], sizeof runs[0][0]) == 1);
}

/* ---- Intermediate bits ----------------------------------------------------------------------- */

/* RMS difference from the image with 16 bits throughout. */
static void deeper_colour_is_nearer_to_the_truth(void **state) {
    (void)state;
    enum { SIDE = 96 };
    static uint8_t rgba[3][4 * SIDE * SIDE];
    static uint16_t truth[4 * SIDE * SIDE];
    double rms[2] = {0}, native[2] = {0};
    uint64_t bytes[2] = {0};
    for (int i = 0; i < 4; i++) { /* 10 bits, floats; floats to the end; at full size */
        masu_session_desc d = test_desc("test_both", SIDE, SIDE);
        masu_commands commands;
        masu_frame_desc frame = {0};
        char error[ERROR_SIZE];
        d.desc.rung_count = 1;
        d.desc.rungs[0] = (masu_rung){.scale = i < 3 ? 0.5f : 1.0f, .sharpness = 0.2f};
        d.desc.targets.storage = 0;
        d.desc.dither = MASU_OFF;
        d.desc.deep_color = i == 0 || i == 3 ? MASU_OFF : MASU_ON;
        if (i == 2) {
            d.desc.targets.format = VK_FORMAT_R16G16B16A16_SFLOAT;
            d.desc.targets.encoding = MASU_ENCODING_SRGB;
        }
        open_session(&s, &d);
        draw(&s, &frame, &commands, i == 2 ? NULL : rgba[i < 2 ? i : 2]);
        if (i < 2) bytes[i] = s.need.device_bytes;
        assert_ok(masu_headless_target_read(&s.host, &s.targets[0], error, sizeof error));
        if (i == 2) memcpy(truth, s.targets[0].mapped, sizeof truth);
        close_session(&s);
    }
    for (uint32_t k = 0; k < 4 * SIDE * SIDE; k++) {
        if (k % 4 == 3) continue;
        for (int i = 0; i < 2; i++) {
            double error = rgba[i][k] - 255 * half_float(truth[k]);
            rms[i] += error * error / (3.0 * SIDE * SIDE);
            error = rgba[i][k] - rgba[2][k];
            native[i] += error * error / (3.0 * SIDE * SIDE);
        }
    }
    print_message(
        "10 bits in between: %.4f of 255 off, RMS; floats in between: %.4f; %llu, %llu bytes\n",
        sqrt(rms[0]), sqrt(rms[1]), (unsigned long long)bytes[0], (unsigned long long)bytes[1]);
    print_message("from the image at full size: %.3f and %.3f of 255, RMS\n", sqrt(native[0]),
                  sqrt(native[1]));
    assert_true(sqrt(rms[1]) < 0.32); /* rounding by itself causes 0.289 */
    assert_true(rms[1] < rms[0]);
    assert_true(bytes[0] < bytes[1]);
}

/* ---- The last pass --------------------------------------------------------------------------- */

/* Each pass that can be the last, after 10 bits and after floats; and into a target with blue as
 * its first channel. */
static void every_chain_makes_the_same_output(void **state) {
    (void)state;
    enum { SIDE = 96, CHAINS = 8, KINDS = 3 };
    static const masu_rung chains[CHAINS] = {
        {.aa = MASU_AA_OFF},
        {.aa = MASU_AA_FXAA},
        {.aa = MASU_AA_SMAA_HIGH},
        {.scale = 0.5f, .aa = MASU_AA_SMAA_ULTRA, .easu = MASU_EASU_FULL, .sharpen = MASU_OFF},
        {.scale = 0.5f, .aa = MASU_AA_FXAA, .easu = MASU_EASU_FAST},
        {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF},
        {.scale = 0.5f, .easu = MASU_EASU_BILINEAR},
        {.scale = 0.5f, .easu = MASU_EASU_FULL}};
    static uint8_t rgba[KINDS][CHAINS][4 * SIDE * SIDE];
    for (int kind = 0; kind < KINDS; kind++) {
        masu_session_desc d = test_desc("test_both", SIDE, SIDE);
        d.desc.rung_count = CHAINS;
        memcpy(d.desc.rungs, chains, sizeof chains);
        d.desc.targets.storage = 0;
        d.desc.dither = MASU_OFF;
        d.desc.deep_color = kind == 1 ? MASU_ON : MASU_OFF;
        if (kind == 2) d.desc.targets.format = VK_FORMAT_B8G8R8A8_SRGB;
        open_session(&s, &d);
        for (uint32_t r = 0; r < CHAINS; r++) {
            masu_commands commands;
            masu_frame_desc frame = {.rung = r, .cut = 1};
            draw(&s, &frame, &commands, rgba[kind][r]);
        }
        close_session(&s);
    }
    for (uint32_t r = 0; r < CHAINS; r++) {
        double sum = 0;
        for (uint32_t k = 0; k < 4 * SIDE * SIDE; k++) {
            double off = (double)rgba[0][r][k] - (double)rgba[1][r][k];
            sum += off * off / (4 * SIDE * SIDE);
            uint32_t swapped = k % 4 == 3 ? k : k / 4 * 4 + 2 - k % 4;
            assert_int_equal(rgba[0][r][k], rgba[2][r][swapped]);
        }
        print_message("chain %u: 10 bits between passes, rms %.3f of 255 compared with floats\n",
                      r, sqrt(sum));
        assert_true(sqrt(sum) < 2.5);
        if (r) assert_true(memcmp(rgba[0][r], rgba[0][0], sizeof rgba[0][0]) != 0);
    }
}

/* ---- Invalid images -------------------------------------------------------------------------- */

enum { IN_W = 24, IN_H = 16, OUT_W = 48, OUT_H = 32 };

/* Sends a half-float image through EASU and RCAS. */
static void upscale(const uint16_t *halves, uint8_t *out) {
    char error[ERROR_SIZE];
    masu_headless_source source;
    assert_ok(masu_headless_source_of(&s.host, VK_FORMAT_R16G16B16A16_SFLOAT, halves, IN_W, IN_H,
                                      IN_W, IN_H, 0, &source, error, sizeof error));
    masu_desc d = s.desc;
    d.output = (VkExtent2D){OUT_W, OUT_H};
    d.source = (masu_source){.view = source.view, .width = IN_W, .height = IN_H};
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.sharpen = MASU_ON};
    draw_rungs_of(&s, &d, &out, NULL);
    masu_headless_source_destroy(&s.host, &source);
}

static void a_broken_pixel_stays_in_its_footprint(void **state) {
    (void)state;
    static const uint16_t hostile[] = {0x7E00, 0xFE00, 0x7C00, 0xFC00,
                                       0xBC00, 0x7BFF, 0x8000, 0x0001};
    static uint16_t halves[4 * IN_W * IN_H];
    static uint8_t good[4 * OUT_W * OUT_H], bad[4 * OUT_W * OUT_H];
    open_device(&s);
    for (uint32_t i = 0; i < 4 * IN_W * IN_H; i++) /* 0.25 to 0.97 */
        halves[i] = i % 4 == 3 ? 0x3C00 : (uint16_t)(0x3400 + i * 2654435761u % 0x7C0);
    upscale(halves, good);
    for (uint32_t k = 0; k < sizeof hostile / sizeof *hostile; k++) {
        uint32_t x = 3 + 2 * k, y = 2 + k, at = 4 * (y * IN_W + x);
        uint16_t kept[3] = {halves[at], halves[at + 1], halves[at + 2]};
        halves[at] = hostile[k], halves[at + 2] = hostile[(k + 3) % 8];
        upscale(halves, bad);
        memcpy(halves + at, kept, sizeof kept);
        uint32_t changed = 0;
        for (uint32_t i = 0; i < OUT_W * OUT_H; i++) {
            if (!memcmp(good + 4 * i, bad + 4 * i, 4)) continue;
            changed++;
            /* EASU reads two texels around; RCAS reads a pixel around. */
            double dx = fabs((i % OUT_W + 0.5) / 2 - (x + 0.5)),
                   dy = fabs((i / OUT_W + 0.5) / 2 - (y + 0.5));
            assert_true(dx <= 2.5 && dy <= 2.5);
        }
        assert_true(changed > 0);
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_target_gets_its_encoding),
        cmocka_unit_test(what_no_target_can_be_is_refused),
        cmocka_unit_test(what_is_brighter_than_white_stays_so),
        cmocka_unit_test(constant_pictures_stay_what_they_are),
        cmocka_unit_test(dither_takes_the_bands_from_a_ramp),
        cmocka_unit_test(upscaled_pictures_are_dithered_too),
        cmocka_unit_test(dither_is_the_reference_and_depends_on_the_frame_alone),
        cmocka_unit_test(deeper_colour_is_nearer_to_the_truth),
        cmocka_unit_test(every_chain_makes_the_same_output),
        cmocka_unit_test(a_broken_pixel_stays_in_its_footprint),
    };
    return cmocka_run_group_tests_name("output", tests, NULL, NULL);
}
