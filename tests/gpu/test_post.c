/* test_post.c: bloom, depth of field and grading: off they change nothing; bloom conserves energy and has the same width
 * at every resolution; depth of field is compared with the mean of many off-centre cameras on the lens; colour tables
 * and curves are compared with their formulas. */
#include "reference/tone.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static masu_session s;
static masu_commands commands;

/* A float target that is linear up to 10000 nits; no tone curve. */
static masu_session_desc linear_desc(const char *scene, uint32_t width, uint32_t height,
                                     uint32_t post) {
    masu_session_desc d = test_desc(scene, width, height);
    d.desc.targets.format = VK_FORMAT_R16G16B16A16_SFLOAT;
    d.desc.tone = MASU_TONE_NONE;
    d.desc.post = post;
    d.desc.rung_count = 1;
    return d;
}

/* Red, green, blue of each pixel. */
static void draw_linear(const masu_frame_desc *frame, float *rgb) {
    char error[ERROR_SIZE];
    const masu_headless_target *t = &s.targets[0];
    draw(&s, frame, &commands, NULL);
    assert_ok(masu_headless_target_read(&s.host, &s.targets[0], error, sizeof error));
    const uint16_t *halves = (const uint16_t *)t->mapped;
    for (size_t i = 0; i < (size_t)t->width * t->height * 3; i++)
        rgb[i] = (float)half_float(halves[i / 3 * 4 + i % 3]);
}

/* ---- Off ------------------------------------------------------------------------------------- */

enum { W = 160, H = 90 };
static uint8_t image[2][4][4 * W * H];

static void reserved_effects_of_strength_0_change_no_bit(void **state) {
    (void)state;
    const masu_rung rungs[] = {{.scale = 1.0f},
                               {.scale = 0.5f, .temporal = MASU_ON},
                               {.scale = 1.0f, .silhouettes = MASU_ON},
                               {.scale = 0.7f, .temporal = MASU_OFF}};
    for (int reserved = 0; reserved < 2; reserved++) {
        masu_session_desc d = test_desc("test_both", W, H);
        d.desc.rung_count = 4;
        memcpy(d.desc.rungs, rungs, sizeof rungs);
        d.desc.post = reserved ? MASU_POST_ALL : 0;
        d.desc.lut_size = reserved ? 5 : 0;
        d.desc.debug.poison = 1;
        open_session(&s, &d);
        for (uint32_t r = 0; r < 4; r++) {
            for (int k = 0; k < 3; k++) draw_rung(&s, r, image[reserved][r]);
        }
        close_session(&s);
    }
    for (uint32_t r = 0; r < 4; r++)
        assert_memory_equal(image[0][r], image[1][r], sizeof image[0][r]);
}

/* Transient images, device memory and passes are those of masu.h, and none without desc.post. */
static void they_cost_what_the_header_says(void **state) {
    (void)state;
    static const uint32_t posts[] = {0, MASU_POST_BLOOM, MASU_POST_FOCUS, MASU_POST_GRADE};
    static const uint32_t passes[] = {0, 4, 3, 0};
    static const double bytes_most[] = {0, 1.25, 6.2, 0};
    enum { SIDE = 256 };
    double base = 0;
    for (int i = 0; i < 4; i++) {
        masu_session_desc d = test_desc("test_both", SIDE, SIDE);
        d.desc.rung_count = 1;
        d.desc.rungs[0].scale = 1.0f;
        d.desc.post = posts[i];
        d.desc.lut_size = i == 3 ? 33 : 0;
        d.desc.frames_in_flight = 2;
        open_session(&s, &d);
        masu_plan_info plan;
        masu_plan_of(s.m, &plan);
        uint32_t found = 0;
        for (uint32_t p = 0; p < plan.pass_count; p++) {
            const char *name = plan.passes[p].name;
            found +=
                plan.passes[p].active && (!strncmp(name, "bloom", 5) || !strncmp(name, "focus", 5));
        }
        assert_int_equal(found, passes[i]);
        masu_memory_row rows[MEMORY_ROWS];
        double images = 0, buffer = 0, host = 0;
        uint32_t n = memory_rows(s.m, rows);
        for (uint32_t k = 0; k < n; k++) {
            if (!strcmp(rows[k].kind, "image")) images += (double)rows[k].bytes;
            if (!strcmp(rows[k].name, "effects")) buffer = (double)rows[k].bytes;
            if (!strcmp(rows[k].name, "colour table")) host = (double)rows[k].bytes;
        }
        if (i == 0) base = images;
        double per_pixel = (images - base) / (SIDE * SIDE);
        print_message("post %u: images %.2f bytes per pixel, buffer %.0f, host %.0f\n", posts[i],
                      per_pixel, buffer, host);
        assert_true(per_pixel <= bytes_most[i] && per_pixel >= 0.8 * bytes_most[i]);
        assert_true(i == 0 ? buffer == 0 : buffer >= 64);
        assert_true(buffer <= (i == 3 ? 2 * (143748 + 256) : 512));
        assert_true(host == (i == 3 ? 143748 : 0));
        close_session(&s);
    }
}

