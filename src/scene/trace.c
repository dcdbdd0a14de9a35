/* trace.c: see trace.h. */
#include "scene/trace.h"

#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

_Static_assert(sizeof(masu_trace_record) == 16 * MASU_TRACE_RECORD_UVEC4, "trace record");
_Static_assert(sizeof(masu_blob_trace_node) == 16 * MASU_TRACE_NODE_UVEC4, "trace node");
_Static_assert(MASU_TRACE_STACK >= MASU_TRACE_DEPTH_MAX + MASU_TRACE_TOP_DEPTH, "trace stack");
_Static_assert(MASU_TRACE_TOP_DEPTH <= MASU_TRACE_DEPTH_MAX, "trace depth");

struct masu_trace_placed {
    masu_trace_root root;
    float transform[12];
    float inverse[9];
    uint32_t mirrored, live;
};

static uint64_t rounded(uint64_t bytes) { return (bytes + 15) & ~(uint64_t)15; }

uint64_t masu_trace_top_bytes(uint32_t instances) {
    uint64_t n = instances, nodes = masu_trace_tree_nodes(instances);
    return rounded(n * sizeof(struct masu_trace_placed)) + rounded(n * sizeof(masu_trace_box)) +
           rounded(nodes * sizeof(masu_trace_below)) +
           rounded(nodes * sizeof(masu_blob_trace_node)) + 3 * rounded(n * sizeof(uint32_t));
}

static void *carve(unsigned char **memory, uint64_t count, uint64_t size) {
    void *out = *memory;
    *memory += rounded(count * size);
    return out;
}

void masu_trace_top_init(masu_trace_top *top, void *memory, uint32_t count) {
    unsigned char *at = memory;
    uint32_t nodes = masu_trace_tree_nodes(count);
    *top = (masu_trace_top){.count = count};
    top->placed = carve(&at, count, sizeof *top->placed);
    top->boxes = carve(&at, count, sizeof *top->boxes);
    top->below = carve(&at, nodes, sizeof *top->below);
    top->tree = carve(&at, nodes, sizeof *top->tree);
    top->items = carve(&at, count, sizeof *top->items);
    top->order = carve(&at, count, sizeof *top->order);
    top->work = carve(&at, count, sizeof *top->work);
    if (count) memset(top->placed, 0, count * sizeof *top->placed);
}

/* A float two ulp below or above x; `side` is -1 or 1. */
static float beyond(double x, float side) {
    float f = (float)x;
    return f + side * (fabsf(f) * 0x1p-22f + 1e-37f);
}

masu_trace_root masu_trace_root_of(const masu_scene_view *view, uint32_t traced) {
    uint32_t instance = view->trace_instances[traced];
    uint32_t node = view->trace_meshes[view->instances[instance].mesh].first_node;
    masu_trace_root out = {.node = node, .instance = instance};
    for (uint32_t k = 0; k < 3; k++) {
        out.box.low[k] = INFINITY;
        out.box.high[k] = -INFINITY;
    }
    for (uint32_t slot = 0; slot < 4; slot++) {
        double low[3], high[3];
        if (!masu_trace_type(&view->trace_nodes[node], slot)) break;
        masu_trace_tree_child(&view->trace_nodes[node], slot, low, high);
        for (uint32_t k = 0; k < 3; k++) {
            out.box.low[k] = fminf(out.box.low[k], beyond(low[k], -1.0f));
            out.box.high[k] = fmaxf(out.box.high[k], beyond(high[k], 1.0f));
        }
    }
    return out;
}

void masu_trace_top_set(masu_trace_top *top, uint32_t traced, const masu_trace_root *root) {
    top->placed[traced].root = *root;
}

masu_trace_root *masu_trace_top_root(masu_trace_top *top, uint32_t traced) {
    return &top->placed[traced].root;
}

_Static_assert(MASU_TRACE_LEVELS_MAX == MASU_TRACE_DEPTH_MAX, "skin_trace.comp sweeps every level");

/* Inverse by cofactors in double, which is exact enough for every accepted float matrix. Returns 0
 * if the matrix is rejected. */
static int invert(const float m[12], float inverse[9], uint32_t *mirrored) {
    double a[3][3], c[3][3], most = 0.0;
    for (uint32_t i = 0; i < 12; i++) {
        if (!(fabsf(m[i]) <= MASU_TRACE_REACH)) return 0; /* NaN too */
    }
    for (uint32_t i = 0; i < 9; i++) a[i / 3][i % 3] = (double)m[i / 3 * 4 + i % 3];
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            c[k][i] = a[i1][k1] * a[i2][k2] - a[i1][k2] * a[i2][k1];
        }
    }
    double determinant = a[0][0] * c[0][0] + a[0][1] * c[1][0] + a[0][2] * c[2][0];
    for (uint32_t i = 0; i < 9; i++) {
        double entry = c[i / 3][i % 3] / determinant;
        if (!(fabs(entry) <= MASU_TRACE_STRETCH)) return 0;
        if (fabs(entry) > most) most = fabs(entry);
        inverse[i] = (float)entry;
    }
    *mirrored = determinant < 0.0;
    return most * MASU_TRACE_STRETCH >= 1.0;
}

int masu_trace_places(const float transform[12]) {
    float inverse[9];
    uint32_t mirrored;
    return invert(transform, inverse, &mirrored);
}

