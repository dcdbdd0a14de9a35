/* emitters.h: emissive parts of meshes become area lights of about their shape. */
#ifndef MASU_BAKE_EMITTERS_H
#define MASU_BAKE_EMITTERS_H

#include "bake/scene/content.h"

/* AUTO: parts that are bright and large enough; YES: all that some shape fits. */
enum { MASU_BAKE_AREA_AUTO, MASU_BAKE_AREA_YES, MASU_BAKE_AREA_NO };

/* Per scene. */
#define MASU_BAKE_EMITTERS_MAX 256u

/* Appends lights for the instances from `first` on, each attached to its instance. `where`: prefix
 * of messages. Textured emission and skinned meshes are skipped; YES reports the skipped ones. */
void masu_bake_fit_emitters(masu_bake_content *content, uint64_t first, int wanted,
                            const char *where);

#endif
