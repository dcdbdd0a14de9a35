/* scene.c: see scene.h. reader.c finds the sections, check_*.c validate their contents. */
#include "scene/scene.h"

#include "base/error.h"
#include "scene/check.h"
#include "scene/material.h"
#include "scene/reader.h"
#include "scene/texture.h"

#include <string.h>

/* Every level of detail of a mesh has its own draws, and list entries for the mesh's instances. */
static void describe_draws(const reader *r, masu_scene_data *out) {
    uint32_t from = 0, first_lod;
    for (uint32_t m = 0; m < out->meshes; m++) {
        uint32_t first, end = masu_scene_mesh_instances(&r->view, out->instances, m, from, &first);
        const masu_blob_mesh *mesh = &r->view.meshes[m];
        uint32_t placed = end - first;
        from = end;
        if (placed > out->max_instances) out->max_instances = placed;
        if (mesh->primitive_count > out->max_primitives)
            out->max_primitives = mesh->primitive_count;
        if (!placed || !mesh->primitive_count) continue;
        uint32_t lods = masu_scene_mesh_lods(&r->view, out->lods, m, &first_lod);
        out->draws += mesh->primitive_count;
        out->lod_draws += lods * mesh->primitive_count;
        out->lod_instances += lods * placed;
        for (uint32_t p = 0; p < mesh->primitive_count; p++) {
            out->triangles +=
                (uint64_t)placed * (r->view.primitives[mesh->first_primitive + p].index_count / 3);
        }
    }
}

/* Fills the counts of a validated scene. */
static void describe(const reader *r, uint64_t blob_bytes, uint64_t pairs, masu_scene_data *out) {
    *out = (masu_scene_data){.blob = r->bytes,
                             .blob_bytes = blob_bytes,
                             .vertices = (uint32_t)r->counts[MASU_BLOB_VERTICES],
                             .indices = (uint32_t)r->counts[MASU_BLOB_INDICES],
                             .primitives = (uint32_t)r->counts[MASU_BLOB_PRIMITIVES],
                             .meshes = (uint32_t)r->counts[MASU_BLOB_MESHES],
                             .instances = (uint32_t)r->counts[MASU_BLOB_INSTANCES],
                             .lods = (uint32_t)r->counts[MASU_BLOB_LODS],
                             .materials = (uint32_t)r->counts[MASU_BLOB_MATERIALS],
                             .groups = (uint32_t)r->counts[MASU_BLOB_GROUPS],
                             .group_items = (uint32_t)r->counts[MASU_BLOB_GROUP_ITEMS],
                             .models = (uint32_t)r->counts[MASU_BLOB_MODELS],
                             .model_nodes = (uint32_t)r->counts[MASU_BLOB_MODEL_NODES],
                             .occluders = (uint32_t)r->counts[MASU_BLOB_OCCLUDERS],
                             .placed_occluders = (uint32_t)pairs,
                             .camera_keys = (uint32_t)r->counts[MASU_BLOB_CAMERA_KEYS],
                             .sdf = r->view.sdf != NULL,
                             .sdf_params = (uint32_t)r->counts[MASU_BLOB_SDF_PARAMS]};
    if (r->view.sdf) masu_describe_sdf(r, out);
    if (r->view.shadow && out->instances) { /* without polygons the map would be empty */
        out->shadow_cascades = r->view.shadow->cascades;
        out->shadow_resolution = r->view.shadow->resolution;
        out->shadow_distance = r->view.shadow->distance;
        out->shadow_lambda = r->view.shadow->lambda;
    }
    out->texture_arrays = (uint32_t)r->counts[MASU_BLOB_TEXTURES];
    out->texture_sets = (uint32_t)r->counts[MASU_BLOB_TEXTURE_SETS];
    out->vertex_colors = r->view.colors != NULL;
    out->second_texcoords = r->view.texcoords_1 != NULL;
    for (uint32_t i = 0; i < out->texture_arrays; i++) {
        const masu_blob_texture *t = &r->view.textures[i];
        out->textures += t->layers;
        out->texture_bytes += masu_blob_texture_bytes(t);
        out->texture_bytes_decoded += masu_texture_bytes(t, 0);
    }
    for (uint32_t i = 0; i < out->materials; i++) {
        if (r->view.materials[i].flags & MASU_MATERIAL_IS_MASK) out->masks = 1;
        if (r->view.materials[i].flags & MASU_MATERIAL_IS_SINGLE) out->singles = 1;
        if (masu_material_emits(&r->view.materials[i]))
            out->emissions |= 1u << masu_draw_kind(r->view.materials[i].flags);
    }
    masu_describe_looks(r, out);
    masu_describe_trace(r, out);
    masu_describe_skins(r, out);
    describe_draws(r, out);
}

/* Every item that has a name hashes it. A long name shared by many items would cause quadratic
 * work, so the total is limited. */
static masu_result check_names(reader *r) {
    uint64_t bytes = r->view.name_bytes;
    for (uint64_t at = 0; at < bytes;) {
        const char *end = memchr(r->view.names + at, '\0', (size_t)(bytes - at));
        if (!end) return bad(r, "names", bytes - 1, "does not end with NUL");
        if ((uint64_t)(end - r->view.names) - at > MASU_BLOB_NAME_MAX)
            return bad(r, "names", at, "a name is longer than 255 bytes");
        at = (uint64_t)(end - r->view.names) + 1;
    }
    return MASU_OK;
}

masu_result masu_scene_bind(const void *blob, uint64_t blob_bytes, masu_scene *out,
                            masu_detail *detail) {
    if (!blob || !out) return masu_fail_null(detail, blob ? "out" : "blob");
    unsigned beyond = (unsigned)((uintptr_t)blob % MASU_BLOB_ALIGN);
    if (beyond) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "blob", MASU_BLOB_ALIGN, beyond,
                         "blob lies %u bytes behind a multiple of %u, where it has to begin",
                         beyond, MASU_BLOB_ALIGN);
    }
    reader r = {.bytes = blob, .detail = detail};
    masu_result result = masu_read_header(&r, blob_bytes);
    if (!result) result = masu_read_sections(&r, blob_bytes);
    if (!result) result = check_names(&r);
    if (!result) result = masu_check_geometry(&r);
    uint64_t pairs = 0;
    if (!result) result = masu_check_models(&r);
    if (!result) result = masu_check_groups(&r);
    if (!result) result = masu_check_occluders(&r, &pairs);
    if (!result) result = masu_check_clips(&r);
    if (!result) result = masu_check_skins(&r);
    if (!result) result = masu_check_looks(&r);
    if (!result) result = masu_check_textures(&r);
    if (!result) result = masu_check_sdf(&r);
    if (!result) result = masu_check_code(&r);
    if (!result) result = masu_check_trace(&r);
    if (!result) result = masu_check_skin_trees(&r);
    if (result) return result;
    *out = (masu_scene){0};
    describe(&r, blob_bytes, pairs, (masu_scene_data *)(void *)out);
    return MASU_OK;
}

masu_scene_view masu_scene_data_view(const masu_scene_data *scene) {
    reader r = {.bytes = scene->blob};
    (void)masu_read_sections(&r, scene->blob_bytes); /* succeeded on these bytes before */
    return r.view;
}
