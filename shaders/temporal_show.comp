/*
 * temporal_show.comp: what rung.temporal shows of the mean over frames, encoded; and the mean itself for the next
 * frame, which finds it where this one has left it.
 *
 * Of what moves a sample counts for the pixels around it by a tent, twice as wide as the pixel (below full size a little
 * wider): steadier than what falls into the pixel alone, but blurred. Of what that and the history's resampling take,
 * push.sharpen gives some back; push.moving does while the view moves, for all of the history is resampled then. Both
 * times the second difference. (The variance of a tent is 1/12 of a pixel above that of a pixel; half of it per axis is
 * 1/24.) Of what rests in a world that does, which is no tent's, push.calm, less than half of it. What
 * is kept is not sharpened: it would be again in every frame.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#define MASU_PUSH masu_push_temporal_show
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "shared/encode.glsl"
#include "upscale/mean.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D accumulated_image;
layout(set = MASU_SET_PASS, binding = 1, rg32ui) uniform writeonly uimage2D history_image;
layout(set = MASU_SET_PASS, binding = 2, MASU_COLOR_FORMAT) uniform writeonly MASU_COLOR_IMAGE target;

vec3 light_at(ivec2 at)
{
    return texelFetch(accumulated_image, at, 0).rgb;
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (masu_is_outside(gl_GlobalInvocationID.xy)) {
        return;
    }
    ivec2 before = max(at - 1, 0), after = min(at + 1, ivec2(pc.output_width, pc.output_height) - 1);
    vec4 mean = texelFetch(accumulated_image, at, 0);
    vec3 left = light_at(ivec2(before.x, at.y)), right = light_at(ivec2(after.x, at.y)),
         above = light_at(ivec2(at.x, before.y)), below = light_at(ivec2(at.x, after.y));
    bool rests = frame.temporal.z < MASU_TEMPORAL_CHANGES && masu_mean_rests(mean);
    float moving = (frame.temporal.z & MASU_TEMPORAL_MOVES) != 0u ? push.moving : push.sharpen;
    float sharpen = rests ? push.calm : moving;
    vec3 sharp = mean.rgb + sharpen * (4.0 * mean.rgb - left - right - above - below);
#if defined(MASU_TEN) || defined(MASU_DEEP) /* no store clamps it */
    sharp = clamp(sharp, 0.0, 1.0);
#endif
    MASU_STORE_SAFE(history_image, at, masu_mean_packed(mean));
    MASU_STORE_FILTERED(target, at, masu_encoded_open(sharp, push.peak, push.white));
}
