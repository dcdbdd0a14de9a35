/*
 * specular_temporal.comp: temporal accumulation of reflections. Each texel's history is sampled at
 * two positions of the previous frame: of the surface (velocity), and of the reflected object
 * (specular_motion; averaged over 3x3 texels, since each texel's ray has a different hit).
 * Mirrors need the second, rough surfaces with their wide lobes the first.
 *
 * A history texel is weighted by its distance to the plane of the reprojected surface and by the
 * similarity of the normals. Its surface may still have reflected something else. Test: the means
 * of the same 3x3 texels in both frames may differ by the noise of nine rays; a larger difference
 * shortens the history (after the weight of "Gran Turismo 7", exp(-|Y - mean| / sigma)). Clamping
 * to the current 3x3 texels only would remove light that few rays hit but that is bright. The clamp
 * handles the remainder, and is as wide as the history's own noise.
 *
 * While the camera moves, the mean is short, and few rays that hit bright light are fireflies: each
 * sample is limited by the usual brightness around it. Stationary pixels have no limit; their
 * mean is long enough.
 *
 * Samples are weighted by their ray weight (specular_rays.comp).
 *
 * push.frames: length of the mean in 1/60 s. push.reused: not 0: specular_reuse has run.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/specular_temporal.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"
#include "specular/filter.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D light_image;
layout(set = MASU_SET_PASS, binding = 2) uniform usampler2D motion_image;
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D velocity_image;
layout(set = MASU_SET_PASS, binding = 4) uniform usampler2D old_guide_image;
layout(set = MASU_SET_PASS, binding = 5) uniform sampler2D old_mean_image;
layout(set = MASU_SET_PASS, binding = 6) uniform usampler2D old_age_image;
layout(set = MASU_SET_PASS, binding = 7) uniform sampler2D own_light_image; /* own rays only */
layout(set = MASU_SET_PASS, binding = 8) uniform usampler2D ray_image;
layout(set = MASU_SET_PASS, binding = 9, rgba16f) uniform writeonly image2D mean_image;
layout(set = MASU_SET_PASS, binding = 10, rg32ui) uniform writeonly uimage2D age_image;

/* Deviations of a 3x3 mean that are treated as noise, and the rate of forgetting beyond them. */
const float surprise = 3.0;
const float forget = 0.5;
/* If the motions of a 3x3 neighbourhood differ by more than this number of pixels plus this share
 * of the larger one, they belong to several objects and the texel is at an outline. There the
 * history has at most `most_outline` frames; more on a moving surface, whose history is limited
 * anyway. */
const float apart_pixels = 0.05;
const float apart_share = 0.5;
const float most_outline = 3.0;
const float most_outline_moving = 8.0;
/* Number of frames in the mean from which it uses only the texel's own rays. Neighbours' hits
 * (specular_reuse) are used without a visibility test, an error that averaging does not remove, so
 * they only serve the first few frames. */
const float reuse_until = 8.0;
/* Half the width of the clamp, in deviations. */
const float clamp_width = 2.0;
/* No deviation of chroma is stored: that of luma is used, times this factor. If few rays hit
 * something red, nine rays that do not are no reason to forget it. */
const float chroma_width = 3.0;
/* Limit of samples in motion: the mean of the 3x3 texels of the previous frame plus a tenth, plus
 * this number of deviations of one of its rays. */
const float usual = 5.0;
const float near_mean = 0.1;

/* The texel in the current frame, and its surface in the previous frame. */
struct here {
    ivec2 texel;
    masu_guide g;
    vec3 point;
    vec3 was;    /* relative to the previous camera */
    float width; /* width of a texel, of the coarser frame */
};

struct past {
    vec4 mean;
    float age;
    float weight; /* 0..1: share of the history that is of this surface */
    vec2 place;   /* position in texels of the previous frame */
    vec2 luma;    /* result of past_luma */
    float off;    /* result of distance_of */
};

struct present {
    vec3 mean, sigma; /* YCoCg, of 3x3 */
    vec2 motion;   /* the mean; at an outline, the motion of the nearest surface */
    float motions;
    bool several;  /* objects with different motions */
    float far;
};

