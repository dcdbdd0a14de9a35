/*
 * test_jitter.c: where in its pixels a frame of a rung with `temporal` looks (src/frame/temporal.h). What takes turns in four
 * frames, as reflections do with each 2x2 pixels, has to see all of a pixel in its turns.
 */
#include "frame/temporal.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define TOLERANCE 1e-6f

typedef struct ratio {
    VkExtent2D render, shown;
    uint32_t places;
} ratio;

static const ratio ratios[] = {
    {{640, 360}, {640, 360}, 16},     {{512, 288}, {640, 360}, 28}, {{320, 180}, {640, 360}, 64},
    {{256, 144}, {640, 360}, 100},    {{1, 1}, {1, 1}, 16},         {{8, 8}, {640, 360}, 1024},
    {{1919, 1079}, {1920, 1080}, 20},
};

#define RATIOS (sizeof ratios / sizeof ratios[0])

static void as_many_places_as_put_16_samples_into_a_pixel(void **state) {
    (void)state;
    for (size_t k = 0; k < RATIOS; k++) {
        const ratio *r = &ratios[k];
        float first[2], place[2], sum[2] = {0, 0};
        masu_temporal_place(r->render, r->shown, 0, first);
        for (uint32_t i = 0; i < r->places; i++) {
            masu_temporal_place(r->render, r->shown, i, place);
            for (int c = 0; c < 2; c++) {
                assert_true(place[c] > -0.5f && place[c] < 0.5f);
                sum[c] += place[c];
            }
            assert_true(i == 0 || fabsf(place[0] - first[0]) > TOLERANCE);
            float later[2];
            masu_temporal_place(r->render, r->shown, i + (uint64_t)r->places * 4000012u, later);
            assert_true(later[0] == place[0] && later[1] == place[1]);
        }
        for (int c = 0; c < 2; c++) assert_true(fabsf(sum[c]) / (float)r->places < 0.05f);
    }
}

/* Each quarter across as often as the others, give or take one. */
static void each_fourth_place_is_in_all_quarters(void **state) {
    (void)state;
    for (size_t k = 0; k < RATIOS; k++) {
        const ratio *r = &ratios[k];
        for (uint32_t turn = 0; turn < 4; turn++) {
            uint32_t in[4] = {0};
            for (uint32_t i = turn; i < r->places; i += 4) {
                float place[2];
                masu_temporal_place(r->render, r->shown, i, place);
                in[(int)floorf(4.0f * (place[0] + 0.5f))]++;
            }
            for (int q = 0; q < 4; q++) {
                assert_in_range(in[q], r->places / 16, (r->places + 15) / 16);
            }
        }
    }
}

/* In four rounds each fourth place is every place, once. */
static void each_fourth_place_is_all_places(void **state) {
    (void)state;
    for (size_t k = 0; k < RATIOS; k++) {
        const ratio *r = &ratios[k];
        for (uint32_t turn = 0; turn < 4; turn++) {
            uint8_t seen[1024] = {0};
            for (uint32_t i = turn; i < 4 * r->places; i += 4) {
                float place[2], other[2];
                uint32_t number = 0;
                masu_temporal_place(r->render, r->shown, i, place);
                for (masu_temporal_place(r->render, r->shown, 0, other); fabsf(other[0] - place[0]) > TOLERANCE;)
                    masu_temporal_place(r->render, r->shown, ++number, other);
                assert_true(number < r->places);
                assert_int_equal(seen[number]++, 0);
            }
        }
    }
}

/* Of four that follow each other, too, from each fourth on: a mean of few is of all of a pixel. */
static void four_places_are_in_all_quarters(void **state) {
    (void)state;
    for (size_t k = 0; k < RATIOS; k++) {
        const ratio *r = &ratios[k];
        for (uint32_t i = 0; i < r->places; i += 4) {
            unsigned seen = 0;
            for (uint32_t n = 0; n < 4; n++) {
                float place[2];
                masu_temporal_place(r->render, r->shown, i + n, place);
                seen |= 1u << (int)floorf(4.0f * (place[0] + 0.5f));
            }
            assert_int_equal(seen, 15);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_many_places_as_put_16_samples_into_a_pixel),
        cmocka_unit_test(each_fourth_place_is_in_all_quarters),
        cmocka_unit_test(each_fourth_place_is_all_places),
        cmocka_unit_test(four_places_are_in_all_quarters),
    };
    return cmocka_run_group_tests_name("jitter", tests, NULL, NULL);
}
