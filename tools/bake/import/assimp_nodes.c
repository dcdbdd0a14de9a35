/* assimp_nodes.c: converts nodes to instances, with their lights; see assimp.h. */
#include "bake/import/assimp.h"
#include "bake/scene/camera.h"
#include "bake/scene/sun.h"

#include <stdlib.h>
#include <string.h>

/* More nodes than any real model; this limit also ends a cycle of nodes. */
#define NODES_MAX 4000000u
#define LIGHTS_MAX 4096u /* searched for among the nodes */
#define CAMERAS_MAX 256u

static bool same_set(const masu_import_set *g, const unsigned *meshes, unsigned count) {
    return g->count == count && memcmp(g->meshes, meshes, count * sizeof *meshes) == 0;
}

/* Adds the primitives of an aiMesh again. Two primitives cannot share indices (src/scene/scene.c):
 * the indices are copied if a mesh is part of a second set. */
static void add_parts(masu_import *m, unsigned mesh) {
    masu_bake_buffer *indices = &m->piece->section[MASU_BLOB_INDICES];
    for (uint32_t i = 0; i < m->mesh_parts[mesh].count; i++) {
        masu_blob_primitive part = m->parts[m->mesh_parts[mesh].first + i];
        if (m->mesh_used[mesh]) {
            size_t from = part.first_index * sizeof(uint32_t);
            size_t bytes = part.index_count * sizeof(uint32_t);
            part.first_index = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_INDICES);
            masu_bake_append(indices, NULL, bytes);
            memcpy(indices->data + indices->bytes - bytes, indices->data + from, bytes);
        }
        masu_bake_append(&m->piece->section[MASU_BLOB_PRIMITIVES], &part, sizeof part);
    }
    m->mesh_used[mesh] = true;
}

/* The masu mesh for a set of aiMeshes, or NONE if it has nothing to draw. */
static uint32_t mesh_of(masu_import *m, const unsigned *meshes, unsigned count) {
    unsigned total = m->source->mNumMeshes, first = total;
    for (unsigned i = 0; i < count; i++) {
        if (meshes[i] < total && m->mesh_parts[meshes[i]].count && first == total) {
            first = meshes[i];
        }
    }
    if (first == total) return MASU_BLOB_NONE;
    for (const masu_import_set *g = m->sets[first]; g; g = g->next) {
        if (same_set(g, meshes, count)) return g->mesh;
    }
    uint32_t from = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_PRIMITIVES);
    for (unsigned i = 0; i < count; i++) {
        if (meshes[i] < total) add_parts(m, meshes[i]);
    }
    const struct aiString *name = &m->source->mMeshes[first]->mName;
    masu_import_set *g = masu_bake_allocate(sizeof *g);
    uint32_t to = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_PRIMITIVES);
    *g = (masu_import_set){meshes, count, 0, m->sets[first]};
    g->mesh =
        masu_bake_mesh(m->piece, from, to - from,
                       masu_bake_name(m->piece, name->data, (size_t)masu_import_length(name)));
    m->sets[first] = g;
    return g->mesh;
}

typedef struct visit {
    const struct aiNode *node;
    masu_bake_affine parent; /* transform to world space */
    /* transform to the parent instance's object space; without one to world */
    masu_bake_affine space;
    uint32_t parent_instance;
    uint32_t parent_node; /* index into `nodes`, if they are kept */
} visit;

static masu_bake_affine node_transform(const struct aiNode *node) {
    const struct aiMatrix4x4 *t = &node->mTransformation;
    const ai_real rows[12] = {t->a1, t->a2, t->a3, t->a4, t->b1, t->b2,
                              t->b3, t->b4, t->c1, t->c2, t->c3, t->c4};
    masu_bake_affine a;
    for (int i = 0; i < 12; i++) a.m[i] = (double)rows[i];
    return a;
}

/* glTF specifies intensities. A white matte surface has a luminance of intensity / pi / distance
 * squared. An absent range remains 0 until the scale of the placement is available. */
static bool convert_light(const struct aiLight *from, const masu_bake_affine *space,
                          masu_blob_light *to) {
    const ai_real color[3] = {from->mColorDiffuse.r, from->mColorDiffuse.g, from->mColorDiffuse.b};
    masu_bake_vec3 own = {(double)from->mPosition.x, (double)from->mPosition.y,
                          (double)from->mPosition.z};
    masu_bake_vec3 ahead = {(double)from->mDirection.x, (double)from->mDirection.y,
                            (double)from->mDirection.z};
    masu_bake_vec3 at = masu_bake_apply(space, own);
    masu_bake_vec3 direction =
        masu_bake_sub(masu_bake_apply(space, masu_bake_mad(own, ahead, 1)), at);
    if (from->mType != aiLightSource_POINT && from->mType != aiLightSource_SPOT) return false;
    if (!masu_bake_sane(at)) return false;
    to->position[0] = (float)at.x, to->position[1] = (float)at.y, to->position[2] = (float)at.z;
    for (int k = 0; k < 3; k++)
        to->color[k] = masu_import_clamped((double)color[k] / MASU_BAKE_PI, 0, 1e9);
    to->radius = 0.01f;
    if (from->mType == aiLightSource_POINT) return true;
    to->type = MASU_LIGHT_SPOT;
    if (!masu_bake_normalize(&direction)) return false;
    to->direction[0] = (float)direction.x;
    to->direction[1] = (float)direction.y;
    to->direction[2] = (float)direction.z;
    to->outer = masu_import_clamped((double)from->mAngleOuterCone, 0, MASU_BAKE_PI / 2);
    to->inner = masu_import_clamped((double)from->mAngleInnerCone, 0, (double)to->outer);
    return true;
}

