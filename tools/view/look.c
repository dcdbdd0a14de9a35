/* look.c: changes of the panels to the scene that need no bake: light, SDF parameters, lamps,
 * visible models and clips. They are applied to A and B before each frame, so that they outlive a
 * renderer. */
#include "view/viewer.h"

#include "scene/blob_section.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEGREES 57.29577951308232f

static uint32_t listed(const masu_viewer *v, masu_scene_item item) {
    uint32_t count = masu_scene_count(&v->scene, item);
    return count < MASU_LOOK_ITEMS ? count : MASU_LOOK_ITEMS;
}

static void read_light(masu_viewer *v) {
    masu_view_look *l = &v->look;
    l->has_light = masu_light_of(v->a.m, &l->from, NULL) == MASU_OK;
    const float *d = l->from.sun_direction;
    float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    l->light = l->from;
    l->azimuth = atan2f(d[0], d[2]) * DEGREES;
    l->elevation =
        length > 0.0f ? asinf(fminf(fmaxf(d[1] / length, -1.0f), 1.0f)) * DEGREES : 90.0f;
    l->sun = 1.0f;
    l->stops = 0.0f;
}

static void read_params(masu_viewer *v) {
    masu_view_look *l = &v->look;
    l->param_count = masu_scene_count(&v->scene, MASU_SCENE_SDF_PARAM);
    for (uint32_t i = 0; i < l->param_count; i++)
        l->params[i] = masu_scene_sdf_range(&v->scene, i, NULL, NULL);
}

void masu_look_reset(masu_viewer *v) {
    masu_view_look *l = &v->look;
    memset(l, 0, sizeof *l);
    read_light(v);
    read_params(v);
    for (uint32_t i = 0; i < MASU_LOOK_ITEMS; i++) {
        l->lamps[i] = 1.0f;
        l->clips[i] = (masu_playback){.other = 1, .speed = 1.0f, .plays = true, .loops = true};
    }
    for (uint32_t i = 0; i < listed(v, MASU_SCENE_MODEL); i++) {
        masu_model_state model;
        masu_model m = masu_model_at(v->a.m, i);
        l->hidden[i] = !masu_model_get(v->a.m, m, &model, NULL) && !model.shown;
    }
}

/* A saved file does not reset the changes: parameters and lamps are matched by index. */
void masu_look_keep(masu_viewer *v) {
    masu_view_look before = v->look;
    masu_look_reset(v);
    masu_view_look *l = &v->look;
    bool same_light = !memcmp(&l->from, &before.from, sizeof l->from);
    if (same_light) {
        l->light = before.light;
        l->azimuth = before.azimuth, l->elevation = before.elevation, l->sun = before.sun,
        l->stops = before.stops;
    }
    if (l->param_count == before.param_count) memcpy(l->params, before.params, sizeof l->params);
    memcpy(l->lamps, before.lamps, sizeof l->lamps);
    memcpy(l->clips, before.clips, sizeof l->clips);
}

void masu_look_light(masu_viewer *v) {
    masu_view_look *l = &v->look;
    float a = l->azimuth / DEGREES, e = l->elevation / DEGREES;
    l->light.sun_direction[0] = cosf(e) * sinf(a);
    l->light.sun_direction[1] = sinf(e);
    l->light.sun_direction[2] = cosf(e) * cosf(a);
    for (int c = 0; c < 3; c++) l->light.sun_color[c] = l->from.sun_color[c] * l->sun;
    l->light.exposure = (l->from.exposure > 0.0f ? l->from.exposure : 1.0f) * exp2f(l->stops);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool pose(masu_renderer *m, masu_model model, masu_playback *p, masu_detail *detail) {
    uint32_t clips = masu_model_clips(m, model);
    if (!clips) return true;
    if (p->clip >= clips) p->clip = 0;
    if (p->other >= clips) p->other = 0;
    masu_clip_use uses[2] = {{p->clip, p->loops, p->time, 1.0f - p->blend},
                             {p->other, p->loops, p->time, p->blend}};
    return !masu_model_animate(m, model, uses, p->blend > 0.0f ? 2 : 1, detail);
}

/* Sets only changed lights, because the renderer processes each light that is set. */
static bool light_lamp(masu_viewer *v, masu_renderer *m, uint32_t i) {
    masu_punctual_light light = masu_punctual_light_at(m, i);
    masu_punctual_light_state state;
    masu_scene_view s = masu_scene_view_of(&v->scene);
    if (masu_punctual_light_get(m, light, &state, NULL)) return true;
    bool same = true;
    for (int c = 0; c < 3; c++) {
        float wanted = s.lights[i].color[c] * v->look.lamps[i];
        same = same && state.color[c] == wanted;
        state.color[c] = wanted;
    }
    return same || !masu_punctual_light_set(m, light, &state, &v->detail);
}

bool masu_look_apply(masu_viewer *v, masu_renderer *m, masu_frame_desc *frame) {
    masu_view_look *l = &v->look;
    bool good = true;
    frame->light = l->has_light && memcmp(&l->light, &l->from, sizeof l->light) ? &l->light : NULL;
    frame->sdf_params = l->param_count ? l->params : NULL;
    frame->sdf_param_count = l->param_count;
    for (uint32_t i = 0; i < listed(v, MASU_SCENE_LIGHT) && good; i++) good = light_lamp(v, m, i);
    for (uint32_t i = 0; i < listed(v, MASU_SCENE_MODEL) && good; i++) {
        masu_model model = masu_model_at(m, i);
        masu_model_state state;
        if (masu_model_get(m, model, &state, NULL)) continue;
        if (!state.shown != l->hidden[i])
            good = !masu_model_show(m, model, !l->hidden[i], &v->detail);
        good = good && pose(m, model, &l->clips[i], &v->detail);
    }
    return good;
}

void masu_look_advance(masu_viewer *v, double seconds) {
    for (uint32_t i = 0; i < listed(v, MASU_SCENE_MODEL); i++) {
        masu_playback *p = &v->look.clips[i];
        if (p->plays) p->time += seconds * (double)p->speed;
    }
}
