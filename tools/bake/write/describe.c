/* describe.c: see describe.h. Camera, light and sizes are written as numbers, although a scene has
 * defaults for them: they are what someone edits, and the defaults of a scene depend on its ground,
 * too. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "bake/write/describe.h"
#include "bake/base/file.h"
#include "cli/cli.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put(masu_bake_buffer *out, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    masu_bake_append_text(out, text);
}

/* The shortest decimal that is read as the same double. */
static void put_double(masu_bake_buffer *out, double value) {
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    masu_bake_append_text(out, text);
}

/* Writes the shortest text that reads back as the same float, because the blob stores floats. */
static void put_float(masu_bake_buffer *out, float value) {
    char text[40];
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if ((float)strtod(text, NULL) == value) break;
    }
    masu_bake_append_text(out, text);
}

static void put_floats(masu_bake_buffer *out, const float *value) {
    for (int i = 0; i < 3; i++) {
        masu_bake_append_text(out, i ? ", " : "[");
        put_float(out, value[i]);
    }
    masu_bake_append_text(out, "]");
}

static void put_doubles(masu_bake_buffer *out, masu_bake_vec3 v) {
    const double value[3] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; i++) {
        masu_bake_append_text(out, i ? ", " : "[");
        put_double(out, value[i]);
    }
    masu_bake_append_text(out, "]");
}

/* A member with one number: `before` has its name. */
static void put_member(masu_bake_buffer *out, const char *before, float value) {
    masu_bake_append_text(out, before);
    put_float(out, value);
}

/* A feature with one setting, or false. `before` has its name. */
static void put_feature(masu_bake_buffer *out, const char *before, bool on, const char *setting,
                        double value) {
    masu_bake_append_text(out, before);
    if (on) {
        put(out, "{\"%s\": ", setting);
        put_double(out, value);
    }
    masu_bake_append_text(out, on ? "}" : "false");
}

/* As the description's folder sees it. */
static bool put_path(const masu_bake_options *options, const char *path, masu_bake_buffer *out) {
    char *directory = options->output ? masu_bake_directory_of(options->output) : NULL;
    char *folder = realpath(directory ? directory : ".", NULL), *file = realpath(path, NULL);
    bool good = folder && file;
    if (good) {
        size_t length = strlen(folder);
        bool inside = strncmp(file, folder, length) == 0 && file[length] == '/';
        json_t *name = json_string(inside ? file + length + 1 : file);
        char *text = name ? json_dumps(name, JSON_ENCODE_ANY) : NULL;
        good = text != NULL; /* a name that is not UTF-8 cannot be in JSON */
        if (text) masu_bake_append_text(out, text);
        free(text);
        json_decref(name);
    }
    if (!good) masu_cli_error("%s: its path cannot be written to a scene description", path);
    free(directory);
    free(folder);
    free(file);
    return good;
}

/* Files, and the ground of a first look. */
static bool put_models(const masu_bake_options *options, const masu_bake_description *d,
                       masu_bake_buffer *out) {
    if (!d->model_count) return true;
    masu_bake_append_text(out, "  \"models\": [\n");
    for (size_t i = 0; i < d->model_count; i++) {
        const masu_bake_model *m = &d->models[i];
        if (m->file) {
            masu_bake_append_text(out, "    {\"file\": ");
            if (!put_path(options, m->file, out)) return false;
            if (m->moving) masu_bake_append_text(out, ", \"moving\": true");
        } else {
            const masu_bake_shape *plane = &d->shapes[m->shape];
            const masu_blob_material *grey = &m->changes[0].value.value;
            put(out, "    {\"name\": \"%s\", \"mesh\": {\"plane\": {\"size_x\": ", m->name);
            put_double(out, plane->size.x);
            masu_bake_append_text(out, ", \"size_z\": ");
            put_double(out, plane->size.z);
            masu_bake_append_text(out, "}},\n     \"translate\": ");
            put_doubles(out, m->translation);
            masu_bake_append_text(out, ",\n     \"material\": {\"base_color\": ");
            put_floats(out, grey->base_color);
            put_member(out, ", \"roughness\": ", grey->roughness);
            put_member(out, ", \"metallic\": ", grey->metallic);
            put_member(out, ", \"specular\": ", grey->specular);
            masu_bake_append_text(out, "}");
        }
        masu_bake_append_text(out, i + 1 < d->model_count ? "},\n" : "}\n");
    }
    masu_bake_append_text(out, "  ],\n");
    return true;
}

