/* gltf_nodes.c: converts the nodes of a glTF file's scene to aiNodes, with their meshes, instances
 * and lights; see gltf.h.
 *
 * Skins, clips and lights of an aiScene refer to nodes by name, so names are made unique here. The
 * first node with a name keeps it, later ones get their number as a suffix; a node without a name
 * is called "nodes[3]". */
#include "bake/import/gltf.h"
#include "bake/scene/sun.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INSTANCES_MAX 4000000u

void masu_gltf_set_string(struct aiString *to, const char *text) {
    size_t length = strlen(text);
    if (length > sizeof to->data - 1) length = sizeof to->data - 1;
    memcpy(to->data, text, length);
    to->data[length] = '\0';
    to->length = (ai_uint32)length;
}

/* ---- names and transforms ---- */

typedef struct named {
    const char *name;
    size_t node;
} named;

static int by_name(const void *a, const void *b) {
    const named *x = a, *y = b;
    int order = strcmp(x->name, y->name);
    return order ? order : x->node < y->node ? -1 : x->node > y->node;
}

static void name_nodes(masu_gltf *g) {
    named *all = masu_gltf_take(g, g->node_count, sizeof *all);
    const json_t *nodes = json_object_get(g->root, "nodes");
    for (size_t i = 0; i < g->node_count; i++)
        all[i] = (named){masu_gltf_name_of(g, "nodes", i, json_array_get(nodes, i)), i};
    if (g->node_count) qsort(all, g->node_count, sizeof *all, by_name);
    for (size_t i = 0; i < g->node_count; i++) {
        char text[1024];
        bool again = i && strcmp(all[i].name, all[i - 1].name) == 0;
        snprintf(text, sizeof text, again ? "%.900s nodes[%zu]" : "%.1000s", all[i].name,
                 all[i].node);
        masu_gltf_set_string(&g->nodes[all[i].node].mName, text);
    }
}

static struct aiMatrix4x4 matrix_of(const double t[3], const double q[4], const double s[3]) {
    double x = q[0], y = q[1], z = q[2], w = q[3], n = x * x + y * y + z * z + w * w;
    if (!(n > 0)) x = y = z = 0, w = n = 1;
    n = 2 / n;
    const double r[9] = {1 - n * (y * y + z * z), n * (x * y - w * z),     n * (x * z + w * y),
                         n * (x * y + w * z),     1 - n * (x * x + z * z), n * (y * z - w * x),
                         n * (x * z - w * y),     n * (y * z + w * x),     1 - n * (x * x + y * y)};
    float m[12];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) m[4 * i + k] = (float)(r[3 * i + k] * s[k]);
        m[4 * i + 3] = (float)t[i];
    }
    return (struct aiMatrix4x4){m[0], m[1], m[2],  m[3],  m[4], m[5], m[6], m[7],
                                m[8], m[9], m[10], m[11], 0,    0,    0,    1};
}

static bool transform_of(masu_gltf *g, const json_t *node, struct aiMatrix4x4 *out) {
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, m[16];
    if (json_object_get(node, "matrix")) {
        if (!masu_gltf_numbers(g, node, "matrix", 16, m)) return false;
        *out = (struct aiMatrix4x4){(float)m[0],
                                    (float)m[4],
                                    (float)m[8],
                                    (float)m[12],
                                    (float)m[1],
                                    (float)m[5],
                                    (float)m[9],
                                    (float)m[13],
                                    (float)m[2],
                                    (float)m[6],
                                    (float)m[10],
                                    (float)m[14],
                                    0,
                                    0,
                                    0,
                                    1};
        return true;
    }
    if (!masu_gltf_numbers(g, node, "translation", 3, t) ||
        !masu_gltf_numbers(g, node, "rotation", 4, q) || !masu_gltf_numbers(g, node, "scale", 3, s))
        return false;
    *out = matrix_of(t, q, s);
    return true;
}

/* ---- the tree ---- */

