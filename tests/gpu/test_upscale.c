/* test_upscale.c: EASU and RCAS on the GPU against the scalar transcription in
 * tests/reference/fsr1.c, through the library's own frame: six kinds of image (nine patterns),
 * ratios from 1 to 2.5, garbage around the valid rectangle. */
#include "support/support.h"

#include "reference/fsr1.h"
#include "reference/patterns.h"
#include "reference/tone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct job {
    uint32_t in_w, in_h, out_w, out_h;
    masu_switch upscale, sharpen;
    float stops;
    masu_easu easu;
    VkFormat format; /* of the source; 0: R8G8B8A8_UNORM, not given to the renderer */
    masu_switch half;
    int shipped; /* not 0: without debug.exact */
} job;

static masu_session s; /* a device without a renderer; each job creates one */

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

/* Runs a job with the source in the corner of a larger image full of `beyond`. */
static void run_gpu(const job *j, const void *texels, uint32_t beyond, uint8_t *out) {
    char error[ERROR_SIZE];
    masu_headless_source source;
    assert_ok(masu_headless_source_of(
        &s.host, j->format ? j->format : VK_FORMAT_R8G8B8A8_UNORM, texels, j->in_w, j->in_h,
        j->in_w + 19, j->in_h + 7, beyond, &source, error, sizeof error));
    masu_desc d = s.desc;
    d.output = (VkExtent2D){j->out_w, j->out_h};
    d.source = (masu_source){source.view, j->in_w, j->in_h, j->format};
    d.half_floats = j->half;
    d.debug.exact = !j->shipped;
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.upscale = j->upscale,
                             .sharpen = j->sharpen,
                             .sharpness = j->stops > 0.0f ? j->stops : -1.0f,
                             .easu = j->easu};
    draw_rungs_of(&s, &d, &out, NULL);
    masu_headless_source_destroy(&s.host, &source);
}

static void reference_of_floats(const job *j, const float *rgb, uint8_t *out) {
    float *result = malloc((size_t)j->out_w * j->out_h * 3 * sizeof *result);
    struct masu_ref_image in = {rgb, j->in_w, j->in_h, 0};
    if (j->easu == MASU_EASU_BILINEAR) {
        masu_ref_bilinear(&in, j->out_w, j->out_h, result);
    } else {
        masu_ref_easu(&in, j->out_w, j->out_h,
                      j->easu == MASU_EASU_FAST ? MASU_REF_FAST : MASU_REF_BIT_TRICK, result);
    }
    masu_ref_to_rgba8(result, j->out_w, j->out_h, out);
    free(result);
}

static void reference_upscale(const job *j, const uint8_t *rgba, uint8_t *out) {
    float *rgb = malloc((size_t)j->in_w * j->in_h * 3 * sizeof *rgb);
    masu_ref_from_rgba8(rgba, j->in_w, j->in_h, 0, rgb);
    reference_of_floats(j, rgb, out);
    free(rgb);
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

/* Ratios: 2, 1.5, 1.3 (not a fraction of small numbers), 2.5, 1, two different ones per axis; from
 * and to one pixel or one column; a smaller output; wider and lower at once. */
static const uint32_t sizes[][4] = {{48, 40, 96, 80},  {64, 36, 96, 54}, {50, 30, 65, 39},
                                    {40, 27, 100, 67}, {53, 31, 53, 31}, {37, 64, 90, 71},
                                    {1, 1, 9, 5},      {7, 3, 1, 1},     {64, 40, 33, 20},
                                    {1, 9, 3, 9},      {31, 50, 78, 20}};

#define SIZES (sizeof sizes / sizeof *sizes)
#define MOST ((size_t)128 * 128 * 4)
#define HALF_STEPS 2 /* of 255, the largest change of EASU by 16-bit floats */

static void is_the_reference_within_one_step(masu_easu easu, const char *name) {
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        uint32_t worst = 0, texels = 0;
        for (size_t i = 0; i < SIZES; i++) {
            job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3], MASU_ON,  MASU_OFF,
                     0,           easu,        0,           MASU_AUTO, 0};
            masu_pattern_fill((enum masu_pattern)pattern, 11 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, i % 2 ? 0xFFFFFFFFu : 0xFF00FF00u, gpu);
            reference_upscale(&j, in, cpu);
            uint32_t d = masu_ref_max_difference_rgba8(gpu, cpu, (size_t)j.out_w * j.out_h);
            if (d > worst) worst = d;
            texels += j.out_w * j.out_h;
        }
        print_message("  %-9s %-12s %6u texels, worst %u/255\n", name,
                      masu_pattern_name((enum masu_pattern)pattern), texels, worst);
        assert_true(worst <= 1);
    }
}

