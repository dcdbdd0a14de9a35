/* texture.c: see texture.h. The input has been validated by masu_scene_bind. Blocks may hold any
 * bits, and any bits decode. */
#include "scene/texture.h"

#include <string.h>

masu_texture_form masu_texture_form_of(uint32_t blob_format, int compressed) {
    switch (blob_format) {
    case MASU_TEXTURE_BC1_SRGB:
        if (compressed) return (masu_texture_form){VK_FORMAT_BC1_RGB_SRGB_BLOCK, 4, 8};
        break;
    case MASU_TEXTURE_BC3_SRGB:
        if (compressed) return (masu_texture_form){VK_FORMAT_BC3_SRGB_BLOCK, 4, 16};
        break;
    case MASU_TEXTURE_BC4:
        if (compressed) return (masu_texture_form){VK_FORMAT_BC4_UNORM_BLOCK, 4, 8};
        return (masu_texture_form){VK_FORMAT_R8_UNORM, 1, 1};
    case MASU_TEXTURE_BC5:
        if (compressed) return (masu_texture_form){VK_FORMAT_BC5_UNORM_BLOCK, 4, 16};
        return (masu_texture_form){VK_FORMAT_R8G8_UNORM, 1, 2};
    }
    return (masu_texture_form){VK_FORMAT_R8G8B8A8_SRGB, 1, 4};
}

uint64_t masu_texture_bytes(const masu_blob_texture *t, int compressed) {
    if (compressed) return masu_blob_texture_bytes(t);
    uint64_t texels = 0;
    for (uint32_t m = 0; m < t->mips; m++) {
        texels += (uint64_t)masu_blob_mip_size(t->width, m) * masu_blob_mip_size(t->height, m);
    }
    return texels * t->layers * masu_texture_form_of(t->format, 0).block_bytes;
}

/* ---- Iteration ------------------------------------------------------------------------------- */

/* Advances the cursor by the rows of *taken, and to the next mip, layer or texture after the last
 * row. */
static void advance(const masu_blob_texture *textures, masu_texture_cursor *c,
                    const masu_texture_region *taken, uint32_t all_rows) {
    const masu_blob_texture *t = &textures[c->texture];
    c->source += taken->rows * taken->source_row;
    c->row += taken->rows;
    if (c->row < all_rows) return;
    c->row = 0;
    if (++c->mip < t->mips) return;
    c->mip = 0;
    if (++c->layer < t->layers) return;
    c->layer = 0;
    c->texture++;
    c->source = (c->source + MASU_BLOB_ALIGN - 1) / MASU_BLOB_ALIGN * MASU_BLOB_ALIGN;
}

int masu_texture_next(const masu_blob_texture *textures, uint32_t count, int compressed,
                      uint64_t room, masu_texture_cursor *cursor, uint64_t *used,
                      masu_texture_region *region) {
    if (cursor->texture >= count) return 0;
    const masu_blob_texture *t = &textures[cursor->texture];
    masu_texture_form form = masu_texture_form_of(t->format, compressed);
    uint32_t width = masu_blob_mip_size(t->width, cursor->mip);
    uint32_t height = masu_blob_mip_size(t->height, cursor->mip);
    uint32_t columns = (width + 3) / 4, all_rows = (height + 3) / 4;
    masu_texture_region r = {.texture = cursor->texture,
                             .layer = cursor->layer,
                             .mip = cursor->mip,
                             .y = 4 * cursor->row,
                             .width = width,
                             .source = cursor->source,
                             .offset = (*used + 15) / 16 * 16};
    r.source_row = (uint64_t)columns * masu_blob_block_bytes(t->format);
    r.target_row = compressed ? r.source_row : (uint64_t)width * 4 * form.block_bytes;
    if (r.offset >= room) return 0;
    uint64_t rows = (room - r.offset) / r.target_row;
    if (rows > all_rows - cursor->row) rows = all_rows - cursor->row;
    /* In decoded textures the last row of blocks may be partial: fewer texel rows, fewer bytes. */
    uint32_t cut = 4 * all_rows - height;
    if (!compressed && rows + 1 == all_rows - cursor->row && cut &&
        r.offset + rows * r.target_row + (uint64_t)width * (4 - cut) * form.block_bytes <= room) {
        rows++;
    }
    if (!rows) return 0;
    r.rows = (uint32_t)rows;
    r.height = 4 * r.rows;
    if (cursor->row + r.rows == all_rows) r.height -= cut;
    r.first = !cursor->layer && !cursor->mip && !cursor->row;
    *used = r.offset +
            (compressed ? rows * r.target_row : (uint64_t)width * r.height * form.block_bytes);
    advance(textures, cursor, &r, all_rows);
    r.last = cursor->texture != r.texture;
    *region = r;
    return 1;
}

