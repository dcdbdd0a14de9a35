/* test_gltf.c: imports each feature of glTF: small files are written here, and the baked result is
 * compared with the values they were made from. Unsupported features are reported; invalid or
 * hostile files are rejected with one line. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <meshoptimizer.h>

#include "bake/import/gltf.h"
#include "bake/import/import.h"
#include "bake/texture/texture.h"
#include "cli/cli.h"
#include "support/files.h"
#include "support/gltf_file.h"

/* ---- Baked results --------------------------------------------------------------------------- */

static masu_bake_content piece;
static char heard[8192];

static void hear(void *user, const char *text) {
    (void)user;
    add(heard, sizeof heard, "%s\n", text);
}

static void import_as(const char *path, masu_bake_wanted wanted) {
    masu_bake_content_release(&piece);
    heard[0] = '\0';
    masu_cli_hear_warnings(hear, NULL);
    assert_true(masu_bake_import_as(path, &wanted, &piece));
    masu_cli_hear_warnings(NULL, NULL);
}

static void import_quietly(const char *path) {
    import_as(path, (masu_bake_wanted){0});
    assert_string_equal(heard, "");
}

static void import_warned(const char *path, const char *warning) {
    import_as(path, (masu_bake_wanted){0});
    if (!strstr(heard, warning) || strchr(heard, '\n') != strrchr(heard, '\n')) fail_msg("heard: %s", heard);
}

/* Imports in this process, without the sandbox, and expects an error that contains `why`. */
static void refused(const char *path, const char *variant, const char *why) {
    masu_bake_content content = {0};
    masu_bake_buffer warnings = {0}, error = {0};
    masu_gltf g = {.path = path, .variant = variant, .piece = &content, .warnings = &warnings, .error = &error};
    assert_false(masu_gltf_read(&g));
    masu_bake_append(&error, "", 1);
    if (!strstr((const char *)error.data, why) || strchr((const char *)error.data, '\n'))
        fail_msg("\"%s\" is not in: %s", why, (const char *)error.data);
    masu_gltf_release(&g);
    masu_bake_content_release(&content);
    masu_bake_release(&warnings);
    masu_bake_release(&error);
}

static const masu_blob_material *material(uint32_t index) {
    assert_true(index < masu_bake_count(&piece, MASU_BLOB_MATERIALS));
    return &MASU_BAKE_MATERIALS(&piece)[index];
}

static uint64_t triangles(void) { return masu_bake_count(&piece, MASU_BLOB_INDICES) / 3; }

static void assert_near(double a, double b, double error) {
    if (!(fabs(a - b) <= error)) fail_msg("%.9g is not %.9g within %g", a, b, error);
}

/* Index of the vertex at this position. */
static uint32_t vertex_at(double x, double y, double z, double error) {
    for (uint32_t i = 0; i < masu_bake_count(&piece, MASU_BLOB_VERTICES); i++) {
        const float *p = MASU_BAKE_VERTICES(&piece)[i].position;
        if (fabs((double)p[0] - x) <= error && fabs((double)p[1] - y) <= error && fabs((double)p[2] - z) <= error) return i;
    }
    fail_msg("no vertex at %g %g %g", x, y, z);
    return 0;
}

static const float *texcoord_at(double x, double y) {
    return MASU_BAKE_ARRAY(&piece, MASU_BLOB_TEXCOORDS, float) + 2 * (size_t)vertex_at(x, y, 0, 0);
}

/* ---- Geometry -------------------------------------------------------------------------------- */

static void quantized_positions_and_normals(void **state) {
    (void)state;
    int16_t p[8][4] = {{0}};
    int8_t n[8][4] = {{0}};
    for (int i = 0; i < 8; i++) {
        for (int k = 0; k < 3; k++) {
            p[i][k] = i >> k & 1 ? 32767 : -32767;
            n[i][k] = i >> k & 1 ? 73 : -73;
        }
    }
    static const uint8_t faces[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    begin();
    int positions = accessor(view(p, sizeof p, 8), SHORT, "VEC3", 8, ",\"normalized\":true");
    int normals = accessor(view(n, sizeof n, 4), BYTE, "VEC3", 8, ",\"normalized\":true");
    int indices = accessor(view(faces, sizeof faces, 0), UBYTE, "SCALAR", 36, "");
    import_quietly(finish("\"extensionsUsed\":[\"KHR_mesh_quantization\"],\"extensionsRequired\":[\"KHR_mesh_quantization\"],"
                          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"NORMAL\":%d},\"indices\":%d}]}],"
                          "\"nodes\":[{\"name\":\"cube\",\"mesh\":0,\"scale\":[2,3,4],\"translation\":[0,5,0]}],\"scenes\":[{\"nodes\":[0]}]",
                          positions, normals, indices));
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_VERTICES), 8);
    assert_int_equal(triangles(), 12);
    uint32_t v = vertex_at(1, -1, 1, 1e-6);
    masu_bake_vec3 normal = masu_bake_decode_normal(MASU_BAKE_VERTICES(&piece)[v].normal);
    assert_near(normal.x, sqrt(1 / 3.0), 1e-3);
    assert_near(normal.y, -sqrt(1 / 3.0), 1e-3);
    masu_bake_affine to = masu_bake_identity();
    masu_bake_box box = masu_bake_bounds(&piece, &to);
    assert_near(box.high.x, 2, 1e-5);
    assert_near(box.low.y, 2, 1e-5);
    assert_near(box.high.z, 4, 1e-5);
    assert_string_equal(masu_bake_name_text(&piece, MASU_BAKE_INSTANCES(&piece)[0].name), "cube");
}

static void indices_of_all_types_strips_and_fans(void **state) {
    (void)state;
    static const uint8_t bytes[4] = {0, 1, 3, 2};
    static const uint32_t words[4] = {0, 1, 2, 3};
    begin_quad();
    int strip = accessor(view(bytes, 4, 0), UBYTE, "SCALAR", 4, "");
    int fan = accessor(view(words, 16, 0), UINT, "SCALAR", 4, "");
    import_quietly(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d},"
                          "{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"mode\":5},"
                          "{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"mode\":6}]}],\"nodes\":[{\"mesh\":0}]",
                          quad_positions, quad_indices, quad_positions, strip, quad_positions, fan));
    assert_int_equal(triangles(), 6);
    /* the winding is kept */
    for (uint32_t i = 0; i < masu_bake_count(&piece, MASU_BLOB_VERTICES); i++) {
        masu_bake_vec3 n = masu_bake_decode_normal(MASU_BAKE_VERTICES(&piece)[i].normal);
        assert_near(n.z, 1, 1e-4);
    }
}

static void sparse_accessors_change_some_elements(void **state) {
    (void)state;
    static const uint8_t changed[2] = {1, 2};
    static const float to[6] = {3, 0, 0, 0, 4, 0};
    begin();
    int at = view(changed, 2, 0), values = view(to, sizeof to, 0);
    char sparse[256];
    snprintf(sparse, sizeof sparse,
             ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":%d,\"componentType\":5121},\"values\":{\"bufferView\":%d}}", at, values);
    int positions = accessor(-1, FLOAT, "VEC3", 3, sparse); /* otherwise zeros */
    import_quietly(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d}}]}],\"nodes\":[{\"mesh\":0}]", positions));
    assert_int_equal(triangles(), 1);
    vertex_at(0, 0, 0, 0);
    vertex_at(3, 0, 0, 0);
    vertex_at(0, 4, 0, 0);
}

/* The test above changes the last element; the one behind it would be a write beyond the array. */
static void a_sparse_index_is_below_the_count(void **state) {
    (void)state;
    static const float to[3];
    for (int integers = 0; integers < 2; integers++) {
        const uint8_t changed = integers ? 6 : 4;
        char sparse[256], why[80];
        begin_quad();
        snprintf(sparse, sizeof sparse,
                 ",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":%d,\"componentType\":5121},\"values\":{\"bufferView\":%d}}",
                 view(&changed, 1, 0), view(to, sizeof to, 0));
        int a = accessor(-1, integers ? UINT : FLOAT, integers ? "SCALAR" : "VEC3", changed, sparse);
        snprintf(why, sizeof why, "\"sparse\" changes element %d of %d", changed, changed);
        refused(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],\"nodes\":[{\"mesh\":0}]",
                       integers ? quad_positions : a, integers ? a : quad_indices),
                NULL, why);
    }
}

