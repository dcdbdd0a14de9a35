/* analyse_operator.c: the facts of shapes made of others; see analyse.c. */
#include "sdfc/facts.h"

#include <limits.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- turning ---- */

/* Rows of the inverse rotation: by -angle. */
static void axis_matrix(sdfc *c, sdfc_shape *s) {
    int *n = s->number, m[9];
    sdfc_unit_vector(c, s, n, "an axis");
    int cosine = sdfc_apply1(c, SDFC_cos, n[3]), sine = sdfc_apply1(c, SDFC_sin, n[3]);
    int rest = sdfc_apply2(c, SDFC_sub, sdfc_number(c, 1), cosine);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int e = sdfc_apply2(c, SDFC_mul, sdfc_apply2(c, SDFC_mul, n[i], n[j]), rest);
            if (i == j) {
                e = sdfc_apply2(c, SDFC_add, e, cosine);
            } else {
                int k = 3 - i - j;
                bool cyclic = (i + 1) % 3 == j;
                e = sdfc_apply2(c, cyclic ? SDFC_add : SDFC_sub, e,
                                sdfc_apply2(c, SDFC_mul, n[k], sine));
            }
            m[3 * i + j] = e;
        }
    }
    memcpy(n, m, sizeof m);
}

/* The inverse of rotations about the fixed axes x, then y, then z. */
static void euler_matrix(sdfc *c, sdfc_shape *s) {
    int *n = s->number, m[9];
    int cs[3], sn[3], zero = sdfc_number(c, 0), one = sdfc_number(c, 1);
    for (int i = 0; i < 3; i++) {
        cs[i] = sdfc_apply1(c, SDFC_cos, n[i]);
        sn[i] = sdfc_apply1(c, SDFC_sin, n[i]);
    }
    for (int i = 0; i < 9; i++) m[i] = i % 4 == 0 ? one : zero;
    /* (Rz Ry Rx)^-1 = Rx^-1 Ry^-1 Rz^-1: multiply from the left by z, y, x */
    for (int axis = 2; axis >= 0; axis--) {
        int a = (axis + 1) % 3, b = (axis + 2) % 3, old[9];
        memcpy(old, m, sizeof old);
        for (int j = 0; j < 3; j++) {
            m[3 * a + j] =
                sdfc_apply2(c, SDFC_add, sdfc_apply2(c, SDFC_mul, cs[axis], old[3 * a + j]),
                            sdfc_apply2(c, SDFC_mul, sn[axis], old[3 * b + j]));
            m[3 * b + j] =
                sdfc_apply2(c, SDFC_sub, sdfc_apply2(c, SDFC_mul, cs[axis], old[3 * b + j]),
                            sdfc_apply2(c, SDFC_mul, sn[axis], old[3 * a + j]));
        }
    }
    memcpy(n, m, sizeof m);
}

