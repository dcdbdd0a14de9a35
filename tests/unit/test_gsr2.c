/* test_gsr2.c: the other way to take the mean of many frames that `masu study temporal` puts beside the library's:
 * colours come out as they went in, an edge that rests becomes what its samples say, what moves is found where it
 * was, and a break of depth or a cut ends the past. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/measure/picture.h"
#include "bench/study/gsr2.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FROM = 24, TO = 48, FRAMES = 64 };

typedef struct stage {
    masu_gsr2 g;
    uint8_t in[4 * FROM * FROM], out[4 * TO * TO];
    float depth[FROM * FROM], motion[2 * FROM * FROM];
} stage;

static void open_stage(stage *s) {
    const uint32_t from[2] = {FROM, FROM}, to[2] = {TO, TO};
    memset(s, 0, sizeof *s);
    assert_true(masu_gsr2_open(&s->g, from, to));
    for (int i = 0; i < FROM * FROM; i++) s->depth[i] = 0.1f;
}

static float mirrored(uint32_t i, uint32_t base) {
    float value = 0, digit = 1;
    for (; i; i /= base) value += (digit /= (float)base) * (float)(i % base);
    return value;
}

/* Dark or bright: a slanted edge, moved to the right. at: pixels of the render size. */
static bool bright(float x, float y, float moved) { return x - moved + 0.37f * y > 0.6f * FROM; }

static void draw(stage *s, uint32_t frame, float speed) {
    masu_gsr2_frame f = {s->in, s->depth, s->motion, {0, 0}, 1.0f, frame == 0, frame && !(speed > 0), 1.0f};
    for (int k = 0; k < 2; k++) f.jitter[k] = mirrored(frame % 32 + 1, k ? 3 : 2) - 0.5f;
    for (int i = 0; i < FROM * FROM; i++) {
        float x = (float)(i % FROM) + 0.5f + f.jitter[0], y = (float)(i / FROM) + 0.5f + f.jitter[1];
        memset(s->in + 4 * i, bright(x, y, speed * (float)frame) ? 230 : 40, 3);
        s->in[4 * i + 3] = 255;
        s->motion[2 * i] = -speed;
    }
    masu_gsr2_add(&s->g, &f, s->out);
}

/* Mean absolute difference of the mean of 64 places of each pixel, of 255. */
static double error(const stage *s, float moved) {
    double sum = 0;
    for (int i = 0; i < TO * TO; i++) {
        float light = 0;
        for (int k = 0; k < 64; k++) {
            float x = (float)(i % TO) + ((float)(k % 8) + 0.5f) / 8, y = (float)(i / TO) + ((float)(k / 8) + 0.5f) / 8;
            light += masu_picture_decoded(bright(0.5f * x, 0.5f * y, moved) ? 230 : 40) / 64;
        }
        sum += abs(s->out[4 * i] - masu_picture_encoded(light));
    }
    return sum / (TO * TO);
}

static void colours_come_out_as_they_went_in(void **state) {
    (void)state;
    static const uint8_t colours[][3] = {{128, 128, 128}, {200, 120, 60}, {30, 20, 10}, {250, 240, 230}};
    static stage s;
    for (size_t c = 0; c < sizeof colours / sizeof *colours; c++) {
        open_stage(&s);
        for (int i = 0; i < FROM * FROM; i++) memcpy(s.in + 4 * i, colours[c], 3);
        for (uint32_t frame = 0; frame < 20; frame++) {
            const masu_gsr2_frame f = {s.in, s.depth, s.motion, {0.3f, -0.4f}, 1.0f, false, frame > 0, 1.0f};
            masu_gsr2_add(&s.g, &f, s.out);
            for (int i = 0; i < 3 * TO * TO; i++)
                assert_in_range(s.out[4 * (i / 3) + i % 3] + 2 - colours[c][i % 3], 0, 4);
        }
        masu_gsr2_close(&s.g);
    }
}

static void an_edge_that_rests_becomes_what_its_samples_say(void **state) {
    (void)state;
    static stage s;
    open_stage(&s);
    draw(&s, 0, 0);
    double first = error(&s, 0);
    for (uint32_t frame = 1; frame < FRAMES; frame++) draw(&s, frame, 0);
    print_message("  at rest, of 255: %.3f, %.3f after %d frames\n", first, error(&s, 0), FRAMES);
    assert_true(error(&s, 0) < 0.5 * first);
    masu_gsr2_close(&s.g);
}

