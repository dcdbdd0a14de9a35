/* test_shared_layout.c: the structs of shaders/shared/masu_shared.h have the same bytes on both
 * sides: the decorations by glslang in the compiled shaders are compared, member by member, with
 * offsetof and sizeof in C. A struct that is in no shader, or has a member that is missing in the
 * table below, fails. */
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

#include "scene/material.h"
#include "shared/masu_shared.h"
#include "support/files.h"
#include "support/spirv.h"

#define MEMBERS_MOST 33u

typedef struct member {
    const char *name;
    size_t offset, bytes;
} member;

typedef struct layout {
    const char *name;
    size_t bytes;
    int in_arrays; /* an element of a storage buffer: its stride counts */
    member members[MEMBERS_MOST];
} layout;

#define STRUCT(s) #s, sizeof(struct s)
#define MEMBER(s, m)                                                                               \
    { #m, offsetof(struct s, m), sizeof(((struct s *)0)->m) }

static const layout layouts[] = {
    {STRUCT(masu_frame_uniforms),
     0,
     {MEMBER(masu_frame_uniforms, clip_from_rel),
      MEMBER(masu_frame_uniforms, eye_hi),
      MEMBER(masu_frame_uniforms, eye_lo),
      MEMBER(masu_frame_uniforms, right),
      MEMBER(masu_frame_uniforms, up),
      MEMBER(masu_frame_uniforms, forward),
      MEMBER(masu_frame_uniforms, sun_direction),
      MEMBER(masu_frame_uniforms, sun_color),
      MEMBER(masu_frame_uniforms, ambient),
      MEMBER(masu_frame_uniforms, sky_zenith),
      MEMBER(masu_frame_uniforms, sky_horizon),
      MEMBER(masu_frame_uniforms, irradiance),
      MEMBER(masu_frame_uniforms, fog),
      MEMBER(masu_frame_uniforms, air),
      MEMBER(masu_frame_uniforms, anchor),
      MEMBER(masu_frame_uniforms, sdf_eye_hi),
      MEMBER(masu_frame_uniforms, sdf_eye_lo),
      MEMBER(masu_frame_uniforms, sdf_min),
      MEMBER(masu_frame_uniforms, sdf_max),
      MEMBER(masu_frame_uniforms, sdf_low),
      MEMBER(masu_frame_uniforms, sdf_high),
      MEMBER(masu_frame_uniforms, history),
      MEMBER(masu_frame_uniforms, trace_anchor),
      MEMBER(masu_frame_uniforms, trace_eye),
      MEMBER(masu_frame_uniforms, jitter),
      MEMBER(masu_frame_uniforms, temporal),
      MEMBER(masu_frame_uniforms, sdf_params),
      MEMBER(masu_frame_uniforms, shifts),
      MEMBER(masu_frame_uniforms, between),
      MEMBER(masu_frame_uniforms, columns),
      MEMBER(masu_frame_uniforms, rows),
      MEMBER(masu_frame_uniforms, environment),
      MEMBER(masu_frame_uniforms, background)}},
    {STRUCT(masu_instance_data),
     1,
     {MEMBER(masu_instance_data, row0), MEMBER(masu_instance_data, row1),
      MEMBER(masu_instance_data, row2)}},
    {STRUCT(masu_post_uniforms),
     0,
     {MEMBER(masu_post_uniforms, lens), MEMBER(masu_post_uniforms, grade)}},
    {STRUCT(masu_material_data),
     1,
     {MEMBER(masu_material_data, base_color), MEMBER(masu_material_data, emissive),
      MEMBER(masu_material_data, more)}},
    {STRUCT(masu_shadow_uniforms),
     0,
     {MEMBER(masu_shadow_uniforms, row0), MEMBER(masu_shadow_uniforms, row1),
      MEMBER(masu_shadow_uniforms, row2), MEMBER(masu_shadow_uniforms, origin_hi),
      MEMBER(masu_shadow_uniforms, origin_lo), MEMBER(masu_shadow_uniforms, rect),
      MEMBER(masu_shadow_uniforms, reach)}},
    {STRUCT(masu_sky_uniforms),
     0,
     {MEMBER(masu_sky_uniforms, sun), MEMBER(masu_sky_uniforms, disc),
      MEMBER(masu_sky_uniforms, azimuth), MEMBER(masu_sky_uniforms, rows),
      MEMBER(masu_sky_uniforms, horizon), MEMBER(masu_sky_uniforms, rough)}},
    {STRUCT(masu_probe_grid),
     0,
     {MEMBER(masu_probe_grid, origin), MEMBER(masu_probe_grid, spacing),
      MEMBER(masu_probe_grid, counts), MEMBER(masu_probe_grid, more),
      MEMBER(masu_probe_grid, sun_direction), MEMBER(masu_probe_grid, sun_inverse)}},
    {STRUCT(masu_punctual_light_data),
     1,
     {MEMBER(masu_punctual_light_data, position), MEMBER(masu_punctual_light_data, color),
      MEMBER(masu_punctual_light_data, axis), MEMBER(masu_punctual_light_data, cone),
      MEMBER(masu_punctual_light_data, bound), MEMBER(masu_punctual_light_data, shadow),
      MEMBER(masu_punctual_light_data, shadow_origin)}},
    {STRUCT(masu_local_face_uniforms),
     0,
     {MEMBER(masu_local_face_uniforms, row0), MEMBER(masu_local_face_uniforms, row1),
      MEMBER(masu_local_face_uniforms, row2), MEMBER(masu_local_face_uniforms, origin_hi),
      MEMBER(masu_local_face_uniforms, origin_lo), MEMBER(masu_local_face_uniforms, tile),
      MEMBER(masu_local_face_uniforms, groups), MEMBER(masu_local_face_uniforms, square)}},
    {STRUCT(masu_push),
     0,
     {MEMBER(masu_push, render_width), MEMBER(masu_push, render_height),
      MEMBER(masu_push, output_width), MEMBER(masu_push, output_height),
      MEMBER(masu_push, output_steps), MEMBER(masu_push, output_flags)}},
};

#define LAYOUTS (sizeof layouts / sizeof *layouts)

static glob_t shaders; /* the library's, with debug names */

static int find_shaders(void **state) {
    (void)state;
    char pattern[512];
    (void)snprintf(pattern, sizeof pattern, "%s/gen/*_????.spv", made_dir());
    return glob(pattern, 0, NULL, &shaders);
}

static int forget_shaders(void **state) {
    (void)state;
    globfree(&shaders);
    return 0;
}

/* Bytes of a type; arrays and matrices by the strides they are decorated with. 0: unknown. */
static size_t type_bytes(const spirv_module *m, uint32_t id, uint32_t matrix_stride) {
    const spirv_instruction *type = m->def[id];
    uint32_t stride;
    if (!type) return 0;
    switch (type->op) {
    case SPIRV_TYPE_INT:
    case SPIRV_TYPE_FLOAT: return type->word[2] / 8;
    case SPIRV_TYPE_VECTOR: return type->word[3] * type_bytes(m, type->word[2], 0);
    case SPIRV_TYPE_MATRIX: return (size_t)type->word[3] * matrix_stride;
    case SPIRV_TYPE_ARRAY:
        if (!spirv_decoration(m, id, SPIRV_DECORATION_ARRAY_STRIDE, &stride)) return 0;
        return (size_t)stride * m->def[type->word[3]]->word[3];
    default: return 0;
    }
}

static const member *find_member(const layout *l, const char *name) {
    for (uint32_t i = 0; i < MEMBERS_MOST && l->members[i].name; i++) {
        if (!strcmp(l->members[i].name, name)) return &l->members[i];
    }
    return NULL;
}

static void compare_member(const spirv_module *m, const layout *l, const spirv_instruction *type,
                           uint32_t index, const char *path) {
    uint32_t id = type->word[1], offset = 0, stride = 0, unused;
    const char *name = spirv_member_name(m, id, index);
    const member *in_c = find_member(l, name);
    if (!in_c) fail_msg("%s: %s.%s is not in the table", path, l->name, name);
    if (!spirv_member_decoration(m, id, index, SPIRV_DECORATION_OFFSET, &offset) ||
        offset != in_c->offset) {
        fail_msg("%s: %s.%s is at %u, in C at %zu", path, l->name, name, offset, in_c->offset);
    }
    if (m->def[type->word[2 + index]]->op == SPIRV_TYPE_MATRIX) {
        if (!spirv_member_decoration(m, id, index, SPIRV_DECORATION_COL_MAJOR, &unused) ||
            !spirv_member_decoration(m, id, index, SPIRV_DECORATION_MATRIX_STRIDE, &stride)) {
            fail_msg("%s: %s.%s is not column-major", path, l->name, name);
        }
        assert_int_equal(stride, 4 * sizeof(float));
    }
    size_t bytes = type_bytes(m, type->word[2 + index], stride);
    if (bytes != in_c->bytes) {
        fail_msg("%s: %s.%s has %zu bytes, in C %zu", path, l->name, name, bytes, in_c->bytes);
    }
}

static void compare_strides(const spirv_module *m, const layout *l, uint32_t id, const char *path,
                            uint32_t *arrays) {
    for (size_t k = 0; k < m->count; k++) {
        const spirv_instruction *i = &m->list[k];
        uint32_t stride;
        if (i->op != SPIRV_TYPE_RUNTIME_ARRAY && i->op != SPIRV_TYPE_ARRAY) continue;
        if (i->word[2] != id) continue;
        if (!spirv_decoration(m, i->word[1], SPIRV_DECORATION_ARRAY_STRIDE, &stride) ||
            stride != l->bytes) {
            fail_msg("%s: %s has a stride of %u, in C %zu bytes", path, l->name, stride, l->bytes);
        }
        ++*arrays;
    }
}

/* Compares every struct with that name that has a layout; counts them. glslang makes a second type,
 * without offsets, for values that are in no buffer. */
static void compare(const spirv_module *m, const layout *l, const char *path, uint32_t *found,
                    uint32_t *arrays) {
    uint32_t unused, members = 0;
    while (members < MEMBERS_MOST && l->members[members].name) members++;
    for (size_t k = 0; k < m->count; k++) {
        const spirv_instruction *i = &m->list[k];
        if (i->op != SPIRV_TYPE_STRUCT || strcmp(spirv_name(m, i->word[1]), l->name)) continue;
        if (!spirv_member_decoration(m, i->word[1], 0, SPIRV_DECORATION_OFFSET, &unused)) continue;
        ++*found;
        if (i->count - 2 != members) {
            fail_msg("%s: %s has %u members, in C %u", path, l->name, i->count - 2, members);
        }
        for (uint32_t x = 0; x < members; x++) compare_member(m, l, i, x, path);
        compare_strides(m, l, i->word[1], path, arrays);
    }
}

static void every_shared_struct_is_laid_out_alike_in_c_and_in_every_shader(void **state) {
    (void)state;
    uint32_t found[LAYOUTS] = {0}, arrays[LAYOUTS] = {0};
    for (size_t s = 0; s < shaders.gl_pathc; s++) {
        spirv_module m;
        if (!spirv_from_file(shaders.gl_pathv[s], &m)) fail_msg("%s", shaders.gl_pathv[s]);
        for (size_t l = 0; l < LAYOUTS; l++) {
            compare(&m, &layouts[l], shaders.gl_pathv[s], &found[l], &arrays[l]);
        }
        spirv_free(&m);
    }
    for (size_t l = 0; l < LAYOUTS; l++) {
        printf("%s: in %u shaders, %u arrays\n", layouts[l].name, found[l], arrays[l]);
        if (!found[l]) fail_msg("%s is in no shader", layouts[l].name);
        if (layouts[l].in_arrays && !arrays[l]) fail_msg("%s is in no array", layouts[l].name);
    }
}

/* The table above covers every byte of a struct. */
static void every_member_in_c_is_in_the_table(void **state) {
    (void)state;
    for (size_t l = 0; l < LAYOUTS; l++) {
        size_t end = 0;
        for (uint32_t i = 0; i < MEMBERS_MOST && layouts[l].members[i].name; i++) {
            assert_int_equal(layouts[l].members[i].offset, end);
            end += layouts[l].members[i].bytes;
        }
        assert_int_equal(end, layouts[l].bytes);
    }
}

/* A material without thickness is metallic by its number; the thinnest one has packed bits. */
static void only_what_is_thick_refracts(void **state) {
    (void)state;
    masu_blob_material m = {.metallic = 0.75f, .ior = 1.5f};
    assert_true(masu_material_data_of(&m).emissive[3] == 0.75f);
    m.thickness = 0x1p-14f;
    assert_true(masu_material_data_of(&m).emissive[3] < 0);
}

/* The minimum of every device: 16 KiB of uniforms. */
_Static_assert(sizeof(struct masu_frame_uniforms) <= 16384, "uniforms fit any device");
_Static_assert(sizeof(struct masu_frame_uniforms) % 16 == 0, "uniforms are whole vec4s");
_Static_assert(MASU_SDF_PARAM_VEC4S * 4 == MASU_SDF_PARAMS_MAX, "each parameter has its place");

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_shared_struct_is_laid_out_alike_in_c_and_in_every_shader),
        cmocka_unit_test(every_member_in_c_is_in_the_table),
        cmocka_unit_test(only_what_is_thick_refracts),
    };
    return cmocka_run_group_tests_name("shared_layout", tests, find_shaders, forget_shaders);
}
