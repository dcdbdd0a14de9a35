/* lower.c: converts a part's tree of shapes to functions of straight-line operations on numbers.
 * Points are passed inwards as three variables, distances return as one. A scene parameter or a
 * literal of the text is an argument, by number: two parts with the same operations and different
 * arguments share their code (group.c).
 *
 * In an anchored scene, the GLSL's points are relative to an anchor, which can be a million metres
 * from the origin. So a point has an offset that has not been added yet, initially the anchor.
 * Translations, rotations, scalings and unbounded repetitions change the offset and not the point;
 * operators that need absolute coordinates add it. By then it is small, because visible objects are
 * near the anchor. The offset's expressions are evaluated in two floats each (shared/wide.glsl). */
#include "sdfc/lower.h"

#include <stdlib.h>
#include <string.h>

#define INSTRS_MAX 60000

/* the variables of a function that are its parameters */
static const sdfc_point entry = {0, 1, 2, {0}};

/* ---- writing ---- */

int sdfc_argument(sdfc_lowering *l, int expr) {
    if (l->c->exprs[expr].local) return sdfc_lower_expr(l, expr);
    sdfc_program *p = l->program;
    p->args = sdfc_grow(l->c, p->args, p->arg_count, &p->arg_capacity, sizeof *p->args, INSTRS_MAX,
                        "arguments of a part");
    p->args[p->arg_count] = expr;
    return ~p->arg_count++;
}

int sdfc_literal(sdfc_lowering *l, double value) {
    return sdfc_argument(l, sdfc_number(l->c, value));
}

sdfc_instr *sdfc_add_instr(sdfc_lowering *l, int op) {
    if (++l->c->instrs > SDFC_INSTRS_MAX) {
        sdfc_fail(l->c, l->c->at, "more than %d operations in all parts", SDFC_INSTRS_MAX);
    }
    sdfc_function *f = &l->program->functions[l->function];
    f->instrs = sdfc_grow(l->c, f->instrs, f->count, &f->capacity, sizeof *f->instrs, INSTRS_MAX,
                          "operations of a part");
    sdfc_instr *i = &f->instrs[f->count++];
    memset(i, 0, sizeof *i);
    i->op = op;
    return i;
}

int sdfc_last_variable(const sdfc_lowering *l) {
    return 2 + l->program->functions[l->function].count;
}

int sdfc_op_n(sdfc_lowering *l, int op, int count, const int *operands) {
    sdfc_instr *i = sdfc_add_instr(l, op);
    for (int k = 0; k < count; k++) i->operand[k] = operands[k];
    return sdfc_last_variable(l);
}

int sdfc_open_function(sdfc_lowering *l) {
    sdfc_program *p = l->program;
    p->functions = sdfc_grow(l->c, p->functions, p->function_count, &p->function_capacity,
                             sizeof *p->functions, 4096, "functions of a part");
    int before = l->function;
    l->function = p->function_count++;
    memset(&p->functions[l->function], 0, sizeof p->functions[0]);
    return before;
}

/* ---- offsets ---- */

bool sdfc_has_offset(const sdfc_point *p) { return p->offset[0] || p->offset[1] || p->offset[2]; }

int sdfc_offset_of(sdfc_lowering *l, const sdfc_point *p, int axis) {
    return p->offset[axis] ? p->offset[axis] - 1 : sdfc_number(l->c, 0);
}

/* The value to be subtracted from a coordinate. */
int sdfc_against(sdfc_lowering *l, const sdfc_point *p, int axis) {
    return sdfc_apply(l->c, SDFC_neg, sdfc_offset_of(l, p, axis), 0, 0);
}

/* The point in true coordinates. */
sdfc_point sdfc_settled(sdfc_lowering *l, sdfc_point p) {
    int v[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; i++) {
        if (p.offset[i]) v[i] = OP(l, sub, v[i], sdfc_argument(l, sdfc_against(l, &p, i)));
    }
    return (sdfc_point){v[0], v[1], v[2], {0}};
}

