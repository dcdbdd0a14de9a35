/* settings.c: see settings.h. */
#include "bench/settings.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- Settings -------------------------------------------------------------------------------- */

/* One knob, or several that form one technique. Fields that are 0 have the value of the base;
 * shadow_distance is a factor of the scene's. WHOLE, HALF: measured at the output size, at half of
 * it; QUICK: also by `masu bench --quick`. Bundles are measured at a few sizes, with SIXTEENTHS at
 * all sizes down to 0.4, with SMALL at a few smaller ones. */
enum { WHOLE = 1, HALF = 2, QUICK = 4, STRUCTURAL = 8, SAME = 16, SIXTEENTHS = 32, SMALL = 64 };

typedef struct technique {
    const char *name;
    uint32_t when;
    masu_rung rung;
} technique;

#define EACH(a, b, c, d) .shadow_refresh = {a, b, c, d}
static const technique techniques[] = {
    {"aa", WHOLE | HALF | QUICK | STRUCTURAL, {.aa = MASU_AA_FXAA}},
    {"aa", WHOLE | HALF | STRUCTURAL, {.aa = MASU_AA_SMAA_LOW}},
    {"aa", WHOLE | STRUCTURAL, {.aa = MASU_AA_SMAA_MEDIUM}},
    {"aa", WHOLE | HALF | STRUCTURAL, {.aa = MASU_AA_SMAA_HIGH}},
    {"aa", WHOLE | STRUCTURAL, {.aa = MASU_AA_SMAA_ULTRA}},
    {"sharpen", WHOLE | STRUCTURAL, {.sharpen = MASU_ON}},
    {"sharpen", HALF | QUICK | STRUCTURAL, {.sharpen = MASU_OFF}},
    {"sharpness", HALF, {.sharpness = 1.0f}},
    {"sharpness", HALF, {.sharpness = 2.0f}},
    {"easu", HALF | QUICK | STRUCTURAL, {.easu = MASU_EASU_FAST}},
    {"easu", HALF | STRUCTURAL, {.easu = MASU_EASU_BILINEAR}},
    {"silhouettes", WHOLE | HALF | STRUCTURAL, {.silhouettes = MASU_ON}},
    {"march_steps", WHOLE, {.march_steps = 32}},
    {"march_steps", WHOLE | HALF | QUICK, {.march_steps = 64}},
    {"march_steps", WHOLE, {.march_steps = 128}},
    {"march_steps", WHOLE, {.march_steps = 512}},
#ifdef MASU_LAB
    {"march", WHOLE, {.march = MASU_MARCH_PLAIN}},
    {"march", WHOLE, {.march = MASU_MARCH_SEED}},
    {"march", WHOLE, {.march = MASU_MARCH_CHECKERBOARD}},
#endif
    {"ao", WHOLE | HALF | QUICK | STRUCTURAL, {.ao = MASU_OFF}},
    {"ao samples", WHOLE, {.ao_slices = 1, .ao_steps = 4}},
    {"ao samples", WHOLE | HALF, {.ao_slices = 1}},
    {"ao samples", WHOLE, {.ao_steps = 4}},
    {"ao samples", WHOLE, {.ao_slices = 4}},
    {"specular", WHOLE | HALF | QUICK | STRUCTURAL, {.specular = MASU_OFF}},
    {"specular_reuse", WHOLE | STRUCTURAL, {.specular_reuse = MASU_OFF}},
    {"specular_temporal", WHOLE | STRUCTURAL, {.specular_temporal = MASU_OFF}},
    {"specular_fine", WHOLE | STRUCTURAL, {.specular_fine = MASU_OFF}},
    {"specular_filter", WHOLE | STRUCTURAL, {.specular_filter = MASU_OFF}},
    {"specular_taa", WHOLE | STRUCTURAL, {.specular_taa = MASU_OFF}},
    {"specular taps", WHOLE, {.specular_reuse_taps = 4}},
    {"specular taps", WHOLE, {.specular_filter_taps = 6}},
    {"specular taps", WHOLE, {.specular_reuse_taps = 16, .specular_filter_taps = 24}},
    {"specular_cutoff", WHOLE, {.specular_cutoff = 0.25f}},
    {"specular_cutoff", WHOLE, {.specular_cutoff = 0.5f}},
    {"specular_frames", WHOLE, {.specular_frames = 16}},
    {"specular_frames", WHOLE, {.specular_frames = 64}},
    {"bounce", WHOLE | STRUCTURAL, {.bounce = MASU_OFF}},
    {"bounce_probes", WHOLE, {.bounce_probes = 47}},
    {"bounce_rays", WHOLE, {.bounce_rays = 24}},
    {"shadow_refresh", WHOLE | HALF | QUICK, {EACH(1, 2, 4, 8)}},
    {"shadow_refresh", WHOLE, {EACH(4, 4, 4, 4)}},
    {"shadow_resolution", WHOLE | STRUCTURAL, {.shadow_resolution = 512}},
    {"shadow_cascades", WHOLE | STRUCTURAL, {.shadow_cascades = 2}},
    {"shadow_distance", WHOLE, {.shadow_distance = 0.5f}},
    {"lod_error", WHOLE, {.lod_error = -1.0f}},
    {"lod_error", WHOLE, {.lod_error = 3.0f}},
    {"frustum", WHOLE | SAME, {.frustum = MASU_OFF}},
    {"occlusion", WHOLE | STRUCTURAL | SAME, {.occlusion = MASU_OFF}},
    {"light_tiles", WHOLE | STRUCTURAL | SAME, {.light_tiles = MASU_OFF}},
    {"local_shadows", WHOLE | STRUCTURAL, {.local_shadows = MASU_OFF}},
    {"local_shadow_lights", WHOLE, {.local_shadow_lights = 4}},
    {"local_shadow_atlas", WHOLE | STRUCTURAL, {.local_shadow_atlas = 1024}},
    {"local_shadow_faces", WHOLE, {.local_shadow_faces = 1}},
    {"upscale", 0, {.upscale = MASU_ON}}, /* no gain at full size; always on below */
    {"temporal", WHOLE | HALF | QUICK | STRUCTURAL, {.temporal = MASU_ON}},
};

