/* shape.c: meshes made by formula; see shape.h. Triangles are written without sharing
 * vertices, and bake/mesh/triangles.c merges them. */
#include "bake/mesh/shape.h"
#include "bake/mesh/triangles.h"

#include <string.h>

typedef struct soup {
    masu_bake_buffer positions, normals, texcoords, indices;
} soup;

static void add_corner(soup *s, masu_bake_vec3 position, masu_bake_vec3 normal, double u,
                       double v) {
    uint32_t index = (uint32_t)(s->indices.bytes / sizeof index);
    const float p[3] = {(float)position.x, (float)position.y, (float)position.z};
    const float n[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
    masu_bake_append(&s->positions, p, sizeof p);
    const float t[2] = {(float)u, (float)v};
    masu_bake_append(&s->normals, n, sizeof n);
    masu_bake_append(&s->texcoords, t, sizeof t);
    masu_bake_append(&s->indices, &index, sizeof index);
}

/* tile 0: without texture coordinates. */
static void finish(masu_bake_content *piece, soup *s, const char *name, double tile) {
    masu_blob_material material = masu_bake_default_material();
    masu_bake_triangles triangles = {
        .positions = (const float *)(const void *)s->positions.data,
        .normals = (const float *)(const void *)s->normals.data,
        .texcoords = tile != 0 ? (const float *)(const void *)s->texcoords.data : NULL,
        .vertex_count = (uint32_t)(s->indices.bytes / sizeof(uint32_t)),
        .indices = (const uint32_t *)(const void *)s->indices.data,
        .index_count = s->indices.bytes / sizeof(uint32_t),
        .material = masu_bake_material(piece, &material, ""),
    };
    masu_bake_losses losses = {0};
    masu_bake_add_triangles(piece, &triangles, &losses);
    uint32_t primitives = (uint32_t)masu_bake_count(piece, MASU_BLOB_PRIMITIVES);
    if (primitives) { /* none: a shape so flat that its triangles have no area in fp32 */
        uint32_t text = masu_bake_name(piece, name, strlen(name));
        uint32_t mesh = masu_bake_mesh(piece, 0, primitives, text);
        masu_bake_affine identity = masu_bake_identity();
        masu_bake_instance(piece, &identity, mesh, MASU_BLOB_NONE, MASU_BLOB_NONE);
    }
    masu_bake_release(&s->positions);
    masu_bake_release(&s->normals);
    masu_bake_release(&s->texcoords);
    masu_bake_release(&s->indices);
}

static masu_bake_vec3 middle(masu_bake_vec3 a, masu_bake_vec3 b) {
    masu_bake_vec3 m = masu_bake_mad(a, b, 1.0); /* a + b: the same bits from either side */
    masu_bake_normalize(&m);
    return m;
}

/* Longitude and latitude; u without the seam between -x and itself, which `near` settles. */
static double longitude(masu_bake_vec3 p, double near) {
    double u = 0.5 - atan2(p.z, p.x) / (2 * MASU_BAKE_PI);
    return u + round(near - u);
}

static void add_sphere_corners(soup *s, double radius, const masu_bake_vec3 corners[3],
                               double tile) {
    const masu_bake_vec3 zero = {0, 0, 0};
    masu_bake_vec3 sum = masu_bake_mad(masu_bake_mad(corners[0], corners[1], 1), corners[2], 1);
    double near = longitude(sum, 0.5);
    for (int i = 0; i < 3; i++) {
        masu_bake_vec3 p = corners[i];
        /* A pole has every longitude: that of its triangle's middle distorts least. */
        double u = fabs(p.y) > 1 - 1e-12 ? near : longitude(p, near);
        double v = acos(fmin(fmax(p.y, -1), 1)) / MASU_BAKE_PI;
        add_corner(s, masu_bake_mad(zero, p, radius), p, 2 * tile * u, tile * v);
    }
}

static void split(soup *s, double radius, masu_bake_vec3 a, masu_bake_vec3 b, masu_bake_vec3 c,
                  uint32_t times, double tile) {
    if (times > 0) {
        masu_bake_vec3 ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        split(s, radius, a, ab, ca, times - 1, tile);
        split(s, radius, ab, b, bc, times - 1, tile);
        split(s, radius, ca, bc, c, times - 1, tile);
        split(s, radius, ab, bc, ca, times - 1, tile);
        return;
    }
    const masu_bake_vec3 corners[3] = {a, b, c};
    add_sphere_corners(s, radius, corners, tile);
}

void masu_bake_sphere(masu_bake_content *piece, double radius, uint32_t subdivisions, double tile) {
    static const unsigned char faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    const double g = 0.5 + sqrt(1.25); /* the golden ratio: three crossed rectangles 2 by 2 g */
    masu_bake_vec3 corners[12] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                  {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                  {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    for (int i = 0; i < 12; i++) masu_bake_normalize(&corners[i]);
    soup s = {{0}, {0}, {0}, {0}};
    for (int i = 0; i < 20; i++) {
        split(&s, radius, corners[faces[i][0]], corners[faces[i][1]], corners[faces[i][2]],
              subdivisions, tile);
    }
    finish(piece, &s, "sphere", tile);
}

/* The rectangle center +- u +- v along axes, visible from the side of u x v. A texture on it is
 * upright from outside; on a horizontal face its upper edge is at -Z. */
static void add_face(soup *s, masu_bake_vec3 center, masu_bake_vec3 u, masu_bake_vec3 v,
                     double tile) {
    masu_bake_vec3 normal = masu_bake_cross(u, v), zero = {0, 0, 0};
    masu_bake_normalize(&normal);
    masu_bake_vec3 up = fabs(normal.y) > 0.5 ? masu_bake_v3(0, 0, -1) : masu_bake_v3(0, 1, 0);
    masu_bake_vec3 right = masu_bake_cross(up, normal);
    double across = fabs(masu_bake_dot(u, right)) + fabs(masu_bake_dot(v, right));
    double along = fabs(masu_bake_dot(u, up)) + fabs(masu_bake_dot(v, up));
    static const signed char corners[6][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
    for (int i = 0; i < 6; i++) {
        masu_bake_vec3 p = masu_bake_mad(center, u, corners[i][0]);
        masu_bake_vec3 offset =
            masu_bake_mad(masu_bake_mad(zero, u, corners[i][0]), v, corners[i][1]);
        add_corner(s, masu_bake_mad(p, v, corners[i][1]), normal,
                   tile * (0.5 + masu_bake_dot(offset, right) / across / 2),
                   tile * (0.5 - masu_bake_dot(offset, up) / along / 2));
    }
}

void masu_bake_cuboid(masu_bake_content *piece, masu_bake_vec3 size, double tile) {
    soup s = {{0}, {0}, {0}, {0}};
    const double h[3] = {size.x / 2, size.y / 2, size.z / 2};
    for (int axis = 0; axis < 3; axis++) {
        for (int side = -1; side <= 1; side += 2) {
            double c[3] = {0}, u[3] = {0}, v[3] = {0};
            int a = (axis + 1) % 3, b = (axis + 2) % 3;
            c[axis] = side * h[axis];
            u[a] = side * h[a]; /* changes the winding with the side */
            v[b] = h[b];
            add_face(&s, masu_bake_v3(c[0], c[1], c[2]), masu_bake_v3(u[0], u[1], u[2]),
                     masu_bake_v3(v[0], v[1], v[2]), tile);
        }
    }
    finish(piece, &s, "box", tile);
}

void masu_bake_plane(masu_bake_content *piece, double size_x, double size_z, double tile) {
    soup s = {{0}, {0}, {0}, {0}};
    add_face(&s, masu_bake_v3(0, 0, 0), masu_bake_v3(0, 0, size_z / 2),
             masu_bake_v3(size_x / 2, 0, 0), tile);
    finish(piece, &s, "plane", tile);
}

void masu_bake_make_shape(const masu_bake_shape *shape, bool mapped, masu_bake_content *piece) {
    double tile = mapped ? shape->tile : 0;
    switch (shape->kind) {
    case MASU_BAKE_SPHERE: masu_bake_sphere(piece, shape->size.x, shape->subdivisions, tile); break;
    case MASU_BAKE_BOX: masu_bake_cuboid(piece, shape->size, tile); break;
    case MASU_BAKE_PLANE: masu_bake_plane(piece, shape->size.x, shape->size.z, tile); break;
    }
}
