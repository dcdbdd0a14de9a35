/* renderer.h: the private struct behind masu_renderer, and the steps of masu_init in order.
 *
 *   masu.c      public functions; walks the layout, calls the steps, unwinds on failure
 *   plan.c      description -> which passes, which images           (pure)
 *   src/device/memory.c  images and buffers -> offsets, memory types
 *   bind.c      memory allocated or taken, objects bound, views made
 *   pipelines.c layouts, shader modules, pipelines, render pass
 *   record.c    descriptor sets and command buffers: barriers derived from the table
 *   visible.c   which instances a view draws: the tree of groups, draw commands
 *   views.c     the camera and the sun's cascades: planes, numbers of the shaders
 *   occlusion.c what of that occluders hide: boxes, the words of the shaders
 *   upload.c    scene -> device, frame uniforms, instance transforms
 *   transparents.c  what is blended, in the order of its distance
 *   lights.c    points and spots: what the host sets, which of them may be seen to light something
 *   specular.c  what reflections are traced through
 *   ray_query.c the same for ray queries of the device
 *   shadow.c    cascades of the sun's shadow map: where they lie, when they are drawn anew
 *
 * Everything of fixed size is a member; what depends on the scene are pointers into the same host
 * block. All handles are zero before they are created, so masu_renderer_destroy may run after any
 * failed step. */
#ifndef MASU_RENDERER_H
#define MASU_RENDERER_H

#include "base/arena.h"
#include "scene/blob.h"
#include "scene/cull.h"
#include "device/memory.h"
#include "quality/governor.h"
#include "plan/plan.h"
#include "device/ray_query.h"
#include "scene/scene.h"
#include "frame/shadow.h"
#include "frame/sky.h"
#include "frame/specular.h"
#include "scene/texture.h"
#include "scene/trace.h"
#include "frame/transparents.h"
#include "device/vk.h"

/* The ways to draw polygons with textures; those without have the pass's own pipeline. Masks have
 * theirs, so that only they lose the early depth test. */
enum { MASU_TEXTURED_OPAQUE, MASU_TEXTURED_MASK, MASU_TEXTURED_COUNT };
#define MASU_SAMPLER_COUNT 9u

#define MASU_RENDERER_COOKIE 0x4D415355u

/* A form of a placed mesh: its instances, and one draw for each of its primitives. The mesh itself comes
 * first, then its LODs, if the plan has any, the finer first. */
typedef struct masu_batch {
    uint32_t first_primitive, first_draw, draw_count;
    uint32_t first_instance, instance_count;
    uint32_t first_listed;        /* where in a view's lists its own begins */
    uint32_t first_lod, lod_count; /* of the mesh itself: its LODs */
    uint32_t blended;              /* of the draws those of blended materials: never recorded */
    uint64_t triangles;            /* of one instance, without those */
} masu_batch;

/* An occluder, the instances of its mesh, and how many LODs hide it too. */
typedef struct masu_placed_occluder {
    uint32_t first_instance, instance_count, lods;
} masu_placed_occluder;

/* What LODs are chosen by: lod.h. */
typedef struct masu_lod_view {
    double eye[3], forward[3];
    double widest; /* cosine of the angle from the middle of the picture to its corners */
    float pixels, threshold;
} masu_lod_view;

/* What stage 2 of culling asks of a view, as the GPU reads it: MASU_CULL_VIEW_*. */
typedef struct masu_stage2_view {
    float clip[16], eye[4], atlas[4], near_distance, margin, blind, bias;
    uint32_t turn, trimmed;
    float reach, reserved;
} masu_stage2_view;
_Static_assert(sizeof(masu_stage2_view) == 4 * MASU_CULL_VIEW_WORDS, "stage 2 view");

#define MASU_BOX_MOVED 0x80000000u /* in box_positions: the tree no longer knows the box */
#define MASU_BOX_PADDING 3u /* floats that SIMD may read behind the last box */

struct masu_renderer {
    uint32_t cookie;
    masu_vk vk;
    masu_frame_plan plan;
    masu_arena arena; /* rows for the report; its base is this struct */
    masu_detail error;

