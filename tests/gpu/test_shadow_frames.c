/* test_shadow_frames.c: the shadow map over frames: stable texels while the view moves, cascades
 * that are not rendered in every frame, rungs with different cascades; far from the origin; a
 * plan's shadow images, and rejected descriptions. */
#include "scene/scene.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/shadow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 130, H = 96, SIZE = 256 };

static shadow_test t;

static const masu_camera home = {
    .position = {1, 3, 6}, .forward = {-1, -3, -6}, .fov_y = 0.873f, .near_distance = 0.125f};

/* Boxes on a ground, with all coordinates in sixteenths of a metre: exact at a million too. */
static void bake(const char *name, double x, double z, const char *shadows, const char *more) {
    char json[4096];
    snprintf(
        json, sizeof json,
        "{\"models\": ["
        "{\"mesh\": {\"plane\": {\"size_x\": 64, \"size_z\": 64}}, \"translate\": [%.4f, 0, %.4f]},"
        "{\"mesh\": {\"box\": {\"size\": [1, 2, 1]}}, \"rotate_y\": 30, \"translate\": [%.4f, 1, "
        "%.4f]},"
        "{\"mesh\": {\"box\": {\"size\": [2, 0.5, 1]}}, \"name\": \"mover\", \"translate\": [%.4f, "
        "1.5, %.4f]},"
        "{\"mesh\": {\"box\": {\"size\": [3, 6, 3]}}, \"translate\": [%.4f, 3, %.4f]}],"
        "\"camera\": {\"near\": 0.125}, \"sun\": {\"azimuth\": 70, \"elevation\": 35%s}%s}",
        x, z, x - 1.5, z, x + 1.5, z - 1.0, x - 6.0, z - 9.0, shadows, more);
    bake_scene(name, json);
}

#define SHADOWS ", \"shadows\": {\"cascades\": 3, \"resolution\": 256, \"distance\": 40}"

static float map_a[SIZE * SIZE * 3], map_b[SIZE * SIZE * 3];
static uint32_t seen_a[W * H], seen_b[W * H];

static void take(float *map, uint32_t *seen) {
    if (map) memcpy(map, shadow_image(&t, MASU_READBACK_SHADOW_MAP), sizeof map_a);
    if (seen) memcpy(seen, shadow_image(&t, MASU_READBACK_OCCLUSION), sizeof seen_a);
}

static void turn(masu_camera *c, double yaw, double pitch) {
    double x = (double)c->forward[0], z = (double)c->forward[2];
    c->forward[0] = (float)(x * cos(yaw) - z * sin(yaw));
    c->forward[2] = (float)(x * sin(yaw) + z * cos(yaw));
    c->forward[1] += (float)pitch;
}

/* The position of a cascade for a camera, in whole texels across the sun. */
static masu_cascade cascade_of(const masu_camera *c, uint32_t k) {
    masu_shadow_view v;
    memset(&v, 0, sizeof v);
    double y = tan((double)c->fov_y / 2), x = y * W / H, length = 0;
    for (int i = 0; i < 3; i++) {
        v.eye[i] = c->position[i];
        v.forward[i] = (double)c->forward[i];
        v.sun[i] = t.sun[i];
        v.casters[0][i] = 1;
        length += v.forward[i] * v.forward[i];
    }
    for (int i = 0; i < 3; i++) v.forward[i] = (double)(float)(v.forward[i] / sqrt(length));
    v.tan2 = x * x + y * y;
    double depth = masu_shadow_split(0.125, (double)masu_scene_shadow_distance(&t.scene),
                                     (double)masu_scene_data_of(&t.scene)->shadow_lambda, k, 3);
    return masu_cascade_fit(&v, depth, 0, SIZE);
}

/* ---- Stability ------------------------------------------------------------------------------- */

/* A camera that moves by a tenth of a texel, and rotates: while no cascade has stepped, the map is
 * bit-identical. */
