/* bvh.c: see bvh.h. */
#include "bake/mesh/bvh.h"
#include "bake/base/process.h"

#include "bake/texture/trace_texture.h"

#include "cli/cli.h"
#include "scene/cull.h"
#include "scene/trace_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct baker {
    masu_bake_content *content;
    masu_bake_bvh_report *report;
    masu_bake_buffer triangles; /* masu_blob_trace_triangle, of the mesh at hand */
    masu_bake_buffer boxes;     /* masu_trace_box of each */
    double cost;                /* times triangles */
} baker;

void masu_bake_mark_traced(masu_bake_content *content, uint64_t first, int traced) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_INSTANCES);
    if (traced == MASU_BAKE_TRACED_AUTO) return;
    if (content->traced.bytes < count)
        masu_bake_append(&content->traced, NULL, (size_t)(count - content->traced.bytes));
    memset(content->traced.data + first, traced, (size_t)(count - first));
}

masu_bake_reflections masu_bake_reflection_defaults(void) {
    return (masu_bake_reflections){
        .smallest = -1, .cutoff = 0.5, .distance = 1e4, .texture_size = MASU_BAKE_TRACE_SIDE};
}

/* ---- Which instances ------------------------------------------------------------------------- */

static masu_bake_box box_of(const masu_bake_content *content, uint64_t i) {
    const masu_blob_instance *n = &MASU_BAKE_INSTANCES(content)[i];
    const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[n->mesh];
    masu_cull_box b = masu_cull_place(n->transform, mesh->aabb_min, mesh->aabb_max);
    masu_bake_vec3 c = masu_bake_v3f(b.center), h = masu_bake_v3f(b.half);
    return (masu_bake_box){masu_bake_sub(c, h), masu_bake_mad(c, h, 1)};
}

static double diagonal_of(const masu_bake_box *b) {
    masu_bake_vec3 d = masu_bake_sub(b->high, b->low);
    return sqrt(masu_bake_dot(d, d));
}

/* Marks instances, and meshes that have a marked instance. */
static void choose(const baker *b, double smallest, unsigned char *instances,
                   unsigned char *meshes) {
    uint64_t count = masu_bake_count(b->content, MASU_BLOB_INSTANCES);
    if (smallest < 0) {
        masu_bake_box all = masu_bake_box_empty();
        for (uint64_t i = 0; i < count; i++) {
            masu_bake_box box = box_of(b->content, i);
            masu_bake_box_grow(&all, box.low);
            masu_bake_box_grow(&all, box.high);
        }
        smallest = count ? MASU_BAKE_TRACED_SHARE * diagonal_of(&all) : 0;
    }
    for (uint64_t i = 0; i < count; i++) {
        int said =
            i < b->content->traced.bytes ? b->content->traced.data[i] : MASU_BAKE_TRACED_AUTO;
        masu_bake_box box = box_of(b->content, i);
        bool small = diagonal_of(&box) < smallest;
        instances[i] = said == MASU_BAKE_TRACED_YES || (said == MASU_BAKE_TRACED_AUTO && !small);
        b->report->small += said == MASU_BAKE_TRACED_AUTO && small;
        if (instances[i]) meshes[MASU_BAKE_INSTANCES(b->content)[i].mesh] = 1;
    }
}

/* ---- A mesh ---------------------------------------------------------------------------------- */

static const float *position(const baker *b, uint32_t vertex) {
    return MASU_BAKE_VERTICES(b->content)[vertex].position;
}

/* In double precision, differences of floats of similar size are exact. A triangle that is flat
 * after rounding has a negligible area. */
static bool has_area(const float *a, const float *b, const float *c) {
    masu_bake_vec3 n = masu_bake_cross(masu_bake_sub(masu_bake_v3f(b), masu_bake_v3f(a)),
                                       masu_bake_sub(masu_bake_v3f(c), masu_bake_v3f(a)));
    return masu_bake_dot(n, n) > 0;
}

