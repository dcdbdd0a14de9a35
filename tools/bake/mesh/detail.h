/* detail.h: what masu-bake makes of a scene's meshes so that less has to be drawn.
 *
 *   merge.c      many small static meshes of a model -> one mesh per material and cell
 *   lod.c        LODs of a mesh, each with a bound of its error
 *   surface.c    distances, insides, closedness: the judge of LODs and of occluders
 *
 * What hides what is behind a mesh is in occluders.h. */
#ifndef MASU_BAKE_DETAIL_H
#define MASU_BAKE_DETAIL_H

#include "bake/scene/content.h"

/* Replaces the instances of `piece` by one mesh per material and cell of a grid of `cell` metres;
 * a triangle belongs to the cell of its middle. Meshes of over MASU_BAKE_MERGE_TRIANGLES triangles
 * that are shown more than once stay as they are. Names and parents of what is merged are lost.
 * NULL, or what is wrong. */
#define MASU_BAKE_MERGE_TRIANGLES 256u
const char *masu_bake_merge(masu_bake_content *piece, double cell);

/* Adds up to `levels` LODs to each mesh. */
typedef struct masu_bake_lod_report {
    uint32_t meshes;    /* with at least one level */
    uint32_t levels;    /* in all */
    uint32_t too_small; /* meshes of too few triangles to try */
    uint32_t refused;   /* candidates whose error came out too large, or that saved too little */
} masu_bake_lod_report;
#define MASU_BAKE_LOD_TRIANGLES 48u /* fewer are not simplified */
void masu_bake_make_lods(masu_bake_content *content, uint32_t levels, masu_bake_lod_report *report);

#define MASU_BAKE_LODS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_LODS, masu_blob_lod)

#endif
