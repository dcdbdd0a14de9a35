/* mesh.h: writes solids as Wavefront OBJ, for the generated world. Every solid is closed and wound
 * outwards, so that the baker can use it as an occluder. A part of the city is a file of solids,
 * which the baker places many times.
 *
 * Numbers have four decimals, so that the text does not depend on the last bits of the machine's
 * sine. */
#ifndef MASU_WORLD_MESH_H
#define MASU_WORLD_MESH_H

#include "bake/scene/content.h"

#include <stdint.h>
#include <stdio.h>

#define MASU_WORLD_MATERIALS 16

/* Vertices are written immediately, triangles at the end, by material: so a material is one draw,
 * even if it is used at several times. */
typedef struct masu_world_mesh {
    FILE *out;
    uint32_t vertices; /* written so far */
    uint32_t triangles;
    uint32_t material;                       /* of the next triangles */
    const char *names[MASU_WORLD_MATERIALS]; /* in the order of first use */
    masu_bake_buffer faces[MASU_WORLD_MATERIALS];
} masu_world_mesh;

/* Sets the material of the following triangles; `name` lives as long as the mesh. At most
 * MASU_WORLD_MATERIALS. */
void masu_world_material(masu_world_mesh *m, const char *name);
void masu_world_finish(masu_world_mesh *m); /* writes the triangles */

/* A box, by its centre and its size. */
void masu_world_box(masu_world_mesh *m, double x, double y, double z, double sx, double sy,
                    double sz);

/* A frustum of n sides along axis 0, 1, 2 from the centre of its first end; radius 0: a point. */
void masu_world_tube(masu_world_mesh *m, int axis, double x, double y, double z, double length,
                     double radius0, double radius1, int n);

/* An ellipsoid of rings x sides; if `half`, the lower half is only the equator's disc. */
void masu_world_ball(masu_world_mesh *m, double x, double y, double z, double rx, double ry,
                     double rz, int rings, int sides, int half);

/* A prism along z over a convex outline in the x-y plane, counter-clockwise viewed from +z. */
void masu_world_prism(masu_world_mesh *m, const double (*outline)[2], int n, double z0, double z1);

#endif
