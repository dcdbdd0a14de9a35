/* sky.h: the analytic sky: radiance of the clear sky for a position of the sun, the sun's colour
 * behind the air, and irradiance as spherical harmonics.
 *
 * The model is an atmosphere of three things around a sphere: air (Rayleigh), aerosol, ozone. Light
 * scattered once is integrated along the view; what is scattered more often comes from a series that
 * takes it to be without direction (Hillaire, A Scalable and Production Ready Sky and Atmosphere
 * Rendering Technique, EGSR 2020, section 5.5). From a fixed height the sky depends on the view's
 * elevation and its azimuth from the sun alone, and apart from the phase functions only weakly on the
 * latter: a table over the elevation, with a polynomial of the azimuth's cosine in each row, is all a
 * shader needs.
 *
 * Whoever holds a masu_sky owns all of it; nothing is allocated, nothing fails: any sun, turbidity
 * and ground give finite numbers. Two tables live here: `multiple` changes with turbidity and ground,
 * the rest with the sun too. masu_sky_update computes only what has changed.
 *
 * Units: radiance and irradiance / pi as in masu_light; the sun has MASU_SKY_SUN outside of the air.
 * Directions: +Y up. */
#ifndef MASU_SKY_H
#define MASU_SKY_H

#include <stdint.h>

#include "shared/masu_shared.h"

/* Irradiance / pi of the sun on a facing surface outside of the air: a noon of about 2. */
#define MASU_SKY_SUN 2.6
#define MASU_SKY_TURBIDITY_MIN 1.5f
#define MASU_SKY_TURBIDITY_MAX 10.0f

/* Table of light scattered more than once: heights and cosines of the sun's zenith angle. */
#define MASU_SKY_HEIGHTS 6
#define MASU_SKY_SUNS 14

/* Irradiance / pi on a surface of normal n: the sum of coefficient k times basis k,
 *     1, x, y, z, xy, yz, zx, 3y^2 - 1, x^2 - z^2,
 * plus, for what order 2 cannot hold, `glow` times a clamped cosine to `direction` whose corner is
 * round over +-MASU_SKY_ROUND, plus `ring` times Legendre's P4 of y. */
typedef struct masu_sky_irradiance {
    float sh[9][3];
    float glow[3], ring[3];
    float direction[3]; /* unit */
} masu_sky_irradiance;

typedef struct masu_sky {
    /* what the tables are of; valid 0: of nothing yet */
    uint32_t valid;
    float turbidity, ground[3], sun[3];
    float multiple[MASU_SKY_HEIGHTS][MASU_SKY_SUNS][3]; /* per steradian, of irradiance 1 */
    struct masu_sky_uniforms uniforms;
    float sun_color[3]; /* irradiance / pi of the disc, 0 when it is below the horizon */
    masu_sky_irradiance irradiance;
    uint64_t air_updates, sun_updates; /* how often each table was computed */
    uint64_t steps;                    /* points of the air looked at in all that */
} masu_sky;

/* Computes what `sun` (towards it, any length but 0), turbidity and ground albedo have changed since
 * the last call. `sky` is zeroed before the first. Returns 1 if anything was computed. What is out of
 * range is clamped, what is not finite becomes a sun straight up, the least turbidity, no albedo. */
int masu_sky_update(masu_sky *sky, const float sun[3], float turbidity, const float ground[3]);

/* Irradiance / pi on a surface of unit normal n. */
void masu_sky_irradiance_at(const masu_sky_irradiance *irradiance, const float n[3], float out[3]);

/* Parts of the model, for tests. Share of the sun's light that comes to `height` km above the ground
 * under a sun of zenith cosine `mu`, by wave length; 0 behind the horizon. */
void masu_sky_transmittance(double height, double mu, double turbidity, double out[3]);

#endif
