/* blob.c: see blob.h. */
#include "support/blob.h"
#include "scene/code.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Offsets into `names`: */
enum {
    NAME_PLATE = 0,
    NAME_LID = 6,
    NAME_STEEL = 10,
    NAME_GLOW = 16,
    NAME_RADIUS = 21,
    NAME_BEND = 28
};
static const char names[] = "plate\0lid\0steel\0glow\0radius\0bend";

static const masu_blob_vertex vertices[] = {
    {{-1.0f, 0.0f, -1.0f}, {0, 32767}}, {{1.0f, 0.0f, -1.0f}, {0, 32767}},
    {{1.0f, 0.0f, 1.0f}, {0, 32767}},   {{-1.0f, 0.0f, 1.0f}, {0, 32767}},
    {{0.0f, 1.0f, 0.0f}, {32767, 0}},   {{0.0f, 2.0f, 0.0f}, {32767, 0}},
    {{0.0f, 1.0f, 1.0f}, {32767, 0}},   {{-2.0f, -2.0f, 0.0f}, {0, 0}},
    {{2.0f, -2.0f, 0.0f}, {0, 0}},      {{2.0f, 2.0f, 0.0f}, {0, 0}},
    {{-2.0f, 2.0f, 0.0f}, {0, 0}},
};

/* The last three are for SUPPORT_DETAIL. */
static const uint32_t indices[] = {0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 1, 2, 0, 2, 3, 0, 1, 2};

static const masu_blob_primitive primitives[] = {
    {0, 6, 0, 4, 0, {-1.0f, 0.0f, -1.0f}, {1.0f, 0.0f, 1.0f}, 0},
    {6, 3, 4, 3, 1, {0.0f, 1.0f, 0.0f}, {0.0f, 2.0f, 1.0f}, 0},
    {9, 6, 7, 4, 0, {-2.0f, -2.0f, 0.0f}, {2.0f, 2.0f, 0.0f}, 0},
    {15, 3, 7, 4, 0, {-2.0f, -2.0f, 0.0f}, {2.0f, 2.0f, 0.0f}, 0},
};

static const masu_blob_lod lods[] = {{1, 3, 2.5f, 0}};

static const masu_blob_mesh meshes[] = {
    {0, 2, {-1.0f, 0.0f, -1.0f}, {1.0f, 2.0f, 1.0f}, NAME_PLATE, 0},
    {2, 1, {-2.0f, -2.0f, 0.0f}, {2.0f, 2.0f, 0.0f}, NAME_LID, 0},
};

static const masu_blob_instance instances[] = {
    {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, NAME_PLATE, MASU_BLOB_NONE, 0},
    {{1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, -4}, 0, MASU_BLOB_NONE, 0, 1},
    {{0, 0, 1, 0, 0, 1, 0, 5, -1, 0, 0, 0}, 1, NAME_LID, 0, MASU_BLOB_NONE},
};

static const masu_blob_group groups[] = {
    {{0, 0, 0}, {16, 16, 16}, 1, 1, 0, 1, MASU_BLOB_NONE, 0},
    {{3, 1, -4}, {8, 8, 8}, 0, 0, 1, 1, NAME_PLATE, 0},
};

static const uint32_t group_items[] = {0, 1};

static const masu_blob_occluder occluders[] = {
    {{-0.5f, 0.25f, -0.5f}, {0.5f, 1.0f, 0.5f}, 0, 0},
    {{-1.0f, -1.0f, 0.0f}, {1.0f, 2.0f, 0.0f}, 1, 0},
};

static const masu_blob_material materials[] = {
    {.base_color = {0.5f, 0.25f, 1.0f},
     .roughness = 0.4f,
     .metallic = 0.9f,
     .name = NAME_STEEL,
     .specular = 0.5f,
     .opacity = 1.0f,
     .meso = MASU_BLOB_NONE,
     .detail = {1.0f, 1.0f}},
    {.roughness = 1.0f,
     .emissive = {4.0f, 2.0f, 1.0f},
     .name = NAME_GLOW,
     .specular = 0.5f,
     .opacity = 1.0f,
     .meso = MASU_BLOB_NONE,
     .detail = {1.0f, 1.0f}},
};

