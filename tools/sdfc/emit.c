/* emit.c: operations -> text. GLSL and C differ in how a slot is read and in what surrounds the
 * functions; the functions themselves are the same lines. What no part uses is not written. */
#include "sdfc/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct writer {
    sdfc *c;
    sdfc_text *out;
    bool glsl;
} writer;

#define PUT(w, ...) sdfc_put((w)->c, (w)->out, __VA_ARGS__)

/* ---- numbers and operands ---- */

static void put_number(writer *w, double v) {
    char text[40];
    if (v != v) v = 0;
    if (v > 1e30) v = 1e30;
    if (v < -1e30) v = -1e30;
    snprintf(text, sizeof text, w->glsl ? "%.9g" : "%.17g", v);
    bool whole = !strpbrk(text, ".e");
    PUT(w, v < 0 ? "(%s%s)" : "%s%s", text, whole ? ".0" : "");
}

static void put_operand(writer *w, const sdfc_group *g, const sdfc_program *p, int operand) {
    if (operand >= 0) {
        if (operand < 3)
            PUT(w, "%c", 'x' + operand);
        else
            PUT(w, "v%d", operand);
        return;
    }
    int a = ~operand, slot = g->slot_of_arg[a];
    if (slot < 0)
        put_number(w, w->c->exprs[p->args[a]].value);
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

static void put_library(writer *w, bool with_expressions) {
    bool used[SDFC_OP_COUNT] = {false};
    for (int g = 0; g < w->c->group_count; g++) {
        const sdfc_program *p = &w->c->parts[w->c->groups[g].first_part].program;
        for (int f = 0; f < p->function_count; f++) {
            for (int i = 0; i < p->functions[f].count; i++) {
                mark_used(used, p->functions[f].instrs[i].op);
            }
        }
    }
    if (with_expressions) {
        for (int i = 0; i < w->c->expr_count; i++) {
            if (w->c->needed[i]) mark_used(used, w->c->exprs[i].op);
        }
    }
    for (int op = SDFC_TIME + 1; op < SDFC_CALL_MIN; op++) {
        const sdfc_op_info *info = &sdfc_ops[op];
        if (!used[op] || !info->body) continue;
        PUT(w, "%sreal masu_h_%s%s\n", w->glsl ? "" : "static ", info->name, info->params);
        sdfc_put_bytes(w->c, w->out, info->body, strlen(info->body));
        PUT(w, "\n");
    }
}

/* ---- shapes ---- */

static void put_template(writer *w, const sdfc_group *g, const sdfc_program *p,
                         const sdfc_instr *i) {
    for (const char *t = sdfc_ops[i->op].text; *t; t++) {
        if (*t == '$')
            put_operand(w, g, p, i->operand[*++t - '0']);
        else
            PUT(w, "%c", *t);
    }
}

/* x - 0 and x * 1 with a literal: the shape that stands at the origin beside others that do not. */
static bool does_nothing(const writer *w, const sdfc_group *g, const sdfc_program *p,
                         const sdfc_instr *i) {
    if (i->op != SDFC_sub && i->op != SDFC_mul) return false;
    if (i->operand[1] >= 0 || g->slot_of_arg[~i->operand[1]] >= 0) return false;
    return w->c->exprs[p->args[~i->operand[1]]].value == (i->op == SDFC_mul ? 1 : 0);
}

static void put_call_min(writer *w, int group, const sdfc_group *g, const sdfc_program *p,
                         const sdfc_instr *i, int variable) {
    PUT(w, "    real v%d = 1e30;\n    for (int i = 0; i < %d; i++) {\n", variable, i->points);
    for (int k = 0; k < 3; k++) {
        PUT(w, "        real p%d = ", k);
        if (i->select[k]) {
            PUT(w, "(i & %d) != 0 ? ", 1 << (i->select[k] - 1));
            put_operand(w, g, p, i->operand[2 * k + 1]);
            PUT(w, " : ");
        }
        put_operand(w, g, p, i->operand[2 * k]);
        PUT(w, ";\n");
    }
    PUT(w, "        v%d = min(v%d, masu_shape_%d_%d(p0, p1, p2, base));\n    }\n", variable,
        variable, group, i->aux);
}

static void put_instr(writer *w, int group, const sdfc_program *p, const sdfc_instr *i,
                      int variable) {
    const sdfc_group *g = &w->c->groups[group];
    if (i->op == SDFC_CALL_MIN) {
        put_call_min(w, group, g, p, i, variable);
        return;
    }
    PUT(w, "    real v%d = ", variable);
    if (i->op == SDFC_CALL_USER) {
        PUT(w, w->glsl ? "masu_user_%d(vec3(" : "masu_user_%d(", i->aux);
        for (int k = 0; k < 3; k++) {
            put_operand(w, g, p, i->operand[k]);
            PUT(w, k < 2 ? ", " : w->glsl ? "))" : ")");
        }
    } else if (does_nothing(w, g, p, i)) {
        put_operand(w, g, p, i->operand[0]);
    } else if (sdfc_ops[i->op].text) {
        put_template(w, g, p, i);
    } else {
        PUT(w, "masu_h_%s(", sdfc_ops[i->op].name);
        for (int k = 0; k < sdfc_ops[i->op].operands; k++) {
            if (k) PUT(w, ", ");
            put_operand(w, g, p, i->operand[k]);
        }
        PUT(w, ")");
    }
    PUT(w, ";\n");
}

static void put_function(writer *w, int group, const sdfc_program *p, int function, bool root) {
    const sdfc_function *f = &p->functions[function];
    PUT(w, "%sreal masu_shape_%d", w->glsl ? "" : "static ", group);
    if (!root) PUT(w, "_%d", function);
    PUT(w, "(real x, real y, real z, uint base)\n{\n");
    if (!w->glsl) PUT(w, "    (void)base;\n");
    for (int k = 0; k < f->count; k++) put_instr(w, group, p, &f->instrs[k], 3 + k);
    PUT(w, "    return ");
    put_operand(w, &w->c->groups[group], p, f->result);
    PUT(w, ";\n}\n\n");
}

static bool group_truth(const sdfc *c, int group) {
    return c->shapes[c->parts[c->groups[group].first_part].shape].facts.truth;
}

/* A function is called by later ones only, but the first is the part's. */
static void put_shapes(writer *w) {
    for (int g = 0; g < w->c->group_count; g++) {
        const sdfc_part *part = &w->c->parts[w->c->groups[g].first_part];
        const sdfc_program *p = &part->program;
        if (!w->glsl && !group_truth(w->c, g)) continue;
        PUT(w, "/* %s%s */\n", part->name, w->c->groups[g].part_count > 1 ? " and others" : "");
        for (int f = p->function_count; f-- > 0;) put_function(w, g, p, f, f == 0);
    }
}

static void put_users(writer *w) {
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

static void find_needed(sdfc *c) {
    c->needed = sdfc_take(c, (size_t)c->expr_count, sizeof *c->needed);
    for (int i = 0; i < c->dynamic_count; i++) c->needed[c->dynamic_slots[2 * i + 1]] = true;
    for (int i = c->expr_count; i-- > 0;) {
        if (!c->needed[i]) continue;
        int op = c->exprs[i].op;
        for (int k = 0; k < sdfc_ops[op].operands; k++) c->needed[c->exprs[i].a[k]] = true;
    }
}

static bool any_timed(const sdfc *c) {
    for (int i = 0; i < c->dynamic_count; i++) {
        if (c->exprs[c->dynamic_slots[2 * i + 1]].timed) return true;
    }
    return false;
}

/* Which expressions the GLSL needs as one float, which as two. What depends on the anchor is large
 * before it is small, and so is what it is added to: 1e6 + sin(time) in one float is off by 0.06. */
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

static void put_wide(writer *w, int e, const unsigned char *widths) {
    const sdfc_expr *x = &w->c->exprs[e];
    if (x->op == SDFC_CONST) {
        double high = (double)(float)x->value;
        PUT(w, "vec2(");
        put_number(w, high);
        PUT(w, ", ");
        put_number(w, x->value - high);
        PUT(w, ")");
    } else if (widths[e] & TWO_FLOATS) {
        PUT(w, "w%d", e);
    } else {
        PUT(w, "vec2(e%d, 0.0)", e);
    }
}

/* Anchored expressions are made of these operations only (lower.c). */
static void put_wide_expr(writer *w, int i, const unsigned char *widths) {
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

static void put_expr(writer *w, int e) {
    if (sdfc_constant(w->c, e))
        put_number(w, w->c->exprs[e].value);
    else
        PUT(w, "e%d", e);
}

static void put_update(writer *w) {
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
            PUT(w, "0.0"); /* in C: the truth needs no anchor */
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

/* ---- GLSL ---- */

/* "float NAME = f / L;" of a part of group g, whose number is in `part` where the group has several. */
static void put_part_value(writer *w, int g, const char *name, const char *point) {
    const sdfc *c = w->c;
    const sdfc_group *group = &c->groups[g];
    if (group->part_count == 1) {
        PUT(w, "        float %s = masu_shape_%d(%s.x, %s.y, %s.z, %uu)", name, g, point, point, point,
            c->parts[group->first_part].slot_base);
        double safe = c->initial[group->first_part * MASU_SDFC_PART_SLOTS + 4];
        if (safe != 1) {
            PUT(w, " * ");
            put_number(w, safe);
        }
        PUT(w, ";\n");
        return;
    }
    PUT(w, "        uint record = part * %uu;\n", MASU_SDFC_PART_SLOTS);
    PUT(w, "        uint base = uint(masu_slot(record + 6u));\n");
    PUT(w,
        "        float %s = masu_shape_%d(%s.x, %s.y, %s.z, base) * masu_slot(record + 4u);\n", name,
        g, point, point, point);
}

/* How fast a half-space's field changes along d: its operations without what they add. */
static void put_slope(writer *w, int group) {
    const sdfc_group *g = &w->c->groups[group];
    const sdfc_program *p = &w->c->parts[g->first_part].program;
    const sdfc_function *f = &p->functions[0];
    PUT(w, "float masu_slope_%d(float x, float y, float z, uint base)\n{\n", group);
    for (int k = 0; k < f->count; k++) {
        const sdfc_instr *i = &f->instrs[k];
        if (i->op == SDFC_sub) {
            PUT(w, "    float v%d = ", 3 + k);
            put_operand(w, g, p, i->operand[0]);
            PUT(w, ";\n");
        } else {
            put_instr(w, group, p, i, 3 + k);
        }
    }
    PUT(w, "    return ");
    put_operand(w, g, p, f->result);
    PUT(w, ";\n}\n\n");
}

static void put_slot_base(writer *w, int g) {
    const sdfc_group *group = &w->c->groups[g];
    if (group->part_count == 1)
        PUT(w, "%uu", w->c->parts[group->first_part].slot_base);
    else
        PUT(w, "uint(masu_slot(part * %uu + 6u))", MASU_SDFC_PART_SLOTS);
}

/* Half-spaces along a ray, and their normals. No part has a field that is not a number. */
static void put_flat(writer *w) {
    const sdfc *c = w->c;
    for (int g = 0; g < c->group_count; g++) {
        if (c->groups[g].flat) put_slope(w, g);
    }
    PUT(w, "float masu_sdf_flat(vec3 o, vec3 d, float start, out uint nearest)\n{\n"
           "    float first = 1e30;\n    nearest = %uu;\n",
        (unsigned)(c->part_count - c->flat_parts));
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!group->flat) continue;
        PUT(w, "    for (uint part = %du; part < %du; part++) {\n", group->first_part,
            group->first_part + group->part_count);
        PUT(w, "        float h = masu_shape_%d(o.x, o.y, o.z, ", g);
        put_slot_base(w, g);
        PUT(w, ");\n        float slope = masu_slope_%d(d.x, d.y, d.z, ", g);
        put_slot_base(w, g);
        PUT(w, ");\n"
               "        float t = h + slope * start <= 0.0 ? start : slope < 0.0 ? -h / slope : 1e30;\n"
               "        nearest = t < first ? part : nearest;\n"
               "        first = t < first ? t : first;\n    }\n");
    }
    PUT(w, "    return first;\n}\n\n"
           "vec3 masu_sdf_flat_normal(uint part)\n{\n    vec3 n = vec3(0.0);\n");
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!group->flat) continue;
        PUT(w, "    if (part >= %du) {\n        n = vec3(", group->first_part);
        for (int k = 0; k < 3; k++) {
            PUT(w, "masu_slope_%d(%d.0, %d.0, %d.0, ", g, k == 0, k == 1, k == 2);
            put_slot_base(w, g);
            PUT(w, k < 2 ? "), " : "));\n    }\n");
        }
    }
    PUT(w, "    return n;\n}\n\n");
}

