/* api_scene.c: the public functions that query and change instances, models, local lights and
 * materials between frames (api_add.c adds and removes them). They change the host's copy in
 * src/frame/; masu_frame uploads the changes. */
#include "renderer.h"

#include <string.h>

/* ---- Instances ------------------------------------------------------------------------------- */

static masu_result check_instance(masu_renderer *m, masu_instance instance, uint32_t *index,
                                  masu_detail *detail) {
    return masu_finish(
        m, masu_handle_check(&m->instances.handles, "instance", instance.id, index, &m->error),
        detail);
}

masu_instance masu_instance_at(const masu_renderer *m, uint32_t index) {
    return (masu_instance){m ? masu_handle_at(&m->instances.handles, index) : 0};
}

masu_instance masu_instance_find(const masu_renderer *m, const char *name) {
    if (!m || !name || !*name) return (masu_instance){0};
    return masu_instance_at(m, masu_instances_find(&m->instances, &m->plan, name));
}

masu_result masu_instance_set_transform(masu_renderer *m, masu_instance instance,
                                        const float rows[12], masu_detail *detail) {
    uint32_t i;
    if (!m || !rows) return masu_finish_null(m, "rows", detail);
    masu_result result = check_instance(m, instance, &i, detail);
    if (!result)
        result =
            masu_finish(m, masu_instances_set(&m->instances, &m->plan, i, rows, &m->error), detail);
    if (!result) masu_bounds_move(&m->bounds, &m->plan, &m->instances, i);
    return result;
}

masu_result masu_instance_set_position(masu_renderer *m, masu_instance instance,
                                       const double position[3], masu_detail *detail) {
    uint32_t i;
    if (!m || !position) return masu_finish_null(m, "position", detail);
    masu_result result = check_instance(m, instance, &i, detail);
    if (!result)
        result = masu_finish(m, masu_position_check(&m->plan, position, &m->error), detail);
    if (result) return result;
    float rows[12];
    masu_instance_rows(&m->instances.now[i], rows);
    rows[3] = rows[7] = rows[11] = 0.0f;
    masu_instances_place_at(&m->instances, &m->plan, i, rows, position);
    masu_bounds_move(&m->bounds, &m->plan, &m->instances, i);
    return MASU_OK;
}

masu_result masu_instance_get(masu_renderer *m, masu_instance instance, masu_instance_state *out,
                              masu_detail *detail) {
    uint32_t i;
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check_instance(m, instance, &i, detail);
    if (result) return result;
    float box[6];
    *out = (masu_instance_state){.index = i,
                                 .mesh = m->instances.meshes[i],
                                 .shown = !masu_instance_hidden(&m->instances, i)};
    masu_instance_rows(&m->instances.now[i], out->rows);
    masu_instance_position(&m->instances, i, out->position);
    masu_bounds_of(&m->bounds, i, box);
    for (uint32_t k = 0; k < 3; k++) {
        out->box_low[k] = box[k] - box[3 + k];
        out->box_high[k] = box[k] + box[3 + k];
    }
    if (m->plan.scene.models && m->models.of_instance[i] != MASU_BLOB_NONE)
        out->model = masu_model_at(m, m->models.of_instance[i]);
    return MASU_OK;
}

masu_result masu_instance_show(masu_renderer *m, masu_instance instance, uint32_t shown,
                               masu_detail *detail) {
    uint32_t i;
    if (!m) return masu_fail_null(detail, "renderer");
    masu_result result = check_instance(m, instance, &i, detail);
    if (!result) masu_instances_show(&m->instances, &m->plan, i, shown != 0);
    return result;
}

masu_result masu_instance_set_look(masu_renderer *m, masu_instance instance, const masu_look *look,
                                   masu_detail *detail) {
    uint32_t i;
    if (!m || !look) return masu_finish_null(m, "look", detail);
    masu_result result = check_instance(m, instance, &i, detail);
    if (!result) result = masu_finish(m, masu_looks_check(&m->plan, look, &m->error), detail);
    if (!result) masu_instances_set_look(&m->instances, &m->plan, i, look);
    return result;
}

