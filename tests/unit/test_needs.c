/* test_needs.c: what every shader of the library, and of scenes with an SDF, needs of a device, read
 * from its SPIR-V: never more than the specification's minimum (chapter "Limits", "Required
 * Limits"), except for storage buffers of features that src/device/capabilities.c can drop. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bindings.h"
#include "device/unpack.h"
#include "masu.h"
#include "scene/scene.h"
#include "support/files.h"
#include "support/spirv.h"

#include "packed.h"

enum {
    ENTRY_POINT = 15,
    EXECUTION_MODE = 16,
    TYPE_IMAGE = 25,
    TYPE_SAMPLED_IMAGE = 27,
    SPEC_CONSTANT = 50,
    LOCAL_SIZE = 17,
    NON_WRITABLE = 24,
    LOCATION = 30,
    BINDING = 33
};
enum {
    IN_UNIFORM_CONSTANT = 0,
    IN_INPUT = 1,
    IN_UNIFORM = 2,
    IN_OUTPUT = 3,
    IN_WORKGROUP = 4,
    IN_STORAGE = 12
};
enum { VERTEX = 0, FRAGMENT = 4, COMPUTE = 5 };

typedef struct shader_needs {
    uint32_t stage, invocations, shared_bytes;
    uint32_t uniform_buffers, storage_buffers, sampled_images, storage_images;
    uint32_t written;       /* storage buffers and images that the shader may write */
    uint32_t input_end, output_end; /* one past the last location */
} shader_needs;

/* ---- Reading --------------------------------------------------------------------------------- */

static const spirv_instruction *defined(const spirv_module *m, uint32_t id) {
    for (size_t i = 0; i < m->count; i++) {
        const spirv_instruction *in = &m->list[i];
        uint32_t at = in->op >= SPIRV_TYPE_INT - 1 && in->op <= SPIRV_TYPE_POINTER ? 1 : 2;
        if ((at == 1 || in->op == SPIRV_CONSTANT || in->op == SPEC_CONSTANT) && in->count > at &&
            in->word[at] == id)
            return in;
    }
    return NULL;
}

static uint32_t size_of(const spirv_module *m, uint32_t id) {
    const spirv_instruction *t = defined(m, id);
    uint32_t bytes = 0;
    if (!t) return 0;
    switch (t->op) {
    case SPIRV_TYPE_VECTOR:
    case SPIRV_TYPE_MATRIX: return size_of(m, t->word[2]) * t->word[3];
    case SPIRV_TYPE_ARRAY: {
        const spirv_instruction *n = defined(m, t->word[3]);
        return size_of(m, t->word[2]) * (n ? n->word[3] : 1);
    }
    case SPIRV_TYPE_STRUCT:
        for (uint32_t i = 2; i < t->count; i++) bytes += size_of(m, t->word[i]);
        return bytes;
    default: return 4;
    }
}

/* Whether a variable of that struct, or all of its members, are decorated NonWritable. */
static int is_read_only(const spirv_module *m, uint32_t variable, const spirv_instruction *type) {
    uint32_t members = 0;
    for (size_t i = 0; i < m->count; i++) {
        const spirv_instruction *in = &m->list[i];
        if (in->op == SPIRV_DECORATE && in->word[1] == variable && in->word[2] == NON_WRITABLE)
            return 1;
        members += in->op == SPIRV_MEMBER_DECORATE && type && in->word[1] == type->word[1] &&
                   in->word[3] == NON_WRITABLE;
    }
    return type && type->op == SPIRV_TYPE_STRUCT && members == type->count - 2;
}

