/* test_temporal.c: rung.temporal against a ground truth of many samples. A static view comes close
 * to it, at full size and at half; disoccluded pixels, changed lights and shadows leave no trails.
 * A cut, NaN and the previous frames have no influence. A change of scale keeps the history; equal
 * frames are bit-identical; reflections move with the reflected surfaces; arbitrary input is safe.
 * The scene is polygons with a shadow map, or the edge of test_truth.c. */
#include "support/files.h"
#include "support/floats.h"
#include "support/support.h"

#include "measure/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 96, PIXELS = SIZE * SIZE, BYTES = 4 * PIXELS };

typedef struct shown {
    uint8_t rgba[BYTES];
} shown;

static shown a, b, truth;

static masu_session_desc temporal_desc(const char *scene, float scale) {
    masu_session_desc d = test_desc(scene, SIZE, SIZE);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.temporal = MASU_ON, .scale = scale};
    return d;
}

/* The scene's camera, moved slightly to the side. */
static masu_camera aside(const masu_session *s, double metres) {
    masu_camera camera;
    assert_int_equal(masu_camera_at(s->m, 0.0, &camera, NULL), MASU_OK);
    camera.position[0] += metres;
    return camera;
}

static void frames(masu_session *s, uint32_t count, masu_frame_desc frame, uint8_t *pixels) {
    masu_commands commands;
    for (uint32_t i = 0; i < count; i++) draw(s, &frame, &commands, i + 1 == count ? pixels : NULL);
}

static double rms(const uint8_t *x, const uint8_t *y) {
    double sum = 0.0;
    for (uint32_t i = 0; i < BYTES; i++) sum += ((double)x[i] - y[i]) * ((double)x[i] - y[i]);
    return sqrt(sum / (3.0 * PIXELS));
}

