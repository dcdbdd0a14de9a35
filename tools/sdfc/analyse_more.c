/* analyse_more.c: the facts of the solids of library_shapes.inc and library_fractals.inc; see
 * analyse.c. */
#include "sdfc/facts.h"

#include <string.h>

#define PI 3.14159265358979323846

static sdfc_facts within(const double low[3], const double high[3], unsigned symmetric) {
    sdfc_facts f = sdfc_solid(0, 0, 0, symmetric);
    memcpy(f.box.low, low, sizeof f.box.low);
    memcpy(f.box.high, high, sizeof f.box.high);
    sdfc_sphere_of_box(&f);
    return f;
}

static sdfc_facts endless(unsigned symmetric) {
    sdfc_facts f = sdfc_solid(0, 0, 0, symmetric);
    f.box = SDFC_EVERYWHERE;
    f.radius = SDFC_INFINITY;
    return f;
}

static void need_above(sdfc *c, const sdfc_shape *s, int e, const char *what) {
    if (!(sdfc_low(c, e) > 0))
        sdfc_fail(c, s->token, "%s: expected %s above 0", sdfc_kinds[s->kind].name, what);
}

static void need_angle(sdfc *c, const sdfc_shape *s, int e) {
    if (sdfc_low(c, e) >= 0 && sdfc_high(c, e) <= PI + 1e-9) return;
    sdfc_fail(c, s->token, "%s: expected an angle from 0 to pi", sdfc_kinds[s->kind].name);
}

/* Bounds around `count` points of n numbers each; point i has the radius radii[i]. */
static sdfc_facts around_points(const sdfc *c, const int *n, int count, int numbers,
                                const int *radii) {
    double low[3] = {-SDFC_INFINITY, -SDFC_INFINITY, -SDFC_INFINITY}, high[3];
    for (int k = 0; k < 3; k++) high[k] = SDFC_INFINITY;
    for (int k = 0; k < numbers; k++) {
        low[k] = SDFC_INFINITY, high[k] = -SDFC_INFINITY;
        for (int i = 0; i < count; i++) {
            double r = radii ? sdfc_size_of(c, radii[i]) : 0;
            low[k] = fmin(low[k], sdfc_low(c, n[numbers * i + k]) - r);
            high[k] = fmax(high[k], sdfc_high(c, n[numbers * i + k]) + r);
        }
    }
    return within(low, high, numbers == 2 ? 4 : 0);
}

static sdfc_facts round_cone_facts(sdfc *c, sdfc_shape *s) {
    int *n = s->number, sum = 0, radii[2] = {n[6], n[7]};
    sdfc_facts f = around_points(c, n, 2, 3, radii);
    for (int i = 0; i < 3; i++) {
        n[3 + i] = sdfc_apply2(c, SDFC_sub, n[3 + i], n[i]);
        int square = sdfc_apply2(c, SDFC_mul, n[3 + i], n[3 + i]);
        sum = i ? sdfc_apply2(c, SDFC_add, sum, square) : square;
    }
    n[6] = sdfc_apply1(c, SDFC_rcp, sum);
    n[7] = radii[0];
    n[8] = radii[1];
    return f;
}

/* Bounds of the directions within an angle t of +y, at distance 1: the lateral extent, and the
 * lowest y. */
static void reach_of_angle(double t, double *across, double *low) {
    *across = t >= PI / 2 ? 1 : sin(t);
    *low = fmin(0, cos(fmin(t, PI)));
}

static sdfc_facts angle_facts(sdfc *c, sdfc_shape *s) {
    int *n = s->number, angle = n[0];
    double across, low, r = sdfc_size_of(c, n[1]), tube = 0;
    bool arc = s->kind == SDFC_KIND_CAPPED_TORUS;
    need_angle(c, s, angle);
    reach_of_angle(sdfc_high(c, angle), &across, &low);
    if (arc) tube = sdfc_size_of(c, n[2]);
    double x = across * r + tube, z = arc ? tube : x;
    sdfc_facts f = within((double[3]){-x, low * r - tube, -z}, (double[3]){x, r + tube, z}, 5);
    n[3] = n[2];
    n[2] = n[1];
    n[0] = sdfc_apply1(c, SDFC_cos, angle);
    n[1] = sdfc_apply1(c, SDFC_sin, angle);
    f.symmetric = 5;
    return f;
}

static sdfc_facts cut_sphere_facts(sdfc *c, sdfc_shape *s) {
    int *n = s->number;
    double r = sdfc_size_of(c, n[0]), h = sdfc_low(c, n[1]);
    if (!(sdfc_most(c, n[1]) < sdfc_low(c, n[0]))) {
        sdfc_fail(c, s->token, "cut_sphere: expected a height within the radius");
    }
    double x = h > 0 ? sqrt(r * r - h * h) : r;
    int squares = sdfc_apply2(c, SDFC_sub, sdfc_apply2(c, SDFC_mul, n[0], n[0]),
                              sdfc_apply2(c, SDFC_mul, n[1], n[1]));
    n[2] = sdfc_apply1(c, SDFC_sqrt, squares);
    return within((double[3]){-x, h, -x}, (double[3]){x, r, x}, 5);
}

