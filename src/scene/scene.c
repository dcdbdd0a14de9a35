/* scene.c: see scene.h. Every number of a blob is hostile until it has been checked here; sums are
 * done so that they cannot wrap. Counts fit 32 bits (each section is checked), products are taken
 * in 64. */
#include "scene/scene.h"

#include "scene/reader.h"

#include "scene/cull.h"
#include "base/error.h"
#include "shared/masu_shared.h"
#include "scene/texture.h"

#include <math.h>
#include <string.h>

typedef struct section_rule {
    const char *name;
    uint32_t stride;
    uint64_t most; /* elements */
    int code;      /* it is SPIR-V */
} section_rule;

#define MANY 0x7FFFFFFFu
#define CODE(kind, name) [kind] = {name, sizeof(uint32_t), (uint64_t)16 << 20, 1}

static const section_rule rules[MASU_BLOB_KIND_COUNT] = {
    [MASU_BLOB_VERTICES] = {"vertices", sizeof(masu_blob_vertex), MANY, 0},
    [MASU_BLOB_INDICES] = {"indices", sizeof(uint32_t), MANY, 0},
    [MASU_BLOB_PRIMITIVES] = {"primitives", sizeof(masu_blob_primitive), MANY, 0},
    [MASU_BLOB_MESHES] = {"meshes", sizeof(masu_blob_mesh), MANY, 0},
    [MASU_BLOB_INSTANCES] = {"instances", sizeof(masu_blob_instance), MANY, 0},
    [MASU_BLOB_MATERIALS] = {"materials", sizeof(masu_blob_material), MANY, 0},
    [MASU_BLOB_LODS] = {"lods", sizeof(masu_blob_lod), MANY, 0},
    [MASU_BLOB_CAMERA_KEYS] = {"camera keys", sizeof(masu_blob_camera_key), MANY, 0},
    [MASU_BLOB_ENVIRONMENT] = {"environment", sizeof(masu_blob_environment), 1, 0},
    [MASU_BLOB_SDF] = {"sdf", sizeof(masu_blob_sdf), 1, 0},
    [MASU_BLOB_SDF_PARAMS] = {"sdf parameters", sizeof(masu_blob_sdf_param), MASU_MAX_SDF_PARAMS,
                              0},
    CODE(MASU_BLOB_MARCH_SPIRV, "march SPIR-V"),
    CODE(MASU_BLOB_CLASSIFY_SPIRV, "classify SPIR-V"),
    CODE(MASU_BLOB_CONE8_SPIRV, "cone8 SPIR-V"),
    CODE(MASU_BLOB_CONE4_SPIRV, "cone4 SPIR-V"),
    CODE(MASU_BLOB_UPDATE_SPIRV, "update SPIR-V"),
    CODE(MASU_BLOB_PLAIN_SPIRV, "march_plain SPIR-V"),
    CODE(MASU_BLOB_SEED_SPIRV, "march_seed SPIR-V"),
    CODE(MASU_BLOB_CHECKERBOARD_SPIRV, "march_checkerboard SPIR-V"),
    CODE(MASU_BLOB_FRAGMENT_SPIRV, "march_fragment SPIR-V"),
    CODE(MASU_BLOB_UPDATE_PREVIOUS_SPIRV, "update_previous SPIR-V"),
    CODE(MASU_BLOB_VELOCITY_SPIRV, "velocity SPIR-V"),
    CODE(MASU_BLOB_OCCLUSION_SPIRV, "sdf_occlusion SPIR-V"),
    CODE(MASU_BLOB_TRACE_SDF_SPIRV, "specular_trace_sdf SPIR-V"),
    [MASU_BLOB_REFLECTIONS] = {"reflections", sizeof(masu_blob_reflections), 1, 0},
    [MASU_BLOB_TRACE_TEXTURES] = {"trace textures", sizeof(masu_blob_trace_texture), MANY, 0},
    [MASU_BLOB_TRACE_TEXELS] = {"trace texels", sizeof(uint32_t), MANY, 0},
    [MASU_BLOB_SLOTS] = {"slots", sizeof(float), 65536, 0},
    [MASU_BLOB_GROUPS] = {"groups", sizeof(masu_blob_group), MANY, 0},
    [MASU_BLOB_GROUP_ITEMS] = {"group items", sizeof(uint32_t), MANY, 0},
    [MASU_BLOB_OCCLUDERS] = {"occluders", sizeof(masu_blob_occluder), MANY, 0},
    [MASU_BLOB_SHADOW] = {"shadow", sizeof(masu_blob_shadow), 1, 0},
    [MASU_BLOB_NAMES] = {"names", 1, MANY, 0},
    [MASU_BLOB_TEXCOORDS] = {"texture coordinates", 2 * sizeof(float), MANY, 0},
    [MASU_BLOB_TEXTURES] = {"textures", sizeof(masu_blob_texture), MASU_TEXTURE_ARRAYS_MAX, 0},
    [MASU_BLOB_TEXTURE_SETS] = {"texture sets", sizeof(masu_blob_texture_set), MANY, 0},
    [MASU_BLOB_TEXELS] = {"texels", MASU_BLOB_ALIGN, MANY, 0},
    [MASU_BLOB_MESO] = {"meso", sizeof(masu_blob_meso), MANY, 0},
    [MASU_BLOB_LIGHTS] = {"lights", sizeof(masu_blob_light), MASU_BLOB_LIGHTS_MAX, 0},
    [MASU_BLOB_PROBES] = {"probes", sizeof(masu_blob_probes), 1, 0},
    [MASU_BLOB_PROBE_DATA] = {"probe data", sizeof(uint32_t), MANY, 0},
    [MASU_BLOB_ENVIRONMENT_MAP] = {"environment map", sizeof(masu_blob_environment_map), 1, 0},
    [MASU_BLOB_ENVIRONMENT_TEXELS] = {"environment texels", sizeof(uint32_t), MANY, 0},
    [MASU_BLOB_TRACE_NODES] = {"trace nodes", sizeof(masu_blob_trace_node), MASU_TRACE_NODES_MAX, 0},
    [MASU_BLOB_TRACE_TRIANGLES] = {"trace triangles", sizeof(masu_blob_trace_triangle), MANY / 4, 0},
    [MASU_BLOB_TRACE_MESHES] = {"trace meshes", sizeof(masu_blob_trace_mesh), MANY, 0},
    [MASU_BLOB_TRACE_INSTANCES] = {"trace instances", sizeof(uint32_t), MASU_TRACE_INSTANCES_MAX, 0},
};