static bool put_field(const masu_bake_options *options, const masu_bake_sdf *sdf,
                      masu_bake_buffer *out) {
    if (!sdf->source) return true;
    masu_bake_append_text(out, "  \"sdf\": {\n    \"source\": ");
    if (!put_path(options, sdf->source, out)) return false;
    masu_bake_append_text(out, ",\n    \"bounds\": [");
    put_doubles(out, sdf->bounds.low);
    masu_bake_append_text(out, ", ");
    put_doubles(out, sdf->bounds.high);
    masu_bake_append_text(out, "],\n    \"max_distance\": ");
    put_double(out, sdf->max_distance);
    const masu_bake_occlusion *o = &sdf->occlusion;
    put_feature(out, ",\n    \"shadows\": ", o->shadows, "distance", o->distance);
    put_feature(out, ",\n    \"ambient_occlusion\": ", o->ambient, "radius", o->radius);
    masu_bake_append_text(out, "\n  },\n");
    return true;
}

static void put_camera(const masu_bake_look *l, const masu_bake_content *content,
                       masu_bake_buffer *out) {
    const masu_blob_camera_key *key =
        MASU_BAKE_ARRAY(content, MASU_BLOB_CAMERA_KEYS, masu_blob_camera_key);
    const masu_blob_environment *e =
        MASU_BAKE_ARRAY(content, MASU_BLOB_ENVIRONMENT, masu_blob_environment);
    masu_bake_append_text(out, "  \"camera\": {\"fov_y\": ");
    put_double(out, l->fov_y);
    put_member(out, ", \"near\": ", e->near_distance);
    masu_bake_append_text(out, ", \"keys\": [{\"position\": ");
    put_floats(out, key->position);
    masu_bake_append_text(out, ", \"target\": ");
    put_floats(out, key->target);
    masu_bake_append_text(out, "}]},\n");
}

/* The sun of a file is not written: a scene with its own sun ignores it. */
static void put_sun(const masu_bake_look *l, const masu_bake_content *content,
                    masu_bake_buffer *out) {
    masu_bake_append_text(out, "  \"sun\": {");
    if (!l->sun_of_model) {
        masu_bake_append_text(out, "\"direction\": ");
        put_doubles(out, l->sun_direction);
        masu_bake_append_text(out, ", \"color\": ");
        put_doubles(out, l->sun_color);
        masu_bake_append_text(out, ", \"intensity\": ");
        put_double(out, l->sun_intensity);
        masu_bake_append_text(out, ", ");
    }
    masu_bake_append_text(out, "\"shadows\": ");
    if (masu_bake_count(content, MASU_BLOB_SHADOW)) {
        const masu_blob_shadow *s = MASU_BAKE_ARRAY(content, MASU_BLOB_SHADOW, masu_blob_shadow);
        put(out, "{\"cascades\": %u, \"resolution\": %u", s->cascades, s->resolution);
        put_member(out, ", \"distance\": ", s->distance);
        put_member(out, ", \"lambda\": ", s->lambda);
        masu_bake_append_text(out, "}");
    } else
        masu_bake_append_text(out, "false");
    masu_bake_append_text(out, "},\n");
}

static void put_air(const masu_bake_content *content, masu_bake_buffer *out) {
    const masu_blob_environment *e =
        MASU_BAKE_ARRAY(content, MASU_BLOB_ENVIRONMENT, masu_blob_environment);
    masu_bake_append_text(out, "  \"ambient\": ");
    put_floats(out, e->ambient);
    masu_bake_append_text(out, ",\n  \"sky\": {\"zenith\": ");
    put_floats(out, e->sky_zenith);
    masu_bake_append_text(out, ", \"horizon\": ");
    put_floats(out, e->sky_horizon);
    masu_bake_append_text(out, "},\n");
    if (e->fog_density > 0) {
        put_member(out, "  \"fog\": {\"density\": ", e->fog_density);
        put_member(out, ", \"start\": ", e->fog_start);
        masu_bake_append_text(out, ", \"color\": ");
        put_floats(out, e->fog_color);
        masu_bake_append_text(out, "},\n");
    }
    masu_bake_append_text(out, "  \"ambient_occlusion\": ");
    if (e->occlusion_radius > 0) {
        put_member(out, "{\"radius\": ", e->occlusion_radius);
        masu_bake_append_text(out, "}");
    } else
        masu_bake_append_text(out, "false");
    put(out, ",\n  \"smooth_edges\": %s,\n", e->smooth_edges > 0 ? "true" : "false");
}

static void put_reflections(const masu_bake_reflections *r, masu_bake_buffer *out) {
    put_feature(out, "  \"reflections\": ", r->wanted, "smallest", r->smallest);
    masu_bake_append_text(out, "\n}\n");
}

bool masu_bake_write_scene(const masu_bake_options *options, const masu_bake_description *d,
                           const masu_bake_content *content) {
    masu_bake_buffer text = {0};
    masu_bake_append_text(&text, "{\n");
    bool good = put_models(options, d, &text) && put_field(options, &d->sdf, &text);
    if (good) {
        put_camera(&d->look, content, &text);
        put_sun(&d->look, content, &text);
        put_air(content, &text);
        put_reflections(&d->reflections, &text);
        masu_cli_progress_clear();
        good = masu_bake_write_file(options->output ? options->output : "/dev/stdout", text.data,
                                    text.bytes);
    }
    masu_bake_release(&text);
    return good;
}
