/* skin.c: see skin.h. */
#include "bake/scene/skin.h"

#include <stdlib.h>
#include <string.h>

#define MODELS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_MODELS, masu_blob_model)
#define NODES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_MODEL_NODES, masu_blob_model_node)
#define SKINS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_SKINS, masu_blob_skin)

static void *elements(const masu_bake_content *c, uint32_t kind, uint64_t first) {
    return c->section[kind].data + (size_t)first * masu_bake_stride(kind);
}

/* Appends a copy of elements of a section, which may be of the same content. Returns the first new
 * index. */
static uint32_t copy_range(masu_bake_content *to, const masu_bake_content *from, uint32_t kind,
                           uint32_t first, uint32_t count) {
    uint32_t made = (uint32_t)masu_bake_count(to, kind);
    if (!count) return made;
    masu_bake_append(&to->section[kind], NULL, (size_t)count * masu_bake_stride(kind));
    memcpy(elements(to, kind, made), elements(from, kind, first),
           (size_t)count * masu_bake_stride(kind));
    return made;
}

/* ---- Skins ----------------------------------------------------------------------------------- */

static bool is_taken(const masu_bake_content *content, uint32_t first_vertex) {
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_SKINS); i++) {
        if (SKINS(content)[i].first_vertex == first_vertex) return true;
    }
    return false;
}

/* A mesh with the same triangles that shares no data with the first. */
static uint32_t copy_mesh(masu_bake_content *c, uint32_t mesh, uint32_t first_vertex,
                          uint32_t vertex_count) {
    masu_blob_mesh made = MASU_BAKE_MESHES(c)[mesh];
    uint32_t vertices = copy_range(c, c, MASU_BLOB_VERTICES, first_vertex, vertex_count);
    copy_range(c, c, MASU_BLOB_TEXCOORDS, first_vertex, vertex_count);
    masu_bake_copy_attributes(c, c, first_vertex, vertex_count);
    made.first_primitive =
        copy_range(c, c, MASU_BLOB_PRIMITIVES, made.first_primitive, made.primitive_count);
    for (uint32_t k = 0; k < made.primitive_count; k++) {
        masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[made.first_primitive + k];
        p->first_vertex = p->first_vertex - first_vertex + vertices;
        p->first_index = copy_range(c, c, MASU_BLOB_INDICES, p->first_index, p->index_count);
    }
    masu_bake_append(&c->section[MASU_BLOB_MESHES], &made, sizeof made);
    return (uint32_t)masu_bake_count(c, MASU_BLOB_MESHES) - 1;
}

/* The index of a model's skin number `skin`. */
static uint32_t skin_of(const masu_bake_content *content, uint32_t model, uint32_t skin) {
    uint32_t at = 0;
    while (SKINS(content)[at].model != model) at++;
    return at + skin;
}

void masu_bake_add_skins(masu_bake_content *content, const masu_bake_content *piece,
                         uint32_t model) {
    const masu_blob_model *m = &MODELS(content)[model];
    for (uint32_t k = 0; k < masu_bake_count(piece, MASU_BLOB_SKINS); k++) {
        masu_blob_skin skin = SKINS(piece)[k];
        uint32_t made = (uint32_t)masu_bake_count(content, MASU_BLOB_SKINS);
        skin.model = model;
        skin.node += m->first_node;
        masu_blob_model_node *node = &NODES(content)[skin.node];
        masu_blob_instance *instance = &MASU_BAKE_INSTANCES(content)[node->instance];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[instance->mesh];
        skin.first_vertex = MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive].first_vertex;
        if (is_taken(content, skin.first_vertex)) {
            instance->mesh =
                copy_mesh(content, instance->mesh, skin.first_vertex, skin.vertex_count);
            mesh = &MASU_BAKE_MESHES(content)[instance->mesh];
            skin.first_vertex = MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive].first_vertex;
        }
        skin.like = made;
        if (m->like == model) {
            skin.first_joint = copy_range(content, piece, MASU_BLOB_JOINTS, skin.first_joint,
                                          skin.joint_count);
            skin.first_skin_vertex = copy_range(content, piece, MASU_BLOB_SKIN_VERTICES,
                                                skin.first_skin_vertex, skin.vertex_count);
            uint32_t first_target = skin.first_target;
            skin.first_target = copy_range(content, piece, MASU_BLOB_MORPH_TARGETS, first_target,
                                           skin.target_count);
            for (uint32_t t = 0; t < skin.target_count; t++) {
                const char *text = masu_bake_name_text(
                    piece, MASU_BAKE_ARRAY(piece, MASU_BLOB_MORPH_TARGETS,
                                           masu_blob_morph_target)[first_target + t]
                               .name);
                MASU_BAKE_ARRAY(content, MASU_BLOB_MORPH_TARGETS, masu_blob_morph_target)
                [skin.first_target + t].name = masu_bake_name(content, text, strlen(text));
            }
            skin.first_delta = copy_range(content, piece, MASU_BLOB_MORPH_DELTAS, skin.first_delta,
                                          skin.vertex_count * skin.target_count);
        } else {
            skin.like = skin_of(content, m->like, k);
            skin.first_joint = SKINS(content)[skin.like].first_joint;
            skin.first_skin_vertex = SKINS(content)[skin.like].first_skin_vertex;
            skin.first_target = SKINS(content)[skin.like].first_target;
            skin.first_delta = SKINS(content)[skin.like].first_delta;
        }
        node->skin = made + 1;
        masu_bake_append(&content->section[MASU_BLOB_SKINS], &skin, sizeof skin);
    }
}

