/*
 * air.glsl: the fog of the frame: what it leaves of light that comes through it, and what it adds of
 * its own. The colour that thick fog has is the scene's, or that of the sky at the horizon beneath the
 * ray, with the wide part of the glow around the sun: there the sky passes into fog without an edge.
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
    if (masu_sky_is_analytic()) { /* that one has its glow in it */
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

/* The same along a ray that begins at a point relative to the eye; far below 0: it ends in the sky. */
float masu_air_depth_from(vec3 point, vec3 direction, float far)
{
    float start = max(frame.air.z - masu_sqrt(dot(point, point)), 0.0);
    float height = frame.air.x + point.y;
    if (far < 0.0) {
        return masu_fog_depth_sky(frame.fog.w, frame.air.y, height, direction.y, start);
    }
    return masu_fog_depth(frame.fog.w, frame.air.y, height, direction.y, start, far);
}

/* Of a share of light that comes through a layer of coverage `alpha` (1: all of what is seen). */
vec3 masu_through_air(vec3 color, vec3 direction, float depth, float alpha)
{
    float left = masu_fog_left(depth);
    return color * left + masu_air_color(direction) * ((1.0 - left) * alpha);
}

/* What is seen along a ray. color: of what it meets, or of the sun's disc; open: it meets nothing, and the sky
 * comes to that; background: of the frame, or (0, 0, 0, 1): radiance added to the sky, and a factor on it; depth:
 * of the air before it, where there is fog. */
vec3 masu_seen_along(vec3 color, bool open, vec4 background, vec3 direction, bool fog, float depth)
{
    if (open) {
        color += masu_sky(direction);
        if (masu_live_environment) {
            color = color * background.w + background.rgb;
        }
    }
    /* A constant of the scene: of the two ways one is compiled. */
    return fog ? masu_through_air(color, direction, depth, 1.0) : color;
}

#endif
