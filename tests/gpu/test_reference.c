/* test_reference.c: the renderer against stored images of the path tracer of lab/reference, which
 * shares no code with it and follows the light paths and the closed material model that
 * docs/scene.md promises. Each scene is rendered with the most exact settings and compared by
 * patches (tools/measure/patches.h), because a wrong light, a missing shadow or a wrong lobe
 * changes the mean of a patch, not a pixel. lab/reference/stored.sh makes the images. */
#include "support/files.h"
#include "support/support.h"

#include "image.h"
#include "measure/patches.h"
#include "measure/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Patches of 6x6 pixels, or of 9x9 where `fine` is set. */
enum { W = 96, H = 54, FINE_W = 144, FINE_H = 81, POSITIONS = 28 };

/* Ratio of the means; 95th percentile of patches; mean square of the patches' errors over tolerance
 * and noise, without the largest tenth. */
#define RATIO 0.008
#define P95 0.035
#define TRIMMED 1.02

typedef struct row {
    const char *scene;
    double time;
    uint32_t rays;              /* reflection rays per pixel; 0: one per position */
    double ratio, p95, trimmed; /* limits; 0: those above. A higher limit has its reason in the
                                   row */
    bool animate, baked;        /* baked: by this program, from sky_scene */
    bool rare;                  /* only with LONG=1: shaded as another row */
    bool fine;                  /* its error depends on the size of a pixel */
} row;

static const row rows[] = {
    /* The scene's own sun is black, so the image keeps its sun, which rough look-ups blur */
    {.scene = "reference_sky", .baked = true, .p95 = 0.08, .trimmed = 1.3},
    {.scene = "test_shadows"},
    {.scene = "reference_rows"},
    {.scene = "reference_emission"},
    {.scene = "reference_masks"},
    {.scene = "reference_lights"},
    {.scene = "reference_air"},
    {.scene = "test_fog"},
    {.scene = "glass"},
    /* Blurred over one gap per pixel, from an image at half size: p95 0.150, worst patch 0.32;
     * rendered sharp 0.324, 0.66 */
    {.scene = "reference_glass", .fine = true, .p95 = 0.17, .trimmed = 1.3},
    /* Lobes: colours and strengths of specular light, sheen, anisotropy; separate coat normals, a
     * transmission map */
    {.scene = "reference_materials"},
    {.scene = "test_pane_maps"},
    {.scene = "test_pane"},
    {.scene = "night"},
    /* A mirror of roughness 0: the reference uses the smallest lobe, whose tail takes 0.8 % of
     * small bright lamps */
    {.scene = "test_reflections", .rays = 32, .ratio = 0.015, .p95 = 0.15},
    {.scene = "test_skin", .time = 0.5, .animate = true, .rays = 8},
    {.scene = "test_swing", .time = 0.3, .animate = true, .rays = 8},
    /* Vertex colours, lit, unlit and fading; emission with the second coordinates; a morph
     * target */
    {.scene = "reference_attributes", .time = 0.5, .animate = true, .rays = 8},
    {.scene = "test_foliage"},
    {.scene = "test_texture_mask"},
    {.scene = "test_texture_normals"},
    {.scene = "test_texture_quad"},
    {.scene = "test_town"},
    {.scene = "test_trace", .rays = 16},
    {.scene = "test_lods"},
    /* Glints of the sun from mirror to mirror: few pixels, half of whose light depends on the 16
     * positions */
    {.scene = "mirrors", .rays = 16, .ratio = 0.06},
    {.scene = "probe_open"},
    {.scene = "city"},
    {.scene = "blobs"},
    {.scene = "spheres", .rare = true},
    {.scene = "rods", .rare = true},
    {.scene = "tunnel", .rare = true},
    {.scene = "engine"},
    {.scene = "city_shadows"},
};
enum { ROWS = sizeof rows / sizeof *rows };

static masu_session s;
static float radiance[3 * FINE_W * FINE_H];

/* A panorama with a strong sun over a bright sky and a dark ground; then a scene of eight materials
 * in it. */
static void write_sky(const char *path) {
    enum { WIDE = 64, HIGH = 32 };
    static float rgb[3 * WIDE * HIGH];
    char error[ERROR_SIZE];
    for (int y = 0; y < HIGH; y++) {
        double up = cos(3.14159265358979 * (y + 0.5) / HIGH);
        for (int x = 0; x < WIDE; x++) {
            bool sun = (x == 22 || x == 23) && (y == 8 || y == 9);
            double level = sun ? 60 : up > 0 ? 0.35 + 0.3 * up : 0.12;
            for (int c = 0; c < 3; c++)
                rgb[3 * (y * WIDE + x) + c] = (float)(level * (sun      ? 1 - 0.1 * c
                                                               : up > 0 ? 0.7 + 0.25 * c
                                                                        : 1 - 0.2 * c));
        }
    }
    assert_ok(masu_image_save_pfm(path, rgb, WIDE, HIGH, 3, error, sizeof error));
}

