/* test_small_lamps.c: a small bright ball above a rough mirror. Its light reaches the mirror as an
 * area light and by reflection rays that hit the ball: together they are as bright as an area light
 * without a ball, they are stable in a static view, and an emissive part that is no light is left
 * to the rays. */
#include "support/files.h"
#include "support/floats.h"
#include "support/shadow.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 66, FRAMES = 48, KEPT = 16 };

typedef struct glow {
    double light;     /* mean radiance of the mirror */
    double deviation; /* largest deviation of a pixel over the last frames, in steps of 1/255 of
                         display light */
    uint32_t lights;
} glow;

/* lamp: the description of the ball, or a light instead. */
static glow glow_of(const char *models, const char *lights) {
    static double sum[WIDTH * HEIGHT], square[WIDTH * HEIGHT];
    char json[2048];
    glow g = {0};
    snprintf(json, sizeof json,
             "{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 12, \"size_z\": 12}}, "
             "\"material\": {\"base_color\": "
             "[0.9, 0.9, 0.9], \"metallic\": 1, \"roughness\": 0.3}}%s], \"lights\": [%s], "
             "\"reflections\": {}, "
             "\"ambient\": [0, 0, 0], \"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]}, "
             "\"sun\": "
             "{\"intensity\": 0}}",
             models, lights);
    bake_scene("lamp", json);
    masu_session s;
    masu_session_desc d = test_desc(NULL, WIDTH, HEIGHT);
    d.scene_path = baked_scene("lamp");
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.frames_in_flight = 1;
    open_session(&s, &d);
    masu_camera camera = {
        .position = {0, 1.5, 6}, .forward = {0, -0.3f, -1}, .fov_y = 0.5f, .near_distance = 0.05f};
    memset(sum, 0, sizeof sum);
    memset(square, 0, sizeof square);
    for (int i = 0; i < FRAMES; i++) {
        masu_frame_desc frame = {.camera = &camera};
        masu_commands commands;
        draw(&s, &frame, &commands, NULL);
        g.lights = stats_of(&s, commands.slot).lights;
        const uint16_t *hdr = read_image(&s, commands.slot, MASU_READBACK_HDR);
        for (int k = 0; k < WIDTH * HEIGHT && i >= FRAMES - KEPT; k++) {
            double light = half_float(hdr[4 * k]);
            if (k / WIDTH < HEIGHT / 2) continue; /* the ball itself */
            g.light += light / (KEPT * WIDTH * HEIGHT / 2);
            double shown = 255 * pow(fmin(light, 1), 1 / 2.2);
            sum[k] += shown / KEPT;
            square[k] += shown * shown / KEPT;
        }
    }
    for (int k = 0; k < WIDTH * HEIGHT; k++)
        g.deviation = worst_of(g.deviation, sqrt(fmax(square[k] - sum[k] * sum[k], 0)));
    close_session(&s);
    return g;
}

static void rays_and_lobe_share_the_light(void **state) {
    (void)state;
    const char *ball = ", {\"mesh\": {\"sphere\": {\"radius\": 0.05, \"subdivisions\": 3}}, "
                       "\"translate\": [0, 1, 0], "
                       "\"traced\": true, \"material\": {\"base_color\": [0, 0, 0], \"emissive\": "
                       "[16, 14, 10]}%s}";
    char with[512], without[512];
    snprintf(with, sizeof with, ball, "");
    snprintf(without, sizeof without, ball, ", \"area_light\": false");
    glow alone = glow_of("", "{\"type\": \"sphere\", \"position\": [0, 1, 0], \"radius\": 0.05, "
                             "\"color\": [16, 14, 10], "
                             "\"range\": 100}");
    glow shared = glow_of(with, ""), rays = glow_of(without, "");
    print_message("  light %.4g as a light, %.4g shared, %.4g by rays; deviation %.2f, %.2f, %.2f "
                  "of 255\n",
                  alone.light, shared.light, rays.light, alone.deviation, shared.deviation,
                  rays.deviation);
    assert_int_equal(shared.lights, 1);
    assert_int_equal(rays.lights, 0);
    assert_true(alone.light > 1e-3);
    assert_true(fabs(shared.light / alone.light - 1) < 0.05);
    assert_true(shared.deviation < 1);
    assert_true(rays.deviation > 4 * shared.deviation); /* otherwise there is nothing to share */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_and_lobe_share_the_light),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
