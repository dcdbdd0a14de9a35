/* parse.c: statements and expressions (the grammar is in docs/sdf.md). A loop is run while it
 * is read: its body's tokens are read once per round, so the rest of the compiler knows no loops.
 * What bounds the work: tokens read, rounds included; depth of nesting; names. */
#include "sdfc/internal.h"

#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
#define LOOPS_DEEP 8

/* ---- tokens ---- */

bool sdfc_token_is(const sdfc *c, int token, const char *word) {
    const sdfc_token *t = &c->tokens[token];
    return t->kind == TOKEN_NAME && strlen(word) == t->length &&
           memcmp(c->text + t->offset, word, t->length) == 0;
}

void sdfc_next(sdfc *c) {
    if (++c->work > SDFC_WORK_MAX) {
        sdfc_fail(c, c->at, "expected at most %d tokens with loops expanded", SDFC_WORK_MAX);
    }
    if (c->tokens[c->at].kind != TOKEN_END) c->at++;
}

static bool is_mark(const sdfc *c, char mark) {
    return c->tokens[c->at].kind == TOKEN_MARK && c->tokens[c->at].mark == mark;
}

bool sdfc_mark(sdfc *c, char mark) {
    if (!is_mark(c, mark)) return false;
    sdfc_next(c);
    return true;
}

void sdfc_need_mark(sdfc *c, char mark) {
    if (sdfc_mark(c, mark)) return;
    if (mark == TOKEN_DOTS) sdfc_expected(c, c->at, "\"..\"");
    sdfc_expected(c, c->at, "\"%c\"", mark);
}

bool sdfc_word(sdfc *c, const char *word) {
    if (!sdfc_token_is(c, c->at, word)) return false;
    sdfc_next(c);
    return true;
}

void sdfc_enter(sdfc *c) {
    if (++c->depth > MASU_SDFC_DEPTH_MAX) {
        sdfc_fail(c, c->at, "expected at most %d levels of nesting", MASU_SDFC_DEPTH_MAX);
    }
}

void sdfc_leave(sdfc *c) { c->depth--; }

/* ---- names ---- */

const sdfc_symbol *sdfc_find(sdfc *c, int token) {
    const sdfc_token *t = &c->tokens[token];
    for (int i = c->symbol_count; i-- > 0;) {
        const sdfc_symbol *s = &c->symbols[i];
        if (s->length == t->length &&
            memcmp(c->text + s->offset, c->text + t->offset, t->length) == 0) {
            c->work += (c->symbol_count - i) / 16;
            return s;
        }
    }
    c->work += c->symbol_count / 16;
    return NULL;
}

static bool reserved(const sdfc *c, int token) {
    static const char *const words[] = {
        "param", "let",   "material", "part", "for", "in",   "shape",  "time", "pi",
        "tau",   "glsl",  "c",        "sin",  "cos", "sqrt", "abs",    "min",  "max",
        "mix",   "clamp", "floor",    "mod",  "deg", "hash", "length", NULL};
    for (int i = 0; words[i]; i++) {
        if (sdfc_token_is(c, token, words[i])) return true;
    }
    for (int i = 0; i < SDFC_KIND_COUNT; i++) {
        if (sdfc_token_is(c, token, sdfc_kind_names[i])) return true;
    }
    return false;
}

/* The token of a name; a new one where it is declared. */
static int need_name(sdfc *c, const char *what, bool declared) {
    int token = c->at;
    if (c->tokens[token].kind != TOKEN_NAME) sdfc_expected(c, token, "%s", what);
    if (declared && reserved(c, token)) {
        sdfc_expected(c, token, "%s that is not a keyword", what);
    }
    if (declared && sdfc_find(c, token))
        sdfc_expected(c, token, "%s that is not declared yet", what);
    sdfc_next(c);
    return token;
}

static void copy_name(const sdfc *c, int token, char out[MASU_SDFC_NAME_MAX]) {
    const sdfc_token *t = &c->tokens[token];
    memcpy(out, c->text + t->offset, t->length);
    out[t->length] = '\0';
}

static sdfc_symbol *declare(sdfc *c, int token, sdfc_symbol_kind kind) {
    c->symbols = sdfc_grow(c, c->symbols, c->symbol_count, &c->symbol_capacity, sizeof *c->symbols,
                           SDFC_SYMBOLS_MAX, "names");
    sdfc_symbol *s = &c->symbols[c->symbol_count++];
    *s = (sdfc_symbol){
        .offset = c->tokens[token].offset, .length = c->tokens[token].length, .kind = kind};
    return s;
}

