/* spirv_cost.c: see spirv_cost.h. Opcodes: Khronos SPIR-V specification, section 3.42; extended
 * instructions: SPIR-V extended instructions for GLSL, section 2. */
#include "lab/model/spirv_cost.h"

/* Cost of an operation on one component, in units of the peak figure, in which an addition is 1 and
 * a fused multiply-add 2.
 *
 * Addition, multiplication, comparison, selection, integer operations, conversions: 1. GPUs issue
 * each at full rate. The peak figure is twice the issue rate because two of them may be fused; a
 * lower bound must assume that they are.
 *
 * Reciprocal, square root and its inverse, exp2, log2, sin, cos: 4. They run at quarter rate on
 * Intel's Gen 9 to 12, on GCN and RDNA, and on phones. If they block the other units they cost 8 of
 * these units; if they run in parallel (Gen 12's extended math) less. The lower bound uses the
 * smaller value.
 *
 * Integer multiplication: 4, quarter rate on GCN, split in halves by Intel. Integer division: 20, a
 * sequence on all. Negation, absolute value: 0, operand modifiers on all of these. */
enum { ADD = 1, SPECIAL = 4, MULTIPLY_INT = 4, DIVIDE_INT = 20, FREE = 0 };

typedef struct range_cost {
    uint16_t first, last; /* opcodes */
    uint8_t plain, weighted;
} range_cost;

/* clang-format off */
/* Per component of the result. */
static const range_cost core[] = {
    {109, 112, 1, ADD},       /* conversions of int and float */
    {115, 115, 1, ADD},       /* of the width of floats */
    {126, 126, 1, ADD},       /* SNegate */
    {127, 127, 0, FREE},      /* FNegate */
    {128, 131, 1, ADD},       /* IAdd, FAdd, ISub, FSub */
    {132, 132, 1, MULTIPLY_INT},
    {133, 133, 1, ADD},       /* FMul */
    {134, 135, 1, DIVIDE_INT},
    {136, 136, 1, SPECIAL + ADD}, /* FDiv: a reciprocal, a product */
    {137, 139, 1, DIVIDE_INT},
    {140, 141, 1, SPECIAL + 4 * ADD}, /* FRem, FMod */
    {142, 143, 1, ADD},       /* vector, matrix times scalar */
    {154, 155, 1, ADD},       /* Any, All */
    {156, 157, 1, ADD},       /* IsNan, IsInf */
    {164, 191, 1, ADD},       /* logic, Select, comparisons */
    {194, 200, 1, ADD},       /* shifts, bits */
    {201, 205, 1, ADD},       /* bit fields, BitReverse, BitCount */
    {207, 209, 1, 2 * ADD},   /* derivatives: a difference across the quad, and its scaling */
    {227, 242, 1, ADD},       /* atomics */
};

/* Per component of the result. */
static const range_cost extended[] = {
    {1, 3, 1, ADD},                   /* Round, RoundEven, Trunc */
    {4, 4, 0, FREE},                  /* FAbs */
    {5, 5, 1, ADD},                   /* SAbs */
    {6, 7, 1, 2 * ADD},               /* FSign, SSign */
    {8, 10, 1, ADD},                  /* Floor, Ceil, Fract */
    {11, 12, 1, ADD},                 /* Radians, Degrees */
    {13, 14, 1, SPECIAL},             /* Sin, Cos */
    {15, 15, 1, 3 * SPECIAL + ADD},   /* Tan: a sine over a cosine */
    {16, 18, 1, SPECIAL + 8 * ADD},   /* Asin, Acos, Atan: a root or 1/x, a polynomial */
    {19, 24, 1, 3 * SPECIAL + 4 * ADD},
    {25, 25, 1, SPECIAL + 12 * ADD},  /* Atan2 */
    {26, 26, 1, 2 * SPECIAL + ADD},   /* Pow: exp2(y * log2(x)) */
    {27, 28, 1, SPECIAL + ADD},       /* Exp, Log: of base 2, scaled */
    {29, 32, 1, SPECIAL},             /* Exp2, Log2, Sqrt, InverseSqrt */
    {35, 36, 1, 2 * ADD},             /* Modf */
    {37, 45, 1, ADD},                 /* minima, maxima, of which a clamp is two: */
    {43, 45, 1, 2 * ADD},
    {46, 46, 1, 2 * ADD},             /* FMix: a difference, a fused product */
    {48, 48, 1, ADD},                 /* Step */
    {49, 49, 1, SPECIAL + 8 * ADD},   /* SmoothStep */
    {50, 50, 1, 2 * ADD},             /* Fma */
    {51, 53, 1, ADD},                 /* Frexp, Ldexp */
    {73, 75, 1, ADD},                 /* FindLsb, FindMsb */
    {79, 80, 1, ADD},                 /* NMin, NMax */
    {81, 81, 1, 2 * ADD},             /* NClamp */
};
/* clang-format on */

uint32_t masu_spirv_components(const spirv_module *m, uint32_t type) {
    uint32_t n = 1;
    /* A matrix of vectors of scalars; a type may refer to itself. */
    for (uint32_t depth = 0; depth < 3; depth++) {
        const spirv_instruction *t = spirv_def(m, type);
        if (!t) return 0;
        if (t->op == 20 || t->op == SPIRV_TYPE_INT || t->op == SPIRV_TYPE_FLOAT) return n;
        if (t->op != SPIRV_TYPE_VECTOR && t->op != SPIRV_TYPE_MATRIX) return 0;
        n *= t->word[3];
        type = t->word[2];
    }
    return 0;
}

