/* test_occlusion.c: SDF shadows and SDF ambient occlusion against a reference in double precision
 * (tests/reference/occlusion.h), and properties that hold at any error: no acne, equal shadows on
 * polygons, no cost in scenes that do not request them.
 *
 * The scenes of scenes/ are baked here again with the options; the reference's fields are generated
 * by the SDF compiler and compiled by the C compiler. The table of errors is printed
 * (docs/design/06-ambient-occlusion.md). */
#include "support/support.h"
#include "support/floats.h"
#include "support/files.h"

#include "measure/truth.h"
#include "reference/occlusion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { W = 160, H = 90, MID_W = 120, MID_H = 90, SMALL_W = 66, SMALL_H = 48 };

static masu_session s;

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* NAME.json, from scenes/ or tests/scenes/, with more members in its "sdf", replacing those that
 * turn the effects off. */
static void bake_with(const char *name, const char *options) {
    static char json[1 << 15];
    char path[256], root[1024];
    const char *folder = "scenes";
    snprintf(path, sizeof path, "%s/%s.json", folder, name);
    if (access(path, R_OK))
        snprintf(path, sizeof path, "%s/%s.json", folder = "tests/scenes", name);
    char *text = read_file(path, NULL);
    static const char before[] = "\"source\": \"",
                      off[] = "\"shadows\": false, \"ambient_occlusion\": false";
    char *source = strstr(text, before), *last = strstr(source, off);
    assert_non_null(source);
    assert_non_null(last);
    memset(last, ' ', strlen(off));
    while (*last != ',') last--;
    *last = ' ';
    assert_non_null(getcwd(root, sizeof root));
    snprintf(json, sizeof json, "%.*s%s%s%s/%s/%s", (int)(source - text), text, options, before,
             root, folder, source + strlen(before));
    free(text);
    bake_scene(name, json);
}

static void open_scene(const char *name, uint32_t width, uint32_t height) {
    masu_session_desc d = test_desc(NULL, width, height);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_ALL;
    d.desc.rung_count = 1;
    open_session(&s, &d);
}

static void draw_once(void) {
    masu_frame_desc frame = {0};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
}

/* The session has freed its blob: the scene is read again. */
static void look_at(const char *name, const masu_camera *camera, masu_view *view) {
    char error[ERROR_SIZE];
    masu_scene scene;
    size_t bytes;
    void *blob = read_file(baked_scene(name), &bytes);
    assert_int_equal(masu_scene_bind(blob, bytes, &scene, NULL), MASU_OK);
    assert_ok(masu_view_of(&scene, camera, 0, W, H, view, error, sizeof error));
    free(blob);
}

/* ---- Comparison with the reference ----------------------------------------------------------- */

typedef struct errors {
    double squares, most;
    uint32_t count, wrong; /* wrong: visible or not, while the reference is certain of the
                              opposite */
} errors;

static void note(errors *e, double truth, double is) {
    double d = fabs(is - truth);
    e->squares += d * d;
    e->most = worst_of(e->most, d);
    e->wrong += (truth == 0 || truth == 1) && d > 0.5;
    e->count++;
}

static double rmse(const errors *e) { return e->count ? sqrt(e->squares / e->count) : 0; }

