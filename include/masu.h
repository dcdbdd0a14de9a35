/* masu.h: the public interface of Masu and its reference manual. It includes masu_knobs.h (quality
 * settings and scene limits) and masu_study.h (settings for studies, which a port does not need).
 * To start, read "Terms", "Life cycle" and examples/minimal.c. The declarations follow in the order
 * in which a port needs them: life cycle, description, frame, live scene, queries.
 *
 * Masu renders baked scenes of polygons and signed distance fields (SDFs) within a fixed amount of
 * memory, whose size is available before the first frame. The host owns the Vulkan device, the
 * queue, the window and the frame loop.
 *
 * MASU DOES NOT
 *  - submit, wait for the GPU, present, start threads, open files, print, or keep global state;
 *  - stream geometry: it is in the blob, or the host's own (masu_mesh_create). At run time a host
 *    may add meshes, copies of movable models without skins, punctual lights, textures, particles,
 *    trails, decals and debug lines, each up to desc.reserve;
 *  - cast shadows from particles, trails or transparent surfaces;
 *  - refract light beyond a bent lookup of the lit image, order intersecting transparent
 *    surfaces, or reflect particles, trails and decals;
 *  - verify that the SPIR-V of a scene with an SDF is harmless: trust such a blob like a program.
 *
 * TERMS
 *    blob        a scene as baked by masu-bake, one block of bytes (docs/blob.md)
 *    rung        a quality level (masu_rung); its settings are knobs (masu_knobs.h)
 *    ladder      the rungs of a renderer, from the best to the fastest
 *    governor    selects the rung of each frame by the times of previous frames
 *    slot        the data of one frame in flight; a fence of the host protects its reuse
 *    cut         a frame that is unrelated to the previous one (masu_frame_desc.cut)
 *    view z      distance from the camera along its forward direction, above 0 (view depth)
 *    AUTO        the value 0 of a setting: the library selects
 *
 * LIFE CYCLE
 *
 *     masu_scene scene;                                   // 1. validate a baked scene
 *     masu_scene_bind(blob, blob_bytes, &scene, &detail); //    (skip for upscaling only)
 *     masu_desc desc = {MASU_DESC, .vulkan = {...}, .scene = &scene, .output = {1920, 1080}, ...};
 *     masu_memory need;                                   // 2. query the memory it needs
 *     masu_memory_query(&desc, &need, &detail);
 *     masu_renderer *m;                                   // 3. create all objects in that memory
 *     masu_init(&desc, block, need.host_bytes, &m, &detail);
 *     while (masu_load(m, &commands, &detail) == MASU_INCOMPLETE) // 4. upload the scene
 *         submit_and_wait(commands.buffer);
 *     for (;;) {                                          // 5. render
 *         wait_for_fence_of_frame(n - frames_in_flight);
 *         masu_frame_desc frame = {MASU_FRAME_DESC, .time = time};
 *         masu_frame(m, &frame, &commands, &detail);      //    writes uniforms, picks a recording
 *         submit(commands.buffer, fence);
 *     }
 *     wait_idle(); masu_destroy(m);                       // 6. the host may reuse the memory
 *
 * VULKAN CONTRACT
 *  - Device: Vulkan 1.1, or 1.0 with VK_KHR_storage_buffer_storage_class, VK_KHR_maintenance1 and
 *    VK_KHR_maintenance2 enabled; one queue family with graphics and compute, D32_SFLOAT as depth
 *    attachment and sampled image. No optional feature is required; masu_detail names a missing
 *    required one. These optional features are used if the host has enabled them (masu_vulkan):
 *    textureCompressionBC and samplerAnisotropy for textures, VK_KHR_ray_query for reflections,
 *    shaderFloat16 for upscaling. masu_device_query reports which ones a scene would use, before
 *    the device exists. masu_init logs each of those that the host has not enabled.
 *  - Command buffers: primary, for `queue_family`, recorded in masu_init. Submit each one once per
 *    call that returns it, all to the same queue, in the order returned. Each starts with a full
 *    barrier against the previous frame. With desc.split a frame has several (masu_commands.parts).
 *  - Targets: views of host images of at least the output size. Frames fill the output size from
 *    the upper left corner; the other texels are undefined after each frame.
 *        storage targets   R8G8B8A8_UNORM or R16G16B16A16_SFLOAT, USAGE_STORAGE; written directly
 *        other targets     the formats of masu_targets (a swapchain's, for example),
 *                          USAGE_TRANSFER_DST; written by a blit, sRGB formats by a copy that needs
 *                          one more image
 *    Initial layout: any; the contents are discarded. Final layout: targets.final_layout. The
 *    submit must wait for the image (the swapchain's semaphore) at
 *    VK_PIPELINE_STAGE_ALL_COMMANDS_BIT. Masu makes its writes available to all later commands and,
 *    with readback, to the host.
 *  - A frame that is never submitted (an outdated swapchain) still advances the frame number, and
 *    its slot still has the data of an older frame. With rung.temporal or shadow_refresh above 1
 *    the next frame must then set frame.cut.
 *
 * GUARANTEES
 *  - After masu_init the library calls no heap function and no vkAllocate*, vkCreate* or
 *    vkBegin/EndCommandBuffer. The exception is that masu_resize, and the first frame of each rung
 *    after it (in each slot, target and viewport, whenever that is), record command buffers again.
 *    Allocations of the driver inside vkQueueSubmit are not covered; `masu render --stats` counts
 *    them.
 *  - A failed masu_init has destroyed everything that it created. A failed masu_frame has written
 *    nothing and has not advanced the frame number.
 *  - A renderer must be used by one thread at a time. Different renderers are independent.
 *
 * CHANGES
 *    output size up to desc.output,
 *    other targets, or another number     masu_resize
 *    a larger output, another scene       masu_destroy and masu_init, in the same memory blocks if
 *                                         they are large enough; without a pause: masu_init of a
 *                                         second renderer in other blocks (masu_load)
 *
 * LIFETIMES
 *    blob                     until masu_load (and masu_init_step, if used) has returned MASU_OK
 *    masu_desc, its arrays    during the call; pipeline_cache also during masu_init_step
 *    device, allocator, log, clock, source view, masu_pipelines                 until masu_destroy
 *    target images and views                       until masu_resize or masu_destroy
 *    strings that functions return                 static, or in the blob (masu_scene_name)
 *
 * CONVENTIONS
 *    world        right-handed, +Y up, metres            time     seconds
 *    angles       radians                                colour   linear, unless noted
 *    depth        reversed, infinite far plane: near / view z, 1 at the near plane, 0 at infinity
 *    matrices     row by row, multiply column vectors    pixels   from the upper left corner
 *    zero         every struct may be zero-initialised; a zero member selects the stated default,
 *                 except `bytes` of masu_desc and masu_frame_desc
 *    flags        a uint32_t described as a flag is off at 0 and on at any other value
 *
 * ERRORS
 *    Functions return MASU_OK (0), MASU_INCOMPLETE (> 0: call again) or a negative masu_result.
 *    Each function with such a result takes a masu_detail as its last parameter, which receives the
 *    cause of a failure (NULL: ignored), and sends the cause to desc.log; masu_scene_bind, which
 *    has no description, only fills the detail. NULL for any other pointer is MASU_ERROR_ARGUMENT;
 *    functions without a result then return 0 or do nothing. A call that fails with ARGUMENT, LIMIT
 *    or STATE has changed nothing.
 *
 * VERSIONS
 *    Until 1.0 a minor version may break source and binary compatibility; the soname contains it
 *    (libmasu.so.0.2). masu_desc and masu_frame_desc begin with their size in bytes, set by
 *    MASU_DESC and MASU_FRAME_DESC: a program that was compiled with another header gets
 *    MASU_ERROR_ARGUMENT with both sizes. docs/embedding.md has the rules.
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

/* ---- Version and results --------------------------------------------------------------------- */

#define MASU_VERSION_MAJOR 0
#define MASU_VERSION_MINOR 2
#define MASU_VERSION_PATCH 0
#define MASU_VERSION                                                                               \
    (MASU_VERSION_MAJOR * 1000000u + MASU_VERSION_MINOR * 1000u + MASU_VERSION_PATCH)

/* MASU_VERSION of the linked library. It is compatible with this header if major and minor version
 * are equal: masu_version() / 1000 == MASU_VERSION / 1000. */
MASU_API uint32_t masu_version(void);

/* Values never change once released. */
typedef enum masu_result {
    MASU_OK = 0,                 /* success */
    MASU_INCOMPLETE = 1,         /* not finished: call again */
    MASU_ERROR_ARGUMENT = -1,    /* an argument is missing, out of range or not finite */
    MASU_ERROR_MEMORY = -2,      /* a memory block is missing, misaligned or too small */
    MASU_ERROR_LIMIT = -3,       /* a limit or budget of the description is exceeded */
    MASU_ERROR_DEVICE = -4,      /* the device lacks a required feature */
    MASU_ERROR_SCENE = -5,       /* the scene blob is corrupt */
    MASU_ERROR_VERSION = -6,     /* the scene blob has another format version: bake it again */
    MASU_ERROR_VULKAN = -7,      /* a Vulkan call failed */
    MASU_ERROR_DEVICE_LOST = -8, /* the Vulkan device was lost */
    MASU_ERROR_STATE = -9,       /* called out of order */
    MASU_RESULT_FORCE_32 = 0x7FFFFFFF
} masu_result;

/* The meaning of a code, without a newline. Never NULL; "unknown result" for other values. */
MASU_API const char *masu_result_string(masu_result result);

/* The cause of a failure. A successful call leaves it untouched. */
typedef struct masu_detail {
    masu_result result;
    VkResult vulkan;  /* of the failed Vulkan call, else VK_SUCCESS */
    const char *what; /* static: a member of masu_desc, a section of the blob, a Vulkan function */
    uint64_t needed; /* the value that the call needs and the value (or limit) that was given; */
    uint64_t given;  /* both 0 if they do not apply */
    char text[200]; /* the complete message, one line: what, limit, needed, given */
} masu_detail;

typedef enum masu_log_level {
    MASU_LOG_ERROR = 0,
    MASU_LOG_WARNING = 1,
    MASU_LOG_INFO = 2
} masu_log_level;

/* Called from masu_* functions on the caller's thread. `text`: one line without a newline, valid
 * during the call. */
typedef void (*masu_log_fn)(void *user, masu_log_level level, const char *text);

/* ---- Life cycle ------------------------------------------------------------------------------ */

typedef struct masu_scene masu_scene;           /* 1. a validated scene */
typedef struct masu_desc masu_desc;             /* 2. everything that masu_init needs */
typedef struct masu_device_info masu_device_info; /*  the device features that it would use */
typedef struct masu_memory masu_memory;         /*    the memory that it would need */
typedef struct masu_renderer masu_renderer;     /* 3. stored in the caller's block */
typedef struct masu_commands masu_commands;     /* 4. the command buffers to submit */
typedef struct masu_frame_desc masu_frame_desc; /* 5. one frame */
typedef struct masu_targets masu_targets;       /*    the images that frames are written to */
typedef struct masu_viewport masu_viewport;

/* Validates every offset, count, index and float of `blob` and its hash, and fills `*out`. Takes
 * time proportional to its size; allocates and keeps nothing. `blob`: 16-byte aligned, readable and
 * unchanged until masu_load has returned MASU_OK for the last renderer that is made from it.
 *
 * A blob with an SDF contains SPIR-V, which the driver compiles and runs. The function checks that
 * the SPIR-V is complete, requires no resource that Masu does not bind, and was compiled for the
 * counts of this blob. It cannot check that the SPIR-V is harmless: use blobs of your own build, or
 * verify a signature first (docs/blob.md, Trust).
 *   MASU_ERROR_ARGUMENT   `blob` or `out` is NULL, or `blob` is misaligned
 *   MASU_ERROR_VERSION    the blob has another format version
 *   MASU_ERROR_SCENE      the blob is corrupt; the detail names section and element */
MASU_API MASU_MUST_USE masu_result masu_scene_bind(const void *blob, uint64_t blob_bytes,
                                                   masu_scene *out, masu_detail *detail);

/* Reports which optional features of a physical device masu_init would use, before the device
 * exists. The host enables the features and extensions of `used`, creates the device, and sets the
 * flags of masu_vulkan. Creates no object, and checks the required features and limits that
 * masu_init checks. Does not plan memory.
 *
 * Reads vulkan.get_instance_proc_addr, .instance, .physical_device and .queue_family. With a scene
 * it reads the rest of `desc`, except the handles of targets, and evaluates the scene as masu_init
 * does; targets.count may be 0. Without a scene `used` has every supported feature except those of
 * ray_query and half_floats at OFF, for a host that loads its scenes later.
 *   MASU_ERROR_DEVICE   the device lacks a required feature, or one that `desc` sets to MASU_ON:
 *                       the detail has its name, the required and the given value
 * Other errors as masu_init. On failure `*out` is unchanged. */
MASU_API MASU_MUST_USE masu_result masu_device_query(const masu_desc *desc, masu_device_info *out,
                                                     masu_detail *detail);

/* Memory that masu_init would need for `desc`, by the same code. Creates no lasting object. Like
 * masu_plan and masu_init, it reads the scene's blob, which must still be readable. Errors as
 * masu_init, except MASU_ERROR_MEMORY for the host block. */
MASU_API MASU_MUST_USE masu_result masu_memory_query(const masu_desc *desc, masu_memory *out,
                                                     masu_detail *detail);

/* Creates a renderer: plans memory, allocates device memory that the host has not provided, and
 * creates all images, buffers, pipelines and descriptor sets. It records one command buffer per
 * combination of frame in flight, rung, target and viewport; each cascade with
 * rungs[].shadow_refresh above 1 doubles the number for its rung.
 *
 * `block`: `block_bytes` of memory with any content, aligned to masu_memory.host_alignment. It
 * belongs to the renderer until masu_destroy; nothing outside is written. On failure *out is NULL
 * and every object has been destroyed.
 *   MASU_ERROR_ARGUMENT      a member of `desc` is invalid, `bytes` for example; the detail names
 *                            it
 *   MASU_ERROR_MEMORY        `block` or a device block is NULL, misaligned or too small; the detail
 *                            has the bytes needed and given
 *   MASU_ERROR_LIMIT         a limit or budget is exceeded
 *   MASU_ERROR_DEVICE        the device lacks a required feature; the detail names it
 *   MASU_ERROR_SCENE         the scene cannot be rendered with `desc`; the detail has the cause
 *   MASU_ERROR_VULKAN, _DEVICE_LOST   a Vulkan call failed; the detail has its name and VkResult */
MASU_API MASU_MUST_USE masu_result masu_init(const masu_desc *desc, void *block,
                                             uint64_t block_bytes, masu_renderer **out,
                                             masu_detail *detail);

typedef struct masu_progress {
    uint32_t done, total; /* steps */
    uint32_t rungs;       /* bit n: frames may use rung n */
} masu_progress;

/* With desc.init_in_steps: creates the pipelines of one pass, or records the frames of one rung,
 * for a loading bar without a thread. The time of a step is that of its pipelines in the driver.
 * Calls of masu_load may come before, between or after. Once a rung is in progress->rungs, and
 * masu_load has finished, masu_frame renders in it while the steps go on; MASU_RUNG_AUTO uses those
 * rungs only. To cancel, call masu_destroy. Blob and vulkan.pipeline_cache must be valid until
 * MASU_OK. `progress` may be NULL; an error sets it too.
 *   MASU_INCOMPLETE   call again
 *   MASU_OK           all rungs are ready; without init_in_steps at the first call
 *   MASU_ERROR_VULKAN, _DEVICE_LOST   only masu_destroy is of use */
MASU_API MASU_MUST_USE masu_result masu_init_step(masu_renderer *renderer, masu_progress *progress,
                                                  masu_detail *detail);

/* Copies the scene to the device.
 *   MASU_INCOMPLETE   submit commands->buffer, wait for it, call again
 *   MASU_OK           finished; there is nothing to submit
 * On unified memory a scene without textures needs no submit, and the first call returns MASU_OK;
 * except with ray query, whose acceleration structures the device builds. Without a scene only the
 * lookup table of SMAA is copied, if a rung uses it.
 *
 * With desc.load_step one call writes at most that number of bytes, and the device copies those for
 * memory that is not host-visible. Per call it builds acceleration structures for at most load_step
 * / 48 triangles, but always whole meshes. A step that has written to host-visible memory only has
 * nothing to submit: buffer is NULL and part_count is 0. A host can thus load a second scene, in a
 * separate renderer with separate memory blocks, while it shows frames of the first one:
 *
 *     masu_scene_bind(blob, ...); masu_memory_query(&desc, ...);  // slow: read the whole blob and
 *     masu_init(&desc, other_block, ..., &next, &detail);         // create all objects; a host's
 *                                                                 // thread may run them
 *     for (;;) {                                                  // frames
 *         wait_for_fence_of_frame(n - frames_in_flight);
 *         step.part_count = 0;
 *         if (next && fence_of_last_step_has_been_waited_for())
 *             loaded = masu_load(next, &step, &detail) == MASU_OK;
 *         masu_frame(now, &frame, &commands, &detail);
 *         submit(step.parts, then commands.parts, fence);
 *         if (loaded) { old = now; now = next; next = NULL; }     // its first frame is a cut.
 *     }                                                           // After the last fence of `old`:
 *                                                                 // masu_destroy(old)
 *
 * The memory blocks of the old renderer are then free for the next scene: two sets of blocks serve
 * any number of scenes. With vulkan.pipelines the two renderers share pipelines, and masu_init
 * creates only those that are missing in the pool. */
