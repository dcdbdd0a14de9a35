/* test_reinit.c: ten times masu_init, masu_load, masu_destroy on one device, without a frame and
 * with one: the same number of Vulkan objects and driver allocations each time, all of them
 * released. Remaining heap growth is printed, next to the growth of a plain loop that creates and
 * destroys the same objects. Without the layer and without cached objects (tests/support/kept.h),
 * which keep their own data. */
#include "support/support.h"
#include "support/wrap.h"

#include "alloc_count.h"
#include "tally_comp.spv.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 10, KINDS = 11 };

typedef struct round_figures {
    uint64_t creates, allocations; /* Vulkan objects; allocations through the callbacks */
    int64_t live, live_objects;    /* those that remain */
    int64_t heap;                  /* bytes more than before the first round of its kind */
} round_figures;

static masu_vk_alloc_counts counts;

static round_figures figures(const round_figures *start) {
    return (round_figures){.creates = wrap.creates - start->creates,
                           .allocations = atomic_load(&counts.allocations) - start->allocations,
                           .live = (int64_t)atomic_load(&counts.live) - start->live,
                           .live_objects = wrap.live - start->live_objects};
}

/* A driver may keep pipelines until its queue has something to do (lavapipe does). */
static void let_go(const masu_session *s) {
    VkSubmitInfo nothing = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};
    assert_int_equal(vkQueueSubmit(s->host.queue, 1, &nothing, VK_NULL_HANDLE), VK_SUCCESS);
    assert_int_equal(vkQueueWaitIdle(s->host.queue), VK_SUCCESS);
}

/* Renders `frames` frames: drivers allocate when shaders run. */
static round_figures library_round(masu_session *s, const masu_desc *d, void *block, uint64_t bytes,
                                   int frames) {
    char error[ERROR_SIZE];
    masu_renderer *m;
    masu_commands commands;
    masu_detail detail;
    round_figures none = {0}, start = figures(&none);
    if (masu_init(d, block, bytes, &m, &detail)) fail_msg("%s", detail.text);
    load_all(s, m);
    for (int i = 0; i < frames; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .rung = 0};
        assert_int_equal(masu_frame(m, &frame, &commands, NULL), MASU_OK);
        assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
    }
    masu_destroy(m);
    let_go(s);
    return figures(&start);
}

/* Creates and destroys one object of each kind. */
static void bare_objects(masu_session *s) {
    const VkDevice device = s->host.device;
    const VkAllocationCallbacks *a = s->host.desc.allocator;
    VkShaderModuleCreateInfo module_info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = sizeof masu_spv_tally_comp,
                                            .pCode = masu_spv_tally_comp};
    VkDescriptorSetLayoutBinding binding = {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                                            VK_SHADER_STAGE_COMPUTE_BIT, NULL};
    VkDescriptorSetLayoutCreateInfo set_info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 1,
        .pBindings = &binding};
    VkShaderModule module;
    VkDescriptorSetLayout set;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkImage image;
    VkImageView view;
    VkSampler sampler;
    VkDescriptorPool sets;
    VkCommandPool pool;