/* ---- expressions ---- */

static sdfc_value scalar(int e) { return (sdfc_value){1, {e, e, e}}; }

static sdfc_value each(sdfc *c, int token, int op, sdfc_value x, sdfc_value y) {
    sdfc_value r = {x.count > y.count ? x.count : y.count, {0, 0, 0}};
    (void)token;
    for (int i = 0; i < r.count; i++) r.e[i] = sdfc_apply(c, op, x.e[i], y.e[i], x.e[i]);
    if (r.count == 1) r.e[1] = r.e[2] = r.e[0];
    return r;
}

static sdfc_value each3(sdfc *c, int op, sdfc_value x, sdfc_value y, sdfc_value z) {
    sdfc_value r = {1, {0, 0, 0}};
    if (x.count == 3 || y.count == 3 || z.count == 3) r.count = 3;
    for (int i = 0; i < r.count; i++) r.e[i] = sdfc_apply(c, op, x.e[i], y.e[i], z.e[i]);
    if (r.count == 1) r.e[1] = r.e[2] = r.e[0];
    return r;
}

static int one(sdfc *c, int token, sdfc_value v) {
    if (v.count != 1) sdfc_fail(c, token, "expected a number, found three numbers");
    return v.e[0];
}

int sdfc_parse_scalar(sdfc *c) {
    int token = c->at;
    return one(c, token, sdfc_parse_expression(c));
}

void sdfc_parse_vector(sdfc *c, int out[3]) {
    sdfc_value v = sdfc_parse_expression(c);
    for (int i = 0; i < 3; i++) out[i] = v.e[i];
}

static double need_constant(sdfc *c, const char *what) {
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
    double value = need_constant(c, "a whole number");
    if (value != floor(value) || value < (double)low || value > (double)high) {
        sdfc_fail(c, token, "expected a whole number from %ld to %ld, found %g", low, high, value);
    }
    return (long)value;
}

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
        a[i] = need_constant(c, "a number");
        if (fabs(a[i]) > 1e15) sdfc_fail(c, token, "expected a number of at most 1e15");
    }
    sdfc_need_mark(c, ')');
    return scalar(sdfc_number(c, mixed(a[0], a[1])));
}

static sdfc_value call_length(sdfc *c) {
    int v[3], sum = 0;
    sdfc_parse_vector(c, v);
    sdfc_need_mark(c, ')');
    for (int i = 0; i < 3; i++) {
        int square = sdfc_apply(c, SDFC_mul, v[i], v[i], 0);
        sum = i ? sdfc_apply(c, SDFC_add, sum, square, 0) : square;
    }
    return scalar(sdfc_apply(c, SDFC_sqrt, sum, 0, 0));
}

static sdfc_value call(sdfc *c, int name) {
    static const struct {
        const char *name;
        int op, count;
    } functions[] = {{"sin", SDFC_sin, 1}, {"cos", SDFC_cos, 1}, {"sqrt", SDFC_sqrt, 1},
                     {"abs", SDFC_abs, 1}, {"min", SDFC_min, 2}, {"max", SDFC_max, 2},
                     {"mix", SDFC_mix, 3}, {"clamp", -1, 3},     {"floor", SDFC_floor, 1},
                     {"mod", SDFC_mod, 2}, {"deg", -2, 1},       {NULL, 0, 0}};
    if (sdfc_token_is(c, name, "hash")) return call_hash(c);
    if (sdfc_token_is(c, name, "length")) return call_length(c);
    int f = 0;
    while (functions[f].name && !sdfc_token_is(c, name, functions[f].name)) f++;
    if (!functions[f].name) {
        sdfc_expected(c, name,
                      "a function (sin, cos, sqrt, abs, min, max, mix, clamp, floor, mod, "
                      "deg, hash, length)");
    }
    sdfc_value a[3];
    for (int i = 0; i < functions[f].count; i++) {
        if (i) sdfc_need_mark(c, ',');
        a[i] = sdfc_parse_expression(c);
    }
    sdfc_need_mark(c, ')');
    switch (functions[f].op) {
    case -1: return each(c, name, SDFC_min, each(c, name, SDFC_max, a[0], a[1]), a[2]);
    case -2: return each(c, name, SDFC_mul, a[0], scalar(sdfc_number(c, PI / 180)));
    default:
        if (functions[f].count == 1) return each(c, name, functions[f].op, a[0], a[0]);
        if (functions[f].count == 2) return each(c, name, functions[f].op, a[0], a[1]);
        return each3(c, functions[f].op, a[0], a[1], a[2]);
    }
}