vec3 old_point(ivec2 texel, masu_guide o)
{
    vec2 size = vec2(frame.history.yz);
    vec2 ndc = (vec2(masu_guide_place(uvec2(texel), o.pixel, 2u)) + 0.5) / size * 2.0 - 1.0 +
               previous.jitter.xy;
    float z = previous.forward.w * masu_rcp(o.depth);
    return (previous.forward.xyz + previous.right.xyz * ndc.x - previous.up.xyz * ndc.y) * z;
}

ivec2 old_last()
{
    return (ivec2(frame.history.yz) + 1) / 2 - 1;
}

/* moved: pixels of this frame's render size. */
past look(here h, vec2 moved)
{
    past p;
    p.mean = vec4(0.0);
    p.age = 0.0;
    p.weight = 0.0;
    vec2 scale = vec2(frame.history.yz) / vec2(pc.render_width, pc.render_height);
    p.place = (2.0 * vec2(h.texel) + 1.0 + moved) * scale * 0.5 - 0.5;
    p.place = clamp(masu_sane(vec4(p.place, 0.0, 0.0), -2.0, 32768.0).xy, vec2(-2.0), vec2(32768.0));
    /* Stationary texels are read without interpolation: an offset of a thousandth of a texel would
     * blur them in a thousand frames. */
    vec2 whole = round(p.place);
    if (all(lessThan(abs(p.place - whole), vec2(2e-3)))) {
        p.place = whole;
    }
    vec2 corner = floor(p.place);
    vec2 part = p.place - corner;
    ivec2 last = old_last();
    [[dont_unroll]] for (int k = 0; k < 4; k++) {
        ivec2 off = ivec2(k & 1, k >> 1);
        ivec2 at = ivec2(corner) + off;
        float bilinear = mix(1.0 - part.x, part.x, float(off.x)) * mix(1.0 - part.y, part.y, float(off.y));
        if (!(bilinear > 0.0) || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
            continue;
        }
        masu_guide o = masu_unpack_guide(texelFetch(old_guide_image, at, 0).rg);
        vec4 mean = texelFetch(old_mean_image, at, 0);
        if (!o.there || !(mean.a >= 0.0) || !masu_finite(mean) || abs(o.roughness - h.g.roughness) > 0.1 ||
            dot(o.normal, h.g.normal) < 0.8 ||
            !masu_same_plane(old_point(at, o) - h.was, h.g.normal, h.width)) {
            continue;
        }
        p.mean += bilinear * mean;
        p.age += bilinear * masu_age_frames(texelFetch(old_age_image, at, 0).r);
        p.weight += bilinear;
    }
    float scale_up = masu_rcp(p.weight);
    p.mean *= scale_up;
    p.age *= scale_up;
    /* One corner with a small weight is not a reliable history. */
    p.weight = p.weight > 0.05 ? p.weight : 0.0;
    return p;
}

present gather(here h)
{
    present r;
    vec3 sum = vec3(0.0);
    vec3 squares = vec3(0.0);
    float count = 0.0;
    float nearness = 0.0;
    r.motion = vec2(0.0);
    r.motions = 0.0;
    vec2 least = vec2(65504.0);
    vec2 most = vec2(-65504.0);
    vec2 front = vec2(0.0);
    float front_far = masu_huge;
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    masu_flat flat_here = masu_flat_through(h.point, h.g.normal);
    [[dont_unroll]] for (int k = 0; k < 9; k++) {
        ivec2 at = h.texel + ivec2(k % 3 - 1, k / 3 - 1);
        if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
            continue;
        }
        masu_guide o = masu_unpack_guide(texelFetch(guide_image, at, 0).rg);
        if (!o.there || dot(o.normal, h.g.normal) < 0.7 ||
            !(abs(masu_specular_off(flat_here, uvec2(at), o)) < h.width)) {
            continue;
        }
        vec4 light = texelFetch(light_image, at, 0);
        vec3 c = masu_ycocg(masu_tamed(light.rgb));
        sum += c;
        squares += c * c;
        count += 1.0;
        nearness += masu_rcp(max(masu_sane(light.a, 0.0, 65504.0), 1e-4));
        uint moved = texelFetch(motion_image, at, 0).r;
        if (moved != masu_unmoved) {
            vec2 motion = masu_sane(vec4(unpackHalf2x16(moved), 0.0, 0.0), -65504.0, 65504.0).xy;
            r.motion += motion;
            r.motions += 1.0;
            least = min(least, motion);
            most = max(most, motion);
            float far = texelFetch(own_light_image, at, 0).a;
            if (far < front_far) {
                front_far = far;
                front = motion;
            }
        }
    }
    count = max(count, 1.0);
    r.mean = sum / count;
    r.sigma = sqrt(max(squares / count - r.mean * r.mean, 0.0));
    vec2 jitter = masu_unjittered(vec2(0.0), vec2(pc.render_width, pc.render_height));
    vec2 larger = max(abs(least + jitter), abs(most + jitter));
    r.several = any(greaterThan(most - least, apart_pixels + apart_share * larger));
    r.motion = r.several ? front : r.motion / max(r.motions, 1.0);
    r.far = count / max(nearness, 1e-9);
    return r;
}

