/* test_arena.c: the layout walk of the host block. The counting walk and the assigning walk must
 * agree exactly; a block that is too small by any amount must be rejected with the full
 * requirement; no byte outside the block may change. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/arena.h"
#include "support/random.h"

#define ROWS_MOST (MASU_ARENA_ROWS + 4u) /* more than the report has room for */
#define ROWS_RANDOM 20u
#define BLOCK_BYTES (64u << 10)
#define GUARD_BYTES 256u
#define NOISE 0xA5
#define CANARY 0x5A

typedef struct row {
    uint64_t count, element_bytes, alignment;
} row;

typedef struct row_set {
    row rows[ROWS_MOST];
    uint32_t count;
} row_set;

static const char *const row_names[ROWS_MOST] = {
    "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l",
    "m", "n", "o", "p", "q", "r", "s", "t", "u", "v", "w", "x",
    "y", "z", "a2", "b2", "c2", "d2", "e2", "f2", "g2", "h2", "i2", "j2",
    "k2", "l2", "m2", "n2", "o2", "p2", "q2", "r2", "s2", "t2", "u2", "v2", "w2", "x2", "y2", "z2",
    "a3", "b3", "c3", "d3", "e3", "f3", "g3", "h3", "i3", "j3", "k3", "l3"};
_Static_assert(ROWS_MOST <= 64, "names");

/* guard | block | guard; the block starts at a multiple of MASU_ARENA_ALIGNMENT. */
static _Alignas(64) unsigned char memory[GUARD_BYTES + BLOCK_BYTES + GUARD_BYTES];
static unsigned char *const block = memory + GUARD_BYTES;

static row_set random_rows(uint64_t seed) {
    static const uint64_t sizes[] = {1, 2, 4, 8, 12, 16, 48, 57, 100, 640};
    row_set set = {.count = 0};
    uint32_t n = (uint32_t)support_random_in(&seed, 1, ROWS_RANDOM);
    for (; set.count < n; set.count++) {
        uint64_t count = support_random(&seed) % 5 ? support_random(&seed) % 40 : 0;
        set.rows[set.count] =
            (row){count, sizes[support_random(&seed) % (sizeof sizes / sizeof *sizes)],
                  (uint64_t)1 << support_random(&seed) % 7};
    }
    return set;
}

/* Walks the set; pointers may be NULL. */
static void walk(masu_arena *arena, const row_set *set, void *base, uint64_t size,
                 unsigned char **pointers) {
    masu_arena_begin(arena, base, size);
    for (uint32_t i = 0; i < set->count; i++) {
        const row *r = &set->rows[i];
        void *p = masu_arena_alloc(arena, row_names[i], r->count, r->element_bytes, r->alignment);
        if (pointers) pointers[i] = p;
    }
}

static uint64_t need_of(const row_set *set) {
    masu_arena arena;
    walk(&arena, set, NULL, 0, NULL);
    return arena.used;
}

static void fill_memory(uint64_t size) {
    memset(memory, CANARY, sizeof memory);
    memset(block, NOISE, (size_t)size);
}

static void assert_only_the_block_changed(uint64_t size) {
    for (size_t i = 0; i < sizeof memory; i++) {
        if (i < GUARD_BYTES || i >= GUARD_BYTES + size) assert_int_equal(memory[i], CANARY);
    }
}

static void counting_and_giving_agree_to_the_byte(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        row_set set = random_rows(seed);
        masu_arena counted, given;
        unsigned char *pointers[ROWS_MOST];
        walk(&counted, &set, NULL, 0, pointers);
        for (uint32_t i = 0; i < set.count; i++) assert_null(pointers[i]);
        assert_true(counted.used <= BLOCK_BYTES);
        fill_memory(counted.used);
        walk(&given, &set, block, counted.used, pointers);
        assert_true(given.used <= given.size);
        assert_int_equal(given.used, counted.used);
        assert_int_equal(given.row_count, counted.row_count);
        assert_memory_equal(given.rows, counted.rows, sizeof given.rows);
        uint64_t end = 0; /* rows are contiguous, with gaps smaller than an alignment */
        for (uint32_t i = 0; i < set.count; i++) {
            const row *r = &set.rows[i];
            assert_non_null(pointers[i]);
            uint64_t offset = (uint64_t)(pointers[i] - block);
            assert_in_range(offset, end, end + r->alignment - 1);
            end = offset + r->count * r->element_bytes;
        }
        assert_int_equal(end, counted.used);
        assert_only_the_block_changed(counted.used);
    }
}

static void a_block_that_is_too_small_is_told_the_whole_need(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        row_set set = random_rows(seed);
        uint64_t need = need_of(&set);
        if (need < 8) continue;
        const uint64_t sizes[] = {need - 1, need - 8, need / 2, 0};
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            masu_arena arena;
            unsigned char *pointers[ROWS_MOST];
            fill_memory(sizes[i]);
            walk(&arena, &set, block, sizes[i], pointers);
            assert_false(arena.used <= arena.size);
            assert_int_equal(arena.used, need);
            assert_only_the_block_changed(sizes[i]);
            for (uint32_t k = 0; k < set.count; k++) {
                if (!pointers[k]) continue;
                uint64_t bytes = set.rows[k].count * set.rows[k].element_bytes;
                assert_true((uint64_t)(pointers[k] - block) + bytes <= sizes[i]);
            }
        }
    }
}

static void every_size_below_the_need_fails_and_the_need_passes(void **state) {
    (void)state;
    row_set set = random_rows(7);
    uint64_t need = need_of(&set);
    for (uint64_t size = 0; size <= need + 1; size++) {
        masu_arena arena;
        walk(&arena, &set, block, size, NULL);
        assert_int_equal(arena.used <= arena.size, size >= need);
    }
}