MASU_API MASU_MUST_USE masu_result masu_load(masu_renderer *renderer, masu_commands *commands,
                                             masu_detail *detail);

/* Writes the uniforms of a frame and returns the command buffer to submit. Allocates nothing, and
 * records nothing except after masu_resize. Call it when the slot is free: the frame that
 * masu_frame returned frames_in_flight calls ago has finished on the GPU. commands->rung is the
 * rung of the frame.
 *   MASU_ERROR_ARGUMENT   `bytes` is not sizeof(masu_frame_desc);
 *                         rung, target, camera, light or a parameter is out of range or not finite;
 *                         MASU_RUNG_AUTO without a governor; an array is NULL with a count above 0
 *   MASU_ERROR_LIMIT      more particles, trail points, decals or lines than desc.reserve, or one
 *                         with a texture that does not exist
 *   MASU_ERROR_STATE      masu_load has not finished; the rung is not ready (masu_init_step)
 *   MASU_ERROR_VULKAN, _DEVICE_LOST   as masu_resize, after it
 * After an error nothing has been written, and the frame number has not advanced. */
MASU_API MASU_MUST_USE masu_result masu_frame(masu_renderer *renderer, const masu_frame_desc *frame,
                                              masu_commands *commands, masu_detail *detail);

/* Changes the output size and the targets, also their number. Creates no pipeline, allocates and
 * loads nothing, and does not read the blob. Requires desc.resizable; allowed before, between and
 * after the calls of masu_load. The frames of this renderer must have finished on the GPU; its own
 * masu_load steps, frames and loads of other renderers may be running.
 *   `output`      1 x 1 to desc.output
 *   `targets`     1 to MASU_MAX_TARGETS images with the format, storage, layout, encoding, white
 *                 and peak of masu_init; all but storage may be 0 for these. The arrays are read
 *                 during the call; the handles must be valid until the next masu_resize or
 *                 masu_destroy
 *   `viewports`   desc.viewport_count elements, or NULL if that is 0
 * The next frame is a cut. Frame numbers, slots, transforms and the governor's state continue.
 *
 * The call records the command buffers of the rung in use. Those of another rung
 * follow in masu_frame: the first frame of that rung in each slot and target records its own.
 *   MASU_ERROR_ARGUMENT   an argument contradicts the rules above
 *   MASU_ERROR_LIMIT      `output` is larger than desc.output: use masu_destroy and masu_init
 *   MASU_ERROR_STATE      desc.resizable is 0, or there is no scene
 *   MASU_ERROR_VULKAN     a Vulkan call failed. The new size and targets apply nevertheless;
 *                         masu_frame records what is missing, or fails likewise
 *   MASU_ERROR_DEVICE_LOST   only masu_destroy is of use: masu_load, masu_resize and masu_frame
 *                         fail likewise from then on */
MASU_API MASU_MUST_USE masu_result masu_resize(masu_renderer *renderer, VkExtent2D output,
                                               const masu_targets *targets,
                                               const masu_viewport *viewports, masu_detail *detail);

/* Destroys every Vulkan object of the renderer and frees the device memory that masu_init
 * allocated. The device must be idle. NULL is allowed. */
MASU_API void masu_destroy(masu_renderer *renderer);

/* ---- Description ----------------------------------------------------------------------------- */

#define MASU_MAX_RUNGS 12u
#define MASU_MAX_PARTS 3u /* of a frame (masu_desc.split) */
#define MASU_MAX_TARGETS 8u
#define MASU_MAX_FLIGHT 3u
#define MASU_MAX_PASSES 128u
#define MASU_MAX_RESOURCES 96u
#define MASU_MAX_SDF_PARAMS 256u
#define MASU_MAX_VIEWS 5u /* the camera and each cascade */
#define MASU_MAX_CASCADES 4u
#define MASU_MAX_REFRESH 64u

/* masu_rung (a quality level), masu_limits and the tables of their members. It includes
 * masu_study.h. */
#include "masu_knobs.h"

/* A validated scene, filled by masu_scene_bind. Copyable; its content is private. A zeroed one is
 * an empty scene for queries, and MASU_ERROR_ARGUMENT as masu_desc.scene. */
typedef struct masu_scene {
    uint64_t opaque[64];
} masu_scene;

#define MASU_MAX_PIPELINES 384u
/* A pool of pipelines that outlive a renderer and that several renderers share. masu_init takes
 * matching pipelines from the pool and adds those that it creates; masu_destroy leaves all in the
 * pool. A further scene or output size then creates only pipelines that are not in the pool. A full
 * pool destroys the pipeline that has been unused by renderers for the longest time; if all of its
 * MASU_MAX_PIPELINES are in use, further ones are destroyed with their renderer.
 *
 * Zero it at first; use it with one device and one build of the library. Its content is private
 * (masu_pipelines_info_of). Renderers with the same pool must not run masu_init or masu_destroy
 * concurrently. The host owns the pool, does not move it, and destroys it with
 * masu_pipelines_destroy. */
typedef struct masu_pipelines {
    uint64_t opaque[1160];
} masu_pipelines;

typedef struct masu_vulkan {
    PFN_vkGetInstanceProcAddr get_instance_proc_addr; /* required */
    VkInstance instance; /* required, created with API version >= 1.1; 1.0 for a 1.0 device */
    VkPhysicalDevice physical_device; /* required */
    VkDevice device;                  /* required */
    uint32_t queue_family;            /* graphics and compute */
    /* For every create and allocate call; NULL: the driver's. pfnAllocation, pfnReallocation and
     * pfnFree are required; of the two internal callbacks, set both or none. */
    const VkAllocationCallbacks *allocator;
    VkPipelineCache pipeline_cache; /* used in masu_init; VK_NULL_HANDLE: none */
    /* Features that the host has enabled on the device. Vulkan has no query for them. */
    uint32_t texture_compression_bc; /* flag: textureCompressionBC. Textures remain compressed, at
                                        1/4 to 1/8 of the memory */
    float max_anisotropy; /* samplerAnisotropy: largest number of samples, 1..64, clamped to
                             maxSamplerAnisotropy; 0: not enabled */
    uint32_t ray_query;   /* flag: VK_KHR_ray_query, VK_KHR_acceleration_structure and buffer device
                             addresses (extension or Vulkan 1.2), each with its feature */
    uint32_t shader_float16; /* flag: shaderFloat16 of VK_KHR_shader_float16_int8 (or Vulkan 1.2) */
    masu_pipelines *pipelines; /* valid until masu_destroy; NULL: no pool, masu_destroy destroys the
                                  pipelines */
} masu_vulkan;

/* Optional features of a device (masu_device_query). */
typedef enum masu_feature_bits {
    MASU_FEATURE_TEXTURE_COMPRESSION_BC = 1, /* VkPhysicalDeviceFeatures.textureCompressionBC */
    MASU_FEATURE_SAMPLER_ANISOTROPY = 2,     /* VkPhysicalDeviceFeatures.samplerAnisotropy */
    /* rayQuery of VkPhysicalDeviceRayQueryFeaturesKHR, accelerationStructure of
     * VkPhysicalDeviceAccelerationStructureFeaturesKHR and bufferDeviceAddress of
     * VkPhysicalDeviceBufferDeviceAddressFeatures */
    MASU_FEATURE_RAY_QUERY = 4,
    MASU_FEATURE_SHADER_FLOAT16 = 8 /* shaderFloat16 of VkPhysicalDeviceShaderFloat16Int8Features */
} masu_feature_bits;

#define MASU_MAX_EXTENSIONS 11u
typedef struct masu_device_info {
    uint32_t supported;       /* MASU_FEATURE_* that the device offers with their extensions */
    uint32_t used;            /* those of `supported` that masu_init would use if enabled */
    float max_anisotropy;     /* maxSamplerAnisotropy; 0 if samplerAnisotropy is not supported */
    uint32_t extension_count; /* device extensions to enable for `used`, and those that Vulkan 1.0
                                 needs, by static names: */
    const char *extensions[MASU_MAX_EXTENSIONS];
} masu_device_info;

/* Encoding of the target. White is the colour of a radiance of 1 / exposure without a tone
 * curve. */
typedef enum masu_encoding {
    MASU_ENCODING_AUTO = 0,   /* SRGB; LINEAR for floating-point targets */
    MASU_ENCODING_SRGB = 1,   /* IEC 61966-2-1: 0..1, 1 is white. Any format */
    MASU_ENCODING_LINEAR = 2, /* scRGB: linear, sRGB primaries, 1 is 80 nits, unbounded.
                                 VK_FORMAT_R16G16B16A16_SFLOAT */
    MASU_ENCODING_PQ = 3      /* HDR10: BT.2020 primaries, ST 2084. Formats of 10 or 16 bits */
} masu_encoding;

typedef struct masu_targets {
    const VkImage *images;    /* `count` images of at least the output size */
    const VkImageView *views; /* one per image; required for storage targets, else may be NULL */
    uint32_t count;           /* 1..8 */
    /* 8 bits: R8G8B8A8, B8G8R8A8, A8B8G8R8, each UNORM or SRGB (same bytes). 10 bits: A2B10G10R10,
     * A2R10G10B10. 5 and 6 bits: R5G6B5, B5G6R5. 16 bits: R16G16B16A16, UNORM or SFLOAT.
     * 0: VK_FORMAT_R8G8B8A8_UNORM. Without a scene: UNORM only. */
    VkFormat format;
    uint32_t storage; /* flag: written directly as storage images; 0: filled by a blit or copy */
    /* GENERAL, TRANSFER_SRC_OPTIMAL, SHADER_READ_ONLY_OPTIMAL, COLOR_ATTACHMENT_OPTIMAL or
     * PRESENT_SRC_KHR. UNDEFINED (0): TRANSFER_SRC_OPTIMAL. */
    VkImageLayout final_layout;
    masu_encoding encoding; /* scene only */
    /* For LINEAR and PQ, nits, 1..10000: luminance of white, and peak luminance of the display, at
     * least white, which shapes the neutral tone curve. 0: white is 80 (LINEAR) or 203 (PQ,
     * BT.2408); peak is 1000, or white if that is higher. */
    float white, peak;
} masu_targets;

/* Upscaling without a scene: a host image is the input of anti-aliasing (if the rung has it), EASU
 * and RCAS. Sampled values are display-encoded colour, clamped to 0..1; NaN becomes 0. For images
 * in an sRGB format the view must therefore be UNORM: an sRGB view returns linear values, which are
 * filtered and written without encoding. Anti-aliasing reduces the image to 8 bits per channel. */
typedef struct masu_source {
    VkImageView view;       /* VK_NULL_HANDLE: none. Sampled; its layout before and after the frame
                               is VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL */
    uint32_t width, height; /* valid texels from (0,0), 1..16384; the image may be larger, texels
                               outside are not read */
    VkFormat format; /* of the view; 0: unspecified. Stating an 8-bit UNORM format saves a tenth of
                        the work; the result is the same */
} masu_source;

/* A rectangle of the output, in pixels, for views with separate frames: split screen, map,
 * mirror. */
typedef struct masu_viewport {
    uint32_t x, y, width, height;
} masu_viewport;
#define MASU_MAX_VIEWPORTS 4u

#define MASU_MAX_MESH_KINDS 8u
/* A kind of meshes that the host creates at run time (masu_mesh_create): slots of equal size for
 * meshes of one material, because draws are recorded with their material. Costs per slot, whether
 * used or not:
 *    device, per vertex     16 bytes; 8 in scenes with textures, 8 with second texture coordinates,
 *                           4 with vertex colours; 12 if velocities are read
 *    device, per triangle   12 bytes; 70 if rays trace polygons (16, and 54 for its share of nodes)
 *    host and device        an instance, a model with one node, and a draw (masu_limits)
 *    GPU                    three empty dispatches per frame for all kinds together; an empty draw
 *                           per free slot and view; if rays trace polygons, a workgroup per slot */
typedef struct masu_mesh_kind {
    uint32_t meshes;    /* slots, 0..1024 of all kinds together; 0: the kind is unused */
    /* Index of a material of the scene (masu_scene_find with MASU_SCENE_MATERIAL), which must be
     * neither transparent nor have mesoscale detail. Back faces are drawn unless the material is
     * single-sided in the scene description. Scenes contain only the materials that their models
     * use: place a hidden model with one that meshes alone shall have. masu_model_set_look tints a
     * single mesh. */
    uint32_t material;
    uint32_t vertices;  /* capacity of each slot, 3..1048576 */
    uint32_t triangles; /* capacity of each slot, 1..262144 */
} masu_mesh_kind;

/* Capacities for objects that the host adds at run time. masu_memory includes their memory. Models
 * and lights of the reserve count towards limits and peaks like those of the scene. 0: none, at no
 * cost. Without a scene all members are unused; so is `models` if the scene has no movable model
 * without skins. Meshes require a scene with polygons. */
typedef struct masu_reserve {
    /* Slots for copies of movable models, in addition to the pooled copies of the scene
     * (masu_model_add), 0..16384. Any movable model without skins fits into a slot, so each slot
     * has the largest number of nodes, instances, transparent primitives and traced instances of
     * any such model. masu_limits states the cost of each of these; if the scene has occluders, the
     * occluders of the meshes are added, and 8 bytes with desc.picking. All slots together have at
     * most 2^20 items of each kind, for example instances. */
    uint32_t models;
    /* Punctual lights (masu_punctual_light_add), 0..4096; at most 4096 with those of the scene. */
    uint32_t lights;
    /* The largest numbers per frame (masu_frame_desc). Without a scene: 0. */
    uint32_t particles; /* 0..65536; device: 64 bytes each per frame in flight, and 16 for each
                           transparent primitive; host: 16 bytes each */
    uint32_t decals;    /* 0..1024; device: 112 bytes each per frame in flight */
    uint32_t lines;     /* 0..65536; device: 32 bytes each per frame in flight, and 4 for each pixel
                           of the output */
    /* Points of all trails, 0..65536; device: 128 bytes each per frame in flight, and 16 for each
     * transparent primitive; host: 16 bytes each. With trail points or textures a particle takes
     * 128 bytes instead of 64, and a decal 144 instead of 112. */
    uint32_t trail_points;
    /* Textures that the host fills at run time, 0..256 (masu_texture_write). They have one size,
     * 1..4096 texels along each axis, 0: 256, and at most 2^28 texels together. Device: 4 bytes per
     * texel. */
    uint32_t textures;
    VkExtent2D texture_size;
    /* Bytes that masu_texture_write accepts between two frames, 4..2^28; 0: those of one texture.
     * Device: as many and 2064 more, per frame in flight. */
    uint32_t texture_bytes;
    masu_mesh_kind meshes[MASU_MAX_MESH_KINDS];
    /* Bytes of mesh data that one frame uploads: the sum over the calls of masu_mesh_create,
     * _replace and _deform between two frames, at most 1 GiB, and at least the largest mesh that
     * fits into a slot. masu_mesh_bytes has the formula. It also bounds the host's time, which is
     * proportional to the bytes. 0: the largest mesh. A host that creates a mesh of that size must
     * then wait for the next masu_frame before it deforms the mesh; otherwise add 16 bytes per
     * vertex. Costs these bytes on the host, and again per frame in flight on the device, with 64
     * bytes per slot; and 51 host bytes per triangle of the largest slot if rays trace polygons. */
    uint32_t mesh_upload;
} masu_reserve;

/* Roles of device memory. On unified memory one block of role MASU_ROLE_DEVICE serves all. */
typedef enum masu_role {
    MASU_ROLE_DEVICE = 0,   /* resident buffers and transient images */
    MASU_ROLE_UPLOAD = 1,   /* written by the host, read by the GPU: per-frame data, staging */
    MASU_ROLE_READBACK = 2, /* written by the GPU, read by the host: counters, readback images */
    MASU_ROLE_COUNT = 3
} masu_role;

/* A block of device memory that the host provides for a role. If `memory` is VK_NULL_HANDLE,
 * masu_init makes one allocation for the role. The memory type can change the plan (host-visible
 * device memory needs no staging buffer): query again with the blocks set. */
typedef struct masu_device_block {
    VkDeviceMemory memory; /* with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT for roles whose
                              masu_role_need.device_address is 1 */
    VkDeviceSize offset;   /* bytes, a multiple of masu_memory.roles[].alignment */
    VkDeviceSize bytes;
    void *mapped; /* host pointer to `offset`, aligned like it, but at most to 64 bytes; required
                     for roles with host_visible 1 */
    uint32_t memory_type; /* index; one of masu_memory.roles[].type_bits */
} masu_device_block;

/* Images that the host can read after a frame (masu_readback). Each one costs its full size per
 * frame in flight in the readback role. */