static const char *sky_scene(void) {
    static char json[4096];
    size_t at = (size_t)snprintf(json, sizeof json, "{\"models\": [\n");
    for (int i = 0; i < 8; i++)
        at += (size_t)snprintf(
            json + at, sizeof json - at,
            "%s{\"mesh\": {\"sphere\": {\"radius\": 0.45, \"subdivisions\": 4}}, \"translate\": "
            "[%g, %g, 0], \"material\": {\"base_color\": [0.8, 0.7, 0.6], \"roughness\": %g, "
            "\"metallic\": %d}}",
            i ? ",\n" : "", i % 4 - 1.5, i < 4 ? 0.5 : -0.5, 0.25 * (i % 4 + 1), i < 4);
    snprintf(json + at, sizeof json - at,
             "],\n\"camera\": {\"fov_y\": 30, \"keys\": [{\"position\": [0, 0, 4.5], \"target\": "
             "[0, 0, 0]}]},\n"
             "\"sun\": {\"intensity\": 0}, \"environment\": {\"file\": \"sky.pfm\"}}\n");
    return json;
}

static void animate(double time) {
    for (uint32_t i = 0; i < masu_scene_count(&s.scene, MASU_SCENE_MODEL); i++) {
        masu_model model = masu_model_at(s.m, i);
        masu_clip_use use = {.loop = 1, .time = time, .weight = 1.0f};
        if (masu_model_clips(s.m, model))
            assert_int_equal(masu_model_animate(s.m, model, &use, 1, NULL), MASU_OK);
    }
}

static double or_else(double limit, double otherwise) { return limit > 0 ? limit : otherwise; }

/* The reference's light paths have no shadows of punctual lights. */
static void no_local_shadows(void) {
    for (uint32_t i = 0;; i++) {
        masu_punctual_light light = masu_punctual_light_at(s.m, i);
        if (!light.id) break;
        masu_punctual_light_state state;
        assert_int_equal(masu_punctual_light_get(s.m, light, &state, NULL), MASU_OK);
        state.no_shadow = 1;
        assert_int_equal(masu_punctual_light_set(s.m, light, &state, NULL), MASU_OK);
    }
}

static void compare(const masu_session_desc *d, const row *r) {
    char error[ERROR_SIZE], path[256];
    masu_reference reference;
    masu_patch patches[MASU_PATCHES];
    masu_session_desc own = *d;
    masu_frame_desc frame = {.time = r->time};
    const uint32_t width = d->desc.output.width, height = d->desc.output.height;
    snprintf(path, sizeof path, "tests/reference/%s.ref", r->scene);
    assert_ok(masu_reference_load(path, &reference, error, sizeof error));
    assert_true(reference.width * height == reference.height * width);
    masu_reference_free(&reference);
    assert_ok(masu_picture_open(&own, POSITIONS, &s, error, sizeof error));
    if (r->animate) animate(r->time);
    no_local_shadows();
    assert_ok(masu_picture_truth(&s, &frame, POSITIONS, r->rays,
                                 &(masu_picture_means){.linear = radiance}, NULL, error,
                                 sizeof error));
    close_session(&s);
    masu_patches_of(radiance, NULL, width, height, patches);
    masu_patch_judgement j = masu_patches_judge(reference.patches, patches);
    printf(
        "%s: mean %.4f of the reference, p95 %.4f, trimmed z^2 %.3f, worst patch %u,%u by %.3f\n",
        r->scene, j.ratio, j.p95, j.trimmed, j.worst % MASU_PATCH_COLUMNS,
        j.worst / MASU_PATCH_COLUMNS, j.worst_by);
    double ratio = or_else(r->ratio, RATIO), p95 = or_else(r->p95, P95),
           trimmed = or_else(r->trimmed, TRIMMED);
    if (!(fabs(j.ratio - 1) <= ratio) || !(j.p95 <= p95) || !(j.trimmed <= trimmed))
        fail_msg("%s differs from its reference: expected a mean of 1 +- %.3f, p95 <= %.3f, "
                 "trimmed z^2 <= %.2f",
                 r->scene, ratio, p95, trimmed);
}

static void a_scene_is_as_the_reference_has_it(void **state) {
    const row *r = *state;
    if (r->rare && !long_run()) return;
    masu_session_desc d = test_desc(r->baked ? NULL : r->scene, r->fine ? FINE_W : W,
                                    r->fine ? FINE_H : H);
    if (r->baked) {
        write_sky(in_scratch("sky.pfm"));
        bake_scene("sky", sky_scene());
        d.scene_path = in_scratch("sky.masu");
    }
    compare(&d, r);
}

/* "--sky": prints the scene, and writes its panorama to sky.pfm, for lab/reference/stored.sh. */
int main(int argc, char **argv) {
    if (argc > 1 && !strcmp(argv[1], "--sky")) {
        write_sky("sky.pfm");
        return fputs(sky_scene(), stdout) < 0;
    }
    struct CMUnitTest tests[ROWS];
    for (size_t i = 0; i < ROWS; i++) {
        row *r = (row *)(uintptr_t)&rows[i]; /* cmocka's state is not const */
        tests[i] =
            (struct CMUnitTest){rows[i].scene, a_scene_is_as_the_reference_has_it, NULL, NULL, r};
    }
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