static double linear_of(uint8_t byte) {
    const double v = byte / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* The ground truth of a scene, with an optional position of its ball. The last one is cached. */
static struct {
    const char *scene;
    int moved, lit;
    float ball[3];
    masu_light light;
} last;

static void find_truth(const char *scene, const float *ball, const masu_light *light) {
    char error[ERROR_SIZE];
    masu_session s;
    if (last.scene && !strcmp(scene, last.scene) && last.moved == (ball != NULL) &&
        last.lit == (light != NULL) && (!ball || !memcmp(ball, last.ball, sizeof last.ball)) &&
        (!light || !memcmp(light, &last.light, sizeof *light)))
        return;
    last.scene = scene, last.moved = ball != NULL, last.lit = light != NULL;
    if (ball) memcpy(last.ball, ball, sizeof last.ball);
    if (light) last.light = *light;
    masu_session_desc d = test_desc(scene, SIZE, SIZE);
    const uint32_t places = trials(64, 32, 32);
    assert_ok(masu_picture_open(&d, places, &s, error, sizeof error));
    if (ball) move_instance(&s, "ball", ball[0], ball[1], ball[2], 1.0f);
    masu_frame_desc f = {MASU_FRAME_DESC, .light = light};
    assert_ok(masu_picture_truth(&s, &f, places, 1, &(masu_picture_means){.display = truth.rgba},
                                 NULL, error, sizeof error));
    close_session(&s);
}

/* ---- Missing cuts ---------------------------------------------------------------------------- */

/* A frame that is not submitted must be followed by a cut. Without it, the next frame must not use
 * the memory's previous content as a history, which would be an image of many samples. */
static void a_frame_left_out_without_a_cut_shows_no_old_memory(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    char error[ERROR_SIZE];
    masu_session_desc d = temporal_desc("test_shadows", 1.0f);
    open_session(&s, &d);
    last.scene = NULL; /* `truth` has other content now */
    masu_frame_desc f = {MASU_FRAME_DESC, .cut = 1};
    for (int i = 0; i < 2; i++) assert_int_equal(masu_frame(s.m, &f, &commands, NULL), MASU_OK);
    draw(&s, &f, &commands, truth.rgba); /* the image without history */
    close_session(&s);
    d.no_renderer = true;
    open_session(&s, &d);
    if (on_gpu(&s)) {
        close_session(&s);
        skip(); /* the host cannot access its memory */
    }
    assert_int_equal(masu_memory_query(&s.desc, &s.need, NULL), MASU_OK);
    const masu_role_need *need = &s.need.roles[MASU_ROLE_DEVICE];
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .allocationSize = need->bytes,
                                 .memoryTypeIndex = need->type};
    VkDeviceMemory memory;
    void *mapped;
    assert_int_equal(vkAllocateMemory(s.host.device, &info, NULL, &memory), VK_SUCCESS);
    assert_int_equal(vkMapMemory(s.host.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
    memset(mapped, 0x60, need->bytes); /* 24 samples of a middle grey */
    s.desc.device_blocks[MASU_ROLE_DEVICE] =
        (masu_device_block){memory, 0, need->bytes, mapped, need->type};
    assert_ok(masu_session_start(&s, error, sizeof error));
    f.cut = 0;
    draw(&s, &f, &commands, NULL);
    assert_int_equal(masu_frame(s.m, &f, &commands, NULL), MASU_OK);
    draw(&s, &f, &commands, a.rgba);
    double off = rms(a.rgba, truth.rgba);
    print_message("  error of %.2f of 255 (root mean square) relative to the image without "
                  "history\n",
                  off);
    assert_true(off < 4.0); /* 2.7; 39 if the memory is used */
    masu_destroy(s.m);
    s.m = NULL;
    vkFreeMemory(s.host.device, memory, NULL);
    close_session(&s);
}

/* ---- Error ----------------------------------------------------------------------------------- */

static void at_rest_it_comes_near_the_truth(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_truth", "test_shadows"};
    /* Not 0.37 or 0.45: for some jitters, with temporal upscaling or without, SwiftShader renders
     * all of the near ground in shadow; its triangle of 40 m passes below the camera. */
    static const float scales[] = {1.0f, 0.7f, 0.5f, 0.4f};
    /* fraction of the error of one frame without history */
    static const double most[] = {0.35, 0.35, 0.35, 0.45};
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        find_truth(scenes[k], NULL, NULL);
        /* if it is no whole run: scale 1 in one scene, a half in the other */
        for (size_t i = whole_run() ? 0 : 2 * k; i < sizeof scales / sizeof *scales;
             i += whole_run() ? 1 : 4) {
            masu_session s;
            masu_session_desc d = temporal_desc(scenes[k], scales[i]);
            d.desc.rung_count = 2;
            d.desc.rungs[1] = (masu_rung){.scale = scales[i]};
            open_session(&s, &d);
            frames(&s, 64, (masu_frame_desc){MASU_FRAME_DESC}, a.rgba);
            draw_rung(&s, 1, b.rgba);
            double with = rms(a.rgba, truth.rgba), without = rms(b.rgba, truth.rgba);
            print_message("  %s, scale %.2f: rms %.2f of 255, without history %.2f\n",
                          scenes[k], (double)scales[i], with, without);
            assert_true(without > 1.0 && with < most[i] * without);
            close_session(&s);
        }
    }
}

/* The camera moves at half a pixel per frame: edges are smoother than in a single frame, without
 * trails. */
static void in_motion_it_is_no_worse(void **state) {
    (void)state;
    static const float scales[] = {1.0f, 0.5f};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_shadows", scales[i]);
        d.desc.rung_count = 2;
        d.desc.rungs[1] = (masu_rung){.scale = scales[i]};
        find_truth("test_shadows", NULL, NULL);
        open_session(&s, &d);
        masu_commands commands;
        for (int k = 24; k >= 0; k--) {
            masu_camera camera = aside(&s, 0.02 * k);
            draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .camera = &camera}, &commands, a.rgba);
        }
        draw_rung(&s, 1, b.rgba);
        double with = rms(a.rgba, truth.rgba), without = rms(b.rgba, truth.rgba);
        print_message("  scale %.2f: rms %.2f of 255, without history %.2f\n",
                      (double)scales[i], with, without);
        assert_true(with < 0.8 * without);
        close_session(&s);
    }
}

/* A white rod half a pixel wide passes in front of a wall at 1.3 pixels per frame: most frames at
 * half size miss it. The sum of its display-linear light, minus the wall's, is its area in pixels,
 * times (1 - wall) each. Twelve frames after it has left, no trace remains. */
