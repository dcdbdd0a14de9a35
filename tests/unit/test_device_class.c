/* test_device_class.c: the class of a GPU, the computed costs of the built-in ladders for it, and
 * how the governor uses them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "quality/device_class.h"
#include "quality/governor.h"
#include "quality/governor_desc.h"
#include "quality/ladder.h"
#include "support/desc.h"
#include "support/random.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static masu_device_class class_of(uint32_t vendor, uint32_t device, VkPhysicalDeviceType type) {
    VkPhysicalDeviceProperties p = {.vendorID = vendor, .deviceID = device, .deviceType = type};
    return masu_device_class_of(&p);
}

static void known_devices_have_their_class(void **state) {
    (void)state;
    static const struct {
        uint32_t vendor, device;
        masu_device_class wanted;
    } known[] = {
        {0x1002, 0x163F, MASU_DEVICE_DECK},   /* Steam Deck */
        {0x1002, 0x1435, MASU_DEVICE_DECK},   /* Steam Deck, OLED */
        {0x1002, 0x1681, MASU_DEVICE_DECK},   /* Rembrandt */
        {0x1002, 0x164E, MASU_DEVICE_DECK},   /* Raphael */
        {0x1002, 0x15BF, MASU_DEVICE_DECK},   /* Phoenix */
        {0x1002, 0x73BF, MASU_DEVICE_DECK},   /* Navi 21 */
        {0x1002, 0x731F, MASU_DEVICE_DECK},   /* Navi 10 */
        {0x1002, 0x15DD, MASU_DEVICE_VEGA8},  /* Raven */
        {0x1002, 0x15D8, MASU_DEVICE_VEGA8},  /* Picasso */
        {0x1002, 0x1636, MASU_DEVICE_VEGA8},  /* Renoir */
        {0x1002, 0x164C, MASU_DEVICE_VEGA8},  /* Lucienne */
        {0x1002, 0x1638, MASU_DEVICE_VEGA8},  /* Cezanne */
        {0x1002, 0x67DF, MASU_DEVICE_VEGA8},  /* Polaris 10 */
        {0x1002, 0x687F, MASU_DEVICE_VEGA8},  /* Vega 10 */
        {0x8086, 0x5916, MASU_DEVICE_UHD620}, /* HD 620 */
        {0x8086, 0x5917, MASU_DEVICE_UHD620}, /* UHD 620 */
        {0x8086, 0x3EA0, MASU_DEVICE_UHD620}, /* UHD 620, Whiskey Lake */
        {0x8086, 0x1912, MASU_DEVICE_UHD620}, /* HD 530 */
        {0x8086, 0x9BC8, MASU_DEVICE_UHD620}, /* UHD 630, Comet Lake */
        {0x8086, 0x8A52, MASU_DEVICE_UHD620}, /* Ice Lake */
        {0x8086, 0x3185, MASU_DEVICE_UHD620}, /* UHD 600 */
        {0x8086, 0x9A49, MASU_DEVICE_XE80},   /* Iris Xe, Tiger Lake */
        {0x8086, 0x46A6, MASU_DEVICE_XE80},   /* Iris Xe, Alder Lake */
        {0x8086, 0xA7A0, MASU_DEVICE_XE80},   /* Iris Xe, Raptor Lake */
        {0x8086, 0x7D55, MASU_DEVICE_XE80},   /* Meteor Lake */
        {0x8086, 0x56A0, MASU_DEVICE_XE80},   /* Arc A770 */
        {0x5143, 0x6030001, MASU_DEVICE_MOBILE},
        {0x13B5, 0x70930000, MASU_DEVICE_MOBILE},
        {0x1010, 0x1, MASU_DEVICE_MOBILE},
        {0x10DE, 0x1C03, MASU_DEVICE_OTHER}, /* no NVIDIA compiler was used */
        {0x106B, 0, MASU_DEVICE_OTHER},
    };
    for (size_t i = 0; i < COUNT(known); i++) {
        for (int discrete = 0; discrete < 2; discrete++) {
            masu_device_class is = class_of(known[i].vendor, known[i].device,
                                            discrete ? VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU
                                                     : VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU);
            if (is != known[i].wanted)
                fail_msg("%04x:%04x is of '%s'", known[i].vendor, known[i].device,
                         masu_device_class_name(is));
        }
        /* A CPU with the IDs of a GPU is a CPU. */
        assert_int_equal(class_of(known[i].vendor, known[i].device, VK_PHYSICAL_DEVICE_TYPE_CPU),
                         MASU_DEVICE_OTHER);
    }
    assert_string_equal(masu_device_class_name(MASU_DEVICE_OTHER), "");
    assert_string_equal(masu_device_class_name((masu_device_class)99), "");
    for (int c = MASU_DEVICE_OTHER + 1; c < MASU_DEVICE_CLASSES; c++)
        assert_true(*masu_device_class_name((masu_device_class)c) != 0);
}

