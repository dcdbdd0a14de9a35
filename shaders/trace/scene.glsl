/*
 * scene.glsl: the buffers of ray tracing, and the data that follows nodes and triangles in them:
 * blue noise, materials, small copies of the textures, and the transforms of the present and the
 * previous frame.
 *
 *   masu_trace_static[0].w   where these begin: a header with the offsets of materials, textures
 *                            and texels; then the noise tile, four values per element
 *   masu_trace_static[0].z   number of triangles; masu_trace_frame[0].z: number of traced instances
 *   masu_trace_frame[0].w    six rows per traced instance: object to world minus anchor, now and in
 *                            the previous frame; then, with looks, two rows per instance
 *
 * Triangles hold the number of their material here, not of their primitive as in the blob, with the
 * flags MASU_TRACE_HOLES: an alpha mask with a texture; MASU_TRACE_SINGLE: single-sided. So a ray
 * reads no material of opaque, double-sided triangles.
 */
#ifndef MASU_TRACE_SCENE_GLSL
#define MASU_TRACE_SCENE_GLSL

#include "shared/trace.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE, std430) readonly buffer Trace
{
    uvec4 masu_trace_static[];
};

/* A value of the noise tile; noise/sequence.glsl has the index. */
uint masu_trace_noise(uint word)
{
    return masu_trace_static[masu_trace_static[0].w + 1u + (word >> 2)][word & 3u];
}

#ifdef MASU_TRACE_POLYGONS
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE_FRAME, std430) readonly buffer TraceFrame
{
    uvec4 masu_trace_frame[];
};
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE_VERTICES, std430)
    readonly buffer TraceVertices
{
    uvec4 masu_trace_vertices[];
};

masu_trace_material masu_trace_material_at(uint material)
{
    uint at = masu_trace_static[masu_trace_static[0].w].x + 4u * material;
    masu_trace_material m;
    m.base_color = uintBitsToFloat(masu_trace_static[at]);
    m.emissive = uintBitsToFloat(masu_trace_static[at + 1u]);
    m.more = uintBitsToFloat(masu_trace_static[at + 2u]);
    m.maps = masu_trace_static[at + 3u];
    return m;
}

/* Normal of a vertex: unit, object space. */
vec3 masu_trace_vertex_normal(uint vertex)
{
    return masu_oct_decode(max(unpackSnorm2x16(masu_trace_vertices[vertex].w), vec2(-1.0)));
}

/* Clamps an instance number from an image, which may hold anything, to the existing ones. */
uint masu_trace_instance(uint traced)
{
    return min(traced, max(masu_trace_frame[0].z, 1u) - 1u);
}

/* The three vertices of a triangle, and its material. */
uvec4 masu_trace_triangle(uint triangle)
{
    uvec4 head = masu_trace_static[0];
    return masu_trace_static[head.x + min(triangle, max(head.z, 1u) - 1u)];
}

/* Row of a traced instance's transform, object to world minus anchor: 0 to 2 now, 3 to 5 in the
 * previous frame. */
vec4 masu_trace_row(uint traced, uint row)
{
    return uintBitsToFloat(masu_trace_frame[masu_trace_frame[0].w + 6u * traced + row]);
}

/* Row of a traced instance's look, if masu_looks: 0 tint, and factor on the emission; 1 offset and
 * scale of texture coordinates. */
layout(constant_id = 24) const uint masu_draws_more = 0u; /* MASU_DRAWS_* */
const bool masu_looks = (masu_draws_more & MASU_DRAWS_LOOKS) != 0u;
vec4 masu_trace_look(uint traced, uint row)
{
    uvec4 head = masu_trace_frame[0];
    return uintBitsToFloat(masu_trace_frame[head.w + 6u * head.z + 2u * traced + row]);
}

vec3 masu_trace_now(uint traced, vec4 p)
{
    return vec3(dot(masu_trace_row(traced, 0u), p), dot(masu_trace_row(traced, 1u), p),
                dot(masu_trace_row(traced, 2u), p));
}

vec3 masu_trace_before(uint traced, vec4 p)
{
    return vec3(dot(masu_trace_row(traced, 3u), p), dot(masu_trace_row(traced, 4u), p),
                dot(masu_trace_row(traced, 5u), p));
}

/* Transforms a normal to world space by the cofactors: the inverse transpose up to a factor. */
vec3 masu_trace_upright(uint traced, vec3 normal)
{
    vec3 x = masu_trace_row(traced, 0u).xyz;
    vec3 y = masu_trace_row(traced, 1u).xyz;
    vec3 z = masu_trace_row(traced, 2u).xyz;
    vec3 yz = cross(y, z);
    vec3 n = vec3(dot(yz, normal), dot(cross(z, x), normal), dot(cross(x, y), normal));
    return dot(yz, x) < 0.0 ? -n : n;
}
#endif

#endif
