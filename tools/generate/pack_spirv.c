/* pack_spirv.c: pack_spirv FOLDER NAME...: packs FOLDER/NAME.opt.spv of every name in the format of
 * src/device/unpack.h, as a C header on stdout. Runs during the build. In a group of similar names
 * the last should be the largest: modules are packed from the last to the first. -NAME is omitted.
 *
 * First each module becomes tokens. A table of the operations that shaders use gives the ids and
 * the result of each instruction (section 3 of the SPIR-V specification); an error in it only costs
 * bytes. Then tokens become runs copied from earlier modules, found by chains of positions that
 * start with the same 8 bytes. The result is unpacked and compared before it is written. */
#include "device/unpack.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 5, HEADS = 255, LEAST = 8, TRIES = 512, HASH_BITS = 18 };

/* Bytes that a run must save if it is from elsewhere, and if it follows the last run. Runs of runs
 * cost their bytes again: keeping early modules in few pieces keeps similar modules small. Size of
 * packed.h as a list of numbers, by the first of these: 12: 5.11 MB, 14: 5.03, 16: 5.01, 18: 4.94,
 * 20: 4.95, 24: 4.97. */
enum { JUMP_SAVES = 18, NEXT_SAVES = 3 };

static void die(const char *format, ...) {
    va_list list;
    va_start(list, format);
    fputs("pack_spirv: ", stderr);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
    exit(EXIT_FAILURE);
}

typedef struct bytes {
    uint8_t *at;
    size_t count, room;
} bytes;

static void put(bytes *b, uint32_t value) {
    if (b->count == b->room) {
        b->room = b->room ? 2 * b->room : 1 << 16;
        b->at = realloc(b->at, b->room);
        if (!b->at) die("no memory");
    }
    b->at[b->count++] = (uint8_t)value;
}

static void put_literal(bytes *b, uint32_t value) {
    for (; value > 127; value >>= 7) put(b, value | 128);
    put(b, value);
}

static void put_whole(bytes *b, uint32_t value) {
    for (uint32_t shift = 0; shift < 32; shift += 8) put(b, value >> shift & 255);
}

static uint32_t code_of(uint32_t difference) {
    return difference << 1 ^ (0u - (difference >> 31));
}

/* ---- Modules --------------------------------------------------------------------------------- */

typedef struct module {
    const char *name;
    uint32_t *words;
    uint32_t count;
    masu_packed packed;
} module;

static void read_module(const char *folder, module *m) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s.opt.spv", folder, m->name);
    FILE *f = fopen(path, "rb");
    if (!f) die("%s cannot be read", path);
    fseek(f, 0, SEEK_END);
    long size = ftell(f);
    rewind(f);
    if (size < 4 * HEADER || size % 4) die("%s is not a SPIR-V module", path);
    m->count = (uint32_t)size / 4;
    m->words = malloc((size_t)size);
    if (!m->words || fread(m->words, 4, m->count, f) != m->count) die("%s cannot be read", path);
    fclose(f);
    if (m->words[0] != 0x07230203u)
        die("%s is not a SPIR-V module of this machine's byte order", path);
    for (uint32_t i = HEADER; i < m->count; i += m->words[i] >> 16)
        if (!(m->words[i] >> 16) || m->words[i] >> 16 > m->count - i)
            die("%s ends in an instruction", path);
}

/* ---- Heads ----------------------------------------------------------------------------------- */

/* Operands after the first word: t type, r result, i id, l literal, w 4 bytes; the last repeats. */
static const char *words_of(uint32_t op) {
    switch (op) {
        case 7: case 11: return "rw";
        case 10: return "w";
        case 12: return "trili";
        case 14: case 17: return "l";
        case 15: return "liwwi";
        case 16: return "il";
        case 19: case 20: case 26: case 4472: case 5341: return "r";
        case 21: case 22: return "rl";
        case 23: case 24: return "rtl";
        case 25: return "rtl";
        case 27: case 29: return "rt";
        case 28: return "rti";
        case 30: case 33: return "rt";
        case 32: return "rlt";
        case 43: case 50: return "trw";
        case 52: return "trli";
        case 54: return "trlt";
        case 59: return "trli";
        case 61: return "tril";
        case 62: case 63: return "iil";
        case 71: return "il";
        case 72: return "tl";
        case 79: case 82: return "triil";
        case 81: return "tril";
        case 86:
        case 87:
        case 88:
        case 89:
        case 90:
        case 91:
        case 92:
        case 93:
        case 94:
        case 95:
        case 98: return "triili";
        case 96: case 97: return "triiili";
        case 99:
        case 218:
        case 219:
        case 224:
        case 225:
        case 228:
        case 249:
        case 254:
        case 4473: return "i";
        case 246: return "iil";
        case 247: return "il";
        case 248: return "r";
        case 250: return "iiil";
        case 251: return "iili";
        case 56: case 252: case 253: case 255: return "l";
        default: return "tri";
    }
}