typedef enum masu_readback_bits {
    MASU_READBACK_DEPTH = 1, /* float: near / view z of the closest surface, 0: none */
    /* ALBEDO and NORMAL are undefined if the depth is 0. */
    MASU_READBACK_ALBEDO = 2, /* 4 x uint8: sqrt of the linear albedo, roughness. Emissive surfaces:
                                 see shaders/shared/pack.glsl */
    MASU_READBACK_NORMAL =
        4, /* uint32: octahedral 13+13 bits, metallic 4 bits, flags 2 bits (masu_unpack_normal) */
    MASU_READBACK_HDR = 8, /* 4 x half: linear radiance before exposure */
    /* 4 x half: motion of the pixel's surface point since the previous frame.
     *   x, y   previous position minus current position, in pixels of the render size, y down. It
     *          includes the change of jitter, with rung.temporal also that of the rung
     *   z      previous view depth / current view depth - 1; 0 for the sky
     *   w      1; or 0 if the point was behind the camera or its motion is unavailable: x, y, z are
     *          then 0
     * The rounding to halves has a relative error of at most 2^-12. In a rung with temporal and
     * specular_fine, pixels that reflect more light than they scatter, at a roughness of at most
     * 0.17, have the motion of the reflected image if the history of the reflections provides it; z
     * then belongs to the mirror plane at the position of the reflected image. Costs the previous
     * frame's data, one more image, and one or two more passes. */
    MASU_READBACK_VELOCITY = 16,
    /* 2 x 16-bit unorm: visibility of the sun, and of the ambient light. Only for scenes with a
     * shadow map, SDF shadows, or ambient occlusion (of polygons or of the SDF); ignored for other
     * scenes. A rung that uses none of these does not write the image. */
    MASU_READBACK_OCCLUSION = 32,
    /* float: depth along the sun's direction, 1 is closest to the sun, 0 is empty. Cascades are
     * stacked from top to bottom; four form a grid of 2x2, row by row. Only for scenes with a
     * shadow map. Culling omits objects without a visible shadow; with rungs[].frustum and
     * .occlusion MASU_OFF the map is complete. */
    MASU_READBACK_SHADOW_MAP = 64,
    MASU_READBACK_ALL = 127
} masu_readback_bits;

/* Points at which a frame is split, so that host commands can run between its parts. masu_frame
 * then returns several masu_commands.parts, and masu_split_of returns the images available
 * there. */
typedef enum masu_split_bits {
    /* Before exposure and tone curve: HDR (linear radiance before exposure, at the render size) to
     * render into, and depth to test against. All surfaces of the scene are complete, transparent
     * ones included. Later passes meter, tone-map, anti-alias and upscale the host's rendering with
     * the scene. desc.readback images contain the scene only. Requires a scene. */
    MASU_SPLIT_BEFORE_TONE = 1,
    /* After anti-aliasing, upscaling and sharpening, at the output size: before the blit or copy to
     * the target, or after the write of a storage target. Commands after the last part of the frame
     * draw over the target. */
    MASU_SPLIT_AFTER_UPSCALE = 2,
    /* Velocities as in MASU_READBACK_VELOCITY, in every rung, at the same cost. Requires
     * BEFORE_TONE or KEEP. */
    MASU_SPLIT_VELOCITY = 4,
    /* Keeps HDR, depth and, with VELOCITY, velocities until AFTER_UPSCALE, by excluding their
     * memory from reuse. Requires AFTER_UPSCALE. */
    MASU_SPLIT_KEEP = 8,
    MASU_SPLIT_ALL = 15
} masu_split_bits;

/* Tone curve: maps radiance times exposure to the output. ACES ends at white. NEUTRAL ends at
 * white, with LINEAR and PQ at the peak. Scene only. */
typedef enum masu_tone {
    MASU_TONE_AUTO = 0,   /* ACES */
    MASU_TONE_NONE = 1,   /* linear, clipped at white; with LINEAR and PQ at 10000 nits */
    MASU_TONE_ACES = 2,   /* filmic: a fit of the ACES reference rendering (Narkowicz 2016) */
    MASU_TONE_NEUTRAL = 3 /* Khronos PBR Neutral: linear up to 0.76 of the maximum, then desaturates
                             towards white */
} masu_tone;

/* Auto-exposure: exposure = light.exposure * 0.18 / (geometric mean of the image's luminance). The
 * mean excludes the darkest and brightest pixels (`low`, `high`), black pixels and non-finite
 * pixels. It adapts over time by frame.time_step; at once in the first frame and after a cut. With
 * `metered` off the other members are checked, but unused. Scene only. */
typedef struct masu_exposure {
    masu_switch metered; /* OFF: light.exposure only, without a pass or memory. AUTO: the scene's
                            setting */
    /* Adaptation rates, 1/s, up to 1e6: the remaining difference decreases by the factor e in
     * 1 / rate seconds. brighten: rate after the scene has become darker; darken: rate after it has
     * become brighter. 0: the scene's, else 1 and 3, because eyes adapt faster to light. */
    float brighten, darken;
    /* Fractions of the counted pixels to exclude, 0..1, sum less than 1. 0: 0.1 each; below 0:
     * none. */
    float low, high;
    float min, max; /* bounds of the metered factor, 1e-9..1e9; 0: 1/1024 and 1024 */
} masu_exposure;

/* Effects on the image, for masu_desc.post. Each is reserved at initialisation: its passes, images
 * and shader variants exist only then. Frames set its strength in masu_frame_desc.post; at strength
 * 0 a reserved effect changes no bit of the image and its passes end at once. P below is the number
 * of pixels of the largest render size. */
typedef enum masu_post_bits {
    /* Light scattered by the lens: a glow around bright parts. Conserves energy; its width is
     * relative to the image height. 4 passes; 1.2 P bytes of transient images. */
    MASU_POST_BLOOM = 1,
    /* Depth of field. 3 passes; 6.1 P bytes of transient images. */
    MASU_POST_FOCUS = 2,
    /* Vignette, brightness, gamma and a colour table, in the tone curve's pass. */
    MASU_POST_GRADE = 4,
    MASU_POST_ALL = 7
} masu_post_bits;

#define MASU_LUT_MAX 33u /* points per axis of a colour table */

#define MASU_LOAD_STEP_MIN 65536u /* bytes of the longest row of texels */

/* ---- Description: governor ------------------------------------------------------------------- */

typedef enum masu_governor_mode {
    MASU_GOVERNOR_OFF = 0,  /* the host selects the rung of each frame */
    MASU_GOVERNOR_ON = 1,   /* MASU_RUNG_AUTO: a rung that is predicted to meet the target */
    MASU_GOVERNOR_FIXED = 2 /* MASU_RUNG_AUTO: `rung`; frame times are still measured */
} masu_governor_mode;

/* Bits of masu_governor_desc.keep. */
#define MASU_KEEP_REFLECTIONS 1u /* rungs[].specular */
#define MASU_KEEP_OCCLUSION 2u   /* rungs[].ao */
#define MASU_KEEP_ALL 3u

/* Selects rungs by frame time. It assumes that rungs are sorted by falling quality, and selects the
 * lowest number that meets the target. Frame times are from two timestamps per frame, from
 * masu_frame_times or masu_frame_wall, or from both. Use both: the governor then detects incorrect
 * timestamps. A rise is a change to a better rung; it has failed if that rung then misses the
 * target. All zero: no governor, at no cost.
 *
 * Unused, but checked: with mode OFF all other members (masu_plan_info still reports `costs`); with
 * FIXED headroom, best_rung, worst_rung, dwell and steady_clock; with ON `rung`. */
typedef struct masu_governor_desc {
    masu_governor_mode mode;
    float target_ms; /* GPU time of a frame, 1..1000 ms; 0: 16.67 */
    /* Fraction of the target that a better rung must leave free, in addition to a margin for the
     * measured noise, up to 0.5; 0: 0.02; below 0, down to -1: none. */
    float headroom;
    uint32_t best_rung;  /* lowest number to select */
    uint32_t worst_rung; /* highest number to select; 0: the last rung */
    uint32_t rung;       /* for MASU_GOVERNOR_FIXED */
    uint32_t wall_only;  /* flag: no timestamps, as on devices without them */
    /* In frames, 1..600; 0: 24. A better rung is selected only if it is predicted to meet the
     * target for this long, and if the last change was at least this long ago. */
    uint32_t dwell;
    /* Initial estimate of the relative cost of each rung, without the part of the frame time that
     * all rungs have in common, 0..1e6. 0: the cost in the built-in ladder (masu_desc.ladder),
     * computed for the class of the GPU (masu_plan_info.computed_for) if that is known, else
     * the mean of the classes; without a ladder scale^2. */
    float costs[MASU_MAX_RUNGS];
    /* Flag: the GPU's clock does not follow its load. 0: after 1800 steady frames in a rung that
     * takes less than 0.92 of the target, the governor tries a better rung for 12 frames, if it is
     * predicted to take at most 1.25 of the target, to detect whether the clock rises. Each failed
     * trial makes the next one rarer. */
    uint32_t steady_clock;
    /* Features that no rung may disable: MASU_KEEP_*, of any mode. A built-in ladder omits its
     * rungs without one of them; a rung of masu_desc.rungs with that feature OFF is
     * MASU_ERROR_ARGUMENT. A scene or device that does not support a feature still renders without
     * it. */
    uint32_t keep;
} masu_governor_desc;

/* ---- Description: all of it ------------------------------------------------------------------ */

/* Everything that masu_init needs. "Scene only": ignored without a scene, unless noted. */
typedef struct masu_desc {
    uint32_t bytes; /* sizeof(masu_desc), set by MASU_DESC */
    masu_vulkan vulkan;
    const masu_scene *scene; /* NULL: upscaling of `source` only. Read during the call */
    masu_source source;      /* required without a scene; with one it must be all zero */
    VkExtent2D output;       /* pixels, 1..16384 and within the device's maxImageDimension2D */
    masu_targets targets;
    uint32_t frames_in_flight; /* 1..3; 0: 2 */
    /* Quality levels; masu_frame_desc.rung selects one per frame. Sort them by falling quality;
     * only the governor relies on it. */
    uint32_t rung_count; /* 0..12; 0: by `ladder`, and rungs[0] must be all zero */
    masu_rung rungs[MASU_MAX_RUNGS]; /* those from rung_count on are unused */
    /* The rungs if rung_count is 0. ON: up to twelve built-in rungs, measured for the scene's class
     * (masu_ladder_of), with their flips, and with their times for governor.costs of 0. OFF, and
     * without a scene: three rungs of scale 1.0 (no upscaling), 0.8 and 0.4 (EASU, RCAS). AUTO: ON
     * with a governor, else OFF. Unused if rung_count is not 0. */
    masu_switch ladder;
    /* Error of each rung, reported by masu_plan_info: FLIP with stationary and moving camera, 0..1;
     * 0: unknown. Does not affect rendering. Built-in rungs replace them. */
    float flips[MASU_MAX_RUNGS];
    masu_limits limits; /* largest scene to accept. Scene only */
    masu_reserve reserve;
    /* Flag: masu_material_set is available. Costs 60 host bytes per material, 48 device bytes per
     * material and frame in flight, and copying the latter in each frame; with reflections of
     * polygons 84 and 112 bytes. Scene only. */
    uint32_t mutable_materials;
    /* Flag: masu_instance_set_position and masu_model_set_position are available. Costs 24 host
     * bytes per instance and per model. Scene only. */
    uint32_t double_positions;
    /* Flag: masu_instance_set_look and masu_model_set_look are available. Costs 49 host bytes per
     * instance; device: 48 bytes per instance and frame in flight (twice that with velocities),
     * counted in multiples of 8 instances, and 32 bytes per traced instance and frame in flight.
     * The G-buffer pass tests the fade of each pixel, and so loses the early depth test. Scene
     * only. */
    uint32_t instance_looks;
    uint64_t host_budget;   /* bytes; 0: none. A larger plan is MASU_ERROR_LIMIT */
    uint64_t device_budget; /* bytes, all roles together; 0: none */
    masu_device_block device_blocks[MASU_ROLE_COUNT];
    /* Flag: frames may set light.turbidity although the scene has no analytic sky. No effect with
     * an environment map. Scene only. */
    uint32_t analytic_sky;
    /* Flag: frames may set light.environment. Costs 9 multiply-adds and 6 multiplications per
     * sample of an environment map. Scene only. */
    uint32_t live_environment;
    /* Flag: local lights may be capsules and rectangles, or have a surface, although those of the
     * scene do not. Costs up to 84 KiB of device memory, and registers in the passes that light
     * surfaces. Scene only. */
    uint32_t area_lights;
    /* Several views of the scene: each frame renders viewports[masu_frame_desc.viewport] with its
     * own camera and rung. 0..4; 0: one view, all of the output; viewports[0] must then be all
     * zero. Each viewport must be inside the output; with storage targets it must start at 0, 0
     * (each may have its own target). Viewports may overlap: a later frame covers an earlier one.
     * Costs a set of recordings per viewport. Without a scene a count is MASU_ERROR_ARGUMENT. */
    uint32_t viewport_count;
    masu_viewport viewports[MASU_MAX_VIEWPORTS];
    /* Flag: masu_resize may change the output size, up to `output`, and the targets. Costs 44 host
     * bytes per draw of a G-buffer pass, LODs included, a bounds test in the last pass, and command
     * buffers and descriptor sets for MASU_MAX_TARGETS targets. Scene only. */
    uint32_t resizable;
    /* Ray-tracing backend for reflections of polygons: VK_KHR_ray_query, or the built-in compute
     * BVH, which needs no device feature. The image is the same.
     *   AUTO   ray query if vulkan.ray_query is set, the device is a discrete or integrated GPU and
     *          its limits suffice (on CPUs the BVH is faster)
     *   ON     ray query, else MASU_ERROR_DEVICE. Scenes with skins, and reserve.meshes, need OFF
     *          or AUTO, which then uses the BVH
     *   OFF    built-in BVH
     * Ray query needs more memory, which masu_memory includes. No effect without reflections of
     * polygons. */
    masu_switch ray_query;
    /* Precision of the filter weights in EASU, 16-bit or 32-bit floats.
     *   AUTO   16 in MASU_EASU_FAST if vulkan.shader_float16 is set and the device is a discrete or
     *          integrated GPU (CPUs emulate it); 32 in MASU_EASU_FULL
     *   ON     16 in both, which changes full EASU by up to 2/255; else MASU_ERROR_DEVICE. With
     *          debug.exact 32
     *   OFF    32
     * No effect if no rung upscales by EASU. */
    masu_switch half_floats;
    masu_exposure exposure;
    masu_tone tone;
    /* masu_post_bits: effects that frames may have; 0: none. Any costs 32 bytes per frame in
     * flight. Scene only. */
    uint32_t post;
    /* Largest number of points per axis of a colour table (masu_lut_set), 2..MASU_LUT_MAX; requires
     * MASU_POST_GRADE. Costs 4 lut_size^3 host bytes and the same number of device bytes per frame
     * in flight: 143,748 for 33. 0: there is no table. Scene only. */
    uint32_t lut_size;
    /* Dithers the final rounding to the target's steps, which prevents banding in smooth gradients.
     * The pattern depends on pixel position and frame number only; its average is correct. Exact
     * steps (0 and 1 included) do not change. AUTO: off for storage targets, which tools compare;
     * on for other targets of at most 8 bits. No effect beyond 10 bits. Scene only. */
    masu_switch dither;
    /* 16-bit floats instead of 10 bits for images between tone curve and target, which takes twice
     * the bytes. AUTO: on for targets of more than 8 bits. OFF limits such targets to a precision
     * of 8 bits, and is an error for floating-point storage targets and encodings other than SRGB.
     * ON is an error for 8-bit storage targets and for SRGB formats. Scene only. */
    masu_switch deep_color;
    uint32_t readback; /* masu_readback_bits. Scene only */
    uint32_t split;    /* masu_split_bits; 0: a frame is one command buffer */
    /* Flag: a frame may query the object at a pixel (masu_frame_desc.pick, masu_pick). A frame with
     * a query renders the surroundings of the pixel a second time; other frames have one empty
     * command per primitive. Costs 20 bytes per primitive and 4 per instance, LODs included, per
     * frame in flight. Scene only. */
    uint32_t picking;
    /* Largest number of bytes that one masu_load writes, at least MASU_LOAD_STEP_MIN: for loading a
     * scene while another renderer shows frames (see masu_load). Costs 8 host bytes per step. A
     * staging buffer, if there is one, is no larger than this. 0: steps of at most 4 MiB through
     * the staging buffer; host-visible memory is written in one step. */
    uint64_t load_step;
    /* Flag: masu_init returns before it has created pipelines and recorded frames;
     * masu_init_step then does. Costs host memory for the largest shader, at most 256 KiB. */
    uint32_t init_in_steps;
    uint32_t first_rung; /* the rung that is ready first; the others follow by number */
    masu_governor_desc governor;
    masu_debug debug; /* for tests and studies (masu_study.h) */
    masu_deny deny;   /* device features to leave unused (masu_study.h) */
    /* Receives the messages of masu_init, and the error of each failed call that takes this
     * description or the renderer. NULL: silent. */
    masu_log_fn log;
    void *log_user;
    /* Monotonic clock, ns, to measure the creation time of pipelines; NULL: not measured. */
    uint64_t (*clock_ns)(void *user);
    void *clock_user;
} masu_desc;

/* Starts an initializer: masu_desc desc = {MASU_DESC, .output = {1920, 1080}}; */
#define MASU_DESC .bytes = sizeof(masu_desc)

/* Copies the description with all defaults filled in, by the same function as in masu_init. Needs
 * no device. Resolving the result again does not change it; `out` may be `desc`. Members that
 * depend on the scene (or source) or on the output size remain unresolved if those are missing.
 * Resolve after the last change: a resolved member no longer follows the member that its default
 * depends on. These members remain AUTO:
 *  - rungs[].specular, .bounce and .occlusion, if the scene has a use for them: with fewer than 9
 *    storage buffers per stage (docs/devices.md) AUTO may be off, and ON an error in masu_init;
 *  - ray_query, half_floats, debug.share_rays, which depend on the device.
 *
 *   MASU_ERROR_ARGUMENT   a pointer is NULL, or desc.bytes is not sizeof(masu_desc); other members
 *                         are not checked */
