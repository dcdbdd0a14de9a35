/* drop.c: see drop.h.
 *
 * Rasterises two height fields from above, over the model's bounds: the lowest heights of the model
 * and the highest of the scene below. A triangle writes its height at the centres of the cells that
 * it covers; each vertex also writes its height to the cell that contains it, so that no detail
 * between the centres is lost. The model falls by the smallest gap of any cell. */
#include "bake/mesh/drop.h"

#include <stdlib.h>

#define CELLS MASU_BAKE_DROP_CELLS

typedef struct field {
    masu_bake_vec3 low; /* minimum of the bounds */
    double cell[2];     /* along x and z */
    double top;         /* surfaces above are ignored */
    double *heights;    /* of cells, by z and x */
    bool lowest;        /* keep the lowest height of each cell, otherwise the highest */
} field;

static void keep(field *f, int x, int z, double height) {
    double *at = &f->heights[z * CELLS + x];
    if (height > f->top) return;
    if (f->lowest ? height < *at : height > *at) *at = height;
}

static int cell_of(double at, double low, double cell) {
    double index = floor((at - low) / cell);
    return index < 0        ? -1
           : index >= CELLS ? (at <= low + cell * CELLS * (1 + 1e-9) ? CELLS - 1 : CELLS)
                            : (int)index;
}

static void add_vertex(field *f, masu_bake_vec3 p) {
    int x = cell_of(p.x, f->low.x, f->cell[0]), z = cell_of(p.z, f->low.z, f->cell[1]);
    if (x >= 0 && x < CELLS && z >= 0 && z < CELLS) keep(f, x, z, p.y);
}

static int clamp_cell(double at, double low, double cell) {
    double index = (at - low) / cell;
    return index < 0 ? 0 : index > CELLS - 1 ? CELLS - 1 : (int)index;
}

static void add_triangle(field *f, const masu_bake_vec3 p[3]) {
    double low[2] = {fmin(p[0].x, fmin(p[1].x, p[2].x)), fmin(p[0].z, fmin(p[1].z, p[2].z))};
    double high[2] = {fmax(p[0].x, fmax(p[1].x, p[2].x)), fmax(p[0].z, fmax(p[1].z, p[2].z))};
    if (high[0] < f->low.x || low[0] > f->low.x + f->cell[0] * CELLS || high[1] < f->low.z ||
        low[1] > f->low.z + f->cell[1] * CELLS)
        return;
    for (int k = 0; k < 3; k++) add_vertex(f, p[k]);
    double area = (p[1].x - p[0].x) * (p[2].z - p[0].z) - (p[2].x - p[0].x) * (p[1].z - p[0].z);
    if (area == 0) return; /* a line when projected; its ends have been written */
    int x0 = clamp_cell(low[0], f->low.x, f->cell[0]),
        x1 = clamp_cell(high[0], f->low.x, f->cell[0]);
    int z0 = clamp_cell(low[1], f->low.z, f->cell[1]),
        z1 = clamp_cell(high[1], f->low.z, f->cell[1]);
    for (int z = z0; z <= z1; z++) {
        for (int x = x0; x <= x1; x++) {
            double qx = f->low.x + (x + 0.5) * f->cell[0], qz = f->low.z + (z + 0.5) * f->cell[1];
            double b =
                ((qx - p[0].x) * (p[2].z - p[0].z) - (p[2].x - p[0].x) * (qz - p[0].z)) / area;
            double c =
                ((p[1].x - p[0].x) * (qz - p[0].z) - (qx - p[0].x) * (p[1].z - p[0].z)) / area;
            if (b < 0 || c < 0 || b + c > 1) continue;
            keep(f, x, z, p[0].y + b * (p[1].y - p[0].y) + c * (p[2].y - p[0].y));
        }
    }
}

static void add_content(field *f, const masu_bake_content *c, const masu_bake_affine *placement) {
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *instance = &MASU_BAKE_INSTANCES(c)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(c)[instance->mesh];
        masu_bake_affine own = masu_bake_transform(instance),
                         world = masu_bake_multiply(placement, &own);
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[mesh->first_primitive + j];
            const uint32_t *indices = MASU_BAKE_INDICES(c) + p->first_index;
            for (uint32_t k = 0; k + 2 < p->index_count; k += 3) {
                masu_bake_vec3 corners[3];
                for (uint32_t n = 0; n < 3; n++) {
                    const float *v =
                        MASU_BAKE_VERTICES(c)[p->first_vertex + indices[k + n]].position;
                    corners[n] = masu_bake_apply(&world, masu_bake_v3f(v));
                }
                add_triangle(f, corners);
            }
        }
    }
}

double masu_bake_drop(const masu_bake_content *scene, const masu_bake_content *piece,
                      const masu_bake_affine *placement, double ground) {
    masu_bake_box box = masu_bake_bounds(piece, placement);
    if (masu_bake_box_is_empty(&box)) return 0;
    masu_bake_vec3 extent = masu_bake_sub(box.high, box.low);
    double least = fmax(fmax(extent.x, extent.z) * 1e-6, 1e-9);
    const masu_bake_affine identity = masu_bake_identity();
    double *heights = masu_bake_allocate(2 * CELLS * CELLS * sizeof *heights);
    field model = {box.low,
                   {fmax(extent.x, least) / CELLS, fmax(extent.z, least) / CELLS},
                   HUGE_VAL,
                   heights,
                   true};
    field below = model;
    below.heights = heights + CELLS * CELLS;
    below.lowest = false;
    below.top = box.low.y + extent.y / 2;
    for (int i = 0; i < CELLS * CELLS; i++) {
        model.heights[i] = HUGE_VAL;
        below.heights[i] = ground;
    }
    add_content(&model, piece, placement);
    add_content(&below, scene, &identity);
    double gap = HUGE_VAL;
    for (int i = 0; i < CELLS * CELLS; i++) gap = fmin(gap, model.heights[i] - below.heights[i]);
    free(heights);
    return isfinite(gap) ? gap : 0;
}
