/* test_ray_query.c: the device's ray queries find the same hits as the library's own BVH. The
 * reference is the own traversal: two implementations that share no code, on the same rays.
 *
 * On drivers without ray queries the test checks that they are rejected by name; it lists the
 * drivers of the test suite that have them. */
#include "support/support.h"
#include "support/wrap.h"

#include "alloc_count.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 96, H = 80, TEXELS = W / 2 * (H / 2), FRAMES = 5 };

/* ---- The hit image --------------------------------------------------------------------------- */

typedef struct hit {
    float t;
    uint32_t instance, triangle, barycentrics;
} hit;

/* Hooks between renderer and driver: they allow copies from the image of hits, and copy it at the
 * end of the pass that fills it. */
static struct {
    VkImage image;
    VkBuffer buffer;
    VkDeviceMemory memory;
    const hit *mapped;
    int tracing;
    uint32_t copies;
    /* Not checked by any layer: barriers before builds, and between the build and the queries of a
     * frame. */
    uint32_t before_builds, before_queries;
} tap;

static VKAPI_ATTR VkResult VKAPI_CALL tap_create_image(VkDevice device,
                                                       const VkImageCreateInfo *info,
                                                       const VkAllocationCallbacks *allocator,
                                                       VkImage *out) {
    VkImageCreateInfo own = *info;
    int hits = info->format == VK_FORMAT_R32G32B32A32_UINT;
    if (hits) own.usage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkResult r = vkCreateImage(device, &own, allocator, out);
    if (hits && !r) tap.image = *out;
    return r;
}

static VKAPI_ATTR void VKAPI_CALL tap_pipeline_barrier(
    VkCommandBuffer cmd, VkPipelineStageFlags from, VkPipelineStageFlags to,
    VkDependencyFlags flags, uint32_t memory_count, const VkMemoryBarrier *memory,
    uint32_t buffer_count, const VkBufferMemoryBarrier *buffers, uint32_t image_count,
    const VkImageMemoryBarrier *images) {
    const VkAccessFlags written = VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
    const VkAccessFlags read = VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR;
    const VkPipelineStageFlags build = VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
    if (memory_count && to == build && memory->srcAccessMask && (memory->dstAccessMask & read) &&
        (memory->dstAccessMask & VK_ACCESS_SHADER_READ_BIT))
        tap.before_builds++;
    if (memory_count && (from & build) && (to & VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT) &&
        (memory->srcAccessMask & written) && (memory->dstAccessMask & read))
        tap.before_queries++;
    vkCmdPipelineBarrier(cmd, from, to, flags, memory_count, memory, buffer_count, buffers,
                         image_count, images);
}

static void tap_barrier(VkCommandBuffer cmd, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                              .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                              .dstAccessMask =
                                  VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                              .oldLayout = from,
                              .newLayout = to,
                              .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .image = tap.image,
                              .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &b);
}

static VKAPI_ATTR void VKAPI_CALL tap_begin_label(VkCommandBuffer cmd,
                                                  const VkDebugUtilsLabelEXT *label) {
    (void)cmd;
    tap.tracing = !strcmp(label->pLabelName, "specular_trace") ||
                  !strcmp(label->pLabelName, "specular_query");
}

