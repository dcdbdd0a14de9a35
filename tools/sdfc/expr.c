/* expr.c: expressions of constants, parameters and time. An expression is an index into a list in
 * which operands precede their users. So one pass evaluates the list, another prints the needed
 * expressions, and no function is recursive. Every expression has the interval of its values over
 * all parameters and times. */
#include "sdfc/internal.h"

#include <string.h>

#define PI 3.14159265358979323846

static int add_expr(sdfc *c, sdfc_expr e) {
    c->exprs = sdfc_grow(c, c->exprs, c->expr_count, &c->expr_capacity, sizeof *c->exprs,
                         SDFC_EXPRS_MAX, "expressions");
    c->exprs[c->expr_count] = e;
    return c->expr_count++;
}

static double in_range(sdfc *c, double value) {
    if (!(fabs(value) <= 1e30)) {
        sdfc_fail(c, c->at > 0 ? c->at - 1 : 0, "expected a number of at most 1e30, found %g",
                  value);
    }
    return value;
}

int sdfc_number(sdfc *c, double value) {
    in_range(c, value);
    return add_expr(c, (sdfc_expr){.op = SDFC_CONST, .value = value, .low = value, .high = value});
}

int sdfc_param_expr(sdfc *c, int param) {
    const masu_sdfc_param *p = &c->params[param];
    return add_expr(c, (sdfc_expr){.op = SDFC_PARAM,
                                   .a = {param, 0, 0},
                                   .dynamic = true,
                                   .timed = true,
                                   .value = p->value,
                                   .low = p->minimum,
                                   .high = p->maximum});
}

int sdfc_time_expr(sdfc *c) {
    if (c->time_expr < 0) {
        c->time_expr = add_expr(c, (sdfc_expr){.op = SDFC_TIME,
                                               .dynamic = true,
                                               .timed = true,
                                               .low = -SDFC_INFINITY,
                                               .high = SDFC_INFINITY});
    }
    return c->time_expr;
}

/* The checker and the C reference work in double precision around the world's origin. */
int sdfc_anchor_expr(sdfc *c, int axis) {
    return add_expr(c, (sdfc_expr){.op = SDFC_ANCHOR,
                                   .a = {axis, 0, 0},
                                   .dynamic = true,
                                   .anchored = true,
                                   .low = -SDFC_INFINITY,
                                   .high = SDFC_INFINITY});
}

int sdfc_leaf(sdfc *c, int op, int a, int b, double low, double high) {
    return add_expr(c,
                    (sdfc_expr){.op = op,
                                .a = {a, b, 0},
                                .local = true,
                                .cellular = op == SDFC_CELL && a < 0,
                                .trapped = op == SDFC_TRAP,
                                .slope = op == SDFC_POINT || op == SDFC_WORLD      ? 1
                                         : op == SDFC_FOOTPRINT || op == SDFC_CELL ? 0
                                                                                   : SDFC_INFINITY,
                                .value = op == SDFC_CELL ? 0.5 : 0,
                                .low = low,
                                .high = high});
}

/* ---- intervals ---- */

typedef struct interval {
    double low, high;
} interval;

static const interval everything = {-SDFC_INFINITY, SDFC_INFINITY};

static double times(double x, double y) { return x == 0 || y == 0 ? 0 : x * y; }

static interval product(interval x, interval y) {
    double p[4] = {times(x.low, y.low), times(x.low, y.high), times(x.high, y.low),
                   times(x.high, y.high)};
    interval r = {p[0], p[0]};
    for (int i = 1; i < 4; i++) {
        r.low = fmin(r.low, p[i]);
        r.high = fmax(r.high, p[i]);
    }
    return r;
}

/* cos, with its extrema at the multiples of pi */
static interval cosine(interval x) {
    if (!(x.high - x.low < 2 * PI) || fabs(x.low) > 1e6) return (interval){-1, 1};
    double a = cos(x.low), b = cos(x.high);
    interval r = {fmin(a, b), fmax(a, b)};
    for (double k = ceil(x.low / PI); k * PI <= x.high; k++) {
        if (fmod(k, 2) == 0)
            r.high = 1;
        else
            r.low = -1;
    }
    return r;
}

