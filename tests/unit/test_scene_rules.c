/* test_scene_rules.c: the rules for the contents of a blob. Each is broken separately, in an
 * otherwise good and well-sealed blob; the error names the section and the element. Content just
 * within a rule is accepted. */
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

#define COUNT(array) (sizeof(array) / sizeof *(array))

static support_blob blob;

static masu_detail detail; /* of the last error */

static void assert_refused(const char *what, uint64_t element) {
    masu_scene scene;
    char place[64];
    support_blob_seal(blob.bytes, blob.size);
    if (!support_bind(blob.bytes, blob.size, &scene, &detail)) fail_msg("%s was accepted", what);
    assert_int_equal(detail.result, MASU_ERROR_SCENE);
    if (strcmp(detail.what, what)) fail_msg("%s was rejected as %s", what, detail.text);
    assert_int_equal(detail.given, element);
    (void)snprintf(place, sizeof place, "%s[%u]", what, (unsigned)element);
    assert_non_null(strstr(detail.text, place));
}

/* A full blob, changed: rejected with the name of the section and the number of the element. */
#define REFUSED(what, element, ...)                                                                \
    do {                                                                                           \
        support_blob_write(&blob, SUPPORT_ALL);                                                    \
        __VA_ARGS__;                                                                               \
        assert_refused(what, element);                                                             \
    } while (0)

/* The same for a change that is still within the rules. */
#define ACCEPTED(...)                                                                              \
    do {                                                                                           \
        masu_scene scene;                                                                          \
        support_blob_write(&blob, SUPPORT_ALL);                                                    \
        __VA_ARGS__;                                                                               \
        support_blob_recode(&blob);                                                                \
        support_blob_seal(blob.bytes, blob.size);                                                  \
        support_accepted(&blob, &scene);                                                           \
    } while (0)

#define ROW(kind) support_blob_row(&blob, MASU_BLOB_##kind)
#define TABLE_INDEX(kind)                                                                          \
    (uint64_t)(ROW(kind) - (masu_blob_section *)(void *)(blob.bytes + sizeof(masu_blob_header)))
#define AT(kind, type) ((type *)support_blob_find(&blob, MASU_BLOB_##kind))
#define VERTEX AT(VERTICES, masu_blob_vertex)
#define INDEX AT(INDICES, uint32_t)
#define PRIMITIVE AT(PRIMITIVES, masu_blob_primitive)
#define MESH AT(MESHES, masu_blob_mesh)
#define INSTANCE AT(INSTANCES, masu_blob_instance)
#define MATERIAL AT(MATERIALS, masu_blob_material)
#define KEY AT(CAMERA_KEYS, masu_blob_camera_key)
#define SKY AT(ENVIRONMENT, masu_blob_environment)
#define GROUP AT(GROUPS, masu_blob_group)
#define OCCLUDER AT(OCCLUDERS, masu_blob_occluder)
#define ITEM AT(GROUP_ITEMS, uint32_t)
#define FIELD AT(SDF, masu_blob_sdf)
#define SHADOW AT(SHADOW, masu_blob_shadow)
#define PARAM AT(SDF_PARAMS, masu_blob_sdf_param)

/* No instance is in a group. */
static void ungroup(void) {
    for (uint32_t i = 0; i < 3; i++) INSTANCE[i].group = MASU_BLOB_NONE;
    support_blob_drop(&blob, MASU_BLOB_GROUPS);
    support_blob_drop(&blob, MASU_BLOB_GROUP_ITEMS);
}


/* Whether this build supports a kind of section: only the lab build has its marches, and no build
 * has kind 20. */
static int is_in_build(uint32_t kind) {
#ifdef MASU_LAB
    return kind != 20;
#else
    return kind < MASU_BLOB_PLAIN_SPIRV || kind > 20;
#endif
}

/* A blob that has a section of that kind, as full as possible. Returns the section's index. */
static uint64_t write_with(uint32_t kind) {
    uint32_t with = kind >= MASU_BLOB_TEXCOORDS && kind <= MASU_BLOB_TEXELS ? SUPPORT_TEXTURES
                    : kind == MASU_BLOB_LODS                                 ? SUPPORT_DETAIL
                    : kind == MASU_BLOB_LOCAL_SHADOW_SPIRV                   ? 0
                    : kind == MASU_BLOB_COLORS || kind == MASU_BLOB_TEXCOORDS_1
                        ? SUPPORT_TEXTURES | SUPPORT_ATTRIBUTES
                    : kind >= MASU_BLOB_MORPH_TARGETS ? SUPPORT_LIVE | SUPPORT_SKIN | SUPPORT_MORPH
                    : kind >= MASU_BLOB_TRACE_NODES                          ? SUPPORT_TRACE
                    : kind >= MASU_BLOB_MESO                                 ? SUPPORT_LIGHTING
                                                                             : 0;
    support_blob_write(&blob, SUPPORT_ALL | with);
    masu_blob_section *row = support_blob_row(&blob, (enum masu_blob_kind)kind);
    assert_non_null(row);
    return (uint64_t)(row - (masu_blob_section *)(void *)(blob.bytes + sizeof(masu_blob_header)));
}

static const struct {
    uint32_t kind;
    const char *name;
    int needed;
} codes[] = {{MASU_BLOB_MARCH_SPIRV, "march SPIR-V", 1},
             {MASU_BLOB_CLASSIFY_SPIRV, "classify SPIR-V", 1},
             {MASU_BLOB_CONE8_SPIRV, "cone8 SPIR-V", 1},
             {MASU_BLOB_CONE4_SPIRV, "cone4 SPIR-V", 1},
             {MASU_BLOB_VELOCITY_SPIRV, "velocity SPIR-V", 0},
             {MASU_BLOB_SILHOUETTES_SPIRV, "silhouettes SPIR-V", 1},
             {MASU_BLOB_UPDATE_PREVIOUS_SPIRV, "update_previous SPIR-V", 1},
             {MASU_BLOB_UPDATE_SPIRV, "update SPIR-V", 1}, /* in addition to the one before */
#ifdef MASU_LAB
             {MASU_BLOB_PLAIN_SPIRV, "march_plain SPIR-V", 0},
             {MASU_BLOB_SEED_SPIRV, "march_seed SPIR-V", 0},
             {MASU_BLOB_CHECKERBOARD_SPIRV, "march_checkerboard SPIR-V", 0},
#endif
             {MASU_BLOB_OCCLUSION_SPIRV, "sdf_occlusion SPIR-V", 0},
             {MASU_BLOB_LOCAL_SHADOW_SPIRV, "local_shadow_sdf SPIR-V", 0}};

static const float not_finite[] = {(float)NAN, (float)INFINITY, (float)-INFINITY};

#define MATERIAL_OF AT(MATERIALS, masu_blob_material)
#define MESO AT(MESO, masu_blob_meso)
#define LIGHT AT(LIGHTS, masu_blob_light)
#define PROBES AT(PROBES, masu_blob_probes)
#define MAP AT(ENVIRONMENT_MAP, masu_blob_environment_map)

/* Like REFUSED, for a blob with all kinds of lighting. */
#define LIT(what, element, ...)                                                                    \
    do {                                                                                           \
        support_blob_write(&blob, SUPPORT_ALL | SUPPORT_LIGHTING);                                 \
        (void)(__VA_ARGS__);                                                                       \
        assert_refused(what, element);                                                             \
    } while (0)

