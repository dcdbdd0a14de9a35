/* gltf_mesh.c: converts primitives of a glTF file to aiMeshes; see gltf.h.
 *
 * COLOR_0 becomes materials where possible (vertex_color.h), else vertex colours.
 *
 * Morph targets of animated models become aiAnimMeshes; in other models the weights of the rest
 * pose are applied. If normals are missing, faces are flat, as glTF requires. */
#include "bake/import/gltf.h"
#include "bake/import/vertex_color.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VERTICES_MAX ((uint32_t)INT32_MAX / 4)
#define JOINT_SETS 4

/* The vertices of a primitive, `count` of each; NULL: absent. */
typedef struct vertices {
    uint32_t count;
    float *positions, *normals, *texcoords, *second, *colors; /* colors: 4 each */
    uint32_t *joints[JOINT_SETS];                    /* 4 each, as are weights */
    float *weights[JOINT_SETS];
    uint32_t *indices;
    uint64_t index_count;
    struct target *targets; /* of an animated model */
    uint32_t target_count;
} vertices;

/* The differences of a morph target; NULL: none. */
typedef struct target {
    float *positions, *normals;
} target;

typedef struct source {
    const json_t *primitive, *attributes, *packed; /* packed: Draco's attributes, or NULL */
    masu_gltf_draco draco;
    const char *name; /* of the mesh */
} source;

/* ---- attributes ---- */

static bool unpacked_id(masu_gltf *g, const source *s, const char *name, json_int_t *id) {
    *id = -1;
    return !s->packed || masu_gltf_index(g, s->packed, name, 1u << 30, id);
}

/* An attribute with fewer elements than there are positions is dropped. components: least, most.
 * NULL without failure: absent. */
static float *attribute(masu_gltf *g, const source *s, const char *name, unsigned least,
                        unsigned most, uint32_t wanted, uint32_t *count, unsigned *components) {
    json_int_t index = -1, id = -1;
    float *out = NULL;
    if (!masu_gltf_index(g, s->attributes, name, masu_gltf_count(g, "accessors"), &index) ||
        !unpacked_id(g, s, name, &id) || (index < 0 && id < 0))
        return NULL;
    if (id >= 0) {
        *components = masu_gltf_draco_components(&s->draco, (uint32_t)id);
        *count = s->draco.points;
        if (*components) out = masu_gltf_take(g, *count, *components * sizeof *out);
        if (!out || !masu_gltf_draco_floats(&s->draco, (uint32_t)id, *components, out)) {
            masu_gltf_fail(g, "KHR_draco_mesh_compression: no attribute %d for %s", (int)id, name);
            return NULL;
        }
    } else if (!(out = masu_gltf_floats(g, index, 0, count, components))) {
        return NULL;
    }
    if (*components < least || *components > most) {
        masu_gltf_fail(g, "%s has %u components", name, *components);
        return NULL;
    }
    if (wanted && *count < wanted) {
        char what[96];
        snprintf(what, sizeof what, "primitives have fewer %.32s than positions: left out", name);
        masu_gltf_note_one(g, what, s->name);
        return NULL;
    }
    return out;
}

static bool read_colors(masu_gltf *g, const source *s, vertices *v) {
    uint32_t count;
    unsigned n = 0;
    float *from = attribute(g, s, "COLOR_0", 3, 4, v->count, &count, &n);
    if (!from || n == 4) {
        v->colors = from;
        return !masu_gltf_failed(g);
    }
    v->colors = masu_gltf_take(g, v->count, 4 * sizeof(float));
    for (size_t i = 0; i < v->count; i++) {
        memcpy(v->colors + 4 * i, from + 3 * i, 3 * sizeof(float));
        v->colors[4 * i + 3] = 1;
    }
    return true;
}

