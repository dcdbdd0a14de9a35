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
    masu_flat was; /* plane of the surface, by pixels of the previous frame */
    float width;   /* width of a texel, of the coarser frame; `was` and it / previous near plane */
    vec2 shift;    /* masu_unjittered(0) */
    vec2 scale;    /* size of the previous frame / this one's */
    ivec2 last;    /* texel of the previous frame */
};

struct past {
    vec4 mean;
    float age;
    float weight; /* 0..1: share of the history that is of this surface */
    ivec2 closest; /* texel of the previous frame */
    vec2 luma;    /* result of past_luma */
    float off;    /* result of distance_of */
};

/* Flags of `present`. */
const uint several = 0x10000u; /* objects with different motions */
const uint mixed = 0x20000u;   /* masu_guide.mixed */

struct present {
    vec3 mean, sigma; /* YCoCg, of 3x3 */
    vec2 motion;   /* the mean; at an outline, the motion of the nearest surface */
    float motions;
    uint flags;    /* masu_pack_far, several, mixed: one register for three values */
};

/* The plane through a point of the previous frame. place: the point in pixels of that frame, 0.5 is
 * the centre of the first; z: its view depth / near plane. */
masu_flat flat_before(vec2 place, float z, vec3 n)
{
    vec2 aside = vec2(dot(previous.right.xyz, n), -dot(previous.up.xyz, n));
    masu_flat f;
    f.lean = aside * (2.0 / vec2(frame.history.yz));
    f.base = dot(previous.forward.xyz, n) + dot(aside, previous.jitter.xy - 1.0) +
             dot(f.lean, vec2(0.5));
    /* one value to keep, not two factors */
    precise float at = (f.base + dot(f.lean, place - 0.5)) * z;
    f.at = at;
    return f;
}

/* Distance of a texel of the previous frame from that plane. */
float off_before(masu_flat f, ivec2 texel, masu_guide o)
{
    return (f.base + dot(f.lean, vec2(masu_guide_place(uvec2(texel), o.pixel, 2u)))) / o.depth -
           f.at;
}

/* moved: pixels of this frame's render size. */
past look(here h, vec2 moved)
{
    past p;
    p.mean = vec4(0.0);
    p.age = 0.0;
    p.weight = 0.0;
    vec2 place = (2.0 * vec2(h.texel) + 1.0 + moved) * h.scale * 0.5 - 0.5;
    place = masu_sane(vec4(place, 0.0, 0.0), -2.0, 32768.0).xy;
    /* Stationary texels are read without interpolation: an offset of a thousandth of a texel would
     * blur them in a thousand frames. */
    vec2 whole = round(place);
    if (all(lessThan(abs(place - whole), vec2(2e-3)))) {
        place = whole;
    }
    vec2 corner = floor(place);
    vec2 part = place - corner;
    [[dont_unroll]] for (int k = 0; k < 4; k++) {
        ivec2 off = ivec2(k & 1, k >> 1);
        ivec2 at = ivec2(corner) + off;
        float bilinear = mix(1.0 - part.x, part.x, float(off.x)) *
                         mix(1.0 - part.y, part.y, float(off.y));
        if (bilinear > 0.0 && all(greaterThanEqual(at, ivec2(0))) &&
            all(lessThanEqual(at, h.last))) {
            masu_guide o = masu_unpack_guide(texelFetch(old_guide_image, at, 0).rg);
            if (o.there && !(abs(o.roughness - h.g.roughness) > 0.1) &&
                !(dot(o.normal, h.g.normal) < 0.8) && abs(off_before(h.was, at, o)) < h.width) {
                vec4 mean = texelFetch(old_mean_image, at, 0);
                if (mean.a >= 0.0 && masu_finite(mean)) {
                    p.mean += bilinear * mean;
                    p.age += bilinear * masu_age_frames(texelFetch(old_age_image, at, 0).r);
                    p.weight += bilinear;
                }
            }
        }
    }
    float scale_up = masu_rcp(p.weight);
    p.mean *= scale_up;
    p.age *= scale_up;
    /* One corner with a small weight is not a reliable history. */
    p.weight = p.weight > 0.05 ? p.weight : 0.0;
    p.closest = ivec2(corner) + ivec2(greaterThanEqual(part, vec2(0.5)));
    return p;
}

