/*
 * sky.glsl: the sky behind all surfaces: a gradient of two colours, or the analytic sky of
 * src/frame/sky.c. masu_sky_light is the GPU copy of masu_sky_radiance there.
 *
 * A specialisation constant enables the analytic sky: without it the code is compiled away, and the
 * uniforms are a stand-in. With it, a frame may still use a gradient. An environment map replaces
 * the gradient.
 *
 * After light/environment.glsl.
 */
#ifndef MASU_SKY_GLSL
#define MASU_SKY_GLSL

#include "shared/sky.h"

#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 1) const bool masu_has_sky = false;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKY, std140) uniform Sky
{
    masu_sky_uniforms masu_sky_tables;
};

/* Blend from horizon to zenith over the sine of elevation; the horizon's colour below it. */
vec3 masu_sky_gradient(vec3 direction)
{
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(frame.sky_horizon.rgb, frame.sky_zenith.rgb, sqrt(height));
}

bool masu_sky_is_analytic()
{
    return masu_has_sky && masu_sky_tables.azimuth.w > 0.0;
}

/* The weighted sum of the three terms at a sine of elevation and a cosine of azimuth from the sun:
 * multiple scattering, air, haze. One after the other: all at once take 72 registers on Intel's
 * GPUs. */
vec3 masu_sky_sum(float y, float x, vec3 weights)
{
    float t = y < 0.0 ? -masu_sqrt(-y) : masu_sqrt(y);
    float at = clamp((float(MASU_SKY_ROWS / 2) - 0.5) * (1.0 + t), 0.0, float(MASU_SKY_ROWS - 1));
    int row = int(min(at, float(MASU_SKY_ROWS - 2)));
    float part = at - float(row);
    row *= MASU_SKY_ROW;
    vec3 sum = vec3(0.0);
    [[dont_unroll]] for (int k = 0; k < MASU_SKY_TERMS; k++) {
        int a = row + 3 * k;
        int b = a + MASU_SKY_ROW;
        vec3 low = masu_sky_tables.rows[a].rgb +
                   x * (masu_sky_tables.rows[a + 1].rgb + x * masu_sky_tables.rows[a + 2].rgb);
        vec3 high = masu_sky_tables.rows[b].rgb +
                    x * (masu_sky_tables.rows[b + 1].rgb + x * masu_sky_tables.rows[b + 2].rgb);
        vec3 power = min(low + part * (high - low), 32.0);
        sum += weights.x * vec3(masu_exp2(power.r), masu_exp2(power.g), masu_exp2(power.b));
        weights = weights.yzx;
    }
    return sum;
}

/* Henyey and Greenstein's phase function. */
float masu_haze_phase(float cosine, float g)
{
    float r = masu_rsqrt(max(1.0 + g * g - 2.0 * g * cosine, 1e-6));
    return (1.0 - g * g) * 0.0795774715 * r * r * r;
}

/* Phase functions of the three terms at a cosine to the sun. */
vec3 masu_sky_phases(float cosine)
{
    return vec3(1.0, 0.0596831037 * (1.0 + cosine * cosine),
                masu_haze_phase(cosine, masu_sky_tables.sun.w));
}

/* Cosine of the azimuth between a direction and the sun; 0 straight up and down. */
float masu_sky_azimuth(vec3 direction)
{
    float flat2 = dot(direction.xz, direction.xz);
    float x = dot(direction.xz, masu_sky_tables.azimuth.xy) * masu_rsqrt(flat2);
    return flat2 > 1e-12 ? clamp(x, -1.0, 1.0) : 0.0;
}

/* Radiance of the analytic sky towards a unit direction, without the sun's disc. */
vec3 masu_sky_light(vec3 direction)
{
    vec3 d = masu_sane(direction, -1.0, 1.0);
    float cosine = clamp(dot(d, masu_sky_tables.sun.xyz), -1.0, 1.0);
    vec3 weights = masu_sky_phases(cosine);
    return masu_sky_sum(d.y, masu_sky_azimuth(d), weights);
}

/* Radiance of the horizon below or above a direction: three terms of a table, instead of nine
 * powers. The cosine to the sun is computed from the unnormalised horizontal part, which fades the
 * phase functions towards the zenith and the ground, where the azimuth is undefined. */
