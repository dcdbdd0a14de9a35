/* code.c: see code.h. */
#include "scene/code.h"

#include <string.h>

#define MAGIC 0x07230203u
#define HEADER 5u

/* Numbers from the SPIR-V specification. */
enum {
    OP_SOURCE_EXTENSION = 4,
    OP_EXTENSION = 10,
    OP_EXT_INST_IMPORT = 11,
    OP_MEMORY_MODEL = 14,
    OP_ENTRY_POINT = 15,
    OP_EXECUTION_MODE = 16,
    OP_CAPABILITY = 17,
    OP_TYPE_INT = 21,
    OP_TYPE_FLOAT = 22,
    OP_TYPE_VECTOR = 23,
    OP_TYPE_IMAGE = 25,
    OP_TYPE_SAMPLED_IMAGE = 27,
    OP_TYPE_STRUCT = 30,
    OP_TYPE_POINTER = 32,
    OP_CONSTANT = 43,
    OP_CONSTANT_COMPOSITE = 44,
    OP_FUNCTION = 54,
    OP_FUNCTION_PARAMETER = 55,
    OP_FUNCTION_END = 56,
    OP_VARIABLE = 59,
    OP_DECORATE = 71,
    OP_MEMBER_DECORATE = 72,
    OP_LOOP_MERGE = 246,
    OP_SELECTION_MERGE = 247,
    OP_LABEL = 248,
    OP_BRANCH = 249,
    OP_BRANCH_CONDITIONAL = 250,
    OP_SWITCH = 251,
    OP_UNREACHABLE = 255
};

enum {
    DECORATION_SPEC_ID = 1,
    DECORATION_BUILT_IN = 11,
    DECORATION_BINDING = 33,
    DECORATION_SET = 34,
    DECORATION_OFFSET = 35
};
enum { BUILT_IN_WORKGROUP_SIZE = 25 };
enum { CLASS_CONSTANT = 0, CLASS_UNIFORM = 2, CLASS_PUSH = 9, CLASS_STORAGE = 12 };
enum { MODE_LOCAL_SIZE = 17 };

/* Sections of a module, in their order. The rank must not decrease from instruction to
 * instruction. */
enum {
    RANK_CAPABILITY,
    RANK_EXTENSION,
    RANK_IMPORT,
    RANK_MODEL,
    RANK_ENTRY,
    RANK_MODE,
    RANK_DEBUG,
    RANK_DECORATION,
    RANK_GLOBAL,
    RANK_FUNCTION
};

/* ---- Instructions ---------------------------------------------------------------------------- */

/* Operands, one letter each:
 *   r  the result               t  the type of the result     y  a type
 *   i  a value, defined before  f  an id, possibly a forward reference
 *   l  a label, possibly a forward reference
 *   n  a number                 N  any number of numbers      S  a string
 * [...] repeats any number of times; operands after ? are optional. A result is a type for opcodes
 * TYPE_FIRST to TYPE_LAST, a label for OP_LABEL, otherwise a value. */
typedef struct form {
    uint16_t first, last;
    uint8_t rank;
    const char *operands;
} form;

#define TYPE_FIRST 19u
#define TYPE_LAST 33u

