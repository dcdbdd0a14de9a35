/* check_skin.c: validates clips of models and skinned meshes. Ranges of clips, channels and joints
 * continue those of the previous element, or are shared with an earlier skin, so that work is
 * linear in the blob's size. */
#include "scene/check.h"
#include "scene/skin.h"
#include "shared/masu_shared.h"

/* ---- Clips ----------------------------------------------------------------------------------- */

/* Whether two consecutive channels of a clip are sorted by node, path and target, without
 * duplicates. */
static int in_order(const masu_blob_channel *c, const masu_blob_channel *before) {
    if (before->node != c->node) return before->node < c->node;
    return before->path < c->path || (before->path == c->path && before->target < c->target);
}

/* The target of a weight channel must exist in the skin of its node. */
static const char *wrong_target(const reader *r, const masu_blob_model *m,
                                const masu_blob_channel *c) {
    if (c->path != MASU_CHANNEL_WEIGHT)
        return c->target ? "has a morph target, but no weight" : NULL;
    uint32_t skin = r->view.model_nodes[m->first_node + c->node].skin;
    if (!skin || skin > r->counts[MASU_BLOB_SKINS] ||
        c->target >= r->view.skins[skin - 1].target_count)
        return "is of a morph target that its node lacks";
    return NULL;
}

static masu_result check_channels(reader *r, const masu_blob_clip *clip, uint64_t *next_key) {
    const masu_scene_view *v = &r->view;
    for (uint64_t c = clip->first_channel; c < (uint64_t)clip->first_channel + clip->channel_count;
         c++) {
        const masu_blob_channel *channel = &v->channels[c];
        const char *wrong = masu_wrong_channel(channel, v->models[clip->model].node_count, v->keys,
                                               r->counts[MASU_BLOB_KEYS], *next_key);
        if (!wrong) wrong = wrong_target(r, &v->models[clip->model], channel);
        if (!wrong && c > clip->first_channel && !in_order(channel, channel - 1))
            wrong = "is not sorted by node and path";
        if (wrong) return bad(r, "channels", c, wrong);
        *next_key += channel->key_count;
    }
    return MASU_OK;
}

masu_result masu_check_clips(reader *r) {
    const masu_scene_view *v = &r->view;
    uint64_t clips = r->counts[MASU_BLOB_CLIPS], channels = r->counts[MASU_BLOB_CHANNELS];
    uint64_t keys = r->counts[MASU_BLOB_KEYS], next = 0, next_key = 0;
    if (!clips != !channels || !clips != !keys)
        return bad(r, "clips", 0, "are there without channels or keys, or these alone");
    for (uint64_t i = 0; i < clips; i++) {
        const masu_blob_clip *clip = &v->clips[i];
        if (clip->model >= r->counts[MASU_BLOB_MODELS]) return bad(r, "clips", i, "no such model");
        if (v->models[clip->model].like != clip->model)
            return bad(r, "clips", i, "is of a model that is not the first of its kind");
        if (i && clip->model < clip[-1].model) return bad(r, "clips", i, "is not sorted by model");
        if (!name_ok(r, clip->name)) return bad(r, "clips", i, "name lies outside the names");
        if (!within(&clip->duration, 1, 0.0f, MASU_CLIP_SECONDS_MAX))
            return bad(r, "clips", i, "duration is not 0 to 1e9 s");
        if (clip->first_channel != next || clip->channel_count > channels - next)
            return bad(r, "clips", i, "channels are not the next of the channels");
        masu_result result = check_channels(r, clip, &next_key);
        if (result) return result;
        next += clip->channel_count;
    }
    if (next != channels) return bad(r, "channels", next, "belongs to no clip");
    return next_key == keys ? MASU_OK : bad(r, "keys", next_key, "belongs to no channel");
}

/* ---- Skins ----------------------------------------------------------------------------------- */

/* Ends of the ranges that skins have used so far: in SKIN_VERTICES, JOINTS, MORPH_TARGETS,
 * MORPH_DELTAS and VERTICES; and the number of joints of all skins. */
typedef struct given {
    uint64_t vertices, joints, skinned, slots, targets, deltas;
} given;

/* The mesh of a skin must not be used by another instance, and its primitives must be within the
 * skin's vertices. */
static masu_result check_mesh(reader *r, uint64_t i) {
    const masu_scene_view *v = &r->view;
    const masu_blob_skin *s = &v->skins[i];
    uint32_t instance = v->model_nodes[s->node].instance, mesh = v->instances[instance].mesh;
    const masu_blob_mesh *m = &v->meshes[mesh];
    int shared = (instance && v->instances[instance - 1].mesh == mesh) ||
                 (instance + (uint64_t)1 < r->counts[MASU_BLOB_INSTANCES] &&
                  v->instances[instance + 1].mesh == mesh);
    if (shared) return bad(r, "skins", i, "bends a mesh of several instances");
    for (uint32_t k = 0; k < m->primitive_count; k++) {
        const masu_blob_primitive *p = &v->primitives[m->first_primitive + k];
        if (p->first_vertex < s->first_vertex ||
            (uint64_t)p->first_vertex + p->vertex_count >
                (uint64_t)s->first_vertex + s->vertex_count)
            return bad(r, "skins", i, "has a primitive outside its vertices");
    }
    return MASU_OK;
}