static VKAPI_ATTR void VKAPI_CALL tap_end_label(VkCommandBuffer cmd) {
    if (!tap.tracing) return;
    VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              .imageExtent = {W / 2, H / 2, 1}};
    tap_barrier(cmd, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vkCmdCopyImageToBuffer(cmd, tap.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, tap.buffer, 1,
                           &copy);
    tap_barrier(cmd, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL);
    tap.tracing = 0;
    tap.copies++;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL tap_device_proc(VkDevice device, const char *name) {
    if (!strcmp(name, "vkCreateImage")) return (PFN_vkVoidFunction)tap_create_image;
    if (!strcmp(name, "vkCmdPipelineBarrier")) return (PFN_vkVoidFunction)tap_pipeline_barrier;
    return vkGetDeviceProcAddr(device, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL tap_instance_proc(VkInstance instance,
                                                                  const char *name) {
    if (!strcmp(name, "vkGetDeviceProcAddr")) return (PFN_vkVoidFunction)tap_device_proc;
    if (!strcmp(name, "vkCmdBeginDebugUtilsLabelEXT")) return (PFN_vkVoidFunction)tap_begin_label;
    if (!strcmp(name, "vkCmdEndDebugUtilsLabelEXT")) return (PFN_vkVoidFunction)tap_end_label;
    return vkGetInstanceProcAddr(instance, name);
}

static void tap_open(masu_headless *host) {
    memset(&tap, 0, sizeof tap);
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = TEXELS * sizeof(hit),
                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    assert_int_equal(vkCreateBuffer(host->device, &info, NULL, &tap.buffer), VK_SUCCESS);
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(host->device, tap.buffer, &need);
    VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = 0;
    while (!(need.memoryTypeBits & 1u << type) ||
           (host->memory.memoryTypes[type].propertyFlags & wanted) != wanted)
        type++;
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = need.size,
                                     .memoryTypeIndex = type};
    void *mapped;
    assert_int_equal(vkAllocateMemory(host->device, &allocate, NULL, &tap.memory), VK_SUCCESS);
    assert_int_equal(vkBindBufferMemory(host->device, tap.buffer, tap.memory, 0), VK_SUCCESS);
    assert_int_equal(vkMapMemory(host->device, tap.memory, 0, VK_WHOLE_SIZE, 0, &mapped),
                     VK_SUCCESS);
    tap.mapped = mapped;
}

static void tap_close(masu_headless *host) {
    vkDestroyBuffer(host->device, tap.buffer, NULL);
    vkFreeMemory(host->device, tap.memory, NULL);
}

/* ---- Sessions -------------------------------------------------------------------------------- */

static masu_session_desc ray_desc_of(const char *scene, masu_switch way) {
    masu_session_desc d = test_desc(scene, W, H);
    d.host.ray_query = true;
    d.desc.ray_query = way;
    d.desc.rung_count = 1;
    /* Without the images of pixels, only the hit image has this format: tap_create_image. */
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f,
                                  .specular = MASU_ON,
                                  .specular_fine = MASU_OFF,
                                  .shadow_resolution = 64};
    return d;
}

static masu_session_desc ray_desc(masu_switch way) { return ray_desc_of("mirrors", way); }

static int offered = -1;

/* Queries the driver, once. Without ray queries the test ends, after an assertion of the behaviour
 * in that case. */
static int has_ray_queries(void) {
    masu_session_desc d = ray_desc(MASU_ON);
    masu_session s;
    masu_detail detail;
    masu_memory need;
    if (offered < 0) {
        const char *driver = getenv("MASU_TEST_DRIVER");
        d.no_renderer = true;
        open_session(&s, &d);
        offered = s.host.ray_query;
        if (driver && !strcmp(driver, "lavapipe-25"))
            assert_int_equal(offered, !masu_session_denied());
        if (!offered) {
            assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_DEVICE);
            assert_string_equal(detail.what, "vulkan.ray_query");
        }
        close_session(&s);
    }
    return offered;
}

static int runs(const masu_renderer *m, const char *pass) {
    masu_plan_info plan;
    masu_plan_of(m, &plan);
    for (uint32_t p = 0; p < plan.pass_count; p++) {
        if (!strcmp(plan.passes[p].name, pass)) return plan.passes[p].active != 0;
    }
    fail_msg("no pass %s", pass);
    return 0;
}

static uint64_t row_bytes(const masu_renderer *m, const char *kind, const char *name) {
    masu_memory_row rows[MEMORY_ROWS];
    uint32_t n = memory_rows(m, rows);
    for (uint32_t i = 0; i < n; i++) {
        if (!strcmp(rows[i].kind, kind) && !strcmp(rows[i].name, name)) return rows[i].bytes;
    }
    return 0;
}

/* ---- Which backend is used ------------------------------------------------------------------- */

static void a_device_without_them_is_refused_by_name(void **state) {
    (void)state;
    masu_session_desc d = ray_desc(MASU_ON);
    masu_session s;
    masu_detail detail;
    masu_memory need;
    d.host.ray_query = false;
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_DEVICE);
    assert_string_equal(detail.what, "vulkan.ray_query");
    assert_string_equal(detail.text,
                        "ray_query is MASU_ON, but vulkan.ray_query says that the device was "
                        "created without VK_KHR_ray_query");
    s.desc.ray_query = (masu_switch)3;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "ray_query");
    s.desc.ray_query = MASU_AUTO;
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    /* Nothing is reflected: no ray queries. */
    s.desc.ray_query = MASU_ON;
    s.desc.rungs[0].specular = MASU_OFF;
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    close_session(&s);
}

