/* test_null.c: every public function with each of its pointers NULL, one at a time. Nothing
 * crashes. A function with a result returns MASU_ERROR_ARGUMENT, unless the pointer may be NULL,
 * and its detail (the last parameter) names the argument. The list of functions and the names of
 * their arguments are read from include/: a new function there that has no row here is a
 * failure. */
#include <ctype.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/bind.h"
#include "support/desc.h"
#include "support/dry_renderer.h"

enum { NO_RESULT = 1000, PARAMETERS_MAX = 8 };

/* ---- The calls ------------------------------------------------------------------------------- */

static masu_desc desc, resolved;
static masu_pipelines pool;
static masu_pipelines_info pool_info;
static masu_viewport screen;
static masu_governor_setting setting;
static masu_governor_state learnt;
static masu_detail detail;
static masu_scene look;
static uint32_t resolution;
static float range[2];
static masu_limits usage;
static masu_commands commands;
static masu_camera camera;
static masu_light light;
static masu_split split;
static masu_frame_view view;
static masu_plan_info plan;
static masu_device_info device;
static masu_memory need;
static masu_memory_row rows_of_memory[2];
static masu_texture_image texture_image;
static VkRect2D rect;
static masu_peak_info peaks;
static masu_stats_info stats;
static masu_readback_image image;
static masu_pick_info pick;
static masu_instance_state instance_state;
static masu_look instance_look;
static masu_progress progress;
static masu_model_state model_state;
static masu_mesh_data mesh_data;
static masu_model added;
static const masu_clip_use clip_use = {.weight = 1.0f};
static masu_node_state node_state;
static masu_punctual_light_state light_state;
static masu_punctual_light made_light;
static masu_material_state material_state;
static masu_renderer *made;
static masu_rung rung;
static const char *from;
static float unpacked[3];
static const float white[24];
static _Alignas(64) unsigned char block[64];
static const masu_frame_desc still = {MASU_FRAME_DESC};
static const float unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
static const double unit_position[3] = {1, 2, 3};

/* The pointer with this number, counted from 0, or NULL if it is the one under test. */
#define P(number, pointer) (null == (number) ? NULL : (pointer))

#define INSTANCE masu_instance_at(&m, 0)
#define MODEL masu_model_at(&m, 0)
#define LIGHT masu_punctual_light_at(&m, 0)
#define KNOB masu_knob_table()