static void easu_is_the_scalar_reference_within_one_step(void **state) {
    (void)state;
    is_the_reference_within_one_step(MASU_EASU_AUTO, "easu");
}

/* Without debug.exact a pixel differs if the last bit decides how straight an edge is. */
typedef struct difference {
    uint32_t worst, pixels, over; /* over: pixels that differ by more than 1/255 */
} difference;

static void add_difference(const uint8_t *a, const uint8_t *b, uint32_t pixels, difference *d) {
    for (uint32_t i = 0; i < pixels; i++) {
        uint32_t most = 0;
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t of = (uint32_t)abs(a[4 * i + c] - b[4 * i + c]);
            if (of > most) most = of;
        }
        if (most > d->worst) d->worst = most;
        d->over += most > 1;
    }
    d->pixels += pixels;
}

static void easu_as_shipped_differs_where_the_last_bit_decides(void **state) {
    (void)state;
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        difference d = {0, 0, 0};
        for (size_t i = 0; i < SIZES; i++) {
            job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3],
                     MASU_ON,     MASU_OFF,    .shipped = 1};
            masu_pattern_fill((enum masu_pattern)pattern, 11 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, i % 2 ? 0xFFFFFFFFu : 0xFF00FF00u, gpu);
            reference_upscale(&j, in, cpu);
            add_difference(gpu, cpu, j.out_w * j.out_h, &d);
        }
        print_message("  easu      %-12s %6u texels, worst %u/255, %u over 1\n",
                      masu_pattern_name((enum masu_pattern)pattern), d.pixels, d.worst, d.over);
        assert_true(d.over <= d.pixels / 100);
    }
}

/* The 2x variant is a separate pass (easu_twice.comp). Odd sizes, one pixel, and sizes that do not
 * fill a workgroup; the image's last row and column use repeated texels. */
static void twice_the_size_is_easu_as_shipped(void **state) {
    (void)state;
    static const uint32_t from[][2] = {{48, 40}, {31, 50}, {7, 3}, {1, 1}, {8, 8}, {64, 57}};
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        difference d = {0, 0, 0};
        for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
            job j = {from[i][0], from[i][1], 2 * from[i][0], 2 * from[i][1],
                     MASU_ON,    MASU_OFF,   .shipped = 1};
            masu_pattern_fill((enum masu_pattern)pattern, 31 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, i % 2 ? 0xFFFFFFFFu : 0xFF00FF00u, gpu);
            reference_upscale(&j, in, cpu);
            add_difference(gpu, cpu, j.out_w * j.out_h, &d);
        }
        print_message("  twice     %-12s %6u texels, worst %u/255, %u over 1\n",
                      masu_pattern_name((enum masu_pattern)pattern), d.pixels, d.worst, d.over);
        assert_true(d.over <= d.pixels / 1000);
    }
}

static void rcas_as_shipped_is_the_scalar_reference_within_one_step(void **state) {
    (void)state;
    static const float stops[] = {0.0f, 0.2f, 1.0f, 2.0f};
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        difference d = {0, 0, 0};
        for (size_t i = 0; i < 4; i++) {
            /* A size of whole workgroups, too. */
            job j = {i ? 61 : 64, i ? 47 : 48, i ? 61 : 64, i ? 47 : 48,
                     MASU_AUTO,   MASU_ON,     stops[i],    .shipped = 1};
            masu_pattern_fill((enum masu_pattern)pattern, 5 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, 0xFFFFFFFFu, gpu);
            reference_rcas(j.out_w, j.out_h, j.stops, in, cpu);
            add_difference(gpu, cpu, j.out_w * j.out_h, &d);
        }
        print_message("  rcas      %-12s worst %u/255\n",
                      masu_pattern_name((enum masu_pattern)pattern), d.worst);
        assert_true(d.worst <= 1);
    }
}

