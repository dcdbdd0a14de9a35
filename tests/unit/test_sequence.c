/* test_sequence.c: shaders/noise/sequence.glsl, compiled as C: integration error of GGX reflections
 * (shaders/brdf/vndf.glsl), compared with white noise and Owen-scrambled Sobol points, over frames
 * and over pixels; and the sequence is as uniform after 1e9 frames as before. */
#include "blue_noise.h"
#include "support/floats.h"
#include "support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "reference/glsl.h"
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#include "brdf/vndf.glsl"
#include "noise/sequence.glsl"
#pragma GCC diagnostic pop
#undef uint
#undef sqrt

enum { TILE = MASU_BLUE_NOISE_SIZE, TEXELS = MASU_BLUE_NOISE_WORDS, FRAMES = 64, PIXELS = 128 };

/* ---- Sequences for comparison ---------------------------------------------------------------- */

static uint32_t reversed(uint32_t x) {
    uint32_t r = 0;
    for (int i = 0; i < 32; i++, x >>= 1) r = r << 1 | (x & 1);
    return r;
}

/* Owen's scrambling by a hash (Laine and Karras 2011, constants of Burley, JCGT 9-4, 2020). */
static uint32_t owen(uint32_t x, uint32_t seed) {
    x = reversed(x) + seed;
    x ^= x * 0x6C50B47Cu;
    x ^= x * 0xB82F1E52u;
    x ^= x * 0xC7AFE638u;
    x ^= x * 0x8D22F6E6u;
    return reversed(x);
}

static vec2 unit2(uint32_t x, uint32_t y) {
    return vec2((float)(x >> 8) / 16777216.0f, (float)(y >> 8) / 16777216.0f);
}

static void sobol(uint32_t i, uint32_t out[2]) {
    out[0] = reversed(i);
    out[1] = 0;
    for (uint32_t v = 1u << 31; i; i >>= 1, v ^= v >> 1) {
        if (i & 1) out[1] ^= v;
    }
}

static vec2 by_white(uint32_t texel, uint32_t frame) {
    uint32_t h = masu_hash(texel * 2654435769u + 1 + masu_hash(frame + 77));
    return unit2(h, masu_hash(h + 0x9E3779B9u));
}

static vec2 by_sobol(uint32_t texel, uint32_t frame) {
    uint32_t p[2], seed = masu_hash(texel + 1);
    sobol(frame, p);
    return unit2(owen(p[0], seed), owen(p[1], masu_hash(seed + 1)));
}

/* One scramble for all pixels, shifted by blue noise, as is done with R2. */
static vec2 by_sobol_blue(uint32_t texel, uint32_t frame) {
    uint32_t p[2], w = masu_blue_noise[texel];
    sobol(frame, p);
    return unit2(owen(p[0], 0x1234567u) + (w << 16), owen(p[1], 0x89ABCDEu) + (w & 0xFFFF0000u));
}

static vec2 by_r2_white(uint32_t texel, uint32_t frame) {
    return masu_noise2(masu_hash(texel + 1), frame);
}

static vec2 by_r2_blue(uint32_t texel, uint32_t frame) {
    return masu_noise2(masu_blue_noise[texel], frame);
}

/* The numbers of one pixel of a 2x2 quad that is sampled in every fourth frame. */
static vec2 by_turns(uint32_t texel, uint32_t frame) {
    return masu_turn_noise2(masu_blue_noise[texel], frame);
}

static vec2 by_turns_fourth(uint32_t texel, uint32_t frame) { return by_turns(texel, 4 * frame); }

static vec2 by_r2_fourth(uint32_t texel, uint32_t frame) { return by_r2_blue(texel, 4 * frame); }

