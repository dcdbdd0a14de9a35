/* test_sdf_shapes.c: every shape of the table against its documented properties. Its Lipschitz
 * constant holds for pairs of points, and for the steepest ones after hill climbing: a few
 * thousand, a million with LONG. If it claims to be exact, following the gradient by the field's
 * value ends on the surface. Cells, blends and colours are compared with formulas written
 * independently here. Everything runs in double precision, without a GPU. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>

#include "sdfc/sdfc.h"
#include "sdfc/internal.h"
#include "support/field.h"
#include "support/files.h"
#include "support/random.h"

static void must_start(field *r, const char *text) {
    if (!field_start(r, text)) fail_msg("%s\n%s", text, r->error);
}

static void look(const field *r, int part, double x, double y, double z, double out[8]) {
    const double p[3] = {x, y, z};
    sdfc_run_look(r->c, &r->c->parts[part], p, &r->at, r->room, out);
}

static const sdfc_facts *facts(const field *r, int part) { return &r->c->shapes[r->c->parts[part].shape].facts; }

static double apart(const double p[3], const double q[3]) {
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

/* ---- every shape ---- */

typedef enum claim {
    BOUND,    /* constant L, and positive outside its bounds */
    EXACT,    /* the distance outside too */
    ESTIMATE, /* no solid within f / L, except for 1 in 200 */
    SAFE      /* no solid within f / L, ever */
} claim;

static const struct {
    const char *text;
    claim claim;
    double solid[3]; /* a point inside it */
} shapes[] = {
    {"round_cone((0, 0, 0), (1, 1, 0), 0.5, 0.2)", EXACT, {0.5, 0.5, 0.1}},
    {"round_cone((0, 0, 0), (0.2, 0, 0), 0.5, 0.2)", EXACT, {0, 0.4, 0}},
    {"round_cone((0, -1, 0), (0, 1, 0), 0.1, 0.6)", EXACT, {0, 1.5, 0}},
    {"capped_torus(1.9, 1, 0.2)", EXACT, {0, 1.1, 0.1}},
    {"capped_torus(0.4, 1, 0.2)", EXACT, {0.3, 0.95, 0.1}},
    {"pyramid(1, 1.5)", EXACT, {0.8, 0.1, -0.8}},
    {"pyramid(0.3, 2)", EXACT, {0, 1.8, 0}},
    {"bezier((0, 0, 0), (1, 2, 0.3), (2, 0, 0), 0.1)", EXACT, {1, 1, 0.15}},
    {"bezier((0, 0, 0), (1, 0.1, 0), (2, 0, 0), 0.1)", EXACT, {1, 0.05, 0}},
    {"bezier((0, 0, 0), (1, 0, 0), (2, 0, 0), 0.1)", EXACT, {1, 0, 0}},
    {"bezier((0, 0, 0), (1, 0.01, 0), (0.1, 0, 0.1), 0.1)", EXACT, {0.5, 0, 0.05}},
    {"rounded_cylinder(1, 0.5, 0.2)", EXACT, {0.3, 0.9, 0}},
    {"solid_angle(0.7, 1)", EXACT, {0, 0.9, 0}},
    {"solid_angle(2, 1)", EXACT, {0.7, -0.1, 0}},
    {"cut_sphere(1, 0.3)", EXACT, {0.2, 0.9, 0}},
    {"cut_sphere(1, -0.6)", EXACT, {0.9, 0.1, 0}},
    {"extrude(0.1, triangle((0, 0), (1, 0), (0.2, 0.8)))", EXACT, {0.3, 0.2, 0.05}},
    {"extrude(0.2, round(0.1, ngon(5, 1)))", EXACT, {0, -1.05, 0}},
    {"extrude(0.2, ngon(6, 1))", EXACT, {1.1, 0, 0}},
    {"extrude(0.1, star(5, 1, 0.4))", EXACT, {0, 0.9, 0}},
    {"extrude(0.2, heart(0.8))", EXACT, {0.2, 0.5, 0.1}},
    {"extrude(0.3, box((1, 0.5, 9)))", EXACT, {0.9, 0.4, 0.2}},
    {"revolve(1, heart(0.5))", EXACT, {1, 0.2, 0}},
    {"revolve(0.5, star(7, 1, 0.5))", BOUND, {0, 0.2, 0.9}},
    {"extrude(0.5, displace(0.1, (5, 6, 7), sphere(1)))", BOUND, {0, 0, 0.4}},
    {"chamfer(0.2, box((1, 1, 1)), translate((1, 0.5, 0), sphere(1)))", BOUND, {1.9, 0.5, 0}},
    {"chamfer(0.3, plane((0, 1, 0), 0), plane((1, 0, 0), 0), translate((1, 1, 0), sphere(0.8)))", BOUND, {0.1, 0.1, 0}},
    {"stairs(0.3, 4, box((1, 1, 1)), translate((1, 0.5, 0), box((1, 2, 0.5))))", BOUND, {1.5, 2, 0}},
    {"xor(box((1, 1, 1)), translate((1, 0.5, 0), sphere(1)))", EXACT, {-0.9, 0, 0}},
    {"blend(0.5, sphere(1), translate((1, 0, 0), sphere(0.5)))", BOUND, {0.9, 0.1, 0}},
    {"blend(0.5, sphere(1), translate((1, 0, 0), sphere(0.5)), translate((0, 1, 0), box((0.3, 0.3, 0.3))),"
     " translate((0, 1, 1), sphere(0.3)), torus(1.5, 0.2), translate((0, -1, 1), sphere(0.3)))", BOUND, {0, 0, 0}},
    {"paint(m, box((1, 2, 3)))", EXACT, {0, 1.9, 0}},
    {"intersection(gyroid(3, 0.1), sphere(2))", BOUND, {0, 0, 0}},
    {"gyroid(0.7, 0.3)", BOUND, {0, 0, 0}},
    {"terrain(2, 0.2, 6, 0.5)", BOUND, {0, -5, 0}},
    {"terrain(6, 0.05, 12, 0.6)", BOUND, {0, -20, 0}},
    {"repeat((8, 0, 8) as h, translate((h.hash(1) - 0.5, 4 + 20 * h.hash(0) ^ 3, 0), box((2.6, 4 + 20 * h.hash(0) ^ 3, 2.6))))",
     BOUND, {0, 1, 0}},
    {"repeat((2, 2, 2) as h, translate(0.3 * (h.hash(1), h.hash(2), h.hash(3)), sphere(0.3 + 0.4 * h.hash(0))))", BOUND, {0, 0, 0}},
    {"repeat_limited((2, 0, 2), (5, 1, 3) as h, rotate((0, 1, 0), tau * h.hash(0), box((0.9, 1, 0.2))))", BOUND, {0, 0, 0}},
    {"repeat_limited((0.6, 0.6, 0.6), (3, 4, 2) as h, sphere(0.1 + 0.15 * h.hash(0)))", BOUND, {0, 0.3, 0.3}},
    {"repeat((9, 0, 9) as a, repeat_limited((2, 0, 2), (3, 1, 3) as b, box((0.3 + 0.3 * b.hash(0), 1 + a.hash(0), 0.5))))",
     BOUND, {0, 0.5, 0}},
    {"repeat((4, 0, 0) as h, polar(5, translate((1, 0, 0.1), box((0.2, 0.2, 0.1 + 0.3 * h.hash(0))))))", BOUND, {1, 0, 0.1}},
    {"repeat((4, 0, 4) as h, polar(6, translate((1, 0, 0), box((0.2, 0.2, 0.1 + 0.3 * h.hash(0))))))", BOUND, {1, 0, 0}},
    {"apollonian(6, 1.2, 0.03)", SAFE, {0, 0, 0}},
    {"intersection(apollonian(9, 1.3, 0.01), sphere(2))", SAFE, {0, 0, 0}},
    {"mandelbox(6, 2)", ESTIMATE, {0, 0, 0}},
    {"mandelbox(8, -1.5)", ESTIMATE, {0, 0, 0}},
    {"mandelbox(7, 2.8)", ESTIMATE, {0, 0, 0}},
    {"julia((-0.2, 0.6, 0.2), 0.2, 8)", ESTIMATE, {0.05, 0.02, 0}},
    {"julia((0.3, 0.5, 0), 0, 6)", ESTIMATE, {0.05, 0.02, 0}},
    {"mandelbulb(8, 3)", ESTIMATE, {0.05, 0.02, 0}},
    {"mandelbulb(3, 9)", ESTIMATE, {0.05, 0.02, 0}},
    {"rotate((0, 1, 0), 0.5 * pi, translate((3, 0, 0), sphere(0.5)))", EXACT, {0, 0, -3}},
};
#define PI 3.14159265358979323846

