/*
 * cull.comp: whether an instance that stage 1 has kept is hidden by occluders: its box against every
 * texel of the atlas that it can touch. One invocation per kept instance; views in y.
 *
 * The answer is a word per view and instance that outlives the frame: what was hidden is asked again
 * in every frame, so that it is drawn in the frame in which it appears; what was visible, in every
 * fifth of those that draw the view. After a cut all are asked. A word that is older than it should be, or noise, therefore costs
 * time and never a pixel.
 *
 * A caster whose shadow falls on nothing in the picture is hidden as well, in cascades that this frame
 * alone looks at: of each texel of the sun's part of the atlas, receiver_mask.comp has noted how far from
 * the sun the farthest surface in the picture is that looks into the cascade.
 *
 * push.header: the header of src/frame/occlusion.c; push.view: the first view.
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

/* Larger rectangles are taken to be visible: they nearly always are. */
#define MASU_TEXELS_MOST 16384

/* Whether a surface of the picture lies behind what is at `nearest`, in texels that its shadow may be looked
 * up in. */
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
    /* 2^-13 for the depth that the raster interpolates, 2^-9 texel for the positions. */
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
