/* test_specular_truth.c: the reflection reference (debug.reference, masu render --reference)
 * against an independent tracer in double precision (tests/reference/specular.h) and in the white
 * furnace; temporal accumulation has the colours of the reference; pixels and tiles that the plan
 * skips are not traced; invalid materials give finite pixels.
 *
 * Both references are noisy. A pixel's reflection is the frame's radiance minus sun and ambient
 * light, by formula. Standard errors assume independent rays, also for the GPU, whose rays are more
 * uniform. Pixels are grouped by material, and the mean of each material must be within 3 standard
 * errors, and 0.2 % for the rounding of images: 9 bits of a ray's weight, half floats of its
 * light. */
#include "reference/specular.h"
#include "measure/shade.h"
#include "image.h"
#include "scene/scene.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/shadow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 66, H = 48, MATERIALS = 16, PIXELS = 192 /* of a material, at most */ };

static masu_session s;
static uint32_t slot;

/* On drivers after the first an eighth; the loss of precision is part of the expected errors. */
static uint32_t frames_of(uint32_t frames) {
    uint32_t quick = frames / 8 > 48 ? frames / 8 : 48;
    return trials(frames, frames / 2, quick);
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

#define METAL(r)                                                                                   \
    "\"material\": {\"base_color\": [0.9, 0.7, 0.5], \"roughness\": " #r ", \"metallic\": 1}"
#define VIEW                                                                                       \
    "\"camera\": {\"fov_y\": 40, \"near\": 0.05, \"keys\": [{\"position\": [0, 1.7, 4.4], "        \
    "\"target\": [0, 0.45, 0]}]}, \"reflections\": {\"cutoff\": 0.6}"
#define SKY "\"sky\": {\"zenith\": [0.25, 0.4, 0.8], \"horizon\": [0.7, 0.75, 0.85]}, "

/* Round and flat ones that reflect each other, matt objects and an emissive one, without a sun: its
 * highlight on a surface as smooth as 0.05, reflected in another, is so rare and bright that no
 * practical number of rays would converge. */
static const char round_ones[] =
    "{\"models\": ["
    "{\"mesh\": {\"plane\": {\"size_x\": 9, \"size_z\": 9}}, " METAL(
        0.2) "}, "
             "{\"mesh\": {\"sphere\": {\"radius\": 0.5, \"subdivisions\": 4}}, \"translate\": "
             "[-1.15, 0.5, 0], " METAL(
                 0.05) "}, "
                       "{\"mesh\": {\"sphere\": {\"radius\": 0.5, \"subdivisions\": 4}}, "
                       "\"translate\": [0, 0.5, 0], \"material\": "
                       "{\"base_color\": [0.5, 0.8, 0.9], \"roughness\": 0.2, \"metallic\": 1}}, "
                       "{\"mesh\": {\"sphere\": {\"radius\": 0.5, \"subdivisions\": 4}}, "
                       "\"translate\": [1.15, 0.5, 0], " METAL(
                           0.4) "}, "
                                "{\"mesh\": {\"sphere\": {\"radius\": 0.35, \"subdivisions\": 4}}, "
                                "\"translate\": [-0.6, 0.35, 1.2], \"material\": "
                                "{\"base_color\": [0.05, 0.1, 0.05], \"roughness\": 0.1}}, "
                                "{\"mesh\": {\"box\": {\"size\": [0.6, 0.5, 0.3]}}, \"translate\": "
                                "[0.7, 0.25, 1.2], \"rotate\": [0, 25, 0], \"material\": "
                                "{\"base_color\": [0.3, 0.02, 0.02], \"roughness\": 0.3}}, "
                                "{\"mesh\": {\"box\": {\"size\": [0.5, 1.4, 0.3]}}, \"translate\": "
                                "[-0.6, 0.7, -1.3], \"material\": "
                                "{\"base_color\": [0.1, 0.2, 0.7], \"roughness\": 1}}, "
                                "{\"mesh\": {\"box\": {\"size\": [0.5, 1.2, 0.3]}}, \"translate\": "
                                "[0.7, 0.9, -1.5], \"material\": "
                                "{\"base_color\": [0, 0, 0], \"emissive\": [3, 2, 1]}, "
                                "\"area_light\": false}], "
                                "\"sun\": {\"intensity\": 0}, \"ambient\": [0.3, 0.33, 0.4], " SKY
                                    VIEW "}";

/* Sunlit objects, all matt, reflected in glossy ones that do not reflect each other. */
static const char sunny[] =
    "{\"models\": ["
    "{\"mesh\": {\"plane\": {\"size_x\": 9, \"size_z\": 9}}, \"material\": "
    "{\"base_color\": [0.02, 0.02, 0.02], \"roughness\": 0.1}}, "
    "{\"mesh\": {\"box\": {\"size\": [0.6, 1, 0.6]}}, \"translate\": [-1.1, 0.5, 0], \"rotate\": "
    "[0, 30, 0], \"material\": "
    "{\"base_color\": [0.8, 0.3, 0.1], \"roughness\": 1}}, "
    "{\"mesh\": {\"sphere\": {\"radius\": 0.5, \"subdivisions\": 4}}, \"translate\": [0.1, 0.6, "
    "0], \"scale\": 1.2, \"material\": "
    "{\"base_color\": [0.7, 0.7, 0.7], \"roughness\": 0.9}}, "
    "{\"mesh\": {\"plane\": {\"size_x\": 1.4, \"size_z\": 1.2}}, \"translate\": [1.3, 0.7, 0.2], "
    "\"rotate\": [62, -35, 0], \"material\": "
    "{\"base_color\": [0.9, 0.9, 0.9], \"roughness\": 0.4, \"metallic\": 0.6}}], "
    "\"sun\": {\"azimuth\": 40, \"elevation\": 40, \"intensity\": 2}, \"ambient\": [0.3, 0.33, "
    "0.4], " SKY VIEW "}";

static void open_scene(const char *name, uint32_t width, uint32_t height, const masu_rung *rung,
                       uint32_t reference) {
    masu_session_desc d = test_desc(NULL, width, height);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_ALBEDO | MASU_READBACK_NORMAL |
                      MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    d.desc.debug.reference = reference;
    if (rung) d.desc.rungs[0] = *rung;
    open_session(&s, &d);
}

static void draw_frames(uint32_t frames, const masu_light *light) {
    for (uint32_t i = 0; i < frames; i++) {
        masu_frame_desc frame = {.light = light};
        masu_commands commands;
        draw(&s, &frame, &commands, NULL);
        slot = commands.slot;
    }
}

/* ---- Comparison with the tracer -------------------------------------------------------------- */

typedef struct group {
    uint32_t key, pixels, values, far; /* far: values with an error of more than 4 standard
                                          errors */
    double gpu, cpu, error2; /* sums over pixels, of the mean of colours */
    double square;           /* sum of (difference / its standard error)^2 */
    double worst;            /* maximum of those */
} group;

static group groups[MATERIALS];

static group *group_of(uint32_t key) {
    for (uint32_t i = 0; i < MATERIALS; i++) {
        if (groups[i].pixels && groups[i].key != key) continue;
        groups[i].key = key;
        return &groups[i];
    }
    fail_msg("more materials than %d", MATERIALS);
    return NULL;
}

/* Compares the last frame with rays; `off` scales the roughness, which must be detected unless it
 * is 1. */
static void compare(const char *name, const masu_ref_mirror *m, const double coat[2],
                    uint32_t frames, uint32_t rays, double off) {
    const float *depth = read_image(&s, slot, MASU_READBACK_DEPTH);
    const uint8_t *albedo = read_image(&s, slot, MASU_READBACK_ALBEDO);
    const uint32_t *normal = read_image(&s, slot, MASU_READBACK_NORMAL);
    const uint16_t *hdr = read_image(&s, slot, MASU_READBACK_HDR);
    memset(groups, 0, sizeof groups);
    for (uint32_t k = 0; k < W * H; k++) {
        uint32_t i = k * 1009 % (W * H); /* all over the image, for materials in many pixels */
        masu_ref_surface surface;
        double lit[3], mirrored[3], mean = 0, truth = 0, error2 = 0;
        if (!masu_ref_surface_of(m, i % W, i / W, depth[i], &albedo[4 * i], normal[i], &surface))
            continue;
        if (surface.look[3] >= 0.45) continue; /* traced only in part, or not at all */
        uint32_t key;
        memcpy(&key, &albedo[4 * i], sizeof key);
        group *g = group_of(key ^ (normal[i] >> 26 & 15) << 20);
        if (g->pixels == PIXELS) continue;
        masu_shade_exact(&m->view, surface.direction, surface.normal, surface.look, lit, mirrored);
        surface.look[3] *= off;
        surface.coat = coat[0];
        surface.coat_roughness = coat[1] * off;
        masu_ref_estimate e = masu_ref_mirrored(m, &surface, rays, i + 1);
        for (int c = 0; c < 3; c++) {
            double gpu = half_float(hdr[4 * i + c]) - lit[c];
            double rounded = 0.002 * e.mean[c] + 0.0005 * lit[c];
            double se2 = e.variance[c] / rays + e.variance[c] / frames + rounded * rounded;
            double z2 = (gpu - e.mean[c]) * (gpu - e.mean[c]) / se2;
            assert_true(isfinite(gpu));
            mean += gpu / 3;
            truth += e.mean[c] / 3;
            /* the errors of the colours are correlated */
            error2 += e.variance[c] * (1.0 / rays + 1.0 / frames) / 3;
            g->square += fmin(z2, 16); /* a pixel on an edge, for which the two find another
                                          neighbour */
            g->far += z2 > 16;
            g->worst = worst_of(g->worst, sqrt(z2));
            g->values++;
        }
        g->pixels++;
        g->gpu += mean;
        g->cpu += truth;
        g->error2 += error2;
    }
    for (uint32_t i = 0; i < MATERIALS && groups[i].pixels; i++) {
        const group *g = &groups[i];
        double n = g->pixels, d = (g->gpu - g->cpu) / n, se = sqrt(g->error2) / n;
        print_message(
            "  %s, roughness %.3f, %3u pixels: %.5f against %.5f (%+.2f %%, %+.1f standard errors);"
            " of a pixel %.2f, at most %.1f\n",
            name, (g->key >> 24) / 255.0, g->pixels, g->gpu / n, g->cpu / n, 100 * d / (g->cpu / n),
            d / se, sqrt(g->square / g->values), g->worst);
    }
}

static double worst_group(double *chi, double *far) {
    double worst = 0;
    *chi = *far = 0;
    for (uint32_t i = 0; i < MATERIALS && groups[i].pixels; i++) {
        const group *g = &groups[i];
        double n = g->pixels, d = fabs(g->gpu - g->cpu) / n, se = sqrt(g->error2) / n;
        worst = worst_of(worst, d / (3 * se + 0.002 * g->cpu / n));
        *chi = fmax(*chi, g->square / g->values);
        *far = fmax(*far, (double)g->far / g->values);
    }
    return worst;
}

/* coat: its fraction of the reflections, and its roughness. */
static void tracer(const char *name, const char *json, uint32_t materials, const double coat[2],
                   uint32_t frames) {
    masu_ref_mirror m;
    masu_camera camera;
    char error[ERROR_SIZE];
    double chi, far, worst;
    bake_scene(name, json);
    open_scene(name, W, H, NULL, 1);
    assert_int_equal(masu_camera_at(s.m, 0, &camera, NULL), MASU_OK);
    draw_frames(frames, NULL);
    assert_int_equal(stats_of(&s, slot).replaced, 0);
    masu_scene scene;
    masu_detail detail;
    uint8_t *blob = NULL;
    size_t bytes = 0;
    assert_ok(masu_file_read(baked_scene(name), 1u << 30, &blob, &bytes, error, sizeof error));
    assert_int_equal(masu_scene_bind(blob, bytes, &scene, &detail), MASU_OK);
    assert_ok(masu_ref_mirror_open(&scene, &camera, W, H, &m, error, sizeof error));
    const uint32_t rays = trials(512, 256, 256);
    compare(name, &m, coat, frames, rays, 1);
    worst = worst_group(&chi, &far);
    uint32_t found = 0;
    for (uint32_t i = 0; i < MATERIALS && groups[i].pixels; i++) {
        found++;
        assert_true(fabs(groups[i].gpu / groups[i].cpu - 1) < 0.01);
    }
    assert_int_equal(found, materials);
    assert_true(worst < 1);
    assert_true(chi < 1.2);
    assert_true(far < 0.02);
    /* And lobes that are half as rough again are distinguished. */
    compare("half as rough again", &m, coat, frames, rays / 4, 1.5);
    worst = worst_group(&chi, &far);
    assert_true(worst > 1 || chi > 1.5);
    masu_ref_mirror_close(&m);
    free(blob);
    close_session(&s);
}

static void round_ones_agree_with_the_tracer(void **state) {
    (void)state;
    tracer("round", round_ones, 6, (const double[]){0, 0}, frames_of(512));
}

static void sunny_ones_agree_with_the_tracer(void **state) {
    (void)state;
    tracer("sunny", sunny, 2, (const double[]){0, 0}, frames_of(192));
}

/* A coated object with no other around, so that none is reflected in another. Without sun and
 * ambient light, of which a coat takes a part from the base. */
#define COATED(roughness)                                                                          \
    "{\"models\": [{\"mesh\": {\"sphere\": {\"radius\": 1, \"subdivisions\": 5}}, \"translate\": "    \
    "[0, 0.6, 0], \"material\": {\"base_color\": [0.9, 0.5, 0.2], \"metallic\": 1, "                 \
    "\"roughness\": 0.4, \"coat\": 1, \"coat_roughness\": " #roughness "}}, "                        \
    "{\"mesh\": {\"box\": {\"size\": [2, 1, 0.3]}}, \"translate\": [-2, 2, 3], \"material\": "       \
    "{\"base_color\": [0, 0, 0], \"emissive\": [2, 3, 4]}, \"area_light\": false}, "                                      \
    "{\"mesh\": {\"box\": {\"size\": [0.3, 2, 1]}}, \"translate\": [2, 0.5, 1], \"material\": "      \
    "{\"base_color\": [0, 0, 0], \"emissive\": [2, 0.5, 0.5]}, \"area_light\": false}], "                                 \
    "\"sun\": {\"intensity\": 0}, \"ambient\": [0, 0, 0], " SKY VIEW "}"

static void coats_agree_with_the_tracer(void **state) {
    (void)state;
    tracer("coat", COATED(0.2), 1, (const double[]){1, 0.2}, frames_of(192));
    tracer("mirror-coat", COATED(0), 1, (const double[]){1, 0}, frames_of(192));
}

/* ---- The white furnace ----------------------------------------------------------------------- */

#define BALL(x, y, rest)                                                                           \
    "{\"mesh\": {\"sphere\": {\"radius\": 0.42, \"subdivisions\": 4}}, \"translate\": [" #x ", " #y  \
    ", 0], \"material\": {\"base_color\": [1, 1, 1], " rest "}}"

/* From the left: smoother to rougher; then coats, of which the last but one is rougher than the
 * cut-off and than its base, and the last the reverse. */
#define BALLS                                                                                      \
    BALL(-2, 1, "\"metallic\": 1, \"roughness\": 0")                                               \
    ", " BALL(-1, 1, "\"metallic\": 1, \"roughness\": 1e-4") ", "                                  \
    BALL(0, 1, "\"metallic\": 1, \"roughness\": 0.2") ", "                                         \
    BALL(1, 1, "\"metallic\": 1, \"roughness\": 0.4") ", "                                         \
    BALL(2, 1, "\"metallic\": 1, \"roughness\": 0.7") ", "                                         \
    BALL(-2, 0, "\"metallic\": 1, \"roughness\": 1") ", "                                          \
    BALL(-1, 0, "\"metallic\": 0, \"roughness\": 0") ", "                                          \
    BALL(0, 0, "\"metallic\": 0, \"roughness\": 0.2") ", "                                         \
    BALL(1, 0, "\"metallic\": 0, \"roughness\": 0.5") ", "                                         \
    BALL(2, 0, "\"metallic\": 0, \"roughness\": 1") ", "                                           \
    BALL(-2, -1, "\"metallic\": 1, \"roughness\": 0.3, \"coat\": 1, \"coat_roughness\": 0") ", "   \
    BALL(-1, -1, "\"metallic\": 0, \"roughness\": 0.2, \"coat\": 0.5, \"coat_roughness\": 0.3") ", " \
    BALL(0, -1, "\"metallic\": 1, \"roughness\": 0.1, \"coat\": 1, \"coat_roughness\": 0.4") ", "  \
    BALL(1, -1, "\"metallic\": 1, \"roughness\": 0.1, \"coat\": 1, \"coat_roughness\": 0.9") ", "  \
    BALL(2, -1, "\"metallic\": 1, \"roughness\": 0.9, \"coat\": 1, \"coat_roughness\": 0.1")
#define BALLS_SEEN                                                                                 \
    "\"camera\": {\"fov_y\": 30, \"near\": 0.05, \"keys\": [{\"position\": [0, 0, 6.4], "          \
    "\"target\": [0, 0, 0]}]}"

static const char furnace[] =
    "{\"models\": [" BALLS "], \"sun\": {\"intensity\": 0}, \"ambient\": [1, 1, 1], "
    "\"sky\": {\"zenith\": [1, 1, 1], \"horizon\": [1, 1, 1]}, " BALLS_SEEN ", "
    "\"reflections\": {\"cutoff\": 0.6}}";

static uint32_t ball_of(uint32_t x, uint32_t y) {
    double px = ((x + 0.5) / 100 * 2 - 1) * tan(15 * 3.14159265358979 / 180) * 100 / 60 * 6.4;
    double py = -((y + 0.5) / 60 * 2 - 1) * tan(15 * 3.14159265358979 / 180) * 6.4;
    return (uint32_t)(rint(px) + 2) + 5 * (uint32_t)(1 - rint(py));
}

/* White surfaces return all light; for each ball the mean, and any single pixel. */
static void furnace_with(const char *how, uint32_t reference, uint32_t frames, double of_pixel) {
    static double sum[15], low[15], high[15];
    static uint32_t pixels[15];
    double worst = 0, worst_pixel = 0;
    open_scene("furnace", 100, 60, NULL, reference);
    draw_frames(frames, NULL);
    const uint16_t *hdr = read_image(&s, slot, MASU_READBACK_HDR);
    const float *depth = read_image(&s, slot, MASU_READBACK_DEPTH);
    for (int b = 0; b < 15; b++) sum[b] = high[b] = 0, low[b] = 1e9, pixels[b] = 0;
    for (uint32_t i = 0; i < 100 * 60; i++) {
        if (!(depth[i] > 0.0f)) continue;
        uint32_t b = ball_of(i % 100, i / 100);
        assert_true(b < 15);
        for (int c = 0; c < 3; c++) {
            double x = half_float(hdr[4 * i + c]);
            assert_true(isfinite(x));
            sum[b] += x / 3;
            low[b] = fmin(low[b], x);
            high[b] = fmax(high[b], x);
        }
        pixels[b]++;
    }
    assert_int_equal(stats_of(&s, slot).replaced, 0);
    close_session(&s);
    for (int b = 0; b < 15; b++) {
        print_message("  furnace, %s, ball %2d: %u pixels, mean %.4f, %.4f to %.4f\n", how, b,
                      pixels[b], sum[b] / pixels[b], low[b], high[b]);
        assert_true(pixels[b] > 80);
        worst = worst_of(worst, fabs(sum[b] / pixels[b] - 1));
        worst_pixel = worst_of(worst_pixel, fmax(1 - low[b], high[b] - 1));
    }
    assert_true(worst < 0.01);
    assert_true(worst_pixel < of_pixel);
}

static void all_light_comes_back_in_the_white_furnace(void **state) {
    (void)state;
    bake_scene("furnace", furnace);
    uint32_t frames = frames_of(128);
    furnace_with("reference", 1, frames, 0.05 * 128.0 / frames);
    furnace_with("frames", 0, 2, 0.01);
}

/* ---- Ray weights ----------------------------------------------------------------------------- */

/* A dull dark street towards a red wall, under a blue sky. It begins in front of the camera: on
 * surfaces that the near plane clips, SwiftShader's depths have errors of a few thousandths, and
 * rays begin below them. */
static const char street[] =
    "{\"models\": ["
    "{\"mesh\": {\"plane\": {\"size_x\": 24, \"size_z\": 18}}, \"translate\": [0, 0, -5], "
    "\"material\": "
    "{\"base_color\": [0.02, 0.02, 0.02], \"roughness\": 0.35}}, "
    "{\"mesh\": {\"box\": {\"size\": [60, 4, 0.5]}}, \"translate\": [0, 2, -14], \"material\": "
    "{\"base_color\": [0, 0, 0], \"emissive\": [2, 0.4, 0.1]}, \"area_light\": false}], "
    "\"sun\": {\"intensity\": 0}, \"ambient\": [0, 0, 0], "
    "\"sky\": {\"zenith\": [0.1, 0.3, 1], \"horizon\": [0.1, 0.3, 1]}, "
    "\"camera\": {\"fov_y\": 40, \"near\": 0.05, \"keys\": [{\"position\": [0, 1, 6], \"target\": "
    "[0, 0.4, -4]}]}, "
    "\"reflections\": {\"cutoff\": 0.6}}";

/* The mean of each colour in the lower two fifths of the image, which is all street. */
static void colors_of_street(const masu_rung *rung, uint32_t reference, uint32_t frames,
                             double mean[3]) {
    open_scene("street", W, H, rung, reference);
    draw_frames(frames, NULL);
    const uint16_t *hdr = read_image(&s, slot, MASU_READBACK_HDR);
    uint32_t first = W * (H * 3 / 5), pixels = W * H - first;
    for (int c = 0; c < 3; c++) {
        mean[c] = 0;
        for (uint32_t i = first; i < W * H; i++) mean[c] += half_float(hdr[4 * i + c]) / pixels;
    }
    close_session(&s);
}

/* By Fresnel's term, rays towards the wall have several times the weight of rays that go up. With
 * equal weights red would have an error of a quarter. */
static void means_have_the_colors_of_the_reference(void **state) {
    (void)state;
    bake_scene("street", street);
    const masu_rung past = {.scale = 1.0f, .temporal = MASU_ON}, *rungs[] = {NULL, &past};
    double reference[3], mean[3], worst = 0;
    colors_of_street(NULL, 1, frames_of(384), reference);
    for (int i = 0; i < 2; i++) {
        colors_of_street(rungs[i], 0, 96, mean);
        for (int c = 0; c < 3; c++) worst = worst_of(worst, fabs(mean[c] / reference[c] - 1));
        print_message("  street%s: %.4f %.4f %.4f, reference %.4f %.4f %.4f\n",
                      i ? " with temporal upscaling" : "", mean[0], mean[1], mean[2],
                      reference[0], reference[1], reference[2]);
    }
    assert_true(worst < 0.03);
}

/* ---- Skipped pixels -------------------------------------------------------------------------- */

/* From the front: a matt wall, and before it two plates, each covering a quarter of the wall. */
static const char plates[] =
    "{\"models\": [{\"mesh\": {\"box\": {\"size\": [40, 40, 0.1]}}, \"translate\": [0, 0, -1], "
    "\"material\": "
    "{\"base_color\": [0.4, 0.4, 0.4], \"roughness\": 0.9}}, "
    "{\"mesh\": {\"box\": {\"size\": [10, 10, 0.1]}}, \"translate\": [-5, 5, 0], \"material\": "
    "{\"base_color\": [0.4, 0.4, 0.4], \"roughness\": 0.1}}, "
    "{\"mesh\": {\"box\": {\"size\": [10, 10, 0.1]}}, \"translate\": [5, -5, 0], \"material\": "
    "{\"base_color\": [0.4, 0.4, 0.4], \"roughness\": 0.3}}], "
    "\"camera\": {\"fov_y\": 60, \"near\": 0.05, \"keys\": [{\"position\": [0, 0, 5], \"target\": "
    "[0, 0, 0]}]}, "
    "\"reflections\": {\"cutoff\": 0.5}}";

static void only_tiles_that_mirror_are_traced(void **state) {
    (void)state;
    static const struct {
        masu_rung rung;
        uint32_t reference, tiles, rays; /* of 36 tiles of 64 texels; with a reference of 256 */
    } cases[] = {{{.scale = 1}, 0, 18, 18 * 64},
                 {{.scale = 1, .specular_cutoff = 0.2f}, 0, 9, 9 * 64},
                 {{.scale = 1, .specular_cutoff = 0.05f}, 0, 0, 0},
                 {{.scale = 1, .specular = MASU_OFF}, 0, 0, 0},
                 {{.scale = 1, .specular_cutoff = 1}, 0, 36, 36 * 64},
                 {{.scale = 1, .specular_cutoff = 0.2f}, 1, 36, 36 * 64}};
    bake_scene("plates", plates);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (i > 1 && !whole_run()) break;
        open_scene("plates", 96, 96, &cases[i].rung, cases[i].reference);
        draw_frames(2, NULL);
        masu_stats_info stats = stats_of(&s, slot);
        print_message("  cut-off %.2f: %u tiles, %u rays\n", (double)cases[i].rung.specular_cutoff,
                      (uint32_t)stats.specular_tiles, (uint32_t)stats.specular_rays);
        assert_int_equal(stats.specular_tiles, cases[i].tiles);
        assert_int_equal(stats.specular_rays, cases[i].rays);
        assert_true(stats.specular_hits <= stats.specular_rays);
        assert_true(!stats.specular_rays == !stats.specular_nodes);
        close_session(&s);
    }
}