static void what_lights_a_scene_is_checked(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        float x = not_finite[i];
        LIT("materials", 1, MATERIAL_OF[1].specular = x);
        LIT("materials", 0, MATERIAL_OF[0].coat = x);
        LIT("materials", 0, MATERIAL_OF[0].coat_roughness = x);
        LIT("materials", 0, MATERIAL_OF[0].opacity = x);
        LIT("materials", 0, MATERIAL_OF[0].thickness = x);
        LIT("materials", 0, MATERIAL_OF[0].ior = x);
        LIT("meso", 0, MESO[0].tilt[2] = x);
        LIT("meso", 0, MESO[0].roughness[0] = x);
        LIT("meso", 0, MESO[0].occlusion[1] = x);
        LIT("meso", 0, MESO[0].alpha = x);
        LIT("lights", 1, LIGHT[1].position[2] = x);
        LIT("lights", 0, LIGHT[0].range = x);
        LIT("lights", 0, LIGHT[0].radius = x);
        LIT("lights", 0, LIGHT[0].color[1] = x);
        LIT("lights", 0, LIGHT[0].direction[0] = x);
        LIT("lights", 1, LIGHT[1].inner = x);
        LIT("lights", 1, LIGHT[1].outer = x);
        LIT("probes", 0, PROBES[0].origin[0] = x);
        LIT("probes", 0, PROBES[0].spacing[2] = x);
        LIT("probes", 0, PROBES[0].bias = x);
        LIT("probes", 0, PROBES[0].sun_direction[0][0] = x);
        LIT("probes", 3, PROBES[0].sun_direction[3][1] = x);
        LIT("probes", 2, PROBES[0].sun_inverse[2][15] = x);
        LIT("environment map", 8, MAP[0].sh[8][2] = x);
        LIT("environment", 0, SKY[0].turbidity = x);
        LIT("environment", 0, SKY[0].ground[1] = x);
        LIT("environment", 0, SKY[0].occlusion_radius = x);
        LIT("environment", 0, SKY[0].metered = x);
        LIT("environment", 0, SKY[0].brighten = x);
        LIT("environment", 0, SKY[0].darken = x);
        LIT("environment", 0, SKY[0].smooth_edges = x);
        LIT("environment", 0, SKY[0].fog_color[0] = x);
        LIT("environment", 0, SKY[0].fog_density = x);
        LIT("environment", 0, SKY[0].fog_height = x);
        LIT("environment", 0, SKY[0].fog_falloff = x);
        LIT("environment", 0, SKY[0].fog_start = x);
    }
    LIT("materials", 0, MATERIAL_OF[0].specular = 12.6f);
    LIT("materials", 0, MATERIAL_OF[0].anisotropy = 1.5f);
    LIT("materials", 0, MATERIAL_OF[0].depth_bias = 0.0101f);
    LIT("materials", 0, MATERIAL_OF[0].depth_bias = -0.0101f);
    LIT("materials", 0, MATERIAL_OF[0].specular_color[1] = 0.5f); /* and no channel is 1 */
    LIT("materials", 0, (MATERIAL_OF[0].sheen_color[0] = 1.0f, MATERIAL_OF[0].specular = 0.3f));
    LIT("materials", 0,
        (MATERIAL_OF[0].sheen_color[0] = 1.0f, MATERIAL_OF[0].specular = 0.5f,
         MATERIAL_OF[0].anisotropy = 1.0f));
    LIT("materials", 0,
        (MATERIAL_OF[0].anisotropy = MATERIAL_OF[0].coat =
             1.0f));                                    /* one lobe, and none with a coat */
    LIT("materials", 0, MATERIAL_OF[0].opacity = 0.5f); /* but not transparent */
    LIT("materials", 0, MATERIAL_OF[0].flags = MASU_MATERIAL_IS_ADDITIVE);
    LIT("materials", 0, MATERIAL_OF[0].flags = MASU_MATERIAL_IS_TINTED);
    LIT("materials", 0,
        MATERIAL_OF[0].flags =
            MASU_MATERIAL_IS_TINTED | MASU_MATERIAL_IS_ADDITIVE | MASU_MATERIAL_IS_BLEND);
#define REFRACTS(t, n, metal, also)                                                                \
    (MATERIAL_OF[0].flags |= MASU_MATERIAL_IS_BLEND | (also), MATERIAL_OF[0].thickness = (t),      \
     MATERIAL_OF[0].ior = (n), MATERIAL_OF[0].metallic = (metal))
    LIT("materials", 0, REFRACTS(65536.0f, 1.5f, 0.0f, MASU_MATERIAL_IS_TINTED));
    LIT("materials", 0, REFRACTS(1.0f, 0.99f, 0.0f, MASU_MATERIAL_IS_TINTED));
    LIT("materials", 0, REFRACTS(1.0f, 1000.1f, 0.0f, MASU_MATERIAL_IS_TINTED));
    LIT("materials", 0,
        REFRACTS(0.0f, 1.5f, 0.0f,
                 MASU_MATERIAL_IS_TINTED)); /* an index, and nothing to go through */
    LIT("materials", 0, REFRACTS(1.0f, 1.5f, 0.0f, 0));
    LIT("materials", 0, REFRACTS(1.0f, 1.5f, 0.5f, MASU_MATERIAL_IS_TINTED));
    LIT("materials", 0,
        REFRACTS(1.0f, 1.5f, 0.0f, MASU_MATERIAL_IS_TINTED | MASU_MATERIAL_HAS_METAL));
    LIT("materials", 0, MATERIAL_OF[0].meso = 1);
    LIT("meso", 0, MESO[0].alpha = 4.5f);
    LIT("meso", 0, MESO[0].facet = 1.5f);
    LIT("meso", 0, MESO[0].offset = -0.5f);
    LIT("lights", 0, LIGHT[0].type = MASU_LIGHT_RECTANGLE + 1);
    LIT("lights", 0, LIGHT[0].type = MASU_LIGHT_CAPSULE); /* whose half axis is 0 */
    LIT("lights", 0, LIGHT[0].type = 0x10000);
    LIT("lights", 0, LIGHT[0].type = MASU_LIGHT_SURFACE); /* for a point */
    LIT("lights", 0, LIGHT[0].reserved = 1);
    LIT("lights", 0,
        (LIGHT[0].type = MASU_LIGHT_RECTANGLE,
         LIGHT[0].direction[0] = LIGHT[0].half_axis[0] = 1.0f));
    LIT("lights", 0, LIGHT[0].range = -1.0f);
    LIT("lights", 0, LIGHT[0].range = 2e15f);
    LIT("lights", 0, LIGHT[0].outer = 1.0f); /* for a point */
    LIT("lights", 0, LIGHT[0].color[2] = 2e9f);
    LIT("lights", 0, LIGHT[0].radius = 0.0f);
    LIT("lights", 1, LIGHT[1].direction[2] = -0.5f);
    LIT("lights", 1, LIGHT[1].outer = 0.3f); /* narrower than the inner */
    LIT("lights", 1, LIGHT[1].outer = 3.2f);
    LIT("lights", 1, LIGHT[1].inner = -0.1f);
    LIT("lights", 1, LIGHT[1].parent = 3);
    LIT("lights", 1, LIGHT[1].name = 1000);
    LIT("probes", 0, PROBES[0].sky_sets = 0);
    LIT("probes", 0, PROBES[0].sky_sets = 2);
    LIT("probes", 0, PROBES[0].suns = 17);
    LIT("probes", 0, PROBES[0].emissive = 2);
    LIT("probes", 0, PROBES[0].visibility = 17);
    LIT("probes", 0, PROBES[0].bias = -0.1f);
    LIT("probe data", 74, PROBES[0].suns = 2);
    LIT("probes", 0, PROBES[0].counts[1] = 0);
    LIT("probes", 0, PROBES[0].counts[0] = UINT32_MAX);
    LIT("probes", 0, PROBES[0].counts[0] = PROBES[0].counts[1] = 1u << 20);
    LIT("probe data", 74, PROBES[0].counts[0] = 3);
    LIT("probe data", 74, PROBES[0].visibility = 2);
    /* Neither a value too few nor one too many. */
    LIT("probe data", 73, support_blob_row(&blob, MASU_BLOB_PROBE_DATA)->count--);
    LIT("probe data", 75, support_blob_row(&blob, MASU_BLOB_PROBE_DATA)->count++);
    LIT("probes", 0, PROBES[0].spacing[0] = 0.0f);
    LIT("probe data", 3, AT(PROBE_DATA, uint32_t)[3] = 0x7C00u);
    LIT("probe data", 4, AT(PROBE_DATA, uint32_t)[4] = 0xFE000000u);
    LIT("probes", 0, support_blob_drop(&blob, MASU_BLOB_PROBE_DATA));
    LIT("environment map", 0, MAP[0].size = 12);
    LIT("environment map", 0, MAP[0].size = 4);
    LIT("environment map", 0, MAP[0].mips = 3); /* for 2 texels */
    LIT("environment map", 0, MAP[0].mips = 0);
    LIT("environment map", 1, MAP[0].sh[1][3] = -0.1f);
    LIT("environment map", 0, MAP[0].sh[4][3] = 1.1f);
    LIT("environment texels", 80, MAP[0].size = 16);
    LIT("environment map", 0, support_blob_drop(&blob, MASU_BLOB_ENVIRONMENT_TEXELS));
    LIT("environment", 0, SKY[0].turbidity = 1.0f);
    LIT("environment", 0, SKY[0].fog_density = -1.0f);
    LIT("environment", 0, SKY[0].occlusion_radius = -1.0f);
    support_blob_write(&blob, SUPPORT_ALL | SUPPORT_LIGHTING);
    SKY[0].turbidity = 2.0f;
    SKY[0].fog_density = 0.1f;
    MATERIAL_OF[0].flags = MASU_MATERIAL_IS_BLEND | MASU_MATERIAL_IS_ADDITIVE;
    MATERIAL_OF[0].opacity = 0.5f;
    MATERIAL_OF[0].coat = 1.0f;
    MATERIAL_OF[1].meso = 0;
    masu_scene scene;
    support_blob_seal(blob.bytes, blob.size);
    assert_int_equal(masu_scene_bind(blob.bytes, blob.size, &scene, NULL), MASU_OK);
    assert_int_equal(masu_scene_data_of(&scene)->surfaces,
                     /* transparent surfaces are in no G-buffer, */
                     1);
    assert_int_equal(masu_scene_data_of(&scene)->coats, 1); /* but has a coat */
    assert_int_equal(masu_scene_data_of(&scene)->blends, 1);
    assert_int_equal(masu_scene_data_of(&scene)->meso, 1);
    assert_int_equal(masu_scene_count(&scene, MASU_SCENE_LIGHT), 2);
    assert_int_equal(masu_scene_data_of(&scene)->probes, 2);
    assert_int_equal(masu_scene_data_of(&scene)->probe_sets, 2);
    assert_int_equal(masu_scene_data_of(&scene)->probe_words, 74);
    assert_int_equal(masu_scene_data_of(&scene)->environment_size, 8);
    assert_int_equal(masu_scene_data_of(&scene)->environment_mips, 2);
    assert_int_equal(masu_scene_data_of(&scene)->analytic_sky, 1);
    assert_int_equal(masu_scene_data_of(&scene)->fog, 1);
}