typedef struct counted {
    masu_pack_head head;
    uint32_t uses;
} counted;

static int by_use(const void *a, const void *b) {
    const counted *x = a, *y = b;
    return x->uses != y->uses ? (x->uses < y->uses) - (x->uses > y->uses)
                              : (x->head.word > y->head.word) - (x->head.word < y->head.word);
}

static masu_pack_head head_of(uint32_t word) {
    masu_pack_head h = {word, {0}};
    const char *w = words_of(word & 0xFFFF);
    for (uint32_t i = 0; i < MASU_PACK_SHAPE; i++) {
        h.shape[i] = *w == 't'   ? MASU_PACK_TYPE
                     : *w == 'r' ? MASU_PACK_RESULT
                     : *w == 'i' ? MASU_PACK_ID
                     : *w == 'w' ? MASU_PACK_WORD
                                 : MASU_PACK_LITERAL;
        if (w[1]) w++;
    }
    return h;
}

static uint32_t find_heads(const module *modules, uint32_t count, masu_pack_head *heads) {
    static counted found[4096];
    uint32_t n = 0;
    for (uint32_t m = 0; m < count; m++) {
        for (uint32_t i = HEADER; i < modules[m].count; i += modules[m].words[i] >> 16) {
            uint32_t k = 0;
            while (k < n && found[k].head.word != modules[m].words[i]) k++;
            if (k == n && n < 4096) found[n++] = (counted){head_of(modules[m].words[i]), 0};
            if (k < n) found[k].uses++;
        }
    }
    qsort(found, n, sizeof *found, by_use);
    if (n > HEADS) n = HEADS;
    for (uint32_t k = 0; k < n; k++) heads[k] = found[k].head;
    return n;
}

/* ---- Tokens ---------------------------------------------------------------------------------- */

static uint32_t literal_bytes(uint32_t value) {
    uint32_t n = 1;
    while (value >>= 7) n++;
    return n;
}

typedef struct recent {
    uint32_t ids[MASU_PACK_RECENT], used, earlier;
} recent;

typedef struct packing {
    bytes to;
    uint32_t bound, *last; /* by id: index of its last result, plus 1; 0: none */
    uint8_t *local;        /* by id: whether a function computes it */
    uint32_t rows[MASU_PACK_ROWS], result_count;
    recent types, ids;
} packing;

static void to_front(uint32_t *list, uint32_t place, uint32_t value) {
    memmove(&list[1], list, place * sizeof *list);
    list[0] = value;
}

static void put_number(packing *p, uint32_t value, int is_result) {
    uint32_t best = MASU_PACK_ROWS, cost = literal_bytes(value);
    for (uint32_t row = 0; row < MASU_PACK_ROWS; row++) {
        uint32_t by = value - p->rows[row];
        uint32_t own = by + MASU_PACK_BACK < MASU_PACK_STEP ? 0 : literal_bytes(code_of(by));
        if (own < cost) {
            cost = own;
            best = row;
        }
    }
    uint32_t by = best < MASU_PACK_ROWS ? value - p->rows[best] : 0;
    uint32_t step = by + MASU_PACK_BACK < MASU_PACK_STEP ? by + MASU_PACK_BACK : MASU_PACK_STEP;
    put(&p->to, best << 5 | step);
    if (best == MASU_PACK_ROWS) put_literal(&p->to, value);
    else if (step == MASU_PACK_STEP) put_literal(&p->to, code_of(by));
    if (!is_result) return;
    to_front(p->rows, best == MASU_PACK_ROWS ? MASU_PACK_ROWS - 1 : best, value);
    p->result_count++;
    if (value < p->bound) p->last[value] = p->result_count;
}

