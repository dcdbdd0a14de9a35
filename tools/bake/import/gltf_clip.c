/* gltf_clip.c: converts animations of a glTF file to aiAnimations with linear keys; see gltf.h.
 *
 * A step becomes two keys, one float apart in time (as do several keys at one time: assimp_skin.c).
 * A cubic spline is divided into lines whose error is at most ERROR of the range of its values (for
 * a rotation: of a unit quaternion). */
#include "bake/import/gltf.h"

#include <stdlib.h>
#include <string.h>

#define ERROR 1e-3
#define CUTS_MAX 7 /* bisections of one spline segment */

typedef struct keys {
    masu_bake_buffer all; /* five doubles each: time, value */
    unsigned components;
    double error;
} keys;

static void add_key(keys *k, double time, const double *value) {
    double key[5] = {time, 0, 0, 0, 0};
    memcpy(key + 1, value, k->components * sizeof *value);
    masu_bake_append(&k->all, key, sizeof key);
}

/* A segment of a cubic spline: value, outgoing tangent; incoming tangent, value. */
typedef struct piece {
    double from, to, v0[4], b0[4], a1[4], v1[4];
} piece;

static void spline(const keys *k, const piece *p, double s, double out[4]) {
    double d = p->to - p->from, s2 = s * s, s3 = s2 * s, square = 0;
    for (unsigned i = 0; i < k->components; i++) {
        out[i] = (2 * s3 - 3 * s2 + 1) * p->v0[i] + d * (s3 - 2 * s2 + s) * p->b0[i] +
                 (3 * s2 - 2 * s3) * p->v1[i] + d * (s3 - s2) * p->a1[i];
        square += out[i] * out[i];
    }
    for (unsigned i = 0; i < k->components && k->components == 4 && square > 0; i++)
        out[i] /= sqrt(square);
}

static bool is_straight(const keys *k, const piece *p, double low, double high) {
    double a[4], b[4];
    spline(k, p, low, a);
    spline(k, p, high, b);
    for (int at = 1; at < 4; at++) {
        double c[4], share = at / 4.0;
        spline(k, p, low + (high - low) * share, c);
        for (unsigned i = 0; i < k->components; i++) {
            if (fabs(a[i] + (b[i] - a[i]) * share - c[i]) > k->error) return false;
        }
    }
    return true;
}

/* Keys after `low`, up to `high`. */
static void cut(keys *k, const piece *p, double low, double high, int depth) {
    double middle = (low + high) / 2, value[4];
    if (depth < CUTS_MAX && !is_straight(k, p, low, high)) {
        cut(k, p, low, middle, depth + 1);
        cut(k, p, middle, high, depth + 1);
        return;
    }
    spline(k, p, high, value);
    add_key(k, p->from + (p->to - p->from) * high, value);
}

/* In a spline, each value is between its two tangents. */
static void find_error(const float *values, size_t count, unsigned components, keys *k) {
    double range = 0;
    for (unsigned c = 0; c < components; c++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = 0; i < count; i++) {
            double value = (double)values[(3 * i + 1) * components + c];
            low = fmin(low, value);
            high = fmax(high, value);
        }
        range = fmax(range, high - low);
    }
    k->error = ERROR * (components == 4 ? 1 : fmax(range, 1e-6));
}

static void load(double *to, const float *from, unsigned count) {
    for (unsigned i = 0; i < count; i++) to[i] = (double)from[i];
}

enum { LINEAR, STEP, CUBIC };

static void make_keys(keys *k, const float *times, uint32_t count, const float *values, int how) {
    unsigned n = k->components;
    double value[4];
    if (how == CUBIC) find_error(values, count, n, k);
    for (uint32_t i = 0; i < count; i++) {
        const float *at = values + (size_t)i * n * (how == CUBIC ? 3 : 1);
        if (how == STEP && i && times[i] > times[i - 1]) {
            load(value, at - n, n);
            add_key(k, (double)nextafterf(times[i], -INFINITY), value);
        }
        if (how != CUBIC || !i) {
            load(value, how == CUBIC ? at + n : at, n);
            add_key(k, (double)times[i], value);
            continue;
        }
        piece p = {.from = (double)times[i - 1], .to = (double)times[i]};
        load(p.v0, at - 2 * n, n);
        load(p.b0, at - n, n);
        load(p.a1, at, n);
        load(p.v1, at + n, n);
        cut(k, &p, 0, 1, 0);
    }
}