/* Each function of the public header: an expression that is its result, or NO_RESULT. */
#define CALLS(X)                                                                                   \
    X(masu_version, (masu_version(), NO_RESULT))                                                   \
    X(masu_result_string, (masu_result_string(MASU_OK), NO_RESULT))                                \
    X(masu_scene_bind,                                                                             \
      masu_scene_bind(P(0, masu_scene_data_of(&scene)->blob),                                      \
                      masu_scene_data_of(&scene)->blob_bytes, P(1, &look), P(2, &detail)))         \
    X(masu_scene_count, (masu_scene_count(P(0, &scene), MASU_SCENE_MODEL), NO_RESULT))             \
    X(masu_scene_name, (masu_scene_name(P(0, &scene), MASU_SCENE_MODEL, 0), NO_RESULT))            \
    X(masu_scene_find, (masu_scene_find(P(0, &scene), MASU_SCENE_MODEL, P(1, "a")), NO_RESULT))    \
    X(masu_scene_clip_count, (masu_scene_clip_count(P(0, &scene), 0), NO_RESULT))                  \
    X(masu_scene_clip_name, (masu_scene_clip_name(P(0, &scene), 0, 0), NO_RESULT))                 \
    X(masu_scene_sdf_range,                                                                        \
      ((void)masu_scene_sdf_range(P(0, &scene), 0, P(1, &range[0]), P(2, &range[1])), NO_RESULT))  \
    X(masu_scene_features, (masu_scene_features(P(0, &scene)), NO_RESULT))                         \
    X(masu_scene_triangles, (masu_scene_triangles(P(0, &scene)), NO_RESULT))                       \
    X(masu_scene_texture_bytes, (masu_scene_texture_bytes(P(0, &scene), 1), NO_RESULT))            \
    X(masu_scene_shadow_cascades,                                                                  \
      (masu_scene_shadow_cascades(P(0, &scene), P(1, &resolution)), NO_RESULT))                    \
    X(masu_scene_shadow_distance, ((void)masu_scene_shadow_distance(P(0, &scene)), NO_RESULT))     \
    X(masu_scene_specular_cutoff, ((void)masu_scene_specular_cutoff(P(0, &scene)), NO_RESULT))     \
    X(masu_scene_usage, (masu_scene_usage(P(0, &scene), P(1, &usage)), NO_RESULT))                 \
    X(masu_scene_class_of, ((void)masu_scene_class_of(P(0, &scene)), NO_RESULT))                   \
    X(masu_scene_class_name, (masu_scene_class_name(MASU_SCENE_SDF), NO_RESULT))                   \
    X(masu_knob_table, (masu_knob_table(), NO_RESULT))                                             \
    X(masu_knob_get, ((void)masu_knob_get(P(0, KNOB), P(1, &rung), 0), NO_RESULT))                 \
    X(masu_knob_set, (masu_knob_set(P(0, KNOB), P(1, &rung), 0, 1.0), NO_RESULT))                  \
    X(masu_knob_accepts, (masu_knob_accepts(P(0, KNOB), 1.0), NO_RESULT))                          \
    X(masu_limit_table, (masu_limit_table(), NO_RESULT))                                           \
    X(masu_governor_reason_string,                                                                 \
      (masu_governor_reason_string(MASU_GOVERNOR_REASON_NONE), NO_RESULT))                         \
    X(masu_device_query, masu_device_query(P(0, &desc), P(1, &device), P(2, &detail)))             \
    X(masu_memory_query, masu_memory_query(P(0, &desc), P(1, &need), P(2, &detail)))               \
    X(masu_init, masu_init(P(0, &desc), P(1, block), sizeof block, P(2, &made), P(3, &detail)))    \
    X(masu_destroy, (masu_destroy(P(0, &m)), NO_RESULT))                                           \
    X(masu_pipelines_destroy,                                                                      \
      (masu_pipelines_destroy(P(0, &desc.vulkan), P(1, &pool)), NO_RESULT))                        \
    X(masu_pipelines_info_of, (masu_pipelines_info_of(P(0, &pool), P(1, &pool_info)), NO_RESULT))  \
    X(masu_resize, masu_resize(P(0, &m), (VkExtent2D){8, 8}, P(1, &desc.targets), P(2, &screen),   \
                               P(3, &detail)))                                                     \
    X(masu_desc_resolve, masu_desc_resolve(P(0, &desc), P(1, &resolved), P(2, &detail)))           \
    X(masu_ladder_of, masu_ladder_of(P(0, &scene), P(1, &desc), P(2, &from), P(3, &detail)))       \
    X(masu_memory_report,                                                                          \
      ((void)masu_memory_report(P(0, &m), P(1, rows_of_memory), 2), NO_RESULT))                    \
    X(masu_plan, masu_plan(P(0, &desc), P(1, &plan), P(2, &detail)))                               \
    X(masu_plan_of, (masu_plan_of(P(0, &m), P(1, &plan)), NO_RESULT))                              \
    X(masu_load, masu_load(P(0, &m), P(1, &commands), P(2, &detail)))                              \
    X(masu_frame, masu_frame(P(0, &m), P(1, &still), P(2, &commands), P(3, &detail)))              \
    X(masu_split_of, masu_split_of(P(0, &m), MASU_SPLIT_BEFORE_TONE, 0, 0, P(1, &split), P(2, &detail))) \
    X(masu_frame_view_of, masu_frame_view_of(P(0, &m), P(1, &view), P(2, &detail)))                \
    X(masu_frame_wall, (masu_frame_wall(P(0, &m), 0, 1.0), NO_RESULT))                             \
    X(masu_frame_times, (masu_frame_times(P(0, &m), 0, 1, 2, 0.0), NO_RESULT))                     \
    X(masu_frame_presented, (masu_frame_presented(P(0, &m), 0, 1, 2), NO_RESULT))                  \
    X(masu_governor_set, masu_governor_set(P(0, &m), P(1, &setting), P(2, &detail)))               \
    X(masu_governor_save, masu_governor_save(P(0, &m), P(1, &learnt), P(2, &detail)))              \
    X(masu_governor_restore, masu_governor_restore(P(0, &m), P(1, &learnt), P(2, &detail)))        \
    X(masu_camera_at, masu_camera_at(P(0, &m), 0.0, P(1, &camera), P(2, &detail)))                 \
    X(masu_light_of, masu_light_of(P(0, &m), P(1, &light), P(2, &detail)))                         \
    X(masu_instance_find, ((void)masu_instance_find(P(0, &m), P(1, "a")), NO_RESULT))              \
    X(masu_instance_set_transform, masu_instance_set_transform(P(0, &m), INSTANCE, P(1, unit), P(2, &detail))) \
    X(masu_instance_at, ((void)masu_instance_at(P(0, &m), 0), NO_RESULT))                          \
    X(masu_instance_set_position, masu_instance_set_position(P(0, &m), INSTANCE, P(1, unit_position), P(2, &detail))) \
    X(masu_instance_get, masu_instance_get(P(0, &m), INSTANCE, P(1, &instance_state), P(2, &detail))) \
    X(masu_instance_show, masu_instance_show(P(0, &m), INSTANCE, 1, P(1, &detail)))                \
    X(masu_init_step, masu_init_step(P(0, &m), P(1, &progress), P(2, &detail)))                    \
    X(masu_instance_set_look, masu_instance_set_look(P(0, &m), INSTANCE, P(1, &instance_look), P(2, &detail))) \
    X(masu_instance_get_look, masu_instance_get_look(P(0, &m), INSTANCE, P(1, &instance_look), P(2, &detail))) \
    X(masu_model_set_look, masu_model_set_look(P(0, &m), MODEL, P(1, &instance_look), P(2, &detail)))       \
    X(masu_model_find, ((void)masu_model_find(P(0, &m), P(1, "a")), NO_RESULT))                    \
    X(masu_model_at, ((void)masu_model_at(P(0, &m), 0), NO_RESULT))                                \
    X(masu_model_get, masu_model_get(P(0, &m), MODEL, P(1, &model_state), P(2, &detail)))          \
    X(masu_model_set_transform, masu_model_set_transform(P(0, &m), MODEL, P(1, unit), P(2, &detail))) \
    X(masu_model_show, masu_model_show(P(0, &m), MODEL, 1, P(1, &detail)))                         \
    X(masu_model_set_position, masu_model_set_position(P(0, &m), MODEL, P(1, unit_position), P(2, &detail))) \
    X(masu_model_add, masu_model_add(P(0, &m), MODEL, P(1, unit), P(2, &added), P(3, &detail)))    \
    X(masu_model_remove, masu_model_remove(P(0, &m), MODEL, P(1, &detail)))                        \
    X(masu_mesh_create, masu_mesh_create(P(0, &m), 0, P(1, &mesh_data), P(2, unit), P(3, &added), P(4, &detail))) \
    X(masu_mesh_replace, masu_mesh_replace(P(0, &m), MODEL, P(1, &mesh_data), P(2, &detail)))      \
    X(masu_mesh_deform, masu_mesh_deform(P(0, &m), MODEL, P(1, unit), P(2, unit), 0, P(3, &detail))) \
    X(masu_mesh_bytes, ((void)masu_mesh_bytes(P(0, &m), 1, 1), NO_RESULT))                          \
    X(masu_model_node_find, ((void)masu_model_node_find(P(0, &m), MODEL, P(1, "a")), NO_RESULT))   \
    X(masu_model_node_get, masu_model_node_get(P(0, &m), MODEL, 0, P(1, &node_state), P(2, &detail))) \
    X(masu_model_node_set, masu_model_node_set(P(0, &m), MODEL, 0, P(1, unit), P(2, &detail)))     \
    X(masu_model_clips, ((void)masu_model_clips(P(0, &m), MODEL), NO_RESULT))                      \
    X(masu_model_clip_find, ((void)masu_model_clip_find(P(0, &m), MODEL, P(1, "a")), NO_RESULT))   \
    X(masu_model_clip_duration, ((void)masu_model_clip_duration(P(0, &m), MODEL, 0), NO_RESULT))   \
    X(masu_model_animate, masu_model_animate(P(0, &m), MODEL, P(1, &clip_use), 1, P(2, &detail)))  \
    X(masu_model_morph_set, masu_model_morph_set(P(0, &m), MODEL, P(1, "up"), 1.0f, P(2, &detail))) \
    X(masu_punctual_light_find, ((void)masu_punctual_light_find(P(0, &m), P(1, "a")), NO_RESULT))  \
    X(masu_punctual_light_at, ((void)masu_punctual_light_at(P(0, &m), 0), NO_RESULT))              \
    X(masu_punctual_light_get, masu_punctual_light_get(P(0, &m), LIGHT, P(1, &light_state), P(2, &detail))) \
    X(masu_punctual_light_set, masu_punctual_light_set(P(0, &m), LIGHT, P(1, &light_state), P(2, &detail))) \
    X(masu_punctual_light_add,                                                                     \
      masu_punctual_light_add(P(0, &m), P(1, &light_state), P(2, &made_light), P(3, &detail)))                    \
    X(masu_punctual_light_remove, masu_punctual_light_remove(P(0, &m), LIGHT, P(1, &detail)))      \
    X(masu_material_find, ((void)masu_material_find(P(0, &m), P(1, "a")), NO_RESULT))              \
    X(masu_material_at, ((void)masu_material_at(P(0, &m), 0), NO_RESULT))                          \
    X(masu_material_get, masu_material_get(P(0, &m), (masu_material){1}, P(1, &material_state), P(2, &detail))) \
    X(masu_material_set, masu_material_set(P(0, &m), (masu_material){1}, P(1, &material_state), P(2, &detail))) \
    X(masu_texture_write, masu_texture_write(P(0, &m), 1, P(1, &rect), P(2, white), 0, P(3, &detail))) \
    X(masu_texture_image_of, masu_texture_image_of(P(0, &m), P(1, &texture_image), P(2, &detail))) \
    X(masu_lut_set, masu_lut_set(P(0, &m), P(1, white), 2, P(2, &detail)))                          \
    X(masu_stats, masu_stats(P(0, &m), 0, P(1, &stats), P(2, &detail)))                            \
    X(masu_peaks, (masu_peaks(P(0, &m), P(1, &peaks)), NO_RESULT))                                 \
    X(masu_readback, masu_readback(P(0, &m), 0, MASU_READBACK_DEPTH, P(1, &image), P(2, &detail))) \
    X(masu_pick, masu_pick(P(0, &m), 0, P(1, &pick), P(2, &detail)))                               \
    X(masu_unpack_normal, (masu_unpack_normal(0, P(0, unpacked)), NO_RESULT))