/* The light points along -z of its node; its unit is lux. */
static void convert_sun(masu_import *m, const struct aiLight *from, const masu_bake_affine *world) {
    const masu_bake_vec3 origin = {0, 0, 0};
    const ai_real color[3] = {from->mColorDiffuse.r, from->mColorDiffuse.g, from->mColorDiffuse.b};
    masu_bake_vec3 back = {-(double)from->mDirection.x, -(double)from->mDirection.y,
                           -(double)from->mDirection.z};
    masu_bake_vec3 direction =
        masu_bake_sub(masu_bake_apply(world, back), masu_bake_apply(world, origin));
    double irradiance[3];
    char name[sizeof from->mName.data + 1];
    size_t length = (size_t)masu_import_length(&from->mName);
    memcpy(name, from->mName.data, length);
    name[length] = '\0';
    for (int k = 0; k < 3; k++) irradiance[k] = (double)color[k] / MASU_BAKE_PI;
    masu_bake_add_sun(m->piece, name, direction, irradiance);
}

/* Only glTF's lights have a defined unit. An aiScene links a light to a node by name. */
static void convert_lights(masu_import *m, const struct aiNode *node, const masu_bake_affine *space,
                           const masu_bake_affine *world, uint32_t instance) {
    const struct aiScene *s = m->source;
    int length = masu_import_length(&node->mName);
    if (!m->ranges || !s->mLights || length == 0) return;
    for (unsigned i = 0; i < s->mNumLights && i < LIGHTS_MAX; i++) {
        const struct aiLight *from = s->mLights[i];
        if (!from || masu_import_length(&from->mName) != length ||
            memcmp(from->mName.data, node->mName.data, (size_t)length) != 0) {
            continue;
        }
        if (from->mType == aiLightSource_DIRECTIONAL) {
            convert_sun(m, from, world);
            continue;
        }
        masu_blob_light light = {.parent = instance, .range = m->ranges[i]};
        if (!convert_light(from, space, &light)) {
            m->other_lights++;
            continue;
        }
        light.name = masu_bake_name(m->piece, from->mName.data, (size_t)length);
        masu_bake_append(&m->piece->section[MASU_BLOB_LIGHTS], &light, sizeof light);
    }
}

/* Cameras are linked like lights, by the name of the node. Assimp's importers disagree on the angle
 * of an aiCamera; most use the full width. */
static void convert_cameras(masu_import *m, const struct aiNode *node,
                            const masu_bake_affine *world) {
    const struct aiScene *s = m->source;
    int length = masu_import_length(&node->mName);
    if (!s->mCameras || length == 0) return;
    for (unsigned i = 0; i < s->mNumCameras && i < CAMERAS_MAX; i++) {
        const struct aiCamera *from = s->mCameras[i];
        if (!from || masu_import_length(&from->mName) != length ||
            memcmp(from->mName.data, node->mName.data, (size_t)length) != 0) {
            continue;
        }
        masu_bake_vec3 own = {(double)from->mPosition.x, (double)from->mPosition.y,
                              (double)from->mPosition.z};
        masu_bake_vec3 ahead = {(double)from->mLookAt.x, (double)from->mLookAt.y,
                                (double)from->mLookAt.z};
        masu_bake_vec3 at = masu_bake_apply(world, own);
        masu_bake_vec3 direction =
            masu_bake_sub(masu_bake_apply(world, masu_bake_mad(own, ahead, 1)), at);
        double aspect = from->mAspect > 0 ? (double)from->mAspect : 16.0 / 9;
        double width = (double)masu_import_clamped((double)from->mHorizontalFOV, 0, 3.1);
        char name[sizeof from->mName.data + 1];
        memcpy(name, from->mName.data, (size_t)length);
        name[length] = '\0';
        /* Half the width, scaled by the node. */
        double half = (double)masu_import_clamped((double)from->mOrthographicWidth, 0, 1e9) *
                      masu_bake_length(direction);
        double fov = half > 0 ? 0.7 : 2 * atan(tan(width / 2) / aspect);
        masu_bake_add_camera(m->piece, name, fov, 2 * half / aspect, at, direction);
    }
}

