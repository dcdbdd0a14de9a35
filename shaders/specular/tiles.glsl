/*
 * tiles.glsl: the list of tiles that trace reflections, and the texel of an invocation of an
 * indirect pass.
 */
#ifndef MASU_SPECULAR_TILES_GLSL
#define MASU_SPECULAR_TILES_GLSL

#include "shared/types.h"
#include "shared/globals.glsl"

#ifndef MASU_SPECULAR_TILES_ACCESS
#define MASU_SPECULAR_TILES_ACCESS readonly
#endif
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SPECULAR_TILES, std430)
    MASU_SPECULAR_TILES_ACCESS buffer SpecularTiles
{
    uint specular_tiles[];
};

uint masu_specular_columns()
{
    return (pc.output_width + uint(MASU_GROUP) - 1u) / uint(MASU_GROUP);
}

/* The texel of this invocation in a workgroup of 8x8. */
uvec2 masu_specular_texel()
{
    uint tile = specular_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x];
    uint columns = masu_specular_columns();
    return uvec2(tile % columns, tile / columns) * uint(MASU_GROUP) + gl_LocalInvocationID.xy;
}

bool masu_specular_inside(uvec2 texel)
{
    return all(lessThan(texel, uvec2(pc.output_width, pc.output_height)));
}

#endif