typedef vec2 sequence(uint32_t texel, uint32_t frame);
enum { WHITE, SOBOL, SOBOL_BLUE, R2_WHITE, R2_BLUE, TURNS, TURNS_FOURTH, R2_FOURTH, KINDS };
static const struct {
    const char *name;
    sequence *next;
} kinds[KINDS] = {{"white noise", by_white},
                  {"Sobol, Owen per pixel", by_sobol},
                  {"Sobol, Owen, blue shift", by_sobol_blue},
                  {"R2, white shift", by_r2_white},
                  {"R2, blue shift", by_r2_blue},
                  {"in order, blue shift", by_turns},
                  {"in order, every fourth", by_turns_fourth},
                  {"R2, every fourth", by_r2_fourth}};

/* ---- Integrands ------------------------------------------------------------------------------ */

/* A room with an edge of light across it: light from beyond a plane, and a little from above. */
typedef struct scene {
    vec3 v, plane;
    float alpha, offset;
    double truth;
} scene;

static const float roughnesses[] = {0.1f, 0.3f, 0.6f, 1};
static const double angles[] = {0, 45, 70, 85};
enum { EDGES = 3, SCENES = 4 * 4 * EDGES };
static scene scenes[SCENES];

static double light(const scene *s, vec2 u) {
    masu_vndf_ray r = masu_vndf_reflect(s->v, s->alpha, u);
    if (!(r.weight > 0)) return 0;
    double from = dot(r.l, s->plane) > s->offset ? 1 : 0.1;
    return (double)r.weight * (from + 0.2 * (double)r.l.z);
}

static int make_scenes(void **state) {
    (void)state;
    uint64_t seed = 11;
    for (int i = 0; i < SCENES; i++) {
        scene *s = &scenes[i];
        double angle = angles[i / EDGES % 4] * 3.14159265358979 / 180;
        float roughness = roughnesses[i / EDGES / 4];
        s->v = vec3(sinf((float)angle), 0, cosf((float)angle));
        s->alpha = masu_alpha(roughness);
        double turn = 6.283185307179586 * (double)(support_random(&seed) >> 40) / 16777216;
        s->plane = vec3(cosf((float)turn), sinf((float)turn), 0);
        /* Through the lobe, off its centre. */
        double beside = (double)(support_random(&seed) >> 40) / 16777216 - 0.5;
        s->offset = -s->v.x * s->plane.x + s->alpha * (float)beside;
        const uint32_t many = 1 << 16;
        for (uint32_t k = 0; k < many; k++) s->truth += light(s, masu_noise2(0, k)) / many;
    }
    return 0;
}

/* ---- Tests ----------------------------------------------------------------------------------- */

/* Relative error of the mean of n frames that begin anywhere, or at 0: RMS over pixels, mean over
 * scenes. */
static void over_frames(int kind, int anywhere, double out[7]) {
    memset(out, 0, 7 * sizeof *out);
    for (int i = 0; i < SCENES; i++) {
        double square[7] = {0};
        uint64_t seed = 5;
        for (int p = 0; p < PIXELS; p++) {
            uint32_t texel = (uint32_t)support_random_in(&seed, 0, TEXELS - 1);
            uint32_t start = (uint32_t)support_random_in(&seed, 0, 1 << 20);
            double sum = 0;
            if (!anywhere) start = 0;
            for (uint32_t n = 1; n <= FRAMES; n++) {
                sum += light(&scenes[i], kinds[kind].next(texel, start + n - 1));
                if (n & (n - 1)) continue;
                int at = 0;
                while (1u << at < n) at++;
                double off = sum / n / scenes[i].truth - 1;
                square[at] += off * off / PIXELS;
            }
        }
        for (int k = 0; k < 7; k++) out[k] += sqrt(square[k]) / SCENES;
    }
}

