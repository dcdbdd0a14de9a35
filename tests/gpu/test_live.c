/* test_live.c: models that are added, removed and moved between frames. A hidden model leaves the
 * image of a scene that never had it: no shadow, reflection, light or pane. The image is
 * bit-identical, except for the rounding of rays, whose BVH and shaders differ. Moved and added
 * models give the image of a scene baked with them. */
#include "support/floats.h"
#include "support/support.h"

#include "device/bind.h"
#include "renderer.h"
#include "scene/trace_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 160, H = 90, BYTES = W * H * 4, FRAMES = 6 };

static uint8_t pictures[3][FRAMES][BYTES];

static masu_session_desc desc_of(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    return d;
}

static masu_model model_of(masu_session *s, const char *name) {
    masu_model model = masu_model_find(s->m, name);
    assert_int_not_equal(model.id, 0);
    return model;
}

static void put(masu_session *s, masu_model model, float x, float y, float z) {
    const float rows[12] = {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z};
    assert_int_equal(masu_model_set_transform(s->m, model, rows, &failure), MASU_OK);
}

static void show(masu_session *s, const char *name, uint32_t shown) {
    assert_int_equal(masu_model_show(s->m, model_of(s, name), shown, &failure), MASU_OK);
}

/* Renders FRAMES frames from number `first`, after a cut: reflections accumulate. */
static void draw_frames(masu_session *s, uint32_t first, uint8_t out[FRAMES][BYTES]) {
    for (uint32_t i = 0; i < FRAMES; i++) {
        masu_commands commands;
        draw(s, &(masu_frame_desc){.cut = i == 0, .time_step = 1.0f / 60}, &commands, out[i]);
        assert_int_equal(commands.frame, first + i);
    }
}

/* ---- Hiding ---------------------------------------------------------------------------------- */

static void what_is_hidden_has_never_been(void **state) {
    (void)state;
    masu_session with, without;
    masu_session_desc d = desc_of("test_live"), bare = desc_of("test_live_bare");
    open_session(&without, &bare);
    open_session(&with, &d);
    draw_frames(&with, 0, pictures[0]); /* the truck and the pane are visible */
    draw_frames(&without, 0, pictures[1]);
    assert_true(max_difference(pictures[0][FRAMES - 1], pictures[1][FRAMES - 1], BYTES) > 60);
    show(&with, "truck", 0);
    show(&with, "pane", 0);
    draw_frames(&with, FRAMES, pictures[0]);
    draw_frames(&without, FRAMES, pictures[1]);
    uint32_t off = 0;
    const uint8_t *a = pictures[0][0], *b = pictures[1][0];
    for (uint32_t i = 0; i < FRAMES * BYTES; i++) off += a[i] != b[i];
    printf("  %u of %u bytes differ from the scene without it\n", off, FRAMES * BYTES);
    assert_true(off <= FRAMES * BYTES / 10000);
    assert_true(max_difference(a, b, FRAMES * BYTES) <= 1);
    close_session(&with);
    close_session(&without);
}

/* A hidden lamp is off, a shown one is on. A model that is shown again is unchanged. */
static void what_comes_back_is_as_it_was(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_live");
    open_session(&s, &d);
    assert_int_equal(masu_scene_count(&s.scene, MASU_SCENE_MODEL),
                     5); /* truck, its two copies, lamp, pane */
    draw_frames(&s, 0, pictures[0]);
    masu_model_state truck;
    assert_int_equal(masu_model_get(s.m, model_of(&s, "truck"), &truck, &failure), MASU_OK);
    show(&s, "lamp", 1);
    draw_frames(&s, FRAMES, pictures[1]);
    assert_int_equal(stats_of(&s, 1).lights_in_view, 1);
    uint32_t lit = 0;
    for (uint32_t i = 0; i < BYTES; i++)
        lit += pictures[1][FRAMES - 1][i] > pictures[0][FRAMES - 1][i] + 8;
    printf("  a lamp that is shown lights %u of %u bytes\n", lit, BYTES);
    assert_true(lit > BYTES / 50);
    show(&s, "lamp", 0);
    show(&s, "truck", 0);
    put(&s, model_of(&s, "truck"), 40, 0, 0);
    draw_frames(&s, 2 * FRAMES, pictures[1]);
    show(&s, "truck", 1);
    assert_int_equal(masu_model_set_transform(s.m, model_of(&s, "truck"), truck.rows, &failure),
                     MASU_OK);
    draw_frames(&s, 3 * FRAMES, pictures[1]);
    assert_int_equal(stats_of(&s, 1).lights_in_view, 0);
    /* Blue noise has other numbers in these frames: reflections differ by their noise, the rest by
     * the rounding of a position to float. */
    double sum = 0;
    for (uint32_t i = 0; i < BYTES; i++)
        sum += abs(pictures[0][FRAMES - 1][i] - pictures[1][FRAMES - 1][i]);
    printf("  mean difference after it has come back: %.3f of 255\n", sum / BYTES);
    assert_true(sum / BYTES < 1.0);
    close_session(&s);
}

/* ---- Moving ---------------------------------------------------------------------------------- */