static void a_section_of_an_unknown_kind_is_refused(void **state) {
    (void)state;
    REFUSED("section", 1, ROW(INDICES)->kind = 0);
    REFUSED("section", 1, ROW(INDICES)->kind = MASU_BLOB_KIND_COUNT);
    assert_non_null(strstr(detail.text, "unknown kind"));
    REFUSED("section", 1, ROW(INDICES)->kind = UINT32_MAX);
    REFUSED("section", 1, ROW(INDICES)->kind = MASU_BLOB_KIND_COUNT);
}

/* Like REFUSED, for a blob with BVHs for rays. */
#define TRACED(what, element, ...)                                                                 \
    do {                                                                                           \
        support_blob_write(&blob, SUPPORT_ALL | SUPPORT_TRACE);                                    \
        (void)(__VA_ARGS__);                                                                       \
        assert_refused(what, element);                                                             \
    } while (0)
#define NODE AT(TRACE_NODES, masu_blob_trace_node)
#define TRIANGLE AT(TRACE_TRIANGLES, masu_blob_trace_triangle)
#define TREE AT(TRACE_MESHES, masu_blob_trace_mesh)
#define TRACE AT(TRACE_INSTANCES, uint32_t)
#define MIRRORS AT(REFLECTIONS, masu_blob_reflections)

/* A chain of nodes at the maximum depth, or one deeper: one leaf at its end. */
static masu_result bind_chain(uint32_t depth) {
    masu_scene scene;
    support_blob_write(&blob, SUPPORT_ALL | SUPPORT_TRACE);
    masu_blob_section *row = support_blob_row(&blob, MASU_BLOB_TRACE_NODES);
    size_t from = (size_t)row->offset, old = 3 * sizeof(masu_blob_trace_node);
    size_t bytes = (depth + 1) * sizeof(masu_blob_trace_node);
    memmove(blob.bytes + from + bytes, blob.bytes + from + old, blob.size - from - old);
    blob.size += bytes - old;
    row->count = depth + 1;
    masu_blob_trace_node second = NODE[2];
    for (uint32_t i = 0; i < depth; i++) {
        NODE[i] = NODE[1];
        NODE[i].packed = (NODE[1].packed & 0xFFFFFFu) | (i + 1 < depth ? 1u : 3u) << 24;
        NODE[i].child = i + 1;
        NODE[i].item = 0;
    }
    NODE[depth] = second;
    NODE[depth].item = 2;
    for (uint32_t kind = MASU_BLOB_TRACE_TRIANGLES; kind <= MASU_BLOB_REFLECTIONS; kind++)
        support_blob_row(&blob, (enum masu_blob_kind)kind)->offset += bytes - old;
    TRIANGLE[2] = TRIANGLE[3];
    ROW(TRACE_TRIANGLES)->count = 3;
    TREE[0] = (masu_blob_trace_mesh){0, depth, 0, 2, depth, 0};
    TREE[1] = (masu_blob_trace_mesh){depth, 1, 2, 1, 1, 0};
    support_blob_seal(blob.bytes, blob.size);
    return masu_scene_bind(blob.bytes, blob.size, &scene, &detail);
}

