/* test_failures.c: failures: the n-th Vulkan call fails, the device lacks a feature, the host
 * passes invalid values. Each gives an error with a name, leaves nothing behind, and a second try
 * succeeds. */
#include "support/support.h"
#include "support/files.h"
#include "support/wrap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 36, H = 22 };

static masu_session s;
static void *block;

static int open_scene(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    wrap_reset();
    d.no_renderer = true;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.desc.debug.timestamps = 1;
    d.desc.readback = MASU_READBACK_ALL;
    open_session(&s, &d);
    assert_int_equal(masu_memory_query(&s.desc, &s.need, NULL), MASU_OK);
    block = host_block(s.need.host_bytes + 4096);
    return 0;
}

static int open_without_renderer(void **state) {
    (void)state;
    return open_scene("test_both");
}

static int close_again(void **state) {
    (void)state;
    wrap_reset();
    free(block);
    close_session(&s);
    return 0;
}

static int open_shadows_instead(void **state) {
    close_again(state);
    int result = open_scene("test_shadows");
    s.desc.rung_count = 1;
    s.desc.rungs[0] = (masu_rung){.shadow_resolution = 64, .shadow_refresh = {1, 2, 4}};
    return result;
}

static int open_textures_instead(void **state) {
    close_again(state);
    return open_scene("test_texture_mask");
}

static int open_the_first_again(void **state) {
    close_again(state);
    return open_without_renderer(state);
}

static masu_result try_init(masu_renderer **m, masu_detail *detail) {
    memset(detail, 0, sizeof *detail);
    *m = (masu_renderer *)block; /* must be overwritten */
    return masu_init(&s.desc, block, s.need.host_bytes + 4096, m, detail);
}

/* Fails call 1, 1 + step, ...; the step is a prime, so that alternating kinds of calls are all
 * tested. */
static void fail_calls_of_init(VkResult with, bool persistent, uint32_t split, uint32_t step) {
    masu_detail detail;
    masu_renderer *m;
    s.desc.deny.unified_memory = split;
    wrap_reset();
    assert_int_equal(try_init(&m, &detail), MASU_OK);
    uint64_t calls = wrap.setup_calls;
    masu_destroy(m);
    assert_int_equal(wrap.live, 0);
    assert_true(calls > 50);
    for (uint64_t k = 1; k <= calls; k += step) {
        wrap_reset();
        wrap.fail_at = k;
        wrap.fail_with = with;
        wrap.persistent = persistent;
        masu_result result = try_init(&m, &detail);
        assert_int_equal(result,
                         with == VK_ERROR_DEVICE_LOST ? MASU_ERROR_DEVICE_LOST : MASU_ERROR_VULKAN);
        assert_null(m);
        assert_int_equal(detail.result, result);
        assert_int_equal(detail.vulkan, with);
        assert_string_equal(detail.what, wrap.failed_call);
        if (wrap.live)
            fail_msg("call %llu (%s) leaks %lld objects", (unsigned long long)k, wrap.failed_call,
                     (long long)wrap.live);
        assert_int_equal(wrap.calls_after_loss, 0);
    }
    wrap_reset();
    assert_int_equal(try_init(&m, &detail), MASU_OK); /* the block can be used again */
    masu_destroy(m);
    assert_int_equal(wrap.live, 0);
    s.desc.deny.unified_memory = 0;
}

static void any_call_of_init_may_run_out_of_memory_once(void **state) {
    (void)state;
    fail_calls_of_init(VK_ERROR_OUT_OF_DEVICE_MEMORY, false, 0, trials(1, 2, 7));
}

static void any_call_of_init_may_fail_for_good(void **state) {
    (void)state;
    fail_calls_of_init(VK_ERROR_OUT_OF_HOST_MEMORY, true, 1, trials(1, 7, 17));
}

static void any_call_of_init_may_fail_with_a_shadow_map(void **state) {
    (void)state;
    fail_calls_of_init(VK_ERROR_OUT_OF_DEVICE_MEMORY, false, 0, 1);
}

static void the_device_may_be_lost_at_any_call_of_init(void **state) {
    (void)state;
    fail_calls_of_init(VK_ERROR_DEVICE_LOST, true, 0, trials(1, 5, 13));
}

