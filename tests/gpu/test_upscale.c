/* test_upscale.c: EASU and RCAS on the GPU against the scalar transcription in
 * tests/reference/fsr1.c, through the library's own frame: six kinds of picture (nine patterns),
 * ratios from 1 to 2.5, garbage around the valid rectangle. */
#include "support.h"

#include "reference/fsr1.h"
#include "reference/patterns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct job {
    uint32_t in_w, in_h, out_w, out_h;
    masu_switch upscale, sharpen;
    float stops;
} job;

static masu_session s; /* a device without a renderer; each job makes its own */

static int open_device(void **state) {
    (void)state;
    masu_session_desc d = test_desc(NULL, 8, 8);
    d.no_renderer = true;
    open_session(&s, &d);
    return 0;
}

static int close_device(void **state) {
    (void)state;
    close_session(&s);
    return 0;
}

/* Runs a job on pixels in the corner of a larger image full of `beyond`. */
static void run_gpu(const job *j, const uint8_t *rgba, uint32_t beyond, uint8_t *out) {
    char error[ERROR_SIZE];
    masu_headless_source source;
    masu_headless_target target;
    assert_ok(masu_headless_source_create(&s.host, rgba, j->in_w, j->in_h, j->in_w + 19,
                                          j->in_h + 7, beyond, &source, error, sizeof error));
    assert_ok(masu_headless_target_create(&s.host, j->out_w, j->out_h, VK_FORMAT_R8G8B8A8_UNORM,
                                          true, &target, error, sizeof error));
    masu_desc d = s.desc;
    d.output = (VkExtent2D){j->out_w, j->out_h};
    d.targets.images = &target.image;
    d.targets.views = &target.view;
    d.source = (masu_source){source.view, j->in_w, j->in_h};
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.upscale = j->upscale, .sharpen = j->sharpen, .sharpness = j->stops};
    masu_memory need;
    masu_detail detail;
    masu_renderer *m;
    masu_commands commands;
    masu_frame_desc frame = {0};
    if (masu_memory_query(&d, &need, &detail)) fail_msg("%s", detail.text);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    if (masu_init(&d, block, need.host_bytes, &m, &detail)) fail_msg("%s", detail.text);
    assert_int_equal(masu_load(m, &commands), MASU_OK);
    assert_int_equal(masu_frame(m, &frame, &commands), MASU_OK);
    assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    assert_ok(masu_headless_target_read(&s.host, &target, error, sizeof error));
    memcpy(out, target.mapped, (size_t)j->out_w * j->out_h * 4);
    masu_destroy(m);
    free(block);
    masu_headless_target_destroy(&s.host, &target);
    masu_headless_source_destroy(&s.host, &source);
}

static void reference_easu(const job *j, const uint8_t *rgba, uint8_t *out) {
    float *rgb = malloc((size_t)j->in_w * j->in_h * 3 * sizeof *rgb);
    float *result = malloc((size_t)j->out_w * j->out_h * 3 * sizeof *result);
    masu_ref_from_rgba8(rgba, j->in_w, j->in_h, 0, rgb);
    struct masu_ref_image in = {rgb, j->in_w, j->in_h, 0};
    masu_ref_easu(&in, j->out_w, j->out_h, MASU_REF_BIT_TRICK, result);
    masu_ref_to_rgba8(result, j->out_w, j->out_h, out);
    free(rgb);
    free(result);
}

static void reference_rcas(uint32_t width, uint32_t height, float stops, const uint8_t *rgba,
                           uint8_t *out) {
    float *rgb = malloc((size_t)width * height * 3 * sizeof *rgb),
          *result = malloc((size_t)width * height * 3 * sizeof *rgb);
    masu_ref_from_rgba8(rgba, width, height, 0, rgb);
    struct masu_ref_image in = {rgb, width, height, 0};
    masu_ref_rcas(&in, exp2f(-stops), result);
    masu_ref_to_rgba8(result, width, height, out);
    free(rgb);
    free(result);
}

/* Ratios: 2, 1.5, 1.3 (not a fraction of small numbers), 2.5, 1, and two different ones per axis.
 * */
static const uint32_t sizes[][4] = {{48, 40, 96, 80},  {64, 36, 96, 54}, {50, 30, 65, 39},
                                    {40, 27, 100, 67}, {53, 31, 53, 31}, {37, 64, 90, 71},
                                    {1, 1, 9, 5}};

#define SIZES (sizeof sizes / sizeof *sizes)
#define MOST ((size_t)128 * 128 * 4)

