/* emit_text.c: the lines common to GLSL and C; see emit.h. Functions that no part uses are not
 * written. */
#include "sdfc/emit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers and operands ---- */

void sdfc_put_number(sdfc_writer *w, double v) {
    char text[40];
    if (v != v) v = 0;
    if (v > 1e30) v = 1e30;
    if (v < -1e30) v = -1e30;
    snprintf(text, sizeof text, w->glsl ? "%.9g" : "%.17g", v);
    bool whole = !strpbrk(text, ".e");
    PUT(w, v < 0 ? "(%s%s)" : "%s%s", text, whole ? ".0" : "");
}

void sdfc_put_operand(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p, int operand) {
    if (operand >= 0) {
        if (operand < 3)
            PUT(w, "%c", 'x' + operand);
        else
            PUT(w, "v%d", operand);
        return;
    }
    int a = ~operand, slot = g->slot_of_arg[a];
    if (slot < 0)
        sdfc_put_number(w, w->c->exprs[p->args[a]].value);
    else
        PUT(w, w->glsl ? "masu_slot(base + %du)" : "slot[base + %du]", slot);
}

/* ---- functions of the library ---- */

static void mark_used(bool *used, int op) {
    if (op <= SDFC_TIME || op >= SDFC_CALL_MIN || used[op]) return;
    used[op] = true;
    if (!sdfc_ops[op].body) return;
    /* Bodies name others as masu_h_NAME; the library has them in the order of their use. */
    for (const char *at = sdfc_ops[op].body; (at = strstr(at, "masu_h_"));) {
        at += 7;
        for (int other = SDFC_TIME + 1; other < op; other++) {
            size_t length = strlen(sdfc_ops[other].name);
            if (strncmp(at, sdfc_ops[other].name, length) == 0 && at[length] == '(') {
                mark_used(used, other);
            }
        }
    }
}

/* The variables that a surface's material depends on; the distance is needed only for the
 * selections. */
static bool *live_variables(sdfc *c, const sdfc_program *p) {
    const sdfc_function *f = &p->functions[p->surface];
    bool *live = sdfc_take(c, (size_t)f->count + 3, sizeof *live);
    for (int k = 0; k < 8; k++) {
        if (p->look[k] >= 0) live[p->look[k]] = true;
    }
    for (int k = f->count; k-- > 0;) {
        const sdfc_instr *i = &f->instrs[k];
        bool calls = i->op == SDFC_CALL_MIN || i->op == SDFC_CALL_NEAREST;
        int count = calls                     ? SDFC_OPERANDS_MAX
                    : i->op == SDFC_CALL_USER ? 3
                                              : sdfc_ops[i->op].operands;
        for (int j = 0; j < count && live[3 + k]; j++) {
            if (i->operand[j] >= 0) live[i->operand[j]] = true;
        }
    }
    return live;
}

/* Which functions of a part are called at all, and which variables of its surface are needed. */
typedef struct liveness {
    bool *functions, *variables;
} liveness;

/* A function calls later ones only. */
static liveness find_live(sdfc *c, const sdfc_program *p) {
    liveness l = {sdfc_take(c, (size_t)p->function_count, 1), NULL};
    if (p->surface) l.variables = live_variables(c, p);
    l.functions[0] = true;
    l.functions[p->surface] = true;
    for (int f = 0; f < p->function_count; f++) {
        bool surface = p->surface && f == p->surface;
        for (int k = 0; k < p->functions[f].count && l.functions[f]; k++) {
            const sdfc_instr *i = &p->functions[f].instrs[k];
            bool calls = i->op == SDFC_CALL_MIN || i->op == SDFC_CALL_NEAREST;
            if (calls && (!surface || l.variables[3 + k])) l.functions[i->aux] = true;
        }
    }
    return l;
}

static void forget(liveness *l) {
    free(l->functions);
    free(l->variables);
}

