/*
 * particles.frag: colour that a particle adds to the lit image; alpha is the share of the
 * background that it removes, as in transparents.frag. A round sprite: full opacity from the centre
 * to `edge` of the radius, then a smooth falloff. It also fades near a surface behind and near the
 * near plane. The depth image has the depths of polygons and the SDF.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/particles.h"
#include "shared/types.h"
#include "shared/globals.glsl"
#include "light/air.glsl"

layout(constant_id = 2) const bool foggy = false; /* the scene has fog */

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;

layout(location = 0) in vec2 in_place;
layout(location = 1) in vec3 in_rel;
#ifdef MASU_LIVE_TEXTURES
#include "shared/live_textures.glsl"
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2DArray textures_image;
layout(location = 2) in vec4 in_color;
layout(location = 4) in vec2 in_at;
layout(location = 5) flat in vec4 in_cell;
layout(location = 6) flat in vec4 in_next;
#else
layout(location = 2) flat in vec4 in_color;
#endif
layout(location = 3) flat in vec4 in_more;

layout(location = 0) out vec4 out_color;

/* The limit of transparents.frag. */
const float brightest = 4096.0;

void main()
{
    vec4 own = in_color;
    float depth = in_more.z;
#ifdef MASU_LIVE_TEXTURES
    depth = dot(in_rel, frame.forward.xyz);
    vec2 dx = dFdx(in_at), dy = dFdy(in_at);
    if (in_next.w != 0.0) {
        float layer = abs(in_next.w) - 1.0;
        uint outside = in_next.w < 0.0 ? MASU_LIVE_REPEAT : MASU_LIVE_CLAMP;
        vec4 texel = masu_live_mean(textures_image, layer, in_cell, in_at, dx, dy, outside);
        if (in_next.z > 0.0) {
            vec4 other = vec4(in_next.xy, in_next.xy + (in_cell.zw - in_cell.xy));
            other = masu_live_mean(textures_image, layer, other, in_at, dx, dy, outside);
            float alpha = mix(texel.a, other.a, in_next.z);
            texel.rgb = mix(texel.rgb * texel.a, other.rgb * other.a, in_next.z) / max(alpha, 1e-6);
            texel.a = alpha;
        }
        own *= texel;
    }
#endif
    float nearest = texelFetch(depth_image, ivec2(gl_FragCoord.xy), 0).r;
    float rest = (1.0 - masu_sqrt(dot(in_place, in_place))) / max(1.0 - in_more.x, 1e-3);
    if (!(rest > 0.0) || !(gl_FragCoord.z >= nearest)) {
        discard;
    }
    float cover = min(rest, 1.0);
    cover *= cover * (3.0 - 2.0 * cover);
    float soft = in_more.w;
    if (soft > 0.0) {
        float near = frame.forward.w;
        /* The sky, with depth 0, is infinitely far. */
        float room = nearest > masu_tiny ? near / nearest - depth : soft;
        cover *= clamp(min(room, depth - near) / soft, 0.0, 1.0);
    }
    float alpha = own.a * cover;
    float taken = alpha * in_more.y;
    vec3 color = own.rgb * alpha;
    if (foggy) {
        vec3 direction = masu_normalize(in_rel, frame.forward.xyz);
        color = masu_through_air(color, direction, masu_air_depth(direction, length(in_rel)),
                                 taken);
    }
    out_color = vec4(masu_sane(color, 0.0, brightest), masu_sane(taken, 0.0, 1.0));
}
