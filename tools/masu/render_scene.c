/* render_scene.c: changes of `masu render` to the scene of a frame: SDF parameters (--param), and
 * animation clips of models (--animate, --clip). */
#include "masu/render.h"

#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SCENE_BYTES_MAX ((size_t)2 << 30)

/* Appends a name to `out`, separated by ", ". */
static void list(char *out, size_t size, const char *name) {
    size_t used = strlen(out);
    snprintf(out + used, size - used, "%s%s", used ? ", " : "", name);
}

/* Sets one --param. On false `error` has the reason. */
static bool set_param(const masu_scene *scene, const char *text, float *values, char *error,
                      size_t size) {
    const char *equals = strchr(text, '=');
    char name[256] = "", known[512] = "", *end = NULL;
    double value = equals ? strtod(equals + 1, &end) : 0.0;
    if (!equals || equals == text || end == equals + 1 || *end ||
        (size_t)(equals - text) >= sizeof name) {
        snprintf(error, size, "--param: expected NAME=NUMBER, found '%.100s'", text);
        return false;
    }
    memcpy(name, text, (size_t)(equals - text));
    int32_t at = masu_scene_find(scene, MASU_SCENE_SDF_PARAM, name);
    if (at < 0) {
        for (uint32_t i = 0; i < masu_scene_count(scene, MASU_SCENE_SDF_PARAM); i++)
            list(known, sizeof known, masu_scene_name(scene, MASU_SCENE_SDF_PARAM, i));
        snprintf(error, size, "--param: the scene has no parameter '%.100s'%s%.500s", name,
                 *known ? ", expected one of " : "; it has none", known);
        return false;
    }
    float minimum, maximum;
    (void)masu_scene_sdf_range(scene, (uint32_t)at, &minimum, &maximum);
    if (!((float)value >= minimum && (float)value <= maximum)) { /* compared as floats, like the
                                                                  * range */
        snprintf(error, size, "--param: %.100s: expected %g to %g, found %.30s", name,
                 (double)minimum, (double)maximum, equals + 1);
        return false;
    }
    values[at] = (float)value;
    return true;
}

/* Finds a clip by name or number. */
static uint32_t find_clip(const masu_session *s, masu_model model, const char *clip) {
    char *end;
    uint32_t at = masu_model_clip_find(s->m, model, clip);
    unsigned long number = strtoul(clip, &end, 10);
    if (at == MASU_CLIP_NONE && *clip >= '0' && *clip <= '9' && !*end &&
        number < masu_model_clips(s->m, model))
        at = (uint32_t)number;
    return at;
}

/* The same before a renderer exists. */
static bool has_clip(const masu_scene *scene, const char *clip, char *error, size_t size) {
    char known[512] = "", number[16];
    for (uint32_t i = 0; i < masu_scene_count(scene, MASU_SCENE_MODEL); i++) {
        for (uint32_t c = 0; c < masu_scene_clip_count(scene, i); c++) {
            const char *name = masu_scene_clip_name(scene, i, c);
            snprintf(number, sizeof number, "%u", c);
            if (!strcmp(name, clip) || !strcmp(number, clip)) return true;
            list(known, sizeof known, *name ? name : number);
        }
    }
    snprintf(error, size, "--clip: no model has the clip '%.100s'%s%.500s", clip,
             *known ? ", expected one of " : ": the scene has no clips", known);
    return false;
}

/* A session does not keep the blob, so it is read here, too. */
bool masu_render_read_scene(masu_render_options *o, char *error, size_t size) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    masu_scene scene;
    masu_detail detail;
    if (!o->param_count && !o->clip) return true;
    if (!masu_file_read(o->d.scene_path, SCENE_BYTES_MAX, &bytes, &count, error, size))
        return false;
    bool good = !masu_scene_bind(bytes, count, &scene, &detail);
    if (good) {
        o->sdf_param_count = o->param_count ? masu_scene_count(&scene, MASU_SCENE_SDF_PARAM) : 0;
        for (uint32_t i = 0; i < o->sdf_param_count; i++)
            o->sdf_params[i] = masu_scene_sdf_range(&scene, i, NULL, NULL);
        for (uint32_t i = 0; i < o->param_count && good; i++)
            good = set_param(&scene, o->params[i], o->sdf_params, error, size);
        good = good && (!o->clip || has_clip(&scene, o->clip, error, size));
    } else {
        snprintf(error, size, "%s: %s", o->d.scene_path, detail.text);
    }
    free(bytes);
    return good;
}

bool masu_render_animate(masu_session *s, const masu_render_options *o, double time, char *error,
                         size_t size) {
    for (uint32_t i = 0; i < masu_scene_count(&s->scene, MASU_SCENE_MODEL); i++) {
        masu_model model = masu_model_at(s->m, i);
        uint32_t clip = o->clip ? find_clip(s, model, o->clip) : 0;
        masu_clip_use use = {
            .clip = clip == MASU_CLIP_NONE ? 0 : clip, .loop = 1, .time = time, .weight = 1.0f};
        if (!masu_model_clips(s->m, model) || !masu_model_animate(s->m, model, &use, 1, &s->detail))
            continue;
        snprintf(error, size, "%s", s->detail.text);
        return false;
    }
    return true;
}
