/* models.h: models of several nodes, which are moved, shown and hidden as one: those that the scene says
 * move. A node has its place relative to the node above it, a model its own place in the world; from both
 * follow the transforms of instances (instances.h), whose truth they become. */
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
    double (*offsets)[3]; /* with desc.double_positions: added to the translation of rows; else NULL */
    masu_animation animation;
    masu_skins skins; /* bent by what the nodes are */
} masu_models;

void masu_models_alloc(masu_models *s, masu_arena *arena, const masu_frame_plan *plan);
/* After the instances: those of models that start hidden are hidden here. */
void masu_models_copy_scene(masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                            const masu_scene_view *v);

uint32_t masu_models_find(const masu_models *s, const masu_frame_plan *plan, const char *name);
/* Of a model's nodes, the first of that name; UINT32_MAX: none. */
uint32_t masu_models_node(const masu_models *s, uint32_t model, const char *name);

/* Whether a model has such a node. */
masu_result masu_models_check_node(const masu_models *s, uint32_t model, uint32_t node,
                                   masu_detail *detail);

/* Places all nodes anew. What is not finite, or would not be where a node is, is refused, and all stays. */
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
/* A free place of the reserve becomes a copy of a model: its nodes are as they are there; they show nothing yet.
 * Refuses no model: of one with skins nothing is to be copied (masu_models_bends). */
void masu_models_copy(masu_models *s, const masu_frame_plan *plan, uint32_t place, uint32_t like);
/* Whether joints bend something of it. */
int masu_models_bends(const masu_models *s, const masu_frame_plan *plan, uint32_t model);
/* A hidden one of that kind that the scene has, or UINT32_MAX. */
uint32_t masu_models_spare(const masu_models *s, const masu_frame_plan *plan, uint32_t like);
/* What is around all that it shows, or would. */
void masu_models_box(const masu_models *s, const masu_bounds *b, uint32_t model, float low[3],
                     float high[3]);

#endif
