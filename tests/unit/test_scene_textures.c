/* test_scene_textures.c: the rules for textures in a blob. Each is broken separately in an
 * otherwise good blob, and the error names section and element; content just within a rule is
 * accepted. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "scene/scene.h"
#include "support/bind.h"

#define WITH (SUPPORT_ALL | SUPPORT_TEXTURES)

static support_blob blob;

static void assert_refused(const char *what, uint64_t element, int line) {
    masu_scene scene;
    masu_detail detail;
    support_blob_seal(blob.bytes, blob.size);
    if (!support_bind(blob.bytes, blob.size, &scene, &detail)) {
        fail_msg("line %d: %s was accepted", line, what);
    }
    if (strcmp(detail.what, what) || detail.given != element) {
        fail_msg("line %d: %s was rejected as %s", line, what, detail.text);
    }
}

#define REFUSED(what, element, ...)                                                                \
    do {                                                                                           \
        support_blob_write(&blob, WITH);                                                           \
        __VA_ARGS__;                                                                               \
        assert_refused(what, element, __LINE__);                                                   \
    } while (0)

#define ACCEPTED(...)                                                                              \
    do {                                                                                           \
        masu_scene scene;                                                                          \
        support_blob_write(&blob, WITH);                                                           \
        __VA_ARGS__;                                                                               \
        support_blob_seal(blob.bytes, blob.size);                                                  \
        support_accepted(&blob, &scene);                                                           \
    } while (0)

#define AT(kind, type) ((type *)support_blob_find(&blob, MASU_BLOB_##kind))
#define TEXTURE AT(TEXTURES, masu_blob_texture)
#define SET AT(TEXTURE_SETS, masu_blob_texture_set)
#define TEXCOORD AT(TEXCOORDS, float)
#define MATERIAL AT(MATERIALS, masu_blob_material)
#define COUNT_OF(kind) support_blob_row(&blob, MASU_BLOB_##kind)->count

static void textures_are_accepted_with_their_numbers(void **state) {
    (void)state;
    masu_scene s;
    for (uint32_t parts = 0; parts < 32; parts++) {
        support_blob_write(&blob, parts);
        support_accepted(&blob, &s);
        int with = parts & SUPPORT_TEXTURES && parts & SUPPORT_RASTER;
        assert_int_equal(masu_scene_data_of(&s)->textures, with ? 4 : 0);
        assert_int_equal(masu_scene_data_of(&s)->texture_arrays, with ? 3 : 0);
        assert_int_equal(masu_scene_data_of(&s)->texture_sets, with ? 2 : 0);
        assert_int_equal(masu_scene_data_of(&s)->masks, with);
        assert_int_equal(masu_scene_texture_bytes(&s, 1), with ? 224 + 64 + 8 : 0);
        /* 85 texels twice and 16 of four bytes; 18 + 3 + 1 of two. */
        assert_int_equal(masu_scene_texture_bytes(&s, 0), with ? 4 * (2 * 85 + 16) + 2 * 22 : 0);
    }
}

static void sections_of_textures_come_together(void **state) {
    (void)state;
    static const enum masu_blob_kind kinds[] = {MASU_BLOB_TEXCOORDS, MASU_BLOB_TEXTURES,
                                                MASU_BLOB_TEXTURE_SETS, MASU_BLOB_TEXELS};
    for (uint32_t left_out = 1; left_out < 15; left_out++) {
        support_blob_write(&blob, WITH);
        for (uint32_t i = 0; i < 4; i++) {
            if (left_out & 1u << i) support_blob_drop(&blob, kinds[i]);
        }
        assert_refused("textures", 0, __LINE__);
    }
    support_blob_write(&blob, WITH);
    for (uint32_t i = 0; i < 4; i++) support_blob_drop(&blob, kinds[i]);
    assert_refused("materials", 0, __LINE__); /* which refer to them */
}

