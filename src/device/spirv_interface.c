/* spirv_interface.c: see spirv_interface.h. Constants are from the SPIR-V specification, sections
 * 3.20 and 3.49.8. */
#include "device/spirv_interface.h"

#include <stddef.h>

enum {
    HEADER = 5,
    FIRST_TYPE = 19,
    LAST_TYPE = 39,
    OP_DECORATE = 71,
    SPEC_ID = 1,
    BINDING = 33,
    DESCRIPTOR_SET = 34,
    SET_0_MAX = 128
};

/* Returns the next OpDecorate with a literal operand, from *at on, or NULL. All decorations precede
 * the first type declaration. */
static const uint32_t *next_decoration(const uint32_t *words, uint64_t count, uint64_t *at) {
    while (*at < count) {
        const uint32_t *op = words + *at;
        uint32_t length = op[0] >> 16, code = op[0] & 0xFFFFu;
        if (!length || length > count - *at || (code >= FIRST_TYPE && code <= LAST_TYPE))
            return NULL;
        *at += length;
        if (code == OP_DECORATE && length == 4) return op;
    }
    return NULL;
}

/* The variables of set 0. A module that Masu can bind has at most one per binding, and few
 * aliases. */
typedef struct variables {
    uint32_t count; /* larger than SET_0_MAX: too many to list */
    uint32_t ids[SET_0_MAX];
} variables;

static int is_in_set_0(const variables *v, uint32_t id) {
    for (uint32_t i = 0; i < v->count && i < SET_0_MAX; i++) {
        if (v->ids[i] == id) return 1;
    }
    return v->count > SET_0_MAX;
}

static variables set_0_of(const uint32_t *words, uint64_t count) {
    variables v = {.count = 0};
    const uint32_t *op;
    for (uint64_t at = HEADER; (op = next_decoration(words, count, &at));) {
        if (op[2] != DESCRIPTOR_SET || op[3] != 0 || v.count > SET_0_MAX) continue;
        if (v.count < SET_0_MAX) v.ids[v.count] = op[1];
        v.count++;
    }
    return v;
}

masu_interface masu_interface_of(const uint32_t *words, uint64_t count) {
    masu_interface is = {0, 0};
    variables v = set_0_of(words, count);
    const uint32_t *op;
    for (uint64_t at = HEADER; (op = next_decoration(words, count, &at));) {
        if (op[2] == SPEC_ID && op[3] < 32) is.constants |= 1u << op[3];
        if (op[2] == BINDING && op[3] < 64 && is_in_set_0(&v, op[1]))
            is.bindings |= (uint64_t)1 << op[3];
    }
    return is;
}

void masu_rebind(uint32_t *words, uint64_t count, uint32_t from, uint32_t to) {
    variables v = set_0_of(words, count);
    const uint32_t *op;
    for (uint64_t at = HEADER; (op = next_decoration(words, count, &at));) {
        if (op[2] == BINDING && op[3] == from && is_in_set_0(&v, op[1])) words[op - words + 3] = to;
    }
}
