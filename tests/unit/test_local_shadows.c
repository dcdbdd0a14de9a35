/* test_local_shadows.c: decisions about shadows of punctual lights: which lights have one
 * (frame/shadow_choice.h), positions of faces in the atlas (frame/shadow_tiles.h), which faces a
 * cone overlaps and how large they are. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "frame/local_shadows.h"
#include "scene/punctual_light.h"
#include "shared/masu_shared.h"
#include "support/random.h"

/* ---- Tiles ----------------------------------------------------------------------------------- */

static int overlap(const masu_shadow_tile *a, const masu_shadow_tile *b) {
    return a->x < b->x + b->size && b->x < a->x + a->size && a->y < b->y + b->size &&
           b->y < a->y + a->size;
}

static void tiles_never_overlap_and_all_come_back(void **state) {
    (void)state;
    enum { MOST = 200 };
    static const uint32_t atlases[] = {128, 512, 2048, 4096};
    uint64_t seed = 1;
    for (size_t a = 0; a < 4; a++) {
        masu_shadow_tiles t;
        masu_shadow_tile tiles[MOST] = {{0, 0, 0}};
        masu_shadow_tiles_clear(&t, atlases[a]);
        for (int n = 0; n < 3000; n++) {
            uint32_t i = (uint32_t)random_between(&seed, 0, MOST - 0.01),
                     size = 128u << (support_random(&seed) % 3);
            if (tiles[i].size) {
                masu_shadow_tile_give(&t, &tiles[i]);
                continue;
            }
            masu_shadow_tile got = masu_shadow_tile_take(&t, size);
            if (!got.size) continue;
            assert_true(got.size == size && got.x % size == 0 && got.y % size == 0);
            assert_true(got.x + size <= atlases[a] && got.y + size <= atlases[a]);
            for (int k = 0; k < MOST; k++) assert_false(tiles[k].size && overlap(&got, &tiles[k]));
            tiles[i] = got;
        }
        for (int k = 0; k < MOST; k++) masu_shadow_tile_give(&t, &tiles[k]);
        for (uint32_t k = 0; k < (atlases[a] / 512) * (atlases[a] / 512); k++)
            assert_int_equal(masu_shadow_tile_take(&t, 512).size, 512);
        assert_int_equal(masu_shadow_tile_take(&t, 512).size, 0);
    }
}

static void small_tiles_leave_room_for_large_ones(void **state) {
    (void)state;
    masu_shadow_tiles t;
    masu_shadow_tiles_clear(&t, 2048);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(masu_shadow_tile_take(&t, 128).size, 128);
        assert_int_equal(masu_shadow_tile_take(&t, 256).size, 256);
    }
    for (int k = 0; k < 14; k++) assert_int_equal(masu_shadow_tile_take(&t, 512).size, 512);
}

static void tiles_move_together(void **state) {
    (void)state;
    enum { MOST = 80 };
    uint64_t seed = 4;
    for (int round = 0; round < 40; round++) {
        masu_shadow_tiles t;
        masu_shadow_tile tiles[MOST] = {{0, 0, 0}};
        masu_shadow_tiles_clear(&t, 2048);
        uint64_t area = 0;
        for (int n = 0; n < 400; n++) {
            uint32_t i = (uint32_t)random_between(&seed, 0, MOST - 0.01),
                     size = 128u << (support_random(&seed) % 3);
            if (tiles[i].size) masu_shadow_tile_give(&t, &tiles[i]);
            else tiles[i] = masu_shadow_tile_take(&t, size);
        }
        for (int i = 0; i < MOST; i += 1 + (support_random(&seed) % 3))
            masu_shadow_tile_give(&t, &tiles[i]);
        for (int i = 0; i < MOST; i++) area += (uint64_t)tiles[i].size * tiles[i].size;
        uint32_t moves = 0;
        for (int moved = 1; moved; moves += (uint32_t)moved) {
            moved = 0;
            for (int i = 0; i < MOST && !moved; i++) {
                masu_shadow_tile before = tiles[i];
                masu_shadow_tile_move(&t, &tiles[i]);
                moved = before.x != tiles[i].x || before.y != tiles[i].y;
                if (moved)
                    assert_true(masu_shadow_tile_order(tiles[i]) < masu_shadow_tile_order(before));
                for (int k = 0; moved && k < MOST; k++)
                    assert_false(k != i && tiles[k].size && overlap(&tiles[i], &tiles[k]));
            }
            assert_true(moves < 10000);
        }
        /* The free area consists of whole squares, except for less than two. */
        uint32_t free_squares = (uint32_t)((2048ull * 2048 - area) / (512 * 512)), found = 0;
        while (masu_shadow_tile_take(&t, 512).size) found++;
        assert_true(found + 2 > free_squares);
    }
}

