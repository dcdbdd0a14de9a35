/* analyse.c: what is known of a field before it is ever evaluated (sdfc_facts): its Lipschitz
 * constant, where the solid can be, and how fast the field grows outside of that. Every operator
 * has a rule; what a rule needs and cannot have (a twist of something endless, a repeated shape that
 * sticks out of its cell) is an error at the operator.
 *
 * `growth` is what makes the rest sound: a field that is only a lower bound of the distance may stay
 * small far away, so "f <= r", what round(r) makes solid, may reach further than r. With
 * f >= growth * distance(box), r / growth is far enough.
 *
 * Operators that need derived numbers (the rotation's matrix, 1 / scale) replace their arguments by
 * those, as expressions, so that constants fold and the rest is computed once per frame. */
#include "sdfc/internal.h"

#include <string.h>

#define EVERYWHERE                                                                                 \
    ((sdfc_box){{-SDFC_INFINITY, -SDFC_INFINITY, -SDFC_INFINITY},                                  \
                {SDFC_INFINITY, SDFC_INFINITY, SDFC_INFINITY}})

static double high(const sdfc *c, int e) { return c->exprs[e].high; }
static double low(const sdfc *c, int e) { return c->exprs[e].low; }
static double most(const sdfc *c, int e) { return fmax(fabs(low(c, e)), fabs(high(c, e))); }
static double size_of(const sdfc *c, int e) { return fmax(high(c, e), 0); }

static int number(sdfc *c, double v) { return sdfc_number(c, v); }
static int apply2(sdfc *c, int op, int x, int y) { return sdfc_apply(c, op, x, y, x); }
static int apply1(sdfc *c, int op, int x) { return sdfc_apply(c, op, x, x, x); }

/* ---- boxes and spheres ---- */

static bool bounded(const sdfc_box *b) {
    for (int i = 0; i < 3; i++) {
        if (!isfinite(b->low[i]) || !isfinite(b->high[i])) return false;
    }
    return true;
}

static double corner(const sdfc_box *b, int i) { return fmax(fabs(b->low[i]), fabs(b->high[i])); }

static double norm3(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static sdfc_box symmetric_box(double x, double y, double z) {
    return (sdfc_box){{-x, -y, -z}, {x, y, z}};
}

/* The sphere around the box, where that is smaller. Both keep their growth. */
static void tighten(sdfc_facts *f) {
    double half[3], center[3];
    if (!bounded(&f->box)) return;
    for (int i = 0; i < 3; i++) {
        half[i] = (f->box.high[i] - f->box.low[i]) / 2;
        center[i] = f->box.low[i] + half[i];
    }
    double radius = norm3(half);
    if (radius < f->radius) {
        f->radius = radius;
        memcpy(f->center, center, sizeof center);
    }
}

static void sphere_of_box(sdfc_facts *f) {
    f->radius = SDFC_INFINITY;
    memset(f->center, 0, sizeof f->center);
    tighten(f);
}

static void box_of_sphere(sdfc_facts *f) {
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = f->center[i] - f->radius;
        f->box.high[i] = f->center[i] + f->radius;
    }
}

static void widen(sdfc_facts *f, double by) {
    for (int i = 0; i < 3; i++) {
        f->box.low[i] -= by;
        f->box.high[i] += by;
    }
    f->radius += by;
}

static void join(sdfc_facts *f, const sdfc_facts *g) {
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = fmin(f->box.low[i], g->box.low[i]);
        f->box.high[i] = fmax(f->box.high[i], g->box.high[i]);
    }
    if (!isfinite(f->radius) || !isfinite(g->radius)) {
        f->radius = SDFC_INFINITY;
        return;
    }
    double d[3] = {g->center[0] - f->center[0], g->center[1] - f->center[1],
                   g->center[2] - f->center[2]};
    double apart = norm3(d);
    if (apart + g->radius <= f->radius) return;
    if (apart + f->radius <= g->radius) {
        f->radius = g->radius;
        memcpy(f->center, g->center, sizeof f->center);
        return;
    }
    double radius = (apart + f->radius + g->radius) / 2;
    double t = apart > 0 ? (radius - f->radius) / apart : 0;
    for (int i = 0; i < 3; i++) f->center[i] += d[i] * t;
    f->radius = radius * (1 + 1e-12);
}