static void a_thin_rod_in_motion_keeps_its_light(void **state) {
    (void)state;
    /* In metres, at the distance of the rod. */
    const double pixel = 2.0 * 10.0 * tan(20.0 * acos(-1.0) / 180.0) / SIZE;
    for (uint32_t half = 0; half < 2; half++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_rod", half ? 0.5f : 1.0f);
        double sum = 0.0, expected = 0.0;
        open_session(&s, &d);
        /* There, back and there again: in 40 frames the jitter hits it too often or too seldom. */
        for (int k = 0; k < 144; k++) {
            const int way = k < 48 ? k : k < 96 ? 96 - k : k - 96;
            move_instance(&s, "rod", (float)(1.3 * pixel * (way - 24)), 0.0f, 0.0f, 1.0f);
            frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC}, a.rgba);
            for (uint32_t y = 30; y < 66 && k >= 8; y++) {
                const double wall = linear_of(a.rgba[4 * (SIZE * y + 2)]);
                for (uint32_t x = 0; x < SIZE; x++)
                    sum += linear_of(a.rgba[4 * (SIZE * y + x)]) - wall;
                expected += 0.5 * (1.0 - wall);
            }
        }
        print_message("  scale %.1f: %.3f of the rod's light\n", half ? 0.5 : 1.0, sum / expected);
        assert_true(sum > 0.8 * expected && sum < 1.2 * expected);
        move_instance(&s, "rod", 0.0f, 0.0f, -20.0f, 1.0f);
        frames(&s, 12, (masu_frame_desc){MASU_FRAME_DESC}, a.rgba);
        frames(&s, 40, (masu_frame_desc){MASU_FRAME_DESC}, b.rgba);
        assert_in_range(max_difference(a.rgba, b.rgba, BYTES), 0, 2);
        close_session(&s);
    }
}

/* ---- Changes --------------------------------------------------------------------------------- */

/* Pixels that the change affects, in regions where the ground truth is smooth: those with an error
 * of more than `off` of 255. */
static uint32_t ghosts(const uint8_t *before, const uint8_t *now, uint32_t off, uint32_t *all) {
    uint32_t count = 0;
    *all = 0;
    for (uint32_t y = 1; y + 1 < SIZE; y++) {
        for (uint32_t x = 1; x + 1 < SIZE; x++) {
            const uint8_t *t = &truth.rgba[4 * (y * SIZE + x)], *n = &now[4 * (y * SIZE + x)];
            int change = 0, rough = 0, wrong = 0;
            for (int c = 0; c < 3; c++) {
                change |= abs(before[4 * (y * SIZE + x) + (uint32_t)c] - t[c]) > 12;
                wrong |= (uint32_t)abs(n[c] - t[c]) > off;
                for (int k = 0; k < 9; k++)
                    rough |= abs(t[4 * (k % 3 - 1 + (k / 3 - 1) * SIZE) + c] - t[c]) > 2;
            }
            if (!change || rough) continue;
            *all += 1;
            count += (uint32_t)wrong;
        }
    }
    return count;
}

static void what_leaves_leaves_no_ghost(void **state) {
    (void)state;
    static const float scales[] = {1.0f, 0.5f};
    const float away[3] = {3.5f, 0.8f, -3.0f};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        for (int jumps = 0; jumps < 2; jumps++) { /* at once, or in eight steps with velocities */
            if (jumps != (int)i && !whole_run()) continue;
            masu_session s;
            masu_session_desc d = temporal_desc("test_shadows", scales[i]);
            find_truth("test_shadows", away, NULL);
            open_session(&s, &d);
            frames(&s, 40, (masu_frame_desc){MASU_FRAME_DESC}, b.rgba);
            for (int k = 1; k <= 8 && !jumps; k++) {
                float t = (float)k / 8.0f;
                move_instance(&s, "ball", 0.8f + t * (away[0] - 0.8f), 0.8f,
                              0.6f + t * (away[2] - 0.6f), 1.0f);
                frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC}, NULL);
            }
            move_instance(&s, "ball", away[0], away[1], away[2], 1.0f);
            frames(&s, 8, (masu_frame_desc){MASU_FRAME_DESC}, a.rgba);
            uint32_t all, off = ghosts(b.rgba, a.rgba, 2, &all);
            print_message("  scale %.2f, %s: %u of %u pixels are more than 2 of 255 off\n",
                          (double)scales[i], jumps ? "a jump" : "a path", off, all);
            assert_true(
                all > 100 &&
                off <= (i ? all / 100 : 0)); /* at half size a shadow edge is three pixels wide */
            close_session(&s);
        }
    }
}

/* Smoke has no velocities: eight frames after a puff has moved away from a static background.
 * `truth` is the image of the puff after a long time at its final position. */
