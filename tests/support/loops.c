/* loops.c: see loops.h. */
#include "support/loops.h"

#include <stdlib.h>
#include <string.h>

#define DEPTH_MOST 32

typedef struct block {
    uint32_t label;
    size_t first, last; /* instructions; last is the terminator */
    uint32_t *next;     /* blocks that can follow */
    uint32_t next_count;
    int merge; /* has an OpLoopMerge */
} block;

typedef struct graph {
    const spirv_module *m;
    block *blocks; /* [0] is the entry of the function */
    uint32_t count;
    /* The loop under test: */
    uint32_t header;
    unsigned char *in_loop, *latch; /* latch: the block is in the loop and branches to the header */
    unsigned char *seen;            /* scratch of the traversal */
} graph;

/* ---- Blocks ---------------------------------------------------------------------------------- */

static uint32_t block_of(const graph *g, uint32_t label) {
    for (uint32_t b = 0; b < g->count; b++) {
        if (g->blocks[b].label == label) return b;
    }
    return UINT32_MAX;
}

/* The block that contains an instruction, or UINT32_MAX outside the function. */
static uint32_t home_of(const graph *g, const spirv_instruction *i) {
    size_t at = (size_t)(i - g->m->list);
    for (uint32_t b = 0; b < g->count; b++) {
        if (at >= g->blocks[b].first && at <= g->blocks[b].last) return b;
    }
    return UINT32_MAX;
}

static const spirv_instruction *def_of(const graph *g, uint32_t id) {
    return id < g->m->bound ? g->m->def[id] : NULL;
}

static void add_next(graph *g, block *b, uint32_t label) {
    uint32_t to = block_of(g, label);
    for (uint32_t i = 0; i < b->next_count; i++) {
        if (b->next[i] == to) return;
    }
    if (to != UINT32_MAX) b->next[b->next_count++] = to;
}

/* A branch whose condition is a constant has only one successor. */
static void link_block(graph *g, block *b) {
    const spirv_instruction *end = &g->m->list[b->last];
    b->next = calloc(end->count + 1, sizeof *b->next);
    if (!b->next) abort();
    if (end->op == SPIRV_BRANCH) add_next(g, b, end->word[1]);
    if (end->op == SPIRV_BRANCH_CONDITIONAL) {
        const spirv_instruction *condition = def_of(g, end->word[1]);
        uint32_t op = condition ? condition->op : 0;
        if (op != SPIRV_CONSTANT_FALSE) add_next(g, b, end->word[2]);
        if (op != SPIRV_CONSTANT_TRUE) add_next(g, b, end->word[3]);
    }
    if (end->op == SPIRV_SWITCH) {
        add_next(g, b, end->word[2]);
        for (uint32_t w = 4; w < end->count; w += 2) add_next(g, b, end->word[w]);
    }
}

/* Reads the blocks of the function that starts at instruction `at`; returns the index after it. */
static size_t read_function(graph *g, size_t at) {
    const spirv_module *m = g->m;
    size_t end = at;
    while (end < m->count && m->list[end].op != SPIRV_FUNCTION_END) end++;
    g->count = 0;
    g->blocks = calloc(end - at + 1, sizeof *g->blocks);
    g->in_loop = calloc(3 * (end - at + 1), 1);
    if (!g->blocks || !g->in_loop) abort();
    g->latch = g->in_loop + (end - at + 1);
    g->seen = g->latch + (end - at + 1);
    for (size_t k = at; k < end; k++) {
        if (m->list[k].op == SPIRV_LABEL) {
            g->blocks[g->count++] = (block){.label = m->list[k].word[1], .first = k};
        }
        if (!g->count) continue;
        g->blocks[g->count - 1].last = k;
        if (m->list[k].op == SPIRV_LOOP_MERGE) g->blocks[g->count - 1].merge = 1;
    }
    for (uint32_t b = 0; b < g->count; b++) link_block(g, &g->blocks[b]);
    return end + 1;
}

static void forget_function(graph *g) {
    for (uint32_t b = 0; b < g->count; b++) free(g->blocks[b].next);
    free(g->blocks);
    free(g->in_loop);
}

/* ---- Loops ----------------------------------------------------------------------------------- */

