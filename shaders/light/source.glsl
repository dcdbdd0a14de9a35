/*
 * source.glsl: light sources that have a size: the sphere of a point or a spot, a rectangle, a
 * capsule.
 *
 *   sphere     diffuse: irradiance of its part above the horizon. Specular: the lobe of a point at
 *              its centre, widened by the source (Karis, "Real Shading in Unreal Engine 4", 2013,
 *              with the distance of half vectors instead of the mirror direction), times a factor
 *              that restores the energy. Roughness 0.045 to 1, sin of the source's radius 0.02 to
 *              0.95, any height: within 15 % of the exact energy for views of 20 degrees above the
 *              surface and more, within 22 % at 10 (tests/gpu/test_area_lights.c)
 *   rectangle  linearly transformed cosines (Heitz et al., "Real-Time Polygonal-Light Shading with
 *              Linearly Transformed Cosines", SIGGRAPH 2016). The horizon does not clip the
 *              polygon: its vector form factor is treated like a sphere's (Hill, "Real-Time Area
 *              Lighting: a Journey from Research to Production", 2016). The table is normalised:
 *              the amplitude is the albedo of tables.glsl
 *   capsule    a rectangle that faces the point, longer by pi r / 4 at either end
 *
 * s2: squared sine of the angle that the radius of a sphere subtends, 0..1.
 */
#ifndef MASU_SOURCE_GLSL
#define MASU_SOURCE_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "brdf/bsdf.glsl"

/* Mean cosine over a sphere whose centre has the cosine c: irradiance / (pi radiance s2). Between
 * the two cosines of tangency a fit; times s2 its error is 0.016 at most, at s 0.98, and 0.003
 * below 0.8, of a full hemisphere (Snyder, "Area Light Sources for Real-Time Graphics", 1996). */
float masu_clipped_cosine(float c, float s2)
{
    float s = sqrt(s2);
    if (c >= s) {
        return c;
    }
    float x = sqrt(1.0 - s2);
    float q = clamp(0.5 + 0.5 * c * masu_rcp(s), 0.0, 1.0);
    float whole = 1.0 - 0.8 * x;
    return s * (whole * masu_pow_above(max(q, 1e-6), 1.0 + x) +
                (1.0 - whole) * q * q * (0.698 + 0.302 * q));
}

float masu_widened(float alpha, float wider)
{
    return sqrt(min(alpha * alpha + wider, 1.0));
}

/* Energy correction of the widened lobe: it has the energy of a disc's irradiance, not of a solid
 * angle, and loses the part that it spreads below the horizon. wider: added to alpha^2. Fitted to
 * integrals. */
float masu_source_gain(float alpha, float n_v, float s2, float wider)
{
    float s = sqrt(s2), steep = (1.0 - n_v) * (1.0 - n_v);
    float solid = 2.0 / (1.0 + sqrt(1.0 - s2)) - 1.0;
    float spread = wider * s / ((alpha * alpha + wider) * (s + 0.06));
    float lost = spread * (0.1 + 0.34 * steep) * (1.0 - s2 * s);
    return (1.0 + solid * (1.0 - alpha)) / (1.0 - lost * (1.0 - alpha));
}

/* Weight of rays for the specular light of a source: a smooth step of the probability that a ray of
 * the lobe hits a sphere of that size. At low probability the widened lobe is nearly exact and rays
 * are noisy. l: unit, towards its centre. */
float masu_ray_share(vec3 n, vec3 v, vec3 l, float roughness, float s2)
{
    float n_v = masu_sane(dot(n, v), 1e-4, 1.0);
    float alpha = masu_alpha(roughness), wide = 0.25 * s2 / (n_v * n_v);
    float a2 = alpha * alpha + wide;
    vec3 h = masu_normalize(l + v, n);
    vec3 sine = cross(n, h);
    float n_h = clamp(dot(n, h), 0.0, 1.0);
    float k = dot(sine, sine) + n_h * n_h * a2;
    float chance = masu_sane(wide * a2 / (k * k), 0.0, 1.0);
    return chance * chance * (3.0 - 2.0 * chance);
}

/* masu_ray_share() of base and coat. Roughness as quantised for reflection rays
 * (specular/guide.glsl). */
vec2 masu_ray_shares(masu_surface s, masu_bsdf b, vec3 l, float s2)
{
    vec2 share = vec2(masu_ray_share(b.n, b.v, l, floor(s.roughness * 63.0 + 0.5) / 63.0, s2), 0.0);
#ifdef MASU_SURFACE
    if (b.coat > 0.0) {
        share.y = masu_ray_share(b.coat_n, b.v, l, floor(s.coat_roughness * 63.0 + 0.5) / 63.0, s2);
    }
#endif
    return share;
}