static void every_rung_of_every_ladder_has_its_cost_on_every_class(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        assert_int_equal(masu_scene_class_of(masu_scene_of(&s)), c);
        const masu_ladder *l = masu_ladder_for(masu_scene_of(&s));
        assert_null(masu_ladder_costs_on(masu_scene_of(&s), MASU_DEVICE_OTHER));
        assert_null(masu_ladder_costs_on(masu_scene_of(&s), MASU_DEVICE_CLASSES));
        for (int k = MASU_DEVICE_OTHER + 1; k < MASU_DEVICE_CLASSES; k++) {
            const float *costs = masu_ladder_costs_on(masu_scene_of(&s), (masu_device_class)k);
            assert_non_null(costs);
            assert_true(costs[0] == 1.0f);
            double off = 0;
            for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++) {
                /* tests/scripts/docs_tables.sh checks that it belongs to the ladder that is
                 * measured now. */
                assert_true(r < l->count ? costs[r] > 0.01f && costs[r] < 1.2f : costs[r] == 0.0f);
                if (r < l->count)
                    off = fmax(off, fabs((double)costs[r] - (double)(l->ratios[r] / l->ratios[0])));
            }
            assert_true(off > 0.0);
            assert_true(costs[l->count - 1] < 0.7f);
        }
    }
}

/* Frames on a GPU that takes `load` ms at rung 0, and the computed costs of its class elsewhere.
 * Returns the number of frames over the target of 16.67 ms. *lost: sum of the rungs by which frames
 * were worse than the best that fits. */
static uint32_t play(const masu_ladder *l, const float *truth, const float *prior, double load,
                     uint64_t seed, uint32_t *lost) {
    enum { FRAMES = 600, LATENCY = 2 };
    static masu_governor g;
    masu_governor_rung rungs[MASU_MAX_RUNGS];
    masu_governor_desc d = {.mode = MASU_GOVERNOR_ON};
    double ms[FRAMES];
    uint32_t drawn[FRAMES], over = 0, fits = 0;
    for (uint32_t r = 0; r < l->count; r++)
        rungs[r] = (masu_governor_rung){(double)l->rungs[r].scale, (double)prior[r]};
    masu_governor_defaults(&d, l->count);
    masu_governor_init(&g, &d, rungs, l->count);
    while (fits + 1 < l->count && load * (double)truth[fits] > 0.93 * 16.67) fits++;
    for (uint32_t f = 0; f < FRAMES; f++) {
        if (f >= LATENCY) {
            masu_governor_sample s = {
                .frame = f - LATENCY, .rung = drawn[f - LATENCY], .gpu_ms = ms[f - LATENCY]};
            masu_governor_sample_in(&g, &s);
        }
        drawn[f] = masu_governor_pick(&g, f);
        double noise = 1.0 + 0.02 * ((double)support_random_in(&seed, 0, 1000) / 1000.0 - 0.5);
        ms[f] = load * (double)truth[drawn[f]] * noise;
        over += ms[f] > 16.67;
        *lost += drawn[f] > fits ? drawn[f] - fits : 0;
    }
    return over;
}

/* The governor on a GPU that behaves as computed: with the mean of the classes, which an unknown
 * GPU gets as well, and with the costs of its own class. Costs from a CPU driver were wrong for up
 * to 71 frames. */
static void a_first_estimate_misses_a_few_frames_at_most(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        const masu_ladder *l = masu_ladder_of_class((masu_scene_class)c);
        if (!l->count) continue;
        uint32_t over[2] = {0, 0}, lost[2] = {0, 0};
        for (int k = MASU_DEVICE_OTHER + 1; k < MASU_DEVICE_CLASSES; k++) {
            const float *truth = masu_ladder_costs_on(masu_scene_of(&s), (masu_device_class)k);
            for (uint32_t r = 1; r < l->count; r++) { /* a load for which this rung is right */
                for (uint32_t seed = 0; seed < 4; seed++) {
                    for (int way = 0; way < 2; way++)
                        over[way] += play(l, truth, way ? truth : l->ratios,
                                          0.9 * 16.67 / (double)truth[r], seed, &lost[way]);
                }
            }
        }
        double runs = 4.0 * 5.0 * (l->count - 1);
        print_message("  %-16s of 600 frames over the target: by the mean of the classes %4.1f, by "
                      "its own %4.1f; rungs "
                      "lost a frame: %.3f, %.3f\n",
                      masu_scene_class_name((masu_scene_class)c), over[0] / runs, over[1] / runs,
                      lost[0] / runs / 600, lost[1] / runs / 600);
        for (int way = 0; way < 2; way++)
            assert_true(over[way] / runs <= 4.0 && lost[way] / runs / 600 <= 0.25);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_devices_have_their_class),
        cmocka_unit_test(every_rung_of_every_ladder_has_its_cost_on_every_class),
        cmocka_unit_test(a_first_estimate_misses_a_few_frames_at_most),
    };
    return cmocka_run_group_tests_name("device class", tests, NULL, NULL);
}
