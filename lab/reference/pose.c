/* pose.c: transforms of the instances and skinned vertices of a scene at one moment. */
#include "lab/reference/scene.h"

#include <stdlib.h>
#include <string.h>

typedef struct node_pose {
    double translation[3], rotation[4], scale[3];
} node_pose;

ref_vec ref_transform_direction(const double m[12], ref_vec d) {
    return ref_v(m[0] * d.x + m[1] * d.y + m[2] * d.z, m[4] * d.x + m[5] * d.y + m[6] * d.z,
                 m[8] * d.x + m[9] * d.y + m[10] * d.z);
}

ref_vec ref_transform(const double m[12], ref_vec p) {
    return ref_add(ref_transform_direction(m, p), ref_v(m[3], m[7], m[11]));
}

/* By the cofactors: the inverse transpose times the determinant, also valid for mirrored and
 * flattened matrices. */
ref_vec ref_transform_normal(const double m[12], ref_vec n) {
    ref_vec a = ref_v(m[0], m[4], m[8]), b = ref_v(m[1], m[5], m[9]), c = ref_v(m[2], m[6], m[10]);
    ref_vec bc = ref_cross(b, c), ca = ref_cross(c, a), ab = ref_cross(a, b);
    double side = ref_dot(a, bc) < 0 ? -1 : 1;
    return ref_scale(ref_along(ref_along(ref_scale(bc, n.x), n.y, ca), n.z, ab), side);
}

static void multiply(const double a[12], const double b[12], double out[12]) {
    double product[12];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++) {
            product[4 * i + k] = k == 3 ? a[4 * i + 3] : 0;
            for (int j = 0; j < 3; j++) product[4 * i + k] += a[4 * i + j] * b[4 * j + k];
        }
    }
    memcpy(out, product, sizeof product);
}

static void doubles_of(const float from[12], double to[12]) {
    for (int i = 0; i < 12; i++) to[i] = (double)from[i];
}

void ref_octahedral(const int16_t packed[2], double out[3]) {
    double x = packed[0] / 32767.0, y = packed[1] / 32767.0, z = 1 - fabs(x) - fabs(y), old = x;
    if (z < 0) {
        x = (1 - fabs(y)) * (old >= 0 ? 1 : -1);
        y = (1 - fabs(old)) * (y >= 0 ? 1 : -1);
    }
    double length = sqrt(x * x + y * y + z * z);
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
}

/* ---- Clips ----------------------------------------------------------------------------------- */

static void matrix_of(const node_pose *p, double m[12]) {
    double x = p->rotation[0], y = p->rotation[1], z = p->rotation[2], w = p->rotation[3];
    double s = 2 / (x * x + y * y + z * z + w * w);
    double r[9] = {1 - s * (y * y + z * z), s * (x * y - z * w),     s * (x * z + y * w),
                   s * (x * y + z * w),     1 - s * (x * x + z * z), s * (y * z - x * w),
                   s * (x * z - y * w),     s * (y * z + x * w),     1 - s * (x * x + y * y)};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) m[4 * i + k] = r[3 * i + k] * p->scale[k];
        m[4 * i + 3] = p->translation[i];
    }
}

/* Translation, rotation (Shepperd 1978) and scale of an affine matrix without shear. */
static node_pose pose_of(const double m[12]) {
    node_pose p;
    double r[3][3];
    for (int k = 0; k < 3; k++) {
        p.translation[k] = m[4 * k + 3];
        p.scale[k] = sqrt(m[k] * m[k] + m[4 + k] * m[4 + k] + m[8 + k] * m[8 + k]);
        for (int i = 0; i < 3; i++) r[i][k] = p.scale[k] > 0 ? m[4 * i + k] / p.scale[k] : i == k;
    }
    double det = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                 r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                 r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
    if (det < 0) {
        p.scale[0] = -p.scale[0];
        for (int i = 0; i < 3; i++) r[i][0] = -r[i][0];
    }
    double q[4] = {r[0][0], r[1][1], r[2][2], r[0][0] + r[1][1] + r[2][2]};
    int largest = 0;
    for (int i = 1; i < 4; i++) largest = q[i] > q[largest] ? i : largest;
    if (largest == 3) {
        double four[4] = {r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], 1 + q[3]};
        memcpy(p.rotation, four, sizeof four);
    } else {
        int i = largest, j = (i + 1) % 3, k = (j + 1) % 3;
        p.rotation[i] = 1 + r[i][i] - r[j][j] - r[k][k];
        p.rotation[j] = r[j][i] + r[i][j];
        p.rotation[k] = r[k][i] + r[i][k];
        p.rotation[3] = r[k][j] - r[j][k];
    }
    return p;
}