static void mark_parts(sdfc *c, bool *used) {
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_program *p = &c->parts[c->groups[g].first_part].program;
        liveness live = find_live(c, p);
        for (int f = 0; f < p->function_count; f++) {
            for (int i = 0; i < p->functions[f].count && live.functions[f]; i++) {
                if (p->surface && f == p->surface && !live.variables[3 + i]) continue;
                mark_used(used, p->functions[f].instrs[i].op);
                if (p->functions[f].instrs[i].named == 1) mark_used(used, SDFC_cell_seed);
            }
        }
        forget(&live);
    }
}

static void mark_expressions(const sdfc *c, bool *used) {
    for (int i = 0; i < c->expr_count; i++) {
        if (c->needed[i]) mark_used(used, c->exprs[i].op);
    }
}

static void put_used(sdfc_writer *w, const bool *used, const bool *except) {
    for (int op = SDFC_TIME + 1; op < SDFC_CALL_MIN; op++) {
        const sdfc_op_info *info = &sdfc_ops[op];
        if (!used[op] || except[op] || !info->body) continue;
        PUT(w, "%sreal masu_h_%s%s\n", w->glsl ? "" : "static ", info->name, info->params);
        sdfc_put_bytes(w->c, w->out, info->body, strlen(info->body));
        PUT(w, "\n");
    }
}

void sdfc_put_library(sdfc_writer *w, bool with_expressions) {
    bool used[SDFC_OP_COUNT] = {false}, none[SDFC_OP_COUNT] = {false};
    mark_parts(w->c, used);
    if (with_expressions) mark_expressions(w->c, used);
    put_used(w, used, none);
}

void sdfc_put_update_library(sdfc_writer *w) {
    bool used[SDFC_OP_COUNT] = {false}, parts[SDFC_OP_COUNT] = {false};
    mark_parts(w->c, parts);
    mark_expressions(w->c, used);
    put_used(w, used, parts);
}

/* ---- shapes ---- */

static void put_template(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                         const sdfc_instr *i) {
    for (const char *t = sdfc_ops[i->op].text; *t; t++) {
        if (*t == '$')
            sdfc_put_operand(w, g, p, i->operand[*++t - '0']);
        else
            PUT(w, "%c", *t);
    }
}

static bool is_literal(const sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                       int operand, double value) {
    return operand < 0 && g->slot_of_arg[~operand] < 0 &&
           w->c->exprs[p->args[~operand]].value == value;
}

/* x - 0 and x * 1 with a literal: a shape at the origin, of a form with other shapes elsewhere. */
static bool does_nothing(const sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                         const sdfc_instr *i) {
    return (i->op == SDFC_sub || i->op == SDFC_mul) &&
           is_literal(w, g, p, i->operand[1], i->op == SDFC_mul);
}

/* Most elements of a rotation about an axis, and of a plane across one, are zeros and ones. */
static void put_dot(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                    const sdfc_instr *i) {
    bool any = false;
    for (int k = 0; k < 3; k++) {
        if (is_literal(w, g, p, i->operand[3 + k], 0)) continue;
        PUT(w, any ? " + " : "(");
        sdfc_put_operand(w, g, p, i->operand[k]);
        any = true;
        if (is_literal(w, g, p, i->operand[3 + k], 1)) continue;
        PUT(w, " * ");
        sdfc_put_operand(w, g, p, i->operand[3 + k]);
    }
    PUT(w, any ? ")" : "0.0");
}

/* Whether other cells of a repetition can be skipped by their distance. */
static bool has_reach(const sdfc_writer *w, const sdfc_program *p, const sdfc_instr *i) {
    return w->glsl && i->op == SDFC_CALL_MIN && w->c->exprs[p->args[~i->operand[15]]].value > 0;
}

static void put_bound(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                      const sdfc_instr *i, int variable, int axis, const char *sign,
                      unsigned bits) {
    PUT(w, "            skip |= v%d + MASU_SDF_MARGIN * ", variable);
    sdfc_put_operand(w, g, p, i->operand[17]);
    PUT(w, " < (");
    sdfc_put_operand(w, g, p, i->operand[12 + axis]);
    PUT(w, " %s abs(", sign);
    sdfc_put_operand(w, g, p, i->operand[4 * axis]);
    PUT(w, ")) * ");
    sdfc_put_operand(w, g, p, i->operand[15]);
    PUT(w, " ? %uu : 0u;\n", bits);
}

