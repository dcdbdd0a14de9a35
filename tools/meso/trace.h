/* trace.h: rays through a patch that repeats without end in x and z. Embree 3 knows one period;
 * a ray is followed from cell to cell, each time only as far as the cell reaches, so a patch may be
 * crossed at any grazing angle and what leans over an edge is met on either side of it once.
 *
 * Single precision positions; a ray starts masu_meso_offset off the surface on the side that it
 * leaves to. Not thread safe only in creation. */
#ifndef MASU_MESO_TRACE_H
#define MASU_MESO_TRACE_H

#include "meso/patch.h"

typedef struct masu_meso_tracer masu_meso_tracer;

typedef struct masu_meso_hit {
    masu_meso_vec3 position; /* within the period */
    masu_meso_vec3 normal;   /* unit, turned against the ray */
    double color[3];
    double shift[2]; /* x, z: periods between the ray's start and the hit */
} masu_meso_hit;

/* NULL after an error message. The patch is copied. */
masu_meso_tracer *masu_meso_tracer_create(const masu_meso_patch *patch);
void masu_meso_tracer_free(masu_meso_tracer *tracer);

/* First surface along the ray; false where it leaves the relief upwards, or was given up after
 * MASU_MESO_CELLS_MAX cells (near horizontal through a hole). */
#define MASU_MESO_CELLS_MAX 512
bool masu_meso_trace(const masu_meso_tracer *tracer, masu_meso_vec3 from, masu_meso_vec3 direction,
                     masu_meso_hit *hit);
/* Whether anything is in the way from a point, along its side of the surface. */
bool masu_meso_blocked(const masu_meso_tracer *tracer, masu_meso_vec3 from, masu_meso_vec3 normal,
                       masu_meso_vec3 direction);

#endif
