/*
 * local_shadow_keep.frag: copies a texel of a rendered shadow face to its tile of the atlas.
 * Rounded to the 16 bits of the atlas away from the light, so that a surface does not shadow
 * itself.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/local_shadow.h"
#include "shared/types.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LOCAL_FACES, std140) uniform LocalFaces
{
    masu_local_face_uniforms faces;
};

#ifdef MASU_NO_POLYGONS
#define MASU_AT_SDF 0
#else
#define MASU_AT_SDF 1
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D faces_image;
#endif
#ifdef MASU_SDF_CASTS
layout(set = MASU_SET_PASS, binding = MASU_AT_SDF) uniform usampler2D sdf_image;
#endif

layout(location = 0) flat in uint in_face;

void main()
{
    uint k = min(in_face, uint(MASU_LOCAL_FACES_MAX - 1));
    uvec2 texel = uvec2(gl_FragCoord.xy) - faces.tile[k].xy;
    uvec2 square = uvec2(k % faces.square.y, k / faces.square.y) * faces.square.x;
    float depth = 0.0; /* in 65535ths */
#ifndef MASU_NO_POLYGONS
    depth = floor(clamp(texelFetch(faces_image, ivec2(square + texel), 0).r, 0.0, 1.0) * 65535.0);
#endif
#ifdef MASU_SDF_CASTS
    if (faces.tile[k].w != 0u) {
        uvec2 at = uvec2(gl_FragCoord.xy);
        uint pair = texelFetch(sdf_image, ivec2(at / uvec2(2u, 1u)), 0).r;
        depth = max(depth, float((at.x & 1u) != 0u ? pair >> 16 : pair & 0xFFFFu));
    }
#endif
    gl_FragDepth = depth * (1.0 / 65535.0);
}
