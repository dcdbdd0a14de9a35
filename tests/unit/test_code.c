/* test_code.c: masu_scene_bind's checks of a blob's SPIR-V. Code that its pass could not run, and
 * code compiled for other counts than the blob's, is rejected with the name of its section, for any
 * content. The rows of check_code.c agree with src/plan/passes.inc. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "plan/frame_plan.h"
#include "scene/code.h"
#include "shared/masu_shared.h"
#include "support/bind.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define OP(words, op) ((uint32_t)(words) << 16 | (op))

static support_blob blob;
static masu_detail detail;

static masu_result bound(void) {
    masu_scene scene;
    support_blob_seal(blob.bytes, blob.size);
    return support_bind(blob.bytes, blob.size, &scene, &detail);
}

static void assert_refused(const char *what, const char *why) {
    assert_int_equal(bound(), MASU_ERROR_SCENE);
    if (strcmp(detail.what, what) != 0 || !strstr(detail.text, why))
        fail_msg("\"%s\" is not %s, %s", detail.text, what, why);
}

static uint32_t *words_of(enum masu_blob_kind kind) { return support_blob_find(&blob, kind); }

/* ---- The compilation record ------------------------------------------------------------------ */

static void other_counts_than_the_code_was_compiled_for_are_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    masu_blob_sdf *field = support_blob_find(&blob, MASU_BLOB_SDF);
    field->part_count = 300;
    assert_refused("march SPIR-V", "parts 0001, slots 00003, words 0, raster, in place, moves', "
                                   "the blob has 'code 11, parts 0300");
    support_blob_recode(&blob);
    assert_int_equal(bound(), MASU_OK);
    field->part_count = 1;
    assert_refused("march SPIR-V", "parts 0300");
    support_blob_write(&blob, SUPPORT_ALL);
    support_blob_row(&blob, MASU_BLOB_SLOTS)->count = 1;
    assert_refused("march SPIR-V", "slots 00003");
    support_blob_write(&blob, SUPPORT_ALL);
    field = support_blob_find(&blob, MASU_BLOB_SDF);
    field->block_words = 2;
    assert_refused("march SPIR-V", "words 0");
    support_blob_write(&blob, SUPPORT_ALL);
    field = support_blob_find(&blob, MASU_BLOB_SDF);
    field->flags = MASU_SDF_ANCHORED;
    assert_refused("march SPIR-V", "in place");
    /* The code reads the second half of the slots, which no longer exists. */
    support_blob_write(&blob, SUPPORT_ALL);
    support_blob_drop(&blob, MASU_BLOB_UPDATE_PREVIOUS_SPIRV);
    support_blob_drop(&blob, MASU_BLOB_UPDATE_SPIRV);
    assert_refused("march SPIR-V", "moves");
}

static void code_of_one_pass_as_that_of_another_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    support_blob_row(&blob, MASU_BLOB_CONE8_SPIRV)->kind = MASU_BLOB_KIND_COUNT;
    support_blob_row(&blob, MASU_BLOB_CONE4_SPIRV)->kind = MASU_BLOB_CONE8_SPIRV;
    for (uint32_t i = 0; i < ((masu_blob_header *)(void *)blob.bytes)->section_count; i++) {
        masu_blob_section *rows =
            (masu_blob_section *)(void *)(blob.bytes + sizeof(masu_blob_header));
        if (rows[i].kind == MASU_BLOB_KIND_COUNT) rows[i].kind = MASU_BLOB_CONE4_SPIRV;
    }
    assert_refused("cone8 SPIR-V", "made for 'code 15");
}

static void code_that_does_not_say_what_for_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    uint32_t *words = words_of(MASU_BLOB_MARCH_SPIRV);
    uint64_t at =
        masu_module_record_place(words, support_blob_row(&blob, MASU_BLOB_MARCH_SPIRV)->count) -
        MASU_MODULE_RECORD_WORDS;
    words[at + 2] = 0x0A0A0A0Au; /* none of its lines reaches a message */
    assert_refused("march SPIR-V", "made for '?'");
    assert_null(strchr(detail.text, '\n'));
    words[at] = OP(MASU_MODULE_RECORD_WORDS, 7); /* OpString: a text, but not the record */
    assert_refused("march SPIR-V", "none that shaders are made of");
}

