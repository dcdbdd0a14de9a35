/* assimp_skin.c: converts nodes, bones and animations to nodes, skins and clips; see assimp.h.
 *
 * A mesh with bones is kept in its bind pose. Each node that shows it gets its own copy: an
 * instance at the file's origin. As in glTF, only the joints determine the vertex positions. The
 * stored vertices are in the rest pose, for programs that use the scene before any animation. */
#include "bake/import/assimp.h"
#include "scene/skin.h"

#include <stdlib.h>
#include <string.h>

#define JOINTS_MAX 65536u
#define NODES(m) ((masu_import_node *)(void *)(m)->nodes.data)

static uint32_t node_count(const masu_import *m) {
    return (uint32_t)(m->nodes.bytes / sizeof(masu_import_node));
}

bool masu_import_is_live(const struct aiScene *s, bool moving) {
    bool live = moving && s->mAnimations && s->mNumAnimations;
    for (unsigned i = 0; s->mMeshes && i < s->mNumMeshes; i++)
        live = live || (s->mMeshes[i] &&
                        (s->mMeshes[i]->mNumBones || (moving && s->mMeshes[i]->mNumAnimMeshes)));
    return live;
}

/* The morph targets of a mesh if the model is animated; else 0. */
static unsigned target_count(const masu_import *m, const struct aiMesh *mesh) {
    unsigned count = m->moving && mesh->mAnimMeshes ? mesh->mNumAnimMeshes : 0;
    return count < MASU_BLOB_MORPH_TARGETS_MAX ? count : MASU_BLOB_MORPH_TARGETS_MAX;
}

bool masu_import_bends(const masu_import *m, unsigned mesh) {
    const struct aiMesh *source = m->source->mMeshes[mesh];
    if (!m->live || !source || source->mNumBones >= JOINTS_MAX) return false;
    return (source->mBones && source->mNumBones) || target_count(m, source);
}

/* ---- Influences ------------------------------------------------------------------------------ */

/* The largest four of a vertex, largest first. */
typedef struct four {
    uint16_t bones[4];
    double weights[4];
    unsigned count; /* the count before the selection */
} four;

static void add_weight(four *f, unsigned bone, double weight) {
    int k = 3;
    f->count++;
    if (!(weight > f->weights[3])) return;
    for (; k > 0 && weight > f->weights[k - 1]; k--) {
        f->weights[k] = f->weights[k - 1];
        f->bones[k] = f->bones[k - 1];
    }
    f->weights[k] = weight;
    f->bones[k] = (uint16_t)bone;
}

/* The weights sum to 65535; the largest one absorbs the rounding error. A vertex without weights
 * gets a joint behind the last bone. */
static masu_bake_influence quantised(const four *f, unsigned bones) {
    masu_bake_influence out = {{(uint16_t)bones, 0, 0, 0}, {65535, 0, 0, 0}, 0};
    double sum = 0;
    unsigned left = 65535;
    for (int k = 0; k < 4; k++) sum += f->weights[k];
    if (!(sum > 0 && isfinite(sum))) return out;
    for (int k = 0; k < 4; k++) {
        out.weights[k] = (uint16_t)(f->weights[k] / sum * 65535.0);
        out.joints[k] = out.weights[k] ? f->bones[k] : 0;
        left -= out.weights[k];
    }
    out.weights[0] = (uint16_t)(out.weights[0] + left);
    out.joints[0] = f->bones[0];
    return out;
}

static masu_bake_influence *influences_of(masu_import *m, const struct aiMesh *mesh) {
    four *all = masu_bake_allocate((size_t)mesh->mNumVertices * sizeof *all);
    memset(all, 0, (size_t)mesh->mNumVertices * sizeof *all);
    for (unsigned b = 0; b < mesh->mNumBones; b++) {
        const struct aiBone *bone = mesh->mBones[b];
        for (unsigned w = 0; bone && bone->mWeights && w < bone->mNumWeights; w++) {
            double weight = (double)bone->mWeights[w].mWeight;
            if (bone->mWeights[w].mVertexId >= mesh->mNumVertices) continue;
            if (weight > 0 && weight < 1e30)
                add_weight(&all[bone->mWeights[w].mVertexId], b, weight);
        }
    }
    masu_bake_influence *out = masu_bake_allocate((size_t)mesh->mNumVertices * sizeof *out);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        out[i] = quantised(&all[i], mesh->mNumBones);
        m->crowded += all[i].count > 4;
        m->unbound += all[i].count == 0 && mesh->mNumBones;
        if (target_count(m, mesh)) out[i].source = i;
    }
    free(all);
    return out;
}