/* The axes whose neighbour cells are farther than the value of the own cell. If the cells that are
 * not evaluated could matter in the ball, nothing is skipped. */
static void put_skips(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                      const sdfc_instr *i, int variable) {
    PUT(w, "        if (i == 0u) {\n");
    for (int k = 0; k < 3; k++) {
        unsigned bit = i->select[k] ? 1u << (i->select[k] - 1) : 0;
        if (i->bits[k] > 0)
            put_bound(w, g, p, i, variable, k, "-", bit | (i->bits[k] == 2 ? 2 * bit : 0));
        if (i->bits[k] == 2) put_bound(w, g, p, i, variable, k, "+", 2 * bit);
    }
    PUT(w, "        }\n");
}

/* The bits of the terms of a function and of the functions that it calls, which follow it. */
static unsigned bits_of(const sdfc_program *p, int function) {
    const sdfc_function *f = &p->functions[function];
    unsigned bits = 0;
    for (int t = 0; t < f->term_count; t++)
        bits |= f->terms[t].bit >= 0 ? 1u << f->terms[t].bit : 0;
    for (int k = 0; k < f->count; k++) {
        if (f->instrs[k].op == SDFC_CALL_MIN && f->instrs[k].aux > function)
            bits |= bits_of(p, f->instrs[k].aux);
    }
    return bits;
}

/* The cells that a function is called in: those around, then its own by how far its coordinates
 * are folded. */
static void put_inputs(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                       const sdfc_instr *i) {
    for (int k = 0; k < i->around; k++) {
        PUT(w, ", ");
        sdfc_put_operand(w, g, p, i->operand[24 + k]);
    }
    if (!i->named) return;
    if (i->named == 2) {
        PUT(w, w->glsl ? ", (i & 1u) != 0u ? " : ", (i & 1) != 0 ? ");
        sdfc_put_operand(w, g, p, i->operand[19]);
        PUT(w, " : ");
        sdfc_put_operand(w, g, p, i->operand[18]);
        return;
    }
    PUT(w, ", masu_h_cell_seed(");
    for (int k = 0; k < 3; k++) {
        sdfc_put_operand(w, g, p, i->operand[18 + k]);
        PUT(w, ", ");
    }
    PUT(w, "p0, p1, p2");
    for (int k = 0; k < 3; k++) {
        PUT(w, ", ");
        sdfc_put_operand(w, g, p, i->operand[21 + k]);
    }
    PUT(w, ")");
}