static void a_device_that_lacks_a_function_is_refused_by_name(void **state) {
    (void)state;
    masu_session_desc d = ray_desc(MASU_ON);
    masu_session s;
    masu_detail detail;
    masu_memory need;
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.no_renderer = true;
    open_session(&s, &d);
    s.desc.vulkan.ray_query = 1; /* even if it is not true */
    wrap.unknown_function = "vkCmdBuildAccelerationStructuresKHR";
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_DEVICE);
    assert_string_equal(detail.what, "vkCmdBuildAccelerationStructuresKHR");
    s.desc.ray_query = MASU_OFF;
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    wrap_reset();
    close_session(&s);
}

/* By the device's type, unless set. A CPU that is presented as a GPU is treated as one. */
static void auto_takes_them_on_gpus_alone(void **state) {
    (void)state;
    static const struct {
        masu_switch way;
        int fake, query;
    } cases[] = {{MASU_AUTO, 0, 0}, {MASU_AUTO, 1, 1}, {MASU_AUTO, 2, 1},
                 {MASU_OFF, 1, 0},  {MASU_ON, 0, 1},   {MASU_OFF, 0, 0}};
    if (!has_ray_queries()) return;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_session_desc d = ray_desc(cases[i].way);
        masu_session s;
        wrap_reset();
        d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
        wrap.fake_memory = cases[i].fake;
        open_session(&s, &d);
        if (!cases[i].fake && s.host.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) {
            close_session(&s); /* a real GPU: AUTO is tested by the simulated ones */
            continue;
        }
        assert_int_equal(runs(s.m, "specular_query"), cases[i].query);
        assert_int_equal(runs(s.m, "specular_structure"), cases[i].query);
        assert_int_equal(runs(s.m, "specular_trace"), !cases[i].query);
        assert_int_equal(row_bytes(s.m, "buffer", "bottom levels") > 0, cases[i].query);
        assert_int_equal(row_bytes(s.m, "host", "traced instances") > 0, !cases[i].query);
        assert_int_equal(s.need.roles[MASU_ROLE_DEVICE].device_address, cases[i].query);
        close_session(&s);
        assert_int_equal(wrap.live, 0);
    }
    wrap_reset();
}

/* ---- The same hits --------------------------------------------------------------------------- */

/* Every tile traces a ray, so that all of the image is written. The box is rotated, scaled and
 * mirrored, and in the fourth frame its matrix is singular: it is invisible. */
static void pose(uint32_t f, masu_camera *camera, float rows[12]) {
    static const double eyes[FRAMES][3] = {
        {0, 5, 5}, {2, 4.5, 4.5}, {-3, 4.5, 3}, {0, 5, -5}, {1, 6, 0.5}};
    static const float scales[FRAMES][3] = {
        {1, 1, 1}, {0.2f, 2, 1}, {-1, 1.5f, 1}, {0, 1, 1}, {1, 0.1f, -0.7f}};
    float c = cosf(0.7f * (float)f), s = sinf(0.7f * (float)f);
    const float *k = scales[f];
    const float placed[12] = {c * k[0], 0, s * k[2], 0.3f, 0, k[1], 0, 0.7f,
                              -s * k[0], 0, c * k[2], 0.8f};
    *camera = (masu_camera){.fov_y = 0.5f};
    for (uint32_t i = 0; i < 3; i++) {
        camera->position[i] = eyes[f][i];
        camera->forward[i] = (float)-eyes[f][i];
    }
    memcpy(rows, placed, sizeof placed);
}

/* Everything except the moving box, moved far out, where rays are relative to an anchor. */
static void move_all(masu_session *s, const masu_scene_view *v, const double by[3]) {
    for (uint32_t i = 0; i < masu_scene_count(&s->scene, MASU_SCENE_INSTANCE); i++) {
        float rows[12];
        memcpy(rows, v->instances[i].transform, sizeof rows);
        for (uint32_t k = 0; k < 3; k++) rows[4 * k + 3] = (float)((double)rows[4 * k + 3] + by[k]);
        assert_int_equal(masu_instance_set_transform(s->m, masu_instance_at(s->m, i), rows, NULL),
                         MASU_OK);
    }
}

static uint64_t structures, own;

