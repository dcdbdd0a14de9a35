/* meso.comp: runs shaders/brdf/meso.glsl for tests/gpu/test_meso.c. pc.y: number of cases. */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "brdf/meso.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push
{
    uvec4 pc;
};

struct test_case {
    masu_meso_curves curves;
    vec4 view;
    vec4 light;
    vec4 normal; /* w roughness */
    vec4 color;  /* w occlusion */
};

struct test_result {
    vec4 normal; /* w roughness */
    vec4 color;  /* w occlusion */
    vec4 rest;   /* specular, shadow, shadow of the light */
};

layout(set = 0, binding = 0, std430) readonly buffer Cases
{
    test_case cases[];
};

layout(set = 0, binding = 1, std430) writeonly buffer Results
{
    test_result results[];
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= pc.y) {
        return;
    }
    test_case c = cases[i];
    masu_meso_surface s =
        masu_meso_surface(c.normal.xyz, c.color.rgb, c.normal.w, c.color.w, 1.0, 1.0);
    masu_meso_bend(c.curves, c.view.xyz, c.view.y, s);
    s.normal = masu_normalize(s.normal, vec3(0.0, 1.0, 0.0));
    s.color = clamp(s.color, 0.0, 1.0);
    results[i].normal = vec4(s.normal, s.roughness);
    results[i].color = vec4(s.color, s.occlusion);
    results[i].rest =
        vec4(s.specular, s.shadow, masu_meso_shadow(s.shadow, c.view.xyz, c.light.xyz), 0.0);
}