static void morph_weights_of_the_node_rest(void **state) {
    (void)state;
    static const float up[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    begin_quad();
    int target = floats(up, "VEC3", 4, 3);
    import_quietly(finish("\"meshes\":[{\"weights\":[1],\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"targets\":[{\"POSITION\":%d}]}]}],"
                          "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"weights\":[0.25]}]",
                          quad_positions, quad_indices, target));
    assert_int_equal(triangles(), 4); /* two meshes: their weights differ */
    vertex_at(2, 1, 1, 1e-6);
    vertex_at(2, 1, 0.25, 1e-6);
}

/* Morph targets of a movable model are kept, and its clips change their weights. */
static void morph_targets_are_kept_to_move(void **state) {
    (void)state;
    static const float up[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, aside[12] = {0, 0, 0, -3, 0, 0};
    static const float times[2] = {0, 2}, weights[4] = {0, 1, 0.5f, 0.25f};
    begin_quad();
    int first = floats(up, "VEC3", 4, 3), second = floats(aside, "VEC3", 4, 3);
    int t = floats(times, "SCALAR", 2, 1), w = floats(weights, "SCALAR", 4, 1);
    const char *path = finish("\"meshes\":[{\"weights\":[0.5,0],\"extras\":{\"targetNames\":[\"up\",\"aside\"]},\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,"
                              "\"targets\":[{\"POSITION\":%d},{\"POSITION\":%d}]}]}],\"nodes\":[{\"mesh\":0,\"translation\":[0,5,0]}],"
                              "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}}],"
                              "\"samplers\":[{\"input\":%d,\"output\":%d}]}]",
                              quad_positions, quad_indices, first, second, t, w);
    import_as(path, (masu_bake_wanted){.plays = true});
    assert_string_equal(heard, "");
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_SKINS), 1);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_MORPH_TARGETS), 2);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_MORPH_DELTAS), 2 * masu_bake_count(&piece, MASU_BLOB_VERTICES));
    const masu_blob_morph_target *m = MASU_BAKE_ARRAY(&piece, MASU_BLOB_MORPH_TARGETS, masu_blob_morph_target);
    assert_string_equal(masu_bake_name_text(&piece, m[1].name), "aside");
    assert_near((double)m[0].weight, 0.5, 0);
    assert_near((double)m[0].high[2], 1, 0);
    assert_near((double)m[1].low[0], -3, 0);
    vertex_at(2, 6, 0.5, 1e-6); /* the baked scene: default weights, at the node's position */
    const masu_blob_channel *c = MASU_BAKE_ARRAY(&piece, MASU_BLOB_CHANNELS, masu_blob_channel);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_CHANNELS), 2);
    const masu_blob_skin *skin = MASU_BAKE_ARRAY(&piece, MASU_BLOB_SKINS, masu_blob_skin);
    for (uint32_t i = 0; i < 2; i++) {
        const masu_blob_key *k = MASU_BAKE_ARRAY(&piece, MASU_BLOB_KEYS, masu_blob_key) + c[i].first_key;
        assert_int_equal(c[i].path, MASU_CHANNEL_WEIGHT);
        assert_int_equal(c[i].node, skin->node);
        assert_int_equal(c[i].target, i);
        assert_near((double)k[1].value[0], (double)weights[2 + i], 0);
    }
}

static void instances_of_a_node(void **state) {
    (void)state;
    static const float places[15] = {0, 0, 0, 10, 0, 0, 20, 0, 0, 30, 0, 0, 40, 0, 5};
    static const float sizes[15] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 3, 3, 3};
    begin_quad();
    int t = floats(places, "VEC3", 5, 3), s = floats(sizes, "VEC3", 5, 3);
    import_quietly(finish("\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],"
                          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],"
                          "\"nodes\":[{\"name\":\"many\",\"mesh\":0,\"translation\":[0,1,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":"
                          "{\"attributes\":{\"TRANSLATION\":%d,\"SCALE\":%d}}}}]",
                          quad_positions, quad_indices, t, s));
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_INSTANCES), 5);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_MESHES), 1);
    masu_bake_affine last = masu_bake_transform(&MASU_BAKE_INSTANCES(&piece)[4]);
    masu_bake_vec3 p = masu_bake_apply(&last, masu_bake_v3(2, 1, 0));
    assert_near(p.x, 46, 1e-4);
    assert_near(p.y, 4, 1e-4);
    assert_near(p.z, 5, 1e-4);
    assert_string_equal(masu_bake_name_text(&piece, MASU_BAKE_INSTANCES(&piece)[4].name), "many.4");
}

/* ---- Compression ----------------------------------------------------------------------------- */

static void meshopt_unpacks(void **state) {
    (void)state;
    static const unsigned order[6] = {0, 1, 2, 2, 1, 3};
    static const float positions[12] = {0, 0, 0, 7, 0, 0, 0, 8, 0, 7, 8, 0};
    unsigned char packed[2][512];
    size_t bytes[2];
    bytes[0] = meshopt_encodeVertexBuffer(packed[0], sizeof packed[0], positions, 4, 12);
    bytes[1] = meshopt_encodeIndexBuffer(packed[1], sizeof packed[1], order, 6);
    assert_true(bytes[0] && bytes[1]);
    begin();
    size_t at[2] = {put(packed[0], bytes[0]), put(packed[1], bytes[1])};
    add(file.views, sizeof file.views,
        "{\"buffer\":1,\"byteLength\":48,\"byteStride\":12,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":%zu,"
        "\"byteLength\":%zu,\"byteStride\":12,\"count\":4,\"mode\":\"ATTRIBUTES\"}}},"
        "{\"buffer\":1,\"byteLength\":12,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":%zu,"
        "\"byteLength\":%zu,\"byteStride\":2,\"count\":6,\"mode\":\"TRIANGLES\"}}}",
        at[0], bytes[0], at[1], bytes[1]);
    int p = accessor(0, FLOAT, "VEC3", 4, ""), i = accessor(1, USHORT, "SCALAR", 6, "");
    char rest[512];
    snprintf(rest, sizeof rest,
             "\"extensionsRequired\":[\"EXT_meshopt_compression\"],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],"
             "\"nodes\":[{\"mesh\":0}]", p, i);
    import_quietly(finish("%s", rest));
    assert_int_equal(triangles(), 2);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_VERTICES), 4);
    vertex_at(7, 8, 0, 0);
    file.data[at[0]] ^= 0x55; /* the header of the packed vertices */
    refused(finish("%s", rest), NULL, "EXT_meshopt_compression: the bytes are damaged");
}

static void draco_unpacks(void **state) {
    (void)state;
    const char *both = "{\"POSITION\":0,\"TEXCOORD_0\":1}";
    import_as(packed(sizeof packed_quad, both), (masu_bake_wanted){.textures = MASU_BAKE_TEXTURES_FORCED});
    assert_string_equal(heard, "");
    assert_int_equal(triangles(), 2);
    uint32_t v = vertex_at(2, 1, 0, 2e-3);
    const float *t = MASU_BAKE_ARRAY(&piece, MASU_BLOB_TEXCOORDS, float) + 2 * (size_t)v;
    assert_near((double)t[0], 1, 1e-3);
    assert_near((double)t[1], 0, 1e-3);
    refused(packed(sizeof packed_quad - 60, both), NULL, "KHR_draco_mesh_compression: the bytes are damaged");
    refused(packed(sizeof packed_quad, "{\"POSITION\":7}"), NULL, "no attribute 7 for POSITION");
}

/* ---- Textures and colours -------------------------------------------------------------------- */

/* Two textures with one image, and a material. */
static const char *finish_textured(const char *attributes, const char *about) {
    char rest[2048];
    int v = view(webp, sizeof webp, 0);
    snprintf(rest, sizeof rest,
             ",\"images\":[{\"bufferView\":%d,\"mimeType\":\"image/webp\"}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648}],"
             "\"textures\":[{\"sampler\":0,\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}},{\"sampler\":0,\"source\":0}],\"materials\":[%s]",
             v, about);
    return finish_quad(attributes, ",\"material\":0", rest);
}

