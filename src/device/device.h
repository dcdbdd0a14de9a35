/* device.h: the Vulkan objects of a renderer. All handles are null before they are created, so
 * masu_device_destroy may run after any failed step. Arrays whose size depends on the scene are
 * pointers into the host memory block. */
#ifndef MASU_DEVICE_H
#define MASU_DEVICE_H

#include "device/memory.h"
#include "device/vk.h"
#include "plan/draws.h"
#include "plan/plan.h"
#include "scene/texture.h"

#define MASU_SAMPLER_COUNT 18u
/* Index of the sampler for the wrap modes of a texture set. */
static inline uint32_t masu_sampler_of(const uint32_t wrap[2]) {
    return (wrap[0] & 3u) + 3u * wrap[1] + (wrap[0] & 4u ? MASU_SAMPLER_COUNT / 2 : 0);
}

/* Acceleration structure of one mesh; null for a mesh that is not traced. */
typedef struct masu_ray_mesh {
    VkAccelerationStructureKHR structure;
    uint64_t address;
    uint32_t first_triangle; /* index into TRACE_TRIANGLES */
} masu_ray_mesh;

typedef struct masu_device {
    masu_vk vk;
    masu_frame_plan *plan; /* owned by the renderer */

    /* copies of the host's handles; plan->desc.targets points here */
    VkImage target_images[MASU_MAX_TARGETS];
    VkImageView target_views[MASU_MAX_TARGETS];

    /* bind.c */
    masu_objects objects;
    VkImageView views[MASU_IMAGE_COUNT]; /* whole images; source and target: views of the host */
    /* of images whose storage format differs from the sampled format */
    VkImageView stores[MASU_IMAGE_COUNT];
    VkDeviceMemory memory[MASU_ROLE_COUNT];
    int memory_owned[MASU_ROLE_COUNT];
    unsigned char *mapped[MASU_ROLE_COUNT]; /* NULL if not host-visible */

    /* pipelines.c */
    VkSampler sampler, linear; /* nearest and linear, clamp to edge */
    /* Set 0: the buffers that the pass declares. */
    VkDescriptorSetLayout global_layouts[MASU_PASS_COUNT];
    VkDescriptorSetLayout pass_layouts[MASU_PASS_COUNT];
    VkPipelineLayout layouts[MASU_PASS_COUNT];
    VkPipeline pipelines[MASU_PASS_COUNT];
    VkPipeline last[MASU_PASS_COUNT]; /* color passes, in rungs where they are the last pass */
    /* Graphics passes. All cascades of the shadow map use the render pass, framebuffer and pipeline
     * of the first cascade. */
    VkRenderPass render_passes[MASU_PASS_COUNT];
    VkFramebuffer framebuffers[MASU_PASS_COUNT];
    VkDescriptorSetLayout texture_layout; /* null without textures, like the next three */
    VkPipeline textured[MASU_TEXTURED_COUNT], masked_casters, masked_faces, masked_picks, tints;
    VkPipeline culled[MASU_CULLED_COUNT]; /* null without single-sided materials */
    /* In the emission subpass: indexed by masu_draw_kind, two-sided first, then culled. */
    VkPipeline emitting[2 * MASU_CULLED_COUNT];
    VkSampler samplers[MASU_SAMPLER_COUNT]; /* by masu_sampler_of; only those in use */
    uint64_t pipeline_ns[MASU_PASS_COUNT];
    uint32_t *code_room; /* masu_code_room bytes for unpacking shaders; NULL: a mapped block */
    uint64_t *pool_keys; /* pool.c: MASU_POOL_KEYS keys; empty without a pool */

    /* descriptors.c */
    VkDescriptorPool descriptor_pool;
    VkDescriptorSet global_sets[MASU_MAX_FLIGHT][MASU_PASS_COUNT];
    VkDescriptorSet *pass_sets;    /* plan->pass_sets sets, in creation order */
    VkDescriptorSet *texture_sets; /* one per texture set of the scene */

    /* recordings.c */
    VkCommandPool command_pool;
    /* [flight][viewport][rung][target][variant][part]; plan->recordings per flight, each with
     * plan->parts parts */
    VkCommandBuffer *frames;
    /* [flight][viewport][rung][target], at the index of the first variant: 1 if all variants are
     * recorded */
    uint8_t *recorded;
    VkQueryPool queries;     /* [flight][MASU_PASS_COUNT + 1] */

    /* prepare.c */
    uint8_t made[MASU_PASS_COUNT]; /* forms of the pass whose pipelines exist */
    uint32_t ready;                /* bit n: rung n is recorded */
    uint32_t steps, steps_done;

    /* load.c */
    VkCommandBuffer *loads;           /* one per staging chunk */
    uint32_t load_count, load_next;   /* chunks in all, chunks submitted */
    /* bytes written to resident buffers directly; bytes written in all */
    uint64_t load_place, load_done;
    masu_texture_cursor texture_next; /* first texel row of the next chunk */

    /* ray_query.c */
    masu_ray_mesh *ray_meshes; /* [mesh]; empty without ray queries */
    VkAccelerationStructureKHR ray_top;
} masu_device;

#endif