/* Distance of the box, or of the sphere if that is nearer, from an axis. */
static double reach(const sdfc_facts *f, int i, int j) {
    double r = hypot(corner(&f->box, i), corner(&f->box, j));
    if (isfinite(f->radius)) r = fmin(r, hypot(f->center[i], f->center[j]) + f->radius);
    return r;
}

/* ---- derived arguments ---- */

static void unit_vector(sdfc *c, const sdfc_shape *s, int *v, const char *what) {
    double u[3];
    for (int i = 0; i < 3; i++) {
        if (!sdfc_constant(c, v[i])) {
            sdfc_fail(c, s->token, "%s: expected %s known at compile time",
                      sdfc_kind_names[s->kind], what);
        }
        u[i] = c->exprs[v[i]].value;
    }
    double length = norm3(u);
    if (!(length > 1e-12)) {
        sdfc_fail(c, s->token, "%s: expected %s that is not zero", sdfc_kind_names[s->kind], what);
    }
    for (int i = 0; i < 3; i++) v[i] = number(c, u[i] / length);
}

/* Rows of the inverse rotation: a turn by -angle. */
static void axis_matrix(sdfc *c, sdfc_shape *s) {
    int *n = s->number, m[9];
    unit_vector(c, s, n, "an axis");
    int cosine = apply1(c, SDFC_cos, n[3]), sine = apply1(c, SDFC_sin, n[3]);
    int rest = apply2(c, SDFC_sub, number(c, 1), cosine);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int e = apply2(c, SDFC_mul, apply2(c, SDFC_mul, n[i], n[j]), rest);
            if (i == j) {
                e = apply2(c, SDFC_add, e, cosine);
            } else {
                int k = 3 - i - j;
                bool cyclic = (i + 1) % 3 == j;
                e = apply2(c, cyclic ? SDFC_add : SDFC_sub, e, apply2(c, SDFC_mul, n[k], sine));
            }
            m[3 * i + j] = e;
        }
    }
    memcpy(n, m, sizeof m);
}

/* The inverse of turns about the fixed axes x, then y, then z. */
static void euler_matrix(sdfc *c, sdfc_shape *s) {
    int *n = s->number, m[9];
    int cs[3], sn[3], zero = number(c, 0), one = number(c, 1);
    for (int i = 0; i < 3; i++) {
        cs[i] = apply1(c, SDFC_cos, n[i]);
        sn[i] = apply1(c, SDFC_sin, n[i]);
    }
    for (int i = 0; i < 9; i++) m[i] = i % 4 == 0 ? one : zero;
    /* (Rz Ry Rx)^-1 = Rx^-1 Ry^-1 Rz^-1: multiply from the left by z, y, x */
    for (int axis = 2; axis >= 0; axis--) {
        int a = (axis + 1) % 3, b = (axis + 2) % 3, old[9];
        memcpy(old, m, sizeof old);
        for (int j = 0; j < 3; j++) {
            m[3 * a + j] = apply2(c, SDFC_add, apply2(c, SDFC_mul, cs[axis], old[3 * a + j]),
                                  apply2(c, SDFC_mul, sn[axis], old[3 * b + j]));
            m[3 * b + j] = apply2(c, SDFC_sub, apply2(c, SDFC_mul, cs[axis], old[3 * b + j]),
                                  apply2(c, SDFC_mul, sn[axis], old[3 * a + j]));
        }
    }
    memcpy(n, m, sizeof m);
}

static void rotate_facts(sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    bool constant = true;
    for (int i = 0; i < 9; i++) constant = constant && sdfc_constant(c, s->number[i]);
    unsigned kept = 0; /* a turn about y keeps the mirror in y */
    for (int i = 0; i < 3; i++) {
        if (sdfc_is(c, s->number[4 * i], 1)) kept |= 1u << i;
    }
    f->symmetric &= kept;
    if (!constant) {
        f->radius += norm3(f->center);
        memset(f->center, 0, sizeof f->center);
        if (isfinite(f->radius))
            box_of_sphere(f);
        else
            f->box = EVERYWHERE;
        return;
    }
    sdfc_box b = f->box;
    double center[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = f->box.high[i] = 0;
        for (int j = 0; j < 3; j++) { /* the matrix is the inverse: its transpose turns forward */
            double m = c->exprs[s->number[3 * j + i]].value;
            center[i] += m * f->center[j];
            if (m == 0) continue;
            f->box.low[i] += m * (m > 0 ? b.low[j] : b.high[j]);
            f->box.high[i] += m * (m > 0 ? b.high[j] : b.low[j]);
        }
        if (!(f->box.low[i] <= f->box.high[i])) {
            f->box.low[i] = -SDFC_INFINITY;
            f->box.high[i] = SDFC_INFINITY;
        }
    }
    memcpy(f->center, center, sizeof center);
    if (isfinite(f->radius) && !bounded(&f->box)) box_of_sphere(f);
}