static bool link_children(masu_gltf *g, size_t index, const json_t *node, bool *is_child) {
    const json_t *children = masu_gltf_array(g, node, "children");
    struct aiNode *to = &g->nodes[index];
    to->mChildren = masu_gltf_take(g, json_array_size(children), sizeof *to->mChildren);
    for (size_t i = 0; i < json_array_size(children); i++) {
        const json_t *child = json_array_get(children, i);
        json_int_t number = json_is_integer(child) ? json_integer_value(child) : -1;
        if (number < 0 || (size_t)number >= g->node_count)
            return masu_gltf_fail(g, "children[%zu] is not a node", i);
        is_child[number] = true;
        to->mChildren[to->mNumChildren++] = &g->nodes[number];
    }
    return !masu_gltf_failed(g);
}

/* The scene's nodes; without a scene, all nodes without a parent. */
static bool find_roots(masu_gltf *g, const bool *is_child, struct aiNode *root) {
    json_int_t chosen = -1;
    size_t scenes = masu_gltf_count(g, "scenes");
    if (!masu_gltf_index(g, g->root, "scene", scenes, &chosen)) return false;
    if (chosen < 0 && scenes) chosen = 0;
    const json_t *scene = chosen < 0 ? NULL : masu_gltf_element(g, "scenes", chosen);
    if (chosen >= 0 && !scene) return false;
    if (scene) masu_gltf_at(g, "scenes", (size_t)chosen, scene);
    if (scene) (void)masu_gltf_string(g, scene, "name");
    const json_t *nodes = scene ? masu_gltf_array(g, scene, "nodes") : NULL;
    root->mChildren =
        masu_gltf_take(g, scene ? json_array_size(nodes) : g->node_count, sizeof *root->mChildren);
    for (size_t i = 0; i < json_array_size(nodes); i++) {
        const json_t *node = json_array_get(nodes, i);
        json_int_t number = json_is_integer(node) ? json_integer_value(node) : -1;
        if (number < 0 || (size_t)number >= g->node_count)
            return masu_gltf_fail(g, "\"nodes\"[%zu] is not a node", i);
        root->mChildren[root->mNumChildren++] = &g->nodes[number];
    }
    for (size_t i = 0; i < g->node_count && !scene; i++) {
        if (!is_child[i]) root->mChildren[root->mNumChildren++] = &g->nodes[i];
    }
    if (scenes > 1)
        masu_gltf_note_many(
            g, scenes - 1, "scenes besides the one that is shown: left out",
            masu_gltf_name_of(g, "scenes", chosen == 0,
                              json_array_get(json_object_get(g->root, "scenes"), chosen == 0)));
    g->where[0] = '\0';
    return !masu_gltf_failed(g);
}

/* ---- data of a node ---- */