enum { SHAPES = sizeof shapes / sizeof *shapes };

static void any_point(const sdfc_facts *f, uint64_t *seed, double p[3]) {
    for (int k = 0; k < 3; k++) {
        bool ends = isfinite(f->box.low[k]) && isfinite(f->box.high[k]);
        double middle = ends ? (f->box.low[k] + f->box.high[k]) / 2 : 0;
        double half = ends ? (f->box.high[k] - f->box.low[k]) / 2 + 0.3 : 12;
        p[k] = middle + random_between(seed, -1, 1) * half * (random_between(seed, 0, 1) < 0.3 ? 3 : 1);
    }
}

typedef struct pair {
    double p[3], q[3], slope;
} pair;

static void measure(const field *r, pair *at) {
    double d = apart(at->p, at->q);
    at->slope = d > 1e-12 ? fabs(field_value(r, 0, at->p) - field_value(r, 0, at->q)) / d : 0;
}

/* The steepest of many pairs, each then moved to steeper points nearby. */
static double steepest(const field *r, uint32_t pairs, uint64_t *seed) {
    enum { KEPT = 64, STEPS = 150 };
    static pair kept[KEPT];
    double most = 0;
    memset(kept, 0, sizeof kept);
    for (uint32_t n = 0; n < pairs; n++) {
        pair at;
        double by = pow(10, random_between(seed, -5, 0.3));
        any_point(facts(r, 0), seed, at.p);
        for (int k = 0; k < 3; k++) at.q[k] = at.p[k] + by * random_between(seed, -1, 1);
        measure(r, &at);
        /* bisects towards the steeper half: finds jumps */
        for (int halves = 0; n % 20 < 2 && halves < 20; halves++) {
            pair low = at, high = at;
            for (int k = 0; k < 3; k++) low.q[k] = high.p[k] = (at.p[k] + at.q[k]) / 2;
            if (apart(at.p, at.q) < 4e-6) break;
            measure(r, &low);
            measure(r, &high);
            at = low.slope > high.slope ? low : high;
        }
        if (at.slope > kept[n % KEPT].slope) kept[n % KEPT] = at;
    }
    for (int i = 0; i < KEPT; i++) {
        double by = 0.1;
        for (int n = 0; n < STEPS; n++) {
            pair next = kept[i];
            for (int k = 0; k < 3; k++) {
                double both = by * random_between(seed, -1, 1);
                next.p[k] += both;
                next.q[k] += both + (n % 2 ? 0 : 0.3 * by * random_between(seed, -1, 1));
            }
            if (apart(next.p, next.q) > 1e-5) measure(r, &next);
            if (next.slope > kept[i].slope && apart(next.p, next.q) > 1e-5)
                kept[i] = next;
            else
                by *= 0.96;
        }
        most = fmax(most, kept[i].slope);
    }
    return most;
}

