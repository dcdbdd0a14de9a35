/* test_upload.c: data that the host copies for the GPU: the scene, in chunks or at once, frames in
 * their slots, and moved instances. Without a GPU: see tests/support/dry_renderer.h. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "support/bind.h"
#include "device/bind.h"
#include "device/load.h"
#include "scene/scene.h"
#include "split_sum.h"
#include "api_stats.h"
#include "plan/plan.h"
#include "support/desc.h"
#include "support/dry_renderer.h"

static masu_detail failure; /* of the last call that failed */

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const float not_finite[] = {(float)NAN, (float)INFINITY, (float)-INFINITY};

/* ---- Loading --------------------------------------------------------------------------------- */

static void assert_resident(const unsigned char *vertices, const unsigned char *indices,
                            const unsigned char *materials, const unsigned char *slots) {
    masu_scene_view v = masu_scene_view_of(&scene);
    assert_memory_equal(vertices, v.vertices, 11 * sizeof *v.vertices);
    assert_memory_equal(indices, v.indices, 15 * sizeof *v.indices);
    const float expected[2][12] = {
        {0.5f, 0.25f, 1.0f, 0.4f, 0.0f, 0.0f, 0.0f, 0.9f, 0.5f, 0.0f, 0.0f, 1.0f},
        {0.0f, 0.0f, 0.0f, 1.0f, 4.0f, 2.0f, 1.0f, 0.0f, 0.5f, 0.0f, 0.0f, 1.0f}};
    assert_memory_equal(materials, expected, sizeof expected);
    assert_int_equal(v.slot_count, 3);
    assert_memory_equal(slots, v.slots, 3 * sizeof *v.slots);
}

static void mapped_memory_is_loaded_at_once(void **state) {
    (void)state;
    masu_commands commands;
    make_renderer(SUPPORT_ALL, 0);
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
    assert_null(commands.buffer);
    assert_resident(slot_bytes(MASU_BUFFER_VERTICES, 0), slot_bytes(MASU_BUFFER_INDICES, 0),
                    slot_bytes(MASU_BUFFER_MATERIALS, 0), slot_bytes(MASU_BUFFER_SLOTS, 0));
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK); /* again, without the blob */
}

/* Every size of staging buffer, including sizes that cut a vertex, an index or a material in
 * two. */
static void chunks_of_any_size_add_up_to_the_scene(void **state) {
    (void)state;
    static unsigned char copy[MASU_BUFFER_COUNT][4 * MASU_TABLE_WORDS];
    for (uint64_t staging = 5; staging <= 400; staging++) {
        masu_commands commands;
        uint32_t submitted = 0;
        make_renderer(SUPPORT_ALL, staging);
        memset(copy, NOISE, sizeof copy);
        while (masu_load(&m, &commands, &failure) == MASU_INCOMPLETE) {
            masu_chunk chunk = masu_load_chunk(&m.plan, submitted);
            assert_ptr_equal(commands.buffer, loads[submitted]);
            assert_true(chunk.bytes > 0 && chunk.bytes <= staging);
            assert_true(chunk.buffer <= MASU_BUFFER_MATERIALS ||
                        chunk.buffer == MASU_BUFFER_SLOTS || chunk.buffer == MASU_BUFFER_TABLES);
            assert_true(chunk.offset + chunk.bytes <= m.plan.buffers[chunk.buffer].bytes);
            memcpy(copy[chunk.buffer] + chunk.offset, slot_bytes(MASU_BUFFER_STAGING, 0),
                   (size_t)chunk.bytes);
            unsigned char *behind = memory[MASU_ROLE_UPLOAD];
            behind += m.plan.buffers[MASU_BUFFER_STAGING].offset + staging;
            for (int k = 0; k < 64; k++) assert_int_equal(behind[k], NOISE);
            submitted++;
        }
        assert_int_equal(submitted, m.device.load_count);
        assert_resident(copy[MASU_BUFFER_VERTICES], copy[MASU_BUFFER_INDICES],
                        copy[MASU_BUFFER_MATERIALS], copy[MASU_BUFFER_SLOTS]);
        assert_memory_equal(copy[MASU_BUFFER_TABLES], masu_split_sum, 4 * MASU_TABLE_WORDS);
        assert_int_equal(masu_load_chunk(&m.plan, submitted).bytes, 0);
    }
}

