/* unpack.h: SPIR-V as the library holds it, and back. The build packs every module of the library
 * (tools/generate/pack_spirv.c) to a tenth; masu_init unpacks those that it makes pipelines of, each for
 * as long as vkCreateShaderModule reads it (pipelines.c).
 *
 *   module --- tokens --- runs --- pool      what every module of a library has in common is there once
 *
 * Tokens are bytes, a few for an instruction: a head, which stands for its first word and how the others
 * are coded; then these. Permutations of a shader differ in little but the numbers of their ids, so ids are not
 * coded by number: one that was used lately is its place among those, another how many results ago
 * it was one; and the number of a result is how far it lies behind one of the last few, of which optimisers
 * keep several rows. So alike instructions have the same tokens. What tokens are of a module is a list of runs
 * of the pool, and the pool is what earlier modules did not have. Each module is unpacked by itself,
 * from constants alone, and what is written is never read: it may go to memory that a processor is slow to
 * read.
 *
 * Total: whatever the bytes are, nothing outside of them is read, nothing behind the words is written, and
 * the work is bounded by the words. */
#ifndef MASU_UNPACK_H
#define MASU_UNPACK_H

#include "device/spirv_interface.h"

#include <stdint.h>

/* How a word behind the first is coded. */
enum {
    MASU_PACK_LITERAL, /* 7 bits a byte, the lowest first, the highest bit: more follow */
    MASU_PACK_WORD,    /* 4 bytes */
    MASU_PACK_RESULT,  /* a number; is a result from here on */
    MASU_PACK_TYPE,    /* an id, its place among types */
    MASU_PACK_ID,      /* an id, its place among others */
    MASU_PACK_CODINGS
};

/* The byte of an id. */
#define MASU_PACK_RECENT 64u  /* below: its place among ids used lately, from 1 on */
#define MASU_PACK_EARLIER 0u  /* a signed literal: of results in order, how far behind the last id so coded */
#define MASU_PACK_NEAR 64u    /* from here on: the last result, the one before, ... */
#define MASU_PACK_FAR 254u    /* a literal more results ago */
#define MASU_PACK_NUMBER 255u /* a number */

/* The byte of a number: which of the last rows << 5 | how far behind its last result, plus 4. */
#define MASU_PACK_ROWS 7u    /* as a row: none, a literal */
#define MASU_PACK_STEP 31u   /* as a distance: a signed literal */
#define MASU_PACK_BACK 4u
#define MASU_PACK_RESULTS 4096u /* as many can be named; a power of two */

#define MASU_PACK_SHAPE 8u /* words that are coded each in its way; the rest as the last of them */

/* A byte of a run: how many bytes of the module's own part of the pool come first, how many from elsewhere
 * then, and whether these do not follow those before. */
#define MASU_PACK_OWN 7u        /* this many: a literal more */
#define MASU_PACK_ELSEWHERE 15u /* this many: a literal more */
#define MASU_PACK_JUMP 128u     /* a signed literal: how far from where they would follow */

typedef struct masu_pack_head {
    uint32_t word;                  /* count << 16 | operation */
    uint8_t shape[MASU_PACK_SHAPE]; /* MASU_PACK_* of words 1 .. */
} masu_pack_head;

/* What modules share. */
typedef struct masu_pack {
    const masu_pack_head *heads; /* at most 255; token 255 is a head of its own: its word, all literals */
    uint32_t head_count;
    const uint8_t *pool, *runs;
    uint32_t pool_bytes, run_bytes;
} masu_pack;

typedef struct masu_packed {
    uint32_t run, run_bytes; /* its bytes of the pack's runs */
    uint32_t own;            /* where its own part of the pool begins */
    uint32_t words;          /* 0: the library was built without it */
    masu_interface interface;
} masu_packed;

/* Writes packed->words words. 0: the bytes are no packed module of that many; what was written is then worth
 * nothing. */
int masu_unpack(const masu_pack *pack, const masu_packed *packed, uint32_t *words);

#endif