static void smoke_leaves_no_trail(void **state) {
    (void)state;
    for (uint32_t half = !whole_run(); half < 2; half++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_shadows", half ? 0.5f : 1.0f);
        last.scene = NULL;
        d.desc.reserve.particles = 1;
        open_session(&s, &d);
        masu_particle puff = {.position = {-0.5, 1.2, 2.0},
                              .half_width = 0.5f,
                              .opacity = 0.7f,
                              .edge = 0.5f,
                              .color = {0.3f, 0.6f, 0.9f}};
        masu_frame_desc f = {MASU_FRAME_DESC, .particles = &puff, .particle_count = 1};
        frames(&s, 40, f, b.rgba);
        for (int k = 1; k <= 20; k++) {
            puff.position[0] = -0.5 + 0.05 * k;
            frames(&s, 1, f, NULL);
        }
        frames(&s, 8, f, a.rgba);
        frames(&s, trials(120, 60, 60), f, truth.rgba);
        uint32_t all, off = ghosts(b.rgba, a.rgba, 2, &all);
        print_message("  scale %.1f: %u of %u pixels are more than 2 of 255 off\n",
                      half ? 0.5 : 1.0, off, all);
        assert_true(all > 100 && off <= (half ? all / 50 : 0));
        close_session(&s);
    }
}

/* The camera passes a pole: the sky behind it is static in the image, but was occluded before. */
static void sky_that_is_uncovered_shows_no_pole(void **state) {
    (void)state;
    const double metres = 0.08;
    for (uint32_t half = !whole_run(); half < 2; half++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_shadows", half ? 0.5f : 1.0f);
        open_session(&s, &d);
        masu_camera camera = {.position = {0, 1, 0}, .forward = {0, 0.2f, -1}, .fov_y = 0.8f};
        move_instance(&s, "ball", 0.0f, 1.0f, -3.0f, 0.3f);
        for (int k = 0; k <= 12; k++) {
            camera.position[0] = k * metres;
            frames(&s, k ? 1 : 40, (masu_frame_desc){MASU_FRAME_DESC, .camera = &camera},
                   k ? a.rgba : b.rgba);
        }
        frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .cut = 1}, NULL);
        frames(&s, trials(150, 75, 75), (masu_frame_desc){MASU_FRAME_DESC, .camera = &camera},
               truth.rgba);
        last.scene = NULL;
        uint32_t all, off = ghosts(b.rgba, a.rgba, 2, &all);
        print_message("  scale %.1f: %u of %u pixels are more than 2 of 255 off\n",
                      half ? 0.5 : 1.0, off, all);
        assert_true(all > 1000 && off <= (half ? all / 50 : 2));
        close_session(&s);
    }
}

static void light_that_changes_is_seen(void **state) {
    (void)state;
    masu_session s;
    masu_light light;
    masu_session_desc d = temporal_desc("test_shadows", 0.5f);
    open_session(&s, &d);
    assert_int_equal(masu_light_of(s.m, &light, NULL), MASU_OK);
    frames(&s, 40, (masu_frame_desc){MASU_FRAME_DESC}, b.rgba);
    for (int k = 0; k < 3; k++) light.sun_color[k] *= 0.6f;
    light.sun_direction[0] = -light.sun_direction[0]; /* shadows move to other positions */
    find_truth("test_shadows", NULL, &light);
    frames(&s, 8, (masu_frame_desc){MASU_FRAME_DESC, .light = &light}, a.rgba);
    uint32_t all, off = ghosts(b.rgba, a.rgba, 2, &all);
    print_message("  %u of %u pixels are more than 2 of 255 off\n", off, all);
    assert_true(all > 1000 && off < all / 100);
    close_session(&s);
}

/* The same for a lamp, which is in no member of the frame: as if it had never been on. */
static void a_lamp_that_goes_out_is_seen(void **state) {
    (void)state;
    masu_session s;
    masu_punctual_light_state lamp;
    masu_session_desc d = temporal_desc("test_live", 0.5f);
    d.desc.rungs[0].specular = MASU_OFF;
    for (int goes = 0; goes < 2; goes++) {
        open_session(&s, &d);
        masu_punctual_light light = masu_punctual_light_find(s.m, "glow");
        assert_int_equal(masu_punctual_light_get(s.m, light, &lamp, NULL), MASU_OK);
        lamp.instance.id = 0; /* the lamp's model is hidden */
        lamp.position[0] = 2, lamp.position[1] = 1.5, lamp.position[2] = -2.5;
        lamp.range = 20;
        assert_int_equal(masu_punctual_light_set(s.m, light, &lamp, NULL), MASU_OK);
        if (goes) frames(&s, 40, (masu_frame_desc){MASU_FRAME_DESC}, b.rgba);
        for (int k = 0; k < 3; k++) lamp.color[k] = 0;
        assert_int_equal(masu_punctual_light_set(s.m, light, &lamp, NULL), MASU_OK);
        frames(&s, goes ? 8 : 48, (masu_frame_desc){MASU_FRAME_DESC}, goes ? a.rgba : truth.rgba);
        close_session(&s);
    }
    uint32_t all, off = ghosts(b.rgba, a.rgba, 6, &all);
    print_message("  %u of %u pixels are more than 6 of 255 off\n", off, all);
    assert_true(all > 100 && off < all / 20);
}

