/* test_detail.c: LODs in a blob: rejected ones, with their element; the accessor; and the LOD that
 * masu_lod_choose selects. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "scene/lod.h"
#include "reference/scene_walk.h"
#include "scene/scene.h"
#include "support/bind.h"
#include "support/random.h"

static support_blob blob;

#define AT(kind, type) ((type *)support_blob_find(&blob, MASU_BLOB_##kind))
#define LOD AT(LODS, masu_blob_lod)
#define PRIMITIVE AT(PRIMITIVES, masu_blob_primitive)

static void assert_refused(const char *what, uint64_t element, const char *why) {
    masu_scene scene;
    masu_detail detail;
    support_blob_seal(blob.bytes, blob.size);
    if (!support_bind(blob.bytes, blob.size, &scene, &detail)) fail_msg("%s: accepted", why);
    assert_string_equal(detail.what, what);
    assert_int_equal(detail.given, element);
    if (!strstr(detail.text, why)) fail_msg("\"%s\" is not in: %s", why, detail.text);
}

#define REFUSED(what, element, why, ...)                                                           \
    do {                                                                                           \
        support_blob_write(&blob, SUPPORT_ALL | SUPPORT_DETAIL);                                   \
        __VA_ARGS__;                                                                               \
        assert_refused(what, element, why);                                                        \
    } while (0)

static void a_blob_with_detail_is_accepted_and_found(void **state) {
    (void)state;
    masu_scene scene;
    support_blob_write(&blob, SUPPORT_ALL | SUPPORT_DETAIL);
    support_accepted(&blob, &scene);
    assert_int_equal(masu_scene_data_of(&scene)->lods, 1);
    assert_int_equal(masu_scene_data_of(&scene)->draws, 3); /* it adds none */
    assert_int_equal(masu_scene_triangles(&scene), 2 * (2 + 1) + 2);
    assert_null(masu_ref_walk_scene(&scene));
    masu_scene_view view = masu_scene_view_of(&scene);
    uint32_t first;
    assert_int_equal(masu_scene_mesh_lods(&view, masu_scene_data_of(&scene)->lods, 0, &first), 0);
    assert_int_equal(masu_scene_mesh_lods(&view, masu_scene_data_of(&scene)->lods, 1, &first), 1);
    assert_int_equal(view.lods[first].first_primitive, 3);
}

static void a_lod_that_breaks_a_rule_is_refused(void **state) {
    (void)state;
    REFUSED("lods", 0, "no such mesh", LOD->mesh = 2);
    REFUSED("lods", 0, "primitives lie outside", LOD->first_primitive = 4);
    REFUSED("lods", 0, "primitives lie outside", LOD->first_primitive = UINT32_MAX);
    REFUSED("lods", 0, "primitives lie outside", LOD->mesh = 0, LOD->first_primitive = 3);
    REFUSED("lods", 0, "error", LOD->error = -0.5f);
    REFUSED("lods", 0, "error", LOD->error = (float)NAN);
    REFUSED("lods", 0, "error", LOD->error = (float)INFINITY);
    REFUSED("lods", 0, "another material", PRIMITIVE[3].material = 1);
    REFUSED("lods", 0, "more triangles", PRIMITIVE[2].index_count = 0);
    REFUSED("lods", 0, "out of the bounds", PRIMITIVE[3].aabb_max[1] = 2.5f);
}

/* The blob with `count` LODs instead of its one, after everything else. */
static void write_lods(const masu_blob_lod *lods, size_t count) {
    support_blob_write(&blob, SUPPORT_ALL | SUPPORT_DETAIL);
    masu_blob_section *row = support_blob_row(&blob, MASU_BLOB_LODS);
    memcpy(blob.bytes + row->offset, lods, count * sizeof *lods);
    row->count = count;
    blob.size = (size_t)row->offset + count * sizeof *lods;
}

static void lods_that_share_primitives_or_are_out_of_order_are_refused(void **state) {
    (void)state;
    static const masu_blob_lod two[][2] = {
        {{1, 3, 1.0f, 0}, {0, 0, 1.0f, 0}},
        {{1, 3, 1.0f, 0}, {1, 3, 0.5f, 0}},
        {{1, 3, 1.0f, 0}, {1, 3, 1.0f, 0}},
    };
    static const char *const why[] = {"not sorted", "error falls", "shares primitives"};
    for (int i = 0; i < 3; i++) {
        write_lods(two[i], 2);
        assert_refused("lods", 1, why[i]);
    }
}

/* Three LODs of a mesh without primitives: sharing the primitives adds none. */
static void a_fourth_lod_is_refused(void **state) {
    (void)state;
    masu_blob_lod four[4];
    for (int i = 0; i < 4; i++) four[i] = (masu_blob_lod){1, 2, 1.0f, 0};
    write_lods(four, 3);
    AT(MESHES, masu_blob_mesh)[1].primitive_count = 0;
    masu_scene scene;
    support_blob_seal(blob.bytes, blob.size);
    support_accepted(&blob, &scene);
    assert_int_equal(masu_scene_data_of(&scene)->lods, 3);
    write_lods(four, 4);
    AT(MESHES, masu_blob_mesh)[1].primitive_count = 0;
    assert_refused("lods", 3, "more than three");
}

