/*
 * local_shadow_keep.frag: a texel of a shadow face from where the frame has rendered it to its tile of the atlas.
 * Rounded to the 16 bits of the atlas away from the light, so that a surface is not behind itself.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/local_shadow.h"
#include "shared/types.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LOCAL_FACES, std140) uniform LocalFaces
{
    masu_local_face_uniforms faces;
};

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D faces_image;

layout(location = 0) flat in uint in_face;

void main()
{
    uint k = min(in_face, uint(MASU_LOCAL_FACES_MAX - 1));
    uvec2 texel = uvec2(gl_FragCoord.xy) - faces.tile[k].xy;
    uvec2 square = uvec2(k % faces.square.y, k / faces.square.y) * faces.square.x;
    float depth = texelFetch(faces_image, ivec2(square + texel), 0).r;
    gl_FragDepth = floor(clamp(depth, 0.0, 1.0) * 65535.0) * (1.0 / 65535.0);
}
