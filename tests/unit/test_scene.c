/* test_scene.c: reading baked blobs. Good ones are accepted with the right numbers; truncated,
 * concatenated or corrupted blobs and other versions are rejected. (Rules for the contents:
 * test_scene_rules.c.) */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "scene/scene.h"
#include "support/bind.h"
#include "support/files.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static support_blob blob;

/* ---- Good blobs ------------------------------------------------------------------------------ */

static void a_full_blob_is_accepted_with_its_numbers(void **state) {
    (void)state;
    masu_scene s;
    support_blob_write(&blob, SUPPORT_ALL);
    support_accepted(&blob, &s);
    assert_int_equal(masu_scene_data_of(&s)->vertices, 11);
    assert_int_equal(masu_scene_data_of(&s)->indices, 15);
    assert_int_equal(masu_scene_data_of(&s)->primitives, 3);
    assert_int_equal(masu_scene_data_of(&s)->meshes, 2);
    assert_int_equal(masu_scene_count(&s, MASU_SCENE_INSTANCE), 3);
    assert_int_equal(masu_scene_count(&s, MASU_SCENE_MATERIAL), 2);
    assert_int_equal(masu_scene_count(&s, MASU_SCENE_CAMERA_KEY), 3);
    assert_int_equal(masu_scene_data_of(&s)->sdf, 1);
    assert_int_equal(masu_scene_count(&s, MASU_SCENE_SDF_PARAM), 2);
    assert_int_equal(masu_scene_data_of(&s)->sdf_parts, 1);
    assert_int_equal(masu_scene_data_of(&s)->sdf_slots, 3);
    assert_int_equal(masu_scene_data_of(&s)->sdf_dynamic, 1);
    /* Two of mesh 0, one of mesh 1. */
    assert_int_equal(masu_scene_data_of(&s)->draws, 3);
    assert_int_equal(masu_scene_triangles(&s), 2 * (2 + 1) + 2); /* mesh 0 has two instances */
}

static void a_blob_of_any_parts_is_accepted_with_these_alone(void **state) {
    (void)state;
    for (uint32_t parts = 0; parts <= SUPPORT_ALL; parts++) {
        masu_scene s;
        support_blob_write(&blob, parts);
        support_accepted(&blob, &s);
        assert_int_equal(masu_scene_data_of(&s)->vertices, parts & SUPPORT_RASTER ? 11 : 0);
        assert_int_equal(masu_scene_count(&s, MASU_SCENE_INSTANCE), parts & SUPPORT_RASTER ? 3 : 0);
        assert_int_equal(masu_scene_data_of(&s)->draws, parts & SUPPORT_RASTER ? 3 : 0);
        assert_int_equal(masu_scene_data_of(&s)->sdf, parts & SUPPORT_SDF ? 1 : 0);
        assert_int_equal(masu_scene_count(&s, MASU_SCENE_SDF_PARAM), parts & SUPPORT_SDF ? 2 : 0);
        assert_int_equal(masu_scene_count(&s, MASU_SCENE_CAMERA_KEY),
                         parts & SUPPORT_CAMERA ? 3 : 0);
        assert_int_equal(masu_scene_data_of(&s)->sdf_parts, parts & SUPPORT_SDF ? 1 : 0);
        assert_int_equal(masu_scene_data_of(&s)->sdf_slots, parts & SUPPORT_SDF ? 3 : 0);
        int variants = parts & SUPPORT_SDF && parts & SUPPORT_VARIANTS;
        assert_int_equal(masu_scene_data_of(&s)->sdf_dynamic, variants);
    }
}

static void a_mesh_that_is_placed_nowhere_is_not_drawn(void **state) {
    (void)state;
    masu_scene s;
    support_blob_write(&blob, SUPPORT_ALL);
    masu_blob_instance *instances = support_blob_find(&blob, MASU_BLOB_INSTANCES);
    instances[0].mesh = instances[1].mesh = 1;
    support_blob_seal(blob.bytes, blob.size);
    support_accepted(&blob, &s);
    assert_int_equal(masu_scene_data_of(&s)->draws, 1);
    assert_int_equal(masu_scene_triangles(&s), 3 * 2);
}

static void instances_of_a_mesh_are_found_from_anywhere_before_them(void **state) {
    (void)state;
    masu_scene s;
    support_blob_write(&blob, SUPPORT_ALL);
    support_accepted(&blob, &s);
    masu_scene_view view = masu_scene_view_of(&s);
    uint32_t first = 99;
    assert_int_equal(masu_scene_mesh_instances(&view, 3, 0, 0, &first), 2);
    assert_int_equal(first, 0);
    assert_int_equal(masu_scene_mesh_instances(&view, 3, 1, 0, &first), 3);
    assert_int_equal(first, 2);
    assert_int_equal(masu_scene_mesh_instances(&view, 3, 1, 2, &first), 3);
    assert_int_equal(first, 2);
    assert_int_equal(masu_scene_mesh_instances(&view, 3, 2, 0, &first), 3);
    assert_int_equal(first, 3);
    assert_int_equal(masu_scene_mesh_instances(&view, 0, 0, 0, &first), 0);
    assert_int_equal(first, 0);
}