static void texels_stay_the_same_while_the_view_creeps(void **state) {
    (void)state;
    uint32_t same = 0, frames = 0;
    bake("still", 0, 0, SHADOWS, "");
    shadow_open(&t, "still", W, H, NULL);
    masu_camera c = home;
    shadow_draw(&t, &c, 0);
    take(map_a, NULL);
    for (int i = 0; i < 60; i++) {
        masu_camera before = c;
        double texel = 2 * cascade_of(&c, 0).half / SIZE;
        c.position[i % 3] += texel / 10;
        if (i % 4 == 3) turn(&c, 1e-5, 1e-5);
        shadow_draw(&t, &c, 0);
        take(map_b, NULL);
        int stepped[3];
        for (uint32_t k = 0; k < 3; k++) {
            masu_cascade one = cascade_of(&before, k), two = cascade_of(&c, k);
            stepped[k] = memcmp(one.center, two.center, sizeof one.center) != 0;
            const float *a = map_a + k * SIZE * SIZE, *b = map_b + k * SIZE * SIZE;
            if (!stepped[k]) assert_memory_equal(a, b, SIZE * SIZE * sizeof *a);
            same += !stepped[k];
            frames++;
        }
        memcpy(map_a, map_b, sizeof map_a);
    }
    shadow_close(&t);
    print_message("%u of %u cascades stayed where they were, bit for bit\n", same, frames);
    assert_true(same > frames / 2 && same < frames);
}

/* A camera that flies and rotates by much more: the cascades move by whole texels, so that texels
 * shared by two frames are rendered at the same positions. */
static void texels_move_by_whole_steps_while_the_view_flies(void **state) {
    (void)state;
    uint64_t shared = 0, changed = 0;
    double most = 0;
    /* otherwise casters without a shadow in the image are missing */
    static const masu_rung all = {.frustum = MASU_OFF};
    shadow_open(&t, "still", W, H, &all);
    masu_camera c = home;
    shadow_draw(&t, &c, 0);
    take(map_a, NULL);
    for (int i = 0; i < 40; i++) {
        masu_camera before = c;
        c.position[0] += 0.07;
        c.position[2] -= 0.05;
        turn(&c, 0.02, i % 2 ? 0.05 : -0.04);
        shadow_draw(&t, &c, 0);
        take(map_b, NULL);
        for (uint32_t k = 0; k < 3; k++) {
            masu_cascade one = cascade_of(&before, k), two = cascade_of(&c, k);
            double texel = 2 * one.half / SIZE, by[3] = {0};
            for (int a = 0; a < 3; a++)
                for (int j = 0; j < 3; j++)
                    by[a] += one.axis[a][j] * (two.center[j] - one.center[j]);
            int32_t dx = (int32_t)lround(by[0] / texel), dy = (int32_t)lround(by[1] / texel);
            assert_true(fabs(by[0] / texel - dx) < 1e-3 && fabs(by[1] / texel - dy) < 1e-3);
            /* A step along the sun moves the far plane, and with it all depths. */
            if (fabs(by[2]) > 1e-9) continue;
            for (int32_t y = 0; y < SIZE; y++) {
                for (int32_t x = 0; x < SIZE; x++) {
                    int32_t fx = x + dx, fy = y + dy;
                    if (fx < 0 || fy < 0 || fx >= SIZE || fy >= SIZE) continue;
                    float a = map_a[k * SIZE * SIZE + (uint32_t)(fy * SIZE + fx)];
                    float b = map_b[k * SIZE * SIZE + (uint32_t)(y * SIZE + x)];
                    double d = fabs((double)a - (double)b);
                    shared++;
                    changed += d > 1e-4;
                    most = worst_of(most, d > 1e-4 ? 0 : d);
                }
            }
        }
        memcpy(map_a, map_b, sizeof map_a);
    }
    shadow_close(&t);
    print_message("%llu of %llu texels changed, the others by at most %.2g of the depth\n",
                  (unsigned long long)changed, (unsigned long long)shared, most);
    assert_true(shared > 3000000 && changed * 20000 < shared);
}

/* ---- Cascades that are not rendered in every frame ------------------------------------------- */

static uint32_t differing(const uint32_t *a, const uint32_t *b) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < W * H; i++) n += (a[i] & 0xFFFF) != (b[i] & 0xFFFF);
    return n;
}

/* Nothing moves: at any refresh interval, every frame is the same; with all other memory
 * poisoned. */
