/* test_models.c: movable models: each rule for them in a blob, broken one at a time; effects of
 * moving, hiding and adding them on the host's data; rejected calls, which change nothing. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "frame/meshes.h"
#include "plan/compile.h"
#include "support/bind.h"
#include "support/desc.h"
#include "support/dry_renderer.h"
#include "support/scene_data.h"

static masu_detail failure; /* of the last call that failed */

/* ---- Rules of the blob ----------------------------------------------------------------------- */

static support_blob broken;

#define MODEL ((masu_blob_model *)support_blob_find(&broken, MASU_BLOB_MODELS))
#define NODE ((masu_blob_model_node *)support_blob_find(&broken, MASU_BLOB_MODEL_NODES))

#define REFUSED(section, element, ...)                                                             \
    do {                                                                                           \
        masu_scene scene;                                                                          \
        masu_detail detail;                                                                        \
        support_blob_write(&broken, SUPPORT_ALL | SUPPORT_LIVE);                                   \
        __VA_ARGS__;                                                                               \
        support_blob_seal(broken.bytes, broken.size);                                              \
        if (!support_bind(broken.bytes, broken.size, &scene, &detail))                             \
            fail_msg("%s was accepted", #__VA_ARGS__);                                             \
        assert_int_equal(detail.result, MASU_ERROR_SCENE);                                         \
        if (strcmp(detail.what, section) || detail.given != (element))                             \
            fail_msg("%s was rejected as %s", #__VA_ARGS__, detail.text);                          \
    } while (0)

static void a_blob_tells_its_models(void **state) {
    (void)state;
    masu_scene scene;
    support_blob_write(&broken, SUPPORT_ALL | SUPPORT_LIVE);
    support_accepted(&broken, &scene);
    assert_int_equal(masu_scene_count(&scene, MASU_SCENE_MODEL), 3);
    assert_int_equal(masu_scene_data_of(&scene)->model_nodes, 4);
    support_scene_data(&scene)->blob = broken.bytes;
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_MODEL, 0), "plate");
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_MODEL, 1), "");
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_MODEL, 2), "lid");
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_MODEL, 3), "");
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_INSTANCE, 2), "lid");
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_INSTANCE, 3), "");
    assert_string_equal(masu_scene_name(&scene, MASU_SCENE_LIGHT, 0), "");
    assert_string_equal(masu_scene_name(NULL, MASU_SCENE_MODEL, 0), "");
}

static void models_that_are_none_are_refused(void **state) {
    (void)state;
    REFUSED("models", 0, support_blob_drop(&broken, MASU_BLOB_MODEL_NODES));
    REFUSED("models", 0, support_blob_drop(&broken, MASU_BLOB_MODELS));
    REFUSED("models", 1, MODEL[1].transform[7] = (float)NAN);
    REFUSED("models", 2, MODEL[2].name = 1u << 20);
    REFUSED("models", 0, MODEL[0].flags = 2);
    REFUSED("models", 0, MODEL[0].first_node = 1);
    REFUSED("models", 1, MODEL[1].node_count = 0);
    REFUSED("models", 2, MODEL[2].node_count = 3);
    REFUSED("models", 2, MODEL[2].node_count = UINT32_MAX);
    REFUSED("model nodes", 3, MODEL[2].node_count = 1);
    REFUSED("models", 0, MODEL[0].like = 1);
    REFUSED("models", 1, MODEL[1].like = UINT32_MAX);
    REFUSED("models", 2, MODEL[2].like = 0);
    REFUSED("models", 2, MODEL[2].like = 1); /* which is a copy itself */
    REFUSED("models", 1, NODE[1].instance = 2); /* another mesh than its original's */
    REFUSED("models", 1, NODE[1].instance = MASU_BLOB_NONE);
    REFUSED("model nodes", 0, NODE[0].local[0] = INFINITY);
    REFUSED("model nodes", 3, NODE[3].instance = 3);
    REFUSED("model nodes", 3, NODE[3].parent = 3);
    REFUSED("model nodes", 3, NODE[3].parent = 1); /* of another model */
    REFUSED("model nodes", 2, NODE[2].parent = 3);
    REFUSED("model nodes", 2, NODE[2].name = 1u << 20);
}

/* ---- Operations ------------------------------------------------------------------------------ */

static const float there[12] = {1, 0, 0, 10, 0, 1, 0, 20, 0, 0, 1, 30};

static void assert_rows(const float *rows, const float *expected) {
    for (uint32_t k = 0; k < 12; k++) {
        if (rows[k] != expected[k])
            fail_msg("rows[%u] is %g, expected %g", k, (double)rows[k], (double)expected[k]);
    }
}

