/*
 * textures.comp: copies the texels that the host has written for this frame to live textures. One
 * invocation per texel of the largest rectangle, a layer of workgroups per write. The head of the
 * buffer is in shared/sprites.h. If rectangles of a texture overlap, the later write is kept.
 * Texels are copied unchanged, through a view of 32-bit integers.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/sprites.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/push.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0, r32ui) uniform writeonly uimage2DArray textures_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TEXELS, std430) readonly buffer Texels
{
    uint texels[];
};

struct region {
    uvec2 first, size;
    uint layer, from;
};

region region_of(uint i)
{
    uint at = uint(MASU_TEXELS_HEAD) + uint(MASU_TEXTURE_WRITE_WORDS) * i;
    return region(uvec2(texels[at], texels[at + 1u]), uvec2(texels[at + 2u], texels[at + 3u]),
                  texels[at + 4u], texels[at + 5u]);
}

void main()
{
    masu_count_begin();
    uint count = min(texels[3], uint(MASU_TEXTURE_WRITES));
    region r = region_of(gl_WorkGroupID.z);
    uvec2 own = gl_GlobalInvocationID.xy, at = r.first + own;
    bool last = all(lessThan(own, r.size)) &&
                all(lessThan(at, uvec2(imageSize(textures_image).xy)));
    for (uint i = 1u; i < uint(MASU_TEXTURE_WRITES) && last; i++) {
        uint later = gl_WorkGroupID.z + i;
        if (later >= count) {
            break;
        }
        region over = region_of(later);
        last = over.layer != r.layer || any(greaterThanEqual(at - over.first, over.size));
    }
    if (last) {
        MASU_STORE_LAYER(textures_image, at, int(r.layer),
                         uvec4(texels[r.from + own.y * r.size.x + own.x]));
    }
    masu_count_end();
}
