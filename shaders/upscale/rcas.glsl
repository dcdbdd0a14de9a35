/*
 * rcas.glsl: the arithmetic of FSR1's contrast-adaptive sharpening (AMD, ffx_fsr1 v1.0.2), with a
 * true reciprocal at the end: AMD's approximate one loses 0.32 % of a constant image. The scalar
 * judge is tests/reference/fsr1.c. MASU_EXACT (debug.exact): divisions and order as in that judge,
 * so that all drivers agree exactly.
 */
#ifndef MASU_RCAS_GLSL
#define MASU_RCAS_GLSL

#ifdef MASU_EXACT

/* Rings darker than the first, or closer to white than the second, have no room on that side: the
 * quotient there would be 0/0. Far below one step of 8 bits, far above a denormal. */
const float dark = 1e-6;
const float bright = 1.0 - 1e-6;

/* Most negative lobe for one channel, given the least and most of its ring; at least -1. */
float limit_of(float least, float most, float centre)
{
    float limit = -1.0;
    if (most > dark) {
        limit = max(limit, -(min(least, centre) / (4.0 * most)));
    }
    if (least < bright) {
        limit = max(limit, (1.0 - max(most, centre)) / (4.0 * least - 4.0));
    }
    return limit;
}

/* A cross of five texels; strength: 0..1, 1 the sharpest, stops: 1 / strength. */
vec3 masu_rcas(vec3 up, vec3 left, vec3 centre, vec3 right, vec3 down, float strength, float stops)
{
    vec3 least = min(min(up, left), min(right, down));
    vec3 most = max(max(up, left), max(right, down));
    float limit = max(max(limit_of(least.r, most.r, centre.r), limit_of(least.g, most.g, centre.g)),
                      limit_of(least.b, most.b, centre.b));
    precise float lobe = clamp(limit, -0.1875, 0.0) * strength;

    /* 4 * -0.1875 + 1 = 0.25: never near 0. */
    precise float denominator = 4.0 * lobe + 1.0;
    precise vec3 ring = (up + left) + (right + down);
    precise vec3 sharpened = (lobe * ring + centre) / denominator;
    return sharpened;
}

#else

/* Added to the divisors below, so that 0/0, a ring of black or of white, is 0: no limit. Above half
 * a unit in the last bit of 1; it changes a limit by less than 3e-4 of its value if there is an
 * 8-bit step to gain. */
const float room = 1.0 / 1048576.0;

/* The factor of masu_rcas_off that is added, from a cross of five texels of 0..1; stops: exp2 of
 * the stops, 1 the sharpest, at most 2^64.
 *
 * The strongest lobe w of a channel is a quarter of the lesser of min / most and (1 - max) / (1 -
 * least), min and max with the centre, least and most without; at most 3/16. Stored as l = 1 / (4
 * w), each fraction needs one guard. And (c - w ring) / (1 - 4 w) = c + (c - ring / 4) / (l - 1):
 * one reciprocal less, and a constant image is unchanged for any l. */
float masu_rcas_share(vec3 up, vec3 left, vec3 centre, vec3 right, vec3 down, float stops)
{
    vec3 least = min(min(up, left), min(right, down));
    vec3 most = max(max(up, left), max(right, down));
    vec3 low = most / (min(least, centre) + room);
    vec3 high = (1.0 - least) / ((1.0 + room) - max(most, centre));
    float l = max(max(1.0 / 0.75, low.r), high.r); /* in this order each line is one max3
                                                    * instruction, if available */
    l = max(max(l, low.g), high.g);
    l = max(max(l, low.b), high.b);
    return 1.0 / (l * stops - 1.0); /* the divisor is at least 1/3 */
}

/* The difference between the centre and the mean of its ring; masu_rcas_share() times this is
 * added. */
vec3 masu_rcas_off(vec3 up, vec3 left, vec3 centre, vec3 right, vec3 down)
{
    return centre - 0.25 * ((up + left) + (right + down));
}

/* Whether two neighbouring pixels, the first in an even column, are sharpened at all. The share is
 * at most 3: if both centres are that close to the means of their rings, as in flat areas and
 * gradients, sharpening changes at most half an 8-bit step and is skipped. */
bool masu_rcas_asked(vec3 off, vec3 off2)
{
    vec3 most = max(abs(off), abs(off2));
    return max(max(most.r, most.g), most.b) > 1.0 / (6.0 * 255.0);
}

#endif

#endif
