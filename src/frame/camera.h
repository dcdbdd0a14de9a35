/* camera.h: the camera of a frame, the host's or a point of the scene's path, and the
 * projection. */
#ifndef MASU_CAMERA_H
#define MASU_CAMERA_H

#include "frame/frame_data.h"
#include "scene/blob_section.h"

typedef struct masu_camera_path {
    masu_blob_camera_key *keys; /* [plan->scene.camera_keys] */
    float near_distance;        /* of cameras that have none */
} masu_camera_path;

void masu_camera_path_alloc(masu_camera_path *path, masu_arena *arena, const masu_frame_plan *plan);
void masu_camera_path_copy_scene(masu_camera_path *path, const masu_frame_plan *plan,
                                 const masu_scene_view *v);
/* masu_camera_at of the public header. */
masu_result masu_camera_path_at(const masu_camera_path *path, const masu_frame_plan *plan,
                                double time, masu_camera *out);

/* Checks the camera of a frame; eye and projection into `f`. */
masu_result masu_camera_read(const masu_camera_path *path, masu_frame_data *f, masu_detail *detail);

#endif