#define NOWHERE UINT32_MAX

/* Marks in g->seen the blocks that are reachable from `from` without entering `closed`. With
 * `inside`, walks only blocks of the loop and does not pass its header again. */
static void walk(graph *g, uint32_t from, uint32_t closed, int inside) {
    memset(g->seen, 0, g->count);
    uint32_t *stack = calloc(g->count, sizeof *stack), top = 0;
    if (!stack) abort();
    if (from != closed) g->seen[from] = 1, stack[top++] = from;
    while (top) {
        const block *b = &g->blocks[stack[--top]];
        for (uint32_t i = 0; i < b->next_count; i++) {
            uint32_t to = b->next[i];
            if (g->seen[to] || to == closed || (inside && (!g->in_loop[to] || to == from)))
                continue;
            g->seen[to] = 1;
            stack[top++] = to;
        }
    }
    free(stack);
}

/* Fills latch and in_loop for the header. Returns 0 if no branch leads back to it. */
static int find_loop(graph *g, uint32_t header) {
    g->header = header;
    memset(g->latch, 0, g->count);
    memset(g->in_loop, 0, g->count);
    walk(g, 0, NOWHERE, 0);
    int any = 0;
    for (uint32_t b = 0; b < g->count; b++) g->in_loop[b] = g->seen[b]; /* reachable at all */
    walk(g, 0, header, 0);
    for (uint32_t b = 0; b < g->count; b++) {
        int dominated = g->in_loop[b] && !g->seen[b];
        for (uint32_t i = 0; i < g->blocks[b].next_count; i++) {
            if (g->blocks[b].next[i] == header && dominated) g->latch[b] = 1, any = 1;
        }
    }
    memcpy(g->in_loop, g->latch, g->count);
    g->in_loop[header] = 1;
    for (int changed = any; changed;) { /* plus all blocks that lead to a latch without the
                                           header */
        changed = 0;
        for (uint32_t b = 0; b < g->count; b++) {
            if (g->in_loop[b]) continue;
            for (uint32_t i = 0; i < g->blocks[b].next_count; i++) {
                uint32_t to = g->blocks[b].next[i];
                if (to != header && g->in_loop[to] && !g->in_loop[b]) {
                    g->in_loop[b] = 1;
                    changed = 1;
                }
            }
        }
    }
    return any;
}

/* Every iteration of the loop passes the block. */
static int in_every_round(graph *g, uint32_t b) {
    if (b == g->header) return 1;
    walk(g, g->header, b, 1);
    for (uint32_t k = 0; k < g->count; k++) {
        if (g->latch[k] && k != b && g->seen[k]) return 0;
    }
    return 1;
}

/* ---- Counters -------------------------------------------------------------------------------- */

static int constant_of(const graph *g, uint32_t id, int is_signed, int64_t *value) {
    const spirv_instruction *i = def_of(g, id);
    while (i && (i->op == SPIRV_BITCAST || i->op == SPIRV_COPY_OBJECT)) i = def_of(g, i->word[3]);
    if (!i || i->op != SPIRV_CONSTANT || i->count != 4) return 0;
    const spirv_instruction *type = def_of(g, i->word[1]);
    if (!type || type->op != SPIRV_TYPE_INT) return 0;
    *value = is_signed ? (int64_t)(int32_t)i->word[3] : (int64_t)i->word[3];
    return 1;
}

/* x + constant or x - constant. */
static int is_step(const graph *g, const spirv_instruction *i, uint32_t *x, int64_t *step) {
    if (!i || (i->op != SPIRV_I_ADD && i->op != SPIRV_I_SUB)) return 0;
    if (constant_of(g, i->word[4], 1, step)) {
        *x = i->word[3];
        if (i->op == SPIRV_I_SUB) *step = -*step;
        return 1;
    }
    *x = i->word[4];
    return i->op == SPIRV_I_ADD && constant_of(g, i->word[3], 1, step);
}

/* Worst-case start of a counter, and its steps. */
typedef struct counter {
    int64_t low, high;     /* starts */
    int64_t step, longest; /* smallest and largest absolute value; 0: none found */
    int has_start;
} counter;