/* x: mean luma of 3x3 texels around a position of the previous frame; y: variance of one frame's
 * luma. Below 0: no valid texel. */
vec2 past_luma(vec2 place)
{
    ivec2 middle = ivec2(round(place));
    ivec2 last = old_last();
    float sum = 0.0;
    float spread = 0.0;
    float count = 0.0;
    [[dont_unroll]] for (int k = 0; k < 9; k++) {
        ivec2 at = middle + ivec2(k % 3 - 1, k / 3 - 1);
        if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
            continue;
        }
        vec4 mean = texelFetch(old_mean_image, at, 0);
        if (!(mean.a >= 0.0) || !masu_finite(mean)) {
            continue;
        }
        float y = masu_luma(mean.rgb);
        sum += y;
        spread += max(mean.a - y * y, 0.0);
        count += 1.0;
    }
    return count > 0.0 ? vec2(sum, spread) / count : vec2(-1.0);
}

/* Difference between history and current luma, in deviations of the current noise. */
float distance_of(vec2 then, present now)
{
    if (!(then.x >= 0.0)) {
        return 0.0;
    }
    /* Nine rays, partly shared by neighbours. */
    float noise = sqrt(max(then.y, 0.0) / 4.0) + 0.02 * then.x + 1e-3;
    return abs(then.x - now.mean.x) / noise;
}

/* Number of frames for which a texel has contained several surfaces. Its mean restarts in
 * each frame, because each traces another pixel; the means of its pixels do not (specular_fine). */