static void fast_easu_is_its_scalar_reference_within_one_step(void **state) {
    (void)state;
    is_the_reference_within_one_step(MASU_EASU_FAST, "easu_fast");
}

static void bilinear_is_its_scalar_reference_within_one_step(void **state) {
    (void)state;
    is_the_reference_within_one_step(MASU_EASU_BILINEAR, "bilinear");
}

static void rcas_is_the_scalar_reference_within_one_step(void **state) {
    (void)state;
    static const float stops[] = {0.0f, 0.2f, 1.0f, 2.0f};
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        uint32_t worst = 0;
        for (size_t i = 0; i < 4; i++) {
            job j = {61, 47,        61,       47, MASU_AUTO, MASU_ON, stops[i], MASU_EASU_AUTO,
                     0,  MASU_AUTO, 0};
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

/* The format between EASU and RCAS. */
typedef enum between { FLOATS, TEN_BITS, BYTES } between;

static void reference_chain(const job *j, const uint8_t *rgba, between held, uint8_t *out) {
    static float rgb[MOST], upscaled[MOST], result[MOST];
    size_t numbers = (size_t)j->out_w * j->out_h * 3;
    masu_ref_from_rgba8(rgba, j->in_w, j->in_h, 0, rgb);
    struct masu_ref_image in = {rgb, j->in_w, j->in_h, 0};
    masu_ref_easu(&in, j->out_w, j->out_h, MASU_REF_BIT_TRICK, upscaled);
    if (held == TEN_BITS) masu_ref_to_ten(upscaled, numbers);
    if (held == BYTES) {
        masu_ref_to_rgba8(upscaled, j->out_w, j->out_h, out);
        masu_ref_from_rgba8(out, j->out_w, j->out_h, 0, upscaled);
    }
    struct masu_ref_image sharpened = {upscaled, j->out_w, j->out_h, 0};
    masu_ref_rcas(&sharpened, exp2f(-j->stops), result);
    masu_ref_to_rgba8(result, j->out_w, j->out_h, out);
}

static void the_chain_is_easu_then_rcas_with_10_bits_between(void **state) {
    (void)state;
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        difference d = {0, 0, 0};
        for (size_t i = 0; i < SIZES; i++) {
            job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3], MASU_ON,   MASU_ON,
                     0.2f,        0,           0,           MASU_AUTO, 0};
            masu_pattern_fill((enum masu_pattern)pattern, 3, j.in_w, j.in_h, in);
            run_gpu(&j, in, 0, gpu);
            reference_chain(&j, in, TEN_BITS, cpu);
            add_difference(gpu, cpu, j.out_w * j.out_h, &d);
        }
        print_message("  chain     %-12s %6u texels, worst %u/255, %u over 1\n",
                      masu_pattern_name((enum masu_pattern)pattern), d.pixels, d.worst, d.over);
        assert_true(d.worst <= 1);
    }
}

/* RCAS amplifies rounding errors before it by up to seven times. */
static void the_chain_is_near_the_one_with_floats_between(void **state) {
    (void)state;
    static uint8_t in[MOST], gpu[MOST], floats[MOST], bytes[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        difference d = {0, 0, 0}, of_bytes = {0, 0, 0};
        for (size_t i = 0; i < SIZES; i++) {
            job j = {sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3], MASU_ON,   MASU_ON,
                     0,           0,           0,           MASU_AUTO, 0};
            masu_pattern_fill((enum masu_pattern)pattern, 3, j.in_w, j.in_h, in);
            run_gpu(&j, in, 0, gpu);
            reference_chain(&j, in, FLOATS, floats);
            reference_chain(&j, in, BYTES, bytes);
            add_difference(gpu, floats, j.out_w * j.out_h, &d);
            add_difference(bytes, floats, j.out_w * j.out_h, &of_bytes);
        }
        print_message("  %-12s %6u texels compared with floats: %5.2f %% with an error over "
                      "1/255, worst %u; with 8 bits %5.2f %%, worst %u\n",
                      masu_pattern_name((enum masu_pattern)pattern), d.pixels,
                      100.0 * d.over / d.pixels, d.worst, 100.0 * of_bytes.over / d.pixels,
                      of_bytes.worst);
        assert_true(d.worst <= of_bytes.worst && d.over <= d.pixels / 1000);
        /* otherwise the comparison proves nothing */
        assert_true(pattern != MASU_PATTERN_PHOTO || of_bytes.over > d.pixels / 4);
    }
}

