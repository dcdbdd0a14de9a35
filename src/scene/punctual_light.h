/* punctual_light.h: a local light (point, spot or area light): conversion from the blob, validation
 * of a state, and conversion to the layout of the shaders (masu_punctual_light_data). Pure
 * functions. */
#ifndef MASU_PUNCTUAL_LIGHT_H
#define MASU_PUNCTUAL_LIGHT_H

#include "masu.h"
#include "scene/blob.h"
#include "shared/masu_shared.h"

/* Size of a tile's light list in 32-bit values. A list never holds more lights than there are. */
#define MASU_LIGHT_LIST_WORDS(lights)                                                              \
    (1u + ((lights) < MASU_TILE_LIGHTS_MAX ? (lights) : MASU_TILE_LIGHTS_MAX))

typedef struct masu_light_header {
    uint32_t count, list_words;
    float atlas_texel; /* 1 / texels along an edge of the local shadow atlas */
    float snap; /* m at distance 1 from the camera: how far its rasteriser may move an edge */
} masu_light_header;

/* Half angle, in radians (60 degrees), of the widest spot whose shadow needs a single face. Other
 * lights use the faces of a cube. */
#define MASU_LOCAL_ANGLE_MOST 1.0472f

/* A sphere around everything that a light reaches. */
typedef struct masu_light_bound {
    double center[3], radius;
} masu_light_bound;

/* The state that an element of the blob's section describes. */
masu_punctual_light_state masu_light_state_of(const masu_blob_light *light);

/* Returns NULL, or the error in a state; *value is then the invalid number. */
const char *masu_light_state_wrong(const masu_punctual_light_state *state, double *value);

/* Distance from the light's centre, in metres before the scale of its instance, within which a
 * surface of the scene may be the light's own, which casts no shadow of the light. */
double masu_light_solid(const masu_punctual_light_state *state);
/* Radiant intensity / pi of the brightest channel, in the direction of the maximum. direction:
 * world space. */
double masu_light_intensity(const masu_punctual_light_state *s, const double direction[3]);

/* Writes the light in the layout of the shaders, with its bounding sphere. position: relative to
 * the camera; direction and the state's half axis: world space. Returns 0 if the light is off in
 * every view. */
int masu_light_place(const masu_punctual_light_state *state, const double position[3],
                     const double direction[3], struct masu_punctual_light_data *out);

/* Whether a bounding sphere, relative to the camera, is completely outside the view frustum. */
int masu_light_outside(const float bound[4], const float clip_from_rel[16]);

#endif