static void what_is_moved_is_as_if_baked_so(void **state) {
    (void)state;
    masu_session live, baked;
    masu_session_desc d = desc_of("test_live"), truth = desc_of("test_live_moved");
    open_session(&baked, &truth);
    open_session(&live, &d);
    const float second[12] = {1, 0, 0, -2.5f, 0, 1, 0, 0, 0, 0, 1, 0.25f};
    masu_model added;
    put(&live, model_of(&live, "truck"), 1.5f, 0.25f, -1.0f);
    put(&live, model_of(&live, "pane"), -2.5f, 0.6f, 2.0f);
    show(&live, "lamp", 1);
    assert_int_equal(masu_model_add(live.m, model_of(&live, "truck"), second, &added, &failure),
                     MASU_OK);
    assert_int_equal(added.id, model_of(&live, "truck.1").id);
    draw_frames(&live, 0, pictures[0]);
    draw_frames(&baked, 0, pictures[1]);
    uint32_t off = 0;
    for (uint32_t i = 0; i < BYTES; i++)
        off += abs(pictures[0][FRAMES - 1][i] - pictures[1][FRAMES - 1][i]) > 4;
    printf("  %u of %u bytes differ by more than 4 from the scene baked so\n", off, BYTES);
    assert_true(off < BYTES / 200);
    close_session(&live);
    close_session(&baked);
}

/* A model that has just been shown has no velocity, although it was elsewhere before. */
static void what_is_shown_has_not_moved(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_live");
    d.desc.readback = MASU_READBACK_VELOCITY;
    open_session(&s, &d);
    masu_commands commands;
    draw(&s, &(masu_frame_desc){.rung = 0}, &commands, NULL);
    masu_model added = {0};
    for (uint32_t frame = 0; frame < 3; frame++) {
        const float at[12] = {1, 0, 0, 0.5f, 0, 1, 0, 0.2f * (float)frame, 0, 0, 1, 2.0f};
        if (frame == 0)
            assert_int_equal(masu_model_add(s.m, model_of(&s, "truck"), at, &added, &failure),
                             MASU_OK);
        else if (frame == 2)
            assert_int_equal(masu_model_set_transform(s.m, added, at, &failure), MASU_OK);
        const uint16_t *v =
            draw_image(&s, &(masu_frame_desc){.rung = 0}, MASU_READBACK_VELOCITY, NULL);
        double most = 0;
        for (uint32_t i = 0; i < W * H; i++)
            most = worst_of(most, hypot(half_float(v[4 * i]), half_float(v[4 * i + 1])));
        printf("  frame %u: at most %g pixels\n", frame, most);
        if (frame < 2) assert_true(most < 0.01);
        if (frame == 2) assert_true(most > 1.0);
    }
    close_session(&s);
}

/* Rays read positions of the previous frame, too. After a model stops, both positions are equal in
 * every slot, although nothing is written once nothing moves. True: the device has ray queries. */
static bool comes_to_rest(masu_switch queries) {
    masu_session s;
    masu_session_desc d = desc_of("test_live");
    masu_commands commands;
    d.host.ray_query = true;
    d.desc.ray_query = queries;
    open_session(&s, &d);
    masu_model truck = model_of(&s, "truck");
    uint32_t slots = s.m->plan.desc.frames_in_flight, differ = 0;
    const uint64_t rows = masu_trace_rows_at(&s.m->plan.scene, s.m->plan.needs.query);
    assert_true(s.m->plan.needs.traced && s.m->plan.scene.trace_instances > 0);
    for (uint32_t frame = 0; frame < 10 + slots; frame++) {
        if (frame < 4) put(&s, truck, 0.3f * (float)frame, 0, 0);
        draw(&s, &(masu_frame_desc){.time = frame / 60.0}, &commands, NULL);
        const float *at =
            (const float *)(const void *)(masu_buffer_pointer(&s.m->device, MASU_BUFFER_TRACE_FRAME,
                                                              frame % slots) +
                                          rows);
        for (uint32_t i = 0; i < s.m->plan.scene.trace_instances; i++, at += 24) {
            int same = memcmp(at, at + 12, 12 * sizeof *at) == 0;
            if (frame < 4) differ += !same;
            else if (frame > 4 && !same)
                fail_msg("frame %u: instance %u is where it was not", frame, i);
        }
    }
    assert_true(differ > 0);
    bool offered = s.host.ray_query;
    close_session(&s);
    return offered;
}

static void what_has_come_to_rest_is_where_it_was(void **state) {
    (void)state;
    if (comes_to_rest(MASU_OFF)) comes_to_rest(MASU_ON);
}

/* ---- Limits ---------------------------------------------------------------------------------- */

static void the_last_spare_one_is_the_last(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_live");
    open_session(&s, &d);
    masu_model truck = model_of(&s, "truck"), added[3];
    const float at[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_int_equal(masu_model_add(s.m, truck, at, &added[0], &failure), MASU_OK);
    assert_int_equal(masu_model_add(s.m, truck, at, &added[1], &failure), MASU_OK);
    assert_int_equal(masu_model_add(s.m, truck, at, &added[2], &failure), MASU_ERROR_LIMIT);
    assert_int_equal(added[2].id, 0);
    assert_string_equal(failure.what, "models");
    assert_int_equal(masu_model_show(s.m, added[0], 0, &failure), MASU_OK);
    assert_int_equal(masu_model_add(s.m, added[1], at, &added[2], &failure), MASU_OK);
    assert_int_equal(added[2].id, added[0].id);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_hidden_has_never_been),
        cmocka_unit_test(what_comes_back_is_as_it_was),
        cmocka_unit_test(what_is_moved_is_as_if_baked_so),
        cmocka_unit_test(what_is_shown_has_not_moved),
        cmocka_unit_test(what_has_come_to_rest_is_where_it_was),
        cmocka_unit_test(the_last_spare_one_is_the_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
