/*
 * mesh_vertices.comp: vertices of a host's mesh. With MASU_MOTION also their previous positions:
 * those of the previous frame if they have moved, the present ones if the mesh is new or has
 * stopped. Jobs in y, vertices in x; shared/meshes.h has the layout.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/mesh_vertices.h"
#include "shared/types.h"
#include "shared/meshes.h"
#include "shared/push.glsl"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MESH_UPLOAD, std430) readonly buffer Upload
{
    uvec4 mesh_upload[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKINNED, std430) buffer Vertices
{
    uvec4 vertices[];
};

#ifdef MASU_MOTION
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PREVIOUS_VERTICES, std430)
    writeonly buffer PreviousVertices
{
    float previous_vertices[];
};
#endif

void main()
{
    uvec4 job = mesh_upload[1u + MASU_MESH_JOB_UVEC4 * gl_WorkGroupID.y];
    uint k = gl_GlobalInvocationID.x, vertex = job.x + k;
    if (k >= job.y) return;
    uvec4 before = vertices[vertex], now = job.z != 0u ? mesh_upload[job.z + k] : before;
    vertices[vertex] = now;
#ifdef MASU_MOTION
    uint to = 3u * (vertex - push.first_vertex);
    vec3 position = uintBitsToFloat(job.w != 0u ? before.xyz : now.xyz);
    for (uint i = 0u; i < 3u; i++) previous_vertices[to + i] = position[i];
#endif
}
