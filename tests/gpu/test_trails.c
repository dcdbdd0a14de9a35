/* test_trails.c: trails against their formula: colour, opacity and texture along the length, edges that
 * segments share, and the order of trails and particles. */
#define LIVE_SCENE "test_texture_quad"
#include "support/live_room.h"

/* View coordinates of a pixel's centre in the plane z metres before the camera. */
static void at_pixel(uint32_t i, double z, double out[2]) {
    out[0] = ((i % SIDE + 0.5) / SIDE * 2 - 1) * tan_y * z;
    out[1] = (1 - (i / SIDE + 0.5) / SIDE * 2) * tan_y * z;
}

/* Straight, in the plane z = 1: colour, opacity and width change linearly, the texture repeats. */
static void a_trail_is_shaded_along_its_length(void **state) {
    (void)state;
    masu_trail_point p[3];
    for (uint32_t i = 0; i < 3; i++)
        p[i] = (masu_trail_point){
            .position = {-0.6 + 0.6 * i, 0, 1}, /* level with the camera: sides are upright */
            .half_width = 0.2f,
            .color = {1, (float)i, 0.5f},
            .opacity = 0.25f + 0.25f * (float)i};
    static const float whole[4] = {0, 0, 1, 1};
    open_room(TEXELS);
    fill(1, TEXELS, 8, 200, 6);
    write_whole(1);
    for (uint32_t form = 0; form < 3; form++) {
        masu_trail t = {.points = p, .point_count = 3, .edge = 1};
        if (form) t.texture = 1;
        if (form == 2) t.repeat = 0.5f, t.offset = 0.2f;
        render((masu_frame_desc){0}, base);
        masu_stats_info stats = render((masu_frame_desc){.trails = &t, .trail_count = 1}, picture);
        assert_int_equal(stats.trail_segments, 2);
        assert_int_equal(stats.particles, 0);
        double worst = 0;
        uint32_t count = 0;
        for (uint32_t i = 0; i < PIXELS; i++) {
            double at[2], texel[4] = {1, 1, 1, 1}, o, pixel = 2 * tan_y * 2 / SIDE;
            at_pixel(i, 2, at);
            double x = (at[0] + 0.6) / 1.2, v = 0.5 - at[1] / 0.4;
            if (x < 0 || x > 1 || v < 0 || v > 1) {
                if ((x < -pixel || x > 1 + pixel || v < -4 * pixel || v > 1 + 4 * pixel) &&
                    memcmp(&picture[4 * i], &base[4 * i], 12))
                    fail_msg("pixel %u is beside the trail", i);
                continue;
            }
            if (form) {
                double u = form == 2 ? (0.2 + 1.2 * x) / 0.5 : x;
                memset(texel, 0, sizeof texel);
                u -= floor(u);
                if (u < 0.08 || u > 0.92) continue; /* the seam is in the pixel */
                sample(1, TEXELS, whole, u, v, texel);
            }
            if (x < 0.01 || x > 0.99) continue; /* the end is in the pixel */
            o = 0.25 + 0.5 * x;
            for (uint32_t k = 0; k < 3; k++) {
                double color = k == 0 ? 1 : k == 1 ? 2 * x : 0.5;
                double want = color * texel[k] * o + (1 - texel[3] * o) * (double)base[4 * i + k];
                double off = fabs(want - (double)picture[4 * i + k]);
                worst = fmax(worst, off);
            }
            count++;
        }
        print_message("form %u: %u pixels, off by %.4f at most\n", form, count, worst);
        assert_true(count > 500 && worst < 0.03);
    }
    close_session(&s);
}

/* Around a corner, at any bend of up to 90 degrees: no pixel is covered twice, and none is missed
 * between segments. */
