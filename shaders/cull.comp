/*
 * cull.comp: occlusion culling: tests the bounds of each instance that stage 1 has kept against
 * every atlas texel that they can touch. One invocation per kept instance; views in y.
 *
 * The result is a 32-bit value per view and instance that persists over frames. Occluded instances
 * are tested in every frame, so that they are drawn in the frame in which they appear. Visible
 * instances are tested in every fifth frame that draws the view. After a camera cut all are tested.
 * A stale or random value therefore costs time but never a pixel.
 *
 * Shadow casters are also culled if their shadow falls on no visible surface, in cascades that only
 * this frame samples: for each texel of the sun's part of the atlas, receiver_mask.comp has stored
 * the distance from the sun of the farthest visible surface that samples the cascade there.
 *
 * push.header: the header of src/frame/occlusion.c. push.view: the first view.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/cull.h"
#include "shared/counters.h"
#include "shared/culling.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/culling.glsl"

layout(local_size_x = 64) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D occluder_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SEEN, std430) buffer Seen
{
    uint seen[];
};

/* Larger rectangles are assumed visible: they nearly always are. */
#define MASU_TEXELS_MOST 16384

/* Whether a visible surface is farther from the sun than `nearest`, in texels where the shadow may
 * be sampled. */
bool receives(uint cascade, vec2 low, vec2 high, float nearest)
{
    ivec2 from = ivec2(clamp(floor(low), vec2(0.0), vec2(MASU_ATLAS_SUN)));
    ivec2 to = ivec2(clamp(ceil(high), vec2(0.0), vec2(MASU_ATLAS_SUN)));
    if ((to.x - from.x) * (to.y - from.y) > MASU_TEXELS_MOST) {
        return true;
    }
    uint words = masu_cull_word(MASU_CULL_RECEIVERS) + cascade * MASU_RECEIVER_WORDS;
    uint depth = floatBitsToUint(max(nearest, 0.0));
    bool any = false;
    for (int y = 0; y < MASU_ATLAS_SUN; y++) {
        if (any || from.y + y >= to.y) {
            break;
        }
        for (int x = 0; x < MASU_ATLAS_SUN; x++) {
            if (any || from.x + x >= to.x) {
                break;
            }
            any = seen[words + uint((from.y + y) * MASU_ATLAS_SUN + from.x + x)] < depth;
        }
    }
    return any;
}

bool hidden(uint view, vec3 center, vec3 extent)
{
    uint at = masu_cull_view(view);
    mat4 clip = masu_cull_matrix(at + MASU_CULL_VIEW_CLIP);
    vec4 atlas = masu_drawn_vec4(at + MASU_CULL_VIEW_ATLAS);
    float margin = masu_drawn_float(at + MASU_CULL_VIEW_MARGIN);
    float near = masu_drawn_float(at + MASU_CULL_VIEW_NEAR);
    vec2 low = vec2(1e9), high = vec2(-1e9);
    float nearest = 0.0;
    for (int i = 0; i < 8; i++) {
        vec3 corner = vec3(i & 1, i >> 1 & 1, i >> 2) * 2.0 - 1.0;
        vec4 p = clip * vec4(center + corner * extent, 1.0);
        if (!(p.w > near)) {
            return false;
        }
        vec2 texel = (p.xy / p.w * 0.5 + 0.5) * atlas.zw;
        if (!(abs(texel.x) < 1e6) || !(abs(texel.y) < 1e6)) {
            return false;
        }
        low = min(low, texel);
        high = max(high, texel);
        nearest = max(nearest, p.z / p.w);
    }
    float reach = masu_drawn_float(at + MASU_CULL_VIEW_REACH);
    if (drawn[at + MASU_CULL_VIEW_TRIMMED] != 0u &&
        !receives(view - 1u, low - reach, high + reach, nearest * (1.0 + 1.2e-4) + 2e-6)) {
        return true;
    }
    /* 2^-13 for rounding of the interpolated depth, 2^-9 texel for the positions. */
    nearest = nearest * (1.0 + 1.2e-4) + masu_drawn_float(at + MASU_CULL_VIEW_BIAS);
    low = clamp(floor(low - margin - 0.002), vec2(0.0), atlas.zw);
    high = clamp(ceil(high + margin + 0.002), vec2(0.0), atlas.zw);
    ivec2 from = ivec2(low), to = ivec2(high);
    if (!(nearest < 1.0) || from.x >= to.x || from.y >= to.y ||
        (to.x - from.x) * (to.y - from.y) > MASU_TEXELS_MOST) {
        return false;
    }
    bool covered = true;
    for (int y = 0; y < 256; y++) {
        if (!covered || from.y + y >= to.y) {
            break;
        }
        for (int x = 0; x < 256; x++) {
            if (!covered || from.x + x >= to.x) {
                break;
            }
            ivec2 texel = ivec2(atlas.xy) + from + ivec2(x, y);
            covered = texelFetch(occluder_image, texel, 0).r > nearest;
        }
    }
    return covered;
}

void main()
{
    masu_count_begin();
    uint view = gl_WorkGroupID.y + push.view;
    uint instance_count = masu_cull_word(MASU_CULL_INSTANCES);
    uint kept = masu_cull_word(MASU_CULL_KEPT) + view * (instance_count + 1u);
    if (gl_GlobalInvocationID.x < min(drawn[kept], instance_count)) {
        uint id = drawn[kept + 1u + gl_GlobalInvocationID.x];
        uint word = view * instance_count + id;
        bool asked = seen[word] != 1u || masu_cull_word(MASU_CULL_CUT) != 0u ||
                     (id + drawn[masu_cull_view(view) + MASU_CULL_VIEW_TURN]) % 5u == 0u;
        if (asked) {
            uint box = masu_cull_word(MASU_CULL_BOXES) + 6u * id;
            vec3 center = (masu_drawn_vec3(box) - frame.eye_hi.xyz) - frame.eye_lo.xyz;
            seen[word] = hidden(view, center, masu_drawn_vec3(box + 3u)) ? 0u : 1u;
            masu_count(MASU_COUNTER_OCCLUSION_TESTS, 1u);
        }
    }
    masu_count_end();
}
