/*
 * specular_fine.comp: what smooth surfaces mirror is as sharp as the picture, and a mean over a texel's 2x2
 * pixels blurs it; and where the four are not one surface there is nothing a mean over them could be of.
 * Here each has its own: the pixel that the texel has traced in this frame takes its ray in, the others keep
 * what they had, found again where specular_temporal has found the texel's, or else where their own surface
 * was. A mirror's ray has no noise and replaces the mean.
 *
 * A ray counts by what it is worth (specular_rays.comp).
 *
 * In motion the four are up to four frames old, and what is reflected has moved by another amount for each:
 * a mean is short then, the shorter the smoother the surface, and held to the colours of the 3x3
 * rays. So is one that has just begun, while the scene changes: what has passed by in a mirror has
 * left its colour in the pixels not traced since.
 *
 * push.frames: how far back the mean reaches, 1/60 s.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_fine.h"
#include "shared/frame.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"
#include "noise/sequence.glsl"
#include "specular/filter.glsl"
#include "specular/fine.glsl"
#include "specular/tiles.glsl"
#include "trace/scene.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D light_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D mean_image;
layout(set = MASU_SET_PASS, binding = 3) uniform usampler2D age_image;
layout(set = MASU_SET_PASS, binding = 4) uniform sampler2D velocity_image;
layout(set = MASU_SET_PASS, binding = 5) uniform usampler2D old_guide_image;
layout(set = MASU_SET_PASS, binding = 6) uniform usampler2D old_fine_image;
layout(set = MASU_SET_PASS, binding = 7) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 8) uniform usampler2D ray_image;
layout(set = MASU_SET_PASS, binding = 9, rgba32ui) uniform writeonly uimage2D fine_image;

/* Whether the previous frame has kept full-resolution history. A rung without them keeps the rest of the history alone. */
bool has_old()
{
    return frame.history.y != 0u && (frame.history.w & uint(MASU_HISTORY_NO_FINE)) == 0u;
}

/* a: 0: nothing is there. at: pixel of the previous frame. */
vec4 old_pixel(ivec2 at, masu_guide g)
{
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(frame.history.yz)))) {
        return vec4(0.0);
    }
    ivec2 texel = at >> 1;
    masu_guide o = masu_unpack_guide(texelFetch(old_guide_image, texel, 0).rg);
    if (!o.there || abs(o.roughness - g.roughness) > 0.1 || dot(o.normal, g.normal) < 0.7 ||
        abs(o.depth - g.depth) > 0.1 * g.depth) {
        return vec4(0.0);
    }
    uint word = texelFetch(old_fine_image, texel, 0)[(at.x & 1) + 2 * (at.y & 1)];
    return word == masu_fine_none ? vec4(0.0) : vec4(masu_unpack_fine(word), 1.0);
}

/* Whether a texel of the previous frame can have held a surface of this normal: if it was not one surface, there is
 * no telling. */
bool was_it(ivec2 texel, vec3 normal)
{
    masu_guide o = masu_unpack_guide(texelFetch(old_guide_image, texel, 0).rg);
    return o.there && (o.mixed || dot(o.normal, normal) > 0.8);
}

/* Where a pixel's own surface was, whatever the texel there stood for: to the nearest pixel, since between two
 * lies the outline. */
vec4 own_way(uvec2 pixel)
{
    if (!has_old() || frame.history.yz != uvec2(pc.render_width, pc.render_height) ||
        any(greaterThanEqual(pixel, frame.history.yz))) {
        return vec4(0.0);
    }
    vec4 velocity = texelFetch(velocity_image, ivec2(pixel), 0);
    ivec2 at = ivec2(pixel) + ivec2(round(masu_unjittered(masu_sane(velocity, -32768.0, 32768.0).xy, vec2(pc.render_width, pc.render_height))));
    if (!(velocity.w > 0.0) || any(lessThan(at, ivec2(0))) ||
        any(greaterThanEqual(at, ivec2(frame.history.yz))) ||
        !was_it(at >> 1, masu_unpack_normal(texelFetch(normal_image, ivec2(pixel), 0).r))) {
        return vec4(0.0);
    }
    uint word = texelFetch(old_fine_image, at >> 1, 0)[(at.x & 1) + 2 * (at.y & 1)];
    return word == masu_fine_none ? vec4(0.0) : vec4(masu_unpack_fine(word), 1.0);
}

vec4 look(uvec2 pixel, vec2 moved, masu_guide g)
{
    vec2 scale = vec2(frame.history.yz) / vec2(pc.render_width, pc.render_height);
    vec2 place = (vec2(pixel) + 0.5 + moved) * scale - 0.5;
    place = masu_sane(vec4(place, 0.0, 0.0), -2.0, 32768.0).xy;
    vec2 whole = round(place);
    if (all(lessThan(abs(place - whole), vec2(4e-3)))) {
        return old_pixel(ivec2(whole), g);
    }
    vec2 corner = floor(place);
    vec2 part = place - corner;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 off = ivec2(k & 1, k >> 1);
        float bilinear = mix(1.0 - part.x, part.x, float(off.x)) * mix(1.0 - part.y, part.y, float(off.y));
        sum += bilinear * old_pixel(ivec2(corner) + off, g);
    }
    return sum.a > 0.2 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}