static void rotate_facts(sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    bool constant = true;
    for (int i = 0; i < 9; i++) constant = constant && sdfc_constant(c, s->number[i]);
    unsigned kept = 0; /* a rotation about y keeps the mirror symmetry in y */
    for (int i = 0; i < 3; i++) {
        if (sdfc_is(c, s->number[4 * i], 1)) kept |= 1u << i;
    }
    f->symmetric &= kept;
    if (!constant) {
        f->radius += sdfc_norm3(f->center);
        memset(f->center, 0, sizeof f->center);
        if (isfinite(f->radius))
            sdfc_box_of_sphere(f);
        else
            f->box = SDFC_EVERYWHERE;
        return;
    }
    sdfc_box b = f->box;
    double center[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = f->box.high[i] = 0;
        for (int j = 0; j < 3; j++) { /* the matrix is the inverse, so its transpose is the forward
                                       * rotation */
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
    if (isfinite(f->radius) && !sdfc_bounded(&f->box)) sdfc_box_of_sphere(f);
}

/* ---- moving ---- */

static void translate_facts(sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    double half[3];
    for (int i = 0; i < 3; i++) {
        int e = s->number[i];
        f->box.low[i] += sdfc_low(c, e);
        f->box.high[i] += sdfc_high(c, e);
        if (!sdfc_is(c, e, 0)) f->symmetric &= ~(1u << i);
        half[i] = (sdfc_high(c, e) - sdfc_low(c, e)) / 2;
        if (isfinite(half[i]))
            f->center[i] += sdfc_low(c, e) + half[i];
        else
            f->radius = SDFC_INFINITY;
    }
    if (isfinite(f->radius)) f->radius += sdfc_norm3(half);
}

static void scale_arguments(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    bool uniform = n[0] == n[1] && n[1] == n[2];
    double least = SDFC_INFINITY, largest = 0;
    for (int i = 0; i < 3; i++) {
        if (sdfc_is(c, n[i], 0)) sdfc_fail(c, s->token, "scale: expected a factor other than 0");
        if (!uniform && !(sdfc_low(c, n[i]) > 0)) {
            sdfc_fail(c, s->token, "scale: expected three factors above 0");
        }
        double from = fmin(f->box.low[i] * sdfc_low(c, n[i]), f->box.low[i] * sdfc_high(c, n[i]));
        double to = fmax(f->box.high[i] * sdfc_low(c, n[i]), f->box.high[i] * sdfc_high(c, n[i]));
        if (sdfc_low(c, n[i]) < 0) {
            double r = sdfc_corner(&f->box, i) * sdfc_most(c, n[i]);
            from = -r;
            to = r;
        }
        f->box.low[i] = from == from ? from : -SDFC_INFINITY;
        f->box.high[i] = to == to ? to : SDFC_INFINITY;
        least = fmin(least, sdfc_low(c, n[i]));
        largest = fmax(largest, sdfc_most(c, n[i]));
        /* the centre: with the centre of the interval of factors; its half width is added to the
         * radius */
    }
    double moved = 0;
    for (int i = 0; i < 3; i++) {
        double a = f->center[i] * sdfc_low(c, n[i]), b = f->center[i] * sdfc_high(c, n[i]);
        moved += (b - a) * (b - a) / 4;
        f->center[i] = (a + b) / 2;
    }
    f->radius = f->radius * largest + sqrt(moved);
    if (!isfinite(f->radius)) f->radius = SDFC_INFINITY;
    if (!uniform) f->growth *= least / largest;
    s->extra[0] = !(sdfc_low(c, n[0]) > 1e-30); /* uniform and possibly 0 */
    int k = n[0];
    if (!uniform) k = sdfc_apply2(c, SDFC_min, n[0], sdfc_apply2(c, SDFC_min, n[1], n[2]));
    if (sdfc_low(c, k) < 0) k = sdfc_apply1(c, SDFC_abs, k);
    for (int i = 0; i < 3; i++) n[i] = i && uniform ? n[0] : sdfc_apply1(c, SDFC_rcp, n[i]);
    n[3] = k;
}

static void mirror_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    sdfc_unit_vector(c, s, n, "a normal");
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
    sdfc_join(f, &g);
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

/* The number of copies in a row that are evaluated: those in the closest cells. `h` is the extent
 * of the shape from the centre of its cell.
 *
 * 1 is enough if the field is even and does not decrease with the distance from the centre: then
 * the closest copy has the lowest value. It is also enough for an even field within its cell. In
 * general, the copies in the m closest cells contain the whole solid if h <= m / 2 periods, because
 * the centre of any other cell is at least that far. The field of these copies:
 *
 *   even       continuous: where the selection switches copies, both have the same value. With the
 *              shape's constant, and zero at the surface, it never exceeds L times the distance.
 *   otherwise  the minimum with L (m / 2 periods - h), the lower bound of the other copies, if the
 *              shape's field is at least L times the distance to its box. A step there is at most
 *              that long: hence GAP.
 *
 * If all copies of a row are evaluated, neither is needed. 0: not possible. */
#define GAP 0.2

static int cells_of(bool even, bool rising, double h, double period, int row) {
    double room = period * (1 + 1e-9);
    if (even && (rising || h <= room / 2)) return 1;
    for (int m = 2; m <= SDFC_CELLS_MAX; m *= 2) {
        if (row <= m || h <= (even ? m / 2 * room : (m / 2 - GAP) * room)) return m;
    }
    return 0;
}

/* extra: 0-2 number of cells evaluated on each axis, 0: it does not repeat; 3 the lower bound of
 * the cells that are not evaluated, INFINITY: no minimum with it is needed; 4-9 the shape's box in
 * its cell; 10: the shape must be joined with that box to make the bound valid; 11 as 3, for the
 * selection of terms. */
static void repeat_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    bool limited = s->kind == SDFC_KIND_REPEAT_LIMITED;
    sdfc_box cell = f->box;
    double rest = SDFC_INFINITY, others = SDFC_INFINITY;
    for (int i = 0; i < 3; i++) {
        s->extra[i] = 0;
        if (sdfc_is(c, n[i], 0) || (limited && s->whole[i] == 1)) {
            n[i] = sdfc_number(c, 0);
            n[3 + i] = n[i];
            continue;
        }
        double period = sdfc_low(c, n[i]);
        if (!(period > 0) || !isfinite(sdfc_high(c, n[i]))) {
            sdfc_fail(c, s->token, "%s: expected periods above 0, or 0 for none",
                      sdfc_kinds[s->kind].name);
        }
        bool even = (f->symmetric >> i & 1) && !s->cell; /* else cells may differ */
        double h = sdfc_corner(&f->box, i);
        int row = limited ? s->whole[i] : INT_MAX;
        int cells = cells_of(even, f->rising >> i & 1, h, period, row);
        if (!cells) {
            double most = (SDFC_CELLS_MAX / 2 - (even ? 0 : GAP)) * period;
            sdfc_fail(c, s->token,
                      "%s: the shape reaches %g from the centre of its cell along %c: expected at "
                      "most %g, "
                      "%g times the period",
                      sdfc_kinds[s->kind].name, h, 'x' + i, most, most / period);
        }
        s->extra[i] = cells;
        f->cost *= cells;
        f->rising &= ~(1u << i);
        if (cells > 1 && cells < row) {
            others = fmin(others, cells / 2 * period - h);
            if (!even) rest = fmin(rest, cells / 2 * period - h);
        }
        if (!even) f->symmetric &= ~(1u << i);
        double far = limited ? sdfc_high(c, n[i]) * 0.5 * (s->whole[i] - 1) : SDFC_INFINITY;
        f->box.low[i] -= far;
        f->box.high[i] += far;
        n[3 + i] = sdfc_apply1(c, SDFC_rcp, n[i]);
    }
    sdfc_sphere_of_box(f);
    bool capped = isfinite(rest);
    s->extra[3] = rest * f->lipschitz;
    s->extra[10] = capped && f->growth < f->lipschitz;
    keep_box(s, &cell);
    if (capped) f->growth = f->lipschitz;
    s->extra[11] = fmin(others * f->growth, 1e30);
}

/* The half-angle around +x of the wedge that has its edge on the y axis and contains these bounds;
 * pi: they contain points on -x. */
static double angle_of_box(const sdfc_box *b) {
    double most = 0;
    if (b->low[2] <= 0 && b->high[2] >= 0 && b->low[0] <= 0) return PI;
    for (int i = 0; i < 4; i++) {
        double x = i & 1 ? b->high[0] : b->low[0], z = i & 2 ? b->high[2] : b->low[2];
        most = fmax(most, fabs(atan2(z, x)));
    }
    return most;
}

static double angle_of_sphere(const sdfc_facts *f) {
    double d = hypot(f->center[0], f->center[2]);
    if (!(f->radius < d)) return f->radius <= 0 ? 0 : PI;
    return fmin(fabs(atan2(f->center[2], f->center[0])) + asin(f->radius / d), PI);
}

static double angle_of(const sdfc_facts *f) {
    return fmin(angle_of_box(&f->box), angle_of_sphere(f));
}

/* Invariant under rotation about y. */
static bool is_round(const sdfc *c, int shape) {
    const sdfc_shape *s = &c->shapes[shape];
    switch (s->kind) {
    case SDFC_KIND_SPHERE:
    case SDFC_KIND_TORUS:
    case SDFC_KIND_CYLINDER:
    case SDFC_KIND_ROUNDED_CYLINDER:
    case SDFC_KIND_SOLID_ANGLE:
    case SDFC_KIND_CUT_SPHERE:
    case SDFC_KIND_CONE: return true;
    case SDFC_KIND_PLANE:
    case SDFC_KIND_TRANSLATE:
        if (!sdfc_is(c, s->number[0], 0) || !sdfc_is(c, s->number[2], 0)) return false;
        break;
    case SDFC_KIND_UNION:
    case SDFC_KIND_INTERSECTION:
    case SDFC_KIND_DIFFERENCE:
    case SDFC_KIND_SMOOTH_UNION:
    case SDFC_KIND_SMOOTH_INTERSECTION:
    case SDFC_KIND_SMOOTH_DIFFERENCE:
    case SDFC_KIND_CHAMFER:
    case SDFC_KIND_STAIRS:
    case SDFC_KIND_XOR:
    case SDFC_KIND_BLEND:
    case SDFC_KIND_PAINT:
    case SDFC_KIND_ONION:
    case SDFC_KIND_ROUND: break;
    case SDFC_KIND_REVOLVE: return true;
    default: return false;
    }
    for (int i = 0; i < s->children; i++) {
        if (!is_round(c, s->child[i])) return false;
    }
    return true;
}

/* All copies of a sector's solid in the sector itself are the sector's own. */
static bool keeps_to_sector(const sdfc *c, int shape, double half) {
    const sdfc_shape *s = &c->shapes[shape];
    if (angle_of(&s->facts) <= half + 1e-9 || is_round(c, shape)) return true;
    if (s->kind != SDFC_KIND_UNION) return false;
    for (int i = 0; i < s->children; i++) {
        if (!(c->shapes[s->child[i]].facts.symmetric & 4) || !keeps_to_sector(c, s->child[i], half))
            return false;
    }
    return true;
}

/* extra: 0: 0 nothing, 1 a fold, 2 two sectors, 3 two that are not all, 4 several copies, 5 several
 * after a fold; 1 2 cosine and sine of half a sector, or of the wedge that holds the shape; 3 the
 * sine of the angle from there to the nearest middle of a sector that is not evaluated; 4-10 as
 * above, with that wedge; 11 the number of copies
 *
 * After a fold into half a sector, the copies that can reach it are evaluated: the result is
 * continuous, with the constant of the shape, and never exceeds L times the distance. */
static void polar_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int count = s->whole[0];
    double half = PI / count, angle = angle_of(f), wedge = fmax(angle, half);
    bool even = (f->symmetric & 4) && !s->cell, fits = angle <= half + 1e-9;
    double copies = even ? fmin(count, ceil(angle / half - 1e-9)) : count;
    keep_box(s, &f->box);
    if (count == 1)
        s->extra[0] = 0;
    else if (even)
        s->extra[0] = keeps_to_sector(c, s->child[0], half) ? 1 : 5;
    else
        s->extra[0] = count == 2 ? 2 : fits || (count > 4 && angle <= 2 * (1 - GAP) * half) ? 3 : 4;
    if (s->extra[0] >= 4 && copies > SDFC_COPIES_MAX) {
        sdfc_fail(
            c, s->token,
            "polar: the shape covers %.4g degrees on either side of +x: expected at most %.4g",
            angle * 180 / PI, (even ? SDFC_COPIES_MAX : 2 * (1 - GAP)) * half * 180 / PI);
    }
    s->extra[1] = fits ? cos(half) : cos(wedge);
    s->extra[2] = fits ? sin(half) : sin(wedge);
    s->extra[3] = fits ? sin(half) : sin(fmin(2 * half - wedge, PI / 2));
    s->extra[11] = copies;
    if (s->extra[0] == 3) {
        bool box_fits = angle_of_box(&f->box) <= wedge + 1e-9;
        s->extra[10] = f->growth < f->lipschitz || !box_fits;
        f->growth = f->lipschitz;
        sdfc_sphere_of_box(f); /* the shape is joined with this box */
    }
    if (s->extra[0] >= 2) f->cost *= s->extra[0] >= 4 ? copies : 2;
    if (count > 1) {
        double r = sdfc_reach(f, 0, 2);
        f->radius += hypot(f->center[0], f->center[2]);
        f->center[0] = f->center[2] = 0;
        f->box.low[0] = f->box.low[2] = -r;
        f->box.high[0] = f->box.high[2] = r;
        f->symmetric &= 2;
        f->rising &= s->extra[0] == 3 ? 0 : 2;
        if (s->extra[0] == 3) sdfc_sphere_of_box(f);
    }
}

