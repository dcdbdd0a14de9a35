/* detail.h: mesh reduction in masu-bake.
 *
 *   merge.c      many small static meshes of a model -> one mesh per material and cell
 *   lod.c        LODs of a mesh, each with a bound of its error
 *   surface.c    distances, inside tests, closedness; validates LODs and occluders
 *
 * Occluders are in occluders.h. */
#ifndef MASU_BAKE_DETAIL_H
#define MASU_BAKE_DETAIL_H

#include "bake/scene/content.h"

/* Replaces the instances of `piece` by one mesh per material and cell of a grid of `cell` metres. A
 * triangle belongs to the cell of its centroid. Meshes of over MASU_BAKE_MERGE_TRIANGLES triangles
 * with more than one instance are unchanged. Merged instances lose names and parents. Returns NULL,
 * or an error message. */
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
