/* camera.h: cameras that model files bring along: of a scene one may be the picture's ("camera":
 * {"from": ...}), the others are names in the statistics. They travel with the piece that they
 * were read with. */
#ifndef MASU_BAKE_CAMERA_H
#define MASU_BAKE_CAMERA_H

#include "bake/scene/content.h"

#define MASU_BAKE_CAMERA_NAME 128u

typedef struct masu_bake_camera {
    char name[MASU_BAKE_CAMERA_NAME]; /* in a scene "model/camera", if the model has a name */
    uint32_t own;                     /* where the name that the file has for it begins */
    float fov_y;                      /* radians */
    float height;                     /* of an orthographic one, metres; else 0 */
    float position[3], direction[3];  /* direction: of unit length */
} masu_bake_camera;

#define MASU_BAKE_CAMERAS(c) ((masu_bake_camera *)(void *)(c)->cameras.data)
uint32_t masu_bake_camera_count(const masu_bake_content *content);

/* Adds one, unless it has no place, looks nowhere or is wider than a picture can be. height: of
 * an orthographic one, or 0. The name is cut if it is too long; its control characters become
 * '?'. */
void masu_bake_add_camera(masu_bake_content *content, const char *name, double fov_y, double height,
                          masu_bake_vec3 position, masu_bake_vec3 direction);

/* NULL or what is wrong with those of a piece. */
const char *masu_bake_check_cameras(const masu_bake_content *piece);

/* Those of a piece under a placement; prefix goes before their names and may be NULL. */
void masu_bake_place_cameras(masu_bake_content *scene, const masu_bake_content *piece,
                             const masu_bake_affine *placement, const char *prefix);

/* The first of that name, else the first that its file calls so; NULL: there is none. */
const masu_bake_camera *masu_bake_find_camera(const masu_bake_content *content, const char *name);

#endif