static void detail_without_meshes_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL | SUPPORT_DETAIL);
    support_blob_drop(&blob, MASU_BLOB_INSTANCES);
    support_blob_drop(&blob, MASU_BLOB_MESHES);
    assert_refused("lods", 0, "no such mesh");
}

/* ---- choosing ---- */

static const masu_blob_lod forms[3] = {{0, 0, 0.01f, 0}, {0, 0, 0.1f, 0}, {0, 0, 1.0f, 0}};

static void the_coarsest_form_within_the_threshold_is_chosen(void **state) {
    (void)state;
    const float pixels = 935.307f; /* 1080 in 60 degrees */
    const float threshold = 1.0f;
    for (int i = 0; i < 3; i++) {
        float depth = forms[i].error * pixels / threshold;
        assert_int_equal(masu_lod_choose(forms, 3, 1, depth * 0.999f, pixels, threshold), i);
        assert_int_equal(masu_lod_choose(forms, 3, 1, depth * 1.001f, pixels, threshold),
                         i + 1);
        assert_int_equal(masu_lod_choose(forms, 3, 2, depth * 1.999f, pixels, threshold), i);
    }
    assert_int_equal(masu_lod_choose(forms, 0, 1, 1e9f, pixels, 1), 0);
    assert_int_equal(masu_lod_choose(forms, 3, 1, 1e9f, pixels, 1), 3);
    assert_int_equal(masu_lod_choose(forms, 3, 1, 1e9f, pixels, -1), 0);
}

static void choosing_is_total_and_falls_back_to_the_mesh(void **state) {
    (void)state;
    const float bad[] = {(float)NAN, -1.0f, 0.0f, (float)-INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(masu_lod_choose(forms, 3, 1, bad[i], 900, 0.5f), 0);
        if (bad[i] == 0.0f) continue; /* no error allowed: an exact LOD is still chosen */
        assert_int_equal(masu_lod_choose(forms, 3, (float)NAN, 10, 900, 0.5f), 0);
        assert_int_equal(masu_lod_choose(forms, 3, 1, 10, (float)NAN, 0.5f), 0);
        assert_int_equal(masu_lod_choose(forms, 3, 1, 10, 900, bad[i]), 0);
    }
    assert_int_equal(masu_lod_choose(forms, 3, (float)INFINITY, 1e30f, 900, 0.5f), 0);
}

static void farther_is_never_finer_and_never_over_the_threshold(void **state) {
    (void)state;
    uint64_t random = 7;
    for (int i = 0; i < 100000; i++) {
        float depth = (float)exp(12.0 * random_unit(&random) - 2.0);
        float scale = (float)exp(4.0 * random_unit(&random) - 2.0);
        uint32_t near = masu_lod_choose(forms, 3, scale, depth, 935, 0.5f);
        assert_true(masu_lod_choose(forms, 3, scale, depth * 1.5f, 935, 0.5f) >= near);
        if (near) {
            double seen = (double)forms[near - 1].error * (double)scale * 935.0 / (double)depth;
            assert_true(seen <= 0.5 * (1 + 1e-6));
        }
    }
}

static void the_scale_bounds_every_direction(void **state) {
    (void)state;
    uint64_t random = 11;
    for (int i = 0; i < 20000; i++) {
        float t[12];
        double d[3], length = 0, moved = 0;
        for (int k = 0; k < 12; k++) t[k] = (float)(4 * random_unit(&random) - 2);
        for (int k = 0; k < 3; k++) {
            d[k] = 2 * random_unit(&random) - 1;
            length += d[k] * d[k];
        }
        for (int k = 0; k < 3; k++) {
            double c =
                (double)t[4 * k] * d[0] + (double)t[4 * k + 1] * d[1] + (double)t[4 * k + 2] * d[2];
            moved += c * c;
        }
        assert_true(sqrt(moved) <= (double)masu_lod_scale(t) * sqrt(length) * (1 + 1e-5));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blob_with_detail_is_accepted_and_found),
        cmocka_unit_test(a_lod_that_breaks_a_rule_is_refused),
        cmocka_unit_test(lods_that_share_primitives_or_are_out_of_order_are_refused),
        cmocka_unit_test(a_fourth_lod_is_refused),
        cmocka_unit_test(detail_without_meshes_is_refused),
        cmocka_unit_test(the_coarsest_form_within_the_threshold_is_chosen),
        cmocka_unit_test(choosing_is_total_and_falls_back_to_the_mesh),
        cmocka_unit_test(farther_is_never_finer_and_never_over_the_threshold),
        cmocka_unit_test(the_scale_bounds_every_direction),
    };
    return cmocka_run_group_tests(tests, support_make_edge, NULL);
}
