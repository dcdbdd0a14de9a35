/* test_instance_looks.c: looks of instances (masu_look) are the image of a scene that was baked so:
 * tint, emission and texture coordinates, in mirrors and through panes too; fades leave out their
 * share of pixels; flags and masks remove an instance from one thing and from nothing else. */
#include "image.h"
#include "support/files.h"
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 160, H = 90, BYTES = W * H * 4, FRAMES = 4 };

static masu_detail failure; /* of the last call that failed */
static uint8_t images[4][BYTES];
static masu_session s;

/* The texture's halves, left and right. */
static const char *texture(int swapped) {
    static uint8_t rgba[16 * 16 * 4];
    char error[256];
    for (int i = 0; i < 16 * 16; i++) {
        int right = (i % 16 >= 8) != swapped;
        const uint8_t color[4] = {right ? 40 : 200, right ? 160 : 60, 90, 255};
        memcpy(rgba + 4 * i, color, 4);
    }
    const char *name = swapped ? "swapped.png" : "halves.png";
    assert_ok(masu_image_save_png(in_scratch(name), rgba, 16, 16, 0, error, sizeof error));
    return name;
}

/* A mirror below a box, a lamp, a textured wall, a pane and a sign, each a movable model; with the
 * factors of a look in the materials instead. */
static void bake(const char *name, float red, float green, float glow, int swapped) {
    char json[4096];
    snprintf(
        json, sizeof json,
        "{\"models\": ["
        "{\"mesh\": {\"plane\": {\"size_x\": 14, \"size_z\": 14}}, \"material\": {\"base_color\": "
        "[0.9, 0.9, 0.9], \"roughness\": 0.05, \"metallic\": 1}},"
        "{\"mesh\": {\"plane\": {\"size_x\": 4, \"size_z\": 9}}, \"translate\": [-4.5, 0.01, 0], "
        "\"material\": {\"base_color\": [0.5, 0.5, 0.5], \"roughness\": 1}},"
        "{\"name\": \"box\", \"moving\": true, \"mesh\": {\"box\": {\"size\": [1, 1, 1]}}, "
        "\"translate\": [-2, 0.7, 0], \"occluder\": true, \"material\": "
        "{\"base_color\": [%g, %g, 0.25], \"roughness\": 0.9}},"
        "{\"name\": \"lamp\", \"moving\": true, \"area_light\": false, \"mesh\": {\"box\": "
        "{\"size\": "
        "[0.6, 0.6, 0.6]}}, \"translate\": [0, 0.5, 0], \"material\": {\"base_color\": [0, 0, 0], "
        "\"emissive\": [%g, %g, %g]}},"
        "{\"name\": \"wall\", \"moving\": true, \"mesh\": {\"plane\": {\"size_x\": 1.4, "
        "\"size_z\": "
        "1.4}}, \"rotate\": [90, 0, 0], \"translate\": [2, 0.9, 0], \"material\": {\"base_color\": "
        "[%g, %g, 1], \"roughness\": 1, \"repeat\": true, \"base_color_map\": \"%s\"}},"
        "{\"name\": \"pane\", \"moving\": true, \"mesh\": {\"box\": {\"size\": [1, 1, 0.05]}}, "
        "\"translate\": [-1, 0.7, 1.5], \"material\": {\"base_color\": [%g, %g, 0.25], "
        "\"opacity\": 0.5}},"
        "{\"name\": \"sign\", \"moving\": true, \"mesh\": {\"box\": {\"size\": [0.5, 0.5, 0.5]}}, "
        "\"translate\": [1.5, 0.4, 1.5], \"material\": {\"base_color\": [%g, %g, 0.25], \"unlit\": "
        "true}}],"
        "\"camera\": {\"fov_y\": 45, \"near\": 0.05, \"keys\": [{\"position\": [0, 2.5, 6], "
        "\"target\": [0, 0.5, 0]}]},"
        "\"sun\": {\"azimuth\": 60, \"elevation\": 40, \"intensity\": 1, \"shadows\": "
        "{\"cascades\": "
        "1, \"resolution\": 512, \"distance\": 20}},"
        "\"ambient\": [0.3, 0.3, 0.3], \"reflections\": {}, \"ambient_occlusion\": false}",
        0.8 * (double)red, 0.4 * (double)green, 0.5 * (double)glow, 0.25 * (double)glow,
        0.125 * (double)glow, (double)red, (double)green, texture(swapped), 0.8 * (double)red,
        0.4 * (double)green, 0.8 * (double)red, 0.4 * (double)green);
    bake_scene(name, json);
}