/* ---- Malformed modules ----------------------------------------------------------------------- */

typedef struct change {
    uint32_t at, value;
    const char *why;
} change;

/* Offsets into the smallest module: tests/support/blob.c. */
enum { CAPABILITY = 5, MODEL = 7, ENTRY = 10, MODE = 15, TAIL = 21 + MASU_MODULE_RECORD_WORDS };

static void what_no_pass_could_run_is_refused(void **state) {
    (void)state;
    const change changes[] = {
        {1, 0x00010300, "version"},
        {3, 0, "ids"},
        {3, 65537, "ids"},
        {3, 4, "bound"},
        {4, 1, "schema"},
        {CAPABILITY, 0, "beyond the end"},
        {CAPABILITY, OP(2000, 17), "beyond the end"},
        {CAPABILITY, OP(2, 18), "none that shaders are made of"},
        {CAPABILITY + 1, 6, "capability"}, /* Kernel */
        {CAPABILITY + 1, 11, "capability"}, /* Int64 */
        {MODEL + 1, 1, "memory model"},
        {MODEL + 2, 3, "memory model"},
        {ENTRY + 1, 4, "another stage"},
        {ENTRY + 2, 3, "of no entry point"},
        {ENTRY + 3, 0x6E69616Eu, "main"},
        {ENTRY + 4, 1, "main"},
        {MODE + 1, 2, "no entry point"},
        {MODE + 3, 4, "local size"},
        {MODE + 4, 1, "local size"},
        {MODE + 5, 2, "local size"},
        {MODE + 2, 18, "local size"},
        {TAIL + 7, 0, "bound"},
        {TAIL + 1, 3, "defined twice"},
        {TAIL + 1, 5, "bound"},
        {TAIL + 4, 4, "nothing has defined"},
        {TAIL, OP(2, 248), "outside of functions"},
        {TAIL, OP(2, 17), "wrong section"},
        {TAIL + 6, 4, "nothing has defined"},
        {TAIL + 9, 4, "defined"},
        {TAIL + 12, OP(1, 56), "within a block"},
        {TAIL + 13, OP(1, 253), "in no block"},
    };
    for (size_t k = 0; k < COUNT(changes); k++) {
        support_blob_write(&blob, SUPPORT_ALL);
        words_of(MASU_BLOB_MARCH_SPIRV)[changes[k].at] = changes[k].value;
        assert_refused("march SPIR-V", changes[k].why);
    }
}

/* Only what every device has and GLSL of the passes needs: Matrix, Shader, ImageQuery,
 * DerivativeControl. */
static void every_other_capability_is_refused(void **state) {
    (void)state;
    for (uint32_t capability = 0; capability < 128; capability++) {
        support_blob_write(&blob, SUPPORT_ALL);
        words_of(MASU_BLOB_MARCH_SPIRV)[CAPABILITY + 1] = capability;
        if (capability != 0 && capability != 1 && capability != 50 && capability != 51)
            assert_refused("march SPIR-V", "capability");
        else
            assert_int_equal(bound(), MASU_OK);
    }
}

static void a_module_that_is_cut_anywhere_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    uint64_t count = support_blob_row(&blob, MASU_BLOB_MARCH_SPIRV)->count;
    for (uint64_t left = 1; left < count; left++) {
        support_blob_write(&blob, SUPPORT_ALL);
        support_blob_row(&blob, MASU_BLOB_MARCH_SPIRV)->count = left;
        assert_refused("march SPIR-V", "scene blob: march SPIR-V");
    }
}

/* ---- Required resources ---------------------------------------------------------------------- */

enum { EXTENSION = 7 };
static const char extension[40] = "SPV_KHR_storage_buffer_storage_class";

