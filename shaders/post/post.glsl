/*
 * post.glsl: the buffer of the effects on the image (shared/post.h), and the filters that they
 * share.
 */
#ifndef MASU_POST_GLSL
#define MASU_POST_GLSL

#include "shared/post.h"
#include "shared/guard.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_POST, std430) readonly buffer Post
{
    masu_post_uniforms post;
    uint lut[];
};

/* Bilinear sample of radiance at a position in texels, whose valid texels are `size` from row `row`
 * on. */
vec3 masu_post_sample(sampler2D image, vec2 at, vec2 size, float row)
{
    vec2 inside = clamp(at, vec2(0.5), max(size - 0.5, 0.5)) + vec2(0.0, row);
    return masu_sane(textureLod(image, inside / vec2(textureSize(image, 0)), 0.0).rgb, 0.0,
                     65504.0);
}

/* The same by the uniform cubic B-spline, as four bilinear samples: smooth at any magnification,
 * and its weights for a texel have the same sum everywhere. */
vec3 masu_post_spline(sampler2D image, vec2 at, vec2 size, float row)
{
    vec2 from = floor(at - 0.5), f = at - 0.5 - from, g = 1.0 - f;
    vec2 w0 = g * g * g / 6.0, w3 = f * f * f / 6.0;
    vec2 w1 = (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0, w2 = 1.0 - w0 - w1 - w3;
    vec2 low = w0 + w1, high = w2 + w3; /* each 1/6 at least */
    vec2 first = from - 0.5 + w1 / low, last = from + 1.5 + w3 / high;
    return low.y * (low.x * masu_post_sample(image, first, size, row) +
                    high.x * masu_post_sample(image, vec2(last.x, first.y), size, row)) +
           high.y * (low.x * masu_post_sample(image, vec2(first.x, last.y), size, row) +
                     high.x * masu_post_sample(image, last, size, row));
}

#endif