/* ---- primitives ---- */

static sdfc_facts solid(double x, double y, double z, unsigned symmetric) {
    sdfc_facts f = {.lipschitz = 1,
                    .growth = 1,
                    .box = symmetric_box(x, y, z),
                    .symmetric = symmetric,
                    .truth = true,
                    .cost = 1,
                    .depth = 1,
                    .size = 1};
    sphere_of_box(&f);
    return f;
}

static sdfc_facts ball(sdfc_facts f, double radius) {
    f.radius = fmin(f.radius, radius);
    return f;
}

/* Lies in the plane of the mirror, or crosses it at a right angle with its middle. */
static bool capsule_mirrored(const sdfc *c, const int *n, int axis) {
    if (sdfc_is(c, n[axis], 0) && sdfc_is(c, n[3 + axis], 0)) return true;
    for (int i = 0; i < 3; i++) {
        if (!sdfc_constant(c, n[i]) || !sdfc_constant(c, n[3 + i])) return false;
        double a = c->exprs[n[i]].value, b = c->exprs[n[3 + i]].value;
        if (i == axis ? a != -b : a != b) return false;
    }
    return true;
}

static void capsule_arguments(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number, sum = 0, radius = n[6];
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = fmin(low(c, n[i]), low(c, n[3 + i])) - size_of(c, radius);
        f->box.high[i] = fmax(high(c, n[i]), high(c, n[3 + i])) + size_of(c, radius);
        if (capsule_mirrored(c, n, i)) f->symmetric |= 1u << i;
    }
    sphere_of_box(f);
    for (int i = 0; i < 3; i++) {
        n[3 + i] = apply2(c, SDFC_sub, n[3 + i], n[i]);
        int square = apply2(c, SDFC_mul, n[3 + i], n[3 + i]);
        sum = i ? apply2(c, SDFC_add, sum, square) : square;
    }
    n[7] = radius;
    n[6] = apply1(c, SDFC_rcp, sum);
}

static void ellipsoid_arguments(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    double least = SDFC_INFINITY, largest = 0;
    int least_e = apply2(c, SDFC_min, n[0], apply2(c, SDFC_min, n[1], n[2]));
    for (int i = 0; i < 3; i++) {
        if (!(low(c, n[i]) > 0)) sdfc_fail(c, s->token, "ellipsoid: expected radii above 0");
        least = fmin(least, low(c, n[i]));
        largest = fmax(largest, high(c, n[i]));
        n[i] = apply1(c, SDFC_rcp, n[i]);
    }
    n[3] = least_e;
    f->growth = least / largest;
    f->radius = largest;
    memset(f->center, 0, sizeof f->center);
}

static sdfc_facts user_facts(sdfc *c, const sdfc_shape *s) {
    sdfc_facts f = solid(0, 0, 0, 0);
    for (int i = 0; i < 3; i++) {
        f.box.low[i] = fmin(low(c, s->number[i]), low(c, s->number[3 + i]));
        f.box.high[i] = fmax(low(c, s->number[i]), low(c, s->number[3 + i]));
    }
    sphere_of_box(&f);
    f.lipschitz = f.growth = low(c, s->number[6]); /* lowering joins it with its box */
    f.user = true;
    f.truth = c->users[s->user].has_c;
    f.cost = 20;
    return f;
}

/* The escape-time estimate is no bound. Measured on 1e5 pairs of a point outside and one of the
 * surface, powers 2 to 16, 2 to 14 levels: divided by 2 it exceeds the distance for 1 of 10,000. */
#define MANDELBULB_LIPSCHITZ 2.0

static sdfc_facts mandelbulb_facts(sdfc *c, const sdfc_shape *s) {
    if (s->whole[0] < 2) sdfc_fail(c, s->token, "mandelbulb: expected a power from 2 to 16");
    double r = pow(2, 1.0 / (s->whole[0] - 1)); /* beyond it every point escapes */
    sdfc_facts f = ball(solid(r, r, r, 0), r);
    f.lipschitz = MANDELBULB_LIPSCHITZ;
    f.estimate = true;
    f.cost = 20.0 * s->whole[1];
    return f; /* lowering joins it with its ball: growth 1 */
}

