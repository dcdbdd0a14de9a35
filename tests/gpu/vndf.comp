/* vndf.comp: runs shaders/brdf/vndf.glsl and shaders/noise/sequence.glsl for tests/gpu/test_vndf.c.
 *
 *   pc.y  number of cases */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "brdf/vndf.glsl"
#include "noise/sequence.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push
{
    uvec4 pc;
};

struct test_case {
    vec4 view;   /* w roughness, by masu_alpha; above 1: roughness - 1 is alpha itself */
    vec4 u;      /* zw: x and y of l, for separate density and weight */
    vec4 normal; /* w: z of l */
    uvec4 noise; /* 32-bit value, frame, x of masu_hash */
};

struct test_result {
    vec4 l;      /* w weight */
    vec4 apart;  /* density, density and weight of the other l, alpha */
    vec4 around; /* l through the frame of the normal; the frame's t.b */
    vec4 noise;  /* the two numbers, bits of the hash */
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
    uint at = gl_GlobalInvocationID.x;
    if (at >= pc.y) {
        return;
    }
    test_case c = cases[at];
    float alpha = c.view.w > 1.0 ? c.view.w - 1.0 : masu_alpha(c.view.w);
    vec3 other = vec3(c.u.zw, c.normal.w);
    masu_vndf_ray r = masu_vndf_reflect(c.view.xyz, alpha, c.u.xy);
    masu_axes f = masu_axes_of(c.normal.xyz);
    results[at].l = vec4(r.l, r.weight);
    results[at].apart = vec4(r.pdf, masu_vndf_pdf(c.view.xyz, other, alpha),
                             masu_vndf_weight(c.view.xyz, other, alpha), alpha);
    results[at].around = vec4(masu_axes_out(f, r.l), dot(f.t, f.b));
    results[at].noise = vec4(masu_noise2(c.noise.x, c.noise.y),
                             uintBitsToFloat(masu_hash(c.noise.z) >> 9 | 0x3F800000u), 0.0);
}
