/* spirv_reach.c: see spirv_reach.h. Propagates values and reachability together (Wegman and Zadeck,
 * "Constant Propagation with Conditional Branches", TOPLAS 1991): unreached code has no value yet
 * and is ignored at merges. Values only become less certain and reachability only grows, until
 * nothing changes. */
#include "lab/model/spirv_reach.h"

#include <stdlib.h>
#include <string.h>

enum {
    ENTRY_POINT = 15,
    SPEC_CONSTANT_TRUE = 48,
    SPEC_CONSTANT_FALSE = 49,
    SPEC_CONSTANT = 50,
    SPEC_CONSTANT_OP = 52,
    DECORATION_SPEC_ID = 1
};

/* Knowledge of a value. */
enum { NOTHING, CONSTANT, ANYTHING };

typedef struct reach {
    const spirv_module *m;
    const VkSpecializationInfo *special;
    uint32_t *value; /* by id */
    uint8_t *state;
    bool *reached; /* labels and functions */
    bool *inside;
    bool changed;
} reach;

/* Merges the new result of an instruction; two different values become ANYTHING. */
static void meet(reach *r, uint32_t id, uint8_t state, uint32_t value) {
    if (id >= r->m->bound) return;
    uint8_t was = r->state[id];
    if (was == CONSTANT && state == CONSTANT && r->value[id] != value) state = ANYTHING;
    if (state <= was) return;
    r->state[id] = state;
    r->value[id] = value;
    r->changed = true;
}

static void mark(reach *r, uint32_t id) {
    if (id >= r->m->bound || r->reached[id]) return;
    r->reached[id] = true;
    r->changed = true;
}

static uint8_t get(const reach *r, uint32_t id, uint32_t *value) {
    if (id >= r->m->bound) return ANYTHING;
    *value = r->value[id];
    return r->state[id];
}

/* The value from the host, else the module's default. */
static uint32_t specialised(const reach *r, uint32_t id, uint32_t otherwise) {
    uint32_t number, value;
    if (!r->special || !spirv_decoration(r->m, id, DECORATION_SPEC_ID, &number)) return otherwise;
    for (uint32_t k = 0; k < r->special->mapEntryCount; k++) {
        const VkSpecializationMapEntry *e = &r->special->pMapEntries[k];
        if (e->constantID != number || e->size != sizeof value) continue;
        memcpy(&value, (const char *)r->special->pData + e->offset, sizeof value);
        return value;
    }
    return otherwise;
}

/* Evaluates an operation on two 32-bit values. */
static bool binary(uint32_t op, uint32_t a, uint32_t b, uint32_t *out) {
    int32_t x = (int32_t)a, y = (int32_t)b;
    switch (op) {
    case SPIRV_I_ADD: *out = a + b; return true;
    case SPIRV_I_SUB: *out = a - b; return true;
    case 164: *out = !a == !b; return true; /* LogicalEqual */
    case 165: *out = !a != !b; return true; /* LogicalNotEqual */
    case SPIRV_LOGICAL_OR: *out = a || b; return true;
    case SPIRV_LOGICAL_AND: *out = a && b; return true;
    case 170: *out = a == b; return true; /* IEqual */
    case 171: *out = a != b; return true; /* INotEqual */
    case SPIRV_U_GREATER_THAN: *out = a > b; return true;
    case SPIRV_S_GREATER_THAN: *out = x > y; return true;
    case SPIRV_U_GREATER_THAN_EQUAL: *out = a >= b; return true;
    case SPIRV_S_GREATER_THAN_EQUAL: *out = x >= y; return true;
    case SPIRV_U_LESS_THAN: *out = a < b; return true;
    case SPIRV_S_LESS_THAN: *out = x < y; return true;
    case SPIRV_U_LESS_THAN_EQUAL: *out = a <= b; return true;
    case SPIRV_S_LESS_THAN_EQUAL: *out = x <= y; return true;
    case 197: *out = a | b; return true;
    case 199: *out = a & b; return true;
    default: return false;
    }
}

