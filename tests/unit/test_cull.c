/* test_cull.c: frustum culling of boxes, compared with an exact test in double precision: it culls
 * nothing that the exact test keeps, however degenerate box or view are; it keeps little that the
 * exact test culls; the hierarchy keeps the same boxes as testing each one, with few tests; SIMD
 * and plain C are bit-identical. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/cull.h"
#include "support/random.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define FIELD 8000u

/* ---- Random numbers -------------------------------------------------------------------------- */

static uint64_t seed;

static double sign(void) { return support_random(&seed) & 1 ? 1.0 : -1.0; }

static double magnitude(double low, double high) {
    return sign() * exp(random_between(&seed, log(low), log(high)));
}

/* ---- The exact test -------------------------------------------------------------------------- */

typedef struct exact_view {
    uint32_t count;
    double n[6][3], d[6];
} exact_view;

/* Doubles hold the products of floats exactly, and their sums to 2^-52. A box within that distance
 * of the border is neither kept nor culled for certain, and is treated as culled. */
static int kept_exactly(const exact_view *v, const masu_cull_box *b) {
    for (uint32_t p = 0; p < v->count; p++) {
        double m = v->d[p], r = 0.0, size = fabs(v->d[p]);
        for (uint32_t k = 0; k < 3; k++) {
            m += v->n[p][k] * (double)b->center[k];
            r += fabs(v->n[p][k]) * (double)b->half[k];
            size += fabs(v->n[p][k] * (double)b->center[k]) + fabs(v->n[p][k] * (double)b->half[k]);
        }
        if (m + r < size * 0x1p-50) return 0;
    }
    return 1;
}

/* A camera as in src/frame/camera.c, and its five planes from the GPU's matrix. */
static void camera(const double eye[3], const double forward[3], double fov, double aspect,
                   double near_distance, masu_cull_view *view, exact_view *exact) {
    double f[3], r[3], u[3], length = 0.0;
    for (uint32_t k = 0; k < 3; k++) length += forward[k] * forward[k];
    for (uint32_t k = 0; k < 3; k++) f[k] = forward[k] / sqrt(length);
    r[0] = -f[2], r[1] = 0.0, r[2] = f[0];
    length = sqrt(r[0] * r[0] + r[2] * r[2]);
    if (length > 0.0) r[0] /= length, r[2] /= length;
    if (!(length > 0.0)) r[0] = 1.0;
    for (uint32_t k = 0; k < 3; k++) {
        u[k] = r[(k + 1) % 3] * f[(k + 2) % 3] - r[(k + 2) % 3] * f[(k + 1) % 3];
    }
    float clip[16] = {0};
    double tan_y = tan(fov / 2), tan_x = tan_y * aspect;
    for (uint32_t k = 0; k < 3; k++) {
        clip[4 * k] = (float)(r[k] / tan_x);
        clip[4 * k + 1] = (float)(-u[k] / tan_y);
        clip[4 * k + 3] = (float)f[k];
    }
    clip[14] = (float)near_distance;
    masu_cull_camera(view, clip, eye, (float)near_distance);
    exact->count = 5;
    for (uint32_t p = 0; p < 5; p++) {
        exact->d[p] = p == 4 ? -(double)clip[14] : 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            double s = p < 4 ? (double)clip[4 * k + p / 2] : 0.0;
            exact->n[p][k] = (double)clip[4 * k + 3] + (p % 2 ? -s : s);
            exact->d[p] -= exact->n[p][k] * eye[k];
        }
    }
}

static void random_camera(double span, masu_cull_view *view, exact_view *exact) {
    static const double fovs[] = {0.001, 0.7, 1.5, 3.1};
    double eye[3], forward[3];
    for (uint32_t k = 0; k < 3; k++) {
        eye[k] = random_between(&seed, -span, span);
        forward[k] = random_between(&seed, -1.0, 1.0);
    }
    if (support_random(&seed) % 4 == 0) { /* along an axis */
        memset(forward, 0, sizeof forward);
        forward[support_random(&seed) % 3] = sign();
    }
    camera(eye, forward, fovs[support_random(&seed) % COUNT(fovs)],
           random_between(&seed, 0.1, 10.0),
           support_random(&seed) % 2 ? 0.1 : exp(random_between(&seed, log(1e-9), log(1e9))), view,
           exact);
}

