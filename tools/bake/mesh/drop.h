/* drop.h: how far a model falls until it touches something. The surfaces below are sampled on a
 * grid over the model's bounds, and at the vertices. Above a slope, the remaining gap is at most
 * the height difference of the slope across one cell. */
#ifndef MASU_BAKE_DROP_H
#define MASU_BAKE_DROP_H

#include "bake/scene/content.h"

#define MASU_BAKE_DROP_CELLS 256 /* along each side of the bounds */

/* Height of the piece above its resting position, for this placement. It falls on the surfaces
 * already in `scene`, or on the infinite plane y = ground. Surfaces above the centre of its bounds
 * are above the piece, not below it. Negative: the piece must be raised. 0 for a piece without
 * geometry. */
double masu_bake_drop(const masu_bake_content *scene, const masu_bake_content *piece,
                      const masu_bake_affine *placement, double ground);

#endif
