/* check_trace.c: validates the ray tracing data.
 *
 * Traversal of a validated BVH terminates, reads only its sections and needs at most
 * MASU_TRACE_DEPTH_MAX 32-bit values of stack, for any box contents. The check visits the nodes in
 * the only permitted order, in which the index of the next children follows from the number of
 * previous ones, so it needs no visited flags. Boxes that do not contain their items can only lose
 * hits; they are not checked. */
#include "scene/check.h"

/* Validates node `i`: its children and items must be the next ones. */
static const char *check_node(const masu_blob_trace_node *n, uint64_t *next_node,
                              uint64_t *next_item, uint32_t *children) {
    uint32_t nodes = 0, items = 0, before = 1;
    for (uint32_t slot = 0; slot < 4; slot++) {
        uint32_t type = masu_trace_type(n, slot);
        if (type == 1 && before != 1) return "has a child node behind a leaf";
        if (type >= 2 && !before) return "has a leaf behind an empty place";
        before = type;
        nodes += type == 1;
        items += type > 1 ? type - 1 : 0;
    }
    if (!within(n->origin, 3, -MASU_TRACE_REACH, MASU_TRACE_REACH))
        return "origin is not finite or too far out";
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t exponent = n->packed >> 8 * k & 0xFFu;
        /* 255 * 2^43 is the first value beyond twice MASU_TRACE_REACH. */
        if (exponent < 1 || exponent > 127 + 43) return "scale is out of range";
    }
    if (nodes && n->child != *next_node) return "children are not the next nodes";
    if (items && n->item != *next_item) return "triangles are not the next ones";
    *next_node += nodes;
    *next_item += items;
    *children = nodes;
    return NULL;
}

static masu_result check_tree(reader *r, const masu_blob_trace_mesh *m) {
    const masu_blob_trace_node *nodes = r->view.trace_nodes;
    uint64_t next_node = (uint64_t)m->first_node + 1, next_item = m->first_triangle;
    uint64_t end = (uint64_t)m->first_node + m->node_count;
    struct {
        uint32_t node, left; /* next sibling to visit, number of siblings left */
    } stack[MASU_TRACE_DEPTH_MAX + 1];
    uint32_t levels = 1, deepest = 1;
    stack[0].node = m->first_node;
    stack[0].left = 1;
    while (levels > 0) {
        if (!stack[levels - 1].left) {
            levels--;
            continue;
        }
        uint32_t i = stack[levels - 1].node++, children = 0;
        stack[levels - 1].left--;
        if (levels > deepest) deepest = levels;
        const char *problem = check_node(&nodes[i], &next_node, &next_item, &children);
        if (!problem && next_node > end) problem = "has children outside of its mesh";
        if (!problem && children && levels == MASU_TRACE_DEPTH_MAX) problem = "lies too deep";
        if (problem) return bad(r, "trace nodes", i, problem);
        stack[levels].node = nodes[i].child;
        stack[levels].left = children;
        levels += children > 0;
    }
    uint64_t mesh = (uint64_t)(m - r->view.trace_meshes);
    if (next_node != end || next_item != (uint64_t)m->first_triangle + m->triangle_count)
        return bad(r, "trace meshes", mesh, "has nodes or triangles that its tree does not reach");
    if (deepest != m->depth) return bad(r, "trace meshes", mesh, "has another depth");
    return MASU_OK;
}

static masu_result check_triangles(reader *r, const masu_blob_trace_mesh *m,
                                   const masu_blob_mesh *mesh) {
    uint64_t triangles = 0;
    for (uint32_t p = 0; p < mesh->primitive_count; p++)
        triangles += r->view.primitives[mesh->first_primitive + p].index_count / 3;
    if (m->triangle_count > triangles)
        return bad(r, "trace meshes", (uint64_t)(m - r->view.trace_meshes),
                   "has more triangles than its mesh");
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const masu_blob_trace_triangle *t = &r->view.trace_triangles[m->first_triangle + i];
        if (t->primitive < mesh->first_primitive ||
            t->primitive - mesh->first_primitive >= mesh->primitive_count) {
            return bad(r, "trace triangles", m->first_triangle + i, "is of another mesh");
        }
        const masu_blob_primitive *p = &r->view.primitives[t->primitive];
        for (uint32_t k = 0; k < 3; k++) {
            if (t->vertex[k] < p->first_vertex || t->vertex[k] - p->first_vertex >= p->vertex_count)
                return bad(r, "trace triangles", m->first_triangle + i,
                           "has a vertex of another primitive");
        }
    }
    return MASU_OK;
}

static masu_result check_instances(reader *r) {
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TRACE_INSTANCES]; i++) {
        uint32_t instance = r->view.trace_instances[i];
        if (instance >= r->counts[MASU_BLOB_INSTANCES])
            return bad(r, "trace instances", i, "no such instance");
        if (i && instance <= r->view.trace_instances[i - 1])
            return bad(r, "trace instances", i, "does not rise");
        if (!r->view.trace_meshes[r->view.instances[instance].mesh].node_count)
            return bad(r, "trace instances", i, "is of a mesh that is not traced");
    }
    return MASU_OK;
}