/* Evaluates an operation; its operands start at w. */
static uint8_t evaluate(const reach *r, uint32_t op, const uint32_t *w, uint32_t count,
                        uint32_t *out) {
    uint32_t a = 0, b = 0;
    uint8_t first = count > 0 ? get(r, w[0], &a) : ANYTHING,
            second = count > 1 ? get(r, w[1], &b) : ANYTHING;
    switch (op) {
    case SPIRV_COPY_OBJECT:
    case SPIRV_BITCAST: *out = a; return first;
    case SPIRV_LOGICAL_NOT: *out = !a; return first;
    case SPIRV_SELECT:
        if (first != CONSTANT || count < 3) return first == NOTHING ? NOTHING : ANYTHING;
        return get(r, a ? w[1] : w[2], out);
    case SPIRV_LOGICAL_AND:
    case SPIRV_LOGICAL_OR:
        *out = op == SPIRV_LOGICAL_OR; /* one operand may decide */
        if ((first == CONSTANT && !a == !*out) || (second == CONSTANT && !b == !*out))
            return CONSTANT;
        break;
    default: break;
    }
    if (!binary(op, a, b, out)) return ANYTHING;
    return first == CONSTANT && second == CONSTANT ? CONSTANT
           : first == ANYTHING || second == ANYTHING ? ANYTHING
                                                     : NOTHING;
}

/* Merges the values from all reached predecessors. */
static uint8_t come_together(const reach *r, const spirv_instruction *i, uint32_t *out) {
    uint8_t state = NOTHING;
    for (uint32_t k = 3; k + 1 < i->count; k += 2) {
        uint32_t value = 0;
        if (i->word[k + 1] < r->m->bound && !r->reached[i->word[k + 1]]) continue;
        uint8_t one = get(r, i->word[k], &value);
        if (one == ANYTHING || (one == CONSTANT && state == CONSTANT && value != *out))
            return ANYTHING;
        if (one == CONSTANT) *out = value, state = CONSTANT;
    }
    return state;
}

static void leave(reach *r, const spirv_instruction *i) {
    const uint32_t *w = i->word;
    uint32_t value = 0;
    if (i->op == SPIRV_BRANCH) mark(r, w[1]);
    if (i->op == SPIRV_BRANCH_CONDITIONAL) {
        uint8_t state = get(r, w[1], &value);
        if (state == ANYTHING || (state == CONSTANT && value)) mark(r, w[2]);
        if (state == ANYTHING || (state == CONSTANT && !value)) mark(r, w[3]);
    }
    if (i->op == SPIRV_SWITCH) {
        uint8_t state = get(r, w[1], &value);
        bool taken = state == NOTHING;
        for (uint32_t k = 3; k + 1 < i->count; k += 2) {
            if (state == NOTHING || (state == CONSTANT && w[k] != value)) continue;
            mark(r, w[k + 1]);
            taken = taken || state == CONSTANT;
        }
        if (!taken) mark(r, w[2]);
    }
    if (i->op == SPIRV_FUNCTION_CALL) mark(r, w[3]);
}

static void constant(reach *r, const spirv_instruction *i) {
    const uint32_t *w = i->word;
    uint32_t value = 0;
    switch (i->op) {
    case SPIRV_CONSTANT_TRUE: meet(r, w[2], CONSTANT, 1); break;
    case SPIRV_CONSTANT_FALSE: meet(r, w[2], CONSTANT, 0); break;
    case SPIRV_CONSTANT:
        if (i->count == 4) meet(r, w[2], CONSTANT, w[3]);
        break;
    case SPEC_CONSTANT_TRUE: meet(r, w[2], CONSTANT, specialised(r, w[2], 1)); break;
    case SPEC_CONSTANT_FALSE: meet(r, w[2], CONSTANT, specialised(r, w[2], 0)); break;
    case SPEC_CONSTANT:
        if (i->count == 4) meet(r, w[2], CONSTANT, specialised(r, w[2], w[3]));
        break;
    case SPEC_CONSTANT_OP:
        if (i->count > 4) {
            uint8_t state = evaluate(r, w[3], w + 4, i->count - 4, &value);
            meet(r, w[2], state, value);
        }
        break;
    case ENTRY_POINT: mark(r, w[2]); break;
    default: break;
    }
}

