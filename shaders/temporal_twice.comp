/*
 * temporal_twice.comp: temporal.comp to twice the width and height: the same for less.
 *
 * Between the middles of four texels lie four pixels of the output, 2x2, whatever the jitter is: the first of them has odd
 * coordinates or even ones, in all the picture. An invocation makes these: it reads the four texels once, each pixel is
 * nearest to one of them, and where pixels lie between texels is the same for all, so that most of what a texel counts
 * is a constant, or none.
 *
 * One invocation for each four texels, those at the picture's edge with what lies beyond: one more each way than there are
 * texels. An output of odd size is twice the input less a row: half a pixel at most by which the last lies elsewhere
 * than temporal.comp would put it.
 *
 * Push constants: output_* = size to write, render_* = the input's; the rest is history.glsl's.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define MASU_OUTPUT
#define MASU_PUSH masu_push_temporal_twice
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "upscale/found.glsl"
#include "upscale/history.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image; /* roots of display light */

vec3 light_at(ivec2 texel)
{
    vec3 root = texelFetch(color_image, texel, 0).rgb;
    return root * root;
}

void main()
{
    ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    ivec2 first = 2 * cell + ivec2(frame.between.xy) - 2;
    ivec2 before = cell + ivec2(frame.between.zw), after = before + 1;
    ivec2 size = ivec2(pc.output_width, pc.output_height), last = ivec2(pc.render_width, pc.render_height) - 1;
    if (any(greaterThanEqual(first, size))) {
        return;
    }
    /* Beyond the picture its last texel is repeated. */
    ivec2 low = clamp(before, ivec2(0), last), high = clamp(after, ivec2(0), last);
    vec3 light[4] = vec3[4](light_at(low), light_at(ivec2(high.x, low.y)), light_at(ivec2(low.x, high.y)), light_at(high));
    vec2 inside_x = vec2(equal(ivec2(low.x, high.x), ivec2(before.x, after.x)));
    vec2 inside_y = vec2(equal(ivec2(low.y, high.y), ivec2(before.y, after.y)));
    uint chance = masu_chance(uvec2(first));
    [[unroll]] for (int i = 0; i < 4; i++) {
        ivec2 way = ivec2(i & 1, i >> 1);
        ivec2 at = first + way;
        ivec2 texel = ivec2(way.x == 0 ? low.x : high.x, way.y == 0 ? low.y : high.y);
        uvec2 found = texelFetch(found_image, texel, 0).xy;
        vec4 column = frame.columns[way.x], row = frame.rows[way.y];
        vec2 f = vec2(column.x, row.x);
        vec2 inside = min(vec2(before) + f, vec2(last) - 0.01); /* samplers care for what is less than 0 */
        vec4 old = masu_history(found, vec2(at) + 0.5, texel, inside, vec2(2.0));
        bool stays = masu_has_stayed(found);
        vec2 x = (stays ? column.y * vec2(1 - way.x, way.x) : column.zw) * inside_x;
        vec2 y = (stays ? row.y * vec2(1 - way.y, way.y) : row.zw) * inside_y;
        float count = old.a + (x.x + x.y) * (y.x + y.y);
        float rest = max(1.0 - count, 0.0), below = f.y * rest, above = rest - below;
        vec2 right = f.x * vec2(above, below), left = vec2(above, below) - right;
        vec4 weights = x.xyxy * y.xxyy + vec4(left.x, right.x, left.y, right.y);
        vec3 sum = old.a * old.rgb;
        for (int k = 0; k < 4; k++) {
            sum += weights[k] * light[k];
        }
        if (all(lessThan(uvec2(at), uvec2(size)))) { /* -1, before the first, is not */
            vec3 mean = sum * (1.0 / max(count, 1.0));
            uint other = uint(way.x) * masu_chance_step.x + uint(way.y) * masu_chance_step.y;
            MASU_STORE_SAFE(accumulated_image, at, masu_mean_bits(mean, count, chance + other));
        }
    }
}
