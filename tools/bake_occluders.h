/* bake_occluders.h: boxes that hide what is behind a mesh. */
#ifndef MASU_BAKE_OCCLUDERS_H
#define MASU_BAKE_OCCLUDERS_H

#include "bake_content.h"

/* Gives a mesh a box (object space), made smaller by what fp32 may round. False: nothing is left of
 * it within the mesh's bounds, or it has been there before. */
bool masu_bake_add_occluder(masu_bake_content *content, uint32_t mesh, masu_bake_box box);

/* Whether the mesh is just a closed box along its own axes: six faces of two triangles each. Then
 * *box is that box. */
bool masu_bake_is_box(const masu_bake_content *content, uint32_t mesh, masu_bake_box *box);

/* Takes the boxes away from meshes that have a mask or are to be blended, with a warning for each:
 * one looks through them. Occluders are sorted, materials have their flags (bake_texture.h). */
void masu_bake_drop_occluders(masu_bake_content *content);

/* Sorts occluders by mesh, as the blob wants them. */
void masu_bake_sort_occluders(masu_bake_content *content);

#endif
