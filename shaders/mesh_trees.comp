/*
 * mesh_trees.comp: copies the BVHs that the host has built over its meshes, and their triangles, to
 * the buffers that rays read. Jobs in y, elements in x; shared/meshes.h has the layout.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/trace.h"
#include "shared/meshes.h"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MESH_UPLOAD, std430) readonly buffer Upload
{
    uint upload_words[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE, std430) buffer Static
{
    uvec4 masu_trace_static[];
};

void main()
{
    uint job = 4u * (1u + MASU_MESH_JOB_UVEC4 * gl_WorkGroupID.y), k = gl_GlobalInvocationID.x;
    uint triangles = upload_words[job + 5u], nodes = upload_words[job + 9u];
    if (triangles == 0u) return;
    if (k < triangles) {
        uint vertex = upload_words[job], from = 4u * upload_words[job + 6u] + 3u * k;
        masu_trace_static[masu_trace_static[0].x + upload_words[job + 13u] + k] =
            uvec4(vertex + upload_words[from], vertex + upload_words[from + 1u],
                  vertex + upload_words[from + 2u], upload_words[job + 11u]);
    }
    if (k < uint(MASU_TRACE_NODE_UVEC4) * nodes) {
        uint from = 4u * (upload_words[job + 10u] + k);
        masu_trace_static[1u + uint(MASU_TRACE_NODE_UVEC4) * upload_words[job + 8u] + k] =
            uvec4(upload_words[from], upload_words[from + 1u], upload_words[from + 2u],
                  upload_words[from + 3u]);
    }
}