/* ---- Bloom ----------------------------------------------------------------------------------- */

static const masu_camera ahead = {
    .position = {0, 0, 50}, .forward = {0, 0, 1}, .fov_y = 0.6f, .near_distance = 0.1f};

/* Radiance of a small bright disc in the dark, away from the scene. */
static void draw_disc(float bloom, float radius, float *rgb) {
    const masu_light dark = {.sun_direction = {0, 1, 0}, .exposure = 1.0f};
    const masu_particle disc = {.position = {0, 0, 60},
                                .half_width = radius,
                                .color = {100, 50, 20},
                                .opacity = 1,
                                .edge = 1};
    const masu_frame_desc frame = {MASU_FRAME_DESC,    .camera = &ahead,    .light = &dark,
                                   .particles = &disc, .particle_count = 1, .post.bloom = bloom};
    draw_linear(&frame, rgb);
}

static void bloom_conserves_energy(void **state) {
    (void)state;
    enum { WIDE = 640, HIGH = 480 };
    float *rgb = malloc(sizeof *rgb * 3 * WIDE * HIGH);
    assert_non_null(rgb);
    masu_session_desc d = linear_desc("test_both", WIDE, HIGH, MASU_POST_BLOOM);
    d.desc.reserve.particles = 1;
    open_session(&s, &d);
    double sums[3][3] = {{0}}, most[3] = {0};
    static const float shares[] = {0.0f, 0.1f, 1.0f};
    for (int i = 0; i < 3; i++) {
        draw_disc(shares[i], 0.05f, rgb);
        for (size_t k = 0; k < (size_t)3 * WIDE * HIGH; k++) {
            sums[i][k % 3] += (double)rgb[k];
            most[i] = fmax(most[i], (double)rgb[k]);
        }
    }
    for (int c = 0; c < 3; c++) {
        print_message("channel %d: sum %.1f; with a tenth scattered %.5f of it, with all %.5f\n", c,
                      sums[0][c], sums[1][c] / sums[0][c], sums[2][c] / sums[0][c]);
        assert_true(sums[0][c] > 1000);
        assert_true(fabs(sums[1][c] / sums[0][c] - 1) < 0.01);
        assert_true(fabs(sums[2][c] / sums[0][c] - 1) < 0.01);
    }
    assert_true(most[1] < 0.95 * most[0] && most[2] < 0.3 * most[0]); /* it is scattered */
    close_session(&s);
    free(rgb);
}

/* Radius that contains a part of the light, of the image height. */
static double radius_of(const float *rgb, uint32_t size, double part) {
    enum { STEPS = 1000 };
    double rings[STEPS] = {0}, all = 0, sum = 0;
    for (uint32_t k = 0; k < size * size; k++) {
        double x = (k % size + 0.5) / size - 0.5, y = (k / size + 0.5) / size - 0.5;
        int ring = (int)(sqrt(x * x + y * y) * STEPS);
        rings[ring < STEPS ? ring : STEPS - 1] += (double)rgb[3 * k];
        all += (double)rgb[3 * k];
    }
    for (int i = 0; i < STEPS; i++) {
        if (sum + rings[i] >= part * all) return (i + (part * all - sum) / rings[i]) / STEPS;
        sum += rings[i];
    }
    return 1;
}

