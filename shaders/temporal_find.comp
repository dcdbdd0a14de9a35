/*
 * temporal_find.comp: reprojection. For each render pixel it finds the position in the history,
 * the weight of the history as a number of samples, and the range that its colour is clamped to.
 * Start with docs/design/17-temporal-upscaling.md.
 *
 *   1. Position: the velocity at the pixel. If a silhouette passes through the 3x3 samples
 *      around it, the velocity of the nearest sample, so that an anti-aliased edge moves with
 *      its foreground. The change of the jitter is subtracted.
 *   2. Disocclusion: is the same surface visible in the previous frame? The range of the four
 *      depths that the previous frame stored there must overlap the depth range of the 3x3
 *      samples: the least stored depth is at most the greatest of the nine, and the greatest
 *      stored depth is at least the least of the nine (is_known). The tolerance grows with the
 *      slope of the surface. If the ranges do not overlap, the history is discarded. The test is
 *      skipped for static pixels while camera position and scene are unchanged.
 *   3. Colour clamp: the history of moving pixels is clamped to 1.25 standard deviations around
 *      the mean of the nine samples, and to their extremes (Salvi, "An excursion in temporal
 *      supersampling", GDC 2016). The history of static pixels is not clamped, and therefore
 *      converges. If the scene has changed and the means of history and samples differ, it is
 *      clamped to 0.6 standard deviations and has a weight of one sample.
 *   4. Weight: up to 28 samples for a static pixel, up to 8 while the camera or anything in the
 *      scene moves, because rule 3 does not detect a soft shadow that moves. Each resampling
 *      between pixels blurs, so a pixel that moves by 1/16 pixel or more has at most 2 samples
 *      (1.5 below full size). The weight falls with speed and with the change of view depth: a
 *      surface that comes closer was smaller in the history.
 *   5. Missed surfaces: samples may miss a surface thinner than a pixel for frames. If the
 *      previous frame had a thin surface here (temporal_keep.comp), its velocity brings it here,
 *      and nothing as near is among the 3x3 samples, then the pixel keeps the surface's history
 *      if that differs from the samples: clamped from below only, with the weight of a moving
 *      pixel. Otherwise the frames that hit it would be averaged with histories that have lost it.
 *
 * upscale/found.glsl defines the two 32-bit values of the result.
 *
 * Push constants: output_* = the render size; push.history_* = used part of `history` / size of
 * the image; push.moved_*, push.depth_*, push.then_*: 1 / size of the images of velocity, of
 * depth and of the previous depth; push.pixel_*: 1 / the render size; push.shift: 1 if the
 * render size is the output size, and an output pixel uses the result at its own position.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/temporal_find.h"
#include "shared/frame.h"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"
#include "upscale/found.glsl"
#include "upscale/corners.glsl"
#include "upscale/mean.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image; /* sqrt-encoded */
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image; /* linear */
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D old_depth_image;
layout(set = MASU_SET_PASS, binding = 4) uniform sampler2DArray history_image; /* linear */
layout(set = MASU_SET_PASS, binding = 5, rg32ui) uniform writeonly uimage2D found_image;

const float most_at_rest = masu_found_most;
const float most_changing = 8.0; /* static pixels of a changing scene */
const float most_moving = 1.5; /* and at full size: */
const float most_moving_whole = 2.0;
const float most_other = 1.0; /* static pixels whose mean has changed */
const float per_growth = 40.0; /* of view depth; */
const float per_pixel = 0.1;   /* of motion: divides the weight */
const float at_rest = 0.02;    /* pixels of the input */
const float apart = 0.1;       /* share of the nearest depth: a silhouette */
const float same_depth = 0.01;
const float deviations = 1.25;
const float deviations_at_rest = 0.6; /* static pixels whose mean has changed */
const float unseen = 0.01; /* allowed difference of the 3x3 means, display-linear */

/* Depths of the 3x3 samples; larger is closer. */
struct around {
    float nearest, farthest;
    float slope; /* change of depth per pixel on the surface */
    uint way;    /* offset of the nearest sample, see upscale/found.glsl */
};

/* The 3x3 samples: square-root-encoded colour of 10 bits, as stored (upscale/roots.glsl). */
struct colors {
    vec3 mean, deviation, least, most;
};

