/* check.c: checks data from another process before any of its indices is used. It applies the rules
 * of blob.h for geometry, instances and materials; the runtime's own reader, masu_scene_bind,
 * checks the finished scene. */
#include "bake/scene/check.h"
#include "bake/scene/camera.h"
#include "bake/scene/sun.h"
#include "scene/punctual_light.h"
#include "scene/skin.h"

static bool finite_all(const float *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i])) return false;
    }
    return true;
}

static bool in_range(const float *values, size_t count, float low, float high) {
    for (size_t i = 0; i < count; i++) {
        if (!(values[i] >= low && values[i] <= high)) return false;
    }
    return true;
}

static bool name_ok(const masu_bake_content *c, uint32_t name) {
    return name == MASU_BLOB_NONE || name < c->section[MASU_BLOB_NAMES].bytes;
}

/* True if [first, first + count) is within [0, total) and not empty. */
static bool range_ok(uint32_t first, uint32_t count, uint64_t total) {
    return count > 0 && (uint64_t)first + count <= total;
}

static const char *check_sections(const masu_bake_content *c) {
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        if (!masu_bake_stride(kind)) continue; /* no such section */
        if (c->section[kind].bytes % masu_bake_stride(kind))
            return "a section with half an element";
        if (masu_bake_count(c, kind) > INT32_MAX) return "a section of 2^31 elements or more";
    }
    const masu_bake_buffer *names = &c->section[MASU_BLOB_NAMES];
    if (names->bytes && names->data[names->bytes - 1] != 0) return "names that do not end";
    return NULL;
}

static const char *check_primitive(const masu_bake_content *c, const masu_blob_primitive *p) {
    if (!range_ok(p->first_index, p->index_count, masu_bake_count(c, MASU_BLOB_INDICES)) ||
        p->index_count % 3 ||
        !range_ok(p->first_vertex, p->vertex_count, masu_bake_count(c, MASU_BLOB_VERTICES)) ||
        p->vertex_count > 16777215u || p->material >= masu_bake_count(c, MASU_BLOB_MATERIALS)) {
        return "a primitive with a range outside the geometry";
    }
    for (uint32_t i = 0; i < p->index_count; i++) {
        if (MASU_BAKE_INDICES(c)[p->first_index + i] >= p->vertex_count) {
            return "an index beyond its primitive's vertices";
        }
    }
    for (uint32_t i = 0; i < p->vertex_count; i++) {
        const float *v = MASU_BAKE_VERTICES(c)[p->first_vertex + i].position;
        for (int k = 0; k < 3; k++) {
            if (!(v[k] >= p->aabb_min[k] && v[k] <= p->aabb_max[k])) {
                return "a vertex outside its primitive's box";
            }
        }
    }
    return NULL;
}

static const char *check_geometry(const masu_bake_content *c) {
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_VERTICES); i++) {
        const masu_blob_vertex *v = &MASU_BAKE_VERTICES(c)[i];
        if (!finite_all(v->position, 3)) return "a vertex that is not finite";
        if (v->normal[0] == INT16_MIN || v->normal[1] == INT16_MIN) return "a normal out of range";
    }
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_PRIMITIVES); i++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[i];
        if (!finite_all(p->aabb_min, 3) || !finite_all(p->aabb_max, 3)) {
            return "a primitive whose box is not finite";
        }
        const char *problem = check_primitive(c, p);
        if (problem) return problem;
    }
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_MESHES); i++) {
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(c)[i];
        if (!range_ok(m->first_primitive, m->primitive_count,
                      masu_bake_count(c, MASU_BLOB_PRIMITIVES))) {
            return "a mesh with a range outside the primitives";
        }
        if (!name_ok(c, m->name)) return "a name out of range";
        for (uint32_t j = 0; j < m->primitive_count; j++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[m->first_primitive + j];
            for (int k = 0; k < 3; k++) {
                if (!(m->aabb_min[k] <= p->aabb_min[k] && m->aabb_max[k] >= p->aabb_max[k])) {
                    return "a primitive outside its mesh's box";
                }
            }
        }
    }
    return NULL;
}

