/* texture.h: upload of textures: their size and format on the device, the order of copies, and
 * decoding of compressed blocks for devices without support for them.
 *
 * The blob holds only block-compressed textures (BC1, BC3, BC4, BC5). For a device without
 * textureCompressionBC they are decoded to RGBA8, R8 or RG8 on the host, one row of blocks at a
 * time, into the staging buffer. A second copy in the blob would make textures three to nine times
 * as large, for rare devices.
 *
 * A load is a sequence of chunks of at most the staging buffer's size. A chunk is a sequence of
 * regions, each some rows of one mip. Recording and writing iterate over the regions with the same
 * cursor. */
#ifndef MASU_TEXTURE_H
#define MASU_TEXTURE_H

#include "scene/blob.h"

#include <vulkan/vulkan_core.h>

/* Format of a blob texture on the device. */
typedef struct masu_texture_form {
    VkFormat format;
    uint32_t block;       /* texels along an edge of a block: 4, or 1 if decoded */
    uint32_t block_bytes; /* per block or texel */
} masu_texture_form;

masu_texture_form masu_texture_form_of(uint32_t blob_format, int compressed);

/* Bytes on the device, all layers and mips, without padding. */
uint64_t masu_texture_bytes(const masu_blob_texture *texture, int compressed);

typedef struct masu_texture_cursor {
    uint32_t texture, layer, mip, row; /* row: in blocks */
    uint64_t source;                   /* bytes into TEXELS */
} masu_texture_cursor;

typedef struct masu_texture_region {
    uint32_t texture, layer, mip;
    uint32_t y, width, height;   /* texels */
    uint32_t rows;               /* in blocks */
    uint64_t source, source_row; /* first byte in TEXELS; bytes per row of blocks */
    uint64_t offset, target_row; /* in the staging buffer; bytes per row of blocks */
    int first, last;             /* whether the region is the first, the last of its texture */
} masu_texture_region;

/* Upper bound of the staging bytes of a row of blocks. */
#define MASU_TEXTURE_ROW_MAX ((uint64_t)MASU_TEXTURE_SIZE_MAX * 4 * 4)

/* Advances to the next region that fits into `room` bytes, of which `*used` are in use. Returns 0
 * if the chunk is full or all regions are done. An empty chunk always fits a region if room is at
 * least MASU_TEXTURE_ROW_MAX, or the size of all textures. */
int masu_texture_next(const masu_blob_texture *textures, uint32_t count, int compressed,
                      uint64_t room, masu_texture_cursor *cursor, uint64_t *used,
                      masu_texture_region *region);

/* Number of chunks that loading needs. */
uint32_t masu_texture_chunks(const masu_blob_texture *textures, uint32_t count, int compressed,
                             uint64_t room);

/* Writes the texels of a region. `to`: the first byte of the staging buffer. */
void masu_texture_write_region(const masu_blob_texture *texture, const unsigned char *texels,
                               int compressed, const masu_texture_region *region,
                               unsigned char *to);

/* Decodes a block to 16 texels, row by row: 4 bytes each for BC1 and BC3, 1 for BC4, 2 for BC5. */
void masu_texture_decode(uint32_t blob_format, const unsigned char *block, unsigned char *texels);

#endif