/* ---- Header and sections --------------------------------------------------------------------- */

static masu_result check_header(reader *r, uint64_t given) {
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

static masu_result read_sections(reader *r, uint64_t given) {
    masu_blob_header h;
    memcpy(&h, r->bytes, sizeof h);
    const void *start[MASU_BLOB_KIND_COUNT] = {0};
    uint64_t behind_table = sizeof h + h.section_count * sizeof(masu_blob_section);
    uint64_t end = behind_table;
    for (uint32_t i = 0; i < h.section_count; i++) {
        masu_blob_section s;
        memcpy(&s, r->bytes + sizeof h + i * sizeof s, sizeof s);
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
    /* The count of sections is in front of what the hash covers. Bytes that no section owns, beyond
     * padding, say that it was damaged. */
    if (given - end >= MASU_BLOB_ALIGN) {
        return bad(r, "section", h.section_count, "is missing: bytes are left behind the last one");
    }
    r->view = (masu_scene_view){.vertices = start[MASU_BLOB_VERTICES],
                                .indices = start[MASU_BLOB_INDICES],
                                .primitives = start[MASU_BLOB_PRIMITIVES],
                                .meshes = start[MASU_BLOB_MESHES],
                                .instances = start[MASU_BLOB_INSTANCES],
                                .groups = start[MASU_BLOB_GROUPS],
                                .group_items = start[MASU_BLOB_GROUP_ITEMS],
                                .occluders = start[MASU_BLOB_OCCLUDERS],
                                .lods = start[MASU_BLOB_LODS],
                                .materials = start[MASU_BLOB_MATERIALS],
                                .material_count = r->counts[MASU_BLOB_MATERIALS],
                                .camera_keys = start[MASU_BLOB_CAMERA_KEYS],
                                .environment = start[MASU_BLOB_ENVIRONMENT],
                                .shadow = start[MASU_BLOB_SHADOW],
                                .sdf = start[MASU_BLOB_SDF],
                                .sdf_params = start[MASU_BLOB_SDF_PARAMS],
                                .slots = start[MASU_BLOB_SLOTS],
                                .slot_count = r->counts[MASU_BLOB_SLOTS],
                                .texcoords = start[MASU_BLOB_TEXCOORDS],
                                .textures = start[MASU_BLOB_TEXTURES],
                                .texture_sets = start[MASU_BLOB_TEXTURE_SETS],
                                .texels = start[MASU_BLOB_TEXELS],
                                .meso = start[MASU_BLOB_MESO],
                                .lights = start[MASU_BLOB_LIGHTS],
                                .probes = start[MASU_BLOB_PROBES],
                                .probe_data = start[MASU_BLOB_PROBE_DATA],
                                .probe_words = r->counts[MASU_BLOB_PROBE_DATA],
                                .environment_map = start[MASU_BLOB_ENVIRONMENT_MAP],
                                .environment_texels = start[MASU_BLOB_ENVIRONMENT_TEXELS],
                                .reflections = start[MASU_BLOB_REFLECTIONS],
                                .trace_textures = start[MASU_BLOB_TRACE_TEXTURES],
                                .trace_texels = start[MASU_BLOB_TRACE_TEXELS],
                                .trace_nodes = start[MASU_BLOB_TRACE_NODES],
                                .trace_triangles = start[MASU_BLOB_TRACE_TRIANGLES],
                                .trace_meshes = start[MASU_BLOB_TRACE_MESHES],
                                .trace_instances = start[MASU_BLOB_TRACE_INSTANCES],
                                .names = start[MASU_BLOB_NAMES],
                                .name_bytes = r->counts[MASU_BLOB_NAMES]};
    for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
        if (!rules[k].code || !start[k]) continue;
        r->view.code[k].words = start[k];
        r->view.code[k].count = r->counts[k];
    }
    return MASU_OK;
}

/* ---- Contents -------------------------------------------------------------------------------- */

/* Culling believes bounds. Two boxes; a point is a box too. */
static int box_holds(const float *low, const float *high, const float *from, const float *to) {
    for (uint32_t k = 0; k < 3; k++) {
        if (!(low[k] <= from[k] && to[k] <= high[k])) return 0;
    }
    return 1;
}

static masu_result check_primitive(reader *r, uint64_t i) {
    const masu_blob_primitive *p = &r->view.primitives[i];
    if (p->index_count % 3) return bad(r, "primitives", i, "index count is no multiple of 3");
    if ((uint64_t)p->first_index + p->index_count > r->counts[MASU_BLOB_INDICES]) {
        return bad(r, "primitives", i, "indices lie outside the index section");
    }
    if (p->vertex_count < 1 || p->vertex_count > 0xFFFFFF) {
        return bad(r, "primitives", i, "vertex count is not 1 to 16,777,215");
    }
    if ((uint64_t)p->first_vertex + p->vertex_count > r->counts[MASU_BLOB_VERTICES]) {
        return bad(r, "primitives", i, "vertices lie outside the vertex section");
    }
    if (p->material >= r->counts[MASU_BLOB_MATERIALS]) {
        return bad(r, "primitives", i, "no such material");
    }
    if (!finite_all(p->aabb_min, 3) || !finite_all(p->aabb_max, 3)) {
        return bad(r, "primitives", i, "bounds are not finite");
    }
    for (uint32_t k = 0; k < p->index_count; k++) {
        uint32_t index = r->view.indices[p->first_index + k];
        if (index >= p->vertex_count) {
            return bad(r, "indices", (uint64_t)p->first_index + k, "points outside its primitive");
        }
        const float *v = r->view.vertices[p->first_vertex + index].position;
        if (!box_holds(p->aabb_min, p->aabb_max, v, v)) {
            return bad(r, "primitives", i, "bounds do not hold its vertices");
        }
    }
    return MASU_OK;
}

static masu_result check_mesh(reader *r, uint64_t i) {
    const masu_blob_mesh *m = &r->view.meshes[i];
    if (!finite_all(m->aabb_min, 3) || !finite_all(m->aabb_max, 3)) {
        return bad(r, "meshes", i, "bounds are not finite");
    }
    for (uint32_t k = 0; k < m->primitive_count; k++) {
        const masu_blob_primitive *p = &r->view.primitives[m->first_primitive + k];
        if (!box_holds(m->aabb_min, m->aabb_max, p->aabb_min, p->aabb_max)) {
            return bad(r, "meshes", i, "bounds do not hold its primitives");
        }
    }
    return name_ok(r, m->name) ? MASU_OK : bad(r, "meshes", i, "name lies outside the names");
}

static masu_result check_lods(reader *r, uint64_t *primitives) {
    const masu_scene_view *v = &r->view;
    uint32_t level = 0;
    if (r->counts[MASU_BLOB_LODS] && r->counts[MASU_BLOB_INSTANCES] > MANY / 4) {
        return bad(r, "lods", 0, "are of over 2^29 instances"); /* listed once for each form */
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_LODS]; i++) {
        const masu_blob_lod *l = &v->lods[i];
        if (l->mesh >= r->counts[MASU_BLOB_MESHES]) return bad(r, "lods", i, "no such mesh");
        const masu_blob_mesh *m = &v->meshes[l->mesh];
        if (i && l->mesh < l[-1].mesh) return bad(r, "lods", i, "not sorted by mesh");
        level = i && l->mesh == l[-1].mesh ? level + 1 : 1;
        if (level > MASU_BLOB_LODS_MAX) return bad(r, "lods", i, "a mesh has more than three");
        if (!(l->error >= 0.0f && l->error <= 1e30f)) {
            return bad(r, "lods", i, "error is negative or not finite");
        }
        if (level > 1 && !(l->error >= l[-1].error)) {
            return bad(r, "lods", i, "error falls from level to level");
        }
        if ((uint64_t)l->first_primitive + m->primitive_count > r->counts[MASU_BLOB_PRIMITIVES]) {
            return bad(r, "lods", i, "primitives lie outside their section");
        }
        *primitives += m->primitive_count;
        if (*primitives > r->counts[MASU_BLOB_PRIMITIVES])
            return bad(r, "lods", i, "shares primitives");
        for (uint32_t p = 0; p < m->primitive_count; p++) {
            const masu_blob_primitive *fine = &v->primitives[m->first_primitive + p];
            const masu_blob_primitive *coarse = &v->primitives[l->first_primitive + p];
            if (coarse->material != fine->material)
                return bad(r, "lods", i, "has another material than its mesh");
            if (coarse->index_count > fine->index_count)
                return bad(r, "lods", i, "has more triangles than its mesh");
            if (!box_holds(m->aabb_min, m->aabb_max, coarse->aabb_min, coarse->aabb_max))
                return bad(r, "lods", i, "reaches out of the bounds of its mesh");
        }
    }
    return MASU_OK;
}

