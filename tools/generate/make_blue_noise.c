/* make_blue_noise.c: generates a tile of blue noise with two channels, as a C header on stdout.
 * Runs during the build; the result is the same with every compiler.
 *
 * Each channel contains every rank 0..4095 once. At every threshold the texels below it are as far
 * apart as possible (Ulichney, "The void-and-cluster method for dither array generation", SPIE
 * 1913, 1993). A texel is a 32-bit value with channel 0 in its lower half and channel 1 in its
 * upper half, each (rank + 1/2) / 4096 of 65536. shaders/noise/sequence.glsl reads it.
 *
 * Energies are integers: their sums and differences are exact, so that nothing depends on the order
 * of rounding. Exact sums also make the method's third phase unnecessary: the energies of set and
 * unset texels have the same sum everywhere, so the tightest cluster of unset texels is the largest
 * void of set ones. */
#include "shared/masu_shared.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = MASU_BLUE_NOISE_SIZE, TEXELS = N * N, START = TEXELS / 10, SWAPS = 100 * START };

/* Ulichney's 1.5. The common 1.9 leaves three times as much energy between an eighth and a quarter
 * of the sampling rate; 1.3 half again as much in the lowest frequencies. */
#define SIGMA 1.5

static uint32_t weight[N][N]; /* by distance, on the torus of the tile */

typedef struct pattern {
    uint8_t set[TEXELS];
    uint32_t energy[TEXELS];
} pattern;

static void make_weights(void) {
    for (int y = 0; y < N; y++) {
        for (int x = 0; x < N; x++) {
            int dx = x < N / 2 ? x : N - x, dy = y < N / 2 ? y : N - y;
            weight[y][x] =
                (uint32_t)(exp(-(dx * dx + dy * dy) / (2 * SIGMA * SIGMA)) * 16777216 + 0.5);
        }
    }
}

static void put(pattern *p, int at, int set) {
    p->set[at] = (uint8_t)set;
    for (int y = 0; y < N; y++) {
        const uint32_t *row = weight[(y - at / N) & (N - 1)];
        uint32_t *energy = &p->energy[y * N];
        for (int x = 0; x < N; x++) {
            uint32_t w = row[(x - at % N) & (N - 1)];
            energy[x] += set ? w : 0 - w;
        }
    }
}

/* The set texel with the most energy, or the unset texel with the least. */
static int extreme(const pattern *p, int set) {
    int best = -1;
    for (int i = 0; i < TEXELS; i++) {
        if (p->set[i] != set) continue;
        if (best < 0 || (set ? p->energy[i] > p->energy[best] : p->energy[i] < p->energy[best]))
            best = i;
    }
    return best;
}

static uint32_t scramble(uint32_t *seed) {
    uint32_t x = *seed += 0x9E3779B9u;
    x = (x ^ x >> 16) * 0x85EBCA6Bu;
    x = (x ^ x >> 13) * 0xC2B2AE35u;
    return x ^ x >> 16;
}

/* Returns 0 if the initial pattern does not converge, which does not happen. */
static int make_channel(uint32_t seed, uint32_t rank[TEXELS]) {
    static pattern p, start;
    memset(&p, 0, sizeof p);
    for (int i = 0; i < START;) {
        int at = (int)(scramble(&seed) % TEXELS);
        if (p.set[at]) continue;
        put(&p, at, 1);
        i++;
    }
    int swaps = 0;
    for (; swaps < SWAPS; swaps++) {
        int from = extreme(&p, 1);
        put(&p, from, 0);
        int to = extreme(&p, 0);
        put(&p, to, 1);
        if (to == from) break;
    }
    if (swaps == SWAPS) return 0;
    start = p;
    for (uint32_t r = START; r-- > 0;) {
        int at = extreme(&p, 1);
        rank[at] = r;
        put(&p, at, 0);
    }
    p = start;
    for (uint32_t r = START; r < TEXELS; r++) {
        int at = extreme(&p, 0);
        rank[at] = r;
        put(&p, at, 1);
    }
    return 1;
}

int main(void) {
    static uint32_t rank[2][TEXELS];
    make_weights();
    for (uint32_t k = 0; k < 2; k++) {
        if (!make_channel(k + 1, rank[k])) {
            fprintf(stderr, "make_blue_noise: channel %u: no rest after %d swaps\n", k, SWAPS);
            return EXIT_FAILURE;
        }
    }
    printf("/* Made by tools/generate/make_blue_noise.c. */\n#include <stdint.h>\n"
           "static const uint32_t masu_blue_noise[] = {\n");
    const uint32_t step = 65536 / TEXELS;
    for (int i = 0; i < TEXELS; i++) {
        uint32_t low = rank[0][i] * step + step / 2, high = rank[1][i] * step + step / 2;
        printf("0x%08x,%s", low | high << 16, i % 8 == 7 ? "\n" : " ");
    }
    printf("};\n");
    return fflush(stdout) || ferror(stdout) ? EXIT_FAILURE : EXIT_SUCCESS;
}