static interval range(const sdfc *c, int op, const int *a) {
    interval v[3];
    for (int i = 0; i < 3; i++) v[i] = (interval){c->exprs[a[i]].low, c->exprs[a[i]].high};
    interval x = v[0], y = v[1];
    switch (op) {
    case SDFC_add: return (interval){x.low + y.low, x.high + y.high};
    case SDFC_sub: return (interval){x.low - y.high, x.high - y.low};
    case SDFC_mul:
        if (a[0] == a[1]) {
            double least = x.low > 0 ? x.low : x.high < 0 ? x.high : 0;
            return (interval){times(least, least),
                              fmax(times(x.low, x.low), times(x.high, x.high))};
        }
        return product(x, y);
    case SDFC_neg: return (interval){-x.high, -x.low};
    case SDFC_rcp:
        if (x.low > 1e-30 || x.high < -1e-30) return (interval){1 / x.high, 1 / x.low};
        if (x.low >= 0) return (interval){0, 1e30};
        return (interval){-1e30, 1e30};
    case SDFC_abs:
        if (x.low >= 0) return x;
        if (x.high <= 0) return (interval){-x.high, -x.low};
        return (interval){0, fmax(-x.low, x.high)};
    case SDFC_min: return (interval){fmin(x.low, y.low), fmin(x.high, y.high)};
    case SDFC_max: return (interval){fmax(x.low, y.low), fmax(x.high, y.high)};
    case SDFC_mix: { /* a (1 - t) + b t */
        interval t = v[2], s = {1 - t.high, 1 - t.low};
        if (t.low >= 0 && t.high <= 1) {
            return (interval){fmin(x.low, y.low), fmax(x.high, y.high)};
        }
        interval p = product(x, s), q = product(y, t);
        return (interval){p.low + q.low, p.high + q.high};
    }
    case SDFC_cos: return cosine(x);
    case SDFC_sin: return cosine((interval){x.low - PI / 2, x.high - PI / 2});
    case SDFC_sqrt: return (interval){sqrt(fmax(x.low, 0)), sqrt(fmax(x.high, 0))};
    case SDFC_floor: return (interval){floor(x.low), floor(x.high)};
    case SDFC_fract: return (interval){0, 1};
    case SDFC_sign:
        return (interval){x.low > 0    ? 1
                          : x.low == 0 ? 0
                                       : -1,
                          x.high < 0    ? -1
                          : x.high == 0 ? 0
                                        : 1};
    case SDFC_step: return (interval){y.low >= x.high ? 1 : 0, y.high < x.low ? 0 : 1};
    case SDFC_less: return (interval){x.high < y.low ? 1 : 0, x.low >= y.high ? 0 : 1};
    case SDFC_select:
        if (x.low > 0.5) return y;
        if (x.high <= 0.5) return v[2];
        return (interval){fmin(y.low, v[2].low), fmax(y.high, v[2].high)};
    case SDFC_ease: /* of 0..1 */
        if (!(x.low >= 0 && x.high <= 1)) return everything;
        return (interval){x.low * x.low * (3 - 2 * x.low), x.high * x.high * (3 - 2 * x.high)};
    case SDFC_atan2:
        if (y.low > 0) {
            return (interval){atan2(x.low, x.low > 0 ? y.high : y.low),
                              atan2(x.high, x.high > 0 ? y.low : y.high)};
        }
        return (interval){-PI, PI};
    case SDFC_log2: return (interval){log2(fmax(x.low, 1e-30)), log2(fmax(x.high, 1e-30))};
    case SDFC_noise:
    case SDFC_square_wave: return (interval){-1, 1};
    case SDFC_fade:
    case SDFC_cell_hash: return (interval){0, 1};
    case SDFC_mod:
        if (y.low > 0) return (interval){0, y.high};
        return (interval){-fmax(fabs(y.low), fabs(y.high)), fmax(fabs(y.low), fabs(y.high))};
    case SDFC_pow: {
        if (!isfinite(y.low) || !isfinite(y.high) || x.high < 0)
            return (interval){0, SDFC_INFINITY};
        double p[4] = {pow(fmax(x.low, 0), y.low), pow(fmax(x.low, 0), y.high),
                       pow(fmax(x.high, 0), y.low), pow(fmax(x.high, 0), y.high)};
        interval r = {0, 1};
        if (x.low > 1e-30) { /* monotone in both: the corners, within 2^+-126 */
            r = (interval){p[0], p[0]};
            for (int i = 1; i < 4; i++) r.low = fmin(r.low, p[i]), r.high = fmax(r.high, p[i]);
            return (interval){fmin(r.low, 8.5e37), fmax(r.high, 1.1e-38)};
        }
        for (int i = 0; i < 4; i++) r.high = fmax(r.high, p[i]);
        return r;
    }
    default: return everything;
    }
}

/* Rounding of the operations that made them, and NaN of Inf - Inf. */
static interval widened(interval r) {
    if (!(r.low <= r.high)) return everything;
    if (r.low != r.high) {
        r.low -= fabs(r.low) * 1e-12;
        r.high += fabs(r.high) * 1e-12;
    }
    return r;
}