static masu_result check_geometry(reader *r) {
    const masu_scene_view *v = &r->view;
    /* Ranges may not be shared: else a small blob could ask for quadratic work, here and in every
     * frame. */
    uint64_t indices = 0, primitives = 0;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_VERTICES]; i++) {
        if (!finite_all(v->vertices[i].position, 3)) return bad(r, "vertices", i, "is not finite");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_PRIMITIVES]; i++) {
        indices += v->primitives[i].index_count;
        if (indices > r->counts[MASU_BLOB_INDICES])
            return bad(r, "primitives", i, "shares indices");
        masu_result result = check_primitive(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MESHES]; i++) {
        const masu_blob_mesh *m = &v->meshes[i];
        if ((uint64_t)m->first_primitive + m->primitive_count > r->counts[MASU_BLOB_PRIMITIVES]) {
            return bad(r, "meshes", i, "primitives lie outside their section");
        }
        primitives += m->primitive_count;
        if (primitives > r->counts[MASU_BLOB_PRIMITIVES])
            return bad(r, "meshes", i, "shares primitives");
        masu_result result = check_mesh(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_INSTANCES]; i++) {
        const masu_blob_instance *n = &v->instances[i];
        if (!finite_all(n->transform, 12)) return bad(r, "instances", i, "transform is not finite");
        if (n->mesh >= r->counts[MASU_BLOB_MESHES]) return bad(r, "instances", i, "no such mesh");
        if (i && n->mesh < v->instances[i - 1].mesh)
            return bad(r, "instances", i, "not sorted by mesh");
        if (!name_ok(r, n->name)) return bad(r, "instances", i, "name lies outside the names");
        if (n->parent != MASU_BLOB_NONE && n->parent >= r->counts[MASU_BLOB_INSTANCES]) {
            return bad(r, "instances", i, "no such parent");
        }
    }
    return check_lods(r, &primitives);
}

