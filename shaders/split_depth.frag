/*
 * split_depth.frag: depth of what is nearest, polygons and SDF alike, into a depth attachment: the march leaves it in
 * an image that is none, and the host's own commands (masu_desc.split) test against it.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;

void main()
{
    gl_FragDepth = texelFetch(depth_image, ivec2(gl_FragCoord.xy), 0).r;
}