static void models_and_nodes_are_found(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE, 0);
    masu_model lid = masu_model_find(&m, "lid");
    assert_int_equal(lid.id, masu_model_at(&m, 2).id);
    assert_int_equal(masu_model_find(&m, "steel").id, 0);
    assert_int_equal(masu_model_at(&m, 3).id, 0);
    assert_int_equal(masu_model_node_find(&m, lid, "bend"), 0);
    assert_int_equal(masu_model_node_find(&m, lid, "lid"), 1);
    assert_int_equal(masu_model_node_find(&m, lid, "plate"), MASU_NODE_NONE);
    assert_int_equal(masu_model_node_find(&m, (masu_model){0}, "lid"), MASU_NODE_NONE);
    masu_node_state node;
    assert_int_equal(masu_model_node_get(&m, lid, 1, &node, &failure), MASU_OK);
    assert_int_equal(node.parent, 0);
    assert_int_equal(node.instance.id, masu_instance_find(&m, "lid").id);
    masu_instance_state instance;
    assert_int_equal(masu_instance_get(&m, node.instance, &instance, &failure), MASU_OK);
    assert_int_equal(instance.model.id, lid.id);
    assert_int_equal(instance.mesh, 1);
    assert_int_equal(instance.index, 2);
    assert_rows(instance.rows, node.world);
    assert_true(instance.shown);
}

/* The lid is two nodes deep: rotated about y by the node above, moved by the model. */
static void a_model_carries_its_nodes(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE, 0);
    masu_model lid = masu_model_find(&m, "lid");
    masu_instance instance = masu_instance_find(&m, "lid");
    masu_instance_state is;
    masu_model_state model;
    assert_int_equal(masu_model_set_transform(&m, lid, there, &failure), MASU_OK);
    assert_int_equal(masu_instance_get(&m, instance, &is, &failure), MASU_OK);
    const float turned[12] = {0, 0, 1, 10, 0, 1, 0, 20, -1, 0, 0, 30};
    assert_rows(is.rows, turned);
    assert_int_equal(masu_model_get(&m, lid, &model, &failure), MASU_OK);
    assert_rows(model.rows, there);
    assert_int_equal(model.nodes, 2);
    for (uint32_t k = 0; k < 3; k++) { /* its mesh is 4 x 4 x 0, rotated */
        const float half[3] = {0, 2, 2};
        assert_true(fabsf(model.box_low[k] - (there[4 * k + 3] - half[k])) < 1e-4f);
        assert_true(fabsf(model.box_high[k] - (there[4 * k + 3] + half[k])) < 1e-4f);
        assert_true(model.box_low[k] == is.box_low[k] && model.box_high[k] == is.box_high[k]);
    }
    const float up[12] = {1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 2};
    assert_int_equal(masu_model_node_set(&m, lid, 1, up, &failure), MASU_OK);
    assert_int_equal(masu_instance_get(&m, instance, &is, &failure), MASU_OK);
    /* the node's z axis is x in the world */
    const float raised[12] = {0, 0, 1, 12, 0, 1, 0, 21, -1, 0, 0, 30};
    assert_rows(is.rows, raised);
    /* The others have not moved. */
    assert_int_equal(masu_instance_get(&m, masu_instance_at(&m, 0), &is, &failure), MASU_OK);
    const float unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_rows(is.rows, unit);
}

