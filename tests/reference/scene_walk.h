/* scene_walk.h: an independent check of scene blobs that masu_scene_bind has accepted. It reads
 * every byte that a renderer would read, checks every index separately, and counts draws and
 * triangles the slow way. Written from blob.h, not from scene.c. */
#ifndef MASU_REFERENCE_SCENE_WALK_H
#define MASU_REFERENCE_SCENE_WALK_H

#include "masu.h"

/* NULL: no fault. Otherwise the first fault that would affect a renderer. */
const char *masu_ref_walk_scene(const masu_scene *scene);

#endif
