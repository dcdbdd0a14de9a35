/* groups.c: see groups.h.
 *
 * Every group, the scene's and the root, has things: instances and groups named by the scene. Up to
 * MASU_CULL_LEAF things are direct members of the group; more are put into a binary tree. It splits
 * the things along the longest side of the bounds of their centres, at the least surface area
 * heuristic, but not further out than a quarter. Groups and items are stored in breadth-first
 * order, as src/scene/check_groups.c requires. */
#include "bake/scene/groups.h"
#include "scene/cull.h"

#include <stdlib.h>
#include <string.h>

typedef struct thing {
    masu_cull_box box; /* expanded, or a group's */
    double key;        /* for the current split */
    uint32_t instance; /* MASU_BLOB_NONE: a group */
    uint32_t group;    /* of the scene */
} thing;

/* Things [first, first + count) of a group. */
typedef struct range {
    size_t first, count;
    uint32_t name, level;
} range;

typedef struct builder {
    masu_bake_content *content;
    thing *things;
    range *own; /* of each group of the scene, then of the root */
    masu_bake_buffer nodes, ranges, items;
} builder;

/* ---- Tags ------------------------------------------------------------------------------------ */

static masu_blob_group *groups_of(const masu_bake_content *content) {
    return MASU_BAKE_ARRAY(content, MASU_BLOB_GROUPS, masu_blob_group);
}

static uint32_t tag_of(masu_bake_content *content, const char *path, size_t length,
                       uint32_t parent) {
    uint32_t count = (uint32_t)masu_bake_count(content, MASU_BLOB_GROUPS);
    for (uint32_t i = 0; i < count; i++) {
        const char *name = masu_bake_name_text(content, groups_of(content)[i].name);
        if (strlen(name) == length && !memcmp(name, path, length)) return i;
    }
    masu_blob_group group = {.name = masu_bake_name(content, path, length), .reserved = parent};
    masu_bake_append(&content->section[MASU_BLOB_GROUPS], &group, sizeof group);
    return count;
}

bool masu_bake_group_path(const char *path) {
    uint32_t levels = 1;
    for (const char *c = path; *c; c++) {
        if (*c == '/' && (c == path || c[1] == '/' || !c[1])) return false;
        levels += *c == '/';
    }
    return *path && levels <= MASU_BAKE_GROUP_LEVELS;
}

uint32_t masu_bake_group(masu_bake_content *content, const char *path) {
    uint32_t tag = MASU_BLOB_NONE;
    for (const char *c = path;; c++) {
        if (*c == '/' || !*c) tag = tag_of(content, path, (size_t)(c - path), tag);
        if (!*c) return tag;
    }
}

/* ---- Things ---------------------------------------------------------------------------------- */

static masu_cull_box instance_box(const masu_bake_content *content, size_t i) {
    const masu_blob_instance *instance = &MASU_BAKE_INSTANCES(content)[i];
    const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[instance->mesh];
    masu_cull_box box = masu_cull_place(instance->transform, mesh->aabb_min, mesh->aabb_max);
    return masu_cull_widen(&box, 1.0f);
}

/* Sorts instances and groups to the ranges of their owners; index `count` is the root's. Groups
 * without any instance are dropped. Boxes of groups are computed last, inner ones first. */
