/* plan.h: the compiled frame as data: what passes.inc, images.inc and buffers.inc become for one description
 * (compile.h). Sizes that only the driver knows are added by src/device/memory.c. Lives in the renderer;
 * nothing here fails. */
#ifndef MASU_PLAN_H
#define MASU_PLAN_H

#include "plan/frame_plan.h"
#include "plan/limits.h"
#include "plan/reserve.h"
#include "scene/scene.h"
#include "masu.h"

/* Timestamps of a frame: one before the first pass and one after each; of the governor the first and
 * the last alone; or none. */
static inline uint32_t masu_stamps(const masu_desc *d) {
    if (d->debug.timestamps) return MASU_PASS_COUNT + 1;
    return d->governor.mode && !d->governor.wall_only ? 2 : 0;
}

typedef struct masu_image_plan {
    int used;
    int persistent; /* its content outlives the frame: it shares its bytes with nothing */
    uint32_t width, height; /* as allocated: the largest rung */
    VkImageUsageFlags usage;
    uint32_t first, last; /* rows of the table between which its content is alive, over all rungs */
    uint64_t bytes, alignment, offset; /* in the device role's block */
    uint32_t type_bits;
} masu_image_plan;

typedef struct masu_rung_plan {
    uint32_t render_width, render_height;
    uint32_t cascades, cascade_size; /* of the shadow map; 0: none */
    uint32_t slow; /* bit per cascade that is not drawn in every frame */
    /* A recording for each set of slow cascades, with and without shadow faces of punctual lights, per target; the
     * last draws them all. */
    uint32_t variants, first_recording;
    int faces; /* it may render such faces */
    masu_pass_set active;
    uint32_t access_count[MASU_PASS_COUNT];
    masu_access access[MASU_PASS_COUNT][MASU_PASS_ACCESSES]; /* stand-ins resolved */
    uint32_t barriers;                                       /* counted while recording */
} masu_rung_plan;

typedef struct masu_buffer_plan {
    const char *name;
    masu_role role;
    VkBufferUsageFlags usage;
    uint64_t bytes;  /* 0: not used */
    uint64_t stride; /* bytes from one frame in flight to the next, 0: shared by all */
    uint64_t count;  /* elements, for the report */
    uint64_t memory_bytes, alignment, offset; /* in its role's block */
    uint32_t type_bits;
} masu_buffer_plan;

typedef struct masu_block_plan {
    uint64_t bytes, alignment;
    uint32_t type_bits, type;
    int host_visible; /* mapped for the renderer's whole life */
    int address;      /* a buffer in it is known to the device by its address */
} masu_block_plan;

#define MASU_READBACK_IMAGES 7u
#define MASU_DRAW_BYTES 20u /* of a VkDrawIndexedIndirectCommand */

/* The atlas of occluders has a part for the camera and one for the sun, whose views all share it. */
#define MASU_ATLAS_PARTS(plan) ((plan)->views > 1 ? 2u : 1u)
/* Where in a slot of MASU_BUFFER_DRAWS the draws of a view begin that stage 1 or 2 has counted, and
 * the draw of the occluders of a part of the atlas. */
#define MASU_DRAWS_OF(plan, view, stage2)                                                          \
    (((uint64_t)(view) + ((stage2) ? (plan)->views : 0)) * (plan)->draws * MASU_DRAW_BYTES)
#define MASU_OCCLUDER_DRAW(plan, part)                                                             \
    (MASU_DRAWS_OF(plan, (plan)->views, 1) + (uint64_t)(part)*MASU_DRAW_BYTES)

/* Words of a slot of MASU_BUFFER_DRAWN; masu_shared.h says what is where. Without occlusion there
 * are the lists of stage 1 alone. */
typedef struct masu_drawn_plan {
    uint64_t header, lists, kept, batches, large, boxes, occluders, pairs, transparents, picks, faces, words;
} masu_drawn_plan;

/* Where in a slot of MASU_BUFFER_SPRITES the three kinds begin, in vec4; masu_shared.h says what is there. */
typedef struct masu_sprites_plan {
    uint64_t particles, lines, decals, end;
} masu_sprites_plan;

