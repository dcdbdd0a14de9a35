/*
 * cascade.frag: discards the holes of masked polygons in the sun's shadow map; depth is the only
 * output.
 * push.flags: the material's flags, push.layers: the layers of its maps.
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