static void put_call_min(sdfc_writer *w, int group, const sdfc_group *g, const sdfc_program *p,
                         const sdfc_instr *i, int variable, bool declared) {
    bool skips = has_reach(w, p, i), nearest = i->op == SDFC_CALL_NEAREST;
    if (nearest)
        PUT(w, declared ? "    v%d = 0.0;\n" : "    real v%d = 0.0;\n", variable);
    else
        PUT(w, declared ? "    v%d = 1e30;\n" : "    real v%d = 1e30;\n", variable);
    if (nearest) PUT(w, "    {\n    real least = 1e30;\n");
    if (skips) PUT(w, "    {\n");
    if (skips)
        PUT(w,
            "    uint skip = 0u;\n    uint i = 0u;\n    MASU_LOOP for (uint n = 0u; n < %du; n++) "
            "{\n        if (i >= %du) {\n            break;\n        }\n",
            i->points, i->points);
    else
        PUT(w,
            w->glsl ? "    MASU_LOOP for (uint i = 0u; i < %du; i++) {\n"
                    : "    for (int i = 0; i < %d; i++) {\n",
            i->points);
    for (int k = 0; k < 3; k++) {
        PUT(w, "        real p%d = ", k);
        for (int cell = (1 << i->bits[k]) - 1; cell > 0; cell--) {
            int shift = i->select[k] - 1;
            if (i->bits[k] == 1)
                PUT(w, w->glsl ? "(i & %du) != 0u ? " : "(i & %d) != 0 ? ", 1 << shift);
            else
                PUT(w, w->glsl ? "(i >> %du & 3u) == %du ? " : "(i >> %d & 3) == %d ? ", shift,
                    cell);
            sdfc_put_operand(w, g, p, i->operand[4 * k + cell]);
            PUT(w, " : ");
        }
        sdfc_put_operand(w, g, p, i->operand[4 * k]);
        PUT(w, ";\n");
    }
    if (nearest)
        PUT(w, "        real d = masu_shape_%d_%d(p0, p1, p2, base%s", group, i->aux,
            w->glsl ? ", on" : "");
    else
        PUT(w, "        v%d = min(v%d, masu_shape_%d_%d(p0, p1, p2, base%s", variable, variable,
            group, i->aux, w->glsl ? ", on" : "");
    put_inputs(w, g, p, i);
    if (nearest)
        PUT(w, ");\n        v%d = d < least ? real(i) : v%d;\n        least = min(least, d);\n",
            variable, variable);
    else
        PUT(w, "));\n");
    if (skips) {
        put_skips(w, g, p, i, variable);
        PUT(w, "        i = ((i | skip) + 1u) & ~skip;\n");
    }
    PUT(w, "    }\n");
    if (skips || nearest) PUT(w, "    }\n");
    if (nearest) return;
    unsigned bits = w->glsl && g->term_count ? bits_of(p, i->aux) : 0;
    if (!bits) return;
    PUT(w, "    MASU_KEEP_ALL(v%d + MASU_SDF_MARGIN * ", variable);
    sdfc_put_operand(w, g, p, i->operand[17]);
    PUT(w, " > ");
    sdfc_put_operand(w, g, p, i->operand[16]);
    PUT(w, ", 0x%xu)\n", bits);
}

void sdfc_put_instr(sdfc_writer *w, int group, const sdfc_program *p, const sdfc_instr *i,
                    int variable, bool declared) {
    const sdfc_group *g = &w->c->groups[group];
    if (i->op == SDFC_INPUT) return; /* in the list of parameters */
    if (i->op == SDFC_CALL_MIN || i->op == SDFC_CALL_NEAREST) {
        put_call_min(w, group, g, p, i, variable, declared);
        return;
    }
    PUT(w, declared ? "    v%d = " : "    real v%d = ", variable);
    if (i->op == SDFC_CALL_USER) {
        PUT(w, w->glsl ? "masu_user_%d(vec3(" : "masu_user_%d(", i->aux);
        for (int k = 0; k < 3; k++) {
            sdfc_put_operand(w, g, p, i->operand[k]);
            PUT(w, k < 2 ? ", " : w->glsl ? "))" : ")");
        }
    } else if (i->op == SDFC_NORMAL) {
        PUT(w, w->glsl ? "masu_normal.%c" : "masu_normal['%c' - 'x']", 'x' + i->aux);
    } else if (i->op == SDFC_FOOTPRINT) {
        PUT(w, "masu_footprint");
    } else if (does_nothing(w, g, p, i)) {
        sdfc_put_operand(w, g, p, i->operand[0]);
    } else if (i->op == SDFC_dot3) {
        put_dot(w, g, p, i);
    } else if (sdfc_ops[i->op].text) {
        put_template(w, g, p, i);
    } else {
        PUT(w, "masu_h_%s(", sdfc_ops[i->op].name);
        for (int k = 0; k < sdfc_ops[i->op].operands; k++) {
            if (k) PUT(w, ", ");
            sdfc_put_operand(w, g, p, i->operand[k]);
        }
        PUT(w, ")");
    }
    PUT(w, ";\n");
}

/* ---- terms (terms.c) ---- */

static bool is_open(const sdfc_term *t) { return t->bit >= 0 || t->cap; }

