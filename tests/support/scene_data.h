/* scene_data.h: the content of a scene, for tests that change it. */
#ifndef SUPPORT_SCENE_DATA_H
#define SUPPORT_SCENE_DATA_H

#include "scene/scene.h"

static inline masu_scene_data *support_scene_data(masu_scene *scene) {
    return (masu_scene_data *)(void *)scene;
}

#endif
