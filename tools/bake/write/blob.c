/* blob.c: content to blob; see blob.h. The machine that bakes is little-endian, like the format:
 * structs are copied bytewise. */
#include "bake/write/blob.h"

#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "masu-bake copies structs into a little-endian format"
#endif

static size_t aligned(size_t bytes) {
    return (bytes + MASU_BLOB_ALIGN - 1) / MASU_BLOB_ALIGN * MASU_BLOB_ALIGN;
}

void masu_bake_make_blob(const masu_bake_content *content, masu_bake_buffer *out) {
    masu_blob_header header = {.magic = MASU_BLOB_MAGIC, .version = MASU_BLOB_VERSION};
    masu_blob_section table[MASU_BLOB_KIND_COUNT];
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        if (content->section[kind].bytes == 0) continue; /* empty sections are omitted */
        table[header.section_count++] =
            (masu_blob_section){.kind = kind,
                                .stride = masu_bake_stride(kind),
                                .count = masu_bake_count(content, kind)};
    }
    size_t offset = aligned(sizeof header + header.section_count * sizeof table[0]);
    for (uint32_t i = 0; i < header.section_count; i++) {
        table[i].offset = offset;
        offset = aligned(offset + content->section[table[i].kind].bytes);
    }
    header.bytes = offset;
    unsigned char *bytes = masu_bake_append(out, NULL, offset);
    memcpy(bytes + sizeof header, table, header.section_count * sizeof table[0]);
    for (uint32_t i = 0; i < header.section_count; i++) {
        const masu_bake_buffer *payload = &content->section[table[i].kind];
        memcpy(bytes + table[i].offset, payload->data, payload->bytes);
    }
    header.hash = masu_fnv1a64(bytes + sizeof header, header.bytes - sizeof header);
    memcpy(bytes, &header, sizeof header);
}

const char *masu_bake_kind_name(uint32_t kind) {
    static const char *const names[MASU_BLOB_KIND_COUNT] = {
        [MASU_BLOB_VERTICES] = "vertices",
        [MASU_BLOB_INDICES] = "indices",
        [MASU_BLOB_PRIMITIVES] = "primitives",
        [MASU_BLOB_MESHES] = "meshes",
        [MASU_BLOB_INSTANCES] = "instances",
        [MASU_BLOB_MATERIALS] = "materials",
        [MASU_BLOB_CAMERA_KEYS] = "camera_keys",
        [MASU_BLOB_ENVIRONMENT] = "environment",
        [MASU_BLOB_SDF] = "sdf",
        [MASU_BLOB_SDF_PARAMS] = "sdf_params",
        [MASU_BLOB_MARCH_SPIRV] = "march_spirv",
        [MASU_BLOB_CLASSIFY_SPIRV] = "classify_spirv",
        [MASU_BLOB_CONE8_SPIRV] = "cone8_spirv",
        [MASU_BLOB_CONE4_SPIRV] = "cone4_spirv",
        [MASU_BLOB_UPDATE_SPIRV] = "update_spirv",
        [MASU_BLOB_PLAIN_SPIRV] = "plain_spirv",
        [MASU_BLOB_SEED_SPIRV] = "seed_spirv",
        [MASU_BLOB_CHECKERBOARD_SPIRV] = "checkerboard_spirv",
        [MASU_BLOB_UPDATE_PREVIOUS_SPIRV] = "update_previous_spirv",
        [MASU_BLOB_VELOCITY_SPIRV] = "velocity_spirv",
        [MASU_BLOB_SILHOUETTES_SPIRV] = "silhouettes_spirv",
        [MASU_BLOB_OCCLUSION_SPIRV] = "occlusion_spirv",
        [MASU_BLOB_TRACE_SDF_SPIRV] = "specular_trace_sdf_spirv",
        [MASU_BLOB_BOUNCE_SDF_SPIRV] = "bounce_sdf_spirv",
        [MASU_BLOB_LOCAL_SHADOW_SPIRV] = "local_shadow_sdf_spirv",
        [MASU_BLOB_SHADOW] = "shadow",
        [MASU_BLOB_SLOTS] = "slots",
        [MASU_BLOB_GROUPS] = "groups",
        [MASU_BLOB_GROUP_ITEMS] = "group_items",
        [MASU_BLOB_LODS] = "lods",
        [MASU_BLOB_LIGHTS] = "lights",
        [MASU_BLOB_OCCLUDERS] = "occluders",
        [MASU_BLOB_NAMES] = "names",
        [MASU_BLOB_TEXCOORDS] = "texcoords",
        [MASU_BLOB_COLORS] = "colors",
        [MASU_BLOB_TEXCOORDS_1] = "texcoords_1",
        [MASU_BLOB_MORPH_TARGETS] = "morph_targets",
        [MASU_BLOB_MORPH_DELTAS] = "morph_deltas",
        [MASU_BLOB_TEXTURES] = "textures",
        [MASU_BLOB_TEXTURE_SETS] = "texture_sets",
        [MASU_BLOB_TEXELS] = "texels",
        [MASU_BLOB_PROBES] = "probes",
        [MASU_BLOB_PROBE_DATA] = "probe_data",
        [MASU_BLOB_TRACE_NODES] = "trace_nodes",
        [MASU_BLOB_TRACE_TRIANGLES] = "trace_triangles",
        [MASU_BLOB_TRACE_MESHES] = "trace_meshes",
        [MASU_BLOB_TRACE_INSTANCES] = "trace_instances",
        [MASU_BLOB_MODELS] = "models",
        [MASU_BLOB_MODEL_NODES] = "model_nodes",
        [MASU_BLOB_CLIPS] = "clips",
        [MASU_BLOB_CHANNELS] = "channels",
        [MASU_BLOB_KEYS] = "keys",
        [MASU_BLOB_SKINS] = "skins",
        [MASU_BLOB_JOINTS] = "joints",
        [MASU_BLOB_SKIN_VERTICES] = "skin_vertices",
        [MASU_BLOB_REFLECTIONS] = "reflections",
        [MASU_BLOB_TRACE_TEXTURES] = "trace_textures",
        [MASU_BLOB_TRACE_TEXELS] = "trace_texels",
    };
    return names[kind];
}