around depths_around(ivec2 at, ivec2 size)
{
    masu_corners c = masu_corners_of(depth_image, vec2(at), vec2(size),
                                     vec2(push.depth_x, push.depth_y));
    around found;
    found.nearest = masu_most_of(c);
    found.farthest = masu_least_of(c);
    found.slope = min(abs(c.left - c.own), abs(c.right - c.own)) +
                  min(abs(c.above - c.own), abs(c.below - c.own));
    found.way = masu_way_to(c, found.nearest);
    return found;
}

/* xy: motion in pixels; z: growth of view depth; w as in the image. */
vec4 motion_at(ivec2 at, vec2 place, around a, vec2 size, out bool of_front)
{
    /* Texels outside of the image must not be read even with a weight of 0: they may be NaN. With a
     * size of 1 every position reads them. */
    vec2 inside = min(max(place, vec2(0.5)), size - 0.51);
    vec4 moved = textureLod(velocity_image, inside * vec2(push.moved_x, push.moved_y), 0.0);
    of_front = a.nearest - a.farthest > apart * a.nearest || !(moved.w > 0.99) ||
               any(lessThan(size, vec2(2.0)));
    if (of_front) {
        moved = texelFetch(velocity_image, at + masu_found_beside(a.way), 0);
    }
    return vec4(moved.xy + frame.shifts.zw, moved.zw);
}

/* The four depths that the previous frame stored around a position in it, 0..1. */
vec4 depths_before(vec2 before)
{
    vec2 size = vec2(frame.temporal.xy);
    vec2 place = (before - 0.5 * previous.jitter.zw) * size;
    vec2 inside = min(max(place, vec2(1.0)), size - 1.0); /* size 1: the same texel four times */
    return textureGather(old_depth_image, inside * vec2(push.then_x, push.then_y));
}

/* Rule 2. growth: relative change of view depth. */
bool is_known(vec4 depths, around a, float growth)
{
    /* Stored depths are scaled by `now`, current ones by `then`. NaN compares as unknown. */
    float then = previous.forward.w, now = frame.forward.w * (1.0 + growth);
    float off = (same_depth * a.nearest + 2.0 * a.slope) * then;
    return masu_least_of(depths) * now <= a.nearest * then + off &&
           masu_most_of(depths) * now >= a.farthest * then - off;
}

/* Whether a depth of the previous frame is in front of all samples of this frame. */
bool is_gone(float depth, around a)
{
    return depth * frame.forward.w > (1.0 + apart) * a.nearest * previous.forward.w;
}

/* Rule 5: the bits of masu_thin of such a depth; 0: the surface is not thin. */
uint thin_of(float depth)
{
    uint bits = floatBitsToUint(depth) & masu_thin_bits;
    return (bits & masu_thin_lives) != 0u ? bits : 0u;
}

colors colors_around(ivec2 at, ivec2 last)
{
    colors c = colors(vec3(0.0), vec3(0.0), vec3(1.0), vec3(0.0));
    ivec2 low = max(at - 1, 0), high = min(at + 1, last);
    for (int i = 0; i < 9; i++) {
        int x = i % 3, y = i / 3;
        ivec2 beside = ivec2(x == 0   ? low.x
                             : x == 1 ? at.x
                                      : high.x,
                             y == 0   ? low.y
                             : y == 1 ? at.y
                                      : high.y);
        vec3 root = texelFetch(color_image, beside, 0).rgb;
        c.mean += root;
        c.deviation += root * root;
        c.least = min(c.least, root);
        c.most = max(c.most, root);
    }
    c.mean *= 1.0 / 9.0;
    c.deviation = sqrt(max(c.deviation * (1.0 / 9.0) - c.mean * c.mean, 0.0));
    return c;
}

/* Whether the mean of the history differs from the mean of the nine samples; off: by how much the
 * history is brighter. Both are compared as light. With square-root-encoded samples, the mean of
 * light is the squared mean plus the variance, and the standard deviation of light is the
 * difference that one standard deviation of the encoded samples makes. */
