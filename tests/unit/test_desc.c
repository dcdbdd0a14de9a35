/* test_desc.c: descriptions: the defaults for zeros, rejected descriptions and the member that the
 * error names, and errors of the public functions that need no device. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "settings/knobs.h"
#include "frame/transparents.h"
#include "plan/compile.h"
#include "quality/governor_desc.h"
#include "scene/blob.h"
#include "plan/desc.h"
#include "support/desc.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void compile(const masu_desc *d, masu_frame_plan *plan) {
    masu_detail detail, before;
    memset(&detail, 0x5A, sizeof detail);
    before = detail;
    masu_result result = masu_compile(d, 256, 64, plan, &detail);
    if (result) fail_msg("rejected: %s", detail.text);
    assert_memory_equal(&detail, &before, sizeof detail); /* unchanged by success */
}

static void assert_refused(const masu_desc *d, masu_result expected, const char *what) {
    static masu_frame_plan plan;
    masu_detail detail;
    memset(&detail, 0x5A, sizeof detail);
    masu_result result = masu_compile(d, 256, 64, &plan, &detail);
    if (result != expected) fail_msg("%s: the result is %d, not %d", what, result, expected);
    assert_int_equal(detail.result, expected);
    assert_int_equal(detail.vulkan, VK_SUCCESS);
    assert_string_equal(detail.what, what);
    assert_non_null(memchr(detail.text, '\0', sizeof detail.text));
    assert_true(strlen(detail.text) > 10 && !strchr(detail.text, '\n'));
    assert_int_equal(masu_compile(d, 256, 64, &plan, NULL), expected);
}

/* ---- Defaults -------------------------------------------------------------------------------- */

#define SAME(field) assert_true(a->field == b->field)

static void assert_same_desc(const masu_desc *a, const masu_desc *b) {
    SAME(vulkan.get_instance_proc_addr);
    SAME(vulkan.instance);
    SAME(vulkan.physical_device);
    SAME(vulkan.device);
    SAME(vulkan.queue_family);
    SAME(vulkan.allocator);
    SAME(vulkan.pipeline_cache);
    SAME(scene);
    SAME(source.view);
    SAME(source.width);
    SAME(source.height);
    SAME(source.format);
    SAME(output.width);
    SAME(output.height);
    SAME(targets.images);
    SAME(targets.views);
    SAME(targets.count);
    SAME(targets.format);
    SAME(targets.storage);
    SAME(targets.final_layout);
    SAME(targets.encoding);
    SAME(targets.white);
    SAME(targets.peak);
    SAME(tone);
    SAME(dither);
    SAME(deep_color);
    SAME(exposure.metered);
    SAME(exposure.brighten);
    SAME(exposure.darken);
    SAME(exposure.low);
    SAME(exposure.high);
    SAME(exposure.min);
    SAME(exposure.max);
    SAME(frames_in_flight);
    SAME(rung_count);
    for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++) {
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            if (masu_knob_differs(k, &a->rungs[r], &b->rungs[r]))
                fail_msg("rungs[%u].%s differs", r, k->name);
        }
        SAME(flips[r]);
        SAME(governor.costs[r]);
    }
    SAME(ladder);
#define SAME_LIMIT(name, ...) SAME(limits.name);
    MASU_LIMITS(SAME_LIMIT)
    SAME(reserve.models);
    SAME(reserve.lights);
    SAME(mutable_materials);
    SAME(double_positions);
    SAME(vulkan.texture_compression_bc);
    SAME(vulkan.max_anisotropy);
    SAME(vulkan.ray_query);
    SAME(vulkan.shader_float16);
    SAME(ray_query);
    SAME(half_floats);
    SAME(deny.compressed_textures);
    SAME(reserve.particles);
    SAME(reserve.decals);
    SAME(reserve.lines);
    SAME(reserve.trail_points);
    SAME(reserve.textures);
    SAME(reserve.texture_size.width);
    SAME(reserve.texture_size.height);
    SAME(reserve.texture_bytes);
    SAME(reserve.mesh_upload);
    for (uint32_t k = 0; k < MASU_MAX_MESH_KINDS; k++) {
        SAME(reserve.meshes[k].meshes);
        SAME(reserve.meshes[k].material);
        SAME(reserve.meshes[k].vertices);
        SAME(reserve.meshes[k].triangles);
    }
    SAME(host_budget);
    SAME(device_budget);
    for (uint32_t k = 0; k < MASU_ROLE_COUNT; k++) {
        SAME(device_blocks[k].memory);
        SAME(device_blocks[k].offset);
        SAME(device_blocks[k].bytes);
        SAME(device_blocks[k].mapped);
        SAME(device_blocks[k].memory_type);
    }
    SAME(readback);
    SAME(picking);
    SAME(load_step);
    SAME(init_in_steps);
    SAME(first_rung);
    SAME(debug.timestamps);
    SAME(debug.counters);
    SAME(debug.labels);
    SAME(debug.poison);
    SAME(debug.casters);
    SAME(debug.ao_full);
    SAME(debug.all_terms);
    SAME(debug.share_rays);
    SAME(debug.no_bias);
    SAME(debug.reference);
    SAME(debug.mip_bias);
    SAME(deny.unified_memory);
    SAME(deny.unorm16);
    SAME(deny.easu_twice);
    SAME(deny.image_size);
    SAME(deny.storage_buffers);
    SAME(deny.color_attachments);
    SAME(log);
    SAME(log_user);
    SAME(clock_ns);
    SAME(clock_user);
}

/* Values that depend on the scene or on sizes are not yet resolved. */
static masu_rung default_rung(float scale, float sharpness) {
    return (masu_rung){.scale = scale,
                       .easu = MASU_EASU_FULL,
                       .sharpness = sharpness,
                       .aa = MASU_AA_OFF,
                       .temporal = MASU_OFF,
                       .silhouettes = MASU_OFF,
                       .frustum = MASU_ON,
                       .ao = MASU_ON,
                       .light_tiles = MASU_ON,
                       .local_shadows = MASU_ON,
                       .local_shadow_atlas = 2048,
                       .local_shadow_lights = 16,
                       .local_shadow_faces = 4,
                       .specular_reuse = MASU_ON,
                       .specular_temporal = MASU_ON,
                       .specular_fine = MASU_ON,
                       .specular_filter = MASU_ON,
                       .specular_taa = MASU_ON,
                       .march_steps = 2048,
                       .lod_error = 1.0f,
                       .ao_slices = 2,
                       .ao_steps = 8,
                       .shadow_refresh = {1, 1, 1, 1},
                       .specular_reuse_taps = 8,
                       .specular_filter_taps = 12,
                       .specular_frames = 32,
                       .bounce_probes = 94,
                       .bounce_rays = 48};
}

/* Without a scene, no further member of the output is resolved. */
static void default_output(masu_desc *d) { d->tone = MASU_TONE_ACES; }