static sdfc_facts primitive(sdfc *c, sdfc_shape *s) {
    int *n = s->number;
    double a = 0, b = 0, d = 0;
    if (s->kind != SDFC_KIND_MENGER && s->kind != SDFC_KIND_SIERPINSKI &&
        s->kind != SDFC_KIND_MANDELBULB && s->kind != SDFC_KIND_USER) {
        a = size_of(c, n[0]);
        b = size_of(c, n[1]);
        d = size_of(c, n[2]);
    }
    sdfc_facts f = solid(a, b, d, 7); /* box, rounded box, frame, ellipsoid */
    switch (s->kind) {
    case SDFC_KIND_SPHERE: return ball(solid(a, a, a, 7), a);
    case SDFC_KIND_TORUS: return ball(solid(a + b, b, a + b, 7), a + b);
    case SDFC_KIND_CAPSULE:
        f.symmetric = 0;
        capsule_arguments(c, s, &f);
        return f;
    case SDFC_KIND_CYLINDER: return solid(b, a, b, 7);
    case SDFC_KIND_CONE: return solid(fmax(b, d), a, fmax(b, d), 5);
    case SDFC_KIND_PLANE:
        unit_vector(c, s, n, "a normal");
        f.box = EVERYWHERE;
        f.radius = SDFC_INFINITY;
        f.symmetric = 0;
        for (int i = 0; i < 3; i++) {
            if (sdfc_is(c, n[i], 0)) f.symmetric |= 1u << i;
        }
        return f;
    case SDFC_KIND_ELLIPSOID: ellipsoid_arguments(c, s, &f); return f;
    case SDFC_KIND_OCTAHEDRON: return ball(f = solid(a, a, a, 7), a);
    case SDFC_KIND_HEX_PRISM: return solid(a * 1.1547005383792517, b, a * 1.0000001, 7);
    case SDFC_KIND_TRI_PRISM: {
        f = solid(a, b, a * 1.1547005383792517, 3);
        f.box.low[2] = -a * 0.57735026918962584;
        f.radius = hypot(a * 1.1547005383792517, b); /* about the middle */
        return f;
    }
    case SDFC_KIND_LINK: return solid(b + d, a + b + d, d, 7);
    case SDFC_KIND_MENGER:
        f = solid(1, 1, 1, 7);
        f.cost = 3.0 * s->whole[0];
        return f;
    case SDFC_KIND_SIERPINSKI:
        f = solid(1, 1, 1, 0);
        f.cost = 3.0 * s->whole[0];
        return f;
    case SDFC_KIND_MANDELBULB: return mandelbulb_facts(c, s);
    case SDFC_KIND_USER: return user_facts(c, s);
    default: return f;
    }
}

/* ---- joining ---- */

/* Fields of different constants are divided by them before a hard union, so that one stiff shape
 * does not slow the others. Not before a blend: that would change its form. */
static bool levelled(const sdfc *c, const sdfc_shape *s) {
    if (s->kind != SDFC_KIND_UNION && s->kind != SDFC_KIND_INTERSECTION &&
        s->kind != SDFC_KIND_DIFFERENCE) {
        return false;
    }
    for (int i = 1; i < s->children; i++) {
        if (c->shapes[s->child[i]].facts.lipschitz != c->shapes[s->child[0]].facts.lipschitz) {
            return true;
        }
    }
    return false;
}

