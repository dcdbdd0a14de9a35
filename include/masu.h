/* masu.h: the whole public interface of Masu, and its manual. Knobs and limits are in masu_knobs.h, what no port needs
 * in masu_study.h; both are parts of this header, which includes them.
 *
 * Masu renders baked scenes of polygons and signed distance fields (SDF) inside a box of memory
 * whose size is known before the first frame. It is a library for a host that owns the Vulkan
 * device, the queue, the window and the loop.
 *
 * THE LIFE OF A RENDERER
 *
 *     masu_scene scene;                                   // 1. look at a baked scene
 *     masu_scene_bind(blob, blob_bytes, &scene, &detail); //    (none: upscaling only)
 *     masu_desc desc = { .vulkan = {...}, .scene = &scene, .output = {1920, 1080}, ... };
 *     masu_memory need;                                   // 2. ask how large the box is
 *     masu_memory_query(&desc, &need, &detail);
 *     masu_renderer *m;                                   // 3. give the block; all is created here
 *     masu_init(&desc, block, need.host_bytes, &m, &detail);
 *     while (masu_load(m, &commands) == MASU_INCOMPLETE)  // 4. copy the scene in
 *         submit_and_wait(commands);
 *     for (;;) {                                          // 5. frames
 *         wait for the fence of the frame frames_in_flight frames ago
 *         masu_frame(m, &frame, &commands);               //    writes uniforms, picks a recording
 *         submit(commands.buffer, fence);
 *     }
 *     wait until the device is idle; masu_destroy(m);     // 6. the blocks are the host's again
 *
 * WHAT IS PROMISED
 *  - After masu_init: no heap allocation, no vkAllocate*, vkCreate*, vkBegin/EndCommandBuffer by
 *    the library. What the driver does inside vkQueueSubmit is the driver's; `masu render --stats`
 *    counts it.
 *  - The library submits nothing, starts no thread, opens no file, prints nothing and has no global
 *    state. One renderer is used by one thread at a time; different renderers are independent.
 *  - Failures leave nothing behind: masu_init that fails has destroyed what it created.
 *
 * THE VULKAN CONTRACT
 *  - Device: Vulkan 1.1, one queue family with graphics and compute, D32_SFLOAT as depth attachment
 *    and sampled image. No optional feature is needed. What is missing is named in the detail.
 *    Of optional ones, textureCompressionBC and samplerAnisotropy serve textures, rayQuery serves
 *    reflections, shaderFloat16 upscaling (masu_vulkan). What the device offers, the scene would use, and
 *    the host has not said to be enabled, masu_init tells the log in a line each.
 *  - `commands.buffer` is a primary command buffer of `queue_family`, recorded in masu_init. It is
 *    to be submitted once (with desc.split, it is the first of several: commands.parts); all frames and loads go to one and the same queue, in order. It starts
 *    with a full barrier against the previous frame.
 *  - Target images: an array of views of host images, all `output` large. Storage targets
 *    (targets.storage != 0) must be VK_FORMAT_R8G8B8A8_UNORM, or VK_FORMAT_R16G16B16A16_SFLOAT, with
 *    VK_IMAGE_USAGE_STORAGE_BIT; Masu writes them directly. Other targets (a swapchain's BGRA
 *    images, say) must have VK_IMAGE_USAGE_TRANSFER_DST_BIT and are filled by a blit, sRGB formats by
 *    a copy, which costs one more image. Layout
 *    on entry: anything (contents are discarded). Layout on exit: targets.final_layout. The submit
 *    must wait for the image to be available (swapchain semaphore) at
 *    VK_PIPELINE_STAGE_ALL_COMMANDS_BIT; writes are made available to all later commands and, with
 *    readback, to the host.
 *
 *  - Handles and callbacks of the description (allocator, log, clock, target and source views) must
 *    live until masu_destroy; the description itself, its arrays and pipeline_cache only during the
 *    call.
 *  - Another output size or other targets: masu_resize. Beyond what was planned for, or another scene:
 *    masu_destroy, then masu_init again, in the same blocks if they are large enough for all; or, without a pause,
 *    masu_init in other blocks, before (masu_load). A frame
 *    that is not submitted after all (a swapchain out of date) still counts: its slot's numbers are
 *    those of an older frame.
 *
 * CONVENTIONS
 *  - World: right-handed, +Y up, metres. Colour: linear, unless said otherwise. Angles: radians.
 *    Time: seconds.
 *  - Every struct may be zero-initialised; a zero field means the default stated next to it.
 *  - Functions return MASU_OK (0), MASU_INCOMPLETE (> 0) or a negative masu_result. `detail` may be
 *    NULL. Of other pointers NULL is MASU_ERROR_ARGUMENT, and where there is no result nothing: what is asked
 *    for is then 0.
 *
 * Compiles as C11 (pedantic) and C++17. */
#ifndef MASU_H
#define MASU_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define MASU_API __attribute__((visibility("default")))
#define MASU_MUST_USE __attribute__((warn_unused_result))
#else
#define MASU_API
#define MASU_MUST_USE
#endif

#define MASU_VERSION_MAJOR 0
#define MASU_VERSION_MINOR 1
#define MASU_VERSION_PATCH 0

/* ---- Results --------------------------------------------------------------------------------- */

/* One line per code: name, value, what it means. Values never change once released. */
#define MASU_RESULTS(X)                                                                            \
    X(MASU_OK, 0, "success")                                                                       \
    X(MASU_INCOMPLETE, 1, "not finished: call again")                                              \
    X(MASU_ERROR_ARGUMENT, -1, "an argument is missing, out of range or not finite")               \
    X(MASU_ERROR_MEMORY, -2, "a memory block is missing, misaligned or too small")                 \
    X(MASU_ERROR_LIMIT, -3, "a limit or budget of the description is exceeded")                    \
    X(MASU_ERROR_DEVICE, -4, "the device lacks something that is needed")                          \
    X(MASU_ERROR_SCENE, -5, "the scene blob is damaged or inconsistent")                           \
    X(MASU_ERROR_VERSION, -6, "the scene blob is of another version")                              \
    X(MASU_ERROR_VULKAN, -7, "a Vulkan call failed")                                               \
    X(MASU_ERROR_DEVICE_LOST, -8, "the Vulkan device was lost")                                    \
    X(MASU_ERROR_STATE, -9, "called out of order")

typedef enum masu_result {
#define MASU_RESULT_ENUM(name, value, text) name = value,
    MASU_RESULTS(MASU_RESULT_ENUM)
#undef MASU_RESULT_ENUM
        MASU_RESULT_FORCE_32 = 0x7FFFFFFF
} masu_result;

/* What a code means, in English, without a newline. Never NULL; unknown codes give "unknown
 * result". */
MASU_API const char *masu_result_string(masu_result result);

/* Filled when a call fails, untouched when it succeeds. `what` names the thing (a field of the
 * description, a section of the blob, a Vulkan function) and is a string constant; needed and given
 * are 0 where they say nothing. `text` is the whole message on one line: thing, limit, needed,
 * given. */
typedef struct masu_detail {
    masu_result result;
    VkResult vulkan; /* of the call that failed, else VK_SUCCESS */
    const char *what;
    uint64_t needed;
    uint64_t given;
    char text[200];
} masu_detail;

typedef enum masu_log_level {
    MASU_LOG_ERROR = 0,
    MASU_LOG_WARNING = 1,
    MASU_LOG_INFO = 2
} masu_log_level;

/* Called from inside masu_* calls, on the caller's thread. `text` is one line without newline,
 * valid during the call. */
typedef void (*masu_log_fn)(void *user, masu_log_level level, const char *text);

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* A validated look at a baked blob (docs/blob.md): plain numbers and the pointer. Filled by
 * masu_scene_bind alone. */
typedef struct masu_scene {
    const void *blob; /* the caller's; see masu_scene_bind */
    uint64_t blob_bytes;
    uint32_t vertices, indices, primitives, meshes, instances, materials, camera_keys;
    uint32_t lods; /* LODs of meshes, in all */
    uint32_t lod_draws, lod_instances; /* draws of those; instances, counted for each form */
    uint32_t occluders, placed_occluders; /* boxes in meshes; those of all instances */
    uint32_t groups, group_items; /* what is culled together; instances in groups */
    uint32_t models, model_nodes; /* that move, come and go as one; nodes of them all */
    uint32_t clips, channels, keys; /* animations of models, and what they are made of */
    uint32_t max_nodes;             /* of one model */
    uint32_t skins;                 /* meshes that joints bend: */
    uint32_t skin_vertices, joints; /* of their kinds, */
    uint32_t skinned_vertices, skinned_joints; /* of all of them */
    uint32_t skinned_nodes;               /* of their trees that rays are traced through */
    uint32_t first_skinned, max_skinned; /* the first of those vertices; the most of one mesh */
    uint32_t metered;    /* 1: it asks for a metered exposure, */
    float brighten, darken; /* that adapts as fast, 1/s; 0: the default */
    uint32_t sdf;        /* 1: the scene has an SDF */
    uint32_t sdf_params; /* run-time parameters of it */
    uint32_t sdf_parts, sdf_slots, sdf_block_words;
    uint32_t sdf_dynamic;   /* 1: slots depend on parameters or time */
    uint32_t sdf_anchored;  /* 1: it keeps its precision far from the origin (docs/sdf.md) */
#ifdef MASU_LAB
    uint32_t sdf_march; /* bit per masu_march that the blob has code for */
#endif
    uint32_t sdf_occlusion; /* 1: the SDF casts shadows or occludes ambient light */
    uint32_t max_instances, max_primitives; /* of one mesh */
    uint32_t shadow_cascades; /* of the sun's shadow map; 0: none. Scenes with instances only */
    uint32_t shadow_resolution;
    float shadow_distance, shadow_lambda;
    uint32_t draws;      /* draw calls of one G-buffer pass, without LODs */
    uint64_t triangles;  /* of one frame: every instance counted, in its finest form */
    uint32_t textures;   /* pictures: layers of the texture arrays */
    uint32_t texture_arrays, texture_sets;
    uint32_t masks; /* 1: some material has an alpha mask */
    uint32_t singles; /* 1: some material is not seen from behind */
    uint32_t surfaces; /* of those not blended: with a specular factor, a coat, small relief or
                        * occlusion map */
    uint32_t coats;    /* materials with a clear coat */
    uint32_t meso;     /* small reliefs */
    uint32_t blends;   /* materials that are blended */
    uint32_t transparents; /* their primitives, counted for each instance */
    uint32_t transparent_sets; /* texture sets that these use, at least 1 */
    uint32_t lights;   /* points and spots */
    uint32_t probes, probe_sets;
    uint64_t probe_words; /* 4 bytes each: what all sets of all probes take */
    uint32_t environment_size, environment_mips; /* texels along an edge of its map; 0: none */
    uint32_t analytic_sky; /* 1: the sky follows from the sun */
    uint32_t fog;          /* 1: there is fog */
    float occlusion_radius; /* of ambient occlusion in screen space, metres; 0: none */
    uint32_t reflections;   /* 1: reflections are traced: */
    uint32_t trace_sdf;     /* 1: of the SDF too */
    uint32_t trace_nodes, trace_triangles; /* of the trees that rays are traced through; 0: none */
    uint32_t trace_instances;              /* that rays meet */
    uint32_t trace_levels; /* of nodes, of the deepest mesh's tree that rays are traced through; 0: none */
    uint32_t trace_textures; /* small pictures of textures for them */
    uint32_t trace_colors;   /* of these such as rays look up; the rest are means of roughness */
    uint64_t trace_texels; /* 4 bytes each */
    float specular_cutoff, glossiest; /* roughness from which they are not; the least of any surface */
    float trace_distance;   /* longest ray, m */
    uint64_t texture_bytes;         /* of their texels as compressed blocks */
    uint64_t texture_bytes_decoded; /* and where the device takes no blocks */
    uint32_t own_coats; /* 1: some coat has a map, or a normal that is not its base's */
    uint32_t tints;     /* 1: what shines through some blended material has its colour */
    uint32_t smooth_edges; /* 1: rungs that nobody gave are anti-aliased: MASU_AA_SMAA_HIGH, with a governor
                              temporal */
} masu_scene;