/* The six planes of the region |axis[i].(x - center)| <= half[i]; axes need not be unit vectors. */
static void set_box_planes(masu_cull_view *view, const double center[3], const double axis[3][3],
                           const double half[3]) {
    view->count = 0;
    for (uint32_t plane = 0; plane < 6; plane++) {
        double n[3], d = half[plane / 2];
        for (uint32_t k = 0; k < 3; k++) {
            n[k] = (plane % 2 ? -1.0 : 1.0) * axis[plane / 2][k];
            d -= n[k] * center[k];
        }
        masu_cull_add_plane(view, n, d);
    }
}

static void random_ortho(double span, masu_cull_view *view, exact_view *exact) {
    double center[3], axis[3][3], half[3];
    exact->count = 6;
    for (uint32_t i = 0; i < 3; i++) {
        center[i] = random_between(&seed, -span, span);
        half[i] = fabs(magnitude(1e-3, 2 * span));
        for (uint32_t k = 0; k < 3; k++) axis[i][k] = random_between(&seed, -1.0, 1.0);
    }
    set_box_planes(view, center, (const double(*)[3])axis, half);
    for (uint32_t p = 0; p < 6; p++) {
        exact->d[p] = half[p / 2];
        for (uint32_t k = 0; k < 3; k++) {
            exact->n[p][k] = p % 2 ? -axis[p / 2][k] : axis[p / 2][k];
            exact->d[p] -= exact->n[p][k] * center[k];
        }
    }
}

static masu_cull_box random_box(double span) {
    static const float odd[] = {0.0f, -0.0f, 1e-45f, 1e30f, -1e30f, 3e38f, -3e38f,
                                (float)NAN, (float)INFINITY, (float)-INFINITY};
    masu_cull_box b;
    uint64_t kind = support_random(&seed) % 8;
    double size = exp(random_between(&seed, log(1e-6), log(4 * span)));
    for (uint32_t k = 0; k < 3; k++) {
        b.center[k] =
            (float)(kind == 1 ? magnitude(1e-3, 1e7) : random_between(&seed, -span, span));
        b.half[k] = (float)(kind == 2 ? 0.0 : kind == 3 ? fabs(magnitude(1e-6, 1e6))
                                                        : random_between(&seed, 0.0, size));
        if (kind == 0 && support_random(&seed) % 2) {
            b.half[k] = fabsf(odd[support_random(&seed) % COUNT(odd)]);
        }
        if (kind == 0 && support_random(&seed) % 2) {
            b.center[k] = odd[support_random(&seed) % COUNT(odd)];
        }
    }
    return b;
}

/* A box that almost touches a plane from outside or inside, a few ulp away. */
static masu_cull_box bordering_box(double span, const exact_view *v) {
    masu_cull_box b = random_box(span);
    uint32_t p = (uint32_t)(support_random(&seed) % v->count);
    double m = v->d[p], r = 0.0;
    uint32_t largest = 0;
    for (uint32_t k = 0; k < 3; k++) {
        if (!(fabsf(b.center[k]) <= 1e9f)) b.center[k] = 1.0f;
        if (!(b.half[k] <= 1e9f)) b.half[k] = 1.0f;
        m += v->n[p][k] * (double)b.center[k];
        r += fabs(v->n[p][k]) * (double)b.half[k];
        if (fabs(v->n[p][k]) > fabs(v->n[p][largest])) largest = k;
    }
    b.center[largest] -= (float)((m + r) / v->n[p][largest]);
    return b;
}

static int is_number(const masu_cull_box *b) {
    for (uint32_t k = 0; k < 3; k++) {
        if (!isfinite(b->center[k]) || !isfinite(b->half[k])) return 0;
    }
    return 1;
}

/* ---- Sets ------------------------------------------------------------------------------------ */

typedef struct field {
    float arrays[6][FIELD + 3];
    uint32_t items[FIELD];
    masu_cull_box boxes[FIELD]; /* in the given order, by position */
    masu_cull_node nodes[2 * FIELD];
    uint8_t states[2 * FIELD], marks[FIELD];
    masu_cull_set set;
} field;

