/*
 * focus.glsl: circles of confusion of a thin lens. A lens of diameter A whose sharp plane is at
 * view z f shows a point at z as a disc of diameter A |1 - f / z| on that plane, which is
 * 2 f tan(fov_y / 2) high: the radius is linear in the stored depth, near / z. Below 0 in front
 * of the sharp plane.
 */
#ifndef MASU_FOCUS_GLSL
#define MASU_FOCUS_GLSL

#include "shared/push.glsl"
#include "post/post.glsl"

/* Most pixels of a radius: focus_gather.comp searches so far. */
const float masu_focus_reach = 128.0;

/* Signed radius, render pixels. */
float masu_focus_radius(float depth)
{
    float most = min(float(MASU_FOCUS_MOST) * float(pc.render_height), masu_focus_reach);
    float height = float(pc.render_height);
    return masu_sane((post.lens.y - post.lens.z * masu_sane(depth, 0.0, 1.0)) * height, -most,
                     most);
}

/* Halving and magnifying the image blurs it with a variance of 1 pixel^2 per axis, a disc of radius
 * r with r^2 / 4. From a radius of 2 pixels on, the gathered disc is smaller by as much. Below, the
 * disc is one texel, and its layer is mixed with the sharp image so that the variances agree, from
 * half a pixel on. */
float masu_focus_disc(float radius)
{
    return masu_sqrt(radius * radius - 4.0);
}

float masu_focus_share(float radius)
{
    return clamp((radius * radius - 0.25) / 3.75, 0.0, 1.0);
}

#endif
