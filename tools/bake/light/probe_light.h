/* probe_light.h: what the runtime does with light probes, in C: shaders/light/probes.glsl and
 * probes_light.comp say the same in GLSL, and tests/gpu/test_probes.c compares the two. masu-bake
 * measures with it how far the light of a grid is from the truth. Bounded and total: whatever the
 * words hold, what comes out is finite. */
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

/* What share of each baked sun makes up one from this direction. */
void masu_probe_sun_weights(const masu_blob_probes *probes, const float direction[3],
                            float weights[MASU_PROBE_SUNS_MAX]);

/* Sums up the sets of every probe under this light: MASU_PROBE_LIT_WORDS for each, as masu_shared.h
 * says. */
void masu_probe_light(const masu_blob_probes *probes, const uint32_t *data,
                      const masu_probe_sky *light, uint32_t *lit);

/* Irradiance / pi at a surface point with that normal. Returns how far the grid answers for it:
 * 1 in its bounds, falling to 0 within a cell around them. */
float masu_probe_lookup(const masu_blob_probes *probes, const uint32_t *data, const uint32_t *lit,
                        const float position[3], const float normal[3], float out[3]);

uint32_t masu_probe_pack(float low, float high);
float masu_probe_half(uint32_t half);

#endif