/* Validates morph targets that no earlier skin has: every delta is in the box of its target. */
static masu_result check_targets(reader *r, const masu_blob_skin *s) {
    const masu_scene_view *v = &r->view;
    for (uint32_t t = 0; t < s->target_count; t++) {
        const masu_blob_morph_target *target = &v->morph_targets[s->first_target + t];
        const char *wrong = masu_wrong_morph_target(
            target, v->morph_deltas + s->first_delta + (uint64_t)t * s->vertex_count,
            s->vertex_count);
        if (!wrong && !name_ok(r, target->name)) wrong = "name lies outside the names";
        if (wrong) return bad(r, "morph targets", (uint64_t)s->first_target + t, wrong);
    }
    return MASU_OK;
}

/* Validates joints and vertices that no earlier skin has. */
static masu_result check_own(reader *r, uint64_t i) {
    const masu_scene_view *v = &r->view;
    const masu_blob_skin *s = &v->skins[i];
    for (uint32_t k = 0; k < s->joint_count; k++) {
        const char *wrong =
            masu_wrong_joint(&v->joints[s->first_joint + k], v->models[s->model].node_count);
        if (wrong) return bad(r, "joints", (uint64_t)s->first_joint + k, wrong);
    }
    for (uint32_t k = 0; k < s->vertex_count; k++) {
        const char *wrong = masu_wrong_skin_vertex(&v->skin_vertices[s->first_skin_vertex + k],
                                                   v->joints + s->first_joint, s->joint_count);
        if (wrong) return bad(r, "skin vertices", (uint64_t)s->first_skin_vertex + k, wrong);
    }
    return check_targets(r, s);
}

static masu_result check_ranges(reader *r, uint64_t i, given *g) {
    const masu_scene_view *v = &r->view;
    const masu_blob_skin *s = &v->skins[i];
    uint64_t vertices = r->counts[MASU_BLOB_VERTICES];
    if (!s->vertex_count || (i && s->first_vertex != g->skinned) || s->first_vertex > vertices ||
        s->vertex_count > vertices - s->first_vertex)
        return bad(r, "skins", i, "vertices are none, or not the next of the vertices");
    g->skinned = (uint64_t)s->first_vertex + s->vertex_count;
    g->slots += s->joint_count;
    if (!s->joint_count || s->joint_count > 65536 || g->slots > MASU_BLOB_SKIN_JOINTS_MAX)
        return bad(r, "skins", i, "has no joints, or too many");
    if (s->like < i) {
        const masu_blob_skin *like = &v->skins[s->like];
        int same = like->like == s->like && like->vertex_count == s->vertex_count &&
                   like->first_skin_vertex == s->first_skin_vertex &&
                   like->first_joint == s->first_joint && like->joint_count == s->joint_count &&
                   like->first_target == s->first_target && like->target_count == s->target_count &&
                   like->first_delta == s->first_delta &&
                   v->models[like->model].like == v->models[s->model].like;
        return same ? MASU_OK : bad(r, "skins", i, "is not like the skin that it says");
    }
    if (s->like > i || s->first_skin_vertex != g->vertices || s->first_joint != g->joints ||
        s->vertex_count > r->counts[MASU_BLOB_SKIN_VERTICES] - g->vertices ||
        s->joint_count > r->counts[MASU_BLOB_JOINTS] - g->joints)
        return bad(r, "skins", i, "joints or vertices are not the next of theirs");
    uint64_t deltas = (uint64_t)s->vertex_count * s->target_count;
    if (s->target_count > MASU_BLOB_MORPH_TARGETS_MAX || s->first_target != g->targets ||
        s->first_delta != g->deltas ||
        s->target_count > r->counts[MASU_BLOB_MORPH_TARGETS] - g->targets ||
        deltas > r->counts[MASU_BLOB_MORPH_DELTAS] - g->deltas)
        return bad(r, "skins", i,
                   "morph targets or their deltas are too many, or not the next of theirs");
    g->vertices += s->vertex_count;
    g->joints += s->joint_count;
    g->targets += s->target_count;
    g->deltas += deltas;
    return check_own(r, i);
}

