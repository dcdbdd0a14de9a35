/*
 * cascade.frag: of masked polygons that the sun sees, what their alpha leaves; depth is the only
 * output. index.z: the material's flags, index.w: the layers of its maps.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/pack.glsl"

layout(push_constant) uniform Push
{
    masu_push pc;
};

#include "shared/maps.glsl"

layout(location = 3) in vec2 in_texcoord;

void main()
{
    if (!(masu_base(in_texcoord).a >= masu_cutoff())) {
        discard;
    }
}
