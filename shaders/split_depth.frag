/*
 * split_depth.frag: copies the depth of polygons and SDF to a depth attachment. The march writes it
 * to a plain image, but the host's own commands (masu_desc.split) need an attachment for their
 * depth test.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;

void main()
{
    gl_FragDepth = texelFetch(depth_image, ivec2(gl_FragCoord.xy), 0).r;
}