/* Positions of nodes far from the origin are exact to the 48 bits of two floats. */
static void a_double_position_is_exact(void **state) {
    (void)state;
    const double away[3] = {10000000.3, -2.7, 1e12 + 0.125}, nowhere[3] = {0, HUGE_VAL, 0};
    masu_instance_state is;
    masu_model_state model;
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE, 0);
    masu_model lid = masu_model_find(&m, "lid");
    masu_instance instance = masu_instance_find(&m, "lid");
    assert_int_equal(masu_model_set_position(&m, lid, away, &failure), MASU_ERROR_STATE);
    assert_int_equal(masu_instance_set_position(&m, instance, away, &failure), MASU_ERROR_STATE);
    static float low[4][3], previous_low[4][3];
    static double offsets[4][3];
    assert_true(m.plan.scene.instances <= 4 && m.plan.scene.models <= 4);
    m.plan.desc.double_positions = 1;
    m.instances.low = low;
    m.instances.previous_low = previous_low;
    m.models.offsets = offsets;
    const float up[12] = {1, 0, 0, 0.25f, 0, 1, 0, 0.5f, 0, 0, 1, 0};
    assert_int_equal(masu_model_node_set(&m, lid, 1, up, &failure), MASU_OK);
    assert_int_equal(masu_instance_get(&m, instance, &is, &failure), MASU_OK);
    assert_int_equal(masu_model_get(&m, lid, &model, &failure), MASU_OK);
    double inside[3];
    for (int k = 0; k < 3; k++) inside[k] = is.position[k] - model.position[k];
    assert_int_equal(masu_model_set_position(&m, lid, away, &failure), MASU_OK);
    assert_int_equal(masu_instance_get(&m, instance, &is, &failure), MASU_OK);
    assert_int_equal(masu_model_get(&m, lid, &model, &failure), MASU_OK);
    for (int k = 0; k < 3; k++) {
        assert_true(model.position[k] == away[k] && model.rows[4 * k + 3] == (float)away[k]);
        assert_true(fabs(is.position[k] - (away[k] + inside[k])) <= fabs(away[k]) * 0x1p-47 + 1e-6);
        assert_true(is.rows[4 * k + 3] == (float)is.position[k]);
    }
    assert_int_equal(masu_model_set_position(&m, lid, nowhere, &failure), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.text, "position[1] is inf"));
    assert_int_equal(masu_instance_set_position(&m, instance, nowhere, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_set_position(&m, instance, away, &failure), MASU_OK);
    assert_int_equal(masu_instance_get(&m, instance, &is, &failure), MASU_OK);
    assert_true(fabs(is.position[0] - away[0]) < 1e-6);
    assert_int_equal(masu_model_set_transform(&m, lid, there, &failure),
                     MASU_OK); /* takes it back */
    assert_int_equal(masu_model_get(&m, lid, &model, &failure), MASU_OK);
    assert_rows(model.rows, there);
    for (int k = 0; k < 3; k++) assert_true(model.position[k] == (double)there[4 * k + 3]);
}