/* ---- bending ---- */

/* Around an axis a twist is a shear that grows with the distance, so the constant holds near the
 * shape only. Further out than `margin` the distance to the cylinder around the shape takes over:
 * max(cylinder, min(field / constant, margin)). extra: 0 constant, 1 margin, 2 radius, 3 4 middle
 * and half length of the cylinder */
static void twist_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int a = 0, b = 2, axis = 1;
    double radius = sdfc_reach(f, a, b), k = sdfc_most(c, s->number[0]);
    if (!isfinite(radius) || !isfinite(k)) {
        sdfc_fail(c, s->token, "twist: expected a bounded shape and a bounded rate");
    }
    double margin = fmax(radius * 0.25, 1e-3), shear = k * (radius + margin);
    double stretch = (shear + sqrt(shear * shear + 4)) / 2;
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
    sdfc_sphere_of_box(f);
}

/* The bounds of a curved box, x within +-x, curvature k. For a single k they follow from the
 * corners and the ends of the arc, for an interval from the length of the arc. */
static void bend_box(sdfc_box *b, double x, double low, double high) {
    double most = fmax(fabs(low), fabs(high)), thick = sdfc_corner(b, 1);
    double y[2] = {b->low[1], b->high[1]}, reach = x * (1 + most * thick);
    if (low < high || most < 1e-6) {
        b->low[1] -= low < 0 ? reach : 0;
        b->high[1] += high > 0 ? reach : 0;
    } else {
        double angle = most * x, sagitta = 2 * sin(angle / 2) * sin(angle / 2) / most;
        double inner = low > 0 ? y[1] : -y[0], outer = low > 0 ? y[0] : -y[1];
        double end = sagitta + cos(angle) * (cos(angle) > 0 ? inner : outer);
        reach = (1 / most - outer) * sin(fmin(angle, PI / 2));
        if (low > 0)
            b->high[1] = fmax(y[1], end);
        else
            b->low[1] = fmin(y[0], -end);
    }
    for (int i = 0; i < 2; i++) {
        double slack = 1e-9 * (reach + fabs(b->low[i]) + fabs(b->high[i]));
        if (i == 0) b->low[0] = -reach, b->high[0] = reach;
        b->low[i] -= slack;
        b->high[i] += slack;
    }
}