void masu_import_bent_mesh(masu_import *m, const struct aiMesh *mesh,
                           masu_bake_triangles *triangles, masu_bake_losses *lost) {
    masu_bake_influence *influences = influences_of(m, mesh);
    triangles->influences = influences;
    triangles->bent = &m->influences;
    if (!masu_bake_add_triangles(&m->bent, triangles, lost)) m->full = true;
    free(influences);
}

/* ---- Skins ----------------------------------------------------------------------------------- */

static masu_bake_affine affine_of(const struct aiMatrix4x4 *t) {
    const ai_real rows[12] = {t->a1, t->a2, t->a3, t->a4, t->b1, t->b2,
                              t->b3, t->b4, t->c1, t->c2, t->c3, t->c4};
    masu_bake_affine a;
    for (int i = 0; i < 12; i++) a.m[i] = (double)rows[i];
    return a;
}

static uint32_t find_node(const masu_import *m, const struct aiString *name) {
    int length = masu_import_length(name);
    for (uint32_t i = 0; i < node_count(m); i++) {
        const struct aiString *other = &NODES(m)[i].node->mName;
        if (masu_import_length(other) == length &&
            memcmp(other->data, name->data, (size_t)length) == 0)
            return i;
    }
    return MASU_BLOB_NONE;
}

/* The joints of a mesh: its bones, and one more for vertices without bones, which follow the node
 * that shows the mesh. */
static void add_joints(masu_import *m, const struct aiMesh *mesh, uint32_t shown_by) {
    for (unsigned b = 0; b <= mesh->mNumBones; b++) {
        masu_blob_joint joint = {.inverse_bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                 .node = shown_by};
        const struct aiBone *bone = b < mesh->mNumBones ? mesh->mBones[b] : NULL;
        uint32_t node = bone ? find_node(m, &bone->mName) : MASU_BLOB_NONE;
        if (node != MASU_BLOB_NONE) {
            masu_bake_affine bind = affine_of(&bone->mOffsetMatrix);
            if (masu_bake_affine_sane(&bind)) {
                for (int k = 0; k < 12; k++) joint.inverse_bind[k] = (float)bind.m[k];
                joint.node = node;
            }
        }
        m->lost_joints += b < mesh->mNumBones && joint.node != node;
        masu_bake_append(&m->piece->section[MASU_BLOB_JOINTS], &joint, sizeof joint);
    }
}

/* A vertex in the rest pose: skinned with all nodes at rest. */
static masu_blob_vertex at_rest(const masu_import *m, const masu_blob_skin_vertex *v,
                                const masu_blob_joint *joints) {
    masu_bake_affine sum = {{0}};
    masu_blob_vertex out = v->rest;
    for (int i = 0; i < 4; i++) {
        masu_bake_affine bind;
        const masu_blob_joint *joint = &joints[v->joints[i]];
        for (int k = 0; k < 12; k++) bind.m[k] = (double)joint->inverse_bind[k];
        bind = masu_bake_multiply(&NODES(m)[joint->node].world, &bind);
        for (int k = 0; k < 12; k++) sum.m[k] += bind.m[k] * v->weights[i] / 65535.0;
    }
    masu_bake_store(masu_bake_apply(&sum, masu_bake_v3f(v->rest.position)), out.position);
    const double *r = sum.m;
    masu_bake_vec3 row0 = {r[0], r[1], r[2]}, row1 = {r[4], r[5], r[6]}, row2 = {r[8], r[9], r[10]};
    masu_bake_vec3 c0 = masu_bake_cross(row1, row2), n = masu_bake_decode_normal(v->rest.normal);
    masu_bake_vec3 turned = {masu_bake_dot(c0, n), masu_bake_dot(masu_bake_cross(row2, row0), n),
                             masu_bake_dot(masu_bake_cross(row0, row1), n)};
    if (masu_bake_dot(row0, c0) < 0) turned = masu_bake_v3(-turned.x, -turned.y, -turned.z);
    if (masu_bake_normalize(&turned)) masu_bake_encode_normal(turned, out.normal);
    return out;
}

static void grow(masu_blob_joint *joint, const float p[3]) {
    for (int k = 0; k < 3; k++) {
        if (!joint->used || p[k] < joint->low[k]) joint->low[k] = p[k];
        if (!joint->used || p[k] > joint->high[k]) joint->high[k] = p[k];
    }
    joint->used = 1;
}

