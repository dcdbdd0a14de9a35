/*
 * specular_composite.comp: adds reflections to the lit image at full size: radiance of the four
 * traced texels around a pixel, times the directional albedo of the pixel's lobe (brdf/tables.glsl,
 * the split sum). light.comp has omitted the same share of the sky's reflection
 * (masu_kept_mirrors).
 *
 * Joint bilateral upsampling: bilinear weights, times the closeness of a texel's surface point to
 * the pixel's plane and the similarity of the normals. If all four texels are other surfaces, the
 * one closest to the plane is used; if none is traced, light.comp's value.
 *
 * Smooth surfaces use a separate mean per pixel (MASU_FINE, specular_fine.comp) if one exists.
 * Surfaces that mirror more than they scatter get the velocity of the reflection, for rung.temporal
 * (MASU_RESOLVED).
 *
 * push.cutoff: roughness from which nothing is traced. push.accumulate: 1: uses the mean of the
 * reference instead, which is already weighted. push.fine: not 0: there is full-resolution history.
 * push.resolved: not 0: the rung has temporal upscaling.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_composite.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/environment.glsl"
#include "light/sky.glsl"
#include "light/ambient.glsl"
#include "light/air.glsl"
#ifdef MASU_RESOLVED
#include "shared/motion.glsl"
#include "specular/filter.glsl"
#endif
#include "brdf/bsdf.glsl"
#include "specular/fine.glsl"
#include "specular/guide.glsl"
#include "specular/surface.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(constant_id = 2) const bool foggy = false; /* the scene has fog */

layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE + 1) uniform sampler2D specular_image;
#ifdef MASU_FINE
layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE + 2) uniform usampler2D fine_image;
#define MASU_AFTER_FINE (MASU_AFTER_SURFACE + 3)
#else
#define MASU_AFTER_FINE (MASU_AFTER_SURFACE + 2)
#endif
#ifdef MASU_RESOLVED
layout(set = MASU_SET_PASS, binding = MASU_AFTER_FINE) uniform usampler2D age_image;
#define MASU_AT_HDR (MASU_AFTER_FINE + 1)
layout(set = MASU_SET_PASS, binding = MASU_AT_HDR + 1, rgba16f) uniform image2D velocity_image;
#else
#define MASU_AT_HDR MASU_AFTER_FINE
#endif
layout(set = MASU_SET_PASS, binding = MASU_AT_HDR, rgba16f) uniform image2D hdr_image;

/* The texels around a pixel. */
struct gathering {
    ivec2 corner, last; /* upper left texel; last of the image */
    vec2 part;          /* of a texel, from the corner's centre */
    masu_flat plane;    /* of the pixel */
    vec3 n;
    float narrow;       /* 1 / tolerance of distances from the plane */
    vec4 sum, nearest;  /* weighted; of the texel with the lowest cost */
    float least, most;  /* that cost; brightest channel of texels with a relevant weight */
};

/* Adds one of the four texels. A function that is called four times, not a loop: the cost model
 * counts an unrolled loop of this size as if each iteration ran all copies
 * (lab/model/spirv_reach.c). */
void gather(inout gathering s, ivec2 off)
{
    ivec2 texel = clamp(s.corner + off, ivec2(0), s.last);
    masu_guide g = masu_unpack_guide(texelFetch(guide_image, texel, 0).rg);
    if (!g.there) {
        return;
    }
    vec3 color = masu_sane(texelFetch(specular_image, texel, 0).rgb, 0.0, 65504.0);
    float away = abs(masu_off(s.plane, masu_guide_place(uvec2(texel), g.pixel, 2u), g.depth)) *
                 s.narrow;
    float alike = max(dot(g.normal, s.n), 0.0);
    alike *= alike;
    alike *= alike;
    float bilinear = mix(1.0 - s.part.x, s.part.x, float(off.x)) *
                     mix(1.0 - s.part.y, s.part.y, float(off.y));
    float weight = (bilinear + 1e-3) * alike * masu_exp2(-away * away);
    float cost = away + 4.0 * (1.0 - alike);
    s.sum += weight * vec4(color, 1.0);
    s.most = max(s.most, weight > 1e-4 ? max(color.r, max(color.g, color.b)) : 0.0);
    if (cost < s.least) {
        s.least = cost;
        s.nearest = vec4(color, 1.0);
    }
}

