/* test_trace.c: BVHs for rays (src/scene/trace_tree.h) and the BVH over the instances of a frame
 * (src/scene/trace.h): content of a leaf is inside the quantised boxes of all its ancestors, after
 * a build, a refit and a thousand moves; shapes have the order that blobs are checked for; the
 * depth is within its limit. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shared/masu_shared.h"
#include "support/random.h"
#include "scene/trace.h"

#define MOST 5000u

static const double zero[3] = {0, 0, 0};
static uint64_t seed;

static float number(float low, float high) {
    return (float)random_between(&seed, (double)low, (double)high);
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

typedef struct tree {
    masu_trace_box *boxes;
    masu_trace_below *below;
    uint32_t *order, *work, items, first_node, first_item;
    masu_blob_trace_node *nodes;
    masu_trace_shape shape;
} tree;

static tree grow(const masu_trace_box *boxes, uint32_t items, uint32_t leaf, uint32_t levels) {
    tree t = {.items = items, .first_node = 7, .first_item = 11};
    uint32_t room = masu_trace_tree_nodes(items);
    t.boxes = malloc((items + 1) * sizeof *t.boxes);
    t.below = malloc((room + 1) * sizeof *t.below);
    t.nodes = malloc((room + 1) * sizeof *t.nodes);
    t.order = malloc((items + 1) * sizeof *t.order);
    t.work = malloc((items + 1) * sizeof *t.work);
    if (items) memcpy(t.boxes, boxes, items * sizeof *boxes);
    memset(t.nodes, 0x5A, (room + 1) * sizeof *t.nodes);
    masu_blob_trace_node behind = t.nodes[room];
    t.shape = masu_trace_tree_shape(t.boxes, items, leaf, levels, 7, 11, t.order, t.work, t.nodes);
    assert_true(t.shape.nodes <= room);
    assert_true(t.shape.depth <= levels);
    assert_memory_equal(&behind, &t.nodes[room], sizeof behind);
    assert_true(
        isfinite(masu_trace_tree_fit(t.nodes, t.shape.nodes, 7, 11, t.order, t.boxes, t.below)));
    for (uint32_t i = 0; i < t.shape.nodes; i++)
        assert_true(t.below[i].cost >= 1.0f && t.below[i].cost < 1e9f);
    return t;
}

static void fell(tree *t) {
    free(t->boxes);
    free(t->below);
    free(t->nodes);
    free(t->order);
    free(t->work);
}

static void assert_holds(const double low[3], const double high[3], const masu_trace_box *box) {
    for (int k = 0; k < 3; k++) {
        assert_true(low[k] <= (double)box->low[k]);
        assert_true(high[k] >= (double)box->high[k]);
    }
}

/* Traverses as the shader does, and checks each quantised box on the way against all items below.
 * Counts the items. */
static uint32_t walk(const masu_blob_trace_node *nodes, const masu_trace_box *boxes,
                     const uint32_t *order, uint32_t first_node, uint32_t first_item, uint32_t node,
                     uint32_t *depth, unsigned char *seen) {
    const masu_blob_trace_node *n = &nodes[node - first_node];
    uint32_t child = n->child, item = n->item, count = 0, deepest = 0;
    for (uint32_t slot = 0; slot < 4; slot++) {
        uint32_t type = masu_trace_type(n, slot), below = 0, from = 0;
        double low[3], high[3];
        masu_trace_tree_child(n, slot, low, high);
        if (type == 1) {
            assert_true(child > node);
            below = walk(nodes, boxes, order, first_node, first_item, child++, &from, seen);
        } else if (type > 1) {
            for (uint32_t i = 0; i + 1 < type; i++, item++) {
                assert_holds(low, high, &boxes[order[item - first_item]]);
                assert_int_equal(seen[order[item - first_item]], 0);
                seen[order[item - first_item]] = 1;
            }
            below = type - 1;
        }
        if (from > deepest) deepest = from;
        count += below;
    }
    *depth = deepest + 1;
    return count;
}