static field fields[2];

static void put(field *f, uint32_t at, const masu_cull_box *box) {
    masu_cull_box wide = masu_cull_widen(box, 1.0f);
    f->boxes[at] = *box;
    for (uint32_t k = 0; k < 3; k++) {
        f->arrays[k][at] = wide.center[k];
        f->arrays[3 + k][at] = wide.half[k];
    }
}

static void start(field *f, uint32_t count) {
    memset(f->states, 0, sizeof f->states);
    f->set = (masu_cull_set){.nodes = f->nodes, .items = f->items, .count = count};
    for (uint32_t k = 0; k < 6; k++) f->set.boxes[k] = f->arrays[k];
    for (uint32_t i = 0; i < count; i++) f->items[i] = i;
}

static masu_cull_box wide_at(const field *f, uint32_t at) {
    masu_cull_box b;
    for (uint32_t k = 0; k < 3; k++) {
        b.center[k] = f->arrays[k][at];
        b.half[k] = f->arrays[3 + k][at];
    }
    return b;
}

/* A hierarchy over the positions in their order: groups of `leaf`, eight groups per parent, in
 * breadth-first order. */
static void grow(field *f, uint32_t leaf) {
    uint32_t sizes[16], levels = 0, n = (f->set.count + leaf - 1) / leaf;
    for (sizes[levels++] = n; n > 1; sizes[levels++] = n) n = (n + 7) / 8;
    f->set.tree_count = f->set.count;
    f->set.node_count = 0;
    for (uint32_t l = 0; l < levels; l++) f->set.node_count += sizes[l];
    uint32_t first = f->set.node_count;
    for (uint32_t l = 0; l < levels; l++) {
        uint32_t below = first;
        first -= sizes[l];
        for (uint32_t i = 0; i < sizes[l]; i++) {
            masu_cull_node *node = &f->nodes[first + i];
            masu_cull_box boxes[64];
            uint32_t each = l ? 8 : leaf, total = l ? sizes[l - 1] : f->set.count;
            uint32_t members = total - i * each < each ? total - i * each : each;
            *node = (masu_cull_node){.first_child = 0};
            for (uint32_t k = 0; k < members; k++) {
                boxes[k] = l ? f->nodes[below + i * each + k].box : wide_at(f, i * each + k);
            }
            node->box = masu_cull_around(boxes, members);
            if (l) node->first_child = below + i * each, node->child_count = members;
            if (!l) node->first_item = i * each, node->item_count = members;
        }
    }
    for (uint32_t i = 0; i < f->set.node_count; i++) {
        f->nodes[i].box = masu_cull_widen(&f->nodes[i].box, 4.0f);
    }
}

static masu_cull_counts cull(field *f, const masu_cull_view *view, int plain) {
    masu_cull_counts counts = {0, 0};
    (plain ? masu_cull_plain : masu_cull)(&f->set, view, f->states, f->marks, 2, &counts);
    return counts;
}

/* ---- Testing each box ------------------------------------------------------------------------ */

