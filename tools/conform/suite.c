/* suite.c: see suite.h. */
#include "conform/suite.h"

#include "settings/knobs.h"
#include "cli/cli.h"
#include "conform/read.h"

#include <fnmatch.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CASES_MOST 4096u
#define NAME_MOST 120u

/* ---- Verdicts -------------------------------------------------------------------------------- */

static const struct {
    const char *name, *group;
    bool more_is_better;
} measures[MASU_MEASURE_COUNT] = {
#define MASU_MEASURE_ROW(name, key, group, more) {#key, group, more},
    MASU_MEASURES(MASU_MEASURE_ROW)
#undef MASU_MEASURE_ROW
};

const char *masu_verdict_name(masu_verdict verdict) {
    static const char *const names[MASU_VERDICT_COUNT] = {
        "pass", "quality warning", "not supported", "resource error", "fail", "not run"};
    return verdict < MASU_VERDICT_COUNT ? names[verdict] : "?";
}

bool masu_verdict_failed(masu_verdict verdict) {
    return verdict >= MASU_VERDICT_RESOURCE;
}

const char *masu_measure_name(masu_measure measure) { return measures[measure].name; }

bool masu_measure_counted(masu_measure measure) {
    return !strcmp(measures[measure].group, "counts");
}

bool masu_measure_more(masu_measure measure) { return measures[measure].more_is_better; }

bool masu_bound_is_set(const masu_bound *bound) {
    return !isnan(bound->warn) || !isnan(bound->fail);
}

/* Written so that NaN exceeds every limit. */
static bool beyond(double value, double limit, bool least) {
    return !isnan(limit) && !(least ? value >= limit : value <= limit);
}

masu_verdict masu_bound_judge(const masu_bound *bound, double value, bool least) {
    if (beyond(value, bound->fail, least)) return MASU_VERDICT_FAIL;
    return beyond(value, bound->warn, least) ? MASU_VERDICT_WARNING : MASU_VERDICT_PASS;
}

/* ---- Rungs ----------------------------------------------------------------------------------- */

static bool read_rung(const masu_suite_place *at, const json_t *value, masu_rung *rung) {
    const char *key;
    json_t *member;
    if (!masu_suite_object(at, "rung", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        char name[80], error[300];
        const masu_knob *k = masu_knob_find(key, strlen(key));
        if (!k) return masu_suite_unknown(at, "rung", key);
        snprintf(name, sizeof name, "rung.%s", key);
        if (!masu_knob_from_json(k, member, rung, error, sizeof error))
            return masu_suite_wrong(at, name, "%s", error);
    }
    return true;
}

static bool read_ladder(const masu_suite_place *at, const json_t *value, masu_case *c) {
    size_t n = json_array_size(value);
    c->measured = json_is_string(value) && !strcmp(json_string_value(value), "auto");
    if (c->measured) return true;
    if (!json_is_array(value) || !n || n > MASU_MAX_RUNGS) {
        return masu_suite_wrong(at, "ladder",
                                "expected 'auto' or an array of 1 to %u rungs, found %zu",
                                MASU_MAX_RUNGS, n);
    }
    memset(c->rungs, 0, sizeof c->rungs);
    for (size_t i = 0; i < n; i++) {
        if (!read_rung(at, json_array_get(value, i), &c->rungs[i])) return false;
    }
    c->rung_count = (uint32_t)n;
    return true;
}

/* ---- Groups of limits ------------------------------------------------------------------------ */

/* A number is the `fail` limit; an object has `warn` and `fail`. */
static bool read_bound(const masu_suite_place *at, const char *name, const json_t *value,
                       bool least, masu_bound *bound) {
    const char *key;
    json_t *member;
    *bound = (masu_bound){MASU_UNKNOWN, MASU_UNKNOWN};
    if (!json_is_object(value))
        return masu_suite_number(at, name, value, 0.0, 1e18, false, &bound->fail);
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        char text[200];
        snprintf(text, sizeof text, "%.160s.%.20s", name, key);
        bool warn = !strcmp(key, "warn");
        if (!warn && strcmp(key, "fail")) return masu_suite_wrong(at, text, "unknown key");
        if (!masu_suite_number(at, text, member, 0.0, 1e18, false,
                               warn ? &bound->warn : &bound->fail))
            return false;
    }
    if (!masu_bound_is_set(bound))
        return masu_suite_wrong(at, name, "expected warn, fail, or both");
    if (isnan(bound->warn) || isnan(bound->fail) ||
        (least ? bound->warn >= bound->fail : bound->warn <= bound->fail)) {
        return true;
    }
    return masu_suite_wrong(at, name, "warn is %.10g, beyond fail, which is %.10g", bound->warn,
                            bound->fail);
}

