/* test_scene_query.c: the public queries of a scene: counts, names, features, and the usage that
 * limits are compared with. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "plan/desc.h"
#include "plan/limits.h"
#include "support/bind.h"
#include "support/desc.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

enum { ITEMS = MASU_SCENE_CAMERA_KEY + 1 };

static const uint32_t everything = SUPPORT_RASTER | SUPPORT_SDF | SUPPORT_CAMERA | SUPPORT_SHADOW |
                                   SUPPORT_LIGHTING | SUPPORT_LIVE | SUPPORT_SKIN;

static support_blob blob;

/* The scene of a blob that remains readable. */
static masu_scene bound(uint32_t parts) {
    masu_scene scene;
    masu_detail detail;
    support_blob_write(&blob, parts);
    if (masu_scene_bind(blob.bytes, blob.size, &scene, &detail)) fail_msg("%s", detail.text);
    return scene;
}

static void assert_no_sdf_param(const masu_scene *scene, uint32_t index) {
    float minimum = 9.0f, maximum = 9.0f;
    assert_true(masu_scene_sdf_range(scene, index, &minimum, &maximum) == 0.0f);
    assert_true(minimum == 0.0f && maximum == 0.0f);
}

static void assert_empty(const masu_scene *scene) {
    uint32_t resolution = 9;
    masu_limits usage, none;
    memset(&usage, 0xFF, sizeof usage);
    memset(&none, 0, sizeof none);
    for (int item = -1; item <= ITEMS; item++) {
        assert_int_equal(masu_scene_count(scene, (masu_scene_item)item), 0);
        assert_string_equal(masu_scene_name(scene, (masu_scene_item)item, 0), "");
        assert_int_equal(masu_scene_find(scene, (masu_scene_item)item, "lid"), -1);
    }
    assert_int_equal(masu_scene_clip_count(scene, 0), 0);
    assert_string_equal(masu_scene_clip_name(scene, 0, 0), "");
    assert_no_sdf_param(scene, 0);
    assert_int_equal(masu_scene_features(scene), 0);
    assert_int_equal(masu_scene_triangles(scene), 0);
    assert_int_equal(masu_scene_texture_bytes(scene, 0), 0);
    assert_int_equal(masu_scene_texture_bytes(scene, 1), 0);
    assert_int_equal(masu_scene_shadow_cascades(scene, &resolution), 0);
    assert_int_equal(resolution, 0);
    assert_int_equal(masu_scene_shadow_cascades(scene, NULL), 0);
    assert_true(masu_scene_shadow_distance(scene) == 0.0f);
    assert_true(masu_scene_specular_cutoff(scene) == 0.0f);
    masu_scene_usage(scene, &usage);
    assert_memory_equal(&usage, &none, sizeof none);
    masu_scene_usage(scene, NULL);
}

static void no_scene_and_an_unbound_scene_are_empty(void **state) {
    (void)state;
    static const masu_scene unbound;
    assert_empty(NULL);
    assert_empty(&unbound);
}

static void what_is_out_of_range_does_not_exist(void **state) {
    (void)state;
    const masu_scene scene = bound(everything);
    static const int none[] = {-1, ITEMS, 1000};
    for (size_t i = 0; i < COUNT(none); i++) {
        assert_int_equal(masu_scene_count(&scene, (masu_scene_item)none[i]), 0);
        assert_string_equal(masu_scene_name(&scene, (masu_scene_item)none[i], 0), "");
        assert_int_equal(masu_scene_find(&scene, (masu_scene_item)none[i], "lid"), -1);
    }
    for (int i = 0; i < ITEMS; i++) {
        masu_scene_item item = (masu_scene_item)i;
        uint32_t count = masu_scene_count(&scene, item);
        assert_true(count > 0);
        assert_string_equal(masu_scene_name(&scene, item, count), "");
        assert_string_equal(masu_scene_name(&scene, item, UINT32_MAX), "");
        assert_int_equal(masu_scene_find(&scene, item, "no such name"), -1);
        assert_int_equal(masu_scene_find(&scene, item, ""), -1);
        assert_int_equal(masu_scene_find(&scene, item, NULL), -1);
    }
    assert_no_sdf_param(&scene, masu_scene_count(&scene, MASU_SCENE_SDF_PARAM));
    assert_no_sdf_param(&scene, UINT32_MAX);
    uint32_t models = masu_scene_count(&scene, MASU_SCENE_MODEL);
    assert_int_equal(masu_scene_clip_count(&scene, models), 0);
    assert_int_equal(masu_scene_clip_count(&scene, UINT32_MAX), 0);
    assert_string_equal(masu_scene_clip_name(&scene, models, 0), "");
    for (uint32_t m = 0; m < models; m++) {
        uint32_t clips = masu_scene_clip_count(&scene, m);
        assert_string_equal(masu_scene_clip_name(&scene, m, clips), "");
        assert_string_equal(masu_scene_clip_name(&scene, m, UINT32_MAX), "");
        for (uint32_t c = 0; c < clips; c++)
            assert_string_not_equal(masu_scene_clip_name(&scene, m, c), "");
    }
}