static int begin_mapped(char *attributes, size_t room) {
    static const float first[8] = {9, 9, 9, 9, 9, 9, 9, 9}, second[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    begin_quad();
    int a = floats(first, "VEC2", 4, 2), b = floats(second, "VEC2", 4, 2);
    snprintf(attributes, room, ",\"TEXCOORD_0\":%d,\"TEXCOORD_1\":%d", a, b);
    return b;
}

static void coordinates_are_of_the_set_and_turned(void **state) {
    (void)state;
    char attributes[128];
    begin_mapped(attributes, sizeof attributes);
    import_quietly(finish_textured(
        attributes, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":0,\"extensions\":{\"KHR_texture_transform\":"
                    "{\"texCoord\":1,\"rotation\":0.5235987755982988,\"scale\":[2,3],\"offset\":[0.5,0.25]}}}}}"));
    const masu_bake_maps *maps = MASU_BAKE_MAPS_OF(&piece);
    assert_int_not_equal(maps->image[MASU_BAKE_BASE], MASU_BLOB_NONE);
    assert_int_equal(MASU_BAKE_IMAGES(&piece)[maps->image[MASU_BAKE_BASE]].data_bytes, sizeof webp);
    assert_int_equal(maps->wrap[0], 1);
    assert_int_equal(maps->wrap[1], 2);
    double c = sqrt(0.75), s = 0.5; /* (1, 0) of the set is at (2, 1) */
    assert_near((double)texcoord_at(2, 1)[0], c * 2 + 0.5, 1e-6);
    assert_near((double)texcoord_at(2, 1)[1], -s * 2 + 0.25, 1e-6);
    assert_near((double)texcoord_at(0, 0)[0], s * 3 + 0.5, 1e-6); /* (0, 1) */
    assert_near((double)texcoord_at(0, 0)[1], c * 3 + 0.25, 1e-6);
}

static void maps_of_other_coordinates_are_told(void **state) {
    (void)state;
    char attributes[128];
    begin_mapped(attributes, sizeof attributes);
    /* A second set of coordinates for textures that need different ones, but not for transparent
     * materials. */
    import_quietly(finish_textured(attributes, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":1}},"
                                               "\"normalTexture\":{\"index\":1,\"texCoord\":0}}"));
    assert_int_not_equal(MASU_BAKE_MAPS_OF(&piece)->image[MASU_BAKE_NORMAL], MASU_BLOB_NONE);
    assert_int_equal(MASU_BAKE_MAPS_OF(&piece)->second, 1u << MASU_SLOT_NORMAL);
    begin_mapped(attributes, sizeof attributes);
    import_warned(finish_textured(attributes, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":1}},\"alphaMode\":\"BLEND\","
                                              "\"normalTexture\":{\"index\":1,\"texCoord\":0}}"),
                  "1 textures use other coordinates than the base colour of their material: ignored");
    assert_int_equal(MASU_BAKE_MAPS_OF(&piece)->image[MASU_BAKE_NORMAL], MASU_BLOB_NONE);
    begin_mapped(attributes, sizeof attributes);
    import_quietly(finish_textured(attributes, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":1}},\"normalTexture\":"
                                               "{\"index\":1,\"texCoord\":1,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[4,8]}}}}"));
    assert_int_not_equal(MASU_BAKE_MAPS_OF(&piece)->image[MASU_BAKE_NORMAL], MASU_BLOB_NONE);
    assert_near((double)material(0)->detail[0], 4, 1e-5);
    assert_near((double)material(0)->detail[1], 8, 1e-5);
}

/* Properties of a material's coat, and which of both has the normal map then. */
static void coats_have_pictures_of_their_own(void **state) {
    (void)state;
#define NORMAL "\"normalTexture\":{\"index\":1,\"texCoord\":1},"
#define COAT_OF(more) "\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5" more "}}"
    static const struct {
        const char *about, *warning;
        int relief_of;
    } cases[] = {
        {"{" NORMAL COAT_OF("") "}", NULL, MASU_BAKE_RELIEF_OF_BASE},
        {"{" NORMAL COAT_OF(",\"clearcoatNormalTexture\":{\"index\":1,\"texCoord\":1}") "}", NULL, MASU_BAKE_RELIEF_OF_BOTH},
        {"{" COAT_OF(",\"clearcoatNormalTexture\":{\"index\":1,\"texCoord\":1,\"scale\":3}") "}", NULL, MASU_BAKE_RELIEF_OF_COAT},
        {"{" NORMAL COAT_OF(",\"clearcoatNormalTexture\":{\"index\":1,\"texCoord\":1,\"scale\":3}") "}",
         NULL, MASU_BAKE_RELIEF_OF_BASE},
        {"{" NORMAL "\"emissiveTexture\":{\"index\":0,\"texCoord\":1}," COAT_OF(",\"clearcoatNormalTexture\":{\"index\":0,\"texCoord\":1,\"scale\":3}") "}",
         "1 clear coats have another normal map than the base layer, and the material has emission or is transparent",
         MASU_BAKE_RELIEF_OF_BASE},
        {"{" NORMAL "\"name\":\"without\"}", NULL, MASU_BAKE_RELIEF_OF_BOTH}};
    char attributes[128];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        begin_mapped(attributes, sizeof attributes);
        const char *path = finish_textured(attributes, cases[i].about);
        if (cases[i].warning)
            import_warned(path, cases[i].warning);
        else
            import_quietly(path);
        const masu_bake_maps *maps = MASU_BAKE_MAPS_OF(&piece);
        assert_int_equal(maps->relief_of, cases[i].relief_of);
        assert_int_not_equal(maps->image[MASU_BAKE_NORMAL], MASU_BLOB_NONE);
        assert_near((double)maps->normal_scale, cases[i].relief_of == MASU_BAKE_RELIEF_OF_COAT ? 3 : 1, 0);
    }
    begin_mapped(attributes, sizeof attributes);
    import_quietly(finish_textured(attributes, "{" COAT_OF(",\"clearcoatTexture\":{\"index\":1,\"texCoord\":1},\"clearcoatRoughnessTexture\":"
                                               "{\"index\":0,\"texCoord\":1}") "}"));
    const masu_bake_maps *maps = MASU_BAKE_MAPS_OF(&piece);
    assert_int_not_equal(maps->image[MASU_BAKE_COAT], MASU_BLOB_NONE);
    assert_int_not_equal(maps->image[MASU_BAKE_COAT_ROUGHNESS], MASU_BLOB_NONE);
    assert_int_equal(maps->channel[MASU_BAKE_COAT], 0);
    assert_int_equal(maps->channel[MASU_BAKE_COAT_ROUGHNESS], 1);
}

static const char *colored(const float *colors, const char *about) {
    char attributes[64], rest[512];
    begin_quad();
    snprintf(attributes, sizeof attributes, ",\"COLOR_0\":%d", floats(colors, "VEC4", 4, 4));
    snprintf(rest, sizeof rest, ",\"materials\":[{%s}]", about);
    return finish_quad(attributes, ",\"material\":0", rest);
}

static void colours_of_vertices_become_materials(void **state) {
    (void)state;
    static const float one[16] = {1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 1};
    static const float many[16] = {1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 1};
    static const uint8_t bytes[16] = {255, 51, 0, 255, 255, 51, 0, 255, 255, 51, 0, 255, 255, 51, 0, 255};
    import_quietly(colored(one, "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.5,0.5,1]}"));
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_MATERIALS), 1);
    assert_near((double)material(0)->base_color[0], 0.5, 1e-6);
    assert_near((double)material(0)->base_color[2], 0.125, 1e-6);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_VERTICES), 4);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_COLORS), 0);
    /* Variation within a triangle is kept: one material, square roots of linear colours. */
    import_quietly(colored(many, ""));
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_MATERIALS), 1);
    assert_int_equal(triangles(), 2);
    assert_int_equal(MASU_BAKE_MAPS_OF(&piece)->colored, MASU_BAKE_COLORED);
    static const uint32_t stored[4] = {0xFF0000FF, 0xFF000000, 0xFF000000, 0xFF00FF00};
    static const float corners[4][2] = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
    for (int i = 0; i < 4; i++) {
        uint32_t v = vertex_at((double)corners[i][0], (double)corners[i][1], 0, 0);
        assert_int_equal(masu_bake_attributes_of(&piece, v).color, stored[i]);
    }
    static const float faint[16] = {1, 0.25f, 0, 1, 1, 1, 1, 0.5f, 1, 1, 1, 1, 1, 1, 1, 1};
    import_quietly(colored(faint, "\"alphaMode\":\"BLEND\""));
    assert_int_equal(MASU_BAKE_MAPS_OF(&piece)->colored, MASU_BAKE_COLORED_ALPHA);
    assert_int_equal(masu_bake_attributes_of(&piece, vertex_at(0, 0, 0, 0)).color, 0xFF0080FF);
    assert_int_equal(masu_bake_attributes_of(&piece, vertex_at(2, 0, 0, 0)).color, 0x80FFFFFF);
    char attributes[64];
    begin_quad();
    snprintf(attributes, sizeof attributes, ",\"COLOR_0\":%d", accessor(view(bytes, 16, 4), UBYTE, "VEC3", 4, ",\"normalized\":true"));
    import_quietly(finish_quad(attributes, "", ""));
    assert_near((double)material(0)->base_color[1], 0.2, 1e-6);
}

/* ---- Materials ------------------------------------------------------------------------------- */

static const masu_blob_material *only(const char *about) {
    char rest[1024];
    begin_quad();
    snprintf(rest, sizeof rest, ",\"materials\":[{\"name\":\"m\",%s}]", about);
    import_quietly(finish_quad("", ",\"material\":0", rest));
    return material(0);
}

