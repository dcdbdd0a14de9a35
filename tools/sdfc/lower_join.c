/* lower_join.c: unions, cuts and blends become operations; see lower.c. */
#include "sdfc/lower.h"

/* Joins the next operand e to d, the value of the operands so far. */
static int join(sdfc_lowering *l, const sdfc_shape *s, int d, int e, int k, int inverse) {
    switch (s->kind) {
    case SDFC_KIND_UNION: return OP(l, min, d, e);
    case SDFC_KIND_INTERSECTION: return OP(l, max, d, e);
    case SDFC_KIND_DIFFERENCE: return OP(l, max, d, OP(l, neg, e));
    case SDFC_KIND_SMOOTH_UNION: return OP(l, smooth_min, d, e, k, inverse);
    case SDFC_KIND_SMOOTH_INTERSECTION: return OP(l, smooth_max, d, e, k, inverse);
    case SDFC_KIND_CHAMFER: return OP(l, chamfer, d, e, k);
    case SDFC_KIND_STAIRS: return OP(l, stairs, d, e, k, inverse);
    case SDFC_KIND_XOR: return OP(l, xor, d, e);
    default: return OP(l, smooth_max, d, OP(l, neg, e), k, inverse);
    }
}

static sdfc_look joined_look(sdfc_lowering *l, const sdfc_shape *s, int d, int e, int k,
                             int inverse, sdfc_look a, sdfc_look b) {
    bool cut = s->kind == SDFC_KIND_DIFFERENCE || s->kind == SDFC_KIND_SMOOTH_DIFFERENCE;
    if (cut && !b.painted) return a; /* a cut shows the material of the cut shape */
    if (!a.painted && !b.painted) return a;
    switch (s->kind) {
    case SDFC_KIND_INTERSECTION: return sdfc_mixed_look(l, a, b, OP(l, less, d, e), true);
    case SDFC_KIND_DIFFERENCE: return sdfc_mixed_look(l, a, b, OP(l, less, d, OP(l, neg, e)), true);
    case SDFC_KIND_SMOOTH_UNION:
        return sdfc_mixed_look(l, a, b, OP(l, share_min, d, e, k, inverse), false);
    case SDFC_KIND_SMOOTH_INTERSECTION:
        return sdfc_mixed_look(l, a, b, OP(l, share_max, d, e, k, inverse), false);
    case SDFC_KIND_SMOOTH_DIFFERENCE:
        return sdfc_mixed_look(l, a, b, OP(l, share_max, d, OP(l, neg, e), k, inverse), false);
    case SDFC_KIND_XOR: return sdfc_mixed_look(l, a, b, OP(l, share_xor, d, e), true);
    default: return sdfc_mixed_look(l, a, b, OP(l, less, e, d), true);
    }
}

/* All operands at once, so that their order does not matter: see blend_two in library_joins.inc. An
 * operand that is farther than the previous ones by the radius has a weight of exactly 0: it is a
 * term. */
static int lower_blend(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int f[SDFC_CHILDREN_MAX] = {0}, n = s->children;
    sdfc_look looks[SDFC_CHILDREN_MAX] = {{0}};
    int k = sdfc_argument(l, s->number[0]), inverse = sdfc_argument(l, s->number[1]);
    bool terms = sdfc_has_terms(l, s), at_fold = l->at_fold;
    int m = 0;
    for (int i = 0; i < n; i++) {
        l->at_fold = at_fold;
        int first = l->program->functions[l->function].count;
        f[i] = sdfc_lower_shape(l, s->child[i], p);
        looks[i] = l->look;
        if (terms && i > 0) {
            f[i] = OP(l, second, m, f[i]);
            sdfc_add_term(l, s, i, first, k);
        }
        if (n > 2 || terms) m = i ? OP(l, min, m, f[i]) : f[0];
    }
    int t = m, zero = sdfc_literal(l, 0);
    if (n == 2) t = OP(l, blend_two, f[0], f[1], k);
    for (int step = 0; step < (n < 4 ? 5 : 7) + n / 8 && n > 2; step++) {
        int squares = zero, sum = zero;
        for (int i = 0; i < n; i++) {
            squares = OP(l, hinge_squared, squares, f[i], t, inverse);
            sum = OP(l, hinge, sum, f[i], t, inverse);
        }
        t = OP(l, blend_step, t, squares, sum, k);
    }
    if (!l->surface) return t;
    int sum = OP(l, hinge, zero, f[0], t, inverse);
    sdfc_look look = looks[0];
    for (int i = 1; i < n; i++) { /* the accumulated material has the weight of its operands */
        sum = OP(l, hinge, sum, f[i], t, inverse);
        look = sdfc_mixed_look(l, look, looks[i], OP(l, share_blend, sum, f[i], t, inverse), false);
    }
    l->look = look;
    return t;
}

int sdfc_lower_joined(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int d = 0, k = 0, inverse = 0;
    bool smooth = s->kind >= SDFC_KIND_SMOOTH_UNION && s->kind != SDFC_KIND_XOR;
    if (s->kind == SDFC_KIND_BLEND && s->children > 1) return lower_blend(l, s, p);
    if (smooth && s->children > 1) {
        k = sdfc_argument(l, s->number[0]);
        inverse = sdfc_argument(l, s->number[1]);
    }
    bool terms = sdfc_has_terms(l, s), at_fold = l->at_fold;
    sdfc_look look = {0};
    for (int i = 0; i < s->children; i++) {
        l->at_fold = at_fold;
        int first = l->program->functions[l->function].count;
        int e = sdfc_lower_shape(l, s->child[i], p);
        if (s->extra[0] != 0) {
            double lipschitz = l->c->shapes[s->child[i]].facts.lipschitz;
            e = OP(l, mul, e, sdfc_literal(l, 1 / lipschitz));
        }
        if (i == 0) {
            d = e;
            look = l->look;
            terms = terms && d == sdfc_last_variable(l);
            if (terms) sdfc_add_term(l, s, i, first, k);
            continue;
        }
        int before = d;
        d = join(l, s, d, e, k, inverse);
        if (terms) sdfc_add_term(l, s, i, first, k);
        if (l->surface) look = joined_look(l, s, before, e, k, inverse, look, l->look);
    }
    l->look = look;
    return d;
}
