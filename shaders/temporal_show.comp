/*
 * temporal_show.comp: prototype
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#define MASU_PUSH masu_push_temporal_show
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "shared/encode.glsl"
#include "temporal/history.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D accumulated_image;
layout(set = MASU_SET_PASS, binding = 1, rgba16f) uniform writeonly image2D history_image;
layout(set = MASU_SET_PASS, binding = 2, MASU_COLOR_FORMAT) uniform writeonly MASU_COLOR_IMAGE target;

/*PAR*/
#define CAP 32.0
#define CAP_MOVE 2.0
#define SHARPEN 0.06
#define CLIP 1.0
#define WHERE true
/*END*/
/*DEF*/
#ifndef SHARPEN
#define SHARPEN 0.0
#endif
vec3 at_place(ivec2 p)
{
    return texelFetch(accumulated_image, clamp(p, ivec2(0), ivec2(pc.output_width, pc.output_height) - 1), 0).rgb;
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (masu_is_outside(at)) {
        return;
    }
    vec4 h = texelFetch(accumulated_image, ivec2(at), 0);
    MASU_STORE_HALF(history_image, at, h);
    vec3 l = at_place(ivec2(at) + ivec2(-1, 0)), r = at_place(ivec2(at) + ivec2(1, 0)),
                 u = at_place(ivec2(at) + ivec2(0, -1)), d = at_place(ivec2(at) + ivec2(0, 1));
    vec3 least = min(h.rgb, min(min(l, r), min(u, d))), most = max(h.rgb, max(max(l, r), max(u, d)));
    vec3 y = clamp(h.rgb + SHARPEN * (4.0 * h.rgb - l - r - u - d), least, most);
    MASU_STORE_COLOR(target, at, masu_encoded(y * push.peak, push.white));
}