/* Textures, their samplers, sets and copies in chunks. */
static void any_call_of_init_with_textures_may_fail(void **state) {
    (void)state;
    fail_calls_of_init(VK_ERROR_OUT_OF_DEVICE_MEMORY, false, 1, trials(1, 3, 11));
}

static void expect_device_error(const char *what) {
    masu_detail detail;
    masu_memory need;
    memset(&detail, 0, sizeof detail);
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_DEVICE);
    if (!strstr(detail.what, what))
        fail_msg("'%s' names '%s', not '%s'", detail.text, detail.what, what);
    assert_true(strlen(detail.text) > 10);
    assert_null(strchr(detail.text, '\n'));
    assert_int_equal(wrap.live, 0);
}

static void what_the_device_lacks_is_named(void **state) {
    (void)state;
    wrap_reset();
    wrap.api_version = VK_API_VERSION_1_0;
    wrap.no_extensions = true;
    expect_device_error("VK_KHR_storage_buffer_storage_class");
    wrap_reset();
    wrap.lacking_format = VK_FORMAT_D32_SFLOAT;
    expect_device_error("VK_FORMAT_D32_SFLOAT");
    wrap.lacking_format = VK_FORMAT_R16G16B16A16_SFLOAT;
    expect_device_error("VK_FORMAT_R16G16B16A16_SFLOAT");
    wrap_reset();
    wrap.no_compute = true;
    expect_device_error("queue family");
    wrap_reset();
    wrap.no_timestamps = true;
    expect_device_error("debug.timestamps");
    wrap_reset();
    wrap.max_image = 16;
    expect_device_error("output");
    wrap_reset();
    wrap.max_framebuffer = 16; /* images may be larger than the rendered area */
    masu_detail detail;
    masu_memory need;
    expect_device_error("output");
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_DEVICE);
    assert_int_equal(detail.needed, W);
    assert_int_equal(detail.given, 16);
    assert_non_null(strstr(detail.text, "may be (16)"));
    wrap_reset();
    s.desc.output = (VkExtent2D){48, 48}; /* enough workgroups for each axis, but not for all tiles
                                             of a list */
    wrap.max_groups = 7;
    expect_device_error("maxComputeWorkGroupCount");
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_DEVICE);
    assert_int_equal(detail.needed, 9);
    s.desc.output = (VkExtent2D){W, H};
    wrap_reset();
    wrap.unknown_function = "vkCmdDispatch";
    expect_device_error("vkCmdDispatch");
    wrap.unknown_function = "vkGetPhysicalDeviceMemoryProperties";
    expect_device_error("vkGetPhysicalDeviceMemoryProperties");
    wrap_reset();
}

/* The requirement on a device is that of the largest layout: with exactly as many storage buffers
 * all features are on; with one fewer, reflections are off, and the plan gives the reason. */
static void storage_buffers_are_counted_as_they_are_bound(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_reflections", "test_reserve", "test_skin"};
    static masu_plan_info plan;
    int culled = 0;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        masu_session own;
        masu_detail detail;
        masu_memory need;
        masu_session_desc d = test_desc(scenes[i], W, H);
        wrap_reset();
        d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
        open_session(&own, &d);
        uint32_t bound = wrap.most.storage_buffers;
        size_t bytes; /* the session has freed its blob, which planning textures needs */
        void *blob = read_file(scene_path(scenes[i]), &bytes);
        masu_scene scene;
        assert_int_equal(masu_scene_bind(blob, bytes, &scene, NULL), MASU_OK);
        own.desc.scene = &scene;
        print_message("  %s binds %u storage buffers in a stage\n", scenes[i], bound);
        assert_in_range(bound, 4, 9); /* a Raspberry Pi has 8 */
        wrap.max_storage_buffers = bound;
        assert_int_equal(masu_plan(&own.desc, &plan, &detail), MASU_OK);
        assert_true(pass_of(&plan, "specular_composite")->active);
        uint32_t culls = pass_of(&plan, "cull")->active;
        culled += culls != 0;
        wrap.max_storage_buffers = bound - 1;
        assert_int_equal(masu_plan(&own.desc, &plan, &detail), MASU_OK);
        assert_false(pass_of(&plan, "specular_composite")->active);
        assert_non_null(
            strstr(pass_of(&plan, "specular_composite")->why, "too few storage buffers"));
        /* Occlusion culling needs fewer, so it remains on. */
        assert_int_equal(pass_of(&plan, "cull")->active, culls);
        own.desc.rung_count = 1;
        own.desc.rungs[0] = (masu_rung){.specular = MASU_ON};
        assert_int_equal(masu_memory_query(&own.desc, &need, &detail), MASU_ERROR_DEVICE);
        assert_int_equal(detail.needed, bound);
        assert_int_equal(detail.given, bound - 1);
        assert_non_null(strstr(detail.text, "rungs[0].specular needs"));
        /* lights on glass and particles: the minimum of every device is enough */
        if (!strcmp(scenes[i], "test_reserve")) {
            own.desc.rungs[0] = (masu_rung){.specular = MASU_OFF, .occlusion = MASU_OFF};
            own.desc.reserve.particles = 1;
            wrap.max_storage_buffers = 4;
            assert_int_equal(masu_plan(&own.desc, &plan, &detail), MASU_OK);
            assert_true(pass_of(&plan, "light_tiles")->active &&
                        pass_of(&plan, "transparents")->active &&
                        pass_of(&plan, "particles")->active);
        }
        own.desc.rungs[0] = (masu_rung){.specular = MASU_OFF};
        wrap.max_storage_buffers = 1;
        assert_int_equal(masu_memory_query(&own.desc, &need, &detail), MASU_ERROR_DEVICE);
        assert_non_null(strstr(detail.text, "the scene needs"));
        close_session(&own);
        free(blob);
    }
    assert_true(culled > 0);
    wrap_reset();
}

