/* test_shadow.c: the shadow map at each pixel against rays towards the sun through the scene's
 * triangles in double precision: hard shadows by one ray to the sun's centre, the filter by 256
 * rays over its disc; no acne, light leaks at the foot of a caster, SDF and polygons together. The
 * figures are printed (docs/design/08-lights-shadows.md). test_shadow_frames.c has the properties
 * over frames. */
#include "support/files.h"
#include "support/floats.h"
#include "support/shadow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 240, H = 136 };

static shadow_test t;
static const masu_camera above = {
    .position = {0, 3, 6}, .forward = {0, -3, -6}, .fov_y = 0.873f, .near_distance = 0.1f};

/* ---- Scenes ---------------------------------------------------------------------------------- */

static char json[1 << 15];
static size_t used;

static void add(const char *format, ...) {
    va_list args;
    va_start(args, format);
    used += (size_t)vsnprintf(json + used, sizeof json - used, format, args);
    va_end(args);
    assert_true(used < sizeof json);
}

static void begin(void) {
    used = 0;
    add("{\"models\": [");
}

/* Not larger: in SwiftShader, depths of a plane of 200 m have errors of up to 0.2 %. */
#define GROUND "{\"mesh\": {\"plane\": {\"size_x\": 60, \"size_z\": 60}}}"
#define SPOT "{\"mesh\": {\"plane\": {\"size_x\": 3, \"size_z\": 3}}}"

/* Adds the last of the models, then the rest of the scene, and bakes it. */
static void finish(const char *name, const char *last, uint32_t resolution, const char *more) {
    add("%s], \"sun\": {\"shadows\": {\"cascades\": 2, \"resolution\": %u, \"distance\": 40}}, "
        "\"camera\": {\"near\": 0.1}%s}",
        last, resolution, more);
    bake_scene(name, json);
}

static uint32_t next(uint32_t *r) {
    *r = *r * 1664525u + 1013904223u;
    return *r >> 8;
}

static double in(uint32_t *r, double low, double high) {
    return low + (high - low) * next(r) / (double)(1 << 24);
}

/* Forty boxes of 0.1 to 2 m, with arbitrary rotations. */
static void bake_boxes(void) {
    uint32_t r = 5;
    begin();
    for (int i = 0; i < 40; i++) {
        double size[3] = {in(&r, 0.1, 2), in(&r, 0.1, 2), in(&r, 0.1, 2)};
        double turn[3] = {in(&r, 0, 360), in(&r, 0, 360), in(&r, 0, 360)};
        double x = in(&r, -8, 8), y = in(&r, 0, 3), z = in(&r, -12, 3);
        add("{\"mesh\": {\"box\": {\"size\": [%g, %g, %g]}}, \"rotate\": [%g, %g, %g], "
            "\"translate\": [%g, %g, %g]}, ",
            size[0], size[1], size[2], turn[0], turn[1], turn[2], x, y, z);
    }
    finish("boxes", GROUND, 512, "");
}

/* Sheets without thickness and posts of 2 cm, less than a texel. */
static void bake_thin(void) {
    begin();
    for (int i = 0; i < 8; i++) {
        add("{\"mesh\": {\"plane\": {\"size_x\": 1.5, \"size_z\": 1.5}}, \"rotate\": [%d, %d, 0], "
            "\"translate\": [%g, 0.8, %g]}, ",
            90 * (i % 2) + 20 * i, 30 * i, -4 + i * 1.1, -0.5 * i);
        add("{\"mesh\": {\"box\": {\"size\": [0.02, 2, 0.02]}}, \"translate\": [%g, 1, 1]}, ",
            -4 + i * 1.1);
    }
    finish("thin", GROUND, 512, "");
}

/* ---- Comparison with the reference ----------------------------------------------------------- */

typedef struct errors {
    uint32_t looked, wrong,
        far;              /* wrong: sunlit instead of shadowed or the reverse; far: beyond 1.5
                             texels */
    double farthest;      /* distance of the wrong pixels from an edge, texels */
    double squares, most; /* error of the filter relative to the disc */
    uint32_t sampled;
} errors;

