/*
 * light.comp: one path for polygons and SDF hits: sun, constant ambient, sky where there is
 * nothing. Compiled twice: with MASU_OCCLUSION it is light_occluded, in which the sun and what comes
 * from everywhere arrive as far as sdf_occlusion.comp says.
 *
 *   radiance = sun * (diffuse + specular) * N.L + ambient
 *   specular: GGX with height-correlated Smith visibility (Heitz, JCGT 3-2, 2014) and Schlick's
 *   Fresnel ambient:  constant radiance on the diffuse part; on the specular part the sky in the
 *   mirror direction, which
 *             fades into the constant with roughness
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D albedo_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D depth_image;
#ifdef MASU_OCCLUSION
layout(set = MASU_SET_PASS, binding = 3) uniform usampler2D occlusion_image;
layout(set = MASU_SET_PASS, binding = 4, rgba16f) uniform writeonly image2D hdr_image;
#else
layout(set = MASU_SET_PASS, binding = 3, rgba16f) uniform writeonly image2D hdr_image;
#endif

/* How much arrives of the sun and of the ambient light. */
vec2 arriving(uvec2 at)
{
#ifdef MASU_OCCLUSION
    return unpackUnorm2x16(texelFetch(occlusion_image, ivec2(at), 0).r);
#else
    return vec2(1.0);
#endif
}

/* The sky: zenith to horizon over the sine of elevation, the horizon's colour below it. */
vec3 sky(vec3 direction)
{
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(frame.sky_horizon.rgb, frame.sky_zenith.rgb, sqrt(height));
}

/* A disc of the sun's size (radius 0.27 degrees) would be two pixels wide and bright enough to
 * swamp the tone curve; a soft glow around it says where the light comes from. */
vec3 sun_glow(vec3 direction)
{
    float towards = clamp(dot(direction, frame.sun_direction.xyz), 0.0, 1.0);
    return frame.sun_color.rgb * (0.25 * masu_pow(towards, 350.0) + 0.05 * masu_pow(towards, 12.0));
}

/* D * G2 / (4 NoL NoV), times pi because the sun's colour is irradiance / pi. The sine form of D
 * keeps its precision for smooth surfaces, where 1 - NoH^2 cancels (Filament, section 4.4.1). */
float specular_lobe(vec3 n, vec3 h, float alpha, float n_l, float n_v)
{
    float n_h = clamp(dot(n, h), 0.0, 1.0);
    vec3 sine = cross(n, h);
    float a = n_h * alpha;
    float k = alpha / (dot(sine, sine) + a * a);
    float a2 = alpha * alpha;
    float g = n_l * sqrt(a2 + (1.0 - a2) * n_v * n_v) + n_v * sqrt(a2 + (1.0 - a2) * n_l * n_l);
    return min(k * k * 0.5 / max(g, 1e-5), 65504.0);
}

vec3 fresnel(vec3 f0, float cosine)
{
    float f = clamp(1.0 - cosine, 0.0, 1.0);
    float f2 = f * f;
    return f0 + (1.0 - f0) * (f2 * f2 * f);
}

vec3 shade(vec3 albedo, float roughness, float metallic, vec3 n, vec3 v, vec2 seen)
{
    vec3 l = frame.sun_direction.xyz;
    vec3 f0 = mix(vec3(0.04), albedo, metallic);
    vec3 diffuse = albedo * (1.0 - metallic);
    float n_v = max(dot(n, v), 1e-4);
    float n_l = dot(n, l);
    /* Below 0.045 the square of alpha leaves what half floats can hold (Filament, section 4.4). */
    float alpha = max(roughness, 0.045);
    alpha *= alpha;
    vec3 lit = vec3(0.0);
    if (n_l > 0.0) {
        vec3 h = masu_normalize(l + v, n);
        vec3 f = fresnel(f0, clamp(dot(v, h), 0.0, 1.0));
        vec3 brdf = diffuse * (1.0 - f) + f * specular_lobe(n, h, alpha, n_l, n_v);
        lit = frame.sun_color.rgb * n_l * brdf * seen.x;
    }
    vec3 grazing = max(vec3(1.0 - roughness), f0);
    float edge = 1.0 - n_v;
    vec3 mirror = f0 + (grazing - f0) * (edge * edge * edge * edge * edge);
    vec3 reflected = mix(sky(reflect(-v, n)), frame.ambient.rgb, roughness);
    return lit + (frame.ambient.rgb * diffuse + mirror * reflected) * seen.y;
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        vec3 ray = masu_pixel_ray(at, uvec2(pc.output_width, pc.output_height));
        vec3 direction = masu_normalize(ray, frame.forward.xyz);
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        vec3 color;
        if (!(depth > 0.0)) {
            color = sky(direction) + sun_glow(direction);
        } else {
            vec4 albedo = texelFetch(albedo_image, ivec2(at), 0);
            uint normal = texelFetch(normal_image, ivec2(at), 0).r;
            vec3 linear = albedo.rgb * albedo.rgb;
            if ((masu_unpack_flags(normal) & MASU_SURFACE_EMISSIVE) != 0u) {
                color = linear * masu_emissive_range;
            } else {
                color = shade(linear, albedo.a, masu_unpack_metallic(normal),
                              masu_unpack_normal(normal), -direction, arriving(at));
            }
        }
        MASU_STORE_HALF(hdr_image, at, vec4(color, 1.0));
    }
    masu_count_end();
}