MASU_API MASU_MUST_USE masu_result masu_desc_resolve(const masu_desc *desc, masu_desc *out,
                                                     masu_detail *detail);

/* Writes the built-in ladder of the scene's class, or of the most similar measured class, into
 * rung_count, rungs, flips and governor.costs of `desc`, for a host that changes it before
 * masu_init. Rungs that governor.keep of `desc` forbids are omitted. Knobs for features that the
 * scene lacks have no effect. `from`: scene, size, driver and date of the measurement (static
 * string); may be NULL. MASU_ERROR_ARGUMENT: `scene` or `desc` is NULL, or desc.bytes is not
 * sizeof(masu_desc). */
MASU_API MASU_MUST_USE masu_result masu_ladder_of(const masu_scene *scene, masu_desc *desc,
                                                  const char **from, masu_detail *detail);

/* Destroys the pipelines and samplers of a pool and zeroes it. Destroy the renderers that use it
 * first. Reads get_instance_proc_addr, instance, device and allocator of `vulkan`. NULL is
 * allowed. */
MASU_API void masu_pipelines_destroy(const masu_vulkan *vulkan, masu_pipelines *pipelines);

/* ---- Memory ---------------------------------------------------------------------------------- */

typedef struct masu_role_need {
    uint64_t bytes;          /* 0: the role is unused */
    uint64_t alignment;      /* bytes */
    uint32_t type_bits;      /* memory types that can serve the role, one bit per index */
    uint32_t type;           /* index that masu_init would choose */
    uint32_t host_visible;   /* 1: the block must be mapped */
    uint32_t device_address; /* 1: allocate with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT */
} masu_role_need;

/* Bytes, unless noted. */
typedef struct masu_memory {
    uint64_t host_bytes;
    uint64_t host_alignment; /* a power of two, at most 64 */
    uint64_t device_bytes;   /* sum over the roles */
    uint32_t unified;        /* 1: one block serves all roles */
    masu_role_need roles[MASU_ROLE_COUNT];
    uint64_t transient_unaliased;   /* transient images without memory aliasing */
    uint64_t transient_aliased;     /* transient images in this plan */
    uint64_t transient_lower_bound; /* largest sum alive at the same time, a bound for any plan */
} masu_memory;

/* ---- Frame ----------------------------------------------------------------------------------- */

typedef struct masu_camera {
    double position[3];  /* world, metres */
    float forward[3];    /* need not be unit length */
    float up[3];         /* not parallel to forward; all zero: +Y */
    float fov_y; /* vertical field of view, radians, 0.0005..3.1; with a window it is unused,
                            but must be finite */
    float near_distance; /* metres, 1e-9..1e9; 0: the scene's. There is no far plane */
    /* Offset of the sample position in every pixel, in pixels of the render size, right and down,
     * -1..1. It shifts the projection without rotating it. The average of frames whose offsets
     * cover a pixel evenly is a supersampled image. Rungs with temporal add their own offsets of up
     * to half a pixel. Velocities include the change of the offset. A change of the absolute value
     * of the offset re-renders all cascades with shadow_refresh above 1. */
    float jitter[2];
    /* Off-centre projection: a window one metre ahead of the camera and perpendicular to `forward`.
     * Its sides, in metres to the right of the centre and above it, are tangents of angles. The
     * window may be off the centre and have any aspect ratio. All four 0: symmetric, from fov_y
     * and the aspect ratio of the output. Range -100..100, left < right, bottom < top, with a
     * difference of at least 0.0001 and at least 1/1024 of the larger absolute value. To render
     * part of an image, pass the same part of its window; screen-space ambient occlusion, filters
     * and auto-exposure then have no access to the rest. Velocities and histories follow a changing
     * window. A different angle of its farthest corner re-renders all cascades with shadow_refresh
     * above 1.
     *
     * For host rendering, the projection of a point (x right, y up, z ahead of the camera) is as
     * follows, with reversed depth (n / z; n: near_distance) and compare operator GREATER. l, r, b,
     * t: the window; j: jitter in pixels, plus that of a rung with temporal; W, H: the render size.
     *     clip.x =  (2 x - (r + l) z) / (r - l) - 2 j[0] / W z      clip.z = n
     *     clip.y = -(2 y - (t + b) z) / (t - b) - 2 j[1] / H z      clip.w = z */
    float left, right, bottom, top;
} masu_camera;

/* Changes of the sky at run time: day and night, a sky that stays while the world tilts. All zero:
 * the sky as it is in the scene. `intensity`, `tint` and `rotation` apply to an environment map,
 * and must be zero without one. They affect its ambient light, its reflections and the sky alike;
 * baked probes and live bounces follow. The sun is separate (sun_direction, sun_color).
 *
 * A rotation about +Y is exact. After another rotation, the part of diffuse light that is beyond
 * second-order spherical harmonics is approximated: tilted by 90 degrees, three skies differ by at
 * most 2.1 % of their brightest irradiance from the same skies baked with that tilt. */
typedef struct masu_environment {
    float intensity; /* factor on the radiance, up to 1e6; 0: 1; below 0: black */
    float tint[3];   /* factors on red, green and blue, 0..1; all 0: white */
    /* Quaternion x, y, z, w from the axes of the map to the world's: by an angle a about +Y it is
     * 0, sin(a / 2), 0, cos(a / 2). Need not be of unit length; all 0: no rotation. */
    float rotation[4];
    /* The background that the camera sees where there is no surface, with any kind of sky:
     * background_intensity * (sky and sun disc) + background_color. Fog is in front of it.
     * Ambient light, reflections and fog colour do not change. */
    float background_intensity; /* factor, up to 1e6; 0: 1; below 0: black */
    float background_color[3];  /* radiance, 0..1e9 */
} masu_environment;

typedef struct masu_light {
    float sun_direction[3];              /* towards the sun; need not be unit length */
    float sun_color[3];                  /* irradiance on a perpendicular surface / pi */
    /* Radiance. An environment map of the scene replaces all three: they must then be zero, or as
     * masu_light_of returns them. An analytic sky (turbidity) replaces them too; the values are
     * then unused. */
    float ambient[3];
    float sky_zenith[3], sky_horizon[3];
    /* Linear factor before the tone curve; 0: 1. With auto-exposure (masu_exposure) it is
     * multiplied by the metered factor. */
    float exposure;
    /* 0: gradient sky from sky_zenith and sky_horizon, with `ambient` as ambient light. 1.5 (very
     * clear) to 10 (hazy): analytic sky from the sun direction, which also sets the ambient light;
     * a sun_color of all zero then selects the sun's colour after extinction in the atmosphere, at
     * sunset too. Sky and sun become black after dusk: for a night with a moon, use 0 then, with
     * the moon as the sun and dark sky colours. Auto-exposure would show that night as bright as
     * the day unless masu_exposure.max limits it. A value other than 0 requires a scene with an
     * analytic sky or desc.analytic_sky; with an environment map it must be 0. A change of sun
     * direction, turbidity or ground recomputes the sky, within one millisecond on the CPU. */
    float turbidity;
    float ground[3]; /* albedo below the horizon of the analytic sky, 0..1; else unused */
    masu_environment environment; /* requires desc.live_environment unless all zero */
    /* Fog, for scenes that have it; for others fog_density must be 0. Density at height y:
     * fog_density * exp(-fog_falloff * (y - fog_height)). */
    float fog_color[3]; /* radiance of thick fog, 0..1e9; all 0: that of the sky at the horizon */
    float fog_density;  /* 1/m, 0..1e6; 0: none */
    float fog_height;   /* metres, -1e9..1e9 */
    float fog_falloff;  /* 1/m, 0..1e6; 0: the same at every height */
    float fog_start;    /* metres from the camera, 0..1e9; the air is clear up to there */
} masu_light;

/* The effects of a frame. All zero: none. A member other than 0 whose effect is not in desc.post is
 * MASU_ERROR_ARGUMENT. */
typedef struct masu_post {
    /* MASU_POST_BLOOM: fraction of the light that is scattered, 0..1; 0.03 to 0.15 are usual. Half
     * of the scattered light is within 1.6 to 1.8 % of the image height, 90 % within 5.0 to 5.8 %,
     * at render sizes of 480 to 2160 rows. */
    float bloom;
    /* MASU_POST_FOCUS: diameter of the lens, metres, 0..1e6; 0: all distances are sharp. A camera
     * with a sensor of 24 mm height at f-number N has 0.012 / (N tan(fov_y / 2)). The blur radius
     * is at most 2 % of the image height. Transparent surfaces and particles are blurred like the
     * surface behind them. */
    float aperture;
    float focus; /* view z of the sharp plane, metres, 1e-6..1e9; unused if aperture is 0 */
    /* MASU_POST_GRADE. Vignette: darkening of the corners before the tone curve, 0..1; by half as
     * much halfway to them in area. */
    float vignette;
    float brightness; /* after the tone curve, stops, -8..8: doubles linear light per stop */
    float gamma;      /* encoded values become v^(1 / gamma), 0.1..10; 0: 1 */
} masu_post;

/* Flags of particles. LIT: `color` is an albedo; without the flag, a radiance. A lit particle
 * scatters light evenly, as thin smoke does: color * (visibility * sun_color / 4 + ambient + the
 * sum over punctual lights of (what a white surface facing the light would send) / 4): 1/4 is the
 * mean of max(n.l, 0) over all directions n. All is taken at its centre, visibility from the shadow
 * maps. ADDITIVE: additive blending, which occludes nothing. */
#define MASU_PARTICLE_LIT 1u
#define MASU_PARTICLE_ADDITIVE 2u
/* A particle: a camera-facing sprite of elliptical shape with soft edges, for smoke, sparks, dust.
 * It is sorted with transparent surfaces by the distance of its centre, blended in linear light
 * before exposure, and tested against depth. Two of them may be in the wrong order only at pixels
 * where their distances from the camera differ by less than the sum of the radii of their bounding
 * spheres. Reflections and shadows do not include particles. They
 * are exposed, metered and anti-aliased with the image. Particles with a non-finite number, beyond
 * 1e15 m, or without size or opacity are skipped; values out of range are clamped. */
typedef struct masu_particle {
    double position[3]; /* of the centre, world, metres */
    float half_width;   /* metres, at most 1e9 */
    float half_height;  /* metres; 0: half_width */
    float rotation;     /* radians, counterclockwise on the screen */
    float color[3];     /* linear, 0..4096, not multiplied by opacity */
    float opacity;      /* 0..1, at the centre */
    /* Fraction of the radius at which the fade to the edge starts, 0..1; 1: a disc. */
    float edge;
    /* Metres before a surface or the near plane over which it fades out, which hides the line of
     * intersection; 0: no fade. */
    float soft;
    uint32_t flags; /* MASU_PARTICLE_*; other bits are ignored, as in decals and lines */
    /* 1 .. desc.reserve.textures: the whole rectangle of the particle shows this texture, whose
     * colour and alpha are multiplied by `color` and `opacity`; `edge` is then unused. 0: none. */
    uint32_t texture;
    /* Cell of the texture to show: left, top, right, bottom, 0..1 of the texture from its upper
     * left corner; left > right and top > bottom mirror. All 0: the whole texture. Texels outside
     * are never mixed in, so cells of an atlas need no margin. */
    float uv[4];
    /* Flipbooks: left and top of a second cell of the same size, and its share, 0..1. */
    float uv_next[2];
    float blend;
} masu_particle;

/* A point of a trail. A non-finite number, or a position beyond 1e15 m, leaves out the two segments
 * at the point; values out of range are clamped. */
typedef struct masu_trail_point {
    double position[3]; /* world, metres */
    float half_width;   /* metres, 0..1e9 */
    float color[3];     /* as in masu_particle */
    float opacity;      /* 0..1 */
} masu_trail_point;

/* A trail: a ribbon through points that faces the camera, for smoke, blades and tracers. Its
 * segments share their edges, and keep their width at bends of up to 120 degrees. Each segment is a
 * particle between two points: sorted by the distance of its centre, lit at both points, blended
 * and fading out as a particle. */
typedef struct masu_trail {
    const masu_trail_point *points; /* read during the call */
    uint32_t point_count;           /* below 2: no trail */
    uint32_t flags;                 /* MASU_PARTICLE_* */
    float edge; /* without a texture: fraction of the half width at which the fade begins, 0..1 */
    float soft; /* as in masu_particle */
    /* As in masu_particle. The left edge of the cell is at the first point, and its top on the left
     * side of the trail, seen along it. */
    uint32_t texture;
    float uv[4];
    float repeat; /* metres of trail per repetition of the cell; 0: once over the whole trail */
    float offset; /* metres of trail before the first point; unused with a repeat of 0 */
} masu_trail;

#define MASU_DECAL_ROUND 1u      /* an ellipse in x and y of the box; else a rectangle */
#define MASU_DECAL_KEEP_COLOR 2u /* keeps colour and metallic: a puddle changes roughness only */
/* A decal: a box that replaces the material of polygons and SDF surfaces inside it, before
 * lighting. It also covers their emission. Transparent and purely emissive surfaces do not receive
 * decals, and reflections show surfaces without decals. Later decals cover earlier ones. Decals
 * with a non-finite number, no volume or no opacity are skipped; values out of range are
 * clamped. */
typedef struct masu_decal {
    /* 3x4 matrix from box space, -1..1 along each axis, to the world, row by row. The decal is
     * projected along the z axis of box space, on surfaces that face it. */
    float rows[12];
    double position[3]; /* added to the translation of `rows`; for boxes far from the origin */
    float color[3]; /* albedo, linear, 0..1 */
    float opacity;  /* 0..1 */
    /* Perceptual, 0..1; 0: that of the surface. Smooth decals reflect by ray tracing, if the scene
     * has reflections. */
    float roughness;
    float metallic; /* 0..1; below 0: that of the surface */
    float edge;     /* fraction of the half width over which it fades out at its edge, 0..1 */
    /* Angle between z axis and surface normal, radians, 0..pi: full effect up to inner, none from
     * outer on. Both 0: 1.05 and 1.4. */
    float inner, outer;
    uint32_t flags; /* MASU_DECAL_* */
    /* As in masu_particle: the colour and alpha of the texture are multiplied by `color` and
     * `opacity`. The cell fills the box: its left edge is at x = -1, its top at y = 1. */
    uint32_t texture;
    float uv[4];
    /* Radiance that the decal emits, 0..1e6, times its colour and the texture's. Requires
     * desc.reserve.textures. */
    float emission;
} masu_decal;

#define MASU_LINE_ON_TOP 1u /* no depth test; else surfaces more than 0.5 % closer occlude it */
/* A debug line: one pixel of the output wide, drawn in its exact colour after tone curve,
 * anti-aliasing and upscaling. The later one of two crossing lines is on top. Lines with a
 * non-finite number or beyond 1e15 m are skipped. */
typedef struct masu_line {
    double from[3], to[3];              /* world, metres */
    uint8_t from_color[4], to_color[4]; /* sRGB-encoded red, green, blue; the fourth is ignored */
    uint32_t flags;                     /* MASU_LINE_* */
} masu_line;

#define MASU_RUNG_AUTO UINT32_MAX

/* Without a scene camera, light and cut are unused. */
typedef struct masu_frame_desc {
    uint32_t bytes;            /* sizeof(masu_frame_desc), set by MASU_FRAME_DESC */
    const masu_camera *camera; /* NULL: the scene's camera path at `time` */
    const masu_light *light;   /* NULL: the scene's */
    double time;     /* seconds since the start, -1e15..1e15: animates SDF and camera path */
    /* Seconds since the previous frame, -1e15..1e15. 0 is allowed, but auto-exposure then does not
     * adapt: it keeps the exposure of the first frame, or of the last cut. */
    float time_step;
    uint32_t rung;   /* 0 .. rung_count - 1, or MASU_RUNG_AUTO: selected by the governor */
    uint32_t target; /* 0 .. targets.count - 1 */
    /* 0 .. desc.viewport_count - 1. A frame of viewport 0 discards the contents of the target;
     * frames of other viewports expect it in targets.final_layout and leave the rest of it
     * unchanged. Histories of reflections, temporal and auto-exposure belong to one view: a frame
     * of a different viewport than the previous one is a cut. MASU_RUNG_AUTO is for viewport 0
     * only. */
    uint32_t viewport;
    /* Flag: camera cut. The image is unrelated to the previous frame, and velocities are 0. The
     * first frame is always a cut. The previous frame is the one that masu_frame returned last,
     * submitted or not. If it was not submitted, and rungs[].shadow_refresh is above 1 or
     * rungs[].temporal is on (AUTO is, with a governor), this frame must be a cut, because cascades
     * or history are missing. */
    uint32_t cut;
    const float *sdf_params;  /* `sdf_param_count` values; NULL with a count of 0: the defaults */
    uint32_t sdf_param_count; /* at most the scene's count; further parameters keep their defaults.
                                 Values are clamped to their declared range; a non-finite value is
                                 MASU_ERROR_ARGUMENT */
    /* Flag: excluded from timing, because its time does not predict the next frames (a level loads,
     * shaders compile, a debugger has stopped). The governor keeps its rung and counts the time as
     * `rejected` and not as `missed`. Affects the governor only. */
    uint32_t exclude_from_timing;
    /* Objects of this frame, read during the call: at most desc.reserve of each. NULL if the count
     * is 0. */
    const masu_particle *particles;
    const masu_decal *decals;
    const masu_line *lines;
    uint32_t particle_count, decal_count, line_count;
    const masu_trail *trails; /* with at most desc.reserve.trail_points points together */
    uint32_t trail_count;
    /* Flag: commands of the host have changed textures (masu_texture_image_of) since the previous
     * frame. Rungs with temporal then shorten their history, as they do after
     * masu_texture_write. */
    uint32_t textures_changed;
    masu_post post; /* effects on the image, of desc.post */
    /* pick: flag. masu_pick reports the object at this pixel of the output (or viewport), counted
     * from the upper left corner: 0 .. width - 1, 0 .. height - 1. Requires desc.picking. */
    uint32_t pick, pick_x, pick_y;
    /* Bits of masu_look.pick_mask: the query passes through instances that have none of them. 0:
     * all bits. */
    uint32_t pick_mask;
} masu_frame_desc;

