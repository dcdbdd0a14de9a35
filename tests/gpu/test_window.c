/* test_window.c: off-centre projections. Four quarters of a window, rendered separately, equal the
 * quarters of the whole image: colour, depth and velocity. */
#include "support/support.h"
#include "support/floats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Quarters are multiples of tiles, cones and the noise pattern of reflections. */
enum { W = 192, H = 192, HALF_W = W / 2, HALF_H = H / 2 };

typedef struct picture {
    uint8_t color[W * H * 4];
    float depth[W * H];
    uint16_t velocity[W * H * 4];
} picture;

static picture whole, quarters;

/* Content that the host adds to each frame if `added` is set: near the centre, at the common corner
 * of the quarters. */
static int added;
static const masu_particle particles[] = {
    {.position = {0.3, 0.2, 1.2}, .half_width = 0.4f, .color = {3, 1, 0.2f}, .opacity = 0.7f},
    {.position = {-0.5, -0.2, 0.9},
     .half_width = 0.3f,
     .color = {0.1f, 0.6f, 2},
     .opacity = 0.8f,
     .edge = 0.5f}};
static const masu_decal decals[] = {{.rows = {1.1f, 0, 0, 0, 0, 1.1f, 0, 0, 0, 0, 1.5f, 0},
                                     .color = {0.9f, 0.1f, 0.1f},
                                     .opacity = 0.9f,
                                     .roughness = 0.5f}};
static const masu_line lines[] = {{.from = {-1.5, -0.6, 0.6},
                                   .to = {1.4, 0.9, 0.5},
                                   .from_color = {255, 255, 0, 0},
                                   .to_color = {255, 255, 0, 0},
                                   .flags = MASU_LINE_ON_TOP}};

static void open_at(masu_session *s, const char *scene, uint32_t width, uint32_t height) {
    masu_session_desc d = test_desc(scene, width, height);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    /* Off: effects in screen space, whose radius would differ, and filters over neighbours, which
     * differ at the edge of a quarter. */
    d.desc.rungs[0] = (masu_rung){.scale = 1, .ao = MASU_OFF, .specular_filter = MASU_OFF,
                                  .specular_reuse = MASU_OFF, .specular_temporal = MASU_OFF};
    if (added) d.desc.reserve.particles = 2, d.desc.reserve.decals = 1, d.desc.reserve.lines = 1;
    open_session(s, &d);
}

/* Two frames, so that there are velocities: the camera and the window move. */
static void draw_two(masu_session *s, const masu_camera *camera, const float window[4],
                     picture *out, uint32_t at_x, uint32_t at_y, uint32_t width, uint32_t height) {
    static uint8_t pixels[W * H * 4];
    masu_commands commands;
    for (int i = 0; i < 2; i++) {
        masu_camera c = *camera;
        c.position[0] += 0.02 * i;
        float scale = i ? 1.0f : 1.0625f;
        c.left = window[0] * scale, c.right = window[1] * scale;
        c.bottom = window[2] * scale, c.top = window[3] * scale;
        masu_frame_desc frame = {.camera = &c, .cut = !i, .time = 1};
        if (added) {
            frame.particles = particles, frame.particle_count = 2;
            frame.decals = decals, frame.decal_count = 1;
            frame.lines = lines, frame.line_count = 1;
        }
        draw(s, &frame, &commands, pixels);
    }
    const float *depth = read_image(s, commands.slot, MASU_READBACK_DEPTH);
    const uint16_t *velocity = read_image(s, commands.slot, MASU_READBACK_VELOCITY);
    for (uint32_t y = 0; y < height; y++) {
        size_t from = (size_t)y * width, to = (size_t)(y + at_y) * W + at_x;
        memcpy(out->color + 4 * to, pixels + 4 * from, width * 4);
        memcpy(out->depth + to, depth + from, width * sizeof *depth);
        memcpy(out->velocity + 4 * to, velocity + 4 * from, width * 8);
    }
}

typedef struct differences {
    uint32_t color, depth, velocity; /* pixels that differ by more than rounding */
    uint32_t surfaces, moved;
    uint32_t worst; /* byte */
} differences;