/* ---- Invalid materials and light ------------------------------------------------------------- */

static const char bright[] =
    "{\"models\": [" BALLS
    ", {\"mesh\": {\"box\": {\"size\": [8, 0.2, 8]}}, \"translate\": [0, 3, 0], "
    "\"material\": {\"base_color\": [0, 0, 0], \"emissive\": [65504, 65504, 1]}, \"area_light\": "
    "false}], "
    "\"sun\": {\"intensity\": 1000}, \"ambient\": [1, 1, 1], " BALLS_SEEN ", "
    "\"reflections\": {\"cutoff\": 1}}";

/* Under light beyond the range of half floats, and from memory full of NaN and Inf. */
static void pixels_are_finite(void **state) {
    (void)state;
    static uint16_t pictures[4][4 * 100 * 60];
    bake_scene("bright", bright);
    for (uint32_t reference = 0; reference < 2; reference++) {
        for (uint32_t poison = 0; poison < (whole_run() ? 4 : 2); poison++) {
            masu_session_desc d = test_desc(NULL, 100, 60);
            d.scene_path = baked_scene("bright");
            d.desc.readback = MASU_READBACK_HDR;
            d.desc.rung_count = 1;
            d.desc.debug.reference = reference;
            d.desc.debug.poison = poison;
            open_session(&s, &d);
            draw_frames(3, NULL);
            const uint16_t *hdr = read_image(&s, slot, MASU_READBACK_HDR);
            for (uint32_t i = 0; i < 4 * 100 * 60; i++) {
                assert_true(isfinite(half_float(hdr[i])) && half_float(hdr[i]) >= 0);
                pictures[poison][i] = hdr[i];
            }
            close_session(&s);
            assert_memory_equal(pictures[poison], pictures[0], sizeof pictures[0]);
        }
    }
}