/* Along an arc of radius 1 / k. The stretch is 1 / (1 - k y), y across the arc, lowest at its inner
 * side. `outside` is the distance to the arc segment that the shape fills, plus the distance to its
 * box. Beyond `margin`, which can be small, it replaces the field: max(L outside, min(field, L (2
 * margin - outside))). extra: 0 L, 1 2 L margin, 2 3 centre and half thickness across, 4 5 along
 * z */
static void bend_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number;
    double x = sdfc_corner(&f->box, 0), low = sdfc_low(c, n[0]), high = sdfc_high(c, n[0]),
           most = sdfc_most(c, n[0]);
    if (!isfinite(sdfc_reach(f, 0, 1)) || !isfinite(most)) {
        sdfc_fail(c, s->token, "bend: expected a bounded shape and a bounded rate");
    }
    double y[2] = {f->box.low[1], f->box.high[1]};
    double inner = fmax(fmax(low * y[0], low * y[1]), fmax(high * y[0], high * y[1]));
    if (!(most * x <= 3.14)) {
        sdfc_fail(c, s->token,
                  "bend: x reaches %g, which the rate turns by %g: expected at most 3.14", x,
                  most * x);
    }
    if (!(inner <= 0.99)) {
        sdfc_fail(c, s->token,
                  "bend: y times the rate reaches %g: expected at most 0.99, inside the centre of "
                  "the arc",
                  inner);
    }
    double margin = fmin(0.25 * fmax(sdfc_reach(f, 0, 1), 1e-3),
                         1e-3 * (1 - fmax(inner, 0)) / fmax(most, 1e-9));
    f->lipschitz *= fmax(1, 1 / (1 - inner - most * margin)) * (1 + 1e-12);
    f->growth = f->lipschitz;
    f->symmetric = 0;
    bool ends = isfinite(f->box.low[2]) && isfinite(f->box.high[2]);
    s->extra[0] = f->lipschitz;
    s->extra[1] = 2 * margin * f->lipschitz;
    s->extra[2] = (y[0] + y[1]) / 2;
    s->extra[3] = (y[1] - y[0]) / 2;
    s->extra[4] = ends ? (f->box.low[2] + f->box.high[2]) / 2 : 0;
    s->extra[5] = ends ? (f->box.high[2] - f->box.low[2]) / 2 : 1e30;
    n[0] = sdfc_apply1(c, SDFC_nonzero, n[0]);
    int angle = sdfc_apply2(c, SDFC_mul, n[0], sdfc_number(c, x));
    n[1] = sdfc_apply1(c, SDFC_cos, angle);
    n[2] = sdfc_apply1(c, SDFC_sin, angle);
    n[3] = sdfc_apply2(c, SDFC_mul, n[2], sdfc_apply1(c, SDFC_rcp, n[0]));
    bend_box(&f->box, x, low, high);
    sdfc_sphere_of_box(f);
}

