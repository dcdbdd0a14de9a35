/* first_look.h: how a model is shown that comes without a scene: camera, light and ground by its shape. */
#ifndef MASU_BAKE_FIRST_LOOK_H
#define MASU_BAKE_FIRST_LOOK_H

#include "bake/description/description.h"

/* After the model has been placed, which is all that there is: replaces camera, light and reflections, and lays a
 * ground under what stands free. `bounds`: of the model, not empty. Returns NULL or what is wrong. */
typedef struct masu_bake_first_look {
    masu_bake_look look; /* its one key is the next */
    masu_blob_camera_key key;
    masu_bake_reflections reflections;
} masu_bake_first_look;
const char *masu_bake_make_first_look(const masu_bake_box *bounds, masu_bake_content *content,
                                      masu_bake_first_look *out);

#endif
