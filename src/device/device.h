/* device.h: the objects of a renderer on the device. All handles are zero before they are created, so
 * masu_device_destroy may run after any failed step. Arrays that depend on the scene are pointers into
 * the host block. */
#ifndef MASU_DEVICE_H
#define MASU_DEVICE_H

#include "device/memory.h"
#include "device/vk.h"
#include "plan/draws.h"
#include "plan/plan.h"
#include "scene/texture.h"

#define MASU_SAMPLER_COUNT 18u
/* Of the wrap modes of a texture set. */
static inline uint32_t masu_sampler_of(const uint32_t wrap[2]) {
    return (wrap[0] & 3u) + 3u * wrap[1] + (wrap[0] & 4u ? MASU_SAMPLER_COUNT / 2 : 0);
}

/* Of each mesh; one that rays do not meet has none. */
typedef struct masu_ray_mesh {
    VkAccelerationStructureKHR structure;
    uint64_t address;
    uint32_t first_triangle; /* of TRACE_TRIANGLES */
} masu_ray_mesh;

typedef struct masu_device {
    masu_vk vk;
    masu_frame_plan *plan; /* the renderer's */

    VkImage target_images[MASU_MAX_TARGETS]; /* the host's, which plan->desc.targets points to */
    VkImageView target_views[MASU_MAX_TARGETS];

    /* bind.c */
    masu_objects objects;
    VkImageView views[MASU_IMAGE_COUNT]; /* whole images; source and target views are the host's */
    VkImageView stores[MASU_IMAGE_COUNT]; /* of images that shaders store to in another format */
    VkDeviceMemory memory[MASU_ROLE_COUNT];
    int memory_owned[MASU_ROLE_COUNT];
    unsigned char *mapped[MASU_ROLE_COUNT]; /* NULL where the block is not host-visible */

    /* pipelines.c */
    VkSampler sampler, linear; /* nearest and linear, clamp to edge */
    /* Set 0: of the buffers that the pass declares. */
    VkDescriptorSetLayout global_layouts[MASU_PASS_COUNT];
    VkDescriptorSetLayout pass_layouts[MASU_PASS_COUNT];
    VkPipelineLayout layouts[MASU_PASS_COUNT];
    VkPipeline pipelines[MASU_PASS_COUNT];
    VkPipeline last[MASU_PASS_COUNT]; /* of passes of colour, for rungs in which they come last */
    /* Of the graphics rows; the cascades of the shadow map share those of the first, and its
     * pipeline. */
    VkRenderPass render_passes[MASU_PASS_COUNT];
    VkFramebuffer framebuffers[MASU_PASS_COUNT];
    VkDescriptorSetLayout texture_layout; /* null without textures, as are the next three */
    VkPipeline textured[MASU_TEXTURED_COUNT], masked_casters, masked_faces, masked_picks, tints;
    VkPipeline culled[MASU_CULLED_COUNT]; /* null where nothing is seen from one side only */
    /* Of the subpass of emitting materials: by masu_draw_kind, two-sided, then culled. */
    VkPipeline emitting[2 * MASU_CULLED_COUNT];
    VkSampler samplers[MASU_SAMPLER_COUNT]; /* masu_sampler_of; those that sets ask for */
    uint64_t pipeline_ns[MASU_PASS_COUNT];
    uint64_t *pool_keys; /* pool.c: MASU_POOL_KEYS of them, or of no length */

    /* descriptors.c */
    VkDescriptorPool descriptor_pool;
    VkDescriptorSet global_sets[MASU_MAX_FLIGHT][MASU_PASS_COUNT];
    VkDescriptorSet *pass_sets;    /* plan->pass_sets of them, in the order that they are made in */
    VkDescriptorSet *texture_sets; /* one per texture set of the scene */

    /* recordings.c */
    VkCommandPool command_pool;
    /* [flight][viewport][rung][target][variant][part]; plan->recordings of each flight, of
     * plan->parts parts */
    VkCommandBuffer *frames;
    /* [flight][viewport][rung][target], at its first variant: 1 if all variants are recorded */
    uint8_t *recorded;
    VkQueryPool queries;     /* [flight][MASU_PASS_COUNT + 1] */

    /* load.c */
    VkCommandBuffer *loads;           /* one per staging chunk */
    uint32_t load_count, load_next;   /* chunks in all, chunks handed out */
    uint64_t load_place, load_done;   /* bytes written in place, of all that place; in all steps */
    masu_texture_cursor texture_next; /* first texel row of the next chunk */

    /* ray_query.c */
    masu_ray_mesh *ray_meshes; /* [mesh]; of no length without ray queries */
    VkAccelerationStructureKHR ray_top;
} masu_device;

#endif