static void gradient(const field *r, const double p[3], double g[3]) {
    for (int k = 0; k < 3; k++) {
        double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[k] += 1e-6;
        b[k] -= 1e-6;
        g[k] = (field_value(r, 0, a) - field_value(r, 0, b)) / 2e-6;
    }
}

/* With the constant 1 the value never exceeds the distance; if the walk ends on the surface, it is
 * not below it either. */
static void assert_exact(const field *r, const char *text, uint64_t *seed) {
    int missed = 0, tried = 0;
    double worst = 0;
    for (int n = 0; n < 600; n++) {
        double p[3], g[3], q[3];
        any_point(facts(r, 0), seed, p);
        double f = field_value(r, 0, p);
        if (!(f > 0.01)) continue;
        gradient(r, p, g);
        double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
        if (fabs(length - 1) > 1e-5) { /* on a crease; these are few */
            missed++;
            continue;
        }
        for (int k = 0; k < 3; k++) q[k] = p[k] - f * g[k];
        worst = fmax(worst, fabs(field_value(r, 0, q)));
        tried++;
    }
    if (tried < 100 || missed > tried / 10 || worst > 1e-3) {
        fail_msg("%s: of %d walks one ends %g from the surface; %d have no direction", text, tried, worst, missed);
    }
}

static void assert_safe(const field *r, const char *text, double share, uint32_t pairs, uint64_t *seed) {
    double L = facts(r, 0)->lipschitz;
    int tried = 0, wrong = 0;
    for (uint32_t n = 0; n < pairs; n++) {
        double p[3], q[3], way[3], length = 0;
        any_point(facts(r, 0), seed, p);
        double f = field_value(r, 0, p);
        if (!(f > 0)) continue;
        for (int k = 0; k < 3; k++) way[k] = random_between(seed, -1, 1);
        for (int k = 0; k < 3; k++) length += way[k] * way[k];
        double step = f / L * cbrt(random_between(seed, 0, 1)) * (1 - 1e-9);
        for (int k = 0; k < 3; k++) q[k] = p[k] + way[k] / sqrt(length) * step;
        tried++;
        wrong += field_value(r, 0, q) < 0;
    }
    if (tried < 100 || wrong > share * tried) fail_msg("%s: %d of %d steps end in the solid", text, wrong, tried);
}

static void every_shape_is_what_its_table_says(void **state) {
    (void)state;
    const uint32_t pairs = long_run() ? 1000000 : whole_run() ? 12000 : 2000;
    for (size_t i = 0; i < SHAPES; i++) {
        field r;
        char text[1024];
        uint64_t seed = 7;
        snprintf(text, sizeof text, "material m { albedo 1 } part a = %s;", shapes[i].text);
        must_start(&r, text);
        const sdfc_facts *f = facts(&r, 0);
        if (!(field_value(&r, 0, shapes[i].solid) < 0)) fail_msg("%s: %g within", text, field_value(&r, 0, shapes[i].solid));
        if (shapes[i].claim == ESTIMATE || shapes[i].claim == SAFE) {
            assert_safe(&r, text, shapes[i].claim == SAFE ? 0 : 0.005, pairs, &seed);
        } else {
            double most = steepest(&r, pairs, &seed);
            if (most > f->lipschitz * (1 + 1e-6)) fail_msg("%s: a slope of %.9g, not %.9g", text, most, f->lipschitz);
            if (shapes[i].claim == EXACT) assert_exact(&r, text, &seed);
        }
        for (uint32_t n = 0; n < pairs; n++) {
            double p[3], out = 0;
            any_point(f, &seed, p);
            for (int k = 0; k < 3; k++) {
                double d = fmax(fmax(f->box.low[k] - p[k], p[k] - f->box.high[k]), 0);
                out = sqrt(out * out + d * d);
            }
            if (isfinite(f->radius)) out = fmax(out, apart(p, f->center) - f->radius);
            double v = out > 0 ? field_value(&r, 0, p) : 0;
            if (v < f->growth * out * (1 - 1e-9) - 1e-9) fail_msg("%s: %g at a distance of %g from its bounds", text, v, out);
        }
        field_stop(&r);
    }
}

/* A turned shape is bounded where it was; an axis without an end does not take the bounds of the others. */
static void turned_bounds_are_tight(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double low, high; /* in y */
    } rows[] = {
        {"repeat((2, 0, 2), translate((0, 1, 0), sphere(0.5)))", 0.5, 1.5},
        {"rotate((0, 1, 0), 0.3, repeat((2, 0, 2), translate((0, 1, 0), sphere(0.5))))", 0.5, 1.5},
        {"rotate((1, 0, 0), 0.5 * pi, box((1, 2, 3)))", -3, 3},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        field r;
        char text[256];
        snprintf(text, sizeof text, "material m { albedo 1 } part a = %s;", rows[i].text);
        must_start(&r, text);
        const sdfc_box *b = &facts(&r, 0)->box;
        bool tight = fabs(b->low[1] - rows[i].low) < 1e-9 && fabs(b->high[1] - rows[i].high) < 1e-9;
        if (!tight) fail_msg("%s: from %g to %g", text, b->low[1], b->high[1]);
        field_stop(&r);
    }
}

static double value_of(const char *shape, double x, double y, double z) {
    field r;
    char text[256];
    const double p[3] = {x, y, z};
    snprintf(text, sizeof text, "material m { albedo 1 } part a = %s;", shape);
    must_start(&r, text);
    double v = field_value(&r, 0, p);
    field_stop(&r);
    return v;
}

