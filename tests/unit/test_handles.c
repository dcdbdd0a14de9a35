/* test_handles.c: handles of the public interface: each identifies one object; handles of another
 * scene, of another kind or of a removed object are rejected. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "frame/handles.h"
#include "support/bind.h"
#include "support/dry_renderer.h"

static masu_detail failure; /* of the last call that failed */

#define COUNT(a) (sizeof(a) / sizeof *(a))

/* ---- Ranges ---------------------------------------------------------------------------------- */

static void a_handle_is_its_index_and_back(void **state) {
    (void)state;
    static const uint32_t counts[] = {0, 1, 3, 4096, 1u << 31, UINT32_MAX - 1, UINT32_MAX};
    for (uint64_t scene = 0; scene < 200; scene++) {
        for (size_t c = 0; c < COUNT(counts); c++) {
            uint32_t count = counts[c], index;
            masu_handles h = masu_handles_of(scene, MASU_HANDLE_INSTANCE, count, 0, NULL);
            masu_detail detail;
            assert_int_equal(masu_handle_check(&h, "thing", 0, &index, &detail),
                             MASU_ERROR_ARGUMENT);
            assert_string_equal(detail.what, "thing");
            assert_int_equal(detail.needed, count);
            assert_int_equal(masu_handle_at(&h, count), 0);
            assert_int_equal(masu_handle_at(&h, UINT32_MAX), 0);
            const uint32_t looked_at[] = {0, 1, count / 2, count - 1};
            for (size_t k = 0; k < COUNT(looked_at); k++) {
                uint64_t id = masu_handle_at(&h, looked_at[k]);
                if (looked_at[k] >= count) continue;
                assert_true(id != 0);
                assert_int_equal(masu_handle_check(&h, "thing", id, &index, NULL), MASU_OK);
                assert_int_equal(index, looked_at[k]);
                assert_int_not_equal(
                    masu_handle_check(&h, "thing", id | 1ull << 32, &index, &detail), MASU_OK);
                assert_int_equal(detail.given, id | 1ull << 32);
            }
        }
    }
}

/* The ids of a scene's own objects do not depend on the reserve. */
static void a_reserve_changes_no_id_of_the_scene(void **state) {
    (void)state;
    uint32_t lives[5];
    masu_handles without = masu_handles_of(77, MASU_HANDLE_LIGHT, 4, 0, NULL);
    masu_handles with = masu_handles_of(77, MASU_HANDLE_LIGHT, 4, 5, lives);
    for (uint32_t i = 0; i < 4; i++)
        assert_true(masu_handle_at(&without, i) == masu_handle_at(&with, i));
}

/* Each object in a slot of the reserve has a new id, which is rejected after its removal, as is 0
 * for a free slot. A slot is used 2^31 - 1 times. */
static void what_was_removed_is_refused(void **state) {
    (void)state;
    enum { LIVES = 70000 };
    static const uint32_t reserves[] = {1, 3, 64, 16384, 1u << 20};
    static uint32_t lives[1u << 20];
    for (size_t c = 0; c < COUNT(reserves); c++) {
        uint32_t reserve = reserves[c], own = 7, index, last = own + reserve - 1;
        masu_handles h = masu_handles_of(c, MASU_HANDLE_MODEL, own, reserve, lives);
        masu_detail detail;
        assert_int_equal(masu_handle_at(&h, own), 0);
        assert_int_equal(masu_handle_free(&h, own, reserve), own);
        assert_int_equal(masu_handle_check(&h, "model", 0, &index, &detail), MASU_ERROR_ARGUMENT);
        uint64_t first = 0, before = 0;
        for (uint32_t life = 0; life < LIVES; life++) {
            masu_handle_turn(&h, last);
            uint64_t id = masu_handle_at(&h, last);
            assert_true(id != 0 && id > before);
            assert_int_equal(masu_handle_check(&h, "model", id, &index, NULL), MASU_OK);
            assert_int_equal(index, last);
            if (before) {
                assert_int_equal(masu_handle_index(&h, before), UINT32_MAX);
                assert_int_equal(masu_handle_index(&h, first), UINT32_MAX);
            }
            masu_handle_turn(&h, last);
            assert_int_equal(masu_handle_at(&h, last), 0);
            before = id;
            if (!life) first = id;
        }
        assert_int_equal(masu_handle_check(&h, "model", before, &index, &detail),
                         MASU_ERROR_ARGUMENT);
        assert_non_null(strstr(detail.text, "removed"));
        for (uint32_t i = 0; i < own; i++) /* the ids of the scene remain valid */
            assert_int_equal(masu_handle_index(&h, masu_handle_at(&h, i)), i);
        /* one more object in each */
        for (uint32_t i = 0; i < reserve; i++) lives[i] = UINT32_MAX - 3;
        assert_int_equal(masu_handle_free(&h, own, reserve), own);
        masu_handle_turn(&h, own);
        uint64_t id = masu_handle_at(&h, own);
        assert_int_equal(masu_handle_index(&h, id), own);
        masu_handle_turn(&h, own);
        assert_int_equal(masu_handle_index(&h, id), UINT32_MAX);
        assert_int_equal(masu_handle_free(&h, own, reserve),
                         reserve > 1 ? own + 1 : UINT32_MAX); /* that slot is retired */
    }
}