static void segments_of_a_trail_share_their_edges(void **state) {
    (void)state;
    open_room(TEXELS);
    memset(texels[0], 255, sizeof texels[0]);
    write_whole(1);
    render((masu_frame_desc){0}, base);
    for (uint32_t form = 0; form < 4; form++) {
        masu_trail_point p[POINTS];
        for (uint32_t i = 0; i < POINTS; i++) {
            double turn = (form + 1) * 0.1 * (double)i;
            p[i] =
                (masu_trail_point){.position = {0.45 * cos(turn), 0.45 * sin(turn), 1 + 0.02 * i},
                                   .half_width = 0.12f,
                                   .color = {4, 4, 4},
                                   .opacity = 0.5f};
        }
        masu_trail t = {.points = p, .point_count = form == 3 ? 14 : POINTS, .texture = 1};
        render((masu_frame_desc){.trails = &t, .trail_count = 1}, picture);
        uint32_t once = 0, partly = 0;
        for (uint32_t i = 0; i < PIXELS; i++) {
            double gain =
                ((double)picture[4 * i] - (double)base[4 * i]) / (4 - (double)base[4 * i]);
            assert_true(gain < 0.51);
            once += gain > 0.49;
            partly += gain > 0.01 && gain < 0.49;
        }
        print_message("form %u: %u pixels once, %u partly\n", form, once, partly);
        assert_true(once > 500 && partly == 0);
    }
    close_session(&s);
}

/* Opaque ones at random: at each pixel the closest one is in front, unless another one that is there
 * too is closer to it than the sum of their radii. */
static void sprites_are_ordered_within_their_bound(void **state) {
    (void)state;
    enum { DISCS = 10, TRAILS = 5 };
    uint64_t seed = 5;
    uint32_t checked = 0;
    open_room(TEXELS);
    for (uint32_t turn = 0; turn < 6; turn++) {
        masu_particle p[DISCS];
        masu_trail_point points[TRAILS][2];
        masu_trail trails[TRAILS];
        double z[DISCS + TRAILS], radius[DISCS + TRAILS];
        for (uint32_t i = 0; i < DISCS + TRAILS; i++) {
            float color = 1 + (float)i;
            z[i] = random_between(&seed, 0.8, 2.9);
            double x = random_between(&seed, -0.3, 0.3), y = random_between(&seed, -0.3, 0.3);
            if (i < DISCS) {
                radius[i] = 0.15 * sqrt(2.0);
                p[i] = (masu_particle){.position = {x, y, 3 - z[i]},
                                       .half_width = 0.15f,
                                       .color = {color, 0, 0},
                                       .opacity = 1,
                                       .edge = 1};
                continue;
            }
            radius[i] = hypot(0.25, 0.1);
            for (uint32_t e = 0; e < 2; e++)
                points[i - DISCS][e] =
                    (masu_trail_point){.position = {x + (e ? 0.25 : -0.25), y, 3 - z[i]},
                                       .half_width = 0.1f,
                                       .color = {color, 0, 0},
                                       .opacity = 1};
            trails[i - DISCS] =
                (masu_trail){.points = points[i - DISCS], .point_count = 2, .edge = 1};
        }
        render(
            (masu_frame_desc){
                .particles = p, .particle_count = DISCS, .trails = trails, .trail_count = TRAILS},
            picture);
        for (uint32_t i = 0; i < PIXELS; i++) {
            int front = -1, rim = 0;
            double next = 1e9;
            for (int n = 0; n < DISCS + TRAILS; n++) {
                double at[2], rest;
                at_pixel(i, z[n], at);
                if (n < DISCS) {
                    rest = 1 - hypot(at[0] - p[n].position[0], at[1] - p[n].position[1]) / 0.15;
                } else {
                    const double *from = points[n - DISCS][0].position;
                    rest = fmin(1 - fabs(at[1] - from[1]) / 0.1,
                                1 - fabs(at[0] - from[0] - 0.25) / 0.25);
                }
                rim |= fabs(rest) < 0.1;
                if (rest < 0) continue;
                if (front < 0 || z[n] < z[front]) front = n;
            }
            for (int n = 0; n < DISCS + TRAILS && front >= 0; n++) {
                if (n != front) next = fmin(next, z[n] - z[front] - radius[n] - radius[front]);
            }
            if (front < 0 || rim || next < 0) continue;
            checked++;
            if (fabsf(picture[4 * i] - (float)(1 + front)) > 0.01f)
                fail_msg("pixel %u: %g, not %d", i, (double)picture[4 * i], 1 + front);
        }
    }
    print_message("%u pixels\n", checked);
    assert_true(checked > 100);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_trail_is_shaded_along_its_length),
        cmocka_unit_test(segments_of_a_trail_share_their_edges),
        cmocka_unit_test(sprites_are_ordered_within_their_bound),
    };
    return cmocka_run_group_tests_name("trails", tests, NULL, NULL);
}