/* An array of textures on the device. Plans have as many as their scene, in the host block; while
 * only asked for, on the stack. */
typedef struct masu_texture_plan {
    VkImage image;
    VkImageView view;
    VkFormat format;
    uint64_t bytes, alignment, offset; /* in the device role's block */
    uint32_t type_bits;
    uint32_t layers;
} masu_texture_plan;

typedef struct masu_frame_plan {
    masu_desc desc; /* resolved; `scene` points to the copy below, or is NULL */
    masu_scene_data scene; /* with the reserve: */
    masu_reserve_plan reserve;
    VkExtent2D whole; /* output that targets have; desc.output is that of the viewport looked at */
    VkExtent2D most; /* output that images are allocated for: desc.output, but after masu_resize */
    masu_needs needs; /* of the scene; upscale and sharpen are of the last rung looked at */
    masu_rung_plan rungs[MASU_MAX_RUNGS];
    const char *why[MASU_PASS_COUNT]; /* of the first rung that runs the pass, else of rung 0 */
    masu_image_plan images[MASU_IMAGE_COUNT];
    masu_buffer_plan buffers[MASU_BUFFER_COUNT];
    masu_block_plan blocks[MASU_ROLE_COUNT];
    masu_texture_plan *textures; /* scene.texture_arrays of them */
    int compressed;              /* textures stay blocks on the device */
    int unified;
    int staged; /* the host cannot write resident buffers: they go through the staging buffer */
    uint64_t transient_offset; /* of the transient region in the device role's block */
    uint64_t transient_unaliased, transient_aliased, transient_lower_bound;
    /* Within one readback slot: counters first, then timestamps, then images in the bit order of
     * masu_readback_bits. */
    uint64_t readback_times, readback_offset[MASU_READBACK_IMAGES];
    uint32_t views;     /* that instances are culled for: the camera, the cascades */
    int occlusion;      /* a rung has occlusion culling */
    int lods;           /* a rung draws LODs of meshes */
    int deep;           /* colour between tone curve and target is of 16-bit floats, else of 10 bits */
    const char *computed_for; /* class of GPUs that the ladder's costs are of; "": as measured, or given */
    int copies;         /* targets are filled by a copy of bytes, not by a blit */
    struct masu_output_plan {
        uint32_t steps[3]; /* of red, green, blue: what passes round to; 0: they do not */
        uint32_t flags;    /* MASU_OUTPUT_*, of the pass that comes last */
    } output;
    uint32_t draws, listed; /* draws of a view; words of its lists: a list for each form */
    masu_drawn_plan drawn;
    masu_sprites_plan sprites;
    uint64_t transparent_draws; /* of MASU_BUFFER_DRAWS: where theirs begin */
    uint64_t pick_draws; /* of the same: where those of the picked pixel begin */
    uint64_t face_draws; /* of the same: where those of the shadow faces begin */
    uint64_t receiver_mask; /* first word of MASU_BUFFER_SEEN that is of receivers; 0: it has none */
    uint32_t pass_sets; /* descriptor sets of set 1 over all rungs and targets */
    uint32_t targets_max; /* targets that there may be: more than now only with desc.resizable */
    uint32_t recordings; /* of one frame in flight: viewports, their rungs, their targets, their variants */
    uint32_t viewport_recordings; /* of one viewport */
    uint32_t parts; /* command buffers of a recording: 1, and one more for each point where it is split */
    uint32_t cascades, cascade_size; /* of the shadow map: the most of any rung */
    /* Shadows of punctual lights, the most of any rung: faces rendered per frame, lights that have them in all
     * viewports, texels along an edge of the atlas and of its largest tile. 0: there are none. */
    uint32_t local_faces, local_lights, local_atlas, local_tile;
} masu_frame_plan;

/* v rounded up to a multiple of a, which need not be a power of two. */
static inline uint64_t masu_align_up(uint64_t v, uint64_t a) { return (v + a - 1) / a * a; }