static sdfc_facts joined(sdfc *c, sdfc_shape *s) {
    bool level = levelled(c, s);
    bool is_union = s->kind == SDFC_KIND_UNION || s->kind == SDFC_KIND_SMOOTH_UNION;
    bool is_cut = s->kind == SDFC_KIND_DIFFERENCE || s->kind == SDFC_KIND_SMOOTH_DIFFERENCE;
    sdfc_facts f = {0};
    int boxes = 0;
    s->extra[0] = level;
    for (int i = 0; i < s->children; i++) {
        sdfc_facts g = c->shapes[s->child[i]].facts;
        if (level) {
            g.growth /= g.lipschitz;
            g.lipschitz = 1;
        }
        if (i == 0) {
            f = g;
            boxes = bounded(&g.box);
            continue;
        }
        f.lipschitz = fmax(f.lipschitz, g.lipschitz);
        f.symmetric &= g.symmetric;
        if (is_union) {
            join(&f, &g);
            f.growth = fmin(f.growth, g.growth);
        } else if (!is_cut) {
            if (g.radius < f.radius) {
                f.radius = g.radius;
                memcpy(f.center, g.center, sizeof f.center);
            }
            for (int k = 0; k < 3; k++) {
                double from = fmax(f.box.low[k], g.box.low[k]);
                double to = fmin(f.box.high[k], g.box.high[k]);
                f.box.low[k] = fmin(from, to);
                f.box.high[k] = fmax(from, to);
            }
            f.growth = fmin(f.growth, g.growth);
            boxes += bounded(&g.box);
        }
    }
    /* outside several boxes at once, one of the distances is 1 / sqrt(n) of the whole */
    if (!is_union && !is_cut && boxes > 1) f.growth /= sqrt(fmin(boxes, 3));
    if (s->kind == SDFC_KIND_SMOOTH_UNION) {
        widen(&f, (s->children - 1) * 0.25 * size_of(c, s->number[0]) / f.growth);
    }
    if (s->kind == SDFC_KIND_SMOOTH_UNION || s->kind == SDFC_KIND_SMOOTH_INTERSECTION ||
        s->kind == SDFC_KIND_SMOOTH_DIFFERENCE) {
        s->number[1] = apply1(c, SDFC_rcp, s->number[0]);
    }
    return f;
}

/* ---- moving ---- */

static void translate_facts(sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    double half[3];
    for (int i = 0; i < 3; i++) {
        int e = s->number[i];
        f->box.low[i] += low(c, e);
        f->box.high[i] += high(c, e);
        if (!sdfc_is(c, e, 0)) f->symmetric &= ~(1u << i);
        half[i] = (high(c, e) - low(c, e)) / 2;
        if (isfinite(half[i]))
            f->center[i] += low(c, e) + half[i];
        else
            f->radius = SDFC_INFINITY;
    }
    if (isfinite(f->radius)) f->radius += norm3(half);
}

static void scale_arguments(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    bool uniform = n[0] == n[1] && n[1] == n[2];
    double least = SDFC_INFINITY, largest = 0;
    for (int i = 0; i < 3; i++) {
        if (sdfc_is(c, n[i], 0)) sdfc_fail(c, s->token, "scale: expected a factor other than 0");
        if (!uniform && !(low(c, n[i]) > 0)) {
            sdfc_fail(c, s->token, "scale: expected three factors above 0");
        }
        double from = fmin(f->box.low[i] * low(c, n[i]), f->box.low[i] * high(c, n[i]));
        double to = fmax(f->box.high[i] * low(c, n[i]), f->box.high[i] * high(c, n[i]));
        if (low(c, n[i]) < 0) {
            double r = corner(&f->box, i) * most(c, n[i]);
            from = -r;
            to = r;
        }
        f->box.low[i] = from == from ? from : -SDFC_INFINITY;
        f->box.high[i] = to == to ? to : SDFC_INFINITY;
        least = fmin(least, low(c, n[i]));
        largest = fmax(largest, most(c, n[i]));
        /* the centre: of the interval of factors; the rest of it goes to the radius */
    }
    double moved = 0;
    for (int i = 0; i < 3; i++) {
        double a = f->center[i] * low(c, n[i]), b = f->center[i] * high(c, n[i]);
        moved += (b - a) * (b - a) / 4;
        f->center[i] = (a + b) / 2;
    }
    f->radius = f->radius * largest + sqrt(moved);
    if (!isfinite(f->radius)) f->radius = SDFC_INFINITY;
    if (!uniform) f->growth *= least / largest;
    s->extra[0] = !(low(c, n[0]) > 1e-30); /* uniform and possibly 0 */
    int k = n[0];
    if (!uniform) k = apply2(c, SDFC_min, n[0], apply2(c, SDFC_min, n[1], n[2]));
    if (low(c, k) < 0) k = apply1(c, SDFC_abs, k);
    for (int i = 0; i < 3; i++) n[i] = i && uniform ? n[0] : apply1(c, SDFC_rcp, n[i]);
    n[3] = k;
}

