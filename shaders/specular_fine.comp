/*
 * specular_fine.comp: full-resolution mean of reflections. Reflections in smooth surfaces are as
 * sharp as the image, and a mean over a texel's 2x2 pixels blurs them. If the four pixels show
 * several surfaces, a common mean has no meaning. Here each pixel has a separate mean: the pixel
 * that the texel traced in this frame adds its ray, the others keep their history. It is
 * reprojected to the position that specular_temporal found for the texel, else to that of the
 * pixel's surface. A mirror's ray has no noise and replaces the mean.
 *
 * Samples are weighted by their ray weight (specular_rays.comp).
 *
 * In motion the four means are up to four frames old, and the reflection has moved by a different
 * amount for each. The mean is then short, shorter for smoother surfaces, and clamped to the
 * colours of the 3x3 rays. A mean that has just begun in a changing scene is clamped too: an object
 * that has passed in a mirror remains visible in pixels that have not been traced since.
 *
 * push.frames: length of the mean in 1/60 s.
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

/* Whether the previous frame has full-resolution history. A rung without it keeps only the other
 * history. */
bool has_old()
{
    return frame.history.y != 0u && (frame.history.w & uint(MASU_HISTORY_NO_FINE)) == 0u;
}

/* a: 0: no history. at: pixel of the previous frame. */
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

/* Whether a texel of the previous frame can have shown a surface with this normal. A texel with
 * several surfaces can have shown any. */
bool was_it(ivec2 texel, vec3 normal)
{
    masu_guide o = masu_unpack_guide(texelFetch(old_guide_image, texel, 0).rg);
    return o.there && (o.mixed || dot(o.normal, normal) > 0.8);
}

/* History at the previous position of the pixel's own surface, whatever the texel there stood for.
 * Uses the nearest pixel, because between two pixels is the outline. */
vec4 own_way(uvec2 pixel)
{
    if (!has_old() || frame.history.yz != uvec2(pc.render_width, pc.render_height) ||
        any(greaterThanEqual(pixel, frame.history.yz))) {
        return vec4(0.0);
    }
    vec4 velocity = texelFetch(velocity_image, ivec2(pixel), 0);
    ivec2 at = ivec2(pixel) +
               ivec2(round(masu_unjittered(masu_sane(velocity, -32768.0, 32768.0).xy,
                                           vec2(pc.render_width, pc.render_height))));
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
        float bilinear = mix(1.0 - part.x, part.x, float(off.x)) *
                         mix(1.0 - part.y, part.y, float(off.y));
        sum += bilinear * old_pixel(ivec2(corner) + off, g);
    }
    return sum.a > 0.2 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}

/* Limit for fireflies: few rays hit bright light, which is noise in so short a mean. A sample is
 * limited by the means of the eight texels around, and by four times the pixel's mean. A real
 * highlight still appears, growing by a factor of four with each ray. x: the mean of the eight; y:
 * their upper bound. Computed once per texel before its pixels, to save registers. */
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

/* Colour bounds of the rays of the 3x3 texels. */
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
            /* This pixel is traced in each fourth frame. Its history from before the first round
             * may belong to another surface. */
            float own = max(floor((masu_age_frames(age.x) - 0.9) * 0.25), 0.0);
            /* A pixel has a ray in every fourth frame only: if it has no other mean, its own is
             * four times as long. */
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
            share = masu_worthy_share(share,
                                      masu_drawn_worth(texelFetch(ray_image, ivec2(texel), 0).g));
            vec2 noise = masu_turn_noise2(masu_trace_noise(masu_noise_index(texel.x, texel.y, 4u)),
                                          masu_turn(frame.history.x));
            float dither = noise.x;
            if (!(g.roughness > masu_mirror_roughness)) {
                /* Each frame traces the same ray. With a changing dither the rounding would
                 * flicker, up to 6 of 255 in a dark channel next to a bright one, and no mean would
                 * remove it. */
                share = 1.0;
                dither = 0.5;
            }
            vec2 around = g.roughness > masu_fine_narrow ? sparks_around(ivec2(texel))
                                                         : vec2(0.0, masu_huge);
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
