/* whole_vectors.c: see whole_vectors.h. */
#include "spirv/whole_vectors.h"

#include "spirv/spirv.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UNIFORM = 2, PUSH_CONSTANT = 9, STORAGE_BUFFER = 12 };
enum {
    COMPOSITE_EXTRACT = 81,
    COMPOSITE_INSERT = 82,
    VECTOR_SHUFFLE = 79,
    VECTOR_EXTRACT_DYNAMIC = 77
};
enum { DECORATION_ROW_MAJOR = 4, DEPTH = 12 };
enum { RAY_QUERY = 4472, SPIRV_1_0 = 0x00010000, SPIRV_1_3 = 0x00010300 };
#define EXTENSION_WORDS SPIRV_STORAGE_EXTENSION_WORDS
static const char extension[4 * EXTENSION_WORDS] = SPIRV_STORAGE_EXTENSION;
#define ANY 0xFFFFFFFFu

/* Where in its block a pointer points: members of structs by number, elements of arrays as ANY. */
typedef struct place {
    uint32_t root, depth, index[DEPTH];
} place;

typedef struct chain {
    bool known;
    place at;         /* of a component: its vector's */
    uint32_t storage, type; /* of what it points to; of a component: of its vector */
    bool component, alone, loaded; /* of a vector; nothing but loads use it; some do */
    uint32_t number;  /* id of the component's index */
    /* id of a pointer to the vector; 0: to be made of this chain without its last index */
    uint32_t vector;
    bool change;
} chain;

/* What is read of one vector. */
typedef struct group {
    place at;
    /* a bit for each component, all for the whole or for one that is not constant */
    uint32_t parts;
} group;

typedef struct state {
    spirv_module m;
    chain *chains; /* by id */
    group *groups;
    size_t group_count;
    place *wholes; /* structs and arrays that are loaded in one piece */
    size_t whole_count;
    uint32_t *out;
    size_t out_count, out_room;
    uint32_t bound;
} state;

static const spirv_instruction *def(const state *s, uint32_t id) { return spirv_def(&s->m, id); }

/* What is known of a pointer; one that is no id is not known. */
static chain *chain_of(const state *s, uint32_t id) {
    return &s->chains[id < s->m.bound ? id : s->m.bound];
}

static bool same(const place *a, const place *b, uint32_t depth) {
    return a->root == b->root && a->depth >= depth && b->depth >= depth &&
           !memcmp(a->index, b->index, depth * sizeof *a->index);
}

/* ---- Finding --------------------------------------------------------------------------------- */

static bool start(const state *s, uint32_t base, chain *c) {
    const spirv_instruction *b = def(s, base);
    if (!b) return false;
    if (b->op == SPIRV_VARIABLE) {
        const spirv_instruction *pointer = def(s, b->word[1]);
        uint32_t storage = b->word[3];
        if (!pointer || pointer->op != SPIRV_TYPE_POINTER) return false;
        if (storage != UNIFORM && storage != PUSH_CONSTANT && storage != STORAGE_BUFFER)
            return false;
        *c = (chain){
            .known = true, .at = {.root = base}, .storage = storage, .type = pointer->word[3]};
        return true;
    }
    if (b->op != SPIRV_ACCESS_CHAIN && b->op != SPIRV_IN_BOUNDS_ACCESS_CHAIN) return false;
    *c = *chain_of(s, base);
    return c->known && !c->component;
}

/* False: not one that is known here. */
static bool follow(const state *s, const spirv_instruction *i, chain *c) {
    if (!start(s, i->word[3], c)) return false;
    uint32_t last = i->count - 1;
    for (uint32_t k = 4; k <= last; k++) {
        const spirv_instruction *type = def(s, c->type), *number = def(s, i->word[k]);
        if (!type) return false;
        if (type->op == SPIRV_TYPE_VECTOR) {
            c->component = true;
            c->number = i->word[k];
            c->vector = k == 4 ? i->word[3] : 0;
            return k == last;
        }
        if (c->at.depth == DEPTH) return false;
        bool structure = type->op == SPIRV_TYPE_STRUCT;
        if (structure &&
            (!number || number->op != SPIRV_CONSTANT || number->word[3] >= type->count - 2))
            return false;
        if (type->count < 3) return false; /* made of nothing */
        c->at.index[c->at.depth++] = structure ? number->word[3] : ANY;
        c->type = type->word[structure ? 2 + number->word[3] : 2];
    }
    return true;
}

static group *group_of(state *s, const place *at) {
    for (size_t k = 0; k < s->group_count; k++) {
        if (s->groups[k].at.depth == at->depth && same(&s->groups[k].at, at, at->depth))
            return &s->groups[k];
    }
    s->groups[s->group_count] = (group){.at = *at};
    return &s->groups[s->group_count++];
}