static errors compare(const masu_camera *camera) {
    errors e = {0};
    const double tangent = tan(0.27 * 3.14159265358979 / 180);
    const uint32_t *seen = shadow_image(&t, MASU_READBACK_OCCLUSION);
    const float *depths = shadow_image(&t, MASU_READBACK_DEPTH);
    for (uint32_t y = 0; y < t.height; y++) {
        for (uint32_t x = 0; x < t.width; x++) {
            shadow_point p;
            uint32_t cascade;
            if (!shadow_point_at(&t, camera, depths, x, y, &p) || !p.faces || p.n_l < 0.005)
                continue;
            double texel = shadow_texel(&t, camera, &p, (double)camera->near_distance, &cascade);
            if (!(texel > 0) || p.z > 0.9 * (double)masu_scene_shadow_distance(&t.scene)) continue;
            double is = sun_share(seen, y * t.width + x);
            int truth = shadow_truth(&t, &p);
            e.looked++;
            if (fabs(is - truth) > 0.5) {
                double edge = shadow_edge(&t, &p, texel, 8);
                e.wrong++;
                e.far += edge > 1.5;
                e.farthest = worst_of(e.farthest, edge);
            }
            if (x % 5 != 1 || y % 5 != 1) continue;
            double d = is - masu_ref_sun_share(&t.world, p.at, p.triangle, t.sun, tangent, 256);
            e.squares += d * d;
            e.most = worst_of(e.most, fabs(d));
            e.sampled++;
        }
    }
    return e;
}

/* The stated bounds: pixels on the wrong side of an edge, per thousand; their distance from it,
 * texels; RMS error of the filter relative to the disc. */
static const struct {
    const char *scene;
    double elevation, wrong, farthest, rmse;
} stated[] = {{"boxes", 10, 6, 1.5, 0.06},
              {"boxes", 40, 5, 1, 0.05},
              {"boxes", 75, 5, 1, 0.06},
              {"thin", 15, 7, 1.5, 0.045},
              {"thin", 50, 4, 1, 0.05}};

static void the_error_against_the_truth_is_as_stated(void **state) {
    (void)state;
    int failed = 0;
    bake_boxes();
    bake_thin();
    for (size_t i = 0; i < sizeof stated / sizeof *stated; i++) {
        shadow_open(&t, stated[i].scene, W, H, NULL);
        shadow_sun(&t, 70, stated[i].elevation);
        shadow_draw(&t, &above, 0);
        errors e = compare(&above);
        shadow_close(&t);
        double rmse = sqrt(e.squares / e.sampled);
        print_message("%-6s sun %2.0f: wrong %u of %u, beyond 1.5 texels %u, farthest %.2f texels; "
                      "against the disc %.4f, most %.2f, of %u\n",
                      stated[i].scene, stated[i].elevation, e.wrong, e.looked, e.far, e.farthest,
                      rmse, e.most, e.sampled);
        assert_true(e.looked > 20000 && e.sampled > 1000);
        failed |= e.far != 0 || e.farthest > stated[i].farthest || rmse > stated[i].rmse;
        failed |= e.wrong * 1000.0 > stated[i].wrong * e.looked;
    }
    assert_false(failed);
}

/* ---- Acne ------------------------------------------------------------------------------------ */

/* Pixels that are sunlit in the reference and not in the map. */
static uint32_t dark_in_the_sun(const masu_camera *camera, uint32_t *looked) {
    const uint32_t *seen = shadow_image(&t, MASU_READBACK_OCCLUSION);
    const float *depths = shadow_image(&t, MASU_READBACK_DEPTH);
    uint32_t dark = 0;
    *looked = 0;
    for (uint32_t i = 0; i < t.width * t.height; i++) {
        shadow_point p;
        if (!shadow_point_at(&t, camera, depths, i % t.width, i / t.width, &p)) continue;
        if (!p.faces || p.n_l < 0.01 || !shadow_truth(&t, &p)) continue;
        ++*looked;
        dark += sun_share(seen, i) < 0.99;
    }
    return dark;
}

/* Convex objects do not occlude the sun for surfaces that face it. */
static void a_plane_has_no_acne_under_any_sun(void **state) {
    (void)state;
    static const double elevations[] = {1, 2, 3, 5, 8, 13, 21, 34, 45, 55, 67, 78, 85, 89};
    static const double azimuths[] = {0, 33, 45, 190};
    begin();
    finish("plane", GROUND, 512, "");
    shadow_open(&t, "plane", 130, 94, NULL);
    for (size_t i = 0; i < 4 * sizeof elevations / sizeof *elevations; i++) {
        uint32_t looked;
        shadow_sun(&t, azimuths[i % 4], elevations[i / 4]);
        shadow_draw(&t, &above, 0);
        uint32_t dark = dark_in_the_sun(&above, &looked);
        if (dark) fail_msg("%u of %u, sun at %g", dark, looked, elevations[i / 4]);
        assert_true(looked > 5000);
    }
    shadow_close(&t);
}