/* Also for mapped memory: any limit, including one that cuts a vertex in two, and the reported
 * progress. */
static void steps_of_any_size_add_up_to_the_scene(void **state) {
    (void)state;
    static unsigned char at_once[ROOM];
    masu_commands commands;
    /* whose atlas is cleared by a separate step */
    const masu_rung rung = {.local_shadows = MASU_OFF};
    make_renderer_with(SUPPORT_ALL | SUPPORT_LIGHTING, 0, &rung, 1);
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
    memcpy(at_once, memory[MASU_ROLE_DEVICE], ROOM);
    uint64_t all = commands.load_bytes;
    assert_true(all > 11 * sizeof(masu_blob_vertex) + 4 * MASU_TABLE_WORDS);
    assert_int_equal(commands.load_left, 0);
    for (uint64_t step = 1; step <= all + 1; step += step < 100 ? 1 : 3001) {
        uint64_t sum = 0, calls = 0;
        masu_result result;
        make_renderer_with(SUPPORT_ALL | SUPPORT_LIGHTING, 0, &rung, 1);
        m.plan.desc.load_step = step;
        do {
            result = masu_load(&m, &commands, &failure);
            sum += commands.load_bytes;
            calls++;
            assert_null(commands.buffer);
            assert_int_equal(commands.part_count, 0);
            assert_true(commands.load_bytes <= step);
            assert_int_equal(commands.load_left, all - sum);
            assert_true(calls <= all / step + 1);
        } while (result == MASU_INCOMPLETE);
        assert_int_equal(result, MASU_OK);
        assert_int_equal(sum, all);
        assert_memory_equal(memory[MASU_ROLE_DEVICE], at_once, ROOM);
    }
}

/* The grid of light probes, its data, and a rest of only zeros. */
static void chunks_of_probes_add_up_to_grid_data_and_room(void **state) {
    (void)state;
    static unsigned char copy[4096];
    for (uint64_t staging = 61; staging <= 2048; staging += 97) {
        masu_commands commands;
        uint32_t submitted = 0;
        make_renderer(SUPPORT_ALL | SUPPORT_LIGHTING, staging);
        masu_scene_view v = masu_scene_view_of(&scene);
        uint64_t bytes = m.plan.buffers[MASU_BUFFER_PROBES].bytes, data = v.probe_words * 4;
        assert_int_equal(v.probe_words, 74);
        assert_int_equal(bytes, sizeof *v.probes + (76 + 2 * MASU_PROBE_LIT_WORDS) * 4);
        memset(copy, NOISE, sizeof copy);
        while (masu_load(&m, &commands, &failure) == MASU_INCOMPLETE) {
            masu_chunk chunk = masu_load_chunk(&m.plan, submitted++);
            if (chunk.buffer != MASU_BUFFER_PROBES) continue;
            memcpy(copy + chunk.offset, slot_bytes(MASU_BUFFER_STAGING, 0), (size_t)chunk.bytes);
        }
        assert_memory_equal(copy, v.probes, sizeof *v.probes);
        assert_memory_equal(copy + sizeof *v.probes, v.probe_data, (size_t)data);
        for (uint64_t i = sizeof *v.probes + data; i < bytes; i++) assert_int_equal(copy[i], 0);
        assert_int_equal(copy[bytes], NOISE);
    }
}

