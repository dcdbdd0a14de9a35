/*
 * trace_rays.comp: traces a list of independent rays, for `masu-lab study rays` and tests. Not a
 * pass of a frame. A ray is origin and t_min, direction and t_max. A result is t, triangle,
 * instance and visited nodes, then barycentric weights, tested triangles and record. push.x: number
 * of rays; push.y 1: any hit, and only t is valid.
 */
#version 440
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Static { uvec4 masu_trace_static[]; };
layout(set = 0, binding = 1, std430) readonly buffer Frame { uvec4 masu_trace_frame[]; };
layout(set = 0, binding = 2, std430) readonly buffer Vertices { uvec4 masu_trace_vertices[]; };
layout(set = 0, binding = 3, std430) readonly buffer Rays { vec4 rays[]; };
layout(set = 0, binding = 4, std430) writeonly buffer Hits { uvec4 hits[]; };
layout(push_constant) uniform Push { uvec4 push; };

#define MASU_TRACE_LANES 64
#include "trace/bvh.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.x) return;
    vec4 from = rays[2u * i], along = rays[2u * i + 1u];
    masu_ray_hit hit = masu_trace_walk(from.xyz, along.xyz, from.w, along.w, push.y != 0u);
    uint seen = masu_trace_exceeded ? 0xFFFFFFFFu : 0u;
    uint tested = 0u;
#ifdef MASU_TRACE_COUNTERS
    if (!masu_trace_exceeded) seen = masu_trace_nodes_seen;
    tested = masu_trace_triangles_seen;
#endif
    hits[2u * i] = uvec4(floatBitsToUint(hit.t), hit.triangle, hit.instance, seen);
    hits[2u * i + 1u] = uvec4(floatBitsToUint(hit.barycentrics), tested, hit.record);
}