/* point: of the texel, relative to the camera. */
present gather(here h, vec3 point)
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
    masu_flat flat_here = masu_flat_through(point, h.g.normal);
    [[dont_unroll]] for (int k = 0; k < 9; k++) {
        ivec2 at = h.texel + masu_ninth(k);
        if (all(greaterThanEqual(at, ivec2(0))) && all(lessThanEqual(at, last))) {
            masu_guide o = masu_unpack_guide(texelFetch(guide_image, at, 0).rg);
            if (o.there && !(dot(o.normal, h.g.normal) < 0.7) &&
                abs(masu_specular_off(flat_here, uvec2(at), o)) < h.width) {
                vec4 light = texelFetch(light_image, at, 0);
                vec3 c = masu_ycocg(masu_tamed(light.rgb));
                sum += c;
                squares += c * c;
                count += 1.0;
                nearness += masu_rcp(max(masu_sane(light.a, 0.0, 65504.0), 1e-4));
                uint moved = texelFetch(motion_image, at, 0).r;
                if (moved != masu_unmoved) {
                    vec2 motion =
                        masu_sane(vec4(unpackHalf2x16(moved), 0.0, 0.0), -65504.0, 65504.0).xy;
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
        }
    }
    count = max(count, 1.0);
    r.mean = sum / count;
    r.sigma = sqrt(max(squares / count - r.mean * r.mean, 0.0));
    vec2 larger = max(abs(least + h.shift), abs(most + h.shift));
    bool differ = any(greaterThan(most - least, apart_pixels + apart_share * larger));
    r.motion = differ ? front : r.motion / max(r.motions, 1.0);
    r.flags = masu_pack_far(count / max(nearness, 1e-9)) | (differ ? several : 0u) |
              (h.g.mixed ? mixed : 0u);
    return r;
}

/* x: mean luma of 3x3 texels of the previous frame; y: variance of one frame's luma. Below 0: no
 * valid texel. */
vec2 past_luma(ivec2 middle, ivec2 last)
{
    float sum = 0.0;
    float spread = 0.0;
    float count = 0.0;
    [[dont_unroll]] for (int k = 0; k < 9; k++) {
        ivec2 at = middle + masu_ninth(k);
        if (all(greaterThanEqual(at, ivec2(0))) && all(lessThanEqual(at, last))) {
            vec4 mean = texelFetch(old_mean_image, at, 0);
            if (mean.a >= 0.0 && masu_finite(mean)) {
                float y = masu_luma(mean.rgb);
                sum += y;
                spread += max(mean.a - y * y, 0.0);
                count += 1.0;
            }
        }
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
    vec2 place = (2.0 * vec2(h.texel) + 1.0 + moved) * h.scale * 0.5;
    ivec2 at = ivec2(floor(masu_sane(vec4(place, 0.0, 0.0), -2.0, 32768.0).xy));
    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, h.last)) ||
        !masu_unpack_guide(texelFetch(old_guide_image, at, 0).rg).there) {
        return 0.0;
    }
    return masu_age_frames(texelFetch(old_age_image, at, 0).r);
}

