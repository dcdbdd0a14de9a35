/* test_probes.c: light probes on the GPU equal tools/bake/light/probe_light.c: the light of a frame
 * at each probe, and at any point; everything is finite for any input. The two shaders are
 * dispatched here directly, on the grid of a real scene. Then whole frames, under the validation
 * layer: a room is darker with its probes, and its walls reflect the sun's colour. */
#include "support/support.h"
#include "support/files.h"
#include "support/random.h"
#include "support/floats.h"

#include "bake/light/probe_light.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include "probes_comp.spv.h"
#include "probes_lookup_comp.spv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS 4096u

enum { FRAME, COUNTERS, PROBES, PLACES, BUFFERS };

typedef struct buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
    VkDeviceSize bytes;
} buffer;

typedef struct bench {
    masu_session s;
    buffer buffers[BUFFERS];
    VkDescriptorSetLayout layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    VkPipelineLayout pipeline_layout;
    VkPipeline pipelines[2];
} bench;

static bench b;

static void make_buffer(buffer *out, VkDeviceSize bytes, VkBufferUsageFlags usage) {
    VkDevice device = b.s.host.device;
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    assert_int_equal(vkCreateBuffer(device, &info, NULL, &out->buffer), VK_SUCCESS);
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(device, out->buffer, &need);
    uint32_t type = 0;
    VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    while (!(need.memoryTypeBits & 1u << type) ||
           (b.s.host.memory.memoryTypes[type].propertyFlags & wanted) != wanted) {
        assert_true(++type < b.s.host.memory.memoryTypeCount);
    }
    VkMemoryAllocateInfo memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                   .allocationSize = need.size,
                                   .memoryTypeIndex = type};
    assert_int_equal(vkAllocateMemory(device, &memory, NULL, &out->memory), VK_SUCCESS);
    assert_int_equal(vkBindBufferMemory(device, out->buffer, out->memory, 0), VK_SUCCESS);
    assert_int_equal(vkMapMemory(device, out->memory, 0, VK_WHOLE_SIZE, 0, &out->mapped),
                     VK_SUCCESS);
    memset(out->mapped, 0, (size_t)bytes);
    out->bytes = bytes;
}

static void make_pipeline(const uint32_t *words, size_t bytes, VkPipeline *out) {
    VkDevice device = b.s.host.device;
    VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
    VkShaderModule module;
    assert_int_equal(vkCreateShaderModule(device, &module_info, NULL, &module), VK_SUCCESS);
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = b.pipeline_layout};
    assert_int_equal(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, NULL, out),
                     VK_SUCCESS);
    vkDestroyShaderModule(device, module, NULL);
}

static void open_bench(const masu_scene_view *v, uint64_t probe_bytes) {
    static const uint32_t bindings[BUFFERS] = {[FRAME] = MASU_BIND_FRAME,
                                               [COUNTERS] = MASU_BIND_COUNTERS,
                                               [PROBES] = MASU_BIND_PROBES,
                                               [PLACES] = MASU_BIND_INSTANCES};
    masu_session_desc d = test_desc(NULL, 16, 16);
    char error[ERROR_SIZE];
    memset(&b, 0, sizeof b);
    d.no_renderer = true;
    assert_ok(masu_session_open(&d, &b.s, error, sizeof error));
    VkDevice device = b.s.host.device;
    VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    make_buffer(&b.buffers[FRAME], sizeof(struct masu_frame_uniforms),
                VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    make_buffer(&b.buffers[COUNTERS], 8 * MASU_COUNTER_COUNT, storage);
    make_buffer(&b.buffers[PROBES], probe_bytes, storage);
    make_buffer(&b.buffers[PLACES], POINTS * 32, storage);
    memcpy(b.buffers[PROBES].mapped, v->probes, sizeof *v->probes);
    memcpy((char *)b.buffers[PROBES].mapped + sizeof *v->probes, v->probe_data,
           (size_t)v->probe_words * 4);
    VkDescriptorSetLayoutBinding rows[BUFFERS];
    for (uint32_t i = 0; i < BUFFERS; i++) {
        rows[i] = (VkDescriptorSetLayoutBinding){bindings[i],
                                                 i == FRAME ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                            : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                 1, VK_SHADER_STAGE_COMPUTE_BIT, NULL};
    }
    VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = BUFFERS,
        .pBindings = rows};
    assert_int_equal(vkCreateDescriptorSetLayout(device, &layout, NULL, &b.layout), VK_SUCCESS);
    VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                    {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3}};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = 1,
                                       .poolSizeCount = 2,
                                       .pPoolSizes = sizes};
    assert_int_equal(vkCreateDescriptorPool(device, &pool, NULL, &b.pool), VK_SUCCESS);
    VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                       .descriptorPool = b.pool,
                                       .descriptorSetCount = 1,
                                       .pSetLayouts = &b.layout};
    assert_int_equal(vkAllocateDescriptorSets(device, &set, &b.set), VK_SUCCESS);
    for (uint32_t i = 0; i < BUFFERS; i++) {
        VkDescriptorBufferInfo info = {b.buffers[i].buffer, 0, b.buffers[i].bytes};
        VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                      .dstSet = b.set,
                                      .dstBinding = bindings[i],
                                      .descriptorCount = 1,
                                      .descriptorType = rows[i].descriptorType,
                                      .pBufferInfo = &info};
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(struct masu_push)};
    VkPipelineLayoutCreateInfo pipeline = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                           .setLayoutCount = 1,
                                           .pSetLayouts = &b.layout,
                                           .pushConstantRangeCount = 1,
                                           .pPushConstantRanges = &push};
    assert_int_equal(vkCreatePipelineLayout(device, &pipeline, NULL, &b.pipeline_layout),
                     VK_SUCCESS);
    make_pipeline(masu_spv_probes_comp, sizeof masu_spv_probes_comp, &b.pipelines[0]);
    make_pipeline(masu_spv_probes_lookup_comp, sizeof masu_spv_probes_lookup_comp, &b.pipelines[1]);
}