/* Starts an initializer: masu_frame_desc frame = {MASU_FRAME_DESC, .time = time}; */
#define MASU_FRAME_DESC .bytes = sizeof(masu_frame_desc)

typedef struct masu_commands {
    VkCommandBuffer buffer; /* parts[0] */
    uint32_t slot; /* frame-in-flight slot: wait for its fence before masu_frame uses it again */
    uint32_t rung;
    uint64_t frame; /* number of this frame, from 0 */
    /* The command buffers of the frame, in order: one, plus one for each point of desc.split, with
     * the host's commands in between. Submit all parts, each once, preferably in one vkQueueSubmit.
     * 1 for a masu_load that returns MASU_INCOMPLETE. */
    uint32_t part_count;
    VkCommandBuffer parts[MASU_MAX_PARTS];
    /* For masu_load: bytes that this step has written, and bytes that remain. */
    uint64_t load_bytes, load_left;
} masu_commands;

/* Sets the colour table from the next masu_frame on. `colors`: size^3 colours of red, green and
 * blue in display encoding, 0..1 (other values are clamped, NaN is 0), stored with 10 bits; red
 * varies fastest, then green, as in .cube files. The table maps colours after the tone curve,
 * brightness and gamma, in sRGB encoding; with LINEAR and PQ, 1 is the peak. Between its points it
 * is interpolated linearly in tetrahedra. NULL with a size of 0: no table, as initially. Copies the
 * colours; the next frames write them once to each slot, 4 size^3 bytes.
 *   MASU_ERROR_ARGUMENT   `size` is not 0 or 2..desc.lut_size, or a pointer is NULL
 * Nothing has changed after an error. */
MASU_API MASU_MUST_USE masu_result masu_lut_set(masu_renderer *renderer, const float *colors,
                                                uint32_t size, masu_detail *detail);

/* ---- Frame: host passes inside it ------------------------------------------------------------ */

/* With desc.split a frame is submitted like this (examples/host_pass.c):
 *
 *     masu_frame(m, &frame, &commands, &detail);
 *     masu_split_of(m, MASU_SPLIT_BEFORE_TONE, commands.rung, frame.viewport, &split, &detail);
 *     masu_frame_view_of(m, &view, &detail);              // the matrices of this frame
 *     record(own);                                        // a command buffer of the host
 *     VkCommandBuffer all[] = {commands.parts[0], own, commands.parts[1]};
 *     vkQueueSubmit(queue, 1, &{.commandBufferCount = 3, .pCommandBuffers = all}, fence);
 *
 *  - Barriers at the split are part of the library's command buffers. The previous part ends with a
 *    barrier from all its work to all commands (VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
 *    VK_ACCESS_MEMORY_READ_BIT | _WRITE_BIT), with the images in `layout`. The next part starts
 *    with a barrier from all commands of the host. A render pass of the host uses `layout` as
 *    initial and final layout, LOAD and STORE. The host inserts the barriers between its own
 *    commands, and restores `layout` if it changes it.
 *  - The host may read and write the images as `usage` allows, within `width` x `height` from 0, 0.
 *    Their remaining texels are undefined. So are all images that are not listed, because images
 *    share memory.
 *  - Images and views are the same in all frames, rungs and viewports, also after masu_resize,
 *    until masu_destroy. Create a framebuffer once, with the size `image_width` x `image_height`,
 *    and set render area, viewport and scissor to `width` x `height` of the frame.
 *  - Depth is reversed: near / view z, 1 at near_distance, 0 at infinity, 32-bit float. Test with
 *    VK_COMPARE_OP_GREATER or _GREATER_OR_EQUAL. In `layout` depth can be a read-only attachment,
 *    and be sampled in the same pass. To write depth, the host changes the layout to
 *    DEPTH_STENCIL_ATTACHMENT_OPTIMAL and back. Later passes of the frame use the written depth:
 *    rungs with temporal reproject surfaces by it.
 *  - HDR contains radiance before exposure: a shader output v is displayed as tone(v * exposure).
 *    Blending works as with any attachment; alpha is ignored and need not be preserved. NaN is
 *    displayed as black.
 *  - Velocities, reflections and shadows do not include the host's rendering. Velocities, and rungs
 *    with temporal, treat it as part of the surface behind it.
 *  - The timestamps of the governor, and so its frame times, include the host's commands between
 *    the parts. With debug.timestamps these have their own times, in the rows split_tone and
 *    split_output. */

/* An image at a split point. */
typedef struct masu_split_image {
    VkImage image;    /* VK_NULL_HANDLE: unavailable; exception: masu_split.color */
    VkImageView view; /* of the whole image, with its full usage */
    VkFormat format;
    VkImageUsageFlags usage;
    VkImageLayout layout;               /* layout at the split, which the host must restore */
    uint32_t image_width, image_height; /* of the VkImage: those of the largest rung */
    uint32_t width, height;             /* of the contents, from 0, 0, in this rung and viewport */
} masu_split_image;

typedef struct masu_split {
    uint32_t part; /* submit the host's commands after masu_commands.parts[part] */
    /* BEFORE_TONE: HDR, R16G16B16A16_SFLOAT, in COLOR_ATTACHMENT_OPTIMAL. Usage: COLOR_ATTACHMENT,
     * SAMPLED, STORAGE, TRANSFER_SRC. AFTER_UPSCALE: the output image in the encoding of the
     * target, with the same layout and usage: display-encoded colour, 0..1, in R8G8B8A8_UNORM; with
     * deep_color R16G16B16A16_SFLOAT. For storage targets it is targets.images[frame.target] in
     * GENERAL: image and view are then VK_NULL_HANDLE, and the host has defined the usage. */
    masu_split_image color;
    /* D32_SFLOAT, in DEPTH_STENCIL_READ_ONLY_OPTIMAL. Usage: DEPTH_STENCIL_ATTACHMENT, SAMPLED,
     * TRANSFER_SRC. In scenes with an SDF it is a separate image with a pass (split_depth), because
     * the output of sphere tracing is not an attachment. AFTER_UPSCALE: with KEEP only, at the
     * render size. */
    masu_split_image depth;
    /* R16G16B16A16_SFLOAT, in SHADER_READ_ONLY_OPTIMAL. Usage: SAMPLED, TRANSFER_SRC. With
     * VELOCITY; AFTER_UPSCALE also with KEEP. Texels as in MASU_READBACK_VELOCITY. */
    masu_split_image velocity;
    /* AFTER_UPSCALE with KEEP: HDR as the input of the tone curve, read only; layout and usage as
     * velocity. */
    masu_split_image hdr;
    /* 1: `color` has red and blue exchanged (AFTER_UPSCALE, B8G8R8A8_SRGB target). */
    uint32_t swapped;
} masu_split;

/* The images at a split point, in a frame of that rung and viewport (0 without viewports). Allowed
 * at any time after masu_init. `which`: BEFORE_TONE or AFTER_UPSCALE. MASU_ERROR_ARGUMENT: a
 * pointer is NULL, `which` is not in desc.split, or the rung or viewport does not exist. */
MASU_API MASU_MUST_USE masu_result masu_split_of(masu_renderer *renderer, masu_split_bits which,
                                                 uint32_t rung, uint32_t viewport, masu_split *out,
                                                 masu_detail *detail);

/* Camera matrices of a frame, row by row, for column vectors: transpose them for a GLSL mat4, or
 * declare it layout(row_major). View space: x right, y up, the camera looks along -z, metres. Clip
 * space: that of Vulkan, y down, depth reversed. */
typedef struct masu_frame_view {
    uint64_t frame;
    double position[3]; /* of the camera, world */
    /* World to view space. Floats are coarse far from the origin: compute (point - position) in
     * doubles there, and use only the rotation of this matrix. Its last column is -rotation *
     * position. */
    float view[16];
    /* View space to the clip space of BEFORE_TONE, depth and velocity, with the jitter of the
     * camera and of a rung with temporal. Geometry drawn with it matches the pixels and depths of
     * the scene. */
    float projection[16];
    /* View space to the clip space of AFTER_UPSCALE and of the target. Without jitter in a rung
     * with temporal, whose output has none; else equal to `projection`. */
    float output_projection[16];
    float jitter[2];     /* in `projection`: pixels of the render size, right and down */
    float near_distance; /* metres; a depth d is at a view z of near_distance / d */
    /* masu_light.exposure: factor before the tone curve. With auto-exposure the GPU multiplies it
     * by the metered factor (masu_stats_info.exposure). */
    float exposure;
    uint32_t render_width, render_height, output_width, output_height; /* of the viewport, pixels */
} masu_frame_view;

/* The matrices of the frame that masu_frame returned last. MASU_ERROR_ARGUMENT: a pointer is NULL.
 * MASU_ERROR_STATE: there is no frame yet, or no scene. */
MASU_API MASU_MUST_USE masu_result masu_frame_view_of(const masu_renderer *renderer,
                                                      masu_frame_view *out, masu_detail *detail);

/* ---- Frame: governor ------------------------------------------------------------------------- */

/* Reports the wall-clock time of the slot's last frame, in ms: from its submit, or from the end of
 * the previous frame if that was later, to its fence. Optional. Call it after the wait for the
 * fence and before the slot is used again. The interval between frames is not a valid time if the
 * display makes the host wait. Non-finite and negative times are ignored. With two frames in
 * flight:
 *
 *     double submitted[2], ended = 0;                     // per slot; of the previous frame, ms
 *     for (uint64_t n = 0;; n++) {
 *         uint32_t slot = n % 2;                          // the value of commands.slot
 *         if (n >= 2) {
 *             wait_for(fence[slot]);                      // of frame n - 2
 *             double now = clock_ms();
 *             masu_frame_wall(m, slot, now - fmax(submitted[slot], ended));
 *             ended = now;
 *         }
 *         masu_frame(m, &frame, &commands, &detail);      // the governor reads the time here
 *         submitted[slot] = clock_ms();
 *         submit(commands.buffer, fence[slot]);
 *     }
 *
 * The time includes everything that the host submits under the same fence, its own passes for
 * example, and the target must include it too; timestamps do not. If the fence was signalled before
 * the host waited for it, the time is too long: wait as soon as there is no other work, or skip the
 * call for such a frame. */
MASU_API void masu_frame_wall(masu_renderer *renderer, uint32_t slot, double wall_ms);

/* As masu_frame_wall, with more information: prefer it. `submit_ns`: when the slot's last frame was
 * passed to vkQueueSubmit; `done_ns`: when its fence was first observed as signalled. Both in ns of
 * one monotonic clock with any start. With frames in flight a frame waits for the previous one; the
 * library starts its time when that one ended, in whichever order they are reported. It needs the
 * times of every frame: after a skipped frame it ignores those of the next one (except with one
 * frame in flight). Check the fence without delay, because a late check lengthens the frame
 * time. done_ns <= submit_ns: no times. Call it at the same point as masu_frame_wall, whose times
 * are then ignored.
 *
 * `cpu_ms`: the host's own work per frame, without waits for fences, images or sleep; 0: unknown. A
 * wall-clock time of at most cpu_ms measures the host and not the GPU. The governor then uses
 * timestamps only; without them, and with cpu_ms above the target, it uses no times. If cpu_ms is
 * above the target and the GPU time is not, governor.locked is MASU_GOVERNOR_LOCKED_CPU. */
MASU_API void masu_frame_times(masu_renderer *renderer, uint32_t slot, uint64_t submit_ns,
                               uint64_t done_ns, double cpu_ms);

/* Reports that frame `frame` (masu_commands.frame) was presented at `present_ns`, from
 * VK_GOOGLE_display_timing, VK_KHR_present_wait or the host's own clock, on a display with a
 * refresh interval of `refresh_ns`, 1e6..1e9. Report frames in order, each once, within 16 frames;
 * frames may be skipped. governor.refreshes is then the number of refreshes for which to present
 * the next frame, `missed` counts frames that were presented later than that, and a target of up to
 * 5 % of a refresh above a whole number of refreshes is rounded down to it. A refresh_ns out of
 * range, 0 for example, ends this mode. Invalid values are ignored. */
MASU_API void masu_frame_presented(masu_renderer *renderer, uint64_t frame, uint64_t present_ns,
                                   uint64_t refresh_ns);

/* The part of masu_governor_desc that can change between frames (masu_governor_set), with the same
 * units, ranges and defaults. `mode` must be MASU_GOVERNOR_ON or _FIXED. */
typedef struct masu_governor_setting {
    masu_governor_mode mode;
    float target_ms, headroom;
    uint32_t best_rung, worst_rung, rung, dwell;
} masu_governor_setting;

/* Replaces mode, target, headroom, range, fixed rung and dwell of the governor from the next
 * masu_frame on. Members that are 0 select their defaults. Measured times and costs remain valid;
 * failed rises are forgotten, and a better rung that fits is selected without waiting for the
 * dwell. Every rung is kept for at least 8 frames, unless it misses the target or is out of the
 * range.
 *   MASU_ERROR_ARGUMENT   a pointer is NULL, or a member is out of range; the detail names it and
 *                         its range. Nothing has changed
 *   MASU_ERROR_STATE      governor.mode was OFF in masu_init */
MASU_API MASU_MUST_USE masu_result masu_governor_set(masu_renderer *renderer,
                                                     const masu_governor_setting *setting,
                                                     masu_detail *detail);

#define MASU_GOVERNOR_STATE_VERSION 1u

/* The estimates of a governor (masu_governor_save): numbers without pointers, to be copied, or
 * written to a file for the same machine. The members are private to the library. */
typedef struct masu_governor_state {
    uint32_t bytes, version; /* sizeof, MASU_GOVERNOR_STATE_VERSION */
    uint32_t known;          /* 0: no measurements yet; all members below are 0 */
    uint32_t width, height;  /* output, pixels */
    uint32_t rung_count, rung;
    uint32_t held;            /* frames since `rung` was selected, at most 4096 */
    uint32_t patience;        /* wait before the next rise, in multiples of dwell, 1..64 */
    uint32_t wall_only;       /* 1: timestamps are implausible */
    uint32_t follows;         /* 1: the clock has followed the load in a trial */
    uint32_t trials;          /* failed trials since, 0..6 */
    double fixed_ms, load_ms; /* as in masu_governor_info */
    double fixed_variance, load_variance, covariance; /* ms^2 */
    double noise, overhead_ms, unit;                  /* as in masu_governor_info */
    double settled_ms, mistake_ms; /* load_ms when the rung settled, and at the last failed rise */
    struct {
        double scale, prior;   /* from the description; they identify the rung */
        double cost, variance; /* estimated cost, variance of its relative error */
        double penalty;        /* factor on the predicted time, raised by failed rises */
    } rungs[MASU_MAX_RUNGS];
} masu_governor_state;

/* Saves the estimates of the governor for masu_governor_restore: after masu_destroy and masu_init,
 * in another renderer, or in a later run. Allowed between any two frames. MASU_ERROR_ARGUMENT: a
 * pointer is NULL. MASU_ERROR_STATE: as masu_governor_set. */
MASU_API MASU_MUST_USE masu_result masu_governor_save(masu_renderer *renderer,
                                                      masu_governor_state *out,
                                                      masu_detail *detail);

/* Restores saved estimates, before the first frame or between any two. With the same rungs (scales
 * and governor.costs) and the same output size, the first frame has the rung that the old renderer
 * would have selected next. Otherwise it has the best rung that is predicted to meet the target:
 *  - With a different output size load_ms is scaled by the number of pixels. fixed_ms is scaled
 *    halfway; its deviation covers both no scaling and full scaling.
 *  - A rung with the same scale and cost in the description keeps its estimated cost. Others start
 *    with their governor.costs, which must have the same unit on both sides, as scale^2 and the
 *    costs of built-in ladders have.
 * A state without measurements has no effect. After an error nothing has changed, so a host may
 * pass the contents of any file.
 *   MASU_ERROR_ARGUMENT   a pointer is NULL, or a number is invalid; the detail names it
 *   MASU_ERROR_VERSION    the state has another version or size
 *   MASU_ERROR_STATE      as masu_governor_set */
MASU_API MASU_MUST_USE masu_result masu_governor_restore(masu_renderer *renderer,
                                                         const masu_governor_state *state,
                                                         masu_detail *detail);

/* ---- Live scene: handles --------------------------------------------------------------------- */