static masu_session_desc desc_of(const char *name, int looks) {
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene(name);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.instance_looks = (uint32_t)looks;
    d.desc.picking = 1;
    d.desc.reserve.models = 1;
    return d;
}

/* mirrors: with reflections, whose noise goes by the number of the frame. */
static void open_looks(const char *name, int looks, int mirrors) {
    masu_session_desc d = desc_of(name, looks);
    if (!mirrors) d.desc.rungs[0].specular = MASU_OFF;
    open_session(&s, &d);
}

/* The last of some frames after a cut, which reflections need. */
static void draw_last(uint8_t *out) {
    for (uint32_t i = 0; i < FRAMES; i++) {
        masu_commands commands;
        draw(&s, &(masu_frame_desc){.cut = i == 0, .time_step = 1.0f / 60}, &commands, out);
    }
    const char *folder = getenv("MASU_LOOKS_OUT");
    static int number;
    char path[512], error[256];
    if (!folder) return;
    snprintf(path, sizeof path, "%s/look%02d.png", folder, number++);
    assert_ok(masu_image_save_png(path, out, W, H, 0, error, sizeof error));
}

static void set(const char *model, const masu_look *look) {
    assert_int_equal(masu_model_set_look(s.m, masu_model_find(s.m, model), look, &failure),
                     MASU_OK);
}

static const char *const names[] = {"box", "lamp", "wall", "pane", "sign"};
#define KINDS (sizeof names / sizeof *names)

static uint32_t differing(const uint8_t *a, const uint8_t *b, int more_than) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        int most = 0;
        for (uint32_t k = 0; k < 3; k++) {
            int off = abs(a[4 * i + k] - b[4 * i + k]);
            most = off > most ? off : most;
        }
        count += most > more_than;
    }
    return count;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static void looks_are_as_if_baked_so(void **state) {
    (void)state;
    bake("plain", 1, 1, 1, 0);
    bake("looked", 0.5f, 0.25f, 4, 1);
    open_looks("looked", 0, 1);
    draw_last(images[0]);
    draw_last(images[0]); /* noise goes by the number of the frame */
    close_session(&s);
    open_looks("plain", 1, 1);
    draw_last(images[1]);
    for (size_t k = 0; k < KINDS; k++)
        set(names[k], &(masu_look){.tint = {0.5f, 0.25f, 1},
                                   .emission = strcmp(names[k], "sign") ? 4 : 0,
                                   .uv_offset = {0.5f, 0}});
    draw_last(images[2]);
    uint32_t before = differing(images[0], images[1], 1), off = differing(images[0], images[2], 1);
    print_message("%u of %u pixels differ by more than 1 from the scene baked so, before %u\n", off,
                  W * H, before);
    assert_true(before > W * H / 10);
    assert_int_equal(off, 0);
    /* And back. */
    for (size_t k = 0; k < KINDS; k++) set(names[k], &(masu_look){.flags = 0});
    draw_last(images[2]);
    close_session(&s);
    open_looks("plain", 0, 1);
    draw_last(images[0]);
    draw_last(images[0]);
    draw_last(images[0]);
    assert_int_equal(differing(images[0], images[2], 0), 0);
    close_session(&s);
}

/* Reserved and not used: the same bits, and the stated bytes. */
static void reserved_looks_change_no_bit_and_cost_what_is_stated(void **state) {
    (void)state;
    masu_memory_row rows[MEMORY_ROWS];
    uint64_t bytes[2][2] = {{0}};
    for (int looks = 0; looks < 2; looks++) {
        open_looks("plain", looks, 1);
        draw_last(images[looks]);
        uint32_t count = memory_rows(s.m, rows);
        for (uint32_t i = 0; i < count; i++) {
            if (strcmp(rows[i].name, "instances") == 0) bytes[looks][0] = rows[i].bytes;
            if (strncmp(rows[i].name, "look", 4) == 0) bytes[looks][1] += rows[i].bytes;
        }
        close_session(&s);
    }
    assert_int_equal(max_difference(images[0], images[1], BYTES), 0);
    assert_int_equal(bytes[0][1], 0);
    assert_int_equal(bytes[1][1], 49 * 8); /* 7 instances, and the reserve's */
    assert_int_equal(bytes[1][0], 2 * 2 * 8 * 96); /* 2 frames in flight, with velocities */
}

