/* test_whole_vectors.c: components of vectors in buffers are read by a load of the whole vector if
 * several are needed; a single component is still read by itself, and stores are unchanged. No
 * shader of the library or of baked scenes has anything left to change. */
#define _XOPEN_SOURCE 700
#include <glob.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/scene.h"
#include "spirv/whole_vectors.h"
#include "support/files.h"
#include "support/spirv.h"

#include "image.h"

/* EXTENSION: words of the instruction that lets SPIR-V 1.0 have storage buffers. */
enum { EXTENSION = 11 };
enum { LOADS_OF_FLOATS, LOADS_OF_VECTORS, EXTRACTS, LOADS_MOST };

static void count(const spirv_module *m, uint32_t counts[LOADS_MOST]) {
    memset(counts, 0, LOADS_MOST * sizeof *counts);
    for (size_t k = 0; k < m->count; k++) {
        const spirv_instruction *i = &m->list[k];
        if (i->op == SPIRV_LOAD && m->def[i->word[1]]->op == SPIRV_TYPE_FLOAT)
            counts[LOADS_OF_FLOATS]++;
        if (i->op == SPIRV_LOAD && m->def[i->word[1]]->op == SPIRV_TYPE_VECTOR)
            counts[LOADS_OF_VECTORS]++;
        counts[EXTRACTS] += i->op == 81 || i->op == 77;
    }
}

/* Compiles the body with glslang and spirv-opt, and transforms it; spirv-val accepts the result. */
static void check(const char *body, uint32_t floats, uint32_t vectors) {
    static char text[2048];
    spirv_module before, after;
    uint32_t counts[LOADS_MOST];
    size_t words;
    snprintf(
        text, sizeof text,
        "#version 440\nlayout(local_size_x = 1) in;\nstruct row { vec4 a; vec3 b; float c; mat2x4 "
        "m; };\n"
        "layout(std140, set = 0, binding = 0) uniform U { vec4 u; vec4 list[8]; row one; } u;\n"
        "layout(std430, set = 0, binding = 1) buffer S { float x; row rows[]; } s;\n"
        "layout(std430, set = 0, binding = 2) buffer V { vec4 v[]; };\n"
        "layout(std430, set = 0, binding = 3) buffer C { uint counter; };\n"
        "layout(push_constant) uniform P { uint n; vec2 p; };\nvoid main() {\n%s\n}\n",
        body);
    write_text("w.comp", text);
    assert_int_equal(
        shell(
            "glslangValidator --quiet -V --target-env vulkan1.1 -o %s/w.spv %s/w.comp && spirv-opt "
            "--target-env=vulkan1.1 -O --strip-debug %s/w.spv -o %s/w.spv",
            scratch, scratch, scratch, scratch),
        0);
    assert_true(spirv_from_file(in_scratch("w.spv"), &before));
    uint32_t *changed = masu_whole_vectors(before.words, before.word_count, &words);
    assert_non_null(changed);
    write_bytes("c.spv", changed, words * sizeof *changed);
    assert_int_equal(shell("spirv-val --target-env vulkan1.0 %s/c.spv", scratch), 0);
    assert_true(spirv_from_words(changed, words, &after));
    count(&after, counts);
    if (counts[LOADS_OF_FLOATS] != floats || counts[LOADS_OF_VECTORS] != vectors)
        fail_msg("%u loads of floats, %u of vectors instead of %u, %u:\n%s",
                 counts[LOADS_OF_FLOATS], counts[LOADS_OF_VECTORS], floats, vectors, body);
    free(changed);
    spirv_free(&after);
    spirv_free(&before);
}

static void components_beside_others_come_whole(void **state) {
    (void)state;
    check("s.x = u.u.w + u.u.x;", 0, 2);
    check("s.x = u.u.w + dot(u.u, u.u);", 0, 2);
    check("s.x = u.list[n].w + u.list[n].x;", 0, 2);
    check("s.x = s.rows[n].b.z + s.rows[n].b.x;", 0, 2);
    check("s.x = s.rows[n].m[1].z + s.rows[n].m[0].x;", 0, 2);
    check("s.x = v[n][n & 3u];", 0, 1); /* the index is computed at run time */
    check("s.x = v[n][atomicAdd(counter, 1u)];", 0, 1);
    check("s.x = p.x + p.y;", 0, 2);
    check("row r = s.rows[n]; v[0] = r.a; v[1] = r.m[0]; s.x = s.rows[2].a.y;", 0, 1);
}