/* Checks every offset, count, index, float and the hash of `blob` and fills `*out`; in time that grows with
 * its size alone. A blob with an SDF holds SPIR-V, which the driver will compile and run: that it is whole, asks for
 * nothing that Masu does not bind and was compiled for this blob's counts is checked, that it does no harm is not, and
 * cannot be. Such a blob is as trusted as the program (docs/blob.md, Trust): take it from your own build, or
 * check a signature first. Allocates nothing, keeps nothing. `blob` must be 16-byte aligned. It must stay readable and unchanged until
 * masu_load has returned MASU_OK for the last renderer made from it; afterwards it may be freed.
 * MASU_ERROR_ARGUMENT: `blob` or `out` is NULL, or `blob` misaligned. MASU_ERROR_VERSION: a blob of another format
 * version. MASU_ERROR_SCENE: anything else; the detail names the section and the element. */
MASU_API MASU_MUST_USE masu_result masu_scene_bind(const void *blob, uint64_t blob_bytes,
                                                   masu_scene *out, masu_detail *detail);

/* Number of the SDF parameter `name`, or -1. Looks at the blob, which must still be readable. */
MASU_API int32_t masu_scene_sdf_param(const masu_scene *scene, const char *name);

/* Names of what a scene has, by index: 0 .. instances - 1, models - 1, lights - 1, materials - 1. "": it has none, or there is
 * no such index. They lie in the blob, which must still be readable. */
MASU_API const char *masu_scene_instance_name(const masu_scene *scene, uint32_t index);
MASU_API const char *masu_scene_model_name(const masu_scene *scene, uint32_t index);
MASU_API const char *masu_scene_light_name(const masu_scene *scene, uint32_t index);
MASU_API const char *masu_scene_material_name(const masu_scene *scene, uint32_t index);
/* The same of the clip-th clip of a model. */
MASU_API const char *masu_scene_clip_name(const masu_scene *scene, uint32_t model, uint32_t clip);

/* Scenes by what their frames are made of: quality ladders are measured for each (masu_desc.ladder). A
 * world is of polygons alone and has both LODs of meshes and occluders. */
typedef enum masu_scene_class {
    MASU_SCENE_POLYGONS = 0,
    MASU_SCENE_WORLD = 1,
    MASU_SCENE_SDF = 2,
    MASU_SCENE_BOTH = 3,            /* polygons and an SDF */
    MASU_SCENE_POLYGONS_TRACED = 4, /* the same four with traced reflections */
    MASU_SCENE_WORLD_TRACED = 5,
    MASU_SCENE_SDF_TRACED = 6,
    MASU_SCENE_BOTH_TRACED = 7,
    MASU_SCENE_CLASSES = 8
} masu_scene_class;

/* NULL: MASU_SCENE_POLYGONS. */
MASU_API masu_scene_class masu_scene_class_of(const masu_scene *scene);

/* "world-traced". Never NULL. */
MASU_API const char *masu_scene_class_name(masu_scene_class scene_class);

/* ---- Description ----------------------------------------------------------------------------- */

#define MASU_MAX_RUNGS 8u
#define MASU_MAX_PARTS 3u /* of a frame (masu_desc.split) */
#define MASU_MAX_TARGETS 8u
#define MASU_MAX_FLIGHT 3u
#define MASU_MAX_PASSES 128u
#define MASU_MAX_RESOURCES 96u
#define MASU_MAX_SDF_PARAMS 256u
#define MASU_MAX_VIEWS 5u /* the camera and each cascade */
#define MASU_MAX_CASCADES 4u
#define MASU_MAX_REFRESH 64u

/* Rungs, their knobs, limits; with masu_study.h, which is for studies alone. */
#include "masu_knobs.h"

/* Room for what the host adds while it runs, beyond what the scene has. All of it counts in masu_memory, models and
 * lights in limits and in peaks too, as if the scene had them; 0 of a kind costs nothing. */
typedef struct masu_reserve {
    /* Copies of models that move, besides those that the scene has spare (masu_model_add), 0..16384. A place holds
     * any of them: each is as large as the largest, in nodes, instances, blended primitives and traced instances,
     * and costs what limits say of these; where the scene has occluders, those of its meshes too. All places
     * together have at most 2^20 of any of these. Models with skins are not copied and do not count. */
    uint32_t models;
    uint32_t lights; /* punctual lights (masu_punctual_light_add), 0..4096 and with the scene's at most 4096 */
    /* What a frame may bring (masu_frame_desc); without a scene nothing. */
    uint32_t particles; /* 0..65536: 64 bytes each per frame in flight, and 16 for each blended primitive, device; 16
                           bytes each, host */
    uint32_t decals;    /* 0..1024: 112 bytes each per frame in flight, device */
    uint32_t lines;     /* 0..65536: 32 bytes each per frame in flight, and 4 for each pixel of the output, device */
} masu_reserve;

/* Device memory roles. On unified memory all of it is one block of role MASU_ROLE_DEVICE. */
typedef enum masu_role {
    MASU_ROLE_DEVICE = 0,   /* resident buffers and transient images */
    MASU_ROLE_UPLOAD = 1,   /* written by the host, read by the GPU: per-frame data, staging */
    MASU_ROLE_READBACK = 2, /* written by the GPU, read by the host: counters, images asked for */
    MASU_ROLE_COUNT = 3
} masu_role;

/* A device block of the host's own, one per role that masu_memory_query asks for. memory ==
 * VK_NULL_HANDLE: masu_init makes the one allocation of that role itself. The memory type can change
 * the plan (what the host can write needs no staging buffer): query again with the blocks set. */
typedef struct masu_device_block {
    VkDeviceMemory memory; /* of roles with device_address set in the query: allocated with
                              VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT */
    VkDeviceSize offset; /* a multiple of masu_memory.roles[].alignment */
    VkDeviceSize bytes;
    void *mapped; /* host pointer to `offset`; required for roles with host_visible set in the query
                   */
    uint32_t memory_type; /* one of masu_memory.roles[].type_bits */
} masu_device_block;

/* Images the host wants to read after a frame. Each costs its full size per frame in flight in the
 * readback role. */
typedef enum masu_readback_bits {
    MASU_READBACK_DEPTH = 1,  /* float: near / view z of the nearest surface, 0: none */
    /* The next two are not defined where the depth is 0. */
    MASU_READBACK_ALBEDO = 2, /* 4 x uint8: sqrt of linear albedo, roughness; of what emits see shaders/shared/pack.glsl */
    MASU_READBACK_NORMAL =
        4, /* uint32: octahedral 13+13 bits, metallic 4 bits, flags 2 bits (masu_unpack_normal) */
    MASU_READBACK_HDR = 8, /* 4 x half: linear radiance before exposure */
    /* 4 x half: where the pixel's surface point was in the previous frame: x, y: previous position
     * minus the present one, in pixels of this frame's render size, y down; z: previous view depth
     * / present one, minus 1 (0 for the sky); w: 1, or 0 where the point was behind the camera or
     * cannot be told, x y z are then 0. What jitter has changed by, with temporal the rung's own too,
     * is in it. Halves: off by up to 2^-12 of the motion. In a rung with temporal and specular_fine
     * a pixel that mirrors more than it scatters, at a roughness of at most 0.17, has the motion of
     * what it mirrors, as far as the reflections' own history tells it; z is then the depth of the
     * mirror's plane where that was seen. Asking for it makes the plan keep the previous frame: one
     * more image and one more pass or two. */
    MASU_READBACK_VELOCITY = 16,
    /* 2 x 16 bit unorm: how much of the sun, and of the ambient light, is seen. Only of scenes with
     * a shadow map, SDF shadows, or ambient occlusion of either kind; asking it of others is ignored,
     * and a rung that has none of it leaves it as it was. */
    MASU_READBACK_OCCLUSION = 32,
    /* float, cascades side by side: depth along the sun, 1 nearest to it, 0 where nothing is. Only
     * of scenes with a shadow map. Culling leaves out what casts no shadow into the picture;
     * rungs[].frustum and .occlusion MASU_OFF: all is there */
    MASU_READBACK_SHADOW_MAP = 64,
    MASU_READBACK_ALL = 127
} masu_readback_bits;

/* Where a frame is split, so that the host's own commands go between its parts: masu_frame then hands out
 * masu_commands.parts, and masu_split_of tells which images the host has there. */
typedef enum masu_split_bits {
    /* Before exposure and tone curve: linear radiance before exposure at the render size, to be drawn into,
     * depth to be tested against. Behind everything of the scene, blended surfaces too, and behind
     * desc.readback, which is of the scene alone; what is drawn here is metered, tone-mapped, anti-aliased
     * and upscaled with the rest. Of scenes */
    MASU_SPLIT_BEFORE_TONE = 1,
    /* After anti-aliasing, upscaling and sharpening, at the output size: before the blit or copy to the target,
     * or, of storage targets, when the target has been written. What is drawn after the frame's last part,
     * on the target, lies over it */
    MASU_SPLIT_AFTER_UPSCALE = 2,
    /* Velocities, as of MASU_READBACK_VELOCITY, in every rung, at the same cost. With BEFORE_TONE or KEEP */
    MASU_SPLIT_VELOCITY = 4,
    /* HDR, depth, and velocity where it is asked for, AFTER_UPSCALE, too: their bytes are not used again for
     * what comes in between. With AFTER_UPSCALE */
    MASU_SPLIT_KEEP = 8,
    MASU_SPLIT_ALL = 15
} masu_split_bits;

/* Pipelines that outlive a renderer, and that several share: masu_init uses what is there and adds what it had to
 * make, masu_destroy leaves all to it. So another scene, or another size, makes only pipelines that no renderer before
 * had. Zero at first; for one device and one build of the library. masu_init and masu_destroy of renderers with the same
 * pool must not run at the same time. The host owns it and ends it with masu_pipelines_destroy. */
#define MASU_MAX_PIPELINES 384u
typedef struct masu_pipelines {
    uint32_t count;       /* that are there */
    uint32_t made, taken; /* by all masu_init so far */
    VkSampler samplers[2];
    struct {
        uint64_t key; /* what it was made of */
        VkPipeline pipeline;
        uint32_t users; /* places in renderers that there are now */
    } rows[MASU_MAX_PIPELINES]; /* what has no room here is destroyed with its renderer */
} masu_pipelines;

typedef struct masu_vulkan {
    PFN_vkGetInstanceProcAddr get_instance_proc_addr; /* required */
    VkInstance instance;              /* required, created with API version >= 1.1 */
    VkPhysicalDevice physical_device; /* required */
    VkDevice device;                  /* required */
    uint32_t queue_family;            /* graphics + compute */
    const VkAllocationCallbacks
        *allocator; /* passed to every create and allocate; NULL: the driver's own. pfnAllocation,
                       pfnReallocation and pfnFree are required, of the two internal ones both or none */
    VkPipelineCache pipeline_cache; /* used in masu_init; VK_NULL_HANDLE: none */
    /* Features that the device was created with; Vulkan does not let a library ask. */
    uint32_t texture_compression_bc; /* not 0: textureCompressionBC. Textures then stay compressed:
                                        1/4 to 1/8 of the memory */
    float max_anisotropy; /* samplerAnisotropy is enabled: samples along the longer axis, 2 to
                             limits.maxSamplerAnisotropy; 0: it is not */
    uint32_t ray_query; /* not 0: VK_KHR_ray_query, VK_KHR_acceleration_structure and buffer device
                           addresses (the extension or 1.2) are enabled, each with its feature */
    uint32_t shader_float16; /* not 0: shaderFloat16 of VK_KHR_shader_float16_int8 (or 1.2) is enabled */
    masu_pipelines *pipelines; /* must live until masu_destroy; NULL: pipelines live as long as the renderer */
} masu_vulkan;

/* What the numbers in a target mean. White is what a radiance of 1 times the exposure becomes without
 * a tone curve. */
typedef enum masu_encoding {
    MASU_ENCODING_AUTO = 0,   /* SRGB; LINEAR for targets of floats */
    MASU_ENCODING_SRGB = 1,   /* IEC 61966-2-1: 0 to 1, 1 is white. Any format */
    MASU_ENCODING_LINEAR = 2, /* scRGB: linear, primaries of sRGB, 1 is 80 nits, more is brighter.
                                 VK_FORMAT_R16G16B16A16_SFLOAT */
    MASU_ENCODING_PQ = 3      /* HDR10: primaries of BT.2020, SMPTE ST 2084 of nits. Formats of 10 or 16
                                 bits */
} masu_encoding;