static void close_bench(void) {
    VkDevice device = b.s.host.device;
    for (int i = 0; i < 2; i++) vkDestroyPipeline(device, b.pipelines[i], NULL);
    vkDestroyPipelineLayout(device, b.pipeline_layout, NULL);
    vkDestroyDescriptorPool(device, b.pool, NULL);
    vkDestroyDescriptorSetLayout(device, b.layout, NULL);
    for (uint32_t i = 0; i < BUFFERS; i++) {
        vkDestroyBuffer(device, b.buffers[i].buffer, NULL);
        vkFreeMemory(device, b.buffers[i].memory, NULL);
    }
    close_session(&b.s);
}

static void dispatch(uint32_t probes) {
    VkDevice device = b.s.host.device;
    VkCommandBuffer cmd;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = b.s.host.pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    assert_int_equal(vkAllocateCommandBuffers(device, &info, &cmd), VK_SUCCESS);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    assert_int_equal(vkBeginCommandBuffer(cmd, &begin), VK_SUCCESS);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, b.pipeline_layout, 0, 1, &b.set, 0,
                            NULL);
    struct masu_push push;
    memset(&push, 0, sizeof push);
    vkCmdPushConstants(cmd, b.pipeline_layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    const uint32_t groups[2] = {(probes + 63) / 64, POINTS / 64};
    for (int i = 0; i < 2; i++) {
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, b.pipelines[i]);
        vkCmdDispatch(cmd, groups[i], 1, 1);
        VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_SHADER_READ_BIT |
                                                    VK_ACCESS_SHADER_WRITE_BIT |
                                                    VK_ACCESS_HOST_READ_BIT};
        vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                             VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0,
                             1, &barrier, 0, NULL, 0, NULL);
    }
    assert_int_equal(vkEndCommandBuffer(cmd), VK_SUCCESS);
    char error[ERROR_SIZE];
    assert_ok(masu_headless_run(&b.s.host, cmd, error, sizeof error));
    vkFreeCommandBuffers(device, b.s.host.pool, 1, &cmd);
}

static void set_points(const masu_blob_probes *p) {
    static const float odd[] = {0, -0.0f, 1e-40f, 1e30f, -1e30f, INFINITY, -INFINITY, NAN};
    float(*points)[4] = b.buffers[PLACES].mapped;
    uint64_t random = 77;
    for (uint32_t i = 0; i < POINTS; i++) {
        float z = random_float(&random) * 2 - 1, a = random_float(&random) * 6.2831853f,
              r = sqrtf(1 - z * z);
        const float n[3] = {r * cosf(a), r * sinf(a), z};
        for (int k = 0; k < 3; k++) {
            /* From two cells outside the grid to two on the other side. */
            float cells = (float)p->counts[k] + 4;
            points[2 * i][k] =
                p->origin[k] + p->spacing[k] * (random_float(&random) * cells - 2.5f);
            points[2 * i + 1][k] = n[k];
            if (i >= POINTS - 512) {
                uint32_t which = (uint32_t)(random_float(&random) * 16);
                if (which < 8) points[2 * i + (i & 1)][k] = odd[which];
            }
        }
        points[2 * i][3] = POINTS;
        points[2 * i + 1][3] = 0;
    }
}

