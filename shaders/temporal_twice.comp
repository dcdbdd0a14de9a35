/*
 * temporal_twice.comp: temporal.comp for 2x upscaling: the same result at a lower cost.
 *
 * For any jitter, a 2x2 block of output pixels falls between the centres of four texels. The first
 * pixel of every block has odd coordinates, or every one has even ones. An invocation writes one
 * block: it reads the four texels once, and each pixel is closest to one texel. The positions
 * between the texels are the same in all blocks, so most texel weights are constant or zero.
 *
 * One invocation per four texels. Blocks at the image border include texels outside the image, so
 * there is one invocation more per row and column than there are texels.
 *
 * Push constants: output_* = size to write, render_* = input size; history.glsl documents the rest.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#include "push/temporal_twice.h"
#include "shared/types.h"
#include "shared/output.glsl"
#include "upscale/found.glsl"
#include "upscale/history.glsl"
#include "upscale/roots.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image; /* square roots of
                                                                         * display-linear colour */

vec3 light_at(ivec2 texel)
{
    vec4 root = texelFetch(color_image, texel, 0);
    root.g += masu_root_rest * root.a;
    return root.rgb * root.rgb;
}

/* Four texels and the pixels between them. */
struct cell {
    ivec2 before, low, high; /* upper left texel; it and the lower right one, clamped */
    ivec2 first;             /* pixel */
    vec2 inside_x, inside_y; /* 1 for a texel of the image, 0 outside: no sample */
    vec3 light[4];
    uint chance; /* of the first pixel */
};

/* Resolves one of the four pixels. A function that is called four times, not a loop: the cost model
 * counts an unrolled loop as if each iteration ran the whole loop
 * (docs/design/20-cost-model.md). */
void resolve(cell c, ivec2 way)
{
    ivec2 at = c.first + way;
    ivec2 texel = ivec2(way.x == 0 ? c.low.x : c.high.x, way.y == 0 ? c.low.y : c.high.y);
    uvec2 found = texelFetch(found_image, texel, 0).xy;
    vec4 column = frame.columns[way.x], row = frame.rows[way.y];
    vec2 f = vec2(column.x, row.x);
    vec2 place = min(vec2(c.before) + f, vec2(push.last_x, push.last_y)); /* < 0: the sampler
                                                                           * clamps */
    masu_past old = masu_history(found, vec2(at) + 0.5, texel, place, vec2(2.0));
    bool stays = masu_has_stayed(found);
    vec2 x = (stays ? column.y * vec2(1 - way.x, way.x) : column.zw) * c.inside_x;
    vec2 y = (stays ? row.y * vec2(1 - way.y, way.y) : row.zw) * c.inside_y;
    vec4 weights = x.xyxy * y.xxyy;
    float count = old.mean.a + (x.x + x.y) * (y.x + y.y);
    if (count < 1.0) {
        float rest = 1.0 - count, below = f.y * rest, above = rest - below;
        vec2 right = f.x * vec2(above, below), left = vec2(above, below) - right;
        weights += vec4(left.x, right.x, left.y, right.y);
    }
    vec3 sum = old.mean.a * old.mean.rgb;
    sum += weights.x * c.light[0];
    sum += weights.y * c.light[1];
    sum += weights.z * c.light[2];
    sum += weights.w * c.light[3];
    if (all(lessThan(uvec2(at), uvec2(pc.output_width, pc.output_height)))) { /* -1, before the
                                                                               * first pixel, is
                                                                               * outside as a
                                                                               * uint */
        vec3 mean = sum * (1.0 / max(count, 1.0));
        uint other = uint(way.x) * masu_chance_step.x + uint(way.y) * masu_chance_step.y;
        masu_show(at, mean, count, old, stays, c.chance + other);
    }
}

void main()
{
    cell c;
    ivec2 number = ivec2(gl_GlobalInvocationID.xy);
    c.first = 2 * number + ivec2(frame.between.xy) - 2;
    c.before = number + ivec2(frame.between.zw);
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    if (any(greaterThanEqual(c.first, ivec2(pc.output_width, pc.output_height)))) {
        return;
    }
    /* Outside the image, the closest texel is repeated. */
    ivec2 after = c.before + 1;
    c.low = clamp(c.before, ivec2(0), last);
    c.high = clamp(after, ivec2(0), last);
    c.light = vec3[4](light_at(c.low), light_at(ivec2(c.high.x, c.low.y)),
                      light_at(ivec2(c.low.x, c.high.y)), light_at(c.high));
    c.inside_x = vec2(equal(ivec2(c.low.x, c.high.x), ivec2(c.before.x, after.x)));
    c.inside_y = vec2(equal(ivec2(c.low.y, c.high.y), ivec2(c.before.y, after.y)));
    c.chance = masu_chance(uvec2(c.first));
    resolve(c, ivec2(0, 0));
    resolve(c, ivec2(1, 0));
    resolve(c, ivec2(0, 1));
    resolve(c, ivec2(1, 1));
}