static void compare(const masu_truth *truth, const masu_view *view, double tangent, uint32_t stride,
                    errors *sun, errors *ambient) {
    const uint32_t *seen = read_image(&s, 0, MASU_READBACK_OCCLUSION);
    const uint32_t *normals = read_image(&s, 0, MASU_READBACK_NORMAL);
    const float *depths = read_image(&s, 0, MASU_READBACK_DEPTH);
    masu_ref_field field = {truth->step, view->params, view->time, {0}, {0}};
    memcpy(field.low, view->sdf_min, sizeof field.low);
    memcpy(field.high, view->sdf_max, sizeof field.high);
    for (uint32_t y = stride / 2; y < view->height; y += stride) {
        for (uint32_t x = stride / 2; x < view->width; x += stride) {
            uint32_t at = y * view->width + x;
            masu_view_ray ray = masu_view_ray_at(view, x, y);
            masu_truth_sample hit;
            masu_truth_march(truth, view, &ray, &hit);
            if (hit.kind != MASU_TRUTH_HIT || !(depths[at] > 0) || normals[at] >> 30) continue;
            /* A surface other than the march found is an error of the march. */
            double t = view->near_distance / (double)depths[at] * ray.z_scale;
            if (fabs(t - hit.t) > 0.01 * hit.t) continue;
            double p[3], n_l = 0;
            for (int k = 0; k < 3; k++) {
                p[k] = view->eye[k] + ray.direction[k] * hit.t;
                n_l += hit.normal[k] * view->sun_direction[k];
            }
            if (ambient)
                note(ambient, masu_ref_ambient_seen(&field, p, hit.normal, 1, 256),
                     ambient_share(seen, at));
            if (n_l <= 0.02) continue; /* the sun hardly matters at this angle */
            note(sun,
                 masu_ref_sun_seen(&field, p, hit.normal, view->sun_direction, tangent,
                                   view->max_distance, 128),
                 sun_share(seen, at));
        }
    }
}

/* The stated bounds: RMS and maximum error of the sun, of the ambient light. */
static const struct {
    const char *scene;
    double radius; /* of the sun, degrees */
    double sun, sun_most, ambient, ambient_most;
    enum { EVERYWHERE, FIRST_DRIVER, LONG_RUN } when;
} stated[] = {{"spheres", 0.27, 0.02, 0.4, 0.03, 0.2, FIRST_DRIVER},
              {"spheres", 2, 0.015, 0.2, 0.03, 0.2, LONG_RUN},
              {"city", 0.27, 0.05, 0.9, 0.05, 0.4, LONG_RUN},
              {"city", 2, 0.03, 0.3, 0.05, 0.4, LONG_RUN},
              {"blobs", 0.27, 0.03, 0.5, 0.06, 0.4, LONG_RUN},
              {"blobs", 2, 0.03, 0.3, 0.06, 0.4, LONG_RUN},
              {"tunnel", 0.27, 0.02, 0.3, 0.05, 0.4, EVERYWHERE},
              /* So many parts that each block of pixels lists only a few: a part missing in a list
               * is an error here. */
              {"parts300", 1, 0.03, 0.3, 0.06, 0.4, EVERYWHERE}};

static void the_error_against_the_truth_is_as_stated(void **state) {
    (void)state;
    const char *cc = getenv("CC");
    int failed = 0;
    for (size_t i = 0; i < sizeof stated / sizeof *stated; i++) {
        const char *name = stated[i].scene;
        if (stated[i].when == LONG_RUN && !long_run()) continue;
        if (stated[i].when == FIRST_DRIVER && !whole_run()) continue;
        char options[256], path[256], error[ERROR_SIZE];
        snprintf(options, sizeof options,
                 "\"shadows\": {\"sun_radius\": %g}, \"ambient_occlusion\": {}, ",
                 stated[i].radius);
        bake_with(name, options);
        if (shell("test -e %s/%s.so || { %s/bin/masu-sdfc %s/%s.sdf --c %s/%s.c --quiet && "
                  "%s -std=c11 -O3 -w -shared -fPIC -o %s/%s.so %s/%s.c -lm; }",
                  scratch, name, build_dir(), strcmp(name, "parts300") ? "scenes" : "tests/scenes",
                  name, scratch, name, cc && *cc ? cc : "cc", scratch, name, scratch, name))
            fail_msg("no reference of %s", name);
        masu_truth truth;
        masu_view view;
        masu_camera camera;
        masu_stats_info stats;
        errors sun = {0}, ambient = {0};
        snprintf(path, sizeof path, "%s/%s.so", scratch, name);
        assert_ok(masu_truth_open(path, &truth, error, sizeof error));
        open_scene(name, W, H);
        draw_once();
        assert_int_equal(masu_camera_at(s.m, 0, &camera, NULL), MASU_OK);
        stats = stats_of(&s, 0);
        look_at(name, &camera, &view);
        /* Each evaluation of 300 parts takes as long as a hundred in other scenes. */
        uint32_t stride = strcmp(name, "parts300") ? trials(5, 7, 7) : trials(5, 8, 8);
        compare(&truth, &view, tan(stated[i].radius * 3.14159265358979 / 180), stride, &sun,
                &ambient);
        close_session(&s);
        masu_truth_close(&truth);
        print_message("%-8s %.2f: sun %.3f most %.2f wrong %u of %u, ambient %.3f most %.2f of %u, "
                      "evaluations a pixel: march %.1f sun %.1f ambient %.1f, open %llu\n",
                      name, stated[i].radius, rmse(&sun), sun.most, sun.wrong, sun.count,
                      rmse(&ambient), ambient.most, ambient.count,
                      (double)stats.sdf_evals / (W * H), (double)stats.shadow_evals / (W * H),
                      (double)stats.occlusion_evals / (W * H),
                      (unsigned long long)stats.shadow_unconverged);
        assert_true(sun.count > 60 && ambient.count > 80);
        failed |= !(rmse(&sun) <= stated[i].sun && sun.most <= stated[i].sun_most);
        failed |= !(rmse(&ambient) <= stated[i].ambient && ambient.most <= stated[i].ambient_most);
        failed |= sun.wrong * 100 > sun.count; /* at most 1 % */
        failed |= stats.replaced != 0;
    }
    assert_false(failed);
}