/* ---- Morph targets --------------------------------------------------------------------------- */

/* The source in the file of a vertex of the skin. */
typedef struct origin {
    const struct aiMesh *mesh;
    uint32_t vertex;
} origin;

static masu_bake_vec3 vector_of(const struct aiVector3D *v) {
    return masu_bake_v3((double)v->x, (double)v->y, (double)v->z);
}

/* The difference that a target adds to a vertex; 0 if it is not finite. */
static void delta_of(const origin *o, unsigned target, masu_bake_vec3 *position,
                     masu_bake_vec3 *normal) {
    const struct aiAnimMesh *t =
        target < o->mesh->mNumAnimMeshes ? o->mesh->mAnimMeshes[target] : NULL;
    *position = *normal = masu_bake_v3(0, 0, 0);
    if (!t || o->vertex >= t->mNumVertices || o->vertex >= o->mesh->mNumVertices) return;
    if (t->mVertices)
        *position = masu_bake_sub(vector_of(&t->mVertices[o->vertex]),
                                  vector_of(&o->mesh->mVertices[o->vertex]));
    if (t->mNormals && o->mesh->mNormals)
        *normal = masu_bake_sub(vector_of(&t->mNormals[o->vertex]),
                                vector_of(&o->mesh->mNormals[o->vertex]));
    if (!masu_bake_sane(*position)) *position = masu_bake_v3(0, 0, 0);
    if (!masu_bake_sane(*normal)) *normal = masu_bake_v3(0, 0, 0);
}

static uint32_t packed_normal(masu_bake_vec3 n) {
    const double all[3] = {n.x, n.y, n.z};
    uint32_t out = 0;
    for (int k = 0; k < 3; k++) {
        double most = k < 2 ? 1023 : 511, v = fmax(-1, fmin(1, all[k] / 2)) * most;
        out |= ((uint32_t)(int32_t)floor(v + 0.5) & (k < 2 ? 0x7FFu : 0x3FFu)) << 11 * k;
    }
    return out;
}

/* Applies the morph weights of the file's rest pose. */
static void rest_morphed(const origin *o, unsigned targets, masu_blob_vertex *v) {
    masu_bake_vec3 p = masu_bake_v3f(v->position), n = masu_bake_decode_normal(v->normal);
    bool any = false;
    for (unsigned t = 0; t < targets && t < o->mesh->mNumAnimMeshes; t++) {
        masu_bake_vec3 position, normal;
        double weight = o->mesh->mAnimMeshes[t] ? (double)o->mesh->mAnimMeshes[t]->mWeight : 0;
        if (!(fabs(weight) <= (double)MASU_MORPH_WEIGHT_MAX) || weight == 0) continue;
        delta_of(o, t, &position, &normal);
        p = masu_bake_mad(p, position, weight);
        n = masu_bake_mad(n, normal, weight);
        any = true;
    }
    if (!any) return;
    masu_bake_store(p, v->position);
    if (masu_bake_normalize(&n)) masu_bake_encode_normal(n, v->normal);
}

/* Called after all parts of a skin; the number of targets is that of the mesh with the most. */
static void add_targets(masu_import *m, const origin *origins, masu_blob_skin *skin) {
    masu_bake_content *c = m->piece;
    const struct aiMesh *most = NULL;
    for (uint32_t k = 0; k < skin->vertex_count; k++) {
        if (!most || target_count(m, origins[k].mesh) > target_count(m, most))
            most = origins[k].mesh;
    }
    skin->target_count = most ? target_count(m, most) : 0;
    skin->first_target = (uint32_t)masu_bake_count(c, MASU_BLOB_MORPH_TARGETS);
    skin->first_delta = (uint32_t)masu_bake_count(c, MASU_BLOB_MORPH_DELTAS);
    for (unsigned t = 0; t < skin->target_count; t++) {
        const struct aiAnimMesh *from = most->mAnimMeshes[t];
        masu_blob_morph_target target = {.name = MASU_BLOB_NONE};
        if (from)
            target.name =
                masu_bake_name(c, from->mName.data, (size_t)masu_import_length(&from->mName));
        if (from && fabsf(from->mWeight) <= MASU_MORPH_WEIGHT_MAX) target.weight = from->mWeight;
        for (uint32_t k = 0; k < skin->vertex_count; k++) {
            masu_bake_vec3 position, normal;
            masu_blob_morph_delta delta;
            delta_of(&origins[k], t, &position, &normal);
            masu_bake_store(position, delta.position);
            delta.normal = packed_normal(normal);
            for (int i = 0; i < 3; i++) {
                target.low[i] = fminf(target.low[i], delta.position[i]);
                target.high[i] = fmaxf(target.high[i], delta.position[i]);
            }
            masu_bake_append(&c->section[MASU_BLOB_MORPH_DELTAS], &delta, sizeof delta);
        }
        masu_bake_append(&c->section[MASU_BLOB_MORPH_TARGETS], &target, sizeof target);
    }
}