static void a_pace_changes_nothing_that_stands_still(void **state) {
    (void)state;
    static const masu_rung rung = {.shadow_refresh = {1, 3, 8}};
    shadow_open(&t, "still", W, H, &rung);
    shadow_draw(&t, &home, 0);
    take(map_a, seen_a);
    for (int i = 0; i < 12; i++) {
        shadow_draw(&t, &home, 0);
        take(map_b, seen_b);
        assert_memory_equal(map_a, map_b, sizeof map_a);
        assert_memory_equal(seen_a, seen_b, sizeof seen_a);
    }
    shadow_close(&t);
    for (uint32_t poison = 1; poison <= 3; poison++) {
        masu_session_desc d = test_desc(NULL, W, H);
        d.scene_path = baked_scene("still");
        d.desc.readback = MASU_READBACK_OCCLUSION | MASU_READBACK_SHADOW_MAP;
        d.desc.rung_count = 1;
        d.desc.rungs[0] = rung;
        d.desc.debug.poison = poison;
        open_session(&t.s, &d);
        for (int i = 0; i < 6; i++) {
            shadow_draw(&t, &home, 0);
            take(map_b, seen_b);
            assert_memory_equal(map_a, map_b, sizeof map_a);
            assert_memory_equal(seen_a, seen_b, sizeof seen_a);
        }
        close_session(&t.s);
    }
}

/* A box moves once: the fast cascade shows it at once, the slow ones at their next refresh, and a
 * cut updates them all. */
static void what_moves_reaches_each_cascade_at_its_pace(void **state) {
    (void)state;
    static const masu_rung rung = {.shadow_refresh = {1, 4, 8}};
    float rows[12] = {1, 0, 0, -3, 0, 1, 0, 1.5f, 0, 0, 1, 2};
    shadow_open(&t, "still", W, H, &rung);
    for (int i = 0; i < 9; i++) shadow_draw(&t, &home, 0);
    take(map_a, NULL);
    masu_instance mover = masu_instance_find(t.s.m, "mover");
    assert_int_equal(masu_instance_set_transform(t.s.m, mover, rows, NULL), MASU_OK);
    uint32_t since[3] = {0, 0, 0};
    for (uint32_t i = 1; i <= 16; i++) {
        shadow_draw(&t, &home, 0);
        take(map_b, NULL);
        for (uint32_t k = 0; k < 3; k++) {
            size_t at = k * SIZE * SIZE;
            int moved = memcmp(map_a + at, map_b + at, SIZE * SIZE * sizeof *map_a) != 0;
            if (moved && !since[k]) since[k] = i;
            assert_int_equal(moved, since[k] != 0);
        }
    }
    print_message("shown by the cascades after %u, %u and %u frames\n", since[0], since[1],
                  since[2]);
    assert_int_equal(since[0], 1);
    assert_in_range(since[1], 1, 4);
    assert_in_range(since[2], 1, 8);
    assert_true(since[1] != since[2]);
    rows[3] = 3;
    assert_int_equal(masu_instance_set_transform(t.s.m, mover, rows, NULL), MASU_OK);
    shadow_draw(&t, &home, 1);
    take(map_b, seen_b);
    shadow_draw(&t, &home, 1);
    take(map_a, seen_a);
    assert_memory_equal(map_a, map_b, sizeof map_a);
    assert_memory_equal(seen_a, seen_b, sizeof seen_a);
    shadow_close(&t);
}

/* While the camera flies, slow cascades are larger and older: shadows shift by less than a texel or
 * two, and none are missing. */
static void a_flight_with_slow_cascades_keeps_its_shadows(void **state) {
    (void)state;
    static const masu_rung rungs[] = {{.shadow_refresh = {1, 1, 1}}, {.shadow_refresh = {2, 4, 8}}};
    static uint32_t frames[24][W * H];
    uint32_t worst = 0;
    for (int r = 0; r < 2; r++) {
        masu_camera c = home;
        shadow_open(&t, "still", W, H, &rungs[r]);
        for (int i = 0; i < 24; i++) {
            c.position[0] += 0.1;
            c.position[2] -= 0.2;
            turn(&c, 0.03, 0);
            shadow_draw(&t, &c, 0);
            take(NULL, r ? seen_b : frames[i]);
            uint32_t other = 0;
            for (uint32_t k = 0; k < W * H && r; k++)
                other += fabs(sun_share(seen_b, k) - sun_share(frames[i], k)) > 0.5;
            if (other > worst) worst = other;
        }
        shadow_close(&t);
    }
    print_message("at most %u of %u pixels on another side of an edge\n", worst, W * H);
    assert_true(worst * 100 < W * H);
}