static void easu_is_the_scalar_reference_within_one_step(void **state) {
    (void)state;
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        uint32_t worst = 0, texels = 0;
        for (size_t i = 0; i < SIZES; i++) {
            job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3], MASU_ON, MASU_OFF, 0};
            masu_pattern_fill((enum masu_pattern)pattern, 11 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, i % 2 ? 0xFFFFFFFFu : 0xFF00FF00u, gpu);
            reference_easu(&j, in, cpu);
            uint32_t d = masu_ref_max_difference_rgba8(gpu, cpu, (size_t)j.out_w * j.out_h);
            if (d > worst) worst = d;
            texels += j.out_w * j.out_h;
        }
        print_message("  easu  %-12s %6u texels, worst %u/255\n",
                      masu_pattern_name((enum masu_pattern)pattern), texels, worst);
        assert_true(worst <= 1);
    }
}

static void rcas_is_the_scalar_reference_within_one_step(void **state) {
    (void)state;
    static const float stops[] = {0.0f, 0.2f, 1.0f, 2.0f};
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        uint32_t worst = 0;
        for (size_t i = 0; i < 4; i++) {
            job j = {61, 47, 61, 47, MASU_AUTO, MASU_ON, stops[i]};
            masu_pattern_fill((enum masu_pattern)pattern, 5 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, 0xFFFFFFFFu, gpu);
            reference_rcas(j.out_w, j.out_h, j.stops, in, cpu);
            uint32_t d = masu_ref_max_difference_rgba8(gpu, cpu, (size_t)j.out_w * j.out_h);
            if (d > worst) worst = d;
        }
        print_message("  rcas  %-12s worst %u/255\n", masu_pattern_name((enum masu_pattern)pattern),
                      worst);
        assert_true(worst <= 1);
    }
}

/* RCAS can amplify a step of EASU, so the second half of the chain is judged on the GPU's own first
 * half. */
static void the_chain_is_easu_then_rcas(void **state) {
    (void)state;
    static uint8_t in[MOST], easu[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        job j = {50, 30, 65, 39, MASU_AUTO, MASU_OFF, 0.2f};
        masu_pattern_fill((enum masu_pattern)pattern, 3, j.in_w, j.in_h, in);
        run_gpu(&j, in, 0, easu);
        reference_rcas(j.out_w, j.out_h, j.stops, easu, cpu);
        j.sharpen = MASU_AUTO;
        run_gpu(&j, in, 0, gpu);
        assert_true(masu_ref_max_difference_rgba8(gpu, cpu, (size_t)j.out_w * j.out_h) <= 1);
    }
}

static void flat_pictures_stay_exactly_as_they_are(void **state) {
    (void)state;
    static const uint8_t levels[] = {0, 1, 64, 128, 254, 255};
    static uint8_t in[MOST], gpu[MOST];
    for (size_t i = 0; i < sizeof levels; i++) {
        job j = {20, 20, 37, 41, MASU_ON, MASU_ON, 0};
        memset(in, levels[i], sizeof in);
        run_gpu(&j, in, 0xFF804020u, gpu);
        for (uint32_t k = 0; k < j.out_w * j.out_h; k++) {
            for (uint32_t ch = 0; ch < 3; ch++) assert_int_equal(gpu[4 * k + ch], levels[i]);
        }
    }
}

static void what_lies_beyond_the_valid_rectangle_is_never_read(void **state) {
    (void)state;
    static uint8_t in[MOST], a[MOST], b[MOST];
    for (size_t i = 0; i < SIZES; i++) {
        job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3], MASU_ON, MASU_ON, 0};
        masu_pattern_fill(MASU_PATTERN_PHOTO, 1, j.in_w, j.in_h, in);
        run_gpu(&j, in, 0x00000000u, a);
        run_gpu(&j, in, 0xFFFFFFFFu, b);
        assert_int_equal(max_difference(a, b, (size_t)j.out_w * j.out_h * 4), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(easu_is_the_scalar_reference_within_one_step),
        cmocka_unit_test(rcas_is_the_scalar_reference_within_one_step),
        cmocka_unit_test(the_chain_is_easu_then_rcas),
        cmocka_unit_test(flat_pictures_stay_exactly_as_they_are),
        cmocka_unit_test(what_lies_beyond_the_valid_rectangle_is_never_read),
    };
    return cmocka_run_group_tests_name("upscale", tests, open_device, close_device);
}
