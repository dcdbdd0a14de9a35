/*
 * occlusion.glsl: shadow and ambient occlusion of the SDF at a point: sun_seen() and
 * ambient_seen().
 *
 * SHADOW. One ray towards the centre of the sun, which is a disc of tangent w. At a sample of field
 * f at distance t, f / (w t) is the distance of the nearest surface from the ray in radii of the
 * disc: from 1 on the disc is fully visible, at -1 and below (the ray is that deep inside a solid)
 * fully covered, and both are proofs, not estimates. In between the least ratio of the ray is taken
 * as the distance of a straight edge from the centre of the disc. Between two samples the closest
 * approach is estimated from the edge that fits both (Aaltonen, "GPU-based clay simulation and
 * ray-tracing tech in Claybook", GDC 2018). Rejected: stopping at the first hit. In half of a
 * penumbra the centre of the sun is occluded; it was dark there, and every shadow grew by half a
 * penumbra.
 *
 * The depth inside a solid is wrong at the seam of two parts: each field is nearly 0 there, and
 * light leaked through as a thin line. So if a ray is blocked but never deep enough, three more
 * rays test a third of the disc each, and the smaller visibility is used.
 *
 * No step is longer than the field allows, with two exceptions: a least step of a twentieth of a
 * pixel (a sixth of that left 989 rays of the tunnel at 160x90 without an end after 128 steps, this
 * leaves 7) and, inside a solid, of a quarter of the disc.
 *
 * AMBIENT OCCLUSION. Over a plane the field is h cos(a) at distance h under the angle a to the
 * normal; the shortfall is occlusion. Five samples: two on the normal, three at 45 degrees around
 * it. Their weights are a least-squares fit to the reference (cosine-weighted, a hit at distance t
 * occludes 1 - t / radius) over four scenes; docs/design/06-ambient-occlusion.md has the errors,
 * also for the usual five samples on the normal.
 *
 * The includer defines MASU_SHADOWS and MASU_AMBIENT_OCCLUSION, and their constants. Positions are
 * relative to the camera, as everywhere.
 */
#ifndef MASU_OCCLUSION_GLSL
#define MASU_OCCLUSION_GLSL

#include "shared/counters.h"
#include "shared/sdf_limits.h"

/* A surface point. */
struct lit_point {
    vec3 place;   /* relative to the camera */
    vec3 normal;
    float extent; /* largest coordinate involved: determines the fp32 rounding */
    float offset; /* distance between the surface and the start of rays */
};

/* The offset is a tenth of a pixel; contact shadows move by as much. Sharper shadows than at a
 * quarter of a pixel (blobs, sun of 0.27 degrees: root mean square error 0.015, not 0.039) and no
 * acne, since a ray that leaves its surface does not treat that surface as an occluder. Not below
 * 32 ulp: the rounding of the field is up to 6, and the march stops at 8. */
lit_point lit_point_at(vec3 place, vec3 normal, float pixel)
{
    lit_point p;
    p.place = place;
    p.normal = normal;
    vec3 a = abs(frame.sdf_eye_hi.xyz + place);
    float t = length(place);
    p.extent = max(max(a.x, max(a.y, a.z)), t);
    p.offset = max(0.1 * pixel * t, 32.0 * ulp * p.extent);
    return p;
}

float field_at(vec3 place, out bool usable)
{
    float f = masu_sdf(frame.sdf_eye_hi.xyz + (frame.sdf_eye_lo.xyz + place)) * frame.sdf_min.w;
    usable = masu_finite(f);
    return usable ? f : 0.0;
}

#if MASU_SHADOWS

/* The interval of a ray from `place` inside the bounds of the SDF: outside nothing is drawn or
 * casts a shadow. */
vec2 span_in_bounds(vec3 place, vec3 direction)
{
    vec3 d = mix(direction, vec3(1e-12), lessThan(abs(direction), vec3(1e-12)));
    vec3 from = frame.sdf_eye_hi.xyz + (frame.sdf_eye_lo.xyz + place);
    vec3 a = clamp((frame.sdf_min.xyz - from) / d, vec3(-masu_huge), vec3(masu_huge));
    vec3 b = clamp((frame.sdf_max.xyz - from) / d, vec3(-masu_huge), vec3(masu_huge));
    vec3 enter = min(a, b);
    vec3 leave = max(a, b);
    return vec2(max(max(enter.x, max(enter.y, enter.z)), 0.0),
                min(min(leave.x, min(leave.y, leave.z)), MASU_SHADOW_DISTANCE));
}

/* Tangent of the angular radius of the sun; 0 would make every ratio infinite. */
const float sun_tangent = max(MASU_SUN_TANGENT, 1e-5);

/* The fraction of a unit disc on one side of a straight line at distance s from its centre. */
float disc_beyond(float s)
{
    float c = masu_sane(s, -1.0, 1.0);
    return clamp(1.0 + (c * masu_sqrt(1.0 - c * c) - masu_acos(c)) * 0.31830989, 0.0, 1.0);
}

