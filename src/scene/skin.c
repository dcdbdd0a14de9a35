/* skin.c: see skin.h. */
#include "scene/skin.h"

#include <math.h>
#include <stddef.h>

static int all_finite(const float *v, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        if (!isfinite(v[i])) return 0;
    }
    return 1;
}

static int is_unit(const float q[4]) {
    double square = 0.0;
    for (uint32_t k = 0; k < 4; k++) square += (double)q[k] * (double)q[k];
    return square > 0.98 && square < 1.02;
}

const char *masu_wrong_channel(const masu_blob_channel *c, uint32_t nodes,
                               const masu_blob_key *keys, uint64_t key_count, uint64_t next) {
    if (c->node >= nodes) return "moves no node of its model";
    if (c->path > MASU_CHANNEL_WEIGHT) return "unknown path";
    if (c->step > 1) return "step is neither 0 nor 1";
    if (c->first_key != next || !c->key_count || c->key_count > key_count - next)
        return "keys are not the next of the keys";
    for (uint64_t k = next; k < next + c->key_count; k++) {
        if (!(keys[k].time >= 0.0f && keys[k].time <= MASU_CLIP_SECONDS_MAX))
            return "the time of a key is not 0 to 1e9 s";
        if (k > next && !(keys[k].time > keys[k - 1].time)) return "keys are not in rising time";
        if (!all_finite(keys[k].value, 4)) return "a key is not finite";
        if (c->path == MASU_CHANNEL_ROTATION && !is_unit(keys[k].value))
            return "a rotation is not of unit length";
        if (c->path == MASU_CHANNEL_WEIGHT && !(fabsf(keys[k].value[0]) <= MASU_MORPH_WEIGHT_MAX))
            return "a weight is beyond 1e6";
    }
    return NULL;
}

const char *masu_wrong_joint(const masu_blob_joint *j, uint32_t nodes) {
    if (j->node >= nodes) return "is no node of its model";
    if (!all_finite(j->inverse_bind, 12)) return "inverse bind is not finite";
    if (j->used > 1) return "used is neither 0 nor 1";
    if (!all_finite(j->low, 3) || !all_finite(j->high, 3)) return "box is not finite";
    for (uint32_t k = 0; k < 3; k++) {
        if (!(j->low[k] <= j->high[k])) return "box is upside down";
    }
    return NULL;
}

const char *masu_wrong_skin_vertex(const masu_blob_skin_vertex *v, const masu_blob_joint *joints,
                                   uint32_t joint_count) {
    uint32_t sum = 0;
    if (!all_finite(v->rest.position, 3)) return "is not finite";
    for (uint32_t i = 0; i < 4; i++) {
        const float *at = v->rest.position;
        sum += v->weights[i];
        if (v->joints[i] >= joint_count) return "is moved by no joint of its skin";
        if (!v->weights[i]) continue;
        const masu_blob_joint *j = &joints[v->joints[i]];
        if (!j->used) return "is moved by a joint that moves nothing";
        for (uint32_t k = 0; k < 3; k++) {
            if (!(j->low[k] <= at[k] && at[k] <= j->high[k]))
                return "lies outside the box of a joint that moves it";
        }
    }
    return sum == 65535 ? NULL : "has weights that are not 65535 together";
}

const char *masu_wrong_morph_target(const masu_blob_morph_target *t,
                                    const masu_blob_morph_delta *deltas, uint32_t vertices) {
    if (!(fabsf(t->weight) <= MASU_MORPH_WEIGHT_MAX)) return "weight is beyond 1e6";
    for (uint32_t k = 0; k < 3; k++) {
        if (!(t->low[k] >= -1e15f && t->high[k] <= 1e15f)) return "box is not finite";
    }
    for (uint32_t i = 0; i < vertices; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            float d = deltas[i].position[k];
            if (!(t->low[k] <= d && d <= t->high[k])) return "has a delta outside its box";
        }
    }
    return NULL;
}
