/*
 * air.glsl: the fog of the frame: its transmission and its own light (masu_through_air). The fog
 * colour is the scene's, or the colour of the sky at the horizon below the ray plus the wide part
 * of the glow around the sun: the sky fades into fog without an edge.
 */
#ifndef MASU_AIR_GLSL
#define MASU_AIR_GLSL

#include "light/fog.glsl"
#include "light/shade.glsl"

vec3 masu_air_glow(vec3 direction)
{
    float towards = clamp(dot(direction, frame.sun_direction.xyz), 0.0, 1.0);
    return frame.sun_color.rgb * (0.05 * masu_pow(towards, 12.0));
}

vec3 masu_air_color(vec3 direction)
{
    if (frame.air.w != 0.0) {
        return frame.fog.rgb;
    }
    if (masu_sky_is_analytic()) { /* the analytic sky includes its glow */
        return masu_sky_horizon(direction);
    }
    return masu_sky(vec3(direction.x, 0.0, direction.z)) + masu_air_glow(direction);
}

float masu_air_depth(vec3 direction, float far)
{
    return masu_fog_depth(frame.fog.w, frame.air.y, frame.air.x, direction.y, frame.air.z, far);
}

float masu_air_depth_sky(vec3 direction)
{
    return masu_fog_depth_sky(frame.fog.w, frame.air.y, frame.air.x, direction.y, frame.air.z);
}

/* masu_air_depth() along a ray that begins at a point relative to the camera; far below 0: a ray to
 * the sky. */
float masu_air_depth_from(vec3 point, vec3 direction, float far)
{
    float start = max(frame.air.z - masu_sqrt(dot(point, point)), 0.0);
    float height = frame.air.x + point.y;
    if (far < 0.0) {
        return masu_fog_depth_sky(frame.fog.w, frame.air.y, height, direction.y, start);
    }
    return masu_fog_depth(frame.fog.w, frame.air.y, height, direction.y, start, far);
}

/* Fogs light that passes through a layer of coverage `alpha` (1: opaque). */
vec3 masu_through_air(vec3 color, vec3 direction, float depth, float alpha)
{
    float left = masu_fog_left(depth);
    return color * left + masu_air_color(direction) * ((1.0 - left) * alpha);
}

/* Radiance along a ray. color: of the hit surface, or of the sun's disc; open: no hit, so the sky
 * is added; background: of the frame, or (0, 0, 0, 1): radiance added to the sky, and a factor on
 * it; depth: optical depth of the air, if there is fog. */
vec3 masu_seen_along(vec3 color, bool open, vec4 background, vec3 direction, bool fog, float depth)
{
    if (open) {
        color += masu_sky(direction);
        if (masu_live_environment) {
            color = color * background.w + background.rgb;
        }
    }
    /* A constant of the scene: only one of the two paths is compiled. */
    return fog ? masu_through_air(color, direction, depth, 1.0) : color;
}

#endif
