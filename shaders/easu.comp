/*
 * easu.comp: FSR1 edge-adaptive upscale, fp32, one invocation for each output pixel.
 *
 * Equal to AMD's published fp32 shader (ffx_fsr1 v1.0.2), approximate reciprocals included; the
 * scalar judge is tests/reference/fsr1.c. It differs from the original in how it reads: 12 clamped
 * texelFetch instead of 12 gathers, because the input is the corner of a larger image and a gather
 * at its border would return what an earlier frame left outside.
 *
 * Why everything is `precise`: the result jumps, by up to tens of 255ths, where floor(p) changes,
 * where the gradient counts as none, and where three neighbours of different colour have the same
 * luma (one unit in the last place then decides between a straight edge and none). With operations
 * that are correctly rounded by the standard and never fused or reordered, and with inputs and
 * scale made independent of the driver below, all drivers take the same side.
 *
 * Push constants: render_* = valid corner of the input, output_* = size to write.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/store.glsl"
#include "shared/unorm8.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(push_constant) uniform Push
{
    masu_push pc;
};

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D target;

/* These two are specification, not optimisation: a true reciprocal changes hard edges by 16/255 and
 * binary noise by 70/255. They are finite for every operand met here, 0 included. */
float approximate_rcp(float a)
{
    return uintBitsToFloat(0x7EF07EBBu - floatBitsToUint(a));
}

float approximate_rsqrt(float a)
{
    return uintBitsToFloat(0x5F347D74u - (floatBitsToUint(a) >> 1));
}

/* 1/n correctly rounded, for n in 1..65535. A division may be 2.5 units off, differently on each
 * device, and with odd:odd ratios (3:5) some pixels lie exactly on a texel centre, where the last
 * bit of the scale decides floor(p). The quotient is m * 2^-shift; the remainder 2^shift - m*n is
 * exact modulo 2^32 although neither term fits, and says which way m is off. */
float exact_rcp(uint n)
{
    uint divisor = max(n, 1u);
    uint bits = floatBitsToUint(1.0 / float(divisor));
    uint shift = 150u - (bits >> 23);
    uint m = (bits & 0x007FFFFFu) | 0x00800000u;
    int power = shift < 32u ? int(1u << shift) : 0;
    int twice = 2 * (power - int(m * divisor));
    int step = int(divisor);
    for (int i = 0; i < 3; i++) {
        int move = twice > step ? 1 : (twice < -step ? -1 : 0);
        m += uint(move);
        twice -= 2 * move * step;
    }
    return float(m) * uintBitsToFloat((127u - shift) << 23);
}

vec3 fetch(ivec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    return masu_fetched_unorm8(texelFetch(source, clamp(at, ivec2(0), last), 0).rgb);
}

/* Twice the luma, cheaply. */
float luma(vec3 c)
{
    precise float red_green = c.r * 0.5 + c.g;
    precise float all_three = c.b * 0.5 + red_green;
    return all_three;
}

/* How straight the luma runs through three texels in a row: 1 = monotonic, 0 = a reversal. For
 * equal lumas 0 times the finite "reciprocal of 0" is 0: an exact division would need a guard. */
float straightness(float before, float centre, float after)
{
    precise float largest = max(abs(after - centre), abs(centre - before));
    precise float ratio = min(abs(after - before) * approximate_rcp(largest), 1.0);
    precise float squared = ratio * ratio;
    return squared;
}

/* Adds one of the four centres: xy gradient, z straightness of both axes. */
vec3 add_edge(vec3 edge, float weight, float above, float left, float centre, float right,
              float below)
{
    precise float x = edge.x + (right - left) * weight;
    precise float z = edge.z + straightness(left, centre, right) * weight;
    precise float y = edge.y + (below - above) * weight;
    z = z + straightness(above, centre, below) * weight;
    return vec3(x, y, z);
}

struct kernel {
    vec2 dir;   /* unit vector across the edge */
    vec2 scale; /* shortens the kernel across the edge, lengthens it along */
    float lobe; /* strength of the window */
    float clip; /* squared distance where the window ends */
};

kernel kernel_of(vec3 edge)
{
    precise float x = edge.x;
    precise float y = edge.y;
    precise float square = x * x + y * y;
    bool none = square < 1.0 / 32768.0;
    precise float unit = none ? 1.0 : approximate_rsqrt(square);
    x = (none ? 1.0 : x) * unit;
    y = y * unit;

    precise float len = edge.z * 0.5;
    len = len * len;

    precise float square_unit = x * x + y * y;
    precise float stretch = square_unit * approximate_rcp(max(abs(x), abs(y)));
    precise float longer = 1.0 + (stretch - 1.0) * len;
    precise float shorter = 1.0 + -0.5 * len;
    precise float lobe = 0.5 + (0.25 - 0.04 - 0.5) * len;
    return kernel(vec2(x, y), vec2(longer, shorter), lobe, approximate_rcp(lobe));
}

