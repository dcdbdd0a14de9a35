/* settings.c: see settings.h. */
#include "bench/sweep/settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- Names ----------------------------------------------------------------------------------- */

/* AMD's own choice for its "quality" pictures, and that of the library's own rungs. */
static const masu_rung base_rung = {.scale = 1.0f, .sharpness = 0.2f};

/* Short: it is part of file names. */
static void knob_text(const masu_knob *k, const masu_rung *rung, char *out, size_t size) {
    const uint32_t *r = rung->shadow_refresh;
    switch (k->kind) {
    case MASU_KNOB_SCALAR: snprintf(out, size, "%.4g", masu_knob_scalar(k, rung)); break;
    case MASU_KNOB_NUMBER: snprintf(out, size, "%u", masu_knob_number(k, rung)); break;
    case MASU_KNOB_WORD:
        snprintf(out, size, "%s", k->words->words[masu_knob_number(k, rung)]);
        break;
    case MASU_KNOB_REFRESH: snprintf(out, size, "%u-%u-%u-%u", r[0], r[1], r[2], r[3]); break;
    }
}

uint32_t masu_setting_period(const masu_rung *rung) {
    uint32_t most = 1;
    for (uint32_t k = 0; k < MASU_MAX_CASCADES; k++) {
        if (rung->shadow_refresh[k] > most) most = rung->shadow_refresh[k];
    }
    return most;
}

void masu_setting_name(const masu_rung *rung, char out[MASU_SETTING_ID]) {
    size_t used = 0;
    snprintf(out, MASU_SETTING_ID, "base");
    for (uint32_t i = 0; i < MASU_KNOBS; i++) {
        char text[64];
        if (!masu_knob_differs(&masu_knobs[i], rung, &base_rung) || used >= MASU_SETTING_ID) continue;
        knob_text(&masu_knobs[i], rung, text, sizeof text);
        used += (size_t)snprintf(out + used, MASU_SETTING_ID - used, "%s%s=%s", used ? "+" : "",
                                 masu_knobs[i].name, text);
    }
}

/* ---- Names read ------------------------------------------------------------------------------- */

/* The knob whose name `text` begins with, up to its '='. */
static const masu_knob *knob_at(const char *text) {
    for (uint32_t i = 0; i < MASU_KNOBS; i++) {
        size_t n = strlen(masu_knobs[i].name);
        if (!strncmp(text, masu_knobs[i].name, n) && text[n] == '=') return &masu_knobs[i];
    }
    return NULL;
}

static const char *read_word(const char *text, const masu_knob *k, uint32_t *out) {
    size_t n = strcspn(text, "+");
    for (uint32_t i = 0; i < k->words->count; i++) {
        if (strlen(k->words->words[i]) != n || strncmp(k->words->words[i], text, n) != 0) continue;
        *out = i;
        return text + n;
    }
    return NULL;
}

/* strtoul takes signs and spaces as well. */
static const char *read_number(const char *text, uint32_t *out) {
    char *end;
    if (*text < '0' || *text > '9') return NULL;
    unsigned long value = strtoul(text, &end, 10);
    *out = (uint32_t)value;
    return value <= UINT32_MAX ? end : NULL;
}

/* A value's end, or NULL. "1e+09" is one number: a '+' ends a value only where a number does. */
static const char *read_value(const char *text, const masu_knob *k, masu_rung *rung) {
    uint32_t values[MASU_MAX_CASCADES] = {0};
    const char *end = text;
    char *after;
    float scalar;
    switch (k->kind) {
    case MASU_KNOB_SCALAR:
        scalar = strtof(text, &after);
        if (after == text || !isfinite(scalar) || !strchr("-.0123456789", *text)) return NULL;
        memcpy(values, &scalar, sizeof scalar);
        end = after;
        break;
    case MASU_KNOB_NUMBER: end = read_number(text, values); break;
    case MASU_KNOB_WORD: end = read_word(text, k, values); break;
    case MASU_KNOB_REFRESH:
        for (uint32_t i = 0; i < MASU_MAX_CASCADES && end; i++) {
            if (i && *end++ != '-') return NULL;
            end = read_number(end, &values[i]);
        }
        break;
    }
    if (end) memcpy((char *)rung + k->offset, values, masu_knob_bytes(k));
    return end;
}

