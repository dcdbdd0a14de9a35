/* look.h: writes camera path, shadow map and environment of the blob. Cannot fail. */
#ifndef MASU_BAKE_LOOK_H
#define MASU_BAKE_LOOK_H

#include "bake/description/description.h"

/* `bounds`: of the scene's visible content; may be empty. */
void masu_bake_build_look(const masu_bake_look *look, const masu_bake_box *bounds,
                          masu_bake_content *content);

#endif
