/*
 * fxaa.comp: anti-aliasing in one pass, if SMAA is too expensive. Pixels of high contrast become a
 * mean along the edge, whose direction the adjacent pixels give.
 *
 * The idea is Lottes' ("FXAA", NVIDIA white paper, 2009; the short variant): two taps half a pixel
 * along the edge, and two more up to two pixels away. The outer two contribute unless they have
 * left the edge, which a luma outside the neighbourhood's range indicates. Taps are mixed as linear
 * light, approximated by the square: accurate enough for a mean of neighbours, and cheap.
 *
 * Push constants: render_*: valid corner of the image.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/output.glsl"
#include "smaa/color.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D picture; /* display-encoded */
layout(set = MASU_SET_PASS, binding = 1, MASU_COLOR_FORMAT)
    uniform writeonly MASU_COLOR_IMAGE smooth_image;

/* Contrast thresholds: an eighth of the brightest neighbour, 1/24 of white. */
const float least_share = 0.125;
const float least_step = 2550000.0 / 24.0;
const float farthest = 2.0;

vec3 fetch(ivec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    return masu_sane_unit(texelFetch(picture, clamp(at, ivec2(0), last), 0).rgb);
}

/* Bilinear, at `offset` from the centre of pixel `at`. */
vec3 light_at(ivec2 at, vec2 offset)
{
    vec2 whole = floor(offset);
    vec2 part = offset - whole;
    ivec2 p = at + ivec2(whole);
    vec3 a = fetch(p), b = fetch(p + ivec2(1, 0)), c = fetch(p + ivec2(0, 1)), d = fetch(p + 1);
    return mix(mix(a * a, b * b, part.x), mix(c * c, d * d, part.x), part.y);
}

vec3 shown(vec3 light)
{
    return vec3(masu_sqrt(light.r), masu_sqrt(light.g), masu_sqrt(light.b));
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(pc.render_width, pc.render_height)))) {
        return;
    }
    vec3 color = fetch(at);
    vec3 up = fetch(at + ivec2(0, -1));
    vec3 left = fetch(at + ivec2(-1, 0));
    vec3 right = fetch(at + ivec2(1, 0));
    vec3 down = fetch(at + ivec2(0, 1));
    float n = masu_smaa_luma(up);
    float w = masu_smaa_luma(left);
    float e = masu_smaa_luma(right);
    float s = masu_smaa_luma(down);
    float centre = masu_smaa_luma(color);
    float least = min(centre, min(min(n, w), min(e, s)));
    float most = max(centre, max(max(n, w), max(e, s)));
    if (most - least >= max(least_step, least_share * most)) {
        vec3 up_left = fetch(at + ivec2(-1, -1));
        vec3 up_right = fetch(at + ivec2(1, -1));
        vec3 down_left = fetch(at + ivec2(-1, 1));
        vec3 down_right = fetch(at + ivec2(1, 1));
        float nw = masu_smaa_luma(up_left);
        float ne = masu_smaa_luma(up_right);
        float sw = masu_smaa_luma(down_left);
        float se = masu_smaa_luma(down_right);
        least = min(least, min(min(nw, ne), min(sw, se)));
        most = max(most, max(max(nw, ne), max(sw, se)));
        /* The edge is perpendicular to the gradient. A single pixel has no gradient: nothing to
         * follow. */
        vec2 along = vec2((nw + 2.0 * n + ne) - (sw + 2.0 * s + se),
                          (ne + 2.0 * e + se) - (nw + 2.0 * w + sw));
        float length_squared = dot(along, along);
        if (length_squared > 1.0) {
            along *= masu_rsqrt(length_squared);
            /* Half a pixel to both sides is still within the nine pixels. */
            vec2 share = 0.5 * abs(along);
            bool falls = along.x * along.y > 0.0;
            vec3 corners = falls ? up_left * up_left + down_right * down_right
                                 : up_right * up_right + down_left * down_left;
            vec3 beside = left * left + right * right;
            vec3 above = up * up + down * down;
            vec3 near_by = color * color * ((1.0 - share.x) * (1.0 - share.y)) +
                           beside * (0.5 * share.x * (1.0 - share.y)) +
                           above * (0.5 * share.y * (1.0 - share.x)) +
                           corners * (0.5 * share.x * share.y);
            float smaller = max(min(abs(along.x), abs(along.y)) * 8.0, 1e-3);
            vec2 far = clamp(along / smaller, vec2(-farthest), vec2(farthest));
            vec3 wider = 0.5 * near_by + 0.25 * (light_at(at, -far) + light_at(at, far));
            vec3 wide_color = shown(wider);
            float luma = masu_smaa_luma(wide_color);
            color = luma < least || luma > most ? shown(near_by) : wide_color;
        }
    }
    MASU_STORE_COLOR(smooth_image, at, color);
}