/* ---- Parts ----------------------------------------------------------------------------------- */

/* Adds a part of a skinned mesh to the piece: its vertices in the rest pose and its triangles.
 * base: its first joint in the skin. */
static bool copy_part(masu_import *m, const masu_blob_primitive *from, uint32_t first_joint,
                      uint32_t base, const struct aiMesh *mesh, masu_bake_buffer *origins) {
    masu_bake_content *to = m->piece;
    masu_blob_primitive part = *from;
    masu_blob_joint *joints = MASU_BAKE_ARRAY(to, MASU_BLOB_JOINTS, masu_blob_joint) + first_joint;
    part.first_vertex = (uint32_t)masu_bake_count(to, MASU_BLOB_VERTICES);
    part.first_index = (uint32_t)masu_bake_count(to, MASU_BLOB_INDICES);
    for (uint32_t k = 0; k < part.vertex_count; k++) {
        uint32_t at = from->first_vertex + k;
        masu_bake_influence by = ((masu_bake_influence *)(void *)m->influences.data)[at];
        masu_blob_skin_vertex v = {.rest = MASU_BAKE_VERTICES(&m->bent)[at]};
        for (int i = 0; i < 4; i++) {
            v.joints[i] = by.weights[i] ? (uint16_t)(base + by.joints[i]) : 0;
            v.weights[i] = by.weights[i];
            if (by.weights[i]) grow(&joints[v.joints[i]], v.rest.position);
        }
        origin o = {mesh, by.source};
        masu_bake_append(origins, &o, sizeof o);
        masu_blob_skin_vertex morphed = v;
        rest_morphed(&o, target_count(m, mesh), &morphed.rest);
        masu_blob_vertex made = at_rest(m, &morphed, joints);
        if (!masu_bake_sane(masu_bake_v3f(made.position))) return false;
        for (int i = 0; i < 3; i++) {
            float p = made.position[i];
            if (!k || p < part.aabb_min[i]) part.aabb_min[i] = p;
            if (!k || p > part.aabb_max[i]) part.aabb_max[i] = p;
        }
        masu_bake_append(&to->section[MASU_BLOB_VERTICES], &made, sizeof made);
        masu_bake_append(&to->section[MASU_BLOB_TEXCOORDS],
                         MASU_BAKE_ARRAY(&m->bent, MASU_BLOB_TEXCOORDS, float) + 2 * (size_t)at,
                         2 * sizeof(float));
        masu_bake_copy_attributes(to, &m->bent, at, 1);
        masu_bake_append(&to->section[MASU_BLOB_SKIN_VERTICES], &v, sizeof v);
    }
    masu_bake_append(&to->section[MASU_BLOB_INDICES],
                     MASU_BAKE_INDICES(&m->bent) + from->first_index,
                     part.index_count * sizeof(uint32_t));
    masu_bake_append(&to->section[MASU_BLOB_PRIMITIVES], &part, sizeof part);
    return true;
}

/* Sizes before a skin is added, to undo it. */
typedef struct mark {
    size_t bytes[MASU_BLOB_KIND_COUNT];
} mark;

static mark mark_of(const masu_bake_content *c) {
    mark here;
    for (uint32_t kind = 0; kind < MASU_BLOB_KIND_COUNT; kind++)
        here.bytes[kind] = c->section[kind].bytes;
    return here;
}

static void back_to(masu_bake_content *c, const mark *here) {
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++)
        c->section[kind].bytes = here->bytes[kind];
}

/* For a node that shows meshes with bones: all their joints together form a skin. False: it has
 * nothing to draw. */