bool masu_setting_parse(const char *text, masu_rung *out, char *error, size_t error_size) {
    uint64_t seen = 0;
    *out = base_rung;
    if (!strcmp(text, "base")) return true;
    for (const char *at = text;;) {
        const masu_knob *k = knob_at(at);
        const char *end = k ? read_value(at + strlen(k->name) + 1, k, out) : NULL;
        int n = (int)strcspn(at, "+");
        uint64_t bit = k ? 1ull << (k - masu_knobs) : 0;
        if (!end || (*end && *end != '+') || (seen & bit)) {
            snprintf(error, error_size, "setting '%.150s': '%.*s' %s", text, n < 60 ? n : 60, at,
                     !k           ? "is no knob with a value"
                     : seen & bit ? "comes twice"
                                  : "has no value of that knob");
            return false;
        }
        if (!*end) return true;
        seen |= bit;
        at = end + 1;
    }
}

/* ---- Settings -------------------------------------------------------------------------------- */

/* One knob, or a few that make one technique. Fields that are 0 are the base's; shadow_distance is
 * a part of the scene's. At which render sizes: the output's, half of it, and in `masu bench
 * --quick`. Bundles are at a few sizes, with SIXTEENTHS at all. */
enum { WHOLE = 1, HALF = 2, QUICK = 4, STRUCTURAL = 8, SAME = 16, SIXTEENTHS = 32 };

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
    {"fuse", HALF | STRUCTURAL, {.fuse = MASU_ON}},
    {"march_steps", WHOLE, {.march_steps = 32}},
    {"march_steps", WHOLE | HALF | QUICK, {.march_steps = 64}},
    {"march_steps", WHOLE, {.march_steps = 128}},
    {"march_steps", WHOLE, {.march_steps = 512}},
    {"march", WHOLE, {.march = MASU_MARCH_PLAIN}},
    {"march", WHOLE, {.march = MASU_MARCH_SEED}},
    {"march", WHOLE, {.march = MASU_MARCH_CONE8}},
    {"march", WHOLE, {.march = MASU_MARCH_CHECKERBOARD}},
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
};

