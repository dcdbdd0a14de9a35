/* spirv_tally.c: see spirv_tally.h. The layout of a module follows the SPIR-V specification,
 * section 2.4: annotations before types, types before functions. */
#include "lab/model/spirv_tally.h"

#include "lab/model/spirv_cost.h"

#include <stdlib.h>
#include <string.h>

enum {
    OP_ENTRY_POINT = 15,
    OP_EXECUTION_MODE = 16,
    OP_TYPE_FIRST = 19,
    OP_TYPE_LAST = 39,
    OP_SELECTION_MERGE = 247,
    OP_KILL = 252,
    OP_RETURN = 253,
    OP_UNREACHABLE = 255,
    OP_TERMINATE_INVOCATION = 4416,
    OP_ATOMIC_I_ADD = 234,
    OP_ATOMIC_U_MAX = 239,
    OP_SHIFT_RIGHT = 194,
    OP_BITWISE_AND = 199,
    STORAGE_PRIVATE = 6,
    STORAGE_BUFFER = 12,
    EARLY_FRAGMENT_TESTS = 9,
    DEPTH_REPLACING = 12,
    VERSION_1_3 = 0x10300,
    VERSION_1_4 = 0x10400
};

typedef struct text {
    uint32_t *words;
    size_t count, room;
    bool failed;
} text;

typedef struct maker {
    const spirv_module *m;
    masu_tally *out;
    uint32_t *type_bytes; /* by id */
    text to;
    uint32_t next, base, set;
    uint32_t uint_type, function; /* type of counts; id of the entry function */
    uint32_t buffer, pointer, low, shift;
    uint32_t variable[MASU_TALLY_NUMBERS];
    uint32_t index[2 + 2 * MASU_TALLY_NUMBERS]; /* constants: indices in the buffer */
    uint32_t zero, one;
    struct {
        uint32_t value, id;
    } * constants;
    size_t constant_count;
} maker;

static void put(text *t, uint32_t word) {
    if (t->count == t->room) {
        size_t room = t->room ? 2 * t->room : 4096;
        uint32_t *more = realloc(t->words, room * sizeof *more);
        if (!more) {
            t->failed = true;
            return;
        }
        t->words = more;
        t->room = room;
    }
    t->words[t->count++] = word;
}

static void put_op(text *t, uint32_t op, uint32_t n, const uint32_t *operands) {
    put(t, (n + 1) << 16 | op);
    for (uint32_t k = 0; k < n; k++) put(t, operands[k]);
}