/* Radiance that a pixel's lobe gathers; a: 0 if no texel is usable. most: brightest channel of
 * texels with a relevant weight. */
vec4 gathered(uvec2 at, vec3 point, vec3 n, float depth, out float most)
{
    vec2 place = (vec2(at) - 0.5) * 0.5; /* a texel and its four pixels share a centre */
    vec2 corner = floor(place);
    float z = frame.forward.w * masu_rcp(depth);
    /* A texel is two pixels wide: a point that is off the plane by half of that is another
     * surface. */
    float tolerance = z * frame.up.w * 2.0 / float(pc.render_height);
    gathering s = gathering(ivec2(corner), ivec2(pc.output_width, pc.output_height) - 1,
                            place - corner, masu_flat_through(point, n), n, 1.0 / tolerance,
                            vec4(0.0), vec4(0.0), 1e30, 0.0);
    gather(s, ivec2(0, 0));
    gather(s, ivec2(1, 0));
    gather(s, ivec2(0, 1));
    gather(s, ivec2(1, 1));
    most = s.most;
    return s.sum.a > 1e-3 ? vec4(s.sum.rgb / s.sum.a, 1.0) : s.nearest;
}

#ifdef MASU_RESOLVED
const float apart = 0.1;  /* share of the closer depth: a silhouette, see temporal_find.comp */
const float least = 0.03; /* pixels: more than the motion of stationary pixels */

/* Whether a pixel is at the outline of its surface. The outline moves with its surface. */
bool ends(ivec2 at, float depth)
{
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    vec4 beside = vec4(texelFetch(depth_image, ivec2(min(at.x + 1, last.x), at.y), 0).r,
                       texelFetch(depth_image, ivec2(max(at.x - 1, 0), at.y), 0).r,
                       texelFetch(depth_image, ivec2(at.x, min(at.y + 1, last.y)), 0).r,
                       texelFetch(depth_image, ivec2(at.x, max(at.y - 1, 0)), 0).r);
    return any(greaterThan(abs(beside - depth), apart * max(beside, vec4(depth))));
}

/* Replaces a pixel's velocity by that of its reflection: temporal.comp then reprojects to the
 * position where the reflection was visible in the surface. The depth is the depth of the
 * surface's plane there. If the reflection is stationary on screen and the surface is not, as with
 * the sky, the velocity is set to `least`: a velocity of 0 would disable the clamp to current
 * colours. */
void follow(uvec2 at, uvec2 texel, float depth, vec3 n)
{
    uint age = texelFetch(age_image, ivec2(texel), 0).g;
    vec4 moved = imageLoad(velocity_image, ivec2(at));
    if (age == masu_unmoved || !(moved.w > 0.0) || ends(ivec2(at), depth)) {
        return;
    }
    vec2 size = vec2(pc.render_width, pc.render_height);
    vec2 jitter = masu_unjittered(vec2(0.0), size);
    vec2 image = unpackHalf2x16(age);
    vec2 surface = moved.xy + jitter;
    image.x = length(image) < least && length(surface) > least ? least : image.x;
    vec2 was = (vec2(at) + 0.5 + moved.xy) / size * 2.0 - 1.0 + previous.jitter.xy;
    vec2 seen = was + (image - surface) / size * 2.0;
    vec3 lean = vec3(dot(n, previous.right.xyz), -dot(n, previous.up.xyz),
                     dot(n, previous.forward.xyz));
    float farther = dot(lean, vec3(was, 1.0)) * masu_rcp(dot(lean, vec3(seen, 1.0)));
    if (farther > 0.25 && farther < 4.0) { /* not beyond the horizon */
        MASU_STORE_HALF(velocity_image, at,
                        vec4(image - jitter, (1.0 + moved.z) * farther - 1.0, 1.0));
    }
}
#endif

