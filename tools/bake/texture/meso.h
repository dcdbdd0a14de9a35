/* meso.h: "meso" of a material in a scene file: the curves of a small relief, as masu-meso writes
 * them, in place or in a file of their own, become an element of the section MESO. */
#ifndef MASU_BAKE_MESO_H
#define MASU_BAKE_MESO_H

#include "bake/scene/content.h"
#include "bake/scene/json.h"

/* `material`: the object that may have a member "meso". *index: the element, or MASU_BLOB_NONE where
 * there is none. Equal curves share an element. False after an error line. */
bool masu_bake_read_meso(const masu_bake_json *material, const char *directory,
                         masu_bake_content *content, uint32_t *index);

#endif
