/* trace_texture.c: see trace_texture.h.
 *
 * A small texture is the whole mip chain down to one texel, which is the mean. */
#include "bake/texture/trace_texture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

uint8_t masu_bake_trace_root(float linear) {
    if (!(linear > 0)) return 0;
    return linear < 1 ? (uint8_t)(sqrtf(linear) * 255.0f + 0.5f) : 255;
}

static void put(masu_bake_buffer *texels, uint32_t r, uint32_t g, uint32_t b, uint32_t a) {
    uint32_t word = r | g << 8 | b << 16 | a << 24;
    masu_bake_append(texels, &word, sizeof word);
}

void masu_bake_trace_colors(masu_bake_trace_picture *p, uint32_t side, const float *level,
                            uint32_t width, uint32_t height, const uint8_t *alpha) {
    if ((width > height ? width : height) > side) return;
    if (!p->width) {
        p->width = width;
        p->height = height;
    }
    for (size_t i = 0; i < (size_t)width * height; i++) {
        put(&p->texels, masu_bake_trace_root(level[4 * i]), masu_bake_trace_root(level[4 * i + 1]),
            masu_bake_trace_root(level[4 * i + 2]), alpha ? alpha[i] : 255u);
    }
}

void masu_bake_trace_surface(masu_bake_trace_picture *p, const uint8_t *bytes, size_t texels,
                             bool first, bool last) {
    if (first) p->least = 1;
    for (size_t i = 0; i < texels && first; i++) {
        float roughness = (float)bytes[4 * i] / 255.0f;
        if (roughness < p->least) p->least = roughness;
    }
    if (!last) return;
    p->width = p->height = 1;
    put(&p->texels, masu_bake_trace_root((float)bytes[0] / 255.0f),
        masu_bake_trace_root((float)bytes[1] / 255.0f), 0, 255);
}

void masu_bake_trace_keep(masu_bake_content *content, uint32_t texture, uint32_t layer,
                          const masu_bake_trace_picture *p) {
    if (!p->width) return;
    masu_bake_trace_row row = {.texture = texture,
                               .layer = layer,
                               .width = p->width,
                               .height = p->height,
                               .first = content->picture_texels.bytes / sizeof(uint32_t),
                               .least = p->least};
    masu_bake_append(&content->pictures, &row, sizeof row);
    masu_bake_append(&content->picture_texels, p->texels.data, p->texels.bytes);
}

/* The row of a material's map in a slot, or NULL. */
static const masu_bake_trace_row *row_of(const masu_bake_content *content,
                                         const masu_blob_material *material, uint32_t slot) {
    const masu_bake_trace_row *rows = (const void *)content->pictures.data;
    size_t count = content->pictures.bytes / sizeof *rows;
    if (!(material->flags & 1u << slot)) return NULL;
    const masu_blob_texture_set *sets =
        MASU_BAKE_ARRAY(content, MASU_BLOB_TEXTURE_SETS, const masu_blob_texture_set);
    uint32_t texture = sets[material->texture_set].texture[slot];
    uint32_t layer = material->layers >> 8 * slot & 255u;
    for (size_t i = 0; i < count; i++) {
        if (rows[i].texture == texture && rows[i].layer == layer) return &rows[i];
    }
    return NULL;
}

float masu_bake_trace_least(const masu_bake_content *content, const masu_blob_material *material) {
    if (!(material->flags & 1u << MASU_SLOT_SURFACE)) return 1;
    const masu_bake_trace_row *row = row_of(content, material, MASU_SLOT_SURFACE);
    return row ? row->least : 0;
}

/* Marks the rows that the materials of traced triangles use. */
static void mark(const masu_bake_content *content, unsigned char *used) {
    static const uint32_t slots[] = {MASU_SLOT_BASE, MASU_SLOT_SURFACE, MASU_SLOT_EMISSIVE};
    const masu_bake_trace_row *rows = (const void *)content->pictures.data;
    const masu_blob_trace_triangle *triangles =
        MASU_BAKE_ARRAY(content, MASU_BLOB_TRACE_TRIANGLES, const masu_blob_trace_triangle);
    size_t materials = (size_t)masu_bake_count(content, MASU_BLOB_MATERIALS);
    unsigned char *seen = masu_bake_allocate(materials + 1);
    memset(seen, 0, materials + 1);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_TRACE_TRIANGLES); i++) {
        uint32_t m = MASU_BAKE_PRIMITIVES(content)[triangles[i].primitive].material;
        if (seen[m]) continue;
        seen[m] = 1;
        for (size_t k = 0; k < sizeof slots / sizeof *slots; k++) {
            const masu_bake_trace_row *row =
                row_of(content, &MASU_BAKE_MATERIALS(content)[m], slots[k]);
            if (row) used[row - rows] = 1;
        }
    }
    free(seen);
}

void masu_bake_trace_textures(masu_bake_content *content) {
    const masu_bake_trace_row *rows = (const void *)content->pictures.data;
    size_t count = content->pictures.bytes / sizeof *rows;
    masu_bake_buffer *texels = &content->section[MASU_BLOB_TRACE_TEXELS];
    unsigned char *used = masu_bake_allocate(count + 1);
    memset(used, 0, count + 1);
    mark(content, used);
    for (size_t i = 0; i < count; i++) {
        if (!used[i]) continue;
        masu_blob_trace_texture t = {.texture = rows[i].texture,
                                     .layer = rows[i].layer,
                                     .width = rows[i].width,
                                     .height = rows[i].height,
                                     .first = (uint32_t)(texels->bytes / sizeof(uint32_t))};
        masu_bake_append(&content->section[MASU_BLOB_TRACE_TEXTURES], &t, sizeof t);
        masu_bake_append(texels, content->picture_texels.data + rows[i].first * sizeof(uint32_t),
                         (size_t)masu_blob_trace_texels(t.width, t.height) * sizeof(uint32_t));
    }
    free(used);
}