static void values_out_of_range_are_rejected(void **state) {
    (void)state;
    static const masu_look good[] = {
        {.tint = {1, 1, 1}, .emission = 1e6f, .fade = 1, .flags = 7},
        {.emission = -1e6f, .uv_offset = {1e4f, -1e4f}, .uv_scale = {-1e4f, 1e4f}}};
    static const masu_look bad[] = {{.tint = {0, 1.001f, 0}},  {.tint = {-0.001f, 0, 0}},
                                    {.emission = 1.1e6f},      {.uv_offset = {0, 1.1e4f}},
                                    {.uv_scale = {1.1e4f, 0}}, {.fade = 1.001f},
                                    {.fade = -0.001f},         {.flags = 8}};
    static const char *const what[] = {"look.tint",      "look.tint",     "look.emission",
                                       "look.uv_offset", "look.uv_scale", "look.fade",
                                       "look.fade",      "look.flags"};
    masu_look got;
    open_looks("plain", 1, 0);
    masu_instance box = masu_instance_at(s.m, 2);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_int_equal(masu_instance_set_look(s.m, box, &good[i], &failure), MASU_OK);
        assert_int_equal(masu_instance_get_look(s.m, box, &got, &failure), MASU_OK);
        assert_memory_equal(&got, &good[i], sizeof got);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(masu_instance_set_look(s.m, box, &bad[i], &failure), MASU_ERROR_ARGUMENT);
        assert_string_equal(failure.what, what[i]);
    }
    assert_int_equal(masu_instance_get_look(s.m, box, &got, &failure), MASU_OK);
    assert_memory_equal(&got, &good[1], sizeof got);
    assert_int_equal(masu_instance_set_look(s.m, (masu_instance){0}, &good[0], &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_set_look(s.m, (masu_model){0}, &good[0], &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_set_look(s.m, box, NULL, &failure), MASU_ERROR_ARGUMENT);
    close_session(&s);
    open_looks("plain", 0, 0);
    assert_int_equal(masu_instance_set_look(s.m, masu_instance_at(s.m, 2), &good[0], &failure),
                     MASU_ERROR_STATE);
    assert_int_equal(masu_instance_get_look(s.m, masu_instance_at(s.m, 2), &got, &failure),
                     MASU_ERROR_STATE);
    close_session(&s);
}

/* A copy is plain, whatever the model that it was copied from, and whatever its slot has had; its look is its own. */
static void copies_have_a_look_of_their_own(void **state) {
    (void)state;
    const masu_look red = {.tint = {1, 0.1f, 0.1f}}, dark = {.tint = {1e-6f, 0, 0}};
    masu_node_state node;
    masu_look got;
    masu_model copy;
    const float rows[12] = {1, 0, 0, 0, 0, 1, 0, 1.9f, 0, 0, 1, -1};
    open_looks("plain", 1, 0);
    set("box", &red);
    masu_model box = masu_model_find(s.m, "box");
    assert_int_equal(masu_model_add(s.m, box, rows, &copy, &failure), MASU_OK);
    assert_int_equal(masu_model_node_get(s.m, copy, 0, &node, &failure), MASU_OK);
    assert_int_equal(masu_instance_get_look(s.m, node.instance, &got, &failure), MASU_OK);
    assert_memory_equal(&got, &(masu_look){.flags = 0}, sizeof got);
    draw_last(images[0]);
    assert_int_equal(masu_model_set_look(s.m, copy, &dark, &failure), MASU_OK);
    draw_last(images[1]);
    uint32_t off = differing(images[0], images[1], 8);
    print_message("%u pixels show the look of the copy\n", off);
    assert_true(off > 200);
    assert_int_equal(masu_model_remove(s.m, copy, &failure), MASU_OK);
    assert_int_equal(masu_model_add(s.m, box, rows, &copy, &failure), MASU_OK);
    assert_int_equal(masu_model_node_get(s.m, copy, 0, &node, &failure), MASU_OK);
    assert_int_equal(masu_instance_get_look(s.m, node.instance, &got, &failure), MASU_OK);
    assert_memory_equal(&got, &(masu_look){.flags = 0}, sizeof got);
    close_session(&s);
}

/* ---- Fades ----------------------------------------------------------------------------------- */

static void fades_leave_out_their_share_of_pixels(void **state) {
    (void)state;
    static const float fades[] = {0.0f, 0.1f, 0.5f, 0.875f, 1.0f};
    open_looks("plain", 1, 0);
    /* The wall, opaque and without a pixel that is like another's behind it. */
    draw_last(images[0]);
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "wall"), 0, &failure), MASU_OK);
    draw_last(images[1]);
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "wall"), 1, &failure), MASU_OK);
    for (size_t i = 0; i < sizeof fades / sizeof *fades; i++) {
        set("wall", &(masu_look){.fade = fades[i]});
        draw_last(images[2]);
        uint32_t wall = 0, left = 0;
        for (uint32_t p = 0; p < W * H / 2; p++) { /* above the mirror, whose image stays solid */
            const uint8_t *with = images[0] + 4 * p, *without = images[1] + 4 * p,
                          *is = images[2] + 4 * p;
            if (abs(with[0] - without[0]) + abs(with[1] - without[1]) < 24) continue;
            wall++;
            left += abs(is[0] - without[0]) + abs(is[1] - without[1]) <
                    abs(is[0] - with[0]) + abs(is[1] - with[1]);
        }
        double share = (double)left / wall;
        print_message("fade %g: %.3f of %u pixels are left out\n", (double)fades[i], share, wall);
        assert_true(wall > 300);
        assert_true(share > (double)fades[i] - 0.03 && share < (double)fades[i] + 0.03);
        if (fades[i] == 0.0f) assert_int_equal(differing(images[2], images[0], 0), 0);
        if (fades[i] == 1.0f) assert_int_equal(differing(images[2], images[1], 0), 0);
    }
    close_session(&s);
}