/* The node's meshes without bones; the node's own array if that is all of them. */
static unsigned stiff_meshes(const masu_import *m, const struct aiNode *node,
                             const unsigned **meshes) {
    unsigned total = m->source->mNumMeshes, bent = 0, count = 0;
    for (unsigned i = 0; i < node->mNumMeshes && m->live; i++)
        bent += node->mMeshes[i] < total && masu_import_bends(m, node->mMeshes[i]);
    if (!bent) return node->mNumMeshes;
    unsigned *kept = masu_bake_allocate(node->mNumMeshes * sizeof *kept); /* sets point into it */
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        if (node->mMeshes[i] < total && !masu_import_bends(m, node->mMeshes[i]))
            kept[count++] = node->mMeshes[i];
    }
    *meshes = kept;
    return count;
}

/* Returns false and leaves *instance unchanged if the node shows nothing. */
static bool make_instance(masu_import *m, const visit *v, const masu_bake_affine *world,
                          uint32_t *instance) {
    const struct aiNode *node = v->node;
    const unsigned *meshes = node->mMeshes;
    unsigned count = meshes ? stiff_meshes(m, node, &meshes) : 0;
    uint32_t mesh = count ? mesh_of(m, meshes, count) : MASU_BLOB_NONE;
    if (mesh == MASU_BLOB_NONE) return false;
    size_t length = (size_t)masu_import_length(&node->mName);
    uint32_t name = masu_bake_name(m->piece, node->mName.data, length);
    uint32_t made = masu_bake_instance(m->piece, world, mesh, v->parent_instance, name);
    m->bad_nodes += made == MASU_BLOB_NONE;
    if (made != MASU_BLOB_NONE) *instance = made;
    return made != MASU_BLOB_NONE;
}

static uint32_t keep_node(masu_import *m, const visit *v, const masu_bake_affine *own,
                          const masu_bake_affine *world, uint32_t instance) {
    masu_import_node node = {.node = v->node,
                             .local = *own,
                             .world = *world,
                             .parent = v->parent_node,
                             .instance = instance};
    masu_bake_append(&m->nodes, &node, sizeof node);
    return (uint32_t)(m->nodes.bytes / sizeof node - 1);
}

/* Depth first with an explicit stack: a deep chain of nodes must not overflow the call stack. */
bool masu_import_walk(masu_import *m, bool convert) {
    masu_bake_buffer stack = {0};
    visit start = {m->source->mRootNode, masu_bake_identity(), masu_bake_identity(),
                   MASU_BLOB_NONE, MASU_BLOB_NONE};
    masu_bake_append(&stack, &start, sizeof start);
    uint32_t visited = 0;
    while (stack.bytes && visited++ < NODES_MAX) {
        visit v;
        stack.bytes -= sizeof v;
        memcpy(&v, stack.data + stack.bytes, sizeof v);
        if (!v.node) continue;
        masu_bake_affine own = node_transform(v.node);
        masu_bake_affine world = masu_bake_multiply(&v.parent, &own);
        masu_bake_affine space = masu_bake_multiply(&v.space, &own);
        uint32_t instance = v.parent_instance, kept = MASU_BLOB_NONE;
        const unsigned *meshes = v.node->mMeshes;
        unsigned count = meshes ? v.node->mNumMeshes : 0;
        if (convert) {
            for (unsigned i = 0; i < count; i++) {
                if (meshes[i] < m->source->mNumMeshes) masu_import_mesh(m, meshes[i]);
            }
        } else {
            bool shows = make_instance(m, &v, &world, &instance);
            if (shows) space = masu_bake_identity();
            if (m->live) kept = keep_node(m, &v, &own, &world, shows ? instance : MASU_BLOB_NONE);
            convert_lights(m, v.node, &space, &world, instance);
            convert_cameras(m, v.node, &world);
        }
        unsigned children = v.node->mChildren ? v.node->mNumChildren : 0;
        if (children > NODES_MAX) break;
        for (unsigned i = children; i > 0; i--) { /* reversed: the first child is popped first */
            visit child = {v.node->mChildren[i - 1], world, space, instance, kept};
            masu_bake_append(&stack, &child, sizeof child);
        }
    }
    bool finished = stack.bytes == 0;
    masu_bake_release(&stack);
    return finished;
}

void masu_import_show_all(masu_import *m) {
    masu_bake_append_text(m->warnings, "no nodes: every mesh has one instance\n");
    unsigned *order = masu_bake_allocate(m->source->mNumMeshes * sizeof *order);
    masu_bake_affine identity = masu_bake_identity();
    for (unsigned i = 0; i < m->source->mNumMeshes; i++) {
        order[i] = i;
        uint32_t mesh = mesh_of(m, &order[i], 1);
        if (mesh != MASU_BLOB_NONE) {
            masu_bake_instance(m->piece, &identity, mesh, MASU_BLOB_NONE, MASU_BLOB_NONE);
        }
    }
    for (unsigned i = 0; i < m->source->mNumMeshes; i++) { /* sets point into `order` */
        while (m->sets[i]) {
            masu_import_set *g = m->sets[i];
            m->sets[i] = g->next;
            free(g);
        }
    }
    free(order);
}