/* The box around the listed parts. */
static void put_box(writer *w) {
    const sdfc *c = w->c;
    PUT(w, "void masu_sdf_box(out vec3 low, out vec3 high)\n{\n");
    for (int side = 0; side < 2; side++) {
        PUT(w, side ? "    high = vec3(" : "    low = vec3(");
        for (int axis = 0; axis < 3; axis++) {
            int e = c->box[side][axis];
            if (axis) PUT(w, ", ");
            if (c->box_slot[side][axis])
                PUT(w, "masu_slot(%uu)", c->box_slot[side][axis]);
            else
                put_number(w, e >= 0 ? c->exprs[e].value : side ? 1e30 : -1e30);
        }
        PUT(w, ");\n");
    }
    PUT(w, "}\n\n");
}

static void put_glsl_dispatch(writer *w) {
    sdfc *c = w->c;
    PUT(w, "float masu_sdf_part(uint part, vec3 p)\n{\n");
    if (c->part_count == 1) {
        PUT(w, "    return masu_shape_0(p.x, p.y, p.z, %uu)", c->parts[0].slot_base);
        if (c->initial[4] != 1) {
            PUT(w, " * ");
            put_number(w, c->initial[4]);
        }
        PUT(w, ";\n}\n\n");
        return;
    }
    PUT(w, "    uint record = part * %uu;\n", MASU_SDFC_PART_SLOTS);
    PUT(w, "    float safe = masu_slot(record + 4u);\n");
    PUT(w, "    uint base = uint(masu_slot(record + 6u));\n");
    if (c->group_count == 1) {
        PUT(w, "    return masu_shape_0(p.x, p.y, p.z, base) * safe;\n}\n\n");
        return;
    }
    PUT(w, "    float d = 1e30;\n    switch (uint(masu_slot(record + 5u))) {\n");
    for (int g = 0; g < c->group_count; g++) {
        PUT(w, "    case %du: d = masu_shape_%d(p.x, p.y, p.z, base); break;\n", g, g);
    }
    PUT(w, "    }\n    return d * safe;\n}\n\n");
}