/* In half floats, too: 1/255 is not one. The output is the nearest step of 8 bits. */
static void constants_of_floats_come_out_as_the_nearest_byte(void **state) {
    (void)state;
    static const uint32_t halves[] = {0, 0x1C04, 0x3800, 0x3C00};
    static const double values[] = {0, 1028.0 / 1024 / 256, 0.5, 1};
    static uint32_t in[20 * 20];
    static uint8_t gpu[MOST];
    for (size_t k = 0; k < 4; k++) {
        for (int easu = MASU_EASU_FULL; easu <= MASU_EASU_BILINEAR; easu++) {
            job j = {20,
                     20,
                     37,
                     41,
                     MASU_ON,
                     MASU_ON,
                     .easu = (masu_easu)easu,
                     .format = VK_FORMAT_R16G16_SFLOAT};
            for (size_t i = 0; i < 20 * 20; i++) in[i] = halves[k] * 0x10001u;
            run_gpu(&j, in, 0, gpu);
            for (uint32_t i = 0; i < j.out_w * j.out_h; i++) {
                if (!(fabs(gpu[4 * i] - 255 * values[k]) <= 0.5 + 1e-6))
                    fail_msg("%g, easu %d: %d", values[k], easu, gpu[4 * i]);
                assert_int_equal(gpu[4 * i + 2], 0);
            }
        }
    }
}

static void flat_pictures_stay_exactly_as_they_are(void **state) {
    (void)state;
    static const uint8_t levels[] = {0, 1, 64, 128, 254, 255};
    static uint8_t in[MOST], gpu[MOST];
    for (size_t i = 0; i < 2 * sizeof levels; i++) {
        job j = {20, 20, 37, 41, MASU_ON, MASU_ON, .shipped = (int)(i / sizeof levels)};
        memset(in, levels[i % sizeof levels], sizeof in);
        run_gpu(&j, in, 0xFF804020u, gpu);
        for (uint32_t k = 0; k < j.out_w * j.out_h; k++) {
            for (uint32_t ch = 0; ch < 3; ch++)
                assert_int_equal(gpu[4 * k + ch], levels[i % sizeof levels]);
        }
    }
}

static void what_lies_beyond_the_valid_rectangle_is_never_read(void **state) {
    (void)state;
    static uint8_t in[MOST], a[MOST], b[MOST];
    for (size_t k = 0; k < 2 * SIZES; k++) {
        const uint32_t *size = sizes[k / 2];
        job j = {size[0], size[1], size[2], size[3], MASU_ON, MASU_ON, .shipped = k % 2};
        masu_pattern_fill(MASU_PATTERN_PHOTO, 1, j.in_w, j.in_h, in);
        run_gpu(&j, in, 0x00000000u, a);
        run_gpu(&j, in, 0xFFFFFFFFu, b);
        assert_int_equal(max_difference(a, b, (size_t)j.out_w * j.out_h * 4), 0);
    }
}

/* ---- Other input formats --------------------------------------------------------------------- */

static void an_input_known_to_have_8_bits_gives_the_same_picture(void **state) {
    (void)state;
    static uint8_t in[MOST], a[MOST], b[MOST];
    for (uint32_t pattern = 0; pattern < MASU_PATTERN_COUNT; pattern++) {
        for (int easu = MASU_EASU_FULL; easu <= MASU_EASU_BILINEAR; easu++) {
            job j = {50, 30, 65, 39, MASU_ON, MASU_ON, 0, (masu_easu)easu, 0, MASU_AUTO, 0};
            masu_pattern_fill((enum masu_pattern)pattern, 4, j.in_w, j.in_h, in);
            run_gpu(&j, in, 0, a);
            j.format = VK_FORMAT_R8G8B8A8_UNORM;
            run_gpu(&j, in, 0, b);
            assert_int_equal(max_difference(a, b, (size_t)j.out_w * j.out_h * 4), 0);
        }
    }
}

