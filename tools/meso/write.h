/* write.h: writes the output files of masu-meso, whose names all start with NAME:
 *
 *   NAME.json        the curves, in the form of a scene file's material ("meso": "NAME.json")
 *   NAME_color.png   sRGB; NAME_normal.png  +y up the image; NAME_rough.png, NAME_ao.png  grey
 *
 * Functions return false after an error message. */
#ifndef MASU_MESO_WRITE_H
#define MASU_MESO_WRITE_H

#include "meso/author.h"

/* Checks before the work whether all files could be written. */
bool masu_meso_can_write(const char *name);
bool masu_meso_write_curves(const char *name, const masu_meso_material *made);
bool masu_meso_write_maps(const char *name, const masu_meso_material *made);

#endif
