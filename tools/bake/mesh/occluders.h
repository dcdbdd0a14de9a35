/* occluders.h: boxes that occlude objects behind a mesh.
 *
 *   occluders.c   boxes given by the scene, meshes that are boxes, and the section
 *   inside.c      boxes found inside meshes */
#ifndef MASU_BAKE_OCCLUDERS_H
#define MASU_BAKE_OCCLUDERS_H

#include "bake/scene/content.h"

#define MASU_BAKE_OCCLUDERS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_OCCLUDERS, masu_blob_occluder)

/* Adds a box (object space) to a mesh, shrunk by the rounding error of fp32. False: the box is
 * empty within the mesh's bounds, or it is a duplicate. */
bool masu_bake_add_occluder(masu_bake_content *content, uint32_t mesh, masu_bake_box box);

/* Whether the mesh is just a closed box along its own axes: six faces of two triangles each. Then
 * *box is that box. */
bool masu_bake_is_box(const masu_bake_content *content, uint32_t mesh, masu_bake_box *box);

/* Takes the boxes away from meshes that have a mask or are to be blended, with a warning for
 * each: one looks through them. Occluders are sorted, materials have their flags
 * (bake/texture/texture.h). */
void masu_bake_drop_occluders(masu_bake_content *content);
/* Gives each mesh occluders that has none yet and whose second longest side is, at its largest
 * placement, at least `least` metres. */
typedef struct masu_bake_occluder_report {
    uint32_t given, whole,
        inside;       /* meshes with occluders: of the scene, boxes themselves, others */
    uint32_t dropped; /* not proven to be inside */
    uint32_t too_small;
} masu_bake_occluder_report;
void masu_bake_make_occluders(masu_bake_content *content, double least,
                              masu_bake_occluder_report *report);

/* Looks up which LODs hide their mesh's occluders too. */
void masu_bake_prove_occluders(masu_bake_content *content);

/* Sorts occluders by mesh, as the blob wants them. */
void masu_bake_sort_occluders(masu_bake_content *content);

/* ---- inside.c ---- */

#define MASU_BAKE_BOXES_MAX 4u /* per mesh */

/* Finds the largest boxes inside the closed parts of the triangles, at most one per part. Their
 * second longest sides are at least `least`. Returns the number of boxes. */
uint32_t masu_bake_boxes_inside(const masu_bake_vec3 (*triangles)[3], size_t count, double least,
                                masu_bake_box boxes[MASU_BAKE_BOXES_MAX]);

/* Whether the whole box is inside one closed part; false also if this cannot be determined. */
bool masu_bake_is_inside(const masu_bake_vec3 (*triangles)[3], size_t count,
                         const masu_bake_box *box);

double masu_bake_second_side(const masu_bake_box *box);

#endif
