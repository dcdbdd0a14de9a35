/* sky.h: tables of the analytic sky, written by src/frame/sky.c, read by light/sky.glsl. */
#ifndef MASU_SHARED_SKY_H
#define MASU_SHARED_SKY_H

#include "shared/types.h"

/* Row r is the view direction whose sine of elevation is t |t|, with t from -1 (down) to 1 (up).
 * Half of the rows are above the horizon and none is exactly at it. */
#define MASU_SKY_ROWS 48
/* A row has three terms: isotropic, with Rayleigh's phase function, and with the aerosol's. Each is
 * a quadratic polynomial of the cosine of the azimuth from the sun. */
#define MASU_SKY_TERMS 3
#define MASU_SKY_ROW 9
/* Cosines of the azimuth, -1 to 1, of the table at the horizon. */
#define MASU_SKY_AZIMUTHS 33
/* Sines of elevation and cosines of azimuth, both -1 to 1, of the sky prefiltered for a roughness
 * of 0.4. */
#define MASU_SKY_ROUGH_ROWS 16
#define MASU_SKY_ROUGH_AZIMUTHS 9
/* The lobe that approximates the aureole in the sky's irradiance (src/frame/sky.c). */
#define MASU_SKY_ROUND (1.0f / 3.0f)
/* Radiance of the sun's disc as rendered, by its irradiance on a facing surface / pi. The true
 * factor is 45,000, which is close to the end of half floats. */
#define MASU_SKY_DISC 40.0f

/* The radiance of a term is 2^(c0 + c1 x + c2 x^2), x = cosine of the azimuth from the sun, and
 * therefore positive. */
struct masu_sky_uniforms {
    masu_vec4 sun;     /* xyz unit vector towards the sun; w asymmetry of the aerosol's phase */
    masu_vec4 disc;    /* rgb radiance of the sun's disc as rendered; w unused */
    masu_vec4 azimuth; /* xy: x and z of the horizontal unit vector towards the sun; w not 0: the
                          scene uses this sky */
    masu_vec4 rows[MASU_SKY_ROWS * MASU_SKY_ROW];          /* rgb log2 of radiance; w unused */
    masu_vec4 horizon[MASU_SKY_AZIMUTHS * MASU_SKY_TERMS]; /* rgb radiance, terms per cosine */
    masu_vec4 rough[MASU_SKY_ROUGH_ROWS * MASU_SKY_ROUGH_AZIMUTHS]; /* rgb radiance, row by row */
};

#endif