static const form forms[] = {
    {1, 1, RANK_GLOBAL, "tr"}, /* in functions too, as a variable */
    {OP_SOURCE_EXTENSION, OP_SOURCE_EXTENSION, RANK_DEBUG, "S"},
    {OP_EXTENSION, OP_EXTENSION, RANK_EXTENSION, "S"},
    {OP_EXT_INST_IMPORT, OP_EXT_INST_IMPORT, RANK_IMPORT, "rS"},
    {12, 12, RANK_FUNCTION, "trin[i]"},
    {OP_MEMORY_MODEL, OP_MEMORY_MODEL, RANK_MODEL, "nn"},
    {OP_ENTRY_POINT, OP_ENTRY_POINT, RANK_ENTRY, "nfS[f]"},
    {OP_EXECUTION_MODE, OP_EXECUTION_MODE, RANK_MODE, "fnN"},
    {OP_CAPABILITY, OP_CAPABILITY, RANK_CAPABILITY, "n"},
    {19, 20, RANK_GLOBAL, "r"},
    {OP_TYPE_INT, OP_TYPE_INT, RANK_GLOBAL, "rnn"},
    {OP_TYPE_FLOAT, OP_TYPE_FLOAT, RANK_GLOBAL, "rn"},
    {23, 24, RANK_GLOBAL, "ryn"},
    {OP_TYPE_IMAGE, OP_TYPE_IMAGE, RANK_GLOBAL, "rynnnnnn"},
    {26, 26, RANK_GLOBAL, "r"},
    {OP_TYPE_SAMPLED_IMAGE, OP_TYPE_SAMPLED_IMAGE, RANK_GLOBAL, "ry"},
    {28, 28, RANK_GLOBAL, "ryi"},
    {29, 29, RANK_GLOBAL, "ry"},
    {OP_TYPE_STRUCT, OP_TYPE_STRUCT, RANK_GLOBAL, "r[y]"},
    {OP_TYPE_POINTER, OP_TYPE_POINTER, RANK_GLOBAL, "rny"},
    {33, 33, RANK_GLOBAL, "ry[y]"},
    {41, 42, RANK_GLOBAL, "tr"},
    /* 32 bits: larger constants need capabilities that are rejected */
    {OP_CONSTANT, OP_CONSTANT, RANK_GLOBAL, "trn"},
    {OP_CONSTANT_COMPOSITE, OP_CONSTANT_COMPOSITE, RANK_GLOBAL, "tr[i]"},
    {46, 46, RANK_GLOBAL, "tr"},
    {48, 49, RANK_GLOBAL, "tr"},
    {50, 50, RANK_GLOBAL, "trn"},
    {51, 51, RANK_GLOBAL, "tr[i]"},
    {52, 52, RANK_GLOBAL, "trniN"},
    {OP_FUNCTION, OP_FUNCTION, RANK_FUNCTION, "trny"},
    {OP_FUNCTION_PARAMETER, OP_FUNCTION_PARAMETER, RANK_FUNCTION, "tr"},
    {OP_FUNCTION_END, OP_FUNCTION_END, RANK_FUNCTION, ""},
    {57, 57, RANK_FUNCTION, "trf[i]"},
    {OP_VARIABLE, OP_VARIABLE, RANK_GLOBAL, "trn?i"},
    {60, 60, RANK_FUNCTION, "triii"},
    {61, 61, RANK_FUNCTION, "tri?n"},
    {62, 63, RANK_FUNCTION, "ii?n"},
    {65, 66, RANK_FUNCTION, "tri[i]"},
    {68, 68, RANK_FUNCTION, "trin"},
    {OP_DECORATE, OP_DECORATE, RANK_DECORATION, "fnN"},
    {OP_MEMBER_DECORATE, OP_MEMBER_DECORATE, RANK_DECORATION, "fnnN"},
    {77, 77, RANK_FUNCTION, "trii"},
    {78, 78, RANK_FUNCTION, "triii"},
    {79, 79, RANK_FUNCTION, "triiN"},
    {80, 80, RANK_FUNCTION, "tr[i]"},
    {81, 81, RANK_FUNCTION, "trinN"},
    {82, 82, RANK_FUNCTION, "triinN"},
    {83, 84, RANK_FUNCTION, "tri"},
    {86, 86, RANK_FUNCTION, "trii"},
    {87, 87, RANK_FUNCTION, "trii?n[i]"},
    {88, 88, RANK_FUNCTION, "triini[i]"},
    {89, 89, RANK_FUNCTION, "triii?n[i]"},
    {90, 90, RANK_FUNCTION, "triiini[i]"},
    {91, 91, RANK_FUNCTION, "trii?n[i]"},
    {92, 92, RANK_FUNCTION, "triini[i]"},
    {93, 93, RANK_FUNCTION, "triii?n[i]"},
    {94, 94, RANK_FUNCTION, "triiini[i]"},
    {95, 95, RANK_FUNCTION, "trii?n[i]"},
    {96, 97, RANK_FUNCTION, "triii?n[i]"},
    {98, 98, RANK_FUNCTION, "trii?n[i]"},
    {99, 99, RANK_FUNCTION, "iii?n[i]"},
    {100, 100, RANK_FUNCTION, "tri"},
    {103, 103, RANK_FUNCTION, "trii"},
    {104, 104, RANK_FUNCTION, "tri"},
    {105, 105, RANK_FUNCTION, "trii"},
    {106, 107, RANK_FUNCTION, "tri"},
    {109, 112, RANK_FUNCTION, "tri"},
    {124, 124, RANK_FUNCTION, "tri"},
    {126, 127, RANK_FUNCTION, "tri"},
    {128, 152, RANK_FUNCTION, "trii"},
    {154, 157, RANK_FUNCTION, "tri"},
    {164, 167, RANK_FUNCTION, "trii"},
    {168, 168, RANK_FUNCTION, "tri"},
    {169, 169, RANK_FUNCTION, "triii"},
    {170, 191, RANK_FUNCTION, "trii"},
    {194, 199, RANK_FUNCTION, "trii"},
    {200, 200, RANK_FUNCTION, "tri"},
    {201, 201, RANK_FUNCTION, "triiii"},
    {202, 203, RANK_FUNCTION, "triii"},
    {204, 205, RANK_FUNCTION, "tri"},
    {207, 215, RANK_FUNCTION, "tri"},
    {224, 224, RANK_FUNCTION, "iii"},
    {225, 225, RANK_FUNCTION, "ii"},
    {227, 227, RANK_FUNCTION, "triii"},
    {228, 228, RANK_FUNCTION, "iiii"},
    {229, 229, RANK_FUNCTION, "triiii"},
    {230, 230, RANK_FUNCTION, "triiiiii"},
    {232, 233, RANK_FUNCTION, "triii"},
    {234, 242, RANK_FUNCTION, "triiii"},
    {245, 245, RANK_FUNCTION, "tr[fl]"},
    {OP_LOOP_MERGE, OP_LOOP_MERGE, RANK_FUNCTION, "lln"},
    {OP_SELECTION_MERGE, OP_SELECTION_MERGE, RANK_FUNCTION, "ln"},
    {OP_LABEL, OP_LABEL, RANK_FUNCTION, "r"},
    {OP_BRANCH, OP_BRANCH, RANK_FUNCTION, "l"},
    {OP_BRANCH_CONDITIONAL, OP_BRANCH_CONDITIONAL, RANK_FUNCTION, "ill?nn"},
    {OP_SWITCH, OP_SWITCH, RANK_FUNCTION, "il[nl]"},
    {252, 253, RANK_FUNCTION, ""},
    {254, 254, RANK_FUNCTION, "i"},
    {OP_UNREACHABLE, OP_UNREACHABLE, RANK_FUNCTION, ""},
};

