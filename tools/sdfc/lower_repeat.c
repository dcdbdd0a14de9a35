/* lower_repeat.c: repetitions become operations: folds, and the least of several cells; see
 * lower.c. */
#include "sdfc/lower.h"

#include <string.h>

/* Passes inputs to the function of a cell: the coordinates before the fold and 1 / period, and the
 * surrounding cells. */
static void add_names(sdfc_lowering *l, const sdfc_shape *s, const int in[3], int out[9]) {
    int none = s->cell || l->cells ? sdfc_literal(l, 0) : 0;
    for (int i = 0; i < 9; i++) out[i] = none;
    for (int i = 0; i < 3 && s->cell; i++) {
        out[i] = in[i];
        if (s->extra[i] != 0) out[3 + i] = sdfc_argument(l, s->number[3 + i]);
    }
    if (l->cells > 3)
        sdfc_fail(l->c, s->token, "expected at most 4 repetitions with names inside each other");
    for (int i = 0; i < l->cells; i++) out[6 + i] = l->seed[i];
}

static int lower_in_cell(sdfc_lowering *l, const sdfc_shape *s, sdfc_point q, int seed) {
    if (s->cell) {
        if (l->cells == SDFC_CELLS_DEEP)
            sdfc_fail(l->c, s->token,
                      "expected at most 4 repetitions with names inside each other");
        l->cell[l->cells] = s->cell - 1;
        l->sector[l->cells] = s->kind == SDFC_KIND_POLAR;
        l->seed[l->cells++] = seed;
    }
    int d = sdfc_lower_shape(l, s->child[0], q);
    if (l->surface && !l->look.painted && s->cell && l->c->materials[l->material].cellular) {
        l->look = sdfc_lower_material(l, l->material, q);
    }
    l->cells -= s->cell != 0;
    return d;
}

/* One cell, which has a name. */
static int lower_alone(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p, unsigned folded,
                       bool at_fold) {
    int zero = sdfc_literal(l, 0);
    int seed = OP(l, cell_seed, p.x, p.y, p.z, p.x, p.y, p.z, zero, zero, zero);
    int d = lower_in_cell(l, s, p, seed);
    l->folded = folded, l->at_fold = at_fold;
    return d;
}

/* For a surface: the shape in the cell whose number the last operation has found. */
static int lower_nearest(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p, int nearest) {
    const sdfc_function *f = &l->program->functions[l->function];
    const sdfc_instr call = f->instrs[f->count - 1];
    int q[3], seed = 0;
    for (int i = 0; i < 3; i++) {
        const int *at = call.operand + 4 * i;
        q[i] = at[0];
        if (!call.bits[i]) continue;
        int unit = sdfc_literal(l, ldexp(1, 1 - call.select[i])),
            most = sdfc_literal(l, (1 << call.bits[i]) - 1);
        q[i] = OP(l, pick, nearest, unit, most, at[0], at[1], at[2], at[3]);
    }
    if (s->cell) {
        const int *in = call.operand + 18, *inverse = call.operand + 21;
        seed = OP(l, cell_seed, in[0], in[1], in[2], q[0], q[1], q[2], inverse[0], inverse[1],
                  inverse[2]);
    }
    sdfc_point at = {q[0], q[1], q[2], {p.offset[0], p.offset[1], p.offset[2]}};
    return lower_in_cell(l, s, at, seed);
}