static void r2_turned_by_blue_noise_has_the_least_error_over_frames(void **state) {
    (void)state;
    static double off[2][KINDS][7];
    print_message("  error in %% of the light of 48 reflections, 128 pixels, after frames\n");
    for (int anywhere = 1; anywhere >= 0; anywhere--) {
        print_message("  %-28s      1      2      4      8     16     32     64\n",
                      anywhere ? "from any frame on" : "from frame 0 on");
        for (int k = 0; k < KINDS; k++) {
            double *o = off[anywhere][k];
            over_frames(k, anywhere, o);
            print_message("    %-26s", kinds[k].name);
            for (int i = 0; i < 7; i++) print_message(" %6.2f", 100 * o[i]);
            print_message("\n");
        }
    }
    for (int i = 2; i < 7; i++) {
        assert_true(off[1][R2_BLUE][i] < 0.75 * off[1][WHITE][i]);
        assert_true(off[1][R2_BLUE][i] < 1.2 * off[1][SOBOL][i]);
    }
    assert_true(off[1][R2_BLUE][6] < 0.45 * off[1][WHITE][6]);
    for (int i = 2; i < 7; i++) {
        assert_true(off[1][TURNS][i] < 1.4 * off[1][R2_BLUE][i]);
        assert_true(off[1][TURNS_FOURTH][i] < 1.25 * off[1][R2_BLUE][i]);
    }
    /* The reason for the other sequence. */
    assert_true(off[1][R2_FOURTH][3] > 1.5 * off[1][TURNS_FOURTH][3]);
}

/* The same after the pixels of the tile are filtered: (1 4 6 4 1)^2 / 256. */
static double over_pixels(int kind, uint32_t frames) {
    static double image[TEXELS];
    static const double binomial[5] = {1, 4, 6, 4, 1};
    double all = 0;
    for (int i = 0; i < SCENES; i += EDGES) {
        uint32_t start = 1000 + 77 * (uint32_t)i;
        for (uint32_t t = 0; t < TEXELS; t++) {
            image[t] = -1;
            for (uint32_t n = 0; n < frames; n++)
                image[t] +=
                    light(&scenes[i], kinds[kind].next(t, start + n)) / frames / scenes[i].truth;
        }
        double square = 0;
        for (int t = 0; t < TEXELS; t++) {
            double sum = 0;
            for (int k = 0; k < 25; k++) {
                int x = (t + k % 5 - 2) & (TILE - 1), y = (t / TILE + k / 5 - 2) & (TILE - 1);
                sum += binomial[k % 5] * binomial[k / 5] / 256 * image[y * TILE + x];
            }
            square += sum * sum / TEXELS;
        }
        all += sqrt(square) * EDGES / SCENES;
    }
    return all;
}

static void r2_turned_by_blue_noise_has_the_least_error_over_pixels(void **state) {
    (void)state;
    double off[KINDS][3];
    print_message("  error in %% after 5x5 pixels are filtered, frames: 1, 4, 16\n");
    for (int k = 0; k < KINDS; k++) {
        for (int i = 0; i < 3; i++) off[k][i] = over_pixels(k, 1u << 2 * i);
        print_message("    %-26s %6.2f %6.2f %6.2f\n", kinds[k].name, 100 * off[k][0],
                      100 * off[k][1], 100 * off[k][2]);
    }
    for (int i = 0; i < 3; i++) {
        assert_true(off[R2_BLUE][i] < off[R2_WHITE][i]);
        assert_true(off[R2_BLUE][i] < off[SOBOL][i]);
        assert_true(off[R2_BLUE][i] < 0.7 * off[WHITE][i]);
    }
}

