/* analyse_join.c: the facts of unions, cuts and blends; see analyse.c. */
#include "sdfc/facts.h"

#include <string.h>

/* Fields of different constants are divided by them before a hard union, so that one stiff shape
 * does not slow the others. Not before a blend: that would change its form. */
static bool levelled(const sdfc *c, const sdfc_shape *s) {
    if (s->kind != SDFC_KIND_UNION && s->kind != SDFC_KIND_INTERSECTION &&
        s->kind != SDFC_KIND_DIFFERENCE) {
        return false;
    }
    for (int i = 1; i < s->children; i++) {
        if (c->shapes[s->child[i]].facts.lipschitz != c->shapes[s->child[0]].facts.lipschitz) {
            return true;
        }
    }
    return false;
}

/* How far n successive smooth minima are below the minimum of their n operands, in units of k. The
 * maximum is at equal operands. If the value is y k below the minimum, a step lowers it to (y + (1
 * - y)^2 / 4) k, which increases with y on 0..1 and stays below 1. */
static double lowered(int n) {
    double y = 0;
    for (int i = 1; i < n; i++) y += (1 - y) * (1 - y) / 4;
    return y;
}

/* Widths by which n equal operands are lowered: halfway to the next again and again, or of a
 * blend. */
static double lowered_by(int kind, int n) {
    switch (kind) {
    case SDFC_KIND_SMOOTH_UNION: return lowered(n);
    case SDFC_KIND_CHAMFER:
    case SDFC_KIND_STAIRS: return 1 - ldexp(1, 1 - n);
    case SDFC_KIND_BLEND: return 1 - 1 / sqrt(n);
    default: return 0;
    }
}

/* Whether it ends in some direction: then a growth is claimed there. */
static bool ends_somewhere(const sdfc_box *b) {
    for (int i = 0; i < 3; i++) {
        if (isfinite(b->low[i]) || isfinite(b->high[i])) return true;
    }
    return false;
}

sdfc_facts sdfc_joined_facts(sdfc *c, sdfc_shape *s) {
    bool level = levelled(c, s);
    bool is_union = s->kind == SDFC_KIND_UNION || s->kind == SDFC_KIND_SMOOTH_UNION ||
                    s->kind >= SDFC_KIND_CHAMFER;
    bool is_cut = s->kind == SDFC_KIND_DIFFERENCE || s->kind == SDFC_KIND_SMOOTH_DIFFERENCE;
    sdfc_facts f = {0};
    int boxes = 0;
    s->extra[0] = level;
    for (int i = 0; i < s->children; i++) {
        sdfc_facts g = c->shapes[s->child[i]].facts;
        if (level) {
            g.growth /= g.lipschitz;
            g.lipschitz = 1;
        }
        if (i == 0) {
            f = g;
            boxes = ends_somewhere(&g.box);
            continue;
        }
        f.lipschitz = fmax(f.lipschitz, g.lipschitz);
        f.symmetric &= g.symmetric;
        f.rising &= is_cut ? 0 : g.rising;
        if (is_union) {
            sdfc_join(&f, &g);
            f.growth = fmin(f.growth, g.growth);
        } else if (!is_cut) {
            if (g.radius < f.radius) {
                f.radius = g.radius;
                memcpy(f.center, g.center, sizeof f.center);
            }
            for (int k = 0; k < 3; k++) {
                double from = fmax(f.box.low[k], g.box.low[k]);
                double to = fmin(f.box.high[k], g.box.high[k]);
                f.box.low[k] = fmin(from, to);
                f.box.high[k] = fmax(from, to);
            }
            f.growth = fmin(f.growth, g.growth);
            boxes += ends_somewhere(&g.box);
        }
    }
    /* outside several boxes at once, one of the distances is 1 / sqrt(n) of the whole */
    if (!is_union && !is_cut && boxes > 1) f.growth /= sqrt(fmin(boxes, 3));
    double by = lowered_by(s->kind, s->children);
    if (by > 0) sdfc_widen(&f, by * sdfc_size_of(c, s->number[0]) / f.growth);
    if (s->kind >= SDFC_KIND_CHAMFER) f.rising = 0;
    if (s->kind == SDFC_KIND_BLEND && !(sdfc_low(c, s->number[0]) > 0)) {
        sdfc_fail(c, s->token, "blend: expected a radius above 0");
    }
    if (s->kind == SDFC_KIND_CHAMFER || s->kind == SDFC_KIND_STAIRS) {
        if (sdfc_low(c, s->number[0]) < 0)
            sdfc_fail(c, s->token, "%s: expected a width from 0", sdfc_kinds[s->kind].name);
    }
    if (s->kind == SDFC_KIND_STAIRS)
        s->number[1] = sdfc_apply2(c, SDFC_mul, s->number[0], sdfc_number(c, 1.0 / s->whole[0]));
    else if (s->kind != SDFC_KIND_UNION && s->kind != SDFC_KIND_INTERSECTION &&
             s->kind != SDFC_KIND_DIFFERENCE)
        s->number[1] = sdfc_apply1(c, SDFC_rcp, s->number[0]);
    return f;
}