static bool read_joints(masu_gltf *g, const source *s, vertices *v) {
    for (int set = 0; set < JOINT_SETS; set++) {
        char joints[16], weights[16];
        uint32_t count;
        unsigned n = 0;
        snprintf(joints, sizeof joints, "JOINTS_%d", set);
        snprintf(weights, sizeof weights, "WEIGHTS_%d", set);
        float *by = attribute(g, s, weights, 4, 4, v->count, &count, &n);
        float *of = by ? attribute(g, s, joints, 4, 4, v->count, &count, &n) : NULL;
        if (masu_gltf_failed(g)) return false;
        if (!by || !of) break;
        v->weights[set] = by;
        v->joints[set] = masu_gltf_take(g, v->count, 4 * sizeof(uint32_t));
        for (size_t i = 0; i < (size_t)v->count * 4; i++)
            v->joints[set][i] = of[i] >= 0 && of[i] < 65536 ? (uint32_t)of[i] : UINT32_MAX;
    }
    return true;
}

/* Texture coordinates with the material's transform applied. */
static bool read_texcoords(masu_gltf *g, const source *s, const masu_gltf_material *material,
                           vertices *v) {
    char name[16];
    uint32_t count;
    unsigned n = 0;
    const double *uv = material->uv;
    bool grained = material->given.material.anisotropy > 0; /* along u */
    if (g->wanted != MASU_BAKE_TEXTURES_FORCED && !grained &&
        !masu_bake_has_maps(&material->given.maps))
        return true;
    for (int set = 0; set < (material->given.maps.second ? 2 : 1) && !masu_gltf_failed(g); set++) {
        snprintf(name, sizeof name, "TEXCOORD_%d", set ? material->second_set : material->set);
        if (set) uv = material->second_uv;
        float *at = attribute(g, s, name, 2, 2, v->count, &count, &n);
        for (size_t i = 0; at && i < v->count; i++) {
            double a = (double)at[2 * i], b = (double)at[2 * i + 1];
            at[2 * i] = (float)(uv[0] * a + uv[1] * b + uv[2]);
            at[2 * i + 1] = (float)(uv[3] * a + uv[4] * b + uv[5]);
        }
        *(set ? &v->second : &v->texcoords) = at;
    }
    return !masu_gltf_failed(g);
}

/* Notes the attributes that are ignored. Tangents follow from coordinates and normals. */
static void note_attributes(masu_gltf *g, const source *s, const masu_gltf_material *material,
                            bool skinned) {
    const char *key;
    json_t *value;
    char used[16];
    snprintf(used, sizeof used, "TEXCOORD_%d", material->set);
    json_object_foreach((json_t *)(uintptr_t)s->attributes, key, value) {
        char what[96];
        bool joints = strncmp(key, "JOINTS_", 7) == 0 || strncmp(key, "WEIGHTS_", 8) == 0;
        if (!strcmp(key, "POSITION") || !strcmp(key, "NORMAL") || !strcmp(key, "TANGENT") ||
            !strcmp(key, "COLOR_0") || !strncmp(key, "TEXCOORD_", 9) ||
            !strncmp(key, "_FEATURE_ID_", 12) ||
            (joints && skinned && strtol(strchr(key, '_') + 1, NULL, 10) < JOINT_SETS))
            continue;
        snprintf(what, sizeof what, "primitives have %.48s, which is not supported", key);
        masu_gltf_note_one(g, what, s->name);
    }
}

/* ---- morph targets ---- */

static bool keeps_targets(const masu_gltf *g) {
    return g->moving || (g->plays && masu_gltf_count(g, "animations"));
}

static bool keep_target(masu_gltf *g, const source *s, const source *from, vertices *v,
                        size_t count, size_t t) {
    uint32_t found;
    unsigned n = 0;
    if (count > MASU_BLOB_MORPH_TARGETS_MAX) {
        masu_gltf_note_one(g, "primitives have more than 1024 morph targets: ignored", s->name);
        return true;
    }
    if (!v->targets) v->targets = masu_gltf_take(g, count, sizeof *v->targets);
    v->target_count = (uint32_t)count;
    v->targets[t].positions = attribute(g, from, "POSITION", 3, 3, v->count, &found, &n);
    if (v->normals && !masu_gltf_failed(g))
        v->targets[t].normals = attribute(g, from, "NORMAL", 3, 3, v->count, &found, &n);
    return !masu_gltf_failed(g);
}