static void mirror_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    unit_vector(c, s, n, "a normal");
    double u[3], center[3];
    unsigned kept = f->symmetric;
    sdfc_facts g = *f;
    for (int i = 0; i < 3; i++) u[i] = c->exprs[n[i]].value;
    for (int i = 0; i < 3; i++) {
        double from = 0, to = 0;
        center[i] = 0;
        for (int j = 0; j < 3; j++) {
            double m = (i == j) - 2 * u[i] * u[j];
            center[i] += m * f->center[j];
            if (m == 0) continue;
            from += m * (m > 0 ? f->box.low[j] : f->box.high[j]);
            to += m * (m > 0 ? f->box.high[j] : f->box.low[j]);
        }
        g.box.low[i] = from <= to ? from : -SDFC_INFINITY;
        g.box.high[i] = from <= to ? to : SDFC_INFINITY;
        if (u[i] != 0 && fabs(u[i]) != 1) kept = 0;
        if (fabs(u[i]) == 1) kept |= 1u << i;
    }
    memcpy(g.center, center, sizeof center);
    join(f, &g);
    f->symmetric = kept;
}

/* ---- repeating ---- */

static void keep_box(sdfc_shape *s, const sdfc_box *b) {
    for (int i = 0; i < 3; i++) {
        bool ends = isfinite(b->low[i]) && isfinite(b->high[i]);
        s->extra[4 + i] = ends ? (b->low[i] + b->high[i]) / 2 : 0;
        s->extra[7 + i] = ends ? (b->high[i] - b->low[i]) / 2 : 1e30;
    }
}

/* extra: 0-2 what is done on each axis: 0 nothing, 1 a fold (the shape is its own mirror image, so
 * the nearest cell is enough), 2 the own cell and its nearer neighbour; 3 the least that the cells
 * not looked at can say; 4-9 the box of the shape in its cell; 10: the shape must be joined with it
 * so that the former is true. */
static void repeat_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    bool limited = s->kind == SDFC_KIND_REPEAT_LIMITED;
    sdfc_box cell = f->box;
    double rest = SDFC_INFINITY, times = 1;
    for (int i = 0; i < 3; i++) {
        s->extra[i] = 0;
        if (sdfc_is(c, n[i], 0) || (limited && s->whole[i] == 1)) {
            n[i] = number(c, 0);
            n[3 + i] = n[i];
            continue;
        }
        double period = low(c, n[i]);
        if (!(period > 0) || !isfinite(high(c, n[i]))) {
            sdfc_fail(c, s->token, "%s: expected periods above 0, or 0 for none",
                      sdfc_kind_names[s->kind]);
        }
        bool mirrored = f->symmetric >> i & 1;
        double h = corner(&f->box, i);
        if (!mirrored && !(h <= period / 2 * (1 + 1e-9))) {
            sdfc_fail(c, s->token,
                      "%s: expected a shape within its cell (or symmetric in it): it reaches %g "
                      "from the middle along %c, the cell %g",
                      sdfc_kind_names[s->kind], h, 'x' + i, period / 2);
        }
        s->extra[i] = mirrored ? 1 : 2;
        if (!mirrored) {
            rest = fmin(rest, period - h);
            times *= 2;
            f->cost *= 2;
            f->symmetric &= ~(1u << i);
        }
        double far = limited ? high(c, n[i]) * 0.5 * (s->whole[i] - 1) : SDFC_INFINITY;
        f->box.low[i] -= far;
        f->box.high[i] += far;
        n[3 + i] = apply1(c, SDFC_rcp, n[i]);
    }
    sphere_of_box(f);
    s->extra[3] = rest * f->lipschitz;
    s->extra[10] = times > 1 && f->growth < f->lipschitz;
    keep_box(s, &cell);
    if (times > 1) f->growth = f->lipschitz;
}

/* extra: 0: 0 nothing, 1 a fold, 2 two sectors, 3 two that are not all; 1 2 cosine and sine of
 * half a sector; 4-10 as above, with the wedge of the sector */