static void sample(const masu_blob_key *keys, const masu_blob_channel *c, double t,
                   node_pose *pose) {
    const masu_blob_key *k = keys + c->first_key;
    uint32_t i = 0;
    while (i + 1 < c->key_count && (double)k[i + 1].time <= t) i++;
    uint32_t next = i + 1 < c->key_count ? i + 1 : i;
    double from = (double)k[i].time, to = (double)k[next].time, share = 0;
    if (next > i && !c->step && t > from) share = (t - from) / (to - from);
    double a = 1 - share, b = share;
    if (c->path == MASU_CHANNEL_ROTATION) {
        double dot = 0, side;
        for (int j = 0; j < 4; j++) dot += (double)k[i].value[j] * (double)k[next].value[j];
        side = dot < 0 ? -1 : 1;
        double angle = acos(fmin(dot * side, 1));
        if (angle > 1e-6) {
            a = sin((1 - share) * angle) / sin(angle);
            b = sin(share * angle) / sin(angle);
        }
        for (int j = 0; j < 4; j++)
            pose->rotation[j] = a * (double)k[i].value[j] + b * side * (double)k[next].value[j];
        return;
    }
    double *to3 = c->path == MASU_CHANNEL_SCALE ? pose->scale : pose->translation;
    for (int j = 0; j < 3; j++) to3[j] = a * (double)k[i].value[j] + b * (double)k[next].value[j];
}

static void animate_node(const ref_blob *blob, const masu_blob_model *m, uint32_t node, double time,
                         double local[12]) {
    const masu_blob_clip *clips = blob->section[MASU_BLOB_CLIPS];
    const masu_blob_channel *channels = blob->section[MASU_BLOB_CHANNELS];
    for (uint64_t i = 0; i < blob->count[MASU_BLOB_CLIPS]; i++) {
        if (clips[i].model != m->like) continue;
        double length = (double)clips[i].duration, t = length > 0 ? fmod(time, length) : 0;
        bool moved = false;
        if (t < 0) t += length;
        node_pose pose = pose_of(local);
        for (uint32_t c = 0; c < clips[i].channel_count; c++) {
            const masu_blob_channel *channel = &channels[clips[i].first_channel + c];
            if (channel->node != node || channel->path == MASU_CHANNEL_WEIGHT) continue;
            sample(blob->section[MASU_BLOB_KEYS], channel, t, &pose);
            moved = true;
        }
        if (moved) matrix_of(&pose, local);
        return;
    }
}

/* Matrices from the nodes' spaces to the model's. */
static void pose_model(const ref_blob *blob, const masu_blob_model *m, double time, bool animate,
                       double *matrices) {
    const masu_blob_model_node *nodes = blob->section[MASU_BLOB_MODEL_NODES];
    for (uint32_t n = 0; n < m->node_count; n++) {
        const masu_blob_model_node *node = &nodes[m->first_node + n];
        double *to = matrices + 12 * (size_t)n;
        doubles_of(node->local, to);
        if (animate) animate_node(blob, m, n, time, to);
        if (node->parent != MASU_BLOB_NONE)
            multiply(matrices + 12 * (size_t)(node->parent - m->first_node), to, to);
    }
}

void ref_pose_instances(const ref_blob *blob, double time, bool animate, double *matrices) {
    const masu_blob_instance *instances = blob->section[MASU_BLOB_INSTANCES];
    const masu_blob_model *models = blob->section[MASU_BLOB_MODELS];
    const masu_blob_model_node *nodes = blob->section[MASU_BLOB_MODEL_NODES];
    for (uint64_t i = 0; i < blob->count[MASU_BLOB_INSTANCES]; i++)
        doubles_of(instances[i].transform, matrices + 12 * i);
    for (uint64_t i = 0; animate && i < blob->count[MASU_BLOB_MODELS]; i++) {
        double whole[12], *posed = calloc(models[i].node_count, 12 * sizeof *posed);
        if (!posed) return;
        doubles_of(models[i].transform, whole);
        pose_model(blob, &models[i], time, true, posed);
        for (uint32_t n = 0; n < models[i].node_count; n++) {
            uint32_t instance = nodes[models[i].first_node + n].instance;
            if (instance != MASU_BLOB_NONE)
                multiply(whole, posed + 12 * (size_t)n, matrices + 12 * (size_t)instance);
        }
        free(posed);
    }
}

