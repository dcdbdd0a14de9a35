/* probe_light.h: the runtime's light probe evaluation, in C. It matches shaders/light/probes.glsl
 * and probes_light.comp; tests/gpu/test_probes.c compares the two. masu-bake uses it to measure the
 * error of a grid's light against ground truth. Bounded and total: the results are finite for any
 * bit pattern of the input. */
#ifndef MASU_PROBE_LIGHT_H
#define MASU_PROBE_LIGHT_H

#include "scene/blob.h"

/* The light of a moment. `sky`: the coefficients of its radiance for the nine real spherical
 * harmonics, in the order of masu_probe_basis. `sun`: irradiance on a facing surface / pi. */
typedef struct masu_probe_sky {
    float sky[9][3];
    float sun_direction[3];
    float sun[3];
} masu_probe_sky;

/* Y_lm of a unit direction: 1; y, z, x; xy, yz, 3zz - 1, xz, xx - yy, with their factors. */
void masu_probe_basis(const float d[3], float y[9]);

/* The weight of each baked sun for a sun in this direction. */
void masu_probe_sun_weights(const masu_blob_probes *probes, const float direction[3],
                            float weights[MASU_PROBE_SUNS_MAX]);

/* Sums the sets of every probe under this light: MASU_PROBE_LIT_WORDS 32-bit values for each, in
 * the layout of masu_shared.h. */
void masu_probe_light(const masu_blob_probes *probes, const uint32_t *data,
                      const masu_probe_sky *light, uint32_t *lit);

/* Irradiance / pi at a surface point with that normal. Returns how far the grid answers for it:
 * 1 in its bounds, falling to 0 within a cell around them. */
float masu_probe_lookup(const masu_blob_probes *probes, const uint32_t *data, const uint32_t *lit,
                        const float position[3], const float normal[3], float out[3]);

uint32_t masu_probe_pack(float low, float high);
float masu_probe_half(uint32_t half);

#endif
