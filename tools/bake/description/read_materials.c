/* read_materials.c: a scene's changes to the materials of a model: to all ("material"), or to those
 * whose name or image matches a pattern ("materials"). The curves of a small relief, as masu-meso
 * writes them, are inline or in a separate file, which is read here too. */
#include "bake/description/reader.h"

#include <string.h>

/* ---- images ---- */

/* The members that name an image, and its use. */
static const struct {
    const char *member;
    int map;
    uint8_t channel;
} map_members[] = {
    {"base_color_map", MASU_BAKE_BASE, 0},     {"normal_map", MASU_BAKE_NORMAL, 0},
    {"roughness_map", MASU_BAKE_ROUGHNESS, 0}, {"metallic_map", MASU_BAKE_METALLIC, 0},
    {"emissive_map", MASU_BAKE_EMISSIVE, 0},   {"opacity_map", MASU_BAKE_OPACITY, 0},
    {"surface_map", MASU_BAKE_ROUGHNESS, 1},   {"surface_map", MASU_BAKE_METALLIC, 2},
    {"occlusion_map", MASU_BAKE_OCCLUSION, 0}, {"coat_map", MASU_BAKE_COAT, 0},
    {"coat_roughness_map", MASU_BAKE_COAT_ROUGHNESS, 0},
};
#define MAP_MEMBERS (sizeof map_members / sizeof *map_members)

static bool read_maps(const masu_bake_json *at, masu_bake_reader *r,
                      masu_bake_material_change *change) {
    masu_bake_override *out = &change->value;
    for (size_t i = 0; i < MAP_MEMBERS; i++) {
        const char *name = NULL;
        if (!masu_bake_json_string(at, map_members[i].member, &name)) return false;
        if (!name) continue;
        int map = map_members[i].map;
        if (out->map[map]) {
            return masu_bake_json_wrong(at, "\"%s\": another member sets the same map",
                                        map_members[i].member);
        }
        out->map[map] = true;
        out->maps.channel[map] = map_members[i].channel;
        change->picture[map] = masu_bake_model_path(r, name);
    }
    return true;
}

static bool read_alpha(const masu_bake_json *at, masu_bake_override *out) {
    static const char *const alphas[] = {"opaque", "mask", "blend"};
    const char *alpha = NULL;
    double cutoff = 0.5;
    if (!masu_bake_json_string(at, "alpha", &alpha) ||
        !masu_bake_json_number(at, "alpha_cutoff", 0, 1, &cutoff)) {
        return false;
    }
    for (uint8_t i = 0; i < 3 && alpha; i++) {
        if (strcmp(alpha, alphas[i]) == 0) {
            out->alpha = true;
            out->maps.alpha = (uint8_t)(MASU_BAKE_ALPHA_OPAQUE + i);
        }
    }
    out->cutoff = masu_bake_json_has(at, "alpha_cutoff");
    out->maps.cutoff = (float)cutoff;
    if (alpha && !out->alpha) {
        masu_bake_json where = masu_bake_json_member(at, "alpha");
        return masu_bake_json_wrong(&where, "expected \"opaque\", \"mask\" or \"blend\"");
    }
    return true;
}

/* ---- other values ---- */

/* One number, or two: for u and for v. */
static bool read_detail(const masu_bake_json *at, masu_bake_override *out) {
    masu_bake_json detail = masu_bake_json_member(at, "detail");
    if (!detail.value) return true;
    bool pair = json_is_array(detail.value);
    for (size_t i = 0; i < 2; i++) {
        json_t *value = pair ? json_array_get(detail.value, i) : detail.value;
        double v = json_number_value(value);
        if ((pair && json_array_size(detail.value) != 2) || !json_is_number(value) ||
            !(v >= 1e-3 && v <= 1e4)) {
            return masu_bake_json_wrong(&detail, "expected a number from 0.001 to 10000, or two");
        }
        out->value.detail[i] = (float)v;
    }
    return out->detail = true;
}

/* How a transparent material is blended with the background; this member makes a material
 * transparent. */
static bool read_blend(const masu_bake_json *at, masu_bake_override *out) {
    const char *blend = NULL;
    double opacity = 1;
    if (!masu_bake_json_number(at, "opacity", 0, 1, &opacity) ||
        !masu_bake_json_string(at, "blend", &blend)) {
        return false;
    }
    masu_bake_json where = masu_bake_json_member(at, blend ? "blend" : "opacity");
    out->opacity = masu_bake_json_has(at, "opacity");
    out->value.opacity = (float)opacity;
    if (blend && strcmp(blend, "alpha") != 0 && strcmp(blend, "additive") != 0 &&
        strcmp(blend, "tinted") != 0)
        return masu_bake_json_wrong(&where, "expected \"alpha\", \"additive\" or \"tinted\"");
    if (out->alpha && out->maps.alpha != MASU_BAKE_ALPHA_BLEND && (blend || opacity < 1))
        return masu_bake_json_wrong(&where, "needs \"alpha\": \"blend\"");
    if (blend) {
        out->alpha = true;
        out->maps.alpha = MASU_BAKE_ALPHA_BLEND;
        out->maps.additive = strcmp(blend, "additive") == 0;
        out->maps.tinted = strcmp(blend, "tinted") == 0;
    }
    return true;
}