static bool make_skin(masu_import *m, uint32_t node, masu_blob_skin *skin, uint32_t *instance,
                      masu_bake_buffer *origins) {
    masu_bake_content *c = m->piece;
    const struct aiNode *source = NODES(m)[node].node;
    uint32_t first = (uint32_t)masu_bake_count(c, MASU_BLOB_PRIMITIVES);
    *skin = (masu_blob_skin){
        .like = (uint32_t)masu_bake_count(c, MASU_BLOB_SKINS),
        .first_vertex = (uint32_t)masu_bake_count(c, MASU_BLOB_VERTICES),
        .first_skin_vertex = (uint32_t)masu_bake_count(c, MASU_BLOB_SKIN_VERTICES),
        .first_joint = (uint32_t)masu_bake_count(c, MASU_BLOB_JOINTS)};
    for (unsigned i = 0; i < source->mNumMeshes; i++) {
        unsigned mesh = source->mMeshes[i];
        if (mesh >= m->source->mNumMeshes || !masu_import_bends(m, mesh)) continue;
        uint32_t base = (uint32_t)masu_bake_count(c, MASU_BLOB_JOINTS) - skin->first_joint;
        if (base + m->source->mMeshes[mesh]->mNumBones + 1 > JOINTS_MAX) return false;
        add_joints(m, m->source->mMeshes[mesh], node);
        for (uint32_t k = 0; k < m->mesh_parts[mesh].count; k++) {
            const masu_blob_primitive *part =
                &MASU_BAKE_PRIMITIVES(&m->bent)[m->mesh_parts[mesh].first + k];
            if (!copy_part(m, part, skin->first_joint, base, m->source->mMeshes[mesh], origins))
                return false;
        }
    }
    uint32_t count = (uint32_t)masu_bake_count(c, MASU_BLOB_PRIMITIVES) - first;
    if (!count) return false;
    size_t length = (size_t)masu_import_length(&source->mName);
    uint32_t name = masu_bake_name(c, source->mName.data, length);
    masu_bake_affine identity = masu_bake_identity();
    *instance = masu_bake_instance(c, &identity, masu_bake_mesh(c, first, count, name),
                                   MASU_BLOB_NONE, name);
    skin->joint_count = (uint32_t)masu_bake_count(c, MASU_BLOB_JOINTS) - skin->first_joint;
    skin->vertex_count = (uint32_t)masu_bake_count(c, MASU_BLOB_VERTICES) - skin->first_vertex;
    add_targets(m, (const origin *)(const void *)origins->data, skin);
    return true;
}

static bool shows_bent(const masu_import *m, const struct aiNode *node) {
    for (unsigned i = 0; node->mMeshes && i < node->mNumMeshes; i++) {
        if (node->mMeshes[i] < m->source->mNumMeshes && masu_import_bends(m, node->mMeshes[i]))
            return true;
    }
    return false;
}

/* Makes all skins. Their nodes follow those of the file, in the order of the skins; `instances` has
 * the instance of each. */
static void make_skins(masu_import *m, masu_bake_buffer *instances) {
    for (uint32_t n = 0; n < node_count(m); n++) {
        masu_blob_skin skin;
        uint32_t instance = MASU_BLOB_NONE;
        if (!shows_bent(m, NODES(m)[n].node)) continue;
        mark here = mark_of(m->piece);
        masu_bake_buffer origins = {0};
        bool good = make_skin(m, n, &skin, &instance, &origins);
        masu_bake_release(&origins);
        if (good) {
            masu_bake_append(&m->piece->section[MASU_BLOB_SKINS], &skin, sizeof skin);
            masu_bake_append(&m->skin_nodes, &n, sizeof n);
            masu_bake_append(instances, &instance, sizeof instance);
        } else {
            back_to(m->piece, &here);
            m->bad_nodes++;
        }
    }
}

/* ---- Clips ----------------------------------------------------------------------------------- */

/* A channel with separate keys until the channels are sorted. */
typedef struct track {
    masu_blob_channel channel;
    uint32_t order, unordered;
    masu_bake_buffer keys;
} track;