/* Groups lie in the order of a breadth-first walk, and so do their items: the children of the first
 * group, then those of the second, ... That each has one parent, and that none is its own ancestor,
 * follows without a mark for each. */
static masu_result check_group(reader *r, uint64_t i, uint64_t *next_child, uint64_t *next_item) {
    const masu_scene_view *v = &r->view;
    const masu_blob_group *g = &v->groups[i];
    if (i >= *next_child) return bad(r, "groups", i, "is a child of no group before it");
    if (g->child_count &&
        (g->first_child != *next_child ||
         *next_child + g->child_count > r->counts[MASU_BLOB_GROUPS])) {
        return bad(r, "groups", i, "children are not the next in breadth-first order");
    }
    if (g->item_count && (g->first_item != *next_item ||
                          *next_item + g->item_count > r->counts[MASU_BLOB_GROUP_ITEMS])) {
        return bad(r, "groups", i, "items are not the next of the items");
    }
    masu_cull_box box;
    memcpy(box.center, g->center, sizeof box.center);
    memcpy(box.half, g->half, sizeof box.half);
    if (!within(g->center, 3, -MASU_CULL_FAR, MASU_CULL_FAR) ||
        !within(g->half, 3, 0.0f, MASU_CULL_FAR)) {
        return bad(r, "groups", i, "bounds are out of range");
    }
    for (uint32_t k = 0; k < g->child_count; k++) {
        const masu_blob_group *child = &v->groups[g->first_child + k];
        masu_cull_box inner;
        memcpy(inner.center, child->center, sizeof inner.center);
        memcpy(inner.half, child->half, sizeof inner.half);
        if (!masu_cull_holds(&box, &inner)) {
            return bad(r, "groups", i, "bounds do not hold its children");
        }
    }
    for (uint32_t k = 0; k < g->item_count; k++) {
        uint32_t item = v->group_items[g->first_item + k];
        if (item >= r->counts[MASU_BLOB_INSTANCES] || v->instances[item].group != i) {
            return bad(r, "group items", (uint64_t)g->first_item + k,
                       "is no instance of its group");
        }
        if (k && item <= v->group_items[g->first_item + k - 1]) {
            return bad(r, "group items", (uint64_t)g->first_item + k, "does not rise");
        }
        masu_cull_box inner = masu_scene_box(v, item);
        inner = masu_cull_widen(&inner, 1.0f);
        if (!masu_cull_holds(&box, &inner)) {
            return bad(r, "groups", i, "bounds do not hold its instances");
        }
    }
    *next_child += g->child_count;
    *next_item += g->item_count;
    return name_ok(r, g->name) ? MASU_OK : bad(r, "groups", i, "name lies outside the names");
}

static masu_result check_groups(reader *r) {
    uint64_t groups = r->counts[MASU_BLOB_GROUPS], items = r->counts[MASU_BLOB_GROUP_ITEMS];
    if (!groups != !items) return bad(r, "groups", 0, "are there without items, or items alone");
    uint64_t next_child = 1, next_item = 0, level_end = 1, levels = 1, grouped = 0;
    for (uint64_t i = 0; i < groups; i++) {
        if (i == level_end) {
            level_end = next_child;
            if (++levels > MASU_CULL_DEPTH) return bad(r, "groups", i, "is below 64 levels");
        }
        masu_result result = check_group(r, i, &next_child, &next_item);
        if (result) return result;
    }
    if (groups && (next_child != groups || next_item != items)) {
        return bad(r, "group items", next_item, "belongs to no group");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_INSTANCES]; i++) {
        if (r->view.instances[i].group == MASU_BLOB_NONE) continue;
        if (++grouped > items) return bad(r, "instances", i, "its group does not know it");
    }
    return MASU_OK;
}

/* How many pairs of an occluder and an instance of its mesh there are. */
static masu_result check_occluders(reader *r, uint64_t *pairs) {
    const masu_scene_view *v = &r->view;
    uint32_t from = 0, first = 0, end = 0, of_mesh = 0;
    *pairs = 0;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_OCCLUDERS]; i++) {
        const masu_blob_occluder *o = &v->occluders[i];
        if (o->mesh >= r->counts[MASU_BLOB_MESHES]) return bad(r, "occluders", i, "no such mesh");
        if (i && o->mesh < o[-1].mesh) return bad(r, "occluders", i, "not sorted by mesh");
        const masu_blob_mesh *mesh = &v->meshes[o->mesh];
        if (!box_holds(mesh->aabb_min, mesh->aabb_max, o->low, o->high) ||
            !box_holds(o->low, o->high, o->high, o->low)) {
            return bad(r, "occluders", i, "is no box inside of its mesh");
        }
        if (o->lods > MASU_BLOB_LODS_MAX) return bad(r, "occluders", i, "knows more than 3 LODs");
        if (!i || o->mesh != o[-1].mesh) {
            end = masu_scene_mesh_instances(v, (uint32_t)r->counts[MASU_BLOB_INSTANCES], o->mesh,
                                            from, &first);
            from = end;
            of_mesh = 0;
        }
        if (++of_mesh > MASU_BLOB_OCCLUDERS_MAX) return bad(r, "occluders", i, "over 64 in one mesh");
        *pairs += end - first;
        if (*pairs > MANY) return bad(r, "occluders", i, "makes over 2^31 - 1 placed occluders");
    }
    return MASU_OK;
}