/* The same while the camera moves: moving pixels are clamped to the current colours, from above
 * when the light goes out, from below when it comes on. Otherwise two frames later two thirds of
 * two thirds of the old light would still be visible. */
static void light_that_changes_in_motion_is_seen(void **state) {
    (void)state;
    static const float scales[] = {1.0f, 0.5f};
    for (int rises = 0; rises < 2; rises++) {
        for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
            if (rises != (int)i && !whole_run()) continue;
            masu_session s;
            masu_light bright, dark;
            masu_commands commands;
            masu_session_desc d = temporal_desc("test_shadows", scales[i]);
            open_session(&s, &d);
            assert_int_equal(masu_light_of(s.m, &bright, NULL), MASU_OK);
            dark = bright;
            for (int k = 0; k < 3; k++) dark.sun_color[k] *= 0.3f;
            find_truth("test_shadows", NULL, rises ? &bright : &dark);
            for (int k = 13; k >= 0; k--) {
                masu_camera camera = aside(&s, 0.02 * k);
                masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera,
                                     .light = (k < 2) == rises ? &bright : &dark};
                draw(&s, &f, &commands, k == 2 ? b.rgba : a.rgba);
            }
            uint32_t all, off = ghosts(b.rgba, a.rgba, 6, &all);
            print_message("  scale %.2f, %s: %u of %u pixels are more than 6 of 255 off\n",
                          (double)scales[i], rises ? "on" : "out", off, all);
            assert_true(all > 1000 && off < all / 20);
            close_session(&s);
        }
    }
}

/* Stochastic rounding never exceeds white: red's step above white would be one of green's. */
static void white_is_white_in_every_frame(void **state) {
    (void)state;
    for (int half = 0; half < 2; half++) {
        masu_session s;
        masu_light light;
        masu_session_desc d = temporal_desc("test_shadows", half ? 0.5f : 1.0f);
        open_session(&s, &d);
        assert_int_equal(masu_light_of(s.m, &light, NULL), MASU_OK);
        light.exposure = 1e6f;
        for (uint32_t i = 0; i < 24; i++) {
            masu_commands commands;
            masu_camera camera = aside(&s, i < 12 ? 0.0 : 0.01 * i);
            draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .light = &light, .camera = &camera},
                 &commands, a.rgba);
            for (uint32_t p = 0; p < BYTES; p++) {
                if (a.rgba[p] != 255)
                    fail_msg("frame %u, scale %g: byte %u is %u", i, half ? 0.5 : 1.0, p,
                             a.rgba[p]);
            }
        }
        close_session(&s);
    }
}

/* ---- Conditions without influence ------------------------------------------------------------ */

/* The 2x variant is a separate pass, and an output of fixed size needs no guard at its border: the
 * images equal those of temporal.comp at a scale with the same render size, in motion, static, and
 * with a host's jitter. */
static void twice_the_size_is_the_same(void **state) {
    (void)state;
    static const struct {
        float scale;
        uint32_t resizable, halves;
    } ways[] = {{0.501f, 0, 0}, {0.501f, 1, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {0.5f, 0, 1}};
    enum { WAYS = sizeof ways / sizeof *ways };
    static uint8_t pixels[WAYS][3][BYTES];
    for (uint32_t k = 0; k < WAYS; k++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_shadows", ways[k].scale);
        d.desc.resizable = ways[k].resizable;
        d.desc.deny.unorm16 = ways[k].halves;
        open_session(&s, &d);
        masu_commands commands;
        for (uint32_t i = 0; i < 36; i++) {
            masu_camera camera = aside(&s, 0.02 * (i < 12 ? i : 12));
            camera.jitter[0] = i < 24 ? 0.0f : 0.05f * (float)(i - 16); /* up to a whole pixel */
            camera.jitter[1] = -0.7f * camera.jitter[0];
            draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .camera = &camera}, &commands,
                 pixels[k][i / 12]);
        }
        close_session(&s);
    }
    for (uint32_t k = 1; k < WAYS; k++) {
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t most = max_difference(pixels[k][i], pixels[0][i], BYTES), others = 0, twos = 0;
            for (uint32_t p = 0; p < BYTES; p++) {
                others += pixels[k][i][p] != pixels[0][i][p];
                twos += abs(pixels[k][i][p] - pixels[0][i][p]) > 1;
            }
            print_message(
                "  scale %.3f, resizable %u, halves %u: %u of %d bytes differ, by %u at most\n",
                (double)ways[k].scale, ways[k].resizable, ways[k].halves, others, BYTES, most);
            /* Half floats are coarser: up to a tenth of an output step. While the view moves, the
             * history of a thin surface that the samples miss is kept if it differs by more than a
             * threshold, and a texel or two are at the threshold with half floats or another
             * size. */
            const bool same = ways[k].scale == ways[0].scale && !ways[k].halves;
            assert_true(most <= (i ? 1u : same ? 2u : 8u) && twos <= (i ? 0u : same ? 1u : 48u));
            assert_true(others < (ways[k].halves ? BYTES / 5 : BYTES / 50));
        }
    }
}

