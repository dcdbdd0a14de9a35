/* lower.c: a part's tree of shapes becomes functions of straight-line operations on numbers.
 * Points travel from the outside in as three variables, distances come back as one. What a
 * parameter of the scene or a literal of the text contributes is an argument, by number: two parts
 * with the same operations and different arguments share their code (group.c).
 *
 * In an anchored scene the GLSL's points are relative to an anchor, which may be a million metres
 * from the origin. So a point carries an offset that is still to be added to it, at first the
 * anchor: movements, turns, scalings and endless repetitions change the offset and not the point,
 * and what needs true coordinates adds it up. By then it is small, since what one sees stands near
 * the anchor. The offset's expressions are evaluated in two floats each (shared/wide.glsl).
 * Over 700 lines: a function for each kind of shape, which all carry the same state. */
#include "sdfc/internal.h"

#include <stdlib.h>
#include <string.h>

#define INSTRS_MAX 60000

typedef struct lowering {
    sdfc *c;
    sdfc_program *program;
    int function; /* being written */
    bool root;    /* no shape but movements, turns and scalings has been met */
    double stretch; /* metres here for one of the world, at most; 0: not known */
    unsigned folded; /* axes that jump from cell to cell: what is alike on both sides alone is continuous */
    bool at_fold;    /* nothing has been done to the point since */
    bool in_cells;   /* of a repetition that looks at several: what is left out of a cut makes a cell nearer */
} lowering;

typedef struct point {
    int x, y, z;
    int offset[3]; /* expressions + 1, to be added; 0: nothing */
} point;

static const point entry = {0, 1, 2, {0}}; /* the variables of a function that are its parameters */

/* ---- writing ---- */

static int argument(lowering *l, int expr) {
    sdfc_program *p = l->program;
    p->args = sdfc_grow(l->c, p->args, p->arg_count, &p->arg_capacity, sizeof *p->args, INSTRS_MAX,
                        "arguments of a part");
    p->args[p->arg_count] = expr;
    return ~p->arg_count++;
}

static int constant(lowering *l, double value) { return argument(l, sdfc_number(l->c, value)); }