static void a_component_alone_stays_alone(void **state) {
    (void)state;
    check("s.x = u.u.w + s.rows[n].c;", 2, 0);
    check("s.x = u.u.w * u.one.a.x + u.one.b.x;", 3, 0);
    check("v[n] = u.u;", 0, 1);
}

static void stores_stay_as_they_are(void **state) {
    (void)state;
    check("v[n].x = 1.0; v[n].y = 2.0;", 0, 0);
    check("vec4 all = v[1]; v[n].x += all.y;", 0, 2); /* one chain for the load and the store */
    check("v[n].y += v[n].x;", 0, 2);
    check("v[n].y += 1.0;", 1, 0);
}

static void what_is_no_module_is_refused(void **state) {
    (void)state;
    static const uint32_t words[] = {0x07230203, 0x10300, 0, 10, 0, 0};
    size_t changed;
    assert_null(masu_whole_vectors(words, 0, &changed));
    assert_null(masu_whole_vectors(words + 1, 5, &changed));
    assert_null(masu_whole_vectors(words, 6, &changed)); /* an instruction of length 0 */
}

/* A module that no tool makes: a changed chain has a second copy before all functions, at which
 * point no pointer type is declared (found by fuzz-spirv). It is unchanged. */
static void a_chain_before_all_functions_stays(void **state) {
    (void)state;
    check("s.x = u.u.w + u.u.x;", 0, 2); /* writes w.spv */
    spirv_module m;
    assert_true(spirv_from_file(in_scratch("w.spv"), &m));
    const spirv_instruction *chain = NULL;
    size_t first = 0, changed = 0;
    for (size_t k = m.count; k-- > 0;) {
        if (m.list[k].op == SPIRV_ACCESS_CHAIN) chain = &m.list[k];
        if (m.list[k].op == SPIRV_FUNCTION) first = (size_t)(m.list[k].word - m.words);
    }
    assert_non_null(chain);
    uint32_t *words = malloc((m.word_count + chain->count) * sizeof *words);
    assert_non_null(words);
    memcpy(words, m.words, first * sizeof *words);
    memcpy(words + first, chain->word, chain->count * sizeof *words);
    memcpy(words + first + chain->count, m.words + first, (m.word_count - first) * sizeof *words);
    uint32_t *out = masu_whole_vectors(words, m.word_count + chain->count, &changed);
    assert_non_null(out);
    assert_memory_equal(out + first + EXTENSION, chain->word, chain->count * sizeof *words);
    free(out);
    free(words);
    spirv_free(&m);
}

static void assert_done(const char *name, const uint32_t *words, size_t bytes) {
    size_t changed;
    uint32_t *again = masu_whole_vectors(words, bytes / 4, &changed);
    assert_non_null(again);
    if (changed != bytes / 4 || memcmp(again, words, bytes))
        fail_msg("%s: has components left to load whole", name);
    free(again);
}

static void shaders_of_the_tree_have_none_left(void **state) {
    (void)state;
    char pattern[512];
    glob_t found;
    uint32_t shaders = 0;
    snprintf(pattern, sizeof pattern, "%s/gen/*.opt.spv", made_dir());
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    for (size_t k = 0; k < found.gl_pathc; k++, shaders++) {
        size_t bytes;
        uint32_t *words = read_file(found.gl_pathv[k], &bytes);
        assert_done(found.gl_pathv[k], words, bytes);
        free(words);
    }
    globfree(&found);
    snprintf(pattern, sizeof pattern, "%s/scenes/*.masu", made_dir());
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    for (size_t k = 0; k < found.gl_pathc; k++) {
        masu_scene scene;
        size_t bytes;
        void *blob = read_file(found.gl_pathv[k], &bytes);
        assert_int_equal(masu_scene_bind(blob, bytes, &scene, NULL), MASU_OK);
        masu_scene_view view = masu_scene_view_of(&scene);
        for (uint32_t kind = 0; kind < MASU_BLOB_KIND_COUNT; kind++) {
            if (!view.code[kind].words) continue;
            assert_done(found.gl_pathv[k], view.code[kind].words,
                        4 * (size_t)view.code[kind].count);
            shaders++;
        }
        free(blob);
    }
    globfree(&found);
    assert_true(shaders > 200);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(components_beside_others_come_whole),
        cmocka_unit_test(a_component_alone_stays_alone),
        cmocka_unit_test(stores_stay_as_they_are),
        cmocka_unit_test(what_is_no_module_is_refused),
        cmocka_unit_test(a_chain_before_all_functions_stays),
        cmocka_unit_test(shaders_of_the_tree_have_none_left),
    };
    return cmocka_run_group_tests_name("whole_vectors", tests, make_scratch, remove_scratch);
}
