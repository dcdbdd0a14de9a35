/* test_device_query.c: masu_device_query before the device exists: it names the features that
 * masu_init then uses, or reports as supported but not enabled, and the required ones that are
 * missing. With MASU_DENY=all the description disables all optional features, and the host enables
 * none. */
#include "support/support.h"
#include "support/wrap.h"

#include <stdio.h>
#include <string.h>

enum { W = 16, H = 16, BC = MASU_FEATURE_TEXTURE_COMPRESSION_BC,
       ANISOTROPY = MASU_FEATURE_SAMPLER_ANISOTROPY,
       RAYS = MASU_FEATURE_RAY_QUERY,
       HALVES = MASU_FEATURE_SHADER_FLOAT16 };

static masu_session s;
static char logged[8192];

static void collect(void *user, masu_log_level level, const char *text) {
    (void)user;
    size_t used = strlen(logged);
    snprintf(logged + used, sizeof logged - used, "%d %s\n", (int)level, text);
}

static void open_scene(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.no_renderer = true;
    d.host.ray_query = true;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 0.5f, .easu = MASU_EASU_FAST, .shadow_resolution = 64};
    wrap_reset();
    open_session(&s, &d);
    s.desc.log = collect;
    logged[0] = 0;
}

/* The description of a host that has no device and no targets yet. */
static masu_desc before_device(void) {
    masu_desc d = s.desc;
    d.vulkan = (masu_vulkan){.get_instance_proc_addr = wrap_get_instance_proc_addr,
                             .instance = s.host.instance,
                             .physical_device = s.host.physical,
                             .queue_family = s.host.family};
    d.targets.images = NULL;
    d.targets.views = NULL;
    d.targets.count = 0;
    return d;
}

static masu_device_info query(const masu_desc *d) {
    masu_device_info info;
    masu_detail detail;
    memset(&info, 0xa5, sizeof info);
    if (masu_device_query(d, &info, &detail)) fail_msg("%s", detail.text);
    assert_int_equal(info.used & ~info.supported, 0);
    uint32_t expected = (info.used & RAYS ? 7 : 0) + (info.used & HALVES ? 1 : 0);
    assert_int_equal(info.extension_count, expected);
    return info;
}

static int names(const masu_device_info *info, const char *extension) {
    for (uint32_t i = 0; i < info->extension_count; i++)
        if (!strcmp(info->extensions[i], extension)) return 1;
    return 0;
}

static void without_a_scene_it_is_what_the_device_has(void **state) {
    (void)state;
    VkPhysicalDeviceFeatures has;
    open_scene("test_texture_quad");
    masu_desc d = before_device();
    d.scene = NULL;
    masu_device_info info = query(&d);
    vkGetPhysicalDeviceFeatures(s.host.physical, &has);
    assert_int_equal((info.supported & BC) != 0, has.textureCompressionBC);
    assert_int_equal((info.supported & ANISOTROPY) != 0, has.samplerAnisotropy);
    assert_float_equal(info.max_anisotropy,
                       has.samplerAnisotropy ? s.host.properties.limits.maxSamplerAnisotropy : 0.0f,
                       0.0f);
    assert_int_equal(info.used, info.supported);
    assert_int_equal(names(&info, VK_KHR_RAY_QUERY_EXTENSION_NAME), (info.supported & RAYS) != 0);
    assert_int_equal(names(&info, VK_KHR_SHADER_FLOAT16_INT8_EXTENSION_NAME),
                     (info.supported & HALVES) != 0);
    if (!masu_session_denied()) { /* the host has enabled exactly these */
        assert_int_equal(s.host.ray_query, (info.used & RAYS) != 0);
        assert_int_equal(s.host.float16, (info.used & HALVES) != 0);
    }
    d.ray_query = d.half_floats = MASU_OFF;
    info = query(&d);
    assert_int_equal(info.used, info.supported & (BC | ANISOTROPY));
    wrap.no_extensions = true; /* feature bits without the extension that they belong to */
    d.ray_query = d.half_floats = MASU_AUTO;
    assert_int_equal(query(&d).supported, info.supported & (BC | ANISOTROPY));
    wrap_reset();
    wrap.no_features = true;
    info = query(&d);
    assert_int_equal(info.supported, 0);
    assert_true(info.max_anisotropy == 0.0f);
    close_session(&s);
}

/* masu_init reports supported features that the host has not enabled. `gpu`: the device is
 * presented as a GPU, because CPUs use no ray queries and no 16-bit floats; `traced`: reflections
 * use rays. */
static void compare_with_log(const char *scene, int gpu, int traced) {
    char error[ERROR_SIZE];
    open_scene(scene);
    wrap.fake_memory = gpu;
    masu_desc d = before_device();
    masu_device_info info = query(&d);
    s.desc.vulkan.texture_compression_bc = s.desc.vulkan.ray_query = 0;
    s.desc.vulkan.shader_float16 = 0, s.desc.vulkan.max_anisotropy = 0.0f;
    assert_ok(masu_session_start(&s, error, sizeof error));
    assert_int_equal(strstr(logged, "vulkan.texture_compression_bc is 0") != NULL,
                     (info.used & BC) != 0);
    assert_int_equal(strstr(logged, "vulkan.max_anisotropy is 0") != NULL,
                     (info.used & ANISOTROPY) != 0);
    assert_int_equal(strstr(logged, "vulkan.ray_query is 0") != NULL, (info.used & RAYS) != 0);
    assert_int_equal(strstr(logged, "vulkan.shader_float16 is 0") != NULL,
                     (info.used & HALVES) != 0);
    if (gpu) assert_int_equal(info.used & HALVES, info.supported & HALVES);
    if (gpu && traced) assert_int_equal(info.used & RAYS, info.supported & RAYS);
    if (!gpu) assert_int_equal(info.used & (RAYS | HALVES), 0);
    if (!masu_scene_texture_bytes(&s.scene, 0))
        assert_int_equal(info.used & (BC | ANISOTROPY), 0);
    close_session(&s);
}

