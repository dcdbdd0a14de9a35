/* analyse.c: static analysis of a field (sdfc_facts): its Lipschitz constant, bounds of the solid,
 * and how fast the field grows outside those bounds. Every operator has a rule. If a rule's
 * precondition fails (a twist of an unbounded shape, a repeated shape that is larger than its
 * cell), compilation reports an error at the operator.
 *
 * `growth` makes the bounds sound. A field that is only a lower bound of the distance can stay
 * small far away, so the solid "f <= r" of round(r) can extend further than r. With f >= growth *
 * distance(box), a margin of r / growth is sufficient.
 *
 * The rules are in analyse_primitive.c and analyse_operator.c; this file applies them and checks
 * their limits.
 *
 * For operators that need derived numbers (the rotation's matrix, 1 / scale), the analysis replaces
 * their arguments by the derived expressions, so that constants fold and the others are computed
 * once per frame. */
#include "sdfc/facts.h"

void sdfc_analyse(sdfc *c, int shape) {
    sdfc_shape s = c->shapes[shape];
    sdfc_facts f;
    if (s.children == 0) {
        f = sdfc_primitive_facts(c, &s);
    } else {
        f = sdfc_operator_facts(c, &s);
        double cost = f.cost + 1;
        int depth = 0, size = 1;
        bool user = false, truth = true, estimate = false;
        for (int i = 0; i < s.children; i++) {
            const sdfc_facts *g = &c->shapes[s.child[i]].facts;
            if (i) cost += g->cost;
            depth = depth < g->depth ? g->depth : depth;
            size = size < SDFC_TREE_MAX && g->size <= SDFC_TREE_MAX ? size + g->size
                                                                    : SDFC_TREE_MAX + 1;
            user = user || g->user;
            estimate = estimate || g->estimate;
            truth = truth && g->truth;
        }
        f.cost = cost;
        f.depth = depth + 1;
        f.size = size;
        f.user = user;
        f.estimate = estimate;
        f.truth = truth;
    }
    sdfc_tighten(&f);
    if (f.depth > MASU_SDFC_DEPTH_MAX) {
        sdfc_fail(c, s.token, "expected at most %d levels of nesting", MASU_SDFC_DEPTH_MAX);
    }
    if (!(f.lipschitz < 1e12) || !(f.growth > 1e-12)) {
        sdfc_fail(c, s.token, "%s: expected a field with a Lipschitz constant below 1e12",
                  sdfc_kinds[s.kind].name);
    }
    for (int i = 0; i < 3; i++) { /* beyond what fp32 can square */
        if (!(f.box.low[i] >= -1e15)) f.box.low[i] = -SDFC_INFINITY;
        if (!(f.box.high[i] <= 1e15)) f.box.high[i] = SDFC_INFINITY;
        if (!isfinite(f.center[i])) f.radius = SDFC_INFINITY;
    }
    if (!(f.radius <= 1e15)) f.radius = SDFC_INFINITY;
    f.rising &= f.symmetric;
    s.facts = f;
    c->shapes[shape] = s;
}
