/* test_upscale_chain.c: the chain of compute shaders of `masu-lab study upscale`: fast EASU with
 * counters, outside a frame, counts the same 8x8 tiles left early as the scalar transcription in
 * tests/reference/fsr1.c. */
#include "support/support.h"

#include "reference/fsr1.h"
#include "reference/patterns.h"

#include "easu_fast_bytes_counted_comp.spv.h"
#include "easu_fast_counted_comp.spv.h"
#include "lab/study/upscale.h"

enum { MOST = 128 * 128 * 4 };

static const uint32_t sizes[3][4] = {{48, 40, 96, 80}, {64, 36, 96, 54}, {50, 30, 65, 39}};

typedef struct job {
    uint32_t in_w, in_h, out_w, out_h;
} job;

static masu_session s; /* a device without a renderer */

static int open_group(void **state) {
    (void)state;
    open_device(&s);
    return 0;
}

static int close_group(void **state) {
    (void)state;
    close_session(&s);
    return 0;
}

static uint32_t early_tiles(const job *j, const uint8_t *rgba) {
    static float rgb[MOST];
    uint32_t count = 0;
    masu_ref_from_rgba8(rgba, j->in_w, j->in_h, 0, rgb);
    struct masu_ref_image in = {rgb, j->in_w, j->in_h, 0};
    for (uint32_t ty = 0; ty < j->out_h; ty += 8) {
        for (uint32_t tx = 0; tx < j->out_w; tx += 8) {
            int all = 1;
            for (uint32_t i = 0; i < 64 && all; i++) {
                uint32_t x = tx + i % 8, y = ty + i / 8;
                if (x >= j->out_w || y >= j->out_h) continue;
                all = masu_ref_easu_leaves_early(&in, j->out_w, j->out_h, x, y);
            }
            count += (uint32_t)all;
        }
    }
    return count;
}

static void fast_easu_counts_the_tiles_that_leave_early(void **state) {
    (void)state;
    static uint8_t in[MOST];
    char error[ERROR_SIZE];
    const masu_bench_stage builds[2] = {
        {masu_spv_easu_fast_counted_comp, sizeof masu_spv_easu_fast_counted_comp, 0, 0},
        {masu_spv_easu_fast_bytes_counted_comp, sizeof masu_spv_easu_fast_bytes_counted_comp, 0,
         0}};
    uint32_t some = 0;
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        for (size_t i = 0; i < 3; i++) {
            const job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3]};
            masu_headless_source source;
            masu_headless_target target;
            masu_pattern_fill((enum masu_pattern)pattern, 8, j.in_w, j.in_h, in);
            for (uint32_t k = 0; k < j.in_w * j.in_h * 2; k++) in[k] = 77; /* a flat upper half */
            assert_ok(masu_headless_source_create(&s.host, in, j.in_w, j.in_h, j.in_w, j.in_h, 0,
                                                  &source, error, sizeof error));
            assert_ok(masu_headless_target_create(&s.host, j.out_w, j.out_h,
                                                  VK_FORMAT_R8G8B8A8_UNORM, true, &target, error,
                                                  sizeof error));
            uint32_t want = early_tiles(&j, in);
            some += want;
            for (int build = 0; build < 2; build++) {
                masu_bench_stage stages[MASU_BENCH_STAGES] = {builds[build]};
                masu_bench_chain chain;
                double wall, gpu;
                assert_ok(masu_bench_chain_open(&s.host, stages, &source,
                                                (VkExtent2D){j.in_w, j.in_h}, &target, true, &chain,
                                                error, sizeof error));
                assert_ok(masu_bench_chain_run(&chain, &wall, &gpu, error, sizeof error));
                assert_int_equal(masu_bench_chain_count(&chain, MASU_COUNTER_EASU_TILES_EARLY),
                                 want);
                masu_bench_chain_close(&chain);
            }
            masu_headless_target_destroy(&s.host, &target);
            masu_headless_source_destroy(&s.host, &source);
        }
    }
    assert_true(some > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_easu_counts_the_tiles_that_leave_early)};
    return cmocka_run_group_tests(tests, open_group, close_group);
}
