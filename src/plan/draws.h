/* draws.h: what the recordings draw, in their order: the forms of placed meshes, then what is blended.
 * Made once of scene and plan; record.c records it, and src/frame/visible.c, occlusion.c and
 * transparents.c say in each frame how many instances a draw has.
 *
 * The renderer owns it; its batches lie in the host block. Nothing here fails. */
#ifndef MASU_DRAWS_H
#define MASU_DRAWS_H

#include "base/arena.h"
#include "plan/plan.h"
#include "scene/blob_section.h"

/* The ways to draw polygons with textures; those without have the pass's own pipeline. Alpha-tested ones
 * have theirs, so that only they lose the early depth test. */
/* 1 + these: masu_draw_kind */
enum { MASU_TEXTURED_OPAQUE, MASU_TEXTURED_MASK, MASU_TEXTURED_COUNT };
/* Of what is not seen from behind: without textures, then the same. */
#define MASU_CULLED_COUNT (1u + MASU_TEXTURED_COUNT)

#define MASU_TRANSPARENT_WORDS 6u /* of a slot in the buffer of drawn instances */

/* A form of a placed mesh: its instances, and one draw for each of its primitives. The mesh itself comes
 * first, then its LODs, if the plan has any, the finer first. */
typedef struct masu_batch {
    uint32_t first_primitive, first_draw, draw_count;
    uint32_t mesh;
    uint32_t first_instance, instance_count;
    uint32_t room;                 /* instances that its list holds: its own, and what may be added */
    uint32_t first_listed;         /* where in a view's lists its own begins */
    uint32_t first_lod, lod_count; /* of the mesh itself: its LODs */
    uint32_t blended;              /* of the draws those of blended materials: never recorded */
    uint32_t mirrored; /* 1: some instance is, as it was baked: its materials are seen from both sides */
    uint64_t triangles;            /* of one instance, without those */
} masu_batch;

/* How a draw is drawn: what recording it asks of its material. */
typedef struct masu_draw_material {
    uint32_t material;
    uint32_t flags; /* masu_blob_material_flags */
    uint32_t emits; /* flag: masu_material_emits */
    uint32_t texture_set, layers, more_layers;
    float detail[2];
    float rise;    /* masu_blob_primitive.rise */
    uint32_t meso; /* element of the buffer of materials where its curves begin; 0: none */
} masu_draw_material;

typedef struct masu_draws {
    masu_batch *batches;
    uint32_t *added; /* [mesh]: instances that may be added; of no length without a reserve */
    /* [draw]; of no length unless they are recorded again, when the blob is gone. */
    masu_draw_material *materials;
    uint32_t batch_count, large_count; /* large: with room for over 64 instances */
    /* Slots of blended things, and the texture sets of each. */
    uint32_t transparent_count, transparent_set_count;
    uint32_t transparent_sets[MASU_TRANSPARENT_SETS_MAX];
} masu_draws;

void masu_draws_alloc(masu_draws *draws, masu_arena *arena, const masu_frame_plan *plan);
void masu_draws_build(masu_draws *draws, const masu_frame_plan *plan, const masu_scene_view *v);

/* Of an instance's transform: its triangles turn the other way in the picture. */
int masu_is_mirrored(const float rows[12]);

masu_draw_material masu_draw_material_of(const masu_scene_view *v, uint32_t primitive);

/* A part of the atlas of occluders: 0 is the camera's, 1 the sun's. */
VkRect2D masu_atlas_part(uint32_t part);

#endif