static sdfc_point moved_offset(sdfc_lowering *l, sdfc_point p, const int by[3]) {
    for (int i = 0; i < 3; i++) {
        p.offset[i] = sdfc_apply(l->c, SDFC_sub, sdfc_offset_of(l, &p, i), by[i], 0) + 1;
    }
    return p;
}

static void turn_offset(sdfc_lowering *l, const sdfc_shape *s, const sdfc_point *from,
                        sdfc_point *to) {
    for (int i = 0; i < 3; i++) {
        int sum = sdfc_number(l->c, 0);
        for (int j = 0; j < 3; j++) {
            int part =
                sdfc_apply(l->c, SDFC_mul, s->number[3 * i + j], sdfc_offset_of(l, from, j), 0);
            sum = sdfc_apply(l->c, SDFC_add, sum, part, 0);
        }
        to->offset[i] = sum + 1;
    }
}

/* A constant coordinate, to be compared with the point's. */
int sdfc_relative(sdfc_lowering *l, const sdfc_point *p, int axis, double value) {
    int e = sdfc_number(l->c, value);
    if (p->offset[axis]) e = sdfc_apply(l->c, SDFC_sub, e, p->offset[axis] - 1, 0);
    return sdfc_argument(l, e);
}

static bool any_timed(const sdfc *c, const int *exprs, int count) {
    for (int i = 0; i < count; i++) {
        if (c->exprs[exprs[i]].timed) return true;
    }
    return false;
}

/* A sphere that may be a ground: one that is no larger loses nothing by the plain form. */
bool sdfc_is_large(const sdfc *c, const sdfc_shape *s) {
    const sdfc_expr *radius = &c->exprs[s->number[0]];
    return s->kind == SDFC_KIND_SPHERE && radius->op == SDFC_CONST && radius->value >= 64;
}

/* Whether a moved shape is a large sphere whose surface passes by the origin: that is where the
 * camera is. Farther from the origin the plain form is as exact. */
static bool is_ground(const sdfc *c, const sdfc_shape *moved) {
    const sdfc_shape *s = &c->shapes[moved->child[0]];
    if (!sdfc_is_large(c, s)) return false;
    double r = c->exprs[s->number[0]].value, squared = 0;
    for (int i = 0; i < 3; i++) {
        if (c->exprs[moved->number[i]].op != SDFC_CONST) return false;
        squared += c->exprs[moved->number[i]].value * c->exprs[moved->number[i]].value;
    }
    return fabs(sqrt(squared) - r) < r / 8;
}

/* Which forms pass an offset on, instead of having it added first. A changing rotation or factor
 * has only 24 bits of precision: more bits of its product with the offset would be meaningless. */
static bool hands_offset_on(const sdfc *c, const sdfc_shape *s) {
    switch (s->kind) {
    case SDFC_KIND_ROTATE:
    case SDFC_KIND_ROTATE_EULER: return !any_timed(c, s->number, 9);
    case SDFC_KIND_REPEAT: return !s->cell; /* the number of a cell depends on the absolute
                                             * position */
    case SDFC_KIND_TRANSLATE:
    case SDFC_KIND_PAINT:
    case SDFC_KIND_PLANE:
    case SDFC_KIND_ONION:
    case SDFC_KIND_ROUND:
    case SDFC_KIND_DISPLACE:
    case SDFC_KIND_DISPLACE_NOISE:
    case SDFC_KIND_MORPH:
    case SDFC_KIND_UNION:
    case SDFC_KIND_INTERSECTION:
    case SDFC_KIND_DIFFERENCE:
    case SDFC_KIND_SMOOTH_UNION:
    case SDFC_KIND_SMOOTH_INTERSECTION:
    case SDFC_KIND_SMOOTH_DIFFERENCE:
    case SDFC_KIND_CHAMFER:
    case SDFC_KIND_STAIRS:
    case SDFC_KIND_XOR:
    case SDFC_KIND_BLEND: return true;
    case SDFC_KIND_SPHERE: return sdfc_is_large(c, s);
    case SDFC_KIND_SCALE: /* which looks at the point again where it may be 0 */
        return s->extra[0] == 0 && !any_timed(c, s->number, 3);
    default: return false;
    }
}