/* A shadow's edge along the texels of both cascades leads away from the camera. The coarse cascade
 * has it at another position, and the image blends between both in steps that are a fraction of
 * that difference. */
static void cascades_meet_without_a_step(void **state) {
    (void)state;
    bake_scene(
        "edge",
        "{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 96, \"size_z\": 96}}},"
        "{\"mesh\": {\"box\": {\"size\": [4, 1, 96]}}, \"translate\": [2.3, 4, 0]}],"
        "\"camera\": {\"near\": 0.125}, \"sun\": {\"azimuth\": 90, \"elevation\": 45, \"shadows\":"
        "{\"cascades\": 2, \"resolution\": 64, \"distance\": 60}}}");
    masu_camera c = {
        .position = {-2, 12, 20}, .forward = {0, -12, -16}, .fov_y = 0.873f, .near_distance = 4};
    shadow_open(&t, "edge", W, H, NULL);
    shadow_draw(&t, &c, 0);
    take(NULL, seen_a);
    shadow_close(&t);
    double step = 0, between = 0;
    for (uint32_t y = 0; y + 8 < H; y++) {
        for (uint32_t x = 0; x < W / 2; x++) { /* the caster is to the right */
            double here = sun_share(seen_a, y * W + x);
            step = worst_of(step, fabs(sun_share(seen_a, (y + 1) * W + x) - here));
            between = worst_of(between, fabs(sun_share(seen_a, (y + 8) * W + x) - here));
        }
    }
    print_message("from one row to the next by at most %.3f, within eight by %.3f\n", step,
                  between);
    assert_true(between > 0.3 && step < 0.5 * between); /* 0.117 of 0.388; without a blend 0.296 */
}

/* ---- Rungs ----------------------------------------------------------------------------------- */

static const masu_rung ladder[] = {
    {.shadow_refresh = {1, 2, 4}},
    {.shadow_cascades = 2, .shadow_resolution = 64, .shadow_refresh = {1, 2}},
    {.shadow_cascades = 1, .shadow_distance = 10},
};

/* Each rung by itself, then all of them alternately: the same images. */
static void rungs_by_turns_show_what_each_shows_alone(void **state) {
    (void)state;
    static uint32_t alone[3][W * H];
    for (int all = 0; all < 2; all++) {
        for (uint32_t r = 0; r < (all ? 1u : 3u); r++) {
            masu_session_desc d = test_desc(NULL, W, H);
            d.scene_path = baked_scene("still");
            d.desc.readback = MASU_READBACK_OCCLUSION;
            d.desc.rung_count = all ? 3 : 1;
            for (uint32_t k = 0; k < 3; k++) d.desc.rungs[k] = ladder[all ? k : r];
            open_session(&t.s, &d);
            for (uint32_t i = 0; i < (all ? 20u : 1u); i++) {
                masu_frame_desc f = {.camera = &home, .rung = all ? i * i % 3 : 0};
                masu_commands commands;
                draw(&t.s, &f, &commands, NULL);
                take(NULL, seen_a);
                if (!all) memcpy(alone[r], seen_a, sizeof seen_a);
                /* A slow cascade of another frame is larger, but nothing has moved. */
                assert_true(differing(alone[all ? f.rung : r], seen_a) == 0);
            }
            close_session(&t.s);
        }
    }
    assert_true(differing(alone[0], alone[1]) > 20); /* the rungs do differ */
}

/* ---- Far away -------------------------------------------------------------------------------- */

static void a_million_metres_away_it_is_the_same(void **state) {
    (void)state;
    static const double far[] = {1e6, 16e6 / 16}; /* and along both axes */
    bake("far", 1e6, -1e6, SHADOWS, "");
    for (int i = 0; i < 2; i++) {
        masu_camera c = home;
        c.position[0] += i ? far[0] : 0;
        c.position[2] -= i ? far[1] : 0;
        shadow_open(&t, i ? "far" : "still", W, H, NULL);
        shadow_draw(&t, &c, 0);
        take(NULL, i ? seen_b : seen_a);
        shadow_close(&t);
    }
    uint32_t dark = 0, other = 0, off = 0;
    for (uint32_t k = 0; k < W * H; k++) {
        double d = fabs(sun_share(seen_a, k) - sun_share(seen_b, k));
        dark += sun_share(seen_a, k) < 0.5;
        off += d > 0.02;
        other += d > 0.5;
    }
    print_message(
        "far away: %u of %u pixels differ by more than 0.02, %u by more than half; %u dark\n", off,
        W * H, other, dark);
    /* Texels are at other positions there, so edges differ within a texel. */
    assert_true(dark > 300 && other * 200 < W * H);
}