static void add_variable(const spirv_module *m, const spirv_instruction *in, uint64_t *buffers,
                         uint64_t *uniforms, shader_needs *n) {
    const spirv_instruction *pointer = defined(m, in->word[1]);
    const spirv_instruction *type = pointer ? defined(m, pointer->word[3]) : NULL;
    uint32_t id = in->word[2], at = 0;
    switch (in->word[3]) {
    case IN_WORKGROUP: n->shared_bytes += pointer ? size_of(m, pointer->word[3]) : 0; break;
    case IN_UNIFORM_CONSTANT:
        if (type && type->op == TYPE_SAMPLED_IMAGE) n->sampled_images++;
        if (type && type->op == TYPE_IMAGE) n->storage_images++;
        if (type && type->op == TYPE_IMAGE) n->written++;
        break;
    case IN_UNIFORM:
        if (spirv_decoration(m, id, BINDING, &at)) *uniforms |= (uint64_t)1 << at;
        break;
    case IN_STORAGE: /* two declarations may share a binding */
        if (spirv_decoration(m, id, BINDING, &at)) *buffers |= (uint64_t)1 << at;
        if (!is_read_only(m, id, type)) n->written++;
        break;
    case IN_INPUT:
        if (spirv_decoration(m, id, LOCATION, &at) && at + 1 > n->input_end) n->input_end = at + 1;
        break;
    case IN_OUTPUT:
        if (spirv_decoration(m, id, LOCATION, &at) && at + 1 > n->output_end)
            n->output_end = at + 1;
        break;
    default: break;
    }
}

static uint32_t bits(uint64_t x) {
    uint32_t n = 0;
    for (; x; x &= x - 1) n++;
    return n;
}

static shader_needs needs_of(const uint32_t *words, size_t count, const char *name) {
    shader_needs n = {.invocations = 1};
    uint64_t buffers = 0, uniforms = 0;
    spirv_module m;
    if (!spirv_from_words(words, count, &m)) fail_msg("%s: no SPIR-V", name);
    for (size_t i = 0; i < m.count; i++) {
        const spirv_instruction *in = &m.list[i];
        if (in->op == ENTRY_POINT) n.stage = in->word[1];
        if (in->op == EXECUTION_MODE && in->word[2] == LOCAL_SIZE)
            n.invocations = in->word[3] * in->word[4] * in->word[5];
        if (in->op == SPIRV_VARIABLE) add_variable(&m, in, &buffers, &uniforms, &n);
    }
    /* Without desc.debug.counters, layouts have the counters only if they are the only buffer. */
    uint64_t others = buffers & ~((uint64_t)1 << MASU_BIND_COUNTERS);
    n.storage_buffers = bits(others ? others : buffers);
    n.uniform_buffers = bits(uniforms);
    spirv_free(&m);
    return n;
}

/* ---- Limits ---------------------------------------------------------------------------------- */

/* Storage buffers that a shader may need. Devices with fewer lack the feature: reflections of
 * polygons, live bounce. All other shaders fit the minimum. docs/devices.md has these numbers. */