vec3 masu_sky_horizon(vec3 direction)
{
    vec3 d = masu_sane(direction, -1.0, 1.0);
    float cosine = clamp(dot(d.xz, masu_sky_tables.sun.xz), -1.0, 1.0);
    float at = (masu_sky_azimuth(d) + 1.0) * (0.5 * float(MASU_SKY_AZIMUTHS - 1));
    int first = int(min(at, float(MASU_SKY_AZIMUTHS - 2)));
    float part = at - float(first);
    first *= MASU_SKY_TERMS;
    vec3 weights = masu_sky_phases(cosine);
    vec3 sum = vec3(0.0);
    [[dont_unroll]] for (int k = 0; k < MASU_SKY_TERMS; k++) {
        sum += weights[k] * mix(masu_sky_tables.horizon[first + k].rgb,
                                masu_sky_tables.horizon[first + MASU_SKY_TERMS + k].rgb, part);
    }
    return sum;
}

/* masu_sky_light(), blurred by lobes with the bands a1 and a2. Both phase functions are exact,
 * since their bands are powers; the elevation is blurred by three samples at the best distance (the
 * lobe has long tails: its variance would require more). */
vec3 masu_sky_blurred(vec3 direction, float a1, float a2)
{
    vec3 d = masu_sane(direction, -1.0, 1.0);
    float cosine = clamp(dot(d, masu_sky_tables.sun.xyz), -1.0, 1.0);
    float x = masu_sky_azimuth(d);
    float air_phase = 0.0795774715 * (1.0 + a2 * (0.75 * cosine * cosine - 0.25));
    float haze_phase = masu_haze_phase(cosine, masu_sky_tables.sun.w * a1);
    float width = masu_sqrt((1.0 - a2) * (1.0 - 0.9 * d.y * d.y)) * 0.45;
    vec3 sum = vec3(0.0);
    [[dont_unroll]] for (int i = -1; i <= 1; i++) {
        sum += masu_sky_sum(clamp(d.y + float(i) * width, -1.0, 1.0), x,
                            vec3(1.0, air_phase, haze_phase));
    }
    return sum * (1.0 / 3.0);
}

/* masu_sky_blurred() for a roughness of 0.4, from the table of src/frame/sky_table.c: no powers. */
vec3 masu_sky_rough(vec3 direction)
{
    vec3 d = masu_sane(direction, -1.0, 1.0);
    float half_angle = masu_sqrt(0.5 - 0.5 * masu_sky_azimuth(d));
    vec2 at = vec2(half_angle * float(MASU_SKY_ROUGH_AZIMUTHS - 1),
                   (0.5 + 0.5 * d.y) * float(MASU_SKY_ROUGH_ROWS - 1));
    ivec2 first = ivec2(min(at, vec2(MASU_SKY_ROUGH_AZIMUTHS - 2, MASU_SKY_ROUGH_ROWS - 2)));
    vec2 part = at - vec2(first);
    int k = first.y * MASU_SKY_ROUGH_AZIMUTHS + first.x;
    vec3 low = mix(masu_sky_tables.rough[k].rgb, masu_sky_tables.rough[k + 1].rgb, part.x);
    k += MASU_SKY_ROUGH_AZIMUTHS;
    vec3 high = mix(masu_sky_tables.rough[k].rgb, masu_sky_tables.rough[k + 1].rgb, part.x);
    return mix(low, high, part.y);
}

/* The visible sun. In front of a gradient a disc of its true size would be two pixels wide and
 * bright enough to swamp the tone curve, so a soft glow shows the direction of the light. The
 * analytic sky and an environment map, whose own sun the baker has removed, have the aureole: they
 * get the disc, with less than its true radiance. */
vec3 masu_sun_disc(vec3 direction)
{
    float towards = clamp(dot(direction, frame.sun_direction.xyz), 0.0, 1.0);
    bool analytic = masu_sky_is_analytic();
    if (analytic || masu_has_environment) {
        float disc = smoothstep(0.99994, 0.99998, towards);
        if (!analytic) {
            return frame.sun_color.rgb * (MASU_SKY_DISC * disc);
        }
        /* The ground covers the part below the horizon. */
        return masu_sky_tables.disc.rgb * (disc * smoothstep(-0.003, 0.003, direction.y));
    }
    return frame.sun_color.rgb * (0.25 * masu_pow(towards, 350.0) + 0.05 * masu_pow(towards, 12.0));
}

/* Radiance of the sky towards a unit direction, without the sun. */
vec3 masu_sky(vec3 direction)
{
    if (masu_sky_is_analytic()) {
        return masu_sky_light(direction);
    }
    if (masu_has_environment) {
        return masu_environment(direction, 0.0);
    }
    return masu_sky_gradient(direction);
}

#endif
