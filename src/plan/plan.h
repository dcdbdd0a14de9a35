/* plan.h: the compiled plan of a description: passes.inc, images.inc and buffers.inc as data
 * (compile.h). src/device/memory.c adds the sizes that only the driver can compute. Owned by the
 * renderer; the functions here cannot fail. */
#ifndef MASU_PLAN_H
#define MASU_PLAN_H

#include "plan/frame_plan.h"
#include "plan/limits.h"
#include "plan/reserve.h"
#include "shared/meshes.h"
#include "scene/scene.h"
#include "masu.h"

/* Timestamps per frame: one before the first pass and one after each pass; for the governor only
 * the first and the last; or none. */
static inline uint32_t masu_stamps(const masu_desc *d) {
    if (d->debug.timestamps) return MASU_PASS_COUNT + 1;
    return d->governor.mode && !d->governor.wall_only ? 2 : 0;
}

typedef struct masu_image_plan {
    int used;
    int persistent;         /* content outlives the frame: shares memory with nothing */
    uint32_t width, height; /* as allocated, for the largest rung */
    VkImageUsageFlags usage;
    uint32_t first, last; /* first and last row of the table at which it is live, over all rungs */
    uint64_t bytes, alignment, offset; /* offset in the memory block of the device role */
    uint32_t type_bits;
} masu_image_plan;

typedef struct masu_rung_plan {
    uint32_t render_width, render_height;
    uint32_t cascades, cascade_size; /* of the shadow map; 0: none */
    uint32_t slow;                   /* bit per cascade that is not rendered in every frame */
    /* Per target, one recording for each set of slow cascades, with and without shadow faces of
     * local lights. The last one draws all. */
    uint32_t variants, first_recording;
    int faces; /* the rung may render shadow faces */
    masu_pass_set active;
    uint32_t access_count[MASU_PASS_COUNT];
    masu_access access[MASU_PASS_COUNT][MASU_PASS_ACCESSES]; /* without stand-ins */
    uint32_t barriers;                                       /* counted while recording */
} masu_rung_plan;

typedef struct masu_buffer_plan {
    const char *name;
    masu_role role;
    VkBufferUsageFlags usage;
    uint64_t bytes;  /* 0: not used */
    uint64_t stride; /* bytes between the slots of frames in flight; 0: one slot */
    uint64_t count;  /* elements, for the report */
    uint64_t memory_bytes, alignment, offset; /* offset in the memory block of its role */
    uint32_t type_bits;
} masu_buffer_plan;

typedef struct masu_block_plan {
    uint64_t bytes, alignment;
    uint32_t type_bits, type;
    int host_visible; /* mapped for the lifetime of the renderer */
    int address;      /* contains a buffer with a device address */
} masu_block_plan;

#define MASU_READBACK_IMAGES 7u
#define MASU_DRAW_BYTES 20u /* of a VkDrawIndexedIndirectCommand */

/* The occluder atlas has one part for the camera and one that all views of the sun share. */
#define MASU_ATLAS_PARTS(plan) ((plan)->views > 1 ? 2u : 1u)
/* Byte offsets in a slot of MASU_BUFFER_DRAWS: the draws of a view after culling stage 1 or 2, and
 * the draw of the occluders of a part of the atlas. */
#define MASU_DRAWS_OF(plan, view, stage2)                                                          \
    (((uint64_t)(view) + ((stage2) ? (plan)->views : 0)) * (plan)->draws * MASU_DRAW_BYTES)
#define MASU_OCCLUDER_DRAW(plan, part)                                                             \
    (MASU_DRAWS_OF(plan, (plan)->views, 1) + (uint64_t)(part)*MASU_DRAW_BYTES)

/* Offsets in a slot of MASU_BUFFER_DRAWN, in 32-bit values; layout in masu_shared.h. Without
 * occlusion culling there are only the lists of stage 1. */
typedef struct masu_drawn_plan {
    uint64_t header, lists, kept, batches, large, boxes, occluders, pairs, transparents, picks,
        faces, words;
} masu_drawn_plan;

/* Offsets of the three kinds of sprites in a slot of MASU_BUFFER_SPRITES, and the size of a
 * particle and a decal, in vec4; layout in masu_shared.h. */
typedef struct masu_sprites_plan {
    uint64_t particles, lines, decals, end;
    uint32_t particle, decal;
} masu_sprites_plan;

/* A texture array on the device. A renderer's plan has them in the host memory block; a plan that
 * is only queried has them on the stack. */
typedef struct masu_texture_plan {
    VkImage image;
    VkImageView view;
    VkFormat format;
    uint64_t bytes, alignment, offset; /* offset in the memory block of the device role */
    uint32_t type_bits;
    uint32_t layers;
} masu_texture_plan;