    /* bind.c */
    masu_objects objects;
    VkImageView views[MASU_IMAGE_COUNT]; /* whole images; source and target views are the host's */
    VkDeviceMemory memory[MASU_ROLE_COUNT];
    int memory_owned[MASU_ROLE_COUNT];
    unsigned char *mapped[MASU_ROLE_COUNT]; /* NULL where the block is not host-visible */

    /* pipelines.c */
    VkSampler sampler; /* nearest, clamp to edge */
    VkDescriptorSetLayout global_layout;
    VkDescriptorSetLayout pass_layouts[MASU_PASS_COUNT];
    VkPipelineLayout layouts[MASU_PASS_COUNT];
    VkPipeline pipelines[MASU_PASS_COUNT];
    /* Of the graphics rows; the cascades of the shadow map share those of the first, and its
     * pipeline. */
    VkRenderPass render_passes[MASU_PASS_COUNT];
    VkFramebuffer framebuffers[MASU_PASS_COUNT];
    VkDescriptorSetLayout texture_layout; /* null without textures, as are the next three */
    VkPipeline textured[MASU_TEXTURED_COUNT], masked_casters;
    VkSampler samplers[MASU_SAMPLER_COUNT]; /* wrap of u + 3 * wrap of v; those that sets ask for */
    uint64_t pipeline_ns[MASU_PASS_COUNT];

    /* record.c */
    VkDescriptorPool descriptor_pool;
    VkDescriptorSet global_sets[MASU_MAX_FLIGHT];
    VkDescriptorSet *pass_sets; /* plan.pass_sets of them, in the order record.c walks */
    VkDescriptorSet *texture_sets; /* one per texture set of the scene */
    VkCommandPool command_pool;
    VkCommandBuffer *frames; /* [flight][rung][target][variant]; plan.recordings of each flight */
    VkCommandBuffer *loads;  /* one per staging chunk */
    VkQueryPool queries;     /* [flight][MASU_PASS_COUNT + 1] */

    /* upload.c */
    uint32_t load_count, load_next; /* chunks in all, chunks handed out */
    masu_texture_cursor texture_next; /* first texel row of the next chunk */
    int loaded;
    struct masu_instance_data *instances; /* the host's truth, copied to a slot when dirty */
    /* The frame before, of no length where nothing reads velocities. It is kept here and not on the device,
     * so that no state crosses frames there and frames in flight need not know of each other. */
    struct masu_instance_data *previous_instances;
    struct masu_frame_uniforms *previous;
    uint64_t *instance_names;             /* FNV-1a 64 of the name, 0: none */
    uint8_t *instance_dirty;              /* frames that still have to write the transform */
    uint32_t dirty_count;
    masu_blob_camera_key *camera_keys;
    masu_blob_sdf_param *sdf_params;
    masu_blob_environment environment;
    float sdf_bounds[2][4]; /* min and 1/Lipschitz, max and longest ray */
    float environment_sh[9][3]; /* of a sky from a picture */
    masu_sky *sky;          /* NULL where the plan has no analytic sky */
    uint64_t slot_sky[MASU_MAX_FLIGHT]; /* sky->sun_updates that the slot has; 0: a gradient */

