/* trace_tree.c: see trace_tree.h.
 *
 * Splits follow the surface area heuristic (Goldsmith and Salmon 1987; MacDonald and Booth 1990):
 * with few items all splits along each axis are evaluated, with many those between BINS bins (Wald
 * 2007). A node starts as one range of items; the range with the largest box is split until there
 * are four ranges (the greedy collapse of a binary tree, Wald et al. 2008, without building that
 * tree). */
#include "scene/trace_tree.h"

#include <math.h>
#include <string.h>

#define BINS 32u
#define FEW 24u /* up to this number all splits are evaluated */

typedef struct range {
    uint32_t first, count;
    float area;
} range;

typedef struct builder {
    const masu_trace_box *boxes;
    uint32_t *work; /* item indices; a range refers to it */
} builder;

/* ---- Boxes ----------------------------------------------------------------------------------- */

static masu_trace_box nothing(void) {
    return (masu_trace_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void grow(masu_trace_box *box, const masu_trace_box *by) {
    for (uint32_t k = 0; k < 3; k++) {
        if (by->low[k] < box->low[k]) box->low[k] = by->low[k];
        if (by->high[k] > box->high[k]) box->high[k] = by->high[k];
    }
}

/* Half the surface area. */
static float area_of(const masu_trace_box *b) {
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x >= 0.0f ? x * y + y * z + z * x : 0.0f;
}

static float middle(const masu_trace_box *b, uint32_t axis) {
    return b->low[axis] + b->high[axis]; /* twice the centre */
}

static range measured(const builder *b, uint32_t first, uint32_t count) {
    masu_trace_box all = nothing();
    for (uint32_t i = 0; i < count; i++) grow(&all, &b->boxes[b->work[first + i]]);
    return (range){first, count, area_of(&all)};
}

/* ---- Splits ---------------------------------------------------------------------------------- */

/* Order by centre, then by index: the tree does not depend on the initial order. */
static int behind(const builder *b, uint32_t i, uint32_t j, uint32_t axis) {
    float x = middle(&b->boxes[i], axis), y = middle(&b->boxes[j], axis);
    return x > y || (x == y && i > j);
}

static void sort_few(const builder *b, uint32_t *items, uint32_t count, uint32_t axis) {
    for (uint32_t i = 1; i < count; i++) {
        uint32_t item = items[i], k = i;
        for (; k > 0 && behind(b, items[k - 1], item, axis); k--) items[k] = items[k - 1];
        items[k] = item;
    }
}

static uint32_t split_few(const builder *b, range r) {
    uint32_t best_axis = 0, best_at = r.count / 2;
    uint32_t *items = b->work + r.first;
    float best = INFINITY, left[FEW];
    for (uint32_t axis = 0; axis < 3; axis++) {
        sort_few(b, items, r.count, axis);
        masu_trace_box box = nothing();
        for (uint32_t i = 0; i + 1 < r.count; i++) {
            grow(&box, &b->boxes[items[i]]);
            left[i] = area_of(&box);
        }
        box = nothing();
        for (uint32_t i = r.count - 1; i > 0; i--) {
            grow(&box, &b->boxes[items[i]]);
            float cost = left[i - 1] * (float)i + area_of(&box) * (float)(r.count - i);
            if (cost < best) {
                best = cost;
                best_axis = axis;
                best_at = i;
            }
        }
    }
    if (best_axis != 2) sort_few(b, items, r.count, best_axis);
    return best_at;
}

/* Partitions at the median along the axis of the largest extent of centres: Hoare's quickselect
 * with median-of-three pivots. Quickselect is quadratic in the worst case, so the number of rounds
 * is limited to what normal input needs. After that, the halves are only approximately ordered, but
 * still halves. */
static uint32_t split_half(const builder *b, range r, uint32_t axis) {
    uint32_t *items = b->work + r.first, half = r.count / 2;
    uint32_t low = 0, high = r.count - 1;
    for (uint32_t round = 0; round < 64 && low < high; round++) {
        uint32_t a = items[low], c = items[high], m = items[low + (high - low) / 2];
        uint32_t pivot = behind(b, a, m, axis) ? (behind(b, m, c, axis)   ? m
                                                  : behind(b, a, c, axis) ? c
                                                                          : a)
                                               : (behind(b, a, c, axis)   ? a
                                                  : behind(b, m, c, axis) ? c
                                                                          : m);
        uint32_t i = low, j = high;
        for (;;) {
            while (behind(b, pivot, items[i], axis)) i++;
            while (behind(b, items[j], pivot, axis)) j--;
            if (i >= j) break;
            uint32_t swap = items[i];
            items[i++] = items[j];
            items[j--] = swap;
        }
        if (half <= j)
            high = j;
        else
            low = j + 1;
    }
    return half;
}

typedef struct bins {
    float low[3], scale[3]; /* scale 0: all centres are equal */
    uint32_t widest;
} bins;

static bins bins_of(const builder *b, range r) {
    bins out = {.widest = 0};
    float high[3];
    for (uint32_t k = 0; k < 3; k++) {
        out.low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < r.count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            float m = middle(&b->boxes[b->work[r.first + i]], k);
            if (m < out.low[k]) out.low[k] = m;
            if (m > high[k]) high[k] = m;
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        float width = high[k] - out.low[k];
        out.scale[k] = width > 0.0f ? (float)BINS * 0.9999f / width : 0.0f;
        if (!(out.scale[k] <= 1e30f)) out.scale[k] = 0.0f; /* nearly equal */
        if (width > high[out.widest] - out.low[out.widest]) out.widest = k;
    }
    return out;
}

static uint32_t bin_of(const builder *b, const bins *by, uint32_t item, uint32_t axis) {
    uint32_t bin = (uint32_t)((middle(&b->boxes[item], axis) - by->low[axis]) * by->scale[axis]);
    return bin < BINS ? bin : BINS - 1;
}

static uint32_t split_many(const builder *b, range r) {
    bins by = bins_of(b, r);
    static const masu_trace_box inside_out = {{INFINITY, INFINITY, INFINITY},
                                              {-INFINITY, -INFINITY, -INFINITY}};
    masu_trace_box boxes[3][BINS];
    uint32_t counts[3][BINS];
    memset(counts, 0, sizeof counts);
    for (uint32_t i = 0; i < 3 * BINS; i++) boxes[i / BINS][i % BINS] = inside_out;
    for (uint32_t i = 0; i < r.count; i++) {
        uint32_t item = b->work[r.first + i];
        for (uint32_t axis = 0; axis < 3; axis++) {
            uint32_t bin = bin_of(b, &by, item, axis);
            grow(&boxes[axis][bin], &b->boxes[item]);
            counts[axis][bin]++;
        }
    }
    float best = INFINITY;
    uint32_t best_axis = 0, best_bin = 0, best_count = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        float right[BINS];
        masu_trace_box box = nothing();
        for (uint32_t i = BINS - 1; i > 0; i--) {
            grow(&box, &boxes[axis][i]);
            right[i] = area_of(&box);
        }
        box = nothing();
        uint32_t count = 0;
        for (uint32_t i = 1; i < BINS; i++) {
            grow(&box, &boxes[axis][i - 1]);
            count += counts[axis][i - 1];
            if (!count || count == r.count) continue;
            float cost = area_of(&box) * (float)count + right[i] * (float)(r.count - count);
            if (cost < best) {
                best = cost;
                best_axis = axis;
                best_bin = i;
                best_count = count;
            }
        }
    }
    if (!best_count) return split_half(b, r, by.widest);
    uint32_t *items = b->work + r.first, at = 0;
    for (uint32_t i = 0; i < r.count; i++) {
        if (bin_of(b, &by, items[i], best_axis) >= best_bin) continue;
        uint32_t swap = items[i];
        items[i] = items[at];
        items[at++] = swap;
    }
    return best_count;
}

/* Index of the range to split next; 4: none. If the remaining depth is small (tight), the range
 * with the most items: two rounds of halving leave no child with more than a quarter. */
static uint32_t next_range(const range *ranges, uint32_t count, uint32_t leaf, int tight) {
    uint32_t best = 4;
    for (uint32_t least = leaf; least > 0; least--) { /* splits leaves too if slots are left */
        for (uint32_t i = 0; i < count; i++) {
            if (ranges[i].count <= least) continue;
            if (best == 4 || (tight ? ranges[i].count > ranges[best].count
                                    : ranges[i].area > ranges[best].area)) {
                best = i;
            }
        }
        if (best < 4) break;
    }
    return best;
}

static uint32_t divide(const builder *b, range all, uint32_t leaf, int tight, range ranges[4]) {
    uint32_t count = 1;
    ranges[0] = all;
    while (count < 4) {
        uint32_t i = next_range(ranges, count, leaf, tight);
        if (i == 4) break;
        range r = ranges[i];
        uint32_t at;
        if (tight)
            at = split_half(b, r, bins_of(b, r).widest);
        else
            at = r.count <= FEW ? split_few(b, r) : split_many(b, r);
        ranges[i] = measured(b, r.first, at);
        ranges[count++] = measured(b, r.first + at, r.count - at);
    }
    return count;
}

/* ---- Structure ------------------------------------------------------------------------------- */

/* leaf * 4^levels, at most 2^40. */
static uint64_t most_items(uint32_t leaf, uint32_t levels) {
    return (uint64_t)leaf << 2 * (levels < 19 ? levels : 19);
}

masu_trace_shape masu_trace_tree_shape(const masu_trace_box *boxes, uint32_t items, uint32_t leaf,
                                       uint32_t levels, uint32_t first_node, uint32_t first_item,
                                       uint32_t *order, uint32_t *work,
                                       masu_blob_trace_node *nodes) {
    struct {
        range r;
        uint32_t node, level;
    } stack[3 * MASU_TRACE_DEPTH_MAX + 4];
    masu_trace_shape out = {0, 0};
    uint32_t pending = 0, placed = 0;
    builder b = {boxes, work};
    if (!items) return out;
    for (uint32_t i = 0; i < items; i++) work[i] = i;
    stack[pending].r = measured(&b, 0, items);
    stack[pending].node = 0;
    stack[pending++].level = 1;
    out.nodes = 1;
    while (pending > 0) {
        pending--;
        range all = stack[pending].r, ranges[4];
        uint32_t node = stack[pending].node, level = stack[pending].level, slot = 0;
        int tight = all.count > most_items(leaf, levels - level);
        uint32_t count = divide(&b, all, leaf, tight, ranges);
        masu_blob_trace_node n = {.child = first_node + out.nodes, .item = first_item + placed};
        if (level > out.depth) out.depth = level;
        /* Popped in reverse order: the first child is the next node of the traversal. */
        for (uint32_t i = count; i-- > 0;) {
            if (ranges[i].count <= leaf) continue;
            stack[pending].r = ranges[i];
            stack[pending++].level = level + 1;
            n.packed |= 1u << (24 + 2 * slot++);
        }
        for (uint32_t i = 0; i < slot; i++) stack[pending - 1 - i].node = out.nodes + i;
        out.nodes += slot;
        for (uint32_t i = 0; i < count; i++) {
            if (ranges[i].count > leaf) continue;
            n.packed |= (ranges[i].count + 1) << (24 + 2 * slot++);
            for (uint32_t k = 0; k < ranges[i].count; k++)
                order[placed++] = work[ranges[i].first + k];
        }
        nodes[node] = n;
    }
    return out;
}

/* ---- Boxes ----------------------------------------------------------------------------------- */

/* Exponent of the smallest power of two of which 255 cover the extent; large enough that origin +
 * 255 * scale is exact in double. */
static int exponent_of(double extent, float origin) {
    int e = -126, of_origin = -126;
    if (extent > 0.0) {
        (void)frexp(extent / 255.0, &e);
        if (ldexp(255.0, e - 1) >= extent) e--;
    }
    if (origin != 0.0f) (void)frexpf(origin, &of_origin);
    if (e < of_origin - 40) e = of_origin - 40;
    return e < -126 ? -126 : e > 43 ? 43 : e;
}

static void quantise(masu_blob_trace_node *n, const masu_trace_box boxes[4], uint32_t count,
                     const masu_trace_box *all) {
    n->packed &= 0xFF000000u;
    for (uint32_t k = 0; k < 3; k++) {
        double origin = (double)all->low[k];
        int e = exponent_of((double)all->high[k] - origin, all->low[k]);
        double scale = ldexp(1.0, e);
        n->origin[k] = all->low[k];
        n->packed |= (uint32_t)(e + 127) << 8 * k;
        n->low[k] = n->high[k] = 0;
        for (uint32_t i = 0; i < 4; i++) {
            double low = 255.0, high = 0.0; /* low > high: an empty box */
            if (i < count) {
                low = floor(((double)boxes[i].low[k] - origin) / scale);
                high = ceil(((double)boxes[i].high[k] - origin) / scale);
                /* Corrects rounding of the differences above. */
                if (low > 0.0 && origin + low * scale > (double)boxes[i].low[k]) low -= 1.0;
                if (high < 255.0 && origin + high * scale < (double)boxes[i].high[k]) high += 1.0;
            }
            n->low[k] |= (uint32_t)fmin(fmax(low, 0.0), 255.0) << 8 * i;
            n->high[k] |= (uint32_t)fmin(fmax(high, 0.0), 255.0) << 8 * i;
        }
    }
}

static float share(const masu_trace_box *part, float area) {
    return area > 0.0f ? area_of(part) / area : 1.0f;
}

double masu_trace_tree_fit(masu_blob_trace_node *nodes, uint32_t count, uint32_t first_node,
                           uint32_t first_item, const uint32_t *order, const masu_trace_box *boxes,
                           masu_trace_below *below) {
    double sum = 0.0;
    for (uint32_t i = count; i-- > 0;) { /* children follow their parents */
        masu_blob_trace_node *n = &nodes[i];
        masu_trace_box of[4];
        float costs[4];
        uint32_t child = n->child - first_node, item = n->item - first_item, slots = 0;
        masu_trace_below all = {.box = nothing(), .cost = 1.0f};
        for (; slots < 4; slots++) {
            uint32_t type = masu_trace_type(n, slots);
            if (!type) break;
            if (type == 1) {
                of[slots] = below[child].box;
                costs[slots] = below[child++].cost;
            } else {
                of[slots] = boxes[order[item++]];
                if (type == 3) grow(&of[slots], &boxes[order[item++]]);
                costs[slots] = (float)(type - 1);
            }
            grow(&all.box, &of[slots]);
        }
        quantise(n, of, slots, &all.box);
        float area = area_of(&all.box);
        for (uint32_t slot = 0; slot < slots; slot++)
            all.cost += share(&of[slot], area) * costs[slot];
        below[i] = all;
        sum += (double)log2f(fmaxf(area, 1e-37f));
    }
    return count ? sum / count : 0.0;
}

void masu_trace_tree_child(const masu_blob_trace_node *node, uint32_t slot, double low[3],
                           double high[3]) {
    for (uint32_t k = 0; k < 3; k++) {
        double scale = ldexp(1.0, (int)(node->packed >> 8 * k & 0xFFu) - 127);
        low[k] = (double)node->origin[k] + (node->low[k] >> 8 * slot & 0xFFu) * scale;
        high[k] = (double)node->origin[k] + (node->high[k] >> 8 * slot & 0xFFu) * scale;
    }
}