static void the_least_important_shrink_first(void **state) {
    (void)state;
    uint32_t sizes[4] = {512, 512, 256, 512};
    const uint32_t faces[4] = {6, 1, 6, 6};
    const double scores[4] = {3, 1, 0.5, 2};
    masu_shadow_sizes_fit(sizes, faces, scores, 4, 2048); /* 13 + 6/4 of 16 squares of 512 */
    assert_true(sizes[0] == 512 && sizes[1] == 512 && sizes[2] == 256 && sizes[3] == 512);
    /* 4: all are halved, and two of them again */
    masu_shadow_sizes_fit(sizes, faces, scores, 4, 1024);
    assert_true(sizes[0] == 256 && sizes[1] == 256 && sizes[2] == 128 && sizes[3] == 256);
    masu_shadow_sizes_fit(sizes, faces, scores, 4, 512);
    assert_true(sizes[0] == 128 && sizes[1] == 128 && sizes[2] == 128 && sizes[3] == 128);
    uint32_t equal[2] = {512, 512};
    const uint32_t spots[2] = {1, 1};
    const double alike[2] = {1, 1};
    masu_shadow_sizes_fit(equal, spots, alike, 2, 512);
    assert_true(equal[0] == 256 && equal[1] == 256);
}

/* ---- Choice ---------------------------------------------------------------------------------- */

typedef struct stage {
    masu_shadow_slot slots[8];
    uint32_t lost; /* lights that have left */
} stage;

static void on_left(void *user, uint32_t slot) {
    stage *s = user;
    assert_int_equal(s->slots[slot].fade, 0);
    s->lost++;
}

/* A frame with these lights; a score of 0: the light was removed. */
static void step(stage *s, uint32_t most, const double *scores, uint32_t count, int cut) {
    masu_shadow_wish wish;
    wish.count = 0;
    for (uint32_t k = 0; k < 8; k++) s->slots[k].offered = 0;
    for (uint32_t i = 0; i < count; i++) {
        double score = scores[i];
        for (uint32_t k = 0; k < 8; k++) {
            if (s->slots[k].light != i + 1 || !(score > 0)) continue;
            score *= MASU_SHADOW_HYSTERESIS;
            s->slots[k].offered = 1;
            s->slots[k].score = score;
        }
        masu_shadow_wish_add(&wish, most, i + 1, score);
    }
    masu_shadow_slot before[8];
    memcpy(before, s->slots, sizeof before);
    masu_shadow_choose(s->slots, 8, most, &wish, cut ? 0 : MASU_SHADOW_CUT, on_left, s);
    uint32_t held = 0;
    for (uint32_t k = 0; k < 8; k++) {
        held += s->slots[k].light != 0;
        if (s->slots[k].light && s->slots[k].light == before[k].light && !cut)
            assert_true(abs((int)s->slots[k].fade - (int)before[k].fade) <= 1);
        if (s->slots[k].light) s->slots[k].ready = 1; /* rendered at once */
    }
    assert_true(held <= most);
}

static const masu_shadow_slot *slot_of(const stage *s, uint32_t light) {
    for (uint32_t k = 0; k < 8; k++) {
        if (s->slots[k].light == light + 1) return &s->slots[k];
    }
    return NULL;
}

