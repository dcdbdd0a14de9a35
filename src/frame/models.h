/* models.h: movable models: hierarchies of nodes that are moved, shown and hidden together. A
 * node's transform is relative to its parent, a model's to the world; their products are written
 * to the instances (instances.h). */
#ifndef MASU_MODELS_H
#define MASU_MODELS_H

#include "frame/animation.h"
#include "frame/bounds.h"
#include "frame/instances.h"
#include "frame/skins.h"

typedef struct masu_placed_model {
    float rows[12]; /* to world */
    uint64_t name;
    uint32_t first_node, node_count;
    uint32_t like;  /* the first model of its kind: spare ones of a kind stand in for each other */
    uint32_t shown;
} masu_placed_model;

typedef struct masu_models {
    masu_placed_model *models;
    masu_node *nodes;
    uint32_t *of_instance; /* [instance]: its model, or MASU_BLOB_NONE; none without models */
    masu_handles handles; /* the last ones come and go: copies, then meshes of the host */
    uint32_t *lives;
    /* with desc.double_positions: added to the translation of rows; else NULL */
    double (*offsets)[3];
    masu_animation animation;
    masu_skins skins; /* skins deformed by the nodes */
} masu_models;

void masu_models_alloc(masu_models *s, masu_arena *arena, const masu_frame_plan *plan);
/* After the instances: those of models that start hidden are hidden here. */
void masu_models_copy_scene(masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                            const masu_scene_view *v);

uint32_t masu_models_find(const masu_models *s, const masu_frame_plan *plan, const char *name);
/* The first node of a model with this name; UINT32_MAX: none. */
uint32_t masu_models_node(const masu_models *s, uint32_t model, const char *name);

/* Whether a model has such a node. */
masu_result masu_models_check_node(const masu_models *s, uint32_t model, uint32_t node,
                                   masu_detail *detail);

/* Updates all nodes. A transform that is not finite, or makes a node's transform not finite, is
 * rejected, and nothing changes. */
masu_result masu_models_move(masu_models *s, masu_instances *in, masu_bounds *b,
                             const masu_frame_plan *plan, uint32_t model, const float rows[12],
                             masu_detail *detail);
masu_result masu_models_move_node(masu_models *s, masu_instances *in, masu_bounds *b,
                                  const masu_frame_plan *plan, uint32_t model, uint32_t node,
                                  const float rows[12], masu_detail *detail);
/* Replaces the translation, in double precision. */
masu_result masu_models_set_position(masu_models *s, masu_instances *in, masu_bounds *b,
                                     const masu_frame_plan *plan, uint32_t model,
                                     const double position[3], masu_detail *detail);
/* 0 without desc.double_positions. */
double masu_models_offset(const masu_models *s, uint32_t model, uint32_t axis);
/* masu_model_animate of the public header. */
masu_result masu_models_animate(masu_models *s, masu_instances *in, masu_bounds *b,
                                const masu_frame_plan *plan, uint32_t model,
                                const masu_clip_use *uses, uint32_t count, masu_detail *detail);
/* masu_model_morph_set of the public header. */
masu_result masu_models_morph(masu_models *s, masu_instances *in, masu_bounds *b,
                              const masu_frame_plan *plan, uint32_t model, const char *name,
                              float weight, masu_detail *detail);
/* masu_model_set_look of the public header, of a look that masu_looks_check has accepted. */
void masu_models_set_look(const masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                          uint32_t model, const masu_look *look);
void masu_models_show(masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                      uint32_t model, int shown);
/* Makes a free slot of the reserve a copy of a model: its nodes have the model's transforms and
 * show nothing yet. Accepts any model; callers exclude skinned ones (masu_models_bends). */
void masu_models_copy(masu_models *s, const masu_frame_plan *plan, uint32_t place, uint32_t like);
/* Whether the model has a skin. */
int masu_models_bends(const masu_models *s, const masu_frame_plan *plan, uint32_t model);
/* A hidden one of that kind that the scene has, or UINT32_MAX. */
uint32_t masu_models_spare(const masu_models *s, const masu_frame_plan *plan, uint32_t like);
/* The box around all its instances, also hidden ones. */
void masu_models_box(const masu_models *s, const masu_bounds *b, uint32_t model, float low[3],
                     float high[3]);

#endif
