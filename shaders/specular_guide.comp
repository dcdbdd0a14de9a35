/*
 * specular_guide.comp: which pixel of each 2x2 is traced in this frame, and the list of 8x8 texels in
 * which any is. Only surfaces smoother than push.cutoff are; the passes behind this one run for the listed
 * tiles alone.
 *
 * A pixel that is not glossy is replaced by another one of its 2x2 that is: a rod one pixel wide would
 * else be traced in every fourth frame only.
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

/* Cosine of the angle by which normals within a texel may differ. */
const float alike = 0.98;

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE, rg32ui) uniform writeonly uimage2D
    guide_image;

shared uint any_glossy;

/* Whether any other of the four pixels is another surface than the one that the texel stands for, or leans so
 * much that it mirrors something else: a mean over the texel would be one of different things, and begin anew
 * with each turn. */
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