static void items_are_found_by_their_names(void **state) {
    (void)state;
    const masu_scene scene = bound(everything);
    uint32_t found = 0;
    for (int i = 0; i < ITEMS; i++) {
        masu_scene_item item = (masu_scene_item)i;
        for (uint32_t k = 0; k < masu_scene_count(&scene, item); k++) {
            const char *name = masu_scene_name(&scene, item, k);
            if (!*name) continue;
            int32_t first = masu_scene_find(&scene, item, name);
            assert_true(first >= 0 && first <= (int32_t)k);
            assert_string_equal(masu_scene_name(&scene, item, (uint32_t)first), name);
            found |= 1u << i;
        }
    }
    assert_int_equal(found, (1u << MASU_SCENE_CAMERA_KEY) - 1); /* keys have no names */
    float minimum, maximum;
    int32_t bend = masu_scene_find(&scene, MASU_SCENE_SDF_PARAM, "bend");
    assert_true(masu_scene_sdf_range(&scene, (uint32_t)bend, &minimum, &maximum) == -1.0f);
    assert_true(minimum == -1.0f && maximum == 1.0f);
    assert_true(masu_scene_sdf_range(&scene, 0, NULL, NULL) == 0.5f);
    int32_t lid = masu_scene_find(&scene, MASU_SCENE_MODEL, "lid");
    assert_int_equal(lid, 2);
    assert_int_equal(masu_scene_clip_count(&scene, (uint32_t)lid), 2);
    assert_int_equal(masu_scene_clip_count(&scene, 0), 0);
}

/* ---- Properties ------------------------------------------------------------------------------ */

static void each_feature_has_its_bit(void **state) {
    (void)state;
    static const struct {
        size_t member;
        uint32_t bit;
    } features[] = {{offsetof(masu_scene_data, sdf), MASU_SCENE_HAS_SDF},
                    {offsetof(masu_scene_data, sdf_dynamic), MASU_SCENE_HAS_DYNAMIC_SDF},
                    {offsetof(masu_scene_data, shadow_cascades), MASU_SCENE_HAS_SHADOW_MAP},
                    {offsetof(masu_scene_data, reflections), MASU_SCENE_HAS_REFLECTIONS},
                    {offsetof(masu_scene_data, transparents), MASU_SCENE_HAS_TRANSPARENTS},
                    {offsetof(masu_scene_data, analytic_sky), MASU_SCENE_HAS_ANALYTIC_SKY},
                    {offsetof(masu_scene_data, fog), MASU_SCENE_HAS_FOG},
                    {offsetof(masu_scene_data, metered), MASU_SCENE_HAS_METERED_EXPOSURE},
                    {offsetof(masu_scene_data, smooth_edges), MASU_SCENE_HAS_DEFAULT_AA}};
    uint32_t all = 0;
    masu_scene_data every;
    memset(&every, 0, sizeof every);
    for (size_t i = 0; i < COUNT(features); i++) {
        masu_scene_data one;
        memset(&one, 0, sizeof one);
        for (uint32_t value = 1; value <= 3; value += 2) { /* for a flag, for a count */
            memcpy((char *)&one + features[i].member, &value, sizeof value);
            assert_int_equal(masu_scene_features(masu_scene_of(&one)), features[i].bit);
            memcpy((char *)&every + features[i].member, &value, sizeof value);
        }
        assert_int_equal(all & features[i].bit, 0);
        all |= features[i].bit;
    }
    assert_int_equal(masu_scene_features(masu_scene_of(&every)), all);
    assert_int_equal(all, 2 * MASU_SCENE_HAS_DEFAULT_AA - 1); /* there are no others */
}