static void gather(builder *b, uint32_t count, size_t instances) {
    const masu_blob_group *groups = groups_of(b->content);
    masu_blob_instance *all = MASU_BAKE_INSTANCES(b->content);
    size_t *used = masu_bake_allocate((count + 1) * sizeof *used); /* instances below */
    memset(used, 0, (count + 1) * sizeof *used);
    for (size_t i = 0; i < instances; i++) {
        masu_cull_box box = instance_box(b->content, i);
        bool finite = box.half[0] <= MASU_CULL_FAR && box.half[1] <= MASU_CULL_FAR &&
                      box.half[2] <= MASU_CULL_FAR;
        if (!finite) all[i].group = MASU_BAKE_MOVING;
        if (all[i].group == MASU_BAKE_MOVING) continue;
        uint32_t owner = all[i].group == MASU_BLOB_NONE ? count : all[i].group;
        b->own[owner].count++;
        used[owner]++;
    }
    for (uint32_t g = count; g-- > 0;) {
        uint32_t owner = groups[g].reserved == MASU_BLOB_NONE ? count : groups[g].reserved;
        used[owner] += used[g];
        if (used[g]) b->own[owner].count++;
        b->own[g].name = groups[g].name;
    }
    b->own[count].name = MASU_BLOB_NONE;
    size_t next = 0;
    for (uint32_t g = 0; g <= count; g++) {
        b->own[g].first = next;
        next += b->own[g].count;
        b->own[g].count = 0;
    }
    b->things = masu_bake_allocate(next * sizeof *b->things);
    for (size_t i = 0; i < instances; i++) {
        if (all[i].group == MASU_BAKE_MOVING) continue;
        range *own = &b->own[all[i].group == MASU_BLOB_NONE ? count : all[i].group];
        b->things[own->first + own->count++] =
            (thing){instance_box(b->content, i), 0, (uint32_t)i, MASU_BLOB_NONE};
    }
    masu_cull_box *boxes = masu_bake_allocate(next * sizeof *boxes);
    for (uint32_t g = count; g-- > 0;) {
        if (!used[g]) continue;
        for (size_t k = 0; k < b->own[g].count; k++) boxes[k] = b->things[b->own[g].first + k].box;
        range *own = &b->own[groups[g].reserved == MASU_BLOB_NONE ? count : groups[g].reserved];
        b->things[own->first + own->count++] =
            (thing){masu_cull_around(boxes, (uint32_t)b->own[g].count), 0, MASU_BLOB_NONE, g};
    }
    free(boxes);
    free(used);
}

/* ---- Splitting ------------------------------------------------------------------------------- */

static int by_key(const void *a, const void *b) {
    const thing *p = a, *q = b;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    if (p->instance != q->instance) return p->instance < q->instance ? -1 : 1;
    return p->group < q->group ? -1 : p->group > q->group;
}

static double area(const masu_cull_box *b) {
    double x = (double)b->half[0], y = (double)b->half[1], z = (double)b->half[2];
    return x * y + y * z + z * x;
}

/* The number of things in the first half. */
static size_t split(thing *things, size_t n, uint32_t level) {
    masu_cull_box around = masu_cull_around(&things[0].box, 1);
    double low[3], high[3];
    for (int k = 0; k < 3; k++) low[k] = high[k] = (double)around.center[k];
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], (double)things[i].box.center[k]);
            high[k] = fmax(high[k], (double)things[i].box.center[k]);
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    for (size_t i = 0; i < n; i++) things[i].key = (double)things[i].box.center[axis];
    qsort(things, n, sizeof *things, by_key);
    if (level >= MASU_CULL_DEPTH / 2) return n / 2;      /* halves keep the tree shallow */
    double *cost = masu_bake_allocate(n * sizeof *cost); /* of a split after each thing */
    masu_cull_box grown[2] = {things[0].box, things[0].box};
    for (size_t i = 0; i < n; i++) {
        grown[1] = things[i].box;
        grown[0] = masu_cull_around(grown, 2);
        cost[i] = area(&grown[0]) * (double)(i + 1);
    }
    grown[0] = things[n - 1].box;
    size_t best = n / 2;
    double least = (double)INFINITY;
    for (size_t i = n - 1; i >= n / 4 && i > 0; i--) {
        grown[1] = things[i].box;
        grown[0] = masu_cull_around(grown, 2);
        double sum = cost[i - 1] + area(&grown[0]) * (double)(n - i);
        if (i <= n - n / 4 && sum < least) {
            least = sum;
            best = i;
        }
    }
    free(cost);
    return best;
}

static int by_instance(const void *a, const void *b) {
    const thing *p = a, *q = b;
    if (p->instance != q->instance) return p->instance < q->instance ? -1 : 1;
    return p->group < q->group ? -1 : p->group > q->group;
}

