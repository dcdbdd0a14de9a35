/* shape.h: procedural meshes for test scenes. Each becomes a piece with one mesh, one instance and
 * the default material, centred at the origin. `tile` is how often a texture repeats over a face,
 * or over half of a sphere's equator; 0: no texture coordinates. */
#ifndef MASU_BAKE_SHAPE_H
#define MASU_BAKE_SHAPE_H

#include "bake/scene/content.h"

#define MASU_BAKE_SUBDIVISIONS_MAX 8 /* 20 * 4^8 = 1,310,720 triangles */

/* An icosahedron whose triangles are split in four `subdivisions` times; vertices on the sphere. */
void masu_bake_sphere(masu_bake_content *piece, double radius, uint32_t subdivisions, double tile);
void masu_bake_cuboid(masu_bake_content *piece, masu_bake_vec3 size, double tile);
/* Two triangles in y = 0, facing +Y. */
void masu_bake_plane(masu_bake_content *piece, double size_x, double size_z, double tile);

/* Parameters of one shape, from the scene file. */
typedef struct masu_bake_shape {
    enum { MASU_BAKE_SPHERE, MASU_BAKE_BOX, MASU_BAKE_PLANE } kind;
    masu_bake_vec3 size; /* of a sphere x is the radius; of a plane y is nothing */
    uint32_t subdivisions;
    double tile;
} masu_bake_shape;

/* mapped: with texture coordinates. */
void masu_bake_make_shape(const masu_bake_shape *shape, bool mapped, masu_bake_content *piece);

#endif