/* An sRGB view returns linear values, and these are filtered, as masu.h states. */
static void an_srgb_view_is_filtered_as_the_linear_numbers_it_gives(void **state) {
    (void)state;
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    static float rgb[MOST];
    for (int easu = MASU_EASU_FULL; easu <= MASU_EASU_BILINEAR; easu++) {
        job j = {48,
                 40,
                 96,
                 80,
                 MASU_ON,
                 MASU_OFF,
                 0,
                 (masu_easu)easu,
                 VK_FORMAT_R8G8B8A8_SRGB,
                 MASU_AUTO, 0};
        masu_pattern_fill(MASU_PATTERN_PHOTO, 1, j.in_w, j.in_h, in);
        for (uint32_t i = 0; i < j.in_w * j.in_h; i++) {
            for (uint32_t c = 0; c < 3; c++) 
                rgb[3 * i + c] = (float)masu_ref_srgb_decode(in[4 * i + c] / 255.0);
        }
        run_gpu(&j, in, 0, gpu);
        reference_of_floats(&j, rgb, cpu);
        uint32_t off = masu_ref_max_difference_rgba8(gpu, cpu, (size_t)j.out_w * j.out_h);
        print_message("  easu %d: error of %u\n", easu, off);
        /* decoded and filtered by a sampler: an NVIDIA H200 has an error of 3 */
        assert_true(off <= (on_gpu(&s) ? 3u : 1u));
        reference_upscale(&j, in, cpu); /* and not equal to filtered bytes */
        assert_true(masu_ref_max_difference_rgba8(gpu, cpu, (size_t)j.out_w * j.out_h) > 20);
    }
}

/* 0, or a number from 1/64 to 1 that a half float represents. */
static uint32_t half_of(float v) {
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return v > 0.0f ? (bits >> 13) - (112u << 10) : 0;
}

/* Whether an output pixel reads an input texel: the 12 taps are within 4x4. */
static int looks_at(const job *j, int x, int y, int bad_x, int bad_y) {
    if (x < 0 || y < 0 || x >= (int)j->out_w || y >= (int)j->out_h) return 0;
    double fx = floor((x + 0.5) * j->in_w / j->out_w - 0.5);
    double fy = floor((y + 0.5) * j->in_h / j->out_h - 0.5);
    return bad_x >= fx - 1 && bad_x <= fx + 2 && bad_y >= fy - 1 && bad_y <= fy + 2;
}

/* NaN, infinities and numbers out of range, as 16-bit floats: they are read as 0 or 1, and affect
 * only the taps of EASU and, sharpened, the cross of RCAS around them. */