/* Converts a sphere in the direction l, unit, to an equivalent point: changes surface, direction
 * and colour. kept: share of the specular light of base and coat that rays do not find. */
void masu_spread(inout masu_bsdf b, inout vec3 l, inout vec3 color, float s2, vec2 kept)
{
    s2 = clamp(s2, 0.0, 0.9999);
    float n_l = dot(b.n, l), cosine = masu_clipped_cosine(n_l, s2);
    if (cosine > 0.0 && cosine != n_l) { /* lifted above the horizon */
        vec3 lifted = l + b.n * (cosine - n_l);
        float size = dot(lifted, lifted);
        l = lifted * masu_rsqrt(size);
        color *= sqrt(size);
    }
    vec3 sum = l + b.v;
    float wider = s2 / (1.8 * sqrt(dot(sum, sum)) + 0.4);
    float base = kept.x * masu_source_gain(b.alpha, b.n_v, s2, wider);
    b.alpha = masu_widened(b.alpha, wider);
    b.f0 *= base;
    b.f90 *= base;
#ifdef MASU_SURFACE
    b.coat_gain = kept.y * masu_source_gain(b.coat_alpha, b.coat_n_v, s2, wider);
    b.coat_alpha = masu_widened(b.coat_alpha, wider);
#endif
}

/* ---- Rectangles ------------------------------------------------------------------------------ */

/* Angle between two unit vectors over 2 pi, times their normal. acos(x) / sqrt(1 - x^2) / (2 pi)
 * within 6e-7 relative. */
vec3 masu_edge(vec3 a, vec3 b)
{
    float x = dot(a, b), y = abs(x);
    float v = (0.2499999 + y * (0.1441643 + 0.0041431 * y)) /
              (1.0 + y * (1.2132374 + 0.2893999 * y));
    vec3 normal = cross(a, b);
    /* For nearly opposite vectors 1 - x^2 has no digits left. */
    return normal * (x >= 0.0 ? v : 0.5 * masu_rsqrt_sure(max(dot(normal, normal), 1e-20)) - v);
}

/* Vector form factor of a parallelogram that faces the point: its centre relative to the point, its
 * half axes. A small one is integrated by four Gauss points, with an error of 0.5 % in the mean and
 * 3.5 % at most, edge on; a larger one over its edges, in a loop, since an edge takes many
 * registers. */
vec3 masu_form_factor(vec3 center, vec3 u, vec3 v)
{
    float squared = dot(center, center);
    float half_squared = dot(u, u) + dot(v, v);
    if (half_squared < 0.16 * squared && squared > 1e-12 && squared < 1e18) {
        vec3 a = (u + v) * 0.57735027, b = (u - v) * 0.57735027;
        vec2 middle = squared + vec2(dot(a, a), dot(b, b)),
             aside = 2.0 * vec2(dot(center, a), dot(center, b));
        vec2 high = 1.0 / (middle + aside), low = 1.0 / (middle - aside);
        high *= high;
        low *= low;
        vec2 even = high + low, odd = high - low;
        vec3 sum = center * (even.x + even.y) + a * odd.x + b * odd.y;
        return sum * (abs(dot(cross(a, b), center)) * 0.47746483); /* 3 / (2 pi) */
    }
    vec3 sum = vec3(0.0), from = masu_unit(center - u - v);
    [[dont_unroll]] for (int i = 0; i < 4; i++) {
        vec3 to =
            masu_unit(center + (i == 1 || i == 2 ? 1.0 : -1.0) * u + (i < 2 ? 1.0 : -1.0) * v);
        sum += masu_edge(from, to);
        from = to;
    }
    return sum;
}

/* The part of a form factor above the horizon, and a mean cosine; height: its scalar product with
 * the normal. */
float masu_above(vec3 form, float height, out float cosine)
{
    float size = min(masu_sqrt(dot(form, form)), 0.99999);
    cosine = masu_clipped_cosine(height * masu_rcp(size), size);
    float above = size * cosine;
    cosine *= 1.0 - size * (1.0 / 3.0); /* the mean over a hemisphere, weighted by itself */
    return above;
}

/* Interpolates two nodes of the transform table, times 32767. Scalar: vectors take more
 * registers. */
vec4 masu_transform_at(uint node, float f)
{
    uint at = uint(MASU_TABLE_TRANSFORM) + 2u * node;
    ivec4 words = ivec4(masu_tables[at], masu_tables[at + 1u], masu_tables[at + 2u],
                        masu_tables[at + 3u]);
    vec4 m;
    m.x = mix(float(words.x << 16 >> 16), float(words.z << 16 >> 16), f);
    m.y = mix(float(words.x >> 16), float(words.z >> 16), f);
    m.z = mix(float(words.y << 16 >> 16), float(words.w << 16 >> 16), f);
    m.w = mix(float(words.y >> 16), float(words.w >> 16), f);
    return m;
}

