/* make_smaa_area.c: generates the parts of SMAA's area table that the shaders use, as a C header on
 * stdout. Runs during the build. masu_shared.h describes the layout.
 *
 * These are 15 648 of the table's 179 200 bytes: one subsample; the 4x4 existing of the 5x5
 * patterns; the 10x10 of 16x16 square roots of distances that the longest search reaches; 17x17 of
 * 20x20 distances for diagonals. */
#include "generate/smaa_tables.h"

#include "shared/masu_shared.h"

#include <stdio.h>
#include <stdlib.h>

static uint8_t texels[MASU_SMAA_AREA_BYTES];
static uint32_t words[MASU_SMAA_AREA_WORDS];

static uint32_t texel(int x, int y) {
    const uint8_t *t = &texels[2 * (y * MASU_SMAA_AREA_WIDTH + x)];
    return t[0] | (uint32_t)t[1] << 8;
}

int main(void) {
    static const int code[4] = {0, 1, 3, 4};
    uint32_t n = 0;
    masu_smaa_area_texture(texels, 1);
    for (int cell = 0; cell < 16; cell++) {
        for (int r = 0; r < MASU_SMAA_STRAIGHT; r++) {
            for (int l = 0; l < MASU_SMAA_STRAIGHT; l++) {
                int x = MASU_SMAA_CELL * code[cell % 4] + l,
                    y = MASU_SMAA_CELL * code[cell / 4] + r;
                words[n++] = texel(x, y) | texel(x + 1, y) << 16;
            }
        }
    }
    uint32_t half = 0;
    for (int cell = 0; cell < 16; cell++) {
        for (int r = 0; r < MASU_SMAA_DIAGONAL; r++) {
            for (int l = 0; l < MASU_SMAA_DIAGONAL; l++, half++) {
                int x = 80 + MASU_SMAA_DIAGONAL_CELL * (cell % 4) + l;
                int y = MASU_SMAA_DIAGONAL_CELL * (cell / 4) + r;
                words[n + half / 2] |= texel(x, y) << 16 * (half % 2);
            }
        }
    }
    printf("/* Made by tools/generate/make_smaa_area.c. */\nstatic const uint32_t masu_smaa_area[] "
           "= {\n");
    for (int i = 0; i < MASU_SMAA_AREA_WORDS; i++)
        printf("0x%08x,%s", words[i], i % 8 == 7 ? "\n" : " ");
    printf("};\n");
    return fflush(stdout) || ferror(stdout) ? EXIT_FAILURE : EXIT_SUCCESS;
}