/* Images have the size of the largest rung that uses them: with only an SDF, velocity is smaller
 * than depth if only a smaller rung has temporal upscaling. */
static void depth_is_found_in_a_larger_image(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_sphere_sdf", 0.5f);
        d.desc.debug.poison = 1;
        d.desc.rungs[0].specular = MASU_OFF;
        if (k) {
            d.desc.rung_count = 2;
            d.desc.rungs[1] = d.desc.rungs[0];
            d.desc.rungs[0] = (masu_rung){.scale = 1.0f, .specular = MASU_OFF};
        }
        open_session(&s, &d);
        masu_commands commands;
        for (int i = 0; i < 16; i++) {
            masu_camera camera = aside(&s, 0.03 * i);
            draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .rung = (uint32_t)k},
                 &commands, k ? b.rgba : a.rgba);
        }
        close_session(&s);
    }
    uint32_t most = max_difference(a.rgba, b.rgba, BYTES);
    print_message("  next to a larger rung a byte has an error of %u at most\n", most);
    assert_true(most <= 1);
}

static void equal_frames_give_equal_bytes(void **state) {
    (void)state;
    static const uint32_t poison[] = {0, 1, 3};
    for (int k = 0; k < 3; k++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_fog", 1.0f);
        d.desc.debug.poison = poison[k]; /* including the images' content before they are
                                            written, */
        d.desc.rung_count = 5;           /* or outside the part that a rung uses */
        d.desc.rungs[1] = (masu_rung){.temporal = MASU_ON, .scale = 0.33f, .sharpen = MASU_ON};
        d.desc.rungs[2] = (masu_rung){.scale = 0.6f, .aa = MASU_AA_SMAA_LOW};
        d.desc.rungs[3] = (masu_rung){.temporal = MASU_ON, .scale = 0.02f};
        d.desc.rungs[4] = (masu_rung){.temporal = MASU_ON, .scale = 0.5f};
        open_session(&s, &d);
        masu_commands commands;
        for (int i = 0; i < 16; i++) {
            masu_camera camera = aside(&s, 0.1 * i);
            camera.position[1] += 0.1 * (i / 4);
            draw(&s,
                 &(masu_frame_desc){MASU_FRAME_DESC, .camera = &camera,
                                    .rung = (uint32_t)("0011230443130141"[i] - '0')},
                 &commands, k ? b.rgba : a.rgba);
        }
        close_session(&s);
        if (k) assert_memory_equal(a.rgba, b.rgba, BYTES);
    }
}

static void a_cut_forgets_all(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_shadows", 0.5f);
        open_session(&s, &d);
        masu_camera elsewhere = aside(&s, k ? 3.0 : -2.0);
        masu_light light;
        assert_int_equal(masu_light_of(s.m, &light, NULL), MASU_OK);
        frames(&s, 9, (masu_frame_desc){MASU_FRAME_DESC, .camera = &elsewhere}, NULL);
        /* earlier changes have no influence, as earlier images do not */
        light.sun_color[0] *= k ? 0.5f : 1.0f;
        move_instance(&s, "ball", k ? 2.0f : 0.8f, 0.8f, 0.6f, 1.0f);
        frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC, .camera = &elsewhere, .light = &light},
               NULL);
        move_instance(&s, "ball", 0.8f, 0.8f, 0.6f, 1.0f);
        frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC, .cut = 1}, NULL);
        frames(&s, 3, (masu_frame_desc){MASU_FRAME_DESC}, k ? b.rgba : a.rgba);
        close_session(&s);
    }
    assert_memory_equal(a.rgba, b.rgba, BYTES);
}

