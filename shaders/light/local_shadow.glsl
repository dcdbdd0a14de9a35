/*
 * local_shadow.glsl: visibility of a local light at a point, from the light's faces in the shadow
 * atlas (shared/local_shadow.h): masu_light_seen(). The includer binds the atlas and defines its
 * binding: MASU_AT_LOCAL_SHADOWS. Needs lights.glsl's buffer before it.
 *
 * A point light has six faces of a cube along the world's axes, a spot one along its own axis. A
 * texel is lit or not, and nine texels are weighted by a quadratic B-spline around the point. The
 * edge of a shadow is where their sum is one half. If the penumbra of the source is narrower than
 * the filter, the sum is made up to three times as steep there.
 *
 * BIAS. The depth near / z of a plane is affine in the face. Each of the nine texels is compared
 * with the surface's own plane there if that rises towards the light, and with the point's depth if
 * it falls: exact on a plane. The atlas holds depths that are rounded away from the light. A bias
 * of a tenth of a texel covers the rounding of the point's normal and depth, and the plane's slope
 * over an eighth of a texel the rounding of vertices. The point is from a depth image, whose
 * rasteriser also snaps vertices: it is lifted off its plane by a step of the subpixel grid at its
 * distance from the camera. This matters if texels are smaller than that step.
 */
#ifndef MASU_LOCAL_SHADOW_GLSL
#define MASU_LOCAL_SHADOW_GLSL

#extension GL_EXT_control_flow_attributes : require

layout(set = MASU_SET_PASS, binding = MASU_AT_LOCAL_SHADOWS) uniform sampler2D local_shadow_atlas;

const float masu_local_steepest = 200.0; /* steepest slope against the light that is compensated:
                                          * 0.3 degrees */
const float masu_local_least_bias = 0.1; /* texels */
const float masu_local_behind = 20.0; /* a surface that faces away from the whole source darkens
                                       * over 2.9 degrees */
const float masu_local_snap = 1.0 / 8.0; /* texels: how far rasterisers may move an edge on a
                                          * face */
const float masu_local_steeper = 3.0; /* at most: edges of a third of the filter's width */
const float masu_local_width = 0.9; /* texels: half width of a penumbra as wide as the filter */

/* Weights of the texels before, at and after the point; f: distance from its texel's centre. */
vec3 masu_local_spline(float f)
{
    float a = 0.5 - f;
    float b = 0.5 + f;
    return vec3(0.5 * a * a, 0.75 - f * f, 0.5 * b * b);
}

/* Which texels of a row are lit. Depths are at most 1: a clamp to 0..1 costs no instruction. */
vec3 masu_local_lit(vec3 across, float down, float depth, vec3 nearest)
{
    return vec3(greaterThanEqual(clamp(across + down, 0.0, 1.0), nearest - depth));
}

#ifdef MASU_LOCAL_SHADOWS_FOUR
/* The four texels around the point, for shaders without registers for nine. */
float masu_local_filter(vec2 at, float depth, vec2 slope, float texel, out float gap)
{
    vec2 corner = floor(at - 0.5);
    vec2 f = at - 0.5 - corner;
    vec4 above = textureGather(local_shadow_atlas, (corner + 1.0) * texel) - depth;
    gap = max(max(above.x, above.y), max(above.z, above.w));
    vec2 low = -slope * f;
    vec2 high = low + slope;
    vec4 rise = vec4(low.x + high.y, high.x + high.y, high.x + low.y, low.x + low.y);
    vec4 lit = vec4(greaterThanEqual(clamp(rise, 0.0, 1.0), above));
    return mix(mix(lit.w, lit.z, f.x), mix(lit.x, lit.y, f.x), f.y);
}
#else
/* at: in texels of the atlas; depth: of the point; slope: change of the surface depth per texel.
 * gap: depth of the texel closest to the light, minus the depth of the point. */