static void with_a_scene_it_is_what_init_uses(void **state) {
    (void)state;
    compare_with_log("test_texture_quad", 0, 0);
    compare_with_log("test_texture_quad", 1, 0);
    compare_with_log("test_reflections", 0, 1);
    compare_with_log("test_reflections", 1, 1);
}

static void expect_missing(const masu_desc *d, masu_result result, const char *what, int needed,
                           const char *text) {
    masu_detail detail;
    masu_device_info info, was;
    memset(&detail, 0, sizeof detail);
    memset(&info, 0xa5, sizeof info);
    was = info;
    logged[0] = 0;
    assert_int_equal(masu_device_query(d, &info, &detail), result);
    assert_string_equal(detail.what, what);
    assert_true(!needed || detail.needed != detail.given);
    if (!strstr(detail.text, text)) fail_msg("'%s' without '%s'", detail.text, text);
    /* The log of a description with another size is unknown. */
    assert_true(d->bytes != sizeof *d || strstr(logged, detail.text));
    assert_memory_equal(&info, &was, sizeof info);
}

/* A Vulkan 1.0 device: the extensions that it needs are listed, and no feature of later versions. */
static void vulkan_1_0_needs_three_extensions(void **state) {
    (void)state;
    masu_device_info info;
    open_scene("test_reflections");
    masu_desc d = before_device();
    d.scene = NULL;
    wrap.api_version = VK_API_VERSION_1_0;
    assert_int_equal(masu_device_query(&d, &info, NULL), MASU_OK);
    assert_int_equal(info.supported & (RAYS | HALVES), 0);
    assert_int_equal(info.extension_count, 3);
    assert_true(names(&info, VK_KHR_STORAGE_BUFFER_STORAGE_CLASS_EXTENSION_NAME));
    assert_true(names(&info, VK_KHR_MAINTENANCE1_EXTENSION_NAME));
    assert_true(names(&info, VK_KHR_MAINTENANCE2_EXTENSION_NAME));
    wrap.no_extensions = true;
    expect_missing(&d, MASU_ERROR_DEVICE, VK_KHR_STORAGE_BUFFER_STORAGE_CLASS_EXTENSION_NAME, 1,
                   "with Vulkan 1.0 lacks the extension");
    wrap.api_version = VK_API_VERSION_1_1;
    assert_int_equal(masu_device_query(&d, &info, NULL), MASU_OK);
    assert_int_equal(info.extension_count, 0);
    wrap_reset();
    close_session(&s);
}

static void what_is_required_and_missing_is_named(void **state) {
    (void)state;
    open_scene("test_reflections");
    for (int scene = 0; scene < 2; scene++) {
        masu_desc d = before_device();
        if (!scene) d.scene = NULL;
        wrap_reset();
        wrap.api_version = VK_API_VERSION_1_0;
        wrap.no_extensions = true;
        expect_missing(&d, MASU_ERROR_DEVICE, "VK_KHR_storage_buffer_storage_class", 1,
                       "with Vulkan 1.0 lacks the extension");
        wrap_reset();
        wrap.lacking_format = VK_FORMAT_D32_SFLOAT;
        expect_missing(&d, MASU_ERROR_DEVICE, "VK_FORMAT_D32_SFLOAT", 1, "lacks features");
        wrap_reset();
        wrap.no_compute = true;
        expect_missing(&d, MASU_ERROR_DEVICE, "queue family with graphics and compute", 1, "lacks");
        wrap_reset();
        wrap.unknown_function = "vkGetPhysicalDeviceFormatProperties";
        expect_missing(&d, MASU_ERROR_DEVICE, "vkGetPhysicalDeviceFormatProperties", 1, "knows no");
        wrap_reset();
        d.vulkan.queue_family = 99;
        expect_missing(&d, MASU_ERROR_ARGUMENT, "vulkan.queue_family", 1, "99");
        d.vulkan.physical_device = NULL;
        expect_missing(&d, MASU_ERROR_ARGUMENT, "vulkan.physical_device", 0, "NULL");
        d.bytes = 4;
        expect_missing(&d, MASU_ERROR_ARGUMENT, "bytes", 1, "4");
    }
    masu_desc d = before_device();
    wrap.no_features = true;
    d.ray_query = MASU_ON;
    expect_missing(&d, MASU_ERROR_DEVICE, "vulkan.ray_query", 1, "does not offer VK_KHR_ray_query");
    d.ray_query = MASU_AUTO, d.half_floats = MASU_ON;
    expect_missing(&d, MASU_ERROR_DEVICE, "vulkan.shader_float16", 1,
                   "does not offer shaderFloat16");
    d.half_floats = MASU_AUTO, wrap_reset();
    wrap.max_storage_buffers = 1;
    expect_missing(&d, MASU_ERROR_DEVICE, "maxPerStageDescriptorStorageBuffers", 1,
                   "the device has 1");
    wrap_reset();
    assert_int_equal(masu_device_query(&d, NULL, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_device_query(NULL, &(masu_device_info){0}, NULL), MASU_ERROR_ARGUMENT);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_scene_it_is_what_the_device_has),
        cmocka_unit_test(with_a_scene_it_is_what_init_uses),
        cmocka_unit_test(vulkan_1_0_needs_three_extensions),
        cmocka_unit_test(what_is_required_and_missing_is_named),
    };
    return cmocka_run_group_tests_name("device_query", tests, NULL, NULL);
}