static void put_id(packing *p, recent *r, uint32_t id) {
    uint32_t last = id < p->bound ? p->last[id] : 0;
    uint32_t ago = last ? p->result_count - last : MASU_PACK_RESULTS;
    uint32_t place = 1;
    int near = ago < MASU_PACK_RESULTS && p->local[id];
    if (near && ago < MASU_PACK_FAR - MASU_PACK_NEAR) {
        put(&p->to, MASU_PACK_NEAR + ago);
        return;
    }
    while (place <= r->used && r->ids[place] != id) place++;
    if (place <= r->used) put(&p->to, place);
    else if (near) {
        put(&p->to, MASU_PACK_FAR);
        put_literal(&p->to, ago - (MASU_PACK_FAR - MASU_PACK_NEAR));
        return;
    } else {
        if (ago < MASU_PACK_RESULTS) {
            put(&p->to, MASU_PACK_EARLIER);
            put_literal(&p->to, code_of(last - 1 - r->earlier));
            r->earlier = last - 1;
        } else {
            put(&p->to, MASU_PACK_NUMBER);
            put_number(p, id, 0);
        }
        if (r->used < MASU_PACK_RECENT - 1) r->used++;
        place = MASU_PACK_RECENT - 1;
    }
    to_front(&r->ids[1], place - 1, id);
}

/* Ids computed in functions are close to their uses; types, constants and variables are defined
 * before. */
static void find_local(packing *p, const module *m) {
    int inside = 0;
    for (uint32_t i = HEADER; i < m->count; i += m->words[i] >> 16) {
        uint32_t op = m->words[i] & 0xFFFF, count = m->words[i] >> 16;
        masu_pack_head h = head_of(m->words[i]);
        inside |= op == 54;
        if (!inside || op == 59) continue;
        for (uint32_t k = 1; k < count && k <= MASU_PACK_SHAPE; k++)
            if (h.shape[k - 1] == MASU_PACK_RESULT && m->words[i + k] < p->bound)
                p->local[m->words[i + k]] = 1;
    }
}

static bytes tokens_of(const module *m, const masu_pack *pack) {
    static const masu_pack_head literals;
    packing p = {.bound = m->words[3]};
    p.last = calloc((size_t)p.bound + 1, sizeof *p.last);
    p.local = calloc((size_t)p.bound + 1, 1);
    if (!p.last || !p.local) die("no memory");
    find_local(&p, m);
    for (uint32_t i = 1; i < HEADER; i++) put_literal(&p.to, m->words[i]);
    for (uint32_t i = HEADER; i < m->count;) {
        uint32_t first = m->words[i], count = first >> 16, head = 0;
        while (head < pack->head_count && pack->heads[head].word != first) head++;
        const masu_pack_head *h = head < pack->head_count ? &pack->heads[head] : &literals;
        put(&p.to, head < pack->head_count ? head : HEADS);
        if (h == &literals) put_whole(&p.to, first);
        for (uint32_t k = 1; k < count; k++) {
            uint32_t word = m->words[i + k];
            switch (h->shape[k <= MASU_PACK_SHAPE ? k - 1 : MASU_PACK_SHAPE - 1]) {
                case MASU_PACK_WORD: put_whole(&p.to, word); break;
                case MASU_PACK_RESULT: put_number(&p, word, 1); break;
                case MASU_PACK_TYPE: put_id(&p, &p.types, word); break;
                case MASU_PACK_ID: put_id(&p, &p.ids, word); break;
                default: put_literal(&p.to, word);
            }
        }
        i += count;
    }
    free(p.local);
    free(p.last);
    return p.to;
}

/* ---- Runs ------------------------------------------------------------------------------------ */

/* Positions in the pool by the 8 bytes found there, the latest first. */
static uint32_t *first_place, *next_place;
static size_t places, next_room;

static uint32_t hash(const uint8_t *at) {
    uint64_t v;
    memcpy(&v, at, sizeof v);
    return (uint32_t)(v * 0x9E3779B97F4A7C15u >> (64 - HASH_BITS));
}

