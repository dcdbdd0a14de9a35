/*
 * cascade.frag: of masked polygons that the sun sees, what their alpha leaves; depth is the only
 * output. push.flags: the material's flags, push.layers: the layers of its maps.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/cascade.h"
#include "shared/pack.glsl"

#include "shared/push.glsl"

#include "shared/maps.glsl"

layout(location = 3) in vec2 in_texcoord;

void main()
{
    if (!(masu_base(in_texcoord).a >= masu_cutoff())) {
        discard;
    }
}
