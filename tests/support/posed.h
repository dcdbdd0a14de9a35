/* posed.h: reference skinning: positions of the vertices of a file's skins at a time of one of its
 * animations, in double precision, from the bones, nodes and keys that Assimp reads. */
#ifndef SUPPORT_POSED_H
#define SUPPORT_POSED_H

#include "reference/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct posed_vertex {
    float rest[3]; /* bind position in the file */
    vec position;  /* the file's space */
    vec normal;    /* of unit length; 0 if the file has no normals */
} posed_vertex;

typedef struct posed {
    posed_vertex *vertices; /* of all meshes with bones, once per node that shows them */
    size_t count;
    double duration; /* of the animation, s */
} posed;

/* The pose of `animation` at `time` seconds; below 0: the bind pose. free(vertices). Failure fails
 * the calling test. */
posed posed_at(const char *path, unsigned animation, double time);

/* The vertex with bind position `rest` that is closest to `position`; among equals, the one with
 * the closest normal. NULL: no vertex has that bind position. */
const posed_vertex *posed_find(const posed *all, const float rest[3], vec position, vec normal);

#endif
