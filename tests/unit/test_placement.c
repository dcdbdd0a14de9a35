/* test_placement.c: memory aliasing of images with disjoint lifetimes. Every result of masu_place
 * must be a valid placement (checked pair by pair and row by row). Over many random sets it must be
 * close to the lower bound, which is checked against a sum taken row by row. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "device/memory.h"
#include "support/random.h"

#define RANDOM_SETS 2000u
#define ITEMS_MOST MASU_IMAGE_COUNT
#define LAST_ROW (MASU_MAX_PASSES - 1)

typedef struct item_set {
    masu_placement items[MASU_MAX_RESOURCES];
    uint32_t count;
} item_set;

/* Like a driver's images: sizes of very different magnitude, each a multiple of its alignment. Each
 * fourth set is of a few bytes, where neighbours touch and miss by one. */
static item_set random_items(uint64_t seed, uint32_t most) {
    static const uint64_t alignments[] = {1, 16, 256, 4096, 65536};
    item_set set;
    memset(&set, 0, sizeof set);
    int tiny = seed % 4 == 0;
    set.count = (uint32_t)support_random_in(&seed, 1, most);
    for (uint32_t i = 0; i < set.count; i++) {
        uint64_t alignment = alignments[support_random(&seed) % (tiny ? 1 : 5)];
        uint64_t magnitude = (uint64_t)1 << (tiny ? 1 : support_random_in(&seed, 4, 24));
        uint32_t first = (uint32_t)support_random_in(&seed, 0, LAST_ROW);
        uint32_t last = (uint32_t)support_random_in(&seed, first, LAST_ROW);
        uint64_t bytes = support_random_in(&seed, magnitude, 2 * magnitude);
        bytes = (bytes + alignment - 1) / alignment * alignment;
        /* The initial value of `offset` must not matter. */
        set.items[i] = (masu_placement){bytes, alignment, first, last, support_random(&seed)};
    }
    return set;
}

static void assert_placement(const item_set *set, uint64_t end, uint64_t seed) {
    uint64_t reached = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        const masu_placement *a = &set->items[i];
        if (a->offset % a->alignment) fail_msg("set %u: item %u is misaligned", (unsigned)seed, i);
        if (a->offset + a->bytes > reached) reached = a->offset + a->bytes;
        for (uint32_t j = 0; j < i; j++) {
            const masu_placement *b = &set->items[j];
            int together = 0;
            for (uint32_t row = 0; row <= LAST_ROW; row++) {
                together |= a->first <= row && row <= a->last && b->first <= row && row <= b->last;
            }
            int apart = a->offset + a->bytes <= b->offset || b->offset + b->bytes <= a->offset;
            if (together && !apart) {
                fail_msg("set %u: items %u and %u share bytes while both are alive", (unsigned)seed,
                         j, i);
            }
        }
    }
    assert_int_equal(end, reached);
}

static uint64_t bound_row_by_row(const item_set *set) {
    uint64_t most = 0;
    for (uint32_t row = 0; row <= LAST_ROW; row++) {
        uint64_t sum = 0;
        for (uint32_t i = 0; i < set->count; i++) {
            if (set->items[i].first <= row && row <= set->items[i].last) sum += set->items[i].bytes;
        }
        if (sum > most) most = sum;
    }
    return most;
}

static void random_sets_are_placed_without_conflict_near_the_bound(void **state) {
    (void)state;
    double ratios = 0.0, worst = 0.0;
    for (uint64_t seed = 1; seed <= RANDOM_SETS; seed++) {
        item_set set = random_items(seed, ITEMS_MOST);
        uint64_t bound = masu_place_lower_bound(set.items, set.count), unaliased = 0;
        for (uint32_t i = 0; i < set.count; i++) {
            unaliased += set.items[i].bytes + set.items[i].alignment - 1;
        }
        uint64_t end = masu_place(set.items, set.count);
        assert_placement(&set, end, seed);
        assert_in_range(end, bound, unaliased);
        double ratio = (double)end / (double)bound;
        ratios += ratio;
        if (ratio > worst) worst = ratio;
    }
    printf("placed / lower bound over %u sets: mean %.4f, worst %.4f\n", RANDOM_SETS,
           ratios / RANDOM_SETS, worst);
    assert_true(ratios / RANDOM_SETS <= 1.15);
}

