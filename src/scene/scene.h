/* scene.h: access to the content of a validated scene: its numbers (scene_data.h) and the sections
 * of its blob. The layout of the blob is in blob.h. Nothing here allocates or keeps anything.
 *
 * masu_scene_bind (public) validates a blob once, completely. masu_scene_view_of and
 * masu_scene_data_view may then be used on the same bytes without further checks. */
#ifndef MASU_SCENE_H
#define MASU_SCENE_H

#include "masu.h"
#include "scene/blob_section.h"
#include "scene/scene_data.h"

/* Sections of the blob of a scene that masu_scene_bind has filled. */
masu_scene_view masu_scene_data_view(const masu_scene_data *scene);
static inline masu_scene_view masu_scene_view_of(const masu_scene *scene) {
    return masu_scene_data_view(masu_scene_data_of(scene));
}

#endif