float masu_local_filter(vec2 at, float depth, vec2 slope, float texel, out float gap)
{
    vec2 middle = floor(at);
    vec2 f = at - middle - 0.5;
    vec2 uv = middle * texel;
    float across = -slope.x * f.x;
    float down = -slope.y * (f.y + 1.0);
    vec3 weight = masu_local_spline(f.x), rows = masu_local_spline(f.y);
    float sum = 0.0;
    gap = 0.0;
    /* In a loop: all sixteen texels of four gathers at once take too many registers. A gather
     * returns the texels below left, below right, above right, above left of a corner. The second
     * iteration reads the middle row again. */
    [[dont_unroll]] for (int i = 0; i < 2; i++) {
        vec4 left = textureGather(local_shadow_atlas, uv);
        vec4 right = textureGather(local_shadow_atlas, uv + vec2(texel, 0.0));
        gap = max(max(gap, max(left.x, left.y)), max(max(left.z, left.w), max(right.y, right.z)));
        vec3 columns = vec3(across - slope.x, across, across + slope.x);
        float low = dot(weight,
                        masu_local_lit(columns, down, depth, vec3(left.w, left.z, right.z)));
        float high = dot(
            weight, masu_local_lit(columns, down + slope.y, depth, vec3(left.x, left.y, right.y)));
        sum += rows.x * low + rows.y * high;
        rows.xy = vec2(0.0, rows.z);
        down += slope.y;
        uv.y += texel;
    }
    gap -= depth;
    return sum;
}
#endif

/* rel: relative to the camera; n: unit normal of the surface itself, on the lit side. */
float masu_light_seen(masu_punctual_light_data light, vec3 rel, vec3 n)
{
    vec3 p = rel - light.shadow_origin.xyz;
    float near = uintBitsToFloat(light.shadow[1].z);
    float tangent = uintBitsToFloat(light.shadow[1].w);
    float z;
    vec2 uv;
    vec2 across;
    uint word = light.shadow[0].x;
    if (tangent > 0.0) {
        vec3 u = uintBitsToFloat(light.shadow[0].yzw);
        vec3 v = cross(light.axis.xyz, u);
        z = dot(light.axis.xyz, p);
        uv = vec2(dot(u, p), dot(v, p));
        across = vec2(dot(u, n), dot(v, n));
    } else {
        vec3 size = abs(p);
        tangent = 1.0;
        if (size.x >= size.y && size.x >= size.z) {
            z = p.x;
            uv = p.yz;
            across = n.yz;
            word = z < 0.0 ? light.shadow[0].y : word;
        } else if (size.y >= size.z) {
            z = p.y;
            uv = p.zx;
            across = n.zx;
            word = z < 0.0 ? light.shadow[0].w : light.shadow[0].z;
        } else {
            z = p.z;
            uv = p.xy;
            across = n.xy;
            word = z < 0.0 ? light.shadow[1].y : light.shadow[1].x;
        }
        z = abs(z);
    }
    if (word == 0u || !(z > 1e-6)) {
        return 1.0;
    }
    float edge = float(1u << (word & 15u));
    vec2 corner = vec2(word >> MASU_LOCAL_X_SHIFT, word >> MASU_LOCAL_Y_SHIFT & 0xFFFu) * 8.0;
    float inverse = 1.0 / z;
    /* of a texel at distance 1 */
    float width = 2.0 * tangent / (edge - 2.0 * float(MASU_LOCAL_GUARD));
    vec2 at = uv * (inverse / width) + (corner + 0.5 * edge);
    float depth = near * inverse;
    float step = depth * width;
    float along = dot(n, p) * inverse;
    float facing = min(along, -1.0 / masu_local_steepest);
    vec2 slope = across * (step / facing);
    /* texels */
    float lift = uintBitsToFloat(masu_lights_header.w) * masu_sqrt(dot(rel, rel)) *
                 (inverse / width);
    float bias = masu_local_least_bias * step + masu_local_snap * (abs(slope.x) + abs(slope.y));
    bias -= lift * (step / facing);
    /* Terms that do not depend on the filter's result are computed first, so that fewer registers
     * are live in it. */
    float radius = masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT
                       ? near
                       : masu_sqrt(light.color.w);
    float narrow = masu_local_width * near * width / max(radius, 1e-6);
    float facing_share = clamp(1.0 - (along - depth) * masu_local_behind, 0.0, 1.0);
    float gap;
    float lit = masu_local_filter(at, depth + bias, slope, uintBitsToFloat(masu_lights_header.z),
                                  gap);
    /* Half the penumbra, in texels: radius * gap / (near * width). */
    float steeper = clamp(narrow / max(gap, 1e-9), 1.0, masu_local_steeper);
    lit = clamp((lit - 0.5) * steeper + 0.5, 0.0, 1.0) * facing_share;
    float fade = float(word >> MASU_LOCAL_FADE_SHIFT & 15u) * (1.0 / float(MASU_LOCAL_FADE));
    return lit * fade + (1.0 - fade);
}

#endif
