/* panel_light.c: the panel "Light": sun, sky, fog, lamps, exposure and tone curve. */
#include "view/viewer.h"

#include "scene/blob_section.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

static void restart(masu_viewer *v, const char *what) {
    v->changed = true;
    snprintf(v->change, sizeof v->change, "%s", what);
}

/* An analytic sky; a scene without one gets it on request. */
static void sky(masu_viewer *v) {
    masu_view_look *l = &v->look;
    bool map = masu_scene_view_of(&v->scene).environment_map != NULL,
         analytic = l->light.turbidity > 0.0f;
    bool can =
        v->want.analytic_sky || (masu_scene_features(&v->scene) & MASU_SCENE_HAS_ANALYTIC_SKY);
    if (map) {
        if (!*v->baker.source) {
            masu_ui_text(
                MASU_INK_DIM,
                "The sky is an environment map. It is turned by baking: open the description of "
                "the scene instead of the baked file.");
            return;
        }
        masu_ui_slider("Environment turn", &v->baker.turn, -180.0f, 180.0f, "%.0f degrees", false);
        if (masu_ui_committed()) masu_baker_again(v);
        masu_ui_help(
            "Turns the environment map about the vertical axis, by baking the scene again.");
        return;
    }
    if (masu_ui_check("Sky from the sun", &analytic)) {
        if (analytic && !can) v->want.analytic_sky = 1, restart(v, "sky from the sun");
        l->light.turbidity = analytic ? l->from.turbidity > 0.0f ? l->from.turbidity : 3.0f : 0.0f;
        for (int c = 0; c < 3 && analytic; c++)
            if (l->from.turbidity == 0.0f) l->light.ground[c] = 0.2f;
    }
    if (!analytic) return;
    masu_ui_slider("Turbidity", &l->light.turbidity, 1.5f, 10.0f, "%.1f", false);
    masu_ui_help("Haze of the atmosphere: 1.5 is very clear, 10 is hazy.");
}

static void sun(masu_viewer *v) {
    masu_view_look *l = &v->look;
    bool moved = masu_ui_slider("Sun azimuth", &l->azimuth, -180.0f, 180.0f, "%.1f degrees", false);
    moved |= masu_ui_slider("Sun elevation", &l->elevation, -10.0f, 90.0f, "%.1f degrees", false);
    moved |= masu_ui_slider("Sun strength", &l->sun, 0.0f, 8.0f, "%.2f", true);
    masu_ui_help(
        "Factor on the sun of the scene. A sun that follows from the sky does not change.");
    if (moved) masu_look_light(v);
    sky(v);
    if (!(masu_scene_features(&v->scene) & MASU_SCENE_HAS_FOG)) return;
    masu_ui_slider("Fog density", &l->light.fog_density, 0.0f, 1.0f, "%.4f per metre", true);
    masu_ui_slider("Fog start", &l->light.fog_start, 0.0f, 1000.0f, "%.1f m", true);
}

static void exposure(masu_viewer *v) {
    static const char *const tones[] = {"auto (ACES)", "none", "ACES", "neutral"};
    bool metered = v->a.desc.exposure.metered == MASU_ON;
    if (v->a.desc.exposure.metered == MASU_AUTO)
        metered = (masu_scene_features(&v->scene) & MASU_SCENE_HAS_METERED_EXPOSURE) != 0;
    uint32_t tone = (uint32_t)v->want.tone;
    if (masu_ui_slider("Exposure", &v->look.stops, -8.0f, 8.0f, "%+.2f stops", false))
        masu_look_light(v);
    if (masu_ui_check("Auto-exposure", &metered)) {
        v->want.exposure.metered = metered ? MASU_ON : MASU_OFF;
        restart(v, metered ? "auto-exposure on" : "auto-exposure off");
    }
    if (masu_ui_choice("Tone curve", &tone, tones, 4)) {
        v->want.tone = (masu_tone)tone;
        restart(v, "tone curve");
    }
}

static void lamps(masu_viewer *v) {
    uint32_t count = masu_scene_count(&v->scene, MASU_SCENE_LIGHT);
    char label[300];
    if (!count || !masu_ui_section("Lamps", count <= 8)) return;
    for (uint32_t i = 0; i < count && i < MASU_LOOK_ITEMS; i++) {
        const char *name = masu_scene_name(&v->scene, MASU_SCENE_LIGHT, i);
        if (*name)
            snprintf(label, sizeof label, "%s", name);
        else
            snprintf(label, sizeof label, "lamp %u", i);
        masu_ui_push(i);
        masu_ui_slider(label, &v->look.lamps[i], 0.0f, 10.0f, "%.2f", true);
        masu_ui_pop();
    }
    if (count > MASU_LOOK_ITEMS) masu_ui_text(MASU_INK_DIM, "and %u more", count - MASU_LOOK_ITEMS);
}

void masu_panel_light(masu_viewer *v) {
    if (v->look.has_light) sun(v);
    exposure(v);
    lamps(v);
    if (!masu_ui_button("Light of the scene")) return;
    v->look.light = v->look.from;
    masu_view_look before = v->look;
    masu_look_reset(v);
    memcpy(v->look.params, before.params, sizeof before.params);
    memcpy(v->look.hidden, before.hidden, sizeof before.hidden);
    memcpy(v->look.clips, before.clips, sizeof before.clips);
}
