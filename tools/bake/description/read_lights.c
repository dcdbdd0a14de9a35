/* read_lights.c: the "lights" of a scene.
 *
 *   type       "point", "spot", "sphere", "capsule", "rectangle"
 *   position   world, or object space of `instance`; likewise directions and axes
 *   color      times intensity: for points and spots, radiant intensity / pi: the radiance of a
 *              white diffuse surface that faces the light at one metre. For other types, their
 *              radiance
 *   range      no light beyond. Default: the distance at which that radiance has fallen to 0.01;
 *              for other types six times as far and at least 8 times their size; at least 6 times
 *   half_u, half_v  half axes, from the centre: of a capsule to an end, of a rectangle to two sides
 *   shadows    false: the light casts none
 *   inner, outer  of a spot: degrees from its axis, full light inside, none outside */
#include "bake/description/reader.h"
#include "bake/scene/piece.h"
#include "scene/punctual_light.h"

#include <string.h>

static bool read_type(const masu_bake_json *at, uint32_t *type) {
    const char *text = NULL;
    if (!masu_bake_json_string(at, "type", &text)) return false;
    static const char *const types[] = {"point", "spot", "sphere", "capsule", "rectangle"};
    for (*type = MASU_LIGHT_POINT; text && *type <= MASU_LIGHT_RECTANGLE; ++*type) {
        if (!strcmp(text, types[*type])) return true;
    }
    masu_bake_json where = masu_bake_json_member(at, "type");
    return masu_bake_json_wrong(text ? &where : at, "expected %s\"point\", \"spot\", \"sphere\", "
                                "\"capsule\" or \"rectangle\"", text ? "" : "\"type\": ");
}

static bool read_cone(const masu_bake_json *at, masu_blob_light *light) {
    masu_bake_vec3 direction = {0, 0, 0};
    double inner = 0, outer = 45;
    if (light->type != MASU_LIGHT_SPOT) {
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

static bool only_for(const masu_bake_json *at, const char *member, bool allowed,
                     const char *types) {
    return allowed || !masu_bake_json_has(at, member) ||
           masu_bake_json_wrong(at, "\"%s\" is only allowed for %s", member, types);
}

/* Reads half axes and sides; *size: from the centre to the farthest point, 0 for points and
 * spots. */
static bool read_shape(const masu_bake_json *at, masu_blob_light *light, double *size) {
    const double most = MASU_BAKE_COORDINATE_MAX;
    bool capsule = light->type == MASU_LIGHT_CAPSULE,
         rectangle = light->type == MASU_LIGHT_RECTANGLE;
    bool two_sided = false;
    masu_bake_vec3 axis[2] = {{0, 0, 0}, {0, 0, 0}};
    if (!only_for(at, "half_u", capsule || rectangle, "capsules and rectangles") ||
        !only_for(at, "half_v", rectangle, "rectangles") ||
        !only_for(at, "two_sided", rectangle, "rectangles") ||
        !only_for(at, "radius", !rectangle, "other lights than rectangles") ||
        !masu_bake_json_vec3(at, "half_u", -most, most, &axis[0]) ||
        !masu_bake_json_vec3(at, "half_v", -most, most, &axis[1]) ||
        !masu_bake_json_boolean(at, "two_sided", &two_sided)) {
        return false;
    }
    if (light->type > MASU_LIGHT_SPOT && !rectangle && !masu_bake_json_has(at, "radius"))
        return masu_bake_json_wrong(at, "needs \"radius\"");
    if (capsule || rectangle) masu_bake_store(axis[0], light->direction);
    masu_bake_store(axis[1], light->half_axis);
    if (two_sided) light->type |= MASU_LIGHT_TWO_SIDED;
    *size = light->type == MASU_LIGHT_SPHERE || capsule ? (double)light->radius : 0;
    *size += sqrt(masu_bake_dot(axis[0], axis[0]) + masu_bake_dot(axis[1], axis[1]));
    return true;
}

static bool read_light(const masu_bake_json *at, masu_bake_reader *r, masu_bake_light *out) {
    static const char *const members[] = {"type",  "position",  "direction", "color",
                                          "range", "intensity", "inner",     "outer",
                                          "name",  "radius",    "instance",  "half_u",
                                          "half_v", "two_sided", "shadows",  NULL};
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
    double range = 0, size = 0;
    light.radius = (float)radius;
    masu_bake_store(color, light.color);
    if (!read_shape(at, &light, &size)) return false;
    range = masu_bake_area_range(&light);
    if (!masu_bake_json_number(at, "range", 0, 1e9, &range)) return false;
    if (range < 6 * size)
        return masu_bake_json_wrong(
            at,
            "\"range\" is %g m; expected at least 6 times the size from the "
            "centre, %g m",
            range, 6 * size);
    masu_bake_store(position, light.position);
    light.range = (float)range;
    double value;
    masu_punctual_light_state state = masu_light_state_of(&light);
    const char *wrong = masu_light_state_wrong(&state, &value);
    if (wrong) return masu_bake_json_wrong(at, "%s: %g", wrong, value);
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