static void factors_of_materials(void **state) {
    (void)state;
    const masu_blob_material *m = only("\"emissiveFactor\":[0.5,0.25,0],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8}}");
    assert_near((double)m->emissive[0], 4, 1e-6);
    assert_near((double)m->emissive[1], 2, 1e-6);
    assert_near((double)m->metallic, 1, 0);
    m = only("\"extensions\":{\"KHR_materials_specular\":{\"specularFactor\":0.4},\"KHR_materials_ior\":{\"ior\":1.5}}");
    assert_near((double)m->specular, 0.2, 1e-6);
    m = only("\"extensions\":{\"KHR_materials_ior\":{\"ior\":1.3333333333}}");
    assert_near((double)m->specular, 0.020408163 / 0.08, 1e-6);
    m = only("\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.75,\"clearcoatRoughnessFactor\":0.125}}");
    assert_near((double)m->coat, 0.75, 0);
    assert_near((double)m->coat_roughness, 0.125, 0);
    m = only("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.125,1]},\"extensions\":{\"KHR_materials_unlit\":{}}");
    assert_near((double)m->emissive[1], 0.5, 0);
    assert_near((double)m->specular, 0, 0);
    m = only("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.125,1],\"metallicFactor\":0,\"roughnessFactor\":0},\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.9}}");
    assert_near((double)m->opacity, 1 - 0.9, 1e-6); /* the colour of the transmitted light */
    assert_int_equal(MASU_BAKE_MAPS_OF(&piece)->alpha, MASU_BAKE_ALPHA_BLEND);
    assert_int_equal(MASU_BAKE_MAPS_OF(&piece)->tinted, 1);
    /* 0.5 m of a medium that transmits a quarter of the red in 0.25 m: a sixteenth, by one surface,
     * or by front and back. */
#define VOLUME                                                                                                              \
    "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,1,1,1],\"metallicFactor\":0},"                                      \
    "\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":"                   \
    "{\"thicknessFactor\":0.5,\"attenuationDistance\":0.25,\"attenuationColor\":[0.25,1,1]}}"
    m = only("\"doubleSided\":true," VOLUME);
    assert_near((double)m->base_color[0], 0.5 * 0.25, 1e-6);
    m = only(VOLUME);
    assert_near((double)m->base_color[0], 0.5 * 0.0625, 1e-6);
    assert_near((double)m->base_color[1], 1, 0);
    assert_near((double)m->thickness, 0.5, 0);
    assert_near((double)m->ior, 1.5, 0);
#define GLASS(ior, rest)                                                                                                    \
    "\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}," \
    "\"KHR_materials_ior\":{\"ior\":" ior "},\"KHR_materials_volume\":{\"thicknessFactor\":2}" rest "}"
    m = only(GLASS("2.4", "")); /* beyond 1.79: reflectance and refraction are both those of 2.4 */
    assert_near((double)m->ior, 2.4, 1e-6);
    assert_near((double)m->specular * 0.08, (1.4 / 3.4) * (1.4 / 3.4), 1e-6);
    m = only(GLASS("0", ""));
    assert_near((double)m->ior, 1000, 0);
    m = only(GLASS("1.5", ",\"KHR_materials_unlit\":{}"));
    assert_near((double)m->thickness + (double)m->ior, 0, 0);
    m = only("\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.5,0.25,0.125,1],\"specularFactor\":[0.04,0.04,0.04],\"glossinessFactor\":0.75}}");
    assert_near((double)m->base_color[0], 0.5, 1e-5);
    assert_near((double)m->roughness, 0.25, 1e-6);
    assert_near((double)m->metallic, 0, 1e-6);
    m = only("\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0,0,0,1],\"specularFactor\":[0.9,0.7,0.3],\"glossinessFactor\":1}}");
    assert_near((double)m->metallic, 1, 0.03);
    assert_near((double)m->base_color[2], 0.3, 0.03);
    m = only("\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.5]}");
    assert_near((double)m->opacity, 0.5, 0);
}

static void what_is_not_read_is_told(void **state) {
    (void)state;
    begin_quad();
    import_warned(finish_quad("", ",\"material\":0",
                              ",\"materials\":[{\"name\":\"oil\",\"extensions\":{\"KHR_materials_iridescence\":{}}},{\"name\":\"pearl\",\"extensions\":{\"KHR_materials_iridescence\":{}}}]"),
                  "2 times KHR_materials_iridescence, which is not supported (first: oil)");
    begin_quad();
    char attributes[64];
    snprintf(attributes, sizeof attributes, ",\"_WETNESS\":%d", quad_positions);
    import_warned(finish_quad(attributes, "", ""), "1 primitives have _WETNESS, which is not supported (first: quad)");
    begin_quad();
    snprintf(attributes, sizeof attributes, ",\"_FEATURE_ID_0\":%d", quad_positions);
    import_quietly(finish_quad(attributes, "", ",\"extensionsUsed\":[\"EXT_structural_metadata\"],\"extensions\":{\"EXT_structural_metadata\":{}}"));
    begin_quad();
    import_warned(finish("\"meshes\":[{\"name\":\"quad\",\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d},{\"attributes\":{\"POSITION\":%d},\"mode\":1}]}],\"nodes\":[{\"mesh\":0}]",
                         quad_positions, quad_indices, quad_positions),
                  "1 primitives are lines: skipped (first: quad)");
}

/* The material after its textures have been made, with the warnings of both. */
static const masu_blob_material *finished(const char *path) {
    import_as(path, (masu_bake_wanted){0});
    masu_cli_hear_warnings(hear, NULL);
    assert_true(masu_bake_make_textures(&piece, NULL));
    masu_cli_hear_warnings(NULL, NULL);
    return material(0);
}

/* If a map is omitted, an emission that needs it is dark; an unlit material has its factor. */
static void without_its_map_a_material_has_its_factor(void **state) {
    (void)state;
#define EMISSION(texture) "{\"emissiveFactor\":[1,0.5,0.25],\"emissiveTexture\":{" texture "}"
#define BASE(texture) "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,0.125,1],\"baseColorTexture\":{" texture "}}"
#define UNLIT ",\"extensions\":{\"KHR_materials_unlit\":{}}}"
    static const struct {
        const char *about;
        double emits;
        const char *warning;
    } cases[] = {
        {EMISSION("\"index\":1,\"texCoord\":0") ",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1,\"texCoord\":1}}}", 1, ""},
        {EMISSION("\"index\":2") "}", 0, "have no supported image"},
        {EMISSION("\"index\":3") "}", 0, "gone.png"},
        {EMISSION("\"index\":4") "}", 0, "are not files"},
        {EMISSION("\"index\":1,\"texCoord\":1") "}", 1, ""},
        {BASE("\"index\":2") UNLIT, 0.5, "have no supported image"},
        {BASE("\"index\":3") UNLIT, 0.5, "gone.png"},
        {BASE("\"index\":4") UNLIT, 0.5, "are not files"},
        {BASE("\"index\":1,\"texCoord\":1") UNLIT, 0.5, ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char attributes[128], rest[2048];
        begin_mapped(attributes, sizeof attributes);
        snprintf(rest, sizeof rest,
                 ",\"images\":[{\"bufferView\":%d,\"mimeType\":\"image/webp\"},{\"uri\":\"gone.png\"},{\"uri\":\"http://there/is/none.png\"}],"
                 "\"textures\":[{\"source\":0},{\"source\":0},{},{\"source\":1},{\"source\":2}],\"materials\":[%s]",
                 view(webp, sizeof webp, 0), cases[i].about);
        const masu_blob_material *m = finished(finish_quad(attributes, ",\"material\":0", rest));
        if (!strstr(heard, cases[i].warning)) fail_msg("case %zu: %s", i, heard);
        if (!*cases[i].warning) assert_string_equal(heard, "");
        assert_near((double)m->emissive[0], cases[i].emits, 0);
        assert_near((double)m->emissive[1], cases[i].emits / 2, 0);
    }
}

/* 1 + strength (visibility - 1), in the texels. */
static void occlusion_has_a_strength(void **state) {
    (void)state;
    static const struct {
        const char *strength;
        int value;
    } cases[] = {{"", 51}, {",\"strength\":1", 51}, {",\"strength\":0.25", 204}, {",\"strength\":0", 255}};
    unsigned char image[64] = "P5 4 4 255\n";
    memset(image + 11, 51, 16);
    write_bytes("dark.pgm", image, 27);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char attributes[128], rest[512];
        begin_mapped(attributes, sizeof attributes);
        snprintf(rest, sizeof rest,
                 ",\"images\":[{\"uri\":\"dark.pgm\"}],\"textures\":[{\"source\":0}],\"materials\":[{\"occlusionTexture\":{\"index\":0,\"texCoord\":1%s}}]",
                 cases[i].strength);
        finished(finish_quad(attributes, ",\"material\":0", rest));
        assert_string_equal(heard, "");
        assert_int_equal(masu_bake_count(&piece, MASU_BLOB_TEXTURES), 1);
        /* An endpoint of a BC4 block. */
        assert_int_equal(piece.section[MASU_BLOB_TEXELS].data[0], cases[i].value);
    }
}

/* A texture whose coordinates are within 0..1 along an axis does not repeat there: its far edge
 * would bleed in. */
static void textures_that_are_shown_once_are_clamped(void **state) {
    (void)state;
    static const struct {
        float u, v;       /* the far corner */
        const char *more; /* of the texture */
        uint32_t wrap[2];
    } cases[] = {{1, 1, "", {1, 1}},
                 {4, 1, "", {0, 1}},
                 {1, 1.5f, "", {1, 0}},
                 {0.5f, 1.0001f, "", {1, 1}},
                 {-0.5f, 1, "", {0, 1}},
                 {1, 1, ",\"sampler\":0", {2, 1}},
                 {1, 1, "detail", {0, 1}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const float uv[8] = {0, 0, cases[i].u, 0, cases[i].u, cases[i].v, 0, cases[i].v};
        bool detail = !strcmp(cases[i].more, "detail");
        char attributes[64], rest[1024];
        begin_quad();
        snprintf(attributes, sizeof attributes, ",\"TEXCOORD_0\":%d", floats(uv, "VEC2", 4, 2));
        snprintf(rest, sizeof rest,
                 ",\"images\":[{\"bufferView\":%d,\"mimeType\":\"image/webp\"}],\"samplers\":[{\"wrapS\":33648}],\"textures\":[{\"source\":0%s}],"
                 "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}%s}]",
                 view(webp, sizeof webp, 0), detail ? "" : cases[i].more,
                 detail ? ",\"normalTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[8,1]}}}" : "");
        finished(finish_quad(attributes, ",\"material\":0", rest));
        assert_string_equal(heard, "");
        const masu_blob_texture_set *set = MASU_BAKE_ARRAY(&piece, MASU_BLOB_TEXTURE_SETS, masu_blob_texture_set);
        for (int k = 0; k < 2; k++) {
            if (set->wrap[k] != cases[i].wrap[k]) fail_msg("case %zu, axis %d: wrap %u", i, k, set->wrap[k]);
        }
    }
}

/* Values that are out of a blob's range, or simplified, are reported. */
static void clamped_and_simplified_values_are_told(void **state) {
    (void)state;
#define EXTENSION(name, members) "{\"extensions\":{\"KHR_materials_" name "\":{" members "}}}"
#define DIELECTRIC(name, members) "{\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_" name "\":{" members "}}}"
    static const char *const cases[][2] = {
        {DIELECTRIC("clearcoat", "\"clearcoatFactor\":1},\"KHR_materials_ior\":{\"ior\":2.4"),
         "1 materials have a clear coat and a specular colour, texture or reflectance above 0.08: gray, at most 0.08"},
        {DIELECTRIC("sheen", "\"sheenColorFactor\":[1,1,1]},\"KHR_materials_ior\":{\"ior\":1.4"),
         "1 materials have a sheen and a specular factor or index of refraction, which is ignored"},
        {DIELECTRIC("sheen", "\"sheenColorFactor\":[1,1,1]},\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1"),
         "1 materials have a clear coat and a sheen: the sheen is ignored"},
        {DIELECTRIC("sheen", "\"sheenColorFactor\":[1,1,1]},\"KHR_materials_anisotropy\":{\"anisotropyStrength\":1"),
         "1 materials have a sheen and an anisotropy: the anisotropy is ignored"},
        {DIELECTRIC("ior", "\"ior\":0.5"), "1 materials have an \"ior\" below 1: taken for 1"},
        {"{\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}}}",
         "1 materials transmit light and are alpha-tested"},
        {EXTENSION("clearcoat", "\"clearcoatFactor\":3"), "1 materials have a \"clearcoatFactor\" beyond 0 to 1: clamped"},
        {"{\"pbrMetallicRoughness\":{\"baseColorFactor\":[2,1,1,1]}}", "1 materials have a \"baseColorFactor\" beyond 0 to 1: clamped"},
        {"{\"pbrMetallicRoughness\":{\"roughnessFactor\":-1}}", "1 materials have a \"roughnessFactor\" beyond 0 to 1: clamped"},
        {"{\"alphaMode\":\"MASK\",\"alphaCutoff\":1.5}", "1 materials have a \"alphaCutoff\" beyond 0 to 1: clamped"},
        {"{\"emissiveFactor\":[1,1,1],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":1e6}}}",
         "1 materials have a \"emissiveFactor\" beyond 0 to 65504: clamped"},
        {EXTENSION("pbrSpecularGlossiness", "\"diffuseFactor\":[0.5,0.1,0.1,1],\"specularFactor\":[0.1,0.1,0.5]"),
         "1 materials have a specular colour that metallic and roughness can only approximate"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rest[1024];
        begin_quad();
        snprintf(rest, sizeof rest, ",\"materials\":[%s]", cases[i][0]);
        import_warned(finish_quad("", ",\"material\":0", rest), cases[i][1]);
    }
}