/* Combinations that a port might choose. The base itself is measured at every size. */
static const technique bundles[] = {
    {"full", 0, {.aa = MASU_AA_SMAA_HIGH}},
    {"temporal", SMALL, {.temporal = MASU_ON}},
    /* RCAS increases the difference from a box-filtered image: most rungs are without it. */
    {"soft", SIXTEENTHS, {.sharpen = MASU_OFF}},
    {"soft aa", 0, {.sharpen = MASU_OFF, .aa = MASU_AA_SMAA_HIGH}},
    {"soft steps", 0, {.sharpen = MASU_OFF, .march_steps = 128}},
    /* For worlds, whose shadow maps cost the same at every render size. */
    {"soft cascades", 0, {.sharpen = MASU_OFF, .shadow_cascades = 2}},
    /* Less of every feature, none disabled: for scales at which a smaller image hardly saves
     * time. */
    {"lean",
     SMALL,
     {.temporal = MASU_ON,
      .march_steps = 128,
      .lod_error = 2.0f,
      .ao_slices = 1,
      .ao_steps = 4,
      .specular_reuse_taps = 4,
      .specular_filter_taps = 6,
      EACH(2, 4, 8, 8)}},
    {"cheap",
     QUICK,
     {.easu = MASU_EASU_FAST,
      .sharpen = MASU_OFF,
      .march_steps = 128,
      .lod_error = 2.0f,
      .ao = MASU_OFF,
      .specular = MASU_OFF,
      EACH(2, 4, 8, 8)}},
};

typedef struct list {
    masu_setting *out;
    uint32_t count;
} list;

/* The knobs of `turned` that are not 0 on top of the base at that scale. */
static masu_rung rung_of(const masu_rung *turned, float scale) {
    masu_rung rung = masu_setting_base;
    static const masu_rung zero;
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        if (masu_knob_differs(k, turned, &zero)) masu_knob_copy(k, &rung, turned);
    }
    rung.scale = scale;
    return rung;
}

static void add(list *l, const technique *t, float scale, const masu_rung *parent) {
    if (l->count == MASU_SETTINGS_MOST) return;
    masu_setting *s = &l->out[l->count++];
    memset(s, 0, sizeof *s);
    s->rung = rung_of(&t->rung, scale);
    s->structural = (t->when & STRUCTURAL) != 0;
    s->same_picture = (t->when & SAME) != 0;
    snprintf(s->technique, sizeof s->technique, "%s", t->name);
    masu_setting_name(&s->rung, s->id);
    masu_setting_name(parent, s->parent);
}

static void add_bundle(list *l, const technique *t, float scale) {
    const technique base = {.name = "base"};
    const masu_rung plain = rung_of(&base.rung, scale);
    add(l, t, scale, &plain);
}

static bool is_turned(const masu_knob *k) {
    static const masu_rung zero;
    for (size_t t = 0; t < COUNT(techniques); t++) {
        if (masu_knob_differs(k, &techniques[t].rung, &zero)) return true;
    }
    return !strcmp(k->name, "scale");
}

/* A knob of no technique: each of its names, or half of and all of the way to its maximum. */
static void add_knob(list *l, const masu_knob *k) {
    technique one = {.name = k->name};
    double from = masu_knob_get(k, &masu_setting_base, 0);
    for (uint32_t n = 1; n <= (k->words ? k->word_count - 1 : 2); n++) {
        double value = k->words ? (double)n : from + (k->max - from) * n / 2.0;
        for (uint32_t i = 0; i < k->values; i++) masu_knob_set(k, &one.rung, i, value);
        add(l, &one, 1.0f, &masu_setting_base);
    }
}

