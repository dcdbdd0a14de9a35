/*
 * local_shadow.vert: polygons in the view of a punctual light, for one of the shadow faces that a
 * frame renders. push.face is the face. Positions are relative to the light, not to the camera: a
 * face does not depend on the camera, so it can be cached.
 *
 * Vertices are drawn below smooth surfaces by push.rise at most, as in cascade.vert.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/local_shadow.h"
#include "shared/local_shadow.h"
#include "shared/materials.h"
#include "shared/polygons.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LOCAL_FACES, std140) uniform LocalFaces
{
    masu_local_face_uniforms faces;
};

#ifdef MASU_TEXTURES
layout(location = 2) in vec2 texcoord;
layout(location = 3) out vec2 out_texcoord;
#endif

void main()
{
    uint id = masu_instance_id();
    masu_instance_data m = instances[id];
    uint k = min(push.face, uint(MASU_LOCAL_FACES_MAX - 1));
    vec3 thinner = position - push.rise * masu_oct_decode(oct_normal);
    precise vec3 at = masu_point_seen_from(m, thinner, faces.origin_hi[k].xyz,
                                           faces.origin_lo[k].xyz);
    precise float x = dot(faces.row0[k].xyz, at) * faces.row0[k].w;
    precise float y = dot(faces.row1[k].xyz, at) * faces.row0[k].w;
    precise float z = dot(faces.row2[k].xyz, at);
#ifdef MASU_TEXTURES
    out_texcoord = masu_moved_texcoord(id, texcoord);
#endif
    gl_Position = vec4(x + z * faces.row1[k].w, y + z * faces.row1[k].w, faces.row2[k].w, z);
}
