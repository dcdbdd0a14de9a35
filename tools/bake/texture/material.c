/* material.c: what a scene changes of the materials of a model: all of them ("material"), or those
 * whose name or picture matches a pattern ("materials"). */
#include "bake/texture/material.h"
#include "bake/texture/meso.h"

#include "bake/scene/file.h"

#include <stdlib.h>
#include <string.h>

#define ASSIMP_PREFIX "@assimp/"

char *masu_bake_resolve(const char *name, const char *directory, const char *models_directory) {
    size_t prefix = strlen(ASSIMP_PREFIX);
    if (strncmp(name, ASSIMP_PREFIX, prefix) == 0) {
        return masu_bake_join(models_directory, name + prefix);
    }
    if (name[0] == '/' || strcmp(directory, ".") == 0) directory = NULL;
    if (directory) return masu_bake_join(directory, name);
    char *copy = masu_bake_allocate(strlen(name) + 1);
    strcpy(copy, name);
    return copy;
}

static void store_color(masu_bake_vec3 v, float out[3]) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* The members that name a picture, and what it stands for. */
static const struct {
    const char *member;
    int map;
    uint8_t channel;
} map_members[] = {
    {"base_color_map", MASU_BAKE_BASE, 0},     {"normal_map", MASU_BAKE_NORMAL, 0},
    {"roughness_map", MASU_BAKE_ROUGHNESS, 0}, {"metallic_map", MASU_BAKE_METALLIC, 0},
    {"emissive_map", MASU_BAKE_EMISSIVE, 0},   {"opacity_map", MASU_BAKE_OPACITY, 0},
    {"surface_map", MASU_BAKE_ROUGHNESS, 1},   {"surface_map", MASU_BAKE_METALLIC, 2},
    {"occlusion_map", MASU_BAKE_OCCLUSION, 0},
};
#define MAP_MEMBERS (sizeof map_members / sizeof *map_members)

static bool has_map_member(const masu_bake_json *at) {
    for (size_t i = 0; i < MAP_MEMBERS; i++) {
        if (masu_bake_json_has(at, map_members[i].member)) return true;
    }
    return false;
}

bool masu_bake_overrides_map(const masu_bake_json *model) {
    masu_bake_json at = masu_bake_json_member(model, "material");
    masu_bake_json list = masu_bake_json_member(model, "materials");
    if (at.value && has_map_member(&at)) return true;
    for (size_t i = 0; json_is_array(list.value) && i < json_array_size(list.value); i++) {
        masu_bake_json item = masu_bake_json_element(&list, i);
        if (has_map_member(&item)) return true;
    }
    return false;
}

static bool read_maps(const masu_bake_json *at, const char *directory,
                      const masu_bake_request *request, masu_bake_content *content,
                      masu_bake_override *out) {
    static const char *const alphas[] = {"opaque", "mask", "blend"};
    for (size_t i = 0; i < MAP_MEMBERS; i++) {
        const char *name = NULL;
        if (!masu_bake_json_string(at, map_members[i].member, &name)) return false;
        if (!name || request->textures == MASU_BAKE_TEXTURES_OFF) continue;
        int map = map_members[i].map;
        if (out->map[map]) {
            return masu_bake_json_wrong(at, "%s: there is another map for the same",
                                        map_members[i].member);
        }
        char *path = masu_bake_resolve(name, directory, request->models_directory);
        out->map[map] = true;
        out->maps.image[map] = masu_bake_add_image(content, path, NULL, NULL);
        out->maps.channel[map] = map_members[i].channel;
        free(path);
    }
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

/* A number, or one along u and one along v. */
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

/* How what is transparent is mixed with what is behind; saying so makes it transparent. */
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
    if (blend && strcmp(blend, "alpha") != 0 && strcmp(blend, "additive") != 0)
        return masu_bake_json_wrong(&where, "expected \"alpha\" or \"additive\"");
    if (out->alpha && out->maps.alpha != MASU_BAKE_ALPHA_BLEND && (blend || opacity < 1))
        return masu_bake_json_wrong(&where, "\"alpha\" says that it is not transparent");
    if (blend) {
        out->alpha = true;
        out->maps.alpha = MASU_BAKE_ALPHA_BLEND;
        out->maps.additive = strcmp(blend, "additive") == 0;
    }
    return true;
}