/* The first frame at another scale continues the history. */
static void a_change_of_scale_keeps_the_past(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = temporal_desc("test_shadows", 1.0f);
    d.desc.rung_count = 2;
    d.desc.rungs[1] = (masu_rung){.temporal = MASU_ON, .scale = 0.5f};
    find_truth("test_shadows", NULL, NULL);
    open_session(&s, &d);
    frames(&s, 40, (masu_frame_desc){MASU_FRAME_DESC}, b.rgba);
    frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC, .rung = 1}, a.rgba);
    double before = rms(b.rgba, truth.rgba), after = rms(a.rgba, truth.rgba),
           pop = rms(a.rgba, b.rgba);
    frames(&s, 1, (masu_frame_desc){MASU_FRAME_DESC, .rung = 1, .cut = 1}, b.rgba);
    double anew = rms(b.rgba, truth.rgba);
    print_message("  rms %.2f of 255 before, %.2f in the frame after, which differs by %.2f; "
                  "after a cut %.2f\n",
                  before, after, pop, anew);
    assert_true(after < 0.35 * anew && pop < 1.5);
    close_session(&s);
}

/* Arbitrary changes: of rungs, jumps, walls, time steps; every pixel is opaque, and no stored value
 * was replaced. */
static void nothing_breaks_it(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_shadows", "test_both", "test_pane", "wet_city"};
    for (size_t k = 0; k < trials(4, 3, 3); k++) { /* wet_city takes ten seconds to compile */
        masu_session s;
        masu_session_desc d = temporal_desc(scenes[k], 1.0f);
        d.desc.rung_count = 5;
        d.desc.rungs[1] = (masu_rung){.temporal = MASU_ON, .scale = 0.33f, .sharpen = MASU_ON};
        d.desc.rungs[2] = (masu_rung){.scale = 0.6f};
        d.desc.rungs[3] = (masu_rung){.temporal = MASU_ON, .scale = 0.01f};
        d.desc.rungs[4] = (masu_rung){.temporal = MASU_ON, .scale = 0.5f};
        open_session(&s, &d);
        /* in 8 frames every change has occurred once */
        for (uint32_t i = 0; i < trials(24, 24, 12); i++) {
            masu_camera camera = aside(&s, i % 6 == 4 ? 1e6 : 0.3 * (i % 7));
            if (i % 3 == 2) camera.position[1] = -0.5;
            if (i % 8 == 7) camera.forward[0] = 5.0f;
            camera.jitter[0] = i % 2 ? 1.0f : -1.0f;
            masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .rung = i % 5,
                                 .time = i % 6 == 5 ? 1e9 : 10.0 * i,
                                 .time_step = i % 2 ? 10.0f : 0.0f};
            masu_commands commands;
            draw(&s, &f, &commands, a.rgba);
            for (uint32_t p = 0; p < PIXELS; p++) assert_int_equal(a.rgba[4 * p + 3], 255);
            assert_int_equal(stats_of(&s, commands.slot).replaced, 0);
        }
        close_session(&s);
    }
}

/* Targets beyond 8 bits and beyond white have the same image as 8-bit targets. */
static void all_targets_are_served(void **state) {
    (void)state;
    static const struct {
        VkFormat format;
        masu_encoding encoding;
    } cases[] = {{VK_FORMAT_A2B10G10R10_UNORM_PACK32, MASU_ENCODING_PQ},
                 {VK_FORMAT_R16G16B16A16_SFLOAT, MASU_ENCODING_LINEAR},
                 {VK_FORMAT_B8G8R8A8_SRGB, MASU_ENCODING_SRGB},
                 {VK_FORMAT_R5G6B5_UNORM_PACK16, MASU_ENCODING_SRGB}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_session s;
        masu_session_desc d = temporal_desc("test_shadows", 0.5f);
        d.desc.targets.format = cases[i].format;
        d.desc.targets.encoding = cases[i].encoding;
        d.desc.targets.storage = 0;
        open_session(&s, &d);
        frames(&s, 3, (masu_frame_desc){MASU_FRAME_DESC}, NULL);
        close_session(&s);
    }
}

/* Difference of surface colours from pixel to pixel, in the last frame of a camera path that ends
 * at the scene's camera, with a motion of `metres` per frame. */
static double roughness_of(float scale, double metres, uint8_t *albedo) {
    masu_session s;
    masu_session_desc d = temporal_desc("test_texture_floor", scale);
    masu_commands commands;
    d.desc.readback = MASU_READBACK_ALBEDO;
    open_session(&s, &d);
    for (int k = 3; k >= 0; k--) {
        masu_camera camera = aside(&s, k * metres);
        draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .camera = &camera}, &commands, NULL);
    }
    uint32_t size = (uint32_t)(SIZE * scale);
    const uint8_t *image = read_image(&s, commands.slot, MASU_READBACK_ALBEDO);
    double sum = 0.0;
    for (uint32_t i = 0; i + 4 < 4 * size * size; i++)
        sum += i % 4 < 3 ? abs((int)image[i + 4] - image[i]) : 0;
    memcpy(albedo, image, 4 * (size_t)size * size);
    close_session(&s);
    return sum;
}

