/* vertex_color.h: converts vertex colours to materials if that is free of cost.
 *
 * The triangles of a mesh are grouped by colour, and each group gets a material of its colour. The
 * condition: at most 64 colours, each constant within a triangle. Other meshes keep their vertex
 * colours. */
#ifndef MASU_BAKE_VERTEX_COLOR_H
#define MASU_BAKE_VERTEX_COLOR_H

#include "bake/base/buffer.h"

#include <stdbool.h>
#include <stdint.h>

#define MASU_IMPORT_COLORS_CLAMPED "triangles have colours at their vertices beyond 0 to 1: clamped"

typedef struct masu_import_color {
    double color[4];       /* linear, with alpha */
    uint32_t first, count; /* of `triangles` */
} masu_import_color;

typedef struct masu_import_colors {
    masu_import_color *groups;
    uint32_t count;
    uint32_t *triangles; /* their numbers, in the order of the groups */
    bool exact;          /* each triangle has its own colour; else there are no groups */
    bool translucent;    /* an alpha is below 1 */
    uint32_t clamped;    /* triangles with a colour beyond 0 to 1 */
} masu_import_colors;

/* colors: linear, 4 for each vertex. opaque: alpha is ignored. The result is allocated in the
 * pool. */
void masu_import_group_colors(masu_bake_pool *pool, const float *colors, uint32_t vertices,
                              const uint32_t *indices, uint32_t triangles, bool opaque,
                              masu_import_colors *out);

#endif