static void every_zero_becomes_its_documented_default(void **state) {
    (void)state;
    masu_desc zero, expected;
    memset(&zero, 0, sizeof zero);
    memset(&expected, 0, sizeof expected);
    expected.targets.format = VK_FORMAT_R8G8B8A8_UNORM;
    expected.targets.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    default_output(&expected);
    expected.frames_in_flight = 2;
    expected.rung_count = 3;
    expected.ladder = MASU_OFF;
    expected.rungs[0] = default_rung(1.0f, 0.2f);
    expected.rungs[1] = default_rung(0.8f, 0.2f);
    expected.rungs[2] = default_rung(0.4f, 0.2f);
    masu_desc resolved = masu_desc_resolved(&zero);
    assert_same_desc(&resolved, &expected);
    resolved = masu_desc_resolved(NULL);
    assert_same_desc(&resolved, &expected);
}

static void zeros_inside_given_rungs_become_defaults_too(void **state) {
    (void)state;
    masu_desc given;
    memset(&given, 0, sizeof given);
    given.rung_count = 2;
    given.rungs[1] = (masu_rung){.sharpness = 1.5f};
    masu_desc expected = masu_desc_resolved(&given);
    given.frames_in_flight = 2;
    given.ladder = MASU_OFF;
    given.targets.format = VK_FORMAT_R8G8B8A8_UNORM;
    given.targets.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    default_output(&given);
    given.rungs[0] = default_rung(1.0f, 0.2f);
    given.rungs[1] = default_rung(1.0f, 1.5f);
    assert_same_desc(&expected, &given); /* rungs 2 to 7 remain zero */
}

static PFN_vkVoidFunction VKAPI_CALL no_function(VkInstance instance, const char *name) {
    (void)instance, (void)name;
    return NULL;
}

static void no_log(void *user, masu_log_level level, const char *text) {
    (void)user, (void)level, (void)text;
}

static uint64_t no_clock(void *user) {
    (void)user;
    return 0;
}

/* Not 0, and accepted. */
static double some_value(const masu_knob *k, uint32_t n) {
    double floor_ = k->kind == MASU_KNOB_FLOAT || k->min > 1.0 ? k->min : 1.0;
    double value = k->kind == MASU_KNOB_FLOAT ? floor_ + (k->max - floor_) * (n + 1) / 17.0
                                              : floor_ + n % (uint32_t)(k->max - floor_ + 1.0);
    assert_true(masu_knob_accepts(k, value) && value != 0.0);
    return value;
}

static masu_desc full_desc(void) {
    static VkAllocationCallbacks allocator;
    static masu_pipelines pool;
    masu_desc d = scene_desc(RASTER, 320, 200);
    d.vulkan = (masu_vulkan){
        no_function, FAKE(VkInstance, 1), FAKE(VkPhysicalDevice, 2), FAKE(VkDevice, 3),
        1,           &allocator,          FAKE(VkPipelineCache, 4),  1,
        4.0f,        1,                   1,                         &pool};
    d.source = (masu_source){FAKE(VkImageView, 5), 6, 7, VK_FORMAT_R8G8B8A8_UNORM};
    d.targets.format = VK_FORMAT_B8G8R8A8_UNORM;
    d.targets.storage = 8;
    d.targets.final_layout = VK_IMAGE_LAYOUT_GENERAL;
    d.targets.encoding = MASU_ENCODING_PQ;
    d.targets.white = 100, d.targets.peak = 600;
    d.tone = MASU_TONE_NEUTRAL;
    d.dither = MASU_ON;
    d.deep_color = MASU_ON;
    d.exposure = (masu_exposure){MASU_ON, 2, 4, 0.2f, 0.3f, 0.25f, 4};
    d.frames_in_flight = 3;
    d.rung_count = MASU_MAX_RUNGS;
    d.ladder = MASU_ON;
    for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++) {
        d.flips[r] = 0.1f * (float)r;
        d.governor.costs[r] = 1.0f + (float)r;
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            for (uint32_t i = 0; i < k->values; i++)
                masu_knob_set(k, &d.rungs[r], i, some_value(k, r + i));
        }
    }
    uint64_t limit = 9;
#define SET_LIMIT(name, ...) d.limits.name = limit++;
    MASU_LIMITS(SET_LIMIT)
    d.reserve = (masu_reserve){.models = 12, .lights = 13};
    d.mutable_materials = 1;
    d.double_positions = 1;
    d.host_budget = 14;
    d.device_budget = 15;
    for (uint32_t k = 0; k < MASU_ROLE_COUNT; k++) {
        d.device_blocks[k] = (masu_device_block){FAKE(VkDeviceMemory, 6 + k), 16, 17, &d, 18 + k};
    }
    d.readback = 3;
    d.picking = 1;
    d.load_step = MASU_LOAD_STEP_MIN + 1;
    d.debug = (masu_debug){1, 2, 3, 4, 5, 6, 7, MASU_ON, 9, 10, 11, 12.0f};
    d.deny.unified_memory = 1;
    d.log = no_log;
    d.log_user = &allocator;
    d.clock_ns = no_clock;
    d.clock_user = &allocator;
    return d;
}

/* Each format that is offered: bits of red, green and blue, to whose steps the last pass rounds. */
static void each_format_has_its_steps(void **state) {
    (void)state;
    static const struct {
        VkFormat format;
        uint32_t bits[3]; /* 0: no rounding */
        int deep;
    } rows[] = {{VK_FORMAT_R8G8B8A8_UNORM, {8, 8, 8}, 0},
                {VK_FORMAT_B8G8R8A8_UNORM, {8, 8, 8}, 0},
                {VK_FORMAT_A8B8G8R8_UNORM_PACK32, {8, 8, 8}, 0},
                {VK_FORMAT_R8G8B8A8_SRGB, {8, 8, 8}, 0},
                {VK_FORMAT_B8G8R8A8_SRGB, {8, 8, 8}, 0},
                {VK_FORMAT_A8B8G8R8_SRGB_PACK32, {8, 8, 8}, 0},
                {VK_FORMAT_A2B10G10R10_UNORM_PACK32, {10, 10, 10}, 1},
                {VK_FORMAT_A2R10G10B10_UNORM_PACK32, {10, 10, 10}, 1},
                {VK_FORMAT_R5G6B5_UNORM_PACK16, {5, 6, 5}, 0},
                {VK_FORMAT_B5G6R5_UNORM_PACK16, {5, 6, 5}, 0},
                {VK_FORMAT_R16G16B16A16_UNORM, {0, 0, 0}, 1},
                {VK_FORMAT_R16G16B16A16_SFLOAT, {0, 0, 0}, 1}};
    static masu_frame_plan plan;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        masu_desc d = scene_desc(RASTER, 64, 64);
        d.targets.format = rows[i].format, d.targets.storage = 0;
        d.targets.views = NULL;
        masu_desc resolved = masu_desc_resolved(&d);
        assert_int_equal(resolved.deep_color == MASU_ON, rows[i].deep);
        assert_int_equal(resolved.dither == MASU_ON, !rows[i].deep);
        compile(&d, &plan);
        for (int c = 0; c < 3; c++)
            assert_int_equal(plan.output.steps[c], (1u << rows[i].bits[c]) - 1);
    }
}