/* ---- Textures -------------------------------------------------------------------------------- */

static masu_result check_texture(reader *r, uint64_t i, uint64_t *end) {
    const masu_blob_texture *t = &r->view.textures[i];
    if (!masu_blob_block_bytes(t->format)) return bad(r, "textures", i, "no such format");
    if (t->width < 1 || t->width > MASU_TEXTURE_SIZE_MAX || t->height < 1 ||
        t->height > MASU_TEXTURE_SIZE_MAX) {
        return bad(r, "textures", i, "size is not 1 to 4096");
    }
    uint32_t larger = t->width > t->height ? t->width : t->height, most = 1;
    while (larger >> most) most++;
    if (t->mips < 1 || t->mips > most) return bad(r, "textures", i, "number of mips");
    if (t->layers < 1 || t->layers > MASU_TEXTURE_LAYERS_MAX) {
        return bad(r, "textures", i, "layers are not 1 to 256");
    }
    if (!name_ok(r, t->name)) return bad(r, "textures", i, "name lies outside the names");
    if (t->offset != *end) return bad(r, "textures", i, "does not begin where the last one ends");
    uint64_t bytes = masu_blob_texture_bytes(t); /* at most 2^33 */
    if (bytes > r->counts[MASU_BLOB_TEXELS] * MASU_BLOB_ALIGN - t->offset) {
        return bad(r, "textures", i, "lies outside the texels");
    }
    *end = (t->offset + bytes + MASU_BLOB_ALIGN - 1) / MASU_BLOB_ALIGN * MASU_BLOB_ALIGN;
    return MASU_OK;
}

static int slot_takes(uint32_t slot, uint32_t format) {
    switch (slot) {
    case MASU_SLOT_BASE: return format == MASU_TEXTURE_BC1_SRGB || format == MASU_TEXTURE_BC3_SRGB;
    case MASU_SLOT_NORMAL: return format == MASU_TEXTURE_BC5;
    case MASU_SLOT_SURFACE: return format == MASU_TEXTURE_BC4 || format == MASU_TEXTURE_BC5;
    case MASU_SLOT_OCCLUSION: return format == MASU_TEXTURE_BC4;
    default: return format == MASU_TEXTURE_BC1_SRGB;
    }
}

static masu_result check_texture_set(reader *r, uint64_t i) {
    const masu_blob_texture_set *set = &r->view.texture_sets[i];
    uint32_t given = 0;
    for (uint32_t slot = 0; slot < MASU_SLOT_COUNT; slot++) {
        if (set->texture[slot] == MASU_BLOB_NONE) continue;
        given++;
        if (set->texture[slot] >= r->counts[MASU_BLOB_TEXTURES]) {
            return bad(r, "texture sets", i, "no such texture");
        }
        if (!slot_takes(slot, r->view.textures[set->texture[slot]].format)) {
            return bad(r, "texture sets", i, "a texture's format is not that of its slot");
        }
    }
    if (!given) return bad(r, "texture sets", i, "is empty");
    if (set->wrap[0] > 2 || set->wrap[1] > 2) return bad(r, "texture sets", i, "no such wrapping");
    return MASU_OK;
}

/* The textures that a material names are there, with that layer. */
static masu_result check_maps(reader *r, uint64_t i) {
    const masu_blob_material *m = &r->view.materials[i];
    uint32_t maps = m->flags & MASU_MATERIAL_HAS_MAPS;
    uint32_t alpha = MASU_MATERIAL_HAS_METAL | MASU_MATERIAL_IS_MASK;
    if (m->flags & ~(uint32_t)MASU_MATERIAL_KNOWN) return bad(r, "materials", i, "unknown flags");
    if (!maps) {
        if (m->texture_set || m->layers || m->occlusion_layer || m->flags & alpha) {
            return bad(r, "materials", i, "has no textures, but speaks of them");
        }
        return MASU_OK;
    }
    if (m->texture_set >= r->counts[MASU_BLOB_TEXTURE_SETS]) {
        return bad(r, "materials", i, "no such texture set");
    }
    const masu_blob_texture_set *set = &r->view.texture_sets[m->texture_set];
    for (uint32_t slot = 0; slot < MASU_SLOT_COUNT; slot++) {
        if (!(maps & 1u << slot)) continue;
        if (set->texture[slot] == MASU_BLOB_NONE) {
            return bad(r, "materials", i, "its texture set lacks a texture");
        }
        uint32_t layer = slot == MASU_SLOT_OCCLUSION ? m->occlusion_layer
                                                     : m->layers >> 8 * slot & 0xFF;
        if (layer > 0xFF || layer >= r->view.textures[set->texture[slot]].layers) {
            return bad(r, "materials", i, "no such layer");
        }
    }
    int has_base = maps & 1u << MASU_SLOT_BASE, has_surface = maps & 1u << MASU_SLOT_SURFACE;
    if (m->flags & MASU_MATERIAL_IS_MASK &&
        (!has_base ||
         r->view.textures[set->texture[MASU_SLOT_BASE]].format != MASU_TEXTURE_BC3_SRGB)) {
        return bad(r, "materials", i, "is a mask without alpha");
    }
    if (m->flags & MASU_MATERIAL_HAS_METAL &&
        (!has_surface ||
         r->view.textures[set->texture[MASU_SLOT_SURFACE]].format != MASU_TEXTURE_BC5)) {
        return bad(r, "materials", i, "has no map of metallic");
    }
    return MASU_OK;
}