static void enter_places(const bytes *pool) {
    for (; places + LEAST <= pool->count; places++) {
        if (places >= next_room) {
            next_room = next_room ? 2 * next_room : 1 << 16;
            next_place = realloc(next_place, next_room * sizeof *next_place);
            if (!next_place) die("no memory");
        }
        uint32_t h = hash(pool->at + places);
        next_place[places] = first_place[h];
        first_place[h] = (uint32_t)places + 1;
    }
}

static size_t alike(const bytes *pool, size_t from, const uint8_t *at, size_t count) {
    size_t n = 0;
    while (n < count && from + n < pool->count && pool->at[from + n] == at[n]) n++;
    return n;
}

/* Bytes that a run saves: its length minus its own size. */
static int gain(size_t length, size_t from, size_t expected) {
    int cost = 1 + (length >= MASU_PACK_ELSEWHERE
                        ? (int)literal_bytes((uint32_t)length - MASU_PACK_ELSEWHERE)
                        : 0);
    if (from != expected) cost += (int)literal_bytes(code_of((uint32_t)(from - expected)));
    return (int)length - cost;
}

static int best_run(const bytes *pool, const uint8_t *at, size_t count, size_t expected,
                    size_t *from, size_t *length) {
    int best = 0;
    size_t n = expected < pool->count ? alike(pool, expected, at, count) : 0;
    if (n && gain(n, expected, expected) > best) {
        best = gain(n, expected, expected);
        *from = expected;
        *length = n;
    }
    if (count < LEAST) return best;
    int tries = TRIES;
    for (uint32_t p = first_place[hash(at)]; p && tries--; p = next_place[p - 1]) {
        /* A run saves less than its length: it must be at least this long. */
        if (best > 0 && ((size_t)best + 2 > count || p + (size_t)best >= pool->count ||
                         pool->at[p + (size_t)best] != at[best + 1]))
            continue;
        n = alike(pool, p - 1, at, count);
        if (n >= LEAST && gain(n, p - 1, expected) > best) {
            best = gain(n, p - 1, expected);
            *from = p - 1;
            *length = n;
        }
    }
    return best;
}

static void put_run(bytes *runs, size_t own, size_t length, uint32_t jump) {
    put(runs, (own < MASU_PACK_OWN ? (uint32_t)own : MASU_PACK_OWN) |
                  (length < MASU_PACK_ELSEWHERE ? (uint32_t)length : MASU_PACK_ELSEWHERE) << 3 |
                  (jump ? MASU_PACK_JUMP : 0));
    if (own >= MASU_PACK_OWN) put_literal(runs, (uint32_t)own - MASU_PACK_OWN);
    if (length >= MASU_PACK_ELSEWHERE) put_literal(runs, (uint32_t)length - MASU_PACK_ELSEWHERE);
    if (jump) put_literal(runs, code_of(jump));
}

/* Greedy with a lookahead of one byte: it waits if the next position has a run that saves more. */
static void pack_module(const bytes *tokens, bytes *pool, bytes *runs, module *m) {
    m->packed = (masu_packed){(uint32_t)runs->count, 0, (uint32_t)pool->count, m->count,
                              masu_interface_of(m->words, m->count)};
    size_t end = 0, own = 0; /* end of the last run from elsewhere; own bytes since */
    for (size_t i = 0; i < tokens->count;) {
        size_t from = 0, length = 0, later_from, later;
        int saves = best_run(pool, tokens->at + i, tokens->count - i, end + own, &from, &length);
        if (saves > 0 && i + 1 < tokens->count &&
            best_run(pool, tokens->at + i + 1, tokens->count - i - 1, end + own + 1, &later_from,
                     &later) > saves)
            saves = 0;
        if (saves < (from == end + own ? NEXT_SAVES : JUMP_SAVES)) {
            put(pool, tokens->at[i++]);
            own++;
            continue;
        }
        put_run(runs, own, length, (uint32_t)(from - end - own));
        end = from + length;
        i += length;
        own = 0;
        enter_places(pool);
    }
    if (own) put_run(runs, own, 0, 0);
    enter_places(pool);
    m->packed.run_bytes = (uint32_t)runs->count - m->packed.run;
}