static const form *form_of(uint32_t op) {
    uint32_t low = 0, high = sizeof forms / sizeof *forms;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (forms[middle].last < op)
            low = middle + 1;
        else
            high = middle;
    }
    return low < sizeof forms / sizeof *forms && forms[low].first <= op ? &forms[low] : NULL;
}

/* ---- Ids: the kind of each, in two bits ------------------------------------------------------ */

enum { ID_NONE = 0, ID_TYPE = 1, ID_VALUE = 2, ID_LABEL = 3 };

typedef struct walk {
    const uint32_t *words;
    uint64_t count, globals_end; /* globals_end: the first function */
    uint32_t bound;
    masu_module *out;
    uint32_t rank, entries, functions, local_sizes, push_type, workgroup_size, entry;
    int in_function, in_block, merging, blocks, entry_found, has_storage_class;
    uint8_t ids[MASU_MODULE_IDS_MAX / 4];
} walk;

static uint32_t id_kind(const walk *w, uint32_t id) {
    return id < w->bound ? w->ids[id / 4] >> id % 4 * 2 & 3u : ID_NONE;
}

/* ---- Operands -------------------------------------------------------------------------------- */

/* Length of a string literal in 32-bit values; 0 if it does not end within `left` values. */
static uint32_t string_length(const uint32_t *at, uint32_t left) {
    const void *end = left ? memchr(at, 0, 4 * (size_t)left) : NULL;
    return end ? (uint32_t)(((const char *)end - (const char *)at) / 4 + 1) : 0;
}