/* There the orbit escapes in two levels, so that more change nothing; two themselves have the constant 1, and with it a
 * factor of 1.3. */
static void a_bulb_of_two_levels_has_a_factor(void **state) {
    (void)state;
    double two = value_of("mandelbulb(8, 2)", 1.12, 0, 0), three = value_of("mandelbulb(8, 3)", 1.12, 0, 0);
    double r = 1.12, slope = 8 * pow(r, 7) + 1, z = sqrt(pow(r, 16) + r * r);
    slope = 8 * pow(z, 7) * fmax(1, fabs(sin(8 * atan2(r, pow(r, 8)))) * fmin(z / r, 9)) * slope + 1;
    assert_true(three > 0.02 && fabs(two / three - 1.3) < 1e-9);
    assert_true(value_of("mandelbulb(8, 16)", 1.12, 0, 0) == three);
    double far = pow(z, 8); /* + r, in another direction */
    assert_true(fabs(three / (0.5 * log(far) * far / slope) - 1) < 1e-3);
}

/* ---- cells and blends, by formulas ---- */

/* The number of a cell is the albedo of the ground there. */
static double hash_of(const field *r, double x, double z) {
    double out[8];
    look(r, 1, x, 0, z, out);
    return out[0];
}

static void cells_that_differ_are_all_there(void **state) {
    (void)state;
    static const char text[] =
        "material m { albedo (cell.hash(0), cell.hash(1), 0) }"
        "part a = repeat((3, 0, 2) as h, translate((0, h.hash(0), 0), sphere(0.4 + 0.4 * h.hash(1))));"
        "part b : m = repeat((3, 0, 2) as h, box((1.5, 1, 1)));";
    field r;
    uint64_t seed = 3;
    must_start(&r, text);
    double least = 1, most = 0;
    for (int n = 0; n < 3000; n++) {
        double p[3] = {random_between(&seed, -30, 30), random_between(&seed, -3, 3), random_between(&seed, -30, 30)}, d = 1e30;
        double i = floor(p[0] / 3 + 0.5), j = floor(p[2] / 2 + 0.5), out[8];
        for (int u = -3; u <= 3; u++) {
            for (int v = -3; v <= 3; v++) {
                double x = 3 * (i + u), z = 2 * (j + v);
                look(&r, 1, x, 0, z, out);
                d = fmin(d, sqrt((p[0] - x) * (p[0] - x) + (p[1] - out[0]) * (p[1] - out[0]) + (p[2] - z) * (p[2] - z)) -
                                (0.4 + 0.4 * out[1]));
            }
        }
        double f = field_value(&r, 0, p), h = hash_of(&r, p[0], p[2]);
        if ((f < 0) != (d < 0) && fabs(d) > 1e-9) fail_msg("(%g, %g, %g): %g, all cells %g", p[0], p[1], p[2], f, d);
        if (f > d + 1e-9 || (d < 0.15 && fabs(f - d) > 1e-9)) fail_msg("(%g, %g, %g): %g, all cells %g", p[0], p[1], p[2], f, d);
        least = fmin(least, h);
        most = fmax(most, h);
    }
    assert_true(least < 0.05 && most > 0.95);
    field_stop(&r);
}