static void put_head(writer *w) {
    PUT(w, "float masu_sdf_with(vec3 p, out uint nearest)\n{\n    float d = 1e30;\n"
           "    nearest = 0u;\n");
}

/* A part whose field is NaN is not there. */
static void put_least(writer *w) {
    PUT(w, "        nearest = f < d ? part : nearest;\n        d = f < d ? f : d;\n");
}

/* The half-spaces count always, unless the includer meets them in closed form. */
static void put_flat_least(writer *w) {
    const sdfc *c = w->c;
    if (!c->flat_parts) return;
    PUT(w, "#ifndef MASU_SDF_NO_FLAT\n");
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!group->flat) continue;
        PUT(w, "    for (uint part = %du; part < %du; part++) {\n", group->first_part,
            group->first_part + group->part_count);
        put_part_value(w, g, "f", "p");
        put_least(w);
        PUT(w, "    }\n");
    }
    PUT(w, "#endif\n");
}

static void put_any_order(writer *w) {
    if (w->c->part_count == 1 && !w->c->flat_parts) {
        PUT(w, "float masu_sdf_with(vec3 p, out uint nearest)\n{\n    nearest = 0u;\n"
               "    float f = masu_part_count() > 0u ? masu_sdf_part(0u, p) : 1e30;\n"
               "    return f < 1e30 ? f : 1e30;\n}\n");
        return;
    }
    put_head(w);
    PUT(w, "    uint count = masu_part_count();\n"
           "    MASU_LOOP for (uint i = 0u; i < uint(MASU_SDF_LISTED_COUNT); i++) {\n"
           "        if (i >= count) {\n            break;\n        }\n"
           "        uint part = masu_part_at(i);\n        float f = masu_sdf_part(part, p);\n");
    put_least(w);
    PUT(w, "    }\n");
    put_flat_least(w);
    PUT(w, "    return d;\n}\n");
}

