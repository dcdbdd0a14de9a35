/* first_look.h: camera, light and ground for a model without a scene, from its shape. */
#ifndef MASU_BAKE_FIRST_LOOK_H
#define MASU_BAKE_FIRST_LOOK_H

#include "bake/description/description.h"

/* Call after the model has been placed, as the only content: replaces the description's camera
 * and light, limits its reflections, and adds a ground under a model without one. `bounds`: of
 * the model, not empty. */
void masu_bake_make_first_look(const masu_bake_box *bounds, const masu_bake_content *content,
                               masu_bake_description *d);

#endif
