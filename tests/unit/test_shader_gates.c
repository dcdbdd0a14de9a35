/* test_shader_gates.c: rules for all shaders, checked in the SPIR-V: loops are bounded by constants
 * (tests/support/loops.h), and at most three descriptor sets are used, of the four that every
 * device has: GPU-assisted validation needs the fourth.
 *
 * Checked are the library's shaders as glslang compiles them, and shaders compiled together with a
 * scene's field, both with the fields of scenes/ before the optimiser and from the baked blobs.
 * Small shaders compiled here show that the checks can fail. */
#define _XOPEN_SOURCE 700
#include <glob.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "image.h"
#include "scene/scene.h"
#include "support/files.h"
#include "support/loops.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define SETS_MOST 3u

/* Paths that match a pattern below $MADE, or below the root of the tree; at least one. */
static glob_t find(const char *root, const char *pattern) {
    char path[512];
    glob_t found;
    (void)snprintf(path, sizeof path, "%s/%s", root, pattern);
    if (glob(path, 0, NULL, &found)) fail_msg("there is no %s", path);
    return found;
}

/* ---- The checks ------------------------------------------------------------------------------ */

static uint32_t descriptor_sets(const spirv_module *m) {
    uint32_t sets = 0;
    for (size_t k = 0; k < m->count; k++) {
        const spirv_instruction *i = &m->list[k];
        if (i->op != SPIRV_DECORATE || i->word[2] != SPIRV_DECORATION_DESCRIPTOR_SET) continue;
        if (i->word[3] >= sets) sets = i->word[3] + 1;
    }
    return sets;
}

static uint32_t assert_passes(const spirv_module *m, const char *name) {
    uint32_t loops = 0, sets = descriptor_sets(m);
    const char *function = spirv_unbounded_loop(m, &loops);
    if (function) fail_msg("%s: a loop in %s has no constant bound", name, function);
    if (sets > SETS_MOST) fail_msg("%s: uses %u descriptor sets", name, sets);
    return loops;
}

/* ---- Self-tests ------------------------------------------------------------------------------ */

#define SHADER(declarations, body)                                                                 \
    "#version 440\n"                                                                               \
    "layout(local_size_x = 1) in;\n"                                                               \
    "layout(set = 0, binding = 0) buffer B { int n; uint u; float x; };\n" declarations            \
    "void main() {\n" body "}\n"

static void compile(const char *text, spirv_module *m) {
    const char *path = write_text("test.comp", text);
    if (!spirv_compile(path, "", m)) fail_msg("does not compile: %s", text);
    assert_int_equal(remove(path), 0);
}

static void assert_loops(const char *text, int bounded) {
    spirv_module m;
    uint32_t loops = 0;
    compile(text, &m);
    const char *function = spirv_unbounded_loop(&m, &loops);
    if (!loops) fail_msg("no loop was found in:\n%s", text);
    if (bounded && function) fail_msg("called unbounded:\n%s", text);
    if (!bounded && !function) fail_msg("called bounded:\n%s", text);
    spirv_free(&m);
}

#define BOUNDED(body) assert_loops(SHADER("", body), 1)
#define UNBOUNDED(body) assert_loops(SHADER("", body), 0)

static void a_loop_that_counts_to_a_constant_is_bounded(void **state) {
    (void)state;
    BOUNDED("for (int i = 0; i < 8; i++) x += 1.0;");
    BOUNDED("for (int i = 0; i <= 8; i += 2) x += 1.0;");
    BOUNDED("for (uint i = 0u; 8u > i; ++i) x += 1.0;");
    BOUNDED("for (int i = 7; i >= 0; i--) x += 1.0;");
    BOUNDED("for (uint i = 7u; i > 0u; i--) x += 1.0;");
    BOUNDED("int i = 0; while (!(i >= 8)) { x += 1.0; i = 1 + i; }");
    BOUNDED("int i = 0; do { x += 1.0; i++; } while (i < 8);");
    BOUNDED("for (int i = 0; i + 3 < 8; i++) x += 1.0;");
}

