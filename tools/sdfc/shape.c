/* shape.c: shapes as they are written: a name, its arguments by the pattern of kinds.inc,
 * and the shapes that it changes or joins. */
#include "sdfc/internal.h"

#include <string.h>

const sdfc_kind sdfc_kinds[SDFC_KIND_COUNT] = {
#define KIND(id, name, pattern, arguments, meaning, lipschitz, distance) \
    {name, pattern, arguments, meaning, lipschitz, distance},
#include "sdfc/kinds.inc"
#undef KIND
};

static int add_shape(sdfc *c, const sdfc_shape *shape) {
    c->shapes = sdfc_grow(c, c->shapes, c->shape_count, &c->shape_capacity, sizeof *c->shapes,
                          SDFC_SHAPES_MAX, "shapes");
    c->shapes[c->shape_count] = *shape;
    return c->shape_count++;
}

static void set_children(sdfc *c, int shape, const int *children, int count) {
    c->shapes[shape].child = sdfc_take(c, (size_t)count, sizeof *children);
    if (count) memcpy(c->shapes[shape].child, children, (size_t)count * sizeof *children);
    c->shapes[shape].children = count;
}

/* Limits of compile-time integers by kind and index. */
static long whole_most(int kind, int place) {
    switch (kind) {
    case SDFC_KIND_MENGER: return 8;
    case SDFC_KIND_SIERPINSKI: return 12;
    case SDFC_KIND_MANDELBULB:
    case SDFC_KIND_APOLLONIAN:
    case SDFC_KIND_MANDELBOX:
    case SDFC_KIND_JULIA: return 16;
    case SDFC_KIND_TERRAIN: return 12;
    case SDFC_KIND_STAIRS: return 32;
    case SDFC_KIND_NGON:
    case SDFC_KIND_STAR: return 64;
    case SDFC_KIND_POLAR: return SDFC_SECTORS_MAX;
    case SDFC_KIND_KALEIDOSCOPE: return 12;
    default: return place < 0 ? 0 : 1 << 20;
    }
}

/* Digits of a literal argument of masu_param at `at`, which is behind the name; -1: there is
 * none. */
static long literal_index(const char *text, uint32_t at, uint32_t end) {
    long n = 0;
    uint32_t digits = 0;
    while (at < end && text[at] == ' ') at++;
    if (at == end || text[at++] != '(') return -1;
    while (at < end && text[at] == ' ') at++;
    for (; at < end && text[at] >= '0' && text[at] <= '9' && digits < 9; at++, digits++)
        n = 10 * n + (text[at] - '0');
    while (at < end && text[at] == ' ') at++;
    return digits && at < end && text[at] == ')' ? n : -1;
}

static void check_code(sdfc *c, const sdfc_user *user, uint32_t offset, uint32_t length) {
    static const char name[] = "masu_param";
    const uint32_t size = sizeof name - 1;
    for (uint32_t i = 0; i + size <= length; i++) {
        if (memcmp(c->text + offset + i, name, size) != 0) continue;
        long index = literal_index(c->text, offset + i + size, offset + length);
        if (index < c->param_count) continue;
        sdfc_fail(c, user->token, "masu_param(%ld): the scene has %d parameter%s, counted from 0",
                  index, c->param_count, c->param_count == 1 ? "" : "s");
    }
}

void sdfc_check_blocks(sdfc *c) {
    for (int i = 0; i < c->user_count; i++) {
        const sdfc_user user = c->users[i];
        check_code(c, &user, user.glsl_offset, user.glsl_length);
        if (user.has_c) check_code(c, &user, user.c_offset, user.c_length);
    }
}

/* glsl { ... } bounds (low), (high) lipschitz L c { ... } */
static int parse_user(sdfc *c, int token) {
    sdfc_shape s = {.kind = SDFC_KIND_USER, .token = token};
    c->users = sdfc_grow(c, c->users, c->user_count, &c->user_capacity, sizeof *c->users, 4096,
                         "glsl blocks");
    s.user = c->user_count++;
    const sdfc_token *block = &c->tokens[c->at];
    if (block->kind != TOKEN_RAW) sdfc_expected(c, c->at, "a block of GLSL in braces");
    sdfc_user user = {.glsl_offset = block->offset, .glsl_length = block->length,
                      .token = token};
    sdfc_next(c);
    if (!sdfc_word(c, "bounds")) sdfc_expected(c, c->at, "\"bounds\"");
    sdfc_parse_vector(c, s.number);
    sdfc_need_mark(c, ',');
    sdfc_parse_vector(c, s.number + 3);
    if (!sdfc_word(c, "lipschitz")) sdfc_expected(c, c->at, "\"lipschitz\"");
    int at = c->at;
    s.number[6] = sdfc_parse_scalar(c);
    for (int i = 0; i < 7; i++) {
        if (!sdfc_constant(c, s.number[i])) {
            sdfc_fail(c, token, "expected bounds and a constant known at compile time");
        }
    }
    if (!(c->exprs[s.number[6]].value > 0)) {
        sdfc_fail(c, at, "expected a constant above 0, found %g", c->exprs[s.number[6]].value);
    }
    if (sdfc_token_is(c, c->at, "c") && c->tokens[c->at + 1].kind == TOKEN_RAW) {
        sdfc_next(c);
        block = &c->tokens[c->at];
        user.c_offset = block->offset;
        user.c_length = block->length;
        user.has_c = true;
        sdfc_next(c);
    }
    c->users[s.user] = user;
    return add_shape(c, &s);
}

