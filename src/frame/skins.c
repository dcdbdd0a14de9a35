/* skins.c: see skins.h. */
#include "frame/skins.h"

#include <math.h>
#include <string.h>

/* Bound of the relative fp32 error of skinned vertices. */
#define ROUNDING 4e-6

void masu_skins_alloc(masu_skins *s, masu_arena *arena, const masu_frame_plan *plan) {
    const masu_scene_data *scene = &plan->scene;
    uint64_t before = plan->needs.velocity ? scene->skinned_joints : 0;
    memset(s, 0, sizeof *s);
    if (!scene->skins) return;
    s->skins = masu_arena_alloc(arena, "skins", scene->skins, sizeof *s->skins, 4);
    s->joints = masu_arena_alloc(arena, "joints", scene->joints, sizeof *s->joints, 4);
    s->now = masu_arena_alloc(arena, "joint matrices", scene->skinned_joints, sizeof *s->now, 4);
    s->previous = masu_arena_alloc(arena, "previous matrices", before, sizeof *s->previous, 4);
    if (scene->skin_targets) {
        before = plan->needs.velocity ? scene->skin_targets : 0;
        s->targets =
            masu_arena_alloc(arena, "morph targets", scene->morph_targets, sizeof *s->targets, 8);
        s->weights =
            masu_arena_alloc(arena, "morph weights", scene->skin_targets, sizeof *s->weights, 4);
        s->before = masu_arena_alloc(arena, "previous weights", before, sizeof *s->before, 4);
    }
    s->inside =
        masu_arena_alloc(arena, "nodes in their model", scene->max_nodes, sizeof *s->inside, 8);
}

static void copy_targets(masu_skins *s, const masu_frame_plan *plan, const masu_scene_view *v) {
    for (uint32_t t = 0; t < plan->scene.morph_targets && plan->scene.skin_targets; t++) {
        const masu_blob_morph_target *from = &v->morph_targets[t];
        masu_morph *to = &s->targets[t];
        *to = (masu_morph){.rest = from->weight, .name = masu_scene_name_hash(v, from->name)};
        memcpy(to->low, from->low, sizeof to->low);
        memcpy(to->high, from->high, sizeof to->high);
    }
    for (uint32_t i = 0; i < plan->scene.clips && plan->scene.skin_targets; i++) {
        const masu_blob_clip *clip = &v->clips[i];
        for (uint32_t c = clip->first_channel; c < clip->first_channel + clip->channel_count; c++) {
            const masu_blob_channel *channel = &v->channels[c];
            if (channel->path != MASU_CHANNEL_WEIGHT) continue;
            uint32_t node = v->models[clip->model].first_node + channel->node;
            s->targets[v->skins[v->model_nodes[node].skin - 1].first_target + channel->target]
                .driven = 1;
        }
    }
}

void masu_skins_copy_scene(masu_skins *s, const masu_frame_plan *plan, const masu_scene_view *v) {
    uint32_t matrix = 0, box = 0, weight = 0;
    copy_targets(s, plan, v);
    for (uint32_t i = 0; i < plan->scene.joints; i++) s->joints[i] = v->joints[i];
    for (uint32_t i = 0; i < plan->scene.skins; i++) {
        const masu_blob_skin *from = &v->skins[i];
        s->skins[i] = (masu_skin){.model = from->model,
                                  .node = from->node,
                                  .instance = v->model_nodes[from->node].instance,
                                  .first_vertex = from->first_vertex,
                                  .vertex_count = from->vertex_count,
                                  .first_skin_vertex = from->first_skin_vertex,
                                  .first_joint = from->first_joint,
                                  .joint_count = from->joint_count,
                                  .first_matrix = matrix,
                                  .first_box = box,
                                  .first_target = from->first_target,
                                  .target_count = from->target_count,
                                  .first_delta = from->first_delta,
                                  .first_weight = weight};
        for (uint32_t t = 0; t < from->target_count; t++, weight++) {
            s->weights[weight] = s->targets[from->first_target + t].rest;
            if (plan->needs.velocity) s->before[weight] = s->weights[weight];
        }
        if (v->trace_meshes) {
            const masu_blob_trace_mesh *tree =
                &v->trace_meshes[v->instances[s->skins[i].instance].mesh];
            s->skins[i].first_tree_node = tree->first_node;
            s->skins[i].tree_nodes = tree->node_count;
            box += tree->node_count;
        }
        for (uint32_t k = 0; k < from->joint_count; k++, matrix++) {
            static const float none[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
            memcpy(s->now[matrix], none, sizeof none);
            if (plan->needs.velocity) memcpy(s->previous[matrix], none, sizeof none);
        }
    }
}

uint32_t masu_skins_of(const masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                       uint32_t *first) {
    *first = 0;
    if (!plan->scene.skins) return 0;
    return masu_scene_range(&s->skins->model, sizeof *s->skins, plan->scene.skins, model, first);
}

/* ---- Matrices, row by row, in double --------------------------------------------------------- */

static void multiply(const double a[12], const double b[12], double out[12]) {
    for (uint32_t i = 0; i < 12; i += 4) {
        for (uint32_t j = 0; j < 4; j++) {
            double sum = j == 3 ? a[i + 3] : 0.0;
            for (uint32_t k = 0; k < 3; k++) sum += a[i + k] * b[4 * k + j];
            out[i + j] = sum;
        }
    }
}

static void widen(const float from[12], double to[12]) {
    for (uint32_t k = 0; k < 12; k++) to[k] = (double)from[k];
}

/* Returns 0 if the matrix has no inverse. */
static int invert(const double a[12], double out[12]) {
    double c[3][3];
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) {
            uint32_t p = (i + 1) % 3, q = (i + 2) % 3, u = (j + 1) % 3, w = (j + 2) % 3;
            c[i][j] = a[4 * p + u] * a[4 * q + w] - a[4 * p + w] * a[4 * q + u];
        }
    }
    double whole = a[0] * c[0][0] + a[1] * c[0][1] + a[2] * c[0][2], one = 1.0 / whole;
    if (!isfinite(one)) return 0;
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) out[4 * i + j] = c[j][i] * one;
    }
    for (uint32_t i = 0; i < 3; i++) {
        out[4 * i + 3] =
            -(out[4 * i] * a[3] + out[4 * i + 1] * a[7] + out[4 * i + 2] * a[11]);
    }
    return 1;
}