static void add_triangle(baker *b, const uint32_t vertex[3], uint32_t primitive) {
    masu_trace_box box;
    const float *corner[3] = {position(b, vertex[0]), position(b, vertex[1]),
                              position(b, vertex[2])};
    bool good = true;
    for (int k = 0; k < 3; k++) {
        box.low[k] = fminf(corner[0][k], fminf(corner[1][k], corner[2][k]));
        box.high[k] = fmaxf(corner[0][k], fmaxf(corner[1][k], corner[2][k]));
        good = good && box.low[k] >= -MASU_TRACE_REACH && box.high[k] <= MASU_TRACE_REACH;
    }
    if (!good || !has_area(corner[0], corner[1], corner[2])) {
        b->report->flat++;
        return;
    }
    masu_blob_trace_triangle t = {{vertex[0], vertex[1], vertex[2]}, primitive};
    masu_bake_append(&b->triangles, &t, sizeof t);
    masu_bake_append(&b->boxes, &box, sizeof box);
}

static void gather(baker *b, const masu_blob_mesh *mesh) {
    b->triangles.bytes = b->boxes.bytes = 0;
    for (uint32_t p = mesh->first_primitive; p < mesh->first_primitive + mesh->primitive_count;
         p++) {
        const masu_blob_primitive *at = &MASU_BAKE_PRIMITIVES(b->content)[p];
        if (MASU_BAKE_MATERIALS(b->content)[at->material].flags & MASU_MATERIAL_IS_BLEND) continue;
        for (uint32_t i = 0; i < at->index_count; i += 3) {
            const uint32_t *index = &MASU_BAKE_INDICES(b->content)[at->first_index + i];
            const uint32_t vertex[3] = {at->first_vertex + index[0], at->first_vertex + index[1],
                                        at->first_vertex + index[2]};
            add_triangle(b, vertex, p);
        }
    }
}

static bool grow_tree(baker *b, masu_blob_trace_mesh *out) {
    masu_bake_buffer *nodes = &b->content->section[MASU_BLOB_TRACE_NODES];
    masu_bake_buffer *triangles = &b->content->section[MASU_BLOB_TRACE_TRIANGLES];
    uint32_t count = (uint32_t)(b->triangles.bytes / sizeof(masu_blob_trace_triangle));
    const masu_blob_trace_triangle *found = (const void *)b->triangles.data;
    const masu_trace_box *boxes = (const void *)b->boxes.data;
    if (!count) return true;
    uint32_t room = masu_trace_tree_nodes(count);
    uint64_t before = nodes->bytes / sizeof(masu_blob_trace_node);
    out->first_node = (uint32_t)before;
    out->first_triangle = (uint32_t)(triangles->bytes / sizeof *found);
    uint32_t *order = masu_bake_allocate(2 * (size_t)count * sizeof *order);
    masu_trace_below *below = masu_bake_allocate(room * sizeof *below);
    masu_blob_trace_node *tree = masu_bake_allocate(room * sizeof *tree);
    masu_trace_shape shape =
        masu_trace_tree_shape(boxes, count, 2, MASU_TRACE_DEPTH_MAX, out->first_node,
                              out->first_triangle, order, order + count, tree);
    bool good = before + shape.nodes <= MASU_TRACE_NODES_MAX && shape.depth <= MASU_TRACE_DEPTH_MAX;
    if (good) {
        (void)masu_trace_tree_fit(tree, shape.nodes, out->first_node, out->first_triangle, order,
                                  boxes, below);
        b->cost += (double)below[0].cost * count;
        masu_bake_append(nodes, tree, shape.nodes * sizeof *tree);
        for (uint32_t i = 0; i < count; i++)
            masu_bake_append(triangles, &found[order[i]], sizeof *found);
        out->node_count = shape.nodes;
        out->triangle_count = count;
        out->depth = shape.depth;
        if (shape.depth > b->report->depth) b->report->depth = shape.depth;
        b->report->meshes++;
    } else {
        masu_cli_error("reflections: found a BVH of %u levels, expected at most %u; %llu nodes in "
                       "total, expected at most %u",
                       shape.depth, MASU_TRACE_DEPTH_MAX,
                       (unsigned long long)(before + shape.nodes), MASU_TRACE_NODES_MAX);
    }
    free(order);
    free(below);
    free(tree);
    return good;
}

/* ---- The scene ------------------------------------------------------------------------------- */

static bool grow_trees(baker *b, const unsigned char *meshes) {
    masu_bake_buffer *out = &b->content->section[MASU_BLOB_TRACE_MESHES];
    for (uint64_t i = 0; i < masu_bake_count(b->content, MASU_BLOB_MESHES); i++) {
        masu_blob_trace_mesh m = {0};
        if (meshes[i]) {
            gather(b, &MASU_BAKE_MESHES(b->content)[i]);
            if (!grow_tree(b, &m)) return false;
        }
        masu_bake_append(out, &m, sizeof m);
    }
    return true;
}