/* Each quantised box contains all items below, not only the boxes of the next level. */
static void assert_ancestors(const masu_blob_trace_node *nodes, uint32_t count,
                             const masu_trace_box *boxes, const uint32_t *order,
                             uint32_t first_node, uint32_t first_item) {
    struct bound {
        double low[3], high[3];
    } *bounds = malloc((count + 1) * sizeof *bounds);
    for (int k = 0; k < 3; k++) {
        bounds[0].low[k] = -(double)INFINITY;
        bounds[0].high[k] = (double)INFINITY;
    }
    for (uint32_t i = 0; i < count; i++) { /* the intersection of all boxes above */
        uint32_t child = nodes[i].child, item = nodes[i].item;
        for (uint32_t slot = 0; slot < 4; slot++) {
            uint32_t type = masu_trace_type(&nodes[i], slot);
            struct bound b;
            masu_trace_tree_child(&nodes[i], slot, b.low, b.high);
            for (int k = 0; k < 3; k++) {
                b.low[k] = fmax(b.low[k], bounds[i].low[k]);
                b.high[k] = fmin(b.high[k], bounds[i].high[k]);
            }
            if (type == 1) bounds[child++ - first_node] = b;
            for (uint32_t j = 1; j < type; j++, item++)
                assert_holds(b.low, b.high, &boxes[order[item - first_item]]);
        }
    }
    free(bounds);
}

static void assert_tree(const tree *t) {
    unsigned char *seen = calloc(t->items + 1, 1);
    uint32_t depth = 0;
    if (t->shape.nodes) {
        assert_int_equal(walk(t->nodes, t->boxes, t->order, 7, 11, 7, &depth, seen), t->items);
    }
    assert_int_equal(depth, t->shape.depth);
    assert_ancestors(t->nodes, t->shape.nodes, t->boxes, t->order, 7, 11);
    free(seen);
}

static masu_trace_box *clouds(uint32_t items, int kind) {
    masu_trace_box *boxes = malloc((items + 1) * sizeof *boxes);
    for (uint32_t i = 0; i < items; i++) {
        for (int k = 0; k < 3; k++) {
            float at = number(-100, 100), size = number(0, 3);
            if (kind == 1) at = 5, size = 0; /* all the same point */
            if (kind == 2)
                at = k ? 0.0f : ldexpf(1.0f, (int)(i % 120) - 70); /* ever farther apart */
            if (kind == 3) at = 1e6f + number(0, 1), size = 1e-3f;
            if (kind == 4) at = number(-9e14f, 9e14f);
            if (kind == 5) size = i % 7 ? 0.01f : 300.0f;
            if (kind == 6) at = 0, size = (float)i; /* one in the other */
            boxes[i].low[k] = at - size;
            boxes[i].high[k] = at + size;
        }
    }
    return boxes;
}

static void every_box_lies_in_the_boxes_above_it(void **state) {
    (void)state;
    static const uint32_t counts[] = {0, 1, 2, 3, 4, 5, 7, 16, 25, 100, 999};
    for (int kind = 0; kind < 7; kind++) {
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
            for (uint32_t leaf = 1; leaf <= 2; leaf++) {
                masu_trace_box *boxes = clouds(counts[c], kind);
                tree t = grow(boxes, counts[c], leaf, MASU_TRACE_DEPTH_MAX);
                assert_tree(&t);
                fell(&t);
                free(boxes);
            }
        }
    }
}

static void a_tree_is_never_deeper_than_it_may_be(void **state) {
    (void)state;
    for (int kind = 0; kind < 7; kind++) {
        for (uint32_t levels = 1; levels <= 5; levels++) {
            for (uint32_t leaf = 1; leaf <= 2; leaf++) {
                uint32_t items = leaf << 2 * levels; /* as many as possible */
                masu_trace_box *boxes = clouds(items, kind);
                tree t = grow(boxes, items, leaf, levels);
                assert_tree(&t);
                fell(&t);
                t = grow(boxes, items - 1, leaf, levels);
                assert_tree(&t);
                fell(&t);
                free(boxes);
            }
        }
    }
}