/* Reflectance at normal incidence, as KHR_materials_ior and KHR_materials_specular define it: ((n -
 * 1) / (n + 1))^2 times the colour, at most 1, times the factor. */
static void reflectance_is_of_any_colour_and_strength(void **state) {
    (void)state;
    static const struct {
        const char *about;
        double f0[3];
    } cases[] = {
        {DIELECTRIC("ior", "\"ior\":1.5"), {0.04, 0.04, 0.04}},
        {DIELECTRIC("ior", "\"ior\":2.4"), {0.16955, 0.16955, 0.16955}},
        {DIELECTRIC("ior", "\"ior\":0"), {1, 1, 1}},
        {DIELECTRIC("specular", "\"specularColorFactor\":[1,0.5,0.25]"), {0.04, 0.02, 0.01}},
        {DIELECTRIC("specular", "\"specularFactor\":0.5,\"specularColorFactor\":[100,10,1]"), {0.5, 0.2, 0.02}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rest[1024];
        begin_quad();
        snprintf(rest, sizeof rest, ",\"materials\":[%s]", cases[i].about);
        import_quietly(finish_quad("", ",\"material\":0", rest));
        for (int k = 0; k < 3; k++)
            assert_near((double)(material(0)->specular * (material(0)->specular_color[0] > 0 ? material(0)->specular_color[k] : 1)) * 0.08,
                        cases[i].f0[k], 1e-5);
    }
    begin_quad();
    import_quietly(finish_quad("", ",\"material\":0",
                               ",\"materials\":[{\"extensions\":{\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,0.5,0],"
                               "\"sheenRoughnessFactor\":0.3}}},{\"extensions\":{\"KHR_materials_anisotropy\":"
                               "{\"anisotropyStrength\":0.5,\"anisotropyRotation\":-1}}}]"));
    assert_near((double)material(0)->sheen_color[1], 0.5, 0);
    assert_near((double)material(0)->sheen_roughness, 0.3, 1e-6);
}

/* Each extension in the specification or its registry that is not supported gives one line with its
 * name. masu-bake --strict treats any such line as an error (tests/scripts/bake_placement.sh). */
static void nothing_is_dropped_in_silence(void **state) {
    (void)state;
    static const char *const of_materials[] = {
        "KHR_materials_iridescence",    "KHR_materials_dispersion",   "KHR_materials_diffuse_transmission",
        "KHR_materials_volume_scatter", "KHR_materials_sss",          "KHR_techniques_webgl",
        "KHR_materials_common",         "ADOBE_materials_clearcoat_specular", "ADOBE_materials_clearcoat_tint",
        "ADOBE_materials_thin_transparency", "NV_materials_mdl",      "MSFT_packing_occlusionRoughnessMetallic",
        "MSFT_packing_normalRoughnessMetallic", "VRMC_materials_mtoon", "EXT_materials_bump"};
    static const char *const of_nodes[] = {
        "KHR_node_visibility", "KHR_node_selectability", "KHR_node_hoverability", "KHR_physics_rigid_bodies", "KHR_audio_emitter",
        "EXT_lights_ies",      "MSFT_lod",               "AGI_articulations",     "MSFT_physics",             "EXT_instance_features"};
    static const char *const of_files[] = {
        "KHR_animation_pointer", "EXT_lights_image_based", "KHR_interactivity",
        "EXT_gaussian",          "KHR_gaussian_splatting", "AGI_stk_metadata",        "FB_geometry_metadata",
        "MPEG_media",            "VRMC_vrm",               "CESIUM_primitive_outline", "GRIFFEL_bim_data",
        "EXT_primitive_voxels",  "EXT_texture_avif",       "SEIN_node_proxy"};
    char rest[2048], warning[160];
#define EACH(names, format)                                                                                           \
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {                                                       \
        begin_quad();                                                                                                 \
        snprintf(rest, sizeof rest, format, names[i]);                                                                \
        snprintf(warning, sizeof warning, "1 times %s, which is not supported", names[i]);                            \
        import_warned(finish_quad("", ",\"material\":0", rest), warning);                                             \
    }
    EACH(of_materials, ",\"materials\":[{\"extensions\":{\"%s\":{}}}]")
    EACH(of_nodes, ",\"materials\":[{}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1},"
                   "\"extensions\":{\"%s\":{}}}]")
    EACH(of_files, ",\"materials\":[{}],\"extensions\":{\"%s\":{}}")
    static const struct {
        const char *attributes, *materials, *warning;
    } properties[] = {
        {",\"COLOR_1\":%d", "{}", "COLOR_1, which is not supported"},
        {",\"_BATCHID\":%d", "{}", "_BATCHID, which is not supported"},
        {"", "{\"extensions\":{\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.5,\"anisotropyTexture\":{\"index\":0}}}}",
         "1 materials have a \"anisotropyTexture\", which is not supported"},
        {"", "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":{"
             "\"thicknessFactor\":1,\"attenuationDistance\":1,\"thicknessTexture\":{\"index\":0}}},"
             "\"pbrMetallicRoughness\":{\"metallicFactor\":0}}",
         "1 materials have a \"thicknessTexture\", which is not supported"},
        {"", "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":{"
             "\"thicknessFactor\":1}},\"pbrMetallicRoughness\":{\"metallicFactor\":0.5}}",
         "1 materials have a thickness and a metallic factor: they do not refract"},
        {"", "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":{"
             "\"thicknessFactor\":1},\"KHR_materials_ior\":{\"ior\":2000}},\"pbrMetallicRoughness\":{\"metallicFactor\":0}}",
         "1 materials have a \"ior\" beyond 1 to 1000: clamped"},
        {"", "{\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{}}},{\"pbrMetallicRoughness\":{}}",
         "1 of 2 materials have specular and glossiness"},
    };
    for (size_t i = 0; i < sizeof properties / sizeof *properties; i++) {
        char attributes[64];
        begin_quad();
        snprintf(attributes, sizeof attributes, properties[i].attributes, quad_positions);
        snprintf(rest, sizeof rest, ",\"materials\":[%s]", properties[i].materials);
        import_warned(finish_quad(attributes, ",\"material\":0", rest), properties[i].warning);
    }
}

/* PLY and OBJ have vertex colours too, encoded in sRGB. */
static void colours_of_vertices_in_other_formats(void **state) {
    (void)state;
#define PLY(rows) "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n" \
                  "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" rows "3 0 1 2\n"
    const double half = pow((188 / 255.0 + 0.055) / 1.055, 2.4);
    import_quietly(write_text("one.ply", PLY("0 0 0 255 188 0\n1 0 0 255 188 0\n0 1 0 255 188 0\n")));
    assert_near((double)material(0)->base_color[0], 1, 1e-5);
    assert_near((double)material(0)->base_color[1], half, 1e-4);
    assert_near((double)material(0)->base_color[2], 0, 1e-5);
    import_quietly(write_text("many.ply", PLY("0 0 0 255 0 0\n1 0 0 0 188 0\n0 1 0 0 0 255\n")));
    assert_near((double)material(0)->base_color[1], 1, 0);
    assert_int_equal(masu_bake_attributes_of(&piece, vertex_at(0, 0, 0, 0)).color, 0xFF0000FF);
    assert_int_equal(masu_bake_attributes_of(&piece, vertex_at(1, 0, 0, 0)).color, 0xFF000000 | (uint32_t)(sqrt(half) * 255 + 0.5) << 8);
    import_quietly(write_text("two.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 5 0 0 0 0 1\nv 6 0 0 0 0 1\nv 5 1 0 0 0 1\nf 1 2 3\nf 4 5 6\n"));
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_PRIMITIVES), 2);
    assert_near((double)material(0)->base_color[0] + (double)material(1)->base_color[0], 1, 1e-5);
    assert_near((double)material(0)->base_color[2] + (double)material(1)->base_color[2], 1, 1e-5);
}

static void variants_by_name(void **state) {
    (void)state;
    const char *rest = ",\"extensions\":{\"KHR_materials_variants\":{\"variants\":[{\"name\":\"day\"},{\"name\":\"night\"}]}},"
                       "\"materials\":[{\"pbrMetallicRoughness\":{\"roughnessFactor\":0.25}},{\"pbrMetallicRoughness\":{\"roughnessFactor\":0.75}}]";
    const char *mapped = ",\"material\":0,\"extensions\":{\"KHR_materials_variants\":{\"mappings\":[{\"material\":1,\"variants\":[1]}]}}";
    begin_quad();
    const char *path = finish_quad("", mapped, rest);
    import_quietly(path);
    assert_near((double)material(0)->roughness, 0.25, 0);
    import_as(path, (masu_bake_wanted){.variant = "night"});
    assert_string_equal(heard, "");
    assert_near((double)material(0)->roughness, 0.75, 0);
    refused(path, "dusk", "it has no variant \"dusk\"; available: \"day\", \"night\"");
}

static void lights_in_candela(void **state) {
    (void)state;
    begin_quad();
    import_quietly(finish("\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"color\":[1,0.5,0],\"intensity\":10,\"range\":7,"
                          "\"spot\":{\"outerConeAngle\":0.5,\"innerConeAngle\":0.25}}]}},"
                          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],"
                          "\"nodes\":[{\"mesh\":0},{\"name\":\"lamp\",\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]",
                          quad_positions, quad_indices));
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_LIGHTS), 1);
    const masu_blob_light *l = MASU_BAKE_LIGHTS(&piece);
    assert_int_equal(l->type, MASU_LIGHT_SPOT);
    assert_near((double)l->color[0], 10 / 3.14159265, 1e-5);
    assert_near((double)l->range, 7, 0);
    assert_near((double)l->outer, 0.5, 0);
    assert_near((double)l->position[1], 2, 0);
    assert_near((double)l->direction[2], -1, 1e-6);
}

