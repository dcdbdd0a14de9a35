/* test_smaa_tables.c: the tables of SMAA are identical to its authors', and the library's part is
 * an exact excerpt. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "smaa_area.h"
#include "generate/smaa_tables.h"

#include "reference/patterns.h"
#include "shared/masu_shared.h"

static uint8_t area[MASU_SMAA_AREA_BYTES];

static void the_table_of_areas_is_the_released_one(void **state) {
    (void)state;
    masu_smaa_area_texture(area, 7);
    assert_int_equal(masu_pattern_fnv1a(area, sizeof area), 0x88cfdb8d);
}

static void the_table_of_searches_is_the_released_one(void **state) {
    (void)state;
    static uint8_t search[MASU_SMAA_SEARCH_BYTES];
    masu_smaa_search_texture(search);
    assert_int_equal(masu_pattern_fnv1a(search, sizeof search), 0x0100c405);
}

static uint32_t texel(uint32_t x, uint32_t y) {
    const uint8_t *t = &area[2 * (y * MASU_SMAA_AREA_WIDTH + x)];
    return t[0] | (uint32_t)t[1] << 8;
}

_Static_assert(sizeof masu_smaa_area / sizeof *masu_smaa_area == MASU_SMAA_AREA_WORDS,
               "the shaders read the whole table");

/* Only four of the five edge patterns per side can occur, and of a pattern only the distances that
 * a search can find. */
static void the_library_has_the_part_that_is_looked_up(void **state) {
    (void)state;
    static const uint32_t code[4] = {0, 1, 3, 4};
    masu_smaa_area_texture(area, 1);
    for (uint32_t i = 0; i < MASU_SMAA_STRAIGHT_WORDS; i++) {
        uint32_t l = i % MASU_SMAA_STRAIGHT, r = i / MASU_SMAA_STRAIGHT % MASU_SMAA_STRAIGHT;
        uint32_t cell = i / (MASU_SMAA_STRAIGHT * MASU_SMAA_STRAIGHT);
        uint32_t x = 16 * code[cell % 4] + l, y = 16 * code[cell / 4] + r;
        assert_int_equal(masu_smaa_area[i], texel(x, y) | texel(x + 1, y) << 16);
    }
    for (uint32_t i = 0; i < 16 * MASU_SMAA_DIAGONAL * MASU_SMAA_DIAGONAL; i++) {
        uint32_t l = i % MASU_SMAA_DIAGONAL, r = i / MASU_SMAA_DIAGONAL % MASU_SMAA_DIAGONAL;
        uint32_t cell = i / (MASU_SMAA_DIAGONAL * MASU_SMAA_DIAGONAL);
        uint32_t word = masu_smaa_area[MASU_SMAA_STRAIGHT_WORDS + i / 2] >> 16 * (i % 2) & 0xFFFFu;
        assert_int_equal(word, texel(80 + 20 * (cell % 4) + l, 20 * (cell / 4) + r));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_table_of_areas_is_the_released_one),
        cmocka_unit_test(the_table_of_searches_is_the_released_one),
        cmocka_unit_test(the_library_has_the_part_that_is_looked_up),
    };
    return cmocka_run_group_tests_name("smaa tables", tests, NULL, NULL);
}
