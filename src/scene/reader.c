/* reader.c: see reader.h. */
#include "scene/reader.h"

#include <string.h>

typedef struct section_rule {
    const char *name;
    uint32_t stride;
    uint64_t most; /* maximum number of elements */
    int code;      /* the section is SPIR-V */
} section_rule;

#define CODE(kind, name) [kind] = {name, sizeof(uint32_t), (uint64_t)16 << 20, 1}

static const section_rule rules[MASU_BLOB_KIND_COUNT] = {
    [MASU_BLOB_VERTICES] = {"vertices", sizeof(masu_blob_vertex), MASU_SECTION_MOST, 0},
    [MASU_BLOB_INDICES] = {"indices", sizeof(uint32_t), MASU_SECTION_MOST, 0},
    [MASU_BLOB_PRIMITIVES] = {"primitives", sizeof(masu_blob_primitive), MASU_SECTION_MOST, 0},
    [MASU_BLOB_MESHES] = {"meshes", sizeof(masu_blob_mesh), MASU_SECTION_MOST, 0},
    [MASU_BLOB_INSTANCES] = {"instances", sizeof(masu_blob_instance), MASU_SECTION_MOST, 0},
    [MASU_BLOB_MATERIALS] = {"materials", sizeof(masu_blob_material), MASU_SECTION_MOST, 0},
    [MASU_BLOB_LODS] = {"lods", sizeof(masu_blob_lod), MASU_SECTION_MOST, 0},
    [MASU_BLOB_CAMERA_KEYS] = {"camera keys", sizeof(masu_blob_camera_key), MASU_SECTION_MOST, 0},
    [MASU_BLOB_ENVIRONMENT] = {"environment", sizeof(masu_blob_environment), 1, 0},
    [MASU_BLOB_SDF] = {"sdf", sizeof(masu_blob_sdf), 1, 0},
    [MASU_BLOB_SDF_PARAMS] = {"sdf parameters", sizeof(masu_blob_sdf_param), MASU_MAX_SDF_PARAMS,
                              0},
    CODE(MASU_BLOB_MARCH_SPIRV, "march SPIR-V"),
    CODE(MASU_BLOB_CLASSIFY_SPIRV, "classify SPIR-V"),
    CODE(MASU_BLOB_CONE8_SPIRV, "cone8 SPIR-V"),
    CODE(MASU_BLOB_CONE4_SPIRV, "cone4 SPIR-V"),
    CODE(MASU_BLOB_UPDATE_SPIRV, "update SPIR-V"),
#ifdef MASU_LAB
    CODE(MASU_BLOB_PLAIN_SPIRV, "march_plain SPIR-V"),
    CODE(MASU_BLOB_SEED_SPIRV, "march_seed SPIR-V"),
    CODE(MASU_BLOB_CHECKERBOARD_SPIRV, "march_checkerboard SPIR-V"),
#endif
    CODE(MASU_BLOB_UPDATE_PREVIOUS_SPIRV, "update_previous SPIR-V"),
    CODE(MASU_BLOB_VELOCITY_SPIRV, "velocity SPIR-V"),
    CODE(MASU_BLOB_SILHOUETTES_SPIRV, "silhouettes SPIR-V"),
    CODE(MASU_BLOB_OCCLUSION_SPIRV, "sdf_occlusion SPIR-V"),
    CODE(MASU_BLOB_TRACE_SDF_SPIRV, "specular_trace_sdf SPIR-V"),
    CODE(MASU_BLOB_BOUNCE_SDF_SPIRV, "bounce_sdf SPIR-V"),
    CODE(MASU_BLOB_LOCAL_SHADOW_SPIRV, "local_shadow_sdf SPIR-V"),
    [MASU_BLOB_REFLECTIONS] = {"reflections", sizeof(masu_blob_reflections), 1, 0},
    [MASU_BLOB_TRACE_TEXTURES] = {"trace textures", sizeof(masu_blob_trace_texture),
                                  MASU_SECTION_MOST, 0},
    [MASU_BLOB_TRACE_TEXELS] = {"trace texels", sizeof(uint32_t), MASU_SECTION_MOST, 0},
    [MASU_BLOB_SLOTS] = {"slots", sizeof(float), 65536, 0},
    [MASU_BLOB_GROUPS] = {"groups", sizeof(masu_blob_group), MASU_SECTION_MOST, 0},
    [MASU_BLOB_GROUP_ITEMS] = {"group items", sizeof(uint32_t), MASU_SECTION_MOST, 0},
    [MASU_BLOB_OCCLUDERS] = {"occluders", sizeof(masu_blob_occluder), MASU_SECTION_MOST, 0},
    [MASU_BLOB_SHADOW] = {"shadow", sizeof(masu_blob_shadow), 1, 0},
    [MASU_BLOB_NAMES] = {"names", 1, MASU_SECTION_MOST, 0},
    [MASU_BLOB_TEXCOORDS] = {"texture coordinates", 2 * sizeof(float), MASU_SECTION_MOST, 0},
    [MASU_BLOB_COLORS] = {"vertex colours", sizeof(uint32_t), MASU_SECTION_MOST, 0},
    [MASU_BLOB_TEXCOORDS_1] = {"second texture coordinates", 2 * sizeof(float), MASU_SECTION_MOST,
                               0},
    [MASU_BLOB_MORPH_TARGETS] = {"morph targets", sizeof(masu_blob_morph_target), MASU_SECTION_MOST,
                                 0},
    [MASU_BLOB_MORPH_DELTAS] = {"morph deltas", sizeof(masu_blob_morph_delta), MASU_SECTION_MOST,
                                0},
    [MASU_BLOB_TEXTURES] = {"textures", sizeof(masu_blob_texture), MASU_TEXTURE_ARRAYS_MAX, 0},
    [MASU_BLOB_TEXTURE_SETS] = {"texture sets", sizeof(masu_blob_texture_set), MASU_SECTION_MOST,
                                0},
    [MASU_BLOB_TEXELS] = {"texels", MASU_BLOB_ALIGN, MASU_SECTION_MOST, 0},
    [MASU_BLOB_MESO] = {"meso", sizeof(masu_blob_meso), MASU_SECTION_MOST, 0},
    [MASU_BLOB_LIGHTS] = {"lights", sizeof(masu_blob_light), MASU_BLOB_LIGHTS_MAX, 0},
    [MASU_BLOB_PROBES] = {"probes", sizeof(masu_blob_probes), 1, 0},
    [MASU_BLOB_PROBE_DATA] = {"probe data", sizeof(uint32_t), MASU_SECTION_MOST, 0},
    [MASU_BLOB_ENVIRONMENT_MAP] = {"environment map", sizeof(masu_blob_environment_map), 1, 0},
    [MASU_BLOB_ENVIRONMENT_TEXELS] = {"environment texels", sizeof(uint32_t), MASU_SECTION_MOST, 0},
    [MASU_BLOB_MODELS] = {"models", sizeof(masu_blob_model), MASU_SECTION_MOST, 0},
    [MASU_BLOB_MODEL_NODES] = {"model nodes", sizeof(masu_blob_model_node), MASU_SECTION_MOST, 0},
    [MASU_BLOB_CLIPS] = {"clips", sizeof(masu_blob_clip), MASU_SECTION_MOST, 0},
    [MASU_BLOB_CHANNELS] = {"channels", sizeof(masu_blob_channel), MASU_SECTION_MOST, 0},
    [MASU_BLOB_KEYS] = {"keys", sizeof(masu_blob_key), MASU_SECTION_MOST, 0},
    [MASU_BLOB_SKINS] = {"skins", sizeof(masu_blob_skin), MASU_BLOB_SKINS_MAX, 0},
    [MASU_BLOB_JOINTS] = {"joints", sizeof(masu_blob_joint), MASU_BLOB_SKIN_JOINTS_MAX, 0},
    [MASU_BLOB_SKIN_VERTICES] = {"skin vertices", sizeof(masu_blob_skin_vertex), MASU_SECTION_MOST,
                                 0},
    [MASU_BLOB_TRACE_NODES] = {"trace nodes", sizeof(masu_blob_trace_node), MASU_TRACE_NODES_MAX,
                               0},
    [MASU_BLOB_TRACE_TRIANGLES] = {"trace triangles", sizeof(masu_blob_trace_triangle),
                                   MASU_SECTION_MOST / 4, 0},
    [MASU_BLOB_TRACE_MESHES] = {"trace meshes", sizeof(masu_blob_trace_mesh), MASU_SECTION_MOST, 0},
    [MASU_BLOB_TRACE_INSTANCES] = {"trace instances", sizeof(uint32_t), MASU_TRACE_INSTANCES_MAX,
                                   0},
};