static void no_box_of_a_million_is_culled_that_the_exact_test_keeps(void **state) {
    (void)state;
    field *f = &fields[0];
    const uint32_t batch = 1000;
    uint64_t tried = 0, exact_kept = 0, kept = 0, falsely = 0;
    for (uint64_t round = 0; round < 1000; round++) {
        double span = exp(random_between(&seed, log(1.0), log(1e6)));
        masu_cull_view view;
        exact_view exact;
        seed = 0x1000 + round;
        if (round % 3 == 2) {
            random_ortho(span, &view, &exact);
        } else {
            random_camera(span, &view, &exact);
        }
        assert_int_equal(view.count, exact.count);
        start(f, batch);
        for (uint32_t i = 0; i < batch; i++) {
            masu_cull_box b = i % 4 ? random_box(span) : bordering_box(span, &exact);
            put(f, i, &b);
        }
        memset(f->marks, 0xFF, sizeof f->marks);
        cull(f, &view, 0);
        for (uint32_t i = 0; i < batch; i++) {
            int here = f->marks[i] == 0xFF;
            assert_true(here || f->marks[i] == 0xFD); /* no other bit changes */
            tried++;
            kept += here;
            if (!is_number(&f->boxes[i])) {
                assert_true(here);
                continue;
            }
            int there = kept_exactly(&exact, &f->boxes[i]);
            exact_kept += there;
            if (there && !here) {
                fail_msg("round %u box %u: (%a %a %a) +- (%a %a %a) was culled", (unsigned)round, i,
                         (double)f->boxes[i].center[0], (double)f->boxes[i].center[1],
                         (double)f->boxes[i].center[2], (double)f->boxes[i].half[0],
                         (double)f->boxes[i].half[1], (double)f->boxes[i].half[2]);
            }
            /* Not counted as kept falsely: boxes at the border of a plane, which the slack keeps,
             * and boxes beyond MASU_CULL_FAR, which have no defined position. */
            masu_cull_box wide = wide_at(f, i);
            if (i % 4 && is_number(&wide)) falsely += here && !there;
        }
    }
    print_message("kept %llu of %llu, %llu falsely\n", (unsigned long long)kept,
                  (unsigned long long)tried, (unsigned long long)falsely);
    assert_int_equal(tried, 1000000);
    assert_in_range(exact_kept, tried / 20, tried * 19 / 20); /* both answers are common */
    assert_true(falsely < tried / 1000);
}

/* The slack has its documented size: a box further outside is culled. */
static void boxes_beyond_the_slack_are_culled(void **state) {
    (void)state;
    field *f = &fields[0];
    uint64_t tried = 0;
    for (uint64_t round = 0; round < 20000; round++) {
        masu_cull_view view;
        exact_view exact;
        seed = 0x900000 + round;
        random_ortho(1000.0, &view, &exact);
        masu_cull_box b = bordering_box(1000.0, &exact);
        for (uint32_t p = 0; p < exact.count; p++) {
            double m = exact.d[p], size = fabs(exact.d[p]), r = 0.0;
            for (uint32_t k = 0; k < 3; k++) {
                double n = exact.n[p][k];
                m += n * (double)b.center[k];
                r += fabs(n) * (double)b.half[k];
                size += fabs(n * (double)b.center[k]);
            }
            if (!(m + r < -2.0 * (double)MASU_CULL_SLACK * size)) continue;
            start(f, 1);
            put(f, 0, &b);
            cull(f, &view, 0);
            assert_int_equal(f->marks[0] & 2, 0);
            tried++;
            break;
        }
    }
    assert_true(tried > 1000);
}

/* Around the origin the group's share of the slack is all that it has: its centre does not reflect
 * the magnitude of the numbers. */
static void a_group_is_kept_where_its_only_box_is(void **state) {
    (void)state;
    field *f = &fields[0];
    for (int i = 0; i < 200; i++) {
        masu_cull_box box = {{0, 0, 0}, {1 + (float)i, 1, 1}};
        masu_cull_view view = {.count = 0};
        const double n[3] = {1, 0, 0};
        double by = 2.0 * i / 200 - 0.5; /* of the slack */
        start(f, 1);
        put(f, 0, &box);
        masu_cull_add_plane(&view, n, -(double)box.half[0] * (1.0 + by * (double)MASU_CULL_SLACK));
        cull(f, &view, 1);
        uint32_t alone = f->marks[0] & 2u;
        grow(f, 16);
        for (int plain = 0; plain < 2; plain++) {
            cull(f, &view, plain);
            assert_int_equal(f->marks[0] & 2u, alone);
        }
        if (by < 0.4) assert_int_equal(alone, 2);
        if (by > 1.2) assert_int_equal(alone, 0);
    }
}

static void planes_that_are_no_planes_reject_nothing(void **state) {
    (void)state;
    static const double normals[][3] = {
        {0, 0, 0}, {(double)NAN, 0, 1}, {(double)INFINITY, 0, 0}, {0, 0, 0}};
    masu_cull_view view = {.count = 0};
    for (size_t i = 0; i < COUNT(normals); i++) masu_cull_add_plane(&view, normals[i], -1.0);
    masu_cull_add_plane(&view, (const double[3]){1, 0, 0}, (double)NAN);
    masu_cull_add_plane(&view, (const double[3]){1, 0, 0}, -1e31);
    assert_int_equal(view.count, 0);
    for (uint32_t i = 0; i < 9; i++) masu_cull_add_plane(&view, (const double[3]){1, 0, 0}, 1.0);
    assert_int_equal(view.count, MASU_CULL_PLANES);
}