static bool add_light(masu_gltf *g, const json_t *node, const struct aiNode *at) {
    const json_t *extension = masu_gltf_extension(g, node, "KHR_lights_punctual");
    const json_t *about = masu_gltf_extension(g, g->root, "KHR_lights_punctual");
    const json_t *all = about ? masu_gltf_array(g, about, "lights") : NULL;
    json_int_t index = -1;
    if (!extension) return !masu_gltf_failed(g);
    if (!masu_gltf_index(g, extension, "light", json_array_size(all), &index)) return false;
    if (index < 0) return true;
    const json_t *light = json_array_get(all, (size_t)index);
    double color[3] = {1, 1, 1}, intensity = 1, range = 0, inner = 0, outer = MASU_BAKE_PI / 4;
    const char *type = masu_gltf_string(g, light, "type");
    const json_t *spot = masu_gltf_object(g, light, "spot");
    if (!masu_gltf_numbers(g, light, "color", 3, color) ||
        !masu_gltf_number(g, light, "intensity", &intensity) ||
        !masu_gltf_number(g, light, "range", &range) ||
        !masu_gltf_number(g, spot, "innerConeAngle", &inner) ||
        !masu_gltf_number(g, spot, "outerConeAngle", &outer))
        return false;
    bool directional = type && !strcmp(type, "directional");
    if (!directional && !(type && (!strcmp(type, "point") || !strcmp(type, "spot")))) {
        masu_gltf_note_one(g, "lights have an unknown type: ignored", at->mName.data);
        return true;
    }
    if (!(range >= 0 && range <= 1e9) ||
        (spot &&
         !(outer > 0 && outer <= MASU_BAKE_PI / 2 + 1e-6 && inner >= 0 && inner <= outer)) ||
        !(intensity >= 0 && fmin(color[0], fmin(color[1], color[2])) >= 0 &&
          intensity * fmax(color[0], fmax(color[1], color[2])) <=
              MASU_BAKE_PI * (directional ? MASU_BAKE_SUN_COLOR_MAX : 1e9)))
        masu_gltf_note_one(g, "lights have a colour, range or angle out of range: clamped",
                           at->mName.data);
    struct aiLight *made = masu_gltf_take(g, 1, sizeof *made);
    made->mName = at->mName;
    made->mType = directional                 ? aiLightSource_DIRECTIONAL
                  : strcmp(type, "spot") == 0 ? aiLightSource_SPOT
                                              : aiLightSource_POINT;
    made->mDirection.z = -1;
    made->mColorDiffuse =
        (struct aiColor3D){(float)(color[0] * intensity), (float)(color[1] * intensity),
                           (float)(color[2] * intensity)};
    made->mAngleInnerCone = (float)inner;
    made->mAngleOuterCone = (float)outer;
    float reach = masu_import_clamped(range, 0, 1e9);
    masu_bake_append(&g->lights, &made, sizeof made);
    masu_bake_append(&g->ranges, &reach, sizeof reach);
    return true;
}

static bool add_camera(masu_gltf *g, const json_t *node, const struct aiNode *at) {
    json_int_t index = -1;
    if (!masu_gltf_index(g, node, "camera", masu_gltf_count(g, "cameras"), &index)) return false;
    if (index < 0) return true;
    const json_t *camera = masu_gltf_element(g, "cameras", index);
    const json_t *lens = camera ? masu_gltf_object(g, camera, "perspective") : NULL;
    double height = 0, aspect = 16.0 / 9;
    if (!camera || masu_gltf_failed(g)) return false;
    const json_t *flat = camera ? masu_gltf_object(g, camera, "orthographic") : NULL;
    double mag[2] = {0, 0};
    if (!lens && !masu_gltf_number(g, flat, "xmag", &mag[0])) return false;
    if (!lens && !masu_gltf_number(g, flat, "ymag", &mag[1])) return false;
    if (!lens && !(mag[0] > 0 && mag[1] > 0)) {
        masu_gltf_note_one(g, "cameras without perspective or size, which are not supported",
                           at->mName.data);
        return true;
    }
    if (!masu_gltf_number(g, lens, "yfov", &height) ||
        !masu_gltf_number(g, lens, "aspectRatio", &aspect))
        return false;
    if (!lens) aspect = mag[0] / mag[1];
    aspect = aspect > 1e-3 && aspect < 1e3 ? aspect : 16.0 / 9;
    height = (double)masu_import_clamped(height, 0, 3.1);
    struct aiCamera *made = masu_gltf_take(g, 1, sizeof *made);
    made->mName = at->mName;
    made->mLookAt.z = -1;
    made->mUp.y = 1;
    made->mAspect = (float)aspect;
    made->mOrthographicWidth = lens ? 0 : (float)(mag[1] * aspect);
    made->mHorizontalFOV = (float)(2 * atan(tan(height / 2) * aspect));
    masu_bake_append(&g->cameras, &made, sizeof made);
    return true;
}