static void bloom_has_the_same_width_at_every_resolution(void **state) {
    (void)state;
    static const uint32_t sizes[] = {540, 720, 1080};
    static const double parts[] = {0.25, 0.5, 0.75, 0.9};
    double radii[3][4];
    float *rgb = malloc(sizeof *rgb * 3 * 1080 * 1080);
    assert_non_null(rgb);
    for (int i = 0; i < 3; i++) {
        masu_session_desc d = linear_desc("test_both", sizes[i], sizes[i], MASU_POST_BLOOM);
        d.desc.reserve.particles = 1;
        open_session(&s, &d);
        draw_disc(1.0f, 0.03f, rgb);
        for (int p = 0; p < 4; p++) radii[i][p] = radius_of(rgb, sizes[i], parts[p]);
        print_message(
            "%u rows: 25, 50, 75, 90 %% of the light within %.4f %.4f %.4f %.4f of the height\n",
            sizes[i], radii[i][0], radii[i][1], radii[i][2], radii[i][3]);
        close_session(&s);
    }
    for (int i = 1; i < 3; i++) {
        for (int p = 1; p < 4; p++) assert_true(fabs(radii[i][p] / radii[0][p] - 1) < 0.1);
    }
    free(rgb);
}

/* ---- Depth of field -------------------------------------------------------------------------- */

/* 96 positions in the lens give the same ratios within 0.04. */
enum { DW = 320, DH = 180, LENS = 48 };
static float sharp[3 * DW * DH], blurred[3 * DW * DH], lens[3 * DW * DH], one[3 * DW * DH];
static float depth[DW * DH];

static double rms(const float *a, const float *b) {
    double sum = 0;
    for (size_t i = 0; i < (size_t)3 * DW * DH; i++)
        sum += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
    return sqrt(sum / (3.0 * DW * DH));
}

/* Sample k of a pixel, evenly spread (R2). */
static void jitter(masu_camera *c, int k) {
    c->jitter[0] = (float)(fmod(0.5 + k * 0.7548776662, 1.0) - 0.5);
    c->jitter[1] = (float)(fmod(0.5 + k * 0.5698402910, 1.0) - 0.5);
}

/* The mean over positions in the pixel. */
static void draw_positions(const masu_camera *camera, const masu_post *post, float *mean) {
    enum { POSITIONS = 8 };
    memset(mean, 0, sizeof lens);
    for (int k = 0; k < POSITIONS; k++) {
        masu_camera c = *camera;
        jitter(&c, k);
        draw_linear(&(masu_frame_desc){MASU_FRAME_DESC, .camera = &c, .post = *post}, one);
        for (size_t i = 0; i < (size_t)3 * DW * DH; i++) mean[i] += one[i] / POSITIONS;
    }
}

/* The mean over cameras all over the lens, whose windows keep the sharp plane in place. */
static void draw_lens(const masu_camera *camera, const masu_post *post, float *mean) {
    const double tan_y = tan(0.5 * (double)camera->fov_y), tan_x = tan_y * DW / DH;
    const double *f = (double[]){(double)camera->forward[0], (double)camera->forward[1],
                                 (double)camera->forward[2]};
    double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), across = hypot(f[0], f[2]);
    const double right[3] = {-f[2] / across, 0, f[0] / across};
    const double up[3] = {-f[1] * f[0] / across / length, across / length,
                          -f[1] * f[2] / across / length};
    memset(mean, 0, sizeof lens);
    for (int k = 0; k < LENS; k++) {
        double away = 0.5 * (double)post->aperture * sqrt((k + 0.5) / LENS), angle = 2.39996 * k;
        double x = away * cos(angle), y = away * sin(angle), focus = (double)post->focus;
        masu_camera c = *camera;
        for (int i = 0; i < 3; i++) c.position[i] += x * right[i] + y * up[i];
        c.left = (float)(-tan_x - x / focus), c.right = (float)(tan_x - x / focus);
        c.bottom = (float)(-tan_y - y / focus), c.top = (float)(tan_y - y / focus);
        jitter(&c, k);
        draw_linear(&(masu_frame_desc){MASU_FRAME_DESC, .camera = &c}, one);
        for (size_t i = 0; i < (size_t)3 * DW * DH; i++) mean[i] += one[i] / LENS;
    }
}

typedef struct lens_case {
    const char *scene;
    masu_post post;
    double most; /* error, of that of the sharp image */
} lens_case;