static void sectors_that_differ_are_all_there(void **state) {
    (void)state;
    static const struct {
        int count;
        double x, z, r, more; /* middle of a ball at an angle of 0, its radius, and how much it grows with hash and index */
    } cases[] = {{12, 3, 0, 0.2, 0.4}, {7, 3, 1.4, 0.3, 0.6}, {2, 1, 0.2, 0.3, 0.5}, {3, 1, 0, 0.4, 0.5}, {1, 1, 0, 0.3, 0.2},
                 {5, 2, 0.1, 0.7, 0.3}, {40, 9, 0.2, 0.2, 0.2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        field r;
        uint64_t seed = 11;
        int n = cases[i].count;
        snprintf(text, sizeof text,
                 "material m { albedo (cell.index / %d, cell.hash(3), 0) }"
                 "part a : m = polar(%d as s, translate((%g, 0, %g), sphere(%g + %g * s.hash(3) * s.index / %d)));",
                 n, n, cases[i].x, cases[i].z, cases[i].r, cases[i].more, n);
        must_start(&r, text);
        double radius[64], hash[64], low = 1, high = 0;
        for (int k = 0; k < n; k++) { /* the colour of a ball says what its sector is, and so how large it is */
            double a = 2 * PI * k / n, out[8];
            look(&r, 0, cases[i].x * cos(a) - cases[i].z * sin(a), 0, cases[i].x * sin(a) + cases[i].z * cos(a), out);
            if (fabs(out[0] * n - k) > 1e-9) fail_msg("%s: sector %d has the index %g", text, k, out[0] * n);
            hash[k] = out[1];
            low = fmin(low, hash[k]), high = fmax(high, hash[k]);
            radius[k] = cases[i].r + cases[i].more * hash[k] * k / n;
        }
        if (n > 6 && !(low < 0.2 && high > 0.8)) fail_msg("%s: numbers from %g to %g", text, low, high);
        for (int m = 0; m < 2000; m++) {
            double p[3] = {random_between(&seed, -12, 12), random_between(&seed, -2, 2), random_between(&seed, -12, 12)}, d = 1e30;
            if (m % 2) p[0] /= 3, p[2] /= 3;
            for (int k = 0; k < n; k++) {
                double a = 2 * PI * k / n, x = cases[i].x * cos(a) - cases[i].z * sin(a), z = cases[i].x * sin(a) + cases[i].z * cos(a);
                d = fmin(d, sqrt((p[0] - x) * (p[0] - x) + p[1] * p[1] + (p[2] - z) * (p[2] - z)) - radius[k]);
            }
            double f = field_value(&r, 0, p);
            if ((f < 0) != (d < 0) && fabs(d) > 1e-9) fail_msg("%s: %g at (%g, %g, %g), all sectors %g", text, f, p[0], p[1], p[2], d);
            if (f > d + 1e-9) fail_msg("%s: %g at (%g, %g, %g), all sectors %g", text, f, p[0], p[1], p[2], d);
        }
        double most = steepest(&r, 20000, &seed);
        if (most > facts(&r, 0)->lipschitz * (1 + 1e-6)) fail_msg("%s: a slope of %.9g", text, most);
        field_stop(&r);
    }
}

static void a_blend_does_not_depend_on_the_order(void **state) {
    (void)state;
    static const char text[] =
        "part a = blend(0.5, sphere(1), translate((1, 0.3, 0), sphere(0.5)), translate((0, 1, 0.4), box((0.3, 0.3, 0.3))), torus(1, 0.2));"
        "part b = blend(0.5, torus(1, 0.2), translate((0, 1, 0.4), box((0.3, 0.3, 0.3))), sphere(1), translate((1, 0.3, 0), sphere(0.5)));"
        "part c = sphere(1); part d = translate((1, 0.3, 0), sphere(0.5)); part e = translate((0, 1, 0.4), box((0.3, 0.3, 0.3)));"
        "part f = torus(1, 0.2); part g = blend(0.5, sphere(1), sphere(1), sphere(1), sphere(1), sphere(1), sphere(1), sphere(1), sphere(1), sphere(1));";
    field r;
    uint64_t seed = 5;
    must_start(&r, text);
    for (int n = 0; n < 5000; n++) {
        double p[3], sum = 0;
        for (int k = 0; k < 3; k++) p[k] = random_between(&seed, -2, 2);
        double t = field_value(&r, 0, p);
        assert_true(fabs(t - field_value(&r, 1, p)) < 1e-9);
        for (int i = 2; i < 6; i++) {
            double h = fmax(1 - (field_value(&r, i, p) - t) / 0.5, 0);
            sum += h * h;
        }
        if (fabs(sum - 1) > 1e-6) fail_msg("sum %.9g at (%g, %g, %g)", sum, p[0], p[1], p[2]);
        double nine = field_value(&r, 6, p), one = field_value(&r, 2, p);
        assert_true(fabs(nine - (one - 0.5 * (1 - 1 / 3.0))) < 1e-6);
    }
    assert_true(fabs(facts(&r, 6)->box.high[0] - (1 + 0.5 * (1 - 1 / 3.0))) < 1e-9);
    field_stop(&r);
}

/* ---- colours ---- */

static void assert_color(const char *text, double x, double y, double z, double red, double green, double blue) {
    field r;
    double out[8];
    must_start(&r, text);
    r.at.normal[1] = 1;
    look(&r, 0, x, y, z, out);
    if (fabs(out[0] - red) + fabs(out[1] - green) + fabs(out[2] - blue) > 1e-6)
        fail_msg("%s at (%g, %g, %g): (%.7g, %.7g, %.7g), not (%.7g, %.7g, %.7g)", text, x, y, z, out[0], out[1], out[2], red,
                 green, blue);
    field_stop(&r);
}

#define TWO "material r { albedo (1, 0, 0) } material b { albedo (0, 0, 1) } "

static void materials_blend_as_their_shapes_do(void **state) {
    (void)state;
    static const char *const smooth = TWO "part a = smooth_union(0.5, paint(r, sphere(1)), paint(b, translate((2, 0, 0), sphere(1))));";
    static const char *const blend = TWO "part a = blend(0.5, paint(r, sphere(1)), paint(b, translate((2, 0, 0), sphere(1))), translate((9, 0, 0), sphere(1)));";
    static const char *const hard = TWO "part a : b = union(paint(r, sphere(1)), translate((2, 0, 0), sphere(1)));";
    static const char *const cut = TWO "part a : b = difference(box((1, 1, 1)), paint(r, sphere(1.2)));";
    assert_color(smooth, -1, 0, 0, 1, 0, 0);
    assert_color(smooth, 1, 0.2, 0, 0.5, 0, 0.5);
    /* fields -0.1 and 0.1: h = (0.5 - 0.2) / 0.5, and half of that is the farther one's */
    assert_color(smooth, 0.9, 0, 0, 1 - 0.3, 0, 0.3);
    assert_color(blend, 1, 0.2, 0, 0.5, 0, 0.5);
    /* -0.1 and 0.1 of k = 0.5: t = (0 - 1 + sqrt(0.5 - 0.04)) / 2 */
    double t = (sqrt(0.46) - 1) / 2, far = 1 - (0.1 - t) / 0.5, near = 1 - (-0.1 - t) / 0.5;
    assert_color(blend, 0.9, 0, 0, near / (near + far), 0, far / (near + far));
    assert_color(hard, 0.9, 0, 0, 1, 0, 0);
    assert_color(hard, 1.1, 0, 0, 0, 0, 1);
    assert_color(cut, 1, 0.9, 0.9, 0, 0, 1);
    assert_color(cut, 0.9, 0.8, 0, 1, 0, 0);
    assert_color(TWO "part a = morph(paint(r, sphere(1)), paint(b, box((1, 1, 1))), 0.25);", 1, 0, 0, 0.75, 0, 0.25);
    /* the nearest of several cells, and of several copies around y */
    assert_color(TWO "part a : r = repeat((2, 0, 0), union(translate((0.4, 0, 0), sphere(0.3)), paint(b, translate((-0.7, 0, 0), sphere(0.2)))));",
                 5.1, 0.2, 0, 0, 0, 1);
    assert_color(TWO "part a : r = polar(4, translate((3, 0, 0), union(sphere(0.3), paint(b, translate((0, 0.4, 0.1), sphere(0.2))))));",
                 -3.1, 0.6, 0, 0, 0, 1);
    assert_color(TWO "part a : r = polar(3, union(translate((3, 0, 2), box((1, 1, 2))), paint(b, translate((-1, 0, 0.5), sphere(0.5)))));",
                 -1, 0.5, 0.5, 0, 0, 1);
}

static void colours_depend_on_the_place(void **state) {
    (void)state;
    assert_color("material m { albedo p } part a : m = translate((1, 2, 3), rotate((0, 1, 0), pi / 2, scale(2, sphere(1))));",
                 1 + 0.2, 2 + 0.4, 3 + 0.6, -0.3, 0.2, 0.1);
    assert_color("material m { albedo world } part a : m = translate((1, 2, 3), sphere(1));", 1, 0.5, 0.25, 1, 0.5, 0.25);
    assert_color("material m { albedo n } part a : m = sphere(1);", 1, 0, 0, 0, 1, 0);
    assert_color("material m { albedo (checker(p.xz), checker(p), stripes(p.y / 0.5)) } part a : m = box((9, 9, 9));", 1.5, 0.7, 0.5,
                 1, 1, 1);
    assert_color("material m { albedo (checker(p.xz), checker(p), stripes(p.y / 0.5)) } part a : m = box((9, 9, 9));", 1.5, 1.2, 1.5,
                 0, 1, 0);
    assert_color("material m { albedo (p.x > 0.5 ? 1 : 0, p.y <= 0.5 ? 1 : 0, step(0.5, p.z)) } part a : m = sphere(1);", 0.6, 0.5, 0.4,
                 1, 1, 0);
    assert_color("material m { albedo (smoothstep(0, 2, p.x), fract(p.y), sign(p.z)) } part a : m = sphere(1);", 0.5, 1.25, -3,
                 0.25 * 0.25 * 2.5, 0.25, -1);
    assert_color("material m { albedo (atan(p.x), atan(p.x, p.y), exp(p.z)) } part a : m = sphere(1);", 1, -1, 0.5, atan(1), atan2(1, -1),
                 exp(0.5));
    assert_color("material m { albedo (dot(p, (1, 2, 3)), dot(p.xy, p.yx), log(p.z)) } part a : m = sphere(1);", 1, -1, 0.5, 0.5, -2,
                 log(0.5));
    assert_color("def wave(x, k = 2) = k * x; material m { albedo (wave(p.x), wave(p.x, 3), p.zyx.x) } part a : m = sphere(1);", 1, 0, 0.5,
                 2, 3, 0.5);
    /* The levels of a fractal: the first traps the point itself. */
    assert_color("material m { albedo (trap.x, trap.y, trap.z) } part a : m = translate((1, 0, 0), mandelbox(1, 2));", 1.3, 0.4, 0, 0.5, 0.3, 0);
    assert_color("material m { albedo (trap.x, trap.y, trap.z) } part a : m = julia((0, 0, 0), 0, 1);", 0.3, 0.4, 0, 0.5, 0.4, 0);
    assert_color("material m { albedo (trap.x, trap.y, trap.z) } part a : m = mandelbulb(8, 1);", 0.3, 0.4, 0, 0.5, 0.3, 0);
    assert_color("material m { albedo (trap.x, trap.y, trap.z) } part a : m = intersection(apollonian(1, 1.2, 0.1), sphere(2));", 0.3, 0.4, 0, 0.5,
                 0.3, 0);
}

/* A pixel wider than the pattern has its mean. */
static void patterns_fade_where_pixels_are_wider(void **state) {
    (void)state;
    static const char text[] = "material m { albedo (checker(4 * p), fbm(p, 4, 0.5, 2), noise(2 * p)) } part a : m = scale(2, box((9, 9, 9)));";
    field r;
    double sharp[8], wide[8], fine[8];
    must_start(&r, text);
    for (int i = 0; i < 50; i++) {
        double x = 0.37 * i;
        r.at.footprint = 0;
        look(&r, 0, x, 0.3, 0.2, sharp);
        r.at.footprint = 10;
        look(&r, 0, x, 0.3, 0.2, wide);
        r.at.footprint = 1e-4;
        look(&r, 0, x, 0.3, 0.2, fine);
        assert_true(fmin(sharp[0], 1 - sharp[0]) < 1e-9 || fmod(2 * x, 1) < 1e-3);
        assert_true(fabs(wide[0] - 0.5) < 1e-9 && wide[1] == 0 && wide[2] == 0);
        assert_true(fabs(fine[1] - sharp[1]) < 1e-9 && fabs(fine[0] - sharp[0]) < 1e-6 + (fmod(2 * x, 1) < 1e-3));
    }
    field_stop(&r);
}

/* ---- noise ---- */

/* Least upper bound of |gradient|^2 of noise() in a box within a cell, for values at the cell's
 * corners: per axis the steepest fade times the largest difference across the cell, which is
 * bilinear in the fades of the other two axes. */
static double noise_slope2(const double corner[8], const double low[3], const double high[3]) {
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        int b = (axis + 1) % 3, c = (axis + 2) % 3;
        double x = fmin(fmax(0.5, low[axis]), high[axis]), most = 0;
        for (int k = 0; k < 4; k++) {
            double u = k & 1 ? high[b] : low[b], v = k & 2 ? high[c] : low[c], difference = 0;
            u = u * u * (3 - 2 * u);
            v = v * v * (3 - 2 * v);
            for (int i = 0; i < 4; i++) {
                int at = (i & 1) << b | i >> 1 << c;
                difference += (i & 1 ? u : 1 - u) * (i & 2 ? v : 1 - v) * (corner[at | 1 << axis] - corner[at]);
            }
            most = fmax(most, fabs(difference));
        }
        sum += pow(6 * x * (1 - x) * most, 2);
    }
    return sum;
}

