/* unpack.c: see unpack.h. */
#include "device/unpack.h"

#include <string.h>

#define MAGIC 0x07230203u
#define HEADER 5u

/* Recently used ids, latest first, from index 1 on; index 0 is unused. */
typedef struct recent {
    uint32_t ids[MASU_PACK_RECENT];
    uint32_t earlier; /* index of the last result that was coded by MASU_PACK_EARLIER */
} recent;

typedef struct unpacking {
    const masu_pack *pack;
    const uint8_t *run, *run_end;
    uint32_t own;  /* next byte of the module's own part of the pool */
    uint32_t from; /* next byte of the rest of the pool */
    uint32_t own_left, left;
    int failed;
    uint32_t rows[MASU_PACK_ROWS]; /* last result of each row, latest row first */
    uint32_t result_count;
    uint32_t results[MASU_PACK_RESULTS]; /* by result index modulo MASU_PACK_RESULTS */
    recent types, ids;
} unpacking;

/* ---- Bytes ----------------------------------------------------------------------------------- */

static uint32_t run_byte(unpacking *u) {
    if (u->run == u->run_end) {
        u->failed = 1;
        return 0;
    }
    return *u->run++;
}

static uint32_t literal_of(unpacking *u, uint32_t (*next)(unpacking *)) {
    uint32_t value = 0;
    for (uint32_t shift = 0; shift < 35; shift += 7) {
        uint32_t b = next(u);
        value |= (b & 127) << shift;
        if (b < 128) return value;
    }
    u->failed = 1;
    return 0;
}

static uint32_t run_literal(unpacking *u) { return literal_of(u, run_byte); }

static uint32_t signed_of(uint32_t code) { return code >> 1 ^ (0u - (code & 1)); }

/* Reads the next run that is not empty. Offsets wrap around; pool_byte checks the range. */
static void next_run(unpacking *u) {
    uint32_t b = run_byte(u);
    u->own_left = b & MASU_PACK_OWN;
    u->left = b >> 3 & MASU_PACK_ELSEWHERE;
    if (u->own_left == MASU_PACK_OWN) u->own_left += run_literal(u);
    if (u->left == MASU_PACK_ELSEWHERE) u->left += run_literal(u);
    u->from += u->own_left;
    if (b & MASU_PACK_JUMP) u->from += signed_of(run_literal(u));
    if (!u->own_left && !u->left) u->failed = 1;
}

static uint32_t pool_byte(unpacking *u) {
    if (!u->own_left && !u->left) next_run(u);
    uint32_t at = u->own_left ? u->own : u->from;
    if (u->failed || at >= u->pack->pool_bytes) {
        u->failed = 1;
        return 0;
    }
    if (u->own_left) {
        u->own_left--;
        u->own++;
    } else {
        u->left--;
        u->from++;
    }
    return u->pack->pool[at];
}

/* ---- Instructions ---------------------------------------------------------------------------- */

static uint32_t literal(unpacking *u) { return literal_of(u, pool_byte); }

static uint32_t whole(unpacking *u) {
    uint32_t value = 0;
    for (uint32_t shift = 0; shift < 32; shift += 8) value |= pool_byte(u) << shift;
    return value;
}

static void to_front(uint32_t *list, uint32_t place, uint32_t value) {
    memmove(&list[1], list, place * sizeof *list);
    list[0] = value;
}

static uint32_t number(unpacking *u, int is_result) {
    uint32_t b = pool_byte(u), row = b >> 5, step = b & MASU_PACK_STEP, value;
    if (row == MASU_PACK_ROWS) value = literal(u);
    else if (step == MASU_PACK_STEP) value = u->rows[row] + signed_of(literal(u));
    else value = u->rows[row] + step - MASU_PACK_BACK;
    if (!is_result) return value;
    to_front(u->rows, row == MASU_PACK_ROWS ? MASU_PACK_ROWS - 1 : row, value);
    u->results[u->result_count++ % MASU_PACK_RESULTS] = value;
    return value;
}

/* The result with index `which`, counted from the first result of the module. */
static uint32_t result(unpacking *u, uint32_t which) {
    uint32_t ago = u->result_count - which;
    if (!ago || ago > u->result_count || ago > MASU_PACK_RESULTS) u->failed = 1;
    return u->results[which % MASU_PACK_RESULTS];
}

static uint32_t id(unpacking *u, recent *r) {
    uint32_t b = pool_byte(u), value, place = b;
    if (b == MASU_PACK_FAR)
        return result(u, u->result_count - 1 - (b - MASU_PACK_NEAR) - literal(u));
    if (b >= MASU_PACK_NEAR && b < MASU_PACK_FAR)
        return result(u, u->result_count - 1 - (b - MASU_PACK_NEAR));
    if (b == MASU_PACK_NUMBER) {
        value = number(u, 0);
        place = MASU_PACK_RECENT - 1;
    } else if (b == MASU_PACK_EARLIER) {
        r->earlier += signed_of(literal(u));
        value = result(u, r->earlier);
        place = MASU_PACK_RECENT - 1;
    } else value = r->ids[place];
    to_front(&r->ids[1], place - 1, value);
    return value;
}

static uint32_t word(unpacking *u, uint32_t coding) {
    switch (coding) {
        case MASU_PACK_LITERAL: return literal(u);
        case MASU_PACK_WORD: return whole(u);
        case MASU_PACK_RESULT: return number(u, 1);
        case MASU_PACK_TYPE: return id(u, &u->types);
        case MASU_PACK_ID: return id(u, &u->ids);
        default: u->failed = 1; return 0;
    }
}

int masu_unpack(const masu_pack *pack, const masu_packed *packed, uint32_t *words) {
    static const uint8_t literals[MASU_PACK_SHAPE]; /* 0: all MASU_PACK_LITERAL */
    unpacking u = {.pack = pack, .own = packed->own};
    if (packed->words < HEADER || packed->run > pack->run_bytes ||
        packed->run_bytes > pack->run_bytes - packed->run)
        return 0;
    u.run = pack->runs + packed->run;
    u.run_end = u.run + packed->run_bytes;
    words[0] = MAGIC;
    for (uint32_t i = 1; i < HEADER; i++) words[i] = literal(&u);
    for (uint32_t i = HEADER; i < packed->words && !u.failed;) {
        uint32_t head = pool_byte(&u);
        int known = head < pack->head_count;
        uint32_t first = known ? pack->heads[head].word : whole(&u), count = first >> 16;
        const uint8_t *shape = known ? pack->heads[head].shape : literals;
        if (u.failed || !count || count > packed->words - i) return 0;
        words[i++] = first;
        for (uint32_t k = 1; k < count && !u.failed; k++)
            words[i++] = word(&u, shape[k <= MASU_PACK_SHAPE ? k - 1 : MASU_PACK_SHAPE - 1]);
    }
    return !u.failed;
}