static void depth_of_field_is_near_the_mean_over_a_lens(void **state) {
    (void)state;
    static const lens_case cases[] = {
        {"test_both", {.aperture = 0.12f, .focus = 3.4f}, 1.1}, /* nearly all is sharp */
        {"test_both", {.aperture = 0.1f, .focus = 2.4f}, 0.6},
        {"test_both", {.aperture = 0.1f, .focus = 6.0f}, 0.7},
        {"test_town", {.aperture = 0.5f, .focus = 12.0f}, 0.35}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (i % 2 == 0 && !whole_run()) continue; /* other drivers: each scene once */
        masu_session_desc d = linear_desc(cases[i].scene, DW, DH, MASU_POST_FOCUS);
        open_session(&s, &d);
        masu_camera camera;
        assert_int_equal(masu_camera_at(s.m, 0.0, &camera, NULL), MASU_OK);
        draw_lens(&camera, &cases[i].post, lens);
        draw_positions(&camera, &(masu_post){0}, sharp);
        draw_positions(&camera, &cases[i].post, blurred);
        double without = rms(sharp, lens), with = rms(blurred, lens);
        print_message(
            "%s, focus %g m, lens %g m: RMS error to the mean of %d cameras %.5f, without %.5f\n",
            cases[i].scene, (double)cases[i].post.focus, (double)cases[i].post.aperture, LENS, with,
            without);
        assert_true(without > 1e-3);
        assert_true(with < cases[i].most * without);
        close_session(&s);
    }
}

static void the_sharp_plane_stays_sharp(void **state) {
    (void)state;
    const masu_post post = {.aperture = 0.02f, .focus = 2.6f}; /* in front of all surfaces */
    masu_session_desc d = linear_desc("test_both", DW, DH, MASU_POST_FOCUS);
    d.desc.readback = MASU_READBACK_DEPTH;
    open_session(&s, &d);
    masu_camera camera;
    assert_int_equal(masu_camera_at(s.m, 0.0, &camera, NULL), MASU_OK);
    camera.near_distance = 0.1f; /* the scene's */
    draw_linear(&(masu_frame_desc){MASU_FRAME_DESC}, sharp);
    view_depths(read_image(&s, commands.slot, MASU_READBACK_DEPTH), &camera, depth, DW * DH);
    draw_linear(&(masu_frame_desc){MASU_FRAME_DESC, .post = post}, blurred);
    double k =
        (double)post.aperture / (4 * (double)post.focus * tan(0.5 * (double)camera.fov_y)) * DH;
    uint32_t kept = 0, changed = 0, before = 0;
    for (uint32_t i = 0; i < DW * DH; i++) {
        double radius = depth[i] > 0 ? k * (1 - (double)post.focus / (double)depth[i]) : k;
        int same = memcmp(&sharp[3 * i], &blurred[3 * i], 3 * sizeof *sharp) == 0;
        before += radius < -0.5;
        if (fabs(radius) < 0.49) {
            kept++;
            if (!same)
                fail_msg("pixel %u at %g m has a radius of %g and has changed", i, (double)depth[i],
                         radius);
        }
        changed += !same;
    }
    print_message("sharp: %u pixels, changed: %u of %u\n", kept, changed, DW * DH);
    assert_int_equal(before, 0);
    assert_true(kept > 200 && changed > 200);
    close_session(&s);
}

/* ---- Grading --------------------------------------------------------------------------------- */

static float table[3 * MASU_LUT_MAX * MASU_LUT_MAX * MASU_LUT_MAX];

typedef enum look { IDENTITY, NEGATIVE, SWAPPED, NOT_FINITE } look;

static void fill_table(uint32_t size, look of) {
    for (uint32_t i = 0; i < size * size * size; i++) {
        const uint32_t at[3] = {i % size, i / size % size, i / size / size};
        for (uint32_t c = 0; c < 3; c++) {
            float v = (float)at[of == SWAPPED ? (c + 1) % 3 : c] / (float)(size - 1);
            table[3 * i + c] = of == NEGATIVE     ? 1 - v
                               : of != NOT_FINITE ? v
                               : c == 0           ? NAN
                               : c == 1           ? INFINITY
                                                  : -3.0f;
        }
    }
}

static uint32_t most_apart(const uint8_t *a, const uint8_t *b, look of) {
    uint32_t most = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        for (uint32_t c = 0; c < 3; c++) {
            int wanted = of == SWAPPED    ? a[4 * i + (c + 1) % 3]
                         : of == NEGATIVE ? 255 - a[4 * i + c]
                         : of == IDENTITY ? a[4 * i + c]
                         : c == 1         ? 255
                                          : 0;
            int apart = abs(b[4 * i + c] - wanted);
            most = most < (uint32_t)apart ? (uint32_t)apart : most;
        }
    }
    return most;
}

