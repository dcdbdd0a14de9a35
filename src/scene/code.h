/* code.h: validates a SPIR-V module of untrusted origin without running it. Uses only stack memory
 * (MASU_MODULE_IDS_MAX / 4 bytes and a few hundred more), and time linear in the module's size.
 *
 * masu_module_read checks that a module is well-formed (Khronos SPIR-V specification, sections 2.3,
 * 2.4 and 3): header, instruction lengths and order of sections. Only instructions that shaders use
 * are allowed, each with the right number of operands. Every id is defined once, before its use if
 * the specification requires that, and as a type if a type is expected. Functions and blocks begin
 * and end. The function also collects the module's interface.
 *
 * Not checked: types are not compared, and control flow is not analysed. A module that passes may
 * still be one that no compiler would emit and that crashes a driver: code in a blob must be
 * trusted like a program. */
#ifndef MASU_SCENE_CODE_H
#define MASU_SCENE_CODE_H

#include <stdint.h>

#define MASU_MODULE_WORDS_MAX ((uint64_t)16 << 20)
#define MASU_MODULE_IDS_MAX 65536u
/* Specialisation constants that a module may declare: 0 .. count - 1 (src/device/pipelines.c). */
#define MASU_SPECIAL_COUNT 27u
#define MASU_MODULE_BOUND_MAX 32u /* resources of a module; also its other interface variables */

typedef enum masu_module_class {
    MASU_MODULE_NOTHING = 0,
    MASU_MODULE_UNIFORMS = 1, /* uniform buffer */
    MASU_MODULE_STORAGE = 2,  /* a storage buffer */
    MASU_MODULE_SAMPLED = 3,  /* combined image sampler */
    MASU_MODULE_IMAGE = 4     /* a storage image */
} masu_module_class;

typedef struct masu_module_bound {
    uint32_t id, set, binding, class;
} masu_module_bound;

/* The interface of a module. */
typedef struct masu_module {
    uint32_t model;           /* execution model of its only entry point, "main" */
    uint32_t local_size[3];   /* of a compute shader */
    uint32_t push_bytes;      /* size of its push constants; 0: none */
    uint32_t bound_count;
    masu_module_bound bound[MASU_MODULE_BOUND_MAX];
    const uint32_t *record; /* the instruction with its MASU_MODULE_RECORD; NULL: none */
    uint32_t record_words;
} masu_module;

/* Validates a module and fills `out`. Returns NULL, or an error text; *at is then the index of the
 * invalid 32-bit value. */
const char *masu_module_read(const uint32_t *words, uint64_t count, masu_module *out, uint64_t *at);

/* ---- The record: the counts that a module of a blob was compiled for ------------------------- */

/* masu-bake writes the record into each module as the string of an OpSourceExtension, which drivers
 * ignore. masu_scene_bind generates it from the counts of the blob and compares. */
typedef struct masu_module_counts {
    uint32_t kind; /* section kind */
    uint32_t parts, slots, block_words;
    uint32_t raster, anchored, moves; /* 0 or 1; moves: slots depend on parameters or time */
} masu_module_counts;

#define MASU_MODULE_RECORD_BYTES 72u /* including the terminating NUL */
void masu_module_record(const masu_module_counts *counts, char text[MASU_MODULE_RECORD_BYTES]);
/* The instruction: opcode and length, then the string. */
#define MASU_MODULE_RECORD_WORDS (1u + MASU_MODULE_RECORD_BYTES / 4u)
#define MASU_MODULE_RECORD_FIRST (MASU_MODULE_RECORD_WORDS << 16 | 4u)
/* Index at which the record is inserted into a well-formed module. */
uint64_t masu_module_record_place(const uint32_t *words, uint64_t count);

#endif
