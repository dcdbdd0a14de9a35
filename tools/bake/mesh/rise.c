/* rise.c: see rise.h. An edge of length e whose end normals differ by d along it is the chord of an
 * arc of height e d / 8: 8.6 mm on an edge of a sphere of 1 m in 24 segments. */
#include "bake/mesh/rise.h"

#include "bake/mesh/triangles.h"

#include <math.h>

/* A box with smoothed normals is meant to be a box: edges that turn by more than 45 degrees are no
 * chords. */
static const double least_cosine = 0.70;
/* Of the primitive's diagonal: shadows may begin no farther inside of their casters than that. */
static const double most = 0.01;

static double rise_of(const masu_blob_vertex *a, const masu_blob_vertex *b) {
    masu_bake_vec3 edge = masu_bake_sub(masu_bake_v3f(b->position), masu_bake_v3f(a->position));
    masu_bake_vec3 from = masu_bake_decode_normal(a->normal),
                   to = masu_bake_decode_normal(b->normal);
    if (masu_bake_dot(from, to) < least_cosine) return 0;
    /* Below 0 where the surface is concave. */
    return masu_bake_dot(masu_bake_sub(to, from), edge) / 8;
}

void masu_bake_measure_rise(masu_bake_content *content) {
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
        p->rise = (float)fmin(rise, most * masu_bake_length(diagonal));
    }
}