/* ---- Skins and clips ------------------------------------------------------------------------- */

static void skins_rest_as_their_joints_have_them(void **state) {
    (void)state;
    static const float moves[9] = {0, 0, 0, 3, 0, 0, 3, 4, 0};
    const char *path = skinned("STEP", moves, 3);
    import_warned(path, "this one has its rest pose");
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_SKINS), 0);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_KEYS), 0);
    vertex_at(2, 0, 0, 1e-6); /* the mesh's node does not move it */
    vertex_at(7, 1, 0, 1e-6);
    import_as(path, (masu_bake_wanted){.moving = true});
    assert_string_equal(heard, "");
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_SKINS), 1);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_CLIPS), 1);
    assert_int_equal(masu_bake_count(&piece, MASU_BLOB_KEYS), 5); /* steps: two keys each */
    const masu_blob_key *k = MASU_BAKE_ARRAY(&piece, MASU_BLOB_KEYS, masu_blob_key);
    assert_near((double)k[1].value[0], 0, 0);
    assert_true(k[1].time < 1 && k[1].time > 0.999f);
    assert_near((double)k[2].time, 1, 0);
    assert_near((double)k[2].value[0], 3, 0);
}

static void cubic_keys_are_cut_into_lines(void **state) {
    (void)state;
    /* In-tangent, value and out-tangent of each key. */
    static const float moves[27] = {0, 0, 0, 0, 0, 0, 6, 0, 0, 0, 0, 0, 2, 0, 0, 0, 5, 0, -4, 0, 0, 0, 1, 0, 0, 0, 0};
    import_as(skinned("CUBICSPLINE", moves, 9), (masu_bake_wanted){.moving = true});
    const masu_blob_key *k = MASU_BAKE_ARRAY(&piece, MASU_BLOB_KEYS, masu_blob_key);
    uint64_t count = masu_bake_count(&piece, MASU_BLOB_KEYS);
    assert_true(count > 10 && count < 200);
    for (int i = 0; i <= 1000; i++) {
        double t = i / 500.0, s = t - (t >= 1 ? 1 : 0), want[2];
        const float *at = moves + (t >= 1 ? 9 : 0);
        uint64_t n = 1;
        while (n < count - 1 && (double)k[n].time < t) n++;
        double share = (t - (double)k[n - 1].time) / ((double)k[n].time - (double)k[n - 1].time);
        for (int c = 0; c < 2; c++) {
            want[c] = (2 * s * s * s - 3 * s * s + 1) * (double)at[3 + c] + (s * s * s - 2 * s * s + s) * (double)at[6 + c] +
                      (3 * s * s - 2 * s * s * s) * (double)at[12 + c] + (s * s * s - s * s) * (double)at[9 + c];
            assert_near((double)k[n - 1].value[c] * (1 - share) + (double)k[n].value[c] * share, want[c], 2 * 2e-3);
        }
    }
}

