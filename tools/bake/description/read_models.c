/* read_models.c: the "models" of a scene: the source of each (a file, or a procedural mesh), its
 * placement, and the settings of its instances. The placement is translate * fit * rotate * scale
 * of the model as in its file. */
#include "bake/light/emitters.h"
#include "bake/description/reader.h"
#include "bake/scene/groups.h"

#include <string.h>

/* ---- procedural meshes ---- */

static bool read_sphere(const masu_bake_json *at, masu_bake_shape *out) {
    static const char *const members[] = {"radius", "subdivisions", "tile", NULL};
    double radius = 1, subdivisions = 5, tile = 1;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "radius", 1e-6, 1e6, &radius) ||
        !masu_bake_json_number(at, "tile", 1e-3, 1e3, &tile) ||
        !masu_bake_json_number(at, "subdivisions", 0, MASU_BAKE_SUBDIVISIONS_MAX, &subdivisions)) {
        return false;
    }
    if (subdivisions != floor(subdivisions)) {
        return masu_bake_json_wrong(at, "subdivisions must be a whole number");
    }
    *out =
        (masu_bake_shape){MASU_BAKE_SPHERE, {radius, radius, radius}, (uint32_t)subdivisions, tile};
    return true;
}

static bool read_box(const masu_bake_json *at, masu_bake_shape *out) {
    static const char *const members[] = {"size", "tile", NULL};
    masu_bake_vec3 size = {1, 1, 1};
    double tile = 1;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "tile", 1e-3, 1e3, &tile) ||
        !masu_bake_json_vec3(at, "size", 1e-6, 1e6, &size)) {
        return false;
    }
    *out = (masu_bake_shape){MASU_BAKE_BOX, size, 0, tile};
    return true;
}

static bool read_plane(const masu_bake_json *at, masu_bake_shape *out) {
    static const char *const members[] = {"size_x", "size_z", "tile", NULL};
    double x = 1, z = 1, tile = 1;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "size_x", 1e-6, 1e6, &x) ||
        !masu_bake_json_number(at, "tile", 1e-3, 1e3, &tile) ||
        !masu_bake_json_number(at, "size_z", 1e-6, 1e6, &z)) {
        return false;
    }
    *out = (masu_bake_shape){MASU_BAKE_PLANE, {x, 0, z}, 0, tile};
    return true;
}

static bool read_shape(const masu_bake_json *mesh, masu_bake_shape *out) {
    static const char *const members[] = {"sphere", "box", "plane", NULL};
    if (!masu_bake_json_object(mesh, members)) return false;
    if (json_object_size(mesh->value) != 1) {
        return masu_bake_json_wrong(mesh, "needs one of \"sphere\", \"box\", \"plane\"");
    }
    masu_bake_json sphere = masu_bake_json_member(mesh, "sphere");
    masu_bake_json box = masu_bake_json_member(mesh, "box");
    masu_bake_json plane = masu_bake_json_member(mesh, "plane");
    if (sphere.value) return read_sphere(&sphere, out);
    return box.value ? read_box(&box, out) : read_plane(&plane, out);
}

/* Meshes with equal JSON are shared. `written`: the JSON of each, borrowed. */
static bool read_mesh(const masu_bake_json *mesh, masu_bake_reader *r, const json_t **written,
                      uint32_t *index) {
    masu_bake_description *out = r->out;
    for (*index = 0; *index < out->shape_count; ++*index) {
        if (json_equal(written[*index], mesh->value)) return true;
    }
    written[*index] = mesh->value;
    return read_shape(mesh, &out->shapes[out->shape_count++]);
}

/* ---- placement ---- */

static bool read_scale(const masu_bake_json *model, masu_bake_affine *out) {
    masu_bake_json at = masu_bake_json_member(model, "scale");
    masu_bake_vec3 scale = {1, 1, 1};
    if (json_is_number(at.value)) {
        if (!masu_bake_json_number(model, "scale", -1e9, 1e9, &scale.x)) return false;
        scale.y = scale.z = scale.x;
    } else if (!masu_bake_json_vec3(model, "scale", -1e9, 1e9, &scale)) {
        return false;
    }
    if (scale.x == 0 || scale.y == 0 || scale.z == 0) {
        return masu_bake_json_wrong(&at, "must not be zero");
    }
    *out = masu_bake_scaling(scale);
    return true;
}

