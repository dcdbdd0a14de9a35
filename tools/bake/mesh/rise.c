/* rise.c: see rise.h. An edge of length e whose end normals differ by d along it is the chord of an
 * arc of height e d / 8: 8.6 mm on an edge of a sphere of 1 m in 24 segments. */
#include "bake/mesh/rise.h"

#include "bake/mesh/triangles.h"

#include <math.h>
#include <stdlib.h>

/* A box with smoothed normals is meant to be a box: edges whose normals differ by more than 45
 * degrees are not chords. */
static const double least_cosine = 0.70;
/* Limit of the rise as a share of the primitive's diagonal: shadows may begin no farther inside
 * their casters. */
static const double most = 0.01;
/* Limit of the rise as a share of the radius of curvature of the primitive's thin parts: the shadow
 * of a leg shrinks by no more. Thin parts are the thinnest 5 % of its area. */
static const double most_of_radius = 0.1;
static const double thin_share = 0.05;

static double rise_of(const masu_blob_vertex *a, const masu_blob_vertex *b) {
    masu_bake_vec3 edge = masu_bake_sub(masu_bake_v3f(b->position), masu_bake_v3f(a->position));
    masu_bake_vec3 from = masu_bake_decode_normal(a->normal),
                   to = masu_bake_decode_normal(b->normal);
    if (masu_bake_dot(from, to) < least_cosine) return 0;
    /* Below 0 where the surface is concave. */
    return masu_bake_dot(masu_bake_sub(to, from), edge) / 8;
}

typedef struct curved {
    double radius, area;
} curved;

static int by_radius(const void *a, const void *b) {
    const double x = ((const curved *)a)->radius, y = ((const curved *)b)->radius;
    return (x > y) - (x < y);
}

/* Radius of the arc whose chord is the edge. The angle has no limit: a leg with four sides is thin,
 * too. */
static double radius_of(const masu_blob_vertex *a, const masu_blob_vertex *b) {
    masu_bake_vec3 edge = masu_bake_sub(masu_bake_v3f(b->position), masu_bake_v3f(a->position));
    masu_bake_vec3 turn =
        masu_bake_sub(masu_bake_decode_normal(b->normal), masu_bake_decode_normal(a->normal));
    double convex = masu_bake_dot(turn, edge);
    return convex > 0 ? masu_bake_dot(edge, edge) / convex : HUGE_VAL;
}

/* The radius that all but thin_share of the surface has at least. A triangle has the radius of its
 * most curved edge. */
static double thin_radius(const masu_blob_vertex *vertices, const uint32_t *indices,
                          uint32_t triangles, curved *room) {
    double area = 0, thin = 0;
    for (uint32_t t = 0; t < triangles; t++) {
        const masu_blob_vertex *v[3];
        for (int c = 0; c < 3; c++) v[c] = &vertices[indices[3 * t + (uint32_t)c]];
        masu_bake_vec3 first = masu_bake_v3f(v[0]->position);
        masu_bake_vec3 cross = masu_bake_cross(masu_bake_sub(masu_bake_v3f(v[1]->position), first),
                                               masu_bake_sub(masu_bake_v3f(v[2]->position), first));
        room[t] = (curved){
            fmin(radius_of(v[0], v[1]), fmin(radius_of(v[1], v[2]), radius_of(v[2], v[0]))),
            masu_bake_length(cross)};
        area += room[t].area;
    }
    qsort(room, triangles, sizeof *room, by_radius);
    for (uint32_t t = 0; t < triangles; t++) {
        thin += room[t].area;
        if (thin >= thin_share * area) return room[t].radius;
    }
    return HUGE_VAL;
}

void masu_bake_measure_rise(masu_bake_content *content) {
    curved *room =
        masu_bake_allocate((1 + masu_bake_count(content, MASU_BLOB_INDICES) / 3) * sizeof *room);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_PRIMITIVES); i++) {
        masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[i];
        const masu_blob_vertex *vertices = &MASU_BAKE_VERTICES(content)[p->first_vertex];
        const uint32_t *indices = &MASU_BAKE_INDICES(content)[p->first_index];
        masu_bake_vec3 diagonal =
            masu_bake_sub(masu_bake_v3f(p->aabb_max), masu_bake_v3f(p->aabb_min));
        double rise = 0;
        for (uint32_t k = 0; k < p->index_count; k++) {
            uint32_t next = k % 3 == 2 ? k - 2 : k + 1;
            rise = fmax(rise, rise_of(&vertices[indices[k]], &vertices[indices[next]]));
        }
        rise = fmin(rise, most * masu_bake_length(diagonal));
        if (rise > 0)
            rise = fmin(rise,
                        most_of_radius * thin_radius(vertices, indices, p->index_count / 3, room));
        p->rise = (float)rise;
    }
    free(room);
}
