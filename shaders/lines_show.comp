/*
 * lines_show.comp: draws the debug lines over the output image, in its encoding. Pixels without a
 * line are not written. push.white: nits.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#include "push/lines_show.h"
#include "shared/target.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/output.glsl"
#include "shared/encode.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D overlay_image;
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE target;

float light_of(float v)
{
    return v <= 0.04045 ? v / 12.92 : masu_pow((v + 0.055) / 1.055, 2.4);
}

void main()
{
    masu_count_begin();
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!masu_is_outside(gl_GlobalInvocationID.xy)) {
        vec4 line = texelFetch(overlay_image, at, 0);
        if (line.a > 0.5) {
            vec3 shown = line.rgb;
            if (masu_encoding != MASU_OUTPUT_SRGB) {
                shown = masu_encoded(vec3(light_of(shown.r), light_of(shown.g), light_of(shown.b)),
                                     push.white);
            }
            MASU_STORE_COLOR(target, at, shown);
        }
    }
    masu_count_end();
}