/* A part alone of its form. */
static void put_only_part(writer *w, int g) {
    PUT(w, "    {\n");
    put_part_value(w, g, "f", "p");
    PUT(w, "        const uint part = %du;\n", w->c->groups[g].first_part);
    put_least(w);
    PUT(w, "    }\n");
}

/* Whether a tile that sees one of two parts nearly always sees both: each one's sphere holds the middle
 * of the other's, well inside. */
static bool share_a_place(const sdfc *c, int g, int h) {
    const sdfc_part *p = &c->parts[c->groups[g].first_part], *q = &c->parts[c->groups[h].first_part];
    const sdfc_facts *e = &c->shapes[p->shape].facts, *f = &c->shapes[q->shape].facts;
    if (p->moves || q->moves || !isfinite(e->radius) || !isfinite(f->radius)) return false;
    double distance = hypot(hypot(e->center[0] - f->center[0], e->center[1] - f->center[1]),
                            e->center[2] - f->center[2]);
    return distance < 0.5 * fmin(e->radius, f->radius);
}

/* Parts that are alone of their form and share a place are asked for together and evaluated one after
 * the other: what they have in common, an angle around one axis for one, is then computed once.
 * Wrong turn: one question for each part. In a tunnel of polar rings no tile leaves any out, and each
 * had an arc tangent of its own: 1.4 times the time of the march. */
static void put_place(writer *w, int g, bool *put) {
    const sdfc *c = w->c;
    uint32_t bits[MASU_SDFC_MASKED_MAX / 32] = {0};
    bool alone = c->part_count - c->flat_parts == 1;
    for (int h = g; h < c->group_count; h++) {
        const sdfc_group *group = &c->groups[h];
        if (group->flat || group->part_count > 1 || put[h]) continue;
        put[h] = h == g || share_a_place(c, g, h);
        if (put[h]) bits[group->first_part / 32] |= 1u << group->first_part % 32;
    }
    if (alone) {
        put_only_part(w, g);
        return;
    }
    PUT(w, "    if (");
    for (int word = 0, some = 0; word < MASU_SDFC_MASKED_MAX / 32; word++) {
        if (!bits[word]) continue;
        PUT(w, "%s(masu_part_bits(%d) & 0x%xu) != 0u", some++ ? " || " : "", word, bits[word]);
    }
    PUT(w, ") {\n");
    for (int h = g; h < c->group_count; h++) {
        int part = c->groups[h].first_part;
        if (c->groups[h].part_count > 1 || !(bits[part / 32] >> part % 32 & 1u)) continue;
        put_only_part(w, h);
    }
    PUT(w, "    }\n");
}

