/* read.c: a scene description as a whole; see description.h. */
#include "bake/base/file.h"
#include "bake/description/reader.h"
#include "cli/cli.h"
#include "file_kind.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ASSIMP_PREFIX "@assimp/"

/* ---- paths ---- */

static const char *take_joined(const masu_bake_reader *r, const char *directory, const char *name) {
    char *path = masu_bake_join(directory, name);
    const char *kept = masu_bake_take_text(&r->out->pool, path);
    free(path);
    return kept;
}

const char *masu_bake_path(const masu_bake_reader *r, const char *name) {
    if (name[0] == '/' || strcmp(r->directory, ".") == 0)
        return masu_bake_take_text(&r->out->pool, name);
    return take_joined(r, r->directory, name);
}

const char *masu_bake_model_path(const masu_bake_reader *r, const char *name) {
    size_t prefix = strlen(ASSIMP_PREFIX);
    if (strncmp(name, ASSIMP_PREFIX, prefix) != 0) return masu_bake_path(r, name);
    return take_joined(r, r->models_directory, name + prefix);
}

/* ---- the scene ---- */

static bool read_members(const masu_bake_json *scene, masu_bake_reader *r) {
    static const char *const members[] = {"models",
                                          "camera",
                                          "sun",
                                          "ambient",
                                          "sky",
                                          "fog",
                                          "exposure",
                                          "smooth_edges",
                                          "sdf",
                                          "lods",
                                          "occluders",
                                          "probes",
                                          "bounce",
                                          "lights",
                                          "ambient_occlusion",
                                          "environment",
                                          "reflections",
                                          NULL};
    if (!masu_bake_json_object(scene, members) || !masu_bake_read_detail(scene, r) ||
        !masu_bake_read_probes(scene, r) || !masu_bake_read_bounce(scene, r) ||
        !masu_bake_read_reflections(scene, r) ||
        !masu_bake_read_models(scene, r) || !masu_bake_read_lights(scene, r) ||
        !masu_bake_read_sdf(scene, r) || !masu_bake_read_look(scene, r) ||
        !masu_bake_read_environment(scene, r)) {
        return false;
    }
    if (r->out->sdf.source || r->out->model_count > 0) return true;
    return masu_bake_json_wrong(scene, "empty scene: expected models or an SDF");
}

static bool read_scene(const masu_bake_options *options, masu_bake_description *out) {
    masu_bake_json scene = {.file = options->input};
    if (!masu_bake_json_load(options->input, &scene.value)) return false;
    char *directory = masu_bake_directory_of(options->input);
    masu_bake_reader reader = {directory, options->models_directory, options->bare, out};
    bool good = read_members(&scene, &reader);
    if (out->environment.file) out->environment.rotate += options->turn;
    free(directory);
    json_decref(scene.value);
    return good;
}

static void describe_model(const char *file, const char *variant, masu_bake_description *out) {
    out->models = masu_bake_take(&out->pool, sizeof *out->models);
    out->models[0] = (masu_bake_model){.where = "",
                                       .file = file,
                                       .variant = variant,
                                       .plays = true,
                                       .lights = 1,
                                       .placement = masu_bake_identity()};
    out->model_count = 1;
}

static bool is_scene(const char *path) {
    size_t length = strlen(path);
    return length > 5 && strcmp(path + length - 5, ".json") == 0;
}

bool masu_bake_read(const masu_bake_options *options, masu_bake_description *out) {
    *out = (masu_bake_description){.file = options->input,
                                   .look = masu_bake_default_look(),
                                   .probes = masu_bake_probe_defaults(),
                                   .reflections = masu_bake_reflection_defaults()};
    masu_file_kind kind = masu_file_kind_of(options->input, NULL, 0);
    if (kind && kind != MASU_FILE_DESCRIPTION && kind != MASU_FILE_MODEL && kind != MASU_FILE_SDF) {
        masu_cli_error("%s: is no model, scene description or SDF%s", options->input,
                       masu_file_hint(options->input, NULL, 0, MASU_FILE_UNKNOWN));
        return false;
    }
    bool is_lone = !is_scene(options->input) && !masu_bake_is_sdf(options->input);
    if (options->variant && !is_lone) {
        masu_cli_error("%s: --variant needs a model", options->input);
        return false;
    }
    if (is_scene(options->input)) {
        if (!options->describe) return read_scene(options, out);
        masu_cli_error(
            "%s: is a scene description already; --describe needs a model or a .sdf file",
            options->input);
        return false;
    }
    if (masu_bake_is_sdf(options->input)) return masu_bake_describe_sdf(options, out);
    describe_model(options->input, options->variant, out);
    out->first_look = out->reflections.wanted = out->default_reflections = !options->bare;
    return true;
}

void masu_bake_description_release(masu_bake_description *description) {
    masu_bake_pool_release(&description->pool);
    *description = (masu_bake_description){0};
}

bool masu_bake_wrong(const masu_bake_description *d, const char *where, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    masu_bake_json at = {.file = d->file};
    snprintf(at.where, sizeof at.where, "%s", where);
    return masu_bake_json_wrong(&at, "%s", text);
}
