/* drop.h: how far a model falls until it touches something. What is below is sampled on a grid
 * over the model's box, and at the vertices: a model hangs above a slope by no more than the
 * slope over a cell of it. */
#ifndef MASU_BAKE_DROP_H
#define MASU_BAKE_DROP_H

#include "bake/scene/content.h"

#define MASU_BAKE_DROP_CELLS 256 /* along each side of the box */

/* How much higher the piece lies under this placement than when it rests: on what `scene` shows
 * so far, or on the plane y = ground, which is everywhere. Surfaces above the middle of its box
 * are above it, not below. Negative: it is to rise. 0 for a piece that shows nothing. */
double masu_bake_drop(const masu_bake_content *scene, const masu_bake_content *piece,
                      const masu_bake_affine *placement, double ground);

#endif