static void parse_argument(sdfc *c, char kind_of, sdfc_shape *s, int *numbers, int *wholes) {
    int v[3];
    switch (kind_of) {
    case 's': s->number[(*numbers)++] = sdfc_parse_scalar(c); break;
    case 'v':
    case 'n':
        sdfc_parse_vector(c, v);
        for (int i = 0; i < 3; i++) s->number[(*numbers)++] = v[i];
        break;
    case 'p':
        sdfc_parse_pair(c, v);
        for (int i = 0; i < 2; i++) s->number[(*numbers)++] = v[i];
        break;
    case 'm':
        s->paint = sdfc_parse_material_name(c);
        break;
    case 'i':
        s->whole[*wholes] = (int)sdfc_parse_whole(c, 1, whole_most(s->kind, *wholes));
        (*wholes)++;
        break;
    case 'c': {
        int token = c->at;
        sdfc_parse_vector(c, v);
        for (int i = 0; i < 3; i++) {
            double n = c->exprs[v[i]].value;
            if (!sdfc_constant(c, v[i]) || n != floor(n) || n < 1 || n > 1 << 20) {
                sdfc_fail(c, token, "expected three whole numbers from 1 to 1048576");
            }
            s->whole[(*wholes)++] = (int)n;
        }
        break;
    }
    default: break;
    }
}

/* "as NAME": the shape can use its cells by that name. */
static void parse_cell_name(sdfc *c, sdfc_shape *s) {
    if (!sdfc_word(c, "as")) return;
    int name = sdfc_need_name(c, "a name", true);
    s->cell = ++c->cells;
    sdfc_symbol *symbol = sdfc_declare(c, name, SYMBOL_CELL);
    symbol->index = s->cell - 1;
    symbol->value.count = s->kind == SDFC_KIND_POLAR ? s->whole[0] : 0;
}

static int parse_call(sdfc *c, int kind, int token) {
    sdfc_shape s = {.kind = kind, .token = token};
    int children[SDFC_CHILDREN_MAX], count = 0, numbers = 0, wholes = 0;
    int around = c->open_kind, symbols = c->symbol_count;
    bool repeats =
        kind == SDFC_KIND_REPEAT || kind == SDFC_KIND_REPEAT_LIMITED || kind == SDFC_KIND_POLAR;
    c->open_kind = kind;
    sdfc_need_mark(c, '(');
    bool first = true;
    for (const char *p = sdfc_kinds[kind].pattern; *p; p++) {
        if (*p == '+') {
            while (sdfc_mark(c, ',')) {
                if (count == SDFC_CHILDREN_MAX) {
                    sdfc_fail(c, c->at, "expected at most %d shapes in one %s", SDFC_CHILDREN_MAX,
                              sdfc_kinds[kind].name);
                }
                children[count++] = sdfc_parse_shape(c);
            }
            continue;
        }
        if (!first) sdfc_need_mark(c, ',');
        first = false;
        if (*p == 'S')
            children[count++] = sdfc_parse_shape(c);
        else
            parse_argument(c, *p, &s, &numbers, &wholes);
        if (repeats && p[1] == 'S') parse_cell_name(c, &s);
    }
    sdfc_need_mark(c, ')');
    c->open_kind = around;
    c->symbol_count = symbols;
    int shape = add_shape(c, &s);
    set_children(c, shape, children, count);
    return shape;
}

int sdfc_parse_shape(sdfc *c) {
    sdfc_enter(c);
    int token = c->at, shape = -1;
    if (c->tokens[token].kind != TOKEN_NAME) sdfc_expected(c, token, "a shape");
    sdfc_next(c);
    for (int kind = 0; kind < SDFC_KIND_COUNT && shape < 0; kind++) {
        if (!sdfc_token_is(c, token, sdfc_kinds[kind].name)) continue;
        shape = kind == SDFC_KIND_USER ? parse_user(c, token) : parse_call(c, kind, token);
        sdfc_analyse(c, shape);
    }
    if (shape < 0) {
        const sdfc_symbol *s = sdfc_find(c, token);
        sdfc_value none;
        bool is_def = s && s->kind == SYMBOL_DEF && c->defs[s->index].is_shape;
        if (!is_def && (!s || s->kind != SYMBOL_SHAPE))
            sdfc_unknown(c, token, SDFC_NAMES_SHAPES, "a shape");
        if (is_def) sdfc_need_mark(c, '(');
        shape = is_def ? sdfc_call_def(c, s->index, token, &none) : s->index;
    }
    sdfc_leave(c);
    return shape;
}

bool masu_sdfc_put_shapes(FILE *to) {
    fputs("# Shapes of the SDF language\n\n"
          "Generated from `tools/sdfc/kinds.inc` by `make docs-tables`. [sdf.md](sdf.md) describes "
          "the language. Primitives are\n"
          "centred at the origin unless noted, and their axis is y. `h` is half the height. Angles "
          "are in radians. Flat shapes\n"
          "have no end along z; `extrude` and `revolve` use the section at z = 0 of any shape.\n\n"
          "The Lipschitz constant bounds the slope of the field. L: the constant of the operand; "
          "largest: the largest constant\n"
          "of the operands. The last column describes the field outside the solid. Exact: it is "
          "the distance. Bound: it is at\n"
          "most the distance. Estimate: it exceeds the distance at less than 1 point in 200. Unit "
          "tests check every shape,\n"
          "with a million pairs of points under `LONG=1`.\n\n"
          "| shape | description | Lipschitz constant | field |\n|---|---|---|---|\n",
          to);
    for (int i = 0; i < SDFC_KIND_COUNT; i++) {
        const sdfc_kind *k = &sdfc_kinds[i];
        if (i == SDFC_KIND_USER) continue;
        fprintf(to, "| `%s(%s)` | %s | %s | %s |\n", k->name, k->arguments, k->meaning,
                k->lipschitz, k->distance);
    }
    return fflush(to) == 0 && !ferror(to);
}