static bool read_override(const masu_bake_json *at, const char *directory,
                          const masu_bake_request *request, masu_bake_content *content,
                          masu_bake_override *out) {
    static const char *const members[] = {"base_color",     "roughness",
                                          "metallic",       "emissive",
                                          "alpha",          "base_color_map",
                                          "normal_map",     "roughness_map",
                                          "metallic_map",   "emissive_map",
                                          "opacity_map",    "surface_map",
                                          "alpha_cutoff",   "occlusion_map",
                                          "specular",       "coat",
                                          "coat_roughness", "detail",
                                          "match",          "opacity",
                                          "blend",          "meso",
                                          NULL};
    memset(out, 0, sizeof *out);
    out->value = masu_bake_default_material();
    out->maps = masu_bake_no_maps();
    masu_bake_vec3 color = {0, 0, 0}, emissive = {0, 0, 0};
    double roughness = 0, metallic = 0, specular = 0, coat = 0, coat_roughness = 0;
    const char *match = NULL;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_vec3(at, "base_color", 0, 1, &color) ||
        !masu_bake_json_number(at, "roughness", 0, 1, &roughness) ||
        !masu_bake_json_number(at, "metallic", 0, 1, &metallic) ||
        !masu_bake_json_number(at, "specular", 0, 1, &specular) ||
        !masu_bake_json_number(at, "coat", 0, 1, &coat) ||
        !masu_bake_json_number(at, "coat_roughness", 0, 1, &coat_roughness) ||
        !read_detail(at, out) || !masu_bake_json_string(at, "match", &match) ||
        !masu_bake_json_vec3(at, "emissive", 0, 65504, &emissive) ||
        !masu_bake_read_meso(at, directory, content, &out->value.meso) ||
        !read_maps(at, directory, request, content, out) || !read_blend(at, out)) {
        return false;
    }
    out->meso = masu_bake_json_has(at, "meso");
    out->base_color = masu_bake_json_has(at, "base_color");
    out->roughness = masu_bake_json_has(at, "roughness");
    out->metallic = masu_bake_json_has(at, "metallic");
    out->emissive = masu_bake_json_has(at, "emissive");
    out->specular = masu_bake_json_has(at, "specular");
    out->coat = masu_bake_json_has(at, "coat");
    out->coat_roughness = masu_bake_json_has(at, "coat_roughness");
    out->value.specular = (float)specular;
    out->value.coat = (float)coat;
    out->value.coat_roughness = (float)coat_roughness;
    store_color(color, out->value.base_color);
    store_color(emissive, out->value.emissive);
    out->value.roughness = (float)roughness;
    out->value.metallic = (float)metallic;
    if (match && strlen(match) >= sizeof out->match)
        return masu_bake_json_wrong(at, "\"match\" is longer than %u", MASU_BAKE_MATCH - 1);
    if (match) strcpy(out->match, match);
    return true;
}

static bool same_override(const masu_bake_override *a, const masu_bake_override *b) {
    const masu_blob_material *x = &a->value, *y = &b->value;
    return a->base_color == b->base_color && a->roughness == b->roughness &&
           a->metallic == b->metallic && a->emissive == b->emissive && a->alpha == b->alpha &&
           a->cutoff == b->cutoff && memcmp(a->map, b->map, sizeof a->map) == 0 &&
           memcmp(&a->maps, &b->maps, sizeof a->maps) == 0 &&
           memcmp(x->base_color, y->base_color, sizeof x->base_color) == 0 &&
           memcmp(x->emissive, y->emissive, sizeof x->emissive) == 0 &&
           x->roughness == y->roughness && x->metallic == y->metallic &&
           a->specular == b->specular && a->coat == b->coat &&
           a->coat_roughness == b->coat_roughness && x->specular == y->specular &&
           x->coat == y->coat && x->coat_roughness == y->coat_roughness &&
           a->meso == b->meso && x->meso == y->meso && a->opacity == b->opacity &&
           x->opacity == y->opacity && a->detail == b->detail &&
           memcmp(x->detail, y->detail, sizeof x->detail) == 0 && strcmp(a->match, b->match) == 0;
}

bool masu_bake_read_overrides(const masu_bake_json *model, const char *directory,
                              const masu_bake_request *request, masu_bake_content *content,
                              masu_bake_overrides *out) {
    masu_bake_json all = masu_bake_json_member(model, "material");
    masu_bake_json list = masu_bake_json_member(model, "materials");
    *out = (masu_bake_overrides){0};
    if (list.value && !masu_bake_json_array(&list, 0)) return false;
    size_t count = list.value ? json_array_size(list.value) : 0;
    out->items = masu_bake_allocate((count + 1) * sizeof *out->items);
    bool good = true;
    if (all.value) {
        good = read_override(&all, directory, request, content, &out->items[out->count++]);
        if (good && *out->items[0].match)
            good = masu_bake_json_wrong(&all, "\"match\" is for \"materials\"");
    }
    for (size_t i = 0; good && i < count; i++) {
        masu_bake_json at = masu_bake_json_element(&list, i);
        masu_bake_override *item = &out->items[out->count++];
        good = read_override(&at, directory, request, content, item);
        if (good && !*item->match)
            good = masu_bake_json_wrong(&at, "needs \"match\": a pattern of names, as \"tr-*\"");
    }
    if (!good) masu_bake_overrides_release(out);
    return good;
}

bool masu_bake_overrides_equal(const masu_bake_overrides *a, const masu_bake_overrides *b) {
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++) {
        if (!same_override(&a->items[i], &b->items[i])) return false;
    }
    return true;
}

void masu_bake_overrides_release(masu_bake_overrides *overrides) {
    free(overrides->items);
    *overrides = (masu_bake_overrides){0};
}
