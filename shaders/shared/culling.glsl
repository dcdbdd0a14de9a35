/*
 * culling.glsl: the host's data for occlusion culling, in the buffer of drawn instances after the
 * lists of stage 1. shared/culling.h names the fields of its header; src/frame/occlusion.c writes
 * them.
 */
#ifndef MASU_CULLING_GLSL
#define MASU_CULLING_GLSL

#include "shared/culling.h"
#include "shared/types.h"

#ifndef MASU_DRAWN_ACCESS
#define MASU_DRAWN_ACCESS readonly
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_DRAWN, std430) MASU_DRAWN_ACCESS buffer Drawn
{
    uint drawn[];
};

/* A value of the header, which begins at push.header. */
uint masu_cull_word(uint i)
{
    return drawn[push.header + i];
}

float masu_drawn_float(uint at)
{
    return uintBitsToFloat(drawn[at]);
}

vec3 masu_drawn_vec3(uint at)
{
    return vec3(masu_drawn_float(at), masu_drawn_float(at + 1u), masu_drawn_float(at + 2u));
}

vec4 masu_drawn_vec4(uint at)
{
    return vec4(masu_drawn_vec3(at), masu_drawn_float(at + 3u));
}

/* Offset of the data of a view. */
uint masu_cull_view(uint view)
{
    return push.header + MASU_CULL_HEADER + view * MASU_CULL_VIEW_WORDS;
}

mat4 masu_cull_matrix(uint at)
{
    return mat4(masu_drawn_vec4(at), masu_drawn_vec4(at + 4u), masu_drawn_vec4(at + 8u),
                masu_drawn_vec4(at + 12u));
}

#endif
