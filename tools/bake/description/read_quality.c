/* read_quality.c: the parts of a scene that make rendering faster or better: LODs and occluders,
 * light probes, reflections. */
#include "bake/description/reader.h"

#define SUNS_APART 0.017 /* radians: closer ones are indistinguishable */

bool masu_bake_read_detail(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_description *out = r->out;
    double levels = 0;
    if (!masu_bake_json_number(scene, "lods", 0, MASU_BLOB_LODS_MAX, &levels) ||
        !masu_bake_json_number(scene, "occluders", 0, 1e9, &out->occluders)) {
        return false;
    }
    if (levels != floor(levels)) {
        return masu_bake_json_wrong(scene, "lods must be a whole number");
    }
    out->lods = (uint32_t)levels;
    return true;
}

/* ---- probes ---- */

static bool read_suns(const masu_bake_json *probes, masu_bake_probe_settings *s) {
    masu_bake_json suns = masu_bake_json_member(probes, "suns");
    if (!suns.value) return true;
    if (!masu_bake_json_array(&suns, 0)) return false;
    size_t count = json_array_size(suns.value);
    if (count > MASU_PROBE_SUNS_MAX) {
        return masu_bake_json_wrong(&suns, "%zu suns, at most %u", count, MASU_PROBE_SUNS_MAX);
    }
    s->has_suns = true;
    s->suns = (uint32_t)count;
    for (size_t i = 0; i < count; i++) {
        static const char *const members[] = {"azimuth", "elevation", NULL};
        masu_bake_json at = masu_bake_json_element(&suns, i);
        double a = 0, e = 45;
        if (!masu_bake_json_object(&at, members) ||
            !masu_bake_json_number(&at, "azimuth", -360, 360, &a) ||
            !masu_bake_json_number(&at, "elevation", -90, 90, &e)) {
            return false;
        }
        masu_bake_store(masu_bake_direction(a, e), s->sun[i]);
        s->sun[i][3] = 0;
        for (size_t k = 0; k < i; k++) {
            double c = masu_bake_dot(masu_bake_v3f(s->sun[i]), masu_bake_v3f(s->sun[k]));
            if (c < cos(SUNS_APART)) continue;
            return masu_bake_json_wrong(&at, "less than a degree from suns[%zu]", k);
        }
    }
    return true;
}

static bool read_bounds(const masu_bake_json *probes, masu_bake_probe_settings *s) {
    masu_bake_json bounds = masu_bake_json_member(probes, "bounds");
    s->has_bounds = bounds.value != NULL;
    return !bounds.value || masu_bake_json_box(&bounds, &s->bounds);
}

static bool read_spacing(const masu_bake_json *probes, masu_bake_probe_settings *s) {
    s->has_spacing = masu_bake_json_has(probes, "spacing");
    s->has_counts = masu_bake_json_has(probes, "counts");
    masu_bake_vec3 counts = {0, 0, 0};
    if (!masu_bake_json_vec3(probes, "spacing", 1e-3, 1e6, &s->spacing) ||
        !masu_bake_json_vec3(probes, "counts", 1, MASU_PROBE_COUNT_MAX, &counts)) {
        return false;
    }
    if (s->has_spacing && s->has_counts) {
        return masu_bake_json_wrong(probes,
                                    "expected either \"spacing\" or \"counts\", found both");
    }
    const double n[3] = {counts.x, counts.y, counts.z};
    for (int k = 0; k < 3; k++) {
        if (n[k] != floor(n[k])) {
            masu_bake_json at = masu_bake_json_member(probes, "counts");
            return masu_bake_json_wrong(&at, "expected whole numbers");
        }
        s->counts[k] = (uint32_t)n[k];
    }
    return true;
}

bool masu_bake_read_probes(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_probe_settings *s = &r->out->probes;
    static const char *const members[] = {"bounds", "spacing",    "counts", "rays",      "bounces",
                                          "suns",   "visibility", "bias",   "sky_bands", NULL};
    masu_bake_json probes = masu_bake_json_member(scene, "probes");
    if (!probes.value) return true;
    s->wanted = true;
    return masu_bake_json_object(&probes, members) && read_bounds(&probes, s) &&
           read_spacing(&probes, s) &&
           masu_bake_json_whole(&probes, "rays", 16, 1u << 16, &s->rays) &&
           masu_bake_json_whole(&probes, "bounces", 1, 32, &s->bounces) &&
           masu_bake_json_whole(&probes, "sky_bands", 1, 3, &s->sky_bands) &&
           masu_bake_json_whole(&probes, "visibility", 0, MASU_PROBE_VISIBILITY_MAX,
                                &s->visibility) &&
           masu_bake_json_number(&probes, "bias", 0, 1, &s->bias) && read_suns(&probes, s);
}

/* If the scene has probes too, the grid is theirs. */
bool masu_bake_read_bounce(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_probe_settings *s = &r->out->probes;
    static const char *const members[] = {"spacing", "box", NULL};
    masu_bake_json at, box, probes = masu_bake_json_member(scene, "probes");
    double spacing = MASU_BAKE_LIVE_SPACING;
    if (!masu_bake_json_feature(scene, "bounce", &at, &s->live)) return false;
    if (s->live && (!probes.value || !masu_bake_json_has(&probes, "visibility")))
        s->visibility = MASU_PROBE_VISIBILITY_MAX;
    if (!at.value) return true;
    if (!masu_bake_json_object(&at, members) ||
        !masu_bake_json_number(&at, "spacing", 1e-3, 1e6, &spacing))
        return false;
    box = masu_bake_json_member(&at, "box");
    bool spaced = masu_bake_json_has(&at, "spacing");
    if ((box.value && s->has_bounds) || (spaced && (s->has_spacing || s->has_counts)))
        return masu_bake_json_wrong(&at, "\"probes\" has a grid of its own, and both share one");
    if (spaced) {
        s->has_spacing = true;
        s->spacing = masu_bake_v3(spacing, spacing, spacing);
    }
    s->has_bounds |= box.value != NULL;
    return !box.value || masu_bake_json_box(&box, &s->bounds);
}

/* ---- reflections ---- */

bool masu_bake_read_reflections(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_reflections *out = &r->out->reflections;
    static const char *const members[] = {"smallest", "cutoff", "distance", "texture_size", NULL};
    masu_bake_json at;
    double side = out->texture_size;
    out->wanted = !r->bare;
    if (!masu_bake_json_feature(scene, "reflections", &at, &out->wanted)) return false;
    r->out->default_reflections = !masu_bake_json_has(scene, "reflections");
    bool good =
        !at.value || (masu_bake_json_object(&at, members) &&
                      masu_bake_json_number(&at, "smallest", 0, 1e9, &out->smallest) &&
                      masu_bake_json_number(&at, "cutoff", 0, 1, &out->cutoff) &&
                      masu_bake_json_number(&at, "distance", 1e-3, 1e9, &out->distance) &&
                      masu_bake_json_number(&at, "texture_size", 0, MASU_TRACE_TEXTURE_MAX, &side));
    uint32_t size = good ? (uint32_t)side : 0;
    if (good && ((double)size != side || size & (size - 1))) {
        masu_bake_json member = masu_bake_json_member(&at, "texture_size");
        good = masu_bake_json_wrong(&member, "is %g, and must be 0 or a power of two up to %u",
                                    side, MASU_TRACE_TEXTURE_MAX);
    }
    out->texture_size = size;
    return good;
}