static void balls_boxes_and_sheets_have_no_acne(void **state) {
    (void)state;
    static const struct {
        const char *model;
        uint32_t most; /* per thousand */
    } models[] = {
        {"{\"mesh\": {\"sphere\": {\"radius\": 2, \"subdivisions\": 5}}}", 0},
        {"{\"mesh\": {\"sphere\": {\"radius\": 2, \"subdivisions\": 3}}}", 0},
        {"{\"mesh\": {\"sphere\": {\"radius\": 2, \"subdivisions\": 2}}}", 1},
        {"{\"mesh\": {\"box\": {\"size\": [2, 3, 1]}}, \"rotate\": [20, 40, 60]}", 0},
        {"{\"mesh\": {\"box\": {\"size\": [3, 0.02, 3]}}, \"rotate\": [20, 40, 60]}", 0},
        {"{\"mesh\": {\"plane\": {\"size_x\": 3, \"size_z\": 3}}, \"rotate\": [35, 10, 0]}", 0},
        {"{\"mesh\": {\"box\": {\"size\": [0.05, 4, 0.05]}}, \"rotate\": [0, 20, 30]}", 0},
    };
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        uint32_t looked = 0, dark = 0;
        begin();
        finish("alone", models[i].model, 256, "");
        shadow_open(&t, "alone", 160, 120, NULL);
        for (int k = 0; k < 12; k++) {
            uint32_t n;
            shadow_sun(&t, 37 * k, 4 + 7 * k);
            shadow_draw(&t, &above, 0);
            dark += dark_in_the_sun(&above, &n);
            looked += n;
        }
        shadow_close(&t);
        if (dark * 1000 > models[i].most * looked)
            fail_msg("%s: %u of %u", models[i].model, dark, looked);
        assert_true(looked > 300);
    }
}

/* A smooth ball is sunlit up to its terminator, whatever the orientation of its triangles: no
 * saw-teeth. */
static void smooth_balls_are_lit_to_their_terminator(void **state) {
    (void)state;
    uint32_t looked = 0, dark = 0;
    begin();
    finish("smooth", "{\"mesh\": {\"sphere\": {\"radius\": 2, \"subdivisions\": 2}}}", 1024, "");
    shadow_open(&t, "smooth", W, H, NULL);
    for (int k = 0; k < 6; k++) {
        shadow_sun(&t, 60 + 40 * k, 15 + 10 * k);
        shadow_draw(&t, &above, 0);
        const uint32_t *seen = shadow_image(&t, MASU_READBACK_OCCLUSION);
        const uint32_t *normals = shadow_image(&t, MASU_READBACK_NORMAL);
        const float *depths = shadow_image(&t, MASU_READBACK_DEPTH);
        for (uint32_t i = 0; i < W * H; i++) {
            shadow_point p;
            float n[3];
            if (!shadow_point_at(&t, &above, depths, i % W, i / W, &p) || p.faces) continue;
            masu_unpack_normal(normals[i], n);
            double n_l = 0;
            for (int c = 0; c < 3; c++) n_l += (double)n[c] * t.sun[c];
            if (n_l < 0.01) continue;
            looked++; /* the shading normal faces away from the sun, the triangle does not */
            dark += sun_share(seen, i) < 0.9;
        }
    }
    shadow_close(&t);
    print_message("  %u of %u pixels of averted triangles of a lit surface are dark\n", dark,
                  looked);
    assert_true(looked > 300);
    assert_true(dark * 50 < looked);
}

/* Half a spider's leg: eight sides around a radius of 5 cm, smooth, with a knee between two long
 * parts. */
static void write_leg(const char *name) {
    FILE *file = fopen(in_scratch(name), "w");
    assert_non_null(file);
    for (int ring = 0; ring < 3; ring++) {
        const double slope = 0.4 * (1 - ring), length = hypot(1, slope);
        for (int side = 0; side < 8; side++) {
            const double up = cos(side * 0.785398163397), across = sin(side * 0.785398163397);
            const double n[3] = {-slope / length * up, 1 / length * up, across};
            fprintf(file, "v %.6f %.6f %.6f\nvn %.6f %.6f %.6f\n", 2 * (ring - 1) + 0.05 * n[0],
                    (ring == 1 ? 1.4 : 0.6) + 0.05 * n[1], 0.05 * n[2], n[0], n[1], n[2]);
        }
    }
    for (int ring = 0; ring < 2; ring++) {
        for (int side = 0; side < 8; side++) {
            const int a = 8 * ring + side + 1, b = 8 * ring + (side + 1) % 8 + 1;
            fprintf(file, "f %d//%d %d//%d %d//%d %d//%d\n", a, a, b, b, b + 8, b + 8, a + 8,
                    a + 8);
        }
    }
    assert_int_equal(fclose(file), 0);
}