#define MAKE(call) assert_int_equal(call, VK_SUCCESS)
    MAKE(vkCreateShaderModule(device, &module_info, a, &module));
    MAKE(vkCreateDescriptorSetLayout(device, &set_info, a, &set));
    VkPipelineLayoutCreateInfo layout_info = {.sType =
                                                  VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                              .setLayoutCount = 1,
                                              .pSetLayouts = &set};
    MAKE(vkCreatePipelineLayout(device, &layout_info, a, &layout));
    VkComputePipelineCreateInfo pipeline_info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .layout = layout,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT, .module = module, .pName = "main"}};
    MAKE(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &pipeline_info, a, &pipeline));
    VkBufferCreateInfo buffer_info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 4096,
                                      .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    MAKE(vkCreateBuffer(device, &buffer_info, a, &buffer));
    VkImageCreateInfo image_info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = VK_FORMAT_R8G8B8A8_UNORM,
                                    .extent = {16, 16, 1},
                                    .mipLevels = 1,
                                    .arrayLayers = 1,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .usage = VK_IMAGE_USAGE_STORAGE_BIT};
    MAKE(vkCreateImage(device, &image_info, a, &image));
    VkMemoryRequirements need;
    vkGetImageMemoryRequirements(device, image, &need);
    VkMemoryAllocateInfo memory_info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .allocationSize = need.size};
    while (!(need.memoryTypeBits >> memory_info.memoryTypeIndex & 1)) memory_info.memoryTypeIndex++;
    MAKE(vkAllocateMemory(device, &memory_info, a, &memory));
    MAKE(vkBindImageMemory(device, image, memory, 0));
    VkImageViewCreateInfo view_info = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                       .image = image,
                                       .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                       .format = image_info.format,
                                       .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    MAKE(vkCreateImageView(device, &view_info, a, &view));
    VkSamplerCreateInfo sampler_info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    MAKE(vkCreateSampler(device, &sampler_info, a, &sampler));
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    VkDescriptorPoolCreateInfo sets_info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .maxSets = 1,
                                            .poolSizeCount = 1,
                                            .pPoolSizes = &size};
    MAKE(vkCreateDescriptorPool(device, &sets_info, a, &sets));
    VkCommandPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .queueFamilyIndex = s->host.family};
    MAKE(vkCreateCommandPool(device, &pool_info, a, &pool));
    vkDestroyCommandPool(device, pool, a);
    vkDestroyDescriptorPool(device, sets, a);
    vkDestroySampler(device, sampler, a);
    vkDestroyImageView(device, view, a);
    vkDestroyImage(device, image, a);
    vkFreeMemory(device, memory, a);
    vkDestroyBuffer(device, buffer, a);
    vkDestroyPipeline(device, pipeline, a);
    vkDestroyPipelineLayout(device, layout, a);
    vkDestroyDescriptorSetLayout(device, set, a);
    vkDestroyShaderModule(device, module, a);
}

static round_figures bare_round(masu_session *s, uint64_t objects) {
    round_figures none = {0}, start = figures(&none);
    for (uint64_t n = 0; n < objects / KINDS; n++) bare_objects(s);
    let_go(s);
    return figures(&start);
}

static void ten_inits_leave_nothing_of_theirs(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("test_both", 96, 54);
    VkAllocationCallbacks callbacks = masu_vk_alloc_callbacks(&counts);
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.host.allocator = &callbacks;
    d.host.validate = false;
    d.no_renderer = true;
    open_session(&s, &d);
    masu_desc own = s.desc;
    own.scene = &s.scene;
    own.rung_count = 1;
    own.resizable = 1;
    masu_memory need;
    assert_int_equal(masu_memory_query(&own, &need, NULL), MASU_OK);
    void *block = host_block(need.host_bytes);
    enum { INITS, FRAMES, BARE, WAYS };
    static const char *const names[WAYS] = {"init, load, destroy", "a frame too", "bare Vulkan"};
    round_figures all[WAYS][ROUNDS];
    for (int way = 0; way < WAYS; way++) {
        size_t before = mallinfo2().uordblks;
        for (int i = 0; i < ROUNDS; i++) {
            if (way < BARE)
                all[way][i] = library_round(&s, &own, block, need.host_bytes, way == FRAMES);
            else all[way][i] = bare_round(&s, all[INITS][0].creates);
            all[way][i].heap = (int64_t)mallinfo2().uordblks - (int64_t)before;
        }
    }
    printf("  %llu objects of Vulkan a round; heap bytes more than before the first of its kind, "
           "after each:\n",
           (unsigned long long)all[INITS][0].creates);
    for (int way = 0; way < WAYS; way++) {
        printf("  %-20s", names[way]);
        for (int i = 0; i < ROUNDS; i++) printf(" %8lld", (long long)all[way][i].heap);
        printf("\n");
    }
    for (int way = 0; way < WAYS; way++) {
        int64_t left = 0; /* the first round creates the driver's data for the device; one may be
                             freed late */
        for (int i = 1; i < ROUNDS; i++) left += all[way][i].live;
        assert_in_range(left + 2, 0, 4);
        for (int i = 0; way < BARE && i < ROUNDS; i++) {
            assert_true(all[way][i].creates > 40);
            assert_int_equal(all[way][i].creates, all[way][0].creates);
            assert_int_equal(all[way][i].live_objects, 0);
        }
    }
    free(block);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_inits_leave_nothing_of_theirs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