static sdfc_value named(sdfc *c, int token) {
    if (sdfc_token_is(c, token, "time")) return scalar(sdfc_time_expr(c));
    if (sdfc_token_is(c, token, "pi")) return scalar(sdfc_number(c, PI));
    if (sdfc_token_is(c, token, "tau")) return scalar(sdfc_number(c, 2 * PI));
    const sdfc_symbol *s = sdfc_find(c, token);
    if (!s || s->kind != SYMBOL_LET) sdfc_expected(c, token, "a number");
    return s->value;
}

static sdfc_value primary(sdfc *c) {
    int token = c->at;
    sdfc_value v = {0};
    if (c->tokens[token].kind == TOKEN_NUMBER) {
        sdfc_next(c);
        return scalar(sdfc_number(c, c->tokens[token].number));
    }
    if (c->tokens[token].kind == TOKEN_NAME) {
        sdfc_next(c);
        v = sdfc_mark(c, '(') ? call(c, token) : named(c, token);
    } else if (sdfc_mark(c, '(')) {
        v = sdfc_parse_expression(c);
        if (sdfc_mark(c, ',')) {
            int e[3] = {one(c, token + 1, v), 0, 0};
            e[1] = sdfc_parse_scalar(c);
            sdfc_need_mark(c, ',');
            e[2] = sdfc_parse_scalar(c);
            v = (sdfc_value){3, {e[0], e[1], e[2]}};
        }
        sdfc_need_mark(c, ')');
    } else {
        sdfc_expected(c, token, "a number");
    }
    while (sdfc_mark(c, '.')) {
        static const char *const names[] = {"x", "y", "z"};
        int i = 0;
        while (i < 3 && !sdfc_token_is(c, c->at, names[i])) i++;
        if (i == 3 || v.count != 3) sdfc_expected(c, c->at, "x, y or z of three numbers");
        sdfc_next(c);
        v = scalar(v.e[i]);
    }
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
    sdfc_value r = scalar(sdfc_number(c, 1)), square = base;
    for (int i = (int)fabs(n); i > 0; i >>= 1) {
        if (i & 1) r = each(c, token, SDFC_mul, square, r);
        if (i > 1) square = each(c, token, SDFC_mul, square, square);
    }
    return n < 0 ? each(c, token, SDFC_rcp, r, r) : r;
}

static sdfc_value unary(sdfc *c) {
    int minus = 0;
    int token = c->at;
    while (is_mark(c, '-') || is_mark(c, '+')) {
        minus ^= is_mark(c, '-');
        sdfc_next(c);
    }
    sdfc_value v = power(c);
    return minus ? each(c, token, SDFC_neg, v, v) : v;
}

static sdfc_value term(sdfc *c) {
    sdfc_value v = unary(c);
    for (;;) {
        int token = c->at;
        if (sdfc_mark(c, '*')) {
            v = each(c, token, SDFC_mul, v, unary(c));
        } else if (sdfc_mark(c, '/')) {
            sdfc_value d = unary(c);
            for (int i = 0; i < d.count; i++) {
                if (sdfc_is(c, d.e[i], 0)) sdfc_fail(c, token + 1, "expected a divisor, found 0");
            }
            /* a / b of constants as C rounds it */
            if (v.count == 1 && d.count == 1 && sdfc_constant(c, v.e[0]) &&
                sdfc_constant(c, d.e[0])) {
                v = scalar(sdfc_number(c, c->exprs[v.e[0]].value / c->exprs[d.e[0]].value));
            } else {
                v = each(c, token, SDFC_mul, v, each(c, token, SDFC_rcp, d, d));
            }
        } else {
            return v;
        }
    }
}

sdfc_value sdfc_parse_expression(sdfc *c) {
    sdfc_enter(c);
    sdfc_value v = term(c);
    for (;;) {
        int token = c->at;
        if (sdfc_mark(c, '+')) {
            v = each(c, token, SDFC_add, v, term(c));
        } else if (sdfc_mark(c, '-')) {
            v = each(c, token, SDFC_sub, v, term(c));
        } else {
            break;
        }
    }
    sdfc_leave(c);
    return v;
}