/* Flat ones end along x and y. */
static sdfc_facts flat(double x, double low, double high, unsigned symmetric) {
    return within((double[3]){-x, low, -SDFC_INFINITY}, (double[3]){x, high, SDFC_INFINITY},
                  symmetric);
}

static sdfc_facts polygon_facts(sdfc *c, sdfc_shape *s) {
    int *n = s->number, sides = s->whole[0];
    double half = PI / sides;
    if (sides < 3)
        sdfc_fail(c, s->token, "%s: expected at least 3 sides", sdfc_kinds[s->kind].name);
    need_above(c, s, n[0], "a radius");
    unsigned mirrors = sides % 2 ? 5 : 7;
    double r = sdfc_high(c, n[0]);
    if (s->kind == SDFC_KIND_STAR) {
        need_above(c, s, n[1], "an inner radius");
        r = fmax(r, sdfc_high(c, n[1]));
        int inner = n[1];
        n[1] = sdfc_apply2(c, SDFC_mul, inner, sdfc_number(c, sin(half)));
        n[2] = sdfc_apply2(c, SDFC_mul, inner, sdfc_number(c, cos(half)));
    } else {
        n[1] = sdfc_apply2(c, SDFC_mul, n[0], sdfc_number(c, tan(half)));
        r /= cos(half);
    }
    return flat(r, -r, r, mirrors);
}

static sdfc_facts terrain_facts(sdfc *c, const sdfc_shape *s) {
    const int *n = s->number;
    double gain = fmin(sdfc_most(c, n[2]), 1), share = sdfc_most(c, n[0]), most = 0;
    for (int i = 0; i < s->whole[0]; i++, share *= gain) most += share;
    sdfc_facts f = endless(0);
    f.box.high[1] = most;
    f.cost = 8.0 * s->whole[0];
    return f;
}

/* Bounds of the set of q -> q^2 + c, and the radius beyond which all points escape. */
static sdfc_facts julia_facts(const sdfc *c, const sdfc_shape *s) {
    double most = 0;
    for (int i = 0; i < 4; i++) most = hypot(most, sdfc_most(c, s->number[i]));
    double r = (1 + sqrt(1 + 4 * most)) / 2;
    sdfc_facts f = sdfc_solid(r, r, r, 0);
    f.radius = fmin(f.radius, r);
    f.lipschitz = 1.5;
    f.estimate = true;
    f.cost = 5.0 * s->whole[0];
    return f;
}

static sdfc_facts mandelbox_facts(sdfc *c, const sdfc_shape *s) {
    double k = c->exprs[s->number[0]].value, r = k > 0 ? 2 * (k + 1) / (k - 1) : 4;
    if (!sdfc_constant(c, s->number[0]) || !(fabs(k) >= 1.2 && fabs(k) <= 3)) {
        sdfc_fail(c, s->token,
                  "mandelbox: expected a constant factor from -3 to -1.2 or from 1.2 to 3");
    }
    sdfc_facts f = sdfc_solid(r, r, r, 0);
    f.lipschitz = 1.5;
    f.estimate = true;
    f.cost = 6.0 * s->whole[0];
    return f;
}

sdfc_facts sdfc_more_facts(sdfc *c, sdfc_shape *s) {
    int *n = s->number;
    double a = sdfc_size_of(c, n[0]), b = sdfc_size_of(c, n[1]);
    switch (s->kind) {
    case SDFC_KIND_ROUND_CONE: return round_cone_facts(c, s);
    case SDFC_KIND_CAPPED_TORUS:
    case SDFC_KIND_SOLID_ANGLE: return angle_facts(c, s);
    case SDFC_KIND_PYRAMID:
        need_above(c, s, n[0], "a half side");
        need_above(c, s, n[1], "a height");
        return within((double[3]){-a, 0, -a}, (double[3]){a, b, a}, 5);
    case SDFC_KIND_BEZIER: {
        int radii[3] = {n[9], n[9], n[9]};
        sdfc_facts f = around_points(c, n, 3, 3, radii);
        f.cost = 12;
        return f;
    }
    case SDFC_KIND_ROUNDED_CYLINDER: return sdfc_solid(b, a, b, 7);
    case SDFC_KIND_CUT_SPHERE: return cut_sphere_facts(c, s);
    case SDFC_KIND_TRIANGLE: return around_points(c, n, 3, 2, NULL);
    case SDFC_KIND_NGON:
    case SDFC_KIND_STAR: return polygon_facts(c, s);
    case SDFC_KIND_HEART:
        need_above(c, s, n[0], "a size");
        return flat(0.60355339059327379 * a, 0, 1.1035533905932737 * a, 5);
    case SDFC_KIND_GYROID: {
        need_above(c, s, n[0], "a frequency");
        return endless(0);
    }
    case SDFC_KIND_TERRAIN: return terrain_facts(c, s);
    case SDFC_KIND_APOLLONIAN: {
        need_above(c, s, n[0], "a factor");
        sdfc_facts f = endless(7);
        f.estimate = true;
        f.cost = 6.0 * s->whole[0];
        return f;
    }
    case SDFC_KIND_MANDELBOX: return mandelbox_facts(c, s);
    default: return julia_facts(c, s);
    }
}