/* ---- Poses ----------------------------------------------------------------------------------- */

static int pose_one(masu_skins *s, const masu_skin *skin, uint32_t first_node) {
    double back[12], to[12], own[12], whole[12];
    int finite = 1;
    /* A node of no extent shows nothing, wherever its joints are. */
    if (!invert(s->inside[skin->node - first_node], back)) return 1;
    for (uint32_t j = 0; j < skin->joint_count; j++) {
        const masu_blob_joint *joint = &s->joints[skin->first_joint + j];
        float *now = s->now[skin->first_matrix + j];
        widen(joint->inverse_bind, own);
        multiply(s->inside[joint->node], own, to);
        multiply(back, to, whole);
        for (uint32_t k = 0; k < 12; k++) {
            now[k] = (float)whole[k];
            finite &= fabs(whole[k]) <= 1e30;
        }
    }
    return finite;
}

int masu_skins_pose(masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                    const masu_node *nodes, uint32_t first_node, uint32_t node_count) {
    uint32_t first, count = plan->scene.skins ? masu_skins_of(s, plan, model, &first) : 0;
    int finite = 1;
    if (!count) return 1;
    for (uint32_t n = 0; n < node_count; n++) {
        const masu_node *node = &nodes[first_node + n];
        double local[12];
        widen(node->local, local);
        if (node->parent == MASU_BLOB_NONE)
            memcpy(s->inside[n], local, sizeof local);
        else
            multiply(s->inside[node->parent - first_node], local, s->inside[n]);
    }
    for (uint32_t i = first; i < first + count; i++)
        finite &= pose_one(s, &s->skins[i], first_node);
    return finite;
}

/* ---- Morph targets --------------------------------------------------------------------------- */

void masu_skins_play(masu_skins *s, const masu_animation *a, const masu_frame_plan *plan,
                     uint32_t model, uint32_t first_node, uint32_t first_clip,
                     const masu_clip_use *uses, uint32_t count) {
    uint32_t first = 0,
             skins = plan->scene.skin_targets ? masu_skins_of(s, plan, model, &first) : 0;
    for (uint32_t i = first; i < first + skins; i++) {
        const masu_skin *skin = &s->skins[i];
        for (uint32_t t = 0; t < skin->target_count; t++) {
            const masu_morph *target = &s->targets[skin->first_target + t];
            if (!target->driven) continue;
            s->weights[skin->first_weight + t] = (float)masu_animation_weight(
                a, first_clip, uses, count, skin->node - first_node, t, (double)target->rest);
        }
    }
}

uint32_t masu_skins_set(masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                        const char *name, float weight) {
    uint32_t first = 0,
             skins = plan->scene.skin_targets ? masu_skins_of(s, plan, model, &first) : 0;
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    uint32_t found = 0;
    for (uint32_t i = first; i < first + skins; i++) {
        const masu_skin *skin = &s->skins[i];
        for (uint32_t t = 0; t < skin->target_count; t++) {
            if (s->targets[skin->first_target + t].name != hash) continue;
            s->weights[skin->first_weight + t] = weight;
            found++;
        }
    }
    return found;
}

/* By how much targets move vertices downwards and upwards at most, rest space. */
static void morph_of(const masu_skins *s, const masu_skin *skin, double low[3], double high[3]) {
    for (uint32_t k = 0; k < 3; k++) low[k] = high[k] = 0.0;
    for (uint32_t t = 0; t < skin->target_count; t++) {
        const masu_morph *target = &s->targets[skin->first_target + t];
        double weight = (double)s->weights[skin->first_weight + t];
        for (uint32_t k = 0; k < 3; k++) {
            double a = weight * (double)target->low[k], b = weight * (double)target->high[k];
            low[k] += fmin(0.0, fmin(a, b));
            high[k] += fmax(0.0, fmax(a, b));
        }
    }
}