/* ---- curves of a small relief ---- */

static bool read_three(const masu_bake_json *at, const char *name, float out[3]) {
    masu_bake_vec3 v = {0, 0, 0};
    if (!masu_bake_json_has(at, name)) return masu_bake_json_wrong(at, "needs \"%s\"", name);
    if (!masu_bake_json_vec3(at, name, -1000, 1000, &v)) return false;
    masu_bake_store(v, out);
    return true;
}

static bool read_one(const masu_bake_json *at, const char *name, double high, float *out) {
    double v = 0;
    if (!masu_bake_json_has(at, name)) return masu_bake_json_wrong(at, "needs \"%s\"", name);
    if (!masu_bake_json_number(at, name, 0, high, &v)) return false;
    *out = (float)v;
    return true;
}

static bool read_spread(const masu_bake_json *at, masu_blob_meso *m) {
    float v[3];
    if (!read_three(at, "spread", v)) return false;
    m->spread = v[0];
    m->spread1 = v[1];
    m->spread2 = v[2];
    return true;
}

static bool read_curves(const masu_bake_json *at, masu_blob_meso *m) {
    static const char *const members[] = {
        "tilt",   "rough", "open",   "gain", "tint", "specular", "facet_roughness",
        "spread", "alpha", "offset", NULL};
    memset(m, 0, sizeof *m);
    return masu_bake_json_object(at, members) && read_three(at, "tilt", m->tilt) &&
           read_three(at, "rough", m->roughness) && read_three(at, "open", m->occlusion) &&
           read_three(at, "gain", m->gain) && read_three(at, "tint", m->tint) &&
           read_three(at, "specular", m->specular) &&
           read_one(at, "facet_roughness", 1, &m->facet) && read_spread(at, m) &&
           read_one(at, "alpha", 4, &m->alpha) && read_one(at, "offset", 4, &m->offset);
}

static bool read_meso(const masu_bake_json *material, masu_bake_reader *r,
                      masu_bake_material_change *change) {
    masu_bake_json at = masu_bake_json_member(material, "meso");
    change->value.meso = at.value != NULL;
    if (!at.value) return true;
    if (!json_is_string(at.value)) return read_curves(&at, &change->meso);
    masu_bake_json file = {.file = masu_bake_path(r, json_string_value(at.value))};
    bool good = masu_bake_json_load(file.file, &file.value) && read_curves(&file, &change->meso);
    if (file.value) json_decref(file.value);
    return good;
}

/* ---- changes ---- */