/* ---- Header and sections --------------------------------------------------------------------- */

masu_result masu_read_header(reader *r, uint64_t given) {
    masu_blob_header h;
    if (given < sizeof h) {
        return masu_fail(r->detail, MASU_ERROR_SCENE, "header", sizeof h, given,
                         "scene blob: %llu bytes are too few for the header (%u)",
                         (unsigned long long)given, (unsigned)sizeof h);
    }
    memcpy(&h, r->bytes, sizeof h);
    if (h.magic != MASU_BLOB_MAGIC) {
        return masu_fail(r->detail, MASU_ERROR_SCENE, "magic", MASU_BLOB_MAGIC, h.magic,
                         "not a Masu scene blob (it starts with 0x%08x, not 'MASU')", h.magic);
    }
    if (h.version != MASU_BLOB_VERSION) {
        return masu_fail(r->detail, MASU_ERROR_VERSION, "version", MASU_BLOB_VERSION, h.version,
                         "scene blob: version %u, this library reads version %u; bake it again",
                         h.version, MASU_BLOB_VERSION);
    }
    uint64_t reserved = h.reserved0 | h.reserved[0] | h.reserved[1] | h.reserved[2] | h.reserved[3];
    if (reserved) {
        return masu_fail(r->detail, MASU_ERROR_SCENE, "header", 0, reserved,
                         "scene blob: a reserved field of the header is not zero");
    }
    if (h.bytes != given) {
        return masu_fail(
            r->detail, MASU_ERROR_SCENE, "bytes", h.bytes, given,
            "scene blob: %llu bytes are given, its header says %llu: truncated or joined",
            (unsigned long long)given, (unsigned long long)h.bytes);
    }
    uint64_t hash = masu_fnv1a64(r->bytes + sizeof h, given - sizeof h);
    if (hash != h.hash) {
        return masu_fail(r->detail, MASU_ERROR_SCENE, "hash", h.hash, hash,
                         "scene blob: damaged (hash %016llx, its header says %016llx)",
                         (unsigned long long)hash, (unsigned long long)h.hash);
    }
    if (h.section_count > MASU_BLOB_KIND_COUNT ||
        sizeof h + h.section_count * sizeof(masu_blob_section) > given) {
        return masu_fail(r->detail, MASU_ERROR_SCENE, "section_count", MASU_BLOB_KIND_COUNT,
                         h.section_count, "scene blob: %u sections do not fit", h.section_count);
    }
    return MASU_OK;
}

