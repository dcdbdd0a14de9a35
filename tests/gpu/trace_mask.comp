/* trace_mask.comp: rays through shaders/trace/bvh.glsl with a hook: rays pass through triangles
 * below push.y if the weight of the second corner is below a half. Bindings and results as in
 * shaders/trace_rays.comp. */
#version 440
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Static { uvec4 masu_trace_static[]; };
layout(set = 0, binding = 1, std430) readonly buffer Frame { uvec4 masu_trace_frame[]; };
layout(set = 0, binding = 2, std430) readonly buffer Vertices { uvec4 masu_trace_vertices[]; };
layout(set = 0, binding = 3, std430) readonly buffer Rays { vec4 rays[]; };
layout(set = 0, binding = 4, std430) writeonly buffer Hits { uvec4 hits[]; };
layout(push_constant) uniform Push { uvec4 push; };

bool opaque(uint triangle, uint instance, vec2 weights)
{
    return triangle >= push.y || weights.x >= 0.5 || instance > 0u;
}
#define MASU_TRACE_OPAQUE(triangle, instance, weights, d) opaque(triangle, instance, weights)

#define MASU_TRACE_LANES 64
#include "trace/bvh.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.x) return;
    vec4 from = rays[2u * i], along = rays[2u * i + 1u];
    masu_ray_hit hit = masu_trace(from.xyz, along.xyz, from.w, along.w);
    bool any_hit = masu_trace_any(from.xyz, along.xyz, from.w, along.w);
    hits[2u * i] = uvec4(floatBitsToUint(hit.t), hit.triangle, hit.instance, any_hit ? 1u : 0u);
    hits[2u * i + 1u] = uvec4(floatBitsToUint(hit.barycentrics), 0u, hit.record);
}
