/* spirv.c: see spirv.h. */
#include "spirv/spirv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC 0x07230203u
#define HEADER_WORDS 5u
#define WORDS_MOST ((size_t)4 << 20)

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

int spirv_from_words(const uint32_t *words, size_t count, spirv_module *out) {
    memset(out, 0, sizeof *out);
    if (count < HEADER_WORDS || count > WORDS_MOST || words[0] != MAGIC) return 0;
    out->words = malloc(count * sizeof *words);
    out->list = calloc(count, sizeof *out->list);
    out->bound = words[3];
    if (out->bound < WORDS_MOST) out->def = calloc(out->bound + 1, sizeof *out->def);
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
        if (i->count == 0 || i->count > count - at) {
            spirv_free(out);
            return 0;
        }
        uint32_t w = result_word(i->op);
        if (w && w < i->count && i->word[w] < out->bound) out->def[i->word[w]] = i;
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
