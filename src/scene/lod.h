/* lod.h: which form of a mesh is drawn. Pure functions of numbers: the same for camera and shadow, on
 * any thread, in any order, and without a memory of the last frame. Choosing by depth alone needs
 * no hysteresis: a form changes where its error is below the threshold, so where the change is small.
 *
 * The error of a form is a bound of the distance between its surface and the mesh's, in the mesh's own
 * units (blob.h). Seen from a distance d it covers at most   error * scale * pixels / d   pixels,
 * where `pixels` is how many pixels a length of one covers at distance one: half the picture's size over
 * the tangent of half its angle. Towards the edges of a wide picture a length covers more; d is therefore
 * the depth along the view, not the distance to the eye. */
#ifndef MASU_LOD_H
#define MASU_LOD_H

#include "scene/blob.h"

/* The largest factor by which the rows of a 3x4 transform lengthen anything, or more: the Frobenius
 * norm, at most the root of three too large. Not finite for a transform that is not. */
float masu_lod_scale(const float transform[12]);

/* 0: the mesh itself; n: lods[n - 1]. The coarsest of `count` forms whose error, `scale` times larger,
 * is at most `threshold` pixels at `depth`, which is that of the nearest point of the instance. The
 * mesh itself at a depth that is not above zero, at a threshold below zero, and for any number that is
 * not one. */
uint32_t masu_lod_choose(const masu_blob_lod *lods, uint32_t count, float scale, float depth,
                         float pixels, float threshold);

#endif