static void note_load(state *s, const spirv_instruction *load) {
    uint32_t id = load->word[3];
    chain c = *chain_of(s, id);
    if (!c.known && !start(s, id, &c)) return;
    uint32_t op = def(s, c.type) ? def(s, c.type)->op : 0;
    if (c.component) {
        const spirv_instruction *number = def(s, c.number);
        s->chains[id].loaded = true;
        group_of(s, &c.at)->parts |=
            number && number->op == SPIRV_CONSTANT ? 1u << (number->word[3] & 31) : ANY;
    } else if (op == SPIRV_TYPE_VECTOR) {
        group_of(s, &c.at)->parts = ANY;
    } else if (op == SPIRV_TYPE_STRUCT || op == SPIRV_TYPE_ARRAY || op == SPIRV_TYPE_MATRIX) {
        s->wholes[s->whole_count++] = c.at;
    }
}

/* A word that only looks like the id does no harm: a chain stays beside the new one that could
 * go. */
static void note_uses(state *s, const spirv_instruction *i) {
    uint32_t last = i->count;
    if (i->op == COMPOSITE_EXTRACT || i->op == SPIRV_SWITCH) last = i->op == SPIRV_SWITCH ? 3 : 4;
    if (i->op == COMPOSITE_INSERT || i->op == VECTOR_SHUFFLE) last = 5;
    for (uint32_t k = 1; k < last && k < i->count; k++) {
        uint32_t id = i->word[k];
        bool result = k == 2 && id < s->m.bound && def(s, id) == i;
        if (i->op == SPIRV_EXT_INST && k == 4) continue;
        if (id < s->m.bound && !result && !(i->op == SPIRV_LOAD && k == 3))
            s->chains[id].alone = false;
    }
}

/* Of a component that is loaded: it has a group. */
static bool several(state *s, const chain *c) {
    uint32_t parts = group_of(s, &c->at)->parts;
    for (size_t k = 0; k < s->whole_count; k++) {
        if (s->wholes[k].depth <= c->at.depth && same(&s->wholes[k], &c->at, s->wholes[k].depth))
            parts = ANY;
    }
    return (parts & (parts - 1)) != 0;
}

static bool row_major(const state *s) {
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        if (i->op == SPIRV_MEMBER_DECORATE && i->word[3] == DECORATION_ROW_MAJOR) return true;
    }
    return false;
}

static void decide(state *s) {
    bool inside = false;
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        chain c = {0};
        inside |= i->op == SPIRV_FUNCTION;
        if (inside && (i->op == SPIRV_ACCESS_CHAIN || i->op == SPIRV_IN_BOUNDS_ACCESS_CHAIN) &&
            follow(s, i, &c)) {
            c.alone = true;
            s->chains[i->word[2]] = c;
        }
    }
    inside = false;
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        inside |= i->op == SPIRV_FUNCTION;
        if (!inside) continue;
        if (i->op == SPIRV_LOAD) note_load(s, i);
        note_uses(s, i);
    }
    for (uint32_t id = 0; id < s->m.bound; id++) {
        chain *c = &s->chains[id];
        c->change = c->known && c->component && c->loaded && several(s, c);
    }
}

/* ---- Writing --------------------------------------------------------------------------------- */

/* Room is for each instruction of the module to become two, and for types of pointers. */
static void put(state *s, const uint32_t *words, uint32_t count) {
    if (s->out_count + count <= s->out_room)
        memcpy(s->out + s->out_count, words, count * sizeof *words);
    s->out_count += count;
}

typedef struct pointer_type {
    uint32_t storage, type, id;
} pointer_type;

/* The types of pointers that chains without their last index have; those that the module lacks
 * are written. */
static void put_pointers(state *s, pointer_type *list, size_t *count) {
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        if (i->op == SPIRV_TYPE_POINTER)
            list[(*count)++] = (pointer_type){i->word[2], i->word[3], i->word[1]};
    }
    for (uint32_t id = 0; id < s->m.bound; id++) {
        const chain *c = &s->chains[id];
        size_t n = 0;
        if (!c->change) continue;
        while (n < *count && (list[n].storage != c->storage || list[n].type != c->type)) n++;
        if (n < *count) continue;
        list[(*count)++] = (pointer_type){c->storage, c->type, s->bound};
        put(s, (uint32_t[]){4u << 16 | SPIRV_TYPE_POINTER, s->bound++, c->storage, c->type}, 4);
    }
}

static void put_chain(state *s, const spirv_instruction *i, const pointer_type *list) {
    chain *c = &s->chains[i->word[2]];
    if (!c->alone) put(s, i->word, i->count); /* for what stores to it */
    if (c->vector) return;
    while (list->storage != c->storage || list->type != c->type) list++;
    c->vector = c->alone ? i->word[2] : s->bound++;
    put(s, (uint32_t[]){(i->count - 1) << 16 | i->op, list->id, c->vector}, 3);
    put(s, i->word + 3, i->count - 4);
}