/* The child as a separate function, because it is called at several points. They share `offset`. */
int sdfc_child_function(sdfc_lowering *l, int shape, bool join_box, const sdfc_shape *owner,
                          const int offset[3]) {
    int before = sdfc_open_function(l), function = l->function, cells = l->cells;
    int seed[SDFC_CELLS_DEEP];
    bool surface = l->surface;
    const sdfc_point start = {0, 1, 2, {offset[0], offset[1], offset[2]}};
    memcpy(seed, l->seed, sizeof seed);
    if (owner->cell) {
        if (l->cells == SDFC_CELLS_DEEP) {
            sdfc_fail(l->c, owner->token,
                      "expected at most %d repetitions with names inside each other",
                      SDFC_CELLS_DEEP);
        }
        l->sector[l->cells] = owner->kind == SDFC_KIND_POLAR;
        l->cell[l->cells++] = owner->cell - 1;
    }
    for (int i = 0; i < l->cells; i++) {
        sdfc_add_instr(l, SDFC_INPUT);
        l->seed[i] = sdfc_last_variable(l);
    }
    l->program->functions[function].inputs = l->cells;
    l->surface = false;
    int d = sdfc_lower_shape(l, shape, start);
    double lipschitz = l->c->shapes[shape].facts.lipschitz;
    if (join_box) {
        int outside;
        int e[6];
        for (int i = 0; i < 3; i++) e[i] = sdfc_relative(l, &start, i, owner->extra[4 + i]);
        for (int i = 3; i < 6; i++) e[i] = sdfc_literal(l, owner->extra[4 + i]);
        outside = OP(l, around_box, 0, 1, 2, e[0], e[1], e[2], e[3], e[4], e[5]);
        if (owner->kind == SDFC_KIND_POLAR) {
            int cosine = sdfc_literal(l, owner->extra[1]);
            int wedge = OP(l, around_wedge, 0, 2, cosine, sdfc_literal(l, owner->extra[2]));
            outside = OP(l, max, outside, wedge);
        }
        d = OP(l, max, d, OP(l, mul, outside, sdfc_literal(l, lipschitz)));
    }
    l->program->functions[function].result = d;
    l->function = before;
    l->surface = surface;
    l->cells = cells;
    memcpy(l->seed, seed, sizeof seed);
    return function;
}

/* The distance to the bounds of all cells, if no evaluated cell is near. */
int sdfc_capped(sdfc_lowering *l, int d, int least, const sdfc_facts *f, sdfc_point p) {
    int ends = 0, axis = 0, at[3] = {p.x, p.y, p.z};
    int e[6], cap = least, first = l->program->functions[l->function].count;
    for (int i = 0; i < 3; i++) {
        if (!isfinite(f->box.low[i]) || !isfinite(f->box.high[i])) continue;
        ends++;
        axis = i;
    }
    if (ends == 1) { /* rows without end: a slab */
        int from = OP(l, sub, at[axis],
                      sdfc_relative(l, &p, axis, (f->box.low[axis] + f->box.high[axis]) / 2));
        int outside = OP(l, sub, OP(l, abs, from),
                         sdfc_literal(l, (f->box.high[axis] - f->box.low[axis]) / 2));
        least = OP(l, max, least, OP(l, mul, outside, sdfc_literal(l, f->lipschitz)));
    } else if (ends) {
        for (int i = 0; i < 3; i++) {
            bool end = isfinite(f->box.low[i]) && isfinite(f->box.high[i]);
            e[i] = end ? sdfc_relative(l, &p, i, (f->box.low[i] + f->box.high[i]) / 2)
                       : sdfc_literal(l, 0);
            e[3 + i] = sdfc_literal(l, end ? (f->box.high[i] - f->box.low[i]) / 2 : 1e30);
        }
        int outside = OP(l, around_box, p.x, p.y, p.z, e[0], e[1], e[2], e[3], e[4], e[5]);
        least = OP(l, max, least, OP(l, mul, outside, sdfc_literal(l, f->lipschitz)));
    }
    int result = OP(l, min, d, least);
    if (cap < 0) {
        sdfc_function *f2 = &l->program->functions[l->function];
        f2->terms = sdfc_grow(l->c, f2->terms, f2->term_count, &f2->term_capacity,
                              sizeof *f2->terms, INSTRS_MAX, "terms of a part");
        f2->terms[f2->term_count++] =
            (sdfc_term){.first = first, .last = f2->count - 1, .bit = -1, .cap = cap};
    }
    return result;
}