static bool morph(masu_gltf *g, const source *s, const json_t *weights, vertices *v) {
    const json_t *targets = masu_gltf_array(g, s->primitive, "targets");
    for (size_t t = 0; t < json_array_size(targets); t++) {
        static const char *const names[] = {"POSITION", "NORMAL"};
        float *const to[] = {v->positions, v->normals};
        double weight = json_number_value(json_array_get(weights, t));
        source target = {.attributes = json_array_get(targets, t), .name = s->name};
        if (keeps_targets(g)) {
            if (!keep_target(g, s, &target, v, json_array_size(targets), t)) return false;
            weight = 0;
        }
        if (weight != 0) for (int a = 0; a < 2 && to[a]; a++) {
            uint32_t count;
            unsigned n = 0;
            const float *from = attribute(g, &target, names[a], 3, 3, v->count, &count, &n);
            for (size_t i = 0; from && i < (size_t)v->count * 3; i++)
                to[a][i] = (float)((double)to[a][i] + weight * (double)from[i]);
        }
        if (json_object_get(target.attributes, "COLOR_0") ||
            json_object_get(target.attributes, "TEXCOORD_0"))
            masu_gltf_note_one(
                g, "morph targets change colours or texture coordinates, which is not supported",
                s->name);
    }
    return !masu_gltf_failed(g);
}

/* ---- triangles ---- */

static bool read_indices(masu_gltf *g, const source *s, vertices *v) {
    json_int_t index = -1;
    uint32_t count = 0;
    if (s->packed) {
        v->index_count = (uint64_t)s->draco.faces * 3;
        v->indices = masu_gltf_take(g, v->index_count + 1, sizeof *v->indices);
        masu_gltf_draco_indices(&s->draco, v->indices);
        return true;
    }
    if (!masu_gltf_index(g, s->primitive, "indices", masu_gltf_count(g, "accessors"), &index))
        return false;
    if (index >= 0) {
        v->indices = masu_gltf_integers(g, index, 1, &count);
        v->index_count = count;
        return v->indices != NULL;
    }
    v->indices = masu_gltf_take(g, v->count, sizeof *v->indices);
    v->index_count = v->count;
    for (uint32_t i = 0; i < v->count; i++) v->indices[i] = i;
    return true;
}

/* Converts strips (5) and fans (6) to lists. */
static void unroll(masu_gltf *g, unsigned mode, vertices *v) {
    if (mode == 4) return;
    uint64_t triangles = v->index_count < 3 ? 0 : v->index_count - 2;
    uint32_t *out = masu_gltf_take(g, triangles * 3 + 1, sizeof *out);
    for (uint64_t i = 0; i < triangles; i++) {
        out[3 * i] = mode == 5 ? v->indices[i + (i & 1)] : v->indices[0];
        out[3 * i + 1] = mode == 5 ? v->indices[i + 1 - (i & 1)] : v->indices[i + 1];
        out[3 * i + 2] = v->indices[i + 2];
    }
    v->indices = out;
    v->index_count = triangles * 3;
}

static void *spread(masu_gltf *g, const vertices *v, const void *from, size_t bytes) {
    if (!from) return NULL;
    unsigned char *out = masu_gltf_take(g, v->index_count, bytes);
    for (uint64_t i = 0; i < v->index_count; i++) {
        if (v->indices[i] < v->count)
            memcpy(out + i * bytes, (const unsigned char *)from + v->indices[i] * bytes, bytes);
    }
    return out;
}

/* The normals of the morphed faces minus the base normals. */
static void flatten_target(masu_gltf *g, const vertices *v, target *to) {
    if (!to->positions) return;
    to->normals = masu_gltf_take(g, v->count, 12);
    for (uint32_t i = 0; i + 3 <= v->count; i += 3) {
        masu_bake_vec3 p[3], from = masu_bake_v3f(v->normals + 3 * (size_t)i);
        for (int k = 0; k < 3; k++)
            p[k] = masu_bake_mad(masu_bake_v3f(v->positions + 3 * ((size_t)i + (size_t)k)),
                                 masu_bake_v3f(to->positions + 3 * ((size_t)i + (size_t)k)), 1);
        masu_bake_vec3 n = masu_bake_cross(masu_bake_sub(p[1], p[0]), masu_bake_sub(p[2], p[0]));
        if (!masu_bake_normalize(&n)) n = from;
        for (int k = 0; k < 3; k++)
            masu_bake_store(masu_bake_sub(n, from), to->normals + 3 * ((size_t)i + (size_t)k));
    }
}

