/* camera.h: cameras of model files. A scene can use one as its camera ("camera": {"from": ...});
 * the others only appear in the statistics. They belong to the piece of their model. */
#ifndef MASU_BAKE_CAMERA_H
#define MASU_BAKE_CAMERA_H

#include "bake/scene/content.h"

#define MASU_BAKE_CAMERA_NAME 128u

typedef struct masu_bake_camera {
    char name[MASU_BAKE_CAMERA_NAME]; /* in a scene "model/camera", if the model has a name */
    uint32_t own;                     /* offset of the name in the file */
    float fov_y;                      /* radians */
    float height;                     /* of an orthographic camera, metres; else 0 */
    float position[3], direction[3];  /* direction: of unit length */
} masu_bake_camera;

#define MASU_BAKE_CAMERAS(c) ((masu_bake_camera *)(void *)(c)->cameras.data)
uint32_t masu_bake_camera_count(const masu_bake_content *content);

/* Adds a camera, unless its position or direction is invalid or its angle too wide. height: of an
 * orthographic camera, or 0. The name is cut if it is too long; its control characters become
 * '?'. */
void masu_bake_add_camera(masu_bake_content *content, const char *name, double fov_y, double height,
                          masu_bake_vec3 position, masu_bake_vec3 direction);

/* NULL, or the error in a piece's cameras. */
const char *masu_bake_check_cameras(const masu_bake_content *piece);

/* Adds a piece's cameras under a placement; prefix is put before their names and may be NULL. */
void masu_bake_place_cameras(masu_bake_content *scene, const masu_bake_content *piece,
                             const masu_bake_affine *placement, const char *prefix);

/* The first camera of that name, else the first with that name in its file; NULL: none. */
const masu_bake_camera *masu_bake_find_camera(const masu_bake_content *content, const char *name);

#endif