typedef struct masu_targets {
    const VkImage *images;    /* `count` images of the output size */
    const VkImageView *views; /* one per image; needed for storage targets, else may be NULL */
    uint32_t count;           /* 1..8 */
    /* 8 bits (R8G8B8A8, B8G8R8A8, A8B8G8R8, each UNORM or SRGB: the same bytes), 10 bits
     * (A2B10G10R10, A2R10G10B10), 5 and 6 (R5G6B5, B5G6R5), 16 (R16G16B16A16, UNORM or SFLOAT). 0:
     * VK_FORMAT_R8G8B8A8_UNORM. Without a scene: UNORM only */
    VkFormat format;
    uint32_t storage;         /* not 0: written directly as storage images; 0: filled by a blit */
    VkImageLayout
        final_layout; /* VK_IMAGE_LAYOUT_UNDEFINED (0): VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL */
    masu_encoding encoding; /* with a scene */
    /* Of LINEAR and PQ, nits, 1..10000: white, and what the display shows at most, which bends the
     * neutral curve. 0: 80 and 203 (BT.2408); 1000, or white where that is more */
    float white, peak;
} masu_targets;

/* How radiance times exposure becomes what is shown. ACES and NEUTRAL end at white; with LINEAR and PQ
 * NEUTRAL ends at the peak. */
typedef enum masu_tone {
    MASU_TONE_AUTO = 0, /* ACES */
    MASU_TONE_NONE = 1, /* what it is, cut off at white; with LINEAR and PQ at 10000 nits */
    MASU_TONE_ACES = 2, /* filmic: a fit of the ACES reference rendering (Narkowicz 2016) */
    MASU_TONE_NEUTRAL = 3 /* colours as they are up to 0.76 of the most, then towards white (Khronos PBR
                             Neutral) */
} masu_tone;

/* Exposure that follows the picture: light.exposure times 0.18 / the mean of its luminance, which is
 * that of logarithms, without the darkest and the brightest pixels, black ones, and any that are not
 * finite. It adapts by time_step, at once in the first frame and after a cut. */
typedef struct masu_exposure {
    masu_switch metered; /* OFF: light.exposure alone, no pass and no memory for it. AUTO: as the scene
                            says */
    /* How fast, 1/s, up to 1e6: the share of the way that is left falls by e in 1 / speed. 0: the
     * scene's, else 1 (the picture has become darker) and 3 (brighter): as eyes, quicker to light */
    float brighten, darken;
    float low, high;   /* shares of the counted pixels left out, 0..1, less than 1 in sum; below 0: none;
                          0: 0.1 of the dark and 0.1 of the bright */
    float min, max; /* bounds of the metered factor, 1e-9..1e9; 0: 1/1024 and 1024 */
} masu_exposure;

/* Without a scene: the host's image is the input of anti-aliasing, where the rung asks for it, EASU and
 * RCAS. What is sampled is taken as display-encoded colour of 0..1; NaN, infinities and what is below 0
 * count as 0, what is above 1 as 1. So of an image in an sRGB format the view must be UNORM: an sRGB view
 * gives linear numbers, which are filtered as they are and not encoded again. What is anti-aliased has 8
 * bits a channel from there on. */
typedef struct masu_source {
    VkImageView view; /* VK_NULL_HANDLE: none. Sampled, layout
                         VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL on entry and exit */
    uint32_t width,
        height; /* valid texels from (0,0); a larger image is fine: nothing outside is read */
    VkFormat format; /* of the view; 0: not told. 8-bit UNORM colour is then known to be just that, which
                        spares a tenth of the work; the result is the same */
} masu_source;

/* A part of the target that frames of their own are drawn to: split screen, a map, a mirror. Pixels of the
 * output, from its upper left corner. */
typedef struct masu_viewport {
    uint32_t x, y, width, height;
} masu_viewport;
#define MASU_MAX_VIEWPORTS 4u

#define MASU_LOAD_STEP_MIN 65536u /* bytes: what the longest row of texels takes */

/* ---- The governor ---------------------------------------------------------------------------- */

typedef enum masu_governor_mode {
    MASU_GOVERNOR_OFF = 0,  /* the host gives each frame's rung */
    MASU_GOVERNOR_ON = 1,   /* MASU_RUNG_AUTO: a rung that is expected to keep the target */
    MASU_GOVERNOR_FIXED = 2 /* MASU_RUNG_AUTO: `rung`; times are followed all the same */
} masu_governor_mode;

/* Chooses rungs by the times of frames. Rungs are taken to be in falling quality: the lowest number
 * that fits is best. Times come from two timestamps around each frame, from masu_frame_wall, or
 * both, which is best: a timer that lies is then found out. All zero: there is none, and it costs
 * nothing. */
typedef struct masu_governor_desc {
    masu_governor_mode mode;
    float target_ms; /* a frame's time on the GPU, 1..1000 ms; 0: 16.67 */
    float headroom;  /* part of the target that a better rung has to leave free besides a margin for
                        the noise that is measured, 0..0.5; 0: 0.02. Below 0: none */
    uint32_t best_rung;  /* the lowest number it may choose */
    uint32_t worst_rung; /* the highest; 0: the last rung */
    uint32_t rung;       /* of MASU_GOVERNOR_FIXED */
    uint32_t wall_only;  /* not 0: no timestamps for it, as where the device has none */
    uint32_t dwell; /* frames: a rung is chosen to last so long, and no better one before, 1..600;
                       0: 24 */
    float costs[MASU_MAX_RUNGS]; /* a first guess of what the part of a frame that depends on the
                                    rung costs, beside other rungs; 0: that of masu_desc.ladder, computed
                                    for the class of the GPU where that is known
                                    (masu_plan_info.computed_for), else measured on a CPU; without a
                                    ladder scale^2 */
    uint32_t steady_clock; /* not 0: the clock of the GPU does not follow its load. 0: at rest for 1,800
                              frames at a rung that takes less than 0.92 of the target, a better one that
                              is expected to take at most 1.25 of it is tried for 12 frames, to see whether
                              the clock follows; seldomer after each that did not */
} masu_governor_desc;

typedef struct masu_desc {
    masu_vulkan vulkan;
    const masu_scene
        *scene; /* NULL: no scene; then source must be given. Read during the call only */
    masu_source source;
    VkExtent2D output; /* pixels, 1..16384 and within the device's maxImageDimension2D */
    masu_targets targets;
    uint32_t frames_in_flight; /* 1..3; 0: 2 */
    uint32_t rung_count; /* 0: as `ladder` says */
    masu_rung rungs[MASU_MAX_RUNGS]; /* in falling quality by convention; any order works */
    /* The rungs where rung_count is 0. ON: up to eight that were measured beforehand for the scene's
     * class (masu_ladder_of), with their flips, and their times as those governor.costs that are 0.
     * OFF, and without a scene: three, scale 1.0 (no upscaling), 0.8 and 0.4 (EASU, RCAS). AUTO: ON
     * with a governor, else OFF. */
    masu_switch ladder;
    float flips[MASU_MAX_RUNGS]; /* error of each rung, FLIP, in motion and at rest, 0..1; 0: unknown. Decides nothing: the
                                    plan says it again */
    masu_limits limits;
    masu_reserve reserve;
    uint32_t live_materials; /* not 0: masu_material_set. 60 host bytes for each material and 48 per frame in
                                flight on the device, which each frame copies to where shaders read them; with
                                reflections of polygons 84 and 112. 0: nothing. Without a scene ignored */
    uint64_t host_budget;   /* bytes; 0: none. A plan that needs more is MASU_ERROR_LIMIT */
    uint64_t device_budget; /* bytes over all roles; 0: none */
    masu_device_block device_blocks[MASU_ROLE_COUNT];
    uint32_t analytic_sky; /* not 0: frames may have light.turbidity where the scene has none */
    /* Several views of the one scene: a frame is drawn to viewports[masu_frame_desc.viewport], with a camera and
     * a rung of its own. 0: one, all of the output. Each is within the output, and of storage targets begins at
     * 0, 0 (they may have a target each). They may overlap: what is drawn later covers. Costs a set of
     * recordings for each. Scenes alone. */
    uint32_t viewport_count;
    masu_viewport viewports[MASU_MAX_VIEWPORTS];
    /* not 0: masu_resize may make the output smaller, and larger again up to `output`. 32 host bytes for each
     * draw of a G-buffer pass, LODs too, and a bounds test where the last pass stores. Scenes alone. */
    uint32_t resizable;
    /* What finds the polygons that reflections show: ray queries of the device, or the library's own
     * tree in a compute shader, which needs nothing of the device. Both find the same. AUTO:
     * queries, if vulkan.ray_query says that they are there, the device is a discrete or integrated
     * GPU, and its limits suffice: on a CPU they are slower than the own tree. ON: queries, or
     * MASU_ERROR_DEVICE. OFF: the own tree. Without reflections of polygons nothing is asked.
     * Queries take more memory, which is planned as all is: see masu_memory. */
    masu_switch ray_query;
    /* What weighs the texels that EASU takes: floats of 16 bits, or of 32. AUTO: of MASU_EASU_FAST 16, if
     * vulkan.shader_float16 says that they are there and the device is a discrete or integrated GPU: CPUs
     * emulate them; of MASU_EASU_FULL 32. ON: 16 of both, which changes EASU by up to 2/255, or
     * MASU_ERROR_DEVICE; rungs with debug.exact stay at 32. OFF: 32. */
    masu_switch half_floats;
    masu_exposure exposure;
    masu_tone tone;
    /* Slow ramps without bands: the pass that writes the target rounds each pixel up or down, by a
     * pattern that depends on place and frame number alone, so that the mean is right. What is a step
     * of the target stays one: 0 and 1 do. AUTO: off for storage targets, which tools read back and
     * compare, on for others of at most 8 bits. Nothing happens without a scene, or beyond 10 bits. */
    masu_switch dither;
    /* 16-bit floats between tone curve and target instead of 10 bits, twice the bytes of those images. AUTO:
     * on for targets of more than 8 bits, which take it; OFF leaves them 8. ON with 8 bits: neither as
     * storage targets nor in an SRGB format, which gets a copy of bytes. */
    masu_switch deep_color;
    uint32_t readback; /* masu_readback_bits; without a scene there is nothing to read: ignored */
    uint32_t split;    /* masu_split_bits; 0: a frame is one command buffer */
    /* not 0: a frame may ask what one pixel shows (masu_frame_desc.pick, masu_pick). A frame that asks draws what
     * is near that pixel a second time; all others have an empty command for each primitive. Per frame in flight 20
     * bytes for each of these and 4 for each instance, LODs too. Without a scene ignored. */
    uint32_t picking;
    /* Bytes that a masu_load writes at most, MASU_LOAD_STEP_MIN or more: for a scene that is loaded while frames of
     * another renderer go on (masu_load says how). 8 host bytes for each step; where there is a staging buffer it is
     * no larger. 0: at most 4 MiB into the staging buffer, and all at once what the host can write where it lives. */
    uint64_t load_step;
    masu_governor_desc governor;
    masu_debug debug;
    masu_deny deny;
    masu_log_fn log; /* NULL: silent */
    void *log_user;
    uint64_t (*clock_ns)(
        void *user); /* monotonic nanoseconds; NULL: build times of pipelines are not measured */
    void *clock_user;
} masu_desc;

/* ---- Memory ---------------------------------------------------------------------------------- */

typedef struct masu_role_need {
    uint64_t bytes; /* 0: this role is not used */
    uint64_t alignment;
    uint32_t type_bits;    /* memory types that can serve it, most of them wished for */
    uint32_t type;         /* the one masu_init would take */
    uint32_t host_visible; /* 1: the block must be mapped */
    uint32_t device_address; /* 1: the memory must be allocated with
                                VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT */
} masu_role_need;

typedef struct masu_memory {
    uint64_t host_bytes;
    uint64_t host_alignment; /* a power of two, at most 64 */
    uint64_t device_bytes;   /* sum over the roles */
    uint32_t unified;        /* 1: all roles are one block */
    masu_role_need roles[MASU_ROLE_COUNT];
    uint64_t transient_unaliased;   /* bytes of transient images, each for itself */
    uint64_t transient_aliased;     /* as planned */
    uint64_t transient_lower_bound; /* largest set alive at once: no plan can be smaller */
} masu_memory;