int sdfc_lower_repeat(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    bool limited = s->kind == SDFC_KIND_REPEAT_LIMITED;
    sdfc_point rest = p; /* the offset that the axes which do not repeat keep */
    for (int i = 0; i < 3; i++) {
        if (s->extra[i] != 0) rest.offset[i] = 0;
        if (s->extra[i] == 0) p.offset[i] = 0;
        if (!p.offset[i]) continue; /* whole periods have no effect */
        p.offset[i] =
            1 + sdfc_apply(l->c, SDFC_fold, p.offset[i] - 1, s->number[i], s->number[3 + i]);
    }
    p = sdfc_settled(l, p);
    memcpy(p.offset, rest.offset, sizeof p.offset);
    int in[3] = {p.x, p.y, p.z}, cell[3][SDFC_CELLS_MAX], bits = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < SDFC_CELLS_MAX; k++) cell[i][k] = in[i];
        if (s->extra[i] == 0) continue;
        int period = sdfc_argument(l, s->number[i]), inverse = sdfc_argument(l, s->number[3 + i]);
        int half = 0, shift = 0;
        if (limited) {
            half = sdfc_literal(l, (s->whole[i] - 1) / 2.0);
            shift = sdfc_literal(l, s->whole[i] % 2 ? 0 : 0.5); /* the centre of a cell */
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
            cell[i][k] = OP(l, window_row, in[i], period, inverse, half, shift, sdfc_literal(l, k));
        }
        static const int steps[] = {0, 1, -1, 2};
        for (int k = 1; k < 4 && !limited && s->extra[i] == 4; k++) {
            int by = sdfc_apply(l->c, SDFC_mul, s->number[i], sdfc_number(l->c, steps[k]), 0);
            cell[i][k] = OP(l, beside, cell[i][0], sdfc_argument(l, by));
        }
    }
    unsigned folded = l->folded;
    bool at_fold = l->at_fold;
    for (int i = 0; i < 3; i++) l->folded |= s->extra[i] == 1 ? 1u << i : 0;
    l->at_fold = !folded; /* one fold inside of another: whose axes they are is not followed */
    if (!bits && s->cell) return lower_alone(l, s, p, folded, at_fold);
    if (!bits) {
        sdfc_point q = {
            cell[0][0], cell[1][0], cell[2][0], {p.offset[0], p.offset[1], p.offset[2]}};
        int d = sdfc_lower_shape(l, s->child[0], q);
        l->folded = folded, l->at_fold = at_fold;
        return d;
    }
    bool in_cells = l->in_cells;
    l->in_cells = true;
    int function = sdfc_child_function(l, s->child[0], s->extra[10] != 0, s, p.offset);
    l->folded = folded, l->at_fold = at_fold, l->in_cells = in_cells;
    const sdfc_facts *child = &l->c->shapes[s->child[0]].facts;
    int reach[6];
    for (int i = 0; i < 3; i++) {
        double corner = fmax(fabs(child->box.low[i]), fabs(child->box.high[i]));
        bool sorted = s->extra[i] == 2 || (s->extra[i] == 4 && !limited);
        int e = isfinite(corner) && sorted
                    ? sdfc_apply(l->c, SDFC_sub, s->number[i], sdfc_number(l->c, corner), 0)
                    : sdfc_number(l->c, -1e30);
        reach[i] = sdfc_argument(l, e);
    }
    reach[3] = sdfc_literal(l, l->stretch > 0 ? child->growth : 0);
    reach[4] = sdfc_literal(l, s->extra[11]);
    reach[5] = sdfc_literal(l, child->lipschitz * fmax(l->stretch, 1e-30));
    int names[9];
    add_names(l, s, in, names);
    sdfc_instr *call = sdfc_add_instr(l, l->surface ? SDFC_CALL_NEAREST : SDFC_CALL_MIN);
    call->aux = function;
    call->points = 1 << bits;
    call->named = s->cell != 0;
    call->around = (int16_t)l->cells;
    memcpy(call->operand + 18, names, sizeof names);
    memcpy(call->operand + 12, reach, sizeof reach);
    memcpy(call->operand, cell, sizeof cell);
    for (int i = 0, first = 1; i < 3; i++) {
        call->bits[i] = s->extra[i] == 4 ? 2 : s->extra[i] == 2;
        call->select[i] = call->bits[i] ? first : 0;
        first += call->bits[i];
    }
    int d = sdfc_last_variable(l);
    if (l->surface) return lower_nearest(l, s, p, d);
    return isfinite(s->extra[3]) ? sdfc_capped(l, d, sdfc_literal(l, s->extra[3]), &s->facts, p)
                                 : d;
}

/* Folds into half a sector around +x, for a shape that is symmetric in z: only reflections, each of
 * which halves the remaining angle, counted in half sectors. A rotation by a computed angle costs 3
 * to 5 times as much. */
static sdfc_point fold_sectors(sdfc_lowering *l, int count, sdfc_point p) {
    const double pi = 3.14159265358979323846;
    p.z = OP(l, abs, p.z);
    for (int left = count; left > 1;) {
        left = (left + 1) / 2; /* everything beyond that angle is mirrored into it */
        if (2 * left == count) {
            p.x = OP(l, abs, p.x);
        } else if (4 * left == count) {
            int x = OP(l, max, p.x, p.z);
            p.z = OP(l, min, p.x, p.z);
            p.x = x;
        } else {
            double c = cos(pi * left / count), s = sin(pi * left / count);
            int d = OP(l, dot2, p.x, p.z, sdfc_literal(l, s), sdfc_literal(l, -c));
            p.x = OP(l, mirror, p.x, d, sdfc_literal(l, 2 * s));
            p.z = OP(l, mirror, p.z, d, sdfc_literal(l, -2 * c));
        }
    }
    return p;
}

/* The least of a function's values at two points of the same y. `sectors`: theirs, if the
 * function takes it. */
static int least_of_two(sdfc_lowering *l, const sdfc_shape *s, int function, sdfc_point q,
                        sdfc_point r, const int *sectors, bool nearest) {
    int none = sdfc_literal(l, 0);
    if (l->cells > 3)
        sdfc_fail(l->c, s->token, "expected at most 4 repetitions with names inside each other");
    sdfc_instr *call = sdfc_add_instr(l, nearest ? SDFC_CALL_NEAREST : SDFC_CALL_MIN);
    *call = (sdfc_instr){.op = nearest ? SDFC_CALL_NEAREST : SDFC_CALL_MIN,
                         .around = (int16_t)l->cells,
                         .named = s->cell ? 2 : 0,
                         .aux = function,
                         .points = 2,
                         .select = {1, 0, 1},
                         .bits = {1, 0, 1},
                         .operand = {q.x, r.x, q.x, q.x, q.y, q.y, q.y, q.y, q.z, r.z, q.z, q.z}};
    for (int i = 12; i < 18; i++) call->operand[i] = none;
    for (int i = 0; i < 2 && s->cell; i++) call->operand[18 + i] = sectors[i];
    for (int i = 0; i < call->around; i++) call->operand[24 + i] = l->seed[i];
    return sdfc_last_variable(l);
}