/* A node with many mesh instances, each with a transform: adds a child for each. */
static bool add_instances(masu_gltf *g, const json_t *about, struct aiNode *node) {
    static const char *const names[] = {"TRANSLATION", "ROTATION", "SCALE"};
    const json_t *attributes = masu_gltf_object(g, about, "attributes");
    const float *values[3] = {NULL, NULL, NULL};
    uint32_t count = 0;
    size_t known = 0;
    for (int a = 0; a < 3; a++) {
        json_int_t index = -1;
        uint32_t own = 0;
        if (!masu_gltf_index(g, attributes, names[a], masu_gltf_count(g, "accessors"), &index))
            return false;
        if (index < 0) continue;
        if (!(values[a] = masu_gltf_floats(g, index, a == 1 ? 4 : 3, &own, NULL))) return false;
        if (count && own != count)
            return masu_gltf_fail(g, "EXT_mesh_gpu_instancing: %s has %u, others %u", names[a], own,
                                  count);
        count = own;
    }
    for (int a = 0; a < 3; a++) known += json_object_get(attributes, names[a]) != NULL;
    if (json_object_size(attributes) > known)
        masu_gltf_note_one(
            g, "nodes have attributes of instances other than their transforms: ignored",
            node->mName.data);
    if (!count)
        return !attributes || masu_gltf_fail(g, "EXT_mesh_gpu_instancing has no attributes");
    static const char what[] = "instances";
    if (count > INSTANCES_MAX) return masu_gltf_fail(g, "more than 4 million %s", what);
    struct aiNode **children =
        masu_gltf_take(g, (size_t)node->mNumChildren + count, sizeof *children);
    struct aiNode *made = masu_gltf_take(g, count, sizeof *made);
    for (unsigned i = 0; i < node->mNumChildren; i++) children[i] = node->mChildren[i];
    for (uint32_t i = 0; i < count; i++) {
        double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
        char name[1024];
        for (int k = 0; k < 3 && values[0]; k++)
            t[k] = (double)values[0][3 * (size_t)i + (size_t)k];
        for (int k = 0; k < 4 && values[1]; k++)
            q[k] = (double)values[1][4 * (size_t)i + (size_t)k];
        for (int k = 0; k < 3 && values[2]; k++)
            s[k] = (double)values[2][3 * (size_t)i + (size_t)k];
        made[i].mTransformation = matrix_of(t, q, s);
        made[i].mMeshes = node->mMeshes;
        made[i].mNumMeshes = node->mNumMeshes;
        snprintf(name, sizeof name, "%.900s.%u", node->mName.data, i);
        masu_gltf_set_string(&made[i].mName, name);
        children[node->mNumChildren + i] = &made[i];
    }
    node->mChildren = children;
    node->mNumChildren += count;
    node->mNumMeshes = 0;
    return true;
}

static bool fill_node(masu_gltf *g, size_t index) {
    const json_t *node = masu_gltf_element(g, "nodes", (json_int_t)index);
    struct aiNode *to = &g->nodes[index];
    json_int_t mesh = -1, skin = -1;
    if (!node) return false;
    masu_gltf_at(g, "nodes", index, node);
    const json_t *weights = masu_gltf_array(g, node, "weights");
    if (!masu_gltf_index(g, node, "mesh", g->mesh_count, &mesh) ||
        !masu_gltf_index(g, node, "skin", masu_gltf_count(g, "skins"), &skin) ||
        !add_light(g, node, to) || !add_camera(g, node, to))
        return false;
    if (mesh >= 0) {
        const masu_gltf_made *made = NULL;
        if (!masu_gltf_make_mesh(g, mesh, skin, weights, &made)) return false;
        to->mMeshes = (unsigned *)(uintptr_t)made->meshes;
        to->mNumMeshes = made->count;
        masu_gltf_at(g, "nodes", index, node);
    }
    const json_t *instances = masu_gltf_extension(g, node, "EXT_mesh_gpu_instancing");
    if (instances && !add_instances(g, instances, to)) return false;
    g->where[0] = masu_gltf_failed(g) ? g->where[0] : '\0';
    return !masu_gltf_failed(g);
}

/* ---- skins ---- */

