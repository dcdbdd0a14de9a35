/* read_sdf.c: the SDF settings of a scene. The field itself, in GLSL or in the language of
 * docs/sdf.md, is a separate file that is compiled when the scene is built. */
#include "bake/description/reader.h"
#include "bake/base/file.h"

#include "sdfc/sdfc.h"
#include "shared/masu_shared.h"

#include <math.h>
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

static bool read_shadows(const masu_bake_json *sdf, const masu_bake_reader *r) {
    masu_bake_occlusion *out = &r->out->sdf.occlusion;
    static const char *const members[] = {"sun_radius", "distance", NULL};
    masu_bake_json shadows;
    double degrees = MASU_BAKE_SUN_RADIUS;
    out->shadows = !r->bare;
    out->distance = r->out->sdf.max_distance;
    out->sun_radius = degrees * (MASU_BAKE_PI / 180.0);
    if (!masu_bake_json_feature(sdf, "shadows", &shadows, &out->shadows)) return false;
    if (!shadows.value) return true;
    if (!masu_bake_json_object(&shadows, members) ||
        !masu_bake_json_number(&shadows, "sun_radius", 0, 20, &degrees) ||
        !masu_bake_json_number(&shadows, "distance", 1e-3, 1e15, &out->distance)) {
        return false;
    }
    out->sun_radius = degrees * (MASU_BAKE_PI / 180.0);
    return true;
}

static bool read_ambient_occlusion(const masu_bake_json *sdf, const masu_bake_reader *r) {
    masu_bake_occlusion *out = &r->out->sdf.occlusion;
    static const char *const members[] = {"radius", "strength", NULL};
    masu_bake_json ambient;
    out->ambient = !r->bare;
    out->radius = 1;
    out->strength = 1;
    if (!masu_bake_json_feature(sdf, "ambient_occlusion", &ambient, &out->ambient)) return false;
    return !ambient.value || (masu_bake_json_object(&ambient, members) &&
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
                                          "static", NULL};
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
        !masu_bake_json_boolean(&sdf, "static", &out->is_static) ||
        !read_shadows(&sdf, r) || !read_ambient_occlusion(&sdf, r) || !read_params(&sdf, r)) {
        return false;
    }
    if (!source) return masu_bake_json_wrong(&sdf, "needs \"source\", a GLSL or .sdf file");
    if (out->anchored && !masu_bake_is_sdf(source))
        return masu_bake_json_wrong(&sdf, "only a .sdf file can be \"anchored\"");
    if (!masu_bake_json_has(&sdf, "anchored"))
        out->anchored = masu_bake_is_sdf(source) && reaches_far(&out->bounds);
    out->source = masu_bake_path(r, source);
    out->framed = out->bounds;
    return true;
}

/* ---- a .sdf without a scene ---- */

/* An endless part is drawn to this distance, in radii of the visible bounds. */
#define UNBOUNDED_RADII 20
/* Metres of an endless axis that the camera frames. */
#define UNBOUNDED_EXTENT 5

static double *axis_of(masu_bake_vec3 *v, int axis) {
    return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z;
}

/* The bounds of the bounded parts, or of `all` parts; for each axis only the finite ones. */
static masu_bake_box framed_box(const masu_sdfc_result *field, bool all) {
    masu_bake_box box = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (int axis = 0; axis < 3; axis++) {
        double *low = axis_of(&box.low, axis), *high = axis_of(&box.high, axis);
        for (uint32_t i = 0; i < field->part_count; i++) {
            const masu_sdfc_part *part = &field->parts[i];
            if (!all && part->radius < 0) continue;
            if (isfinite(part->low[axis])) *low = fmin(*low, part->low[axis]);
            if (isfinite(part->high[axis])) *high = fmax(*high, part->high[axis]);
        }
        if (!all || *low < *high) continue;
        double middle = isfinite(*low) ? *low : isfinite(*high) ? *high : 0;
        *low = middle - UNBOUNDED_EXTENT;
        *high = middle + UNBOUNDED_EXTENT;
    }
    return box;
}

static void frame_field(const masu_sdfc_result *field, const masu_bake_options *options,
                        masu_bake_description *out) {
    masu_bake_sdf *sdf = &out->sdf;
    sdf->framed = framed_box(field, false);
    if (masu_bake_box_is_empty(&sdf->framed)) sdf->framed = framed_box(field, true);
    double radius =
        fmax(masu_bake_length(masu_bake_sub(sdf->framed.high, sdf->framed.low)) / 2, 1e-3);
    sdf->bounds = sdf->framed;
    for (uint32_t i = 0; i < field->part_count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            double low = field->parts[i].low[axis], high = field->parts[i].high[axis];
            double *most = axis_of(&sdf->bounds.high, axis),
                   *least = axis_of(&sdf->bounds.low, axis);
            double far_low = *axis_of(&sdf->framed.low, axis) - UNBOUNDED_RADII * radius;
            double far_high = *axis_of(&sdf->framed.high, axis) + UNBOUNDED_RADII * radius;
            *least = fmin(*least, isfinite(low) ? low : far_low);
            *most = fmax(*most, isfinite(high) ? high : far_high);
        }
    }
    const masu_bake_vec3 margin = {radius * 1e-3, radius * 1e-3, radius * 1e-3};
    sdf->bounds.low = masu_bake_sub(sdf->bounds.low, margin);
    sdf->bounds.high = masu_bake_mad(sdf->bounds.high, margin, 1);
    sdf->max_distance = 3 * masu_bake_length(masu_bake_sub(sdf->bounds.high, sdf->bounds.low));
    sdf->anchored = reaches_far(&sdf->bounds);
    sdf->occlusion =
        (masu_bake_occlusion){.shadows = !options->bare,
                              .ambient = !options->bare,
                              .sun_radius = MASU_BAKE_SUN_RADIUS * (MASU_BAKE_PI / 180.0),
                              .distance = sdf->max_distance,
                              .radius = fmin(radius * 0.4, 1e6),
                              .strength = 1};
}

bool masu_bake_describe_sdf(const masu_bake_options *options, masu_bake_description *out) {
    masu_bake_buffer text = {0};
    masu_sdfc_result field = {0};
    /* Building tests the claims. */
    const masu_sdfc_options quick = {.pairs = UINT32_MAX};
    char error[4096];
    if (!masu_bake_read_file(options->input, MASU_SDFC_SOURCE_MAX, &text)) return false;
    bool good = masu_sdfc_compile_with((const char *)text.data, text.bytes, options->input, &quick,
                                       &field, error, sizeof error);
    if (good) {
        out->sdf.lipschitz = 1; /* replaced by the compiler's value */
        out->sdf.source = masu_bake_take_text(&out->pool, options->input);
        frame_field(&field, options, out);
    } else {
        masu_bake_report_lines(error, false);
    }
    masu_sdfc_release(&field);
    masu_bake_release(&text);
    return good;
}