static bool is_declared(const sdfc_function *f, int t) {
    for (int k = f->term_count; k-- > t + 1;) {
        if (is_open(&f->terms[k]) && f->terms[k].last == f->terms[t].last &&
            f->terms[k].first <= f->terms[t].first) {
            return true;
        }
    }
    return false;
}

/* Without the term, its join keeps its previous value, or nothing. Outer terms open first. */
static void open_terms(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                       const sdfc_function *f, int k) {
    for (int t = f->term_count; t-- > 0;) {
        const sdfc_term *term = &f->terms[t];
        if (term->first != k || !is_open(term)) continue;
        PUT(w, is_declared(f, t) ? "    v%d = " : "    real v%d = ", 3 + term->last);
        if (term->opens || term->far)
            PUT(w, term->most ? "(-1e30)" : "1e30");
        else
            sdfc_put_operand(w, g, p, f->instrs[term->last].operand[0]);
        if (!term->cap) {
            PUT(w, ";\n    if ((on & 0x%xu) != 0u) {\n", 1u << term->bit);
            continue;
        }
        PUT(w, ";\n    if (");
        sdfc_put_operand(w, g, p, f->instrs[term->last].operand[0]);
        PUT(w, " > ");
        sdfc_put_operand(w, g, p, term->cap);
        PUT(w, ") {\n");
    }
}

static void close_terms(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p,
                        const sdfc_function *f, int k) {
    for (int t = 0; t < f->term_count; t++) {
        const sdfc_term *term = &f->terms[t];
        if (term->last != k || !is_open(term)) continue;
        if (term->cap) {
            PUT(w, "    }\n");
            continue;
        }
        if (term->opens) {
            PUT(w, "    MASU_KEEP(0x%xu)\n    }\n", 1u << term->bit);
            continue;
        }
        PUT(w, term->most ? "    MASU_KEEP_MOST(" : "    MASU_KEEP_LEAST(");
        sdfc_put_operand(w, g, p, f->instrs[k].operand[0]);
        PUT(w, ", ");
        sdfc_put_operand(w, g, p, f->instrs[k].operand[1]);
        PUT(w, ", ");
        sdfc_put_number(w, term->lipschitz);
        PUT(w, ", ");
        if (term->smooth)
            sdfc_put_operand(w, g, p, term->smooth);
        else
            PUT(w, "0.0");
        PUT(w, ", 0x%xu, 0x%xu)\n    }\n", 1u << term->bit, (unsigned)term->before);
    }
}

static bool ends_term(const sdfc_function *f, int k) {
    for (int t = 0; t < f->term_count; t++) {
        if (f->terms[t].last == k && is_open(&f->terms[t])) return true;
    }
    return false;
}

static void put_function(sdfc_writer *w, int group, const sdfc_program *p, int function,
                         const liveness *live) {
    const sdfc_function *f = &p->functions[function];
    const sdfc_group *g = &w->c->groups[group];
    bool terms = w->glsl, surface = p->surface && function == p->surface, root = function == 0;
    PUT(w, surface ? "%svoid masu_look_%d" : "%sreal masu_shape_%d", w->glsl ? "" : "static ",
        group);
    if (!root && !surface) PUT(w, "_%d", function);
    PUT(w, w->glsl ? "(real x, real y, real z, uint base, uint on"
                   : "(real x, real y, real z, uint base");
    for (int k = 0; k < f->inputs; k++) PUT(w, ", real v%d", 3 + k);
    PUT(w, !surface ? ")\n{\n" : w->glsl ? ", out real look[8])\n{\n" : ", real look[8])\n{\n");
    if (!w->glsl) PUT(w, "    (void)x;\n    (void)y;\n    (void)z;\n    (void)base;\n");
    if (terms && g->term_count) PUT(w, "    uint kept = 0u;\n");
    for (int k = 0; k < f->count; k++) {
        if (surface && !live->variables[3 + k]) continue;
        if (terms) open_terms(w, g, p, f, k);
        sdfc_put_instr(w, group, p, &f->instrs[k], 3 + k, terms && ends_term(f, k));
        if (terms) close_terms(w, g, p, f, k);
    }
    if (terms && g->term_count) PUT(w, "    MASU_KEPT\n");
    for (int k = 0; k < 8 && surface; k++) {
        PUT(w, "    look[%d] = ", k);
        sdfc_put_operand(w, g, p, p->look[k]);
        PUT(w, ";\n");
    }
    if (surface) {
        PUT(w, "}\n\n");
        return;
    }
    PUT(w, "    return ");
    sdfc_put_operand(w, &w->c->groups[group], p, f->result);
    PUT(w, ";\n}\n\n");
}