/* Compares both on that grid with those data. */
static void hold_together(const masu_scene_view *v) {
    const masu_blob_probes *p = v->probes;
    const uint32_t probes = p->counts[0] * p->counts[1] * p->counts[2];
    uint64_t lit_words = (uint64_t)probes * MASU_PROBE_LIT_WORDS;
    uint64_t lit_at = (v->probe_words + 3) / 4 * 4;
    open_bench(v, sizeof *p + (lit_at + lit_words) * 4);
    struct masu_frame_uniforms *frame = b.buffers[FRAME].mapped;
    masu_probe_sky light = {.sky = {{0.35f * 3.5449077f, 0.42f * 3.5449077f, 0.52f * 3.5449077f}},
                            .sun_direction = {0.3f, 0.5f, 0.8124038f},
                            .sun = {2.5f, 2, 1.5f}};
    memcpy(frame->sun_direction, light.sun_direction, sizeof light.sun_direction);
    memcpy(frame->sun_color, light.sun, sizeof light.sun);
    for (int k = 0; k < 3; k++) {
        float c[9]; /* irradiance / pi, over the functions of src/frame/sky.h */
        for (int i = 0; i < 9; i++) c[i] = i ? 0.01f * (float)((5 * i + 3 * k) % 7 - 3) : 0.0f;
        c[0] = light.sky[0][k] / 3.5449077f;
        for (int i = 0; i < 9; i++) frame->irradiance[i][k] = c[i];
        frame->ambient[k] = c[0];
        light.sky[1][k] = c[2] * (1.5f / 0.488603f);
        light.sky[2][k] = c[3] * (1.5f / 0.488603f);
        light.sky[3][k] = c[1] * (1.5f / 0.488603f);
        light.sky[4][k] = c[4] * (4 / 1.092548f);
        light.sky[5][k] = c[5] * (4 / 1.092548f);
        light.sky[6][k] = (c[7] + c[8]) * (-2 / 0.315392f);
        light.sky[7][k] = c[6] * (4 / 1.092548f);
        light.sky[8][k] = (2 * c[8] - 6 * c[7]) * (1 / 0.546274f);
    }
    set_points(p);
    float(*asked)[4] = malloc(POINTS * 32);
    memcpy(asked, b.buffers[PLACES].mapped, POINTS * 32);
    dispatch(probes);
    const uint32_t *words = (const uint32_t *)((const char *)b.buffers[PROBES].mapped + sizeof *p);
    const uint32_t *lit = words + lit_at;
    uint32_t *own = malloc(lit_words * 4);
    masu_probe_light(p, v->probe_data, &light, own);
    double worst = 0;
    for (uint32_t i = 0; i < probes; i++) {
        const uint32_t *got = lit + i * MASU_PROBE_LIT_WORDS,
                       *want = own + i * MASU_PROBE_LIT_WORDS;
        for (uint32_t k = 0; k < 4; k++) {
            double g = (double)masu_probe_half(got[k / 2] >> (k & 1 ? 16 : 0) & 0xFFFFu);
            double w = (double)masu_probe_half(want[k / 2] >> (k & 1 ? 16 : 0) & 0xFFFFu);
            worst = worst_of(worst, fabs(g - w) / (fabs(w) + 0.01));
        }
        for (uint32_t k = 0; k < 24; k++) {
            int32_t g = (int32_t)(got[2 + k / 3] << (22 - 10 * (k % 3))) >> 22;
            int32_t w = (int32_t)(want[2 + k / 3] << (22 - 10 * (k % 3))) >> 22;
            worst = worst_of(worst, fabs((double)g - (double)w) / 511);
        }
    }
    print_message("%u probes: error of the light %.2e at most\n", probes, worst);
    assert_true(worst < 4.5e-3); /* two steps of 511; arc cosines are imprecise */
    const float(*found)[4] = (const float(*)[4])b.buffers[PLACES].mapped;
    uint32_t outside = 0;
    worst = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        float out[3],
            inside = masu_probe_lookup(p, words, lit, asked[2 * i], asked[2 * i + 1], out);
        for (int k = 0; k < 4; k++) assert_true(isfinite(found[2 * i + 1][k]));
        if (i >= POINTS - 512) continue; /* unusual ones only need to be finite */
        assert_float_equal(found[2 * i + 1][3], inside, 1e-3);
        outside += !(inside > 0);
        for (int k = 0; k < 3 && inside > 0; k++) {
            double e = fabs((double)found[2 * i + 1][k] - (double)out[k]);
            worst = worst_of(worst, e / ((double)fabsf(out[k]) + 0.01));
        }
    }
    print_message("%u points, %u beyond the grid: error %.2e at most\n", POINTS, outside,
                  worst);
    assert_true(outside > 100 && outside < POINTS * 9 / 10 && worst < 1e-4);
    free(own);
    free(asked);
    close_bench();
}