/* HANDLES. id 0 is no object. All other ids are returned by the functions below; do not construct
 * them. A handle of an object of the scene is valid in every renderer of the same blob, also after
 * masu_destroy and masu_init. A handle of another scene or of another kind is MASU_ERROR_ARGUMENT;
 * the probability that it passes for a valid one is (number of objects of its kind in the scene) /
 * 2^32.
 *
 * A handle of an object that was added belongs to its renderer. Once the object is removed, the
 * handle is MASU_ERROR_ARGUMENT for good: no id is used twice. For that, a slot of desc.reserve
 * holds at most 2^31 - 1 objects, one after the other, until masu_destroy; then it is retired. */

/* ---- Live scene: instances and models -------------------------------------------------------- */

/* Handle of an instance: a mesh with a transform. */
typedef struct masu_instance {
    uint64_t id;
} masu_instance;

/* The first instance with that name in the scene; id 0 if there is none. */
MASU_API masu_instance masu_instance_find(const masu_renderer *renderer, const char *name);

/* Sets the transform of an instance from the next masu_frame on. `rows`: 3x4 matrix from object to
 * world space, row by row. MASU_ERROR_ARGUMENT: the handle is invalid, or a value is not finite. */
MASU_API MASU_MUST_USE masu_result masu_instance_set_transform(masu_renderer *renderer,
                                                               masu_instance instance,
                                                               const float rows[12],
                                                               masu_detail *detail);

/* Replaces the translation of an instance by `position`, world, metres, in double precision. Far
 * from the origin, where a float resolves 1 m at 1e7 m, polygons are then placed relative to the
 * camera as exactly as near the origin. Culling, LODs and the boxes of masu_instance_state remain
 * in single precision, which is conservative. Scenes with probes of baked or bounced light, and
 * those with an SDF and shadows of punctual lights, are placed in single precision.
 * masu_instance_set_transform sets the translation again.
 *   MASU_ERROR_ARGUMENT   the handle is invalid, or a value is not within -1e15..1e15
 *   MASU_ERROR_STATE      desc.double_positions is 0 */
MASU_API MASU_MUST_USE masu_result masu_instance_set_position(masu_renderer *renderer,
                                                              masu_instance instance,
                                                              const double position[3],
                                                              masu_detail *detail);

/* The instance with that index: first those of the scene, in the order of MASU_SCENE_INSTANCE,
 * then those of copied models (desc.reserve). id 0 after the last one, and for an unused slot. */
MASU_API masu_instance masu_instance_at(const masu_renderer *renderer, uint32_t index);

/* Handle of a movable model: one with "moving", "hidden" or "spare" in the scene description. Its
 * nodes are placed, shown and hidden together. */
typedef struct masu_model {
    uint64_t id;
} masu_model;

typedef struct masu_instance_state {
    float rows[12]; /* as in masu_instance_set_transform */
    /* World, metres: contains the transformed box of the mesh, with a small margin. */
    float box_low[3], box_high[3];
    uint32_t index; /* for masu_instance_at */
    uint32_t mesh;
    uint32_t shown;   /* 0: hidden */
    masu_model model; /* the model whose node it is; id 0: none */
    double position[3]; /* translation of `rows`, before rounding to float */
} masu_instance_state;

/* State of an instance in the next masu_frame. MASU_ERROR_ARGUMENT: a pointer is NULL, or the
 * handle is invalid. */
MASU_API MASU_MUST_USE masu_result masu_instance_get(masu_renderer *renderer,
                                                     masu_instance instance,
                                                     masu_instance_state *out, masu_detail *detail);

/* Hides an instance (`shown` 0) or shows it from the next masu_frame on: in the image, in shadows
 * and in reflections. The lights of a hidden instance are off. Cascades with shadow_refresh above 1
 * keep its shadow until they are re-rendered. An instance that is shown has a velocity of 0 in its
 * first frame. Baked light of probes does not change; a live bounce follows within some
 * rounds of its probes. MASU_ERROR_ARGUMENT: the handle is invalid. */
MASU_API MASU_MUST_USE masu_result masu_instance_show(masu_renderer *renderer,
                                                      masu_instance instance, uint32_t shown,
                                                      masu_detail *detail);

/* Flags of masu_look. */
#define MASU_LOOK_NO_SHADOW 1u  /* casts no shadow of sun or punctual lights */
#define MASU_LOOK_NOT_TRACED 2u /* absent in reflections, and for live bounces */
#define MASU_LOOK_NOT_PICKED 4u /* masu_pick passes through it */

/* The look of one instance, on top of its materials. Requires desc.instance_looks. All zero:
 * unchanged. */
typedef struct masu_look {
    /* Multiplies the base colour, and the emission of unlit materials; 0..1. All 0: white; black is
     * {1e-6f, 0, 0}. */
    float tint[3];
    float emission; /* factor on the emission, up to 1e6; 0: 1; below 0: off */
    /* Texture coordinate = scale * coordinate of the mesh + offset, -1e4..1e4, for all maps; in
     * alpha tests of reflection rays the mesh's own. A scale of 0 is 1. */
    float uv_offset[2], uv_scale[2];
    /* Fraction of its pixels that are not drawn, 0..1: fades by dithering; 1: it is hidden, but
     * its lights stay on. Two
     * instances at one pixel have the same pattern, which with rung.temporal differs in each frame
     * and so is averaged. Transparent materials fade smoothly. Shadows and reflections stay solid
     * below 1: one depth per shadow texel cannot hold a part, and dithered shadow texels would
     * flicker. Picking finds it below 1. */
    float fade;
    uint32_t flags; /* MASU_LOOK_* */
    /* Bit per viewport (masu_frame_desc.viewport) in which the camera does not see the instance.
     * Its shadows and reflections stay. */
    uint32_t hidden_views;
    uint32_t pick_mask; /* picked by frames with one of these bits in pick_mask; 0: all bits */
} masu_look;

/* Sets the look of an instance from the next masu_frame on. masu_model_add gives the model a look
 * of all zero. Velocities ignore uv_offset. Live bounces follow within some rounds of their probes;
 * baked light and the lights of the scene do not change. A change of shadows has the delay of
 * masu_instance_show.
 *   MASU_ERROR_ARGUMENT   a pointer is NULL, the handle is invalid, or a value is out of range or
 *                         not finite, or an unknown flag
 *   MASU_ERROR_STATE      desc.instance_looks is 0 */
MASU_API MASU_MUST_USE masu_result masu_instance_set_look(masu_renderer *renderer,
                                                          masu_instance instance,
                                                          const masu_look *look,
                                                          masu_detail *detail);

/* The look as it was set. Errors as masu_instance_set_look. */
MASU_API MASU_MUST_USE masu_result masu_instance_get_look(masu_renderer *renderer,
                                                          masu_instance instance, masu_look *out,
                                                          masu_detail *detail);

/* The first model with that name in the scene description; id 0 if there is none. */
MASU_API masu_model masu_model_find(const masu_renderer *renderer, const char *name);

/* The model with that index: first those of the scene, in the order of MASU_SCENE_MODEL, then
 * the slots of desc.reserve. id 0 after the last one, and for an unused slot. */
MASU_API masu_model masu_model_at(const masu_renderer *renderer, uint32_t index);

typedef struct masu_model_state {
    /* 3x4 matrix from model space to the world, row by row. Model space is the space of the scene
     * description without "translate": scale, rotation and fit are part of the nodes. Initially
     * only the translation. */
    float rows[12];
    float box_low[3], box_high[3]; /* bounding box of all its instances, world, metres */
    uint32_t index;                /* for masu_model_at */
    uint32_t shown;                /* 0: hidden */
    uint32_t nodes;                /* number of nodes; parents have lower indices than children */
    double position[3];            /* translation of `rows`, before rounding to float */
} masu_model_state;

/* State of a model in the next masu_frame. Errors as masu_instance_get. */
MASU_API MASU_MUST_USE masu_result masu_model_get(masu_renderer *renderer, masu_model model,
                                                  masu_model_state *out, masu_detail *detail);

/* Sets the transform of a model with all its nodes from the next masu_frame on. `rows` as in
 * masu_model_state. An instance of the model that masu_instance_set_transform has moved returns to
 * its node. MASU_ERROR_ARGUMENT: a pointer is NULL, the handle is invalid, a value is not finite,
 * or the transform of a node overflows a float. Nothing has changed then. */
MASU_API MASU_MUST_USE masu_result masu_model_set_transform(masu_renderer *renderer,
                                                            masu_model model, const float rows[12],
                                                            masu_detail *detail);

/* As masu_instance_set_position, for the model with all its nodes. After masu_model_add, call it
 * before the next masu_frame. masu_model_set_transform sets the translation again. */
MASU_API MASU_MUST_USE masu_result masu_model_set_position(masu_renderer *renderer,
                                                           masu_model model,
                                                           const double position[3],
                                                           masu_detail *detail);

/* As masu_instance_show, for all instances of the model. */
MASU_API MASU_MUST_USE masu_result masu_model_show(masu_renderer *renderer, masu_model model,
                                                   uint32_t shown, masu_detail *detail);

/* As masu_instance_set_look, for all instances of the model. */
MASU_API MASU_MUST_USE masu_result masu_model_set_look(masu_renderer *renderer, masu_model model,
                                                       const masu_look *look, masu_detail *detail);

/* Adds a model of the same kind as `like` at `rows` from the next masu_frame on. It takes a hidden
 * model of that kind from the scene, a pooled copy ("spare") for example. If all of them are shown,
 * it makes a copy in a slot of desc.reserve.models, without a name. The nodes get the current
 * transforms of the nodes of `like`. Lights attached to `like` are copied too, into
 * desc.reserve.lights. Allocates nothing. The model has a velocity of 0 in its first frame.
 *   MASU_ERROR_LIMIT      all models of the kind are shown, and the reserve is full, or `like` has
 *                         skins or is a mesh of the host, which cannot be copied; or
 *                         desc.reserve.lights is too small
 *   MASU_ERROR_ARGUMENT   as masu_model_set_transform
 * Nothing has changed after an error. */
MASU_API MASU_MUST_USE masu_result masu_model_add(masu_renderer *renderer, masu_model like,
                                                  const float rows[12], masu_model *out,
                                                  masu_detail *detail);

/* Removes a model. A copy frees its slot: its handle, the handles of its instances, and the handles
 * of reserve lights attached to them become invalid. Scene lights attached to it are detached and
 * switched off. A model of the scene is only hidden, as by masu_model_show, and its handle remains
 * valid. MASU_ERROR_ARGUMENT: the handle is invalid. */
MASU_API MASU_MUST_USE masu_result masu_model_remove(masu_renderer *renderer, masu_model model,
                                                     masu_detail *detail);

/* The vertices and triangles of a mesh of the host; read during the call. Object space, metres. */
typedef struct masu_mesh_data {
    const float *positions; /* 3 per vertex, within -1e15..1e15 */
    const float *normals;   /* 3 per vertex, of any length; one of length 0 becomes +Y */
    const float *texcoords; /* 2 per vertex, of every map; NULL: all 0. Not read without textures */
    const float *colors;    /* linear red, green, blue, alpha per vertex, 0..1; NULL: white. Only in
                               scenes with vertex colours */
    const uint32_t *indices; /* 3 per triangle, counter-clockwise from the front */
    uint32_t vertex_count;   /* 3 .. masu_mesh_kind.vertices */
    uint32_t triangle_count; /* 1 .. masu_mesh_kind.triangles */
} masu_mesh_data;

/* Creates a mesh from the next masu_frame on, in a slot of desc.reserve.meshes[kind]. The result is
 * a model with one node, without a name: masu_model_set_transform moves it, masu_model_show hides
 * it, masu_model_remove frees its slot, masu_model_node_get has its instance. In the image, in
 * shadows, for culling, for picking and in traced reflections it is like a mesh of the scene,
 * without LODs. Occlusion culling does not use it as an occluder, and baked light does not include
 * it. Rays trace it if they trace any polygon of the scene; the call then also builds its BVH, so
 * reflections show it in the same frame.
 *
 * A frame that is not submitted loses what was uploaded for it: replace these meshes again.
 * Allocates nothing. Nothing has changed after an error.
 *   MASU_ERROR_LIMIT      no slot of the kind is free; the mesh is larger than its slot; or the
 *                         calls since the last masu_frame have more bytes than
 *                         desc.reserve.mesh_upload: call again after the next masu_frame
 *   MASU_ERROR_ARGUMENT   a pointer is NULL; the kind is unused; a number is not finite or out of
 *                         range; an index is not below vertex_count; `colors` in a scene without
 *                         vertex colours; or as masu_model_set_transform */
MASU_API MASU_MUST_USE masu_result masu_mesh_create(masu_renderer *renderer, uint32_t kind,
                                                    const masu_mesh_data *data,
                                                    const float rows[12], masu_model *out,
                                                    masu_detail *detail);

/* Replaces vertices and triangles of a mesh from the next masu_frame on. Its velocity in that frame
 * is that of its transform only. Errors as masu_mesh_create; MASU_ERROR_ARGUMENT also if `mesh` is
 * not from masu_mesh_create. */
MASU_API MASU_MUST_USE masu_result masu_mesh_replace(masu_renderer *renderer, masu_model mesh,
                                                     const masu_mesh_data *data,
                                                     masu_detail *detail);

/* Moves the vertices of a mesh from the next masu_frame on, for cloth, water or trails: any number
 * of meshes per frame, within desc.reserve.mesh_upload, at 16 bytes per vertex. Triangles, texture
 * coordinates and colours are kept. Velocities follow from the previous positions. The device
 * refits the BVH to the new positions; after a large change masu_mesh_replace builds a better one.
 * `positions` and `normals` as in masu_mesh_data; `vertex_count` must be that of the mesh. Errors
 * as masu_mesh_replace. */
MASU_API MASU_MUST_USE masu_result masu_mesh_deform(masu_renderer *renderer, masu_model mesh,
                                                    const float *positions, const float *normals,
                                                    uint32_t vertex_count, masu_detail *detail);

/* Bytes that a mesh of these counts takes of desc.reserve.mesh_upload in masu_mesh_create and
 * masu_mesh_replace: 16 per vertex, 8 more with textures and 4 with vertex colours; 12 per
 * triangle, and up to 32 more if rays trace polygons. 0 for NULL. */
MASU_API uint64_t masu_mesh_bytes(const masu_renderer *renderer, uint32_t vertex_count,
                                  uint32_t triangle_count);

#define MASU_NODE_NONE UINT32_MAX

/* The first node of a model with that name in the model's file; MASU_NODE_NONE if there is none. */
MASU_API uint32_t masu_model_node_find(const masu_renderer *renderer, masu_model model,
                                       const char *name);

typedef struct masu_node_state {
    float rows[12];         /* 3x4 matrix to the parent node; for a root node, to the model */
    float world[12];        /* 3x4 matrix to the world */
    uint32_t parent;        /* index of the parent node, or MASU_NODE_NONE */
    masu_instance instance; /* the instance of the node; id 0: none */
} masu_node_state;

/* State of a node in the next masu_frame. Errors as masu_model_get; also MASU_ERROR_ARGUMENT if the
 * node does not exist. */
MASU_API MASU_MUST_USE masu_result masu_model_node_get(masu_renderer *renderer, masu_model model,
                                                       uint32_t node, masu_node_state *out,
                                                       masu_detail *detail);

/* Sets the transform of a node relative to its parent, which also moves the nodes below it: doors,
 * wheels, turrets. Errors as masu_model_set_transform; also MASU_ERROR_ARGUMENT if the node does
 * not exist. */
MASU_API MASU_MUST_USE masu_result masu_model_node_set(masu_renderer *renderer, masu_model model,
                                                       uint32_t node, const float rows[12],
                                                       masu_detail *detail);

/* Clips: animations from a model's file, which masu-bake stores for movable models. Indices 0 ..
 * count - 1 are the same for all copies of a model. */
#define MASU_CLIP_NONE UINT32_MAX
#define MASU_MAX_CLIP_USES 16u

typedef struct masu_clip_use {
    uint32_t clip; /* index */
    uint32_t loop; /* flag: repeats after its end; 0: holds its first and last pose */
    double time;   /* seconds from its start, finite */
    float weight;  /* relative to the sum of all weights of the call, >= 0 */
} masu_clip_use;

/* Number of clips of a model; 0 for an invalid handle. */
MASU_API uint32_t masu_model_clips(const masu_renderer *renderer, masu_model model);

/* The first clip with that name in the model's file; MASU_CLIP_NONE if there is none. */
MASU_API uint32_t masu_model_clip_find(const masu_renderer *renderer, masu_model model,
                                       const char *name);

/* Duration in seconds; 0 if the clip does not exist. */
MASU_API double masu_model_clip_duration(const masu_renderer *renderer, masu_model model,
                                         uint32_t clip);

/* Poses a model from the next masu_frame on. All nodes that any clip of the model animates get the
 * weighted average of the clips in `uses`, and so do the weights of their morph targets; with a
 * count of 0, or a sum of weights of 0, they get the rest pose of the file. Other nodes do not
 * change. The host advances the times; there is no automatic playback.
 *
 * Skinned meshes follow their nodes in the image, shadows, velocities and traced reflections. The
 * histories of reflections use the motion of the instance, not the deformation. Scenes with skins
 * trace reflections with the built-in BVH; masu_init fails for desc.ray_query MASU_ON.
 *
 * MASU_ERROR_ARGUMENT: a pointer is NULL with a count above 0, the count is above
 * MASU_MAX_CLIP_USES, the model lacks a clip, a time or weight is not finite, a weight is below 0,
 * the transform of a node overflows a float, or the handle is invalid. Nothing has changed then. */