/* a, or b where `second` is 1; of the same y */
static sdfc_point nearer(sdfc_lowering *l, int second, sdfc_point a, sdfc_point b) {
    a.x = OP(l, select, second, b.x, a.x);
    a.z = OP(l, select, second, b.z, a.z);
    return a;
}

/* The copies next to +x, as many as the analysis found. */
static int lower_copies(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    const double pi = 3.14159265358979323846;
    int copies = (int)s->extra[11], d = 0, number = 0;
    sdfc_point best = p;
    if (s->extra[0] == 5) p = fold_sectors(l, s->whole[0], p);
    double stretch = l->stretch;
    l->stretch = 0;
    int function = sdfc_child_function(l, s->child[0], false, s, p.offset);
    l->stretch = stretch;
    for (int i = 0; i < copies; i += 2) {
        sdfc_point q[2] = {p, p};
        int sectors[2] = {0};
        for (int k = 0; k < 2 && i + k < copies; k++) { /* sectors 0, 1, -1, 2, ... */
            int n = i + k, sector = n % 2 ? (n + 1) / 2 : -n / 2;
            double a = 2 * pi * sector / s->whole[0];
            int cosine = sdfc_literal(l, cos(a)), sine = sdfc_literal(l, sin(a)),
                minus = sdfc_literal(l, -sin(a));
            if (s->cell) sectors[k] = sdfc_literal(l, (sector + s->whole[0]) % s->whole[0]);
            if (!sector) continue;
            q[k].x = OP(l, dot2, p.x, p.z, cosine, sine);
            q[k].z = OP(l, dot2, p.x, p.z, minus, cosine);
        }
        if (i + 1 == copies) {
            q[1] = q[0];
            sectors[1] = sectors[0];
        }
        int e = least_of_two(l, s, function, q[0], q[1], sectors, false);
        if (l->surface) {
            int second = least_of_two(l, s, function, q[0], q[1], sectors, true);
            sdfc_point at = nearer(l, second, q[0], q[1]);
            int closer = i ? OP(l, less, e, d) : 0;
            best = i ? nearer(l, closer, best, at) : at;
            if (s->cell) {
                int own = OP(l, select, second, sectors[1], sectors[0]);
                number = i ? OP(l, select, closer, own, number) : own;
            }
        }
        d = i ? OP(l, min, d, e) : e;
    }
    return l->surface ? lower_in_cell(l, s, best, number) : d;
}

int sdfc_lower_polar(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    if (s->extra[0] == 0) return lower_in_cell(l, s, p, s->cell ? sdfc_literal(l, 0) : 0);
    if (s->extra[0] == 1) return sdfc_lower_whole(l, s->child[0], fold_sectors(l, s->whole[0], p));
    if (s->extra[0] >= 4) return lower_copies(l, s, p);
    int sector = sdfc_literal(l, 6.283185307179586 / s->whole[0]);
    int zero = sdfc_literal(l, 0), one = sdfc_literal(l, 1);
    int a = OP(l, polar_angle, p.x, p.z, sector, zero);
    sdfc_point q = {OP(l, turn_x, p.x, p.z, a), p.y, OP(l, turn_z, p.x, p.z, a), {0}};
    int b = OP(l, polar_angle, p.x, p.z, sector, one);
    sdfc_point r = {OP(l, turn_x, p.x, p.z, b), p.y, OP(l, turn_z, p.x, p.z, b), {0}};
    double stretch = l->stretch;
    l->stretch = 0;
    int function = sdfc_child_function(l, s->child[0], s->extra[10] != 0, s, p.offset);
    l->stretch = stretch;
    int sectors[2] = {0}, count = sdfc_literal(l, s->whole[0]),
        inverse = sdfc_literal(l, s->whole[0] / 6.283185307179586);
    for (int k = 0; k < 2 && s->cell; k++)
        sectors[k] = OP(l, sector_number, k ? b : a, inverse, count);
    int d = least_of_two(l, s, function, q, r, sectors, l->surface);
    if (l->surface)
        return lower_in_cell(l, s, nearer(l, d, q, r),
                             s->cell ? OP(l, select, d, sectors[1], sectors[0]) : 0);
    if (s->extra[0] == 2) return d;
    int edge = OP(l, mul, OP(l, len2, p.x, p.z), sdfc_literal(l, s->extra[3] * s->facts.lipschitz));
    return sdfc_capped(l, d, edge, &s->facts, p);
}
