/* field.h: the SDF of a scene for the rays of the baker: its parts as masu-sdfc evaluates them,
 * sphere-traced, with parameters at their defaults and time 0. Parts of hand-written GLSL are
 * not known here, nor is a source of it: they are warned of, and block no light. */
#ifndef MASU_BAKE_FIELD_H
#define MASU_BAKE_FIELD_H

#include "bake/mesh/trace.h"

typedef struct masu_bake_field masu_bake_field;

/* NULL: there is nothing to trace. `source`: the file of the description. */
masu_bake_field *masu_bake_field_make(const masu_bake_content *content, const char *source);
void masu_bake_field_release(masu_bake_field *field);

/* The nearest surface before `far`; direction of unit length. hit: NULL, or filled. One who
 * begins inside of something has met its back there. Threads may ask at the same time. */
bool masu_bake_field_ray(const masu_bake_field *field, const float origin[3], const float direction[3],
                         float far, masu_bake_hit *hit);

#endif
