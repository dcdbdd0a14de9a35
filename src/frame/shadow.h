/* shadow.h: the cascades of the sun's shadow map: their boxes, and when each is rendered.
 *
 *        sun            A cascade is an orthographic box along the sun's direction around a sphere
 *       /               that contains the frustum up to some depth, and so the smaller cascades.
 *   +--/------+         A surface point uses the first cascade that contains it with a margin.
 *   | +-----+ |
 *   | | cam >--->       STABLE. The sphere's size depends only on the field of view and the depth,
 *   | +-----+ |         not on the camera's direction, and its centre moves by whole texels across
 *   +---------+         the sun's direction: static surfaces keep their texels. While the camera
 *                       moves by less than a texel the map does not change at all: positions in it
 * are relative to the box's centre, not to the camera.
 *
 * DEPTH is 1 nearest to the sun and 0 at the far side of the box, which ends just behind the
 * sphere: a float's precision is highest at the receivers, however far the box must reach towards
 * the sun to contain all casters. It reaches to their bounds; the vertex shader flattens geometry
 * beyond it onto its near side.
 *
 * Computed in double precision and in world space: sufficient at 1e7 m from the origin. */
#ifndef MASU_SHADOW_H
#define MASU_SHADOW_H

#include "frame/bounds.h"

/* Texels by which cascade.vert moves surfaces away from the sun at most. */
#define MASU_SHADOW_BIAS_MOST (MASU_SHADOW_BIAS * MASU_SHADOW_STEEPEST)

typedef struct masu_cascade {
    int drawn;            /* 0: its map is not rendered yet */
    uint64_t frame;       /* that drew it */
    double axis[3][3];    /* unit: across, across, towards the sun */
    double center[3];     /* world */
    double half;          /* half of its width */
    double behind, ahead; /* how far it reaches from the centre away from the sun, towards it */
    double radius;        /* of the sphere that it was made for */
    uint32_t size;        /* texels along its edge */
    int trimmed;          /* culled to the casters of its frame's image */
    float lod_error;      /* of its rung: which forms of meshes it holds */
} masu_cascade;

/* Requirements of a cascade. */
typedef struct masu_shadow_view {
    double eye[3], forward[3]; /* forward: unit */
    double tan2;               /* square of the tangent of the view's half diagonal */
    double near_distance;
    double begin; /* view depth from which on it is held: 0, or that of masu_shadow_begin */
    double sun[3];        /* towards it, unit */
    double casters[2][3]; /* box around all casters; low above high: there are none */
} masu_shadow_view;

/* The sun's direction and two unit vectors orthogonal to it and to each other. They change
 * continuously with it, except at a sun straight from below. */
void masu_shadow_axes(const double sun[3], double axis[3][3]);

/* Depth at which the cascades begin: 0, or the near plane if that is beyond half of their
 * distance, as of orthographic cameras. Splits and fade then count from there. */
double masu_shadow_begin(double near_distance, double distance);

/* View depth where cascade k of n ends: between even steps (lambda 0) and a constant factor (1),
 * which begins at the near distance, but not below 1/256 of the last depth (the practical split
 * scheme; Zhang et al., VRCIA 2006). */
double masu_shadow_split(double near_distance, double distance, double lambda, uint32_t k,
                         uint32_t n);

/* The cascade that holds the view up to `depth`. slack: share of its radius that it is made larger,
 * to be of use while the camera moves on. */
masu_cascade masu_cascade_fit(const masu_shadow_view *view, double depth, double slack,
                              uint32_t size);

/* Whether a cascade drawn earlier still holds all that `wanted` was made for. */
int masu_cascade_holds(const masu_cascade *drawn, const masu_cascade *wanted);

/* Element k of the uniforms, for a camera position and a first texel in the map. origin: of the
 * instances. */
void masu_cascade_write(const masu_cascade *c, const double eye[3], const double origin[3],
                        const int32_t place[2], uint32_t k, struct masu_shadow_uniforms *u);

/* ---- Of a frame ------------------------------------------------------------------------------ */

typedef struct masu_shadow {
    masu_cascade cascades[MASU_CASCADES_MAX]; /* as drawn last */
    double distance;                          /* view depth where shadows end in this frame */
} masu_shadow;

/* Fits the cascades to camera and sun, writes them to the slot, and decides which the frame
 * draws. */
void masu_shadow_write(masu_shadow *s, const masu_bounds *bounds, masu_frame_data *f);

#endif