/* Gives each corner a separate vertex with the normal of its face. Indices that are out of range
 * remain so. */
static void flatten(masu_gltf *g, vertices *v) {
    vertices out = *v;
    if (v->normals || !v->index_count || v->index_count > VERTICES_MAX) return;
    out.count = (uint32_t)v->index_count;
    out.positions = spread(g, v, v->positions, 12);
    out.texcoords = spread(g, v, v->texcoords, 8);
    out.second = spread(g, v, v->second, 8);
    out.colors = spread(g, v, v->colors, 16);
    for (int set = 0; set < JOINT_SETS; set++) {
        out.joints[set] = spread(g, v, v->joints[set], 16);
        out.weights[set] = spread(g, v, v->weights[set], 16);
    }
    out.normals = masu_gltf_take(g, out.count, 12);
    out.indices = masu_gltf_take(g, out.count, sizeof *out.indices);
    for (uint32_t i = 0; i < out.count; i++)
        out.indices[i] = v->indices[i] < v->count ? i : UINT32_MAX;
    for (uint32_t i = 0; i + 3 <= out.count; i += 3) {
        const float *p = out.positions + 3 * (size_t)i;
        masu_bake_vec3 a = masu_bake_v3f(p);
        masu_bake_vec3 n = masu_bake_cross(masu_bake_sub(masu_bake_v3f(p + 3), a),
                                           masu_bake_sub(masu_bake_v3f(p + 6), a));
        /* a triangle without area is dropped later */
        if (!masu_bake_normalize(&n)) n = masu_bake_v3(0, 1, 0);
        for (int k = 0; k < 3; k++) masu_bake_store(n, out.normals + 3 * ((size_t)i + (size_t)k));
    }
    if (v->target_count) out.targets = masu_gltf_take(g, v->target_count, sizeof *out.targets);
    for (uint32_t t = 0; t < v->target_count; t++) {
        out.targets[t].positions = spread(g, v, v->targets[t].positions, 12);
        flatten_target(g, &out, &out.targets[t]);
    }
    *v = out;
}

/* ---- aiMeshes ---- */