MASU_API MASU_MUST_USE masu_result masu_model_animate(masu_renderer *renderer, masu_model model,
                                                      const masu_clip_use *uses, uint32_t count,
                                                      masu_detail *detail);

/* Sets the weight of a model's morph targets of that name, of all of its meshes, from the next
 * masu_frame on. masu_model_animate replaces the weights of targets that any clip of the model
 * animates; others keep theirs. Before the first call they have the weights of the file.
 * MASU_ERROR_ARGUMENT: a pointer is NULL, the model has no such target, the weight is not within
 * -1e6..1e6, or the handle is invalid. Nothing has changed then. */
MASU_API MASU_MUST_USE masu_result masu_model_morph_set(masu_renderer *renderer, masu_model model,
                                                        const char *name, float weight,
                                                        masu_detail *detail);

/* ---- Live scene: lights ---------------------------------------------------------------------- */

/* Handle of a local light: a point or spot light, or an area light. */
typedef struct masu_punctual_light {
    uint64_t id;
} masu_punctual_light;

/* Shapes of local lights. A point or spot is a sphere of `radius` that has the given radiant
 * intensity. The others are given by their radiance; the camera does not see them. */
typedef enum masu_light_shape {
    MASU_SHAPE_POINT = 0,     /* point or spot */
    MASU_SHAPE_SPHERE = 1,    /* as a point with color * radius^2 */
    MASU_SHAPE_CAPSULE = 2,   /* position +- direction, with hemispheres of `radius` at both ends */
    MASU_SHAPE_RECTANGLE = 3, /* position +- direction +- half_axis; shines towards direction x
                               * half_axis, or both ways. A parallelogram if they are not at right
                               * angles */
    MASU_SHAPE_FORCE_32 = 0x7fffffff
} masu_light_shape;

typedef struct masu_punctual_light_state {
    masu_instance instance; /* that the light is attached to; id 0: none */
    double position[3]; /* metres, world, or object space of `instance`; within 1e15 */
    /* Same space. Spot: direction of the light, of any length. Capsule, rectangle: half axis in
     * metres, 1e-6..1e9 long. */
    float direction[3];
    /* 0..1e9; 0: off. Point, spot: radiant intensity / pi; a white diffuse surface that faces the
     * light at d metres has a radiance of color / d^2, less towards `range`. Other shapes:
     * radiance. */
    float color[3];
    /* Metres, 0..1e15: the light is 0 from this distance to its centre on. At least 6 times the
     * size of an area light, or its near field is cut off. */
    float range;
    /* Of the source, metres, 1e-6..1e9; rectangle with has_surface: half the thickness. */
    float radius;
    uint32_t spot; /* 0: point, 1: spot */
    /* Spot: angles from the direction, radians, 0 <= inner <= outer <= pi: full intensity up to
     * inner, 0 from outer on. A point does not use them, but they are checked. */
    float inner, outer;
    /* Capsules and rectangles, and has_surface, require desc.area_lights or a scene with some. */
    masu_light_shape shape;
    float half_axis[3];  /* rectangle: the other half axis, metres, like `direction` */
    uint32_t two_sided;  /* rectangle: 1: shines both ways */
    /* 1: the light of a surface that the scene has too, which lies within its shape. That surface
     * is not lit by it, and reflection rays that hit it share its mirrored light with it. Lights
     * that masu-bake has fitted have it. Radii scale with their instance then. */
    uint32_t has_surface;
    /* 1: casts no shadows. In a scene without any light that does, none will. */
    uint32_t no_shadow;
} masu_punctual_light_state;

/* The first light with that name in the scene; id 0 if there is none. */
MASU_API masu_punctual_light masu_punctual_light_find(const masu_renderer *renderer,
                                                      const char *name);

/* The light with that index: first those of the scene, in the order of MASU_SCENE_LIGHT, then
 * those of desc.reserve.lights. id 0 after the last one, and for an unused slot. */
MASU_API masu_punctual_light masu_punctual_light_at(const masu_renderer *renderer, uint32_t index);

/* State of a light; initially that of the scene. MASU_ERROR_ARGUMENT: a pointer is NULL, or the
 * handle is invalid. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_get(masu_renderer *renderer,
                                                           masu_punctual_light light,
                                                           masu_punctual_light_state *out,
                                                           masu_detail *detail);

/* Changes a light from the next masu_frame on. MASU_ERROR_ARGUMENT: the handle is invalid, or a
 * value is out of range or not finite. Nothing has changed then. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_set(masu_renderer *renderer,
                                                           masu_punctual_light light,
                                                           const masu_punctual_light_state *state,
                                                           masu_detail *detail);

/* Adds a light from the next masu_frame on, in a slot of desc.reserve.lights. MASU_ERROR_LIMIT: no
 * slot is free. MASU_ERROR_ARGUMENT: as masu_punctual_light_set. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_add(masu_renderer *renderer,
                                                           const masu_punctual_light_state *state,
                                                           masu_punctual_light *out,
                                                           masu_detail *detail);

/* Removes a light that was added. Its handle becomes invalid. MASU_ERROR_ARGUMENT: the handle is
 * invalid, or the light is one of the scene; set the colour of such a light to 0 instead. */
MASU_API MASU_MUST_USE masu_result masu_punctual_light_remove(masu_renderer *renderer,
                                                              masu_punctual_light light,
                                                              masu_detail *detail);

/* ---- Live scene: materials ------------------------------------------------------------------- */

/* Handle of a material. Requires desc.mutable_materials. */
typedef struct masu_material {
    uint64_t id;
} masu_material;

typedef enum masu_material_mode {
    MASU_MATERIAL_OPAQUE = 0,
    /* Alpha-tested: discarded if the alpha of its map is below `cutoff`. */
    MASU_MATERIAL_MASKED = 1,
    MASU_MATERIAL_BLENDED = 2,
    MASU_MATERIAL_ADDITIVE = 3 /* blended: adds its light, occludes nothing */
} masu_material_mode;

/* The factors of a material. A map, if there is one, is multiplied by its factor. */
typedef struct masu_material_state {
    float base_color[3]; /* linear, 0..1 */
    float opacity;       /* 0..1 for blended materials; 1 for others */
    float emissive[3];   /* linear radiance, 0..1e9 */
    float roughness;     /* perceptual, 0..1 */
    float metallic;      /* 0..1 */
    /* 0..1: dielectric reflectance at normal incidence / 0.08; default 0.5. Lobes: read only, to
     * 12.5. */
    float specular;
    float coat;              /* weight of the clear coat, 0..1 */
    float coat_roughness;    /* perceptual, 0..1; unused while `coat` is 0 */
    masu_material_mode mode; /* read only */
    float cutoff;            /* read only */
    /* 1 .. desc.reserve.textures: this texture replaces the base-colour map of the material, its
     * alpha included, and its emission map: a screen has a base colour of 0 and emits. 0: the maps
     * of the scene, initially. Requires a base-colour map, whose coordinates and wrapping it has.
     * Shadows and traced reflections have the maps of the scene. */
    uint32_t texture;
} masu_material_state;

/* The first material with that name in the scene; id 0 if there is none. */
MASU_API masu_material masu_material_find(const masu_renderer *renderer, const char *name);

/* The material with that index, in the order of MASU_SCENE_MATERIAL; id 0 after the last
 * one. */
MASU_API masu_material masu_material_at(const masu_renderer *renderer, uint32_t index);

/* State of a material; initially that of the scene. MASU_ERROR_ARGUMENT: a pointer is NULL, or the
 * handle is invalid. MASU_ERROR_STATE: desc.mutable_materials is 0. */
MASU_API MASU_MUST_USE masu_result masu_material_get(masu_renderer *renderer,
                                                     masu_material material,
                                                     masu_material_state *out, masu_detail *detail);

/* Changes a material from the next masu_frame on: in the image, on transparent surfaces, and in
 * traced reflections, whose histories adapt over some frames. Baked light of probes does not
 * change, a live bounce follows. Whether a rung traces reflections still depends on the original
 * materials.
 *
 * Nothing has changed after an error.
 *   MASU_ERROR_ARGUMENT   as masu_material_get; a value is out of range or not finite; or a member,
 *                         named in the detail, differs that would change a pass, an image or a
 *                         pipeline: `mode`; `cutoff`; `opacity` of a material that is not blended;
 *                         `specular` and `coat` if no opaque material of the scene has a
 *                         specular factor, a clear coat, mesoscale detail or an occlusion map;
 *                         `coat` if no material has a clear coat; `texture` of a material without a
 *                         base-colour map; `metallic` above 0 of a material with a thickness
 *                         (KHR_materials_volume), which stays as it is
 *   MASU_ERROR_LIMIT      `texture` is above desc.reserve.textures
 *   MASU_ERROR_STATE      desc.mutable_materials is 0 */
MASU_API MASU_MUST_USE masu_result masu_material_set(masu_renderer *renderer,
                                                     masu_material material,
                                                     const masu_material_state *state,
                                                     masu_detail *detail);

/* ---- Live scene: textures -------------------------------------------------------------------- */

/* Textures of desc.reserve, which particles, trails, decals and materials show by their numbers, 1
 * to desc.reserve.textures. All are layers of one image: sRGB-encoded red, green and blue, not
 * multiplied by alpha, and alpha; transparent black after masu_load. The image has no mips: shaders
 * average up to 4 x 4 samples per pixel, one for each texel along both axes of the pixel. Textures
 * with up to four texels per pixel are thus filtered without aliasing; those with more alias
 * gradually. */

/* Writes texels from the next masu_frame on, which must be submitted. Copies them into the slot of
 * that frame: call it when the slot is free, as masu_frame. Later writes replace earlier ones.
 *   `rect`        within the texture; NULL: all of it
 *   `texels`      4 bytes each, red, green, blue, alpha, from the upper left corner
 *   `row_bytes`   from one row to the next, a multiple of 4; 0: no gaps
 *
 *   MASU_ERROR_ARGUMENT   a pointer is NULL, the rectangle is empty or not within the texture, or
 *                         row_bytes is too small or not a multiple of 4
 *   MASU_ERROR_LIMIT      `texture` is 0 or above desc.reserve.textures; or since the last frame
 *                         there have been more than desc.reserve.texture_bytes bytes, or more than
 *                         64 calls: write the remainder after the next frame
 *   MASU_ERROR_STATE      masu_load has not finished */
#define MASU_MAX_TEXTURE_WRITES 64u
MASU_API MASU_MUST_USE masu_result masu_texture_write(masu_renderer *renderer, uint32_t texture,
                                                      const VkRect2D *rect, const void *texels,
                                                      uint32_t row_bytes, masu_detail *detail);

/* The image of all textures, for commands of the host that copy, blit or render into it: a video, a
 * mirror, the picture of another camera on a screen. Texture t is array layer t - 1. The host
 * submits them to the same queue between two frames. Its first barrier waits for
 * VK_PIPELINE_STAGE_ALL_COMMANDS_BIT and changes the layout of the layer from `layout`; its last
 * one restores the layout and makes the writes available. The next frame begins with a barrier
 * after all commands. Views of the host need a VkImageViewUsageCreateInfo with the usage below, and
 * may have the format R8G8B8A8_UNORM, for values that are encoded already. */
typedef struct masu_texture_image {
    VkImage image;
    VkFormat format;         /* R8G8B8A8_SRGB */
    VkImageUsageFlags usage; /* SAMPLED, COLOR_ATTACHMENT, TRANSFER_SRC, TRANSFER_DST */
    VkImageLayout layout;    /* SHADER_READ_ONLY_OPTIMAL */
    uint32_t width, height, layers;
} masu_texture_image;

/* Fills `*out`. MASU_ERROR_ARGUMENT: a pointer is NULL. MASU_ERROR_STATE: masu_load has not
 * finished, or desc.reserve.textures is 0. */
MASU_API MASU_MUST_USE masu_result masu_texture_image_of(const masu_renderer *renderer,
                                                         masu_texture_image *out,
                                                         masu_detail *detail);

/* ---- Queries: scene -------------------------------------------------------------------------- */

/* The functions below describe what the blob contains; room that masu_desc.reserve adds is not
 * counted. They take constant time unless stated otherwise. Functions that read the blob need it to
 * be readable and unchanged. `scene` may be NULL: the result is then 0, -1 or "". */

typedef enum masu_scene_item {
    MASU_SCENE_INSTANCE = 0,
    MASU_SCENE_MODEL = 1, /* movable models, the scene's pooled copies included */
    MASU_SCENE_LIGHT = 2, /* punctual lights */
    MASU_SCENE_MATERIAL = 3,
    MASU_SCENE_SDF_PARAM = 4, /* run-time parameters of the SDF */
    MASU_SCENE_CAMERA_KEY = 5 /* keys of the camera path; they have no names */
} masu_scene_item;

/* Number of items of a kind; their indices are 0 to the result - 1. 0 for an unknown kind. */
MASU_API uint32_t masu_scene_count(const masu_scene *scene, masu_scene_item item);

/* Name of an item, "" if it has none or does not exist. Reads the blob and points into it. */
MASU_API const char *masu_scene_name(const masu_scene *scene, masu_scene_item item, uint32_t index);

/* Index of the first item with that name; -1 if there is none, or if `name` is NULL or "". Reads
 * the blob; takes time proportional to the number of items. */
MASU_API int32_t masu_scene_find(const masu_scene *scene, masu_scene_item item, const char *name);

/* Number of animation clips of a model, 0 if the model does not exist; and the name of a clip, as
 * masu_scene_name. Both read the blob and take time proportional to the clips of all models. */
MASU_API uint32_t masu_scene_clip_count(const masu_scene *scene, uint32_t model);
MASU_API const char *masu_scene_clip_name(const masu_scene *scene, uint32_t model, uint32_t clip);

/* Default value of an SDF parameter. `minimum`, `maximum`: NULL, or receive the range to which
 * masu_frame_desc.sdf_params is clamped. All are 0 if there is no such parameter. Reads the
 * blob. */
MASU_API float masu_scene_sdf_range(const masu_scene *scene, uint32_t index, float *minimum,
                                    float *maximum);

typedef enum masu_scene_feature_bits {
    MASU_SCENE_HAS_SDF = 1,
    MASU_SCENE_HAS_DYNAMIC_SDF = 2, /* the SDF depends on parameters or time */
    MASU_SCENE_HAS_SHADOW_MAP = 4,  /* polygons cast sun shadows */
    MASU_SCENE_HAS_REFLECTIONS = 8, /* traced ones, if a surface is smooth enough: see the class */
    MASU_SCENE_HAS_TRANSPARENTS = 16,
    MASU_SCENE_HAS_ANALYTIC_SKY = 32, /* the sky follows from the sun */
    MASU_SCENE_HAS_FOG = 64,
    MASU_SCENE_HAS_METERED_EXPOSURE = 128, /* the default of masu_exposure.metered is ON */
    MASU_SCENE_HAS_DEFAULT_AA = 256        /* the default rungs use anti-aliasing */
} masu_scene_feature_bits;

/* The features that the scene uses: MASU_SCENE_HAS_*. */
MASU_API uint32_t masu_scene_features(const masu_scene *scene);

/* Triangles of all instances at the finest level of detail. */
MASU_API uint64_t masu_scene_triangles(const masu_scene *scene);

/* Bytes of all texels with their mips, without padding. compressed: 1 as BC blocks, 0 decoded, for
 * a device without textureCompressionBC. */
MASU_API uint64_t masu_scene_texture_bytes(const masu_scene *scene, int compressed);

/* Cascades of the sun's shadow map, 0 to MASU_MAX_CASCADES; 0: no shadow map. `resolution`: NULL,
 * or receives the texels along an edge of a cascade. They are what 0 stands for in
 * rung.shadow_cascades and rung.shadow_resolution, and their upper bounds. */
MASU_API uint32_t masu_scene_shadow_cascades(const masu_scene *scene, uint32_t *resolution);

/* Distance from the camera up to which the shadow map reaches, metres: what 0 stands for in
 * rung.shadow_distance. 0: no shadow map. */
MASU_API float masu_scene_shadow_distance(const masu_scene *scene);

/* Perceptual roughness, 0..1, from which on reflections are not traced: what 0 stands for in
 * rung.specular_cutoff. 0 without MASU_SCENE_HAS_REFLECTIONS. */
MASU_API float masu_scene_specular_cutoff(const masu_scene *scene);

/* The smallest masu_limits (masu_knobs.h) that accept the scene, with default rungs and no reserve.
 * `texture_bytes` is the size of decoded texels; a device with textureCompressionBC needs less. All
 * members are 0 if `scene` is NULL. */
MASU_API void masu_scene_usage(const masu_scene *scene, masu_limits *out);

/* Classes of scenes by content. Those without a measured ladder (masu_desc.ladder) use the nearest
 * one's. A world is a scene of polygons with LODs and occluders. */
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

/* The class of a scene; MASU_SCENE_POLYGONS for NULL. */
MASU_API masu_scene_class masu_scene_class_of(const masu_scene *scene);

/* Name of a class, "world-traced" for example. Never NULL. */
MASU_API const char *masu_scene_class_name(masu_scene_class scene_class);

/* The camera of the scene's path at `time`, in seconds; before the start and after the end the
 * first and the last camera. MASU_ERROR_STATE: the scene has no camera. MASU_ERROR_ARGUMENT: a
 * pointer is NULL, or `time` is not finite. */