static void add_key(track *t, double time, const double value[4], int components) {
    masu_blob_key key = {.time = (float)fmax(time, 0)};
    size_t count = t->keys.bytes / sizeof key;
    if (!(time <= (double)MASU_CLIP_SECONDS_MAX)) return; /* also false for NaN */
    double square = 0;
    for (int k = 0; k < components; k++) {
        if (!(fabs(value[k]) <= MASU_BAKE_COORDINATE_MAX)) return;
        square += value[k] * value[k];
    }
    bool turns = t->channel.path == MASU_CHANNEL_ROTATION;
    if (turns && !(square > 1e-12)) return;
    for (int k = 0; k < components; k++)
        key.value[k] = (float)(turns ? value[k] / sqrt(square) : value[k]);
    const masu_blob_key *keys = (const masu_blob_key *)(const void *)t->keys.data;
    if (count && !(key.time > keys[count - 1].time)) {
        /* Several keys at one time are a step: the first one ends just before it, the last one
         * applies from then on. */
        masu_blob_key *last = (masu_blob_key *)(void *)t->keys.data + count - 1;
        float before = nextafterf(key.time, -INFINITY);
        if (key.time < last->time) {
            t->unordered++;
            return;
        }
        if (!(before >= 0) || (count > 1 && !(before > last[-1].time))) {
            *last = key;
            return;
        }
        last->time = before;
    }
    masu_bake_append(&t->keys, &key, sizeof key);
}

/* A constant channel needs one key. */
static void shorten(track *t) {
    size_t count = t->keys.bytes / sizeof(masu_blob_key);
    const masu_blob_key *keys = (const masu_blob_key *)(const void *)t->keys.data;
    for (size_t k = 1; k < count; k++) {
        if (memcmp(keys[k].value, keys[0].value, sizeof keys[0].value) != 0) return;
    }
    if (count) t->keys.bytes = sizeof *keys;
}

static void add_track(masu_bake_buffer *tracks, track *t) {
    shorten(t);
    t->order = (uint32_t)(tracks->bytes / sizeof *t);
    if (t->keys.bytes) masu_bake_append(tracks, t, sizeof *t);
}

static void add_tracks(const struct aiNodeAnim *from, uint32_t node, double tick,
                       masu_bake_buffer *tracks) {
    track moves = {.channel = {.node = node, .path = MASU_CHANNEL_TRANSLATION}};
    track turns = {.channel = {.node = node, .path = MASU_CHANNEL_ROTATION}};
    track scales = {.channel = {.node = node, .path = MASU_CHANNEL_SCALE}};
    for (unsigned k = 0; from->mPositionKeys && k < from->mNumPositionKeys; k++) {
        const struct aiVector3D *v = &from->mPositionKeys[k].mValue;
        const double value[4] = {(double)v->x, (double)v->y, (double)v->z, 0};
        add_key(&moves, from->mPositionKeys[k].mTime * tick, value, 3);
    }
    for (unsigned k = 0; from->mRotationKeys && k < from->mNumRotationKeys; k++) {
        const struct aiQuaternion *q = &from->mRotationKeys[k].mValue;
        const double value[4] = {(double)q->x, (double)q->y, (double)q->z, (double)q->w};
        add_key(&turns, from->mRotationKeys[k].mTime * tick, value, 4);
    }
    for (unsigned k = 0; from->mScalingKeys && k < from->mNumScalingKeys; k++) {
        const struct aiVector3D *v = &from->mScalingKeys[k].mValue;
        const double value[4] = {(double)v->x, (double)v->y, (double)v->z, 0};
        add_key(&scales, from->mScalingKeys[k].mTime * tick, value, 3);
    }
    add_track(tracks, &moves);
    add_track(tracks, &turns);
    add_track(tracks, &scales);
}

/* Weights belong to the skins' nodes, which follow all others. */
static int by_node(const void *a, const void *b) {
    const track *x = a, *y = b;
    int weighs[2] = {x->channel.path == MASU_CHANNEL_WEIGHT,
                     y->channel.path == MASU_CHANNEL_WEIGHT};
    if (weighs[0] != weighs[1]) return weighs[0] - weighs[1];
    if (x->channel.node != y->channel.node) return x->channel.node < y->channel.node ? -1 : 1;
    if (x->channel.path != y->channel.path) return x->channel.path < y->channel.path ? -1 : 1;
    if (x->channel.target != y->channel.target)
        return x->channel.target < y->channel.target ? -1 : 1;
    return x->order < y->order ? -1 : 1;
}

/* The weights of the targets of the skin that a node shows. Assimp's name may be the node's,
 * followed by "*" and a number. */