static void a_bounded_loop_may_end_earlier(void **state) {
    (void)state;
    BOUNDED("for (int i = 0; i < 8; i++) { x *= 0.5; if (x < 1.0) break; }");
    BOUNDED("for (int i = 0; i < 8; i++) { if (x < 1.0) continue; x *= 0.5; }");
    BOUNDED("for (int i = 0; i < 8; i++) { x *= 0.5; if (x < 1.0) return; }");
    BOUNDED("for (int i = 0; i < 8 && x > 1.0; i++) x *= 0.5;");
    BOUNDED("for (int i = 0; x > 1.0 && i < 8; i++) x *= 0.5;");
    BOUNDED("for (int i = 0; i < 8 && n / (i + n) > 1; i++) n--;");
    BOUNDED("for (int i = 0; n / (n - 1) > 1 && i < 8; i++) n--;");
    BOUNDED("int i = 0; while (true) { if (i >= 8 || x < 1.0) break; x *= 0.5; i++; }");
    BOUNDED("for (int i = 0;; i++) { if (x < 1.0) break; if (i >= 8) break; x *= 0.5; }");
}

static void loops_inside_loops_are_bounded_each(void **state) {
    (void)state;
    BOUNDED("for (int i = 0; i < 8; i++) for (int j = 0; j < 4; j++) x += float(i * j);");
    UNBOUNDED("for (int i = 0; i < 8; i++) for (int j = 0; j < n; j++) x += float(i * j);");
    UNBOUNDED("for (int i = 0; i < n; i++) for (int j = 0; j < 8; j++) x += float(i * j);");
    UNBOUNDED("for (int i = 0; i < 8; i++) for (int j = 0; j < 4; i++) x += float(i * j);");
}

static void a_loop_that_its_data_ends_is_unbounded(void **state) {
    (void)state;
    UNBOUNDED("while (x > 1.0) x *= 0.5;");
    UNBOUNDED("for (int i = 0; i < n; i++) x += 1.0;");
    UNBOUNDED("for (int i = n; i < 8; i++) x += 1.0;");
    UNBOUNDED("for (int i = 0; i < 8; i += n) x += 1.0;");
    UNBOUNDED("for (int i = 0; i < 8 || x > 1.0; i++) x *= 0.5;");
    UNBOUNDED("for (int i = 0; i < 8 || n / (n - 1) > 1; i++) n--;");
    UNBOUNDED("int i = 0; while (true) { if (i >= 8 && x < 1.0) break; x *= 0.5; i++; }");
    UNBOUNDED("for (float f = 0.0; f < 8.0; f += x) u++;");
    UNBOUNDED("for (float f = 0.0; f < 1e9; f += 1.0) u++;");
}

static void a_counter_that_is_tampered_with_counts_nothing(void **state) {
    (void)state;
    UNBOUNDED("for (int i = 0; i < 8; i++) if (x > 1.0) i = 0;");
    UNBOUNDED("for (int i = 0; i < 8; i++) if (x > 1.0) i -= 1;");
    UNBOUNDED("for (int i = 0; i < 8; ) if (x > 1.0) i++;");
    UNBOUNDED("for (int i = 0; i < 8; i += 0) x += 1.0;");
    UNBOUNDED("for (int i = 0; i < 8; i--) x += 1.0;");
    UNBOUNDED("int k = 0; for (int i = 0; i < 8; k++) x += 1.0; n = k;");
    UNBOUNDED("int k = 0; for (int i = 0; i < 8; i = k + 1) x += 1.0;");
    assert_loops(SHADER("void spoil(inout int i) { if (x > 1.0) i = 0; }\n",
                        "for (int i = 0; i < 8; i++) spoil(i);"),
                 0);
}

static void a_bound_that_is_no_bound_is_none(void **state) {
    (void)state;
    UNBOUNDED("for (int i = 0; i < 1000000; i++) x += 1.0;");
    UNBOUNDED("for (int i = 0; i <= 0x7FFFFFFF; i++) x += 1.0;");
    UNBOUNDED("for (uint i = 8u; i >= 0u; i--) x += 1.0;");
    UNBOUNDED("for (uint i = 5u; i > 0u; i -= 2u) x += 1.0;");
    UNBOUNDED("for (int i = 0x7FFFFFF0; i < 0x7FFFFFFA; i += 10) x += 1.0;");
    UNBOUNDED("int i = 0; while (true) { if (x > 2.0) { i++; continue; } if (i >= 8) break; }");
    BOUNDED("for (int i = 0; i < 4096; i++) x += 1.0;");
}

static void an_unbounded_loop_is_named_by_its_function(void **state) {
    (void)state;
    spirv_module m;
    uint32_t loops = 0;
    compile(SHADER("float spin(float f) { while (f > 1.0) f *= 0.5; return f; }\n",
                   "for (int i = 0; i < 8; i++) x += spin(x);"),
            &m);
    const char *function = spirv_unbounded_loop(&m, &loops);
    assert_non_null(function);
    assert_memory_equal(function, "spin(", 5);
    spirv_free(&m);
}

