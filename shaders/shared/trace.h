/* trace.h: the BVHs that reflection rays traverse (shaders/trace/bvh.glsl, src/scene/trace.h,
 * src/scene/blob.h). */
#ifndef MASU_SHARED_TRACE_H
#define MASU_SHARED_TRACE_H

#include "shared/types.h"

/* Buffers of uvec4:
 *
 *   static    header: first triangle, nodes, triangles, 0; then nodes of NODE_UVEC4; triangles
 *   frame     header: first record, nodes, records, 0; then nodes; records of RECORD_UVEC4
 *   vertices  as in the blob: position, normal
 *
 * The traversal stack holds one value per level of the BVH over instances and of one mesh's BVH. A
 * ray that has visited VISITS nodes misses. */
#define MASU_TRACE_NODE_UVEC4 3
#define MASU_TRACE_RECORD_UVEC4 4
#define MASU_TRACE_TOP_DEPTH 20
#define MASU_MORPH_TARGETS 1024  /* loop bound: MASU_BLOB_MORPH_TARGETS_MAX of blob.h */
#define MASU_SKIN_ROUNDS 4096    /* loop bound: nodes of a skinned mesh's BVH / 64 */
#define MASU_TRACE_LEVELS_MAX 28 /* of a mesh's BVH: MASU_TRACE_DEPTH_MAX of blob.h */
#define MASU_TRACE_STACK 48
#define MASU_TRACE_VISITS 4096

/* Material of a triangle: index and flags. */
#define MASU_TRACE_NONE 0xFFFFFFFFu
#define MASU_TRACE_HOLES 0x80000000u  /* alpha-tested */
#define MASU_TRACE_SECOND 0x10u       /* in wrap modes: emission uses the second UVs */
#define MASU_TRACE_SINGLE 0x40000000u /* single-sided: missed from behind */
#define MASU_TRACE_MATERIAL 0x3FFFFFFFu
#define MASU_TRACE_NOISE_WORDS 4096u
struct masu_trace_material {
    masu_vec4 base_color; /* rgb linear albedo; w perceptual roughness 0..1 */
    masu_vec4 emissive;   /* rgb linear radiance; w metallic 0..1 */
    masu_vec4 more;       /* as of masu_material_data */
    masu_uvec4 maps;      /* x base colour texture, y emissive texture, or TRACE_NONE; z flags of
                             the material (materials.h); w wrap modes of u and v, 2 bits each */
};

#endif
