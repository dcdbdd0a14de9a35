/*
 * local_shadow_keep.vert: a quad over the tile of each shadow face that the frame renders, six
 * vertices per face. A slot without a face is degenerate.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/local_shadow.h"
#include "shared/types.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LOCAL_FACES, std140) uniform LocalFaces
{
    masu_local_face_uniforms faces;
};

layout(location = 0) flat out uint out_face;

void main()
{
    uint k = min(uint(gl_VertexIndex) / 6u, uint(MASU_LOCAL_FACES_MAX - 1));
    uint corner = uint(gl_VertexIndex) % 6u;
    bvec2 far = bvec2(corner == 1u || corner == 2u || corner == 4u,
                      corner == 2u || corner == 4u || corner == 5u);
    vec2 at = vec2(faces.tile[k].xy + mix(uvec2(0u), faces.tile[k].zz, far));
    out_face = k;
    gl_Position = vec4(at * (2.0 / float(faces.square.z)) - 1.0, 0.0, 1.0);
}
