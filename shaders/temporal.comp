/*
 * temporal.comp: anti-aliasing and upscaling in one, by samples of frames before. Of each pixel of the output it takes
 * the mean of this frame's samples near it and of its history, each by how many samples stand in it. The frame's
 * jitter has put its samples elsewhere than those before. docs/design/41-temporal.md has the measurements.
 *
 *   1. Where was it? By the velocity at the pixel; where a silhouette passes through the 3x3 samples around, by the
 *      nearest one's, so that a smooth edge moves with what it is the edge of. Without what the frames' jitter differs by.
 *   2. Is it the same thing? What rests in a world that does is. Else one of the four depths that the previous frame has kept there has to lie between the nearest
 *      and the farthest of the nine of now, as far as they were then; else the pixel begins anew. A surface that leans
 *      may differ by its slope.
 *   3. Has what it shows changed? History of what has moved across the screen is held within what the nine samples
 *      show: a standard deviation around their mean, and none of their extremes exceeded. (Salvi, "An excursion in
 *      temporal supersampling", GDC 2016.) What rests is not held, which is what makes it exact; but where the world has
 *      changed, and the mean of the history around is not that of the nine, it is, too, and counts as one sample.
 *   4. How much does it count? At rest as many samples as it has, up to 32, and up to 8 while anything in the world
 *      changes: a soft shadow that moves is not seen by rule 3. Each resampling between pixels blurs, so
 *      that what moves counts at most 2, and less the faster it moves and the more it grows: it was smaller then.
 *   5. A pixel that has not yet a whole sample takes the rest from the wider surroundings.
 *
 * Everything is display light, as an eye takes the mean of it (docs/design/31-truth.md); a: samples. Halves are rounded up
 * or down by chance: the nearest one would hold a history still that is a little wrong.
 *
 * Push constants: render_* = valid corner of the input, output_* = size to write, push.scale_* = input size * (1 /
 * output size).
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_PUSH masu_push_temporal
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/dither.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image; /* roots of display light */
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image; /* linear */
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D old_depth_image;
layout(set = MASU_SET_PASS, binding = 4) uniform sampler2D history_image; /* linear */
layout(set = MASU_SET_PASS, binding = 5, rgba16f) uniform writeonly image2D accumulated_image;

const float most_at_rest = 32.0;
const float most_changing = 8.0; /* the same in a world that changes */
const float most_moving = 2.0;
const float most_other = 1.0; /* of what rests and is no longer what it was */
const float per_growth = 20.0; /* of view depth; */
const float per_pixel = 0.1;   /* of motion: by how much that is divided */
const float at_rest = 0.02;    /* pixels of the input */
const float apart = 0.1;       /* of the nearest depth: a silhouette */
const float same_depth = 0.01;
const float deviations = 1.0;
const float unseen = 0.01; /* display light that a mean over the surroundings may differ by */

/* The nine samples around a place. */
struct around {
    vec3 mean, least, most, deviation;
    float nearest, farthest; /* depths: large is near */
    float slope;             /* by which depth differs from pixel to pixel of one surface */
    ivec2 front;             /* the nearest */
};

/* What they tell of the pixel: sums. */
struct samples {
    vec3 light;
    float count;
    vec3 wide; /* the mean of a wider surrounding */
};

vec3 squared(vec3 v)
{
    return v * v;
}