static void what_rays_are_traced_through_is_checked(void **state) {
    (void)state;
    for (uint32_t kind = MASU_BLOB_TRACE_NODES; kind <= MASU_BLOB_TRACE_INSTANCES; kind++)
        TRACED("trace nodes", 0, support_blob_drop(&blob, (enum masu_blob_kind)kind));
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) TRACED("trace nodes", 1, NODE[1].origin[k] = not_finite[i]);
    }
    for (int i = 0; i < 3; i++) {
        TRACED("reflections", 0, MIRRORS->cutoff = not_finite[i]);
        TRACED("reflections", 0, MIRRORS->glossiest = not_finite[i]);
        TRACED("reflections", 0, MIRRORS->distance = not_finite[i]);
    }
    TRACED("reflections", 0, MIRRORS->cutoff = 1.01f);
    TRACED("reflections", 0, MIRRORS->glossiest = -0.01f);
    TRACED("reflections", 0, MIRRORS->distance = 0.0f);
    TRACED("reflections", 0, support_blob_drop(&blob, MASU_BLOB_REFLECTIONS));
    TRACED("trace nodes", 0, NODE[0].origin[2] = 2e15f);
    TRACED("trace nodes", 0, NODE[0].packed &= ~0xFFu);         /* a scale of a denormal */
    TRACED("trace nodes", 2, NODE[2].packed |= 0xFFu << 8);     /* of infinity */
    TRACED("trace nodes", 2, NODE[2].packed = 0x02ABAB80u);     /* 2^44 */
    TRACED("trace nodes", 0, NODE[0].child = 0);                /* itself */
    TRACED("trace nodes", 0, NODE[0].child = 2);                /* another mesh's */
    TRACED("trace nodes", 0, NODE[0].child = 0xFFFFFFFFu);
    TRACED("trace nodes", 0, NODE[0].item = 1);
    TRACED("trace nodes", 1, NODE[1].item = 0);                 /* a triangle twice */
    TRACED("trace nodes", 1, NODE[1].packed |= 1u << 26);       /* a node after a leaf */
    TRACED("trace nodes", 1, NODE[1].packed |= 2u << 28);       /* a leaf after nothing */
    TRACED("trace meshes", 0, NODE[1].packed |= 2u << 26);      /* more than there are */
    TRACED("trace meshes", 0, NODE[1].packed &= 0xFFFFFFu);     /* fewer */
    TRACED("trace nodes", 0, NODE[0].packed &= ~(1u << 24));    /* a leaf after nothing */
    TRACED("trace meshes", 0, TREE[0].depth = 1);
    TRACED("trace meshes", 0, TREE[0].depth = 3);
    TRACED("trace meshes", 0, TREE[0].triangle_count = 4);
    TRACED("trace meshes", 0, TREE[0].first_triangle = 1);
    TRACED("trace meshes", 0, TREE[0].first_node = 1);
    TRACED("trace meshes", 0, TREE[0].node_count = 0);
    TRACED("trace meshes", 1, TREE[1].node_count = 2);
    TRACED("trace meshes", 1, TREE[1].node_count = 0xFFFFFFFFu);
    TRACED("trace meshes", 1, TREE[1].triangle_count = 0xFFFFFFFFu);
    TRACED("trace meshes", 1, TREE[1].first_node = 0);
    TRACED("trace triangles", 2, TRIANGLE[2].primitive = 2);
    TRACED("trace triangles", 3, TRIANGLE[3].primitive = 0xFFFFFFFFu);
    TRACED("trace triangles", 1, TRIANGLE[1].vertex[2] = 0);
    TRACED("trace triangles", 3, TRIANGLE[3].vertex[0] = 11);
    TRACED("trace instances", 1, TRACE[0] = 2);
    TRACED("trace instances", 1, TRACE[1] = 1);
    TRACED("trace instances", 1, TRACE[1] = 3);
    TRACED("trace instances", 1, (TREE[1] = (masu_blob_trace_mesh){0}, ROW(TRACE_NODES)->count = 2,
                                  ROW(TRACE_TRIANGLES)->count = 3));
    support_blob_write(&blob, SUPPORT_ALL | SUPPORT_TRACE);
    masu_scene scene;
    assert_int_equal(masu_scene_bind(blob.bytes, blob.size, &scene, NULL), MASU_OK);
    assert_int_equal(masu_scene_data_of(&scene)->trace_nodes, 3);
    assert_int_equal(masu_scene_data_of(&scene)->trace_triangles, 4);
    assert_int_equal(masu_scene_data_of(&scene)->trace_instances, 2);
    assert_int_equal(bind_chain(MASU_TRACE_DEPTH_MAX), MASU_OK);
    assert_int_equal(bind_chain(MASU_TRACE_DEPTH_MAX + 1), MASU_ERROR_SCENE);
    assert_non_null(strstr(detail.text, "too deep"));
}

static void a_section_that_appears_twice_is_refused(void **state) {
    (void)state;
    REFUSED("section", 4, *ROW(INSTANCES) = *ROW(MESHES));
}

static void a_section_of_another_element_size_is_refused(void **state) {
    (void)state;
    for (uint32_t kind = 1; kind <= MASU_BLOB_REFLECTIONS; kind++) {
        if (!is_in_build(kind)) continue;
        for (int change = 0; change < 3; change++) {
            uint64_t index = write_with(kind);
            uint32_t *stride = &support_blob_row(&blob, (enum masu_blob_kind)kind)->stride;
            *stride = change == 0 ? 0 : change == 1 ? *stride + 1 : *stride * 2;
            assert_refused("section", index);
        }
    }
}

static void a_section_with_too_few_or_too_many_elements_is_refused(void **state) {
    (void)state;
    for (uint32_t kind = 1; kind <= MASU_BLOB_REFLECTIONS; kind++) {
        if (!is_in_build(kind)) continue;
        static const uint64_t counts[] = {0, 0x80000000u, (uint64_t)1 << 60, UINT64_MAX};
        for (size_t i = 0; i < COUNT(counts); i++) {
            uint64_t index = write_with(kind);
            support_blob_row(&blob, (enum masu_blob_kind)kind)->count = counts[i];
            assert_refused("section", index);
        }
    }
    REFUSED("section", TABLE_INDEX(ENVIRONMENT), ROW(ENVIRONMENT)->count = 2);
    REFUSED("section", TABLE_INDEX(SDF), ROW(SDF)->count = 2);
    REFUSED("section", TABLE_INDEX(SDF_PARAMS), ROW(SDF_PARAMS)->count = MASU_MAX_SDF_PARAMS + 1);
    REFUSED("section", TABLE_INDEX(SLOTS), ROW(SLOTS)->count = 65537);
    for (size_t i = 0; i < COUNT(codes); i++) {
        uint64_t index = write_with(codes[i].kind);
        support_blob_row(&blob, (enum masu_blob_kind)codes[i].kind)->count =
            ((uint64_t)16 << 20) + 1;
        assert_refused("section", index);
        assert_non_null(strstr(detail.text, "element count"));
    }
}

static void a_section_outside_the_blob_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_ALL);
    uint64_t index = TABLE_INDEX(SLOTS); /* the last one */
    REFUSED("section", index, ROW(SLOTS)->count += 16);
    REFUSED("section", index, ROW(SLOTS)->offset += 16);
    REFUSED("section", index, ROW(SLOTS)->offset += 8);                       /* misaligned */
    REFUSED("section", index, ROW(SLOTS)->offset = 0);                        /* the header */
    REFUSED("section", index, ROW(SLOTS)->offset = sizeof(masu_blob_header)); /* the table */
    REFUSED("section", index, ROW(SLOTS)->offset = (blob.size + 31) / 16 * 16);
    REFUSED("section", index, ROW(SLOTS)->offset = UINT64_MAX - 15);
    REFUSED("section", index, ROW(SLOTS)->offset = (uint64_t)1 << 63);
    /* Misaligned and entirely inside: bytes of the next sections. */
    index = TABLE_INDEX(VERTICES);
    REFUSED("section", index, ROW(VERTICES)->offset += 8);
}

/* The hash does not cover the count of sections: bytes without a section reveal a wrong count. */
static void bytes_that_no_section_owns_are_refused(void **state) {
    (void)state;
    for (uint32_t parts = 0; parts <= SUPPORT_ALL; parts++) {
        support_blob_write(&blob, parts);
        masu_blob_header *header = (masu_blob_header *)(void *)blob.bytes;
        assert_refused("section", --header->section_count);
        support_blob_write(&blob, parts);
        blob.size += MASU_BLOB_ALIGN;
        assert_refused("section", header->section_count);
        blob.size--; /* padding */
        support_blob_seal(blob.bytes, blob.size);
        masu_scene scene;
        support_accepted(&blob, &scene);
    }
}

static void names_that_do_not_end_are_refused(void **state) {
    (void)state;
    REFUSED("names", ROW(NAMES)->count - 1, AT(NAMES, char)[ROW(NAMES)->count - 1] = 'x');
}

/* Every sharer of the name would have to hash it again. */
static void a_name_of_over_255_bytes_is_refused(void **state) {
    (void)state;
    support_blob_write(&blob, SUPPORT_LONG_NAME);
    support_blob_seal(blob.bytes, blob.size);
    masu_scene scene;
    support_accepted(&blob, &scene); /* 255 */
    AT(NAMES, char)[0] = 'x';        /* the end of an empty name */
    assert_refused("names", 0);
    AT(NAMES, char)[0] = '\0';
    AT(NAMES, char)[256] = 'x';      /* the end of the long name */
    assert_refused("names", 1);
}

