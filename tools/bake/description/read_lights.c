/* read_lights.c: the "lights" of a scene.
 *
 *   type       "point" or "spot"
 *   position   world, or object space of `instance`; likewise direction
 *   color      times intensity is radiant intensity / pi: a white diffuse surface that faces the light
 *              at one metre has this radiance
 *   range      0 beyond; by default where that radiance has fallen to a hundredth
 *   shadows    false: it casts none
 *   inner, outer  of a spot: degrees from its axis, full light inside, none outside */
#include "bake/description/reader.h"

#include <string.h>

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
                return masu_bake_json_wrong(at, "\"%s\" is only allowed for spot lights",
                                            members[i]);
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
        return masu_bake_json_wrong(at, "a spot light needs a \"direction\" that is not zero");
    masu_bake_store(direction, light->direction);
    light->inner = (float)(inner * (MASU_BAKE_PI / 180));
    light->outer = (float)(outer * (MASU_BAKE_PI / 180));
    return true;
}

static bool read_light(const masu_bake_json *at, masu_bake_reader *r, masu_bake_light *out) {
    static const char *const members[] = {"type",  "position",  "direction", "color",
                                          "range", "intensity", "inner",     "outer",
                                          "name",  "radius",    "instance",  "shadows",   NULL};
    const double most = MASU_BAKE_COORDINATE_MAX;
    masu_blob_light light = {.parent = MASU_BLOB_NONE, .name = MASU_BLOB_NONE};
    masu_bake_vec3 position = {0, 0, 0}, color = {1, 1, 1};
    double intensity = 1, radius = 0.01;
    const char *name = NULL, *instance = NULL;
    bool shadows = true;
    if (!masu_bake_json_object(at, members) || !read_type(at, &light.type) ||
        !masu_bake_json_vec3(at, "position", -most, most, &position) ||
        !masu_bake_json_vec3(at, "color", 0, MASU_BAKE_LIGHT_COLOR_MAX, &color) ||
        !masu_bake_json_number(at, "intensity", 0, MASU_BAKE_LIGHT_COLOR_MAX, &intensity) ||
        !masu_bake_json_number(at, "radius", 1e-6, 1e9, &radius) ||
        !masu_bake_json_string(at, "name", &name) ||
        !masu_bake_json_boolean(at, "shadows", &shadows) || !read_cone(at, &light) ||
        !masu_bake_json_string(at, "instance", &instance)) {
        return false;
    }
    if (!masu_bake_json_has(at, "position")) return masu_bake_json_wrong(at, "needs \"position\"");
    color = masu_bake_v3(color.x * intensity, color.y * intensity, color.z * intensity);
    if (fmax(color.x, fmax(color.y, color.z)) > MASU_BAKE_LIGHT_COLOR_MAX)
        return masu_bake_json_wrong(at, "expected color times intensity of at most %g",
                                    MASU_BAKE_LIGHT_COLOR_MAX);
    double range = masu_bake_light_range(color);
    if (!masu_bake_json_number(at, "range", 0, 1e9, &range)) return false;
    masu_bake_store(position, light.position);
    masu_bake_store(color, light.color);
    light.range = (float)range;
    light.radius = (float)radius;
    if (!shadows) light.type |= MASU_LIGHT_NO_SHADOW;
    *out = (masu_bake_light){.value = light};
    out->where = masu_bake_take_text(&r->out->pool, at->where);
    if (name) out->name = masu_bake_take_text(&r->out->pool, name);
    if (instance) out->instance = masu_bake_take_text(&r->out->pool, instance);
    return true;
}

bool masu_bake_read_lights(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_json lights = masu_bake_json_member(scene, "lights");
    masu_bake_description *out = r->out;
    if (!lights.value) return true;
    if (!masu_bake_json_array(&lights, 0)) return false;
    out->light_count = json_array_size(lights.value);
    out->lights = masu_bake_take(&out->pool, out->light_count * sizeof *out->lights);
    for (size_t i = 0; i < out->light_count; i++) {
        masu_bake_json at = masu_bake_json_element(&lights, i);
        if (!read_light(&at, r, &out->lights[i])) return false;
    }
    return true;
}