static void polar_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int count = s->whole[0];
    const double pi = 3.14159265358979323846;
    double half = pi / count;
    keep_box(s, &f->box);
    s->extra[1] = cos(half);
    s->extra[2] = sin(half);
    s->extra[0] = count == 1 ? 0 : f->symmetric & 4 ? 1 : count == 2 ? 2 : 3;
    if (s->extra[0] == 3) {
        double widest = corner(&f->box, 2);
        bool box_fits = f->box.low[0] >= 0 && widest * cos(half) <= f->box.low[0] * sin(half);
        double side = fabs(f->center[2]) * cos(half) - f->center[0] * sin(half) + f->radius;
        if (!box_fits && !(side <= 1e-9)) {
            sdfc_fail(c, s->token,
                      "polar: expected a shape within its sector of %g degrees around +x, or "
                      "symmetric in z",
                      360.0 / count);
        }
        s->extra[10] = f->growth < f->lipschitz || !box_fits;
        f->growth = f->lipschitz;
        sphere_of_box(f); /* it is the box that the shape is joined with */
    }
    if (s->extra[0] >= 2) f->cost *= 2;
    if (count > 1) {
        double r = reach(f, 0, 2);
        f->radius += hypot(f->center[0], f->center[2]);
        f->center[0] = f->center[2] = 0;
        f->box.low[0] = f->box.low[2] = -r;
        f->box.high[0] = f->box.high[2] = r;
        f->symmetric &= 2;
        if (s->extra[0] == 3) sphere_of_box(f);
    }
}

/* ---- bending ---- */

/* Around an axis the map is a shear that grows with the distance, so the constant holds near the
 * shape only. Further out than `margin` the distance to the cylinder around the shape takes over:
 * max(cylinder, min(field / constant, margin)). extra: 0 constant, 1 margin, 2 radius, 3 4 middle
 * and half length of the cylinder */
static void bend_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int a = 0, b = s->kind == SDFC_KIND_TWIST ? 2 : 1, axis = 3 - a - b;
    double radius = reach(f, a, b), k = most(c, s->number[0]);
    if (!isfinite(radius) || !isfinite(k)) {
        sdfc_fail(c, s->token, "%s: expected a shape with an end, and a rate with limits",
                  sdfc_kind_names[s->kind]);
    }
    double margin = fmax(radius * 0.25, 1e-3), shear = k * (radius + margin);
    double stretch = s->kind == SDFC_KIND_TWIST ? (shear + sqrt(shear * shear + 4)) / 2 : 1 + shear;
    f->lipschitz *= stretch * (1 + 1e-12);
    f->growth = f->lipschitz;
    f->symmetric = 0;
    f->box.low[a] = f->box.low[b] = -radius;
    f->box.high[a] = f->box.high[b] = radius;
    bool ends = isfinite(f->box.low[axis]) && isfinite(f->box.high[axis]);
    s->extra[0] = f->lipschitz;
    s->extra[1] = margin * f->lipschitz;
    s->extra[2] = radius;
    s->extra[3] = ends ? (f->box.low[axis] + f->box.high[axis]) / 2 : 0;
    s->extra[4] = ends ? (f->box.high[axis] - f->box.low[axis]) / 2 : 1e30;
    sphere_of_box(f);
}

static void kaleidoscope_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number, levels = s->whole[0];
    double k = c->exprs[n[0]].value;
    if (!sdfc_constant(c, n[0]) || !(k > 1 && k <= 16)) {
        sdfc_fail(c, s->token,
                  "kaleidoscope: expected a factor above 1, at most 16, known at "
                  "compile time");
    }
    double shift[3] = {most(c, n[1]), most(c, n[2]), most(c, n[3])};
    double size = pow(k, -levels);
    double r = fmin(norm3((double[3]){corner(&f->box, 0), corner(&f->box, 1), corner(&f->box, 2)}),
                    norm3(f->center) + f->radius);
    r = r * size + norm3(shift) * (1 - size);
    if (!isfinite(r)) r = SDFC_INFINITY;
    for (int i = 1; i < 4; i++) n[i] = apply2(c, SDFC_mul, n[i], number(c, k - 1));
    n[4] = number(c, size);
    f->box = symmetric_box(r, r, r);
    f->radius = r;
    memset(f->center, 0, sizeof f->center);
    f->symmetric = 7;
    f->cost += 8.0 * levels;
}

/* ---- all of them ---- */

