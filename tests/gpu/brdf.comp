/* brdf.comp: runs shaders/brdf/bsdf.glsl for tests/gpu/test_brdf.c. The normal is +z unless a case
 * sets another.
 *
 *   pc.x 0: f * N.L * pi of each case; the three factors of ambient light
 *        1: the white furnace: f * N.L over all l
 *        2: as 0, after packing the bsdf to half floats
 *   pc.y    number of cases
 *   pc.z    steps per angle of the furnace */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OWN_COATS
#define MASU_SURFACE
#include "brdf/shelf.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push
{
    uvec4 pc;
};

struct test_case {
    vec4 albedo;  /* w roughness */
    vec4 surface; /* metallic, specular, coat, coat_roughness */
    vec4 normal;
    vec4 view;
    vec4 light;
};

struct test_result {
    vec4 light;    /* or the furnace result */
    vec4 diffuse;
    vec4 specular; /* w for the coat */
};

layout(set = 0, binding = 0, std430) readonly buffer Cases
{
    test_case cases[];
};

layout(set = 0, binding = 1, std430) writeonly buffer Results
{
    test_result results[];
};

const float pi = 3.14159265358979;

/* Density of masu_ggx's visible normals over l (Heitz, JCGT 7-4, 2018): D G1 / (4 N.v). */
float visible_pdf(float alpha, vec3 v, vec3 l)
{
    vec3 h = masu_normalize(v + l, vec3(0.0, 0.0, 1.0));
    float a2 = alpha * alpha;
    float k = alpha / (dot(h.xy, h.xy) + h.z * h.z * a2);
    float g = 2.0 / (v.z + sqrt(a2 + (1.0 - a2) * v.z * v.z)); /* G1 / N.v */
    return k * k / pi * g * 0.25;
}

vec3 visible_direction(float alpha, vec3 v, vec2 u)
{
    vec3 w = normalize(vec3(alpha * v.xy, v.z));
    float radius = sqrt(u.x), angle = pi * (u.y - 0.5);
    vec2 t = radius * vec2(cos(angle), sin(angle));
    float s = 0.5 * (1.0 + w.z);
    t.y = (1.0 - s) * sqrt(max(1.0 - t.x * t.x, 0.0)) + s * t.y;
    vec3 across = vec3(0.0, 1.0, 0.0), along = cross(w, across);
    vec3 h = t.x * across + t.y * along + sqrt(max(1.0 - dot(t, t), 0.0)) * w;
    h = normalize(vec3(alpha * h.xy, max(h.z, 0.0)));
    return 2.0 * dot(v, h) * h - v;
}

/* eval is a sum of the base's lobe, the coat's, and terms that depend only on N.l. By setting the
 * factors of the others to 0, each is integrated over its own directions, on a grid of midpoints:
 * without randomness, and no lobe falls between the points. v is in the plane of x and z, and so
 * are half of the directions. */
vec3 furnace(masu_bsdf b, vec3 v, float coat_alpha, uint steps)
{
    masu_bsdf lobes = b, coat = b;
    lobes.rest = coat.rest = vec3(0.0);
    lobes.diffuse = coat.diffuse = vec3(0.0);
    coat.f0 = vec3(0.0);
    coat.f90 = 0.0;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < steps; i++) {
        vec3 row = vec3(0.0);
        for (uint k = 0u; k < steps; k++) {
            vec2 u = (vec2(i, k) + 0.5) / float(steps);
            /* Normals far out are few, but end abruptly at the horizon of l: smaller steps
             * there. */
            vec2 w = vec2(1.0 - (1.0 - u.x) * (1.0 - u.x), u.y);
            float size = 2.0 * (1.0 - u.x);
            vec3 l = visible_direction(b.alpha, v, w);
            if (l.z > 0.0) {
                vec3 f = masu_bsdf_eval(lobes, l) - masu_bsdf_eval(coat, l);
                row += f * size / (pi * visible_pdf(b.alpha, v, l));
            }
            if (b.coat > 0.0) {
                l = visible_direction(coat_alpha, v, w);
                if (l.z > 0.0) {
                    row += masu_bsdf_eval(coat, l) * size / (pi * visible_pdf(coat_alpha, v, l));
                }
            }
            /* N.l = u^4, because it can change within 0.001 of the horizon. */
            float z = u.x * u.x * u.x * u.x;
            l = vec3(sqrt(1.0 - z * z) * vec2(cos(pi * u.y), sin(pi * u.y)), z);
            vec3 f = masu_bsdf_eval(b, l) - masu_bsdf_eval(lobes, l);
            row += f * 8.0 * u.x * u.x * u.x;
        }
        sum += row;
    }
    return sum / float(steps * steps);
}

void main()
{
    uint at = gl_GlobalInvocationID.x;
    if (at >= pc.y) {
        return;
    }
    test_case c = cases[at];
    masu_surface s = masu_plain_surface(c.albedo.rgb, c.albedo.w);
    s.metallic = c.surface.x;
    s.specular = c.surface.y;
    s.coat = c.surface.z;
    s.coat_roughness = c.surface.w;
    s.lean = vec2(c.normal.w, c.view.w);
    masu_bsdf b = masu_bsdf_make(s, c.normal.xyz, c.view.xyz);
    if (pc.x == 2u) {
        masu_unshelve(masu_shelve(b), b);
    }
    vec3 light = pc.x != 1u ? masu_bsdf_eval(b, c.light.xyz)
                            : furnace(b, c.view.xyz, masu_alpha(c.surface.w), pc.z);
    results[at].light = vec4(light, 0.0);
    results[at].diffuse = vec4(masu_bsdf_diffuse(b), 0.0);
    results[at].specular = vec4(masu_bsdf_specular(b), masu_bsdf_coat(b));
}
