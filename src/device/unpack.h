/* unpack.h: the compressed form of SPIR-V in the library, and its decoder. The build packs every
 * module (tools/generate/pack_spirv.c) to about a tenth. masu_init unpacks a module for the time of
 * vkCreateShaderModule (pipelines.c).
 *
 *   module --- tokens --- runs --- pool      bytes that modules share are stored once
 *
 * Tokens are bytes. An instruction starts with a head, which stands for opcode and length and for
 * the coding of the operands; the operands follow. The permutations of a shader differ in little
 * but their id numbers, so ids are not stored as numbers. A recently used id is stored as its index
 * in the recent list, any other id as the number of results since its definition. A new result id
 * is stored as its distance from the last id of one of a few rows, because optimisers emit ids in
 * several interleaved sequences. As a result, similar instructions have equal tokens. The tokens of
 * a module are a list of runs of the pool. The pool holds those bytes that earlier modules did not
 * have. Each module is unpacked separately and only from constants. The decoder never reads its
 * output, so the output may be in memory that is slow to read, such as write-combined memory.
 *
 * Safe for arbitrary input: reads only the pack, writes at most packed->words values, and its work
 * is bounded by that number. */
#ifndef MASU_UNPACK_H
#define MASU_UNPACK_H

#include "device/spirv_interface.h"

#include <stdint.h>

/* Coding of an operand: a 32-bit value after the first of an instruction. */
enum {
    MASU_PACK_LITERAL, /* 7 bits per byte, lowest first; the high bit is set if more follow */
    MASU_PACK_WORD,    /* 4 bytes */
    MASU_PACK_RESULT,  /* a number; defines a new result */
    MASU_PACK_TYPE,    /* an id, coded by the recent list of types */
    MASU_PACK_ID,      /* an id, coded by the recent list of other ids */
    MASU_PACK_CODINGS
};

/* First byte of an id. */
#define MASU_PACK_RECENT 64u /* below: index in the recent list, from 1 on */
/* then a signed literal: distance in results from the last id coded so */
#define MASU_PACK_EARLIER 0u
#define MASU_PACK_NEAR 64u    /* from here on: the last result, the one before, ... */
#define MASU_PACK_FAR 254u    /* then a literal: this many results earlier */
#define MASU_PACK_NUMBER 255u /* then a number */

/* First byte of a number: row << 5 | distance from the row's last result + MASU_PACK_BACK. */
#define MASU_PACK_ROWS 7u  /* as a row: no row; a literal follows */
#define MASU_PACK_STEP 31u /* as a distance: a signed literal follows */
#define MASU_PACK_BACK 4u
#define MASU_PACK_RESULTS 4096u /* results that can be addressed; a power of two */

#define MASU_PACK_SHAPE 8u /* operands with separate codings; later ones use the last one */

/* First byte of a run: number of bytes from the module's own part of the pool, then number of bytes
 * from elsewhere in the pool << 3, and MASU_PACK_JUMP if the latter do not follow the previous
 * run's. */
#define MASU_PACK_OWN 7u        /* this many, plus a literal */
#define MASU_PACK_ELSEWHERE 15u /* this many, plus a literal */
#define MASU_PACK_JUMP 128u     /* a signed literal follows: the distance of the jump */

typedef struct masu_pack_head {
    uint32_t word;                  /* count << 16 | opcode */
    uint8_t shape[MASU_PACK_SHAPE]; /* MASU_PACK_* of the operands */
} masu_pack_head;

/* The data that all modules share. */
typedef struct masu_pack {
    /* at most 255; token 255: 4 bytes (see masu_pack_head) follow, all operands are literals */
    const masu_pack_head *heads;
    uint32_t head_count;
    const uint8_t *pool, *runs;
    uint32_t pool_bytes, run_bytes;
} masu_pack;

typedef struct masu_packed {
    uint32_t run, run_bytes; /* the module's bytes in the runs of the pack */
    uint32_t own;            /* start of the module's own part of the pool */
    uint32_t words;          /* 32-bit values of the SPIR-V; 0: the library was built without it */
    masu_interface interface;
} masu_packed;

/* Writes packed->words 32-bit values. Returns 0 if the bytes are not a packed module of this size;
 * the output is then undefined. */
int masu_unpack(const masu_pack *pack, const masu_packed *packed, uint32_t *words);

#endif
