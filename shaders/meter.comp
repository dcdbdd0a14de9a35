/*
 * meter.comp: luminance histogram of the image. An invocation reads 4x4 pixels. A workgroup adds up
 * its bins in shared memory, then adds them to the buffer. Integers only: the sums do not depend on
 * order.
 *
 * Push constants: render_*: image size, output_*: invocations.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/exposure.h"
#include "shared/types.h"
#include "shared/globals.glsl"
#include "shared/tone.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D hdr_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_EXPOSURE, std430) buffer Exposure
{
    uint header[MASU_EXPOSURE_HEADER];
    uint bins[MASU_EXPOSURE_BINS];
};

shared uint counts[MASU_EXPOSURE_BINS];

void main()
{
    for (uint k = 0u; k < uint(MASU_EXPOSURE_BINS); k += 64u) {
        counts[k + gl_LocalInvocationIndex] = 0u;
    }
    barrier();
    ivec2 from = 4 * ivec2(gl_GlobalInvocationID.xy);
    for (int k = 0; k < 16; k++) {
        ivec2 at = from + ivec2(k & 3, k >> 2);
        if (all(lessThan(at, ivec2(pc.render_width, pc.render_height)))) {
            uint bin = masu_luminance_bin(texelFetch(hdr_image, at, 0).rgb);
            if (bin < uint(MASU_EXPOSURE_BINS)) {
                atomicAdd(counts[bin], 1u);
            }
        }
    }
    barrier();
    for (uint k = 0u; k < uint(MASU_EXPOSURE_BINS); k += 64u) {
        uint n = counts[k + gl_LocalInvocationIndex];
        if (n > 0u) {
            atomicAdd(bins[k + gl_LocalInvocationIndex], n);
        }
    }
}
