/* scene_query.c: the public queries of a validated scene. No allocation, no state. */
#include "scene/scene.h"

#include <string.h>

/* A scene without content, for NULL. */
static const masu_scene_data *data_of(const masu_scene *scene) {
    static const masu_scene_data empty;
    return scene ? masu_scene_data_of(scene) : &empty;
}

static uint32_t count_of(const masu_scene_data *s, masu_scene_item item) {
    switch (item) {
    case MASU_SCENE_INSTANCE: return s->instances;
    case MASU_SCENE_MODEL: return s->models;
    case MASU_SCENE_LIGHT: return s->lights;
    case MASU_SCENE_MATERIAL: return s->materials;
    case MASU_SCENE_SDF_PARAM: return s->sdf_params;
    case MASU_SCENE_CAMERA_KEY: return s->camera_keys;
    }
    return 0;
}

/* ---- Names ----------------------------------------------------------------------------------- */

static const char *text_of(const masu_scene_view *v, uint32_t name) {
    return name == MASU_BLOB_NONE ? "" : v->names + name;
}

/* The name of an item; `index` must be valid. */
static const char *name_of(const masu_scene_view *v, masu_scene_item item, uint32_t index) {
    switch (item) {
    case MASU_SCENE_INSTANCE: return text_of(v, v->instances[index].name);
    case MASU_SCENE_MODEL: return text_of(v, v->models[index].name);
    case MASU_SCENE_LIGHT: return text_of(v, v->lights[index].name);
    case MASU_SCENE_MATERIAL: return text_of(v, v->materials[index].name);
    case MASU_SCENE_SDF_PARAM: return text_of(v, v->sdf_params[index].name);
    case MASU_SCENE_CAMERA_KEY: break;
    }
    return "";
}

uint32_t masu_scene_count(const masu_scene *scene, masu_scene_item item) {
    return count_of(data_of(scene), item);
}

const char *masu_scene_name(const masu_scene *scene, masu_scene_item item, uint32_t index) {
    const masu_scene_data *s = data_of(scene);
    if (!s->blob || index >= count_of(s, item)) return "";
    masu_scene_view v = masu_scene_data_view(s);
    return name_of(&v, item, index);
}

int32_t masu_scene_find(const masu_scene *scene, masu_scene_item item, const char *name) {
    const masu_scene_data *s = data_of(scene);
    if (!s->blob || !name || !*name) return -1;
    masu_scene_view v = masu_scene_data_view(s);
    for (uint32_t i = 0; i < count_of(s, item); i++) {
        if (!strcmp(name_of(&v, item, i), name)) return (int32_t)i;
    }
    return -1;
}

/* ---- Clips ----------------------------------------------------------------------------------- */

/* Clips belong to the first of the models that have the same meshes at the same nodes. */
uint32_t masu_scene_clip_count(const masu_scene *scene, uint32_t model) {
    const masu_scene_data *s = data_of(scene);
    uint32_t count = 0;
    if (!s->blob || model >= s->models) return 0;
    masu_scene_view v = masu_scene_data_view(s);
    for (uint32_t i = 0; i < s->clips; i++) count += v.clips[i].model == v.models[model].like;
    return count;
}

const char *masu_scene_clip_name(const masu_scene *scene, uint32_t model, uint32_t clip) {
    const masu_scene_data *s = data_of(scene);
    if (!s->blob || model >= s->models) return "";
    masu_scene_view v = masu_scene_data_view(s);
    for (uint32_t i = 0; i < s->clips; i++) {
        if (v.clips[i].model == v.models[model].like && !clip--)
            return text_of(&v, v.clips[i].name);
    }
    return "";
}

float masu_scene_sdf_range(const masu_scene *scene, uint32_t index, float *minimum,
                           float *maximum) {
    const masu_scene_data *s = data_of(scene);
    masu_blob_sdf_param p = {0};
    if (s->blob && index < s->sdf_params) p = masu_scene_data_view(s).sdf_params[index];
    if (minimum) *minimum = p.minimum;
    if (maximum) *maximum = p.maximum;
    return p.value;
}

/* ---- Properties ------------------------------------------------------------------------------ */

uint32_t masu_scene_features(const masu_scene *scene) {
    const masu_scene_data *s = data_of(scene);
    return (s->sdf ? MASU_SCENE_HAS_SDF : 0u) | (s->sdf_dynamic ? MASU_SCENE_HAS_DYNAMIC_SDF : 0u) |
           (s->shadow_cascades ? MASU_SCENE_HAS_SHADOW_MAP : 0u) |
           (s->reflections ? MASU_SCENE_HAS_REFLECTIONS : 0u) |
           (s->transparents ? MASU_SCENE_HAS_TRANSPARENTS : 0u) |
           (s->analytic_sky ? MASU_SCENE_HAS_ANALYTIC_SKY : 0u) |
           (s->fog ? MASU_SCENE_HAS_FOG : 0u) |
           (s->metered ? MASU_SCENE_HAS_METERED_EXPOSURE : 0u) |
           (s->smooth_edges ? MASU_SCENE_HAS_DEFAULT_AA : 0u);
}

uint64_t masu_scene_triangles(const masu_scene *scene) { return data_of(scene)->triangles; }

uint64_t masu_scene_texture_bytes(const masu_scene *scene, int compressed) {
    const masu_scene_data *s = data_of(scene);
    return compressed ? s->texture_bytes : s->texture_bytes_decoded;
}

uint32_t masu_scene_shadow_cascades(const masu_scene *scene, uint32_t *resolution) {
    const masu_scene_data *s = data_of(scene);
    if (resolution) *resolution = s->shadow_resolution;
    return s->shadow_cascades;
}

float masu_scene_shadow_distance(const masu_scene *scene) {
    return data_of(scene)->shadow_distance;
}

float masu_scene_specular_cutoff(const masu_scene *scene) {
    return data_of(scene)->specular_cutoff;
}

void masu_scene_usage(const masu_scene *scene, masu_limits *out) {
    const masu_scene_data *s = data_of(scene);
    if (!out) return;
#define SCENE_HAS(name, ...) .name = s->name,
    *out = (masu_limits){MASU_LIMITS(SCENE_HAS)};
#undef SCENE_HAS
    /* Reports the larger size, which a device without textureCompressionBC needs. */
    if (out->texture_bytes < s->texture_bytes_decoded)
        out->texture_bytes = s->texture_bytes_decoded;
}