bool are_apart(vec2 a, vec2 b)
{
    return any(greaterThan(abs(a - b), vec2(2e-3)));
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
            h.width = masu_texel_width(h.g);
            /* precise, as above */
            precise vec2 shift = (previous.jitter.zw - frame.jitter.zw) * (0.5 * size);
            h.shift = shift;
            present now = gather(h, masu_specular_point(texel, h.g));
            float frames = 1.0, weight = 0.0, off = 0.0;
            vec4 history = vec4(0.0);
            vec2 motion = vec2(0.0), luma = vec2(0.0);
            vec4 velocity = texelFetch(velocity_image, ivec2(pixel), 0);
            if (frame.history.y != 0u && velocity.w > 0.0 && masu_finite(velocity)) {
                float per_near = masu_rcp(previous.forward.w);
                h.scale = vec2(frame.history.yz) / size;
                h.last = (ivec2(frame.history.yz) + 1) / 2 - 1;
                h.was = flat_before((vec2(pixel) + 0.5 + velocity.xy) * h.scale,
                                    frame.forward.w * masu_rcp(h.g.depth) * (1.0 + velocity.z) *
                                        per_near,
                                    h.g.normal);
                h.width *= max(1.0, size.y / float(frame.history.z)) * per_near;
                if (!(now.motions > 0.0) || !are_apart(now.motion, velocity.xy)) {
                    now.motion = velocity.xy;
                }
                /* The surface's position, then the reflected object's. A loop: shorter code. */
                past a;
                past b;
                [[dont_unroll]] for (int i = 0; i < 2; i++) {
                    b = look(h, (i == 0 ? velocity.xy : now.motion) + h.shift);
                    b.luma = b.weight > 0.0 ? past_luma(b.closest, h.last) : vec2(-1.0);
                    b.off = distance_of(b.luma, now);
                    if (i == 0) {
                        a = b;
                        if (!are_apart(now.motion, velocity.xy)) {
                            break;
                        }
                    }
                }
                float surface = 1.0;
                if (are_apart(now.motion, velocity.xy)) {
                    float rough = smoothstep(0.2, 0.8, h.g.roughness);
                    surface = a.weight * rough * masu_exp2(-min(a.off, 60.0));
                    float mirrored = b.weight * (1.0 - rough) * masu_exp2(-min(b.off, 60.0));
                    float both = surface + mirrored;
                    surface = both > 1e-20 ? surface / both : (b.weight > 0.0 ? 0.0 : 1.0);
                }
                if ((now.flags & mixed) != 0u) {
                    motion = velocity.xy + h.shift;
                    frames = 1.0 + turns(h, motion);
                    age.y = packHalf2x16(clamp(motion, vec2(-60000.0), vec2(60000.0)));
                } else {
                    weight = mix(b.weight, a.weight, surface);
                    history = mix(b.mean, a.mean, surface);
                    luma = mix(b.luma, a.luma, surface);
                    off = mix(b.off, a.off, surface);
                    motion = mix(now.motion, velocity.xy, surface) + h.shift;
                    if (weight > 0.0) {
                        frames = mix(b.age, a.age, surface);
                    }
                }
            }
            vec3 color = masu_tamed(texelFetch(light_image, h.texel, 0).rgb);
            float y = masu_luma(color);
            mean = vec4(color, y * y);
            if (weight > 0.0) {
                float old_y = masu_luma(history.rgb);
                float old_sigma = masu_sqrt(history.a - old_y * old_y);
                frames *= masu_exp2(-forget * max(off - surprise, 0.0));
                if ((now.flags & several) != 0u) {
                    bool moves = masu_is_moving(velocity.xy + h.shift);
                    frames = min(frames, moves ? most_outline_moving : most_outline);
                }
                /* Clamp along the line to the current mean. */
                vec3 wide = clamp_width *
                                max(now.sigma, old_sigma * vec3(1.0, chroma_width, chroma_width)) +
                            1e-3 + 0.02 * now.mean.x;
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
                share = masu_worthy_share(share,
                                          push.reused != 0u ? mix(1.0, worth, alone) : worth);
                y = masu_luma(color);
                float most_y = max((1.0 + near_mean) * luma.x + usual * masu_sqrt(luma.y), 0.0);
                /* After a rejected history (frames) the usual brightness is not defined. */
                if (frames > 1.0 && masu_is_moving(motion) &&
                    h.g.roughness > masu_mirror_roughness) {
                    /* y is not limited: its square determines the next frame's limit. */
                    color = masu_no_brighter(color, most_y);
                }
                mean = mix(history, vec4(color, y * y), share);
                frames += 1.0;
                age.y = packHalf2x16(clamp(motion, vec2(-60000.0), vec2(60000.0)));
            }
            age.x = masu_pack_age(frames, now.flags & 0xFFFFu);
        }
        mean = vec4(masu_tamed(mean.rgb), masu_sane(mean.a, 0.0, 65504.0));
        MASU_STORE_HALF(mean_image, texel, mean);
        MASU_STORE_UINT(age_image, texel, uvec4(age, 0u, 0u));
    }
    masu_count_end();
}