static sdfc_instr *add_instr(lowering *l, int op) {
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

static int last_variable(const lowering *l) { return 2 + l->program->functions[l->function].count; }

static int op_n(lowering *l, int op, int count, const int *operands) {
    sdfc_instr *i = add_instr(l, op);
    for (int k = 0; k < count; k++) i->operand[k] = operands[k];
    return last_variable(l);
}

#define OP(l, op, ...)                                                                             \
    op_n(l, SDFC_##op, (int)(sizeof((int[]){__VA_ARGS__}) / sizeof(int)), (int[]){__VA_ARGS__})

static int open_function(lowering *l) {
    sdfc_program *p = l->program;
    p->functions = sdfc_grow(l->c, p->functions, p->function_count, &p->function_capacity,
                             sizeof *p->functions, 4096, "functions of a part");
    int before = l->function;
    l->function = p->function_count++;
    memset(&p->functions[l->function], 0, sizeof p->functions[0]);
    return before;
}

/* ---- offsets ---- */

static bool has_offset(const point *p) { return p->offset[0] || p->offset[1] || p->offset[2]; }

static int offset_of(lowering *l, const point *p, int axis) {
    return p->offset[axis] ? p->offset[axis] - 1 : sdfc_number(l->c, 0);
}

/* What is to be subtracted from a coordinate. */
static int against(lowering *l, const point *p, int axis) {
    return sdfc_apply(l->c, SDFC_neg, offset_of(l, p, axis), 0, 0);
}

/* The point in true coordinates. */
static point settled(lowering *l, point p) {
    int v[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; i++) {
        if (p.offset[i]) v[i] = OP(l, sub, v[i], argument(l, against(l, &p, i)));
    }
    return (point){v[0], v[1], v[2], {0}};
}

static point moved_offset(lowering *l, point p, const int by[3]) {
    for (int i = 0; i < 3; i++) {
        p.offset[i] = sdfc_apply(l->c, SDFC_sub, offset_of(l, &p, i), by[i], 0) + 1;
    }
    return p;
}

static void turn_offset(lowering *l, const sdfc_shape *s, const point *from, point *to) {
    for (int i = 0; i < 3; i++) {
        int sum = sdfc_number(l->c, 0);
        for (int j = 0; j < 3; j++) {
            int part = sdfc_apply(l->c, SDFC_mul, s->number[3 * i + j], offset_of(l, from, j), 0);
            sum = sdfc_apply(l->c, SDFC_add, sum, part, 0);
        }
        to->offset[i] = sum + 1;
    }
}

/* A constant coordinate, to be compared with the point's. */
static int relative(lowering *l, const point *p, int axis, double value) {
    int e = sdfc_number(l->c, value);
    if (p->offset[axis]) e = sdfc_apply(l->c, SDFC_sub, e, p->offset[axis] - 1, 0);
    return argument(l, e);
}

static bool any_timed(const sdfc *c, const int *exprs, int count) {
    for (int i = 0; i < count; i++) {
        if (c->exprs[exprs[i]].timed) return true;
    }
    return false;
}

/* A sphere that may be a ground: one that is no larger loses nothing by the plain form. */
static bool is_large(const sdfc *c, const sdfc_shape *s) {
    const sdfc_expr *radius = &c->exprs[s->number[0]];
    return s->kind == SDFC_KIND_SPHERE && radius->op == SDFC_CONST && radius->value >= 64;
}

/* Whether a moved shape is a large sphere whose surface passes by the origin: that is where the
 * camera is. Farther from the origin the plain form is as exact. */
static bool is_ground(const sdfc *c, const sdfc_shape *moved) {
    const sdfc_shape *s = &c->shapes[moved->child[0]];
    if (!is_large(c, s)) return false;
    double r = c->exprs[s->number[0]].value, squared = 0;
    for (int i = 0; i < 3; i++) {
        if (c->exprs[moved->number[i]].op != SDFC_CONST) return false;
        squared += c->exprs[moved->number[i]].value * c->exprs[moved->number[i]].value;
    }
    return fabs(sqrt(squared) - r) < r / 8;
}

/* Which forms hand an offset on, instead of having it added first. A turn or a factor that changes
 * is known to 24 bits only: more bits of its product with the offset would say nothing. */
static bool hands_offset_on(const sdfc *c, const sdfc_shape *s) {
    switch (s->kind) {
    case SDFC_KIND_ROTATE:
    case SDFC_KIND_ROTATE_EULER: return !any_timed(c, s->number, 9);
    case SDFC_KIND_TRANSLATE:
    case SDFC_KIND_REPEAT:
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
    case SDFC_KIND_SMOOTH_DIFFERENCE: return true;
    case SDFC_KIND_SPHERE: return is_large(c, s);
    case SDFC_KIND_SCALE: /* which looks at the point again where it may be 0 */
        return s->extra[0] == 0 && !any_timed(c, s->number, 3);
    default: return false;
    }
}

static int lower(lowering *l, int shape, point p);

/* The child as a function of its own, since it is called at several points. They share `offset`. */
static int child_function(lowering *l, int shape, bool join_box, const sdfc_shape *owner,
                          const int offset[3]) {
    int before = open_function(l), function = l->function;
    const point start = {0, 1, 2, {offset[0], offset[1], offset[2]}};
    int d = lower(l, shape, start);
    double lipschitz = l->c->shapes[shape].facts.lipschitz;
    if (join_box) {
        int outside;
        int e[6];
        for (int i = 0; i < 3; i++) e[i] = relative(l, &start, i, owner->extra[4 + i]);
        for (int i = 3; i < 6; i++) e[i] = constant(l, owner->extra[4 + i]);
        outside = OP(l, around_box, 0, 1, 2, e[0], e[1], e[2], e[3], e[4], e[5]);
        if (owner->kind == SDFC_KIND_POLAR) {
            int cosine = constant(l, owner->extra[1]);
            int wedge = OP(l, around_wedge, 0, 2, cosine, constant(l, owner->extra[2]));
            outside = OP(l, max, outside, wedge);
        }
        d = OP(l, max, d, OP(l, mul, outside, constant(l, lipschitz)));
    }
    l->program->functions[function].result = d;
    l->function = before;
    return function;
}

/* The distance to all of it, where no cell that was looked at is near. */
static int capped(lowering *l, int d, int least, const sdfc_facts *f, point p) {
    int ends = 0, axis = 0, at[3] = {p.x, p.y, p.z};
    int e[6], cap = least, first = l->program->functions[l->function].count;
    for (int i = 0; i < 3; i++) {
        if (!isfinite(f->box.low[i]) || !isfinite(f->box.high[i])) continue;
        ends++;
        axis = i;
    }
    if (ends == 1) { /* rows without end: a slab */
        int from = OP(l, sub, at[axis], relative(l, &p, axis, (f->box.low[axis] + f->box.high[axis]) / 2));
        int outside = OP(l, sub, OP(l, abs, from), constant(l, (f->box.high[axis] - f->box.low[axis]) / 2));
        least = OP(l, max, least, OP(l, mul, outside, constant(l, f->lipschitz)));
    } else if (ends) {
        for (int i = 0; i < 3; i++) {
            bool end = isfinite(f->box.low[i]) && isfinite(f->box.high[i]);
            e[i] = end ? relative(l, &p, i, (f->box.low[i] + f->box.high[i]) / 2) : constant(l, 0);
            e[3 + i] = constant(l, end ? (f->box.high[i] - f->box.low[i]) / 2 : 1e30);
        }
        int outside = OP(l, around_box, p.x, p.y, p.z, e[0], e[1], e[2], e[3], e[4], e[5]);
        least = OP(l, max, least, OP(l, mul, outside, constant(l, f->lipschitz)));
    }
    int result = OP(l, min, d, least);
    if (cap < 0) {
        sdfc_function *f2 = &l->program->functions[l->function];
        f2->terms = sdfc_grow(l->c, f2->terms, f2->term_count, &f2->term_capacity, sizeof *f2->terms,
                              INSTRS_MAX, "terms of a part");
        f2->terms[f2->term_count++] = (sdfc_term){.first = first, .last = f2->count - 1, .bit = -1, .cap = cap};
    }
    return result;
}

/* ---- the root transform ---- */

/* Arguments `first` on, `count` of them; count 1: the one stands for three. */
static void add_root_step(lowering *l, int kind, int first, int count) {
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

/* What the offset has gathered is a movement too. At the end of the root transform it needs no
 * arguments where nothing of all this changes with time: nothing has moved. */
static void gather_root(lowering *l, const point *p, bool ends) {
    if (!has_offset(p)) return;
    bool timed = !ends || sdfc_root_moves(l->c, l->program);
    for (int i = 0; i < 3; i++) timed = timed || l->c->exprs[offset_of(l, p, i)].timed;
    if (!timed) return;
    int first = l->program->arg_count;
    for (int i = 0; i < 3; i++) argument(l, against(l, p, i));
    add_root_step(l, SDFC_KIND_TRANSLATE, first, 3);
}

/* ---- terms ---- */

/* Inside of something that takes the point apart in another way than terms know. */
static int lower_whole(lowering *l, int shape, point p) {
    double stretch = l->stretch;
    l->stretch = 0;
    int d = lower(l, shape, p);
    l->stretch = stretch;
    return d;
}

static bool has_terms(const lowering *l, const sdfc_shape *s) {
    if (!(l->stretch > 0) || s->children < 2 || s->facts.estimate) return false;
    if (l->in_cells && s->kind != SDFC_KIND_UNION && s->kind != SDFC_KIND_SMOOTH_UNION) return false;
    if (!l->folded) return true;
    for (int i = 0; i < s->children; i++) {
        if (l->folded & ~l->c->shapes[s->child[i]].facts.symmetric) return false;
    }
    return l->at_fold;
}

static void add_term(lowering *l, const sdfc_shape *s, int child, int first, int smooth) {
    sdfc_function *f = &l->program->functions[l->function];
    double lipschitz = s->extra[0] != 0 ? 1 : s->facts.lipschitz;
    if (f->count == first) return;
    f->terms = sdfc_grow(l->c, f->terms, f->term_count, &f->term_capacity, sizeof *f->terms, INSTRS_MAX,
                         "terms of a part");
    f->terms[f->term_count++] =
        (sdfc_term){.first = first,
                    .last = f->count - 1,
                    .bit = -1,
                    .smooth = smooth,
                    .opens = child == 0,
                    .most = s->kind != SDFC_KIND_UNION && s->kind != SDFC_KIND_SMOOTH_UNION,
                    .lipschitz = lipschitz * l->stretch};
}

/* ---- operators ---- */

static int lower_repeat(lowering *l, const sdfc_shape *s, point p) {
    bool limited = s->kind == SDFC_KIND_REPEAT_LIMITED;
    point rest = p; /* the offset that the axes which do not repeat keep */
    for (int i = 0; i < 3; i++) {
        if (s->extra[i] != 0) rest.offset[i] = 0;
        if (s->extra[i] == 0) p.offset[i] = 0;
        if (!p.offset[i]) continue; /* whole periods of it do not matter */
        p.offset[i] =
            1 + sdfc_apply(l->c, SDFC_fold, p.offset[i] - 1, s->number[i], s->number[3 + i]);
    }
    p = settled(l, p);
    memcpy(p.offset, rest.offset, sizeof p.offset);
    int in[3] = {p.x, p.y, p.z}, cell[3][SDFC_CELLS_MAX], bits = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < SDFC_CELLS_MAX; k++) cell[i][k] = in[i];
        if (s->extra[i] == 0) continue;
        int period = argument(l, s->number[i]), inverse = argument(l, s->number[3 + i]);
        int half = 0, shift = 0;
        if (limited) {
            half = constant(l, (s->whole[i] - 1) / 2.0);
            shift = constant(l, s->whole[i] % 2 ? 0 : 0.5); /* where the middle of a cell is */
            if (s->extra[i] < 4) cell[i][0] = OP(l, fold_row, in[i], period, inverse, half, shift);
        } else {
            cell[i][0] = OP(l, fold, in[i], period, inverse);
        }
        bits += s->extra[i] == 4 ? 2 : s->extra[i] == 2;
        if (s->extra[i] == 2) {
            cell[i][1] = limited ? OP(l, beside_row, in[i], period, inverse, half, shift)
                                 : OP(l, beside, cell[i][0], period);
        }
        for (int k = 0; k < 4 && limited && s->extra[i] == 4; k++) {
            cell[i][k] = OP(l, window_row, in[i], period, inverse, half, shift, constant(l, k));
        }
        static const int steps[] = {0, 1, -1, 2};
        for (int k = 1; k < 4 && !limited && s->extra[i] == 4; k++) {
            int by = sdfc_apply(l->c, SDFC_mul, s->number[i], sdfc_number(l->c, steps[k]), 0);
            cell[i][k] = OP(l, beside, cell[i][0], argument(l, by));
        }
    }
    unsigned folded = l->folded;
    bool at_fold = l->at_fold;
    for (int i = 0; i < 3; i++) l->folded |= s->extra[i] == 1 ? 1u << i : 0;
    l->at_fold = !folded; /* one fold inside of another: whose axes they are is not followed */
    if (!bits) {
        point q = {cell[0][0], cell[1][0], cell[2][0], {p.offset[0], p.offset[1], p.offset[2]}};
        int d = lower(l, s->child[0], q);
        l->folded = folded, l->at_fold = at_fold;
        return d;
    }
    bool in_cells = l->in_cells;
    l->in_cells = true;
    int function = child_function(l, s->child[0], s->extra[10] != 0, s, p.offset);
    l->folded = folded, l->at_fold = at_fold, l->in_cells = in_cells;
    const sdfc_facts *child = &l->c->shapes[s->child[0]].facts;
    int reach[6];
    for (int i = 0; i < 3; i++) {
        double corner = fmax(fabs(child->box.low[i]), fabs(child->box.high[i]));
        bool sorted = s->extra[i] == 2 || (s->extra[i] == 4 && !limited);
        int e = isfinite(corner) && sorted
                    ? sdfc_apply(l->c, SDFC_sub, s->number[i], sdfc_number(l->c, corner), 0)
                    : sdfc_number(l->c, -1e30);
        reach[i] = argument(l, e);
    }
    reach[3] = constant(l, l->stretch > 0 ? child->growth : 0);
    reach[4] = constant(l, s->extra[11]);
    reach[5] = constant(l, child->lipschitz * fmax(l->stretch, 1e-30));
    sdfc_instr *call = add_instr(l, SDFC_CALL_MIN);
    call->aux = function;
    call->points = 1 << bits;
    memcpy(call->operand + 12, reach, sizeof reach);
    memcpy(call->operand, cell, sizeof cell);
    for (int i = 0, first = 1; i < 3; i++) {
        call->bits[i] = s->extra[i] == 4 ? 2 : s->extra[i] == 2;
        call->select[i] = call->bits[i] ? first : 0;
        first += call->bits[i];
    }
    int d = last_variable(l);
    return isfinite(s->extra[3]) ? capped(l, d, constant(l, s->extra[3]), &s->facts, p) : d;
}

/* Into half a sector around +x, of a shape that is its own mirror image in z: reflections alone, each of which halves the
 * angle that is left, counted in half sectors. A turn by an angle that was found takes 3 to 5 times as much. */
static point fold_sectors(lowering *l, int count, point p) {
    const double pi = 3.14159265358979323846;
    p.z = OP(l, abs, p.z);
    for (int left = count; left > 1;) {
        left = (left + 1) / 2; /* what lies beyond that angle is mirrored there */
        if (2 * left == count) {
            p.x = OP(l, abs, p.x);
        } else if (4 * left == count) {
            int x = OP(l, max, p.x, p.z);
            p.z = OP(l, min, p.x, p.z);
            p.x = x;
        } else {
            double c = cos(pi * left / count), s = sin(pi * left / count);
            int d = OP(l, dot2, p.x, p.z, constant(l, s), constant(l, -c));
            p.x = OP(l, mirror, p.x, d, constant(l, 2 * s));
            p.z = OP(l, mirror, p.z, d, constant(l, -2 * c));
        }
    }
    return p;
}

/* The least of a function's values at two points of the same y. */
static int least_of_two(lowering *l, int function, point q, point r) {
    int none = constant(l, 0);
    sdfc_instr *call = add_instr(l, SDFC_CALL_MIN);
    *call = (sdfc_instr){.op = SDFC_CALL_MIN,
                         .aux = function,
                         .points = 2,
                         .select = {1, 0, 1},
                         .bits = {1, 0, 1},
                         .operand = {q.x, r.x, q.x, q.x, q.y, q.y, q.y, q.y, q.z, r.z, q.z, q.z}};
    for (int i = 12; i < SDFC_OPERANDS_MAX; i++) call->operand[i] = none;
    return last_variable(l);
}

/* The copies next to +x, as many as the analysis found. */
static int lower_copies(lowering *l, const sdfc_shape *s, point p) {
    const double pi = 3.14159265358979323846;
    int copies = (int)s->extra[11], d = 0;
    if (s->extra[0] == 5) p = fold_sectors(l, s->whole[0], p);
    double stretch = l->stretch;
    l->stretch = 0;
    int function = child_function(l, s->child[0], false, s, p.offset);
    l->stretch = stretch;
    for (int i = 0; i < copies; i += 2) {
        point q[2] = {p, p};
        for (int k = 0; k < 2 && i + k < copies; k++) { /* sectors 0, 1, -1, 2, ... */
            int n = i + k, sector = n % 2 ? (n + 1) / 2 : -n / 2;
            double a = 2 * pi * sector / s->whole[0];
            int cosine = constant(l, cos(a)), sine = constant(l, sin(a)),
                minus = constant(l, -sin(a));
            if (!sector) continue;
            q[k].x = OP(l, dot2, p.x, p.z, cosine, sine);
            q[k].z = OP(l, dot2, p.x, p.z, minus, cosine);
        }
        if (i + 1 == copies) q[1] = q[0];
        int e = least_of_two(l, function, q[0], q[1]);
        d = i ? OP(l, min, d, e) : e;
    }
    return d;
}

static int lower_polar(lowering *l, const sdfc_shape *s, point p) {
    if (s->extra[0] == 0) return lower(l, s->child[0], p);
    if (s->extra[0] == 1) return lower_whole(l, s->child[0], fold_sectors(l, s->whole[0], p));
    if (s->extra[0] >= 4) return lower_copies(l, s, p);
    int sector = constant(l, 6.283185307179586 / s->whole[0]);
    int zero = constant(l, 0), one = constant(l, 1);
    int a = OP(l, polar_angle, p.x, p.z, sector, zero);
    point q = {OP(l, turn_x, p.x, p.z, a), p.y, OP(l, turn_z, p.x, p.z, a), {0}};
    int b = OP(l, polar_angle, p.x, p.z, sector, one);
    point r = {OP(l, turn_x, p.x, p.z, b), p.y, OP(l, turn_z, p.x, p.z, b), {0}};
    double stretch = l->stretch;
    l->stretch = 0;
    int function = child_function(l, s->child[0], s->extra[10] != 0, s, p.offset);
    l->stretch = stretch;
    int d = least_of_two(l, function, q, r);
    if (s->extra[0] == 2) return d;
    int edge = OP(l, mul, OP(l, len2, p.x, p.z), constant(l, s->extra[3] * s->facts.lipschitz));
    return capped(l, d, edge, &s->facts, p);
}

/* Boxes without an end are as wide as fp32 can square. */
static int outside_box(lowering *l, const sdfc_box *b, point p) {
    int e[6];
    for (int i = 0; i < 3; i++) {
        bool ends = isfinite(b->low[i]) && isfinite(b->high[i]);
        e[i] = constant(l, ends ? (b->low[i] + b->high[i]) / 2 : 0);
        e[3 + i] = constant(l, ends ? (b->high[i] - b->low[i]) / 2 : 1e30);
    }
    return OP(l, around_box, p.x, p.y, p.z, e[0], e[1], e[2], e[3], e[4], e[5]);
}

static int lower_bend(lowering *l, const sdfc_shape *s, point p) {
    int k = argument(l, s->number[0]);
    int along = OP(l, arc_along, p.x, p.y, k), across = OP(l, arc_across, p.x, p.y, k);
    int d = lower_whole(l, s->child[0], (point){along, across, p.z, {0}});
    int e[7];
    for (int i = 0; i < 3; i++) e[i] = argument(l, s->number[1 + i]);
    for (int i = 0; i < 4; i++) e[3 + i] = constant(l, s->extra[2 + i]);
    int outside =
        OP(l, around_arc, p.x, p.y, p.z, across, e[0], e[1], e[2], e[3], e[4], e[5], e[6]);
    outside = OP(l, max, outside, outside_box(l, &s->facts.box, p));
    int shell = OP(l, mul, outside, constant(l, s->extra[0]));
    return OP(l, max, shell, OP(l, min, d, OP(l, sub, constant(l, s->extra[1]), shell)));
}

static int lower_twist(lowering *l, const sdfc_shape *s, point p) {
    int a = OP(l, mul, p.y, argument(l, s->number[0]));
    point q = {OP(l, turn_x, p.x, p.z, a), p.y, OP(l, turn_z, p.x, p.z, a), {0}};
    int d = lower_whole(l, s->child[0], q);
    int radius = constant(l, s->extra[2]), middle = constant(l, s->extra[3]);
    int outside = OP(l, around_cylinder, p.x, p.y, p.z, radius, middle, constant(l, s->extra[4]));
    int shell = OP(l, mul, outside, constant(l, s->extra[0]));
    return OP(l, max, shell, OP(l, min, d, constant(l, s->extra[1])));
}

static point matrix(lowering *l, const sdfc_shape *s, point p) {
    int v[3];
    for (int i = 0; i < 3; i++) {
        int a = argument(l, s->number[3 * i]), b = argument(l, s->number[3 * i + 1]);
        v[i] = OP(l, dot3, p.x, p.y, p.z, a, b, argument(l, s->number[3 * i + 2]));
    }
    return (point){v[0], v[1], v[2], {0}};
}

static point reflect(lowering *l, point p, int nx, int ny, int nz) {
    int d = OP(l, dot3, p.x, p.y, p.z, nx, ny, nz);
    int x = OP(l, reflect, p.x, d, nx), y = OP(l, reflect, p.y, d, ny);
    return (point){x, y, OP(l, reflect, p.z, d, nz), {0}};
}

/* Into one octant, then across its diagonals into x >= y >= z: reflections only. Then the factor. */
static int lower_kaleidoscope(lowering *l, const sdfc_shape *s, point p) {
    int k = argument(l, s->number[0]);
    int shift[3];
    for (int i = 0; i < 3; i++) shift[i] = argument(l, s->number[1 + i]);
    for (int level = 0; level < s->whole[0]; level++) {
        int a = OP(l, abs, p.x), b = OP(l, abs, p.y), e = OP(l, abs, p.z);
        int high = OP(l, max, a, b), low = OP(l, min, a, b);
        int middle = OP(l, max, low, e), least = OP(l, min, low, e);
        int most = OP(l, max, high, middle);
        middle = OP(l, min, high, middle);
        int x = OP(l, sub, OP(l, mul, most, k), shift[0]);
        int y = OP(l, sub, OP(l, mul, middle, k), shift[1]);
        p = (point){x, y, OP(l, sub, OP(l, mul, least, k), shift[2]), {0}};
    }
    return OP(l, mul, lower_whole(l, s->child[0], p), argument(l, s->number[4]));
}

static int lower_joined(lowering *l, const sdfc_shape *s, point p) {
    int d = 0, k = 0, inverse = 0;
    bool smooth = s->kind >= SDFC_KIND_SMOOTH_UNION;
    if (smooth && s->children > 1) {
        k = argument(l, s->number[0]);
        inverse = argument(l, s->number[1]);
    }
    bool terms = has_terms(l, s), at_fold = l->at_fold;
    for (int i = 0; i < s->children; i++) {
        l->at_fold = at_fold;
        int first = l->program->functions[l->function].count;
        int e = lower(l, s->child[i], p);
        if (s->extra[0] != 0) {
            double lipschitz = l->c->shapes[s->child[i]].facts.lipschitz;
            e = OP(l, mul, e, constant(l, 1 / lipschitz));
        }
        if (i == 0) {
            d = e;
            terms = terms && d == last_variable(l);
            if (terms) add_term(l, s, i, first, k);
            continue;
        }
        switch (s->kind) {
        case SDFC_KIND_UNION: d = OP(l, min, d, e); break;
        case SDFC_KIND_INTERSECTION: d = OP(l, max, d, e); break;
        case SDFC_KIND_DIFFERENCE: d = OP(l, max, d, OP(l, neg, e)); break;
        case SDFC_KIND_SMOOTH_UNION: d = OP(l, smooth_min, d, e, k, inverse); break;
        case SDFC_KIND_SMOOTH_INTERSECTION: d = OP(l, smooth_max, d, e, k, inverse); break;
        default: d = OP(l, smooth_max, d, OP(l, neg, e), k, inverse); break;
        }
        if (terms) add_term(l, s, i, first, k);
    }
    return d;
}

static int lower_scale(lowering *l, const sdfc_shape *s, point p, bool root) {
    const int *n = s->number;
    int next = l->program->arg_count;
    int a[3] = {argument(l, n[0]), 0, 0};
    for (int i = 1; i < 3; i++) a[i] = n[i] == n[0] ? a[0] : argument(l, n[i]);
    int x = OP(l, mul, p.x, a[0]), y = OP(l, mul, p.y, a[1]), z = OP(l, mul, p.z, a[2]);
    if (root) {
        add_root_step(l, SDFC_KIND_SCALE, next, 1);
        sdfc_root_step *step = &l->program->root[l->program->root_count - 1];
        for (int i = 0; i < 3; i++) step->arg[i] = ~a[i];
    }
    point q = {x, y, z, {0}};
    for (int i = 0; i < 3; i++) {
        if (p.offset[i]) {
            q.offset[i] = 1 + sdfc_apply(l->c, SDFC_mul, p.offset[i] - 1, n[i], 0);
        }
    }
    double stretch = l->stretch, factor = 0;
    for (int i = 0; i < 3; i++) {
        factor = fmax(factor, fmax(fabs(l->c->exprs[n[i]].low), fabs(l->c->exprs[n[i]].high)));
    }
    l->stretch = isfinite(factor) ? stretch * factor : 0;
    int d = lower(l, s->child[0], q);
    l->stretch = stretch;
    int k = argument(l, n[3]);
    return s->extra[0] != 0 ? OP(l, unscale, d, k, p.x, p.y, p.z) : OP(l, mul, d, k);
}

static int lower_mirror(lowering *l, const sdfc_shape *s, point p) {
    const sdfc *c = l->c;
    const int *n = s->number;
    for (int i = 0; i < 3; i++) {
        if (fabs(c->exprs[n[i]].value) != 1) continue;
        int v = OP(l, abs, i == 0 ? p.x : i == 1 ? p.y : p.z);
        if (c->exprs[n[i]].value < 0) v = OP(l, neg, v);
        return lower(l, s->child[0],
                     (point){i == 0 ? v : p.x, i == 1 ? v : p.y, i == 2 ? v : p.z, {0}});
    }
    int x = argument(l, n[0]), y = argument(l, n[1]);
    return lower(l, s->child[0], reflect(l, p, x, y, argument(l, n[2])));
}

static int lower_displace(lowering *l, const sdfc_shape *s, point p) {
    const int *n = s->number;
    int d = lower(l, s->child[0], p), a = argument(l, n[0]);
    int x = argument(l, n[1]), y = argument(l, n[2]);
    p = settled(l, p);
    int w = OP(l, waves, p.x, p.y, p.z, x, y, argument(l, n[3]));
    return OP(l, add, d, OP(l, mul, w, a));
}

static int lower_displace_noise(lowering *l, const sdfc_shape *s, point p) {
    const int *n = s->number;
    int d = lower(l, s->child[0], p), a = argument(l, n[0]), k = argument(l, n[1]);
    p = settled(l, p);
    int x = OP(l, mul, p.x, k), y = OP(l, mul, p.y, k);
    int w = OP(l, noise, x, y, OP(l, mul, p.z, k));
    return OP(l, add, d, OP(l, mul, w, a));
}

/* ---- primitives ---- */

/* An operation whose operands are the point and the first `count` numbers. */
static int plain(lowering *l, int op, const sdfc_shape *s, point p, int count) {
    int operands[SDFC_OPERANDS_MAX] = {p.x, p.y, p.z};
    for (int i = 0; i < count; i++) operands[3 + i] = argument(l, s->number[i]);
    return op_n(l, op, 3 + count, operands);
}

static int lower_user(lowering *l, const sdfc_shape *s, point p) {
    sdfc_instr *call = add_instr(l, SDFC_CALL_USER);
    call->aux = s->user;
    call->operand[0] = p.x;
    call->operand[1] = p.y;
    call->operand[2] = p.z;
    int d = last_variable(l), outside = outside_box(l, &s->facts.box, p);
    return OP(l, max, d, OP(l, mul, outside, constant(l, s->facts.lipschitz)));
}

/* A capsule along an axis, as most are, has no slant to reckon with. */
static int lower_capsule(lowering *l, const sdfc_shape *s, point p) {
    const int v[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        const int *a = s->number, *d = s->number + 3;
        if (!sdfc_is(l->c, d[i], 0) || !sdfc_is(l->c, d[j], 0)) continue;
        if (!sdfc_constant(l->c, d[k]) || !(l->c->exprs[d[k]].value > 0)) continue;
        double half = l->c->exprs[d[k]].value / 2;
        int middle = sdfc_apply(l->c, SDFC_add, a[k], sdfc_number(l->c, half), a[k]);
        int e[5] = {argument(l, a[i]), argument(l, middle), argument(l, a[j]), constant(l, half),
                    argument(l, s->number[7])};
        return OP(l, stick, v[i], v[k], v[j], e[0], e[1], e[2], e[3], e[4]);
    }
    return plain(l, SDFC_capsule, s, p, 8);
}

/* The distance to a large sphere with its centre at `c`, expressions. */
static int lower_ground(lowering *l, const int c[3], int radius, point p) {
    int at[3], k = sdfc_apply(l->c, SDFC_neg, sdfc_apply(l->c, SDFC_mul, radius, radius, 0), 0, 0);
    for (int i = 0; i < 3; i++) {
        k = sdfc_apply(l->c, SDFC_add, k, sdfc_apply(l->c, SDFC_mul, c[i], c[i], 0), 0);
        at[i] = argument(l, c[i]); /* in the places of a translation's */
    }
    int excess = argument(l, k);
    return OP(l, ground_sphere, p.x, p.y, p.z, at[0], at[1], at[2], excess, argument(l, radius));
}

static int lower_primitive(lowering *l, const sdfc_shape *s, point p) {
    switch (s->kind) {
    case SDFC_KIND_SPHERE: {
        if (!has_offset(&p)) return plain(l, SDFC_sphere, s, p, 1);
        const int c[3] = {against(l, &p, 0), against(l, &p, 1), against(l, &p, 2)};
        return lower_ground(l, c, s->number[0], p);
    }
    case SDFC_KIND_BOX: return plain(l, SDFC_box, s, p, 3);
    case SDFC_KIND_ROUNDED_BOX: {
        int r = argument(l, s->number[3]), h[3];
        for (int i = 0; i < 3; i++) {
            int inner = sdfc_apply(l->c, SDFC_sub, s->number[i], s->number[3], 0);
            inner = sdfc_apply(l->c, SDFC_max, inner, sdfc_number(l->c, 0), 0);
            h[i] = argument(l, inner);
        }
        return OP(l, sub, OP(l, box, p.x, p.y, p.z, h[0], h[1], h[2]), r);
    }
    case SDFC_KIND_TORUS: return plain(l, SDFC_torus, s, p, 2);
    case SDFC_KIND_CAPSULE: return lower_capsule(l, s, p);
    case SDFC_KIND_CYLINDER: return plain(l, SDFC_cylinder, s, p, 2);
    case SDFC_KIND_CONE: return plain(l, SDFC_cone, s, p, 3);
    case SDFC_KIND_PLANE: {
        int d = plain(l, SDFC_dot3, s, p, 3), e = s->number[3];
        for (int i = 0; i < 3; i++) {
            if (!p.offset[i]) continue;
            int along = sdfc_apply(l->c, SDFC_mul, s->number[i], p.offset[i] - 1, 0);
            e = sdfc_apply(l->c, SDFC_sub, e, along, 0);
        }
        return OP(l, sub, d, argument(l, e));
    }
    case SDFC_KIND_ELLIPSOID: return plain(l, SDFC_ellipsoid, s, p, 4);
    case SDFC_KIND_BOX_FRAME: return plain(l, SDFC_box_frame, s, p, 4);
    case SDFC_KIND_OCTAHEDRON: return plain(l, SDFC_octahedron, s, p, 1);
    case SDFC_KIND_HEX_PRISM: return plain(l, SDFC_hex_prism, s, p, 2);
    case SDFC_KIND_TRI_PRISM: return plain(l, SDFC_tri_prism, s, p, 2);
    case SDFC_KIND_LINK: return plain(l, SDFC_link, s, p, 3);
    case SDFC_KIND_MENGER: return OP(l, menger, p.x, p.y, p.z, constant(l, s->whole[0]));
    case SDFC_KIND_SIERPINSKI: {
        int d = OP(l, sierpinski, p.x, p.y, p.z, constant(l, s->whole[0]));
        int zero = constant(l, 0), one = constant(l, 1);
        return OP(l, max, d, OP(l, around_box, p.x, p.y, p.z, zero, zero, zero, one, one, one));
    }
    case SDFC_KIND_MANDELBULB: {
        double bail = pow(10, 12.0 / s->whole[0]);
        int power = constant(l, s->whole[0]), limit = constant(l, bail);
        int levels = constant(l, s->whole[1]);
        int d = s->whole[0] == 8 ? OP(l, mandelbulb8, p.x, p.y, p.z, limit, levels)
                                 : OP(l, mandelbulb, p.x, p.y, p.z, power, limit, levels);
        if (s->whole[1] <= SDFC_SHALLOW_LEVELS) d = OP(l, mul, d, constant(l, 1.3));
        d = OP(l, min, d, constant(l, 0.25)); /* far away the estimate is none */
        int r = constant(l, pow(2, 1.0 / (s->whole[0] - 1)));
        return OP(l, max, d, OP(l, sphere, p.x, p.y, p.z, r));
    }
    default: return lower_user(l, s, p);
    }
}

static int lower(lowering *l, int shape, point p) {
    sdfc *c = l->c;
    /* A copy: expressions made below may move the array. */
    const sdfc_shape copy = c->shapes[shape], *s = &copy;
    const int *n = s->number;
    bool root = l->root;
    l->root = root && (s->kind == SDFC_KIND_TRANSLATE || s->kind == SDFC_KIND_ROTATE ||
                       s->kind == SDFC_KIND_ROTATE_EULER || s->kind == SDFC_KIND_SCALE);
    if (root && (!l->root || !hands_offset_on(l->c, s))) gather_root(l, &p, !l->root);
    if (!hands_offset_on(l->c, s)) p = settled(l, p);
    if (s->children == 0) return lower_primitive(l, s, p);
    l->at_fold = l->at_fold && s->kind >= SDFC_KIND_UNION && s->kind <= SDFC_KIND_SMOOTH_DIFFERENCE;
    int first = s->child[0], next = l->program->arg_count;
    switch (s->kind) {
    case SDFC_KIND_TRANSLATE: {
        if (has_offset(&p)) return lower(l, first, moved_offset(l, p, n));
        if (is_ground(l->c, s)) {
            if (root) add_root_step(l, SDFC_KIND_TRANSLATE, next, 3);
            return lower_ground(l, n, l->c->shapes[first].number[0], p);
        }
        int x = OP(l, sub, p.x, argument(l, n[0])), y = OP(l, sub, p.y, argument(l, n[1]));
        int z = OP(l, sub, p.z, argument(l, n[2]));
        if (root) add_root_step(l, SDFC_KIND_TRANSLATE, next, 3);
        return lower(l, first, (point){x, y, z, {0}});
    }
    case SDFC_KIND_ROTATE:
    case SDFC_KIND_ROTATE_EULER: {
        point turned = matrix(l, s, p);
        if (has_offset(&p)) turn_offset(l, s, &p, &turned);
        if (root) add_root_step(l, SDFC_KIND_ROTATE, next, 9);
        return lower(l, first, turned);
    }
    case SDFC_KIND_SCALE: return lower_scale(l, s, p, root);
    case SDFC_KIND_MIRROR: return lower_mirror(l, s, p);
    case SDFC_KIND_REPEAT:
    case SDFC_KIND_REPEAT_LIMITED: return lower_repeat(l, s, p);
    case SDFC_KIND_POLAR: return lower_polar(l, s, p);
    case SDFC_KIND_TWIST: return lower_twist(l, s, p);
    case SDFC_KIND_BEND: return lower_bend(l, s, p);
    case SDFC_KIND_ELONGATE: {
        int x = OP(l, elongate, p.x, argument(l, n[0]));
        int y = OP(l, elongate, p.y, argument(l, n[1]));
        return lower(l, first, (point){x, y, OP(l, elongate, p.z, argument(l, n[2])), {0}});
    }
    case SDFC_KIND_ONION: {
        int d = lower(l, first, p);
        return OP(l, onion, d, argument(l, n[0]));
    }
    case SDFC_KIND_ROUND: {
        int d = lower(l, first, p);
        return OP(l, sub, d, argument(l, n[0]));
    }
    case SDFC_KIND_DISPLACE: return lower_displace(l, s, p);
    case SDFC_KIND_DISPLACE_NOISE: return lower_displace_noise(l, s, p);
    case SDFC_KIND_MORPH: {
        int a = lower(l, first, p), b = lower(l, s->child[1], p);
        return OP(l, mix, a, b, argument(l, n[0]));
    }
    case SDFC_KIND_KALEIDOSCOPE: return lower_kaleidoscope(l, s, p);
    default: return lower_joined(l, s, p);
    }
}

void sdfc_lower(sdfc *c, sdfc_part *part) {
    lowering l = {.c = c, .program = &part->program, .root = true, .stretch = 1};
    c->at = part->token;
    open_function(&l);
    int root = l.function;
    point whole = entry;
    for (int i = 0; i < 3 && c->anchored; i++) whole.offset[i] = c->anchor_expr[i] + 1;
    int d = lower(&l, part->shape, whole);
    part->program.functions[root].result = d;
    int variables = 0;
    for (int i = 0; i < part->program.function_count; i++) {
        part->program.functions[i].first_variable = variables;
        variables += 3 + part->program.functions[i].count;
    }
    part->program.variable_count = variables;
}