masu_result masu_instance_get_look(masu_renderer *m, masu_instance instance, masu_look *out,
                                   masu_detail *detail) {
    const masu_look plain = {.flags = 0};
    uint32_t i;
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check_instance(m, instance, &i, detail);
    if (!result) result = masu_finish(m, masu_looks_check(&m->plan, &plain, &m->error), detail);
    if (!result) *out = m->instances.looks.now[i];
    return result;
}

/* ---- Models ---------------------------------------------------------------------------------- */

static masu_result check_model(masu_renderer *m, masu_model model, uint32_t *index,
                               masu_detail *detail) {
    return masu_finish(
        m, masu_handle_check(&m->models.handles, "model", model.id, index, &m->error), detail);
}

masu_model masu_model_find(const masu_renderer *m, const char *name) {
    if (!m || !name || !*name) return (masu_model){0};
    return masu_model_at(m, masu_models_find(&m->models, &m->plan, name));
}

masu_model masu_model_at(const masu_renderer *m, uint32_t index) {
    return (masu_model){m ? masu_handle_at(&m->models.handles, index) : 0};
}

masu_result masu_model_get(masu_renderer *m, masu_model model, masu_model_state *out,
                           masu_detail *detail) {
    uint32_t i;
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (result) return result;
    const masu_placed_model *of = &m->models.models[i];
    *out = (masu_model_state){.index = i, .shown = of->shown, .nodes = of->node_count};
    memcpy(out->rows, of->rows, sizeof out->rows);
    for (uint32_t k = 0; k < 3; k++) {
        out->position[k] = (double)of->rows[4 * k + 3] + masu_models_offset(&m->models, i, k);
        out->rows[4 * k + 3] = (float)out->position[k];
    }
    masu_models_box(&m->models, &m->bounds, i, out->box_low, out->box_high);
    return MASU_OK;
}

