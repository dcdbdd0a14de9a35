/* meso.c: see meso.h. */
#include "bake/texture/meso.h"

#include <stdlib.h>
#include <string.h>

#include "bake/texture/material.h"
#include "cli/cli.h"

static bool read_three(const masu_bake_json *at, const char *name, float out[3]) {
    masu_bake_vec3 v = {0, 0, 0};
    if (!masu_bake_json_has(at, name)) return masu_bake_json_wrong(at, "needs \"%s\"", name);
    if (!masu_bake_json_vec3(at, name, -1000, 1000, &v)) return false;
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
    return true;
}

static bool read_one(const masu_bake_json *at, const char *name, double high, float *out) {
    double v = 0;
    if (!masu_bake_json_has(at, name)) return masu_bake_json_wrong(at, "needs \"%s\"", name);
    if (!masu_bake_json_number(at, name, 0, high, &v)) return false;
    *out = (float)v;
    return true;
}

static bool read_spread(const masu_bake_json *at, masu_blob_meso *m) {
    float v[3];
    if (!read_three(at, "spread", v)) return false;
    m->spread = v[0];
    m->spread1 = v[1];
    m->spread2 = v[2];
    return true;
}

static bool read_curves(const masu_bake_json *at, masu_blob_meso *m) {
    static const char *const members[] = {
        "tilt",   "rough", "open",   "gain", "tint", "specular", "facet_roughness",
        "spread", "alpha", "offset", NULL};
    memset(m, 0, sizeof *m);
    return masu_bake_json_object(at, members) && read_three(at, "tilt", m->tilt) &&
           read_three(at, "rough", m->roughness) && read_three(at, "open", m->occlusion) &&
           read_three(at, "gain", m->gain) && read_three(at, "tint", m->tint) &&
           read_three(at, "specular", m->specular) &&
           read_one(at, "facet_roughness", 1, &m->facet) && read_spread(at, m) &&
           read_one(at, "alpha", 4, &m->alpha) && read_one(at, "offset", 4, &m->offset);
}

static uint32_t element_of(masu_bake_content *content, const masu_blob_meso *m) {
    masu_bake_buffer *all = &content->section[MASU_BLOB_MESO];
    size_t count = all->bytes / sizeof *m;
    for (size_t i = 0; i < count; i++) {
        if (memcmp(all->data + i * sizeof *m, m, sizeof *m) == 0) return (uint32_t)i;
    }
    masu_bake_append(all, m, sizeof *m);
    return (uint32_t)count;
}

bool masu_bake_read_meso(const masu_bake_json *material, const char *directory,
                         masu_bake_content *content, uint32_t *index) {
    masu_bake_json at = masu_bake_json_member(material, "meso");
    masu_blob_meso curves;
    *index = MASU_BLOB_NONE;
    if (!at.value) return true;
    if (!json_is_string(at.value)) {
        if (!read_curves(&at, &curves)) return false;
    } else {
        char *path = masu_bake_resolve(json_string_value(at.value), directory, NULL);
        masu_bake_json file = {.file = path};
        bool good = masu_bake_json_load(path, &file.value) && read_curves(&file, &curves);
        if (file.value) json_decref(file.value);
        free(path);
        if (!good) return false;
    }
    *index = element_of(content, &curves);
    return true;
}
