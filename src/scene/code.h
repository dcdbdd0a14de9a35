/* code.h: what can be told of a SPIR-V module without running it, of words that may be anybody's. No memory but the
 * stack's (MASU_MODULE_IDS_MAX / 4 bytes and a few hundred), and time in proportion to the words.
 *
 * masu_module_read walks it once and says whether it holds together (Khronos SPIR-V specification, sections 2.3, 2.4 and
 * 3): header, lengths, order of sections, instructions of the set that shaders are made of, each with operands of the
 * right number; every id defined once, before it is used where that is asked, as a type where a type is meant; functions
 * and blocks that begin and end. It collects what the module asks of the world around it.
 *
 * What is left: types are not compared, and the shape of the control flow is not judged. A module that passes may still
 * be one that no compiler would make, and a driver need not bear it: code in a blob is trusted as a program is. */
#ifndef MASU_SCENE_CODE_H
#define MASU_SCENE_CODE_H

#include <stdint.h>

#define MASU_MODULE_WORDS_MAX ((uint64_t)16 << 20)
#define MASU_MODULE_IDS_MAX 65536u
#define MASU_MODULE_BOUND_MAX 32u /* resources, and other interfaces, of a module */

typedef enum masu_module_class {
    MASU_MODULE_NOTHING = 0,
    MASU_MODULE_UNIFORMS = 1, /* a buffer of uniforms */
    MASU_MODULE_STORAGE = 2,  /* a storage buffer */
    MASU_MODULE_SAMPLED = 3,  /* an image with its sampler */
    MASU_MODULE_IMAGE = 4     /* a storage image */
} masu_module_class;

typedef struct masu_module_bound {
    uint32_t id, set, binding, class;
} masu_module_bound;

/* What a module asks for. */
typedef struct masu_module {
    uint32_t model;           /* execution model of its one entry point, "main" */
    uint32_t local_size[3];   /* of a compute shader */
    uint32_t push_bytes;      /* of its push constants; 0: it has none */
    uint32_t bound_count;
    masu_module_bound bound[MASU_MODULE_BOUND_MAX];
    const uint32_t *record;   /* the words of its MASU_MODULE_RECORD, NULL: none */
    uint32_t record_words;
} masu_module;

/* NULL: it holds together, and `out` is filled. Else what is wrong; *at: the word where. */
const char *masu_module_read(const uint32_t *words, uint64_t count, masu_module *out, uint64_t *at);

/* ---- The record: what a module of a blob was compiled for ---------------------------------------- */

/* masu-bake writes it into each module, as the text of an OpModuleProcessed, which means nothing to drivers; masu_scene_bind
 * makes the same of the blob's own numbers and compares. */
typedef struct masu_module_counts {
    uint32_t kind; /* of the section */
    uint32_t parts, slots, block_words;
    uint32_t raster, anchored, moves; /* 0 or 1; moves: slots depend on parameters or time */
} masu_module_counts;

#define MASU_MODULE_RECORD_BYTES 72u /* with the NUL that ends it */
void masu_module_record(const masu_module_counts *counts, char text[MASU_MODULE_RECORD_BYTES]);
/* The instruction: its first word, then the text. */
#define MASU_MODULE_RECORD_WORDS (1u + MASU_MODULE_RECORD_BYTES / 4u)
#define MASU_MODULE_RECORD_FIRST (MASU_MODULE_RECORD_WORDS << 16 | 330u)
/* Where in a module that holds together it belongs. */
uint64_t masu_module_record_place(const uint32_t *words, uint64_t count);

#endif