static void the_best_have_shadows(void **state) {
    (void)state;
    stage s = {0};
    double scores[6] = {1, 5, 3, 9, 3, 7};
    for (int f = 0; f < 12; f++) step(&s, 4, scores, 6, 0);
    assert_non_null(slot_of(&s, 3));
    assert_non_null(slot_of(&s, 5));
    assert_non_null(slot_of(&s, 1));
    assert_non_null(slot_of(&s, 2)); /* the first of equals */
    assert_null(slot_of(&s, 4));
    assert_int_equal(slot_of(&s, 3)->fade, MASU_LOCAL_FADE);
}

static void small_changes_of_order_change_nothing(void **state) {
    (void)state;
    stage s = {0};
    for (int f = 0; f < 400; f++) {
        double scores[3] = {10 + 2 * sin(f * 0.3), 10 + 2 * sin(f * 0.37 + 2),
                            10 + 2 * sin(f * 0.41 + 4)};
        step(&s, 2, scores, 3, 0);
    }
    assert_int_equal(s.lost, 0);
}

static void a_shadow_is_held_then_faded_then_given_away(void **state) {
    (void)state;
    stage s = {0};
    double before[2] = {9, 1}, after[2] = {1, 9};
    for (int f = 0; f < 10; f++) step(&s, 1, before, 2, 0);
    int frame = 10;
    for (; slot_of(&s, 0); frame++) {
        assert_null(slot_of(&s, 1));
        if (frame < (int)MASU_SHADOW_HOLD) assert_int_equal(slot_of(&s, 0)->fade, MASU_LOCAL_FADE);
        assert_true(frame < 100);
        step(&s, 1, after, 2, 0);
    }
    /* The first age belongs to the frame after the choice. */
    assert_in_range(frame, MASU_SHADOW_HOLD + MASU_LOCAL_FADE,
                    MASU_SHADOW_HOLD + MASU_LOCAL_FADE + 2);
    assert_non_null(slot_of(&s, 1));
    assert_int_equal(slot_of(&s, 1)->fade, 0);
    for (int f = 0; f < MASU_LOCAL_FADE; f++) step(&s, 1, after, 2, 0);
    assert_int_equal(slot_of(&s, 1)->fade, MASU_LOCAL_FADE);
}

/* A slot is kept until another light needs it; but not after a cut. */
static void nobody_leaves_for_nothing(void **state) {
    (void)state;
    stage s = {0};
    double near[3] = {9, 8, 0}, far[3] = {9, 1e-3, 0}, other[3] = {9, 1e-3, 5};
    for (int f = 0; f < 40; f++) step(&s, 2, near, 3, 0);
    for (int f = 0; f < 100; f++) step(&s, 2, far, 3, 0);
    assert_int_equal(s.lost, 0);
    step(&s, 2, other, 3, 1);
    assert_int_equal(s.lost, 1);
    assert_non_null(slot_of(&s, 2));
    /* A removed light fades out, whoever waits. */
    double gone[3] = {9, 0, 0};
    for (int f = 0; f < 12; f++) step(&s, 2, other, 3, 0);
    for (int f = 0; f < MASU_LOCAL_FADE + 1; f++) step(&s, 2, gone, 3, 0);
    assert_null(slot_of(&s, 2));
}