static void a_vertex_that_is_not_finite_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 3; k++) {
            REFUSED("vertices", 10, VERTEX[10].position[k] = not_finite[i]);
            REFUSED("vertices", 0, VERTEX[0].position[k] = not_finite[i]);
        }
    }
    ACCEPTED(VERTEX[3].position[0] = PRIMITIVE[0].aabb_max[0] = MESH[0].aabb_max[0] = 3e38f,
             VERTEX[3].normal[0] = -32768, ungroup());
}

static void a_primitive_outside_its_sections_is_refused(void **state) {
    (void)state;
    REFUSED("primitives", 0, PRIMITIVE[0].index_count = 5);
    REFUSED("primitives", 2, PRIMITIVE[2].first_index = 10);
    REFUSED("primitives", 0, PRIMITIVE[0].first_index = UINT32_MAX - 2); /* wraps in 32 bits */
    REFUSED("primitives", 0, PRIMITIVE[0].vertex_count = 0);
    REFUSED("primitives", 0, PRIMITIVE[0].vertex_count = 0x1000000);
    REFUSED("primitives", 2, PRIMITIVE[2].first_vertex = 8);
    REFUSED("primitives", 2, PRIMITIVE[2].vertex_count++); /* one too many, which no index uses */
    REFUSED("primitives", 1, PRIMITIVE[1].first_vertex = UINT32_MAX - 2);
    REFUSED("primitives", 1, PRIMITIVE[1].material = 2);
    REFUSED("primitives", 1, PRIMITIVE[1].material = UINT32_MAX);
}

static void primitives_that_share_indices_are_refused(void **state) {
    (void)state;
    REFUSED("primitives", 2, PRIMITIVE[1].index_count = 6);
    REFUSED("primitives", 0, PRIMITIVE[0].index_count = 18);
    REFUSED("primitives", 1, PRIMITIVE[1].index_count = 0xFFFFFFFF);
}

static void an_index_outside_its_primitive_is_refused(void **state) {
    (void)state;
    REFUSED("indices", 5, INDEX[5] = 4);
    REFUSED("indices", 8, INDEX[8] = 3); /* a vertex, but the next primitive's */
    REFUSED("indices", 14, INDEX[14] = UINT32_MAX);
    ACCEPTED(INDEX[5] = 0);
    ACCEPTED(INDEX[9] = 3); /* the first vertex after a primitive of three */
    ACCEPTED(PRIMITIVE[1].vertex_count = 1, INDEX[7] = INDEX[8] = 0);
}

static void bounds_that_are_not_finite_are_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 3; k++) {
            REFUSED("primitives", 1, PRIMITIVE[1].aabb_min[k] = not_finite[i]);
            REFUSED("primitives", 2, PRIMITIVE[2].aabb_max[k] = not_finite[i]);
            REFUSED("meshes", 0, MESH[0].aabb_min[k] = not_finite[i]);
            REFUSED("meshes", 1, MESH[1].aabb_max[k] = not_finite[i]);
        }
    }
}

static void bounds_that_do_not_hold_what_they_should_are_refused(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        REFUSED("primitives", 2, VERTEX[9].position[k] = 2.25f);
        REFUSED("primitives", 2, VERTEX[9].position[k] = -2.25f);
        REFUSED("meshes", 0, PRIMITIVE[1].aabb_max[k] = 2.25f);
        REFUSED("meshes", 1, PRIMITIVE[2].aabb_min[k] = -2.25f);
        REFUSED("groups", 0, GROUP[1].half[k] = 16.5f);
        REFUSED("groups", 1, GROUP[1].half[k] = 0.5f);
        REFUSED("groups", 1, INSTANCE[1].transform[4 * k + 3] += 12.0f);
        REFUSED("groups", 0, INSTANCE[0].transform[5 * k] = 100.0f);
    }
    assert_non_null(strstr(detail.text, "do not hold its instances"));
    ACCEPTED(INSTANCE[2].transform[3] = 1e6f); /* in no group */
    /* A box that exactly holds a point would clip the point as rounded. */
    REFUSED("groups", 1, GROUP[1].half[0] = 1.0f);
    ACCEPTED(GROUP[1].half[0] = 1.0001f);
}

static void groups_that_are_no_tree_are_refused(void **state) {
    (void)state;
    REFUSED("groups", 0, GROUP[0].first_child = 0);
    REFUSED("groups", 0, GROUP[0].first_child = 2);
    REFUSED("groups", 0, GROUP[0].child_count = 2);
    REFUSED("groups", 0, GROUP[0].child_count = UINT32_MAX);
    REFUSED("groups", 1, GROUP[0].child_count = 0);
    REFUSED("groups", 1, GROUP[1].child_count = 1, GROUP[1].first_child = 1);
    REFUSED("groups", 1, GROUP[1].child_count = 1, GROUP[1].first_child = 0);
    REFUSED("groups", 1, GROUP[1].name = (uint32_t)ROW(NAMES)->count);
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        REFUSED("groups", 0, GROUP[0].center[1] = not_finite[i]);
        REFUSED("groups", 0, GROUP[0].half[2] = not_finite[i]);
    }
    REFUSED("groups", 0, GROUP[0].half[0] = -1.0f);
    REFUSED("groups", 0, GROUP[0].half[0] = 2e30f);
}

/* A chain of groups, each the only child of the one before. */
static void groups_below_64_levels_are_refused(void **state) {
    (void)state;
    for (uint32_t levels = 63; levels <= 66; levels++) {
        support_blob_write(&blob, SUPPORT_RASTER);
        masu_blob_group *to = (masu_blob_group *)(void *)(blob.bytes + (blob.size + 15) / 16 * 16);
        masu_blob_section *row = ROW(GROUPS);
        assert_true((unsigned char *)(to + levels) <= blob.bytes + sizeof blob.bytes);
        for (uint32_t i = 0; i < levels; i++) {
            to[i] = GROUP[0];
            to[i].first_child = i + 1;
            to[i].child_count = i + 1 < levels;
            to[i].item_count = i < 2;
            to[i].first_item = i;
        }
        row->offset = (uint64_t)((unsigned char *)to - blob.bytes);
        row->count = levels;
        blob.size = (size_t)row->offset + levels * sizeof *to;
        if (levels > 64) {
            assert_refused("groups", 64);
            continue;
        }
        masu_scene scene;
        support_blob_seal(blob.bytes, blob.size);
        support_accepted(&blob, &scene);
        assert_int_equal(masu_scene_data_of(&scene)->groups, levels);
        assert_int_equal(masu_scene_data_of(&scene)->group_items, 2);
    }
}

static void items_that_do_not_fit_their_group_are_refused(void **state) {
    (void)state;
    REFUSED("group items", 0, ITEM[0] = 3);
    REFUSED("group items", 0, ITEM[0] = UINT32_MAX);
    REFUSED("group items", 1, ITEM[1] = 0);
    REFUSED("group items", 1, ITEM[1] = 2);
    REFUSED("group items", 1, GROUP[1].item_count = 0); /* it is left over */
    REFUSED("groups", 1, GROUP[1].item_count = 2);
    REFUSED("groups", 1, GROUP[1].first_item = 0);
    REFUSED("groups", 0, GROUP[0].item_count = UINT32_MAX);
    REFUSED("group items", 1, INSTANCE[1].group = MASU_BLOB_NONE);
    REFUSED("group items", 0, INSTANCE[0].group = 1);
    REFUSED("instances", 2, INSTANCE[2].group = 1);
    REFUSED("instances", 2, INSTANCE[2].group = 77);
    /* Both in one group, in falling order or the same twice. */
    REFUSED("group items", 1, GROUP[0].item_count = 2, GROUP[1].item_count = 0,
            INSTANCE[1].group = 0, ITEM[0] = 1, ITEM[1] = 0);
    REFUSED("group items", 1, GROUP[0].item_count = 2, GROUP[1].item_count = 0,
            INSTANCE[1].group = 0, ITEM[0] = ITEM[1] = 1);
    ACCEPTED(GROUP[0].item_count = 2, GROUP[1].item_count = 0, INSTANCE[1].group = 0);
    REFUSED("groups", 0, support_blob_drop(&blob, MASU_BLOB_GROUP_ITEMS));
    REFUSED("groups", 0, support_blob_drop(&blob, MASU_BLOB_GROUPS));
    REFUSED("instances", 0, support_blob_drop(&blob, MASU_BLOB_GROUPS),
            support_blob_drop(&blob, MASU_BLOB_GROUP_ITEMS));
    ACCEPTED(ungroup());
}