/* Terminator smoothing reduces a leg's shadow by at most a tenth of its radius. */
static void thin_smooth_casters_keep_their_shadow(void **state) {
    (void)state;
    double dark = 0, truth = 0;
    write_leg("leg.obj");
    begin();
    add("{\"file\": \"leg.obj\"}, ");
    finish("leg", GROUND, 2048, "");
    shadow_open(&t, "leg", W, H, NULL);
    for (int k = 0; k < 3; k++) {
        shadow_sun(&t, 20 * k - 20, 50);
        shadow_draw(&t, &above, 0);
        const uint32_t *seen = shadow_image(&t, MASU_READBACK_OCCLUSION);
        const float *depths = shadow_image(&t, MASU_READBACK_DEPTH);
        for (uint32_t i = 0; i < W * H; i++) {
            shadow_point p;
            if (!shadow_point_at(&t, &above, depths, i % W, i / W, &p) || p.at[1] > 0.01) continue;
            if (fabs(p.at[0]) > 4 || fabs(p.at[2]) > 3) continue;
            dark += 1 - sun_share(seen, i);
            truth += !shadow_truth(&t, &p);
        }
    }
    shadow_close(&t);
    print_message("  the shadow of a leg is %.3f of its exact size\n", dark / truth);
    assert_true(truth > 200);
    assert_true(dark > 0.88 * truth && dark < 1.05 * truth);
}

/* ---- Light leaks ----------------------------------------------------------------------------- */

/* Behind a sheet and a box that stand on the ground: distance of the shadow's start from the
 * foot. */
static void shadows_begin_at_the_foot_of_their_caster(void **state) {
    (void)state;
    static const char *const casters[] = {
        "{\"mesh\": {\"plane\": {\"size_x\": 4, \"size_z\": 4}}, \"rotate\": [90, 0, 0]}",
        "{\"mesh\": {\"box\": {\"size\": [4, 4, 0.3]}}, \"translate\": [0, 0, 0.15]}"};
    static const masu_camera behind = {
        .position = {0.3, 3, -4}, .forward = {0, -3, 4}, .fov_y = 0.6f, .near_distance = 0.1f};
    for (int i = 0; i < 2; i++) {
        begin();
        add("%s, ", casters[i]);
        finish("foot", GROUND, 512, "");
        shadow_open(&t, "foot", W, H, NULL);
        double worst = 0;
        for (int elevation = 5; elevation <= 80; elevation += 15) {
            uint32_t cascade = 0, ground = 0;
            double leak = 0;
            shadow_sun(&t, 20, elevation);
            shadow_draw(&t, &behind, 0);
            const uint32_t *seen = shadow_image(&t, MASU_READBACK_OCCLUSION);
            const float *depths = shadow_image(&t, MASU_READBACK_DEPTH);
            for (uint32_t k = 0; k < W * H; k++) {
                shadow_point p;
                if (!shadow_point_at(&t, &behind, depths, k % W, k / W, &p)) continue;
                if (fabs(p.at[1]) > 1e-6 || shadow_truth(&t, &p)) continue;
                double texel = shadow_texel(&t, &behind, &p, 0.1, &cascade);
                if (fabs(p.at[2]) > 10 * texel || fabs(p.at[0]) > 1) continue; /* no other edge */
                ground++;
                if (sun_share(seen, k) > 0.5) leak = worst_of(leak, -p.at[2] / texel);
            }
            print_message("%s, sun %d: lit up to %.2f texels behind the foot, of %u pixels\n",
                          i ? "box" : "sheet", elevation, leak, ground);
            assert_true(ground > 100);
            worst = worst_of(worst, leak);
        }
        shadow_close(&t);
        assert_true(worst <= (i ? 0.5 : 3.5));
    }
}