static bool is_below(const double corner[8], double low[3], double high[3], int depth, double bound) {
    if (noise_slope2(corner, low, high) <= bound * bound) return true;
    if (depth == 60) return false;
    int axis = depth % 3;
    double from = low[axis], to = high[axis], middle = (from + to) / 2;
    high[axis] = middle;
    bool good = is_below(corner, low, high, depth + 1, bound);
    high[axis] = to;
    low[axis] = middle;
    good = good && is_below(corner, low, high, depth + 1, bound);
    low[axis] = from;
    return good;
}

/* |gradient|^2 is convex in the values at the corners, so its maximum over -1..1 is at values of -1 and 1. */
static void noise_is_no_steeper_than_its_constant(void **state) {
    (void)state;
    for (int pattern = 0; pattern < 128; pattern++) { /* the others are these with inverted sign */
        double corner[8], low[3] = {0}, high[3] = {1, 1, 1};
        for (int i = 0; i < 8; i++) corner[i] = pattern >> i & 1 ? 1 : -1;
        if (!is_below(corner, low, high, 0, SDFC_NOISE_SLOPE)) fail_msg("corners %d", pattern);
    }
    const double x_only[8] = {-1, 1, -1, 1, -1, 1, -1, 1};
    double middle[3] = {0.5, 0.5, 0.5};
    assert_true(fabs(noise_slope2(x_only, middle, middle) - 9) < 1e-12);
    assert_false(is_below(x_only, (double[3]){0}, (double[3]){1, 1, 1}, 0, 2.999));
}