static int add_start(const graph *g, uint32_t id, int is_signed, counter *c) {
    int64_t value;
    if (!constant_of(g, id, is_signed, &value)) return 0;
    if (!c->has_start || value < c->low) c->low = value;
    if (!c->has_start || value > c->high) c->high = value;
    c->has_start = 1;
    return 1;
}

static int add_step(counter *c, int64_t step) {
    if (step == 0 || (c->step && (c->step > 0) != (step > 0))) return 0;
    if (!c->step || llabs(step) < llabs(c->step)) c->step = step;
    if (llabs(step) > llabs(c->longest)) c->longest = step;
    return 1;
}

/* A pointer has uses other than loads and stores. */
static int is_passed_on(const spirv_instruction *i, uint32_t pointer) {
    uint32_t from;
    switch (i->op) {
    case SPIRV_FUNCTION_CALL:
    case SPIRV_IMAGE_TEXEL_POINTER:
    case SPIRV_ACCESS_CHAIN:
    case SPIRV_IN_BOUNDS_ACCESS_CHAIN:
    case SPIRV_COPY_OBJECT:
    case SPIRV_SELECT:
    case SPIRV_PHI: from = 3; break;
    case SPIRV_COPY_MEMORY: from = 1; break;
    case SPIRV_EXT_INST: from = 5; break; /* modf and the like */
    default:
        if (i->op < 227 || i->op > 242) return 0; /* atomics */
        from = 1;
    }
    for (uint32_t w = from; w < i->count; w++) {
        if (i->word[w] == pointer) return 1;
    }
    return 0;
}

static int load_of_this_round(const graph *g, uint32_t id, uint32_t pointer) {
    const spirv_instruction *i = def_of(g, id);
    if (!i || i->op != SPIRV_LOAD || i->word[3] != pointer) return 0;
    uint32_t home = home_of(g, i);
    return home != NOWHERE && g->in_loop[home];
}

/* A variable that each iteration changes by a constant, as glslang writes it. */
static int read_variable(graph *g, uint32_t pointer, int is_signed, counter *c) {
    const spirv_instruction *variable = def_of(g, pointer);
    int moved = 0;
    if (!variable || variable->op != SPIRV_VARIABLE || variable->word[3] != 7) return 0;
    for (uint32_t b = 0; b < g->count; b++) {
        for (size_t k = g->blocks[b].first; k <= g->blocks[b].last; k++) {
            const spirv_instruction *i = &g->m->list[k];
            if (is_passed_on(i, pointer)) return 0;
            if (i->op != SPIRV_STORE || i->word[1] != pointer) continue;
            if (!g->in_loop[b]) {
                if (!add_start(g, i->word[2], is_signed, c)) return 0;
                continue;
            }
            uint32_t from;
            int64_t step;
            if (!is_step(g, def_of(g, i->word[2]), &from, &step)) return 0;
            if (!load_of_this_round(g, from, pointer) || !add_step(c, step)) return 0;
            moved |= in_every_round(g, b);
        }
    }
    return moved && c->has_start;
}

/* The value is the phi plus constants, on each path through the iteration. `met` are the phis on
 * the path; one that leads back to itself adds nothing. */
static int moves(graph *g, uint32_t id, uint32_t phi, const uint32_t *met, int depth, counter *c) {
    const spirv_instruction *i = def_of(g, id);
    uint32_t from, path[DEPTH_MOST];
    int64_t step;
    if (!i || depth + 1 >= DEPTH_MOST) return 0;
    for (int k = 0; k < depth; k++) {
        if (met[k] == id) return 1;
        path[k] = met[k];
    }
    path[depth] = id;
    if (is_step(g, i, &from, &step)) {
        return add_step(c, step) && (from == phi || moves(g, from, phi, path, depth + 1, c));
    }
    if (i->op != SPIRV_PHI || id == phi) return 0;
    for (uint32_t w = 3; w + 1 < i->count; w += 2) {
        if (!moves(g, i->word[w], phi, path, depth + 1, c)) return 0;
    }
    return 1;
}

