/* write.h: the files that masu-meso writes, whose names all begin with NAME:
 *
 *   NAME.json        the curves, as a scene file's material takes them ("meso": "NAME.json")
 *   NAME_color.png   sRGB; NAME_normal.png  +y up the image; NAME_rough.png, NAME_ao.png  grey
 *
 * False after an error message. */
#ifndef MASU_MESO_WRITE_H
#define MASU_MESO_WRITE_H

#include "meso/author.h"

/* Before the work: whether all of them could be written. */
bool masu_meso_can_write(const char *name);
bool masu_meso_write_curves(const char *name, const masu_meso_material *made);
bool masu_meso_write_maps(const char *name, const masu_meso_material *made);

#endif