static void without_a_scene_there_is_nothing_to_load(void **state) {
    (void)state;
    masu_commands commands;
    make_renderer(SUPPORT_ALL, 0);
    memset(memory, NOISE, sizeof memory);
    m.plan.desc.scene = NULL;
    masu_copy_scene(&m);
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
    for (size_t i = 0; i < ROOM; i++) assert_int_equal(memory[MASU_ROLE_DEVICE][i], NOISE);
    assert_int_equal(masu_load(NULL, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_load(&m, NULL, &failure), MASU_ERROR_ARGUMENT);
}

static void the_blob_is_not_looked_at_after_loading(void **state) {
    (void)state;
    masu_commands commands;
    make_renderer(SUPPORT_ALL, 0);
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
    assert_null(m.plan.scene.blob);
    masu_frame_desc f = {MASU_FRAME_DESC, .rung = 1, .target = 1};
    assert_int_equal(masu_frame(&m, &f, &commands, &failure), MASU_OK);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static void frames_take_their_slots_in_turn(void **state) {
    (void)state;
    masu_commands commands;
    make_renderer(SUPPORT_ALL, 0);
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
    for (uint32_t n = 0; n < 7; n++) {
        masu_frame_desc f = {MASU_FRAME_DESC, .rung = n % 3, .target = n % 2, .time = n};
        assert_int_equal(masu_frame(&m, &f, &commands, &failure), MASU_OK);
        assert_int_equal(commands.frame, n);
        assert_int_equal(commands.slot, n % 2);
        assert_int_equal(commands.rung, n % 3);
        assert_ptr_equal(commands.buffer, frames[(n % 2 * 3 + n % 3) * 2 + n % 2]);
        assert_true((double)uniforms(n % 2).eye_hi[3] == (double)n);
    }
}

static void a_frame_that_is_refused_changes_nothing(void **state) {
    (void)state;
    static unsigned char before[ROOM];
    masu_commands commands, untouched;
    make_renderer(SUPPORT_ALL, 0);
    masu_frame_desc f = {MASU_FRAME_DESC, .rung = 0};
    assert_int_equal(masu_frame(&m, &f, &commands, &failure), MASU_ERROR_STATE);
    assert_string_equal(failure.what, "masu_load");
    assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
    assert_int_equal(masu_frame(&m, &f, &commands, &failure), MASU_OK);
    memcpy(before, memory[MASU_ROLE_UPLOAD], ROOM);
    memset(&commands, 0x5A, sizeof commands);
    untouched = commands;
    masu_camera camera = {.forward = {1.0f, 0.0f, 0.0f}, .fov_y = (float)NAN};
    const masu_frame_desc bad[] = {
        {MASU_FRAME_DESC, .rung = 3},
        {MASU_FRAME_DESC, .rung = UINT32_MAX},
        {MASU_FRAME_DESC, .target = 2},
        {MASU_FRAME_DESC, .time = (double)NAN},
        {MASU_FRAME_DESC, .time_step = (float)INFINITY},
        {MASU_FRAME_DESC, .camera = &camera},
        {.bytes = 0},
        {.bytes = sizeof(masu_frame_desc) - 8}};
    static const char *const names[] = {"rung",      "rung",         "target", "time",
                                        "time_step", "camera.fov_y", "bytes",  "bytes"};
    for (size_t i = 0; i < COUNT(bad); i++) {
        assert_int_equal(masu_frame(&m, &bad[i], &commands, &failure), MASU_ERROR_ARGUMENT);
        assert_string_equal(failure.what, names[i]);
        if (!strcmp(names[i], "bytes")) {
            assert_int_equal(failure.needed, sizeof(masu_frame_desc));
            assert_int_equal(failure.given, bad[i].bytes);
        }
        assert_memory_equal(memory[MASU_ROLE_UPLOAD], before, ROOM);
        assert_memory_equal(&commands, &untouched, sizeof commands);
    }
    assert_int_equal(masu_frame(NULL, &f, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_frame(&m, NULL, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_frame(&m, &f, NULL, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_frame(&m, &f, &commands, &failure), MASU_OK);
    assert_int_equal(commands.frame, 1);
}

/* ---- Instances ------------------------------------------------------------------------------- */

static void write_instances(uint32_t slot) {
    masu_frame_data f = begin_frame(&(masu_frame_desc){MASU_FRAME_DESC, .rung = 0}, slot);
    f.cut = 0;
    masu_instances_write(&m.instances, &f);
}

static void instances_are_found_by_name(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    assert_int_equal(masu_instance_find(&m, "plate").id, masu_instance_at(&m, 0).id);
    assert_int_equal(masu_instance_find(&m, "lid").id, masu_instance_at(&m, 2).id);
    assert_int_equal(masu_instance_at(&m, 3).id, 0);
    assert_int_equal(masu_instance_find(&m, "steel").id, 0);
    assert_int_equal(masu_instance_find(&m, "").id, 0);
    assert_int_equal(masu_instance_find(&m, NULL).id, 0);
    assert_int_equal(masu_instance_find(NULL, "plate").id, 0);
}

static void a_moved_instance_reaches_every_slot_once(void **state) {
    (void)state;
    const uint64_t size = sizeof(struct masu_instance_data);
    static const float rows[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    make_renderer(SUPPORT_ALL, 0);
    masu_scene_view v = masu_scene_view_of(&scene);
    for (uint32_t slot = 0; slot < 2; slot++) { /* all, at first */
        write_instances(slot);
        for (uint32_t i = 0; i < 3; i++) {
            assert_memory_equal(slot_bytes(MASU_BUFFER_INSTANCES, slot) + i * size,
                                v.instances[i].transform, size);
        }
    }
    assert_int_equal(masu_instance_set_transform(&m, masu_instance_at(&m, 1), rows, &failure),
                     MASU_OK);
    for (uint32_t frame = 0; frame < 4; frame++) { /* slots alternate */
        unsigned char *to = masu_buffer_pointer(&m.device, MASU_BUFFER_INSTANCES, frame % 2);
        memset(to, NOISE, 3 * size);
        write_instances(frame % 2);
        if (frame < 2) {
            assert_memory_equal(to + size, rows, size);
        } else {
            assert_int_equal(to[size], NOISE); /* both have it */
        }
        assert_int_equal(to[0], NOISE); /* the others are unchanged */
        assert_int_equal(to[2 * size], NOISE);
    }
}

/* With three frames in flight too. With velocities one frame more, or the last slot would still
 * report motion. */
static void a_moved_instance_reaches_as_many_slots_as_there_are(void **state) {
    (void)state;
    static const float rows[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    for (uint32_t flight = 1; flight <= MASU_MAX_FLIGHT; flight++) {
        for (uint32_t velocity = 0; velocity < 2; velocity++) {
            make_renderer(SUPPORT_ALL, 0);
            m.plan.desc.frames_in_flight = flight;
            m.plan.needs.velocity = velocity;
            m.plan.buffers[MASU_BUFFER_INSTANCES].stride =
                2 * 4 * sizeof(struct masu_instance_data);
            masu_scene_view v = masu_scene_view_of(&scene);
            masu_instances_copy_scene(&m.instances, &m.plan, &v);
            for (uint32_t n = 0; n < flight + velocity; n++) {
                assert_int_equal(m.instances.dirty_count, 3);
                write_instances(0);
            }
            assert_int_equal(m.instances.dirty_count, 0);
            masu_instances_place(&m.instances, &m.plan, 1, rows);
            for (uint32_t n = 0; n < flight + velocity; n++) {
                assert_int_equal(m.instances.dirty_count, 1);
                write_instances(0);
            }
            assert_int_equal(m.instances.dirty_count, 0);
        }
    }
}

static void moving_twice_before_a_frame_keeps_the_last(void **state) {
    (void)state;
    float rows[12] = {0};
    make_renderer(SUPPORT_ALL, 0);
    for (uint32_t slot = 0; slot < 2; slot++) write_instances(slot);
    for (int n = 1; n <= 5; n++) {
        rows[3] = (float)n;
        assert_int_equal(masu_instance_set_transform(&m, masu_instance_at(&m, 2), rows, &failure),
                         MASU_OK);
    }
    for (uint32_t slot = 0; slot < 2; slot++) {
        struct masu_instance_data got;
        write_instances(slot);
        memcpy(&got, slot_bytes(MASU_BUFFER_INSTANCES, slot) + 2 * sizeof got, sizeof got);
        assert_true(got.row0[3] == 5.0f);
    }
    assert_int_equal(m.instances.dirty_count, 0);
}

static void a_bad_instance_or_transform_is_refused(void **state) {
    (void)state;
    static const float good[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    make_renderer(SUPPORT_ALL, 0);
    for (uint32_t slot = 0; slot < 2; slot++) write_instances(slot);
    const uint64_t first = masu_instance_at(&m, 0).id;
    const uint64_t ids[] = {0, first - 1, first + 3, first + (1u << 31), first + (1ull << 32)};
    for (size_t i = 0; i < COUNT(ids); i++) {
        assert_int_equal(masu_instance_set_transform(&m, (masu_instance){ids[i]}, good, &failure),
                         MASU_ERROR_ARGUMENT);
        assert_string_equal(failure.what, "instance");
    }
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 12; k++) {
            float bad[12];
            memcpy(bad, good, sizeof bad);
            bad[k] = not_finite[i];
            assert_int_equal(
                masu_instance_set_transform(&m, masu_instance_at(&m, 0), bad, &failure),
                MASU_ERROR_ARGUMENT);
            assert_int_equal(failure.given, k);
        }
    }
    assert_int_equal(masu_instance_set_transform(&m, masu_instance_at(&m, 0), NULL, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_set_transform(NULL, masu_instance_at(&m, 0), good, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(m.instances.dirty_count, 0);
}

/* ---- Times ----------------------------------------------------------------------------------- */

/* A counter of few bits, from just below its maximum to just beyond. */
/* Whether the last of 40 frames looks for changes, each `step` seconds after the previous one. Nothing
 * else changes: it has been at rest for longer than changes are looked for. */
static int looks_for_changes(uint32_t parts, double step) {
    masu_rung rung = {.scale = 0.5f, .temporal = MASU_ON, .lod_error = -1.0f};
    make_renderer_with(parts, 0, &rung, 1);
    masu_camera camera = {
        .position = {0, 1, 5}, .forward = {0, 0, -1}, .fov_y = 1, .near_distance = 0.1f};
    for (uint32_t n = 0; n < 40; n++) {
        masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .time = 1 + n * step};
        (void)write_good(&f, n % 2);
        m.timeline.frame++;
    }
    return (uniforms(1).temporal[2] & MASU_TEMPORAL_CHANGES) != 0;
}

/* An SDF that only time changes: no transform, parameter or light tells of it. */
static void temporal_upscaling_is_told_of_an_sdf_that_time_changes(void **state) {
    (void)state;
    assert_false(looks_for_changes(SUPPORT_SDF, 0));
    assert_true(looks_for_changes(SUPPORT_SDF, 0.02));
    assert_false(looks_for_changes(SUPPORT_RASTER, 0.02));
}

/* The instances of the mesh with a LOD are in several views: the LOD does not depend on the view. */
static void an_lod_is_chosen_once_for_all_views(void **state) {
    (void)state;
    masu_rung rung = {.scale = 1.0f, .lod_error = 1.0f};
    make_renderer_with(SUPPORT_RASTER | SUPPORT_SHADOW | SUPPORT_DETAIL, 0, &rung, 1);
    masu_camera camera = {
        .position = {0, 1, 5}, .forward = {0, 0, -1}, .fov_y = 1, .near_distance = 0.1f};
    masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera};
    (void)write_good(&f, 0);
    uint32_t instances = 0, listed = 0;
    for (uint32_t b = 0; b < m.draws.batch_count; b++) {
        if (m.draws.batches[b].lod_count) instances += m.draws.batches[b].instance_count;
    }
    for (uint32_t view = 0; view < m.plan.views; view++)
        listed += m.visible.slot_views[0][view].instances;
    print_message("  %u instances with LODs, %u in lists\n", instances, listed);
    assert_true(m.plan.views > 1 && instances && listed > m.plan.scene.instances);
    assert_int_equal(m.visible.levels_chosen, instances);
}

static void times_of_a_clock_that_wraps_are_right(void **state) {
    (void)state;
    masu_commands commands;
    masu_governor_sample sample;
    masu_stats_info stats;
    static const uint32_t bits[] = {32, 36, 48, 63, 64};
    for (size_t i = 0; i < COUNT(bits); i++) {
        make_renderer(SUPPORT_ALL, 0);
        m.plan.desc.debug.timestamps = 1;
        m.plan.readback_times = 0;
        m.device.queries = FAKE(VkQueryPool, 1);
        m.device.vk.queue_family.timestampValidBits = bits[i];
        m.plan.buffers[MASU_BUFFER_READBACK].bytes = m.plan.buffers[MASU_BUFFER_READBACK].stride =
            4096;
        m.device.vk.properties.limits.timestampPeriod = 2.0f;
        assert_int_equal(masu_load(&m, &commands, &failure), MASU_OK);
        assert_int_equal(
            masu_frame(&m, &(masu_frame_desc){MASU_FRAME_DESC, .rung = 0}, &commands, &failure),
            MASU_OK);
        uint64_t *stamps =
            (uint64_t *)(void *)masu_buffer_pointer(&m.device, MASU_BUFFER_READBACK, commands.slot);
        uint64_t mask = bits[i] == 64 ? UINT64_MAX : (UINT64_C(1) << bits[i]) - 1;
        uint32_t count = masu_stamps(&m.plan.desc);
        assert_true(count > 2);
        assert_false(masu_slot_sample(&m, commands.slot, &sample)); /* not ended */
        for (uint32_t k = 0; k < count; k++) stamps[k] = (mask - 999 + 500 * (uint64_t)k) & mask;
        assert_true(masu_slot_sample(&m, commands.slot, &sample));
        assert_true(fabs(sample.gpu_ms - 500.0 * (count - 1) * 2.0 * 1e-6) < 1e-9);
        assert_int_equal(masu_stats(&m, commands.slot, &stats, &failure), MASU_OK);
        assert_true(stats.timed);
        assert_int_equal(stats.gpu_ns, 1000 * (count - 1));
        for (uint32_t k = 0; k + 1 < count; k++)
            assert_true(stats.pass_ns[k] == 0 || stats.pass_ns[k] == 1000);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mapped_memory_is_loaded_at_once),
        cmocka_unit_test(chunks_of_any_size_add_up_to_the_scene),
        cmocka_unit_test(steps_of_any_size_add_up_to_the_scene),
        cmocka_unit_test(chunks_of_probes_add_up_to_grid_data_and_room),
        cmocka_unit_test(without_a_scene_there_is_nothing_to_load),
        cmocka_unit_test(the_blob_is_not_looked_at_after_loading),
        cmocka_unit_test(frames_take_their_slots_in_turn),
        cmocka_unit_test(a_frame_that_is_refused_changes_nothing),
        cmocka_unit_test(instances_are_found_by_name),
        cmocka_unit_test(a_moved_instance_reaches_every_slot_once),
        cmocka_unit_test(a_moved_instance_reaches_as_many_slots_as_there_are),
        cmocka_unit_test(temporal_upscaling_is_told_of_an_sdf_that_time_changes),
        cmocka_unit_test(an_lod_is_chosen_once_for_all_views),
        cmocka_unit_test(times_of_a_clock_that_wraps_are_right),
        cmocka_unit_test(moving_twice_before_a_frame_keeps_the_last),
        cmocka_unit_test(a_bad_instance_or_transform_is_refused),
    };
    return cmocka_run_group_tests_name("upload", tests, support_make_edge, NULL);
}
