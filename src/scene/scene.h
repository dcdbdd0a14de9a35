/* scene.h: reading a baked blob. The layout of the bytes is in blob.h; nothing here allocates or
 * keeps anything.
 *
 * masu_scene_bind (public) checks a blob once, completely. After that masu_scene_look may be used on
 * the same bytes without further checks. */
#ifndef MASU_SCENE_H
#define MASU_SCENE_H

#include "masu.h"
#include "scene/view.h"

/* Sections of the blob behind a masu_scene that masu_scene_bind has filled. */
masu_scene_view masu_scene_look(const masu_scene *scene);

#endif