static void trace_all(const char *scene, masu_switch way, uint32_t split, const double by[3],
                      hit *hits, uint8_t *pixels) {
    masu_session_desc d = ray_desc_of(scene, way);
    masu_session s;
    char error[ERROR_SIZE];
    d.no_renderer = true;
    d.desc.frames_in_flight = 2;
    d.desc.debug.labels = 1;
    d.desc.deny.unified_memory = split;
    d.host.get_instance_proc_addr = tap_instance_proc;
    open_session(&s, &d);
    tap_open(&s.host);
    masu_scene_view v = masu_scene_view_of(&s.scene);
    masu_blob_instance *instances =
        malloc(masu_scene_count(&s.scene, MASU_SCENE_INSTANCE) * sizeof *instances);
    memcpy(instances, v.instances,
           masu_scene_count(&s.scene, MASU_SCENE_INSTANCE) * sizeof *instances);
    v.instances = instances; /* loading frees the blob */
    assert_ok(masu_session_start(&s, error, sizeof error));
    assert_int_equal(tap.copies, 2);
    assert_int_equal(runs(s.m, "specular_query"), way == MASU_ON);
    assert_int_equal(tap.before_builds, way == MASU_ON ? masu_scene_data_of(&s.scene)->meshes : 0);
    assert_int_equal(tap.before_queries, way == MASU_ON ? 2 : 0);
    if (by) move_all(&s, &v, by);
    masu_instance box = masu_instance_find(s.m, "moving");
    for (uint32_t f = 0; f < FRAMES; f++) {
        masu_camera camera;
        masu_commands commands;
        float rows[12];
        pose(f, &camera, rows);
        for (uint32_t k = 0; k < 3 && by; k++) {
            camera.position[k] += by[k];
            rows[4 * k + 3] = (float)((double)rows[4 * k + 3] + by[k]);
        }
        /* Far out it is then stationary: in the last frame only the anchor moves. */
        if (!by || f == 0)
            assert_int_equal(masu_instance_set_transform(s.m, box, rows, NULL), MASU_OK);
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .cut = f == 0};
        draw(&s, &frame, &commands, pixels + (size_t)f * W * H * 4);
        memcpy(hits + (size_t)f * TEXELS, tap.mapped, TEXELS * sizeof(hit));
    }
    if (way == MASU_ON) {
        structures = row_bytes(s.m, "buffer", "bottom levels") +
                     row_bytes(s.m, "buffer", "top level") +
                     row_bytes(s.m, "buffer", "top level scratch") +
                     row_bytes(s.m, "buffer", "top level instances");
        own = row_bytes(s.m, "buffer", "traced scene") +
              row_bytes(s.m, "buffer", "traced instances");
    } else {
        own = row_bytes(s.m, "buffer", "traced scene") +
              row_bytes(s.m, "buffer", "traced instances") - own;
    }
    masu_headless_settle(&s.host);
    tap_close(&s.host);
    free(instances);
    close_session(&s);
}

static hit by_query[FRAMES * TEXELS], by_tree[FRAMES * TEXELS];
static uint8_t query_pixels[FRAMES * W * H * 4], tree_pixels[FRAMES * W * H * 4];

static void trace_both(const char *scene, uint32_t split, const double by[3]) {
    trace_all(scene, MASU_ON, split, by, by_query, query_pixels);
    trace_all(scene, MASU_OFF, split, by, by_tree, tree_pixels);
}

/* Equal hits, up to a different order of roundings. */
static void compare(const char *what, uint32_t least) {
    uint32_t met = 0, missed = 0, other = 0, differ = 0;
    double worst = 0.0, worst_weight = 0.0;
    for (uint32_t i = 0; i < FRAMES * TEXELS; i++) {
        const hit *q = &by_query[i], *t = &by_tree[i];
        if (!(t->t == -1.0f || (t->t > 0.0f && t->t < 1e4f)))
            fail_msg("texel %u was not written: %g", i, (double)t->t);
        if ((q->t >= 0.0f) != (t->t >= 0.0f)) {
            differ++;
            continue;
        }
        missed += t->t < 0.0f;
        if (t->t < 0.0f) continue;
        met++;
        double off = fabs((double)q->t - (double)t->t) / (double)t->t;
        if (off > worst) worst = off;
        /* On an edge shared by two triangles, either is correct. */
        if (q->instance != t->instance || q->triangle != t->triangle) {
            other++;
            continue;
        }
        for (uint32_t k = 0; k < 2; k++) {
            double a = (double)(q->barycentrics >> 16 * k & 0xFFFFu);
            double b = (double)(t->barycentrics >> 16 * k & 0xFFFFu);
            if (fabs(a - b) / 65535.0 > worst_weight) worst_weight = fabs(a - b) / 65535.0;
        }
    }
    uint32_t picture = max_difference(query_pixels, tree_pixels, sizeof tree_pixels);
    printf("%s: %u rays hit, %u missed, %u differ; t within %.1e, weights within %.1e, "
           "%u other triangles, pixels within %u\n",
           what, met, missed, differ, worst, worst_weight, other, picture);
    assert_int_equal(differ, 0);
    assert_true(met > least && missed > least);
    assert_true(worst <= 1e-4);
    assert_true(worst_weight <= 2e-2);
    assert_true(other * 200 <= met);
    assert_true(picture <= 2);
}