static const masu_blob_camera_key camera_keys[] = {
    {0.0f, {0.0f, 1.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, 0.8f},
    {1.5f, {5.0f, 1.0f, 0.0f}, {0.0f, 0.5f, 0.0f}, 0.9f},
    {4.0f, {0.0f, 1.0f, -5.0f}, {0.0f, 0.0f, 1.0f}, 1.0f},
};

static const masu_blob_environment environment[] = {{
    .sun_direction = {0.6f, 0.8f, 0.0f},
    .exposure = 1.5f,
    .sun_color = {2.0f, 1.5f, 1.0f},
    .near_distance = 0.05f,
    .ambient = {0.1f, 0.2f, 0.3f},
    .sky_zenith = {0.1f, 0.2f, 0.8f},
    .sky_horizon = {1.0f, 0.7f, 0.4f},
}};

static const masu_blob_shadow shadow[] = {{2, 64, 50.0f, 0.5f}};

static const masu_blob_sdf_param sdf_params[] = {
    {0.5f, 0.0f, 2.0f, NAME_RADIUS},
    {-1.0f, -1.0f, 1.0f, NAME_BEND},
};

static const masu_blob_material mapped[] = {
    {.base_color = {0.5f, 0.25f, 1.0f},
     .roughness = 0.4f,
     .metallic = 0.9f,
     .name = NAME_STEEL,
     .flags =
         7 | MASU_MATERIAL_HAS_METAL | MASU_MATERIAL_IS_MASK | 128 << MASU_MATERIAL_CUTOFF_SHIFT,
     .layers = 1,
     .specular = 0.5f,
     .opacity = 1.0f,
     .meso = MASU_BLOB_NONE,
     .detail = {1.0f, 1.0f}},
    {.roughness = 1.0f,
     .emissive = {4.0f, 2.0f, 1.0f},
     .name = NAME_GLOW,
     .flags = 8 | MASU_MATERIAL_IS_BLEND,
     .texture_set = 1,
     .specular = 0.5f,
     .opacity = 1.0f,
     .meso = MASU_BLOB_NONE,
     .detail = {1.0f, 1.0f}},
};

static const float texcoords[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {-3.5f, 2},   {0.5f, 0.5f},
                                     {7, 7}, {0, 0}, {4, 0}, {4, 4}, {0, 32768.0f}};

static const uint32_t colors[] = {
    0xFF0000FF, 0xFF00FF00, MASU_BLOB_WHITE, 0x80FF0000, 0, 1, 2, 3, 4, 5, 6};

static const masu_blob_texture textures[] = {
    {MASU_TEXTURE_BC3_SRGB, 8, 8, 4, 2, NAME_PLATE, 0},
    {MASU_TEXTURE_BC5, 6, 3, 3, 1, MASU_BLOB_NONE, 224},
    {MASU_TEXTURE_BC1_SRGB, 4, 4, 1, 1, NAME_LID, 288},
};

static const masu_blob_texture_set texture_sets[] = {
    {{0, 1, 1, MASU_BLOB_NONE, MASU_BLOB_NONE, MASU_BLOB_NONE}, {0, 2}},
    {{MASU_BLOB_NONE, MASU_BLOB_NONE, MASU_BLOB_NONE, 2, MASU_BLOB_NONE, MASU_BLOB_NONE}, {1, 1}},
};

/* 7 blocks of 16 bytes twice, 2 + 1 + 1 of 16, 1 of 8, and padding. */
static const unsigned char texels[19][16] = {{1, 2, 3}, {0xFF, 0, 0x5A}};

static const masu_blob_meso meso[] = {
    {.tilt = {0.5f, 0.0f, -0.25f}, .facet = 0.5f, .occlusion = {1.0f, 0.5f, 0.0f}, .alpha = 1.5f,
     .offset = 1.0f, .specular = {1.0f, 0.0f, 0.0f}}};

static const masu_blob_light lights[] = {
    {.position = {1.0f, 2.0f, 3.0f},
     .range = 8.0f,
     .color = {1.0f, 0.5f, 0.25f},
     .radius = 0.1f,
     .type = MASU_LIGHT_POINT,
     .parent = MASU_BLOB_NONE,
     .name = NAME_GLOW},
    {.position = {0.0f, 1.0f, 0.0f},
     .range = 20.0f,
     .color = {2.0f, 2.0f, 2.0f},
     .radius = 0.05f,
     .direction = {0.0f, 0.0f, -1.0f},
     .type = MASU_LIGHT_SPOT,
     .inner = 0.4f,
     .outer = 0.8f,
     .parent = 1,
     .name = MASU_BLOB_NONE}};

static const masu_blob_probes probes[] = {{.origin = {-1.0f, 0.0f, 0.0f},
                                           .bias = 0.5f,
                                           .spacing = {2.0f, 2.0f, 2.0f},
                                           .counts = {2, 1, 1},
                                           .sky_sets = 1,
                                           .suns = 1,
                                           .visibility = 1,
                                           .sun_direction = {{0.0f, 1.0f, 0.0f, 0.0f}},
                                           .sun_inverse = {{1.0f}}}};

/* Two sets, and a map of 3 x 3 for each. */
static const uint32_t probe_data[2 * (2 * MASU_PROBE_WORDS + 9)] = {0x3C003800u, 0x80000001u};

static const masu_blob_environment_map environment_map[] = {
    {8, 2, {0}, {{0.5f, 0.5f, 1.0f, 0.0f}, {0.1f, -0.1f, 0.0f, 0.0f}}}};

static const uint32_t environment_texels[64 + 16] = {0x80000001u, 0xFFFFFFFFu};

#define NODE_SCALE (128u | 128u << 8 | 128u << 16)

static const masu_blob_trace_node trace_nodes[] = {
    {{-1, 0, -1}, NODE_SCALE | 1u << 24 | 2u << 26, {0, 0, 0}, {0x0101, 0x0101, 0x0101}, 1, 0},
    {{-1, 0, -1}, NODE_SCALE | 3u << 24, {0, 0, 0}, {1, 1, 1}, 2, 1},
    {{-2, -2, 0}, NODE_SCALE | 2u << 24, {0, 0, 0}, {2, 2, 1}, 3, 3},
};

static const masu_blob_trace_triangle trace_triangles[] = {
    {{0, 1, 2}, 0}, {{4, 5, 6}, 1}, {{0, 2, 3}, 0}, {{7, 8, 9}, 2}};

static const masu_blob_trace_mesh trace_meshes[] = {{0, 2, 0, 3, 2, 0}, {2, 1, 3, 1, 1, 0}};

static const masu_blob_reflections reflections[] = {{0.5f, 100.0f, 0.25f, 0}};
static const uint32_t trace_instances[] = {1, 2};

/* Two by one texels and one, with their mips. */
static const masu_blob_trace_texture trace_textures[] = {{0, 0, 2, 1, 0, 0}, {2, 0, 1, 1, 3, 0}};
static const uint32_t trace_texels[4] = {0xFF204060u, 0xFF806040u, 0xFF505050u, 0xFFFFFFFFu};

static const masu_blob_model models[] = {
    {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1, NAME_PLATE, 0, 0, {0}},
    {{1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, -4}, 1, 1, MASU_BLOB_NONE, MASU_MODEL_HIDDEN, 0, {0}},
    {{1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1, 0}, 2, 2, NAME_LID, 0, 2, {0}},
};

static const masu_blob_model_node model_nodes[] = {
    {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, MASU_BLOB_NONE, 0, NAME_PLATE, 0},
    {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, MASU_BLOB_NONE, 1, MASU_BLOB_NONE, 0},
    {{0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0}, MASU_BLOB_NONE, MASU_BLOB_NONE, NAME_BEND, 0},
    {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 2, 2, NAME_LID, 0},
};

/* The square of mesh 1, skinned to "bend", which is rotated, and to its child "lid". */
static const masu_blob_skin skins[] = {{2, 3, 0, 7, 4, 0, 0, 2, 0, 0, 0, 0}};

/* With SUPPORT_MORPH: "up" lifts the square; "wide" pulls two corners apart, with a default weight
 * of one half. */
static const masu_blob_morph_target morph_targets[] = {
    {{0, 0, 0}, {0, 1, 0}, 0.0f, NAME_BEND},
    {{-1, 0, 0}, {1, 0, 0}, 0.5f, NAME_GLOW},
};

static const masu_blob_morph_delta morph_deltas[] = {
    {{0, 1, 0}, 0}, {{0, 1, 0}, 0}, {{0, 1, 0}, 0}, {{0, 1, 0}, 0},
    {{0, 0, 0}, 0}, {{0, 0, 0}, 0}, {{1, 0, 0}, 0}, {{-1, 0, 0}, 0x2FF},
};

static const masu_blob_joint joints[] = {
    {{1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1, 0}, {-2, -2, 0}, {2, -2, 0}, 0, 1},
    {{0, 0, -1, 0, 0, 1, 0, -2, 1, 0, 0, 0}, {-2, -2, 0}, {2, 2, 0}, 1, 1},
};

static const masu_blob_skin_vertex skin_vertices[] = {
    {{{-2.0f, -2.0f, 0.0f}, {0, 0}}, {0, 1, 0, 0}, {65000, 535, 0, 0}},
    {{{2.0f, -2.0f, 0.0f}, {0, 0}}, {0, 1, 0, 0}, {65000, 535, 0, 0}},
    {{{2.0f, 2.0f, 0.0f}, {0, 0}}, {1, 0, 0, 0}, {65535, 0, 0, 0}},
    {{{-2.0f, 2.0f, 0.0f}, {0, 0}}, {1, 0, 0, 0}, {65535, 0, 0, 0}},
};

/* Clips of the last model: "bend" moves both and rotates "lid"; "glow" enlarges it in one step. */
static const masu_blob_clip clips[] = {{2, 0, 2, 2.0f, NAME_BEND, {0}},
                                       {2, 2, 1, 0.5f, NAME_GLOW, {0}}};

static const masu_blob_channel channels[] = {
    {0, MASU_CHANNEL_TRANSLATION, 0, 0, 2, 0, {0}},
    {1, MASU_CHANNEL_ROTATION, 0, 2, 2, 0, {0}},
    {1, MASU_CHANNEL_SCALE, 1, 4, 2, 0, {0}},
};

/* The same, and "bend" raises the weight of the first morph target of the skin at its node. */
static const masu_blob_clip morph_clips[] = {{2, 0, 3, 2.0f, NAME_BEND, {0}},
                                             {2, 3, 1, 0.5f, NAME_GLOW, {0}}};
static const masu_blob_channel morph_channels[] = {
    {0, MASU_CHANNEL_TRANSLATION, 0, 0, 2, 0, {0}},
    {1, MASU_CHANNEL_ROTATION, 0, 2, 2, 0, {0}},
    {1, MASU_CHANNEL_WEIGHT, 0, 4, 2, 0, {0}},
    {1, MASU_CHANNEL_SCALE, 1, 6, 2, 0, {0}},
};
static const masu_blob_key morph_keys[] = {
    {0.0f, {0, 0, 0, 0}}, {2.0f, {4, 0, 2, 0}}, {0.5f, {0, 0, 0, 1}}, {1.5f, {0, 0, 1, 0}},
    {0.0f, {0, 0, 0, 0}}, {2.0f, {1, 0, 0, 0}}, {0.0f, {1, 1, 1, 0}}, {0.25f, {2, 3, 4, 0}},
};

static const masu_blob_key clip_keys[] = {
    {0.0f, {0, 0, 0, 0}}, {2.0f, {4, 0, 2, 0}}, {0.5f, {0, 0, 0, 1}}, {1.5f, {0, 0, 1, 0}},
    {0.0f, {1, 1, 1, 0}}, {0.25f, {2, 3, 4, 0}},
};

static const float slots[] = {0.5f, -1.0f, 2.0f};

static size_t aligned(size_t at) {
    return (at + MASU_BLOB_ALIGN - 1) / MASU_BLOB_ALIGN * MASU_BLOB_ALIGN;
}

static void add(support_blob *blob, enum masu_blob_kind kind, const void *data, size_t stride,
                size_t count) {
    masu_blob_header *header = (masu_blob_header *)(void *)blob->bytes;
    masu_blob_section *row = (masu_blob_section *)(void *)(blob->bytes + sizeof *header);
    size_t at = aligned(blob->size);
    row[header->section_count++] = (masu_blob_section){(uint32_t)kind, (uint32_t)stride, at, count};
    if (at + stride * count > sizeof blob->bytes) {
        fputs("support_blob: SUPPORT_BLOB_ROOM is too small\n", stderr);
        abort();
    }
    memcpy(blob->bytes + at, data, stride * count);
    blob->size = at + stride * count;
}

#define ADD(kind, array) add(blob, kind, array, sizeof *(array), COUNT(array))

static int is_code(uint32_t kind) {
    return kind == MASU_BLOB_MARCH_SPIRV ||
           (kind >= MASU_BLOB_CLASSIFY_SPIRV && kind <= MASU_BLOB_CHECKERBOARD_SPIRV) ||
           (kind >= MASU_BLOB_UPDATE_PREVIOUS_SPIRV && kind <= MASU_BLOB_OCCLUSION_SPIRV) ||
           kind == MASU_BLOB_TRACE_SDF_SPIRV || kind == MASU_BLOB_BOUNCE_SDF_SPIRV ||
           kind == MASU_BLOB_SILHOUETTES_SPIRV || kind == MASU_BLOB_LOCAL_SHADOW_SPIRV;
}

/* The smallest valid module for its pass: main returns. The compilation record is filled in when
 * the blob is complete. */
static void add_code(support_blob *blob, enum masu_blob_kind kind) {
    uint32_t update = kind == MASU_BLOB_UPDATE_SPIRV || kind == MASU_BLOB_UPDATE_PREVIOUS_SPIRV;
    uint32_t columns = update ? 1 : kind == MASU_BLOB_SEED_SPIRV ? 4 : 8;
    const uint32_t head[] = {0x07230203u, 0x00010000u, 0, 5, 0,
                             2u << 16 | 17, 1,    /* OpCapability Shader */
                             3u << 16 | 14, 0, 1, /* OpMemoryModel Logical GLSL450 */
                             5u << 16 | 15, 5, 1, 0x6E69616Du, 0}; /* OpEntryPoint %1 "main" */
    const uint32_t compute[] = {6u << 16 | 16,    1, 17, columns,
                                update ? 1u : 8u, 1};   /* OpExecutionMode LocalSize */
    const uint32_t tail[] = {2u << 16 | 19, 2,          /* %2 = OpTypeVoid */
                             3u << 16 | 33, 3, 2,       /* %3 = OpTypeFunction %2 */
                             5u << 16 | 54, 2, 1, 0, 3, /* %1 = OpFunction %2 None %3 */
                             2u << 16 | 248, 4,         /* %4 = OpLabel */
                             1u << 16 | 253,            /* OpReturn */
                             1u << 16 | 56};            /* OpFunctionEnd */
    uint32_t words[64] = {0}, n = 0;
    memcpy(words, head, sizeof head);
    n += COUNT(head);
    memcpy(words + n, compute, sizeof compute);
    n += COUNT(compute);
    words[n] = MASU_MODULE_RECORD_FIRST;
    n += MASU_MODULE_RECORD_WORDS;
    memcpy(words + n, tail, sizeof tail);
    add(blob, kind, words, sizeof *words, n + COUNT(tail));
}

void support_blob_recode(support_blob *blob) {
    const masu_blob_section *slots = support_blob_row(blob, MASU_BLOB_SLOTS),
                            *field = support_blob_row(blob, MASU_BLOB_SDF);
    for (uint32_t kind = 0; kind < MASU_BLOB_KIND_COUNT && field; kind++) {
        masu_blob_section *row =
            is_code(kind) ? support_blob_row(blob, (enum masu_blob_kind)kind) : NULL;
        if (!row) continue;
        const masu_blob_sdf *s = (const masu_blob_sdf *)(const void *)(blob->bytes + field->offset);
        const masu_module_counts counts = {
            .kind = kind,
            .parts = s->part_count,
            .slots = slots ? (uint32_t)slots->count : 0,
            .block_words = s->block_words,
            .raster = s->has_raster,
            .anchored = s->flags & MASU_SDF_ANCHORED,
            .moves = support_blob_row(blob, MASU_BLOB_UPDATE_PREVIOUS_SPIRV) != NULL};
        uint32_t *words = (uint32_t *)(void *)(blob->bytes + row->offset);
        masu_module_record(&counts, (char *)(words + masu_module_record_place(words, row->count) -
                                             MASU_MODULE_RECORD_WORDS + 1));
    }
}

void support_blob_write(support_blob *blob, uint32_t parts) {
    memset(blob, 0, sizeof *blob);
    masu_blob_header *header = (masu_blob_header *)(void *)blob->bytes;
    header->magic = MASU_BLOB_MAGIC;
    header->version = MASU_BLOB_VERSION;
    size_t sections = 1 + (parts & SUPPORT_RASTER ? 9u : 0u) + (parts & SUPPORT_CAMERA ? 1u : 0u) +
                      (parts & SUPPORT_SDF ? 9u : 0u) + (parts & SUPPORT_SHADOW ? 1u : 0u) + 1;
    int detail = parts & SUPPORT_RASTER && parts & SUPPORT_DETAIL;
    if (detail) sections++;
    int lighting = parts & SUPPORT_RASTER && parts & SUPPORT_LIGHTING;
    if (lighting) sections += 6;
#ifdef MASU_LAB
    enum { VARIANT_SECTIONS = 7 };
#else
    enum { VARIANT_SECTIONS = 4 };
#endif
    if (parts & SUPPORT_SDF && parts & SUPPORT_VARIANTS) sections += VARIANT_SECTIONS;
    uint32_t with_textures = SUPPORT_RASTER | SUPPORT_TEXTURES;
    if ((parts & with_textures) == with_textures) sections += 4;
    int trace = parts & SUPPORT_RASTER && parts & SUPPORT_TRACE;
    if (trace) sections += 5;
    int trace_textured = trace && parts & SUPPORT_TRACE_MORE && parts & SUPPORT_TEXTURES;
    int trace_sdf = trace && parts & SUPPORT_TRACE_MORE && parts & SUPPORT_SDF;
    if (trace_textured) sections += 2;
    if (trace_sdf) sections += 2;
    int live = parts & SUPPORT_RASTER && parts & SUPPORT_LIVE;
    if (live) sections += 2;
    int skin = live && parts & SUPPORT_SKIN;
    if (skin) sections += 6;
    int morph = skin && parts & SUPPORT_MORPH;
    if (morph) sections += 2;
    int attributes = (parts & with_textures) == with_textures && parts & SUPPORT_ATTRIBUTES;
    if (attributes) sections += 2;
    blob->size = sizeof *header + sections * sizeof(masu_blob_section);
    if (parts & SUPPORT_RASTER) {
        ADD(MASU_BLOB_VERTICES, vertices);
        add(blob, MASU_BLOB_INDICES, indices, sizeof *indices, COUNT(indices) - (detail ? 0 : 3));
        add(blob, MASU_BLOB_PRIMITIVES, primitives, sizeof *primitives,
            COUNT(primitives) - (detail ? 0 : 1));
        ADD(MASU_BLOB_MESHES, meshes);
        ADD(MASU_BLOB_INSTANCES, instances);
        if (parts & SUPPORT_TEXTURES) {
            ADD(MASU_BLOB_MATERIALS, mapped);
        } else {
            ADD(MASU_BLOB_MATERIALS, materials);
        }
        ADD(MASU_BLOB_GROUPS, groups);
        ADD(MASU_BLOB_GROUP_ITEMS, group_items);
        add(blob, MASU_BLOB_OCCLUDERS, occluders, sizeof *occluders, skin ? 1 : COUNT(occluders));
    }
    if (parts & SUPPORT_CAMERA) ADD(MASU_BLOB_CAMERA_KEYS, camera_keys);
    ADD(MASU_BLOB_ENVIRONMENT, environment);
    if (parts & SUPPORT_SHADOW) ADD(MASU_BLOB_SHADOW, shadow);
    if (parts & SUPPORT_SDF) {
        masu_blob_sdf sdf[] = {{{-10.0f, -1.0f, -10.0f},
                                2.0f,
                                {10.0f, 4.0f, 10.0f},
                                100.0f,
                                parts & SUPPORT_RASTER ? 1u : 0u,
                                1,
                                0,
                                0}};
        ADD(MASU_BLOB_SDF, sdf);
        ADD(MASU_BLOB_SDF_PARAMS, sdf_params);
        add_code(blob, MASU_BLOB_MARCH_SPIRV);
    }
    if (parts & SUPPORT_LONG_NAME) {
        char long_names[1 + MASU_BLOB_NAME_MAX + 1 + 2] = {0};
        memset(long_names + 1, 'n', MASU_BLOB_NAME_MAX);
        long_names[sizeof long_names - 2] = 'x';
        add(blob, MASU_BLOB_NAMES, long_names, 1, sizeof long_names);
    } else {
        ADD(MASU_BLOB_NAMES, names);
    }
    if (parts & SUPPORT_SDF) {
        add_code(blob, MASU_BLOB_CLASSIFY_SPIRV);
        add_code(blob, MASU_BLOB_CONE8_SPIRV);
        add_code(blob, MASU_BLOB_CONE4_SPIRV);
        add_code(blob, MASU_BLOB_VELOCITY_SPIRV);
        add_code(blob, MASU_BLOB_SILHOUETTES_SPIRV);
        if (parts & SUPPORT_VARIANTS) {
            add_code(blob, MASU_BLOB_UPDATE_SPIRV);
            add_code(blob, MASU_BLOB_UPDATE_PREVIOUS_SPIRV);
#ifdef MASU_LAB
            add_code(blob, MASU_BLOB_PLAIN_SPIRV);
            add_code(blob, MASU_BLOB_SEED_SPIRV);
            add_code(blob, MASU_BLOB_CHECKERBOARD_SPIRV);
#endif
            add_code(blob, MASU_BLOB_OCCLUSION_SPIRV);
            add_code(blob, MASU_BLOB_LOCAL_SHADOW_SPIRV);
        }
        ADD(MASU_BLOB_SLOTS, slots);
    }
    if ((parts & with_textures) == with_textures) {
        ADD(MASU_BLOB_TEXCOORDS, texcoords);
        ADD(MASU_BLOB_TEXTURES, textures);
        ADD(MASU_BLOB_TEXTURE_SETS, texture_sets);
        ADD(MASU_BLOB_TEXELS, texels);
    }
    if (attributes) {
        ADD(MASU_BLOB_COLORS, colors);
        ADD(MASU_BLOB_TEXCOORDS_1, texcoords);
    }
    if (detail) ADD(MASU_BLOB_LODS, lods);
    if (lighting) {
        ADD(MASU_BLOB_MESO, meso);
        ADD(MASU_BLOB_LIGHTS, lights);
        ADD(MASU_BLOB_PROBES, probes);
        ADD(MASU_BLOB_PROBE_DATA, probe_data);
        ADD(MASU_BLOB_ENVIRONMENT_MAP, environment_map);
        ADD(MASU_BLOB_ENVIRONMENT_TEXELS, environment_texels);
    }
    if (trace) {
        ADD(MASU_BLOB_TRACE_NODES, trace_nodes);
        ADD(MASU_BLOB_TRACE_TRIANGLES, trace_triangles);
        ADD(MASU_BLOB_TRACE_MESHES, trace_meshes);
        ADD(MASU_BLOB_TRACE_INSTANCES, trace_instances);
        ADD(MASU_BLOB_REFLECTIONS, reflections);
    }
    if (trace_textured) {
        ADD(MASU_BLOB_TRACE_TEXTURES, trace_textures);
        ADD(MASU_BLOB_TRACE_TEXELS, trace_texels);
    }
    if (trace_sdf) {
        add_code(blob, MASU_BLOB_TRACE_SDF_SPIRV);
        add_code(blob, MASU_BLOB_BOUNCE_SDF_SPIRV);
    }
    if (live) {
        ADD(MASU_BLOB_MODELS, models);
        ADD(MASU_BLOB_MODEL_NODES, model_nodes);
    }
    if (skin) {
        if (morph) {
            ADD(MASU_BLOB_CLIPS, morph_clips);
            ADD(MASU_BLOB_CHANNELS, morph_channels);
            ADD(MASU_BLOB_KEYS, morph_keys);
            ADD(MASU_BLOB_MORPH_TARGETS, morph_targets);
            ADD(MASU_BLOB_MORPH_DELTAS, morph_deltas);
        } else {
            ADD(MASU_BLOB_CLIPS, clips);
            ADD(MASU_BLOB_CHANNELS, channels);
            ADD(MASU_BLOB_KEYS, clip_keys);
        }
        ADD(MASU_BLOB_SKINS, skins);
        ADD(MASU_BLOB_JOINTS, joints);
        ADD(MASU_BLOB_SKIN_VERTICES, skin_vertices);
        ((masu_blob_model_node *)support_blob_find(blob, MASU_BLOB_MODEL_NODES))[3].skin = 1;
        if (morph) ((masu_blob_skin *)support_blob_find(blob, MASU_BLOB_SKINS))->target_count = 2;
    }
    support_blob_recode(blob);
    support_blob_seal(blob->bytes, blob->size);
}

masu_blob_section *support_blob_row(support_blob *blob, enum masu_blob_kind kind) {
    masu_blob_header *header = (masu_blob_header *)(void *)blob->bytes;
    masu_blob_section *rows = (masu_blob_section *)(void *)(blob->bytes + sizeof *header);
    for (uint32_t i = 0; i < header->section_count; i++) {
        if (rows[i].kind == (uint32_t)kind) return &rows[i];
    }
    return NULL;
}

void *support_blob_find(support_blob *blob, enum masu_blob_kind kind) {
    masu_blob_section *row = support_blob_row(blob, kind);
    if (!row) {
        fprintf(stderr, "support_blob: no section of kind %d\n", (int)kind);
        abort();
    }
    return blob->bytes + row->offset;
}

void support_blob_drop(support_blob *blob, enum masu_blob_kind kind) {
    static support_blob old;
    old = *blob;
    const masu_blob_header *was = (const masu_blob_header *)(const void *)old.bytes;
    const masu_blob_section *rows =
        (const masu_blob_section *)(const void *)(old.bytes + sizeof *was);
    masu_blob_header *header = (masu_blob_header *)(void *)blob->bytes;
    uint32_t kept = was->section_count - (support_blob_row(blob, kind) != NULL);
    memset(blob->bytes + sizeof *was, 0, sizeof blob->bytes - sizeof *was);
    header->section_count = 0;
    blob->size = sizeof *header + kept * sizeof *rows;
    for (uint32_t i = 0; i < was->section_count; i++) {
        if (rows[i].kind == (uint32_t)kind) continue;
        add(blob, (enum masu_blob_kind)rows[i].kind, old.bytes + rows[i].offset, rows[i].stride,
            (size_t)rows[i].count);
    }
}

void support_blob_seal(unsigned char *bytes, size_t size) {
    masu_blob_header header;
    if (size < sizeof header) return;
    memcpy(&header, bytes, sizeof header);
    header.bytes = size;
    header.hash = masu_fnv1a64(bytes + sizeof header, size - sizeof header);
    memcpy(bytes, &header, sizeof header);
}
