/* field.c: see field.h. */
#include "lab/reference/field.h"

#include "image.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EMISSIVE_MOST 65504.0
enum { SOURCE_MOST = 4 << 20, PARAMS_MOST = 256, STEPS_MOST = 4000 };
_Static_assert(REF_GLSL_SLOTS == MASU_SDFC_SLOTS_MAX && PARAMS_MOST == MASU_SDFC_PARAMS_MAX,
               "the GLSL has room for what the compiler makes");

static bool is_sdf(const char *path) {
    size_t length = strlen(path);
    return length > 4 && !strcmp(path + length - 4, ".sdf");
}

/* "#define MASU_PARAM_RADIUS 0" for each parameter, then the GLSL; the caller frees it. */
static char *with_params(const ref_blob *blob, const char *glsl) {
    enum { LINE = 2 * MASU_BLOB_NAME_MAX };
    const masu_blob_sdf_param *params = blob->section[MASU_BLOB_SDF_PARAMS];
    const char *names = blob->section[MASU_BLOB_NAMES];
    uint64_t count = blob->count[MASU_BLOB_SDF_PARAMS];
    size_t size = count * LINE + strlen(glsl) + 16, at = 0;
    char *text = malloc(size);
    for (uint64_t i = 0; text && i < count; i++) {
        const char *name = names && params[i].name != MASU_BLOB_NONE ? names + params[i].name : "";
        at += (size_t)snprintf(text + at, size - at, "#define MASU_PARAM_");
        for (; *name; name++) text[at++] = (char)toupper((unsigned char)*name);
        at += (size_t)snprintf(text + at, size - at, " %llu\n", (unsigned long long)i);
    }
    if (text) snprintf(text + at, size - at, "#line 1\n%s", glsl);
    return text;
}

static bool open_glsl(ref_field *f, const ref_blob *blob, const char *glsl, const char *source,
                      bool parts, char *error, size_t size) {
    char *text = with_params(blob, glsl);
    f->inputs = calloc(1, sizeof *f->inputs);
    bool good = text && f->inputs;
    if (!good) snprintf(error, size, "out of memory for the field");
    if (good) {
        f->inputs->time = f->time;
        memcpy(f->inputs->params, f->params, sizeof f->params);
        good = ref_compile_glsl(text, source, parts, &f->glsl, &f->run, error, size);
    }
    free(text);
    return good;
}

/* The parts for which masu-sdfc generates no C: their whole form is GLSL. */
static bool open_parts(ref_field *f, const ref_blob *blob, const masu_sdfc_result *made,
                       const char *source, char *error, size_t size) {
    f->parts = calloc(made->part_count, sizeof *f->parts);
    f->steepness = calloc(made->part_count, sizeof *f->steepness);
    for (uint32_t i = 0; f->parts && f->steepness && i < made->part_count; i++) {
        if (made->parts[i].truth) continue;
        f->parts[f->part_count] = (int)i;
        f->steepness[f->part_count++] = made->parts[i].lipschitz;
    }
    if (!f->part_count) return true;
    if (!open_glsl(f, blob, made->glsl, source, true, error, size)) return false;
    for (uint32_t i = 0; i < made->slot_count; i++) f->inputs->slots[i] = (double)made->slots[i];
    ref_glsl_call call = {.what = REF_GLSL_UPDATE};
    f->run(f->inputs, &call);
    return true;
}

static bool find_boxes(ref_field *f, const masu_sdfc_result *made) {
    f->boxes = calloc(made->part_count + 1, sizeof *f->boxes);
    for (uint32_t i = 0; f->boxes && i < made->part_count; i++) {
        const masu_sdfc_part *part = &made->parts[i];
        if (!part->truth) continue;
        f->boxes[f->box_count++] = (ref_field_box){
            ref_v(part->low[0], part->low[1], part->low[2]),
            ref_v(part->high[0], part->high[1], part->high[2]), (int)i, part->lipschitz};
    }
    return f->boxes != NULL;
}

static bool open_sdf(ref_field *f, const ref_blob *blob, const char *text, size_t bytes,
                     const char *source, char *error, size_t size) {
    const masu_blob_sdf *sdf = blob->section[MASU_BLOB_SDF];
    uint64_t param_count = blob->count[MASU_BLOB_SDF_PARAMS];
    masu_sdfc_result made;
    masu_sdfc_options options = {.pairs = UINT32_MAX};
    memset(&made, 0, sizeof made);
    bool good = masu_sdfc_compile_with(text, bytes, source, &options, &made, error, size);
    if (good && (made.param_count != param_count || made.part_count != sdf->part_count)) {
        snprintf(error, size,
                 "%s: not the source of this scene's field: expected %u parts and %u parameters, "
                 "found %u and %u",
                 source, sdf->part_count, (unsigned)param_count, made.part_count, made.param_count);
        good = false;
    }
    good = good && ref_compile_c(made.c, &f->c, error, size);
    if (good && (!ref_library_find(&f->c, "masu_truth_step", &f->step) ||
                 !ref_library_find(&f->c, "masu_truth_distance", &f->distance) ||
                 !ref_library_find(&f->c, "masu_truth_part", &f->part) ||
                 !ref_library_find(&f->c, "masu_truth_part_distance", &f->part_distance) ||
                 !ref_library_find(&f->c, "masu_truth_look", &f->look) ||
                 !ref_library_find(&f->c, "masu_truth_material", &f->material))) {
        snprintf(error, size, "%s: the compiled field lacks a function", source);
        good = false;
    }
    good = good && open_parts(f, blob, &made, source, error, size);
    if (good && (!find_boxes(f, &made) || !ref_field_find_emitters(f, &made))) {
        snprintf(error, size, "out of memory for the field");
        good = false;
    }
    masu_sdfc_release(&made);
    return good;
}