typedef struct masu_frame_plan {
    masu_desc desc; /* resolved; `scene` points to the copy below, or is NULL */
    masu_scene_data scene; /* including the reserve: */
    masu_reserve_plan reserve;
    VkExtent2D whole; /* output size of the targets; desc.output: of the selected viewport */
    /* output size that images are allocated for: desc.output before any masu_resize */
    VkExtent2D most;
    masu_needs needs; /* of the scene; upscale and sharpen: of the last rung processed */
    masu_rung_plan rungs[MASU_MAX_RUNGS];
    const char *why[MASU_PASS_COUNT]; /* from the first rung that runs the pass, else from rung 0 */
    masu_image_plan images[MASU_IMAGE_COUNT];
    masu_buffer_plan buffers[MASU_BUFFER_COUNT];
    masu_block_plan blocks[MASU_ROLE_COUNT];
    masu_texture_plan *textures; /* scene.texture_arrays elements */
    int compressed;              /* textures remain block-compressed on the device */
    int unified;
    /* the host cannot write resident buffers, so they are uploaded through the staging buffer */
    int staged;
    uint64_t transient_offset; /* of the transient images in the memory block of the device role */
    uint64_t transient_unaliased, transient_aliased, transient_lower_bound;
    /* Offsets in a readback slot: counters, then timestamps, then images in the bit order of
     * masu_readback_bits. */
    uint64_t readback_times, readback_offset[MASU_READBACK_IMAGES];
    uint32_t views;     /* views for which instances are culled: camera and cascades */
    int occlusion;      /* a rung has occlusion culling */
    int lods;           /* a rung draws LODs */
    int deep; /* colour after the tone curve is stored as 16-bit floats, else with 10 bits */
    /* GPU class of the ladder's costs; "": as measured, or given by the host */
    const char *computed_for;
    int copies; /* targets are filled by a copy of bytes instead of a blit */
    struct masu_output_plan {
        uint32_t steps[3]; /* of red, green, blue: values that passes round to; 0: no rounding */
        uint32_t flags;    /* MASU_OUTPUT_* of the last pass */
    } output;
    /* draws per view; 32-bit values of a view's lists, one list per batch */
    uint32_t draws, listed;
    masu_drawn_plan drawn;
    masu_sprites_plan sprites;
    uint64_t transparent_draws; /* in MASU_BUFFER_DRAWS: first draw of transparent items */
    uint64_t pick_draws;        /* first draw of picking */
    uint64_t face_draws;        /* first draw of the shadow faces */
    uint64_t receiver_mask;     /* in MASU_BUFFER_SEEN: first 32-bit value of receivers; 0: none */
    uint32_t pass_sets; /* descriptor sets of set 1 over all rungs and targets */
    /* maximum number of targets: more than at present only with desc.resizable */
    uint32_t targets_max;
    uint32_t recordings; /* per frame in flight: viewports, their rungs, targets and variants */
    uint32_t viewport_recordings; /* of one viewport */
    uint32_t parts;               /* command buffers per recording: 1, plus 1 per split point */
    uint32_t cascades, cascade_size; /* of the shadow map: maximum over all rungs */
    /* Shadows of local lights, maximum over all rungs: faces rendered per frame, shadowed lights of
     * all viewports, texels along an edge of the atlas and of its largest tile. 0: none. */
    uint32_t local_faces, local_lights, local_atlas, local_tile;
} masu_frame_plan;

/* Rounds v up to a multiple of a, which need not be a power of two. */
static inline uint64_t masu_align_up(uint64_t v, uint64_t a) { return (v + a - 1) / a * a; }

/* Sets the render sizes for another output size of at most plan->most. Passes, images and buffers
 * do not change. */
void masu_plan_resize(masu_frame_plan *plan, VkExtent2D output);
/* The same for the size of a viewport, or for the whole output if there are no viewports. */
void masu_plan_select_viewport(masu_frame_plan *plan, uint32_t viewport);
/* Bytes of MASU_BUFFER_JOINTS for one frame: a header per skin and per mesh of the host, whose BVHs
 * are refitted alike; then the matrices. */
#define MASU_SKIN_HEADER_BYTES 32u
static inline uint64_t masu_skin_headers(const masu_scene_data *s) {
    return (s->skins + (uint64_t)s->host_meshes) * MASU_SKIN_HEADER_BYTES;
}
/* Byte offset of the morph weights: an element per skin, then one per target. */
static inline uint64_t masu_morphs_at(const masu_scene_data *s) {
    return masu_skin_headers(s) + s->skinned_joints * (uint64_t)48;
}
static inline uint64_t masu_joints_bytes(const masu_scene_data *s) {
    uint64_t morphs =
        s->skin_targets ? (uint64_t)16 * s->skins + (uint64_t)16 * s->skin_targets : 0;
    return masu_morphs_at(s) + morphs;
}
/* Byte offset of the jobs' data in a slot of MASU_BUFFER_MESH_UPLOAD (shaders/shared/meshes.h). */
static inline uint64_t masu_mesh_data_at(const masu_scene_data *s) {
    return 16 * (1 + (uint64_t)MASU_MESH_JOB_UVEC4 * s->host_meshes);
}

