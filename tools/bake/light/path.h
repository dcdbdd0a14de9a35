/* path.h: diffuse light along random paths through a traced scene, each source separately: the sky,
 * emissive surfaces, and each of a number of suns. Offline, for light probes and their ground
 * truth.
 *
 * A path's random numbers depend only on its index and the item's seed, so that results do not
 * depend on the distribution of work over threads. */
#ifndef MASU_BAKE_PATH_H
#define MASU_BAKE_PATH_H

#include "bake/mesh/trace.h"

#define MASU_PATH_SETS_MAX 40u

typedef struct masu_path_lights {
    /* Writes `sky_sets` radiances (RGB) that come from a unit direction. */
    void (*sky)(const void *context, const float direction[3], float *rgb);
    const void *context;
    uint32_t sky_sets;
    uint32_t suns;         /* of irradiance pi on a facing surface */
    const float (*sun)[4]; /* towards each */
    uint32_t bounces;      /* maximum number of surfaces in a path */
} masu_path_lights;

/* Sets are in this order: the sky's, then one of emissive surfaces, then the suns'. */
static inline uint32_t masu_path_sets(const masu_path_lights *l) {
    return l->sky_sets + 1 + l->suns;
}

/* Two numbers in 0..1 of low discrepancy over `index`, another pair for every `pair`. */
void masu_path_sample(uint64_t seed, uint32_t index, uint32_t pair, float out[2]);

/* A direction about n by the cosine. */
void masu_path_cosine(const float n[3], const float u[2], float out[3]);
/* Any direction, evenly. */
void masu_path_sphere(const float u[2], float out[3]);

/* Adds to sum[set][3], times `scale`, the radiance that arrives at origin from direction,
 * without the suns' own. `first`: filled with the first surface; t below 0 if there is none.
 * Returns rays. */
uint64_t masu_path_radiance(const masu_bake_trace *trace, const masu_path_lights *lights,
                            const float origin[3], const float direction[3], uint64_t seed,
                            uint32_t index, float scale, float (*sum)[3], masu_bake_hit *first);

/* Calls work(context, item, thread) for all items below count, on `threads` threads (0: as many as
 * there are processors). */
void masu_path_share(uint32_t count, uint32_t threads, void (*work)(void *context, uint32_t item),
                     void *context);

#endif