static void numbers_are_those_of_the_blob(void **state) {
    (void)state;
    uint32_t resolution = 0;
    const masu_scene scene = bound(everything | SUPPORT_TRACE | SUPPORT_TEXTURES);
    const masu_scene_data *data = masu_scene_data_of(&scene);
    assert_int_equal(masu_scene_triangles(&scene), data->triangles);
    assert_true(data->texture_bytes > 0 && data->texture_bytes < data->texture_bytes_decoded);
    assert_int_equal(masu_scene_texture_bytes(&scene, 1), data->texture_bytes);
    assert_int_equal(masu_scene_texture_bytes(&scene, 0), data->texture_bytes_decoded);
    assert_true(data->shadow_cascades > 0);
    assert_int_equal(masu_scene_shadow_cascades(&scene, &resolution), data->shadow_cascades);
    assert_int_equal(resolution, data->shadow_resolution);
    assert_true(masu_scene_shadow_distance(&scene) > 0.0f);
    assert_true(masu_scene_specular_cutoff(&scene) > 0.0f);
    const masu_scene copy = scene;
    assert_string_equal(masu_scene_name(&copy, MASU_SCENE_MODEL, 0), "plate");
}

/* ---- Usage ----------------------------------------------------------------------------------- */

static masu_result check(const masu_scene *scene, const masu_limits *limits, masu_detail *detail) {
    masu_desc d = scene_desc(RASTER, 640, 360);
    d.scene = scene;
    d.limits = *limits;
    d = masu_desc_resolved(&d);
    return masu_limits_check(&d, detail);
}

static uint64_t *limit_at(masu_limits *limits, const masu_limit *row) {
    return (uint64_t *)(void *)((char *)limits + row->offset);
}

/* A scene with at least 2 of everything, because a limit of 0 means none. */
static void limits_equal_to_the_usage_accept_and_lower_ones_do_not(void **state) {
    (void)state;
    masu_scene_data data;
    memset(&data, 0, sizeof data);
    data.vertices = 11, data.indices = 15, data.materials = 2, data.instances = 3;
    data.models = 4, data.model_nodes = 5, data.sdf_params = 6;
    data.shadow_cascades = 3, data.shadow_resolution = 512, data.probes = 7;
    data.textures = 8, data.texture_bytes = 200, data.texture_bytes_decoded = 1000;
    data.transparents = 9, data.transparent_sets = 1, data.lights = 10;
    data.trace_triangles = 12, data.trace_instances = 13;
    const masu_scene *scene = masu_scene_of(&data);
    masu_limits usage, limits;
    masu_detail detail;
    char what[64];
    masu_scene_usage(scene, &usage);
    assert_int_equal(usage.texture_bytes, 1000);
    if (check(scene, &usage, &detail)) fail_msg("rejected: %s", detail.text);
    for (const masu_limit *row = masu_limit_table(); row->name; row++) {
        limits = usage;
        uint64_t used = *limit_at(&limits, row);
        if (used < 2) fail_msg("%s is not tried: the scene uses %u", row->name, (unsigned)used);
        *limit_at(&limits, row) = used - 1;
        assert_int_equal(check(scene, &limits, &detail), MASU_ERROR_LIMIT);
        snprintf(what, sizeof what, "limits.%s", row->name);
        assert_string_equal(detail.what, what);
        assert_int_equal(detail.needed, used);
        assert_int_equal(detail.given, used - 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_scene_and_an_unbound_scene_are_empty),
        cmocka_unit_test(what_is_out_of_range_does_not_exist),
        cmocka_unit_test(items_are_found_by_their_names),
        cmocka_unit_test(each_feature_has_its_bit),
        cmocka_unit_test(numbers_are_those_of_the_blob),
        cmocka_unit_test(limits_equal_to_the_usage_accept_and_lower_ones_do_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