static void kaleidoscope_facts(sdfc *c, sdfc_shape *s, sdfc_facts *f) {
    int *n = s->number, levels = s->whole[0];
    double k = c->exprs[n[0]].value;
    if (!sdfc_constant(c, n[0]) || !(k > 1 && k <= 16)) {
        sdfc_fail(c, s->token,
                  "kaleidoscope: expected a factor above 1, at most 16, known at "
                  "compile time");
    }
    double shift[3] = {sdfc_most(c, n[1]), sdfc_most(c, n[2]), sdfc_most(c, n[3])};
    double size = pow(k, -levels);
    double r = fmin(sdfc_norm3((double[3]){sdfc_corner(&f->box, 0), sdfc_corner(&f->box, 1),
                                           sdfc_corner(&f->box, 2)}),
                    sdfc_norm3(f->center) + f->radius);
    r = r * size + sdfc_norm3(shift) * (1 - size);
    if (!isfinite(r)) r = SDFC_INFINITY;
    for (int i = 1; i < 4; i++) n[i] = sdfc_apply2(c, SDFC_mul, n[i], sdfc_number(c, k - 1));
    n[4] = sdfc_number(c, size);
    f->box = sdfc_symmetric_box(r, r, r);
    f->radius = r;
    memset(f->center, 0, sizeof f->center);
    f->symmetric = 7;
    f->rising = 0;
    f->cost += 8.0 * levels;
}