static void the_same_boxes_give_the_same_tree(void **state) {
    (void)state;
    masu_trace_box *boxes = clouds(500, 0);
    tree a = grow(boxes, 500, 2, 28), b = grow(boxes, 500, 2, 28);
    assert_int_equal(a.shape.nodes, b.shape.nodes);
    assert_memory_equal(a.nodes, b.nodes, a.shape.nodes * sizeof *a.nodes);
    assert_memory_equal(a.order, b.order, 500 * sizeof *a.order);
    fell(&a);
    fell(&b);
    free(boxes);
}

/* Objects in rows: a BVH built by position costs a small part of one that splits blindly. */
static void the_heuristic_is_worth_its_name(void **state) {
    (void)state;
    masu_trace_box *boxes = clouds(2000, 0);
    tree t = grow(boxes, 2000, 2, 28);
    float good = t.below[0].cost;
    for (uint32_t i = 0; i < 2000; i++) t.order[i] = i;
    (void)masu_trace_tree_fit(t.nodes, t.shape.nodes, 7, 11, t.order, t.boxes, t.below);
    assert_true(good * 10 < t.below[0].cost);
    fell(&t);
    free(boxes);
}

/* ---- Instances ------------------------------------------------------------------------------- */

static void *memory;
static masu_trace_top top;
static float (*transforms)[12];

static void random_transform(float m[12], float reach) {
    for (int i = 0; i < 12; i++)
        m[i] = i % 4 == 3 ? number(-reach, reach) : number(-2, 2);
}

static void make(uint32_t count, float reach) {
    free(memory);
    free(transforms);
    memory = aligned_alloc(16, masu_trace_top_bytes(count) + 16);
    transforms = malloc((count + 1) * sizeof *transforms);
    memset(memory, 0xA5, masu_trace_top_bytes(count) + 16);
    masu_trace_top_init(&top, memory, count);
    for (uint32_t i = 0; i < count; i++) {
        masu_trace_root root = {{{-1, -2, -3}, {1, 0.5f, 4}}, 100 + i, 2 * i};
        masu_trace_top_set(&top, i, &root);
        random_transform(transforms[i], reach);
        assert_int_equal(masu_trace_top_place(&top, i, transforms[i]), 1);
    }
}

/* The box of an instance, independently: its corners in double precision, around its rounded
 * position. */
static void corners_of(uint32_t i, const double anchor[3], double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = (double)INFINITY;
        high[k] = -(double)INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        double p[3] = {corner & 1 ? 1 : -1, corner & 2 ? 0.5 : -2, corner & 4 ? 4 : -3};
        for (int k = 0; k < 3; k++) {
            const float *row = &transforms[i][4 * k];
            double x = (double)(float)((double)row[3] - anchor[k]);
            for (int c = 0; c < 3; c++) x += (double)row[c] * p[c];
            low[k] = fmin(low[k], x);
            high[k] = fmax(high[k], x);
        }
    }
}

static void assert_top(const double anchor[3], uint32_t live) {
    assert_int_equal(top.live, live);
    assert_true(top.nodes <= masu_trace_tree_nodes(live));
    assert_true(top.depth <= masu_trace_top_levels(top.count) &&
                masu_trace_top_levels(top.count) <= MASU_TRACE_TOP_DEPTH);
    unsigned char *seen = calloc(live + 1, 1);
    uint32_t depth = 0;
    if (live) {
        assert_int_equal(walk(top.tree, top.boxes, top.order, 0, 0, 0, &depth, seen), live);
    }
    assert_int_equal(depth, top.depth);
    assert_ancestors(top.tree, top.nodes, top.boxes, top.order, 0, 0);
    for (uint32_t i = 0; i < live; i++) {
        double low[3], high[3];
        corners_of(top.items[i], anchor, low, high);
        for (int k = 0; k < 3; k++) {
            assert_true((double)top.boxes[i].low[k] <= low[k]);
            assert_true((double)top.boxes[i].high[k] >= high[k]);
        }
    }
    free(seen);
}