/* ---- Properties at any error ----------------------------------------------------------------- */

/* A scene of one .sdf text under a sun at 40 degrees, viewed along -z and slightly down. scale: of
 * all lengths; the texts use it as SCALE. */
static void bake_sdf(const char *name, const char *sdf, const char *models, const char *sun,
                     double scale, const char *options) {
    char text[1024], json[2048];
    snprintf(text, sizeof text, "let k = %g;\n%s", scale, sdf);
    snprintf(json, sizeof json, "%s.sdf", name);
    write_text(json, text);
    snprintf(json, sizeof json,
             "{%s \"camera\": {\"fov_y\": 50, \"near\": %g, \"keys\": [{\"position\": [0, %g, %g], "
             "\"target\": [0, 0, 0]}]}, \"sun\": {%s}, \"ambient\": [0.25, 0.25, 0.25], "
             "\"sdf\": {\"source\": \"%s.sdf\", \"bounds\": [[%g, %g, %g], [%g, %g, %g]], "
             "\"max_distance\": %g, %s}}",
             models, 0.05 * scale, 3 * scale, 5 * scale, sun, name, -40 * scale, -3 * scale,
             -40 * scale, 40 * scale, 20 * scale, 40 * scale, 200 * scale, options);
    bake_scene(name, json);
}

static const char *const plain_sun = "\"azimuth\": 70, \"elevation\": 40";
static const char *const hard = "\"shadows\": {}, \"ambient_occlusion\": {}";

/* Only a plane, a sphere, a box: no point of a convex solid occludes the sun or the sky for another
 * point that faces it. */