static void sdf_parameters_are_found_by_their_names(void **state) {
    (void)state;
    masu_scene s;
    support_blob_write(&blob, SUPPORT_ALL);
    support_accepted(&blob, &s);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "radius"), 0);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "bend"), 1);
    /* A name, but of a material. */
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "steel"), -1);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "radiu"), -1);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "radius "), -1);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, ""), -1);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, NULL), -1);
    assert_int_equal(masu_scene_find(NULL, MASU_SCENE_SDF_PARAM, "radius"), -1);
    masu_blob_sdf_param *params = support_blob_find(&blob, MASU_BLOB_SDF_PARAMS);
    params[0].name = MASU_BLOB_NONE;
    support_blob_seal(blob.bytes, blob.size);
    support_accepted(&blob, &s);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "radius"), -1);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "bend"), 1);
    support_blob_write(&blob, SUPPORT_RASTER);
    support_accepted(&blob, &s);
    assert_int_equal(masu_scene_find(&s, MASU_SCENE_SDF_PARAM, "radius"), -1);
}

/* ---- Damage ---------------------------------------------------------------------------------- */

static void a_pointer_that_is_missing_or_misaligned_is_an_argument_error(void **state) {
    (void)state;
    masu_scene scene;
    masu_detail detail;
    support_blob_write(&blob, SUPPORT_ALL);
    assert_int_equal(masu_scene_bind(NULL, blob.size, &scene, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "blob");
    assert_string_equal(detail.text, "blob is NULL");
    assert_int_equal(masu_scene_bind(NULL, 0, &scene, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_scene_bind(blob.bytes, blob.size, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.text, "out is NULL");
    memmove(blob.bytes + 16, blob.bytes, blob.size);
    for (size_t off = 1; off < 16; off++) {
        memmove(blob.bytes + off, blob.bytes + (off == 1 ? 16 : off - 1), blob.size);
        assert_int_equal(masu_scene_bind(blob.bytes + off, blob.size, &scene, &detail),
                         MASU_ERROR_ARGUMENT);
        assert_string_equal(detail.what, "blob");
        assert_int_equal(detail.given, ((uintptr_t)blob.bytes + off) % 16);
        assert_non_null(strstr(detail.text, " bytes behind a multiple of 16"));
    }
}

static void a_blob_cut_anywhere_is_refused(void **state) {
    (void)state;
    masu_scene scene;
    masu_detail detail;
    for (uint32_t parts = 0; parts <= SUPPORT_ALL; parts++) {
        support_blob_write(&blob, parts);
        for (size_t size = 0; size < blob.size; size++) {
            if (!support_bind(blob.bytes, size, &scene, &detail))
                fail_msg("%zu bytes accepted", size);
        }
    }
}

/* As if the baker had been interrupted, but had written a matching header. */
static void a_blob_cut_anywhere_and_sealed_again_is_refused(void **state) {
    (void)state;
    masu_scene scene;
    masu_detail detail;
    for (uint32_t parts = 0; parts <= SUPPORT_ALL; parts++) {
        support_blob_write(&blob, parts);
        for (size_t size = sizeof(masu_blob_header); size < blob.size;
             size += whole_run() ? 1 : 3) {
            support_blob cut = blob;
            support_blob_seal(cut.bytes, size);
            if (!support_bind(cut.bytes, size, &scene, &detail))
                fail_msg("%zu bytes accepted", size);
        }
    }
}

static void bytes_behind_the_blob_are_refused(void **state) {
    (void)state;
    masu_scene scene;
    masu_detail detail;
    support_blob_write(&blob, SUPPORT_ALL);
    for (size_t more = 1; more <= 16; more++) {
        assert_int_equal(support_bind(blob.bytes, blob.size + more, &scene, &detail),
                         MASU_ERROR_SCENE);
        assert_string_equal(detail.what, "bytes");
        assert_int_equal(detail.needed, blob.size);
        assert_int_equal(detail.given, blob.size + more);
    }
}

/* The hash covers everything after the header; errors in the header's own bits must be detected one
 * by one. After the header every seventh bit is tested, but all bits of the fullest blob (not with
 * the sanitizers); with LONG=1 all bits of all blobs. */
static void a_blob_with_any_bit_flipped_is_refused(void **state) {
    (void)state;
    masu_scene scene;
    masu_detail detail;
    for (uint32_t parts = 0; parts <= SUPPORT_ALL; parts++) {
        bool all = long_run() || (whole_run() && parts == SUPPORT_ALL);
        support_blob_write(&blob, parts);
        for (size_t bit = 0; bit < 8 * blob.size;
             bit += bit < 8 * sizeof(masu_blob_header) || all ? 1 : 7) {
            blob.bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
            if (!support_bind(blob.bytes, blob.size, &scene, &detail)) {
                fail_msg("parts %u: accepted with bit %zu of byte %zu flipped", parts, bit % 8,
                         bit / 8);
            }
            blob.bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
        }
    }
}

/* The independent reader inside support_bind checks every accepted blob. */
static void a_sealed_blob_with_any_byte_changed_is_refused_or_harmless(void **state) {
    (void)state;
    masu_scene scene;
    masu_detail detail;
    size_t accepted = 0, refused = 0;
    for (uint32_t parts = 1; parts <= SUPPORT_ALL; parts += 2) {
        support_blob_write(&blob, parts);
        for (size_t at = 0; at < blob.size; at++) {
            static const unsigned char changes[] = {0x01, 0x80, 0xFF, 0x7F, 0x10};
            for (size_t i = 0; i < COUNT(changes); i++) {
                support_blob changed = blob;
                changed.bytes[at] ^= changes[i];
                support_blob_seal(changed.bytes, changed.size);
                if (support_bind(changed.bytes, changed.size, &scene, &detail)) {
                    refused++;
                } else {
                    accepted++;
                }
            }
        }
    }
    printf("%zu changes harmless, %zu rejected\n", accepted, refused);
    assert_true(refused > 1000 && accepted > 1000);
}

/* ---- Header ---------------------------------------------------------------------------------- */

static void assert_header_refused(masu_result result, const char *what) {
    masu_scene scene;
    masu_detail detail;
    assert_int_equal(support_bind(blob.bytes, blob.size, &scene, &detail), result);
    assert_string_equal(detail.what, what);
}

static masu_blob_header *header(void) { return (masu_blob_header *)(void *)blob.bytes; }

static void another_version_is_a_version_error(void **state) {
    (void)state;
    static const uint32_t versions[] = {0, MASU_BLOB_VERSION - 1, MASU_BLOB_VERSION + 1, 0x01000000,
                                        UINT32_MAX};
    for (size_t i = 0; i < COUNT(versions); i++) {
        support_blob_write(&blob, SUPPORT_ALL);
        header()->version = versions[i];
        header()->hash ^= 1; /* other changes of such a version */
        assert_header_refused(MASU_ERROR_VERSION, "version");
    }
}

static void a_file_that_is_no_blob_is_named_so(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    header()->magic = 0x46546C67; /* glTF */
    assert_header_refused(MASU_ERROR_SCENE, "magic");
    blob.size = 63;
    assert_header_refused(MASU_ERROR_SCENE, "header");
    blob.size = 0;
    assert_header_refused(MASU_ERROR_SCENE, "header");
}

static void a_header_alone_lacks_an_environment(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    header()->section_count = 0;
    blob.size = sizeof(masu_blob_header);
    support_blob_seal(blob.bytes, blob.size);
    assert_header_refused(MASU_ERROR_SCENE, "environment");
}

static void a_header_that_does_not_fit_its_blob_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    header()->bytes++;
    assert_header_refused(MASU_ERROR_SCENE, "bytes");
    header()->bytes = UINT64_MAX;
    assert_header_refused(MASU_ERROR_SCENE, "bytes");
    support_blob_write(&blob, SUPPORT_ALL);
    header()->hash++;
    assert_header_refused(MASU_ERROR_SCENE, "hash");
    support_blob_write(&blob, SUPPORT_ALL);
    header()->section_count = MASU_BLOB_KIND_COUNT + 1;
    assert_header_refused(MASU_ERROR_SCENE, "section_count");
    header()->section_count = UINT32_MAX;
    assert_header_refused(MASU_ERROR_SCENE, "section_count");
    blob.size = sizeof(masu_blob_header) + 2 * sizeof(masu_blob_section) - 1;
    header()->section_count = 2; /* a truncated table */
    support_blob_seal(blob.bytes, blob.size);
    assert_header_refused(MASU_ERROR_SCENE, "section_count");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_full_blob_is_accepted_with_its_numbers),
        cmocka_unit_test(a_blob_of_any_parts_is_accepted_with_these_alone),
        cmocka_unit_test(a_mesh_that_is_placed_nowhere_is_not_drawn),
        cmocka_unit_test(instances_of_a_mesh_are_found_from_anywhere_before_them),
        cmocka_unit_test(sdf_parameters_are_found_by_their_names),
        cmocka_unit_test(a_pointer_that_is_missing_or_misaligned_is_an_argument_error),
        cmocka_unit_test(a_blob_cut_anywhere_is_refused),
        cmocka_unit_test(a_blob_cut_anywhere_and_sealed_again_is_refused),
        cmocka_unit_test(bytes_behind_the_blob_are_refused),
        cmocka_unit_test(a_blob_with_any_bit_flipped_is_refused),
        cmocka_unit_test(a_sealed_blob_with_any_byte_changed_is_refused_or_harmless),
        cmocka_unit_test(another_version_is_a_version_error),
        cmocka_unit_test(a_file_that_is_no_blob_is_named_so),
        cmocka_unit_test(a_header_alone_lacks_an_environment),
        cmocka_unit_test(a_header_that_does_not_fit_its_blob_is_refused),
    };
    return cmocka_run_group_tests_name("scene", tests, support_make_edge, NULL);
}