static bool read_rotation(const masu_bake_json *model, masu_bake_affine *out) {
    masu_bake_vec3 angles = {0, 0, 0};
    if (masu_bake_json_has(model, "rotate") && masu_bake_json_has(model, "rotate_y")) {
        return masu_bake_json_wrong(model,
                                    "expected either \"rotate\" or \"rotate_y\", found both");
    }
    if (!masu_bake_json_vec3(model, "rotate", -3600, 3600, &angles) ||
        !masu_bake_json_number(model, "rotate_y", -3600, 3600, &angles.y)) {
        return false;
    }
    masu_bake_affine x = masu_bake_rotation(0, angles.x), y = masu_bake_rotation(1, angles.y);
    masu_bake_affine z = masu_bake_rotation(2, angles.z), yx = masu_bake_multiply(&y, &x);
    *out = masu_bake_multiply(&z, &yx);
    return true;
}

static bool read_fit(const masu_bake_json *model, masu_bake_fit *out) {
    static const char *const members[] = {"size", "center", "base", NULL};
    masu_bake_json fit = masu_bake_json_member(model, "fit");
    const double most = MASU_BAKE_COORDINATE_MAX;
    out->wanted = fit.value != NULL;
    if (!fit.value) return true;
    if (!masu_bake_json_object(&fit, members) ||
        !masu_bake_json_number(&fit, "size", 1e-6, 1e9, &out->size) ||
        !masu_bake_json_vec3(&fit, "center", -most, most, &out->at) ||
        !masu_bake_json_vec3(&fit, "base", -most, most, &out->at)) {
        return false;
    }
    out->center = masu_bake_json_has(&fit, "center");
    out->base = masu_bake_json_has(&fit, "base");
    if (!out->center || !out->base) return true;
    return masu_bake_json_wrong(&fit, "expected either \"center\" or \"base\", found both");
}

/* true, or the height of the ground if there is nothing else below. */
static bool read_drop(const masu_bake_json *model, masu_bake_model *out) {
    masu_bake_json drop = masu_bake_json_member(model, "drop");
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!json_is_number(drop.value)) return masu_bake_json_boolean(model, "drop", &out->drop);
    out->drop = true;
    return masu_bake_json_number(model, "drop", -most, most, &out->ground);
}

static bool read_placement(const masu_bake_json *model, masu_bake_model *out) {
    masu_bake_affine scale, rotation;
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!read_scale(model, &scale) || !read_rotation(model, &rotation) ||
        !masu_bake_json_vec3(model, "translate", -most, most, &out->translation) ||
        !read_fit(model, &out->fit) || !read_drop(model, out)) {
        return false;
    }
    out->placement = masu_bake_multiply(&rotation, &scale);
    return true;
}

/* ---- instances ---- */

static bool read_group(const masu_bake_json *model, masu_bake_reader *r, masu_bake_model *out) {
    const char *path = NULL;
    double spare = 0;
    if (!masu_bake_json_string(model, "group", &path) ||
        !masu_bake_json_boolean(model, "moving", &out->moving) ||
        !masu_bake_json_boolean(model, "hidden", &out->hidden) ||
        !masu_bake_json_number(model, "spare", 0, MASU_BAKE_SPARE_MAX, &spare)) {
        return false;
    }
    if (spare != floor(spare)) return masu_bake_json_wrong(model, "spare must be a whole number");
    out->spare = (uint32_t)spare;
    if (out->hidden || out->spare) {
        if (masu_bake_json_has(model, "moving") && !out->moving)
            return masu_bake_json_wrong(model, "\"hidden\" and \"spare\" need \"moving\": true");
        out->moving = true;
    }
    if (!path) return true;
    if (out->moving)
        return masu_bake_json_wrong(model, "a \"moving\" model cannot have a \"group\"");
    if (!masu_bake_group_path(path)) {
        masu_bake_json at = masu_bake_json_member(model, "group");
        return masu_bake_json_wrong(&at, "expected 1 to %u names separated by /",
                                    MASU_BAKE_GROUP_LEVELS);
    }
    out->group = masu_bake_take_text(&r->out->pool, path);
    return true;
}

/* Two corners: a box in each mesh of the model; true: the mesh itself is a box. */
static bool read_occluder(const masu_bake_json *model, masu_bake_model *out) {
    masu_bake_json at = masu_bake_json_member(model, "occluder");
    const double most = MASU_BAKE_COORDINATE_MAX;
    masu_bake_box *box = &out->occluder;
    if (!at.value || json_is_false(at.value)) return true;
    out->hides = json_is_true(at.value) ? MASU_BAKE_HIDES_WHOLE : MASU_BAKE_HIDES_BOX;
    if (out->hides == MASU_BAKE_HIDES_WHOLE) return true;
    if (!masu_bake_json_array(&at, 2)) return false;
    masu_bake_json low = masu_bake_json_element(&at, 0);
    masu_bake_json high = masu_bake_json_element(&at, 1);
    if (!masu_bake_json_vec3(&low, NULL, -most, most, &box->low) ||
        !masu_bake_json_vec3(&high, NULL, -most, most, &box->high)) {
        return false;
    }
    if (json_array_size(at.value) == 2 && box->low.x < box->high.x && box->low.y < box->high.y &&
        box->low.z < box->high.z) {
        return true;
    }
    return masu_bake_json_wrong(&at, "expected true or two corners, lower corner first");
}