/* late: checks ids that may be forward references; otherwise all other operands. */
static const char *check_operand(walk *w, uint32_t op, char letter, uint32_t value, int late) {
    int follows = letter == 'f' || letter == 'l';
    if (letter == 'n' || follows != late) return NULL;
    if (letter == 'r') {
        if (value == 0 || value >= w->bound) return "an id is 0 or not below the bound";
        if (id_kind(w, value) != ID_NONE) return "an id is defined twice";
        uint32_t kind = op == OP_LABEL                        ? ID_LABEL
                        : op >= TYPE_FIRST && op <= TYPE_LAST ? ID_TYPE
                                                              : ID_VALUE;
        w->ids[value / 4] |= (uint8_t)(kind << value % 4 * 2);
        return NULL;
    }
    uint32_t kind = id_kind(w, value);
    if (kind == ID_NONE) return "an id is used that nothing has defined";
    if (letter == 'l') return kind == ID_LABEL ? NULL : "an id is used as a label, which it is not";
    if (letter == 't' || letter == 'y')
        return kind == ID_TYPE ? NULL : "an id is used as a type, which it is not";
    /* OpDecorate may name a type too. */
    if (letter == 'f' && (op == OP_DECORATE || op == OP_MEMBER_DECORATE)) return NULL;
    return kind == ID_VALUE ? NULL : "an id is used as a value, which it is not";
}

/* Checks the number of operands and, in one of two passes (late or not), their kinds. */
static const char *check_operands(walk *w, const form *f, const uint32_t *word, uint32_t length,
                                  int late) {
    uint32_t at = 1;
    const char *again = NULL;
    for (const char *p = f->operands;; p++) {
        if (*p == '?') {
            if (at == length) return NULL;
            continue;
        }
        if (*p == '[') {
            again = p;
            if (at == length) return NULL;
            continue;
        }
        if (*p == ']') {
            if (at == length) return NULL;
            p = again;
            continue;
        }
        if (*p == 'N') return NULL;
        if (*p == '\0') return at == length ? NULL : "an instruction is too long";
        if (at >= length) return "an instruction is too short";
        if (*p == 'S') {
            uint32_t text = string_length(word + at, length - at);
            if (!text) return "a text does not end";
            at += text;
            continue;
        }
        const char *problem = check_operand(w, word[0] & 0xFFFFu, *p, word[at++], late);
        if (problem) return problem;
    }
}

/* ---- Rules for single instructions ----------------------------------------------------------- */

static int capability_ok(uint32_t capability) {
    /* Matrix, Shader, ImageQuery, DerivativeControl: supported by every device, and generated from
     * GLSL. */
    return capability == 0 || capability == 1 || capability == 50 || capability == 51;
}

static const char *note_decoration(walk *w, const uint32_t *word, uint32_t length) {
    if (word[2] == DECORATION_BUILT_IN && length > 3 && word[3] == BUILT_IN_WORKGROUP_SIZE)
        w->workgroup_size = word[1];
    if (word[2] == DECORATION_SPEC_ID && (length != 4 || word[3] >= MASU_SPECIAL_COUNT))
        return "a specialization constant has a number that no pass gives";
    if (word[2] != DECORATION_BINDING && word[2] != DECORATION_SET) return NULL;
    if (length != 4) return "a decoration has not one number";
    masu_module *o = w->out;
    uint32_t k = 0;
    while (k < o->bound_count && o->bound[k].id != word[1]) k++;
    if (k == o->bound_count) {
        if (k == MASU_MODULE_BOUND_MAX) return "more than 32 things have a set and a binding";
        o->bound[o->bound_count++] =
            (masu_module_bound){word[1], UINT32_MAX, UINT32_MAX, MASU_MODULE_NOTHING};
    }
    *(word[2] == DECORATION_SET ? &o->bound[k].set : &o->bound[k].binding) = word[3];
    return NULL;
}

