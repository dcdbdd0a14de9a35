/* field.h: the SDF of a scene for the baker's rays: its parts as masu-sdfc evaluates them,
 * sphere-traced, with parameters at their defaults and time 0. Hand-written GLSL, as a whole source
 * or as parts, cannot be evaluated: it causes a warning, and blocks no light. */
#ifndef MASU_BAKE_FIELD_H
#define MASU_BAKE_FIELD_H

#include "bake/mesh/trace.h"

typedef struct masu_bake_field masu_bake_field;

/* NULL: there is nothing to trace. `source`: the file of the description. */
masu_bake_field *masu_bake_field_make(const masu_bake_content *content, const char *source);
void masu_bake_field_release(masu_bake_field *field);

/* The closest surface before `far`; direction of unit length. hit: NULL, or filled. A ray that
 * starts inside a solid hits its back face there. Thread-safe. */
bool masu_bake_field_ray(const masu_bake_field *field, const float origin[3],
                         const float direction[3], float far, masu_bake_hit *hit);

#endif