static bool check_skins(masu_gltf *g) {
    for (size_t i = 0; i < masu_gltf_count(g, "skins"); i++) {
        const json_t *skin = masu_gltf_element(g, "skins", (json_int_t)i);
        if (!skin) return false;
        masu_gltf_at(g, "skins", i, skin);
        const json_t *joints = masu_gltf_array(g, skin, "joints");
        if (!json_array_size(joints)) return masu_gltf_fail(g, "it has no joints");
        for (size_t k = 0; k < json_array_size(joints); k++) {
            const json_t *joint = json_array_get(joints, k);
            if (!json_is_integer(joint) || json_integer_value(joint) < 0 ||
                (uint64_t)json_integer_value(joint) >= g->node_count)
                return masu_gltf_fail(g, "joints[%zu] is not a node", k);
        }
    }
    g->where[0] = '\0';
    return true;
}

/* ---- all nodes ---- */

/* Reverses the last `count` nodes of a stack, so that the first one is popped first. */
static void reverse(masu_bake_buffer *stack, size_t count) {
    if (count < 2) return;
    struct aiNode **at = (struct aiNode **)(void *)(stack->data + stack->bytes) - count;
    for (size_t i = 0; i < count / 2; i++) {
        struct aiNode *node = at[i];
        at[i] = at[count - 1 - i];
        at[count - 1 - i] = node;
    }
}

bool masu_gltf_read_nodes(masu_gltf *g) {
    g->node_count = masu_gltf_count(g, "nodes");
    g->mesh_count = masu_gltf_count(g, "meshes");
    g->made = masu_gltf_take(g, g->mesh_count, sizeof *g->made);
    g->nodes = masu_gltf_take(g, g->node_count + 1, sizeof *g->nodes);
    bool *is_child = masu_gltf_take(g, g->node_count, 1);
    struct aiNode *root = &g->nodes[g->node_count];
    root->mTransformation.a1 = root->mTransformation.b2 = root->mTransformation.c3 =
        root->mTransformation.d4 = 1;
    masu_gltf_set_string(&root->mName, "ROOT");
    name_nodes(g);
    for (size_t i = 0; i < g->node_count; i++) {
        const json_t *node = masu_gltf_element(g, "nodes", (json_int_t)i);
        if (!node) return false;
        masu_gltf_at(g, "nodes", i, node);
        (void)masu_gltf_string(g, node, "name");
        if (!transform_of(g, node, &g->nodes[i].mTransformation) ||
            !link_children(g, i, node, is_child))
            return false;
    }
    g->where[0] = '\0';
    if (!check_skins(g) || !find_roots(g, is_child, root)) return false;
    /* Depth first, with an explicit stack. The visible nodes are a tree, so each node is reached
     * once. Some exporters keep nodes outside the scene that have children in the scene; such
     * parents are not reached. */
    bool *reached = masu_gltf_take(g, g->node_count, 1);
    masu_bake_buffer stack = {0};
    masu_bake_append(&stack, root->mChildren, root->mNumChildren * sizeof(struct aiNode *));
    reverse(&stack, root->mNumChildren);
    bool good = true;
    while (good && stack.bytes) {
        struct aiNode *node;
        stack.bytes -= sizeof node;
        memcpy(&node, stack.data + stack.bytes, sizeof node);
        size_t index = (size_t)(node - g->nodes);
        if (reached[index]) {
            good = masu_gltf_fail(
                g, "nodes[%zu] is twice in the scene: as a root, or a child of two nodes", index);
            break;
        }
        reached[index] = true;
        masu_bake_append(&stack, node->mChildren, node->mNumChildren * sizeof node);
        reverse(&stack, node->mNumChildren);
        good = fill_node(g, index);
    }
    masu_bake_release(&stack);
    if (!good) return false;
    size_t only = masu_gltf_count(g, "scenes") == 1 ? g->node_count : 0;
    for (size_t i = 0; i < only; i++) {
        if (!reached[i] && json_object_get(masu_gltf_element(g, "nodes", (json_int_t)i), "mesh"))
            masu_gltf_note_one(g, "nodes with meshes are not in the scene: left out",
                               g->nodes[i].mName.data);
    }
    g->scene.mRootNode = root->mNumChildren == 1 ? root->mChildren[0] : root;
    return true;
}