/* place: in the input, the jitter taken off. */
void look_around(vec2 place, ivec2 middle, ivec2 last, out around a, out samples s)
{
    vec2 to_output = 1.0 / vec2(push.scale_x, push.scale_y);
    vec3 sum = vec3(0.0);
    vec3 squares = vec3(0.0);
    vec4 wide = vec4(0.0);
    vec4 own = vec4(0.0);
    float depths[9];
    a.least = vec3(1.0);
    a.most = vec3(0.0);
    a.nearest = 0.0;
    a.farthest = masu_huge;
    a.front = middle;
    for (int i = 0; i < 9; i++) {
        ivec2 at = clamp(middle + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last);
        vec3 light = squared(texelFetch(color_image, at, 0).rgb);
        vec2 off = vec2(at) + 0.5 - place;
        vec2 tent = max(1.0 - abs(off * to_output), 0.0);
        own += tent.x * tent.y * vec4(light, 1.0);
        wide += masu_exp2(-3.0 * dot(off, off)) * vec4(light, 1.0);
        sum += light;
        squares += light * light;
        a.least = min(a.least, light);
        a.most = max(a.most, light);
        depths[i] = texelFetch(depth_image, at, 0).r;
        a.front = depths[i] > a.nearest ? at : a.front;
        a.nearest = max(a.nearest, depths[i]);
        a.farthest = min(a.farthest, depths[i]);
    }
    a.mean = sum * (1.0 / 9.0);
    a.deviation = sqrt(max(squares * (1.0 / 9.0) - a.mean * a.mean, 0.0));
    a.slope = min(abs(depths[3] - depths[4]), abs(depths[5] - depths[4])) +
              min(abs(depths[1] - depths[4]), abs(depths[7] - depths[4]));
    s.light = own.rgb;
    s.count = own.a;
    s.wide = wide.rgb / wide.a; /* the middle one has 2^-1.5 at least */
}

/* Of this frame's input: pixels that the pixel has moved, how its depth has grown; w as in the image. */
vec4 motion_at(vec2 place, around a, vec2 size)
{
    vec2 inside = min(max(place, vec2(0.5)), size - 0.51); /* not even with a weight of 0 what lies beyond */
    vec4 moved = textureLod(velocity_image, inside / vec2(textureSize(velocity_image, 0)), 0.0);
    if (a.nearest - a.farthest > apart * a.nearest || !(moved.w > 0.99)) {
        moved = texelFetch(velocity_image, a.front, 0);
    }
    return vec4(masu_unjittered(moved.xy, size), moved.zw);
}

/* before: place in the output where the previous frame has shown it. */
bool is_known(vec2 before, around a, float growth)
{
    vec2 size = vec2(frame.temporal.xy);
    vec2 place = (before / vec2(pc.output_width, pc.output_height) - 0.5 * previous.jitter.zw) * size;
    vec2 inside = min(max(place, vec2(1.0)), size - 1.0); /* of a size of 1 it is the same texel four times */
    vec4 depths = textureGather(old_depth_image, inside / vec2(textureSize(old_depth_image, 0)));
    float then = previous.forward.w * masu_rcp(frame.forward.w * (1.0 + growth));
    float off = (same_depth * a.nearest + 2.0 * a.slope) * then;
    float nearest = max(max(depths.x, depths.y), max(depths.z, depths.w));
    float farthest = min(min(depths.x, depths.y), min(depths.z, depths.w));
    return farthest <= a.nearest * then + off && nearest >= a.farthest * then - off;
}

/* The cubic of Catmull and Rom, by five linear fetches: the corners' weights are small, and left out. b: the mean of
 * the surroundings. */
vec4 history_at(vec2 place, vec2 size, out vec3 surroundings)
{
    vec2 texel = 1.0 / vec2(textureSize(history_image, 0)); /* which may be larger: masu_resize */
    vec2 last = size - 0.5;
    vec2 base = floor(place - 0.5) + 0.5;
    vec2 t = place - base;
    vec2 w0 = t * (-0.5 + t * (1.0 - 0.5 * t));
    vec2 w1 = 1.0 + t * t * (1.5 * t - 2.5);
    vec2 w3 = t * t * (0.5 * t - 0.5);
    vec2 w2 = 1.0 - w0 - w1 - w3;
    vec2 w12 = w1 + w2;
    vec2 middle = min(base + w2 / w12, last) * texel;
    vec2 first = min(base - 1.0, last) * texel, fourth = min(base + 2.0, last) * texel;
    vec4 here = textureLod(history_image, middle, 0.0);
    vec3 left = textureLod(history_image, vec2(first.x, middle.y), 0.0).rgb;
    vec3 right = textureLod(history_image, vec2(fourth.x, middle.y), 0.0).rgb;
    vec3 above = textureLod(history_image, vec2(middle.x, first.y), 0.0).rgb;
    vec3 below = textureLod(history_image, vec2(middle.x, fourth.y), 0.0).rgb;
    vec4 beside = vec4(w0.x * w12.y, w3.x * w12.y, w12.x * w0.y, w12.x * w3.y);
    float all = w12.x * w12.y + beside.x + beside.y + beside.z + beside.w;
    vec3 sum = w12.x * w12.y * here.rgb + beside.x * left + beside.y * right + beside.z * above + beside.w * below;
    surroundings = 0.2 * (here.rgb + left + right + above + below);
    return vec4(max(sum / all, 0.0), here.a);
}