/* Against motion that is told the wrong way round. */
static void what_moves_is_found_where_it_was(void **state) {
    (void)state;
    static stage right, wrong;
    const float speed = 0.25f;
    open_stage(&right);
    open_stage(&wrong);
    for (uint32_t frame = 0; frame < 24; frame++) {
        draw(&right, frame, speed);
        memcpy(wrong.in, right.in, sizeof wrong.in);
        masu_gsr2_frame f = {wrong.in, wrong.depth, wrong.motion, {0, 0}, 1.0f, frame == 0, false, 1.0f};
        for (int k = 0; k < 2; k++) f.jitter[k] = mirrored(frame % 32 + 1, k ? 3 : 2) - 0.5f;
        for (int i = 0; i < FROM * FROM; i++) wrong.motion[2 * i] = speed;
        masu_gsr2_add(&wrong.g, &f, wrong.out);
    }
    print_message("  in motion: %.3f, told wrong %.3f\n", error(&right, 23 * speed), error(&wrong, 23 * speed));
    assert_true(error(&right, 23 * speed) < 0.7 * error(&wrong, 23 * speed));
    masu_gsr2_close(&right.g);
    masu_gsr2_close(&wrong.g);
}

/* All dark, then bright: by how much the picture follows in one frame. */
static int followed(bool cut, float break_at, float rest) {
    static stage s;
    open_stage(&s);
    for (uint32_t frame = 0; frame < 4; frame++) {
        memset(s.in, frame < 3 ? 40 : 200, sizeof s.in);
        for (int i = 0; i < FROM * FROM; i++) s.depth[i] = i % 4 || i / FROM % 4 ? 0.1f - break_at : 0.1f;
        const masu_gsr2_frame f = {s.in, s.depth, s.motion, {0, 0}, 1.0f, cut && frame == 3, true, rest};
        masu_gsr2_add(&s.g, &f, s.out);
    }
    masu_gsr2_close(&s.g);
    return s.out[4 * (TO / 2 * TO + TO / 2)];
}

static void a_break_of_depth_or_a_cut_ends_the_past(void **state) {
    (void)state;
    print_message("  of 40..200: flat %d, where depth breaks %d, after a cut %d\n", followed(false, 0, 1),
                  followed(false, 0.05f, 1), followed(true, 0, 1));
    assert_true(followed(false, 0, 1) < 120);
    assert_true(followed(false, 0.05f, 1) > followed(false, 0, 1) + 10);
    assert_in_range(followed(true, 0, 1), 199, 201);
    /* And what the samples show no longer, unless all of the past is kept where nothing moves. */
    assert_in_range(followed(false, 0, 0), 199, 201);
}

/* What is held within bright and brighter pixels counts a tenth: the picture shows which is which at once. */
static void what_had_to_be_held_counts_less(void **state) {
    (void)state;
    static stage s;
    open_stage(&s);
    for (uint32_t frame = 0; frame < 4; frame++) {
        for (int i = 0; i < FROM * FROM; i++) memset(s.in + 4 * i, frame < 3 ? 40 : (i + i / FROM) % 2 ? 230 : 170, 4);
        const masu_gsr2_frame f = {s.in, s.depth, s.motion, {0, 0}, 1.0f, false, true, 0.0f};
        masu_gsr2_add(&s.g, &f, s.out);
    }
    masu_gsr2_close(&s.g);
    const int dark = s.out[4 * (TO / 2 * TO + TO / 2)], bright = s.out[4 * (TO / 2 * TO + TO / 2 + 2)];
    print_message("  of 170 and 230: %d and %d\n", dark, bright);
    assert_true(bright - dark > 6); /* 1, if it counted as all of the past */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_come_out_as_they_went_in),
        cmocka_unit_test(an_edge_that_rests_becomes_what_its_samples_say),
        cmocka_unit_test(what_moves_is_found_where_it_was),
        cmocka_unit_test(a_break_of_depth_or_a_cut_ends_the_past),
        cmocka_unit_test(what_had_to_be_held_counts_less),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