static bool read_change(const masu_bake_json *at, masu_bake_reader *r,
                        masu_bake_material_change *change) {
    masu_bake_override *out = &change->value;
    static const char *const members[] = {
        "base_color",     "roughness",      "metallic",    "emissive",
        "alpha",          "base_color_map", "normal_map",  "roughness_map",
        "metallic_map",   "emissive_map",   "opacity_map", "surface_map",
        "alpha_cutoff",   "occlusion_map",  "specular",    "coat",
        "coat_roughness", "detail",         "match",       "opacity",
        "blend",          "meso",           "name",        "single_sided",
        "coat_map",       "coat_roughness_map", "coat_smooth", "thickness",
        "ior",            "unlit",              "depth_bias",  "repeat",
        "detail_color",
        NULL};
    out->value = masu_bake_default_material();
    out->maps = masu_bake_no_maps();
    masu_bake_vec3 color = {0, 0, 0}, emissive = {0, 0, 0};
    double roughness = 0, metallic = 0, specular = 0, coat = 0, coat_roughness = 0, thickness = 0,
           ior = 1.5;
    const char *match = NULL, *name = NULL;
    bool single = false, even = false, unlit = false, repeat = false;
    double bias = 0;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_vec3(at, "base_color", 0, 1, &color) ||
        !masu_bake_json_number(at, "roughness", 0, 1, &roughness) ||
        !masu_bake_json_number(at, "metallic", 0, 1, &metallic) ||
        !masu_bake_json_number(at, "specular", 0, 1, &specular) ||
        !masu_bake_json_number(at, "coat", 0, 1, &coat) ||
        !masu_bake_json_number(at, "coat_roughness", 0, 1, &coat_roughness) ||
        !masu_bake_json_number(at, "thickness", 0, 65504, &thickness) ||
        !masu_bake_json_number(at, "ior", 1, 1000, &ior) || !read_detail(at, out) ||
        !masu_bake_json_string(at, "match", &match) || !masu_bake_json_string(at, "name", &name) ||
        !masu_bake_json_boolean(at, "single_sided", &single) ||
        !masu_bake_json_boolean(at, "coat_smooth", &even) ||
        !masu_bake_json_boolean(at, "unlit", &unlit) ||
        !masu_bake_json_boolean(at, "repeat", &repeat) ||
        !masu_bake_json_number(at, "depth_bias", -0.01, 0.01, &bias) ||
        !masu_bake_json_boolean(at, "detail_color", &out->color_repeats) ||
        !masu_bake_json_vec3(at, "emissive", 0, 65504, &emissive) || !read_meso(at, r, change) ||
        !read_maps(at, r, change) || !read_alpha(at, out) || !read_blend(at, out)) {
        return false;
    }
    out->base_color = masu_bake_json_has(at, "base_color");
    out->roughness = masu_bake_json_has(at, "roughness");
    out->metallic = masu_bake_json_has(at, "metallic");
    out->emissive = masu_bake_json_has(at, "emissive");
    out->specular = masu_bake_json_has(at, "specular");
    out->coat = masu_bake_json_has(at, "coat");
    out->coat_roughness = masu_bake_json_has(at, "coat_roughness");
    out->single = masu_bake_json_has(at, "single_sided");
    out->maps.single = single;
    out->detail_color = masu_bake_json_has(at, "detail_color");
    out->relief_of = masu_bake_json_has(at, "coat_smooth");
    out->maps.relief_of = even ? MASU_BAKE_RELIEF_OF_BASE : MASU_BAKE_RELIEF_OF_BOTH;
    out->unlit = unlit;
    out->repeat = repeat;
    out->depth_bias = masu_bake_json_has(at, "depth_bias");
    out->value.depth_bias = (float)bias;
    out->value.specular = (float)specular;
    out->value.coat = (float)coat;
    out->thickness = masu_bake_json_has(at, "thickness");
    out->ior = masu_bake_json_has(at, "ior");
    out->value.thickness = (float)thickness;
    out->value.ior = (float)ior;
    out->value.coat_roughness = (float)coat_roughness;
    masu_bake_store(color, out->value.base_color);
    masu_bake_store(emissive, out->value.emissive);
    out->value.roughness = (float)roughness;
    out->value.metallic = (float)metallic;
    if (unlit && out->emissive)
        return masu_bake_json_wrong(at, "\"emissive\": an unlit material emits its \"base_color\"");
    if (match && strlen(match) >= sizeof out->match)
        return masu_bake_json_wrong(at, "\"match\": expected at most %u bytes",
                                    MASU_BAKE_MATCH - 1);
    if (match) strcpy(out->match, match);
    if (name && strlen(name) >= sizeof out->name)
        return masu_bake_json_wrong(at, "\"name\": expected at most %u bytes", MASU_BAKE_MATCH - 1);
    if (name) strcpy(out->name, name);
    return true;
}

bool masu_bake_read_materials(const masu_bake_json *model, masu_bake_reader *r,
                              masu_bake_model *out) {
    masu_bake_json all = masu_bake_json_member(model, "material");
    masu_bake_json list = masu_bake_json_member(model, "materials");
    if (list.value && !masu_bake_json_array(&list, 0)) return false;
    size_t count = list.value ? json_array_size(list.value) : 0;
    bool shadows = true;
    if (!masu_bake_json_boolean(model, "shadows", &shadows)) return false;
    out->changes = masu_bake_take(&r->out->pool, (count + 2) * sizeof *out->changes);
    if (all.value) {
        masu_bake_material_change *change = &out->changes[out->change_count++];
        if (!read_change(&all, r, change)) return false;
        if (*change->value.match)
            return masu_bake_json_wrong(&all, "\"match\" is only allowed in \"materials\"");
    }
    for (size_t i = 0; i < count; i++) {
        masu_bake_json at = masu_bake_json_element(&list, i);
        masu_bake_material_change *change = &out->changes[out->change_count++];
        if (!read_change(&at, r, change)) return false;
        if (!*change->value.match)
            return masu_bake_json_wrong(&at, "needs \"match\": a name pattern such as \"tr-*\"");
    }
    if (!shadows) {
        masu_bake_override *last = &out->changes[out->change_count++].value;
        last->value = masu_bake_default_material();
        last->maps = masu_bake_no_maps();
        last->shadowless = true;
    }
    return true;
}