static void occluders_outside_of_their_mesh_are_refused(void **state) {
    (void)state;
    REFUSED("occluders", 1, OCCLUDER[1].mesh = 2);
    REFUSED("occluders", 1, OCCLUDER[1].mesh = UINT32_MAX);
    REFUSED("occluders", 1, OCCLUDER[0] = OCCLUDER[1], OCCLUDER[1].mesh = 0);
    REFUSED("occluders", 0, OCCLUDER[0].high[1] = 2.25f);
    REFUSED("occluders", 0, OCCLUDER[0].low[0] = -1.25f);
    REFUSED("occluders", 1, OCCLUDER[1].low[1] = 2.0f, OCCLUDER[1].high[1] = -1.0f);
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 3; k++) {
            REFUSED("occluders", 0, OCCLUDER[0].low[k] = not_finite[i]);
            REFUSED("occluders", 1, OCCLUDER[1].high[k] = not_finite[i]);
        }
    }
    ACCEPTED(OCCLUDER[1] = OCCLUDER[0]);
    masu_scene scene;
    support_blob_write(&blob, SUPPORT_ALL);
    support_accepted(&blob, &scene);
    assert_int_equal(masu_scene_data_of(&scene)->occluders, 2);
    assert_int_equal(masu_scene_data_of(&scene)->placed_occluders, 3);
}

static void a_mesh_outside_the_primitives_is_refused(void **state) {
    (void)state;
    REFUSED("meshes", 1, MESH[1].first_primitive = 3);
    REFUSED("meshes", 1, MESH[1].primitive_count = 2);
    REFUSED("meshes", 0, MESH[0].first_primitive = UINT32_MAX); /* wraps in 32 bits */
    ACCEPTED(MESH[1].first_primitive = 3, MESH[1].primitive_count = 0);
}

static void meshes_that_share_primitives_are_refused(void **state) {
    (void)state;
    REFUSED("meshes", 1, MESH[1].first_primitive = 0, MESH[1].primitive_count = 2);
}

static void an_instance_that_is_not_finite_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 12; k++) {
            REFUSED("instances", 2, INSTANCE[2].transform[k] = not_finite[i]);
        }
    }
}

static void an_instance_of_nothing_is_refused(void **state) {
    (void)state;
    REFUSED("instances", 2, INSTANCE[2].mesh = 2);
    REFUSED("instances", 0, INSTANCE[0].mesh = UINT32_MAX);
    REFUSED("instances", 1, INSTANCE[1].parent = 3);
    REFUSED("instances", 1, INSTANCE[1].parent = MASU_BLOB_NONE - 1);
}

static void instances_that_are_not_sorted_by_mesh_are_refused(void **state) {
    (void)state;
    REFUSED("instances", 1, INSTANCE[0].mesh = 1);
    REFUSED("instances", 2, INSTANCE[1].mesh = 1, INSTANCE[2].mesh = 0);
}

static void a_name_outside_the_names_is_refused(void **state) {
    (void)state;
    uint32_t end;
    support_blob_write(&blob, SUPPORT_ALL);
    end = (uint32_t)ROW(NAMES)->count;
    const uint32_t outside[] = {end, end + 1, MASU_BLOB_NONE - 1};
    for (size_t i = 0; i < COUNT(outside); i++) {
        REFUSED("meshes", 1, MESH[1].name = outside[i]);
        REFUSED("instances", 1, INSTANCE[1].name = outside[i]);
        REFUSED("materials", 1, MATERIAL[1].name = outside[i]);
        REFUSED("sdf parameters", 1, PARAM[1].name = outside[i]);
    }
    ACCEPTED(MESH[1].name = end - 1, MATERIAL[0].name = MASU_BLOB_NONE); /* "" and none */
    REFUSED("meshes", 0, support_blob_drop(&blob, MASU_BLOB_NAMES));
}

static void a_material_out_of_range_is_refused(void **state) {
    (void)state;
    const float below = -1e-6f, above = 1.000001f;
    for (int k = 0; k < 3; k++) {
        REFUSED("materials", 0, MATERIAL[0].base_color[k] = below);
        REFUSED("materials", 0, MATERIAL[0].base_color[k] = above);
        REFUSED("materials", 0, MATERIAL[0].base_color[k] = (float)NAN);
        REFUSED("materials", 1, MATERIAL[1].emissive[k] = below);
        REFUSED("materials", 1, MATERIAL[1].emissive[k] = 1.1e9f);
        REFUSED("materials", 1, MATERIAL[1].emissive[k] = (float)NAN);
    }
    REFUSED("materials", 1, MATERIAL[1].roughness = below);
    REFUSED("materials", 1, MATERIAL[1].roughness = above);
    REFUSED("materials", 1, MATERIAL[1].roughness = (float)NAN);
    REFUSED("materials", 1, MATERIAL[1].metallic = below);
    REFUSED("materials", 1, MATERIAL[1].metallic = above);
    REFUSED("materials", 1, MATERIAL[1].metallic = (float)NAN);
    ACCEPTED(MATERIAL[0].roughness = 0.0f, MATERIAL[0].metallic = 1.0f,
             MATERIAL[0].emissive[0] = 1e9f, MATERIAL[0].base_color[2] = -0.0f);
}

static void a_camera_key_that_is_not_finite_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 3; k++) {
            REFUSED("camera keys", 1, KEY[1].position[k] = not_finite[i]);
            REFUSED("camera keys", 2, KEY[2].target[k] = not_finite[i]);
        }
        REFUSED("camera keys", 0, KEY[0].time = not_finite[i]);
        REFUSED("camera keys", 0, KEY[0].fov_y = not_finite[i]);
    }
}

static void a_camera_key_that_sees_nothing_is_refused(void **state) {
    (void)state;
    REFUSED("camera keys", 2, KEY[2].fov_y = 0.0f);
    REFUSED("camera keys", 2, KEY[2].fov_y = 0.00049f);
    REFUSED("camera keys", 2, KEY[2].fov_y = 3.11f);
    REFUSED("camera keys", 2, KEY[2].fov_y = -1.0f);
    REFUSED("camera keys", 1, memcpy(KEY[1].target, KEY[1].position, sizeof KEY->target));
    REFUSED("camera keys", 1, memset(KEY[1].position, 0, sizeof KEY->position),
            memset(KEY[1].target, 0, sizeof KEY->target), KEY[1].target[1] = -0.0f);
    ACCEPTED(KEY[0].fov_y = 3.1f, KEY[1].fov_y = 0.0005f);
}

static void a_camera_path_whose_time_does_not_rise_is_refused(void **state) {
    (void)state;
    REFUSED("camera keys", 1, KEY[1].time = 0.0f);
    REFUSED("camera keys", 2, KEY[2].time = 1.25f);
    REFUSED("camera keys", 1, KEY[0].time = 2.0f);
    ACCEPTED(KEY[0].time = -5.0f);
}

static void a_blob_without_an_environment_is_refused(void **state) {
    (void)state;
    REFUSED("environment", 0, support_blob_drop(&blob, MASU_BLOB_ENVIRONMENT));
}