static void list_instances(const baker *b, const unsigned char *instances) {
    const masu_blob_trace_mesh *meshes =
        MASU_BAKE_ARRAY(b->content, MASU_BLOB_TRACE_MESHES, const masu_blob_trace_mesh);
    for (uint32_t i = 0; i < masu_bake_count(b->content, MASU_BLOB_INSTANCES); i++) {
        if (!instances[i] || !meshes[MASU_BAKE_INSTANCES(b->content)[i].mesh].node_count) continue;
        masu_bake_append(&b->content->section[MASU_BLOB_TRACE_INSTANCES], &i, sizeof i);
    }
}

static void fill_report(const baker *b) {
    masu_bake_bvh_report *r = b->report;
    r->instances = masu_bake_count(b->content, MASU_BLOB_TRACE_INSTANCES);
    r->nodes = masu_bake_count(b->content, MASU_BLOB_TRACE_NODES);
    r->triangles = masu_bake_count(b->content, MASU_BLOB_TRACE_TRIANGLES);
    for (uint32_t k = MASU_BLOB_TRACE_NODES; k <= MASU_BLOB_TRACE_INSTANCES; k++)
        r->bytes += b->content->section[k].bytes;
    r->cost = r->triangles ? b->cost / (double)r->triangles : 0;
}

/* The lowest roughness that a material can have anywhere. Small relief changes the roughness, but
 * not below that of its facets. */
static float least_of(const masu_bake_content *content, const masu_blob_material *m) {
    float roughness = m->roughness * masu_bake_trace_least(content, m);
    if (m->meso != MASU_BLOB_NONE) {
        float facet = MASU_BAKE_ARRAY(content, MASU_BLOB_MESO, const masu_blob_meso)[m->meso].facet;
        if (facet < roughness) roughness = facet;
    }
    float coat = m->flags & 1u << MASU_SLOT_COAT ? 0 : m->coat_roughness;
    return m->coat > 0 && coat < roughness ? coat : roughness;
}

/* The least roughness that anything may have. */
static float glossiest(const masu_bake_content *content) {
    float least = masu_bake_count(content, MASU_BLOB_SDF) ? content->sdf_glossiest : 1.0f;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_MATERIALS); i++) {
        const masu_blob_material *m = &MASU_BAKE_MATERIALS(content)[i];
        if (m->flags & MASU_MATERIAL_IS_BLEND) continue;
        float roughness = least_of(content, m);
        if (roughness < least) least = roughness;
    }
    return least;
}

static void add_reflections(masu_bake_content *content, const masu_bake_reflections *wanted) {
    masu_blob_reflections r = {.cutoff = (float)wanted->cutoff,
                               .distance = fmaxf((float)wanted->distance, 1e-3f),
                               .glossiest = glossiest(content)};
    masu_bake_append(&content->section[MASU_BLOB_REFLECTIONS], &r, sizeof r);
}

bool masu_bake_make_bvh(masu_bake_content *content, const masu_bake_reflections *wanted,
                        masu_bake_bvh_report *report) {
    memset(report, 0, sizeof *report);
    if (!wanted->wanted) return true;
    masu_cli_progress("building trees for rays");
    double started = masu_bake_seconds();
    baker b = {.content = content, .report = report};
    size_t count = (size_t)masu_bake_count(content, MASU_BLOB_INSTANCES);
    size_t meshes = (size_t)masu_bake_count(content, MASU_BLOB_MESHES);
    unsigned char *marks = masu_bake_allocate(count + meshes + 1);
    memset(marks, 0, count + meshes + 1);
    choose(&b, wanted->smallest, marks, marks + count);
    bool good = grow_trees(&b, marks + count);
    if (good) list_instances(&b, marks);
    if (good && !content->section[MASU_BLOB_TRACE_INSTANCES].bytes) {
        if (count || !masu_bake_count(content, MASU_BLOB_SDF))
            masu_cli_warn("reflections: no instance is traced");
        for (uint32_t k = MASU_BLOB_TRACE_NODES; k <= MASU_BLOB_TRACE_INSTANCES; k++)
            masu_bake_release(&content->section[k]);
    }
    add_reflections(content, wanted);
    fill_report(&b);
    free(marks);
    masu_bake_release(&b.triangles);
    masu_bake_release(&b.boxes);
    report->seconds = masu_bake_seconds() - started;
    masu_cli_progress_clear();
    return good;
}