#define DEFINE_CALL(name, expression)                                                              \
    static int call_##name(int null) {                                                             \
        (void)null;                                                                                \
        return (int)(expression);                                                                  \
    }
CALLS(DEFINE_CALL)

static const struct {
    const char *name;
    int (*call)(int null);
} calls[] = {
#define CALL_ROW(name, expression) {#name, call_##name},
    CALLS(CALL_ROW)};
enum { CALL_COUNT = sizeof calls / sizeof *calls };

/* ---- Declarations of the header -------------------------------------------------------------- */

typedef struct parameter {
    char name[32];
} parameter;

typedef struct function {
    char name[64];
    int has_result;       /* it returns a masu_result */
    int pointers;         /* for its parameters, in order: */
    parameter parameter[PARAMETERS_MAX];
} function;

static char *header;

static int read_header(void **state) {
    static const char *const parts[] = {"include/masu.h", "include/masu_knobs.h",
                                        "include/masu_study.h"};
    size_t length = 0, room = (1 << 20) - 1;
    header = calloc(1, room + 1);
    if (!header || support_make_edge(state)) return -1;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        FILE *f = fopen(parts[i], "rb");
        size_t read = f ? fread(header + length, 1, room - length, f) : 0;
        if (f) fclose(f);
        if (!read) return -1;
        length += read;
    }
    return 0;
}