/* ---- the root transform ---- */

/* Arguments `first` on, `count` of them; count 1: one value for all three. */
static void add_root_step(sdfc_lowering *l, int kind, int first, int count) {
    sdfc_program *p = l->program;
    p->root = sdfc_grow(l->c, p->root, p->root_count, &p->root_capacity, sizeof *p->root,
                        MASU_SDFC_DEPTH_MAX, "movements around a part");
    sdfc_root_step *step = &p->root[p->root_count++];
    memset(step, 0, sizeof *step);
    step->kind = kind;
    for (int i = 0; i < 9; i++) step->arg[i] = i < count ? first + i : first;
}

/* It matters where it changes: only then has it carried the part. */
bool sdfc_root_moves(const sdfc *c, const sdfc_program *p) {
    for (int i = 0; i < p->root_count; i++) {
        int count = p->root[i].kind == SDFC_KIND_ROTATE ? 9 : 3;
        for (int k = 0; k < count; k++) {
            if (c->exprs[p->args[p->root[i].arg[k]]].timed) return true;
        }
    }
    return false;
}

/* The accumulated offset is a translation too. At the end of the root transform it needs no
 * arguments if none of it changes with time. */
static void gather_root(sdfc_lowering *l, const sdfc_point *p, bool ends) {
    if (!sdfc_has_offset(p)) return;
    bool timed = !ends || sdfc_root_moves(l->c, l->program);
    for (int i = 0; i < 3; i++) timed = timed || l->c->exprs[sdfc_offset_of(l, p, i)].timed;
    if (!timed) return;
    int first = l->program->arg_count;
    for (int i = 0; i < 3; i++) sdfc_argument(l, sdfc_against(l, p, i));
    add_root_step(l, SDFC_KIND_TRANSLATE, first, 3);
}

/* ---- terms ---- */

/* Inside of something that takes the point apart in another way than terms know. */
int sdfc_lower_whole(sdfc_lowering *l, int shape, sdfc_point p) {
    double stretch = l->stretch;
    l->stretch = 0;
    int d = sdfc_lower_shape(l, shape, p);
    l->stretch = stretch;
    return d;
}

bool sdfc_has_terms(const sdfc_lowering *l, const sdfc_shape *s) {
    if (!(l->stretch > 0) || s->children < 2 || s->facts.estimate || s->kind == SDFC_KIND_XOR)
        return false;
    bool is_union = s->kind == SDFC_KIND_UNION || s->kind == SDFC_KIND_SMOOTH_UNION ||
                    s->kind >= SDFC_KIND_CHAMFER;
    if (l->in_cells && !is_union) return false;
    if (!l->folded) return true;
    for (int i = 0; i < s->children; i++) {
        if (l->folded & ~l->c->shapes[s->child[i]].facts.symmetric) return false;
    }
    return l->at_fold;
}