/* What a port might choose together. The plain one, nothing but the base, is at every size. */
static const technique bundles[] = {
    {"full", 0, {.aa = MASU_AA_SMAA_HIGH}},
    /* What a mean over each pixel is, RCAS leads away from: most rungs are of this kind. */
    {"soft", SIXTEENTHS, {.sharpen = MASU_OFF}},
    {"soft aa", 0, {.sharpen = MASU_OFF, .aa = MASU_AA_SMAA_HIGH}},
    {"soft steps", 0, {.sharpen = MASU_OFF, .march_steps = 128}},
    /* Of a world, whose shadow map takes a part of the frame that a smaller picture does not make less. */
    {"soft cascades", 0, {.sharpen = MASU_OFF, .shadow_cascades = 2}},
    {"middle",
     0,
     {.aa = MASU_AA_FXAA,
      .ao_slices = 1,
      .ao_steps = 4,
      .specular_reuse_taps = 4,
      .specular_filter_taps = 6,
      EACH(1, 2, 4, 8)}},
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
    masu_rung rung = base_rung;
    static const masu_rung zero;
    for (uint32_t i = 0; i < MASU_KNOBS; i++) {
        if (masu_knob_differs(&masu_knobs[i], turned, &zero)) {
            masu_knob_copy(&masu_knobs[i], &rung, turned);
        }
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

uint32_t masu_settings_make(bool quick, masu_setting out[MASU_SETTINGS_MOST]) {
    static const float quick_scales[] = {1.0f, 0.75f, 0.5f, 0.4f};
    static const float bundle_scales[] = {1.0f, 0.875f, 0.75f, 0.625f, 0.5f, 0.4f};
    const technique base = {.name = "base"}, scale = {.name = "scale"};
    const masu_rung half = rung_of(&base.rung, 0.5f);
    list l = {out, 0};
    add(&l, &base, 1.0f, &base_rung);
    if (quick) {
        for (uint32_t i = 1; i < COUNT(quick_scales); i++)
            add(&l, &scale, quick_scales[i], &base_rung);
    } else {
        for (int i = 15; i >= 7; i--) add(&l, &scale, (float)i / 16.0f, &base_rung);
        add(&l, &scale, 0.4f, &base_rung);
    }
    for (size_t t = 0; t < COUNT(techniques); t++) {
        const technique *one = &techniques[t];
        if (quick && !(one->when & QUICK)) continue;
        if (one->when & WHOLE) add(&l, one, 1.0f, &base_rung);
        if (one->when & HALF) add(&l, one, 0.5f, &half);
    }
    for (size_t b = 0; b < COUNT(bundles); b++) {
        const technique *one = &bundles[b];
        if (quick && !(one->when & QUICK)) continue;
        const float *scales = quick ? quick_scales : bundle_scales;
        for (size_t i = 0; i < (quick ? COUNT(quick_scales) : COUNT(bundle_scales)); i++)
            add_bundle(&l, one, scales[i]);
        /* Those that are not eighths: bundle_scales has the others. */
        for (int i = 15; i >= 7 && one->when & SIXTEENTHS; i -= 2)
            add_bundle(&l, one, (float)i / 16.0f);
    }
    return l.count;
}

/* ---- What a scene has use for ---------------------------------------------------------------- */

static bool has_pass(const masu_plan_info *plan, const char *start) {
    for (uint32_t p = 0; p < plan->pass_count; p++) {
        if (plan->passes[p].active && !strncmp(plan->passes[p].name, start, strlen(start)))
            return true;
    }
    return false;
}

/* Why the knob has no effect, or NULL. */
static const char *useless(const masu_knob *k, const masu_rung *rung, const masu_scene *scene,
                           const masu_plan_info *base) {
    bool upscaled = rung->scale < 1.0f || rung->upscale == MASU_ON;
    bool by_default = upscaled && rung->easu != MASU_EASU_BILINEAR;
    bool sharpened = rung->sharpen == MASU_ON || (rung->sharpen == MASU_AUTO && by_default);
    switch (k->use) {
    case MASU_USE_SDF: return scene->sdf ? NULL : "the scene has no SDF";
    case MASU_USE_AO: return has_pass(base, "ao") ? NULL : "the scene asks for no ambient occlusion";
    case MASU_USE_SPECULAR: return has_pass(base, "specular_") ? NULL : "no reflections are traced";
    case MASU_USE_SHADOWS: return has_pass(base, "cascade_") ? NULL : "the scene has no shadow map";
    case MASU_USE_LODS: return scene->lods ? NULL : "the scene's meshes have no coarser forms";
    case MASU_USE_OCCLUDERS: return scene->placed_occluders ? NULL : "the scene has no occluders";
    case MASU_USE_POLYGONS: return scene->instances ? NULL : "the scene has no polygons";
    case MASU_USE_LIGHTS: return scene->lights ? NULL : "the scene has no local lights";
    case MASU_USE_UPSCALED: return upscaled ? NULL : "nothing is upscaled";
    case MASU_USE_SHARPEN: return by_default || rung->sharpen == MASU_ON ? NULL : "nothing is sharpened";
    case MASU_USE_SHARPENED: return sharpened ? NULL : "nothing is sharpened";
    default: return NULL;
    }
}

static void refit_parent(masu_setting *s, const masu_setting *all, uint32_t count,
                         char old[][MASU_SETTING_ID]) {
    for (uint32_t k = 0; k < count; k++) {
        if (strcmp(s->parent, old[k]) != 0) continue;
        memcpy(s->parent, all[k].id, sizeof s->parent);
        return;
    }
}

/* Values that only a scene can give a meaning. */
static void scene_values(masu_rung *rung, const masu_scene *scene, const char **why) {
    if (scene->shadow_distance > 0.0f) rung->shadow_distance *= scene->shadow_distance;
    if (rung->shadow_cascades && scene->shadow_cascades &&
        rung->shadow_cascades >= scene->shadow_cascades) {
        *why = "the scene has no more of them";
        rung->shadow_cascades = 0;
    }
    if (!(fabsf(rung->specular_cutoff - scene->specular_cutoff) > 1e-6f)) {
        if (rung->specular_cutoff > 0.0f) *why = "it is the scene's own";
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
        for (uint32_t k = 0; k < MASU_KNOBS; k++) {
            const char *no = useless(&masu_knobs[k], &s->rung, scene, base);
            if (!no || !masu_knob_differs(&masu_knobs[k], &s->rung, &base_rung)) continue;
            masu_knob_copy(&masu_knobs[k], &s->rung, &base_rung);
            why = why ? why : no;
        }
        char fitted[MASU_SETTING_ID];
        masu_setting_name(&s->rung, fitted);
        refit_parent(s, settings, i, old);
        for (uint32_t k = 0; k < i && !s->dropped[0]; k++) {
            if (strcmp(settings[k].id, fitted) != 0 || settings[k].dropped[0]) continue;
            snprintf(s->dropped, sizeof s->dropped, "%s", why ? why : "it is there already");
        }
        /* What is dropped keeps the name that says what it was to be. */
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
