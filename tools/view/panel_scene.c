/* panel_scene.c: the panel "Scene": SDF parameters, models with their clips and variants, and the
 * scene's counts. */
#include "view/viewer.h"

#include <stdio.h>
#include <string.h>

#define CLIPS_MAX 64u

static void parameters(masu_viewer *v) {
    masu_view_look *l = &v->look;
    char format[32];
    if (!l->param_count || !masu_ui_section("Parameters", true)) return;
    for (uint32_t i = 0; i < l->param_count; i++) {
        float minimum, maximum;
        (void)masu_scene_sdf_range(&v->scene, i, &minimum, &maximum);
        float span = maximum - minimum;
        snprintf(format, sizeof format, "%%.%df", span > 50.0f ? 1 : span > 5.0f ? 2 : 3);
        masu_ui_push(i);
        masu_ui_slider(masu_scene_name(&v->scene, MASU_SCENE_SDF_PARAM, i), &l->params[i],
                       minimum, maximum, format, false);
        masu_ui_pop();
    }
    if (masu_ui_button("Defaults##parameters"))
        for (uint32_t i = 0; i < l->param_count; i++)
            l->params[i] = masu_scene_sdf_range(&v->scene, i, NULL, NULL);
}

static void clips(masu_viewer *v, uint32_t model, masu_playback *p) {
    const char *names[CLIPS_MAX];
    uint32_t count = masu_scene_clip_count(&v->scene, model);
    masu_model handle = masu_model_at(v->a.m, model);
    if (!count) return;
    if (count > CLIPS_MAX) count = CLIPS_MAX;
    for (uint32_t i = 0; i < count; i++) {
        names[i] = masu_scene_clip_name(&v->scene, model, i);
        if (!*names[i]) names[i] = "(no name)";
    }
    double length = masu_model_clip_duration(v->a.m, handle, p->clip);
    float at = (float)p->time;
    if (p->loops && length > 0.0)
        at = (float)(p->time - length * (double)(int64_t)(p->time / length));
    masu_ui_choice("Clip", &p->clip, names, count);
    masu_ui_check("Play", &p->plays);
    masu_ui_same_line();
    masu_ui_check("Loop", &p->loops);
    if (length > 0.0 && masu_ui_slider("Clip time", &at, 0.0f, (float)length, "%.2f s", false))
        p->time = (double)at, p->plays = false;
    masu_ui_slider("Speed", &p->speed, -4.0f, 4.0f, "%.2f", false);
    if (count < 2) return;
    masu_ui_choice("Blend with", &p->other, names, count);
    masu_ui_slider("Blend", &p->blend, 0.0f, 1.0f, "%.2f", false);
}

static void models(masu_viewer *v) {
    uint32_t count = masu_scene_count(&v->scene, MASU_SCENE_MODEL);
    char label[300];
    if (!count || !masu_ui_section("Models", true)) return;
    for (uint32_t i = 0; i < count && i < MASU_LOOK_ITEMS; i++) {
        const char *name = masu_scene_name(&v->scene, MASU_SCENE_MODEL, i);
        bool shown = !v->look.hidden[i];
        if (*name)
            snprintf(label, sizeof label, "%s", name);
        else
            snprintf(label, sizeof label, "model %u", i);
        masu_ui_push(i);
        if (masu_ui_check(label, &shown)) v->look.hidden[i] = !shown;
        clips(v, i, &v->look.clips[i]);
        masu_ui_pop();
    }
    if (count > MASU_LOOK_ITEMS) masu_ui_text(MASU_INK_DIM, "and %u more", count - MASU_LOOK_ITEMS);
}

static void variants(masu_viewer *v) {
    masu_baker *b = &v->baker;
    const char *names[MASU_VARIANTS_MAX + 1];
    uint32_t chosen = 0;
    if (!b->variant_count || !masu_ui_section("Variants", true)) return;
    names[0] = "(of the file)";
    for (uint32_t i = 0; i < b->variant_count; i++) {
        names[i + 1] = b->variants[i];
        if (!strcmp(b->variants[i], b->variant)) chosen = i + 1;
    }
    if (!masu_ui_choice("Materials", &chosen, names, b->variant_count + 1)) return;
    snprintf(b->variant, sizeof b->variant, "%s", chosen ? names[chosen] : "");
    masu_baker_again(v);
}

static void counts(const masu_viewer *v) {
    if (!masu_ui_section("Contents", true)) return;
    masu_ui_text(MASU_INK_DIM, "%s", *v->baker.source ? v->baker.source : v->baker.blob);
    masu_ui_text(MASU_INK, "%u instances, %llu triangles, %u materials, %u lights%s",
                 masu_scene_count(&v->scene, MASU_SCENE_INSTANCE),
                 (unsigned long long)masu_scene_triangles(&v->scene),
                 masu_scene_count(&v->scene, MASU_SCENE_MATERIAL),
                 masu_scene_count(&v->scene, MASU_SCENE_LIGHT),
                 masu_scene_features(&v->scene) & MASU_SCENE_HAS_SDF ? ", an SDF" : "");
    masu_ui_text(MASU_INK, "class %s, textures %.1f MiB",
                 masu_scene_class_name(masu_scene_class_of(&v->scene)),
                 (double)masu_scene_texture_bytes(&v->scene, v->host.compressed) / 1048576.0);
}

void masu_panel_scene(masu_viewer *v) {
    bool paused = v->paused;
    if (masu_ui_check("Pause time", &paused)) v->paused = paused;
    if (*v->baker.source) {
        masu_ui_same_line();
        if (masu_ui_button("Bake again")) masu_baker_again(v);
    }
    parameters(v);
    variants(v);
    models(v);
    counts(v);
}
