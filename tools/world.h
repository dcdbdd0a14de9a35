/* world.h: what masu-world writes. A world is a folder: a scene for masu-bake (docs/scene.md) and the
 * models that it places and that do not exist elsewhere. The same arguments give the same bytes.
 *
 *   world.c        the program
 *   world_city.c   a city on several decks, from parts
 *   world_parts.c  the parts, as OBJ files
 *   world_mesh.c   closed solids
 *   world_forza.c  a camera path and cars on a track of TORCS */
#ifndef MASU_WORLD_H
#define MASU_WORLD_H

#include <stdbool.h>
#include <stdio.h>

/* Each reports its own errors. `folder` exists. */
bool masu_world_city(const char *folder);
bool masu_world_parts(const char *folder);
bool masu_world_forza(const char *folder, const char *torcs);

/* Opens FOLDER/NAME for writing, and closes it; both report. */
FILE *masu_world_create(const char *folder, const char *name);
bool masu_world_close(FILE *file, const char *folder, const char *name);

#endif