static VkFormat format_of(const char *image) {
    static masu_plan_info plan;
    masu_detail detail;
    assert_int_equal(masu_plan(&s.desc, &plan, &detail), MASU_OK);
    for (uint32_t i = 0; i < plan.image_count; i++)
        if (!strcmp(plan.images[i].name, image))
            return plan.images[i].used ? plan.images[i].format : VK_FORMAT_UNDEFINED;
    return VK_FORMAT_UNDEFINED;
}

/* No device needs to filter 16-bit unorm: a device that does not keeps the history in half
 * floats. */
static void a_device_that_does_not_filter_unorm_has_halves(void **state) {
    (void)state;
    masu_desc was = s.desc;
    wrap_reset();
    s.desc.rung_count = 1;
    s.desc.rungs[0] = (masu_rung){.temporal = MASU_ON};
    assert_int_equal(format_of("history"), VK_FORMAT_R16G16B16A16_UNORM);
    wrap.lacking_format = VK_FORMAT_R16G16B16A16_UNORM;
    assert_int_equal(format_of("history"), VK_FORMAT_R16G16B16A16_SFLOAT);
    wrap_reset();
    s.desc.deny.unorm16 = 1;
    assert_int_equal(format_of("history"), VK_FORMAT_R16G16B16A16_SFLOAT);
    s.desc = was;
}

static void expect_frame_error(masu_renderer *m, const masu_frame_desc *frame, const char *what) {
    masu_commands commands;
    memset(&commands, 0, sizeof commands);
    assert_int_equal(masu_frame(m, frame, &commands, &failure), MASU_ERROR_ARGUMENT);
    const masu_detail *detail = (&failure);
    if (!strstr(detail->what, what))
        fail_msg("'%s' names '%s', not '%s'", detail->text, detail->what, what);
    assert_null(commands.buffer);
}