/* seam: pixels near the edges of quarters whose colour depends on neighbours in another one. */
static differences compare(int seam) {
    differences d = {0, 0, 0, 0, 0, 0};
    for (uint32_t i = 0; i < W * H; i++) {
        int beside = abs((int)(i % W) - HALF_W) <= seam || abs((int)(i / W) - HALF_H) <= seam;
        uint32_t most = max_difference(whole.color + 4 * i, quarters.color + 4 * i, 4);
        if (seam && beside) most = 0;
        d.worst = most > d.worst ? most : d.worst;
        d.color += most > 2;
        double a = (double)whole.depth[i], b = (double)quarters.depth[i];
        d.surfaces += a > 0;
        d.depth += !(fabs(a - b) <= 1e-3 * fmax(a, b));
        int off = 0;
        for (uint32_t k = 0; k < 3; k++) {
            double x = half_float(whole.velocity[4 * i + k]),
                   y = half_float(quarters.velocity[4 * i + k]);
            off |= !(fabs(x - y) <= 0.01 + 2e-3 * fabs(x));
            d.moved += k == 0 && fabs(x) > 0.1;
        }
        d.velocity += off;
    }
    return d;
}

static void quarters_of(const char *scene, masu_camera camera, double budget, int seam) {
    float window[4] = {-0.5f, 0.5f, -0.5f, 0.5f};
    masu_session s;
    open_at(&s, scene, W, H);
    draw_two(&s, &camera, window, &whole, 0, 0, W, H);
    close_session(&s);
    for (uint32_t q = 0; q < 4; q++) { /* each from frame 0: rays depend on its number */
        open_at(&s, scene, HALF_W, HALF_H);
        uint32_t x = q & 1, y = q >> 1;
        float part[4] = {x ? 0 : -0.5f, x ? 0.5f : 0, y ? -0.5f : 0, y ? 0 : 0.5f};
        draw_two(&s, &camera, part, &quarters, x * HALF_W, y * HALF_H, HALF_W, HALF_H);
        close_session(&s);
    }
    differences d = compare(seam);
    print_message("  %s: of %d pixels %u of colour, %u of depth, %u of velocity differ, worst %u; "
                  "%u surfaces\n",
                  scene, W * H, d.color, d.depth, d.velocity, d.worst, d.surfaces);
    assert_in_range(d.surfaces, W * H / 8, W * H);
    assert_in_range(d.moved, W * H / 2, W * H);
    uint32_t most = (uint32_t)(budget * W * H);
    if (d.color > most || d.depth > most || d.velocity > most)
        fail_msg("%s: more than %u pixels differ", scene, most);
}

/* Edges that pass within rounding of a pixel's centre may fall on either side. */
#define EDGES 0.002

static const masu_camera before_it = {
    .position = {1.2, 0.9, 3.2}, .forward = {-1.2f, -0.9f, -3.2f}, .near_distance = 0.1f};

static void quarters_make_the_whole_of_polygons_and_sdf(void **state) {
    (void)state;
    quarters_of("test_both", before_it, EDGES, 0);
}

static void quarters_make_the_whole_with_cascades(void **state) {
    (void)state;
    quarters_of("test_shadows",
                (masu_camera){.position = {3.2, 2.6, 5.2},
                              .forward = {-3.2f, -2.0f, -5.6f},
                              .near_distance = 0.1f},
                EDGES, 0);
}

static void quarters_make_the_whole_with_punctual_lights(void **state) {
    (void)state;
    quarters_of(
        "night",
        (masu_camera){.position = {6, 3, 9}, .forward = {-6, -2.5f, -9}, .near_distance = 0.1f},
        EDGES, 0);
}

static void quarters_make_the_whole_with_reflections(void **state) {
    (void)state;
    quarters_of(
        "test_reflections",
        (masu_camera){.position = {0, 3, 5}, .forward = {0, -3, -3}, .near_distance = 0.05f}, EDGES,
        2);
}

static void quarters_make_the_whole_of_a_moving_sdf(void **state) {
    (void)state;
    quarters_of("test_velocity",
                (masu_camera){.position = {0.6, 1.2, 4.5},
                              .forward = {-0.6f, -1, -4.5f},
                              .near_distance = 0.1f},
                EDGES, 0);
}

