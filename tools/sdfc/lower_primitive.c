/* lower_primitive.c: shapes without children become operations; see lower.c. */
#include "sdfc/lower.h"

/* An operation whose operands are the point and the first `count` numbers. */
static int plain(sdfc_lowering *l, int op, const sdfc_shape *s, sdfc_point p, int count) {
    int operands[SDFC_OPERANDS_MAX] = {p.x, p.y, p.z};
    for (int i = 0; i < count; i++) operands[3 + i] = sdfc_argument(l, s->number[i]);
    return sdfc_op_n(l, op, 3 + count, operands);
}

static int lower_user(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    sdfc_instr *call = sdfc_add_instr(l, SDFC_CALL_USER);
    call->aux = s->user;
    call->operand[0] = p.x;
    call->operand[1] = p.y;
    call->operand[2] = p.z;
    int d = sdfc_last_variable(l), outside = sdfc_outside_box(l, &s->facts.box, p);
    return OP(l, max, d, OP(l, mul, outside, sdfc_literal(l, s->facts.lipschitz)));
}

/* A capsule along an axis, as most are, has no slant to reckon with. */
static int lower_capsule(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    const int v[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        const int *a = s->number, *d = s->number + 3;
        if (!sdfc_is(l->c, d[i], 0) || !sdfc_is(l->c, d[j], 0)) continue;
        if (!sdfc_constant(l->c, d[k]) || !(l->c->exprs[d[k]].value > 0)) continue;
        double half = l->c->exprs[d[k]].value / 2;
        int middle = sdfc_apply(l->c, SDFC_add, a[k], sdfc_number(l->c, half), a[k]);
        int e[5] = {sdfc_argument(l, a[i]), sdfc_argument(l, middle), sdfc_argument(l, a[j]),
                    sdfc_literal(l, half), sdfc_argument(l, s->number[7])};
        return OP(l, stick, v[i], v[k], v[j], e[0], e[1], e[2], e[3], e[4]);
    }
    return plain(l, SDFC_capsule, s, p, 8);
}

/* The distance to a large sphere with its centre at `c`, expressions. */
int sdfc_lower_ground(sdfc_lowering *l, const int c[3], int radius, sdfc_point p) {
    int at[3], k = sdfc_apply(l->c, SDFC_neg, sdfc_apply(l->c, SDFC_mul, radius, radius, 0), 0, 0);
    for (int i = 0; i < 3; i++) {
        k = sdfc_apply(l->c, SDFC_add, k, sdfc_apply(l->c, SDFC_mul, c[i], c[i], 0), 0);
        at[i] = sdfc_argument(l, c[i]); /* in the slots of a translation */
    }
    int excess = sdfc_argument(l, k);
    return OP(l, ground_sphere, p.x, p.y, p.z, at[0], at[1], at[2], excess,
              sdfc_argument(l, radius));
}

static int lower_fractal(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    int levels = sdfc_literal(l, s->whole[0]), n[4] = {0},
        count = s->kind == SDFC_KIND_JULIA       ? 4
                : s->kind == SDFC_KIND_MANDELBOX ? 1
                                                 : 2;
    for (int i = 0; i < count; i++) n[i] = sdfc_argument(l, s->number[i]);
    if (s->kind == SDFC_KIND_APOLLONIAN)
        return OP(l, apollonian, p.x, p.y, p.z, levels, n[0], n[1]);
    if (s->kind == SDFC_KIND_MANDELBOX) {
        int d = OP(l, mandelbox, p.x, p.y, p.z, levels, n[0]);
        return OP(l, max, d, sdfc_outside_box(l, &s->facts.box, p));
    }
    int d = OP(l, julia, p.x, p.y, p.z, n[0], n[1], n[2], n[3], levels);
    d = OP(l, min, d, sdfc_literal(l, 0.25)); /* far away the estimate is none */
    return OP(l, max, d, OP(l, sphere, p.x, p.y, p.z, sdfc_literal(l, s->facts.radius)));
}