#define PUT(t, op, ...)                                                                            \
    put_op(t, op, sizeof((uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t), (uint32_t[]){__VA_ARGS__})

/* ---- Cost of a block ------------------------------------------------------------------------- */

/* The variable that a pointer, an image or a sampled image comes from. */
static const spirv_instruction *root_of(const spirv_module *m, uint32_t id) {
    for (uint32_t guard = 0; guard < 64; guard++) {
        const spirv_instruction *d = spirv_def(m, id);
        if (!d || d->op == SPIRV_VARIABLE) return d;
        bool through = d->op == SPIRV_ACCESS_CHAIN || d->op == SPIRV_IN_BOUNDS_ACCESS_CHAIN ||
                       d->op == SPIRV_LOAD || d->op == SPIRV_COPY_OBJECT || d->op == 86 ||
                       d->op == 100 || d->op == SPIRV_IMAGE_TEXEL_POINTER;
        if (!through) return NULL;
        id = d->word[3];
    }
    return NULL;
}

static uint32_t bytes_of(const spirv_module *m, const uint32_t *bytes, uint32_t type) {
    return type < m->bound ? bytes[type] : 0;
}

/* Sizes of types by id, in the order of the module, which defines a type's members first: a type
 * that refers to a later one or to itself has no size, and each type is visited once. */
static uint32_t *size_types(const spirv_module *m) {
    uint32_t *bytes = calloc(m->bound + 1u, sizeof *bytes);
    for (size_t i = 0; bytes && i < m->count; i++) {
        const spirv_instruction *t = &m->list[i], *n;
        uint32_t sum = 0;
        switch (t->op) {
        case SPIRV_TYPE_INT:
        case SPIRV_TYPE_FLOAT: sum = t->word[2] / 8; break;
        case SPIRV_TYPE_VECTOR:
        case SPIRV_TYPE_MATRIX: sum = bytes_of(m, bytes, t->word[2]) * t->word[3]; break;
        case SPIRV_TYPE_ARRAY:
            n = spirv_def(m, t->word[3]);
            if (n && n->op == SPIRV_CONSTANT) sum = bytes_of(m, bytes, t->word[2]) * n->word[3];
            break;
        case SPIRV_TYPE_STRUCT:
            for (uint32_t k = 2; k < t->count; k++) sum += bytes_of(m, bytes, t->word[k]);
            break;
        default: continue;
        }
        bytes[t->word[1]] = sum;
    }
    return bytes;
}

static bool number_of(masu_tally *p, masu_tally_kind kind, uint32_t set, uint32_t binding,
                      uint32_t *out) {
    for (*out = 0; *out < p->count; ++*out) {
        const masu_tally_number *n = &p->numbers[*out];
        if (n->kind == kind && n->set == set && n->binding == binding) return true;
    }
    if (p->count == MASU_TALLY_NUMBERS) return false;
    p->numbers[p->count++] = (masu_tally_number){kind, set, binding};
    return true;
}

typedef uint32_t sums[MASU_TALLY_NUMBERS];

static bool touched(maker *k, uint32_t id, masu_tally_kind kind, uint32_t amount, sums s) {
    uint32_t set, binding, number;
    const spirv_instruction *v = root_of(k->m, id);
    if (!v || !amount) return true;
    if (!spirv_decoration(k->m, v->word[2], SPIRV_DECORATION_DESCRIPTOR_SET, &set) ||
        !spirv_decoration(k->m, v->word[2], 33, &binding))
        return true;
    if (!number_of(k->out, kind, set, binding, &number)) return false;
    s[number] += amount;
    return true;
}

/* Bytes of storage buffers; uniform blocks are ignored: they are small and read by all. */
static bool touched_buffer(maker *k, uint32_t pointer, uint32_t type, masu_tally_kind kind,
                           sums s) {
    const spirv_instruction *v = root_of(k->m, pointer);
    if (!v || v->word[3] != STORAGE_BUFFER) return true;
    return touched(k, pointer, kind, bytes_of(k->m, k->type_bytes, type), s);
}

static bool add_instruction(maker *k, const spirv_instruction *i, sums s) {
    masu_spirv_cost cost = masu_spirv_cost_of(k->m, i);
    s[0] += cost.plain;
    s[1] += cost.weighted;
    switch (i->op) {
    case SPIRV_LOAD: return touched_buffer(k, i->word[3], i->word[1], MASU_TALLY_LOADED, s);
    case SPIRV_STORE:
        return touched_buffer(k, i->word[1], masu_spirv_type_of(k->m, i->word[2]),
                              MASU_TALLY_STORED, s);
    case 87:
    case 88:
    case 89:
    case 90:
    case 91:
    case 92:
    case 93:
    case 94: /* samples */
    case 95:
    case 98: /* fetch, read */ return touched(k, i->word[3], MASU_TALLY_FETCHED, 1, s);
    case 96:
    case 97: return touched(k, i->word[3], MASU_TALLY_FETCHED, 4, s); /* gathers */
    case 99: return touched(k, i->word[1], MASU_TALLY_WRITTEN, 1, s);
    default:
        if (i->op >= 229 && i->op <= 242) /* atomics with a result: their stores */
            return touched_buffer(k, i->word[3], i->word[1], MASU_TALLY_STORED, s);
        return true;
    }
}

/* ---- Parts of the new module ----------------------------------------------------------------- */

static uint32_t constant_of(maker *k, uint32_t value) {
    for (size_t c = 0; c < k->constant_count; c++) {
        if (k->constants[c].value == value) return k->constants[c].id;
    }
    void *more = realloc(k->constants, (k->constant_count + 1) * sizeof *k->constants);
    if (!more) {
        k->to.failed = true;
        return k->zero;
    }
    k->constants = more;
    k->constants[k->constant_count].value = value;
    k->constants[k->constant_count].id = k->next;
    k->constant_count++;
    return k->next++;
}

static void put_annotations(maker *k, uint32_t array, uint32_t block) {
    PUT(&k->to, SPIRV_DECORATE, array, SPIRV_DECORATION_ARRAY_STRIDE, 4);
    PUT(&k->to, SPIRV_DECORATE, block, 2); /* Block */
    PUT(&k->to, SPIRV_MEMBER_DECORATE, block, 0, SPIRV_DECORATION_OFFSET, 0);
    PUT(&k->to, SPIRV_DECORATE, k->buffer, SPIRV_DECORATION_DESCRIPTOR_SET, k->set);
    PUT(&k->to, SPIRV_DECORATE, k->buffer, 33, 0); /* Binding */
}

static void put_types(maker *k, bool own_uint, uint32_t array, uint32_t block) {
    uint32_t to_block = k->next++, to_private = k->next++;
    if (own_uint) PUT(&k->to, SPIRV_TYPE_INT, k->uint_type, 32, 0);
    PUT(&k->to, SPIRV_TYPE_RUNTIME_ARRAY, array, k->uint_type);
    PUT(&k->to, SPIRV_TYPE_STRUCT, block, array);
    PUT(&k->to, SPIRV_TYPE_POINTER, to_block, STORAGE_BUFFER, block);
    PUT(&k->to, SPIRV_TYPE_POINTER, k->pointer, STORAGE_BUFFER, k->uint_type);
    PUT(&k->to, SPIRV_TYPE_POINTER, to_private, STORAGE_PRIVATE, k->uint_type);
    for (size_t c = 0; c < k->constant_count; c++)
        PUT(&k->to, SPIRV_CONSTANT, k->uint_type, k->constants[c].id, k->constants[c].value);
    PUT(&k->to, SPIRV_VARIABLE, to_block, k->buffer, STORAGE_BUFFER);
    for (uint32_t n = 0; n < k->out->count; n++)
        PUT(&k->to, SPIRV_VARIABLE, to_private, k->variable[n], STORAGE_PRIVATE, k->zero);
}

static void put_block_sums(maker *k, const uint32_t *s) {
    for (uint32_t n = 0; n < k->out->count; n++) {
        if (!s[n]) continue;
        uint32_t old = k->next++, sum = k->next++;
        PUT(&k->to, SPIRV_LOAD, k->uint_type, old, k->variable[n]);
        PUT(&k->to, SPIRV_I_ADD, k->uint_type, sum, old, constant_of(k, s[n]));
        PUT(&k->to, SPIRV_STORE, k->variable[n], sum);
    }
}

static void put_atomic(maker *k, uint32_t op, uint32_t place, uint32_t value) {
    uint32_t at = k->next++, old = k->next++;
    PUT(&k->to, SPIRV_ACCESS_CHAIN, k->pointer, at, k->buffer, k->zero, k->index[place]);
    PUT(&k->to, op, k->uint_type, old, at, k->one, k->zero, value); /* device scope, relaxed */
}

static void put_flush(maker *k) {
    put_atomic(k, OP_ATOMIC_I_ADD, 0, k->one);
    for (uint32_t n = 0; n < k->out->count; n++) {
        uint32_t sum = k->next++, low = k->next++, high = k->next++;
        PUT(&k->to, SPIRV_LOAD, k->uint_type, sum, k->variable[n]);
        PUT(&k->to, OP_BITWISE_AND, k->uint_type, low, sum, k->low);
        PUT(&k->to, OP_SHIFT_RIGHT, k->uint_type, high, sum, k->shift);
        if (!n) put_atomic(k, OP_ATOMIC_U_MAX, 1, sum);
        put_atomic(k, OP_ATOMIC_I_ADD, 2 + 2 * n, low);
        put_atomic(k, OP_ATOMIC_I_ADD, 3 + 2 * n, high);
    }
}

/* ---- Traversal ------------------------------------------------------------------------------- */

static bool ends_block(uint32_t op) {
    return (op >= SPIRV_BRANCH && op <= OP_UNREACHABLE) || op == OP_TERMINATE_INVOCATION;
}

/* All numbers must exist before the variables are declared: computes the sums of each block,
 * indexed by its label's position in the list. */
static sums *sum_blocks(maker *k) {
    const spirv_module *m = k->m;
    sums *all = calloc(m->count, sizeof *all);
    size_t block = 0;
    bool inside = false;
    k->out->count = 2;
    k->out->numbers[0] = (masu_tally_number){MASU_TALLY_PLAIN, 0, 0};
    k->out->numbers[1] = (masu_tally_number){MASU_TALLY_WEIGHTED, 0, 0};
    for (size_t i = 0; all && i < m->count; i++) {
        if (m->list[i].op == SPIRV_LABEL) block = i, inside = true;
        if (inside && !add_instruction(k, &m->list[i], all[block])) {
            free(all);
            return NULL;
        }
        if (ends_block(m->list[i].op)) inside = false;
    }
    return all;
}

/* Writes the functions, with the sums of each block at its end, and writes all sums to the buffer
 * at the end of an invocation. */
static void put_functions(maker *k, size_t from, sums *all) {
    const spirv_module *m = k->m;
    size_t block = 0;
    bool entry = false;
    for (size_t i = from; i < m->count; i++) {
        const spirv_instruction *one = &m->list[i];
        if (one->op == SPIRV_FUNCTION) entry = one->word[2] == k->function;
        if (one->op == SPIRV_LABEL) block = i;
        bool merge = one->op == OP_SELECTION_MERGE || one->op == SPIRV_LOOP_MERGE;
        /* A merge instruction immediately precedes its branch. */
        bool merged =
            i && (m->list[i - 1].op == OP_SELECTION_MERGE || m->list[i - 1].op == SPIRV_LOOP_MERGE);
        if (merge || (ends_block(one->op) && !merged)) put_block_sums(k, all[block]);
        if ((one->op == OP_RETURN && entry) || one->op == OP_KILL ||
            one->op == OP_TERMINATE_INVOCATION)
            put_flush(k);
        put_op(&k->to, one->op, one->count - 1, one->word + 1);
    }
}

static void look(maker *k, size_t *first_type, size_t *first_function, bool *early) {
    const spirv_module *m = k->m;
    *first_type = *first_function = m->count;
    for (size_t i = 0; i < m->count; i++) {
        const spirv_instruction *one = &m->list[i];
        if (one->op == OP_ENTRY_POINT && !k->function) {
            k->function = one->word[2];
            k->out->model = one->word[1];
        }
        if (one->op == OP_EXECUTION_MODE &&
            (one->word[2] == EARLY_FRAGMENT_TESTS || one->word[2] == DEPTH_REPLACING))
            *early = true;
        if (one->op == OP_KILL || one->op == OP_TERMINATE_INVOCATION) k->out->late = true;
        if (one->op >= OP_TYPE_FIRST && one->op <= OP_TYPE_LAST && *first_type == m->count)
            *first_type = i;
        if (one->op == SPIRV_FUNCTION && *first_function == m->count) *first_function = i;
        if (one->op == SPIRV_TYPE_INT && one->word[2] == 32 && one->word[3] == 0)
            k->uint_type = one->word[1];
    }
}

/* From SPIR-V 1.4 on an entry point names all variables that it uses. */
static void put_entry(maker *k, const spirv_instruction *one) {
    bool names = k->m->words[1] >= VERSION_1_4;
    uint32_t more = names ? 1 + k->out->count : 0;
    if (one->count + more > 0xFFFFu) k->to.failed = true; /* exceeds the size of an instruction */
    put(&k->to, (one->count + more) << 16 | one->op);
    for (uint32_t w = 1; w < one->count; w++) put(&k->to, one->word[w]);
    for (uint32_t n = 0; n < more; n++) put(&k->to, n ? k->variable[n - 1] : k->buffer);
}

/* A module of SPIR-V 1.0 without storage buffers gets the extension for the buffer of the
 * counts. */
static bool lacks_extension(const spirv_module *m) {
    bool lacks = m->words[1] < VERSION_1_3;
    for (size_t i = 0; i < m->count; i++) lacks &= m->list[i].op != SPIRV_EXTENSION;
    return lacks;
}

static void put_extension(maker *k) {
    static const char name[4 * SPIRV_STORAGE_EXTENSION_WORDS] = SPIRV_STORAGE_EXTENSION;
    uint32_t words[SPIRV_STORAGE_EXTENSION_WORDS];
    memcpy(words, name, sizeof words);
    put_op(&k->to, SPIRV_EXTENSION, SPIRV_STORAGE_EXTENSION_WORDS, words);
}

static bool make(maker *k, sums *all) {
    const spirv_module *m = k->m;
    size_t first_type, first_function;
    bool early = false, extend = lacks_extension(m);
    look(k, &first_type, &first_function, &early);
    if (!k->function || first_function == m->count) return false;
    bool own_uint = !k->uint_type;
    if (own_uint) k->uint_type = k->next++;
    uint32_t array = k->next++, block = k->next++;
    k->buffer = k->next++;
    k->pointer = k->next++;
    k->zero = k->next; /* only for failures */
    k->zero = constant_of(k, 0);
    k->one = constant_of(k, 1);
    k->low = constant_of(k, 1023);
    k->shift = constant_of(k, 10);
    for (uint32_t n = 0; n < k->out->count; n++) k->variable[n] = k->next++;
    for (uint32_t n = 0; n < 2 + 2 * k->out->count; n++) k->index[n] = constant_of(k, k->base + n);
    for (size_t i = 0; i < m->count; i++) { /* all constants, before they are declared */
        for (uint32_t n = 0; n < k->out->count; n++) {
            if (all[i][n]) (void)constant_of(k, all[i][n]);
        }
    }
    for (uint32_t w = 0; w < 5; w++) put(&k->to, m->words[w]);
    for (size_t i = 0; i < first_function; i++) {
        const spirv_instruction *one = &m->list[i];
        if (extend && one->op != SPIRV_CAPABILITY) put_extension(k), extend = false;
        if (i == first_type) put_annotations(k, array, block);
        if (one->op == OP_ENTRY_POINT) {
            put_entry(k, one);
        } else {
            put_op(&k->to, one->op, one->count - 1, one->word + 1);
        }
        /* Writing to a buffer would move the depth test after the shader, and count occluded
         * fragments. */
        bool last_entry = one->op == OP_ENTRY_POINT && m->list[i + 1].op != OP_ENTRY_POINT;
        if (last_entry && k->out->model == 4 && !early && !k->out->late)
            PUT(&k->to, OP_EXECUTION_MODE, k->function, EARLY_FRAGMENT_TESTS);
    }
    put_types(k, own_uint, array, block);
    put_functions(k, first_function, all);
    if (k->to.failed) return false;
    k->to.words[3] = k->next;
    return true;
}

bool masu_tally_make(const uint32_t *words, size_t count, uint32_t set, uint32_t base,
                     masu_tally *out) {
    spirv_module m;
    memset(out, 0, sizeof *out);
    if (!spirv_from_words(words, count, &m)) return false;
    maker k = {.m = &m, .out = out, .next = m.bound, .base = base, .set = set};
    k.type_bytes = size_types(&m);
    sums *all = k.type_bytes ? sum_blocks(&k) : NULL;
    bool good = all && make(&k, all);
    out->words = k.to.words;
    out->word_count = k.to.count;
    if (!good) {
        free(out->words);
        out->words = NULL;
    }
    free(all);
    free(k.constants);
    free(k.type_bytes);
    spirv_free(&m);
    return good;
}

uint64_t masu_tally_sum(const uint32_t *from, uint32_t number) {
    return from[2 + 2 * number] + ((uint64_t)from[3 + 2 * number] << 10);
}