/* Defaults that follow from the target and the scene. */
static void output_follows_from_target_and_scene(void **state) {
    (void)state;
    static const struct {
        VkFormat format;
        uint32_t storage;
        masu_switch dither, deep;
        masu_encoding encoding;
    } rows[] = {
        {VK_FORMAT_R8G8B8A8_UNORM, 1, MASU_OFF, MASU_OFF, MASU_ENCODING_SRGB},
        {VK_FORMAT_R8G8B8A8_UNORM, 0, MASU_ON, MASU_OFF, MASU_ENCODING_SRGB},
        {VK_FORMAT_B8G8R8A8_SRGB, 0, MASU_ON, MASU_OFF, MASU_ENCODING_SRGB},
        {VK_FORMAT_R5G6B5_UNORM_PACK16, 0, MASU_ON, MASU_OFF, MASU_ENCODING_SRGB},
        {VK_FORMAT_A2B10G10R10_UNORM_PACK32, 0, MASU_OFF, MASU_ON, MASU_ENCODING_SRGB},
        {VK_FORMAT_R16G16B16A16_SFLOAT, 1, MASU_OFF, MASU_ON, MASU_ENCODING_LINEAR}};
    static masu_frame_plan plan;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        masu_desc d = scene_desc(RASTER, 64, 64);
        d.targets.format = rows[i].format, d.targets.storage = rows[i].storage;
        masu_desc resolved = masu_desc_resolved(&d);
        assert_int_equal(resolved.dither, rows[i].dither);
        assert_int_equal(resolved.deep_color, rows[i].deep);
        assert_int_equal(resolved.targets.encoding, rows[i].encoding);
        compile(&d, &plan);
        int deep = rows[i].deep == MASU_ON;
        VkFormat wanted = deep ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_A2B10G10R10_UNORM_PACK32;
        VkFormat stored = deep ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32_UINT;
        VkFormat last = deep ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R8G8B8A8_UNORM;
        static const masu_image_id between[] = {MASU_IMAGE_LDR, MASU_IMAGE_SMOOTH,
                                                MASU_IMAGE_UPSCALED};
        for (size_t k = 0; k < sizeof between / sizeof *between; k++) {
            assert_int_equal(masu_plan_format(&plan, between[k]), wanted);
            assert_int_equal(masu_plan_store_format(&plan, between[k]), stored);
        }
        VkFormat mean = rows[i].encoding == MASU_ENCODING_SRGB ? VK_FORMAT_R16G16B16A16_UNORM
                                                               : VK_FORMAT_R16G16B16A16_SFLOAT;
        assert_int_equal(masu_plan_format(&plan, MASU_IMAGE_HISTORY), mean);
        assert_int_equal(masu_plan_store_format(&plan, MASU_IMAGE_HISTORY), VK_FORMAT_R32G32_UINT);
        assert_int_equal(masu_plan_format(&plan, MASU_IMAGE_FINAL), last);
        assert_int_equal(masu_plan_store_format(&plan, MASU_IMAGE_FINAL), last);
        assert_int_equal(masu_plan_format(&plan, MASU_IMAGE_ALBEDO), VK_FORMAT_R8G8B8A8_UNORM);
        assert_int_equal(plan.copies, rows[i].format == VK_FORMAT_B8G8R8A8_SRGB);
    }
    support_scene.metered = 1, support_scene.brighten = 7;
    masu_desc d = scene_desc(RASTER, 64, 64);
    support_scene.metered = 1, support_scene.brighten = 7;
    masu_desc resolved = masu_desc_resolved(&d);
    assert_int_equal(resolved.exposure.metered, MASU_ON);
    assert_true(resolved.exposure.brighten == 7 && resolved.exposure.darken == 3);
    d.exposure.metered = MASU_OFF;
    assert_int_equal(masu_desc_resolved(&d).exposure.metered, MASU_OFF);
    /* Resolved before the scene is given, and again with it. */
    masu_desc early = scene_desc(RASTER, 64, 64);
    support_scene.metered = 1;
    early.targets.storage = 0;
    early.scene = NULL;
    early = masu_desc_resolved(&early);
    early.scene = masu_scene_of(&support_scene);
    early = masu_desc_resolved(&early);
    assert_int_equal(early.exposure.metered, MASU_ON);
    assert_int_equal(early.dither, MASU_ON);
    assert_int_equal(early.targets.encoding, MASU_ENCODING_SRGB);
    assert_true(early.exposure.max == 1024 && early.targets.white == 80);
}

static void what_is_given_stays_as_it_is(void **state) {
    (void)state;
    masu_desc given = full_desc(), resolved = masu_desc_resolved(&given);
    assert_same_desc(&resolved, &given);
}

/* Only the members that masu.h names remain AUTO. Resolving again gives the same, as does
 * masu_compile. */
static void words_are_resolved_by_the_rule_of_the_plan(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 640, 360);
    d.rung_count = 6;
    for (uint32_t r = 0; r < 6; r++) d.rungs[r] = (masu_rung){.scale = r ? 0.5f : 1.0f};
    d.rungs[2].easu = MASU_EASU_BILINEAR;
    d.rungs[3].sharpen = MASU_OFF;
    d.rungs[4].temporal = MASU_ON;
    d.rungs[5].sharpness = -1.0f;
    static const masu_switch upscale[] = {MASU_OFF, MASU_ON, MASU_ON, MASU_ON, MASU_ON, MASU_ON};
    static const masu_switch sharpen[] = {MASU_OFF, MASU_ON, MASU_OFF, MASU_OFF, MASU_OFF, MASU_ON};
    masu_desc is = masu_desc_resolved(&d), twice = masu_desc_resolved(&is);
    compile(&d, &plan);
    for (uint32_t r = 0; r < 6; r++) {
        assert_int_equal(is.rungs[r].upscale, upscale[r]);
        assert_int_equal(is.rungs[r].sharpen, sharpen[r]);
        assert_int_equal(masu_has_pass(&plan.rungs[r].active, MASU_PASS_RCAS),
                         sharpen[r] == MASU_ON);
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            assert_false(masu_knob_differs(k, &is.rungs[r], &twice.rungs[r]));
            assert_false(masu_knob_differs(k, &is.rungs[r], &plan.desc.rungs[r]));
            if (k->kind != MASU_KNOB_WORD || masu_knob_get(k, &is.rungs[r], 0) != 0.0) continue;
            if (strcmp(k->name, "specular") && strcmp(k->name, "occlusion"))
                fail_msg("rungs[%u].%s is still AUTO", r, k->name);
        }
    }
    /* Features that the scene does not use are off; features for which a device may lack buffers
     * remain. */
    assert_int_equal(is.rungs[0].occlusion, support_scene.placed_occluders ? MASU_AUTO : MASU_OFF);
    support_scene.placed_occluders = 3;
    assert_int_equal(masu_desc_resolved(&d).rungs[0].occlusion, MASU_AUTO);
    support_scene.placed_occluders = 0;
    assert_int_equal(masu_desc_resolved(&d).rungs[0].occlusion, MASU_OFF);
    support_scene.reflections = 0;
    assert_int_equal(masu_desc_resolved(&d).rungs[0].specular, MASU_OFF);
    support_scene.reflections = 1, support_scene.glossiest = 0.1f;
    support_scene.specular_cutoff = 0.5f;
    assert_int_equal(masu_desc_resolved(&d).rungs[0].specular, MASU_AUTO);
    support_scene.glossiest = 0.9f;
    assert_int_equal(masu_desc_resolved(&d).rungs[0].specular, MASU_OFF);
    /* A scene can request anti-aliased edges, for the default rungs. */
    masu_desc none = d;
    none.rung_count = 0;
    assert_int_equal(masu_desc_resolved(&none).rungs[2].aa, MASU_AA_OFF);
    support_scene.smooth_edges = 1;
    assert_int_equal(masu_desc_resolved(&none).rungs[2].aa, MASU_AA_SMAA_HIGH);
    assert_int_equal(masu_desc_resolved(&d).rungs[0].aa, MASU_AA_OFF);
    support_scene.smooth_edges = 0;
}

