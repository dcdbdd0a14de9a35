/* area_lights.comp: runs masu_add_local_light (shaders/light/lights.glsl) for
 * tests/gpu/test_area_lights.c: a point at the origin with normal +z; each case has a surface, a
 * view and the number of its light. */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_AREA_LIGHTS
#define MASU_LIGHTS_APART
#define MASU_SURFACE
#include "brdf/bsdf.glsl"

/* The declarations of a frame and of light/shade.glsl that lights.glsl needs. */
#define MASU_SHADE_GLSL
const bool masu_few_registers = false;
struct test_frame {
    vec4 forward;
};
const test_frame frame = test_frame(vec4(0.0, 0.0, 0.0, 1.0));

struct masu_lit {
    vec3 diffuse;
    vec3 specular;
};

void masu_add_light(inout masu_lit lit, masu_surface s, masu_bsdf b, vec3 l, vec3 color)
{
    vec3 specular, diffuse;
    masu_bsdf_parts(b, l, specular, diffuse);
    lit.specular += color * specular;
    lit.diffuse += color * diffuse;
}

float masu_meso_shadow(float shadow, vec3 view, vec3 light)
{
    return 1.0;
}

#include "light/lights.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push
{
    uvec4 pc; /* x number of cases */
};

struct test_case {
    vec4 surface; /* roughness, metallic, coat, coat_roughness */
    vec4 view;    /* w: number of the light */
    vec4 point;   /* w: albedo */
};

layout(set = 0, binding = 0, std430) readonly buffer Cases
{
    test_case cases[];
};

layout(set = 0, binding = 1, std430) writeonly buffer Results
{
    vec4 results[]; /* x diffuse, y specular, for one channel */
};

void main()
{
    uint at = gl_GlobalInvocationID.x;
    if (at >= pc.x) {
        return;
    }
    test_case c = cases[at];
    masu_surface s = masu_plain_surface(vec3(c.point.w), c.surface.x);
    s.metallic = c.surface.y;
    s.specular = 0.0;
    s.coat = c.surface.z;
    s.coat_roughness = c.surface.w;
    masu_bsdf b = masu_bsdf_make(s, vec3(0.0, 0.0, 1.0), c.view.xyz);
    masu_light_sum sum = masu_light_sum(vec3(0.0), vec3(0.0));
    bool reached = masu_add_local_light(sum, s, b, uint(c.view.w), c.point.xyz, vec3(0.0, 0.0, 1.0), vec3(0.0));
    results[at] = vec4(sum.light.x, sum.mirrored.x, reached ? 1.0 : 0.0, 0.0);
}