static const char *check_instances(const masu_bake_content *c) {
    uint64_t count = masu_bake_count(c, MASU_BLOB_INSTANCES);
    for (uint64_t i = 0; i < count; i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(c)[i];
        if (!finite_all(n->transform, 12)) return "an instance whose transform is not finite";
        if (n->mesh >= masu_bake_count(c, MASU_BLOB_MESHES)) return "an instance of no mesh";
        if (n->parent != MASU_BLOB_NONE && n->parent >= count) return "a parent out of range";
        if (n->group != MASU_BLOB_NONE) return "an instance in a group that is not there";
        if (!name_ok(c, n->name)) return "a name out of range";
    }
    return NULL;
}

/* Images and maps. They are not part of the blob, so no other code checks them. */
static const char *check_maps(const masu_bake_content *c) {
    uint64_t materials = masu_bake_count(c, MASU_BLOB_MATERIALS);
    size_t images = c->images.bytes / sizeof(masu_bake_image);
    if (c->maps.bytes != materials * sizeof(masu_bake_maps) ||
        c->images.bytes != images * sizeof(masu_bake_image)) {
        return "maps of other materials";
    }
    if (c->image_text.bytes && c->image_text.data[c->image_text.bytes - 1] != 0) {
        return "picture names that do not end";
    }
    for (size_t i = 0; i < images; i++) {
        const masu_bake_image *image = &MASU_BAKE_IMAGES(c)[i];
        if (image->name >= c->image_text.bytes || image->data > c->image_data.bytes ||
            image->data_bytes > c->image_data.bytes - image->data) {
            return "a picture out of range";
        }
        if ((uint64_t)image->raw_width * image->raw_height > image->data_bytes / 4) {
            return "a picture of too few texels";
        }
    }
    for (uint64_t i = 0; i < materials; i++) {
        const masu_bake_maps *m = &MASU_BAKE_MAPS_OF(c)[i];
        for (int k = 0; k < MASU_BAKE_MAPS; k++) {
            if ((m->image[k] != MASU_BLOB_NONE && m->image[k] >= images) || m->channel[k] > 3) {
                return "a map of no picture";
            }
        }
        if (m->gloss > 1 || m->additive > 1 || m->single > 1 ||
            m->colored > MASU_BAKE_COLORED_ALPHA || m->second > MASU_MATERIAL_HAS_MAPS ||
            m->alpha > MASU_BAKE_ALPHA_COVERS || m->relief > 2 || m->nearest > 1 ||
            m->transmission > 1 || !in_range(&m->coat_scale, 1, -16, 16) || m->wrap[0] > 3 ||
            m->wrap[1] > 3 || !in_range(&m->cutoff, 1, 0, 1) ||
            !in_range(&m->normal_scale, 1, -16, 16) || !in_range(&m->occlusion, 1, 0, 1)) {
            return "a map out of range";
        }
    }
    if (masu_bake_count(c, MASU_BLOB_TEXCOORDS) != masu_bake_count(c, MASU_BLOB_VERTICES)) {
        return "not as many texture coordinates as vertices";
    }
    if (masu_bake_count(c, MASU_BLOB_COLORS) > masu_bake_count(c, MASU_BLOB_VERTICES) ||
        masu_bake_count(c, MASU_BLOB_TEXCOORDS_1) > masu_bake_count(c, MASU_BLOB_VERTICES))
        return "more colours or texture coordinates than vertices";
    if (!in_range(MASU_BAKE_ARRAY(c, MASU_BLOB_TEXCOORDS_1, const float),
                  (size_t)(2 * masu_bake_count(c, MASU_BLOB_TEXCOORDS_1)), -MASU_TEXCOORD_MAX,
                  MASU_TEXCOORD_MAX))
        return "texture coordinates out of range";
    const float *texcoords = MASU_BAKE_ARRAY(c, MASU_BLOB_TEXCOORDS, const float);
    if (!in_range(texcoords, (size_t)(2 * masu_bake_count(c, MASU_BLOB_TEXCOORDS)),
                  -MASU_TEXCOORD_MAX, MASU_TEXCOORD_MAX)) {
        return "texture coordinates out of range";
    }
    return NULL;
}