static void assert_footprint(masu_switch half) {
    static const uint32_t bad[] = {0x7E00, 0xFE01, 0x7C00, 0xFC00, 0xC500, 0x70E2, 0x8001};
    static const float counts_as[] = {0, 0, 0, 0, 0, 1, 0};
    static uint32_t in[32 * 24];
    static float rgb[32 * 24 * 3];
    static uint8_t base[MOST], gpu[MOST], cpu[MOST];
    for (int easu = MASU_EASU_FULL; easu <= MASU_EASU_BILINEAR; easu++) {
        if (half == MASU_ON && easu == MASU_EASU_BILINEAR) continue;
        for (int sharpen = 0; sharpen < 2; sharpen++) {
            job j = {32,
                     24,
                     76,
                     60,
                     MASU_ON,
                     sharpen ? MASU_ON : MASU_OFF,
                     0,
                     (masu_easu)easu,
                     VK_FORMAT_R16G16_SFLOAT,
                     half, 0};
            j.shipped = sharpen;
            for (uint32_t i = 0; i < 32 * 24; i++) {
                /* Half of the image is flat: fast EASU exits early there. */
                float v = i % 32 < 16 ? 0.5f : (float)(masu_pattern_hash(i) % 64) / 64.0f;
                in[i] = half_of(v) * 0x10001u;
                rgb[3 * i] = rgb[3 * i + 1] = v;
                rgb[3 * i + 2] = 0.0f;
            }
            run_gpu(&j, in, 0x7E007E00u, base);
            for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
                int x = k % 2 ? 7 : 22, y = 11, touched = 0;
                uint32_t good = in[y * 32 + x];
                in[y * 32 + x] = bad[k] * 0x10001u;
                run_gpu(&j, in, 0x7E007E00u, gpu);
                in[y * 32 + x] = good;
                for (int o = 0; o < 76 * 60; o++) {
                    int ox = o % 76, oy = o / 76, may = looks_at(&j, ox, oy, x, y);
                    if (sharpen) {
                        may |= looks_at(&j, ox - 1, oy, x, y) | looks_at(&j, ox + 1, oy, x, y) |
                               looks_at(&j, ox, oy - 1, x, y) | looks_at(&j, ox, oy + 1, x, y);
                    }
                    int differs = memcmp(gpu + 4 * o, base + 4 * o, 4) != 0;
                    touched += differs;
                    if (differs && !may) fail_msg("%zu: pixel %d, %d has changed", k, ox, oy);
                }
                assert_true(touched > 0);
                if (sharpen) continue;
                float *texel = &rgb[3 * (y * 32 + x)], was = texel[0];
                texel[0] = texel[1] = counts_as[k];
                reference_of_floats(&j, rgb, cpu);
                texel[0] = texel[1] = was;
                uint32_t d = masu_ref_max_difference_rgba8(gpu, cpu, 76 * 60);
                assert_true(d <= (half == MASU_ON ? HALF_STEPS : 1));
            }
        }
    }
}

static void a_bad_texel_stays_within_its_footprint(void **state) {
    (void)state;
    assert_footprint(MASU_AUTO);
    if (s.host.float16) assert_footprint(MASU_ON);
}

/* ---- Floats of 16 bits ----------------------------------------------------------------------- */

static void halves_change_easu_by_this_much(void **state) {
    (void)state;
    static uint8_t in[MOST], gpu[MOST], cpu[MOST];
    if (!s.host.float16) {
        print_message("  no shaderFloat16\n");
        masu_desc d = s.desc;
        masu_memory need;
        masu_detail detail;
        d.source = (masu_source){(VkImageView)(uintptr_t)1, 8, 8, 0};
        d.rung_count = 1;
        d.half_floats = MASU_ON;
        for (int easu = MASU_EASU_FULL; easu <= MASU_EASU_FAST; easu++) {
            d.rungs[0] = (masu_rung){.upscale = MASU_ON, .easu = (masu_easu)easu};
            assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_ERROR_DEVICE);
            assert_string_equal(detail.what, "vulkan.shader_float16");
        }
        d.rungs[0].easu = MASU_EASU_BILINEAR;
        assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_OK);
        return;
    }
    for (uint32_t k = 0; k < 2 * MASU_PATTERN_COUNT; k++) {
        enum masu_pattern pattern = (enum masu_pattern)(k % MASU_PATTERN_COUNT);
        masu_easu easu = k < MASU_PATTERN_COUNT ? MASU_EASU_FAST : MASU_EASU_FULL;
        uint32_t worst = 0;
        double sum = 0, count = 0;
        for (size_t i = 0; i < SIZES; i++) {
            job j = {sizes[i][0], sizes[i][1], sizes[i][2],
                     sizes[i][3], MASU_ON,     MASU_OFF,
                     0,           easu,        i % 2 ? VK_FORMAT_R8G8B8A8_UNORM : 0,
                     MASU_ON,   1};
            masu_pattern_fill(pattern, 11 + (uint32_t)i, j.in_w, j.in_h, in);
            run_gpu(&j, in, 0, gpu);
            /* Decisions use 32 bits in both: full EASU finds the same edges. */
            j.half = MASU_OFF;
            run_gpu(&j, in, 0, cpu);
            for (size_t p = 0; p < (size_t)j.out_w * j.out_h * 4; p++) {
                uint32_t d = (uint32_t)abs(gpu[p] - cpu[p]);
                worst = d > worst ? d : worst;
                sum += (double)d * d;
            }
            count += 3.0 * j.out_w * j.out_h;
        }
        print_message("  halves    %-4s %-12s rms %.2f, worst %u/255\n",
                      easu == MASU_EASU_FAST ? "fast" : "full", masu_pattern_name(pattern),
                      sqrt(sum / count), worst);
        assert_true(worst <= HALF_STEPS && sqrt(sum / count) < 0.75);
        assert_true(pattern != MASU_PATTERN_FLAT || worst == 0);
        /* otherwise it was not in half floats */
        assert_true(pattern != MASU_PATTERN_PHOTO || worst > 0);
    }
}

