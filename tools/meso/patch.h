/* patch.h: a patch of mesoscale relief: triangles that fill one period of a surface.
 *
 *   space      y up; the period is 1 x 1 in x and z, heights in the same unit
 *   triangles  may extend beyond the edge of the period; masu_meso_tracer adds parts of neighbours
 *   color      linear albedo per vertex
 *   sides      both are visible: the normal is on the side of the viewer
 *
 * make.c, height.c and import.c fill patches with the functions below, which exit if memory runs
 * out, like those of masu-bake. */
#ifndef MASU_MESO_PATCH_H
#define MASU_MESO_PATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bake/base/math.h"

/* Upper bounds: a period of 2048 x 2048 heights. */
#define MASU_MESO_VERTICES_MAX (1u << 23)
#define MASU_MESO_TRIANGLES_MAX (1u << 23)
/* The relief must not be higher than this: rays at 88 degrees would cross 100 periods. */
#define MASU_MESO_HEIGHT_MAX 2.0

typedef masu_bake_vec3 masu_meso_vec3;

typedef struct masu_meso_patch {
    float *position; /* 3 per vertex */
    float *color;    /* 3 per vertex */
    uint32_t *index; /* 3 per triangle */
    uint32_t vertex_count, triangle_count;
    uint32_t vertex_room, triangle_room;
    double roughness; /* perceptual, of the facets */
    double low, high; /* after masu_meso_patch_finish: lowest and highest vertex */
} masu_meso_patch;

/* Adds a vertex and returns its index. */
uint32_t masu_meso_vertex(masu_meso_patch *patch, masu_meso_vec3 position, const double color[3]);
void masu_meso_triangle(masu_meso_patch *patch, uint32_t a, uint32_t b, uint32_t c);

/* Adds a grid of size x size heights over the period, row by row along z. color: 3 per height, or
 * NULL for `plain`. The grid wraps around. */
void masu_meso_patch_from_grid(masu_meso_patch *patch, const double *height, const double *color,
                               const double plain[3], uint32_t size);

/* Finds the lowest and highest vertex, and moves the lowest to y = 0. */
void masu_meso_patch_finish(masu_meso_patch *patch);
void masu_meso_patch_free(masu_meso_patch *patch);

/* make.c: procedural patches, identical on every machine for the same arguments. `detail` 1..4:
 * triangles per stone or blade and heights per period. Returns false for an unknown name. */
bool masu_meso_make(const char *name, uint32_t detail, uint32_t seed, masu_meso_patch *patch);
extern const char *const masu_meso_made[]; /* their names, NULL at the end */

#endif