bool sdfc_group_truth(const sdfc *c, int group) {
    return c->shapes[c->parts[c->groups[group].first_part].shape].facts.truth;
}

/* A function is called by later ones only, but the first is the part's. */
void sdfc_put_shapes(sdfc_writer *w) {
    for (int g = 0; g < w->c->group_count; g++) {
        const sdfc_part *part = &w->c->parts[w->c->groups[g].first_part];
        const sdfc_program *p = &part->program;
        if (!w->glsl && !sdfc_group_truth(w->c, g)) continue;
        PUT(w, "/* %s%s */\n", part->name, w->c->groups[g].part_count > 1 ? " and others" : "");
        liveness live = find_live(w->c, p);
        for (int f = p->function_count; f-- > 0;) {
            if (live.functions[f]) put_function(w, g, p, f, &live);
        }
        forget(&live);
    }
}

void sdfc_put_users(sdfc_writer *w) {
    bool *used = sdfc_take(w->c, (size_t)w->c->user_count, sizeof *used);
    free(w->c->scratch);
    w->c->scratch = used;
    for (int g = 0; g < w->c->group_count; g++) {
        const sdfc_program *p = &w->c->parts[w->c->groups[g].first_part].program;
        for (int f = 0; f < p->function_count; f++) {
            for (int i = 0; i < p->functions[f].count; i++) {
                const sdfc_instr *instr = &p->functions[f].instrs[i];
                if (instr->op == SDFC_CALL_USER) used[instr->aux] = true;
            }
        }
    }
    for (int i = 0; i < w->c->user_count; i++) {
        const sdfc_user *u = &w->c->users[i];
        if (!used[i] || (!w->glsl && !u->has_c)) continue;
        PUT(w,
            w->glsl ? "float masu_user_%d(vec3 p)\n{"
                    : "static double masu_user_%d(double x, double y, double z)\n{",
            i);
        if (!w->glsl) PUT(w, " (void)x; (void)y; (void)z;");
        sdfc_put_bytes(w->c, w->out, w->c->text + (w->glsl ? u->glsl_offset : u->c_offset),
                       w->glsl ? u->glsl_length : u->c_length);
        PUT(w, "\n}\n\n");
    }
}

/* ---- slots that change ---- */

/* Which expressions the GLSL needs as one float, and which as two. Anchor-dependent expressions
 * have large intermediate values and small results, and so do their addends: 1e6 + sin(time) in one
 * float has an error of 0.06. */
enum { ONE_FLOAT = 1, TWO_FLOATS = 2 };

static unsigned char *find_widths(sdfc *c) {
    unsigned char *widths = sdfc_take(c, (size_t)c->expr_count, 1);
    free(c->scratch);
    c->scratch = widths;
    for (int i = 0; i < c->dynamic_count; i++) {
        uint32_t e = c->dynamic_slots[2 * i + 1];
        widths[e] |= c->exprs[e].anchored ? TWO_FLOATS : ONE_FLOAT;
    }
    for (int i = c->expr_count; i-- > 0;) {
        for (int k = 0; k < sdfc_ops[c->exprs[i].op].operands; k++) {
            const sdfc_expr *a = &c->exprs[c->exprs[i].a[k]];
            bool sums = a->op == SDFC_add || a->op == SDFC_sub || a->op == SDFC_mul ||
                        a->op == SDFC_neg || a->anchored;
            if (widths[i] & TWO_FLOATS) {
                widths[c->exprs[i].a[k]] |= sums ? TWO_FLOATS : ONE_FLOAT;
            }
            if (widths[i] & ONE_FLOAT) widths[c->exprs[i].a[k]] |= ONE_FLOAT;
        }
    }
    return widths;
}