static void the_same_rays_meet_the_same(void **state) {
    (void)state;
    if (!has_ray_queries()) return;
    trace_both("mirrors", 0, NULL);
    compare("near", 500);
    printf("%llu bytes of structures, %llu of the replaced own BVHs\n",
           (unsigned long long)structures, (unsigned long long)own);
    assert_true(structures > 0 && own > 0);
}

static void far_out_the_same_rays_meet_the_same(void **state) {
    (void)state;
    /* The last camera is beyond the midpoint between two anchor positions, and the one before is
     * not. */
    const double far_out[3] = {(31250.0 + 0.5) * MASU_ANCHOR_GRID - 0.5, 0.0, -1.0e6};
    if (!has_ray_queries()) return;
    trace_both("mirrors", 1, far_out); /* and with a separate block for each role */
    compare("far out", 500);
}

/* Leaves over a mirror: a ray passes through their holes, equally often in both backends. */
static void through_the_holes_of_masks_they_meet_the_same(void **state) {
    (void)state;
    if (!has_ray_queries()) return;
    trace_both("test_mirror_masks", 0, NULL);
    compare("masks", 200);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static void sixty_frames_create_and_allocate_nothing(void **state) {
    (void)state;
    masu_session_desc d = ray_desc(MASU_ON);
    masu_session s;
    char error[ERROR_SIZE];
    if (!has_ray_queries()) return;
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.host.validate = false; /* the layer allocates inside the calls that it wraps */
    d.desc.output = (VkExtent2D){32, 24};
    open_session(&s, &d);
    uint64_t setup = wrap.setup_calls, heap = 0;
    int64_t live = wrap.live;
    assert_true(setup > 50);
    masu_instance box = masu_instance_find(s.m, "moving");
    for (uint32_t i = 0; i < 60; i++) {
        float rows[12] = {1, 0, 0, 0.05f * (float)i, 0, 1, 0, 0.5f, 0, 0, 1, 0};
        masu_frame_desc frame = {MASU_FRAME_DESC, .time = 0.02 * i};
        masu_commands commands;
        assert_ok(masu_headless_wait(&s.host, i % 2, error, sizeof error));
        uint64_t before = masu_allocs_of_thread();
        assert_int_equal(masu_instance_set_transform(s.m, box, rows, NULL), MASU_OK);
        assert_int_equal(masu_frame(s.m, &frame, &commands, NULL), MASU_OK);
        heap += masu_allocs_of_thread() - before;
        assert_ok(
            masu_headless_submit(&s.host, commands.buffer, commands.slot, error, sizeof error));
    }
    masu_headless_settle(&s.host);
    assert_int_equal(wrap.setup_calls, setup);
    assert_int_equal(wrap.live, live);
    if (masu_alloc_counting()) assert_int_equal(heap, 0);
    close_session(&s);
    assert_int_equal(wrap.live, 0);
}

/* A discrete GPU: the scene and the triangles for the structures are uploaded through the staging
 * buffer. */
static void what_is_built_comes_through_the_staging_buffer_too(void **state) {
    (void)state;
    static uint8_t straight[W * H * 4], staged[W * H * 4];
    if (!has_ray_queries()) return;
    skip_unless_host_sees_all_memory(); /* or the scene is already uploaded through one */
    for (int fake = 0; fake < 2; fake++) {
        masu_session_desc d = ray_desc(MASU_ON);
        masu_session s;
        wrap_reset();
        d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
        wrap.fake_memory = fake;
        open_session(&s, &d);
        assert_int_equal(row_bytes(s.m, "buffer", "staging") > 0, fake);
        draw_rung(&s, 0, fake ? staged : straight);
        close_session(&s);
    }
    wrap_reset();
    assert_int_equal(max_difference(straight, staged, sizeof staged), 0);
}

/* A block of the host's is accepted if it was allocated as the query requires. */
static void a_block_of_the_host_serves(void **state) {
    (void)state;
    static uint8_t given[W * H * 4], taken[W * H * 4];
    masu_session_desc d = ray_desc(MASU_ON);
    masu_session s;
    char error[ERROR_SIZE];
    if (!has_ray_queries()) return;
    open_session(&s, &d);
    draw_rung(&s, 0, taken);
    close_session(&s);
    d.no_renderer = true;
    open_session(&s, &d);
    masu_memory need;
    VkDeviceMemory memory[MASU_ROLE_COUNT] = {VK_NULL_HANDLE};
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) {
        if (!need.roles[r].bytes) continue;
        VkMemoryAllocateFlagsInfo flags = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                           .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
        VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .pNext = need.roles[r].device_address ? &flags : NULL,
                                     .allocationSize = need.roles[r].bytes,
                                     .memoryTypeIndex = need.roles[r].type};
        void *mapped = NULL;
        assert_int_equal(vkAllocateMemory(s.host.device, &info, NULL, &memory[r]), VK_SUCCESS);
        if (need.roles[r].host_visible) {
            assert_int_equal(vkMapMemory(s.host.device, memory[r], 0, VK_WHOLE_SIZE, 0, &mapped),
                             VK_SUCCESS);
        }
        s.desc.device_blocks[r] = (masu_device_block){.memory = memory[r],
                                                      .bytes = need.roles[r].bytes,
                                                      .mapped = mapped,
                                                      .memory_type = need.roles[r].type};
    }
    assert_ok(masu_session_start(&s, error, sizeof error));
    draw_rung(&s, 0, given);
    masu_destroy(s.m);
    s.m = NULL;
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) vkFreeMemory(s.host.device, memory[r], NULL);
    close_session(&s);
    assert_int_equal(max_difference(given, taken, sizeof taken), 0);
}

