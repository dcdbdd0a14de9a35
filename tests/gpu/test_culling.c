/* test_culling.c: culling never changes the image: images with and without culling are
 * bit-identical for any camera rotation and any moving objects, and fewer triangles are drawn. */
#include "scene/scene.h"
#include "support/files.h"
#include "support/shadow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 66, H = 40, BYTES = W * H * 4 };

static uint8_t pixels[4][BYTES];

enum { BOTH, FRUSTUM, OCCLUSION, NEITHER, WAYS }; /* rungs: stages of culling that are on */

static masu_session_desc town_desc(void) {
    masu_session_desc d = test_desc("test_town", W, H);
    d.desc.rung_count = WAYS;
    d.desc.debug.casters = 1;
    d.desc.rungs[OCCLUSION].frustum = d.desc.rungs[NEITHER].frustum = MASU_OFF;
    d.desc.rungs[FRUSTUM].occlusion = d.desc.rungs[NEITHER].occlusion = MASU_OFF;
    return d;
}

/* Fast rotations, all around and up and down, through the town's streets; a different field of view
 * in each frame, and now and then a cut. */
static masu_camera path(uint32_t frame) {
    double t = frame;
    masu_camera c = {
        .position = {35.0 * sin(t * 0.05), 1.0 + 12.0 * (frame % 50 > 40), 30.0 * sin(t * 0.031)},
        .forward = {(float)cos(t * 0.37), (float)(0.8 * sin(t * 0.23)), (float)sin(t * 0.37)},
        .fov_y = 0.3f + 2.5f * (float)(frame % 7) / 7.0f};
    if (frame % 60 == 59) { /* beyond the town, looking away */
        c.position[0] += 1000.0;
        c.forward[0] = 2.0f;
    }
    return c;
}

static masu_stats_info draw_frame(masu_session *s, uint32_t frame, uint32_t rung, uint8_t *out) {
    masu_camera c = path(frame);
    masu_frame_desc f = {.camera = &c, .rung = rung, .cut = frame % 60 == 59};
    masu_commands commands;
    draw(s, &f, &commands, out);
    return stats_of(s, commands.slot);
}

static void compare_path(masu_session *s, uint32_t frames, int moving) {
    uint64_t triangles[WAYS] = {0}, casters[WAYS] = {0}, seen = 0, tests = 0;
    for (uint32_t frame = 0; frame < frames; frame++) {
        if (moving) {
            float t = (float)frame;
            move_instance(s, "ball2", 30.0f * sinf(t * 0.2f), 1.0f, 30.0f * cosf(t * 0.13f), 1.0f);
            /* These instances are in groups, whose bounds do not follow them; a house occludes as
             * well. */
            move_instance(s, "late1", 25.0f * cosf(t * 0.3f), 3.0f, 3.0f, 2.0f);
            move_instance(s, "b17/block", 20.0f * sinf(t * 0.11f), 0.0f, 30.0f,
                 frame % 20 < 10 ? 3.0f : 0.0f);
        }
        for (uint32_t way = 0; way < WAYS; way++) {
            masu_stats_info stats = draw_frame(s, frame, way, pixels[way]);
            const masu_view_stats *view = stats.views;
            int occlusion = way == BOTH || way == OCCLUSION;
            assert_int_equal(stats.view_count, 2);
            triangles[way] += stats.triangles;
            for (uint32_t v = 0; v < 2; v++) {
                int all = way == OCCLUSION || way == NEITHER;
                if (all)
                    assert_int_equal(view[v].instances,
                                     masu_scene_count(&s->scene, MASU_SCENE_INSTANCE));
                if (all) assert_int_equal(view[v].plane_tests, 0);
                if (!all) assert_true(view[v].groups > 0);
                if (occlusion) assert_true(view[v].visible_instances <= view[v].instances);
                if (occlusion) assert_true(view[v].visible_triangles <= view[v].triangles);
                if (!occlusion) assert_int_equal(view[v].visible_instances, 0);
            }
            casters[way] += occlusion ? view[1].visible_triangles : view[1].triangles;
            if (way == BOTH) tests += stats.occlusion_tests;
            if (way == NEITHER) assert_int_equal(stats.triangles, masu_scene_triangles(&s->scene));
            if (way == FRUSTUM && frame % 60 == 59) assert_int_equal(stats.triangles, 0);
        }
        for (uint32_t way = 0; way < NEITHER; way++) {
            if (max_difference(pixels[way], pixels[NEITHER], BYTES))
                fail_msg("frame %u differs, stages %u", frame, way);
        }
        for (uint32_t i = 0; i < BYTES; i += 4) seen += memcmp(pixels[0], pixels[0] + i, 4) != 0;
    }
    static const char *const names[WAYS] = {"both stages", "frustum", "occlusion", "neither"};
    for (uint32_t way = 0; way < WAYS; way++) {
        print_message("%-12s triangles %8.1f a frame, casters %8.1f\n", names[way],
                      (double)triangles[way] / frames, (double)casters[way] / frames);
    }
    print_message("occlusion tests %.1f a frame\n", (double)tests / frames);
    assert_true(triangles[FRUSTUM] < triangles[NEITHER] / 2);
    assert_true(triangles[BOTH] < triangles[FRUSTUM] * 9 / 10);
    assert_true(triangles[OCCLUSION] < triangles[NEITHER]);
    assert_true(!moving || casters[OCCLUSION] < casters[NEITHER]);
    assert_true(seen > (uint64_t)frames * W * H / 8); /* the image has content */
}