static void nothing_shadows_itself(void **state) {
    (void)state;
    static const double scales[] = {1, 1000};
    static const char *const fields[] = {
        "part a = plane((0, 1, 0), 0);", "part a = sphere(2 * k);",
        "part a = rotate_euler((0.3, 0.5, 0.2), box((k, 2 * k, k)));"};
    for (int i = 0; i < 6; i++) {
        const double scale = scales[i % 2];
        /* Otherwise each field at one size; on drivers after the first two fields only: each takes
         * seconds to compile. */
        if ((i == 0 || i == 3 || i == 4) && !long_run()) continue;
        if (i == 1 && !whole_run()) continue;
        char options[128];
        snprintf(options, sizeof options,
                 "\"shadows\": {}, \"ambient_occlusion\": {\"radius\": %g}", scale);
        bake_sdf("alone", fields[i / 2], "", plain_sun, scale, options);
        open_scene("alone", 240, 180);
        draw_once();
        const uint32_t *seen = read_image(&s, 0, MASU_READBACK_OCCLUSION),
                       *normals = read_image(&s, 0, MASU_READBACK_NORMAL);
        const float *depths = read_image(&s, 0, MASU_READBACK_DEPTH);
        uint32_t looked = 0, dark = 0, closed = 0;
        for (uint32_t k = 0; k < 240 * 180; k++) {
            float n[3];
            masu_unpack_normal(normals[k], n);
            const double e = 40 * 3.14159265 / 180, a = 70 * 3.14159265 / 180;
            double n_l = (double)n[0] * cos(e) * sin(a) + (double)n[1] * sin(e) +
                         (double)n[2] * cos(e) * cos(a);
            if (!(depths[k] > 0) || n_l < 0.02) continue;
            looked++;
            dark += sun_share(seen, k) < 0.999;
            closed += ambient_share(seen, k) < 0.98;
        }
        close_session(&s);
        /* The normal at an edge is between those of its faces: the box itself occludes some sky
         * there. */
        if (dark || (closed && i / 2 < 2) || closed * 100 > looked)
            fail_msg("field %d, scale %g: %u of %u in the shadow, %u occluded", i / 2, scale, dark,
                     looked, closed);
        assert_true(looked > 2000);
    }
}

/* The sphere is left of the image, its shadow is inside. The lists of tiles do not have the sphere;
 * the pass's own lists must. */
static void what_is_out_of_sight_casts_its_shadow(void **state) {
    (void)state;
    bake_sdf("aside",
             "part ground = plane((0, 1, 0), 0);\n"
             "part caster = translate((-12, 8, 0), sphere(1.5));\n"
             "for i in 0..6 { part other = translate((30, 2 * i, 30), sphere(0.5)); }\n",
             "", "\"direction\": [-12, 8, 0]", 1, hard);
    open_scene("aside", MID_W, MID_H);
    draw_once();
    const uint32_t *seen = read_image(&s, 0, MASU_READBACK_OCCLUSION);
    const uint32_t *normals = read_image(&s, 0, MASU_READBACK_NORMAL);
    uint32_t dark = 0;
    for (uint32_t k = 0; k < MID_W * MID_H; k++) dark += normals[k] && sun_share(seen, k) < 0.1;
    /* The origin is on the line to the sun. */
    assert_true(sun_share(seen, MID_H / 2 * MID_W + MID_W / 2) < 0.01);
    /* An ellipse of half axes 1.5 and 1.5 / sin(33.7 degrees) at distance 5.8, approximately. */
    assert_in_range(dark, 300, 4000);
    assert_true(sun_share(seen, 84 * MID_W + 112) > 0.99);
    close_session(&s);
}

/* An SDF sphere over a polygon floor, the sun straight above. */
static void an_sdf_shadows_polygons(void **state) {
    (void)state;
    bake_sdf("floor", "part caster = translate((0, 1, 0), sphere(0.7));\n",
             "\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 12, \"size_z\": 12}}}],",
             "\"direction\": [0, 1, 0], \"color\": [1, 1, 1]", 1, hard);
    open_scene("floor", MID_W, MID_H);
    draw_once();
    const uint32_t *seen = read_image(&s, 0, MASU_READBACK_OCCLUSION);
    const uint16_t *hdr = read_image(&s, 0, MASU_READBACK_HDR);
    const uint32_t shadow = MID_H / 2 * MID_W + MID_W / 2, light = MID_H / 2 * MID_W + 6;
    assert_true(sun_share(seen, shadow) < 0.001);
    assert_true(ambient_share(seen, shadow) < 1.0 && ambient_share(seen, shadow) > 0.5);
    assert_true(sun_share(seen, light) > 0.999);
    assert_true(ambient_share(seen, light) > 0.99);
    /* Halves order like their bits. */
    assert_true(hdr[4 * shadow] > 0 && hdr[4 * shadow] < hdr[4 * light]);
    close_session(&s);
}

static uint64_t image_bytes(const masu_plan_info *plan, const char *name) {
    for (uint32_t i = 0; i < plan->image_count; i++)
        if (!strcmp(plan->images[i].name, name)) return plan->images[i].bytes;
    fail_msg("there is no image %s", name);
    return 0;
}