/* a, b, c / alpha, d / (2 alpha) of the matrix (a 0 b, 0 1 0, c 0 d) from the lobe to a cosine. */
vec4 masu_transform(float alpha, float n_v)
{
    const float rows = float(MASU_TRANSFORM_ROWS - 1), columns = float(MASU_TRANSFORM_COLUMNS - 1);
    float y = clamp((sqrt(alpha) - MASU_TABLE_SMOOTHEST) * (rows / (1.0 - MASU_TABLE_SMOOTHEST)),
                    0.0, rows);
    float x = sqrt(1.0 - n_v) * columns;
    uint row = min(uint(y), uint(MASU_TRANSFORM_ROWS - 2));
    uint column = min(uint(x), uint(MASU_TRANSFORM_COLUMNS - 2));
    uint node = row * uint(MASU_TRANSFORM_COLUMNS) + column;
    vec4 low = masu_transform_at(node, x - float(column));
    vec4 high = masu_transform_at(node + uint(MASU_TRANSFORM_COLUMNS), x - float(column));
    return mix(low, high, y - float(row)) * (1.0 / 32767.0);
}

/* Axes of a surface's lobe in addition to its normal: `along` leads away from the viewer. At the
 * pole the lobe is round. */
void masu_lobe_axes(masu_bsdf b, out vec3 along, out vec3 aside)
{
    vec3 away = b.n * dot(b.n, b.v) - b.v;
    float size = dot(away, away);
    /* Across z or x. Products, so that no negated copies of the normal stay in registers. */
    float z = abs(b.n.x) > 0.5 ? 1.0 : 0.0, x = 1.0 - z;
    vec3 any = vec3(-b.n.y * z, b.n.x * z - b.n.z * x, b.n.y * x);
    along = masu_unit(size > 1e-10 ? away : any);
    aside = cross(b.n, along);
}

/* Transforms from the lobe to a cosine around +z. m: from masu_transform. */
vec3 masu_to_cosine(masu_bsdf b, vec4 m, vec3 along, vec3 aside, vec3 p)
{
    float x = dot(along, p), z = dot(b.n, p);
    return vec3(m.x * x + m.y * z, dot(aside, p), b.alpha * (m.z * x + 2.0 * m.w * z));
}

/* Irradiance / (pi radiance) by a parallelogram that faces the point (x), the share of its specular
 * lobe that it covers (y), and the mean cosine of the former (z). */
vec3 masu_rectangle(masu_bsdf b, vec3 center, vec3 u, vec3 v)
{
    float lit = 0.0, mirrored = 0.0, cosine = 0.0, part = 1.0;
    if (!(dot(center, b.n) + abs(dot(u, b.n)) + abs(dot(v, b.n)) > 0.0)) {
        return vec3(0.0);
    }
    /* In a loop, so that the form factor is compiled only once. */
    [[dont_unroll]] for (int i = 0; i < 2; i++) {
        vec3 form = masu_form_factor(center, u, v);
        float mean, above = masu_above(form, i == 0 ? dot(form, b.n) : form.z, mean);
        mirrored = above * part;
        if (i == 0) {
            lit = above;
            cosine = mean;
            vec4 m = masu_transform(b.alpha, b.n_v);
            vec3 along, aside;
            masu_lobe_axes(b, along, aside);
            center = masu_to_cosine(b, m, along, aside, center);
            u = masu_to_cosine(b, m, along, aside, u);
            v = masu_to_cosine(b, m, along, aside, v);
            /* The horizon cuts off a part of the cosine's hemisphere: the rest is scaled up. */
            float c = b.alpha * m.z;
            part = 2.0 / (1.0 + m.x * masu_rsqrt(m.x * m.x + c * c));
        }
    }
    return vec3(lit, mirrored, cosine);
}

/* Converts a parallelogram to a directional light: changes surface, direction and colour. It has
 * the rectangle's irradiance and only the coat's specular lobe. s2: as for a sphere. */
void masu_flatten(inout masu_bsdf b, inout vec3 l, inout vec3 color, vec3 form, float s2, vec2 kept)
{
    float cosine = clamp(form.z, 0.01, 1.0);
    vec3 side = l - b.n * dot(b.n, l);
    l = side * masu_sqrt((1.0 - cosine * cosine) * masu_rcp(dot(side, side))) + b.n * cosine;
    color *= form.x / cosine;
    b.f0 = vec3(0.0);
    b.f90 = 0.0;
#ifdef MASU_SURFACE
    b.coat_gain = kept.y;
    b.coat_alpha = masu_widened(b.coat_alpha, s2 / (3.6 * b.coat_n_v + 0.4));
#endif
}

#endif