/* Runs the layout walk of masu_init without a block. Creates no lasting object. Looks at the scene's blob, as masu_plan
 * and masu_init do (sizes of textures, reserve.models, ray queries): it must still be readable. Errors as
 * masu_init, except MEMORY. */
MASU_API MASU_MUST_USE masu_result masu_memory_query(const masu_desc *desc, masu_memory *out,
                                                     masu_detail *detail);

typedef struct masu_renderer masu_renderer; /* lives inside the caller's block */

/* Creates everything: plans memory, makes the device allocations that the host did not bring, all
 * images, buffers, pipelines, descriptor sets and one command buffer per (frame in flight, rung,
 * target), twice as many for each slow cascade (rungs[].shadow_refresh). `block` is `block_bytes` of any content, aligned to masu_memory.host_alignment; it
 * belongs to the renderer until masu_destroy. Nothing is written outside it. On failure *out is
 * NULL and every object is destroyed again. MASU_ERROR_ARGUMENT: a bad field, named.
 * MASU_ERROR_MEMORY: block NULL, misaligned or too small (needed, given); the same for device
 * blocks. MASU_ERROR_LIMIT: a limit or budget. MASU_ERROR_DEVICE: something is missing, named.
 * MASU_ERROR_VULKAN / _DEVICE_LOST: the call is named, its VkResult is in the detail. */
MASU_API MASU_MUST_USE masu_result masu_init(const masu_desc *desc, void *block,
                                             uint64_t block_bytes, masu_renderer **out,
                                             masu_detail *detail);

/* Destroys every Vulkan object of the renderer and frees device memory that masu_init allocated.
 * The device must be idle. NULL is fine. */
MASU_API void masu_destroy(masu_renderer *renderer);

/* Destroys what a pool holds, and makes it zero. Renderers that have taken from it must be destroyed before. Of
 * `vulkan` function, instance, device and allocator are read. NULL is fine. */
MASU_API void masu_pipelines_destroy(const masu_vulkan *vulkan, masu_pipelines *pipelines);

/* Another output size and other targets, without a pipeline, an allocation or a load: the recordings are made
 * again (a millisecond or some). Takes desc.resizable and a finished masu_load; the blob may be gone. `output`:
 * 1 x 1 to desc.output. `targets`: as many, of the same format, storage, layout and encoding as the
 * description's; format, layout and encoding may be 0, for these. Its arrays are read during the call, its
 * handles must live until the next masu_resize or masu_destroy. `viewports`: desc.viewport_count of them, NULL where
 * there are none. The device must be idle. The next frame is a
 * cut; frames, slots, transforms, and what the governor knows go on. MASU_ERROR_ARGUMENT: something other
 * than said. MASU_ERROR_LIMIT: larger than desc.output: masu_destroy and masu_init. MASU_ERROR_STATE: not
 * resizable, or not loaded. All of these leave everything as it was. MASU_ERROR_VULKAN / _DEVICE_LOST: a call
 * has failed half-way; all that is left to do is masu_destroy. */
MASU_API MASU_MUST_USE masu_result masu_resize(masu_renderer *renderer, VkExtent2D output,
                                               const masu_targets *targets,
                                               const masu_viewport *viewports, masu_detail *detail);

/* The description with the defaults filled in, as masu_init uses it: by the same function. Needs no device, and
 * is the same when resolved again. What depends on the scene (or source) or on the output's size is left as it
 * is where these are not given; resolve after the last change, for what follows from another field then stays.
 * These words stay AUTO:
 *  - rungs[].specular and .occlusion where the scene has use for them: with ON masu_init fails on a device
 *    that lacks the storage buffers, with AUTO it goes without;
 *  - ray_query, half_floats, debug.share_rays: these follow from the device. */
MASU_API masu_desc masu_desc_resolved(const masu_desc *desc);

/* Fills rung_count, rungs, flips and governor.costs with the measured ladder of the scene's class, or of
 * the nearest class that was measured: to be changed and given to masu_init. What the scene lacks, rungs
 * that turn it change nothing by. `from` may be NULL: scene, size, driver and date of the measurement.
 * MASU_ERROR_ARGUMENT: a NULL pointer. */
MASU_API MASU_MUST_USE masu_result masu_ladder_of(const masu_scene *scene, masu_desc *desc,
                                                  const char **from);

/* One row of the memory plan. */
typedef struct masu_memory_row {
    const char *name;
    const char *kind; /* "host", "buffer", "texture" (an array of them), "image" */
    masu_role role;   /* of device rows */
    uint64_t count;   /* elements, or texels of an image */
    uint64_t bytes;   /* total */
    uint64_t alignment;
    uint64_t offset; /* in its block */
    /* 1: lives from first_pass to last_pass only, may share its bytes with others. A buffer that
     * has it lives in masu_load alone: it shares them with any image that has it. */
    uint32_t transient;
    uint32_t first_pass, last_pass; /* rows of masu_plan.passes */
} masu_memory_row;

/* Rows of the renderer's memory: host rows first. Writes at most `capacity` rows, none where `rows` is NULL,
 * and returns how many there are. */
MASU_API uint32_t masu_memory_report(const masu_renderer *renderer, masu_memory_row *rows,
                                     uint32_t capacity);

/* ---- What the governor knows ----------------------------------------------------------------- */

#define MASU_GOVERNOR_REASONS(X)                                                                   \
    X(MASU_GOVERNOR_REASON_NONE, 0, "there is no governor")                                        \
    X(MASU_GOVERNOR_REASON_START, 1, "no frame has been measured yet")                             \
    X(MASU_GOVERNOR_REASON_HOLD, 2, "the rung fits, and no better one does")                       \
    X(MASU_GOVERNOR_REASON_BEST, 3, "the best rung fits")                                          \
    X(MASU_GOVERNOR_REASON_WAIT, 4, "a better rung fits, but the last change is too recent")       \
    X(MASU_GOVERNOR_REASON_DOWN, 5, "the rung before was expected to miss the target")             \
    X(MASU_GOVERNOR_REASON_JUMP, 6, "the load has jumped: the rung before would miss the target")  \
    X(MASU_GOVERNOR_REASON_PANIC, 7, "two frames in a row have missed the target")                 \
    X(MASU_GOVERNOR_REASON_UP, 8, "this better rung is expected to keep the target")               \
    X(MASU_GOVERNOR_REASON_WORST, 9, "no rung keeps the target: the cheapest")                     \
    X(MASU_GOVERNOR_REASON_FUTILE, 10, "no rung keeps the target; cheaper ones save nothing")         \
    X(MASU_GOVERNOR_REASON_BLIND, 11, "no frame has been measured for long: the rung stays")       \
    X(MASU_GOVERNOR_REASON_FIXED, 12, "the rung is fixed")                                         \
    X(MASU_GOVERNOR_REASON_HOST, 13, "the host has chosen the rung")                                \
    X(MASU_GOVERNOR_REASON_UNUSUAL, 14, "the frame's time will say nothing: the rung stays")  \
    X(MASU_GOVERNOR_REASON_TRIAL, 15, "a better rung: does the clock follow the load?")

/* Why the rung is what it is. */
typedef enum masu_governor_reason {
#define MASU_GOVERNOR_REASON_ENUM(name, value, text) name = value,
    MASU_GOVERNOR_REASONS(MASU_GOVERNOR_REASON_ENUM)
#undef MASU_GOVERNOR_REASON_ENUM
        MASU_GOVERNOR_REASON_FORCE_32 = 0x7FFFFFFF
} masu_governor_reason;

/* What times are taken from at the moment. */
typedef enum masu_governor_source {
    MASU_GOVERNOR_SOURCE_NONE = 0, /* nothing that is believed */
    MASU_GOVERNOR_SOURCE_GPU = 1,  /* timestamps, checked against the wall where it is known */
    MASU_GOVERNOR_SOURCE_WALL = 2  /* the host's clock: there are no timestamps, or they lie */
} masu_governor_source;

/* Why the rung cannot move to where it should be. */
typedef enum masu_governor_lock {
    MASU_GOVERNOR_FREE = 0,
    MASU_GOVERNOR_LOCKED_FIXED = 1,  /* there is one rung to choose from */
    MASU_GOVERNOR_LOCKED_WORST = 2,  /* over the target at the cheapest rung */
    MASU_GOVERNOR_LOCKED_FUTILE = 3, /* over the target, and rungs hardly differ in time */
    MASU_GOVERNOR_LOCKED_BLIND = 4,  /* there are no samples to go by */
    MASU_GOVERNOR_LOCKED_CPU = 5     /* the host's own work is over the target: no rung helps, and for its
                                        sake none is left */
} masu_governor_lock;

/* What the governor knows, and what it has done. */
typedef struct masu_governor_info {
    masu_governor_mode mode;
    uint32_t rung; /* of the frame that was handed out last */
    masu_governor_reason reason;
    const char *reason_text; /* in English, never NULL */
    masu_governor_lock locked;
    masu_governor_source source;
    uint32_t rung_count;
    float predicted_ms[MASU_MAX_RUNGS]; /* of a frame like the last at each rung; 0: not known */
    float target_ms;
    float fixed_ms;  /* the model: fixed + load * cost of the rung */
    float load_ms;   /* at cost 1 */
    float slope_ms;  /* how load_ms changes in a frame */
    float noise;     /* of one frame's time, standard deviation / time */
    float overhead_ms; /* wall time that timestamps do not show; part of the predictions */
    float unit; /* GPU times are multiplied by this: not 1 where the clock's unit is wrong */
    float start_delay_ms; /* pacing: a frame of this rung that is submitted so long after its interval
                             has begun is expected to end within it. Waiting so long before input is
                             read makes it that much fresher. The interval is target_ms, or, with a
                             refresh that is known, `refreshes` of them */
    uint64_t samples, rejected; /* used; left out as no frame's time, or unusual */
    uint64_t missed;  /* of the used ones: longer than the target. With a refresh that is known: frames
                         shown more than half a refresh later than they should have been */
    uint64_t changes; /* of the rung */
    float cpu_ms;     /* the host's own work for a frame (masu_frame_times), without single long ones;
                         0: not known */
    float refresh_ms;   /* of the display (masu_frame_presented); 0: not known */
    uint32_t refreshes; /* that this frame should be shown for, 1..16: the least that it, and the host's
                           own work, is expected to fit into, and not fewer than target_ms does. More
                           after 4 frames in a row that do not fit, or 4 late ones of 16; one fewer after
                           60 that would, later where that was a mistake. 0: refresh_ms is not known */
} masu_governor_info;

/* What of masu_governor_desc can be changed between frames (masu_governor_set): the same fields, units,
 * ranges and defaults, but that `mode` is ON or FIXED. */
typedef struct masu_governor_setting {
    masu_governor_mode mode;
    float target_ms, headroom;
    uint32_t best_rung, worst_rung, rung, dwell;
} masu_governor_setting;

#define MASU_GOVERNOR_STATE_VERSION 1u

/* What a governor has learnt (masu_governor_save): plain numbers without pointers, which may be copied and
 * written to a file for the same machine. Its fields are the library's; a host need not look at them. */
typedef struct masu_governor_state {
    uint32_t bytes, version; /* sizeof, MASU_GOVERNOR_STATE_VERSION */
    uint32_t known;          /* 0: it had measured nothing: all below is 0 */
    uint32_t width, height;  /* output, pixels */
    uint32_t rung_count, rung;
    uint32_t held;      /* frames that `rung` has been drawn for, at most 4096 */
    uint32_t patience;  /* a rise waits so many dwells, 1..64 */
    uint32_t wall_only; /* 1: timestamps were found to lie */
    uint32_t follows;   /* 1: the clock was seen to follow the load; */
    uint32_t trials;    /* trials since that it did not follow, 0..6 */
    double fixed_ms, load_ms;                         /* as in masu_governor_info */
    double fixed_variance, load_variance, covariance; /* of them, ms^2 */
    double noise, overhead_ms, unit;                  /* as in masu_governor_info */
    double settled_ms, mistake_ms; /* load where it came to rest; at the last rise that was taken back */
    struct {
        double scale, prior;   /* as described: what rungs are told apart by */
        double cost, variance; /* as learnt, and of its relative error */
        double penalty;        /* factor on what it is expected to take, after rises taken back */
    } rungs[MASU_MAX_RUNGS];
} masu_governor_state;