/* First fit of the largest first: one of the orders that masu_place may try. */
static uint64_t place_by_size(item_set *set) {
    uint64_t end = 0;
    for (uint32_t k = 0; k < set->count; k++) {
        uint32_t largest = k;
        for (uint32_t i = k + 1; i < set->count; i++) {
            if (set->items[i].bytes > set->items[largest].bytes) largest = i;
        }
        masu_placement item = set->items[largest];
        for (uint32_t i = largest; i > k; i--) set->items[i] = set->items[i - 1];
        item.offset = 0;
        for (uint32_t i = 0; i < k;) { /* move above every overlap, until there is none */
            const masu_placement *other = &set->items[i++];
            if (other->first > item.last || item.first > other->last) continue;
            if (other->offset >= item.offset + item.bytes) continue;
            if (item.offset >= other->offset + other->bytes) continue;
            item.offset = other->offset + other->bytes + item.alignment - 1;
            item.offset -= item.offset % item.alignment;
            i = 0;
        }
        set->items[k] = item;
        if (item.offset + item.bytes > end) end = item.offset + item.bytes;
    }
    return end;
}

static void other_orders_than_the_largest_first_are_tried(void **state) {
    (void)state;
    uint32_t better = 0;
    for (uint64_t seed = 1; seed <= RANDOM_SETS; seed++) {
        item_set a = random_items(seed, ITEMS_MOST), b = a;
        uint64_t by_size = place_by_size(&b), placed = masu_place(a.items, a.count);
        assert_placement(&b, by_size, seed);
        assert_true(placed <= by_size);
        better += placed < by_size;
    }
    printf("better than the largest first in %u of %u sets\n", better, RANDOM_SETS);
    assert_true(better > 0);
}

static void the_largest_allowed_sets_are_placed_without_conflict(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 100; seed++) {
        item_set set = random_items(seed << 32, MASU_MAX_RESOURCES);
        uint64_t bound = masu_place_lower_bound(set.items, set.count);
        uint64_t end = masu_place(set.items, set.count);
        assert_placement(&set, end, seed);
        assert_true(end >= bound);
    }
}

static void the_lower_bound_is_the_largest_row(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= RANDOM_SETS; seed++) {
        item_set set = random_items(seed, MASU_MAX_RESOURCES);
        assert_int_equal(masu_place_lower_bound(set.items, set.count), bound_row_by_row(&set));
    }
}

static void the_same_set_is_placed_the_same_way(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        item_set a = random_items(seed, ITEMS_MOST), b = a;
        for (uint32_t i = 0; i < b.count; i++) b.items[i].offset = ~b.items[i].offset;
        assert_int_equal(masu_place(a.items, a.count), masu_place(b.items, b.count));
        for (uint32_t i = 0; i < a.count; i++) {
            assert_int_equal(a.items[i].offset, b.items[i].offset);
        }
    }
}

static void nothing_needs_nothing(void **state) {
    (void)state;
    assert_int_equal(masu_place(NULL, 0), 0);
    assert_int_equal(masu_place_lower_bound(NULL, 0), 0);
}

static void one_item_lies_at_the_start(void **state) {
    (void)state;
    masu_placement item = {100, 64, 3, 3, 999};
    assert_int_equal(masu_place(&item, 1), 100);
    assert_int_equal(item.offset, 0);
    assert_int_equal(masu_place_lower_bound(&item, 1), 100);
}

static void items_that_never_meet_share_the_same_bytes(void **state) {
    (void)state;
    masu_placement items[] = {{100, 4, 0, 1, 0}, {300, 4, 2, 3, 0}, {200, 4, 4, 9, 0}};
    assert_int_equal(masu_place(items, 3), 300);
    for (int i = 0; i < 3; i++) assert_int_equal(items[i].offset, 0);
    assert_int_equal(masu_place_lower_bound(items, 3), 300);
}