/* A neon tube is bright, but lights less than a lamp; a cone reaches less than a sphere. */
static void scores_are_of_what_a_light_adds(void **state) {
    (void)state;
    const double none[3] = {0, 0, 0}, half[3] = {0, 0.75, 0};
    masu_punctual_light_state lamp = {.color = {7, 5, 2}}, ball = {.shape = MASU_SHAPE_SPHERE,
                                                                   .color = {26, 2, 11},
                                                                   .radius = 0.5f};
    masu_punctual_light_state tube = {
        .shape = MASU_SHAPE_CAPSULE, .color = {26, 2, 11}, .radius = 0.02f};
    masu_punctual_light_state window = {
        .shape = MASU_SHAPE_RECTANGLE, .color = {3, 2, 1}, .half_axis = {1.5f, 0, 0}};
    assert_true(fabs(masu_light_intensity(&lamp, none) - 7) < 1e-9);
    assert_true(fabs(masu_light_intensity(&ball, none) - 26 * 0.25) < 1e-6);
    assert_true(fabs(masu_light_intensity(&tube, half) -
                     26 * (0.0004 + 4 * 0.75 * 0.02 / 3.14159265)) < 1e-5);
    assert_true(fabs(masu_light_intensity(&window, half) - 3 * 4 * 0.75 * 1.5 / 3.14159265) < 1e-5);
    assert_true(masu_shadow_score(2, 10, 20) < masu_shadow_score(3, 10, 20));
    assert_true(fabs(masu_shadow_score(2, 10, 20) - 4 * masu_shadow_score(2, 10, 40)) < 1e-9);
    assert_true(masu_shadow_score(2, 10, 0) > 0);
}

/* ---- Faces ----------------------------------------------------------------------------------- */

static void a_cone_reaches_into_the_faces_that_it_touches(void **state) {
    (void)state;
    uint64_t seed = 9;
    for (int n = 0; n < 300; n++) {
        double axis[3], length = 0, angle = random_between(&seed, 0.1, 3.1);
        for (int k = 0; k < 3; k++)
            axis[k] = random_between(&seed, -1, 1), length += axis[k] * axis[k];
        for (int k = 0; k < 3; k++) axis[k] /= sqrt(length);
        for (int i = 0; i < 500; i++) {
            double d[3], size = 0, cosine = 0, most = 0;
            uint32_t face = 0;
            for (uint32_t k = 0; k < 3; k++) {
                d[k] = random_between(&seed, -1, 1);
                size += d[k] * d[k];
                cosine += d[k] * axis[k];
                if (fabs(d[k]) > most) most = fabs(d[k]), face = 2 * k + (d[k] < 0);
            }
            if (acos(cosine / sqrt(size)) < angle)
                assert_true(masu_local_face_is_lit(axis, angle, face));
        }
    }
    const double down[3] = {0, -1, 0};
    assert_false(masu_local_face_is_lit(down, 1.2, 2)); /* up */
}

static void sizes_follow_the_view_with_hysteresis(void **state) {
    (void)state;
    assert_int_equal(masu_local_face_size(260, 0, 512), 256);
    assert_int_equal(masu_local_face_size(2000, 0, 256), 256);
    assert_int_equal(masu_local_face_size(3, 0, 512), 128);
    assert_int_equal(masu_local_face_size(500, 256, 512), 256);
    assert_int_equal(masu_local_face_size(600, 256, 512), 512);
    assert_int_equal(masu_local_face_size(120, 256, 512), 256);
    assert_int_equal(masu_local_face_size(110, 256, 512), 128);
    assert_int_equal(masu_local_face_size(500, 512, 256), 256);
    /* Half the distance: twice the texels, up to a third of the range. */
    double far = masu_local_face_wish(15, 1, 20, 500), near = masu_local_face_wish(15, 1, 10, 500);
    assert_true(fabs(2 * far - near) < 1e-9);
    assert_true(fabs(masu_local_face_wish(15, 1, 1000, 500) - 256) < 1e-9);
    assert_true(fabs(masu_local_face_wish(15, 1, 1, 300) - 800) < 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_never_overlap_and_all_come_back),
        cmocka_unit_test(small_tiles_leave_room_for_large_ones),
        cmocka_unit_test(tiles_move_together),
        cmocka_unit_test(the_least_important_shrink_first),
        cmocka_unit_test(the_best_have_shadows),
        cmocka_unit_test(small_changes_of_order_change_nothing),
        cmocka_unit_test(a_shadow_is_held_then_faded_then_given_away),
        cmocka_unit_test(nobody_leaves_for_nothing),
        cmocka_unit_test(scores_are_of_what_a_light_adds),
        cmocka_unit_test(a_cone_reaches_into_the_faces_that_it_touches),
        cmocka_unit_test(sizes_follow_the_view_with_hysteresis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