static void a_texture_out_of_range_is_refused(void **state) {
    (void)state;
    REFUSED("textures", 0, TEXTURE[0].format = 0);
    REFUSED("textures", 0, TEXTURE[0].format = 5);
    REFUSED("textures", 1, TEXTURE[1].format = UINT32_MAX);
    REFUSED("textures", 0, TEXTURE[0].width = 0);
    REFUSED("textures", 0, TEXTURE[0].height = 0);
    REFUSED("textures", 0, TEXTURE[0].width = MASU_TEXTURE_SIZE_MAX + 1);
    REFUSED("textures", 2, TEXTURE[2].height = UINT32_MAX);
    REFUSED("textures", 0, TEXTURE[0].mips = 0);
    REFUSED("textures", 0, TEXTURE[0].mips = 5); /* 8 x 8 has 4 mips */
    REFUSED("textures", 1, TEXTURE[1].mips = UINT32_MAX);
    REFUSED("textures", 0, TEXTURE[0].layers = 0);
    REFUSED("textures", 0, TEXTURE[0].layers = MASU_TEXTURE_LAYERS_MAX + 1);
    REFUSED("textures", 0, TEXTURE[0].layers = UINT32_MAX);
    REFUSED("textures", 2, TEXTURE[2].name = 1000);
    REFUSED("section",
            (uint64_t)(support_blob_row(&blob, MASU_BLOB_TEXTURES) -
                       (masu_blob_section *)(void *)(blob.bytes + 64)),
            COUNT_OF(TEXTURES) = MASU_TEXTURE_ARRAYS_MAX + 1);
    ACCEPTED(TEXTURE[2].name = MASU_BLOB_NONE);
    ACCEPTED(TEXTURE[2].format = MASU_TEXTURE_BC1_SRGB); /* unchanged */
}

static void textures_lie_one_behind_the_other_and_fill_the_texels(void **state) {
    (void)state;
    REFUSED("textures", 0, TEXTURE[0].offset = 16);
    REFUSED("textures", 1, TEXTURE[1].offset = 0);
    REFUSED("textures", 1, TEXTURE[1].offset = 208);
    REFUSED("textures", 1, TEXTURE[1].offset = UINT64_MAX - 15);
    REFUSED("textures", 1, TEXTURE[0].mips = 3); /* then the second array begins too late */
    REFUSED("textures", 1, TEXTURE[0].layers = 1);
    REFUSED("textures", 2, TEXTURE[2].width = 100); /* larger than the remaining bytes */
    REFUSED("textures", 2, TEXTURE[2].layers = 256);
    REFUSED("texels", 18, COUNT_OF(TEXTURES) = 2, SET[1].texture[3] = MASU_BLOB_NONE);
    REFUSED("texels", 18, TEXTURE[1].height = 4, TEXTURE[1].mips = 3, TEXTURE[1].width = 4,
            TEXTURE[2].offset = 272);
}

static void texture_coordinates_are_as_many_as_vertices_and_small(void **state) {
    (void)state;
    REFUSED("texture coordinates", 10, COUNT_OF(TEXCOORDS) = 10);
    REFUSED("texture coordinates", 12, COUNT_OF(TEXCOORDS) = 12);
    REFUSED("texture coordinates", 0, TEXCOORD[0] = (float)NAN);
    REFUSED("texture coordinates", 10, TEXCOORD[21] = (float)INFINITY);
    REFUSED("texture coordinates", 3, TEXCOORD[7] = nextafterf(32768.0f, 40000.0f));
    ACCEPTED(TEXCOORD[0] = -32768.0f);
}

static void a_texture_set_names_textures_of_the_right_kind(void **state) {
    (void)state;
    REFUSED("texture sets", 0, SET[0].texture[0] = 3);
    REFUSED("texture sets", 0, SET[0].texture[3] = UINT32_MAX - 1);
    REFUSED("texture sets", 0, SET[0].texture[0] = 1); /* BC5 is no colour */
    REFUSED("texture sets", 0, SET[0].texture[1] = 0); /* BC3 is no normal */
    REFUSED("texture sets", 0, SET[0].texture[2] = 2);
    REFUSED("texture sets", 1, SET[1].texture[3] = 0); /* no emissive texture has alpha */
    REFUSED("texture sets", 1, SET[1].texture[3] = MASU_BLOB_NONE);
    REFUSED("texture sets", 1, SET[1].wrap[0] = 3);
    REFUSED("texture sets", 0, SET[0].wrap[1] = UINT32_MAX);
    ACCEPTED(SET[1].texture[0] = 0, SET[1].texture[1] = 1); /* more than its materials use */
}