static void the_picture_is_the_same_without_culling(void **state) {
    (void)state;
    masu_session_desc d = town_desc();
    masu_session s;
    d.host.validate = false; /* the long path; the other tests run with the layers */
    open_session(&s, &d);
    assert_true(masu_scene_data_of(&s.scene)->groups > 5);
    compare_path(&s, trials(600, 180, 60), 0);
    close_session(&s);
}

static void what_moves_is_culled_where_it_is(void **state) {
    (void)state;
    masu_session_desc d = town_desc();
    masu_session s;
    open_session(&s, &d);
    compare_path(&s, trials(120, 60, 60), 1);
    close_session(&s);
}

/* Velocities read the previous frame by the same list of instances. */
static void velocities_are_the_same_without_culling(void **state) {
    (void)state;
    static uint8_t velocity[2][W * H * 8];
    masu_session_desc d = town_desc();
    d.desc.readback = MASU_READBACK_VELOCITY;
    masu_session s[2];
    uint64_t moving = 0;
    for (uint32_t i = 0; i < 2; i++) open_session(&s[i], &d);
    for (uint32_t frame = 0; frame < 20; frame++) {
        for (uint32_t i = 0; i < 2; i++) {
            masu_camera c = path(60);
            masu_frame_desc f = {.camera = &c, .rung = i ? NEITHER : BOTH};
            masu_commands commands;
            masu_readback_image image;
            move_instance(&s[i], "ball3", (float)c.position[0] + 4.0f * c.forward[0],
                 1.0f + 0.1f * (float)frame, (float)c.position[2] + 4.0f * c.forward[2], 1.0f);
            draw(&s[i], &f, &commands, NULL);
            assert_int_equal(
                masu_readback(s[i].m, commands.slot, MASU_READBACK_VELOCITY, &image, NULL),
                MASU_OK);
            for (uint32_t y = 0; y < H; y++) {
                memcpy(velocity[i] + (size_t)y * W * 8,
                       (const uint8_t *)image.pixels + y * image.row_bytes, W * 8);
            }
        }
        assert_memory_equal(velocity[0], velocity[1], sizeof velocity[0]);
        for (uint32_t i = 0; i < W * H; i++) moving += velocity[0][8 * i + 2] != 0;
    }
    assert_true(moving > 100);
    for (uint32_t i = 0; i < 2; i++) close_session(&s[i]);
}

/* The town with a shadow map, which the test bakes. */
static void bake_shadows(void) {
    assert_int_equal(
        shell("sed -e 's#\"../../scenes/#\"'\"$PWD\"'/scenes/#' "
              "-e 's#\"shadows\": false#\"shadows\": {\"cascades\": 3, "
              "\"resolution\": 192, \"distance\": 90}#' "
              "tests/scenes/test_town.json > %s/town.json",
              scratch),
        0);
    assert_int_equal(shell("%s/bin/masu-bake %s/town.json -o %s/town.masu --quiet", build_dir(),
                           scratch, scratch),
                     0);
}

/* Each culling mode has its own renderer, so the content of a slow cascade is from that mode only.
 * The sun moves from low over the roofs to high and to the other side. A map of slow cascades is
 * bit-identical. Other maps lack casters without a shadow in the image: the sun's visibility at
 * each pixel is the same, and so is the image. */