static int free_header(void **state) {
    (void)state;
    free(header);
    return 0;
}

/* The last identifier of a declaration, without an array size in brackets. */
static void last_word(const char *text, size_t length, char *to, size_t room) {
    const char *bracket = memchr(text, '[', length);
    if (bracket) length = (size_t)(bracket - text);
    while (length && !isalnum((unsigned char)text[length - 1])) length--;
    size_t start = length;
    while (start && (isalnum((unsigned char)text[start - 1]) || text[start - 1] == '_')) start--;
    assert_true(length - start < room);
    memcpy(to, text + start, length - start);
    to[length - start] = '\0';
}

/* Reads the declaration that begins at `at`; returns its end. */
static const char *read_function(const char *at, function *f) {
    const char *open = strchr(at, '('), *end = strchr(at, ';');
    assert_true(open && end && open < end);
    memset(f, 0, sizeof *f);
    last_word(at, (size_t)(open - at), f->name, sizeof f->name);
    const char *result = strstr(at, "masu_result ");
    f->has_result = result && result < open && !memchr(result, '*', (size_t)(open - result));
    for (const char *p = open + 1; p < end;) {
        size_t length = strcspn(p, ",;");
        if (memchr(p, '*', length) || memchr(p, '[', length)) {
            assert_true(f->pointers < PARAMETERS_MAX);
            parameter *to = &f->parameter[f->pointers++];
            last_word(p, length, to->name, sizeof to->name);
        }
        p += length + 1;
    }
    return end;
}