masu_result masu_model_set_transform(masu_renderer *m, masu_model model, const float rows[12],
                                     masu_detail *detail) {
    uint32_t i;
    if (!m || !rows) return masu_finish_null(m, "rows", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (result) return result;
    return masu_finish(
        m, masu_models_move(&m->models, &m->instances, &m->bounds, &m->plan, i, rows, &m->error),
        detail);
}

masu_result masu_model_set_position(masu_renderer *m, masu_model model, const double position[3],
                                    masu_detail *detail) {
    uint32_t i;
    if (!m || !position) return masu_finish_null(m, "position", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (result) return result;
    return masu_finish(m,
                       masu_models_set_position(&m->models, &m->instances, &m->bounds, &m->plan, i,
                                                position, &m->error),
                       detail);
}

masu_result masu_model_show(masu_renderer *m, masu_model model, uint32_t shown,
                            masu_detail *detail) {
    uint32_t i;
    if (!m) return masu_fail_null(detail, "renderer");
    masu_result result = check_model(m, model, &i, detail);
    if (!result) masu_models_show(&m->models, &m->instances, &m->plan, i, shown != 0);
    return result;
}

masu_result masu_model_set_look(masu_renderer *m, masu_model model, const masu_look *look,
                                masu_detail *detail) {
    uint32_t i;
    if (!m || !look) return masu_finish_null(m, "look", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (!result) result = masu_finish(m, masu_looks_check(&m->plan, look, &m->error), detail);
    if (!result) masu_models_set_look(&m->models, &m->instances, &m->plan, i, look);
    return result;
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

uint32_t masu_model_node_find(const masu_renderer *m, masu_model model, const char *name) {
    if (!m || !name || !*name) return MASU_NODE_NONE;
    uint32_t i = masu_handle_index(&m->models.handles, model.id);
    return i < m->models.handles.count ? masu_models_node(&m->models, i, name) : MASU_NODE_NONE;
}

masu_result masu_model_node_get(masu_renderer *m, masu_model model, uint32_t node,
                                masu_node_state *out, masu_detail *detail) {
    uint32_t i;
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (!result)
        result = masu_finish(m, masu_models_check_node(&m->models, i, node, &m->error), detail);
    if (result) return result;
    uint32_t first = m->models.models[i].first_node;
    const masu_node *of = &m->models.nodes[first + node];
    *out = (masu_node_state){.parent = of->parent == MASU_BLOB_NONE ? MASU_NODE_NONE
                                                                    : of->parent - first};
    if (of->instance != MASU_BLOB_NONE) out->instance = masu_instance_at(m, of->instance);
    memcpy(out->rows, of->local, sizeof out->rows);
    memcpy(out->world, of->world, sizeof out->world);
    for (uint32_t k = 3; k < 12; k += 4)
        out->world[k] = (float)((double)of->world[k] + masu_models_offset(&m->models, i, k / 4));
    return MASU_OK;
}

masu_result masu_model_node_set(masu_renderer *m, masu_model model, uint32_t node,
                                const float rows[12], masu_detail *detail) {
    uint32_t i;
    if (!m || !rows) return masu_finish_null(m, "rows", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (!result)
        result = masu_finish(m, masu_models_check_node(&m->models, i, node, &m->error), detail);
    if (result) return result;
    return masu_finish(m,
                       masu_models_move_node(&m->models, &m->instances, &m->bounds, &m->plan, i,
                                             node, rows, &m->error),
                       detail);
}

/* ---- Clips ----------------------------------------------------------------------------------- */

/* Number and first of the clips of a model; 0 for an invalid model. */
static uint32_t clips_of(const masu_renderer *m, masu_model model, uint32_t *first) {
    uint32_t i = m ? masu_handle_index(&m->models.handles, model.id) : 0;
    if (!m || i >= m->plan.scene.models) return 0;
    return masu_animation_clips(&m->models.animation, &m->plan, m->models.models[i].like, first);
}

uint32_t masu_model_clips(const masu_renderer *m, masu_model model) {
    uint32_t first;
    return clips_of(m, model, &first);
}

uint32_t masu_model_clip_find(const masu_renderer *m, masu_model model, const char *name) {
    uint32_t first, count = clips_of(m, model, &first);
    if (!name || !*name) return MASU_CLIP_NONE;
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < count; i++) {
        if (m->models.animation.clips[first + i].name == hash) return i;
    }
    return MASU_CLIP_NONE;
}

double masu_model_clip_duration(const masu_renderer *m, masu_model model, uint32_t clip) {
    uint32_t first, count = clips_of(m, model, &first);
    return clip < count ? (double)m->models.animation.clips[first + clip].duration : 0.0;
}

masu_result masu_model_animate(masu_renderer *m, masu_model model, const masu_clip_use *uses,
                               uint32_t count, masu_detail *detail) {
    uint32_t i;
    if (!m || (count && !uses)) return masu_finish_null(m, "uses", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (result) return result;
    return masu_finish(m,
                       masu_models_animate(&m->models, &m->instances, &m->bounds, &m->plan, i, uses,
                                           count, &m->error),
                       detail);
}

masu_result masu_model_morph_set(masu_renderer *m, masu_model model, const char *name, float weight,
                                 masu_detail *detail) {
    uint32_t i;
    if (!m || !name) return masu_finish_null(m, "name", detail);
    masu_result result = check_model(m, model, &i, detail);
    if (result) return result;
    return masu_finish(m,
                       masu_models_morph(&m->models, &m->instances, &m->bounds, &m->plan, i, name,
                                         weight, &m->error),
                       detail);
}

/* ---- Punctual lights ------------------------------------------------------------------------- */

static masu_result check_light(masu_renderer *m, masu_punctual_light light, uint32_t *index,
                               masu_detail *detail) {
    return masu_finish(
        m, masu_handle_check(&m->lights.handles, "light", light.id, index, &m->error), detail);
}

masu_punctual_light masu_punctual_light_at(const masu_renderer *m, uint32_t index) {
    return (masu_punctual_light){m ? masu_handle_at(&m->lights.handles, index) : 0};
}

masu_punctual_light masu_punctual_light_find(const masu_renderer *m, const char *name) {
    if (!m || !name || !*name) return (masu_punctual_light){0};
    return masu_punctual_light_at(m, masu_lights_find(&m->lights, &m->plan, name));
}

masu_result masu_punctual_light_get(masu_renderer *m, masu_punctual_light light,
                                    masu_punctual_light_state *out, masu_detail *detail) {
    uint32_t i;
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check_light(m, light, &i, detail);
    if (!result) *out = masu_lights_get(&m->lights, &m->instances, i);
    return result;
}

masu_result masu_punctual_light_set(masu_renderer *m, masu_punctual_light light,
                                    const masu_punctual_light_state *state, masu_detail *detail) {
    uint32_t i;
    if (!m || !state) return masu_finish_null(m, "state", detail);
    masu_result result = check_light(m, light, &i, detail);
    if (result) return result;
    return masu_finish(m, masu_lights_set(&m->lights, &m->instances, i, state, &m->error), detail);
}

/* ---- Materials ------------------------------------------------------------------------------- */

static masu_result check_material(masu_renderer *m, masu_material material, uint32_t *index,
                                  masu_detail *detail) {
    if (m->plan.desc.mutable_materials)
        return masu_finish(
            m, masu_handle_check(&m->materials.handles, "material", material.id, index, &m->error),
            detail);
    return masu_finish(
        m,
        masu_fail(&m->error, MASU_ERROR_STATE, "mutable_materials", 1, 0,
                  "materials can be neither read nor changed: desc.mutable_materials is 0"),
        detail);
}

masu_material masu_material_at(const masu_renderer *m, uint32_t index) {
    return (masu_material){m ? masu_handle_at(&m->materials.handles, index) : 0};
}

masu_material masu_material_find(const masu_renderer *m, const char *name) {
    if (!m || !name || !*name) return (masu_material){0};
    return masu_material_at(m, masu_materials_find(&m->materials, name));
}

masu_result masu_material_get(masu_renderer *m, masu_material material, masu_material_state *out,
                              masu_detail *detail) {
    uint32_t i;
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check_material(m, material, &i, detail);
    if (!result) *out = masu_materials_get(&m->materials, i);
    return result;
}

masu_result masu_material_set(masu_renderer *m, masu_material material,
                              const masu_material_state *state, masu_detail *detail) {
    uint32_t i;
    if (!m || !state) return masu_finish_null(m, "state", detail);
    masu_result result = check_material(m, material, &i, detail);
    if (result) return result;
    return masu_finish(m, masu_materials_set(&m->materials, &m->plan, i, state, &m->error), detail);
}

/* ---- Textures -------------------------------------------------------------------------------- */

static masu_result not_loaded(const masu_renderer *m, masu_detail *detail) {
    masu_detail own;
    masu_fail(&own, MASU_ERROR_STATE, "masu_load", 1, 0,
              "textures are there once masu_load has returned MASU_OK");
    return masu_finish_desc(&m->plan.desc, MASU_ERROR_STATE, &own, detail);
}

masu_result masu_texture_write(masu_renderer *m, uint32_t texture, const VkRect2D *rect,
                               const void *texels, uint32_t row_bytes, masu_detail *detail) {
    if (!m || !texels) return masu_finish_null(m, "texels", detail);
    if (!m->loaded) return not_loaded(m, detail);
    return masu_finish(m,
                       masu_textures_add(&m->textures, &m->device, &m->timeline, texture, rect,
                                         texels, row_bytes, &m->error),
                       detail);
}

masu_result masu_texture_image_of(const masu_renderer *m, masu_texture_image *out,
                                  masu_detail *detail) {
    if (!m || !out) return masu_finish_null_const(m, "out", detail);
    if (!m->loaded) return not_loaded(m, detail);
    if (!m->plan.needs.texture_writes) {
        masu_detail own;
        masu_fail(&own, MASU_ERROR_STATE, "reserve.textures", 1, 0,
                  "there are no textures: desc.reserve.textures is 0");
        return masu_finish_desc(&m->plan.desc, MASU_ERROR_STATE, &own, detail);
    }
    const masu_image_plan *image = &m->plan.images[MASU_IMAGE_TEXTURES];
    *out = (masu_texture_image){.image = m->device.objects.images[MASU_IMAGE_TEXTURES],
                                .format = masu_plan_format(&m->plan, MASU_IMAGE_TEXTURES),
                                .usage =
                                    image->usage & ~(VkImageUsageFlags)VK_IMAGE_USAGE_STORAGE_BIT,
                                .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                .width = image->width,
                                .height = image->height,
                                .layers = masu_plan_layers(&m->plan, MASU_IMAGE_TEXTURES)};
    return MASU_OK;
}

/* ---- Effects on the image -------------------------------------------------------------------- */

masu_result masu_lut_set(masu_renderer *m, const float *colors, uint32_t size,
                         masu_detail *detail) {
    if (!m || (size && !colors)) return masu_finish_null(m, "colors", detail);
    return masu_finish(m, masu_post_set_lut(&m->post, &m->plan, colors, size, &m->error), detail);
}
