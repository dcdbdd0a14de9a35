/* lights.h: local lights, points and spots, between the scene and the shaders.
 *
 * The host keeps each light as the scene or masu_local_light_set has it; every frame it places them,
 * leaves out those that light nothing in the picture, and writes the rest, in the scene's order, to
 * the frame's slot of MASU_BUFFER_LIGHTS: a masu_light_header and so many masu_local_light_data,
 * relative to the eye. light_tiles.comp sorts them into tiles from there. */
#ifndef MASU_LIGHTS_H
#define MASU_LIGHTS_H

#include "scene/blob.h"
#include "masu.h"
#include "shared/masu_shared.h"

/* Words of one tile's list: none needs more lights than there are. */
#define MASU_LIGHT_LIST_WORDS(lights)                                                              \
    (1u + ((lights) < MASU_TILE_LIGHTS_MAX ? (lights) : MASU_TILE_LIGHTS_MAX))

typedef struct masu_light_header {
    uint32_t count, list_words, reserved[2];
} masu_light_header;

/* A sphere around all that a light reaches. */
typedef struct masu_light_bound {
    double center[3], radius;
} masu_light_bound;

/* What an element of the blob's section says. */
masu_local_light_state masu_light_state_of(const masu_blob_light *light);

/* NULL, or what is wrong with a state; `value` then is the number that is. */
const char *masu_light_state_wrong(const masu_local_light_state *state, double *value);

/* The light as the shaders read it, its bound included. position: relative to the eye; direction: of
 * any length, in world space. Returns 0 if it lights nothing, wherever that is. */
int masu_light_place(const masu_local_light_state *state, const double position[3],
                     const double direction[3], struct masu_local_light_data *out);

/* Whether a bound relative to the eye lies wholly outside of the picture. */
int masu_light_outside(const float bound[4], const float clip_from_rel[16]);

#endif
