/* world.h: what `masu-lab world` writes. A world is a folder: a scene for masu-bake (docs/scene.md)
 * and the models that were generated for it. The same arguments give the same bytes. The program is
 * lab/command/world.c.
 *
 *   city.c   a city on several decks, made of parts
 *   parts.c  the parts, as OBJ files
 *   mesh.c   closed solids
 *   forza.c  a camera path on a track of TORCS, and the track in numbers
 *   cars.c   its cars, with their wheels
 *   xml.c    TORCS's parameter files */
#ifndef MASU_WORLD_H
#define MASU_WORLD_H

#include "bake/base/math.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Each reports its own errors. `folder` exists. */
bool masu_world_city(const char *folder);
bool masu_world_parts(const char *folder);
bool masu_world_forza(const char *folder, const char *torcs);

/* The height of the ground at (x, z), near `guess`. */
typedef double (*masu_world_height)(void *user, double x, double z, double guess);

/* Writes car `index` as the next elements of "models", and of a track file (docs/drive.md): on the
 * road at `at` (whose y is a guess), pointing to `heading`, in radians about y. Reports its own
 * errors. */
#define MASU_WORLD_CARS 10
bool masu_world_car(FILE *out, FILE *road, const char *torcs, int index, masu_bake_vec3 at,
                    double heading, masu_world_height height, void *user);

/* From an XML's text between two pointers: a number, or `otherwise`; a string, or false if there is
 * no matching one. */
double masu_world_number(const char *from, const char *to, const char *name, double otherwise);
bool masu_world_string(const char *from, const char *to, const char *name, char *out,
                       size_t capacity);
/* The start of the first section of that name, and the end of its first part without sections; or
 * NULL. */
const char *masu_world_section(const char *text, const char *name, const char **end);

/* Open FOLDER/NAME for writing, and close it; both report errors. */
FILE *masu_world_create(const char *folder, const char *name);
bool masu_world_close(FILE *file, const char *folder, const char *name);

#endif
