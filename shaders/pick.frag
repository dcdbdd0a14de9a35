/*
 * pick.frag: writes the instance of a polygon. push.blended: not 0 if it is transparent.
 * MASU_TEXTURES discards pixels by the map's alpha: push.layers are the layers of its maps.
 * push.flags: the material's. Mip levels are chosen as for stationary surfaces: with rung.temporal
 * a hole in a moving surface may differ by a pixel here.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/pick.h"
#include "shared/materials.h"
#include "shared/picking.h"
#include "shared/pack.glsl"

#include "shared/push.glsl"

#ifdef MASU_TEXTURES
#include "shared/maps.glsl"
layout(location = 3) in vec2 in_texcoord;
#endif

layout(location = 0) flat in uint in_id;
layout(location = 0) out uint out_id;

void main()
{
#ifdef MASU_TEXTURES
    if (!(masu_base(in_texcoord).a >= masu_cutoff())) {
        discard;
    }
#endif
    if ((push.flags & MASU_MAP_SINGLE) != 0u && !gl_FrontFacing) {
        discard;
    }
    out_id = (in_id + 1u) | (push.blended != 0u ? MASU_PICK_BLENDED : 0u);
}
