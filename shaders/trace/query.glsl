/*
 * query.glsl: rays against the triangles of a scene by ray queries of the device
 * (src/device/ray_query.h), instead of bvh.glsl, with equal results. The includer declares
 *   masu_trace_top   the accelerationStructureEXT over the traced instances, each with its mesh's
 *                    first triangle
 * and may define
 *   MASU_TRACE_OPAQUE(triangle, instance, barycentrics, d)
 *                    false: the ray of object-space direction d passes through this point. For
 *                    meshes that are not marked opaque
 *
 * Rays are in world space minus the anchor. A ray that is not finite, has no direction, or begins
 * farther than 1e15 out hits nothing: the specification leaves the first two undefined. A ray with
 * more than MASU_TRACE_VISITS possibly transparent points sets masu_trace_exceeded, and hits
 * nothing.
 */
#ifndef MASU_TRACE_QUERY_GLSL
#define MASU_TRACE_QUERY_GLSL

#include "shared/guard.glsl"
#include "shared/trace.h"

#ifndef MASU_TRACE_OPAQUE
#define MASU_TRACE_OPAQUE(triangle, instance, barycentrics, d) true
#endif

struct masu_ray_hit {
    float t;            /* negative: a miss, and the other members are undefined */
    uint triangle;      /* index into TRACE_TRIANGLES */
    uint instance;      /* index into TRACE_INSTANCES */
    vec2 barycentrics;  /* weights of the second and third vertex */
};

bool masu_trace_exceeded = false;

const float masu_trace_reach = 1e15;

/* The closest triangle at t_min < t < t_max. */
masu_ray_hit masu_trace(vec3 origin, vec3 direction, float t_min, float t_max)
{
    masu_ray_hit best = masu_ray_hit(-1.0, 0u, 0u, vec2(0.0));
    float most = max(abs(direction.x), max(abs(direction.y), abs(direction.z)));
    float distant = max(abs(origin.x), max(abs(origin.y), abs(origin.z)));
    float start = max(masu_finite(t_min) ? t_min : 0.0, 0.0);
    float far = masu_sane(t_max, 0.0, masu_huge);
    bool going = masu_finite(origin) && masu_finite(direction) && distant <= masu_trace_reach &&
                 most >= 1e-6 && most <= 1e6 && start < far;
    if (!going) return best;
    rayQueryEXT query;
    rayQueryInitializeEXT(query, masu_trace_top, gl_RayFlagsNoneEXT, 0xFFu, origin, start,
                          direction, far);
    for (int i = 0; i < MASU_TRACE_VISITS; i++) {
        going = rayQueryProceedEXT(query);
        if (!going) break;
        uint triangle = uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false)) +
                        uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
        uint instance = uint(rayQueryGetIntersectionInstanceIdEXT(query, false));
        vec2 weights = rayQueryGetIntersectionBarycentricsEXT(query, false);
        vec3 d = rayQueryGetIntersectionObjectRayDirectionEXT(query, false);
        if (MASU_TRACE_OPAQUE(triangle, instance, weights, d))
            rayQueryConfirmIntersectionEXT(query);
    }
    if (going) {
        masu_trace_exceeded = true;
        return best;
    }
    if (rayQueryGetIntersectionTypeEXT(query, true) ==
        gl_RayQueryCommittedIntersectionTriangleEXT) {
        best.t = rayQueryGetIntersectionTEXT(query, true);
        best.triangle = uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, true)) +
                        uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true));
        best.instance = uint(rayQueryGetIntersectionInstanceIdEXT(query, true));
        best.barycentrics = rayQueryGetIntersectionBarycentricsEXT(query, true);
    }
    return best;
}

#endif