/* In English, without a newline. Never NULL. */
MASU_API const char *masu_governor_reason_string(masu_governor_reason reason);

/* ---- Frames ---------------------------------------------------------------------------------- */

typedef struct masu_commands {
    VkCommandBuffer buffer; /* parts[0] */
    uint32_t slot; /* frame-in-flight slot: its fence must be waited for before the slot comes round
                      again */
    uint32_t rung;
    uint64_t frame; /* number of this frame, from 0 */
    /* All of it, in order: one, and one more for each point that desc.split names, behind which the host's own
     * commands go. All parts are to be submitted, each once, with or without something between them, and
     * best in one vkQueueSubmit. 1 for masu_load that is MASU_INCOMPLETE. */
    uint32_t part_count;
    VkCommandBuffer parts[MASU_MAX_PARTS];
    /* Of masu_load: bytes that this step has written, and that are left for those that follow. */
    uint64_t load_bytes, load_left;
} masu_commands;

/* Copies the scene to the device. MASU_INCOMPLETE: submit commands->buffer, wait for it, call
 * again. MASU_OK: done; nothing to submit. On unified memory a scene without textures needs no
 * submit: the first call returns MASU_OK; but with ray queries, whose structures the device
 * builds. Without a scene there is nothing to copy but the table of SMAA, where a rung has it.
 *
 * With desc.load_step a call writes no more bytes than that, of which the device copies what has no place that the
 * host can write. It builds structures of ray queries of no more triangles than so many bytes hold, at 48 each, but
 * always of whole meshes. A step that has written where the host can has nothing to submit: buffer is NULL and
 * part_count 0. So another scene comes while frames of the one that is shown go on, in a renderer and blocks of its own:
 *
 *     masu_scene_bind(blob, ...); masu_memory_query(&desc, ...);  // they look at all of it, init makes all objects:
 *     masu_init(&desc, other_block, ..., &next, &detail);         // a thread of the host's may do these, in between
 *     for (;;) {                                                  // frames
 *         wait for the fence of the frame frames_in_flight frames ago
 *         step.part_count = 0;
 *         if (next && the fence of the last step's submit was waited for)
 *             loaded = masu_load(next, &step) == MASU_OK;
 *         masu_frame(now, &frame, &commands);
 *         submit(step.parts, then commands.parts, fence);
 *         if (loaded) { now = next; next = NULL; }                // the first frame of it is a cut; the old one:
 *     }                                                           // masu_destroy when its last frame was waited for
 *
 * Then its blocks are free for the scene after that: two boxes serve any number of scenes. With vulkan.pipelines both
 * have the same pipelines, so that masu_init makes only those that are new. */
MASU_API MASU_MUST_USE masu_result masu_load(masu_renderer *renderer, masu_commands *commands);

typedef struct masu_camera {
    double position[3];
    float forward[3];    /* need not be unit length */
    float up[3];         /* not parallel to forward; all zero: +Y */
    float fov_y;         /* vertical field of view, radians, 0.001 .. 3.1. With a window: not read */
    float near_distance; /* metres, 1e-9 .. 1e9; 0: the scene's. There is no far plane */
    /* Pixels of the render size, right and down, -1..1: by how much beside its own middle each pixel
     * looks. The projection is shifted and nothing turned, so that all pixels move alike. The mean of
     * frames with places all over a pixel is what a larger picture made smaller shows. Rungs with
     * temporal add places of their own, within half a pixel. Velocities hold the change from frame to
     * frame, too; cascades that are not drawn in every frame are drawn again whenever its size
     * changes. */
    float jitter[2];
    /* A projection of one's own: the window that is seen through, a metre ahead of the eye and square to
     * `forward`: its sides, metres to the right of the middle and above it. They are tangents of angles; the
     * middle of the window need not be straight ahead, nor has it to have the shape of the output. All four 0:
     * fov_y, and the output's width by its height. Each -100 .. 100, left < right and bottom < top, apart by 0.0001 and by
     * 1/1024 of the farther of the two at least. A part of a picture is the same part of its window; ambient
     * occlusion in screen space, filters and metering see of the rest nothing. Velocities and histories follow
     * a window that changes. Cascades that are not drawn in every frame are drawn again when its farthest corner
     * comes to be at another angle.
     *
     * What a host draws itself fits by this matrix, of a point (x to the right, y up, z ahead of the eye), whose
     * depth (reversed, infinitely far: 1 at near_distance n, n / z at z, 0 at infinity) is to be compared
     * by GREATER; l, r, b, t: the window, j: jitter in pixels + that of a rung with temporal, W and H the render size:
     *     clip.x =  (2 x - (r + l) z) / (r - l) - 2 j[0] / W z      clip.z = n
     *     clip.y = -(2 y - (t + b) z) / (t - b) - 2 j[1] / H z      clip.w = z */
    float left, right, bottom, top;
} masu_camera;

typedef struct masu_light {
    float sun_direction[3]; /* towards the sun; need not be unit length */
    float sun_color[3];     /* irradiance on a facing surface / pi */
    float ambient[3];       /* radiance */
    float sky_zenith[3], sky_horizon[3];
    float exposure; /* linear factor before the tone curve; 0: 1. Metered: times that factor */
    /* 0: the two colours and the ambient light above. 1.5 (very clear) to 10 (hazy): the sky follows
     * from the sun, and with it the ambient light; a sun colour of all zero then is the sun's behind
     * that air, which sets too. Takes a scene with such a sky or desc.analytic_sky. Computed anew,
     * within a millisecond of the host's time, when the direction of the sun, turbidity or ground
     * differ from those of the previous frame. */
    float turbidity;
    float ground[3]; /* albedo of what lies below the horizon of such a sky, 0..1 */
    /* Fog, of scenes that have some; others have no code for it. Its density at a height y is
     * fog_density * exp(-fog_falloff * (y - fog_height)). */
    float fog_color[3]; /* radiance of thick fog, 0..1e9; all 0: the sky's at the horizon */
    float fog_density;  /* 1/m, 0..1e6; 0: none */
    float fog_height;   /* metres, -1e9..1e9 */
    float fog_falloff;  /* 1/m, 0..1e6; 0: the same at every height */
    float fog_start;    /* metres from the eye, 0..1e9; nearer it is clear */
} masu_light;

#define MASU_RUNG_AUTO UINT32_MAX

/* A quad that faces the eye: a round spot, softer towards its edge, of smoke, sparks, dust. Sorted with what is
 * blended by the distance of its middle, blended in linear light before exposure and tone curve, hidden by what is
 * before it. Reflections and shadows know nothing of it; it is exposed, metered and anti-aliased with the
 * picture. One with a number that is not finite, beyond 1e15 m, or of no size or opacity is left out; what is out
 * of range is clamped. */
#define MASU_PARTICLE_LIT 1u      /* color is an albedo: a share of the light of the sun, as far as the shadow map
                                     lets it through to the middle, and of ambient light. It scatters evenly, as
                                     thin smoke does: color * (sun_color / 4 + ambient). Else color is radiance */
#define MASU_PARTICLE_ADDITIVE 2u /* it adds to what is behind and hides nothing */
typedef struct masu_particle {
    double position[3];     /* of its middle, world, metres */
    float half_width;       /* metres, at most 1e9 */
    float half_height;      /* 0: as wide */
    float rotation;         /* radians, counterclockwise as it is seen */
    float color[3];         /* linear, 0..4096, not multiplied by the opacity */
    float opacity;          /* 0..1, in its middle */
    float edge;             /* part of the radius from which on it fades out: 0 (from the middle on) .. 1 (a disc) */
    float soft;             /* metres before a surface or the near plane over which it fades, so that no line is seen where it
                               cuts through; 0: it does not */
    uint32_t flags;         /* MASU_PARTICLE_* */
} masu_particle;

/* A box that paints what is in it, of polygons and the SDF, before light falls on it, and covers what shines there: what is
 * transparent or does nothing but shine stays as it is, and reflections show surfaces without it. Later ones lie over earlier
 * ones. One with a number that is not finite, no volume or no opacity is left out; what is out of range is clamped. */
#define MASU_DECAL_ROUND 1u      /* an ellipse in x and y of the box; else a rectangle */
#define MASU_DECAL_KEEP_COLOR 2u /* colour and metal stay: water on a street is roughness alone */
typedef struct masu_decal {
    float rows[12];    /* the 3x4 matrix from the box, -1..1 along each axis, to the world, row by row. It is
                          painted along its z axis, on what faces that */
    float color[3];    /* albedo, linear, 0..1 */
    float opacity;     /* 0..1 */
    float roughness;   /* perceptual, 0..1; 0: the surface's own. What is smooth enough is traced, where the scene has
                          reflections */
    float metallic;    /* 0..1 */
    float edge;        /* part of the half width over which it fades out at its edge, 0..1 */
    float inner, outer; /* radians between its z axis and the surface's normal: all of it up to inner, nothing from
                           outer on, 0..pi. Both 0: 1.05 and 1.4 */
    uint32_t flags;    /* MASU_DECAL_* */
} masu_decal;

/* A line to look at what a program thinks: one pixel of the output wide, drawn after the tone curve,
 * anti-aliasing and upscaling, in the colour that is asked for; of lines that cross the later one is seen. One
 * with a number that is not finite or beyond 1e15 m is left out. */
#define MASU_LINE_ON_TOP 1u /* nothing hides it; else what is nearer than it by more than 0.5 % does */
typedef struct masu_line {
    double from[3], to[3];   /* world, metres */
    uint8_t from_color[4], to_color[4]; /* red, green, blue as in an sRGB picture; the fourth means nothing */
    uint32_t flags;          /* MASU_LINE_* */
} masu_line;

#define MASU_RUNG_AUTO UINT32_MAX

typedef struct masu_frame_desc {
    const masu_camera *camera; /* NULL: the scene's camera path at `time` */
    const masu_light *light;   /* NULL: the scene's */
    double time;     /* seconds since the start, -1e15..1e15: animation of SDF and camera path */
    float time_step; /* seconds since the previous frame; 0 is fine, within +-1e15 */
    uint32_t rung;   /* 0 .. rung_count-1, or MASU_RUNG_AUTO: the governor's */
    uint32_t target; /* 0 .. targets.count-1 */
    /* 0 .. desc.viewport_count-1. A frame of the first discards what the target holds; the others find it in
     * targets.final_layout and leave the rest of it alone. What reflections, rungs with temporal and metered
     * exposure keep from frame to frame is of one view: a frame of another viewport than the one before is a
     * cut. Those of the first alone are the governor's: the others name their rung. */
    uint32_t viewport;
    uint32_t cut;    /* not 0: what is seen has nothing to do with the previous frame (a camera cut):
                        nothing has moved. The first frame is one anyway. "Before" is the frame that
                        masu_frame handed out last, submitted or not. With rungs[].shadow_refresh
                        above 1, or rungs[].temporal (which AUTO is with a governor), the frame after one that was
                        not submitted must be a cut: the cascades or the history that it should have left are
                        not there */
    const float *sdf_params;  /* `sdf_param_count` values, NULL: the scene's defaults */
    uint32_t sdf_param_count; /* at most the scene's count; the rest keep their defaults. Values are
                            clamped to their declared range; one that is not finite is an error */
    uint32_t unusual; /* not 0: this frame's times say nothing of the next ones' (a level is loaded, shaders
                         are compiled, a debugger has stopped it): the governor keeps its rung, does not
                         learn of it (`rejected`) and does not count it as missed. Of the governor alone */
    /* Of this frame, read during the call: at most desc.reserve of each; NULL with a count of 0. */
    const masu_particle *particles;
    const masu_decal *decals;
    const masu_line *lines;
    uint32_t particle_count, decal_count, line_count;
    /* pick not 0: masu_pick will tell what this pixel of the output (or viewport) shows, counted from the upper
     * left corner: 0 .. width - 1, 0 .. height - 1. Takes desc.picking. */
    uint32_t pick, pick_x, pick_y;
} masu_frame_desc;

