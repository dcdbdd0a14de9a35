/* posed.h: where the vertices of a file's skins are at a time of one of its animations, in double precision, by
 * what Assimp says of bones, nodes and keys: the truth of skinning. */
#ifndef SUPPORT_POSED_H
#define SUPPORT_POSED_H

#include "reference/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct posed_vertex {
    float rest[3]; /* as the file has it */
    vec position;  /* the file's space */
    vec normal;    /* of unit length; of none where the file has none */
} posed_vertex;

typedef struct posed {
    posed_vertex *vertices; /* of all meshes with bones, for each node that shows them */
    size_t count;
    double duration; /* of the animation, s */
} posed;

/* Of `animation`, at `time` seconds in it; below 0: at rest. free(vertices). Fails the test that asks. */
posed posed_at(const char *path, unsigned animation, double time);

/* The one that was at `rest` and is nearest to `position`; of several, that whose normal is nearest. NULL: none
 * was there. */
const posed_vertex *posed_find(const posed *all, const float rest[3], vec position, vec normal);

#endif