static masu_result check_textures(reader *r) {
    const masu_scene_view *v = &r->view;
    int some = v->texcoords || v->textures || v->texture_sets || v->texels;
    int all = v->texcoords && v->textures && v->texture_sets && v->texels;
    if (some && !all) return bad(r, "textures", 0, "are there in part");
    if (some && r->counts[MASU_BLOB_TEXCOORDS] != r->counts[MASU_BLOB_VERTICES]) {
        return bad(r, "texture coordinates", r->counts[MASU_BLOB_TEXCOORDS],
                   "are not as many as vertices");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TEXCOORDS]; i++) {
        if (!within(&v->texcoords[2 * i], 2, -MASU_TEXCOORD_MAX, MASU_TEXCOORD_MAX)) {
            return bad(r, "texture coordinates", i, "are not finite or beyond 32768");
        }
    }
    uint64_t end = 0;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TEXTURES]; i++) {
        masu_result result = check_texture(r, i, &end);
        if (result) return result;
    }
    if (end != r->counts[MASU_BLOB_TEXELS] * MASU_BLOB_ALIGN) {
        return bad(r, "texels", end / MASU_BLOB_ALIGN, "belong to no texture");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TEXTURE_SETS]; i++) {
        masu_result result = check_texture_set(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MATERIALS]; i++) {
        masu_result result = check_maps(r, i);
        if (result) return result;
    }
    return MASU_OK;
}

/* ---- Looks ----------------------------------------------------------------------------------- */

static masu_result check_looks(reader *r) {
    const masu_scene_view *v = &r->view;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MATERIALS]; i++) {
        const masu_blob_material *m = &v->materials[i];
        if (!within(m->base_color, 3, 0.0f, 1.0f) || !within(&m->roughness, 1, 0.0f, 1.0f) ||
            !within(&m->metallic, 1, 0.0f, 1.0f) || !within(m->emissive, 3, 0.0f, 1e9f)) {
            return bad(r, "materials", i, "a value is out of range");
        }
        if (!name_ok(r, m->name)) return bad(r, "materials", i, "name lies outside the names");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_CAMERA_KEYS]; i++) {
        const masu_blob_camera_key *k = &v->camera_keys[i];
        /* Times and places that masu_frame would accept, so that the path works as a whole. */
        if (!within(&k->time, 1, -1e15f, 1e15f) || !within(k->position, 3, -1e15f, 1e15f) ||
            !within(k->target, 3, -1e15f, 1e15f)) {
            return bad(r, "camera keys", i, "is not finite or beyond 1e15");
        }
        if (!(k->fov_y >= 0.001f && k->fov_y <= 3.1f)) {
            return bad(r, "camera keys", i, "field of view is not 0.001 to 3.1 radians");
        }
        if (!memcmp(k->position, k->target, sizeof k->position)) {
            return bad(r, "camera keys", i, "position and target are the same");
        }
        if (i && !(k->time > v->camera_keys[i - 1].time)) {
            return bad(r, "camera keys", i, "time does not rise");
        }
    }
    const masu_blob_environment *e = v->environment;
    if (!e) return bad(r, "environment", 0, "is missing");
    float sun = e->sun_direction[0] * e->sun_direction[0] +
                e->sun_direction[1] * e->sun_direction[1] +
                e->sun_direction[2] * e->sun_direction[2];
    if (!(sun > 0.98f && sun < 1.02f))
        return bad(r, "environment", 0, "sun direction is no unit vector");
    if (!within(e->sun_color, 3, 0.0f, 1e9f) || !within(e->ambient, 3, 0.0f, 1e9f) ||
        !within(e->sky_zenith, 3, 0.0f, 1e9f) || !within(e->sky_horizon, 3, 0.0f, 1e9f) ||
        !within(&e->exposure, 1, 1e-9f, 1e9f) || !within(&e->near_distance, 1, 1e-9f, 1e9f)) {
        return bad(r, "environment", 0, "a value is out of range");
    }
    return MASU_OK;
}

static masu_result check_shadow(reader *r) {
    const masu_blob_shadow *s = r->view.shadow;
    if (!s) return MASU_OK;
    if (s->cascades < 1 || s->cascades > MASU_SHADOW_CASCADES_MAX)
        return bad(r, "shadow", 0, "cascades are not 1 to 4");
    if (s->resolution < MASU_SHADOW_SIZE_MIN || s->resolution > MASU_SHADOW_SIZE_MAX)
        return bad(r, "shadow", 0, "resolution is not 16 to 8192");
    if (!within(&s->distance, 1, 1e-3f, 1e9f))
        return bad(r, "shadow", 0, "distance is not 0.001 to 1e9 m");
    if (!within(&s->lambda, 1, 0.0f, 1.0f)) return bad(r, "shadow", 0, "lambda is not 0 to 1");
    return MASU_OK;
}