/* The parts of a form of several are found bit by bit. Wrong turn: lists of numbers in memory for a few
 * parts as well. On lavapipe each lane fetches by itself, which cost more than the parts' own
 * arithmetic. */
static void put_masked_group(writer *w, int g) {
    const sdfc_group *group = &w->c->groups[g];
    int first = group->first_part, end = first + group->part_count;
    for (int word = first / 32; word * 32 < end; word++) {
        int low = first > word * 32 ? first - word * 32 : 0;
        int high = end < word * 32 + 32 ? end - word * 32 : 32;
        uint32_t own = (high == 32 ? 0xFFFFFFFFu : (1u << high) - 1u) & ~((1u << low) - 1u);
        PUT(w,
            "    MASU_LOOP for (uint n = 0u, bits = masu_part_bits(%d) & 0x%xu; n < %du; n++) {\n",
            word, own, high - low);
        PUT(w,
            "        if (bits == 0u) {\n            break;\n        }\n"
            "        uint part = %du + masu_low_bit(bits);\n        bits &= bits - 1u;\n",
            word * 32);
        put_part_value(w, g, "f", "p");
        put_least(w);
        PUT(w, "    }\n");
    }
}

static void put_listed_group(writer *w, int g) {
    const sdfc *c = w->c;
    const sdfc_group *group = &c->groups[g];
    int end = group->first_part + group->part_count;
    PUT(w, "    MASU_LOOP for (uint n = 0u; n < %du; n++) {\n", group->part_count);
    PUT(w, "        if (i >= count) {\n            break;\n        }\n"
           "        uint part = masu_part_at(i);\n");
    if (end < c->part_count - c->flat_parts) {
        PUT(w, "        if (part >= %du) {\n            break;\n        }\n", end);
    }
    put_part_value(w, g, "f", "p");
    put_least(w);
    PUT(w, "        i++;\n    }\n");
}

/* One loop per form: where a driver runs all arms of a switch and masks what they write, a part then
 * costs its own form and not all of them. Needs a list in rising order, or bits. */
static void put_ascending(writer *w) {
    const sdfc *c = w->c;
    bool masked = c->part_count <= MASU_SDFC_MASKED_MAX, put[MASU_SDFC_MASKED_MAX] = {false};
    put_head(w);
    if (!masked) PUT(w, "    uint count = masu_part_count();\n    uint i = 0u;\n");
    for (int g = 0; g < c->group_count; g++) {
        if (c->groups[g].flat) continue;
        if (!masked)
            put_listed_group(w, g);
        else if (c->groups[g].part_count > 1)
            put_masked_group(w, g);
        else if (!put[g])
            put_place(w, g, put);
    }
    put_flat_least(w);
    PUT(w, "    return d;\n}\n");
}

/* ---- GLSL: the root transforms ---- */

/* One step, inwards or outwards. The rows of a turn are orthonormal: its transpose undoes it. */
static void put_root_step(writer *w, int group, const sdfc_root_step *step, bool out) {
    const sdfc_group *g = &w->c->groups[group];
    const sdfc_program *p = &w->c->parts[g->first_part].program;
    bool turn = step->kind == SDFC_KIND_ROTATE;
    PUT(w, "        p = ");
    if (!turn) PUT(w, step->kind == SDFC_KIND_SCALE ? "p * " : out ? "p + " : "p - ");
    PUT(w, "vec3(");
    for (int i = 0; i < 3; i++) {
        if (i) PUT(w, ", ");
        if (turn) {
            PUT(w, "dot(p, vec3(");
            for (int k = 0; k < 3; k++) {
                if (k) PUT(w, ", ");
                put_operand(w, g, p, ~step->arg[out ? 3 * k + i : 3 * i + k]);
            }
            PUT(w, "))");
        } else {
            bool invert = step->kind == SDFC_KIND_SCALE && out;
            if (invert) PUT(w, "masu_rcp(");
            put_operand(w, g, p, ~step->arg[i]);
            if (invert) PUT(w, ")");
        }
    }
    PUT(w, ");\n");
}

/* From the world into a part's own space, and out of it: the movements, turns and scalings that
 * stand around all else in the part. Of parts where these do not change: nothing. */