/* A governor implies consecutive frames. Several viewports, frames that a host renders or upscales
 * itself, or a rung's own anti-aliasing and upscaling settings imply no temporal upscaling. */
static void with_a_governor_many_samples_come_from_one(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER | SDF, 640, 360);
    d.rung_count = 7;
    for (uint32_t r = 0; r < 7; r++)
        d.rungs[r] = (masu_rung){.scale = r ? 0.5f : 1.0f, .sharpness = 0.5f};
    d.rungs[0].specular_frames = 24;
    d.rungs[2].upscale = MASU_ON;
    d.rungs[3].easu = MASU_EASU_FAST;
    d.rungs[4].sharpen = MASU_OFF;
    d.rungs[5].aa = MASU_AA_OFF;
    d.rungs[6].temporal = MASU_OFF;
    masu_desc is = masu_desc_resolved(&d);
    for (uint32_t r = 0; r < 7; r++) assert_int_equal(is.rungs[r].temporal, MASU_OFF);
    static const masu_governor_mode modes[] = {MASU_GOVERNOR_ON, MASU_GOVERNOR_FIXED};
    for (uint32_t k = 0; k < 2; k++) {
        d.governor.mode = modes[k];
        is = masu_desc_resolved(&d);
        masu_desc twice = masu_desc_resolved(&is);
        for (uint32_t r = 0; r < 7; r++) {
            assert_int_equal(is.rungs[r].temporal, r < 2 ? MASU_ON : MASU_OFF);
            assert_int_equal(twice.rungs[r].temporal, is.rungs[r].temporal);
            /* the host's value is kept */
            assert_int_equal(is.rungs[r].specular_frames, r == 0 ? 24 : r == 1 ? 8 : 32);
            assert_int_equal(twice.rungs[r].specular_frames, is.rungs[r].specular_frames);
        }
        assert_int_equal(is.rungs[1].sharpen, MASU_OFF); /* EASU does not run in that rung */
        assert_int_equal(is.rungs[2].sharpen, MASU_ON);
        d.viewport_count = 1;
        assert_int_equal(masu_desc_resolved(&d).rungs[1].temporal, MASU_ON);
        d.viewport_count = 2;
        assert_int_equal(masu_desc_resolved(&d).rungs[1].temporal, MASU_OFF);
        d.viewport_count = 0;
        d.split = MASU_SPLIT_AFTER_UPSCALE;
        assert_int_equal(masu_desc_resolved(&d).rungs[1].temporal, MASU_ON);
        d.split = MASU_SPLIT_BEFORE_TONE;
        assert_int_equal(masu_desc_resolved(&d).rungs[1].temporal, MASU_OFF);
        d.split = 0;
        d.debug.reference = 1;
        assert_int_equal(masu_desc_resolved(&d).rungs[1].temporal, MASU_OFF);
        d.debug.reference = 0;
    }
    /* Default rungs, with anti-aliased edges requested. */
    d.rung_count = 0;
    d.ladder = MASU_OFF;
    support_scene.smooth_edges = 1;
    is = masu_desc_resolved(&d);
    for (uint32_t r = 0; r < 3; r++)
        assert_true(is.rungs[r].temporal == MASU_ON && is.rungs[r].aa == MASU_AA_OFF);
    d.governor.mode = MASU_GOVERNOR_OFF;
    assert_int_equal(masu_desc_resolved(&d).rungs[0].temporal, MASU_OFF);
    support_scene.smooth_edges = 0;
    masu_desc source = source_desc(640, 360);
    source.governor.mode = MASU_GOVERNOR_ON;
    assert_int_equal(masu_desc_resolved(&source).rungs[0].temporal, MASU_OFF);
}

/* Too many rungs are a later error, and no reason to write behind the array. */
static void an_absurd_number_of_rungs_is_resolved_without_harm(void **state) {
    (void)state;
    masu_desc given = full_desc();
    given.rung_count = UINT32_MAX;
    masu_desc resolved = masu_desc_resolved(&given);
    assert_same_desc(&resolved, &given);
}

/* ---- Rejected descriptions ------------------------------------------------------------------- */

/* A valid description with one wrong member: rejected, and the error names the member. */
#define BAD(what, ...)                                                                             \
    do {                                                                                           \
        masu_desc d = scene_desc(RASTER | SDF, 640, 480);                                          \
        d.rung_count = 2;                                                                          \
        __VA_ARGS__;                                                                               \
        assert_refused(&d, MASU_ERROR_ARGUMENT, what);                                             \
    } while (0)

static void a_bad_size_is_named(void **state) {
    (void)state;
    BAD("output.width", d.output.width = 0);
    BAD("output.width", d.output.width = 16385);
    BAD("output.width", d.output.width = UINT32_MAX);
    BAD("output.height", d.output.height = 0);
    BAD("output.height", d.output.height = 16385);
    masu_desc d = scene_desc(RASTER, 16384, 16384);
    static masu_frame_plan plan;
    compile(&d, &plan);
}

static void a_bad_count_is_named(void **state) {
    (void)state;
    BAD("rung_count", d.rung_count = MASU_MAX_RUNGS + 1);
    BAD("rung_count", d.rung_count = UINT32_MAX);
    BAD("frames_in_flight", d.frames_in_flight = MASU_MAX_FLIGHT + 1);
    BAD("targets.count", d.targets.count = 0);
    BAD("targets.count", d.targets.count = MASU_MAX_TARGETS + 1);
    BAD("readback", d.readback = MASU_READBACK_ALL + 1);
    BAD("debug.mip_bias", d.debug.mip_bias = -16.1f);
    BAD("debug.mip_bias", d.debug.mip_bias = nanf(""));
    BAD("readback", d.readback = UINT32_MAX);
}

static void a_missing_target_is_named(void **state) {
    (void)state;
    BAD("targets.images", d.targets.images = NULL);
    BAD("targets.images", support_images[0] = VK_NULL_HANDLE);
    BAD("targets.images", support_images[1] = VK_NULL_HANDLE);
    BAD("targets.views", d.targets.views = NULL);
    BAD("targets.views", support_views[1] = VK_NULL_HANDLE);
    masu_desc d = scene_desc(RASTER, 64, 64);
    static masu_frame_plan plan;
    support_images[2] = VK_NULL_HANDLE, support_views[2] = VK_NULL_HANDLE; /* beyond the count */
    compile(&d, &plan);
}

static void a_storage_target_of_another_format_is_named(void **state) {
    (void)state;
    BAD("targets.format", d.targets.format = VK_FORMAT_B8G8R8A8_UNORM);
    BAD("targets.format", d.targets.format = VK_FORMAT_R8G8B8A8_SRGB);
}