static void what_cannot_be_changes_nothing(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE, 0);
    masu_model lid = masu_model_find(&m, "lid"), none = {0}, beyond = {lid.id + 1};
    masu_model_state before, after;
    masu_node_state node;
    assert_int_equal(masu_model_get(&m, lid, &before, &failure), MASU_OK);
    float bad[12];
    memcpy(bad, there, sizeof bad);
    bad[5] = (float)NAN;
    assert_int_equal(masu_model_set_transform(&m, lid, bad, &failure), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.text, "rows[5] is nan"));
    assert_int_equal(masu_model_node_set(&m, lid, 0, bad, &failure), MASU_ERROR_ARGUMENT);
    const float far_out[12] = {3e38f, 0, 0, 0, 0, 3e38f, 0, 0, 0, 0, 3e38f, 0};
    /* the sum is still a float */
    assert_int_equal(masu_model_node_set(&m, lid, 0, far_out, &failure), MASU_OK);
    assert_int_equal(masu_model_set_transform(&m, lid, far_out, &failure), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.text, "beyond"));
    assert_int_equal(masu_model_get(&m, lid, &after, &failure), MASU_OK);
    assert_rows(after.rows, before.rows);
    assert_int_equal(masu_model_set_transform(&m, none, there, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_set_transform(&m, beyond, there, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "model");
    assert_int_equal(masu_model_node_set(&m, lid, 2, there, &failure), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.text, "node 2 does not exist, the last one is 1"));
    assert_int_equal(masu_model_node_get(&m, lid, UINT32_MAX, &node, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_set_transform(&m, lid, NULL, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "rows is NULL");
    assert_int_equal(masu_model_get(&m, lid, NULL, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "out is NULL");
    assert_int_equal(masu_model_set_transform(NULL, lid, there, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_show(&m, (masu_instance){0}, 1, &failure), MASU_ERROR_ARGUMENT);
}

/* Hidden copies are shown one after the other, until none is left. */
static void a_spare_one_is_shown(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE, 0);
    masu_model plate = masu_model_find(&m, "plate"), added = {7};
    masu_instance_state is;
    assert_int_equal(m.instances.hidden_count, 1);
    assert_int_equal(masu_instance_get(&m, masu_instance_at(&m, 1), &is, &failure), MASU_OK);
    assert_false(is.shown);
    assert_int_equal(masu_model_add(&m, plate, there, &added, &failure), MASU_OK);
    assert_int_equal(added.id, masu_model_at(&m, 1).id);
    assert_int_equal(masu_instance_get(&m, masu_instance_at(&m, 1), &is, &failure), MASU_OK);
    assert_true(is.shown);
    assert_rows(is.rows, there);
    assert_int_equal(m.instances.hidden_count, 0);
    assert_int_equal(masu_model_add(&m, plate, there, &added, &failure), MASU_ERROR_LIMIT);
    assert_int_equal(added.id, 0);
    assert_int_equal(masu_model_show(&m, plate, 0, &failure), MASU_OK);
    assert_int_equal(masu_model_show(&m, plate, 0, &failure), MASU_OK); /* once is enough */
    assert_int_equal(m.instances.hidden_count, 1);
    assert_int_equal(masu_model_add(&m, masu_model_at(&m, 1), there, &added, &failure), MASU_OK);
    assert_int_equal(added.id, plate.id);
    /* A model of another kind cannot serve as a copy. */
    assert_int_equal(masu_model_show(&m, plate, 0, &failure), MASU_OK);
    assert_int_equal(masu_model_add(&m, masu_model_find(&m, "lid"), there, &added, &failure),
                     MASU_ERROR_LIMIT);
}

/* ---- Slots for copies ------------------------------------------------------------------------ */

static masu_frame_plan plan_with(uint32_t parts, masu_reserve reserve, uint32_t live) {
    static support_blob blob;
    static masu_scene of;
    masu_frame_plan plan;
    masu_detail detail;
    support_blob_write(&blob, parts);
    support_accepted(&blob, &of);
    masu_desc d = scene_desc(0, 1280, 720);
    d.scene = &of;
    d.reserve = reserve;
    d.mutable_materials = live;
    if (masu_compile(&d, 64, 64, &plan, &detail)) fail_msg("%s", detail.text);
    return plan;
}

/* Each slot has the size of the largest kind. A reserve of 0, or for models that cannot be copied,
 * changes no buffer. */
static void places_are_as_large_as_the_largest(void **state) {
    (void)state;
    static masu_frame_plan none, some;
    const masu_reserve empty = {.models = 0};
    none = plan_with(SUPPORT_ALL | SUPPORT_LIVE, empty, 0);
    assert_int_equal(none.buffers[MASU_BUFFER_LIVE_MATERIALS].bytes, 0);
    some = plan_with(SUPPORT_ALL | SUPPORT_LIVE, (masu_reserve){.models = 5, .lights = 3}, 1);
    assert_int_equal(some.scene.models, none.scene.models + 5);
    assert_int_equal(some.scene.model_nodes, none.scene.model_nodes + 5 * 2); /* the lid's */
    assert_int_equal(some.scene.instances, none.scene.instances + 5);
    assert_int_equal(some.scene.lights, none.scene.lights + 3);
    assert_int_equal(masu_own_models(&some), none.scene.models);
    assert_int_equal(masu_own_nodes(&some), none.scene.model_nodes);
    assert_int_equal(some.draws, none.draws);
    assert_true(some.listed >= none.listed + 5);
    uint64_t each = sizeof(struct masu_material_data);
    if (some.needs.traced) each += sizeof(struct masu_trace_material);
    assert_int_equal(masu_live_material_bytes(&some), some.scene.materials * each);
    assert_true(some.buffers[MASU_BUFFER_LIVE_MATERIALS].bytes >= 2 * some.scene.materials * each);
    none = plan_with(SUPPORT_ALL, empty, 0);
    some = plan_with(SUPPORT_ALL, (masu_reserve){.models = 5}, 0); /* nothing moves */
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++)
        assert_int_equal(some.buffers[b].bytes, none.buffers[b].bytes);
    assert_memory_equal(&some.scene, &none.scene, sizeof some.scene);
}

/* Each kind of meshes has a word, and what follows in the description is no kind. */
static void words_are_those_of_the_kinds_of_meshes(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static masu_blob_material materials[2];
    struct {
        masu_meshes meshes;
        uint32_t after[4];
    } s;
    const masu_scene_view view = {.materials = materials};
    memset(&s, 0x55, sizeof s);
    plan.scene.host_nodes = 1;
    plan.desc.reserve.meshes[MASU_MAX_MESH_KINDS - 1] = (masu_mesh_kind){.meshes = 1, .material = 1};
    plan.desc.reserve.mesh_upload = 64;
    masu_meshes_copy_scene(&s.meshes, &plan, &view);
    assert_int_equal(s.meshes.words[MASU_MAX_MESH_KINDS - 1], 1);
    assert_int_equal(s.meshes.words[0], 0x55555555);
    for (size_t i = 0; i < 4; i++) assert_int_equal(s.after[i], 0x55555555);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blob_tells_its_models),
        cmocka_unit_test(models_that_are_none_are_refused),
        cmocka_unit_test(models_and_nodes_are_found),
        cmocka_unit_test(a_model_carries_its_nodes),
        cmocka_unit_test(what_cannot_be_changes_nothing),
        cmocka_unit_test(a_double_position_is_exact),
        cmocka_unit_test(a_spare_one_is_shown),
        cmocka_unit_test(places_are_as_large_as_the_largest),
        cmocka_unit_test(words_are_those_of_the_kinds_of_meshes),
    };
    return cmocka_run_group_tests(tests, support_make_edge, NULL);
}