/* Notes a global variable. Images get the class SAMPLED until check_resources looks up the type. */
static const char *note_variable(walk *w, const uint32_t *word) {
    masu_module *o = w->out;
    uint32_t storage = word[3], k = 0;
    while (k < o->bound_count && o->bound[k].id != word[2]) k++;
    int bound = storage == CLASS_CONSTANT || storage == CLASS_UNIFORM || storage == CLASS_STORAGE;
    if (storage == CLASS_PUSH) {
        if (w->push_type) return "there are two blocks of push constants";
        w->push_type = word[1];
    }
    if (storage == CLASS_STORAGE && !w->has_storage_class)
        return "storage buffers need SPV_KHR_storage_buffer_storage_class";
    if (!bound) return k < o->bound_count ? "a variable has a binding, but is no resource" : NULL;
    if (k == o->bound_count || o->bound[k].set == UINT32_MAX || o->bound[k].binding == UINT32_MAX)
        return "a resource has no set or no binding";
    if (o->bound[k].class) return "a resource is declared twice";
    o->bound[k].class = storage == CLASS_UNIFORM   ? MASU_MODULE_UNIFORMS
                        : storage == CLASS_STORAGE ? MASU_MODULE_STORAGE
                                                   : MASU_MODULE_SAMPLED;
    return NULL;
}

static const char *note_entry(walk *w, const uint32_t *word, uint32_t length) {
    static const char name[] = "main";
    if (w->entries++) return "there is more than one entry point";
    if (length < 5 || memcmp(word + 3, name, sizeof name) != 0)
        return "the entry point is not main";
    w->out->model = word[1];
    w->entry = word[2];
    return NULL;
}

static const char *note(walk *w, const uint32_t *word, uint32_t length) {
    switch (word[0] & 0xFFFFu) {
    case OP_CAPABILITY:
        return capability_ok(word[1]) ? NULL : "a capability is asked for that no pass has";
    case OP_EXTENSION: {
        static const char known[40] = "SPV_KHR_storage_buffer_storage_class";
        w->has_storage_class = length == 11 && memcmp(word + 1, known, sizeof known) == 0;
        return w->has_storage_class ? NULL : "an extension is asked for that no pass has";
    }
    case OP_EXT_INST_IMPORT: {
        static const char set[16] = "GLSL.std.450";
        return length == 6 && memcmp(word + 2, set, sizeof set) == 0
                   ? NULL
                   : "instructions are imported that are not GLSL.std.450";
    }
    case OP_MEMORY_MODEL:
        return word[1] == 0 && word[2] == 1 ? NULL : "the memory model is not logical, GLSL450";
    case OP_ENTRY_POINT: return note_entry(w, word, length);
    case OP_EXECUTION_MODE:
        if (word[1] != w->entry) return "an execution mode is of no entry point";
        if (word[2] != MODE_LOCAL_SIZE) return NULL;
        if (length != 6 || w->local_sizes++) return "the local size is not three numbers, once";
        memcpy(w->out->local_size, word + 3, sizeof w->out->local_size);
        return NULL;
    case OP_DECORATE: return note_decoration(w, word, length);
    case OP_TYPE_INT:
    case OP_TYPE_FLOAT: return word[2] == 32 ? NULL : "numbers are not of 32 bits";
    case OP_FUNCTION: w->entry_found |= word[2] == w->entry; return NULL;
    case OP_VARIABLE: return w->in_function ? NULL : note_variable(w, word);
    case OP_SOURCE_EXTENSION:
        if (!w->out->record) w->out->record = word, w->out->record_words = length;
        return NULL;
    default: return NULL;
    }
}

/* ---- Functions and blocks -------------------------------------------------------------------- */

static const char *check_block_structure(walk *w, uint32_t op) {
    int ends = op >= OP_BRANCH && op <= OP_UNREACHABLE;
    if (w->merging &&
        !(w->merging == OP_LOOP_MERGE ? op == OP_BRANCH || op == OP_BRANCH_CONDITIONAL
                                      : op == OP_BRANCH_CONDITIONAL || op == OP_SWITCH))
        return "a merge stands before no branch";
    w->merging = op == OP_LOOP_MERGE || op == OP_SELECTION_MERGE ? (int)op : 0;
    switch (op) {
    case OP_FUNCTION:
        if (w->in_function) return "a function begins in another";
        w->in_function = 1;
        w->blocks = 0;
        w->functions++;
        return NULL;
    case OP_FUNCTION_PARAMETER:
        return w->in_function && !w->blocks ? NULL : "a parameter is of no function";
    case OP_FUNCTION_END:
        if (!w->in_function || w->in_block || !w->blocks)
            return "a function ends that has not begun, or within a block";
        w->in_function = 0;
        return NULL;
    case OP_LABEL:
        if (!w->in_function || w->in_block)
            return "a block begins outside of functions, or within another";
        w->in_block = w->blocks = 1;
        return NULL;
    default:
        if (!w->in_block) return "an instruction is in no block";
        if (ends) w->in_block = 0;
        return NULL;
    }
}

