/* fit.h: fits the curves to the ray-traced radiance. Levenberg-Marquardt (Marquardt, SIAM 1963)
 * with finite differences, from several starts, keeping the best result. Four kinds of residuals,
 * all relative to the mean radiance of their view:
 *
 *   far      the mean texel against the reference, every view and light: a distant surface
 *   near     single texels from straight above against the reference: the shadows
 *   filtered the mean of the texels' radiance against the radiance of the mean texel: errors that a
 *            mip may have
 *   kept     the same for the mean over all lights, from the texels of the map itself: light that a
 *            mip must preserve. Far uses only the mean texel, so gain and spread can serve both */
#ifndef MASU_MESO_FIT_H
#define MASU_MESO_FIT_H

#include "meso/shade.h"

#define MASU_MESO_NEAR_LIGHTS_MAX 16u

typedef struct masu_meso_samples {
    const masu_meso_setup *setup;
    const masu_meso_view *views;
    masu_meso_texel mean;
    /* Texels for near and filtered: `near` holds their radiance from above under near_light, by
     * texel, light and channel, including the sky. */
    const masu_meso_texel *texels;
    const double *near;
    /* Texels spread over the map, for the kind `kept`. */
    const masu_meso_texel *fine;
    uint32_t texel_count, near_count, fine_count;
    masu_meso_light near_light[MASU_MESO_NEAR_LIGHTS_MAX];
} masu_meso_samples;

/* Root mean square of each kind of residual, for messages. */
typedef struct masu_meso_misfit {
    double far, near, filtered;
} masu_meso_misfit;

masu_meso_curves masu_meso_fit(const masu_meso_samples *samples, const masu_meso_sky_table *table,
                               double facet, masu_meso_misfit *misfit);

#endif
