/* lower_local.c: expressions that depend on the point of evaluation. Expressions of a shape's cell
 * become operations of the shape's function. Materials with such expressions, and materials painted
 * on parts of a shape, become a second function of the part: it has the same control flow as the
 * first, selects the closest of several cells, and mixes materials where shapes blend. The march
 * never calls it. See lower.c. */
#include "sdfc/lower.h"

#include <string.h>

#define MEMO 512

/* ---- expressions ---- */

typedef struct memo {
    int expr[MEMO], operand[MEMO], count;
} memo;

static int cell_number(sdfc_lowering *l, int cell, bool sector) {
    for (int i = l->cells; i-- > 0;) {
        if (cell >= 0 && l->cell[i] != cell) continue;
        if (sector && !l->sector[i])
            sdfc_fail(l->c, l->c->at,
                      "cell.index: expected polar(count as name, ...) around what this material is "
                      "of, found repeat");
        return l->seed[i];
    }
    if (l->c->any_cell) return sdfc_literal(l, sector ? 0 : 7);
    sdfc_fail(l->c, l->c->at,
              "cell: expected a repetition with a name around what this material is of: "
              "repeat(periods as name, ...)");
}

static int trap(sdfc_lowering *l, int which) {
    if (l->fractal < 0)
        sdfc_fail(l->c, l->c->at, "trap: expected a fractal in what this material is of");
    const sdfc_shape s = l->c->shapes[l->fractal];
    sdfc_point p = l->fractal_at;
    int w = sdfc_literal(l, which),
        levels = sdfc_literal(l, s.whole[s.kind == SDFC_KIND_MANDELBULB]);
    int a[4] = {0};
    for (int i = 0; i < 4 && s.kind != SDFC_KIND_MANDELBULB; i++)
        a[i] = s.number[i] ? sdfc_argument(l, s.number[i]) : 0;
    switch (s.kind) {
    case SDFC_KIND_APOLLONIAN: return OP(l, trap_apollonian, p.x, p.y, p.z, levels, a[0], a[1], w);
    case SDFC_KIND_MANDELBOX: return OP(l, trap_mandelbox, p.x, p.y, p.z, levels, a[0], w);
    case SDFC_KIND_JULIA:
        return OP(l, trap_julia, p.x, p.y, p.z, a[0], a[1], a[2], a[3], levels, w);
    default: {
        int power = sdfc_literal(l, s.whole[0]), bail = sdfc_literal(l, pow(10, 12.0 / s.whole[0]));
        return OP(l, trap_mandelbulb, p.x, p.y, p.z, power, bail, levels, w);
    }
    }
}

static int leaf(sdfc_lowering *l, const sdfc_expr *e) {
    const sdfc_point *p = e->op == SDFC_WORLD ? &l->world : &l->here;
    int axis[3] = {p->x, p->y, p->z};
    switch (e->op) {
    case SDFC_POINT:
    case SDFC_WORLD: return axis[e->a[0]];
    case SDFC_TRAP: return trap(l, e->a[0]);
    case SDFC_CELL: {
        int number = cell_number(l, e->a[0], e->a[1] < 0);
        return e->a[1] < 0 ? number : OP(l, cell_hash, number, sdfc_literal(l, e->a[1]));
    }
    default: {
        sdfc_add_instr(l, e->op)->aux = e->a[0];
        int v = sdfc_last_variable(l);
        bool scaled = e->op == SDFC_FOOTPRINT && l->scale != 1;
        return scaled ? OP(l, mul, v, sdfc_literal(l, l->scale)) : v;
    }
    }
}

static int lower_one(sdfc_lowering *l, int expr, memo *known) {
    const sdfc_expr e = l->c->exprs[expr];
    if (!e.local) return sdfc_argument(l, expr);
    for (int i = 0; i < known->count; i++) {
        if (known->expr[i] == expr) return known->operand[i];
    }
    int count = sdfc_ops[e.op].operands, v[3], r;
    for (int i = 0; i < count; i++) v[i] = lower_one(l, e.a[i], known);
    r = count ? sdfc_op_n(l, e.op, count, v) : leaf(l, &e);
    if (known->count < MEMO) {
        known->expr[known->count] = expr;
        known->operand[known->count++] = r;
    }
    return r;
}

int sdfc_lower_expr(sdfc_lowering *l, int expr) {
    memo known;
    known.count = 0;
    return lower_one(l, expr, &known);
}

/* ---- looks ---- */

sdfc_look sdfc_lower_material(sdfc_lowering *l, int material, sdfc_point p) {
    const sdfc_material m = l->c->materials[material];
    sdfc_look look = {.painted = true};
    memo known;
    known.count = 0;
    l->here = sdfc_settled(l, p);
    for (int i = 0; i < MASU_SDFC_MATERIAL_SLOTS; i++)
        look.value[i] = lower_one(l, m.value[i], &known);
    return look;
}

/* For unpainted surfaces: the part's material, in the part's own space. */
static sdfc_look plain_look(sdfc_lowering *l) {
    if (!l->plain.painted) l->plain = sdfc_lower_material(l, l->material, l->own);
    return l->plain;
}

sdfc_look sdfc_mixed_look(sdfc_lowering *l, sdfc_look a, sdfc_look b, int share, bool whole) {
    if (!a.painted && !b.painted) return a;
    if (!a.painted) a = plain_look(l);
    if (!b.painted) b = plain_look(l);
    for (int i = 0; i < MASU_SDFC_MATERIAL_SLOTS; i++) {
        if (a.value[i] == b.value[i]) continue;
        a.value[i] = whole ? OP(l, select, share, b.value[i], a.value[i])
                           : OP(l, mix, a.value[i], b.value[i], share);
    }
    return a;
}

/* ---- parts ---- */

static bool holds_paint(const sdfc *c, int shape) {
    const sdfc_shape *s = &c->shapes[shape];
    if (s->kind == SDFC_KIND_PAINT) return true;
    for (int i = 0; i < s->children; i++) {
        if (holds_paint(c, s->child[i])) return true;
    }
    return false;
}

static bool asks_trap(const sdfc *c, const sdfc_material *m) {
    for (int i = 0; i < MASU_SDFC_MATERIAL_SLOTS; i++) {
        if (c->exprs[m->value[i]].trapped) return true;
    }
    return false;
}

void sdfc_lower_surface(sdfc *c, sdfc_part *part) {
    const sdfc_material m = c->materials[part->material];
    bool painted = holds_paint(c, part->shape);
    if (!m.local && !painted) return;
    sdfc_lowering l = {.c = c,
                       .program = &part->program,
                       .root = true,
                       .surface = true,
                       .shallow = !painted && !m.cellular && !asks_trap(c, &m),
                       .material = part->material,
                       .scale = 1,
                       .fractal = -1};
    sdfc_point whole = {0, 1, 2, {0}};
    c->at = part->token;
    sdfc_open_function(&l);
    part->program.surface = l.function;
    for (int i = 0; i < 3 && c->anchored; i++) whole.offset[i] = c->anchor_expr[i] + 1;
    l.world = l.own = sdfc_settled(&l, whole);
    int d = sdfc_lower_shape(&l, part->shape, whole);
    sdfc_look look = l.look.painted ? l.look : plain_look(&l);
    part->program.functions[part->program.surface].result = d;
    memcpy(part->program.look, look.value, sizeof look.value);
}