/* ---- the language ---- */

static void defs_and_functions_mean_what_they_say(void **state) {
    (void)state;
    field r;
    must_start(&r, "def column(h, r = 0.25) = union(cylinder(h, r), translate((0, h, 0), sphere(2 * r)));"
                   "def twice(s, by) = union(s, translate(by, s)); def half(x) = x / 2;"
                   "let r = 7; part a = column(2); part b = union(cylinder(2, 0.25), translate((0, 2, 0), sphere(0.5)));"
                   "part c = twice(column(half(4), 0.5), (3, 0, 0));"
                   "part d = union(cylinder(2, 0.5), translate((0, 2, 0), sphere(1)), translate((3, 0, 0), cylinder(2, 0.5)), translate((3, 2, 0), sphere(1)));");
    uint64_t seed = 2;
    for (int n = 0; n < 500; n++) {
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = random_between(&seed, -4, 4);
        assert_true(fabs(field_value(&r, 0, p) - field_value(&r, 1, p)) < 1e-12);
        assert_true(fabs(field_value(&r, 2, p) - field_value(&r, 3, p)) < 1e-12);
    }
    field_stop(&r);
}

static void several_mistakes_are_told_at_once(void **state) {
    (void)state;
    static const char text[] = "part a = shpere(1);\npart b = box(1, 2);\nlet k = radus + 1;\npart c = translate((k, 0, 0), sphere(1));\n"
                               "def f(x) = x + y;\npart d = sphere(f(1));\npart e = smooth_union(0.1, sphere(1) box((1,1,1)))\n"
                               "part g : stone = sphere(1);\nmaterial stone { albedo 1 }\npart h : stnoe = sphere(1);\npart i = sphere(stripe(2));\n";
    static const char *const wanted[] = {
        "x.sdf:1:10: expected a shape, found \"shpere\": did you mean \"sphere\"?\npart a = shpere(1);\n         ^\n",
        "x.sdf:2:15: expected \")\", found \",\"\npart b = box(1, 2);\n              ^\n    box(half sizes)\n",
        "x.sdf:3:9: expected a number, found \"radus\"",
        "x.sdf:5:16: expected a number, found \"y\" (in f of line 6)",
        "x.sdf:7:38: expected \")\", found \"box\"",
        "    smooth_union(radius, shape, ...)\n",
        "x.sdf:8:10: expected a material, found \"stone\"",
        "x.sdf:10:10: expected a material, found \"stnoe\": did you mean \"stone\"?",
        "x.sdf:11:17: expected a function, found \"stripe\": did you mean \"stripes\"?",
    };
    field r;
    assert_false(field_start(&r, text));
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        if (!strstr(r.error, wanted[i])) fail_msg("\"%s\" is not in\n%s", wanted[i], r.error);
    }
    assert_null(strstr(r.error, "x.sdf:4:")); /* k has been reported */
}