static void put_load(state *s, const spirv_instruction *i, const chain *c) {
    const spirv_instruction *number = def(s, c->number);
    bool constant = number && number->op == SPIRV_CONSTANT;
    uint32_t id = s->bound++;
    put(s, (uint32_t[]){i->word[0], c->type, id, c->vector}, 4);
    put(s, i->word + 4, i->count - 4);
    put(s,
        (uint32_t[]){5u << 16 | (constant ? COMPOSITE_EXTRACT : VECTOR_EXTRACT_DYNAMIC), i->word[1],
                     i->word[2], id, constant ? number->word[3] : c->number},
        5);
}

/* glslang uses only one part of SPIR-V after 1.0: the storage class StorageBuffer of 1.3, which is
 * an extension of 1.0. Modules with ray queries keep their version: ray queries need Vulkan 1.1. */
static bool can_be_1_0(const state *s) {
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        if (i->op == SPIRV_CAPABILITY && i->count > 1 && i->word[1] == RAY_QUERY) return false;
    }
    return s->m.words[1] <= SPIRV_1_3;
}

static bool lacks_extension(const state *s) {
    bool needed = false;
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        needed |= i->op == SPIRV_TYPE_POINTER && i->word[2] == STORAGE_BUFFER;
        if (i->op == SPIRV_EXTENSION && i->count == 1 + EXTENSION_WORDS &&
            !memcmp(i->word + 1, extension, sizeof extension))
            return false;
    }
    return needed;
}

static void put_extension(state *s) {
    uint32_t words[1 + EXTENSION_WORDS] = {(1 + EXTENSION_WORDS) << 16 | SPIRV_EXTENSION};
    memcpy(words + 1, extension, sizeof extension);
    put(s, words, 1 + EXTENSION_WORDS);
}

static void write_out(state *s, pointer_type *list) {
    size_t pointers = 0;
    bool inside = false;
    bool older = can_be_1_0(s), extend = older && lacks_extension(s);
    put(s, s->m.words, 5);
    for (size_t k = 0; k < s->m.count; k++) {
        const spirv_instruction *i = &s->m.list[k];
        if (extend && i->op != SPIRV_CAPABILITY) put_extension(s), extend = false;
        if (i->op == SPIRV_FUNCTION && !inside) put_pointers(s, list, &pointers);
        inside |= i->op == SPIRV_FUNCTION;
        /* Of a broken module something outside of functions may have a chain's id: the types are
         * not there yet. */
        bool chained = i->op == SPIRV_ACCESS_CHAIN || i->op == SPIRV_IN_BOUNDS_ACCESS_CHAIN;
        if (inside && chained && s->chains[i->word[2]].change)
            put_chain(s, i, list);
        else if (inside && i->op == SPIRV_LOAD && chain_of(s, i->word[3])->change)
            put_load(s, i, chain_of(s, i->word[3]));
        else
            put(s, i->word, i->count);
    }
    if (s->out_count > s->out_room) return;
    s->out[3] = s->bound;
    if (older) s->out[1] = SPIRV_1_0;
}

uint32_t *masu_whole_vectors(const uint32_t *words, size_t count, size_t *changed_count) {
    state s = {0};
    pointer_type *list = NULL;
    if (!spirv_from_words(words, count, &s.m)) return NULL;
    s.bound = s.m.bound;
    s.out_room = 4 * s.m.word_count + 1 + EXTENSION_WORDS;
    s.chains = calloc(s.m.bound + 1u, sizeof *s.chains);
    s.groups = calloc(s.m.count, sizeof *s.groups);
    s.wholes = calloc(s.m.count, sizeof *s.wholes);
    s.out = malloc(s.out_room * sizeof *s.out);
    list = calloc(s.m.count + s.m.bound, sizeof *list);
    if (s.chains && s.groups && s.wholes && s.out && list) {
        if (!row_major(&s)) decide(&s);
        write_out(&s, list);
    }
    if (!s.out_count || s.out_count > s.out_room) {
        free(s.out);
        s.out = NULL;
    }
    *changed_count = s.out_count;
    free(list);
    free(s.wholes);
    free(s.groups);
    free(s.chains);
    spirv_free(&s.m);
    return s.out;
}

masu_whole_vectors_result masu_whole_vectors_file(const char *from, const char *to) {
    spirv_module m;
    size_t count = 0;
    if (!spirv_from_file(from, &m)) return MASU_WHOLE_VECTORS_NO_MODULE;
    uint32_t *words = masu_whole_vectors(m.words, m.word_count, &count);
    FILE *out = words ? fopen(to, "wb") : NULL;
    bool good = out && fwrite(words, sizeof *words, count, out) == count;
    if (out && fclose(out)) good = false;
    free(words);
    spirv_free(&m);
    return good ? MASU_WHOLE_VECTORS_OK : MASU_WHOLE_VECTORS_NOT_WRITTEN;
}
