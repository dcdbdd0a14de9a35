/* patch.c: see patch.h. */
#include "meso/patch.h"

#include <stdio.h>
#include <stdlib.h>

#include "cli/cli.h"

static void *grown(void *block, size_t bytes) {
    void *r = realloc(block, bytes);
    if (!r) exit(masu_cli_error("out of memory: %zu bytes", bytes));
    return r;
}

uint32_t masu_meso_vertex(masu_meso_patch *patch, masu_meso_vec3 position, const double color[3]) {
    if (patch->vertex_count == patch->vertex_room) {
        patch->vertex_room = patch->vertex_room ? 2 * patch->vertex_room : 4096;
        size_t bytes = (size_t)patch->vertex_room * 3 * sizeof(float);
        patch->position = grown(patch->position, bytes);
        patch->color = grown(patch->color, bytes);
    }
    float *p = patch->position + 3 * (size_t)patch->vertex_count;
    float *c = patch->color + 3 * (size_t)patch->vertex_count;
    p[0] = (float)position.x;
    p[1] = (float)position.y;
    p[2] = (float)position.z;
    for (int k = 0; k < 3; k++) c[k] = (float)color[k];
    return patch->vertex_count++;
}

void masu_meso_triangle(masu_meso_patch *patch, uint32_t a, uint32_t b, uint32_t c) {
    if (patch->triangle_count == patch->triangle_room) {
        patch->triangle_room = patch->triangle_room ? 2 * patch->triangle_room : 4096;
        patch->index = grown(patch->index, (size_t)patch->triangle_room * 3 * sizeof(uint32_t));
    }
    uint32_t *t = patch->index + 3 * (size_t)patch->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

void masu_meso_patch_from_grid(masu_meso_patch *patch, const double *height, const double *color,
                               const double plain[3], uint32_t size) {
    uint32_t first = patch->vertex_count, row = size + 1;
    for (uint32_t z = 0; z <= size; z++) {
        for (uint32_t x = 0; x <= size; x++) {
            size_t at = (size_t)(z % size) * size + x % size;
            masu_meso_vertex(patch, masu_bake_v3((double)x / size, height[at], (double)z / size),
                             color ? color + 3 * at : plain);
        }
    }
    for (uint32_t z = 0; z < size; z++) {
        for (uint32_t x = 0; x < size; x++) {
            uint32_t a = first + z * row + x, b = a + 1, c = a + row, d = c + 1;
            /* The diagonal alternates between cells: otherwise all slopes would lean in one
             * direction. */
            if ((x ^ z) & 1) {
                masu_meso_triangle(patch, a, c, b);
                masu_meso_triangle(patch, b, c, d);
            } else {
                masu_meso_triangle(patch, a, c, d);
                masu_meso_triangle(patch, a, d, b);
            }
        }
    }
}

void masu_meso_patch_finish(masu_meso_patch *patch) {
    double low = 1e30, high = -1e30;
    for (uint32_t i = 0; i < patch->vertex_count; i++) {
        low = fmin(low, (double)patch->position[3 * (size_t)i + 1]);
        high = fmax(high, (double)patch->position[3 * (size_t)i + 1]);
    }
    if (!patch->vertex_count) low = high = 0;
    for (uint32_t i = 0; i < patch->vertex_count; i++) {
        patch->position[3 * (size_t)i + 1] -= (float)low;
    }
    patch->low = 0;
    patch->high = high - low;
}

void masu_meso_patch_free(masu_meso_patch *patch) {
    free(patch->position);
    free(patch->color);
    free(patch->index);
    *patch = (masu_meso_patch){0};
}
