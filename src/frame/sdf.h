/* sdf.h: a frame's data of the SDF: its parameters, and the floating origin of its space. */
#ifndef MASU_SDF_H
#define MASU_SDF_H

#include "frame/frame_data.h"
#include "scene/blob_section.h"

typedef struct masu_sdf {
    masu_blob_sdf_param *params; /* [plan->scene.sdf_params] */
    float bounds[2][4];          /* min and 1/Lipschitz, max and longest ray */
} masu_sdf;

void masu_sdf_alloc(masu_sdf *sdf, masu_arena *arena, const masu_frame_plan *plan);
void masu_sdf_copy_scene(masu_sdf *sdf, const masu_frame_plan *plan, const masu_scene_view *v);

/* Checks the parameters of a frame and writes them and the SDF's origin, near the camera, into
 * the uniforms. */
masu_result masu_sdf_read(const masu_sdf *sdf, masu_frame_data *f, masu_detail *detail);

#endif