/* ---- all operators ---- */

static void elongate_facts(sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    double by[3];
    for (int i = 0; i < 3; i++) {
        int e = s->number[i];
        if (sdfc_low(c, e) < 0) sdfc_fail(c, s->token, "elongate: expected lengths from 0");
        by[i] = sdfc_high(c, e);
        f->box.low[i] -= by[i];
        f->box.high[i] += by[i];
    }
    f->radius += sdfc_norm3(by);
}

/* From the section at z = 0, which is the shape itself if it is flat. A section with a constant
 * below 1 would have caps that are too steep for its constant. */
static void extrude_facts(const sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    double h = sdfc_size_of(c, s->number[0]);
    f->box.low[2] = -h;
    f->box.high[2] = h;
    f->lipschitz = fmax(f->lipschitz, 1);
    f->growth = fmin(f->growth, 1);
    f->symmetric |= 4;
    f->rising |= 4;
    sdfc_sphere_of_box(f);
}

static void revolve_facts(const sdfc *c, const sdfc_shape *s, sdfc_facts *f) {
    double r = fmax(f->box.high[0] + sdfc_high(c, s->number[0]), 0);
    f->box.low[0] = f->box.low[2] = -r;
    f->box.high[0] = f->box.high[2] = r;
    f->symmetric = 5 | (f->symmetric & 2);
    f->rising &= 2;
    sdfc_sphere_of_box(f);
}