static void add_node(builder *b, range r) {
    masu_blob_group node = {.name = r.name};
    masu_bake_append(&b->nodes, &node, sizeof node);
    masu_bake_append(&b->ranges, &r, sizeof r);
}

/* Gives group i its members, or two halves. */
static void fill(builder *b, uint32_t i) {
    range r = ((const range *)(const void *)b->ranges.data)[i];
    thing *things = b->things + r.first;
    uint32_t children = (uint32_t)(b->nodes.bytes / sizeof(masu_blob_group));
    uint32_t items = (uint32_t)(b->items.bytes / sizeof(uint32_t)), item_count = 0;
    uint32_t child_count = 0;
    if (r.count > MASU_CULL_LEAF) {
        size_t half = split(things, r.count, r.level);
        add_node(b, (range){r.first, half, MASU_BLOB_NONE, r.level + 1});
        add_node(b, (range){r.first + half, r.count - half, MASU_BLOB_NONE, r.level + 1});
        child_count = 2;
    } else {
        qsort(things, r.count, sizeof *things, by_instance);
        for (size_t k = 0; k < r.count; k++) {
            if (things[k].instance == MASU_BLOB_NONE) {
                range own = b->own[things[k].group];
                own.level = r.level + 1;
                add_node(b, own);
                child_count++;
                continue;
            }
            masu_bake_append(&b->items, &things[k].instance, sizeof things[k].instance);
            MASU_BAKE_INSTANCES(b->content)[things[k].instance].group = i;
            item_count++;
        }
    }
    masu_blob_group *node = &((masu_blob_group *)(void *)b->nodes.data)[i];
    node->child_count = child_count;
    node->first_child = child_count ? children : 0;
    node->item_count = item_count;
    node->first_item = item_count ? items : 0;
}

static void set_boxes(builder *b) {
    masu_blob_group *nodes = (masu_blob_group *)(void *)b->nodes.data;
    const uint32_t *items = (const uint32_t *)(const void *)b->items.data;
    for (size_t i = b->nodes.bytes / sizeof *nodes; i-- > 0;) {
        masu_blob_group *g = &nodes[i];
        masu_cull_box boxes[MASU_CULL_LEAF];
        uint32_t n = 0;
        for (uint32_t k = 0; k < g->item_count; k++) {
            boxes[n++] = instance_box(b->content, items[g->first_item + k]);
        }
        for (uint32_t k = 0; k < g->child_count; k++, n++) {
            memcpy(boxes[n].center, nodes[g->first_child + k].center, sizeof boxes[n].center);
            memcpy(boxes[n].half, nodes[g->first_child + k].half, sizeof boxes[n].half);
        }
        masu_cull_box around = masu_cull_around(boxes, n);
        memcpy(g->center, around.center, sizeof g->center);
        memcpy(g->half, around.half, sizeof g->half);
    }
}

void masu_bake_groups(masu_bake_content *content) {
    uint32_t count = (uint32_t)masu_bake_count(content, MASU_BLOB_GROUPS);
    size_t instances = (size_t)masu_bake_count(content, MASU_BLOB_INSTANCES);
    builder b = {.content = content};
    b.own = masu_bake_allocate((count + 1) * sizeof *b.own);
    memset(b.own, 0, (count + 1) * sizeof *b.own);
    gather(&b, count, instances);
    for (size_t i = 0; i < instances; i++) MASU_BAKE_INSTANCES(content)[i].group = MASU_BLOB_NONE;
    if (b.own[count].count) {
        add_node(&b, b.own[count]);
        for (uint32_t i = 0; i < b.nodes.bytes / sizeof(masu_blob_group); i++) fill(&b, i);
        set_boxes(&b);
    }
    masu_bake_release(&content->section[MASU_BLOB_GROUPS]);
    masu_bake_release(&content->section[MASU_BLOB_GROUP_ITEMS]);
    content->section[MASU_BLOB_GROUPS] = b.nodes;
    content->section[MASU_BLOB_GROUP_ITEMS] = b.items;
    masu_bake_release(&b.ranges);
    free(b.things);
    free(b.own);
}