    /* visible.c; positions are those of src/scene/cull.h */
    masu_batch *batches;
    uint32_t batch_count, large_count; /* large: of over 64 instances */
    masu_blob_lod *lods;
    uint8_t *levels; /* [instance]: 0, or the LOD that it was last drawn as; with LODs alone */
    masu_lod_view lod_view;
    masu_placed_occluder *occluders;
    masu_cull_node *groups;
    uint8_t *group_states;   /* [view][group] */
    float *boxes;            /* [6][box_stride] */
    uint64_t box_stride;
    uint32_t *box_items;     /* [position]: instance */
    uint32_t *box_positions; /* [instance] */
    uint32_t *moved;         /* positions */
    uint32_t moved_count;
    uint8_t *marks;            /* [instance]: a bit per view */
    uint32_t *instance_meshes; /* [instance] */
    float (*mesh_bounds)[6];   /* low, high */
    masu_cull_view view_planes[MASU_MAX_VIEWS];
    masu_stage2_view stage2[MASU_MAX_VIEWS];
    uint32_t turns[MASU_MAX_VIEWS]; /* frames that have drawn the view, modulo 5 */
    masu_cull_box scene_box; /* around all instances as the scene places them */
    masu_view_stats slot_views[MASU_MAX_FLIGHT][MASU_MAX_VIEWS];
    /* transparents.c */
    masu_transparent *transparents; /* plan.scene.transparents of them */
    masu_far_first *far_first;      /* twice as many */
    uint32_t transparent_count, transparent_set_count;
    uint32_t transparent_sets[MASU_TRANSPARENT_SETS_MAX];
    uint32_t slot_transparents[MASU_MAX_FLIGHT]; /* drawn */
    /* lights.c */
    masu_local_light_state *lights;
    uint64_t *light_names; /* FNV-1a 64 of the name, 0: none */
    uint32_t slot_lights[MASU_MAX_FLIGHT]; /* in view */
    /* specular.c */
    masu_trace_top trace; /* in trace_memory */
    void *trace_memory;
    uint32_t *traced;     /* [traced instance]: instance */
    double anchor[3];     /* of the frame at hand */
    uint64_t trace_versions;              /* so many times something has changed */
    uint64_t slot_trace[MASU_MAX_FLIGHT]; /* as of which the slot is */
    /* ray_query.c */
    masu_ray_mesh *ray_meshes; /* [mesh]; of no length without ray queries */
    VkAccelerationStructureKHR ray_top;
    uint8_t *ray_live; /* [traced instance]: it is not left out */
    double ray_anchor[3];
    int traced_before;       /* the frame before has kept what it traced, */
    uint32_t traced_size[2]; /* at this render size; */
    int fine_before;         /* and means of pixels */
    /* shadow.c */
    masu_cascade cascades[MASU_CASCADES_MAX]; /* as drawn last */
    double shadow_distance;                    /* view depth where shadows end in this frame */
    double casters[2][3];                      /* a box around all instances, wherever they have been */

    /* frames */
    uint64_t frame;
    uint64_t slot_frame[MASU_MAX_FLIGHT]; /* UINT64_MAX: not used yet */
    uint32_t slot_rung[MASU_MAX_FLIGHT];
    masu_governor *governor; /* of no length where the description asks for none */
    double slot_wall[MASU_MAX_FLIGHT]; /* ms; 0: the host has not said */
    uint32_t drawn; /* bit per cascade that the frame at hand draws */
};

masu_result masu_bind_memory(masu_renderer *m, masu_detail *detail);
masu_result masu_make_views(masu_renderer *m, masu_detail *detail);
masu_result masu_make_pipelines(masu_renderer *m, masu_detail *detail);
masu_result masu_record(masu_renderer *m, masu_detail *detail);

/* How many staging chunks the scene needs: those of resident buffers, none where the host can write
 * them, then those of textures. */
uint32_t masu_load_chunks(const masu_frame_plan *plan);
uint32_t masu_buffer_chunks(const masu_frame_plan *plan);
/* Whether frames leave images to each other: then the last chunk puts them into their layout. */
int masu_keeps_images(const masu_frame_plan *plan);
/* Whether a chunk of so many is that in which structures of ray queries are built. */
int masu_is_build_chunk(const masu_frame_plan *plan, uint32_t index, uint32_t chunks);
/* One chunk: `bytes` of `buffer`, which has `whole`, from `offset`. */
typedef struct masu_chunk {
    masu_buffer_id buffer;
    uint64_t offset, bytes, whole;
} masu_chunk;
masu_chunk masu_load_chunk(const masu_frame_plan *plan, uint32_t index);
/* Copies what a frame needs later from the blob into the host block. */
void masu_keep_scene(masu_renderer *m);
/* Writes camera, light, time and parameters to a slot. Checks first, writes after. */
masu_result masu_write_frame(masu_renderer *m, const masu_frame_desc *frame, uint32_t slot,
                             masu_detail *detail);
/* Unit vector of v; 0: it has none. */
int masu_unit(const float v[3], float out[3]);
/* light.c: checks the light of a frame, the scene's if none is given, and writes what does not follow
 * from an analytic sky; `out` has it with defaults. */
