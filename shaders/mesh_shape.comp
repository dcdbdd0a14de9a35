/*
 * mesh_shape.comp: the static data of a host's mesh, independent of vertex motion: triangles and,
 * with MASU_MAPS, texture coordinates and colours of its vertices. Jobs in y, elements in x;
 * shared/meshes.h has the layout.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/mesh_shape.h"
#include "shared/types.h"
#include "shared/meshes.h"
#include "shared/push.glsl"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MESH_UPLOAD, std430) readonly buffer Upload
{
    uint upload_words[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MESH_INDICES, std430) writeonly buffer Indices
{
    uint mesh_indices[];
};

#ifdef MASU_MAPS
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE_TEXCOORDS, std430)
    writeonly buffer Texcoords
{
    uint texcoord_words[];
};
#endif

void main()
{
    uint job = 4u * (1u + MASU_MESH_JOB_UVEC4 * gl_WorkGroupID.y), k = gl_GlobalInvocationID.x;
    uint triangles = upload_words[job + 5u];
    if (triangles == 0u) return;
    if (k < triangles) {
        uint to = 3u * (upload_words[job + 4u] + k), from = 4u * upload_words[job + 6u] + 3u * k;
        for (uint i = 0u; i < 3u; i++) mesh_indices[to + i] = upload_words[from + i];
    }
#ifdef MASU_MAPS
    if (k >= upload_words[job + 1u]) return;
    uint vertex = upload_words[job] + k, texcoords = upload_words[job + 7u],
         colors = upload_words[job + 12u];
    for (uint i = 0u; i < 2u; i++) {
        uint value = texcoords != 0u ? upload_words[4u * texcoords + 2u * k + i] : 0u;
        texcoord_words[2u * vertex + i] = value;
        if (push.second != 0u) texcoord_words[push.second + 2u * vertex + i] = value;
    }
    if (push.colors != 0u)
        texcoord_words[push.colors + vertex] = colors != 0u ? upload_words[4u * colors + k]
                                                            : 0xFFFFFFFFu;
#endif
}