/* Bounds of the vertices of all joints, object space. */
static void box_of(const masu_skins *s, const masu_skin *skin, float box[6]) {
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, down[3], up[3];
    int any = 0;
    morph_of(s, skin, down, up);
    for (uint32_t j = 0; j < skin->joint_count; j++) {
        const masu_blob_joint *joint = &s->joints[skin->first_joint + j];
        double to[12];
        if (!joint->used) continue;
        widen(s->now[skin->first_matrix + j], to);
        for (uint32_t k = 0; k < 3; k++) {
            double middle = to[4 * k + 3], half = 0.0, size = fabs(to[4 * k + 3]);
            for (uint32_t i = 0; i < 3; i++) {
                double l = (double)joint->low[i] + down[i], h = (double)joint->high[i] + up[i];
                middle += to[4 * k + i] * 0.5 * (l + h);
                half += fabs(to[4 * k + i]) * 0.5 * (h - l);
                size += fabs(to[4 * k + i]) * fmax(fabs(l), fabs(h));
            }
            half += ROUNDING * size;
            low[k] = any ? fmin(low[k], middle - half) : middle - half;
            high[k] = any ? fmax(high[k], middle + half) : middle + half;
        }
        any = 1;
    }
    for (uint32_t k = 0; k < 3; k++) { /* outwards by more than a float rounds */
        box[k] = (float)(low[k] - 1.2e-7 * fabs(low[k]) - 1e-37);
        box[3 + k] = (float)(high[k] + 1.2e-7 * fabs(high[k]) + 1e-37);
    }
}

void masu_skins_settle(masu_skins *s, masu_instances *in, masu_bounds *b,
                       const masu_frame_plan *plan, uint32_t model) {
    uint32_t first, count = plan->scene.skins ? masu_skins_of(s, plan, model, &first) : 0;
    for (uint32_t i = 0; i < count; i++) {
        const masu_skin *skin = &s->skins[first + i];
        box_of(s, skin, b->meshes[in->meshes[skin->instance]]);
        masu_instances_touch(in, plan, skin->instance);
        masu_bounds_move(b, plan, in, skin->instance);
    }
}

/* ---- The frame ------------------------------------------------------------------------------- */

/* A slot: of each skin a header, then all matrices; the same again as of the previous frame. */
static void write_one(const masu_skin *skin, uint32_t index, int hidden,
                      const masu_frame_plan *plan, float (*matrices)[12], const float *weights,
                      unsigned char *to) {
    uint32_t morphs = (uint32_t)(masu_morphs_at(&plan->scene) / 16) + index + skin->first_weight;
    uint32_t at = (uint32_t)(masu_skin_headers(&plan->scene) / 16) + 3 * skin->first_matrix;
    const uint32_t header[8] = {skin->first_skin_vertex,
                                skin->first_vertex,
                                hidden ? 0 : skin->vertex_count,
                                at,
                                skin->first_tree_node,
                                hidden ? 0 : skin->tree_nodes,
                                skin->first_box,
                                skin->target_count ? morphs : 0};
    memcpy(to + sizeof header * index, header, sizeof header);
    uint32_t count = 0;
    for (uint32_t t = 0; t < skin->target_count; t++) { /* those that do anything */
        uint32_t target[4] = {2 * plan->scene.skin_vertices + skin->first_delta +
                              t * skin->vertex_count};
        if (weights[skin->first_weight + t] == 0.0f) continue;
        memcpy(&target[1], &weights[skin->first_weight + t], sizeof target[1]);
        memcpy(to + (size_t)16 * (morphs + 1 + count++), target, sizeof target);
    }
    if (skin->target_count) memcpy(to + (size_t)16 * morphs, (uint32_t[4]){count}, 16);
    memcpy(to + (size_t)16 * at, matrices[skin->first_matrix], (size_t)48 * skin->joint_count);
}

void masu_skins_write(masu_skins *s, const masu_instances *in, const masu_frame_data *f) {
    const masu_frame_plan *plan = f->plan;
    if (!plan->scene.skins || !in->dirty_count) return;
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_JOINTS);
    uint64_t half = masu_joints_bytes(&plan->scene);
    for (uint32_t i = 0; i < plan->scene.skins; i++) {
        const masu_skin *skin = &s->skins[i];
        if (!masu_instance_dirty(in, skin->instance)) continue;
        int hidden = masu_instance_hidden(in, skin->instance) != 0;
        write_one(skin, i, hidden, plan, s->now, s->weights, to);
        if (!plan->needs.velocity) continue;
        int comes = f->cut || in->flags[skin->instance] & MASU_INSTANCE_COMES;
        write_one(skin, i, hidden, plan, comes ? s->now : s->previous,
                  comes ? s->weights : s->before, to + half);
        memcpy(s->previous[skin->first_matrix], s->now[skin->first_matrix],
               skin->joint_count * sizeof *s->now);
        if (skin->target_count)
            memcpy(s->before + skin->first_weight, s->weights + skin->first_weight,
                   skin->target_count * sizeof *s->weights);
    }
}