uint32_t masu_spirv_type_of(const spirv_module *m, uint32_t id) {
    const spirv_instruction *d = spirv_def(m, id);
    if (!d || d->count < 3 || (d->op >= 19 && d->op <= 39) || d->op == SPIRV_LABEL) return 0;
    return d->word[1];
}

static masu_spirv_cost times(uint32_t n, uint32_t plain, uint32_t weighted) {
    return (masu_spirv_cost){n * plain, n * weighted};
}

static masu_spirv_cost ranged(const range_cost *list, size_t count, uint32_t op, uint32_t n) {
    masu_spirv_cost cost = {0, 0};
    for (size_t k = 0; k < count; k++) {
        if (op >= list[k].first && op <= list[k].last)
            cost = times(n, list[k].plain, list[k].weighted); /* the last match */
    }
    return cost;
}

static masu_spirv_cost extended_cost(const spirv_module *m, const spirv_instruction *i) {
    uint32_t n = masu_spirv_components(m, i->word[1]);
    uint32_t in = i->count > 5 ? masu_spirv_components(m, masu_spirv_type_of(m, i->word[5])) : 0;
    switch (i->word[4]) {
    case 33: return times(1, 5 * n, 5 * n);                             /* Determinant */
    case 34: return times(1, 14 * n, SPECIAL + 14 * n);                 /* MatrixInverse */
    case 66: return times(1, 2 * in, 2 * in - 1 + SPECIAL);             /* Length */
    case 67: return times(1, 3 * in, 3 * in - 1 + SPECIAL);             /* Distance */
    case 68: return times(1, 9, 9);                                     /* Cross */
    case 69: return times(1, 3 * n, 3 * n - 1 + SPECIAL);               /* Normalize */
    case 70: return times(1, 3 * n, 3 * n);                             /* FaceForward */
    case 71: return times(1, 4 * n, 4 * n);                             /* Reflect */
    case 72: return times(1, 5 * n + 6, 5 * n + 6 + SPECIAL);           /* Refract */
    case 54: case 55: return times(1, 12, 12);                          /* PackSnorm/Unorm4x8 */
    case 56: case 57: return times(1, 6, 6);                            /* PackSnorm/Unorm2x16 */
    case 58: return times(1, 2, 2);                                     /* PackHalf2x16 */
    case 60: case 61: return times(1, 4, 4);                            /* UnpackSnorm/Unorm2x16 */
    case 62: return times(1, 2, 2);                                     /* UnpackHalf2x16 */
    case 63: case 64: return times(1, 8, 8);                            /* UnpackSnorm/Unorm4x8 */
    default: return ranged(extended, sizeof extended / sizeof *extended, i->word[4], n);
    }
}

masu_spirv_cost masu_spirv_cost_of(const spirv_module *m, const spirv_instruction *i) {
    const uint32_t *w = i->word;
    if (i->op == SPIRV_EXT_INST && i->count > 4) return extended_cost(m, i);
    if (i->op < 109 || i->op > 242 || i->count < 3) return times(0, 0, 0);
    if (i->op == 228) return times(0, 0, 0); /* AtomicStore: has no result type */
    uint32_t n = masu_spirv_components(m, w[1]);
    uint32_t in = i->count > 3 ? masu_spirv_components(m, masu_spirv_type_of(m, w[3])) : 0;
    uint32_t in2 = i->count > 4 ? masu_spirv_components(m, masu_spirv_type_of(m, w[4])) : 0;
    /* Dot products of length k: k products, k - 1 sums. */
    switch (i->op) {
    case 144: /* VectorTimesMatrix: in = k, n results */
        return times(n, 2 * in - 1, 2 * in - 1);
    case 145: /* MatrixTimesVector: in2 = k */
        return times(n, 2 * in2 - 1, 2 * in2 - 1);
    case 146: { /* MatrixTimesMatrix: left r x k, right k x c; r c = n, r k = in, k c = in2 */
        uint32_t k = 1;
        while (k < 4 && (uint64_t)k * k * n < (uint64_t)in * in2) k++;
        return times(n, 2 * k - 1, 2 * k - 1);
    }
    case 147: return times(n, 1, 1);                      /* OuterProduct */
    case 148: return times(1, 2 * in - 1, 2 * in - 1);    /* Dot */
    case 154: case 155: return times(1, in - 1, in - 1);  /* Any, All */
    default: return ranged(core, sizeof core / sizeof *core, i->op, n);
    }
}

masu_spirv_cost masu_spirv_cost_straight(const spirv_module *m) {
    masu_spirv_cost sum = {0, 0};
    int inside = 0;
    for (size_t k = 0; k < m->count; k++) {
        if (m->list[k].op == SPIRV_FUNCTION) inside = 1;
        if (m->list[k].op == SPIRV_FUNCTION_END) inside = 0;
        if (!inside) continue;
        masu_spirv_cost one = masu_spirv_cost_of(m, &m->list[k]);
        sum.plain += one.plain;
        sum.weighted += one.weighted;
    }
    return sum;
}