/* The data that the shader reads: the record of a leaf transforms back to the instance's own
 * points. */
static void assert_written(const double anchor[3]) {
    uint64_t bytes = masu_trace_frame_bytes(top.count);
    unsigned char *frame = malloc(bytes + 16);
    memset(frame + bytes, 0x77, 16);
    masu_trace_top_write(&top, frame);
    for (int i = 0; i < 16; i++) assert_int_equal(frame[bytes + (unsigned)i], 0x77);
    uint32_t header[4];
    memcpy(header, frame, sizeof header);
    assert_int_equal(header[1], top.nodes);
    assert_int_equal(header[2], top.count);
    for (uint32_t i = 0; i < top.live; i++) {
        masu_trace_record r;
        memcpy(&r, frame + 16 * (uint64_t)header[0] + i * sizeof r, sizeof r);
        assert_int_equal(r.traced, top.items[top.order[i]]);
        assert_int_equal(r.root, 100 + r.traced);
        assert_int_equal(r.instance, 2 * r.traced);
        const float *m = transforms[r.traced];
        double determinant = 0;
        for (int k = 0; k < 3; k++) {
            int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            determinant += (double)m[k] * ((double)m[4 + k1] * (double)m[8 + k2] -
                                           (double)m[4 + k2] * (double)m[8 + k1]);
        }
        assert_int_equal(r.mirrored, determinant < 0);
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < 3; c++) {
                double is = 0, size = 0;
                for (int j = 0; j < 3; j++) {
                    is += (double)r.row[k][j] * (double)m[4 * j + c];
                    size += fabs((double)r.row[k][j] * (double)m[4 * j + c]);
                }
                assert_true(fabs(is - (k == c)) <= 2e-7 * size);
            }
            assert_true(r.row[k][3] == (float)((double)m[4 * k + 3] - anchor[k]));
        }
    }
    free(frame);
}

static void any_number_of_instances_makes_a_tree(void **state) {
    (void)state;
    static const uint32_t counts[] = {0, 1, 2, 3, 5, 64, MOST};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        make(counts[c], 500);
        masu_trace_change change = masu_trace_top_update(&top, zero);
        assert_int_equal(change, counts[c] ? MASU_TRACE_BUILT : MASU_TRACE_SAME);
        assert_top(zero, counts[c]);
        assert_written(zero);
        assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_SAME);
    }
}

static void a_thousand_moves_leave_every_box_in_place(void **state) {
    (void)state;
    make(300, 100);
    (void)masu_trace_top_update(&top, zero);
    for (int i = 0; i < 1000; i++) {
        uint32_t which = (uint32_t)support_random_in(&seed, 0, 299);
        random_transform(transforms[which], i % 50 ? 100 : 1e5f);
        int live = masu_trace_top_place(&top, which, transforms[which]);
        assert_int_equal(live, 1);
        if (i % 3) continue;
        assert_int_not_equal(masu_trace_top_update(&top, zero), MASU_TRACE_SAME);
        assert_true(top.size <= top.built_size + log2(MASU_TRACE_WORSE));
        assert_top(zero, 300);
    }
    assert_written(zero);
    assert_true(top.fits > 0 && top.builds > 1);
}

static void what_is_mixed_up_is_built_again_and_what_is_not_is_fitted(void **state) {
    (void)state;
    make(1000, 300);
    assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_BUILT);
    double size = top.size;
    for (int i = 0; i < 20; i++) { /* all move in the same direction */
        for (uint32_t k = 0; k < 1000; k++) {
            transforms[k][3] += 1.0f;
            (void)masu_trace_top_place(&top, k, transforms[k]);
        }
        assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_FITTED);
        assert_true(fabs(top.size - size) < 0.01);
    }
    assert_int_equal(top.builds, 1);
    for (uint32_t k = 0; k < 1000; k++) { /* all are at new positions */
        random_transform(transforms[k], 300);
        (void)masu_trace_top_place(&top, k, transforms[k]);
    }
    assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_BUILT);
    assert_int_equal(top.builds, 2);
    assert_true(top.size < size + 0.4);
    assert_top(zero, 1000);
}

