/* scene.c: see scene.h. reader.c finds the sections, check_*.c look at what is in them. */
#include "scene/scene.h"

#include "base/error.h"
#include "scene/check.h"
#include "scene/reader.h"
#include "scene/texture.h"

#include <string.h>

/* Every form of a mesh has draws of its own, and room for the numbers of its instances. */
static void look_at_draws(const reader *r, masu_scene *out) {
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

/* What the public struct tells of a scene that has passed. */
static void describe(const reader *r, uint64_t blob_bytes, uint64_t pairs, masu_scene *out) {
    *out = (masu_scene){.blob = r->bytes,
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
    if (r->view.sdf) masu_look_at_sdf(r, out);
    if (r->view.shadow && out->instances) { /* without polygons there is nothing to draw into it */
        out->shadow_cascades = r->view.shadow->cascades;
        out->shadow_resolution = r->view.shadow->resolution;
        out->shadow_distance = r->view.shadow->distance;
        out->shadow_lambda = r->view.shadow->lambda;
    }
    out->texture_arrays = (uint32_t)r->counts[MASU_BLOB_TEXTURES];
    out->texture_sets = (uint32_t)r->counts[MASU_BLOB_TEXTURE_SETS];
    for (uint32_t i = 0; i < out->texture_arrays; i++) {
        const masu_blob_texture *t = &r->view.textures[i];
        out->textures += t->layers;
        out->texture_bytes += masu_blob_texture_bytes(t);
        out->texture_bytes_decoded += masu_texture_bytes(t, 0);
    }
    for (uint32_t i = 0; i < out->materials; i++) {
        if (r->view.materials[i].flags & MASU_MATERIAL_IS_MASK) out->masks = 1;
        if (r->view.materials[i].flags & MASU_MATERIAL_IS_SINGLE) out->singles = 1;
    }
    masu_look_at_looks(r, out);
    masu_look_at_trace(r, out);
    masu_look_at_skins(r, out);
    look_at_draws(r, out);
}

/* Names are hashed for each thing that has one: a long one that many share would be work without measure. */
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
    describe(&r, blob_bytes, pairs, out);
    return MASU_OK;
}

masu_scene_view masu_scene_look(const masu_scene *scene) {
    reader r = {.bytes = scene->blob};
    (void)masu_read_sections(&r, scene->blob_bytes); /* has passed once on these bytes */
    return r.view;
}

int32_t masu_scene_sdf_param(const masu_scene *scene, const char *name) {
    if (!scene || !scene->blob || !name) return -1;
    masu_scene_view v = masu_scene_look(scene);
    for (uint32_t i = 0; i < scene->sdf_params; i++) {
        if (v.sdf_params[i].name != MASU_BLOB_NONE &&
            !strcmp(v.names + v.sdf_params[i].name, name)) {
            return (int32_t)i;
        }
    }
    return -1;
}

/* A name of the blob, which has passed. */
static const char *text_of(const masu_scene_view *v, uint32_t name) {
    return name == MASU_BLOB_NONE ? "" : v->names + name;
}

const char *masu_scene_instance_name(const masu_scene *scene, uint32_t index) {
    if (!scene || !scene->blob || index >= scene->instances) return "";
    masu_scene_view v = masu_scene_look(scene);
    return text_of(&v, v.instances[index].name);
}

const char *masu_scene_model_name(const masu_scene *scene, uint32_t index) {
    if (!scene || !scene->blob || index >= scene->models) return "";
    masu_scene_view v = masu_scene_look(scene);
    return text_of(&v, v.models[index].name);
}

const char *masu_scene_clip_name(const masu_scene *scene, uint32_t model, uint32_t clip) {
    if (!scene || !scene->blob || model >= scene->models) return "";
    masu_scene_view v = masu_scene_look(scene);
    for (uint32_t i = 0; i < scene->clips; i++) {
        if (v.clips[i].model == v.models[model].like && !clip--) return text_of(&v, v.clips[i].name);
    }
    return "";
}

const char *masu_scene_material_name(const masu_scene *scene, uint32_t index) {
    if (!scene || !scene->blob || index >= scene->materials) return "";
    masu_scene_view v = masu_scene_look(scene);
    return text_of(&v, v.materials[index].name);
}

const char *masu_scene_light_name(const masu_scene *scene, uint32_t index) {
    if (!scene || !scene->blob || index >= scene->lights) return "";
    masu_scene_view v = masu_scene_look(scene);
    return text_of(&v, v.lights[index].name);
}
