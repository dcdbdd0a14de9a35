/* tone.comp: runs shaders/shared/tone.glsl for tests/gpu/test_tone.c. pc.x: number of cases; pc.y:
 * bits of the float at which the neutral curve ends. */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/tone.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push
{
    uvec4 pc;
};

struct test_result {
    vec4 none;    /* each sRGB-encoded; w the bin of the luminance */
    vec4 filmic;
    vec4 neutral; /* w: its red, linear */
    vec4 pq;      /* of 100 nits a unit; w: red encoded and decoded */
};

layout(set = 0, binding = 0, std430) readonly buffer Cases
{
    vec4 cases[]; /* radiance; w exposure */
};

layout(set = 0, binding = 1, std430) writeonly buffer Results
{
    test_result results[];
};

vec3 encoded(vec3 y)
{
    return vec3(masu_srgb_encode(y.r), masu_srgb_encode(y.g), masu_srgb_encode(y.b));
}

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= pc.x) {
        return;
    }
    vec3 x = masu_exposed(cases[i].rgb, cases[i].w);
    vec3 neutral = masu_tone_neutral(x, uintBitsToFloat(pc.y));
    vec3 pq = vec3(masu_pq_encode(100.0 * x.r), masu_pq_encode(100.0 * x.g),
                   masu_pq_encode(100.0 * x.b));
    results[i].none = vec4(encoded(x), float(masu_luminance_bin(cases[i].rgb)));
    results[i].filmic = vec4(encoded(masu_tone_filmic(x)), 0.0);
    results[i].neutral = vec4(encoded(neutral), neutral.r);
    results[i].pq = vec4(pq, masu_pq_decode(pq.r));
}