/* The weight of a morph target while the first clip of its model plays. */
static double weight_of(const ref_blob *blob, const masu_blob_skin *skin, uint32_t target,
                        double time, bool animate) {
    const masu_blob_model *m =
        (const masu_blob_model *)blob->section[MASU_BLOB_MODELS] + skin->model;
    const masu_blob_clip *clips = blob->section[MASU_BLOB_CLIPS];
    const masu_blob_channel *channels = blob->section[MASU_BLOB_CHANNELS];
    double rest = (double)((const masu_blob_morph_target *)
                               blob->section[MASU_BLOB_MORPH_TARGETS])[skin->first_target + target]
                      .weight;
    for (uint64_t i = 0; animate && i < blob->count[MASU_BLOB_CLIPS]; i++) {
        if (clips[i].model != m->like) continue;
        double length = (double)clips[i].duration, t = length > 0 ? fmod(time, length) : 0;
        if (t < 0) t += length;
        for (uint32_t c = 0; c < clips[i].channel_count; c++) {
            const masu_blob_channel *channel = &channels[clips[i].first_channel + c];
            node_pose pose = {.translation = {0}};
            if (channel->path != MASU_CHANNEL_WEIGHT ||
                channel->node != skin->node - m->first_node || channel->target != target)
                continue;
            sample(blob->section[MASU_BLOB_KEYS], channel, t, &pose); /* as a translation along x */
            return pose.translation[0];
        }
        return rest;
    }
    return rest;
}

/* Adds the morph targets of a skin to a rest vertex. */
static void morph(const ref_blob *blob, const masu_blob_skin *skin, uint32_t vertex,
                  const double *weights, ref_vec *position, double normal[3]) {
    const masu_blob_morph_delta *deltas = blob->section[MASU_BLOB_MORPH_DELTAS];
    for (uint32_t t = 0; t < skin->target_count; t++) {
        const masu_blob_morph_delta *d =
            &deltas[skin->first_delta + (size_t)t * skin->vertex_count + vertex];
        *position = ref_along(*position, weights[t], ref_of(d->position));
        for (int k = 0; k < 3; k++) {
            int bits = k < 2 ? 11 : 10, most = (1 << (bits - 1)) - 1;
            int value = (int)(d->normal >> 11 * k & ((1u << bits) - 1));
            if (value > most) value -= 1 << bits;
            normal[k] += weights[t] * 2 * value / most;
        }
    }
}

bool ref_pose_skin(const ref_blob *blob, uint32_t index, double time, bool animate,
                   ref_vec *positions, ref_vec *normals) {
    const masu_blob_skin *skin = (const masu_blob_skin *)blob->section[MASU_BLOB_SKINS] + index;
    const masu_blob_model *m =
        (const masu_blob_model *)blob->section[MASU_BLOB_MODELS] + skin->model;
    const masu_blob_joint *joints =
        (const masu_blob_joint *)blob->section[MASU_BLOB_JOINTS] + skin->first_joint;
    const masu_blob_skin_vertex *from =
        (const masu_blob_skin_vertex *)blob->section[MASU_BLOB_SKIN_VERTICES] +
        skin->first_skin_vertex;
    double whole[12], *nodes = calloc(m->node_count, 12 * sizeof *nodes);
    double *bones = calloc(skin->joint_count, 12 * sizeof *bones);
    double *weights = calloc(skin->target_count + 1, sizeof *weights);
    bool good = nodes && bones && weights;
    for (uint32_t t = 0; good && t < skin->target_count; t++)
        weights[t] = weight_of(blob, skin, t, time, animate);
    if (good) {
        doubles_of(m->transform, whole);
        pose_model(blob, m, time, animate, nodes);
        for (uint32_t j = 0; j < skin->joint_count; j++) {
            double *bone = bones + 12 * (size_t)j;
            doubles_of(joints[j].inverse_bind, bone);
            multiply(nodes + 12 * (size_t)joints[j].node, bone, bone);
            multiply(whole, bone, bone);
        }
        for (uint32_t v = 0; v < skin->vertex_count; v++) {
            double sum[12] = {0}, normal[3];
            for (int k = 0; k < 4; k++) {
                const double *bone = bones + 12 * (size_t)from[v].joints[k];
                for (int e = 0; e < 12; e++) sum[e] += from[v].weights[k] / 65535.0 * bone[e];
            }
            ref_octahedral(from[v].rest.normal, normal);
            ref_vec rest = ref_of(from[v].rest.position);
            morph(blob, skin, v, weights, &rest, normal);
            positions[v] = ref_transform(sum, rest);
            normals[v] =
                ref_unit(ref_transform_normal(sum, ref_v(normal[0], normal[1], normal[2])));
        }
    }
    free(nodes);
    free(bones);
    free(weights);
    return good;
}
