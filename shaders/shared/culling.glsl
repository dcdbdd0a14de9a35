/*
 * culling.glsl: what the host writes for occlusion culling, in the buffer of drawn instances behind
 * the lists of stage 1. masu_shared.h names the words of its header; src/frame/occlusion.c writes them.
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

/* A word of the header; push.header is where that begins. */
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

/* Where the numbers of a view begin. */
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