/* History that counts: its light, how many samples. */
vec4 found_again(vec2 at, vec2 place, around a)
{
    vec2 size = vec2(pc.output_width, pc.output_height), render = vec2(pc.render_width, pc.render_height);
    vec4 moved = motion_at(place, a, render);
    vec2 before = at + moved.xy / vec2(push.scale_x, push.scale_y);
    bool there = frame.temporal.x != 0u && moved.w > 0.0 && all(greaterThanEqual(before, vec2(0.0))) &&
                 all(lessThanEqual(before, size));
    float speed = length(moved.xy);
    bool rests = !(speed > at_rest);
    /* Where nothing has moved it is what it was, though this frame's samples may miss it: a wire. */
    if (!there || !((rests && frame.temporal.z == 0u) || is_known(before, a, moved.z))) {
        return vec4(0.0);
    }
    vec3 surroundings;
    vec4 old = history_at(before, size, surroundings);
    /* What no frame stores, as NaN, would count as many samples as there can be, and be seen as long: begin anew. */
    if (!(all(greaterThanEqual(surroundings, vec3(0.0))) && all(lessThanEqual(surroundings, vec3(1.5))) &&
          old.a >= 0.0 && old.a <= 64.0)) {
        return vec4(0.0);
    }
    bool other = frame.temporal.z != 0u && any(greaterThan(abs(surroundings - a.mean), a.deviation + unseen));
    if (other || !rests) {
        old.rgb = clamp(old.rgb, max(a.least, a.mean - deviations * a.deviation),
                        min(a.most, a.mean + deviations * a.deviation));
    }
    float moving = most_moving / (1.0 + per_growth * abs(moved.z) + per_pixel * speed);
    float resting = frame.temporal.z != 0u ? most_changing : most_at_rest;
    float most = rests && other ? most_other : mix(resting, moving, min(4.0 * speed, 1.0));
    return vec4(old.rgb, min(old.a, most));
}

/* To a half, up or down by chance; a to the nearest. */
vec4 by_chance(vec4 v, uvec2 at)
{
    uvec4 noise = uvec4(masu_dither(at), 0x80000000u);
    return uintBitsToFloat((floatBitsToUint(v) + (noise >> 19)) & 0xFFFFE000u);
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        vec2 render = vec2(pc.render_width, pc.render_height);
        ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
        vec2 place = (vec2(at) + 0.5) * vec2(push.scale_x, push.scale_y) - 0.5 * frame.jitter.zw * render;
        around a;
        samples s;
        look_around(place, clamp(ivec2(floor(place)), ivec2(0), last), last, a, s);
        vec4 old = found_again(vec2(at) + 0.5, place, a);
        float count = old.a + s.count;
        float rest = max(1.0 - count, 0.0);
        vec3 light = (old.a * old.rgb + s.light + rest * s.wide) / (count + rest);
        vec4 mean = masu_sane(vec4(min(light, 1.0), count), 0.0, 64.0);
        MASU_STORE_SAFE(accumulated_image, at, by_chance(mean, at));
    }
    masu_count_end();
}
