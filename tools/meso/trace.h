/* trace.h: traces rays through a patch that repeats infinitely in x and z. Embree 3 holds one
 * period; a ray is traced from cell to cell, each time only up to the cell's wall. So a patch can
 * be crossed at any grazing angle, and triangles across an edge are hit once on each side.
 *
 * Positions are single precision; a ray starts masu_meso_offset off the surface on its side. Thread
 * safe, except for creation. */
#ifndef MASU_MESO_TRACE_H
#define MASU_MESO_TRACE_H

#include "meso/patch.h"

typedef struct masu_meso_tracer masu_meso_tracer;

typedef struct masu_meso_hit {
    masu_meso_vec3 position; /* within the period */
    masu_meso_vec3 normal;   /* unit, facing the ray */
    double color[3];
    double shift[2]; /* x, z: periods between the ray's start and the hit */
} masu_meso_hit;

/* Copies the patch. NULL after an error message. */
masu_meso_tracer *masu_meso_tracer_create(const masu_meso_patch *patch);
void masu_meso_tracer_free(masu_meso_tracer *tracer);

/* First surface along the ray. Returns false if the ray leaves the relief upwards, or after
 * MASU_MESO_CELLS_MAX cells (nearly horizontal through a hole). */
#define MASU_MESO_CELLS_MAX 512
bool masu_meso_trace(const masu_meso_tracer *tracer, masu_meso_vec3 from, masu_meso_vec3 direction,
                     masu_meso_hit *hit);
/* Whether the ray from a point is occluded. It starts on its side of the surface. */
bool masu_meso_blocked(const masu_meso_tracer *tracer, masu_meso_vec3 from, masu_meso_vec3 normal,
                       masu_meso_vec3 direction);

#endif