/* Several keys at one time are a step: the last one holds from that time on. */
static void repeated_key_times_are_steps(void **state) {
    (void)state;
    static const float moves[18] = {0, 0, 0, 2, 0, 0, 9, 9, 9, 4, 0, 0, 6, 0, 0, 8, 0, 0};
    static const float times[6] = {0, 1, 1, 1, 2, 2};
    static const char *const how[] = {"LINEAR", "STEP"};
    for (int i = 0; i < 2; i++) {
        begin_quad();
        int t = floats(times, "SCALAR", 6, 1), m = floats(moves, "VEC3", 6, 3);
        import_as(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],\"nodes\":[{\"mesh\":0}],"
                         "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
                         "\"samplers\":[{\"input\":%d,\"output\":%d,\"interpolation\":\"%s\"}]}]",
                         quad_positions, quad_indices, t, m, how[i]),
                  (masu_bake_wanted){.moving = true});
        assert_string_equal(heard, "");
        const masu_blob_key *k = MASU_BAKE_ARRAY(&piece, MASU_BLOB_KEYS, masu_blob_key);
        uint64_t count = masu_bake_count(&piece, MASU_BLOB_KEYS);
        assert_int_equal(count, 5);
        assert_true(k[1].time < 1 && k[1].time > 0.999f);
        assert_near((double)k[1].value[0], i ? 0 : 2, 0);
        assert_near((double)k[2].time, 1, 0);
        assert_near((double)k[2].value[0], 4, 0);
        assert_near((double)k[count - 1].time, 2, 0);
        assert_near((double)k[count - 1].value[0], 8, 0);
    }
}

/* ---- Files of exporters ---------------------------------------------------------------------- */

#define TRIANGLE                                                                                                       \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"          \
    "\"type\":\"VEC3\",\"count\":3}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"                  \
    "\"nodes\":[{\"mesh\":0}]}"

static const float corner[9] = {0, 0, 0, 5, 0, 0, 0, 5, 0};

static const char *triangle_of(const char *uri) {
    char text[2048];
    int wrote = snprintf(text, sizeof text, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"%s\",\"byteLength\":36}]," TRIANGLE, uri);
    assert_true(wrote > 0 && (size_t)wrote < sizeof text);
    return write_text("x.gltf", text);
}

/* Nodes outside the scene's hierarchy are ignored (UniGLTF writes such nodes). */
static void nodes_outside_of_the_scene_are_ignored(void **state) {
    (void)state;
    static const char *const graphs[] = {
        "\"nodes\":[{\"children\":[1],\"translation\":[100,0,0]},{\"mesh\":0,\"translation\":[3,0,0]}],\"scenes\":[{\"nodes\":[1]}]",
        "\"nodes\":[{\"children\":[1,1]},{\"mesh\":0,\"translation\":[3,0,0]},{\"children\":[1]}],\"scenes\":[{\"nodes\":[1]}]",
        "\"nodes\":[{\"children\":[0]},{\"mesh\":0,\"translation\":[3,0,0]}],\"scenes\":[{\"nodes\":[1]}]",
    };
    for (size_t i = 0; i < sizeof graphs / sizeof *graphs; i++) {
        begin_quad();
        import_quietly(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],%s", quad_positions,
                              quad_indices, graphs[i]));
        assert_int_equal(masu_bake_count(&piece, MASU_BLOB_INSTANCES), 1);
        assert_near((double)MASU_BAKE_INSTANCES(&piece)[0].transform[3], 3, 0);
    }
    begin_quad();
    import_warned(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}],"
                         "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"name\":\"spare\"}],\"scenes\":[{\"nodes\":[0]}]",
                         quad_positions, quad_indices),
                  "1 nodes with meshes are not in the scene: left out (first: spare)");
}

static void data_uris_of_all_forms(void **state) {
    (void)state;
    static const char *const heads[] = {"data:,",
                                        "data:application/octet-stream,",
                                        "DATA:application/gltf-buffer;charset=UTF-8,",
                                        "data:;base64,",
                                        "data:application/octet-stream;charset=utf-8;base64,",
                                        "Data:application/octet-stream;BASE64,"};
    static const char base64[] = "AAAAAAAAAAAAAAAAAACgQAAAAAAAAAAAAAAAAAAAoEAAAAAA";
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        char uri[512] = "";
        add(uri, sizeof uri, "%s", heads[i]);
        /* Letters unchanged, everything else in hexadecimal. */
        for (size_t k = 0; i < 3 && k < sizeof corner; k++) {
            unsigned char c = ((const unsigned char *)corner)[k];
            add(uri, sizeof uri, c >= 'A' && c <= 'Z' ? "%c" : k & 1 ? "%%%02x" : "%%%02X", c);
        }
        if (i == 3) add(uri, sizeof uri, "%s", base64);
        /* One letter in hexadecimal, too. */
        if (i == 4) add(uri, sizeof uri, "%.10s%%41%s", base64, base64 + 11);
        if (i == 5) add(uri, sizeof uri, "%.24s\\r\\n%s", base64, base64 + 24);
        import_quietly(triangle_of(uri));
        vertex_at(5, 0, 0, 0);
        vertex_at(0, 5, 0, 0);
    }
    refused(triangle_of("data:nothing"), NULL, "a data: URI without a comma");
    refused(triangle_of("data:;base64,AAAA!"), NULL, "a data: URI with a '!'");
    refused(triangle_of("data:,%00%0"), NULL, "\"byteLength\" is 36, and there are 3 bytes");
}

static void files_named_on_other_machines(void **state) {
    (void)state;
    static const char *const uris[] = {"a%20B.bin",
                                       "A b.BIN",
                                       ".\\\\A%20b.BIN",
                                       "C:\\\\models\\\\a B.bin",
                                       "c:/models/A B.bin",
                                       "file:///C:/models/a%20B.bin",
                                       "/home/somebody/a B.bin"};
    write_bytes("a B.bin", corner, sizeof corner);
    for (size_t i = 0; i < sizeof uris / sizeof *uris; i++) {
        import_quietly(triangle_of(uris[i]));
        vertex_at(0, 5, 0, 0);
    }
    refused(triangle_of("D:\\\\gone.bin"), NULL, "there is no file");
}

static void older_versions_are_refused(void **state) {
    (void)state;
    static const char *const texts[] = {"{\"asset\":{\"version\":\"1.0\"},\"meshes\":{}}", "{\"asset\":{\"version\":1.1},\"meshes\":{}}",
                                        "{\"meshes\":{},\"scenes\":{}}"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) refused(write_text("x.gltf", texts[i]), NULL, "glTF 1");
    static const uint32_t head[5] = {0x46546C67, 1, 22, 2, 0};
    refused(write_bytes("x.glb", head, sizeof head), NULL, "glTF 1");
}

/* Beyond the limit, as NaN: 0 in both axes. The others are moved by whole periods around the middle of their range. */
static void coordinates_that_cannot_be_used_are_0(void **state) {
    (void)state;
    const float most = 16384, beyond = nextafterf(most, INFINITY);
    const float bad[][2] = {{beyond, 0.5f}, {0.5f, -beyond}, {NAN, 0.5f}, {0.5f, INFINITY}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const float uv[8] = {0.25f, 0.5f, most, 0.5f, bad[i][0], bad[i][1], 0.25f, -most};
        begin_quad();
        char attributes[64];
        snprintf(attributes, sizeof attributes, ",\"TEXCOORD_0\":%d", floats(uv, "VEC2", 4, 2));
        import_warned(finish_textured(attributes, "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}"),
                      "texture coordinates set to 0");
        const float *a = texcoord_at(0, 0), *b = texcoord_at(2, 0), *lost = texcoord_at(2, 1), *c = texcoord_at(0, 1);
        assert_true(lost[0] == 0 && lost[1] == 0);
        assert_true(b[0] - a[0] == most - 0.25f && a[1] - c[1] == most + 0.5f && b[1] == a[1] && c[0] == a[0]);
    }
}