static void a_scene_that_does_not_ask_has_none_of_it(void **state) {
    (void)state;
    static masu_plan_info plan;
    static const char *const options[] = {"", "\"shadows\": {}, ", "\"ambient_occlusion\": {}, "};
    masu_readback_image out;
    masu_stats_info stats;
    if (!whole_run()) return; /* the plan does not depend on the driver */
    for (int i = 0; i < 3; i++) {
        bake_with("test_sphere_sdf", options[i]);
        open_scene("test_sphere_sdf", SMALL_W, SMALL_H);
        draw_once();
        masu_plan_of(s.m, &plan);
        stats = stats_of(&s, 0);
        assert_int_equal(pass_of(&plan, "sdf_occlusion")->active, i > 0);
        assert_int_equal(pass_of(&plan, "light_occluded")->active, i > 0);
        assert_int_equal(pass_of(&plan, "light")->active, i == 0);
        assert_string_equal(pass_of(&plan, "sdf_occlusion")->why,
                            i ? "the scene has SDF shadows or SDF ambient occlusion"
                              : "the scene has no SDF shadows or SDF ambient occlusion");
        assert_true((image_bytes(&plan, "occlusion") > 0) == (i > 0));
        assert_int_equal(masu_readback(s.m, 0, MASU_READBACK_OCCLUSION, &out, NULL),
                         i ? MASU_OK : MASU_ERROR_ARGUMENT);
        assert_true((stats.shadow_evals > 0) == (i == 1));
        assert_true((stats.occlusion_evals > 0) == (i == 2));
        close_session(&s);
    }
}

/* With a point sun, infinite rays and radii, or a field that is not finite, the image is still
 * finite. */
static void extremes_give_finite_pixels(void **state) {
    (void)state;
    static const char *const options[] = {
        "\"shadows\": {\"sun_radius\": 0, \"distance\": 1e15}, \"ambient_occlusion\": {\"radius\": "
        "1e6}, ",
        "\"shadows\": {\"sun_radius\": 20, \"distance\": 1e-3}, \"ambient_occlusion\": "
        "{\"radius\": "
        "1e-3}, "};
    static const char *const scenes[] = {"test_broken_field", "spheres", "test_both"};
    for (int i = 0; i < 6; i++) {
        /* Otherwise each scene once, and both options; on drivers after the first two scenes
         * only. */
        if (i != 0 && i != 3 && i != 4 && !long_run()) continue;
        if (i == 4 && !whole_run()) continue;
        bake_with(scenes[i / 2], options[i % 2]);
        open_scene(scenes[i / 2], SMALL_W, SMALL_H);
        draw_once();
        const uint32_t *seen = read_image(&s, 0, MASU_READBACK_OCCLUSION);
        const uint16_t *hdr = read_image(&s, 0, MASU_READBACK_HDR);
        const float *depths = read_image(&s, 0, MASU_READBACK_DEPTH);
        uint32_t surface = 0;
        double lit = 0;
        for (uint32_t k = 0; k < SMALL_W * SMALL_H; k++) {
            for (int c = 0; c < 4; c++) assert_true((hdr[4 * k + c] & 0x7C00) != 0x7C00);
            if (!(depths[k] > 0)) continue;
            surface++;
            lit += sun_share(seen, k);
        }
        assert_true(surface > 100);
        /* With a ray of a millimetre only the terminator is in shadow. */
        if (i % 2 && i / 2) assert_true(lit > 0.9 * surface);
        close_session(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_shadows_itself),
        cmocka_unit_test(what_is_out_of_sight_casts_its_shadow),
        cmocka_unit_test(an_sdf_shadows_polygons),
        cmocka_unit_test(a_scene_that_does_not_ask_has_none_of_it),
        cmocka_unit_test(extremes_give_finite_pixels),
        cmocka_unit_test(the_error_against_the_truth_is_as_stated),
    };
    return cmocka_run_group_tests_name("occlusion", tests, make_scratch, remove_scratch);
}