static void an_empty_set_and_an_empty_view_keep_nothing(void **state) {
    (void)state;
    field *f = &fields[0];
    masu_cull_view view = {.count = 0};
    start(f, 0);
    assert_int_equal(cull(f, &view, 0).plane_tests, 0);
    start(f, 5);
    masu_cull_box b = {{1, 2, 3}, {1, 1, 1}};
    for (uint32_t i = 0; i < 5; i++) put(f, i, &b);
    memset(f->marks, 0, sizeof f->marks);
    assert_int_equal(cull(f, &view, 0).plane_tests, 0);
    for (uint32_t i = 0; i < 5; i++) assert_int_equal(f->marks[i], 2);
}

/* ---- Transforming ---------------------------------------------------------------------------- */

static void a_placed_box_holds_what_floats_make_of_its_points(void **state) {
    (void)state;
    for (uint64_t round = 0; round < 100000; round++) {
        float rows[12], low[3], high[3];
        seed = 0x5000000 + round;
        for (uint32_t k = 0; k < 12; k++) {
            rows[k] = (float)(k % 4 == 3 ? magnitude(1e-3, 1e7) : magnitude(1e-3, 1e3));
        }
        for (uint32_t k = 0; k < 3; k++) {
            float a = (float)magnitude(1e-3, 1e6), b = (float)magnitude(1e-3, 1e6);
            low[k] = a < b ? a : b;
            high[k] = a < b ? b : a;
        }
        masu_cull_box box = masu_cull_place(rows, low, high);
        for (uint32_t corner = 0; corner < 9; corner++) {
            float p[3];
            for (uint32_t k = 0; k < 3; k++) {
                p[k] = corner == 8
                           ? low[k] + (high[k] - low[k]) * (float)random_between(&seed, 0.0, 0.999)
                       : corner >> k & 1 ? high[k]
                                         : low[k];
            }
            for (uint32_t i = 0; i < 3; i++) {
                const float *row = rows + 4 * i;
                float x = ((row[0] * p[0] + row[1] * p[1]) + row[2] * p[2]) + row[3];
                assert_true(fabs((double)x - (double)box.center[i]) <= (double)box.half[i]);
            }
        }
    }
}

static void boxes_around_boxes_hold_them(void **state) {
    (void)state;
    for (uint64_t round = 0; round < 100000; round++) {
        masu_cull_box boxes[5];
        seed = 0x7000000 + round;
        for (uint32_t i = 0; i < 5; i++) {
            masu_cull_box b = random_box(100.0);
            boxes[i] = masu_cull_widen(&b, 1.0f);
        }
        masu_cull_box around = masu_cull_around(boxes, 5);
        for (uint32_t i = 0; i < 5; i++) {
            assert_true(masu_cull_holds(&around, &boxes[i]));
            /* Its own members give its size, except for an ulp. */
            if (isfinite(around.half[0])) assert_true(around.half[0] >= boxes[i].half[0]);
        }
        around.half[1] = nextafterf(around.half[1] * 0.999f, 0.0f);
        int all = 1;
        for (uint32_t i = 0; i < 5; i++) all &= masu_cull_holds(&around, &boxes[i]);
        assert_true(!all || around.half[1] == 0.0f || isinf(around.half[1]));
    }
}

/* ---- The hierarchy --------------------------------------------------------------------------- */

static int by_place(const void *a, const void *b) {
    const masu_cull_box *p = a, *q = b;
    /* Cells of a Morton curve: in this order, groups contain neighbours. */
    for (int level = 9; level >= 0; level--) {
        for (uint32_t k = 0; k < 3; k++) {
            int i = (int)((double)p->center[k] / 2.0 + 512) >> level & 1;
            int j = (int)((double)q->center[k] / 2.0 + 512) >> level & 1;
            if (i != j) return i - j;
        }
    }
    return 0;
}