static void put_roots(writer *w) {
    sdfc *c = w->c;
    PUT(w, "#ifdef MASU_MOTION\nvec3 masu_sdf_root(uint part, vec3 p, bool out_of)\n{\n");
    PUT(w, "    uint record = part * %uu;\n", MASU_SDFC_PART_SLOTS);
    PUT(w, "    uint form = uint(masu_slot(record + 5u));\n");
    PUT(w, "    uint base = uint(masu_slot(record + 6u));\n");
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_program *p = &c->parts[c->groups[g].first_part].program;
        if (!c->groups[g].moves) continue;
        PUT(w, "    if (form == %du && !out_of) {\n", g);
        for (int i = 0; i < p->root_count; i++) put_root_step(w, g, &p->root[i], false);
        PUT(w, "    }\n    if (form == %du && out_of) {\n", g);
        for (int i = p->root_count; i-- > 0;) put_root_step(w, g, &p->root[i], true);
        PUT(w, "    }\n");
    }
    PUT(w, "    return p;\n}\n#endif\n\n");
}

/* One slot of those that depend on the anchor alone; their constants are slots themselves. */
static void put_places(writer *w) {
    PUT(w,
        "#define MASU_SDF_PLACES %d\n"
        "void masu_sdf_place(uint i)\n{\n"
        "    uint at = %uu + i * %uu;\n"
        "    vec2 v = vec2(masu_slot(at + 7u), masu_slot(at + 8u));\n"
        "    for (int k = 0; k < 3; k++) {\n"
        "        uint factor = at + 1u + 2u * uint(k);\n"
        "        vec2 m = vec2(masu_slot(factor), masu_slot(factor + 1u));\n"
        "        v = masu_wide_add(v, masu_wide_mul(m, vec2(masu_anchor(k), 0.0)));\n"
        "    }\n"
        "    if (masu_slot(at + 11u) != 0.0) {\n"
        "        vec2 period = vec2(masu_slot(at + 9u), masu_slot(at + 10u));\n"
        "        v = masu_wide_fold(v, period, vec2(masu_slot(at + 11u), 0.0));\n"
        "    }\n"
        "    masu_slot_write(uint(masu_slot(at)), v.x + v.y);\n}\n",
        w->c->place_count, w->c->place_base, SDFC_PLACE_SLOTS);
}

static void put_glsl(writer *w) {
    sdfc *c = w->c;
    PUT(w, "/* Made by masu-sdfc: %d parts of %d forms. */\n", c->part_count, c->group_count);
    PUT(w, "#ifndef MASU_LOOP\n#define MASU_LOOP /* an includer's [[dont_unroll]] */\n#endif\n");
    PUT(w, "#define MASU_SDF_PART_COUNT %d\n", c->part_count);
    PUT(w, "#define MASU_SDF_LISTED_COUNT %d /* the rest are half-spaces */\n",
        c->part_count - c->flat_parts);
    PUT(w, "#define MASU_SDF_MASKED %d /* 1: lists of parts are bits */\n",
        c->part_count <= MASU_SDFC_MASKED_MAX);
    PUT(w, "#define MASU_SDF_SLOT_COUNT %u\n", c->slot_count);
    PUT(w, "#define MASU_SDF_DYNAMIC %d\n\n", any_timed(c));
    put_users(w);
    PUT(w, "#define real float\n#define TO_INT(x) int(x)\n");
    put_library(w, false);
    PUT(w, "\n");
    put_shapes(w);
    put_glsl_dispatch(w);
    PUT(w,
        "vec4 masu_sdf_bounds(uint part)\n{\n"
        "    uint record = part * %uu;\n"
        "    return vec4(masu_slot(record), masu_slot(record + 1u), masu_slot(record + 2u),\n"
        "                masu_slot(record + 3u));\n}\n\n",
        MASU_SDFC_PART_SLOTS);
    put_box(w);
    put_roots(w);
    PUT(w, "#ifdef MASU_SDF_ASCENDING\n");
    put_ascending(w);
    PUT(w, "#else\n");
    put_any_order(w);
    PUT(w, "#endif\n\n"
           "float masu_sdf(vec3 p)\n{\n    uint part;\n    return masu_sdf_with(p, part);\n}\n\n"
           "uint masu_sdf_nearest(vec3 p)\n{\n    uint part;\n    masu_sdf_with(p, part);\n"
           "    return part;\n}\n\n");
    put_flat(w);
    PUT(w,
        "void masu_sdf_part_surface(uint part, vec3 p, inout masu_surface s)\n{\n"
        "    uint material = uint(masu_slot(part * %uu + 7u));\n"
        "    uint at = %uu + material * %uu;\n"
        "    s.albedo = vec3(masu_slot(at), masu_slot(at + 1u), masu_slot(at + 2u));\n"
        "    s.roughness = masu_slot(at + 3u);\n"
        "    s.emissive = vec3(masu_slot(at + 4u), masu_slot(at + 5u), masu_slot(at + 6u));\n"
        "    s.metallic = masu_slot(at + 7u);\n}\n\n"
        "void masu_sdf_surface(vec3 p, inout masu_surface s)\n{\n"
        "    masu_sdf_part_surface(masu_sdf_nearest(p), p, s);\n}\n\n",
        MASU_SDFC_PART_SLOTS, (unsigned)c->part_count * MASU_SDFC_PART_SLOTS,
        MASU_SDFC_MATERIAL_SLOTS);
    PUT(w, "#ifdef MASU_SDF_SETUP\n");
    bool has_mod = false;
    for (int i = 0; i < c->expr_count; i++) {
        has_mod = has_mod || (c->needed[i] && c->exprs[i].op == SDFC_mod);
    }
    if (has_mod) {
        PUT(w, "real masu_h_mod%s\n%s\n", sdfc_ops[SDFC_mod].params, sdfc_ops[SDFC_mod].body);
    }
    if (c->place_count) put_places(w);
    PUT(w, "void masu_sdf_update()\n{\n");
    put_update(w);
    PUT(w, "}\n#endif\n#undef real\n#undef TO_INT\n");
}

