/* extreme.c: see extreme.h. */
#include "conform/extreme.h"

#include "conform/read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979324 / 180.0)

/* ---- Reading --------------------------------------------------------------------------------- */

static bool read_floats(const masu_suite_place *at, const char *key, const json_t *value, size_t n,
                        double most, double *out) {
    char name[64];
    if (json_array_size(value) != n)
        return masu_suite_wrong(at, key, "expected an array of %zu numbers, found %zu", n,
                                json_array_size(value));
    for (size_t i = 0; i < n; i++) {
        snprintf(name, sizeof name, "%s[%zu]", key, i);
        if (!masu_suite_number(at, name, json_array_get(value, i), -most, most, false, &out[i]))
            return false;
    }
    return true;
}

static bool read_vector(const masu_suite_place *at, const char *key, const json_t *value,
                        float out[3]) {
    double v[3];
    if (!read_floats(at, key, value, 3, 1e9, v)) return false;
    for (int i = 0; i < 3; i++) out[i] = (float)v[i];
    return true;
}

static bool read_camera(const masu_suite_place *at, const json_t *value, masu_camera *c) {
    const char *key;
    json_t *member;
    double number;
    *c = (masu_camera){.forward = {0, 0, -1}, .fov_y = (float)(50 * DEGREE)};
    if (!masu_suite_object(at, "camera", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        bool good;
        if (!strcmp(key, "position")) {
            good = read_floats(at, "camera.position", member, 3, 1e12, c->position);
        } else if (!strcmp(key, "forward")) {
            good = read_vector(at, "camera.forward", member, c->forward);
        } else if (!strcmp(key, "up")) {
            good = read_vector(at, "camera.up", member, c->up);
        } else if (!strcmp(key, "fov")) {
            good = masu_suite_number(at, "camera.fov", member, 0.05, 179.9, false, &number);
            if (good) c->fov_y = (float)(number * DEGREE);
        } else if (!strcmp(key, "near")) {
            good = masu_suite_number(at, "camera.near", member, 0, 1e9, false, &number);
            if (good) c->near_distance = (float)number;
        } else {
            return masu_suite_unknown(at, "camera", key);
        }
        if (!good) return false;
    }
    return true;
}

static bool read_light(const masu_suite_place *at, const json_t *value, masu_light *l) {
    const char *key;
    json_t *member;
    *l = (masu_light){.sun_direction = {0, 1, 0}};
    if (!masu_suite_object(at, "light", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        const struct {
            const char *key;
            float *vector, *number;
        } known[] = {{"sun", l->sun_direction, NULL},   {"color", l->sun_color, NULL},
                     {"ambient", l->ambient, NULL},     {"zenith", l->sky_zenith, NULL},
                     {"horizon", l->sky_horizon, NULL}, {"ground", l->ground, NULL},
                     {"exposure", NULL, &l->exposure},  {"turbidity", NULL, &l->turbidity}};
        size_t i = 0, n = sizeof known / sizeof *known;
        double number = 0.0;
        while (i < n && strcmp(known[i].key, key)) i++;
        if (i == n) return masu_suite_unknown(at, "light", key);
        if (known[i].vector ? !read_vector(at, key, member, known[i].vector)
                            : !masu_suite_number(at, key, member, 0, 1e9, false, &number))
            return false;
        if (known[i].number) *known[i].number = (float)number;
    }
    return true;
}

static bool read_material(const masu_suite_place *at, const json_t *value, masu_extreme *x) {
    const char *key;
    json_t *member;
    x->has_material = true;
    if (!masu_suite_object(at, "material", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        bool good;
        if (!strcmp(key, "index")) {
            good = masu_suite_count(at, "material.index", member, 0, 65535, &x->material);
        } else if (!strcmp(key, "roughness")) {
            good = read_floats(at, "material.roughness", member, 2, 1, x->roughness);
        } else if (!strcmp(key, "emissive")) {
            good = masu_suite_number(at, "material.emissive", member, 0, 1e9, false, &x->emissive);
            x->has_emissive = true;
        } else {
            return masu_suite_unknown(at, "material", key);
        }
        if (!good) return false;
    }
    return true;
}

static bool read_key(const masu_suite_place *at, const char *key, const json_t *value,
                     masu_extreme *x) {
    double number = 0.0, rows[12];
    if (!strcmp(key, "camera")) {
        x->has_camera = true;
        return read_camera(at, value, &x->camera);
    }
    if (!strcmp(key, "other_camera")) {
        x->has_other = true;
        return read_camera(at, value, &x->other);
    }
    if (!strcmp(key, "light")) {
        x->has_light = true;
        return read_light(at, value, &x->light);
    }
    if (!strcmp(key, "material")) return read_material(at, value, x);
    if (!strcmp(key, "cut")) return masu_suite_flag(at, key, value, &x->cut);
    if (!strcmp(key, "cycle")) return masu_suite_flag(at, key, value, &x->cycle);
    if (!strcmp(key, "settle")) return masu_suite_count(at, key, value, 0, 100000, &x->settle);
    if (!strcmp(key, "instance")) return masu_suite_count(at, key, value, 0, 1000000, &x->instance);
    if (!strcmp(key, "step")) {
        x->has_step = true;
        if (!masu_suite_number(at, key, value, -1e15, 1e15, false, &number)) return false;
        x->step = (float)number;
        return true;
    }
    if (strcmp(key, "transform")) return masu_suite_unknown(at, "extreme", key);
    x->has_transform = true;
    if (!read_floats(at, "transform", value, 12, 3e38, rows)) return false;
    for (int i = 0; i < 12; i++) x->transform[i] = (float)rows[i];
    return true;
}

bool masu_extreme_read(const masu_suite_place *at, const json_t *value, masu_extreme *out) {
    const char *key;
    json_t *member;
    const char *input = out->input;
    memset(out, 0, sizeof *out);
    out->input = input;
    out->given = true;
    if (!masu_suite_object(at, "extreme", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        if (!read_key(at, key, member, out)) return false;
    }
    return true;
}

/* ---- Drawing --------------------------------------------------------------------------------- */

static bool looks(const masu_case *of) {
    return masu_bound_is_set(&of->bounds[MASU_MEASURE_NON_FINITE]) || masu_case_field(of);
}

void masu_extreme_describe(const masu_case *of, masu_desc *desc) {
    if (looks(of))
        desc->readback = MASU_READBACK_DEPTH | MASU_READBACK_HDR | MASU_READBACK_VELOCITY;
    desc->mutable_materials = of->extreme.has_material;
}

static bool set_material(masu_session *s, const masu_extreme *x, uint32_t number) {
    masu_material_state state;
    masu_material material = masu_material_at(s->m, x->material);
    if (masu_material_get(s->m, material, &state, &s->detail)) return false;
    double roughness = x->roughness[0] + x->roughness[1] * number;
    state.roughness = (float)fmin(fmax(roughness, 0.0), 1.0);
    for (int i = 0; i < 3 && x->has_emissive; i++) state.emissive[i] = (float)x->emissive;
    return !masu_material_set(s->m, material, &state, &s->detail);
}

bool masu_extreme_frame(masu_session *s, const masu_case *of, uint32_t number,
                        masu_frame_desc *frame, char *error, size_t error_size) {
    const masu_extreme *x = &of->extreme;
    bool settles = number + x->settle >= of->frames, odd = number % 2 && !settles;
    if (x->has_camera) frame->camera = odd && x->has_other ? &x->other : &x->camera;
    if (x->has_light) frame->light = &x->light;
    if (x->has_step && !(settles && x->settle)) frame->time_step = x->step;
    frame->cut = x->cut && !(settles && x->settle);
    frame->rung = x->cycle && !settles ? number % of->rung_count : 0;
    if (x->has_transform && !number &&
        masu_instance_set_transform(s->m, masu_instance_at(s->m, x->instance), x->transform,
                                    &s->detail)) {
        snprintf(error, error_size, "transform: %s", s->detail.text);
        return false;
    }
    if (x->has_material && !set_material(s, x, number)) {
        snprintf(error, error_size, "material: %s", s->detail.text);
        return false;
    }
    return true;
}

double masu_extreme_count(const masu_readback_image *image, bool depth) {
    double n = 0;
    for (uint32_t y = 0; y < image->height; y++) {
        const void *row = (const uint8_t *)image->pixels + y * image->row_bytes;
        const float *depths = row;
        const uint16_t *halves = row;
        for (uint32_t i = 0; i < image->width && depth; i++)
            n += !(depths[i] >= 0 && depths[i] <= 1);
        for (uint32_t i = 0; i < 4 * image->width && !depth; i++)
            n += (halves[i] & 0x7C00) == 0x7C00;
    }
    return n;
}

bool masu_extreme_non_finite(const masu_session *s, uint32_t slot, double *count, char *error,
                             size_t error_size) {
    masu_detail detail;
    static const masu_readback_bits kinds[] = {MASU_READBACK_DEPTH, MASU_READBACK_HDR,
                                               MASU_READBACK_VELOCITY};
    for (int k = 0; k < 3; k++) {
        masu_readback_image image;
        if (masu_readback(s->m, slot, kinds[k], &image, &detail)) {
            snprintf(error, error_size, "readback: %s", detail.text);
            return false;
        }
        *count += masu_extreme_count(&image, !k);
    }
    return true;
}

/* ---- The march ------------------------------------------------------------------------------- */

bool masu_field_look(const masu_session *s, const masu_case *of, masu_view *view, char *error,
                     size_t error_size) {
    return masu_view_of(&s->scene, &of->extreme.camera, of->time, of->width, of->height, view,
                        error, error_size);
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double part_of(const double *sorted, size_t count, double part) {
    return count ? sorted[(size_t)(part * (double)(count - 1) + 0.5)] : 0.0;
}

static void compare(const masu_readback_image *image, const masu_view *view,
                    const masu_truth_sample *samples, double *errors, masu_field_figures *out) {
    size_t decided = 0, wrong = 0, lost = 0, both = 0;
    for (uint32_t i = 0; i < view->width * view->height; i++) {
        uint32_t x = i % view->width, y = i / view->width;
        const float *row = (const void *)((const uint8_t *)image->pixels + y * image->row_bytes);
        if (samples[i].kind == MASU_TRUTH_UNSURE) continue;
        bool hit = row[x] > 0.0f, truly = samples[i].kind == MASU_TRUTH_HIT;
        decided++;
        wrong += hit != truly;
        lost += truly && !hit;
        if (!hit || !truly) continue;
        masu_view_ray ray = masu_view_ray_at(view, x, y);
        double t = view->near_distance * ray.z_scale / (double)row[x];
        errors[both++] = fabs(t - samples[i].t) / samples[i].t;
    }
    qsort(errors, both, sizeof *errors, by_size);
    double per_cent = 100.0 / (double)(decided ? decided : 1);
    *out = (masu_field_figures){.hitmiss_pct = per_cent * (double)wrong,
                                .lost_pct = per_cent * (double)lost,
                                .depth_p50 = part_of(errors, both, 0.5),
                                .depth_p99 = part_of(errors, both, 0.99)};
}

bool masu_field_compare(const masu_session *s, uint32_t slot, const char *scene_path,
                        const masu_view *view, masu_field_figures *out, char *error,
                        size_t error_size) {
    masu_truth truth;
    masu_readback_image image;
    char path[4096];
    size_t pixels = (size_t)view->width * view->height;
    if (masu_readback(s->m, slot, MASU_READBACK_DEPTH, &image, NULL) ||
        image.width != view->width || image.height != view->height) {
        snprintf(error, error_size, "field: expected a depth image of %ux%u", view->width,
                 view->height);
        return false;
    }
    if (!masu_truth_path(scene_path, path, sizeof path)) {
        snprintf(error, error_size, "field: '%.200s' is too long", scene_path);
        return false;
    }
    if (!masu_truth_open(path, &truth, error, error_size)) return false;
    masu_truth_sample *samples = malloc(pixels * sizeof *samples);
    double *errors = malloc(pixels * sizeof *errors);
    if (samples && errors) {
        masu_truth_image(&truth, view, 1, samples);
        compare(&image, view, samples, errors, out);
    } else {
        snprintf(error, error_size, "field: out of memory for %zu samples", pixels);
    }
    bool good = samples && errors;
    free(samples);
    free(errors);
    masu_truth_close(&truth);
    return good;
}