static bool read_measure(const masu_suite_place *at, const char *group, const char *key,
                         const json_t *value, masu_case *c) {
    bool least = !strcmp(group, "at_least");
    char name[160];
    snprintf(name, sizeof name, "%s.%.100s", group, key);
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
        if (strcmp(measures[m].name, key) || strcmp(measures[m].group, least ? "counts" : group))
            continue;
        bool more = least || measures[m].more_is_better;
        return read_bound(at, name, value, more, least ? &c->least[m] : &c->bounds[m]);
    }
    return masu_suite_unknown(at, group, key);
}

static bool read_measures(const masu_suite_place *at, const char *group, const json_t *value,
                          masu_case *c) {
    const char *key;
    json_t *member;
    if (!masu_suite_object(at, group, value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        if (!read_measure(at, group, key, member, c)) return false;
    }
    return true;
}

static bool read_error(const masu_suite_place *at, const json_t *value, masu_case *c) {
    const char *key;
    json_t *member;
    if (!masu_suite_object(at, "error", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        bool good = !strcmp(key, "against")
                        ? masu_suite_string(at, "error.against", member, &c->against)
                    : !strcmp(key, "golden")
                        ? masu_suite_string(at, "error.golden", member, &c->golden)
                    : !strcmp(key, "positions")
                        ? masu_suite_count(at, "error.positions", member, 1, 4096, &c->positions)
                    : !strcmp(key, "rays")
                        ? masu_suite_count(at, "error.rays", member, 1, 1000000, &c->rays)
                        : read_measure(at, "error", key, member, c);
        if (!good) return false;
    }
    return true;
}

static bool read_pair(const masu_suite_place *at, const char *key, const json_t *value,
                      uint32_t low, uint32_t high, uint32_t *a, uint32_t *b) {
    char text[80];
    if (!json_is_array(value) || json_array_size(value) != 2) {
        return masu_suite_wrong(at, key, "expected an array of two numbers, found %s",
                                masu_json_given(value, text, sizeof text));
    }
    return masu_suite_count(at, key, json_array_get(value, 0), low, high, a) &&
           masu_suite_count(at, key, json_array_get(value, 1), low, high, b);
}

static bool read_settles(const masu_suite_place *at, const json_t *value, masu_governed *g) {
    uint32_t low = 0, high = 0;
    if (!read_pair(at, "governed.settles", value, 0, MASU_MAX_RUNGS - 1, &low, &high)) return false;
    if (low > high) {
        return masu_suite_wrong(at, "governed.settles",
                                "expected the lower rung first, found %u and %u", low, high);
    }
    g->settles[0] = (int32_t)low;
    g->settles[1] = (int32_t)high;
    return true;
}

static bool read_told(const masu_suite_place *at, const json_t *value, masu_governed *g) {
    const char *key;
    json_t *member;
    g->told = true;
    if (!masu_suite_object(at, "governed.told", value)) return false;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        double *out = !strcmp(key, "fixed_ms")  ? &g->fixed_ms
                      : !strcmp(key, "load_ms") ? &g->load_ms
                                                : NULL;
        if (!out) return masu_suite_unknown(at, "governed.told", key);
        if (!masu_suite_number(at, "governed.told", member, 0.0, 1e4, false, out)) return false;
    }
    return true;
}

static bool read_governed(const masu_suite_place *at, const json_t *value, masu_case *c) {
    const char *key;
    json_t *member;
    masu_governed *g = &c->governed;
    if (!masu_suite_object(at, "governed", value)) return false;
    *g = (masu_governed){.on = true, .frames = 60, .settles = {-1, -1}};
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        bool good;
        if (!strcmp(key, "target_ms")) {
            good =
                masu_suite_number(at, "governed.target_ms", member, 1, 1000, false, &g->target_ms);
        } else if (!strcmp(key, "frames")) {
            good = masu_suite_count(at, "governed.frames", member, 1, 100000, &g->frames);
        } else if (!strcmp(key, "best_rung")) {
            good =
                masu_suite_count(at, "governed.best_rung", member, 0, MASU_MAX_RUNGS - 1, &g->best);
        } else if (!strcmp(key, "worst_rung")) {
            good = masu_suite_count(at, "governed.worst_rung", member, 0, MASU_MAX_RUNGS - 1,
                                    &g->worst);
        } else if (!strcmp(key, "settles")) {
            good = read_settles(at, member, g);
        } else if (!strcmp(key, "told")) {
            good = read_told(at, member, g);
        } else {
            good = read_measure(at, "governed", key, member, c);
        }
        if (!good) return false;
    }
    return json_object_get(value, "target_ms") ||
           masu_suite_wrong(at, "governed.target_ms",
                            "expected a number from 1 to 1000, found nothing");
}