/* Adds one tap to rgb = weighted colour, a = weight. The weight is a polynomial stand-in for a
 * windowed sinc, of the squared distance in the kernel's own axes. */
vec4 add_tap(vec4 sum, kernel k, vec2 offset, vec3 colour)
{
    precise float x = (offset.x * k.dir.x + offset.y * k.dir.y) * k.scale.x;
    precise float y = (offset.x * -k.dir.y + offset.y * k.dir.x) * k.scale.y;
    precise float distance = min(x * x + y * y, k.clip);
    precise float base = 0.4 * distance + -1.0;
    base = 1.5625 * (base * base) + -0.5625;
    precise float window = k.lobe * distance + -1.0;
    precise float weight = base * (window * window);
    precise vec3 weighted = sum.rgb + colour * weight;
    precise float weights = sum.a + weight;
    return vec4(weighted, weights);
}

void main()
{
    uvec2 target_size = uvec2(pc.output_width, pc.output_height);
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, target_size))) {
        return;
    }

    /* Pixel centre to texel centre, in the order in which AMD's host code rounds. */
    precise vec2 scale = vec2(pc.render_width, pc.render_height)
                         * vec2(exact_rcp(target_size.x), exact_rcp(target_size.y));
    precise vec2 offset = 0.5 * scale - 0.5;
    precise vec2 moved = vec2(at) * scale;
    precise vec2 p = moved + offset;
    precise vec2 whole = floor(p);
    p = p - whole;
    ivec2 origin = ivec2(whole);

    /*   b c
     * e f g h     f is the texel at floor(p)
     * i j k l
     *   n o    */
    vec3 b = fetch(origin + ivec2(0, -1));
    vec3 c = fetch(origin + ivec2(1, -1));
    vec3 e = fetch(origin + ivec2(-1, 0));
    vec3 f = fetch(origin);
    vec3 g = fetch(origin + ivec2(1, 0));
    vec3 h = fetch(origin + ivec2(2, 0));
    vec3 i = fetch(origin + ivec2(-1, 1));
    vec3 j = fetch(origin + ivec2(0, 1));
    vec3 k = fetch(origin + ivec2(1, 1));
    vec3 l = fetch(origin + ivec2(2, 1));
    vec3 n = fetch(origin + ivec2(0, 2));
    vec3 o = fetch(origin + ivec2(1, 2));

    float luma_f = luma(f);
    float luma_g = luma(g);
    float luma_j = luma(j);
    float luma_k = luma(k);
    precise vec2 q = 1.0 - p;
    precise float weight_f = q.x * q.y;
    precise float weight_g = p.x * q.y;
    precise float weight_j = q.x * p.y;
    precise float weight_k = p.x * p.y;
    vec3 edge = vec3(0.0);
    edge = add_edge(edge, weight_f, luma(b), luma(e), luma_f, luma_g, luma_j);
    edge = add_edge(edge, weight_g, luma(c), luma_f, luma_g, luma(h), luma_k);
    edge = add_edge(edge, weight_j, luma_f, luma(i), luma_j, luma_k, luma(n));
    edge = add_edge(edge, weight_k, luma_g, luma_j, luma_k, luma(l), luma(o));
    kernel shape = kernel_of(edge);

    vec4 sum = vec4(0.0);
    sum = add_tap(sum, shape, vec2(0.0, -1.0) - p, b);
    sum = add_tap(sum, shape, vec2(1.0, -1.0) - p, c);
    sum = add_tap(sum, shape, vec2(-1.0, 1.0) - p, i);
    sum = add_tap(sum, shape, vec2(0.0, 1.0) - p, j);
    sum = add_tap(sum, shape, vec2(0.0, 0.0) - p, f);
    sum = add_tap(sum, shape, vec2(-1.0, 0.0) - p, e);
    sum = add_tap(sum, shape, vec2(1.0, 1.0) - p, k);
    sum = add_tap(sum, shape, vec2(2.0, 1.0) - p, l);
    sum = add_tap(sum, shape, vec2(2.0, 0.0) - p, h);
    sum = add_tap(sum, shape, vec2(1.0, 0.0) - p, g);
    sum = add_tap(sum, shape, vec2(1.0, 2.0) - p, o);
    sum = add_tap(sum, shape, vec2(0.0, 2.0) - p, n);

    /* The clamp removes ringing, and makes a flat area come out exactly as it went in. */
    vec3 least = min(min(f, g), min(j, k));
    vec3 most = max(max(f, g), max(j, k));
    precise vec3 mean = sum.rgb * (1.0 / sum.a); /* the four centres keep the sum well above 0 */
    vec3 result = min(most, max(least, mean));
    MASU_STORE_UNORM(target, at, vec4(result, 1.0));
}
