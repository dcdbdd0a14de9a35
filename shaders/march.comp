/*
 * march.comp: sphere tracing of the scene's SDF, limited by the raster depth; the nearer surface
 * wins. A hit becomes texels of the G-buffer, so that every later pass has one path.
 *
 * One workgroup per active tile of 16x16 pixels, with the tile's list of parts; each invocation has four
 * pixels. A pixel starts where the cone of its 4x4 block stopped (cone.comp). Compiled by masu-bake
 * together with the scene's field.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define MASU_PUSH masu_push_march
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D cone_image;
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D albedo_image;
layout(set = MASU_SET_PASS, binding = 2, r32ui) uniform writeonly uimage2D normal_image;
layout(set = MASU_SET_PASS, binding = 3, r32f) uniform image2D depth_image;

#define MASU_RELAXED
#define MASU_SPANS_USED 1
#define MASU_SDF_NO_FLAT
#include "sdf/spans.glsl"
#include "sdf/hit.glsl"

/* Of the four pixels of an invocation, one in each quarter of the tile. */
vec4 start = vec4(0.0);
vec4 limit = vec4(-1.0);
vec4 flat_end = vec4(-1.0); /* distance of a half-space, or -1 */
uvec4 flat_part = uvec4(0u);
vec4 found = vec4(-1.0);

bvec4 only(int k)
{
    return equal(ivec4(k), ivec4(0, 1, 2, 3));
}

float lane(vec4 v, int k)
{
    return k == 0 ? v.x : k == 1 ? v.y : k == 2 ? v.z : v.w;
}

uvec2 pixel_of(uvec2 corner, int k)
{
    return corner + uvec2(k & 1, k >> 1) * uint(MASU_GROUP) + masu_block_at(gl_LocalInvocationIndex);
}

/* Where the ray of a pixel begins and ends. The nearest half-space ends the march. */
void prepare(uvec2 at, uvec2 size, int k)
{
    float z_scale, depth = 0.0;
#if MASU_HAS_RASTER
    depth = imageLoad(depth_image, ivec2(at)).r;
#endif
    ray r = pixel_ray(at, size, depth, z_scale);
    uint part;
    float end = masu_sdf_flat(world_at(r.direction, 0.0), r.direction, r.start, part);
    bool ends = end < r.limit;
    vec3 low, high;
    masu_listed_box(low, high);
    float farthest = min(r.limit, end);
    clip_to_box(r, low, high);
    /* What ends at the very side of the box may be found a little behind it. */
    r.limit = min(r.limit * (1.0 + newton_reach * r.pixel), farthest);
    start = mix(start, vec4(max(r.start, texelFetch(cone_image, ivec2(at / 4u), 0).r)), only(k));
    limit = mix(limit, vec4(r.limit), only(k));
    flat_end = mix(flat_end, vec4(ends ? end : -1.0), only(k));
    flat_part = uvec4(mix(vec4(flat_part), vec4(part), only(k)));
}

ray ray_of(uvec2 corner, uvec2 size, int k)
{
    float z_scale;
    ray r = ray_through(pixel_of(corner, k), size, z_scale);
    r.start = lane(start, k);
    r.limit = lane(limit, k);
    return r;
}

#if MASU_SDF_BLOCK_WORDS > 0
/* The piece of its rays that the ray in work is in. */
uint tile_bits[2];
uint span_first; /* of its block's pieces */
float span_from, span_to, span_start, span_pixel;
int span_now;

void look_up_span(float t)
{
    span_now = 0;
    for (int i = 1; i <= MASU_BLOCK_SPANS; i++) {
        span_now += t > span_begin(span_start, span_pixel, i) ? 1 : 0;
    }
    bool last = span_now == MASU_BLOCK_SPANS;
    span_from = span_begin(span_start, span_pixel, span_now);
    span_to = last ? 1e30 : span_begin(span_start, span_pixel, span_now + 1);
    uint place = span_first + uint(min(span_now, MASU_BLOCK_SPANS - 1) * MASU_SDF_BLOCK_WORDS);
    for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
        masu_list_bits[w] = last ? tile_bits[w] : masu_tiles[place + uint(w)];
    }
}

void begin_spans(uvec2 corner, uvec2 size, int k, float t)
{
    uvec2 block = min(pixel_of(corner, k), size - 1u) / 4u;
    span_start = texelFetch(cone_image, ivec2(block), 0).r;
    span_first = span_place(block, size, 0);
    look_up_span(t);
}
#endif

/* The field at m.t by what matters there. */
float field_here(ray r, march_state m)
{
#if MASU_SDF_BLOCK_WORDS > 0
    if (!(m.t >= span_from && m.t <= span_to)) {
        look_up_span(m.t);
    }
#endif
    return field_at(r, m.t);
}

/* All four rays in one loop: who is done with one takes the next, instead of waiting for the slowest of
 * its subgroup. Eight lanes that wait took 1.2 to 1.9 times the steps of their mean. */
uint march_all(uvec2 corner, uvec2 size)
{
    int k = 0;
    uint evals = 0u;
    ray r = ray_of(corner, size, 0);
    march_state m = march_begin(r);
#if MASU_SDF_BLOCK_WORDS > 0
    begin_spans(corner, size, 0, m.t);
#endif
    MASU_LOOP for (int i = 0; i < 4 * MASU_MARCH_STEPS_MAX; i++) {
        if (k > 3) {
            break;
        }
        if (!m.done) {
            evals++;
            march_step(m, r, field_here(r, m));
        }
        if (m.done) {
            found = mix(found, vec4(m.t), only(k));
            k++;
            r = ray_of(corner, size, k);
            m = march_begin(r);
#if MASU_SDF_BLOCK_WORDS > 0
            begin_spans(corner, size, k, m.t);
#endif
        }
    }
    return evals;
}

void main()
{
    masu_count_begin();
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    uint tile = masu_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x];
    uint columns = masu_tile_grid(size).x;
    uvec2 corner = uvec2(tile % columns, tile / columns) * uint(MASU_TILE);
    bool listed = masu_use_tile(tile, size);
    MASU_LOOP for (int k = 0; k < 4; k++) {
        if (all(lessThan(pixel_of(corner, k), size))) {
            prepare(pixel_of(corner, k), size, k);
        }
    }
#if MASU_SDF_BLOCK_WORDS > 0
    tile_bits = masu_list_bits;
    span_pixel = 2.0 * max(frame.up.w / float(size.y), frame.right.w / float(size.x));
#endif
    if (listed) {
        masu_count(MASU_COUNTER_SDF_EVALS, march_all(corner, size));
    }
    MASU_LOOP for (int k = 0; k < 4; k++) {
        uvec2 at = pixel_of(corner, k);
        if (all(lessThan(at, size))) {
            float t = lane(found, k);
            bool known = !(t >= 0.0);
            t = known ? lane(flat_end, k) : t;
            if (t >= 0.0) {
                ray r = ray_of(corner, size, k);
#if MASU_SDF_BLOCK_WORDS > 0
                begin_spans(corner, size, k, t);
#endif
                float z_scale = length(masu_pixel_ray(at, size));
                uint part = flat_part[k];
                float depth = write_hit(at, r, t, known, part, z_scale);
                MASU_STORE_R32F(depth_image, at, depth);
            }
#if !MASU_HAS_RASTER
            else {
                MASU_STORE_R32F(depth_image, at, 0.0);
            }
#endif
            masu_count(MASU_COUNTER_SDF_EVALS, MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT ? 1u : 0u);
        }
    }
    masu_count_end();
}