float turns(here h, vec2 moved)
{
    vec2 scale = vec2(frame.history.yz) / vec2(pc.render_width, pc.render_height);
    vec2 place = (2.0 * vec2(h.texel) + 1.0 + moved) * scale * 0.5;
    ivec2 at = ivec2(floor(masu_sane(vec4(place, 0.0, 0.0), -2.0, 32768.0).xy));
    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, old_last())) ||
        !masu_unpack_guide(texelFetch(old_guide_image, at, 0).rg).there) {
        return 0.0;
    }
    return masu_age_frames(texelFetch(old_age_image, at, 0).r);
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        here h;
        h.texel = ivec2(texel);
        h.g = masu_unpack_guide(texelFetch(guide_image, h.texel, 0).rg);
        vec4 mean = vec4(0.0);
        uvec2 age = uvec2(0u, masu_unmoved);
        if (h.g.there) {
            vec2 size = vec2(pc.render_width, pc.render_height);
            uvec2 pixel = masu_guide_place(texel, h.g.pixel, 2u);
            h.point = masu_specular_point(texel, h.g);
            h.width = masu_texel_width(h.g);
            vec4 light = texelFetch(light_image, h.texel, 0);
            vec3 color = masu_tamed(light.rgb);
            float y = masu_luma(color);
            vec4 sample_mean = vec4(color, y * y);
            present now = gather(h);
            mean = sample_mean;
            float frames = 1.0;
            vec4 velocity = texelFetch(velocity_image, ivec2(pixel), 0);
            if (frame.history.y != 0u && velocity.w > 0.0 && masu_finite(velocity)) {
                vec2 ndc = (vec2(pixel) + 0.5 + velocity.xy) / size * 2.0 - 1.0 + previous.jitter.xy;
                float z = frame.forward.w * masu_rcp(h.g.depth) * (1.0 + velocity.z);
                h.was = (previous.forward.xyz + previous.right.xyz * ndc.x - previous.up.xyz * ndc.y) * z;
                h.width *= max(1.0, size.y / float(frame.history.z));
                bool apart = now.motions > 0.0 && any(greaterThan(abs(now.motion - velocity.xy), vec2(2e-3)));
                float surface = 1.0;
                /* The surface's position, then the reflected object's. A loop: shorter code. */
                past a;
                past b;
                [[dont_unroll]] for (int i = 0; i < 2; i++) {
                    if (i == 0 || apart) {
                        b = look(h, masu_unjittered(i == 0 ? velocity.xy : now.motion, size));
                        b.luma = b.weight > 0.0 ? past_luma(b.place) : vec2(-1.0);
                        b.off = distance_of(b.luma, now);
                    }
                    if (i == 0) {
                        a = b;
                    }
                }
                if (apart) {
                    float rough = smoothstep(0.2, 0.8, h.g.roughness);
                    surface = a.weight * rough * masu_exp2(-min(a.off, 60.0));
                    float mirrored = b.weight * (1.0 - rough) * masu_exp2(-min(b.off, 60.0));
                    float both = surface + mirrored;
                    surface = both > 1e-20 ? surface / both : (b.weight > 0.0 ? 0.0 : 1.0);
                }
                float weight = mix(b.weight, a.weight, surface);
                if (h.g.mixed) {
                    vec2 motion = masu_unjittered(velocity.xy, size);
                    frames = 1.0 + turns(h, motion);
                    age.y = packHalf2x16(clamp(motion, vec2(-60000.0), vec2(60000.0)));
                } else if (weight > 0.0) {
                    vec4 history = mix(b.mean, a.mean, surface);
                    float old_y = masu_luma(history.rgb);
                    float old_sigma = masu_sqrt(history.a - old_y * old_y);
                    float off = mix(b.off, a.off, surface);
                    float trust = masu_exp2(-forget * max(off - surprise, 0.0));
                    frames = mix(b.age, a.age, surface) * trust;
                    if (now.several) {
                        bool moves = masu_is_moving(masu_unjittered(velocity.xy, size));
                        frames = min(frames, moves ? most_outline_moving : most_outline);
                    }
                    /* Clamp along the line to the current mean. */
                    vec3 wide = clamp_width * max(now.sigma, old_sigma * vec3(1.0, chroma_width, chroma_width)) + 1e-3 + 0.02 * now.mean.x;
                    vec3 from = masu_ycocg(history.rgb) - now.mean;
                    vec3 times = abs(from) / wide;
                    float most = max(times.x, max(times.y, times.z));
                    if (most > 1.0) {
                        history.rgb = max(masu_from_ycocg(now.mean + from / most), vec3(0.0));
                        float new_y = masu_luma(history.rgb);
                        history.a = new_y * new_y + old_sigma * old_sigma;
                        frames = frames / most;
                    }
                    float reach = h.g.roughness > masu_mirror_roughness ? float(push.frames) : 4.0;
                    float share = max(1.0 / (frames + 1.0), masu_time_share(reach));
                    float alone = smoothstep(0.0, reuse_until, frames);
                    color = mix(color, masu_tamed(texelFetch(own_light_image, h.texel, 0).rgb), alone);
                    /* Rays reused from neighbours are already weighted. */
                    float worth = masu_drawn_worth(texelFetch(ray_image, h.texel, 0).g);
                    share = masu_worthy_share(share, push.reused != 0u ? mix(1.0, worth, alone) : worth);
                    y = masu_luma(color);
                    vec2 motion = masu_unjittered(mix(now.motion, velocity.xy, surface), size);
                    vec2 luma = mix(b.luma, a.luma, surface);
                    float most_y = max((1.0 + near_mean) * luma.x + usual * masu_sqrt(luma.y), 0.0);
                    /* After a rejected history (frames) the usual brightness is not defined. */
                    if (frames > 1.0 && masu_is_moving(motion) && h.g.roughness > masu_mirror_roughness) {
                        /* y is not limited: its square determines the next frame's limit. */
                        color = masu_no_brighter(color, most_y);
                    }
                    mean = mix(history, vec4(color, y * y), share);
                    frames += 1.0;
                    age.y = packHalf2x16(clamp(motion, vec2(-60000.0), vec2(60000.0)));
                }
            }
            age.x = masu_pack_age(frames, now.far);
        }
        mean = vec4(masu_tamed(mean.rgb), masu_sane(mean.a, 0.0, 65504.0));
        MASU_STORE_HALF(mean_image, texel, mean);
        MASU_STORE_UINT(age_image, texel, uvec4(age, 0u, 0u));
    }
    masu_count_end();
}
