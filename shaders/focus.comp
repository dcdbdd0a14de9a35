/*
 * focus.comp: depth of field: mixes the layers of focus_gather.comp into the lit image. A pixel
 * whose circle of confusion is less than half a pixel in radius remains unchanged unless a closer
 * disc covers it.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/counters.h"
#include "shared/counters.glsl"
#include "shared/store.glsl"
#include "post/focus.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D far_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D near_image;
layout(set = MASU_SET_PASS, binding = 3, rgba16f) uniform image2D hdr_image;

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (!(post.lens.y > 0.0) ||
        any(greaterThanEqual(at, uvec2(pc.render_width, pc.render_height)))) {
        return;
    }
    float radius = masu_focus_radius(texelFetch(depth_image, ivec2(at), 0).r);
    /* Bilinear, of four texels: texels without a layer have weight 0. */
    vec2 place = 0.5 * (vec2(at) + 0.5) - 0.5, part = fract(place);
    ivec2 first = ivec2(floor(place)),
          last = (ivec2(pc.render_width, pc.render_height) + 1) / 2 - 1;
    vec4 behind = vec4(0.0), front = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 side = ivec2(k & 1, k >> 1), texel = clamp(first + side, ivec2(0), last);
        vec2 weights = mix(1.0 - part, part, vec2(side));
        behind += weights.x * weights.y * masu_sane(texelFetch(far_image, texel, 0), 0.0, 65504.0);
        front += weights.x * weights.y * masu_sane(texelFetch(near_image, texel, 0), 0.0, 65504.0);
    }
    float blurred = masu_focus_share(radius);
    if (!(front.a > 0.0) && !(blurred > 0.0 && behind.a > 0.0)) {
        return;
    }
    vec4 lit = imageLoad(hdr_image, ivec2(at));
    vec3 color = masu_sane(lit.rgb, 0.0, 65504.0),
         distant = behind.a > 1e-3 ? behind.rgb / behind.a : color;
    if (radius < 0.0 && blurred > 0.0) {
        /* The surrounding discs have this pixel's share. Dividing by it leaves the coverage of the
         * surface. */
        front /= max(blurred, max(front.a, 1e-3));
        front += max(0.5 - front.a, 0.0) * vec4(color, 1.0); /* half at the edge */
        color = mix(color, distant * (1.0 - front.a) + front.rgb, blurred);
    } else {
        color = mix(color, distant, blurred) * (1.0 - min(front.a, 1.0)) + front.rgb;
    }
    MASU_STORE_HALF(hdr_image, at, vec4(color, lit.a));
}
