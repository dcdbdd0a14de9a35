/* sky_table.c: see sky_table.h. Single precision, as the shaders. */
#include "frame/sky_table.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Henyey and Greenstein, Astrophysical Journal 93, 1941. */
static float haze_phase(float cosine, float g) {
    float d = 1.0f + g * g - 2.0f * g * cosine;
    return (1.0f - g * g) / (12.5663706f * d * sqrtf(d));
}

static float air_phase(float cosine) { return 0.0596831037f * (1.0f + cosine * cosine); }

/* The terms of a row between two, at a cosine of azimuth. */
static void look_up(const struct masu_sky_uniforms *sky, float y, float x,
                    float out[MASU_SKY_TERMS][3]) {
    const float half = (float)(MASU_SKY_ROWS / 2);
    float t = y < 0.0f ? -sqrtf(-y) : sqrtf(y);
    float at = fminf(fmaxf((half - 0.5f) * (1.0f + t), 0.0f), (float)MASU_SKY_ROWS - 1.0f);
    uint32_t row = (uint32_t)fminf(at, (float)MASU_SKY_ROWS - 2.0f);
    float part = at - (float)row;
    const masu_vec4 *a = &sky->rows[row * MASU_SKY_ROW], *b = a + MASU_SKY_ROW;
    for (uint32_t k = 0; k < MASU_SKY_TERMS; k++) {
        for (uint32_t c = 0; c < 3; c++) {
            float low = a[3 * k][c] + x * (a[3 * k + 1][c] + x * a[3 * k + 2][c]);
            float high = b[3 * k][c] + x * (b[3 * k + 1][c] + x * b[3 * k + 2][c]);
            out[k][c] = exp2f(low + part * (high - low));
        }
    }
}

void masu_sky_evaluate(const struct masu_sky_uniforms *sky, float y, float x, float cosine,
                       float out[3]) {
    float terms[MASU_SKY_TERMS][3];
    look_up(sky, y, x, terms);
    float air = air_phase(cosine), haze = haze_phase(cosine, sky->sun[3]);
    for (uint32_t c = 0; c < 3; c++) out[c] = terms[0][c] + air * terms[1][c] + haze * terms[2][c];
}

void masu_sky_radiance(const struct masu_sky_uniforms *sky, const float d[3], float out[3]) {
    float flat = sqrtf(d[0] * d[0] + d[2] * d[2]);
    float x = flat > 1e-6f ? (d[0] * sky->azimuth[0] + d[2] * sky->azimuth[1]) / flat : 0.0f;
    float cosine = d[0] * sky->sun[0] + d[1] * sky->sun[1] + d[2] * sky->sun[2];
    masu_sky_evaluate(sky, fminf(fmaxf(d[1], -1.0f), 1.0f), fminf(fmaxf(x, -1.0f), 1.0f),
                      fminf(fmaxf(cosine, -1.0f), 1.0f), out);
}

/* The colour of distant fog, without the phase functions. */
static void fill_horizon(struct masu_sky_uniforms *sky) {
    for (uint32_t a = 0; a < MASU_SKY_AZIMUTHS; a++) {
        float terms[MASU_SKY_TERMS][3];
        look_up(sky, 0.0f, (float)a * (2.0f / (MASU_SKY_AZIMUTHS - 1)) - 1.0f, terms);
        for (uint32_t k = 0; k < MASU_SKY_TERMS; k++)
            memcpy(sky->horizon[a * MASU_SKY_TERMS + k], terms[k], sizeof terms[k]);
    }
}

/* The bands 1 and 2 of a lobe of the roughness that `rough` is for: masu_lobe_bands of
 * shaders/light/ambient.glsl. */
#define BAND_1 0.9188f
#define BAND_2 0.7874f
/* Samples per node over the elevation, and the distance of the outermost from the centre. */
#define LOOKS 5
#define SPREAD 1.0f

/* The sky blurred as by a lobe of that roughness: both phase functions exactly so, for their
 * bands are powers; of the rest the elevation, by looks. */
static void fill_rough(struct masu_sky_uniforms *sky) {
    float sun_y = sky->sun[1], across = sqrtf(fmaxf(1.0f - sun_y * sun_y, 0.0f));
    for (uint32_t row = 0; row < MASU_SKY_ROUGH_ROWS; row++) {
        float y = (float)row * (2.0f / (MASU_SKY_ROUGH_ROWS - 1)) - 1.0f;
        float flat = sqrtf(fmaxf(1.0f - y * y, 0.0f));
        float width = 0.45f * sqrtf((1.0f - BAND_2) * (1.0f - 0.9f * y * y));
        for (uint32_t a = 0; a < MASU_SKY_ROUGH_AZIMUTHS; a++) {
            float half = (float)a * (1.0f / (MASU_SKY_ROUGH_AZIMUTHS - 1)),
                  x = 1.0f - 2.0f * half * half;
            float cosine = flat * x * across + y * sun_y, sum[3] = {0.0f, 0.0f, 0.0f};
            float air = 0.0795774715f * (1.0f + BAND_2 * (0.75f * cosine * cosine - 0.25f));
            float haze = haze_phase(cosine, sky->sun[3] * BAND_1);
            for (uint32_t i = 0; i < LOOKS; i++) {
                float terms[MASU_SKY_TERMS][3],
                    away = width * SPREAD * ((float)i * (2.0f / (LOOKS - 1)) - 1.0f);
                look_up(sky, fminf(fmaxf(y + away, -1.0f), 1.0f), x, terms);
                for (uint32_t c = 0; c < 3; c++)
                    sum[c] +=
                        (terms[0][c] + air * terms[1][c] + haze * terms[2][c]) * (1.0f / LOOKS);
            }
            memcpy(sky->rough[row * MASU_SKY_ROUGH_AZIMUTHS + a], sum, sizeof sum);
        }
    }
}

void masu_sky_tables(struct masu_sky_uniforms *sky) {
    fill_horizon(sky);
    fill_rough(sky);
}
