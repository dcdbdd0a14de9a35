/* probes.h: the buffer of light probes. */
#ifndef MASU_SHARED_PROBES_H
#define MASU_SHARED_PROBES_H

#include "shared/types.h"

#define MASU_PROBE_SUNS 16
#define MASU_PROBE_SETS 26
#define MASU_PROBE_SET_WORDS 14u

/* Light of this frame at a probe, in 32-bit values: the first SH coefficient (r, g, b) and the
 * probe's validity as halves; then one value per further coefficient: r, g, b of 10 signed bits, in
 * units of the first coefficient times PROBE_MOST / 511. This loads half of what halves would, and
 * integers unpack in a third of the time on GPUs without half instructions. The last two values are
 * padding, so that a probe is three loads of four values, aligned to four. */
#define MASU_PROBE_LIT_WORDS 12u
#define MASU_PROBE_MOST_1 1.25  /* light from a single direction has 1.155 in band 1 */
#define MASU_PROBE_MOST_2 0.625 /* and 0.559 in band 2 */

/* With live probes, after the light of this frame: per probe the mean of its rays, in the same
 * format; then per probe MASU_BOUNCE_SETS partial sums, in the format of sets. */

/* Head of the buffer, masu_blob_probes in src/scene/blob.h. Then, per probe, the coefficients from
 * the blob; then, per probe, the light of this frame. */
struct masu_probe_grid {
    masu_vec4 origin;  /* xyz first probe; w metres by which points are moved along their normal */
    masu_vec4 spacing; /* xyz */
    masu_uvec4 counts; /* xyz; w coefficient sets of the sky */
    masu_uvec4 more;   /* x suns; y 1: a set for emission; z texels per edge of a map; w 1: live */
    masu_vec4 sun_direction[MASU_PROBE_SUNS];
    masu_vec4 sun_inverse[4 * MASU_PROBE_SUNS]; /* rows of 16 */
};

#endif