static void add_bones(masu_gltf *g, const vertices *v, json_int_t skin, struct aiMesh *mesh,
                      const char *name) {
    const json_t *joints = json_object_get(masu_gltf_element(g, "skins", skin), "joints");
    unsigned count = (unsigned)json_array_size(joints);
    uint32_t *sums = masu_gltf_take(g, count + 1, sizeof *sums), matrices = 0;
    json_int_t inverse = -1;
    const float *bind = NULL;
    if (!masu_gltf_index(g, masu_gltf_element(g, "skins", skin), "inverseBindMatrices",
                         masu_gltf_count(g, "accessors"), &inverse))
        return;
    if (inverse >= 0 && !(bind = masu_gltf_floats(g, inverse, 16, &matrices, NULL))) return;
    if (inverse >= 0 && matrices < count) {
        masu_gltf_fail(g, "skins[%lld] has %u joints and %u matrices", (long long)skin, count,
                       matrices);
        return;
    }
    uint64_t lost = 0;
    for (int set = 0; set < JOINT_SETS && v->joints[set]; set++) {
        for (size_t i = 0; i < (size_t)v->count * 4; i++) {
            if (!(v->weights[set][i] > 0)) continue;
            if (v->joints[set][i] < count)
                sums[v->joints[set][i]]++;
            else
                lost++;
        }
    }
    if (lost)
        masu_gltf_note_many(g, lost, "weights are of joints that a skin has not: left out", name);
    mesh->mBones = masu_gltf_take(g, count, sizeof *mesh->mBones);
    mesh->mNumBones = count;
    struct aiBone *bones = masu_gltf_take(g, count, sizeof *bones);
    for (unsigned b = 0; b < count; b++) {
        /* check_skins has checked it */
        uint64_t node = (uint64_t)json_integer_value(json_array_get(joints, b));
        struct aiMatrix4x4 *t = &bones[b].mOffsetMatrix;
        bones[b].mName = g->nodes[node].mName;
        bones[b].mWeights = masu_gltf_take(g, sums[b], sizeof *bones[b].mWeights);
        const float *m = bind ? bind + 16 * (size_t)b : NULL;
        *t = m ? (struct aiMatrix4x4){m[0], m[4], m[8],  m[12], m[1], m[5], m[9],  m[13],
                                      m[2], m[6], m[10], m[14], 0,    0,    0,     1}
               : (struct aiMatrix4x4){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        mesh->mBones[b] = &bones[b];
    }
    for (int set = 0; set < JOINT_SETS && v->joints[set]; set++) {
        for (size_t i = 0; i < (size_t)v->count * 4; i++) {
            uint32_t b = v->joints[set][i];
            if (!(v->weights[set][i] > 0) || b >= count) continue;
            bones[b].mWeights[bones[b].mNumWeights++] =
                (struct aiVertexWeight){(unsigned)(i / 4), v->weights[set][i]};
        }
    }
}

/* Adds a mesh with the triangles of `list` (NULL: all). */
static unsigned add_mesh(masu_gltf *g, const vertices *v, const struct aiMesh *like,
                         const uint32_t *list, uint32_t triangles, unsigned material) {
    struct aiMesh *mesh = masu_gltf_take(g, 1, sizeof *mesh);
    *mesh = *like;
    mesh->mMaterialIndex = material;
    mesh->mFaces = masu_gltf_take(g, triangles, sizeof *mesh->mFaces);
    mesh->mNumFaces = triangles;
    for (uint32_t i = 0; i < triangles; i++) {
        mesh->mFaces[i].mNumIndices = 3;
        mesh->mFaces[i].mIndices = v->indices + 3 * (size_t)(list ? list[i] : i);
    }
    masu_bake_append(&g->meshes, &mesh, sizeof mesh);
    return (unsigned)(g->meshes.bytes / sizeof mesh - 1);
}

/* Adds a mesh for each colour, or one with vertex colours. */
static void add_parts(masu_gltf *g, const vertices *v, const struct aiMesh *like,
                      json_int_t material, uint32_t triangles, masu_bake_buffer *numbers,
                      const char *name) {
    masu_import_colors colors;
    bool blends = g->materials[material < 0 ? g->material_count : (size_t)material].blends;
    masu_import_group_colors(&g->pool, v->colors, v->count, v->indices, triangles, !blends,
                             &colors);
    if (colors.clamped) masu_gltf_note_many(g, colors.clamped, MASU_IMPORT_COLORS_CLAMPED, name);
    if (!colors.exact) {
        static const double white[4] = {1, 1, 1, 1};
        struct aiMesh colored = *like;
        int how = colors.translucent ? MASU_BAKE_COLORED_ALPHA : MASU_BAKE_COLORED;
        colored.mColors[0] = (struct aiColor4D *)(void *)v->colors;
        unsigned number =
            add_mesh(g, v, &colored, NULL, triangles, masu_gltf_given(g, material, white, how));
        masu_bake_append(numbers, &number, sizeof number);
    }
    for (uint32_t i = 0; i < colors.count; i++) {
        const masu_import_color *c = &colors.groups[i];
        unsigned number = add_mesh(g, v, like, colors.triangles + c->first, c->count,
                                   masu_gltf_given(g, material, c->color, MASU_BAKE_COLORED_NOT));
        masu_bake_append(numbers, &number, sizeof number);
    }
}

/* Assimp stores absolute values, not differences. */
static struct aiVector3D *moved(masu_gltf *g, const float *base, const float *delta,
                                uint32_t count) {
    float *to = masu_gltf_take(g, count, 12);
    if (!base) return NULL;
    for (size_t i = 0; i < (size_t)count * 3; i++) to[i] = base[i] + (delta ? delta[i] : 0);
    return (struct aiVector3D *)(void *)to;
}

static void add_targets(masu_gltf *g, const vertices *v, const json_t *mesh, const json_t *weights,
                        struct aiMesh *to) {
    const json_t *names = json_object_get(json_object_get(mesh, "extras"), "targetNames");
    to->mNumAnimMeshes = v->target_count;
    to->mAnimMeshes = masu_gltf_take(g, v->target_count, sizeof *to->mAnimMeshes);
    for (uint32_t t = 0; t < v->target_count; t++) {
        struct aiAnimMesh *made = to->mAnimMeshes[t] = masu_gltf_take(g, 1, sizeof *made);
        const char *name = json_string_value(json_array_get(names, t));
        masu_gltf_set_string(&made->mName, name ? name : "");
        made->mNumVertices = v->count;
        made->mVertices = moved(g, v->positions, v->targets[t].positions, v->count);
        made->mNormals = moved(g, v->normals, v->targets[t].normals, v->count);
        made->mWeight = (float)json_number_value(json_array_get(weights, t));
    }
}

static bool add_primitive(masu_gltf *g, const vertices *v, json_int_t material, json_int_t skin,
                          const json_t *owner, const json_t *weights, masu_bake_buffer *numbers,
                          const char *name) {
    static const double white[4] = {1, 1, 1, 1};
    struct aiMesh like = {.mNumVertices = v->count,
                          .mVertices = (struct aiVector3D *)(void *)v->positions,
                          .mNormals = (struct aiVector3D *)(void *)v->normals};
    masu_gltf_set_string(&like.mName, name);
    if (v->index_count / 3 > VERTICES_MAX || v->count > VERTICES_MAX)
        return masu_gltf_fail(g, "more than 2^29 vertices or triangles");
    uint32_t triangles = (uint32_t)(v->index_count / 3);
    if (!triangles) return true;
    for (int set = 0; set < 2; set++) {
        const float *from = set ? v->second : v->texcoords;
        struct aiVector3D *to = from ? masu_gltf_take(g, v->count, sizeof *to) : NULL;
        for (size_t i = 0; to && i < v->count; i++)
            to[i] = (struct aiVector3D){from[2 * i], from[2 * i + 1], 0};
        like.mTextureCoords[set] = to;
    }
    if (skin >= 0 && v->joints[0]) add_bones(g, v, skin, &like, name);
    if (v->target_count && !masu_gltf_failed(g)) add_targets(g, v, owner, weights, &like);
    if (masu_gltf_failed(g)) return false;
    if (v->colors) {
        add_parts(g, v, &like, material, triangles, numbers, name);
        return true;
    }
    unsigned number = add_mesh(g, v, &like, NULL, triangles,
                               masu_gltf_given(g, material, white, MASU_BAKE_COLORED_NOT));
    masu_bake_append(numbers, &number, sizeof number);
    return true;
}

/* ---- primitives ---- */

static bool material_of(masu_gltf *g, const json_t *primitive, json_int_t *material) {
    const json_t *about = masu_gltf_extension(g, primitive, "KHR_materials_variants");
    const json_t *mappings = about ? masu_gltf_array(g, about, "mappings") : NULL;
    if (!masu_gltf_index(g, primitive, "material", g->material_count, material)) return false;
    for (size_t i = 0; g->variant && i < json_array_size(mappings); i++) {
        const json_t *mapping = json_array_get(mappings, i);
        const json_t *variants = masu_gltf_array(g, mapping, "variants");
        for (size_t k = 0; k < json_array_size(variants); k++) {
            const json_t *variant = json_array_get(variants, k);
            if (!json_is_integer(variant) || json_integer_value(variant) != g->variant_index)
                continue;
            return masu_gltf_index(g, mapping, "material", g->material_count, material);
        }
    }
    return !masu_gltf_failed(g);
}

static bool open_draco(masu_gltf *g, source *s) {
    const json_t *about = masu_gltf_extension(g, s->primitive, "KHR_draco_mesh_compression");
    json_int_t view = -1;
    masu_gltf_bytes bytes;
    size_t stride;
    if (!about) return !masu_gltf_failed(g);
    if (!masu_gltf_index(g, about, "bufferView", g->view_count, &view)) return false;
    s->packed = masu_gltf_object(g, about, "attributes");
    if (view < 0 || !s->packed)
        return masu_gltf_fail(g, "KHR_draco_mesh_compression lacks a member");
    if (!masu_gltf_view(g, view, &bytes, &stride)) return false;
    return masu_gltf_draco_open(bytes.data, bytes.bytes, &s->draco) ||
           masu_gltf_fail(g, "KHR_draco_mesh_compression: the bytes are damaged");
}

static bool read_primitive(masu_gltf *g, source *s, unsigned mode, json_int_t skin,
                           const json_t *owner, const json_t *weights, masu_bake_buffer *numbers) {
    vertices v = {0};
    json_int_t chosen = -1;
    unsigned n = 0;
    uint32_t count;
    if (!material_of(g, s->primitive, &chosen) || !open_draco(g, s)) return false;
    const masu_gltf_material *material =
        &g->materials[chosen < 0 ? g->material_count : (size_t)chosen];
    v.positions = attribute(g, s, "POSITION", 3, 3, 0, &v.count, &n);
    if (masu_gltf_failed(g)) return false;
    if (!v.positions) {
        masu_gltf_note_one(g, "primitives have no positions: skipped", s->name);
        return true;
    }
    v.normals = attribute(g, s, "NORMAL", 3, 3, v.count, &count, &n);
    note_attributes(g, s, material, skin >= 0);
    if (masu_gltf_failed(g) || !read_texcoords(g, s, material, &v) || !read_colors(g, s, &v) ||
        (skin >= 0 && !read_joints(g, s, &v)) || !morph(g, s, weights, &v) ||
        !read_indices(g, s, &v))
        return false;
    unroll(g, s->packed ? 4 : mode, &v);
    flatten(g, &v);
    return add_primitive(g, &v, chosen, skin, owner, weights, numbers, s->name);
}

static bool read_mesh(masu_gltf *g, const json_t *mesh, size_t index, json_int_t skin,
                      const json_t *weights, masu_gltf_made *made) {
    masu_gltf_at(g, "meshes", index, mesh);
    const json_t *primitives = masu_gltf_array(g, mesh, "primitives");
    masu_bake_buffer numbers = {0};
    const char *name = masu_gltf_name_of(g, "meshes", index, mesh);
    for (size_t i = 0; i < json_array_size(primitives) && !masu_gltf_failed(g); i++) {
        source s = {.primitive = json_array_get(primitives, i), .name = name};
        uint64_t mode = 4;
        s.attributes = masu_gltf_object(g, s.primitive, "attributes");
        if (!masu_gltf_size(g, s.primitive, "mode", &mode)) break;
        if (mode < 4) {
            masu_gltf_note_one(
                g, mode ? "primitives are lines: skipped" : "primitives are points: skipped", name);
        } else if (mode > 6 || !s.attributes) {
            masu_gltf_fail(g, "primitives[%zu] has no attributes or an unknown mode", i);
        } else {
            read_primitive(g, &s, (unsigned)mode, skin, mesh, weights, &numbers);
            masu_gltf_draco_close(&s.draco);
        }
    }
    made->count = (unsigned)(numbers.bytes / sizeof(unsigned));
    unsigned *kept = masu_gltf_take(g, made->count, sizeof *kept);
    if (made->count) memcpy(kept, numbers.data, numbers.bytes);
    made->meshes = kept;
    masu_bake_release(&numbers);
    g->where[0] = masu_gltf_failed(g) ? g->where[0] : '\0';
    return !masu_gltf_failed(g);
}

bool masu_gltf_make_mesh(masu_gltf *g, json_int_t index, json_int_t skin, const json_t *weights,
                         const masu_gltf_made **out) {
    const json_t *mesh = masu_gltf_element(g, "meshes", index);
    if (!mesh) return false;
    for (const masu_gltf_made *m = g->made[index]; m; m = m->next) {
        if (m->skin == skin &&
            (m->weights == weights || (weights && m->weights && json_equal(m->weights, weights)))) {
            *out = m;
            return true;
        }
    }
    masu_gltf_made *made = masu_gltf_take(g, 1, sizeof *made);
    *made = (masu_gltf_made){.next = g->made[index], .skin = skin, .weights = weights};
    g->made[index] = made;
    *out = made;
    return read_mesh(g, mesh, (size_t)index, skin,
                     weights ? weights : masu_gltf_array(g, mesh, "weights"), made);
}