void pixel(uvec2 at, uvec2 texel, uint number)
{
    masu_pixel p = masu_pixel_at(at);
    float roughness = masu_traced_roughness(p.surface);
    if (!(p.depth > 0.0) || !masu_is_traced(p.surface, push.cutoff, push.accumulate != 0u)) {
        return;
    }
    vec4 lit = imageLoad(hdr_image, ivec2(at));
    vec3 point = masu_guide_point(at, p.depth);
    vec3 mirrored;
    if (push.accumulate != 0u) {
        vec4 sum = texelFetch(specular_image, ivec2(texel), 0);
        mirrored = sum.rgb / max(sum.a, 1.0);
    } else {
        vec3 n = masu_unpack_normal(p.normal);
        vec3 v = -masu_normalize(point, frame.forward.xyz);
        masu_bsdf b = masu_bsdf_make(p.surface, n, v);
        vec3 mirrors = p.surface.coat > 0.0 ? vec3(masu_bsdf_coat(b)) : masu_bsdf_specular(b);
        /* Smooth surfaces, and texels with several surfaces, use only the pixel's own mean. */
        vec3 own = vec3(0.0);
        float fine = 0.0;
        bool limited = false;
        bool whole = false; /* the four pixels are one surface */
#ifdef MASU_FINE
        uint word = push.fine != 0u ? texelFetch(fine_image, ivec2(texel), 0)[number]
                                    : masu_fine_none;
        if (word != masu_fine_none) {
            masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
            own = masu_unpack_fine(word);
            fine = masu_fine_share(g, roughness);
            limited = roughness > masu_fine_narrow && !g.mixed;
            whole = !g.mixed;
        }
#endif
        vec3 light = own;
        if (!(fine >= 1.0) || limited) {
            float most;
            vec4 around = gathered(at, point, n, p.depth, most);
            if (!(around.a > 0.0)) {
                around.rgb = masu_ambient_mirror(reflect(-v, n), roughness);
            }
            /* A pixel more than twice as bright as the means of the texels is noise of few rays.
             * Narrow lobes have little noise. */
            float bright = max(own.r, max(own.g, own.b));
            float limit = limited && most > 0.0 ? 2.0 * most + 0.01 : bright;
            light = mix(around.rgb, own * min(1.0, limit / max(bright, 1e-9)), fine);
        }
        mirrored = masu_traced_share(roughness, push.cutoff) * mirrors * light;
#ifdef MASU_RESOLVED
        /* Depends on the surface, not on the reflection: dark parts of a mirrored column move like
         * the bright ones. */
        vec3 scattered = p.surface.albedo * (1.0 - p.surface.metallic);
        scattered += p.surface.coat > 0.0 ? b.f0 : vec3(0.0);
        if (push.resolved != 0u && whole && fine > 0.5 && !masu_has_emission(p.normal) &&
            masu_luma(mirrors) > masu_luma(scattered)) {
            follow(at, texel, p.depth, n);
        }
#endif
    }
    if (foggy) { /* light.comp has added the fog's own light */
        vec3 direction = masu_normalize(point, frame.forward.xyz);
        mirrored *= masu_fog_left(masu_air_depth(direction, length(point)));
    }
    lit.rgb += mirrored;
    MASU_STORE_HALF(hdr_image, at, lit);
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    for (uint k = 0u; k < 4u; k++) {
        if (k >= push.traced_size * push.traced_size) {
            break;
        }
        uvec2 at = masu_guide_place(texel, k, push.traced_size);
        if (all(lessThan(at, size))) {
            pixel(at, texel, k);
        }
    }
    masu_count_end();
}