static void add_weights(masu_import *m, const struct aiMeshMorphAnim *from, double tick,
                        masu_bake_buffer *tracks) {
    struct aiString name = from->mName;
    char *star = memchr(name.data, '*', (size_t)masu_import_length(&name));
    if (star) name.length = (ai_uint32)(star - name.data);
    uint32_t node = find_node(m, &name);
    const uint32_t *skins = (const uint32_t *)(const void *)m->skin_nodes.data;
    for (uint32_t s = 0; s < m->skin_nodes.bytes / sizeof *skins; s++) {
        const masu_blob_skin *skin =
            &MASU_BAKE_ARRAY(m->piece, MASU_BLOB_SKINS, const masu_blob_skin)[s];
        if (skins[s] != node) continue;
        for (uint32_t t = 0; t < skin->target_count; t++) {
            track weights = {.channel = {.node = s, .path = MASU_CHANNEL_WEIGHT, .target = t}};
            for (unsigned k = 0; from->mKeys && k < from->mNumKeys; k++) {
                const struct aiMeshMorphKey *key = &from->mKeys[k];
                for (unsigned i = 0; key->mValues && key->mWeights && i < key->mNumValuesAndWeights;
                     i++) {
                    const double value[4] = {
                        (double)masu_import_clamped(key->mWeights[i], -1e6, 1e6), 0, 0, 0};
                    if (key->mValues[i] == t) add_key(&weights, key->mTime * tick, value, 1);
                }
            }
            add_track(tracks, &weights);
        }
    }
}