static uint32_t most_buffers(const char *name) {
    static const struct {
        const char *start;
        uint32_t most;
    } rows[] = {{"bounce_shade_textures_lights", 9}, {"bounce_", 8}, {"specular_shade", 8},
                {"specular_trace", 5}, {"specular_motion", 4}, {"specular_query", 4}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (!strncmp(name, rows[i].start, strlen(rows[i].start))) return rows[i].most;
    return 4;
}

static void assert_fits(const shader_needs *n, const char *name) {
    const struct {
        const char *what;
        uint32_t needed, least;
    } rows[] = {
        {"storage buffers", n->storage_buffers, most_buffers(name)},
        {"uniform buffers", n->uniform_buffers, 12},
        {"sampled images", n->sampled_images, 16},
        {"storage images", n->storage_images, 4},
        {"invocations", n->invocations, 128},
        {"bytes of shared memory", n->shared_bytes, 16384},
        {"vertex inputs", n->stage == VERTEX ? n->input_end : 0, 16},
        {"vertex outputs", n->stage == VERTEX ? n->output_end : 0, 16},
        /* with emission, velocity and surface only if the device has five attachments */
        {"fragment outputs", n->stage == FRAGMENT ? n->output_end : 0,
         strstr(name, "gbuffer") && strstr(name, "velocity_surface_frag") ? 5 : 4},
        {"buffers and images written outside of compute", n->stage == COMPUTE ? 0 : n->written, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (rows[i].needed > rows[i].least)
            fail_msg("%s needs %u %s, every device has %u", name, rows[i].needed, rows[i].what,
                     rows[i].least);
    }
}

static void the_shaders_of_the_library_fit_every_device(void **state) {
    (void)state;
    static const char *const names[] = {
#define NAME(name) #name,
        MASU_PACKED_EACH(NAME)
#undef NAME
    };
    shader_needs most = {0};
    (void)masu_pack_of_all;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[512];
        size_t bytes;
        snprintf(path, sizeof path, "%s/gen/%s.opt.spv", made_dir(), names[i]);
        uint32_t *words = read_file(path, &bytes);
        shader_needs n = needs_of(words, bytes / sizeof *words, names[i]);
        assert_fits(&n, names[i]);
        if (n.storage_buffers > most.storage_buffers) most.storage_buffers = n.storage_buffers;
        if (n.sampled_images > most.sampled_images) most.sampled_images = n.sampled_images;
        if (n.storage_images > most.storage_images) most.storage_images = n.storage_images;
        if (n.uniform_buffers > most.uniform_buffers) most.uniform_buffers = n.uniform_buffers;
        if (n.shared_bytes > most.shared_bytes) most.shared_bytes = n.shared_bytes;
        free(words);
    }
    print_message("most: %u storage buffers, %u uniform buffers, %u sampled, %u storage images, %u "
                  "bytes shared\n",
                  most.storage_buffers, most.uniform_buffers, most.sampled_images,
                  most.storage_images, most.shared_bytes);
    assert_int_equal(most.storage_buffers, 9); /* bounce_shade_textures_lights */
    assert_true(most.shared_bytes > 1024 && most.sampled_images > 8 && most.uniform_buffers > 1);
}

static void the_code_of_scenes_fits_every_device(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_sdf_looks", "test_velocity", "test_both"};
    uint32_t modules = 0;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        char path[512];
        size_t bytes;
        masu_scene scene;
        snprintf(path, sizeof path, "%s/scenes/%s.masu", made_dir(), scenes[i]);
        void *blob = read_file(path, &bytes);
        assert_int_equal(masu_scene_bind(blob, bytes, &scene, NULL), MASU_OK);
        masu_scene_view view = masu_scene_view_of(&scene);
        for (uint32_t kind = 0; kind < MASU_BLOB_KIND_COUNT; kind++) {
            if (!view.code[kind].words) continue;
            char name[600];
            snprintf(name, sizeof name, "%s, section of kind %u", path, kind);
            shader_needs n = needs_of(view.code[kind].words, (size_t)view.code[kind].count, name);
            assert_fits(&n, name);
            modules++;
        }
        free(blob);
    }
    assert_true(modules >= 12);
}

/* ---- masu_rebind ----------------------------------------------------------------------------- */

/* Only the variables of set 0 change: set 1 has the same number. */
static void a_binding_moves_in_set_0_only(void **state) {
    (void)state;
    const uint32_t words[] = {0x07230203u,
                              0x10000u,
                              0,
                              9,
                              0,
                              4u << 16 | 71,
                              5,
                              34,
                              0,
                              4u << 16 | 71,
                              5,
                              33,
                              7, /* set 0, binding 7 */
                              4u << 16 | 71,
                              6,
                              34,
                              1,
                              4u << 16 | 71,
                              6,
                              33,
                              7, /* set 1, binding 7 */
                              4u << 16 | 71,
                              8,
                              34,
                              0,
                              4u << 16 | 71,
                              8,
                              33,
                              3}; /* set 0, binding 3 */
    enum { COUNT = sizeof words / sizeof *words };
    uint32_t is[COUNT];
    memcpy(is, words, sizeof is);
    masu_rebind(is, COUNT, 7, 3);
    for (uint32_t i = 0; i < COUNT; i++) assert_int_equal(is[i], i == 12 ? 3 : words[i]);
    assert_int_equal(masu_interface_of(is, COUNT).bindings, 1u << 3);
    memcpy(is, words, sizeof is);
    for (uint32_t n = 0; n < COUNT; n++)
        masu_rebind(is, n, 9, 1); /* cut anywhere, nothing to move */
    assert_memory_equal(is, words, sizeof is);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_shaders_of_the_library_fit_every_device),
        cmocka_unit_test(the_code_of_scenes_fits_every_device),
        cmocka_unit_test(a_binding_moves_in_set_0_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
