/* lights.h: local lights of a frame and their tile lists. */
#ifndef MASU_SHARED_LIGHTS_H
#define MASU_SHARED_LIGHTS_H

#include "shared/types.h"

/* A tile's list is a count and light numbers in rising order, or MASU_TILE_ALL (sdf_limits.h) if
 * more than TILE_LIGHTS_MAX lights reach the tile. */
#define MASU_LOCAL_LIGHTS_MAX 4096
#define MASU_TILE_LIGHTS_MAX 63

/* A local light, camera-relative. shaders/light/lights.glsl evaluates it. */
struct masu_punctual_light_data {
    masu_vec4 position; /* xyz; w 1 / range^2 */
    masu_vec4 color;    /* point, spot: rgb radiant intensity / pi. Capsule, rectangle: radiance.
                           w squared radius; rectangle: 1 two sides, 0 only the front, u x v */
    masu_vec4 axis;     /* xyz unit direction of a spot, w 1 - cos(outer); point 0 0 0 4.
                           Capsule, rectangle: half axis u, metres; w of a rectangle half the
                           thickness of its surface */
    masu_vec4 cone;     /* spot: x 1 / (cos(inner) - cos(outer)); y sine and z cosine of the outer
                           angle; point 1 0 0. Rectangle: half axis v. Capsule: 0 0 0.
                           w bits: kind, 0 point or spot, 1 capsule, 2 rectangle; LIGHT_SHARED */
    masu_vec4 bound;    /* sphere around everything that it lights: xyz, w radius, rounded up */
    /* Shadow, all 0: none. x y z w, x y: a value for each cube face +x -x +y -y +z -z; z near
     * distance, w 0, as bits of floats. A spot has only one face: x its value; y z w the unit
     * vector to its right, whose cross product with the axis points down; then z near distance, w
     * tangent of half its angle. */
    masu_uvec4 shadow[2];
    masu_vec4 shadow_origin; /* xyz: centre of the rendered faces; lags behind a moving light */
};

/* A face as a 32-bit value, 0: no shadow casters. From the lowest bit on: log2 of the tile's size,
 * 4 bits; its fade-in, 0 to LOCAL_FADE, 4; y / 8, 12; x / 8, 12. */
#define MASU_LOCAL_FADE 8
#define MASU_LOCAL_FADE_SHIFT 4
#define MASU_LOCAL_Y_SHIFT 8
#define MASU_LOCAL_X_SHIFT 20
/* Texels beyond the face's edge on each side of a tile, for the filter. */
#define MASU_LOCAL_GUARD 2
/* The light is the emission of a surface of the scene, which rays hit. */
#define MASU_LIGHT_SHARED 4

#endif