static masu_result check_trees(reader *r) {
    const masu_scene_view *v = &r->view;
    uint64_t nodes = 0, triangles = 0;
    int some = v->trace_nodes || v->trace_triangles || v->trace_meshes || v->trace_instances;
    int all = v->trace_nodes && v->trace_triangles && v->trace_meshes && v->trace_instances;
    if (!some) return MASU_OK;
    if (!all) return bad(r, "trace nodes", 0, "are there in part");
    if (r->counts[MASU_BLOB_TRACE_MESHES] != r->counts[MASU_BLOB_MESHES])
        return bad(r, "trace meshes", r->counts[MASU_BLOB_TRACE_MESHES],
                   "are not as many as meshes");
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TRACE_MESHES]; i++) {
        const masu_blob_trace_mesh *m = &v->trace_meshes[i];
        if (!m->node_count) {
            if (m->first_node | m->first_triangle | m->triangle_count | m->depth)
                return bad(r, "trace meshes", i, "has no nodes, but something else");
            continue;
        }
        if (m->first_node != nodes || m->first_triangle != triangles)
            return bad(r, "trace meshes", i, "does not begin where the one before ends");
        nodes += m->node_count;
        triangles += m->triangle_count;
        if (nodes > r->counts[MASU_BLOB_TRACE_NODES] ||
            triangles > r->counts[MASU_BLOB_TRACE_TRIANGLES]) {
            return bad(r, "trace meshes", i, "lies outside of its sections");
        }
        masu_result result = check_tree(r, m);
        if (!result) result = check_triangles(r, m, &v->meshes[i]);
        if (result) return result;
    }
    if (nodes != r->counts[MASU_BLOB_TRACE_NODES])
        return bad(r, "trace nodes", nodes, "is of no mesh");
    if (triangles != r->counts[MASU_BLOB_TRACE_TRIANGLES])
        return bad(r, "trace triangles", triangles, "is of no mesh");
    return check_instances(r);
}

static masu_result check_reflections(reader *r) {
    const masu_blob_reflections *f = r->view.reflections;
    int traced = r->view.trace_nodes || r->view.code[MASU_BLOB_TRACE_SDF_SPIRV].words ||
                 r->view.code[MASU_BLOB_BOUNCE_SDF_SPIRV].words;
    if (!f)
        return traced ? bad(r, "reflections", 0, "are not there, but what they trace is") : MASU_OK;
    if (!within(&f->cutoff, 1, 0.0f, 1.0f) || !within(&f->glossiest, 1, 0.0f, 1.0f) ||
        !within(&f->distance, 1, 1e-3f, 1e9f)) {
        return bad(r, "reflections", 0, "a value is out of range");
    }
    return MASU_OK;
}

static masu_result check_pictures(reader *r) {
    uint64_t count = r->counts[MASU_BLOB_TRACE_TEXTURES], next = 0;
    if (!r->view.trace_textures != !r->view.trace_texels)
        return bad(r, "trace textures", 0, "are there in part");
    if (count && !r->view.trace_nodes) return bad(r, "trace textures", 0, "are of nothing traced");
    for (uint64_t i = 0; i < count; i++) {
        const masu_blob_trace_texture *t = &r->view.trace_textures[i], *before = t - 1;
        if (t->texture >= r->counts[MASU_BLOB_TEXTURES] ||
            t->layer >= r->view.textures[t->texture].layers)
            return bad(r, "trace textures", i, "no such texture");
        if (i && (t->texture < before->texture ||
                  (t->texture == before->texture && t->layer <= before->layer)))
            return bad(r, "trace textures", i, "is not in order");
        if (!t->width || !t->height || t->width > MASU_TRACE_TEXTURE_MAX ||
            t->height > MASU_TRACE_TEXTURE_MAX)
            return bad(r, "trace textures", i, "a side is not 1 to 256");
        if (t->first != next)
            return bad(r, "trace textures", i, "does not begin where the one before ends");
        next += masu_blob_trace_texels(t->width, t->height);
    }
    if (next != r->counts[MASU_BLOB_TRACE_TEXELS])
        return bad(r, "trace texels", next, "is of no picture");
    return MASU_OK;
}

void masu_describe_trace(const reader *r, masu_scene_data *out) {
    out->trace_nodes = (uint32_t)r->counts[MASU_BLOB_TRACE_NODES];
    out->trace_triangles = (uint32_t)r->counts[MASU_BLOB_TRACE_TRIANGLES];
    out->trace_instances = (uint32_t)r->counts[MASU_BLOB_TRACE_INSTANCES];
    out->trace_levels = 0;
    for (uint32_t i = 0; r->view.trace_meshes && i < out->meshes; i++) {
        uint32_t levels = r->view.trace_meshes[i].depth;
        if (levels > out->trace_levels) out->trace_levels = levels;
    }
    out->trace_textures = (uint32_t)r->counts[MASU_BLOB_TRACE_TEXTURES];
    out->trace_texels = r->counts[MASU_BLOB_TRACE_TEXELS];
    for (uint32_t i = 0; i < out->trace_textures; i++) {
        uint32_t format = r->view.textures[r->view.trace_textures[i].texture].format;
        out->trace_colors += format == MASU_TEXTURE_BC1_SRGB || format == MASU_TEXTURE_BC3_SRGB;
    }
    const masu_blob_reflections *f = r->view.reflections;
    if (!f) return;
    out->reflections = f->cutoff > 0.0f;
    out->trace_sdf = r->view.code[MASU_BLOB_TRACE_SDF_SPIRV].words != NULL;
    out->specular_cutoff = f->cutoff;
    out->glossiest = f->glossiest;
    out->trace_distance = f->distance;
}

masu_result masu_check_trace(reader *r) {
    masu_result result = check_reflections(r);
    if (!result) result = check_pictures(r);
    return result ? result : check_trees(r);
}