static void a_fourth_descriptor_set_is_noticed(void **state) {
    (void)state;
    spirv_module m;
    compile(SHADER("layout(set = 2, binding = 0) buffer C { int c; };\n", "c = n;"), &m);
    assert_int_equal(descriptor_sets(&m), 3);
    spirv_free(&m);
    compile(SHADER("layout(set = 3, binding = 0) buffer C { int c; };\n", "c = n;"), &m);
    assert_int_equal(descriptor_sets(&m), 4);
    spirv_free(&m);
}

/* ---- The shaders ----------------------------------------------------------------------------- */

/* Shaders that need a field, as masu-bake compiles them, and the minimum number of loops in
 * each. */
static const struct {
    const char *source, *define;
    int sides;      /* 2: it differs with and without a raster depth */
    int dynamic;    /* it needs changing slots, which a hand-written field does not have */
    uint32_t loops; /* apart from the field's */
} scene_shaders[] = {
    {"update.comp", "-DMASU_PASS=1", 1, 1, 0},
    {"update.comp", "-DMASU_MOTION=1", 1, 1, 0},
    {"sdf_velocity.comp", "-DMASU_PASS=1", 2, 0, 2},
    {"silhouettes.comp", "-DMASU_PASS=1", 2, 0,
     6}, /* sides, rays and their march, the normal, reference pixels, light */
    {"classify.comp", "-DMASU_PASS=1", 2, 0, 1},
    {"cone.comp", "-DMASU_CONE_BLOCK=8", 1, 0, 1},
    {"cone.comp", "-DMASU_CONE_BLOCK=2", 1, 0, 1},
    {"march.comp", "-DMASU_PASS=1", 1, 0, 3}, /* the march, its refinement, the normal */
    {"march_plain.comp", "-DMASU_LAB=1", 2, 0, 3},
    {"march_seed.comp", "-DMASU_LAB=1", 2, 0, 3},
    {"march_checkerboard.comp", "-DMASU_LAB=1", 1, 0, 3},
    {"sdf_occlusion.comp", "-DMASU_PASS=1", 1, 0, 6}, /* lists 3, rays and their march, samples */
    /* 2 for the list, 2 for leaving and the march, and the bounds */
    {"local_shadow_sdf.comp", "-DMASU_PASS=1", 1, 0, 4},
    {"specular_trace_sdf.comp", "-DMASU_PASS=1", 1, 0, 2}, /* the march, the normal */
    {"specular_trace_sdf.comp", "-DMASU_MOTION=1", 1, 0, 3},
    {"bounce_sdf.comp", "-DMASU_PASS=1", 1, 0, 2},
};

static int needs_a_field(const char *name) {
    for (size_t i = 0; i < COUNT(scene_shaders); i++) {
        if (!strcmp(scene_shaders[i].source, name)) return 1;
    }
    return 0;
}

static void every_shader_of_the_library_passes(void **state) {
    (void)state;
    glob_t sources = find("shaders", "*.????");
    uint32_t loops = 0, modules = 0;
    for (size_t i = 0; i < sources.gl_pathc; i++) {
        const char *name = sources.gl_pathv[i] + strlen("shaders/");
        size_t stem = strcspn(name, ".");
        char path[512];
        (void)snprintf(path, sizeof path, "%s/gen/%.*s_%s.spv", made_dir(), (int)stem, name,
                       name + stem + 1);
        spirv_module m;
        if (needs_a_field(name)) continue; /* see below */
        if (!spirv_from_file(path, &m)) fail_msg("%s is missing or no SPIR-V", path);
        loops += assert_passes(&m, name);
        spirv_free(&m);
        modules++;
    }
    /* and shaders that are compiled a second time with a macro */
    static const char *const second[] = {"gbuffer_velocity_vert", "gbuffer_velocity_frag",
                                         "light_occluded_comp"};
    for (size_t i = 0; i < COUNT(second); i++) {
        spirv_module m;
        char path[512];
        (void)snprintf(path, sizeof path, "%s/gen/%s.spv", made_dir(), second[i]);
        if (!spirv_from_file(path, &m)) fail_msg("%s is missing or no SPIR-V", path);
        loops += assert_passes(&m, second[i]);
        spirv_free(&m);
    }
    printf("%u loops in %u modules\n", loops, modules);
    assert_true(modules >= 6);
    globfree(&sources);
}