void sdfc_add_term(sdfc_lowering *l, const sdfc_shape *s, int child, int first, int smooth) {
    sdfc_function *f = &l->program->functions[l->function];
    double lipschitz = s->extra[0] != 0 ? 1 : s->facts.lipschitz;
    if (f->count == first) return;
    f->terms = sdfc_grow(l->c, f->terms, f->term_count, &f->term_capacity, sizeof *f->terms,
                         INSTRS_MAX, "terms of a part");
    f->terms[f->term_count++] =
        (sdfc_term){.first = first,
                    .last = f->count - 1,
                    .bit = -1,
                    .smooth = smooth,
                    .opens = child == 0,
                    .far = s->kind == SDFC_KIND_BLEND,
                    .most = s->kind != SDFC_KIND_UNION && s->kind != SDFC_KIND_SMOOTH_UNION &&
                            s->kind < SDFC_KIND_CHAMFER,
                    .lipschitz = lipschitz * l->stretch};
}

/* Boxes without an end are as wide as fp32 can square. */
int sdfc_outside_box(sdfc_lowering *l, const sdfc_box *b, sdfc_point p) {
    int e[6];
    for (int i = 0; i < 3; i++) {
        bool ends = isfinite(b->low[i]) && isfinite(b->high[i]);
        e[i] = sdfc_literal(l, ends ? (b->low[i] + b->high[i]) / 2 : 0);
        e[3 + i] = sdfc_literal(l, ends ? (b->high[i] - b->low[i]) / 2 : 1e30);
    }
    return OP(l, around_box, p.x, p.y, p.z, e[0], e[1], e[2], e[3], e[4], e[5]);
}

static int lower_bend(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int k = sdfc_argument(l, s->number[0]);
    int along = OP(l, arc_along, p.x, p.y, k), across = OP(l, arc_across, p.x, p.y, k);
    int d = sdfc_lower_whole(l, s->child[0], (sdfc_point){along, across, p.z, {0}});
    int e[7];
    for (int i = 0; i < 3; i++) e[i] = sdfc_argument(l, s->number[1 + i]);
    for (int i = 0; i < 4; i++) e[3 + i] = sdfc_literal(l, s->extra[2 + i]);
    int outside =
        OP(l, around_arc, p.x, p.y, p.z, across, e[0], e[1], e[2], e[3], e[4], e[5], e[6]);
    outside = OP(l, max, outside, sdfc_outside_box(l, &s->facts.box, p));
    int shell = OP(l, mul, outside, sdfc_literal(l, s->extra[0]));
    return OP(l, max, shell, OP(l, min, d, OP(l, sub, sdfc_literal(l, s->extra[1]), shell)));
}

static int lower_twist(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int a = OP(l, mul, p.y, sdfc_argument(l, s->number[0]));
    sdfc_point q = {OP(l, turn_x, p.x, p.z, a), p.y, OP(l, turn_z, p.x, p.z, a), {0}};
    int d = sdfc_lower_whole(l, s->child[0], q);
    int radius = sdfc_literal(l, s->extra[2]), middle = sdfc_literal(l, s->extra[3]);
    int outside =
        OP(l, around_cylinder, p.x, p.y, p.z, radius, middle, sdfc_literal(l, s->extra[4]));
    int shell = OP(l, mul, outside, sdfc_literal(l, s->extra[0]));
    return OP(l, max, shell, OP(l, min, d, sdfc_literal(l, s->extra[1])));
}

static sdfc_point matrix(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int v[3];
    for (int i = 0; i < 3; i++) {
        int a = sdfc_argument(l, s->number[3 * i]), b = sdfc_argument(l, s->number[3 * i + 1]);
        v[i] = OP(l, dot3, p.x, p.y, p.z, a, b, sdfc_argument(l, s->number[3 * i + 2]));
    }
    return (sdfc_point){v[0], v[1], v[2], {0}};
}