/* Hashes that differ in one bit, and the kinds of one scene, have ranges far from each other. */
static void ranges_of_others_do_not_meet(void **state) {
    (void)state;
    enum { HASHES = 65, KINDS = 3, ALL = HASHES * KINDS };
    masu_handles all[ALL];
    for (uint32_t i = 0; i < HASHES; i++) {
        uint64_t scene = 0x0123456789ABCDEFu ^ (i ? 1ull << (i - 1) : 0);
        for (uint32_t k = 0; k < KINDS; k++)
            all[KINDS * i + k] = masu_handles_of(scene, (masu_handle_kind)(k + 1), 1000, 0, NULL);
    }
    for (uint32_t a = 0; a < ALL; a++) {
        for (uint32_t b = 0; b < ALL; b++) {
            uint32_t first = masu_handle_index(&all[a], masu_handle_at(&all[b], 0));
            uint32_t last = masu_handle_index(&all[a], masu_handle_at(&all[b], 999));
            if (a != b && (first < 1000 || last < 1000))
                fail_msg("%u: from %u, %u: from %u", a, all[a].offset, b, all[b].offset);
        }
    }
}

/* ---- Renderers ------------------------------------------------------------------------------- */

#define REFUSED(what_, call)                                                                       \
    do {                                                                                           \
        m.error = (masu_detail){0};                                                                \
        assert_int_equal(call, MASU_ERROR_ARGUMENT);                                               \
        if (!failure.what || strcmp(failure.what, what_))                \
            fail_msg("%s: %s", #call, failure.text);                                  \
    } while (0)

static void handles_of_another_scene_are_refused(void **state) {
    (void)state;
    static const float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const uint32_t with = SUPPORT_ALL | SUPPORT_LIVE | SUPPORT_LIGHTING;
    masu_instance_state instance;
    masu_model_state model;
    masu_node_state node;
    masu_punctual_light_state light;
    make_renderer(with, 0);
    masu_instance instance_of = masu_instance_at(&m, 0);
    masu_model model_of = masu_model_at(&m, 0), added;
    masu_punctual_light light_of = masu_punctual_light_at(&m, 0);
    assert_true(instance_of.id && model_of.id && light_of.id);
    assert_int_equal(masu_punctual_light_get(&m, light_of, &light, &failure), MASU_OK);
    light.instance = instance_of;
    assert_int_equal(masu_punctual_light_set(&m, light_of, &light, &failure), MASU_OK);
    masu_punctual_light_state carried;
    assert_int_equal(masu_punctual_light_get(&m, light_of, &carried, &failure), MASU_OK);
    assert_int_equal(carried.instance.id, instance_of.id);

    make_renderer(with, 0); /* another renderer of the same scene: the same objects */
    assert_int_equal(masu_instance_at(&m, 0).id, instance_of.id);
    assert_int_equal(masu_model_at(&m, 0).id, model_of.id);
    assert_int_equal(masu_punctual_light_at(&m, 0).id, light_of.id);

    make_renderer(with & ~SUPPORT_SDF, 0); /* another scene */
    assert_true(masu_instance_at(&m, 0).id && masu_model_at(&m, 0).id);
    assert_true(masu_punctual_light_at(&m, 0).id);
    REFUSED("instance", masu_instance_get(&m, instance_of, &instance, &failure));
    REFUSED("instance", masu_instance_set_transform(&m, instance_of, rows, &failure));
    REFUSED("instance", masu_instance_show(&m, instance_of, 0, &failure));
    REFUSED("model", masu_model_get(&m, model_of, &model, &failure));
    REFUSED("model", masu_model_set_transform(&m, model_of, rows, &failure));
    REFUSED("model", masu_model_show(&m, model_of, 0, &failure));
    REFUSED("model", masu_model_add(&m, model_of, rows, &added, &failure));
    REFUSED("model", masu_model_node_get(&m, model_of, 0, &node, &failure));
    REFUSED("model", masu_model_node_set(&m, model_of, 0, rows, &failure));
    assert_int_equal(masu_model_node_find(&m, model_of, "plate"), MASU_NODE_NONE);
    REFUSED("light", masu_punctual_light_get(&m, light_of, &carried, &failure));
    REFUSED("light", masu_punctual_light_set(&m, light_of, &light, &failure));
    REFUSED("instance",
            masu_punctual_light_set(&m, masu_punctual_light_at(&m, 0), &light, &failure));
    assert_non_null(strstr(failure.text, "light 0: instance handle"));
    assert_int_equal(masu_punctual_light_get(&m, masu_punctual_light_at(&m, 0), &carried, &failure),
                     MASU_OK);
    assert_int_not_equal(carried.instance.id, light.instance.id);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_handle_is_its_index_and_back),
        cmocka_unit_test(a_reserve_changes_no_id_of_the_scene),
        cmocka_unit_test(what_was_removed_is_refused),
        cmocka_unit_test(ranges_of_others_do_not_meet),
        cmocka_unit_test(handles_of_another_scene_are_refused),
    };
    return cmocka_run_group_tests(tests, support_make_edge, NULL);
}