static int may_be_null(const char *parameter) {
    return !strcmp(parameter, "detail") || !strcmp(parameter, "progress") ||
           !strcmp(parameter, "viewports") || !strcmp(parameter, "rect") ||
           !strcmp(parameter, "from");
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void begin(void) {
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE | SUPPORT_LIGHTING, 0);
    while (masu_load(&m, &commands, &detail) == MASU_INCOMPLETE) continue;
    desc = scene_desc(0, 64, 64);
    desc.scene = &scene;
    assert_int_equal(masu_punctual_light_get(&m, LIGHT, &light_state, &detail), MASU_OK);
    memset(&detail, 0, sizeof detail);
}

static void call_with_null(const function *f, int row, int null) {
    begin();
    int result = calls[row].call(null);
    const char *name = f->parameter[null].name;
    char expected[64];
    if (!f->has_result || may_be_null(name)) return;
    if (result != MASU_ERROR_ARGUMENT && !(result == MASU_ERROR_MEMORY && !strcmp(name, "block")))
        fail_msg("%s with %s NULL: %d", f->name, name, result);
    snprintf(expected, sizeof expected, "%s is NULL", name);
    if (strcmp(f->parameter[f->pointers - 1].name, "detail") != 0)
        fail_msg("the last parameter of %s is not a masu_detail", f->name);
    if (!strstr(detail.text, expected))
        fail_msg("%s with %s NULL: \"%s\"", f->name, name, detail.text);
}

static void nothing_crashes_and_the_argument_is_named(void **state) {
    (void)state;
    int found = 0;
    for (const char *at = header; (at = strstr(at, "\nMASU_API ")) != NULL; found++) {
        function f;
        int row = 0;
        at = read_function(at, &f);
        while (row < CALL_COUNT && strcmp(calls[row].name, f.name)) row++;
        if (row == CALL_COUNT) fail_msg("%s has no row in CALLS", f.name);
        begin();
        (void)calls[row].call(-1);
        for (int null = 0; null < f.pointers; null++) call_with_null(&f, row, null);
    }
    assert_int_equal(found, CALL_COUNT);
}

static void what_has_nothing_to_tell_says_so(void **state) {
    (void)state;
    begin();
    memset(&peaks, 0xFF, sizeof peaks);
    masu_peaks(NULL, &peaks);
    assert_int_equal(peaks.instances, 0);
    assert_int_equal(peaks.device_bytes, 0);
    memset(&plan, 0xFF, sizeof plan);
    masu_plan_of(NULL, &plan);
    assert_int_equal(plan.pass_count, 0);
    assert_int_equal(plan.memory.host_bytes, 0);
    uint32_t count = masu_memory_report(&m, rows_of_memory, 2);
    assert_true(count > 2);
    assert_int_equal(masu_memory_report(&m, NULL, 1000), count); /* counted by itself */
    assert_int_equal(masu_memory_report(NULL, rows_of_memory, 2), 0);
    assert_true(masu_knob_get(NULL, &rung, 0) == 0.0);
    assert_int_equal(masu_knob_accepts(NULL, 0.0), 0);
    assert_int_equal(masu_scene_find(&(masu_scene){0}, MASU_SCENE_SDF_PARAM, "a"), -1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_crashes_and_the_argument_is_named),
        cmocka_unit_test(what_has_nothing_to_tell_says_so),
    };
    return cmocka_run_group_tests(tests, read_header, free_header);
}