static const char *check_order(walk *w, const form *f, uint32_t op) {
    int inside = w->in_function && (op == OP_VARIABLE || op == 1);
    uint32_t rank = inside ? RANK_FUNCTION : f->rank;
    if (rank < w->rank) return "an instruction stands in the wrong section";
    w->rank = rank;
    return rank == RANK_FUNCTION ? check_block_structure(w, op) : NULL;
}

/* ---- Traversal ------------------------------------------------------------------------------- */

static const char *walk_once(walk *w, int late, uint64_t *at) {
    for (*at = HEADER; *at < w->count;) {
        const uint32_t *word = w->words + *at;
        uint32_t op = word[0] & 0xFFFFu, length = word[0] >> 16;
        if (!length || length > w->count - *at) return "an instruction reaches beyond the end";
        const form *f = form_of(op);
        if (!f) return "an instruction is none that shaders are made of";
        const char *problem = check_operands(w, f, word, length, late);
        if (!problem && !late) problem = check_order(w, f, op);
        if (!problem && !late) problem = note(w, word, length);
        if (problem) return problem;
        if (!late && op == OP_FUNCTION && w->functions == 1) w->globals_end = *at;
        *at += length;
    }
    return NULL;
}

/* The instruction that defines a global id; searches the instructions before the first function. */
static const uint32_t *find(const walk *w, uint32_t id) {
    for (uint64_t at = HEADER; at < w->globals_end; at += w->words[at] >> 16) {
        const uint32_t *word = w->words + at;
        uint32_t op = word[0] & 0xFFFFu;
        uint32_t place = op >= TYPE_FIRST && op <= TYPE_LAST           ? 1
                         : (op >= 41 && op <= 52) || op == OP_VARIABLE ? 2
                                                                       : 0;
        if (place && word[place] == id) return word;
    }
    return NULL;
}

static int is(const uint32_t *word, uint32_t op) { return word && (word[0] & 0xFFFFu) == op; }

/* The instruction of the type that a pointer type points to. */
static const uint32_t *pointee_of(const walk *w, uint32_t type) {
    const uint32_t *pointer = find(w, type);
    return is(pointer, OP_TYPE_POINTER) ? find(w, pointer[3]) : NULL;
}

static const char *check_resources(walk *w) {
    for (uint32_t k = 0; k < w->out->bound_count; k++) {
        masu_module_bound *b = &w->out->bound[k];
        if (!b->class) return "a binding is of nothing";
        for (uint32_t j = 0; j < k; j++) {
            if (w->out->bound[j].set == b->set && w->out->bound[j].binding == b->binding)
                return "two resources share a binding";
        }
        const uint32_t *variable = find(w, b->id),
                       *type = variable ? pointee_of(w, variable[1]) : NULL;
        if (b->class != MASU_MODULE_SAMPLED) {
            if (!is(type, OP_TYPE_STRUCT)) return "a buffer is no block";
            continue;
        }
        if (is(type, OP_TYPE_IMAGE) && type[7] == 2)
            b->class = MASU_MODULE_IMAGE;
        else if (!is(type, OP_TYPE_SAMPLED_IMAGE))
            return "a resource is neither a buffer, an image with its sampler nor a storage image";
    }
    return NULL;
}

#define PUSH_MEMBERS 16u

/* End, in bytes, of the last member of a push constant struct. Members are 32-bit scalars or, at
 * the top level, structs of such scalars. 0: other members, or beyond 128 bytes. */