static void scene_and_source_exclude_each_other(void **state) {
    (void)state;
    BAD("scene", d.scene = NULL);
    BAD("source.view", d.source = (masu_source){FAKE(VkImageView, 1), 64, 64, VK_FORMAT_UNDEFINED});
}

static void a_bad_source_is_named(void **state) {
    (void)state;
    BAD("source.width", d = source_desc(0, 10));
    BAD("source.width", d = source_desc(16385, 10));
    BAD("source.height", d = source_desc(10, 0));
    BAD("source.height", d = source_desc(10, 16385));
}

/* Each bad value of each knob in each rung: rejected with the knob's name. */
static void a_knob_out_of_its_range_is_named(void **state) {
    (void)state;
    const double nan = (double)NAN, infinity = (double)INFINITY;
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        double bad[6];
        char what[80];
        uint32_t count = 0;
        snprintf(what, sizeof what, "rungs[].%s", k->name);
        if (k->kind == MASU_KNOB_FLOAT) {
            bad[count++] = nan, bad[count++] = infinity, bad[count++] = -infinity;
            bad[count++] = k->max + 1e-4 * fabs(k->max), bad[count++] = k->min - 1e-4 * k->max;
        } else {
            bad[count++] = k->max + 1.0, bad[count++] = UINT32_MAX;
            if (k->min > 1.0) bad[count++] = 1.0, bad[count++] = k->min - 1.0;
        }
        for (uint32_t n = 0; n < count * 2 * k->values; n++) {
            uint32_t rung = n / count % 2, value = n / count / 2;
            assert_false(masu_knob_accepts(k, bad[n % count]));
            BAD(what, masu_knob_set(k, &d.rungs[rung], value, bad[n % count]));
        }
    }
    masu_desc d = scene_desc(RASTER, 64, 64);
    static masu_frame_plan plan;
    d.rung_count = 1;
    d.rungs[1].scale = (float)NAN; /* beyond the count */
    compile(&d, &plan);
    BAD("debug.share_rays", d.debug.share_rays = (masu_switch)3);
    BAD("half_floats", d.half_floats = (masu_switch)3);
    BAD("load_step", d.load_step = MASU_LOAD_STEP_MIN - 1);
    BAD("first_rung", d.first_rung = d.rung_count);
    BAD("reserve.particles", d.reserve.particles = MASU_PARTICLES_MAX + 1);
    BAD("reserve.decals", d.reserve.decals = MASU_DECALS_MAX + 1);
    BAD("reserve.lines", d.reserve.lines = MASU_LINES_MAX + 1);
    BAD("reserve.trail_points", d.reserve.trail_points = MASU_PARTICLES_MAX + 1);
    BAD("reserve.textures", d.reserve.textures = MASU_LIVE_TEXTURES_MAX + 1);
    BAD("reserve.texture_size.width",
        (d.reserve.textures = 1, d.reserve.texture_size.width = 4097));
    BAD("reserve.texture_size.height",
        (d.reserve.textures = 1, d.reserve.texture_size.height = 4097));
    BAD("reserve.texture_bytes", (d.reserve.textures = 1, d.reserve.texture_bytes = 3));
    BAD("reserve.texture_bytes",
        (d.reserve.textures = 1, d.reserve.texture_bytes = (1u << 28) + 1));
    d = scene_desc(RASTER, 64, 64);
    d.reserve = (masu_reserve){
        .particles = MASU_PARTICLES_MAX, .decals = MASU_DECALS_MAX, .lines = MASU_LINES_MAX};
    compile(&d, &plan);
    /* 2^28 texels, and one texture more; sizes that are not given. */
    d.reserve = (masu_reserve){.trail_points = MASU_PARTICLES_MAX,
                               .textures = 16,
                               .texture_size = {4096, 4096},
                               .texture_bytes = 1u << 28};
    compile(&d, &plan);
    assert_int_equal(plan.images[MASU_IMAGE_TEXTURES].width, 4096);
    d.reserve.textures = 17;
    masu_detail detail;
    assert_int_equal(masu_compile(&d, 1, 1, &plan, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "reserve.textures");
    assert_true(detail.needed == 17ull << 24 && detail.given == 1ull << 28);
    d.reserve = (masu_reserve){.textures = MASU_LIVE_TEXTURES_MAX};
    compile(&d, &plan);
    assert_int_equal(plan.desc.reserve.texture_size.height, 256);
    assert_int_equal(plan.desc.reserve.texture_bytes, 4 * 256 * 256);
    d.reserve =
        (masu_reserve){.particles = MASU_PARTICLES_MAX, .lines = MASU_LINES_MAX, .textures = 1};
    /* Without a scene there is no camera, and no passes are planned for them. */
    masu_desc none = source_desc(64, 64);
    none.reserve = d.reserve;
    assert_int_equal(masu_desc_resolved(&none).reserve.lines, 0);
    compile(&none, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SPRITES].bytes, 0);
}

/* The text about a knob's values, in full and once as names, for each kind. */
static void a_refused_knob_says_what_it_takes(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static const struct {
        const char *knob;
        double value;
        const char *text;
        uint64_t needed, given;
    } rows[] = {{"scale", 1.5, "rungs[1].scale is 1.5, allowed are 0 to 1", 0, 0},
                {"lod_error", -2e9,
                 "rungs[1].lod_error is -2000000000 pixels, allowed are -1e+09 to 1e+09", 0, 0},
                {"march_steps", 2049, "rungs[1].march_steps is 2049 steps, allowed are 0 to 2048",
                 2048, 2049},
                {"shadow_resolution", 8,
                 "rungs[1].shadow_resolution is 8 texels, allowed are 0 and 16 to 8192", 16, 8},
                {"shadow_refresh", 65,
                 "rungs[1].shadow_refresh[0] is 65 frames, allowed are 0 to 64", 64, 65},
                {"aa", 7, "rungs[1].aa is 7, allowed are 0 to 6", 6, 7}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        masu_desc d = scene_desc(RASTER | SDF, 640, 480);
        masu_detail detail;
        d.rung_count = 2;
        const masu_knob *k = masu_knob_find(rows[i].knob, strlen(rows[i].knob));
        masu_knob_set(k, &d.rungs[1], 0, rows[i].value);
        assert_int_equal(masu_compile(&d, 256, 64, &plan, &detail), MASU_ERROR_ARGUMENT);
        assert_string_equal(detail.text, rows[i].text);
        assert_int_equal(detail.needed, rows[i].needed);
        assert_int_equal(detail.given, rows[i].given);
    }
}

