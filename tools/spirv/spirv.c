/* spirv.c: see spirv.h. */
#include "spirv/spirv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC 0x07230203u
#define HEADER_WORDS 5u
#define WORDS_MOST ((size_t)4 << 20)
#define IDS_A_WORD 16u

/* Where the result id of an instruction stands; 0: it has none, or none that matters here. */
static uint32_t result_word(uint32_t op) {
    if (op >= 19 && op <= 39) return 1; /* types */
    if (op == SPIRV_LABEL) return 1;
    if (op == 1 || op == SPIRV_EXT_INST || (op >= 41 && op <= 55)) return 2;
    if (op == SPIRV_FUNCTION_CALL || (op >= SPIRV_VARIABLE && op <= SPIRV_LOAD)) return 2;
    if (op >= SPIRV_ACCESS_CHAIN && op <= 70) return 2;
    if (op >= 77 && op <= 98) return 2;
    if (op >= 100 && op <= 215) return 2;
    if (op >= 229 && op <= SPIRV_PHI) return 2;
    return 0;
}

/* The least that an instruction has words, the first included: the specification's, of all whose
 * operands somebody here reads by their place. One with fewer would let its reader see the next
 * instruction's, or none. */
static uint32_t least_words(uint32_t op) {
    static const struct {
        uint16_t first, last, words;
    } list[] = {
        {5, 5, 3},     {6, 6, 4},     {12, 12, 5},   {15, 15, 4},   {16, 16, 3},   {19, 20, 2},
        {21, 21, 4},   {22, 22, 3},   {23, 24, 4},   {25, 25, 9},   {26, 26, 2},   {27, 27, 3},
        {28, 28, 4},   {29, 29, 3},   {30, 31, 2},   {32, 32, 4},   {33, 33, 3},   {34, 38, 2},
        {39, 39, 3},   {41, 42, 3},   {43, 43, 4},   {44, 49, 3},   {50, 50, 4},   {51, 51, 3},
        {52, 52, 4},   {54, 54, 5},   {55, 55, 3},   {57, 57, 4},   {59, 59, 4},   {60, 60, 6},
        {61, 61, 4},   {62, 63, 3},   {64, 66, 4},   {67, 68, 4},   {69, 70, 4},   {71, 71, 3},
        {72, 72, 4},   {77, 77, 5},   {78, 78, 6},   {79, 79, 5},   {80, 80, 3},   {81, 81, 4},
        {82, 82, 5},   {83, 84, 4},   {86, 97, 5},   {98, 98, 5},   {99, 99, 4},   {100, 127, 4},
        {128, 153, 5}, {154, 157, 4}, {158, 167, 5}, {168, 168, 4}, {169, 169, 6}, {170, 191, 5},
        {194, 199, 5}, {200, 215, 4}, {227, 227, 6}, {228, 228, 5}, {229, 242, 6}, {245, 245, 3},
        {246, 246, 4}, {247, 247, 3}, {248, 249, 2}, {250, 250, 4}, {251, 251, 3}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        if (op >= list[k].first && op <= list[k].last) return list[k].words;
    }
    return 1;
}

/* A name ends within its instruction. */
static int name_ends(const spirv_instruction *i) {
    return (i->op != SPIRV_NAME && i->op != SPIRV_MEMBER_NAME) ||
           memchr(i->word + i->count - 1, 0, sizeof *i->word);
}

int spirv_from_words(const uint32_t *words, size_t count, spirv_module *out) {
    memset(out, 0, sizeof *out);
    if (count < HEADER_WORDS || count > WORDS_MOST || words[0] != MAGIC) return 0;
    out->words = malloc(count * sizeof *words);
    out->list = calloc(count, sizeof *out->list);
    out->bound = words[3];
    /* An id takes two words at least; optimisers leave some unused. */
    if (out->bound / IDS_A_WORD <= count) out->def = calloc(out->bound + 1, sizeof *out->def);
    if (!out->words || !out->list || !out->def) {
        spirv_free(out);
        return 0;
    }
    memcpy(out->words, words, count * sizeof *words);
    out->word_count = count;
    for (size_t at = HEADER_WORDS; at < count;) {
        spirv_instruction *i = &out->list[out->count++];
        i->word = out->words + at;
        i->op = i->word[0] & 0xFFFFu;
        i->count = i->word[0] >> 16;
        if (i->count < least_words(i->op) || i->count > count - at || !name_ends(i)) {
            spirv_free(out);
            return 0;
        }
        uint32_t w = result_word(i->op);
        if (w && (w >= i->count || i->word[w] == 0 || i->word[w] >= out->bound)) {
            spirv_free(out);
            return 0;
        }
        if (w) out->def[i->word[w]] = i;
        at += i->count;
    }
    return 1;
}

int spirv_from_file(const char *path, spirv_module *out) {
    memset(out, 0, sizeof *out);
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    uint32_t *words = malloc(WORDS_MOST * sizeof *words);
    size_t count = words ? fread(words, sizeof *words, WORDS_MOST, file) : 0;
    int good = words && spirv_from_words(words, count, out);
    (void)fclose(file);
    free(words);
    return good;
}

void spirv_free(spirv_module *module) {
    free(module->words);
    free(module->list);
    free((void *)module->def);
    memset(module, 0, sizeof *module);
}

const spirv_instruction *spirv_def(const spirv_module *module, uint32_t id) {
    return id < module->bound ? module->def[id] : NULL;
}

const char *spirv_name(const spirv_module *module, uint32_t id) {
    for (size_t k = 0; k < module->count; k++) {
        const spirv_instruction *i = &module->list[k];
        if (i->op == SPIRV_NAME && i->word[1] == id) return (const char *)(i->word + 2);
    }
    return "";
}

const char *spirv_member_name(const spirv_module *module, uint32_t id, uint32_t member) {
    for (size_t k = 0; k < module->count; k++) {
        const spirv_instruction *i = &module->list[k];
        if (i->op == SPIRV_MEMBER_NAME && i->word[1] == id && i->word[2] == member) {
            return (const char *)(i->word + 3);
        }
    }
    return "";
}

int spirv_decoration(const spirv_module *module, uint32_t id, uint32_t decoration,
                     uint32_t *value) {
    for (size_t k = 0; k < module->count; k++) {
        const spirv_instruction *i = &module->list[k];
        if (i->op != SPIRV_DECORATE || i->word[1] != id || i->word[2] != decoration) continue;
        *value = i->count > 3 ? i->word[3] : 0;
        return 1;
    }
    return 0;
}

int spirv_member_decoration(const spirv_module *module, uint32_t id, uint32_t member,
                            uint32_t decoration, uint32_t *value) {
    for (size_t k = 0; k < module->count; k++) {
        const spirv_instruction *i = &module->list[k];
        if (i->op != SPIRV_MEMBER_DECORATE || i->word[1] != id || i->word[2] != member) continue;
        if (i->word[3] != decoration) continue;
        *value = i->count > 4 ? i->word[4] : 0;
        return 1;
    }
    return 0;
}
