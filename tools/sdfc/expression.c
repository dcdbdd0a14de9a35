/* expression.c: expressions as they are written (the grammar is in docs/sdf.md), and the table
 * of their functions. A value is 1, 2 or 3 numbers. */
#include "sdfc/internal.h"

#include <string.h>

#define PI 3.14159265358979323846

static sdfc_value scalar(int e) { return (sdfc_value){1, {e, e, e}}; }

static int wider(sdfc *c, int token, sdfc_value x, sdfc_value y) {
    if (x.count != y.count && x.count != 1 && y.count != 1) {
        sdfc_fail(c, token, "expected as many numbers on both sides, found %d and %d", x.count,
                  y.count);
    }
    return x.count > y.count ? x.count : y.count;
}

static sdfc_value each3(sdfc *c, int token, int op, sdfc_value x, sdfc_value y, sdfc_value z) {
    sdfc_value r = {wider(c, token, x, y), {0, 0, 0}};
    r.count = wider(c, token, r, z);
    for (int i = 0; i < r.count; i++) r.e[i] = sdfc_apply(c, op, x.e[i], y.e[i], z.e[i]);
    for (int i = r.count; i < 3; i++) r.e[i] = r.e[0];
    return r;
}

static sdfc_value each(sdfc *c, int token, int op, sdfc_value x, sdfc_value y) {
    return each3(c, token, op, x, y, x);
}

static int one(sdfc *c, int token, sdfc_value v) {
    if (v.count != 1) {
        sdfc_fail(c, token, "expected a number, found %s numbers", v.count == 3 ? "three" : "two");
    }
    return v.e[0];
}

int sdfc_parse_scalar(sdfc *c) {
    int token = c->at;
    return one(c, token, sdfc_parse_expression(c));
}

void sdfc_parse_vector(sdfc *c, int out[3]) {
    int token = c->at;
    sdfc_value v = sdfc_parse_expression(c);
    if (v.count == 2) sdfc_fail(c, token, "expected three numbers, found two");
    for (int i = 0; i < 3; i++) out[i] = v.e[i];
}

void sdfc_parse_pair(sdfc *c, int out[2]) {
    int token = c->at;
    sdfc_value v = sdfc_parse_expression(c);
    if (v.count != 2) sdfc_fail(c, token, "expected two numbers in parentheses");
    for (int i = 0; i < 2; i++) out[i] = v.e[i];
}

double sdfc_need_constant(sdfc *c, const char *what) {
    int token = c->at;
    int e = sdfc_parse_scalar(c);
    if (!sdfc_constant(c, e)) {
        sdfc_fail(c, token,
                  "expected %s known at compile time, found an expression of "
                  "parameters or time",
                  what);
    }
    return c->exprs[e].value;
}

long sdfc_parse_whole(sdfc *c, long low, long high) {
    int token = c->at;
    double value = sdfc_need_constant(c, "a whole number");
    if (value != floor(value) || value < (double)low || value > (double)high) {
        sdfc_fail(c, token, "expected a whole number from %ld to %ld, found %g", low, high, value);
    }
    return (long)value;
}

/* ---- functions ---- */

static double mixed(double seed, double channel) {
    uint64_t z = (uint64_t)(int64_t)floor(seed) * 0x9E3779B97F4A7C15u +
                 (uint64_t)(int64_t)floor(channel) * 0xD1B54A32D192ED03u + 0x632BE59BD9B4E019u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 40) / 16777216.0;
}

static sdfc_value call_hash(sdfc *c) {
    double a[2] = {0, 0};
    for (int i = 0; i < 2 && (i == 0 || sdfc_mark(c, ',')); i++) {
        int token = c->at;
        a[i] = sdfc_need_constant(c, "a number");
        if (fabs(a[i]) > 1e15) sdfc_fail(c, token, "expected a number of at most 1e15");
    }
    sdfc_need_mark(c, ')');
    return scalar(sdfc_number(c, mixed(a[0], a[1])));
}

static int number(sdfc *c, double v) { return sdfc_number(c, v); }

static sdfc_value dot(sdfc *c, int token, sdfc_value x, sdfc_value y) {
    int sum = 0, count = wider(c, token, x, y);
    if (count == 1) count = 3; /* a number stands for three */
    for (int i = 0; i < count; i++) {
        int product = sdfc_apply(c, SDFC_mul, x.e[i], y.e[i], 0);
        sum = i ? sdfc_apply(c, SDFC_add, sum, product, 0) : product;
    }
    return scalar(sum);
}

static sdfc_value length(sdfc *c, int token, sdfc_value v) {
    return scalar(sdfc_apply(c, SDFC_sqrt, dot(c, token, v, v).e[0], 0, 0));
}

