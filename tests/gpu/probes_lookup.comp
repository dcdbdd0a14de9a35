/* probes_lookup.comp: shaders/light/probes.glsl at given points, for test_probes.c. */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "light/probes.glsl"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_INSTANCES, std430) buffer Points
{
    vec4 points[]; /* position and number of points, normal; the result replaces the second */
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(points[0].w)) {
        vec3 from = points[2u * i].xyz - probe_grid.origin.xyz;
        points[2u * i + 1u] = masu_probe_light(from, masu_sane(points[2u * i + 1u].xyz, -1.0, 1.0));
    }
}