static const char *check_materials(const masu_bake_content *c) {
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_MATERIALS); i++) {
        const masu_blob_material *m = &MASU_BAKE_MATERIALS(c)[i];
        if (!in_range(m->base_color, 3, 0, 1) || !in_range(&m->roughness, 1, 0, 1) ||
            !in_range(&m->metallic, 1, 0, 1) || !in_range(m->emissive, 3, 0, 1e9f)) {
            return "a material out of range";
        }
        if (!name_ok(c, m->name)) return "a name out of range";
        if (m->flags || m->texture_set || m->layers) return "a material with textures already";
    }
    return NULL;
}

static const char *check_lights(const masu_bake_content *c) {
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_LIGHTS); i++) {
        const masu_blob_light *light = &MASU_BAKE_LIGHTS(c)[i];
        double value;
        masu_punctual_light_state state = masu_light_state_of(light);
        if ((light->type & MASU_LIGHT_TYPE) > MASU_LIGHT_RECTANGLE ||
            masu_light_state_wrong(&state, &value))
            return "a light with a value out of range";
        if (light->parent != MASU_BLOB_NONE &&
            light->parent >= masu_bake_count(c, MASU_BLOB_INSTANCES)) {
            return "a light of no instance";
        }
        if (!name_ok(c, light->name)) return "a name out of range";
    }
    return NULL;
}

/* ---- Animated models: nodes, clips, skins ---- */

static const char *check_nodes(const masu_bake_content *c) {
    const masu_blob_model_node *nodes =
        MASU_BAKE_ARRAY(c, MASU_BLOB_MODEL_NODES, const masu_blob_model_node);
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_MODEL_NODES); i++) {
        if (!finite_all(nodes[i].local, 12)) return "a node whose transform is not finite";
        if (nodes[i].parent != MASU_BLOB_NONE && nodes[i].parent >= i)
            return "a node before the one above it";
        if (nodes[i].instance != MASU_BLOB_NONE &&
            nodes[i].instance >= masu_bake_count(c, MASU_BLOB_INSTANCES))
            return "a node of no instance";
        if (!name_ok(c, nodes[i].name)) return "a name out of range";
    }
    return NULL;
}

static const char *check_clips(const masu_bake_content *c) {
    const masu_blob_clip *clips = MASU_BAKE_ARRAY(c, MASU_BLOB_CLIPS, const masu_blob_clip);
    const masu_blob_channel *channels =
        MASU_BAKE_ARRAY(c, MASU_BLOB_CHANNELS, const masu_blob_channel);
    uint64_t next = 0, next_key = 0;
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_CLIPS); i++) {
        if (clips[i].first_channel != next ||
            clips[i].channel_count > masu_bake_count(c, MASU_BLOB_CHANNELS) - next ||
            !in_range(&clips[i].duration, 1, 0, MASU_CLIP_SECONDS_MAX) ||
            !name_ok(c, clips[i].name)) {
            return "a clip out of range";
        }
        for (uint64_t end = next + clips[i].channel_count; next < end; next++) {
            if (masu_wrong_channel(
                    &channels[next], (uint32_t)masu_bake_count(c, MASU_BLOB_MODEL_NODES),
                    MASU_BAKE_ARRAY(c, MASU_BLOB_KEYS, const masu_blob_key),
                    masu_bake_count(c, MASU_BLOB_KEYS), next_key))
                return "a channel out of range";
            next_key += channels[next].key_count;
        }
    }
    return next == masu_bake_count(c, MASU_BLOB_CHANNELS) ? NULL : "channels of no clip";
}

/* The skin's node shows a mesh that uses all of the skin's vertices and no others. */
static const char *check_skin(const masu_bake_content *c, const masu_blob_skin *s) {
    const masu_blob_model_node *nodes =
        MASU_BAKE_ARRAY(c, MASU_BLOB_MODEL_NODES, const masu_blob_model_node);
    if (s->node >= masu_bake_count(c, MASU_BLOB_MODEL_NODES) ||
        nodes[s->node].instance == MASU_BLOB_NONE)
        return "a skin that nothing shows";
    const masu_blob_mesh *m =
        &MASU_BAKE_MESHES(c)[MASU_BAKE_INSTANCES(c)[nodes[s->node].instance].mesh];
    uint64_t next = s->first_vertex;
    for (uint32_t k = 0; k < m->primitive_count; k++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[m->first_primitive + k];
        if (p->first_vertex != next) return "a skin of other vertices than its mesh";
        next += p->vertex_count;
    }
    if (next != (uint64_t)s->first_vertex + s->vertex_count)
        return "a skin of other vertices than its mesh";
    return NULL;
}