/* One pass over the module: blocks follow the blocks that dominate them. */
static void walk(reach *r) {
    bool function = false, block = false, first = false;
    for (size_t k = 0; k < r->m->count; k++) {
        const spirv_instruction *i = &r->m->list[k];
        uint32_t value = 0;
        bool outside = i->op == SPIRV_FUNCTION_END;
        if (i->op == SPIRV_FUNCTION) function = r->reached[i->word[2]], block = false, first = true;
        if (outside) function = block = false;
        if (i->op == SPIRV_LABEL) {
            /* A function starts with its first block. */
            if (first && function) mark(r, i->word[1]);
            first = false;
            block = function && r->reached[i->word[1]];
        }
        if (!function && !outside) constant(r, i);
        r->inside[k] = block;
        if (!block) continue;
        leave(r, i);
        if (i->count < 3 || i->word[2] >= r->m->bound || r->m->def[i->word[2]] != i)
            continue; /* no result */
        uint8_t state = i->op == SPIRV_PHI ? come_together(r, i, &value)
                        : i->count > 3     ? evaluate(r, i->op, i->word + 3, i->count - 3, &value)
                                           : ANYTHING;
        meet(r, i->word[2], state, value);
    }
}

/* Results of instructions have no value yet; all other ids, such as globals and parameters, can
 * have any. */
static void begin(reach *r) {
    bool function = false;
    memset(r->state, ANYTHING, r->m->bound);
    for (size_t k = 0; k < r->m->count; k++) {
        const spirv_instruction *i = &r->m->list[k];
        function = (function || i->op == SPIRV_FUNCTION) && i->op != SPIRV_FUNCTION_END;
        bool result = i->count > 2 && i->word[2] < r->m->bound && r->m->def[i->word[2]] == i;
        bool boolean = i->op == SPIRV_CONSTANT_TRUE || i->op == SPIRV_CONSTANT_FALSE ||
                       i->op == SPEC_CONSTANT_TRUE || i->op == SPEC_CONSTANT_FALSE;
        bool number = boolean ||
                      ((i->op == SPIRV_CONSTANT || i->op == SPEC_CONSTANT) && i->count == 4) ||
                      i->op == SPEC_CONSTANT_OP;
        bool made = function && i->op != SPIRV_FUNCTION_PARAMETER && i->op != SPIRV_FUNCTION;
        if (result && (made || number)) r->state[i->word[2]] = NOTHING;
    }
}

bool masu_spirv_reach(const spirv_module *m, const VkSpecializationInfo *special, bool *inside) {
    reach r = {m, special, calloc(m->bound, sizeof(uint32_t)), calloc(m->bound, 1),
               calloc(m->bound, sizeof(bool)), inside, true};
    bool good = r.value && r.state && r.reached;
    if (good) begin(&r);
    while (good && r.changed) {
        r.changed = false;
        walk(&r);
    }
    free(r.value);
    free(r.state);
    free(r.reached);
    return good;
}

/* ---- Cost ------------------------------------------------------------------------------------ */

/* Mesa unrolls a loop of at most 32 iterations if its copies stay below 832 of its own instructions
 * (nir_opt_loop_unroll), two to three per operation. The numbers of loops of mirrors that remain in
 * the code for Iris Xe agree with this limit. Some loops above it are unrolled too: they count
 * once, which overestimates their pass. */
enum { UNROLLED_ITERATIONS = 32, UNROLLED_OPERATIONS = 320 };

static bool integer(const spirv_module *m, uint32_t id, int64_t *out) {
    const spirv_instruction *d = spirv_def(m, id);
    if (!d || d->op != SPIRV_CONSTANT || d->count != 4) return false;
    *out = (int32_t)d->word[3];
    return true;
}

/* Iterations of the loop `for (i = first; i < end; i += step)` of constants, whose condition is the
 * one of branch b; 0: another loop. */