static void an_environment_out_of_range_is_refused(void **state) {
    (void)state;
    static const size_t colors[] = {
        offsetof(masu_blob_environment, sun_color), offsetof(masu_blob_environment, ambient),
        offsetof(masu_blob_environment, sky_zenith), offsetof(masu_blob_environment, sky_horizon)};
    static const float bad[] = {-1e-6f, 1.1e9f, (float)NAN, (float)INFINITY};
    for (size_t i = 0; i < COUNT(bad); i++) {
        for (size_t c = 0; c < COUNT(colors); c++) {
            for (size_t k = 0; k < 3; k++) {
                REFUSED("environment", 0, memcpy((char *)SKY + colors[c] + 4 * k, &bad[i], 4));
            }
        }
        REFUSED("environment", 0, SKY->exposure = bad[i]);
        REFUSED("environment", 0, SKY->near_distance = bad[i]);
    }
    REFUSED("environment", 0, SKY->exposure = 0.0f);
    REFUSED("environment", 0, SKY->metered = 0.5f);
    REFUSED("environment", 0, SKY->brighten = 2e6f);
    REFUSED("environment", 0, SKY->darken = -1.0f);
    REFUSED("environment", 0, SKY->smooth_edges = 0.5f);
    REFUSED("environment", 0, SKY->near_distance = 0.0f);
}

static void a_sun_without_a_direction_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 3; k++) {
            REFUSED("environment", 0, SKY->sun_direction[k] = not_finite[i]);
        }
    }
    REFUSED("environment", 0, memset(SKY->sun_direction, 0, 12));
    REFUSED("environment", 0, SKY->sun_direction[2] = 0.3f); /* 1.044 long */
    REFUSED("environment", 0, SKY->sun_direction[2] = 1e30f);
}

static void a_shadow_map_out_of_range_is_refused(void **state) {
    (void)state;
    static const uint32_t sizes[] = {0, 15, 8193, UINT32_MAX};
    static const float distances[] = {0.0f, -1.0f, 0.0009f, 1.1e9f};
    REFUSED("shadow", 0, SHADOW->cascades = 0);
    REFUSED("shadow", 0, SHADOW->cascades = 5);
    REFUSED("shadow", 0, SHADOW->cascades = UINT32_MAX);
    for (size_t i = 0; i < COUNT(sizes); i++) {
        REFUSED("shadow", 0, SHADOW->resolution = sizes[i]);
        REFUSED("shadow", 0, SHADOW->distance = distances[i]);
    }
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        REFUSED("shadow", 0, SHADOW->distance = not_finite[i]);
        REFUSED("shadow", 0, SHADOW->lambda = not_finite[i]);
    }
    REFUSED("shadow", 0, SHADOW->lambda = -0.1f);
    REFUSED("shadow", 0, SHADOW->lambda = 1.1f);
    ACCEPTED(SHADOW->cascades = 4, SHADOW->resolution = 8192, SHADOW->distance = 1e9f,
             SHADOW->lambda = 1.0f);
    ACCEPTED(SHADOW->cascades = 1, SHADOW->resolution = 16, SHADOW->distance = 1e-3f,
             SHADOW->lambda = 0.0f);
}

static void parts_of_an_sdf_that_is_missing_are_refused(void **state) {
    (void)state;
    REFUSED("sdf", 0, support_blob_drop(&blob, MASU_BLOB_SDF));
    REFUSED("sdf", 0, support_blob_drop(&blob, MASU_BLOB_SDF),
            support_blob_drop(&blob, MASU_BLOB_SDF_PARAMS));
    REFUSED("sdf", 0, support_blob_drop(&blob, MASU_BLOB_SDF),
            support_blob_drop(&blob, MASU_BLOB_MARCH_SPIRV));
    static const uint32_t rest[] = {MASU_BLOB_SDF_PARAMS, MASU_BLOB_SLOTS};
    for (size_t k = 0; k < COUNT(rest) + COUNT(codes); k++) {
        uint32_t left = k < COUNT(rest) ? rest[k] : codes[k - COUNT(rest)].kind;
        (void)write_with(left);
        support_blob_drop(&blob, MASU_BLOB_SDF);
        for (uint32_t kind = MASU_BLOB_SDF_PARAMS; kind < MASU_BLOB_KIND_COUNT; kind++) {
            if (kind == left || kind == MASU_BLOB_NAMES) continue;
            if (kind >= MASU_BLOB_GROUPS && kind <= MASU_BLOB_OCCLUDERS) continue;
            support_blob_drop(&blob, (enum masu_blob_kind)kind);
        }
        assert_refused("sdf", 0); /* only for this part */
    }
}

static void an_sdf_out_of_range_is_refused(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < COUNT(not_finite); i++) {
            REFUSED("sdf", 0, FIELD->bounds_min[k] = not_finite[i]);
            REFUSED("sdf", 0, FIELD->bounds_max[k] = not_finite[i]);
        }
        REFUSED("sdf", 0, FIELD->bounds_min[k] = FIELD->bounds_max[k] + 1.0f);
        REFUSED("sdf", 0, FIELD->bounds_min[k] = -1.1e30f);
        REFUSED("sdf", 0, FIELD->bounds_max[k] = 1.1e30f);
        ACCEPTED(FIELD->bounds_min[k] = FIELD->bounds_max[k]); /* flat */
        ACCEPTED(FIELD->bounds_min[k] = -1e30f, FIELD->bounds_max[k] = 1e30f);
    }
    static const float lipschitz[] = {0.0f, -1.0f, 0.0009f, 1.1e6f, (float)NAN, (float)INFINITY};
    static const float distance[] = {0.0f, -1.0f, 0.9e-6f, 1.1e30f, (float)NAN, (float)INFINITY};
    for (size_t i = 0; i < COUNT(lipschitz); i++) {
        REFUSED("sdf", 0, FIELD->lipschitz = lipschitz[i]);
        REFUSED("sdf", 0, FIELD->max_distance = distance[i]);
    }
}

static void code_compiled_for_other_instances_is_refused(void **state) {
    (void)state;
    REFUSED("sdf", 0, FIELD->has_raster = 0);
    REFUSED("sdf", 0, FIELD->has_raster = 2);
    REFUSED("sdf", 0, ungroup(), support_blob_drop(&blob, MASU_BLOB_INSTANCES));
    support_blob_write(&blob, SUPPORT_SDF);
    FIELD->has_raster = 1;
    assert_refused("sdf", 0);
}

#ifndef MASU_LAB
static void marches_of_the_lab_build_are_refused(void **state) {
    (void)state;
    static const uint32_t kinds[] = {MASU_BLOB_PLAIN_SPIRV, MASU_BLOB_SEED_SPIRV,
                                     MASU_BLOB_CHECKERBOARD_SPIRV};
    for (size_t i = 0; i < COUNT(kinds); i++) {
        uint64_t section = write_with(MASU_BLOB_OCCLUSION_SPIRV); /* the order of kinds is kept */
        ROW(OCCLUSION_SPIRV)->kind = kinds[i];
        assert_refused("section", section);
        assert_non_null(strstr(detail.text, "lab build"));
    }
}
#endif

static void an_sdf_parameter_outside_its_range_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        REFUSED("sdf parameters", 1, PARAM[1].value = not_finite[i]);
        REFUSED("sdf parameters", 1, PARAM[1].minimum = not_finite[i]);
        REFUSED("sdf parameters", 1, PARAM[1].maximum = not_finite[i]);
    }
    REFUSED("sdf parameters", 0, PARAM[0].value = 2.1f);
    REFUSED("sdf parameters", 0, PARAM[0].value = -0.1f);
    REFUSED("sdf parameters", 0, PARAM[0].minimum = 3.0f);
    REFUSED("sdf parameters", 0, PARAM[0].maximum = -1.0f);
    ACCEPTED(PARAM[0].minimum = PARAM[0].maximum = PARAM[0].value);
}