static const char *check_skins(const masu_bake_content *c) {
    const masu_blob_skin *skins = MASU_BAKE_ARRAY(c, MASU_BLOB_SKINS, const masu_blob_skin);
    const masu_blob_joint *joints = MASU_BAKE_ARRAY(c, MASU_BLOB_JOINTS, const masu_blob_joint);
    const masu_blob_skin_vertex *vertices =
        MASU_BAKE_ARRAY(c, MASU_BLOB_SKIN_VERTICES, const masu_blob_skin_vertex);
    uint64_t next_joint = 0, next = 0, next_target = 0, next_delta = 0;
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_SKINS); i++) {
        const masu_blob_skin *s = &skins[i];
        const char *problem = check_skin(c, s);
        if (problem) return problem;
        if (s->first_joint != next_joint || !s->joint_count || s->joint_count > 65536 ||
            s->joint_count > masu_bake_count(c, MASU_BLOB_JOINTS) - next_joint ||
            s->first_skin_vertex != next || !s->vertex_count ||
            s->vertex_count > masu_bake_count(c, MASU_BLOB_SKIN_VERTICES) - next) {
            return "a skin out of range";
        }
        for (uint32_t k = 0; k < s->joint_count; k++) {
            if (masu_wrong_joint(&joints[next_joint + k],
                                 (uint32_t)masu_bake_count(c, MASU_BLOB_MODEL_NODES)))
                return "a joint out of range";
        }
        for (uint32_t k = 0; k < s->vertex_count; k++) {
            if (masu_wrong_skin_vertex(&vertices[next + k], joints + next_joint, s->joint_count))
                return "a vertex that no joints move";
        }
        uint64_t deltas = (uint64_t)s->vertex_count * s->target_count;
        if (s->target_count > MASU_BLOB_MORPH_TARGETS_MAX ||
            (s->target_count && (s->first_target != next_target || s->first_delta != next_delta)) ||
            s->target_count > masu_bake_count(c, MASU_BLOB_MORPH_TARGETS) - next_target ||
            deltas > masu_bake_count(c, MASU_BLOB_MORPH_DELTAS) - next_delta)
            return "morph targets out of range";
        for (uint32_t t = 0; t < s->target_count; t++) {
            const masu_blob_morph_target *target = &MASU_BAKE_ARRAY(
                c, MASU_BLOB_MORPH_TARGETS, const masu_blob_morph_target)[next_target + t];
            const masu_blob_morph_delta *all =
                MASU_BAKE_ARRAY(c, MASU_BLOB_MORPH_DELTAS, const masu_blob_morph_delta) +
                next_delta;
            if (!name_ok(c, target->name) ||
                masu_wrong_morph_target(target, all + (size_t)t * s->vertex_count, s->vertex_count))
                return "a morph target out of range";
        }
        next_target += s->target_count;
        next_delta += deltas;
        next_joint += s->joint_count;
        next += s->vertex_count;
    }
    return NULL;
}

const char *masu_bake_check(const masu_bake_content *piece) {
    const char *problem = check_sections(piece);
    if (!problem) problem = check_materials(piece);
    if (!problem) problem = check_maps(piece);
    if (!problem) problem = check_geometry(piece);
    if (!problem) problem = check_instances(piece);
    if (!problem) problem = check_lights(piece);
    if (!problem) problem = check_nodes(piece);
    if (!problem) problem = check_clips(piece);
    if (!problem) problem = check_skins(piece);
    if (!problem) problem = masu_bake_check_cameras(piece);
    if (!problem) problem = masu_bake_check_suns(piece);
    return problem;
}
