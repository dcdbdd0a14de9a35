/* import.c: see input.h. A child process reads the model like masu-bake. Base colours are used,
 * textures are not. */
#include "meso/input.h"

#include "bake/import/import.h"
#include "cli/cli.h"

static void take_primitive(const masu_bake_content *piece, const masu_blob_primitive *p,
                           const masu_bake_affine *world, double scale, masu_bake_vec3 low,
                           masu_meso_patch *patch) {
    const float *base = MASU_BAKE_MATERIALS(piece)[p->material].base_color;
    const double color[3] = {(double)base[0], (double)base[1], (double)base[2]};
    uint32_t first = patch->vertex_count;
    for (uint32_t k = 0; k < p->vertex_count; k++) {
        const float *v = MASU_BAKE_VERTICES(piece)[p->first_vertex + k].position;
        masu_bake_vec3 at = masu_bake_sub(masu_bake_apply(world, masu_bake_v3f(v)), low);
        masu_meso_vertex(patch, masu_bake_v3(at.x * scale, at.y * scale, at.z * scale), color);
    }
    const uint32_t *index = (const uint32_t *)(const void *)piece->section[MASU_BLOB_INDICES].data;
    for (uint32_t k = 0; k + 2 < p->index_count; k += 3) {
        const uint32_t *t = index + p->first_index + k;
        masu_meso_triangle(patch, first + t[0], first + t[1], first + t[2]);
    }
}

static void take_instance(const masu_bake_content *piece, uint64_t i, double scale,
                          masu_bake_vec3 low, masu_meso_patch *patch) {
    const masu_blob_instance *instance = &MASU_BAKE_INSTANCES(piece)[i];
    const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(piece)[instance->mesh];
    masu_bake_affine world = masu_bake_transform(instance);
    for (uint32_t j = 0; j < mesh->primitive_count; j++) {
        take_primitive(piece, &MASU_BAKE_PRIMITIVES(piece)[mesh->first_primitive + j], &world,
                       scale, low, patch);
    }
}

static uint64_t triangles_of(const masu_bake_content *piece) {
    uint64_t sum = 0;
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(piece)[MASU_BAKE_INSTANCES(piece)[i].mesh];
        for (uint32_t j = 0; j < m->primitive_count; j++) {
            sum += MASU_BAKE_PRIMITIVES(piece)[m->first_primitive + j].index_count / 3;
        }
    }
    return sum;
}

static bool take(const char *path, const masu_bake_content *piece, const masu_meso_input *input,
                 masu_meso_patch *patch) {
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box box = masu_bake_bounds(piece, &identity);
    uint64_t triangles = triangles_of(piece);
    if (triangles == 0 || triangles > MASU_MESO_TRIANGLES_MAX) {
        masu_cli_error("%s: expected 1 to %u triangles, found %llu", path,
                       MASU_MESO_TRIANGLES_MAX, (unsigned long long)triangles);
        return false;
    }
    double tile = input->tile > 0 ? input->tile : box.high.x - box.low.x;
    if (!(tile > 1e-9)) {
        masu_cli_error("%s: the model has no extent in x: use --tile", path);
        return false;
    }
    double height = (box.high.y - box.low.y) / tile;
    double reach = fmax(box.high.x - box.low.x, box.high.z - box.low.z) / tile;
    if (!(height <= MASU_MESO_HEIGHT_MAX) || !(reach <= 2)) {
        masu_cli_error(
            "%s: expected at most %g periods high and 2 wide, found %g and %g: use --tile", path,
            MASU_MESO_HEIGHT_MAX, height, reach);
        return false;
    }
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_INSTANCES); i++) {
        take_instance(piece, i, 1 / tile, box.low, patch);
    }
    patch->roughness = input->roughness;
    masu_meso_patch_finish(patch);
    return true;
}

bool masu_meso_read_model(const char *path, const masu_meso_input *input, masu_meso_patch *patch) {
    masu_bake_content piece = {0};
    *patch = (masu_meso_patch){0};
    bool good =
        masu_bake_import(path, MASU_BAKE_TEXTURES_OFF, &piece) && take(path, &piece, input, patch);
    masu_bake_content_release(&piece);
    return good;
}