/* ---- The header ------------------------------------------------------------------------------ */

/* As a string: compilers take a sixth of the time that they take for a list of numbers. "??" would
 * be read as the start of a trigraph. */
static void print_bytes(const char *name, const bytes *b) {
    printf("static const uint8_t %s[%zu] =", name, b->count + 1);
    for (size_t i = 0; i < b->count; i++) {
        uint8_t c = b->at[i];
        bool plain = c >= ' ' && c <= '~' && c != '"' && c != '\\' && c != '?';
        if (i % 64 == 0) fputs(i ? "\"\n\"" : "\n\"", stdout);
        printf(plain ? "%c" : "\\%03o", c);
    }
    printf("\";\n");
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fputs("usage: pack_spirv FOLDER NAME...\n", stderr);
        return 2;
    }
    uint32_t count = 0, largest = 0;
    module *modules = calloc((size_t)argc, sizeof *modules);
    first_place = calloc((size_t)1 << HASH_BITS, sizeof *first_place);
    static masu_pack_head heads[HEADS];
    if (!modules || !first_place) die("no memory");
    for (int i = argc; i-- > 2;) {
        if (*argv[i] == '-') continue;
        module *m = &modules[count++];
        m->name = argv[i];
        read_module(argv[1], m);
        if (m->count > largest) largest = m->count;
    }
    bytes pool = {0}, runs = {0};
    masu_pack pack = {.heads = heads, .head_count = find_heads(modules, count, heads)};
    for (uint32_t i = 0; i < count; i++) {
        bytes tokens = tokens_of(&modules[i], &pack);
        pack_module(&tokens, &pool, &runs, &modules[i]);
        free(tokens.at);
    }
    pack.pool = pool.at;
    pack.pool_bytes = (uint32_t)pool.count;
    pack.runs = runs.at;
    pack.run_bytes = (uint32_t)runs.count;
    uint32_t *words = malloc(largest * sizeof *words);
    if (!words) die("no memory");
    for (uint32_t i = 0; i < count; i++) {
        if (!masu_unpack(&pack, &modules[i].packed, words) ||
            memcmp(words, modules[i].words, 4 * (size_t)modules[i].count))
            die("%s does not come back as it was", modules[i].name);
    }
    printf("/* Made by tools/generate/pack_spirv.c: %u modules. */\n", count);
    printf("#pragma GCC diagnostic push\n"
           "#pragma GCC diagnostic ignored \"-Woverlength-strings\"\n");
    print_bytes("masu_pack_pool", &pool);
    print_bytes("masu_pack_runs", &runs);
    printf("#pragma GCC diagnostic pop\n");
    printf("static const masu_pack_head masu_pack_heads[] = {\n");
    for (uint32_t i = 0; i < pack.head_count; i++) {
        printf("{0x%08x, {", heads[i].word);
        for (uint32_t k = 0; k < MASU_PACK_SHAPE; k++) printf("%u,", heads[i].shape[k]);
        printf("}},\n");
    }
    printf("};\nstatic const masu_pack masu_pack_of_all = {masu_pack_heads, %u, masu_pack_pool, "
           "masu_pack_runs, "
           "%u, %u};\n",
           pack.head_count, pack.pool_bytes, pack.run_bytes);
    for (uint32_t i = 0; i < count; i++) {
        const masu_packed *p = &modules[i].packed;
        printf("#define MASU_PACKED_%s {%uu, %uu, %uu, %uu, {0x%xu, 0x%llxu}}\n", modules[i].name,
               p->run, p->run_bytes, p->own, p->words, p->interface.constants,
               (unsigned long long)p->interface.bindings);
    }
    for (int i = 2; i < argc; i++)
        if (*argv[i] == '-')
            printf("#define MASU_PACKED_%s {0u, 0u, 0u, 0u, {0u, 0u}}\n", argv[i] + 1);
    printf("#define MASU_PACKED_EACH(X)");
    for (uint32_t i = 0; i < count; i++) printf(" \\\n    X(%s)", modules[i].name);
    printf("\n");
    return fflush(stdout) || ferror(stdout) ? EXIT_FAILURE : EXIT_SUCCESS;
}