/* A town of 8,000: streets of boxes within 1,000 m. */
static void build_town(field *f, uint64_t number) {
    static masu_cull_box boxes[FIELD];
    seed = number;
    for (uint32_t i = 0; i < FIELD; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            boxes[i].center[k] =
                (float)random_between(&seed, k == 1 ? 0.0 : -500.0, k == 1 ? 60.0 : 500.0);
            boxes[i].half[k] = (float)exp(random_between(&seed, log(0.2), log(8.0)));
        }
    }
    qsort(boxes, FIELD, sizeof *boxes, by_place);
    start(f, FIELD);
    for (uint32_t i = 0; i < FIELD; i++) put(f, i, &boxes[i]);
}

static void street_view(double t, masu_cull_view *view, exact_view *exact) {
    double eye[3] = {400.0 * cos(t * 0.01), 2.0, 400.0 * sin(t * 0.013)};
    double forward[3] = {cos(t * 0.021), 0.1 * sin(t * 0.05), sin(t * 0.021)};
    camera(eye, forward, 1.0, 16.0 / 9.0, 0.1, view, exact);
}

static void the_tree_keeps_what_one_by_one_keeps(void **state) {
    (void)state;
    field *tree = &fields[0], *flat = &fields[1];
    static const uint32_t leaves[] = {1, 3, 16};
    for (uint64_t round = 0; round < 300; round++) {
        double span = exp(random_between(&seed, log(1.0), log(1e6)));
        uint32_t count = 1 + (uint32_t)(round * 7 % 1500);
        seed = 0x300000 + round;
        start(tree, count);
        start(flat, count);
        masu_cull_view view;
        exact_view exact;
        random_camera(span, &view, &exact);
        for (uint32_t i = 0; i < count; i++) {
            masu_cull_box b = i % 3 ? random_box(span) : bordering_box(span, &exact);
            put(tree, i, &b);
            put(flat, i, &b);
        }
        grow(tree, leaves[round % COUNT(leaves)]);
        /* also with the rejecting planes it has stored */
        for (uint32_t again = 0; again < 3; again++) {
            cull(tree, &view, 0);
            cull(flat, &view, 0);
            for (uint32_t i = 0; i < count; i++) {
                if ((tree->marks[i] & 2) != (flat->marks[i] & 2)) {
                    fail_msg("round %u: box %u of %u: %d in the hierarchy, %d by itself",
                             (unsigned)round, i, count, tree->marks[i] & 2, flat->marks[i] & 2);
                }
            }
            if (again == 1) random_ortho(span, &view, &exact);
        }
    }
}

static void a_path_through_a_town_takes_few_tests(void **state) {
    (void)state;
    field *tree = &fields[0], *flat = &fields[1];
    build_town(tree, 1);
    build_town(flat, 1);
    grow(tree, MASU_CULL_LEAF);
    uint64_t in_tree = 0, alone = 0, kept = 0;
    for (uint32_t frame = 0; frame < 300; frame++) {
        masu_cull_view view;
        exact_view exact;
        street_view(frame, &view, &exact);
        in_tree += cull(tree, &view, 0).plane_tests;
        /* Tested one by one, ending at the first rejecting plane, unlike the test of four at a
         * time. */
        for (uint32_t i = 0; i < FIELD; i++) {
            int here = 1;
            for (uint32_t p = 0; p < 5 && here; p++) {
                masu_cull_view one = {.count = 1, .planes = {view.planes[p]}};
                masu_cull_set single = flat->set;
                masu_cull_counts counts = {0, 0};
                uint8_t mark = 0;
                const uint32_t item = 0;
                for (uint32_t k = 0; k < 6; k++) single.boxes[k] += i;
                single.items = &item;
                single.count = 1;
                masu_cull(&single, &one, NULL, &mark, 1, &counts);
                alone += counts.plane_tests;
                here = mark;
            }
            assert_int_equal(here, tree->marks[i] >> 1 & 1);
            kept += (uint32_t)here;
        }
    }
    print_message("%llu plane tests in a tree, %llu one by one; %llu of %u kept\n",
                  (unsigned long long)in_tree, (unsigned long long)alone,
                  (unsigned long long)kept / 300, FIELD);
    assert_true(kept > 300 * FIELD / 50 && kept < 300 * FIELD / 2);
    assert_true(4 * in_tree <= alone);
}

