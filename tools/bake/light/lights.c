/* lights.c: the "lights" of a scene, and those that models bring along: how they are placed.
 *
 *   type       "point" or "spot"
 *   position   world, or object space of `instance`; likewise direction
 *   color      times intensity is radiant intensity / pi: a white matt surface that faces the light at
 *              one metre has this radiance
 *   range      0 beyond; by default where that radiance has fallen to a hundredth
 *   inner, outer  of a spot: degrees from its axis, full light inside, none outside */
#include "bake/scene/scene.h"

#include <stdlib.h>
#include <string.h>

#define COLOR_MAX 1e9

static void to_floats(masu_bake_vec3 v, float out[3]) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

double masu_bake_light_range(masu_bake_vec3 color) {
    double most = fmax(color.x, fmax(color.y, color.z));
    return fmin(fmax(10.0 * sqrt(fmax(most, 0.0)), 1e-3), 1e9);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static bool read_type(const masu_bake_json *at, uint32_t *type) {
    const char *text = NULL;
    if (!masu_bake_json_string(at, "type", &text)) return false;
    if (!text) return masu_bake_json_wrong(at, "needs \"type\": \"point\" or \"spot\"");
    *type = strcmp(text, "spot") == 0 ? MASU_LIGHT_SPOT : MASU_LIGHT_POINT;
    if (*type == MASU_LIGHT_SPOT || strcmp(text, "point") == 0) return true;
    masu_bake_json where = masu_bake_json_member(at, "type");
    return masu_bake_json_wrong(&where, "expected \"point\" or \"spot\"");
}

static bool read_cone(const masu_bake_json *at, masu_blob_light *light) {
    masu_bake_vec3 direction = {0, 0, 0};
    double inner = 0, outer = 45;
    if (light->type == MASU_LIGHT_POINT) {
        static const char *const members[] = {"direction", "inner", "outer"};
        for (int i = 0; i < 3; i++) {
            if (masu_bake_json_has(at, members[i]))
                return masu_bake_json_wrong(at, "a point has no \"%s\"", members[i]);
        }
        return true;
    }
    if (!masu_bake_json_vec3(at, "direction", -1e9, 1e9, &direction) ||
        !masu_bake_json_number(at, "outer", 0, 180, &outer)) {
        return false;
    }
    inner = 0.75 * outer;
    if (!masu_bake_json_number(at, "inner", 0, outer, &inner)) return false;
    if (!masu_bake_normalize(&direction))
        return masu_bake_json_wrong(at, "a spot needs a \"direction\" that is not zero");
    to_floats(direction, light->direction);
    light->inner = (float)(inner * (MASU_BAKE_PI / 180));
    light->outer = (float)(outer * (MASU_BAKE_PI / 180));
    return true;
}

/* The first instance of that name. */
static bool read_instance(const masu_bake_json *at, const masu_bake_content *content,
                          uint32_t *parent) {
    const char *name = NULL;
    if (!masu_bake_json_string(at, "instance", &name)) return false;
    *parent = MASU_BLOB_NONE;
    if (!name) return true;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES) && *name; i++) {
        if (strcmp(masu_bake_name_text(content, MASU_BAKE_INSTANCES(content)[i].name), name))
            continue;
        *parent = (uint32_t)i;
        return true;
    }
    masu_bake_json where = masu_bake_json_member(at, "instance");
    return masu_bake_json_wrong(&where, "no instance is called \"%s\"", name);
}

static bool read_light(const masu_bake_json *at, masu_bake_content *content) {
    static const char *const members[] = {"type",  "position",  "direction", "color",
                                          "range", "intensity", "inner",     "outer",
                                          "name",  "radius",    "instance",  NULL};
    const double most = MASU_BAKE_COORDINATE_MAX;
    masu_blob_light light = {.parent = MASU_BLOB_NONE};
    masu_bake_vec3 position = {0, 0, 0}, color = {1, 1, 1};
    double intensity = 1, radius = 0.01;
    const char *name = NULL;
    if (!masu_bake_json_object(at, members) || !read_type(at, &light.type) ||
        !masu_bake_json_vec3(at, "position", -most, most, &position) ||
        !masu_bake_json_vec3(at, "color", 0, COLOR_MAX, &color) ||
        !masu_bake_json_number(at, "intensity", 0, COLOR_MAX, &intensity) ||
        !masu_bake_json_number(at, "radius", 1e-6, 1e9, &radius) ||
        !masu_bake_json_string(at, "name", &name) || !read_cone(at, &light) ||
        !read_instance(at, content, &light.parent)) {
        return false;
    }
    if (!masu_bake_json_has(at, "position")) return masu_bake_json_wrong(at, "needs \"position\"");
    color = masu_bake_v3(color.x * intensity, color.y * intensity, color.z * intensity);
    if (fmax(color.x, fmax(color.y, color.z)) > COLOR_MAX)
        return masu_bake_json_wrong(at, "color times intensity is above %g", COLOR_MAX);
    double range = masu_bake_light_range(color);
    if (!masu_bake_json_number(at, "range", 0, 1e9, &range)) return false;
    to_floats(position, light.position);
    to_floats(color, light.color);
    light.range = (float)range;
    light.radius = (float)radius;
    light.name = name ? masu_bake_name(content, name, strlen(name)) : MASU_BLOB_NONE;
    masu_bake_append(&content->section[MASU_BLOB_LIGHTS], &light, sizeof light);
    return true;
}