static int read_phi(graph *g, const spirv_instruction *phi, int is_signed, counter *c) {
    if (home_of(g, phi) != g->header) return 0;
    for (uint32_t w = 3; w + 1 < phi->count; w += 2) {
        uint32_t from = block_of(g, phi->word[w + 1]);
        if (from == NOWHERE) return 0;
        if (g->in_loop[from]) {
            if (!moves(g, phi->word[w], phi->word[2], NULL, 0, c)) return 0;
        } else if (!add_start(g, phi->word[w], is_signed, c)) {
            return 0;
        }
    }
    return c->has_start && c->step != 0;
}

/* The value is a counter, plus `shift`. */
static int read_counter(graph *g, uint32_t id, int is_signed, counter *c, int64_t *shift) {
    const spirv_instruction *i = def_of(g, id);
    uint32_t from;
    int64_t step;
    *shift = 0;
    for (int depth = 0; i && depth < DEPTH_MOST; depth++) {
        if (i->op == SPIRV_BITCAST || i->op == SPIRV_COPY_OBJECT) {
            i = def_of(g, i->word[3]);
        } else if (is_step(g, i, &from, &step)) {
            *shift += step;
            i = def_of(g, from);
        } else {
            break;
        }
    }
    if (!i) return 0;
    if (i->op == SPIRV_LOAD) {
        return load_of_this_round(g, i->word[2], i->word[3]) &&
               read_variable(g, i->word[3], is_signed, c);
    }
    return i->op == SPIRV_PHI && read_phi(g, i, is_signed, c);
}

/* ---- Conditions ------------------------------------------------------------------------------ */

typedef struct comparison {
    int less; /* the left side is below the right one */
    int equal;
    int is_signed;
} comparison;

static int comparison_of(uint32_t op, comparison *c) {
    switch (op) {
    case SPIRV_U_GREATER_THAN: *c = (comparison){0, 0, 0}; return 1;
    case SPIRV_S_GREATER_THAN: *c = (comparison){0, 0, 1}; return 1;
    case SPIRV_U_GREATER_THAN_EQUAL: *c = (comparison){0, 1, 0}; return 1;
    case SPIRV_S_GREATER_THAN_EQUAL: *c = (comparison){0, 1, 1}; return 1;
    case SPIRV_U_LESS_THAN: *c = (comparison){1, 0, 0}; return 1;
    case SPIRV_S_LESS_THAN: *c = (comparison){1, 0, 1}; return 1;
    case SPIRV_U_LESS_THAN_EQUAL: *c = (comparison){1, 1, 0}; return 1;
    case SPIRV_S_LESS_THAN_EQUAL: *c = (comparison){1, 1, 1}; return 1;
    default: return 0;
    }
}

/* Remaining in the loop means that a counter has not passed a constant, within a bounded number of
 * iterations. */
static int counted_comparison(graph *g, const spirv_instruction *i, int value) {
    comparison is;
    int64_t limit, shift, rounds;
    counter c;
    memset(&c, 0, sizeof c);
    if (!comparison_of(i->op, &is)) return 0;
    uint32_t counted = i->word[3];
    if (!constant_of(g, i->word[4], is.is_signed, &limit)) {
        if (!constant_of(g, i->word[3], is.is_signed, &limit)) return 0;
        counted = i->word[4];
        is.less = !is.less; /* 8 > i is i < 8 */
    }
    if (!value) is.less = !is.less, is.equal = !is.equal; /* not i < 8 is i >= 8 */
    if (!read_counter(g, counted, is.is_signed, &c, &shift)) return 0;
    limit -= shift;
    if ((c.step > 0) != is.less) return 0;
    /* A step from the last value inside the loop must not overflow the type. */
    int64_t lowest = is.is_signed ? INT32_MIN : 0;
    int64_t highest = is.is_signed ? INT32_MAX : UINT32_MAX;
    int64_t last = limit + (is.equal ? 0 : is.less ? -1 : 1);
    if (last + c.longest < lowest || last + c.longest > highest) return 0;
    rounds = (is.less ? last - c.low : c.high - last) / llabs(c.step) + 1;
    return rounds <= (int64_t)SUPPORT_ROUNDS_MOST;
}

static int counted(graph *g, uint32_t id, int value, int depth);

/* On the path into the block, a branch was taken that requires a counted comparison, or that
 * contradicts `id` being `value`. */