/* A module with one resource, of this class, in set and binding. */
static uint32_t resource_module(uint32_t *words, uint32_t set, uint32_t binding, uint32_t class) {
    static const uint32_t storage[] = {0, 2, 12, 0, 0, 9};
    uint32_t head[] = {0x07230203u, 0x00010000u, 0, 16, 0, OP(2, 17), 1, OP(11, 10),
                       [18] = OP(3, 14), 0, 1, OP(5, 15), 5, 1, 0x6E69616Du, 0,
                       OP(6, 16), 1, 17, 8, 8, 1};
    const uint32_t globals[] = {OP(5, 72),
                                8,
                                0,
                                35,
                                24, /* Offset of the block's member */
                                OP(3, 22),
                                5,
                                32,
                                OP(4, 23),
                                6,
                                5,
                                4,
                                OP(9, 25),
                                7,
                                5,
                                1,
                                0,
                                0,
                                0,
                                class == MASU_MODULE_SAMPLED ? 1u : 2u,
                                0,
                                OP(3, 30),
                                8,
                                5,
                                OP(3, 27),
                                9,
                                7,
                                OP(4, 32),
                                10,
                                storage[class],
                                class == MASU_MODULE_SAMPLED ? 9u
                                : class == MASU_MODULE_IMAGE ? 7u
                                                             : 8u,
                                OP(4, 59),
                                10,
                                11,
                                storage[class]};
    const uint32_t bind[] = {OP(4, 71), 11, 34, set, OP(4, 71), 11, 33, binding};
    const uint32_t tail[] = {OP(2, 19), 2, OP(3, 33), 3,          2, OP(5, 54),  2,
                             1,         0, 3,         OP(2, 248), 4, OP(1, 253), OP(1, 56)};
    uint32_t n = COUNT(head);
    memcpy(head + EXTENSION + 1, extension, sizeof extension);
    memcpy(words, head, sizeof head);
    if (class <= MASU_MODULE_IMAGE) {
        memcpy(words + n, bind, sizeof bind);
        n += COUNT(bind);
    }
    memcpy(words + n, globals, sizeof globals);
    n += COUNT(globals);
    memcpy(words + n, tail, sizeof tail);
    return n + COUNT(tail);
}

static void what_a_module_asks_for_is_found(void **state) {
    (void)state;
    uint32_t words[128];
    masu_module code;
    uint64_t at;
    for (uint32_t class = MASU_MODULE_UNIFORMS; class <= MASU_MODULE_IMAGE; class++) {
        uint32_t count = resource_module(words, 1, 7, class);
        assert_null(masu_module_read(words, count, &code, &at));
        assert_int_equal(code.bound_count, 1);
        assert_int_equal(code.bound[0].set, 1);
        assert_int_equal(code.bound[0].binding, 7);
        assert_int_equal(code.bound[0].class, class);
        assert_int_equal(code.push_bytes, 0);
        assert_int_equal(code.model, 5);
        assert_int_equal(code.local_size[0], 8);
        assert_null(code.record);
    }
    uint32_t count = resource_module(words, 0, 0, 5);
    assert_null(masu_module_read(words, count, &code, &at));
    assert_int_equal(code.push_bytes, 28);
    assert_int_equal(code.bound_count, 0);
    words[36] = 128; /* the offset: beyond all device limits */
    assert_non_null(masu_module_read(words, count, &code, &at));
}

/* A Vulkan 1.0 device has no other storage for storage buffers, and no other extension. */
static void the_storage_class_is_the_only_extension(void **state) {
    (void)state;
    uint32_t words[128];
    masu_module code;
    uint64_t at;
    uint32_t count = resource_module(words, 1, 7, MASU_MODULE_STORAGE);
    assert_null(masu_module_read(words, count, &code, &at));
    for (uint32_t k = 1; k < 11; k++) {
        words[EXTENSION + k] ^= 1;
        assert_string_equal(masu_module_read(words, count, &code, &at),
                            "an extension is asked for that no pass has");
        assert_int_equal(at, EXTENSION);
        words[EXTENSION + k] ^= 1;
    }
    memmove(words + EXTENSION, words + EXTENSION + 11, (count - EXTENSION - 11) * sizeof *words);
    assert_string_equal(masu_module_read(words, count - 11, &code, &at),
                        "storage buffers need SPV_KHR_storage_buffer_storage_class");
    count = resource_module(words, 1, 7, MASU_MODULE_UNIFORMS);
    memmove(words + EXTENSION, words + EXTENSION + 11, (count - EXTENSION - 11) * sizeof *words);
    assert_null(masu_module_read(words, count - 11, &code, &at));
}