int sdfc_lower_primitive(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p) {
    switch (s->kind) {
    case SDFC_KIND_ROUND_CONE: return plain(l, SDFC_round_cone, s, p, 9);
    case SDFC_KIND_CAPPED_TORUS: return plain(l, SDFC_capped_torus, s, p, 4);
    case SDFC_KIND_PYRAMID: return plain(l, SDFC_pyramid, s, p, 2);
    case SDFC_KIND_BEZIER: return plain(l, SDFC_bezier, s, p, 10);
    case SDFC_KIND_ROUNDED_CYLINDER: return plain(l, SDFC_rounded_cylinder, s, p, 3);
    case SDFC_KIND_SOLID_ANGLE: return plain(l, SDFC_solid_angle, s, p, 3);
    case SDFC_KIND_CUT_SPHERE: return plain(l, SDFC_cut_sphere, s, p, 3);
    case SDFC_KIND_TRIANGLE: {
        int n[6];
        for (int i = 0; i < 6; i++) n[i] = sdfc_argument(l, s->number[i]);
        return OP(l, flat_triangle, p.x, p.y, n[0], n[1], n[2], n[3], n[4], n[5]);
    }
    case SDFC_KIND_NGON:
    case SDFC_KIND_STAR: {
        int sector = sdfc_literal(l, 6.283185307179586 / s->whole[0]),
            r = sdfc_argument(l, s->number[0]);
        int a = sdfc_argument(l, s->number[1]);
        if (s->kind == SDFC_KIND_NGON) return OP(l, ngon, p.x, p.y, sector, r, a);
        return OP(l, star, p.x, p.y, sector, r, a, sdfc_argument(l, s->number[2]));
    }
    case SDFC_KIND_HEART: return OP(l, heart, p.x, p.y, sdfc_argument(l, s->number[0]));
    case SDFC_KIND_GYROID: return plain(l, SDFC_gyroid, s, p, 2);
    case SDFC_KIND_TERRAIN: {
        int height = sdfc_argument(l, s->number[0]), f = sdfc_argument(l, s->number[1]);
        int octaves = sdfc_literal(l, s->whole[0]), gain = sdfc_argument(l, s->number[2]);
        return OP(l, terrain, p.x, p.y, p.z, height, f, octaves, gain);
    }
    case SDFC_KIND_APOLLONIAN:
    case SDFC_KIND_MANDELBOX:
    case SDFC_KIND_JULIA: return lower_fractal(l, s, p);
    case SDFC_KIND_SPHERE: {
        if (!sdfc_has_offset(&p)) return plain(l, SDFC_sphere, s, p, 1);
        const int c[3] = {sdfc_against(l, &p, 0), sdfc_against(l, &p, 1), sdfc_against(l, &p, 2)};
        return sdfc_lower_ground(l, c, s->number[0], p);
    }
    case SDFC_KIND_BOX: return plain(l, SDFC_box, s, p, 3);
    case SDFC_KIND_ROUNDED_BOX: {
        int r = sdfc_argument(l, s->number[3]), h[3];
        for (int i = 0; i < 3; i++) {
            int inner = sdfc_apply(l->c, SDFC_sub, s->number[i], s->number[3], 0);
            inner = sdfc_apply(l->c, SDFC_max, inner, sdfc_number(l->c, 0), 0);
            h[i] = sdfc_argument(l, inner);
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
        return OP(l, sub, d, sdfc_argument(l, e));
    }
    case SDFC_KIND_ELLIPSOID: return plain(l, SDFC_ellipsoid, s, p, 4);
    case SDFC_KIND_BOX_FRAME: return plain(l, SDFC_box_frame, s, p, 4);
    case SDFC_KIND_OCTAHEDRON: return plain(l, SDFC_octahedron, s, p, 1);
    case SDFC_KIND_HEX_PRISM: return plain(l, SDFC_hex_prism, s, p, 2);
    case SDFC_KIND_TRI_PRISM: return plain(l, SDFC_tri_prism, s, p, 2);
    case SDFC_KIND_LINK: return plain(l, SDFC_link, s, p, 3);
    case SDFC_KIND_MENGER: return OP(l, menger, p.x, p.y, p.z, sdfc_literal(l, s->whole[0]));
    case SDFC_KIND_SIERPINSKI: {
        int d = OP(l, sierpinski, p.x, p.y, p.z, sdfc_literal(l, s->whole[0]));
        int zero = sdfc_literal(l, 0), one = sdfc_literal(l, 1);
        return OP(l, max, d, OP(l, around_box, p.x, p.y, p.z, zero, zero, zero, one, one, one));
    }
    case SDFC_KIND_MANDELBULB: {
        double bail = pow(10, 12.0 / s->whole[0]);
        int power = sdfc_literal(l, s->whole[0]), limit = sdfc_literal(l, bail);
        int levels = sdfc_literal(l, s->whole[1]);
        int d = s->whole[0] == 8 ? OP(l, mandelbulb8, p.x, p.y, p.z, limit, levels)
                                 : OP(l, mandelbulb, p.x, p.y, p.z, power, limit, levels);
        if (s->whole[1] <= SDFC_SHALLOW_LEVELS) d = OP(l, mul, d, sdfc_literal(l, 1.3));
        d = OP(l, min, d, sdfc_literal(l, 0.25)); /* far away the estimate is none */
        int r = sdfc_literal(l, pow(2, 1.0 / (s->whole[0] - 1)));
        return OP(l, max, d, OP(l, sphere, p.x, p.y, p.z, r));
    }
    default: return lower_user(l, s, p);
    }
}