static void put_wide(sdfc_writer *w, int e, const unsigned char *widths) {
    const sdfc_expr *x = &w->c->exprs[e];
    if (x->op == SDFC_CONST) {
        double high = (double)(float)x->value;
        PUT(w, "vec2(");
        sdfc_put_number(w, high);
        PUT(w, ", ");
        sdfc_put_number(w, x->value - high);
        PUT(w, ")");
    } else if (widths[e] & TWO_FLOATS) {
        PUT(w, "w%d", e);
    } else {
        PUT(w, "vec2(e%d, 0.0)", e);
    }
}

/* Anchored expressions consist only of these operations (lower.c). */
static void put_wide_expr(sdfc_writer *w, int i, const unsigned char *widths) {
    const sdfc_expr *e = &w->c->exprs[i];
    static const struct {
        int op;
        const char *name;
    } names[] = {{SDFC_add, "masu_wide_add"},
                 {SDFC_sub, "masu_wide_sub"},
                 {SDFC_mul, "masu_wide_mul"},
                 {SDFC_neg, "-"},
                 {SDFC_fold, "masu_wide_fold"}};
    PUT(w, "    vec2 w%d = ", i);
    if (e->op == SDFC_ANCHOR) {
        PUT(w, "vec2(masu_anchor(%d), 0.0);\n", e->a[0]);
        return;
    }
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        if (names[k].op == e->op) PUT(w, "%s(", names[k].name);
    }
    for (int k = 0; k < sdfc_ops[e->op].operands; k++) {
        if (k) PUT(w, ", ");
        put_wide(w, e->a[k], widths);
    }
    PUT(w, ");\n");
}

static void put_expr(sdfc_writer *w, int e) {
    if (sdfc_constant(w->c, e))
        sdfc_put_number(w, w->c->exprs[e].value);
    else
        PUT(w, "e%d", e);
}

void sdfc_put_update(sdfc_writer *w) {
    sdfc *c = w->c;
    const unsigned char *widths = w->glsl ? find_widths(c) : NULL;
    for (int i = 0; i < c->expr_count; i++) {
        const sdfc_expr *e = &c->exprs[i];
        if (!c->needed[i] || e->op == SDFC_CONST) continue;
        if (widths && widths[i] & TWO_FLOATS) put_wide_expr(w, i, widths);
        if (widths && !(widths[i] & ONE_FLOAT)) continue;
        PUT(w, "    real e%d = ", i);
        if (e->op == SDFC_PARAM) {
            PUT(w, "masu_param(%d)", e->a[0]);
        } else if (e->op == SDFC_TIME) {
            PUT(w, "masu_time()");
        } else if (e->op == SDFC_ANCHOR) {
            PUT(w, "0.0"); /* in C: the double-precision reference needs no anchor */
        } else if (sdfc_ops[e->op].text) {
            for (const char *t = sdfc_ops[e->op].text; *t; t++) {
                if (*t == '$')
                    put_expr(w, e->a[*++t - '0']);
                else
                    PUT(w, "%c", *t);
            }
        } else {
            PUT(w, "masu_h_%s(", sdfc_ops[e->op].name);
            for (int k = 0; k < sdfc_ops[e->op].operands; k++) {
                if (k) PUT(w, ", ");
                put_expr(w, e->a[k]);
            }
            PUT(w, ")");
        }
        PUT(w, ";\n");
    }
    for (int i = 0; i < c->dynamic_count; i++) {
        uint32_t slot = c->dynamic_slots[2 * i], e = c->dynamic_slots[2 * i + 1];
        if (w->glsl && c->exprs[e].anchored)
            PUT(w, "    masu_slot_write(%uu, w%u.x + w%u.y);\n", slot, e, e);
        else
            PUT(w, w->glsl ? "    masu_slot_write(%uu, e%u);\n" : "    slot[%u] = e%u;\n", slot, e);
    }
}
