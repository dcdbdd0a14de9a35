/* probes.h: a grid of path-traced light probes: the response of the diffuse light at each probe to
 * the sky and to the sun (blob.h, masu_blob_probes). Daylight changes at run time; the stored
 * response of the scene does not. */
#ifndef MASU_BAKE_PROBES_H
#define MASU_BAKE_PROBES_H

#include "bake/mesh/trace.h"

typedef struct masu_bake_probe_settings {
    bool wanted; /* baked light of sky and sun */
    bool live;   /* rays of each frame add the rest */
    bool has_bounds, has_spacing, has_counts;
    masu_bake_box bounds;   /* default: bounds of the instances */
    masu_bake_vec3 spacing; /* default: about 2048 probes, with equal spacing on all axes; for live
                             * probes 0.5 m, or larger if LIVE_BYTES requires it */
    uint32_t counts[3];
    uint32_t rays; /* of each probe */
    uint32_t bounces;
    uint32_t sky_bands;  /* 1..3 */
    uint32_t visibility; /* texels along the edge of a map of distances */
    uint32_t suns;       /* 0 and !has_suns: the scene's */
    bool has_suns;
    double bias; /* of the shortest spacing */
    float sun[MASU_PROBE_SUNS_MAX][4];
    uint32_t threads; /* 0: all processors */
} masu_bake_probe_settings;

#define MASU_BAKE_LIVE_SPACING 0.5
#define MASU_BAKE_LIVE_BYTES ((uint64_t)4 << 20)

typedef struct masu_bake_probe_report {
    uint64_t probes, invalid, rays, bytes, triangles;
    double seconds;
} masu_bake_probe_report;

masu_bake_probe_settings masu_bake_probe_defaults(void);

/* Appends PROBES and PROBE_DATA; for live probes without baked light, only distance maps. Textures,
 * if any, must have been made before. False after reporting. */
bool masu_bake_make_probes(masu_bake_content *content, const masu_bake_probe_settings *settings,
                           const masu_bake_trace *trace, masu_bake_probe_report *report);

/* How far one way to have ambient light is off under one light. */
typedef struct masu_bake_probe_error {
    const char *light, *method;
    double rmse, bias, worst; /* relative to the mean of the ground truth */
} masu_bake_probe_error;

#define MASU_BAKE_PROBE_ERRORS 48u

/* Fills the errors of the grid's light against path-traced ground truth at `points` surface points
 * (fewer if the grid sees fewer), and returns the number of rows. */
uint32_t masu_bake_judge_probes(const masu_bake_content *content,
                                const masu_bake_probe_settings *settings,
                                const masu_bake_trace *trace, uint32_t points, uint32_t rays,
                                masu_bake_probe_error errors[MASU_BAKE_PROBE_ERRORS]);

/* The same as a table. */
void masu_bake_report_probes(const masu_bake_content *content,
                             const masu_bake_probe_settings *settings, const masu_bake_trace *trace,
                             uint32_t points, uint32_t rays);

#endif