/* ---- Cases ----------------------------------------------------------------------------------- */

static bool read_key(const masu_suite_place *at, const char *key, const json_t *value,
                     masu_case *c) {
    static const char *const same[] = MASU_SAME_NAMES, *const needs[] = MASU_NEEDS_NAMES;
    if (!strcmp(key, "name") || !strcmp(key, "sizes")) return true; /* read by the caller */
    if (!strcmp(key, "scene")) return masu_suite_string(at, key, value, &c->scene);
    if (!strcmp(key, "size")) return read_pair(at, key, value, 1, 16384, &c->width, &c->height);
    if (!strcmp(key, "time")) return masu_suite_number(at, key, value, -1e9, 1e9, false, &c->time);
    if (!strcmp(key, "move")) return masu_suite_number(at, key, value, 0.0, 1e6, false, &c->move);
    if (!strcmp(key, "frames")) return masu_suite_count(at, key, value, 1, 100000, &c->frames);
    if (!strcmp(key, "flight"))
        return masu_suite_count(at, key, value, 1, MASU_MAX_FLIGHT, &c->flight);
    if (!strcmp(key, "validate")) return masu_suite_flag(at, key, value, &c->validate);
    if (!strcmp(key, "exact_memory")) return masu_suite_flag(at, key, value, &c->exact_memory);
    if (!strcmp(key, "same")) return masu_suite_names(at, key, value, same, &c->same);
    if (!strcmp(key, "needs")) return masu_suite_names(at, key, value, needs, &c->needs);
    if (!strcmp(key, "rung")) {
        memset(c->rungs, 0, sizeof c->rungs);
        c->rung_count = 1;
        c->measured = false;
        return read_rung(at, value, &c->rungs[0]);
    }
    if (!strcmp(key, "ladder")) return read_ladder(at, value, c);
    if (!strcmp(key, "governed")) return read_governed(at, value, c);
    if (!strcmp(key, "error")) return read_error(at, value, c);
    if (!strcmp(key, "input")) return masu_suite_string(at, key, value, &c->extreme.input);
    if (!strcmp(key, "extreme")) return masu_extreme_read(at, value, &c->extreme);
    if (!strcmp(key, "budget") || !strcmp(key, "counts") || !strcmp(key, "at_least") ||
        !strcmp(key, "field"))
        return read_measures(at, key, value, c);
    return masu_suite_wrong(at, key, "unknown key");
}

static bool read_keys(const masu_suite_place *at, const json_t *value, masu_case *c) {
    const char *key;
    json_t *member;
    json_object_foreach((json_t *)(uintptr_t)value, key, member) {
        if (!read_key(at, key, member, c)) return false;
    }
    return true;
}

bool masu_case_field(const masu_case *c) {
    for (int m = MASU_MEASURE_HITMISS_PCT; m <= MASU_MEASURE_DEPTH_P99; m++) {
        if (masu_bound_is_set(&c->bounds[m])) return true;
    }
    return false;
}

static bool check_extreme(const masu_suite_place *at, const masu_case *c) {
    const masu_extreme *x = &c->extreme;
    if (c->governed.on && (x->given || masu_bound_is_set(&c->bounds[MASU_MEASURE_NON_FINITE])))
        return masu_suite_wrong(at, "extreme", "cannot be combined with 'governed'");
    if (x->cycle && c->rung_count < 2)
        return masu_suite_wrong(at, "extreme.cycle", "expected a ladder of two rungs or more");
    if (x->has_other && !x->has_camera)
        return masu_suite_wrong(at, "extreme.other_camera", "expected a 'camera' as well");
    if (masu_case_field(c) && (!x->has_camera || x->cycle || c->rungs[0].scale > 0.0f))
        return masu_suite_wrong(at, "field", "expected extreme.camera and one rung of scale 1");
    if (c->against && !strcmp(c->against, "truth") && (x->has_transform || x->has_material))
        return masu_suite_wrong(at, "error.against",
                                "a changed transform or material has no ground truth");
    if (masu_case_field(c) && c->move > 0)
        return masu_suite_wrong(at, "field", "expected a case without 'move'");
    return true;
}

