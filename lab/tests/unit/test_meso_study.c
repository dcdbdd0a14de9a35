/* test_meso_study.c: the fitted curves of masu-meso are at least twice as close to ray tracing as
 * plain normal mapping, for asphalt, gravel and grass at every view angle of the comparison; a mip
 * of one texel keeps the light of the map within 5 %. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lab/meso/study.h"
#include "support/files.h"

#define assert_near(got, want, most)                                                               \
    do {                                                                                           \
        double got_ = (got), want_ = (want);                                                       \
        if (!(fabs(got_ - want_) <= (most))) fail_msg("%s is %g, not %g", #got, got_, want_);       \
    } while (0)

static void curves_are_twice_as_near_as_plain_maps(void **state) {
    (void)state;
    static masu_meso_study study;
    for (const char *const *name = masu_meso_made; *name; name++) {
        if (name - masu_meso_made >= (int)trials(8, 1, 1)) break;
        masu_meso_patch p;
        assert_true(masu_meso_make(*name, 2, 1, &p));
        masu_meso_options options = {
            .size = 64, .side = trials(64, 64, 32), .sky_rays = trials(16, 16, 8), .seed = 1};
        assert_true(masu_meso_study_run(&p, &options, &study));
        double angle = 0, gain = masu_meso_study_gain(&study, &angle);
        double kept = 0, between = 0;
        for (uint32_t i = 0; i < MASU_MESO_JUDGED; i++) {
            const masu_meso_verdict *v = &study.verdict[i];
            kept = fmax(kept, fabs(v->mip_mean[2]));
            between = fmax(between, fmax(fabs(v->mip_mean[0]), fabs(v->mip_mean[1])));
            assert_near(v->mip_mean[2], v->filtered_mean[MASU_MESO_CURVES], 1e-6);
            /* Never worse than the AO map either. */
            assert_true(v->far[MASU_MESO_CURVES] < v->far[MASU_MESO_OCCLUDED]);
        }
        print_message(
            "  %s: %.2f times closer at worst, at %g degrees; a mip's mean differs by %.3f "
            "at worst, mips between by %.3f\n",
            *name, gain, angle, kept, between);
        assert_true(gain >= 2);
        assert_true(kept < 0.05);
        assert_true(between < 0.07);
        masu_meso_study_free(&study);
        masu_meso_patch_free(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(curves_are_twice_as_near_as_plain_maps)};
    return cmocka_run_group_tests_name("meso_study", tests, NULL, NULL);
}
