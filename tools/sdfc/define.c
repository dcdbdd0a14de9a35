/* define.c: names that need an expansion: def with arguments (the body is parsed again at each
 * call), the local variables of materials, and the cells of a repetition. */
#include "sdfc/internal.h"

#include <string.h>

/* ---- def ---- */

bool sdfc_begins_shape(sdfc *c) {
    if (c->tokens[c->at].kind != TOKEN_NAME) return false;
    bool opens = c->tokens[c->at + 1].kind == TOKEN_MARK && c->tokens[c->at + 1].mark == '(';
    for (int kind = 0; kind < SDFC_KIND_COUNT; kind++) {
        if (sdfc_token_is(c, c->at, sdfc_kinds[kind].name)) return opens || kind == SDFC_KIND_USER;
    }
    const sdfc_symbol *s = sdfc_find(c, c->at);
    return s && (s->kind == SYMBOL_SHAPE || (s->kind == SYMBOL_DEF && c->defs[s->index].is_shape));
}

static void skip_to(sdfc *c, const char *ends) {
    int depth = 0, from = c->at;
    for (;; sdfc_next(c)) {
        const sdfc_token *t = &c->tokens[c->at];
        if (t->kind == TOKEN_END) sdfc_fail(c, from, "expected a \"%c\" behind this", ends[0]);
        if (t->kind != TOKEN_MARK) continue;
        if (depth == 0 && strchr(ends, t->mark)) return;
        depth += t->mark == '(' ? 1 : t->mark == ')' ? -1 : 0;
    }
}

/* The first token of the body decides whether the def is a shape: a shape, or a def of a shape. */
void sdfc_parse_def(sdfc *c) {
    int name = sdfc_need_shape_name(c);
    sdfc_def d = {.symbols = c->symbol_count};
    sdfc_need_mark(c, '(');
    for (bool more = !sdfc_mark(c, ')'); more;) {
        if (d.count == SDFC_ARGUMENTS_MAX)
            sdfc_fail(c, c->at, "expected at most %d arguments", SDFC_ARGUMENTS_MAX);
        d.argument[d.count] = sdfc_need_name(c, "an argument", true);
        if (sdfc_mark(c, '=')) {
            d.fallback[d.count] = c->at;
            skip_to(c, ",)");
        }
        d.count++;
        more = sdfc_mark(c, ',');
        if (!more) sdfc_need_mark(c, ')');
    }
    sdfc_need_mark(c, '=');
    d.body = c->at;
    d.is_shape = sdfc_begins_shape(c);
    skip_to(c, ";");
    sdfc_need_mark(c, ';');
    c->defs = sdfc_grow(c, c->defs, c->def_count, &c->def_capacity, sizeof *c->defs,
                        SDFC_SYMBOLS_MAX, "defs");
    c->defs[c->def_count] = d;
    sdfc_declare(c, name, SYMBOL_DEF)->index = c->def_count++;
}

typedef struct given {
    bool is_shape;
    int shape;
    sdfc_value value;
} given;

static given parse_given(sdfc *c) {
    given g = {.is_shape = sdfc_begins_shape(c)};
    if (g.is_shape)
        g.shape = sdfc_parse_shape(c);
    else
        g.value = sdfc_parse_expression(c);
    return g;
}

static void declare_given(sdfc *c, int token, const given *g) {
    sdfc_symbol *s = sdfc_declare(c, token, g->is_shape ? SYMBOL_SHAPE : SYMBOL_LET);
    if (g->is_shape)
        s->index = g->shape;
    else
        s->value = g->value;
}