/* Below full size, moving surfaces are rendered with coarser mips than static ones, because they
 * have few samples. */
static void what_moves_has_coarser_mips(void **state) {
    (void)state;
    double rests = roughness_of(0.5f, 0.0, a.rgba), moves = roughness_of(0.5f, 3.0, b.rgba);
    print_message("  differences of neighbours: moving %.3f of static\n", moves / rests);
    assert_true(moves < 0.9 * rests && moves > 0.1 * rests);
    (void)roughness_of(1.0f, 0.0, a.rgba);
    (void)roughness_of(1.0f, 3.0, b.rgba);
    assert_memory_equal(a.rgba, b.rgba, BYTES);
}

/* Velocity of the centre pixel, which shows the reflection of a wall two metres in front of a
 * mirror, which is a metre away. The camera moves parallel to both, to the right and up. Rung 1 has
 * no temporal upscaling. */
static void velocity_in_mirror(masu_switch fine, uint32_t rung, double metres, double v[2]) {
    masu_session s;
    masu_session_desc d = temporal_desc("test_mirror_plain", 1.0f);
    masu_commands commands;
    d.desc.rungs[0].specular_fine = fine;
    d.desc.rung_count = 2;
    d.desc.rungs[1] = (masu_rung){.scale = 1};
    d.desc.readback = MASU_READBACK_VELOCITY;
    open_session(&s, &d);
    for (int k = 5; k >= 0; k--) {
        masu_camera camera = aside(&s, k * metres);
        camera.position[1] -= 0.5 * k * metres;
        draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .rung = rung}, &commands,
             NULL);
    }
    const uint16_t *image = read_image(&s, commands.slot, MASU_READBACK_VELOCITY);
    for (int k = 0; k < 2; k++) v[k] = half_float(image[4 * (SIZE / 2 * SIZE + SIZE / 2) + k]);
    close_session(&s);
}

/* The reflected image is behind the mirror, three metres from the camera, and moves a third as fast
 * as the mirror's surface. */
static void what_a_mirror_shows_is_found_where_it_was(void **state) {
    (void)state;
    const double metres = 0.05, pixels = metres * 0.5 * SIZE / tan(20.0 * acos(-1.0) / 180.0);
    double surface[2], image[2], plain[2];
    velocity_in_mirror(MASU_OFF, 0, metres, surface);
    velocity_in_mirror(MASU_ON, 0, metres, image);
    velocity_in_mirror(MASU_ON, 1, metres, plain);
    for (int k = 0; k < 2; k++) {
        /* previous minus current position of the pixel */
        const double moved = k ? -0.5 * pixels : -pixels;
        print_message("  %c: without history %.3f of %.3f pixels, surface %.3f, reflection %.3f\n",
                      "xy"[k], plain[k], moved, surface[k], image[k]);
        assert_true(fabs(plain[k] - moved) < 0.02);
        assert_true(fabs(surface[k] - moved) < 1.0); /* the change of the jitter is in both */
        assert_true(fabs(surface[k] - image[k] - moved * 2.0 / 3.0) < 0.05);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_left_out_without_a_cut_shows_no_old_memory),
        cmocka_unit_test(at_rest_it_comes_near_the_truth),
        cmocka_unit_test(in_motion_it_is_no_worse),
        cmocka_unit_test(a_thin_rod_in_motion_keeps_its_light),
        cmocka_unit_test(a_change_of_scale_keeps_the_past), /* with the same ground truth */
        cmocka_unit_test(what_leaves_leaves_no_ghost),
        cmocka_unit_test(smoke_leaves_no_trail),
        cmocka_unit_test(sky_that_is_uncovered_shows_no_pole),
        cmocka_unit_test(light_that_changes_is_seen),
        cmocka_unit_test(a_lamp_that_goes_out_is_seen),
        cmocka_unit_test(light_that_changes_in_motion_is_seen),
        cmocka_unit_test(white_is_white_in_every_frame),
        cmocka_unit_test(twice_the_size_is_the_same),
        cmocka_unit_test(depth_is_found_in_a_larger_image),
        cmocka_unit_test(equal_frames_give_equal_bytes),
        cmocka_unit_test(a_cut_forgets_all),
        cmocka_unit_test(nothing_breaks_it),
        cmocka_unit_test(all_targets_are_served),
        cmocka_unit_test(what_moves_has_coarser_mips),
        cmocka_unit_test(what_a_mirror_shows_is_found_where_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