bool ref_field_open(const char *source, const ref_blob *blob, double time, ref_field *f,
                    char *error, size_t size) {
    const masu_blob_sdf *sdf = blob->section[MASU_BLOB_SDF];
    const masu_blob_sdf_param *params = blob->section[MASU_BLOB_SDF_PARAMS];
    uint8_t *text = NULL;
    size_t bytes;
    memset(f, 0, sizeof *f);
    f->time = time;
    f->low = ref_of(sdf->bounds_min);
    f->high = ref_of(sdf->bounds_max);
    f->longest = (double)sdf->max_distance;
    f->lipschitz = (double)sdf->lipschitz;
    for (uint64_t i = 0; i < blob->count[MASU_BLOB_SDF_PARAMS] && i < PARAMS_MOST; i++)
        f->params[i] = (double)params[i].value;
    bool good = masu_file_read(source, SOURCE_MOST, &text, &bytes, error, size);
    if (good && is_sdf(source)) {
        good = open_sdf(f, blob, (const char *)text, bytes, source, error, size);
    } else if (good) {
        char *copy = calloc(bytes + 1, 1); /* with a NUL */
        if (copy) memcpy(copy, text, bytes);
        good = open_glsl(f, blob, copy ? copy : "", source, false, error, size);
        free(copy);
    }
    free(text);
    if (!good) {
        ref_field_close(f);
        error[strcspn(error, "\n")] = 0;
    }
    return good;
}

void ref_field_close(ref_field *f) {
    ref_library_close(&f->c);
    ref_library_close(&f->glsl);
    free(f->inputs);
    free(f->parts);
    free(f->steepness);
    free(f->boxes);
    free(f->emitters);
    memset(f, 0, sizeof *f);
}

/* ---- Values ---------------------------------------------------------------------------------- */

static double glsl_at(const ref_field *f, int part, const double p[3]) {
    ref_glsl_call call = {.what = REF_GLSL_FIELD, .part = part};
    memcpy(call.point, p, sizeof call.point);
    f->run(f->inputs, &call);
    return isnan(call.value) ? HUGE_VAL : call.value; /* empty */
}

/* The smallest f / L over all parts, its part and f. */
static double least_at(const ref_field *f, const double p[3], int *part, double *distance) {
    if (!f->c.handle) {
        *distance = glsl_at(f, 0, p);
        *part = 0;
        return *distance / f->lipschitz;
    }
    double step = f->step(f->params, f->time, p);
    *distance = f->part_count ? f->distance(f->params, f->time, p) : step;
    *part = -1; /* in the C */
    for (uint32_t i = 0; i < f->part_count; i++) {
        double own = glsl_at(f, f->parts[i], p);
        *distance = fmin(*distance, own * f->steepness[i]);
        if (!(own < step)) continue;
        step = own;
        *part = f->parts[i];
    }
    return step;
}

static double step_at(const ref_field *f, ref_vec p) {
    double at[3] = {p.x, p.y, p.z}, distance;
    int part;
    return least_at(f, at, &part, &distance);
}

double ref_field_distance(const ref_field *f, ref_vec p) {
    double at[3] = {p.x, p.y, p.z}, distance;
    int part;
    if (f->c.handle && !f->part_count) return f->distance(f->params, f->time, at);
    least_at(f, at, &part, &distance);
    return distance;
}

/* ---- Rays ------------------------------------------------------------------------------------ */

