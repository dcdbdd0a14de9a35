/* test_unpack.c: every shader of the library unpacks to exactly the output of spirv-opt and
 * whole_vectors. For any damage to the packed data, nothing outside the pack is read and nothing after
 * the output is written: each part ends at a page border with nothing mapped after it. */
#define _DEFAULT_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <sys/mman.h>
#include <unistd.h>

#include "device/unpack.h"
#include "support/files.h"
#include "support/random.h"

#include "packed.h"

typedef struct named {
    const char *name;
    masu_packed packed;
} named;

static const named all[] = {
#define NAMED(name) {#name, MASU_PACKED_##name},
    MASU_PACKED_EACH(NAMED)
#undef NAMED
};

enum { COUNT = sizeof all / sizeof *all };

/* ---- Memory that ends at an unmapped page ---------------------------------------------------- */

typedef struct walled {
    void *pages, *at; /* at: its last `bytes` bytes, so aligned if their number is */
    size_t mapped;
} walled;

static walled wall(size_t bytes) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE), size = (bytes + page - 1) / page * page;
    walled w = {.mapped = size + page};
    w.pages = mmap(NULL, w.mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_ptr_not_equal(w.pages, MAP_FAILED);
    assert_int_equal(mprotect((uint8_t *)w.pages + size, page, PROT_NONE), 0);
    w.at = (uint8_t *)w.pages + size - bytes;
    return w;
}

static walled wall_around(const void *bytes, size_t count) {
    walled w = wall(count);
    if (count) memcpy(w.at, bytes, count);
    return w;
}

static void tear_down(walled *w) { assert_int_equal(munmap(w->pages, w->mapped), 0); }

/* One module with a separate pack, all of which a test may change. */
typedef struct trial {
    walled heads, pool, runs, words;
    masu_pack pack;
    masu_packed packed;
} trial;

static trial begin(const masu_packed *packed) {
    trial t = {.pack = masu_pack_of_all, .packed = *packed};
    t.heads = wall_around(masu_pack_heads, sizeof masu_pack_heads);
    t.pool = wall_around(masu_pack_pool, sizeof masu_pack_pool);
    t.runs = wall_around(masu_pack_runs + packed->run, packed->run_bytes);
    t.words = wall(packed->words * sizeof(uint32_t));
    t.pack.heads = t.heads.at;
    t.pack.pool = t.pool.at;
    t.pack.runs = t.runs.at;
    t.pack.run_bytes = packed->run_bytes;
    t.packed.run = 0;
    return t;
}

static int unpack(const trial *t) { return masu_unpack(&t->pack, &t->packed, t->words.at); }

static void end(trial *t) {
    tear_down(&t->heads);
    tear_down(&t->pool);
    tear_down(&t->runs);
    tear_down(&t->words);
}