/* A box that fades does not cull what is behind it. */
static void what_is_behind_a_fade_is_drawn(void **state) {
    (void)state;
    masu_commands commands;
    masu_camera camera = {.position = {-2, 0.7, 3}, .forward = {0, 0, -1}, .fov_y = 0.3f};
    masu_frame_desc frame = {.camera = &camera};
    open_looks("plain", 1, 0);
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "pane"), 0, &failure), MASU_OK);
    move_instance(&s, "lamp", -2, 0.7f, -2, 1.0f);
    set("box", &(masu_look){.fade = 0.5f});
    for (int i = 0; i < 8; i++) draw(&s, &frame, &commands, images[0]);
    set("lamp", &(masu_look){.emission = -1});
    for (int i = 0; i < 8; i++) draw(&s, &frame, &commands, images[1]);
    uint32_t seen = differing(images[0], images[1], 8);
    print_message("%u pixels show the lamp behind\n", seen);
    assert_true(seen > 100);
    close_session(&s);
}

/* ---- Flags and masks ------------------------------------------------------------------------- */

/* Pixels of the matt floor on the left, where the box casts its shadow. */
static uint32_t shaded(const uint8_t *image, const uint8_t *bright) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < W * H; i++)
        if (i % W < W * 2 / 5 && image[4 * i + 1] + 12 < bright[4 * i + 1]) count++;
    return count;
}

static uint32_t picked(uint32_t x, uint32_t y, uint32_t mask) {
    masu_commands commands;
    masu_pick_info info;
    masu_node_state node;
    draw(&s, &(masu_frame_desc){.pick = 1, .pick_x = x, .pick_y = y, .pick_mask = mask}, &commands,
         NULL);
    assert_int_equal(masu_pick(s.m, commands.slot, &info, &failure), MASU_OK);
    assert_int_equal(masu_model_node_get(s.m, masu_model_find(s.m, "box"), 0, &node, &failure),
                     MASU_OK);
    return info.instance.id == node.instance.id;
}