/* What few rays meet and much light comes from is noise in so few of them: no brighter than what the means
 * of the eight texels around show, nor than four times what the pixel has. A highlight that is there comes up
 * all the same, by four times with each ray. x: the mean of the eight; y: what they show at most. Once for a texel and
 * before its pixels, whose registers it would take. */
vec2 sparks_around(ivec2 texel)
{
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    float sum = 0.0;
    float squares = 0.0;
    float count = 0.0;
    for (int k = 0; k < 9; k++) {
        ivec2 at = texel + ivec2(k % 3 - 1, k / 3 - 1);
        if (k == 4 || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last)) ||
            !masu_unpack_guide(texelFetch(guide_image, at, 0).rg).there) {
            continue;
        }
        float y = masu_luma(masu_tamed(texelFetch(mean_image, at, 0).rgb));
        sum += y;
        squares += y * y;
        count += 1.0;
    }
    if (!(count > 0.0)) {
        return vec2(0.0, masu_huge);
    }
    float mean = sum / max(count, 1.0);
    return vec2(mean, mean + 2.5 * masu_sqrt(squares / max(count, 1.0) - mean * mean) + 0.1 * mean);
}

vec3 without_sparks(vec3 color, vec4 old, vec2 around)
{
    float most = around.y;
    if (old.a > 0.0 && most < masu_huge) {
        most = min(most, 4.0 * masu_luma(old.rgb) + around.x);
    }
    return masu_no_brighter(color, most);
}

/* Of the rays of the 3x3 texels. */
void colors_around(ivec2 texel, out vec3 least, out vec3 most)
{
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    least = vec3(masu_most_radiance);
    most = vec3(0.0);
    for (int k = 0; k < 9; k++) {
        ivec2 at = clamp(texel + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last);
        if (masu_unpack_guide(texelFetch(guide_image, at, 0).rg).there) {
            vec3 c = masu_tamed(texelFetch(light_image, at, 0).rgb);
            least = min(least, c);
            most = max(most, c);
        }
    }
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        uvec4 words = uvec4(masu_fine_none);
        if (g.there && masu_fine_share(g, g.roughness) > 0.0) {
            vec3 color = masu_tamed(texelFetch(light_image, ivec2(texel), 0).rgb);
            uvec2 age = texelFetch(age_image, ivec2(texel), 0).rg;
            bool known = frame.history.y != 0u && age.y != masu_unmoved;
            vec2 moved = known ? unpackHalf2x16(age.y) : vec2(0.0);
            /* Each fourth frame is this pixel's. What it has from before the first round is of another
             * surface, maybe. */
            float own = max(floor((masu_age_frames(age.x) - 0.9) * 0.25), 0.0);
            /* A ray a quarter as often: the mean of a surface that has no other reaches back four times as far. */
            float reach = max(float(push.frames) * (g.mixed ? 1.0 : 0.25), 1.0);
            bool moving = masu_is_moving(moved);
            bool young = masu_age_frames(age.x) < 8.0;
            vec3 least = vec3(0.0);
            vec3 most = vec3(masu_most_radiance);
            if (moving || (young && frame.temporal.z >= MASU_TEMPORAL_CHANGES)) {
                colors_around(ivec2(texel), least, most);
            }
            if (moving) {
                own = min(own, g.mixed ? 4.0 : 100.0 * g.roughness * g.roughness);
            }
            float share = max(1.0 / (own + 1.0), masu_time_share(reach));
            share = masu_worthy_share(share, masu_drawn_worth(texelFetch(ray_image, ivec2(texel), 0).g));
            vec2 noise = masu_turn_noise2(masu_trace_noise(masu_noise_index(texel.x, texel.y, 4u)), masu_turn(frame.history.x));
            float dither = noise.x;
            if (!(g.roughness > masu_mirror_roughness)) {
                /* The same ray each time: rounded by another dither it would flicker, up to 6 of 255 in a dark channel
                 * beside a bright one, and no mean would make up for it. */
                share = 1.0;
                dither = 0.5;
            }
            vec2 around = g.roughness > masu_fine_narrow ? sparks_around(ivec2(texel)) : vec2(0.0, masu_huge);
            for (uint k = 0u; k < 4u; k++) {
                uvec2 pixel = masu_guide_place(texel, k, 2u);
                vec4 old = known && has_old() && !g.mixed ? look(pixel, moved, g) : vec4(0.0);
                if (!(old.a > 0.0)) {
                    old = own_way(pixel);
                }
                old.rgb = clamp(old.rgb, least, most);
                if (k == g.pixel) {
                    color = without_sparks(color, old, around);
                    old = vec4(old.a > 0.0 ? mix(old.rgb, color, share) : color, 1.0);
                }
                words[k] = old.a > 0.0 ? masu_pack_fine(old.rgb, dither) : masu_fine_none;
            }
        }
        MASU_STORE_UINT(fine_image, texel, words);
    }
    masu_count_end();
}
