/* vertex_color.c: see vertex_color.h. */
#include "bake/import/vertex_color.h"
#include "bake/import/assimp.h"

#include <stdlib.h>
#include <string.h>

#define GROUPS_MAX 64u

typedef struct key {
    float color[4];
    uint32_t triangle;
} key;

static int by_color(const void *a, const void *b) {
    const key *x = a, *y = b;
    int order = memcmp(x->color, y->color, sizeof x->color);
    return order ? order : x->triangle < y->triangle ? -1 : x->triangle > y->triangle;
}

/* Sorts triangles by colour. Returns how many colours. */
static uint32_t sort_colors(const key *means, uint32_t count, key *out) {
    uint32_t colors = 0;
    memcpy(out, means, count * sizeof *out);
    qsort(out, count, sizeof *out, by_color);
    for (uint32_t i = 0; i < count; i++)
        colors += !i || memcmp(out[i].color, out[i - 1].color, sizeof out->color) != 0;
    return colors;
}

/* The mean colour of each triangle; returns whether each triangle has only one colour. */
static bool mean_colors(const float *colors, uint32_t vertices, const uint32_t *indices,
                        uint32_t triangles, bool opaque, key *means, uint32_t *clamped) {
    bool plain = true;
    for (uint32_t i = 0; i < triangles; i++) {
        const uint32_t *corner = indices + 3 * (size_t)i;
        bool beyond = false;
        means[i] = (key){{0}, i};
        if (corner[0] >= vertices || corner[1] >= vertices || corner[2] >= vertices) continue;
        for (int k = 0; k < 4; k++) {
            float c[3];
            for (int j = 0; j < 3; j++) {
                float own = colors[4 * (size_t)corner[j] + (size_t)k];
                beyond = beyond || !(own >= 0 && own <= 1 + 1e-6f);
                c[j] = masu_import_clamped((double)own, 0, 1);
            }
            if (k == 3 && opaque) c[0] = c[1] = c[2] = 1;
            plain = plain && fabsf(c[0] - c[1]) < 1.0f / 1024 && fabsf(c[0] - c[2]) < 1.0f / 1024;
            means[i].color[k] = c[0] == c[1] && c[0] == c[2] ? c[0] : (c[0] + c[1] + c[2]) / 3;
        }
        *clamped += beyond;
    }
    return plain;
}

void masu_import_group_colors(masu_bake_pool *pool, const float *colors, uint32_t vertices,
                              const uint32_t *indices, uint32_t triangles, bool opaque,
                              masu_import_colors *out) {
    key *means = masu_bake_take(pool, triangles * sizeof *means),
        *sorted = masu_bake_take(pool, triangles * sizeof *sorted);
    *out =
        (masu_import_colors){.triangles = masu_bake_take(pool, triangles * sizeof *out->triangles)};
    bool plain = mean_colors(colors, vertices, indices, triangles, opaque, means, &out->clamped);
    for (uint32_t i = 0; i < vertices && !opaque; i++)
        out->translucent = out->translucent || colors[4 * (size_t)i + 3] < 0.999f;
    uint32_t count = plain ? sort_colors(means, triangles, sorted) : 0;
    out->exact = plain && count <= GROUPS_MAX;
    if (!out->exact) return;
    out->groups = masu_bake_take(pool, count * sizeof *out->groups);
    for (uint32_t i = 0, next; i < triangles; i = next) {
        masu_import_color *to = &out->groups[out->count++];
        for (next = i;
             next < triangles && !memcmp(sorted[next].color, sorted[i].color, sizeof sorted->color);
             next++)
            out->triangles[next] = sorted[next].triangle;
        to->first = i;
        to->count = next - i;
        for (int k = 0; k < 4; k++) to->color[k] = (double)sorted[i].color[k];
    }
}