static void tables_map_colours(void **state) {
    (void)state;
    static const uint32_t sizes[] = {2, 5, 17, MASU_LUT_MAX};
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.rung_count = 1;
    d.desc.post = MASU_POST_GRADE;
    d.desc.lut_size = MASU_LUT_MAX;
    open_session(&s, &d);
    draw_rung(&s, 0, image[0][0]);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t apart[4];
        for (look of = IDENTITY; of <= NOT_FINITE; of++) {
            fill_table(sizes[i], of);
            assert_int_equal(masu_lut_set(s.m, table, sizes[i], NULL), MASU_OK);
            for (int k = 0; k < 3; k++) { /* each slot */
                draw_rung(&s, 0, image[1][0]);
                apart[of] = most_apart(image[0][0], image[1][0], of);
                assert_true(apart[of] <= 1);
            }
        }
        print_message("%u points: identity %u, negative %u, swapped %u, not finite %u of 255\n",
                      sizes[i], apart[0], apart[1], apart[2], apart[3]);
    }
    assert_int_equal(masu_lut_set(s.m, NULL, 0, NULL), MASU_OK);
    draw_rung(&s, 0, image[1][0]);
    assert_memory_equal(image[0][0], image[1][0], sizeof image[0][0]);
    close_session(&s);
}

static bool is_even(const uint8_t *rgba, uint32_t p) {
    if (p % W == 0 || p % W == W - 1 || p < W || p >= W * H - W) return false;
    for (uint32_t c = 0; c < 3; c++) {
        for (int y = -1; y <= 1; y++) {
            for (int x = -1; x <= 1; x++) {
                if (abs(rgba[4 * (size_t)((int)p + y * W + x) + c] - rgba[4 * p + c]) > 4)
                    return false;
            }
        }
    }
    return true;
}

/* Also with rung.temporal, whose history is graded, and changes with it. */
static void curves_are_their_formulas(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.rung_count = 2;
    d.desc.rungs[0].scale = d.desc.rungs[1].scale = 1.0f;
    d.desc.rungs[1].temporal = MASU_ON;
    d.desc.rungs[1].sharpen = MASU_OFF;
    d.desc.post = MASU_POST_GRADE;
    open_session(&s, &d);
    for (uint32_t r = 0; r < 2; r++) {
        const masu_post posts[] = {{0}, {.brightness = -1}, {.gamma = 2}, {.vignette = 0.5f}};
        double worst[4] = {0};
        for (int i = 0; i < 4; i++) {
            masu_frame_desc frame = {MASU_FRAME_DESC, .rung = r, .post = posts[i]};
            for (int k = 0; k < (r ? 48 : 1); k++) draw(&s, &frame, &commands, image[1][i]);
            for (uint32_t p = 0; p < W * H; p++) {
                double x = (p % W + 0.5) / W * 2 - 1, y = (p / W + 0.5) / H * 2 - 1;
                if (i == 3) { /* centre as before, corners darker */
                    int centre = x * x + y * y < 0.003, corner = x * x + y * y > 1.9;
                    if (centre)
                        assert_true(abs(image[1][3][4 * p + 1] - image[1][0][4 * p + 1]) <= 3);
                    if (corner) assert_true(image[1][3][4 * p + 1] < 0.93 * image[1][0][4 * p + 1]);
                    continue;
                }
                for (uint32_t c = 0; c < 3; c++) {
                    double v = image[1][0][4 * p + c] / 255.0,
                           linear = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
                    double wanted =
                        i == 2 ? sqrt(v) : masu_ref_srgb_encode(i == 1 ? 0.5 * linear : linear);
                    if (v < 0.1) continue; /* roots of few steps */
                    if (r && !is_even(image[1][0], p))
                        continue; /* means of graded samples differ at edges */
                    worst[i] = fmax(worst[i], fabs(image[1][i][4 * p + c] - 255 * wanted));
                }
            }
        }
        print_message("rung %u: brightness %.2f, gamma %.2f of 255\n", r, worst[1], worst[2]);
        assert_true(worst[1] <= (r ? 6 : 1.01) && worst[2] <= (r ? 6 : 1.6));
    }
    close_session(&s);
}

