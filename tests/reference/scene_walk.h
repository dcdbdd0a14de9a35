/* scene_walk.h: a second opinion on scene blobs. masu_scene_bind has said that a blob may be used;
 * this reads every byte that a renderer would read, with every index checked on its own, and counts
 * draws and triangles the slow way. Written from blob.h, not from scene.c. */
#ifndef MASU_REFERENCE_SCENE_WALK_H
#define MASU_REFERENCE_SCENE_WALK_H

#include "masu.h"

/* NULL: nothing is wrong. Else what a renderer would have stumbled over. */
const char *masu_ref_walk_scene(const masu_scene *scene);

#endif