/* The "(" has been read. The body can use names declared before the def, and its arguments. */
int sdfc_call_def(sdfc *c, int def, int token, sdfc_value *v) {
    const sdfc_def d = c->defs[def];
    given arguments[SDFC_ARGUMENTS_MAX];
    int count = 0, kind = c->open_kind;
    sdfc_enter(c);
    c->open_kind = -1;
    for (bool more = !sdfc_mark(c, ')'); more;) {
        if (count == d.count)
            sdfc_fail(c, c->at, "expected %d argument%s", d.count, d.count == 1 ? "" : "s");
        arguments[count++] = parse_given(c);
        more = sdfc_mark(c, ',');
        if (!more) sdfc_need_mark(c, ')');
    }
    int after = c->at, symbols = c->symbol_count, from = c->hidden_from, to = c->hidden_to,
        caller = c->call_token;
    c->hidden_from = d.symbols;
    c->hidden_to = symbols;
    if (caller < 0) c->call_token = token;
    for (int i = 0; i < d.count; i++) {
        if (i >= count) {
            if (!d.fallback[i]) {
                const sdfc_token *t = &c->tokens[d.argument[i]];
                sdfc_fail(c, token, "expected %d arguments, found %d: \"%.*s\" has no default",
                          d.count, count, (int)t->length, c->text + t->offset);
            }
            c->at = d.fallback[i];
            arguments[i] = parse_given(c);
        }
        declare_given(c, d.argument[i], &arguments[i]);
    }
    int shape = -1;
    c->at = d.body;
    if (d.is_shape)
        shape = sdfc_parse_shape(c);
    else
        *v = sdfc_parse_expression(c);
    sdfc_need_mark(c, ';');
    c->at = after;
    c->symbol_count = symbols;
    c->hidden_from = from;
    c->hidden_to = to;
    c->call_token = caller;
    c->open_kind = kind;
    sdfc_leave(c);
    return shape;
}

/* ---- local variables of materials ---- */

bool sdfc_local_name(sdfc *c, int token, sdfc_value *v) {
    static const struct {
        const char *name;
        int op, count;
        double most;
    } names[] = {{"p", SDFC_POINT, 3, SDFC_INFINITY},
                 {"world", SDFC_WORLD, 3, SDFC_INFINITY},
                 {"n", SDFC_NORMAL, 3, 1},
                 {"trap", SDFC_TRAP, 3, 1e6},
                 {"px", SDFC_FOOTPRINT, 1, SDFC_INFINITY}};
    if (!c->in_material) return false;
    if (sdfc_token_is(c, token, "cell")) {
        const sdfc_symbol innermost = {.kind = SYMBOL_CELL, .index = -1};
        *v = sdfc_parse_cell(c, token, &innermost);
        return true;
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (!sdfc_token_is(c, token, names[i].name)) continue;
        bool positive = names[i].op == SDFC_TRAP || names[i].op == SDFC_FOOTPRINT;
        for (int k = 0; k < 3; k++) {
            v->e[k] = k < names[i].count ? sdfc_leaf(c, names[i].op, k, 0,
                                                     positive ? 0 : -names[i].most, names[i].most)
                                         : v->e[0];
        }
        v->count = names[i].count;
        return true;
    }
    return false;
}

sdfc_value sdfc_parse_cell(sdfc *c, int token, const sdfc_symbol *s) {
    int index = s->index, sectors = index < 0 ? SDFC_SECTORS_MAX : s->value.count;
    (void)token;
    bool dot = sdfc_mark(c, '.');
    if (dot && sectors && sdfc_word(c, "index")) {
        int e = sdfc_leaf(c, SDFC_CELL, index, -1, 0, sectors - 1);
        return (sdfc_value){1, {e, e, e}};
    }
    if (!dot || !sdfc_word(c, "hash")) {
        sdfc_expected(c, c->at,
                      sectors ? "\".index\", or \".hash(\", a number and \")\""
                              : "\".hash(\", a number and \")\"");
    }
    sdfc_need_mark(c, '(');
    int channel = (int)sdfc_parse_whole(c, 0, 1000);
    sdfc_need_mark(c, ')');
    int e = sdfc_leaf(c, SDFC_CELL, index, channel, 0, 1);
    return (sdfc_value){1, {e, e, e}};
}
