/* first_look.h: how a model is shown that comes without a scene: camera, light and ground by its shape. */
#ifndef MASU_BAKE_FIRST_LOOK_H
#define MASU_BAKE_FIRST_LOOK_H

#include "bake/description/description.h"

/* After the model has been placed, which is all of the content: replaces the description's camera
 * and light, limits its reflections, and adds a ground to its models under what stands free.
 * `bounds`: of the model, not empty. */
void masu_bake_make_first_look(const masu_bake_box *bounds, const masu_bake_content *content,
                               masu_bake_description *d);

#endif
