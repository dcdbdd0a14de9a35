/* parse.c: statements (the grammar is in docs/sdf.md). A loop runs during parsing: its body's
 * tokens are read once per iteration, so the later stages have no loops. Limits on the work: tokens
 * read, iterations included; nesting depth; names. */
#include "sdfc/internal.h"

#include <stdio.h>
#include <string.h>

#define LOOPS_DEEP 8

/* ---- tokens ---- */

bool sdfc_token_is(const sdfc *c, int token, const char *word) {
    const sdfc_token *t = &c->tokens[token];
    return t->kind == TOKEN_NAME && strlen(word) == t->length &&
           memcmp(c->text + t->offset, word, t->length) == 0;
}

void sdfc_next(sdfc *c) {
    if (++c->work > SDFC_WORK_MAX) {
        c->in_statement = false;
        sdfc_fail(c, c->at, "expected at most %d tokens with loops expanded", SDFC_WORK_MAX);
    }
    if (c->tokens[c->at].kind != TOKEN_END) c->at++;
}

bool sdfc_is_mark(const sdfc *c, char mark) {
    return c->tokens[c->at].kind == TOKEN_MARK && c->tokens[c->at].mark == mark;
}

bool sdfc_mark(sdfc *c, char mark) {
    if (!sdfc_is_mark(c, mark)) return false;
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
        if (i >= c->hidden_from && i < c->hidden_to) continue;
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
    static const char *const words[] = {"param", "let", "material", "part", "for",  "in",
                                        "shape", "def", "include",  "as",   "glsl", "time",
                                        "pi",    "tau", NULL};
    for (int i = 0; words[i]; i++) {
        if (sdfc_token_is(c, token, words[i])) return true;
    }
    return false;
}

/* Whether a function or a shape has this name. Numbers and materials can have it too, because they
 * are not called. */
static bool is_called(const sdfc *c, int token) {
    const char *function;
    for (int i = 0; (function = sdfc_function_name(i)); i++) {
        if (sdfc_token_is(c, token, function)) return true;
    }
    for (int i = 0; i < SDFC_KIND_COUNT; i++) {
        if (sdfc_token_is(c, token, sdfc_kinds[i].name)) return true;
    }
    return false;
}

/* The token of a name; a new one where it is declared. */
int sdfc_need_name(sdfc *c, const char *what, bool declared) {
    int token = c->at;
    if (c->tokens[token].kind != TOKEN_NAME) sdfc_expected(c, token, "%s", what);
    if (declared && reserved(c, token)) {
        sdfc_expected(c, token, "%s that is not a keyword", what);
    }
    const sdfc_symbol *known = declared ? sdfc_find(c, token) : NULL;
    if (known && known->kind != SYMBOL_BROKEN)
        sdfc_expected(c, token, "%s that is not declared yet", what);
    sdfc_next(c);
    return token;
}

int sdfc_need_shape_name(sdfc *c) {
    if (is_called(c, c->at)) sdfc_expected(c, c->at, "a name that no shape or function has");
    return sdfc_need_name(c, "a name", true);
}

static void copy_name(const sdfc *c, int token, char out[MASU_SDFC_NAME_MAX]) {
    const sdfc_token *t = &c->tokens[token];
    memcpy(out, c->text + t->offset, t->length);
    out[t->length] = '\0';
}

sdfc_symbol *sdfc_declare(sdfc *c, int token, sdfc_symbol_kind kind) {
    c->symbols = sdfc_grow(c, c->symbols, c->symbol_count, &c->symbol_capacity, sizeof *c->symbols,
                           SDFC_SYMBOLS_MAX, "names");
    sdfc_symbol *s = &c->symbols[c->symbol_count++];
    *s = (sdfc_symbol){
        .offset = c->tokens[token].offset, .length = c->tokens[token].length, .kind = kind};
    return s;
}

/* ---- statements ---- */

