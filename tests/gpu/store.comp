/* store.comp: the macros of shaders/shared/store.glsl on an image of integers, for test_store.c:
 * the values and positions stored, and how often a value was replaced. */
#version 440
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64) in;

struct stored {
    vec4 value;
    uvec4 bits; /* of an image of integers; times stored; replaced */
};

layout(set = 0, binding = 0, std430) readonly buffer Values { vec4 values[]; };
layout(set = 0, binding = 1, std430) buffer Stored { stored out_of[]; };
layout(push_constant) uniform Push { uint count; } push;

uint at, replaced;

#define imageSize(img) ivec2(4, 3)
#define imageStore(img, p, v) keep(v)
#define MASU_COUNT_REPLACED(n) replaced += (n)

void keep(vec4 v)
{
    out_of[at].value = v;
    out_of[at].bits.y++;
}

void keep(uvec4 v)
{
    out_of[at].bits.x = v.x;
    out_of[at].bits.y++;
}

#include "shared/store.glsl"

/* For each value: UNORM, HALF, R32F, TEN inside the image, then UNORM at positions around it. */
void main()
{
    uint i = gl_GlobalInvocationID.x;
    const ivec2 places[6] = ivec2[6](ivec2(3, 2), ivec2(-1, 0), ivec2(0, -1), ivec2(4, 0), ivec2(0, 3), ivec2(0, 0));
    if (i >= push.count) {
        return;
    }
    for (uint k = 0u; k < 10u; k++) {
        at = 10u * i + k;
        replaced = 0u;
        if (k == 0u) {
            MASU_STORE_UNORM(0, ivec2(1, 1), values[i]);
        } else if (k == 1u) {
            MASU_STORE_HALF(0, ivec2(1, 1), values[i]);
        } else if (k == 2u) {
            MASU_STORE_R32F(0, ivec2(1, 1), values[i].x);
        } else if (k == 3u) {
            MASU_STORE_TEN(0, ivec2(1, 1), values[i].rgb);
        } else {
            MASU_STORE_UNORM(0, places[k - 4u], values[i]);
        }
        out_of[at].bits.z = replaced;
    }
}