/* ---- C ---- */

static void put_c_field(writer *w) {
    sdfc *c = w->c;
    PUT(w,
        "static double field(int part, const double p[3])\n{\n"
        "    uint base = (uint)slot[part * %u + 6];\n"
        "    switch ((int)slot[part * %u + 5]) {\n",
        MASU_SDFC_PART_SLOTS, MASU_SDFC_PART_SLOTS);
    for (int g = 0; g < c->group_count; g++) {
        if (!group_truth(c, g)) continue;
        PUT(w, "    case %d: return masu_shape_%d(p[0], p[1], p[2], base);\n", g, g);
    }
    PUT(w, "    default: return INFINITY;\n    }\n}\n\n");
}

static const char c_api[] =
    "static int nearest(const double *params, double time, const double p[3], double *step,\n"
    "                   double *distance)\n"
    "{\n"
    "    int part = -1;\n"
    "    *step = *distance = INFINITY;\n"
    "    update(params, time);\n"
    "    for (int i = 0; i < PARTS; i++) {\n"
    "        double f = field(i, p);\n"
    "        if (f < *distance) *distance = f;\n"
    "        if (f / lipschitz[i] < *step) {\n"
    "            *step = f / lipschitz[i];\n"
    "            part = i;\n"
    "        }\n"
    "    }\n"
    "    return part;\n"
    "}\n\n"
    "const int masu_truth_part_count = PARTS;\n\n"
    "double masu_truth_distance(const double *params, double time, const double p[3])\n"
    "{\n"
    "    double step, distance;\n"
    "    nearest(params, time, p, &step, &distance);\n"
    "    return distance;\n"
    "}\n\n"
    "/* one part's field; INFINITY where it has no C */\n"
    "double masu_truth_part_distance(const double *params, double time, const double p[3],\n"
    "                                int part)\n"
    "{\n"
    "    if (part < 0 || part >= PARTS) return INFINITY;\n"
    "    update(params, time);\n"
    "    return field(part, p);\n"
    "}\n\n"
    "double masu_truth_step(const double *params, double time, const double p[3])\n"
    "{\n"
    "    double step, distance;\n"
    "    nearest(params, time, p, &step, &distance);\n"
    "    return step;\n"
    "}\n\n"
    "int masu_truth_part(const double *params, double time, const double p[3])\n"
    "{\n"
    "    double step, distance;\n"
    "    return nearest(params, time, p, &step, &distance);\n"
    "}\n\n"
    "/* albedo, roughness, emissive, metallic, as of the last call above in this thread */\n"
    "void masu_truth_material(int part, double out[8])\n"
    "{\n"
    "    if (part < 0 || part >= PARTS) part = 0;\n"
    "    if (!ready) memcpy(slot, initial, sizeof slot);\n"
    "    ready = 1;\n"
    "    memcpy(out, slot + MATERIALS + 8 * (int)slot[part * 8 + 7], 8 * sizeof *out);\n"
    "}\n";