/* The ranges that shaders and scene files are built for are those of the table. */
static void ranges_are_those_of_shaders_and_blobs(void **state) {
    (void)state;
    static const struct {
        const char *knob;
        double min, max;
    } rows[] = {{"march_steps", 1, MASU_MARCH_STEPS_MAX},
                {"ao_slices", 1, MASU_AO_SLICES_MAX},
                {"ao_steps", 1, MASU_AO_STEPS_MAX},
                {"specular_reuse_taps", 1, MASU_REUSE_TAPS_MAX},
                {"specular_filter_taps", 1, MASU_FILTER_TAPS_MAX},
                {"specular_frames", 1, MASU_SPECULAR_FRAMES_MAX},
                {"shadow_cascades", 1, MASU_MAX_CASCADES},
                {"shadow_resolution", MASU_SHADOW_SIZE_MIN, MASU_SHADOW_SIZE_MAX},
                {"shadow_refresh", 1, MASU_MAX_REFRESH}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        const masu_knob *k = masu_knob_find(rows[i].knob, strlen(rows[i].knob));
        assert_non_null(k);
        assert_true(k->min == rows[i].min && k->max == rows[i].max);
    }
    static const struct {
        const char *limit;
        uint64_t max;
    } limits[] = {{"shadow_resolution", MASU_SHADOW_SIZE_MAX},
                  {"transparents", MASU_TRANSPARENTS_MAX},
                  {"lights", MASU_BLOB_LIGHTS_MAX}};
    for (size_t i = 0; i < COUNT(limits); i++) {
        const masu_limit *l = masu_limit_table();
        while (l->name && strcmp(l->name, limits[i].limit)) l++;
        assert_non_null(l->name);
        assert_int_equal(l->max, limits[i].max);
    }
}

/* Tables that programs iterate over: each field of masu_rung and masu_limits once, with its
 * texts. */
static void tables_have_every_field_once(void **state) {
    (void)state;
    uint32_t end = 0;
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        assert_int_equal(k->offset, end);
        end += 4 * k->values;
        assert_true(k->text[0] && k->cost[0] && k->where[0] && k->min < k->max);
        assert_true(masu_knob_accepts(k, 0.0) && masu_knob_accepts(k, k->zero));
        assert_true(masu_knob_accepts(k, k->min) && masu_knob_accepts(k, k->max));
        assert_int_equal(k->kind == MASU_KNOB_WORD, k->words != NULL);
        for (uint32_t w = 0; w < k->word_count; w++) {
            assert_int_equal(k->words[w].value, w);
            assert_true(k->words[w].word[0] && !strncmp(k->words[w].name, "MASU_", 5));
        }
        if (k->words) assert_string_equal(k->words[0].word, "auto");
        if (k->words && k->zero > 0.0) { /* the text states the value of the column */
            char rule[64];
            (void)snprintf(rule, sizeof rule, "AUTO: %s", k->words[(uint32_t)k->zero].word);
            assert_non_null(strstr(k->text, rule));
        }
        masu_rung rung = {.scale = 0.5f};
        masu_knob_set(k, &rung, k->values, 1.0); /* beyond the last: nothing */
        assert_true(masu_knob_get(k, &rung, k->values) == 0.0 && rung.scale == 0.5f);
    }
    assert_int_equal(end, sizeof(masu_rung));
    end = 0;
    for (const masu_limit *l = masu_limit_table(); l->name; l++) {
        assert_int_equal(l->offset, end);
        end += sizeof(uint64_t);
        assert_true(l->text[0]);
    }
    assert_int_equal(end, sizeof(masu_limits));
}

static void meshes_too_large_for_occlusion_are_a_limit(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 64, 64);
    for (int instances = 0; instances < 2; instances++) {
        uint32_t *most = instances ? &support_scene.max_instances : &support_scene.max_primitives;
        uint32_t limit = instances ? 64 * 4096 : 4096;
        *most = limit + 1;
        support_scene.placed_occluders = 0;
        compile(&d, &plan);
        assert_int_equal(plan.occlusion, 0);
        support_scene.placed_occluders = 1;
        compile(&d, &plan); /* AUTO disables the feature, and reports it */
        assert_int_equal(plan.occlusion, 0);
        assert_string_equal(plan.why[MASU_PASS_CULL],
                            "a mesh has too many primitives or instances");
        d.rung_count = 1;
        d.rungs[0].occlusion = MASU_ON;
        assert_refused(&d, MASU_ERROR_LIMIT, "rungs[].occlusion");
        d.rungs[0].occlusion = MASU_AUTO;
        *most = limit;
        compile(&d, &plan);
        assert_int_equal(plan.occlusion, 1);
    }
}

static void a_rung_that_needs_upscaling_cannot_switch_it_off(void **state) {
    (void)state;
    BAD("rungs[].upscale", d.rungs[1].scale = 0.5f, d.rungs[1].upscale = MASU_OFF);
    BAD("rungs[].upscale", d = source_desc(10, 10), d.rungs[0].upscale = MASU_OFF);
    BAD("rungs[].upscale", d = source_desc(1920, 10), d.rungs[0].upscale = MASU_OFF);
}

static void the_extremes_of_each_range_are_accepted(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 1, 16384);
    d.rung_count = MASU_MAX_RUNGS;
    d.targets.count = MASU_MAX_TARGETS;
    d.frames_in_flight = MASU_MAX_FLIGHT;
    d.readback = MASU_READBACK_ALL;
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        for (uint32_t i = 0; i < k->values; i++) {
            masu_knob_set(k, &d.rungs[0], i, k->max);
            masu_knob_set(k, &d.rungs[1], i, k->min > 0.0 || k->min < 0.0 ? k->min : 1.0);
        }
    }
    d.rungs[0].scale = 1e-30f, d.rungs[1].scale = 1.0f;
    d.rungs[1].upscale = d.rungs[1].occlusion = MASU_OFF;
    d.rungs[0].shadow_distance = 1e9f, d.rungs[1].shadow_distance = 1e-30f;
    d.rungs[1].specular_cutoff = 1e-30f;
    compile(&d, &plan);
    d.targets.count = 1;
    d.frames_in_flight = 1;
    compile(&d, &plan);
    d = source_desc(1, 16384);
    compile(&d, &plan);
    d = source_desc(16384, 1);
    compile(&d, &plan);
}