static void a_material_asks_for_maps_that_are_there(void **state) {
    (void)state;
    REFUSED("materials", 0, MATERIAL[0].flags |= 0x20000);
    REFUSED("materials", 0, MATERIAL[0].flags |= 0x10); /* its set has no occlusion map */
    REFUSED("materials", 0, MATERIAL[0].texture_set = 2);
    REFUSED("materials", 0, MATERIAL[0].texture_set = UINT32_MAX);
    REFUSED("materials", 0, MATERIAL[0].flags |= 8); /* its set has no emissive map */
    REFUSED("materials", 1, MATERIAL[1].texture_set = 0);
    REFUSED("materials", 0, MATERIAL[0].layers = 2); /* of two layers */
    REFUSED("materials", 0, MATERIAL[0].layers = 0x100);
    REFUSED("materials", 1, MATERIAL[1].layers = 0x1000000);
    REFUSED("materials", 1, MATERIAL[1].flags |= MASU_MATERIAL_IS_MASK);
    REFUSED("materials", 1, MATERIAL[1].flags |= MASU_MATERIAL_HAS_METAL);
    REFUSED("texture sets", 0, SET[0].texture[4] = 1); /* BC5 is no occlusion */
    /* and BC3 no coat */
    REFUSED("materials", 0, SET[0].texture[MASU_SLOT_COAT] = 0,
            MATERIAL[0].flags |= 1u << MASU_SLOT_COAT);
    REFUSED("materials", 0, MATERIAL[0].flags |= MASU_MATERIAL_LOBE_MAP); /* it has none */
    REFUSED("materials", 0, MATERIAL[0].flags |= MASU_MATERIAL_COAT_RELIEF);
    REFUSED("materials", 0, SET[0].texture[MASU_SLOT_COAT] = 1,
            MATERIAL[0].flags |= 1u << MASU_SLOT_COAT, MATERIAL[0].more_layers = 0x900);
    REFUSED("materials", 0, MATERIAL[0].more_layers = 0x10000);
    /* the set has no normal map */
    REFUSED("materials", 1, MATERIAL[1].flags |= MASU_MATERIAL_COAT_SMOOTH);
    REFUSED("materials", 0,
            MATERIAL[0].flags |= MASU_MATERIAL_COAT_SMOOTH | MASU_MATERIAL_BASE_SMOOTH);
    ACCEPTED(MATERIAL[0].flags |= MASU_MATERIAL_COAT_SMOOTH);
    ACCEPTED(SET[0].texture[MASU_SLOT_COAT] = 1, MATERIAL[0].flags |= 1u << MASU_SLOT_COAT);
    REFUSED("materials", 0, MATERIAL[0].flags = 0); /* but a layer */
    REFUSED("materials", 1, MATERIAL[1].flags = 0); /* but a set */
    REFUSED("materials", 1, MATERIAL[1].flags = MASU_MATERIAL_IS_MASK, MATERIAL[1].texture_set = 0);
    ACCEPTED(MATERIAL[1].flags = MASU_MATERIAL_IS_BLEND, MATERIAL[1].texture_set = 0);
    ACCEPTED(MATERIAL[0].flags &= ~(uint32_t)MASU_MATERIAL_IS_MASK);
    ACCEPTED(MATERIAL[0].layers = 0xFF000000u); /* of an unused slot */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(textures_are_accepted_with_their_numbers),
        cmocka_unit_test(sections_of_textures_come_together),
        cmocka_unit_test(a_texture_out_of_range_is_refused),
        cmocka_unit_test(textures_lie_one_behind_the_other_and_fill_the_texels),
        cmocka_unit_test(texture_coordinates_are_as_many_as_vertices_and_small),
        cmocka_unit_test(a_texture_set_names_textures_of_the_right_kind),
        cmocka_unit_test(a_material_asks_for_maps_that_are_there),
    };
    return cmocka_run_group_tests_name("scene_textures", tests, support_make_edge, NULL);
}