/* Fills a view. start: the first byte of each section that is present. */
static masu_scene_view view_of(const void *const start[MASU_BLOB_KIND_COUNT],
                               const uint64_t counts[MASU_BLOB_KIND_COUNT]) {
    masu_scene_view v = (masu_scene_view){.vertices = start[MASU_BLOB_VERTICES],
                                          .indices = start[MASU_BLOB_INDICES],
                                          .primitives = start[MASU_BLOB_PRIMITIVES],
                                          .meshes = start[MASU_BLOB_MESHES],
                                          .instances = start[MASU_BLOB_INSTANCES],
                                          .groups = start[MASU_BLOB_GROUPS],
                                          .group_items = start[MASU_BLOB_GROUP_ITEMS],
                                          .occluders = start[MASU_BLOB_OCCLUDERS],
                                          .lods = start[MASU_BLOB_LODS],
                                          .materials = start[MASU_BLOB_MATERIALS],
                                          .material_count = counts[MASU_BLOB_MATERIALS],
                                          .camera_keys = start[MASU_BLOB_CAMERA_KEYS],
                                          .environment = start[MASU_BLOB_ENVIRONMENT],
                                          .shadow = start[MASU_BLOB_SHADOW],
                                          .sdf = start[MASU_BLOB_SDF],
                                          .sdf_params = start[MASU_BLOB_SDF_PARAMS],
                                          .slots = start[MASU_BLOB_SLOTS],
                                          .slot_count = counts[MASU_BLOB_SLOTS],
                                          .texcoords = start[MASU_BLOB_TEXCOORDS],
                                          .colors = start[MASU_BLOB_COLORS],
                                          .texcoords_1 = start[MASU_BLOB_TEXCOORDS_1],
                                          .textures = start[MASU_BLOB_TEXTURES],
                                          .texture_sets = start[MASU_BLOB_TEXTURE_SETS],
                                          .texels = start[MASU_BLOB_TEXELS],
                                          .meso = start[MASU_BLOB_MESO],
                                          .lights = start[MASU_BLOB_LIGHTS],
                                          .probes = start[MASU_BLOB_PROBES],
                                          .probe_data = start[MASU_BLOB_PROBE_DATA],
                                          .probe_words = counts[MASU_BLOB_PROBE_DATA],
                                          .environment_map = start[MASU_BLOB_ENVIRONMENT_MAP],
                                          .environment_texels = start[MASU_BLOB_ENVIRONMENT_TEXELS],
                                          .reflections = start[MASU_BLOB_REFLECTIONS],
                                          .trace_textures = start[MASU_BLOB_TRACE_TEXTURES],
                                          .trace_texels = start[MASU_BLOB_TRACE_TEXELS],
                                          .trace_nodes = start[MASU_BLOB_TRACE_NODES],
                                          .trace_triangles = start[MASU_BLOB_TRACE_TRIANGLES],
                                          .trace_meshes = start[MASU_BLOB_TRACE_MESHES],
                                          .trace_instances = start[MASU_BLOB_TRACE_INSTANCES],
                                          .models = start[MASU_BLOB_MODELS],
                                          .model_nodes = start[MASU_BLOB_MODEL_NODES],
                                          .clips = start[MASU_BLOB_CLIPS],
                                          .channels = start[MASU_BLOB_CHANNELS],
                                          .keys = start[MASU_BLOB_KEYS],
                                          .skins = start[MASU_BLOB_SKINS],
                                          .joints = start[MASU_BLOB_JOINTS],
                                          .skin_vertices = start[MASU_BLOB_SKIN_VERTICES],
                                          .morph_targets = start[MASU_BLOB_MORPH_TARGETS],
                                          .morph_deltas = start[MASU_BLOB_MORPH_DELTAS],
                                          .names = start[MASU_BLOB_NAMES],
                                          .name_bytes = counts[MASU_BLOB_NAMES]};
    for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
        if (!rules[k].code || !start[k]) continue;
        v.code[k].words = start[k];
        v.code[k].count = counts[k];
    }
    return v;
}