/* Of any 64 consecutive frames, each of 4x4 squares gets 4, within 2; and numbers are below 1. */
static void numbers_stay_as_even_after_many_frames(void **state) {
    (void)state;
    static const uint32_t starts[] = {0, 1000, 1000000, 100000000, 4000000000u, 0xFFFFFFF0u};
    for (size_t s = 0; s < sizeof starts / sizeof *starts; s++) {
        for (uint32_t t = 0; t < TEXELS; t += 37) {
            int count[16] = {0};
            for (uint32_t n = 0; n < FRAMES; n++) {
                vec2 u = masu_noise2(masu_blue_noise[t], starts[s] + n);
                assert_true(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
                count[(int)(4 * u.x) + 4 * (int)(4 * u.y)]++;
            }
            for (int k = 0; k < 16; k++) assert_in_range(count[k], 2, 6);
        }
    }
    /* They are multiples of 1/g and 1/g^2; only frames 2^32 apart are equal. */
    const double g = 1.32471795724474602596;
    for (uint32_t n = 0; n < 1000000; n += 997) {
        vec2 u = masu_noise2(0, n);
        double off[2] = {fabs((double)u.x - n / g + floor(n / g)),
                         fabs((double)u.y - n / (g * g) + floor(n / (g * g)))};
        for (int k = 0; k < 2; k++) assert_true(fmin(off[k], 1 - off[k]) < 2e-4);
    }
    for (int b = 0; b < 24; b++) {
        vec2 u = masu_noise2(0, 1u << b);
        assert_true(u.x > 0 && u.y > 0);
    }
    /* All bits of both at once: the maximum. */
    vec2 u = masu_noise2(0xFFFFFFFFu, 0);
    assert_true(u.x < 1 && u.y < 1 && u.x > 0.9999f && u.y > 0.9999f);
}

/* One bit of x flips each bit of the hash in half of the cases; a shifted tile is a permutation. */
static void the_hash_mixes(void **state) {
    (void)state;
    static uint32_t turned[32][32];
    uint64_t seed = 3;
    enum { MANY = 4096 };
    memset(turned, 0, sizeof turned);
    for (int i = 0; i < MANY; i++) {
        uint32_t x = (uint32_t)support_random(&seed), h = masu_hash(x);
        for (int b = 0; b < 32; b++) {
            uint32_t change = h ^ masu_hash(x ^ 1u << b);
            for (int k = 0; k < 32; k++) turned[b][k] += change >> k & 1;
        }
    }
    double worst = 0;
    for (int b = 0; b < 32; b++) {
        for (int k = 0; k < 32; k++)
            worst = worst_of(worst, fabs((double)turned[b][k] / MANY - 0.5));
    }
    print_message("  a bit of x flips a bit of the hash with 0.5 +- %.3f\n", worst);
    assert_true(worst < 0.05); /* random error: 4.5 deviations of 0.0078 */
    /* Every texel once, for any key. */
    for (uint32_t key = 0; key < 5; key++) {
        static uint8_t seen[TEXELS];
        memset(seen, 0, sizeof seen);
        for (uint32_t i = 0; i < TEXELS; i++) {
            uint32_t at = masu_noise_index(i % TILE + 640, i / TILE + 1920, key);
            assert_true(at < TEXELS);
            assert_int_equal(seen[at]++, 0);
        }
    }
    assert_int_equal(masu_noise_index(5, 7, 0), 7 * TILE + 5);
}

/* With a cycle of 16 positions, a pixel that is sampled in one of four frames gets all of them
 * within 64 frames, and in each sixteen frames that begin a cycle one of each four. */
static void turns_see_all_places(void **state) {
    (void)state;
    for (uint32_t turn = 0; turn < 4; turn++) {
        for (uint32_t first = 0; first < 1024; first += 64) {
            uint32_t seen = 0, asked = 0;
            for (uint32_t frame = first; frame < first + 64; frame++) {
                if (frame % 16 == 0) asked = 0;
                if ((masu_turn(frame) & 3) != turn) continue;
                seen |= 1u << frame % 16;
                asked |= 1u << frame % 4;
                if (frame % 16 >= 12) assert_int_equal(asked, 15);
            }
            assert_int_equal(seen, 0xFFFF);
        }
    }
    for (uint32_t frame = 0xFFFFFF00u; frame != 256; frame += 4) {
        uint32_t turns = 0;
        for (uint32_t k = 0; k < 4; k++) {
            assert_int_equal(masu_turn(frame + k) / 4, frame / 4);
            turns |= 1u << (masu_turn(frame + k) & 3);
        }
        assert_int_equal(turns, 15);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(r2_turned_by_blue_noise_has_the_least_error_over_frames),
        cmocka_unit_test(r2_turned_by_blue_noise_has_the_least_error_over_pixels),
        cmocka_unit_test(numbers_stay_as_even_after_many_frames),
        cmocka_unit_test(the_hash_mixes),
        cmocka_unit_test(turns_see_all_places),
    };
    return cmocka_run_group_tests(tests, make_scenes, NULL);
}