static void quarters_make_the_whole_of_blended_things_and_an_analytic_sky(void **state) {
    (void)state;
    quarters_of(
        "glass",
        (masu_camera){.position = {0, 2, 7}, .forward = {0, -0.2f, -1}, .near_distance = 0.1f},
        EDGES, 0);
}

/* They are also visible: the image without them differs. */
static void quarters_make_the_whole_with_what_the_host_adds(void **state) {
    (void)state;
    static uint8_t without[sizeof whole.color];
    quarters_of("test_both", before_it, EDGES, 0);
    memcpy(without, whole.color, sizeof without);
    added = 1;
    quarters_of("test_both", before_it, EDGES, 0);
    added = 0;
    uint32_t changed = 0;
    for (uint32_t i = 0; i < W * H; i++)
        changed += max_difference(without + 4 * i, whole.color + 4 * i, 4) > 8;
    assert_in_range(changed, W * H / 16, W * H);
}

/* A portal's window far to the side, narrow and high, equals that part of a wide image. */
static void a_window_far_to_the_side_is_part_of_a_wide_picture(void **state) {
    (void)state;
    enum { PART_W = 18, PART_H = 66 };
    masu_session s;
    masu_camera c = before_it;
    open_at(&s, "test_both", W, H);
    draw_two(&s, &c, (float[4]){-4, 4, -4, 4}, &whole, 0, 0, W, H);
    close_session(&s);
    memset(&quarters, 0, sizeof quarters);
    open_at(&s, "test_both", PART_W, PART_H);
    uint32_t x = 88, y = 64; /* the window's first pixel */
    float l = -4 + 8.0f * (float)x / W, t = 4 - 8.0f * (float)y / H;
    draw_two(&s, &c, (float[4]){l, l + 8.0f * PART_W / W, t - 8.0f * PART_H / H, t}, &quarters, x,
             y, PART_W, PART_H);
    close_session(&s);
    uint32_t off = 0, seen = 0;
    for (uint32_t i = x; i < x + PART_W; i++) {
        for (uint32_t j = y; j < y + PART_H; j++) {
            uint32_t at = j * W + i;
            off += max_difference(whole.color + 4 * at, quarters.color + 4 * at, 4) > 2;
            seen += whole.depth[at] > 0;
        }
    }
    if (off > 8 || seen < 16) fail_msg("%u pixels differ, %u are of surfaces", off, seen);
}

/* With temporal upscaling: static surfaces under a moving window are not blurred, and later only
 * the jitter moves. */
static void history_follows_a_window_that_moves(void **state) {
    (void)state;
    static uint8_t last[W * H * 4], fresh[W * H * 4];
    masu_commands commands;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1, .temporal = MASU_ON};
    masu_session s;
    open_session(&s, &d);
    masu_camera c = before_it;
    for (uint32_t i = 0; i < 48; i++) {
        float off = i < 24 ? 0.004f * (float)i : 0.096f; /* moves, then stationary */
        c.left = -0.5f + off, c.right = 0.5f + off, c.bottom = -0.5f - off, c.top = 0.5f - off;
        draw(&s, &(masu_frame_desc){.camera = &c, .cut = !i}, &commands, i == 24 ? fresh : last);
    }
    double moving = 0;
    for (uint32_t i = 0; i < W * H * 4; i++) moving += abs(fresh[i] - last[i]);
    moving /= W * H * 4;
    print_message("  mean difference of a moving window from a stationary one: %.3f of 255\n",
                  moving);
    assert_true(moving < 0.5);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quarters_make_the_whole_of_polygons_and_sdf),
        cmocka_unit_test(quarters_make_the_whole_with_what_the_host_adds),
        cmocka_unit_test(quarters_make_the_whole_with_cascades),
        cmocka_unit_test(quarters_make_the_whole_with_punctual_lights),
        cmocka_unit_test(quarters_make_the_whole_with_reflections),
        cmocka_unit_test(quarters_make_the_whole_of_a_moving_sdf),
        cmocka_unit_test(quarters_make_the_whole_of_blended_things_and_an_analytic_sky),
        cmocka_unit_test(a_window_far_to_the_side_is_part_of_a_wide_picture),
        cmocka_unit_test(history_follows_a_window_that_moves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
