/* scene.h: access to a validated scene: its counts (scene_data.h) and the sections of its blob
 * (blob.h). No allocation, no state.
 *
 * masu_scene_bind (public) validates a blob completely, once. masu_scene_view_of and
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
