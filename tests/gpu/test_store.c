/* test_store.c: values that shaders store (shaders/shared/store.glsl): NaN and infinities become 0
 * and are counted, other values are clamped to the format's range, and nothing is stored outside
 * the image. The macros run with a buffer instead of an image (store.comp), because the handling
 * of infinities in image formats differs by driver. */
#include "support/compute.h"
#include "support/support.h"

#include "store_comp.spv.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { EACH = 10, UNORM = 0, HALF = 1, R32F = 2, TEN = 3, PLACES = 4 };

typedef struct stored {
    float value[4];
    uint32_t bits[4]; /* integers; times stored; replaced */
} stored;

static const float values[][4] = {
    {0.25f, 0.5f, 0.75f, 1.0f},
    {-1.0f, 2.0f, 1e6f, -1e6f},
    {NAN, 0.5f, 0.5f, 0.5f},
    {0.5f, INFINITY, 0.5f, 0.5f},
    {0.5f, 0.5f, -INFINITY, 0.5f},
    {0.5f, 0.5f, 0.5f, NAN},
    {INFINITY, INFINITY, NAN, -NAN},
    {-INFINITY, NAN, INFINITY, 0.0f},
    {-0.0f, 1e-40f, 3.4e38f, -3.4e38f},
    {65504.0f, 65505.0f, 1e5f, 7e4f},
};
enum { COUNT = sizeof values / sizeof *values };

static float sane(float x, float low, float high) {
    return isfinite(x) ? fminf(fmaxf(x, low), high) : 0.0f;
}

/* A driver may flush denormals to 0. */
static void assert_stored(float found, float wanted) {
    if (fabsf(wanted) < FLT_MIN && found == 0.0f) wanted = 0.0f;
    assert_float_equal(found, wanted, 0.0f);
}

static void run(stored out[EACH * COUNT]) {
    memset(out, 0, EACH * COUNT * sizeof *out);
    float given[COUNT][4];
    memcpy(given, values, sizeof given);
    const compute_buffer buffers[] = {{0, given, sizeof given},
                                      {1, out, EACH * COUNT * sizeof *out}};
    compute_run(masu_spv_store_comp, sizeof masu_spv_store_comp, buffers, 2,
                (const uint32_t[4]){COUNT}, 1);
}

static void what_is_not_finite_is_stored_as_0(void **state) {
    (void)state;
    static stored out[EACH * COUNT];
    run(out);
    for (uint32_t i = 0; i < COUNT; i++) {
        const stored *at = &out[EACH * i];
        uint32_t bad = 0, bad_three = 0;
        for (uint32_t c = 0; c < 4; c++) {
            float v = values[i][c];
            bad |= !isfinite(v);
            bad_three |= c < 3 && !isfinite(v);
            assert_stored(at[UNORM].value[c], sane(v, 0.0f, 1.0f));
            assert_stored(at[HALF].value[c], sane(v, -65504.0f, 65504.0f));
            uint32_t ten = at[TEN].bits[0] >> (10 * c) & (c < 3 ? 1023u : 3u);
            assert_int_equal(ten, c < 3 ? (uint32_t)(sane(v, 0.0f, 1.0f) * 1023.0f + 0.5f) : 3u);
        }
        assert_stored(at[R32F].value[0], sane(values[i][0], -3.4e38f, 3.4e38f));
        for (uint32_t k = 0; k < PLACES; k++) assert_int_equal(at[k].bits[1], 1);
        assert_int_equal(at[UNORM].bits[2], bad);
        assert_int_equal(at[HALF].bits[2], bad);
        assert_int_equal(at[R32F].bits[2], !isfinite(values[i][0]));
        assert_int_equal(at[TEN].bits[2], bad_three);
    }
}

static void nothing_is_stored_beside_the_image(void **state) {
    (void)state;
    static stored out[EACH * COUNT];
    run(out);
    for (uint32_t i = 0; i < COUNT; i++) {
        for (uint32_t k = PLACES; k < EACH; k++)
            assert_int_equal(out[EACH * i + k].bits[1], k == PLACES || k == EACH - 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_finite_is_stored_as_0),
        cmocka_unit_test(nothing_is_stored_beside_the_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