masu_result masu_write_light(const masu_renderer *m, const masu_light *given, double eye_y,
                             struct masu_frame_uniforms *u, masu_light *out, masu_detail *detail);
/* The frame's analytic sky, or that it has none, to a slot; its light to the uniforms. */
void masu_write_sky(masu_renderer *m, const masu_light *light, uint32_t slot,
                    struct masu_frame_uniforms *u);
/* Fits the cascades of the shadow map to the camera and sun of the uniforms, writes them to a slot
 * and returns a bit for each that the frame has to draw. */
uint32_t masu_write_shadow(masu_renderer *m, const masu_frame_desc *frame, uint32_t slot,
                           const struct masu_frame_uniforms *u, const double eye[3]);
/* Widens the box around all casters by one of an instance. */
void masu_note_caster(masu_renderer *m, const masu_cull_box *box);
void masu_write_instances(masu_renderer *m, uint32_t slot, int cut);
/* Whether nothing of the frame before counts: it is taken to be as this one. */
int masu_is_cut(const masu_renderer *m, const masu_frame_desc *frame);

/* Copies the lights of the blob. */
void masu_keep_lights(masu_renderer *m, const masu_scene_view *v);
/* Writes those that may be seen to light something to a slot. culls 0: all of them. */
void masu_write_lights(masu_renderer *m, uint32_t slot, const struct masu_frame_uniforms *u,
                       const double eye[3], int culls);

/* Copies groups and bounds from the blob; needs m->instances. */
void masu_keep_visible(masu_renderer *m, const masu_scene_view *v);
/* The same of occluders; after it. */
void masu_keep_occluders(masu_renderer *m, const masu_scene_view *v);
void masu_write_occluders(masu_renderer *m, const masu_scene_view *v);
/* Writes what does not change of the draw commands of all slots. */
void masu_write_commands(masu_renderer *m, const masu_scene_view *v);
/* After a transform has changed. */
void masu_move_box(masu_renderer *m, uint32_t instance);
/* Writes which instances a view draws to a slot. culls 0: all of them. */
void masu_write_visible(masu_renderer *m, uint32_t slot, uint32_t view, int culls);

/* Copies what rays meet from the blob. */
void masu_keep_trace(masu_renderer *m, const masu_scene_view *v);
/* Writes of a frame what reflections ask of it, and where traced things are measured from. */
void masu_write_reflections(masu_renderer *m, const masu_frame_desc *frame, const double eye[3],
                            struct masu_frame_uniforms *u);
/* Writes traced instances to a slot, before masu_write_instances. */
void masu_write_trace(masu_renderer *m, uint32_t slot, int cut);

/* Copies what is blended from the blob. */
void masu_keep_transparents(masu_renderer *m, const masu_scene_view *v);
/* Writes it to a slot, sorted; after masu_write_visible for the camera. */
void masu_write_transparents(masu_renderer *m, uint32_t slot);

/* Sets up the views of a frame, of the camera and the sun in `u`. */
void masu_set_views(masu_renderer *m, const struct masu_frame_uniforms *u, const double eye[3],
                    uint32_t rung);
/* Whether the frame at hand draws a view: the camera's always, of the cascades those that are due. */
int masu_view_draws(const masu_renderer *m, uint32_t view);
/* Of the occluder atlas: 0 is the camera's, 1 the sun's. */
VkRect2D masu_atlas_part(uint32_t part);
/* Writes what stage 2 of culling reads of a frame. */
void masu_write_stage2(masu_renderer *m, uint32_t slot, int cut);
/* The box of an instance, for stage 2. */
void masu_write_box(masu_renderer *m, uint32_t slot, uint32_t instance);

/* Host pointer to a buffer's first byte, of a slot where it has slots. NULL where it is not
 * host-visible. */
unsigned char *masu_buffer_pointer(const masu_renderer *m, masu_buffer_id buffer, uint32_t slot);

/* Gives a Vulkan object the name of its row, where labels are on. */
void masu_name(const masu_renderer *m, VkObjectType type, uint64_t handle, const char *name);
/* Handles are pointers on 64-bit targets and integers on 32-bit ones; both convert through this. */
#define MASU_HANDLE(h) ((uint64_t)(h))

#endif