uint32_t masu_settings_make(bool quick, masu_setting out[MASU_SETTINGS_MOST]) {
    static const float quick_scales[] = {1.0f, 0.75f, 0.5f, 0.4f};
    static const float bundle_scales[] = {1.0f, 0.875f, 0.75f, 0.625f, 0.5f, 0.4f};
    static const float small_scales[] = {0.35f, 0.3f, 0.28f, 0.25f, 0.22f, 0.2f};
    const technique base = {.name = "base"}, scale = {.name = "scale"};
    const masu_rung half = rung_of(&base.rung, 0.5f);
    list l = {out, 0};
    add(&l, &base, 1.0f, &masu_setting_base);
    if (quick) {
        for (uint32_t i = 1; i < COUNT(quick_scales); i++)
            add(&l, &scale, quick_scales[i], &masu_setting_base);
    } else {
        for (int i = 15; i >= 7; i--) add(&l, &scale, (float)i / 16.0f, &masu_setting_base);
        add(&l, &scale, 0.4f, &masu_setting_base);
        for (size_t i = 0; i < COUNT(small_scales); i++)
            add(&l, &scale, small_scales[i], &masu_setting_base);
    }
    for (size_t t = 0; t < COUNT(techniques); t++) {
        const technique *one = &techniques[t];
        if (quick && !(one->when & QUICK)) continue;
        if (one->when & WHOLE) add(&l, one, 1.0f, &masu_setting_base);
        if (one->when & HALF) add(&l, one, 0.5f, &half);
    }
    for (const masu_knob *k = masu_knob_table(); k->name && !quick; k++) {
        if (!is_turned(k)) add_knob(&l, k);
    }
    for (size_t b = 0; b < COUNT(bundles); b++) {
        const technique *one = &bundles[b];
        if (quick && !(one->when & QUICK)) continue;
        const float *scales = quick ? quick_scales : bundle_scales;
        for (size_t i = 0; i < (quick ? COUNT(quick_scales) : COUNT(bundle_scales)); i++)
            add_bundle(&l, one, scales[i]);
        /* Sizes that are not eighths: bundle_scales has the eighths. */
        for (int i = 15; i >= 7 && one->when & SIXTEENTHS; i -= 2)
            add_bundle(&l, one, (float)i / 16.0f);
        for (size_t i = 0; i < COUNT(small_scales) && one->when & SMALL && !quick; i++)
            add_bundle(&l, one, small_scales[i]);
    }
    return l.count;
}

/* ---- Settings of one scene ------------------------------------------------------------------- */

static void refit_parent(masu_setting *s, const masu_setting *all, uint32_t count,
                         char old[][MASU_SETTING_ID]) {
    for (uint32_t k = 0; k < count; k++) {
        if (strcmp(s->parent, old[k]) != 0) continue;
        memcpy(s->parent, all[k].id, sizeof s->parent);
        return;
    }
}

/* Resolves values that depend on the scene. */
static void scene_values(masu_rung *rung, const masu_scene *scene, const char **why) {
    if (masu_scene_shadow_distance(scene) > 0.0f)
        rung->shadow_distance *= masu_scene_shadow_distance(scene);
    if (rung->shadow_cascades && masu_scene_shadow_cascades(scene, NULL) &&
        rung->shadow_cascades >= masu_scene_shadow_cascades(scene, NULL)) {
        *why = "the scene does not have more";
        rung->shadow_cascades = 0;
    }
    if (!(fabsf(rung->specular_cutoff - masu_scene_specular_cutoff(scene)) > 1e-6f)) {
        if (rung->specular_cutoff > 0.0f) *why = "equal to the scene's value";
        rung->specular_cutoff = 0.0f;
    }
}

void masu_settings_fit(masu_setting *settings, uint32_t count, const masu_scene *scene,
                       const masu_plan_info *base) {
    static char old[MASU_SETTINGS_MOST][MASU_SETTING_ID];
    for (uint32_t i = 0; i < count; i++) {
        masu_setting *s = &settings[i];
        const char *why = NULL;
        memcpy(old[i], s->id, sizeof old[i]);
        scene_values(&s->rung, scene, &why);
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            const char *no = masu_knob_useless(k, &s->rung, scene, base);
            if (!no || !masu_knob_differs(k, &s->rung, &masu_setting_base)) continue;
            masu_knob_copy(k, &s->rung, &masu_setting_base);
            why = why ? why : no;
        }
        char fitted[MASU_SETTING_ID];
        masu_setting_name(&s->rung, fitted);
        refit_parent(s, settings, i, old);
        for (uint32_t k = 0; k < i && !s->dropped[0]; k++) {
            if (strcmp(settings[k].id, fitted) != 0 || settings[k].dropped[0]) continue;
            snprintf(s->dropped, sizeof s->dropped, "%s", why ? why : "equal to another setting");
        }
        /* A dropped setting keeps its original name. */
        if (!s->dropped[0]) memcpy(s->id, fitted, sizeof s->id);
    }
}

bool masu_settings_same_plan(const masu_plan_info *a, const masu_plan_info *b) {
    bool same = a->pass_count == b->pass_count &&
                a->memory.device_bytes == b->memory.device_bytes &&
                a->rungs[0].render_width == b->rungs[0].render_width &&
                a->rungs[0].render_height == b->rungs[0].render_height &&
                a->rungs[0].dispatches == b->rungs[0].dispatches;
    for (uint32_t p = 0; p < a->pass_count && same; p++)
        same = a->passes[p].active == b->passes[p].active;
    return same;
}