static void flags_remove_from_one_thing_only(void **state) {
    (void)state;
    open_looks("plain", 1, 1);
    draw_last(images[0]);
    /* Without its shadow and its reflection. */
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "box"), 0, &failure), MASU_OK);
    draw_last(images[1]);
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "box"), 1, &failure), MASU_OK);
    set("box", &(masu_look){.flags = MASU_LOOK_NOT_TRACED});
    draw_last(images[2]);
    set("box", &(masu_look){.flags = MASU_LOOK_NO_SHADOW});
    draw_last(images[3]);
    uint32_t whole = differing(images[0], images[1], 4),
             traced = differing(images[0], images[2], 4),
             shadow = differing(images[0], images[3], 4);
    print_message("box %u pixels, its reflection %u, its shadow %u\n", whole, traced, shadow);
    assert_true(traced > 100 && shadow > 100);
    assert_true(traced + shadow < whole);
    assert_true(shaded(images[0], images[3]) > 60);
    assert_int_equal(shaded(images[2], images[0]), 0);
    close_session(&s);
}

static void a_view_that_hides_an_instance_keeps_its_shadow(void **state) {
    (void)state;
    open_looks("plain", 1, 1);
    draw_last(images[0]);
    set("box", &(masu_look){.hidden_views = ~1u}); /* other viewports */
    draw_last(images[1]);
    assert_in_range(differing(images[0], images[1], 16), 0, 60); /* noise of reflections */
    set("box", &(masu_look){.hidden_views = 1u});
    draw_last(images[1]);
    set("box", &(masu_look){.hidden_views = 1u, .flags = MASU_LOOK_NO_SHADOW});
    draw_last(images[2]);
    set("box",
        &(masu_look){.hidden_views = 1u, .flags = MASU_LOOK_NO_SHADOW | MASU_LOOK_NOT_TRACED});
    draw_last(images[3]);
    assert_true(differing(images[0], images[1], 4) > 200);
    assert_true(shaded(images[1], images[2]) > 60);
    assert_true(differing(images[2], images[3], 4) > 100);
    close_session(&s);
}

/* Two viewports of one place: an instance that the first one does not show is in the second. */
static void viewports_show_what_their_bit_says(void **state) {
    (void)state;
    masu_session_desc d = desc_of("plain", 1);
    d.desc.rungs[0].specular = MASU_OFF;
    d.desc.viewport_count = 2;
    for (uint32_t k = 0; k < 2; k++) d.desc.viewports[k] = (masu_viewport){0, 0, W, H};
    open_session(&s, &d);
    for (uint32_t hidden = 0; hidden < 4; hidden++) {
        set("box", &(masu_look){.hidden_views = hidden});
        for (uint32_t k = 0; k < 2; k++) {
            masu_commands commands;
            draw(&s, &(masu_frame_desc){.viewport = k}, &commands, images[k]);
            if (!hidden) memcpy(images[2 + k], images[k], BYTES);
            assert_int_equal(differing(images[k], images[2 + k], 4) > 200, hidden >> k & 1u);
        }
    }
    close_session(&s);
}

static void queries_pass_through_what_they_do_not_pick(void **state) {
    (void)state;
    const uint32_t x = 40, y = 42; /* of the box */
    open_looks("plain", 1, 0);
    assert_int_equal(picked(x, y, 0), 1);
    assert_int_equal(picked(x, y, 4), 1);
    set("box", &(masu_look){.pick_mask = 6});
    assert_int_equal(picked(x, y, 0), 1);
    assert_int_equal(picked(x, y, 4), 1);
    assert_int_equal(picked(x, y, 1), 0);
    set("box", &(masu_look){.flags = MASU_LOOK_NOT_PICKED});
    assert_int_equal(picked(x, y, 0), 0);
    set("box", &(masu_look){.fade = 0.9f});
    assert_int_equal(picked(x, y, 0), 1);
    set("box", &(masu_look){.fade = 1});
    assert_int_equal(picked(x, y, 0), 0);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(looks_are_as_if_baked_so),
        cmocka_unit_test(reserved_looks_change_no_bit_and_cost_what_is_stated),
        cmocka_unit_test(values_out_of_range_are_rejected),
        cmocka_unit_test(copies_have_a_look_of_their_own),
        cmocka_unit_test(fades_leave_out_their_share_of_pixels),
        cmocka_unit_test(what_is_behind_a_fade_is_drawn),
        cmocka_unit_test(flags_remove_from_one_thing_only),
        cmocka_unit_test(a_view_that_hides_an_instance_keeps_its_shadow),
        cmocka_unit_test(viewports_show_what_their_bit_says),
        cmocka_unit_test(queries_pass_through_what_they_do_not_pick),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