MASU_API MASU_MUST_USE masu_result masu_camera_at(const masu_renderer *renderer, double time,
                                                  masu_camera *out, masu_detail *detail);

/* The light of the scene, which a host can change and pass to masu_frame. Its sun_color is all zero
 * if an analytic sky provides the colour. MASU_ERROR_STATE: there is no scene.
 * MASU_ERROR_ARGUMENT: a pointer is NULL. */
MASU_API MASU_MUST_USE masu_result masu_light_of(const masu_renderer *renderer, masu_light *out,
                                                 masu_detail *detail);

/* ---- Queries: plan and memory ---------------------------------------------------------------- */

typedef struct masu_plan_pass {
    /* Also the file name of the shader, the debug label and the timestamp's name. */
    const char *name;
    uint32_t active; /* one bit per rung: bit r is 1 if the pass runs in rung r */
    const char *why; /* why the pass runs, or does not */
    const char *reads[12];
    const char *writes[6];
    uint64_t pipeline_ns; /* creation time of its pipeline in masu_init, ns; 0: no clock, or from
                             masu_plan */
} masu_plan_pass;

typedef struct masu_plan_image {
    const char *name;
    VkFormat format;
    uint32_t width, height; /* as allocated, for the largest rung */
    uint32_t used;          /* 0: not part of this plan */
    uint64_t bytes, offset; /* in the device role */
    uint32_t first_pass, last_pass;
    uint32_t layers; /* 2: a ping-pong pair; a frame writes one layer and reads that of the previous
                        frame */
} masu_plan_image;

typedef struct masu_plan_rung {
    uint32_t render_width, render_height; /* pixels */
    uint32_t dispatches;                  /* per frame; a graphics or transfer pass counts 1 */
    uint32_t barriers;                    /* per frame, from the recording; 0 from masu_plan */
    /* Relative time and FLIP error, from governor.costs and flips or the built-in ladder; 0:
     * unknown. */
    float ratio, flip;
} masu_plan_rung;

typedef struct masu_plan_info {
    uint32_t pass_count, image_count, rung_count;
    masu_plan_pass passes[MASU_MAX_PASSES]; /* every row of the pass table, in order */
    masu_plan_image images[MASU_MAX_RESOURCES];
    masu_plan_rung rungs[MASU_MAX_RUNGS];
    /* Class of GPUs, by vendor and device id, whose instruction counts gave the ratios of the
     * built-in ladder: "Xe80", "UHD620", "Vega8", "Deck", "low mobile". "": their mean, or
     * the host's. */
    const char *computed_for;
    masu_memory memory;
    uint64_t saved_bytes; /* bytes of the images that this plan does not need */
} masu_plan_info;

/* The compiled frame of a description, without a renderer. Errors as masu_memory_query. */
MASU_API MASU_MUST_USE masu_result masu_plan(const masu_desc *desc, masu_plan_info *out,
                                             masu_detail *detail);

/* As masu_plan, for an existing renderer, with creation times of pipelines. */
MASU_API void masu_plan_of(const masu_renderer *renderer, masu_plan_info *out);

/* A row of the memory plan. */
typedef struct masu_memory_row {
    const char *name;
    const char *kind; /* "host", "buffer", "texture" (an array of textures), "image" */
    masu_role role;   /* of device rows */
    uint64_t count;   /* elements, or texels of an image */
    uint64_t bytes;   /* total */
    uint64_t alignment;
    uint64_t offset; /* in its block, bytes */
    /* 1: needed from first_pass to last_pass only, may share its memory with other rows. A
     * transient buffer is needed during masu_load only, and may share its memory with any transient
     * image. */
    uint32_t transient;
    uint32_t first_pass, last_pass; /* indices into masu_plan_info.passes */
} masu_memory_row;

/* Writes at most `capacity` rows of the renderer's memory plan, host rows first; none if `rows` is
 * NULL. Returns the total number of rows. */
MASU_API uint32_t masu_memory_report(const masu_renderer *renderer, masu_memory_row *rows,
                                     uint32_t capacity);

/* The numbers of items in the renderer, which can be used as masu_limits. */
MASU_API void masu_peaks(const masu_renderer *renderer, masu_peak_info *out);

typedef struct masu_pipelines_info {
    uint32_t count; /* pipelines in the pool */
    uint32_t used;  /* of these, in use by renderers */
    /* By all masu_init calls so far: pipelines created, and taken from the pool. */
    uint32_t created, reused;
    uint32_t evicted; /* destroyed to make room */
} masu_pipelines_info;

/* The counts of a pool; all 0 if `pipelines` is NULL. */
MASU_API void masu_pipelines_info_of(const masu_pipelines *pipelines, masu_pipelines_info *out);

/* ---- Queries: governor ----------------------------------------------------------------------- */

/* Why the rung was selected. */
typedef enum masu_governor_reason {
    MASU_GOVERNOR_REASON_NONE = 0,      /* there is no governor */
    MASU_GOVERNOR_REASON_START = 1,     /* no frame has been measured yet */
    MASU_GOVERNOR_REASON_HOLD = 2,      /* the rung meets the target, and no better rung would */
    MASU_GOVERNOR_REASON_BEST = 3,      /* the best rung meets the target */
    MASU_GOVERNOR_REASON_WAIT = 4,      /* a better rung fits, but the last change is too recent */
    MASU_GOVERNOR_REASON_DOWN = 5,      /* the previous rung was predicted to miss the target */
    MASU_GOVERNOR_REASON_JUMP = 6,      /* the load has jumped: the previous rung is too slow */
    MASU_GOVERNOR_REASON_EMERGENCY = 7, /* two frames in a row have missed the target */
    MASU_GOVERNOR_REASON_UP = 8,        /* this better rung is predicted to meet the target */
    MASU_GOVERNOR_REASON_WORST = 9,     /* no rung meets the target: the cheapest one is used */
    MASU_GOVERNOR_REASON_NO_GAIN = 10,  /* cheaper rungs save no time, or a survey measures it */
    MASU_GOVERNOR_REASON_STALE = 11,    /* no recent measurements: the rung is kept */
    MASU_GOVERNOR_REASON_FIXED = 12,    /* the rung is fixed */
    MASU_GOVERNOR_REASON_HOST = 13,     /* the host has selected the rung */
    MASU_GOVERNOR_REASON_EXCLUDED = 14, /* the frame is excluded from timing: the rung is kept */
    /* trial of a better rung: does the clock follow the load? */
    MASU_GOVERNOR_REASON_TRIAL = 15,
    MASU_GOVERNOR_REASON_FORCE_32 = 0x7FFFFFFF
} masu_governor_reason;

/* The clock that the governor currently uses. */
typedef enum masu_governor_source {
    MASU_GOVERNOR_SOURCE_NONE = 0, /* no plausible clock */
    MASU_GOVERNOR_SOURCE_GPU = 1,  /* timestamps, checked against wall-clock time if available */
    MASU_GOVERNOR_SOURCE_WALL = 2  /* the host's clock: timestamps are missing or implausible */
} masu_governor_source;

/* Why the governor cannot reach the rung that it needs. */
typedef enum masu_governor_lock {
    MASU_GOVERNOR_FREE = 0,
    MASU_GOVERNOR_LOCKED_FIXED = 1,   /* the range contains one rung only */
    MASU_GOVERNOR_LOCKED_WORST = 2,   /* the cheapest rung misses the target */
    MASU_GOVERNOR_LOCKED_NO_GAIN = 3, /* over the target, and the rungs hardly differ in time */
    MASU_GOVERNOR_LOCKED_STALE = 4,   /* there are no recent samples */
    MASU_GOVERNOR_LOCKED_CPU = 5      /* CPU bound: the host's own work exceeds the target, so the
                                         rung is kept */
} masu_governor_lock;

/* The state of the governor. */
typedef struct masu_governor_info {
    masu_governor_mode mode;
    uint32_t rung; /* of the frame that masu_frame returned last */
    masu_governor_reason reason;
    const char *reason_text; /* in English, static, never NULL */
    masu_governor_lock locked;
    masu_governor_source source;
    uint32_t rung_count;
    float predicted_ms[MASU_MAX_RUNGS]; /* of a frame like the last one in each rung; 0: unknown */
    float target_ms;
    /* The model: frame time = fixed_ms + load_ms * (cost of the rung). */
    float fixed_ms;
    float load_ms;     /* at cost 1 */
    float slope_ms;    /* change of load_ms per frame */
    float noise;       /* relative standard deviation of one frame time */
    float overhead_ms; /* wall-clock time outside the timestamps; included in the predictions */
    float unit;        /* factor on GPU times; not 1 if the unit of the timestamps is wrong */
    /* Frame pacing: a frame of this rung that is submitted this long after its interval has begun
     * is predicted to end within the interval. A host that reads its input only after this time has
     * a lower latency. The interval is target_ms, or `refreshes` refreshes if refresh_ms is not
     * 0. */
    float start_delay_ms;
    /* Frame times used; frame times rejected as implausible, or excluded
     * (frame.exclude_from_timing). */
    uint64_t samples, rejected;
    /* Used frame times above the target. If refresh_ms is not 0: frames that were presented more
     * than half a refresh late. */
    uint64_t missed;
    uint64_t changes; /* of the rung */
    /* The host's work per frame (masu_frame_times), without outliers; 0: unknown. */
    float cpu_ms;
    float refresh_ms; /* refresh interval of the display (masu_frame_presented); 0: unknown */
    /* Number of refreshes, 1..16, for which the host should present this frame: the smallest number
     * that the predicted frame time and the host's work fit into, and at least target_ms. It rises
     * after 4 frames in a row that do not fit, or 4 late ones of 16. It falls by one after 60
     * frames that would fit, later after a failed fall. 0: refresh_ms is unknown. */
    uint32_t refreshes;
    /* Wall-clock times are whole multiples of this: the host waits for the display's refresh before
     * it measures, so they hide how much of a refresh a frame needs. 0: not detected. Pass the time
     * at which the GPU finished (masu_frame_times), or enable timestamps. */
    float vsync_ms;
} masu_governor_info;

/* The meaning of a reason, in English, without a newline. Never NULL. */
MASU_API const char *masu_governor_reason_string(masu_governor_reason reason);

/* ---- Queries: statistics, readback and picking ----------------------------------------------- */

/* Culling statistics of one view. */
typedef struct masu_view_stats {
    uint64_t groups;                      /* groups of instances tested */
    uint64_t plane_tests;                 /* tests of a group or an instance against a plane */
    uint64_t instances, draws, triangles; /* visible after frustum culling */
    uint64_t occluders;                   /* rendered */
    /* With debug.counters, if occlusion culling is on: */
    uint64_t visible_instances, visible_triangles; /* not occluded */
} masu_view_stats;

typedef struct masu_stats_info {
    uint64_t frame; /* number of the slot's last frame; UINT64_MAX: none yet */
    uint32_t rung;
    uint32_t pass_count;
    const char *pass_names[MASU_MAX_PASSES];
    uint64_t pass_ns[MASU_MAX_PASSES]; /* with debug.timestamps; 0 for inactive passes */
    uint64_t gpu_ns; /* first to last timestamp, with debug.timestamps or a governor */
    uint32_t timed;  /* 1: the times above are valid */
    /* SDF, with debug.counters: */
    uint64_t sdf_evals;       /* SDF evaluations of sphere tracing */
    uint64_t sdf_hits;        /* pixels whose closest surface is the SDF */
    uint64_t sdf_unconverged; /* rays that reached march_steps */
    /* SDF evaluations of SDF shadows and SDF ambient occlusion. */
    uint64_t shadow_evals, occlusion_evals;
    uint64_t shadow_unconverged; /* shadow rays that reached their step limit */
    uint64_t replaced;           /* non-finite pixel components that were replaced; should be 0 */
    uint64_t draws;              /* G-buffer draws with instances, before occlusion culling */
    uint64_t triangles;          /* in `draws`; with debug.counters after occlusion culling */
    uint64_t transparents;       /* transparent primitives drawn, each with its own draw */
    /* Entries of this frame that were drawn: not skipped, and not culled against the view. */
    uint32_t particles, decals, lines, trail_segments;
    uint64_t occlusion_tests; /* with debug.counters */
    /* Punctual lights of the scene; those whose bounding sphere intersects the view. */
    uint32_t lights, lights_in_view;
    /* Punctual lights, with debug.counters: pairs of light and pixel tested, those with a
     * contribution, and 16x16 tiles with more than 63 lights, whose pixels test all lights. */
    uint64_t light_tests, light_shaded, light_tiles_full;
    /* Shadows of punctual lights: lights that have them, faces rendered in this frame, and faces
     * that are not up to date because local_shadow_faces were rendered already. */
    uint32_t local_shadow_lights, local_shadow_faces, local_shadow_waiting;
    /* Live bounce: rounds of all probes until it rests, 64 after a change; below 56 most light has
     * arrived. 0: it rests, or there is none. */
    uint32_t bounce_rounds_left;
    /* Traced reflections, with debug.counters: number of 8x8 tiles with rays, rays, rays that hit a
     * polygon, rays that hit the SDF, BVH nodes visited, SDF evaluations. */
    uint64_t specular_tiles, specular_rays, specular_hits, specular_sdf_hits;
    uint64_t specular_nodes, specular_evals;
    /* Rungs[].easu FAST, with debug.counters: uniform 8x8 blocks of the output that skip the
     * filter. 0 without a scene. */
    uint64_t easu_tiles_early;
    uint64_t smaa_tiles; /* with debug.counters: 16x16 tiles that SMAA has blended */
    float exposure; /* auto-exposure factor before the tone curve, with debug.counters; else 0 */
    uint32_t view_count;
    masu_view_stats views[MASU_MAX_VIEWS]; /* 0: the camera */
    masu_governor_info governor; /* at the frame that masu_frame returned last, in any slot */
} masu_stats_info;

/* Statistics of the slot's last frame. Call it after the wait for the slot's fence and before the
 * slot is used again. Between masu_frame and that point `frame`, `rung` and the numbers that the
 * CPU counts (draws, lights, views) belong to the frame that was returned, and the data that the
 * GPU writes (times, counters, images) to no particular frame. The function reads memory only and
 * cannot check fences: the library detects the end of a frame by its timestamps (debug.timestamps,
 * or a governor that uses them).
 *   MASU_ERROR_ARGUMENT   the slot does not exist, or a pointer is NULL
 *   MASU_INCOMPLETE       the slot has not been used yet; or there are timestamps, and the frame
 *                         has not ended or was never submitted: only its `frame` and `rung` are
 *                         valid */
MASU_API masu_result masu_stats(const masu_renderer *renderer, uint32_t slot, masu_stats_info *out,
                                masu_detail *detail);

typedef struct masu_readback_image {
    const void *pixels;     /* valid until the slot is used again */
    uint32_t width, height; /* pixels */
    uint64_t row_bytes;
    VkFormat format;
} masu_readback_image;

/* An image of the slot's last frame, from desc.readback. Call it at the same point as masu_stats.
 * MASU_ERROR_ARGUMENT: the image is not in desc.readback, the slot does not exist, or a pointer is
 * NULL. MASU_INCOMPLETE: as masu_stats. */
MASU_API masu_result masu_readback(const masu_renderer *renderer, uint32_t slot,
                                   masu_readback_bits which, masu_readback_image *out,
                                   masu_detail *detail);

/* Kind of object at a pixel. */
typedef enum masu_pick_kind {
    MASU_PICK_NOTHING = 0, /* the frame had no query */
    MASU_PICK_SKY = 1,
    MASU_PICK_SDF = 2,
    MASU_PICK_INSTANCE = 3
} masu_pick_kind;

typedef struct masu_pick_info {
    masu_pick_kind kind;
    uint64_t frame; /* of the query */
    uint32_t x, y;  /* pixel of the query */
    /* MASU_PICK_INSTANCE: the instance; id 0, rarely, for polygons below the precision of
     * rasterisation, and for a copy that was removed after the query. The movable model and the
     * index of its node; id 0 and MASU_NODE_NONE for other instances. */
    masu_instance instance;
    masu_model model;
    uint32_t node;
    /* Near_distance / view depth, as MASU_READBACK_DEPTH but with transparent surfaces; 0 for the
     * sky. */
    float depth;
    double position[3]; /* of the surface point, world, metres; 0 for the sky */
} masu_pick_info;

/* The object at the pixel that the slot's last frame has queried (masu_frame_desc.pick). Picking
 * has the precision of the G-buffer: it passes through the holes of alpha-tested materials (with
 * rung.temporal, for moving objects, to within a pixel), and uses the drawn LOD and the deformed
 * skin. A transparent surface is picked before the surfaces behind it at any opacity; one with
 * textures only if the alpha of its base colour is 0.5 or more. In rungs of another scale it uses
 * the render pixel that contains the centre of the output pixel, with temporal or camera.jitter at
 * its jittered sample position. Call it at the same point as masu_stats. MASU_ERROR_ARGUMENT:
 * desc.picking is 0, the slot does not exist, or a pointer is NULL. MASU_INCOMPLETE: as
 * masu_stats. */
MASU_API masu_result masu_pick(const masu_renderer *renderer, uint32_t slot, masu_pick_info *out,
                               masu_detail *detail);

/* Unpacks a texel of MASU_READBACK_NORMAL to a unit vector in world space. */
MASU_API void masu_unpack_normal(uint32_t texel, float out[3]);

#ifdef __cplusplus
}
#endif

#endif