/* How much a result changes with the point, from how its operands do. */
static double slope_of(const sdfc *c, int op, const int *a) {
    const sdfc_expr *x = &c->exprs[a[0]], *y = &c->exprs[a[1]];
    switch (op) {
    case SDFC_add:
    case SDFC_sub: return x->slope + y->slope;
    case SDFC_neg:
    case SDFC_abs:
    case SDFC_sin:
    case SDFC_cos: return x->slope;
    case SDFC_min:
    case SDFC_max: return fmax(x->slope, y->slope);
    case SDFC_mul: {
        double by_x = fmax(fabs(x->low), fabs(x->high)), by_y = fmax(fabs(y->low), fabs(y->high));
        return times(x->slope, by_y) + times(y->slope, by_x);
    }
    case SDFC_noise:
        return SDFC_NOISE_SLOPE * hypot(hypot(x->slope, y->slope), c->exprs[a[2]].slope);
    default: return SDFC_INFINITY;
    }
}

int sdfc_footprint(sdfc *c, int e) {
    const sdfc_expr *x = &c->exprs[e];
    if (!x->local || !isfinite(x->slope) || x->slope == 0) return sdfc_number(c, 0);
    int slope = sdfc_number(c, x->slope);
    return sdfc_apply(c, SDFC_mul, sdfc_leaf(c, SDFC_FOOTPRINT, 0, 0, 0, SDFC_INFINITY), slope,
                      slope);
}

int sdfc_fade(sdfc *c, const int e[3]) {
    int steepest = e[0];
    for (int i = 1; i < 3; i++) {
        double a = c->exprs[e[i]].slope, b = c->exprs[steepest].slope;
        if (c->exprs[e[i]].local && (a > b || !c->exprs[steepest].local)) steepest = e[i];
    }
    int width = sdfc_footprint(c, steepest);
    return sdfc_apply(c, SDFC_fade, width, width, width);
}

int sdfc_apply(sdfc *c, int op, int x, int y, int z) {
    int a[3] = {x, y, z};
    int count = sdfc_ops[op].operands;
    bool constant = true, timed = false, anchored = false, local = false, cellular = false,
         trapped = false;
    double values[3] = {0};
    for (int i = 0; i < count; i++) {
        values[i] = c->exprs[a[i]].value;
        constant = constant && sdfc_constant(c, a[i]);
        timed = timed || c->exprs[a[i]].timed;
        anchored = anchored || c->exprs[a[i]].anchored;
        local = local || c->exprs[a[i]].local;
        cellular = cellular || c->exprs[a[i]].cellular;
        trapped = trapped || c->exprs[a[i]].trapped;
    }
    double value = sdfc_run_op(op, (const int32_t[]){0, 1, 2}, values);
    if (constant) return sdfc_number(c, value);
    /* x + 0, x * 1, x * 0: common, since a number stands for a vector of three */
    for (int i = 0; i < 2 && (op == SDFC_add || op == SDFC_mul); i++) {
        if (sdfc_is(c, a[i], op == SDFC_mul)) return a[1 - i];
        if (op == SDFC_mul && sdfc_is(c, a[i], 0)) return a[i];
    }
    if (op == SDFC_sub && sdfc_is(c, y, 0)) return x;
    if (op == SDFC_select && c->exprs[x].low > 0.5) return y;
    if (op == SDFC_select && c->exprs[x].high <= 0.5) return z;
    for (int i = count; i < 3; i++) a[i] = a[0];
    interval r = widened(range(c, op, a));
    return add_expr(c, (sdfc_expr){.op = op,
                                   .a = {a[0], a[1], a[2]},
                                   .dynamic = timed || anchored,
                                   .timed = timed,
                                   .anchored = anchored,
                                   .local = local,
                                   .cellular = cellular,
                                   .trapped = trapped,
                                   .slope = local ? slope_of(c, op, a) : 0,
                                   .value = in_range(c, value),
                                   .low = r.low,
                                   .high = r.high});
}

void sdfc_evaluate(const sdfc *c, const double *params, double time, double *values) {
    for (int i = 0; i < c->expr_count; i++) {
        const sdfc_expr *e = &c->exprs[i];
        switch (e->op) {
        case SDFC_CONST: values[i] = e->value; break;
        case SDFC_PARAM: values[i] = params[e->a[0]]; break;
        case SDFC_TIME: values[i] = time; break;
        case SDFC_ANCHOR: values[i] = 0; break;
        case SDFC_POINT:
        case SDFC_WORLD:
        case SDFC_NORMAL:
        case SDFC_TRAP:
        case SDFC_FOOTPRINT:
        case SDFC_CELL: values[i] = e->value; break; /* operations replace it if it is evaluated */
        default: values[i] = sdfc_run_op(e->op, e->a, values);
        }
    }
}
