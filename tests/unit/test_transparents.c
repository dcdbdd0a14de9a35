/* test_transparents.c: the order of transparent surfaces: by falling distance, equal ones in their
 * original order, for any number. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/random.h"
#include "frame/transparents.h"

enum { MOST = 4096 };

static masu_back_to_front entries[MOST + 1], scratch[MOST + 1];

/* Every item once, and in order; nothing after both arrays was written. */
static void assert_sorted(uint32_t n, const float *keys) {
    static uint8_t seen[MOST];
    const masu_back_to_front guard = {-7, 12345};
    for (uint32_t i = 0; i < n; i++) entries[i] = (masu_back_to_front){keys[i], i};
    entries[n] = scratch[n] = guard;
    const masu_back_to_front *sorted = masu_sort_back_to_front(entries, scratch, n);
    assert_true(sorted == entries || sorted == scratch);
    memset(seen, 0, sizeof seen);
    for (uint32_t i = 0; i < n; i++) {
        assert_true(sorted[i].thing < n && !seen[sorted[i].thing]);
        seen[sorted[i].thing] = 1;
        assert_true(sorted[i].key == keys[sorted[i].thing]);
        if (!i) continue;
        assert_true(sorted[i - 1].key >= sorted[i].key);
        if (sorted[i - 1].key == sorted[i].key) assert_true(sorted[i - 1].thing < sorted[i].thing);
    }
    assert_memory_equal(&entries[n], &guard, sizeof guard);
    assert_memory_equal(&scratch[n], &guard, sizeof guard);
}

static void any_number_is_sorted_and_equal_ones_stay(void **state) {
    (void)state;
    static float keys[MOST];
    uint64_t seed = 3;
    for (uint32_t n = 0; n <= 300; n++) {
        for (uint32_t kinds = 1; kinds < 1000000; kinds *= 40) {
            for (uint32_t i = 0; i < n; i++) keys[i] = (float)support_random_in(&seed, 0, kinds);
            assert_sorted(n, keys);
        }
    }
    for (uint32_t n = MOST - 3; n <= MOST; n++) {
        for (uint32_t i = 0; i < n; i++) keys[i] = (float)support_random_in(&seed, 0, 5000);
        assert_sorted(n, keys);
        for (uint32_t i = 0; i < n; i++) keys[i] = (float)i;
        assert_sorted(n, keys);
    }
    const float odd[] = {0, 3e38f, 0, 1e-45f, INFINITY, 0, INFINITY};
    assert_sorted(7, odd);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_is_sorted_and_equal_ones_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