/* Bytes of a slot of MASU_BUFFER_LIVE_MATERIALS: all materials, then, with ray tracing, all in the
 * layout for ray hits. */
static inline uint64_t masu_live_material_bytes(const masu_frame_plan *p) {
    return p->scene.materials *
           (sizeof(struct masu_material_data) +
            (p->needs.traced ? sizeof(struct masu_trace_material) : 0));
}

/* Counts of the blob, without the reserve. */
/* With looks, the instance that the looks begin at in the buffer of transforms: a multiple of 8. */
static inline uint32_t masu_look_capacity(uint32_t instances) { return (instances + 7u) & ~7u; }

static inline uint32_t masu_own_instances(const masu_frame_plan *p) {
    return p->scene.instances - p->reserve.places.instances;
}
static inline uint32_t masu_own_models(const masu_frame_plan *p) {
    return p->scene.models - p->reserve.models - p->reserve.meshes;
}
static inline uint32_t masu_own_meshes(const masu_frame_plan *p) {
    return p->scene.meshes - p->reserve.meshes;
}
/* The first of each that belongs to desc.reserve.meshes; one per slot, the last ones. */
static inline uint32_t masu_mesh_models(const masu_frame_plan *p) {
    return p->scene.models - p->reserve.meshes;
}
static inline uint32_t masu_mesh_instances(const masu_frame_plan *p) {
    return p->scene.instances - p->reserve.meshes;
}
static inline uint32_t masu_mesh_traced(const masu_frame_plan *p) {
    return p->scene.trace_instances - (p->scene.host_nodes ? p->reserve.meshes : 0);
}
static inline uint32_t masu_own_nodes(const masu_frame_plan *p) {
    return p->scene.model_nodes - p->reserve.places.nodes;
}
static inline uint32_t masu_own_lights(const masu_frame_plan *p) {
    return p->scene.lights - p->reserve.lights;
}
static inline uint32_t masu_own_transparents(const masu_frame_plan *p) {
    return p->scene.transparents - p->reserve.places.transparents;
}
static inline uint32_t masu_own_traced(const masu_frame_plan *p) {
    return p->scene.trace_instances - p->reserve.places.traced;
}

/* Position of a cascade in the shadow map, at the allocated size. */
VkOffset2D masu_cascade_place(const masu_frame_plan *plan, uint32_t cascade);
/* Position of the square of one of the frame's shadow faces of local lights. */
VkOffset2D masu_local_face_place(const masu_frame_plan *plan, uint32_t face);
/* Bit number of the shadow faces of local lights, after those of the cascades, in the mask of the
 * passes that a frame draws. */
#define MASU_DRAWN_FACES MASU_CASCADES_MAX
/* Index of the variant that draws `drawn`, a bit mask of cascades and MASU_DRAWN_FACES. Uses only
 * the bits of passes that the rung may skip. */
uint32_t masu_recording_variant(const masu_rung_plan *rung, uint32_t drawn);
/* Whether a variant of a rung's recordings draws a cascade, or MASU_DRAWN_FACES. */
int masu_variant_draws(const masu_rung_plan *rung, uint32_t variant, uint32_t what);
/* Whether a pass reads an image in any rung that runs it. */
int masu_reads(const masu_frame_plan *plan, uint32_t pass, masu_image_id image);
/* The first rung that runs a pass, or NULL. It represents all these rungs: they may bind different
 * images, but their number and kind are the same. */
const masu_rung_plan *masu_first_rung(const masu_frame_plan *plan, uint32_t pass);
/* Size of an image, or of a pass in a rung. */
VkExtent2D masu_plan_extent(const masu_frame_plan *plan, masu_image_extent extent,
                            VkExtent2D render);
/* Format of an image in this plan, and of the view that shaders store through, which differs if not
 * every device supports storing to the former. */
VkFormat masu_plan_format(const masu_frame_plan *plan, uint32_t image);
VkFormat masu_plan_store_format(const masu_frame_plan *plan, uint32_t image);
uint32_t masu_plan_layers(const masu_frame_plan *plan, uint32_t image);
/* Whether temporal histories are stored as half floats instead of 16-bit unorm: if the device
 * cannot filter the latter, or if the target exceeds white, where a step of 1/65535 of its peak is
 * visible in the dark. */
int masu_has_half_means(const masu_frame_plan *plan);
/* Whether a compute pass writes the final image of a rung: the target, or the image that is blitted
 * to it. */
int masu_comes_last(const masu_rung_plan *rung, uint32_t pass);

/* Bytes per texel of the formats in the table. */
uint32_t masu_format_bytes(VkFormat format);
static inline int masu_is_depth(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
}

/* Whether the G-buffer pass draws emitting materials in a second subpass, the only one with hdr
 * attached. If materials may start to emit at run time, all are drawn in one subpass with hdr. */
static inline int masu_has_emission_subpass(const masu_frame_plan *plan) {
    return plan->needs.emissive && !plan->desc.mutable_materials;
}

#endif