static masu_result check_sdf(reader *r) {
    const masu_scene_view *v = &r->view;
    if (!v->sdf) {
        int more = v->sdf_params || v->slots;
        for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) more |= v->code[k].words != NULL;
        return more ? bad(r, "sdf", 0, "is missing, but parts of it are there") : MASU_OK;
    }
    const masu_blob_sdf *s = v->sdf;
    for (uint32_t k = 0; k < 3; k++) {
        if (!(s->bounds_min[k] <= s->bounds_max[k]) || !(s->bounds_min[k] >= -1e30f) ||
            !(s->bounds_max[k] <= 1e30f)) {
            return bad(r, "sdf", 0, "bounds are inverted or out of range");
        }
    }
    if (!within(&s->lipschitz, 1, 1e-3f, 1e6f))
        return bad(r, "sdf", 0, "Lipschitz constant is out of range");
    if (!within(&s->max_distance, 1, 1e-6f, 1e30f))
        return bad(r, "sdf", 0, "longest ray is out of range");
    if (s->has_raster != (r->counts[MASU_BLOB_INSTANCES] ? 1u : 0u)) {
        return bad(r, "sdf", 0, "code was compiled for other instances");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_SDF_PARAMS]; i++) {
        const masu_blob_sdf_param *p = &v->sdf_params[i];
        if (!finite_all(&p->value, 1) || !finite_all(&p->minimum, 1) ||
            !finite_all(&p->maximum, 1) || !(p->minimum <= p->value && p->value <= p->maximum)) {
            return bad(r, "sdf parameters", i, "value is outside its range");
        }
        if (!name_ok(r, p->name)) return bad(r, "sdf parameters", i, "name lies outside the names");
    }
    if (s->part_count < 1 || s->part_count > MASU_SDF_PARTS_MAX) {
        return bad(r, "sdf", 0, "part count is not 1 to 4096");
    }
    if (s->anchored > 1) return bad(r, "sdf", 0, "anchored is neither 0 nor 1");
    if (s->has_raster && v->code[MASU_BLOB_FRAGMENT_SPIRV].words) {
        return bad(r, "march_fragment SPIR-V", 0, "is there beside polygons, which it would erase");
    }
    if (!v->slots) return bad(r, "slots", 0, "are missing");
    for (uint64_t i = 0; i < v->slot_count; i++) {
        if (!finite_all(&v->slots[i], 1)) return bad(r, "slots", i, "is not finite");
    }
    for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
        int needed = k == MASU_BLOB_MARCH_SPIRV || k == MASU_BLOB_CLASSIFY_SPIRV ||
                     k == MASU_BLOB_CONE8_SPIRV || k == MASU_BLOB_CONE4_SPIRV ||
                     k == MASU_BLOB_VELOCITY_SPIRV;
        /* The slots of an anchored SDF change with the anchor, if with nothing else. */
        if (k == MASU_BLOB_UPDATE_SPIRV) {
            needed = s->anchored || v->code[MASU_BLOB_UPDATE_PREVIOUS_SPIRV].words;
        } else if (k == MASU_BLOB_UPDATE_PREVIOUS_SPIRV) {
            needed = !s->anchored && v->code[MASU_BLOB_UPDATE_SPIRV].words;
        }
        if (!v->code[k].words && !needed) continue;
        if (!v->code[k].words || v->code[k].count < 5 || v->code[k].words[0] != 0x07230203u) {
            return bad(r, rules[k].name, 0, "is missing or is no SPIR-V");
        }
    }
    return MASU_OK;
}

static void look_at_sdf(const reader *r, masu_scene *out) {
    static const struct {
        uint32_t kind;
        masu_march march;
    } variants[] = {{MASU_BLOB_PLAIN_SPIRV, MASU_MARCH_PLAIN},
                    {MASU_BLOB_FRAGMENT_SPIRV, MASU_MARCH_FRAGMENT},
                    {MASU_BLOB_SEED_SPIRV, MASU_MARCH_SEED},
                    {MASU_BLOB_CHECKERBOARD_SPIRV, MASU_MARCH_CHECKERBOARD}};
    out->sdf_parts = r->view.sdf->part_count;
    out->sdf_slots = (uint32_t)r->counts[MASU_BLOB_SLOTS];
    out->sdf_dynamic = r->view.code[MASU_BLOB_UPDATE_PREVIOUS_SPIRV].words != NULL;
    out->sdf_anchored = r->view.sdf->anchored;
    out->sdf_occlusion = r->view.code[MASU_BLOB_OCCLUSION_SPIRV].words != NULL;
    out->sdf_march = 1u << MASU_MARCH_AUTO | 1u << MASU_MARCH_CONE8 | 1u << MASU_MARCH_CONES |
                     1u << MASU_MARCH_UNPRUNED;
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        if (r->view.code[variants[i].kind].words) out->sdf_march |= 1u << variants[i].march;
    }
}

/* Every form of a mesh has draws of its own, and room for the numbers of its instances. */
static void look_at_draws(const reader *r, masu_scene *out) {
    uint32_t from = 0, first_lod;
    for (uint32_t m = 0; m < out->meshes; m++) {
        uint32_t first, end = masu_scene_mesh_instances(&r->view, out->instances, m, from, &first);
        const masu_blob_mesh *mesh = &r->view.meshes[m];
        uint32_t placed = end - first;
        from = end;
        if (placed > out->most_instances) out->most_instances = placed;
        if (mesh->primitive_count > out->most_primitives)
            out->most_primitives = mesh->primitive_count;
        if (!placed || !mesh->primitive_count) continue;
        uint32_t lods = masu_scene_mesh_lods(&r->view, out->lods, m, &first_lod);
        out->draws += mesh->primitive_count;
        out->lod_draws += lods * mesh->primitive_count;
        out->lod_instances += lods * placed;
        for (uint32_t p = 0; p < mesh->primitive_count; p++) {
            out->triangles += (uint64_t)placed *
                              (r->view.primitives[mesh->first_primitive + p].index_count / 3);
        }
    }
}