static uint32_t struct_bytes(const walk *w, const uint32_t *type, int deeper) {
    uint32_t members = is(type, OP_TYPE_STRUCT) ? (type[0] >> 16) - 2 : 0, end = 0;
    uint32_t offset[PUSH_MEMBERS];
    if (!members || members > PUSH_MEMBERS) return 0;
    memset(offset, 0xFF, sizeof offset);
    for (uint64_t at = HEADER; at < w->globals_end; at += w->words[at] >> 16) {
        const uint32_t *word = w->words + at;
        if (is(word, OP_MEMBER_DECORATE) && word[0] >> 16 == 5 && word[1] == type[1] &&
            word[3] == DECORATION_OFFSET && word[2] < members)
            offset[word[2]] = word[4];
    }
    for (uint32_t k = 0; k < members; k++) {
        const uint32_t *member = find(w, type[2 + k]);
        uint32_t bytes = is(member, OP_TYPE_INT) || is(member, OP_TYPE_FLOAT) ? 4
                         : deeper ? struct_bytes(w, member, 0)
                                  : 0;
        if (!bytes || offset[k] > 128 || offset[k] % 4 || offset[k] + bytes > 128) return 0;
        if (offset[k] + bytes > end) end = offset[k] + bytes;
    }
    return end;
}

/* The WorkgroupSize constant overrides the execution mode, so both must be equal. */
static const char *check_local_size(walk *w) {
    if (!w->workgroup_size) return NULL;
    const uint32_t *size = find(w, w->workgroup_size);
    if (!size) return NULL; /* decorates an undefined id */
    if (!is(size, OP_CONSTANT_COMPOSITE) || size[0] >> 16 != 6)
        return "the local size is not three numbers, once";
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t *number = find(w, size[3 + k]);
        if (!is(number, OP_CONSTANT) || number[3] != w->out->local_size[k])
            return "there are two local sizes";
    }
    return NULL;
}

const char *masu_module_read(const uint32_t *words, uint64_t count, masu_module *out,
                             uint64_t *at) {
    *at = 0;
    memset(out, 0, sizeof *out);
    if (count < HEADER || count > MASU_MODULE_WORDS_MAX || words[0] != MAGIC)
        return "is missing or is no SPIR-V";
    *at = 1;
    if (words[1] != 0x00010000u) return "is not SPIR-V of version 1.0";
    *at = 3;
    if (!words[3] || words[3] > MASU_MODULE_IDS_MAX) return "has no ids, or more than 65,536";
    *at = 4;
    if (words[4]) return "has a schema";
    walk w = {.words = words, .count = count, .globals_end = count, .bound = words[3], .out = out};
    const char *problem = walk_once(&w, 0, at);
    if (problem) return problem;
    if (w.in_function || !w.entry_found) return "ends within a function, or has no entry point";
    problem = walk_once(&w, 1, at);
    if (problem) return problem;
    *at = count;
    problem = check_resources(&w);
    if (!problem) problem = check_local_size(&w);
    if (!problem && w.push_type) {
        out->push_bytes = struct_bytes(&w, pointee_of(&w, w.push_type), 1);
        if (!out->push_bytes)
            problem = "push constants are not numbers of 32 bits within 128 bytes";
    }
    return problem;
}

/* ---- The record ------------------------------------------------------------------------------ */

static char *put_text(char *to, const char *text) {
    while (*text) *to++ = *text++;
    return to;
}

static char *put_number(char *to, const char *before, uint32_t value, uint32_t digits) {
    to = put_text(to, before);
    for (uint32_t k = digits; k-- > 0; value /= 10) to[k] = (char)('0' + value % 10);
    return to + digits;
}

/* Fixed-width numbers: the text has the same length for all counts. */
void masu_module_record(const masu_module_counts *c, char text[MASU_MODULE_RECORD_BYTES]) {
    memset(text, 0, MASU_MODULE_RECORD_BYTES);
    char *to = put_number(text, "masu code ", c->kind, 2);
    to = put_number(to, ", parts ", c->parts, 4);
    to = put_number(to, ", slots ", c->slots, 5);
    to = put_number(to, ", words ", c->block_words, 1);
    to = put_text(to, c->raster ? ", raster" : ", single");
    to = put_text(to, c->anchored ? ", anchored" : ", in place");
    (void)put_text(to, c->moves ? ", moves" : ", still");
}

uint64_t masu_module_record_place(const uint32_t *words, uint64_t count) {
    uint64_t at = HEADER;
    while (at < count && words[at] >> 16) {
        const form *f = form_of(words[at] & 0xFFFFu);
        if (f && f->rank > RANK_DEBUG) break;
        at += words[at] >> 16;
    }
    return at < count ? at : count;
}