/* A sheet parallel to the ground: the height from which on it casts a shadow. */
static void a_sheet_above_the_ground_casts_from_a_few_texels_on(void **state) {
    (void)state;
    static const double elevations[4] = {10, 30, 60, 85};
    double lost[4] = {0};
    for (int k = 1; k <= 8; k++) {
        double height = 0.01 * k;
        /* From halfway between the two, straight down. */
        masu_camera low = {.position = {0, height / 2, 0},
                           .forward = {0, -1, -0.2f},
                           .fov_y = 1,
                           .near_distance = 0.001f};
        begin();
        add("{\"mesh\": {\"plane\": {\"size_x\": 2, \"size_z\": 2}}, \"translate\": [0, %g, 0]}, ",
            height);
        finish("above", SPOT, 512, "");
        shadow_open(&t, "above", 66, 48, NULL);
        for (int i = 0; i < 4; i++) {
            /* All visible surfaces are ground, and dark. */
            shadow_point p = {.z = height / 2};
            uint32_t cascade = 0, inside = 0, lit = 0;
            shadow_sun(&t, 200, elevations[i]);
            shadow_draw(&t, &low, 0);
            const uint32_t *seen = shadow_image(&t, MASU_READBACK_OCCLUSION);
            const float *depths = shadow_image(&t, MASU_READBACK_DEPTH);
            for (uint32_t j = 0; j < 64 * 48; j++) {
                inside += depths[j] > 0;
                lit += sun_share(seen, j) > 0.5;
            }
            assert_int_equal(inside, 64 * 48);
            if (lit) lost[i] = height / shadow_texel(&t, &low, &p, 0.001, &cascade);
        }
        shadow_close(&t);
    }
    for (int i = 0; i < 4; i++) {
        print_message("sheet above the ground, sun %g: lost up to %.2f texels of height\n",
                      elevations[i], lost[i]);
        assert_true(lost[i] <= 1.5);
    }
}

/* ---- SDF and polygons ------------------------------------------------------------------------ */

/* The sun's visibility is the product of both, on pixels of either; the ambient part is only the
 * SDF's. */
static void sdf_and_polygons_shadow_each_other(void **state) {
    (void)state;
    static uint32_t seen[3][W * H];
    static float depths[W * H];
    static const char field[] = "part ball = translate((-1.2, 0.8, 0), sphere(0.8));\n";
    for (int i = 0; i < 3; i++) {
        char text[2048];
        write_text("ball.sdf", field);
        snprintf(
            text, sizeof text,
            "{\"models\": [%s, {\"mesh\": {\"box\": {\"size\": [0.7, 3, 0.7]}}, \"translate\": "
            "[0.6, 1.5, 0.5]}], \"camera\": {\"near\": 0.1}, \"sun\": {\"direction\": [0.8, 0.7, "
            "0.3]%s}, \"sdf\": {\"source\": \"ball.sdf\", \"bounds\": [[-3, -1, -3], [3, 3, "
            "3]]%s}}",
            GROUND,
            i != 0 ? ", \"shadows\": {\"cascades\": 2, \"resolution\": 512, \"distance\": 40}" : "",
            i != 1 ? ", \"shadows\": {}, \"ambient_occlusion\": {}" : "");
        bake_scene("both", text);
        shadow_open(&t, "both", W, H, NULL);
        shadow_draw(&t, &above, 0);
        memcpy(seen[i], shadow_image(&t, MASU_READBACK_OCCLUSION), sizeof seen[i]);
        memcpy(depths, shadow_image(&t, MASU_READBACK_DEPTH), sizeof depths);
        shadow_close(&t);
    }
    uint32_t on_ball = 0, by_ball = 0, by_box = 0;
    for (uint32_t k = 0; k < W * H; k++) {
        if (!(depths[k] > 0)) continue;
        double sdf = sun_share(seen[0], k), map = sun_share(seen[1], k);
        assert_true(fabs(sun_share(seen[2], k) - sdf * map) < 2e-4);
        assert_int_equal(seen[2][k] >> 16, seen[0][k] >> 16);
        assert_int_equal(seen[1][k] >> 16, 0xFFFF);
        by_ball += sdf < 0.1;
        by_box += map < 0.1;
        /* The ball is left of the centre, and nothing else is that close. */
        double z = 0.1 / (double)depths[k];
        on_ball += map < 0.1 && k % W > W / 4 && k % W < W / 2 && z < 6.3;
    }
    print_message("dark by the ball %u, by a box %u, on the ball about %u\n", by_ball,
                  by_box, on_ball);
    assert_true(by_ball > 300 && by_box > 500 && on_ball > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_has_no_acne_under_any_sun),
        cmocka_unit_test(smooth_balls_are_lit_to_their_terminator),
        cmocka_unit_test(thin_smooth_casters_keep_their_shadow),
        cmocka_unit_test(balls_boxes_and_sheets_have_no_acne),
        cmocka_unit_test(shadows_begin_at_the_foot_of_their_caster),
        cmocka_unit_test(a_sheet_above_the_ground_casts_from_a_few_texels_on),
        cmocka_unit_test(sdf_and_polygons_shadow_each_other),
        cmocka_unit_test(the_error_against_the_truth_is_as_stated),
    };
    return cmocka_run_group_tests_name("shadow", tests, make_scratch, remove_scratch);
}