/* Sphere-tracing variants that only a library built with MASU_LAB can run. */
static int is_of_lab(uint32_t kind) {
#ifdef MASU_LAB
    (void)kind;
    return 0;
#else
    return kind == MASU_BLOB_PLAIN_SPIRV || kind == MASU_BLOB_SEED_SPIRV ||
           kind == MASU_BLOB_CHECKERBOARD_SPIRV;
#endif
}

masu_result masu_read_sections(reader *r, uint64_t given) {
    masu_blob_header h;
    memcpy(&h, r->bytes, sizeof h);
    const void *start[MASU_BLOB_KIND_COUNT] = {0};
    uint64_t behind_table = sizeof h + h.section_count * sizeof(masu_blob_section);
    uint64_t end = behind_table;
    for (uint32_t i = 0; i < h.section_count; i++) {
        masu_blob_section s;
        memcpy(&s, r->bytes + sizeof h + i * sizeof s, sizeof s);
        if (is_of_lab(s.kind))
            return bad(r, "section", i,
                       "holds a march of the lab build: bake the scene without --variants");
        if (s.kind == 0 || s.kind >= MASU_BLOB_KIND_COUNT || !rules[s.kind].stride)
            return bad(r, "section", i, "unknown kind");
        if (start[s.kind]) return bad(r, "section", i, "appears twice");
        if (s.stride != rules[s.kind].stride) return bad(r, "section", i, "element size is wrong");
        if (s.count == 0 || s.count > rules[s.kind].most) {
            return bad(r, "section", i, "element count is out of range");
        }
        if (s.offset % MASU_BLOB_ALIGN || s.offset < behind_table || s.offset > given ||
            s.count * s.stride > given - s.offset) {
            return bad(r, "section", i, "lies outside the blob or is misaligned");
        }
        if (s.offset + s.count * s.stride > end) end = s.offset + s.count * s.stride;
        start[s.kind] = r->bytes + s.offset;
        r->counts[s.kind] = s.count;
    }
    /* The section count is not covered by the hash. Bytes that belong to no section, except
     * padding, mean that the count is corrupt. */
    if (given - end >= MASU_BLOB_ALIGN) {
        return bad(r, "section", h.section_count, "is missing: bytes are left behind the last one");
    }
    r->view = view_of(start, r->counts);
    r->view.hash = h.hash;
    return MASU_OK;
}

const char *masu_section_name(uint32_t kind) { return rules[kind].name; }
