/*
 * specular_guide.comp: selects the pixel of each 2x2 that is traced in this frame, and lists the
 * tiles of 8x8 texels with traced pixels. Only surfaces smoother than push.cutoff are traced. The
 * following passes run only for the listed tiles.
 *
 * A pixel that is not glossy is replaced by a glossy one of its 2x2: otherwise a rod one pixel wide
 * would be traced in every fourth frame only.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_guide.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "specular/guide.glsl"
#include "specular/surface.glsl"
#define MASU_SPECULAR_TILES_ACCESS
#include "specular/tiles.glsl"

/* Cosine of the largest angle between normals within a texel. */
const float alike = 0.98;

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE, rg32ui) uniform writeonly uimage2D
    guide_image;

shared uint any_glossy;

/* Whether another of the four pixels shows a different surface, or a normal so different that it
 * reflects something else. A mean over the texel would mix them, and restarts in each frame. */
bool is_mixed(uvec2 texel, uint pixel, masu_pixel p, uvec2 at)
{
    uvec2 last = uvec2(pc.render_width, pc.render_height) - 1u;
    vec3 n = masu_unpack_normal(p.normal);
    vec3 point = masu_guide_point(at, p.depth);
    float width = length(point) * frame.up.w * 2.0 / float(pc.render_height);
    for (uint k = 1u; k < 4u; k++) {
        uvec2 other = min(masu_guide_place(texel, pixel ^ k, 2u), last);
        masu_pixel o = masu_pixel_at(other);
        if (!(o.depth > 0.0) || dot(masu_unpack_normal(o.normal), n) < alike ||
            abs(masu_traced_roughness(o.surface) - masu_traced_roughness(p.surface)) > 0.1 ||
            abs(dot(masu_guide_point(other, o.depth) - point, n)) > 2.0 * width) {
            return true;
        }
    }
    return false;
}

void main()
{
    masu_count_begin();
    if (gl_LocalInvocationIndex == 0u) {
        any_glossy = 0u;
    }
    barrier();
    uvec2 texel = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    if (masu_specular_inside(texel)) {
        uvec2 guide = uvec2(0u);
        uint first = push.traced_size == 1u ? 0u : masu_guide_pixel(texel, frame.history.x);
        for (uint k = 0u; k < 4u; k++) {
            if (k >= push.traced_size * push.traced_size) {
                break;
            }
            uint pixel = first ^ k;
            uvec2 at = masu_guide_place(texel, pixel, push.traced_size);
            if (any(greaterThanEqual(at, size))) {
                continue;
            }
            masu_pixel p = masu_pixel_at(at);
            if (p.depth > 0.0 && masu_is_traced(p.surface, push.cutoff, push.accumulate != 0u)) {
                guide = masu_pack_guide(p.normal, masu_traced_roughness(p.surface), p.depth, pixel,
                                        push.traced_size == 2u && is_mixed(texel, pixel, p, at));
                break;
            }
        }
        if (guide.y > 7u) {
            any_glossy = 1u;
        }
        MASU_STORE_UINT(guide_image, texel, uvec4(guide, 0u, 0u));
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && any_glossy != 0u) {
        uint slot = atomicAdd(specular_tiles[0], 1u);
        specular_tiles[uint(MASU_TILES_HEADER) + slot] =
            gl_WorkGroupID.y * masu_specular_columns() + gl_WorkGroupID.x;
        masu_count(MASU_COUNTER_SPECULAR_TILES, 1u);
    }
    masu_count_end();
}