/* Coordinates of a repeated texture stay if they are from -2 to 3, of a clamped one always. */
static void coordinates_near_0_are_not_moved(void **state) {
    (void)state;
    const float rows[][3] = {{-2, 0, 0}, {nextafterf(-2, -3), 0, -1}, {1, 3, 0}, {1, nextafterf(3, 4), 2}};
    for (size_t i = 0; i < 8; i++) {
        const float *row = rows[i % 4], shift = i < 4 ? row[2] : 0;
        const float uv[8] = {row[0], 0, row[1], 0, row[1], 1, row[0], 1};
        begin_quad();
        char attributes[64], rest[512];
        snprintf(attributes, sizeof attributes, ",\"TEXCOORD_0\":%d", floats(uv, "VEC2", 4, 2));
        snprintf(rest, sizeof rest,
                 ",\"images\":[{\"bufferView\":%d,\"mimeType\":\"image/webp\"}],\"samplers\":[{\"wrapS\":%d}],"
                 "\"textures\":[{\"sampler\":0,\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}}],"
                 "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}]",
                 view(webp, sizeof webp, 0), i < 4 ? 10497 : 33071);
        import_quietly(finish_quad(attributes, ",\"material\":0", rest));
        assert_true(texcoord_at(0, 0)[0] == row[0] - shift && texcoord_at(2, 0)[0] == row[1] - shift);
        assert_true(texcoord_at(2, 1)[1] == 1);
    }
}

/* Control characters and bytes that are not UTF-8 become '?'; of each form its first and its last character stay. */
static void names_are_utf8(void **state) {
    (void)state;
    static const char *const names[][2] = {
        {" a~", " a~"},
        {"a\x1f\x7f", "a??"},
        {"\xc2\x80\xdf\xbf", NULL},
        {"\x80|\xc1\xbf", "?|??"},
        {"\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xef\xbf\xbf", NULL},
        {"\xe0\x9f\xbf|\xed\xa0\x80|\xed\xbf\xbf", "???|???|???"},
        {"\xf0\x90\x80\x80\xf4\x8f\xbf\xbf", NULL},
        {"\xf0\x8f\xbf\xbf|\xf4\x90\x80\x80|\xf8\x88\x80\x80\x80", "????|????|?????"},
        {"a\xc3", "a?"},
        {"\xe2\x82|\xe2\x82\xac", "??|\xe2\x82\xac"},
    };
    masu_bake_content content = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        uint32_t at = masu_bake_name(&content, names[i][0], strlen(names[i][0]));
        assert_string_equal(masu_bake_name_text(&content, at), names[i][names[i][1] ? 1 : 0]);
    }
    char full[MASU_BLOB_NAME_MAX + 2];
    memset(full, 'a', sizeof full - 1);
    full[sizeof full - 1] = 0;
    uint32_t at = masu_bake_name(&content, full, MASU_BLOB_NAME_MAX);
    assert_true(strlen(masu_bake_name_text(&content, at)) == MASU_BLOB_NAME_MAX && !content.names_cut);
    at = masu_bake_name(&content, full, MASU_BLOB_NAME_MAX + 1);
    assert_true(strlen(masu_bake_name_text(&content, at)) == MASU_BLOB_NAME_MAX && content.names_cut == 1);
    memcpy(full + MASU_BLOB_NAME_MAX - 1, "\xc3\xa9", 2); /* cut before the character, not within it */
    at = masu_bake_name(&content, full, MASU_BLOB_NAME_MAX + 1);
    assert_true(strlen(masu_bake_name_text(&content, at)) == MASU_BLOB_NAME_MAX - 1 && content.names_cut == 2);
    assert_int_equal(masu_bake_name(&content, "", 0), MASU_BLOB_NONE);
    masu_bake_content_release(&content);
}

/* ---- Invalid files --------------------------------------------------------------------------- */

static void names_with_percent_signs(void **state) {
    (void)state;
    const float p[9] = {0, 0, 0, 5, 0, 0, 0, 5, 0};
    write_bytes("a b.bin", p, sizeof p);
    import_quietly(write_text("x.gltf", "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"a%20b.bin\",\"byteLength\":36}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
                                        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3}],"
                                        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]}"));
    vertex_at(0, 5, 0, 0);
    refused(write_text("x.gltf", "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"c%20d.bin\",\"byteLength\":36}]}"), NULL, "there is no file");
    refused(write_text("x.gltf", "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"http://x/y.bin\",\"byteLength\":36}]}"), NULL, "is not a file in the model's folder");
}

static void what_a_file_requires(void **state) {
    (void)state;
    begin_quad();
    refused(finish_quad("", "", ",\"extensionsRequired\":[\"EXT_from_tomorrow\"]"), NULL, "it requires EXT_from_tomorrow, which is not supported");
}

static void hostile_files_are_refused(void **state) {
    (void)state;
    begin();
    accessor(view(corners, 24, 0), FLOAT, "VEC3", 4, "");
    const char *mesh = "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]";
    refused(finish("%s", mesh), NULL, "4 elements of 12 bytes, 12 apart, from byte 0 on: bufferViews[0] has 24 bytes");
    begin();
    accessor(view(corners, 48, 0), FLOAT, "VEC3", 4, ",\"byteOffset\":9007199254740992");
    refused(finish("%s", mesh), NULL, "bufferViews[0] has 48 bytes");
    begin();
    accessor(-1, FLOAT, "VEC3", 2147483647, "");
    refused(finish("%s", mesh), NULL, "accessors[0] has 2147483647 elements and no bufferView");
    begin();
    accessor(view(corners, 48, 0), FLOAT, "VEC3", 4, ",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5125,\"byteOffset\":12},\"values\":{\"bufferView\":0}}");
    refused(finish("%s", mesh), NULL, "\"sparse\" changes element 1073741824 of 4");
    begin_quad();
    refused(finish("\"nodes\":[{\"children\":[1]},{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]"), NULL, "nodes[0] is twice in the scene");
    refused(finish("\"nodes\":[{\"children\":[1,1]},{}]"), NULL, "nodes[1] is twice in the scene");
    refused(finish("\"nodes\":[{\"mesh\":3}]"), NULL, "nodes[0]: \"mesh\": index 3 of 0 elements");
    refused(finish("\"nodes\":[{}],\"skins\":[{\"joints\":[-1]}]"), NULL, "joints[0] is not a node");
    size_t bytes;
    char *whole = read_file(finish("\"nodes\":[]"), &bytes);
    for (size_t cut = 1; cut < bytes; cut += 7) refused(write_bytes("x.glb", whole, cut), NULL, "");
    free(whole);
}

static int clean(void **state) {
    masu_bake_content_release(&piece);
    return remove_scratch(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantized_positions_and_normals),
        cmocka_unit_test(indices_of_all_types_strips_and_fans),
        cmocka_unit_test(sparse_accessors_change_some_elements),
        cmocka_unit_test(a_sparse_index_is_below_the_count),
        cmocka_unit_test(morph_weights_of_the_node_rest),
        cmocka_unit_test(morph_targets_are_kept_to_move),
        cmocka_unit_test(instances_of_a_node),
        cmocka_unit_test(meshopt_unpacks),
        cmocka_unit_test(draco_unpacks),
        cmocka_unit_test(coordinates_are_of_the_set_and_turned),
        cmocka_unit_test(coordinates_that_cannot_be_used_are_0),
        cmocka_unit_test(coordinates_near_0_are_not_moved),
        cmocka_unit_test(names_are_utf8),
        cmocka_unit_test(maps_of_other_coordinates_are_told),
        cmocka_unit_test(coats_have_pictures_of_their_own),
        cmocka_unit_test(colours_of_vertices_become_materials),
        cmocka_unit_test(factors_of_materials),
        cmocka_unit_test(what_is_not_read_is_told),
        cmocka_unit_test(without_its_map_a_material_has_its_factor),
        cmocka_unit_test(occlusion_has_a_strength),
        cmocka_unit_test(textures_that_are_shown_once_are_clamped),
        cmocka_unit_test(clamped_and_simplified_values_are_told),
        cmocka_unit_test(reflectance_is_of_any_colour_and_strength),
        cmocka_unit_test(nothing_is_dropped_in_silence),
        cmocka_unit_test(colours_of_vertices_in_other_formats),
        cmocka_unit_test(variants_by_name),
        cmocka_unit_test(lights_in_candela),
        cmocka_unit_test(skins_rest_as_their_joints_have_them),
        cmocka_unit_test(cubic_keys_are_cut_into_lines),
        cmocka_unit_test(repeated_key_times_are_steps),
        cmocka_unit_test(nodes_outside_of_the_scene_are_ignored),
        cmocka_unit_test(data_uris_of_all_forms),
        cmocka_unit_test(files_named_on_other_machines),
        cmocka_unit_test(older_versions_are_refused),
        cmocka_unit_test(names_with_percent_signs),
        cmocka_unit_test(what_a_file_requires),
        cmocka_unit_test(hostile_files_are_refused),
    };
    return cmocka_run_group_tests(tests, make_scratch, clean);
}
