/* animation.c: see animation.h. */
#include "frame/animation.h"

#include <math.h>
#include <string.h>

void masu_animation_alloc(masu_animation *a, masu_arena *arena, const masu_frame_plan *plan) {
    const masu_scene_data *s = &plan->scene;
    uint32_t nodes = s->model_nodes;
    memset(a, 0, sizeof *a);
    if (!s->clips) return;
    a->clips = masu_arena_alloc(arena, "clips", s->clips, sizeof *a->clips, 8);
    a->channels = masu_arena_alloc(arena, "channels", s->channels, sizeof *a->channels, 4);
    a->keys = masu_arena_alloc(arena, "keys", s->keys, sizeof *a->keys, 4);
    a->rest = masu_arena_alloc(arena, "rest poses", nodes, sizeof *a->rest, 8);
    a->moved = masu_arena_alloc(arena, "moved nodes", nodes, sizeof *a->moved, 1);
    a->poses = masu_arena_alloc(arena, "poses", s->max_nodes, sizeof *a->poses, 8);
    a->locals = masu_arena_alloc(arena, "previous nodes", s->max_nodes, sizeof *a->locals, 4);
}

/* ---- Poses and matrices ---------------------------------------------------------------------- */

static double normalised(double *v, uint32_t n) {
    double square = 0.0;
    for (uint32_t k = 0; k < n; k++) square += v[k] * v[k];
    double length = sqrt(square);
    for (uint32_t k = 0; k < n && length > 0.0; k++) v[k] /= length;
    return length;
}

void masu_pose_rows(const masu_node_pose *pose, float rows[12]) {
    const double *q = pose->rotation;
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                         2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                         2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) rows[4 * i + j] = (float)(r[3 * i + j] * pose->scale[j]);
        rows[4 * i + 3] = (float)pose->translation[i];
    }
}

/* From a rotation matrix: by the largest component, so that no division is by a small number. */
static void quaternion_of(double r[3][3], double q[4]) {
    double trace = r[0][0] + r[1][1] + r[2][2];
    uint32_t i = r[1][1] > r[0][0] ? 1 : 0;
    if (r[2][2] > r[i][i]) i = 2;
    uint32_t j = (i + 1) % 3, k = (i + 2) % 3;
    if (trace > r[i][i]) {
        q[3] = 1 + trace;
        q[0] = r[2][1] - r[1][2];
        q[1] = r[0][2] - r[2][0];
        q[2] = r[1][0] - r[0][1];
    } else {
        q[i] = 1 + r[i][i] - r[j][j] - r[k][k];
        q[j] = r[j][i] + r[i][j];
        q[k] = r[k][i] + r[i][k];
        q[3] = r[k][j] - r[j][k];
    }
    if (!(normalised(q, 4) > 0.0)) q[3] = 1.0;
}

masu_node_pose masu_pose_of(const float rows[12]) {
    masu_node_pose pose;
    double columns[3][3], r[3][3];
    for (uint32_t j = 0; j < 3; j++) {
        for (uint32_t i = 0; i < 3; i++) columns[j][i] = (double)rows[4 * i + j];
        pose.translation[j] = (double)rows[4 * j + 3];
        pose.scale[j] = normalised(columns[j], 3);
        if (pose.scale[j] > 0.0) continue;
        for (uint32_t i = 0; i < 3; i++) columns[j][i] = i == j; /* flattened: any axis will do */
    }
    const double *a = columns[0], *b = columns[1], *c = columns[2];
    double turns = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]);
    if (turns < 0.0) { /* mirrored */
        pose.scale[0] = -pose.scale[0];
        for (uint32_t i = 0; i < 3; i++) columns[0][i] = -columns[0][i];
    }
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) r[i][j] = columns[j][i];
    }
    quaternion_of(r, pose.rotation);
    return pose;
}

/* ---- Clips ----------------------------------------------------------------------------------- */