bool masu_bake_is_skinned(const masu_bake_content *content, uint32_t mesh) {
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_SKINS); i++) {
        uint32_t instance = NODES(content)[SKINS(content)[i].node].instance;
        if (MASU_BAKE_INSTANCES(content)[instance].mesh == mesh) return true;
    }
    return false;
}

/* ---- Clips ----------------------------------------------------------------------------------- */

void masu_bake_add_clips(masu_bake_content *content, const masu_bake_content *piece,
                         uint32_t model) {
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_CLIPS); i++) {
        masu_blob_clip clip = MASU_BAKE_ARRAY(piece, MASU_BLOB_CLIPS, masu_blob_clip)[i];
        const char *text = masu_bake_name_text(piece, clip.name);
        clip.name = masu_bake_name(content, text, strlen(text));
        clip.model = model;
        clip.first_channel = copy_range(content, piece, MASU_BLOB_CHANNELS, clip.first_channel,
                                        clip.channel_count);
        for (uint32_t c = 0; c < clip.channel_count; c++) {
            masu_blob_channel *channel = &MASU_BAKE_ARRAY(
                content, MASU_BLOB_CHANNELS, masu_blob_channel)[clip.first_channel + c];
            channel->first_key = copy_range(content, piece, MASU_BLOB_KEYS, channel->first_key,
                                            channel->key_count);
        }
        masu_bake_append(&content->section[MASU_BLOB_CLIPS], &clip, sizeof clip);
    }
}

/* ---- The order of vertices ------------------------------------------------------------------- */

static void reorder(masu_bake_buffer *section, const uint32_t *place, uint64_t count,
                    uint32_t stride) {
    if (section->bytes != count * stride) return; /* there are no texture coordinates */
    unsigned char *sorted = masu_bake_allocate(section->bytes);
    for (uint64_t i = 0; i < count; i++)
        memcpy(sorted + (size_t)place[i] * stride, section->data + i * stride, stride);
    memcpy(section->data, sorted, section->bytes);
    free(sorted);
}

void masu_bake_gather_skins(masu_bake_content *content) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_VERTICES);
    uint64_t skins = masu_bake_count(content, MASU_BLOB_SKINS), next = count;
    if (!skins) return;
    uint32_t *place = masu_bake_allocate((size_t)count * sizeof *place);
    memset(place, 0xFF, (size_t)count * sizeof *place);
    for (uint64_t i = 0; i < skins; i++) next -= SKINS(content)[i].vertex_count;
    for (uint64_t i = 0; i < skins; i++) {
        masu_blob_skin *skin = &SKINS(content)[i];
        for (uint32_t k = 0; k < skin->vertex_count; k++)
            place[skin->first_vertex + k] = (uint32_t)(next + k);
        skin->first_vertex = (uint32_t)next;
        next += skin->vertex_count;
    }
    uint32_t free_place = 0;
    for (uint64_t i = 0; i < count; i++) {
        if (place[i] == MASU_BLOB_NONE) place[i] = free_place++;
    }
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_PRIMITIVES); i++) {
        masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[i];
        p->first_vertex = place[p->first_vertex];
    }
    reorder(&content->section[MASU_BLOB_VERTICES], place, count, sizeof(masu_blob_vertex));
    reorder(&content->section[MASU_BLOB_TEXCOORDS], place, count, 2 * sizeof(float));
    masu_bake_pad_attributes(content);
    reorder(&content->section[MASU_BLOB_COLORS], place, count, sizeof(uint32_t));
    reorder(&content->section[MASU_BLOB_TEXCOORDS_1], place, count, 2 * sizeof(float));
    free(place);
}