static double extent(ref_vec p) { return 1 + fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* The interval of a ray within a box. */
static bool clip(ref_vec lowest, ref_vec highest, ref_vec from, ref_vec d, double *near,
                 double *far) {
    double o[3] = {from.x, from.y, from.z}, w[3] = {d.x, d.y, d.z};
    double low[3] = {lowest.x, lowest.y, lowest.z}, high[3] = {highest.x, highest.y, highest.z};
    for (int k = 0; k < 3; k++) {
        if (w[k] == 0) {
            if (o[k] < low[k] || o[k] > high[k]) return false;
            continue;
        }
        double a = (low[k] - o[k]) / w[k], b = (high[k] - o[k]) / w[k];
        double first = a < b ? a : b, last = a < b ? b : a;
        if (first > *near) *near = first;
        if (last < *far) *far = last;
        if (!(*near < *far)) return false;
    }
    return true;
}

/* Work of a ray: a part, and the ray's interval in its box. */
typedef struct span {
    double near, far;
    const ref_field_box *box;
} span;

static uint32_t spans_of(const ref_field *f, ref_vec from, ref_vec d, double near, double far,
                         span out[MASU_SDFC_PARTS_MAX]) {
    uint32_t count = 0;
    ref_vec wider = ref_splat(1e-6 * extent(from));
    for (uint32_t i = 0; i < f->box_count; i++) {
        span s = {near, far, &f->boxes[i]};
        ref_vec low = ref_sub(s.box->low, wider), high = ref_add(s.box->high, wider);
        if (clip(low, high, from, d, &s.near, &s.far)) out[count++] = s;
    }
    return count;
}

/* Safe step of a ray at t: no part is hit before its box. */
static double step_along(const ref_field *f, ref_vec p, double t, const span *spans,
                         uint32_t count) {
    double at[3] = {p.x, p.y, p.z}, step = HUGE_VAL;
    for (uint32_t i = 0; i < count; i++) {
        const span *s = &spans[i];
        if (t > s->far) continue;
        double own = s->near - t;
        if (!(own > 1e-7 * extent(p)))
            own = f->part_distance(f->params, f->time, at, s->box->part) / s->box->lipschitz;
        if (own < step) step = own;
    }
    for (uint32_t i = 0; i < f->part_count; i++) step = fmin(step, glsl_at(f, f->parts[i], at));
    return step;
}

double ref_field_trace(const ref_field *f, ref_vec from, ref_vec d, double far) {
    double t = 0, limit = fmin(far, f->longest);
    span spans[MASU_SDFC_PARTS_MAX];
    if (!clip(f->low, f->high, from, d, &t, &limit)) return HUGE_VAL;
    uint32_t count = f->c.handle ? spans_of(f, from, d, t, limit, spans) : 0;
    for (int i = 0; i < STEPS_MOST && t < limit; i++) {
        ref_vec p = ref_along(from, t, d);
        double step = f->c.handle ? step_along(f, p, t, spans, count) : step_at(f, p);
        if (!(step > 1e-8 * extent(p))) return t;
        t += step;
    }
    return HUGE_VAL;
}

ref_vec ref_field_normal(const ref_field *f, ref_vec p) {
    double h = 1e-6 * extent(p);
    ref_vec g = ref_v(ref_field_distance(f, ref_v(p.x + h, p.y, p.z)) -
                          ref_field_distance(f, ref_v(p.x - h, p.y, p.z)),
                      ref_field_distance(f, ref_v(p.x, p.y + h, p.z)) -
                          ref_field_distance(f, ref_v(p.x, p.y - h, p.z)),
                      ref_field_distance(f, ref_v(p.x, p.y, p.z + h)) -
                          ref_field_distance(f, ref_v(p.x, p.y, p.z - h)));
    return ref_unit(g);
}

ref_vec ref_field_leave(const ref_field *f, ref_vec p, ref_vec n) {
    double lift = 4e-8 * extent(p);
    ref_vec from = ref_along(p, lift, n);
    for (int i = 0; i < 20 && !(step_at(f, from) > 2e-8 * extent(p)); i++) {
        lift *= 2;
        from = ref_along(p, lift, n);
    }
    return from;
}

void ref_field_surface(const ref_field *f, ref_vec p, ref_vec n, ref_surface *s) {
    double at[3] = {p.x, p.y, p.z}, m[8], distance;
    int part;
    least_at(f, at, &part, &distance);
    if (f->c.handle) {
        const double normal[3] = {n.x, n.y, n.z};
        part = part < 0 ? f->part(f->params, f->time, at) : part;
        f->look(f->params, f->time, part, at, normal, 0, m);
    } else {
        ref_glsl_call call = {.what = REF_GLSL_SURFACE, .normal = {n.x, n.y, n.z}};
        memcpy(call.point, at, sizeof at);
        f->run(f->inputs, &call);
        memcpy(m, call.look, sizeof m);
    }
    memset(s, 0, sizeof *s);
    s->albedo = ref_v(ref_clamp(m[0], 0, 1), ref_clamp(m[1], 0, 1), ref_clamp(m[2], 0, 1));
    s->roughness = ref_clamp(m[3], 0, 1);
    s->emissive = ref_v(ref_clamp(m[4], 0, EMISSIVE_MOST), ref_clamp(m[5], 0, EMISSIVE_MOST),
                        ref_clamp(m[6], 0, EMISSIVE_MOST));
    s->metallic = ref_clamp(m[7], 0, 1);
    s->specular = 0.5;
    s->occlusion = 1;
}
