/*
 * ray.glsl: the rays of live probes (shared/bounce.h), and their 32 bytes in a buffer:
 *
 *   between tracing and shading   the hit in the format of reflections (specular/ray.glsl); the
 *                                 other half is unused
 *   from shading on   xyz hit point in world space minus the anchor of the traced scene, w distance
 *                     to the sampled light, below 0 if unlit; then as half floats the radiance
 *                     without that light, and its addition; then the direction towards it,
 * octahedral
 *
 * The directions of all sets of a probe are a spherical Fibonacci lattice (Swinbank and Purser
 * 2006), rotated by a hash of the probe: so a static scene gives the same bits again, and errors of
 * neighbours are uncorrelated. A lattice at half the distance is four copies of itself, shifted by
 * halves of its two steps: each set is a sixteenth of the lattice and evenly distributed, and so
 * are the first four together.
 */
#ifndef MASU_BOUNCE_RAY_GLSL
#define MASU_BOUNCE_RAY_GLSL

#include "shared/bounce.h"
#include "shared/guard.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_BOUNCE, std430) readonly buffer Bounce
{
    masu_bounce_header masu_bounce;
    uint masu_bounce_list[];
};
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_BOUNCE_RAYS, std430) buffer BounceRays
{
    uvec4 masu_bounce_rays[];
};

struct masu_bounce_ray {
    uint probe, set, number; /* of its set */
};

uint masu_bounce_each() { return clamp(masu_bounce.probes.w, 1u, MASU_BOUNCE_RAYS_MAX); }

masu_bounce_ray masu_bounce_ray_at(uint i)
{
    uint each = masu_bounce_each();
    uint word = masu_bounce_list[i / each];
    return masu_bounce_ray(word & MASU_BOUNCE_PROBE,
                           word >> MASU_BOUNCE_SET_SHIFT & (MASU_BOUNCE_SETS - 1u), i % each);
}

/* pcg3d (Jarzynski and Olano, JCGT 9-3, 2020). */
uvec3 masu_bounce_hash(uvec3 v)
{
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

float masu_bounce_unit(uint hash) { return float(hash >> 8) * (1.0 / 16777216.0); }

/* Direction of a ray, rotated by a uniform random quaternion (Shoemake 1992). The lattice's steps
 * are (1, golden ratio) and (0, 1), in rays and rotations; a set is shifted by quarters of a
 * step. */
vec3 masu_bounce_direction(masu_bounce_ray r)
{
    uvec3 h = masu_bounce_hash(uvec3(r.probe, 0u, 0x6D617375u));
    float a = masu_bounce_unit(h.x), b = 6.28318531 * masu_bounce_unit(h.y),
          c = 6.28318531 * masu_bounce_unit(h.z);
    vec4 q = vec4(masu_sqrt(1.0 - a) * vec2(sin(b), cos(b)), masu_sqrt(a) * vec2(sin(c), cos(c)));
    uint i = (r.set & 1u) * 2u + (r.set >> 2 & 1u), j = (r.set >> 1 & 1u) * 2u + (r.set >> 3 & 1u);
    float at = float(r.number) + 0.25 * float(i);
    float z = 1.0 - (2.0 * at + 0.25) / float(masu_bounce_each());
    float turn = 6.28318531 * fract(at * 0.618033989 + 0.25 * float(j));
    vec3 d = vec3(masu_sqrt(1.0 - z * z) * vec2(cos(turn), sin(turn)), z);
    d += 2.0 * cross(q.xyz, cross(q.xyz, d) + q.w * d);
    return masu_normalize(d, vec3(0.0, 1.0, 0.0));
}

#endif