static void an_sdf_without_code_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(codes); i++) {
        enum masu_blob_kind kind = (enum masu_blob_kind)codes[i].kind;
        masu_scene scene;
        (void)write_with(kind);
        *(uint32_t *)support_blob_find(&blob, kind) = 0x03022307; /* of the other byte order */
        assert_refused(codes[i].name, 0);
        (void)write_with(kind);
        support_blob_row(&blob, kind)->count = 4;
        assert_refused(codes[i].name, 0);
        (void)write_with(kind);
        support_blob_row(&blob, kind)->count = 5; /* a module's header */
        assert_refused(codes[i].name, 5);
        (void)write_with(kind);
        support_blob_drop(&blob, kind);
        if (codes[i].needed) {
            assert_refused(codes[i].name, 0);
        } else {
            support_blob_recode(&blob);
            support_blob_seal(blob.bytes, blob.size);
            support_accepted(&blob, &scene);
        }
    }
    ACCEPTED(support_blob_drop(&blob, MASU_BLOB_SDF_PARAMS)); /* these may be absent */
}

static void an_anchored_sdf_needs_the_code_that_moves_it(void **state) {
    (void)state;
    REFUSED("sdf", 0, AT(SDF, masu_blob_sdf)->flags = 4);
    for (uint32_t constant = 0; constant < 2; constant++) { /* except for the anchor */
        masu_scene scene;
        support_blob_write(&blob, SUPPORT_ALL);
        AT(SDF, masu_blob_sdf)->flags = MASU_SDF_ANCHORED;
        if (constant) support_blob_drop(&blob, MASU_BLOB_UPDATE_PREVIOUS_SPIRV);
        support_blob_recode(&blob);
        support_blob_seal(blob.bytes, blob.size);
        support_accepted(&blob, &scene);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_anchored, 1);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_dynamic, !constant);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_timed, 1);
        AT(SDF, masu_blob_sdf)->flags |= MASU_SDF_TIMELESS;
        support_blob_seal(blob.bytes, blob.size);
        support_accepted(&blob, &scene);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_timed, 0);
    }
    for (uint32_t timeless = 0; timeless < 2;
         timeless++) { /* a hand-written field has no such code */
        masu_scene scene;
        support_blob_write(&blob, SUPPORT_ALL);
        AT(SDF, masu_blob_sdf)->flags = timeless ? MASU_SDF_TIMELESS : 0;
        support_blob_drop(&blob, MASU_BLOB_UPDATE_PREVIOUS_SPIRV);
        support_blob_drop(&blob, MASU_BLOB_UPDATE_SPIRV);
        support_blob_recode(&blob);
        support_blob_seal(blob.bytes, blob.size);
        support_accepted(&blob, &scene);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_timed, !timeless);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_static, 0);
        support_blob_drop(&blob, MASU_BLOB_VELOCITY_SPIRV);
        support_blob_seal(blob.bytes, blob.size);
        support_accepted(&blob, &scene);
        assert_int_equal(masu_scene_data_of(&scene)->sdf_static, 1);
    }
    REFUSED("update SPIR-V", 0, {
        AT(SDF, masu_blob_sdf)->flags = MASU_SDF_ANCHORED;
        support_blob_drop(&blob, MASU_BLOB_UPDATE_PREVIOUS_SPIRV);
        support_blob_drop(&blob, MASU_BLOB_UPDATE_SPIRV);
    });
}

static void an_sdf_without_slots_that_are_finite_is_refused(void **state) {
    (void)state;
    REFUSED("slots", 0, support_blob_drop(&blob, MASU_BLOB_SLOTS));
    ACCEPTED(ROW(SLOTS)->count = 1);
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        REFUSED("slots", 2, AT(SLOTS, float)[2] = not_finite[i]);
    }
}

static void an_sdf_of_no_parts_or_too_many_is_refused(void **state) {
    (void)state;
    static const uint32_t counts[] = {0, 4097, UINT32_MAX};
    for (size_t i = 0; i < COUNT(counts); i++) {
        REFUSED("sdf", 0, FIELD->part_count = counts[i]);
        assert_non_null(strstr(detail.text, "part count"));
    }
    REFUSED("sdf", 0, FIELD->block_words = 3);
    ACCEPTED(FIELD->block_words = 2);
    ACCEPTED(FIELD->part_count = 2);
    ACCEPTED(FIELD->part_count = 4096);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_section_of_an_unknown_kind_is_refused),
        cmocka_unit_test(a_section_that_appears_twice_is_refused),
        cmocka_unit_test(a_section_of_another_element_size_is_refused),
        cmocka_unit_test(a_section_with_too_few_or_too_many_elements_is_refused),
        cmocka_unit_test(what_lights_a_scene_is_checked),
        cmocka_unit_test(what_rays_are_traced_through_is_checked),
        cmocka_unit_test(a_section_outside_the_blob_is_refused),
        cmocka_unit_test(bytes_that_no_section_owns_are_refused),
        cmocka_unit_test(names_that_do_not_end_are_refused),
        cmocka_unit_test(a_name_of_over_255_bytes_is_refused),
        cmocka_unit_test(a_vertex_that_is_not_finite_is_refused),
        cmocka_unit_test(a_primitive_outside_its_sections_is_refused),
        cmocka_unit_test(primitives_that_share_indices_are_refused),
        cmocka_unit_test(an_index_outside_its_primitive_is_refused),
        cmocka_unit_test(bounds_that_are_not_finite_are_refused),
        cmocka_unit_test(a_mesh_outside_the_primitives_is_refused),
        cmocka_unit_test(meshes_that_share_primitives_are_refused),
        cmocka_unit_test(an_instance_that_is_not_finite_is_refused),
        cmocka_unit_test(an_instance_of_nothing_is_refused),
        cmocka_unit_test(instances_that_are_not_sorted_by_mesh_are_refused),
        cmocka_unit_test(a_name_outside_the_names_is_refused),
        cmocka_unit_test(a_material_out_of_range_is_refused),
        cmocka_unit_test(a_camera_key_that_is_not_finite_is_refused),
        cmocka_unit_test(a_camera_key_that_sees_nothing_is_refused),
        cmocka_unit_test(a_camera_path_whose_time_does_not_rise_is_refused),
        cmocka_unit_test(a_blob_without_an_environment_is_refused),
        cmocka_unit_test(an_environment_out_of_range_is_refused),
        cmocka_unit_test(a_sun_without_a_direction_is_refused),
        cmocka_unit_test(bounds_that_do_not_hold_what_they_should_are_refused),
        cmocka_unit_test(groups_that_are_no_tree_are_refused),
        cmocka_unit_test(groups_below_64_levels_are_refused),
        cmocka_unit_test(items_that_do_not_fit_their_group_are_refused),
        cmocka_unit_test(occluders_outside_of_their_mesh_are_refused),
        cmocka_unit_test(a_shadow_map_out_of_range_is_refused),
        cmocka_unit_test(parts_of_an_sdf_that_is_missing_are_refused),
        cmocka_unit_test(an_sdf_out_of_range_is_refused),
        cmocka_unit_test(code_compiled_for_other_instances_is_refused),
#ifndef MASU_LAB
        cmocka_unit_test(marches_of_the_lab_build_are_refused),
#endif
        cmocka_unit_test(an_sdf_parameter_outside_its_range_is_refused),
        cmocka_unit_test(an_sdf_without_code_is_refused),
        cmocka_unit_test(an_anchored_sdf_needs_the_code_that_moves_it),
        cmocka_unit_test(an_sdf_without_slots_that_are_finite_is_refused),
        cmocka_unit_test(an_sdf_of_no_parts_or_too_many_is_refused),
    };
    return cmocka_run_group_tests_name("scene_rules", tests, support_make_edge, NULL);
}