static void parse_param(sdfc *c) {
    int name = sdfc_need_name(c, "a name", true);
    if (c->loop_depth) sdfc_fail(c, name, "expected parameters outside of loops");
    c->params = sdfc_grow(c, c->params, c->param_count, &c->param_capacity, sizeof *c->params,
                          MASU_SDFC_PARAMS_MAX, "parameters");
    masu_sdfc_param *p = &c->params[c->param_count++];
    copy_name(c, name, p->name);
    sdfc_need_mark(c, '=');
    p->value = sdfc_need_constant(c, "a number");
    sdfc_need_mark(c, '[');
    int token = c->at;
    p->minimum = sdfc_need_constant(c, "a number");
    sdfc_need_mark(c, ',');
    p->maximum = sdfc_need_constant(c, "a number");
    if (!(p->minimum <= p->value && p->value <= p->maximum)) {
        sdfc_fail(c, token, "expected a range that holds %g, found [%g, %g]", p->value, p->minimum,
                  p->maximum);
    }
    sdfc_need_mark(c, ']');
    sdfc_need_mark(c, ';');
    sdfc_symbol *s = sdfc_declare(c, name, SYMBOL_LET);
    int e = sdfc_param_expr(c, c->param_count - 1);
    s->value = (sdfc_value){1, {e, e, e}};
}

static void parse_let(sdfc *c) {
    int name = sdfc_need_name(c, "a name", true);
    sdfc_need_mark(c, '=');
    sdfc_value v = sdfc_parse_expression(c);
    sdfc_need_mark(c, ';');
    sdfc_declare(c, name, SYMBOL_LET)->value = v;
}

static void parse_shape_name(sdfc *c) {
    int name = sdfc_need_shape_name(c);
    sdfc_need_mark(c, '=');
    int shape = sdfc_parse_shape(c);
    sdfc_need_mark(c, ';');
    sdfc_declare(c, name, SYMBOL_SHAPE)->index = shape;
}

static void parse_material(sdfc *c) {
    int name = sdfc_need_name(c, "a name", true);
    c->materials = sdfc_grow(c, c->materials, c->material_count, &c->material_capacity,
                             sizeof *c->materials, MASU_SDFC_MATERIALS_MAX, "materials");
    int index = c->material_count++;
    sdfc_material m = {.name = ""};
    copy_name(c, name, m.name);
    int half = sdfc_number(c, 0.5), zero = sdfc_number(c, 0);
    for (int i = 0; i < 8; i++) m.value[i] = i < 4 ? half : zero;
    sdfc_need_mark(c, '{');
    c->in_material = true;
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
        if (!sdfc_mark(c, ';') && !sdfc_is_mark(c, '}')) sdfc_expected(c, c->at, "\";\" or \"}\"");
    }
    c->in_material = false;
    for (int i = 0; i < MASU_SDFC_MATERIAL_SLOTS; i++) {
        m.local = m.local || c->exprs[m.value[i]].local;
        m.cellular = m.cellular || c->exprs[m.value[i]].cellular;
    }
    c->materials[index] = m;
    sdfc_declare(c, name, SYMBOL_MATERIAL)->index = index;
}

int sdfc_parse_material_name(sdfc *c) {
    int token = sdfc_need_name(c, "a material", false);
    const sdfc_symbol *s = sdfc_find(c, token);
    if (!s || s->kind != SYMBOL_MATERIAL)
        sdfc_unknown(c, token, SDFC_NAMES_MATERIALS, "a material");
    return s->index;
}

