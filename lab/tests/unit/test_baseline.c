/* test_baseline.c: the parts of `masu-lab study baseline` that need no device: the search for the
 * least sample count, medians over rounds, and the baseline's settings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "lab/study/baseline.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

typedef struct step {
    uint32_t from, asked, most_asked, fails_at;
} step;

static int from_on(void *user, uint32_t k) {
    step *s = user;
    s->asked++;
    if (k > s->most_asked) s->most_asked = k;
    return k == s->fails_at ? -1 : k >= s->from;
}

static void the_least_is_found(void **state) {
    (void)state;
    for (uint32_t most = 1; most <= 200; most++) {
        for (uint32_t from = 1; from <= 210; from++) {
            step s = {.from = from};
            uint32_t k = masu_baseline_least(most, from_on, &s);
            assert_true(s.most_asked <= most);
            assert_true(s.asked <= 16);
            if (from > most) {
                assert_int_equal(k, 0);
            } else {
                assert_true(k >= from && 8 * (k - from) <= k); /* within an eighth */
                if (from <= 8) assert_int_equal(k, from);
            }
        }
    }
    step s = {.from = 9, .fails_at = 4};
    assert_int_equal(masu_baseline_least(64, from_on, &s), UINT32_MAX);
    s = (step){.from = 11, .fails_at = 12};
    assert_int_equal(masu_baseline_least(64, from_on, &s), UINT32_MAX);
}

/* A machine that is half as fast in every other round does not change the ratio over rounds. */
static void ratios_are_of_rounds(void **state) {
    (void)state;
    static masu_samples plain, own;
    for (uint32_t k = 0; k < 9; k++) {
        double slow = k % 2 ? 2.0 : 1.0;
        masu_samples_add(&plain, 60.0 * slow, 50.0 * slow, 2);
        masu_samples_add(&own, 10.0 * slow, k == 4 ? 99.0 : 4.9 * slow, 1);
    }
    assert_int_equal(plain.count, 9);
    assert_int_equal(plain.plausible, 9);
    assert_int_equal(own.plausible, 0); /* 0.49 of the wall, and once 9.9 */
    assert_true(fabs(masu_samples_ratio(own.wall, plain.wall, 9) - 3.0) < 1e-12);
    masu_samples_sort(&plain);
    assert_true(fabs(masu_samples_at(plain.wall, 9, 0.0) - 30.0) < 1e-12);
    assert_true(fabs(masu_samples_at(plain.wall, 9, 1.0) - 60.0) < 1e-12);
    own.wall[3] = 0.0;
    assert_true(isnan(masu_samples_ratio(own.wall, plain.wall, 9)));
}

static void the_plain_renderer_takes_no_short_cut(void **state) {
    (void)state;
    const uint32_t all = 1u << MASU_MARCH_AUTO | 1u << MASU_MARCH_PLAIN;
    static const uint32_t without = 1u << MASU_MARCH_AUTO;
    const struct {
        masu_scene_data scene;
        masu_march march;
        const char *name;
    } cases[] = {{{.sdf = 1, .sdf_march = all}, MASU_MARCH_PLAIN, "plain"},
                 {{.sdf = 1, .sdf_march = all, .instances = 2}, MASU_MARCH_PLAIN, "plain"},
                 {{.sdf = 1, .sdf_march = without}, MASU_MARCH_AUTO, "auto"},
                 {{.instances = 2}, MASU_MARCH_AUTO, "none"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *name;
        masu_rung r = masu_baseline_rung(masu_scene_of(&cases[i].scene), &name);
        assert_int_equal(r.march, cases[i].march);
        assert_string_equal(name, cases[i].name);
        assert_true(r.frustum == MASU_OFF && r.occlusion == MASU_OFF && r.light_tiles == MASU_OFF);
        assert_true(r.lod_error < 0.0f && r.scale >= 1.0f && r.aa == MASU_AA_OFF);
        assert_true(r.ao == MASU_AUTO && r.specular == MASU_AUTO && !r.shadow_resolution);
    }
}

/* 2 of the 8 ms are for cascades: 3 samples take 8 + 2 * 6. */
static void shadow_maps_are_drawn_once(void **state) {
    (void)state;
    static masu_baseline w;
    masu_baseline_entry *plain = &w.entries[0], *own = &w.entries[1];
    plain->pass_count = 3;
    plain->pass_names[0] = "gbuffer", plain->pass_ms[0] = 6.0;
    plain->pass_names[1] = "cascade_0", plain->pass_ms[1] = 1.5;
    plain->pass_names[2] = "cascade_1", plain->pass_ms[2] = 0.5;
    own->times[MASU_BASELINE_MOTION].ratio = 2.0;
    assert_true(fabs(masu_baseline_once(plain) - 0.25) < 1e-12);
    assert_true(fabs(masu_baseline_equal(&w, own, 1) - 2.0) < 1e-12);
    assert_true(fabs(masu_baseline_equal(&w, own, 3) - 5.0) < 1e-12);
}

static void spare_passes_are_told(void **state) {
    (void)state;
    masu_baseline_entry e;
    memset(&e, 0, sizeof e);
    assert_true(masu_baseline_spare(&e) <= 0.0);
    e.pass_count = 3;
    e.pass_names[0] = "march_plain", e.pass_ms[0] = 6.0;
    e.pass_names[1] = "sdf_velocity", e.pass_ms[1] = 1.5;
    e.pass_names[2] = "specular_accumulate", e.pass_ms[2] = 0.5;
    assert_true(fabs(masu_baseline_spare(&e) - 0.25) < 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_least_is_found),
        cmocka_unit_test(ratios_are_of_rounds),
        cmocka_unit_test(the_plain_renderer_takes_no_short_cut),
        cmocka_unit_test(spare_passes_are_told),
        cmocka_unit_test(shadow_maps_are_drawn_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