/* The march pass: cone4 as a sampled image, three storage images; frame, counters, slots, tiles. */
static void a_resource_that_the_pass_does_not_bind_is_refused(void **state) {
    (void)state;
    for (uint32_t set = 0; set < 4; set++) {
        for (uint32_t binding = 0; binding < 70; binding++) {
            for (uint32_t class = MASU_MODULE_UNIFORMS; class <= MASU_MODULE_IMAGE; class++) {
                uint32_t words[160], count = resource_module(words, set, binding, class);
                uint32_t place = (uint32_t)masu_module_record_place(words, count);
                memmove(words + place + MASU_MODULE_RECORD_WORDS, words + place,
                        4 * (count - place));
                words[place] = MASU_MODULE_RECORD_FIRST;
                support_blob_write(&blob, SUPPORT_ALL);
                masu_blob_section *march = support_blob_row(&blob, MASU_BLOB_MARCH_SPIRV);
                memcpy(words + place, words_of(MASU_BLOB_MARCH_SPIRV) + 21,
                       4 * MASU_MODULE_RECORD_WORDS);
                /* After everything else, where the buffer has room. */
                blob.size = (blob.size + 15) / 16 * 16;
                march->offset = blob.size;
                march->count = count + MASU_MODULE_RECORD_WORDS;
                memcpy(blob.bytes + blob.size, words, 4 * march->count);
                blob.size += 4 * march->count;
                int known = set == 0   ? binding == MASU_BIND_FRAME ? class == MASU_MODULE_UNIFORMS
                                         : binding == MASU_BIND_SLOTS || binding == MASU_BIND_TILES ||
                                               binding == MASU_BIND_COUNTERS
                                             ? class == MASU_MODULE_STORAGE
                                             : 0
                            : set == 1 ? binding == 0 ? class == MASU_MODULE_SAMPLED
                                                      : binding <= 4 && class == MASU_MODULE_IMAGE
                                       : 0;
                if (known)
                    assert_int_equal(bound(), MASU_OK);
                else
                    assert_refused("march SPIR-V", "does not bind");
            }
        }
    }
}

/* ---- Arbitrary content ----------------------------------------------------------------------- */

/* Each 32-bit value of a small module, changed in many ways, one at a time: the check ends, and
 * reads only the module (tests/support/bind.c has an unreadable page after it). */
static void any_word_gives_an_answer(void **state) {
    (void)state;
    static const uint32_t values[] = {
        0, 1, 2, 5, 0xFFFF, 0x10000, 0x20011, 0x5000F, 0x1000F, 0x80000000, 0xFFFFFFFF, 0x0001003B};
    support_blob_write(&blob, SUPPORT_SDF);
    uint64_t count = support_blob_row(&blob, MASU_BLOB_MARCH_SPIRV)->count;
    uint32_t refused = 0, tried = 0;
    for (uint64_t at = 0; at < count; at++) {
        for (size_t k = 0; k < COUNT(values); k++) {
            uint32_t *words = words_of(MASU_BLOB_MARCH_SPIRV), was = words[at];
            words[at] = values[k];
            refused += bound() != MASU_OK;
            tried++;
            words[at] = was;
        }
    }
    assert_true(refused > tried * 9 / 10);
    assert_int_equal(bound(), MASU_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(other_counts_than_the_code_was_compiled_for_are_refused),
        cmocka_unit_test(code_of_one_pass_as_that_of_another_is_refused),
        cmocka_unit_test(code_that_does_not_say_what_for_is_refused),
        cmocka_unit_test(what_no_pass_could_run_is_refused),
        cmocka_unit_test(every_other_capability_is_refused),
        cmocka_unit_test(a_module_that_is_cut_anywhere_is_refused),
        cmocka_unit_test(what_a_module_asks_for_is_found),
        cmocka_unit_test(the_storage_class_is_the_only_extension),
        cmocka_unit_test(a_resource_that_the_pass_does_not_bind_is_refused),
        cmocka_unit_test(any_word_gives_an_answer),
    };
    return cmocka_run_group_tests_name("code", tests, support_make_edge, NULL);
}
