/* colours have no small textures. */
#ifndef MASU_BAKE_TRACE_TEXTURE_H
#define MASU_BAKE_TRACE_TEXTURE_H

#include "bake/scene/content.h"

/* Default for the texels along the longer side; docs/design/10-reflections.md has the memory
 * cost. */
#define MASU_BAKE_TRACE_SIDE 64u

/* A small texture while it is built. */
typedef struct masu_bake_trace_picture {
    masu_bake_buffer texels; /* uint32_t, as TRACE_TEXELS */
    uint32_t width, height;
    float least; /* the least roughness of a roughness map */
} masu_bake_trace_picture;

/* An element of content->pictures: a layer of TEXTURES. Sorted like TRACE_TEXTURES. */
typedef struct masu_bake_trace_row {
    uint32_t texture, layer;
    uint32_t width, height;
    uint64_t first; /* index into content->picture_texels */
    float least;
    uint32_t reserved;
} masu_bake_trace_row;

/* The encoding of texels: the square root, rounded to 8 bits. */
uint8_t masu_bake_trace_root(float linear);

/* Adds the next mip of a colour; `level` has four floats per texel. Mips larger than `side` are
 * skipped. `alpha`: a byte per texel; NULL: opaque. */
void masu_bake_trace_colors(masu_bake_trace_picture *p, uint32_t side, const float *level,
                            uint32_t width, uint32_t height, const uint8_t *alpha);

/* Adds a mip of roughness and metallic: the first two of four bytes per texel. The last mip gives
 * the mean, the first one the least roughness. */
void masu_bake_trace_surface(masu_bake_trace_picture *p, const uint8_t *bytes, size_t texels,
                             bool first, bool last);

/* Records a finished small texture for a layer; call it in the order of the rows. */
void masu_bake_trace_keep(masu_bake_content *content, uint32_t texture, uint32_t layer,
                          const masu_bake_trace_picture *p);

/* The least roughness in a material's map; 1 if it has no map. */
float masu_bake_trace_least(const masu_bake_content *content, const masu_blob_material *material);

/* Fills the sections with the small textures of the traced triangles' materials; call it after
 * masu_bake_make_bvh. */
void masu_bake_trace_textures(masu_bake_content *content);

#endif