/* Writes this frame's uniforms and hands out the command buffer to submit. Call when the slot is
 * free: the frame that came frames_in_flight previous frames has finished on the GPU. Costs no
 * allocation and no recording. commands->rung is the rung that it is drawn at. MASU_ERROR_ARGUMENT: a
 * rung, target, camera, light or parameter that is out of range or not finite, MASU_RUNG_AUTO
 * without a governor, or an array that is NULL with a count. MASU_ERROR_LIMIT: more particles, decals or lines
 * than desc.reserve. Nothing has been written then and the frame number has not moved.
 * MASU_ERROR_STATE: masu_load has not finished. */
MASU_API MASU_MUST_USE masu_result masu_frame(masu_renderer *renderer, const masu_frame_desc *frame,
                                              masu_commands *commands);

/* ---- The host's own passes ------------------------------------------------------------------- */

/* With desc.split a frame is submitted so:
 *
 *     masu_frame(m, &frame, &commands);
 *     masu_split_of(m, MASU_SPLIT_BEFORE_TONE, commands.rung, frame.viewport, &split);
 *     masu_frame_view_of(m, &view);                       // the matrices of this frame
 *     record `own`;                                       // in a command buffer of the host's
 *     VkCommandBuffer all[] = {commands.parts[0], own, commands.parts[1]};
 *     vkQueueSubmit(queue, 1, &{.commandBufferCount = 3, .pCommandBuffers = all}, fence);
 *
 * examples/host_pass.c does it.
 *  - Barriers at a split are the library's. The part before it ends with one from all that it has done to all
 *    commands and accesses (VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT | _WRITE_BIT), and
 *    with the images in `layout`; the next part begins with one from all of the host's commands. A render pass
 *    of the host's has `layout` as its initial and its final layout, LOAD and STORE. Between its own commands
 *    barriers are the host's, other layouts too, which it must undo.
 *  - Of the images the host may read and write what `usage` allows, within `width` x `height` from 0, 0;
 *    all else of them is undefined, as are images that are not named: they share bytes.
 *  - Images and views are the same in all frames, rungs and viewports, and after masu_resize, until
 *    masu_destroy: a framebuffer is made once, of the size `image_width` x `image_height`, and render area,
 *    viewport and scissor are of the frame's `width` x `height`.
 *  - Depth is reversed: near / view z, 1 at near_distance, 0 at infinity, 32-bit floats. Test by
 *    VK_COMPARE_OP_GREATER or _GREATER_OR_EQUAL. In `layout` it can be an attachment that is not written, and
 *    sampled in the same pass. Written it is a host's transition to DEPTH_STENCIL_ATTACHMENT_OPTIMAL and back;
 *    what is written the rest of the frame sees: a rung with temporal follows surfaces by it.
 *  - HDR holds radiance before exposure: what a shader writes as v is shown as tone(v * exposure).
 *    Blending is as with any attachment; alpha is not looked at, and need not be kept. NaN is shown
 *    as black.
 *  - Velocities, reflections and shadows know nothing of what the host draws. Velocities (and a rung with
 *    temporal) take it for a part of the surface behind it.
 *  - The two timestamps of a governor, and what it makes of frames, are of all parts, the host's commands between
 *    them included. With debug.timestamps the host's commands have times of their own, of the rows split_tone
 *    and split_output. */

/* Of an image as a split point gives it. */
typedef struct masu_split_image {
    VkImage image; /* VK_NULL_HANDLE: it is not there; but see masu_split.color */
    VkImageView view; /* of all of it, with all of its usage */
    VkFormat format;
    VkImageUsageFlags usage;
    VkImageLayout layout; /* that it is in, and has to be left in */
    uint32_t image_width, image_height; /* of the VkImage: the largest rung's */
    uint32_t width, height; /* of the picture in it, from 0, 0: this rung's, this viewport's */
} masu_split_image;

typedef struct masu_split {
    uint32_t part; /* the host's commands go behind masu_commands.parts[part] */
    /* BEFORE_TONE HDR, R16G16B16A16_SFLOAT, in COLOR_ATTACHMENT_OPTIMAL: COLOR_ATTACHMENT, SAMPLED, STORAGE,
     * TRANSFER_SRC. AFTER_UPSCALE what is shown, in the encoding of the target (display-encoded colour of 0..1
     * in R8G8B8A8_UNORM; with deep_color R16G16B16A16_SFLOAT), the same layout and usage. Of storage targets it is
     * targets.images[frame.target] itself, in GENERAL: image and view are null then, and `usage` is the host's. */
    masu_split_image color;
    /* D32_SFLOAT, in DEPTH_STENCIL_READ_ONLY_OPTIMAL: DEPTH_STENCIL_ATTACHMENT, SAMPLED, TRANSFER_SRC. Of scenes with
     * an SDF an image and a pass of its own (split_depth), since what the march leaves is no attachment. AFTER_UPSCALE
     * with KEEP alone, at the render size */
    masu_split_image depth;
    /* R16G16B16A16_SFLOAT, in SHADER_READ_ONLY_OPTIMAL: SAMPLED, TRANSFER_SRC. With VELOCITY; AFTER_UPSCALE with
     * KEEP, too. What its texels are says MASU_READBACK_VELOCITY */
    masu_split_image velocity;
    /* AFTER_UPSCALE with KEEP: HDR as it went into the tone curve, read only, as velocity */
    masu_split_image hdr;
    uint32_t swapped; /* 1: AFTER_UPSCALE, of a target of B8G8R8A8_SRGB: red is where blue should be in `color` */
} masu_split;

/* What the host has at a split point in a frame of that rung and viewport (0 where there are none). May be asked at
 * any time after masu_init. `which` is one of BEFORE_TONE, AFTER_UPSCALE. MASU_ERROR_ARGUMENT: a NULL
 * pointer, a point that desc.split does not name, or there is no such rung or viewport. */
MASU_API MASU_MUST_USE masu_result masu_split_of(masu_renderer *renderer, masu_split_bits which,
                                                 uint32_t rung, uint32_t viewport, masu_split *out);

/* How a frame sees the world. Matrices are given row by row and multiply columns: a mat4 of GLSL takes them
 * transposed, or as layout(row_major). View space: x to the right, y up, the camera looks along -z, metres.
 * Clip space is Vulkan's, y down, depth reversed. */
typedef struct masu_frame_view {
    uint64_t frame; /* that it is of */
    double position[3]; /* of the eye, world */
    /* From the world to view space. Far from the origin floats are coarse: take world - position in doubles,
     * and of this matrix the rotation alone (its last column is -rotation * position). */
    float view[16];
    /* From view space to the clip space of BEFORE_TONE, depth and velocity: with the frame's jitter, the camera's and
     * that of a rung with temporal. What is drawn with it lands on the pixels and depths of the scene. */
    float projection[16];
    /* The same of AFTER_UPSCALE and of what is drawn on the target: without jitter in a rung with temporal, whose
     * result has none; else the same. */
    float output_projection[16];
    float jitter[2];     /* in `projection`: pixels of the render size, right and down */
    float near_distance; /* metres: what a depth d is of lies near_distance / d ahead */
    float exposure; /* masu_light.exposure: the factor before the tone curve. Metered: times what the GPU finds
                       (masu_stats_info.exposure) */
    uint32_t render_width, render_height, output_width, output_height; /* of the viewport */
} masu_frame_view;

/* That of the frame that masu_frame handed out last. MASU_ERROR_ARGUMENT: a NULL pointer. MASU_ERROR_STATE: there
 * was none yet, or there is no scene. */
MASU_API MASU_MUST_USE masu_result masu_frame_view_of(const masu_renderer *renderer,
                                                      masu_frame_view *out);

/* For the governor: how long the slot's last frame took by the host's clock, ms: from its submit, or
 * from the end of the previous frame if that was later, to its fence. To be called, if at all, after the
 * fence has been waited for and before the slot is used again. A time of the whole interval between
 * frames will not do where the display makes the host wait. Values that are none are left out. With two
 * frames in flight:
 *
 *     double submitted[2], ended = 0;                     // per slot; of the frame before, ms
 *     for (uint64_t n = 0;; n++) {
 *         uint32_t slot = n % 2;                          // what commands.slot will be
 *         if (n >= 2) {
 *             wait for fence[slot];                       // of frame n - 2
 *             double now = clock_ms();
 *             masu_frame_wall(m, slot, now - fmax(submitted[slot], ended));
 *             ended = now;
 *         }
 *         masu_frame(m, &frame, &commands);               // the governor reads it here
 *         submitted[slot] = clock_ms();
 *         submit(commands.buffer, fence[slot]);
 *     }
 *
 * What the host submits with the frame under the same fence, passes of its own say, is in this time, and the
 * target has to hold it too; it is not in the timestamps. Where the fence had been signalled before the host came
 * to wait, the time is too long by the difference: wait on it as soon as nothing else is to be done, or leave the
 * call out for such a frame. */
MASU_API void masu_frame_wall(masu_renderer *renderer, uint32_t slot, double wall_ms);

/* The same, and better: when the slot's last frame was handed to vkQueueSubmit and when its fence was seen
 * signalled, ns by one clock of the host's that never goes back, whatever its start. With frames in flight
 * a frame waits for the one before: the library begins its time where that one ended, whichever was told
 * first. It takes the times of every frame: after one that was left out, the next one's are too (with one
 * frame in flight none is). Look at the fence as soon as it is due: a host that comes late makes frames
 * longer. done_ns <= submit_ns: no times. To be called when masu_frame_wall would be, which then says
 * nothing.
 *
 * `cpu_ms`: what the host itself worked for this frame, from frame to frame without waiting for fences,
 * images or sleep; 0: not known. A time by the clock that is no longer than that is the host's and not the
 * GPU's: then timestamps alone are believed, and without them, where cpu_ms is over the target, nothing.
 * Over the target governor.locked is MASU_GOVERNOR_LOCKED_CPU, unless the GPU is, too. */
MASU_API void masu_frame_times(masu_renderer *renderer, uint32_t slot, uint64_t submit_ns,
                               uint64_t done_ns, double cpu_ms);

/* For the governor: frame number `frame` (masu_commands.frame) was shown at `present_ns`, of which
 * VK_GOOGLE_display_timing, VK_KHR_present_wait or the host's own clock tells, at a display whose refresh
 * takes `refresh_ns`, 1e6..1e9. Frames in their order, each once, within 16 frames; some may be left out.
 * From then on governor.refreshes says for how many refreshes the next frame should be shown, `missed`
 * counts frames that were shown later than that, and a target that is up to 5 % of a refresh above whole
 * refreshes is taken as these. A refresh_ns out of range, such as 0: it is known no longer. Values that are
 * none are left out. */
MASU_API void masu_frame_presented(masu_renderer *renderer, uint64_t frame, uint64_t present_ns,
                                   uint64_t refresh_ns);

/* Another mode, target, headroom, range, fixed rung or dwell for the governor, from the next masu_frame on.
 * All of it is replaced: fields that are 0 become their defaults. What was learnt of times and costs stays,
 * but for which rises were mistakes; a better rung that now fits is taken without waiting for the dwell.
 * Any rung is held for 8 frames, unless it is over the target or out of the range. MASU_ERROR_ARGUMENT: a
 * NULL pointer, or a field out of range, named, with what is allowed; nothing is changed then.
 * MASU_ERROR_STATE: governor.mode was OFF in masu_init. */
MASU_API MASU_MUST_USE masu_result masu_governor_set(masu_renderer *renderer,
                                                     const masu_governor_setting *setting);

/* What the governor has learnt: for masu_governor_restore after a masu_destroy and masu_init, in another
 * renderer, on another day. May be asked between any two frames. MASU_ERROR_ARGUMENT: a NULL pointer.
 * MASU_ERROR_STATE: as masu_governor_set. */
MASU_API MASU_MUST_USE masu_result masu_governor_save(masu_renderer *renderer,
                                                      masu_governor_state *out);

/* Takes it over; to be called before the first frame, or between any two. With the same rungs (scales and
 * governor.costs) and output size the first frame has the rung that the next of the old renderer would have
 * had. Else the first frame has the best rung that is expected to keep the target:
 *  - of another output size load_ms goes with the pixels; fixed_ms half with them, and its deviation is what
 *    none or all of it would make;
 *  - a rung that was described alike keeps its learnt cost, others begin with their own governor.costs,
 *    which are taken to be in the same unit on both sides, as scale^2 and those of built-in ladders are.
 * A state that had measured nothing changes nothing. MASU_ERROR_VERSION: of another version or size.
 * MASU_ERROR_ARGUMENT: a NULL pointer, or a number that no governor can have, named. MASU_ERROR_STATE: as
 * masu_governor_set. On an error nothing is changed: a host with a file of any bytes may go on without. */
