/* scene.c: a scene description; docs/scene.md is its reference. Members are read in an order
 * of their own, not the file's: models first, then the SDF's description, then the camera, whose
 * default frames both, and last the shader, which depends on whether there are models. */
#include "bake/light/environment.h"
#include "bake/scene/scene.h"
#include "bake/scene/file.h"
#include "bake/shader/sdf.h"
#include "cli/cli.h"

#include "shared/masu_shared.h"

#include <math.h>
#include <stdlib.h>
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

static bool macro_is_taken(const masu_bake_content *content, const char *macro) {
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_SDF_PARAMS); i++) {
        const masu_blob_sdf_param *p =
            &MASU_BAKE_ARRAY(content, MASU_BLOB_SDF_PARAMS, const masu_blob_sdf_param)[i];
        char other[128];
        masu_bake_param_macro(masu_bake_name_text(content, p->name), other, sizeof other);
        if (strcmp(other, macro) == 0) return true;
    }
    return false;
}

static bool read_param(const masu_bake_json *at, masu_bake_content *content) {
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
        return masu_bake_json_wrong(&where, "must be letters, digits and _, at most %d",
                                    PARAM_NAME_MAX);
    }
    if (!(low <= value && value <= high)) {
        return masu_bake_json_wrong(at, "value %g is not between min %g and max %g", value, low,
                                    high);
    }
    char macro[128];
    masu_bake_param_macro(name, macro, sizeof macro);
    if (macro_is_taken(content, macro)) {
        return masu_bake_json_wrong(at, "a second parameter would be called %s", macro);
    }
    masu_blob_sdf_param param = {(float)value, (float)low, (float)high,
                                 masu_bake_name(content, name, strlen(name))};
    masu_bake_append(&content->section[MASU_BLOB_SDF_PARAMS], &param, sizeof param);
    return true;
}

static bool read_params(const masu_bake_json *sdf, masu_bake_content *content) {
    masu_bake_json params = masu_bake_json_member(sdf, "params");
    if (!params.value) return true;
    if (!masu_bake_json_array(&params, 0)) return false;
    size_t count = json_array_size(params.value);
    if (count > PARAMS_MAX) {
        return masu_bake_json_wrong(&params, "%zu parameters, at most %d", count, PARAMS_MAX);
    }
    for (size_t i = 0; i < count; i++) {
        masu_bake_json at = masu_bake_json_element(&params, i);
        if (!read_param(&at, content)) return false;
    }
    return true;
}