static int counted_on_the_way(graph *g, uint32_t from, uint32_t to, uint32_t id, int value,
                              int depth) {
    for (int steps = 0; steps < DEPTH_MOST && g->in_loop[from]; steps++) {
        const spirv_instruction *end = &g->m->list[g->blocks[from].last];
        if (end->op == SPIRV_BRANCH_CONDITIONAL && end->word[2] != end->word[3]) {
            int taken = end->word[2] == g->blocks[to].label;
            if (end->word[1] == id && taken != value) return 1;
            if (counted(g, end->word[1], taken, depth + 1)) return 1;
        }
        uint32_t before = NOWHERE, ways = 0;
        for (uint32_t b = 0; b < g->count; b++) {
            for (uint32_t i = 0; i < g->blocks[b].next_count; i++) {
                if (g->blocks[b].next[i] == from) before = b, ways++;
            }
        }
        if (ways != 1 || from == g->header) return 0;
        to = from;
        from = before;
    }
    return 0;
}

static int counted_phi(graph *g, const spirv_instruction *phi, int value, int depth) {
    uint32_t to = home_of(g, phi);
    if (to == NOWHERE || !g->in_loop[to] || to == g->header) return 0;
    for (uint32_t w = 3; w + 1 < phi->count; w += 2) {
        uint32_t from = block_of(g, phi->word[w + 1]);
        if (from == NOWHERE || !g->in_loop[from]) return 0;
        if (!counted(g, phi->word[w], value, depth + 1) &&
            !counted_on_the_way(g, from, to, phi->word[w], value, depth)) {
            return 0;
        }
    }
    return 1;
}

/* That `id` is `value` implies a counted comparison. */
static int counted(graph *g, uint32_t id, int value, int depth) {
    const spirv_instruction *i = def_of(g, id);
    if (!i || depth > DEPTH_MOST) return 0;
    switch (i->op) {
    case SPIRV_CONSTANT_TRUE: return !value; /* impossible: implies anything */
    case SPIRV_CONSTANT_FALSE: return value;
    case SPIRV_LOGICAL_NOT: return counted(g, i->word[3], !value, depth + 1);
    case SPIRV_LOGICAL_AND:
    case SPIRV_LOGICAL_OR: {
        int a = counted(g, i->word[3], value, depth + 1);
        int b = counted(g, i->word[4], value, depth + 1);
        int both_hold = (i->op == SPIRV_LOGICAL_AND) == (value != 0);
        return both_hold ? a || b : a && b;
    }
    case SPIRV_SELECT:
        return (counted(g, i->word[3], 1, depth + 1) || counted(g, i->word[4], value, depth + 1)) &&
               (counted(g, i->word[3], 0, depth + 1) || counted(g, i->word[5], value, depth + 1));
    case SPIRV_PHI: return counted_phi(g, i, value, depth);
    default: return counted_comparison(g, i, value);
    }
}

static int is_bounded(graph *g, uint32_t header) {
    if (!find_loop(g, header)) return 1; /* never iterates */
    for (uint32_t b = 0; b < g->count; b++) {
        const spirv_instruction *end = &g->m->list[g->blocks[b].last];
        if (!g->in_loop[b] || end->op != SPIRV_BRANCH_CONDITIONAL) continue;
        uint32_t yes = block_of(g, end->word[2]), no = block_of(g, end->word[3]);
        if (yes == NOWHERE || no == NOWHERE || g->in_loop[yes] == g->in_loop[no]) continue;
        if (in_every_round(g, b) && counted(g, end->word[1], g->in_loop[yes], 0)) return 1;
    }
    return 0;
}

const char *spirv_unbounded_loop(const spirv_module *module, uint32_t *loops) {
    for (size_t at = 0; at < module->count;) {
        if (module->list[at].op != SPIRV_FUNCTION) {
            at++;
            continue;
        }
        graph g = {.m = module};
        const char *name = spirv_name(module, module->list[at].word[2]), *fault = NULL;
        at = read_function(&g, at);
        for (uint32_t b = 0; b < g.count; b++) {
            if (!g.blocks[b].merge) continue;
            ++*loops;
            if (!fault && !is_bounded(&g, b)) fault = *name ? name : "(a function without a name)";
        }
        forget_function(&g);
        if (fault) return fault;
    }
    return NULL;
}
