/* test_scene_limits.c: limits and ranges of a blob's contents that small blobs (test_scene_rules.c)
 * cannot reach. Each check is called on sections in memory: accepted at the limit, rejected one
 * beyond it, by its own message. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/check.h"
#include "shared/masu_shared.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static masu_detail detail;
static reader r;

static void judge(masu_result result, const char *why, int line) {
    if (!why != !result || (why && !strstr(detail.text, why)))
        fail_msg("line %d: expected '%s', found '%s'", line, why ? why : "accepted",
                 result ? detail.text : "accepted");
}

/* A change of the sections, and the message of the check; NULL: accepted. */
#define TRY(set_up, check, why, ...)                                                               \
    do {                                                                                           \
        set_up();                                                                                  \
        __VA_ARGS__;                                                                               \
        judge(check(&r), why, __LINE__);                                                           \
    } while (0)

#define SECTION(KIND, member, array)                                                               \
    (r.view.member = (array), r.counts[MASU_BLOB_##KIND] = COUNT(array))

static void start(void) {
    memset(&r, 0, sizeof r);
    r.detail = &detail;
}

/* ---- Geometry -------------------------------------------------------------------------------- */

static masu_blob_vertex vertices[8];
static masu_blob_primitive primitives[8];
static masu_blob_mesh meshes[2];
static masu_blob_instance instances[2];
static masu_blob_lod lods[4];

/* Two meshes of one primitive; mesh 0 has three LODs. */
static void geometry(void) {
    static const uint32_t indices[6];
    start();
    memset(vertices, 0, sizeof vertices);
    for (uint32_t i = 0; i < COUNT(primitives); i++)
        primitives[i] = (masu_blob_primitive){.vertex_count = 1};
    primitives[0].index_count = 3;
    for (uint32_t i = 0; i < 2; i++)
        meshes[i] =
            (masu_blob_mesh){.first_primitive = i, .primitive_count = 1, .name = MASU_BLOB_NONE};
    for (uint32_t i = 0; i < COUNT(lods); i++)
        lods[i] = (masu_blob_lod){.first_primitive = 2 + i, .error = 1.0f};
    SECTION(VERTICES, vertices, vertices);
    SECTION(INDICES, indices, indices);
    SECTION(PRIMITIVES, primitives, primitives);
    SECTION(MESHES, meshes, meshes);
    SECTION(LODS, lods, lods);
    r.counts[MASU_BLOB_LODS] = 3;
    r.counts[MASU_BLOB_MATERIALS] = 2;
}

static void lods_are_coarser_forms_of_their_mesh(void **state) {
    (void)state;
#define LOD(why, ...) TRY(geometry, masu_check_geometry, why, __VA_ARGS__)
    LOD(NULL, (void)0);
    LOD("a mesh has more than three", r.counts[MASU_BLOB_LODS] = 4);
    LOD(NULL, (r.counts[MASU_BLOB_LODS] = 4, lods[3].mesh = 1));
    LOD("no such mesh", lods[2].mesh = 2);
    LOD("not sorted by mesh", lods[0].mesh = 1);
    LOD("negative or not finite", lods[0].error = -1e-6f);
    LOD(NULL, (lods[0].error = 0.0f, lods[2].error = 1e30f));
    LOD("negative or not finite", lods[2].error = 1.1e30f);
    LOD("falls from level to level", lods[1].error = 0.9f);
    LOD(NULL, lods[2].first_primitive = 7);
    LOD("outside their section", lods[2].first_primitive = 8);
    LOD(NULL, r.counts[MASU_BLOB_PRIMITIVES] = 5);
    LOD("shares primitives", (r.counts[MASU_BLOB_PRIMITIVES] = 4, lods[2].first_primitive = 3));
    LOD(NULL, primitives[2].material = primitives[3].material = primitives[4].material =
                  primitives[0].material = 1);
    LOD("another material", primitives[3].material = 1);
    LOD(NULL, primitives[3].index_count = 3);
    LOD("more triangles", (primitives[3].index_count = 3, primitives[0].index_count = 0));
    LOD("out of the bounds", primitives[4].aabb_max[1] = 1e-3f);
    LOD("no such material", primitives[7].material = 2);
    LOD("vertices lie outside", primitives[7].first_vertex = 8);
    LOD("indices lie outside", (primitives[7].first_index = 4, primitives[7].index_count = 3));
}

static void a_mesh_has_64_occluders(void **state) {
    (void)state;
    static masu_blob_occluder occluders[65];
    for (uint32_t n = 64; n <= 65; n++) {
        uint64_t pairs;
        geometry();
        SECTION(OCCLUDERS, occluders, occluders);
        r.counts[MASU_BLOB_OCCLUDERS] = n;
        judge(masu_check_occluders(&r, &pairs), n > 64 ? "over 64" : NULL, __LINE__);
        occluders[64].mesh = 1;
        judge(masu_check_occluders(&r, &pairs), NULL, __LINE__);
        occluders[64].mesh = 0;
    }
}

/* ---- Skins ----------------------------------------------------------------------------------- */

static masu_blob_model models[2];
static masu_blob_model_node nodes[2];
static masu_blob_skin skins[2];
static masu_blob_joint joints[65537];
static masu_blob_skin_vertex skin_vertices[3];

/* Two models of one node; the second skin shares joints and vertices with the first. */
static void skinned(void) {
    geometry();
    r.counts[MASU_BLOB_LODS] = 0;
    r.counts[MASU_BLOB_VERTICES] = 4;
    r.counts[MASU_BLOB_PRIMITIVES] = 2;
    for (uint32_t i = 0; i < 2; i++) {
        models[i] = (masu_blob_model){.first_node = i, .node_count = 1};
        nodes[i] = (masu_blob_model_node){.instance = i, .skin = i + 1};
        instances[i] = (masu_blob_instance){.mesh = i};
        primitives[i].first_vertex = 2 * i;
        primitives[i].vertex_count = 2;
        skins[i] = (masu_blob_skin){
            .model = i, .node = i, .first_vertex = 2 * i, .vertex_count = 2, .joint_count = 1};
    }
    for (uint32_t i = 0; i < COUNT(joints); i++) joints[i] = (masu_blob_joint){.used = 1};
    for (uint32_t i = 0; i < 3; i++)
        skin_vertices[i] = (masu_blob_skin_vertex){.weights = {65535, 0, 0, 0}};
    SECTION(MODELS, models, models);
    SECTION(MODEL_NODES, model_nodes, nodes);
    SECTION(INSTANCES, instances, instances);
    SECTION(SKINS, skins, skins);
    SECTION(JOINTS, joints, joints);
    SECTION(SKIN_VERTICES, skin_vertices, skin_vertices);
    r.counts[MASU_BLOB_JOINTS] = 1;
    r.counts[MASU_BLOB_SKIN_VERTICES] = 2;
}

static void skins_own_what_their_sections_have(void **state) {
    (void)state;
#define SKIN(why, ...) TRY(skinned, masu_check_skins, why, __VA_ARGS__)
    SKIN(NULL, (void)0);
    SKIN("follows those of skins", r.counts[MASU_BLOB_VERTICES] = 5);
    SKIN("vertices are none", r.counts[MASU_BLOB_VERTICES] = 3);
    SKIN("vertices are none", skins[0].vertex_count = 0);
    SKIN("not the next of the vertices", skins[1].first_vertex = 1);
    SKIN("skin vertices[2]: belongs to no skin", r.counts[MASU_BLOB_SKIN_VERTICES] = 3);
    SKIN("not the next of theirs", r.counts[MASU_BLOB_SKIN_VERTICES] = 1);
    SKIN("joints[1]: belongs to no skin", r.counts[MASU_BLOB_JOINTS] = 2);
    SKIN("morph targets[0]: belongs to no skin", r.counts[MASU_BLOB_MORPH_TARGETS] = 1);
    SKIN("belongs to no target", r.counts[MASU_BLOB_MORPH_DELTAS] = 1);
    SKIN("too many, or not the next", skins[0].target_count = 1);
    SKIN("outside its vertices", primitives[0].vertex_count = 3);
    SKIN("outside its vertices", primitives[1].first_vertex = 1);
    SKIN("of several instances", instances[1].mesh = 0);
    SKIN("of several instances", instances[0].mesh = 1);
    SKIN("no joints, or too many", skins[0].joint_count = 0);
    SKIN(NULL, skins[0].joint_count = skins[1].joint_count = r.counts[MASU_BLOB_JOINTS] = 65536);
    SKIN("no joints, or too many",
         skins[0].joint_count = skins[1].joint_count = r.counts[MASU_BLOB_JOINTS] = 65537);
    SKIN("lods[0]: is of a mesh that bends", r.counts[MASU_BLOB_LODS] = 1);
}

/* A skin that shares differs from the first in nothing but its vertices, model and node. */
static void a_shared_skin_is_like_the_first(void **state) {
    (void)state;
    static const size_t same[] = {
        offsetof(masu_blob_skin, vertex_count), offsetof(masu_blob_skin, first_skin_vertex),
        offsetof(masu_blob_skin, first_joint), offsetof(masu_blob_skin, joint_count),
        offsetof(masu_blob_skin, first_target), offsetof(masu_blob_skin, target_count),
        offsetof(masu_blob_skin, first_delta)};
    for (size_t i = 0; i < COUNT(same); i++) {
        SKIN("is not like the skin", {
            r.counts[MASU_BLOB_VERTICES] = 5;
            ++*(uint32_t *)(void *)((char *)&skins[1] + same[i]);
        });
    }
    SKIN("is not like the skin", models[1].like = 1);
    SKIN("not the next of theirs", skins[1].like = 2);
}

static void a_skinned_tree_has_as_many_nodes_as_its_pass_refits(void **state) {
    (void)state;
    static masu_blob_trace_mesh trees[2];
    r.view.trace_meshes = trees;
    for (uint32_t over = 0; over < 2; over++) {
        skinned();
        r.view.trace_meshes = trees;
        trees[1].node_count = 64 * MASU_SKIN_ROUNDS + over;
        judge(masu_check_skin_trees(&r), over ? "over 262,144 nodes" : NULL, __LINE__);
    }
    assert_int_equal(64 * MASU_SKIN_ROUNDS, 262144);
}

/* ---- Rays ------------------------------------------------------------------------------------ */

static masu_blob_trace_node trace_nodes[2];
static masu_blob_trace_triangle trace_triangles[2];
static masu_blob_trace_mesh trace_meshes[3];

/* One triangle in one leaf, of mesh 0. */
static void traced(void) {
    static const uint32_t of[] = {0};
    static const masu_blob_reflections reflections[] = {{0.5f, 100.0f, 0.25f, 0}};
    geometry();
    trace_nodes[0] =
        (masu_blob_trace_node){.packed = 128u | 128u << 8 | 128u << 16 | 2u << 24, .child = 1};
    memset(trace_triangles, 0, sizeof trace_triangles);
    memset(trace_meshes, 0, sizeof trace_meshes);
    trace_meshes[0] = (masu_blob_trace_mesh){.node_count = 1, .triangle_count = 1, .depth = 1};
    instances[0] = (masu_blob_instance){.mesh = 0};
    SECTION(INSTANCES, instances, instances);
    SECTION(TRACE_NODES, trace_nodes, trace_nodes);
    SECTION(TRACE_TRIANGLES, trace_triangles, trace_triangles);
    SECTION(TRACE_MESHES, trace_meshes, trace_meshes);
    SECTION(TRACE_INSTANCES, trace_instances, of);
    r.view.reflections = reflections;
    r.counts[MASU_BLOB_TRACE_NODES] = r.counts[MASU_BLOB_TRACE_TRIANGLES] = 1;
    r.counts[MASU_BLOB_TRACE_MESHES] = 2;
}

static void trees_hold_the_triangles_of_their_mesh(void **state) {
    (void)state;
#define RAYS(why, ...) TRY(traced, masu_check_trace, why, __VA_ARGS__)
    RAYS(NULL, (void)0);
    RAYS("more triangles than its mesh", primitives[0].index_count = 0);
    RAYS("not as many as meshes", r.counts[MASU_BLOB_TRACE_MESHES] = 1);
    RAYS("not as many as meshes", r.counts[MASU_BLOB_TRACE_MESHES] = 3);
    RAYS("trace nodes[1]: is of no mesh", r.counts[MASU_BLOB_TRACE_NODES] = 2);
    RAYS("trace triangles[1]: is of no mesh", r.counts[MASU_BLOB_TRACE_TRIANGLES] = 2);
    RAYS("is of another mesh", trace_triangles[0].primitive = 1);
    RAYS("vertex of another primitive", trace_triangles[0].vertex[2] = 1);
    RAYS("no such instance", r.counts[MASU_BLOB_INSTANCES] = 0);
}

/* ---- SDF ------------------------------------------------------------------------------------- */

static void numbers_of_parts_fit_their_shaders(void **state) {
    (void)state;
    static const uint32_t code[5] = {0x07230203u};
    static float slots[2 * MASU_BLOB_PART_SLOTS];
    static const float values[] = {0.0f, 65536.0f, -1e-3f, 65537.0f};
    static masu_blob_sdf sdf[1];
    sdf[0] = (masu_blob_sdf){.lipschitz = 1.0f, .max_distance = 1.0f, .part_count = 2};
    for (uint32_t at = 0; at < 2 * MASU_BLOB_PART_SLOTS; at++) {
        for (uint32_t i = 0; i < COUNT(values); i++) {
            start();
            r.view.sdf = sdf;
            r.view.slots = slots;
            r.view.slot_count = COUNT(slots);
            for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
                r.view.code[k].words = code;
                r.view.code[k].count = COUNT(code);
            }
            slots[at] = values[i];
            judge(masu_check_sdf(&r), i > 1 && at % 8 > 4 ? "form, a slot and a material" : NULL,
                  __LINE__);
        }
        slots[at] = 0.0f;
    }
    static const uint32_t other[5] = {0x07230204u};
    r.view.code[MASU_BLOB_MARCH_SPIRV].words = other;
    judge(masu_check_sdf(&r), "is missing or is no SPIR-V", __LINE__);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lods_are_coarser_forms_of_their_mesh),
        cmocka_unit_test(a_mesh_has_64_occluders),
        cmocka_unit_test(skins_own_what_their_sections_have),
        cmocka_unit_test(a_shared_skin_is_like_the_first),
        cmocka_unit_test(a_skinned_tree_has_as_many_nodes_as_its_pass_refits),
        cmocka_unit_test(trees_hold_the_triangles_of_their_mesh),
        cmocka_unit_test(numbers_of_parts_fit_their_shaders),
    };
    return cmocka_run_group_tests_name("scene_limits", tests, NULL, NULL);
}