bool masu_case_linear(const masu_case *c) {
    const char *end = c->golden ? strrchr(c->golden, '.') : NULL;
    return end && (!strcmp(end, ".ref") || !strcmp(end, ".pfm") || !strcmp(end, ".exr"));
}

/* Linear light uses patch measures, 8-bit images the other ones. */
static bool check_golden(const masu_suite_place *at, const masu_case *c) {
    const bool reference = c->against && !strcmp(c->against, "reference"),
               linear = masu_case_linear(c);
    const char *end = c->golden ? strrchr(c->golden, '.') : NULL;
    if (reference != (c->golden != NULL))
        return masu_suite_wrong(
            at, "error.golden",
            "expected 'against': 'reference' with a file, found one of the two");
    if (c->golden && !linear && (!end || strcmp(end, ".png") != 0))
        return masu_suite_wrong(at, "error.golden",
                                "expected a file .ref, .pfm, .exr or .png, found '%.60s'",
                                c->golden);
    for (int m = MASU_MEASURE_RMSE; m <= MASU_MEASURE_PATCH_Z2; m++) {
        if (masu_bound_is_set(&c->bounds[m]) && (m >= MASU_MEASURE_MEAN_OFF) != linear)
            return masu_suite_wrong(at, "error", "%s needs %s", masu_measure_name((masu_measure)m),
                                    linear ? "an image of 8 bits"
                                           : "a golden file of linear light");
    }
    return true;
}

/* Checks combinations of keys. */
static bool check_case(const masu_suite_place *at, masu_case *c) {
    bool compares = false;
    for (int m = MASU_MEASURE_RMSE; m <= MASU_MEASURE_PATCH_Z2; m++)
        compares = compares || masu_bound_is_set(&c->bounds[m]);
    if (!c->scene)
        return masu_suite_wrong(at, "scene", "expected the name of a scene, found nothing");
    if (strstr(c->scene, "..") || c->scene[0] == '/')
        return masu_suite_wrong(
            at, "scene", "expected a name in the folder of scenes, found '%s'", c->scene);
    if (!c->width)
        return masu_suite_wrong(at, "size", "expected width and height, found nothing");
    if (compares != (c->against != NULL)) {
        return masu_suite_wrong(
            at, compares ? "error.against" : "error",
            compares ? "expected 'truth', 'reference' or the name of a case, found nothing"
                     : "expected a limit with 'against', found none");
    }
    if (!check_extreme(at, c) || !check_golden(at, c)) return false;
    masu_governed *g = &c->governed;
    if (!g->on && (c->measured || (c->rung_count > 1 && !c->extreme.cycle)))
        return masu_suite_wrong(at, "ladder",
                                "expected 'governed', which chooses its rungs");
    if (!g->on) return true;
    if (c->against || c->same || masu_bound_is_set(&c->bounds[MASU_MEASURE_MS_RATIO])) {
        return masu_suite_wrong(at, "governed",
                                "cannot be combined with error, same and ms_ratio, which need an "
                                "image of one rung");
    }
    if (c->measured) { /* its length depends on the scene */
        memset(c->rungs, 0, sizeof c->rungs);
        c->rung_count = 0;
        if (g->worst && g->best > g->worst) {
            return masu_suite_wrong(at, "governed.worst_rung", "expected %u to %u, found %u",
                                    g->best, MASU_MAX_RUNGS - 1, g->worst);
        }
        return true;
    }
    if (c->rung_count ==
        1) { /* eight rungs from scale 1 to 0.4, as in masu render --target-ms --ladder off */
        masu_rung first = c->rungs[0];
        c->rung_count = 8;
        for (uint32_t r = 0; r < c->rung_count; r++) {
            c->rungs[r] = first;
            c->rungs[r].scale = (float)pow(0.4, r / (double)(c->rung_count - 1));
        }
    }
    if (!g->worst) g->worst = c->rung_count - 1;
    if (g->worst >= c->rung_count || g->best > g->worst) {
        return masu_suite_wrong(at, "governed.worst_rung", "expected %u to %u, found %u",
                                g->best, c->rung_count - 1, g->worst);
    }
    return true;
}

