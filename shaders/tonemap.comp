/*
 * tonemap.comp: exposure, a filmic curve, sRGB encoding. FSR1 wants what comes out here:
 * display-encoded, 0..1.
 *
 * Curve: K. Narkowicz's rational fit of the ACES reference rendering transform ("ACES Filmic Tone
 * Mapping Curve", 2016). It reaches 1 near x = 8.1 and would run past it: the store clamps.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D hdr_image;
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D ldr_image;

vec3 curve(vec3 x)
{
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

/* IEC 61966-2-1, linear to encoded. */
float encode(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * masu_pow(x, 1.0 / 2.4) - 0.055;
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        vec3 hdr = texelFetch(hdr_image, ivec2(at), 0).rgb;
        /* Layers that add up to more than a half holds are bright, not broken. */
        hdr = mix(hdr, vec3(65504.0), equal(floatBitsToUint(hdr), uvec3(masu_exponent_mask)));
        /* 1e4 is far past white, and keeps the squares of the curve in range. */
        vec3 x = masu_sane(hdr * frame.sun_direction.w, 0.0, 1e4);
        vec3 y = curve(x);
        MASU_STORE_UNORM(ldr_image, at, vec4(encode(y.r), encode(y.g), encode(y.b), 1.0));
    }
    masu_count_end();
}
