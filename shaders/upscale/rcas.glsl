/*
 * rcas.glsl: the arithmetic of FSR1's contrast-adaptive sharpening (AMD, ffx_fsr1 v1.0.2), with an
 * exact division at the end. The scalar judge is tests/reference/fsr1.c.
 */
#ifndef MASU_RCAS_GLSL
#define MASU_RCAS_GLSL

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

/* A cross of five texels; strength: 0..1, 1 the sharpest. */
vec3 masu_rcas(vec3 up, vec3 left, vec3 centre, vec3 right, vec3 down, float strength)
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

#endif