/* Each call up to the first shader fails once; the rest of init is tested in test_failures.c. */
static void a_structure_that_cannot_be_made_leaves_nothing_behind(void **state) {
    (void)state;
    masu_session_desc d = ray_desc(MASU_ON);
    masu_session s;
    masu_detail detail;
    masu_renderer *m;
    uint32_t structures_failed = 0;
    if (!has_ray_queries()) return;
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_memory_query(&s.desc, &s.need, NULL), MASU_OK);
    void *block = host_block(s.need.host_bytes);
    for (uint64_t k = 1; k < 1000; k++) {
        wrap_reset();
        wrap.fail_at = k;
        wrap.fail_with = VK_ERROR_OUT_OF_DEVICE_MEMORY;
        assert_int_equal(masu_init(&s.desc, block, s.need.host_bytes, &m, &detail),
                         MASU_ERROR_VULKAN);
        assert_string_equal(detail.what, wrap.failed_call);
        assert_int_equal(wrap.live, 0);
        structures_failed += !strcmp(wrap.failed_call, "vkCreateAccelerationStructureKHR");
        if (!strcmp(wrap.failed_call, "vkCreateShaderModule")) break;
    }
    assert_int_equal(structures_failed, masu_scene_data_of(&s.scene)->meshes + 1);
    wrap_reset();
    free(block);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_without_them_is_refused_by_name),
        cmocka_unit_test(a_device_that_lacks_a_function_is_refused_by_name),
        cmocka_unit_test(auto_takes_them_on_gpus_alone),
        cmocka_unit_test(the_same_rays_meet_the_same),
        cmocka_unit_test(far_out_the_same_rays_meet_the_same),
        cmocka_unit_test(through_the_holes_of_masks_they_meet_the_same),
        cmocka_unit_test(sixty_frames_create_and_allocate_nothing),
        cmocka_unit_test(what_is_built_comes_through_the_staging_buffer_too),
        cmocka_unit_test(a_block_of_the_host_serves),
        cmocka_unit_test(a_structure_that_cannot_be_made_leaves_nothing_behind),
    };
    return cmocka_run_group_tests_name("ray_query", tests, NULL, NULL);
}
