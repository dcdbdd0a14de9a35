/* texture.h: textures between blob and device: how large they are there, in which order they are
 * copied, and how compressed blocks become plain texels where the device does not take them.
 *
 * The blob holds blocks alone (BC1, BC3, BC4, BC5). A device without textureCompressionBC gets RGBA8,
 * R8 or RG8, decoded here on the host, a row of blocks at a time, into the staging buffer: a second
 * copy in the blob would make texels three to nine times as large for devices that are rare.
 *
 * A load is a sequence of chunks of at most the staging buffer's size; a chunk is a sequence of
 * regions, each some rows of one mip. The cursor walks them; recording and writing walk alike. */
#ifndef MASU_TEXTURE_H
#define MASU_TEXTURE_H

#include "scene/blob.h"

#include <vulkan/vulkan_core.h>

/* How a blob format lies on the device. */
typedef struct masu_texture_form {
    VkFormat format;
    uint32_t block;       /* texels along the edge of a block: 4, or 1 where decoded */
    uint32_t block_bytes; /* of one block or texel */
} masu_texture_form;

masu_texture_form masu_texture_form_of(uint32_t blob_format, int compressed);

/* Texel bytes on the device, all layers and mips, without padding. */
uint64_t masu_texture_bytes(const masu_blob_texture *texture, int compressed);

typedef struct masu_texture_cursor {
    uint32_t texture, layer, mip, row; /* row: of blocks */
    uint64_t source;                   /* bytes into TEXELS */
} masu_texture_cursor;

typedef struct masu_texture_region {
    uint32_t texture, layer, mip;
    uint32_t y, width, height;   /* texels */
    uint32_t rows;               /* of blocks */
    uint64_t source, source_row; /* first byte in TEXELS; bytes of a row of blocks there */
    uint64_t offset, target_row; /* in the staging buffer; bytes per row of blocks there */
    int first, last;             /* of its texture */
} masu_texture_region;

/* Staging bytes that any single row of blocks needs at most. */
#define MASU_TEXTURE_ROW_MAX ((uint64_t)MASU_TEXTURE_SIZE_MAX * 4 * 4)

/* The next region that fits into `room` bytes of which `*used` are taken. 0: none, the chunk is
 * full or all is done. An empty chunk always takes one if room is at least MASU_TEXTURE_ROW_MAX, or
 * what all textures need together. */
int masu_texture_next(const masu_blob_texture *textures, uint32_t count, int compressed,
                      uint64_t room, masu_texture_cursor *cursor, uint64_t *used,
                      masu_texture_region *region);

/* Chunks that loading takes. */
uint32_t masu_texture_chunks(const masu_blob_texture *textures, uint32_t count, int compressed,
                             uint64_t room);

/* Writes a region's texels to `to`, the staging buffer's first byte. */
void masu_texture_write(const masu_blob_texture *texture, const unsigned char *texels,
                        int compressed, const masu_texture_region *region, unsigned char *to);

/* One block to 16 texels, row by row: 4 bytes each for BC1 and BC3, 1 for BC4, 2 for BC5. */
void masu_texture_decode(uint32_t blob_format, const unsigned char *block, unsigned char *texels);

#endif