static const masu_packed *find(const char *name) {
    for (uint32_t i = 0; i < COUNT; i++)
        if (!strcmp(all[i].name, name)) return &all[i].packed;
    fail_msg("there is no shader %s", name);
    return NULL;
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void every_shader_comes_back_to_the_byte(void **state) {
    (void)state;
    assert_true(COUNT > 150);
    for (uint32_t i = 0; i < COUNT; i++) {
        char path[512];
        size_t bytes;
        snprintf(path, sizeof path, "%s/gen/%s.opt.spv", made_dir(), all[i].name);
        uint32_t *words = read_file(path, &bytes);
        trial t = begin(&all[i].packed);
        if (bytes != all[i].packed.words * sizeof *words || !unpack(&t) ||
            memcmp(words, t.words.at, bytes))
            fail_msg("%s differs from %s", all[i].name, path);
        end(&t);
        free(words);
    }
}

static void they_take_a_tenth(void **state) {
    (void)state;
    uint64_t bytes = 0,
             packed = sizeof masu_pack_pool + sizeof masu_pack_runs + sizeof masu_pack_heads;
    for (uint32_t i = 0; i < COUNT; i++) bytes += all[i].packed.words * sizeof(uint32_t);
    print_message("%llu bytes in %llu\n", (unsigned long long)bytes, (unsigned long long)packed);
    assert_true(packed * 10 < bytes);
}

static void fewer_runs_are_refused(void **state) {
    (void)state;
    const masu_packed *packed = find("light_occluded_comp");
    trial t = begin(packed);
    assert_true(unpack(&t));
    for (uint32_t n = 0; n < packed->run_bytes; n++) {
        walled fewer = wall_around(t.runs.at, n);
        t.pack.runs = fewer.at;
        t.pack.run_bytes = t.packed.run_bytes = n;
        assert_false(unpack(&t));
        tear_down(&fewer);
    }
    end(&t);
}

static void a_smaller_pool_is_refused(void **state) {
    (void)state;
    trial t = begin(&all[0].packed); /* the first of the pool */
    for (uint32_t n = 0; n < 200; n++) {
        walled smaller = wall_around(masu_pack_pool, n);
        t.pack.pool = smaller.at;
        t.pack.pool_bytes = n;
        assert_false(unpack(&t));
        tear_down(&smaller);
    }
    end(&t);
}

static void other_sizes_are_refused(void **state) {
    (void)state;
    trial t = begin(find("light_occluded_comp"));
    uint32_t words = t.packed.words;
    for (uint32_t n = 0; n < words; n += n < 100 ? 1 : 97) {
        walled fewer = wall(n * sizeof(uint32_t)), whole = t.words;
        t.packed.words = n;
        t.words = fewer;
        /* At the end of an instruction the only error is that more was expected. */
        if (n < 5) assert_false(unpack(&t));
        else (void)unpack(&t);
        t.words = whole;
        tear_down(&fewer);
    }
    walled more = wall((words + 1) * sizeof(uint32_t)), whole = t.words;
    t.words = more;
    t.packed.words = words + 1;
    assert_false(unpack(&t));
    t.packed.words = words;
    t.words = whole;
    tear_down(&more);

    t.packed.run = 1; /* and the same number of bytes from there */
    assert_false(unpack(&t));
    t.packed.run = UINT32_MAX;
    assert_false(unpack(&t));
    t.packed.run = 0;
    t.packed.own = UINT32_MAX;
    assert_false(unpack(&t));
    end(&t);
}

/* For any output, it returns, within the memory. */
static void changed_bytes_stay_inside(void **state) {
    (void)state;
    uint64_t random = 1;
    uint32_t refused = 0, rounds = trials(200000, 20000, 2000);
    trial t = begin(find("light_occluded_comp"));
    trial small = begin(find("cascade_frag"));
    for (uint32_t i = 0; i < rounds; i++) {
        trial *of = i % 8 ? &small : &t;
        struct {
            uint8_t *at, was;
        } changed[4];
        uint32_t count = 1 + i % 4;
        for (uint32_t k = 0; k < count; k++) {
            uint64_t where = support_random_in(&random, 0, 3);
            uint8_t *at = of->runs.at;
            uint64_t room = of->pack.run_bytes;
            if (where == 1) at = (uint8_t *)of->pool.at + of->packed.own, room = 200;
            if (where == 2) at = of->heads.at, room = sizeof masu_pack_heads;
            changed[k].at = at + support_random_in(&random, 0, room - 1);
            changed[k].was = *changed[k].at;
            *changed[k].at = (uint8_t)support_random(&random);
        }
        refused += !unpack(of);
        for (uint32_t k = count; k-- > 0;) *changed[k].at = changed[k].was;
    }
    print_message("%u of %u are rejected\n", refused, rounds);
    assert_true(refused > rounds / 8);
    assert_true(unpack(&t) && unpack(&small));
    end(&t);
    end(&small);
}

static void noise_stays_inside(void **state) {
    (void)state;
    uint64_t random = 2;
    trial t = begin(find("cascade_frag"));
    for (uint32_t i = 0; i < 20000; i++) {
        uint8_t *runs = t.runs.at;
        for (uint32_t k = 0; k < t.pack.run_bytes; k++) runs[k] = (uint8_t)support_random(&random);
        t.packed.own = (uint32_t)support_random_in(&random, 0, t.pack.pool_bytes);
        (void)unpack(&t);
    }
    end(&t);
}

/* The interface that a module declares; truncated modules are not read beyond their end. */
static void declarations_are_read(void **state) {
    (void)state;
    enum { DECORATE = 4 << 16 | 71, SPEC_ID = 1, BINDING = 33, SET = 34, TYPE_VOID = 2 << 16 | 19 };
    static const uint32_t module[] = {
        0x07230203u, 0x10300u, 0, 20,      0,  DECORATE, 3, SPEC_ID, 7, DECORATE,  4,  SPEC_ID,
        31,          DECORATE, 5, SPEC_ID, 32, DECORATE, 6, BINDING, 5, DECORATE,  6,  SET,
        0,           DECORATE, 7, SET,     1,  DECORATE, 7, BINDING, 9, DECORATE,  8,  SET,
        0,           DECORATE, 8, BINDING, 63, DECORATE, 9, BINDING, 2, TYPE_VOID, 10, DECORATE,
        11,          SPEC_ID,  3};
    enum { WORDS = sizeof module / sizeof *module };
    masu_interface is = masu_interface_of(module, WORDS);
    assert_int_equal(is.constants, 1u << 7 | 1u << 31);
    assert_true(is.bindings == (1ull << 5 | 1ull << 63));
    for (uint32_t n = 0; n <= WORDS; n++) {
        walled part = wall_around(module, n * sizeof *module);
        masu_interface less = masu_interface_of(part.at, n);
        assert_int_equal(less.constants & ~is.constants, 0);
        tear_down(&part);
    }
    const uint32_t bad[] = {0, 0, 0, 0, 0, 0xFFFF0047u, 1, 1, 1}, none[] = {0, 0, 0, 0, 0, 0, 1};
    assert_int_equal(masu_interface_of(bad, 9).constants, 0);
    assert_int_equal(masu_interface_of(none, 7).constants, 0);
    /* The build has recorded it for every shader: the tone curve is a constant of this one,
     * reflections are not. */
    assert_int_equal(find("tonemap_comp")->interface.constants >> 4 & 3, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(declarations_are_read),
        cmocka_unit_test(every_shader_comes_back_to_the_byte),
        cmocka_unit_test(they_take_a_tenth),
        cmocka_unit_test(fewer_runs_are_refused),
        cmocka_unit_test(a_smaller_pool_is_refused),
        cmocka_unit_test(other_sizes_are_refused),
        cmocka_unit_test(changed_bytes_stay_inside),
        cmocka_unit_test(noise_stays_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