/* Occluders and LODs are valid only for rigid meshes. */
static masu_result check_stiff(reader *r) {
    const masu_scene_view *v = &r->view;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_LODS] + r->counts[MASU_BLOB_OCCLUDERS]; i++) {
        uint64_t o = i - r->counts[MASU_BLOB_LODS];
        int lod = i < r->counts[MASU_BLOB_LODS];
        const masu_blob_mesh *m = &v->meshes[lod ? v->lods[i].mesh : v->occluders[o].mesh];
        if (!m->primitive_count) continue;
        uint32_t first = v->primitives[m->first_primitive].first_vertex;
        if (first >= v->skins[0].first_vertex)
            return bad(r, lod ? "lods" : "occluders", lod ? i : o, "is of a mesh that bends");
    }
    return MASU_OK;
}

masu_result masu_check_skins(reader *r) {
    const masu_scene_view *v = &r->view;
    uint64_t skins = r->counts[MASU_BLOB_SKINS], joints = r->counts[MASU_BLOB_JOINTS], bent = 0;
    uint64_t vertices = r->counts[MASU_BLOB_SKIN_VERTICES];
    given g = {0, 0, 0, 0, 0, 0};
    if (!skins != !joints || !skins != !vertices)
        return bad(r, "skins", 0, "are there without joints or vertices, or these alone");
    for (uint64_t n = 0; n < r->counts[MASU_BLOB_MODEL_NODES]; n++)
        bent += v->model_nodes[n].skin != 0;
    for (uint64_t i = 0; i < skins; i++) {
        const masu_blob_skin *s = &v->skins[i];
        if (s->model >= r->counts[MASU_BLOB_MODELS]) return bad(r, "skins", i, "no such model");
        if (i && s->model < s[-1].model) return bad(r, "skins", i, "is not sorted by model");
        const masu_blob_model *m = &v->models[s->model];
        if (s->node < m->first_node || s->node - m->first_node >= m->node_count ||
            v->model_nodes[s->node].skin != i + 1 ||
            v->model_nodes[s->node].instance == MASU_BLOB_NONE)
            return bad(r, "skins", i, "is shown by no node of its model");
        masu_result result = check_ranges(r, i, &g);
        if (!result) result = check_mesh(r, i);
        if (result) return result;
    }
    if (bent != skins) return bad(r, "model nodes", 0, "share a skin");
    if (g.vertices != vertices) return bad(r, "skin vertices", g.vertices, "belongs to no skin");
    if (g.joints != joints) return bad(r, "joints", g.joints, "belongs to no skin");
    if (g.targets != r->counts[MASU_BLOB_MORPH_TARGETS])
        return bad(r, "morph targets", g.targets, "belongs to no skin");
    if (g.deltas != r->counts[MASU_BLOB_MORPH_DELTAS])
        return bad(r, "morph deltas", g.deltas, "belongs to no target");
    if (skins && g.skinned != r->counts[MASU_BLOB_VERTICES])
        return bad(r, "vertices", g.skinned, "follows those of skins");
    return skins ? check_stiff(r) : MASU_OK;
}

masu_result masu_check_skin_trees(reader *r) {
    const masu_scene_view *v = &r->view;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_SKINS] && v->trace_meshes; i++) {
        uint32_t mesh = v->instances[v->model_nodes[v->skins[i].node].instance].mesh;
        if (v->trace_meshes[mesh].node_count > 64u * MASU_SKIN_ROUNDS)
            return bad(r, "skins", i, "has a tree of over 262,144 nodes");
    }
    return MASU_OK;
}

void masu_describe_skins(const reader *r, masu_scene_data *out) {
    const masu_scene_view *v = &r->view;
    out->clips = (uint32_t)r->counts[MASU_BLOB_CLIPS];
    out->channels = (uint32_t)r->counts[MASU_BLOB_CHANNELS];
    out->keys = (uint32_t)r->counts[MASU_BLOB_KEYS];
    out->skins = (uint32_t)r->counts[MASU_BLOB_SKINS];
    out->skin_vertices = (uint32_t)r->counts[MASU_BLOB_SKIN_VERTICES];
    out->joints = (uint32_t)r->counts[MASU_BLOB_JOINTS];
    out->morph_targets = (uint32_t)r->counts[MASU_BLOB_MORPH_TARGETS];
    out->morph_deltas = (uint32_t)r->counts[MASU_BLOB_MORPH_DELTAS];
    for (uint32_t i = 0; i < out->models; i++) {
        if (v->models[i].node_count > out->max_nodes) out->max_nodes = v->models[i].node_count;
    }
    for (uint32_t i = 0; i < out->skins; i++) {
        const masu_blob_skin *s = &v->skins[i];
        uint32_t mesh = v->instances[v->model_nodes[s->node].instance].mesh;
        if (v->trace_meshes) out->skinned_nodes += v->trace_meshes[mesh].node_count;
        if (!i) out->first_skinned = s->first_vertex;
        out->skinned_vertices += s->vertex_count;
        out->skinned_joints += s->joint_count;
        out->skin_targets += s->target_count;
        if (s->vertex_count > out->max_skinned) out->max_skinned = s->vertex_count;
    }
}
