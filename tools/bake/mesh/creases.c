/* creases.c: computes normals for triangles that have none; see creases.h.
 *
 * Sorting finds corners with identical position bits. Shared vertices carry no information: some
 * formats share all vertices, others none. The normal of a corner is the sum of the normals of the
 * surrounding faces within the crease angle of its own face, weighted by their angles at the corner
 * (Thuermer and Wuethrich 1998: no other weight is independent of how a polygon was triangulated).
 * The importer's own function is not used: it assumes that no vertex is shared, and gives a cube of
 * eight vertices the normals of whichever face was last. */
#include "bake/mesh/creases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* cos(60 degrees), minus a rounding allowance: the sides of a hexagonal prism are at 60 degrees. */
#define CREASE 0.4999

/* Each corner is compared with all others at its position. Above this number, which no real surface
 * reaches, it is compared with none, to bound the time. */
#define AROUND_MAX 512

typedef struct corner {
    float position[3];
    uint32_t at; /* which corner */
} corner;

typedef struct face {
    masu_bake_vec3 normal; /* unit */
    double angle[3];
} face;

static int by_position(const void *a, const void *b) {
    const corner *x = a, *y = b;
    for (int k = 0; k < 3; k++) {
        if (x->position[k] != y->position[k]) return x->position[k] < y->position[k] ? -1 : 1;
    }
    return x->at < y->at ? -1 : x->at > y->at;
}

static double angle_between(masu_bake_vec3 a, masu_bake_vec3 b) {
    return atan2(masu_bake_length(masu_bake_cross(a, b)), masu_bake_dot(a, b));
}

static void measure(const masu_bake_triangles *t, const uint32_t *three, face *out) {
    masu_bake_vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = masu_bake_v3f(t->positions + 3 * (size_t)three[k]);
    for (int k = 0; k < 3; k++)
        out->angle[k] =
            angle_between(masu_bake_sub(p[(k + 1) % 3], p[k]), masu_bake_sub(p[(k + 2) % 3], p[k]));
    out->normal = masu_bake_cross(masu_bake_sub(p[1], p[0]), masu_bake_sub(p[2], p[0]));
    if (!masu_bake_normalize(&out->normal)) out->normal = masu_bake_v3(0, 1, 0);
}

/* Smooths the corners at one position. */
static void smooth(const face *faces, const corner *here, uint64_t count, int16_t (*out)[2]) {
    for (uint64_t i = 0; i < count; i++) {
        const masu_bake_vec3 own = faces[here[i].at / 3].normal;
        masu_bake_vec3 sum = {0, 0, 0};
        for (uint64_t j = 0; j < count && count <= AROUND_MAX; j++) {
            const face *f = &faces[here[j].at / 3];
            if (masu_bake_dot(own, f->normal) >= CREASE)
                sum = masu_bake_mad(sum, f->normal, f->angle[here[j].at % 3]);
        }
        if (!masu_bake_normalize(&sum)) sum = own;
        masu_bake_encode_normal(sum, out[here[i].at]);
    }
}

void masu_bake_creased_normals(const masu_bake_triangles *t, const uint32_t *corners,
                               uint64_t count, int16_t (*out)[2]) {
    if (!count) return;
    face *faces = masu_bake_allocate((size_t)(count / 3) * sizeof *faces);
    corner *sorted = masu_bake_allocate((size_t)count * sizeof *sorted);
    for (uint64_t i = 0; i < count; i += 3) measure(t, corners + i, &faces[i / 3]);
    for (uint64_t i = 0; i < count; i++) {
        /* -0 is 0 */
        for (int k = 0; k < 3; k++)
            sorted[i].position[k] = t->positions[3 * (size_t)corners[i] + (size_t)k] + 0;
        sorted[i].at = (uint32_t)i;
    }
    qsort(sorted, (size_t)count, sizeof *sorted, by_position);
    for (uint64_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count; end++) {
            if (memcmp(sorted[i].position, sorted[end].position, sizeof sorted[i].position) != 0)
                break;
        }
        smooth(faces, sorted + i, end - i, out);
    }
    free(sorted);
    free(faces);
}
