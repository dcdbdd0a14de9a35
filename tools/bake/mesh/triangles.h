/* triangles.h: triangles of unknown quality become vertices and primitives that the runtime may
 * trust. */
#ifndef MASU_BAKE_TRIANGLES_H
#define MASU_BAKE_TRIANGLES_H

#include "bake/scene/content.h"

/* The skinning of a vertex: up to four joints of its mesh; the weights have the sum 65535. */
typedef struct masu_bake_influence {
    uint16_t joints[4], weights[4];
    uint32_t source; /* of a mesh that morphs: its number there; else 0 */
} masu_bake_influence;

/* Triangles of unknown quality become one or more primitives at the end of `content`. */
typedef struct masu_bake_triangles {
    const float *positions; /* 3 per vertex */
    const float *normals;   /* 3 per vertex; NULL: made, see creases.h */
    const float *texcoords; /* 2 per vertex, v down the image, or NULL */
    const float *colors;    /* 4 per vertex, linear with alpha, or NULL */
    const float *second;    /* second texture coordinates, or NULL */
    bool repeats;           /* their textures repeat: whole periods may be subtracted */
    uint32_t vertex_count;
    const uint32_t *indices;
    uint64_t index_count; /* a rest behind the last full triangle is ignored */
    uint32_t material;
    const masu_bake_influence *influences; /* 1 per vertex, or NULL */
    masu_bake_buffer *bent; /* with influences: gets those of each vertex that is made */
} masu_bake_triangles;

typedef struct masu_bake_losses {
    uint64_t triangles;     /* looked at */
    uint64_t bad_index;     /* dropped: an index beyond the vertices */
    uint64_t bad_position;  /* dropped: NaN, infinite or absurdly far */
    uint64_t degenerate;    /* dropped: no area */
    uint64_t bad_normals;   /* vertices whose normal had to be made from the triangles */
    uint64_t bad_texcoords; /* corners whose texture coordinates became 0 */
} masu_bake_losses;

/* False: over 2^31 - 1 vertices or indices in all. */
bool masu_bake_add_triangles(masu_bake_content *content, const masu_bake_triangles *triangles,
                             masu_bake_losses *losses);

/* Unit vector to two signed normalised components; blob.md gives the mapping. */
void masu_bake_encode_normal(masu_bake_vec3 normal, int16_t out[2]);
masu_bake_vec3 masu_bake_decode_normal(const int16_t normal[2]);

#endif