static void nonsense_in_a_frame_is_refused_by_name(void **state) {
    (void)state;
    masu_detail detail;
    masu_renderer *m;
    masu_commands commands;
    wrap_reset();
    assert_int_equal(try_init(&m, &detail), MASU_OK);
    load_all(&s, m);
    const masu_camera good = {.position = {0, 0, 5}, .forward = {0, 0, -1}, .fov_y = 1.0f};
    masu_camera c;
    masu_frame_desc f = {MASU_FRAME_DESC, .camera = &c};
    masu_light l = {.sun_direction = {0, 1, 0}}, bad_light;
    float params[300] = {0};
    c = good;
    f.rung = 3, expect_frame_error(m, &f, "rung"), f.rung = 0;
    f.target = 1, expect_frame_error(m, &f, "target"), f.target = 0;
    f.time = (double)NAN, expect_frame_error(m, &f, "time"), f.time = 0;
    f.time_step = INFINITY, expect_frame_error(m, &f, "time"), f.time_step = 0;
    c.position[1] = (double)NAN, expect_frame_error(m, &f, "camera.position"), c = good;
    c.position[2] = (double)INFINITY, expect_frame_error(m, &f, "camera.position"), c = good;
    c.forward[2] = 0, expect_frame_error(m, &f, "camera.forward"), c = good;
    c.forward[0] = NAN, expect_frame_error(m, &f, "camera.forward"), c = good;
    c.up[2] = -2, expect_frame_error(m, &f, "camera.up"), c = good;
    c.up[0] = INFINITY, expect_frame_error(m, &f, "camera.up"), c = good;
    c.fov_y = 0, expect_frame_error(m, &f, "camera.fov_y"), c = good;
    c.fov_y = 3.2f, expect_frame_error(m, &f, "camera.fov_y"), c = good;
    c.fov_y = NAN, expect_frame_error(m, &f, "camera.fov_y"), c = good;
    c.near_distance = -1, expect_frame_error(m, &f, "camera.near_distance"), c = good;
    bad_light = l, bad_light.sun_direction[1] = 0, f.light = &bad_light,
    expect_frame_error(m, &f, "sun_direction");
    bad_light = l, bad_light.ambient[1] = NAN, expect_frame_error(m, &f, "light");
    bad_light = l, bad_light.exposure = -1, expect_frame_error(m, &f, "exposure");
    /* Also if no other value makes them relevant. */
    bad_light = l, bad_light.ground[2] = NAN, expect_frame_error(m, &f, "light.ground");
    bad_light = l, bad_light.fog_color[0] = INFINITY, expect_frame_error(m, &f, "light.fog_color");
    bad_light = l, bad_light.fog_start = NAN, expect_frame_error(m, &f, "light.fog_start");
    bad_light = l, bad_light.turbidity = NAN, expect_frame_error(m, &f, "light.turbidity");
    f.light = &l;
    c.left = c.bottom = -1, c.right = c.top = 1, c.fov_y = NAN,
    expect_frame_error(m, &f, "camera.fov_y"), c = good;
    uint32_t own = masu_scene_count(&s.scene, MASU_SCENE_SDF_PARAM);
    f.sdf_params = params, f.sdf_param_count = own + 1,
    expect_frame_error(m, &f, "sdf_param_count");
    f.sdf_params = params, f.sdf_param_count = 300, expect_frame_error(m, &f, "sdf_param_count"),
    f.sdf_params = NULL, f.sdf_param_count = 0;
    /* The failed calls have not advanced the frame number, and extreme but valid values work. */
    c.fov_y = 3.1f, c.position[0] = 1e12, c.forward[0] = 1e-30f, c.forward[2] = -1e-30f,
    c.near_distance = 1e-6f;
    assert_int_equal(masu_frame(m, &f, &commands, &failure), MASU_OK);
    assert_int_equal(commands.frame, 0);
    char error[ERROR_SIZE];
    assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    masu_stats_info stats;
    assert_int_equal(masu_stats(m, commands.slot, &stats, &failure), MASU_OK);
    assert_int_equal(stats.replaced, 0);
    float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_int_equal(masu_instance_set_transform(m, (masu_instance){0}, rows, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_set_transform(m, (masu_instance){99}, rows, &failure),
                     MASU_ERROR_ARGUMENT);
    rows[5] = NAN;
    assert_int_equal(masu_instance_set_transform(m, masu_instance_at(m, 0), rows, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_find(m, "no such name").id, 0);
    masu_readback_image image;
    assert_int_equal(masu_readback(m, 0, (masu_readback_bits)3, &image, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_readback(m, 9, MASU_READBACK_DEPTH, &image, &failure),
                     MASU_ERROR_ARGUMENT);
    masu_destroy(m);
    assert_int_equal(wrap.live, 0);
}

/* ---- The log, and blocks of the host --------------------------------------------------------- */

static struct {
    uint32_t errors;
    char last[256];
} logged;

static void log_line(void *user, masu_log_level level, const char *text) {
    (void)user;
    if (level != MASU_LOG_ERROR) return;
    logged.errors++;
    snprintf(logged.last, sizeof logged.last, "%s", text);
}

#define LOGGED(call)                                                                               \
    do {                                                                                           \
        uint32_t before = logged.errors;                                                           \
        assert_true((call) < 0);                                                                   \
        if (logged.errors != before + 1) fail_msg("%s: %u lines", #call, logged.errors - before);  \
        assert_string_equal(logged.last, failure.text);                                \
    } while (0)

static void errors_of_live_calls_reach_the_log(void **state) {
    (void)state;
    static const float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, bad[12] = {NAN};
    masu_detail detail;
    masu_renderer *m;
    masu_commands commands;
    masu_instance_state instance;
    masu_model_state model;
    masu_model added;
    masu_node_state node;
    masu_punctual_light_state light = {.radius = 1};
    masu_punctual_light made;
    masu_material_state material;
    masu_split split;
    masu_governor_state learnt;
    wrap_reset();
    s.desc.log = log_line;
    assert_int_equal(try_init(&m, &detail), MASU_OK);
    s.desc.log = NULL;
    logged.errors = 0;
    LOGGED(masu_load(m, NULL, &failure));
    LOGGED(masu_frame(m, &(masu_frame_desc){MASU_FRAME_DESC}, &commands, &failure));
    assert_string_equal(failure.what, "masu_load"); /* not loaded */
    LOGGED(masu_frame(m, NULL, &commands, &failure));
    LOGGED(masu_split_of(m, MASU_SPLIT_BEFORE_TONE, 0, 0, &split, &failure));
    LOGGED(masu_split_of(m, MASU_SPLIT_BEFORE_TONE, 0, 0, NULL, &failure));
    LOGGED(masu_governor_set(m, &(masu_governor_setting){.mode = MASU_GOVERNOR_ON}, &failure));
    LOGGED(masu_governor_save(m, &learnt, &failure));
    LOGGED(masu_governor_restore(m, NULL, &failure));
    LOGGED(masu_instance_get(m, (masu_instance){0}, &instance, &failure));
    LOGGED(masu_instance_get(m, masu_instance_at(m, 0), NULL, &failure));
    LOGGED(masu_instance_show(m, (masu_instance){0}, 0, &failure));
    LOGGED(masu_instance_set_transform(m, (masu_instance){0}, rows, &failure));
    LOGGED(masu_instance_set_transform(m, masu_instance_at(m, 0), bad, &failure));
    LOGGED(masu_model_get(m, (masu_model){0}, &model, &failure));
    LOGGED(masu_model_set_transform(m, (masu_model){0}, rows, &failure));
    LOGGED(masu_model_show(m, (masu_model){0}, 1, &failure));
    LOGGED(masu_model_add(m, (masu_model){0}, rows, &added, &failure));
    LOGGED(masu_model_remove(m, (masu_model){0}, &failure));
    LOGGED(masu_mesh_create(m, 0, &(masu_mesh_data){0}, rows, &added, &failure)); /* no reserve */
    LOGGED(masu_mesh_replace(m, (masu_model){0}, &(masu_mesh_data){0}, &failure));
    LOGGED(masu_mesh_deform(m, (masu_model){0}, rows, rows, 1, &failure));
    LOGGED(masu_model_node_get(m, (masu_model){0}, 0, &node, &failure));
    LOGGED(masu_model_node_set(m, (masu_model){0}, 0, rows, &failure));
    LOGGED(masu_model_animate(m, (masu_model){0}, NULL, 0, &failure));
    LOGGED(masu_punctual_light_get(m, (masu_punctual_light){0}, &light, &failure));
    LOGGED(masu_punctual_light_set(m, (masu_punctual_light){0}, &light, &failure));
    LOGGED(masu_punctual_light_add(m, &light, &made, &failure)); /* no reserve */
    light.inner = NAN;                                 /* for a light that is no spot */
    LOGGED(masu_punctual_light_add(m, &light, &made, &failure));
    assert_non_null(strstr(logged.last, "inner"));
    LOGGED(masu_punctual_light_remove(m, (masu_punctual_light){0}, &failure));
    LOGGED(masu_material_get(m, (masu_material){0}, &material, &failure));
    LOGGED(masu_material_set(m, (masu_material){0}, NULL, &failure));
    /* Functions that do not change the renderer. */
    masu_stats_info stats;
    masu_readback_image image;
    masu_pick_info pick;
    masu_frame_view view;
    masu_camera camera;
    LOGGED(masu_frame(m, &(masu_frame_desc){0}, &commands, &failure));
    assert_string_equal(failure.what, "bytes");
    LOGGED(masu_stats(m, 99, &stats, &failure));
    LOGGED(masu_stats(m, 0, NULL, &failure));
    LOGGED(masu_readback(m, 0, MASU_READBACK_ALL, &image, &failure));
    LOGGED(masu_readback(m, 99, MASU_READBACK_HDR, &image, &failure));
    LOGGED(masu_pick(m, 0, &pick, &failure));
    LOGGED(masu_frame_view_of(m, &view, &failure));
    LOGGED(masu_camera_at(m, (double)NAN, &camera, &failure));
    LOGGED(masu_light_of(m, NULL, &failure));
    logged.errors = 0;
    assert_int_equal(masu_resize(m, (VkExtent2D){8, 8}, &s.desc.targets, NULL, &detail),
                     MASU_ERROR_STATE);
    assert_int_equal(logged.errors, 1);
    assert_string_equal(logged.last, detail.text);
    assert_int_equal(masu_resize(m, (VkExtent2D){8, 8}, NULL, NULL, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(logged.errors, 2);
    masu_destroy(m);
}

static void blocks_of_the_host_are_checked(void **state) {
    (void)state;
    masu_detail detail;
    masu_renderer *m;
    masu_memory need;
    masu_desc was = s.desc;
    wrap_reset();
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    assert_true(need.roles[0].host_visible && need.roles[0].alignment > 1); /* on a CPU driver */
    masu_device_block *b = &s.desc.device_blocks[0];
    b->memory = (VkDeviceMemory)(uintptr_t)64; /* no Vulkan call uses it */
    b->bytes = need.roles[0].bytes;
    b->memory_type = need.roles[0].type;
    b->mapped = (unsigned char *)block + 1;
    assert_int_equal(try_init(&m, &detail), MASU_ERROR_MEMORY);
    assert_non_null(strstr(detail.text, "mapped is not aligned"));
    b->mapped = block;
    b->offset = UINT64_MAX / need.roles[0].alignment * need.roles[0].alignment;
    assert_int_equal(try_init(&m, &detail), MASU_ERROR_MEMORY);
    assert_string_equal(detail.what, "device_blocks[MASU_ROLE_DEVICE]");
    assert_int_equal(detail.given, b->bytes);
    assert_true(detail.needed == UINT64_MAX - b->offset);
    assert_int_equal(wrap.live, 0);
    s.desc = was;
}

/* ---- Waits ----------------------------------------------------------------------------------- */

/* On a CPU driver, whose work stops with the process, a wait has no limit. On other drivers it has,
 * and after a timeout no object that may be in use is destroyed. */
static void a_wait_that_times_out_fails_cleanly(void **state) {
    (void)state;
    masu_detail detail;
    masu_renderer *m;
    masu_commands commands;
    char error[ERROR_SIZE] = "";
    wrap_reset();
    assert_int_equal(try_init(&m, &detail), MASU_OK);
    load_all(&s, m);
    masu_headless was = s.host;
    s.host.wait_ns = 0;
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(masu_frame(m, &(masu_frame_desc){MASU_FRAME_DESC}, &commands, &failure),
                         MASU_OK);
        assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    }
    s.host.properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    int finished = 1;
    for (uint32_t i = 0; i < 100 && finished;
         i++) { /* it may be faster than 120 checks of a fence */
        assert_int_equal(masu_frame(m, &(masu_frame_desc){MASU_FRAME_DESC}, &commands, &failure),
                         MASU_OK);
        finished = masu_headless_run(&s.host, commands.buffer, error, sizeof error);
    }
    assert_false(finished);
    assert_non_null(strstr(error, "did not finish"));
    assert_false(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    masu_headless_target_destroy(&s.host, &s.targets[0]); /* these do nothing */
    masu_headless_close(&s.host);
    was.pending[0] = true;
    s.host = was;
    assert_ok(masu_headless_wait(&s.host, 0, error, sizeof error));
    masu_destroy(m);
}

/* Neither plan nor query leaves objects behind. */
static void any_call_of_a_query_may_fail(void **state) {
    (void)state;
    static masu_plan_info plan;
    masu_detail detail;
    masu_memory need;
    wrap_reset();
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    uint64_t calls = wrap.setup_calls;
    assert_true(calls > 5);
    for (uint64_t k = 1; k <= calls; k++) {
        for (int query = 0; query < 2; query++) {
            wrap_reset();
            wrap.fail_at = k;
            wrap.fail_with = VK_ERROR_OUT_OF_DEVICE_MEMORY;
            masu_result result = query ? masu_memory_query(&s.desc, &need, &detail)
                                       : masu_plan(&s.desc, &plan, &detail);
            assert_int_equal(result, MASU_ERROR_VULKAN);
            assert_string_equal(detail.what, wrap.failed_call);
            assert_int_equal(wrap.live, 0);
        }
    }
    wrap_reset();
}

/* Singular, mirrored, huge and tiny transforms: a defined image without a single replaced value. */
static void extreme_transforms_stay_finite(void **state) {
    (void)state;
    static const float diagonals[][3] = {{0, 0, 0},
                                         {1, 0, 1},
                                         {-1, 1, 1},
                                         {1e18f, 1e18f, 1e18f},
                                         {1e-18f, 1e-18f, 1e-18f},
                                         {3e38f, 1, 1e-38f},
                                         {1, 1e-30f, 1}};
    masu_detail detail;
    masu_renderer *m;
    masu_commands commands;
    char error[ERROR_SIZE];
    wrap_reset();
    assert_int_equal(try_init(&m, &detail), MASU_OK);
    load_all(&s, m);
    for (size_t i = 0; i < sizeof diagonals / sizeof *diagonals; i++) {
        const float *d = diagonals[i];
        float rows[12] = {d[0], 0, 0, 0, 0, d[1], 0, 0, 0, 0, d[2], 0};
        masu_frame_desc f = {MASU_FRAME_DESC};
        masu_stats_info stats;
        masu_readback_image depth, hdr;
        assert_int_equal(masu_instance_set_transform(m, masu_instance_at(m, 0), rows, &failure),
                         MASU_OK);
        assert_int_equal(masu_frame(m, &f, &commands, &failure), MASU_OK);
        assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
        assert_int_equal(masu_stats(m, commands.slot, &stats, &failure), MASU_OK);
        assert_int_equal(stats.replaced, 0);
        assert_int_equal(masu_readback(m, commands.slot, MASU_READBACK_DEPTH, &depth, &failure),
                         MASU_OK);
        assert_int_equal(masu_readback(m, commands.slot, MASU_READBACK_HDR, &hdr, &failure),
                         MASU_OK);
        for (uint32_t k = 0; k < W * H; k++) {
            float v = ((const float *)depth.pixels)[k];
            assert_true(v >= 0.0f && v <= 1.0f);
            const uint16_t *half = (const uint16_t *)hdr.pixels + 4 * k;
            for (uint32_t ch = 0; ch < 4; ch++)
                assert_true((half[ch] & 0x7C00) != 0x7C00); /* no Inf, no NaN */
        }
    }
    masu_destroy(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_call_of_init_may_run_out_of_memory_once),
        cmocka_unit_test(any_call_of_init_may_fail_for_good),
        cmocka_unit_test(the_device_may_be_lost_at_any_call_of_init),
        cmocka_unit_test_setup_teardown(any_call_of_init_may_fail_with_a_shadow_map,
                                        open_shadows_instead, open_the_first_again),
        cmocka_unit_test_setup_teardown(any_call_of_init_with_textures_may_fail,
                                        open_textures_instead, open_the_first_again),
        cmocka_unit_test(what_the_device_lacks_is_named),
        cmocka_unit_test(a_device_that_does_not_filter_unorm_has_halves),
        cmocka_unit_test(storage_buffers_are_counted_as_they_are_bound),
        cmocka_unit_test(nonsense_in_a_frame_is_refused_by_name),
        cmocka_unit_test(errors_of_live_calls_reach_the_log),
        cmocka_unit_test(blocks_of_the_host_are_checked),
        cmocka_unit_test(a_wait_that_times_out_fails_cleanly),
        cmocka_unit_test(any_call_of_a_query_may_fail),
        cmocka_unit_test(extreme_transforms_stay_finite),
    };
    return cmocka_run_group_tests_name("failures", tests, open_without_renderer, close_again);
}
