/* field.c: see field.h. */
#include "lab/reference/field.h"

#include "bake/base/process.h"
#include "image.h"
#include "sdfc/sdfc.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EMISSIVE_MOST 65504.0
enum { SOURCE_MOST = 4 << 20, SECONDS = 120, STEPS_MOST = 4000 };

static bool compile(ref_field *f, const char *text, char *error, size_t size) {
    char source[128], object[128];
    snprintf(f->folder, sizeof f->folder, "/tmp/masu-reference-XXXXXX");
    if (!mkdtemp(f->folder)) {
        f->folder[0] = 0;
        snprintf(error, size, "cannot make a folder in /tmp for the compiled field");
        return false;
    }
    snprintf(source, sizeof source, "%s/field.c", f->folder);
    snprintf(object, sizeof object, "%s/field.so", f->folder);
    if (!masu_file_write(source, text, strlen(text), error, size)) return false;
    const char *arguments[] = {"cc",      "-std=c11", "-O2", "-w",   "-ffp-contract=off",
                               "-shared", "-fPIC",    "-o",  object, source,
                               "-lm",     NULL};
    masu_bake_buffer output = {0};
    masu_bake_result result = masu_bake_run(arguments, SECONDS, &output);
    bool good = result.end == MASU_BAKE_EXITED && result.code == 0;
    if (!good) {
        masu_bake_append(&output, "", 1);
        output.data[strcspn((char *)output.data, "\n")] = 0;
        snprintf(error, size, "the C compiler (cc) cannot compile the field: %.200s",
                 (char *)output.data);
    }
    masu_bake_release(&output);
    if (good) f->library = dlopen(object, RTLD_NOW | RTLD_LOCAL);
    if (good && !f->library)
        snprintf(error, size, "cannot load the compiled field: %.200s", dlerror());
    return f->library != NULL;
}

/* ISO C has no conversion from an object pointer to a function pointer; POSIX has. */
static bool find(const ref_field *f, const char *name, void *to) {
    void *symbol = dlsym(f->library, name);
    memcpy(to, &symbol, sizeof symbol);
    return symbol != NULL;
}

bool ref_field_open(const char *source, const masu_blob_sdf *sdf, const masu_blob_sdf_param *params,
                    uint32_t param_count, double time, ref_field *f, char *error, size_t size) {
    uint8_t *text = NULL;
    size_t bytes;
    masu_sdfc_result made;
    memset(f, 0, sizeof *f);
    memset(&made, 0, sizeof made);
    f->time = time;
    f->low = ref_of(sdf->bounds_min);
    f->high = ref_of(sdf->bounds_max);
    f->longest = (double)sdf->max_distance;
    for (uint32_t i = 0; i < param_count && i < 256; i++) f->params[i] = (double)params[i].value;
    masu_sdfc_options options = {.pairs = UINT32_MAX};
    bool good =
        masu_file_read(source, SOURCE_MOST, &text, &bytes, error, size) &&
        masu_sdfc_compile_with((const char *)text, bytes, source, &options, &made, error, size);
    if (good && (made.param_count != param_count || made.part_count != sdf->part_count)) {
        snprintf(error, size,
                 "%s: not the source of this scene's field: expected %u parts and %u parameters, "
                 "found %u and %u",
                 source, sdf->part_count, param_count, made.part_count, made.param_count);
        good = false;
    }
    for (uint32_t i = 0; good && i < made.part_count; i++) {
        if (made.parts[i].truth) continue;
        snprintf(error, size, "%s: the part %s is GLSL and has no C: the reference cannot trace it",
                 source, made.parts[i].name);
        good = false;
    }
    good = good && compile(f, made.c, error, size);
    if (good &&
        (!find(f, "masu_truth_step", &f->step) || !find(f, "masu_truth_distance", &f->distance) ||
         !find(f, "masu_truth_part", &f->part) || !find(f, "masu_truth_material", &f->material))) {
        snprintf(error, size, "%s: the compiled field lacks a function", source);
        good = false;
    }
    masu_sdfc_release(&made);
    free(text);
    if (!good) ref_field_close(f);
    error[strcspn(error, "\n")] = 0;
    return good;
}

void ref_field_close(ref_field *f) {
    static const char *const files[] = {"field.c", "field.so"};
    char path[128];
    if (f->library) dlclose(f->library);
    for (int i = 0; f->folder[0] && i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", f->folder, files[i]);
        unlink(path);
    }
    if (f->folder[0]) rmdir(f->folder);
    memset(f, 0, sizeof *f);
}

/* ---- Rays ------------------------------------------------------------------------------------ */

static double extent(ref_vec p) { return 1 + fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

static double step_at(const ref_field *f, ref_vec p) {
    double at[3] = {p.x, p.y, p.z};
    return f->step(f->params, f->time, at);
}

static double distance_at(const ref_field *f, ref_vec p) {
    double at[3] = {p.x, p.y, p.z};
    return f->distance(f->params, f->time, at);
}

/* Where a ray is within the bounds. */
static bool clip(const ref_field *f, ref_vec from, ref_vec d, double *near, double *far) {
    double o[3] = {from.x, from.y, from.z}, w[3] = {d.x, d.y, d.z};
    double low[3] = {f->low.x, f->low.y, f->low.z}, high[3] = {f->high.x, f->high.y, f->high.z};
    for (int k = 0; k < 3; k++) {
        if (w[k] == 0) {
            if (o[k] < low[k] || o[k] > high[k]) return false;
            continue;
        }
        double a = (low[k] - o[k]) / w[k], b = (high[k] - o[k]) / w[k];
        *near = fmax(*near, fmin(a, b));
        *far = fmin(*far, fmax(a, b));
    }
    return *near < *far;
}

double ref_field_trace(const ref_field *f, ref_vec from, ref_vec d, double far) {
    double t = 0, limit = fmin(far, f->longest);
    if (!clip(f, from, d, &t, &limit)) return HUGE_VAL;
    for (int i = 0; i < STEPS_MOST && t < limit; i++) {
        ref_vec p = ref_along(from, t, d);
        double step = step_at(f, p);
        if (!(step > 1e-8 * extent(p))) return t;
        t += step;
    }
    return HUGE_VAL;
}

ref_vec ref_field_normal(const ref_field *f, ref_vec p) {
    double h = 1e-6 * extent(p);
    ref_vec g =
        ref_v(distance_at(f, ref_v(p.x + h, p.y, p.z)) - distance_at(f, ref_v(p.x - h, p.y, p.z)),
              distance_at(f, ref_v(p.x, p.y + h, p.z)) - distance_at(f, ref_v(p.x, p.y - h, p.z)),
              distance_at(f, ref_v(p.x, p.y, p.z + h)) - distance_at(f, ref_v(p.x, p.y, p.z - h)));
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

void ref_field_surface(const ref_field *f, ref_vec p, ref_surface *s) {
    double at[3] = {p.x, p.y, p.z}, m[8];
    f->material(f->part(f->params, f->time, at), m);
    memset(s, 0, sizeof *s);
    s->albedo = ref_v(ref_clamp(m[0], 0, 1), ref_clamp(m[1], 0, 1), ref_clamp(m[2], 0, 1));
    s->roughness = ref_clamp(m[3], 0, 1);
    s->emissive = ref_v(ref_clamp(m[4], 0, EMISSIVE_MOST), ref_clamp(m[5], 0, EMISSIVE_MOST),
                        ref_clamp(m[6], 0, EMISSIVE_MOST));
    s->metallic = ref_clamp(m[7], 0, 1);
    s->specular = 0.5;
    s->occlusion = 1;
}