static bool append(const masu_suite_place *at, const masu_case *c) {
    masu_suite *s = at->suite;
    char size[40];
    for (uint32_t i = 0; i < s->count; i++) {
        const masu_case *o = &s->cases[i];
        if (strcmp(o->name, c->name) || o->width != c->width || o->height != c->height) continue;
        snprintf(size, sizeof size, "%ux%u", c->width, c->height);
        return masu_suite_wrong(at, "name", "two cases have this name at %s", size);
    }
    if (s->count == CASES_MOST) return masu_suite_wrong(at, NULL, "more than %u cases", CASES_MOST);
    if (!(s->count & (s->count - 1))) { /* full at each power of two */
        size_t room = s->count ? 2 * (size_t)s->count : 1;
        masu_case *more = realloc(s->cases, room * sizeof *more);
        if (!more) return masu_suite_wrong(at, NULL, "out of memory for %zu cases", room);
        s->cases = more;
    }
    s->cases[s->count++] = *c;
    return true;
}

/* ':' separates the parts of a token, and control characters could not be retyped. */
static bool read_name(masu_suite_place *at, const json_t *value, masu_case *c) {
    if (!masu_suite_string(at, "name", json_object_get(value, "name"), &c->name)) return false;
    size_t n = strlen(c->name);
    bool good = n <= NAME_MOST && n == json_string_length(json_object_get(value, "name"));
    for (size_t i = 0; i < n; i++)
        good = good && (unsigned char)c->name[i] >= ' ' && c->name[i] != ':' && c->name[i] != 127;
    if (!good) {
        return masu_suite_wrong(at, "name",
                                "expected at most %u characters without ':' and control "
                                "characters, found %zu",
                                NAME_MOST, n);
    }
    at->case_name = c->name;
    return true;
}

static bool read_case(masu_suite_place *at, size_t number, const json_t *value,
                      const masu_case *defaults) {
    masu_case c = *defaults;
    char label[32], text[80];
    snprintf(label, sizeof label, "cases[%zu]", number);
    at->case_name = NULL;
    if (!masu_suite_object(at, label, value)) return false;
    at->case_name = label;
    if (!read_name(at, value, &c) || !read_keys(at, value, &c)) return false;
    const json_t *sizes = json_object_get(value, "sizes");
    if (!sizes) return check_case(at, &c) && append(at, &c);
    if (!json_is_array(sizes) || !json_array_size(sizes)) {
        return masu_suite_wrong(at, "sizes", "expected an array of sizes, found %s",
                                masu_json_given(sizes, text, sizeof text));
    }
    if (json_object_get(value, "size"))
        return masu_suite_wrong(at, "sizes", "cannot be combined with 'size'");
    for (size_t i = 0; i < json_array_size(sizes); i++) {
        masu_case one = c;
        if (!read_pair(at, "sizes", json_array_get(sizes, i), 1, 16384, &one.width, &one.height) ||
            !check_case(at, &one) || !append(at, &one)) {
            return false;
        }
    }
    return true;
}

/* Finds the other case that a case is compared with: it has the same size and renders an image. */
static bool find_others(masu_suite_place *at) {
    masu_suite *s = at->suite;
    for (uint32_t i = 0; i < s->count; i++) {
        masu_case *c = &s->cases[i];
        at->case_name = c->name;
        if (!c->against || c->golden || !strcmp(c->against, "truth")) continue;
        for (uint32_t k = 0; k < s->count && c->other < 0; k++) {
            const masu_case *o = &s->cases[k];
            if (k != i && !o->governed.on && o->width == c->width && o->height == c->height &&
                !strcmp(o->name, c->against)) {
                c->other = (int32_t)k;
            }
        }
        if (c->other < 0) {
            return masu_suite_wrong(at, "error.against",
                                    "expected 'truth' or another case of %ux%u without 'governed', "
                                    "found '%.60s'",
                                    c->width, c->height, c->against);
        }
    }
    return true;
}