void masu_animation_copy_scene(masu_animation *a, const masu_frame_plan *plan,
                               const masu_scene_view *v) {
    const masu_scene_data *s = &plan->scene;
    if (!s->clips) return;
    memcpy(a->channels, v->channels, s->channels * sizeof *a->channels);
    memcpy(a->keys, v->keys, s->keys * sizeof *a->keys);
    memset(a->moved, 0, s->model_nodes);
    for (uint32_t i = 0; i < s->clips; i++) {
        const masu_blob_clip *c = &v->clips[i];
        const char *name = c->name == MASU_BLOB_NONE ? "" : v->names + c->name;
        a->clips[i] = (masu_clip){.name = *name ? masu_fnv1a64(name, strlen(name)) : 0,
                                  .model = c->model,
                                  .first_channel = c->first_channel,
                                  .channel_count = c->channel_count,
                                  .duration = c->duration};
        for (uint32_t k = 0; k < c->channel_count; k++) {
            uint32_t node = v->channels[c->first_channel + k].node;
            if (v->channels[c->first_channel + k].path == MASU_CHANNEL_WEIGHT) continue;
            a->moved[v->models[c->model].first_node + node] = 1;
        }
    }
    for (uint32_t i = 0; i < masu_own_models(plan); i++) {
        const masu_blob_model *m = &v->models[i];
        for (uint32_t n = 0; n < m->node_count; n++) {
            uint32_t node = m->first_node + n;
            a->moved[node] = a->moved[v->models[m->like].first_node + n];
            if (a->moved[node]) a->rest[node] = masu_pose_of(v->model_nodes[node].local);
        }
    }
}

void masu_animation_copy(masu_animation *a, const masu_frame_plan *plan, uint32_t from, uint32_t to,
                         uint32_t nodes) {
    if (!plan->scene.clips) return;
    memcpy(a->moved + to, a->moved + from, nodes);
    memcpy(a->rest + to, a->rest + from, nodes * sizeof *a->rest);
}

uint32_t masu_animation_clips(const masu_animation *a, const masu_frame_plan *plan, uint32_t like,
                              uint32_t *first) {
    *first = 0;
    if (!plan->scene.clips) return 0;
    return masu_scene_range(&a->clips->model, sizeof *a->clips, plan->scene.clips, like, first);
}

/* Seconds from the clip's start. */
static double time_in(const masu_clip *clip, const masu_clip_use *use) {
    double length = (double)clip->duration, t = use->time;
    if (!(length > 0.0)) return 0.0;
    if (!use->loop) return t < 0.0 ? 0.0 : t > length ? length : t;
    t = fmod(t, length);
    return t < 0.0 ? t + length : t;
}

static void turn_evenly(const float from[4], const float to[4], double share, double out[4]) {
    double a[4], b[4], dot = 0.0;
    for (uint32_t k = 0; k < 4; k++) a[k] = (double)from[k], b[k] = (double)to[k];
    normalised(a, 4);
    normalised(b, 4);
    for (uint32_t k = 0; k < 4; k++) dot += a[k] * b[k];
    double side = dot < 0.0 ? -1.0 : 1.0, angle = acos(fmin(dot * side, 1.0));
    double one = 1.0 - share, two = share;
    if (angle > 1e-6) {
        one = sin((1.0 - share) * angle) / sin(angle);
        two = sin(share * angle) / sin(angle);
    }
    for (uint32_t k = 0; k < 4; k++) out[k] = one * a[k] + two * side * b[k];
    normalised(out, 4);
}

/* The keys around a time, and how much of the way from the first to the second it is. */
static double around(const masu_blob_key *keys, const masu_blob_channel *c, double t,
                     const masu_blob_key **from_key, const masu_blob_key **to_key) {
    const masu_blob_key *k = keys + c->first_key;
    uint32_t low = 0, end = c->key_count - 1;
    while (low < end) { /* the last key that is not behind t; the first, where all are */
        uint32_t middle = low + (end - low + 1) / 2;
        if ((double)k[middle].time <= t)
            low = middle;
        else
            end = middle - 1;
    }
    uint32_t next = low + 1 < c->key_count ? low + 1 : low;
    double from = (double)k[low].time, share = 0.0;
    if (next > low && !c->step && t > from) share = (t - from) / ((double)k[next].time - from);
    *from_key = &k[low];
    *to_key = &k[next];
    return share;
}

