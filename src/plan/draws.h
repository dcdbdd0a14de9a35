/* draws.h: the list of draws in recording order: the levels of detail of instantiated meshes, then
 * the transparent items. Built once from scene and plan. record.c records the draws;
 * src/frame/visible.c, occlusion.c and transparents.c write the instance counts every frame.
 *
 * The renderer owns the list; its batches are in the host memory block. Cannot fail. */
#ifndef MASU_DRAWS_H
#define MASU_DRAWS_H

#include "base/arena.h"
#include "plan/plan.h"
#include "scene/blob_section.h"

/* Pipelines of polygons with textures; polygons without textures use the pipeline of the pass.
 * Alpha-tested materials have a separate pipeline, so that only these lose the early depth test. */
/* 1 + value: masu_draw_kind */
enum { MASU_TEXTURED_OPAQUE, MASU_TEXTURED_MASK, MASU_TEXTURED_COUNT };
/* Pipelines of single-sided materials: without textures, then as above. */
#define MASU_CULLED_COUNT (1u + MASU_TEXTURED_COUNT)

/* 32-bit values per slot of transparent surfaces in the buffer of drawn instances. */
static inline uint32_t masu_transparent_words(const masu_frame_plan *plan) {
    return plan->scene.depth_biases ? 7 : 6;
}
#define MASU_TRANSPARENT_WORDS_MAX 7u

/* A batch: one level of detail of a mesh, its instances, and one draw per primitive. The mesh
 * itself is first, then its LODs, if the plan has any, finest first. The slots of
 * desc.reserve.meshes are the last batches, one each. */
typedef struct masu_batch {
    uint32_t first_primitive, first_draw, draw_count;
    uint32_t mesh;
    uint32_t material; /* of a slot of desc.reserve.meshes; else MASU_BLOB_NONE */
    uint32_t first_instance, instance_count;
    uint32_t room; /* capacity of its instance list: its instances, and those that may be added */
    uint32_t first_listed;         /* start of its list in a view's lists */
    uint32_t first_lod, lod_count; /* only in the batch of the mesh itself */
    uint32_t blended; /* number of draws with transparent materials, which are not recorded here */
    /* 1: some instance is mirrored in the baked scene: its materials are drawn two-sided */
    uint32_t mirrored;
    uint64_t triangles; /* of one instance, without transparent primitives; of a slot at present */
} masu_batch;

/* The properties of a material that its recording needs. */
typedef struct masu_draw_material {
    uint32_t material;
    uint32_t flags; /* masu_blob_material_flags */
    uint32_t emits; /* flag: masu_material_emits */
    uint32_t texture_set, layers, more_layers;
    float detail[2];
    float rise;    /* masu_blob_primitive.rise */
    uint32_t meso; /* index of its mesoscale detail in the materials buffer; 0: none */
    float depth_bias;
} masu_draw_material;

typedef struct masu_draws {
    masu_batch *batches;
    uint32_t *added; /* [mesh]: instances that may be added; empty without a reserve */
    /* [draw]; empty unless recordings are repeated later, when the blob may be freed. */
    masu_draw_material *materials;
    uint32_t batch_count, large_count; /* large: with a capacity of over 64 instances */
    /* Transparent slots, and the texture sets of each slot. */
    uint32_t transparent_count, transparent_set_count;
    uint32_t transparent_sets[MASU_TRANSPARENT_SETS_MAX];
} masu_draws;

void masu_draws_alloc(masu_draws *draws, masu_arena *arena, const masu_frame_plan *plan);
void masu_draws_build(masu_draws *draws, const masu_frame_plan *plan, const masu_scene_view *v);

/* Whether a transform reverses the winding of triangles. */
int masu_is_mirrored(const float rows[12]);

masu_draw_material masu_draw_material_of(const masu_scene_view *v, const masu_batch *batch,
                                         uint32_t draw);

/* Area of a part of the occluder atlas: 0 camera, 1 sun. */
VkRect2D masu_atlas_part(uint32_t part);

#endif