/* The bounds of all casters then extend there, and so do the cascades, along the sun: depths get
 * small and keep their precision. */
static void a_caster_however_far_leaves_the_others_their_shadows(void **state) {
    (void)state;
    static const float places[][3] = {{0, -500, 0},
                                      {1e3f, 1e3f, -1e3f},
                                      {1e9f, 1e9f, -1e9f},
                                      {1e20f, 1e20f, -1e20f},
                                      {3e38f, 3e38f, -3e38f}};
    shadow_open(&t, "still", W, H, NULL);
    masu_instance mover = masu_instance_find(t.s.m, "mover");
    for (int i = 0; i < 5; i++) {
        float rows[12] = {1, 0, 0, places[i][0], 0, 1, 0, places[i][1], 0, 0, 1, places[i][2]};
        assert_int_equal(masu_instance_set_transform(t.s.m, mover, rows, NULL), MASU_OK);
        shadow_draw(&t, &home, 0);
        take(NULL, i ? seen_b : seen_a);
        uint32_t dark = 0, other = 0;
        for (uint32_t k = 0; k < W * H; k++) {
            dark += sun_share(seen_a, k) < 0.5;
            other += i && fabs(sun_share(seen_a, k) - sun_share(seen_b, k)) > 0.02;
        }
        print_message("at %g: %u pixels differ, %u are dark\n", (double)places[i][0], other, dark);
        assert_true(dark > 200 && other * 2000 < W * H);
    }
    shadow_close(&t);
}

/* ---- Plans ----------------------------------------------------------------------------------- */

static int has_row(const char *name) {
    static masu_memory_row rows[MEMORY_ROWS];
    uint32_t n = memory_rows(t.s.m, rows);
    for (uint32_t i = 0; i < n; i++)
        if (!strcmp(rows[i].name, name)) return 1 + (int)rows[i].transient;
    return 0;
}

static void only_scenes_that_ask_have_any_of_it(void **state) {
    (void)state;
    static masu_plan_info plan;
    static const char *const sdf =
        "{\"sdf\": {\"source\": \"ball.sdf\", \"bounds\": [[-3, -1, -3], [3, 3, 3]]}, "
        "\"sun\": {\"shadows\": {}}}";
    uint64_t bytes[4];
    write_text("ball.sdf", "part b = sphere(1);\n");
    bake("none", 0, 0, "", "");
    bake_scene("sdf", sdf);
    static const char *const names[] = {"none", "sdf", "still", "still"};
    static const masu_rung slow = {.shadow_refresh = {1, 1, 2}};
    for (int i = 0; i < 4; i++) {
        masu_readback_image out;
        shadow_open(&t, names[i], W, H, i == 3 ? &slow : NULL);
        shadow_draw(&t, &home, 0);
        masu_plan_of(t.s.m, &plan);
        bytes[i] = plan.memory.device_bytes;
        assert_int_equal(pass_of(&plan, "cascade_0")->active, i >= 2);
        assert_int_equal(pass_of(&plan, "cascade_2")->active, i >= 2);
        assert_int_equal(pass_of(&plan, "cascade_3")->active, 0);
        assert_int_equal(pass_of(&plan, "shadow")->active, i >= 2);
        assert_int_equal(pass_of(&plan, "light_occluded")->active, i >= 2);
        assert_int_equal(has_row("shadow uniforms") != 0, i >= 2);
        assert_int_equal(has_row("occlusion") != 0, i >= 2);
        assert_int_equal(has_row("shadow_map"), i < 2 ? 0 : i == 2 ? 2 : 1); /* transient or not */
        assert_int_equal(masu_readback(t.s.m, 0, MASU_READBACK_SHADOW_MAP, &out, NULL),
                         i >= 2 ? MASU_OK : MASU_ERROR_ARGUMENT);
        masu_peak_info peaks;
        masu_peaks(t.s.m, &peaks);
        assert_int_equal(peaks.shadow_cascades, i >= 2 ? 3 : 0);
        assert_int_equal(peaks.shadow_resolution, i >= 2 ? SIZE : 0);
        shadow_close(&t);
    }
    assert_true(bytes[2] > bytes[0] && bytes[3] >= bytes[2]);
}

