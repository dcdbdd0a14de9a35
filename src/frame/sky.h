/* sky.h: the analytic sky: radiance of the clear sky for a position of the sun, the sun's colour
 * after the atmosphere, and irradiance as spherical harmonics.
 *
 * The model is an atmosphere of air (Rayleigh), aerosol and ozone around a sphere. Single
 * scattering is integrated along the view ray; multiple scattering is an isotropic series
 * (Hillaire, A Scalable and Production Ready Sky and Atmosphere Rendering Technique, EGSR 2020,
 * section 5.5). At a fixed height the sky depends only on the view's elevation and its azimuth from
 * the sun, and apart from the phase functions only weakly on the azimuth: a shader needs only a
 * table over the elevation, with a polynomial of the azimuth's cosine in each row.
 *
 * The caller owns the masu_sky; nothing is allocated, nothing fails: any sun, turbidity and ground
 * give finite numbers. It has two tables: `multiple` depends on turbidity and ground, the other
 * also on the sun. masu_sky_update computes only the changed ones.
 *
 * Units: radiance and irradiance / pi as in masu_light; the sun has MASU_SKY_SUN outside of the
 * air. Directions: +Y up. */
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
    /* inputs of the tables; valid 0: not computed yet */
    uint32_t valid;
    float turbidity, ground[3], sun[3];
    float multiple[MASU_SKY_HEIGHTS][MASU_SKY_SUNS][3]; /* per steradian, of irradiance 1 */
    struct masu_sky_uniforms uniforms;
    float sun_color[3]; /* irradiance / pi of the disc, 0 when it is below the horizon */
    masu_sky_irradiance irradiance;
    uint64_t air_updates, sun_updates; /* how often each table was computed */
    uint64_t steps;                    /* points of the air looked at in all that */
} masu_sky;

/* Recomputes the tables whose inputs have changed since the last call: `sun` (towards it, any
 * length but 0), turbidity and ground albedo. `sky` is zeroed before the first call. Returns 1
 * if anything was computed. Values out of range are clamped; values that are not finite become a
 * sun straight up, the least turbidity, no albedo. */
int masu_sky_update(masu_sky *sky, const float sun[3], float turbidity, const float ground[3]);

/* Irradiance / pi on a surface of unit normal n. */
void masu_sky_irradiance_at(const masu_sky_irradiance *irradiance, const float n[3], float out[3]);

/* Parts of the model, for tests. Transmittance of the sun's light to `height` km above the
 * ground under a sun of zenith cosine `mu`, per wavelength; 0 below the horizon. */
void masu_sky_transmittance(double height, double mu, double turbidity, double out[3]);

#endif