/* ---- Limits ---------------------------------------------------------------------------------- */

static void values_beyond_their_limits_are_errors(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_detail detail;
    d.desc.rung_count = 1;
    d.desc.post = MASU_POST_ALL;
    d.desc.lut_size = 5;
    open_session(&s, &d);
    draw_rung(&s, 0, image[0][0]);
    const masu_post good[] = {{.bloom = 1},
                              {.aperture = 1e6f, .focus = 1e-6f},
                              {.aperture = 1e-3f, .focus = 1e9f},
                              {.vignette = 1},
                              {.brightness = 8},
                              {.brightness = -8},
                              {.gamma = 0.1f},
                              {.gamma = 10},
                              {.focus = 1}};
    const masu_post bad[] = {{.bloom = 1.001f},
                             {.bloom = -0.001f},
                             {.bloom = NAN},
                             {.aperture = 1.01e6f, .focus = 1},
                             {.aperture = 1, .focus = 0},
                             {.aperture = 1, .focus = 1.01e9f},
                             {.aperture = -1, .focus = 1},
                             {.vignette = 1.001f},
                             {.vignette = -0.1f},
                             {.brightness = 8.01f},
                             {.brightness = -8.01f},
                             {.gamma = 0.099f},
                             {.gamma = 10.01f},
                             {.gamma = INFINITY},
                             {.focus = -1}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .post = good[i]}, &commands, NULL);
    uint64_t next = commands.frame + 1;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .post = bad[i]};
        assert_int_equal(masu_frame(s.m, &frame, &commands, &detail), MASU_ERROR_ARGUMENT);
        assert_int_equal(strncmp(detail.text, "post.", 5), 0);
    }
    fill_table(5, IDENTITY);
    assert_int_equal(masu_lut_set(s.m, table, 5, &detail), MASU_OK);
    assert_int_equal(masu_lut_set(s.m, table, 6, &detail), MASU_ERROR_ARGUMENT);
    assert_true(detail.needed == 5 && detail.given == 6);
    assert_int_equal(masu_lut_set(s.m, table, 1, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_lut_set(s.m, NULL, 5, &detail), MASU_ERROR_ARGUMENT);
    draw_rung(&s, 0, image[1][0]);
    assert_true(max_difference(image[0][0], image[1][0], sizeof image[0][0]) <= 1);
    draw(&s, &(masu_frame_desc){MASU_FRAME_DESC}, &commands, NULL);
    assert_int_equal(commands.frame, next + 1);
    close_session(&s);

    d.desc.post = 0;
    d.desc.lut_size = 0;
    open_session(&s, &d);
    for (size_t i = 0; i + 1 < sizeof good / sizeof *good; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .post = good[i]};
        assert_int_equal(masu_frame(s.m, &frame, &commands, &detail), MASU_ERROR_ARGUMENT);
    }
    assert_int_equal(masu_lut_set(s.m, table, 5, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_lut_set(s.m, NULL, 0, &detail), MASU_OK);
    masu_memory need;
    static const uint32_t descs[][3] = {{MASU_POST_ALL, 33, 0},    {MASU_POST_ALL, 2, 0},
                                        {MASU_POST_ALL + 1, 0, 1}, {MASU_POST_ALL, 34, 1},
                                        {MASU_POST_ALL, 1, 1},     {MASU_POST_FOCUS, 5, 1}};
    for (size_t i = 0; i < sizeof descs / sizeof *descs; i++) {
        masu_desc other = s.desc;
        other.post = descs[i][0], other.lut_size = descs[i][1];
        assert_int_equal(masu_memory_query(&other, &need, &detail),
                         descs[i][2] ? MASU_ERROR_ARGUMENT : MASU_OK);
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reserved_effects_of_strength_0_change_no_bit),
        cmocka_unit_test(they_cost_what_the_header_says),
        cmocka_unit_test(bloom_conserves_energy),
        cmocka_unit_test(bloom_has_the_same_width_at_every_resolution),
        cmocka_unit_test(depth_of_field_is_near_the_mean_over_a_lens),
        cmocka_unit_test(the_sharp_plane_stays_sharp),
        cmocka_unit_test(tables_map_colours),
        cmocka_unit_test(curves_are_their_formulas),
        cmocka_unit_test(values_beyond_their_limits_are_errors),
    };
    return cmocka_run_group_tests_name("post", tests, NULL, NULL);
}
