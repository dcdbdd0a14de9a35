/* check_models.c: validates movable models: each node belongs to one model, and models of one kind
 * are alike. Model and instance transforms need not agree; after the first move of the model they
 * do. */
#include "scene/check.h"

static masu_result check_node(reader *r, const masu_blob_model *m, uint64_t n) {
    const masu_blob_model_node *node = &r->view.model_nodes[n];
    if (!finite_all(node->local, 12)) return bad(r, "model nodes", n, "transform is not finite");
    if (node->parent != MASU_BLOB_NONE && (node->parent < m->first_node || node->parent >= n))
        return bad(r, "model nodes", n, "parent is no node of its model before it");
    if (node->instance != MASU_BLOB_NONE && node->instance >= r->counts[MASU_BLOB_INSTANCES])
        return bad(r, "model nodes", n, "no such instance");
    if (node->skin > r->counts[MASU_BLOB_SKINS]) return bad(r, "model nodes", n, "no such skin");
    return name_ok(r, node->name) ? MASU_OK
                                  : bad(r, "model nodes", n, "name lies outside the names");
}

/* Models of one kind have the same meshes at the same nodes. Skinned meshes are unique to a model;
 * check_skin.c compares these. */
static int alike(const masu_scene_view *v, const masu_blob_model *a, const masu_blob_model *b) {
    for (uint32_t k = 0; k < a->node_count; k++) {
        uint32_t x = v->model_nodes[a->first_node + k].instance;
        uint32_t y = v->model_nodes[b->first_node + k].instance;
        if ((x == MASU_BLOB_NONE) != (y == MASU_BLOB_NONE)) return 0;
        int bends =
            v->model_nodes[a->first_node + k].skin && v->model_nodes[b->first_node + k].skin;
        if (x != MASU_BLOB_NONE && !bends && v->instances[x].mesh != v->instances[y].mesh) return 0;
    }
    return 1;
}

masu_result masu_check_models(reader *r) {
    const masu_scene_view *v = &r->view;
    uint64_t models = r->counts[MASU_BLOB_MODELS], nodes = r->counts[MASU_BLOB_MODEL_NODES];
    uint64_t next = 0;
    if (!models != !nodes) return bad(r, "models", 0, "are there without nodes, or nodes alone");
    for (uint64_t i = 0; i < models; i++) {
        const masu_blob_model *m = &v->models[i];
        if (!finite_all(m->transform, 12)) return bad(r, "models", i, "transform is not finite");
        if (!name_ok(r, m->name)) return bad(r, "models", i, "name lies outside the names");
        if (m->flags & ~(uint32_t)MASU_MODEL_HIDDEN) return bad(r, "models", i, "unknown flags");
        if (m->first_node != next || !m->node_count || m->node_count > nodes - next)
            return bad(r, "models", i, "nodes are not the next of the nodes");
        next += m->node_count;
        for (uint64_t n = m->first_node; n < next; n++) {
            masu_result result = check_node(r, m, n);
            if (result) return result;
        }
        if (m->like > i || v->models[m->like].like != m->like ||
            v->models[m->like].node_count != m->node_count ||
            !alike(v, m, &v->models[m->like])) {
            return bad(r, "models", i, "is not like the model that it says");
        }
    }
    return next == nodes ? MASU_OK : bad(r, "model nodes", next, "belongs to no model");
}