bool is_other(vec2 before, colors c, out vec3 off)
{
    vec2 shown = vec2(push.history_x, push.history_y),
         half_texel = 0.5 * shown * vec2(push.pixel_x, push.pixel_y);
    vec2 inside = min(max(before * shown, half_texel), max(shown - 2.0 * half_texel, half_texel));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; i++) {
        vec2 corner = inside + vec2(2 * (i & 1) - 1, 2 * (i >> 1) - 1) * half_texel;
        corner = min(corner, shown - half_texel); /* with a size of 1 it is outside */
        sum += textureLod(history_image, vec3(corner, masu_layer_before()), 0.0).rgb;
    }
    vec3 mean = c.mean * c.mean + c.deviation * c.deviation;
    off = 0.25 * sum - mean;
    return any(greaterThan(abs(off), c.deviation * (2.0 * c.mean + c.deviation) + unseen));
}

uvec2 found_at(ivec2 at, vec2 size)
{
    around a = depths_around(at, ivec2(size));
    vec2 place = vec2(at) + 0.5 - push.shift * frame.shifts.xy;
    bool of_front;
    vec4 moved = motion_at(at, place, a, size, of_front);
    vec2 before = (place + frame.shifts.xy + moved.xy) * vec2(push.pixel_x, push.pixel_y);
    float speed = length(moved.xy);
    bool rests = !(speed > at_rest);
    bool changes = frame.temporal.z >= MASU_TEMPORAL_CHANGES;
    bool there = frame.temporal.x != 0u && moved.w > 0.0 &&
                 all(greaterThanEqual(before, vec2(0.0))) && all(lessThanEqual(before, vec2(1.0)));
    /* If nothing has moved, the surface is unchanged even if this frame's samples miss it: a
     * wire. */
    if (there && rests && !changes) {
        return masu_found(masu_found_stays, most_at_rest, vec3(0.0), vec3(1.0));
    }
    vec4 depths = depths_before(before);
    bool gone = is_gone(masu_most_of(depths), a);
    uint thin = gone && there && frame.temporal.xy == uvec2(size) ? thin_of(masu_most_of(depths))
                                                                   : 0u;
    vec2 moved_thin = masu_thin_motion(thin);
    if (thin != 0u) {
        vec2 left = (place + frame.shifts.xy + moved_thin) * vec2(push.pixel_x, push.pixel_y);
        vec2 texel = clamp((left - 0.5 * previous.jitter.zw) * size, vec2(0.0), size - 1.0);
        float depth = texelFetch(old_depth_image, ivec2(texel), 0).r;
        bool within = all(greaterThanEqual(left, vec2(0.0))) && all(lessThanEqual(left, vec2(1.0)));
        thin = within && is_gone(depth, a) ? thin_of(depth) : 0u;
        before = thin != 0u ? left : before;
    }
    bool known = there && is_known(depths, a, moved.z);
    if (!known && thin == 0u) {
        return uvec2(0u);
    }
    colors c = colors_around(at, ivec2(size) - 1);
    vec3 off = vec3(0.0);
    bool other = ((rests && changes) || thin != 0u) && is_other(before, c, off);
    float most = push.shift > 0.0 ? most_moving_whole : most_moving;
    if (thin != 0u && other) {
        /* The cubic filter overshoots below it. */
        vec3 least = mix(vec3(0.0), c.least * c.least, greaterThan(off, vec3(0.0)));
        return masu_found_thin(thin, most / (1.0 + per_pixel * length(moved_thin)), least);
    }
    if (!known) {
        return uvec2(0u);
    }
    other = other || (rests && gone); /* the disoccluded surface may contribute a little */
    vec3 within = (rests ? deviations_at_rest : deviations) * c.deviation;
    vec3 low = max(c.least, c.mean - within), high = min(c.most, c.mean + within);
    float moving = most / (1.0 + per_growth * abs(moved.z) + per_pixel * speed);
    float resting = changes ? most_changing : most_at_rest;
    float count = other ? most_other : mix(resting, moving, min(16.0 * speed, 1.0));
    bool held = other || !rests;
    return masu_found(of_front ? a.way : masu_found_linear, count, held ? low * low : vec3(0.0),
                      held ? high * high : vec3(1.0));
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        MASU_STORE_SAFE(found_image, at, uvec4(found_at(at, vec2(size)), 0u, 0u));
    }
}