/* sdf_scene.glsl as masu-bake writes it: a number for each parameter, the field, and the
 * definitions that masu-sdfc adds. The values do not matter here. */
static const char *write_field(const char *field) {
    static char text[1 << 16];
    char name[128];
    size_t at = 0, length;
    char *source = read_file(field, NULL);
    for (const char *p = source; (p = strstr(p, "MASU_PARAM_")); p += length) {
        length = strspn(p, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");
        (void)snprintf(name, sizeof name, "%.*s", (int)length, p);
        at += (size_t)snprintf(text + at, sizeof text - at, "#ifndef %s\n#define %s 0\n#endif\n",
                               name, name);
        assert_true(at < sizeof text);
    }
    free(source);
    (void)snprintf(text + at, sizeof text - at,
                   "#include \"%s\"\n"
                   "#define MASU_SDF_TERMS_FOUND 1\n#include \"sdf/hand_written.glsl\"\n",
                   field);
    return write_text("sdf_scene.glsl", text);
}

/* Compiles with sdf_scene.glsl in the test's directory. Returns the number of loops. */
static uint32_t assert_scene_shaders_pass(const char *field, int dynamic) {
    uint32_t loops = 0;
    const char *chosen =
        write_text("sdf_options.glsl",
               "#define MASU_SHADOWS 1\n#define MASU_AMBIENT_OCCLUSION 1\n"
               "#define MASU_SUN_TANGENT 0.01\n#define MASU_SHADOW_DISTANCE 100.0\n"
               "#define MASU_AO_RADIUS 1.0\n#define MASU_AO_STRENGTH 1.0\n");
    for (size_t i = 0; i < COUNT(scene_shaders); i++) {
        if (scene_shaders[i].dynamic && !dynamic) continue;
        for (int raster = 0; raster < scene_shaders[i].sides; raster++) {
            char path[64], name[256], options[256];
            spirv_module m;
            (void)snprintf(path, sizeof path, "shaders/%s", scene_shaders[i].source);
            (void)snprintf(name, sizeof name, "%s %s with %s", scene_shaders[i].source,
                           scene_shaders[i].define, field);
            (void)snprintf(options, sizeof options,
                           "-Ishaders -I%s/gen -I. -I%s -DMASU_HAS_RASTER=%d %s", made_dir(),
                           scratch, raster, scene_shaders[i].define);
            if (!spirv_compile(path, options, &m)) fail_msg("%s does not compile", name);
            uint32_t found = assert_passes(&m, name);
            if (found < scene_shaders[i].loops) fail_msg("%s: %u loops only", name, found);
            loops += found;
            spirv_free(&m);
        }
    }
    assert_int_equal(remove(chosen), 0);
    return loops;
}

static void scene_shaders_pass_with_every_field_of_the_scenes(void **state) {
    (void)state;
    glob_t fields = find("scenes", "*.glsl");
    uint32_t loops = 0;
    for (size_t i = 0; i < fields.gl_pathc; i++) {
        const char *wrapper = write_field(fields.gl_pathv[i]);
        loops += assert_scene_shaders_pass(fields.gl_pathv[i], 0);
        assert_int_equal(remove(wrapper), 0);
    }
    printf("%u loops with %zu fields\n", loops, fields.gl_pathc);
    globfree(&fields);
}

/* Every feature of the language, including changing slots. */
static void scene_shaders_pass_with_what_masu_sdfc_writes(void **state) {
    (void)state;
    uint32_t loops = 0;
    for (int anchored = 0; anchored < 2; anchored++) {
        const char *wrapper = in_scratch("sdf_scene.glsl");
        assert_int_equal(
            shell("%s/bin/masu-sdfc --quiet --glsl %s --pairs 10 tests/unit/features.sdf %s",
                  build_dir(), wrapper, anchored ? "--anchored" : ""),
            0);
        loops += assert_scene_shaders_pass("features.sdf", 1);
        assert_int_equal(remove(wrapper), 0);
    }
    printf("%u loops\n", loops);
}

/* Size of march.comp in 32-bit values with the field of a .sdf file, and its number of loops. */
static size_t march_words(const char *sdf, uint32_t *loops) {
    char options[256];
    const char *wrapper = in_scratch("sdf_scene.glsl");
    spirv_module m;
    assert_int_equal(shell("%s/bin/masu-sdfc --quiet --glsl %s --pairs 10 %s", build_dir(), wrapper,
                           sdf),
                     0);
    (void)snprintf(options, sizeof options, "-Ishaders -I%s/gen -I%s -DMASU_HAS_RASTER=0",
                   made_dir(), scratch);
    assert_true(spirv_compile("shaders/march.comp", options, &m));
    size_t words = m.word_count;
    *loops = assert_passes(&m, sdf);
    spirv_free(&m);
    assert_int_equal(remove(wrapper), 0);
    return words;
}

static void a_march_has_the_code_that_its_scene_needs(void **state) {
    (void)state;
    write_text("one.sdf", "part a = sphere(1);\n");
    write_text("two.sdf", "part a = sphere(1);\npart b = box((1, 2, 3));\n");
    uint32_t loops[4];
    size_t single = march_words(in_scratch("one.sdf"), &loops[0]);
    size_t pair = march_words(in_scratch("two.sdf"), &loops[1]);
    size_t parts = march_words("tests/scenes/parts300.sdf", &loops[2]);
    size_t city = march_words("scenes/city.sdf", &loops[3]);
    printf("march.comp, 32-bit values: %zu with a sphere, %zu with a box too, %zu with 300 parts, "
           "%zu with the city\n",
           single, pair, parts, city);
    assert_true(single < pair && pair < parts && parts < city);
    /* No loops over parts: only those of march.comp itself, and with two parts two over the masks
     * of a block, at the start of a ray and at its look-up. */
    assert_int_equal(loops[0] + 2, loops[1]);
    assert_true(loops[2] > loops[0]);
    assert_int_equal(remove(in_scratch("one.sdf")), 0);
    assert_int_equal(remove(in_scratch("two.sdf")), 0);
}

static void the_code_in_every_baked_scene_passes(void **state) {
    (void)state;
    glob_t scenes = find(made_dir(), "scenes/*.masu");
    uint32_t loops = 0, modules = 0;
    for (size_t i = 0; i < scenes.gl_pathc; i++) {
        uint8_t *bytes;
        size_t size;
        char error[256];
        masu_scene scene;
        masu_detail detail;
        const char *path = scenes.gl_pathv[i];
        if (!masu_file_read(path, (size_t)1 << 30, &bytes, &size, error, sizeof error)) {
            fail_msg("%s", error);
        }
        if (masu_scene_bind(bytes, size, &scene, &detail)) fail_msg("%s: %s", path, detail.text);
        masu_scene_view view = masu_scene_view_of(&scene);
        uint32_t found = 0;
        for (uint32_t kind = 0; kind < MASU_BLOB_KIND_COUNT; kind++) {
            char name[512];
            spirv_module m;
            if (!view.code[kind].words) continue;
            (void)snprintf(name, sizeof name, "%s, section of kind %u", path, kind);
            if (!spirv_from_words(view.code[kind].words, (size_t)view.code[kind].count, &m)) {
                fail_msg("%s: no SPIR-V", name);
            }
            loops += assert_passes(&m, name);
            found++;
            spirv_free(&m);
        }
        assert_true(masu_scene_data_of(&scene)->sdf ? found >= 4 : found == 0);
        modules += found;
        free(bytes);
    }
    printf("%u loops in %u baked modules\n", loops, modules);
    assert_true(modules > 0 && loops > 0);
    globfree(&scenes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_that_counts_to_a_constant_is_bounded),
        cmocka_unit_test(a_bounded_loop_may_end_earlier),
        cmocka_unit_test(loops_inside_loops_are_bounded_each),
        cmocka_unit_test(a_loop_that_its_data_ends_is_unbounded),
        cmocka_unit_test(a_counter_that_is_tampered_with_counts_nothing),
        cmocka_unit_test(a_bound_that_is_no_bound_is_none),
        cmocka_unit_test(an_unbounded_loop_is_named_by_its_function),
        cmocka_unit_test(a_fourth_descriptor_set_is_noticed),
        cmocka_unit_test(every_shader_of_the_library_passes),
        cmocka_unit_test(scene_shaders_pass_with_every_field_of_the_scenes),
        cmocka_unit_test(scene_shaders_pass_with_what_masu_sdfc_writes),
        cmocka_unit_test(a_march_has_the_code_that_its_scene_needs),
        cmocka_unit_test(the_code_in_every_baked_scene_passes),
    };
    return cmocka_run_group_tests_name("shader_gates", tests, make_scratch, remove_empty_scratch);
}