static void sample(const masu_blob_key *keys, const masu_blob_channel *c, double t,
                   masu_node_pose *pose) {
    const masu_blob_key *from, *next;
    double share = around(keys, c, t, &from, &next);
    if (c->path == MASU_CHANNEL_ROTATION) {
        turn_evenly(from->value, next->value, share, pose->rotation);
        return;
    }
    double *to = c->path == MASU_CHANNEL_SCALE ? pose->scale : pose->translation;
    for (uint32_t i = 0; i < 3; i++)
        to[i] = (1.0 - share) * (double)from->value[i] + share * (double)next->value[i];
}

/* Adds a weighted pose; rotations in the hemisphere of the sum. */
static void add(masu_node_pose *sum, const masu_node_pose *pose, double share) {
    double dot = 0.0;
    for (uint32_t k = 0; k < 4; k++) dot += sum->rotation[k] * pose->rotation[k];
    for (uint32_t k = 0; k < 4; k++)
        sum->rotation[k] += (dot < 0.0 ? -share : share) * pose->rotation[k];
    for (uint32_t k = 0; k < 3; k++) {
        sum->translation[k] += share * pose->translation[k];
        sum->scale[k] += share * pose->scale[k];
    }
}

static void add_use(masu_animation *a, const masu_clip *clip, const masu_clip_use *use,
                    double share, uint32_t first_node, uint32_t nodes) {
    double t = time_in(clip, use);
    uint32_t c = clip->first_channel, end = c + clip->channel_count;
    for (uint32_t n = 0; n < nodes; n++) {
        masu_node_pose pose;
        if (!a->moved[first_node + n]) continue;
        pose = a->rest[first_node + n];
        for (; c < end && a->channels[c].node <= n; c++) {
            if (a->channels[c].path != MASU_CHANNEL_WEIGHT)
                sample(a->keys, &a->channels[c], t, &pose);
        }
        add(&a->poses[n], &pose, share);
    }
}

void masu_animation_pose(masu_animation *a, uint32_t first_clip, const masu_clip_use *uses,
                         uint32_t count, uint32_t first_node, uint32_t nodes) {
    double whole = 0.0;
    for (uint32_t i = 0; i < count; i++) whole += (double)uses[i].weight;
    for (uint32_t n = 0; n < nodes; n++) {
        if (!a->moved[first_node + n]) continue;
        if (whole > 0.0)
            memset(&a->poses[n], 0, sizeof a->poses[n]);
        else
            a->poses[n] = a->rest[first_node + n];
    }
    for (uint32_t i = 0; i < count && whole > 0.0; i++) {
        if (!(uses[i].weight > 0.0f)) continue;
        add_use(a, &a->clips[first_clip + uses[i].clip], &uses[i], (double)uses[i].weight / whole,
                first_node, nodes);
    }
    for (uint32_t n = 0; n < nodes; n++) { /* opposite ones may have left nothing */
        if (!a->moved[first_node + n] || normalised(a->poses[n].rotation, 4) > 0.0) continue;
        a->poses[n].rotation[3] = 1.0;
    }
}

double masu_animation_weight(const masu_animation *a, uint32_t first_clip,
                             const masu_clip_use *uses, uint32_t count, uint32_t node,
                             uint32_t target, double rest) {
    double whole = 0.0, sum = 0.0;
    for (uint32_t i = 0; i < count; i++) whole += (double)uses[i].weight;
    for (uint32_t i = 0; i < count && whole > 0.0; i++) {
        const masu_clip *clip = &a->clips[first_clip + uses[i].clip];
        const masu_blob_key *from, *next;
        for (uint32_t c = clip->first_channel; c < clip->first_channel + clip->channel_count; c++) {
            const masu_blob_channel *channel = &a->channels[c];
            if (channel->path != MASU_CHANNEL_WEIGHT || channel->node != node ||
                channel->target != target)
                continue;
            double share = around(a->keys, channel, time_in(clip, &uses[i]), &from, &next);
            double value = (1.0 - share) * (double)from->value[0] + share * (double)next->value[0];
            sum += (value - rest) * ((double)uses[i].weight / whole);
            break;
        }
    }
    return rest + sum;
}
