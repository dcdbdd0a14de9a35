/* test_depth_bias.c: coplanar decals with a depth bias are in front of their surface at 1 m and at
 * 200 m, opaque, alpha-tested and transparent, for picking too; without one they are not. Unlit
 * materials of a scene description show their colour. */
#include "image.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 160, H = 90 };

static masu_detail failure; /* of the last call that failed */
static masu_session s;
static uint16_t hdr[W * H * 4];

/* A floor, a decal of another triangulation in its plane, and a lid above its middle. */
static void bake(double size, const char *decal) {
    char json[4096];
    snprintf(
        json, sizeof json,
        "{\"sun\": {\"intensity\": 0}, \"ambient\": [0.5, 0.5, 0.5], \"ambient_occlusion\": false, "
        "\"models\": ["
        "{\"name\": \"floor\", \"mesh\": {\"plane\": {\"size_x\": %g, \"size_z\": %g}}, "
        "\"rotate\": [7, 31, 3], "
        "\"material\": {\"base_color\": [1, 0, 0], \"unlit\": true}},"
        "{\"name\": \"decal\", \"moving\": true, \"mesh\": {\"plane\": {\"size_x\": %g, "
        "\"size_z\": %g}}, "
        "\"rotate\": [7, 31, 3], \"material\": {\"base_color\": [0, 0.5, 0], \"unlit\": true %s}},"
        "{\"name\": \"lid\", \"mesh\": {\"plane\": {\"size_x\": %g, \"size_z\": %g}}, \"rotate\": "
        "[7, 31, 3], "
        "\"translate\": [0, %g, 0], \"material\": {\"base_color\": [0, 0, 0.5], \"unlit\": "
        "true}}]}",
        8 * size, 8 * size, 0.9 * size, 0.7 * size, decal, 0.2 * size, 0.2 * size, 0.02 * size);
    bake_scene("decal", json);
}

/* From a distance, towards the middle, 25 degrees above the ground. */
static masu_camera camera_at(double distance) {
    return (masu_camera){.position = {0.3 * distance, 0.42 * distance, 0.85 * distance},
                         .forward = {-0.3f, -0.42f, -0.85f},
                         .fov_y = 0.9f,
                         .near_distance = 0.05f};
}

typedef struct shares {
    double decal, lid; /* of all pixels */
} shares;

static shares look(double distance) {
    masu_camera camera = camera_at(distance);
    masu_frame_desc frame = {.camera = &camera};
    masu_commands commands;
    shares out = {0, 0};
    masu_session_desc d = test_desc(NULL, W, H);
    static uint8_t shown[W * H * 4];
    d.scene_path = baked_scene("decal");
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.picking = 1;
    open_session(&s, &d);
    draw(&s, &frame, &commands, shown);
    memcpy(hdr, read_image(&s, commands.slot, MASU_READBACK_HDR), sizeof hdr);
    for (uint32_t i = 0; i < W * H; i++) {
        out.decal += half_float(hdr[4 * i + 1]) > 0.2 && half_float(hdr[4 * i + 2]) < 0.1;
        out.lid += half_float(hdr[4 * i + 2]) > 0.2;
    }
    const char *folder = getenv("MASU_LOOKS_OUT");
    static int number;
    char path[512], error[256];
    if (folder) {
        snprintf(path, sizeof path, "%s/bias%02d.png", folder, number++);
        assert_ok(masu_image_save_png(path, shown, W, H, 0, error, sizeof error));
    }
    return out;
}

/* The decal, lifted by half a millimetre per metre of distance: what it covers. */
static shares expected(double distance) {
    masu_camera camera = camera_at(distance);
    masu_frame_desc frame = {.camera = &camera};
    masu_commands commands;
    shares out = {0, 0};
    masu_model_state model;
    masu_model decal = masu_model_find(s.m, "decal");
    assert_int_equal(masu_model_get(s.m, decal, &model, &failure), MASU_OK);
    model.rows[7] += (float)(5e-4 * distance);
    assert_int_equal(masu_model_set_transform(s.m, decal, model.rows, &failure), MASU_OK);
    draw(&s, &frame, &commands, NULL);
    const uint16_t *is = read_image(&s, commands.slot, MASU_READBACK_HDR);
    for (uint32_t i = 0; i < W * H; i++) {
        out.decal += half_float(is[4 * i + 1]) > 0.2 && half_float(is[4 * i + 2]) < 0.1;
        out.lid += half_float(is[4 * i + 2]) > 0.2;
    }
    return out;
}