sdfc_facts sdfc_operator_facts(sdfc *c, sdfc_shape *s) {
    if (sdfc_is_join(s->kind)) return sdfc_joined_facts(c, s);
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
    case SDFC_KIND_TWIST: twist_facts(c, s, &f); break;
    case SDFC_KIND_BEND: bend_facts(c, s, &f); break;
    case SDFC_KIND_ELONGATE: elongate_facts(c, s, &f); break;
    case SDFC_KIND_EXTRUDE: extrude_facts(c, s, &f); break;
    case SDFC_KIND_REVOLVE: revolve_facts(c, s, &f); break;
    case SDFC_KIND_ONION: f.rising = 0; /* fallthrough */
    case SDFC_KIND_ROUND: sdfc_widen(&f, sdfc_size_of(c, n[0]) / f.growth); break;
    case SDFC_KIND_DISPLACE: {
        double a = sdfc_most(c, n[0]),
               k = fmax(sdfc_most(c, n[1]), fmax(sdfc_most(c, n[2]), sdfc_most(c, n[3])));
        f.lipschitz += a * k;
        f.symmetric = 0;
        sdfc_widen(&f, a / f.growth);
        break;
    }
    case SDFC_KIND_DISPLACE_NOISE: {
        double a = sdfc_most(c, n[0]), k = sdfc_most(c, n[1]);
        f.lipschitz += a * k * SDFC_NOISE_SLOPE;
        f.symmetric = 0;
        f.cost += 8;
        sdfc_widen(&f, a / f.growth);
        break;
    }
    case SDFC_KIND_MORPH: {
        const sdfc_facts *g = &c->shapes[s->child[1]].facts;
        f.lipschitz = fmax(f.lipschitz, g->lipschitz);
        f.growth = fmin(f.growth, g->growth);
        f.symmetric &= g->symmetric;
        f.rising &= g->rising;
        sdfc_join(&f, g);
        n[0] = sdfc_apply2(c, SDFC_min, sdfc_apply2(c, SDFC_max, n[0], sdfc_number(c, 0)),
                           sdfc_number(c, 1));
        break;
    }
    case SDFC_KIND_KALEIDOSCOPE: kaleidoscope_facts(c, s, &f); break;
    default: break;
    }
    return f;
}