static const masu_memory_row *row_of(const char *name) {
    static masu_memory_row rows[MEMORY_ROWS];
    uint32_t count = memory_rows(s.m, rows);
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(rows[i].name, name) && !strcmp(rows[i].kind, "buffer")) return &rows[i];
    fail_msg("no buffer %s", name);
    return NULL;
}

/* A blob with a NaN is rejected; here it is written to the device's memory, to the materials of the
 * raster and of the rays. */
static void materials_of_nan_give_finite_pixels(void **state) {
    (void)state;
    static const uint32_t bits[] = {0x7FC00000u, 0x7F800000u, 0xFF800000u, 0x00000001u,
                                    0xC2C80000u};
    char error[ERROR_SIZE];
    bake_scene("bright", bright);
    for (uint32_t reference = 0; reference < 2; reference++) {
        masu_session_desc d = test_desc(NULL, 100, 60);
        d.scene_path = baked_scene("bright");
        d.desc.readback = MASU_READBACK_HDR;
        d.desc.rung_count = 1;
        d.desc.debug.reference = reference;
        d.no_renderer = true;
        open_session(&s, &d);
        assert_int_equal(masu_memory_query(&s.desc, &s.need, NULL), MASU_OK);
        const masu_role_need *need = &s.need.roles[MASU_ROLE_DEVICE];
        if (!need->host_visible) { /* its materials cannot be written after masu_init */
            close_session(&s);
            skip();
        }
        VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = need->bytes,
                                     .memoryTypeIndex = need->type};
        VkDeviceMemory memory;
        void *mapped = NULL;
        assert_int_equal(vkAllocateMemory(s.host.device, &info, NULL, &memory), VK_SUCCESS);
        assert_int_equal(vkMapMemory(s.host.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped),
                         VK_SUCCESS);
        s.desc.device_blocks[MASU_ROLE_DEVICE] =
            (masu_device_block){memory, 0, need->bytes, mapped, need->type};
        assert_ok(masu_session_start(&s, error, sizeof error));
        uint32_t *raster =
            (uint32_t *)(void *)((unsigned char *)mapped + row_of("materials")->offset);
        uint32_t *traced =
            (uint32_t *)(void *)((unsigned char *)mapped + row_of("traced scene")->offset);
        traced += 4 * (size_t)traced[4 * traced[3]]; /* shaders/trace/scene.glsl */
        uint32_t materials = masu_scene_count(&s.scene, MASU_SCENE_MATERIAL), given;
        memcpy(&given, &raster[3], sizeof given);
        assert_int_equal(traced[3], given); /* a roughness: the correct position */
        for (size_t b = 0; b < sizeof bits / sizeof *bits; b++) {
            /* each material has another invalid value, some have all */
            for (uint32_t i = 0; i < 12 * materials; i++) {
                uint32_t m = i / 12, k = i % 12;
                if (k != 3 && m % 4 && (m + b) % 12 != k) continue;
                raster[i] = traced[16 * m + k] = bits[b];
            }
            draw_frames(2, NULL);
            const uint16_t *hdr = read_image(&s, slot, MASU_READBACK_HDR);
            for (uint32_t i = 0; i < 4 * 100 * 60; i++)
                assert_true(isfinite(half_float(hdr[i])) && half_float(hdr[i]) >= 0);
        }
        masu_destroy(s.m);
        s.m = NULL;
        vkFreeMemory(s.host.device, memory, NULL);
        close_session(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_ones_agree_with_the_tracer),
        cmocka_unit_test(sunny_ones_agree_with_the_tracer),
        cmocka_unit_test(coats_agree_with_the_tracer),
        cmocka_unit_test(all_light_comes_back_in_the_white_furnace),
        cmocka_unit_test(means_have_the_colors_of_the_reference),
        cmocka_unit_test(only_tiles_that_mirror_are_traced),
        cmocka_unit_test(pixels_are_finite),
        cmocka_unit_test(materials_of_nan_give_finite_pixels),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
