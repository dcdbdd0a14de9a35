/* assimp_mesh.c: converts meshes and reports triangles that cannot be drawn; see assimp.h. */
#include "bake/import/assimp.h"
#include "bake/import/vertex_color.h"
#include "bake/mesh/triangles.h"

#include <assimp/material.h>
#include <stdlib.h>
#include <string.h>

static void note_loss(masu_import *m, int kind, uint64_t count, const struct aiMesh *mesh) {
    masu_import_loss *l = &m->losses[kind];
    if (count == 0) return;
    l->count += count;
    if (l->meshes++ >= MASU_IMPORT_NAMES_MAX) return;
    masu_bake_append_text(&l->names, l->meshes > 1 ? ", \"" : "\"");
    masu_import_name(&l->names, mesh->mName.data, masu_import_length(&mesh->mName));
    masu_bake_append_text(&l->names, "\"");
}

static void note_losses(masu_import *m, const struct aiMesh *mesh, const masu_bake_losses *lost) {
    m->triangles += lost->triangles;
    note_loss(m, MASU_LOST_INDEX, lost->bad_index, mesh);
    note_loss(m, MASU_LOST_POSITION, lost->bad_position, mesh);
    note_loss(m, MASU_LOST_AREA, lost->degenerate, mesh);
    note_loss(m, MASU_LOST_NORMAL, lost->bad_normals, mesh);
    note_loss(m, MASU_LOST_TEXCOORD, lost->bad_texcoords, mesh);
}

void masu_import_report_losses(masu_import *m) {
    static const char *const what[MASU_LOSSES] = {
        [MASU_LOST_INDEX] = "triangles skipped: an index is out of range",
        [MASU_LOST_POSITION] = "triangles skipped: a vertex is not finite",
        [MASU_LOST_AREA] = "triangles skipped: they have no area",
        [MASU_LOST_NORMAL] = "normals regenerated: they were invalid",
        [MASU_LOST_FACE] = "points and lines skipped",
        [MASU_LOST_TEXCOORD] = "texture coordinates set to 0: they were not finite or beyond 16384",
    };
    for (int kind = 0; kind < MASU_LOSSES; kind++) {
        masu_import_loss *l = &m->losses[kind];
        if (l->count == 0) continue;
        masu_bake_append(&l->names, "", 1);
        masu_import_format(m->warnings, "%llu ", (unsigned long long)l->count);
        if (kind != MASU_LOST_NORMAL && kind != MASU_LOST_TEXCOORD && kind != MASU_LOST_FACE) {
            masu_import_format(m->warnings, "of %llu ", (unsigned long long)m->triangles);
        }
        masu_import_format(m->warnings, "%s (in %u meshes: ", what[kind], l->meshes);
        masu_bake_append_text(m->warnings, (const char *)l->names.data);
        masu_bake_append_text(m->warnings, l->meshes > MASU_IMPORT_NAMES_MAX ? ", ...)\n" : ")\n");
        masu_bake_release(&l->names);
    }
}

/* KHR_texture_transform and its equivalents: scale, then translate; rotations cause a warning.
 * Assimp's v grows upwards. */
static bool texture_transform(const masu_import *m, const struct aiMesh *mesh,
                              struct aiUVTransform *out) {
    const struct aiScene *s = m->source;
    if (mesh->mMaterialIndex >= s->mNumMaterials || !s->mMaterials[mesh->mMaterialIndex]) {
        return false;
    }
    static const enum aiTextureType types[] = {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE};
    for (int i = 0; i < 2; i++) {
        if (aiGetMaterialUVTransform(s->mMaterials[mesh->mMaterialIndex],
                                     AI_MATKEY_UVTRANSFORM(types[i], 0), out) == aiReturn_SUCCESS) {
            return true;
        }
    }
    return false;
}

/* Two floats per vertex, v down the image, of the channel that the base colour uses; NULL if the
 * mesh has none. The caller frees it. */
static float *texcoords_of(masu_import *m, const struct aiMesh *mesh) {
    const struct aiScene *s = m->source;
    int channel = 0;
    unsigned count = 1;
    if (!m->given && mesh->mMaterialIndex < s->mNumMaterials &&
        s->mMaterials[mesh->mMaterialIndex]) {
        aiGetMaterialIntegerArray(s->mMaterials[mesh->mMaterialIndex],
                                  AI_MATKEY_UVWSRC(aiTextureType_BASE_COLOR, 0), &channel, &count);
    }
    if (channel < 0 || channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS ||
        !mesh->mTextureCoords[channel]) {
        channel = 0;
    }
    const struct aiVector3D *from = mesh->mTextureCoords[channel];
    if (!from) {
        m->unmapped++;
        return NULL;
    }
    struct aiUVTransform transform;
    bool moved = !m->given && texture_transform(m, mesh, &transform);
    if (moved && transform.mRotation != 0) m->turned++;
    float *out = masu_bake_allocate((size_t)mesh->mNumVertices * 2 * sizeof *out);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        double u = (double)from[i].x, v = (double)from[i].y;
        if (moved) {
            u = u * (double)transform.mScaling.x + (double)transform.mTranslation.x;
            v = v * (double)transform.mScaling.y + (double)transform.mTranslation.y;
        }
        out[2 * i] = (float)u;
        out[2 * i + 1] = (float)(m->given ? v : 1 - v);
    }
    return out;
}