MASU_API MASU_MUST_USE masu_result masu_governor_restore(masu_renderer *renderer,
                                                         const masu_governor_state *state);

/* Why the last masu_load, masu_frame, masu_split_of, or call that asks or changes an instance, model or punctual light
 * failed. Never NULL. */
MASU_API const masu_detail *masu_last_error(const masu_renderer *renderer);

/* The scene's camera path at a time, held at both ends. MASU_ERROR_STATE: the scene has no camera.
 * MASU_ERROR_ARGUMENT: a NULL pointer or a time that is not finite. */
MASU_API MASU_MUST_USE masu_result masu_camera_at(const masu_renderer *renderer, double time,
                                                  masu_camera *out);

/* The scene's own light, to be changed and given to masu_frame. MASU_ERROR_STATE: the renderer has no
 * scene. MASU_ERROR_ARGUMENT: a NULL pointer. */
MASU_API MASU_MUST_USE masu_result masu_light_of(const masu_renderer *renderer, masu_light *out);

/* HANDLES. id 0 is none; all others are given by the functions below and not to be made or counted up by
 * hand. A handle belongs to the scene of the renderer that gave it: in every renderer of the same blob it
 * means the same, so it outlives masu_destroy and masu_init again. One of another scene, or of another
 * kind, is refused with MASU_ERROR_ARGUMENT, but for a chance of (how many of its kind the scene has) in
 * 2^32 that it looks like one of these. */

/* Handle of one placed mesh. */
typedef struct masu_instance {
    uint32_t id;
} masu_instance;

/* The first instance of that name in the scene; id 0 if there is none. */
MASU_API masu_instance masu_instance_find(const masu_renderer *renderer, const char *name);

/* Moves an instance from the next masu_frame on. `rows` is the 3x4 matrix from object to world
 * space, row by row. MASU_ERROR_ARGUMENT: a handle that is not of this renderer, or a value that is
 * not finite. */
MASU_API MASU_MUST_USE masu_result masu_instance_set_transform(masu_renderer *renderer,
                                                               masu_instance instance,
                                                               const float rows[12]);

/* The index-th instance of the scene, in the order of masu_scene_instance_name; behind those, of copies of models
 * (desc.reserve). id 0 beyond the last, and where no copy is. */
MASU_API masu_instance masu_instance_at(const masu_renderer *renderer, uint32_t index);

/* Handle of a model that the scene says moves ("moving", "hidden" or "spare" in its description): all of
 * its nodes are placed, shown and hidden as one. */
typedef struct masu_model {
    uint32_t id;
} masu_model;

typedef struct masu_instance_state {
    float rows[12];             /* as of masu_instance_set_transform */
    float box_low[3], box_high[3]; /* around it, world, metres: of its mesh's box, turned and a little wider */
    uint32_t index;             /* of masu_instance_at */
    uint32_t mesh;
    uint32_t shown;             /* 0: hidden */
    masu_model model;           /* that it is a node of; id 0: none */
} masu_instance_state;

/* Where an instance is and whether it is shown, as the next masu_frame will draw it. MASU_ERROR_ARGUMENT: a
 * NULL pointer, or a handle that is not of this renderer. */
MASU_API MASU_MUST_USE masu_result masu_instance_get(masu_renderer *renderer, masu_instance instance,
                                                     masu_instance_state *out);

/* Hides an instance from the next masu_frame on, or shows it again where it is by now: in the picture,
 * shadows, reflections; a hidden one's lights are off. Cascades that are not drawn in every frame keep its
 * shadow until they are. What is shown again has not moved in its first frame. Light probes, which are
 * baked, know nothing of it. MASU_ERROR_ARGUMENT: a handle that is not of this renderer. */
MASU_API MASU_MUST_USE masu_result masu_instance_show(masu_renderer *renderer, masu_instance instance,
                                                      uint32_t shown);

/* The first model of that name, the name of its description; id 0 if there is none. */
MASU_API masu_model masu_model_find(const masu_renderer *renderer, const char *name);

/* The index-th model of the scene, in the order of masu_scene_model_name; behind those, the places of desc.reserve. id 0
 * beyond the last, and of a place that is free. */
MASU_API masu_model masu_model_at(const masu_renderer *renderer, uint32_t index);

typedef struct masu_model_state {
    /* The 3x4 matrix from the model's own space to the world, row by row. The model's own space is that of
     * its description without "translate": its scale, rotation and fit lie in its nodes. At first it is
     * that translation alone. */
    float rows[12];
    float box_low[3], box_high[3]; /* around all of its instances, world, metres */
    uint32_t index;                /* of masu_model_at */
    uint32_t shown;                /* 0: hidden */
    uint32_t nodes;                /* 0 .. nodes - 1, each behind the one above it */
} masu_model_state;

/* As of masu_instance_get. */
MASU_API MASU_MUST_USE masu_result masu_model_get(masu_renderer *renderer, masu_model model,
                                                  masu_model_state *out);

/* Moves a model, and with it each of its nodes, from the next masu_frame on. `rows` as in masu_model_state.
 * An instance of it that was moved by itself goes back to its node. MASU_ERROR_ARGUMENT: a NULL pointer, a
 * handle that is not of this renderer, a value that is not finite or that takes a node beyond what a float
 * holds; nothing is changed then. */
MASU_API MASU_MUST_USE masu_result masu_model_set_transform(masu_renderer *renderer, masu_model model,
                                                            const float rows[12]);

/* As masu_instance_show, of all of its instances. */
MASU_API MASU_MUST_USE masu_result masu_model_show(masu_renderer *renderer, masu_model model,
                                                   uint32_t shown);

/* One more of the kind of `like`, at `rows`, from the next masu_frame on, and its handle: a hidden one of the same kind
 * that the scene has, a spare one, say; where all of these are shown, a copy in a place of desc.reserve.models. The copy
 * has no name, and its nodes are as those of `like` are now; lights that `like` carries are copied too, of
 * desc.reserve.lights. Nothing is allocated. It had been nowhere before: it has not moved in its first frame.
 * MASU_ERROR_LIMIT: all are shown, and the reserve has no place left, or `like` has skins, of which there are no copies;
 * or reserve.lights are too few. MASU_ERROR_ARGUMENT: as masu_model_set_transform. Nothing is changed then. */
MASU_API MASU_MUST_USE masu_result masu_model_add(masu_renderer *renderer, masu_model like,
                                                  const float rows[12], masu_model *out);

/* A copy goes, and its place is free: its handle, those of its instances, and of lights of the reserve that these
 * carry, are refused from then on; lights of the scene that they carry are put out and carried no more. A model of the
 * scene is hidden, as masu_model_show(.., 0) does it: its handle stays. MASU_ERROR_ARGUMENT: a handle that is not of
 * this renderer, or of what was removed. */
MASU_API MASU_MUST_USE masu_result masu_model_remove(masu_renderer *renderer, masu_model model);

#define MASU_NODE_NONE UINT32_MAX

/* The first node of a model of that name, the name in its file; MASU_NODE_NONE if there is none. */
MASU_API uint32_t masu_model_node_find(const masu_renderer *renderer, masu_model model,
                                       const char *name);

typedef struct masu_node_state {
    float rows[12];  /* the 3x4 matrix to the node above it, of the topmost ones to the model */
    float world[12]; /* and to the world */
    uint32_t parent; /* the node above it, or MASU_NODE_NONE */
    masu_instance instance; /* that it shows; id 0: none */
} masu_node_state;

/* As masu_model_get, of one node. MASU_ERROR_ARGUMENT: there is no such node, too. */
MASU_API MASU_MUST_USE masu_result masu_model_node_get(masu_renderer *renderer, masu_model model,
                                                       uint32_t node, masu_node_state *out);

/* Moves a node in its model, and with it all below it: doors, wheels, turrets. Errors as
 * masu_model_set_transform. */
MASU_API MASU_MUST_USE masu_result masu_model_node_set(masu_renderer *renderer, masu_model model,
                                                       uint32_t node, const float rows[12]);

/* Clips: the animations of a model's file, which masu-bake keeps of models that move. Those of one model are
 * 0 .. count - 1, the same for all of its kind. */
#define MASU_CLIP_NONE UINT32_MAX
#define MASU_MAX_CLIP_USES 16u

typedef struct masu_clip_use {
    uint32_t clip;
    uint32_t loop; /* 1: it begins again after its end; 0: its ends hold */
    double time;   /* seconds from its start, finite */
    float weight;  /* share of all that are used at once: 0 or more, any sum */
} masu_clip_use;

/* How many a model has; 0 for a handle that is not of this renderer. */
MASU_API uint32_t masu_model_clips(const masu_renderer *renderer, masu_model model);

/* The first of that name, the name in its file; MASU_CLIP_NONE if there is none. */
MASU_API uint32_t masu_model_clip_find(const masu_renderer *renderer, masu_model model,
                                       const char *name);

/* Seconds from start to end; 0 of what does not exist. */
MASU_API double masu_model_clip_duration(const masu_renderer *renderer, masu_model model,
                                         uint32_t clip);

/* Poses a model from the next masu_frame on: puts all nodes that any of its clips moves where these clips have
 * them, blended by their weights; with count 0 or no weight at all, where the file has them at rest. Nodes that no
 * clip moves stay. Skinned meshes follow their nodes: in the picture, shadows, velocities and traced reflections,
 * whose histories know where an instance was but not how it has bent. What has skins is traced without ray queries
 * of the device: with MASU_ON masu_init fails.
 * Time is the host's to keep: nothing goes on by itself.
 * MASU_ERROR_ARGUMENT: a NULL pointer with a count, more than MASU_MAX_CLIP_USES, a clip that the model does not
 * have, a time or weight that is not finite or a weight below 0, a pose that takes a node beyond what a float
 * holds, or a handle that is not of this renderer; nothing is changed then. */
MASU_API MASU_MUST_USE masu_result masu_model_animate(masu_renderer *renderer, masu_model model,
                                                      const masu_clip_use *uses, uint32_t count);

/* Handle of a punctual light, a point or a spot. */
typedef struct masu_punctual_light {
    uint32_t id;
} masu_punctual_light;

typedef struct masu_punctual_light_state {
    double position[3];  /* world, or object space of the instance; within 1e15 */
    float direction[3];  /* of a spot: where it shines, in the same space; need not be unit length */
    float color[3];      /* radiant intensity / pi, 0..1e9; 0: it is off. A white matt surface that faces
                            it at d metres has the radiance color / d^2, less towards the range */
    float range;         /* metres, 0..1e15: nothing of it arrives beyond */
    float radius;        /* of the source, 1e-6..1e9 metres: what is nearer is lit as if it were this far */
    uint32_t spot;       /* 0: a point, 1: a spot */
    float inner, outer;  /* of a spot, radians from its direction: all of the light up to inner, none
                            from outer on; 0 <= inner <= outer <= pi */
    masu_instance instance; /* that carries it; id 0: none */
} masu_punctual_light_state;

/* The first light of that name in the scene; id 0 if there is none. */
MASU_API masu_punctual_light masu_punctual_light_find(const masu_renderer *renderer, const char *name);

/* The index-th light of the scene, in the order of masu_scene_light_name; behind those, desc.reserve.lights. id 0 beyond
 * the last, and of one that is not taken. */
MASU_API masu_punctual_light masu_punctual_light_at(const masu_renderer *renderer, uint32_t index);