static struct aiNodeAnim *channel_of(masu_gltf *g, const keys *k, int path,
                                     const struct aiNode *node) {
    struct aiNodeAnim *out = masu_gltf_take(g, 1, sizeof *out);
    const double *key = (const double *)(const void *)k->all.data;
    unsigned count = (unsigned)(k->all.bytes / (5 * sizeof *key));
    out->mNodeName = node->mName;
    if (path == 1) {
        out->mNumRotationKeys = count;
        out->mRotationKeys = masu_gltf_take(g, count, sizeof *out->mRotationKeys);
        for (unsigned i = 0; i < count; i++, key += 5)
            out->mRotationKeys[i] = (struct aiQuatKey){.mTime = key[0],
                                                       .mValue = {.w = (float)key[4],
                                                                  .x = (float)key[1],
                                                                  .y = (float)key[2],
                                                                  .z = (float)key[3]}};
        return out;
    }
    struct aiVectorKey *to = masu_gltf_take(g, count, sizeof *to);
    for (unsigned i = 0; i < count; i++, key += 5)
        to[i] = (struct aiVectorKey){.mTime = key[0],
                                     .mValue = {(float)key[1], (float)key[2], (float)key[3]}};
    if (path == 0) {
        out->mNumPositionKeys = count;
        out->mPositionKeys = to;
    } else {
        out->mNumScalingKeys = count;
        out->mScalingKeys = to;
    }
    return out;
}

/* A channel of weights: one of Assimp's channels per target, with only that target. */
static void add_weights(masu_gltf *g, const float *times, uint32_t count, const float *values,
                        uint32_t targets, int how, const struct aiNode *node,
                        struct aiAnimation *out) {
    struct aiMeshMorphAnim **all =
        masu_gltf_take(g, out->mNumMorphMeshChannels + (size_t)targets, sizeof *all);
    uint32_t parts = how == CUBIC ? 3 : 1;
    float *own = masu_gltf_take(g, (size_t)count * parts + 1, sizeof *own);
    if (out->mNumMorphMeshChannels)
        memcpy(all, out->mMorphMeshChannels, out->mNumMorphMeshChannels * sizeof *all);
    for (uint32_t t = 0; t < targets; t++) {
        keys k = {.components = 1};
        for (size_t i = 0; i < (size_t)count * parts; i++) own[i] = values[i * targets + t];
        make_keys(&k, times, count, own, how);
        const double *key = (const double *)(const void *)k.all.data;
        struct aiMeshMorphAnim *made = masu_gltf_take(g, 1, sizeof *made);
        made->mName = node->mName;
        made->mNumKeys = (unsigned)(k.all.bytes / (5 * sizeof *key));
        made->mKeys = masu_gltf_take(g, made->mNumKeys, sizeof *made->mKeys);
        unsigned *number = masu_gltf_take(g, 1, sizeof *number);
        double *weights = masu_gltf_take(g, made->mNumKeys, sizeof *weights);
        *number = t;
        for (unsigned i = 0; i < made->mNumKeys; i++, key += 5) {
            weights[i] = key[1];
            made->mKeys[i] = (struct aiMeshMorphKey){.mTime = key[0],
                                                     .mValues = number,
                                                     .mWeights = &weights[i],
                                                     .mNumValuesAndWeights = 1};
        }
        all[out->mNumMorphMeshChannels++] = made;
        masu_bake_release(&k.all);
    }
    out->mMorphMeshChannels = all;
}

static int find_path(const char *path) {
    static const char *const paths[] = {"translation", "rotation", "scale"};
    for (int i = 0; path && i < 3; i++) {
        if (strcmp(path, paths[i]) == 0) return i;
    }
    return -1;
}

/* NULL without failure: it animates nothing that can move, or weights, which are already in the
 * clip. */