int masu_trace_top_place(masu_trace_top *top, uint32_t traced, const float transform[12]) {
    struct masu_trace_placed *p = &top->placed[traced];
    float inverse[9];
    uint32_t mirrored = 0, live = (uint32_t)invert(transform, inverse, &mirrored);
    if (live != p->live) top->regroup = 1;
    p->live = live;
    if (!live) return 0;
    memcpy(p->transform, transform, sizeof p->transform);
    memcpy(p->inverse, inverse, sizeof p->inverse);
    p->mirrored = mirrored;
    top->dirty = 1;
    return 1;
}

static float place_of(const struct masu_trace_placed *p, const double anchor[3], uint32_t k) {
    return (float)((double)p->transform[4 * k + 3] - anchor[k]);
}

static double clamped(double x) {
    double reach = (double)MASU_TRACE_REACH;
    return x < -reach ? -reach : x > reach ? reach : x;
}

/* World box of a placed instance, relative to the floating origin. Based on the rounded position
 * that the shader uses, and slightly enlarged, because the shader's inverse is rounded too. */
static masu_trace_box box_of(const struct masu_trace_placed *p, const double anchor[3]) {
    const masu_trace_box *b = &p->root.box;
    masu_trace_box out;
    for (uint32_t k = 0; k < 3; k++) {
        const float *row = &p->transform[4 * k];
        double middle = 0.0, half = 0.0, room = 0.0, at = (double)place_of(p, anchor, k);
        for (uint32_t i = 0; i < 3; i++) {
            double center = 0.5 * ((double)b->low[i] + (double)b->high[i]);
            double side = 0.5 * ((double)b->high[i] - (double)b->low[i]);
            middle += (double)row[i] * center;
            half += fabs((double)row[i]) * side;
            room += fabs((double)row[i]) * (fabs(center) + side);
        }
        half += room * 0x1p-20;
        out.low[k] = beyond(clamped(at + middle - half), -1.0f);
        out.high[k] = beyond(clamped(at + middle + half), 1.0f);
    }
    return out;
}

uint32_t masu_trace_top_levels(uint32_t instances) {
    uint32_t levels = 4;
    for (uint64_t most = 4; most < instances; most *= 4) levels++;
    return levels < MASU_TRACE_TOP_DEPTH ? levels : MASU_TRACE_TOP_DEPTH;
}

static void build(masu_trace_top *top) {
    masu_trace_shape shape =
        masu_trace_tree_shape(top->boxes, top->live, 1, masu_trace_top_levels(top->count), 0, 0,
                              top->order, top->work, top->tree);
    top->nodes = shape.nodes;
    top->depth = shape.depth;
    top->size = top->built_size =
        masu_trace_tree_fit(top->tree, top->nodes, 0, 0, top->order, top->boxes, top->below);
    top->builds++;
}

masu_trace_change masu_trace_top_update(masu_trace_top *top, const double anchor[3]) {
    int moved = memcmp(top->anchor, anchor, sizeof top->anchor) != 0;
    if (!moved && !top->dirty && !top->regroup) return MASU_TRACE_SAME;
    memcpy(top->anchor, anchor, sizeof top->anchor);
    if (top->regroup) {
        top->live = 0;
        for (uint32_t i = 0; i < top->count; i++) {
            if (top->placed[i].live) top->items[top->live++] = i;
        }
    }
    for (uint32_t i = 0; i < top->live; i++)
        top->boxes[i] = box_of(&top->placed[top->items[i]], anchor);
    int regroup = top->regroup;
    top->dirty = top->regroup = 0;
    if (!regroup) {
        top->size =
            masu_trace_tree_fit(top->tree, top->nodes, 0, 0, top->order, top->boxes, top->below);
        top->fits++;
        if (top->size <= top->built_size + log2(MASU_TRACE_WORSE)) return MASU_TRACE_FITTED;
    }
    build(top);
    return MASU_TRACE_BUILT;
}

uint64_t masu_trace_frame_bytes(uint32_t instances) {
    return 16 + (uint64_t)masu_trace_tree_nodes(instances) * sizeof(masu_blob_trace_node) +
           (uint64_t)instances * sizeof(masu_trace_record);
}

void masu_trace_top_write(const masu_trace_top *top, void *frame) {
    uint32_t header[4] = {1 + top->nodes * MASU_TRACE_NODE_UVEC4, top->nodes, top->count, 0};
    unsigned char *out = frame;
    memcpy(out, header, sizeof header);
    out += sizeof header;
    if (top->nodes) memcpy(out, top->tree, top->nodes * sizeof *top->tree);
    out += top->nodes * sizeof *top->tree;
    for (uint32_t i = 0; i < top->live; i++) {
        uint32_t traced = top->items[top->order[i]];
        const struct masu_trace_placed *p = &top->placed[traced];
        masu_trace_record r = {.root = p->root.node,
                               .traced = traced,
                               .instance = p->root.instance,
                               .mirrored = p->mirrored};
        for (uint32_t k = 0; k < 3; k++) {
            memcpy(r.row[k], &p->inverse[3 * k], 3 * sizeof(float));
            r.row[k][3] = place_of(p, top->anchor, k);
        }
        memcpy(out, &r, sizeof r);
        out += sizeof r;
    }
}

masu_trace_static masu_trace_static_layout(uint32_t nodes, uint32_t triangles) {
    masu_trace_static s = {.nodes = 16};
    s.triangles = s.nodes + (uint64_t)nodes * sizeof(masu_blob_trace_node);
    s.bytes = s.triangles + (uint64_t)triangles * sizeof(masu_blob_trace_triangle);
    s.header[0] = (uint32_t)(s.triangles / 16);
    s.header[1] = nodes;
    s.header[2] = triangles;
    return s;
}