static void mistakes_of_the_new_words_name_their_place(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"def f(x, y) = x; part a = sphere(f(1));", "x.sdf:1:34: expected 2 arguments, found 1: \"y\" has no default"},
        {"def f(x) = x; part a = sphere(f(1, 2));", "x.sdf:1:36: expected 1 argument"},
        {"def f(x) = f(x); part a = sphere(f(1));", "x.sdf:1:12: expected a function, found \"f\" (in f of line 1)"},
        {"def sphere(x) = box(x); part a = sphere(1);", "x.sdf:1:5: expected a name that no shape or function has"},
        {"part a = mandelbox(4, 1);", "x.sdf:1:10: mandelbox: expected a constant factor"},
        {"part a = capped_torus(4, 1, 0.1);", "x.sdf:1:10: capped_torus: expected an angle from 0 to pi"},
        {"part a = cut_sphere(1, 2);", "x.sdf:1:10: cut_sphere: expected a height within the radius"},
        {"part a = ngon(2, 1);", "x.sdf:1:10: ngon: expected at least 3 sides"},
        {"part a = blend(0, sphere(1), sphere(2));", "x.sdf:1:10: blend: expected a radius above 0"},
        {"part a = triangle((0, 0), (1, 0), 3);", "x.sdf:1:35: expected two numbers in parentheses"},
        {"part a = sphere((1, 2).x + (1, 2).z);", "x.sdf:1:35: expected x, y or z of three numbers"},
        {"let a = (1, 2) + (1, 2, 3);", "x.sdf:1:16: expected as many numbers on both sides, found 2 and 3"},
        {"material m { albedo trap.x } part a : m = sphere(1);", "trap: expected a fractal in what this material is of"},
        {"material m { albedo cell.hash(0) } part a : m = sphere(1);", "cell: expected a repetition with a name"},
        {"material m { albedo cell.index } part a : m = repeat((2, 0, 0) as h, sphere(0.2 + h.hash(0)));",
         "cell.index: expected polar(count as name, ...) around what this material is of, found repeat"},
        {"part a = repeat((2, 0, 0) as h, sphere(0.1 * h.index));", "x.sdf:1:48: expected \".hash(\""},
        {"part a = polar(6 as h, sphere(0.1 * h.number));", "x.sdf:1:39: expected \".index\", or \".hash(\""},
        {"part a = sphere(p.x);", "x.sdf:1:17: expected a number, found \"p\""},
        {"part a = repeat((2, 0, 0) as h, sphere(0.2 + 5 * h.hash(0)));", "x.sdf:1:10: repeat: the shape reaches 5.2 from the centre of its cell"},
        {"include columns;", "x.sdf:1:9: expected a file's name in quotes"},
        {"include \"no such file.sdf\";", "x.sdf:1:9: include: no such file.sdf: cannot open"},
        {"part a = intersection(repeat((2, 0, 0) as h, sphere(h.hash(1001))));", "x.sdf:1:60: expected a whole number from 0 to 1000"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        field r;
        if (field_start(&r, cases[i].text)) fail_msg("%s: success", cases[i].text);
        if (!strstr(r.error, cases[i].message)) fail_msg("%s\nis answered by\n%s", cases[i].text, r.error);
    }
}

static void files_include_others_once(void **state) {
    (void)state;
    masu_sdfc_result result;
    char error[2048], name[4096];
    write_text("columns.sdf", "include \"more.sdf\";\ndef column(h) = cylinder(h, width);\n");
    write_text("more.sdf", "let width = 0.2;\n");
    write_text("wrong.sdf", "let width = 0.2;\nlet x = width + heigth;\n");
    snprintf(name, sizeof name, "%s", in_scratch("main.sdf"));
    static const char good[] = "include \"columns.sdf\";\ninclude \"more.sdf\"\npart a = column(width);";
    static const char bad[] = "include \"wrong.sdf\";\npart a = sphere(1);";
    if (!masu_sdfc_compile(good, sizeof good - 1, name, &result, error, sizeof error)) fail_msg("%s", error);
    assert_true(result.parts[0].high[1] == 0.2);
    masu_sdfc_release(&result);
    assert_false(masu_sdfc_compile(bad, sizeof bad - 1, name, &result, error, sizeof error));
    assert_non_null(strstr(error, "wrong.sdf:2:17: expected a number, found \"heigth\""));
}

/* Scenes that do not use them contain neither their code nor their slots. */
static void other_scenes_pay_nothing(void **state) {
    (void)state;
    static const char plain[] = "material m { albedo (1, 0, 0) } part a : m = repeat((4, 0, 4), union(sphere(1), torus(1.5, 0.1)));";
    static const char varied[] = "material m { albedo p } part a : m = repeat((4, 0, 4), union(sphere(1), torus(1.5, 0.1)));";
    masu_sdfc_result a, b;
    char error[1024];
    masu_sdfc_options options = {.pairs = 1000};
    assert_true(masu_sdfc_compile_with(plain, sizeof plain - 1, "x", &options, &a, error, sizeof error));
    assert_true(masu_sdfc_compile_with(varied, sizeof varied - 1, "x", &options, &b, error, sizeof error));
    assert_null(strstr(a.glsl, "masu_look"));
    assert_null(strstr(a.glsl, "masu_footprint"));
    assert_non_null(strstr(b.glsl, "masu_look_0("));
    /* and the march of the scene with fractals is the same */
    const char *from_a = strstr(a.glsl, "real masu_shape_0("), *from_b = strstr(b.glsl, "real masu_shape_0(");
    const char *to_a = strstr(from_a, "\n}\n"), *to_b = strstr(from_b, "\n}\n");
    assert_true(to_a - from_a == to_b - from_b && memcmp(from_a, from_b, (size_t)(to_a - from_a)) == 0);
    masu_sdfc_release(&a);
    masu_sdfc_release(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_shape_is_what_its_table_says),
        cmocka_unit_test(turned_bounds_are_tight),
        cmocka_unit_test(a_bulb_of_two_levels_has_a_factor),
        cmocka_unit_test(cells_that_differ_are_all_there),
        cmocka_unit_test(sectors_that_differ_are_all_there),
        cmocka_unit_test(a_blend_does_not_depend_on_the_order),
        cmocka_unit_test(materials_blend_as_their_shapes_do),
        cmocka_unit_test(colours_depend_on_the_place),
        cmocka_unit_test(patterns_fade_where_pixels_are_wider),
        cmocka_unit_test(noise_is_no_steeper_than_its_constant),
        cmocka_unit_test(defs_and_functions_mean_what_they_say),
        cmocka_unit_test(several_mistakes_are_told_at_once),
        cmocka_unit_test(mistakes_of_the_new_words_name_their_place),
        cmocka_unit_test(files_include_others_once),
        cmocka_unit_test(other_scenes_pay_nothing),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