static struct aiNodeAnim *read_channel(masu_gltf *g, const json_t *clip, const json_t *channel,
                                       struct aiAnimation *clip_made) {
    const json_t *target = masu_gltf_object(g, channel, "target");
    const json_t *samplers = masu_gltf_array(g, clip, "samplers");
    json_int_t node = -1, sampler = -1, input = -1, output = -1;
    size_t accessors = masu_gltf_count(g, "accessors");
    uint32_t times = 0, values = 0;
    const char *path = masu_gltf_string(g, target, "path");
    if (!masu_gltf_index(g, target, "node", g->node_count, &node) ||
        !masu_gltf_index(g, channel, "sampler", json_array_size(samplers), &sampler))
        return NULL;
    const json_t *about = sampler < 0 ? NULL : json_array_get(samplers, (size_t)sampler);
    const char *how = masu_gltf_string(g, about, "interpolation");
    int kind = !how || !strcmp(how, "LINEAR") ? LINEAR : !strcmp(how, "STEP") ? STEP : CUBIC;
    bool weighs = path && strcmp(path, "weights") == 0;
    keys k = {.components = find_path(path) == 1 ? 4 : weighs ? 1 : 3};
    if ((find_path(path) < 0 && !weighs) || node < 0 || !about || masu_gltf_failed(g)) return NULL;
    if (!masu_gltf_index(g, about, "input", accessors, &input) ||
        !masu_gltf_index(g, about, "output", accessors, &output))
        return NULL;
    if (input < 0 || output < 0) {
        masu_gltf_fail(g, "samplers[%lld] lacks its input or output", (long long)sampler);
        return NULL;
    }
    const float *in = masu_gltf_floats(g, input, 1, &times, NULL);
    const float *out = in ? masu_gltf_floats(g, output, k.components, &values, NULL) : NULL;
    if (!out) return NULL;
    uint64_t needed = (uint64_t)times * (kind == CUBIC ? 3 : 1);
    if (needed > values) {
        masu_gltf_fail(g, "samplers[%lld] has %u times and %u values", (long long)sampler, times,
                       values);
        return NULL;
    }
    for (uint32_t i = 0; i < times; i++)
        clip_made->mDuration = fmax(clip_made->mDuration, (double)in[i]);
    if (weighs) {
        uint64_t targets = needed ? values / needed : 0;
        if (targets <= MASU_BLOB_MORPH_TARGETS_MAX)
            add_weights(g, in, times, out, (uint32_t)targets, kind, &g->nodes[node], clip_made);
        return NULL;
    }
    make_keys(&k, in, times, out, kind);
    struct aiNodeAnim *made = channel_of(g, &k, find_path(path), &g->nodes[node]);
    masu_bake_release(&k.all);
    return made;
}

static bool read_clip(masu_gltf *g, const json_t *clip, size_t index, struct aiAnimation *out) {
    const json_t *channels = masu_gltf_array(g, clip, "channels");
    masu_gltf_set_string(&out->mName, masu_gltf_name_of(g, "animations", index, clip));
    out->mTicksPerSecond = 1;
    out->mChannels = masu_gltf_take(g, json_array_size(channels), sizeof *out->mChannels);
    for (size_t i = 0; i < json_array_size(channels) && !masu_gltf_failed(g); i++) {
        struct aiNodeAnim *made = read_channel(g, clip, json_array_get(channels, i), out);
        if (made) out->mChannels[out->mNumChannels++] = made;
    }
    return !masu_gltf_failed(g);
}

bool masu_gltf_read_clips(masu_gltf *g) {
    size_t count = masu_gltf_count(g, "animations");
    struct aiAnimation *all = masu_gltf_take(g, count, sizeof *all);
    g->scene.mAnimations = masu_gltf_take(g, count, sizeof *g->scene.mAnimations);
    for (size_t i = 0; i < count; i++) {
        const json_t *clip = masu_gltf_element(g, "animations", (json_int_t)i);
        if (!clip) return false;
        masu_gltf_at(g, "animations", i, clip);
        if (!read_clip(g, clip, i, &all[i])) return false;
        g->scene.mAnimations[i] = &all[i];
    }
    g->scene.mNumAnimations = (unsigned)count;
    g->where[0] = '\0';
    return true;
}