/* The least ratio of a ray to a disc of that tangent. */
float least_ratio(lit_point p, vec3 towards, float tangent, inout uint evals)
{
    vec3 start = p.place + p.normal * p.offset;
    vec2 span = span_in_bounds(start, towards);
    float t = span.x;
    float before_t = t;
    float before_f = 0.0; /* of the previous sample; 0: none */
    bool fell = false;
    bool done = !(span.x < span.y);
    /* The surface itself covers the part of the disc below its horizon. */
    float least = min(dot(p.normal, towards) / tangent, 1.0);
    MASU_LOOP for (int i = 0; i < MASU_SHADOW_STEPS_MAX; i++) {
        if (done || uint(i) >= push.steps) {
            break;
        }
        bool usable;
        float f = field_at(start + towards * t, usable);
        evals++;
        /* Near the start the closest surface is still the one that the ray leaves; in a crease the
         * offset may even pass through the other side. */
        bool close = t < 2.0 * p.offset;
        if (usable && t > 0.0 && !(close && f < p.offset)) {
            least = min(least, f / (tangent * t));
        }
        bool falls = f < before_f;
        if (usable && f > 0.0 && before_f > 0.0 && (falls || fell)) {
            float reach = t - before_t;
            float nearest = before_t + 0.5 * (reach + (before_f - f) * (before_f + f) / reach);
            float off = before_f * before_f - (nearest - before_t) * (nearest - before_t);
            if (nearest > before_t && nearest < t && off > 0.0) {
                least = min(least, sqrt(off) / (tangent * nearest));
            }
        }
        fell = falls;
        before_f = f;
        before_t = t;
        float shortest = max(0.5 * p.offset, 4.0 * ulp * t);
        shortest = f < 0.0 ? max(shortest, 0.25 * tangent * t) : shortest;
        t += max(abs(f), shortest);
        done = !usable || least <= -1.0 || !(t < span.y);
    }
    if (!done) {
        masu_count(MASU_COUNTER_SHADOW_UNCONVERGED, 1u); /* the least ratio so far is used */
    }
    return least;
}

/* The visible share of the sun: one ray; three more, each for a third of the disc, if it is blocked
 * without proof. */
float sun_seen(lit_point p, out uint evals)
{
    vec3 sun = frame.sun_direction.xyz;
    float s = sun.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (s + sun.z);
    vec3 u = vec3(1.0 + s * sun.x * sun.x * a, s * sun.x * sun.y * a, -s * sun.x);
    vec3 v = vec3(sun.x * sun.y * a, s + sun.y * sun.y * a, -sun.y);
    float whole = 1.0;
    float thirds = 0.0;
    evals = 0u;
    MASU_LOOP for (int i = 0; i < 4; i++) {
        if (i == 1 && !(whole > -1.0 && whole < 0.0)) {
            break;
        }
        /* sqrt((k + 1/2) / 3) from the centre, 137.5 degrees apart */
        vec2 around = i == 1 ? vec2(0.408248, 0.0)
                             : i == 2 ? vec2(-0.521393, 0.477641) : vec2(0.079800, -0.909299);
        around = i == 0 ? vec2(0.0) : around * sun_tangent;
        vec3 towards = masu_normalize(sun + u * around.x + v * around.y, sun);
        float ratio =
            least_ratio(p, towards, i == 0 ? sun_tangent : 0.57735 * sun_tangent, evals);
        whole = i == 0 ? ratio : whole;
        thirds += i == 0 ? 0.0 : disc_beyond(ratio) / 3.0;
    }
    return whole > -1.0 && whole < 0.0 ? min(disc_beyond(whole), thirds) : disc_beyond(whole);
}

#endif
#if MASU_AMBIENT_OCCLUSION

float ambient_seen(lit_point p, out uint evals)
{
    /* Orthonormal basis without a branch that would show as a seam (Duff et al., JCGT 6-1,
     * 2017). */
    vec3 n = p.normal;
    float s = n.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    vec3 u = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
    vec3 v = vec3(b, s + n.y * n.y * a, -n.y);
    /* Closer than this the field is mostly the error of the march: some 0.01 pixels, and 8 ulp. */
    float least = max(p.offset, 64.0 * ulp * p.extent);
    float lacks = 0.0;
    evals = 0u;
    MASU_LOOP for (int i = 0; i < 5; i++) {
        bool tilted = i >= 2;
        float high = (i == 0 ? 0.0625 : i == 1 ? 0.25 : 0.5) * MASU_AO_RADIUS;
        float h = max(high, least);
        float weight = i == 0 ? 0.161 : i == 1 ? 0.210 : 0.078;
        vec2 around = i == 2 ? vec2(1.0, 0.0) : vec2(-0.5, i == 3 ? 0.8660254 : -0.8660254);
        vec3 direction = tilted ? (n + u * around.x + v * around.y) * 0.70710678 : n;
        bool usable;
        float f = field_at(p.place + direction * h, usable);
        evals++;
        /* Above 1 inside a solid: a corner that deep occludes more than the directions of the
         * samples. */
        float lack = clamp(1.0 - f / (tilted ? 0.70710678 * h : h), 0.0, 3.0);
        lacks += usable ? weight * lack : 0.0;
    }
    /* Fades out when the radius shrinks below the resolution of the image. */
    float fade = clamp(MASU_AO_RADIUS / (2.0 * least) - 1.0, 0.0, 1.0);
    return 1.0 - MASU_AO_STRENGTH * fade * min(lacks, 1.0);
}

#endif
#endif