static bool read_bounds(const masu_bake_json *sdf, masu_bake_box *out) {
    masu_bake_json bounds = masu_bake_json_member(sdf, "bounds");
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!bounds.value) return masu_bake_json_wrong(sdf, "needs \"bounds\": [[x,y,z],[x,y,z]]");
    if (!masu_bake_json_array(&bounds, 2)) return false;
    if (json_array_size(bounds.value) != 2) {
        return masu_bake_json_wrong(&bounds, "expected two corners");
    }
    masu_bake_json low = masu_bake_json_element(&bounds, 0);
    masu_bake_json high = masu_bake_json_element(&bounds, 1);
    if (!masu_bake_json_vec3(&low, NULL, -most, most, &out->low) ||
        !masu_bake_json_vec3(&high, NULL, -most, most, &out->high)) {
        return false;
    }
    if (!(out->low.x < out->high.x && out->low.y < out->high.y && out->low.z < out->high.z)) {
        return masu_bake_json_wrong(&bounds, "the first corner must be the lower one");
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

/* All of the SDF but its shader. `source` is left NULL without an SDF. */
static bool read_sdf(const masu_bake_json *scene, masu_bake_content *content, masu_bake_box *bounds,
                     const char **source, masu_bake_occlusion *occlusion) {
    static const char *const members[] = {"source", "bounds",   "lipschitz", "max_distance",
                                          "params", "anchored", "shadows",   "ambient_occlusion",
                                          NULL};
    masu_bake_json sdf = masu_bake_json_member(scene, "sdf");
    if (!sdf.value) return true;
    masu_bake_box box = masu_bake_box_empty();
    double lipschitz = 1, max_distance = 200;
    bool anchored = false, given = masu_bake_json_has(&sdf, "anchored");
    if (!masu_bake_json_object(&sdf, members) || !masu_bake_json_string(&sdf, "source", source) ||
        !read_bounds(&sdf, &box) ||
        !masu_bake_json_number(&sdf, "lipschitz", 1e-3, 1e6, &lipschitz) ||
        !masu_bake_json_number(&sdf, "max_distance", 1e-3, 1e15, &max_distance) ||
        !masu_bake_json_boolean(&sdf, "anchored", &anchored) ||
        !read_shadows(&sdf, max_distance, occlusion) || !read_ambient_occlusion(&sdf, occlusion) ||
        !read_params(&sdf, content)) {
        return false;
    }
    if (!*source) return masu_bake_json_wrong(&sdf, "needs \"source\", a GLSL or .sdf file");
    if (anchored && !masu_bake_is_sdf(*source)) {
        return masu_bake_json_wrong(&sdf, "only a .sdf file can be \"anchored\"");
    }
    if (!given) anchored = masu_bake_is_sdf(*source) && reaches_far(&box);
    masu_blob_sdf out = {
        .bounds_min = {(float)box.low.x, (float)box.low.y, (float)box.low.z},
        .bounds_max = {(float)box.high.x, (float)box.high.y, (float)box.high.z},
        .lipschitz = (float)lipschitz,
        .max_distance = (float)max_distance,
        .has_raster = masu_bake_count(content, MASU_BLOB_INSTANCES) > 0,
        .part_count = 1,
        .anchored = anchored,
    };
    masu_bake_append(&content->section[MASU_BLOB_SDF], &out, sizeof out);
    /* Models say better than an endless world's bounds what the camera should look at. */
    if (masu_bake_box_is_empty(bounds)) *bounds = box;
    return true;
}

static bool read_detail(const masu_bake_json *scene, masu_bake_detail *detail) {
    double levels = 0;
    if (!masu_bake_json_number(scene, "lods", 0, MASU_BLOB_LODS_MAX, &levels) ||
        !masu_bake_json_number(scene, "occluders", 0, 1e9, &detail->least)) {
        return false;
    }
    if (levels != floor(levels)) {
        return masu_bake_json_wrong(scene, "lods must be a whole number");
    }
    detail->levels = (uint32_t)levels;
    return true;
}

/* Occluders first: they are of the meshes as they are, and then looked for in their LODs. */
static void make_detail(masu_bake_content *content, masu_bake_detail *detail) {
    masu_cli_progress("making occluders and LODs");
    masu_bake_make_occluders(content, detail->least, &detail->occluders);
    masu_bake_make_lods(content, detail->levels, &detail->lods);
    masu_bake_prove_occluders(content);
}

static bool read_all(const masu_bake_json *scene, const char *directory,
                     const masu_bake_request *request, masu_bake_content *content) {
    static const char *const members[] = {"models",    "camera", "sun",      "ambient",
                                          "sky",       "fog",    "exposure", "sdf",
                                          "lods",      "occluders", "probes", "lights",
                                          "ambient_occlusion", "environment", "reflections",
                                          NULL};
    if (!masu_bake_json_object(scene, members) || !read_detail(scene, request->detail) ||
        (request->probes && !masu_bake_read_probes(scene, request->probes)) ||
        !masu_bake_read_reflections(scene, request->reflections) ||
        !masu_bake_read_models(scene, directory, request, content)) {
        return false;
    }
    make_detail(content, request->detail);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box bounds = masu_bake_bounds(content, &identity);
    const char *source = NULL;
    masu_bake_occlusion occlusion = {0};
    if (!masu_bake_read_lights(scene, content) ||
        !read_sdf(scene, content, &bounds, &source, &occlusion) ||
        !masu_bake_read_look(scene, &bounds, content) ||
        !masu_bake_read_environment(scene, directory, content)) {
        return false;
    }
    if (!source && masu_bake_count(content, MASU_BLOB_INSTANCES) == 0) {
        return masu_bake_json_wrong(scene, "shows nothing: neither models nor an SDF");
    }
    if (!source) return true;
    char *path = NULL;
    if (source[0] != '/' && strcmp(directory, ".") != 0) path = masu_bake_join(directory, source);
    bool good =
        masu_bake_compile_march(content, path ? path : source, &occlusion,
                                request->reflections->wanted, request->variants);
    free(path);
    return good;
}

bool masu_bake_read_scene(const masu_bake_request *request, masu_bake_content *content) {
    masu_bake_json scene = {.file = request->input};
    if (!masu_bake_json_load(request->input, &scene.value)) return false;
    char *directory = masu_bake_directory_of(request->input);
    bool good = read_all(&scene, directory, request, content);
    free(directory);
    json_decref(scene.value);
    return good;
}