static void refusals_say_what_was_given_and_what_is_allowed(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_detail detail;
    masu_desc d = scene_desc(RASTER, 20000, 480);
    assert_int_equal(masu_compile(&d, 1, 1, &plan, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(detail.given, 20000);
    assert_int_equal(detail.needed, 16384);
    assert_string_equal(detail.text, "output.width is 20000, allowed are 1 to 16384");
}

static void a_scene_beyond_a_limit_is_refused_with_both_numbers(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint64_t needed;
    } rows[] = {{"vertices", 11},       {"indices", 15},
                {"materials", 2},       {"instances", 3},
                {"models", 2},          {"model_nodes", 7},
                {"sdf_params", 2},      {"shadow_cascades", 3},
                {"shadow_resolution", 1024}, {"probes", 6},
                {"textures", 4},        {"texture_bytes", 1000},
                {"transparents", 6},    {"lights", 5},
                {"trace_triangles", 12}, {"trace_instances", 2}};
    static masu_frame_plan plan;
    const masu_limit *l = masu_limit_table();
    for (size_t i = 0; l->name; l++, i++) {
        masu_desc d = scene_desc(RASTER | SDF, 640, 480);
        masu_detail detail;
        char what[80];
        assert_true(i < COUNT(rows)); /* a new limit needs a row here */
        assert_string_equal(l->name, rows[i].name);
        uint64_t limit = rows[i].needed;
        snprintf(what, sizeof what, "limits.%s", l->name);
        support_scene.shadow_cascades = 3;
        support_scene.shadow_resolution = 1024;
        support_scene.transparents = 6, support_scene.transparent_sets = 1;
        support_scene.probes = 6;
        support_scene.models = 2, support_scene.model_nodes = 7;
        support_scene.lights = 5;
        support_scene.trace_triangles = 12;
        support_scene.trace_instances = 2;
        masu_desc is = masu_desc_resolved(&d);
        const masu_limits needed = masu_limits_needed(&is);
        assert_memory_equal((const char *)&needed + l->offset, &limit, sizeof limit);
        memcpy((char *)&d.limits + l->offset, &limit, sizeof limit);
        compile(&d, &plan); /* exactly enough */
        limit--;
        memcpy((char *)&d.limits + l->offset, &limit, sizeof limit);
        assert_refused(&d, MASU_ERROR_LIMIT, what);
        assert_int_equal(masu_compile(&d, 1, 1, &plan, &detail), MASU_ERROR_LIMIT);
        assert_int_equal(detail.needed, rows[i].needed);
        assert_int_equal(detail.given, limit);
    }
}

/* For every allowed description, the recordings have a draw for each transparent surface. */
static void more_transparents_than_can_be_recorded_are_refused(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static const struct {
        uint32_t transparents, sets;
        const char *what; /* NULL: accepted */
    } rows[] = {{4096, 16, NULL},
                {4097, 1, "limits.transparents"},
                {UINT32_MAX, 1, "limits.transparents"},
                {4096, 17, "transparents times their texture sets"},
                {1, 64, NULL},
                {1, 65, "transparent texture sets"}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        masu_desc d = scene_desc(RASTER, 640, 480);
        support_scene.transparents = rows[i].transparents;
        support_scene.transparent_sets = rows[i].sets;
        if (rows[i].what) {
            assert_refused(&d, MASU_ERROR_LIMIT, rows[i].what);
        } else {
            compile(&d, &plan);
        }
    }
}

/* Errors of the public functions that need no device. */
static void what_no_device_is_needed_for_is_refused_without_one(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 640, 480);
    masu_memory memory;
    masu_plan_info info;
    masu_renderer *renderer = (masu_renderer *)&info;
    masu_detail detail;
    static _Alignas(64) unsigned char block[128];
    assert_int_equal(masu_memory_query(NULL, &memory, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "desc");
    assert_int_equal(masu_memory_query(&d, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "out");
    assert_int_equal(masu_plan(&d, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_plan(NULL, &info, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_init(&d, block, sizeof block, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_init(&d, NULL, 0, &renderer, &detail), MASU_ERROR_MEMORY);
    assert_string_equal(detail.what, "host block");
    assert_null(renderer);
    assert_int_equal(masu_init(&d, block + 8, 64, &renderer, &detail), MASU_ERROR_MEMORY);
    support_scene.blob = NULL;
    assert_int_equal(masu_memory_query(&d, &memory, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "scene");
    masu_destroy(NULL);
}

static void a_missing_vulkan_handle_is_named(void **state) {
    (void)state;
    static const char *const names[] = {"vulkan.get_instance_proc_addr", "vulkan.instance",
                                        "vulkan.physical_device", "vulkan.device"};
    for (int missing = 0; missing < 4; missing++) {
        masu_desc d = scene_desc(RASTER, 640, 480);
        masu_memory memory;
        masu_detail detail;
        d.vulkan = full_desc().vulkan;
        if (missing == 0) d.vulkan.get_instance_proc_addr = NULL;
        if (missing == 1) d.vulkan.instance = NULL;
        if (missing == 2) d.vulkan.physical_device = NULL;
        if (missing == 3) d.vulkan.device = NULL;
        d.scene = NULL;
        d.source = (masu_source){FAKE(VkImageView, 1), 64, 64, VK_FORMAT_UNDEFINED};
        assert_int_equal(masu_memory_query(&d, &memory, &detail), MASU_ERROR_ARGUMENT);
        assert_string_equal(detail.what, names[missing]);
    }
    masu_desc d = source_desc(64, 64);
    masu_memory memory;
    masu_detail detail;
    d.vulkan = full_desc().vulkan;
    d.vulkan.allocator = NULL;
    assert_int_equal(masu_memory_query(&d, &memory, &detail), MASU_ERROR_DEVICE);
    assert_string_equal(detail.what, "vkGetDeviceProcAddr"); /* no_function returns none */
}

static void *VKAPI_PTR no_allocation(void *user, size_t size, size_t align,
                                     VkSystemAllocationScope s) {
    (void)user, (void)size, (void)align, (void)s;
    return NULL;
}
static void *VKAPI_PTR no_reallocation(void *user, void *from, size_t size, size_t align,
                                       VkSystemAllocationScope s) {
    (void)user, (void)from, (void)size, (void)align, (void)s;
    return NULL;
}
static void VKAPI_PTR no_free(void *user, void *at) { (void)user, (void)at; }
static void VKAPI_PTR no_notice(void *user, size_t size, VkInternalAllocationType t,
                                VkSystemAllocationScope s) {
    (void)user, (void)size, (void)t, (void)s;
}

/* A driver calls the callbacks without a check. */
static void a_missing_callback_of_the_allocator_is_named(void **state) {
    (void)state;
    const VkAllocationCallbacks all = {
        NULL, no_allocation, no_reallocation, no_free, no_notice, no_notice};
    static const char *const names[] = {"pfnAllocation", "pfnReallocation", "pfnFree",
                                        "pfnInternalAllocation", "pfnInternalFree"};
    for (int missing = -1; missing <= 5; missing++) {
        masu_desc d = source_desc(64, 64);
        masu_memory memory;
        masu_detail detail;
        VkAllocationCallbacks some = all;
        d.vulkan = full_desc().vulkan;
        d.vulkan.allocator = &some;
        if (missing == 0) some.pfnAllocation = NULL;
        if (missing == 1) some.pfnReallocation = NULL;
        if (missing == 2) some.pfnFree = NULL;
        if (missing == 3 || missing == 5) some.pfnInternalAllocation = NULL;
        if (missing == 4 || missing == 5) some.pfnInternalFree = NULL;
        if (missing < 0 || missing == 5) { /* accepted: the next argument is missing */
            assert_int_equal(masu_memory_query(&d, &memory, &detail), MASU_ERROR_DEVICE);
            continue;
        }
        assert_int_equal(masu_memory_query(&d, &memory, &detail), MASU_ERROR_ARGUMENT);
        assert_memory_equal(detail.what, "vulkan.allocator.", 17);
        assert_string_equal(detail.what + 17, names[missing]);
        assert_non_null(strstr(detail.text, " is NULL"));
    }
    const VkAllocationCallbacks none = {0};
    masu_desc d = source_desc(64, 64);
    masu_detail detail;
    masu_memory memory;
    d.vulkan = full_desc().vulkan;
    d.vulkan.allocator = &none;
    assert_int_equal(masu_memory_query(&d, &memory, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.text, "vulkan.allocator.pfnAllocation is NULL");
}

static void every_result_has_its_text(void **state) {
    (void)state;
    const char *const unknown = "unknown result";
    for (int i = MASU_ERROR_STATE; i <= MASU_INCOMPLETE; i++) {
        const char *text = masu_result_string((masu_result)i);
        assert_true(*text && strcmp(text, unknown) != 0);
    }
    assert_string_equal(masu_result_string(MASU_OK), "success");
    assert_string_equal(masu_result_string((masu_result)-1000), unknown);
    assert_string_equal(masu_result_string((masu_result)2), unknown);
    assert_string_equal(masu_result_string(MASU_RESULT_FORCE_32), unknown);
}

static char last_log[256];

static void keep_log(void *user, masu_log_level level, const char *text) {
    (void)user, (void)level;
    snprintf(last_log, sizeof last_log, "%s", text);
}

/* A description with another struct size is not read: not even its log. */
static void a_description_of_another_size_is_refused(void **state) {
    (void)state;
    static _Alignas(64) unsigned char block[64];
    const uint32_t sizes[] = {0, sizeof(masu_desc) - 8, sizeof(masu_desc) + 8};
    masu_renderer *m;
    masu_memory need;
    static masu_plan_info plan;
    for (size_t i = 0; i < 3; i++) {
        masu_desc d = scene_desc(RASTER, 64, 64), out;
        d.bytes = sizes[i];
        d.log = keep_log;
        last_log[0] = '\0';
        for (int call = 0; call < 5; call++) {
            masu_detail detail = {0};
            masu_result result = call == 0   ? masu_memory_query(&d, &need, &detail)
                                 : call == 1 ? masu_plan(&d, &plan, &detail)
                                 : call == 2 ? masu_init(&d, block, sizeof block, &m, &detail)
                                 : call == 3 ? masu_desc_resolve(&d, &out, &detail)
                                             : masu_ladder_of(d.scene, &d, NULL, &detail);
            assert_int_equal(result, MASU_ERROR_ARGUMENT);
            assert_string_equal(detail.what, "bytes");
            assert_int_equal(detail.needed, sizeof(masu_desc));
            assert_int_equal(detail.given, sizes[i]);
            assert_non_null(strstr(detail.text, "sizeof(masu_desc)"));
            assert_string_equal(last_log, "");
        }
    }
    /* With the right size, errors go to its log. */
    masu_desc d = scene_desc(RASTER, 64, 64);
    masu_detail detail;
    d.log = keep_log;
    assert_int_equal(masu_desc_resolve(&d, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(last_log, detail.text);
    last_log[0] = '\0';
    d.output.width = 0;
    assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(last_log, detail.text);
    /* source and result are the same object */
    assert_int_equal(masu_desc_resolve(&d, &d, &detail), MASU_OK);
    assert_int_equal(d.bytes, sizeof d);
    assert_int_equal(masu_version() / 1000, MASU_VERSION / 1000);
}

/* Arrays without a count, and a source together with a scene, would silently have no effect. */
static void what_would_have_no_effect_is_refused(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 640, 480);
    d.rung_count = 0;
    memset(d.rungs, 0, sizeof d.rungs);
    masu_frame_plan plan;
    compile(&d, &plan);
    d.rungs[0].aa = MASU_AA_FXAA;
    assert_refused(&d, MASU_ERROR_ARGUMENT, "rung_count");
    d.rung_count = 1;
    compile(&d, &plan);
    d.viewports[0] = (masu_viewport){0, 0, 320, 480};
    assert_refused(&d, MASU_ERROR_ARGUMENT, "viewport_count");
    d.viewport_count = 1;
    compile(&d, &plan);
    d.source = (masu_source){VK_NULL_HANDLE, 64, 64, VK_FORMAT_UNDEFINED};
    assert_refused(&d, MASU_ERROR_ARGUMENT, "source");
}

/* A number is checked even if it has no effect: without a scene, or without a governor. */
static void an_unused_number_is_checked_too(void **state) {
    (void)state;
    masu_desc d = source_desc(320, 200);
    float *const numbers[] = {&d.targets.white,   &d.targets.peak, &d.exposure.brighten,
                              &d.exposure.darken, &d.exposure.low, &d.exposure.high,
                              &d.exposure.min,    &d.exposure.max};
    static const char *const names[] = {"targets.white",   "targets.peak", "exposure.brighten",
                                        "exposure.darken", "exposure.low", "exposure.high",
                                        "exposure.min",    "exposure.max"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        *numbers[i] = (float)NAN;
        assert_refused(&d, MASU_ERROR_ARGUMENT, names[i]);
        *numbers[i] = 0.0f;
    }
    masu_detail detail;
    masu_governor_desc g = {.target_ms = (float)NAN};
    assert_int_equal(masu_governor_check(&g, 3, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "governor.target_ms");
    g = (masu_governor_desc){.headroom = (float)INFINITY};
    assert_int_equal(masu_governor_check(&g, 3, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "governor.headroom");
    g = (masu_governor_desc){.mode = MASU_GOVERNOR_OFF};
    assert_int_equal(masu_governor_check(&g, 3, &detail), MASU_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_zero_becomes_its_documented_default),
        cmocka_unit_test(zeros_inside_given_rungs_become_defaults_too),
        cmocka_unit_test(each_format_has_its_steps),
        cmocka_unit_test(output_follows_from_target_and_scene),
        cmocka_unit_test(what_is_given_stays_as_it_is),
        cmocka_unit_test(words_are_resolved_by_the_rule_of_the_plan),
        cmocka_unit_test(with_a_governor_many_samples_come_from_one),
        cmocka_unit_test(an_absurd_number_of_rungs_is_resolved_without_harm),
        cmocka_unit_test(a_bad_size_is_named),
        cmocka_unit_test(a_bad_count_is_named),
        cmocka_unit_test(a_missing_target_is_named),
        cmocka_unit_test(a_storage_target_of_another_format_is_named),
        cmocka_unit_test(scene_and_source_exclude_each_other),
        cmocka_unit_test(a_bad_source_is_named),
        cmocka_unit_test(a_knob_out_of_its_range_is_named),
        cmocka_unit_test(a_refused_knob_says_what_it_takes),
        cmocka_unit_test(ranges_are_those_of_shaders_and_blobs),
        cmocka_unit_test(tables_have_every_field_once),
        cmocka_unit_test(meshes_too_large_for_occlusion_are_a_limit),
        cmocka_unit_test(a_rung_that_needs_upscaling_cannot_switch_it_off),
        cmocka_unit_test(the_extremes_of_each_range_are_accepted),
        cmocka_unit_test(refusals_say_what_was_given_and_what_is_allowed),
        cmocka_unit_test(a_scene_beyond_a_limit_is_refused_with_both_numbers),
        cmocka_unit_test(more_transparents_than_can_be_recorded_are_refused),
        cmocka_unit_test(what_would_have_no_effect_is_refused),
        cmocka_unit_test(what_no_device_is_needed_for_is_refused_without_one),
        cmocka_unit_test(a_missing_vulkan_handle_is_named),
        cmocka_unit_test(a_missing_callback_of_the_allocator_is_named),
        cmocka_unit_test(an_unused_number_is_checked_too),
        cmocka_unit_test(every_result_has_its_text),
        cmocka_unit_test(a_description_of_another_size_is_refused),
    };
    return cmocka_run_group_tests_name("desc", tests, NULL, NULL);
}
