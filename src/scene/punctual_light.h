/* punctual_light.h: one local light, a point, a spot or an area light: what the scene or the host says of it, whether
 * that is in range, and how the shaders read it (masu_punctual_light_data). Pure functions. */
#ifndef MASU_PUNCTUAL_LIGHT_H
#define MASU_PUNCTUAL_LIGHT_H

#include "masu.h"
#include "scene/blob.h"
#include "shared/masu_shared.h"

/* Words of one tile's list: none needs more lights than there are. */
#define MASU_LIGHT_LIST_WORDS(lights)                                                              \
    (1u + ((lights) < MASU_TILE_LIGHTS_MAX ? (lights) : MASU_TILE_LIGHTS_MAX))

typedef struct masu_light_header {
    uint32_t count, list_words;
    float atlas_texel; /* 1 / texels along an edge of the atlas of shadows */
    float snap; /* m at distance 1 from the camera: how far its rasteriser may move an edge */
} masu_light_header;

/* The half angle of the widest spot whose shadow is one face; others have faces of a cube. Radians: 60 degrees. */
#define MASU_LOCAL_ANGLE_MOST 1.0472f

/* A sphere around all that a light reaches. */
typedef struct masu_light_bound {
    double center[3], radius;
} masu_light_bound;

/* What an element of the blob's section says. */
masu_punctual_light_state masu_light_state_of(const masu_blob_light *light);

/* NULL, or what is wrong with a state; `value` then is the number that is. */
const char *masu_light_state_wrong(const masu_punctual_light_state *state, double *value);

/* How far from its centre the scene may have a surface that is the light's own and casts no shadow of its light,
 * metres, before its instance scales it. */
double masu_light_solid(const masu_punctual_light_state *state);
/* Radiant intensity over pi of the brightest channel, towards where it is largest. direction: in world space. */
double masu_light_intensity(const masu_punctual_light_state *s, const double direction[3]);

/* The light as the shaders read it, its bound included. position: relative to the eye; direction and
 * the state's half axis: in world space. Returns 0 if it lights nothing, wherever that is. */
int masu_light_place(const masu_punctual_light_state *state, const double position[3],
                     const double direction[3], struct masu_punctual_light_data *out);

/* Whether a bound relative to the eye lies wholly outside of the picture. */
int masu_light_outside(const float bound[4], const float clip_from_rel[16]);

#endif