static void the_plane_that_rejected_last_is_asked_first(void **state) {
    (void)state;
    field *f = &fields[0];
    build_town(f, 2);
    grow(f, MASU_CULL_LEAF);
    masu_cull_view view;
    exact_view exact;
    street_view(17, &view, &exact);
    masu_cull_counts first = cull(f, &view, 0), second = cull(f, &view, 0);
    assert_int_equal(first.nodes, second.nodes);
    assert_true(second.plane_tests < first.plane_tests);
    for (uint32_t i = 0; i < f->set.node_count; i++) assert_true(f->states[i] < 8);
}

static void what_has_moved_is_tested_where_it_is(void **state) {
    (void)state;
    field *f = &fields[0];
    build_town(f, 3);
    grow(f, MASU_CULL_LEAF);
    static uint32_t moved[FIELD / 4];
    masu_cull_view view;
    exact_view exact;
    street_view(40, &view, &exact);
    for (uint32_t i = 0; i < COUNT(moved); i++) {
        masu_cull_box b = random_box(500.0);
        moved[i] = 4 * i;
        put(f, 4 * i, &b);
    }
    f->set.moved = moved;
    f->set.moved_count = COUNT(moved);
    cull(f, &view, 0);
    uint32_t here = 0;
    for (uint32_t i = 0; i < FIELD; i++) {
        if (is_number(&f->boxes[i]) && kept_exactly(&exact, &f->boxes[i]))
            assert_true(f->marks[i] & 2);
        if (i % 4 == 0) here += f->marks[i] >> 1 & 1u;
    }
    assert_in_range(here, COUNT(moved) / 50, COUNT(moved) / 2); /* and not all */
}

static void simd_and_plain_agree_in_every_bit(void **state) {
    (void)state;
    field *f = &fields[0];
    static uint8_t marks[FIELD], states[2 * FIELD];
    for (uint64_t round = 0; round < 200; round++) {
        masu_cull_view view;
        exact_view exact;
        seed = 0x770000 + round;
        double span = exp(random_between(&seed, log(1.0), log(1e6)));
        uint32_t count = 1 + (uint32_t)(support_random(&seed) % 2000);
        random_camera(span, &view, &exact);
        if (round % 2) random_ortho(span, &view, &exact);
        start(f, count);
        for (uint32_t i = 0; i < count; i++) {
            masu_cull_box b = i % 3 ? random_box(span) : bordering_box(span, &exact);
            put(f, i, &b);
        }
        if (round % 4) grow(f, 1 + (uint32_t)(round % 16));
        memset(f->marks, 0x55, sizeof f->marks);
        masu_cull_counts plain = cull(f, &view, 1);
        memcpy(marks, f->marks, sizeof marks);
        memcpy(states, f->states, sizeof states);
        memset(f->marks, 0x55, sizeof f->marks);
        memset(f->states, 0, sizeof f->states);
        masu_cull_counts simd = cull(f, &view, 0);
        assert_memory_equal(marks, f->marks, sizeof marks);
        assert_memory_equal(states, f->states, sizeof states);
        assert_int_equal(plain.nodes, simd.nodes);
        assert_int_equal(plain.plane_tests, simd.plane_tests);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_box_of_a_million_is_culled_that_the_exact_test_keeps),
        cmocka_unit_test(boxes_beyond_the_slack_are_culled),
        cmocka_unit_test(a_group_is_kept_where_its_only_box_is),
        cmocka_unit_test(planes_that_are_no_planes_reject_nothing),
        cmocka_unit_test(an_empty_set_and_an_empty_view_keep_nothing),
        cmocka_unit_test(a_placed_box_holds_what_floats_make_of_its_points),
        cmocka_unit_test(boxes_around_boxes_hold_them),
        cmocka_unit_test(the_tree_keeps_what_one_by_one_keeps),
        cmocka_unit_test(a_path_through_a_town_takes_few_tests),
        cmocka_unit_test(the_plane_that_rejected_last_is_asked_first),
        cmocka_unit_test(what_has_moved_is_tested_where_it_is),
        cmocka_unit_test(simd_and_plain_agree_in_every_bit),
    };
    return cmocka_run_group_tests_name("cull", tests, NULL, NULL);
}