masu_result masu_scene_bind(const void *blob, uint64_t blob_bytes, masu_scene *out,
                            masu_detail *detail) {
    if (!blob || !out || (uintptr_t)blob % MASU_BLOB_ALIGN) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "blob", MASU_BLOB_ALIGN, 0,
                         "masu_scene_bind: blob or out is NULL, or blob is not 16-byte aligned");
    }
    reader r = {.bytes = blob, .detail = detail};
    masu_result result = check_header(&r, blob_bytes);
    if (!result) result = read_sections(&r, blob_bytes);
    if (!result && r.view.names && r.view.names[r.view.name_bytes - 1]) {
        result = bad(&r, "names", r.view.name_bytes - 1, "does not end with NUL");
    }
    if (!result) result = check_geometry(&r);
    uint64_t pairs = 0;
    if (!result) result = check_groups(&r);
    if (!result) result = check_occluders(&r, &pairs);
    if (!result) result = check_looks(&r);
    if (!result) result = check_shadow(&r);
    if (!result) result = masu_check_lighting(&r);
    if (!result) result = check_textures(&r);
    if (!result) result = check_sdf(&r);
    if (!result) result = masu_check_trace(&r);
    if (result) return result;
    *out = (masu_scene){.blob = blob,
                        .blob_bytes = blob_bytes,
                        .vertices = (uint32_t)r.counts[MASU_BLOB_VERTICES],
                        .indices = (uint32_t)r.counts[MASU_BLOB_INDICES],
                        .primitives = (uint32_t)r.counts[MASU_BLOB_PRIMITIVES],
                        .meshes = (uint32_t)r.counts[MASU_BLOB_MESHES],
                        .instances = (uint32_t)r.counts[MASU_BLOB_INSTANCES],
                        .lods = (uint32_t)r.counts[MASU_BLOB_LODS],
                        .materials = (uint32_t)r.counts[MASU_BLOB_MATERIALS],
                        .groups = (uint32_t)r.counts[MASU_BLOB_GROUPS],
                        .group_items = (uint32_t)r.counts[MASU_BLOB_GROUP_ITEMS],
                        .occluders = (uint32_t)r.counts[MASU_BLOB_OCCLUDERS],
                        .placed_occluders = (uint32_t)pairs,
                        .camera_keys = (uint32_t)r.counts[MASU_BLOB_CAMERA_KEYS],
                        .sdf = r.view.sdf != NULL,
                        .sdf_params = (uint32_t)r.counts[MASU_BLOB_SDF_PARAMS]};
    if (r.view.sdf) look_at_sdf(&r, out);
    if (r.view.shadow && out->instances) { /* without polygons there is nothing to draw into it */
        out->shadow_cascades = r.view.shadow->cascades;
        out->shadow_resolution = r.view.shadow->resolution;
        out->shadow_distance = r.view.shadow->distance;
        out->shadow_lambda = r.view.shadow->lambda;
    }
    out->texture_arrays = (uint32_t)r.counts[MASU_BLOB_TEXTURES];
    out->texture_sets = (uint32_t)r.counts[MASU_BLOB_TEXTURE_SETS];
    for (uint32_t i = 0; i < out->texture_arrays; i++) {
        const masu_blob_texture *t = &r.view.textures[i];
        out->textures += t->layers;
        out->texture_bytes += masu_blob_texture_bytes(t);
        out->texture_bytes_decoded += masu_texture_bytes(t, 0);
    }
    for (uint32_t i = 0; i < out->materials; i++) {
        if (r.view.materials[i].flags & MASU_MATERIAL_IS_MASK) out->masks = 1;
    }
    masu_look_at_lighting(&r, out);
    masu_look_at_trace(&r, out);
    look_at_draws(&r, out);
    return MASU_OK;
}

/* ---- Accessors ------------------------------------------------------------------------------- */

masu_scene_view masu_scene_look(const masu_scene *scene) {
    reader r = {.bytes = scene->blob};
    (void)read_sections(&r, scene->blob_bytes); /* has passed once on these bytes */
    return r.view;
}

masu_cull_box masu_scene_box(const masu_scene_view *view, uint32_t instance) {
    const masu_blob_instance *n = &view->instances[instance];
    const masu_blob_mesh *mesh = &view->meshes[n->mesh];
    return masu_cull_place(n->transform, mesh->aabb_min, mesh->aabb_max);
}

uint32_t masu_scene_mesh_instances(const masu_scene_view *view, uint32_t instance_count,
                                   uint32_t mesh, uint32_t from, uint32_t *first) {
    while (from < instance_count && view->instances[from].mesh < mesh) from++;
    *first = from;
    while (from < instance_count && view->instances[from].mesh == mesh) from++;
    return from;
}

uint32_t masu_scene_mesh_lods(const masu_scene_view *view, uint32_t lod_count, uint32_t mesh,
                              uint32_t *first) {
    uint32_t low = 0, high = lod_count;
    while (low < high) { /* the first that is not below */
        uint32_t middle = low + (high - low) / 2;
        if (view->lods[middle].mesh < mesh)
            low = middle + 1;
        else
            high = middle;
    }
    *first = low;
    while (high < lod_count && view->lods[high].mesh == mesh) high++;
    return high - low;
}

int32_t masu_scene_sdf_param(const masu_scene *scene, const char *name) {
    if (!scene || !name) return -1;
    masu_scene_view v = masu_scene_look(scene);
    for (uint32_t i = 0; i < scene->sdf_params; i++) {
        if (v.sdf_params[i].name != MASU_BLOB_NONE &&
            !strcmp(v.names + v.sdf_params[i].name, name)) {
            return (int32_t)i;
        }
    }
    return -1;
}