static void a_lifetime_includes_its_last_row(void **state) {
    (void)state;
    masu_placement items[] = {{100, 4, 0, 2, 0}, {100, 4, 2, 3, 0}};
    assert_int_equal(masu_place(items, 2), 200);
    assert_int_equal(masu_place_lower_bound(items, 2), 200);
    assert_int_not_equal(items[0].offset, items[1].offset);
}

static void items_that_all_meet_lie_one_behind_the_other(void **state) {
    (void)state;
    masu_placement items[] = {{10, 1, 0, 9, 0}, {20, 1, 3, 5, 0}, {30, 1, 5, 7, 0}};
    assert_int_equal(masu_place(items, 3), 60);
    assert_int_equal(masu_place_lower_bound(items, 3), 60);
}

static void alignment_costs_no_more_than_its_padding(void **state) {
    (void)state;
    masu_placement items[] = {{100, 1, 0, 0, 0}, {50, 64, 0, 0, 0}};
    /* The larger first ends at 128 + 50; the best order, which is not tried, at 150. */
    assert_int_equal(masu_place_lower_bound(items, 2), 150);
    uint64_t end = masu_place(items, 2);
    assert_in_range(end, 150, 178);
    assert_int_equal(items[1].offset % 64, 0);
}

static void a_gap_between_two_items_is_used(void **state) {
    (void)state;
    /* rows      0  1  2
     * a 100     x  x        alive with b and c
     * b 100        x  x     c fits below b only where a has been */
    masu_placement items[] = {{100, 1, 0, 1, 0}, {100, 1, 1, 2, 0}, {100, 1, 2, 2, 0}};
    assert_int_equal(masu_place(items, 3), 200);
    assert_int_equal(items[2].offset, items[0].offset);
    assert_int_equal(masu_place_lower_bound(items, 3), 200);
}

/* The images of the demo's frame at 1920x1080 with polygons and SDF, from scale 1.0 down. */
static void the_frame_of_the_demo_reaches_its_lower_bound(void **state) {
    (void)state;
    const uint64_t texels = 1920 * 1080;
    masu_placement items[] = {
        {4 * texels, 256, 0, 2, 0}, /* albedo: gbuffer to light */
        {4 * texels, 256, 0, 2, 0}, /* normal */
        {4 * texels, 256, 0, 1, 0}, /* depth: to march */
        {4 * texels, 256, 1, 2, 0}, /* scene depth */
        {8 * texels, 256, 2, 4, 0}, /* hdr: light to tonemap */
        {4 * texels, 256, 4, 5, 0}, /* ldr */
        {4 * texels, 256, 5, 6, 0}, /* upscaled */
    };
    uint64_t bound = masu_place_lower_bound(items, 7);
    assert_int_equal(bound, 20 * texels);
    assert_int_equal(masu_place(items, 7), bound);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_sets_are_placed_without_conflict_near_the_bound),
        cmocka_unit_test(other_orders_than_the_largest_first_are_tried),
        cmocka_unit_test(the_largest_allowed_sets_are_placed_without_conflict),
        cmocka_unit_test(the_lower_bound_is_the_largest_row),
        cmocka_unit_test(the_same_set_is_placed_the_same_way),
        cmocka_unit_test(nothing_needs_nothing),
        cmocka_unit_test(one_item_lies_at_the_start),
        cmocka_unit_test(items_that_never_meet_share_the_same_bytes),
        cmocka_unit_test(a_lifetime_includes_its_last_row),
        cmocka_unit_test(items_that_all_meet_lie_one_behind_the_other),
        cmocka_unit_test(alignment_costs_no_more_than_its_padding),
        cmocka_unit_test(a_gap_between_two_items_is_used),
        cmocka_unit_test(the_frame_of_the_demo_reaches_its_lower_bound),
    };
    return cmocka_run_group_tests_name("placement", tests, NULL, NULL);
}