static uint32_t picked_decal(double distance) {
    masu_camera camera = camera_at(distance);
    uint32_t hits = 0;
    masu_node_state node;
    assert_int_equal(masu_model_node_get(s.m, masu_model_find(s.m, "decal"), 0, &node, &failure),
                     MASU_OK);
    for (uint32_t i = 0; i < 8; i++) {
        masu_commands commands;
        masu_pick_info info;
        masu_frame_desc frame = {
            .camera = &camera, .pick = 1, .pick_x = W / 2 - 36 + i, .pick_y = H / 2};
        draw(&s, &frame, &commands, NULL);
        assert_int_equal(masu_pick(s.m, commands.slot, &info, &failure), MASU_OK);
        hits += info.instance.id == node.instance.id;
    }
    return hits;
}

static void decals_are_in_front_at_every_distance(void **state) {
    (void)state;
    static const double distances[] = {1, 200};
    static const char *const kinds[] = {"", ", \"opacity\": 0.9, \"blend\": \"alpha\""};
    double fights = 0;
    for (int blended = 0; blended < 2; blended++) {
        for (size_t k = 0; k < 2; k++) {
            for (int biased = 0; biased < 2; biased++) {
                char decal[128];
                snprintf(decal, sizeof decal, "%s%s", kinds[blended],
                         biased ? ", \"depth_bias\": 0.0005" : "");
                bake(distances[k], decal);
                shares is = look(distances[k]);
                uint32_t picks = biased ? picked_decal(distances[k]) : 0;
                shares want = expected(distances[k]);
                print_message("%s%s at %g m: %g of %g pixels of the decal, %g of %g of the lid, "
                              "picked %u of 8\n",
                              blended ? "transparent" : "opaque", biased ? ", biased" : "",
                              distances[k], is.decal, want.decal, is.lid, want.lid, picks);
                assert_true(want.decal > W * H / 10);
                if (biased) {
                    assert_true(fabs(is.decal - want.decal) <= 0.01 * want.decal + 2);
                    assert_true(fabs(is.lid - want.lid) <= 2);
                    assert_int_equal(picks, 8);
                } else if (!blended) {
                    fights += want.decal - is.decal;
                }
                close_session(&s);
            }
        }
    }
    assert_true(fights > 0); /* without a bias; else this test shows nothing */
}

static void unlit_materials_show_their_color(void **state) {
    (void)state;
    static uint8_t rgba[8 * 8 * 4];
    char error[256];
    masu_camera camera = {
        .position = {0, 4, 0}, .forward = {0, -1, 0}, .up = {0, 0, -1}, .fov_y = 0.5f};
    masu_frame_desc frame = {.camera = &camera};
    masu_commands commands;
    for (size_t i = 0; i < sizeof rgba; i++) rgba[i] = 255;
    assert_ok(masu_image_save_png(in_scratch("white.png"), rgba, 8, 8, 0, error, sizeof error));
    bake_scene(
        "unlit",
        "{\"sun\": {\"intensity\": 3}, \"ambient\": [1, 1, 1], \"models\": ["
        "{\"mesh\": {\"box\": {\"size\": [1, 1, 8]}}, \"translate\": [-1, 0, 0], \"material\": "
        "{\"base_color\": [0.25, 0.5, 0.125], \"metallic\": 1, \"coat\": 1, \"roughness\": 0, "
        "\"unlit\": true}},"
        "{\"mesh\": {\"box\": {\"size\": [1, 1, 8]}}, \"translate\": [1, 0, 0], \"material\": "
        "{\"base_color\": [0.25, 0.5, 0.125], \"unlit\": true, \"base_color_map\": "
        "\"white.png\"}}]}");
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene("unlit");
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    draw(&s, &frame, &commands, NULL);
    const uint16_t *is = read_image(&s, commands.slot, MASU_READBACK_HDR);
    for (uint32_t side = 0; side < 2; side++) {
        const uint16_t *at = is + 4 * (H / 2 * W + (side ? W * 3 / 4 : W / 4));
        print_message("unlit: %g %g %g\n", half_float(at[0]), half_float(at[1]), half_float(at[2]));
        assert_true(half_float(at[0]) == 0.25 && half_float(at[1]) == 0.5 &&
                    half_float(at[2]) == 0.125);
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decals_are_in_front_at_every_distance),
        cmocka_unit_test(unlit_materials_show_their_color),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