static void what_exceeds_a_limit_is_named(void **state) {
    (void)state;
    static const struct {
        const char *what;
        uint64_t cascades, resolution;
        masu_result result;
    } cases[] = {{"limits.shadow_cascades", 2, 0, MASU_ERROR_LIMIT},
                 {"limits.shadow_resolution", 0, SIZE - 1, MASU_ERROR_LIMIT}};
    for (int i = 0; i < 3; i++) {
        char error[ERROR_SIZE];
        masu_session_desc d = test_desc(NULL, W, H);
        d.scene_path = baked_scene("still");
        d.desc.limits.shadow_cascades = i < 2 ? cases[i].cascades : 3;
        d.desc.limits.shadow_resolution = i < 2 ? cases[i].resolution : SIZE;
        if (i == 2) {
            open_session(&t.s, &d); /* exactly enough */
            close_session(&t.s);
            continue;
        }
        assert_false(masu_session_open(&d, &t.s, error, sizeof error));
        assert_int_equal(t.s.detail.result, cases[i].result);
        assert_string_equal(t.s.detail.what, cases[i].what);
    }
    char error[ERROR_SIZE];
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene("still");
    d.desc.deny.image_size = 2 * SIZE - 1; /* a texel too small for a square of cascades */
    assert_false(masu_session_open(&d, &t.s, error, sizeof error));
    assert_int_equal(t.s.detail.result, MASU_ERROR_DEVICE);
    assert_string_equal(t.s.detail.what, "maxImageDimension2D");
    assert_int_equal(t.s.detail.needed, 2 * SIZE);
    assert_int_equal(t.s.detail.given, 2 * SIZE - 1);
}

/* The three cascades need no image of three times their size. */
static void small_images_hold_the_cascades_in_a_square(void **state) {
    (void)state;
    static uint8_t images[2][W * H * 4];
    for (uint32_t i = 0; i < 2; i++) {
        masu_plan_info plan;
        masu_commands commands;
        masu_session_desc d = test_desc(NULL, W, H);
        d.scene_path = baked_scene("still");
        d.desc.deny.image_size = i ? 2 * SIZE : 0;
        open_session(&t.s, &d);
        assert_int_equal(masu_plan(&t.s.desc, &plan, NULL), MASU_OK);
        uint32_t found = 0;
        for (uint32_t k = 0; k < plan.image_count; k++) {
            if (strcmp(plan.images[k].name, "shadow_map")) continue;
            found = 1;
            assert_int_equal(plan.images[k].width, i ? 2 * SIZE : SIZE);
            assert_int_equal(plan.images[k].height, i ? 2 * SIZE : 3 * SIZE);
        }
        assert_true(found);
        draw(&t.s, &(masu_frame_desc){.camera = &home, .cut = 1}, &commands, images[i]);
        close_session(&t.s);
    }
    assert_memory_equal(images[0], images[1], sizeof images[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_stay_the_same_while_the_view_creeps),
        cmocka_unit_test(texels_move_by_whole_steps_while_the_view_flies),
        cmocka_unit_test(a_pace_changes_nothing_that_stands_still),
        cmocka_unit_test(what_moves_reaches_each_cascade_at_its_pace),
        cmocka_unit_test(a_flight_with_slow_cascades_keeps_its_shadows),
        cmocka_unit_test(cascades_meet_without_a_step),
        cmocka_unit_test(rungs_by_turns_show_what_each_shows_alone),
        cmocka_unit_test(a_million_metres_away_it_is_the_same),
        cmocka_unit_test(a_caster_however_far_leaves_the_others_their_shadows),
        cmocka_unit_test(only_scenes_that_ask_have_any_of_it),
        cmocka_unit_test(what_exceeds_a_limit_is_named),
        cmocka_unit_test(small_images_hold_the_cascades_in_a_square),
    };
    return cmocka_run_group_tests_name("shadow_frames", tests, make_scratch, remove_scratch);
}
