/* read_sdf.c: what a scene says of its SDF. The field itself, in GLSL or in the language of
 * docs/sdf.md, is a file that is named here and compiled when the scene is built. */
#include "bake/description/reader.h"

#include "shared/masu_shared.h"

#include <string.h>

#define PARAMS_MAX 256 /* MASU_SDF_PARAMS_MAX of the march shader */
#define PARAM_NAME_MAX 63

static bool identifier(const char *name) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_";
    size_t length = strlen(name);
    return length > 0 && length <= PARAM_NAME_MAX && strchr(letters, name[0]) &&
           strspn(name, "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_") ==
               length;
}

static bool macro_is_taken(const masu_bake_sdf *sdf, const char *macro) {
    for (size_t i = 0; i < sdf->param_count; i++) {
        char other[128];
        masu_bake_param_macro(sdf->params[i].name, other, sizeof other);
        if (strcmp(other, macro) == 0) return true;
    }
    return false;
}

static bool read_param(const masu_bake_json *at, masu_bake_reader *r) {
    masu_bake_sdf *out = &r->out->sdf;
    static const char *const members[] = {"name", "value", "min", "max", NULL};
    const double most = 1e30;
    double value = 0, low = -most, high = most;
    const char *name = NULL;
    if (!masu_bake_json_object(at, members) || !masu_bake_json_string(at, "name", &name) ||
        !masu_bake_json_number(at, "value", -most, most, &value) ||
        !masu_bake_json_number(at, "min", -most, most, &low) ||
        !masu_bake_json_number(at, "max", -most, most, &high)) {
        return false;
    }
    if (!name || !masu_bake_json_has(at, "value")) {
        return masu_bake_json_wrong(at, "needs \"name\" and \"value\"");
    }
    if (!identifier(name)) {
        masu_bake_json where = masu_bake_json_member(at, "name");
        return masu_bake_json_wrong(
            &where, "expected at most %d letters, digits and _, no digit first", PARAM_NAME_MAX);
    }
    if (!(low <= value && value <= high)) {
        return masu_bake_json_wrong(at, "value %g is not between min %g and max %g", value, low,
                                    high);
    }
    char macro[128];
    masu_bake_param_macro(name, macro, sizeof macro);
    if (macro_is_taken(out, macro)) {
        return masu_bake_json_wrong(at, "another parameter has the same constant %s", macro);
    }
    out->params[out->param_count++] = (masu_bake_sdf_param){
        masu_bake_take_text(&r->out->pool, name), (float)value, (float)low, (float)high};
    return true;
}

static bool read_params(const masu_bake_json *sdf, masu_bake_reader *r) {
    masu_bake_json params = masu_bake_json_member(sdf, "params");
    if (!params.value) return true;
    if (!masu_bake_json_array(&params, 0)) return false;
    size_t count = json_array_size(params.value);
    if (count > PARAMS_MAX) {
        return masu_bake_json_wrong(&params, "%zu parameters, at most %d", count, PARAMS_MAX);
    }
    r->out->sdf.params = masu_bake_take(&r->out->pool, count * sizeof(masu_bake_sdf_param));
    for (size_t i = 0; i < count; i++) {
        masu_bake_json at = masu_bake_json_element(&params, i);
        if (!read_param(&at, r)) return false;
    }
    return true;
}

static bool reaches_far(const masu_bake_box *box) {
    double low = fmin(box->low.x, fmin(box->low.y, box->low.z));
    return fmax(-low, fmax(box->high.x, fmax(box->high.y, box->high.z))) > MASU_ANCHOR_FROM;
}

static bool read_shadows(const masu_bake_json *sdf, double max_distance, masu_bake_occlusion *out) {
    static const char *const members[] = {"sun_radius", "distance", NULL};
    masu_bake_json shadows = masu_bake_json_member(sdf, "shadows");
    double degrees = 0.27;
    out->shadows = shadows.value != NULL;
    out->distance = max_distance;
    if (!out->shadows) return true;
    if (!masu_bake_json_object(&shadows, members) ||
        !masu_bake_json_number(&shadows, "sun_radius", 0, 20, &degrees) ||
        !masu_bake_json_number(&shadows, "distance", 1e-3, 1e15, &out->distance)) {
        return false;
    }
    out->sun_radius = degrees * (MASU_BAKE_PI / 180.0);
    return true;
}

static bool read_ambient_occlusion(const masu_bake_json *sdf, masu_bake_occlusion *out) {
    static const char *const members[] = {"radius", "strength", NULL};
    masu_bake_json ambient = masu_bake_json_member(sdf, "ambient_occlusion");
    out->ambient = ambient.value != NULL;
    out->radius = 1;
    out->strength = 1;
    return !out->ambient || (masu_bake_json_object(&ambient, members) &&
                             masu_bake_json_number(&ambient, "radius", 1e-3, 1e6, &out->radius) &&
                             masu_bake_json_number(&ambient, "strength", 0, 1, &out->strength));
}

/* 0: "auto" */
static bool read_lipschitz(const masu_bake_json *sdf, double *out) {
    masu_bake_json member = masu_bake_json_member(sdf, "lipschitz");
    if (member.value && json_is_string(member.value)) {
        *out = 0;
        return strcmp(json_string_value(member.value), "auto") == 0 ||
               masu_bake_json_wrong(&member, "must be a number or \"auto\"");
    }
    return masu_bake_json_number(sdf, "lipschitz", 1e-3, 1e6, out);
}

bool masu_bake_read_sdf(const masu_bake_json *scene, masu_bake_reader *r) {
    static const char *const members[] = {"source", "bounds",   "lipschitz", "max_distance",
                                          "params", "anchored", "shadows",   "ambient_occlusion",
                                          NULL};
    masu_bake_json sdf = masu_bake_json_member(scene, "sdf");
    if (!sdf.value) return true;
    masu_bake_sdf *out = &r->out->sdf;
    out->lipschitz = 1;
    out->max_distance = 200;
    const char *source = NULL;
    masu_bake_json bounds = masu_bake_json_member(&sdf, "bounds");
    if (!masu_bake_json_object(&sdf, members) || !masu_bake_json_string(&sdf, "source", &source))
        return false;
    if (!bounds.value) return masu_bake_json_wrong(&sdf, "needs \"bounds\": [[x,y,z],[x,y,z]]");
    if (!masu_bake_json_box(&bounds, &out->bounds) ||
        !read_lipschitz(&sdf, &out->lipschitz) ||
        !masu_bake_json_number(&sdf, "max_distance", 1e-3, 1e15, &out->max_distance) ||
        !masu_bake_json_boolean(&sdf, "anchored", &out->anchored) ||
        !read_shadows(&sdf, out->max_distance, &out->occlusion) ||
        !read_ambient_occlusion(&sdf, &out->occlusion) || !read_params(&sdf, r)) {
        return false;
    }
    if (!source) return masu_bake_json_wrong(&sdf, "needs \"source\", a GLSL or .sdf file");
    if (out->anchored && !masu_bake_is_sdf(source))
        return masu_bake_json_wrong(&sdf, "only a .sdf file can be \"anchored\"");
    if (!masu_bake_json_has(&sdf, "anchored"))
        out->anchored = masu_bake_is_sdf(source) && reaches_far(&out->bounds);
    out->source = masu_bake_path(r, source);
    return true;
}