enum {
    CLAMP = -1,
    DEG = -2,
    EXP = -3,
    LOG = -4,
    ATAN = -5,
    SMOOTHSTEP = -6,
    DOT = -7,
    LENGTH = -8,
    HASH = -9,
    TAN = -10,
    CONSTANT = -11,
    NOISE = -12,
    FBM = -13,
    CHECKER = -14,
    STRIPES = -15
};

static const struct {
    const char *name;
    int op, least, most; /* arguments */
} functions[] = {{"sin", SDFC_sin, 1, 1},
                 {"cos", SDFC_cos, 1, 1},
                 {"tan", TAN, 1, 1},
                 {"atan", ATAN, 1, 2},
                 {"sqrt", SDFC_sqrt, 1, 1},
                 {"exp", EXP, 1, 1},
                 {"log", LOG, 1, 1},
                 {"abs", SDFC_abs, 1, 1},
                 {"sign", SDFC_sign, 1, 1},
                 {"floor", SDFC_floor, 1, 1},
                 {"fract", SDFC_fract, 1, 1},
                 {"min", SDFC_min, 2, 2},
                 {"max", SDFC_max, 2, 2},
                 {"mod", SDFC_mod, 2, 2},
                 {"step", SDFC_step, 2, 2},
                 {"mix", SDFC_mix, 3, 3},
                 {"clamp", CLAMP, 3, 3},
                 {"smoothstep", SMOOTHSTEP, 3, 3},
                 {"dot", DOT, 2, 2},
                 {"length", LENGTH, 1, 1},
                 {"deg", DEG, 1, 1},
                 {"hash", HASH, 1, 2},
                 {"noise", NOISE, 1, 1},
                 {"fbm", FBM, 4, 4},
                 {"checker", CHECKER, 1, 1},
                 {"stripes", STRIPES, 1, 1},
                 {"time", CONSTANT, 0, 0},
                 {"pi", CONSTANT, 0, 0},
                 {"tau", CONSTANT, 0, 0}};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

const char *sdfc_function_name(int i) { return i < FUNCTIONS ? functions[i].name : NULL; }

/* Noise of three numbers. An octave fades out if a pixel covers more than half of its period. */
static int octave(sdfc *c, sdfc_value v, double factor, double turn) {
    int e[3];
    if (v.count == 2) v.e[2] = number(c, 0);
    for (int i = 0; i < 3; i++) {
        e[i] = sdfc_apply(c, SDFC_mul, v.e[i], number(c, factor), 0);
        e[i] = sdfc_apply(c, SDFC_add, e[i], number(c, turn * (i + 1)), 0);
    }
    int n = sdfc_apply(c, SDFC_noise, e[0], e[1], e[2]);
    return sdfc_apply(c, SDFC_mul, n, sdfc_fade(c, e), 0);
}

static sdfc_value call_fbm(sdfc *c, int token, const sdfc_value *a) {
    double octaves = c->exprs[a[1].e[0]].value, gain = 1, factor = 1;
    int sum = number(c, 0);
    for (int i = 1; i < 4; i++) {
        if (a[i].count != 1 || !sdfc_constant(c, a[i].e[0]))
            sdfc_fail(c, token, "fbm: expected constants behind the point");
    }
    if (!(octaves >= 1 && octaves <= 12 && octaves == floor(octaves))) {
        sdfc_fail(c, token, "fbm: expected 1 to 12 octaves, found %g", octaves);
    }
    for (int i = 0; i < (int)octaves; i++) {
        int n = sdfc_apply(c, SDFC_mul, octave(c, a[0], factor, 17.3 * i), number(c, gain), 0);
        sum = sdfc_apply(c, SDFC_add, sum, n, 0);
        gain *= c->exprs[a[2].e[0]].value;
        factor *= c->exprs[a[3].e[0]].value;
    }
    return scalar(sum);
}

/* 0 or 1, and between them the share of a pixel. */
static sdfc_value call_checker(sdfc *c, sdfc_value v) {
    int product = number(c, 1);
    for (int i = 0; i < v.count; i++) {
        int wave = sdfc_apply(c, SDFC_square_wave, v.e[i], sdfc_footprint(c, v.e[i]), 0);
        product = sdfc_apply(c, SDFC_mul, product, wave, 0);
    }
    return scalar(sdfc_apply(c, SDFC_sub, number(c, 0.5),
                             sdfc_apply(c, SDFC_mul, product, number(c, 0.5), 0), 0));
}