/* Render sizes of another output, up to plan->most; passes, images and buffers stay what they are. */
void masu_plan_resize(masu_frame_plan *plan, VkExtent2D output);
/* The same of a viewport; where there are none, of the whole output. */
void masu_plan_select_viewport(masu_frame_plan *plan, uint32_t viewport);
/* Bytes of MASU_BUFFER_JOINTS for one moment: of each skin a header, then the matrices. */
#define MASU_SKIN_HEADER_BYTES 32u
static inline uint64_t masu_joints_bytes(const masu_scene_data *s) {
    uint64_t morphs = s->skin_targets ? (uint64_t)16 * s->skins + (uint64_t)16 * s->skin_targets : 0;
    return s->skins * (uint64_t)MASU_SKIN_HEADER_BYTES + s->skinned_joints * (uint64_t)48 + morphs;
}
/* Where the morphs of skins begin there: of each skin an element, then of each target one. */
static inline uint64_t masu_morphs_at(const masu_scene_data *s) {
    return s->skins * (uint64_t)MASU_SKIN_HEADER_BYTES + s->skinned_joints * (uint64_t)48;
}

/* Bytes of a slot of MASU_BUFFER_LIVE_MATERIALS: of all materials, then the same as rays know them. */
static inline uint64_t masu_live_material_bytes(const masu_frame_plan *p) {
    return p->scene.materials *
           (sizeof(struct masu_material_data) +
            (p->needs.traced ? sizeof(struct masu_trace_material) : 0));
}

/* What the blob has of what a reserve adds to. */
static inline uint32_t masu_own_instances(const masu_frame_plan *p) {
    return p->scene.instances - p->reserve.places.instances;
}
static inline uint32_t masu_own_models(const masu_frame_plan *p) {
    return p->scene.models - p->reserve.models;
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

/* Where a cascade lies in the shadow map, of the size that the map is laid out for. */
VkOffset2D masu_cascade_place(const masu_frame_plan *plan, uint32_t cascade);
/* Where the square of one of the frame's shadow faces of punctual lights lies. */
VkOffset2D masu_local_face_place(const masu_frame_plan *plan, uint32_t face);
/* What a frame may leave out: the bit of a cascade, or of all shadow faces of punctual lights. */
#define MASU_DRAWN_FACES MASU_CASCADES_MAX
/* Bits over what a rung may leave out only, out of bits over all: the variant that draws it. */
uint32_t masu_recording_variant(const masu_rung_plan *rung, uint32_t drawn);
/* Whether a variant of a rung's recordings draws a cascade, or MASU_DRAWN_FACES. */
int masu_variant_draws(const masu_rung_plan *rung, uint32_t variant, uint32_t what);
/* Whether a pass reads an image in any rung that runs it. */
int masu_reads(const masu_frame_plan *plan, uint32_t pass, masu_image_id image);
/* The first rung that runs a pass, which speaks for all of them: which images stand behind its bindings may
 * differ, their number and kind do not. NULL: none does. */
const masu_rung_plan *masu_first_rung(const masu_frame_plan *plan, uint32_t pass);
/* Size of an image or of a pass of a rung. */
VkExtent2D masu_plan_extent(const masu_frame_plan *plan, masu_image_extent extent,
                            VkExtent2D render);
/* The format of an image in this plan, and of the view that shaders store through: another where not
 * every device stores to the first. */
VkFormat masu_plan_format(const masu_frame_plan *plan, uint32_t image);
VkFormat masu_plan_store_format(const masu_frame_plan *plan, uint32_t image);
/* Whether means over frames are kept in halves instead of 16-bit unorm: the device does not filter that, or the target goes
 * beyond white, where a step of 1/65535 of its peak is seen in the dark. */
int masu_has_half_means(const masu_frame_plan *plan);
/* Whether a compute pass writes what a rung shows: the target, or the image that a blit takes to it. */
int masu_comes_last(const masu_rung_plan *rung, uint32_t pass);

/* Texel bytes of the formats of the table. */
uint32_t masu_format_bytes(VkFormat format);
static inline int masu_is_depth(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
}

/* Whether the G-buffer pass draws emitting materials in a second subpass, the only one that has hdr
 * attached. Where materials may begin to emit at run time, all are drawn with it in one. */
static inline int masu_has_emission_subpass(const masu_frame_plan *plan) {
    return plan->needs.emissive && !plan->desc.mutable_materials;
}

#endif
