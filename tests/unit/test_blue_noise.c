/* test_blue_noise.c: the tile of tools/generate/make_blue_noise.c has each rank once, and a blue
 * spectrum: dark at the low frequencies, where white noise is as bright as anywhere. Also after a
 * shift modulo the range of values, which shaders/noise/sequence.glsl does from frame to frame. */
#include "blue_noise.h"
#include "shared/masu_shared.h"
#include "support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { N = MASU_BLUE_NOISE_SIZE, TEXELS = N * N, RINGS = N / 2 };

static void value_of(int channel, uint32_t shift, double out[TEXELS]) {
    for (int i = 0; i < TEXELS; i++) {
        uint32_t v = (masu_blue_noise[i] >> 16 * channel & 0xFFFFu) + shift;
        out[i] = (v & 0xFFFFu) / 65536.0;
    }
}

static void white(uint64_t seed, double out[TEXELS]) {
    for (int i = 0; i < TEXELS; i++) out[i] = (i + 0.5) / TEXELS;
    for (int i = TEXELS - 1; i > 0; i--) {
        int k = (int)support_random_in(&seed, 0, (uint64_t)i);
        double t = out[i];
        out[i] = out[k];
        out[k] = t;
    }
}

/* Mean power of each ring of frequencies, cycles per tile; white noise of equal variance has 1. */
static void spectrum(const double value[TEXELS], double ring[RINGS]) {
    static double rows[2][N][N];
    double cosine[N], sine[N], count[RINGS] = {0};
    for (int i = 0; i < N; i++) {
        cosine[i] = cos(2 * 3.14159265358979323846 * i / N);
        sine[i] = sin(2 * 3.14159265358979323846 * i / N);
    }
    for (int y = 0; y < N; y++) {
        for (int u = 0; u < N; u++) {
            double re = 0, im = 0;
            for (int x = 0; x < N; x++) {
                re += value[y * N + x] * cosine[u * x % N];
                im -= value[y * N + x] * sine[u * x % N];
            }
            rows[0][y][u] = re;
            rows[1][y][u] = im;
        }
    }
    memset(ring, 0, RINGS * sizeof *ring);
    for (int u = 0; u < N; u++) {
        for (int v = 0; v < N; v++) {
            double re = 0, im = 0;
            for (int y = 0; y < N; y++) {
                double c = cosine[v * y % N], s = sine[v * y % N];
                re += rows[0][y][u] * c + rows[1][y][u] * s;
                im += rows[1][y][u] * c - rows[0][y][u] * s;
            }
            int fu = u < N / 2 ? u : N - u, fv = v < N / 2 ? v : N - v;
            int at = (int)(hypot(fu, fv) + 0.5);
            if (!at || at >= RINGS) continue;
            ring[at] += re * re + im * im;
            count[at] += 1;
        }
    }
    /* TEXELS values at even steps of 0..1 have the variance 1/12. */
    for (int r = 1; r < RINGS; r++) ring[r] *= 12 / (count[r] * TEXELS);
}

static double band(const double ring[RINGS], int from, int to) {
    double sum = 0;
    for (int r = from; r <= to; r++) sum += ring[r];
    return sum / (to - from + 1);
}

_Static_assert(sizeof masu_blue_noise / sizeof *masu_blue_noise == MASU_BLUE_NOISE_WORDS,
               "the shaders read the whole table");

static void each_rank_stands_once(void **state) {
    (void)state;
    for (int c = 0; c < 2; c++) {
        static uint8_t seen[TEXELS];
        memset(seen, 0, sizeof seen);
        for (int i = 0; i < TEXELS; i++) {
            uint32_t v = masu_blue_noise[i] >> 16 * c & 0xFFFFu;
            assert_int_equal(v % 16, 8);
            assert_int_equal(seen[v / 16]++, 0);
        }
    }
}

static void it_is_blue(void **state) {
    (void)state;
    static double value[TEXELS];
    double ring[RINGS];
    print_message("  mean power, white noise 1; cycles in 64 texels\n");
    print_message("  %-26s %9s %9s %9s %9s\n", "", "1-4", "5-8", "9-16", "17-31");
    for (int c = 0; c < 2; c++) {
        value_of(c, 0, value);
        spectrum(value, ring);
        print_message("  channel %d                  %9.5f %9.5f %9.4f %9.3f\n", c,
                      band(ring, 1, 4), band(ring, 5, 8), band(ring, 9, 16), band(ring, 17, 31));
        assert_true(band(ring, 1, 4) < 0.001 && band(ring, 5, 8) < 0.005);
        assert_true(band(ring, 9, 16) < 0.05);
        double low = 0, middle = 0;
        for (uint32_t k = 1; k <= 16; k++) {
            value_of(c, k * (c ? 0x91E1u : 0xC13Fu), value);
            spectrum(value, ring);
            low = fmax(low, band(ring, 1, 8));
            middle = fmax(middle, band(ring, 9, 16));
        }
        print_message("    worst of 16 shifts       %19.5f %9.4f\n", low, middle);
        assert_true(low < 0.1 && middle < 0.5);
    }
    white(3, value);
    spectrum(value, ring);
    print_message("  a permutation at random    %9.5f %9.5f %9.4f %9.3f\n", band(ring, 1, 4),
                  band(ring, 5, 8), band(ring, 9, 16), band(ring, 17, 31));
    /* So the bounds above distinguish the two. */
    assert_true(band(ring, 1, 4) > 0.5 && band(ring, 5, 8) > 0.7);
}

static void channels_do_not_know_each_other(void **state) {
    (void)state;
    double sum = 0;
    for (int i = 0; i < TEXELS; i++) {
        double a = (masu_blue_noise[i] & 0xFFFFu) / 65536.0 - 0.5;
        double b = (masu_blue_noise[i] >> 16) / 65536.0 - 0.5;
        sum += 12 * a * b / TEXELS;
    }
    print_message("  correlation of the channels %.4f\n", sum);
    assert_true(fabs(sum) < 0.05); /* three standard deviations */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_rank_stands_once),
                                       cmocka_unit_test(it_is_blue),
                                       cmocka_unit_test(channels_do_not_know_each_other)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
