/*
 * skin_previous.comp: previous positions of the vertices of skin.comp, from the previous frame's
 * matrices, which are stored behind the current ones. Computed again instead of copied: no state
 * crosses frames.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/skin_previous.h"
#include "shared/types.h"
#include "shared/pack.glsl"
#include "shared/push.glsl"
#include "shared/skinning.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PREVIOUS_VERTICES, std430) writeonly buffer
    PreviousVertices
{
    float previous_vertices[];
};

void main()
{
    uint rest, vertex, matrices;
    if (!masu_find_vertex(push.half_elements, rest, vertex, matrices)) return;
    vec3 position = masu_bend(push.half_elements, rest, matrices).position;
    uint k = 3u * (vertex - push.first_vertex);
    previous_vertices[k] = position.x;
    previous_vertices[k + 1u] = position.y;
    previous_vertices[k + 2u] = position.z;
}