static int64_t iterations(const spirv_module *m, const spirv_instruction *b) {
    const spirv_instruction *less = spirv_def(m, b->word[1]);
    if (b->op != SPIRV_BRANCH_CONDITIONAL || !less ||
        (less->op != SPIRV_S_LESS_THAN && less->op != SPIRV_U_LESS_THAN))
        return 0;
    const spirv_instruction *i = spirv_def(m, less->word[3]);
    int64_t first, end, step;
    if (!i || i->op != SPIRV_PHI || i->count != 7 || !integer(m, less->word[4], &end)) return 0;
    bool constant_first = integer(m, i->word[3], &first);
    if (!constant_first && !integer(m, i->word[5], &first)) return 0;
    const spirv_instruction *next = spirv_def(m, i->word[constant_first ? 5 : 3]);
    if (!next || next->op != SPIRV_I_ADD || next->word[3] != i->word[2] ||
        !integer(m, next->word[4], &step) || step <= 0 || end <= first)
        return 0;
    return (end - first + step - 1) / step;
}

/* The merge instruction of the loop that starts with the block of label k; 0: no loop does. */
static size_t loop_of(const spirv_module *m, size_t k) {
    while (++k < m->count && m->list[k].op != SPIRV_LABEL) {
        if (m->list[k].op == SPIRV_LOOP_MERGE) return k;
    }
    return 0;
}

/* Whether only the condition of the loop between its header and its merge block, from..to - 1,
 * leaves it. */
static bool has_one_exit(const spirv_module *m, uint32_t merge, size_t from, size_t to) {
    uint32_t exits = 0;
    for (size_t k = from; k < to; k++) {
        const spirv_instruction *i = &m->list[k];
        if (i->op == SPIRV_BRANCH) exits += i->word[1] == merge;
        if (i->op == SPIRV_BRANCH_CONDITIONAL)
            exits += i->word[2] == merge || i->word[3] == merge;
    }
    return exits == 1;
}

/* Cost of the instructions from..to - 1, the bodies of unrolled loops once per iteration. rolled:
 * set if a loop remains. Blocks of a loop are between its header and its merge block. */
static masu_spirv_cost cost_between(const spirv_module *m, const bool *inside, size_t from,
                                    size_t to, bool *rolled) {
    masu_spirv_cost sum = {0, 0};
    for (size_t k = from; k < to; k++) {
        size_t loop = inside[k] && m->list[k].op == SPIRV_LABEL ? loop_of(m, k) : 0;
        if (!loop || loop + 1 >= to) {
            if (!inside[k]) continue;
            masu_spirv_cost one = masu_spirv_cost_of(m, &m->list[k]);
            sum.plain += one.plain;
            sum.weighted += one.weighted;
            continue;
        }
        size_t end = k + 1;
        while (end < to && !(m->list[end].op == SPIRV_LABEL &&
                             m->list[end].word[1] == m->list[loop].word[1]))
            end++;
        bool inner = false;
        masu_spirv_cost body = cost_between(m, inside, k + 1, end, &inner);
        int64_t times = inner ? 0 : iterations(m, &m->list[loop + 1]);
        bool unrolled = times > 0 && has_one_exit(m, m->list[loop].word[1], k, end) &&
                        times <= UNROLLED_ITERATIONS &&
                        times * body.plain <= UNROLLED_OPERATIONS;
        if (!unrolled) *rolled = true;
        sum.plain += body.plain * (unrolled ? (uint32_t)times : 1u);
        sum.weighted += body.weighted * (unrolled ? (uint32_t)times : 1u);
        k = end - 1;
    }
    return sum;
}

masu_spirv_cost masu_spirv_cost_reached(const spirv_module *m,
                                        const VkSpecializationInfo *special) {
    bool *inside = calloc(m->count ? m->count : 1, sizeof *inside), rolled = false;
    if (!inside || !masu_spirv_reach(m, special, inside)) {
        free(inside);
        return masu_spirv_cost_straight(m);
    }
    masu_spirv_cost sum = cost_between(m, inside, 0, m->count, &rolled);
    free(inside);
    return sum;
}