static bool read_suite(masu_suite_place *at) {
    static const char *const known[] = {"format", "defaults", "cases", "about", NULL};
    const char *key;
    json_t *member, *root = at->suite->root;
    uint32_t format = 0;
    if (!masu_suite_object(at, "the suite", root)) return false;
    json_object_foreach(root, key, member) {
        const char *const *k = known;
        while (*k && strcmp(*k, key)) k++;
        if (!*k) return masu_suite_wrong(at, key, "unknown key");
    }
    if (!masu_suite_count(at, "format", json_object_get(root, "format"), 1, 1, &format))
        return false;
    masu_case defaults = {.frames = 1,
                          .flight = 2,
                          .other = -1,
                          .positions = 64,
                          .rays = 1024,
                          .rung_count = 1,
                          .governed = {.settles = {-1, -1}}};
    for (int m = 0; m < MASU_MEASURE_COUNT; m++)
        defaults.bounds[m] = defaults.least[m] = (masu_bound){MASU_UNKNOWN, MASU_UNKNOWN};
    const json_t *given_defaults = json_object_get(root, "defaults");
    at->case_name = "defaults";
    if (given_defaults && (!masu_suite_object(at, NULL, given_defaults) ||
                           !read_keys(at, given_defaults, &defaults))) {
        return false;
    }
    at->case_name = NULL;
    const json_t *cases = json_object_get(root, "cases");
    if (!json_array_size(cases))
        return masu_suite_wrong(at, "cases", "expected an array of cases, found none");
    for (size_t i = 0; i < json_array_size(cases); i++) {
        if (!read_case(at, i, json_array_get(cases, i), &defaults)) return false;
    }
    return find_others(at);
}

/* FNV-1a (Fowler, Noll, Vo), 32 bits: distinguishes suites; no protection against attacks. */
static uint32_t hash_of(const char *text, size_t bytes) {
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ (unsigned char)text[i]) * 16777619u;
    return hash;
}

bool masu_suite_parse(const char *file, const char *text, size_t bytes, masu_suite *suite,
                      char *error, size_t error_size) {
    json_error_t json_error;
    masu_suite_place at = {suite, NULL, error, error_size};
    *suite = (masu_suite){.file = file, .hash = hash_of(text, bytes)};
    suite->root = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &json_error);
    if (!suite->root) {
        snprintf(error, error_size, "%s:%d:%d: %s", file, json_error.line, json_error.column,
                 json_error.text);
        masu_cli_plain(error);
        return false;
    }
    if (read_suite(&at)) return true;
    masu_cli_plain(error);
    masu_suite_free(suite);
    return false;
}

void masu_suite_free(masu_suite *suite) {
    json_decref(suite->root);
    free(suite->cases);
    suite->root = NULL;
    suite->cases = NULL;
    suite->count = 0;
}

/* ---- Selection ------------------------------------------------------------------------------- */

bool masu_replay_token(const masu_suite *suite, const masu_case *c, char *out, size_t size) {
    int n = snprintf(out, size, "%08x:%s:%ux%u", suite->hash, c->name, c->width, c->height);
    return n > 0 && (size_t)n < size;
}

int32_t masu_replay_find(const masu_suite *suite, const char *token, char *error,
                         size_t error_size) {
    char own[200];
    unsigned hash = 0;
    int read = 0;
    if (sscanf(token, "%8x:%n", &hash, &read) != 1 || read != 9) {
        snprintf(error, error_size,
                 "expected a token suite:case:size, found '%.80s'; example: "
                 "1f00ba42:rungs.city:96x64",
                 token);
        return -1;
    }
    if (hash != suite->hash) {
        snprintf(error, error_size, "token of another suite: found %08x, expected %08x (%s)", hash,
                 suite->hash, suite->file);
        return -1;
    }
    for (uint32_t i = 0; i < suite->count; i++) {
        if (masu_replay_token(suite, &suite->cases[i], own, sizeof own) &&
            !strcmp(own + 9, token + 9))
            return (int32_t)i;
    }
    snprintf(error, error_size, "%s: no case '%.140s'", suite->file, token + 9);
    return -1;
}

uint32_t masu_suite_select(const masu_suite *suite, const char *glob, uint32_t first, uint32_t of,
                           bool *marks) {
    uint32_t fits = 0, marked = 0;
    for (uint32_t i = 0; i < suite->count; i++) {
        bool fit = !glob || !fnmatch(glob, suite->cases[i].name, 0);
        marks[i] = fit && fits % of == first;
        fits += fit;
        marked += marks[i];
    }
    return marked;
}