static void instances_that_cannot_be_traced_are_left_out(void **state) {
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 3e38f};
    make(40, 50);
    (void)masu_trace_top_update(&top, zero);
    float flat[12] = {1, 2, 3, 0, 2, 4, 6, 0, 0, 0, 1, 0}, none[12] = {0};
    float tiny[12] = {1e-12f, 0, 0, 0, 0, 1e-12f, 0, 0, 0, 0, 1e-12f, 0};
    float huge[12] = {1e12f, 0, 0, 0, 0, 1e12f, 0, 0, 0, 0, 1e12f, 0};
    const float *const matrices[] = {flat, none, tiny, huge};
    for (int i = 0; i < 12 * 4 + 4; i++) {
        float m[12];
        memcpy(m, transforms[5], sizeof m);
        if (i < 48)
            m[i / 4] = bad[i % 4];
        else
            memcpy(m, matrices[i - 48], sizeof m);
        assert_int_equal(masu_trace_top_place(&top, 5, m), 0);
        assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_BUILT);
        assert_top(zero, 39);
        assert_written(zero);
        assert_int_equal(masu_trace_top_place(&top, 5, transforms[5]), 1);
        assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_BUILT);
        assert_top(zero, 40);
    }
    for (uint32_t i = 0; i < 40; i++) (void)masu_trace_top_place(&top, i, none);
    assert_int_equal(masu_trace_top_update(&top, zero), MASU_TRACE_BUILT);
    assert_top(zero, 0);
    assert_written(zero);
}

/* A million metres out, relative to an anchor there, boxes are as precise as at the origin. */
static void an_anchor_keeps_far_worlds_sharp(void **state) {
    (void)state;
    const double anchor[3] = {1e6, -3e6, 5e5};
    make(200, 50);
    for (uint32_t i = 0; i < 200; i++) {
        for (int k = 0; k < 3; k++) transforms[i][4 * k + 3] += (float)anchor[k];
        (void)masu_trace_top_place(&top, i, transforms[i]);
    }
    assert_int_equal(masu_trace_top_update(&top, anchor), MASU_TRACE_BUILT);
    assert_top(anchor, 200);
    assert_written(anchor);
    for (uint32_t i = 0; i < 200; i++) {
        double low[3], high[3];
        corners_of(top.items[i], anchor, low, high);
        for (int k = 0; k < 3; k++) {
            assert_true(low[k] - (double)top.boxes[i].low[k] < 1e-3);
            assert_true((double)top.boxes[i].high[k] - high[k] < 1e-3);
        }
    }
    const double next[3] = {1e6 + 64, -3e6, 5e5};
    assert_int_equal(masu_trace_top_update(&top, next), MASU_TRACE_FITTED);
    assert_top(next, 200);
    assert_written(next);
}

static int tidy(void **state) {
    (void)state;
    free(memory);
    free(transforms);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_box_lies_in_the_boxes_above_it),
        cmocka_unit_test(a_tree_is_never_deeper_than_it_may_be),
        cmocka_unit_test(the_same_boxes_give_the_same_tree),
        cmocka_unit_test(the_heuristic_is_worth_its_name),
        cmocka_unit_test(any_number_of_instances_makes_a_tree),
        cmocka_unit_test(a_thousand_moves_leave_every_box_in_place),
        cmocka_unit_test(what_is_mixed_up_is_built_again_and_what_is_not_is_fitted),
        cmocka_unit_test(instances_that_cannot_be_traced_are_left_out),
        cmocka_unit_test(an_anchor_keeps_far_worlds_sharp),
    };
    return cmocka_run_group_tests(tests, NULL, tidy);
}