static sdfc_value apply(sdfc *c, int name, int f, const sdfc_value *a, int count) {
    switch (functions[f].op) {
    case CLAMP: return each(c, name, SDFC_min, each(c, name, SDFC_max, a[0], a[1]), a[2]);
    case DEG: return each(c, name, SDFC_mul, a[0], scalar(number(c, PI / 180)));
    case TAN: {
        sdfc_value cosine = each(c, name, SDFC_cos, a[0], a[0]);
        return each(c, name, SDFC_mul, each(c, name, SDFC_sin, a[0], a[0]),
                    each(c, name, SDFC_rcp, cosine, cosine));
    }
    case EXP: return each(c, name, SDFC_pow, scalar(number(c, 2.71828182845904523536)), a[0]);
    case LOG: {
        sdfc_value log2 = each(c, name, SDFC_log2, a[0], a[0]);
        return each(c, name, SDFC_mul, log2, scalar(number(c, 0.69314718055994530942)));
    }
    case ATAN: return each(c, name, SDFC_atan2, a[0], count == 2 ? a[1] : scalar(number(c, 1)));
    case SMOOTHSTEP: {
        sdfc_value from = each(c, name, SDFC_sub, a[2], a[0]),
                   whole = each(c, name, SDFC_sub, a[1], a[0]);
        sdfc_value t = each(c, name, SDFC_mul, from, each(c, name, SDFC_rcp, whole, whole));
        t = each(c, name, SDFC_min, each(c, name, SDFC_max, t, scalar(number(c, 0))),
                 scalar(number(c, 1)));
        return each(c, name, SDFC_ease, t, t);
    }
    case DOT: return dot(c, name, a[0], a[1]);
    case LENGTH: return length(c, name, a[0]);
    case NOISE: return scalar(octave(c, a[0], 1, 0));
    case FBM: return call_fbm(c, name, a);
    case CHECKER: return call_checker(c, a[0]);
    case STRIPES: return call_checker(c, scalar(one(c, name, a[0])));
    default:
        return each3(c, name, functions[f].op, a[0], count > 1 ? a[1] : a[0],
                     count > 2 ? a[2] : a[0]);
    }
}

static sdfc_value call(sdfc *c, int name) {
    const sdfc_symbol *s = sdfc_find(c, name);
    if (s && s->kind == SYMBOL_DEF) {
        if (c->defs[s->index].is_shape) sdfc_expected(c, name, "a number");
        sdfc_value v;
        sdfc_call_def(c, s->index, name, &v);
        return v;
    }
    int f = 0, count = 0;
    while (f < FUNCTIONS && !sdfc_token_is(c, name, functions[f].name)) f++;
    if (f == FUNCTIONS || functions[f].op == CONSTANT)
        sdfc_unknown(c, name, SDFC_NAMES_NUMBERS, "a function");
    int kind = c->open_kind;
    c->open_kind = -1;
    if (functions[f].op == HASH) {
        sdfc_value v = call_hash(c);
        c->open_kind = kind;
        return v;
    }
    sdfc_value a[4];
    do {
        if (count == functions[f].most) {
            sdfc_fail(c, c->at, "%s: expected %d argument%s", functions[f].name, functions[f].most,
                      functions[f].most == 1 ? "" : "s");
        }
        a[count++] = sdfc_parse_expression(c);
    } while (sdfc_mark(c, ','));
    if (count < functions[f].least) {
        sdfc_fail(c, c->at, "%s: expected %d arguments, found %d", functions[f].name,
                  functions[f].least, count);
    }
    sdfc_need_mark(c, ')');
    c->open_kind = kind;
    return apply(c, name, f, a, count);
}

static sdfc_value named(sdfc *c, int token) {
    const sdfc_symbol *s = sdfc_find(c, token);
    sdfc_value v;
    if (s && s->kind == SYMBOL_CELL) return sdfc_parse_cell(c, token, s);
    if (sdfc_token_is(c, token, "time")) return scalar(sdfc_time_expr(c));
    if (sdfc_token_is(c, token, "pi")) return scalar(number(c, PI));
    if (sdfc_token_is(c, token, "tau")) return scalar(number(c, 2 * PI));
    if (!s && sdfc_local_name(c, token, &v)) return v;
    if (!s || s->kind != SYMBOL_LET) sdfc_unknown(c, token, SDFC_NAMES_NUMBERS, "a number");
    return s->value;
}

/* .x, .zx, ... */
static sdfc_value components(sdfc *c, sdfc_value v) {
    const sdfc_token *t = &c->tokens[c->at];
    const char *text = c->text + t->offset;
    sdfc_value r = {(int)t->length, {0, 0, 0}};
    bool good = t->kind == TOKEN_NAME && t->length <= 3 && v.count > 1;
    for (uint32_t i = 0; good && i < t->length; i++) {
        int axis = text[i] - 'x';
        good = axis >= 0 && axis < v.count;
        if (good) r.e[i] = v.e[axis];
    }
    if (!good) sdfc_expected(c, c->at, "x, y or z of three numbers");
    for (int i = r.count; i < 3; i++) r.e[i] = r.e[0];
    sdfc_next(c);
    return r;
}

