/* box.c: bounds of all listed parts at the current parameters and time. sdfc_facts has bounds for
 * all values at once, which are too wide for clipping rays: for a ball of radius r that stands on
 * the ground, with r from 0.2 to 1.4, they are -1.2 to 2.8, and the ball is from 0 to 2 r.
 *
 * So the bounds are computed as expressions where this is exact: through translations and
 * repetitions down to balls and boxes. Everything else has the constant bounds of the analysis, and
 * so has a scene with too many parts for bits: the expressions would be most of the update's code.
 * Only changing bounds become slots; the update writes them once per frame. */
#include "sdfc/internal.h"

/* One side of a box along one axis. */
typedef struct bound {
    int expr;     /* -1: only the constant */
    double value; /* +-INFINITY: endless */
    double slack; /* what rounding in fp32 may have taken from expr */
} bound;

static int expr_of(sdfc *c, bound b) { return b.expr < 0 ? sdfc_number(c, b.value) : b.expr; }

/* Replaces the constant by an expression. */
static bound changing(sdfc *c, int expr, double slack) {
    const sdfc_expr *e = &c->exprs[expr];
    double most = fmin(fmax(fabs(e->low), fabs(e->high)), 1e4);
    return (bound){expr, e->value, slack + most * 2.4e-7};
}

static bound moved(sdfc *c, bound b, int by) {
    if (!isfinite(b.value)) return b;
    if (b.expr < 0 && sdfc_constant(c, by)) return (bound){-1, b.value + c->exprs[by].value, 0};
    return changing(c, sdfc_apply(c, SDFC_add, expr_of(c, b), by, by), b.slack);
}

/* Half a size of 0 or more, to either side. */
static bound half_size(sdfc *c, int size, bool high) {
    int half = sdfc_apply(c, SDFC_max, size, sdfc_number(c, 0), size);
    return changing(c, high ? half : sdfc_apply(c, SDFC_neg, half, half, half), 0);
}

static bound extent(sdfc *c, int shape, int axis, bool high) {
    const sdfc_shape *s = &c->shapes[shape];
    bound constant = {-1, high ? s->facts.box.high[axis] : s->facts.box.low[axis], 0};
    if (c->part_count > MASU_SDFC_MASKED_MAX) return constant;
    bool repeats = s->kind == SDFC_KIND_REPEAT && s->extra[axis] != 0;
    bool local = false; /* cells have individual sizes */
    for (int i = 0; i < 3; i++) local = local || (s->children < 2 && c->exprs[s->number[i]].local);
    if (local) return constant;
    if (s->kind == SDFC_KIND_PAINT) return extent(c, s->child[0], axis, high);
    if (s->kind == SDFC_KIND_TRANSLATE) {
        return moved(c, extent(c, s->child[0], axis, high), s->number[axis]);
    }
    if (s->kind == SDFC_KIND_REPEAT && !repeats) return extent(c, s->child[0], axis, high);
    int size = s->number[s->kind == SDFC_KIND_BOX ? axis : 0];
    if ((s->kind == SDFC_KIND_SPHERE || s->kind == SDFC_KIND_BOX) && c->exprs[size].dynamic) {
        return half_size(c, size, high);
    }
    return constant;
}

static bound joined(sdfc *c, bound a, bound b, bool high) {
    if (!isfinite(a.value) || !isfinite(b.value)) return isfinite(a.value) ? b : a;
    if (a.expr < 0 && b.expr < 0) {
        return (bound){-1, high ? fmax(a.value, b.value) : fmin(a.value, b.value), 0};
    }
    int x = expr_of(c, a), y = expr_of(c, b);
    return (bound){sdfc_apply(c, high ? SDFC_max : SDFC_min, x, y, x), a.value,
                   fmax(a.slack, b.slack)};
}

/* The expression of one side, or -1: endless. Relative to an anchor the sums would need two floats
 * each: there is no box then. */
int sdfc_box_side(sdfc *c, int axis, bool high) {
    int listed = c->part_count - c->flat_parts;
    if (c->anchored || !listed) return -1;
    bound all = extent(c, c->parts[0].shape, axis, high);
    for (int i = 1; i < listed; i++) {
        all = joined(c, all, extent(c, c->parts[i].shape, axis, high), high);
    }
    if (!isfinite(all.value)) return -1;
    int side = expr_of(c, all);
    return sdfc_apply(c, high ? SDFC_add : SDFC_sub, side, sdfc_number(c, all.slack), side);
}