static void *open_room(masu_scene_view *v) {
    size_t bytes;
    masu_scene scene;
    void *blob = read_file(scene_path("probe_room"), &bytes);
    assert_int_equal(masu_scene_bind(blob, bytes, &scene, NULL), MASU_OK);
    *v = masu_scene_view_of(&scene);
    assert_non_null(v->probes);
    return blob;
}

static void the_gpu_says_what_the_twin_says(void **state) {
    (void)state;
    masu_scene_view v;
    void *blob = open_room(&v);
    hold_together(&v);
    free(blob);
}

/* Grids that are one probe thick, the same data in other shapes: the neighbour along that axis is
 * the probe itself. */
static void the_two_agree_on_grids_that_are_one_probe_thick(void **state) {
    (void)state;
    masu_scene_view v;
    void *blob = open_room(&v);
    const masu_blob_probes *whole = v.probes;
    const uint32_t *n = whole->counts;
    masu_blob_probes flat = *whole;
    for (uint32_t axis = 0; axis < 3; axis++) {
        uint32_t next = (axis + 1) % 3, last = (axis + 2) % 3;
        flat.counts[axis] = 1;
        flat.counts[next] = n[axis] * n[next];
        flat.counts[last] = n[last];
        v.probes = &flat;
        hold_together(&v);
    }
    free(blob);
}

/* ---- Whole frames ---------------------------------------------------------------------------- */

enum { W = 96, H = 64 };

/* Mean radiance of the image under that light. */
static void mean_of(masu_session *s, const masu_light *light, double mean[3]) {
    masu_commands commands;
    masu_readback_image hdr;
    masu_frame_desc frame = {.light = light};
    draw(s, &frame, &commands, NULL);
    assert_int_equal(masu_readback(s->m, commands.slot, MASU_READBACK_HDR, &hdr, NULL), MASU_OK);
    memset(mean, 0, 3 * sizeof *mean);
    for (uint32_t i = 0; i < W * H; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint16_t h = ((const uint16_t *)hdr.pixels)[4 * i + k];
            assert_true((h & 0x7C00) != 0x7C00);
            mean[k] += half_float(h) / (W * H);
        }
    }
}

static void a_room_is_lit_through_its_window(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("probe_room", W, H);
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    double sky[3], sun[3];
    masu_light light = {.sun_direction = {0.2f, 0.6f, 0.75f}, .ambient = {1, 1, 1}};
    mean_of(&s, &light, sky);
    /* In the open a white sky of 1 would leave about the albedo, 0.6 on average. */
    print_message("white sky: %.3f %.3f %.3f\n", sky[0], sky[1], sky[2]);
    assert_true(sky[1] > 0.005 && sky[1] < 0.25);
    light = (masu_light){.sun_direction = {0.2f, 0.6f, 0.75f}, .sun_color = {2, 2, 2}};
    mean_of(&s, &light, sun);
    print_message("sun: %.3f %.3f %.3f\n", sun[0], sun[1], sun[2]);
    assert_true(sun[0] > 0.02 && sun[1] > 0.02);
    /* Twice the sun is twice the light. */
    double twice[3];
    light = (masu_light){.sun_direction = {0.2f, 0.6f, 0.75f}, .sun_color = {4, 4, 4}};
    mean_of(&s, &light, twice);
    for (int k = 0; k < 3; k++) assert_true(fabs(twice[k] - 2 * sun[k]) < 0.01 * twice[k]);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gpu_says_what_the_twin_says),
        cmocka_unit_test(the_two_agree_on_grids_that_are_one_probe_thick),
        cmocka_unit_test(a_room_is_lit_through_its_window),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
