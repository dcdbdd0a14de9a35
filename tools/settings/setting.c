/* setting.c: see setting.h. */
#include "settings/setting.h"

#include "scene/scene.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- Names ----------------------------------------------------------------------------------- */

/* AMD's sharpness for its "quality" mode, and that of the library's default rungs. */
const masu_rung masu_setting_base = {.scale = 1.0f, .sharpness = 0.2f};

uint32_t masu_setting_period(const masu_rung *rung) {
    uint32_t most = 1;
    for (uint32_t k = 0; k < MASU_MAX_CASCADES; k++) {
        if (rung->shadow_refresh[k] > most) most = rung->shadow_refresh[k];
    }
    return most;
}

bool masu_setting_remembers(const masu_rung *rung) { return rung->temporal == MASU_ON; }

void masu_setting_name(const masu_rung *rung, char out[MASU_SETTING_ID]) {
    size_t used = 0;
    snprintf(out, MASU_SETTING_ID, "base");
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        char text[64];
        if (!masu_knob_differs(k, rung, &masu_setting_base) || used >= MASU_SETTING_ID) continue;
        masu_knob_text(k, rung, text, sizeof text);
        used += (size_t)snprintf(out + used, MASU_SETTING_ID - used, "%s%s=%s", used ? "+" : "",
                                 k->name, text);
    }
}

/* ---- Parsing --------------------------------------------------------------------------------- */

static bool wrong(const char *name, char *error, size_t error_size, const char *format, ...) {
    char text[360];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    snprintf(error, error_size, "setting '%.150s': %s", name, text);
    return false;
}

#define ONE(...) +1
_Static_assert(0 MASU_KNOBS(ONE, ONE) <= 64, "a bit for each parsed knob");

/* A value ends after its number, which may contain a '+' ("1e+09"), or else at the next '+'. */
static bool read_part(const char *name, const char **at, masu_rung *rung, uint64_t *seen,
                      char *error, size_t error_size) {
    char range[200];
    size_t length = strcspn(*at, "=+");
    int part = (int)strcspn(*at, "+");
    if (part > 60) part = 60;
    const masu_knob *k = (*at)[length] == '=' ? masu_knob_find(*at, length) : NULL;
    if (!k)
        return wrong(name, error, error_size, "expected KNOB=VALUE with a known knob, found '%.*s'",
                     part, *at);
    uint64_t bit = 1ull << (k - masu_knob_table());
    if (*seen & bit)
        return wrong(name, error, error_size, "'%.*s': the knob is already set", part, *at);
    *seen |= bit;
    const char *value = *at + length + 1, *end = masu_knob_from_text(k, value, rung);
    if (!end || (*end && *end != '+')) {
        masu_knob_range(k, range, sizeof range);
        return wrong(name, error, error_size, "%s: expected %s, found '%.*s'", k->name, range,
                     part - (int)length - 1 > 0 ? part - (int)length - 1 : 0, value);
    }
    *at = end;
    return true;
}

bool masu_setting_parse(const char *name, masu_rung *out, char *error, size_t error_size) {
    uint64_t seen = 0;
    *out = masu_setting_base;
    if (!strcmp(name, "base")) return true;
    for (const char *at = name;; at++) {
        if (!read_part(name, &at, out, &seen, error, error_size)) return false;
        if (!*at) return true;
    }
}

/* ---- Knobs without effect in a scene --------------------------------------------------------- */

static bool has_pass(const masu_plan_info *plan, const char *start) {
    for (uint32_t p = 0; p < plan->pass_count; p++) {
        if (plan->passes[p].active && !strncmp(plan->passes[p].name, start, strlen(start)))
            return true;
    }
    return false;
}

const char *masu_knob_useless(const masu_knob *k, const masu_rung *rung, const masu_scene *scene,
                              const masu_plan_info *base) {
    bool upscaled = rung->scale < 1.0f || rung->upscale == MASU_ON;
    bool by_default = upscaled && rung->easu != MASU_EASU_BILINEAR;
    bool sharpened = rung->sharpen == MASU_ON || (rung->sharpen == MASU_AUTO && by_default);
    bool used = true;
    switch (k->use) {
    case MASU_USE_ALWAYS: return NULL;
    case MASU_USE_SDF: used = (masu_scene_features(scene) & MASU_SCENE_HAS_SDF); break;
    case MASU_USE_AO: used = has_pass(base, "ao"); break;
    case MASU_USE_SPECULAR: used = has_pass(base, "specular_"); break;
    case MASU_USE_BOUNCE: used = has_pass(base, "bounce_"); break;
    case MASU_USE_SHADOWS: used = has_pass(base, "cascade_"); break;
    case MASU_USE_LODS: used = masu_scene_data_of(scene)->lods; break;
    case MASU_USE_OCCLUDERS: used = masu_scene_data_of(scene)->placed_occluders; break;
    case MASU_USE_POLYGONS: used = masu_scene_count(scene, MASU_SCENE_INSTANCE); break;
    case MASU_USE_LOCAL_SHADOWS: used = masu_scene_data_of(scene)->shadow_lights; break;
    case MASU_USE_LIGHTS: used = masu_scene_count(scene, MASU_SCENE_LIGHT); break;
    case MASU_USE_UPSCALED: used = upscaled; break;
    case MASU_USE_SHARPEN: used = by_default || rung->sharpen == MASU_ON; break;
    case MASU_USE_SHARPENED: used = sharpened; break;
    }
    return used ? NULL : k->missing;
}