static sdfc_point reflect(sdfc_lowering *l, sdfc_point p, int nx, int ny, int nz) {
    int d = OP(l, dot3, p.x, p.y, p.z, nx, ny, nz);
    int x = OP(l, reflect, p.x, d, nx), y = OP(l, reflect, p.y, d, ny);
    return (sdfc_point){x, y, OP(l, reflect, p.z, d, nz), {0}};
}

/* Into one octant, then across its diagonals into x >= y >= z: reflections only. Then the
 * factor. */
static int lower_kaleidoscope(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int k = sdfc_argument(l, s->number[0]);
    int shift[3];
    for (int i = 0; i < 3; i++) shift[i] = sdfc_argument(l, s->number[1 + i]);
    for (int level = 0; level < s->whole[0]; level++) {
        int a = OP(l, abs, p.x), b = OP(l, abs, p.y), e = OP(l, abs, p.z);
        int high = OP(l, max, a, b), low = OP(l, min, a, b);
        int middle = OP(l, max, low, e), least = OP(l, min, low, e);
        int most = OP(l, max, high, middle);
        middle = OP(l, min, high, middle);
        int x = OP(l, sub, OP(l, mul, most, k), shift[0]);
        int y = OP(l, sub, OP(l, mul, middle, k), shift[1]);
        p = (sdfc_point){x, y, OP(l, sub, OP(l, mul, least, k), shift[2]), {0}};
    }
    return OP(l, mul, sdfc_lower_whole(l, s->child[0], p), sdfc_argument(l, s->number[4]));
}

static int lower_scale(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p, bool root) {
    const int *n = s->number;
    int next = l->program->arg_count;
    int a[3] = {sdfc_argument(l, n[0]), 0, 0};
    for (int i = 1; i < 3; i++) a[i] = n[i] == n[0] ? a[0] : sdfc_argument(l, n[i]);
    int x = OP(l, mul, p.x, a[0]), y = OP(l, mul, p.y, a[1]), z = OP(l, mul, p.z, a[2]);
    if (root && !l->surface) {
        add_root_step(l, SDFC_KIND_SCALE, next, 1);
        sdfc_root_step *step = &l->program->root[l->program->root_count - 1];
        for (int i = 0; i < 3; i++) step->arg[i] = ~a[i];
    }
    sdfc_point q = {x, y, z, {0}};
    for (int i = 0; i < 3; i++) {
        if (p.offset[i]) {
            q.offset[i] = 1 + sdfc_apply(l->c, SDFC_mul, p.offset[i] - 1, n[i], 0);
        }
    }
    double stretch = l->stretch, factor = 0;
    for (int i = 0; i < 3; i++) {
        factor = fmax(factor, fmax(fabs(l->c->exprs[n[i]].low), fabs(l->c->exprs[n[i]].high)));
    }
    double scale = l->scale;
    l->stretch = isfinite(factor) ? stretch * factor : 0;
    l->scale = isfinite(factor) ? scale * factor : scale;
    int d = sdfc_lower_shape(l, s->child[0], q);
    l->stretch = stretch;
    l->scale = scale;
    int k = sdfc_argument(l, n[3]);
    return s->extra[0] != 0 ? OP(l, unscale, d, k, p.x, p.y, p.z) : OP(l, mul, d, k);
}

static int lower_mirror(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    const sdfc *c = l->c;
    const int *n = s->number;
    for (int i = 0; i < 3; i++) {
        if (fabs(c->exprs[n[i]].value) != 1) continue;
        int v = OP(l, abs, i == 0 ? p.x : i == 1 ? p.y : p.z);
        if (c->exprs[n[i]].value < 0) v = OP(l, neg, v);
        return sdfc_lower_shape(l, s->child[0],
                     (sdfc_point){i == 0 ? v : p.x, i == 1 ? v : p.y, i == 2 ? v : p.z, {0}});
    }
    int x = sdfc_argument(l, n[0]), y = sdfc_argument(l, n[1]);
    return sdfc_lower_shape(l, s->child[0], reflect(l, p, x, y, sdfc_argument(l, n[2])));
}