/* ---- statements ---- */

static void parse_param(sdfc *c) {
    int name = need_name(c, "a name", true);
    if (c->loop_depth) sdfc_fail(c, name, "expected parameters outside of loops");
    c->params = sdfc_grow(c, c->params, c->param_count, &c->param_capacity, sizeof *c->params,
                          MASU_SDFC_PARAMS_MAX, "parameters");
    masu_sdfc_param *p = &c->params[c->param_count++];
    copy_name(c, name, p->name);
    sdfc_need_mark(c, '=');
    p->value = need_constant(c, "a number");
    sdfc_need_mark(c, '[');
    int token = c->at;
    p->minimum = need_constant(c, "a number");
    sdfc_need_mark(c, ',');
    p->maximum = need_constant(c, "a number");
    if (!(p->minimum <= p->value && p->value <= p->maximum)) {
        sdfc_fail(c, token, "expected a range that holds %g, found [%g, %g]", p->value, p->minimum,
                  p->maximum);
    }
    sdfc_need_mark(c, ']');
    sdfc_need_mark(c, ';');
    sdfc_symbol *s = declare(c, name, SYMBOL_LET);
    s->value = scalar(sdfc_param_expr(c, c->param_count - 1));
}

static void parse_let(sdfc *c) {
    int name = need_name(c, "a name", true);
    sdfc_need_mark(c, '=');
    sdfc_value v = sdfc_parse_expression(c);
    sdfc_need_mark(c, ';');
    declare(c, name, SYMBOL_LET)->value = v;
}

static void parse_shape_name(sdfc *c) {
    int name = need_name(c, "a name", true);
    sdfc_need_mark(c, '=');
    int shape = sdfc_parse_shape(c);
    sdfc_need_mark(c, ';');
    declare(c, name, SYMBOL_SHAPE)->index = shape;
}

static void parse_material(sdfc *c) {
    int name = need_name(c, "a name", true);
    c->materials = sdfc_grow(c, c->materials, c->material_count, &c->material_capacity,
                             sizeof *c->materials, MASU_SDFC_MATERIALS_MAX, "materials");
    int index = c->material_count++;
    sdfc_material m = {.name = ""};
    copy_name(c, name, m.name);
    int half = sdfc_number(c, 0.5), zero = sdfc_number(c, 0);
    for (int i = 0; i < 8; i++) m.value[i] = i < 4 ? half : zero;
    sdfc_need_mark(c, '{');
    while (!sdfc_mark(c, '}')) {
        if (sdfc_word(c, "albedo")) {
            sdfc_parse_vector(c, m.value);
        } else if (sdfc_word(c, "roughness")) {
            m.value[3] = sdfc_parse_scalar(c);
        } else if (sdfc_word(c, "emissive")) {
            sdfc_parse_vector(c, m.value + 4);
        } else if (sdfc_word(c, "metallic")) {
            m.value[7] = sdfc_parse_scalar(c);
        } else {
            sdfc_expected(c, c->at, "albedo, roughness, metallic, emissive or \"}\"");
        }
        if (!sdfc_mark(c, ';') && !is_mark(c, '}')) sdfc_expected(c, c->at, "\";\" or \"}\"");
    }
    c->materials[index] = m;
    declare(c, name, SYMBOL_MATERIAL)->index = index;
}