static bool read_traced(const masu_bake_json *model, masu_bake_model *out) {
    bool traced = true;
    if (!masu_bake_json_has(model, "traced")) return true;
    if (!masu_bake_json_boolean(model, "traced", &traced)) return false;
    out->traced = traced ? MASU_BAKE_TRACED_YES : MASU_BAKE_TRACED_NO;
    return true;
}

static bool read_area_light(const masu_bake_json *model, masu_bake_model *out) {
    bool area = true;
    if (!masu_bake_json_has(model, "area_light")) return true;
    if (!masu_bake_json_boolean(model, "area_light", &area)) return false;
    out->area_light = area ? MASU_BAKE_AREA_YES : MASU_BAKE_AREA_NO;
    return true;
}

/* ---- models ---- */

static bool read_source(const masu_bake_json *model, masu_bake_reader *r, const json_t **written,
                        masu_bake_model *out) {
    const char *file = NULL, *variant = NULL;
    if (!masu_bake_json_string(model, "file", &file) ||
        !masu_bake_json_number(model, "merge", 1e-3, 1e9, &out->merge)) {
        return false;
    }
    masu_bake_json mesh = masu_bake_json_member(model, "mesh");
    if (out->merge > 0 && masu_bake_json_has(model, "occluder"))
        return masu_bake_json_wrong(model, "\"merge\" and \"occluder\" cannot be combined");
    if (!masu_bake_json_string(model, "variant", &variant)) return false;
    if (variant && !file) return masu_bake_json_wrong(model, "\"variant\" needs \"file\"");
    if (variant) out->variant = masu_bake_take_text(&r->out->pool, variant);
    if (!file == !mesh.value)
        return masu_bake_json_wrong(model, "needs either \"file\" or \"mesh\"");
    if (!file) {
        if (out->merge > 0) return masu_bake_json_wrong(model, "\"merge\" needs \"file\"");
        return read_mesh(&mesh, r, written, &out->shape);
    }
    out->file = masu_bake_model_path(r, file);
    return true;
}

static bool read_model(const masu_bake_json *model, masu_bake_reader *r, const json_t **written,
                       masu_bake_model *out) {
    static const char *const members[] = {"file",      "mesh",      "name",     "group", "moving",
                                          "translate", "rotate",    "rotate_y", "scale", "fit",
                                          "material",  "materials", "occluder", "merge", "lights",
                                          "traced",    "hidden",    "spare",    "variant", "drop",
                                          "area_light", "shadows",  NULL};
    const char *name = NULL;
    out->where = masu_bake_take_text(&r->out->pool, model->where);
    out->lights = 1;
    if (!masu_bake_json_object(model, members) || !read_source(model, r, written, out) ||
        !read_placement(model, out) || !masu_bake_json_string(model, "name", &name) ||
        !masu_bake_json_number(model, "lights", 0, 1e9, &out->lights) ||
        !masu_bake_read_materials(model, r, out) || !read_group(model, r, out) ||
        !read_occluder(model, out) || !read_traced(model, out) || !read_area_light(model, out)) {
        return false;
    }
    if (name) out->name = masu_bake_take_text(&r->out->pool, name);
    return true;
}

bool masu_bake_read_models(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_json models = masu_bake_json_member(scene, "models");
    masu_bake_description *out = r->out;
    if (!models.value) return true;
    if (!masu_bake_json_array(&models, 0)) return false;
    out->model_count = json_array_size(models.value);
    out->models = masu_bake_take(&out->pool, out->model_count * sizeof *out->models);
    out->shapes = masu_bake_take(&out->pool, out->model_count * sizeof *out->shapes);
    const json_t **written = masu_bake_take(&out->pool, out->model_count * sizeof *written);
    for (size_t i = 0; i < out->model_count; i++) {
        masu_bake_json model = masu_bake_json_element(&models, i);
        if (!read_model(&model, r, written, &out->models[i])) return false;
    }
    return true;
}