/* ---- Tiles with an early exit ---------------------------------------------------------------- */

static void a_scene_says_how_many_tiles_left_early(void **state) {
    (void)state;
    enum { W = 120, H = 72, TILES = W / 8 * (H / 8) };
    static uint8_t pixels[3][W * H * 4];
    masu_session scene;
    masu_session_desc d = test_desc("spheres", W, H);
    uint64_t early[3];
    d.desc.rung_count = 3;
    for (int r = 0; r < 3; r++) {
        d.desc.rungs[r] = (masu_rung){
            .scale = 0.5f, .sharpen = MASU_OFF, .easu = (masu_easu)(MASU_EASU_FULL + r)};
    }
    open_session(&scene, &d);
    for (uint32_t r = 0; r < 3; r++) {
        masu_frame_desc frame = {.rung = r};
        masu_commands commands;
        masu_stats_info stats;
        draw(&scene, &frame, &commands, pixels[r]);
        assert_int_equal(masu_stats(scene.m, commands.slot, &stats, NULL), MASU_OK);
        early[r] = stats.easu_tiles_early;
    }
    close_session(&scene);
    uint32_t alike = 0; /* tiles in which fast EASU is bilinear */
    for (uint32_t t = 0; t < TILES; t++) {
        int same = 1;
        for (uint32_t y = t / (W / 8) * 8, row = 0; row < 8; row++) {
            size_t at = 4 * ((size_t)(y + row) * W + t % (W / 8) * 8);
            same &= !memcmp(pixels[1] + at, pixels[2] + at, 32);
        }
        alike += (uint32_t)same;
    }
    print_message("  %u of %u tiles left early, %u are bilinear\n", (unsigned)early[1],
                  (unsigned)TILES, alike);
    assert_int_equal(early[0], 0);
    assert_int_equal(early[2], 0);
    assert_in_range(early[1], 1, alike);
    assert_true(early[1] < TILES);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(easu_is_the_scalar_reference_within_one_step),
        cmocka_unit_test(fast_easu_is_its_scalar_reference_within_one_step),
        cmocka_unit_test(bilinear_is_its_scalar_reference_within_one_step),
        cmocka_unit_test(rcas_is_the_scalar_reference_within_one_step),
        cmocka_unit_test(easu_as_shipped_differs_where_the_last_bit_decides),
        cmocka_unit_test(twice_the_size_is_easu_as_shipped),
        cmocka_unit_test(rcas_as_shipped_is_the_scalar_reference_within_one_step),
        cmocka_unit_test(the_chain_is_easu_then_rcas_with_10_bits_between),
        cmocka_unit_test(the_chain_is_near_the_one_with_floats_between),
        cmocka_unit_test(constants_of_floats_come_out_as_the_nearest_byte),
        cmocka_unit_test(flat_pictures_stay_exactly_as_they_are),
        cmocka_unit_test(what_lies_beyond_the_valid_rectangle_is_never_read),
        cmocka_unit_test(an_input_known_to_have_8_bits_gives_the_same_picture),
        cmocka_unit_test(an_srgb_view_is_filtered_as_the_linear_numbers_it_gives),
        cmocka_unit_test(a_bad_texel_stays_within_its_footprint),
        cmocka_unit_test(halves_change_easu_by_this_much),
        cmocka_unit_test(a_scene_says_how_many_tiles_left_early),
    };
    return cmocka_run_group_tests_name("upscale", tests, open_group, close_group);
}
