/* panel_quality.c: the panel "Quality": rungs, the governor, and the knobs of the current rung.
 * Knobs without effect in this scene are omitted. A change is written to v->want and takes effect
 * at the end of the iteration, when the renderer is recreated. */
#include "view/viewer.h"

#include "settings/setting.h"

#include "session.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void rungs(masu_viewer *v) {
    static char labels[MASU_MAX_RUNGS][MASU_SETTING_ID + 8];
    const char *names[MASU_MAX_RUNGS];
    char id[MASU_SETTING_ID];
    uint32_t rung = v->rung;
    float target = v->want.governor.target_ms;
    bool governed = v->governed;
    for (uint32_t r = 0; r < v->want.rung_count; r++) {
        masu_viewer_setting(v, &v->want.rungs[r], id);
        snprintf(labels[r], sizeof labels[r], "%u: %s", r, id);
        names[r] = labels[r];
    }
    if (masu_ui_choice("Rung", &rung, names, v->want.rung_count))
        v->rung = rung, v->governed = false;
    if (v->want.governor.mode != MASU_GOVERNOR_OFF) {
        if (masu_ui_check("Governor selects the rung", &governed)) v->governed = governed;
        if (masu_ui_slider("Target", &target, 1.0f, 1000.0f, "%.2f ms", true))
            v->want.governor.target_ms = target;
        if (masu_ui_committed()) {
            v->changed = true;
            snprintf(v->change, sizeof v->change, "target %.2f ms",
                     (double)v->want.governor.target_ms);
        }
    }
    if (masu_ui_button("Keep as B")) masu_key_pressed(v, SDLK_b, 0);
    masu_ui_help("B is what F2 shows beside the current setting, and F3 compares it with.");
}

/* The value that 0 stands for: the scene's, or the resolved default with or without history. */
static double of_scene(const masu_viewer *v, const masu_knob *k) {
    uint32_t resolution, cascades = masu_scene_shadow_cascades(&v->scene, &resolution);
    if (!strcmp(k->name, "shadow_distance")) return (double)masu_scene_shadow_distance(&v->scene);
    if (!strcmp(k->name, "shadow_resolution")) return resolution;
    if (!strcmp(k->name, "shadow_cascades")) return cascades;
    if (!strcmp(k->name, "specular_cutoff")) return (double)masu_scene_specular_cutoff(&v->scene);
    masu_desc plain = {.rung_count = 1, .rungs = {{.temporal = v->want.rungs[v->rung].temporal}}};
    plain = masu_session_resolved(&plain);
    return masu_knob_get(k, &plain.rungs[0], 0);
}

static void put(masu_viewer *v, const masu_knob *k, uint32_t value, double to) {
    masu_rung *rung = &v->want.rungs[v->rung];
    char text[32];
    if (to == masu_knob_get(k, rung, value) || !masu_knob_accepts(k, to)) return;
    masu_knob_set(k, rung, value, to);
    masu_knob_text(k, rung, text, sizeof text);
    v->want.flips[v->rung] = 0.0f; /* it was measured for a different setting */
    v->governed = false;
    v->changed = true;
    snprintf(v->change, sizeof v->change, "%s=%s", k->name, text);
}

static void help(const masu_knob *k) {
    char range[200], text[1200];
    masu_knob_range(k, range, sizeof range);
    snprintf(text, sizeof text, "%s\n%s%s%s\n%s", k->text, range, *k->unit ? ", " : "", k->unit,
             k->cost);
    masu_ui_help(text);
}

/* A value is applied when the slider is released: recreating the renderer at each step would make
 * dragging too slow. */
static void number(masu_viewer *v, const masu_knob *k, uint32_t value, const char *label) {
    static const masu_knob *dragged;
    static uint32_t which;
    static float at;
    double now = masu_knob_get(k, &v->want.rungs[v->rung], value),
           shown = now == 0.0 ? of_scene(v, k) : now;
    bool whole = k->kind == MASU_KNOB_COUNT, wide = k->max - k->min > 300.0 && k->min >= 0.0;
    float to = dragged == k && which == value ? at : (float)shown;
    if (masu_ui_slider(label, &to, (float)k->min, (float)k->max, whole ? "%.0f" : "%.3g", wide)) {
        dragged = k, which = value;
        at = whole ? roundf(to) : to;
    }
    if (masu_ui_committed() && dragged == k && which == value) put(v, k, value, (double)at);
    help(k);
    if (dragged == k && which == value && !masu_ui_takes_keys()) dragged = NULL;
    if (now == 0.0 || now == k->zero) return;
    masu_ui_push(1);
    if (masu_ui_button("Default")) put(v, k, value, 0.0);
    masu_ui_pop();
}

static void word(masu_viewer *v, const masu_knob *k, const char *label) {
    const char *names[32];
    uint32_t chosen = (uint32_t)masu_knob_get(k, &v->want.rungs[v->rung], 0),
             count = k->word_count < 32 ? (uint32_t)k->word_count : 32;
    for (uint32_t i = 0; i < count; i++) names[i] = k->words[i].word;
    if (masu_ui_choice(label, &chosen, names, count)) put(v, k, 0, chosen);
    help(k);
}

void masu_panel_quality(masu_viewer *v) {
    char label[64];
    uint32_t id = 0;
    rungs(v);
    snprintf(label, sizeof label, "Knobs of rung %u", v->rung);
    masu_ui_text(MASU_INK_TITLE, "%s", label);
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        if (masu_knob_useless(k, &v->want.rungs[v->rung], &v->scene, &v->plan)) continue;
        for (uint32_t i = 0; i < k->values; i++) {
            if (k->values > 1)
                snprintf(label, sizeof label, "%s %u", k->name, i + 1);
            else
                snprintf(label, sizeof label, "%s", k->name);
            masu_ui_push(id++);
            if (k->kind == MASU_KNOB_WORD)
                word(v, k, label);
            else
                number(v, k, i, label);
            masu_ui_pop();
        }
    }
}