static sdfc_facts changed(sdfc *c, sdfc_shape *s) {
    sdfc_facts f = c->shapes[s->child[0]].facts;
    int *n = s->number;
    switch (s->kind) {
    case SDFC_KIND_TRANSLATE: translate_facts(c, s, &f); break;
    case SDFC_KIND_ROTATE:
        axis_matrix(c, s);
        rotate_facts(c, s, &f);
        break;
    case SDFC_KIND_ROTATE_EULER:
        euler_matrix(c, s);
        rotate_facts(c, s, &f);
        break;
    case SDFC_KIND_SCALE: scale_arguments(c, s, &f); break;
    case SDFC_KIND_MIRROR: mirror_facts(c, s, &f); break;
    case SDFC_KIND_REPEAT:
    case SDFC_KIND_REPEAT_LIMITED: repeat_facts(c, s, &f); break;
    case SDFC_KIND_POLAR: polar_facts(c, s, &f); break;
    case SDFC_KIND_TWIST:
    case SDFC_KIND_BEND: bend_facts(c, s, &f); break;
    case SDFC_KIND_ELONGATE: {
        double by[3];
        for (int i = 0; i < 3; i++) {
            if (low(c, n[i]) < 0) sdfc_fail(c, s->token, "elongate: expected lengths from 0");
            by[i] = high(c, n[i]);
            f.box.low[i] -= by[i];
            f.box.high[i] += by[i];
        }
        f.radius += norm3(by);
        break;
    }
    case SDFC_KIND_ONION:
    case SDFC_KIND_ROUND: widen(&f, size_of(c, n[0]) / f.growth); break;
    case SDFC_KIND_DISPLACE: {
        double a = most(c, n[0]), k = fmax(most(c, n[1]), fmax(most(c, n[2]), most(c, n[3])));
        f.lipschitz += a * k;
        f.symmetric = 0;
        widen(&f, a / f.growth);
        break;
    }
    case SDFC_KIND_DISPLACE_NOISE: {
        double a = most(c, n[0]), k = most(c, n[1]);
        f.lipschitz += a * k * 3.4641016151377549;
        f.symmetric = 0;
        f.cost += 8;
        widen(&f, a / f.growth);
        break;
    }
    case SDFC_KIND_MORPH: {
        const sdfc_facts *g = &c->shapes[s->child[1]].facts;
        f.lipschitz = fmax(f.lipschitz, g->lipschitz);
        f.growth = fmin(f.growth, g->growth);
        f.symmetric &= g->symmetric;
        join(&f, g);
        n[0] = apply2(c, SDFC_min, apply2(c, SDFC_max, n[0], number(c, 0)), number(c, 1));
        break;
    }
    case SDFC_KIND_KALEIDOSCOPE: kaleidoscope_facts(c, s, &f); break;
    default: break;
    }
    return f;
}

void sdfc_analyse(sdfc *c, int shape) {
    sdfc_shape s = c->shapes[shape];
    sdfc_facts f;
    if (s.children == 0) {
        f = primitive(c, &s);
    } else {
        f = s.kind >= SDFC_KIND_UNION && s.kind <= SDFC_KIND_SMOOTH_DIFFERENCE ? joined(c, &s)
                                                                               : changed(c, &s);
        double cost = f.cost + 1;
        int depth = 0, size = 1;
        bool user = false, truth = true, estimate = false;
        for (int i = 0; i < s.children; i++) {
            const sdfc_facts *g = &c->shapes[s.child[i]].facts;
            if (i) cost += g->cost;
            depth = depth < g->depth ? g->depth : depth;
            size = size < SDFC_TREE_MAX && g->size <= SDFC_TREE_MAX ? size + g->size
                                                                    : SDFC_TREE_MAX + 1;
            user = user || g->user;
            estimate = estimate || g->estimate;
            truth = truth && g->truth;
        }
        f.cost = cost;
        f.depth = depth + 1;
        f.size = size;
        f.user = user;
        f.estimate = estimate;
        f.truth = truth;
    }
    tighten(&f);
    if (f.depth > MASU_SDFC_DEPTH_MAX) {
        sdfc_fail(c, s.token, "expected at most %d levels of nesting", MASU_SDFC_DEPTH_MAX);
    }
    if (!(f.lipschitz < 1e12) || !(f.growth > 1e-12)) {
        sdfc_fail(c, s.token, "%s: expected a field with a Lipschitz constant below 1e12",
                  sdfc_kind_names[s.kind]);
    }
    for (int i = 0; i < 3; i++) { /* beyond what fp32 can square */
        if (!(f.box.low[i] >= -1e15)) f.box.low[i] = -SDFC_INFINITY;
        if (!(f.box.high[i] <= 1e15)) f.box.high[i] = SDFC_INFINITY;
        if (!isfinite(f.center[i])) f.radius = SDFC_INFINITY;
    }
    if (!(f.radius <= 1e15)) f.radius = SDFC_INFINITY;
    s.facts = f;
    c->shapes[shape] = s;
}