/* The section at z = 0. */
static int lower_extrude(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int d = sdfc_lower_whole(l, s->child[0], (sdfc_point){p.x, p.y, sdfc_literal(l, 0), {0}});
    return OP(l, extrude, d, p.z, sdfc_argument(l, s->number[0]));
}

static int lower_revolve(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int q = OP(l, sub, OP(l, len2, p.x, p.z), sdfc_argument(l, s->number[0]));
    return sdfc_lower_whole(l, s->child[0], (sdfc_point){q, p.y, sdfc_literal(l, 0), {0}});
}

static int lower_paint(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int d = sdfc_lower_shape(l, s->child[0], p);
    if (l->surface) l->look = sdfc_lower_material(l, s->paint, p);
    return d;
}

static int lower_morph(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int a = sdfc_lower_shape(l, s->child[0], p);
    sdfc_look look = l->look;
    int b = sdfc_lower_shape(l, s->child[1], p), t = sdfc_argument(l, s->number[0]);
    if (l->surface) l->look = sdfc_mixed_look(l, look, l->look, t, false);
    return OP(l, mix, a, b, t);
}

static int lower_displace(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    const int *n = s->number;
    int d = sdfc_lower_shape(l, s->child[0], p), a = sdfc_argument(l, n[0]);
    int x = sdfc_argument(l, n[1]), y = sdfc_argument(l, n[2]);
    p = sdfc_settled(l, p);
    int w = OP(l, waves, p.x, p.y, p.z, x, y, sdfc_argument(l, n[3]));
    return OP(l, add, d, OP(l, mul, w, a));
}

static int lower_displace_noise(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    const int *n = s->number;
    int d = sdfc_lower_shape(l, s->child[0], p), a = sdfc_argument(l, n[0]),
        k = sdfc_argument(l, n[1]);
    p = sdfc_settled(l, p);
    int x = OP(l, mul, p.x, k), y = OP(l, mul, p.y, k);
    int w = OP(l, noise, x, y, OP(l, mul, p.z, k));
    return OP(l, add, d, OP(l, mul, w, a));
}

