/*
 * specular_keep_fine.comp: copies the full-resolution history for the next frame. Only the listed
 * tiles: the copied guide records which texels have traced rays (specular_keep.comp).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D fine_image;
layout(set = MASU_SET_PASS, binding = 1, rgba32ui) uniform writeonly uimage2D old_fine_image;

void main()
{
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        MASU_STORE_UINT(old_fine_image, texel, texelFetch(fine_image, ivec2(texel), 0));
    }
}