static void put_c(writer *w) {
    sdfc *c = w->c;
    PUT(w, "/* Made by masu-sdfc: the distance in double precision. */\n"
           "#include <math.h>\n#include <stdint.h>\n#include <string.h>\n\n");
    PUT(w, "#define PARTS %d\n#define MATERIALS %d\n#define PARAMS %d\n\n", c->part_count,
        c->part_count * MASU_SDFC_PART_SLOTS, c->param_count);
    PUT(w, "static const double initial[%u] = {", c->slot_count);
    for (uint32_t i = 0; i < c->slot_count; i++) {
        PUT(w, i % 8 ? " " : "\n    ");
        put_number(w, c->initial[i]);
        PUT(w, ",");
    }
    PUT(w, "\n};\nstatic const double lipschitz[PARTS] = {");
    for (int i = 0; i < c->part_count; i++) {
        PUT(w, i % 8 ? " " : "\n    ");
        put_number(w, c->shapes[c->parts[i].shape].facts.lipschitz);
        PUT(w, ",");
    }
    PUT(w, "\n};\nstatic _Thread_local double slot[%u];\n", c->slot_count);
    PUT(w, "static _Thread_local double now[PARAMS + 1]; /* parameters and time of the slots */\n"
           "static _Thread_local int ready;\n\n"
           "static double masu_param(int i) { return now[i]; }\n"
           "static double masu_time(void) { return now[PARAMS]; }\n\n");
    put_users(w);
    sdfc_put_bytes(c, w->out, sdfc_c_prelude, strlen(sdfc_c_prelude));
    PUT(w, "\ntypedef uint32_t uint;\n#define uint(x) ((uint32_t)(x))\n#define real(x) "
           "((real)(x))\n"
           "#define TO_INT(x) ((int32_t)((x) == (x) ? (x) : 0.0))\n"
           "#define min lib_min\n#define max lib_max\n#define mix lib_mix\n#define abs fabs\n\n");
    put_library(w, true);
    PUT(w, "\n");
    put_shapes(w);
    put_c_field(w);
    PUT(w, "static void update(const double *params, double time)\n{\n"
           "    (void)masu_param;\n    (void)masu_time;\n"
           "    if (ready && now[PARAMS] == time &&\n"
           "        (PARAMS == 0 || memcmp(now, params, PARAMS * sizeof *now) == 0)) {\n"
           "        return;\n    }\n"
           "    if (!ready) memcpy(slot, initial, sizeof slot);\n    ready = 1;\n"
           "    if (PARAMS > 0) memcpy(now, params, PARAMS * sizeof *now);\n"
           "    now[PARAMS] = time;\n");
    put_update(w);
    PUT(w, "}\n\n");
    sdfc_put_bytes(c, w->out, c_api, sizeof c_api - 1);
}

/* ---- table ---- */

static void put_json_number(writer *w, double v) {
    if (isfinite(v))
        PUT(w, "%.17g", v);
    else
        PUT(w, "null");
}

static void put_json_vector(writer *w, const char *name, const double v[3]) {
    PUT(w, "\"%s\": [", name);
    for (int i = 0; i < 3; i++) {
        put_json_number(w, v[i]);
        PUT(w, i < 2 ? ", " : "]");
    }
}

static void put_table(writer *w) {
    sdfc *c = w->c;
    PUT(w, "{\n  \"dynamic\": %s,\n  \"shapes\": %d,\n  \"slots\": %u,\n  \"params\": [",
        c->dynamic_count ? "true" : "false", c->group_count, c->slot_count);
    for (int i = 0; i < c->param_count; i++) {
        const masu_sdfc_param *p = &c->params[i];
        PUT(w, "%s\n    {\"name\": \"%s\", \"value\": %.17g, \"min\": %.17g, \"max\": %.17g}",
            i ? "," : "", p->name, p->value, p->minimum, p->maximum);
    }
    PUT(w, "%s],\n  \"materials\": [", c->param_count ? "\n  " : "");
    for (int i = 0; i < c->material_count; i++) {
        PUT(w, "%s\n    {\"name\": \"%s\", \"slot\": %d}", i ? "," : "", c->materials[i].name,
            c->part_count * MASU_SDFC_PART_SLOTS + i * MASU_SDFC_MATERIAL_SLOTS);
    }
    PUT(w, "\n  ],\n  \"parts\": [");
    for (int i = 0; i < c->part_count; i++) {
        const sdfc_part *p = &c->parts[i];
        const sdfc_facts *f = &c->shapes[p->shape].facts;
        PUT(w,
            "%s\n    {\"name\": \"%s\", \"shape\": %d, \"slot\": %u, \"slots\": %d, "
            "\"material\": %d, \"lipschitz\": %.17g, ",
            i ? "," : "", p->name, p->group, p->slot_base, c->groups[p->group].slot_count,
            p->material, f->lipschitz);
        put_json_vector(w, "center", f->center);
        PUT(w, ", \"radius\": ");
        put_json_number(w, isfinite(f->radius) ? f->radius : -1);
        PUT(w, ", ");
        put_json_vector(w, "low", f->box.low);
        PUT(w, ", ");
        put_json_vector(w, "high", f->box.high);
        PUT(w, ", \"operations\": %.9g, \"truth\": %s}", f->cost, f->truth ? "true" : "false");
    }
    PUT(w, "\n  ]\n}\n");
}

void sdfc_emit(sdfc *c) {
    find_needed(c);
    for (int i = 0; i < c->part_count; i++) {
        if (c->shapes[c->parts[i].shape].facts.truth) continue;
        sdfc_warn(c, c->parts[i].token,
                  "part %s has GLSL and no C: it is not checked and not in the truth",
                  c->parts[i].name);
    }
    writer w = {c, &c->glsl, true};
    put_glsl(&w);
    w = (writer){c, &c->c, false};
    put_c(&w);
    w = (writer){c, &c->table, false};
    put_table(&w);
}
