/* trace_texture.h: small pictures of textures, which rays of reflections look up where they meet a
 * surface: TRACE_TEXTURES and TRACE_TEXELS of the blob.
 *
 * While textures are made, each keeps a picture: a colour the mips from the finest that is small
 * enough, in linear light before it is compressed; roughness and metallic their mean alone,
 * which is what a ray sees of them. Once it is known what is traced, the pictures that its
 * materials use become sections. */
#ifndef MASU_BAKE_TRACE_TEXTURE_H
#define MASU_BAKE_TRACE_TEXTURE_H

#include "bake/scene/content.h"

/* Texels along the longer side of a picture, where the scene does not say; see
 * docs/design/10-reflections.md for what that takes. 0: colours have no pictures. */
#define MASU_BAKE_TRACE_SIDE 64u

/* A picture while it grows. */
typedef struct masu_bake_trace_picture {
    masu_bake_buffer texels; /* uint32_t, as TRACE_TEXELS */
    uint32_t width, height;
    float least; /* of roughness maps: the least roughness */
} masu_bake_trace_picture;

/* One of content->pictures: a layer of TEXTURES. Sorted as TRACE_TEXTURES. */
typedef struct masu_bake_trace_row {
    uint32_t texture, layer;
    uint32_t width, height;
    uint64_t first; /* of content->picture_texels */
    float least;
    uint32_t reserved;
} masu_bake_trace_row;

/* As texels are stored: nearest of 256 roots. */
uint8_t masu_bake_trace_root(float linear);

/* The next mip of a colour: `level` has four floats per texel. Larger ones than `side` are
 * passed over. `alpha`: a byte per texel; NULL: opaque. */
void masu_bake_trace_colors(masu_bake_trace_picture *p, uint32_t side, const float *level,
                            uint32_t width, uint32_t height, const uint8_t *alpha);

/* A mip of roughness and metallic: the first two of four bytes per texel. The last one counts as
 * the mean, the first one says what is least. */
void masu_bake_trace_surface(masu_bake_trace_picture *p, const uint8_t *bytes, size_t texels,
                             bool first, bool last);

/* Notes a finished picture as that of a layer; in the order of rows. */
void masu_bake_trace_keep(masu_bake_content *content, uint32_t texture, uint32_t layer,
                          const masu_bake_trace_picture *p);

/* The least roughness of what a material's map holds; 1 where it has none. */
float masu_bake_trace_least(const masu_bake_content *content, const masu_blob_material *material);

/* Fills the sections with what the materials of traced triangles use; after masu_bake_make_bvh. */
void masu_bake_trace_textures(masu_bake_content *content);

#endif