/* What it is set to: at first, what the scene says. MASU_ERROR_ARGUMENT: a NULL pointer, or a handle
 * that is not of this renderer. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_get(masu_renderer *renderer,
                                                        masu_punctual_light light,
                                                        masu_punctual_light_state *out);

/* Moves, recolours or switches a light from the next masu_frame on. MASU_ERROR_ARGUMENT: a handle that
 * is not of this renderer, or a value that is out of range or not finite: nothing is changed then. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_set(masu_renderer *renderer,
                                                        masu_punctual_light light,
                                                        const masu_punctual_light_state *state);

/* One more light, of desc.reserve.lights, from the next masu_frame on. MASU_ERROR_LIMIT: all of these are taken.
 * MASU_ERROR_ARGUMENT: as masu_punctual_light_set. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_add(masu_renderer *renderer,
                                                           const masu_punctual_light_state *state,
                                                           masu_punctual_light *out);

/* A light that was added goes: its handle is refused from then on. MASU_ERROR_ARGUMENT: a handle that is not of this
 * renderer or of what was removed, or of a light that the scene has: a colour of 0 puts that out. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_remove(masu_renderer *renderer,
                                                              masu_punctual_light light);

/* Handle of a material. Without desc.live_materials there are none. */
typedef struct masu_material {
    uint32_t id;
} masu_material;

typedef enum masu_material_mode {
    MASU_MATERIAL_OPAQUE = 0,
    MASU_MATERIAL_MASKED = 1,  /* where the alpha of its map is below `cutoff`, it is not there */
    MASU_MATERIAL_BLENDED = 2,
    MASU_MATERIAL_ADDITIVE = 3 /* blended: adds its light, hides nothing */
} masu_material_mode;

/* Its factors. Of what it has a map for, the map is times it. */
typedef struct masu_material_state {
    float base_color[3]; /* linear, 0..1 */
    float opacity;       /* 0..1, of blended ones; of others 1 */
    float emissive[3];   /* linear radiance, 0..1e9 */
    float roughness;     /* perceptual, 0..1 */
    float metallic;      /* 0..1 */
    float specular;      /* 0..1: reflectance of a dielectric at normal incidence / 0.08; plain: 0.5 */
    float coat;          /* 0..1: how much of a clear coat lies on it */
    float coat_roughness; /* perceptual, 0..1 */
    masu_material_mode mode; /* told, not changed; */
    float cutoff;            /* the same */
} masu_material_state;

/* The first material of that name in the scene; id 0 if there is none. */
MASU_API masu_material masu_material_find(const masu_renderer *renderer, const char *name);

/* The index-th material of the scene, in the order of masu_scene_material_name; id 0 beyond the last. */
MASU_API masu_material masu_material_at(const masu_renderer *renderer, uint32_t index);

/* What it is set to: at first, what the scene says. MASU_ERROR_ARGUMENT: a NULL pointer, or a handle that is not of
 * this renderer. MASU_ERROR_STATE: desc.live_materials is 0. */
MASU_API MASU_MUST_USE masu_result masu_material_get(masu_renderer *renderer, masu_material material,
                                                     masu_material_state *out);

/* Changes what it looks like from the next masu_frame on, wherever it is: in the picture, what is blended, traced
 * reflections, whose histories fade over some frames. Light probes, which are baked, know nothing of it, nor does the
 * choice of rungs that trace: it goes by what the scene had. MASU_ERROR_ARGUMENT: as masu_material_get, a value out of
 * range or not finite, or one that would change a pass, an image or a pipeline, by name: mode; cutoff; opacity of what
 * is not blended; specular and coat where nothing opaque in the scene has either, nor a small relief or an occlusion
 * map, coat where no material has one. Nothing is changed then. MASU_ERROR_STATE: desc.live_materials is 0. */
MASU_API MASU_MUST_USE masu_result masu_material_set(masu_renderer *renderer, masu_material material,
                                                     const masu_material_state *state);

/* ---- Plan ------------------------------------------------------------------------------------ */

typedef struct masu_plan_pass {
    const char *name; /* also the shader's file name, the debug label and the timestamp's name */
    uint32_t active;  /* bit r: runs in rung r; 0: left out */
    const char *why;  /* why it is in or was left out */
    const char *reads[12];
    const char *writes[6];
    uint64_t pipeline_ns; /* time to build its pipeline in masu_init; 0 without a clock or before
                             masu_init */
} masu_plan_pass;

typedef struct masu_plan_image {
    const char *name;
    VkFormat format;
    uint32_t width, height; /* as allocated: the largest rung */
    uint32_t used;          /* 0: this plan does not need it */
    uint64_t bytes, offset; /* in the device role */
    uint32_t first_pass, last_pass;
    uint32_t layers; /* 2: a frame writes one, and reads what the frame before has left in the other */
} masu_plan_image;

typedef struct masu_plan_rung {
    uint32_t render_width, render_height;
    uint32_t dispatches; /* per frame; a graphics or transfer pass counts as one */
    uint32_t barriers;   /* per frame; 0 from masu_plan: they are counted while recording */
    /* As given in governor.costs and flips, or by the measured ladder; 0: unknown. */
    float ratio, flip; /* time beside other rungs; error */
} masu_plan_rung;

typedef struct masu_plan_info {
    uint32_t pass_count, image_count, rung_count;
    masu_plan_pass passes[MASU_MAX_PASSES]; /* every row of the frame table, in order */
    masu_plan_image images[MASU_MAX_RESOURCES];
    masu_plan_rung rungs[MASU_MAX_RUNGS];
    /* The class of GPUs, by vendor and device id, whose instructions the ratios of the built-in ladder were computed
     * of: "Xe80", "UHD620", "Vega8", "Deck", "low mobile". "": they were measured on a CPU, or are the host's. */
    const char *computed_for;
    masu_memory memory;
    uint64_t left_out_bytes; /* image bytes that leaving passes out has saved at this size */
} masu_plan_info;

/* The compiled frame of a description, without creating a renderer. Errors as masu_memory_query. */
MASU_API MASU_MUST_USE masu_result masu_plan(const masu_desc *desc, masu_plan_info *out,
                                             masu_detail *detail);

/* The same of a live renderer, with pipeline build times. */
MASU_API void masu_plan_of(const masu_renderer *renderer, masu_plan_info *out);

/* ---- Looking at frames ----------------------------------------------------------------------- */

/* One view: what culling did, and what it left. */
typedef struct masu_view_stats {
    uint64_t groups;      /* looked at */
    uint64_t plane_tests; /* of groups and of instances, a plane each */
    uint64_t instances, draws, triangles; /* kept */
    uint64_t occluders;                   /* drawn */
    /* With debug.counters, where occlusion was on: */
    uint64_t visible_instances, visible_triangles; /* not hidden by occluders */
} masu_view_stats;

typedef struct masu_stats_info {
    uint64_t frame; /* the newest finished frame that is known; UINT64_MAX: none yet */
    uint32_t rung;
    uint32_t pass_count;
    const char *pass_names[MASU_MAX_PASSES];
    uint64_t pass_ns[MASU_MAX_PASSES]; /* with debug.timestamps; passes that did not run have 0 */
    uint64_t gpu_ns; /* first to last timestamp; with debug.timestamps or a governor */
    uint32_t timed;                    /* 1: the times above were read */
    uint64_t sdf_evals;       /* of the field by the march; with debug.counters, as the next six */
    uint64_t sdf_hits;        /* pixels whose nearest surface is the SDF */
    uint64_t sdf_unconverged; /* rays that used up their steps */
    uint64_t shadow_evals, occlusion_evals; /* of the field by SDF shadows, SDF ambient occlusion */
    uint64_t shadow_unconverged;            /* shadow rays that used up their steps */
    uint64_t replaced; /* pixel components that were not finite and were replaced; should be 0 */
    uint64_t draws; /* submitted to the G-buffer, but those of no instance; before occlusion */
    uint64_t triangles; /* the same; with debug.counters after occlusion */
    uint64_t transparents; /* blended primitives drawn, each with a draw of its own */
    uint32_t particles, decals, lines; /* drawn: in view, as far as that is looked at, and not left out */
    uint64_t occlusion_tests; /* with debug.counters */
    uint32_t lights, lights_in_view; /* local ones of the scene; those that may light something seen */
    /* With debug.counters: pairs of a light and a pixel that were looked at, those of them where
     * something arrives; tiles of 16x16 that more than 63 lights reach: they look at all. */
    uint64_t light_tests, light_shaded, light_tiles_full;
    /* The same of traced reflections: 8x8 texels that have any, rays, those that meet a polygon or the
     * SDF first, nodes of trees visited, evaluations of the field. */
    uint64_t specular_tiles, specular_rays, specular_hits, specular_sdf_hits;
    uint64_t specular_nodes, specular_evals;
    /* The same of rungs[].easu FAST: blocks of 8x8 output pixels that are flat and were not filtered. Of
     * scenes; without one 0. */
    uint64_t easu_tiles_early;
    uint64_t smaa_tiles; /* with debug.counters: 16x16 pixels that SMAA has blended */
    float exposure; /* factor before the tone curve, where it is metered and with debug.counters; else 0 */
    uint32_t view_count;
    masu_view_stats views[MASU_MAX_VIEWS]; /* 0: the camera */
    masu_governor_info governor; /* as of the frame that was handed out last, whatever the slot */
} masu_stats_info;

/* What is known of the slot's last frame. Call when `commands.slot`'s fence has been waited for, before the slot is
 * used again: from masu_frame until then `frame`, `rung` and what the host counts (draws, lights, views) are of the
 * frame that was handed out, and what the GPU writes (times, counters, images) is of no frame in particular.
 * Reads memory, calls no driver, so it cannot look at fences: only where there are timestamps (debug.timestamps,
 * or a governor that takes them) does the library see whether the frame has ended.
 * MASU_ERROR_ARGUMENT: no such slot, or a NULL pointer. MASU_INCOMPLETE: the slot has not been used yet, or
 * there are timestamps and its frame has not ended or was never submitted; of that frame `frame` and `rung`
 * alone are filled in. */
MASU_API masu_result masu_stats(const masu_renderer *renderer, uint32_t slot, masu_stats_info *out);

/* How much of each thing the renderer holds: to be pasted into masu_limits. */
MASU_API void masu_peaks(const masu_renderer *renderer, masu_peak_info *out);

typedef struct masu_readback_image {
    const void *pixels; /* valid until the slot is used again */
    uint32_t width, height;
    uint64_t row_bytes;
    VkFormat format;
} masu_readback_image;

/* One image of the slot's last frame, asked for by desc.readback. Call as masu_stats.
 * MASU_ERROR_ARGUMENT: not asked for, no such slot, or a NULL pointer. MASU_INCOMPLETE: as masu_stats. */
MASU_API masu_result masu_readback(const masu_renderer *renderer, uint32_t slot,
                                   masu_readback_bits which, masu_readback_image *out);

/* What a pixel shows. */
typedef enum masu_pick_what {
    MASU_PICK_NOTHING = 0, /* the frame has not asked */
    MASU_PICK_SKY = 1,
    MASU_PICK_SDF = 2,
    MASU_PICK_INSTANCE = 3
} masu_pick_what;

typedef struct masu_pick_info {
    masu_pick_what what;
    uint64_t frame; /* whose pixel it is */
    uint32_t x, y;  /* as it has asked */
    /* MASU_PICK_INSTANCE: which, by the handle that it keeps wherever it is moved to; id 0, rarely: a polygon thinner than what
     * rasterisation tells apart. And the moving model that it is a node of, and which: id 0 and MASU_NODE_NONE of
     * others. */
    masu_instance instance;
    masu_model model;
    uint32_t node;
    float depth;        /* near_distance / view depth, as MASU_READBACK_DEPTH has it but of what is blended; the sky: 0 */
    double position[3]; /* of that point, world, metres; the sky: 0 */
} masu_pick_info;

/* What the pixel shows that the slot's last frame has asked for. Instances are told apart where the G-buffer tells
 * them apart: through the holes of an alpha-tested material (with rung.temporal, of what moves within a pixel), in the
 * LOD that is drawn, as joints have bent it. What is blended is picked before what is behind it, be it ever so clear;
 * where it has textures, where the alpha of its base colour is 0.5 or more. At rungs of another scale it is the render pixel in which the middle of the output's lies,
 * and with temporal or camera.jitter where that looked. Call as masu_stats. MASU_ERROR_ARGUMENT: without desc.picking, no such slot, or a NULL pointer.
 * MASU_INCOMPLETE: as masu_stats. */
MASU_API masu_result masu_pick(const masu_renderer *renderer, uint32_t slot, masu_pick_info *out);

/* Unpacks one texel of MASU_READBACK_NORMAL to a unit vector in world space. */
MASU_API void masu_unpack_normal(uint32_t texel, float out[3]);

#ifdef __cplusplus
}
#endif

#endif
