/*
 * fsr1.comp: EASU and RCAS in one pass: with debug.exact bit for bit what easu.comp and rcas.comp make of it in two.
 * A workgroup of GROUP x GROUP upscales its block of pixels and a border of one to shared memory,
 * as 10 bits, and sharpens from there: the image between the passes, 8 bytes of traffic for each
 * output pixel, is not needed, and (BLOCK + 2)^2 / BLOCK^2 = 1.13 times the pixels are upscaled.
 *
 * Push constants: as easu.comp, push.lobe and push.stops as rcas.comp.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/fsr1.h"
#include "shared/types.h"
#include "shared/output.glsl"
#include "shared/unorm.glsl"
#include "upscale/easu.glsl"
#include "upscale/place.glsl"
#include "upscale/rcas.glsl"
#include "upscale/taps.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT) uniform writeonly MASU_COLOR_IMAGE target;

const int block = MASU_FSR1_BLOCK;
const int side = block + 2;
const int group = MASU_GROUP * MASU_GROUP;
shared uint upscaled[side * side]; /* 10 bits a channel: 4.6 KB of the 16 that every device has */

vec3 easu(uvec2 at)
{
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    masu_taps t = masu_fetch_taps(source, place.texel);
    return masu_easu(t, masu_edge_of(t, place.p), place.p);
}

vec3 upscaled_at(int i)
{
    uvec3 steps = uvec3(upscaled[i], upscaled[i] >> 10, upscaled[i] >> 20) & 1023u;
    return masu_fetched_unorm(vec3(steps) * (1.0 / 1023.0));
}

void main()
{
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    ivec2 first = ivec2(gl_WorkGroupID.xy) * block;
    int own = int(gl_LocalInvocationIndex);
    for (int round = 0; round < (side * side + group - 1) / group; round++) {
        int i = min(round * group + own, side * side - 1);
        ivec2 at = first - 1 + ivec2(i % side, i / side);
        /* RCAS repeats the edge of the picture. */
        uint bits = masu_ten_bits(easu(uvec2(clamp(at, ivec2(0), last))));
        if (round * group + own < side * side) {
            upscaled[i] = bits;
        }
    }
    barrier();
    for (int round = 0; round < block * block / group; round++) {
        int i = round * group + own;
        ivec2 at = ivec2(i % block, i / block);
        int centre = (at.y + 1) * side + at.x + 1;
        at += first;
        if (all(lessThanEqual(at, last))) {
            vec3 up = upscaled_at(centre - side), left = upscaled_at(centre - 1), c = upscaled_at(centre);
            vec3 right = upscaled_at(centre + 1), down = upscaled_at(centre + side);
#ifdef MASU_EXACT
            vec3 sharpened = masu_rcas(up, left, c, right, down, push.lobe, push.stops);
#else
            /* The other one of the pair that rcas.comp makes at once. */
            int other = centre + ((at.x & 1) == 0 ? 1 : -1);
            vec3 off = masu_rcas_off(up, left, c, right, down);
            vec3 off2 = masu_rcas_off(upscaled_at(other - side), upscaled_at(other - 1), upscaled_at(other),
                                      upscaled_at(other + 1), upscaled_at(other + side));
            vec3 sharpened = c;
            if (masu_rcas_asked(off, off2)) {
                sharpened = c + masu_rcas_share(up, left, c, right, down, push.stops) * off;
            }
#endif
            MASU_STORE_FILTERED(target, at, sharpened);
        }
    }
}