static void compare_shadows(uint32_t frames, const uint32_t refresh[3], uint64_t casters[WAYS]) {
    static uint8_t map[2][3 * 192 * 192 * 4], lit[2][W * H * 4];
    masu_session s[WAYS];
    for (uint32_t way = 0; way < WAYS; way++) {
        masu_session_desc d = test_desc(NULL, W, H);
        d.scene_path = baked_scene("town");
        d.desc.rung_count = 1;
        d.desc.readback = MASU_READBACK_SHADOW_MAP | MASU_READBACK_OCCLUSION;
        d.host.validate = way == BOTH;
        d.desc.rungs[0].frustum = way == OCCLUSION || way == NEITHER ? MASU_OFF : MASU_ON;
        d.desc.rungs[0].occlusion = way == FRUSTUM || way == NEITHER ? MASU_OFF : MASU_ON;
        memcpy(d.desc.rungs[0].shadow_refresh, refresh, 3 * sizeof *refresh);
        open_session(&s[way], &d);
        casters[way] = 0;
    }
    for (uint32_t frame = 0; frame < frames; frame++) {
        float t = (float)frame, up = 0.08f + 1.5f * (float)(frame % 29) / 29.0f;
        masu_light light = {.sun_direction = {cosf(t * 0.02f), up, sinf(t * 0.02f)},
                            .sun_color = {3, 3, 3},
                            .ambient = {0.2f, 0.2f, 0.2f}};
        masu_camera c = path(refresh[0] > 1 ? frame / 3 : frame);
        uint64_t drawn = 0;
        for (uint32_t way = WAYS; way-- > 0;) {
            masu_frame_desc f = {.camera = &c, .light = &light, .cut = frame % 60 == 59};
            masu_commands commands;
            move_instance(&s[way], "ball2", 30.0f * sinf(t * 0.2f), 1.0f, 30.0f * cosf(t * 0.13f),
                          1.0f);
            move_instance(&s[way], "late1", 25.0f * cosf(t * 0.3f), 3.0f, 3.0f, 2.0f);
            draw(&s[way], &f, &commands, pixels[way]);
            masu_stats_info stats = stats_of(&s[way], commands.slot);
            uint32_t one = way != NEITHER;
            memcpy(map[one], read_image(&s[way], commands.slot, MASU_READBACK_SHADOW_MAP),
                   sizeof map[0]);
            memcpy(lit[one], read_image(&s[way], commands.slot, MASU_READBACK_OCCLUSION),
                   sizeof lit[0]);
            assert_int_equal(stats.view_count, 4);
            uint64_t all = 0;
            for (uint32_t v = 1; v < 4; v++) {
                const masu_view_stats *view = &stats.views[v];
                int occlusion = way == BOTH || way == OCCLUSION;
                assert_true(view->visible_triangles <= view->triangles);
                all += occlusion ? view->visible_triangles : view->triangles;
            }
            if (way == NEITHER) drawn = all;
            assert_true(all <= drawn);
            casters[way] += all;
            if (one && refresh[0] > 1 && max_difference(map[0], map[1], sizeof map[0]))
                fail_msg("frame %u: the shadow map differs, stages %u", frame, way);
            if (one && max_difference(lit[0], lit[1], sizeof lit[0]))
                fail_msg("frame %u: shadows differ, stages %u", frame, way);
            if (max_difference(pixels[way], pixels[NEITHER], BYTES))
                fail_msg("frame %u differs, stages %u", frame, way);
        }
    }
    for (uint32_t way = 0; way < WAYS; way++) {
        print_message("stages %u: casters %8.1f triangles a frame\n", way,
                      (double)casters[way] / frames);
        close_session(&s[way]);
    }
}

static void shadows_are_the_same_without_culling(void **state) {
    (void)state;
    uint64_t every[WAYS], slow[WAYS];
    bake_shadows();
    const uint32_t frames = trials(180, 60, 20), slow_frames = trials(60, 60, 20);
    compare_shadows(frames, (const uint32_t[3]){1, 1, 1}, every);
    compare_shadows(slow_frames, (const uint32_t[3]){2, 3, 5}, slow);
    assert_true(every[FRUSTUM] < every[NEITHER] * 9 / 10);
    assert_true(every[BOTH] < every[FRUSTUM]);
    assert_true(every[OCCLUSION] < every[NEITHER]);
    /* Per frame; a jumping sun has slow cascades rendered more often than shadow_refresh
     * requests. */
    assert_true(slow[NEITHER] > 0 && 4 * slow[NEITHER] * frames < 3 * every[NEITHER] * slow_frames);
}

/* A plate is all that the camera sees. A box above it, out of view, passes over it: the texels of
 * the shadow map are so large that the box's shadow reaches the plate through the filter alone,
 * from up to two texels away. */
