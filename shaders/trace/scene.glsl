/*
 * scene.glsl: the buffers that rays are traced through, and what lies behind nodes and triangles there:
 * the blue noise, materials, small pictures of the textures, and where instances were in the previous frame.
 *
 *   masu_trace_static[0].w   where the rest begins: a header of where materials, pictures and texels begin; then
 *                            the tile of noise, four words to an element
 *   masu_trace_static[0].z   how many triangles, masu_trace_frame[0].z how many traced instances there are
 *   masu_trace_frame[0].w    of each traced instance six rows: object to world minus anchor, and the same as
 *                            of the previous frame; then, with looks, two rows of each
 *
 * Triangles hold the number of their material here, not that of their primitive as in the blob; MASU_TRACE_HOLES
 * with it: of a mask that has a picture; MASU_TRACE_SINGLE: of what is not seen from behind. So a ray asks no material
 * of what is whole.
 */
#ifndef MASU_TRACE_SCENE_GLSL
#define MASU_TRACE_SCENE_GLSL

#include "shared/trace.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE, std430) readonly buffer Trace
{
    uvec4 masu_trace_static[];
};

/* Of the tile of noise: noise/sequence.glsl says which word. */
uint masu_trace_noise(uint word)
{
    return masu_trace_static[masu_trace_static[0].w + 1u + (word >> 2)][word & 3u];
}

#ifdef MASU_TRACE_POLYGONS
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE_FRAME, std430) readonly buffer TraceFrame
{
    uvec4 masu_trace_frame[];
};
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE_VERTICES, std430) readonly buffer TraceVertices
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

/* Of a vertex: unit normal, object space. */
vec3 masu_trace_vertex_normal(uint vertex)
{
    return masu_oct_decode(max(unpackSnorm2x16(masu_trace_vertices[vertex].w), vec2(-1.0)));
}

/* What an image says that a ray has met, which may hold anything, as far as there is such a thing. */
uint masu_trace_instance(uint traced)
{
    return min(traced, max(masu_trace_frame[0].z, 1u) - 1u);
}

/* Its three vertices, and its material. */
uvec4 masu_trace_triangle(uint triangle)
{
    uvec4 head = masu_trace_static[0];
    return masu_trace_static[head.x + min(triangle, max(head.z, 1u) - 1u)];
}

/* Row of a traced instance's transform, object to world minus anchor: 0 to 2 now, 3 to 5 in the previous frame. */
vec4 masu_trace_row(uint traced, uint row)
{
    return uintBitsToFloat(masu_trace_frame[masu_trace_frame[0].w + 6u * traced + row]);
}

/* Row of a traced instance's look, if masu_looks: 0 tint, and factor on the emission; 1 offset and scale of texture
 * coordinates. */
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

/* What stands on a surface: by the cofactors, which are the inverse transposed but for a factor. */
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