bool masu_bake_read_lights(const masu_bake_json *scene, masu_bake_content *content) {
    masu_bake_json lights = masu_bake_json_member(scene, "lights");
    size_t count = 0;
    if (lights.value) {
        if (!masu_bake_json_array(&lights, 0)) return false;
        count = json_array_size(lights.value);
    }
    for (size_t i = 0; i < count; i++) {
        masu_bake_json at = masu_bake_json_element(&lights, i);
        if (!read_light(&at, content)) return false;
    }
    uint64_t all = masu_bake_count(content, MASU_BLOB_LIGHTS);
    if (all <= MASU_BLOB_LIGHTS_MAX) return true;
    return masu_bake_json_wrong(scene, "%llu lights, those of models included; at most %u",
                                (unsigned long long)all, MASU_BLOB_LIGHTS_MAX);
}

/* ---- Lights of models ------------------------------------------------------------------------ */

static masu_bake_affine transform_of(const masu_bake_content *content, uint32_t instance) {
    masu_bake_affine a;
    for (int i = 0; i < 12; i++)
        a.m[i] = (double)MASU_BAKE_INSTANCES(content)[instance].transform[i];
    return a;
}

/* A light in another space. False: it has left what can be said. */
static bool move(masu_blob_light *light, const masu_bake_affine *to) {
    masu_bake_vec3 origin = {0, 0, 0}, zero = masu_bake_apply(to, origin);
    masu_bake_vec3 position = masu_bake_apply(to, masu_bake_v3f(light->position));
    masu_bake_vec3 direction =
        masu_bake_sub(masu_bake_apply(to, masu_bake_v3f(light->direction)), zero);
    if (!masu_bake_sane(position)) return false;
    to_floats(position, light->position);
    if (light->type != MASU_LIGHT_SPOT) return true;
    if (!masu_bake_normalize(&direction)) return false;
    to_floats(direction, light->direction);
    return true;
}

void masu_bake_detach_lights(masu_bake_content *piece) {
    masu_blob_light *lights = MASU_BAKE_LIGHTS(piece);
    uint64_t count = masu_bake_count(piece, MASU_BLOB_LIGHTS), kept = 0;
    for (uint64_t i = 0; i < count; i++) {
        masu_blob_light light = lights[i];
        masu_bake_affine to = masu_bake_identity();
        if (light.parent != MASU_BLOB_NONE) to = transform_of(piece, light.parent);
        light.parent = MASU_BLOB_NONE;
        if (move(&light, &to)) lights[kept++] = light;
    }
    piece->section[MASU_BLOB_LIGHTS].bytes = (size_t)kept * sizeof *lights;
}

const char *masu_bake_place_lights(masu_bake_content *scene, const masu_bake_content *piece,
                                   const masu_bake_affine *placement, uint32_t first_instance,
                                   double factor, const char *prefix) {
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_LIGHTS) && factor > 0; i++) {
        masu_blob_light light = MASU_BAKE_LIGHTS(piece)[i];
        const char *own = masu_bake_name_text(piece, light.name);
        masu_bake_buffer name = {0};
        if (prefix && *prefix) {
            masu_bake_append_text(&name, prefix);
            masu_bake_append_text(&name, *own ? "/" : "");
        }
        masu_bake_append_text(&name, own);
        light.name = name.bytes ? masu_bake_name(scene, (const char *)name.data, name.bytes)
                                : MASU_BLOB_NONE;
        masu_bake_release(&name);
        double color[3];
        for (int k = 0; k < 3; k++) color[k] = fmin((double)light.color[k] * factor, COLOR_MAX);
        to_floats(masu_bake_v3(color[0], color[1], color[2]), light.color);
        if (light.range == 0.0f)
            light.range = (float)masu_bake_light_range(masu_bake_v3f(light.color));
        if (light.parent != MASU_BLOB_NONE) {
            light.parent += first_instance;
        } else if (!move(&light, placement)) {
            return "a light beyond 1e15, or that shines nowhere";
        }
        masu_bake_append(&scene->section[MASU_BLOB_LIGHTS], &light, sizeof light);
    }
    return NULL;
}
