/* look.h: camera path, shadow map and environment of the blob. Nothing of it can fail. */
#ifndef MASU_BAKE_LOOK_H
#define MASU_BAKE_LOOK_H

#include "bake/description/description.h"

/* `bounds`: of what the scene shows; may be empty. */
void masu_bake_build_look(const masu_bake_look *look, const masu_bake_box *bounds,
                          masu_bake_content *content);

#endif
