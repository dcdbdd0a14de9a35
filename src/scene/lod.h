/* lod.h: selects the level of detail of a mesh. Pure functions: the result is the same for camera
 * and shadow, on any thread and in any order, and does not depend on the previous frame. Selection
 * by depth needs no hysteresis: a level changes when its error is below the threshold, so the
 * visible change is small.
 *
 * The error of a level is an upper bound of the distance between its surface and the mesh's, in
 * object space (blob.h). At distance d it covers at most  error * scale * pixels / d  pixels.
 * `pixels` is the number of pixels that unit length covers at unit distance: half the image size
 * divided by the tangent of half the field of view. Towards the edges of a wide image the same
 * length covers more pixels; therefore d is the view depth and not the distance to the camera. */
#ifndef MASU_LOD_H
#define MASU_LOD_H

#include "scene/blob.h"

/* Upper bound of the largest scale factor of a 3x4 transform: the Frobenius norm, at most sqrt(3)
 * too large. Not finite if the transform is not. */
float masu_lod_scale(const float transform[12]);

/* Returns 0 for the mesh itself, n for lods[n - 1]: the coarsest of `count` levels whose error,
 * times `scale`, is at most `threshold` pixels at `depth`, the depth of the closest point of the
 * instance. Returns 0 if depth <= 0, if threshold < 0, or if any number is NaN. */
uint32_t masu_lod_choose(const masu_blob_lod *lods, uint32_t count, float scale, float depth,
                         float pixels, float threshold);

#endif
