/* live.c: see live.h. */
#include "bake/scene/live.h"

#include "bake/scene/skin.h"

#include <stdlib.h>
#include <string.h>

#define MODELS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_MODELS, masu_blob_model)
#define NODES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_MODEL_NODES, masu_blob_model_node)

static void store(const masu_bake_affine *from, float to[12]) {
    for (int k = 0; k < 12; k++) to[k] = (float)from->m[k];
}

/* The transform from the space of the instance above to its own; false if the former has
 * no inverse, or beyond the coordinate limit. */
static bool relative(const masu_bake_affine *above, const masu_bake_affine *world,
                     masu_bake_affine *local) {
    masu_bake_affine inverse;
    if (!masu_bake_invert(above, &inverse)) return false;
    *local = masu_bake_multiply(&inverse, world);
    for (int k = 0; k < 12; k++) {
        if (!(fabs(local->m[k]) <= MASU_BAKE_COORDINATE_MAX)) return false;
    }
    return true;
}

/* Adds a node for each instance. */
static void add_instances(masu_bake_content *content, const masu_bake_content *piece,
                          uint64_t first, const masu_bake_affine *back, uint32_t first_node) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_INSTANCES) - first;
    for (uint32_t i = 0; i < count; i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(content)[first + i];
        const char *text = masu_bake_name_text(piece, MASU_BAKE_INSTANCES(piece)[i].name);
        masu_bake_affine world = masu_bake_transform(n), local;
        masu_blob_model_node node = {.parent = MASU_BLOB_NONE,
                                     .instance = (uint32_t)first + i,
                                     .name = masu_bake_name(content, text, strlen(text))};
        if (n->parent != MASU_BLOB_NONE && n->parent >= first && n->parent < first + i) {
            masu_bake_affine above = masu_bake_transform(&MASU_BAKE_INSTANCES(content)[n->parent]);
            if (relative(&above, &world, &local))
                node.parent = first_node + n->parent - (uint32_t)first;
        }
        if (node.parent == MASU_BLOB_NONE) local = masu_bake_multiply(back, &world);
        store(&local, node.local);
        masu_bake_append(&content->section[MASU_BLOB_MODEL_NODES], &node, sizeof node);
    }
}

/* Adds the piece's nodes; the topmost ones contain the piece's placement. */
static void add_nodes(masu_bake_content *content, const masu_bake_content *piece, uint64_t first,
                      const masu_bake_affine *own, uint32_t first_node) {
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_MODEL_NODES); i++) {
        masu_blob_model_node node = NODES(piece)[i];
        const char *text = masu_bake_name_text(piece, node.name);
        node.name = masu_bake_name(content, text, strlen(text));
        node.skin = 0; /* masu_bake_add_skins sets it */
        if (node.instance != MASU_BLOB_NONE) node.instance += (uint32_t)first;
        if (node.parent != MASU_BLOB_NONE) {
            node.parent += first_node;
        } else {
            masu_bake_affine local;
            for (int k = 0; k < 12; k++) local.m[k] = (double)node.local[k];
            local = masu_bake_multiply(own, &local);
            store(&local, node.local);
        }
        masu_bake_append(&content->section[MASU_BLOB_MODEL_NODES], &node, sizeof node);
    }
}

uint32_t masu_bake_add_model(masu_bake_content *content, const masu_bake_content *piece,
                             uint64_t first, const masu_bake_affine *placement,
                             masu_bake_vec3 translation, const char *name, bool hidden,
                             uint32_t like) {
    uint32_t index = (uint32_t)masu_bake_count(content, MASU_BLOB_MODELS);
    uint32_t first_node = (uint32_t)masu_bake_count(content, MASU_BLOB_MODEL_NODES);
    masu_bake_affine own = masu_bake_translation(translation);
    masu_bake_vec3 zero = {0, 0, 0};
    masu_bake_affine back = masu_bake_translation(masu_bake_sub(zero, translation));
    masu_bake_affine inside = masu_bake_multiply(&back, placement);
    if (masu_bake_count(piece, MASU_BLOB_MODEL_NODES))
        add_nodes(content, piece, first, &inside, first_node);
    else
        add_instances(content, piece, first, &back, first_node);
    masu_blob_model model = {
        .first_node = first_node,
        .node_count = (uint32_t)masu_bake_count(content, MASU_BLOB_MODEL_NODES) - first_node,
        .name = name ? masu_bake_name(content, name, strlen(name)) : MASU_BLOB_NONE,
        .flags = hidden ? MASU_MODEL_HIDDEN : 0,
        .like = like == MASU_BLOB_NONE ? index : like};
    store(&own, model.transform);
    masu_bake_append(&content->section[MASU_BLOB_MODELS], &model, sizeof model);
    masu_bake_add_skins(content, piece, index);
    if (like == MASU_BLOB_NONE) masu_bake_add_clips(content, piece, index);
    return index;
}

void masu_bake_carry_lights(masu_bake_content *content, uint64_t first_light,
                            uint64_t first_instance) {
    masu_bake_affine carrier =
        masu_bake_transform(&MASU_BAKE_INSTANCES(content)[first_instance]);
    masu_bake_affine inverse;
    if (!masu_bake_invert(&carrier, &inverse)) return;
    for (uint64_t i = first_light; i < masu_bake_count(content, MASU_BLOB_LIGHTS); i++) {
        masu_blob_light *light = &MASU_BAKE_LIGHTS(content)[i];
        if (light->parent != MASU_BLOB_NONE) continue;
        masu_bake_vec3 at = masu_bake_v3f(light->position);
        masu_bake_vec3 to = masu_bake_mad(at, masu_bake_v3f(light->direction), 1);
        masu_bake_vec3 other = masu_bake_mad(at, masu_bake_v3f(light->half_axis), 1);
        uint32_t type = light->type & MASU_LIGHT_TYPE;
        masu_bake_vec3 moved = masu_bake_apply(&inverse, at);
        masu_bake_vec3 ahead = masu_bake_sub(masu_bake_apply(&inverse, to), moved);
        if (!masu_bake_sane(moved)) continue;
        if (type == MASU_LIGHT_SPOT && !masu_bake_normalize(&ahead)) continue;
        masu_bake_store(moved, light->position);
        if (type != MASU_LIGHT_POINT && type != MASU_LIGHT_SPHERE)
            masu_bake_store(ahead, light->direction);
        other = masu_bake_sub(masu_bake_apply(&inverse, other), moved);
        masu_bake_store(other, light->half_axis);
        light->parent = (uint32_t)first_instance;
    }
}

void masu_bake_renumber_models(masu_bake_content *content, const uint32_t *place) {
    for (uint64_t n = 0; n < masu_bake_count(content, MASU_BLOB_MODEL_NODES); n++) {
        masu_blob_model_node *node = &NODES(content)[n];
        if (node->instance != MASU_BLOB_NONE) node->instance = place[node->instance];
    }
}

unsigned char *masu_bake_hidden(const masu_bake_content *content) {
    size_t count = (size_t)masu_bake_count(content, MASU_BLOB_INSTANCES);
    unsigned char *hidden = masu_bake_allocate(count + 1);
    memset(hidden, 0, count + 1);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_MODELS); i++) {
        const masu_blob_model *m = &MODELS(content)[i];
        if (!(m->flags & MASU_MODEL_HIDDEN)) continue;
        for (uint32_t k = 0; k < m->node_count; k++) {
            uint32_t instance = NODES(content)[m->first_node + k].instance;
            if (instance != MASU_BLOB_NONE) hidden[instance] = 1;
        }
    }
    return hidden;
}