int sdfc_lower_shape(sdfc_lowering *l, int shape, sdfc_point p) {
    sdfc *c = l->c;
    /* A copy: expressions made below may move the array. */
    const sdfc_shape copy = c->shapes[shape], *s = &copy;
    const int *n = s->number;
    bool root = l->root;
    l->root = root && (s->kind == SDFC_KIND_TRANSLATE || s->kind == SDFC_KIND_ROTATE ||
                       s->kind == SDFC_KIND_ROTATE_EULER || s->kind == SDFC_KIND_SCALE ||
                       s->kind == SDFC_KIND_PAINT);
    if (root && (!l->root || !hands_offset_on(l->c, s)) && !l->surface)
        gather_root(l, &p, !l->root);
    if (!hands_offset_on(l->c, s)) p = sdfc_settled(l, p);
    if (root && !l->root && l->surface) l->own = sdfc_settled(l, p);
    l->look = (sdfc_look){0};
    if (l->shallow && !l->root) return sdfc_literal(l, 0);
    bool fractal = s->kind == SDFC_KIND_MANDELBULB ||
                   (s->kind >= SDFC_KIND_APOLLONIAN && s->kind <= SDFC_KIND_JULIA);
    if (fractal && l->surface) {
        l->fractal = shape;
        l->fractal_at = p;
    }
    if (s->children == 0) return sdfc_lower_primitive(l, s, p);
    l->at_fold = l->at_fold && (sdfc_is_join(s->kind) || s->kind == SDFC_KIND_PAINT);
    int first = s->child[0], next = l->program->arg_count;
    switch (s->kind) {
    case SDFC_KIND_TRANSLATE: {
        if (sdfc_has_offset(&p)) return sdfc_lower_shape(l, first, moved_offset(l, p, n));
        if (is_ground(l->c, s) && !l->surface) {
            if (root && !l->surface) add_root_step(l, SDFC_KIND_TRANSLATE, next, 3);
            return sdfc_lower_ground(l, n, l->c->shapes[first].number[0], p);
        }
        int x = OP(l, sub, p.x, sdfc_argument(l, n[0])),
            y = OP(l, sub, p.y, sdfc_argument(l, n[1]));
        int z = OP(l, sub, p.z, sdfc_argument(l, n[2]));
        if (root && !l->surface) add_root_step(l, SDFC_KIND_TRANSLATE, next, 3);
        return sdfc_lower_shape(l, first, (sdfc_point){x, y, z, {0}});
    }
    case SDFC_KIND_ROTATE:
    case SDFC_KIND_ROTATE_EULER: {
        sdfc_point turned = matrix(l, s, p);
        if (sdfc_has_offset(&p)) turn_offset(l, s, &p, &turned);
        if (root && !l->surface) add_root_step(l, SDFC_KIND_ROTATE, next, 9);
        return sdfc_lower_shape(l, first, turned);
    }
    case SDFC_KIND_SCALE: return lower_scale(l, s, p, root);
    case SDFC_KIND_MIRROR: return lower_mirror(l, s, p);
    case SDFC_KIND_REPEAT:
    case SDFC_KIND_REPEAT_LIMITED: return sdfc_lower_repeat(l, s, p);
    case SDFC_KIND_POLAR: return sdfc_lower_polar(l, s, p);
    case SDFC_KIND_TWIST: return lower_twist(l, s, p);
    case SDFC_KIND_BEND: return lower_bend(l, s, p);
    case SDFC_KIND_ELONGATE: {
        int x = OP(l, elongate, p.x, sdfc_argument(l, n[0]));
        int y = OP(l, elongate, p.y, sdfc_argument(l, n[1]));
        return sdfc_lower_shape(
            l, first, (sdfc_point){x, y, OP(l, elongate, p.z, sdfc_argument(l, n[2])), {0}});
    }
    case SDFC_KIND_ONION: {
        int d = sdfc_lower_shape(l, first, p);
        return OP(l, onion, d, sdfc_argument(l, n[0]));
    }
    case SDFC_KIND_ROUND: {
        int d = sdfc_lower_shape(l, first, p);
        return OP(l, sub, d, sdfc_argument(l, n[0]));
    }
    case SDFC_KIND_DISPLACE: return lower_displace(l, s, p);
    case SDFC_KIND_DISPLACE_NOISE: return lower_displace_noise(l, s, p);
    case SDFC_KIND_MORPH: return lower_morph(l, s, p);
    case SDFC_KIND_PAINT: return lower_paint(l, s, p);
    case SDFC_KIND_EXTRUDE: return lower_extrude(l, s, p);
    case SDFC_KIND_REVOLVE: return lower_revolve(l, s, p);
    case SDFC_KIND_KALEIDOSCOPE: return lower_kaleidoscope(l, s, p);
    default: return sdfc_lower_joined(l, s, p);
    }
}

void sdfc_lower(sdfc *c, sdfc_part *part) {
    sdfc_lowering l = {
        .c = c, .program = &part->program, .root = true, .stretch = 1, .scale = 1, .fractal = -1};
    c->at = part->token;
    sdfc_open_function(&l);
    int root = l.function;
    sdfc_point whole = entry;
    for (int i = 0; i < 3 && c->anchored; i++) whole.offset[i] = c->anchor_expr[i] + 1;
    int d = sdfc_lower_shape(&l, part->shape, whole);
    part->program.functions[root].result = d;
    if (!c->any_cell) sdfc_lower_surface(c, part);
    int variables = 0;
    for (int i = 0; i < part->program.function_count; i++) {
        part->program.functions[i].first_variable = variables;
        variables += 3 + part->program.functions[i].count;
    }
    part->program.variable_count = variables;
}
