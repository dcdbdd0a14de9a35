/* spirv.h: looking into SPIR-V modules: instructions, definitions, names. Enough of the format
 * (Khronos SPIR-V specification, sections 2.3 and 3) for tests that ask what a compiler has made of
 * a shader, and for the model sheet, which counts operations.
 *
 * A blob's modules may be anybody's. What is promised of a module that has been read:
 * instructions are as long as their kind needs at least (operands up to there may be read by
 * their place), their results are ids below the bound, names end. What is not: operands may be
 * any number, so ids are looked up with spirv_def; a definition may be of any kind, stand
 * anywhere, name itself. */
#ifndef MASU_SPIRV_H
#define MASU_SPIRV_H

#include <stddef.h>
#include <stdint.h>

enum {
    SPIRV_EXTENSION = 10,
    SPIRV_EXT_INST = 12,
    SPIRV_CAPABILITY = 17,
    SPIRV_NAME = 5,
    SPIRV_MEMBER_NAME = 6,
    SPIRV_TYPE_INT = 21,
    SPIRV_TYPE_FLOAT = 22,
    SPIRV_TYPE_VECTOR = 23,
    SPIRV_TYPE_MATRIX = 24,
    SPIRV_TYPE_ARRAY = 28,
    SPIRV_TYPE_RUNTIME_ARRAY = 29,
    SPIRV_TYPE_STRUCT = 30,
    SPIRV_TYPE_POINTER = 32,
    SPIRV_CONSTANT_TRUE = 41,
    SPIRV_CONSTANT_FALSE = 42,
    SPIRV_CONSTANT = 43,
    SPIRV_FUNCTION = 54,
    SPIRV_FUNCTION_PARAMETER = 55,
    SPIRV_FUNCTION_END = 56,
    SPIRV_FUNCTION_CALL = 57,
    SPIRV_VARIABLE = 59,
    SPIRV_IMAGE_TEXEL_POINTER = 60,
    SPIRV_LOAD = 61,
    SPIRV_STORE = 62,
    SPIRV_COPY_MEMORY = 63,
    SPIRV_ACCESS_CHAIN = 65,
    SPIRV_IN_BOUNDS_ACCESS_CHAIN = 66,
    SPIRV_DECORATE = 71,
    SPIRV_MEMBER_DECORATE = 72,
    SPIRV_COPY_OBJECT = 83,
    SPIRV_BITCAST = 124,
    SPIRV_I_ADD = 128,
    SPIRV_I_SUB = 130,
    SPIRV_LOGICAL_OR = 166,
    SPIRV_LOGICAL_AND = 167,
    SPIRV_LOGICAL_NOT = 168,
    SPIRV_SELECT = 169,
    SPIRV_U_GREATER_THAN = 172,
    SPIRV_S_GREATER_THAN = 173,
    SPIRV_U_GREATER_THAN_EQUAL = 174,
    SPIRV_S_GREATER_THAN_EQUAL = 175,
    SPIRV_U_LESS_THAN = 176,
    SPIRV_S_LESS_THAN = 177,
    SPIRV_U_LESS_THAN_EQUAL = 178,
    SPIRV_S_LESS_THAN_EQUAL = 179,
    SPIRV_PHI = 245,
    SPIRV_LOOP_MERGE = 246,
    SPIRV_LABEL = 248,
    SPIRV_BRANCH = 249,
    SPIRV_BRANCH_CONDITIONAL = 250,
    SPIRV_SWITCH = 251
};

enum {
    SPIRV_DECORATION_COL_MAJOR = 5,
    SPIRV_DECORATION_ARRAY_STRIDE = 6,
    SPIRV_DECORATION_MATRIX_STRIDE = 7,
    SPIRV_DECORATION_DESCRIPTOR_SET = 34,
    SPIRV_DECORATION_OFFSET = 35
};

/* Lets SPIR-V before 1.3 have storage buffers; 40 bytes with its zeros. */
#define SPIRV_STORAGE_EXTENSION "SPV_KHR_storage_buffer_storage_class"
enum { SPIRV_STORAGE_EXTENSION_WORDS = 10 };

typedef struct spirv_instruction {
    uint32_t op, count;   /* words, the first included */
    const uint32_t *word; /* word[0] is op and count */
} spirv_instruction;

typedef struct spirv_module {
    uint32_t *words;
    size_t word_count;
    uint32_t bound; /* ids are below */
    spirv_instruction *list;
    size_t count;
    const spirv_instruction **def; /* by id; NULL: none, or of a kind that no test asks about */
} spirv_module;

/* Each returns 0, with nothing left to free, when the bytes are no module or there is no file. */
int spirv_from_words(const uint32_t *words, size_t count, spirv_module *out);
int spirv_from_file(const char *path, spirv_module *out);
void spirv_free(spirv_module *module);

/* What defines an id; NULL: nothing, or it is none. */
const spirv_instruction *spirv_def(const spirv_module *module, uint32_t id);

/* Name of an id, or of a struct's member; "" if it has none. */
const char *spirv_name(const spirv_module *module, uint32_t id);
const char *spirv_member_name(const spirv_module *module, uint32_t id, uint32_t member);

/* Operand of a decoration; 0 if it is not there. */
int spirv_decoration(const spirv_module *module, uint32_t id, uint32_t decoration, uint32_t *value);
int spirv_member_decoration(const spirv_module *module, uint32_t id, uint32_t member,
                            uint32_t decoration, uint32_t *value);

#endif