uint32_t masu_texture_chunks(const masu_blob_texture *textures, uint32_t count, int compressed,
                             uint64_t room) {
    masu_texture_cursor cursor = {0};
    uint32_t chunks = 0;
    while (cursor.texture < count) {
        masu_texture_region region;
        uint64_t used = 0;
        int taken = 0;
        while (masu_texture_next(textures, count, compressed, room, &cursor, &used, &region)) {
            taken = 1;
        }
        /* not even one row fits: impossible with the sizes of src/device/memory.c */
        if (!taken) return 0;
        chunks++;
    }
    return chunks;
}

/* ---- Decoding -------------------------------------------------------------------------------- */

static uint32_t read16(const unsigned char *p) { return p[0] | (uint32_t)p[1] << 8; }

/* Decodes two colours (5, 6 and 5 bits) followed by 2-bit indices. `four`: always four colours, as
 * in BC3; BC1 has three and black if the first colour is not the larger one. */
static void decode_color(const unsigned char *block, int four, unsigned char *rgba) {
    uint32_t ends[2] = {read16(block), read16(block + 2)}, color[4][3];
    for (uint32_t e = 0; e < 2; e++) {
        uint32_t r = ends[e] >> 11, g = ends[e] >> 5 & 63, b = ends[e] & 31;
        color[e][0] = r << 3 | r >> 2;
        color[e][1] = g << 2 | g >> 4;
        color[e][2] = b << 3 | b >> 2;
    }
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t a = color[0][k], b = color[1][k];
        if (four || ends[0] > ends[1]) {
            color[2][k] = (2 * a + b + 1) / 3;
            color[3][k] = (a + 2 * b + 1) / 3;
        } else {
            color[2][k] = (a + b + 1) / 2;
            color[3][k] = 0;
        }
    }
    for (uint32_t i = 0; i < 16; i++) {
        const uint32_t *c = color[block[4 + i / 4] >> 2 * (i % 4) & 3];
        for (uint32_t k = 0; k < 3; k++) rgba[4 * i + k] = (unsigned char)c[k];
        rgba[4 * i + 3] = 255;
    }
}

/* Decodes two 8-bit values followed by 3-bit indices. */
static void decode_channel(const unsigned char *block, unsigned char *to, uint32_t stride) {
    uint32_t value[8] = {block[0], block[1]};
    uint64_t bits = 0;
    for (uint32_t i = 0; i < 6; i++) bits |= (uint64_t)block[2 + i] << 8 * i;
    if (value[0] > value[1]) {
        for (uint32_t i = 1; i < 7; i++) {
            value[1 + i] = ((7 - i) * value[0] + i * value[1] + 3) / 7;
        }
    } else {
        for (uint32_t i = 1; i < 5; i++) {
            value[1 + i] = ((5 - i) * value[0] + i * value[1] + 2) / 5;
        }
        value[7] = 255;
    }
    for (uint32_t i = 0; i < 16; i++) to[stride * i] = (unsigned char)value[bits >> 3 * i & 7];
}

void masu_texture_decode(uint32_t blob_format, const unsigned char *block, unsigned char *texels) {
    switch (blob_format) {
    case MASU_TEXTURE_BC1_SRGB: decode_color(block, 0, texels); break;
    case MASU_TEXTURE_BC3_SRGB:
        decode_color(block + 8, 1, texels);
        decode_channel(block, texels + 3, 4);
        break;
    case MASU_TEXTURE_BC4: decode_channel(block, texels, 1); break;
    case MASU_TEXTURE_BC5:
        decode_channel(block, texels, 2);
        decode_channel(block + 8, texels + 1, 2);
        break;
    }
}

void masu_texture_write_region(const masu_blob_texture *texture, const unsigned char *texels,
                               int compressed, const masu_texture_region *r, unsigned char *to) {
    if (compressed) {
        memcpy(to + r->offset, texels + r->source, (size_t)(r->rows * r->source_row));
        return;
    }
    uint32_t block_bytes = masu_blob_block_bytes(texture->format);
    uint32_t texel = masu_texture_form_of(texture->format, 0).block_bytes;
    for (uint32_t y = 0; y < r->height; y += 4) {
        for (uint32_t x = 0; x < r->width; x += 4) {
            unsigned char block[64];
            masu_texture_decode(texture->format,
                                texels + r->source + y / 4 * r->source_row + x / 4 * block_bytes,
                                block);
            uint32_t across = r->width - x < 4 ? r->width - x : 4;
            for (uint32_t row = 0; row < 4 && y + row < r->height; row++) {
                memcpy(to + r->offset + ((uint64_t)(y + row) * r->width + x) * texel,
                       block + 4 * row * texel, across * texel);
            }
        }
    }
}
