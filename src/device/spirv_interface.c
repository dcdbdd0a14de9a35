/* spirv_interface.c: see spirv_interface.h. Numbers are those of the SPIR-V specification,
 * sections 3.20 and 3.49.8. */
#include "device/spirv_interface.h"

#include <stddef.h>

enum {
    HEADER = 5,
    FIRST_TYPE = 19,
    LAST_TYPE = 39,
    OP_DECORATE = 71,
    SPEC_ID = 1,
    BINDING = 33,
    DESCRIPTOR_SET = 34
};

/* The next OpDecorate with a number behind it, from *at on; NULL: there is none. All stand
 * before the first type. */
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

static int is_in_set_0(const uint32_t *words, uint64_t count, uint32_t id) {
    const uint32_t *op;
    for (uint64_t at = HEADER; (op = next_decoration(words, count, &at));) {
        if (op[1] == id && op[2] == DESCRIPTOR_SET) return op[3] == 0;
    }
    return 0;
}

masu_interface masu_interface_of(const uint32_t *words, uint64_t count) {
    masu_interface is = {0, 0};
    const uint32_t *op;
    for (uint64_t at = HEADER; (op = next_decoration(words, count, &at));) {
        if (op[2] == SPEC_ID && op[3] < 32) is.constants |= 1u << op[3];
        if (op[2] == BINDING && op[3] < 64 && is_in_set_0(words, count, op[1]))
            is.bindings |= (uint64_t)1 << op[3];
    }
    return is;
}