static void every_row_is_aligned(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        row_set set = random_rows(seed);
        masu_arena arena;
        unsigned char *pointers[ROWS_MOST];
        walk(&arena, &set, block, BLOCK_BYTES, pointers);
        for (uint32_t i = 0; i < set.count; i++) {
            assert_non_null(pointers[i]);
            assert_int_equal((uintptr_t)pointers[i] % set.rows[i].alignment, 0);
        }
    }
}

static void what_is_given_is_zero_and_what_is_not_is_left_alone(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        row_set set = random_rows(seed);
        masu_arena arena;
        unsigned char *pointers[ROWS_MOST];
        fill_memory(BLOCK_BYTES);
        walk(&arena, &set, block, BLOCK_BYTES, pointers);
        unsigned char *end = block; /* padding is not written */
        for (uint32_t i = 0; i < set.count; i++) {
            uint64_t bytes = set.rows[i].count * set.rows[i].element_bytes;
            while (end < pointers[i]) assert_int_equal(*end++, NOISE);
            for (uint64_t b = 0; b < bytes; b++) assert_int_equal(*end++, 0);
        }
        while (end < block + BLOCK_BYTES) assert_int_equal(*end++, NOISE);
    }
}

static void nothing_takes_no_bytes_but_has_an_address(void **state) {
    (void)state;
    masu_arena arena;
    masu_arena_begin(&arena, block, 16);
    assert_non_null(masu_arena_alloc(&arena, "all", 16, 1, 1));
    assert_ptr_equal(masu_arena_alloc(&arena, "none", 0, 640, 16), block + 16);
    assert_ptr_equal(masu_arena_alloc(&arena, "empty", 5, 0, 1), block + 16);
    assert_int_equal(arena.used, 16);
    assert_true(arena.used <= arena.size);
    assert_null(masu_arena_alloc(&arena, "one", 1, 1, 1));
    assert_null(masu_arena_alloc(&arena, "none", 0, 1, 1)); /* the block is already used up */
}

static void the_report_keeps_the_first_rows(void **state) {
    (void)state;
    row_set set = {.count = ROWS_MOST};
    for (uint32_t i = 0; i < ROWS_MOST; i++) set.rows[i] = (row){i + 1, 3, 8};
    masu_arena arena;
    walk(&arena, &set, NULL, 0, NULL);
    assert_int_equal(arena.row_count, MASU_ARENA_ROWS);
    uint64_t offset = 0;
    for (uint32_t i = 0; i < MASU_ARENA_ROWS; i++) {
        const masu_arena_row *r = &arena.rows[i];
        assert_string_equal(r->name, row_names[i]);
        assert_int_equal(r->count, i + 1);
        assert_int_equal(r->element_bytes, 3);
        assert_int_equal(r->alignment, 8);
        assert_int_equal(r->offset, offset);
        offset = (offset + 3 * (i + 1) + 7) / 8 * 8;
    }
}

/* A walk in which a product or a sum overflows 64 bits. It must never wrap to a size that fits. */
static void assert_overflows(uint64_t count, uint64_t element_bytes, uint64_t before,
                             uint64_t alignment) {
    masu_arena arena;
    for (int giving = 0; giving < 2; giving++) {
        fill_memory(BLOCK_BYTES);
        masu_arena_begin(&arena, giving ? block : NULL, giving ? BLOCK_BYTES : 0);
        (void)masu_arena_alloc(&arena, "before", before, 1, 1);
        assert_null(masu_arena_alloc(&arena, "too much", count, element_bytes, alignment));
        assert_true(arena.used == UINT64_MAX);
        assert_false(arena.used <= arena.size);
        assert_null(masu_arena_alloc(&arena, "after", 1, 1, 1));
        assert_true(arena.used == UINT64_MAX);
        assert_only_the_block_changed(BLOCK_BYTES);
    }
}

static void a_product_that_overflows_stays_an_overflow(void **state) {
    (void)state;
    assert_overflows(UINT64_MAX, 2, 0, 1);
    assert_overflows(UINT64_MAX / 48 + 1, 48, 0, 16);
    assert_overflows((uint64_t)1 << 32, (uint64_t)1 << 32, 0, 8);
    assert_overflows((uint64_t)1 << 63, 2, 64, 64);
}

static void a_sum_that_overflows_stays_an_overflow(void **state) {
    (void)state;
    assert_overflows(UINT64_MAX - 1, 1, 64, 64);
    assert_overflows(2, 1, UINT64_MAX - 1, 1);
    assert_overflows(UINT64_MAX / 48, 48, 64, 16);
}

static void an_alignment_that_overflows_stays_an_overflow(void **state) {
    (void)state;
    assert_overflows(1, 1, UINT64_MAX - 10, 64);
    assert_overflows(0, 1, UINT64_MAX - 1, 8);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counting_and_giving_agree_to_the_byte),
        cmocka_unit_test(a_block_that_is_too_small_is_told_the_whole_need),
        cmocka_unit_test(every_size_below_the_need_fails_and_the_need_passes),
        cmocka_unit_test(every_row_is_aligned),
        cmocka_unit_test(what_is_given_is_zero_and_what_is_not_is_left_alone),
        cmocka_unit_test(nothing_takes_no_bytes_but_has_an_address),
        cmocka_unit_test(the_report_keeps_the_first_rows),
        cmocka_unit_test(a_product_that_overflows_stays_an_overflow),
        cmocka_unit_test(a_sum_that_overflows_stays_an_overflow),
        cmocka_unit_test(an_alignment_that_overflows_stays_an_overflow),
    };
    return cmocka_run_group_tests_name("arena", tests, NULL, NULL);
}