static sdfc_value primary(sdfc *c) {
    int token = c->at;
    sdfc_value v = {0};
    if (c->tokens[token].kind == TOKEN_NUMBER) {
        sdfc_next(c);
        return scalar(number(c, c->tokens[token].number));
    }
    if (c->tokens[token].kind == TOKEN_NAME) {
        sdfc_next(c);
        v = sdfc_mark(c, '(') ? call(c, token) : named(c, token);
    } else if (sdfc_mark(c, '(')) {
        v = sdfc_parse_expression(c);
        if (sdfc_mark(c, ',')) {
            int e[3] = {one(c, token + 1, v), 0, 0}, count = 2;
            e[1] = sdfc_parse_scalar(c);
            e[2] = e[0];
            if (sdfc_mark(c, ',')) e[2] = sdfc_parse_scalar(c), count = 3;
            v = (sdfc_value){count, {e[0], e[1], e[2]}};
        }
        sdfc_need_mark(c, ')');
    } else {
        sdfc_expected(c, token, "a number");
    }
    while (sdfc_mark(c, '.')) v = components(c, v);
    return v;
}

static sdfc_value unary(sdfc *c);

/* Whole powers are products, so that a negative base keeps its meaning. */
static sdfc_value power(sdfc *c) {
    sdfc_value base = primary(c);
    int token = c->at;
    if (!sdfc_mark(c, '^')) return base;
    sdfc_enter(c);
    sdfc_value exponent = unary(c);
    sdfc_leave(c);
    double n = c->exprs[exponent.e[0]].value;
    bool whole = exponent.count == 1 && sdfc_constant(c, exponent.e[0]) && n == floor(n);
    if (!whole || fabs(n) > 64) return each(c, token, SDFC_pow, base, exponent);
    sdfc_value r = scalar(number(c, 1)), square = base;
    for (int i = (int)fabs(n); i > 0; i >>= 1) {
        if (i & 1) r = each(c, token, SDFC_mul, square, r);
        if (i > 1) square = each(c, token, SDFC_mul, square, square);
    }
    return n < 0 ? each(c, token, SDFC_rcp, r, r) : r;
}

static sdfc_value unary(sdfc *c) {
    int minus = 0;
    int token = c->at;
    for (bool any = true; any;) {
        if (sdfc_mark(c, '-'))
            minus ^= 1;
        else
            any = sdfc_mark(c, '+');
    }
    sdfc_value v = power(c);
    return minus ? each(c, token, SDFC_neg, v, v) : v;
}

static sdfc_value divided(sdfc *c, int token, sdfc_value v, sdfc_value d) {
    for (int i = 0; i < d.count; i++) {
        if (sdfc_is(c, d.e[i], 0)) sdfc_fail(c, token + 1, "expected a divisor, found 0");
    }
    /* a / b of constants as C rounds it */
    if (v.count == 1 && d.count == 1 && sdfc_constant(c, v.e[0]) && sdfc_constant(c, d.e[0])) {
        return scalar(number(c, c->exprs[v.e[0]].value / c->exprs[d.e[0]].value));
    }
    return each(c, token, SDFC_mul, v, each(c, token, SDFC_rcp, d, d));
}

static sdfc_value term(sdfc *c) {
    sdfc_value v = unary(c);
    for (;;) {
        int token = c->at;
        if (sdfc_mark(c, '*'))
            v = each(c, token, SDFC_mul, v, unary(c));
        else if (sdfc_mark(c, '/'))
            v = divided(c, token, v, unary(c));
        else
            return v;
    }
}

static sdfc_value sum(sdfc *c) {
    sdfc_value v = term(c);
    for (;;) {
        int token = c->at;
        if (sdfc_mark(c, '+')) {
            v = each(c, token, SDFC_add, v, term(c));
        } else if (sdfc_mark(c, '-')) {
            v = each(c, token, SDFC_sub, v, term(c));
        } else {
            return v;
        }
    }
}

/* 1 where it is true, else 0. */
static sdfc_value compared(sdfc *c) {
    sdfc_value v = sum(c);
    int token = c->at;
    bool less = sdfc_mark(c, '<'), more = !less && sdfc_mark(c, '>');
    if (!less && !more) return v;
    bool equal = sdfc_mark(c, '=');
    sdfc_value w = sum(c);
    sdfc_value r =
        less != equal ? each(c, token, SDFC_less, v, w) : each(c, token, SDFC_less, w, v);
    return equal ? each(c, token, SDFC_sub, scalar(number(c, 1)), r) : r;
}

sdfc_value sdfc_parse_expression(sdfc *c) {
    sdfc_enter(c);
    sdfc_value v = compared(c);
    int token = c->at;
    if (sdfc_mark(c, '?')) {
        sdfc_value yes = sdfc_parse_expression(c);
        sdfc_need_mark(c, ':');
        v = each3(c, token, SDFC_select, v, yes, sdfc_parse_expression(c));
    }
    sdfc_leave(c);
    return v;
}