static void parse_part(sdfc *c) {
    int name = need_name(c, "a name", false);
    c->parts = sdfc_grow(c, c->parts, c->part_count, &c->part_capacity, sizeof *c->parts,
                         MASU_SDFC_PARTS_MAX, "parts");
    sdfc_part part = {.token = name, .material = -1};
    char base[MASU_SDFC_NAME_MAX];
    copy_name(c, name, base);
    size_t length = strlen(base);
    memcpy(part.name, base, length + 1);
    for (int i = 0; i < c->loop_depth && length < sizeof part.name; i++) {
        int more =
            snprintf(part.name + length, sizeof part.name - length, "_%ld", c->loop_index[i]);
        length += more > 0 ? (size_t)more : 0;
    }
    if (sdfc_mark(c, ':')) {
        int token = need_name(c, "a material", false);
        const sdfc_symbol *s = sdfc_find(c, token);
        if (!s || s->kind != SYMBOL_MATERIAL) sdfc_expected(c, token, "a material");
        part.material = s->index;
    }
    sdfc_need_mark(c, '=');
    part.shape = sdfc_parse_shape(c);
    sdfc_need_mark(c, ';');
    const sdfc_facts *f = &c->shapes[part.shape].facts;
    if (f->size > SDFC_TREE_MAX) {
        sdfc_fail(c, name, "expected a part of at most %d shapes, found %d", SDFC_TREE_MAX,
                  f->size);
    }
    if (f->cost > SDFC_COST_MAX) {
        sdfc_fail(c, name, "expected a part of at most %g operations, found %g", SDFC_COST_MAX,
                  f->cost);
    }
    c->cost += f->cost;
    if (c->cost > SDFC_COST_ALL_MAX) {
        sdfc_fail(c, name, "expected a scene of at most %g operations", SDFC_COST_ALL_MAX);
    }
    c->parts[c->part_count++] = part;
}

static void parse_statements(sdfc *c, bool in_loop);

/* From the "{" to behind its "}". */
static void skip_body(sdfc *c) {
    int depth = 0, open = c->at;
    do {
        if (c->tokens[c->at].kind == TOKEN_END)
            sdfc_fail(c, open, "expected a \"}\" for this \"{\"");
        depth += is_mark(c, '{') ? 1 : is_mark(c, '}') ? -1 : 0;
        sdfc_next(c);
    } while (depth > 0);
}

static void parse_for(sdfc *c) {
    int name = need_name(c, "a name", true);
    if (!sdfc_word(c, "in")) sdfc_expected(c, c->at, "\"in\"");
    long first = sdfc_parse_whole(c, -65536, 65536);
    sdfc_need_mark(c, TOKEN_DOTS);
    long end = sdfc_parse_whole(c, -65536, 65536);
    if (!is_mark(c, '{')) sdfc_expected(c, c->at, "\"{\"");
    if (c->loop_depth >= LOOPS_DEEP) {
        sdfc_fail(c, name, "expected at most %d loops inside each other", LOOPS_DEEP);
    }
    int body = c->at, symbols = c->symbol_count, depth = c->loop_depth++;
    if (first >= end) skip_body(c);
    for (long i = first; i < end; i++) {
        c->at = body;
        c->loop_index[depth] = i;
        declare(c, name, SYMBOL_LET)->value = scalar(sdfc_number(c, (double)i));
        sdfc_need_mark(c, '{');
        parse_statements(c, true);
        sdfc_need_mark(c, '}');
        c->symbol_count = symbols;
    }
    c->loop_depth = depth;
}

static void parse_statements(sdfc *c, bool in_loop) {
    sdfc_enter(c);
    for (;;) {
        if (sdfc_word(c, "part")) {
            parse_part(c);
        } else if (sdfc_word(c, "let")) {
            parse_let(c);
        } else if (sdfc_word(c, "shape")) {
            parse_shape_name(c);
        } else if (sdfc_word(c, "material")) {
            parse_material(c);
        } else if (sdfc_word(c, "param")) {
            parse_param(c);
        } else if (sdfc_word(c, "for")) {
            parse_for(c);
        } else if (in_loop ? is_mark(c, '}') : c->tokens[c->at].kind == TOKEN_END) {
            break;
        } else {
            sdfc_expected(c, c->at, "param, let, shape, material, part or for");
        }
    }
    sdfc_leave(c);
}

/* What no part names stands at the end: grey. */
void sdfc_parse(sdfc *c) {
    parse_statements(c, false);
    if (c->part_count == 0) sdfc_expected(c, c->at, "a part");
    sdfc_check_blocks(c);
    int grey = -1;
    for (int i = 0; i < c->part_count; i++) {
        if (c->parts[i].material >= 0) continue;
        if (grey < 0) {
            c->materials = sdfc_grow(c, c->materials, c->material_count, &c->material_capacity,
                                     sizeof *c->materials, MASU_SDFC_MATERIALS_MAX, "materials");
            grey = c->material_count++;
            sdfc_material m = {.name = "default"};
            for (int k = 0; k < 8; k++) m.value[k] = sdfc_number(c, k < 4 ? 0.5 : 0);
            c->materials[grey] = m;
        }
        c->parts[i].material = grey;
    }
}