/* Channels refer to the file's nodes until those have their final numbers. */
static void make_clip(masu_import *m, const struct aiAnimation *from) {
    masu_bake_content *c = m->piece;
    masu_bake_buffer tracks = {0};
    double tick = from->mTicksPerSecond > 0 ? 1 / from->mTicksPerSecond : 1;
    for (unsigned i = 0; from->mChannels && i < from->mNumChannels; i++) {
        uint32_t node = from->mChannels[i] ? find_node(m, &from->mChannels[i]->mNodeName)
                                           : MASU_BLOB_NONE;
        if (node != MASU_BLOB_NONE) add_tracks(from->mChannels[i], node, tick, &tracks);
    }
    for (unsigned i = 0; from->mMorphMeshChannels && i < from->mNumMorphMeshChannels; i++) {
        if (from->mMorphMeshChannels[i]) add_weights(m, from->mMorphMeshChannels[i], tick, &tracks);
    }
    size_t count = tracks.bytes / sizeof(track);
    track *all = (track *)(void *)tracks.data;
    if (count) qsort(all, count, sizeof *all, by_node);
    masu_blob_clip clip = {
        .first_channel = (uint32_t)masu_bake_count(c, MASU_BLOB_CHANNELS),
        .duration = masu_import_clamped(from->mDuration * tick, 0, (double)MASU_CLIP_SECONDS_MAX),
        .name = masu_bake_name(c, from->mName.data, (size_t)masu_import_length(&from->mName))};
    for (size_t i = 0; i < count; i++) {
        masu_blob_channel channel = all[i].channel;
        if (i && channel.node == all[i - 1].channel.node &&
            channel.path == all[i - 1].channel.path && channel.target == all[i - 1].channel.target)
            continue;
        channel.first_key = (uint32_t)masu_bake_count(c, MASU_BLOB_KEYS);
        channel.key_count = (uint32_t)(all[i].keys.bytes / sizeof(masu_blob_key));
        masu_bake_append(&c->section[MASU_BLOB_KEYS], all[i].keys.data, all[i].keys.bytes);
        masu_bake_append(&c->section[MASU_BLOB_CHANNELS], &channel, sizeof channel);
        const masu_blob_key *keys = (const masu_blob_key *)(const void *)all[i].keys.data;
        clip.duration = fmaxf(clip.duration, keys[channel.key_count - 1].time);
        clip.channel_count++;
        if (channel.path != MASU_CHANNEL_WEIGHT) NODES(m)[channel.node].needed = true;
    }
    for (size_t i = 0; i < count; i++) {
        m->unordered += all[i].unordered;
        masu_bake_release(&all[i].keys);
    }
    masu_bake_release(&tracks);
    if (clip.channel_count) masu_bake_append(&c->section[MASU_BLOB_CLIPS], &clip, sizeof clip);
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

static void add_node(masu_import *m, const masu_bake_affine *local, uint32_t parent,
                     uint32_t instance, uint32_t name, uint32_t skin) {
    masu_blob_model_node node = {
        .parent = parent, .instance = instance, .name = name, .skin = skin};
    masu_bake_affine identity = masu_bake_identity();
    bool sane = masu_bake_affine_sane(local);
    m->bad_nodes += !sane;
    for (int k = 0; k < 12; k++) node.local[k] = (float)(sane ? local : &identity)->m[k];
    masu_bake_append(&m->piece->section[MASU_BLOB_MODEL_NODES], &node, sizeof node);
}

/* Keeps nodes that show something, joints, nodes that clips animate, and all their ancestors. */
static void make_nodes(masu_import *m) {
    uint32_t count = node_count(m), next = 0;
    for (uint32_t n = count; n > 0; n--) { /* children follow their parents */
        masu_import_node *node = &NODES(m)[n - 1];
        node->needed = node->needed || node->instance != MASU_BLOB_NONE;
        if (node->needed && node->parent != MASU_BLOB_NONE) NODES(m)[node->parent].needed = true;
    }
    for (uint32_t n = 0; n < count; n++) {
        masu_import_node *node = &NODES(m)[n];
        if (!node->needed) continue;
        const struct aiString *name = &node->node->mName;
        node->number = next++;
        add_node(m, &node->local,
                 node->parent == MASU_BLOB_NONE ? MASU_BLOB_NONE : NODES(m)[node->parent].number,
                 node->instance,
                 masu_bake_name(m->piece, name->data, (size_t)masu_import_length(name)), 0);
    }
}

static void report_live(masu_import *m) {
    if (m->crowded) {
        masu_import_format(m->warnings,
                           "%u vertices have more than 4 joints: the 4 largest weights are used\n",
                           m->crowded);
    }
    if (m->unbound) {
        masu_import_format(m->warnings,
                           "%u vertices of skins have no joint: they follow their node\n",
                           m->unbound);
    }
    if (m->unordered) {
        masu_import_format(m->warnings,
                           "%u keys of animations are before the previous key: ignored\n",
                           m->unordered);
    }
    if (m->lost_joints) {
        masu_import_format(m->warnings, "%u joints are not nodes of the file: they are static\n",
                           m->lost_joints);
    }
}

void masu_import_live(masu_import *m) {
    masu_bake_content *c = m->piece;
    masu_bake_buffer instances = {0};
    masu_bake_affine identity = masu_bake_identity();
    make_skins(m, &instances);
    for (unsigned i = 0; m->moving && m->source->mAnimations && i < m->source->mNumAnimations;
         i++) {
        if (m->source->mAnimations[i]) make_clip(m, m->source->mAnimations[i]);
    }
    masu_blob_joint *joints = MASU_BAKE_ARRAY(c, MASU_BLOB_JOINTS, masu_blob_joint);
    for (uint64_t j = 0; j < masu_bake_count(c, MASU_BLOB_JOINTS); j++)
        NODES(m)[joints[j].node].needed = true;
    make_nodes(m);
    for (uint64_t j = 0; j < masu_bake_count(c, MASU_BLOB_JOINTS); j++)
        joints[j].node = NODES(m)[joints[j].node].number;
    masu_blob_channel *channels = MASU_BAKE_ARRAY(c, MASU_BLOB_CHANNELS, masu_blob_channel);
    for (uint64_t k = 0; k < masu_bake_count(c, MASU_BLOB_CHANNELS); k++)
        channels[k].node =
            channels[k].path == MASU_CHANNEL_WEIGHT
                ? channels[k].node + (uint32_t)masu_bake_count(c, MASU_BLOB_MODEL_NODES)
                : NODES(m)[channels[k].node].number;
    for (uint32_t i = 0; i < instances.bytes / sizeof(uint32_t); i++) {
        uint32_t instance = ((const uint32_t *)(const void *)instances.data)[i];
        masu_blob_skin *skin = &MASU_BAKE_ARRAY(c, MASU_BLOB_SKINS, masu_blob_skin)[i];
        skin->node = (uint32_t)masu_bake_count(c, MASU_BLOB_MODEL_NODES);
        add_node(m, &identity, MASU_BLOB_NONE, instance, MASU_BLOB_NONE, i + 1);
    }
    report_live(m);
    masu_bake_release(&instances);
}

void masu_import_forget(masu_import *m) {
    static const int kinds[] = {
        MASU_BLOB_MODEL_NODES,   MASU_BLOB_CLIPS,         MASU_BLOB_CHANNELS,
        MASU_BLOB_KEYS,          MASU_BLOB_SKINS,         MASU_BLOB_JOINTS,
        MASU_BLOB_SKIN_VERTICES, MASU_BLOB_MORPH_TARGETS, MASU_BLOB_MORPH_DELTAS};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        masu_bake_release(&m->piece->section[kinds[i]]);
}