static void a_shadow_that_only_the_filter_reaches_is_drawn(void **state) {
    (void)state;
    enum { STEPS = 48 };
    static const char scene[] =
        "{\"models\": [{\"mesh\": {\"box\": {\"size\": [0.5, 0.1, 0.5]}}},"
        "{\"name\": \"moving\", \"mesh\": {\"box\": {\"size\": [0.5, 0.2, 0.5]}}, "
        "\"occluder\": true, \"translate\": [0, 2, 0]}],"
        "\"camera\": {\"fov_y\": 14, \"keys\": [{\"position\": [0, 1, 3], \"target\": [0, 0, 0]}]},"
        "\"sun\": {\"azimuth\": 20, \"elevation\": 80, \"shadows\": {\"cascades\": 1, "
        "\"resolution\": 32, \"distance\": 4}}, \"reflections\": false}";
    uint32_t left_out = 0, dark = 0;
    masu_session s;
    bake_scene("plate", scene);
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene("plate");
    d.desc.rung_count = WAYS;
    d.desc.rungs[OCCLUSION].frustum = d.desc.rungs[NEITHER].frustum = MASU_OFF;
    d.desc.rungs[FRUSTUM].occlusion = d.desc.rungs[NEITHER].occlusion = MASU_OFF;
    open_session(&s, &d);
    for (uint32_t n = 0; n < STEPS; n++) {
        move_instance(&s, "moving", 2.4f * ((float)n / STEPS - 0.5f), 2, 0.02f * (float)(n % 5), 1);
        for (uint32_t way = 0; way < WAYS; way += NEITHER) {
            masu_frame_desc f = {.rung = way, .cut = 1};
            masu_commands commands;
            draw(&s, &f, &commands, pixels[way]);
            masu_stats_info stats = stats_of(&s, commands.slot);
            left_out += way == BOTH && stats.views[1].visible_triangles < 24;
        }
        if (max_difference(pixels[BOTH], pixels[NEITHER], BYTES)) fail_msg("step %u differs", n);
        if (n == 0) memcpy(pixels[FRUSTUM], pixels[BOTH], BYTES);
        dark += max_difference(pixels[FRUSTUM], pixels[BOTH], BYTES) > 8;
    }
    close_session(&s);
    print_message("box without a shadow in %u of %u steps, plate shaded in %u\n", left_out, STEPS,
                  dark);
    assert_true(left_out > STEPS / 8 && dark > STEPS / 8 && left_out + dark <= STEPS);
}

/* A slow cascade is rendered again when the next rung has other LODs: its map is that of a renderer
 * which has only had this rung. */
static void a_slow_cascade_has_the_lods_of_its_rung(void **state) {
    (void)state;
    enum { FINE, COARSE, RESOLUTION = 64, BYTES_OF_MAP = RESOLUTION * RESOLUTION * 4 };
    static const char scene[] =
        "{\"lods\": 3, \"models\": [{\"mesh\": {\"plane\": {\"size_x\": 6, \"size_z\": 6}}},"
        "{\"mesh\": {\"sphere\": {\"radius\": 1, \"subdivisions\": 4}}, \"translate\": [0, 1.5, "
        "0]}],"
        "\"camera\": {\"keys\": [{\"position\": [0, 3, 6], \"target\": [0, 0.5, 0]}]},"
        "\"sun\": {\"azimuth\": 20, \"elevation\": 50, \"shadows\": {\"cascades\": 1, "
        "\"resolution\": 64, \"distance\": 20}}, \"reflections\": false}";
    static uint8_t map[3][BYTES_OF_MAP];
    bake_scene("round", scene);
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene("round");
    d.desc.rung_count = 2;
    d.desc.readback = MASU_READBACK_SHADOW_MAP;
    d.desc.rungs[FINE].lod_error = -1;
    d.desc.rungs[COARSE].lod_error = 1e9f;
    d.desc.rungs[FINE].shadow_refresh[0] = d.desc.rungs[COARSE].shadow_refresh[0] = 64;
    for (uint32_t alone = 0; alone < 2; alone++) {
        masu_session s;
        open_session(&s, &d);
        for (uint32_t n = 0; n < 3; n++) {
            masu_commands commands;
            masu_frame_desc f = {.rung = alone || n == 2 ? COARSE : FINE, .cut = n == 0};
            draw(&s, &f, &commands, NULL);
            if (!alone && n == 0) continue;
            memcpy(map[alone ? 2 : n - 1], read_image(&s, commands.slot, MASU_READBACK_SHADOW_MAP),
                   BYTES_OF_MAP);
        }
        close_session(&s);
    }
    assert_true(memcmp(map[0], map[1], BYTES_OF_MAP)); /* the LODs differ in their shadows */
    assert_memory_equal(map[1], map[2], BYTES_OF_MAP);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_is_the_same_without_culling),
        cmocka_unit_test(what_moves_is_culled_where_it_is),
        cmocka_unit_test(velocities_are_the_same_without_culling),
        cmocka_unit_test(shadows_are_the_same_without_culling),
        cmocka_unit_test(a_shadow_that_only_the_filter_reaches_is_drawn),
        cmocka_unit_test(a_slow_cascade_has_the_lods_of_its_rung),
    };
    return cmocka_run_group_tests_name("culling", tests, make_scratch, remove_scratch);
}