static void parse_part(sdfc *c) {
    int name = sdfc_need_name(c, "a name", false);
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
        part.material = sdfc_parse_material_name(c);
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

static void parse_statements(sdfc *c);

/* From the "{" to behind its "}". */
static void skip_body(sdfc *c) {
    int depth = 0, open = c->at;
    do {
        if (c->tokens[c->at].kind == TOKEN_END)
            sdfc_fail(c, open, "expected a \"}\" for this \"{\"");
        depth += sdfc_is_mark(c, '{') ? 1 : sdfc_is_mark(c, '}') ? -1 : 0;
        sdfc_next(c);
    } while (depth > 0);
}

static void parse_for(sdfc *c) {
    int name = sdfc_need_name(c, "a name", true);
    if (!sdfc_word(c, "in")) sdfc_expected(c, c->at, "\"in\"");
    long first = sdfc_parse_whole(c, -65536, 65536);
    sdfc_need_mark(c, TOKEN_DOTS);
    long end = sdfc_parse_whole(c, -65536, 65536);
    if (!sdfc_is_mark(c, '{')) sdfc_expected(c, c->at, "\"{\"");
    if (c->loop_depth >= LOOPS_DEEP) {
        sdfc_fail(c, name, "expected at most %d loops inside each other", LOOPS_DEEP);
    }
    int body = c->at, symbols = c->symbol_count, depth = c->loop_depth++;
    if (first >= end) skip_body(c);
    for (long i = first; i < end; i++) {
        c->at = body;
        c->loop_index[depth] = i;
        int e = sdfc_number(c, (double)i);
        sdfc_declare(c, name, SYMBOL_LET)->value = (sdfc_value){1, {e, e, e}};
        sdfc_need_mark(c, '{');
        parse_statements(c);
        sdfc_need_mark(c, '}');
        c->symbol_count = symbols;
    }
    c->loop_depth = depth;
}

static bool parse_statement(sdfc *c) {
    if (sdfc_word(c, "part"))
        parse_part(c);
    else if (sdfc_word(c, "let"))
        parse_let(c);
    else if (sdfc_word(c, "shape"))
        parse_shape_name(c);
    else if (sdfc_word(c, "def"))
        sdfc_parse_def(c);
    else if (sdfc_word(c, "material"))
        parse_material(c);
    else if (sdfc_word(c, "param"))
        parse_param(c);
    else if (sdfc_word(c, "for"))
        parse_for(c);
    else
        return false;
    return true;
}

static SDFC_NORETURN void no_statement(sdfc *c) {
    sdfc_expected(c, c->at, "param, let, shape, def, material, part or for");
}

static void parse_statements(sdfc *c) {
    sdfc_enter(c);
    while (!sdfc_is_mark(c, '}')) {
        if (!parse_statement(c)) no_statement(c);
    }
    sdfc_leave(c);
}

static bool begins_statement(const sdfc *c, int token) {
    static const char *const words[] = {"part", "let", "shape", "def", "material", "param", "for"};
    if (token > 0 && c->tokens[token].line == c->tokens[token - 1].line) return false;
    for (int i = 0; i < 7; i++) {
        if (sdfc_token_is(c, token, words[i])) return true;
    }
    return false;
}

/* Behind the statement that begins at `first`: at its ";" or "}", or before a line that begins
 * another. */
static void skip_statement(sdfc *c, int first) {
    int depth = 0, at = first;
    bool block = sdfc_token_is(c, first, "for") || sdfc_token_is(c, first, "material");
    for (; c->tokens[at].kind != TOKEN_END; at++) {
        if (at > first && depth <= 0 && begins_statement(c, at)) break;
        char mark = c->tokens[at].kind == TOKEN_MARK ? c->tokens[at].mark : ' ';
        depth += mark == '{' ? 1 : mark == '}' ? -1 : 0;
        if ((mark == ';' && depth <= 0) || (mark == '}' && depth <= 0 && block)) {
            at++;
            break;
        }
    }
    c->at = at;
}

/* Marks the name that the statement at `first` would have declared as erroneous. */
static void recover(sdfc *c, int first, int symbols) {
    enum { ERRORS_MAX = 16 };
    int name = first + 1 < c->token_count ? first + 1 : first;
    c->depth = c->loop_depth = 0;
    c->symbol_count = symbols;
    c->hidden_from = c->hidden_to = 0;
    c->open_kind = c->call_token = -1;
    c->in_material = false;
    if (++c->errors >= ERRORS_MAX) longjmp(c->failed, 1);
    if (c->tokens[name].kind == TOKEN_NAME && !reserved(c, name) && !sdfc_find(c, name)) {
        sdfc_declare(c, name, SYMBOL_BROKEN);
    }
    skip_statement(c, first);
}

static void parse_whole_text(sdfc *c) {
    while (c->tokens[c->at].kind != TOKEN_END) {
        c->first_token = c->at;
        c->first_symbol = c->symbol_count;
        if (setjmp(c->statement)) {
            recover(c, c->first_token, c->first_symbol);
            continue;
        }
        c->in_statement = true;
        if (!parse_statement(c)) no_statement(c);
        c->in_statement = false;
    }
    c->in_statement = false;
}

/* Parts without a material get a grey default, the last material. */
void sdfc_parse(sdfc *c) {
    c->open_kind = c->call_token = -1;
    parse_whole_text(c);
    if (c->errors) longjmp(c->failed, 1);
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