/* Adds triangles of one material, times a colour (or NULL). */
static void add_part(masu_import *m, const struct aiMesh *mesh, bool bent,
                     masu_bake_triangles *part, const double *color, masu_bake_losses *lost) {
    part->material = masu_import_material(m, mesh->mMaterialIndex, color, part->colors != NULL);
    if (bent)
        masu_import_bent_mesh(m, mesh, part, lost);
    else if (!masu_bake_add_triangles(m->piece, part, lost))
        m->full = true;
}

/* Adds a part for each colour, or one with vertex colours. For glTF, gltf_mesh.c has done this. */
static void add_colored(masu_import *m, const struct aiMesh *mesh, bool bent,
                        const masu_bake_triangles *all, masu_bake_losses *lost) {
    masu_bake_pool pool = {0};
    masu_import_colors colors;
    uint32_t triangles = (uint32_t)(all->index_count / 3);
    float *linear = masu_bake_take(&pool, (size_t)mesh->mNumVertices * 4 * sizeof *linear);
    bool alpha = false;
    for (size_t i = 0; i < mesh->mNumVertices; i++) {
        const struct aiColor4D *c = &mesh->mColors[0][i];
        const ai_real rgb[3] = {c->r, c->g, c->b};
        for (int k = 0; k < 3; k++)
            linear[4 * i + (size_t)k] = (float)masu_import_decode_srgb((double)rgb[k]);
        linear[4 * i + 3] = 1;
        alpha = alpha || c->a < 0.999f;
    }
    m->translucent += alpha;
    masu_import_group_colors(&pool, linear, mesh->mNumVertices, all->indices, triangles, true,
                             &colors);
    m->clamped += colors.clamped;
    if (!colors.exact) {
        masu_bake_triangles part = *all;
        part.colors = linear;
        add_part(m, mesh, bent, &part, NULL, lost);
    }
    for (uint32_t g = 0; g < colors.count && !m->full; g++) {
        const masu_import_color *c = &colors.groups[g];
        masu_bake_buffer indices = {0};
        for (uint32_t i = 0; i < c->count; i++)
            masu_bake_append(&indices, all->indices + 3 * (size_t)colors.triangles[c->first + i],
                             3 * sizeof(uint32_t));
        masu_bake_triangles part = *all;
        part.indices = (const uint32_t *)(const void *)indices.data;
        part.index_count = 3 * (size_t)c->count;
        add_part(m, mesh, bent, &part, c->color, lost);
        masu_bake_release(&indices);
    }
    masu_bake_pool_release(&pool);
}

static const float *second_texcoords(masu_bake_pool *pool, const struct aiMesh *mesh) {
    float *out = masu_bake_take(pool, (size_t)mesh->mNumVertices * 2 * sizeof *out);
    for (size_t i = 0; i < mesh->mNumVertices; i++) {
        out[2 * i] = mesh->mTextureCoords[1][i].x;
        out[2 * i + 1] = mesh->mTextureCoords[1][i].y;
    }
    return out;
}

void masu_import_mesh(masu_import *m, unsigned index) {
    const struct aiMesh *mesh = m->source->mMeshes[index];
    if (m->mesh_done[index] || !mesh) return;
    m->mesh_done[index] = true;
    masu_bake_content *to = masu_import_bends(m, index) ? &m->bent : m->piece;
    m->mesh_parts[index].first = (uint32_t)masu_bake_count(to, MASU_BLOB_PRIMITIVES);
    if (!mesh->mVertices || !mesh->mFaces || mesh->mNumVertices == 0 || m->full) return;
    masu_bake_buffer indices = {0};
    uint64_t left_out = 0;
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        if (face->mNumIndices != 3 || !face->mIndices) {
            left_out++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            uint32_t corner = face->mIndices[k];
            masu_bake_append(&indices, &corner, sizeof corner);
        }
    }
    _Static_assert(sizeof(struct aiVector3D) == 3 * sizeof(float), "Assimp built for double");
    const masu_import_given *given = masu_import_read_material(m, mesh->mMaterialIndex);
    float *texcoords = NULL;
    /* The direction of an anisotropy is along u. */
    if (m->wanted == MASU_BAKE_TEXTURES_FORCED || masu_bake_has_maps(&given->maps) ||
        (given->material.anisotropy > 0 && mesh->mTextureCoords[0])) {
        texcoords = texcoords_of(m, mesh);
    }
    masu_bake_triangles triangles = {
        .positions = &mesh->mVertices->x,
        .normals = mesh->mNormals ? &mesh->mNormals->x : NULL,
        .vertex_count = mesh->mNumVertices,
        .indices = (const uint32_t *)(const void *)indices.data,
        .index_count = indices.bytes / sizeof(uint32_t),
        .texcoords = texcoords,
        .repeats = !given->maps.wrap[0] && !given->maps.wrap[1],
    };
    masu_bake_losses lost = {0};
    masu_bake_pool pool = {0};
    if (m->given && mesh->mColors[0]) triangles.colors = &mesh->mColors[0]->r;
    if (m->given && mesh->mTextureCoords[1]) triangles.second = second_texcoords(&pool, mesh);
    if (!m->given && mesh->mColors[0] && triangles.index_count)
        add_colored(m, mesh, to == &m->bent, &triangles, &lost);
    else
        add_part(m, mesh, to == &m->bent, &triangles, NULL, &lost);
    masu_bake_release(&indices);
    masu_bake_pool_release(&pool);
    free(texcoords);
    note_losses(m, mesh, &lost);
    note_loss(m, MASU_LOST_FACE, left_out, mesh);
    if (mesh->mNumBones) m->skins++;
    m->mesh_parts[index].count =
        (uint32_t)masu_bake_count(to, MASU_BLOB_PRIMITIVES) - m->mesh_parts[index].first;
}
